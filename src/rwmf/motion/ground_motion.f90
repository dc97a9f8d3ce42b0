!> Ground motion as a sequence of intervals between knots, inside which it is smooth.
!>
!> Knot k lies between the intervals k-1 and k. Interval 0 comes before the first knot and the last
!> interval follows the last one; in both the ground acceleration is zero. An integrator that stops
!> at every knot and evaluates the acceleration *of an interval* meets no kink and no jump.
module rwmf_motion_ground_motion
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_host_motion, only: ground_t
   use rwmf_motion_record_lines, only: last_until, line_t, lines_t, lines_through, merged_times, &
      next_eighth, on_knots
   use rwmf_motion_pulse_curve, only: build_curve, curve_gain, curve_rate, curve_series, curve_t, &
      curve_turn, curve_value, knots_with_bends, steep_time
   use rwmf_problem_case, only: case_t
   use rwmf_problem_record, only: record_t
   implicit none
   private

   public :: motion_t, motion_from_case, piecewise_linear_motion, refined_motion, scaled_motion
   public :: step_parts
   public :: ground_t, follow_samples, follow_ground, is_known_until, peak_acceleration
   public :: line_t, line_of, vertical_line_of, acceleration, vertical_acceleration, has_jump
   public :: lowest_vertical
   public :: is_curved
   public :: interval_at, interval_end, interval_last, turning_point, steep_point, fastest_rate
   public :: is_piecewise_linear, motion_end, velocities_at_knots, velocity
   public :: scan_lines, pass_lines_inside
   public :: expand_ground

   integer, parameter :: shape_linear = 1
   !! straight lines between the knots
   integer, parameter :: shape_given = 2
   !! acceleration computed by a host in interval 1, then constant
   integer, parameter :: shape_pulse = 3
   !! `curve` between its two knots, which may be among those of a vertical record

   !> Ground acceleration.
   type :: motion_t
      private
      integer :: shape = shape_linear
      !! one of the `shape_` numbers
      real(wp), allocatable :: knot(:)
      !! (knots) strictly increasing times [s]
      real(wp), allocatable :: a(:)
      !! (knots) acceleration just after the knot [m/s2]
      real(wp), allocatable :: slope(:)
      !! (knots) rate of the acceleration in the interval after the knot [m/s3]
      type(curve_t) :: curve
      !! pulse; for lines only the amplitude is set, their largest magnitude
      integer :: last_turning = 1
      !! last interval that may have an extremum inside
      class(ground_t), pointer :: ground => null()
      !! function of a host, for the time of one advance
      real(wp) :: vertical_ratio = 0
      !! ratio of the vertical to the horizontal acceleration [-]
      type(lines_t), allocatable :: upward
      !! independent vertical acceleration, positive upward, on the same knots [m/s2]
      integer :: parts = 1
      !! number of parts of each interval and of the longest step
      logical :: is_open = .false.
      !! the host supplies it piece by piece: it is unknown beyond the current interval
   end type motion_t

contains

   !> Build the ground motion of a case, including its vertical component.
   pure function motion_from_case(case, origin) result(motion)
      type(case_t), intent(in) :: case
      type(case_t), intent(in), optional :: origin
      !! original of a changed case, which holds the samples of its records
      type(motion_t) :: motion

      ! a missing record is passed as an absent argument
      if (present(origin)) then
         motion = built_motion(case, origin%record, origin%upward_record)
      else
         motion = built_motion(case, case%record, case%upward_record)
      end if
   end function motion_from_case

   !> Build the motion of a case from the samples of its records.
   pure function built_motion(case, record, upward_record) result(motion)
      type(case_t), intent(in) :: case
      type(record_t), intent(in), optional :: record
      type(record_t), intent(in), optional :: upward_record
      type(motion_t) :: motion
      type(lines_t) :: lines
      real(wp), allocatable :: own(:)
      !! knots of the pulse [s]

      motion = horizontal_motion(case, record)
      if (allocated(case%upward)) then
         if (allocated(case%upward%ratio)) motion%vertical_ratio = case%upward%ratio
      end if
      if (.not. present(upward_record)) return
      motion%upward = lines_through(upward_record%t, &
         case%upward_record%factor*upward_record%a)
      if (motion%shape == shape_linear) then
         ! merge the knots of both motions, each of straight lines
         lines = lines_t(motion%knot, motion%a, motion%slope)
         lines = on_knots(lines, merged_times(lines%knot, motion%upward%knot))
         motion%upward = on_knots(motion%upward, lines%knot)
         motion%knot = lines%knot
         motion%a = lines%a
         motion%slope = lines%slope
      else
         ! merge the knots of a pulse with those of the straight lines of the vertical motion
         own = knots_with_bends(motion%curve)
         motion%knot = merged_times(own, motion%upward%knot)
         motion%upward = on_knots(motion%upward, motion%knot)
         motion%curve%first = last_until(motion%knot, own(1))
         motion%curve%last = last_until(motion%knot, own(size(own)))
         motion%last_turning = motion%curve%last - 1
      end if
   end function built_motion

   !> Build the horizontal ground motion of a case; no motion without `&motion`.
   pure function horizontal_motion(case, record) result(motion)
      type(case_t), intent(in) :: case
      type(record_t), intent(in), optional :: record
      !! record with samples, of kind 'record'
      type(motion_t) :: motion

      motion = piecewise_linear_motion([real(wp) ::], [real(wp) ::])
      if (.not. allocated(case%motion)) return
      select case (case%motion%kind)
      case ('record')
         motion = piecewise_linear_motion(record%t, case%record%factor*record%a)
      case ('one_sine', 'one_cosine', 'sine', 'type_c', 'ricker', 'ricker_antisymmetric', &
            'mavroeidis_papageorgiou')
         motion = pulse_motion(build_curve(case%motion, case%model%g))
      case default
         continue
      end select
   end function horizontal_motion

   !> Build a motion that is linear between samples and zero before the first and after the last
   !> one.
   pure function piecewise_linear_motion(t, a, vertical_ratio) result(motion)
      real(wp), intent(in) :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), intent(in) :: a(:)
      !! (n) accelerations [m/s2]
      real(wp), intent(in), optional :: vertical_ratio
      !! ratio of the vertical to this acceleration, 0 if absent [-]
      type(motion_t) :: motion
      type(lines_t) :: lines

      lines = lines_through(t, a)
      if (present(vertical_ratio)) motion%vertical_ratio = vertical_ratio
      motion%shape = shape_linear
      motion%knot = lines%knot
      motion%a = lines%a
      motion%slope = lines%slope
      if (size(t) > 0) motion%curve%amplitude = maxval(abs(a))
   end function piecewise_linear_motion

   !> Set the motion to straight lines through a host's samples, then to the last value until the
   !> next call. The host calls this once per step: the arrays are reused if they fit.
   pure subroutine follow_samples(motion, t, a)
      type(motion_t), intent(inout) :: motion
      real(wp), intent(in) :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), intent(in) :: a(:)
      !! (n) accelerations [m/s2]
      integer :: n

      n = size(t)
      motion%shape = shape_linear
      motion%is_open = .true.
      call make_room(motion, n + 1)
      motion%knot(:n) = t
      motion%knot(n + 1) = huge(1.0_wp)
      motion%a(:n) = a
      motion%a(n + 1) = a(n)
      motion%slope(:n - 1) = (a(2:) - a(:n - 1))/(t(2:) - t(:n - 1))
      motion%slope(n:) = 0
      motion%curve%amplitude = maxval(abs(a))
   end subroutine follow_samples

   !> Set the motion to a host's function between two times, then to its last value.
   subroutine follow_ground(motion, t_begin, t_end, ground)
      type(motion_t), intent(inout) :: motion
      real(wp), intent(in) :: t_begin
      !! [s]
      real(wp), intent(in) :: t_end
      !! [s]
      class(ground_t), intent(in), target :: ground
      !! in use until the next call for this motion

      motion%shape = shape_given
      motion%is_open = .true.
      call make_room(motion, 3)
      motion%knot(:) = [t_begin, t_end, huge(1.0_wp)]
      motion%a(:) = ground%acceleration_at(t_end)
      motion%a(1) = ground%acceleration_at(t_begin)
      motion%slope(:) = 0
      motion%curve%amplitude = maxval(abs(motion%a))
      motion%ground => ground
   end subroutine follow_ground

   pure subroutine make_room(motion, n)
      type(motion_t), intent(inout) :: motion
      integer, intent(in) :: n
      !! knots

      if (allocated(motion%knot)) then
         if (size(motion%knot) == n .and. size(motion%a) == n) return
         deallocate (motion%knot, motion%a, motion%slope)
      end if
      allocate (motion%knot(n), motion%a(n), motion%slope(n))
   end subroutine make_room

   !> Return whether the motion in an interval is known until t.
   pure logical function is_known_until(motion, interval, t)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the current interval
      real(wp), intent(in) :: t
      !! [s]

      is_known_until = .true.
      if (motion%is_open) is_known_until = t <= interval_end(motion, interval)
   end function is_known_until

   !> Scale the amplitude of a motion.
   function scaled_motion(motion, factor) result(scaled)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: factor
      !! [-]
      type(motion_t) :: scaled

      scaled = motion
      scaled%curve%amplitude = factor*motion%curve%amplitude
      scaled%a = factor*motion%a
      scaled%slope = factor*motion%slope
      if (.not. allocated(motion%upward)) return
      scaled%upward%a = factor*motion%upward%a
      scaled%upward%slope = factor*motion%upward%slope
   end function scaled_motion

   !> Divide every interval of a motion. Steps limited by its knots become shorter, as do steps
   !> limited only by the periods of the scene (`step_parts`).
   function refined_motion(motion, parts) result(refined)
      type(motion_t), intent(in) :: motion
      !! motion of a case
      integer, intent(in) :: parts
      !! number of parts of each interval
      type(motion_t) :: refined
      type(lines_t) :: lines
      real(wp), allocatable :: knot(:)
      !! [s]
      integer :: i, j, n

      refined = motion
      refined%parts = parts
      n = size(motion%knot)
      if (n < 2) return
      allocate (knot((n - 1)*parts + 1))
      knot(size(knot)) = motion%knot(n)
      do i = 1, n - 1
         associate (begin => motion%knot(i))
            knot((i - 1)*parts + 1) = begin
            do j = 1, parts - 1
               knot((i - 1)*parts + 1 + j) = begin + (motion%knot(i + 1) - begin)*j/parts
            end do
         end associate
      end do
      if (allocated(motion%upward)) refined%upward = on_knots(motion%upward, knot)
      if (motion%shape == shape_linear) then
         lines = on_knots(lines_t(motion%knot, motion%a, motion%slope), knot)
         refined%a = lines%a
         refined%slope = lines%slope
      else
         refined%curve%first = (motion%curve%first - 1)*parts + 1
         refined%curve%last = (motion%curve%last - 1)*parts + 1
         refined%last_turning = motion%last_turning*parts
      end if
      refined%knot = knot
   end function refined_motion

   !> Number of parts of the longest step under a motion.
   pure integer function step_parts(motion)
      type(motion_t), intent(in) :: motion

      step_parts = motion%parts
   end function step_parts

   !> Convert a pulse to a motion.
   pure type(motion_t) function pulse_motion(curve) result(motion)
      type(curve_t), intent(in) :: curve

      motion%shape = shape_pulse
      motion%curve = curve
      motion%knot = curve%knot
      motion%curve%first = 1
      motion%curve%last = size(curve%knot)
      allocate (motion%a(0), motion%slope(0))
   end function pulse_motion

   !> Ground acceleration in an interval [m/s2].
   pure real(wp) function acceleration(motion, interval, t)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s], in the closed interval

      if (interval < 1 .or. interval >= size(motion%knot)) then
         acceleration = 0
      else if (motion%shape == shape_linear) then
         acceleration = motion%a(interval) + motion%slope(interval)*(t - motion%knot(interval))
      else if (motion%shape == shape_pulse) then
         acceleration = 0
         if (is_curved(motion, interval)) acceleration = curve_value(motion%curve, t)
      else if (interval == 1) then
         acceleration = motion%ground%acceleration_at(t)
      else
         acceleration = motion%a(interval)
      end if
   end function acceleration

   !> Expand both components of the ground acceleration in the time after t, inside an interval.
   !>
   !> A host's function is replaced by a polynomial through its values at Chebyshev points.
   pure subroutine expand_ground(motion, interval, t, span, order, ground, upward)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: span
      !! length in which the series of a host's function holds [s]
      integer, intent(inout) :: order
      !! on entry the largest order; on return that of the series
      real(wp), intent(out) :: ground(0:), upward(0:)
      !! (order) coefficients over s**k, horizontal and vertical (upward) [m/s2]
      type(line_t) :: line

      if (is_curved(motion, interval)) then
         call curve_series(motion%curve, t, ground(0:order))
      else if (motion%shape == shape_given .and. interval == 1) then
         call fit_series(motion%ground, t, span, ground(0:order))
      else
         line = line_of(motion, interval)
         order = 1
         ground(0) = acceleration(motion, interval, t)
         ground(1) = line%slope
      end if
      upward(0:order) = motion%vertical_ratio*ground(0:order)
      if (.not. allocated(motion%upward)) return
      line = vertical_line_of(motion, interval, line_of(motion, interval))
      upward(0:order) = 0
      upward(0) = line%a_0 + line%slope*(t - line%t_0)
      upward(1) = line%slope
   end subroutine expand_ground

   !> Coefficients of the polynomial through a host's values at the Chebyshev points of a span.
   pure subroutine fit_series(ground, t, span, series)
      class(ground_t), intent(in) :: ground
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(out) :: series(0:)
      !! (order)
      real(wp) :: x(0:ubound(series, 1)), difference(0:ubound(series, 1))
      integer :: i, k, n

      n = ubound(series, 1)
      ! points and divided differences over the span
      do k = 0, n
         x(k) = 0.5_wp - 0.5_wp*cos(pi*k/n)
         difference(k) = ground%acceleration_at(t + x(k)*span)
      end do
      do k = 1, n
         do i = n, k, -1
            difference(i) = (difference(i) - difference(i - 1))/(x(i) - x(i - k))
         end do
      end do
      series = 0
      do k = n, 0, -1
         do i = n - k, 1, -1
            series(i) = series(i - 1) - x(k)*series(i)
         end do
         series(0) = difference(k) - x(k)*series(0)
      end do
      do k = 1, n
         series(k) = series(k)/span**k
      end do
   end subroutine fit_series

   !> Compute the smallest distance of straight lines from two bounds, and their total variation, in
   !> a span. The scan ends early at a variation above a multiple of the distance.
   pure subroutine scan_lines(motion, interval, bounds, most, t_end, t, least, variation)
      type(motion_t), intent(in) :: motion
      !! piecewise linear
      integer, intent(in) :: interval
      !! number of the interval at t
      real(wp), intent(in) :: bounds(2)
      !! lower and upper bound [m/s2]
      real(wp), intent(in) :: most
      !! variation over the distance that ends the scan [-]
      real(wp), intent(in) :: t_end
      !! [s]
      real(wp), intent(inout) :: t
      !! begin of the span; on return the end of the scan [s]
      real(wp), intent(out) :: least
      !! negative beyond a bound [m/s2]
      real(wp), intent(out) :: variation
      !! [m/s2]
      real(wp) :: a, b
      integer :: k

      k = interval
      a = acceleration(motion, k, t)
      least = min(bounds(2) - a, a - bounds(1))
      variation = 0
      do while (t < t_end .and. variation <= most*least)
         if (k < 1 .or. k >= size(motion%knot)) then
            t = min(interval_end(motion, k), t_end)
            b = 0
         else
            t = min(motion%knot(k + 1), t_end)
            b = motion%a(k) + motion%slope(k)*(t - motion%knot(k))
         end if
         variation = variation + abs(b - a)
         least = min(least, min(bounds(2) - b, b - bounds(1)))
         k = k + 1
         a = b
         if (k > size(motion%knot)) cycle
         if (t < motion%knot(k)) cycle
         a = merge(motion%a(k), 0.0_wp, k < size(motion%knot))
         variation = variation + abs(a - b)
         least = min(least, min(bounds(2) - a, a - bounds(1)))
      end do
   end subroutine scan_lines

   !> Advance to the first interval whose straight line is not between two bounds, or that ends
   !> after a time.
   pure subroutine pass_lines_inside(motion, bounds, t_limit, t, interval)
      type(motion_t), intent(in) :: motion
      !! piecewise linear
      real(wp), intent(in) :: bounds(2)
      !! lower and upper bound [m/s2]
      real(wp), intent(in) :: t_limit
      !! [s]
      real(wp), intent(inout) :: t
      !! [s]
      integer, intent(inout) :: interval
      !! number of the interval at t
      real(wp) :: a, b

      do while (interval >= 1 .and. interval < size(motion%knot))
         if (motion%knot(interval + 1) > t_limit) return
         a = motion%a(interval)
         b = a + motion%slope(interval)*(motion%knot(interval + 1) - motion%knot(interval))
         if (.not. (min(a, b) >= bounds(1) .and. max(a, b) <= bounds(2))) return
         interval = interval + 1
         t = motion%knot(interval)
      end do
   end subroutine pass_lines_inside

   !> Compute the ground velocities at the knots of straight lines, from rest at the first one
   !> [m/s]; for a pulse, the velocity after it.
   pure function velocities_at_knots(motion) result(v)
      type(motion_t), intent(in) :: motion
      real(wp), allocatable :: v(:)
      !! (knots of straight lines, or 1)
      real(wp) :: h
      integer :: i

      if (motion%shape == shape_pulse) then
         v = [curve_gain(motion%curve, motion%knot(motion%curve%last))]
         return
      end if
      allocate (v(size(motion%knot)), source=0.0_wp)
      do i = 2, size(v)
         h = motion%knot(i) - motion%knot(i - 1)
         v(i) = v(i - 1) + h*(motion%a(i - 1) + h/2*motion%slope(i - 1))
      end do
   end function velocities_at_knots

   !> Ground velocity in an interval [m/s]; not for a host's motion.
   pure real(wp) function velocity(motion, at_knots, interval, t)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: at_knots(:)
      !! result of `velocities_at_knots` [m/s]
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s], in the closed interval

      velocity = 0
      if (interval < 1) return
      if (motion%shape == shape_pulse) then
         if (interval >= motion%curve%last) velocity = at_knots(1)
         if (is_curved(motion, interval)) velocity = curve_gain(motion%curve, t)
      else
         velocity = at_knots(min(interval, size(at_knots)))
         if (interval >= size(motion%knot)) return
         associate (h => t - motion%knot(interval))
            velocity = velocity + h*(motion%a(interval) + h/2*motion%slope(interval))
         end associate
      end if
   end function velocity

   !> Return whether a pulse acts in an interval.
   pure logical function is_curved(motion, interval)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`

      is_curved = motion%shape == shape_pulse .and. interval >= motion%curve%first &
         .and. interval < motion%curve%last
   end function is_curved

   !> Return the line of an interval, if the motion is linear there. It holds the data of
   !> `acceleration` for all times of the interval.
   pure type(line_t) function line_of(motion, interval) result(line)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`

      if (interval < 1 .or. interval >= size(motion%knot)) return
      line%is_straight = motion%shape == shape_linear
      line%t_0 = motion%knot(interval)
      if (.not. line%is_straight) return
      line%a_0 = motion%a(interval)
      line%slope = motion%slope(interval)
   end function line_of

   !> Vertical ground acceleration in an interval, positive upward [m/s2].
   pure real(wp) function vertical_acceleration(motion, interval, t) result(upward)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s], in the closed interval
      type(line_t) :: line

      upward = motion%vertical_ratio*acceleration(motion, interval, t)
      if (.not. allocated(motion%upward)) return
      line = vertical_line_of(motion, interval, line_of(motion, interval))
      upward = line%a_0 + line%slope*(t - line%t_0)
   end function vertical_acceleration

   !> Lowest vertical acceleration up to a time, at most zero [m/s2].
   pure real(wp) function lowest_vertical(motion, t_end) result(lowest)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t_end
      !! end of the time range [s]
      integer, parameter :: most_turns = 8
      !! turning points of an interval; only a harmonic has more, and repeats itself after these
      real(wp) :: t
      !! time [s]
      integer :: i, turn

      lowest = 0
      do i = 1, interval_last(motion) - 1
         t = interval_end(motion, i - 1)
         if (t > t_end) return
         lowest = min(lowest, vertical_acceleration(motion, i, t))
         do turn = 1, most_turns
            if (t >= min(interval_end(motion, i), t_end)) exit
            t = min(turning_point(motion, i, t), t_end)
            lowest = min(lowest, vertical_acceleration(motion, i, t))
         end do
      end do
   end function lowest_vertical

   !> Return the straight line of the vertical motion.
   pure type(line_t) function vertical_line_of(motion, interval, horizontal) result(line)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      type(line_t), intent(in) :: horizontal
      !! line of the horizontal motion in this interval

      line = horizontal
      line%a_0 = motion%vertical_ratio*line%a_0
      line%slope = motion%vertical_ratio*line%slope
      if (.not. allocated(motion%upward)) return
      if (interval < 1 .or. interval >= size(motion%knot)) return
      line = line_t(.true., motion%knot(interval), motion%upward%a(interval), &
         motion%upward%slope(interval))
   end function vertical_line_of

   !> Number of the interval that begins at or before t and ends after it; 0 before the first knot.
   pure integer function interval_at(motion, t)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t
      !! [s]

      interval_at = last_until(motion%knot, t)
   end function interval_at

   !> End of an interval [s]; the largest number after the last knot.
   pure real(wp) function interval_end(motion, interval)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`

      if (interval < size(motion%knot)) then
         interval_end = motion%knot(interval + 1)
      else
         interval_end = huge(1.0_wp)
      end if
   end function interval_end

   !> Number of the interval after the last knot.
   pure integer function interval_last(motion)
      type(motion_t), intent(in) :: motion

      interval_last = size(motion%knot)
   end function interval_last

   !> Return whether the acceleration is discontinuous at the beginning of an interval.
   !>
   !> Linear interpolation reaches the next sample only within round-off; this difference is not a
   !> jump.
   pure logical function has_jump(motion, interval)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! >= 1
      real(wp) :: before
      real(wp) :: after
      real(wp) :: t

      t = motion%knot(interval)
      before = acceleration(motion, interval - 1, t)
      after = acceleration(motion, interval, t)
      has_jump = abs(after - before) > 1.0e4_wp*epsilon(1.0_wp)*peak_near(motion, interval)
      if (has_jump .or. .not. allocated(motion%upward)) return
      before = vertical_acceleration(motion, interval - 1, t)
      after = vertical_acceleration(motion, interval, t)
      has_jump = abs(after - before) > 1.0e4_wp*epsilon(1.0_wp) &
         *maxval(abs(motion%upward%a(max(1, interval - 1):interval)))
   end function has_jump

   !> Largest magnitude of acceleration around a knot, the measure of round-off there [m/s2].
   pure real(wp) function peak_near(motion, interval)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval

      if (motion%shape == shape_pulse) then
         peak_near = abs(motion%curve%amplitude)
      else
         peak_near = maxval(abs(motion%a(max(1, interval - 1):interval)))
      end if
   end function peak_near

   !> First time after t at which the acceleration is extremal inside the interval, otherwise its
   !> end [s].
   !>
   !> Between t and that time the acceleration is monotone. (Pulses other than harmonics have knots
   !> at their extrema.)
   pure real(wp) function turning_point(motion, interval, t)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s], inside the interval

      turning_point = interval_end(motion, interval)
      if (interval > motion%last_turning .or. interval < 1) return
      if (motion%shape == shape_given) then
         turning_point = next_eighth(motion%knot(1), motion%knot(2), t)
      else if (is_curved(motion, interval)) then
         turning_point = min(curve_turn(motion%curve, t), turning_point)
      end if
   end function turning_point

   !> First time inside the interval at which the slope of a pulse equals a share of that of the
   !> vertical record, otherwise its end [s].
   pure real(wp) function steep_point(motion, interval, t, share)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      !! number of the interval, as from `interval_at`
      real(wp), intent(in) :: t
      !! [s], inside the interval
      real(wp), intent(in) :: share
      !! [-]

      steep_point = interval_end(motion, interval)
      if (.not. allocated(motion%upward)) return
      if (is_curved(motion, interval)) steep_point = steep_time(motion%curve, &
         abs(share*motion%upward%slope(interval)), t, steep_point)
   end function steep_point

   !> Largest magnitude of the ground acceleration; for pulses the amplitude [m/s2].
   pure real(wp) function peak_acceleration(motion)
      type(motion_t), intent(in) :: motion

      peak_acceleration = abs(motion%curve%amplitude)
   end function peak_acceleration

   !> Rate of variation of a pulse inside its intervals, the fourth root of its largest fourth
   !> derivative over its peak; 0 for straight lines [1/s].
   pure real(wp) function fastest_rate(motion)
      type(motion_t), intent(in) :: motion

      fastest_rate = 0
      if (motion%shape == shape_pulse) fastest_rate = curve_rate(motion%curve)
   end function fastest_rate

   !> Return whether the acceleration is linear between all knots.
   pure logical function is_piecewise_linear(motion)
      type(motion_t), intent(in) :: motion

      is_piecewise_linear = motion%shape == shape_linear
   end function is_piecewise_linear

   !> Time of the last knot, after which the ground is at rest; 0 without knots [s].
   pure real(wp) function motion_end(motion)
      type(motion_t), intent(in) :: motion

      motion_end = 0
      if (size(motion%knot) > 0) motion_end = motion%knot(size(motion%knot))
   end function motion_end

end module rwmf_motion_ground_motion
