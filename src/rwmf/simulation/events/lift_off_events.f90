!> Lift-off of a wall held on both corners while further states move, inside the last step of an
!> integrator.
!>
!> The reaction of the base depends on the further states. Lift-off is therefore a root of a
!> function known only from the integrator's states.
module rwmf_simulation_events_lift_off_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: rates_at
   use rwmf_model_equation, only: equation_t, interval_of, uplift_demands
   use rwmf_model_lift_off, only: find_uplift_acceleration, lifting_side
   use rwmf_simulation_events_first_change, only: are_quiet, functions_t, moment_t, &
      sample_functions, span_between, span_t, stop_at_first, watch_t
   use rwmf_simulation_events_step_view, only: sample_state, step_view_t
   implicit none
   private

   public :: side_pulled, search_lift_off, stays_down

   !> Uplift capacity minus demand on the left and on the right [m/s2], with rates.
   type, extends(functions_t) :: reserve_t
   contains
      procedure :: evaluate => evaluate_reserve
   end type reserve_t

contains

   !> Side on which the wall lifts off in a state, 0 if it stays down.
   integer function side_pulled(equation, t, y) result(side)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! within the current interval [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      call find_uplift_acceleration(equation%model_t, equation%state, y)
      side = lifting_side(equation, interval_of(equation), t)
   end function side_pulled

   !> Return whether the ends of a step show that the wall stays down in it.
   logical function stays_down(step, rates_a, rates_b)
      type(step_view_t), intent(in) :: step
      !! step without an integrator
      real(wp), intent(in) :: rates_a(:), rates_b(:)
      !! (states) rates at both ends
      type(reserve_t) :: reserve
      type(moment_t) :: a, b

      reserve%step = step
      a%t = step%t_a
      b%t = step%t_b
      allocate (a%f(2, 0:1), b%f(2, 0:1))
      a%f = reserve_at(step, a%t, step%y_a, rates_a)
      b%f = reserve_at(step, b%t, step%y_b, rates_b)
      stays_down = are_quiet(span_between(reserve, a, b), both_sides(step%equation))
   end function stays_down

   !> Evaluate the reserve against uplift at a state.
   subroutine evaluate_reserve(self, t, y, f)
      class(reserve_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: rates(size(y))

      call rates_at(self%step%equation, t, y, rates)
      allocate (f(2, 0:1))
      f = reserve_at(self%step, t, y, rates)
   end subroutine evaluate_reserve

   !> Uplift capacity minus demand on both sides, with rates. The capacity is linear in the further
   !> states.
   function reserve_at(step, t, y, rates) result(f)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:), rates(:)
      !! (states) with their rates
      real(wp) :: f(2, 0:1)
      !! (sides, 0:1) [m/s2], [m/s3]
      real(wp), parameter :: part = 1.0e-5_wp
      !! fraction of the step in which the ground motion is nearly straight [-]
      real(wp) :: later(2), h

      associate (equation => step%equation, interval => interval_of(step%equation))
         h = step%t_b - step%t_a
         call find_uplift_acceleration(equation%model_t, equation%state, y + h*rates)
         later = -uplift_demands(equation, interval, t)
         call find_uplift_acceleration(equation%model_t, equation%state, y)
         f(:, 0) = -uplift_demands(equation, interval, t)
         f(:, 1) = (later - f(:, 0))/h - (uplift_demands(equation, interval, t + part*h) &
            - uplift_demands(equation, interval, t - part*h))/(2*part*h)
      end associate
   end function reserve_at

   !> Levels just below zero on both sides, by round-off, that the reserve must not pass.
   pure function both_sides(equation) result(watches)
      type(equation_t), intent(in) :: equation
      type(watch_t) :: watches(2)

      watches(1) = watch_t(1, 0, level=-4*epsilon(1.0_wp)*equation%uplift%threshold)
      watches(2) = watch_t(2, 0, level=watches(1)%level)
   end function both_sides

   !> Search the last step of the integrator for the first lift-off.
   subroutine search_lift_off(step, t, y, side, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(out) :: t
      !! time of lift-off, or end of the step [s]
      real(wp), intent(out) :: y(:)
      !! (states) at this time
      integer, intent(out) :: side
      !! side of the new motion, +1 or -1; 0 if the wall stays down
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(reserve_t) :: reserve
      type(moment_t) :: a, b
      type(span_t) :: span

      t = step%t_a
      y = step%y_a
      side = side_pulled(step%equation, t, y)
      if (side /= 0) return
      reserve%step = step
      call sample_functions(reserve, step%t_a, a, error)
      if (.not. allocated(error)) call sample_functions(reserve, step%t_b, b, error)
      if (allocated(error)) return
      span = span_between(reserve, a, b)
      call stop_at_first(reserve, both_sides(step%equation), span, side, error)
      if (allocated(error)) return
      if (side /= 0) side = 2*side - 3
      t = span%b%t
      call sample_state(step, t, y, error)
      ! an implicit method solves for all states together and leaves round-off in the held ones
      y(:2) = 0
      call find_uplift_acceleration(step%equation%model_t, step%equation%state, y)
   end subroutine search_lift_off

end module rwmf_simulation_events_lift_off_events
