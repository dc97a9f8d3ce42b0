!> Conditions under which chatter ends in rest (`rwmf_simulation_hybrid_transitions` applies them).
!> They depend only on the ground motion, unless further states change while the wall is on its
!> base.
module rwmf_model_system_rest_after_chatter
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_spring_set, only: renew_window
   use rwmf_model_equation, only: discrete_state_t, equation_t, interval_of, uplift_demands
   use rwmf_model_system_assembly, only: enter_side, rhs, second_derivative
   use rwmf_model_system_lift_off, only: demand_turns, find_uplift_acceleration, resting_range
   use rwmf_motion_ground_motion, only: interval_end, interval_last, is_known_until, &
      is_piecewise_linear, scan_lines
   implicit none
   private

   real(wp), parameter :: most_varied = 4
   !! largest variation of the uplift demands over the smallest contact pressure at which chatter
   !! counts as settling [-]
   real(wp), parameter :: elastic_loss = 1.0_wp/640
   !! relative velocity loss at an impact up to which bouncing may never end [-]

   public :: elastic_loss, hold_wall, release_wall, decelerations, may_rest, will_settle
   public :: inverse_inertia

contains

   !> Hold theta at 0 while further states change.
   pure subroutine hold_wall(state)
      type(discrete_state_t), intent(inout) :: state

      state%coef(1, 1) = 0
   end subroutine hold_wall

   !> Release theta to follow its equation of motion.
   pure subroutine release_wall(state)
      type(discrete_state_t), intent(inout) :: state

      state%coef(1, 1) = 1
   end subroutine release_wall

   !> Smallest ground acceleration that presses the wall down on both sides over a span [m/s2]. It
   !> is not positive if one side lifts off.
   pure real(wp) function pressing_acceleration(equation, t_begin, t_end) result(press)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_begin
      !! a time in the current interval [s]
      real(wp), intent(in) :: t_end
      !! [s]
      real(wp), parameter :: unlimited = 1.0e30_wp
      real(wp) :: variation, t_pulled

      call press_over(equation, t_begin, t_end, unlimited, press, variation, t_pulled)
   end function pressing_acceleration

   !> Angular decelerations of a wall that leaves its base slowly, on the negative and on the
   !> positive side [rad/s2].
   pure function decelerations(equation, t) result(pull)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! within the current interval [s]
      real(wp) :: pull(2)

      pull = -uplift_demands(equation, interval_of(equation), t)*inverse_inertia(equation)
   end function decelerations

   !> True if the wall may be put to rest after an impact that leaves it the velocity v.
   logical function may_rest(equation, t, y, v, e, small_angle, small_velocity, pull)
      type(equation_t), intent(inout) :: equation
      !! unchanged on return
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: small_velocity
      !! negligible angular velocity [rad/s]
      real(wp), intent(in) :: pull(2)
      !! `decelerations` [rad/s2]

      if (equation%moves_at_rest) then
         may_rest = may_rest_moving(equation, t, y, v, e, small_angle, small_velocity)
      else
         may_rest = may_rest_still(equation, t, v, e, small_angle, small_velocity, minval(pull))
      end if
   end function may_rest

   !> Return true if the wall may rest while only the ground moves.
   !>
   !> Impacts with e < 1 accumulate: flights of duration 2 v e**n/a end after 2 v/(a (1 - e)). If
   !> the wall is pressed down throughout that time, the true motion has ended by then. Until then
   !> it stays below v**2/(2a). If that is negligible, immediate rest changes nothing else. This
   !> also holds for any e after the ground has stopped permanently. In all other cases only a
   !> velocity that is itself negligible may be dropped.
   pure logical function may_rest_still(equation, t, v, e, small_angle, small_velocity, pull) &
      result(may_rest)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: small_velocity
      !! negligible angular velocity [rad/s]
      real(wp), intent(in) :: pull
      !! smaller deceleration of both sides [rad/s2]
      real(wp) :: press
      real(wp) :: chatter

      may_rest = .false.
      if (pull <= 0) return
      ! Flights of a few spacings of the time cannot be resolved.
      may_rest = v <= small_velocity
      ! a spacing is at most epsilon*t; the cheap test avoids most calls of `spacing`
      if (v <= pull*64*epsilon(t)*t) may_rest = may_rest .or. v <= pull*64*spacing(t)
      if (may_rest .or. v**2 > 2*pull*small_angle) return
      ! With e = 1 the chatter has no end, but it is harmless after the last knot.
      may_rest = interval_of(equation) >= interval_last(equation%motion)
      if (may_rest .or. e >= 1) return
      ! Twice the time under the present pressure allows for a smaller pressure later.
      chatter = 4*v/(pull*(1 - e))
      if (.not. is_known_until(equation%motion, interval_of(equation), t + chatter)) return
      press = pressing_acceleration(equation, t, t + chatter)
      may_rest = press > 0 .and. 2*v <= press*inverse_inertia(equation)*(1 - e)*chatter
   end function may_rest_still

   !> Return true if the wall may rest while further states change.
   !>
   !> The test is that of `may_rest_still`, but the pressure changes with the other states. The
   !> chatter must therefore end within a tenth of their shortest period. The pressure is reduced by
   !> twice its change at their present rates in that time. It is also reduced by a bound on the
   !> effect of their acceleration.
   !>
   !> Bounces with little loss of energy would continue below the resolution. The wall then rests if
   !> many bounces are certain to follow within the shortest period over 2 pi. The dropped energy is
   !> less than the energy tolerance.
   logical function may_rest_moving(equation, t, y, v, e, small_angle, small_velocity) &
      result(may_rest)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: small_velocity
      !! negligible angular velocity [rad/s]
      real(wp), parameter :: flights = 64
      real(wp) :: press
      real(wp) :: gain
      real(wp) :: loss
      !! relative velocity loss at an impact, or over half the number of flights [-]
      real(wp) :: chatter
      !! largest duration of the chatter [s]
      real(wp) :: longest
      !! limit of that duration over (shortest period over 2 pi) [-]
      real(wp) :: change
      !! change of the pressure in that time [m/s2]

      may_rest = .false.
      press = pressing_acceleration(equation, t, t)
      if (press <= 0) return
      gain = inverse_inertia(equation)
      may_rest = v <= max(small_velocity, press*gain*64*spacing(t))
      if (may_rest .or. v**2 > 2*press*gain*small_angle) return
      loss = 1 - e
      longest = 0.1_wp
      if (loss <= elastic_loss) then
         loss = 2/flights
         longest = 1
      end if
      chatter = 4*v/(press*gain*loss)
      if (chatter*equation%floors%max_frequency > longest) return
      if (.not. is_known_until(equation%motion, interval_of(equation), t + chatter)) return
      call bound_change(equation, t, y, chatter, change)
      press = pressing_acceleration(equation, t, t + chatter) - change
      may_rest = press > 0 .and. 2*v <= press*gain*loss*chatter
   end function may_rest_moving

   !> Bound the change of the uplift acceleration by the other states within a duration.
   subroutine bound_change(equation, t, y, duration, change)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: duration
      !! duration, much shorter than the shortest period of these states [s]
      real(wp), intent(out) :: change
      !! [m/s2]
      real(wp) :: held(size(y))
      real(wp) :: rates(size(y))
      real(wp) :: present(-1:1)
      real(wp) :: later(-1:1)
      real(wp) :: displaced

      held = y
      held(:2) = 0
      present = equation%state%uplift_acceleration
      call hold_wall(equation%state)
      call rhs(equation, t, held, rates)
      call release_wall(equation%state)
      call find_uplift_acceleration(equation%model_t, equation%state, held + duration*rates)
      later = equation%state%uplift_acceleration
      call find_uplift_acceleration(equation%model_t, equation%state, y)
      displaced = maxval(abs(present([-1, 1]) - equation%uplift%threshold))
      change = 2*maxval(abs(later([-1, 1]) - present([-1, 1]))) &
         + (duration*equation%floors%max_frequency)**2*displaced
   end subroutine bound_change

   !> True if the chatter after an impact ends below an angle and before the ground motion pulls a
   !> side off the base. A wall put to rest immediately then has the same largest displacement and
   !> the same instant of lift-off.
   !>
   !> Under a deceleration p(t) >= p_min > 0 a flight returns with at most sqrt(p_1/p_0) of its
   !> velocity. Here p_0 and p_1 are the smallest and the largest deceleration in the flight. Impact
   !> number n therefore leaves at most w e**n with w = v exp(V/2), where V is the total variation
   !> of ln(p). The flights take at most 2 w/(p_min (1 - e)) together, and none rises above w**2/(2
   !> p_min). Below a small angle, rotation and velocity reduce p only slightly. The bound subtracts
   !> four times the largest reduction. Springs with memory stay on their branches.
   logical function will_settle(equation, t, v, e, angle, pull, t_pulled) result(will)
      type(equation_t), intent(inout) :: equation
      !! equation with two states, without smooth hysteresis; unchanged on return
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: angle
      !! largest permitted rotation of a flight [rad]
      real(wp), intent(in) :: pull(2)
      !! `decelerations` [rad/s2]
      real(wp), intent(inout) :: t_pulled
      !! time at which a side is first pulled off the base, as far as known from an earlier call [s]
      real(wp), parameter :: patience = 3
      !! examined span over the duration of chatter under a steady pressure [-]
      real(wp) :: pressure, least, variation, span, w, lost
      integer :: k, m

      will = .false.
      pressure = min(pull(1), pull(2))
      if (pressure <= 0 .or. e >= 1) return
      if (v**2 > 2*pressure*angle) return
      if (ends_branch(equation, v**2/(2*pressure))) return
      span = patience*2*v/(pressure*(1 - e))
      if (.not. is_known_until(equation%motion, interval_of(equation), t + span)) return
      if (t < t_pulled .and. t + span >= t_pulled) return
      call press_over(equation, t, t + span, most_varied, least, variation, t_pulled)
      if (variation > most_varied*least) return
      w = v*exp(variation/(2*least))
      least = inverse_inertia(equation)*least
      ! The largest reduction of the deceleration near the base, at the bounds of velocity and
      ! rotation on both sides. The current side is the last one and remains set.
      lost = 0
      do k = 1, 2
         call enter_side(equation%model_t, equation%state, -equation%state%side)
         associate (side => equation%state%side, phi => w**2/(2*least))
            do m = -1, 1, 2
               lost = max(lost, pull((side + 3)/2) + side*second_derivative(equation, t, &
                  [0.0_wp, side*m*w]), pull((side + 3)/2) + side*second_derivative(equation, &
                  t, [side*phi, side*m*w]))
            end do
         end associate
      end do
      pressure = least - 4*lost
      if (pressure < least/2) return
      will = 2*w <= pressure*(1 - e)*span .and. w**2 <= 2*pressure*angle
      if (will .and. w > v) will = .not. ends_branch(equation, w**2/(2*pressure))
   end function will_settle

   !> Return whether a flight up to an angle may end the branch of a spring on either side.
   logical function ends_branch(equation, angle) result(ends)
      type(equation_t), intent(inout) :: equation
      !! unchanged on return
      real(wp), intent(in) :: angle
      !! [rad]
      integer :: k

      ends = .false.
      if (.not. equation%has_bilinear_springs) return
      ! the current side is the last one and remains set
      associate (state => equation%state)
         do k = 1, 2
            state%side = -state%side
            call renew_window(equation%model_t, state)
            ends = ends .or. state%ends_at_peak .or. state%side*angle > state%high &
               .or. state%side*angle < state%low
         end do
      end associate
   end function ends_branch

   !> Compute the smallest ground acceleration that presses the wall down in a span, and the
   !> variation of the uplift demands.
   pure subroutine press_over(equation, t_begin, t_end, most, least, variation, t_pulled)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_begin
      !! a time in the current interval [s]
      real(wp), intent(in) :: t_end
      !! [s]
      real(wp), intent(in) :: most
      !! variation over the pressing acceleration that ends the search [-]
      real(wp), intent(out) :: least
      !! smallest pressing acceleration; not positive if one side lifts off [m/s2]
      real(wp), intent(out) :: variation
      !! [m/s2]
      real(wp), intent(inout) :: t_pulled
      !! time at which a side is pulled, if the span contains one [s]
      real(wp) :: t, drive(2), before(2)
      integer :: interval

      interval = interval_of(equation)
      t = t_begin
      if (is_piecewise_linear(equation%motion) .and. .not. equation%has_vertical) then
         call scan_lines(equation%motion, interval, resting_range(equation), most, t_end, t, &
            least, variation)
         least = equation%uplift%push_gain*least
         variation = equation%uplift%push_gain*variation
         if (least <= 0) t_pulled = t
         return
      end if
      drive = uplift_demands(equation, interval, t)
      least = -maxval(drive)
      variation = 0
      do while (t < t_end .and. variation <= most*least)
         before = drive
         t = min(demand_turns(equation, interval, t), t_end)
         drive = uplift_demands(equation, interval, t)
         variation = variation + maxval(abs(drive - before))
         least = min(least, -maxval(drive))
         if (t < interval_end(equation%motion, interval)) cycle
         interval = interval + 1
         before = drive
         drive = uplift_demands(equation, interval, t)
         variation = variation + maxval(abs(drive - before))
         least = min(least, -maxval(drive))
      end do
      if (least <= 0) t_pulled = t
   end subroutine press_over

   !> Angular acceleration of the resting wall per ground acceleration beyond the threshold [1/m].
   pure real(wp) function inverse_inertia(equation) result(gain)
      type(equation_t), intent(in) :: equation

      associate (p => equation%p, c => equation%p%cos_alpha)
         gain = c*(2*p%gamma*equation%floors%excited_mass_ratio &
            + 1)/(p%R*equation%state%inertia_at_rest)
      end associate
   end function inverse_inertia

end module rwmf_model_system_rest_after_chatter
