!> Rules of the impact, of the vertical ground motion, and of a frame without mass.
module rwmf_input_rules_effects
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_group_values, only: get_list, has_group, has_key, real_of, text_of
   use rwmf_input_namelist, only: group_t
   use rwmf_input_rules_common, only: check_one_of, fail_group, fail_key
   implicit none
   private

   public :: check_impact, check_massless, check_vertical

contains

   !> Exactly one of e and r for rule 'constant', the table for rule 'table', none for the others.
   subroutine check_impact(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(15), parameter :: keys(4) = [character(15) :: &
         'e', 'r', 'table_theta_dot', 'table_e']
      character(8), parameter :: rules(4) = [character(8) :: &
         'constant', 'constant', 'table', 'table']
      character(:), allocatable :: rule
      integer :: i

      if (.not. has_group(groups, 'impact')) return
      rule = text_of(groups, 'impact', 'rule')
      do i = 1, size(keys)
         if (rule == rules(i) .or. .not. has_key(groups, 'impact', trim(keys(i)))) cycle
         call fail_key(groups, 'impact', trim(keys(i)), "must not be given with rule = '"//rule &
            //"', which sets it", error)
         return
      end do
      if (rule == 'constant') then
         call check_one_of(groups, 'impact', 'e', 'r', "with rule = 'constant'", error)
      else if (rule == 'table') then
         call check_table(groups, error)
      end if
   end subroutine check_impact

   !> Both columns of a table, of one length, with velocities in order.
   subroutine check_table(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(15), parameter :: keys(2) = [character(15) :: 'table_theta_dot', 'table_e']
      real(wp), allocatable :: theta_dot(:)
      real(wp), allocatable :: e(:)
      integer :: i

      do i = 1, size(keys)
         if (has_key(groups, 'impact', trim(keys(i)))) cycle
         call fail_group(groups, 'impact', 'the key '//trim(keys(i))//' is missing: must be ' &
            //"given with rule = 'table'", error)
         return
      end do
      call get_list(groups, 'impact', 'table_theta_dot', theta_dot)
      call get_list(groups, 'impact', 'table_e', e)
      if (size(theta_dot) /= size(e)) then
         call fail_key(groups, 'impact', 'table_e', 'must have as many values as table_theta_dot', &
            error)
      else if (any(theta_dot(2:) <= theta_dot(:size(theta_dot) - 1))) then
         call fail_key(groups, 'impact', 'table_theta_dot', 'must increase strictly', error)
      end if
   end subroutine check_table

   !> A ratio to the horizontal motion, or a record.
   subroutine check_vertical(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: record_keys(3) = [character(5) :: 'dt', 'unit', 'scale']
      character(:), allocatable :: kind
      integer :: i

      if (.not. has_group(groups, 'vertical')) return
      call check_one_of(groups, 'vertical', 'ratio', 'file', 'of the vertical motion', error)
      if (allocated(error)) return
      kind = 'none'
      if (has_group(groups, 'motion')) kind = text_of(groups, 'motion', 'kind')
      if (has_key(groups, 'vertical', 'file')) return
      if (kind == 'none') then
         call fail_key(groups, 'vertical', 'ratio', 'must not be given without a horizontal ' &
            //'&motion, which it multiplies', error)
      else
         do i = 1, size(record_keys)
            if (.not. has_key(groups, 'vertical', trim(record_keys(i)))) cycle
            call fail_key(groups, 'vertical', trim(record_keys(i)), 'must not be given beside ' &
               //'ratio: it belongs to a record', error)
            return
         end do
      end if
   end subroutine check_vertical

   !> The springs of the frame are those of its period and mass: without mass nothing yields.
   subroutine check_massless(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(8), parameter :: places(2) = [character(8) :: 'frame', 'spectrum']
      character(*), parameter :: problem = 'must be > 0 with &yielding (a frame without mass has ' &
         //'no stiffness, and nothing yields)'
      real(wp), allocatable :: gamma(:)
      integer :: i

      if (.not. has_group(groups, 'yielding')) return
      do i = 1, size(places)
         if (.not. has_key(groups, trim(places(i)), 'gamma')) cycle
         if (places(i) == 'frame') then
            gamma = [real_of(groups, 'frame', 'gamma')]
         else
            call get_list(groups, 'spectrum', 'gamma', gamma)
         end if
         if (all(gamma > 0)) cycle
         call fail_key(groups, trim(places(i)), 'gamma', problem, error)
         return
      end do
   end subroutine check_massless

end module rwmf_input_rules_effects
