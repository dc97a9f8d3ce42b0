!> Turns of the rotation inside the last step of an integrator: sign changes of theta'.
module rwmf_simulation_events_turns
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_sign_changes, only: no_change, one_change, polygon_t, roughness, &
      value_polygon
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_first_change, only: changes_in, functions_t, moment_t, &
      span_between, span_t, stop_at_change, watch_t
   use rwmf_simulation_events_step_view, only: fastest_angle, sample_state, step_view_t
   implicit none
   private

   public :: rotation_t, velocity_t, keeps_direction, fastest_in, farthest_turn, split_turns

   !> Rotation, velocity and acceleration.
   type, extends(functions_t) :: rotation_t
   contains
      procedure :: evaluate => evaluate_rotation
   end type rotation_t

   !> Velocity and acceleration.
   type, extends(functions_t) :: velocity_t
   contains
      procedure :: evaluate => evaluate_velocity
   end type velocity_t

contains

   !> Evaluate rotation, velocity and acceleration at a state.
   subroutine evaluate_rotation(self, t, y, f)
      class(rotation_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      call rates_at(self%step%equation, t, y, y_dot)
      allocate (f(1, 0:2))
      f(1, :) = [y(1), y(2), y_dot(2)]
   end subroutine evaluate_rotation

   !> Evaluate velocity and acceleration at a state.
   subroutine evaluate_velocity(self, t, y, f)
      class(velocity_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      call rates_at(self%step%equation, t, y, y_dot)
      allocate (f(1, 0:1))
      f(1, :) = [y(2), y_dot(2)]
   end subroutine evaluate_velocity

   !> Return whether the ends of a step show that theta' keeps its sign.
   pure logical function keeps_direction(step)
      type(step_view_t), intent(in) :: step
      real(wp) :: middle(2), error

      associate (a => step%y_a(2), b => step%y_b(2))
         keeps_direction = a*b > 0
         if (.not. keeps_direction) return
         call bound_velocity(step, middle, error)
         keeps_direction = minval(sign(1.0_wp, a)*middle) > error
      end associate
   end function keeps_direction

   !> Upper bound of |theta'| in a step from its ends.
   pure real(wp) function fastest_in(step) result(fastest)
      type(step_view_t), intent(in) :: step
      real(wp) :: middle(2), error

      call bound_velocity(step, middle, error)
      fastest = max(abs(step%y_a(2)), abs(step%y_b(2)), maxval(abs(middle)) + error)
   end function fastest_in

   !> Compute velocity bounds in a step from the cubic of the rotation.
   !>
   !> This is `rate_polygon` written out, because most steps need nothing else.
   pure subroutine bound_velocity(step, middle, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(out) :: middle(2)
      !! Bernstein coefficients between both ends [rad/s]
      real(wp), intent(out) :: error
      !! error bound of both coefficients [rad/s]
      real(wp) :: bend(2)
      !! differences of the coefficients at one degree lower [rad/s]
      real(wp) :: mean, angle

      associate (h => step%t_b - step%t_a, a => step%y_a, b => step%y_b)
         mean = 3*((b(1) - a(1))/h) - a(2) - b(2)
         middle = [a(2) + 2*mean, b(2) + 2*mean]/3
         bend = [mean - a(2), b(2) - mean]
         angle = fastest_angle(step, h)
         error = angle*(abs(bend(2) - bend(1)) + angle*maxval(abs(bend)))/18
      end associate
   end subroutine bound_velocity

   !> Bound on the rotation at a single turn between the ends of a step.
   !>
   !> The turn lies within the cubic and its error. The bound also lies beyond the farther end, by
   !> four times the distance under a steady acceleration.
   pure real(wp) function farthest_turn(step) result(turn)
      type(step_view_t), intent(in) :: step
      type(polygon_t) :: polygon
      real(wp) :: reach

      associate (h => step%t_b - step%t_a, a => step%y_a(:2), b => step%y_b(:2))
         reach = 0.5_wp*h*(abs(a(2)) + abs(b(2)))
         polygon = value_polygon(h, a, b, roughness(fastest_angle(step, h), h, a, b))
         associate (c => polygon%c(:polygon%n), margin => polygon%margin(:polygon%n))
            if (b(2) > a(2)) then
               turn = min(minval(c - margin), min(a(1), b(1)) - reach)
            else
               turn = max(maxval(c + margin), max(a(1), b(1)) + reach)
            end if
         end associate
      end associate
   end function farthest_turn

   !> Split a step in which theta' changes its sign more often than its ends show.
   !>
   !> The cut lies between the first and the second change, or before the first if theta' starts at
   !> zero.
   subroutine split_turns(step, direction, t, y, is_split, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: direction
      !! sign of theta' at the start of the step; 0: sign of its first values [-]
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states) at t
      logical, intent(out) :: is_split
      !! true if the step is split; otherwise `t` and `y` are undefined
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(rotation_t) :: rotation
      type(moment_t) :: a, b
      type(span_t) :: span, next
      type(watch_t) :: watch
      logical :: is_known

      is_split = .false.
      if (keeps_direction(step)) return
      rotation%step = step
      a%t = step%t_a
      b%t = step%t_b
      call rotation%evaluate(a%t, step%y_a, a%f)
      call rotation%evaluate(b%t, step%y_b, b%f)
      span = span_between(rotation, a, b)
      watch = watch_t(1, 1, side=sign(1.0_wp, direction))
      if (abs(direction) <= 0) watch%side = sign(1.0_wp, a%f(1, 2))
      if (any(changes_in(span, watch) == [no_change, one_change])) return
      next = span
      call stop_at_change(rotation, watch, span, is_known, error)
      if (allocated(error) .or. .not. is_known) return
      if (span%b%t <= step%t_a) then
         ! the turn is at the start of the step
         watch%side = -watch%side
         call stop_at_change(rotation, watch, next, is_known, error)
         if (allocated(error) .or. .not. is_known) return
         t = step%t_a + (next%b%t - step%t_a)/2
      else if (abs(direction) <= 0) then
         t = step%t_a + (span%b%t - step%t_a)/2
      else
         t = span%b%t
      end if
      is_split = t > step%t_a .and. t < step%t_b
      if (is_split) call sample_state(step, t, y, error)
   end subroutine split_turns

end module rwmf_simulation_events_turns
