!> Error estimates of ordinates, as for single runs (`rwmf_simulation_error_control`).
!>
!> All ordinates run at one tolerance; those above the accuracy limit run again at tighter ones.
module rwmf_spectrum_estimates
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_kinds, only: wp
   use rwmf_motion_ground_motion, only: motion_t, refined_motion, scaled_motion
   use rwmf_problem_quantity_table, only: key_length
   use rwmf_simulation_peak_sensitivity, only: has_motion, probe_step, sensitivity_of
   use rwmf_simulation_error_control, only: first_tolerance, is_close_enough, most_refinements, &
      next_tolerance, refinement, relative_change, tightest, verifying_tolerance
   use rwmf_spectrum_lane_rows, only: ordinate_t, queue_t, run_ordinates
   use rwmf_spectrum_quantities, only: request_of, request_t
   implicit none
   private

   public :: run_with_estimates

contains

   !> Run all ordinates, and repeat them as the case's `accuracy` or requested quantities require.
   subroutine run_with_estimates(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      integer :: i

      if (allocated(queue%rows%case%solver%accuracy)) then
         call run_to_accuracy(queue, threads, control, ordinates)
      else
         call run_ordinates(queue, threads, control, ordinates)
      end if
      if (queue%request%is_verified) call verify_ordinates(queue, threads, control, ordinates)
      if (queue%request%has_sensitivity) call condition_ordinates(queue, threads, control, &
         ordinates)
      do i = 1, size(ordinates)
         if (.not. allocated(ordinates(i)%values)) cycle
         ! equal peaks give no estimate
         if (.not. ordinates(i)%estimate > 0) ordinates(i)%estimate = ieee_value(1.0_wp, &
            ieee_quiet_nan)
         where (queue%request%keys == 'estimated_relative_error') ordinates(i)%values = &
            ordinates(i)%estimate
         where (queue%request%keys == 'sensitivity') ordinates(i)%values = ordinates(i)%sensitivity
      end do
   end subroutine run_with_estimates

   !> Repeat each ordinate until the estimated error of its peak is at most the case's `accuracy`.
   subroutine run_to_accuracy(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      !! its case sets `solver%accuracy`
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(ordinate_t), allocatable :: tight(:)
      type(queue_t) :: trial
      type(motion_t), target :: refined
      type(control_t) :: silent
      real(wp) :: accuracy
      integer, allocatable :: open(:)
      logical, allocatable :: stays(:)
      integer :: i, m, round

      accuracy = queue%rows%case%solver%accuracy
      ! count an ordinate as done only when it needs no further run
      silent%cancel => control%cancel
      ordinates%rtol = first_tolerance(accuracy)
      call run_ordinates(queue, threads, silent, ordinates)
      open = pack([(i, i=1, size(ordinates))], ordinates%failure == '')
      do round = 1, most_refinements
         if (size(open) == 0) exit
         if (is_cancelled(control)) return
         tight = ordinates(open)
         tight%rtol = next_tolerance(accuracy, tight%rtol, tight%estimate)
         trial = queue
         trial%parts = 1 + round
         refined = refined_motion(queue%motion, trial%parts)
         trial%motion => refined
         call run_ordinates(trial, threads, silent, tight)
         allocate (stays(size(open)))
         do m = 1, size(open)
            i = open(m)
            tight(m)%estimate = difference(ordinates(i), tight(m))
            stays(m) = tight(m)%failure == '' .and. tight(m)%rtol > tightest &
               .and. .not. is_close_enough(tight(m)%estimate, accuracy)
            if (stays(m) .or. tight(m)%failure /= '') then
               ordinates(i) = tight(m)
            else
               ordinates(i)%estimate = tight(m)%estimate
               ordinates(i)%rhs_evaluations = tight(m)%rhs_evaluations
               call count_done(control)
            end if
         end do
         open = pack(open, stays)
         deallocate (stays)
      end do
      ordinates%is_inaccurate = ordinates%estimate > accuracy
   end subroutine run_to_accuracy

   !> Estimate the errors of ordinates without an estimate by runs at a much tighter tolerance.
   subroutine verify_ordinates(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(ordinate_t), allocatable :: tight(:)
      type(queue_t) :: trial
      type(motion_t), target :: refined
      type(control_t) :: silent
      integer :: i

      silent%cancel => control%cancel
      trial = queue
      trial%request = request_of(queue%rows%case, [character(key_length) ::])
      trial%verifies = .true.
      trial%parts = refinement
      refined = refined_motion(queue%motion, refinement)
      trial%motion => refined
      tight = ordinates
      where (tight%rtol <= 0) tight%rtol = queue%rows%case%solver%rtol
      tight%rtol = verifying_tolerance(tight%rtol)
      call run_ordinates(trial, threads, silent, tight)
      do i = 1, size(ordinates)
         if (ordinates(i)%failure == '') ordinates(i)%failure = tight(i)%failure
         if (ordinates(i)%estimate <= 0) ordinates(i)%estimate = difference(ordinates(i), tight(i))
         ordinates(i)%rhs_evaluations = tight(i)%rhs_evaluations
      end do
   end subroutine verify_ordinates

   !> Measure the sensitivities of all ordinates: of their peaks, and of the peak of `verify`.
   !>
   !> Each ordinate runs again with a stronger motion. The sensitivity of a peak other than 0 is NaN
   !> without a motion, and where this run fails.
   subroutine condition_ordinates(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(ordinate_t), allocatable :: stronger(:)
      type(queue_t) :: trial
      type(motion_t), target :: scaled
      type(control_t) :: silent
      real(wp) :: step
      integer :: i

      silent%cancel => control%cancel
      step = probe_step(queue%rows%case%solver%rtol)
      if (allocated(queue%rows%case%solver%accuracy)) step = probe_step( &
         queue%rows%case%solver%accuracy)
      trial = queue
      trial%shaken = 1 + step
      scaled = scaled_motion(queue%motion, trial%shaken)
      trial%motion => scaled
      stronger = ordinates
      call run_ordinates(trial, threads, silent, stronger)
      if (.not. has_motion(queue%rows%case) .and. .not. queue%request%is_verified) then
         stronger%failure = 'no_motion'
      end if
      do i = 1, size(ordinates)
         if (ordinates(i)%failure /= '') cycle
         call compare(queue%request, step, stronger(i), ordinates(i))
         ordinates(i)%rhs_evaluations = stronger(i)%rhs_evaluations
      end do
   end subroutine condition_ordinates

   !> Compare the peaks of an ordinate with those of its probe.
   pure subroutine compare(request, step, stronger, ordinate)
      type(request_t), intent(in) :: request
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      type(ordinate_t), intent(in) :: stronger
      type(ordinate_t), intent(inout) :: ordinate
      logical :: are_alike

      are_alike = end_alike(ordinate, stronger)
      ordinate%sensitivity = 1/step
      if (are_alike) ordinate%sensitivity = sensitivity_of(ordinate%peak, stronger%peak, step, &
         0.0_wp)
      if (.not. any(request%is_sensitivity)) return
      if (stronger%failure /= '') then
         where (request%is_sensitivity) ordinate%values = merge(0.0_wp, ieee_value(1.0_wp, &
            ieee_quiet_nan), abs(ordinate%values) <= 0)
      else if (are_alike) then
         where (request%is_sensitivity) ordinate%values = sensitivity_of(ordinate%values, &
            stronger%values, step, ordinate%round_off)
      else
         where (request%is_sensitivity) ordinate%values = 1/step
      end if
   end subroutine compare

   !> True if two runs end in the same way.
   pure logical function end_alike(one, other)
      type(ordinate_t), intent(in) :: one, other

      end_alike = (one%overturned .eqv. other%overturned) .and. (one%collapsed .eqv. &
         other%collapsed)
   end function end_alike

   !> Difference of the peaks of two runs over the peak of the second [-].
   !>
   !> The result is 1 if the runs ended differently.
   pure real(wp) function difference(one, other)
      type(ordinate_t), intent(in) :: one
      type(ordinate_t), intent(in) :: other

      difference = 1
      if (end_alike(one, other)) difference = relative_change(one%peak, other%peak)
   end function difference

end module rwmf_spectrum_estimates
