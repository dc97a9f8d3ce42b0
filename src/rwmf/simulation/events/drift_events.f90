!> Drifts with a collapse limit, as watched functions of a step.
module rwmf_simulation_events_drift_events
   use rwmf_core_kinds, only: wp
   use rwmf_model_drift_limits, only: drift_ratios
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_simulation_events_watched_spans, only: functions_t, span_t, watch_t
   use rwmf_simulation_state_result, only: event_collapsed
   implicit none
   private

   public :: drifts_t, has_collapsed

   !> Ratios of the drifts to their limits [-], with their rates.
   type, extends(functions_t) :: drifts_t
   contains
      procedure :: evaluate => evaluate_drifts
      procedure :: watches => watch_drift
   end type drifts_t

contains

   !> Evaluate the ratios of the drifts to their limits at a state.
   subroutine evaluate_drifts(self, t, y, f)
      class(drifts_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)

      allocate (f(self%n, 0:1))
      call drift_ratios(self%step%equation, y, f(:, 0), f(:, 1))
   end subroutine evaluate_drifts

   !> Declare the limits of a drift on both sides.
   function watch_drift(self, i, span) result(watches)
      class(drifts_t), intent(in) :: self
      integer, intent(in) :: i
      !! number of the drift
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)

      watches = [watch_t(i, 0, level=-1.0_wp, kind=event_collapsed), &
         watch_t(i, 0, level=1.0_wp, side=-1.0_wp, kind=event_collapsed)]
   end function watch_drift

   !> Return whether a drift is at its limit or beyond it.
   logical function has_collapsed(equation, n, y)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: n
      !! number of drifts with a limit; 0 excludes collapse
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: ratio(n), rate(n)

      has_collapsed = .false.
      if (n == 0) return
      call drift_ratios(equation, y, ratio, rate)
      has_collapsed = any(abs(ratio) >= 1)
   end function has_collapsed

end module rwmf_simulation_events_drift_events
