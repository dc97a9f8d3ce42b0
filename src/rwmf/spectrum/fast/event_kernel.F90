!> Impacts and peaks on the Taylor series of flights: loops to be vectorised.
!>
!> The series is exact in a substep, so that no further evaluation of N is needed. Compiled once for
!> each instruction set, like `rwmf_spectrum_fast_step_kernel`: no operation mixes two flights.
#ifndef FAST_LOCATE
#define FAST_LOCATE rwmf_spectrum_fast_event_kernel
#endif
module FAST_LOCATE
   use rwmf_spectrum_fast_types, only: batch_width, c_2, c_3, substep_batch_t, terms, wp
   implicit none
   private

   public :: locate_events, place_impacts

contains

   !> First return to v = 0 and the largest v before it.
   !>
   !> For a flight that starts on the base the root is that of v/y, which does not vanish there.
   !> Flights that may have other events than one impact and one peak get `needs_search`.
   pure subroutine locate_events(first, batch)
      integer, intent(in) :: first
      !! 0: all start in the air, 1: all start on the base with a velocity
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: ones(batch_width)
      !! upper end of the brackets
      real(wp) :: has_root(batch_width)
      !! 1: one impact, to be located here
      real(wp) :: v(batch_width)
      real(wp) :: slope
      !! of v or v/y at the end
      real(wp) :: w_sum
      integer :: i

      associate (p => batch%p, at_end => batch%end_state%v)
         !$omp simd private(slope, w_sum)
         do i = 1, batch_width
            ones(i) = 1
            slope = batch%h(i)*batch%end_state%w(i) - first*at_end(i)
            batch%has_impact(i) = merge(1.0_wp, 0.0_wp, at_end(i) <= 0)
            ! A dip (v falls at the beginning, rises at the end), or v = v' = 0 at the beginning.
            batch%needs_search(i) = merge(1.0_wp, 0.0_wp, &
               min(at_end(i), min(-p(i, first + 1), slope)) > 0)
            batch%needs_search(i) = merge(batch%needs_search(i), 1.0_wp, p(i, first) > 0)
            ! v' may change its sign twice: see `may_have_event` of the stage kernel.
            slope = batch%h(i)*batch%end_state%w(i)
            w_sum = p(i, 1) + slope
            batch%needs_search(i) = max(batch%needs_search(i), merge(1.0_wp, 0.0_wp, &
               min(p(i, 1)*slope, min(w_sum*(w_sum - 3*(at_end(i) - p(i, 0))), &
               0.25_wp*abs(w_sum) + max(max(p(i, 0), at_end(i)) - batch%v_max(i), &
               -min(p(i, 0), at_end(i))))) > 0))
            has_root(i) = batch%has_impact(i)*(1 - batch%needs_search(i))
         end do
         call find_roots(p(1, first), ones, at_end, has_root, batch%y)
         call state_at(p, batch%y, v, batch%w_impact)
      end associate
      call place_impacts(batch)
      call find_peaks(batch)
   end subroutine locate_events

   !> Position, speed and ground acceleration of the impacts.
   pure subroutine place_impacts(batch)
      type(substep_batch_t), intent(inout) :: batch
      real(wp), parameter :: last_x = 1 - 1.0e-13_wp
      !! largest position of an impact, so that the rest of the step has a length [-]
      real(wp) :: x
      integer :: i

      associate (f => batch%f)
         !$omp simd private(x)
         do i = 1, batch_width
            x = min(batch%x(i) + batch%span(i)*batch%y(i), last_x)
            batch%x_impact(i) = x
            batch%impact_speed(i) = -batch%w_impact(i)/(batch%span(i)*batch%h_step(i))
            batch%f_impact(i) = f(i, 0) + x*(f(i, 1) + (x - c_2)*(f(i, 2) + (x - c_3)*f(i, 3)))
         end do
      end associate
   end subroutine place_impacts

   !> Roots of functions that are positive at 0 and negative at `high_start`: Newton's method from
   !> the parabola through both ends, with bisection where it would leave the bracket.
   pure subroutine find_roots(r, high_start, at_high, wanted, x)
      real(wp), intent(in) :: r(batch_width, 0:terms)
      real(wp), intent(in) :: high_start(batch_width)
      real(wp), intent(in) :: at_high(batch_width)
      !! values at `high_start`
      real(wp), intent(in) :: wanted(batch_width)
      !! 1 where there is a root; elsewhere x becomes `high_start`
      real(wp), intent(out) :: x(batch_width)
      integer, parameter :: max_iterations = 80
      real(wp), parameter :: near = 1.0e-7_wp
      !! relative correction after which the error, its square, is round-off [-]
      real(wp) :: low(batch_width), high(batch_width), active(batch_width), value(batch_width), &
         slope(batch_width)
      real(wp) :: bend, drop, next, steep
      integer :: i, iteration

      x = high_start
      if (.not. any_of(wanted)) return
      !$omp simd private(bend, drop, next)
      do i = 1, batch_width
         drop = r(i, 1)*high_start(i)
         bend = at_high(i) - r(i, 0) - drop
         ! the root of the parabola next to that of the secant, without cancellation
         bend = sqrt(max(0.0_wp, drop*drop - 4*bend*r(i, 0))) - drop
         ! from the middle of the bracket where the parabola has no root in it
         next = 2*r(i, 0)/merge(bend, 1.0_wp, bend > 2*abs(r(i, 0)))
         next = merge(next, 0.5_wp, bend > 2*abs(r(i, 0)))
         next = high_start(i)*merge(next, 0.5_wp, next > 0)
         low(i) = 0
         high(i) = high_start(i)
         active(i) = wanted(i)
         x(i) = merge(next, high_start(i), wanted(i) > 0)
      end do
      do iteration = 1, max_iterations
         call state_at(r, x, value, slope)
         !$omp simd private(next, steep)
         do i = 1, batch_width
            low(i) = merge(x(i), low(i), value(i) > 0)
            high(i) = merge(high(i), x(i), value(i) > 0)
            steep = merge(slope(i), huge(1.0_wp), abs(value(i)) < abs(slope(i))*high_start(i))
            next = x(i) - value(i)/steep
            steep = merge(1.0_wp, -1.0_wp, abs(value(i)) < abs(slope(i))*high_start(i))
            steep = min(steep, min(next - low(i), high(i) - next))
            next = merge(next, low(i) + (high(i) - low(i))*0.5_wp, steep >= 0)
            next = merge(next, x(i), active(i) > 0)
            active(i) = merge(active(i), 0.0_wp, abs(next - x(i)) > near*abs(next))
            x(i) = next
         end do
         if (.not. any_of(active)) exit
      end do
   end subroutine find_roots

   !> Is one of the flags set?
   pure logical function any_of(flag)
      real(wp), intent(in) :: flag(batch_width)
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, batch_width
         total = max(total, flag(i))
      end do
      any_of = total > 0
   end function any_of

   !> Largest v of the flights that may bring a new maximum.
   pure subroutine find_peaks(batch)
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: r(batch_width, 0:terms)
      real(wp) :: wanted(batch_width)
      real(wp) :: x(batch_width)
      real(wp) :: slope(batch_width)
      integer :: i, j

      associate (p => batch%p)
         !$omp simd
         do i = 1, batch_width
            ! A bound of the peak: most peaks are far below the largest one.
            wanted(i) = max(p(i, 0) + 1.5_wp*p(i, 1)*batch%y(i) - batch%v_max(i), p(i, 2))
            wanted(i) = merge(1.0_wp, 0.0_wp, min(wanted(i), -batch%w_impact(i)) > 0)
            wanted(i) = wanted(i)*(1 - batch%needs_search(i))
            wanted(i) = merge(wanted(i), 0.0_wp, p(i, 1) > 0)
            batch%peak(i) = 0
         end do
         if (.not. any_of(wanted)) return
         do j = 0, terms - 1
            !$omp simd
            do i = 1, batch_width
               r(i, j) = (j + 1)*p(i, j + 1)
            end do
         end do
         r(:, terms) = 0
         call find_roots(r, batch%y, batch%w_impact, wanted, x)
         call state_at(p, x, r(:, 0), slope)
      end associate
      !$omp simd
      do i = 1, batch_width
         batch%peak(i) = merge(r(i, 0), 0.0_wp, wanted(i) > 0)
      end do
   end subroutine find_peaks

   !> Polynomials and their derivatives at x, summed in pairs to shorten chains of dependent
   !> operations.
   pure subroutine state_at(p, x, value, rate)
      real(wp), intent(in) :: p(batch_width, 0:terms)
      real(wp), intent(in) :: x(batch_width)
      real(wp), intent(out) :: value(batch_width)
      real(wp), intent(out) :: rate(batch_width)
      real(wp) :: y, y_2, y_4, y_8
      integer :: i

      !$omp simd private(y, y_2, y_4, y_8)
      do i = 1, batch_width
         y = x(i)
         y_2 = y*y
         y_4 = y_2*y_2
         y_8 = y_4*y_4
         value(i) = (((p(i, 0) + y*p(i, 1)) + y_2*(p(i, 2) + y*p(i, 3))) &
            + y_4*((p(i, 4) + y*p(i, 5)) + y_2*(p(i, 6) + y*p(i, 7)))) &
            + y_8*(((p(i, 8) + y*p(i, 9)) + y_2*(p(i, 10) + y*p(i, 11))) + y_4*p(i, 12))
         rate(i) = (((p(i, 1) + y*(2*p(i, 2))) + y_2*(3*p(i, 3) + y*(4*p(i, 4)))) &
            + y_4*((5*p(i, 5) + y*(6*p(i, 6))) + y_2*(7*p(i, 7) + y*(8*p(i, 8))))) &
            + y_8*((9*p(i, 9) + y*(10*p(i, 10))) + y_2*(11*p(i, 11) + y*(12*p(i, 12))))
      end do
   end subroutine state_at

end module FAST_LOCATE
