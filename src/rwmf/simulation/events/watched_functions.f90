!> Functions of a scene that may end a step, besides the rotation: the one list of them.
!>
!> Each kind shortens the step to its first event: later kinds use one smooth equation. The last
!> event found is the first in time.
module rwmf_simulation_events_watched_functions
   use rwmf_core_error, only: error_t
   use rwmf_simulation_events_drift_events, only: drifts_t
   use rwmf_simulation_events_first_change, only: ending_t, shows_no_event, stop_at_event
   use rwmf_simulation_events_held_wall_lift_off, only: reserve_t
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_simulation_events_storey_events, only: displacements_t, hysteretic_t
   use rwmf_simulation_events_watched_spans, only: functions_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, mode_held
   implicit none
   private

   public :: cut_step, keeps_limits, watches_functions

   integer, parameter :: kinds = 4
   integer, parameter :: first_limit = 3
   !! number of the first kind whose events only end a run or a rest

contains

   !> Return whether a scene has such functions in its present mode.
   pure logical function watches_functions(step, hybrid) result(watches)
      type(step_view_t), intent(in) :: step
      type(hybrid_t), intent(in) :: hybrid

      watches = step%equation%floors%yields .or. hybrid%drifts > 0 .or. hybrid%mode == mode_held
   end function watches_functions

   !> Functions of a kind in the present mode; not allocated if the scene has none.
   subroutine choose_functions(step, hybrid, kind, functions)
      type(step_view_t), intent(in) :: step
      type(hybrid_t), intent(in) :: hybrid
      integer, intent(in) :: kind
      !! from 1 to `kinds`
      class(functions_t), allocatable, intent(out) :: functions
      integer :: n

      n = step%equation%floors%n_storeys
      select case (kind)
      case (1)
         if (step%equation%floors%yields) allocate (displacements_t :: functions)
      case (2)
         if (allocated(step%equation%floors%laws)) allocate (hysteretic_t :: functions)
      case (3)
         n = hybrid%drifts
         if (n > 0) allocate (drifts_t :: functions)
      case default
         n = 2
         if (hybrid%mode == mode_held) allocate (reserve_t :: functions)
      end select
      if (allocated(functions)) functions%n = n
   end subroutine choose_functions

   !> Return whether the ends of a step show that neither a drift nor a held wall ends it.
   logical function keeps_limits(step, hybrid)
      type(step_view_t), intent(in) :: step
      !! step of one part, without an integrator
      type(hybrid_t), intent(in) :: hybrid
      class(functions_t), allocatable :: functions
      integer :: kind

      keeps_limits = .true.
      do kind = first_limit, kinds
         call choose_functions(step, hybrid, kind, functions)
         if (allocated(functions)) keeps_limits = shows_no_event(functions, step)
         if (.not. keeps_limits) return
      end do
   end function keeps_limits

   !> End the last step of the integrator at the first event of the functions, or leave it whole.
   subroutine cut_step(step, hybrid, ending, error)
      type(step_view_t), intent(inout) :: step
      type(hybrid_t), intent(in) :: hybrid
      type(ending_t), intent(out) :: ending
      !! event at the end of the step
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      class(functions_t), allocatable :: functions
      integer :: kind

      if (.not. watches_functions(step, hybrid)) return
      do kind = 1, kinds
         call choose_functions(step, hybrid, kind, functions)
         if (allocated(functions)) call stop_at_event(functions, step, ending, error)
         if (allocated(error)) return
      end do
   end subroutine cut_step

end module rwmf_simulation_events_watched_functions
