!> Search of the integrator's last step for the events that it contains, in the order of time.
!>
!> Peaks (theta' = 0) split the step into monotone pieces; in each of them a return to theta = 0 or
!> a passage of the overturning angle shows by the values at its ends.
module rwmf_simulation_events_step_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_model_assembly, only: equation_t, interval_of
   use rwmf_model_hysteresis_bouc_wen, only: will_pass_zero
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_simulation_events_event_time, only: count_parts, find_event_time, find_reversal
   use rwmf_simulation_hybrid_state, only: hybrid_t, mode_rocking
   use rwmf_simulation_recorder_recorder, only: observe_event, observe_state, recorder_t
   use rwmf_simulation_result, only: event_branch, event_impact, event_overturned, event_passage, &
      event_peak
   implicit none
   private

   public :: search_step

contains

   !> Search the integrator's last step; leaves time and state of its end or of the event in hybrid.
   subroutine search_step(hybrid, equation, integrator, recorder, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      integer, intent(out) :: event
      !! `event_impact`, `event_overturned`, `event_branch`, `event_peak` (only where a spring
      !! unloads there), `event_passage`, or 0
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_a
      real(wp) :: t_b
      real(wp) :: y_a(equation%n)
      real(wp) :: y_b(equation%n)
      integer :: n
      integer :: i

      event = 0
      if (is_quiet(hybrid, equation, integrator)) then
         hybrid%t = integrator%t1
         hybrid%y(:) = integrator%y1
         return
      end if
      n = count_parts(equation, integrator%t0, integrator%t1)
      t_a = integrator%t0
      y_a = integrator%y0
      do i = 1, n
         t_b = integrator%t1
         y_b = integrator%y1
         if (i < n) then
            t_b = integrator%t0 + i*((integrator%t1 - integrator%t0)/n)
            call integrator%state_at(t_b, y_b, error)
            if (allocated(error)) return
         end if
         call search_part(hybrid, equation, integrator, recorder, t_a, y_a, t_b, y_b, event, error)
         if (allocated(error) .or. event /= 0) return
         t_a = t_b
         y_a = y_b
      end do
   end subroutine search_step

   !> Is it plain from the ends of the step that nothing happens in it? Most steps of a multistep
   !> method are so short that the velocity hardly changes, under a motion that is monotone.
   !>
   !> A ground acceleration that changes its sign may take the velocity below zero and back to what
   !> it was: then the way is shorter than such a velocity says, by two thirds when the velocity is
   !> a parabola that touches zero.
   logical function is_quiet(hybrid, equation, integrator)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(in) :: integrator
      real(wp) :: change
      real(wp) :: least
      real(wp) :: way
      !! in the direction of the velocity [rad] or [m]

      change = abs(integrator%y1(2) - integrator%y0(2))
      least = min(abs(integrator%y0(2)), abs(integrator%y1(2)))
      way = sign(1.0_wp, integrator%y0(2))*(integrator%y1(1) - integrator%y0(1))
      is_quiet = 2*change < least .and. 2*way > (integrator%t1 - integrator%t0)*least
      if (is_quiet .and. equation%has_wall) then
         is_quiet = abs(integrator%y1(1)) < hybrid%overturning_angle
         if (hybrid%mode == mode_rocking) then
            is_quiet = is_quiet .and. equation%side*integrator%y0(1) > 0 &
               .and. equation%side*integrator%y1(1) > 0
         end if
      end if
      if (is_quiet .and. equation%has_bilinear_springs) then
         is_quiet = integrator%y1(1) < equation%high .and. integrator%y1(1) > equation%low
      end if
      if (is_quiet .and. equation%has_loading_direction) is_quiet = .not. passes_zero(equation, &
         integrator%y1)
      if (is_quiet .and. equation%has_frame) then
         is_quiet = 2*(integrator%t1 - integrator%t0)*max(equation%p%omega_s, &
            equation%max_frequency) < 1
      end if
      if (is_quiet) then
         is_quiet = turning_point(equation%motion, interval_of(equation), integrator%t0) >= &
            integrator%t1
      end if
   end function is_quiet

   !> Search a part of the step in which theta' changes its sign at most twice.
   subroutine search_part(hybrid, equation, integrator, recorder, t_a, y_a, t_b, y_b, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_a
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(in) :: t_b
      real(wp), intent(in) :: y_b(:)
      integer, intent(out) :: event
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_m
      real(wp) :: y_m(size(y_a))
      logical :: turns_twice

      event = 0
      t_m = t_a
      y_m = y_a
      if (.not. has_peak(hybrid, equation, y_a, y_b)) then
         call find_reversal(equation, integrator, t_a, y_a, t_b, y_b, t_m, y_m, turns_twice, error)
         if (allocated(error)) return
         if (turns_twice) then
            call search_span(hybrid, equation, integrator, recorder, t_a, y_a, t_m, y_m, event, &
               error)
            if (allocated(error) .or. event /= 0) return
         else
            t_m = t_a
            y_m = y_a
         end if
      end if
      call search_span(hybrid, equation, integrator, recorder, t_m, y_m, t_b, y_b, event, error)
   end subroutine search_part

   !> Search a span in which theta' changes its sign at most once.
   subroutine search_span(hybrid, equation, integrator, recorder, t_a, y_a, t_b, y_b, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_a
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(in) :: t_b
      real(wp), intent(in) :: y_b(:)
      integer, intent(out) :: event
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_peak
      real(wp) :: y_peak(size(y_a))
      logical :: turns

      t_peak = t_a
      y_peak = y_a
      turns = has_peak(hybrid, equation, y_a, y_b)
      if (turns) turns = .not. stands_still(equation, y_a, y_b)
      if (turns) then
         call find_event_time(equation, integrator, 2, 0.0_wp, t_a, y_a, t_b, y_b, t_peak, &
            y_peak, error)
         if (allocated(error)) return
         hybrid%t = t_peak
         hybrid%y(:) = y_peak
         call end_piece(hybrid, equation, integrator, t_a, y_a, event, error)
         if (equation%has_loading_direction .and. .not. allocated(error)) then
            call end_at_zero(hybrid, equation, integrator, t_a, y_a, event, error)
         end if
         if (allocated(error) .or. event /= 0) return
         call observe_state(recorder, equation, t_peak, y_peak)
         call observe_event(recorder, event_peak, t_peak, y_peak)
         if (equation%ends_at_peak) then
            event = event_peak
            return
         end if
      end if
      hybrid%t = t_b
      hybrid%y(:) = y_b
      call end_piece(hybrid, equation, integrator, t_peak, y_peak, event, error)
      if (equation%has_loading_direction .and. .not. allocated(error)) then
         call end_at_zero(hybrid, equation, integrator, t_peak, y_peak, event, error)
      end if
   end subroutine search_span

   !> Does theta' change its sign between two states? A flight that starts with theta' = 0 moves
   !> away from the base.
   logical function has_peak(hybrid, equation, y_a, y_b)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(in) :: y_b(:)
      real(wp) :: v_a

      v_a = y_a(2)
      if (abs(v_a) <= 0 .and. equation%has_loading_direction) v_a = equation%loading_direction
      if (abs(v_a) <= 0 .and. abs(y_a(1)) <= 0 .and. hybrid%mode == mode_rocking) then
         v_a = equation%side
      end if
      has_peak = (v_a > 0 .and. y_b(2) <= 0) .or. (v_a < 0 .and. y_b(2) >= 0)
   end function has_peak

   !> A frame that stands still has a course, the last one, and no peaks.
   pure logical function stands_still(equation, y_a, y_b)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(in) :: y_b(:)

      stands_still = equation%has_loading_direction .and. max(abs(y_a(2)), abs(y_b(2))) <= 0
   end function stands_still

   !> A monotone piece from (t_a, y_a) to the time and state in hybrid: does the hysteretic force of
   !> the frame pass zero in it? The piece ends there, before whatever else was found.
   !>
   !> As long as nothing has yielded it does so in the instant of an impact: then the impact is what
   !> happens, after which the signs of the next piece are looked at anyway.
   subroutine end_at_zero(hybrid, equation, integrator, t_a, y_a, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: t_a
      real(wp), intent(in) :: y_a(:)
      integer, intent(inout) :: event
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_b
      real(wp) :: y_b(size(y_a))

      if (.not. passes_zero(equation, hybrid%y)) return
      ! z is monotone where theta is: it has passed zero once
      t_b = hybrid%t
      y_b = hybrid%y
      if (passes_zero(equation, y_a)) then
         hybrid%t = t_a
         hybrid%y(:) = y_a
      else
         call find_event_time(equation, integrator, equation%hysteresis%place, 0.0_wp, t_a, y_a, &
            t_b, y_b, &
            hybrid%t, hybrid%y, error)
         if (allocated(error)) return
         if (t_b - hybrid%t <= 8*spacing(t_b) .or. (event == event_impact &
             .and. equation%side*hybrid%y(1) <= 0)) then
            hybrid%t = t_b
            hybrid%y(:) = y_b
            return
         end if
      end if
      event = event_passage
      hybrid%y(equation%hysteresis%place) = 0
   end subroutine end_at_zero

   !> Has the hysteretic force of the frame changed its sign since the piece of motion began?
   pure logical function passes_zero(equation, y)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      passes_zero = will_pass_zero(equation) &
         .and. equation%loading_direction*y(equation%hysteresis%place) > 0
   end function passes_zero

   !> A monotone piece from (t_a, y_a) to the time and state in hybrid: does the flight end in it,
   !> or does a spring enter another branch?
   subroutine end_piece(hybrid, equation, integrator, t_a, y_a, event, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: t_a
      real(wp), intent(in) :: y_a(:)
      integer, intent(out) :: event
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: level
      real(wp) :: t_b
      real(wp) :: y_b(size(y_a))

      event = 0
      level = 0
      if (equation%has_bilinear_springs) then
         ! The limits of a spring without strength coincide: only the motion tells them apart.
         hybrid%is_rising = hybrid%y(1) > y_a(1)
         if (leaves_window(hybrid, equation, y_a, level)) event = event_branch
      end if
      if (event == 0) then
         if (hybrid%mode == mode_rocking .and. equation%side*hybrid%y(1) < 0) then
            event = event_impact
         else if (equation%has_wall .and. abs(hybrid%y(1)) >= hybrid%overturning_angle) then
            event = event_overturned
            level = sign(hybrid%overturning_angle, hybrid%y(1))
         else
            return
         end if
      end if
      if (event == event_branch .and. abs(level - y_a(1)) <= 0) then
         hybrid%t = t_a
         hybrid%y(:) = y_a
         return
      end if
      t_b = hybrid%t
      y_b = hybrid%y
      call find_event_time(equation, integrator, 1, level, t_a, y_a, t_b, y_b, hybrid%t, &
         hybrid%y, error)
      hybrid%y(1) = level
   end subroutine end_piece

   !> Does a monotone piece leave the rotations for which the branches of the springs hold, before
   !> it comes to an impact or overturns?
   logical function leaves_window(hybrid, equation, y_a, level) result(leaves)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y_a(:)
      real(wp), intent(out) :: level
      !! where it leaves them, not outside of the piece [rad] or [m]

      level = 0
      if (hybrid%y(1) > y_a(1)) then
         leaves = hybrid%y(1) > equation%high
         if (leaves) level = max(equation%high, y_a(1))
      else
         leaves = hybrid%y(1) < equation%low
         if (leaves) level = min(equation%low, y_a(1))
      end if
      if (.not. leaves) return
      if (hybrid%mode == mode_rocking) leaves = equation%side*level >= 0
      if (equation%has_wall) leaves = leaves .and. abs(level) < hybrid%overturning_angle
      if (.not. leaves) level = 0
   end function leaves_window

end module rwmf_simulation_events_step_events
