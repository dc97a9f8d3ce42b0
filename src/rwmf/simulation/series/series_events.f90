!> Common steps of a series batch and the events in them.
!>
!> Loops over the lanes prove that a step has no event or one root of phi. The other steps are
!> searched one by one. Impacts after which the wall rocks on stay in the loops; the transitions of
!> the hybrid system apply all other events.
module rwmf_simulation_series_series_events
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_lanes, only: left, right, series_width
   use rwmf_math_polynomial_roots, only: evaluate, find_largest, first_negative
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_hybrid_transitions, only: apply_event
   use rwmf_simulation_lanes_batch, only: lane_state_t
   use rwmf_simulation_series_series_batch, only: at_lower, at_turn, at_upper, series_batch_t
   use rwmf_simulation_series_series_demands, only: search_demands
   use rwmf_simulation_series_series_loading, only: check_work, enter_series, &
      leave_series, load_curves, pass_knots, shorten_steps
   use rwmf_simulation_state_result, only: event_branch, event_collapsed, &
      event_impact, event_overturned, event_peak
   implicit none
   private

   public :: step_series

contains

   !> Take one step of all lanes and apply its events.
   subroutine step_series(lanes, batch)
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      integer :: i

      if (batch%lanes%has_curves) call load_curves(lanes, batch)
      call batch%kernels%expand_lanes(batch%lanes)
      call batch%kernels%screen_lanes(batch%lanes)
      if (batch%lanes%some_short) call shorten_steps(lanes, batch)
      if (batch%lanes%some_root) call batch%kernels%find_roots(batch%lanes)
      if (batch%lanes%some_open) then
         do i = 1, series_width
            if (batch%lanes%is_open(i) > 0) call search_step(i, batch)
         end do
      end if
      if (batch%lanes%some_peak .or. batch%lanes%some_speed) call find_peaks(batch)
      if (batch%lanes%some_demand) then
         do i = 1, series_width
            if (batch%lanes%may_exceed(i) > 0) call search_demands(lanes(i), i, batch)
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

   !> Find the largest rotations and velocities in the steps of the lanes.
   subroutine find_peaks(batch)
      type(series_batch_t), intent(inout) :: batch
      real(wp) :: c(batch%kernels%order), largest, place
      integer :: i, k, m

      associate (lanes => batch%lanes)
         do i = 1, series_width
            if (lanes%may_peak(i) > 0) then
               m = merge(right, left, lanes%side(i) > 0)
               call find_largest(lanes%p(i, :batch%kernels%order), lanes%x(i), largest, place)
               if (largest > lanes%top(i, m)) then
                  lanes%top(i, m) = largest
                  lanes%t_top(i, m) = lanes%t(i) + place*lanes%h(i)
               end if
            end if
            if (.not. (lanes%some_speed .and. lanes%may_race(i) > 0)) cycle
            c = [(k*lanes%p(i, k)/lanes%h(i), k=1, size(c))]
            do k = 1, 2
               call find_largest(c, lanes%x(i), largest, place)
               lanes%top_speed(i) = max(lanes%top_speed(i), largest)
               c = -c
            end do
         end do
      end associate
   end subroutine find_peaks

   !> Find the first event in the step of a lane.
   subroutine search_step(i, batch)
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      real(wp), parameter :: noise = 1.0e-13_wp
      !! part of the terms of the acceleration that is round-off [-]
      real(wp) :: c(0:batch%kernels%order), ends(at_lower:at_turn), slope
      integer :: root, k, m

      associate (lanes => batch%lanes, n => batch%kernels%order)
         m = merge(right, left, lanes%side(i) > 0)
         ends = huge(slope)
         ! a third power begins where the second one is round-off
         root = nint(lanes%multiplicity(i))
         c = lanes%p(i, :n)
         c(0) = c(0) - lanes%lower(i)
         ends(at_lower) = first_negative(c(power_of(root):), lanes%x_most(i))
         root = nint(lanes%above(i))
         c = -lanes%p(i, :n)
         c(0) = c(0) + lanes%upper(i, m)
         ends(at_upper) = first_negative(c(power_of(root):), lanes%x_most(i))
         if (abs(lanes%turn(i)) > 0) then
            c(:n - 1) = [(k*lanes%turn(i)*lanes%p(i, k), k=1, n)]
            root = 2
            if (abs(c(0)) > 0) root = 1
            ends(at_turn) = first_negative(c(power_of(root) - 1:n - 1), lanes%x_most(i))
         end if
         lanes%x(i) = min(minval(ends), lanes%x_most(i))
         call evaluate(lanes%p(i, :n), lanes%x(i), lanes%phi_end(i), slope)
         lanes%phi_end(i) = max(lanes%phi_end(i), 0.0_wp)
         lanes%rate_end(i) = slope
         lanes%has_root(i) = 0
         if (minval(ends) > lanes%x_most(i)) return
         ! a turn precedes the upper end of the window, which precedes the lower one
         batch%ending(i) = ubound(ends, 1) + 1 - minloc(ends(at_turn:at_lower:-1), 1)
         if (batch%ending(i) == at_lower) then
            lanes%phi_end(i) = lanes%lower(i)
            lanes%rate_end(i) = min(slope, 0.0_wp)
            lanes%has_root(i) = 1
            return
         end if
         lanes%needs_care(i) = 1
         if (batch%ending(i) == at_turn) then
            lanes%rate_end(i) = 0
         else if (lanes%x(i) > 0) then
            lanes%phi_end(i) = lanes%upper(i, m)
         end if
      end associate

   contains

      !> Power of the position that vanishes at the start.
      pure integer function power_of(root)
         integer, intent(in) :: root
         !! known order of the root there

         power_of = root
         if (root == 2 .and. abs(batch%lanes%p(i, 2)) < noise*batch%lanes%gravity(i) &
             *batch%lanes%h(i)**2) power_of = 3
      end function power_of
   end subroutine search_step

   !> Apply an impact that may end in rest, the end of a branch, or overturning.
   subroutine apply_rare_event(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      type(ending_t) :: ending

      call leave_series(lane, i, batch)
      batch%lanes%needs_care(i) = 0
      batch%lanes%is_at_limit(i) = 0
      ending%kind = event_impact
      ending%is_rising = (batch%ending(i) == at_upper) .eqv. batch%lanes%side(i) > 0
      associate (lanes => batch%lanes, side => (3 + nint(batch%lanes%side(i)))/2)
         select case (batch%ending(i))
         case (at_turn)
            ending%kind = event_peak
         case (at_upper)
            ending%kind = event_branch
            if (lanes%upper(i, side) >= batch%last(i, side)) ending%kind = event_collapsed
            if (lanes%upper(i, side) >= lane%hybrid%overturning_angle) ending%kind = &
               event_overturned
         case default
            if (lanes%lower(i) > 0) ending%kind = event_branch
         end select
      end associate
      batch%ending(i) = at_lower
      call apply_event(lane%hybrid, lane%equation, lane%recorder, ending, lane%error)
      call enter_series(lane, i, batch)
   end subroutine apply_rare_event

end module rwmf_simulation_series_series_events
