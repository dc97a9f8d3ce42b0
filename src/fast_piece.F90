!> Exponential collocation over parts of a step: loops to be vectorised.
!>
!> The scheme is that of `rwmf_fast_step`; here the linear equation is solved by its Taylor series,
!> on which events are then located (`rwmf_fast_locate`). Compiled once for each instruction set,
!> like that module: no operation mixes two flights, and all instruction sets give the same bits.
#ifndef FAST_PIECE
#define FAST_PIECE rwmf_fast_piece
#define FAST_LOCATE rwmf_fast_locate
#endif
module FAST_PIECE
   use FAST_LOCATE, only: state_at
   use rwmf_fast_lanes, only: c_2, c_3, flights_t, width, wp
   implicit none
   private

   public :: follow_flights, depart_flights

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
   !> The higher differences of N are evaluated only where they are not negligible: late flights of
   !> a chatter need none.
   pure subroutine depart_flights(flights)
      type(flights_t), intent(inout) :: flights
      type(part_t) :: part
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      integer :: i

      flights%v = 0
      call force_parts(flights, part)
      call begin_remainder(flights, part)
      do i = 1, 3
         if (largest(part%change, flights%small) <= 0) exit
         call sum_series(flights, part)
         call end_at(node(i), part, flights)
         call refine(i, part, flights)
      end do
      call sum_series(flights, part)
      call end_at(1.0_wp, part, flights)
      call end_slope(part, flights)
   end subroutine depart_flights

   !> Largest difference of two rows.
   pure real(wp) function largest(a, b)
      real(wp), intent(in) :: a(width)
      real(wp), intent(in) :: b(width)
      integer :: i

      largest = -huge(largest)
      !$omp simd reduction(max: largest)
      do i = 1, width
         largest = max(largest, a(i) - b(i))
      end do
   end function largest

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

   !> State and N at the position y of the parts.
   pure subroutine end_at(y, part, flights)
      real(wp), intent(in) :: y
      type(part_t), intent(in) :: part
      type(flights_t), intent(inout) :: flights
      real(wp) :: at(width), v(width), rate(width)
      integer :: i

      do i = 1, width
         at(i) = y
      end do
      call state_at(flights%p, at, v, rate)
      associate (finish => flights%finish)
         !$omp simd
         do i = 1, width
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
            do i = 1, width
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
            do i = 1, width
               second = ((value(i) - n(i, 0))*(1/c_3) - n(i, 1))*(1/(c_3 - c_2))
               third = (second - part%highest(i))*(1/c_3)
               n(i, 2) = merge(second, n(i, 2), part%change(i) > flights%small(i))
               n(i, 3) = merge(third, 0.0_wp, part%change(i) > flights%small(i))
               part%change(i) = merge(h(i)*h(i)*abs(third), 0.0_wp, &
                  part%change(i) > flights%small(i))
            end do
         case default
            !$omp simd private(third)
            do i = 1, width
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
         do i = 1, width
            slope = (n(i, 1) + slope_2*n(i, 2) + slope_3*n(i, 3))/flights%h(i)
            flights%finish%s(i) = merge(part%slope(i), slope, flights%span(i) < short)
         end do
      end associate
   end subroutine end_slope

end module FAST_PIECE
