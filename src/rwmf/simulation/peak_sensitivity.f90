!> Sensitivities of the peaks of a run: relative changes per relative change of the motion.
!>
!> A second run gives them, the probe: the same case, method and tolerance with a slightly stronger
!> motion, both amplitudes of a vertical motion together, and the initial state with them. The
!> difference of the two runs is almost free of their common error.
module rwmf_simulation_peak_sensitivity
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_interrupt, error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_values, only: is_present, numbered, put, value_of, values_t
   use rwmf_motion_ground_motion, only: motion_t, scaled_motion
   use rwmf_problem_case, only: case_t, structure_t
   use rwmf_problem_quantity_table, only: all_quantities, is_peak, key_length, key_of
   use rwmf_simulation_peak, only: ask_for_peak, peak_of
   use rwmf_simulation_run, only: run_once
   use rwmf_simulation_state_result, only: add_warning, ending_name, result_t
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: digits_of, has_motion, is_conditioned, measure_sensitivities, needs_probe, perturb
   public :: probe_step, round_off_of, sensitivity_of

   real(wp), parameter :: limit = 100
   !! smallest sensitivity of a peak with a warning: a motion that is 1 % stronger changes such a
   !! peak by its own size [-]

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

   !> Relative change of the motion in the probe [-].
   !>
   !> It exceeds the error of the run by a factor of 100, and stays below 1 %.
   elemental real(wp) function probe_step(error)
      real(wp), intent(in) :: error
      !! relative tolerance or required accuracy of the run [-]
      real(wp), parameter :: smallest = 1.0e-7_wp
      !! last digits of a record [-]

      probe_step = min(1.0e-2_wp, 100*max(error, smallest))
   end function probe_step

   !> Scale the initial state like the motion.
   pure subroutine perturb(structure, factor)
      class(structure_t), intent(inout) :: structure
      real(wp), intent(in) :: factor
      !! factor of the motion [-]

      if (.not. allocated(structure%initial)) return
      structure%initial%theta_over_alpha = structure%initial%theta_over_alpha*factor
      structure%initial%theta_dot = structure%initial%theta_dot*factor
   end subroutine perturb

   !> Sensitivity of a peak from its values in the run and in the probe [-].
   !>
   !> A peak that changes by its own size or more has the value 1/step.
   elemental real(wp) function sensitivity_of(value, stronger, step, round_off) result(sensitivity)
      real(wp), intent(in) :: value, stronger
      !! peaks of the run and of the probe, in the same unit
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      real(wp), intent(in) :: round_off
      !! change of the peak that is none, in its unit
      real(wp) :: change

      sensitivity = 0
      change = abs(stronger - value)
      if (change <= round_off) return
      if (abs(value) > huge(value) .and. abs(stronger) > huge(value)) return
      sensitivity = 1/step
      if (change < abs(value)) sensitivity = change/abs(value)/step
   end function sensitivity_of

   !> Number of digits of a peak that hold.
   !>
   !> The peak is uncertain by its sensitivity, at least 1, times the larger of 10 rtol and a change
   !> of the motion by 1e-7, the last digits of a record. Where the probes change it by more than
   !> 1 %, it is uncertain by that change. This bound is wide at a large tolerance. Three digits
   !> hold unless a change of the motion changes the peak as much as in a warning.
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
      digits = max(merge(1, 3, sensitivity >= limit), floor(-log10(error) + 1.0e-6_wp))
   end function digits_of

   !> Return whether a single run of a case needs a probe.
   pure logical function needs_probe(case)
      type(case_t), intent(in) :: case

      needs_probe = case%solver%verify .or. (is_conditioned(case, .true.) .and. has_motion(case))
   end function needs_probe

   !> Return whether a case has a ground motion.
   pure logical function has_motion(case)
      type(case_t), intent(in) :: case

      has_motion = allocated(case%upward)
      if (allocated(case%motion)) has_motion = has_motion .or. case%motion%kind /= 'none'
   end function has_motion

   !> Measure the sensitivities of a finished run: of all its peaks, and of the peak of `verify`.
   !>
   !> If the probe fails, the result has a warning in place of the sensitivities.
   subroutine measure_sensitivities(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      !! interrupted
      type(result_t) :: stronger
      real(wp) :: step
      integer :: n, place

      step = probe_step(result%rtol)
      if (allocated(case%solver%accuracy)) step = probe_step(case%solver%accuracy)
      call run_probe(case, motion, step, control, result, stronger, error)
      if (allocated(error)) then
         if (error%stat == err_interrupt) return
         if (error%name == 'too_many_steps') then
            call add_warning(result, 'no sensitivities: with a slightly stronger motion the run ' &
               //'takes more than '//trim(integer_to_text(most_steps(result)))//' steps')
         else
            call add_warning(result, 'no sensitivities: a run with a stronger motion fails: ' &
               //error%message)
         end if
         deallocate (error)
         return
      end if
      if (case%solver%verify) then
         if (.not. allocated(result%estimate_seconds)) result%estimate_seconds = 0
         result%estimate_seconds = result%estimate_seconds + stronger%seconds
         result%sensitivity = 1/step
         if (ending_name(result) == ending_name(stronger)) result%sensitivity = sensitivity_of( &
            peak_of(case, result), peak_of(case, stronger), step, 0.0_wp)
      end if
      if (.not. (is_conditioned(case, .true.) .and. has_motion(case))) return
      call compare(step, result, stronger)
      associate (found => result%sensitivities)
         n = count(found%numbers(:found%n) >= limit)
         if (n == 0) return
         place = maxloc(found%numbers(:found%n), dim=1)
         call add_warning(result, 'sensitive: a motion that is 1 % stronger or weaker may change ' &
            //trim(integer_to_text(n))//' peaks by their own size, most of all ' &
            //trim(numbered(key_of(found%ids(place)), found%levels(place)))//' (sensitivity ' &
            //trim(integer_to_text(nint(found%numbers(place)))) &
            //'); compare many similar motions')
      end associate
   end subroutine measure_sensitivities

   !> Largest number of steps of the probe.
   !>
   !> A wall that rests may lift off under a stronger motion and bounce a million times without a
   !> visible rotation. The probe must not take longer than the run deserves.
   pure integer function most_steps(result) result(most)
      type(result_t), intent(in) :: result
      !! of the run; its own limit may be just enough for it
      integer, parameter :: few = 20000, factor = 20

      most = int(min(real(huge(most), wp), few + real(factor, wp)*result%steps))
   end function most_steps

   !> Run a case with a stronger motion, and without history and energies.
   subroutine run_probe(case, motion, step, control, own, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      type(control_t), intent(in) :: control
      type(result_t), intent(in) :: own
      !! of the run
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: probe
      type(motion_t), target :: scaled

      probe%structure_t = case%structure_t
      probe%solver = case%solver
      probe%solver%rtol = own%rtol
      probe%solver%max_steps = most_steps(own)
      if (allocated(case%output)) then
         probe%output = case%output
         if (allocated(probe%output%dt)) deallocate (probe%output%dt)
         probe%output%energy = .false.
      end if
      call perturb(probe, 1 + step)
      call ask_for_peak(probe)
      scaled = scaled_motion(motion, 1 + step)
      call run_once(probe, scaled, control, result, error)
   end subroutine run_probe

   !> Compare the peaks of a run with those of its probe.
   subroutine compare(step, result, stronger)
      real(wp), intent(in) :: step
      !! relative change of the motion [-]
      type(result_t), intent(inout) :: result
      type(result_t), intent(in) :: stronger
      real(wp) :: round_off(result%values%n), found
      integer :: i

      allocate (result%sensitivities)
      associate (here => result%values, there => stronger%values)
         round_off = round_off_of(here, here%ids(:here%n))
         do i = 1, here%n
            if (.not. is_peak(all_quantities(here%ids(i)))) cycle
            found = 1/step
            if (ending_name(result) == ending_name(stronger) .and. is_present(there, here%ids(i), &
               here%levels(i))) found = sensitivity_of(here%numbers(i), value_of(there, &
               here%ids(i), here%levels(i)), step, round_off(i))
            call put(result%sensitivities, here%ids(i), [found], here%levels(i) - 1)
         end do
      end associate
   end subroutine compare

   !> Changes that round-off can cause in peaks, in their units.
   !>
   !> The largest peak of the run whose key has the same ending has this round-off. Equilibrium
   !> leaves no moment at the top of a wall, for example, but the round-off of the others.
   pure function round_off_of(values, numbers) result(round_off)
      type(values_t), intent(in) :: values
      integer, intent(in) :: numbers(:)
      !! (peaks) numbers of the table
      real(wp) :: round_off(size(numbers))
      !! (peaks)
      character(key_length) :: endings(size(numbers)), ending
      integer :: i

      do i = 1, size(numbers)
         endings(i) = ending_of(key_of(numbers(i)))
      end do
      round_off = 0
      do i = 1, values%n
         if (.not. abs(values%numbers(i)) <= huge(round_off)) cycle
         if (.not. is_peak(all_quantities(values%ids(i)))) cycle
         ending = ending_of(key_of(values%ids(i)))
         where (endings == ending) round_off = max(round_off, 100*epsilon(round_off) &
            *abs(values%numbers(i)))
      end do
   end function round_off_of

   !> Ending of a key behind 'max' or 'min'; the whole key without them.
   pure function ending_of(key) result(ending)
      character(*), intent(in) :: key
      character(len(key)) :: ending
      integer :: place

      place = max(index(key, '_max', back=.true.), index(key, '_min', back=.true.))
      ending = key(place + 1:)
   end function ending_of

end module rwmf_simulation_peak_sensitivity
