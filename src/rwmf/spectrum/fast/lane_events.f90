!> Events of the lanes inside a step: impacts, peaks, rest and lift-off.
!>
!> Flights are integrated and searched in batches (`rwmf_spectrum_fast_substep_kernel`,
!> `rwmf_spectrum_fast_event_kernel`); this module loads the batches and classifies the results.
module rwmf_spectrum_fast_lane_events
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_energy_bound, only: is_peak_final
   use rwmf_spectrum_fast_event_kernel, only: place_impacts
   use rwmf_spectrum_fast_lane_pool, only: block_of, dequeue, lane_of, lane_pool_t, push
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_rest_rule, only: comes_to_rest, find_next_uplift, velocity_share
   use rwmf_spectrum_fast_scalar_events, only: locate_flight_events
   use rwmf_spectrum_fast_shared_data, only: shared_data_t
   use rwmf_spectrum_fast_simd_dispatch, only: integrate_batch, rebound_batch, search_batch
   use rwmf_spectrum_fast_types, only: batch_width, lane_block_t, reduced_equation_t, &
      substep_batch_t, trial_step_t
   implicit none
   private

   public :: max_impacts, load_step, follow_steps, follow_new_flights, put_to_rest

   integer, parameter :: max_impacts = 200000
   !! of one ordinate; beyond them it is left to the general kernel and its rules for chatter
   real(wp), parameter :: remainder_share = 1.0e-4_wp
   !! part of the tolerance below which a change of v by N is left out
   real(wp), parameter :: last_x = 1 - 1.0e-13_wp
   !! largest position of a lift-off, so that the rest of the step has a length [-]

contains

   !> Put the wall to rest at the position x of a step: until it lifts off, or to the end.
   pure subroutine put_to_rest(shared, slot, number, x, pool)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: slot
      integer, intent(in) :: number
      !! number of the step in the grid
      real(wp), intent(in) :: x
      !! position in the step [-]
      type(lane_pool_t), intent(inout) :: pool
      integer :: uplift_number
      real(wp) :: uplift_x

      associate (ordinate => pool%ordinate(slot))
         associate (equation => shared%equation(ordinate%equation), &
            grid => shared%grid(ordinate%grid))
            uplift_number = number
            uplift_x = x
            call find_next_uplift(equation, grid, &
               shared%uplift(ordinate%pair, ordinate%grid)%next, uplift_number, uplift_x, &
               ordinate%side)
            call clear_motion(slot, pool)
            if (uplift_number > size(grid%step)) then
               call push(slot, pool%finished_queue)
            else
               call plan_flight(uplift_number, min(uplift_x, last_x), 0.0_wp, ordinate)
               call push(slot, pool%start_queue)
            end if
         end associate
      end associate
   end subroutine put_to_rest

   !> Clear the motion of a lane.
   pure subroutine clear_motion(slot, pool)
      integer, intent(in) :: slot
      type(lane_pool_t), intent(inout) :: pool

      associate (now => pool%block(block_of(slot))%now, i => lane_of(slot))
         now%v(i) = 0
         now%w(i) = 0
         now%n(i) = 0
         now%n_rate(i) = 0
         now%v_d2(i) = 0
      end associate
   end subroutine clear_motion

   !> Plan a flight that starts on the base.
   pure subroutine plan_flight(number, x, w, ordinate)
      integer, intent(in) :: number
      !! number of the step in the grid
      real(wp), intent(in) :: x
      !! position in the step [-]
      real(wp), intent(in) :: w
      !! rate of v [1/s]
      type(ordinate_t), intent(inout) :: ordinate

      ordinate%step = number
      ordinate%x = x
      ordinate%span = 1 - x
      ordinate%w = w
   end subroutine plan_flight

   !> Locate the events of the waiting steps. The flights after the impacts are followed in the same
   !> batch, with planned flights at its free places.
   pure subroutine follow_steps(shared, pool)
      type(shared_data_t), intent(in) :: shared
      type(lane_pool_t), intent(inout) :: pool
      integer :: k

      associate (batch => pool%step_batch)
         call clear_substeps(batch%n_steps + 1, batch%n_filled, batch)
         batch%n_filled = batch%n_steps
         if (batch%n_steps > 0) then
            batch%v(batch%n_steps + 1:) = 1
            batch%end_state%v(batch%n_steps + 1:) = 1
            call search_batch(shared%instructions, batch)
            call search_remaining(batch, pool)
            call rebound_batch(shared%instructions, remainder_share*shared%rtol, batch)
            do k = 1, batch%n_steps
               call classify(shared, k, batch, pool)
               if (batch%slot(k) == 0) then
                  call clear_substeps(k, k, batch)
               else
                  call load_polynomials(shared, pool%ordinate(batch%slot(k)), k, batch)
               end if
            end do
         end if
         call load_planned_flights(shared, batch, pool)
         call follow_flights(shared, batch, pool)
         batch%n_steps = 0
      end associate
   end subroutine follow_steps

   !> Follow a batch of planned flights.
   pure subroutine follow_new_flights(shared, pool)
      type(shared_data_t), intent(in) :: shared
      type(lane_pool_t), intent(inout) :: pool

      associate (batch => pool%flight_batch)
         call clear_substeps(1, batch%n_filled, batch)
         batch%n_filled = 0
         call load_planned_flights(shared, batch, pool)
         call follow_flights(shared, batch, pool)
      end associate
   end subroutine follow_new_flights

   !> Load planned flights at the free places of a batch.
   pure subroutine load_planned_flights(shared, batch, pool)
      type(shared_data_t), intent(in) :: shared
      type(substep_batch_t), intent(inout) :: batch
      type(lane_pool_t), intent(inout) :: pool
      integer :: slot(batch_width)
      integer :: k, n, n_taken

      n = min(pool%start_queue%n, count(batch%slot == 0))
      if (n == 0) return
      call dequeue(pool%start_queue, slot(:n))
      n_taken = 0
      do k = 1, batch_width
         if (batch%slot(k) /= 0) cycle
         if (n_taken == n) exit
         n_taken = n_taken + 1
         batch%slot(k) = slot(n_taken)
         batch%n_filled = max(batch%n_filled, k)
         call load_flight(shared, pool%ordinate(slot(n_taken)), k, batch)
      end do
   end subroutine load_planned_flights

   !> Integrate the flights of a batch, which start on the base, and classify them; lanes that start
   !> another flight are queued.
   pure subroutine follow_flights(shared, batch, pool)
      type(shared_data_t), intent(in) :: shared
      type(substep_batch_t), intent(inout) :: batch
      type(lane_pool_t), intent(inout) :: pool
      integer :: k

      call integrate_batch(shared%instructions, batch)
      call search_remaining(batch, pool)
      call rebound_batch(shared%instructions, remainder_share*shared%rtol, batch)
      do k = 1, batch_width
         if (batch%slot(k) == 0) cycle
         call classify(shared, k, batch, pool)
         if (batch%slot(k) == 0) cycle
         pool%ordinate(batch%slot(k))%span = batch%span(k)
         call push(batch%slot(k), pool%start_queue)
      end do
   end subroutine follow_flights

   !> Load the constants of an ordinate.
   pure subroutine load_constants(equation, ordinate, k, batch)
      type(reduced_equation_t), intent(in) :: equation
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: k
      !! place in the batch
      type(substep_batch_t), intent(inout) :: batch

      batch%damping(k) = ordinate%damping
      batch%stiffness(k) = ordinate%stiffness
      batch%stages(k) = ordinate%stages
      batch%w_begin(k) = ordinate%w
      ! From the impacts so far; `comes_to_rest` includes the latest one.
      batch%negligible_velocity(k) = velocity_share*ordinate%rtol*ordinate%w_max
      batch%v_max(k) = ordinate%v_max
      if (batch%equation(k) == ordinate%equation) return
      batch%equation(k) = ordinate%equation
      batch%m1(k) = equation%m1
      batch%m2(k) = equation%m2
      batch%m3(k) = equation%m3
      batch%m3_1(k) = equation%m3_1
      batch%threshold(k) = equation%threshold
      batch%e(k) = equation%e
   end subroutine load_constants

   !> Load a tentative step of a lane at the next place of a batch.
   pure subroutine load_step(shared, lanes, trial, i, slot, ordinate, batch)
      type(shared_data_t), intent(in) :: shared
      type(lane_block_t), intent(in) :: lanes
      type(trial_step_t), intent(in) :: trial
      integer, intent(in) :: i
      !! lane
      integer, intent(in) :: slot
      type(ordinate_t), intent(inout) :: ordinate
      type(substep_batch_t), intent(inout) :: batch
      integer :: k

      ordinate%step = lanes%step(i) - ordinate%offset
      ordinate%v_max = lanes%v_max(i)
      k = batch%n_steps + 1
      batch%n_steps = k
      batch%slot(k) = slot
      call load_constants(shared%equation(ordinate%equation), ordinate, k, batch)
      batch%h_step(k) = lanes%constants%h(i)
      batch%f(k, :) = trial%ground%f(i, :)
      batch%x(k) = 0
      batch%span(k) = 1
      batch%v(k) = lanes%now%v(i)
      batch%w(k) = lanes%now%w(i)
      batch%side(k) = lanes%constants%side(i)
      batch%difference(k, :) = trial%difference(i, :)
      batch%end_state%v(k) = trial%next%v(i)
      batch%end_state%w(k) = trial%next%w(i)
      batch%end_state%n(k) = trial%next%n(i)
      batch%end_state%n_rate(k) = trial%next%n_rate(i)
      batch%end_state%v_d2(k) = trial%next%v_d2(i)
   end subroutine load_step

   !> Load the planned flight of an ordinate.
   pure subroutine load_flight(shared, ordinate, k, batch)
      type(shared_data_t), intent(in) :: shared
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: k
      type(substep_batch_t), intent(inout) :: batch

      associate (equation => shared%equation(ordinate%equation), &
         ground => shared%ground(ordinate%offset + ordinate%step))
         call load_constants(equation, ordinate, k, batch)
         batch%h_step(k) = ground%h
         batch%f(k, :) = ground%f
         batch%x(k) = ordinate%x
         batch%span(k) = ordinate%span
         batch%w(k) = ordinate%w
         batch%side(k) = ordinate%side
         batch%negligible_change(k) = remainder_share*ordinate%rtol*ordinate%v_max
      end associate
      call load_polynomials(shared, ordinate, k, batch)
   end subroutine load_flight

   !> Load the polynomials of the side on which a flight takes place.
   pure subroutine load_polynomials(shared, ordinate, k, batch)
      type(shared_data_t), intent(in) :: shared
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: k
      type(substep_batch_t), intent(inout) :: batch

      associate (equation => shared%equation(ordinate%equation))
         if (batch%polynomial(k) == polynomial_of(equation, ordinate)) return
         batch%polynomial(k) = polynomial_of(equation, ordinate)
         batch%coef(k, :, :) = equation%coef(:, :, merge(1, 2, ordinate%side > 0))
      end associate
   end subroutine load_polynomials

   !> Key of the polynomials of an ordinate: the number of its equation, negative for theta < 0
   !> where the sides differ.
   pure integer function polynomial_of(equation, ordinate) result(polynomial)
      type(reduced_equation_t), intent(in) :: equation
      type(ordinate_t), intent(in) :: ordinate

      polynomial = ordinate%equation
      if (ordinate%side < 0 .and. .not. equation%is_even) polynomial = -polynomial
   end function polynomial_of

   !> Clear places of a batch: values that need no search. Components not set here may keep those of
   !> any flight.
   pure subroutine clear_substeps(first, last, batch)
      integer, intent(in) :: first
      integer, intent(in) :: last
      type(substep_batch_t), intent(inout) :: batch
      integer :: k

      do k = first, last
         batch%slot(k) = 0
         batch%h_step(k) = 1.0e-3_wp
         batch%f(k, :) = 0
         batch%x(k) = 0
         batch%span(k) = 1
         batch%v(k) = 1
         batch%w(k) = 1
         batch%v_max(k) = huge(1.0_wp)
         batch%stages(k) = 1
         batch%negligible_change(k) = huge(1.0_wp)
         batch%difference(k, :) = 0
         batch%end_state%v(k) = 1
         batch%end_state%w(k) = 1
      end do
   end subroutine clear_substeps

   !> Search the flights that the vectorised search leaves out.
   pure subroutine search_remaining(batch, pool)
      type(substep_batch_t), intent(inout) :: batch
      type(lane_pool_t), intent(inout) :: pool
      integer :: k

      if (.not. any(batch%needs_search > 0)) return
      do k = 1, batch_width
         if (.not. batch%needs_search(k) > 0 .or. batch%slot(k) == 0) cycle
         call locate_flight_events(k, batch, pool%ordinate(batch%slot(k))%failed)
      end do
      call place_impacts(batch)
   end subroutine search_remaining

   !> Classify the end of a substep: failure, impact, rest, or end of the step. The place in the
   !> batch becomes free unless another flight follows in the step.
   pure subroutine classify(shared, k, batch, pool)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: k
      type(substep_batch_t), intent(inout) :: batch
      type(lane_pool_t), intent(inout) :: pool
      logical :: is_at_rest

      associate (slot => batch%slot(k))
         associate (ordinate => pool%ordinate(slot))
            ordinate%v_max = batch%v_max(k)
            if (batch%has_impact(k) > 0 .and. .not. ordinate%failed) then
               call apply_impact(shared, k, batch, ordinate, is_at_rest)
               if (ordinate%failed) then
                  call push(slot, pool%finished_queue)
                  slot = 0
               else if (is_at_rest) then
                  call put_to_rest(shared, slot, ordinate%step, batch%x_impact(k), pool)
                  slot = 0
               end if
            else if (ordinate%failed) then
               call push(slot, pool%finished_queue)
               slot = 0
            else if (batch%span(k) < 1 - batch%x(k)) then
               ! The flight takes longer than expected: follow the rest of the step.
               batch%span(k) = 1 - batch%x(k)
            else
               ordinate%v_max = max(ordinate%v_max, batch%end_state%v(k))
               call return_to_block(shared, batch, k, pool)
               slot = 0
            end if
         end associate
      end associate
   end subroutine classify

   !> Return a lane to its block at the end of a step.
   pure subroutine return_to_block(shared, batch, k, pool)
      type(shared_data_t), intent(in) :: shared
      type(substep_batch_t), intent(in) :: batch
      integer, intent(in) :: k
      type(lane_pool_t), intent(inout) :: pool

      associate (end_state => batch%end_state, slot => batch%slot(k))
         associate (lanes => pool%block(block_of(slot)), i => lane_of(slot), &
            ordinate => pool%ordinate(slot))
            lanes%now%v(i) = end_state%v(k)
            lanes%now%w(i) = end_state%w(k)
            lanes%now%n(i) = end_state%n(k)
            lanes%now%n_rate(i) = end_state%n_rate(k)
            lanes%now%v_d2(i) = end_state%v_d2(k)
            call update_peak(ordinate%v_max, i, lanes)
            if (abs(lanes%constants%side(i) - ordinate%side) > 0) then
               lanes%constants%side(i) = ordinate%side
               associate (equation => shared%equation(ordinate%equation))
                  if (.not. equation%is_even) lanes%constants%coef(i, :, :) = equation%coef(:, :, &
                     merge(1, 2, ordinate%side > 0))
               end associate
            end if
            ordinate%step = ordinate%step + 1
            lanes%step(i) = ordinate%offset + ordinate%step
            if (lanes%length_change(i) == huge(1)) lanes%length_change(i) = 0
            pool%needs_update(block_of(slot)) = pool%needs_update(block_of(slot)) &
               .or. lanes%step(i) >= lanes%length_change(i)
            pool%n_active(block_of(slot)) = pool%n_active(block_of(slot)) + 1
            lanes%ready(i) = 1
         end associate
      end associate
   end subroutine return_to_block

   !> Update the largest v and the error estimate that belongs to it.
   pure subroutine update_peak(v_max, i, lanes)
      real(wp), intent(in) :: v_max
      integer, intent(in) :: i
      !! lane
      type(lane_block_t), intent(inout) :: lanes

      if (v_max > lanes%v_max(i)) lanes%error_at_peak(i) = lanes%error_estimate(i)
      lanes%v_max(i) = max(lanes%v_max(i), v_max)
   end subroutine update_peak

   !> Apply an impact to an ordinate: the next flight is set up, or the wall comes to rest.
   pure subroutine apply_impact(shared, k, batch, ordinate, is_at_rest)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: k
      !! place in the batch
      type(substep_batch_t), intent(in) :: batch
      type(ordinate_t), intent(inout) :: ordinate
      logical, intent(out) :: is_at_rest

      ordinate%impacts = ordinate%impacts + 1
      ordinate%failed = .not. batch%impact_speed(k) > 0 .or. ordinate%impacts > max_impacts
      ordinate%side = -ordinate%side
      ordinate%w_max = max(ordinate%w_max, batch%impact_speed(k))
      ordinate%x = batch%x(k)
      ordinate%w = batch%w(k)
      is_at_rest = .false.
      if (batch%may_rest(k) > 0) then
         is_at_rest = comes_to_rest(shared%equation(ordinate%equation), &
            shared%grid(ordinate%grid), shared%uplift(ordinate%pair, ordinate%grid)%next, &
            ordinate%step, ordinate%x, batch%f_impact(k), ordinate%w, ordinate)
      end if
      ! The ordinate is closed as well where no larger peak can follow.
      if (ordinate%step >= ordinate%motion_end_step) is_at_rest = is_at_rest &
         .or. is_peak_final(shared%equation(ordinate%equation), ordinate, ordinate%w)
   end subroutine apply_impact

end module rwmf_spectrum_fast_lane_events
