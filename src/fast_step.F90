!> One step of exponential collocation for many ordinates at once: the loops to be vectorised.
!>
!> The linear part of the equation (see `rwmf_fast_law`) is advanced exactly; the remainder N is
!> interpolated on Lobatto's nodes 0, c2, c3, 1. Each of its values is taken at the state predicted
!> from the earlier ones and from the slope of N at the end of the step before, so that three
!> evaluations of N suffice. A lane never sees another one: the result of an ordinate does not
!> depend on its neighbours.
!>
!> Compiled once for each instruction set (see `rwmf_fast_machine`): FAST_STEP is the module's name.
!> Neither fused multiply-add nor reordering is allowed, so that all of them give the same bits.
#ifndef FAST_STEP
#define FAST_STEP rwmf_fast_step
#endif
module FAST_STEP
   use rwmf_fast_lanes, only: c_2, c_3, lane_rate_t, lane_state_t, lanes, step_t, wp
   implicit none
   private

   public :: step_lanes, settle_lanes, step_frames

contains

   !> Advance all lanes by one step, as if nothing happened in it.
   pure subroutine step_lanes(n_used, rate, step, now, next, difference)
      integer, intent(in) :: n_used
      !! lanes in use, a multiple of `width`
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      type(lane_state_t), intent(in) :: now
      type(lane_state_t), intent(inout) :: next
      real(wp), intent(inout) :: difference(lanes, 0:3)
      !! divided differences of N on the nodes [1/s2]
      real(wp) :: v(lanes)
      real(wp) :: w(lanes)
      real(wp) :: n(lanes)
      real(wp) :: slope(lanes)

      call predict_second(n_used, rate, step, now%v, now%w, now%n, now%s, now%drive, slope, &
         difference, v, w)
      call remainder(n_used, rate, step%f(0) + c_2*step%f(1), v, w, n, next%drive)
      call predict_third(n_used, rate, step, now%v, now%w, n, slope, difference, v, w)
      call remainder(n_used, rate, step%f(0) + c_3*(step%f(1) + (c_3 - c_2)*step%f(2)), v, w, n, &
         next%drive)
      call predict_end(n_used, rate, step, now%v, now%w, n, slope, difference, next%v, next%w)
      call remainder(n_used, rate, &
         step%f(0) + step%f(1) + (1 - c_2)*(step%f(2) + (1 - c_3)*step%f(3)), &
         next%v, next%w, next%n, next%drive)
      call correct_end(n_used, rate, step, next%n, next%s, difference, next%v, next%w, next%doubt)
   end subroutine step_lanes

   !> N at the states of all lanes.
   pure subroutine remainder(n_used, rate, f, v, w, n, drive)
      integer, intent(in) :: n_used
      type(lane_rate_t), intent(in) :: rate
      real(wp), intent(in) :: f
      !! ground acceleration [m/s2]
      real(wp), intent(in) :: v(lanes)
      real(wp), intent(in) :: w(lanes)
      real(wp), intent(out) :: n(lanes)
      real(wp), intent(out) :: drive(lanes)
      real(wp) :: x
      real(wp) :: q
      real(wp) :: d_1
      real(wp) :: d_2
      real(wp) :: h
      integer :: i

      associate (c => rate%coef)
         !$omp simd private(x, q, d_1, d_2, h)
         do i = 1, n_used
            x = v(i)
            q = c(i, 0, 1) + x*(c(i, 1, 1) + x*(c(i, 2, 1) + x*(c(i, 3, 1) + x*(c(i, 4, 1) &
               + x*(c(i, 5, 1) + x*c(i, 6, 1))))))
            d_1 = c(i, 0, 2) + x*(c(i, 1, 2) + x*(c(i, 2, 2) + x*(c(i, 3, 2) + x*(c(i, 4, 2) &
               + x*(c(i, 5, 2) + x*c(i, 6, 2))))))
            d_2 = c(i, 0, 3) + x*(c(i, 1, 3) + x*(c(i, 2, 3) + x*(c(i, 3, 3) + x*(c(i, 4, 3) &
               + x*(c(i, 5, 3) + x*c(i, 6, 3))))))
            h = c(i, 0, 4) + x*(c(i, 1, 4) + x*(c(i, 2, 4) + x*(c(i, 3, 4) + x*(c(i, 4, 4) &
               + x*(c(i, 5, 4) + x*c(i, 6, 4))))))
            drive(i) = x*d_2
            n(i) = q*w(i)*w(i) - x*(d_1*(rate%damping(i)*w(i) + rate%stiffness(i)*x) + h) &
               - drive(i)*(rate%side(i)*f)
         end do
      end associate
   end subroutine remainder

   !> State at c2 from the value and the slope of N at 0.
   pure subroutine predict_second(n_used, rate, step, v_0, w_0, n_0, s_0, drive, slope, d, v, w)
      integer, intent(in) :: n_used
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: v_0(lanes)
      real(wp), intent(in) :: w_0(lanes)
      real(wp), intent(in) :: n_0(lanes)
      real(wp), intent(in) :: s_0(lanes)
      real(wp), intent(in) :: drive(lanes)
      real(wp), intent(out) :: slope(lanes)
      !! of N at 0 per step [1/s2]
      real(wp), intent(inout) :: d(lanes, 0:3)
      real(wp), intent(out) :: v(lanes)
      real(wp), intent(out) :: w(lanes)
      real(wp) :: g_0, g_1, g_2, g_3, ground
      integer :: i

      associate (a => rate%weight, f => step%f)
         !$omp simd private(g_0, g_1, g_2, g_3, ground)
         do i = 1, n_used
            d(i, 0) = n_0(i) - drive(i)*rate%side(i)*step%jump
            slope(i) = step%h*(s_0(i) - drive(i)*rate%side(i)*step%kink)
            ground = -rate%m2(i)*rate%side(i)
            g_0 = d(i, 0) - rate%m3(i) + ground*f(0)
            g_1 = slope(i) + ground*f(1)
            g_2 = ground*f(2)
            g_3 = ground*f(3)
            v(i) = a(i, 1)*v_0(i) + a(i, 2)*w_0(i) + a(i, 5)*g_0 + a(i, 6)*g_1 + a(i, 7)*g_2 &
               + a(i, 8)*g_3
            w(i) = a(i, 3)*v_0(i) + a(i, 4)*w_0(i) + a(i, 9)*g_0 + a(i, 10)*g_1 + a(i, 11)*g_2 &
               + a(i, 12)*g_3
         end do
      end associate
   end subroutine predict_second

   !> State at c3 from the slope at 0 and the values at 0 and c2.
   pure subroutine predict_third(n_used, rate, step, v_0, w_0, n_2, slope, d, v, w)
      integer, intent(in) :: n_used
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: v_0(lanes)
      real(wp), intent(in) :: w_0(lanes)
      real(wp), intent(in) :: n_2(lanes)
      real(wp), intent(inout) :: slope(lanes)
      !! in: of N at 0; out: second difference of N on 0, 0, c2 [1/s2]
      real(wp), intent(inout) :: d(lanes, 0:3)
      real(wp), intent(out) :: v(lanes)
      real(wp), intent(out) :: w(lanes)
      real(wp) :: g_0, g_1, g_2, g_3, ground
      integer :: i

      associate (a => rate%weight, f => step%f)
         !$omp simd private(g_0, g_1, g_2, g_3, ground)
         do i = 1, n_used
            d(i, 1) = (n_2(i) - d(i, 0))*(1/c_2)
            slope(i) = (d(i, 1) - slope(i))*(1/c_2)
            ground = -rate%m2(i)*rate%side(i)
            g_0 = d(i, 0) - rate%m3(i) + ground*f(0)
            g_1 = d(i, 1) + ground*f(1)
            g_2 = slope(i) + ground*f(2)
            g_3 = ground*f(3)
            v(i) = a(i, 13)*v_0(i) + a(i, 14)*w_0(i) + a(i, 17)*g_0 + a(i, 18)*g_1 &
               + a(i, 19)*g_2 + a(i, 20)*g_3
            w(i) = a(i, 15)*v_0(i) + a(i, 16)*w_0(i) + a(i, 21)*g_0 + a(i, 22)*g_1 &
               + a(i, 23)*g_2 + a(i, 24)*g_3
         end do
      end associate
   end subroutine predict_third

   !> State at 1 from the slope at 0 and the values at 0, c2 and c3.
   pure subroutine predict_end(n_used, rate, step, v_0, w_0, n_3, slope, d, v, w)
      integer, intent(in) :: n_used
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: v_0(lanes)
      real(wp), intent(in) :: w_0(lanes)
      real(wp), intent(in) :: n_3(lanes)
      real(wp), intent(in) :: slope(lanes)
      !! second difference of N on 0, 0, c2 [1/s2]
      real(wp), intent(inout) :: d(lanes, 0:3)
      real(wp), intent(out) :: v(lanes)
      real(wp), intent(out) :: w(lanes)
      real(wp) :: g_0, g_1, g_2, g_3, ground
      integer :: i

      associate (a => rate%weight, f => step%f)
         !$omp simd private(g_0, g_1, g_2, g_3, ground)
         do i = 1, n_used
            d(i, 2) = ((n_3(i) - d(i, 0))*(1/c_3) - d(i, 1))*(1/(c_3 - c_2))
            d(i, 3) = (d(i, 2) - slope(i))*(1/c_3)
            ground = -rate%m2(i)*rate%side(i)
            g_0 = d(i, 0) - rate%m3(i) + ground*f(0)
            g_1 = d(i, 1) + ground*f(1)
            g_2 = d(i, 2) + ground*f(2)
            g_3 = d(i, 3) + ground*f(3)
            v(i) = a(i, 25)*v_0(i) + a(i, 26)*w_0(i) + a(i, 29)*g_0 + a(i, 30)*g_1 &
               + a(i, 31)*g_2 + a(i, 32)*g_3
            w(i) = a(i, 27)*v_0(i) + a(i, 28)*w_0(i) + a(i, 33)*g_0 + a(i, 34)*g_1 &
               + a(i, 35)*g_2 + a(i, 36)*g_3
         end do
      end associate
   end subroutine predict_end

   !> Third difference of N with its value at 1, and what it changes.
   pure subroutine correct_end(n_used, rate, step, n_1, s_1, d, v, w, doubt)
      integer, intent(in) :: n_used
      type(lane_rate_t), intent(in) :: rate
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: n_1(lanes)
      real(wp), intent(out) :: s_1(lanes)
      !! rate of N at 1 [1/s3]
      real(wp), intent(inout) :: d(lanes, 0:3)
      real(wp), intent(inout) :: v(lanes)
      real(wp), intent(inout) :: w(lanes)
      real(wp), intent(out) :: doubt(lanes)
      !! what the last evaluation of N changes in the rate [1/s]
      real(wp), parameter :: slope_2 = 2 - c_2
      !! of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! of x (x - c2)(x - c3) at 1
      real(wp) :: third
      real(wp) :: per_h
      real(wp) :: share
      integer :: i

      per_h = 1/step%h
      ! A jump of the acceleration changes the slope of N in a way that the prediction leaves out;
      ! the change of N then says nothing about what is wrong after it.
      share = merge(0.0_wp, 1.0_wp, abs(step%jump) > 0)
      !$omp simd private(third)
      do i = 1, n_used
         third = (((n_1(i) - d(i, 0)) - d(i, 1))*(1/(1 - c_2)) - d(i, 2))*(1/(1 - c_3))
         doubt(i) = share*abs(rate%weight(i, 36)*(third - d(i, 3)))
         v(i) = v(i) + rate%weight(i, 32)*(third - d(i, 3))
         w(i) = w(i) + rate%weight(i, 36)*(third - d(i, 3))
         d(i, 3) = third
         s_1(i) = per_h*(d(i, 1) + slope_2*d(i, 2) + slope_3*third)
      end do
   end subroutine correct_end

   !> Accept the step in the lanes that are awake and where nothing happened, and mark the others.
   pure subroutine settle_lanes(n_used, h, awake, keep, next, now, v_max, worst, event)
      integer, intent(in) :: n_used
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: awake(lanes)
      !! 1 in motion, 0 at rest
      real(wp), intent(in) :: keep(lanes)
      !! what the damping leaves of an error after the step [-]
      type(lane_state_t), intent(in) :: next
      type(lane_state_t), intent(inout) :: now
      real(wp), intent(inout) :: v_max(lanes)
      !! [-]
      real(wp), intent(inout) :: worst(lanes)
      !! doubt when `v_max` was reached [1/s]
      real(wp), intent(out) :: event(lanes)
      !! 1: an impact or a new maximum is possible within the step
      real(wp), parameter :: margin = 0.25_wp
      !! between its end tangents a motion of one curvature stays; this much more is looked at
      real(wp) :: room
      real(wp) :: from_0
      real(wp) :: from_1
      real(wp) :: higher
      logical :: accepted
      integer :: i

      !$omp simd private(room, from_0, from_1)
      do i = 1, n_used
         room = margin*h*abs(now%w(i) - next%w(i))
         from_0 = now%v(i) + h*now%w(i)
         from_1 = next%v(i) - h*next%w(i)
         event(i) = merge(1.0_wp, 0.0_wp, next%v(i) <= 0)
         event(i) = max(event(i), merge(1.0_wp, 0.0_wp, min(now%w(i), -next%w(i), &
            min(from_0, from_1) + room - v_max(i)) > 0))
         event(i) = max(event(i), merge(1.0_wp, 0.0_wp, max(now%w(i), -next%w(i), &
            max(from_0, from_1) - room) < 0))
         event(i) = event(i)*awake(i)
      end do
      !$omp simd private(accepted, higher)
      do i = 1, n_used
         accepted = awake(i) > event(i)
         now%v(i) = merge(next%v(i), now%v(i), accepted)
         now%w(i) = merge(next%w(i), now%w(i), accepted)
         now%n(i) = merge(next%n(i), now%n(i), accepted)
         now%s(i) = merge(next%s(i), now%s(i), accepted)
         now%drive(i) = merge(next%drive(i), now%drive(i), accepted)
         now%doubt(i) = merge(keep(i)*now%doubt(i) + next%doubt(i), now%doubt(i), accepted)
         higher = merge(next%v(i), 0.0_wp, accepted)
         worst(i) = merge(now%doubt(i), worst(i), higher > v_max(i))
         v_max(i) = max(v_max(i), higher)
      end do
   end subroutine settle_lanes

   !> One step of bare frames, u'' = - d u' - k u - f: a linear recursion, exact for a cubic f.
   pure subroutine step_frames(n_used, h, f, weight, u, w, u_max, event)
      integer, intent(in) :: n_used
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: f(0:3)
      !! ground acceleration as in `step_t` [m/s2]
      real(wp), intent(in) :: weight(lanes, 12)
      !! what u, u' and the modes of -f contribute to u and to u', as in `lane_rate_t` for node 1
      real(wp), intent(inout) :: u(lanes, 2)
      !! in: (:, 1) at the beginning; out: (:, 1) at the end, (:, 2) at the beginning [m]
      real(wp), intent(inout) :: w(lanes, 2)
      !! rates [m/s]
      real(wp), intent(inout) :: u_max(lanes)
      !! largest |u| on the ends of steps, and where `event` was heeded [m]
      real(wp), intent(out) :: event(lanes)
      !! 1: between the ends |u| may be larger than `u_max`
      real(wp) :: reach
      integer :: i

      associate (a => weight)
         !$omp simd private(reach)
         do i = 1, n_used
            u(i, 2) = u(i, 1)
            w(i, 2) = w(i, 1)
            u(i, 1) = a(i, 1)*u(i, 2) + a(i, 2)*w(i, 2) - (a(i, 5)*f(0) + a(i, 6)*f(1) &
               + a(i, 7)*f(2) + a(i, 8)*f(3))
            w(i, 1) = a(i, 3)*u(i, 2) + a(i, 4)*w(i, 2) - (a(i, 9)*f(0) + a(i, 10)*f(1) &
               + a(i, 11)*f(2) + a(i, 12)*f(3))
            u_max(i) = max(u_max(i), abs(u(i, 1)))
            ! A parabola rises above its ends by at most an eighth of this; twice as much is room.
            reach = 0.25_wp*h*(abs(w(i, 1)) + abs(w(i, 2)))
            reach = max(abs(u(i, 1)), abs(u(i, 2))) + reach - u_max(i)
            event(i) = merge(1.0_wp, 0.0_wp, min(reach, -w(i, 1)*w(i, 2)) > 0)
         end do
      end associate
   end subroutine step_frames

end module FAST_STEP
