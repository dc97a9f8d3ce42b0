!> Wall hinged in the middle of its base instead of rocking on its corners, `&wall base`.
module rwmf_model_effects_pinned_base
   use rwmf_core_error, only: error_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: group_values_t, has_group, text_of
   use rwmf_problem_key, only: optional_key
   use rwmf_problem_rules, only: fail_group
   implicit none
   private

   public :: pinned_base_group

contains

   !> Keys that a hinged base adds to the group `&wall`.
   type(case_group_t) function pinned_base_group() result(group)
      group%name = 'wall'
      group%after = 'wall'
      group%keys = [optional_key('wall', 'base', 'choice', '', 'rocking', 'rocking pinned', &
         'on two corners with impacts, or hinged in the middle')]
      group%check => check_pinned_base
      group%fill => fill_pinned_base
      group%is_present => has_pinned_base
   end function pinned_base_group

   !> Refuse the groups that a wall hinged in the middle of its base excludes.
   subroutine check_pinned_base(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(6), parameter :: excluded(*) = [character(6) :: 'impact', 'cable']
      character(60), parameter :: reasons(size(excluded)) = [character(60) :: &
         'a hinged wall has no impacts', &
         'a straight cable through the hinge is not stretched']
      integer :: i

      if (text_of(values, 'wall', 'base') /= 'pinned') return
      do i = 1, size(excluded)
         if (.not. has_group(values, trim(excluded(i)))) cycle
         call fail_group(values, trim(excluded(i)), "must not be given with &wall base = " &
            //"'pinned' ("//trim(reasons(i))//')', error)
         return
      end do
   end subroutine check_pinned_base

   subroutine fill_pinned_base(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%wall%base = text_of(case%values, 'wall', 'base')
   end subroutine fill_pinned_base

   pure logical function has_pinned_base(case)
      type(case_t), intent(in) :: case

      has_pinned_base = .false.
      if (allocated(case%wall)) has_pinned_base = case%wall%base == 'pinned'
   end function has_pinned_base

end module rwmf_model_effects_pinned_base
