!> Exponential collocation over parts of a step, and the events in them: loops to be vectorised.
!>
!> The scheme is that of `rwmf_fast_step`; here the linear equation is solved by its Taylor series,
!> on which impacts and peaks are then located: it is exact in a part, so that no further evaluation
!> of N is needed. Compiled once for each instruction set, like that module: no operation mixes two
!> flights, and all instruction sets give the same bits.
#ifndef FAST_PIECE
#define FAST_PIECE rwmf_fast_piece
#endif
module FAST_PIECE
   use rwmf_fast_lanes, only: c_2, c_3, curves, degree, fast_law_t, flights_t, lanes, step_t, &
      terms, width, wp
   implicit none
   private

   public :: follow_flights, depart_flights, locate_events

   !> What a part needs beside its series.
   type :: part_t
      real(wp) :: d(lanes)
      !! damping of the linear equation times h [-]
      real(wp) :: k(lanes)
      !! its stiffness times h**2 [-]
      real(wp) :: f(lanes, 0:3)
      !! ground acceleration in powers of y [m/s2]
      real(wp) :: g(lanes, 0:3)
      !! forcing without N in powers of y, times h**2 [-]
      real(wp) :: c(lanes, 0:degree, curves)
      !! polynomials of the side
      real(wp) :: slope(lanes)
      !! rate of N at the beginning [1/s3]
      real(wp) :: highest(lanes)
      !! highest difference of N, with the slope at the beginning [1/s2]
      real(wp) :: change(lanes)
      !! of N within the part, as far as it is not yet followed, times h**2 [-]
   end type part_t

contains

   !> Series of whole steps whose differences of N are known.
   pure subroutine follow_flights(law, step, flights)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights
      type(part_t) :: part

      call force_parts(law, step, flights, part)
      call sum_series(flights, part)
   end subroutine follow_flights

   !> Integrate from v = 0 with the rate w over a part of the step.
   !>
   !> The higher differences of N are evaluated only where they are not negligible: late flights of
   !> a chatter need none.
   pure subroutine depart_flights(law, step, flights)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights
      type(part_t) :: part
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      integer :: i

      flights%v(:flights%n) = 0
      call force_parts(law, step, flights, part)
      call choose_side(law, flights, part)
      call begin_remainder(flights, part)
      do i = 1, 3
         if (largest(flights%n, part%change, flights%small) <= 0) exit
         call sum_series(flights, part)
         call end_at(node(i), part, flights)
         call refine(i, part, flights)
      end do
      call sum_series(flights, part)
      call end_at(1.0_wp, part, flights)
      call end_slope(part, flights)
   end subroutine depart_flights

   !> Largest difference of two rows.
   pure real(wp) function largest(n, a, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(lanes)
      real(wp), intent(in) :: b(lanes)
      integer :: i

      largest = -huge(largest)
      !$omp simd reduction(max: largest)
      do i = 1, n
         largest = max(largest, a(i) - b(i))
      end do
   end function largest

   !> Constants of the linear equation and its forcing, without N.
   pure subroutine force_parts(law, step, flights, part)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights
      type(part_t), intent(inout) :: part
      real(wp) :: p_0, p_1, p_2, p_3, x, r, square
      integer :: i

      p_0 = step%f(0)
      p_1 = step%f(1) - c_2*step%f(2) + c_2*c_3*step%f(3)
      p_2 = step%f(2) - step%f(3)
      p_3 = step%f(3)
      !$omp simd private(x, r, square)
      do i = 1, flights%n
         x = flights%x(i)
         r = flights%span(i)
         flights%h(i) = r*step%h
         square = flights%h(i)*flights%h(i)
         part%d(i) = flights%damping(i)*law%m1*flights%h(i)
         part%k(i) = (flights%stiffness(i)*law%m1 + law%m3_1)*square
         part%f(i, 0) = p_0 + x*(p_1 + x*(p_2 + x*p_3))
         part%f(i, 1) = r*(p_1 + x*(2*p_2 + x*3*p_3))
         part%f(i, 2) = r*r*(p_2 + x*3*p_3)
         part%f(i, 3) = r*r*r*p_3
         part%g(i, 0) = square*(-law%m2*flights%side(i)*part%f(i, 0) - law%m3)
         part%g(i, 1) = square*(-law%m2*flights%side(i)*part%f(i, 1))
         part%g(i, 2) = square*(-law%m2*flights%side(i)*part%f(i, 2))
         part%g(i, 3) = square*(-law%m2*flights%side(i)*part%f(i, 3))
      end do
   end subroutine force_parts

   !> v in powers of y: in v'' = - d v' - k v + F with a cubic F every derivative follows from the
   !> two before it.
   pure subroutine sum_series(flights, part)
      type(flights_t), intent(inout) :: flights
      type(part_t), intent(in) :: part
      real(wp) :: d, k, square, f_0, f_1, f_2, f_3
      real(wp) :: p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11
      integer :: i

      associate (p => flights%p, n => flights%n_0)
         !$omp simd private(d, k, square, f_0, f_1, f_2, f_3, p_0, p_1, p_2, p_3, p_4, p_5, p_6, &
         !$omp& p_7, p_8, p_9, p_10, p_11)
         do i = 1, flights%n
            d = part%d(i)
            k = part%k(i)
            square = flights%h(i)*flights%h(i)
            f_0 = part%g(i, 0) + square*n(i, 0)
            f_1 = part%g(i, 1) + square*(n(i, 1) - c_2*n(i, 2) + c_2*c_3*n(i, 3))
            f_2 = part%g(i, 2) + square*(n(i, 2) - n(i, 3))
            f_3 = part%g(i, 3) + square*n(i, 3)
            p_0 = flights%v(i)
            p_1 = flights%h(i)*flights%w(i)
            p_2 = ((f_0 - k*p_0) - d*p_1)*(1/2.0_wp)
            p_3 = ((f_1 - k*p_1) - d*(2*p_2))*(1/6.0_wp)
            p_4 = ((f_2 - k*p_2) - d*(3*p_3))*(1/12.0_wp)
            p_5 = ((f_3 - k*p_3) - d*(4*p_4))*(1/20.0_wp)
            p_6 = (k*p_4 + d*(5*p_5))*(-1/30.0_wp)
            p_7 = (k*p_5 + d*(6*p_6))*(-1/42.0_wp)
            p_8 = (k*p_6 + d*(7*p_7))*(-1/56.0_wp)
            p_9 = (k*p_7 + d*(8*p_8))*(-1/72.0_wp)
            p_10 = (k*p_8 + d*(9*p_9))*(-1/90.0_wp)
            p_11 = (k*p_9 + d*(10*p_10))*(-1/110.0_wp)
            p(i, 0) = p_0
            p(i, 1) = p_1
            p(i, 2) = p_2
            p(i, 3) = p_3
            p(i, 4) = p_4
            p(i, 5) = p_5
            p(i, 6) = p_6
            p(i, 7) = p_7
            p(i, 8) = p_8
            p(i, 9) = p_9
            p(i, 10) = p_10
            p(i, 11) = p_11
            p(i, 12) = (k*p_10 + d*(11*p_11))*(-1/132.0_wp)
            p(i, 13) = 0
         end do
      end associate
   end subroutine sum_series

   !> Polynomials and their derivatives at x, summed in pairs: short chains of operations.
   pure subroutine state_at(n, p, x, value, rate)
      integer, intent(in) :: n
      real(wp), intent(in) :: p(lanes, 0:*)
      real(wp), intent(in) :: x(lanes)
      real(wp), intent(out) :: value(lanes)
      real(wp), intent(out) :: rate(lanes)
      real(wp) :: y, y_2, y_4, y_8
      integer :: i

      !$omp simd private(y, y_2, y_4, y_8)
      do i = 1, n
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

   !> Polynomials of the sides on which the flights are.
   pure subroutine choose_side(law, flights, part)
      type(fast_law_t), intent(in) :: law
      type(flights_t), intent(in) :: flights
      type(part_t), intent(inout) :: part
      integer :: first, i, j, k

      do first = 1, flights%n, width
         do k = 1, curves
            do j = 0, degree
               ! A loop of known length costs one instruction here, others ten times as much.
               !$omp simd
               do i = first, first + width - 1
                  part%c(i, j, k) = merge(law%coef(j, k, 1), law%coef(j, k, 2), &
                     flights%side(i) > 0)
               end do
            end do
         end do
      end do
   end subroutine choose_side

   !> N and its slope at the beginning of a part, and how much N may change in it.
   pure subroutine begin_remainder(flights, part)
      type(flights_t), intent(inout) :: flights
      type(part_t), intent(inout) :: part
      real(wp) :: a
      !! v'' [1/s2]
      real(wp) :: by_v
      !! derivative of N by v [1/s2]
      real(wp) :: w, square, reach
      integer :: i

      associate (c => part%c, n => flights%n_0)
         !$omp simd private(a, by_v, w, square, reach)
         do i = 1, flights%n
            w = flights%w(i)
            square = flights%h(i)*flights%h(i)
            n(i, 0) = c(i, 0, 1)*w*w
            a = part%g(i, 0)/square + n(i, 0) - part%d(i)/flights%h(i)*w
            by_v = -c(i, 0, 2)*flights%damping(i)*w - c(i, 0, 3)*flights%side(i)*part%f(i, 0) &
               - c(i, 0, 4)
            part%slope(i) = w*(c(i, 1, 1)*w*w + 2*c(i, 0, 1)*a + by_v)
            n(i, 1) = flights%h(i)*part%slope(i)
            n(i, 2) = 0
            n(i, 3) = 0
            part%highest(i) = n(i, 1)
            ! From rest at the threshold both the slope and a vanish: what counts is how far the
            ! forcing takes the wall within the part.
            reach = square*abs(a) &
               + (abs(part%g(i, 1)) + abs(part%g(i, 2)) + abs(part%g(i, 3)))
            part%change(i) = square*(abs(n(i, 1)) + reach*abs(2*c(i, 0, 1)*a + by_v))
         end do
      end associate
   end subroutine begin_remainder

   !> State and N at the position y of the parts.
   pure subroutine end_at(y, part, flights)
      real(wp), intent(in) :: y
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: at(lanes), v(lanes), rate(lanes)
      integer :: i

      do i = 1, flights%n
         at(i) = y
      end do
      call state_at(flights%n, flights%p, at, v, rate)
      associate (finish => flights%finish)
         !$omp simd
         do i = 1, flights%n
            finish%v(i) = v(i)
            finish%w(i) = rate(i)/flights%h(i)
         end do
      end associate
      call remainder(y, part, flights)
   end subroutine end_at

   !> N and v D2 at the states reached.
   pure subroutine remainder(y, part, flights)
      real(wp), intent(in) :: y
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: x, w, q, d_1, d_2, h, f
      integer :: i

      associate (c => part%c, finish => flights%finish)
         !$omp simd private(x, w, q, d_1, d_2, h, f)
         do i = 1, flights%n
            x = finish%v(i)
            w = finish%w(i)
            q = c(i, 0, 1) + x*(c(i, 1, 1) + x*(c(i, 2, 1) + x*(c(i, 3, 1) + x*(c(i, 4, 1) &
               + x*(c(i, 5, 1) + x*c(i, 6, 1))))))
            d_1 = c(i, 0, 2) + x*(c(i, 1, 2) + x*(c(i, 2, 2) + x*(c(i, 3, 2) + x*(c(i, 4, 2) &
               + x*(c(i, 5, 2) + x*c(i, 6, 2))))))
            d_2 = c(i, 0, 3) + x*(c(i, 1, 3) + x*(c(i, 2, 3) + x*(c(i, 3, 3) + x*(c(i, 4, 3) &
               + x*(c(i, 5, 3) + x*c(i, 6, 3))))))
            h = c(i, 0, 4) + x*(c(i, 1, 4) + x*(c(i, 2, 4) + x*(c(i, 3, 4) + x*(c(i, 4, 4) &
               + x*(c(i, 5, 4) + x*c(i, 6, 4))))))
            f = part%f(i, 0) + y*(part%f(i, 1) + y*(part%f(i, 2) + y*part%f(i, 3)))
            finish%drive(i) = x*d_2
            finish%n(i) = q*w*w - x*(d_1*(flights%damping(i)*w + flights%stiffness(i)*x) + h) &
               - finish%drive(i)*(flights%side(i)*f)
         end do
      end associate
   end subroutine remainder

   !> Enter the value of N at the next node into its divided differences; the slope at 0 supplies
   !> the highest one until the last value is known.
   pure subroutine refine(node, part, flights)
      integer, intent(in) :: node
      !! 1: c2, 2: c3, 3: 1
      type(part_t), intent(inout) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: first, second, third
      integer :: i

      associate (n => flights%n_0, value => flights%finish%n, h => flights%h)
         select case (node)
         case (1)
            !$omp simd private(first, second)
            do i = 1, flights%n
               first = (value(i) - n(i, 0))*(1/c_2)
               second = (first - part%highest(i))*(1/c_2)
               n(i, 1) = merge(first, n(i, 1), part%change(i) > flights%small(i))
               n(i, 2) = merge(second, 0.0_wp, part%change(i) > flights%small(i))
               part%highest(i) = n(i, 2)
               part%change(i) = merge(h(i)*h(i)*abs(second), 0.0_wp, &
                  part%change(i) > flights%small(i))
            end do
         case (2)
            !$omp simd private(second, third)
            do i = 1, flights%n
               second = ((value(i) - n(i, 0))*(1/c_3) - n(i, 1))*(1/(c_3 - c_2))
               third = (second - part%highest(i))*(1/c_3)
               n(i, 2) = merge(second, n(i, 2), part%change(i) > flights%small(i))
               n(i, 3) = merge(third, 0.0_wp, part%change(i) > flights%small(i))
               part%change(i) = merge(h(i)*h(i)*abs(third), 0.0_wp, &
                  part%change(i) > flights%small(i))
            end do
         case default
            !$omp simd private(third)
            do i = 1, flights%n
               third = (((value(i) - n(i, 0)) - n(i, 1))*(1/(1 - c_2)) - n(i, 2))*(1/(1 - c_3))
               n(i, 3) = merge(third, n(i, 3), part%change(i) > flights%small(i))
            end do
         end select
      end associate
   end subroutine refine

   !> Rate of N at the end of the parts.
   pure subroutine end_slope(part, flights)
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp), parameter :: slope_2 = 2 - c_2
      !! of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! of x (x - c2)(x - c3) at 1
      real(wp), parameter :: short = 1.0e-3_wp
      !! differences over less of a step are round-off; there N has not changed its course
      real(wp) :: slope
      integer :: i

      associate (n => flights%n_0)
         !$omp simd private(slope)
         do i = 1, flights%n
            slope = (n(i, 1) + slope_2*n(i, 2) + slope_3*n(i, 3))/flights%h(i)
            flights%finish%s(i) = merge(part%slope(i), slope, flights%span(i) < short)
         end do
      end associate
   end subroutine end_slope

   !> First return to v = 0 and the largest v before it.
   !>
   !> A flight that starts on the base is asked for v/y, which does not vanish there.
   pure subroutine locate_events(first, flights)
      integer, intent(in) :: first
      !! 0: all start in the air, 1: all start on the base with a velocity
      type(flights_t), intent(inout) :: flights
      real(wp) :: whole(lanes)
      !! 1
      real(wp) :: plain(lanes)
      !! 1: an impact, as it should be
      real(wp) :: v(lanes)
      real(wp) :: slope
      !! of v or v/y at the end
      integer :: i

      associate (p => flights%p, at_end => flights%finish%v)
         !$omp simd private(slope)
         do i = 1, flights%n
            whole(i) = 1
            slope = flights%h(i)*flights%finish%w(i) - first*at_end(i)
            flights%hits(i) = merge(1.0_wp, 0.0_wp, at_end(i) <= 0)
            ! It dips: falls at the beginning, rises at the end. Or it begins with nothing at all.
            flights%is_odd(i) = merge(1.0_wp, 0.0_wp, &
               min(at_end(i), min(-p(i, first + 1), slope)) > 0)
            flights%is_odd(i) = merge(flights%is_odd(i), 1.0_wp, p(i, first) > 0)
            plain(i) = flights%hits(i)*(1 - flights%is_odd(i))
         end do
         call find_roots(flights%n, p(1, first), whole, at_end, plain, flights%y)
         call state_at(flights%n, p, flights%y, v, flights%w_hit)
      end associate
      call find_peaks(flights)
   end subroutine locate_events

   !> Roots of functions that are positive at 0 and negative at `high`: Newton's method from the
   !> parabola through both ends, halving where it would leave.
   pure subroutine find_roots(n, r, high_start, at_high, wanted, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: r(lanes, 0:*)
      real(wp), intent(in) :: high_start(lanes)
      real(wp), intent(in) :: at_high(lanes)
      !! values there
      real(wp), intent(in) :: wanted(lanes)
      !! 1 where there is a root; elsewhere x becomes `high_start`
      real(wp), intent(out) :: x(lanes)
      integer, parameter :: most_iterations = 80
      real(wp), parameter :: near = 1.0e-9_wp
      !! Newton's method is quadratic: what is left after such a correction is round-off
      real(wp) :: low(lanes), high(lanes), active(lanes), value(lanes), slope(lanes)
      real(wp) :: bend, fall, next, steep
      integer :: i, iteration

      x(:n) = high_start(:n)
      if (.not. any_of(n, wanted)) return
      !$omp simd private(bend, fall, next)
      do i = 1, n
         fall = r(i, 1)*high_start(i)
         bend = at_high(i) - r(i, 0) - fall
         ! the root with the same sign as the secant's, without cancellation
         bend = sqrt(max(0.0_wp, fall*fall - 4*bend*r(i, 0))) - fall
         next = 2*r(i, 0)/merge(bend, 1.0_wp, bend > 0)
         next = merge(next, 0.5_wp, bend > 0)
         next = merge(next, 0.5_wp, next < 1)
         next = high_start(i)*merge(next, 0.5_wp, next > 0)
         low(i) = 0
         high(i) = high_start(i)
         active(i) = wanted(i)
         x(i) = merge(next, high_start(i), wanted(i) > 0)
      end do
      do iteration = 1, most_iterations
         call state_at(n, r, x, value, slope)
         !$omp simd private(next, steep)
         do i = 1, n
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
         if (.not. any_of(n, active)) exit
      end do
   end subroutine find_roots

   !> Is one of the marks set?
   pure logical function any_of(n, mark)
      integer, intent(in) :: n
      real(wp), intent(in) :: mark(lanes)
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, n
         total = max(total, mark(i))
      end do
      any_of = total > 0
   end function any_of

   !> Largest v of the flights that may bring a new maximum.
   pure subroutine find_peaks(flights)
      type(flights_t), intent(inout) :: flights
      real(wp) :: r(lanes, 0:terms)
      real(wp) :: wanted(lanes)
      real(wp) :: x(lanes)
      real(wp) :: slope(lanes)
      integer :: i, j

      associate (p => flights%p)
         !$omp simd
         do i = 1, flights%n
            ! A cheap bound: most peaks are far below the largest one.
            wanted(i) = max(p(i, 0) + 1.5_wp*p(i, 1)*flights%y(i) - flights%v_max(i), p(i, 2))
            wanted(i) = merge(1.0_wp, 0.0_wp, min(wanted(i), -flights%w_hit(i)) > 0)
            wanted(i) = wanted(i)*(1 - flights%is_odd(i))
            wanted(i) = merge(wanted(i), 0.0_wp, p(i, 1) > 0)
            flights%peak(i) = 0
         end do
         if (.not. any_of(flights%n, wanted)) return
         do j = 0, terms - 1
            !$omp simd
            do i = 1, flights%n
               r(i, j) = (j + 1)*p(i, j + 1)
            end do
         end do
         r(:flights%n, terms) = 0
         call find_roots(flights%n, r, flights%y, flights%w_hit, wanted, x)
         call state_at(flights%n, p, x, r(:, 0), slope)
      end associate
      !$omp simd
      do i = 1, flights%n
         flights%peak(i) = merge(r(i, 0), 0.0_wp, wanted(i) > 0)
      end do
   end subroutine find_peaks

end module FAST_PIECE
