!> Impacts and peaks on the Taylor series of flights: loops to be vectorised.
!>
!> The series is exact in a part of a step, so that no further evaluation of N is needed. Compiled
!> once for each instruction set, like `rwmf_spectrum_fast_step_kernel`: no operation mixes two
!> flights.
#ifndef FAST_LOCATE
#define FAST_LOCATE rwmf_spectrum_fast_event_kernel
#endif
module FAST_LOCATE
   use rwmf_spectrum_fast_types, only: c_2, c_3, flights_t, terms, width, wp
   implicit none
   private

   public :: locate_events, place_impacts

contains

   !> First return to v = 0 and the largest v before it.
   !>
   !> A flight that starts on the base is asked for v/y, which does not vanish there.
   pure subroutine locate_events(first, flights)
      integer, intent(in) :: first
      !! 0: all start in the air, 1: all start on the base with a velocity
      type(flights_t), intent(inout) :: flights
      real(wp) :: whole(width)
      !! 1
      real(wp) :: plain(width)
      !! 1: an impact, as it should be
      real(wp) :: v(width)
      real(wp) :: slope
      !! of v or v/y at the end
      real(wp) :: both
      integer :: i

      associate (p => flights%p, at_end => flights%finish%v)
         !$omp simd private(slope, both)
         do i = 1, width
            whole(i) = 1
            slope = flights%h(i)*flights%finish%w(i) - first*at_end(i)
            flights%hits(i) = merge(1.0_wp, 0.0_wp, at_end(i) <= 0)
            ! It dips: falls at the beginning, rises at the end. Or it begins with nothing at all.
            flights%is_odd(i) = merge(1.0_wp, 0.0_wp, &
               min(at_end(i), min(-p(i, first + 1), slope)) > 0)
            flights%is_odd(i) = merge(flights%is_odd(i), 1.0_wp, p(i, first) > 0)
            ! v' may change its sign twice: see `happens` of rwmf_fast_node.
            slope = flights%h(i)*flights%finish%w(i)
            both = p(i, 1) + slope
            flights%is_odd(i) = max(flights%is_odd(i), merge(1.0_wp, 0.0_wp, min(p(i, 1)*slope, &
               min(both*(both - 3*(at_end(i) - p(i, 0))), &
               0.25_wp*abs(both) + max(max(p(i, 0), at_end(i)) - flights%v_max(i), &
               -min(p(i, 0), at_end(i))))) > 0))
            plain(i) = flights%hits(i)*(1 - flights%is_odd(i))
         end do
         call find_roots(p(1, first), whole, at_end, plain, flights%y)
         call state_at(p, flights%y, v, flights%w_hit)
      end associate
      call place_impacts(flights)
      call find_peaks(flights)
   end subroutine locate_events

   !> Impacts in the time of the step.
   pure subroutine place_impacts(flights)
      type(flights_t), intent(inout) :: flights
      real(wp), parameter :: last_x = 1 - 1.0e-13_wp
      !! an impact on the very end of a step leaves a last part that is only formally one
      real(wp) :: x
      integer :: i

      associate (f => flights%f)
         !$omp simd private(x)
         do i = 1, width
            x = min(flights%x(i) + flights%span(i)*flights%y(i), last_x)
            flights%x_hit(i) = x
            flights%speed(i) = -flights%w_hit(i)/(flights%span(i)*flights%step(i))
            flights%f_hit(i) = f(i, 0) + x*(f(i, 1) + (x - c_2)*(f(i, 2) + (x - c_3)*f(i, 3)))
         end do
      end associate
   end subroutine place_impacts

   !> Roots of functions that are positive at 0 and negative at `high`: Newton's method from the
   !> parabola through both ends, halving where it would leave.
   pure subroutine find_roots(r, high_start, at_high, wanted, x)
      real(wp), intent(in) :: r(width, 0:terms)
      real(wp), intent(in) :: high_start(width)
      real(wp), intent(in) :: at_high(width)
      !! values there
      real(wp), intent(in) :: wanted(width)
      !! 1 where there is a root; elsewhere x becomes `high_start`
      real(wp), intent(out) :: x(width)
      integer, parameter :: most_iterations = 80
      real(wp), parameter :: near = 1.0e-7_wp
      !! Newton's method is quadratic: what is left after such a correction is round-off
      real(wp) :: low(width), high(width), active(width), value(width), slope(width)
      real(wp) :: bend, fall, next, steep
      integer :: i, iteration

      x = high_start
      if (.not. any_of(wanted)) return
      !$omp simd private(bend, fall, next)
      do i = 1, width
         fall = r(i, 1)*high_start(i)
         bend = at_high(i) - r(i, 0) - fall
         ! the root with the same sign as the secant's, without cancellation
         bend = sqrt(max(0.0_wp, fall*fall - 4*bend*r(i, 0))) - fall
         ! elsewhere than in the bracket, or without a root, from its middle
         next = 2*r(i, 0)/merge(bend, 1.0_wp, bend > 2*abs(r(i, 0)))
         next = merge(next, 0.5_wp, bend > 2*abs(r(i, 0)))
         next = high_start(i)*merge(next, 0.5_wp, next > 0)
         low(i) = 0
         high(i) = high_start(i)
         active(i) = wanted(i)
         x(i) = merge(next, high_start(i), wanted(i) > 0)
      end do
      do iteration = 1, most_iterations
         call state_at(r, x, value, slope)
         !$omp simd private(next, steep)
         do i = 1, width
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

   !> Is one of the marks set?
   pure logical function any_of(mark)
      real(wp), intent(in) :: mark(width)
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, width
         total = max(total, mark(i))
      end do
      any_of = total > 0
   end function any_of

   !> Largest v of the flights that may bring a new maximum.
   pure subroutine find_peaks(flights)
      type(flights_t), intent(inout) :: flights
      real(wp) :: r(width, 0:terms)
      real(wp) :: wanted(width)
      real(wp) :: x(width)
      real(wp) :: slope(width)
      integer :: i, j

      associate (p => flights%p)
         !$omp simd
         do i = 1, width
            ! A cheap bound: most peaks are far below the largest one.
            wanted(i) = max(p(i, 0) + 1.5_wp*p(i, 1)*flights%y(i) - flights%v_max(i), p(i, 2))
            wanted(i) = merge(1.0_wp, 0.0_wp, min(wanted(i), -flights%w_hit(i)) > 0)
            wanted(i) = wanted(i)*(1 - flights%is_odd(i))
            wanted(i) = merge(wanted(i), 0.0_wp, p(i, 1) > 0)
            flights%peak(i) = 0
         end do
         if (.not. any_of(wanted)) return
         do j = 0, terms - 1
            !$omp simd
            do i = 1, width
               r(i, j) = (j + 1)*p(i, j + 1)
            end do
         end do
         r(:, terms) = 0
         call find_roots(r, flights%y, flights%w_hit, wanted, x)
         call state_at(p, x, r(:, 0), slope)
      end associate
      !$omp simd
      do i = 1, width
         flights%peak(i) = merge(r(i, 0), 0.0_wp, wanted(i) > 0)
      end do
   end subroutine find_peaks

   !> Polynomials and their derivatives at x, summed in pairs: short chains of operations.
   pure subroutine state_at(p, x, value, rate)
      real(wp), intent(in) :: p(width, 0:terms)
      real(wp), intent(in) :: x(width)
      real(wp), intent(out) :: value(width)
      real(wp), intent(out) :: rate(width)
      real(wp) :: y, y_2, y_4, y_8
      integer :: i

      !$omp simd private(y, y_2, y_4, y_8)
      do i = 1, width
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
