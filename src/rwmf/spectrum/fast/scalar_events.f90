!> Flights that the vectorised search leaves alone: those that dip, or start with nothing.
module rwmf_spectrum_fast_scalar_events
   use rwmf_spectrum_fast_types, only: flights_t, terms
   use rwmf_spectrum_fast_taylor_oscillator, only: find_root, state_at
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: search_again

contains

   !> Impact and peak of one flight, as `locate_events` finds them in plain ones.
   pure subroutine search_again(k, flights, failed)
      integer, intent(in) :: k
      !! number of the flight
      type(flights_t), intent(inout) :: flights
      logical, intent(inout) :: failed
      !! no clean crossing
      real(wp) :: p(0:terms)
      real(wp) :: v
      logical :: hits

      p = flights%p(k, :terms)
      call find_impact(p, flights%y(k), hits, failed)
      if (failed) return
      flights%hits(k) = merge(1.0_wp, 0.0_wp, hits)
      call state_at(p, flights%y(k), v, flights%w_hit(k))
      if (flights%w_hit(k) < 0 .and. p(1) >= 0) call find_peak(p, flights%y(k), flights%peak(k))
      if (.not. hits) call search_turns(k, p, flights)
   end subroutine search_again

   !> First return to v = 0 after the beginning of a series.
   !>
   !> A flight that starts on the base is asked for v/y (or v/y**2), which does not vanish there.
   pure subroutine find_impact(p, y, hits, failed)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(out) :: y
      !! position of the impact; 1 without one [-]
      logical, intent(out) :: hits
      logical, intent(inout) :: failed
      integer :: first

      first = 0
      if (p(0) <= 0) first = 1
      if (p(0) <= 0 .and. p(1) <= 0) first = 2
      y = 1
      hits = .false.
      if (sum(p(first:)) <= 0) then
         failed = first == 2 .or. .not. p(first) > 0
         if (failed) return
         hits = .true.
         call find_root(p(first:), 0.0_wp, 1.0_wp, y)
      else if (first < 2 .and. p(first + 1) < 0) then
         call find_dip(p(first:), y, hits)
      end if
   end subroutine find_impact

   !> Does a function that falls at 0 and is positive at 1 become negative between?
   pure subroutine find_dip(r, y, hits)
      real(wp), contiguous, intent(in) :: r(0:)
      real(wp), intent(out) :: y
      logical, intent(out) :: hits
      real(wp) :: lowest
      real(wp) :: value
      real(wp) :: slope

      y = 1
      hits = .false.
      call state_at(r, 1.0_wp, value, slope)
      if (slope <= 0) return
      call find_root(derivative(r), 0.0_wp, 1.0_wp, lowest)
      call state_at(r, lowest, value, slope)
      hits = value < 0
      if (hits) call find_root(r, 0.0_wp, lowest, y)
   end subroutine find_dip

   pure function derivative(r) result(slope)
      real(wp), intent(in) :: r(0:)
      real(wp) :: slope(0:size(r) - 2)
      integer :: i

      do i = 0, size(r) - 2
         slope(i) = (i + 1)*r(i + 1)
      end do
   end function derivative

   !> Largest v before the position y, where v falls.
   !>
   !> A flight that starts with nothing is asked for v'/y, and one that starts at the threshold,
   !> without acceleration, for v'/y**2: v' itself vanishes at both.
   pure subroutine find_peak(p, y, peak)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: y
      real(wp), intent(out) :: peak
      real(wp) :: rate(0:size(p) - 2)
      real(wp) :: x
      real(wp) :: slope
      integer :: first

      rate = derivative(p)
      first = 0
      if (p(1) <= 0) first = 1
      if (p(1) <= 0 .and. p(2) <= 0) first = 2
      call find_root(rate(first:), 0.0_wp, y, x)
      call state_at(p, x, peak, slope)
   end subroutine find_peak

   !> Where v' changes its sign twice: the largest and the smallest v between.
   pure subroutine find_turns(p, found, highest, lowest)
      real(wp), contiguous, intent(in) :: p(0:)
      logical, intent(out) :: found
      real(wp), intent(out) :: highest
      !! position [-]
      real(wp), intent(out) :: lowest
      real(wp) :: rate(0:size(p) - 2)
      real(wp) :: bend(0:size(p) - 3)
      real(wp) :: x, value, slope

      highest = 0
      lowest = 0
      rate = derivative(p)
      bend = derivative(rate)
      found = bend(0)*sum(bend) < 0 .and. p(1)*sum(rate) > 0
      if (.not. found) return
      call find_root(bend, 0.0_wp, 1.0_wp, x)
      call state_at(rate, x, value, slope)
      found = value*p(1) < 0
      if (.not. found) return
      call find_root(rate, 0.0_wp, x, highest)
      call find_root(rate, x, 1.0_wp, lowest)
      if (p(1) < 0) then
         x = highest
         highest = lowest
         lowest = x
      end if
   end subroutine find_turns

   !> A flight that turns twice: it may touch the base between, and be highest between.
   pure subroutine search_turns(k, p, flights)
      integer, intent(in) :: k
      real(wp), contiguous, intent(in) :: p(0:)
      type(flights_t), intent(inout) :: flights
      real(wp) :: highest, lowest, value, slope
      logical :: found

      call find_turns(p, found, highest, lowest)
      if (.not. found) return
      call state_at(p, lowest, value, slope)
      if (value < 0) then
         flights%hits(k) = 1
         call find_root(p, merge(highest, 0.0_wp, highest < lowest), lowest, flights%y(k))
         call state_at(p, flights%y(k), value, flights%w_hit(k))
      end if
      if (highest < flights%y(k)) call state_at(p, highest, flights%peak(k), slope)
   end subroutine search_turns

end module rwmf_spectrum_fast_scalar_events
