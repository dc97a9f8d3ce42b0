!> Stages of the steps of `rwmf_spectrum_fast_step_kernel`: functions of one lane.
!>
!> Both modules are compiled as one unit, so that the functions are inlined into the loops.
!> Compiled once for each instruction set, like that module (see
!> `rwmf_spectrum_fast_simd_dispatch`): FAST_NODE is the name of the module. Properties common to
!> all lanes are literal at the calls:
!>
!>    is_plain   the ground acceleration is linear in the steps, without jumps between them
!>    is_short   the polynomials have `short_degree`
!>
!> i is the number of the lane.
#ifndef FAST_NODE
#define FAST_NODE rwmf_spectrum_fast_stage_kernel
#endif
module FAST_NODE
   use rwmf_spectrum_fast_types, only: block_width, c_2, c_3, curves, degree, lane_block_t, &
      lane_constants_t, lane_ground_t, trial_step_t, weights, wp
   implicit none
   private

   public :: n_at_begin, n_slope_at_begin, forcing_mode, state_at_node, v_d2_at, remainder, &
      store_end, accept_end, event_bit

contains

   !> N at the beginning of a step [1/s2].
   pure real(wp) function n_at_begin(is_plain, i, lanes, trial) result(n)
      logical, value :: is_plain
      integer, value :: i
      type(lane_block_t), intent(in) :: lanes
      type(trial_step_t), intent(in) :: trial

      n = lanes%now%n(i)
      if (.not. is_plain) n = n - trial%n_jump(i)
   end function n_at_begin

   !> Slope of N at the beginning of a step, per step [1/s2].
   pure real(wp) function n_slope_at_begin(is_plain, i, lanes, trial) result(slope)
      logical, value :: is_plain
      integer, value :: i
      type(lane_block_t), intent(in) :: lanes
      type(trial_step_t), intent(in) :: trial

      slope = lanes%now%n_rate(i) - lanes%now%v_d2(i)*lanes%constants%side(i)*trial%ground%kink(i)
      if (.not. is_plain) slope = slope - trial%n_rate_jump(i)
      slope = lanes%constants%h(i)*slope
   end function n_slope_at_begin

   !> Higher mode of the forcing: a divided difference of N and one of the ground motion, which is
   !> zero where that is linear [1/s2].
   pure real(wp) function forcing_mode(is_plain, difference, gain, f)
      logical, value :: is_plain
      real(wp), value :: difference
      !! divided difference of N [1/s2]
      real(wp), value :: gain
      !! -M2 sigma [1/m]
      real(wp), value :: f
      !! divided difference of the ground acceleration [m/s2]

      forcing_mode = difference
      if (.not. is_plain) forcing_mode = forcing_mode + gain*f
   end function forcing_mode

   !> v [-] or v' [1/s] at a node, from the state at the beginning and the modes of the forcing.
   pure real(wp) function state_at_node(modes, a, i, k, m, v, w, g_0, g_1, g_2, g_3)
      integer, value :: modes
      !! number of modes that are not zero, at least two; literal at the calls
      real(wp), intent(in) :: a(block_width, weights)
      integer, value :: i
      integer, value :: k
      !! number of the weight of v
      integer, value :: m
      !! number of the weight of g_0
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: g_0
      real(wp), value :: g_1
      real(wp), value :: g_2
      real(wp), value :: g_3

      state_at_node = a(i, m)*g_0 + a(i, m + 1)*g_1
      if (modes == 3) state_at_node = state_at_node + a(i, m + 2)*g_2
      if (modes == 4) state_at_node = state_at_node + (a(i, m + 2)*g_2 + a(i, m + 3)*g_3)
      state_at_node = (a(i, k)*v + a(i, k + 1)*w) + state_at_node
   end function state_at_node

   !> v D2 at v [1/m].
   pure real(wp) function v_d2_at(is_short, constants, i, v)
      logical, value :: is_short
      type(lane_constants_t), intent(in) :: constants
      integer, value :: i
      real(wp), value :: v

      v_d2_at = v*curve(is_short, constants%coef, i, 3, v)
   end function v_d2_at

   !> N at a state and a position in the step [1/s2].
   pure real(wp) function remainder(is_plain, is_short, constants, ground, i, y, v, w, v_d2) &
      result(n)
      logical, value :: is_plain
      logical, value :: is_short
      type(lane_constants_t), intent(in) :: constants
      type(lane_ground_t), intent(in) :: ground
      integer, value :: i
      real(wp), value :: y
      !! position [-]
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: v_d2
      !! v D2 [1/m]

      associate (c => constants%coef)
         n = curve(is_short, c, i, 1, v)*w*w - v*(curve(is_short, c, i, 2, v) &
            *(constants%damping(i)*w + constants%stiffness(i)*v) + curve(is_short, c, i, 4, v)) &
            - v_d2*(constants%side(i)*ground_acceleration(is_plain, ground, i, y))
      end associate
   end function remainder

   !> Polynomial k of a lane at v.
   pure real(wp) function curve(is_short, c, i, k, v)
      logical, value :: is_short
      real(wp), intent(in) :: c(block_width, 0:degree, curves)
      integer, value :: i
      integer, value :: k
      !! 1 to 4: Q, D1, D2, H
      real(wp), value :: v
      real(wp) :: v_2

      v_2 = v*v
      curve = (c(i, 0, k) + v*c(i, 1, k)) + v_2*(c(i, 2, k) + v*c(i, 3, k))
      if (is_short) then
         curve = curve + (v_2*v_2)*c(i, 4, k)
      else
         curve = curve + (v_2*v_2)*((c(i, 4, k) + v*c(i, 5, k)) + v_2*c(i, 6, k))
      end if
   end function curve

   !> Ground acceleration at the position y of a step [m/s2].
   pure real(wp) function ground_acceleration(is_plain, ground, i, y)
      logical, value :: is_plain
      type(lane_ground_t), intent(in) :: ground
      integer, value :: i
      real(wp), value :: y

      associate (f => ground%f)
         if (is_plain) then
            ground_acceleration = f(i, 0) + y*f(i, 1)
         else
            ground_acceleration = f(i, 0) + y*(f(i, 1) + (y - c_2)*(f(i, 2) + (y - c_3)*f(i, 3)))
         end if
      end associate
   end function ground_acceleration

   !> Store the end of a tentative step.
   pure subroutine store_end(i, v, w, n, n_rate, v_d2, w_correction, trial)
      integer, value :: i
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: n
      real(wp), value :: n_rate
      real(wp), value :: v_d2
      real(wp), value :: w_correction
      type(trial_step_t), intent(inout) :: trial

      trial%next%v(i) = v
      trial%next%w(i) = w
      trial%next%n(i) = n
      trial%next%n_rate(i) = n_rate
      trial%next%v_d2(i) = v_d2
      trial%w_correction(i) = abs(w_correction)
   end subroutine store_end

   !> Accept the step if the lane is ready and has no event.
   pure subroutine accept_end(is_plain, i, lanes, trial)
      logical, value :: is_plain
      integer, value :: i
      type(lane_block_t), intent(inout) :: lanes
      type(trial_step_t), intent(inout) :: trial
      real(wp) :: event, v_max, v_candidate, estimate, next_estimate
      logical :: is_accepted

      associate (now => lanes%now, next => trial%next)
         v_max = lanes%v_max(i)
         estimate = lanes%error_estimate(i)
         next_estimate = lanes%constants%damping_factor(i)*estimate
         event = merge(lanes%ready(i), 0.0_wp, may_have_event(i, lanes, trial))
         is_accepted = lanes%ready(i) > event
         trial%event(i) = event
         now%v(i) = merge(next%v(i), now%v(i), is_accepted)
         now%w(i) = merge(next%w(i), now%w(i), is_accepted)
         now%n(i) = merge(next%n(i), now%n(i), is_accepted)
         now%n_rate(i) = merge(next%n_rate(i), now%n_rate(i), is_accepted)
         now%v_d2(i) = merge(next%v_d2(i), now%v_d2(i), is_accepted)
         if (is_plain) then
            next_estimate = next_estimate + trial%w_correction(i)
         else
            ! After a jump of the acceleration the correction measures the neglected change of the
            ! predicted slope of N, not the error of the step.
            next_estimate = next_estimate + merge(0.0_wp, trial%w_correction(i), &
               abs(trial%ground%jump(i)) > 0)
         end if
         estimate = merge(next_estimate, estimate, is_accepted)
         lanes%error_estimate(i) = estimate
         v_candidate = merge(next%v(i), 0.0_wp, is_accepted)
         lanes%error_at_peak(i) = merge(estimate, lanes%error_at_peak(i), v_candidate > v_max)
         lanes%v_max(i) = max(v_max, v_candidate)
      end associate
      lanes%step(i) = lanes%step(i) + merge(1, 0, is_accepted)
   end subroutine accept_end

   !> Is an impact or a new maximum possible within the step?
   pure logical function may_have_event(i, lanes, trial)
      integer, value :: i
      type(lane_block_t), intent(in) :: lanes
      type(trial_step_t), intent(in) :: trial
      real(wp), parameter :: margin = 0.25_wp
      !! share of h (|w_0| + |w|): with a parabolic rate v exceeds its ends by at most 4/27 of it
      real(wp) :: v_0, w_0, v, w, h, reach, w_sum, two_turns, peak, dip

      v_0 = lanes%now%v(i)
      w_0 = lanes%now%w(i)
      v = trial%next%v(i)
      w = trial%next%w(i)
      h = lanes%constants%h(i)
      reach = margin*h*(abs(w_0) + abs(w))
      ! If v' changes its sign twice, its mean is less than a third of the sum of its ends.
      w_sum = w_0 + w
      two_turns = min(w_0*w, w_sum*(h*w_sum - 3*(v - v_0)))
      peak = max(min(w_0, -w), two_turns)
      peak = min(peak, reach + max(v_0, v) - lanes%v_max(i))
      dip = max(min(-w_0, w), two_turns)
      dip = min(dip, reach - min(v_0, v))
      may_have_event = v <= 0 .or. max(peak, dip) > 0
   end function may_have_event

   !> Bit of a lane in which an event is possible; 0 without one.
   pure integer function event_bit(i, trial) result(bit)
      integer, value :: i
      type(trial_step_t), intent(in) :: trial

      bit = merge(ishft(1, i - 1), 0, trial%event(i) > 0)
   end function event_bit

end module FAST_NODE
