!> Common steps of a batch of lanes, and the events in these steps.
!>
!> The lanes of a batch step together. A step with a possible event is inspected individually. If
!> the rotation alone does not show all changes, the search of the hybrid loop inspects it. No
!> number of a lane depends on the other lanes: a single run is a batch of one lane.
module rwmf_simulation_lanes_loop
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t, extend_work
   use rwmf_integrator_integrator, only: step_too_small
   use rwmf_integrator_lane_columns, only: at_limit, is_done, is_rejected, needs_inspection, &
      of_bottom, of_fastest, of_target, of_high, of_interval, of_least, &
      of_length, of_limit, of_line, of_longest, of_low, of_most, of_rejected, of_steps, of_time, &
      of_calm, of_max_rate, of_plain, of_top, of_trial, of_vertical_line, of_inspection
   use rwmf_integrator_lane_control, only: accept_or_reject_one => accept_or_reject, &
      pass_one => advance_intervals, &
      plan_one => plan_step
   use rwmf_integrator_lane_step, only: attempt_one => attempt_step
   use rwmf_integrator_one_step, only: begin_at
   use rwmf_integrator_pairs, only: step_tolerance
   use rwmf_math_sign_changes, only: no_change, unclear
   use rwmf_model_assembly, only: enter_interval, equation_t, interval_of, rates_at
   use rwmf_model_hysteresis_bouc_wen, only: stable_rate, will_pass_zero
   use rwmf_model_lanes, only: power_count
   use rwmf_motion_ground_motion, only: interval_end, is_piecewise_linear
   use rwmf_simulation_events_drift_events, only: is_uncut
   use rwmf_simulation_events_lift_off_events, only: stays_down
   use rwmf_simulation_events_step_events, only: list_turns
   use rwmf_simulation_events_step_quartic, only: at_high, at_low, at_turn, cross_window, &
      cubic_of, first_event, no_event, place_event, quartic_of, quartic_t, quintic_of
   use rwmf_simulation_events_step_view, only: step_view_t, until, view_step
   use rwmf_simulation_free_vibration, only: long_rest
   use rwmf_simulation_hybrid_loop, only: begin_step, check_work, end_step, &
      may_stand_on_fuses, stands_on_fuses, stay_at_rest
   use rwmf_simulation_hybrid_state, only: check_creep, check_progress, has_ended, hybrid_t, &
      mode_held, mode_rest, mode_rocking, most_creeping, progress_t
   use rwmf_simulation_lanes_reaction_screen, only: begin_reactions, note_extremes, &
      screen_reactions
   use rwmf_simulation_lanes_batch, only: batch_t, create_batch, find_steps_to_inspect, &
      first_acceleration, follow_curves, follow_interval, lane_state_t, line_row, longest_step, &
      may_shorten, turns_in_step
   use rwmf_simulation_recorder_energy_balance, only: add_work
   use rwmf_simulation_recorder_recorder, only: observe_piece, recorder_t
   use rwmf_simulation_result, only: event_branch, event_impact, event_overturned, event_passage, &
      event_peak
   use rwmf_simulation_transitions, only: apply_event, observe_peak
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: advance_lane, join_batch, step_batch

   integer, parameter :: at_state = 3
   !! event in addition to those of the rotation: a further state leaves its window

contains

   !> Integrate a single run up to t_target, overturning or collapse.
   subroutine advance_lane(hybrid, equation, integrator, recorder, t_target, control, batch, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      type(explicit_pair_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout), target :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(control_t), intent(in) :: control
      type(batch_t), intent(inout), target :: batch
      !! batch of one lane; created here if necessary
      type(error_t), allocatable, intent(out) :: error
      !! as `advance`
      type(lane_state_t), target :: lanes(1)

      if (.not. allocated(batch%room)) call create_batch(equation, integrator%pair, &
         hybrid%max_steps, 1, batch)
      lanes(1)%hybrid => hybrid
      lanes(1)%equation => equation
      lanes(1)%integrator => integrator
      lanes(1)%recorder => recorder
      lanes(1)%t_end = t_target
      batch%has_curves = .not. is_piecewise_linear(equation%motion)
      batch%keeps_more = .true.
      call join_batch(lanes(1), 1, batch)
      do while (batch%table(1, of_length) > 0)
         call step_batch(lanes, batch)
         equation%rhs_evaluations = equation%rhs_evaluations + batch%pair%stages
         if (.not. is_cancelled(control)) cycle
         if (batch%table(1, of_length) > 0) call catch_up(lanes(1), 1, batch)
         call check_work(hybrid, integrator, control, lanes(1)%error)
         exit
      end do
      call move_alloc(lanes(1)%error, error)
   end subroutine advance_lane

   !> Add a lane with a new run, or with the next part of a run, to the batch.
   subroutine join_batch(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      batch%is_busy(i) = .true.
      if (.not. allocated(lane%error)) then
         lane%hybrid%progress = progress_t()
         associate (tolerance => lane%integrator%tolerance)
            batch%tolerance(i, :) = step_tolerance(batch%pair, tolerance%rtol)/tolerance%rtol &
               *[tolerance%rtol, tolerance%atol]
         end associate
         if (lane%recorder%keeps_energy .and. .not. allocated(batch%work)) allocate ( &
            batch%work(batch%width, power_count))
         batch%table(i, of_longest) = longest_step(lane%equation)
         batch%table(i, of_interval) = -1
      end if
      call enter_batch(lane, i, batch)
   end subroutine join_batch

   !> Prepare a lane for a common step. If its run is over, its step length remains 0.
   subroutine enter_batch(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      type(control_t) :: no_control
      real(wp) :: t_limit, span

      batch%table(i, of_length) = 0
      associate (hybrid => lane%hybrid, equation => lane%equation, t_end => lane%t_end)
         do
            if (allocated(lane%error)) return
            if (hybrid%t >= t_end .or. has_ended(hybrid) .or. hybrid%is_stopped) return
            call check_work(hybrid, lane%integrator, no_control, lane%error)
            if (allocated(lane%error)) return
            if (hybrid%mode == mode_rest) then
               call stay_at_rest(hybrid, equation, lane%recorder, t_end, lane%error)
               cycle
            end if
            call begin_step(hybrid, equation, lane%recorder, lane%integrator%steps, t_end, &
               t_limit, span, lane%error)
            if (t_limit > hybrid%t) exit
         end do
      end associate
      call load_lane(lane, i, t_limit, span, batch)
   end subroutine enter_batch

   !> Load the state of a lane into the table of its batch.
   subroutine load_lane(lane, i, t_limit, span, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: t_limit, span
      type(batch_t), intent(inout) :: batch
      integer :: j

      associate (hybrid => lane%hybrid, equation => lane%equation, table => batch%table)
         if (hybrid%must_restart) then
            if (lane%integrator%h > 0) then
               lane%integrator%h = min(lane%integrator%h, span)
            else
               call begin_at(lane%integrator, hybrid%t, hybrid%y, span, lane%error)
               if (allocated(lane%error)) return
            end if
         end if
         hybrid%must_restart = .false.
         do j = 1, equation%n
            batch%y(i, j) = hybrid%y(j)
         end do
         do j = 1, equation%scene%n_coef
            batch%coef(i, j) = equation%state%coef(1, j)
         end do
         table(i, of_steps) = real(lane%integrator%steps, wp)
         batch%steps_left = min(batch%steps_left, batch%max_steps - table(i, of_steps), &
            real(most_creeping, wp))
         table(i, of_time) = hybrid%t
         table(i, of_fastest) = lane%recorder%theta_dot_ends
         table(i, of_rejected) = 0
         table(i, of_max_rate) = 0
         if (equation%has_loading_direction) table(i, of_max_rate) = stable_rate(equation)
         table(i, of_length) = min(lane%integrator%h, table(i, of_longest), &
            1/max(tiny(span), table(i, of_max_rate)*abs(hybrid%y(2))))
         lane%is_held = hybrid%mode == mode_held
         lane%has_limits = equation%floors%yields .or. hybrid%drifts > 0 .or. lane%is_held &
            .or. may_stand_on_fuses(equation)
         batch%has_limits = batch%has_limits .or. lane%has_limits
         lane%is_smooth = .true.
         lane%target_event = no_event
         table(i, of_target) = 0
         table(i, of_inspection) = merge(0, 1, lane%is_smooth)
      end associate
      call load_window(lane, i, batch)
      call load_line(lane, i, t_limit, batch)
      call begin_reactions(lane, i, batch)
      ! under an extremely strong motion, no first step is short enough
      if (.not. batch%table(i, of_length) > 0) call check_length(lane, i, batch)
   end subroutine load_lane

   !> Set the window of states without an event.
   subroutine load_window(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      associate (hybrid => lane%hybrid, equation => lane%equation, table => batch%table, &
                 recorder => lane%recorder)
         table(i, of_least) = -huge(1.0_wp)
         table(i, of_most) = huge(1.0_wp)
         if (equation%has_loading_direction) then
            ! on unloading, the hysteretic force passes zero
            if (will_pass_zero(equation)) table(i, merge(of_most, of_least, &
               equation%state%signs%loading_direction > 0)) = 0
         end if
         table(i, of_low) = merge(-hybrid%overturning_angle, -huge(1.0_wp), equation%has_wall)
         table(i, of_high) = -table(i, of_low)
         if (hybrid%mode == mode_rocking) table(i, merge(of_low, of_high, &
            equation%state%side > 0)) = 0
         table(i, of_low) = max(table(i, of_low), equation%state%low)
         table(i, of_high) = min(table(i, of_high), equation%state%high)
         table(i, of_bottom) = merge(huge(1.0_wp), recorder%theta_min, equation%state%ends_at_peak)
         table(i, of_top) = merge(-huge(1.0_wp), recorder%theta_max, equation%state%ends_at_peak)
         if (lane%is_held) then
            table(i, [of_low, of_bottom, of_least]) = -huge(1.0_wp)
            table(i, [of_high, of_top, of_most]) = huge(1.0_wp)
         end if
      end associate
   end subroutine load_window

   !> Load the current interval of the motion.
   subroutine load_line(lane, i, t_limit, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: t_limit
      type(batch_t), intent(inout) :: batch
      integer :: interval

      interval = interval_of(lane%equation)
      ! in most cases an event has changed the motion inside an interval
      if (interval == int(batch%table(i, of_interval)) &
          .and. abs(t_limit - batch%table(i, of_limit)) <= 0) return
      batch%table(i, of_interval) = interval
      associate (row => line_row(t_limit, lane%equation%state%line, &
                                 lane%equation%state%vertical_line))
         batch%table(i, of_limit) = row(1)
         batch%table(i, of_line) = row(2)
         batch%table(i, of_line + 1) = row(3)
         batch%table(i, of_line + 2) = row(4)
         batch%table(i, of_vertical_line) = row(5)
         batch%table(i, of_vertical_line + 1) = row(6)
      end associate
   end subroutine load_line

   !> Take one step of all lanes and apply its events.
   subroutine step_batch(lanes, batch)
      type(lane_state_t), intent(inout), target :: lanes(:)
      type(batch_t), intent(inout) :: batch
      integer :: i

      associate (scene => lanes(1)%equation%scene, n => lanes(1)%equation%n, &
                 intervals => ubound(batch%lines, 2) - 1, trial => batch%table(:, of_trial))
         if (batch%width == 1) then
            call plan_one(batch%pair, batch%table, batch%ground)
            call follow_curves(lanes, batch)
            call attempt_one(scene, batch%pair, batch%coef, batch%ground, trial, batch%tolerance, &
               batch%y, .false., batch%k, batch%y_new, batch%error, batch%work)
            call ask_limits(lanes, batch)
            if (batch%keeps_more) call choose_steps(lanes, batch)
            call accept_or_reject_one(n, further_state(lanes(1)%equation), batch%table, batch%y, &
               batch%k, batch%y_new, batch%error, batch%mark)
            if (batch%keeps_more .or. allocated(batch%work)) call observe_steps(lanes, batch)
            call pass_one(intervals, batch%lines, batch%table, batch%mark)
         else
            call batch%kernels%plan_step(batch%pair, batch%table, batch%ground)
            call follow_curves(lanes, batch)
            call batch%kernels%attempt_step(scene, batch%pair, batch%coef, batch%ground, trial, &
               batch%tolerance, batch%y, .false., batch%k, batch%y_new, batch%error, batch%work)
            call ask_limits(lanes, batch)
            if (batch%keeps_more) call choose_steps(lanes, batch)
            call batch%kernels%accept_or_reject(n, further_state(lanes(1)%equation), batch%table, &
               batch%y, batch%k, batch%y_new, batch%error, batch%mark)
            if (batch%keeps_more .or. allocated(batch%work)) call observe_steps(lanes, batch)
            call batch%kernels%advance_intervals(intervals, batch%lines, batch%table, batch%mark)
         end if
      end associate
      do i = 1, batch%width
         if (batch%mark(i) == is_done .or. .not. batch%is_busy(i)) cycle
         call check_lane(lanes(i), i, batch)
         select case (batch%mark(i))
         case (needs_inspection)
            ! an event may prevent this in the next step
            if (batch%table(i, of_calm) < 1) batch%is_watched(i) = .true.
            if (.not. lanes(i)%is_smooth) then
               call inspect_step(lanes(i), i, batch)
            else if (lanes(i)%target_event /= no_event) then
               call converge_to_event(lanes(i), i, batch)
            else
               call find_event(lanes(i), i, batch)
            end if
         case (at_limit)
            call pass_limit(lanes(i), i, batch)
         case (is_rejected)
            call forget_target(lanes(i), i, batch)
            call check_length(lanes(i), i, batch)
         case default
            ! `is_done`, see above
         end select
         batch%has_ended = batch%has_ended .or. .not. batch%table(i, of_length) > 0
      end do
      batch%steps_left = batch%steps_left - 1
      if (batch%steps_left < 0) then
         do i = 1, batch%width
            if (batch%is_busy(i)) call bound_work(lanes(i), i, batch)
         end do
         batch%steps_left = min(batch%max_steps - maxval(batch%table(:, of_steps), &
            batch%is_busy), real(most_creeping, wp))
         batch%has_ended = .true.
      end if
   end subroutine step_batch

   !> Find the steps that are smooth although their lanes have limits.
   subroutine ask_limits(lanes, batch)
      type(lane_state_t), intent(inout), target :: lanes(:)
      type(batch_t), intent(inout), target :: batch
      type(step_view_t) :: step
      real(wp), dimension(lanes(1)%equation%n), target :: y_a, y_b
      integer :: i

      if (.not. batch%has_limits) return
      batch%has_limits = .false.
      do i = 1, batch%width
         if (.not. (batch%is_busy(i) .and. lanes(i)%has_limits)) cycle
         batch%has_limits = .true.
         call follow_interval(lanes(i), i, batch)
         y_a = batch%y(i, :)
         y_b = batch%y_new(i, :)
         step%equation => lanes(i)%equation
         step%t_a = batch%table(i, of_time)
         step%t_b = step%t_a + batch%table(i, of_trial)
         step%y_a => y_a
         step%y_b => y_b
         lanes(i)%is_smooth = is_uncut(step, lanes(i)%hybrid%drifts)
         if (lanes(i)%is_smooth .and. lanes(i)%is_held) then
            ! the last stage approximates the rates at the end
            lanes(i)%is_smooth = stays_down(step, batch%k(i, :, 1), &
               batch%k(i, :, batch%pair%stages))
         else if (lanes(i)%is_smooth) then
            ! a step beyond the base ends with an impact
            associate (equation => lanes(i)%equation)
               if (may_stand_on_fuses(equation)) lanes(i)%is_smooth = .not. stands_on_fuses( &
                  equation, equation%state%side*max(0.0_wp, equation%state%side*y_b(1)))
            end associate
         end if
         batch%table(i, of_inspection) = merge(0, 1, lanes(i)%is_smooth &
            .and. lanes(i)%target_event == no_event)
      end do
   end subroutine ask_limits

   !> Select the steps that the requested outputs need.
   subroutine choose_steps(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch

      call screen_reactions(lanes, batch)
      call find_steps_to_inspect(lanes, batch)
   end subroutine choose_steps

   !> Record the requested outputs over the accepted steps.
   subroutine observe_steps(lanes, batch)
      type(lane_state_t), intent(inout), target :: lanes(:)
      type(batch_t), intent(inout) :: batch
      real(wp) :: work(power_count)
      integer :: i

      do i = 1, batch%width
         if (batch%mark(i) /= at_limit .and. batch%mark(i) /= is_done) cycle
         ! the next step includes a quantity that increases up to the end of this one
         if (batch%table(i, of_calm) > 0) batch%table(i, of_calm) = 1
         if (batch%is_watched(i)) then
            call observe_step(lanes(i), i, batch, batch%t_before(i), batch%y_before(i, :), &
               batch%table(i, of_time), batch%y_new(i, :))
            batch%has_ended = batch%has_ended .or. allocated(lanes(i)%error)
         else if (batch%is_busy(i) .and. allocated(batch%work)) then
            work = batch%work(i, :)
            call add_work(lanes(i)%recorder%energy, work)
         end if
      end do
   end subroutine observe_steps

   !> Record the requested outputs over an accepted step, or over its part before an event. If no
   !> output needs this step, accumulate only its work.
   subroutine pass_step(lane, i, batch, t, y)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in), contiguous, target :: y(:)
      !! (states) at t
      real(wp) :: work(power_count)

      if (batch%is_watched(i)) then
         call observe_step(lane, i, batch, batch%table(i, of_time), batch%y(i, :), t, y)
      else
         call follow_interval(lane, i, batch)
         work = batch%work(i, :)
         call extend_work(lane%equation, batch%table(i, of_time) + batch%table(i, of_trial), &
            batch%y_new(i, :), t, y, work)
         call add_work(lane%recorder%energy, work)
      end if
   end subroutine pass_step

   !> Record the requested outputs over a step of a lane, or over a part of it.
   subroutine observe_step(lane, i, batch, t_a, y_a, t_b, y_b)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: y_a(:)
      !! (states)
      real(wp), intent(in) :: t_b
      !! [s]
      real(wp), intent(in), contiguous, target :: y_b(:)
      !! (states)
      type(step_view_t) :: step

      if (allocated(lane%error)) return
      call follow_interval(lane, i, batch)
      associate (integrator => lane%integrator)
         integrator%t0 = t_a
         integrator%y0(:) = y_a
         integrator%f0(:) = batch%k(i, :, 1)
         integrator%t1 = t_a + batch%table(i, of_trial)
         integrator%y1(:) = batch%y_new(i, :)
         if (allocated(batch%work)) integrator%work = batch%work(i, :)
         integrator%t_work = integrator%t1
         call view_step(step, lane%equation, integrator)
      end associate
      step = until(step, t_b, y_b)
      if (lane%recorder%keeps_events) call list_turns(lane%recorder, step, lane%error)
      if (.not. allocated(lane%error)) call observe_piece(lane%recorder, step, lane%error, &
         batch%table(i, of_plain) > 0, batch%table(i, of_calm) > 0.75_wp)
      call note_extremes(lane, i, batch)
      if (allocated(lane%error)) batch%table(i, of_length) = 0
   end subroutine observe_step

   !> Check the number of steps of one run in the batch.
   subroutine bound_work(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      type(control_t) :: no_control
      type(error_t), allocatable :: error

      call check_creep(lane%hybrid%creep, int(batch%table(i, of_steps), i8), &
         batch%table(i, of_time), error)
      if (batch%table(i, of_steps) <= batch%max_steps .and. .not. allocated(error)) return
      call catch_up(lane, i, batch)
      if (.not. allocated(error)) call check_work(lane%hybrid, lane%integrator, no_control, error)
      call move_alloc(error, lane%error)
      batch%table(i, of_length) = 0
   end subroutine bound_work

   !> Update the run of a lane with its progress in the batch.
   subroutine catch_up(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(in) :: batch

      lane%integrator%steps = int(batch%table(i, of_steps), i8)
      lane%hybrid%t = batch%table(i, of_time)
      lane%recorder%theta_dot_ends = batch%table(i, of_fastest)
      call follow_interval(lane, i, batch)
   end subroutine catch_up

   !> Fail if round-off holds a lane at nearly the same time.
   subroutine check_lane(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      call check_progress(lane%hybrid%progress, size(lane%hybrid%y), batch%table(i, of_time), &
         lane%error)
      if (.not. allocated(lane%error)) return
      call catch_up(lane, i, batch)
      batch%table(i, of_length) = 0
      batch%mark(i) = is_done
   end subroutine check_lane

   !> Fail if a step is below the resolution of the time.
   subroutine check_length(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      if (batch%table(i, of_length) > 8*spacing(batch%table(i, of_time))) return
      call catch_up(lane, i, batch)
      batch%table(i, of_length) = 0
      call fail(lane%error, err_numerical, step_too_small//'; t = ' &
         //trim(real_to_text(batch%table(i, of_time)))//' s')
   end subroutine check_length

   !> Continue a lane at a knot of the motion, or at its end, without an event.
   subroutine pass_limit(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      real(wp) :: t_limit, span

      call catch_up(lane, i, batch)
      associate (hybrid => lane%hybrid, equation => lane%equation)
         if (hybrid%t < lane%t_end &
             .and. hybrid%t >= interval_end(equation%motion, interval_of(equation))) then
            call enter_interval(equation%model_t, equation%state, interval_of(equation) + 1)
            t_limit = min(lane%t_end, interval_end(equation%motion, interval_of(equation)))
            span = t_limit - hybrid%t
            if (span > 16*epsilon(t_limit)*t_limit .and. span <= long_rest) then
               call load_line(lane, i, t_limit, batch)
               return
            end if
         end if
      end associate
      lane%integrator%h = batch%table(i, of_length)
      lane%hybrid%y(:) = batch%y(i, :)
      call enter_batch(lane, i, batch)
   end subroutine pass_limit

   !> Find the first event in the step of a lane by its quartic; without one, accept the step.
   subroutine find_event(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      type(quartic_t) :: quartic
      integer :: turns
      real(wp) :: x
      logical :: is_beyond

      associate (table => batch%table, y => batch%y, y_new => batch%y_new)
         quartic = quartic_of(table(i, of_trial), [y(i, 1), y_new(i, 1)], [y(i, 2), y_new(i, 2)], &
            first_acceleration(batch, i))
         turns = turns_in_step(batch, i)
         x = 0
         if (turns == no_change .and. may_shorten(lane, batch)) call cross_window( &
            table(i, of_trial)*[y(i, 2), y_new(i, 2)], y_new(i, 1) - y(i, 1), &
            [table(i, of_low), table(i, of_high)] - y(i, 1), lane%target_event, x)
         if (.not. (x > 0 .and. x <= 1)) call first_event(quartic, [table(i, of_low), &
            table(i, of_high)], [table(i, of_bottom), table(i, of_top)], lane%target_event, x)
         call compare_with_further(lane, i, batch, x)
         ! by round-off, a motion may turn beyond the limit of the branch that begins there
         is_beyond = (lane%target_event == at_high .and. y(i, 1) > table(i, of_high)) &
            .or. (lane%target_event == at_low .and. y(i, 1) < table(i, of_low))
         if (is_beyond) is_beyond = event_at_level(lane, table(i, merge(of_low, of_high, &
            lane%target_event == at_low))) == event_branch
         if (is_beyond .or. is_against_loading(lane, i, batch) .or. turns == unclear) then
            lane%target_event = no_event
            call inspect_step(lane, i, batch)
            return
         else if (lane%target_event == no_event) then
            call accept_step(lane, i, batch)
            return
         end if
         if (abs(lane%target_event) == 1 .and. lane%target_event*y(i, 2) > 0 &
             .and. x*table(i, of_trial) <= 4*epsilon(x)*table(i, of_time)) then
            ! within round-off of the time, a branch may end where the next one or the base begins
            call catch_up(lane, i, batch)
            call happen(lane, i, (table(i, of_time)), (y(i, :)), batch)
            return
         end if
         x = sharpened(lane, i, quartic, x, batch)
         lane%seen_within = table(i, of_trial)
         lane%trials = 0
         table(i, of_target) = max(x*table(i, of_trial), 4*epsilon(x)*table(i, of_time))
         table(i, of_inspection) = 1
      end associate
   end subroutine find_event

   !> Refine the time of an event with the rates at the end of the step.
   !>
   !> The last stage approximates these rates. The refinement uses the quintic of the rotation or
   !> the cubic of the further state.
   pure real(wp) function sharpened(lane, i, quartic, x, batch) result(at)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      type(quartic_t), intent(in) :: quartic
      real(wp), intent(in) :: x
      !! position of the event in the quartic [-]
      type(batch_t), intent(in) :: batch
      logical :: is_found

      at = x
      associate (h => batch%table(i, of_trial), last => batch%pair%stages, &
                 z => further_state(lane%equation))
         if (lane%target_event == at_state) then
            call place_event(cubic_of([batch%y(i, z), batch%y_new(i, z)], [h*batch%k(i, z, 1), &
               h*batch%k(i, z, last)]), at_high, 0.0_wp, at, is_found)
         else
            call place_event(quintic_of(quartic, h**2*batch%k(i, 2, last)), lane%target_event, &
               batch%table(i, merge(of_low, of_high, lane%target_event == at_low)), at, is_found)
         end if
      end associate
      if (.not. is_found) at = x
   end function sharpened

   !> True if a frame with smooth hysteresis moves against its loading direction, as from rest.
   pure logical function is_against_loading(lane, i, batch) result(is_against)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(in) :: batch

      is_against = .false.
      if (.not. lane%equation%has_loading_direction) return
      associate (direction => lane%equation%state%signs%loading_direction)
         is_against = direction*batch%y(i, 2) < 0 .or. (abs(batch%y(i, 2)) <= 0 &
            .and. direction*batch%k(i, 2, 1) < 0)
         if (lane%target_event == no_event) is_against = is_against .or. direction &
            *batch%y_new(i, 2) < 0
      end associate
   end function is_against_loading

   !> Find an earlier exit of the further state from its window, by the parabola through its ends
   !> and first rate.
   !>
   !> Without previous yielding, an exit at the time of an impact is the impact.
   subroutine compare_with_further(lane, i, batch, x)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(in) :: batch
      real(wp), intent(inout) :: x
      !! position of the event found in the step [-]
      real(wp), parameter :: same = 1.0e-3_wp
      real(wp) :: z, rise, bend, root, at

      associate (table => batch%table, further => further_state(lane%equation))
         z = batch%y_new(i, further)
         if (z >= table(i, of_least) .and. z <= table(i, of_most)) return
         rise = table(i, of_trial)*batch%k(i, further, 1)
         bend = z - batch%y(i, further) - rise
         root = max(0.0_wp, rise**2 - 4*bend*batch%y(i, further))
         at = 1
         if (abs(rise) + sqrt(root) > 0) at = abs(2*batch%y(i, further))/(abs(rise) + sqrt(root))
         if (lane%target_event /= no_event .and. at > x - same) return
         lane%target_event = at_state
         x = min(1.0_wp, at)
      end associate
   end subroutine compare_with_further

   !> Index of the further state whose window ends a piece; 1 without smooth hysteresis.
   pure integer function further_state(equation)
      type(equation_t), intent(in) :: equation

      further_state = 1
      if (equation%has_loading_direction) further_state = equation%hysteresis%place
   end function further_state

   !> Clear the target event of a lane.
   subroutine forget_target(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      lane%target_event = no_event
      batch%table(i, of_target) = 0
      batch%table(i, of_inspection) = merge(0, 1, lane%is_smooth)
   end subroutine forget_target

   !> Accept the step of a lane without an event.
   subroutine accept_step(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      call forget_target(lane, i, batch)
      associate (table => batch%table)
         table(i, of_fastest) = max(table(i, of_fastest), abs(batch%y_new(i, 2)))
         if (batch%is_watched(i) .or. allocated(batch%work)) call pass_step(lane, i, batch, &
            table(i, of_time) + table(i, of_trial), batch%y_new(i, :))
         if (allocated(lane%error)) return
         ! the next step begins at the end of this one
         batch%mark(i) = is_done
         batch%y(i, :) = batch%y_new(i, :)
         table(i, of_steps) = table(i, of_steps) + 1
         if (table(i, of_trial) >= table(i, of_limit) - table(i, of_time)) then
            table(i, of_time) = table(i, of_limit)
            call pass_limit(lane, i, batch)
         else
            table(i, of_time) = table(i, of_time) + table(i, of_trial)
            call bound_work(lane, i, batch)
         end if
      end associate
   end subroutine accept_step

   !> Converge to the expected event, by Newton's method or by another trial step.
   subroutine converge_to_event(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch
      integer, parameter :: most_trials = 6
      real(wp) :: short
      !! fraction of the step for which a Taylor series is accurate [-]
      real(wp), dimension(lane%equation%n) :: y, rates
      real(wp) :: t, rest
      integer :: j

      call catch_up(lane, i, batch)
      associate (table => batch%table, h => batch%table(i, of_trial))
         t = table(i, of_time) + h
         do j = 1, lane%equation%n
            y(j) = batch%y_new(i, j)
            rates(j) = batch%k(i, j, batch%pair%stages)
         end do
         if (.not. last_stage_suffices(lane, i, y, rates, batch)) then
            call rates_at(lane%equation, t, y, rates)
            if (lane%equation%has_loading_direction) call choose_first(lane, i, rates, batch)
            if (lane%target_event == at_turn &
                .and. (y(1) < table(i, of_low) .or. y(1) > table(i, of_high))) then
               ! an end of the window is the earlier event, unless the step begins there
               if (batch%y(i, 1) > table(i, of_low) .and. batch%y(i, 1) < table(i, of_high)) then
                  call find_event(lane, i, batch)
               else
                  call inspect_step(lane, i, batch)
               end if
               return
            end if
         end if
         rest = time_to_event(lane, i, y, rates, batch)
         short = min(0.1_wp*sqrt(lane%integrator%tolerance%rtol), merge(1.0e-4_wp, 1.0e-5_wp, &
            lane%equation%n == 2))
         if (abs(rest) <= max(short*h, 2*epsilon(t)*t)) then
            ! interpolate the rates by the cubic through both ends
            do j = 1, lane%equation%n
               y(j) = y(j) + rest*(rates(j) + rest/h*(3*(batch%y(i, j) - y(j))/h &
                  + batch%k(i, j, 1) + 2*rates(j)))
            end do
            call happen(lane, i, t + rest, y, batch)
            return
         end if
         lane%trials = lane%trials + 1
         if (rest > 0 .and. h >= table(i, of_limit) - table(i, of_time)) then
            ! the event lies after the knot
            call accept_step(lane, i, batch)
         else if (lane%trials > most_trials .or. .not. h + rest > 4*epsilon(t)*t &
                  .or. .not. abs(rest) < table(i, of_length) .or. h + rest > lane%seen_within) then
            ! If Newton returns to the start of the step, it has found the previous event: search
            ! the step. If it leaves the step that showed the event, the turn is round-off of a
            ! decayed motion.
            call inspect_step(lane, i, batch)
         else
            table(i, of_target) = min(h + rest, table(i, of_limit) - table(i, of_time))
         end if
      end associate
   end subroutine converge_to_event

   !> Return whether the last stage of a step is accurate enough as its rates at an end of the
   !> window.
   !>
   !> Only outputs of peaks use it. The velocity at the event then changes by at most a few times
   !> the tolerance, and the error of the last stage is a small part of this change.
   pure logical function last_stage_suffices(lane, i, y, rates, batch) result(suffices)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: y(:), rates(:)
      !! (states) at the end of the step; rates of the last stage
      type(batch_t), intent(in) :: batch
      real(wp), parameter :: few = 10

      suffices = may_shorten(lane, batch) .and. abs(lane%target_event) == 1
      if (suffices) suffices = abs(time_to_event(lane, i, y, rates, batch)*rates(2)) &
         <= few*lane%integrator%tolerance%rtol*abs(y(2))
   end function last_stage_suffices

   !> Time from the end of the step to the target event, by one step of Newton's method [s].
   pure real(wp) function time_to_event(lane, i, y, rates, batch) result(rest)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: y(:), rates(:)
      !! (states) at the end of the step, and their rates
      type(batch_t), intent(in) :: batch

      if (lane%target_event == at_turn) then
         rest = -y(2)/rates(2)
      else if (lane%target_event == at_state) then
         associate (further => further_state(lane%equation))
            rest = -y(further)/rates(further)
         end associate
      else
         rest = (batch%table(i, merge(of_low, of_high, lane%target_event == at_low)) - y(1))/y(2)
      end if
   end function time_to_event

   !> Select an earlier event if one precedes the target: an end of the rotation's window, or of the
   !> further state's window.
   subroutine choose_first(lane, i, rates, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: rates(:)
      !! (states) rates at the end of the step
      type(batch_t), intent(in) :: batch
      real(wp), parameter :: slack = 1.0e-12_wp
      !! tolerance of the further state [-]
      integer :: level
      real(wp) :: z

      associate (table => batch%table, theta => batch%y_new(i, 1), theta_dot => batch%y_new(i, 2), &
                 further => further_state(lane%equation))
         level = merge(at_low, merge(at_high, no_event, theta > table(i, of_high)), &
            theta < table(i, of_low))
         z = batch%y_new(i, further)
         if (level == no_event) then
            if (max(table(i, of_least) - z, z - table(i, of_most)) > slack) then
               lane%target_event = at_state
            end if
         else if (lane%target_event /= at_turn) then
            ! further state at the time at which the rotation leaves its window
            z = z + rates(further)*(table(i, merge(of_low, of_high, level == at_low)) - theta) &
               /theta_dot
            lane%target_event = merge(at_state, level, max(table(i, of_least) - z, z &
               - table(i, of_most)) &
               > slack)
         end if
      end associate
   end subroutine choose_first

   !> Apply the event that a lane has reached.
   subroutine happen(lane, i, t, y, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) approximately at t
      type(batch_t), intent(inout) :: batch
      integer :: event

      associate (hybrid => lane%hybrid, equation => lane%equation, table => batch%table)
         hybrid%t = min(t, table(i, of_limit))
         hybrid%y(:) = y
         event = event_peak
         if (lane%target_event == at_turn) then
            hybrid%y(2) = 0
         else if (lane%target_event == at_state) then
            hybrid%y(further_state(equation)) = 0
            event = event_passage
         else
            hybrid%y(1) = table(i, merge(of_low, of_high, lane%target_event == at_low))
            event = event_at_level(lane, hybrid%y(1))
         end if
         hybrid%is_rising = lane%target_event == at_high
         lane%integrator%steps = lane%integrator%steps + 1_i8
         lane%integrator%h = table(i, of_length)
         if ((batch%is_watched(i) .or. allocated(batch%work)) .and. hybrid%t &
             > table(i, of_time)) then
            call pass_step(lane, i, batch, hybrid%t, hybrid%y)
         end if
         lane%recorder%theta_dot_ends = max(table(i, of_fastest), abs(hybrid%y(2)))
         if (event == event_peak) then
            call observe_peak(hybrid, equation, lane%recorder, (batch%y(i, 2)), hybrid%t, hybrid%y)
         end if
         if (allocated(lane%error)) return
         if (event /= event_peak .or. equation%state%ends_at_peak) call apply_event(hybrid, &
            equation, lane%recorder, event, lane%error)
      end associate
      call enter_batch(lane, i, batch)
   end subroutine happen

   !> Type of event at an end of the window.
   pure integer function event_at_level(lane, level) result(event)
      type(lane_state_t), intent(in) :: lane
      real(wp), intent(in) :: level
      !! [rad]

      event = event_overturned
      if (lane%hybrid%mode == mode_rocking .and. abs(level) <= 0) event = event_impact
      if (abs(level - merge(lane%equation%state%high, lane%equation%state%low, &
         lane%target_event == at_high)) <= 0) then
         event = event_branch
      end if
   end function event_at_level

   !> Inspect the step of one lane as in a single run.
   subroutine inspect_step(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      type(batch_t), intent(inout) :: batch

      call catch_up(lane, i, batch)
      associate (step => lane%integrator)
         step%steps = step%steps + 1_i8
         step%h = batch%table(i, of_length)
         step%t0 = batch%table(i, of_time)
         step%y0(:) = batch%y(i, :)
         step%f0(:) = batch%k(i, :, 1)
         step%t1 = step%t0 + batch%table(i, of_trial)
         if (batch%table(i, of_trial) >= batch%table(i, of_limit) - step%t0) step%t1 = &
            batch%table(i, of_limit)
         step%y1(:) = batch%y_new(i, :)
         if (allocated(batch%work)) step%work = batch%work(i, :)
         step%t_work = step%t1
      end associate
      call end_step(lane%hybrid, lane%equation, lane%integrator, lane%recorder, lane%error)
      if (allocated(lane%error)) then
         batch%table(i, of_length) = 0
      else
         call enter_batch(lane, i, batch)
      end if
   end subroutine inspect_step

end module rwmf_simulation_lanes_loop
