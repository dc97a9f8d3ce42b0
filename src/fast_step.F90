!> Steps of exponential collocation for a team of ordinates: the loops to be vectorised.
!>
!> The linear part of the equation (see `rwmf_fast_law`) is advanced exactly; the remainder N is
!> interpolated. One, two or three evaluations of it make a step, each at the state predicted from
!> the earlier ones and from the slope of N at the beginning. A lane never sees another one: the
!> result of an ordinate does not depend on its neighbours.
!>
!> Compiled once for each instruction set (see `rwmf_fast_machine`): FAST_STEP is the module's name.
!> Neither fused multiply-add nor reordering is allowed, so that all of them give the same bits.
#ifndef FAST_STEP
#define FAST_STEP rwmf_fast_step
#define FAST_NODE rwmf_fast_node
#endif
module FAST_STEP
   use FAST_NODE, only: pass_jump, propagate, remainder
   use rwmf_fast_lanes, only: c_2, c_3, lane_ground_t, lane_rate_t, lanes, scheme_t, seats, &
      step_t, team_t, tried_step_t, wp
   implicit none
   private

   public :: advance_team, step_frames

contains

   !> One step of a team. The lanes in which something may happen are left as they were.
   pure subroutine advance_team(ground, scheme, team, trial, has_event, is_called)
      type(step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      logical, intent(out) :: has_event
      logical, intent(out) :: is_called
      !! the next step of a lane may be another one than the last
      real(wp) :: slope(seats)

      call load_ground(ground, scheme, team%at, trial%ground)
      call begin_step(team%rate, trial%ground, team%now%n, team%now%s, team%now%drive, &
         trial%difference, slope)
      if (scheme%has_jumps) then
         if (jumps(trial%ground%jump)) call pass_jump(team%rate, trial%ground, team%now%v, &
            team%now%w, team%now%drive, slope)
      end if
      select case (scheme%stages)
      case (1)
         call take_one(scheme, team, slope, trial)
      case (2)
         call take_two(scheme, team, slope, trial)
      case default
         call take_three(scheme, team, slope, trial)
      end select
      call mark_events(team, trial, has_event)
      call accept(trial, team)
      call count_step(trial%event, team, is_called)
   end subroutine advance_team

   !> The ground motion in the step of each lane.
   pure subroutine load_ground(ground, scheme, at, loaded)
      type(step_t), contiguous, intent(in) :: ground(:)
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: at(seats)
      type(lane_ground_t), intent(inout) :: loaded
      !! in: without curvature and jumps
      integer :: i

      do i = 1, seats
         associate (step => ground(at(i)))
            loaded%f(i, 0) = step%f(0)
            loaded%f(i, 1) = step%f(1)
            loaded%kink(i) = step%kink
         end associate
      end do
      if (scheme%has_jumps) then
         do i = 1, seats
            loaded%jump(i) = ground(at(i))%jump
         end do
      end if
      if (scheme%is_straight) return
      do i = 1, seats
         loaded%f(i, 2) = ground(at(i))%f(2)
         loaded%f(i, 3) = ground(at(i))%f(3)
      end do
   end subroutine load_ground

   pure logical function jumps(jump)
      real(wp), intent(in) :: jump(seats)
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, seats
         total = max(total, abs(jump(i)))
      end do
      jumps = total > 0
   end function jumps

   !> N as far as it is known at the beginning: its value and its slope.
   pure subroutine begin_step(rate, ground, n_0, s_0, drive, d, slope)
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      real(wp), intent(in) :: n_0(seats)
      real(wp), intent(in) :: s_0(seats)
      real(wp), intent(in) :: drive(seats)
      real(wp), intent(out) :: d(seats, 0:3)
      !! divided differences on 0, c2, c3, 1
      real(wp), intent(out) :: slope(seats)
      !! of N at 0 per step [1/s2]
      integer :: i

      !$omp simd
      do i = 1, seats
         d(i, 0) = n_0(i) - drive(i)*rate%side(i)*ground%jump(i)
         slope(i) = rate%h(i)*(s_0(i) - drive(i)*rate%side(i)*ground%kink(i))
         d(i, 1) = slope(i)
         d(i, 2) = 0
         d(i, 3) = 0
      end do
   end subroutine begin_step

   !> One evaluation: N through its value and slope at 0 and its value at 1.
   pure subroutine take_one(scheme, team, slope, trial)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(in) :: team
      real(wp), intent(in) :: slope(seats)
      !! of N at 0 per step [1/s2]
      type(tried_step_t), intent(inout) :: trial
      real(wp) :: second
      integer :: i

      associate (rate => team%rate, now => team%now, d => trial%difference, next => trial%next, &
         ground => trial%ground)
         call propagate(merge(2, 4, scheme%is_straight), rate, ground, d, rate%weight(:, 25:36), &
            now%v, now%w, next%v, next%w)
         call remainder(scheme%is_short, rate, ground, 1.0_wp, next%v, next%w, next%n, next%drive)
         !$omp simd private(second)
         do i = 1, seats
            second = (next%n(i) - d(i, 0)) - slope(i)
            ! x**2 is x (x - c2) + c2 x
            d(i, 1) = slope(i) + c_2*second
            d(i, 2) = second
            next%v(i) = next%v(i) + second*(rate%weight(i, 31) + c_2*rate%weight(i, 30))
            next%doubt(i) = second*(rate%weight(i, 35) + c_2*rate%weight(i, 34))
            next%w(i) = next%w(i) + next%doubt(i)
            next%s(i) = rate%per_h(i)*(slope(i) + 2*second)
         end do
      end associate
   end subroutine take_one

   !> Two evaluations: N through its values at 0, 1/2 and 1 and its slope at 0.
   !>
   !> The rate of v at 1 is that of Simpson's rule, whatever the slope.
   pure subroutine take_two(scheme, team, slope, trial)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(in) :: team
      real(wp), intent(in) :: slope(seats)
      type(tried_step_t), intent(inout) :: trial
      real(wp), parameter :: half = 0.5_wp
      real(wp), parameter :: to_first = c_2*(half - c_3)
      !! x**2 (x - 1/2) = x (x - c2)(x - c3) + x (x - c2)/2 + to_first x
      real(wp) :: v(seats)
      real(wp) :: w(seats)
      real(wp) :: n(seats)
      real(wp) :: second(seats)
      real(wp) :: third
      real(wp) :: fourth
      integer :: i

      associate (rate => team%rate, now => team%now, d => trial%difference, next => trial%next, &
         ground => trial%ground)
         call propagate(merge(2, 4, scheme%is_straight), rate, ground, d, rate%weight(:, 13:24), &
            now%v, now%w, v, w)
         call remainder(scheme%is_short, rate, ground, half, v, w, n, next%drive)
         !$omp simd
         do i = 1, seats
            second(i) = ((n(i) - d(i, 0))*2 - slope(i))*2
            d(i, 1) = slope(i) + c_2*second(i)
            d(i, 2) = second(i)
         end do
         call propagate(merge(3, 4, scheme%is_straight), rate, ground, d, rate%weight(:, 25:36), &
            now%v, now%w, next%v, next%w)
         call remainder(scheme%is_short, rate, ground, 1.0_wp, next%v, next%w, next%n, next%drive)
         !$omp simd private(third, fourth)
         do i = 1, seats
            third = (((next%n(i) - d(i, 0)) - slope(i)) - second(i))*2
            d(i, 1) = d(i, 1) + to_first*third
            d(i, 2) = d(i, 2) + half*third
            d(i, 3) = third
            next%v(i) = next%v(i) + third*(rate%weight(i, 32) + (half*rate%weight(i, 31) &
               + to_first*rate%weight(i, 30)))
            next%doubt(i) = third*(rate%weight(i, 36) + (half*rate%weight(i, 35) &
               + to_first*rate%weight(i, 34)))
            ! Of degree four is above all what the change of the ground acceleration in the step
            ! makes of Q v'**2 and v D2 f; the cubic misses its part along x**2 (x - 1/2)(x - 1).
            fourth = (rate%h(i)*ground%f(i, 1))**2*rate%m2(i)*(rate%coef(i, 0, 1)*rate%m2(i) &
               *0.25_wp + rate%coef(i, 0, 3)*(1/6.0_wp))
            next%w(i) = next%w(i) + (next%doubt(i) - rate%h(i)*fourth*(1/120.0_wp))
            next%s(i) = rate%per_h(i)*(slope(i) + (2*(second(i) + third) + half*fourth))
         end do
      end associate
   end subroutine take_two

   !> Three evaluations: N through its values at 0, c2, c3 and 1; its slope at 0 only predicts.
   pure subroutine take_three(scheme, team, slope, trial)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(in) :: team
      real(wp), intent(in) :: slope(seats)
      type(tried_step_t), intent(inout) :: trial
      real(wp), parameter :: slope_2 = 2 - c_2
      !! of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! of x (x - c2)(x - c3) at 1
      real(wp) :: v(seats)
      real(wp) :: w(seats)
      real(wp) :: n(seats)
      real(wp) :: second(seats)
      real(wp) :: third
      integer :: i

      associate (rate => team%rate, now => team%now, d => trial%difference, next => trial%next, &
         ground => trial%ground)
         call propagate(merge(2, 4, scheme%is_straight), rate, ground, d, rate%weight(:, 1:12), &
            now%v, now%w, v, w)
         call remainder(scheme%is_short, rate, ground, c_2, v, w, n, next%drive)
         !$omp simd
         do i = 1, seats
            d(i, 1) = (n(i) - d(i, 0))*(1/c_2)
            second(i) = (d(i, 1) - slope(i))*(1/c_2)
            d(i, 2) = second(i)
         end do
         call propagate(merge(3, 4, scheme%is_straight), rate, ground, d, rate%weight(:, 13:24), &
            now%v, now%w, v, w)
         call remainder(scheme%is_short, rate, ground, c_3, v, w, n, next%drive)
         !$omp simd
         do i = 1, seats
            d(i, 2) = ((n(i) - d(i, 0))*(1/c_3) - d(i, 1))*(1/(c_3 - c_2))
            d(i, 3) = (d(i, 2) - second(i))*(1/c_3)
         end do
         call propagate(4, rate, ground, d, rate%weight(:, 25:36), &
            now%v, now%w, next%v, next%w)
         call remainder(scheme%is_short, rate, ground, 1.0_wp, next%v, next%w, next%n, next%drive)
         !$omp simd private(third)
         do i = 1, seats
            third = (((next%n(i) - d(i, 0)) - d(i, 1))*(1/(1 - c_2)) - d(i, 2))*(1/(1 - c_3))
            next%v(i) = next%v(i) + rate%weight(i, 32)*(third - d(i, 3))
            next%doubt(i) = rate%weight(i, 36)*(third - d(i, 3))
            next%w(i) = next%w(i) + next%doubt(i)
            d(i, 3) = third
            next%s(i) = rate%per_h(i)*(d(i, 1) + slope_2*d(i, 2) + slope_3*third)
         end do
      end associate
   end subroutine take_three

   !> In which lanes is an impact or a new maximum possible within the step?
   pure subroutine mark_events(team, trial, has_event)
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(inout) :: trial
      logical, intent(out) :: has_event
      real(wp), parameter :: margin = 0.25_wp
      !! between its end tangents a motion of one curvature stays; this much more is looked at
      real(wp) :: room
      real(wp) :: from_0
      real(wp) :: from_1
      real(wp) :: both
      real(wp) :: total
      integer :: i

      total = 0
      associate (now => team%now, next => trial%next, event => trial%event, h => team%rate%h)
         !$omp simd private(room, from_0, from_1, both) reduction(max: total)
         do i = 1, seats
            room = margin*h(i)*abs(now%w(i) - next%w(i))
            from_0 = now%v(i) + h(i)*now%w(i)
            from_1 = next%v(i) - h(i)*next%w(i)
            event(i) = merge(1.0_wp, 0.0_wp, next%v(i) <= 0)
            event(i) = max(event(i), merge(1.0_wp, 0.0_wp, min(now%w(i), -next%w(i), &
               min(from_0, from_1) + room - team%v_max(i)) > 0))
            event(i) = max(event(i), merge(1.0_wp, 0.0_wp, max(now%w(i), -next%w(i), &
               max(from_0, from_1) - room) < 0))
            ! v' may change its sign twice: its mean is then less than a third of the sum of its
            ! ends.
            both = now%w(i) + next%w(i)
            room = margin*h(i)*abs(both)
            event(i) = max(event(i), merge(1.0_wp, 0.0_wp, min(now%w(i)*next%w(i), &
               min(both*(h(i)*both - 3*(next%v(i) - now%v(i))), &
               room + max(max(now%v(i), next%v(i)) - team%v_max(i), &
               -min(now%v(i), next%v(i))))) > 0))
            event(i) = event(i)*team%ready(i)
            total = max(total, event(i))
         end do
      end associate
      has_event = total > 0
   end subroutine mark_events

   !> Take the step in the lanes that are ready and where nothing happens.
   pure subroutine accept(trial, team)
      type(tried_step_t), intent(in) :: trial
      type(team_t), intent(inout) :: team
      real(wp) :: higher
      real(wp) :: doubt
      logical :: accepted
      integer :: i

      associate (now => team%now, next => trial%next)
         !$omp simd private(accepted, higher, doubt)
         do i = 1, seats
            accepted = team%ready(i) > trial%event(i)
            now%v(i) = merge(next%v(i), now%v(i), accepted)
            now%w(i) = merge(next%w(i), now%w(i), accepted)
            now%n(i) = merge(next%n(i), now%n(i), accepted)
            now%s(i) = merge(next%s(i), now%s(i), accepted)
            now%drive(i) = merge(next%drive(i), now%drive(i), accepted)
            ! A jump of the acceleration changes the slope of N in a way that the prediction leaves
            ! out; the change of N then says nothing about what is wrong after it.
            doubt = merge(0.0_wp, abs(next%doubt(i)), abs(trial%ground%jump(i)) > 0)
            doubt = team%rate%keep(i)*now%doubt(i) + doubt
            now%doubt(i) = merge(doubt, now%doubt(i), accepted)
            higher = merge(next%v(i), 0.0_wp, accepted)
            team%worst(i) = merge(now%doubt(i), team%worst(i), higher > team%v_max(i))
            team%v_max(i) = max(team%v_max(i), higher)
         end do
      end associate
   end subroutine accept

   pure subroutine count_step(event, team, is_called)
      real(wp), intent(in) :: event(seats)
      type(team_t), intent(inout) :: team
      logical, intent(out) :: is_called
      integer :: total
      integer :: i

      total = 0
      !$omp simd reduction(+: total)
      do i = 1, seats
         team%at(i) = team%at(i) + merge(1, 0, team%ready(i) > event(i))
         total = total + merge(1, 0, team%at(i) >= team%stop(i))
      end do
      is_called = total > 0
   end subroutine count_step

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
