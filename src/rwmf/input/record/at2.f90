!> Records in PEER's AT2 format: accelerations in g, several per line, after a header with their
!> number and interval.
!>
!> The header line with number and interval has one of four forms:
!>
!>     NPTS=   5372, DT=   .0100 SEC,
!>     NPTS=  4000, DT= .01000 SEC, 0 POLE @ ...
!>     4096    0.0100    NPTS, DT
!>     NPTS =   7500 , DT =   .020 SEC ,
module rwmf_input_record_at2
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp
   use rwmf_input_record_columns, only: fail_at_word
   use rwmf_text_strings, only: integer_to_text, is_separator, next_line, next_word, &
      parse_integer, parse_real, shown, to_lower
   implicit none
   private

   public :: has_at2_header, read_at2

contains

   !> True if the content of a file, whatever its name, has an AT2 header.
   pure logical function has_at2_header(bytes)
      character(*), intent(in) :: bytes
      !! text of the file
      integer :: line
      integer :: position

      call find_header(bytes, line, position)
      has_at2_header = line > 0
   end function has_at2_header

   !> Read interval and accelerations.
   !>
   !> Text after the last number is allowed. Errors: an invalid header, a quantity other than an
   !> acceleration in g, fewer or more numbers than the header states.
   subroutine read_at2(bytes, dt, a, error)
      character(*), intent(in) :: bytes
      !! text of the file
      real(dp), intent(out) :: dt
      !! [s]
      real(dp), allocatable, intent(out) :: a(:)
      !! (n) [g]
      type(error_t), allocatable, intent(out) :: error
      integer :: first
      integer :: last
      integer :: line
      integer :: n
      integer :: position

      dt = 0
      call find_header(bytes, line, position)
      if (index(to_lower(bytes(:min(position - 1, 2000))), 'units of cm') > 0) then
         call fail(error, err_input, 'the header says units of cm: an AT2 file has accelerations ' &
            //'in g')
         return
      end if
      call next_line(bytes, position, first, last)
      call read_header(bytes(first:last), line, n, dt, error)
      if (.not. allocated(error)) call read_numbers(bytes, position, line, n, a, error)
   end subroutine read_at2

   !> Find the line with NPTS and DT among the first lines.
   pure subroutine find_header(bytes, line, start)
      character(*), intent(in) :: bytes
      integer, intent(out) :: line
      !! its line number, 0 if there is none
      integer, intent(out) :: start
      !! position of its beginning
      integer, parameter :: most_lines = 10, longest = 200
      character(:), allocatable :: text
      integer :: first
      integer :: last
      integer :: position

      position = 1
      do line = 1, most_lines
         if (position > len(bytes)) exit
         call next_line(bytes, position, first, last)
         text = to_lower(bytes(first:min(last, first + longest - 1)))
         if (index(adjustl(text), '#') == 1) cycle
         start = first
         if (index(text, 'npts') > 0 .and. index(text, 'dt') > 0) return
      end do
      line = 0
      start = 1
   end subroutine find_header

   !> Read number of samples and interval.
   subroutine read_header(text, line, n, dt, error)
      character(*), intent(in) :: text
      !! line with NPTS and DT
      integer, intent(in) :: line
      !! its line number
      integer, intent(out) :: n
      real(dp), intent(out) :: dt
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      logical :: ok
      logical :: ok_dt
      integer :: first
      integer :: last
      integer :: position

      position = index(to_lower(text), 'npts')
      if (index(adjustl(text(position + len('npts'):)), '=') == 1) then
         call find_value(text, position, first, last)
         call parse_integer(text(first:last), n, ok)
         position = position + index(to_lower(text(position + 1:)), 'dt')
         call find_value(text, position, first, last)
         call parse_real(text(first:last), dt, ok_dt)
      else
         position = 1
         call next_word(text, position, first, last)
         call parse_integer(text(first:last), n, ok)
         call next_word(text, position, first, last)
         call parse_real(text(first:last), dt, ok_dt)
      end if
      if (.not. (ok .and. ok_dt .and. n > 0 .and. dt > 0)) then
         call fail(error, err_input, 'line '//trim(integer_to_text(line))//": '"//shown(text) &
            //"' does not give NPTS > 0 and DT > 0")
      end if
   end subroutine read_header

   !> Find the characters of the number after the next equals sign.
   pure subroutine find_value(text, position, first, last)
      character(*), intent(in) :: text
      integer, intent(in) :: position
      integer, intent(out) :: first
      integer, intent(out) :: last
      !! the number is text(first:last), empty if there is no equals sign
      integer :: equals

      equals = index(text(position:), '=')
      do first = position + equals, len(text)
         if (.not. is_separator(text(first:first))) exit
      end do
      last = first - 1
      if (equals > 0) last = last + verify(text(first:)//'?', '0123456789.+-EeDd') - 1
   end subroutine find_value

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
