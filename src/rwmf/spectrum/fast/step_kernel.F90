!> Steps of exponential collocation for a team of ordinates: the loops to be vectorised.
!>
!> The linear part of the equation (see `rwmf_spectrum_fast_reduced_equation`) is advanced exactly;
!> the remainder N is interpolated. One, two or three evaluations of it make a step, each at the
!> state predicted from the earlier ones and from the slope of N at the beginning. A lane never sees
!> another one: the result of an ordinate does not depend on its neighbours.
!>
!> A step is one loop over the lanes, so that what is computed stays in registers. What all lanes
!> have in common (see `rwmf_spectrum_fast_stage_kernel`) is literal in the calls of `advance_team`,
!> each of which becomes a loop of its own. Where the instructions cannot choose between two values
!> (without FAST_CHOICE) the last part is a loop that is not vectorised.
!>
!> Compiled once for each instruction set (see `rwmf_spectrum_fast_simd_dispatch`): FAST_STEP is the
!> module's name. Neither fused multiply-add nor reordering is allowed, so that all of them give the
!> same bits.
#ifndef FAST_STEP
#define FAST_STEP rwmf_spectrum_fast_step_kernel
#define FAST_NODE rwmf_spectrum_fast_stage_kernel
#endif
module FAST_STEP
   use FAST_NODE, only: drive_at, enter_end, mark_of, mode, remainder, slope_before, state, &
      take_end, value_before
   use rwmf_spectrum_fast_types, only: c_2, c_3, lane_ground_t, lanes, scheme_t, seats, step_t, &
      team_t, tried_step_t, wp
   implicit none
   private

   public :: advance_team, step_frames

#ifdef FAST_CHOICE
   logical, parameter :: has_choice = .true.
#else
   logical, parameter :: has_choice = .false.
#endif
   !! the instructions can choose between two values

contains

   !> One step of a team. The lanes in which something may happen are left as they were.
   pure subroutine advance_team(ground, scheme, team, trial, marks, is_called)
      type(step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      !! bit i - 1: something may happen in lane i
      logical, intent(out) :: is_called
      !! the next step of a lane may be another one than the last

      call load_ground(ground, scheme, team%at, trial%ground)
      if (scheme%has_jumps .or. .not. scheme%is_straight) then
         if (scheme%has_jumps) call pass_jumps(team, trial)
         call advance_alike(.false., .false., scheme%stages, team, trial, marks, is_called)
      else if (scheme%is_short) then
         call advance_alike(.true., .true., scheme%stages, team, trial, marks, is_called)
      else
         call advance_alike(.true., .false., scheme%stages, team, trial, marks, is_called)
      end if
   end subroutine advance_team

   !> What the lanes have in common is literal in the calls.
   pure subroutine advance_alike(is_plain, is_short, stages, team, trial, marks, is_called)
      logical, value :: is_plain
      logical, value :: is_short
      integer, intent(in) :: stages
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      logical, intent(out) :: is_called

      select case (stages)
      case (1)
         call take_one(is_plain, is_short, team, trial, marks, is_called)
      case (2)
         call take_two(is_plain, is_short, team, trial, marks, is_called)
      case default
         call take_three(is_plain, is_short, team, trial, marks, is_called)
      end select
   end subroutine advance_alike

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

   !> A jump of the ground acceleration is one of v'' as well, by -M2 sigma. N jumps with it, and
   !> its slope by that times dN/dv' = 2 Q v' - v D1 2 xi_s omega_s and by -v' d(v D2)/dv sigma.
   pure subroutine pass_jumps(team, trial)
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(inout) :: trial
      real(wp) :: x, q, d_1, bend, jump
      integer :: i

      associate (c => team%rate%coef, rate => team%rate, now => team%now)
         !$omp simd private(x, q, d_1, bend, jump)
         do i = 1, seats
            x = now%v(i)
            q = c(i, 0, 1) + x*(c(i, 1, 1) + x*(c(i, 2, 1) + x*(c(i, 3, 1) + x*(c(i, 4, 1) &
               + x*(c(i, 5, 1) + x*c(i, 6, 1))))))
            d_1 = c(i, 0, 2) + x*(c(i, 1, 2) + x*(c(i, 2, 2) + x*(c(i, 3, 2) + x*(c(i, 4, 2) &
               + x*(c(i, 5, 2) + x*c(i, 6, 2))))))
            bend = c(i, 0, 3) + x*(2*c(i, 1, 3) + x*(3*c(i, 2, 3) + x*(4*c(i, 3, 3) &
               + x*(5*c(i, 4, 3) + x*(6*c(i, 5, 3) + x*7*c(i, 6, 3))))))
            jump = rate%side(i)*trial%ground%jump(i)
            trial%n_jump(i) = now%drive(i)*jump
            trial%s_jump(i) = ((2*q*now%w(i) - x*d_1*rate%damping(i))*(rate%m2(i) &
               + now%drive(i)) + now%w(i)*bend)*jump
         end do
      end associate
   end subroutine pass_jumps

   !> Take the step in the lanes that are ready and where nothing happens.
   pure subroutine take_ends(is_plain, team, trial, marks, is_called)
      logical, intent(in) :: is_plain
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      logical, intent(out) :: is_called
      integer :: i

      marks = 0
      do i = 1, seats
         call take_end(is_plain, i, team, trial)
         marks = ior(marks, mark_of(i, trial))
      end do
      is_called = any(team%at >= team%stop)
   end subroutine take_ends

   !> One evaluation: N through its value and slope at 0 and its value at 1.
   pure subroutine take_one(is_plain, is_short, team, trial, marks, is_called)
      logical, value :: is_plain
      logical, value :: is_short
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      logical, intent(out) :: is_called
      real(wp) :: n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive
      real(wp) :: second, doubt, s
      integer :: calls, i

      marks = 0
      calls = 0
      associate (rate => team%rate, now => team%now, a => team%rate%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive) &
         !$omp& private(second, doubt, s) reduction(ior: marks) reduction(+: calls)
         do i = 1, seats
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = value_before(is_plain, i, team, trial)
            slope = slope_before(is_plain, i, team, trial)
            pull = -rate%m2(i)*rate%side(i)
            g_0 = (n_0 - rate%m3(i)) + pull*f(i, 0)
            g_1 = slope + pull*f(i, 1)
            g_2 = pull*f(i, 2)
            g_3 = pull*f(i, 3)
            v = state(merge(2, 4, is_plain), a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(merge(2, 4, is_plain), a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, 1.0_wp, v, w, drive)
            second = (n - n_0) - slope
            doubt = second*(a(i, 35) + c_2*a(i, 34))
            v = v + second*(a(i, 31) + c_2*a(i, 30))
            w = w + doubt
            s = rate%per_h(i)*(slope + 2*second)
            ! x**2 is x (x - c2) + c2 x
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = slope + c_2*second
            trial%difference(i, 2) = second
            trial%difference(i, 3) = 0
            call enter_end(i, v, w, n, s, drive, doubt, trial)
            if (.not. has_choice) cycle
            call take_end(is_plain, i, team, trial)
            marks = ior(marks, mark_of(i, trial))
            calls = calls + merge(1, 0, team%at(i) >= team%stop(i))
         end do
      end associate
      is_called = calls > 0
      if (.not. has_choice) call take_ends(is_plain, team, trial, marks, is_called)
   end subroutine take_one

   !> Two evaluations: N through its values at 0, 1/2 and 1 and its slope at 0.
   !>
   !> The rate of v at 1 is that of Simpson's rule, whatever the slope.
   pure subroutine take_two(is_plain, is_short, team, trial, marks, is_called)
      logical, value :: is_plain
      logical, value :: is_short
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      logical, intent(out) :: is_called
      real(wp), parameter :: half = 0.5_wp
      real(wp), parameter :: to_first = c_2*(half - c_3)
      !! x**2 (x - 1/2) = x (x - c2)(x - c3) + x (x - c2)/2 + to_first x
      real(wp) :: n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive
      real(wp) :: first, second, third, fourth, doubt, s
      integer :: calls, i

      marks = 0
      calls = 0
      associate (rate => team%rate, now => team%now, a => team%rate%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive) &
         !$omp& private(first, second, third, fourth, doubt, s) reduction(ior: marks) &
         !$omp& reduction(+: calls)
         do i = 1, seats
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = value_before(is_plain, i, team, trial)
            slope = slope_before(is_plain, i, team, trial)
            pull = -rate%m2(i)*rate%side(i)
            g_0 = (n_0 - rate%m3(i)) + pull*f(i, 0)
            g_1 = slope + pull*f(i, 1)
            g_2 = pull*f(i, 2)
            g_3 = pull*f(i, 3)
            v = state(merge(2, 4, is_plain), a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(merge(2, 4, is_plain), a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, half, v, w, drive)
            second = ((n - n_0)*2 - slope)*2
            first = slope + c_2*second
            g_1 = first + pull*f(i, 1)
            g_2 = mode(is_plain, second, pull, f(i, 2))
            v = state(merge(3, 4, is_plain), a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(merge(3, 4, is_plain), a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, 1.0_wp, v, w, drive)
            third = (((n - n_0) - slope) - second)*2
            doubt = third*(a(i, 36) + (half*a(i, 35) + to_first*a(i, 34)))
            ! Of degree four is above all what the change of the ground acceleration in the step
            ! makes of Q v'**2 and v D2 f; the cubic misses its part along x**2 (x - 1/2)(x - 1).
            fourth = (rate%h(i)*f(i, 1))**2*rate%m2(i)*(rate%coef(i, 0, 1)*rate%m2(i)*0.25_wp &
               + rate%coef(i, 0, 3)*(1/6.0_wp))
            v = v + third*(a(i, 32) + (half*a(i, 31) + to_first*a(i, 30)))
            w = w + (doubt - rate%h(i)*fourth*(1/120.0_wp))
            s = rate%per_h(i)*(slope + (2*(second + third) + half*fourth))
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = first + to_first*third
            trial%difference(i, 2) = second + half*third
            trial%difference(i, 3) = third
            call enter_end(i, v, w, n, s, drive, doubt, trial)
            if (.not. has_choice) cycle
            call take_end(is_plain, i, team, trial)
            marks = ior(marks, mark_of(i, trial))
            calls = calls + merge(1, 0, team%at(i) >= team%stop(i))
         end do
      end associate
      is_called = calls > 0
      if (.not. has_choice) call take_ends(is_plain, team, trial, marks, is_called)
   end subroutine take_two

   !> Three evaluations: N through its values at 0, c2, c3 and 1; its slope at 0 only predicts.
   pure subroutine take_three(is_plain, is_short, team, trial, marks, is_called)
      logical, value :: is_plain
      logical, value :: is_short
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      integer, intent(out) :: marks
      logical, intent(out) :: is_called
      real(wp), parameter :: slope_2 = 2 - c_2
      !! of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! of x (x - c2)(x - c3) at 1
      real(wp) :: n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive
      real(wp) :: first, second, third, guess, doubt, s
      integer :: calls, i

      marks = 0
      calls = 0
      associate (rate => team%rate, now => team%now, a => team%rate%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, pull, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, drive) &
         !$omp& private(first, second, third, guess, doubt, s) reduction(ior: marks) &
         !$omp& reduction(+: calls)
         do i = 1, seats
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = value_before(is_plain, i, team, trial)
            slope = slope_before(is_plain, i, team, trial)
            pull = -rate%m2(i)*rate%side(i)
            g_0 = (n_0 - rate%m3(i)) + pull*f(i, 0)
            g_1 = slope + pull*f(i, 1)
            g_2 = pull*f(i, 2)
            g_3 = pull*f(i, 3)
            v = state(merge(2, 4, is_plain), a, i, 1, 5, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(merge(2, 4, is_plain), a, i, 3, 9, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, c_2, v, w, drive)
            first = (n - n_0)*(1/c_2)
            guess = (first - slope)*(1/c_2)
            g_1 = first + pull*f(i, 1)
            g_2 = mode(is_plain, guess, pull, f(i, 2))
            v = state(merge(3, 4, is_plain), a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(merge(3, 4, is_plain), a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, c_3, v, w, drive)
            second = ((n - n_0)*(1/c_3) - first)*(1/(c_3 - c_2))
            guess = (second - guess)*(1/c_3)
            g_2 = mode(is_plain, second, pull, f(i, 2))
            g_3 = mode(is_plain, guess, pull, f(i, 3))
            v = state(4, a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state(4, a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            drive = drive_at(is_short, rate, i, v)
            n = remainder(is_plain, is_short, rate, ground, i, 1.0_wp, v, w, drive)
            third = (((n - n_0) - first)*(1/(1 - c_2)) - second)*(1/(1 - c_3))
            doubt = a(i, 36)*(third - guess)
            v = v + a(i, 32)*(third - guess)
            w = w + doubt
            s = rate%per_h(i)*(first + slope_2*second + slope_3*third)
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = first
            trial%difference(i, 2) = second
            trial%difference(i, 3) = third
            call enter_end(i, v, w, n, s, drive, doubt, trial)
            if (.not. has_choice) cycle
            call take_end(is_plain, i, team, trial)
            marks = ior(marks, mark_of(i, trial))
            calls = calls + merge(1, 0, team%at(i) >= team%stop(i))
         end do
      end associate
      is_called = calls > 0
      if (.not. has_choice) call take_ends(is_plain, team, trial, marks, is_called)
   end subroutine take_three

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
