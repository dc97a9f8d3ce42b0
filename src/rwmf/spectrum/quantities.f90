!> Quantities that each ordinate of a spectrum reports (`&spectrum quantities`).
!>
!> Their keys are in the table of quantities, their values come from `result_values`.
module rwmf_spectrum_quantities
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t, has_numbers, output_t, structure_t
   use rwmf_problem_frame_strength, only: has_strength
   use rwmf_problem_group_values, only: has_key
   use rwmf_problem_quantity_table, only: all_quantities, id, is_of_ordinate, is_peak, key_length, &
      look_up, of_demands, of_displacement, of_energy, of_envelopes, of_reactions, of_storeys, &
      of_velocity, of_verification, own_key, sensitivity_id
   use rwmf_problem_quantity_values, only: is_present, levels_of, put, value_of, values_t
   use rwmf_problem_rules, only: fail_key
   use rwmf_simulation_peak_sensitivity, only: is_conditioned, round_off_of
   use rwmf_simulation_finite_check, only: may_report
   use rwmf_simulation_peak, only: list_reported
   use rwmf_simulation_quantity_words, only: list_quantities
   use rwmf_simulation_simulate, only: simulate_instant
   use rwmf_simulation_state_result, only: result_t, result_values
   implicit none
   private

   public :: request_t, request_of, requested_keys_of, check_request, default_quantity, &
      list_applicable
   public :: take_values, with_sensitivities

   character(*), parameter :: displacement = 'u_s_max_m'
   !! default quantity of a scene with a frame

   !> Requested quantities.
   type :: request_t
      character(key_length), allocatable :: keys(:)
      !! (quantities) keys as in the outputs
      integer, allocatable :: place(:)
      !! (quantities) index in the table
      integer, allocatable :: storey(:)
      !! (quantities) number of the storey, for keys that have one
      type(output_t), allocatable :: output
      !! outputs that a run must record for them; not allocated: none
      logical :: is_displacement = .true.
      !! only the largest displacement of the frame is requested
      logical :: has_only_peaks = .false.
      !! all of them depend on the largest rotations only
      logical :: seeks_velocity = .false.
      !! the largest velocity is one of them
      logical :: is_watched = .false.
      !! some of them have peaks inside steps
      logical, allocatable :: is_sensitivity(:)
      !! (quantities) true for the sensitivity of the quantity at that index
      logical :: is_verified = .false.
      !! `verify` must make a tighter run for them
      logical :: has_sensitivity = .false.
      !! rows must run again for them
      logical :: has_peak = .false.
      !! their error is that of a peak named by the case
   end type request_t

contains

   !> Key of the default quantity.
   !>
   !> This is the largest displacement of the frame, or without a frame the largest rotation of the
   !> wall.
   pure function default_quantity(case) result(key)
      class(structure_t), intent(in) :: case
      character(20) :: key

      key = 'theta_max_over_alpha'
      if (allocated(case%frame)) key = displacement
   end function default_quantity

   !> Keys of the quantities that the groups `&spectrum` and `&limits` of a case request.
   pure function requested_keys_of(case) result(keys)
      type(case_t), intent(in) :: case
      character(key_length), allocatable :: keys(:)
      !! (quantities)
      integer :: i

      keys = [character(key_length) :: default_quantity(case)]
      if (allocated(case%spectrum)) then
         if (allocated(case%spectrum%quantities)) keys = case%spectrum%quantities
      end if
      if (.not. allocated(case%output)) return
      if (.not. allocated(case%output%limited)) return
      do i = 1, size(case%output%limited)
         if (.not. any(keys == case%output%limited(i))) keys = [keys, case%output%limited(i)]
      end do
   end function requested_keys_of

   !> Describe the requested quantities of a case.
   pure type(request_t) function request_of(case, keys) result(request)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: keys(:)
      !! (quantities) keys that apply to its scene, as checked by `check_request`
      type(output_t) :: output
      character(12), allocatable :: observed(:)
      !! (quantities, then the peak of `accuracy_of`) kind of output that each needs
      integer :: i, place, number

      request%keys = keys
      allocate (request%place(size(request%keys)), request%storey(size(request%keys)))
      do i = 1, size(request%keys)
         call look_up(trim(own_key(request%keys(i))), request%place(i), request%storey(i))
      end do
      request%is_sensitivity = own_key(request%keys) /= request%keys
      call look_up(trim(case%solver%accuracy_of), place, number)
      request%has_peak = place > 0
      observed = all_quantities([request%place, pack([place], request%has_peak)])%observed
      output%reactions = any(observed == of_reactions)
      output%demands = any(observed == of_demands)
      output%envelopes = any(observed == of_envelopes)
      output%energy = any(observed == of_energy)
      request%is_watched = output%reactions .or. output%demands .or. output%envelopes &
         .or. any(observed == of_velocity .or. observed == of_storeys) .or. has_numbers(case, &
         'bending')
      request%is_displacement = all(request%keys == displacement) .and. .not. request%has_peak
      request%has_only_peaks = all(observed == of_displacement)
      request%seeks_velocity = any(observed == of_velocity)
      request%is_verified = case%solver%verify .and. any(observed == of_verification)
      request%has_sensitivity = any(request%is_sensitivity) &
         .or. (request%is_verified .and. any(request%keys == 'sensitivity'))
      if (.not. (output%reactions .or. output%demands .or. output%envelopes &
         .or. output%energy)) return
      associate (rows => all_quantities([request%place, pack([place], request%has_peak)]))
         ! a force in N is computed from its ratio to a weight
         output%sought = merge(rows%ratio, rows%id, rows%ratio > 0)
      end associate
      if (allocated(case%output)) then
         if (allocated(case%output%friction_limit)) output%friction_limit = &
            case%output%friction_limit
      end if
      request%output = output
   end function request_of

   !> Quantities with the sensitivities of their peaks, if the case requests them.
   pure function with_sensitivities(case, keys) result(all_keys)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: keys(:)
      !! (quantities)
      character(key_length), allocatable :: all_keys(:)
      character(key_length) :: key
      integer :: i, place, number

      all_keys = [character(key_length) :: keys]
      if (.not. is_conditioned(case, .false.)) return
      do i = 1, size(keys)
         call look_up(trim(keys(i)), place, number)
         if (place == 0) cycle
         key = 'sensitivity_'//keys(i)
         if (is_peak(all_quantities(place)) .and. .not. any(all_keys == key)) all_keys = &
            [all_keys, key]
      end do
   end function with_sensitivities

   !> Check that all requested quantities apply to the scene of a case.
   !>
   !> Errors: a key that does not apply (the message lists those that do, if there are few), and
   !> those of `simulate`.
   subroutine check_request(case, motion, requested_keys, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      character(*), intent(in) :: requested_keys(:)
      !! (quantities)
      type(error_t), allocatable, intent(out) :: error
      character(key_length), allocatable :: keys(:)
      character(:), allocatable :: problem
      integer :: i, place, number
      logical :: is_known

      if (allocated(case%frame) .and. all(requested_keys == displacement)) return
      call list_applicable(case, motion, keys, error)
      if (allocated(error)) return
      do i = 1, size(requested_keys)
         is_known = any(keys == own_key(requested_keys(i)))
         if (is_known .and. own_key(requested_keys(i)) /= requested_keys(i)) then
            call look_up(trim(own_key(requested_keys(i))), place, number)
            is_known = is_peak(all_quantities(place))
         end if
         if (is_known) cycle
         problem = trim(requested_keys(i))//' does not apply to this scene'
         call list_quantities(keys, problem)
         if (is_of_spectrum(case, requested_keys)) then
            call fail_key(case%values, 'spectrum', 'quantities', problem, error)
         else
            call fail(error, err_input, 'quantities: '//problem)
         end if
         return
      end do
   end subroutine check_request

   !> True if these quantities come from the case itself, not from the call.
   pure logical function is_of_spectrum(case, requested_keys) result(is_own)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: requested_keys(:)
      !! (quantities)

      is_own = has_key(case%values, 'spectrum', 'quantities') .and. allocated(case%spectrum)
      if (.not. is_own) return
      associate (own => requested_keys_of(case))
         is_own = size(own) == size(requested_keys)
         if (is_own) is_own = all(own == requested_keys)
      end associate
   end function is_of_spectrum

   !> List the keys that apply to a spectrum of a scene.
   !>
   !> They include the quantities that a run reports only after certain events. Errors: those of
   !> `simulate`.
   subroutine list_applicable(case, motion, keys, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      character(key_length), allocatable, intent(out) :: keys(:)
      !! (keys) with the number of a storey in place of '{i}'
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: asking, instant
      type(result_t) :: result

      asking%structure_t = case%structure_t
      asking%solver = case%solver
      asking%solver%accuracy_of = ''
      asking%solver%method = 'auto'
      asking%output = output_t(energy=.true., reactions=.true., demands=.true., &
         envelopes=.true., conditioning=.false.)
      if (allocated(case%output)) then
         if (allocated(case%output%friction_limit)) asking%output%friction_limit = &
            case%output%friction_limit
      end if
      call simulate_instant(asking, motion, instant, result, error)
      if (allocated(error)) return
      call promise(id%t_collapse_s, id%collapsed)
      call promise(id%storey_i_residual_drift_at_rest, id%storey_i_residual_drift)
      call promise(id%t_flight_first_s, id%flights)
      if (has_strength(case) .or. allocated(case%fuse)) call promise( &
         id%roof_residual_drift_at_rest, id%roof_drift_max)
      call promise(id%t_friction_demand_max_s, id%friction_demand_max)
      call promise(id%t_friction_exceeded_s, id%friction_exceeded)
      if (allocated(asking%solver%accuracy) .or. asking%solver%verify) then
         result%estimated_relative_error = 0
      end if
      call list_reported(result, is_of_ordinate(all_quantities), keys)

   contains

      !> Add a quantity that later events of a scene with another quantity can give.
      subroutine promise(number, companion)
         integer, intent(in) :: number, companion

         associate (values => result%values, levels => levels_of(result%values, companion))
            if (.not. any(is_present(values, number, levels))) call put(values, number, 0.0_wp &
               *levels)
         end associate
      end subroutine promise

   end subroutine list_applicable

   !> Fill in the values of the requested quantities.
   !>
   !> A result without sensitivities gives the peaks in their place.
   !> Counts and flags (1 or 0) are stored as reals. A quantity without a value, such as the time of
   !> an event that did not occur, is NaN.
   pure subroutine take_values(request, result, values, are_finite, round_off)
      type(request_t), intent(in) :: request
      type(result_t), intent(in) :: result
      real(wp), intent(inout) :: values(:)
      !! (quantities, then others that stay unchanged) [unit of each]
      logical, intent(out) :: are_finite
      !! no value that is present is infinite or NaN
      real(wp), allocatable, intent(inout), optional :: round_off(:)
      !! (quantities) changes that round-off can cause [unit of each]; only with sensitivities
      type(values_t) :: found
      integer :: numbers(size(request%place))
      !! (quantities) index in the table

      found = result_values(result)
      numbers = all_quantities(request%place)%id
      if (allocated(result%sensitivities)) numbers = merge(sensitivity_id(numbers), numbers, &
         request%is_sensitivity)
      associate (requested_values => values(:size(numbers)))
         requested_values = value_of(found, numbers, request%storey)
         are_finite = all(may_report(numbers, requested_values) .or. .not. is_present(found, &
            numbers, request%storey))
      end associate
      if (.not. (present(round_off) .and. any(request%is_sensitivity))) return
      round_off = round_off_of(found, numbers)
   end subroutine take_values

end module rwmf_spectrum_quantities
