!> Loading of the lanes of a batch: a new run, the next part of a run, or the state after an event.
module rwmf_simulation_lanes_lane_loading
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: step_too_small
   use rwmf_integrator_lane_columns, only: of_bottom, of_fastest, of_high, of_inspection, &
      of_interval, of_least, of_length, of_limit, of_line, of_longest, of_low, of_max_rate, &
      of_most, of_rejected, of_steps, of_target, of_time, of_top, of_vertical_line
   use rwmf_integrator_one_step, only: begin_at
   use rwmf_integrator_pairs, only: step_tolerance
   use rwmf_model_hysteresis_bouc_wen, only: stable_rate, will_pass_zero
   use rwmf_model_lanes, only: power_count
   use rwmf_model_system_assembly, only: equation_t, interval_of
   use rwmf_simulation_events_wall_support, only: may_stand_on_elements
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_hybrid_hybrid_loop, only: begin_step, check_steps, stay_at_rest
   use rwmf_simulation_lanes_batch, only: batch_t, follow_interval, lane_state_t, line_row, &
      longest_step
   use rwmf_simulation_lanes_output_screen, only: begin_screen, restart_screen
   use rwmf_simulation_lanes_lane_limits, only: load_limits
   use rwmf_simulation_state_hybrid_state, only: check_creep, check_progress, has_ended, &
      mode_held, mode_rest, mode_rocking, most_creeping, progress_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: join_batch, enter_batch, load_line, catch_up, check_length, further_state, &
      forget_target, bound_work

contains

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
         call begin_screen(lane, i, batch)
      end if
      call enter_batch(lane, i, batch)
   end subroutine join_batch

   !> Prepare a lane for a common step. If its run is over, its step length remains 0.
   subroutine enter_batch(lane, i, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      type(control_t) :: no_control
      real(wp) :: t_limit, span

      batch%table(i, of_length) = 0
      associate (hybrid => lane%hybrid, equation => lane%equation, t_end => lane%t_end)
         do
            if (allocated(lane%error)) return
            if (hybrid%t >= t_end .or. has_ended(hybrid) .or. hybrid%is_stopped) return
            call check_steps(hybrid, lane%integrator, no_control, lane%error)
            if (allocated(lane%error)) return
            if (hybrid%mode == mode_rest) then
               call stay_at_rest(hybrid, equation, lane%recorder, t_end, lane%error)
            else
               call begin_step(hybrid, equation, lane%recorder, lane%integrator%steps, t_end, &
                  t_limit, span, lane%error)
               if (t_limit > hybrid%t) exit
            end if
            if (allocated(lane%error)) return
            call check_progress(hybrid%progress, size(hybrid%y), hybrid%t, lane%error)
         end do
      end associate
      call load_lane(lane, i, t_limit, span, batch)
   end subroutine enter_batch

   !> Load the state of a lane into the table of its batch.
   subroutine load_lane(lane, i, t_limit, span, batch)
      type(lane_state_t), intent(inout), target :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      real(wp), intent(in) :: t_limit, span
      !! [s]
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
            .or. may_stand_on_elements(equation)
         batch%has_limits = batch%has_limits .or. lane%has_limits
         lane%is_smooth = .true.
         lane%target_event = no_event
         lane%storey%at = huge(span)
         table(i, of_target) = 0
         table(i, of_inspection) = merge(0, 1, lane%is_smooth)
      end associate
      call load_window(lane, i, batch)
      if (lane%equation%floors%yields) call load_limits(lane, i, batch)
      call load_line(lane, i, t_limit, batch)
      call restart_screen(lane, i, batch)
      ! under an extremely strong motion, no first step is short enough
      if (.not. batch%table(i, of_length) > 0) call check_length(lane, i, batch)
   end subroutine load_lane

   !> Set the window of states without an event.
   subroutine load_window(lane, i, batch)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
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
      !! number of the lane in the batch
      real(wp), intent(in) :: t_limit
      !! [s]
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

   !> Check the number of steps of one run in the batch.
   subroutine bound_work(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch
      type(control_t) :: no_control
      type(error_t), allocatable :: error

      call check_creep(lane%hybrid%creep, int(batch%table(i, of_steps), i8), &
         batch%table(i, of_time), error)
      if (batch%table(i, of_steps) <= batch%max_steps .and. .not. allocated(error)) return
      call catch_up(lane, i, batch)
      if (.not. allocated(error)) call check_steps(lane%hybrid, lane%integrator, no_control, error)
      call move_alloc(error, lane%error)
      batch%table(i, of_length) = 0
   end subroutine bound_work

   !> Update the run of a lane with its progress in the batch.
   subroutine catch_up(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(in) :: batch

      lane%integrator%steps = int(batch%table(i, of_steps), i8)
      lane%hybrid%t = batch%table(i, of_time)
      lane%recorder%theta_dot_ends = batch%table(i, of_fastest)
      call follow_interval(lane, i, batch)
   end subroutine catch_up

   !> Fail if a step is below the resolution of the time.
   subroutine check_length(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      if (batch%table(i, of_length) > 8*spacing(batch%table(i, of_time))) return
      call catch_up(lane, i, batch)
      batch%table(i, of_length) = 0
      call fail(lane%error, err_numerical, step_too_small//'; t = ' &
         //trim(real_to_text(batch%table(i, of_time)))//' s')
   end subroutine check_length

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
      !! number of the lane in the batch
      type(batch_t), intent(inout) :: batch

      lane%target_event = no_event
      batch%table(i, of_target) = 0
      batch%table(i, of_inspection) = merge(0, 1, lane%is_smooth)
   end subroutine forget_target

end module rwmf_simulation_lanes_lane_loading
