!> Limits of the lanes of a batch in addition to those of the rotation: ends of the branches of
!> yielding storeys, drifts, a held wall and fuses.
!>
!> The ends of a step show the first end of a branch in it. A trial step then leads to its time.
module rwmf_simulation_lanes_storey_ends
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: of_inspection, of_time, of_trial
   use rwmf_integrator_lane_quiet, only: find_quiet_one => find_quiet_steps, of_direction, &
      of_high_end, of_low_end, of_side
   use rwmf_model_floor_motion, only: storey_accelerations, storey_motion
   use rwmf_model_floors_yielding_storeys, only: branch_limits, hysteretic_states, &
      loading_direction_of, side_beyond_zero, stands_still
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_first_change, only: expect_change, measure_span, span_t, value_at, &
      watch_t
   use rwmf_simulation_events_fuse_support, only: ends_on_fuses
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_events_step_view, only: count_parts, fastest_angle, quarter_period, &
      step_view_t
   use rwmf_simulation_events_storey_events, only: list_ends, zero_of
   use rwmf_simulation_events_watched_functions, only: keeps_limits
   use rwmf_simulation_lanes_batch, only: at_storey, batch_t, follow_interval, &
      lane_state_t, storey_end_t
   implicit none
   private

   public :: load_limits, inspect_limits

contains

   !> Load the limits of the active branches of a lane into its batch.
   subroutine load_limits(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      type(step_view_t) :: step
      integer :: j

      step%equation => lane%equation
      ! phase in a second
      batch%branches%frequency(i) = fastest_angle(step, 1.0_wp)
      batch%branches%longest(i) = 0
      if (.not. (batch%has_curves .or. has_other_limits(lane))) batch%branches%longest(i) = &
         quarter_period(lane%equation)
      associate (equation => lane%equation, state => lane%equation%state, &
                 limits => batch%branches%limits)
         do j = 1, batch%branches%n
            call branch_limits(equation, j, limits(i, j, of_low_end), limits(i, j, of_high_end))
            limits(i, j, of_direction) = loading_direction_of(equation, state, j)
            limits(i, j, of_side) = side_beyond_zero(state, j)
            if (.not. stands_still(state, j)) cycle
            ! no step is quiet before the first motion
            limits(i, j, of_direction) = 1
            limits(i, j, of_high_end) = -huge(1.0_wp)
         end do
      end associate
   end subroutine load_limits

   !> Find the first changes of the attempted steps of lanes with limits.
   subroutine inspect_limits(lanes, batch)
      type(lane_state_t), intent(inout), target :: lanes(:)
      type(batch_t), intent(inout), target :: batch
      integer :: i

      if (batch%branches%is_screened) call screen_storeys(lanes, batch)
      batch%has_limits = .false.
      do i = 1, batch%width
         if (.not. (batch%is_busy(i) .and. lanes(i)%has_limits)) cycle
         batch%has_limits = .true.
         if (is_without_change(lanes(i), i, batch)) then
            lanes(i)%is_smooth = .true.
            lanes(i)%storey%at = huge(1.0_wp)
         else if (batch%error(i) <= 1) then
            ! an inaccurate step is rejected
            call inspect_lane(lanes(i), i, batch)
         end if
         batch%table(i, of_inspection) = merge(0, 1, lanes(i)%is_smooth &
            .and. lanes(i)%target_event == no_event .and. lanes(i)%storey%at > 1)
      end do
   end subroutine inspect_limits

   !> Return whether the loop over lanes shows that an attempted step has no change.
   pure logical function is_without_change(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch

      is_without_change = batch%branches%is_screened .and. lane%target_event /= at_storey
      if (is_without_change) is_without_change = batch%branches%is_quiet(i, 0) > 0 &
         .and. batch%table(i, of_trial) < batch%branches%longest(i)
   end function is_without_change

   !> Return whether a lane has limits besides those of its rotation and of its storeys.
   pure logical function has_other_limits(lane)
      type(lane_state_t), intent(in) :: lane

      has_other_limits = lane%is_held .or. lane%hybrid%drifts > 0 .or. lane%equation%has_fuses
   end function has_other_limits

   !> Find the steps in which no storey ends its branch.
   subroutine screen_storeys(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch

      associate (scene => lanes(1)%equation%scene, branches => batch%branches)
         if (batch%width == 1) then
            call find_quiet_one(scene, branches%n, branches%smooth, batch%coef, batch%y, &
               batch%y_new, branches%limits, branches%frequency, batch%table, branches%d, &
               branches%is_quiet)
         else
            call batch%kernels%find_quiet_steps(scene, branches%n, branches%smooth, batch%coef, &
               batch%y, batch%y_new, branches%limits, branches%frequency, batch%table, branches%d, &
               branches%is_quiet)
         end if
      end associate
   end subroutine screen_storeys

   !> Find the first change of an attempted step. The step is smooth if its ends show it.
   subroutine inspect_lane(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      type(step_view_t) :: step

      call follow_interval(lane, i, batch)
      step%equation => lane%equation
      step%t_a = batch%table(i, of_time)
      step%t_b = step%t_a + batch%table(i, of_trial)
      lane%storey%at = huge(1.0_wp)
      lane%is_smooth = count_parts(step) == 1
      if (.not. lane%is_smooth) return
      if (batch%branches%n > 0) then
         if (batch%branches%is_quiet(i, 0) <= 0 .or. lane%target_event == at_storey) then
            call find_first_end(lane, i, step, batch)
            if (.not. lane%is_smooth) return
         end if
      end if
      if (.not. lane%storey%at > 1) return
      if (has_other_limits(lane)) call check_other_limits(lane, i, batch)
   end subroutine inspect_lane

   !> Find out whether drifts, a held wall or fuses may end an attempted step.
   subroutine check_other_limits(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      type(step_view_t) :: step
      real(wp), dimension(lane%equation%n), target :: y_a, y_b, rates_a, rates_b

      step%equation => lane%equation
      step%t_a = batch%table(i, of_time)
      step%t_b = step%t_a + batch%table(i, of_trial)
      y_a = batch%y(i, :)
      y_b = batch%y_new(i, :)
      rates_a = batch%k(i, :, 1)
      rates_b = batch%k(i, :, batch%pair%stages)
      step%y_a => y_a
      step%y_b => y_b
      step%rates_a => rates_a
      step%rates_b => rates_b
      lane%is_smooth = keeps_limits(step, lane%hybrid)
      if (lane%is_smooth) lane%is_smooth = .not. ends_on_fuses(step)
   end subroutine check_other_limits

   !> Find the first end of a storey's branch in an attempted step, and the distance to the target.
   !>
   !> Storeys without the end of a branch, by the loop over the lanes, need no further test.
   subroutine find_first_end(lane, i, step, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(step_view_t), intent(in) :: step
      type(batch_t), intent(inout) :: batch
      type(watch_t) :: watches(2)
      integer :: j, k, n
      logical :: is_aim, has_aim

      call measure_storeys(lane, i, step, batch)
      lane%is_smooth = .true.
      has_aim = lane%target_event /= at_storey
      associate (equation => lane%equation, storey => lane%storey)
         do j = 1, batch%branches%n
            is_aim = lane%target_event == at_storey .and. storey%target%which == j
            if (batch%branches%is_quiet(i, j) > 0 .and. .not. is_aim) cycle
            call list_ends(equation, j, storey%span, watches, n)
            do k = 1, n
               call compare_end(storey%span, watches(k), is_aim, lane, has_aim)
            end do
            if (side_beyond_zero(equation%state, j) /= 0) call compare_end(storey%states, &
               zero_of(equation, j), is_aim, lane, has_aim)
         end do
         ! the step up to the first change decides on changes that are not clear
         lane%is_smooth = (lane%is_smooth .and. has_aim) .or. storey%at <= 1
      end associate
   end subroutine find_first_end

   !> Compare the end of a branch with the first one so far, or find the distance to it if it is the
   !> target.
   pure subroutine compare_end(span, watch, may_be_aim, lane, has_aim)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      logical, intent(in) :: may_be_aim
      !! the watch may be the target
      type(lane_state_t), intent(inout) :: lane
      logical, intent(inout) :: has_aim
      !! the distance to the target is known
      real(wp) :: x, rate
      logical :: is_clear

      associate (storey => lane%storey)
         if (may_be_aim .and. watch%kind == storey%target%kind &
             .and. abs(watch%side - storey%target%side) <= 0) then
            rate = watch%side*span%b%f(watch%which, watch%order + 1)
            has_aim = rate < 0
            if (has_aim) storey%rest = -value_at(watch, span%b)/rate
            return
         end if
         call expect_change(span, watch, x, is_clear)
         lane%is_smooth = lane%is_smooth .and. is_clear
         if (.not. x < storey%at) return
         storey%at = x
         storey%first = watch
      end associate
   end subroutine compare_end

   !> Evaluate the storeys at both ends of an attempted step, with exact rates.
   subroutine measure_storeys(lane, i, step, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(step_view_t), intent(in) :: step
      type(batch_t), intent(inout) :: batch
      integer :: m

      associate (equation => lane%equation, side => lane%equation%state%side, &
                 storey => lane%storey, a => lane%storey%span%a, b => lane%storey%span%b, &
                 d => batch%branches%d)
         call create_spans(equation%n, batch%branches%n, storey)
         a%t = step%t_a
         b%t = step%t_b
         storey%states%a%t = a%t
         storey%states%b%t = b%t
         ! rates at the beginning
         storey%y(:) = batch%y(i, :)
         storey%rates(:) = batch%k(i, :, 1)
         if (.not. batch%branches%is_screened) call storey_motion(equation, side, storey%y, &
            d(i, :, 0, 1), d(i, :, 1, 1))
         a%f(:, 2) = storey_accelerations(equation, side, storey%y, storey%rates)
         storey%states%a%f(:, 0) = hysteretic_states(equation, storey%y)
         storey%states%a%f(:, 1) = hysteretic_states(equation, storey%rates)
         storey%y(:) = batch%y_new(i, :)
         call rates_at(equation, step%t_b, storey%y, storey%rates)
         if (.not. batch%branches%is_screened) call storey_motion(equation, side, storey%y, &
            d(i, :, 0, 2), d(i, :, 1, 2))
         b%f(:, 2) = storey_accelerations(equation, side, storey%y, storey%rates)
         storey%states%b%f(:, 0) = hysteretic_states(equation, storey%y)
         storey%states%b%f(:, 1) = hysteretic_states(equation, storey%rates)
         do m = 0, 1
            a%f(:, m) = d(i, :, m, 1)
            b%f(:, m) = d(i, :, m, 2)
         end do
         call measure_span(fastest_angle(step, step%t_b - step%t_a), storey%span)
         storey%states%rough = 0
         storey%states%largest = 1
      end associate
   end subroutine measure_storeys

   !> Create the arrays of a lane, unless they exist.
   pure subroutine create_spans(n_states, n, storey)
      integer, intent(in) :: n_states, n
      !! numbers of states and of storeys
      type(storey_end_t), intent(inout) :: storey

      if (allocated(storey%y)) then
         if (size(storey%y) == n_states .and. size(storey%span%a%f, 1) == n) return
         deallocate (storey%y, storey%rates, storey%span%a%f, storey%span%b%f, &
            storey%states%a%f, storey%states%b%f)
      end if
      allocate (storey%y(n_states), storey%rates(n_states))
      allocate (storey%span%a%f(n, 0:2), storey%span%b%f(n, 0:2))
      allocate (storey%states%a%f(n, 0:1), storey%states%b%f(n, 0:1))
   end subroutine create_spans

end module rwmf_simulation_lanes_storey_ends
