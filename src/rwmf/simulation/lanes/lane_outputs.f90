!> Requested outputs over the steps of a batch.
module rwmf_simulation_lanes_lane_outputs
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_explicit_pair, only: extend_work
   use rwmf_integrator_lane_columns, only: at_limit, is_done, of_calm, of_length, of_plain, &
      of_time, of_trial
   use rwmf_model_lanes, only: power_count
   use rwmf_simulation_events_step_view, only: step_view_t, until, view_step
   use rwmf_simulation_hybrid_step_events, only: list_turns
   use rwmf_simulation_lanes_batch, only: batch_t, find_steps_to_inspect, follow_interval, &
      lane_state_t
   use rwmf_simulation_lanes_output_screen, only: note_extremes, screen_outputs
   use rwmf_simulation_recorder_energy_balance, only: add_work
   use rwmf_simulation_recorder_recorder, only: observe_piece
   implicit none
   private

   public :: choose_steps, observe_steps, pass_step

contains

   !> Select the steps that the requested outputs need.
   subroutine choose_steps(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch

      call screen_outputs(lanes, batch)
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
      !! number of the lane in the batch
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
      !! number of the lane in the batch
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

end module rwmf_simulation_lanes_lane_outputs
