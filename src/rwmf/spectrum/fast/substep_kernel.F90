!> Exponential collocation over substeps: loops to be vectorised.
!>
!> The scheme is that of `rwmf_spectrum_fast_step_kernel`, with other nodes for two evaluations of N
!> (c3 and 1); here the linear equation is solved by its Taylor series, on which events are then
!> located (`rwmf_spectrum_fast_event_kernel`). Compiled once for each instruction set, like that
!> module: no operation mixes two lanes, and all instruction sets give the same bits.
module rwmf_spectrum_fast_substep_kernel
   use rwmf_spectrum_fast_step_kernel, only: curve
   use rwmf_spectrum_fast_types, only: c_2, c_3, lane_state_t, lanes, scheme_t, team_t, &
      terms, wp
   implicit none
   private

   public :: expand_steps

   !> Intermediate results. y: position in the substep.
   type :: substep_work_t
      real(wp) :: d(lanes)
      !! damping of the linear equation times h [-]
      real(wp) :: k(lanes)
      !! its stiffness times h**2 [-]
      real(wp) :: f(lanes, 0:3)
      !! ground acceleration in powers of y [m/s2]
      real(wp) :: g(lanes, 0:3)
      !! forcing without N in powers of y, times h**2 [-]
      real(wp) :: highest_difference(lanes)
      !! highest divided difference of N, that with the slope at the beginning [1/s2]
      real(wp) :: remaining_change(lanes)
      !! bound of the change of N in the substep beyond its differences so far, times h**2 [-]
      type(lane_state_t) :: at_node
   end type substep_work_t

contains

   !> Taylor series of the steps that are followed; substeps are integrated first, from the base
   !> with the rate w or, in the air, from a state with known N.
   !>
   !> A substep takes as many evaluations of N as a whole step, at the last of the nodes. An
   !> evaluation whose effect is negligible is left out: late flights of a chatter need none.
   pure subroutine expand_steps(are_substeps, scheme, team)
      logical, intent(in) :: are_substeps
      !! the steps that are followed are substeps, still to be integrated
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      type(substep_work_t) :: work
      real(wp), parameter :: node(3) = [c_2, c_3, 1.0_wp]
      real(wp) :: wanted(lanes)
      !! 1 where N is evaluated at the node
      logical :: is_wanted
      integer :: i

      call set_forcing(team, work)
      if (.not. are_substeps) then
         call expand_series(.true., .false., 1.0_wp, team, work)
         return
      end if
      call start_remainder(team, work)
      do i = 1, size(node)
         call select_lanes(i, team, work, wanted, is_wanted)
         if (.not. is_wanted) cycle
         call expand_series(.false., .true., node(i), team, work)
         call evaluate_remainder(scheme, node(i), team, work)
         select case (i)
         case (1)
            call enter_value_at_c2(wanted, work, team)
         case (2)
            call enter_value_at_c3(wanted, work, team)
         case default
            call enter_value_at_1(wanted, work, team)
         end select
      end do
      call expand_series(.true., .true., 1.0_wp, team, work)
      ! As in whole steps, N at the end is that of the predicted state.
      if (.not. is_wanted) call evaluate_remainder(scheme, 1.0_wp, team, work)
      call set_end(work, team)
   end subroutine expand_steps

   !> Select the substeps that need N at a node.
   pure subroutine select_lanes(node, team, work, wanted, is_wanted)
      integer, intent(in) :: node
      !! 1 for c2, 2 for c3, 3 for 1
      type(team_t), intent(in) :: team
      type(substep_work_t), intent(in) :: work
      real(wp), intent(out) :: wanted(lanes)
      logical, intent(out) :: is_wanted
      !! some substep needs it
      real(wp) :: total, excess
      integer :: i

      total = 0
      !$omp simd reduction(max: total) private(excess)
      do i = 1, lanes
         excess = work%remaining_change(i) - team%negligible_change*team%v_max(i)
         wanted(i) = merge(1.0_wp, 0.0_wp, min(team%is_substep(i), &
            min(excess, team%stages(i) + node - 3.5_wp)) > 0)
         total = max(total, wanted(i))
      end do
      is_wanted = total > 0
   end subroutine select_lanes

   !> Coefficients of the linear equation and its forcing without N, in the position y.
   pure subroutine set_forcing(team, work)
      type(team_t), intent(inout) :: team
      type(substep_work_t), intent(inout) :: work
      real(wp) :: p_0, p_1, p_2, p_3, x, r, square, gain
      integer :: i

      !$omp simd private(p_0, p_1, p_2, p_3, x, r, square, gain)
      do i = 1, lanes
         p_0 = team%f(i, 0)
         p_1 = team%f(i, 1) - c_2*team%f(i, 2) + c_2*c_3*team%f(i, 3)
         p_2 = team%f(i, 2) - team%f(i, 3)
         p_3 = team%f(i, 3)
         x = team%x(i)
         r = team%span(i)
         team%h_part(i) = r*team%h(i)
         square = team%h_part(i)*team%h_part(i)
         work%d(i) = team%linear_damping(i)*team%h_part(i)
         work%k(i) = team%linear_stiffness(i)*square
         work%f(i, 0) = p_0 + x*(p_1 + x*(p_2 + x*p_3))
         work%f(i, 1) = r*(p_1 + x*(2*p_2 + x*3*p_3))
         work%f(i, 2) = r*r*(p_2 + x*3*p_3)
         work%f(i, 3) = r*r*r*p_3
         gain = -team%m2(i)*team%side(i)
         work%g(i, 0) = square*(gain*work%f(i, 0) - team%m3(i))
         work%g(i, 1) = square*(gain*work%f(i, 1))
         work%g(i, 2) = square*(gain*work%f(i, 2))
         work%g(i, 3) = square*(gain*work%f(i, 3))
      end do
   end subroutine set_forcing

   !> v in powers of y, the state at a position, or both, as literal in the calls: in
   !> v'' = - d v' - k v + F with a cubic F every derivative follows from the two before it.
   !>
   !> Terms are grouped so that each depends on the one before through one product and one sum only:
   !> their latency limits the speed.
   pure subroutine expand_series(is_kept, has_state, y, team, work)
      logical, value :: is_kept
      !! the powers of y are stored
      logical, value :: has_state
      !! the state at y is wanted
      real(wp), intent(in) :: y
      type(team_t), intent(inout) :: team
      type(substep_work_t), intent(inout) :: work
      real(wp) :: a(terms)
      !! factors of the coefficients in v
      real(wp) :: b(terms)
      !! factors of the coefficients in the rate of v per substep
      real(wp) :: d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11, p_12
      integer :: i

      a(1) = y
      b(1) = 1
      do i = 2, terms
         a(i) = a(i - 1)*y
         b(i) = i*a(i - 1)
      end do
      associate (p => team%p, n => team%difference)
         !$omp simd private(d, k, square, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, &
         !$omp& p_11, p_12)
         do i = 1, lanes
            d = work%d(i)
            k = work%k(i)
            square = team%h_part(i)*team%h_part(i)
            p_0 = team%now%v(i)
            p_1 = team%h_part(i)*team%now%w(i)
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
            p_12 = (k*(-1/132.0_wp))*p_10 - (d*(11/132.0_wp))*p_11
            if (is_kept) then
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
               p(i, 12) = p_12
            end if
            if (.not. has_state) cycle
            work%at_node%v(i) = (((p_0 + a(1)*p_1) + (a(2)*p_2 + a(3)*p_3)) &
               + ((a(4)*p_4 + a(5)*p_5) + (a(6)*p_6 + a(7)*p_7))) &
               + (((a(8)*p_8 + a(9)*p_9) + (a(10)*p_10 + a(11)*p_11)) + a(12)*p_12)
            work%at_node%w(i) = ((((p_1 + b(2)*p_2) + (b(3)*p_3 + b(4)*p_4)) &
               + ((b(5)*p_5 + b(6)*p_6) + (b(7)*p_7 + b(8)*p_8))) &
               + ((b(9)*p_9 + b(10)*p_10) + (b(11)*p_11 + b(12)*p_12)))/team%h_part(i)
         end do
      end associate
   end subroutine expand_series

   !> N and its slope at the beginning of substeps: on the base their values at v = 0, in the air
   !> those known; and a bound of the change of N in the substep.
   pure subroutine start_remainder(team, work)
      type(team_t), intent(inout) :: team
      type(substep_work_t), intent(inout) :: work
      real(wp) :: a
      !! v'' [1/s2]
      real(wp) :: by_v
      !! derivative of N by v [1/s2]
      real(wp) :: w, square, reach, on_base, first
      integer :: i

      associate (c => team%coef, n => team%difference)
         !$omp simd private(a, by_v, w, square, reach, on_base, first)
         do i = 1, lanes
            w = team%now%w(i)
            square = team%h_part(i)*team%h_part(i)
            on_base = merge(0.0_wp, team%is_substep(i), team%now%v(i) > 0)
            ! Inside a step both are those of the state: the team may have stepped since the substep
            ! before this one, from the state with the kink and the jump at the step's beginning.
            n(i, 0) = merge(team%now%n(i), n(i, 0), team%x(i) > 0)
            team%slope(i) = merge(team%now%n_rate(i), team%slope(i), team%x(i) > 0)
            n(i, 0) = merge(c(i, 0, 1)*w*w, n(i, 0), on_base > 0)
            a = work%g(i, 0)/square + n(i, 0) - team%linear_damping(i)*w
            by_v = -c(i, 0, 2)*team%damping(i)*w - c(i, 0, 3)*team%side(i)*work%f(i, 0) &
               - c(i, 0, 4) - c(i, 0, 5)*w
            team%slope(i) = merge(w*(c(i, 1, 1)*w*w + 2*c(i, 0, 1)*a + by_v), team%slope(i), &
               on_base > 0)
            first = team%h_part(i)*team%slope(i)
            n(i, 1) = merge(first, n(i, 1), team%is_substep(i) > 0)
            n(i, 2) = merge(0.0_wp, n(i, 2), team%is_substep(i) > 0)
            n(i, 3) = merge(0.0_wp, n(i, 3), team%is_substep(i) > 0)
            work%highest_difference(i) = first
            ! From rest at the threshold both the slope and a vanish; the distance by which the
            ! forcing moves the wall in the substep then bounds the change.
            reach = square*abs(a) &
               + (abs(work%g(i, 1)) + abs(work%g(i, 2)) + abs(work%g(i, 3)))
            work%remaining_change(i) = merge(square*(abs(first) + reach*abs(2*c(i, 0, 1)*a &
               + by_v)), huge(1.0_wp), on_base > 0)
         end do
      end associate
   end subroutine start_remainder

   !> N and v D2 at the state at a node; the scheme is literal in the calls of the loop.
   pure subroutine evaluate_remainder(scheme, y, team, work)
      type(scheme_t), intent(in) :: scheme
      real(wp), intent(in) :: y
      type(team_t), intent(in) :: team
      type(substep_work_t), intent(inout) :: work

      if (scheme%is_damped) then
         call evaluate(.true., .false., y, team, work)
      else if (scheme%is_short) then
         call evaluate(.false., .true., y, team, work)
      else
         call evaluate(.false., .false., y, team, work)
      end if
   end subroutine evaluate_remainder

   !> The loop.
   pure subroutine evaluate(is_damped, is_short, y, team, work)
      logical, value :: is_damped
      logical, value :: is_short
      real(wp), intent(in) :: y
      type(team_t), intent(in) :: team
      type(substep_work_t), intent(inout) :: work
      real(wp) :: x, w, f, h, v_d2
      integer :: i

      associate (c => team%coef, state => work%at_node)
         !$omp simd private(x, w, f, h, v_d2)
         do i = 1, lanes
            x = state%v(i)
            w = state%w(i)
            f = work%f(i, 0) + y*(work%f(i, 1) + y*(work%f(i, 2) + y*work%f(i, 3)))
            v_d2 = x*curve(is_short, c, i, 3, x)
            h = curve(is_short, c, i, 4, x)
            if (is_damped) h = h + curve(is_short, c, i, 5, x)*w
            state%v_d2(i) = v_d2
            state%n(i) = curve(is_short, c, i, 1, x)*w*w - x*(curve(is_short, c, i, 2, x) &
               *(team%damping(i)*w + team%stiffness(i)*x) + h) - v_d2*(team%side(i)*f)
         end do
      end associate
   end subroutine evaluate

   !> Enter the value of N at c2 into its divided differences; the slope at 0 supplies the highest
   !> one.
   pure subroutine enter_value_at_c2(wanted, work, team)
      real(wp), intent(in) :: wanted(lanes)
      !! 1 where the value is new
      type(substep_work_t), intent(inout) :: work
      type(team_t), intent(inout) :: team
      real(wp) :: first, second
      integer :: i

      associate (n => team%difference, value => work%at_node%n, h => team%h_part)
         !$omp simd private(first, second)
         do i = 1, lanes
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
   pure subroutine enter_value_at_c3(wanted, work, team)
      real(wp), intent(in) :: wanted(lanes)
      type(substep_work_t), intent(inout) :: work
      type(team_t), intent(inout) :: team
      real(wp) :: first, second, third, of_three
      integer :: i

      associate (n => team%difference, value => work%at_node%n, h => team%h_part)
         !$omp simd private(first, second, third, of_three)
         do i = 1, lanes
            of_three = team%stages(i) - 2.5_wp
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
   pure subroutine enter_value_at_1(wanted, work, team)
      real(wp), intent(in) :: wanted(lanes)
      type(substep_work_t), intent(in) :: work
      type(team_t), intent(inout) :: team
      real(wp), parameter :: to_first = c_2*(c_2 - c_3)
      !! x**2 (x - c3) = x (x - c2)(x - c3) + c2 x (x - c2) + to_first x
      real(wp) :: bend, square, cube, third
      integer :: i

      associate (n => team%difference, value => work%at_node%n, stages => team%stages)
         !$omp simd private(bend, square, cube, third)
         do i = 1, lanes
            third = (((value(i) - n(i, 0)) - n(i, 1))*(1/(1 - c_2)) - n(i, 2))*(1/(1 - c_3))
            bend = (value(i) - n(i, 0)) - team%h_part(i)*team%slope(i)
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

   !> State at the end of the substeps, with the rate of N.
   pure subroutine set_end(work, team)
      type(substep_work_t), intent(in) :: work
      type(team_t), intent(inout) :: team
      real(wp), parameter :: slope_2 = 2 - c_2
      !! slope of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! slope of x (x - c2)(x - c3) at 1
      real(wp), parameter :: short = 1.0e-3_wp
      !! span below which differences of N are round-off and the slope at the beginning holds [-]
      real(wp) :: slope
      integer :: i

      associate (n => team%difference, next => team%next, found => work%at_node, &
         is_new => team%is_substep)
         !$omp simd private(slope)
         do i = 1, lanes
            slope = (n(i, 1) + slope_2*n(i, 2) + slope_3*n(i, 3))/team%h_part(i)
            slope = merge(team%slope(i), slope, team%span(i) < short)
            next%n_rate(i) = merge(slope, next%n_rate(i), is_new(i) > 0)
            next%v(i) = merge(found%v(i), next%v(i), is_new(i) > 0)
            next%w(i) = merge(found%w(i), next%w(i), is_new(i) > 0)
            next%n(i) = merge(found%n(i), next%n(i), is_new(i) > 0)
            next%v_d2(i) = merge(found%v_d2(i), next%v_d2(i), is_new(i) > 0)
         end do
      end associate
   end subroutine set_end

end module rwmf_spectrum_fast_substep_kernel
