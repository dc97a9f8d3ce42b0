!> Viscous dampers between the foundation and the corners of the base, one at each corner.
!>
!> The stroke of the damper under the lifting corner is the chord 4b sin(phi/2); the other damper
!> is at rest. By virtual work its force c d(stroke)/dt gives the moment c (2b cos(phi/2))**2 phi'
!> against the motion.
module rwmf_model_effects_corner_damper
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, corner_share, discrete_state_t, equation_t, &
      model_t
   use rwmf_model_scene, only: under_corner
   use rwmf_problem_case, only: case_t, damper_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: real_of
   use rwmf_problem_key, only: dimensional, not_negative, required, with_si, usually
   implicit none
   private

   public :: damper_group
   public :: prepare_damper

contains

   !> Describe the group `&damper`: its keys and the procedures that check and read them.
   type(case_group_t) function damper_group() result(group)
      group%name = 'damper'
      group%needs(1) = 'wall'
      group%reasons(1) = 'dampers work under its corners'
      group%keys = [ &
         with_si('N s/m', required('damper', 'c_over_m_w', 'real', '1/s', not_negative, &
            'viscous damper under each corner of the base: its constant over m_w')), &
         usually('[100, 1e9]', &
            dimensional('damper', 'c', 'real', 'N s/m', 'c_over_m_w', '', 'or its constant', &
            not_negative))]
      group%fill => fill_damper
      group%is_present => has_damper
   end function damper_group

   subroutine fill_damper(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%damper = damper_t(real_of(case%values, 'damper', 'c_over_m_w'))
   end subroutine fill_damper

   pure logical function has_damper(case)
      type(case_t), intent(in) :: case

      has_damper = allocated(case%damper)
   end function has_damper

   !> Prepare the contribution of the dampers to the equation, if the case has them.
   subroutine prepare_damper(case, equation, damper)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: damper

      damper%is_present = has_damper(case)
      if (.not. damper%is_present) return
      damper%constants = [corner_share(equation)*case%damper%c_over_m_w]
      damper%n_coef = 1
      damper%coefficients => damper_coefficients
      damper%acts = under_corner
   end subroutine prepare_damper

   pure subroutine damper_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      coef(1) = effect%constants(1)*(2*model%p%sin_alpha)**2
   end subroutine damper_coefficients

end module rwmf_model_effects_corner_damper
