!> Instants inside the last step of an integrator: where a state passes a level, to round-off, and
!> where theta' turns unseen between the ends.
module rwmf_simulation_events_event_time
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow, stationary_point
   use rwmf_model_assembly, only: equation_t, interval_of, rhs, second_derivative
   use rwmf_motion_ground_motion, only: interval_end, turning_point
   implicit none
   private

   public :: find_event_time, count_parts, find_reversal

   integer, parameter :: most_iterations = 200
   !! a bisection of the whole range of exponents takes fewer

contains

   !> Find t in [t_a, t_b] with y(component) = level.
   !>
   !> Newton's method from the inverse cubic through both ends, kept inside a bracket that every
   !> evaluation tightens. A correction below sqrt(epsilon) of the step is carried out by Taylor's
   !> formula, whose remainder is then round-off: usually two states are asked of the integrator.
   subroutine find_event_time(equation, integrator, component, level, t_a, y_a, t_b, y_b, t, y, &
      error)
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      integer, intent(in) :: component
      !! 1: theta, 2: theta', or a further state
      real(wp), intent(in) :: level
      !! [rad], [rad/s] or of the further state
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: y_a(:)
      !! (states) at t_a
      real(wp), intent(in) :: t_b
      !! [s]; y_b - level has the other sign than y_a - level, or is zero
      real(wp), intent(in) :: y_b(:)
      !! (states) at t_b
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states) there
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      !! [s]
      real(wp) :: g
      real(wp) :: correction
      real(wp) :: y_dot(size(y))
      logical :: is_falling
      !! y - level is positive at t_a, or zero there and negative at t_b
      integer :: i

      bracket = bracket_between(t_a, t_b, spacings=2)
      is_falling = y_a(component) > level &
         .or. (y_a(component) >= level .and. y_b(component) < level)
      t = first_guess(equation, component, level, t_a, y_a, t_b, y_b)
      do i = 1, most_iterations
         call integrator%state_at(t, y, error)
         if (allocated(error)) return
         g = y(component) - level
         if (abs(g) <= tiny(g)) return
         call narrow(bracket, (g > 0) .neqv. is_falling, t)
         if (.not. bracket%is_open) exit
         call rhs(equation, t, y, y_dot)
         correction = newton_correction(g, y_dot(component))
         if (abs(correction) <= sqrt(epsilon(g))/10*(t_b - t_a) .and. t + correction >= t_a &
            .and. t + correction <= t_b) then
            t = t + correction
            y = y + correction*y_dot
            return
         end if
         t = keep_inside(bracket, t + correction)
      end do
      t = bracket%high
      call integrator%state_at(t, y, error)
      if (allocated(error)) return
      ! A few spacings of the time are not nothing to a flight of a hundred: without this its impact
      ! would be faster than its start, and hardly damped chatter would never end.
      call rhs(equation, t, y, y_dot)
      correction = newton_correction(y(component) - level, y_dot(component))
      if (abs(correction) <= 2*spacing(t)) y = y + correction*y_dot
   end subroutine find_event_time

   !> Newton's correction; a vanishing rate gives one that leaves every bracket.
   pure real(wp) function newton_correction(g, rate) result(correction)
      real(wp), intent(in) :: g
      real(wp), intent(in) :: rate

      correction = huge(g)
      if (abs(g) < abs(rate)*sqrt(huge(g))) correction = -g/rate
   end function newton_correction

   !> Time as the cubic function of the state through both ends, at the level [s].
   real(wp) function first_guess(equation, component, level, t_a, y_a, t_b, y_b) result(t)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: component
      real(wp), intent(in) :: level
      real(wp), intent(in) :: t_a
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(in) :: t_b
      real(wp), intent(in) :: y_b(:)
      real(wp) :: slope_a(size(y_a))
      real(wp) :: slope_b(size(y_a))
      real(wp) :: rise
      real(wp) :: x
      !! position between the end values [-]
      real(wp) :: s_a
      real(wp) :: s_b
      !! slopes of time over state, per unit of x [s]

      t = t_a + (t_b - t_a)/2
      rise = y_b(component) - y_a(component)
      if (abs(rise) <= tiny(rise)) return
      x = (level - y_a(component))/rise
      call rhs(equation, t_a, y_a, slope_a)
      call rhs(equation, t_b, y_b, slope_b)
      ! A slope far from the secant's means that time is no smooth function of the state here.
      s_a = inverse_slope(slope_a(component))
      s_b = inverse_slope(slope_b(component))
      t = t_a + x*(t_b - t_a) + x*(1 - x)*((1 - x)*(s_a - (t_b - t_a)) - x*(s_b - (t_b - t_a)))
      if (.not. (t > t_a .and. t < t_b)) t = t_a + x*(t_b - t_a)
      if (.not. (t > t_a .and. t < t_b)) t = t_a + (t_b - t_a)/2

   contains

      !> Slope of the time from that of the state; one that vanishes has the sign of the rise, so
      !> that the mirrored motion gives the mirrored bits.
      pure real(wp) function inverse_slope(slope)
         real(wp), intent(in) :: slope

         inverse_slope = max(abs(slope), abs(rise)/(4*(t_b - t_a)))
         inverse_slope = abs(rise)/inverse_slope
         if (slope*rise < 0) inverse_slope = -inverse_slope
      end function inverse_slope
   end function first_guess

   !> In how many parts to search a step: in each of them frame and ground motion go through a
   !> quarter of their periods at most. A high order with a loose tolerance takes steps of a period.
   integer function count_parts(equation, t_a, t_b) result(n)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      integer, parameter :: most = 1000
      real(wp) :: quarter
      !! of the shortest period [s]
      real(wp) :: first
      real(wp) :: second

      quarter = huge(quarter)
      if (equation%has_frame) quarter = pi/2/max(equation%p%omega_s, equation%max_frequency)
      first = turning_point(equation%motion, interval_of(equation), t_a)
      if (first < min(t_b, interval_end(equation%motion, interval_of(equation)))) then
         second = turning_point(equation%motion, interval_of(equation), first)
         if (second < interval_end(equation%motion, interval_of(equation))) then
            quarter = min(quarter, (second - first)/2)
         end if
      end if
      n = ceiling(min((t_b - t_a)/quarter, real(most, wp)))
      n = max(n, 1)
   end function count_parts

   !> Does theta' pass through zero and back between two times at which it has the same sign?
   !>
   !> The rotation tells at no cost: a theta' that touches zero as a parabola has the mean
   !> (v_a + v_b - sqrt(v_a v_b))/3. Only below that, with a margin, slopes and a state are
   !> evaluated.
   subroutine find_reversal(equation, integrator, t_a, y_a, t_b, y_b, t, y, found, error)
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: y_a(:)
      !! (states) at t_a
      real(wp), intent(in) :: t_b
      !! [s]
      real(wp), intent(in) :: y_b(:)
      !! (states) at t_b
      real(wp), intent(inout) :: t
      !! when found: a time between both sign changes [s]
      real(wp), intent(inout) :: y(:)
      !! (states) there
      logical, intent(out) :: found
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: margin = 0.45_wp
      !! 1/3: the parabola; 1/2: a straight line from rest, of which there are many
      real(wp) :: h
      real(wp) :: v(2)
      !! theta' at the ends, not negative [rad/s]
      real(wp) :: slope(2)
      !! of it over the span [rad/s]

      h = t_b - t_a
      found = .false.
      v = abs([y_a(2), y_b(2)])
      if (sign(1.0_wp, y_a(2) + y_b(2))*(y_b(1) - y_a(1)) &
         >= margin*h*(sum(v) - sqrt(v(1))*sqrt(v(2)))) return
      slope = [second_derivative(equation, t_a, y_a), second_derivative(equation, t_b, y_b)]
      slope = slope*sign(h, y_a(2) + y_b(2))
      if (slope(1) >= 0 .or. slope(2) <= 0) return
      t = t_a + stationary_point(v(1), slope(1), v(2), slope(2))*h
      call integrator%state_at(t, y, error)
      if (allocated(error)) return
      found = y(2)*(y_a(2) + y_b(2)) < 0
   end subroutine find_reversal

end module rwmf_simulation_events_event_time
