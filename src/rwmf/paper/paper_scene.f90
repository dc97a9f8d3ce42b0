!> Scenes to which Eq. (15) of the paper applies.
module rwmf_paper_paper_scene
   use rwmf_core_error, only: error_t
   use rwmf_model_effects_list, only: all_effects
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_rules, only: fail_group, fail_key
   implicit none
   private

   public :: check_paper_scene

contains

   !> Check that a case has nothing beyond the paper.
   !>
   !> The paper has one rocking wall with a constant sqrt(r), a linear frame with one mass, a linear
   !> cable and a horizontal motion. The error names the group or the key to change, with the
   !> required value.
   subroutine check_paper_scene(case, error)
      type(case_t), intent(in) :: case
      !! filled up to `&solver`
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: reason = " with &solver method = 'paper'"
      type(case_group_t), allocatable :: effects(:)
      integer :: i

      associate (values => case%values)
         if (.not. allocated(case%wall)) then
            call fail_key(values, 'solver', 'method', 'needs &wall, whose rotation is theta in ' &
               //'Eq. (15)', error)
         else if (case%model%formulation /= 'published') then
            call fail_key(values, 'model', 'formulation', "must be 'published'"//reason, error)
         else if (case%wall%base /= 'rocking') then
            call fail_key(values, 'wall', 'base', "must be 'rocking'"//reason, error)
         else if (case%impact%rule /= 'constant') then
            call fail_key(values, 'impact', 'rule', "must be 'constant'"//reason &
               //', with e or r', error)
         end if
         effects = all_effects()
         do i = 1, size(effects)
            if (allocated(error)) return
            if (effects(i)%is_present(case)) call fail_group(values, trim(effects(i)%name), &
               'must not be given'//reason//': it is not in the paper', error)
         end do
      end associate
   end subroutine check_paper_scene

end module rwmf_paper_paper_scene
