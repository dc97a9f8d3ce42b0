!> Rest and lift-off in the steps of the fast spectra; the rules are those of `rwmf_model_rest`.
module rwmf_spectrum_fast_rest_rule
   use rwmf_spectrum_fast_time_grid, only: fast_grid_t, ground_at, ground_end
   use rwmf_spectrum_fast_types, only: fast_law_t
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_taylor_oscillator, only: find_root, newton_to_powers
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: find_wake, comes_to_rest, negligible

   real(wp), parameter :: beyond = 1 + 4*epsilon(1.0_wp)
   !! the drive exceeds the threshold by more than round-off
   real(wp), parameter :: negligible = 0.01_wp
   !! part of the tolerance below which a velocity may be dropped
   real(wp), parameter :: room = 3
   !! span looked at over the time that a steady pressure would need

contains

   !> Where a wall that rests at the position x of a step lifts off.
   pure subroutine find_wake(law, grid, loud, number, x, side)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! from `loud_steps`
      integer, intent(inout) :: number
      !! of the step; beyond the last one: never
      real(wp), intent(inout) :: x
      !! [-]
      integer, intent(out) :: side
      !! to which it lifts off, +1 or -1
      real(wp) :: begin
      real(wp) :: limit
      real(wp) :: f
      real(wp) :: p(0:3)

      limit = law%threshold*beyond
      side = 1
      do
         if (number > size(grid%step)) return
         f = ground_at(grid%step(number), x)
         if (abs(f) > limit) exit
         f = ground_end(grid%step(number))
         if (abs(f) > limit) then
            p = newton_to_powers(grid%step(number)%f)*sign(1.0_wp, f)
            p(0) = p(0) - law%threshold
            begin = x
            call find_root(p, begin, 1.0_wp, x)
            exit
         end if
         number = loud(number + 1)
         x = 0
      end do
      side = merge(-1, 1, f > 0)
   end subroutine find_wake

   !> May the wall be put to rest after an impact?
   !>
   !> Yes, if what is left of the velocity is negligible while the motion presses the wall down
   !> (`may_rest` of `rwmf_model_rest`). Yes as well, whatever the velocity, if the chatter ends by
   !> itself in time: under a pressure p(t) >= p_min > 0 a flight returns with at most sqrt(p_1/p_0)
   !> of its velocity, p_0 and p_1 the least and the largest pressure in it, so that impact number n
   !> leaves at most F w e**n with F = exp(V/2), V the total variation of ln(p); the flights take at
   !> most 2 F w/(p_min (1 - e)) together, and none rises above (F w)**2/(2 p_min). If that is
   !> within the span looked at and below the maximum so far, the true motion has come to rest by
   !> then and has changed nothing.
   pure logical function comes_to_rest(law, grid, loud, number, x, f, w, ordinate) result(rests)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! from `loud_steps`
      integer, intent(in) :: number
      !! of the step
      real(wp), intent(in) :: x
      !! position in it [-]
      real(wp), intent(in) :: f
      !! ground acceleration there [m/s2]
      real(wp), intent(in) :: w
      !! rate of v after the impact [1/s]
      type(ordinate_t), intent(in) :: ordinate
      real(wp), parameter :: round_off = 64*epsilon(1.0_wp)
      real(wp) :: press
      !! deceleration of v [1/s2]
      real(wp) :: chatter
      !! [s]
      real(wp) :: growth
      !! F [-]
      real(wp) :: top
      !! bound of v [-]

      rests = .false.
      press = law%m2*(law%threshold - abs(f))
      if (press <= 0) return
      rests = w <= max(negligible*ordinate%rtol*ordinate%w_max, &
         press*round_off*grid%t(number))
      if (rests .or. law%e >= 1 .or. w**2 > press*ordinate%v_max) return
      chatter = room*2*w/(press*(1 - law%e))
      if (loud(number) < loud(number + 1)) return
      if (loud(number) <= size(grid%t)) then
         if (grid%t(number) + x*grid%step(number)%h + chatter > grid%t(loud(number))) return
      end if
      call press_over(law, grid, number, x, chatter, press, growth)
      if (press <= 0) return
      top = (growth*w)**2/(2*press)
      press = press - hindrance(law, ordinate, growth*w, top)
      rests = 2*growth*w <= press*(1 - law%e)*chatter .and. top <= 0.5_wp*ordinate%v_max
   end function comes_to_rest

   !> Bound of what delays the return of flights that are no faster than w and no higher than v,
   !> beside a weaker pressure [1/s2]; the stiffness only hastens it.
   pure real(wp) function hindrance(law, ordinate, w, v)
      type(fast_law_t), intent(in) :: law
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(in) :: w
      !! [1/s]
      real(wp), intent(in) :: v
      !! [-]

      associate (c => law%bound)
         hindrance = law%m1*ordinate%damping*w + 2*(c(1)*w**2 + v*(c(2)*(ordinate%damping*w &
            + ordinate%stiffness*v) + c(3)*law%threshold + c(4) + abs(law%m3_1)))
      end associate
   end function hindrance

   !> Smallest deceleration of v from a position on for a time, and how much it lets velocities
   !> grow; the acceleration of the ground is monotone within a step.
   pure subroutine press_over(law, grid, number, x, span, press, growth)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(inout) :: press
      !! in: at the position; out: not positive when the wall is let go [1/s2]
      real(wp), intent(out) :: growth
      !! F of `comes_to_rest` [-]
      real(wp) :: t_end
      real(wp) :: least, f, f_last, variation
      real(wp) :: enough
      !! with less, and however steady, the chatter takes longer than the span
      integer :: i

      enough = press/(room*law%m2)
      t_end = grid%t(number) + x*grid%step(number)%h + span
      f_last = ground_at(grid%step(number), x)
      least = law%threshold - abs(f_last)
      variation = 0
      do i = number, size(grid%step) - 1
         if (grid%t(i + 1) >= t_end) exit
         associate (next => grid%step(i + 1))
            variation = variation + (abs(next%f(0) - next%jump - f_last) + abs(next%jump))
            least = min(least, law%threshold - max(abs(next%f(0)), abs(next%f(0) - next%jump)))
            f_last = next%f(0)
         end associate
         if (least <= enough .or. variation > 4*least) exit
      end do
      if (least > enough .and. variation <= 4*least) then
         f = ground_at(grid%step(i), min(1.0_wp, (t_end - grid%t(i))/grid%step(i)%h))
         variation = variation + abs(f - f_last)
         least = min(least, law%threshold - abs(f))
      end if
      press = 0
      growth = 1
      if (least <= enough .or. variation > 4*least) return
      press = law%m2*least
      growth = exp(variation/(2*least))
   end subroutine press_over

end module rwmf_spectrum_fast_rest_rule
