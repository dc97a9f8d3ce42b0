!> Common steps of a series batch and the events in them.
!>
!> Loops over the lanes prove that a step has no event or one root of phi. The other steps are
!> searched one by one. Impacts after which the wall rocks on stay in the loops; the transitions of
!> the hybrid system apply all other events.
module rwmf_simulation_series_series_events
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_lanes, only: left, right, series_width
   use rwmf_math_polynomial_roots, only: evaluate, first_negative, largest_value
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_hybrid_transitions, only: apply_event
   use rwmf_simulation_lanes_batch, only: lane_state_t
   use rwmf_simulation_series_series_batch, only: series_batch_t
   use rwmf_simulation_series_series_loading, only: check_work, enter_series, &
      leave_series, pass_knots, shorten_steps
   use rwmf_simulation_state_result, only: event_impact, event_overturned
   implicit none
   private

   public :: step_series

contains

   !> Take one step of all lanes and apply its events.
   subroutine step_series(lanes, batch)
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      integer :: i

      call batch%kernels%expand_lanes(batch%lanes)
      call batch%kernels%screen_lanes(batch%lanes)
      if (batch%lanes%some_short) call shorten_steps(lanes, batch)
      if (batch%lanes%some_root) call batch%kernels%find_roots(batch%lanes)
      if (batch%lanes%some_open) then
         do i = 1, series_width
            if (batch%lanes%is_open(i) > 0) call search_step(i, batch)
         end do
      end if
      if (batch%lanes%some_peak) then
         do i = 1, series_width
            if (batch%lanes%may_peak(i) > 0) call find_peak(i, batch)
         end do
      end if
      call batch%kernels%end_steps(batch%lanes)
      if (batch%lanes%needs_some_care) then
         do i = 1, series_width
            if (batch%lanes%needs_care(i) > 0) call apply_rare_event(lanes(i), i, batch)
         end do
      end if
      call pass_knots(lanes, batch)
      batch%steps_left = batch%steps_left - 1
      if (batch%steps_left < 0) call check_work(lanes, batch)
   end subroutine step_series

   !> Find the first event in the step of a lane.
   subroutine search_step(i, batch)
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      real(wp), parameter :: noise = 1.0e-13_wp
      !! part of the terms of the acceleration that is round-off [-]
      real(wp) :: c(0:batch%kernels%order), lower, upper, slope
      integer :: root

      associate (lanes => batch%lanes, n => batch%kernels%order)
         c = lanes%p(i, :n)
         root = nint(lanes%multiplicity(i))
         if (root == 2 .and. abs(c(2)) < noise*lanes%gravity(i)*lanes%h(i)**2) root = 3
         lower = first_negative(c(root:), lanes%x_most(i))
         c = -c
         c(0) = c(0) + lanes%upper(i)
         upper = first_negative(c, lanes%x_most(i))
         lanes%x(i) = min(lower, upper, lanes%x_most(i))
         call evaluate(lanes%p(i, :n), lanes%x(i), lanes%phi_end(i), slope)
         lanes%phi_end(i) = max(lanes%phi_end(i), 0.0_wp)
         lanes%rate_end(i) = slope
         lanes%has_root(i) = 0
         if (upper < lower) then
            lanes%phi_end(i) = lanes%upper(i)
            lanes%needs_care(i) = 1
         else if (lower <= lanes%x_most(i)) then
            lanes%phi_end(i) = 0
            lanes%rate_end(i) = min(slope, 0.0_wp)
            lanes%has_root(i) = 1
         end if
      end associate
   end subroutine search_step

   !> Find the largest rotation in the step of a lane.
   subroutine find_peak(i, batch)
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      integer :: m

      associate (lanes => batch%lanes)
         m = merge(right, left, lanes%side(i) > 0)
         lanes%top(i, m) = max(lanes%top(i, m), largest_value(lanes%p(i, :batch%kernels%order), &
            lanes%x(i)))
      end associate
   end subroutine find_peak

   !> Apply an impact that may end in rest, or overturning.
   subroutine apply_rare_event(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      type(ending_t) :: ending

      call leave_series(lane, i, batch)
      batch%lanes%needs_care(i) = 0
      batch%lanes%is_at_limit(i) = 0
      ending%kind = merge(event_overturned, event_impact, batch%lanes%phi(i) > 0)
      call apply_event(lane%hybrid, lane%equation, lane%recorder, ending, lane%error)
      call enter_series(lane, i, batch)
   end subroutine apply_rare_event

end module rwmf_simulation_series_series_events
