!> Rest and lift-off in the steps of a time grid, by the rules of `rwmf_model_rest`.
module rwmf_spectrum_fast_rest_rule
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_shared_data, only: ordinate_t
   use rwmf_spectrum_fast_taylor_oscillator, only: newton_to_powers, state_at
   use rwmf_spectrum_fast_time_grid, only: ground_at, time_grid_t
   use rwmf_spectrum_fast_types, only: reduced_equation_t
   implicit none
   private

   public :: find_next_uplift, find_rest, velocity_share

   real(wp), parameter :: uplift_margin = 1 + 4*epsilon(1.0_wp)
   !! factor of the threshold that is more than round-off above 1 [-]
   real(wp), parameter :: velocity_share = 0.01_wp
   !! velocity below which the wall may be put to rest, over the largest one and the tolerance [-]
   real(wp), parameter :: span_factor = 3
   !! span examined over the duration of the chatter under a steady pressure [-]

contains

   !> Does a ground acceleration lift the resting wall?
   pure logical function lifts(equation, f)
      type(reduced_equation_t), intent(in) :: equation
      real(wp), intent(in) :: f
      !! [m/s2]

      lifts = abs(f) > uplift_margin*equation%threshold(side_of(f))
   end function lifts

   !> Side on which a ground acceleration lifts the wall: 1 (theta > 0) or 2.
   pure integer function side_of(f)
      real(wp), intent(in) :: f
      !! [m/s2]

      side_of = merge(2, 1, f > 0)
   end function side_of

   !> Deceleration of v with which a ground acceleration returns the wall, on the side that it pulls
   !> it to [1/s2].
   pure real(wp) function pressure_at(equation, f)
      type(reduced_equation_t), intent(in) :: equation
      real(wp), intent(in) :: f
      !! [m/s2]

      pressure_at = equation%m2(side_of(f))*(equation%threshold(side_of(f)) - abs(f))
   end function pressure_at

   !> Find where a wall that rests at the position x of a step lifts off.
   pure subroutine find_next_uplift(equation, grid, number, x, side)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(inout) :: number
      !! number of the step; out: beyond the last one if the wall never lifts off
      real(wp), intent(inout) :: x
      !! position in the step [-]
      integer, intent(out) :: side
      !! to which it lifts off, +1 or -1
      real(wp) :: f, begin, change, rate
      integer :: i

      side = 1
      do number = number, grid%motion_end_step - 1
         if (grid%largest(number) > minval(equation%threshold)) then
            f = ground_at(grid%step(number), x)
            if (lifts(equation, f)) exit
            f = ground_at(grid%step(number), 1.0_wp)
            if (lifts(equation, f)) then
               ! the acceleration is monotone within a step, and a straight line in a record
               begin = x
               do i = 1, 12
                  call state_at(newton_to_powers(grid%step(number)%f), x, change, rate)
                  change = (sign(equation%threshold(side_of(f)), f) - change)/rate
                  x = max(begin, min(x + change, 1.0_wp))
                  if (.not. abs(change) > 2*epsilon(x)) exit
               end do
               exit
            end if
         end if
         x = 0
      end do
      if (number < grid%motion_end_step) then
         side = 3 - 2*side_of(f)
      else
         number = size(grid%step) + 1
      end if
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
   !>
   !> With the ground at rest for good it is enough that no later flight is higher than the largest
   !> so far: v'**2/2 + p v + M1 omega_s**2 v**2/2 does not grow in flight, p the pressure less what
   !> N may take off it, and an impact lowers it.
   pure subroutine find_rest(equation, grid, number, x, f, w, ordinate, rests)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      !! number of the step
      real(wp), intent(in) :: x
      !! position in the step [-]
      real(wp), intent(in) :: f
      !! ground acceleration at that position [m/s2]
      real(wp), intent(in) :: w
      !! rate of v after the impact [1/s]
      type(ordinate_t), intent(inout) :: ordinate
      logical, intent(out) :: rests
      !! it may
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
      pressure = pressure_at(equation, f)
      if (pressure <= 0) return
      rests = w <= max(ordinate%negligible_velocity, pressure*round_off*grid%t(number))
      if (number >= grid%motion_end_step .and. ordinate%v_max <= equation%v_high) then
         associate (v => ordinate%v_max)
            rests = rests .or. w**2 <= v*(2*(pressure - return_delay(equation, ordinate, w, v)) &
               + equation%m1*ordinate%stiffness*v)
         end associate
      end if
      if (rests .or. equation%e >= 1 .or. w**2 > pressure*ordinate%v_max) return
      chatter_span = span_factor*2*w/(pressure*(1 - equation%e))
      call pressure_over(equation, grid, number, x, chatter_span, ordinate%uplift, pressure, &
         growth)
      if (pressure <= 0) return
      v_bound = (growth*w)**2/(2*pressure)
      pressure = pressure - return_delay(equation, ordinate, growth*w, v_bound)
      rests = 2*growth*w <= pressure*(1 - equation%e)*chatter_span &
         .and. v_bound <= 0.5_wp*ordinate%v_max
   end subroutine find_rest

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
         return_delay = (equation%m1*ordinate%damping + equation%m4)*w + 2*(c(1)*w**2 &
            + v*(c(2)*(ordinate%damping*w + ordinate%stiffness*v) &
            + c(3)*maxval(equation%threshold) + c(4) + c(5)*w + abs(equation%m3_1)))
      end associate
   end function return_delay

   !> Least deceleration of v within a span from a position on, and the growth of velocities that
   !> its variation allows. The ground acceleration is monotone within a step.
   pure subroutine pressure_over(equation, grid, number, x, span, uplift, pressure, growth)
      type(reduced_equation_t), intent(in) :: equation
      type(time_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: span
      !! [s]
      integer, intent(inout) :: uplift
      !! no step before this one, after that of the position, lifts the wall
      real(wp), intent(inout) :: pressure
      !! at the position; on return the least one, not positive if the bound does not hold [1/s2]
      real(wp), intent(out) :: growth
      !! F of `find_rest` [-]
      real(wp) :: t_end, f, f_begin, largest, variation
      real(wp) :: largest_useful
      !! acceleration of the ground with which even a steady chatter outlasts the span [m/s2]
      integer :: i

      t_end = grid%t(number) + x*grid%step(number)%h + span
      growth = 1
      associate (m2 => maxval(equation%m2), threshold => minval(equation%threshold))
         largest_useful = threshold - pressure/(span_factor*m2)
         ! most often a later step lifts the wall
         do uplift = max(uplift, number + 1), size(grid%step)
            if (grid%t(uplift) >= t_end .or. grid%largest(uplift) > threshold) exit
         end do
         if (uplift <= size(grid%step)) then
            if (grid%t(uplift) < t_end) pressure = 0
         end if
         if (pressure <= 0) return
         f_begin = ground_at(grid%step(number), x)
         largest = abs(f_begin)
         variation = 0
         do i = number, size(grid%step)
            associate (step => grid%step(i))
               if (i > number) then
                  f_begin = step%f(0)
                  largest = max(largest, abs(f_begin), abs(f_begin - step%jump))
                  variation = variation + abs(step%jump)
               end if
               f = ground_at(step, min(1.0_wp, (t_end - grid%t(i))/step%h))
               largest = max(largest, abs(f))
               variation = variation + abs(f - f_begin)
               if (grid%t(i) + step%h >= t_end .or. largest > largest_useful) exit
            end associate
         end do
         pressure = min(pressure, m2*(threshold - largest))
         variation = m2*variation
         if (largest > largest_useful .or. variation > 4*pressure) pressure = 0
         if (pressure > 0) growth = exp(variation/(2*pressure))
      end associate
   end subroutine pressure_over

end module rwmf_spectrum_fast_rest_rule
