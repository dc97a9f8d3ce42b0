!> Events in the steps of a batch.
!>
!> A step with a possible event is inspected individually. If the rotation alone does not show all
!> changes, the search of the hybrid loop inspects it.
module rwmf_simulation_lanes_lane_events
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_lane_columns, only: is_done, of_bottom, of_fastest, of_high, of_inspection, &
      of_least, of_length, of_limit, of_low, of_most, of_steps, of_target, of_time, of_top, &
      of_trial
   use rwmf_math_sign_changes, only: no_change, unclear
   use rwmf_model_system_assembly, only: enter_interval, interval_of, rates_at
   use rwmf_motion_ground_motion, only: interval_end
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_step_quartic, only: at_high, at_low, at_turn, &
      cubic_of, first_event, no_event, place_event, quartic_of, quartic_t, quintic_of
   use rwmf_simulation_hybrid_free_vibration, only: long_rest
   use rwmf_simulation_hybrid_hybrid_loop, only: end_step
   use rwmf_simulation_hybrid_transitions, only: apply_event, observe_peak
   use rwmf_simulation_lanes_batch, only: at_storey, batch_t, first_acceleration, lane_state_t, &
      turns_in_step
   use rwmf_simulation_lanes_lane_loading, only: bound_work, catch_up, enter_batch, forget_target, &
      further_state, load_line
   use rwmf_simulation_lanes_lane_outputs, only: pass_step
   use rwmf_simulation_lanes_lane_limits, only: reach_target
   use rwmf_simulation_state_hybrid_state, only: mode_rocking
   use rwmf_simulation_state_result, only: event_branch, event_impact, event_overturned, &
      event_passage, event_peak
   implicit none
   private

   public :: pass_limit, find_event, converge_to_event, inspect_step

   integer, parameter :: at_state = 3
   !! event in addition to those of the rotation: a further state leaves its window
   integer, parameter :: most_trials = 6
   !! largest number of trial steps to an event
   real(wp), parameter :: same = 1.0e-3_wp
   !! distance below which two events of a step may be simultaneous [-]

contains

   !> Continue a lane at a knot of the motion, or at its end, without an event.
   subroutine pass_limit(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
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

   !> Find the first event in the step of a lane; without one, accept the step.
   subroutine find_event(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      type(quartic_t) :: quartic
      real(wp) :: x
      logical :: is_clear

      ! two events at nearly the same time may precede each other in turn
      lane%trials = merge(0, lane%trials + 1, lane%target_event == no_event)
      call find_in_rotation(lane, i, batch, quartic, x, is_clear)
      ! a spring on the rotation may turn at the same instant as a storey: the search of single runs
      ! knows their order
      if (lane%equation%has_bilinear_springs .and. lane%target_event /= no_event) is_clear = &
         is_clear .and. abs(lane%storey%at - x) > same
      if (is_clear .and. lane%storey%at <= merge(1.0_wp, x, lane%target_event == no_event)) then
         lane%target_event = at_storey
         lane%storey%target = lane%storey%first
         lane%storey%is_proven = lane%storey%is_clear
         x = lane%storey%at
      end if
      associate (table => batch%table, y => batch%y)
         if (.not. is_clear .or. lane%trials > most_trials) then
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
         if (lane%target_event /= at_storey) x = sharpened(lane, i, quartic, x, batch)
         lane%seen_within = table(i, of_trial)
         table(i, of_target) = max(x*table(i, of_trial), 4*epsilon(x)*table(i, of_time))
         table(i, of_inspection) = 1
      end associate
   end subroutine find_event

   !> Find the first event of the rotation in the step of a lane by its quartic.
   subroutine find_in_rotation(lane, i, batch, quartic, x, is_clear)
      type(lane_state_t), intent(inout) :: lane
      !! with its target event on return
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      type(quartic_t), intent(out) :: quartic
      real(wp), intent(out) :: x
      !! position of the event [-]
      logical, intent(out) :: is_clear
      !! the quartic shows the first event
      integer :: turns
      logical :: is_beyond

      lane%target_event = no_event
      x = 0
      is_clear = .true.
      if (lane%is_held) return
      associate (table => batch%table, y => batch%y, y_new => batch%y_new)
         quartic = quartic_of(table(i, of_trial), [y(i, 1), y_new(i, 1)], [y(i, 2), y_new(i, 2)], &
            first_acceleration(batch, i))
         turns = turns_in_step(batch, i)
         call first_event(quartic, [table(i, of_low), &
            table(i, of_high)], [table(i, of_bottom), table(i, of_top)], lane%target_event, x)
         call compare_with_further(lane, i, batch, x)
         ! by round-off, a motion may turn beyond the limit of the branch that begins there
         is_beyond = (lane%target_event == at_high .and. y(i, 1) > table(i, of_high)) &
            .or. (lane%target_event == at_low .and. y(i, 1) < table(i, of_low))
         if (is_beyond) is_beyond = event_at_level(lane, table(i, merge(of_low, of_high, &
            lane%target_event == at_low))) == event_branch
         is_clear = .not. (is_beyond .or. is_against_loading(lane, i, batch) .or. turns == unclear)
      end associate
   end subroutine find_in_rotation

   !> Return whether an event of the rotation or of another storey precedes the target of a storey.
   logical function is_preceded(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      type(quartic_t) :: quartic
      real(wp) :: x
      logical :: is_clear

      is_preceded = lane%storey%at <= 1
      if (is_preceded .or. lane%target_event /= at_storey) return
      call find_in_rotation(lane, i, batch, quartic, x, is_clear)
      is_preceded = .not. is_clear .or. lane%target_event /= no_event
      lane%target_event = at_storey
   end function is_preceded

   !> Refine the time of an event with the rates at the end of the step.
   !>
   !> The last stage approximates these rates. The refinement uses the quintic of the rotation or
   !> the cubic of the further state.
   pure real(wp) function sharpened(lane, i, quartic, x, batch) result(at)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
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
      !! number of the lane in the batch
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
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      real(wp), intent(inout) :: x
      !! position of the event found in the step [-]
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

   !> Accept the step of a lane without an event.
   subroutine accept_step(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
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
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      real(wp) :: short
      !! fraction of the step for which a Taylor series is accurate [-]
      real(wp), dimension(lane%equation%n) :: y, rates
      real(wp) :: t, rest
      integer :: j

      if (is_preceded(lane, i, batch)) then
         call find_event(lane, i, batch)
         return
      end if
      call catch_up(lane, i, batch)
      associate (table => batch%table, h => batch%table(i, of_trial))
         t = table(i, of_time) + h
         do j = 1, lane%equation%n
            y(j) = batch%y_new(i, j)
            rates(j) = batch%k(i, j, batch%pair%stages)
         end do
         if (lane%target_event == at_storey) then
            rates = lane%storey%rates
         else
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
         ! time from the end of the step to the target event, by one step of Newton's method [s]
         if (lane%target_event == at_storey) then
            rest = lane%storey%rest
         else if (lane%target_event == at_turn) then
            rest = -y(2)/rates(2)
         else if (lane%target_event == at_state) then
            associate (further => further_state(lane%equation))
               rest = -y(further)/rates(further)
            end associate
         else
            rest = (batch%table(i, merge(of_low, of_high, lane%target_event == at_low)) - y(1))/y(2)
         end if
         short = min(0.1_wp*sqrt(lane%integrator%tolerance%rtol), merge(1.0e-4_wp, 1.0e-5_wp, &
            lane%equation%n == 2))
         if (abs(rest) <= max(short*h, 2*epsilon(t)*t)) then
            call reach_event(lane, i, t, rest, y, rates, batch)
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

   !> Interpolate the states at the event near the end of a step, and apply it.
   subroutine reach_event(lane, i, t, rest, y, rates, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      real(wp), intent(in) :: t
      !! end of the step [s]
      real(wp), intent(inout) :: rest
      !! time from the end of the step to the event; refined on return [s]
      real(wp), intent(inout) :: y(:)
      !! (states) at the end of the step; on return at the event
      real(wp), intent(in) :: rates(:)
      !! (states) at the end of the step
      type(batch_t), intent(inout) :: batch
      integer :: j
      logical :: turns_at
      integer, parameter :: spacings = 8

      if (lane%target_event == at_storey) then
         call reach_target(lane, i, batch, rest, y)
         ! the rotation turns before the end of the step or within round-off of it
         turns_at = batch%y(i, 2)*y(2) < 0 .or. abs(y(2)) <= spacings*spacing(t)*abs(rates(2))
         if (lane%equation%state%ends_at_peak .and. turns_at) then
            call inspect_step(lane, i, batch)
            return
         end if
      else
         ! interpolate the rates by the cubic through both ends
         associate (h => batch%table(i, of_trial))
            do j = 1, lane%equation%n
               y(j) = y(j) + rest*(rates(j) + rest/h*(3*(batch%y(i, j) - y(j))/h &
                  + batch%k(i, j, 1) + 2*rates(j)))
            end do
         end associate
      end if
      call happen(lane, i, t + rest, y, batch)
   end subroutine reach_event

   !> Select an earlier event if one precedes the target: an end of the rotation's window, or of the
   !> further state's window.
   subroutine choose_first(lane, i, rates, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
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
      !! number of the lane in the batch
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) approximately at t
      type(batch_t), intent(inout) :: batch
      type(ending_t) :: ending

      associate (hybrid => lane%hybrid, equation => lane%equation, table => batch%table)
         hybrid%t = min(t, table(i, of_limit))
         hybrid%y(:) = y
         ending%kind = event_peak
         ending%is_rising = lane%target_event == at_high
         if (lane%target_event == at_turn) then
            hybrid%y(2) = 0
         else if (lane%target_event == at_storey) then
            associate (watch => lane%storey%target)
               ending = ending_t(watch%kind, watch%which, hybrid%t, watch%side < 0)
            end associate
         else if (lane%target_event == at_state) then
            hybrid%y(further_state(equation)) = 0
            ending%kind = event_passage
         else
            hybrid%y(1) = table(i, merge(of_low, of_high, lane%target_event == at_low))
            ending%kind = event_at_level(lane, hybrid%y(1))
         end if
         lane%integrator%steps = lane%integrator%steps + 1_i8
         lane%integrator%h = table(i, of_length)
         if ((batch%is_watched(i) .or. allocated(batch%work)) .and. hybrid%t &
             > table(i, of_time)) then
            call pass_step(lane, i, batch, hybrid%t, hybrid%y)
         end if
         lane%recorder%theta_dot_ends = max(table(i, of_fastest), abs(hybrid%y(2)))
         if (ending%kind == event_peak) then
            call observe_peak(hybrid, equation, lane%recorder, (batch%y(i, 2)), hybrid%t, hybrid%y)
         end if
         if (allocated(lane%error)) return
         if (ending%kind /= event_peak .or. equation%state%ends_at_peak) call apply_event(hybrid, &
            equation, lane%recorder, ending, lane%error)
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
      !! number of the lane in the batch
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

end module rwmf_simulation_lanes_lane_events
