!> The rotation inside a step as the quartic through both ends, both velocities and the acceleration
!> at the beginning: where something happens first. The quintic with the acceleration at the end as
!> well says it more sharply. Both say where to step to, not what the state is.
module rwmf_simulation_events_step_quartic
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: quartic_t, quartic_of, first_event, quintic_of, place_event
   public :: no_event, at_low, at_high, at_turn, value_at, slope_at

   integer, parameter :: no_event = 0
   integer, parameter :: at_low = -1
   !! the rotation falls below its window
   integer, parameter :: at_high = 1
   !! or rises above it
   integer, parameter :: at_turn = 2
   !! the velocity changes its sign

   integer, parameter :: most_iterations = 60
   real(wp), parameter :: resolution = 1.0e-4_wp
   !! of a position: about the error of the quartic [-]

   !> theta in powers of the position in the step, from 0 to 1 [rad].
   type :: quartic_t
      real(wp) :: c(0:5)
      !! the last one is that of the quintic
   end type quartic_t

contains

   !> The quartic of a step.
   pure type(quartic_t) function quartic_of(h, theta, theta_dot, acceleration) result(quartic)
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: theta(2)
      !! at both ends [rad]
      real(wp), intent(in) :: theta_dot(2)
      !! [rad/s]
      real(wp), intent(in) :: acceleration
      !! at the beginning [rad/s2]
      real(wp) :: rest, slope

      associate (v => h*theta_dot, a => h**2*acceleration)
         rest = theta(2) - theta(1) - v(1) - a/2
         slope = v(2) - v(1) - a
         quartic%c = [theta(1), v(1), a/2, 4*rest - slope, slope - 3*rest, 0.0_wp]
      end associate
   end function quartic_of

   !> The quintic of a step from its quartic.
   pure type(quartic_t) function quintic_of(quartic, end) result(quintic)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: end
      !! acceleration at the end of the step, times the square of its length [rad]
      real(wp) :: rest

      associate (c => quartic%c)
         rest = (end - (2*c(2) + 6*c(3) + 12*c(4)))/2
         quintic%c = [c(0), c(1), c(2), c(3) + rest, c(4) - 2*rest, rest]
      end associate
   end function quintic_of

   !> Where the quintic has the event that its quartic has shown.
   pure subroutine place_event(quintic, event, level, x, is_found)
      type(quartic_t), intent(in) :: quintic
      integer, intent(in) :: event
      !! `at_low`, `at_high` or `at_turn`
      real(wp), intent(in) :: level
      !! of the rotation; a turn has none [rad]
      real(wp), intent(inout) :: x
      !! its position in the step, nearly; on return more so than the quintic is [-]
      logical, intent(out) :: is_found
      real(wp) :: move
      integer :: i

      is_found = .false.
      do i = 1, 6
         if (event == at_turn) then
            associate (c => quintic%c)
               move = -slope_at(quintic, x)/(2*c(2) + x*(6*c(3) + x*(12*c(4) + x*20*c(5))))
            end associate
         else
            move = (level - value_at(quintic, x))/slope_at(quintic, x)
         end if
         x = x + move
         if (.not. (x > 0 .and. x <= 1)) return
         is_found = abs(move) <= 1.0e-5_wp*x
         if (is_found) return
      end do
   end subroutine place_event

   !> First event of a step: the end of the window, or a turn that matters.
   pure subroutine first_event(quartic, window, extremes, event, x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: window(2)
      !! rotations between which nothing happens [rad]
      real(wp), intent(in) :: extremes(2)
      !! turns between these do not matter [rad]
      integer, intent(out) :: event
      !! `no_event`, `at_low`, `at_high` or `at_turn`
      real(wp), intent(out) :: x
      !! its position in the step [-]
      real(wp) :: turn(0:4)
      !! ends of the monotone pieces [-]
      real(wp) :: value, margin
      integer :: i, n

      call find_turns(quartic, turn, n)
      event = no_event
      do i = 1, n
         value = value_at(quartic, turn(i))
         if (value <= window(1) .and. value < value_at(quartic, turn(i - 1))) then
            event = at_low
            x = crossing(quartic, window(1), turn(i - 1), turn(i))
            return
         else if (value >= window(2) .and. value > value_at(quartic, turn(i - 1))) then
            event = at_high
            x = crossing(quartic, window(2), turn(i - 1), turn(i))
            return
         end if
         if (i == n) return
         ! the true turn may lie a little further out than that of the quartic
         margin = 0.05_wp*max(abs(value - quartic%c(0)), abs(value - sum(quartic%c)))
         if (value - margin < max(extremes(1), window(1)) &
             .or. value + margin > min(extremes(2), window(2))) then
            event = at_turn
            x = turn(i)
            return
         end if
      end do
   end subroutine first_event

   !> Zeros of the velocity inside the step, between its ends.
   pure subroutine find_turns(quartic, turn, n)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(out) :: turn(0:4)
      integer, intent(out) :: n
      !! number of monotone pieces
      real(wp) :: edge(0:3)
      !! ends of the pieces in which the velocity is monotone
      real(wp) :: root
      integer :: i, m

      edge(0) = 0
      m = 0
      associate (a => 12*quartic%c(4), b => 6*quartic%c(3), c => 2*quartic%c(2))
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
      if (m == 2) then
         if (edge(2) < edge(1)) edge(1:2) = edge([2, 1])
      end if
      m = m + 1
      edge(m) = 1
      turn(0) = 0
      n = 0
      do i = 1, m
         associate (at_begin => slope_at(quartic, edge(i - 1)), &
            at_end => slope_at(quartic, edge(i)))
            if (at_begin*at_end >= 0 .and. .not. (i == m .and. abs(at_end) <= 0)) cycle
         end associate
         n = n + 1
         turn(n) = stationary(quartic, edge(i - 1), edge(i))
      end do
      n = n + 1
      turn(n) = 1
   end subroutine find_turns

   !> Where the velocity is zero between two positions at which it has different signs.
   pure real(wp) function stationary(quartic, begin, end) result(x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: begin, end
      real(wp) :: low, high, value, bend
      logical :: rises
      integer :: i

      low = begin
      high = end
      rises = slope_at(quartic, end) > slope_at(quartic, begin)
      x = low + (high - low)*slope_at(quartic, begin)/(slope_at(quartic, begin) &
         - slope_at(quartic, end))
      do i = 1, most_iterations
         value = slope_at(quartic, x)
         if (abs(value) <= 0) exit
         bend = 2*quartic%c(2) + x*(6*quartic%c(3) + x*12*quartic%c(4))
         call improve(value, bend, rises, low, high, x)
         if (high - low <= resolution .or. abs(value) <= resolution*abs(bend)) exit
      end do
   end function stationary

   !> Where the rotation passes a level in a monotone piece.
   pure real(wp) function crossing(quartic, level, begin, end) result(x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: level
      real(wp), intent(in) :: begin, end
      real(wp) :: low, high, value, slope
      logical :: rises
      integer :: i

      low = begin
      high = end
      associate (at_begin => value_at(quartic, begin) - level, &
                 at_end => value_at(quartic, end) - level)
         rises = at_end > at_begin
         x = begin + (end - begin)*max(0.0_wp, min(1.0_wp, at_begin/(at_begin - at_end)))
      end associate
      do i = 1, most_iterations
         value = value_at(quartic, x) - level
         if (abs(value) <= 0) exit
         slope = slope_at(quartic, x)
         call improve(value, slope, rises, low, high, x)
         if (high - low <= resolution .or. abs(value) <= resolution*abs(slope)) exit
      end do
   end function crossing

   !> One step of Newton's method inside a bracket.
   pure subroutine improve(value, slope, rises, low, high, x)
      real(wp), intent(in) :: value, slope
      logical, intent(in) :: rises
      real(wp), intent(inout) :: low, high
      real(wp), intent(inout) :: x

      if ((value > 0) .eqv. rises) then
         high = x
      else
         low = x
      end if
      if (abs(slope) > 0) x = x - value/slope
      if (.not. (x > low .and. x < high)) x = low + (high - low)/2
   end subroutine improve

   pure real(wp) function value_at(quartic, x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: x

      associate (c => quartic%c)
         value_at = c(0) + x*(c(1) + x*(c(2) + x*(c(3) + x*(c(4) + x*c(5)))))
      end associate
   end function value_at

   !> Its derivative by the position.
   pure real(wp) function slope_at(quartic, x)
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: x

      associate (c => quartic%c)
         slope_at = c(1) + x*(2*c(2) + x*(3*c(3) + x*(4*c(4) + x*5*c(5))))
      end associate
   end function slope_at

end module rwmf_simulation_events_step_quartic
