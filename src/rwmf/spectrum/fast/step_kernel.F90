!> Steps of exponential collocation for a block of lanes: the loops to be vectorised.
!>
!> The linear part of the equation (see `rwmf_spectrum_fast_reduced_equation`) is advanced exactly;
!> the remainder N is interpolated. One, two or three evaluations of it make a step, each at the
!> state predicted from the earlier ones and from the slope of N at the beginning. No operation
!> mixes two lanes: the result of an ordinate does not depend on the other lanes.
!>
!> A step is one loop over the lanes, so that intermediate results stay in registers. Properties
!> common to all lanes (see `rwmf_spectrum_fast_stage_kernel`) are literal in the calls of
!> `step_block`, each of which becomes a loop of its own. Where the instructions cannot choose
!> between two values (without FAST_CHOICE) the last part is a loop that is not vectorised.
!>
!> Compiled once for each instruction set (see `rwmf_spectrum_fast_simd_dispatch`): FAST_STEP is the
!> module's name. Neither fused multiply-add nor reordering is allowed, so that all of them give the
!> same bits.
#ifndef FAST_STEP
#define FAST_STEP rwmf_spectrum_fast_step_kernel
#define FAST_NODE rwmf_spectrum_fast_stage_kernel
#endif
module FAST_STEP
   use FAST_NODE, only: accept_end, event_bit, forcing_mode, n_at_begin, n_slope_at_begin, &
      remainder, state_at_node, store_end, v_d2_at
   use rwmf_spectrum_fast_types, only: block_width, c_2, c_3, frame_block_width, ground_step_t, &
      lane_block_t, lane_ground_t, scheme_t, trial_step_t, wp
   implicit none
   private

   public :: step_block, step_frames

#ifdef FAST_CHOICE
   logical, parameter :: has_choice = .true.
#else
   logical, parameter :: has_choice = .false.
#endif
   !! the instructions can choose between two values

contains

   !> One step of a block. Lanes in which an event is possible keep their state.
   pure subroutine step_block(ground, scheme, lanes, trial, event_bits, needs_update)
      type(ground_step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      !! bit i - 1: an event is possible in lane i
      logical, intent(out) :: needs_update
      !! a lane has reached a step of another length, or its end

      call load_ground(ground, scheme, lanes%step, trial%ground)
      if (scheme%has_jumps .or. .not. scheme%is_straight) then
         if (scheme%has_jumps) call apply_jumps(lanes, trial)
         call select_stages(.false., .false., scheme%stages, lanes, trial, event_bits, needs_update)
      else if (scheme%is_short) then
         call select_stages(.true., .true., scheme%stages, lanes, trial, event_bits, needs_update)
      else
         call select_stages(.true., .false., scheme%stages, lanes, trial, event_bits, needs_update)
      end if
   end subroutine step_block

   !> Select the loop for the number of evaluations; the properties of the scheme are literal in the
   !> calls.
   pure subroutine select_stages(is_plain, is_short, stages, lanes, trial, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      integer, intent(in) :: stages
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update

      select case (stages)
      case (1)
         call step_one_stage(is_plain, is_short, lanes, trial, event_bits, needs_update)
      case (2)
         call step_two_stages(is_plain, is_short, lanes, trial, event_bits, needs_update)
      case default
         call step_three_stages(is_plain, is_short, lanes, trial, event_bits, needs_update)
      end select
   end subroutine select_stages

   !> Load the ground motion in the step of each lane.
   pure subroutine load_ground(ground, scheme, number, loaded)
      type(ground_step_t), contiguous, intent(in) :: ground(:)
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: number(block_width)
      type(lane_ground_t), intent(inout) :: loaded
      !! in: curvature and jumps are zero where the scheme has none
      integer :: i

      do i = 1, block_width
         associate (step => ground(number(i)))
            loaded%f(i, 0) = step%f(0)
            loaded%f(i, 1) = step%f(1)
            loaded%kink(i) = step%kink
         end associate
      end do
      if (scheme%has_jumps) then
         do i = 1, block_width
            loaded%jump(i) = ground(number(i))%jump
         end do
      end if
      if (scheme%is_straight) return
      do i = 1, block_width
         loaded%f(i, 2) = ground(number(i))%f(2)
         loaded%f(i, 3) = ground(number(i))%f(3)
      end do
   end subroutine load_ground

   !> A jump of the ground acceleration is one of v'' as well, by -M2 sigma. N jumps with it, and
   !> its slope by that times dN/dv' = 2 Q v' - v D1 2 xi_s omega_s and by -v' d(v D2)/dv sigma.
   pure subroutine apply_jumps(lanes, trial)
      type(lane_block_t), intent(in) :: lanes
      type(trial_step_t), intent(inout) :: trial
      real(wp) :: x, q, d_1, v_d2_slope, jump
      integer :: i

      associate (c => lanes%constants%coef, constants => lanes%constants, now => lanes%now)
         !$omp simd private(x, q, d_1, v_d2_slope, jump)
         do i = 1, block_width
            x = now%v(i)
            q = c(i, 0, 1) + x*(c(i, 1, 1) + x*(c(i, 2, 1) + x*(c(i, 3, 1) + x*(c(i, 4, 1) &
               + x*(c(i, 5, 1) + x*c(i, 6, 1))))))
            d_1 = c(i, 0, 2) + x*(c(i, 1, 2) + x*(c(i, 2, 2) + x*(c(i, 3, 2) + x*(c(i, 4, 2) &
               + x*(c(i, 5, 2) + x*c(i, 6, 2))))))
            v_d2_slope = c(i, 0, 3) + x*(2*c(i, 1, 3) + x*(3*c(i, 2, 3) + x*(4*c(i, 3, 3) &
               + x*(5*c(i, 4, 3) + x*(6*c(i, 5, 3) + x*7*c(i, 6, 3))))))
            jump = constants%side(i)*trial%ground%jump(i)
            trial%n_jump(i) = now%v_d2(i)*jump
            trial%n_rate_jump(i) = ((2*q*now%w(i) - x*d_1*constants%damping(i))*(constants%m2(i) &
               + now%v_d2(i)) + now%w(i)*v_d2_slope)*jump
         end do
      end associate
   end subroutine apply_jumps

   !> Accept the step in the lanes that are ready and have no event.
   pure subroutine accept_ends(is_plain, lanes, trial, event_bits, needs_update)
      logical, intent(in) :: is_plain
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update
      integer :: i

      event_bits = 0
      do i = 1, block_width
         call accept_end(is_plain, i, lanes, trial)
         event_bits = ior(event_bits, event_bit(i, trial))
      end do
      needs_update = any(lanes%step >= lanes%length_change)
   end subroutine accept_ends

   !> One evaluation: N through its value and slope at 0 and its value at 1.
   pure subroutine step_one_stage(is_plain, is_short, lanes, trial, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update
      real(wp) :: n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2
      real(wp) :: second, w_correction, n_rate
      integer :: n_updates, i

      event_bits = 0
      n_updates = 0
      associate (constants => lanes%constants, now => lanes%now, a => lanes%constants%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2) &
         !$omp& private(second, w_correction, n_rate) reduction(ior: event_bits) &
         !$omp& reduction(+: n_updates)
         do i = 1, block_width
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = n_at_begin(is_plain, i, lanes, trial)
            slope = n_slope_at_begin(is_plain, i, lanes, trial)
            gain = -constants%m2(i)*constants%side(i)
            g_0 = (n_0 - constants%m3(i)) + gain*f(i, 0)
            g_1 = slope + gain*f(i, 1)
            g_2 = gain*f(i, 2)
            g_3 = gain*f(i, 3)
            v = state_at_node(merge(2, 4, is_plain), a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(merge(2, 4, is_plain), a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, 1.0_wp, v, w, v_d2)
            second = (n - n_0) - slope
            w_correction = second*(a(i, 35) + c_2*a(i, 34))
            v = v + second*(a(i, 31) + c_2*a(i, 30))
            w = w + w_correction
            n_rate = constants%inverse_h(i)*(slope + 2*second)
            ! x**2 is x (x - c2) + c2 x
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = slope + c_2*second
            trial%difference(i, 2) = second
            trial%difference(i, 3) = 0
            call store_end(i, v, w, n, n_rate, v_d2, w_correction, trial)
            if (.not. has_choice) cycle
            call accept_end(is_plain, i, lanes, trial)
            event_bits = ior(event_bits, event_bit(i, trial))
            n_updates = n_updates + merge(1, 0, lanes%step(i) >= lanes%length_change(i))
         end do
      end associate
      needs_update = n_updates > 0
      if (.not. has_choice) call accept_ends(is_plain, lanes, trial, event_bits, needs_update)
   end subroutine step_one_stage

   !> Two evaluations: N through its values at 0, 1/2 and 1 and its slope at 0.
   !>
   !> The rate of v at 1 is that of Simpson's rule, whatever the slope.
   pure subroutine step_two_stages(is_plain, is_short, lanes, trial, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update
      real(wp), parameter :: half = 0.5_wp
      real(wp), parameter :: to_first = c_2*(half - c_3)
      !! x**2 (x - 1/2) = x (x - c2)(x - c3) + x (x - c2)/2 + to_first x
      real(wp) :: n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2
      real(wp) :: first, second, third, fourth, w_correction, n_rate
      integer :: n_updates, i

      event_bits = 0
      n_updates = 0
      associate (constants => lanes%constants, now => lanes%now, a => lanes%constants%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2) &
         !$omp& private(first, second, third, fourth, w_correction, n_rate) &
         !$omp& reduction(ior: event_bits) reduction(+: n_updates)
         do i = 1, block_width
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = n_at_begin(is_plain, i, lanes, trial)
            slope = n_slope_at_begin(is_plain, i, lanes, trial)
            gain = -constants%m2(i)*constants%side(i)
            g_0 = (n_0 - constants%m3(i)) + gain*f(i, 0)
            g_1 = slope + gain*f(i, 1)
            g_2 = gain*f(i, 2)
            g_3 = gain*f(i, 3)
            v = state_at_node(merge(2, 4, is_plain), a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(merge(2, 4, is_plain), a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, half, v, w, v_d2)
            second = ((n - n_0)*2 - slope)*2
            first = slope + c_2*second
            g_1 = first + gain*f(i, 1)
            g_2 = forcing_mode(is_plain, second, gain, f(i, 2))
            v = state_at_node(merge(3, 4, is_plain), a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(merge(3, 4, is_plain), a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, 1.0_wp, v, w, v_d2)
            third = (((n - n_0) - slope) - second)*2
            w_correction = third*(a(i, 36) + (half*a(i, 35) + to_first*a(i, 34)))
            ! The change of the ground acceleration in the step gives Q v'**2 and v D2 f a part of
            ! degree four; the cubic misses its component along x**2 (x - 1/2)(x - 1).
            fourth = (constants%h(i)*f(i, 1))**2*constants%m2(i)*(constants%coef(i, 0, 1) &
               *constants%m2(i)*0.25_wp + constants%coef(i, 0, 3)*(1/6.0_wp))
            v = v + third*(a(i, 32) + (half*a(i, 31) + to_first*a(i, 30)))
            w = w + (w_correction - constants%h(i)*fourth*(1/120.0_wp))
            n_rate = constants%inverse_h(i)*(slope + (2*(second + third) + half*fourth))
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = first + to_first*third
            trial%difference(i, 2) = second + half*third
            trial%difference(i, 3) = third
            call store_end(i, v, w, n, n_rate, v_d2, w_correction, trial)
            if (.not. has_choice) cycle
            call accept_end(is_plain, i, lanes, trial)
            event_bits = ior(event_bits, event_bit(i, trial))
            n_updates = n_updates + merge(1, 0, lanes%step(i) >= lanes%length_change(i))
         end do
      end associate
      needs_update = n_updates > 0
      if (.not. has_choice) call accept_ends(is_plain, lanes, trial, event_bits, needs_update)
   end subroutine step_two_stages

   !> Three evaluations: N through its values at 0, c2, c3 and 1; its slope at 0 only predicts.
   pure subroutine step_three_stages(is_plain, is_short, lanes, trial, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update
      real(wp), parameter :: slope_2 = 2 - c_2
      !! slope of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! slope of x (x - c2)(x - c3) at 1
      real(wp) :: n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2
      real(wp) :: first, second, third, predicted, w_correction, n_rate
      integer :: n_updates, i

      event_bits = 0
      n_updates = 0
      associate (constants => lanes%constants, now => lanes%now, a => lanes%constants%weight, &
         ground => trial%ground, f => trial%ground%f)
         !$omp simd private(n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2) &
         !$omp& private(first, second, third, predicted, w_correction, n_rate) &
         !$omp& reduction(ior: event_bits) reduction(+: n_updates)
         do i = 1, block_width
            v_0 = now%v(i)
            w_0 = now%w(i)
            n_0 = n_at_begin(is_plain, i, lanes, trial)
            slope = n_slope_at_begin(is_plain, i, lanes, trial)
            gain = -constants%m2(i)*constants%side(i)
            g_0 = (n_0 - constants%m3(i)) + gain*f(i, 0)
            g_1 = slope + gain*f(i, 1)
            g_2 = gain*f(i, 2)
            g_3 = gain*f(i, 3)
            v = state_at_node(merge(2, 4, is_plain), a, i, 1, 5, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(merge(2, 4, is_plain), a, i, 3, 9, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, c_2, v, w, v_d2)
            first = (n - n_0)*(1/c_2)
            predicted = (first - slope)*(1/c_2)
            g_1 = first + gain*f(i, 1)
            g_2 = forcing_mode(is_plain, predicted, gain, f(i, 2))
            v = state_at_node(merge(3, 4, is_plain), a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(merge(3, 4, is_plain), a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, c_3, v, w, v_d2)
            second = ((n - n_0)*(1/c_3) - first)*(1/(c_3 - c_2))
            predicted = (second - predicted)*(1/c_3)
            g_2 = forcing_mode(is_plain, second, gain, f(i, 2))
            g_3 = forcing_mode(is_plain, predicted, gain, f(i, 3))
            v = state_at_node(4, a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(4, a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v_d2_at(is_short, constants, i, v)
            n = remainder(is_plain, is_short, constants, ground, i, 1.0_wp, v, w, v_d2)
            third = (((n - n_0) - first)*(1/(1 - c_2)) - second)*(1/(1 - c_3))
            w_correction = a(i, 36)*(third - predicted)
            v = v + a(i, 32)*(third - predicted)
            w = w + w_correction
            n_rate = constants%inverse_h(i)*(first + slope_2*second + slope_3*third)
            trial%difference(i, 0) = n_0
            trial%difference(i, 1) = first
            trial%difference(i, 2) = second
            trial%difference(i, 3) = third
            call store_end(i, v, w, n, n_rate, v_d2, w_correction, trial)
            if (.not. has_choice) cycle
            call accept_end(is_plain, i, lanes, trial)
            event_bits = ior(event_bits, event_bit(i, trial))
            n_updates = n_updates + merge(1, 0, lanes%step(i) >= lanes%length_change(i))
         end do
      end associate
      needs_update = n_updates > 0
      if (.not. has_choice) call accept_ends(is_plain, lanes, trial, event_bits, needs_update)
   end subroutine step_three_stages

   !> One step of bare frames, u'' = - d u' - k u - f: a linear recursion, exact for a cubic f.
   pure subroutine step_frames(n_used, h, f, weight, u, w, u_max, event)
      integer, intent(in) :: n_used
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: f(0:3)
      !! ground acceleration as in `ground_step_t` [m/s2]
      real(wp), intent(in) :: weight(frame_block_width, 12)
      !! contributions of u, u' and the modes of -f to u and to u', as those of the node 1 in
      !! `lane_constants_t`
      real(wp), intent(inout) :: u(frame_block_width, 2)
      !! in: (:, 1) at the beginning; out: (:, 1) at the end, (:, 2) at the beginning [m]
      real(wp), intent(inout) :: w(frame_block_width, 2)
      !! rates [m/s]
      real(wp), intent(inout) :: u_max(frame_block_width)
      !! largest |u| at the ends of steps, and between them as far as the caller has entered it [m]
      real(wp), intent(out) :: event(frame_block_width)
      !! 1: between the ends |u| may be larger than `u_max`
      real(wp) :: rise
      integer :: i

      associate (a => weight)
         !$omp simd private(rise)
         do i = 1, n_used
            u(i, 2) = u(i, 1)
            w(i, 2) = w(i, 1)
            u(i, 1) = a(i, 1)*u(i, 2) + a(i, 2)*w(i, 2) - (a(i, 5)*f(0) + a(i, 6)*f(1) &
               + a(i, 7)*f(2) + a(i, 8)*f(3))
            w(i, 1) = a(i, 3)*u(i, 2) + a(i, 4)*w(i, 2) - (a(i, 9)*f(0) + a(i, 10)*f(1) &
               + a(i, 11)*f(2) + a(i, 12)*f(3))
            u_max(i) = max(u_max(i), abs(u(i, 1)))
            ! A parabola rises above its ends by at most h/8 of this sum; the bound is twice that.
            rise = 0.25_wp*h*(abs(w(i, 1)) + abs(w(i, 2)))
            rise = max(abs(u(i, 1)), abs(u(i, 2))) + rise - u_max(i)
            event(i) = merge(1.0_wp, 0.0_wp, min(rise, -w(i, 1)*w(i, 2)) > 0)
         end do
      end associate
   end subroutine step_frames

end module FAST_STEP
