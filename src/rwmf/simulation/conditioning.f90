!> Sensitivities of the peaks of a run: relative changes per relative change of the motion.
!>
!> Two probes give them: runs of the same case with a slightly weaker and a slightly stronger
!> motion, both amplitudes of a vertical motion together, and an initial state with them. The probes
!> need fewer digits than the run, so they use a looser tolerance and a pair of lower order. Their
!> difference is free of the common error; the run itself only decides between the two sides.
module rwmf_simulation_conditioning
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_interrupt, error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_history_row, only: numbered
   use rwmf_motion_ground_motion, only: motion_t, scaled_motion
   use rwmf_problem_case, only: case_t, solver_t, structure_t
   use rwmf_problem_quantity_table, only: all_quantities, is_peak, key_length
   use rwmf_simulation_peak, only: ask_for_peak, peak_of
   use rwmf_simulation_result, only: add_warning, ending_name, result_t, sensitivities_t
   use rwmf_simulation_run, only: run_once
   use rwmf_simulation_scalars, only: floors_of, is_present, scalars_of, value_of, values_t
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: digits_of, has_motion, is_conditioned, make_probe, measure_sensitivities, needs_probes, probe_step, &
      probe_tolerance, round_off_of, sensitivity_of

   real(wp), parameter :: limit = 100
   !! largest sensitivity of a peak without a warning: a motion that is 1 % stronger changes a peak
   !! above it by the size of the peak [-]
   real(wp), parameter :: loosest = 1.0e-7_wp
   !! tolerance of the probes of tighter runs [-]

contains

   !> Return whether a case requests the sensitivities of its peaks.
   pure logical function is_conditioned(case, is_run)
      type(case_t), intent(in) :: case
      logical, intent(in) :: is_run
      !! true for a single run, the default of which is yes; a spectrum or sweep has the default no

      is_conditioned = is_run
      if (.not. allocated(case%output)) return
      if (allocated(case%output%conditioning)) is_conditioned = case%output%conditioning
   end function is_conditioned

   !> Tolerance of the probes of a run [-].
   elemental real(wp) function probe_tolerance(rtol)
      real(wp), intent(in) :: rtol
      !! relative tolerance of the run [-]

      probe_tolerance = max(rtol, loosest)
   end function probe_tolerance

   !> Relative change of the motion in a probe [-].
   !>
   !> It exceeds the tolerance of the probes by a factor of 100, and stays below 1 %.
   elemental real(wp) function probe_step(rtol)
      real(wp), intent(in) :: rtol
      !! relative tolerance of the run [-]

      probe_step = min(1.0e-2_wp, 100*probe_tolerance(rtol))
   end function probe_step

   !> Set the solver of a probe, and scale its initial state like its motion.
   pure subroutine make_probe(rtol, factor, structure, solver)
      real(wp), intent(in) :: rtol
      !! relative tolerance of the run [-]
      real(wp), intent(in) :: factor
      !! factor of the motion [-]
      class(structure_t), intent(inout) :: structure
      type(solver_t), intent(inout) :: solver

      solver%method = 'auto'
      solver%rtol = probe_tolerance(rtol)
      ! a pair of lower order takes more steps than the run
      solver%max_steps = huge(solver%max_steps)
      if (allocated(solver%accuracy)) deallocate (solver%accuracy)
      if (allocated(solver%atol)) deallocate (solver%atol)
      call perturb(structure, factor)
   end subroutine make_probe

   !> Scale the initial state like the motion.
   pure subroutine perturb(structure, factor)
      class(structure_t), intent(inout) :: structure
      real(wp), intent(in) :: factor
      !! factor of the motion [-]

      if (.not. allocated(structure%initial)) return
      structure%initial%theta_over_alpha = structure%initial%theta_over_alpha*factor
      structure%initial%theta_dot = structure%initial%theta_dot*factor
   end subroutine perturb

   !> Sensitivity of a peak from its values in the run and in the two probes [-].
   !>
   !> This is the central difference. At a kink or a jump, where the two sides differ, it is the
   !> larger one-sided difference. A peak that changes by its own size has the value 1/step.
   elemental real(wp) function sensitivity_of(value, weaker, stronger, step, round_off) &
      result(sensitivity)
      real(wp), intent(in) :: value, weaker, stronger
      !! peaks of the run and of the probes, in the same unit
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      real(wp), intent(in) :: round_off
      !! change of the peak that is none, in its unit
      real(wp) :: above, below, change

      sensitivity = 0
      above = stronger - value
      below = value - weaker
      change = max(abs(above), abs(below))
      if (change <= round_off .or. (abs(value) > huge(value) .and. abs(weaker) > huge(value) &
         .and. abs(stronger) > huge(value))) return
      if (abs(above - below) <= 0.5_wp*abs(above + below)) change = abs(above + below)/2
      sensitivity = 1/step
      if (change < abs(value)) sensitivity = change/abs(value)/step
   end function sensitivity_of

   !> Number of digits of a peak that hold.
   !>
   !> The peak is uncertain by its sensitivity, at least 1, times the larger of 10 rtol and a change
   !> of the motion by 1e-7, the last digits of a record. Where the probes change it by more than
   !> 1 %, it is uncertain by that change.
   elemental integer function digits_of(rtol, sensitivity) result(digits)
      real(wp), intent(in) :: rtol
      !! relative tolerance of the run [-]
      real(wp), intent(in) :: sensitivity
      !! [-]
      real(wp), parameter :: last_digits = 1.0e-7_wp
      real(wp) :: error

      error = max(10*rtol, last_digits)*max(1.0_wp, sensitivity)
      if (sensitivity*probe_step(rtol) > 1.0e-2_wp) error = max(error, &
         sensitivity*probe_step(rtol))
      ! round-off of the logarithm must not cost a digit
      digits = max(1, floor(-log10(error) + 1.0e-6_wp))
   end function digits_of

   !> Change of values that round-off can cause, from the largest of their kind.
   elemental real(wp) function round_off_of(largest) result(round_off)
      real(wp), intent(in) :: largest

      round_off = 100*epsilon(largest)*largest
   end function round_off_of

   !> Return whether a single run of a case needs probes.
   pure logical function needs_probes(case)
      type(case_t), intent(in) :: case

      needs_probes = case%solver%verify .or. (is_conditioned(case, .true.) .and. has_motion(case))
   end function needs_probes

   !> Measure the sensitivities of a finished run: of all its peaks, and of the peak of `verify`.
   !>
   !> If a probe fails, the result has a warning in place of the sensitivities.
   subroutine measure_sensitivities(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      !! interrupted
      type(result_t) :: weaker, stronger
      real(wp) :: step

      step = probe_step(result%rtol)
      call run_probe(case, motion, 1 - step, control, result%rtol, weaker, error)
      if (.not. allocated(error)) call run_probe(case, motion, 1 + step, control, result%rtol, &
         stronger, error)
      if (allocated(error)) then
         if (error%stat == err_interrupt) return
         call add_warning(result, 'no sensitivities: a run with another motion fails: ' &
            //error%message)
         deallocate (error)
         return
      end if
      if (.not. allocated(result%estimate_seconds)) result%estimate_seconds = 0
      result%estimate_seconds = result%estimate_seconds + weaker%seconds + stronger%seconds
      if (case%solver%verify) then
         result%sensitivity = 1/step
         if (end_alike(result, weaker, stronger)) result%sensitivity = sensitivity_of( &
            peak_of(case, result), peak_of(case, weaker), peak_of(case, stronger), step, 0.0_wp)
      end if
      if (.not. (is_conditioned(case, .true.) .and. has_motion(case))) return
      call compare(case, step, result, weaker, stronger)
      call warn_of_sensitivity(result)
   end subroutine measure_sensitivities

   !> Return whether a case has a ground motion.
   pure logical function has_motion(case)
      type(case_t), intent(in) :: case

      has_motion = allocated(case%vertical)
      if (allocated(case%motion)) has_motion = has_motion .or. case%motion%kind /= 'none'
   end function has_motion

   !> Run a case with a multiple of its motion and without a history.
   subroutine run_probe(case, motion, factor, control, rtol, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: factor
      !! [-]
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: rtol
      !! relative tolerance of the run [-]
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: probe
      type(motion_t), target :: scaled

      probe = case
      call make_probe(rtol, factor, probe%structure_t, probe%solver)
      if (allocated(probe%output)) then
         if (allocated(probe%output%dt)) deallocate (probe%output%dt)
         probe%output%energy = .false.
      end if
      call ask_for_peak(probe)
      scaled = scaled_motion(motion, factor)
      call run_once(probe, scaled, control, result, error, is_probe=.true.)
   end subroutine run_probe

   pure logical function end_alike(result, weaker, stronger)
      type(result_t), intent(in) :: result, weaker, stronger

      end_alike = ending_name(result) == ending_name(weaker) .and. ending_name(result) &
         == ending_name(stronger)
   end function end_alike

   !> Compare the peaks of a run with those of its probes.
   subroutine compare(case, step, result, weaker, stronger)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      type(result_t), intent(inout) :: result
      type(result_t), intent(in) :: weaker, stronger
      type(values_t) :: here, below, above
      integer, allocatable :: rows(:), floors(:)
      logical :: are_alike
      integer :: i

      are_alike = end_alike(result, weaker, stronger)
      call scalars_of(case, result, here)
      call scalars_of(case, weaker, below)
      call scalars_of(case, stronger, above)
      rows = pack([(i, i=1, size(all_quantities))], here%count(all_quantities%id) > 0)
      rows = pack(rows, is_peak(all_quantities(rows)))
      allocate (result%sensitivities(size(rows)))
      do i = 1, size(rows)
         associate (found => result%sensitivities(i), number => all_quantities(rows(i))%id)
            floors = floors_of(here, number)
            found%number = number
            found%below = here%count(number) - size(floors)
            allocate (found%values(size(floors)), source=1/step)
            if (.not. are_alike) cycle
            where (is_present(below, number, floors) .and. is_present(above, number, floors)) &
               found%values = sensitivity_of(value_of(here, number, floors), &
               value_of(below, number, floors), value_of(above, number, floors), step, &
               round_off_of(largest_like(here, rows, rows(i))))
         end associate
      end do
   end subroutine compare

   !> Largest peak whose key has the same ending: the size that round-off has.
   !>
   !> Equilibrium leaves no moment at the top of a wall, for example, but the round-off of the
   !> others.
   pure real(wp) function largest_like(values, rows, place) result(largest)
      type(values_t), intent(in) :: values
      integer, intent(in) :: rows(:)
      !! (peaks) rows of the table
      integer, intent(in) :: place
      !! one of them
      character(key_length) :: ending
      integer :: i

      largest = 0
      ending = ending_of(all_quantities(place)%key)
      do i = 1, size(rows)
         associate (row => all_quantities(rows(i)))
            if (ending_of(row%key) /= ending) cycle
            associate (sizes => abs(value_of(values, row%id, floors_of(values, row%id))))
               largest = max(largest, maxval(sizes, sizes <= huge(largest)))
            end associate
         end associate
      end do
   end function largest_like

   !> Ending of a key behind 'max' or 'min'; the whole key without them.
   pure function ending_of(key) result(ending)
      character(*), intent(in) :: key
      character(len(key)) :: ending
      integer :: place

      place = max(index(key, '_max', back=.true.), index(key, '_min', back=.true.))
      ending = key(place + 1:)
   end function ending_of

   !> Warn of peaks that a small change of the motion changes strongly.
   subroutine warn_of_sensitivity(result)
      type(result_t), intent(inout) :: result
      !! result with sensitivities
      character(:), allocatable :: worst
      real(wp) :: largest
      integer :: i, n, place

      largest = limit
      n = 0
      do i = 1, size(result%sensitivities)
         associate (found => result%sensitivities(i))
            n = n + count(found%values > limit)
            if (size(found%values) == 0) cycle
            if (.not. maxval(found%values) > largest) cycle
            largest = maxval(found%values)
            place = findloc(all_quantities%id, found%number, dim=1)
            worst = trim(numbered(trim(all_quantities(place)%key), found%below &
               + maxloc(found%values, dim=1)))
         end associate
      end do
      if (n == 0) return
      call add_warning(result, 'sensitive: a motion that is 1 % stronger or weaker may change ' &
         //trim(integer_to_text(n))//' peaks by their own size, most of all '//worst &
         //' (sensitivity '//trim(integer_to_text(nint(largest)))//'); compare many similar motions')
   end subroutine warn_of_sensitivity

end module rwmf_simulation_conditioning
