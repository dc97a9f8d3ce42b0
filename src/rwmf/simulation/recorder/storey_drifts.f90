!> How far the storeys of a frame have been displaced, where they yield.
module rwmf_simulation_recorder_storey_drifts
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_effects_storeys_yielding_storeys, only: storey_motion
   use rwmf_simulation_events_event_time, only: count_parts
   use rwmf_simulation_events_storey_events, only: find_turn, moment_t, of_drift, sample_storeys
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

      call storey_motion(equation, y, d, d_dot)
      largest = max(largest, abs(d))
   end subroutine observe_drifts

   !> Let the turns inside a piece of the last step, and its end, take part in them.
   subroutine observe_turns(largest, equation, integrator, t_b, y_b, error)
      real(wp), intent(inout) :: largest(:)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: t_b
      !! end of the piece [s]
      real(wp), intent(in) :: y_b(:)
      !! (states) there
      type(error_t), allocatable, intent(out) :: error
      type(moment_t) :: before
      type(moment_t) :: after
      type(moment_t) :: turn
      integer :: n, i, k

      n = count_parts(equation, integrator%t0, t_b)
      if (n == 1) then
         if (.not. may_turn(largest, equation, integrator, t_b, y_b)) return
      end if
      call sample_storeys(equation, integrator, integrator%t0, after, error)
      do i = 1, n
         if (allocated(error)) return
         before = after
         call sample_storeys(equation, integrator, min(t_b, integrator%t0 + i*((t_b - &
            integrator%t0)/n)), after, &
            error)
         do k = 1, size(largest)
            if (allocated(error)) return
            call find_turn(equation, integrator, k, before, after, -largest(k), largest(k), turn, &
               error)
            if (.not. allocated(error)) largest(k) = max(largest(k), abs(turn%motion(k, of_drift)))
         end do
      end do
   end subroutine observe_turns

   !> May a storey turn in a short piece, farther out than ever? Lets the end take part.
   logical function may_turn(largest, equation, integrator, t_b, y_b)
      real(wp), intent(inout) :: largest(:)
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(in) :: integrator
      real(wp), intent(in) :: t_b
      !! end of the piece [s]
      real(wp), intent(in) :: y_b(:)
      !! (states) there
      real(wp) :: d(size(largest), 2)
      real(wp) :: rate(size(largest), 2)

      call storey_motion(equation, integrator%y0, d(:, 1), rate(:, 1))
      call storey_motion(equation, y_b, d(:, 2), rate(:, 2))
      may_turn = any(rate(:, 1)*rate(:, 2) < 0 .and. maxval(abs(d), 2) &
         + (t_b - integrator%t0)*maxval(abs(rate), 2) > largest)
      largest = max(largest, abs(d(:, 2)))
   end function may_turn

end module rwmf_simulation_recorder_storey_drifts
