!> Exponential collocation over parts of a step: loops to be vectorised.
!>
!> The scheme is that of `rwmf_spectrum_fast_step_kernel`, with other nodes for two evaluations of N
!> (c3 and 1); here the linear equation is solved by its Taylor series, on which events are then
!> located (`rwmf_spectrum_fast_event_kernel`). Compiled once for each instruction set,
!> like that module: no operation mixes two flights, and all instruction sets give the same bits.
#ifndef FAST_PIECE
#define FAST_PIECE rwmf_spectrum_fast_substep_kernel
#define FAST_LOCATE rwmf_spectrum_fast_event_kernel
#endif
module FAST_PIECE
   use rwmf_spectrum_fast_types, only: c_2, c_3, flights_t, terms, width, wp
   implicit none
   private

   public :: follow_flights, depart_flights, rebound_flights

   !> What a part needs beside its series.
   type :: part_t
      real(wp) :: d(width)
      !! damping of the linear equation times h [-]
      real(wp) :: k(width)
      !! its stiffness times h**2 [-]
      real(wp) :: f(width, 0:3)
      !! ground acceleration in powers of y [m/s2]
      real(wp) :: g(width, 0:3)
      !! forcing without N in powers of y, times h**2 [-]
      real(wp) :: slope(width)
      !! rate of N at the beginning [1/s3]
      real(wp) :: highest(width)
      !! highest difference of N, with the slope at the beginning [1/s2]
      real(wp) :: change(width)
      !! of N within the part, as far as it is not yet followed, times h**2 [-]
   end type part_t

contains

   !> Series of whole steps whose differences of N are known.
   pure subroutine follow_flights(flights)
      type(flights_t), intent(inout) :: flights
      type(part_t) :: part

      call force_parts(flights, part)
      call sum_series(flights, part)
   end subroutine follow_flights

   !> Integrate from v = 0 with the rate w over a part of the step.
   !>
   !> As many evaluations of N make a part as a whole step, at the last ones of the nodes. They are
   !> made only where what they find is not negligible: late flights of a chatter need none.
   pure subroutine depart_flights(flights)
      type(flights_t), intent(inout) :: flights
      type(part_t) :: part
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      real(wp) :: wanted(width)
      !! 1: N at the node
      logical :: is_wanted
      integer :: i

      flights%v = 0
      flights%w_begin = flights%w
      call force_parts(flights, part)
      call begin_remainder(flights, part)
      do i = 1, size(node)
         call choose_flights(i, flights, part, wanted, is_wanted)
         if (.not. is_wanted) cycle
         call sum_series(flights, part)
         call end_at(node(i), flights)
         call remainder(node(i), part, flights)
         select case (i)
         case (1)
            call enter_first(wanted, part, flights)
         case (2)
            call enter_second(wanted, part, flights)
         case default
            call enter_last(wanted, part, flights)
         end select
      end do
      call sum_series(flights, part)
      call end_at(1.0_wp, flights)
      ! N at the end is that of the state predicted there, as in whole steps.
      if (.not. is_wanted) call remainder(1.0_wp, part, flights)
      call end_slope(part, flights)
   end subroutine depart_flights

   !> The flights that call for N at a node.
   pure subroutine choose_flights(node, flights, part, wanted, is_wanted)
      integer, intent(in) :: node
      !! 1: c2, 2: c3, 3: 1
      type(flights_t), intent(in) :: flights
      type(part_t), intent(in) :: part
      real(wp), intent(out) :: wanted(width)
      logical, intent(out) :: is_wanted
      !! by one of them
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, width
         wanted(i) = merge(1.0_wp, 0.0_wp, min(part%change(i) - flights%small(i), &
            flights%stages(i) + node - 3.5_wp) > 0)
         total = max(total, wanted(i))
      end do
      is_wanted = total > 0
   end subroutine choose_flights

   !> Where flights met the base others begin: position, rate, side, and for how much of the step
   !> they are followed.
   !>
   !> When a flight is expected to take much less than the rest of the step, that is some more than
   !> this time.
   pure subroutine rebound_flights(negligible, flights)
      real(wp), intent(in) :: negligible
      !! change of v by N over the largest v [-]
      type(flights_t), intent(inout) :: flights
      real(wp), parameter :: tiny_part = 1.0e-12_wp
      real(wp) :: f, press, slow, pull, span, brief
      integer :: i

      associate (hits => flights%hits, w => flights%w, x => flights%x, side => flights%side)
         !$omp simd private(f, press, slow, pull, span, brief)
         do i = 1, width
            flights%v_max(i) = max(flights%v_max(i), flights%peak(i))
            flights%small(i) = negligible*flights%v_max(i)
            w(i) = merge(flights%e(i)*flights%speed(i), w(i), hits(i) > 0)
            x(i) = merge(flights%x_hit(i), x(i), hits(i) > 0)
            side(i) = merge(-side(i), side(i), hits(i) > 0)
            ! A chatter that ends has flights that begin slower and slower. In a step that can lift
            ! the wall only what is negligible is dropped.
            f = flights%f(i, 0) + (flights%f(i, 1) + (1 - c_2)*(flights%f(i, 2) &
               + (1 - c_3)*flights%f(i, 3)))
            f = max(abs(flights%f(i, 0)), abs(f))
            press = flights%m2(i)*(flights%threshold(i) - abs(flights%f_hit(i)))
            slow = press*flights%v_max(i)*merge(tiny_part, 1.0_wp, f > flights%threshold(i))
            slow = max(flights%idle(i) - w(i), slow - w(i)*w(i))
            flights%may_rest(i) = merge(1.0_wp, 0.0_wp, &
               min(press, min(flights%w_begin(i) - w(i), slow)) > 0)
            pull = flights%m3(i) + flights%m2(i)*side(i)*flights%f_hit(i) &
               + flights%m1(i)*flights%damping(i)*w(i)
            pull = pull*flights%step(i)
            span = 1 - x(i)
            brief = 2.5_wp*w(i)
            span = merge(brief/merge(pull, 1.0_wp, pull > 0), span, brief < 0.5_wp*span*pull)
            flights%span(i) = merge(span, flights%span(i), hits(i) > 0)
         end do
      end associate
   end subroutine rebound_flights

   !> Constants of the linear equation and its forcing, without N.
   pure subroutine force_parts(flights, part)
      type(flights_t), intent(inout) :: flights
      type(part_t), intent(inout) :: part
      real(wp) :: p_0, p_1, p_2, p_3, x, r, square
      integer :: i

      !$omp simd private(p_0, p_1, p_2, p_3, x, r, square)
      do i = 1, width
         p_0 = flights%f(i, 0)
         p_1 = flights%f(i, 1) - c_2*flights%f(i, 2) + c_2*c_3*flights%f(i, 3)
         p_2 = flights%f(i, 2) - flights%f(i, 3)
         p_3 = flights%f(i, 3)
         x = flights%x(i)
         r = flights%span(i)
         flights%h(i) = r*flights%step(i)
         square = flights%h(i)*flights%h(i)
         part%d(i) = flights%damping(i)*flights%m1(i)*flights%h(i)
         part%k(i) = (flights%stiffness(i)*flights%m1(i) + flights%m3_1(i))*square
         part%f(i, 0) = p_0 + x*(p_1 + x*(p_2 + x*p_3))
         part%f(i, 1) = r*(p_1 + x*(2*p_2 + x*3*p_3))
         part%f(i, 2) = r*r*(p_2 + x*3*p_3)
         part%f(i, 3) = r*r*r*p_3
         part%g(i, 0) = square*(-flights%m2(i)*flights%side(i)*part%f(i, 0) - flights%m3(i))
         part%g(i, 1) = square*(-flights%m2(i)*flights%side(i)*part%f(i, 1))
         part%g(i, 2) = square*(-flights%m2(i)*flights%side(i)*part%f(i, 2))
         part%g(i, 3) = square*(-flights%m2(i)*flights%side(i)*part%f(i, 3))
      end do
   end subroutine force_parts

   !> v in powers of y: in v'' = - d v' - k v + F with a cubic F every derivative follows from the
   !> two before it.
   !>
   !> What does not depend on the term before is computed apart: the processor then waits for one
   !> product and one sum a term.
   pure subroutine sum_series(flights, part)
      type(flights_t), intent(inout) :: flights
      type(part_t), intent(in) :: part
      real(wp) :: d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11
      integer :: i

      associate (p => flights%p, n => flights%n_0)
         !$omp simd private(d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, &
         !$omp& p_11)
         do i = 1, width
            d = part%d(i)
            k = part%k(i)
            square = flights%h(i)*flights%h(i)
            p_0 = flights%v(i)
            p_1 = flights%h(i)*flights%w(i)
            p_2 = (((part%g(i, 0) + square*n(i, 0)) - k*p_0) - d*p_1)*(1/2.0_wp)
            p_3 = ((part%g(i, 1) + square*((n(i, 1) - c_2*n(i, 2)) + c_2*c_3*n(i, 3))) - k*p_1) &
               *(1/6.0_wp) - (d*(2/6.0_wp))*p_2
            p_4 = ((part%g(i, 2) + square*(n(i, 2) - n(i, 3))) - k*p_2)*(1/12.0_wp) &
               - (d*(3/12.0_wp))*p_3
            p_5 = ((part%g(i, 3) + square*n(i, 3)) - k*p_3)*(1/20.0_wp) - (d*(4/20.0_wp))*p_4
            p_6 = (k*(-1/30.0_wp))*p_4 - (d*(5/30.0_wp))*p_5
            p_7 = (k*(-1/42.0_wp))*p_5 - (d*(6/42.0_wp))*p_6
            p_8 = (k*(-1/56.0_wp))*p_6 - (d*(7/56.0_wp))*p_7
            p_9 = (k*(-1/72.0_wp))*p_7 - (d*(8/72.0_wp))*p_8
            p_10 = (k*(-1/90.0_wp))*p_8 - (d*(9/90.0_wp))*p_9
            p_11 = (k*(-1/110.0_wp))*p_9 - (d*(10/110.0_wp))*p_10
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
            p(i, 12) = (k*(-1/132.0_wp))*p_10 - (d*(11/132.0_wp))*p_11
            p(i, 13) = 0
         end do
      end associate
   end subroutine sum_series

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

      associate (c => flights%coef, n => flights%n_0)
         !$omp simd private(a, by_v, w, square, reach)
         do i = 1, width
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

   !> State at the position y of the parts.
   pure subroutine end_at(y, flights)
      real(wp), intent(in) :: y
      type(flights_t), intent(inout) :: flights
      real(wp) :: a(terms)
      !! what the coefficients contribute to v
      real(wp) :: b(terms)
      !! to its rate per part
      integer :: i

      a(1) = y
      b(1) = 1
      do i = 2, terms
         a(i) = a(i - 1)*y
         b(i) = i*a(i - 1)
      end do
      associate (finish => flights%finish, p => flights%p)
         !$omp simd
         do i = 1, width
            finish%v(i) = (((p(i, 0) + a(1)*p(i, 1)) + (a(2)*p(i, 2) + a(3)*p(i, 3))) &
               + ((a(4)*p(i, 4) + a(5)*p(i, 5)) + (a(6)*p(i, 6) + a(7)*p(i, 7)))) &
               + (((a(8)*p(i, 8) + a(9)*p(i, 9)) + (a(10)*p(i, 10) + a(11)*p(i, 11))) &
               + a(12)*p(i, 12))
            finish%w(i) = ((((p(i, 1) + b(2)*p(i, 2)) + (b(3)*p(i, 3) + b(4)*p(i, 4))) &
               + ((b(5)*p(i, 5) + b(6)*p(i, 6)) + (b(7)*p(i, 7) + b(8)*p(i, 8)))) &
               + ((b(9)*p(i, 9) + b(10)*p(i, 10)) + (b(11)*p(i, 11) + b(12)*p(i, 12)))) &
               /flights%h(i)
         end do
      end associate
   end subroutine end_at

   !> N and v D2 at the states reached.
   pure subroutine remainder(y, part, flights)
      real(wp), intent(in) :: y
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: x, x_2, x_4, w, q, d_1, d_2, h, f
      integer :: i

      associate (c => flights%coef, finish => flights%finish)
         !$omp simd private(x, x_2, x_4, w, q, d_1, d_2, h, f)
         do i = 1, width
            x = finish%v(i)
            x_2 = x*x
            x_4 = x_2*x_2
            w = finish%w(i)
            q = ((c(i, 0, 1) + x*c(i, 1, 1)) + x_2*(c(i, 2, 1) + x*c(i, 3, 1))) &
               + x_4*((c(i, 4, 1) + x*c(i, 5, 1)) + x_2*c(i, 6, 1))
            d_1 = ((c(i, 0, 2) + x*c(i, 1, 2)) + x_2*(c(i, 2, 2) + x*c(i, 3, 2))) &
               + x_4*((c(i, 4, 2) + x*c(i, 5, 2)) + x_2*c(i, 6, 2))
            d_2 = ((c(i, 0, 3) + x*c(i, 1, 3)) + x_2*(c(i, 2, 3) + x*c(i, 3, 3))) &
               + x_4*((c(i, 4, 3) + x*c(i, 5, 3)) + x_2*c(i, 6, 3))
            h = ((c(i, 0, 4) + x*c(i, 1, 4)) + x_2*(c(i, 2, 4) + x*c(i, 3, 4))) &
               + x_4*((c(i, 4, 4) + x*c(i, 5, 4)) + x_2*c(i, 6, 4))
            f = part%f(i, 0) + y*(part%f(i, 1) + y*(part%f(i, 2) + y*part%f(i, 3)))
            finish%drive(i) = x*d_2
            finish%n(i) = q*w*w - x*(d_1*(flights%damping(i)*w + flights%stiffness(i)*x) + h) &
               - finish%drive(i)*(flights%side(i)*f)
         end do
      end associate
   end subroutine remainder

   !> Enter the value of N at c2 into its divided differences; the slope at 0 supplies the highest
   !> one.
   pure subroutine enter_first(wanted, part, flights)
      real(wp), intent(in) :: wanted(width)
      !! 1: enter it
      type(part_t), intent(inout) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: first, second
      integer :: i

      associate (n => flights%n_0, value => flights%finish%n, h => flights%h)
         !$omp simd private(first, second)
         do i = 1, width
            first = (value(i) - n(i, 0))*(1/c_2)
            second = (first - part%highest(i))*(1/c_2)
            n(i, 1) = merge(first, n(i, 1), wanted(i) > 0)
            n(i, 2) = merge(second, n(i, 2), wanted(i) > 0)
            part%highest(i) = merge(second, part%highest(i), wanted(i) > 0)
            part%change(i) = merge(h(i)*h(i)*abs(second), part%change(i), wanted(i) > 0)
         end do
      end associate
   end subroutine enter_first

   !> Enter the value at c3, after that at c2 (three evaluations) or after the slope (two).
   pure subroutine enter_second(wanted, part, flights)
      real(wp), intent(in) :: wanted(width)
      type(part_t), intent(inout) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: first, second, third, of_three
      integer :: i

      associate (n => flights%n_0, value => flights%finish%n, h => flights%h)
         !$omp simd private(first, second, third, of_three)
         do i = 1, width
            of_three = flights%stages(i) - 2.5_wp
            first = (value(i) - n(i, 0))*(1/c_3) - n(i, 1)
            second = first*merge(1/(c_3 - c_2), 1/c_3, of_three > 0)
            third = merge((second - part%highest(i))*(1/c_3), 0.0_wp, of_three > 0)
            ! x**2 is x (x - c2) + c2 x
            first = n(i, 1) + merge(0.0_wp, c_2*second, of_three > 0)
            n(i, 1) = merge(first, n(i, 1), wanted(i) > 0)
            n(i, 2) = merge(second, n(i, 2), wanted(i) > 0)
            n(i, 3) = merge(third, n(i, 3), wanted(i) > 0)
            part%highest(i) = merge(second, part%highest(i), wanted(i) > 0)
            third = merge(third, second, of_three > 0)
            part%change(i) = merge(h(i)*h(i)*abs(third), part%change(i), wanted(i) > 0)
         end do
      end associate
   end subroutine enter_second

   !> Enter the value at 1, after those at c2 and c3, after the slope and that at c3, or after the
   !> slope.
   pure subroutine enter_last(wanted, part, flights)
      real(wp), intent(in) :: wanted(width)
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp), parameter :: to_first = c_2*(c_2 - c_3)
      !! x**2 (x - c3) = x (x - c2)(x - c3) + c2 x (x - c2) + to_first x
      real(wp) :: bend, square, cube, third
      integer :: i

      associate (n => flights%n_0, value => flights%finish%n, stages => flights%stages)
         !$omp simd private(bend, square, cube, third)
         do i = 1, width
            third = (((value(i) - n(i, 0)) - n(i, 1))*(1/(1 - c_2)) - n(i, 2))*(1/(1 - c_3))
            bend = (value(i) - n(i, 0)) - flights%h(i)*part%slope(i)
            ! of x**2 with one evaluation, of x**2 (x - c3) with two
            square = merge(bend, 0.0_wp, stages(i) < 1.5_wp)
            cube = merge((bend - part%highest(i))*(1/(1 - c_3)), 0.0_wp, &
               abs(stages(i) - 2) < 0.5_wp)
            third = merge(third, cube, stages(i) > 2.5_wp)
            n(i, 1) = n(i, 1) + merge(c_2*square + to_first*cube, 0.0_wp, wanted(i) > 0)
            n(i, 2) = n(i, 2) + merge(square + c_2*cube, 0.0_wp, wanted(i) > 0)
            n(i, 3) = merge(third, n(i, 3), wanted(i) > 0)
         end do
      end associate
   end subroutine enter_last

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
         do i = 1, width
            slope = (n(i, 1) + slope_2*n(i, 2) + slope_3*n(i, 3))/flights%h(i)
            flights%finish%s(i) = merge(part%slope(i), slope, flights%span(i) < short)
         end do
      end associate
   end subroutine end_slope

end module FAST_PIECE
