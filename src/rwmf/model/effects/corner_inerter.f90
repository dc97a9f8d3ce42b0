!> Inerters between the foundation and the corners of the base, one at each corner.
!>
!> An inerter resists the relative acceleration of its ends with B times this acceleration. The
!> stroke of the inerter under the lifting corner is the chord 4b sin(phi/2); the other inerter is
!> at rest. Its kinetic energy B (2b cos(phi/2) phi')**2/2 adds to the inertia. Since the arm
!> decreases with the rotation, it also adds a term in phi'**2.
module rwmf_model_effects_corner_inerter
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, model_t
   use rwmf_model_scene, only: under_corner
   use rwmf_problem_case, only: case_t, inerter_t
   use rwmf_problem_case_group, only: case_group_t, two_corners
   use rwmf_problem_group_values, only: real_of
   use rwmf_problem_key, only: dimensional, not_negative, required, with_si, usually
   implicit none
   private

   public :: inerter_group
   public :: prepare_inerter

contains

   !> Describe the group `&inerter`: its keys and the procedures that check and read them.
   type(case_group_t) function inerter_group() result(group)
      group%name = 'inerter'
      group%needs(1) = 'wall'
      group%not_on_base = two_corners
      group%reasons(1) = 'inerters work under its corners'
      group%keys = [ &
         with_si('kg', required('inerter', 'inertance_over_m_w', 'real', '-', not_negative, &
            'inerter under each corner of the base: its inertance over m_w')), &
         usually('[1, 1e10]', &
            dimensional('inerter', 'inertance', 'real', 'kg', 'inertance_over_m_w', '', &
            'or its inertance', not_negative))]
      group%fill => fill_inerter
      group%is_present => has_inerter
   end function inerter_group

   subroutine fill_inerter(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%inerter = inerter_t(real_of(case%values, 'inerter', 'inertance_over_m_w'))
   end subroutine fill_inerter

   pure logical function has_inerter(case)
      type(case_t), intent(in) :: case

      has_inerter = allocated(case%inerter)
   end function has_inerter

   !> Prepare the contribution of the inerters to the equation, if the case has them.
   subroutine prepare_inerter(case, equation, inerter)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: inerter

      inerter%is_present = has_inerter(case)
      if (.not. inerter%is_present) return
      ! a hinged wall moves both inerters, each with half of the arm
      inerter%constants = [merge(1.0_wp, 0.5_wp, equation%has_impacts) &
         *case%inerter%inertance_over_m_w]
      inerter%n_coef = 1
      inerter%coefficients => inerter_coefficients
      inerter%energy => inerter_energy
      inerter%acts = under_corner
   end subroutine prepare_inerter

   pure subroutine inerter_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      coef(1) = effect%constants(1)*(2*model%p%sin_alpha)**2
   end subroutine inerter_coefficients

   !> Kinetic energy of the inerter [J/kg].
   real(wp) function inerter_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)

      energy = equation%p%R**2*(effect%constants(1)*(2*equation%p%sin_alpha*cos(y(1)/2))**2) &
         *y(2)**2/2
   end function inerter_energy

end module rwmf_model_effects_corner_inerter
