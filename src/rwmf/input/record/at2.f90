!> Records in PEER's AT2 format: accelerations, several per line, after a header with their number
!> and interval. Without another unit in the header they are in g.
!>
!> Number and interval come in either order, on one line or two, as
!>
!>     NPTS=   5372, DT=   .0100 SEC,
!>     DT= .01000 SEC, NPTS=  4000, 0 POLE @ ...
!>     4096    0.0100    NPTS, DT
!>     NPTS =   7500 , DT =   20 MSEC ,
module rwmf_input_record_at2
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp
   use rwmf_input_record_lines, only: fail_at_word, is_comment, is_number_line, behind_mark
   use rwmf_input_record_samples, only: samples_t, set_unit
   use rwmf_input_record_statements, only: fail_at_line, read_statements, stated_t
   use rwmf_input_record_unit_names, only: unit_t
   use rwmf_text_strings, only: integer_to_text, next_line, next_word, parse_real, shown, to_lower
   implicit none
   private

   public :: has_at2_header, read_at2, read_at2_header

   integer, parameter :: most_lines = 20
   !! lines that may come before NPTS

contains

   !> True if the content of a file, whatever its name, has an AT2 header.
   pure logical function has_at2_header(bytes)
      character(*), intent(in) :: bytes
      !! text of the file
      integer :: line

      call find_header(bytes, line)
      has_at2_header = line > 0
   end function has_at2_header

   !> Read interval, unit and accelerations.
   !>
   !> Text after the last number is allowed. Errors: an invalid header, a quantity other than an
   !> acceleration, fewer or more numbers than the header states.
   subroutine read_at2(bytes, samples, error)
      character(*), intent(in) :: bytes
      !! text of the file
      type(samples_t), intent(out) :: samples
      type(error_t), allocatable, intent(out) :: error
      type(stated_t) :: stated
      integer :: last_line
      integer :: position

      call read_at2_header(bytes, stated, position, last_line, error)
      if (.not. allocated(error)) then
         call read_numbers(bytes, position, last_line, stated%n, samples%a, error)
      end if
      if (allocated(error)) return
      samples%format = 'AT2'
      samples%name = ''
      samples%dt = stated%dt
      samples%dt_line = stated%dt_line
      call set_unit(samples, stated%unit, stated%unit_text, stated%unit_line)
   end subroutine read_at2

   !> Read the lines before the first number.
   subroutine read_at2_header(bytes, stated, position, last_line, error)
      character(*), intent(in) :: bytes
      !! text of the file
      type(stated_t), intent(out) :: stated
      !! number and interval, both positive, and unit
      integer, intent(out) :: position
      !! of the first line of numbers
      integer, intent(out) :: last_line
      !! line number of the line before it
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for statements that contradict each other, a quantity other than an
      !! acceleration, and a header without positive number and interval
      character(:), allocatable :: title
      integer :: first
      integer :: last
      integer :: line
      integer :: next
      logical :: is_complete

      call find_header(bytes, line)
      title = ''
      position = 1
      last_line = 0
      do while (position <= len(bytes))
         next = position
         call next_line(bytes, next, first, last)
         if (last_line >= line .and. is_number_line(bytes(first:last))) exit
         position = next
         last_line = last_line + 1
         associate (text => bytes(first:last))
            if (last_line == line) title = text
            call read_statements(text(behind_mark(text):), last_line, is_comment(text), stated, &
               error)
         end associate
         if (allocated(error)) return
      end do
      is_complete = allocated(stated%n) .and. allocated(stated%dt)
      if (is_complete) is_complete = stated%n > 0 .and. stated%dt > 0
      if (.not. is_complete) call fail_at_line(error, line, "'"//shown(title) &
         //"' does not give NPTS > 0 and DT > 0")
      if (allocated(stated%unit)) return
      stated%unit = unit_t('acceleration', 'g')
      stated%unit_text = 'g'
   end subroutine read_at2_header

   !> Find the number of the line with NPTS among the first lines, 0 if there is none.
   pure subroutine find_header(bytes, line)
      character(*), intent(in) :: bytes
      integer, intent(out) :: line
      integer, parameter :: longest = 200
      integer :: first
      integer :: last
      integer :: position

      position = 1
      do line = 1, most_lines
         if (position > len(bytes)) exit
         call next_line(bytes, position, first, last)
         if (is_comment(bytes(first:last))) cycle
         if (index(to_lower(bytes(first:min(last, first + longest - 1))), 'npts') > 0) return
      end do
      line = 0
   end subroutine find_header

   !> Read the number of values that the header states.
   subroutine read_numbers(bytes, start, header_line, n, a, error)
      character(*), intent(in) :: bytes
      integer, intent(in) :: start
      !! position of the first number
      integer, intent(in) :: header_line
      !! line number of the header
      integer, intent(in) :: n
      !! number of values according to the header
      real(dp), allocatable, intent(out) :: a(:)
      !! (n) [g]
      type(error_t), allocatable, intent(out) :: error
      integer :: first
      integer :: found
      integer :: last
      integer :: line
      integer :: position

      ! A number takes at least two bytes, which limits the allocation for a wrong header.
      allocate (a(min(n, len(bytes)/2 + 1)))
      found = 0
      position = start
      line = header_line
      do while (position <= len(bytes))
         call next_line(bytes, position, first, last)
         line = line + 1
         if (found == n .and. is_text(bytes(first:last))) exit
         call read_row(bytes(first:last), line, n, a, found, error)
         if (allocated(error)) return
      end do
      if (found < n) then
         call fail(error, err_input, 'the file has '//trim(integer_to_text(found)) &
            //' numbers where its header says NPTS = '//trim(integer_to_text(n)))
      end if
      a = a(:found)
   end subroutine read_numbers

   !> Append the numbers of a line.
   subroutine read_row(text, line, n, a, found, error)
      character(*), intent(in) :: text
      integer, intent(in) :: line
      integer, intent(in) :: n
      !! number of values according to the header
      real(dp), intent(inout) :: a(:)
      !! (capacity) [g]
      integer, intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: value
      logical :: ok
      integer :: first
      integer :: last
      integer :: position

      position = 1
      do
         call next_word(text, position, first, last)
         if (last < first) return
         call parse_real(text(first:last), value, ok)
         if (.not. ok) then
            call fail_at_word(line, text(first:last), error)
            error%message = error%message//' ('//trim(integer_to_text(found))//' of NPTS = ' &
               //trim(integer_to_text(n))//' numbers read)'
            return
         else if (found == n) then
            call fail(error, err_input, 'line '//trim(integer_to_text(line)) &
               //': more numbers than NPTS = '//trim(integer_to_text(n))//' of the header')
            return
         end if
         found = found + 1
         a(found) = value
      end do
   end subroutine read_row

   !> True if the line begins with a word that is not a number.
   pure logical function is_text(line)
      character(*), intent(in) :: line
      logical :: ok
      real(dp) :: value
      integer :: first
      integer :: last
      integer :: position

      position = 1
      call next_word(line, position, first, last)
      call parse_real(line(first:last), value, ok)
      is_text = .not. ok .and. last >= first
   end function is_text

end module rwmf_input_record_at2
