!> Detection of lane steps that cannot contain an extremum of reactions and demands.
module rwmf_integrator_lane_screens
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: at_limit, column_count, is_done, of_calm, &
      of_fastest_demand, of_frequency, of_ground_end, of_known, of_middle, of_plain, of_trial, &
      screen_t
   use rwmf_integrator_pairs, only: most_stages
   use rwmf_model_system_demands_loop, only: demand_constants, lane_demands, section_terms, sections
   use rwmf_model_system_reactions_loop, only: demand, lane_reactions, low_normal, reaction_count
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: force_parts_t
   implicit none
   private

   public :: screen_steps
   public :: so_far, least_so_far, value_count

   integer, parameter :: at_begin = 1
   integer, parameter :: at_middle = 2
   integer, parameter :: at_end = 3
   !! indices of the values at the ends and the middle of a step
   integer, parameter :: so_far = 4
   !! index of the largest value so far
   integer, parameter :: least_so_far = 5
   !! index of the smallest value so far, for the range
   integer, parameter :: value_count = 5

   real(wp), parameter :: unknown = sqrt(huge(1.0_wp))
   !! value at the beginning of a step after a jump of the ground

   real(wp), parameter :: rise = 0.25_wp
   !! largest rise of a peak above three samples, over their range [-]
   real(wp), parameter :: steep = 0.6_wp
   !! least change over a step by the slope at an end, over the range of three samples [-]
   real(wp), parameter :: slack = 0.01_wp
   !! margin over the range so far [-]
   real(wp), parameter :: least_range = 0.25_wp
   !! least range so far over the magnitude of the level: after a start or an event, a vibration has
   !! not shown its range yet [-]
   real(wp), parameter :: cap = sqrt(sqrt(huge(1.0_wp)))
   !! bound of the factors of a product
   real(wp), parameter :: same = 1.0e-8_wp
   !! relative difference between two procedures that compute the same value [-]

contains

   !> Compute reactions and demands in the attempted steps of all lanes, and mark the steps without
   !> an extremum.
   !>
   !> The values at the end of a step are those at the beginning of the next one, unless the ground
   !> jumps in between. The state in the middle is found from the cubic through states and rates.
   subroutine screen_steps(parts, screen, last, constants, coef, y, k, y_new, ground, mark, table, &
      values)
      type(force_parts_t), intent(in) :: parts
      !! complete
      type(screen_t), intent(in) :: screen
      integer, intent(in) :: last
      !! stage at the end of the step
      real(wp), intent(in) :: constants(lane_count, demand_constants(screen%demands))
      !! constants of the buildings from `put_constants`, each in its unit
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, for the current side and branches
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states) at the beginning
      real(wp), intent(in) :: k(lane_count, parts%through_link%n, most_stages)
      !! rates of the states at the nodes
      real(wp), intent(in) :: y_new(lane_count, parts%through_link%n)
      !! (states) at the end
      real(wp), intent(in) :: ground(lane_count, most_stages, 2)
      !! acceleration of the ground at the nodes, horizontal and vertical [m/s2]
      integer, intent(in) :: mark(lane_count)
      !! results of the steps before
      real(wp), intent(inout) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`; sets
      !! `of_ground_end`, `of_known`, `of_plain` and `of_calm` (0.5 if values grow up to the end)
      real(wp), intent(inout) :: values(lane_count, screen%columns, value_count)
      !! reactions and demands, in the units of `lane_demands`, at both ends and in the middle;
      !! their extremes so far are kept
      real(wp), dimension(lane_count) :: angle, demand_angle, turning
      real(wp) :: at(lane_count, 2), y_middle(lane_count, parts%through_link%n)
      integer :: i, m

      if (any(table(:, of_known) < 1)) then
         at = ground(:, 1, :)
         call find_values(parts, screen, constants, coef, y, at, values(1, 1, at_middle))
         call begin_anew(screen, at, table, values)
      end if
      call begin_at_end(screen, ground(:, [1, last], :), mark, table, values)
      turning = 0
      ! forces of a wall contain sines and cosines of twice its rotation
      if (parts%through_link%has_wall) turning = 2*max(abs(y(:, 2)), abs(y_new(:, 2)))
      angle = table(:, of_trial)*max(table(:, of_frequency), turning)
      demand_angle = table(:, of_trial)*max(table(:, of_fastest_demand), turning)
      at = ground(:, last, :)
      call find_values(parts, screen, constants, coef, y_new, at, values(1, 1, at_end))
      call find_low_ends(screen, angle, values, 1, reaction_count, parts, table(1, of_plain))
      call find_low_ends(screen, demand_angle, values, reaction_count + 1, screen%n, parts, &
         table(1, of_calm))
      if (all(min(table(:, of_plain), table(:, of_calm)) > 0 .or. table(:, of_trial) <= 0)) return
      do m = 1, parts%through_link%n
         !$omp simd
         do i = 1, lane_count
            y_middle(i, m) = (y(i, m) + y_new(i, m))/2 + table(i, of_trial)/8*(k(i, m, 1) &
               - k(i, m, last))
         end do
      end do
      at = table(:, of_middle:of_middle + 1)
      call find_values(parts, screen, constants, coef, y_middle, at, values(1, 1, at_middle))
      call find_flat_steps(screen, angle, values, 1, reaction_count, parts, turning)
      table(:, of_plain) = max(table(:, of_plain), aint(turning))
      call find_flat_steps(screen, demand_angle, values, reaction_count + 1, screen%n, parts, &
         turning)
      table(:, of_calm) = max(table(:, of_calm), turning)
   end subroutine screen_steps

   !> Find the short steps whose ends alone exclude an extremum of some values.
   !>
   !> A vibration through a small angle rises above both ends by a part of its amplitude, less than
   !> the square of the angle.
   pure subroutine find_low_ends(screen, angle, values, first, final, parts, is_flat)
      type(screen_t), intent(in) :: screen
      real(wp), intent(in) :: angle(lane_count)
      !! phase angle of the fastest vibration of the scene over the step [rad]
      real(wp), intent(in) :: values(lane_count, screen%columns, value_count)
      !! those in the middle may be undefined
      integer, intent(in) :: first, final
      !! range of the values to check
      type(force_parts_t), intent(in) :: parts
      real(wp), intent(out) :: is_flat(lane_count)
      !! 1 if the step has no extremum, 0 if it may have one
      real(wp), parameter :: short_angle = 0.4_wp
      !! longest phase angle of a short step [rad]
      real(wp), parameter :: least_rise = 0.02_wp, rise_by_angle = 1.6_wp
      !! possible rise above the ends over the range so far: least, and over the angle squared [-]
      real(wp) :: margin(lane_count), a, c, level, range
      logical :: is_magnitude
      integer :: i, q

      !$omp simd
      do i = 1, lane_count
         is_flat(i) = merge(1.0_wp, 0.0_wp, angle(i) < short_angle)
         margin(i) = max(least_rise, rise_by_angle*angle(i)*angle(i))
      end do
      do q = first, final
         if (.not. screen%has_search(q)) cycle
         if (q == demand .and. is_quotient(parts)) then
            call check_quotient_at_ends(screen%columns, margin, values, is_flat)
            cycle
         end if
         is_magnitude = q /= low_normal
         !$omp simd private(a, c, level, range)
         do i = 1, lane_count
            a = merge(abs(values(i, q, at_begin)), values(i, q, at_begin), is_magnitude)
            c = merge(abs(values(i, q, at_end)), values(i, q, at_end), is_magnitude)
            level = values(i, q, so_far)
            range = level - values(i, q, least_so_far)
            is_flat(i) = min(is_flat(i), merge(merge(1.0_wp, 0.0_wp, max(a, c) &
               + margin(i)*max(range, least_range*abs(level)) <= level), 0.0_wp, range >= 0))
         end do
      end do
   end subroutine find_low_ends

   !> Begin with the values in `at_middle` where no step has ended at the start of this one.
   pure subroutine begin_anew(screen, ground, table, values)
      type(screen_t), intent(in) :: screen
      real(wp), intent(in) :: ground(lane_count, 2)
      !! acceleration of the ground at the start [m/s2]
      real(wp), intent(inout) :: table(lane_count, column_count)
      real(wp), intent(inout) :: values(lane_count, screen%columns, value_count)
      integer :: i, q

      do q = 1, screen%columns
         if (.not. screen%is_used(q)) cycle
         !$omp simd
         do i = 1, lane_count
            values(i, q, at_begin) = merge(values(i, q, at_begin), values(i, q, at_middle), &
               table(i, of_known) > 0)
            values(i, q, at_end) = merge(values(i, q, at_end), values(i, q, at_middle), &
               table(i, of_known) > 0)
         end do
      end do
      !$omp simd
      do i = 1, lane_count
         table(i, of_ground_end) = merge(table(i, of_ground_end), ground(i, 1), &
            table(i, of_known) > 0)
         table(i, of_ground_end + 1) = merge(table(i, of_ground_end + 1), ground(i, 2), &
            table(i, of_known) > 0)
         table(i, of_known) = 1
      end do
   end subroutine begin_anew

   !> Copy the values at the ends of accepted steps to the beginnings of the next ones.
   pure subroutine begin_at_end(screen, ground, mark, table, values)
      type(screen_t), intent(in) :: screen
      real(wp), intent(in) :: ground(lane_count, 2, 2)
      !! acceleration of the ground at both ends of the step [m/s2]
      integer, intent(in) :: mark(lane_count)
      real(wp), intent(inout) :: table(lane_count, column_count)
      real(wp), intent(inout) :: values(lane_count, screen%columns, value_count)
      real(wp), parameter :: slack = 1.0e-9_wp
      real(wp), dimension(lane_count) :: is_passed, jump
      integer :: i, m, q

      !$omp simd
      do i = 1, lane_count
         is_passed(i) = merge(1.0_wp, 0.0_wp, mark(i) == is_done .or. mark(i) == at_limit)
         jump(i) = 0
      end do
      do m = 1, 2
         !$omp simd
         do i = 1, lane_count
            jump(i) = max(jump(i), is_passed(i)*(abs(ground(i, 1, m) - table(i, of_ground_end + m &
               - 1)) - slack*(abs(ground(i, 1, m)) + abs(ground(i, 2, m)))))
            table(i, of_ground_end + m - 1) = ground(i, 2, m)
         end do
      end do
      do q = 1, screen%columns
         if (.not. screen%is_used(q)) cycle
         !$omp simd
         do i = 1, lane_count
            values(i, q, at_begin) = merge(merge(unknown, values(i, q, at_end), jump(i) > 0), &
               values(i, q, at_begin), is_passed(i) > 0)
         end do
      end do
   end subroutine begin_at_end

   !> Check the ends of short steps for an extremum of the quotient |H|/N, by bounds of |H| and N.
   pure subroutine check_quotient_at_ends(columns, margin, values, is_flat)
      integer, intent(in) :: columns
      !! number of values and coefficients
      real(wp), intent(in) :: margin(lane_count)
      !! possible rise above the ends over the range so far [-]
      real(wp), intent(in) :: values(lane_count, columns, value_count)
      real(wp), intent(inout) :: is_flat(lane_count)
      !! as in `find_low_ends`
      real(wp) :: a, c, top, low, level, range
      integer :: i

      !$omp simd private(a, c, top, low, level, range)
      do i = 1, lane_count
         a = -max(-cap, min(values(i, low_normal, at_begin), cap))
         c = -max(-cap, min(values(i, low_normal, at_end), cap))
         level = min(values(i, demand, so_far), cap)
         range = values(i, low_normal, so_far) - values(i, low_normal, least_so_far)
         low = min(a, c) - margin(i)*max(range, least_range*abs(values(i, low_normal, so_far)))
         ! |H| departs from its ends by a part of its range, which is less than the largest quotient
         ! times the largest N
         top = max(abs(a*max(-cap, min(values(i, demand, at_begin), cap))), &
            abs(c*max(-cap, min(values(i, demand, at_end), cap))))
         top = top + margin(i)*level*min(-values(i, low_normal, least_so_far), cap)
         ! a pivot that lifts has the largest possible demand
         top = merge(-1.0_wp, merge(top, 2*cap*cap, low > 0 .and. range >= 0), level >= cap)
         is_flat(i) = merge(is_flat(i), 0.0_wp, top <= level*max(low, 0.0_wp))
      end do
   end subroutine check_quotient_at_ends

   !> Compute reactions, and demands if requested, of moving lanes; arguments and units are those of
   !> `lane_demands`.
   subroutine find_values(parts, screen, constants, coef, y, ground, found)
      type(force_parts_t), intent(in) :: parts
      type(screen_t), intent(in) :: screen
      real(wp), intent(in) :: constants(lane_count, demand_constants(screen%demands))
      !! each in its unit
      real(wp), intent(in) :: coef(lane_count, parts%through_link%n_coef)
      !! coefficients of the loops, each in its unit
      real(wp), intent(in) :: y(lane_count, parts%through_link%n)
      !! (states)
      real(wp), intent(in) :: ground(lane_count, 2)
      !! [m/s2]
      real(wp), intent(out) :: found(lane_count, screen%columns)
      !! each in its unit

      if (screen%has_demands) then
         call lane_demands(parts, screen%demands, constants, coef, y, ground, found)
      else
         call lane_reactions(parts, coef, y, ground, found)
      end if
   end subroutine find_values

   !> Find the steps that cannot contain an extremum of some values. Their three samples are below
   !> the largest magnitude so far by more than a peak can exceed them. This excess is an eighth of
   !> the range for a parabola, or for a vibration through up to `longest_angle`.
   pure subroutine find_flat_steps(screen, angle, values, first, final, parts, is_flat)
      type(screen_t), intent(in) :: screen
      real(wp), intent(in) :: angle(lane_count)
      !! phase angle of the fastest vibration of the scene over the step [rad]
      real(wp), intent(in) :: values(lane_count, screen%columns, value_count)
      integer, intent(in) :: first, final
      !! range of the values to check
      type(force_parts_t), intent(in) :: parts
      real(wp), intent(out) :: is_flat(lane_count)
      !! 1 if the step has no extremum, 0 if it may have one; 0.5 if values grow up to the end
      real(wp), parameter :: longest_angle = 1.5_wp
      !! longest phase angle of a step [rad]
      real(wp), parameter :: longest_slope = 0.75_wp
      !! longest phase angle of a step whose samples give the slopes at the ends [rad]. Forces
      !! contain squares of velocities, which vary at twice the frequency.
      real(wp) :: has_slopes(lane_count)
      integer :: i, m, q

      !$omp simd
      do i = 1, lane_count
         is_flat(i) = merge(1.0_wp, 0.0_wp, angle(i) < longest_angle)
         has_slopes(i) = merge(1.0_wp, 0.0_wp, angle(i) < longest_slope)
      end do
      do q = first, final
         if (.not. screen%has_search(q)) cycle
         if (q == demand .and. is_quotient(parts)) then
            call check_quotient(screen%columns, values, is_flat)
         else if (q > screen%n - sections .and. first > demand) then
            m = q - (screen%n - sections)
            call check_section(screen%columns, values, has_slopes, q, screen%n &
               + section_terms*(m - 1) + 1, is_flat)
         else
            call check_value(screen%columns, values, has_slopes, q, is_flat)
         end if
      end do
   end subroutine find_flat_steps

   !> Check the steps for an extremum of one value; except for -N, of its magnitude.
   !>
   !> A magnitude that falls from the largest so far, by the parabola through the samples, has no
   !> other peak either.
   pure subroutine check_value(columns, values, has_slopes, q, is_flat)
      integer, intent(in) :: columns
      !! number of values and coefficients
      real(wp), intent(in) :: values(lane_count, columns, value_count)
      real(wp), intent(in) :: has_slopes(lane_count)
      !! 1 if the samples are dense enough for slopes, otherwise 0
      integer, intent(in) :: q
      !! number of the value
      real(wp), intent(inout) :: is_flat(lane_count)
      !! as in `find_flat_steps`
      real(wp) :: a, b, c, begin, end, top, spread, low, level, range, grows, falls
      logical :: is_magnitude
      integer :: i

      is_magnitude = q /= low_normal
      !$omp simd private(a, b, c, begin, end, top, spread, low, level, range, grows, falls)
      do i = 1, lane_count
         a = values(i, q, at_begin)
         b = values(i, q, at_middle)
         c = values(i, q, at_end)
         level = values(i, q, so_far)
         range = level - values(i, q, least_so_far)
         spread = max(a, b, c) - min(a, b, c)
         low = rise*spread
         begin = merge(abs(a), a, is_magnitude)
         end = merge(abs(c), c, is_magnitude)
         top = merge(max(begin, abs(b), end), max(a, b, c), is_magnitude)
         ! slopes of the parabola at both ends, away from zero
         grows = merge(sign(1.0_wp, c), 1.0_wp, is_magnitude)
         grows = min(grows*(3*c - 4*b + a), grows*(4*b - 3*a - c))
         falls = merge(sign(1.0_wp, a), 1.0_wp, is_magnitude)
         falls = max(falls*(3*c - 4*b + a), falls*(4*b - 3*a - c))
         grows = merge(0.5_wp, 0.0_wp, min(grows - steep*spread, end - begin) > 0)*has_slopes(i)
         falls = merge(1.0_wp, 0.0_wp, max(falls + steep*spread, end - begin, &
            begin - level - same*abs(level)) < 0)*has_slopes(i)
         top = merge(1.0_wp, max(grows, falls), top + low + slack*max(range, 0.0_wp) <= level)
         is_flat(i) = min(is_flat(i), merge(top, 0.0_wp, range >= 0))
      end do
   end subroutine check_value

   !> Check the steps for an extremum of a maximum along the wall.
   !>
   !> Either the maximum stays below the largest so far by the largest range of a coefficient in
   !> Bernstein form, or all coefficients stay below it. The outer coefficients are values at the
   !> ends of the wall, which may also grow up to the end of the step.
   pure subroutine check_section(columns, values, has_slopes, q, first, is_flat)
      integer, intent(in) :: columns
      !! number of values and coefficients
      real(wp), intent(in) :: values(lane_count, columns, value_count)
      real(wp), intent(in) :: has_slopes(lane_count)
      !! as in `check_value`
      integer, intent(in) :: q
      !! number of the value
      integer, intent(in) :: first
      !! column of its first coefficient
      real(wp), intent(inout) :: is_flat(lane_count)
      !! as in `find_flat_steps`
      real(wp) :: a, b, c
      real(wp), dimension(lane_count) :: spread, inside, all_inside
      integer :: i, m

      spread = 0
      all_inside = 1
      do m = first, first + section_terms - 1
         inside = 1
         call check_value(columns, values, has_slopes, m, inside)
         !$omp simd private(a, b, c)
         do i = 1, lane_count
            a = values(i, m, at_begin)
            b = values(i, m, at_middle)
            c = values(i, m, at_end)
            spread(i) = max(spread(i), max(a, b, c) - min(a, b, c))
            inside(i) = merge(inside(i), aint(inside(i)), m == first .or. m == first &
               + section_terms - 1)
            all_inside(i) = min(all_inside(i), inside(i))
         end do
      end do
      !$omp simd private(a)
      do i = 1, lane_count
         a = max(values(i, q, at_begin), values(i, q, at_middle), values(i, q, at_end)) &
            + 2*rise*spread(i)
         is_flat(i) = min(is_flat(i), merge(1.0_wp, all_inside(i), a <= values(i, q, so_far)))
      end do
   end subroutine check_section

   !> Check the steps for an extremum of the quotient |H|/N, by bounds of |H| and N.
   pure subroutine check_quotient(columns, values, is_flat)
      integer, intent(in) :: columns
      !! number of values and coefficients
      real(wp), intent(in) :: values(lane_count, columns, value_count)
      real(wp), intent(inout) :: is_flat(lane_count)
      !! as in `find_flat_steps`
      real(wp) :: top, low, level, a, b, c
      integer :: i

      !$omp simd private(top, low, level, a, b, c)
      do i = 1, lane_count
         a = -max(-cap, min(values(i, low_normal, at_begin), cap))
         b = -max(-cap, min(values(i, low_normal, at_middle), cap))
         c = -max(-cap, min(values(i, low_normal, at_end), cap))
         low = min(a, b, c)
         low = low - rise*(max(a, b, c) - low) - slack*abs(low)
         a = a*max(-cap, min(values(i, demand, at_begin), cap))
         b = b*max(-cap, min(values(i, demand, at_middle), cap))
         c = c*max(-cap, min(values(i, demand, at_end), cap))
         top = max(abs(a), abs(b), abs(c))
         top = top + rise*(max(a, b, c) - min(a, b, c)) + slack*top
         level = min(values(i, demand, so_far), cap)
         ! a pivot that lifts has the largest possible demand
         top = merge(-1.0_wp, merge(top, 2*cap*cap, low > 0), level >= cap)
         is_flat(i) = merge(is_flat(i), 0.0_wp, top <= level*max(low, 0.0_wp))
      end do
   end subroutine check_quotient

   !> Return whether the demand of a scene is |H|/N rather than the force of a shear key.
   pure logical function is_quotient(parts)
      type(force_parts_t), intent(in) :: parts

      is_quotient = parts%through_link%has_wall .and. .not. parts%has_shear_key
   end function is_quotient

end module rwmf_integrator_lane_screens
