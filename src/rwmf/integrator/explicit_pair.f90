!> Explicit pairs as integrators of a single run, a batch of one lane.
module rwmf_integrator_explicit_pair
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_lane_step, only: attempt_step
   use rwmf_integrator_one_step, only: one_step_t
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_model_equation, only: equation_t, ground, vertical_ground
   use rwmf_model_lanes, only: power_count
   use rwmf_model_system_energy, only: powers_at
   implicit none
   private

   public :: explicit_pair_t, extend_work

   !> Integrator with an explicit pair.
   type, extends(one_step_t) :: explicit_pair_t
      type(pair_t) :: pair
      real(wp) :: work(power_count) = 0
      !! work of the ground motion, dampers and smooth plastic flow over the last step, if requested
      !! [J/kg]
      real(wp) :: t_work = 0
      !! end of the last step, which may be shortened later [s]
      real(wp), allocatable :: k(:, :, :)
      !! (1, states, stages) buffer for the rates at the stages of a step
   contains
      procedure :: find_work
      procedure :: attempt => attempt_explicit_pair
   end type explicit_pair_t

contains

   !> Compute the work from the beginning of the last step to another time. Close to the end of the
   !> step, add the mean power over the difference to the work of the step. Otherwise repeat the
   !> step.
   subroutine find_work(self, t, y, work)
      class(explicit_pair_t), intent(inout) :: self
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) at t
      real(wp), intent(out) :: work(power_count)
      !! work, as the component `work` [J/kg]
      real(wp), parameter :: close = 2.0e-4_wp
      !! fraction of the step whose third power is negligible [-]
      real(wp) :: y_new(size(y))
      real(wp) :: ignored

      work = self%work
      if (max(abs(t - self%t1), abs(t - self%t_work)) <= max(close*(self%t_work - self%t0), &
         4*epsilon(t)*abs(t))) then
         call extend_work(self%equation, self%t_work, self%y1, t, y, work)
      else
         call attempt_pair(self, self%t0, self%y0, self%f0, t - self%t0, y_new, ignored, work)
      end if
   end subroutine find_work

   !> Add the work over an interval so short that the power in its middle is its mean power.
   subroutine extend_work(equation, t_a, y_a, t_b, y_b, work)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_a, t_b
      !! [s]
      real(wp), intent(in) :: y_a(:), y_b(:)
      !! (states)
      real(wp), intent(inout) :: work(power_count)
      !! [J/kg]
      real(wp) :: power(power_count)

      if (abs(t_b - t_a) <= 4*epsilon(t_b)*abs(t_b)) return
      call powers_at(equation, (t_a + t_b)/2, (y_a + y_b)/2, power)
      work = work + (t_b - t_a)*power
   end subroutine extend_work

   subroutine attempt_explicit_pair(self, t, y, f, h, y_new, error)
      class(explicit_pair_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in), contiguous :: y(:)
      real(wp), intent(in), contiguous :: f(:)
      real(wp), intent(in) :: h
      real(wp), intent(out), contiguous :: y_new(:)
      real(wp), intent(out) :: error

      call attempt_pair(self, t, y, f, h, y_new, error)
   end subroutine attempt_explicit_pair

   !> Attempt a step and compute the work in it on request.
   subroutine attempt_pair(self, t, y, f, h, y_new, error, work)
      class(explicit_pair_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in), contiguous :: y(:)
      real(wp), intent(in), contiguous :: f(:)
      real(wp), intent(in) :: h
      real(wp), intent(out), contiguous :: y_new(:)
      real(wp), intent(out) :: error
      real(wp), intent(out), optional :: work(power_count)
      real(wp) :: acceleration(1, most_stages, 2)
      real(wp) :: tolerance(1, 0:size(y))
      real(wp) :: length(1), square(1)
      integer :: i

      self%error_order = self%pair%error_order
      associate (equation => self%equation, pair => self%pair)
         acceleration(:, :, 2) = 0
         do i = 1, pair%stages
            acceleration(1, i, 1) = ground(equation, t + pair%c(i)*h)
            if (equation%has_vertical) acceleration(1, i, 2) = vertical_ground(equation, t &
               + pair%c(i)*h)
         end do
         if (allocated(self%k)) then
            if (size(self%k, 2) /= size(y)) deallocate (self%k)
         end if
         if (.not. allocated(self%k)) allocate (self%k(1, size(y), most_stages))
         self%k(1, :, 1) = f
         length = h
         tolerance(1, 0) = self%tolerance%rtol
         tolerance(1, 1:) = self%tolerance%atol
         call attempt_step(equation%scene, pair, equation%state%coef, acceleration, length, &
            tolerance, y, .not. present(work), self%k, y_new, square, work)
         equation%rhs_evaluations = equation%rhs_evaluations + int(pair%stages - 1, i8)
      end associate
      error = sqrt(square(1))
   end subroutine attempt_pair

end module rwmf_integrator_explicit_pair
