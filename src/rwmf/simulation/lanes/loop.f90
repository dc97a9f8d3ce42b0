!> Common steps of a batch of lanes.
!>
!> The lanes of a batch step together. No number of a lane depends on the other lanes: a single run
!> is a batch of one lane.
module rwmf_simulation_lanes_loop
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_lane_columns, only: at_limit, is_done, is_rejected, needs_inspection, &
      of_calm, of_length, of_steps, of_time, of_trial
   use rwmf_integrator_lane_control, only: accept_or_reject_one => accept_or_reject, &
      pass_one => advance_intervals, plan_one => plan_step
   use rwmf_integrator_lane_step, only: attempt_one => attempt_step
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_motion_ground_motion, only: is_piecewise_linear
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_hybrid_hybrid_loop, only: check_steps
   use rwmf_simulation_lanes_batch, only: batch_t, create_batch, follow_curves, &
      lane_state_t
   use rwmf_simulation_lanes_lane_events, only: converge_to_event, find_event, inspect_step, &
      pass_limit
   use rwmf_simulation_lanes_lane_loading, only: bound_work, catch_up, check_length, &
      forget_target, further_state, join_batch
   use rwmf_simulation_lanes_lane_outputs, only: choose_steps, observe_steps
   use rwmf_simulation_lanes_lane_limits, only: inspect_limits
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_state_hybrid_state, only: check_progress, hybrid_t, most_creeping
   implicit none
   private

   public :: advance_lane, step_batch

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
         call check_steps(hybrid, integrator, control, lanes(1)%error)
         exit
      end do
      call move_alloc(lanes(1)%error, error)
   end subroutine advance_lane

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
            if (batch%has_limits) call inspect_limits(lanes, batch)
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
            if (batch%has_limits) call inspect_limits(lanes, batch)
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

end module rwmf_simulation_lanes_loop
