!> Steps of exponential collocation for the lanes of a team: the loops to be vectorised.
!>
!> The linear part of the equation (see `rwmf_spectrum_fast_reduced_equation`) is advanced exactly;
!> the remainder N is interpolated. One, two or three evaluations of it make a step, each at the
!> state predicted from the earlier ones and from the slope of N at the beginning. No operation
!> mixes two lanes: the result of an ordinate does not depend on the other lanes.
!>
!> A step is one loop over the lanes, so that intermediate results stay in registers; what is done
!> in one lane are functions that are inlined. Properties common to all lanes are literal in the
!> calls of `take_step`, each of which becomes a loop of its own:
!>
!>    stages     evaluations of N
!>    is_plain   the ground acceleration is linear in the steps, without jumps between them; no D4
!>    is_short   no polynomial is of higher degree than 4
!>
!> Where the instructions cannot choose between two values (without FAST_CHOICE) the last part is a
!> loop that is not vectorised. Compiled once for each instruction set (see
!> `rwmf_spectrum_fast_simd_dispatch`). Neither fused multiply-add nor reordering is allowed, so
!> that all of them give the same bits. i is the number of the lane.
module rwmf_spectrum_fast_step_kernel
   use rwmf_spectrum_fast_types, only: c_2, c_3, curves, degree, ground_step_t, lanes, scheme_t, &
      team_t, weights, wp
   implicit none
   private

   public :: step_team, curve

#ifdef FAST_CHOICE
   logical, parameter :: has_choice = .true.
#else
   logical, parameter :: has_choice = .false.
#endif
   !! the instructions can choose between two values

contains

   !> One step of a team. Lanes in which an event is possible keep their state.
   pure subroutine step_team(ground, scheme, team, event_bits, needs_update)
      type(ground_step_t), contiguous, intent(in) :: ground(:)
      !! (steps)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      integer, intent(out) :: event_bits
      !! bit i - 1: an event is possible in lane i
      logical, intent(out) :: needs_update
      !! a lane has reached a step of another length, or its end

      call load_ground(ground, scheme, team)
      if (scheme%has_jumps) call apply_jumps(team)
      if (scheme%has_jumps .or. scheme%is_damped .or. .not. scheme%is_straight) then
         call select_stages(.false., .false., scheme%stages, team, event_bits, needs_update)
      else if (scheme%is_short) then
         call select_stages(.true., .true., scheme%stages, team, event_bits, needs_update)
      else
         call select_stages(.true., .false., scheme%stages, team, event_bits, needs_update)
      end if
   end subroutine step_team

   !> Select the loop for the number of evaluations; the properties of the scheme are literal in the
   !> calls.
   pure subroutine select_stages(is_plain, is_short, stages, team, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      integer, intent(in) :: stages
      type(team_t), intent(inout) :: team
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update

      select case (stages)
      case (1)
         call take_step(is_plain, is_short, 1, team, event_bits, needs_update)
      case (2)
         call take_step(is_plain, is_short, 2, team, event_bits, needs_update)
      case default
         call take_step(is_plain, is_short, 3, team, event_bits, needs_update)
      end select
   end subroutine select_stages

   !> Load the ground motion in the step of each lane; curvature and jumps are zero where the scheme
   !> has none.
   pure subroutine load_ground(ground, scheme, team)
      type(ground_step_t), contiguous, intent(in) :: ground(:)
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team
      integer :: i

      do i = 1, lanes
         associate (step => ground(team%step(i)))
            team%f(i, 0) = step%f(0)
            team%f(i, 1) = step%f(1)
            team%kink(i) = step%kink
         end associate
      end do
      if (scheme%has_jumps) then
         do i = 1, lanes
            team%jump(i) = ground(team%step(i))%jump
         end do
      end if
      if (scheme%is_straight) return
      do i = 1, lanes
         team%f(i, 2) = ground(team%step(i))%f(2)
         team%f(i, 3) = ground(team%step(i))%f(3)
      end do
   end subroutine load_ground

   !> A jump of the ground acceleration is one of v'' as well, by -M2 sigma. N jumps with it, and
   !> its slope by that times dN/dv' = 2 Q v' - v (D1 2 xi_s omega_s + D4) and by
   !> -v' d(v D2)/dv sigma.
   pure subroutine apply_jumps(team)
      type(team_t), intent(inout) :: team
      real(wp) :: x, q, d, v_d2_slope, jump
      integer :: i

      associate (c => team%coef, now => team%now)
         !$omp simd private(x, q, d, v_d2_slope, jump)
         do i = 1, lanes
            x = now%v(i)
            q = curve(.false., c, i, 1, x)
            d = curve(.false., c, i, 2, x)*team%damping(i) + curve(.false., c, i, 5, x)
            v_d2_slope = c(i, 0, 3) + x*(2*c(i, 1, 3) + x*(3*c(i, 2, 3) + x*(4*c(i, 3, 3) &
               + x*(5*c(i, 4, 3) + x*(6*c(i, 5, 3) + x*7*c(i, 6, 3))))))
            jump = team%side(i)*team%jump(i)
            team%n_jump(i) = now%v_d2(i)*jump
            team%n_rate_jump(i) = ((2*q*now%w(i) - x*d)*(team%m2(i) + now%v_d2(i)) &
               + now%w(i)*v_d2_slope)*jump
         end do
      end associate
   end subroutine apply_jumps

   !> One step with literal properties.
   !>
   !> One evaluation: N through its value and slope at 0 and its value at 1. Two: through its values
   !> at 0, 1/2 and 1 and its slope at 0; the rate of v at 1 is that of Simpson's rule, whatever the
   !> slope. Three: through its values at 0, c2, c3 and 1; its slope at 0 only predicts.
   pure subroutine take_step(is_plain, is_short, stages, team, event_bits, needs_update)
      logical, value :: is_plain
      logical, value :: is_short
      integer, value :: stages
      type(team_t), intent(inout) :: team
      integer, intent(out) :: event_bits
      logical, intent(out) :: needs_update
      real(wp), parameter :: half = 0.5_wp
      real(wp), parameter :: to_first = c_2*(half - c_3)
      !! x**2 (x - 1/2) = x (x - c2)(x - c3) + x (x - c2)/2 + to_first x; x**2 = x (x - c2) + c2 x
      real(wp), parameter :: slope_2 = 2 - c_2
      !! slope of x (x - c2) at 1
      real(wp), parameter :: slope_3 = (1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2)
      !! slope of x (x - c2)(x - c3) at 1
      real(wp) :: n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2
      real(wp) :: first, second, third, fourth, predicted, w_correction, n_rate
      integer :: modes, last_modes, n_updates, i

      event_bits = 0
      n_updates = 0
      modes = merge(2, 4, is_plain)
      last_modes = merge(1 + stages, 4, is_plain)
      associate (a => team%weight, f => team%f)
         !$omp simd private(n_0, slope, gain, g_0, g_1, g_2, g_3, v_0, w_0, v, w, n, v_d2) &
         !$omp& private(first, second, third, fourth, predicted, w_correction, n_rate) &
         !$omp& reduction(ior: event_bits) reduction(+: n_updates)
         do i = 1, lanes
            v_0 = team%now%v(i)
            w_0 = team%now%w(i)
            n_0 = team%now%n(i)
            slope = team%now%n_rate(i) - team%now%v_d2(i)*team%side(i)*team%kink(i)
            if (.not. is_plain) then
               n_0 = n_0 - team%n_jump(i)
               slope = slope - team%n_rate_jump(i)
            end if
            team%slope(i) = slope
            slope = team%h(i)*slope
            gain = -team%m2(i)*team%side(i)
            g_0 = (n_0 - team%m3(i)) + gain*f(i, 0)
            g_1 = slope + gain*f(i, 1)
            g_2 = gain*f(i, 2)
            g_3 = gain*f(i, 3)
            first = slope
            second = 0
            third = 0
            if (stages == 2) then
               v = state_at_node(modes, a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
               w = state_at_node(modes, a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
               v_d2 = v*curve(is_short, team%coef, i, 3, v)
               n = remainder(is_plain, is_short, team, i, half, v, w, v_d2)
               second = ((n - n_0)*2 - slope)*2
               first = slope + c_2*second
               g_1 = first + gain*f(i, 1)
               g_2 = forcing_mode(is_plain, second, gain, f(i, 2))
            else if (stages == 3) then
               v = state_at_node(modes, a, i, 1, 5, v_0, w_0, g_0, g_1, g_2, g_3)
               w = state_at_node(modes, a, i, 3, 9, v_0, w_0, g_0, g_1, g_2, g_3)
               v_d2 = v*curve(is_short, team%coef, i, 3, v)
               n = remainder(is_plain, is_short, team, i, c_2, v, w, v_d2)
               first = (n - n_0)*(1/c_2)
               predicted = (first - slope)*(1/c_2)
               g_1 = first + gain*f(i, 1)
               g_2 = forcing_mode(is_plain, predicted, gain, f(i, 2))
               v = state_at_node(merge(3, 4, is_plain), a, i, 13, 17, v_0, w_0, g_0, g_1, g_2, g_3)
               w = state_at_node(merge(3, 4, is_plain), a, i, 15, 21, v_0, w_0, g_0, g_1, g_2, g_3)
               v_d2 = v*curve(is_short, team%coef, i, 3, v)
               n = remainder(is_plain, is_short, team, i, c_3, v, w, v_d2)
               second = ((n - n_0)*(1/c_3) - first)*(1/(c_3 - c_2))
               predicted = (second - predicted)*(1/c_3)
               g_2 = forcing_mode(is_plain, second, gain, f(i, 2))
               g_3 = forcing_mode(is_plain, predicted, gain, f(i, 3))
            end if
            v = state_at_node(last_modes, a, i, 25, 29, v_0, w_0, g_0, g_1, g_2, g_3)
            w = state_at_node(last_modes, a, i, 27, 33, v_0, w_0, g_0, g_1, g_2, g_3)
            v_d2 = v*curve(is_short, team%coef, i, 3, v)
            n = remainder(is_plain, is_short, team, i, 1.0_wp, v, w, v_d2)
            if (stages == 1) then
               second = (n - n_0) - slope
               w_correction = second*(a(i, 35) + c_2*a(i, 34))
               v = v + second*(a(i, 31) + c_2*a(i, 30))
               w = w + w_correction
               n_rate = slope + 2*second
               first = slope + c_2*second
            else if (stages == 2) then
               third = (((n - n_0) - slope) - second)*2
               w_correction = third*(a(i, 36) + (half*a(i, 35) + to_first*a(i, 34)))
               ! The change of the ground acceleration in the step gives Q v'**2 and v D2 f a part
               ! of degree four; the cubic misses its component along x**2 (x - 1/2)(x - 1).
               fourth = (team%h(i)*f(i, 1))**2*team%m2(i)*(team%coef(i, 0, 1) &
                  *team%m2(i)*0.25_wp + team%coef(i, 0, 3)*(1/6.0_wp))
               v = v + third*(a(i, 32) + (half*a(i, 31) + to_first*a(i, 30)))
               w = w + (w_correction - team%h(i)*fourth*(1/120.0_wp))
               n_rate = slope + (2*(second + third) + half*fourth)
               first = first + to_first*third
               second = second + half*third
            else
               third = (((n - n_0) - first)*(1/(1 - c_2)) - second)*(1/(1 - c_3))
               w_correction = a(i, 36)*(third - predicted)
               v = v + a(i, 32)*(third - predicted)
               w = w + w_correction
               n_rate = first + slope_2*second + slope_3*third
            end if
            team%difference(i, 0) = n_0
            team%difference(i, 1) = first
            team%difference(i, 2) = second
            team%difference(i, 3) = third
            team%next%v(i) = v
            team%next%w(i) = w
            team%next%n(i) = n
            team%next%n_rate(i) = team%inverse_h(i)*n_rate
            team%next%v_d2(i) = v_d2
            team%w_correction(i) = abs(w_correction)
            if (.not. has_choice) cycle
            call accept_end(is_plain, i, team, event_bits)
            n_updates = n_updates + merge(1, 0, team%step(i) >= team%length_change(i))
         end do
      end associate
      needs_update = n_updates > 0
      if (has_choice) return
      do i = 1, lanes
         call accept_end(is_plain, i, team, event_bits)
      end do
      needs_update = any(team%step >= team%length_change)
   end subroutine take_step

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
      real(wp), intent(in) :: a(lanes, weights)
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

   !> N at a state and a position in the step [1/s2].
   pure real(wp) function remainder(is_plain, is_short, team, i, y, v, w, v_d2) result(n)
      logical, value :: is_plain
      logical, value :: is_short
      type(team_t), intent(in) :: team
      integer, value :: i
      real(wp), value :: y
      !! position [-]
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: v_d2
      !! v D2 [1/m]
      real(wp) :: f, d

      associate (c => team%coef)
         f = team%f(i, 0) + y*team%f(i, 1)
         d = curve(is_short, c, i, 4, v)
         if (.not. is_plain) then
            f = team%f(i, 0) + y*(team%f(i, 1) + (y - c_2)*(team%f(i, 2) + (y - c_3)*team%f(i, 3)))
            d = d + curve(is_short, c, i, 5, v)*w
         end if
         n = curve(is_short, c, i, 1, v)*w*w - v*(curve(is_short, c, i, 2, v) &
            *(team%damping(i)*w + team%stiffness(i)*v) + d) - v_d2*(team%side(i)*f)
      end associate
   end function remainder

   !> Polynomial k of a lane at v.
   pure real(wp) function curve(is_short, c, i, k, v)
      logical, value :: is_short
      !! no polynomial is of higher degree than 4
      real(wp), intent(in) :: c(lanes, 0:degree, curves)
      !! coefficients in powers of v
      integer, value :: i
      !! number of the lane
      integer, value :: k
      !! 1 to 5: Q, D1, D2, H, D4
      real(wp), value :: v
      !! |u_s|/(2R) [-]
      real(wp) :: v_2

      v_2 = v*v
      curve = (c(i, 0, k) + v*c(i, 1, k)) + v_2*(c(i, 2, k) + v*c(i, 3, k))
      if (is_short) then
         curve = curve + (v_2*v_2)*c(i, 4, k)
      else
         curve = curve + (v_2*v_2)*((c(i, 4, k) + v*c(i, 5, k)) + v_2*c(i, 6, k))
      end if
   end function curve

   !> Accept the step if the lane is ready and has no event.
   pure subroutine accept_end(is_plain, i, team, event_bits)
      logical, value :: is_plain
      integer, value :: i
      type(team_t), intent(inout) :: team
      integer, intent(inout) :: event_bits
      real(wp) :: event, v_max, v_candidate, estimate, next_estimate
      logical :: is_accepted

      associate (now => team%now, next => team%next)
         v_max = team%v_max(i)
         estimate = team%error_estimate(i)
         next_estimate = team%damping_factor(i)*estimate
         event = merge(team%ready(i), 0.0_wp, may_have_event(i, team))
         is_accepted = team%ready(i) > event
         now%v(i) = merge(next%v(i), now%v(i), is_accepted)
         now%w(i) = merge(next%w(i), now%w(i), is_accepted)
         now%n(i) = merge(next%n(i), now%n(i), is_accepted)
         now%n_rate(i) = merge(next%n_rate(i), now%n_rate(i), is_accepted)
         now%v_d2(i) = merge(next%v_d2(i), now%v_d2(i), is_accepted)
         if (is_plain) then
            next_estimate = next_estimate + team%w_correction(i)
         else
            ! After a jump of the acceleration the correction measures the neglected change of the
            ! predicted slope of N, not the error of the step.
            next_estimate = next_estimate + merge(0.0_wp, team%w_correction(i), &
               abs(team%jump(i)) > 0)
         end if
         estimate = merge(next_estimate, estimate, is_accepted)
         team%error_estimate(i) = estimate
         v_candidate = merge(next%v(i), 0.0_wp, is_accepted)
         team%error_at_peak(i) = merge(estimate, team%error_at_peak(i), v_candidate > v_max)
         team%v_max(i) = max(v_max, v_candidate)
      end associate
      team%step(i) = team%step(i) + merge(1, 0, is_accepted)
      event_bits = ior(event_bits, merge(ishft(1, i - 1), 0, event > 0))
   end subroutine accept_end

   !> Is an impact or a new maximum possible within the step?
   pure logical function may_have_event(i, team)
      integer, value :: i
      type(team_t), intent(in) :: team
      real(wp), parameter :: margin = 0.25_wp
      !! share of h (|w_0| + |w|): with a parabolic rate v exceeds its ends by at most 4/27 of it
      real(wp) :: v_0, w_0, v, w, h, reach, w_sum, two_turns, peak, dip

      v_0 = team%now%v(i)
      w_0 = team%now%w(i)
      v = team%next%v(i)
      w = team%next%w(i)
      h = team%h(i)
      reach = margin*h*(abs(w_0) + abs(w))
      ! If v' changes its sign twice, its mean is less than a third of the sum of its ends.
      w_sum = w_0 + w
      two_turns = min(w_0*w, w_sum*(h*w_sum - 3*(v - v_0)))
      peak = max(min(w_0, -w), two_turns)
      peak = min(peak, reach + max(v_0, v) - team%v_max(i))
      dip = max(min(-w_0, w), two_turns)
      dip = min(dip, reach - min(v_0, v))
      may_have_event = v <= 0 .or. max(peak, dip) > 0
   end function may_have_event

end module rwmf_spectrum_fast_step_kernel
