!> Scalar search in flights that the vectorised search leaves out: those that dip, turn twice or
!> start with v = v' = 0.
module rwmf_spectrum_fast_scalar_events
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_taylor_oscillator, only: find_root, state_at
   use rwmf_spectrum_fast_types, only: substep_batch_t, terms
   implicit none
   private

   public :: locate_flight_events

contains

   !> Locate impact and peak of one flight, with the results of `locate_events`.
   pure subroutine locate_flight_events(k, batch, failed)
      integer, intent(in) :: k
      !! place in the batch
      type(substep_batch_t), intent(inout) :: batch
      logical, intent(inout) :: failed
      !! set where v does not cross zero
      real(wp) :: p(0:terms)
      real(wp) :: v
      logical :: has_impact

      p = batch%p(k, :terms)
      call find_impact(p, batch%y(k), has_impact, failed)
      if (failed) return
      batch%has_impact(k) = merge(1.0_wp, 0.0_wp, has_impact)
      call state_at(p, batch%y(k), v, batch%w_impact(k))
      if (batch%w_impact(k) < 0 .and. p(1) >= 0) call find_peak(p, batch%y(k), batch%peak(k))
      if (.not. has_impact) call search_turns(k, p, batch)
   end subroutine locate_flight_events

   !> First return to v = 0 after the beginning of a series.
   !>
   !> For a flight that starts on the base the root is that of v/y (or v/y**2), which does not
   !> vanish there.
   pure subroutine find_impact(p, y, has_impact, failed)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(out) :: y
      !! position of the impact; 1 without one [-]
      logical, intent(out) :: has_impact
      logical, intent(inout) :: failed
      integer :: first

      first = 0
      if (p(0) <= 0) first = 1
      if (p(0) <= 0 .and. p(1) <= 0) first = 2
      y = 1
      has_impact = .false.
      if (sum(p(first:)) <= 0) then
         failed = first == 2 .or. .not. p(first) > 0
         if (failed) return
         has_impact = .true.
         call find_root(p(first:), 0.0_wp, 1.0_wp, y)
      else if (first < 2 .and. p(first + 1) < 0) then
         call find_dip(p(first:), y, has_impact)
      end if
   end subroutine find_impact

   !> First root of a function that falls at 0 and is positive at 1, if it becomes negative between.
   pure subroutine find_dip(r, y, has_impact)
      real(wp), contiguous, intent(in) :: r(0:)
      real(wp), intent(out) :: y
      logical, intent(out) :: has_impact
      real(wp) :: lowest
      real(wp) :: value
      real(wp) :: slope

      y = 1
      has_impact = .false.
      call state_at(r, 1.0_wp, value, slope)
      if (slope <= 0) return
      call find_root(derivative(r), 0.0_wp, 1.0_wp, lowest)
      call state_at(r, lowest, value, slope)
      has_impact = value < 0
      if (has_impact) call find_root(r, 0.0_wp, lowest, y)
   end subroutine find_dip

   !> Coefficients of the derivative of a polynomial.
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
   !> For a flight that starts with v' = 0 the root is that of v'/y, and for one that starts at the
   !> threshold, without acceleration, that of v'/y**2, which do not vanish at the beginning.
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

   !> Positions of the extrema of v where v' changes its sign twice.
   pure subroutine find_turns(p, turns_twice, highest, lowest)
      real(wp), contiguous, intent(in) :: p(0:)
      logical, intent(out) :: turns_twice
      real(wp), intent(out) :: highest
      !! position of the maximum [-]
      real(wp), intent(out) :: lowest
      !! position of the minimum [-]
      real(wp) :: rate(0:size(p) - 2)
      real(wp) :: bend(0:size(p) - 3)
      real(wp) :: x, value, slope

      highest = 0
      lowest = 0
      rate = derivative(p)
      bend = derivative(rate)
      turns_twice = bend(0)*sum(bend) < 0 .and. p(1)*sum(rate) > 0
      if (.not. turns_twice) return
      call find_root(bend, 0.0_wp, 1.0_wp, x)
      call state_at(rate, x, value, slope)
      turns_twice = value*p(1) < 0
      if (.not. turns_twice) return
      call find_root(rate, 0.0_wp, x, highest)
      call find_root(rate, x, 1.0_wp, lowest)
      if (p(1) < 0) then
         x = highest
         highest = lowest
         lowest = x
      end if
   end subroutine find_turns

   !> Impact and peak between the two extrema of a flight that turns twice.
   pure subroutine search_turns(k, p, batch)
      integer, intent(in) :: k
      real(wp), contiguous, intent(in) :: p(0:)
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: highest, lowest, value, slope
      logical :: turns_twice

      call find_turns(p, turns_twice, highest, lowest)
      if (.not. turns_twice) return
      call state_at(p, lowest, value, slope)
      if (value < 0) then
         batch%has_impact(k) = 1
         call find_root(p, merge(highest, 0.0_wp, highest < lowest), lowest, batch%y(k))
         call state_at(p, batch%y(k), value, batch%w_impact(k))
      end if
      if (highest < batch%y(k)) call state_at(p, highest, batch%peak(k), slope)
   end subroutine search_turns

end module rwmf_spectrum_fast_scalar_events
