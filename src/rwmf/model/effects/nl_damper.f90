!> Nonlinear viscous dampers under the base of a wall. Their force is F_1 |v|**exponent against the
!> velocity v of the stroke.
!>
!> The stroke of a damper is the chord 2a sin(phi/2). It has the velocity v = a cos(phi/2) phi' and
!> the arm a cos(phi/2). The law has a kink at v = 0. The loop of the force is in
!> `rwmf_model_effects_nl_damper_loop`.
module rwmf_model_effects_nl_damper
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, model_t
   use rwmf_model_scene, only: under_corner
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: prepare_nl_damper

contains

   !> Prepare the contribution of the dampers to the equation, if the case has them.
   subroutine prepare_nl_damper(case, damper)
      type(case_t), intent(in) :: case
      type(contribution_t), intent(out) :: damper

      damper%is_present = allocated(case%nl_damper)
      if (.not. damper%is_present) return
      damper%constants = case%nl_damper%exponent(:1)
      damper%n_coef = 4
      damper%coefficients => nl_damper_coefficients
      damper%has_sides = .true.
      damper%acts = under_corner
      damper%has_corner_at_turn = .true.
   end subroutine prepare_nl_damper

   !> Coefficients of all dampers, which have one exponent: those of one damper at the largest arm.
   pure subroutine nl_damper_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)
      real(wp) :: arm, force
      integer :: i

      coef = 0
      do i = 1, size(model%elements)
         if (model%elements(i)%force_1 > 0) coef(1) = max(coef(1), &
            maxval(abs(model%elements(i)%stroke%arm)))
      end do
      do i = 1, size(model%elements)
         associate (damper => model%elements(i))
            if (.not. damper%force_1 > 0) cycle
            coef(3) = damper%exponent
            arm = damper%stroke%arm(state%side)
            force = damper%force_1*(abs(arm)/coef(1))**damper%exponent
            coef([2, 4]) = coef([2, 4]) + [abs(arm)/model%p%R**2*force, sign(force, arm)]
         end associate
      end do
   end subroutine nl_damper_coefficients

end module rwmf_model_effects_nl_damper
