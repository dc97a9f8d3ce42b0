!> CSV files of a run and of a spectrum.
!>
!> Lines that start with '#' contain the data to repeat the computation: version, record with its
!> checksum, the text of the case. One line of column names with units follows, then numbers that
!> round-trip to the same bits.
module rwmf_output_csv
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_interrupt, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_core_version, only: version
   use rwmf_output_summary, only: summarise, summary_item_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_record, only: record_t, upward_group
   use rwmf_problem_scene_axes, only: axis_t, list_axes
   use rwmf_simulation_state_history, only: history_t
   use rwmf_simulation_state_result, only: result_t
   use rwmf_spectrum_ordinates, only: spectrum_t
   use rwmf_text_atomic_file, only: atomic_file_t, check_not_folder, check_not_read, discard, &
      finish, join_path, open_atomic, publish, write_line
   use rwmf_text_strings, only: integer_to_text, next_line, real_to_text
   use rwmf_text_text_buffer, only: append, clear, text_buffer_t
   implicit none
   private

   public :: write_result, write_spectrum, case_name, check_outputs, file_names

   character(*), parameter :: endings(3) = [character(13) :: &
      '.summary.csv', '.history.csv', '.spectrum.csv']
   !! endings of the names of the files of a case

contains

   !> Write `NAME.summary.csv` and, if the case requests a history, `NAME.history.csv`. Both appear
   !> only when both are complete. Neither overwrites an input file of the case.
   subroutine write_result(case, result, folder, name, error, source, control)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      character(*), intent(in) :: folder
      !! existing folder; '' is the current one
      character(*), intent(in) :: name
      !! name of the case, see `case_name`
      type(error_t), allocatable, intent(out) :: error
      !! a file cannot be written, or is an input file of the case (`err_input`); cancelled before
      !! the files were complete (`err_interrupt`)
      character(*), intent(in), optional :: source
      !! path of the namelist
      type(control_t), intent(in), optional :: control
      type(atomic_file_t) :: summary
      type(atomic_file_t) :: history

      call check_outputs(folder, name, case, error, source)
      if (allocated(error)) return
      call write_summary(summary, case, result, join_path(folder, name//'.summary.csv'), error)
      if (allocated(error)) return
      if (allocated(result%history)) then
         call write_history(history, case, result%history, &
            join_path(folder, name//'.history.csv'), error, control)
         if (.not. allocated(error)) call publish(history, error)
      end if
      if (.not. allocated(error)) call publish(summary, error)
      call discard(summary)
   end subroutine write_result

   !> Write a spectrum with one line per ordinate; T_s varies fastest, then gamma, then b.
   subroutine write_spectrum(case, spectrum, path, error, part, control)
      type(case_t), intent(in) :: case
      type(spectrum_t), intent(in) :: spectrum
      character(*), intent(in) :: path
      !! path of the file
      type(error_t), allocatable, intent(out) :: error
      !! the file cannot be written, or is an input file of the case (`err_input`); cancelled before
      !! the file was complete (`err_interrupt`)
      character(*), intent(in), optional :: part
      !! part of the case's periods in this file, 'K/N'
      type(control_t), intent(in), optional :: control
      type(atomic_file_t) :: file
      type(axis_t), allocatable :: axes(:)
      character(:), allocatable :: names
      integer :: i

      call check_output(path, case, error)
      if (.not. allocated(error)) call open_atomic(file, path, error)
      if (allocated(error)) return
      call write_header(file, case, part)
      call write_line(file, '# method: '//case%solver%method)
      call list_axes(case, axes)
      do i = 1, size(axes)
         if (.not. axes(i)%is_plain) call write_line(file, '# axis '//trim(axes(i)%column)//': ' &
            //trim(axes(i)%meaning))
      end do
      names = ''
      if (allocated(spectrum%b)) names = 'b_m,'
      if (allocated(spectrum%gamma)) names = names//'gamma,'
      names = names//'T_s_s,'
      do i = 1, size(spectrum%quantities)
         names = names//trim(spectrum%quantities(i))//','
      end do
      call write_line(file, names//'status')
      call write_ordinates(file, spectrum, error, control)
      if (.not. allocated(error)) call finish(file, error)
      if (.not. allocated(error)) call publish(file, error)
      call discard(file)
   end subroutine write_spectrum

   !> Check the output files of a case. Fails if one of them is a folder or an input file.
   subroutine check_outputs(folder, name, case, error, source)
      character(*), intent(in) :: folder
      !! path of the folder; '' is the current one
      character(*), intent(in) :: name
      !! name of the case that writes, see `case_name`
      type(case_t), intent(in) :: case
      !! case that was read
      type(error_t), allocatable, intent(out) :: error
      character(*), intent(in), optional :: source
      !! path of its namelist
      integer :: i

      associate (names => file_names(name))
         do i = 1, size(names)
            call check_output(join_path(folder, trim(names(i))), case, error, source)
            if (allocated(error)) return
         end do
      end associate
   end subroutine check_outputs

   !> Names of the output files of a case, padded with blanks.
   pure function file_names(name) result(names)
      character(*), intent(in) :: name
      !! name of the case, see `case_name`
      character(len(name) + len(endings)) :: names(size(endings))

      names = name//endings
   end function file_names

   !> Check an output file. Fails if it is a folder or an input file of the case.
   subroutine check_output(path, case, error, source)
      character(*), intent(in) :: path
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      character(*), intent(in), optional :: source

      call check_not_folder(path, error)
      if (present(source) .and. .not. allocated(error)) call check_not_read(path, source, error)
      if (.not. allocated(error) .and. allocated(case%record)) then
         call check_not_read(path, case%motion%path, error)
      end if
      if (.not. allocated(error) .and. allocated(case%upward_record)) then
         call check_not_read(path, case%upward%path, error)
      end if
   end subroutine check_output

   !> Length of `case_name`: without ending, or that of 'case' for an empty name.
   pure integer function name_length(source) result(length)
      character(*), intent(in) :: source

      length = len(source) - index(source, '/', back=.true.)
      if (length > 4) then
         if (any(source(len(source) - 3:) == ['.nml', '.NML'])) length = length - 4
      end if
      if (length == 0) length = len('case')
   end function name_length

   !> Name of a case, from the name of its file without folder and '.nml'; 'case' if empty.
   pure function case_name(source) result(name)
      character(*), intent(in) :: source
      !! path of the namelist, '' for a case made in memory
      character(name_length(source)) :: name

      name = source(index(source, '/', back=.true.) + 1:)//'case'
   end function case_name

   !> Write the scalars of a run as one line, so that the summaries of many cases can be joined.
   subroutine write_summary(file, case, result, path, error)
      type(atomic_file_t), intent(out) :: file
      !! finished, not published
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(summary_item_t), allocatable :: items(:)
      type(text_buffer_t) :: names
      type(text_buffer_t) :: values
      integer :: i

      call open_atomic(file, path, error)
      if (allocated(error)) return
      call write_header(file, case)
      call summarise(case, result, items)
      do i = 1, size(items)
         call begin_cell(names)
         call append(names, items(i)%key)
         call begin_cell(values)
         call append_value(items(i), values)
      end do
      call end_line(file, names)
      call end_line(file, values)
      call finish(file, error)
   end subroutine write_summary

   !> Write the response on its grid of times, one line per instant.
   subroutine write_history(file, case, history, path, error, control)
      type(atomic_file_t), intent(out) :: file
      !! finished, not published; discarded after an error
      type(case_t), intent(in) :: case
      type(history_t), intent(in) :: history
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(control_t), intent(in), optional :: control
      type(text_buffer_t) :: line
      integer :: i
      integer :: j

      call open_atomic(file, path, error)
      if (allocated(error)) return
      call write_header(file, case)
      do j = 1, size(history%names)
         call begin_cell(line)
         call append(line, trim(history%names(j)))
      end do
      call end_line(file, line)
      do i = 1, size(history%values, 1)
         do j = 1, size(history%values, 2)
            call append_number(history%values(i, j), line)
         end do
         call end_line(file, line)
         call check_cancelled(path, error, control)
         if (allocated(error)) exit
      end do
      if (.not. allocated(error)) call finish(file, error)
      if (allocated(error)) call discard(file)
   end subroutine write_history

   !> Write the ordinates of a spectrum.
   subroutine write_ordinates(file, spectrum, error, control)
      type(atomic_file_t), intent(in) :: file
      type(spectrum_t), intent(in) :: spectrum
      type(error_t), allocatable, intent(out) :: error
      type(control_t), intent(in), optional :: control
      type(text_buffer_t) :: line
      integer :: i
      integer :: j
      integer :: k
      integer :: q

      do k = 1, size(spectrum%values, 3)
         do j = 1, size(spectrum%values, 2)
            do i = 1, size(spectrum%T_s)
               if (allocated(spectrum%b)) call append_number(spectrum%b(k), line)
               if (allocated(spectrum%gamma)) call append_number(spectrum%gamma(j), line)
               call append_number(spectrum%T_s(i), line)
               do q = 1, size(spectrum%values, 4)
                  call append_number(spectrum%values(i, j, k, q), line)
               end do
               call begin_cell(line)
               call append(line, trim(spectrum%status_names(spectrum%status(i, j, k))))
               call end_line(file, line)
               call check_cancelled('the spectrum', error, control)
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine write_ordinates

   !> Check for a cancellation. Fails if the caller has cancelled the computation.
   subroutine check_cancelled(what, error, control)
      character(*), intent(in) :: what
      !! name of the file or result being written
      type(error_t), allocatable, intent(out) :: error
      type(control_t), intent(in), optional :: control

      if (.not. present(control)) return
      if (is_cancelled(control)) call fail(error, err_interrupt, 'interrupted while ' &
         //what//' was being written; an earlier file of this name is unchanged')
   end subroutine check_cancelled

   !> Append a comma before all cells of a line but the first.
   pure subroutine begin_cell(line)
      type(text_buffer_t), intent(inout) :: line

      if (line%length > 0) call append(line, ',')
   end subroutine begin_cell

   !> Append a cell with a number.
   pure subroutine append_number(number, line)
      real(wp), intent(in) :: number
      type(text_buffer_t), intent(inout) :: line
      character(25) :: text

      text = real_to_text(number)
      call begin_cell(line)
      call append(line, text(:len_trim(text)))
   end subroutine append_number

   !> Write a line and begin the next one.
   subroutine end_line(file, line)
      type(atomic_file_t), intent(in) :: file
      type(text_buffer_t), intent(inout) :: line

      call write_line(file, line%room(:line%length))
      call clear(line)
   end subroutine end_line

   !> Write the data to repeat the computation.
   subroutine write_header(file, case, part)
      type(atomic_file_t), intent(in) :: file
      type(case_t), intent(in) :: case
      character(*), intent(in), optional :: part
      integer :: position
      integer :: first
      integer :: last

      call write_line(file, '# rwmf '//version)
      if (present(part)) call write_line(file, '# part '//part)
      if (allocated(case%record)) then
         call write_record(file, '# record: '//case%motion%file, case%record)
      end if
      if (allocated(case%upward_record)) then
         call write_record(file, '# '//upward_group//' record: '//case%upward%file, &
            case%upward_record)
      end if
      call write_line(file, '# case:')
      if (.not. allocated(case%text)) return
      position = 1
      do while (position <= len(case%text))
         call next_line(case%text, position, first, last)
         call write_line(file, trim('# '//case%text(first:last)))
      end do
   end subroutine write_header

   !> Write the identity of a record: copies of "the same" earthquake differ.
   subroutine write_record(file, name, record)
      type(atomic_file_t), intent(in) :: file
      character(*), intent(in) :: name
      !! kind of the record, and its file
      type(record_t), intent(in) :: record
      character(:), allocatable :: line

      line = name//', '//trim(record%format)//', CRC-32 '//trim(record%crc32)//', ' &
         //trim(integer_to_text(record%n))//' points'
      if (allocated(record%dt)) line = line//', dt = '//trim(real_to_text(record%dt))//' s'
      line = line//', peak '//trim(real_to_text(record%peak))//' m/s2 at ' &
         //trim(real_to_text(record%t_peak))//' s'
      call write_line(file, line)
   end subroutine write_record

   !> Append the value of a summary item.
   pure subroutine append_value(item, line)
      type(summary_item_t), intent(in) :: item
      type(text_buffer_t), intent(inout) :: line
      integer :: i

      select case (item%kind)
      case ('real')
         call append(line, trim(real_to_text(item%number)))
      case ('int')
         call append(line, trim(integer_to_text(item%count)))
      case ('logical')
         call append(line, trim(merge('true ', 'false', item%count == 1)))
      case ('text')
         call append(line, item%text)
      case default
         ! a list
         call append(line, '"')
         do i = 1, len(item%text)
            select case (item%text(i:i))
            case (achar(9))
               call append(line, '; ')
            case ('"')
               call append(line, '""')
            case default
               call append(line, item%text(i:i))
            end select
         end do
         call append(line, '"')
      end select
   end subroutine append_value

end module rwmf_output_csv
