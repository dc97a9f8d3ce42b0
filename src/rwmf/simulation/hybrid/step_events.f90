!> Search of the integrator's last step for its events, in chronological order.
!>
!> Peaks (theta' = 0) split the step into monotone pieces. The values at the ends of each piece then
!> show a return to theta = 0 or a passage of the overturning angle.
module rwmf_simulation_hybrid_step_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen, only: will_pass_zero
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_lift_off, only: find_uplift_acceleration
   use rwmf_simulation_events_event_time, only: find_event_time
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, from, &
      sample_state, step_view_t, until
   use rwmf_simulation_events_turns, only: farthest_turn, keeps_direction, split_turns
   use rwmf_simulation_events_watched_functions, only: cut_step
   use rwmf_simulation_hybrid_transitions, only: observe_peak
   use rwmf_simulation_recorder_recorder, only: observe_event, recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, mode_held, mode_rocking
   use rwmf_simulation_state_result, only: event_branch, event_impact, event_overturned, &
      event_passage, event_peak
   implicit none
   private

   public :: search_step, list_turns

   integer, parameter :: most_spans = 20
   !! largest number of spans in a part of a step; more turns are round-off

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
      real(wp), dimension(size(step%y_a)), target :: y_a, y_b
      type(step_view_t) :: part
      type(ending_t) :: rotation
      integer :: i, n

      call cut_step(step, hybrid, ending, error)
      if (allocated(error)) return
      if (hybrid%mode == mode_held) then
         call stay_on_base(hybrid, step)
         return
      end if
      if (is_quiet(hybrid, step)) then
         hybrid%t = step%t_b
         hybrid%y(:) = step%y_b
         return
      end if
      n = count_parts(step)
      y_a = step%y_a
      part = until(from(step, step%t_a, y_a), step%t_b, y_b)
      do i = 1, n
         part%t_b = end_of_part(step, i, n)
         call sample_state(step, part%t_b, y_b, error)
         if (allocated(error)) return
         call search_part(hybrid, part, recorder, rotation, error)
         if (allocated(error)) return
         if (rotation%kind /= 0) then
            ending = rotation
            return
         end if
         part%t_a = part%t_b
         y_a = y_b
      end do
   end subroutine search_step

   !> Store the end of a step of a wall held on its base.
   subroutine stay_on_base(hybrid, step)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: step

      hybrid%t = step%t_b
      hybrid%y(:) = step%y_b
      ! an implicit method solves for all states together and leaves round-off in the held ones
      hybrid%y(:2) = 0
      call find_uplift_acceleration(step%equation%model_t, step%equation%state, hybrid%y)
   end subroutine stay_on_base

   !> Return whether the ends of the step exclude any event in it.
   logical function is_quiet(hybrid, step)
      type(hybrid_t), intent(in) :: hybrid
      type(step_view_t), intent(in) :: step

      associate (equation => step%equation, a => step%y_a, b => step%y_b)
         is_quiet = keeps_direction(step)
         if (is_quiet .and. equation%has_wall) then
            is_quiet = abs(b(1)) < hybrid%overturning_angle
            if (hybrid%mode == mode_rocking) then
               is_quiet = is_quiet .and. equation%state%side*a(1) > 0 &
                  .and. equation%state%side*b(1) > 0
            end if
         end if
         if (is_quiet) is_quiet = b(1) < equation%state%high .and. b(1) > equation%state%low
         if (is_quiet .and. equation%has_loading_direction) is_quiet = .not. passes_zero( &
            equation, b)
      end associate
   end function is_quiet

   !> Search a part of the step, in spans with at most one sign change of theta'.
   subroutine search_part(hybrid, part, recorder, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: part
      type(recorder_t), intent(inout) :: recorder
      type(ending_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(step_view_t) :: rest
      real(wp) :: t_m
      real(wp), dimension(size(part%y_a)), target :: y_a, y_m
      logical :: is_split
      integer :: i

      rest = part
      do i = 1, most_spans
         call split_turns(rest, direction_of(hybrid, rest), t_m, y_m, is_split, error)
         if (allocated(error) .or. .not. is_split) exit
         call search_span(hybrid, until(rest, t_m, y_m), recorder, ending, error)
         if (allocated(error) .or. ending%kind /= 0) return
         y_a = y_m
         rest = from(rest, t_m, y_a)
      end do
      if (.not. allocated(error)) call search_span(hybrid, rest, recorder, ending, error)
   end subroutine search_part

   !> Search a span with at most one sign change of theta'.
   subroutine search_span(hybrid, span, recorder, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: span
      type(recorder_t), intent(inout) :: recorder
      type(ending_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_peak
      real(wp), target :: y_peak(size(span%y_a))
      logical :: is_plain

      if (.not. has_peak(hybrid, span) .or. stands_still(span)) then
         call search_piece(hybrid, span, ending, error)
         return
      end if
      is_plain = turns_inside(hybrid, span)
      if (is_plain) then
         call search_piece(hybrid, span, ending, error)
         if (allocated(error)) return
         if (.not. recorder%keeps_events) then
            if (.not. may_be_extreme(recorder, span)) return
         end if
      end if
      call find_event_time(span, 2, 0.0_wp, t_peak, y_peak, error)
      if (allocated(error)) return
      if (.not. is_plain) call search_piece(hybrid, until(span, t_peak, y_peak), ending, error)
      if (allocated(error) .or. (ending%kind /= 0 .and. .not. is_plain)) return
      call observe_peak(hybrid, span%equation, recorder, span%y_a(2), t_peak, y_peak)
      if (is_plain) return
      if (span%equation%state%ends_at_peak) then
         ending%kind = event_peak
      else
         call search_piece(hybrid, from(span, t_peak, y_peak), ending, error)
      end if
   end subroutine search_span

   !> Return whether the turn of a span certainly lies inside all limits. The search for a later
   !> event then does not need the turn.
   pure logical function turns_inside(hybrid, span) result(is_inside)
      type(hybrid_t), intent(in) :: hybrid
      type(step_view_t), intent(in) :: span
      real(wp) :: low, high, turn

      associate (equation => span%equation, state => span%equation%state)
         is_inside = .false.
         if (state%ends_at_peak .or. equation%has_loading_direction) return
         ! from a limit of the window, only the turn shows whether the motion leaves it
         if (span%y_a(1) <= state%low .or. span%y_a(1) >= state%high) return
         low = -huge(low)
         high = huge(high)
         if (equation%has_wall) high = hybrid%overturning_angle
         if (equation%has_wall) low = -high
         if (hybrid%mode == mode_rocking .and. state%side > 0) low = 0
         if (hybrid%mode == mode_rocking .and. state%side < 0) high = 0
         turn = farthest_turn(span)
         is_inside = turn < min(high, state%high) .and. turn > max(low, state%low)
      end associate
   end function turns_inside

   !> Return whether the turn of a span may be the largest rotation so far on its side.
   pure logical function may_be_extreme(recorder, span)
      type(recorder_t), intent(in) :: recorder
      type(step_view_t), intent(in) :: span
      real(wp) :: turn

      turn = farthest_turn(span)
      may_be_extreme = turn >= recorder%theta_max .or. turn <= recorder%theta_min
   end function may_be_extreme

   !> Search a piece with monotone theta; store time and state of its end or of the event in hybrid.
   subroutine search_piece(hybrid, piece, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: piece
      type(ending_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error

      hybrid%t = piece%t_b
      hybrid%y(:) = piece%y_b
      call end_piece(hybrid, piece, ending, error)
      if (piece%equation%has_loading_direction .and. .not. allocated(error)) then
         call end_at_zero(hybrid, piece, ending, error)
      end if
   end subroutine search_piece

   !> Return whether theta' changes its sign between the ends of a span.
   logical function has_peak(hybrid, span)
      type(hybrid_t), intent(in) :: hybrid
      type(step_view_t), intent(in) :: span

      associate (v_a => direction_of(hybrid, span), v_b => span%y_b(2))
         has_peak = (v_a > 0 .and. v_b <= 0) .or. (v_a < 0 .and. v_b >= 0)
      end associate
   end function has_peak

   !> Sign of theta' at the start of a span, 0 if unknown. A flight that starts with theta' = 0
   !> moves away from the base.
   pure real(wp) function direction_of(hybrid, span) result(direction)
      type(hybrid_t), intent(in) :: hybrid
      type(step_view_t), intent(in) :: span

      associate (equation => span%equation)
         direction = span%y_a(2)
         if (abs(direction) > 0) return
         if (equation%has_loading_direction) direction = equation%state%signs%loading_direction
         if (abs(direction) <= 0 .and. abs(span%y_a(1)) <= 0 .and. hybrid%mode == mode_rocking) then
            direction = equation%state%side
         end if
      end associate
   end function direction_of

   !> Return whether a frame is at standstill. It keeps its last loading direction and has no peaks.
   pure logical function stands_still(span)
      type(step_view_t), intent(in) :: span

      stands_still = span%equation%has_loading_direction &
         .and. max(abs(span%y_a(2)), abs(span%y_b(2))) <= 0
   end function stands_still

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
      real(wp) :: t_b
      real(wp), target :: y_b(size(hybrid%y))

      associate (equation => piece%equation, place => piece%equation%hysteresis%place)
         if (.not. passes_zero(equation, hybrid%y)) return
         ! z is monotone if theta is, so it passes zero once
         t_b = hybrid%t
         y_b = hybrid%y
         if (passes_zero(equation, piece%y_a)) then
            hybrid%t = piece%t_a
            hybrid%y(:) = piece%y_a
         else
            call find_event_time(until(piece, t_b, y_b), place, 0.0_wp, hybrid%t, hybrid%y, error)
            if (allocated(error)) return
            if (t_b - hybrid%t <= 8*spacing(t_b) .or. (ending%kind == event_impact &
                .and. equation%state%side*hybrid%y(1) <= 0)) then
               hybrid%t = t_b
               hybrid%y(:) = y_b
               return
            end if
         end if
         ending%kind = event_passage
         hybrid%y(place) = 0
      end associate
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

   !> Search a monotone piece for the end of the flight or for a branch end of a spring.
   subroutine end_piece(hybrid, piece, ending, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: piece
      type(ending_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: level

      level = 0
      associate (equation => piece%equation, theta_a => piece%y_a(1), theta_b => piece%y_b(1))
         ! The two limits of a spring without strength coincide; the direction of motion selects
         ! one.
         ending%is_rising = theta_b > theta_a
         if (leaves_window(hybrid, equation, theta_a, theta_b, level)) ending%kind = event_branch
         if (ending%kind == 0) then
            if (hybrid%mode == mode_rocking .and. equation%state%side*theta_b < 0 &
                .and. .not. leaves_base(piece)) then
               ending%kind = event_impact
            else if (equation%has_wall .and. abs(theta_b) >= hybrid%overturning_angle) then
               ending%kind = event_overturned
               level = sign(hybrid%overturning_angle, theta_b)
            else
               return
            end if
         end if
         if (ending%kind == event_branch .and. abs(level - theta_a) <= 0) then
            hybrid%t = piece%t_a
            hybrid%y(:) = piece%y_a
            return
         end if
      end associate
      call find_event_time(piece, 1, level, hybrid%t, hybrid%y, error)
      hybrid%y(1) = level
   end subroutine end_piece

   !> Return whether a wall leaves its base in a monotone piece. The first rotations after lift-off
   !> are below the tolerance of a method and may have either sign.
   pure logical function leaves_base(piece)
      type(step_view_t), intent(in) :: piece

      associate (side => piece%equation%state%side, a => piece%y_a, b => piece%y_b)
         leaves_base = side*a(1) <= 0 .and. side*a(2) >= 0 .and. side*b(2) > 0
      end associate
   end function leaves_base

   !> Return whether a monotone piece leaves the window of the current branches before an impact or
   !> overturning.
   logical function leaves_window(hybrid, equation, theta_a, theta_b, level) result(leaves)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta_a, theta_b
      real(wp), intent(out) :: level
      !! limit of the window, not outside of the piece [rad] or [m]

      level = 0
      if (theta_b > theta_a) then
         leaves = theta_b > equation%state%high
         if (leaves) level = max(equation%state%high, theta_a)
      else
         leaves = theta_b < equation%state%low
         if (leaves) level = min(equation%state%low, theta_a)
      end if
      if (.not. leaves) return
      if (hybrid%mode == mode_rocking) leaves = equation%state%side*level >= 0
      if (equation%has_wall) leaves = leaves .and. abs(level) < hybrid%overturning_angle
      if (.not. leaves) level = 0
   end function leaves_window

   !> Add the turns inside a piece, which end no step, to the list of events.
   subroutine list_turns(recorder, piece, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(step_view_t) :: rest
      real(wp), dimension(size(piece%y_a)), target :: y_a, y
      real(wp) :: t
      logical :: is_split
      integer :: k

      rest = piece
      do k = 1, most_spans
         call split_turns(rest, rest%y_a(2), t, y, is_split, error)
         if (allocated(error)) return
         if (.not. is_split) exit
         call list_turn(recorder, until(rest, t, y), error)
         if (allocated(error)) return
         y_a = y
         rest = from(rest, t, y_a)
      end do
      call list_turn(recorder, rest, error)
   end subroutine list_turns

   !> Add the turn of a span with at most one turn to the list of events.
   subroutine list_turn(recorder, span, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: span
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(size(span%y_a))
      real(wp) :: t

      if (span%y_a(2)*span%y_b(2) >= 0) return
      call find_event_time(span, 2, 0.0_wp, t, y, error)
      if (.not. allocated(error)) call observe_event(recorder, event_peak, t, y)
   end subroutine list_turn

end module rwmf_simulation_hybrid_step_events
