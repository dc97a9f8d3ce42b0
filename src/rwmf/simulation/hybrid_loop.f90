!> The hybrid system: rest, rocking on either corner, overturned or collapsed, and the ways between
!> them.
!>
!> Between events an integrator follows the equation of motion of one side in one interval of the
!> ground motion. Each of its steps is searched for events (`step_events`), so that two returns in
!> one step, or a peak and an impact, are found as well. A flight knows its side, so that a start on
!> theta = 0 is no event.
module rwmf_simulation_hybrid_loop
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_assembly, only: cable_at, enter_interval, enter_side, equation_t, &
      interval_of, rates_at, second_derivative
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_drift_limits, only: count_drifts
   use rwmf_model_effects_storeys_yielding_storeys, only: settle_storeys, start_storeys
   use rwmf_model_hysteresis_bouc_wen, only: follow_loading_direction, load_bouc_wen
   use rwmf_model_hysteresis_spring_set, only: fuse_uplift, load_to, pass_window, renew_window, &
      reset_springs, tendon_is_broken, turn_back
   use rwmf_model_lift_off, only: find_lift_off, find_uplift_acceleration, jumps, pull_duration
   use rwmf_model_rest, only: may_rest, will_settle
   use rwmf_model_restitution, only: factor_at, largest_factor
   use rwmf_motion_ground_motion, only: fastest_rate, interval_at, interval_end, is_curved
   use rwmf_simulation_events_drift_events, only: cut_step, has_collapsed
   use rwmf_simulation_events_step_events, only: search_step
   use rwmf_simulation_events_step_view, only: step_view_t, view_step
   use rwmf_simulation_events_storey_events, only: storey_end_t
   use rwmf_simulation_elastic_chatter, only: drop_chatter, skip_chatter
   use rwmf_simulation_free_vibration, only: follow_free_vibration
   use rwmf_simulation_held_wall, only: elastic_loss, hold_wall, may_rest_moving, move_at_rest
   use rwmf_simulation_hybrid_state, only: change_storey, count_steps, has_ended, hybrid_t, &
      mode_collapsed, mode_no_impacts, mode_overturned, mode_rest, mode_rocking, pass_knot
   use rwmf_simulation_recorder_nearby_motion, only: meet_impact
   use rwmf_simulation_recorder_recorder, only: observe_event, observe_grazing, observe_impact, &
      observe_piece, observe_rest, observe_state, observe_still, recorder_t, sees_forces, &
      sees_rest
   use rwmf_simulation_result, only: event_branch, event_impact, event_lift_off, event_overturned, &
      event_passage, event_peak, event_rest, event_rupture
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: hybrid_t, start_hybrid, advance_hybrid, begin_step, end_step, apply_event, stay_at_rest
   public :: check_work, leave_rest, may_stand_on_fuses, stands_on_fuses
   public :: mode_rest, mode_rocking, mode_overturned, mode_collapsed, mode_no_impacts, has_ended

   real(wp), parameter :: negligible = 0.01_wp
   !! part of the tolerance below which a motion may be put to rest

contains

   !> Set out at time t with the state y.
   subroutine start_hybrid(hybrid, equation, t, y)
      type(hybrid_t), intent(inout) :: hybrid
      !! with restitution, overturning_angle, rtol and max_steps set
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      hybrid%t = t
      hybrid%y = y
      hybrid%must_restart = .true.
      hybrid%t_turn = -huge(t)
      hybrid%drifts = count_drifts(equation)
      call enter_interval(equation%model_t, equation%state, interval_at(equation%motion, t))
      call count_steps(hybrid, equation)
      call enter_side(equation%model_t, equation%state, 1)
      if (equation%moves_at_rest) call hold_wall(equation%state, .false.)
      equation%state%signs%loading_direction = 1
      if (equation%has_impacts) then
         if (y(1) < 0 .or. (abs(y(1)) <= 0 .and. y(2) < 0)) call enter_side(equation%model_t, &
            equation%state, -1)
      end if
      if (equation%has_bilinear_springs) call start_springs(equation, y(1))
      if (equation%has_loading_direction .and. abs(y(1)) > 0) call start_hysteresis(hybrid, &
         equation)
      if (equation%floors%yields) call start_storeys(equation%model_t, equation%state, y)
      if (.not. equation%has_impacts) then
         hybrid%mode = mode_no_impacts
         if (has_collapsed(equation, hybrid%drifts, y)) hybrid%mode = mode_collapsed
         return
      end if
      call find_uplift_acceleration(equation%model_t, equation%state, y)
      hybrid%mode = mode_rocking
      if (all(abs(y(:2)) <= 0)) hybrid%mode = mode_rest
      if (has_collapsed(equation, hybrid%drifts, y)) hybrid%mode = mode_collapsed
      if (abs(y(1)) >= hybrid%overturning_angle) hybrid%mode = mode_overturned
   end subroutine start_hybrid

   !> Smooth hysteresis that has not moved before, at the initial rotation; from rest the
   !> acceleration says where it goes.
   subroutine start_hysteresis(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation

      call load_bouc_wen(equation, hybrid%y)
      equation%state%signs%loading_direction = 1
      if (abs(hybrid%y(2)) <= 0) equation%state%signs%loading_direction = int(sign(1.0_wp, &
         second_derivative(equation, &
         hybrid%t, hybrid%y)))
   end subroutine start_hysteresis

   !> Springs that have not moved before, at the initial rotation.
   subroutine start_springs(equation, theta)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      call reset_springs(equation%model_t, equation%state)
      call load_to(equation%model_t, equation%state, theta)
   end subroutine start_springs

   !> Follow the system to the time t_target, or to overturning or collapse.
   subroutine advance_hybrid(hybrid, equation, integrator, recorder, t_target, control, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error
      !! as `advance`

      do while (hybrid%t < t_target .and. .not. has_ended(hybrid))
         if (hybrid%mode == mode_rest) then
            call stay_at_rest(hybrid, equation, integrator, recorder, t_target, error)
            if (allocated(error)) return
         else
            call integrate_step(hybrid, equation, integrator, recorder, t_target, error)
         end if
         if (allocated(error)) return
         call check_work(hybrid, integrator, control, error)
         if (allocated(error)) return
      end do
   end subroutine advance_hybrid

   !> Bound on the work, and the caller's wish to stop.
   subroutine check_work(hybrid, integrator, control, error)
      type(hybrid_t), intent(in) :: hybrid
      class(integrator_t), intent(in) :: integrator
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error
      !! `err_interrupt` when the caller wishes to stop, `err_numerical` after too many steps

      if (.not. is_cancelled(control) .and. integrator%steps <= hybrid%max_steps) return
      if (is_cancelled(control)) then
         call fail(error, err_interrupt, 'interrupted at t = '//trim(real_to_text(hybrid%t))//' s')
      else
         call fail(error, err_numerical, 'more than &solver max_steps steps by t = ' &
            //trim(real_to_text(hybrid%t))//' s, theta = '//trim(real_to_text(hybrid%y(1))) &
            //': raise max_steps or rtol, or shorten t_end', 'too_many_steps')
      end if
   end subroutine check_work

   !> Rest until the ground motion lifts the wall.
   subroutine stay_at_rest(hybrid, equation, integrator, recorder, t_target, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails, or the wall jumps
      real(wp) :: t_begin
      real(wp) :: t_limit
      integer :: interval
      integer :: side

      side = 0
      if (equation%moves_at_rest) then
         call move_at_rest(hybrid, equation, integrator, recorder, t_target, side, error)
         if (allocated(error)) return
      end if
      interval = interval_of(equation)
      do while (side == 0 .and. hybrid%t < t_target .and. .not. equation%moves_at_rest)
         t_begin = hybrid%t
         t_limit = t_target
         ! One interval at a time, where history and reactions show the ground motion as well.
         if (sees_rest(recorder)) t_limit = min(t_target, interval_end(equation%motion, interval))
         call find_lift_off(equation, t_limit, hybrid%t, interval, side)
         ! A motion that begins with a jump lifts the wall at once: that is no rest.
         if (hybrid%t > t_begin) call observe_rest(recorder, equation, hybrid%y, t_begin, hybrid%t)
         call enter_interval(equation%model_t, equation%state, interval)
      end do
      if (side /= 0) call leave_rest(hybrid, equation, recorder, side, error)
   end subroutine stay_at_rest

   !> The resting wall lifts off on a side.
   subroutine leave_rest(hybrid, equation, recorder, side, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      integer, intent(in) :: side
      !! +1 or -1
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps

      if (equation%moves_at_rest) call hold_wall(equation%state, .false.)
      if (equation%has_vertical) call check_ground(hybrid, equation, error)
      if (allocated(error)) return
      call enter_side(equation%model_t, equation%state, side)
      hybrid%mode = mode_rocking
      hybrid%must_restart = .true.
      hybrid%t_turn = -huge(hybrid%t)
      recorder%lift_offs = recorder%lift_offs + 1_i8
      call observe_event(recorder, event_lift_off, hybrid%t, hybrid%y)
   end subroutine leave_rest

   !> A wall that stands on its base and would leave it on both sides at once jumps.
   subroutine check_ground(hybrid, equation, error)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      type(error_t), allocatable, intent(out) :: error

      if (.not. jumps(equation, interval_of(equation), hybrid%t)) return
      call fail(error, err_numerical, 'the wall jumps at t = '//trim(real_to_text(hybrid%t)) &
         //' s: vertical motion or fuses take all of weight and cable force from the base, and a ' &
         //'wall in the air is not in the model', 'wall_jumps')
   end subroutine check_ground

   !> Fuses that have been drawn out push both corners up on the way back. A wall that one of them
   !> holds up at one corner rocks on the other; together stronger than weight and cable, they lift
   !> it off both, and it stands on its fuses. Fails at the first such time of the step.
   subroutine check_fuses(equation, piece, error)
      type(equation_t), intent(in) :: equation
      type(step_view_t), intent(in) :: piece
      !! up to the end of the step, or to the event that cuts it
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      real(wp) :: y(equation%n)

      if (.not. may_stand_on_fuses(equation)) return
      if (.not. stands_on_fuses(equation, piece%y_b(1))) return
      bracket = bracket_between(piece%t_a, piece%t_b)
      do while (bracket%is_open)
         call piece%integrator%state_at(bracket%middle, y, error)
         if (allocated(error)) return
         call narrow(bracket, stands_on_fuses(equation, y(1)))
      end do
      call fail(error, err_numerical, 'the wall stands on its fuses at t = ' &
         //trim(real_to_text(bracket%high)) &
         //' s: drawn out before, both together push it up with more than weight and cable, and ' &
         //'no corner stays on the ground, which is not in the model; fuses with eta_y <= ' &
         //'(1 + eta_0)/2 never do that while the cable keeps its prestress', 'wall_on_fuses')
   end subroutine check_fuses

   !> May the fuses lift the wall off the ground? Their forces grow with the stroke: what they are
   !> on the base mostly says that all is well.
   pure logical function may_stand_on_fuses(equation)
      type(equation_t), intent(in) :: equation

      may_stand_on_fuses = .false.
      if (.not. equation%has_fuses) return
      may_stand_on_fuses = -sum(equation%state%springs(size(equation%springs) - 1:)%offset) &
         > equation%p%g
   end function may_stand_on_fuses

   !> Do the fuses push the wall up with more than weight and cable, beyond round-off?
   logical function stands_on_fuses(equation, theta)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      type(cable_state_t) :: cable

      cable = cable_at(equation, theta)
      stands_on_fuses = fuse_uplift(equation, theta) > (1 + cable%force)*(1 + sqrt(epsilon(theta)))
   end function stands_on_fuses

   !> One step of the integrator, cut at the first event that ends the flight.
   subroutine integrate_step(hybrid, equation, integrator, recorder, t_target, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_limit
      real(wp) :: span

      call begin_step(hybrid, equation, recorder, integrator%steps, t_target, t_limit, span)
      if (t_limit <= hybrid%t) return
      if (hybrid%must_restart) call integrator%start(hybrid%t, hybrid%y, span, error)
      if (allocated(error)) return
      hybrid%must_restart = .false.
      t_limit = min(t_limit, hybrid%t + longest_step(equation))
      call integrator%step(t_limit, error)
      if (.not. allocated(error)) call end_step(hybrid, equation, integrator, recorder, error)
   end subroutine integrate_step

   !> Longest step under a pulse far shorter than the periods of the scene, else no limit [s].
   !>
   !> Such a pulse leaves much less velocity than it has given in between; the tolerance, which goes
   !> by the largest one, would let long steps err by all of what is left.
   pure real(wp) function longest_step(equation) result(longest)
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: short = 10
      !! rate of the pulse over those of the scene [-]
      real(wp), parameter :: angle = 0.1_wp
      !! of the pulse in a step [rad]
      real(wp) :: rate

      longest = huge(longest)
      rate = fastest_rate(equation%motion)
      if (rate <= short*max(equation%p%omega_s, equation%floors%max_frequency)) return
      if (equation%has_wall) then
         if (rate <= short*sqrt(equation%p%g_over_R)) return
      end if
      if (is_curved(equation%motion, interval_of(equation))) longest = angle/rate
   end function longest_step

   !> How far the next step may go, and what a new piece of motion needs to know.
   subroutine begin_step(hybrid, equation, recorder, steps, t_target, t_limit, span)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      integer(i8), intent(in) :: steps
      !! that the integrator has taken
      real(wp), intent(in) :: t_target
      !! [s]
      real(wp), intent(out) :: t_limit
      !! not beyond the present time where there was no way to go, and a knot has been passed [s]
      real(wp), intent(out) :: span
      !! within which the motion is expected to change its course, where it begins anew [s]

      t_limit = min(t_target, interval_end(equation%motion, interval_of(equation)))
      span = huge(span)
      if (hybrid%must_restart) call skip_chatter(hybrid, equation, recorder, &
         negligible*hybrid%rtol*max(recorder%theta_max, -recorder%theta_min), t_limit)
      call follow_free_vibration(hybrid, equation, recorder, t_target, t_limit)
      if (t_limit - hybrid%t <= 8*epsilon(t_limit)*t_limit) then
         ! An event within round-off of a knot: no integrator can step that far.
         hybrid%flight = 0
         hybrid%t = t_limit
         call pass_knot(hybrid, equation, steps)
         return
      end if
      if (.not. hybrid%must_restart) return
      if (equation%has_bilinear_springs) call renew_window(equation%model_t, equation%state)
      if (equation%has_loading_direction) call set_loading_direction(hybrid, equation)
      if (equation%floors%yields) call settle_storeys(equation%model_t, equation%state, hybrid%y, &
         hybrid%t <= hybrid%t_turn)
      if (hybrid%flight > 0) then
         span = hybrid%flight
      else
         span = flight_time(hybrid, equation)
      end if
      hybrid%flight = 0
   end subroutine begin_step

   !> Look at the integrator's last step, and let what happens first in it happen.
   subroutine end_step(hybrid, equation, integrator, recorder, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails, the wall jumps or stands on its fuses
      type(storey_end_t) :: ending
      type(step_view_t) :: step
      integer :: event

      call view_step(step, equation, integrator)
      call cut_step(step, hybrid%drifts, ending, error)
      if (allocated(error)) return
      call search_step(hybrid, step, recorder, event, error)
      if (allocated(error)) return
      step%t_b = hybrid%t
      step%y_b => hybrid%y
      if (equation%has_fuses) call check_fuses(equation, step, error)
      if (allocated(error)) return
      call observe_piece(recorder, step, error)
      if (allocated(error)) return
      call apply_event(hybrid, equation, recorder, event, error)
      if (allocated(error)) return
      ! When nothing else happened, the flight goes on with the next step.
      if (event == 0 .and. ending%storey > 0) call change_storey(hybrid, equation, recorder, ending)
      call pass_knot(hybrid, equation, integrator%steps)
   end subroutine end_step

   !> Let the event at the present time happen.
   subroutine apply_event(hybrid, equation, recorder, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      integer, intent(in) :: event
      !! one of the `event_` numbers, or 0
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps

      select case (event)
      case (event_impact)
         call apply_impact(hybrid, equation, recorder)
         if (equation%has_vertical) call check_ground(hybrid, equation, error)
      case (event_branch)
         call enter_branch(hybrid, equation, recorder)
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
      case default
         ! nothing
      end select
   end subroutine apply_event

   !> The sign that theta' has in the piece of motion that begins, and what follows from it; after a
   !> peak it is known already.
   pure subroutine set_loading_direction(hybrid, equation)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(inout) :: equation

      if (abs(hybrid%y(2)) > 0) then
         equation%state%signs%loading_direction = int(sign(1.0_wp, hybrid%y(2)))
      else if (hybrid%mode == mode_rocking .and. abs(hybrid%y(1)) <= 0) then
         equation%state%signs%loading_direction = equation%state%side
      end if
      call follow_loading_direction(equation%model_t, equation%state, hybrid%y)
   end subroutine set_loading_direction

   !> A spring enters another branch.
   subroutine enter_branch(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      logical :: was_broken

      was_broken = tendon_is_broken(equation)
      call observe_state(recorder, equation, hybrid%t, hybrid%y)
      call pass_window(equation%model_t, equation%state, is_rising=hybrid%is_rising)
      hybrid%must_restart = .true.
      if (tendon_is_broken(equation) .and. .not. was_broken) then
         call observe_event(recorder, event_rupture, hybrid%t, hybrid%y)
      else
         call observe_event(recorder, event_branch, hybrid%t, hybrid%y)
      end if
   end subroutine enter_branch

   !> Estimated duration of a flight that begins at theta = 0: a little more than 2 v/a against an
   !> acceleration that pulls it back, or twice the time for which the motion pulls it off; else no
   !> limit [s].
   real(wp) function flight_time(hybrid, equation) result(time)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp) :: pull
      !! towards the base [rad/s2]

      time = huge(time)
      if (hybrid%mode /= mode_rocking .or. abs(hybrid%y(1)) > 0) return
      pull = -equation%state%side*second_derivative(equation, hybrid%t, hybrid%y)
      if (abs(hybrid%y(2)) < pull*sqrt(huge(time))) then
         time = 2.2_wp*abs(hybrid%y(2))/max(pull, tiny(pull))
      else if (pull <= 0) then
         time = pull_duration(equation, hybrid%t)
         if (time < huge(time)/4) time = max(2*time, 256*spacing(hybrid%t))
      end if
      if (time <= 0) time = huge(time)
   end function flight_time

   !> At an impact the velocity falls by the factor e, the other side's equation takes over, or the
   !> wall comes to rest.
   !>
   !> When one side is pressed hard and the other hardly at all, a flight can be over within a few
   !> spacings of the time: the wall is then back with the velocity that it left with, at once.
   subroutine apply_impact(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), parameter :: followable = 64
      !! least duration of a flight in spacings of the time [-]

      hybrid%must_restart = .true.
      do
         call apply_one_impact(hybrid, equation, recorder)
         if (hybrid%mode == mode_rest .or. abs(hybrid%y(2)) <= 0) return
         hybrid%flight = flight_time(hybrid, equation)
         ! a spacing is at most epsilon*t, and costs a call
         if (hybrid%flight > followable*epsilon(hybrid%t)*hybrid%t) return
         if (hybrid%flight > followable*spacing(hybrid%t)) return
         hybrid%y(2) = -hybrid%y(2)
      end do
   end subroutine apply_impact

   !> One impact and what follows from it.
   subroutine apply_one_impact(hybrid, equation, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), parameter :: slow = 1000
      !! impacts faster than that over the largest velocity, times sqrt(rtol), do not graze [-]
      real(wp) :: after
      logical :: rests

      ! a warning that ordinates of peaks alone do not have
      if (hybrid%settled_angle <= 0 &
          .and. abs(hybrid%y(2)) < slow*sqrt(hybrid%rtol)*recorder%theta_dot_ends) then
         call look_for_grazing(hybrid, equation, recorder)
      end if
      after = factor_at(hybrid%restitution, abs(hybrid%y(2)))*hybrid%y(2)
      call observe_event(recorder, event_impact, hybrid%t, hybrid%y)
      call observe_impact(recorder, equation, hybrid%y(2), after)
      if (allocated(recorder%nearby)) call meet_impact(recorder%nearby, equation, hybrid%y, &
         factor_at(hybrid%restitution, abs(hybrid%y(2))))
      hybrid%y(:2) = [0.0_wp, after]
      hybrid%t_turn = -huge(hybrid%t)
      call turn_back(equation%model_t, equation%state, 0.0_wp, goes_on=abs(after) > 0)
      call enter_side(equation%model_t, equation%state, -equation%state%side)
      if (equation%has_bilinear_springs .or. equation%has_loading_direction &
          .or. equation%moves_at_rest) call find_uplift_acceleration(equation%model_t, &
          equation%state, hybrid%y)
      if (equation%moves_at_rest) then
         rests = may_rest_moving(equation, hybrid%t, hybrid%y, abs(after), &
            largest_factor(hybrid%restitution, abs(after)), &
            negligible*hybrid%rtol*max(recorder%theta_max, -recorder%theta_min), &
            negligible*hybrid%rtol*recorder%theta_dot_ends)
         if (rests .and. 1 - largest_factor(hybrid%restitution, abs(after)) <= elastic_loss &
             .and. abs(after) > negligible*hybrid%rtol*recorder%theta_dot_ends) then
            call drop_chatter(equation, recorder, hybrid%t, after)
         end if
      else
         rests = may_rest(equation, hybrid%t, abs(after), &
            largest_factor(hybrid%restitution, abs(after)), &
            negligible*hybrid%rtol*max(recorder%theta_max, -recorder%theta_min), &
            negligible*hybrid%rtol*recorder%theta_dot_ends)
         if (.not. rests .and. hybrid%settled_angle > 0) rests = will_settle(equation, hybrid%t, &
            abs(after), largest_factor(hybrid%restitution, abs(after)), &
            hybrid%settled_angle*max(recorder%theta_max, -recorder%theta_min), hybrid%t_pulled)
      end if
      if (rests) then
         if (sees_forces(recorder)) call observe_end_of_chatter(hybrid, equation, recorder)
         call turn_back(equation%model_t, equation%state, 0.0_wp)
         if (equation%has_bilinear_springs) call find_uplift_acceleration(equation%model_t, &
            equation%state, hybrid%y)
         hybrid%y(:2) = 0
         hybrid%mode = mode_rest
         call observe_event(recorder, event_rest, hybrid%t, hybrid%y)
      else if (abs(after) <= 0) then
         ! Nothing bounces (e = 0) and the motion pulls: the drive says to which side.
         call leave_without_velocity(hybrid, equation)
      end if
   end subroutine apply_one_impact

   !> Reactions at the end of the chatter that a wall at rest is spared: those of a wall that leaves
   !> its base on either side without velocity, when the flights, of 2 v/a each, will have ended.
   subroutine observe_end_of_chatter(hybrid, equation, recorder)
      type(hybrid_t), intent(in) :: hybrid
      !! after the impact
      type(equation_t), intent(inout) :: equation
      !! returns as it was
      type(recorder_t), intent(inout) :: recorder
      real(wp), dimension(equation%n) :: y, rates
      real(wp) :: pull(2)
      !! towards the base on the side that the wall leaves to, and on the other [rad/s2]
      real(wp) :: t, e
      integer :: i

      if (abs(hybrid%y(2)) <= 0) return
      y = hybrid%y
      y(:2) = 0
      do i = 1, 2
         call rates_at(equation, hybrid%t, y, rates)
         pull(i) = -equation%state%side*rates(2)
         call enter_side(equation%model_t, equation%state, -equation%state%side)
      end do
      if (minval(pull) <= 0) return
      e = largest_factor(hybrid%restitution, abs(hybrid%y(2)))
      t = hybrid%t + 2*abs(hybrid%y(2))*(1/pull(1) + e/pull(2))/(1 - e**2)
      t = min(t, interval_end(equation%motion, interval_of(equation)))
      ! the floors go on meanwhile
      y(3:) = y(3:) + (t - hybrid%t)*rates(3:)
      do i = 1, 2
         call observe_still(recorder, equation, t, y)
         call enter_side(equation%model_t, equation%state, -equation%state%side)
      end do
   end subroutine observe_end_of_chatter

   !> An impact so slow that the acceleration away from the base would have ended the way at once.
   subroutine look_for_grazing(hybrid, equation, recorder)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp) :: away
      !! from the base [rad/s2]

      away = equation%state%side*second_derivative(equation, hybrid%t, hybrid%y)
      if (away > 0) call observe_grazing(recorder, hybrid%rtol, hybrid%t, hybrid%y(2)**2/(2*away))
   end subroutine look_for_grazing

   !> The wall touches its base without velocity while one side is pulled.
   subroutine leave_without_velocity(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      real(wp) :: t
      integer :: interval
      integer :: side

      t = hybrid%t
      interval = interval_of(equation)
      call find_lift_off(equation, t, t, interval, side)
      if (side /= 0) then
         call enter_side(equation%model_t, equation%state, side)
      else
         hybrid%mode = mode_rest
      end if
   end subroutine leave_without_velocity

end module rwmf_simulation_hybrid_loop
