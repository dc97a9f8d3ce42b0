!> Error estimates of ordinates, as for single runs (`rwmf_simulation_error_control`).
!>
!> All ordinates run at one tolerance; those above the accuracy limit run again at tighter ones.
module rwmf_spectrum_estimates
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_kinds, only: wp
   use rwmf_motion_ground_motion, only: motion_t, refined_motion, scaled_motion
   use rwmf_simulation_error_control, only: first_tolerance, is_close_enough, most_refinements, &
      next_tolerance, refinement, relative_change, perturb_step, tightest, verifying_tolerance
   use rwmf_spectrum_lanes, only: ordinate_t, queue_t, run_ordinates
   use rwmf_spectrum_quantities, only: request_of
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
      if (queue%request%has_sensitivity) call verify_ordinates(queue, threads, control, ordinates)
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

   !> Estimate the sensitivity to the motion, and any missing error estimates.
   !>
   !> Both follow from runs at a much tighter tolerance.
   subroutine verify_ordinates(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(ordinate_t), allocatable :: tight(:), larger(:)
      type(queue_t) :: trial
      type(motion_t), target :: refined
      type(control_t) :: silent
      integer :: i

      silent%cancel => control%cancel
      trial = queue
      trial%request = request_of(queue%rows%case, [character(40) ::])
      trial%verifies = .true.
      trial%parts = refinement
      refined = refined_motion(queue%motion, refinement)
      trial%motion => refined
      tight = ordinates
      where (tight%rtol <= 0) tight%rtol = queue%rows%case%solver%rtol
      tight%rtol = verifying_tolerance(tight%rtol)
      call run_ordinates(trial, threads, silent, tight)
      larger = tight
      trial%shaken = 1 + perturb_step
      refined = scaled_motion(refined, trial%shaken)
      call run_ordinates(trial, threads, silent, larger)
      do i = 1, size(ordinates)
         if (ordinates(i)%failure == '') then
            if (tight(i)%failure /= '') ordinates(i)%failure = tight(i)%failure
            if (larger(i)%failure /= '') ordinates(i)%failure = larger(i)%failure
         end if
         if (ordinates(i)%estimate <= 0) ordinates(i)%estimate = difference(ordinates(i), tight(i))
         ordinates(i)%sensitivity = difference(larger(i), tight(i))/perturb_step
         ordinates(i)%rhs_evaluations = larger(i)%rhs_evaluations
      end do
   end subroutine verify_ordinates

   !> Difference of the peaks of two runs over the peak of the second [-].
   !>
   !> The result is 1 if the runs ended differently.
   pure real(wp) function difference(one, other)
      type(ordinate_t), intent(in) :: one
      type(ordinate_t), intent(in) :: other

      difference = 1
      if (one%overturned .neqv. other%overturned) return
      if (one%collapsed .neqv. other%collapsed) return
      difference = relative_change(one%peak, other%peak)
   end function difference

end module rwmf_spectrum_estimates
