!> What the rules between keys and groups have in common: conditions, and messages that name a group
!> or a key.
module rwmf_input_rules_common
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_input_group_values, only: entry_of, group_of, has_group, has_key
   use rwmf_input_namelist, only: group_t
   use rwmf_input_schema_check, only: fail_at_entry, fail_at_group
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: check_needs, check_one_of, fail_group, fail_key
   public :: too_stiff

contains

   !> What is wrong with a spring so stiff that no method follows its mass; empty for others.
   !>
   !> A period of 1e-5 s is a thousandth of what any part of a building has; far below, the motion
   !> of the mass is lost in the round-off of its rotation.
   pure function too_stiff(root_mass, root_stiffness) result(problem)
      real(wp), intent(in) :: root_mass
      !! square root of the mass, or of its part of a quotient: neither overflows [sqrt(kg)]
      real(wp), intent(in) :: root_stiffness
      !! > 0, square root of the stiffness [sqrt(N/m)]
      character(:), allocatable :: problem
      real(wp), parameter :: shortest = 1.0e-5_wp
      !! [s]

      problem = ''
      if (2*pi*root_mass >= shortest*root_stiffness) return
      problem = 'the period 2 pi sqrt(mass/stiffness) is ' &
         //real_to_text(2*pi*root_mass/root_stiffness)//' s, must be >= ' &
         //real_to_text(shortest)//' s: lower the stiffness'
   end function too_stiff

   !> A group that is given needs another one.
   subroutine check_needs(groups, group, other, reason, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: other
      character(*), intent(in) :: reason
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, group) .or. has_group(groups, other)) return
      call fail_group(groups, group, 'must not be given without &'//other//' ('//reason//')', error)
   end subroutine check_needs

   !> Exactly one of two keys must be given.
   subroutine check_one_of(groups, group, a, b, condition, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: a
      character(*), intent(in) :: b
      character(*), intent(in) :: condition
      !! 'with ...'
      type(error_t), allocatable, intent(out) :: error

      if (has_key(groups, group, a) .and. has_key(groups, group, b)) then
         call fail_key(groups, group, b, 'must not be given beside '//a//': exactly one of both ' &
            //condition, error)
      else if (.not. has_key(groups, group, a) .and. .not. has_key(groups, group, b)) then
         call fail_group(groups, group, 'exactly one of the keys '//a//' and '//b &
            //' must be given '//condition, error)
      end if
   end subroutine check_one_of

   !> Report a group by its name.
   subroutine fail_group(groups, group, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error

      call fail_at_group(groups(group_of(groups, group)), problem, error)
   end subroutine fail_group

   !> Report a key by its name.
   subroutine fail_key(groups, group, key, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      at = group_of(groups, group)
      call fail_at_entry(groups(at), groups(at)%entries(entry_of(groups(at), key)), problem, error)
   end subroutine fail_key

end module rwmf_input_rules_common
