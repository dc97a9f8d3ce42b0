!> A single simulation of a valid case, with the requested accuracy or error estimate.
module rwmf_simulation_simulate
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_problem_group_values, only: has_key
   use rwmf_problem_quantity_table, only: all_quantities, is_peak, key_length
   use rwmf_problem_rules, only: fail_key
   use rwmf_simulation_peak_sensitivity, only: measure_sensitivities, needs_probe
   use rwmf_simulation_error_control, only: run_to_accuracy, verify_run
   use rwmf_simulation_peak, only: ask_for_peak, list_reported, reports_peak
   use rwmf_simulation_quantity_words, only: list_quantities
   use rwmf_simulation_run, only: run_once
   use rwmf_simulation_state_result, only: result_t
   implicit none
   private

   public :: simulate, simulate_with_motion, simulate_instant, check_peak

contains

   !> Compute the response of the scene that a case describes.
   subroutine simulate(case, result, error, control)
      type(case_t), intent(in) :: case
      !! valid case (from `rwmf_input_reader`)
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      !! numerical failure or interruption, with time and state
      type(control_t), intent(in), optional :: control
      type(control_t) :: used

      if (present(control)) used = control
      call simulate_with_motion(case, motion_from_case(case), used, result, error)
   end subroutine simulate

   !> Compute the response under a ground motion owned by the caller and shared by many simulations.
   subroutine simulate_with_motion(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      !! errors of `simulate`
      type(case_t), allocatable :: asking

      if (case%solver%accuracy_of == '') then
         call run_requested(case, motion, control, result, error)
      else
         call check_peak(case, motion, error)
         if (allocated(error)) return
         asking = case
         call ask_for_peak(asking)
         call run_requested(asking, motion, control, result, error)
      end if
   end subroutine simulate_with_motion

   !> Run a case that stores all outputs that the error estimate needs.
   subroutine run_requested(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error

      if (allocated(case%solver%accuracy)) then
         call run_to_accuracy(case, motion, control, result, error)
      else
         call run_once(case, motion, control, result, error)
      end if
      if (allocated(error)) return
      if (case%solver%verify) call verify_run(case, motion, control, result, error)
      if (allocated(error)) return
      if (needs_probe(case)) call measure_sensitivities(case, motion, control, result, error)
   end subroutine run_requested

   !> Check that the scene has the peak of `accuracy_of`.
   !>
   !> Errors: the peak does not apply to the scene, or an error of `simulate`.
   subroutine check_peak(case, motion, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: asking, instant
      type(result_t) :: result
      type(control_t) :: no_control
      character(key_length), allocatable :: keys(:)
      character(:), allocatable :: problem

      if (case%solver%accuracy_of == '') return
      asking%structure_t = case%structure_t
      asking%solver = case%solver
      asking%solver%method = 'auto'
      asking%output = output_t(energy=.false., reactions=.true., demands=.true., &
         envelopes=.true.)
      call begin_instant(asking, instant)
      call run_once(instant, motion, no_control, result, error)
      if (allocated(error)) return
      if (reports_peak(instant, result)) return
      call list_reported(result, is_peak(all_quantities), keys)
      problem = trim(case%solver%accuracy_of)//' does not apply to this scene'
      call list_quantities(keys, problem)
      if (has_key(case%values, 'solver', 'accuracy_of')) then
         call fail_key(case%values, 'solver', 'accuracy_of', problem, error)
      else
         call fail(error, err_input, '&solver accuracy_of: '//problem)
      end if
   end subroutine check_peak

   !> Compute the initial outputs of a case: the result of a run with zero duration.
   !>
   !> Errors: those of `simulate`.
   subroutine simulate_instant(case, motion, instant, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(case_t), intent(out) :: instant
      !! case with zero duration
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(control_t) :: no_control

      ! check the original case: the instant has no input locations for messages
      call check_peak(case, motion, error)
      if (allocated(error)) return
      call begin_instant(case, instant)
      call simulate_with_motion(instant, motion, no_control, result, error)
   end subroutine simulate_instant

   !> Create a case with zero duration.
   subroutine begin_instant(case, instant)
      type(case_t), intent(in) :: case
      type(case_t), intent(out) :: instant

      instant%structure_t = case%structure_t
      instant%solver = case%solver
      if (allocated(case%output)) instant%output = case%output
      instant%solver%t_end = 0
      if (allocated(instant%frame)) then
         ! all periods of a spectrum give the same initial outputs
         if (.not. allocated(instant%frame%T_s)) instant%frame%T_s = 1
      end if
   end subroutine begin_instant

end module rwmf_simulation_simulate
