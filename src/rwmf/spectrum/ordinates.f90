!> Response spectra: parallel runs over frame periods, mass ratios and wall widths, or over the
!> rows of a table.
module rwmf_spectrum_ordinates
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only: int8
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_error, only: err_input, err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_math_ordering, only: rising_order
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_problem_quantity_table, only: canonical_key, key_length
   use rwmf_problem_single_run, only: check_tolerance
   use rwmf_simulation_simulate, only: check_peak, simulate_with_motion
   use rwmf_simulation_state_result, only: ending_name, result_t
   use rwmf_simulation_warnings, only: list_case_warnings
   use rwmf_spectrum_estimates, only: run_with_estimates
   use rwmf_spectrum_lane_rows, only: ordinate_t, queue_t, refused
   use rwmf_spectrum_quantities, only: request_of, check_request, requested_keys_of, take_values, &
      with_sensitivities
   use rwmf_spectrum_rows, only: period_of, row_motion, rows_of_grid, &
      rows_of_table, rows_t, spectrum_periods, take_row
   use rwmf_spectrum_threads, only: choose_threads
   implicit none
   private

   public :: spectrum_t, compute_spectrum, compute_rows, spectrum_periods, status_of

   integer, parameter :: block_size = 8192
   !! rows computed at a time, which bounds the memory for intermediate data of large tables
   character(*), parameter :: interrupted = 'interrupted'

   !> Results over the grid of a `&spectrum` group, or over the rows of a table.
   !>
   !> The rows of a table are the first dimension; the second and third then have size 1.
   type :: spectrum_t
      real(wp), allocatable :: T_s(:)
      !! (n_T) periods [s]; not allocated for a table, like the following two
      real(wp), allocatable :: gamma(:)
      !! (n_gamma) mass ratios [-]; absent for the bare frame and for a block
      real(wp), allocatable :: b(:)
      !! (n_b) half widths [m]; absent for the bare frame
      character(key_length), allocatable :: quantities(:)
      !! (n_quantities) keys of the requested quantities
      real(wp), allocatable :: values(:, :, :, :)
      !! (n_T, n_gamma, n_b, n_quantities) [unit of each]; counts and flags (1 or 0) are stored as
      !! reals. NaN where the simulation failed or the quantity has no value
      integer(int8), allocatable :: status(:, :, :)
      !! (n_T, n_gamma, n_b) index into `status_names`; `status_of` returns the names
      character(24), allocatable :: status_names(:)
      !! 'ok', 'overturned', 'collapsed', 'inaccurate', 'refused' or the name of an error.
      !! 'inaccurate': the values are the best available, but err by more than `accuracy`.
      !! 'refused': the rules of the case do not allow the numbers of the row
      integer(i8) :: rhs_evaluations
      real(wp) :: seconds
      !! wall-clock time [s]
      integer :: threads
      !! number of threads used
      character(256), allocatable :: warnings(:)
      !! warnings that concern all ordinates
   end type spectrum_t

contains

   !> Compute the spectrum of a case's `&spectrum` group.
   !>
   !> Each ordinate is a separate simulation, so the result is bitwise identical for every number
   !> of threads. An ordinate that fails gets NaN and the name of its error; the others continue.
   subroutine compute_spectrum(case, threads, spectrum, error, control, quantities, origin, &
      known_motion)
      type(case_t), intent(in), target :: case
      integer, intent(in) :: threads
      !! number of threads; 0 for all that OpenMP offers
      type(spectrum_t), intent(out) :: spectrum
      type(error_t), allocatable, intent(out) :: error
      !! no `&spectrum`, quantities that do not apply, too many threads, no memory, or interrupted
      type(control_t), intent(in), optional :: control
      character(*), intent(in), optional :: quantities(:)
      !! keys of the quantities of each ordinate; absent or empty: those of the case
      type(case_t), intent(in), target, optional :: origin
      !! original of a changed case, which holds the samples of its records
      type(motion_t), intent(in), target, optional :: known_motion
      !! motion of the case, if the caller has built it already
      type(rows_t), target :: rows
      integer :: sizes(3)

      if (.not. allocated(case%spectrum)) then
         call fail(error, err_input, 'no &spectrum group: nothing to loop over')
         return
      end if
      call rows_of_grid(case, rows, error, origin)
      if (allocated(error)) return
      spectrum%T_s = rows%T_s
      sizes = [size(rows%T_s), 1, 1]
      if (allocated(rows%gamma)) then
         spectrum%gamma = rows%gamma
         sizes(2) = size(rows%gamma)
      end if
      if (allocated(rows%b)) then
         spectrum%b = rows%b
         sizes(3) = size(rows%b)
      end if
      call compute(rows, sizes, wanted_keys(case, quantities), threads, spectrum, error, control, &
         known_motion)
   end subroutine compute_spectrum

   !> Compute the rows of a table: runs of one case with different numbers.
   !>
   !> Each row is bitwise identical to the same case run by itself. A row that the rules of the case
   !> refuse, or that fails, gets NaN; the others continue.
   subroutine compute_rows(case, columns, values, quantities, threads, spectrum, error, control)
      type(case_t), intent(in), target :: case
      !! common data of the rows; only the quantities of `&spectrum` apply
      character(*), intent(in) :: columns(:)
      !! (columns) 'T_s', 'gamma', 'b', 'scale' (factor on the horizontal motion) or 'group.key'
      real(wp), intent(in), target, contiguous :: values(:, :)
      !! (columns, rows) each in the unit of its key
      character(*), intent(in) :: quantities(:)
      !! keys of the quantities of each row; empty: those of the case
      integer, intent(in) :: threads
      !! number of threads; 0 for all that OpenMP offers
      type(spectrum_t), intent(out) :: spectrum
      !! (rows, 1, 1, quantities)
      type(error_t), allocatable, intent(out) :: error
      !! columns that cannot vary, and the errors of `compute_spectrum`
      type(control_t), intent(in), optional :: control
      type(rows_t), target :: rows
      integer :: sizes(3)

      call rows_of_table(case, columns, values, rows, error)
      if (allocated(error)) return
      sizes = [rows%n, 1, 1]
      call compute(rows, sizes, wanted_keys(case, quantities), threads, spectrum, error, control)
   end subroutine compute_rows

   !> Keys of the quantities to report.
   pure function wanted_keys(case, quantities) result(keys)
      type(case_t), intent(in) :: case
      character(*), intent(in), optional :: quantities(:)
      !! (quantities) keys; of size 0 for those of the case
      character(key_length), allocatable :: keys(:)

      keys = requested_keys_of(case)
      if (present(quantities)) then
         if (size(quantities) > 0) keys = canonical_key(quantities)
      end if
      keys = with_sensitivities(case, keys)
   end function wanted_keys

   !> Compute all rows.
   subroutine compute(rows, sizes, keys, threads, spectrum, error, control, known_motion)
      type(rows_t), intent(in), target :: rows
      integer, intent(in) :: sizes(3)
      !! shape of the results
      character(*), intent(in) :: keys(:)
      !! (quantities)
      integer, intent(in) :: threads
      type(spectrum_t), intent(inout), target :: spectrum
      type(error_t), allocatable, intent(out) :: error
      type(control_t), intent(in), optional :: control
      type(motion_t), intent(in), target, optional :: known_motion
      !! motion common to all rows
      type(queue_t) :: queue
      type(motion_t), target :: motion
      type(control_t) :: signals
      integer(i8) :: started, finished, rate

      call choose_threads(threads, spectrum%threads, error)
      if (.not. allocated(error)) call check_tolerance(rows%case, error)
      if (allocated(error)) return
      if (present(control)) signals = control
      call system_clock(started, rate)
      if (present(known_motion)) then
         queue%motion => known_motion
      else
         motion = motion_from_case(rows%case, rows%origin)
         queue%motion => motion
      end if
      call check_request(rows%case, queue%motion, keys, error)
      if (.not. allocated(error)) call check_peak(rows%case, queue%motion, error)
      if (.not. allocated(error)) call make_room(sizes, keys, spectrum, error)
      if (allocated(error)) return
      queue%rows => rows
      queue%request = request_of(rows%case, keys)
      call list_case_warnings(rows%case, queue%motion, .not. associated(rows%table), keys, &
         spectrum%warnings)
      call run_rows(queue, signals, spectrum)
      call system_clock(finished)
      spectrum%seconds = real(finished - started, wp)/real(rate, wp)
      if (is_cancelled(signals)) call fail(error, err_interrupt, 'spectrum interrupted')
   end subroutine compute

   !> Allocate the results and mark all of them as not computed.
   pure subroutine make_room(sizes, keys, spectrum, error)
      integer, intent(in) :: sizes(3)
      character(*), intent(in) :: keys(:)
      type(spectrum_t), intent(inout) :: spectrum
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      allocate (spectrum%status(sizes(1), sizes(2), sizes(3)), stat=status)
      if (status == 0) allocate (spectrum%values(sizes(1), sizes(2), sizes(3), size(keys)), &
         stat=status)
      if (status /= 0) then
         call fail(error, err_numerical, 'out of memory for the spectrum', 'out_of_memory')
         return
      end if
      spectrum%quantities = keys
      spectrum%values = ieee_value(1.0_wp, ieee_quiet_nan)
      spectrum%status_names = [character(24) :: interrupted, 'ok', 'overturned', 'collapsed', &
         'inaccurate', refused]
      spectrum%status = 1
      spectrum%rhs_evaluations = 0_i8
   end subroutine make_room

   !> Status names of the ordinates.
   pure function status_of(spectrum) result(names)
      type(spectrum_t), intent(in) :: spectrum
      character(24) :: names(size(spectrum%status, 1), size(spectrum%status, 2), &
         size(spectrum%status, 3))
      !! (n_T, n_gamma, n_b)
      integer :: i, j, k

      do concurrent(i=1:size(names, 1), j=1:size(names, 2), k=1:size(names, 3))
         names(i, j, k) = spectrum%status_names(spectrum%status(i, j, k))
      end do
   end function status_of

   !> Compute all rows, one block after the other.
   subroutine run_rows(queue, control, spectrum)
      type(queue_t), intent(in) :: queue
      type(control_t), intent(in) :: control
      type(spectrum_t), intent(inout), target :: spectrum
      real(wp), pointer :: values(:, :)
      integer(int8), pointer :: codes(:)
      character(24), allocatable :: status(:)
      integer(i8) :: evaluations
      integer :: first, last, i, place
      logical :: in_lanes

      ! lanes share the settings of their error estimates
      associate (case => queue%rows%case)
         in_lanes = (case%solver%method == 'auto' .or. case%solver%method == 'dop853') &
            .and. .not. allocated(case%compliant_base) .and. .not. queue%rows%has_own_estimate
      end associate
      evaluations = 0
      associate (n => queue%rows%n)
         values(1:n, 1:size(spectrum%quantities)) => spectrum%values
         codes(1:n) => spectrum%status
         do first = 1, n, block_size
            last = min(n, first + block_size - 1)
            if (allocated(status)) deallocate (status)
            allocate (status(last - first + 1))
            status = interrupted
            if (in_lanes) then
               call run_lanes(queue, first, spectrum%threads, control, values(first:last, :), &
                  status, evaluations)
            else
               !$omp parallel do num_threads(spectrum%threads) schedule(dynamic) &
               !$omp default(shared) reduction(+:evaluations)
               do i = first, last
                  call run_one(queue, i, control, values(i, :), status(i - first + 1), evaluations)
               end do
               !$omp end parallel do
            end if
            spectrum%rhs_evaluations = evaluations
            do i = first, last
               ! find the index of a status name; append the name if it is new
               do place = 1, size(spectrum%status_names)
                  if (spectrum%status_names(place) == status(i - first + 1)) exit
               end do
               if (place > size(spectrum%status_names)) spectrum%status_names = &
                  [spectrum%status_names, status(i - first + 1)]
               codes(i) = int(place, int8)
            end do
            if (is_cancelled(control)) return
         end do
      end associate
   end subroutine run_rows

   !> Compute the rows of a block in lanes, the shortest periods first.
   !>
   !> These runs take longest; starting them first avoids a long run at the end.
   subroutine run_lanes(queue, first, threads, control, values, status, evaluations)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: first
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      real(wp), intent(inout) :: values(:, :)
      character(24), intent(inout) :: status(:)
      integer(i8), intent(inout) :: evaluations
      type(ordinate_t), allocatable :: ordinates(:)
      integer, allocatable :: order(:)
      real(wp), allocatable :: T_s(:)
      integer :: i, m

      T_s = [(period_of(queue%rows, first + i - 1), i=1, size(status))]
      order = rising_order(T_s)
      allocate (ordinates(size(order)))
      ordinates%row = first + order - 1
      call run_with_estimates(queue, threads, control, ordinates)
      if (is_cancelled(control)) return
      evaluations = evaluations + sum(ordinates%rhs_evaluations)
      do m = 1, size(order)
         i = order(m)
         status(i) = ordinates(m)%failure
         if (ordinates(m)%failure /= '') cycle
         if (allocated(ordinates(m)%values)) then
            values(i, :) = ordinates(m)%values
         else
            values(i, :) = ordinates(m)%peak
         end if
         status(i) = merge('overturned', 'ok        ', ordinates(m)%overturned)
         if (ordinates(m)%collapsed) status(i) = 'collapsed'
         if (ordinates(m)%is_inaccurate) status(i) = 'inaccurate'
      end do
   end subroutine run_lanes

   !> Compute one row by the general kernel. Thread-safe: all work space is local.
   subroutine run_one(queue, number, control, values, status, evaluations)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: number
      !! number of the row
      type(control_t), intent(in) :: control
      real(wp), intent(inout) :: values(:)
      !! (quantities)
      character(24), intent(inout) :: status
      integer(i8), intent(inout) :: evaluations
      type(case_t) :: row
      type(result_t) :: result
      type(error_t), allocatable :: error
      logical :: are_finite

      if (is_cancelled(control)) return
      call take_row(queue%rows, number, row, error)
      if (allocated(error)) then
         status = refused
         call count_done(control)
         return
      end if
      if (allocated(row%output)) deallocate (row%output)
      if (allocated(queue%request%output)) row%output = queue%request%output
      if (.not. allocated(row%output)) row%output = output_t(energy=.false.)
      row%output%conditioning = any(queue%request%is_sensitivity)
      ! rows with a common motion do not describe it
      if (.not. allocated(row%motion) .and. allocated(queue%rows%case%motion)) row%motion = &
         queue%rows%case%motion
      if (queue%rows%has_own_motion) then
         call simulate_with_motion(row, row_motion(queue%rows, row), control, result, error)
      else
         call simulate_with_motion(row, queue%motion, control, result, error)
      end if
      call count_done(control)
      if (allocated(error)) then
         status = error%name
         return
      end if
      ! the run has already been checked for finite numbers
      call take_values(queue%request, result, values, are_finite)
      if (.not. allocated(result%sensitivities)) where (queue%request%is_sensitivity) values = &
         ieee_value(1.0_wp, ieee_quiet_nan)
      status = ending_name(result)
      if (allocated(row%solver%accuracy) .and. allocated(result%estimated_relative_error)) then
         if (result%estimated_relative_error > row%solver%accuracy) status = 'inaccurate'
      end if
      evaluations = evaluations + result%rhs_evaluations
   end subroutine run_one

end module rwmf_spectrum_ordinates
