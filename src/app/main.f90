!> Program `rwmf-batch`, which runs the cases of namelist files and writes CSV files.
program rwmf_batch
   use, intrinsic :: iso_fortran_env, only: error_unit
   use rwmf, only: case_t, compute_spectrum, control_t, err_input, err_interrupt, err_numerical, &
      error_t, instruction_set, read_case_file, result_t, simulate, spectrum_t, version, &
      write_result, write_spectrum
   use rwmf_app_cli, only: command_line_t, read_command_line, usage
   use rwmf_app_signals, only: ignore_file_limit, is_interrupted, watch_interrupts
   use rwmf_app_streams, only: fill_standard_streams, put
   use rwmf_core_error, only: add_context, fail
   use rwmf_core_kinds, only: wp
   use rwmf_output_csv, only: case_name, check_outputs
   use rwmf_output_preview, only: check_run
   use rwmf_problem_group_values, only: has_group
   use rwmf_problem_single_run, only: has_period
   use rwmf_spectrum_ordinates, only: spectrum_periods, status_of
   use rwmf_text_atomic_file, only: check_folder, join_path, remove_leftovers
   use rwmf_text_strings, only: integer_to_text, string_t
   implicit none

   integer, parameter :: warning_length = 256
   !! buffer length of one warning

   type(command_line_t) :: command_line
   type(error_t), allocatable :: error
   integer :: status

   status = 0
   call fill_standard_streams()
   call ignore_file_limit()
   call read_command_line(command_line, error)
   if (allocated(error)) then
      call report(error, status)
   else if (command_line%help) then
      call say(usage, status)
   else if (command_line%version) then
      call say('rwmf '//version//' ('//trim(instruction_set())//')', status)
   else
      call run_batch(command_line, status)
   end if
   ! no message: the status is for the shell
   stop status, quiet=.true.

contains

   !> Check all cases, then run one after the other.
   subroutine run_batch(command_line, status)
      type(command_line_t), intent(in) :: command_line
      integer, intent(out) :: status
      !! 0, or the status of the last case that failed
      type(case_t), allocatable :: cases(:)
      type(control_t) :: control
      type(error_t), allocatable :: error
      integer :: i

      call read_cases(command_line, cases, status)
      if (status /= 0) return
      call watch_interrupts(control)
      do i = 1, size(cases)
         if (is_interrupted()) then
            call fail(error, err_interrupt, command_line%cases(i)%text//': not begun: interrupted')
            call report(error, status)
         else
            call run_case(cases(i), command_line%cases(i)%text, command_line, control, status)
         end if
         ! a signal after the last file has no effect: all results are complete
         if (status == err_interrupt) return
      end do
   end subroutine run_batch

   !> Read and validate all files; report each invalid one.
   subroutine read_cases(command_line, cases, status)
      type(command_line_t), intent(in) :: command_line
      type(case_t), allocatable, intent(out) :: cases(:)
      !! (files)
      integer, intent(out) :: status
      type(error_t), allocatable :: error
      integer :: i

      status = 0
      allocate (cases(size(command_line%cases)))
      do i = 1, size(cases)
         call read_case_file(command_line%cases(i)%text, cases(i), error)
         if (.not. allocated(error)) call check_name(command_line%cases(:i), error)
         if (.not. allocated(error)) call take_part(command_line, i, cases(i), error)
         if (.not. allocated(error)) then
            call check_run(cases(i), error)
            if (allocated(error)) call add_context(error, command_line%cases(i)%text)
         end if
         call report(error, status)
      end do
      call check_folder(command_line%folder, error)
      call report(error, status)
      if (status /= 0) return
      call check_inputs(command_line, cases, error)
      call report(error, status)
      call remove_leftovers(command_line%folder)
   end subroutine read_cases

   !> Check that no output file of a case is an input file of any case.
   subroutine check_inputs(command_line, cases, error)
      type(command_line_t), intent(in) :: command_line
      type(case_t), intent(in) :: cases(:)
      !! (files)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: name
      integer :: reads
      integer :: writes

      do writes = 1, size(cases)
         call name_output(command_line%cases(writes)%text, command_line, name)
         do reads = 1, size(cases)
            call check_outputs(command_line%folder, name, cases(reads), error, &
               command_line%cases(reads)%text)
            if (allocated(error)) return
         end do
      end do
   end subroutine check_inputs

   !> Check that the last of these files does not write to the names of an earlier one.
   subroutine check_name(paths, error)
      type(string_t), intent(in) :: paths(:)
      !! (files up to the checked one)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      integer :: n

      n = size(paths)
      do i = 1, n - 1
         if (case_name(paths(i)%text) /= case_name(paths(n)%text)) cycle
         call fail(error, err_input, paths(n)%text//': writes to the same names as ' &
            //paths(i)%text//'; give one of them another name or run them apart')
         return
      end do
   end subroutine check_name

   !> Reduce a case to its share of the periods: every N-th one, so that all parts cost the same.
   subroutine take_part(command_line, number, case, error)
      type(command_line_t), intent(in) :: command_line
      integer, intent(in) :: number
      !! number of the case
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: T_s(:)

      if (command_line%parts == 1) return
      associate (path => command_line%cases(number)%text)
         if (.not. allocated(case%spectrum)) then
            call fail(error, err_input, path//': --part needs &spectrum: nothing to share out')
            return
         end if
         T_s = spectrum_periods(case%spectrum)
         if (command_line%part > size(T_s)) then
            call fail(error, err_input, path//': --part ' &
               //trim(part_name(command_line, '/'))//': there are more parts than periods')
            return
         end if
      end associate
      case%spectrum%T_s = T_s(command_line%part::command_line%parts)
   end subroutine take_part

   !> Name of the part, for messages and names of files; padded with blanks.
   pure function part_name(command_line, between) result(text)
      type(command_line_t), intent(in) :: command_line
      character(*), intent(in) :: between
      !! text between the two numbers
      character(40 + len(between)) :: text

      text = trim(integer_to_text(command_line%part))//between &
         //integer_to_text(command_line%parts)
   end function part_name

   !> Compose the beginning of the names of a case's files.
   subroutine name_output(path, command_line, name)
      character(*), intent(in) :: path
      !! path of the namelist
      type(command_line_t), intent(in) :: command_line
      character(:), allocatable, intent(out) :: name

      name = case_name(path)
      if (command_line%parts > 1) then
         name = name//'.part-'//trim(part_name(command_line, '-of-'))
      end if
   end subroutine name_output

   !> Run the simulation or the spectrum of a case, or both. With `--part` only the spectrum runs.
   subroutine run_case(case, path, command_line, control, status)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: path
      type(command_line_t), intent(in) :: command_line
      type(control_t), intent(in) :: control
      integer, intent(inout) :: status
      !! unchanged on success
      type(error_t), allocatable :: error
      character(warning_length), allocatable :: told(:)
      !! warnings already printed
      character(11), parameter :: names(3) = ['limits     ', 'sensitivity', 'design     ']
      character(:), allocatable :: given
      integer :: i

      allocate (told(0))
      ! print a note on groups that the command `rwmf` evaluates
      given = ''
      do i = 1, size(names)
         if (has_group(case%values, trim(names(i)))) given = given//', &'//trim(names(i))
      end do
      if (given /= '') call complain(path//': note: '//given(3:) &
         //': evaluated by the command rwmf only')
      if (has_period(case) .and. command_line%parts == 1) then
         call run_simulation(case, path, command_line%folder, control, told, status, error)
      end if
      if (.not. allocated(error) .and. allocated(case%spectrum)) then
         call run_spectrum(case, path, command_line, control, told, status, error)
      end if
      if (allocated(error)) call add_context(error, path)
      call report(error, status)
   end subroutine run_case

   !> Run one simulation and write summary and history.
   subroutine run_simulation(case, path, folder, control, told, status, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: path
      character(*), intent(in) :: folder
      type(control_t), intent(in) :: control
      character(warning_length), allocatable, intent(inout) :: told(:)
      integer, intent(inout) :: status
      !! unchanged if the message was printed
      type(error_t), allocatable, intent(out) :: error
      type(result_t) :: result

      call simulate(case, result, error, control)
      if (allocated(error)) return
      if (allocated(result%warnings)) call report_warnings(path, result%warnings, told)
      call write_result(case, result, folder, case_name(path), error, path, control)
      if (allocated(error)) return
      call say(path//': summary'//trim(merge(', history', '         ', allocated(result%history))) &
         //' written ('//milliseconds(result%seconds)//' s)', status)
   end subroutine run_simulation

   !> Compute and write the spectrum. Failed ordinates are NaN with a reason; the others are
   !> computed.
   subroutine run_spectrum(case, path, command_line, control, told, status, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: path
      type(command_line_t), intent(in) :: command_line
      type(control_t), intent(in) :: control
      character(warning_length), allocatable, intent(inout) :: told(:)
      integer, intent(inout) :: status
      !! unchanged if the message was printed
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: all_threads = 0
      type(spectrum_t) :: spectrum
      integer :: failed
      character(:), allocatable :: name

      call compute_spectrum(case, all_threads, spectrum, error, control)
      if (allocated(error)) return
      call report_warnings(path, spectrum%warnings, told)
      ! write a spectrum or a part of it
      call name_output(path, command_line, name)
      name = join_path(command_line%folder, name//'.spectrum.csv')
      if (command_line%parts == 1) then
         call write_spectrum(case, spectrum, name, error, control=control)
      else
         call write_spectrum(case, spectrum, name, error, trim(part_name(command_line, '/')), &
            control)
      end if
      if (allocated(error)) return
      associate (names => status_of(spectrum))
         failed = count(names /= 'ok' .and. names /= 'overturned' .and. names /= 'collapsed')
      end associate
      call say(path//': spectrum written ('//trim(integer_to_text(size(spectrum%status))) &
         //' ordinates, '//milliseconds(spectrum%seconds)//' s, ' &
         //trim(integer_to_text(spectrum%threads))//' threads)', status)
      if (failed > 0) call fail(error, err_numerical, trim(integer_to_text(failed))//' of ' &
         //trim(integer_to_text(size(spectrum%status))) &
         //' ordinates failed; the spectrum gives their reasons')
   end subroutine run_spectrum

   !> Print the warnings of a result, each once.
   subroutine report_warnings(path, warnings, told)
      character(*), intent(in) :: path
      character(*), intent(in) :: warnings(:)
      character(warning_length), allocatable, intent(inout) :: told(:)
      !! on return includes these warnings
      integer :: i

      do i = 1, size(warnings)
         if (any(told == warnings(i))) cycle
         told = [character(warning_length) :: told, warnings(i)]
         call complain(path//': warning: '//trim(warnings(i)))
      end do
   end subroutine report_warnings

   !> Print a line. Results are written even if the standard output is closed.
   subroutine say(line, status)
      character(*), intent(in) :: line
      integer, intent(inout) :: status
      !! unchanged on success
      type(error_t), allocatable :: error

      call put(line, error)
      call report(error, status)
   end subroutine say

   !> Print the message of an error, if there is one.
   subroutine report(error, status)
      type(error_t), allocatable, intent(in) :: error
      integer, intent(inout) :: status
      !! unchanged on success

      if (.not. allocated(error)) return
      status = error%stat
      call complain(error%message)
   end subroutine report

   !> Print a line on the standard error output, which may be closed.
   subroutine complain(line)
      character(*), intent(in) :: line
      integer :: status

      write (error_unit, '(a)', iostat=status) 'rwmf-batch: '//line
      if (status /= 0) return
   end subroutine complain

   !> Time with three decimals.
   pure function milliseconds(seconds) result(text)
      real(wp), intent(in) :: seconds
      !! [s]
      character(:), allocatable :: text
      character(40) :: digits
      integer :: status

      write (digits, '(f0.3)', iostat=status) seconds
      text = trim(digits)
      if (status /= 0) text = '*'
   end function milliseconds

end program rwmf_batch
