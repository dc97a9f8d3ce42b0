!> How far the storeys of a frame have been displaced, where they yield.
module rwmf_simulation_recorder_storey_drifts
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, step_view_t
   use rwmf_simulation_events_storey_events, only: end_at_turn, moment_t, of_drift, &
      sample_storeys, span_of, storey_span_t
   implicit none
   private

   public :: observe_drifts, observe_turns

contains

   !> Let a state take part in the largest displacements.
   subroutine observe_drifts(largest, equation, y)
      real(wp), intent(inout) :: largest(:)
      !! (n) of |u_i - u_(i-1)| so far [m]
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(size(largest))
      real(wp) :: d_dot(size(largest))

      call storey_motion(equation, equation%state%side, y, d, d_dot)
      largest = max(largest, abs(d))
   end subroutine observe_drifts

   !> Let the turns inside a piece of the last step, and its end, take part in them.
   subroutine observe_turns(largest, step, error)
      real(wp), intent(inout) :: largest(:)
      !! (storeys) largest |u_i - u_(i-1)| so far [m]
      type(step_view_t), intent(in) :: step
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(moment_t) :: before, after
      type(storey_span_t) :: span
      integer :: n, i, k

      n = count_parts(step)
      if (n == 1) then
         if (.not. may_turn(largest, step)) return
      end if
      call sample_storeys(step, step%t_a, after, error)
      do i = 1, n
         if (allocated(error)) return
         before = after
         call sample_storeys(step, end_of_part(step, i, n), after, error)
         do k = 1, size(largest)
            if (allocated(error)) return
            span = span_of(step, k, before, after)
            call end_at_turn(span, [-largest(k), largest(k)], error)
            largest(k) = max(largest(k), abs(span%motion(of_drift, 2)))
         end do
      end do
   end subroutine observe_turns

   !> May a storey turn in a short piece, farther out than ever? Lets the end take part.
   logical function may_turn(largest, step)
      real(wp), intent(inout) :: largest(:)
      type(step_view_t), intent(in) :: step
      real(wp), dimension(size(largest), 2) :: d, rate

      call storey_motion(step%equation, step%equation%state%side, step%y_a, d(:, 1), rate(:, 1))
      call storey_motion(step%equation, step%equation%state%side, step%y_b, d(:, 2), rate(:, 2))
      may_turn = any(rate(:, 1)*rate(:, 2) < 0 .and. maxval(abs(d), 2) &
         + (step%t_b - step%t_a)*maxval(abs(rate), 2) > largest)
      largest = max(largest, abs(d(:, 2)))
   end function may_turn

end module rwmf_simulation_recorder_storey_drifts
