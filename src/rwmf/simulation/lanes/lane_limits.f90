!> Limits of lanes besides those of the rotation: branches of yielding storeys, drifts, a held wall
!> and fuses.
!>
!> The ends of a step show the first end of a branch in it. A trial step then leads to its time.
module rwmf_simulation_lanes_lane_limits
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: of_inspection, of_time, of_trial
   use rwmf_integrator_lane_quiet, only: find_quiet_one => find_quiet_steps, of_direction, &
      of_high_end, of_low_end, of_side
   use rwmf_model_equation, only: equation_t
   use rwmf_model_floor_motion, only: storey_accelerations, storey_motion
   use rwmf_model_floors_yielding_storeys, only: branch_limits, hysteretic_states, &
      loading_direction_of, side_beyond_zero, stands_still
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_wall_support, only: ends_on_elements
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_events_step_view, only: count_parts, fastest_angle, quarter_period, &
      step_view_t
   use rwmf_simulation_events_storey_events, only: list_ends, zero_of
   use rwmf_simulation_events_watched_functions, only: keeps_limits
   use rwmf_simulation_events_watched_spans, only: expect_change, measure_smoothness, moment_t, &
      span_t, value_at, watch_t
   use rwmf_simulation_lanes_batch, only: at_storey, batch_t, follow_interval, &
      lane_state_t, storey_end_t
   use rwmf_simulation_state_result, only: event_storey_zero
   implicit none
   private

   public :: load_limits, inspect_limits, reach_target

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
      logical :: is_without_change

      if (batch%branches%is_screened) call screen_storeys(lanes, batch)
      batch%has_limits = .false.
      do i = 1, batch%width
         if (.not. (batch%is_busy(i) .and. lanes(i)%has_limits)) cycle
         batch%has_limits = .true.
         ! the loop over lanes shows that an attempted step has no change
         is_without_change = batch%branches%is_screened .and. lanes(i)%target_event /= at_storey
         if (is_without_change) is_without_change = batch%branches%is_quiet(i, 0) > 0 &
            .and. batch%table(i, of_trial) < batch%branches%longest(i)
         if (is_without_change) then
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

   !> Return whether a lane has limits besides those of its rotation and of its storeys.
   pure logical function has_other_limits(lane)
      type(lane_state_t), intent(in) :: lane

      has_other_limits = lane%is_held .or. lane%hybrid%drifts > 0 .or. lane%equation%may_hold
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

   !> Find out whether drifts, a held wall or elements may end an attempted step.
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
      if (lane%is_smooth) lane%is_smooth = .not. ends_on_elements(step)
   end subroutine check_other_limits

   !> Find the first end of a storey's branch in an attempted step, and the distance to the target.
   !>
   !> Storeys without the end of a branch, by the loop over the lanes, need no further test. A step
   !> to the first change of a longer one needs none of the storey that ends its branch.
   subroutine find_first_end(lane, i, step, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(step_view_t), intent(in) :: step
      type(batch_t), intent(inout) :: batch
      type(watch_t) :: watches(2)
      integer :: j, k, n
      logical :: is_clear, has_target

      has_target = lane%target_event == at_storey
      associate (equation => lane%equation, storey => lane%storey)
         ! evaluate the storeys at the end of an attempted step, with exact rates
         call create_spans(equation%n, batch%branches%n, storey)
         storey%y(:) = batch%y_new(i, :)
         call rates_at(equation, step%t_b, storey%y, storey%rates)
         storey%span%b%t = step%t_b
         call take_values(equation, storey%y, storey%rates, batch%branches%is_screened, &
            batch%branches%d(i, :, :, 2), storey%span%b, storey%states%b)
         is_clear = .true.
         if (has_target) call approach_target(storey, is_clear)
         lane%is_smooth = is_clear
         if (has_target .and. is_clear .and. storey%is_proven) then
            if (count(batch%branches%is_quiet(i, 1:) <= 0) <= merge(0, 1, &
                batch%branches%is_quiet(i, storey%target%which) > 0)) return
         end if
         call measure_begin(equation, i, step, batch, storey)
         do j = 1, batch%branches%n
            if (batch%branches%is_quiet(i, j) > 0) cycle
            call list_ends(equation, j, storey%span, watches, n)
            do k = 1, n
               if (.not. (has_target .and. is_target(storey, watches(k)))) call compare_end( &
                  storey%span, watches(k), storey, is_clear)
            end do
            if (side_beyond_zero(equation%state, j) == 0) cycle
            watches(1) = zero_of(equation, j)
            if (.not. (has_target .and. is_target(storey, watches(1)))) call compare_end( &
               storey%states, watches(1), storey, is_clear)
         end do
         storey%is_clear = is_clear
         ! the step up to the first change decides on changes that are not clear
         lane%is_smooth = is_clear .or. storey%at <= 1
      end associate
   end subroutine find_first_end

   !> Return whether a watch is the target.
   pure logical function is_target(storey, watch)
      type(storey_end_t), intent(in) :: storey
      type(watch_t), intent(in) :: watch

      associate (target => storey%target)
         is_target = watch%which == target%which .and. watch%kind == target%kind &
            .and. abs(watch%side - target%side) <= 0
      end associate
   end function is_target

   !> Find the time to the target by one step of Newton's method.
   pure subroutine approach_target(storey, is_clear)
      type(storey_end_t), intent(inout) :: storey
      logical, intent(out) :: is_clear
      !! the function approaches its level
      real(wp) :: value, rate

      associate (watch => storey%target)
         if (watch%kind == event_storey_zero) then
            value = value_at(watch, storey%states%b)
            rate = watch%side*storey%states%b%f(watch%which, watch%order + 1)
         else
            value = value_at(watch, storey%span%b)
            rate = watch%side*storey%span%b%f(watch%which, watch%order + 1)
         end if
         is_clear = rate < 0
         if (is_clear) storey%rest = -value/rate
      end associate
   end subroutine approach_target

   !> Move the state at the end of a step to the target, by the cubic through both ends.
   !>
   !> The branch ends at its limit or just beyond it: otherwise the next branch could begin on the
   !> wrong side, and end at once.
   subroutine reach_target(lane, i, batch, rest, y)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch
      real(wp), intent(inout) :: rest
      !! time from the end of the step to the target, on input by one step of Newton's method [s]
      real(wp), intent(out) :: y(:)
      !! (states) at the target
      integer, parameter :: most = 8
      integer, parameter :: spacings = 4
      real(wp) :: value, rate, slack
      !! distance to the level, its rate, and round-off of function and time together
      integer :: j, k

      associate (storey => lane%storey, watch => lane%storey%target, b => lane%storey%span%b, &
                 rates => lane%storey%rates, h => batch%table(i, of_trial))
         rate = watch%side*b%f(watch%which, watch%order + 1)
         do k = 1, most
            do j = 1, size(y)
               y(j) = storey%y(j) + rest*(rates(j) + rest/h*(3*(batch%y(i, j) - storey%y(j))/h &
                  + batch%k(i, j, 1) + 2*rates(j)))
            end do
            ! the transition sets the state to zero
            if (watch%kind == event_storey_zero) return
            call storey_motion(lane%equation, lane%equation%state%side, y, b%f(:, 0), b%f(:, 1))
            value = value_at(watch, b)
            slack = max(spacings*epsilon(h)*maxval(abs(b%f(:, watch%order))), &
               -rate*spacing(batch%table(i, of_time) + h))
            if (value <= 0 .and. value >= -slack) return
            rest = rest - (value + slack/2)/rate
         end do
      end associate
   end subroutine reach_target

   !> Compare the end of a branch with the first one so far.
   pure subroutine compare_end(span, watch, storey, is_clear)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      type(storey_end_t), intent(inout) :: storey
      logical, intent(inout) :: is_clear
      !! the ends of the step show all changes so far
      real(wp) :: x
      logical :: is_clear_one

      call expect_change(span, watch, x, is_clear_one)
      is_clear = is_clear .and. is_clear_one
      if (.not. x < storey%at) return
      storey%at = x
      storey%first = watch
   end subroutine compare_end

   !> Evaluate the storeys at the beginning of an attempted step, and measure the step.
   subroutine measure_begin(equation, i, step, batch, storey)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(step_view_t), intent(in) :: step
      type(batch_t), intent(in) :: batch
      type(storey_end_t), intent(inout) :: storey
      real(wp), dimension(size(storey%y)) :: y, rates

      y = batch%y(i, :)
      rates = batch%k(i, :, 1)
      storey%span%a%t = step%t_a
      call take_values(equation, y, rates, batch%branches%is_screened, &
         batch%branches%d(i, :, :, 1), storey%span%a, storey%states%a)
      call measure_smoothness(fastest_angle(step, step%t_b - step%t_a), storey%span)
      ! only the ends of the states matter
      storey%states%rough = 0
      storey%states%largest = 1
   end subroutine measure_begin

   !> Store displacements and hysteretic states of the storeys at one end of a step.
   subroutine take_values(equation, y, rates, is_screened, d, span_end, states_end)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:), rates(:)
      !! (states) with their rates
      logical, intent(in) :: is_screened
      !! the loop over lanes has computed the displacements
      real(wp), intent(in) :: d(:, 0:)
      !! (storeys, 0:1) displacements [m] and rates [m/s], if the loop has computed them
      type(moment_t), intent(inout) :: span_end
      !! with its time
      type(moment_t), intent(inout) :: states_end

      states_end%t = span_end%t
      if (is_screened) then
         span_end%f(:, :1) = d
      else
         call storey_motion(equation, equation%state%side, y, span_end%f(:, 0), span_end%f(:, 1))
      end if
      span_end%f(:, 2) = storey_accelerations(equation, equation%state%side, y, rates)
      if (.not. allocated(equation%floors%laws)) return
      states_end%f(:, 0) = hysteretic_states(equation, y)
      states_end%f(:, 1) = hysteretic_states(equation, rates)
   end subroutine take_values

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
      allocate (storey%states%a%f(n, 0:1), storey%states%b%f(n, 0:1), source=0.0_wp)
   end subroutine create_spans

end module rwmf_simulation_lanes_lane_limits
