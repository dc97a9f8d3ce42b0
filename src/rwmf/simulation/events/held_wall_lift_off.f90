!> Lift-off of a wall held on both corners while further states move, as watched functions.
!>
!> The reaction of the base depends on the further states. Lift-off is therefore a root of a
!> function known only from the integrator's states.
module rwmf_simulation_events_held_wall_lift_off
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, interval_of, uplift_demands
   use rwmf_model_system_lift_off, only: find_uplift_acceleration, lifting_side
   use rwmf_simulation_events_step_view, only: rates_in, step_view_t
   use rwmf_simulation_events_watched_spans, only: functions_t, span_t, watch_t
   use rwmf_simulation_state_result, only: event_lift_off
   implicit none
   private

   public :: reserve_t, side_pulled

   !> Uplift capacity minus demand on the left and on the right [m/s2], with rates.
   type, extends(functions_t) :: reserve_t
   contains
      procedure :: evaluate => evaluate_reserve
      procedure :: watches => watch_reserve
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

   !> Evaluate the reserve against uplift at a state.
   subroutine evaluate_reserve(self, t, y, f)
      class(reserve_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: rates(size(y))
      real(wp), parameter :: part = 1.0e-5_wp
      !! fraction of the step in which the ground motion is nearly straight [-]
      real(wp) :: later(2), h

      call rates_in(self%step, t, y, rates)
      allocate (f(2, 0:1))
      ! Uplift capacity minus demand on both sides, with rates. The capacity is linear in the
      ! further states.
      associate (equation => self%step%equation, interval => interval_of(self%step%equation))
         h = self%step%t_b - self%step%t_a
         call find_uplift_acceleration(equation%model_t, equation%state, y + h*rates)
         later = -uplift_demands(equation, interval, t)
         call find_uplift_acceleration(equation%model_t, equation%state, y)
         f(:, 0) = -uplift_demands(equation, interval, t)
         f(:, 1) = (later - f(:, 0))/h - (uplift_demands(equation, interval, t + part*h) &
            - uplift_demands(equation, interval, t - part*h))/(2*part*h)
      end associate
   end subroutine evaluate_reserve

   !> Declare the lift-off on a side: the reserve falls below a level just below zero, by round-off.
   function watch_reserve(self, i, span) result(watches)
      class(reserve_t), intent(in) :: self
      integer, intent(in) :: i
      !! 1 for the left side, 2 for the right side
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)

      watches = [watch_t(i, 0, level=-4*epsilon(1.0_wp)*self%step%equation%uplift%threshold, &
         kind=event_lift_off)]
   end function watch_reserve

end module rwmf_simulation_events_held_wall_lift_off
