!> Step lengths of lanes, and acceptance of steps that need no inspection.
module rwmf_integrator_lane_control
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: at_limit, column_count, is_done, is_rejected, &
      line_columns, needs_inspection, of_bottom, of_fastest, of_target, of_high, of_interval, &
      of_least, &
      of_length, of_limit, of_line, of_longest, of_low, of_most, of_rejected, of_steps, of_time, &
      of_max_rate, of_top, of_trial, of_vertical_line, of_inspection
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_model_lanes, only: lane_count
   implicit none
   private

   public :: plan_step, accept_or_reject, advance_intervals

contains

   !> Compute the length of the next step of each lane and the ground acceleration on straight lines
   !> at the nodes. The length is an equal share of the time to the limit, so that no sliver
   !> remains.
   pure subroutine plan_step(pair, table, ground)
      type(pair_t), intent(in) :: pair
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`; sets
      !! `of_trial`
      real(wp), intent(out) :: ground(lane_count, most_stages, 2)
      !! accelerations at the nodes, horizontal and vertical [m/s2]
      real(wp) :: rest, length
      real(wp), dimension(lane_count) :: line, vertical_line
      !! accelerations at the beginning [m/s2]
      real(wp), dimension(lane_count) :: rise, vertical_rise
      !! growth of the accelerations in the step [m/s2]
      integer :: i, s

      !$omp simd private(rest, length)
      do i = 1, lane_count
         rest = table(i, of_limit) - table(i, of_time)
         ! an idle lane gets any nonzero length, as a divisor
         length = merge(min(table(i, of_length), rest), 1.0_wp, table(i, of_length) > 0)
         ! a length far below the remaining time needs no equal parts
         length = merge(length, rest/max(1.0_wp, aint(rest/length*(1 - 1.0e-12_wp)) + 1), &
            length < 1.0e-8_wp*rest)
         length = merge(table(i, of_target), length, table(i, of_target) > 0)
         length = merge(length, 0.0_wp, table(i, of_length) > 0)
         table(i, of_trial) = length
         rest = table(i, of_time) - table(i, of_line + 2)
         line(i) = table(i, of_line) + table(i, of_line + 1)*rest
         rise(i) = table(i, of_line + 1)*length
         vertical_line(i) = table(i, of_vertical_line) + table(i, of_vertical_line + 1)*rest
         vertical_rise(i) = table(i, of_vertical_line + 1)*length
      end do
      do s = 1, pair%stages
         !$omp simd
         do i = 1, lane_count
            ground(i, s, 1) = line(i) + pair%c(s)*rise(i)
            ground(i, s, 2) = vertical_line(i) + pair%c(s)*vertical_rise(i)
         end do
      end do
   end subroutine plan_step

   !> Accept the accurate steps without an event and set the lengths of the next ones.
   !>
   !> An event is possible where a state leaves its window. It is also possible where theta' may
   !> change its sign, unless a bound of the turning point is inside the window. Both bounds are
   !> coefficients in Bernstein form of the quartic through both ends, both velocities and the
   !> acceleration at the beginning. They include its error (as in `rwmf_math_sign_changes`) for
   !> vibrations of up to 1.4 rad in a step.
   subroutine accept_or_reject(n, further, table, y, y_dot, y_new, error, mark)
      integer, intent(in) :: n
      !! number of states
      integer, intent(in) :: further
      !! number of the state with a window besides the rotation
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`
      real(wp), intent(inout) :: y(lane_count, n)
      !! states at the beginnings; on return at the ends of accepted steps
      real(wp), intent(in) :: y_dot(lane_count, n)
      !! rates of the states at the beginning
      real(wp), intent(in) :: y_new(lane_count, n)
      !! states at the ends of the attempted steps
      real(wp), intent(in) :: error(lane_count)
      !! square of the norm of the local error over the tolerance; accurate up to 1 [-]
      integer, intent(out) :: mark(lane_count)
      !! `is_done`, `is_rejected`, `needs_inspection` or `at_limit`
      real(wp) :: h, h_new, way, begin, end, reach, lowest, top, bottom, slack
      real(wp) :: first, second
      !! coefficients of theta' in the middle of the step, times its length like all rates [rad]
      real(wp) :: bend, last_bend
      !! second differences of these coefficients [rad]
      ! 1 for true, 0 for false: logical variables would prevent vectorisation of the loop
      real(wp) :: is_accurate, is_inside, turns, is_far
      real(wp) :: is_plain(lane_count), growth(lane_count)
      integer :: i, m

      call find_growth(error, growth)
      !$omp simd private(h, h_new, way, begin, end, reach, lowest, top, bottom, slack, first) &
      !$omp& private(second, bend, last_bend, is_accurate, is_inside, turns, is_far)
      do i = 1, lane_count
         h = table(i, of_trial)
         is_accurate = merge(1.0_wp, 0.0_wp, error(i) <= 1)
         h_new = h*min(6.0_wp, 0.9_wp*growth(i))
         h_new = merge(min(h_new, h), max(h_new, merge(table(i, of_length), 0.0_wp, &
            h < table(i, of_length))), table(i, of_rejected) > 0)
         h_new = merge(h_new, h*max(0.1_wp, min(0.9_wp, 0.9_wp*growth(i))), is_accurate > 0)
         table(i, of_length) = min(h_new, table(i, of_longest))
         table(i, of_rejected) = 1 - is_accurate
         begin = h*y(i, 2)
         end = h*y_new(i, 2)
         way = y_new(i, 1) - y(i, 1)
         reach = 0.25_wp*(abs(begin) + abs(end))
         first = begin + (1/3.0_wp)*(h*h*y_dot(i, 2))
         second = 4*way - begin - first - end
         bend = second - 2*first + begin
         last_bend = end - 2*second + first
         slack = 0.035_wp*abs(last_bend - bend) + 0.05_wp*max(abs(bend), abs(last_bend))
         ! smallest theta' of a step that begins upwards
         lowest = sign(1.0_wp, begin)
         lowest = min(abs(begin), lowest*(begin + 3*first), lowest*(first + second) - 2*slack, &
            lowest*(3*second + end) - 4*slack, lowest*end)
         turns = merge(1.0_wp, 0.0_wp, lowest <= 0)
         slack = 0.2_wp*slack
         bottom = y(i, 1) + 0.25_wp*begin
         first = bottom + 0.25_wp*first
         second = first + 0.25_wp*second
         top = max(max(y(i, 1), y_new(i, 1)) + reach, max(bottom, first, second) + slack)
         bottom = min(min(y(i, 1), y_new(i, 1)) - reach, min(bottom, first, second) - slack)
         is_inside = merge(1.0_wp, 0.0_wp, max(table(i, of_low) - y_new(i, 1), y_new(i, 1) &
            - table(i, of_high), table(i, of_inspection) - 0.5_wp) < 0)
         is_inside = merge(is_inside, 0.0_wp, max(table(i, of_least) - y_new(i, further), &
            y_new(i, further) - table(i, of_most)) <= 0)
         is_far = merge(1.0_wp, 0.0_wp, max(top - min(table(i, of_top), table(i, of_high)), &
            max(table(i, of_bottom), table(i, of_low)) - bottom) < 0)
         is_plain(i) = is_accurate*is_inside*max(1 - turns, is_far)
         table(i, of_fastest) = merge(max(table(i, of_fastest), abs(y_new(i, 2))), &
            table(i, of_fastest), is_plain(i) > 0)
         h_new = merge(table(i, of_limit), table(i, of_time) + h, &
            h >= table(i, of_limit) - table(i, of_time))
         table(i, of_time) = merge(h_new, table(i, of_time), is_plain(i) > 0)
         table(i, of_steps) = table(i, of_steps) + is_plain(i)
         mark(i) = int(merge(merge(real(at_limit, wp), real(is_done, wp), table(i, of_time) &
            >= table(i, of_limit)), merge(real(needs_inspection, wp), real(is_rejected, wp), &
            is_accurate > 0), is_plain(i) > 0))
      end do
      ! only smooth hysteresis, which has the further state, limits the rate
      if (further > 1) call limit_rate(n, y, y_new, table)
      do m = 1, n
         !$omp simd
         do i = 1, lane_count
            y(i, m) = merge(y_new(i, m), y(i, m), is_plain(i) > 0)
         end do
      end do
   end subroutine accept_or_reject

   !> Compute the factor on each step length: the inverse eighth root of the norm of the error.
   !>
   !> The factor is accurate to 4 %; it is 0 where the error is not finite. The bits of a positive
   !> number are nearly its logarithm to the base 2. Roots and divisions would take as long as the
   !> rest of `accept_or_reject`.
   pure subroutine find_growth(error, growth)
      real(wp), intent(in) :: error(lane_count)
      !! square of the norm of the local error over the tolerance [-]
      real(wp), intent(out) :: growth(lane_count)
      !! [-]
      integer(int64), parameter :: one = 17_int64*(1023_int64*2_int64**48) - 6_int64*2_int64**45
      !! bits of 1 and a sixteenth of them, less half of the largest error of the logarithm
      real(real64) :: number(lane_count)
      integer(int64) :: bits(lane_count)
      integer :: i

      !$omp simd
      do i = 1, lane_count
         number(i) = real(max(error(i), real(tiny(number), wp)), real64)
      end do
      bits = transfer(number, bits)
      !$omp simd
      do i = 1, lane_count
         bits(i) = one - shiftr(bits(i), 4)
      end do
      number = transfer(bits, number)
      !$omp simd
      do i = 1, lane_count
         growth(i) = merge(real(number(i), wp), 0.0_wp, error(i) < huge(error))
      end do
   end subroutine find_growth

   !> Limit the next step lengths while a hysteretic state relaxes to its bound.
   pure subroutine limit_rate(n, y, y_new, table)
      integer, intent(in) :: n
      !! number of states
      real(wp), intent(in) :: y(lane_count, n), y_new(lane_count, n)
      !! states at both ends of the steps
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`
      integer :: i

      !$omp simd
      do i = 1, lane_count
         table(i, of_length) = min(table(i, of_length), 1/max(tiny(y), table(i, of_max_rate) &
            *max(abs(y(i, 2)), abs(y_new(i, 2)))))
      end do
   end subroutine limit_rate

   !> Move lanes at their limits to the next interval of the motion, if that interval is a straight
   !> line with its own limit.
   pure subroutine advance_intervals(intervals, lines, table, mark)
      integer, intent(in) :: intervals
      !! number of the last known interval
      real(wp), intent(in) :: lines(line_columns, 0:intervals + 1)
      !! (line_columns, intervals) limit [s] (negative if unknown or beyond the last interval), a_0,
      !! slope, t_0, vertical a_0, vertical slope
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`
      integer, intent(inout) :: mark(lane_count)
      !! `at_limit`; on return `is_done` after the knot
      integer :: i, next

      do i = 1, lane_count
         if (mark(i) /= at_limit) cycle
         next = min(int(table(i, of_interval)), intervals) + 1
         if (.not. lines(1, next) > table(i, of_time)) cycle
         table(i, of_interval) = next
         table(i, of_limit) = lines(1, next)
         table(i, of_line) = lines(2, next)
         table(i, of_line + 1) = lines(3, next)
         table(i, of_line + 2) = lines(4, next)
         table(i, of_vertical_line) = lines(5, next)
         table(i, of_vertical_line + 1) = lines(6, next)
         mark(i) = is_done
      end do
   end subroutine advance_intervals

end module rwmf_integrator_lane_control
