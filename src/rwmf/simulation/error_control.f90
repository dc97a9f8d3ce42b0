!> Accuracy instead of tolerance: runs that estimate their own error.
!>
!> The peak of a run is compared with that of a tighter one. The difference is the error of the
!> first run up to that of the second, which is much smaller; so the first run is delivered together
!> with an estimate of its true error, and not the second with none.
module rwmf_simulation_error_control
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_motion_ground_motion, only: motion_t, scaled_motion
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_result, only: add_warning, ending_name, history_t, result_t
   use rwmf_simulation_run, only: run_once
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: run_to_accuracy, verify_run, peak_of

   real(wp), parameter :: tighter = 0.03_wp
   !! ratio of the tolerances of two runs that are compared
   real(wp), parameter :: loosest = 1.0e-2_wp
   real(wp), parameter :: tightest = 3.0e-14_wp
   !! below, round-off governs (double precision)
   integer, parameter :: most_refinements = 12

contains

   !> Run until the estimated relative error of the peak is at most what the case asks for.
   !>
   !> When that is impossible the best run is returned with its estimate and a warning.
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
      real(wp) :: spent
      integer :: i

      trial = case
      trial%solver%rtol = min(loosest, max(tightest, 0.5_wp*case%solver%accuracy))
      call run_once(trial, motion, control, result, error)
      if (allocated(error)) return
      spent = result%seconds
      do i = 1, most_refinements
         trial%solver%rtol = next_tolerance(case%solver%accuracy, result)
         call run_once(trial, motion, control, tight, error)
         if (allocated(error)) return
         spent = spent + tight%seconds
         result%estimated_relative_error = relative_difference(result, tight)
         if (result%estimated_relative_error <= 0.7_wp*case%solver%accuracy) exit
         if (trial%solver%rtol <= tightest) exit
         ! the history is moved: it can be the largest array
         call move_alloc(tight%history, history)
         result = tight
         call move_alloc(history, result%history)
      end do
      result%estimate_seconds = spent - result%seconds
      if (result%estimated_relative_error > case%solver%accuracy) then
         call add_warning(result, 'the accuracy asked for, ' &
            //trim(real_to_text(case%solver%accuracy))//', cannot be delivered: estimated error ' &
            //trim(real_to_text(result%estimated_relative_error))//' at the tightest tolerance')
      end if
   end subroutine run_to_accuracy

   !> Tolerance of the run that a result is compared with: much tighter, and at once as tight as the
   !> error found before suggests.
   pure real(wp) function next_tolerance(accuracy, result) result(rtol)
      real(wp), intent(in) :: accuracy
      type(result_t), intent(in) :: result

      rtol = result%rtol*tighter
      if (allocated(result%estimated_relative_error)) then
         rtol = rtol*min(1.0_wp, accuracy/result%estimated_relative_error)
      end if
      rtol = max(tightest, rtol)
   end function next_tolerance

   !> Estimate the error of a finished run by an independent, much tighter one, and the sensitivity
   !> of its peak to the motion by two more.
   subroutine verify_run(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in), target :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      !! gains estimate and sensitivity
      type(error_t), allocatable, intent(out) :: error
      type(result_t) :: tight
      type(result_t) :: larger
      type(case_t) :: trial
      type(motion_t), target :: shaken
      real(wp) :: step

      trial = case
      trial%solver%method = 'dop853'
      trial%solver%rtol = max(tightest, 1.0e-3_wp*min(result%rtol, 1.0e-6_wp))
      if (allocated(trial%solver%atol)) deallocate (trial%solver%atol)
      if (allocated(trial%output)) deallocate (trial%output)
      call run_once(trial, motion, control, tight, error)
      if (allocated(error)) return
      if (.not. allocated(result%estimated_relative_error)) then
         result%estimated_relative_error = relative_difference(result, tight)
      end if
      step = 1.0e-6_wp
      shaken = scaled_motion(motion, 1 + step)
      if (allocated(trial%initial)) then
         trial%initial%theta_over_alpha = trial%initial%theta_over_alpha*(1 + step)
         trial%initial%theta_dot = trial%initial%theta_dot*(1 + step)
      end if
      call run_once(trial, shaken, control, larger, error)
      if (allocated(error)) return
      result%sensitivity = relative_difference(larger, tight)/step
      if (.not. allocated(result%estimate_seconds)) result%estimate_seconds = 0
      result%estimate_seconds = result%estimate_seconds + tight%seconds + larger%seconds
   end subroutine verify_run

   !> Difference of two peaks over the second; 1 when they ended differently [-].
   pure real(wp) function relative_difference(one, other) result(difference)
      type(result_t), intent(in) :: one
      type(result_t), intent(in) :: other
      real(wp) :: change

      difference = 1
      if (ending_name(one) /= ending_name(other)) return
      change = abs(peak_of(one) - peak_of(other))
      difference = 0
      if (change > 0) difference = change/max(abs(peak_of(other)), tiny(change))
   end function relative_difference

   !> The peak that accuracy is about: u_s_max [m], or |theta|_max [rad] without a frame.
   pure real(wp) function peak_of(result) result(peak)
      type(result_t), intent(in) :: result

      if (allocated(result%u_s_max)) then
         peak = result%u_s_max
      else
         peak = max(result%theta_max, -result%theta_min)
      end if
   end function peak_of

end module rwmf_simulation_error_control
