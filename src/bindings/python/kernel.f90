!> Kernel as flat procedures for f2py, in the extension `rwmf._kernel`.
!>
!> * A case is passed as namelist text, so that all users share one parser and one validation. It
!>   is read once and stored in the kernel behind a handle, from which everything is computed. Texts
!>   are bytes (UTF-8), because f2py rejects strings that are not ASCII.
!> * Text is returned as bytes. `length` is the required size; if the buffer is smaller, the caller
!>   calls again with a larger one.
!> * `status` is 0, 1 (numerical), 2 (input, output) or 130 (interrupted), with a message.
!> * Results are stored in the kernel behind a handle until they are freed. Any number of threads
!>   may use a case at once, because it is constant; only one thread at a time may use a result.
!> * The large arrays are not copied: the caller gets their address, valid until the handle is
!>   freed.
!>
!> f2py parses this file, which therefore uses kinds of iso_c_binding and plain `implicit none`.
module rwmf_bindings_python_kernel
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t, c_loc
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_bindings_python_handles, only: complete_case, find, free, keep, kept_t, &
      make_control, motion_of, put_error, put_text, sampled_case, split_names
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_version, only: kernel_version => version
   use rwmf_input_describe, only: describe_case
   use rwmf_input_schema, only: write_groups, write_schema
   use rwmf_integrator_lane_kernels, only: kernel_instructions => instruction_set
   use rwmf_model_no_tension_strip, only: base_moment, contact_length, settlement_stress, &
      strip_t, toe_stress
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_system_assembly, only: parameters_of
   use rwmf_motion_ground_motion, only: motion_end, motion_t, peak_acceleration
   use rwmf_output_csv, only: case_name, file_names, write_result, write_spectrum
   use rwmf_output_preview, only: preview_text
   use rwmf_output_summary, only: joined, summarise, summary_item_t, summary_text
   use rwmf_paper_coefficients, only: coefficients_a, coefficients_b
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: all_quantities, key_length, quantities_text
   use rwmf_problem_scene_axes, only: axis_t, list_axes
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_problem_usual_ranges, only: text_of_unusual => unusual_record
   use rwmf_simulation_peak_sensitivity, only: count_digits => digits_of
   use rwmf_simulation_quantity_words, only: find_meant => meant_quantity
   use rwmf_simulation_simulate, only: simulate_with_motion
   use rwmf_simulation_state_result, only: event_collapsed, event_impact, event_name
   use rwmf_simulation_warnings, only: list_case_warnings
   use rwmf_spectrum_quantities, only: default_quantity, requested_keys_of, list_applicable
   use rwmf_spectrum_ordinates, only: compute_rows, compute_spectrum
   use rwmf_spectrum_threads, only: kernel_most_threads => most_threads
   use rwmf_text_strings, only: real_to_text
   use rwmf_text_text_buffer, only: append, clear, text_buffer_t
   implicit none
   public

contains

   !> Version of the package.
   subroutine version(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: buffer
      integer(c_int), intent(out) :: length

      call put_text(kernel_version, buffer, length)
   end subroutine version

   !> Instruction set that spectra use on this processor.
   subroutine instruction_set(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length

      call put_text(trim(kernel_instructions()), buffer, length)
   end subroutine instruction_set

   !> Table of groups and keys, one key per line.
   subroutine schema(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: text

      call write_schema(text)
      call put_text(text, buffer, length)
   end subroutine schema

   !> Groups and their required groups, one per line.
   subroutine groups(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: text

      call write_groups(text)
      call put_text(text, buffer, length)
   end subroutine groups

   !> Table of output quantities, one per line.
   subroutine quantities(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: text

      call quantities_text(text)
      call put_text(text, buffer, length)
   end subroutine quantities

   !> Names of the kinds of events 1, 2, ..., one per line.
   subroutine event_names(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: names
      integer :: kind_number

      names = ''
      do kind_number = event_impact, event_collapsed
         names = names//event_name(kind_number)//new_line('a')
      end do
      call put_text(names, buffer, length)
   end subroutine event_names

   !> Free the memory behind a handle, which is invalid from then on.
   subroutine release(handle)
      integer(c_int64_t), intent(in) :: handle
      type(kept_t), pointer :: kept

      kept => find(handle)
      call free(kept)
   end subroutine release

   !> Describe all values of a case, including those that were not given.
   subroutine describe(handle, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept
      character(:), allocatable :: lines

      kept => find(handle)
      call describe_case(kept%case, lines)
      call put_text(lines, buffer, length)
   end subroutine describe

   !> Time of the end of the motion of a case, after which the ground is at rest [s].
   subroutine end_of_motion(handle, t)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: t
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion

      kept => find(handle)
      call motion_of(kept, room, motion)
      t = real(motion_end(motion), c_double)
   end subroutine end_of_motion

   !> Largest horizontal acceleration of the ground in a case [m/s2].
   subroutine peak_of_motion(handle, a)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: a
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion

      kept => find(handle)
      call motion_of(kept, room, motion)
      a = real(peak_acceleration(motion), c_double)
   end subroutine peak_of_motion

   !> List the spectrum axes of the scene of a case, one per line: name, value ('' for none), unit,
   !> meaning. The last line is the key of the default quantity.
   subroutine axes_of_case(handle, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(*), parameter :: tab = achar(9)
      type(kept_t), pointer :: kept
      type(axis_t), allocatable :: axes(:)
      character(:), allocatable :: lines, value
      integer :: i

      kept => find(handle)
      call list_axes(kept%case, axes)
      lines = ''
      do i = 1, size(axes)
         value = ''
         if (axes(i)%has_value) value = trim(real_to_text(axes(i)%value))
         lines = lines//trim(axes(i)%name)//tab//value//tab//trim(axes(i)%unit)//tab &
            //trim(axes(i)%meaning)//new_line('a')
      end do
      call put_text(lines//trim(default_quantity(kept%case)), buffer, length)
   end subroutine axes_of_case

   !> Preview the effects and outputs of a case; see `preview_text`.
   subroutine inventory(handle, buffer, length, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(case_t) :: case
      type(error_t), allocatable :: error
      character(:), allocatable :: lines

      length = 0_c_int
      kept => find(handle)
      call complete_case(kept, case)
      call preview_text(case, lines, error)
      if (.not. allocated(error)) call put_text(lines, buffer, length)
      call put_error(error, status, message, message_length)
   end subroutine inventory

   !> Method for a spectrum or rows of a case.
   subroutine spectrum_method(handle, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept

      kept => find(handle)
      call put_text(kept%case%solver%method, buffer, length)
   end subroutine spectrum_method

   !> List the warnings of a case, for its spectrum if it has one, separated by tabs.
   subroutine case_warnings(handle, keys, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: keys
      !! reported quantities, separated by tabs; '' for those of the case
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion
      character(key_length), allocatable :: reported(:)
      character(256), allocatable :: warnings(:)

      kept => find(handle)
      call motion_of(kept, room, motion)
      call split_names(keys, reported)
      if (keys == '') then
         reported = requested_keys_of(kept%case)
         if (allocated(kept%case%output)) then
            if (kept%case%output%reactions) reported = all_quantities%key
         end if
      end if
      call list_case_warnings(kept%case, motion, allocated(kept%case%spectrum), reported, warnings)
      call put_text(joined(warnings), buffer, length)
   end subroutine case_warnings

   !> List the warnings of a spectrum, separated by tabs.
   subroutine spectrum_warnings(sweep, buffer, length)
      integer(c_int64_t), intent(in) :: sweep
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept

      kept => find(sweep)
      call put_text(joined(kept%spectrum%warnings), buffer, length)
   end subroutine spectrum_warnings

   !> Run one simulation. `control` is (finished, cancel), read and set during the run.
   subroutine simulate(handle, control, run, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: run
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion
      type(error_t), allocatable :: error
      !f2py threadsafe

      from => find(handle)
      allocate (kept)
      allocate (kept%result)
      call motion_of(from, room, motion)
      call simulate_with_motion(from%case, motion, make_control(control), kept%result, error)
      call keep(kept, error, run)
      call put_error(error, status, message, message_length)
   end subroutine simulate

   !> List the named scalars of a run, with a line for each as in `summary_text`. Its number is in
   !> `reals` (kind 'real') or `counts` ('int', 'logical'), up to the sizes of these arrays.
   subroutine result_summary(handle, run, reals, counts, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: run
      real(c_double), intent(inout) :: reals(:)
      integer(c_int64_t), intent(inout) :: counts(:)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(summary_item_t), allocatable :: items(:)
      character(:), allocatable :: lines
      integer :: m

      from => find(handle)
      kept => find(run)
      call summarise(from%case, kept%result, items)
      m = min(size(reals), size(counts), size(items))
      reals(:m) = real(items(:m)%number, c_double)
      counts(:m) = int(items(:m)%count, c_int64_t)
      call summary_text(items, lines)
      call put_text(lines, buffer, length)
   end subroutine result_summary

   !> Return the address and shape of the history, stored as (rows, columns) column by column, and
   !> the number of events; 0 if absent.
   subroutine result_history(run, address, n_rows, n_columns, n_events)
      integer(c_int64_t), intent(in) :: run
      integer(c_int64_t), intent(out) :: address
      integer(c_int), intent(out) :: n_rows
      integer(c_int), intent(out) :: n_columns
      integer(c_int), intent(out) :: n_events
      type(kept_t), pointer :: kept

      kept => find(run)
      address = 0_c_int64_t
      n_rows = 0_c_int
      n_columns = 0_c_int
      n_events = 0_c_int
      if (allocated(kept%result%history)) then
         address = transfer(c_loc(kept%result%history%values), address)
         n_rows = size(kept%result%history%values, 1, c_int)
         n_columns = size(kept%result%history%values, 2, c_int)
      end if
      if (allocated(kept%result%events)) n_events = size(kept%result%events, kind=c_int)
   end subroutine result_history

   !> Names of the columns of the history, one per line.
   subroutine result_columns(run, buffer, length)
      integer(c_int64_t), intent(in) :: run
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept
      type(text_buffer_t) :: names
      integer :: i

      kept => find(run)
      call clear(names)
      if (allocated(kept%result%history)) then
         do i = 1, size(kept%result%history%names)
            call append(names, trim(kept%result%history%names(i))//new_line('a'))
         end do
      end if
      call put_text(names%room(:names%length), buffer, length)
   end subroutine result_columns

   !> Copy the events; `result_history` gives their number.
   subroutine result_events(run, kinds, t, theta, theta_dot)
      integer(c_int64_t), intent(in) :: run
      integer(c_int), intent(inout) :: kinds(:)
      real(c_double), intent(inout) :: t(:)
      real(c_double), intent(inout) :: theta(:)
      real(c_double), intent(inout) :: theta_dot(:)
      type(kept_t), pointer :: kept

      kept => find(run)
      if (.not. allocated(kept%result%events)) return
      kinds = int(kept%result%events%kind, c_int)
      t = real(kept%result%events%t, c_double)
      theta = real(kept%result%events%theta, c_double)
      theta_dot = real(kept%result%events%theta_dot, c_double)
   end subroutine result_events

   !> Names of the files that a run may write, named after `source`, one per line.
   subroutine result_names(source, buffer, length)
      character(*), intent(in) :: source
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: lines
      integer :: i

      lines = ''
      associate (names => file_names(case_name(source)))
         do i = 1, size(names)
            lines = lines//trim(names(i))//new_line('a')
         end do
      end associate
      call put_text(lines, buffer, length)
   end subroutine result_names

   !> Number of digits of a peak that hold in a run, from its tolerance and its sensitivity.
   subroutine digits_of(rtol, sensitivity, digits)
      real(c_double), intent(in) :: rtol
      real(c_double), intent(in) :: sensitivity
      integer(c_int), intent(out) :: digits

      digits = int(count_digits(rtol, sensitivity), c_int)
   end subroutine digits_of

   !> Warning about peak over g [-], mean interval and duration [s] of a record; empty for none.
   subroutine unusual_record(peak, interval, duration, buffer, length)
      real(c_double), intent(in) :: peak
      real(c_double), intent(in) :: interval
      real(c_double), intent(in) :: duration
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length

      call put_text(trim(text_of_unusual(peak, interval, duration)), buffer, length)
   end subroutine unusual_record

   !> Key of the output quantity that a word may mean; empty for none.
   subroutine meant_quantity(word, buffer, length)
      character(*), intent(in) :: word
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length

      call put_text(trim(find_meant(word)), buffer, length)
   end subroutine meant_quantity

   !> Write the files of a run, named after `source`, as the batch program does. `text` is the
   !> namelist text of the case, `control` (finished, cancel).
   subroutine result_write(handle, run, text, source, folder, control, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: run
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      character(*), intent(in) :: folder
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(case_t) :: case
      type(error_t), allocatable :: error
      !f2py threadsafe

      from => find(handle)
      kept => find(run)
      case = from%case
      case%text = text
      call write_result(case, kept%result, folder, case_name(source), error, source, &
         make_control(control))
      call put_error(error, status, message, message_length)
   end subroutine result_write

   !> Contact length [m], toe stress [Pa], moment [N m] and stress of the toe's settlement [Pa] of a
   !> strip under a base at each state.
   subroutine strip_under(width, thickness, k, strength, normal, phi, found)
      real(c_double), intent(in) :: width, thickness, k, strength
      real(c_double), intent(in) :: normal(:), phi(:)
      real(c_double), intent(inout) :: found(:, :)
      type(strip_t) :: strip

      strip = strip_t(width, thickness, k, strength)
      found(:, 1) = contact_length(strip, normal, phi)
      found(:, 2) = toe_stress(strip, normal, phi)
      found(:, 3) = base_moment(strip, normal, phi)
      found(:, 4) = settlement_stress(strip, normal, phi)
   end subroutine strip_under

   !> Coefficients of Eq. (15): `found(i, :)` is A_1 to A_4 if theta(i) [rad] is negative, -0
   !> included, otherwise B_1 to B_4.
   subroutine paper_coefficients(handle, theta, found, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: theta(:)
      real(c_double), intent(inout) :: found(:, :)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(parameters_t) :: p
      type(error_t), allocatable :: error
      integer :: i

      kept => find(handle)
      call check_single_run(kept%case, error)
      if (.not. allocated(kept%case%wall)) call fail(error, err_input, 'Eq. (15) needs &wall')
      if (.not. allocated(error)) then
         p = parameters_of(kept%case)
         do i = 1, size(theta)
            if (sign(1.0_c_double, theta(i)) < 0) then
               found(i, :) = coefficients_a(p, theta(i))
            else
               found(i, :) = coefficients_b(p, theta(i))
            end if
         end do
      end if
      call put_error(error, status, message, message_length)
   end subroutine paper_coefficients

   !> Largest number of threads for a spectrum on this machine.
   subroutine most_threads(n)
      integer(c_int), intent(out) :: n

      n = int(kernel_most_threads(), c_int)
   end subroutine most_threads

   !> Compute a spectrum with a number of threads (0: all). `keys` are those of the quantities (''
   !> for those of the case), separated by tabs; `control` is (finished, cancel).
   subroutine spectrum(handle, keys, threads, control, sweep, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: keys
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: sweep
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion
      type(case_t), pointer :: origin
      type(error_t), allocatable :: error
      character(key_length), allocatable :: wanted(:)
      !f2py threadsafe

      from => find(handle)
      origin => sampled_case(handle)
      call motion_of(from, room, motion)
      call split_names(keys, wanted)
      allocate (kept)
      allocate (kept%spectrum)
      call compute_spectrum(from%case, int(threads), kept%spectrum, error, make_control(control), &
         wanted, origin, motion)
      call keep(kept, error, sweep)
      call put_error(error, status, message, message_length)
   end subroutine spectrum

   !> Compute the rows of a table: runs of one case whose numbers differ.
   !>
   !> `columns` are the names of the columns, `keys` those of the quantities ('' for those of the
   !> case), separated by tabs; the table is (columns, rows). The result is a spectrum whose n_T is
   !> the number of rows.
   subroutine rows(handle, columns, table, keys, threads, control, sweep, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: columns
      real(c_double), intent(in), target :: table(:, :)
      character(*), intent(in) :: keys
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: sweep
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      type(case_t), target :: case
      character(key_length), allocatable :: names(:), wanted(:)
      !f2py threadsafe

      from => find(handle)
      call complete_case(from, case)
      call split_names(columns, names)
      call split_names(keys, wanted)
      allocate (kept)
      allocate (kept%spectrum)
      call compute_rows(case, names, table, wanted, int(threads), kept%spectrum, error, &
         make_control(control))
      call keep(kept, error, sweep)
      call put_error(error, status, message, message_length)
   end subroutine rows

   !> Sizes and cost of a spectrum.
   subroutine spectrum_shape(sweep, n_T, n_gamma, n_b, threads, rhs_evaluations, seconds)
      integer(c_int64_t), intent(in) :: sweep
      integer(c_int), intent(out) :: n_T
      integer(c_int), intent(out) :: n_gamma
      integer(c_int), intent(out) :: n_b
      integer(c_int), intent(out) :: threads
      integer(c_int64_t), intent(out) :: rhs_evaluations
      real(c_double), intent(out) :: seconds
      type(kept_t), pointer :: kept

      kept => find(sweep)
      n_T = size(kept%spectrum%values, 1, c_int)
      n_gamma = size(kept%spectrum%values, 2, c_int)
      n_b = size(kept%spectrum%values, 3, c_int)
      threads = int(kept%spectrum%threads, c_int)
      rhs_evaluations = int(kept%spectrum%rhs_evaluations, c_int64_t)
      seconds = real(kept%spectrum%seconds, c_double)
   end subroutine spectrum_shape

   !> Copy the axes in the sizes of `spectrum_shape`; return the address of the values (n_T,
   !> n_gamma, n_b, n_quantities), T_s varying fastest. The gamma and b of a bare frame are NaN, as
   !> are all axes of rows.
   subroutine spectrum_values(sweep, T_s, gamma, b, address)
      integer(c_int64_t), intent(in) :: sweep
      real(c_double), intent(inout) :: T_s(:)
      real(c_double), intent(inout) :: gamma(:)
      real(c_double), intent(inout) :: b(:)
      integer(c_int64_t), intent(out) :: address
      type(kept_t), pointer :: kept

      kept => find(sweep)
      T_s = ieee_value(1.0_c_double, ieee_quiet_nan)
      gamma = ieee_value(1.0_c_double, ieee_quiet_nan)
      b = ieee_value(1.0_c_double, ieee_quiet_nan)
      if (allocated(kept%spectrum%T_s)) T_s = real(kept%spectrum%T_s, c_double)
      if (allocated(kept%spectrum%gamma)) gamma = real(kept%spectrum%gamma, c_double)
      if (allocated(kept%spectrum%b)) b = real(kept%spectrum%b, c_double)
      address = transfer(c_loc(kept%spectrum%values), address)
   end subroutine spectrum_values

   !> Keys of the quantities of a spectrum, separated by tabs.
   subroutine spectrum_quantities(sweep, buffer, length)
      integer(c_int64_t), intent(in) :: sweep
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept

      kept => find(sweep)
      call put_text(joined(kept%spectrum%quantities), buffer, length)
   end subroutine spectrum_quantities

   !> Keys of the demands that `&limits` of a case requests, separated by tabs.
   subroutine limited_demands(handle, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept
      character(:), allocatable :: text

      kept => find(handle)
      text = ''
      if (allocated(kept%case%output)) then
         if (allocated(kept%case%output%limited)) text = joined(kept%case%output%limited)
      end if
      call put_text(text, buffer, length)
   end subroutine limited_demands

   !> Keys of the quantities applicable to a spectrum of the scene, separated by tabs.
   subroutine applicable(handle, buffer, length, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(motion_t), target :: room
      type(motion_t), pointer :: motion
      type(error_t), allocatable :: error
      character(key_length), allocatable :: keys(:)

      length = 0_c_int
      kept => find(handle)
      call motion_of(kept, room, motion)
      call list_applicable(kept%case, motion, keys, error)
      if (.not. allocated(error)) call put_text(joined(keys), buffer, length)
      call put_error(error, status, message, message_length)
   end subroutine applicable

   !> Return the status of the ordinates: positions, from 1, in the table of names, in the order of
   !> the array (T_s, gamma, b). The names are separated by tabs.
   subroutine spectrum_status(sweep, places, buffer, length)
      integer(c_int64_t), intent(in) :: sweep
      integer(c_int8_t), intent(inout) :: places(:)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept

      kept => find(sweep)
      places = reshape(kept%spectrum%status, shape(places))
      call put_text(joined(kept%spectrum%status_names), buffer, length)
   end subroutine spectrum_status

   !> Write a spectrum as the batch program does. `text` is the namelist text of the case.
   subroutine spectrum_write(handle, sweep, text, path, control, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: sweep
      character(*), intent(in) :: text
      character(*), intent(in) :: path
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(case_t) :: case
      type(error_t), allocatable :: error
      !f2py threadsafe

      from => find(handle)
      kept => find(sweep)
      case = from%case
      case%text = text
      call write_spectrum(case, kept%spectrum, path, error, control=make_control(control))
      call put_error(error, status, message, message_length)
   end subroutine spectrum_write

end module rwmf_bindings_python_kernel
