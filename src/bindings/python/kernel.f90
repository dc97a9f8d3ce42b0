!> The kernel as flat procedures for f2py: the extension `rwmf._kernel`.
!>
!> * A case enters as namelist text, so that all users share one parser and one validation. Texts
!>   come as bytes (UTF-8): f2py refuses strings that are not ASCII.
!> * Text leaves as bytes: `length` is what the text needs; when the buffer is smaller, the caller
!>   asks again with a larger one.
!> * `status` is 0, 1 (numerical), 2 (input, output) or 130 (interrupted), with a message.
!> * Results stay in the kernel behind a handle until they are freed; a handle is used by one
!>   thread at a time.
!>
!> f2py reads this file: kinds of iso_c_binding, plain `implicit none`, explicit shapes.
module rwmf_bindings_python_kernel
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_bindings_python_handles, only: find_run, find_sweep, join_status, keep_run, &
      keep_sweep, make_control, put_error, put_text, read_source, run_t, sweep_t
   use rwmf_core_error, only: error_t
   use rwmf_core_version, only: kernel_version => version
   use rwmf_input_describe, only: describe_case
   use rwmf_input_schema, only: schema_text
   use rwmf_motion_ground_motion, only: motion_end, motion_from_case
   use rwmf_output_csv, only: case_name, write_result, write_spectrum
   use rwmf_output_preview, only: preview_text
   use rwmf_output_summary, only: summarise, summary_item_t, summary_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_quantities, only: quantities_text
   use rwmf_simulation_result, only: event_impact, event_name, event_rupture
   use rwmf_simulation_simulate, only: run_simulation => simulate
   use rwmf_spectrum_fast_simd_dispatch, only: kernel_instructions => instruction_set
   use rwmf_spectrum_spectrum, only: compute_spectrum
   implicit none
   public

contains

   !> Version of the package.
   subroutine version(n, buffer, length)
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: buffer
      integer(c_int), intent(out) :: length

      call put_text(kernel_version, buffer, length)
   end subroutine version

   !> Instructions that method 'fast' uses on this processor.
   subroutine instruction_set(n, buffer, length)
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length

      call put_text(trim(kernel_instructions()), buffer, length)
   end subroutine instruction_set

   !> The table of groups and keys, one key a line.
   subroutine schema(n, buffer, length)
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length

      call put_text(schema_text(), buffer, length)
   end subroutine schema

   !> The table of output quantities, one a line.
   subroutine quantities(n, buffer, length)
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: text

      call quantities_text(text)
      call put_text(text, buffer, length)
   end subroutine quantities

   !> Names of the kinds of events 1, 2, ..., one a line.
   subroutine event_names(n, buffer, length)
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      character(:), allocatable :: names
      integer :: kind_number

      names = ''
      do kind_number = event_impact, event_rupture
         names = names//event_name(kind_number)//new_line('a')
      end do
      call put_text(names, buffer, length)
   end subroutine event_names

   !> Read and validate a case, return all its values with those that were not given.
   subroutine describe(text, source, n, buffer, length, status, n_message, message, message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(case_t) :: the_case
      type(error_t), allocatable :: error

      length = 0_c_int
      call read_source(text, source, the_case, error)
      ! texts: one thread at a time, see `read_case_text`
      !$omp critical (rwmf_text)
      if (.not. allocated(error)) call put_text(describe_case(the_case), buffer, length)
      !$omp end critical (rwmf_text)
      call put_error(error, status, message, message_length)
   end subroutine describe

   !> End of the motion of a case, after which the ground is still [s].
   subroutine end_of_motion(text, source, t, status, n_message, message, message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      real(c_double), intent(out) :: t
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(case_t) :: the_case
      type(error_t), allocatable :: error

      t = 0.0_c_double
      call read_source(text, source, the_case, error)
      if (.not. allocated(error)) t = real(motion_end(motion_from_case(the_case)), c_double)
      call put_error(error, status, message, message_length)
   end subroutine end_of_motion

   !> Read and validate a case, return what it will simulate and report.
   subroutine inventory(text, source, n, buffer, length, status, n_message, message, message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(case_t) :: the_case
      type(error_t), allocatable :: error
      character(:), allocatable :: lines

      length = 0_c_int
      call read_source(text, source, the_case, error)
      if (.not. allocated(error)) call preview_text(the_case, lines, error)
      ! texts: one thread at a time, see `read_case_text`
      !$omp critical (rwmf_text)
      if (.not. allocated(error)) call put_text(lines, buffer, length)
      !$omp end critical (rwmf_text)
      call put_error(error, status, message, message_length)
   end subroutine inventory

   !> Run one simulation. `control` is (finished, cancel), read and set while this runs.
   subroutine simulate(text, source, control, handle, status, n_message, message, message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(run_t), pointer :: run
      type(error_t), allocatable :: error
      !f2py threadsafe

      handle = 0_c_int64_t
      allocate (run)
      call read_source(text, source, run%case, error)
      if (.not. allocated(error)) then
         call run_simulation(run%case, run%result, error, make_control(control))
      end if
      if (allocated(error)) then
         deallocate (run)
      else
         handle = keep_run(run)
      end if
      call put_error(error, status, message, message_length)
   end subroutine simulate

   !> The named scalars of a run as lines `key<TAB>kind<TAB>value`.
   subroutine result_summary(handle, n, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      type(run_t), pointer :: run
      type(summary_item_t), allocatable :: items(:)

      run => find_run(handle)
      !$omp critical (rwmf_text)
      call summarise(run%case, run%result, items)
      call put_text(summary_text(items), buffer, length)
      !$omp end critical (rwmf_text)
   end subroutine result_summary

   !> Sizes of the history and of the list of events; 0 where there is none.
   subroutine result_shape(handle, n_rows, n_columns, n_events)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: n_rows
      integer(c_int), intent(out) :: n_columns
      integer(c_int), intent(out) :: n_events
      type(run_t), pointer :: run

      run => find_run(handle)
      n_rows = 0_c_int
      n_columns = 0_c_int
      n_events = 0_c_int
      if (allocated(run%result%history)) then
         n_rows = size(run%result%history%values, 1, c_int)
         n_columns = size(run%result%history%values, 2, c_int)
      end if
      if (allocated(run%result%events)) n_events = size(run%result%events, kind=c_int)
   end subroutine result_shape

   !> Names of the columns of the history, one a line.
   subroutine result_columns(handle, n, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      type(run_t), pointer :: run
      character(:), allocatable :: names
      integer :: i

      run => find_run(handle)
      names = ''
      if (allocated(run%result%history)) then
         do i = 1, size(run%result%history%names)
            names = names//trim(run%result%history%names(i))//new_line('a')
         end do
      end if
      call put_text(names, buffer, length)
   end subroutine result_columns

   !> The history, in the sizes of `result_shape`.
   subroutine result_history(handle, n_rows, n_columns, values)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n_rows
      integer(c_int), intent(in) :: n_columns
      real(c_double), intent(inout) :: values(n_rows, n_columns)
      type(run_t), pointer :: run

      run => find_run(handle)
      if (allocated(run%result%history)) values = real(run%result%history%values, c_double)
   end subroutine result_history

   !> The events, in the number of `result_shape`.
   subroutine result_events(handle, n, kinds, t, theta, theta_dot)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(inout) :: kinds(n)
      real(c_double), intent(inout) :: t(n)
      real(c_double), intent(inout) :: theta(n)
      real(c_double), intent(inout) :: theta_dot(n)
      type(run_t), pointer :: run

      run => find_run(handle)
      if (.not. allocated(run%result%events)) return
      kinds = int(run%result%events%kind, c_int)
      t = real(run%result%events%t, c_double)
      theta = real(run%result%events%theta, c_double)
      theta_dot = real(run%result%events%theta_dot, c_double)
   end subroutine result_events

   !> Write the files of a run, named after `source`, as the batch program does.
   subroutine result_write(handle, source, folder, status, n_message, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: source
      character(*), intent(in) :: folder
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(run_t), pointer :: run
      type(error_t), allocatable :: error

      run => find_run(handle)
      call write_result(run%case, run%result, folder, case_name(source), error)
      call put_error(error, status, message, message_length)
   end subroutine result_write

   !> Give back the memory of a run; its handle is void from then on.
   subroutine result_free(handle)
      integer(c_int64_t), intent(in) :: handle
      type(run_t), pointer :: run

      run => find_run(handle)
      deallocate (run)
   end subroutine result_free

   !> Compute a spectrum with so many threads (0: all). `control` is (finished, cancel).
   subroutine spectrum(text, source, threads, control, handle, status, n_message, message, &
      message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(sweep_t), pointer :: sweep
      type(error_t), allocatable :: error
      !f2py threadsafe

      handle = 0_c_int64_t
      allocate (sweep)
      call read_source(text, source, sweep%case, error)
      if (.not. allocated(error)) then
         call compute_spectrum(sweep%case, int(threads), sweep%spectrum, error, &
            make_control(control))
      end if
      if (allocated(error)) then
         deallocate (sweep)
      else
         handle = keep_sweep(sweep)
      end if
      call put_error(error, status, message, message_length)
   end subroutine spectrum

   !> Sizes and cost of a spectrum; `bare` is 1 for a frame without wall (no gamma, no b).
   subroutine spectrum_shape(handle, n_T, n_gamma, n_b, bare, threads, rhs_evaluations, seconds)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: n_T
      integer(c_int), intent(out) :: n_gamma
      integer(c_int), intent(out) :: n_b
      integer(c_int), intent(out) :: bare
      integer(c_int), intent(out) :: threads
      integer(c_int64_t), intent(out) :: rhs_evaluations
      real(c_double), intent(out) :: seconds
      type(sweep_t), pointer :: sweep

      sweep => find_sweep(handle)
      n_T = size(sweep%spectrum%u_s_max, 1, c_int)
      n_gamma = size(sweep%spectrum%u_s_max, 2, c_int)
      n_b = size(sweep%spectrum%u_s_max, 3, c_int)
      bare = merge(0_c_int, 1_c_int, allocated(sweep%spectrum%gamma))
      threads = int(sweep%spectrum%threads, c_int)
      rhs_evaluations = int(sweep%spectrum%rhs_evaluations, c_int64_t)
      seconds = real(sweep%spectrum%seconds, c_double)
   end subroutine spectrum_shape

   !> The spectrum, in the sizes of `spectrum_shape`; gamma and b of a bare frame are NaN.
   subroutine spectrum_values(handle, n_T, n_gamma, n_b, T_s, gamma, b, u_s_max)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n_T
      integer(c_int), intent(in) :: n_gamma
      integer(c_int), intent(in) :: n_b
      real(c_double), intent(inout) :: T_s(n_T)
      real(c_double), intent(inout) :: gamma(n_gamma)
      real(c_double), intent(inout) :: b(n_b)
      real(c_double), intent(inout) :: u_s_max(n_T, n_gamma, n_b)
      type(sweep_t), pointer :: sweep

      sweep => find_sweep(handle)
      T_s = real(sweep%spectrum%T_s, c_double)
      gamma = ieee_value(1.0_c_double, ieee_quiet_nan)
      b = ieee_value(1.0_c_double, ieee_quiet_nan)
      if (allocated(sweep%spectrum%gamma)) gamma = real(sweep%spectrum%gamma, c_double)
      if (allocated(sweep%spectrum%b)) b = real(sweep%spectrum%b, c_double)
      u_s_max = real(sweep%spectrum%u_s_max, c_double)
   end subroutine spectrum_values

   !> What became of the ordinates, one a line in the order of the array (T_s, gamma, b).
   subroutine spectrum_status(handle, n, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int8_t), intent(inout) :: buffer(n)
      integer(c_int), intent(out) :: length
      type(sweep_t), pointer :: sweep

      sweep => find_sweep(handle)
      call put_text(join_status(sweep), buffer, length)
   end subroutine spectrum_status

   !> Write a spectrum as the batch program does.
   subroutine spectrum_write(handle, path, status, n_message, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: path
      integer(c_int), intent(out) :: status
      integer(c_int), intent(in) :: n_message
      integer(c_int8_t), intent(inout) :: message(n_message)
      integer(c_int), intent(out) :: message_length
      type(sweep_t), pointer :: sweep
      type(error_t), allocatable :: error

      sweep => find_sweep(handle)
      call write_spectrum(sweep%case, sweep%spectrum, path, error)
      call put_error(error, status, message, message_length)
   end subroutine spectrum_write

   !> Give back the memory of a spectrum; its handle is void from then on.
   subroutine spectrum_free(handle)
      integer(c_int64_t), intent(in) :: handle
      type(sweep_t), pointer :: sweep

      sweep => find_sweep(handle)
      deallocate (sweep)
   end subroutine spectrum_free

end module rwmf_bindings_python_kernel
