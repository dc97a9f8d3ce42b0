!> Explicit pairs as integrators of a single run: a team of one lane.
module rwmf_integrator_explicit_pair
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_lane_step, only: attempt_step
   use rwmf_integrator_one_step, only: one_step_t
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_model_equation, only: ground, vertical_ground
   implicit none
   private

   public :: explicit_pair_t

   !> An explicit pair.
   type, extends(one_step_t) :: explicit_pair_t
      type(pair_t) :: pair
   contains
      procedure :: attempt => attempt_explicit_pair
   end type explicit_pair_t

contains

   subroutine attempt_explicit_pair(self, t, y, f, h, y_new, error)
      class(explicit_pair_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in), contiguous :: y(:)
      real(wp), intent(in), contiguous :: f(:)
      real(wp), intent(in) :: h
      real(wp), intent(out), contiguous :: y_new(:)
      real(wp), intent(out) :: error
      real(wp) :: acceleration(1, most_stages, 2)
      real(wp) :: k(1, size(y), most_stages)
      real(wp) :: tolerance(1, 0:size(y))
      real(wp) :: length(1), norm(1)
      integer :: i

      self%error_order = self%pair%error_order
      associate (equation => self%equation, pair => self%pair)
         acceleration(:, :, 2) = 0
         do i = 2, pair%stages
            acceleration(1, i, 1) = ground(equation, t + pair%c(i)*h)
            if (equation%has_vertical) acceleration(1, i, 2) = vertical_ground(equation, t &
               + pair%c(i)*h)
         end do
         k(1, :, 1) = f
         length = h
         tolerance(1, 0) = self%tolerance%rtol
         tolerance(1, 1:) = self%tolerance%atol
         call attempt_step(equation%scene, pair, equation%state%coef, acceleration, length, &
            tolerance, y, .true., k, y_new, norm)
         equation%rhs_evaluations = equation%rhs_evaluations + int(pair%stages - 1, i8)
      end associate
      error = norm(1)
   end subroutine attempt_explicit_pair

end module rwmf_integrator_explicit_pair
