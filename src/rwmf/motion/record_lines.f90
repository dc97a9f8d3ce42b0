!> Straight lines through the samples of a record, and the merging of two sequences of knots
!> (`rwmf_motion_ground_motion` evaluates them).
module rwmf_motion_record_lines
   use rwmf_core_kinds, only: pi, wp
   implicit none
   private

   public :: line_t, lines_t, lines_through, merged_times, on_knots, last_until
   public :: next_extremum, next_eighth

   !> Straight lines between knots: zero before the first and after the last one.
   type :: lines_t
      real(wp), allocatable :: knot(:)
      !! (n) strictly increasing times [s]
      real(wp), allocatable :: a(:)
      !! (n) acceleration just after the knot [m/s2]
      real(wp), allocatable :: slope(:)
      !! (n) rate of the acceleration in the interval after the knot [m/s3]
   end type lines_t

   !> Straight line a_0 + slope*(t - t_0) that the ground acceleration follows in an interval.
   type :: line_t
      logical :: is_straight = .true.
      !! if false the other components are unused: call `acceleration` of the motion
      real(wp) :: t_0 = 0
      !! [s]
      real(wp) :: a_0 = 0
      !! [m/s2]
      real(wp) :: slope = 0
      !! [m/s3]
   end type line_t

contains

   !> Return the lines through samples.
   pure type(lines_t) function lines_through(t, a) result(lines)
      real(wp), intent(in) :: t(:)
      !! (n) strictly increasing times [s]
      real(wp), intent(in) :: a(:)
      !! (n) accelerations [m/s2]
      integer :: n

      n = size(t)
      allocate (lines%knot(n), lines%a(n), lines%slope(n))
      lines%knot(:) = t
      lines%a(:) = a
      if (n == 0) return
      lines%slope(:n - 1) = (a(2:) - a(:n - 1))/(t(2:) - t(:n - 1))
      lines%slope(n) = 0
      ! The acceleration is zero after the last sample; its value belongs to the interval before.
      lines%a(n) = 0
   end function lines_through

   !> Merge two sequences of times in order. A time of the second sequence that equals one of the
   !> first within round-off is dropped, so that no interval has zero length.
   pure function merged_times(first, second) result(times)
      real(wp), intent(in) :: first(:)
      !! (n) strictly increasing times [s]
      real(wp), intent(in) :: second(:)
      !! (m) strictly increasing times [s]
      real(wp), allocatable :: times(:)
      !! (at most n + m)
      logical :: is_first
      integer :: i, j, n

      allocate (times(size(first) + size(second)))
      i = 1
      j = 1
      n = 0
      do while (i <= size(first) .or. j <= size(second))
         if (i <= size(first) .and. j <= size(second)) then
            if (abs(second(j) - first(i)) <= 64*spacing(max(abs(first(i)), abs(second(j))))) then
               j = j + 1
               cycle
            end if
         end if
         is_first = j > size(second)
         if (.not. is_first .and. i <= size(first)) is_first = first(i) < second(j)
         n = n + 1
         if (is_first) then
            times(n) = first(i)
            i = i + 1
         else
            times(n) = second(j)
            j = j + 1
         end if
      end do
      times = times(:n)
   end function merged_times

   !> Refine lines to more knots. The middle of each interval selects its line, so that round-off in
   !> a knot has no effect.
   pure type(lines_t) function on_knots(lines, knots) result(refined)
      type(lines_t), intent(in) :: lines
      real(wp), intent(in) :: knots(:)
      !! (n) strictly increasing times, including those of the lines [s]
      integer :: i, k

      allocate (refined%knot(size(knots)), refined%a(size(knots)), refined%slope(size(knots)))
      refined%knot(:) = knots
      refined%a = 0
      refined%slope = 0
      do k = 1, size(knots) - 1
         i = last_until(lines%knot, (knots(k) + knots(k + 1))/2)
         if (i < 1 .or. i >= size(lines%knot)) cycle
         refined%slope(k) = lines%slope(i)
         refined%a(k) = lines%a(i) + lines%slope(i)*(knots(k) - lines%knot(i))
      end do
   end function on_knots

   !> Number of the last knot not after t, 0 before the first one.
   pure integer function last_until(knots, t) result(low)
      real(wp), intent(in) :: knots(:)
      !! (n) strictly increasing times [s]
      real(wp), intent(in) :: t
      !! [s]
      integer :: high
      integer :: middle

      low = 0
      high = size(knots) + 1
      do while (high - low > 1)
         middle = (low + high)/2
         if (knots(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function last_until

   !> First time after t at which sin(omega (t - t_0) + phase) is extremal [s].
   pure real(wp) function next_extremum(omega, phase, t_0, t) result(extremum)
      real(wp), intent(in) :: omega
      !! [rad/s]
      real(wp), intent(in) :: phase
      !! [rad]
      real(wp), intent(in) :: t_0
      !! [s]
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: half_turns
      !! integral

      half_turns = (omega*(t - t_0) + phase)/pi + 0.5_wp
      half_turns = aint(half_turns) - merge(1.0_wp, 0.0_wp, aint(half_turns) > half_turns)
      extremum = t_0 + ((half_turns + 0.5_wp)*pi - phase)/omega
      if (extremum <= t) extremum = t_0 + ((half_turns + 1.5_wp)*pi - phase)/omega
   end function next_extremum

   !> Return the end of the next eighth of an interval [s]. The extrema of a host's motion are
   !> unknown: each eighth is taken as monotone.
   pure real(wp) function next_eighth(t_begin, t_end, t) result(next)
      real(wp), intent(in) :: t_begin
      !! beginning of the interval [s]
      real(wp), intent(in) :: t_end
      !! end of the interval [s]
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: eighth
      !! [s]

      eighth = (t_end - t_begin)/8
      next = t_begin + (aint((t - t_begin)/eighth) + 1)*eighth
      if (next <= t) next = next + eighth
      next = min(next, t_end)
   end function next_eighth

end module rwmf_motion_record_lines
