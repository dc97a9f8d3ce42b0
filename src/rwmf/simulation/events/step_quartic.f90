!> Polynomials of the rotation inside a step, for the position of the first event.
!>
!> The quartic fits rotations and velocities at both ends, and the acceleration at the start. The
!> quintic also fits the acceleration at the end and is more accurate. Both give the length of the
!> next trial step; they do not replace the state.
module rwmf_simulation_events_step_quartic
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: quartic_t, quartic_of, first_event, quintic_of, cubic_of, place_event
   public :: no_event, at_low, at_high, at_turn, value_at, slope_at

   integer, parameter :: no_event = 0
   integer, parameter :: at_low = -1
   !! the rotation falls below its window
   integer, parameter :: at_high = 1
   !! the rotation rises above its window
   integer, parameter :: at_turn = 2
   !! the velocity changes its sign

   integer, parameter :: most_iterations = 60
   real(wp), parameter :: resolution = 1.0e-2_wp
   !! last correction of Newton's method without another check. The remaining error is about its
   !! square, as is the error of the quartic [-]

   !> Coefficients of theta in powers of the position in the step, from 0 to 1 [rad].
   type :: quartic_t
      real(wp) :: c(0:5)
      !! coefficients; the last one belongs to the quintic
   end type quartic_t

contains

   !> Compute the quartic of a step.
   pure type(quartic_t) function quartic_of(h, theta, theta_dot, acceleration) result(quartic)
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: theta(2)
      !! rotations at both ends [rad]
      real(wp), intent(in) :: theta_dot(2)
      !! [rad/s]
      real(wp), intent(in) :: acceleration
      !! acceleration at the start [rad/s2]
      real(wp) :: rest, slope

      associate (v => h*theta_dot, a => h**2*acceleration)
         rest = theta(2) - theta(1) - v(1) - a/2
         slope = v(2) - v(1) - a
         ! one by one, because an array constructor would be copied through memory
         quartic%c(0) = theta(1)
         quartic%c(1) = v(1)
         quartic%c(2) = a/2
         quartic%c(3) = 4*rest - slope
         quartic%c(4) = slope - 3*rest
         quartic%c(5) = 0
      end associate
   end function quartic_of

   !> Compute the quintic of a step from its quartic.
   pure type(quartic_t) function quintic_of(quartic, end) result(quintic)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: end
      !! acceleration at the end of the step times the square of its length [rad]
      real(wp) :: rest

      associate (c => quartic%c)
         rest = (end - (2*c(2) + 6*c(3) + 12*c(4)))/2
         quintic%c(0) = c(0)
         quintic%c(1) = c(1)
         quintic%c(2) = c(2)
         quintic%c(3) = c(3) + rest
         quintic%c(4) = c(4) - 2*rest
         quintic%c(5) = rest
      end associate
   end function quintic_of

   !> Compute the cubic of a further state through its values and rates at both ends.
   pure type(quartic_t) function cubic_of(y, way) result(cubic)
      real(wp), intent(in) :: y(2)
      !! values of the state at both ends
      real(wp), intent(in) :: way(2)
      !! rates of the state at both ends times the length of the step

      cubic%c(0) = y(1)
      cubic%c(1) = way(1)
      cubic%c(2) = 3*(y(2) - y(1)) - 2*way(1) - way(2)
      cubic%c(3) = way(1) + way(2) - 2*(y(2) - y(1))
      cubic%c(4) = 0
      cubic%c(5) = 0
   end function cubic_of

   !> Find the position in the quintic of an event found in the quartic.
   pure subroutine place_event(quintic, event, level, x, is_found)
      type(quartic_t), intent(in) :: quintic
      integer, intent(in) :: event
      !! `at_low`, `at_high` or `at_turn`
      real(wp), intent(in) :: level
      !! level of the rotation; unused for a turn [rad]
      real(wp), intent(inout) :: x
      !! approximate position in the step; on return with less error than the quintic [-]
      logical, intent(out) :: is_found
      !! true if the position converges inside the step; otherwise it is undefined
      real(wp) :: move
      integer :: i

      is_found = .false.
      do i = 1, 6
         if (event == at_turn) then
            associate (c => quintic%c)
               move = -slope_at(c, x)/(2*c(2) + x*(6*c(3) + x*(12*c(4) + x*20*c(5))))
            end associate
         else
            move = (level - value_at(quintic%c, x))/slope_at(quintic%c, x)
         end if
         x = x + move
         if (.not. (x > 0 .and. x <= 1)) return
         is_found = abs(move) <= 1.0e-3_wp*x
         if (is_found) return
      end do
   end subroutine place_event

   !> Find the first event of a step: the end of the window, or a relevant turn.
   pure subroutine first_event(quartic, window, extremes, event, x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: window(2)
      !! range of rotations without an event [rad]
      real(wp), intent(in) :: extremes(2)
      !! range of rotations with irrelevant turns [rad]
      integer, intent(out) :: event
      !! `no_event`, `at_low`, `at_high` or `at_turn`
      real(wp), intent(out) :: x
      !! position of the event in the step [-]
      real(wp) :: turn(0:4)
      !! ends of the monotone pieces [-]
      real(wp) :: value, before, margin
      integer :: i, n

      call find_turns(quartic, turn, n)
      event = no_event
      value = quartic%c(0)
      do i = 1, n
         before = value
         value = value_at(quartic%c, turn(i))
         if (value <= window(1) .and. value < before) then
            event = at_low
         else if (value >= window(2) .and. value > before) then
            event = at_high
         end if
         if (event /= no_event) then
            x = place_between(quartic%c, window(merge(1, 2, event == at_low)), turn(i - 1), &
               turn(i))
            return
         end if
         if (i == n) return
         ! the true turn may lie slightly beyond the turn of the quartic
         margin = 0.05_wp*max(abs(value - quartic%c(0)), abs(value - sum(quartic%c)))
         if (value - margin < max(extremes(1), window(1)) &
             .or. value + margin > min(extremes(2), window(2))) then
            event = at_turn
            x = turn(i)
            return
         end if
      end do
   end subroutine first_event

   !> Find the zeros of the velocity inside the step.
   pure subroutine find_turns(quartic, turn, n)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(out) :: turn(0:4)
      integer, intent(out) :: n
      !! number of monotone pieces
      real(wp) :: v(0:5)
      !! velocity in powers of the position
      real(wp) :: b(0:3)
      !! velocity in Bernstein polynomials; it has at most as many zeros as the coefficients have
      !! sign changes
      real(wp) :: edge(0:3)
      !! ends of the pieces with monotone velocity
      integer :: i, m

      associate (c => quartic%c)
         b(0) = c(1)
         b(1) = c(1) + 2*c(2)/3
         b(2) = c(1) + 4*c(2)/3 + c(3)
         b(3) = c(1) + 2*c(2) + 3*c(3) + 4*c(4)
         turn(0) = 0
         n = 1
         if (min(b(0)*b(1), b(0)*b(2), b(0)*b(3)) > 0) then
            turn(1) = 1
            return
         end if
         v(0) = c(1)
         v(1) = 2*c(2)
         v(2) = 3*c(3)
         v(3) = 4*c(4)
         v(4) = 0
         v(5) = 0
      end associate
      m = 1
      edge(0) = 0
      edge(1) = 1
      if (.not. (b(0)*b(3) < 0 .and. max(b(0)*b(1), b(2)*b(3)) >= 0)) call find_edges(v, edge, m)
      n = 0
      do i = 1, m
         associate (at_begin => value_at(v, edge(i - 1)), at_end => value_at(v, edge(i)))
            if (at_begin*at_end >= 0 .and. .not. (i == m .and. abs(at_end) <= 0)) cycle
         end associate
         n = n + 1
         turn(n) = place_between(v, 0.0_wp, edge(i - 1), edge(i))
      end do
      n = n + 1
      turn(n) = 1
   end subroutine find_turns

   !> Find the ends of the pieces of the step with monotone velocity.
   pure subroutine find_edges(v, edge, m)
      real(wp), intent(in) :: v(0:5)
      !! velocity, of third degree, in powers of the position
      real(wp), intent(out) :: edge(0:3)
      integer, intent(out) :: m
      !! number of pieces
      real(wp) :: root

      edge(0) = 0
      m = 0
      associate (a => 3*v(3), b => 2*v(2), c => v(1))
         root = b**2 - 4*a*c
         if (root > 0) then
            root = -(b + sign(sqrt(root), b))/2
            if (root > min(0.0_wp, a) .and. root < max(0.0_wp, a)) then
               m = 1
               edge(1) = root/a
            end if
            if (c > min(0.0_wp, root) .and. c < max(0.0_wp, root)) then
               m = m + 1
               edge(m) = c/root
            end if
         end if
      end associate
      if (m == 2) edge(1:2) = [minval(edge(1:2)), maxval(edge(1:2))]
      m = m + 1
      edge(m) = 1
   end subroutine find_edges

   !> Position where a polynomial passes a level once between two positions.
   !>
   !> Behind a turn, a velocity first moves away from zero: Newton's method would return there.
   pure real(wp) function place_between(p, level, begin, end) result(x)
      real(wp), intent(in) :: p(0:5)
      real(wp), intent(in) :: level
      real(wp), intent(in) :: begin, end
      real(wp) :: low, high, value, slope
      logical :: rises
      integer :: i

      low = begin
      high = end
      associate (at_begin => value_at(p, begin) - level, at_end => value_at(p, end) - level)
         rises = at_end > at_begin
         x = begin + (end - begin)*max(0.0_wp, min(1.0_wp, at_begin/(at_begin - at_end)))
      end associate
      do i = 1, most_iterations
         value = value_at(p, x) - level
         if (abs(value) <= 0) return
         slope = slope_at(p, x)
         if ((value > 0) .eqv. rises) then
            high = x
         else
            low = x
         end if
         ! Newton's method inside the bracket
         if ((slope > 0) .eqv. rises) then
            if (abs(slope) > 0) x = x - value/slope
            if (abs(value) <= resolution*abs(slope)) then
               x = min(high, max(low, x))
               return
            end if
         end if
         if (.not. (x > low .and. x < high)) x = low + (high - low)/2
         if (high - low <= resolution) return
      end do
   end function place_between

   !> Value of a polynomial.
   pure real(wp) function value_at(p, x)
      real(wp), intent(in) :: p(0:5)
      !! coefficients in powers of x
      real(wp), intent(in) :: x
      !! position in the step [-]

      value_at = p(0) + x*(p(1) + x*(p(2) + x*(p(3) + x*(p(4) + x*p(5)))))
   end function value_at

   !> Derivative of a polynomial.
   pure real(wp) function slope_at(p, x)
      real(wp), intent(in) :: p(0:5)
      !! coefficients in powers of x
      real(wp), intent(in) :: x
      !! position in the step [-]

      slope_at = p(1) + x*(2*p(2) + x*(3*p(3) + x*(4*p(4) + x*5*p(5))))
   end function slope_at

end module rwmf_simulation_events_step_quartic
