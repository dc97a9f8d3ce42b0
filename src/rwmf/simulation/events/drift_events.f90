!> Time at which a drift exceeds its collapse limit inside the last step of an integrator.
!>
!> Drifts are not functions of the rotation alone, so the search uses all states. It ends the step
!> at the first passage. Later searches then cover only the part before the collapse.
module rwmf_simulation_events_drift_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_drift_limits, only: drift_ratios
   use rwmf_simulation_events_first_change, only: are_quiet, functions_t, moment_t, &
      sample_functions, span_between, span_t, stop_at_first, watch_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, sample_state, step_view_t
   use rwmf_simulation_events_storey_events, only: is_quiet, stop_at_storey, storey_end_t
   implicit none
   private

   public :: cut_step, has_collapsed, is_uncut

   !> Ratios of the drifts to their limits [-], with their rates.
   type, extends(functions_t) :: drifts_t
      integer :: n
      !! number of drifts with a limit
   contains
      procedure :: evaluate => evaluate_drifts
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

   !> Return whether the ends of a step suffice to show that `cut_step` leaves it whole.
   logical function is_uncut(step, n)
      type(step_view_t), intent(in) :: step
      !! step without an integrator
      integer, intent(in) :: n
      !! number of drifts with a limit
      type(drifts_t) :: drifts
      type(moment_t) :: a, b

      is_uncut = count_parts(step) == 1
      if (is_uncut .and. step%equation%floors%yields) is_uncut = is_quiet(step)
      if (.not. is_uncut .or. n == 0) return
      drifts%step = step
      drifts%n = n
      a%t = step%t_a
      b%t = step%t_b
      call drifts%evaluate(a%t, step%y_a, a%f)
      call drifts%evaluate(b%t, step%y_b, b%f)
      is_uncut = are_quiet(span_between(drifts, a, b), limits_of(n))
   end function is_uncut

   !> Limits of the drifts on both sides.
   pure function limits_of(n) result(watches)
      integer, intent(in) :: n
      !! number of drifts with a limit
      type(watch_t) :: watches(2*n)
      integer :: i

      do i = 1, n
         watches(2*i - 1) = watch_t(i, 0, level=-1.0_wp)
         watches(2*i) = watch_t(i, 0, level=1.0_wp, side=-1.0_wp)
      end do
   end function limits_of

   !> End the last step of the integrator at the first branch end of a storey, or at an earlier
   !> collapse.
   subroutine cut_step(step, drifts, ending, error)
      type(step_view_t), intent(inout) :: step
      integer, intent(in) :: drifts
      !! number of drifts with a limit
      type(storey_end_t), intent(out) :: ending
      !! event at the end of the step
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails

      if (step%equation%floors%yields) call stop_at_storey(step, ending, error)
      if (allocated(error) .or. drifts == 0) return
      call stop_at_collapse(step, drifts, ending, error)
   end subroutine cut_step

   !> End a step where the first drift exceeds its limit.
   subroutine stop_at_collapse(step, n, ending, error)
      type(step_view_t), intent(inout) :: step
      integer, intent(in) :: n
      !! number of drifts with a limit, > 0
      type(storey_end_t), intent(inout) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(drifts_t) :: drifts
      type(moment_t) :: a, b
      type(span_t) :: span
      integer :: parts, i, which

      drifts%step = step
      drifts%n = n
      parts = count_parts(step)
      call sample_functions(drifts, step%t_a, b, error)
      do i = 1, parts
         a = b
         if (.not. allocated(error)) call sample_functions(drifts, end_of_part(step, i, parts), b, &
            error)
         if (allocated(error)) return
         span = span_between(drifts, a, b)
         call stop_at_first(drifts, limits_of(n), span, which, error)
         if (allocated(error)) return
         if (which > 0) ending = storey_end_t((which + 1)/2, span%b%t, collapses=.true.)
         if (ending%collapses) exit
      end do
      if (ending%collapses) call shorten(step, ending%t, error)
   end subroutine stop_at_collapse

   !> Shorten the last step of the integrator to a time inside it.
   subroutine shorten(step, t, error)
      type(step_view_t), intent(inout) :: step
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(size(step%y_a))

      call sample_state(step, t, y, error)
      if (allocated(error)) return
      step%t_b = t
      step%integrator%t1 = t
      step%integrator%y1(:) = y
   end subroutine shorten

end module rwmf_simulation_events_drift_events
