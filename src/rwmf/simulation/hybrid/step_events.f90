!> Search of the integrator's last step for its events, in chronological order.
!>
!> Turns of the rotation that end no step are recorded; the search continues behind them.
module rwmf_simulation_hybrid_step_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen, only: will_pass_zero
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_lift_off, only: find_uplift_acceleration
   use rwmf_simulation_events_first_change, only: ending_t, find_event
   use rwmf_simulation_events_rotation_events, only: frame_state_t, keeps_direction, rotation_t
   use rwmf_simulation_events_step_view, only: from, step_view_t, until
   use rwmf_simulation_events_watched_functions, only: cut_step
   use rwmf_simulation_hybrid_transitions, only: observe_peak
   use rwmf_simulation_recorder_recorder, only: observe_event, recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, mode_held, mode_rocking
   use rwmf_simulation_state_result, only: event_impact, event_peak
   implicit none
   private

   public :: search_step, list_turns

   integer, parameter :: most_turns = 20
   !! largest number of turns in a step; more turns are round-off

contains

   !> Search the integrator's last step; store time and state of its end or of the event in hybrid.
   subroutine search_step(hybrid, step, recorder, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(inout) :: step
      type(recorder_t), intent(inout) :: recorder
      type(ending_t), intent(out) :: ending
      !! `event_impact`, `event_overturned`, `event_branch`, `event_passage`, `event_peak` (only if
      !! a spring unloads at the peak), or an event of a watched function
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails

      call cut_step(step, hybrid, ending, error)
      if (allocated(error)) return
      hybrid%t = step%t_b
      hybrid%y(:) = step%y_b
      if (hybrid%mode == mode_held) then
         ! an implicit method solves for all states together and leaves round-off in the held ones
         hybrid%y(:2) = 0
         call find_uplift_acceleration(step%equation%model_t, step%equation%state, hybrid%y)
      else if (.not. (keeps_direction(step) .and. stays_inside(hybrid, step))) then
         call search_rotation(hybrid, step, recorder, ending, error)
      end if
   end subroutine search_step

   !> Return whether a motion in one direction ends before all limits of the rotation.
   pure logical function stays_inside(hybrid, step)
      type(hybrid_t), intent(in) :: hybrid
      type(step_view_t), intent(in) :: step

      associate (equation => step%equation, b => step%y_b)
         stays_inside = b(1) < equation%state%high .and. b(1) > equation%state%low
         if (equation%has_wall) stays_inside = stays_inside .and. abs(b(1)) &
            < hybrid%overturning_angle
         if (hybrid%mode == mode_rocking) stays_inside = stays_inside &
            .and. equation%state%side*b(1) > 0
         if (stays_inside .and. equation%has_loading_direction) stays_inside = .not. passes_zero( &
            equation, b)
      end associate
   end function stays_inside

   !> Search a step for the first event of the rotation and of a smooth frame.
   subroutine search_rotation(hybrid, step, recorder, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: step
      type(recorder_t), intent(inout) :: recorder
      type(ending_t), intent(inout) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(rotation_t) :: rotation
      type(step_view_t) :: rest
      type(ending_t) :: at_end
      real(wp), target :: y_a(size(step%y_a))
      logical :: is_found
      integer :: i

      ! set the limits of the scene
      rotation%n = 1
      rotation%states = [1, 2]
      rotation%has_limits = .true.
      rotation%is_rocking = hybrid%mode == mode_rocking
      if (step%equation%has_wall) rotation%overturning_angle = hybrid%overturning_angle
      if (.not. recorder%keeps_events) rotation%known = [recorder%theta_min, recorder%theta_max]
      if (step%equation%has_loading_direction) then
         rotation%direction = step%equation%state%signs%loading_direction
         rotation%knows_direction = abs(step%y_a(2)) <= 0
      end if
      call leave_base(rotation, step)
      at_end = ending
      rest = step
      do i = 0, most_turns
         hybrid%t = step%t_b
         hybrid%y(:) = step%y_b
         ending = at_end
         if (rest%t_a >= rest%t_b) return
         rotation%has_turns = .not. keeps_direction(rest, rotation%direction)
         if (.not. rotation%has_turns .and. stays_inside(hybrid, rest)) return
         rotation%has_turns = rotation%has_turns .and. i < most_turns
         ! an event of the rotation at the end of the step precedes the event that cuts the step
         ending = ending_t()
         call find_event(rotation, rest, ending, is_found, error)
         if (is_found) then
            hybrid%t = ending%t
            hybrid%y(:) = ending%y
         else
            ending = at_end
         end if
         if (step%equation%has_loading_direction .and. .not. allocated(error)) call end_at_zero( &
            hybrid, rest, ending, error)
         if (allocated(error) .or. ending%kind /= event_peak) return
         if (step%equation%has_loading_direction .or. .not. is_start(rest, ending)) then
            call observe_peak(hybrid, step%equation, recorder, real(before(ending), wp), &
               hybrid%t, hybrid%y)
            if (step%equation%state%ends_at_peak) return
         end if
         call pass_turn(rotation, rest, ending, y_a)
      end do
   end subroutine search_rotation

   !> Set the direction of a flight that starts with theta' = 0: away from the base.
   pure subroutine leave_base(rotation, step)
      type(rotation_t), intent(inout) :: rotation
      type(step_view_t), intent(in) :: step

      if (.not. step%equation%has_impacts .or. abs(step%y_a(1)) > 0) return
      rotation%direction = step%equation%state%side
      rotation%knows_direction = .true.
   end subroutine leave_base

   !> Continue behind a turn.
   subroutine pass_turn(rotation, rest, turn, y_a)
      type(rotation_t), intent(inout) :: rotation
      type(step_view_t), intent(inout) :: rest
      type(ending_t), intent(in) :: turn
      real(wp), intent(out), contiguous, target :: y_a(:)
      !! (states) at the start of the rest

      rotation%direction = -before(turn)
      rotation%knows_direction = .true.
      y_a = turn%y
      rest = from(rest, turn%t, y_a)
   end subroutine pass_turn

   !> Return whether a turn is the start of a motion from rest, whose direction is uncertain within
   !> round-off.
   pure logical function is_start(rest, turn)
      type(step_view_t), intent(in) :: rest
      type(ending_t), intent(in) :: turn

      is_start = turn%t <= rest%t_a .and. abs(rest%y_a(2)) <= 0
   end function is_start

   !> Sign of the velocity before a turn.
   pure integer function before(turn)
      type(ending_t), intent(in) :: turn

      before = merge(-1, 1, turn%is_rising)
   end function before

   !> End a monotone piece where the hysteretic force of the frame passes zero, before any other
   !> event.
   !>
   !> Without previous yielding, the force passes zero at the time of an impact. The impact is then
   !> the event, and the next piece sets the signs again.
   subroutine end_at_zero(hybrid, piece, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: piece
      type(ending_t), intent(inout) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(frame_state_t) :: frame
      type(ending_t) :: passage
      real(wp), target :: y_b(size(hybrid%y))
      logical :: is_found

      if (.not. passes_zero(piece%equation, hybrid%y)) return
      y_b = hybrid%y
      frame%n = 1
      frame%states(0) = piece%equation%hysteresis%place
      call find_event(frame, until(piece, hybrid%t, y_b), passage, is_found, error)
      if (allocated(error) .or. .not. is_found) return
      if (passage%t > piece%t_a) then
         if (hybrid%t - passage%t <= 8*spacing(hybrid%t)) return
         if (ending%kind == event_impact .and. piece%equation%state%side*passage%y(1) <= 0) return
      end if
      hybrid%t = passage%t
      hybrid%y(:) = passage%y
      ending = passage
   end subroutine end_at_zero

   !> Return whether the hysteretic force of the frame has changed its sign since the start of the
   !> piece.
   pure logical function passes_zero(equation, y)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      passes_zero = will_pass_zero(equation) &
         .and. equation%state%signs%loading_direction*y(equation%hysteresis%place) > 0
   end function passes_zero

   !> Add the turns inside a piece, which end no step, to the list of events.
   subroutine list_turns(recorder, piece, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(rotation_t) :: rotation
      type(step_view_t) :: rest
      type(ending_t) :: turn
      real(wp), target :: y_a(size(piece%y_a))
      logical :: is_found
      integer :: i

      rotation%n = 1
      rotation%states = [1, 2]
      call leave_base(rotation, piece)
      rest = piece
      do i = 1, most_turns
         if (keeps_direction(rest, rotation%direction) .or. rest%t_a >= rest%t_b) return
         turn = ending_t()
         call find_event(rotation, rest, turn, is_found, error)
         if (allocated(error) .or. .not. is_found) return
         if (.not. is_start(rest, turn)) call observe_event(recorder, event_peak, turn%t, turn%y)
         call pass_turn(rotation, rest, turn, y_a)
      end do
   end subroutine list_turns

end module rwmf_simulation_hybrid_step_events
