!> Rest and lift-off in the steps of a time grid; the rules are those of `rwmf_model_rest`.
module rwmf_spectrum_fast_rest_rule
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_taylor_oscillator, only: find_root, newton_to_powers
   use rwmf_spectrum_fast_time_grid, only: ground_at, ground_end, time_grid_t
   use rwmf_spectrum_fast_types, only: reduced_equation_t
   implicit none
   private

   public :: find_next_uplift, comes_to_rest, velocity_share

   real(wp), parameter :: uplift_margin = 1 + 4*epsilon(1.0_wp)
   !! factor of the threshold that is more than round-off above 1 [-]
   real(wp), parameter :: velocity_share = 0.01_wp
   !! velocity below which the wall may be put to rest, over the largest one and the tolerance [-]
   real(wp), parameter :: span_factor = 3
   !! span examined over the duration of the chatter under a steady pressure [-]

contains

   !> Find where a wall that rests at the position x of a step lifts off.
   pure subroutine find_next_uplift(equation, grid, uplift, number, x, side)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(in) :: uplift(:)
      !! from `uplift_steps`
      integer, intent(inout) :: number
      !! number of the step; out: beyond the last one if the wall never lifts off
      real(wp), intent(inout) :: x
      !! position in the step [-]
      integer, intent(out) :: side
      !! to which it lifts off, +1 or -1
      real(wp) :: begin
      real(wp) :: limit
      real(wp) :: f
      real(wp) :: p(0:3)

      limit = equation%threshold*uplift_margin
      side = 1
      do
         if (number > size(grid%step)) return
         f = ground_at(grid%step(number), x)
         if (abs(f) > limit) exit
         f = ground_end(grid%step(number))
         if (abs(f) > limit) then
            p = newton_to_powers(grid%step(number)%f)*sign(1.0_wp, f)
            p(0) = p(0) - equation%threshold
            begin = x
            call find_root(p, begin, 1.0_wp, x)
            exit
         end if
         number = uplift(number + 1)
         x = 0
      end do
      side = merge(-1, 1, f > 0)
   end subroutine find_next_uplift

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
   pure logical function comes_to_rest(equation, grid, uplift, number, x, f, w, ordinate) &
      result(rests)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(in) :: uplift(:)
      !! from `uplift_steps`
      integer, intent(in) :: number
      !! number of the step
      real(wp), intent(in) :: x
      !! position in the step [-]
      real(wp), intent(in) :: f
      !! ground acceleration at that position [m/s2]
      real(wp), intent(in) :: w
      !! rate of v after the impact [1/s]
      type(ordinate_t), intent(in) :: ordinate
      real(wp), parameter :: round_off = 64*epsilon(1.0_wp)
      real(wp) :: pressure
      !! deceleration of v [1/s2]
      real(wp) :: chatter_span
      !! span in which the chatter has to end [s]
      real(wp) :: growth
      !! bound F of the growth of velocities [-]
      real(wp) :: v_bound
      !! bound of v [-]

      rests = .false.
      pressure = equation%m2*(equation%threshold - abs(f))
      if (pressure <= 0) return
      rests = w <= max(velocity_share*ordinate%rtol*ordinate%w_max, &
         pressure*round_off*grid%t(number))
      if (rests .or. equation%e >= 1 .or. w**2 > pressure*ordinate%v_max) return
      chatter_span = span_factor*2*w/(pressure*(1 - equation%e))
      if (uplift(number) < uplift(number + 1)) return
      if (uplift(number) <= size(grid%t)) then
         if (grid%t(number) + x*grid%step(number)%h + chatter_span > grid%t(uplift(number))) return
      end if
      call pressure_over(equation, grid, number, x, chatter_span, pressure, growth)
      if (pressure <= 0) return
      v_bound = (growth*w)**2/(2*pressure)
      pressure = pressure - return_delay(equation, ordinate, growth*w, v_bound)
      rests = 2*growth*w <= pressure*(1 - equation%e)*chatter_span &
         .and. v_bound <= 0.5_wp*ordinate%v_max
   end function comes_to_rest

   !> Bound of the accelerations, beside a weaker pressure, that delay the return of flights no
   !> faster than w and no higher than v [1/s2]; the stiffness only hastens it.
   pure real(wp) function return_delay(equation, ordinate, w, v)
      type(reduced_equation_t), intent(in) :: equation
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(in) :: w
      !! [1/s]
      real(wp), intent(in) :: v
      !! [-]

      associate (c => equation%bound)
         return_delay = equation%m1*ordinate%damping*w + 2*(c(1)*w**2 &
            + v*(c(2)*(ordinate%damping*w + ordinate%stiffness*v) + c(3)*equation%threshold + c(4) &
            + abs(equation%m3_1)))
      end associate
   end function return_delay

   !> Least deceleration of v within a span from a position on, and the growth of velocities that
   !> its variation allows. The ground acceleration is monotone within a step.
   pure subroutine pressure_over(equation, grid, number, x, span, pressure, growth)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(inout) :: pressure
      !! in: at the position; out: the least one, not positive if the bound does not hold [1/s2]
      real(wp), intent(out) :: growth
      !! F of `comes_to_rest` [-]
      real(wp) :: t_end
      real(wp) :: lowest, f, f_last, variation
      real(wp) :: least_useful
      !! acceleration of the ground below the threshold with which even a steady chatter outlasts
      !! the span [m/s2]
      integer :: i

      least_useful = pressure/(span_factor*equation%m2)
      t_end = grid%t(number) + x*grid%step(number)%h + span
      f_last = ground_at(grid%step(number), x)
      lowest = equation%threshold - abs(f_last)
      variation = 0
      do i = number, size(grid%step) - 1
         if (grid%t(i + 1) >= t_end) exit
         associate (next => grid%step(i + 1))
            variation = variation + (abs(next%f(0) - next%jump - f_last) + abs(next%jump))
            lowest = min(lowest, equation%threshold - max(abs(next%f(0)), &
               abs(next%f(0) - next%jump)))
            f_last = next%f(0)
         end associate
         if (lowest <= least_useful .or. variation > 4*lowest) exit
      end do
      if (lowest > least_useful .and. variation <= 4*lowest) then
         f = ground_at(grid%step(i), min(1.0_wp, (t_end - grid%t(i))/grid%step(i)%h))
         variation = variation + abs(f - f_last)
         lowest = min(lowest, equation%threshold - abs(f))
      end if
      pressure = 0
      growth = 1
      if (lowest <= least_useful .or. variation > 4*lowest) return
      pressure = equation%m2*lowest
      growth = exp(variation/(2*lowest))
   end subroutine pressure_over

end module rwmf_spectrum_fast_rest_rule
