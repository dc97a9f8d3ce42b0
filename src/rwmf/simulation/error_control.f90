!> Runs to a requested accuracy, with an error estimate.
!>
!> The estimate compares the peak of a run with the peak of a tighter run. The difference equals the
!> error of the first run, up to the much smaller error of the second. The first run is therefore
!> the result, because its true error is estimated.
!>
!> The samples of a record may limit the steps of both runs, which would then be identical. The
!> second run therefore uses shorter intervals (`refined_motion`).
module rwmf_simulation_error_control
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_motion_ground_motion, only: motion_t, refined_motion
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_peak, only: ask_for_peak, peak_of
   use rwmf_simulation_run, only: run_once
   use rwmf_simulation_state_history, only: history_t
   use rwmf_simulation_state_result, only: add_warning, ending_name, result_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: run_to_accuracy, verify_run
   public :: first_tolerance, next_tolerance, is_close_enough, verifying_tolerance
   public :: relative_change, most_refinements, refinement, tightest

   real(wp), parameter :: tighter = 0.03_wp
   !! ratio of the tolerances of the two compared runs
   real(wp), parameter :: loosest = 1.0e-2_wp
   real(wp), parameter :: tightest = 1.0e-14_wp
   !! below this value round-off governs (double precision)
   integer, parameter :: most_refinements = 12
   integer, parameter :: refinement = 2
   !! number of parts of each interval of the motion in a verifying run

contains

   !> Tighten the tolerance until the estimated relative error of the peak is small enough.
   !>
   !> If the requested accuracy is out of reach, return the best run with its estimate and a
   !> warning.
   subroutine run_to_accuracy(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      !! with `solver%accuracy`
      type(motion_t), intent(in), target :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(result_t) :: tight
      type(history_t), allocatable :: history
      type(case_t) :: trial
      type(motion_t), target :: refined
      real(wp) :: spent, found
      integer :: i

      trial = case
      trial%solver%rtol = first_tolerance(case%solver%accuracy)
      call run_once(trial, motion, control, result, error)
      if (allocated(error)) return
      spent = result%seconds
      found = -1
      do i = 1, most_refinements
         trial%solver%rtol = next_tolerance(case%solver%accuracy, result%rtol, found)
         refined = refined_motion(motion, 1 + i)
         call run_once(trial, refined, control, tight, error)
         if (allocated(error)) return
         spent = spent + tight%seconds
         found = relative_difference(case, result, tight)
         if (is_close_enough(found, case%solver%accuracy)) exit
         if (trial%solver%rtol <= tightest) exit
         ! move the history: it can be the largest array
         call move_alloc(tight%history, history)
         result = tight
         call move_alloc(history, result%history)
      end do
      if (found > 0) result%estimated_relative_error = found
      result%estimate_seconds = spent - result%seconds
      if (found > case%solver%accuracy) then
         call add_warning(result, 'the accuracy asked for, ' &
            //trim(real_to_text(case%solver%accuracy))//', cannot be delivered: estimated error ' &
            //trim(real_to_text(found))//' at the tightest tolerance')
      end if
   end subroutine run_to_accuracy

   !> Tolerance of the run for comparison: much tighter, and reduced further by the last error
   !> estimate.
   elemental real(wp) function next_tolerance(accuracy, present, estimate) result(rtol)
      real(wp), intent(in) :: accuracy
      !! requested relative error of the result [-]
      real(wp), intent(in) :: present
      !! tolerance of the result [-]
      real(wp), intent(in) :: estimate
      !! estimated relative error of the result; not positive if unknown [-]

      rtol = present*tighter
      if (estimate > 0) rtol = rtol*min(1.0_wp, accuracy/estimate)
      rtol = max(tightest, rtol)
   end function next_tolerance

   !> Tolerance of the first run for a requested accuracy.
   pure real(wp) function first_tolerance(accuracy) result(rtol)
      real(wp), intent(in) :: accuracy
      !! requested relative error of the result [-]

      rtol = min(loosest, max(tightest, 0.5_wp*accuracy))
   end function first_tolerance

   !> Return whether an estimated error is below the requested accuracy, with a margin for the error
   !> of the estimate itself.
   elemental logical function is_close_enough(estimate, accuracy)
      real(wp), intent(in) :: estimate
      !! estimated relative error of the result [-]
      real(wp), intent(in) :: accuracy
      !! requested relative error of the result [-]

      is_close_enough = estimate <= 0.7_wp*accuracy
   end function is_close_enough

   !> Tolerance of the verifying run.
   elemental real(wp) function verifying_tolerance(rtol) result(tight)
      real(wp), intent(in) :: rtol
      !! relative tolerance of the verified run [-]

      tight = max(tightest, 1.0e-3_wp*min(rtol, 1.0e-6_wp))
   end function verifying_tolerance

   !> Estimate the error of a finished run by one independent, much tighter run.
   subroutine verify_run(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in), target :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      !! receives the estimate
      type(error_t), allocatable, intent(out) :: error
      type(result_t) :: tight
      type(case_t) :: trial
      type(motion_t), target :: refined
      real(wp) :: found

      trial = case
      trial%solver%method = 'taylor'
      trial%solver%rtol = verifying_tolerance(result%rtol)
      if (allocated(trial%solver%atol)) deallocate (trial%solver%atol)
      if (allocated(trial%output)) deallocate (trial%output)
      call ask_for_peak(trial)
      refined = refined_motion(motion, refinement)
      call run_once(trial, refined, control, tight, error)
      if (allocated(error)) return
      if (.not. allocated(result%estimated_relative_error)) then
         found = relative_difference(case, result, tight)
         if (found > 0) result%estimated_relative_error = found
      end if
      if (.not. allocated(result%estimate_seconds)) result%estimate_seconds = 0
      result%estimate_seconds = result%estimate_seconds + tight%seconds
   end subroutine verify_run

   !> Relative difference of two peaks with respect to the second; 1 if the runs end differently
   !> [-].
   pure real(wp) function relative_difference(case, one, other) result(difference)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: one
      type(result_t), intent(in) :: other

      difference = 1
      if (ending_name(one) == ending_name(other)) difference = relative_change(peak_of(case, one), &
         peak_of(case, other))
   end function relative_difference

   !> Relative difference of two peaks with respect to the second [-].
   pure real(wp) function relative_change(one, other) result(change)
      real(wp), intent(in) :: one
      !! peak, in any unit
      real(wp), intent(in) :: other
      !! peak of the run for comparison, in the same unit

      change = abs(one - other)
      if (change > 0) change = change/max(abs(other), tiny(change))
   end function relative_change

end module rwmf_simulation_error_control
