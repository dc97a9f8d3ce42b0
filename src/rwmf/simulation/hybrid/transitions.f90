!> Transitions of the hybrid system at events, shared by all methods, spectra and hosts.
!>
!> The events are impact, rest, lift-off, branch ends, turns, overturning and collapse.
module rwmf_simulation_hybrid_transitions
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_hysteresis_bouc_wen, only: follow_loading_direction
   use rwmf_model_hysteresis_spring_set, only: pass_window, renew_window, broken_tendons, &
      turn_back
   use rwmf_model_restitution, only: factor_at, largest_factor
   use rwmf_model_system_assembly, only: enter_interval, enter_side, equation_t, interval_of, &
      rates_at, second_derivative
   use rwmf_model_system_energy, only: mechanical_energy
   use rwmf_model_system_lift_off, only: find_lift_off, find_uplift_acceleration, jumps, &
      pull_duration
   use rwmf_model_system_reactions, only: impulse_from_rest
   use rwmf_model_system_rest_after_chatter, only: decelerations, elastic_loss, hold_wall, &
      may_rest, release_wall, will_settle
   use rwmf_motion_ground_motion, only: interval_end
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_storey_events, only: end_branch, settle_storeys
   use rwmf_simulation_hybrid_elastic_chatter, only: drop_chatter
   use rwmf_simulation_recorder_reaction_extremes, only: observe_impulse
   use rwmf_simulation_recorder_recorder, only: observe_event, observe_grazing, observe_impact, &
      observe_state, observe_still, recorder_t, sees_forces, sees_impulses
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, is_at_rest, mode_collapsed, mode_held, &
      mode_overturned, mode_rest, mode_rocking
   use rwmf_simulation_state_result, only: event_branch, event_collapsed, event_impact, &
      event_lift_off, event_overturned, event_passage, event_peak, event_rest, event_rupture, &
      event_storey_limit, event_storey_turn, event_storey_zero
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: reason_of_jump
   public :: apply_event, begin_piece, enter_rest, lift_off, observe_peak, negligible

   character(*), parameter :: reason_of_jump = 'ground motion or fuses take all of weight and ' &
      //'cable force from the base, and a wall in the air is not in the model'
   !! why a wall leaves its base with both corners
   real(wp), parameter :: negligible = 0.01_wp
   !! fraction of the tolerance below which a motion may be set to rest
   real(wp), parameter :: flight_margin = 2.2_wp
   !! estimated duration of a flight over the ratio of velocity to deceleration, at least 2 [-]

contains

   !> Apply the event at the current time.
   subroutine apply_event(hybrid, equation, recorder, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      type(ending_t), intent(in) :: ending
      !! event, or none
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps
      integer :: broken
      integer, allocatable :: before(:)
      !! (springs) kinds of branches

      select case (ending%kind)
      case (event_impact)
         call apply_impact(hybrid, equation, recorder)
         call check_ground(hybrid, equation, error)
      case (event_lift_off)
         call lift_off(hybrid, equation, recorder, 2*ending%number - 3, error)
      case (event_branch)
         ! move a spring to its next branch
         broken = broken_tendons(equation%state)
         before = equation%state%springs%kind
         call observe_state(recorder, equation, hybrid%t, hybrid%y)
         call pass_window(equation%model_t, equation%state, ending%is_rising)
         hybrid%must_restart = .true.
         if (broken_tendons(equation%state) > broken) then
            call observe_event(recorder, event_rupture, hybrid%t, hybrid%y)
         else if (any(equation%state%springs%kind /= before)) then
            ! a stroke that turns ends a window without a change of branch
            call observe_event(recorder, event_branch, hybrid%t, hybrid%y)
         end if
      case (event_peak)
         hybrid%y(2) = 0
         call turn_back(equation%model_t, equation%state, hybrid%y(1))
         if (equation%has_loading_direction) then
            equation%state%signs%loading_direction = -equation%state%signs%loading_direction
         end if
         hybrid%must_restart = .true.
      case (event_passage)
         hybrid%must_restart = .true.
      case (event_overturned)
         hybrid%mode = mode_overturned
         call observe_event(recorder, event_overturned, hybrid%t, hybrid%y)
      case (event_collapsed)
         hybrid%mode = mode_collapsed
         call observe_event(recorder, event_collapsed, hybrid%t, hybrid%y)
      case (event_storey_limit, event_storey_turn, event_storey_zero)
         ! end the branch of a storey at the current state
         call observe_state(recorder, equation, hybrid%t, hybrid%y)
         call end_branch(equation%model_t, equation%state, ending, hybrid%y)
         if (.not. allocated(equation%floors%laws)) call observe_event(recorder, event_branch, &
            hybrid%t, hybrid%y)
         if (ending%kind == event_storey_turn) hybrid%t_turn = hybrid%t
         hybrid%must_restart = .true.
      case default
         ! no change
      end select
   end subroutine apply_event

   !> Apply the lift-off of the resting wall on a side.
   subroutine lift_off(hybrid, equation, recorder, side, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      integer, intent(in) :: side
      !! side of the lift-off, +1 or -1
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps

      call release_wall(equation%state)
      call check_ground(hybrid, equation, error)
      if (allocated(error)) return
      call enter_side(equation%model_t, equation%state, side)
      hybrid%mode = mode_rocking
      hybrid%must_restart = .true.
      hybrid%t_turn = -huge(hybrid%t)
      recorder%t_settled = -huge(hybrid%t)
      recorder%lift_offs = recorder%lift_offs + 1_i8
      call observe_event(recorder, event_lift_off, hybrid%t, hybrid%y)
   end subroutine lift_off

   !> Fail if a wall on its base would leave it on both sides at once.
   subroutine check_ground(hybrid, equation, error)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      type(error_t), allocatable, intent(out) :: error

      if (.not. equation%has_vertical) return
      if (.not. jumps(equation, interval_of(equation), hybrid%t)) return
      call fail(error, err_numerical, 'the wall jumps at t = '//trim(real_to_text(hybrid%t)) &
         //' s: '//reason_of_jump, 'wall_jumps')
   end subroutine check_ground

   !> Place both corners of the wall on the base.
   pure subroutine enter_rest(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation

      hybrid%y(:2) = 0
      hybrid%mode = mode_rest
      if (.not. equation%moves_at_rest) return
      hybrid%mode = mode_held
      call hold_wall(equation%state)
   end subroutine enter_rest

   !> Initialise a new piece of motion: branch windows, loading directions and expected duration.
   subroutine begin_piece(hybrid, equation, span)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      real(wp), intent(out) :: span
      !! [s]

      call renew_window(equation%model_t, equation%state)
      if (equation%has_loading_direction) then
         ! after a peak the loading direction is already set
         if (abs(hybrid%y(2)) > 0) then
            equation%state%signs%loading_direction = int(sign(1.0_wp, hybrid%y(2)))
         else if (hybrid%mode == mode_rocking .and. abs(hybrid%y(1)) <= 0) then
            equation%state%signs%loading_direction = equation%state%side
         end if
         call follow_loading_direction(equation%model_t, equation%state, hybrid%y)
      end if
      call settle_storeys(equation%model_t, equation%state, hybrid%y, hybrid%t <= hybrid%t_turn)
      span = hybrid%flight
      if (.not. span > 0) span = flight_time(hybrid, equation)
      hybrid%flight = 0
   end subroutine begin_piece

   !> Estimated duration of a flight that begins at theta = 0; infinite if unknown [s].
   !>
   !> It is slightly more than 2 v/a if the deceleration a pulls the wall back. Otherwise it is
   !> twice the time during which the motion pulls the wall off its base.
   real(wp) function flight_time(hybrid, equation) result(time)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp) :: pull
      !! acceleration towards the base [rad/s2]

      time = huge(time)
      if (hybrid%mode /= mode_rocking .or. abs(hybrid%y(1)) > 0) return
      pull = -equation%state%side*second_derivative(equation, hybrid%t, hybrid%y)
      if (abs(hybrid%y(2)) < pull*sqrt(huge(time))) then
         time = flight_margin*abs(hybrid%y(2))/max(pull, tiny(pull))
      else if (pull <= 0) then
         time = pull_duration(equation, hybrid%t)
         if (time < huge(time)/4) time = max(2*time, 256*spacing(hybrid%t))
      end if
      if (time <= 0) time = huge(time)
   end function flight_time

   !> Record a peak of the rotation.
   subroutine observe_peak(hybrid, equation, recorder, v, t, y)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: v
      !! angular velocity before the peak [rad/s]
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      if (hybrid%mode == mode_rocking .and. equation%state%side*v < 0) then
         call observe_grazing(recorder, hybrid%rtol, t, abs(y(1)))
      end if
      call observe_state(recorder, equation, t, y)
      call observe_event(recorder, event_peak, t, y)
   end subroutine observe_peak

   !> Apply an impact: reduce the velocity by the factor e, then change the side or set the wall to
   !> rest.
   !>
   !> If one side is strongly pressed and the other hardly at all, a flight may last only a few
   !> spacings of the time. The wall then returns at once with its initial velocity.
   subroutine apply_impact(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), parameter :: followable = 64
      !! shortest duration of a flight in spacings of the time [-]

      hybrid%must_restart = .true.
      hybrid%is_stopped = hybrid%stops_at_impact
      do
         hybrid%flight = 0
         call apply_one_impact(hybrid, equation, recorder)
         if (is_at_rest(hybrid) .or. abs(hybrid%y(2)) <= 0) return
         if (.not. hybrid%flight > 0) hybrid%flight = flight_time(hybrid, equation)
         ! a spacing is at most epsilon*t; this test saves a call
         if (hybrid%flight > followable*epsilon(hybrid%t)*hybrid%t) return
         if (hybrid%flight > followable*spacing(hybrid%t)) return
         hybrid%y(2) = -hybrid%y(2)
      end do
   end subroutine apply_impact

   !> Apply one impact and choose the following side or rest.
   subroutine apply_one_impact(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), parameter :: slow = 1000
      !! ratio to the largest velocity, over sqrt(rtol), above which impacts do not graze [-]
      real(wp) :: after, energy, impulse(2), t, away
      !! the last one: acceleration away from the base [rad/s2]
      integer :: interval, side
      logical :: stays

      ! spectrum ordinates of peaks alone have no such warning
      if (hybrid%settled_angle <= 0 &
          .and. abs(hybrid%y(2)) < slow*sqrt(hybrid%rtol)*recorder%theta_dot_ends) then
         ! record a grazing impact: so slow that the acceleration away from the base nearly prevents
         ! contact
         away = equation%state%side*second_derivative(equation, hybrid%t, hybrid%y)
         if (away > 0) call observe_grazing(recorder, hybrid%rtol, hybrid%t, hybrid%y(2)**2/(2 &
            *away))
      end if
      after = factor_at(hybrid%restitution, abs(hybrid%y(2)))*hybrid%y(2)
      call observe_event(recorder, event_impact, hybrid%t, hybrid%y)
      energy = 0
      if (recorder%keeps_energy .and. equation%beam%n > 0) energy = mechanical_energy(equation, &
         hybrid%y)
      impulse = 0
      if (sees_impulses(recorder)) impulse = impulse_from_rest(equation, hybrid%t, hybrid%y)
      stays = .false.
      call land_effects(equation, hybrid%y, after, stays)
      if (stays) after = 0
      call observe_impact(recorder, equation, hybrid%y(2), after)
      hybrid%y(:2) = [0.0_wp, after]
      hybrid%t_turn = -huge(hybrid%t)
      call turn_back(equation%model_t, equation%state, 0.0_wp, goes_on=abs(after) > 0)
      call enter_side(equation%model_t, equation%state, -equation%state%side)
      if (recorder%keeps_energy .and. equation%beam%n > 0) then
         recorder%energy%impact = recorder%energy%impact + energy - mechanical_energy(equation, &
            hybrid%y)
      end if
      if (sees_impulses(recorder)) call observe_impulse(recorder%forces, hybrid%t, &
         impulse_from_rest(equation, hybrid%t, hybrid%y) - impulse)
      call find_uplift_acceleration(equation%model_t, equation%state, hybrid%y)
      if (.not. stays) stays = settles(hybrid, equation, recorder)
      if (stays) then
         call end_chatter(hybrid, equation, recorder)
      else if (abs(after) <= 0) then
         ! Without a bounce (e = 0), the uplift demand gives the side of the next motion.
         t = hybrid%t
         interval = interval_of(equation)
         call find_lift_off(equation, t, t, interval, side)
         if (side /= 0) then
            call enter_side(equation%model_t, equation%state, side)
         else
            call enter_rest(hybrid, equation)
         end if
      end if
   end subroutine apply_one_impact

   !> Apply the effects that change further states by their own momentum balance at an impact.
   subroutine land_effects(equation, y, after, stays)
      type(equation_t), intent(in) :: equation
      !! equation on the side before the impact
      real(wp), intent(inout) :: y(:)
      !! (states) before the impact; on return, further states have their values after it
      real(wp), intent(inout) :: after
      !! angular velocity after the impact [rad/s]
      logical, intent(inout) :: stays
      !! an effect keeps both corners on the base
      integer :: i

      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         associate (effect => equation%effects(i))
            if (associated(effect%land)) call effect%land(effect, equation, y, after, stays)
         end associate
      end do
   end subroutine land_effects

   !> Return whether the wall rests after an impact.
   logical function settles(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      !! hybrid system after the impact
      type(equation_t), intent(inout) :: equation
      !! equation, unchanged on return
      type(recorder_t), intent(inout) :: recorder
      real(wp) :: v, e, small(2)
      !! velocity; largest velocity factor of further impacts; negligible rotation and velocity
      real(wp) :: pull(2)

      v = abs(hybrid%y(2))
      e = largest_factor(hybrid%restitution, v)
      associate (largest => max(recorder%theta_max, -recorder%theta_min))
         small = negligible*hybrid%rtol*[largest, recorder%theta_dot_ends]
         pull = decelerations(equation, hybrid%t)
         settles = may_rest(equation, hybrid%t, hybrid%y, v, e, small(1), small(2), pull)
         if (settles .and. equation%moves_at_rest .and. 1 - e <= elastic_loss &
             .and. v > small(2)) then
            call drop_chatter(equation, recorder, hybrid%t, hybrid%y(2))
         end if
         if (settles .or. hybrid%settled_angle <= 0) return
         settles = will_settle(equation, hybrid%t, v, e, hybrid%settled_angle*largest, pull, &
            hybrid%t_pulled)
         ! outputs of peaks alone need no more than this estimate, without damping and rotation
         associate (ahead => pull((equation%state%side + 3)/2))
            if (ahead > 0 .and. .not. settles) hybrid%flight = flight_margin*v/ahead
         end associate
      end associate
   end function settles

   !> Set the wall to rest after an impact.
   subroutine end_chatter(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp) :: after
      logical :: stays

      ! let the effects take the momentum that the impacts left out would give to them
      stays = .true.
      after = 0
      call land_effects(equation, hybrid%y, after, stays)
      if (sees_forces(recorder)) call observe_end_of_chatter(hybrid, equation, recorder)
      call turn_back(equation%model_t, equation%state, 0.0_wp)
      call find_uplift_acceleration(equation%model_t, equation%state, hybrid%y)
      call enter_rest(hybrid, equation)
      call observe_event(recorder, event_rest, hybrid%t, hybrid%y)
   end subroutine end_chatter

   !> Record the reactions at the end of the chatter that the rest omits.
   !>
   !> The first omitted flight begins with the velocity after the impact. At the end of the flights
   !> the wall leaves its base on either side without velocity; the forces of rest follow. In
   !> between, forces vary with velocity and ground motion along straight lines, broken at the
   !> knots.
   subroutine observe_end_of_chatter(hybrid, equation, recorder)
      type(hybrid_t), intent(in) :: hybrid
      !! hybrid system after the impact
      type(equation_t), intent(inout) :: equation
      !! equation, unchanged on return
      type(recorder_t), intent(inout) :: recorder
      real(wp), dimension(equation%n) :: y, held
      real(wp), dimension(2) :: pull, later, e
      !! accelerations towards the base on the next side and on the other side, now and later
      !! [rad/s2]. Velocity factors of the impacts that end flights on both sides.
      real(wp) :: t, knot
      !! end of the flights, end of an interval [s]
      integer :: interval

      if (abs(hybrid%y(2)) <= 0) return
      if (equation%beam%n == 0) call observe_still(recorder, equation, hybrid%t, hybrid%y)
      y = [0.0_wp, 0.0_wp, hybrid%y(3:)]
      call find_pulls(hybrid, equation, hybrid%t, y, pull, e, held)
      if (minval(pull) <= 0) return
      t = hybrid%t
      interval = interval_of(equation)
      if (e(1)*e(2) < 1) then
         t = t + end_of_flights(abs(hybrid%y(2)), pull, e)
         ! the pressure changes in the meantime
         t = min(t, interval_end(equation%motion, interval))
         if (t > hybrid%t) then
            y(3:) = hybrid%y(3:) + (t - hybrid%t)*held(3:)
            call find_pulls(hybrid, equation, t, y, later, e)
            t = hybrid%t + end_of_flights(abs(hybrid%y(2)), pull, e, (later - pull)/(t - hybrid%t))
         end if
      end if
      do
         knot = interval_end(equation%motion, interval_of(equation))
         call observe_both_sides(min(t, knot))
         if (t <= knot) exit
         call enter_interval(equation%model_t, equation%state, interval_of(equation) + 1)
         call observe_both_sides(knot)
      end do
      call enter_interval(equation%model_t, equation%state, interval)
      recorder%t_settled = t

   contains

      !> Record the forces on both sides; the floors move in the meantime.
      subroutine observe_both_sides(at)
         real(wp), intent(in) :: at
         !! [s]
         integer :: k

         y(3:) = hybrid%y(3:) + (at - hybrid%t)*held(3:)
         do k = 1, 2
            call observe_still(recorder, equation, at, y)
            call enter_side(equation%model_t, equation%state, -equation%state%side)
         end do
      end subroutine observe_both_sides
   end subroutine observe_end_of_chatter

   !> Compute the accelerations towards the base of a wall that leaves it without velocity.
   subroutine find_pulls(hybrid, equation, t, y, pull, e, held)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(inout) :: equation
      !! unchanged on return
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) with the wall on its base
      real(wp), intent(out) :: pull(2)
      !! on the present side and on the other side [rad/s2]
      real(wp), intent(out) :: e(2)
      !! velocity factors of the impacts that end flights on these sides [-]
      real(wp), intent(out), optional :: held(:)
      !! (states) rates of the other states
      real(wp) :: rates(size(y))
      integer :: i

      do i = 1, 2
         call rates_at(equation, t, y, rates)
         pull(i) = -equation%state%side*rates(2)
         e(i) = landing_factor(hybrid, equation)
         call enter_side(equation%model_t, equation%state, -equation%state%side)
      end do
      if (.not. present(held)) return
      held = rates
      if (equation%beam%n == 0) return
      ! the impacts take back the energy that the flights give to the modes
      call hold_wall(equation%state)
      call rates_at(equation, t, y, held)
      call release_wall(equation%state)
   end subroutine find_pulls

   !> Duration of the flights from a velocity to rest, alternately on both sides [s].
   !>
   !> Under a constant deceleration p a flight takes 2 v/p. A deceleration that grows at the rate r
   !> shortens it by the share r t/(3 p). It increases the velocity of the return by r t**2/6.
   pure real(wp) function end_of_flights(v, pull, e, growth) result(t)
      real(wp), intent(in) :: v
      !! velocity at the beginning [rad/s]
      real(wp), intent(in) :: pull(2)
      !! decelerations of the first and the second flight [rad/s2]
      real(wp), intent(in) :: e(2)
      !! velocity factors of the impacts behind them [-]
      real(wp), intent(in), optional :: growth(2)
      !! rates of the decelerations [rad/s3]; 0 if absent
      integer, parameter :: most = 200
      real(wp) :: left, p(2), span
      integer :: i, k

      t = 0
      left = v
      p = pull
      if (present(growth)) then
         do k = 1, most
            i = 2 - mod(k, 2)
            p = pull + growth*t
            if (minval(p) <= minval(pull)/2) exit
            span = 2*left/p(i)
            span = span*(1 - growth(i)*span/(3*p(i)))
            left = e(i)*(left + growth(i)*span**2/6)
            t = t + span
         end do
      end if
      ! the last flight was on the second side
      t = t + 2*left*(1/p(1) + e(1)/p(2))/(1 - e(1)*e(2))
   end function end_of_flights

   !> Velocity factor of the impact that ends a flight on the present side. The modes of a bending
   !> wall take momentum.
   real(wp) function landing_factor(hybrid, equation) result(e)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp) :: y(size(hybrid%y)), after
      logical :: stays

      e = largest_factor(hybrid%restitution, abs(hybrid%y(2)))
      if (equation%beam%n == 0) return
      y = hybrid%y
      y(:2) = [0.0_wp, 1.0_wp]
      after = 0
      stays = .false.
      call land_effects(equation, y, after, stays)
      e = after/y(2)
   end function landing_factor

end module rwmf_simulation_hybrid_transitions
