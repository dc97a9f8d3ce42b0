!> Exponential collocation over substeps: loops to be vectorised.
!>
!> The scheme is that of `rwmf_spectrum_fast_step_kernel`, with other nodes for two evaluations of N
!> (c3 and 1); here the linear equation is solved by its Taylor series, on which events are then
!> located (`rwmf_spectrum_fast_event_kernel`). Compiled once for each instruction set, like that
!> module: no operation mixes two substeps, and all instruction sets give the same bits.
#ifndef FAST_PIECE
#define FAST_PIECE rwmf_spectrum_fast_substep_kernel
#define FAST_LOCATE rwmf_spectrum_fast_event_kernel
#endif
module FAST_PIECE
   use rwmf_spectrum_fast_types, only: batch_width, c_2, c_3, substep_batch_t, terms, wp
   implicit none
   private

   public :: expand_steps, integrate_substeps, rebound_substeps

   !> Intermediate results of a batch. y: position in the substep.
   type :: substep_work_t
      real(wp) :: d(batch_width)
      !! damping of the linear equation times h [-]
      real(wp) :: k(batch_width)
      !! its stiffness times h**2 [-]
      real(wp) :: f(batch_width, 0:3)
      !! ground acceleration in powers of y [m/s2]
      real(wp) :: g(batch_width, 0:3)
      !! forcing without N in powers of y, times h**2 [-]
      real(wp) :: slope(batch_width)
      !! rate of N at the beginning [1/s3]
      real(wp) :: highest_difference(batch_width)
      !! highest divided difference of N, that with the slope at the beginning [1/s2]
      real(wp) :: remaining_change(batch_width)
      !! bound of the change of N in the substep beyond its differences so far, times h**2 [-]
   end type substep_work_t

contains

   !> Taylor series of whole steps, from their differences of N.
   pure subroutine expand_steps(batch)
      type(substep_batch_t), intent(inout) :: batch
      type(substep_work_t) :: work

      call set_forcing(batch, work)
      call expand_series(batch, work)
   end subroutine expand_steps

   !> Integrate from v = 0 with the rate w over a substep.
   !>
   !> A substep takes as many evaluations of N as a whole step, at the last of the nodes. An
   !> evaluation whose effect is negligible is left out: late flights of a chatter need none.
   pure subroutine integrate_substeps(batch)
      type(substep_batch_t), intent(inout) :: batch
      type(substep_work_t) :: work
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      real(wp) :: wanted(batch_width)
      !! 1: evaluate N at the node
      logical :: is_wanted
      integer :: i

      batch%v = 0
      batch%w_begin = batch%w
      call set_forcing(batch, work)
      call start_remainder(batch, work)
      do i = 1, size(node)
         call select_substeps(i, batch, work, wanted, is_wanted)
         if (.not. is_wanted) cycle
         call expand_series(batch, work)
         call evaluate_series(node(i), batch)
         call evaluate_remainder(node(i), work, batch)
         select case (i)
         case (1)
            call enter_value_at_c2(wanted, work, batch)
         case (2)
            call enter_value_at_c3(wanted, work, batch)
         case default
            call enter_value_at_1(wanted, work, batch)
         end select
      end do
      call expand_series(batch, work)
      call evaluate_series(1.0_wp, batch)
      ! As in whole steps, N at the end is that of the predicted state.
      if (.not. is_wanted) call evaluate_remainder(1.0_wp, work, batch)
      call set_end_slope(work, batch)
   end subroutine integrate_substeps

   !> Select the substeps that need N at a node.
   pure subroutine select_substeps(node, batch, work, wanted, is_wanted)
      integer, intent(in) :: node
      !! 1: c2, 2: c3, 3: 1
      type(substep_batch_t), intent(in) :: batch
      type(substep_work_t), intent(in) :: work
      real(wp), intent(out) :: wanted(batch_width)
      logical, intent(out) :: is_wanted
      !! some substep needs it
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, batch_width
         wanted(i) = merge(1.0_wp, 0.0_wp, min(work%remaining_change(i) &
            - batch%negligible_change(i), batch%stages(i) + node - 3.5_wp) > 0)
         total = max(total, wanted(i))
      end do
      is_wanted = total > 0
   end subroutine select_substeps

   !> Set up the flights that follow the impacts: position, rate, side, length of the substep.
   !>
   !> The substep is the rest of the step, or 1.25 times the expected duration of the flight where
   !> that is much shorter.
   pure subroutine rebound_substeps(remainder_share, batch)
      real(wp), intent(in) :: remainder_share
      !! change of v by N that is left out, over the largest v [-]
      type(substep_batch_t), intent(inout) :: batch
      real(wp), parameter :: tiny_part = 1.0e-12_wp
      real(wp) :: f, pressure, slowness, deceleration, span, expected
      integer :: i

      associate (has_impact => batch%has_impact, w => batch%w, x => batch%x, side => batch%side)
         !$omp simd private(f, pressure, slowness, deceleration, span, expected)
         do i = 1, batch_width
            batch%v_max(i) = max(batch%v_max(i), batch%peak(i))
            batch%negligible_change(i) = remainder_share*batch%v_max(i)
            w(i) = merge(batch%e(i)*batch%impact_speed(i), w(i), has_impact(i) > 0)
            x(i) = merge(batch%x_impact(i), x(i), has_impact(i) > 0)
            side(i) = merge(-side(i), side(i), has_impact(i) > 0)
            ! Rest is considered where the flights of a chatter begin ever slower; in a step that
            ! can lift the wall only where the velocity left is negligible.
            f = batch%f(i, 0) + (batch%f(i, 1) + (1 - c_2)*(batch%f(i, 2) &
               + (1 - c_3)*batch%f(i, 3)))
            f = max(abs(batch%f(i, 0)), abs(f))
            pressure = batch%m2(i)*(batch%threshold(i) - abs(batch%f_impact(i)))
            slowness = pressure*batch%v_max(i)*merge(tiny_part, 1.0_wp, f > batch%threshold(i))
            slowness = max(batch%negligible_velocity(i) - w(i), slowness - w(i)*w(i))
            batch%may_rest(i) = merge(1.0_wp, 0.0_wp, &
               min(pressure, min(batch%w_begin(i) - w(i), slowness)) > 0)
            deceleration = batch%m3(i) + batch%m2(i)*side(i)*batch%f_impact(i) &
               + batch%m1(i)*batch%damping(i)*w(i)
            deceleration = deceleration*batch%h_step(i)
            span = 1 - x(i)
            expected = 2.5_wp*w(i)
            span = merge(expected/merge(deceleration, 1.0_wp, deceleration > 0), span, &
               expected < 0.5_wp*span*deceleration)
            batch%span(i) = merge(span, batch%span(i), has_impact(i) > 0)
         end do
      end associate
   end subroutine rebound_substeps

   !> Coefficients of the linear equation and its forcing without N, in the position y.
   pure subroutine set_forcing(batch, work)
      type(substep_batch_t), intent(inout) :: batch
      type(substep_work_t), intent(inout) :: work
      real(wp) :: p_0, p_1, p_2, p_3, x, r, square
      integer :: i

      !$omp simd private(p_0, p_1, p_2, p_3, x, r, square)
      do i = 1, batch_width
         p_0 = batch%f(i, 0)
         p_1 = batch%f(i, 1) - c_2*batch%f(i, 2) + c_2*c_3*batch%f(i, 3)
         p_2 = batch%f(i, 2) - batch%f(i, 3)
         p_3 = batch%f(i, 3)
         x = batch%x(i)
         r = batch%span(i)
         batch%h(i) = r*batch%h_step(i)
         square = batch%h(i)*batch%h(i)
         work%d(i) = batch%damping(i)*batch%m1(i)*batch%h(i)
         work%k(i) = (batch%stiffness(i)*batch%m1(i) + batch%m3_1(i))*square
         work%f(i, 0) = p_0 + x*(p_1 + x*(p_2 + x*p_3))
         work%f(i, 1) = r*(p_1 + x*(2*p_2 + x*3*p_3))
         work%f(i, 2) = r*r*(p_2 + x*3*p_3)
         work%f(i, 3) = r*r*r*p_3
         work%g(i, 0) = square*(-batch%m2(i)*batch%side(i)*work%f(i, 0) - batch%m3(i))
         work%g(i, 1) = square*(-batch%m2(i)*batch%side(i)*work%f(i, 1))
         work%g(i, 2) = square*(-batch%m2(i)*batch%side(i)*work%f(i, 2))
         work%g(i, 3) = square*(-batch%m2(i)*batch%side(i)*work%f(i, 3))
      end do
   end subroutine set_forcing

   !> v in powers of y: in v'' = - d v' - k v + F with a cubic F every derivative follows from the
   !> two before it.
   !>
   !> Terms are grouped so that each depends on the one before through one product and one sum only:
   !> their latency limits the speed.
   pure subroutine expand_series(batch, work)
      type(substep_batch_t), intent(inout) :: batch
      type(substep_work_t), intent(in) :: work
      real(wp) :: d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11
      integer :: i

      associate (p => batch%p, n => batch%difference)
         !$omp simd private(d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, &
         !$omp& p_11)
         do i = 1, batch_width
            d = work%d(i)
            k = work%k(i)
            square = batch%h(i)*batch%h(i)
            p_0 = batch%v(i)
            p_1 = batch%h(i)*batch%w(i)
            p_2 = (((work%g(i, 0) + square*n(i, 0)) - k*p_0) - d*p_1)*(1/2.0_wp)
            p_3 = ((work%g(i, 1) + square*((n(i, 1) - c_2*n(i, 2)) + c_2*c_3*n(i, 3))) - k*p_1) &
               *(1/6.0_wp) - (d*(2/6.0_wp))*p_2
            p_4 = ((work%g(i, 2) + square*(n(i, 2) - n(i, 3))) - k*p_2)*(1/12.0_wp) &
               - (d*(3/12.0_wp))*p_3
            p_5 = ((work%g(i, 3) + square*n(i, 3)) - k*p_3)*(1/20.0_wp) - (d*(4/20.0_wp))*p_4
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
   end subroutine expand_series

   !> N and its slope at the beginning of a substep, and a bound of the change of N in it.
   pure subroutine start_remainder(batch, work)
      type(substep_batch_t), intent(inout) :: batch
      type(substep_work_t), intent(inout) :: work
      real(wp) :: a
      !! v'' [1/s2]
      real(wp) :: by_v
      !! derivative of N by v [1/s2]
      real(wp) :: w, square, reach
      integer :: i

      associate (c => batch%coef, n => batch%difference)
         !$omp simd private(a, by_v, w, square, reach)
         do i = 1, batch_width
            w = batch%w(i)
            square = batch%h(i)*batch%h(i)
            n(i, 0) = c(i, 0, 1)*w*w
            a = work%g(i, 0)/square + n(i, 0) - work%d(i)/batch%h(i)*w
            by_v = -c(i, 0, 2)*batch%damping(i)*w - c(i, 0, 3)*batch%side(i)*work%f(i, 0) &
               - c(i, 0, 4)
            work%slope(i) = w*(c(i, 1, 1)*w*w + 2*c(i, 0, 1)*a + by_v)
            n(i, 1) = batch%h(i)*work%slope(i)
            n(i, 2) = 0
            n(i, 3) = 0
            work%highest_difference(i) = n(i, 1)
            ! From rest at the threshold both the slope and a vanish; the distance by which the
            ! forcing moves the wall in the substep then bounds the change.
            reach = square*abs(a) &
               + (abs(work%g(i, 1)) + abs(work%g(i, 2)) + abs(work%g(i, 3)))
            work%remaining_change(i) = square*(abs(n(i, 1)) + reach*abs(2*c(i, 0, 1)*a + by_v))
         end do
      end associate
   end subroutine start_remainder

   !> State at the position y of the substeps, from the series.
   pure subroutine evaluate_series(y, batch)
      real(wp), intent(in) :: y
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: a(terms)
      !! factors of the coefficients in v
      real(wp) :: b(terms)
      !! factors of the coefficients in the rate of v per substep
      integer :: i

      a(1) = y
      b(1) = 1
      do i = 2, terms
         a(i) = a(i - 1)*y
         b(i) = i*a(i - 1)
      end do
      associate (end_state => batch%end_state, p => batch%p)
         !$omp simd
         do i = 1, batch_width
            end_state%v(i) = (((p(i, 0) + a(1)*p(i, 1)) + (a(2)*p(i, 2) + a(3)*p(i, 3))) &
               + ((a(4)*p(i, 4) + a(5)*p(i, 5)) + (a(6)*p(i, 6) + a(7)*p(i, 7)))) &
               + (((a(8)*p(i, 8) + a(9)*p(i, 9)) + (a(10)*p(i, 10) + a(11)*p(i, 11))) &
               + a(12)*p(i, 12))
            end_state%w(i) = ((((p(i, 1) + b(2)*p(i, 2)) + (b(3)*p(i, 3) + b(4)*p(i, 4))) &
               + ((b(5)*p(i, 5) + b(6)*p(i, 6)) + (b(7)*p(i, 7) + b(8)*p(i, 8)))) &
               + ((b(9)*p(i, 9) + b(10)*p(i, 10)) + (b(11)*p(i, 11) + b(12)*p(i, 12)))) &
               /batch%h(i)
         end do
      end associate
   end subroutine evaluate_series

   !> N and v D2 at the end states.
   pure subroutine evaluate_remainder(y, work, batch)
      real(wp), intent(in) :: y
      type(substep_work_t), intent(in) :: work
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: x, x_2, x_4, w, q, d_1, d_2, h, f
      integer :: i

      associate (c => batch%coef, end_state => batch%end_state)
         !$omp simd private(x, x_2, x_4, w, q, d_1, d_2, h, f)
         do i = 1, batch_width
            x = end_state%v(i)
            x_2 = x*x
            x_4 = x_2*x_2
            w = end_state%w(i)
            q = ((c(i, 0, 1) + x*c(i, 1, 1)) + x_2*(c(i, 2, 1) + x*c(i, 3, 1))) &
               + x_4*((c(i, 4, 1) + x*c(i, 5, 1)) + x_2*c(i, 6, 1))
            d_1 = ((c(i, 0, 2) + x*c(i, 1, 2)) + x_2*(c(i, 2, 2) + x*c(i, 3, 2))) &
               + x_4*((c(i, 4, 2) + x*c(i, 5, 2)) + x_2*c(i, 6, 2))
            d_2 = ((c(i, 0, 3) + x*c(i, 1, 3)) + x_2*(c(i, 2, 3) + x*c(i, 3, 3))) &
               + x_4*((c(i, 4, 3) + x*c(i, 5, 3)) + x_2*c(i, 6, 3))
            h = ((c(i, 0, 4) + x*c(i, 1, 4)) + x_2*(c(i, 2, 4) + x*c(i, 3, 4))) &
               + x_4*((c(i, 4, 4) + x*c(i, 5, 4)) + x_2*c(i, 6, 4))
            f = work%f(i, 0) + y*(work%f(i, 1) + y*(work%f(i, 2) + y*work%f(i, 3)))
            end_state%v_d2(i) = x*d_2
            end_state%n(i) = q*w*w - x*(d_1*(batch%damping(i)*w + batch%stiffness(i)*x) + h) &
               - end_state%v_d2(i)*(batch%side(i)*f)
         end do
      end associate
   end subroutine evaluate_remainder

   !> Enter the value of N at c2 into its divided differences; the slope at 0 supplies the highest
   !> one.
   pure subroutine enter_value_at_c2(wanted, work, batch)
      real(wp), intent(in) :: wanted(batch_width)
      !! 1: the value is new
      type(substep_work_t), intent(inout) :: work
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: first, second
      integer :: i

      associate (n => batch%difference, value => batch%end_state%n, h => batch%h)
         !$omp simd private(first, second)
         do i = 1, batch_width
            first = (value(i) - n(i, 0))*(1/c_2)
            second = (first - work%highest_difference(i))*(1/c_2)
            n(i, 1) = merge(first, n(i, 1), wanted(i) > 0)
            n(i, 2) = merge(second, n(i, 2), wanted(i) > 0)
            work%highest_difference(i) = merge(second, work%highest_difference(i), wanted(i) > 0)
            work%remaining_change(i) = merge(h(i)*h(i)*abs(second), work%remaining_change(i), &
               wanted(i) > 0)
         end do
      end associate
   end subroutine enter_value_at_c2

   !> Enter the value of N at c3, after that at c2 (three evaluations) or the slope at 0 (two).
   pure subroutine enter_value_at_c3(wanted, work, batch)
      real(wp), intent(in) :: wanted(batch_width)
      type(substep_work_t), intent(inout) :: work
      type(substep_batch_t), intent(inout) :: batch
      real(wp) :: first, second, third, of_three
      integer :: i

      associate (n => batch%difference, value => batch%end_state%n, h => batch%h)
         !$omp simd private(first, second, third, of_three)
         do i = 1, batch_width
            of_three = batch%stages(i) - 2.5_wp
            first = (value(i) - n(i, 0))*(1/c_3) - n(i, 1)
            second = first*merge(1/(c_3 - c_2), 1/c_3, of_three > 0)
            third = merge((second - work%highest_difference(i))*(1/c_3), 0.0_wp, of_three > 0)
            ! x**2 is x (x - c2) + c2 x
            first = n(i, 1) + merge(0.0_wp, c_2*second, of_three > 0)
            n(i, 1) = merge(first, n(i, 1), wanted(i) > 0)
            n(i, 2) = merge(second, n(i, 2), wanted(i) > 0)
            n(i, 3) = merge(third, n(i, 3), wanted(i) > 0)
            work%highest_difference(i) = merge(second, work%highest_difference(i), wanted(i) > 0)
            third = merge(third, second, of_three > 0)
            work%remaining_change(i) = merge(h(i)*h(i)*abs(third), work%remaining_change(i), &
               wanted(i) > 0)
         end do
      end associate
   end subroutine enter_value_at_c3

   !> Enter the value of N at 1, after those at c2 and c3 (three evaluations), the slope at 0 and
   !> the value at c3 (two) or the slope at 0 (one).
   pure subroutine enter_value_at_1(wanted, work, batch)
      real(wp), intent(in) :: wanted(batch_width)
      type(substep_work_t), intent(in) :: work
      type(substep_batch_t), intent(inout) :: batch
      real(wp), parameter :: to_first = c_2*(c_2 - c_3)
      !! x**2 (x - c3) = x (x - c2)(x - c3) + c2 x (x - c2) + to_first x
      real(wp) :: bend, square, cube, third
      integer :: i

      associate (n => batch%difference, value => batch%end_state%n, stages => batch%stages)
         !$omp simd private(bend, square, cube, third)
         do i = 1, batch_width
            third = (((value(i) - n(i, 0)) - n(i, 1))*(1/(1 - c_2)) - n(i, 2))*(1/(1 - c_3))
            bend = (value(i) - n(i, 0)) - batch%h(i)*work%slope(i)
            ! coefficient of x**2 with one evaluation, of x**2 (x - c3) with two
            square = merge(bend, 0.0_wp, stages(i) < 1.5_wp)
            cube = merge((bend - work%highest_difference(i))*(1/(1 - c_3)), 0.0_wp, &
               abs(stages(i) - 2) < 0.5_wp)
            third = merge(third, cube, stages(i) > 2.5_wp)
            n(i, 1) = n(i, 1) + merge(c_2*square + to_first*cube, 0.0_wp, wanted(i) > 0)
            n(i, 2) = n(i, 2) + merge(square + c_2*cube, 0.0_wp, wanted(i) > 0)
            n(i, 3) = merge(third, n(i, 3), wanted(i) > 0)
         end do
      end associate
   end subroutine enter_value_at_1

   !> Rate of N at the end of the substeps.
   pure subroutine set_end_slope(work, batch)
      type(substep_work_t), intent(in) :: work
      type(substep_batch_t), intent(inout) :: batch
      real(wp), parameter :: slope_2 = 2 - c_2
      !! slope of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! slope of x (x - c2)(x - c3) at 1
      real(wp), parameter :: short = 1.0e-3_wp
      !! span below which differences of N are round-off and the slope at the beginning holds [-]
      real(wp) :: slope
      integer :: i

      associate (n => batch%difference)
         !$omp simd private(slope)
         do i = 1, batch_width
            slope = (n(i, 1) + slope_2*n(i, 2) + slope_3*n(i, 3))/batch%h(i)
            batch%end_state%n_rate(i) = merge(work%slope(i), slope, batch%span(i) < short)
         end do
      end associate
   end subroutine set_end_slope

end module FAST_PIECE
