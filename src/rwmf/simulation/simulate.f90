!> One simulation: from a valid case to its result, with the accuracy or the estimate asked for.
module rwmf_simulation_simulate
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_error_control, only: run_to_accuracy, verify_run
   use rwmf_simulation_result, only: result_t
   use rwmf_simulation_run, only: run_once
   implicit none
   private

   public :: simulate, simulate_with_motion, simulate_instant

contains

   !> Compute the response of the scene that a case describes.
   subroutine simulate(case, result, error, control)
      type(case_t), intent(in) :: case
      !! valid (from `rwmf_input_reader`)
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      !! numerical failure or interruption, with time and state
      type(control_t), intent(in), optional :: control
      type(motion_t) :: motion
      type(control_t) :: no_control

      motion = motion_from_case(case)
      if (present(control)) then
         call simulate_with_motion(case, motion, control, result, error)
      else
         call simulate_with_motion(case, motion, no_control, result, error)
      end if
   end subroutine simulate

   !> The same with a ground motion that the caller holds (many simulations share one).
   subroutine simulate_with_motion(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      !! as `simulate`

      if (allocated(case%solver%accuracy)) then
         call run_to_accuracy(case, motion, control, result, error)
      else
         call run_once(case, motion, control, result, error)
      end if
      if (allocated(error)) return
      if (case%solver%verify) call verify_run(case, motion, control, result, error)
   end subroutine simulate_with_motion

   !> What a case reports at the beginning: the result of the same case when it ends as it begins.
   !> Errors: as `simulate`.
   subroutine simulate_instant(case, motion, instant, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(case_t), intent(out) :: instant
      !! without any duration
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(control_t) :: no_control

      instant%structure_t = case%structure_t
      instant%solver = case%solver
      if (allocated(case%output)) instant%output = case%output
      instant%solver%t_end = 0
      if (allocated(instant%frame)) then
         ! each period of a spectrum reports the same
         if (.not. allocated(instant%frame%T_s)) instant%frame%T_s = 1
      end if
      call simulate_with_motion(instant, motion, no_control, result, error)
   end subroutine simulate_instant

end module rwmf_simulation_simulate
