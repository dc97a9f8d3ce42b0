!> Public interface of the kernel.
!>
!>     program example
!>        use rwmf, only: case_t, error_t, read_case_file, result_t, simulate
!>        type(case_t) :: case
!>        type(result_t) :: result
!>        type(error_t), allocatable :: error
!>
!>        call read_case_file('inputs/fig12_one_cosine.nml', case, error)
!>        if (.not. allocated(error)) call simulate(case, result, error)
!>        if (allocated(error)) then
!>           print '(a)', error%message
!>        else
!>           print '(a, es12.4)', 'largest |u_s| [m]:', result%u_s_max
!>        end if
!>     end program example
!>
!> `error` is allocated when a call failed. The library neither prints nor stops and keeps no data
!> between calls; any number of threads may call it with their own variables. An absent component of
!> `case_t` is an effect that is not simulated. An absent component of `result_t` does not apply.
!> `result_value` gives every number of a run by its key, as in the summary.
module rwmf
   ! read a case from namelist text or file into validated components
   use rwmf_problem_case, only: case_t
   use rwmf_input_reader, only: read_case_file, read_case_text
   ! ground motion from arrays, in place of the record of a case
   use rwmf_input_record_samples, only: samples_from_array, samples_t
   ! change numbers of a case, in microseconds
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_simulation_simulate, only: simulate_with_motion
   ! one simulation: maxima, counts, history and events
   use rwmf_simulation_pushover_curve, only: static_curve_t, mark_t
   use rwmf_simulation_pushover_pushover, only: protocol_t, push_over
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_history, only: history_t
   use rwmf_simulation_state_result, only: event_branch, event_collapsed, event_impact, &
      event_lift_off, event_name, event_overturned, event_peak, event_rest, event_rupture, &
      event_t, result_t, result_value
   ! coefficients of the paper's equation of motion
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_system_assembly, only: parameters_of
   use rwmf_paper_coefficients, only: coefficients_a, coefficients_b
   ! spectra: maxima over frame period, mass ratio and wall width, in parallel
   use rwmf_spectrum_ordinates, only: compute_rows, compute_spectrum, spectrum_t, status_of
   ! a wall inside the time loop of a host program
   use rwmf_motion_ground_motion, only: ground_t
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      restore_stepping, save_stepping, snapshot_t, stepping_t, stop_at_impacts, query_events, &
      query_forces, query_state, wall_forces_t, wall_state_t
   use rwmf_embedding_outputs, only: find_output, query_outputs
   ! the wall as an element of a host program that owns the frame
   use rwmf_embedding_element, only: create_element, element_response_t, next_impact, &
      next_lift_off, respond, settles, uplift_demand_of, velocity_factor, wall_element_t
   ! the wall as a member: an element with memory
   use rwmf_embedding_member, only: commit_member, create_member, member_info_t, place_member, &
      query_member, restart_member, revert_member, wall_member_t
   use rwmf_embedding_member_response, only: link_motion_t, member_response_t, query_links, &
      respond_member
   use rwmf_embedding_member_events, only: land_member, member_event_t, member_settles, &
      next_member_event
   ! CSV files, written completely or not at all
   use rwmf_output_csv, only: write_result, write_spectrum
   ! stop a computation from another thread, count its finished parts
   use rwmf_core_control, only: control_t
   ! failures as values
   use rwmf_core_error, only: err_input, err_interrupt, err_numerical, error_t
   ! kinds of the real and integer components
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_lane_kernels, only: instruction_set
   use rwmf_core_version, only: version
   implicit none
   private

   public :: case_t, read_case_file, read_case_text, samples_t, samples_from_array
   public :: changes_t, find_changes, change_case, motion_t, motion_from_case, simulate_with_motion
   public :: result_t, result_value, history_t, event_t
   public :: event_name, simulate
   public :: event_impact, event_lift_off, event_overturned, event_peak, event_rest, &
      event_branch, event_rupture, event_collapsed
   public :: stepping_t, snapshot_t, ground_t, create_stepping, destroy_stepping
   public :: advance_stepping, save_stepping, restore_stepping
   public :: wall_state_t, wall_forces_t, query_state, query_forces, query_events
   public :: stop_at_impacts, find_output, query_outputs
   public :: wall_element_t, element_response_t, create_element, respond, velocity_factor
   public :: next_impact, next_lift_off, uplift_demand_of, settles
   public :: wall_member_t, member_info_t, member_response_t, link_motion_t, member_event_t
   public :: create_member, query_member, respond_member, query_links
   public :: commit_member, revert_member, restart_member, place_member
   public :: next_member_event, land_member, member_settles
   public :: parameters_t, parameters_of, coefficients_a, coefficients_b
   public :: spectrum_t, compute_spectrum, compute_rows, status_of
   public :: static_curve_t, mark_t, protocol_t, push_over
   public :: write_result, write_spectrum
   public :: control_t
   public :: error_t, err_input, err_interrupt, err_numerical
   public :: wp, i8, version, instruction_set

end module rwmf
