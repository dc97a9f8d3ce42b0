!> Numbers in one column (accelerations) or two columns (times and accelerations).
module rwmf_input_record_columns
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_text_strings, only: integer_to_text, next_line, next_word, parse_real, real_to_text, &
      shown, to_lower
   implicit none
   private

   public :: read_columns, fail_at_word

contains

   !> Read the columns of a file.
   !>
   !> Errors, each with its line: a word that is not a finite number, more than two columns, lines
   !> of different lengths. Times that do not increase and a file without numbers are errors too.
   subroutine read_columns(bytes, t, a, error)
      character(*), intent(in) :: bytes
      !! text of the file
      real(dp), allocatable, intent(out) :: t(:)
      !! (n) times [s]; unallocated for one column
      real(dp), allocatable, intent(out) :: a(:)
      !! (n) accelerations in the unit of the file
      type(error_t), allocatable, intent(out) :: error
      real(dp), allocatable :: column(:, :)
      integer :: n
      integer :: n_columns

      call read_table(bytes, column, n, n_columns, error)
      if (allocated(error)) return
      if (n == 0) then
         call fail(error, err_input, 'the file has no numbers')
      else if (n_columns == 1) then
         a = column(1, :n)
      else
         t = column(1, :n)
         a = column(2, :n)
      end if
   end subroutine read_columns

   !> Read the table line by line.
   subroutine read_table(bytes, table, n, n_columns, error)
      character(*), intent(in) :: bytes
      real(dp), allocatable, intent(out) :: table(:, :)
      !! (2, lines of the file)
      integer, intent(out) :: n
      !! number of rows in use
      integer, intent(out) :: n_columns
      !! 1 or 2, 0 if there are no numbers
      type(error_t), allocatable, intent(out) :: error
      logical :: header_seen
      integer :: first
      integer :: last
      integer :: line
      integer :: lines
      integer :: position
      integer :: i

      lines = 1
      do i = 1, len(bytes)
         if (bytes(i:i) == achar(10)) lines = lines + 1
      end do
      allocate (table(2, lines))
      n = 0
      n_columns = 0
      line = 0
      header_seen = .false.
      position = first_byte(bytes)
      do while (position <= len(bytes))
         call next_line(bytes, position, first, last)
         line = line + 1
         if (is_empty(bytes(first:last))) cycle
         if (n == 0 .and. .not. header_seen .and. is_header(bytes(first:last))) then
            header_seen = .true.
            cycle
         end if
         call read_row(bytes(first:last), line, table(:, n + 1), n_columns, error)
         if (allocated(error)) return
         n = n + 1
         if (n_columns < 2 .or. n == 1) cycle
         if (table(1, n) > table(1, n - 1)) cycle
         call fail(error, err_input, 'line '//trim(integer_to_text(line))//': the time ' &
            //trim(real_to_text(real(table(1, n), wp)))//' s follows ' &
            //trim(real_to_text(real(table(1, n - 1), wp)))//' s: times must increase strictly')
         return
      end do
   end subroutine read_table

   !> Read the one or two numbers of a line.
   subroutine read_row(text, line, row, n_columns, error)
      character(*), intent(in) :: text
      integer, intent(in) :: line
      !! its line number, for messages
      real(dp), intent(out) :: row(2)
      integer, intent(inout) :: n_columns
      !! number of columns of the lines before, 0 for the first line
      type(error_t), allocatable, intent(out) :: error
      logical :: ok
      integer :: first
      integer :: found
      integer :: last
      integer :: position

      row = 0
      found = 0
      position = 1
      do
         call next_word(text, position, first, last)
         if (last < first) exit
         found = found + 1
         if (found > size(row)) then
            call fail(error, err_input, 'line '//trim(integer_to_text(line)) &
               //': more than two columns')
            return
         end if
         call parse_real(text(first:last), row(found), ok)
         if (.not. ok) then
            call fail_at_word(line, text(first:last), error)
            return
         end if
      end do
      if (n_columns == 0) n_columns = found
      if (found /= n_columns) then
         call fail(error, err_input, 'line '//trim(integer_to_text(line))//': ' &
            //trim(integer_to_text(found))//' columns where the lines before have ' &
            //trim(integer_to_text(n_columns)))
      end if
   end subroutine read_row

   !> Report a word that is not a number.
   subroutine fail_at_word(line, word, error)
      integer, intent(in) :: line
      !! number of the line in the file
      character(*), intent(in) :: word
      !! word as in the file
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail(error, err_input, 'line '//trim(integer_to_text(line))//": '"//shown(word) &
         //"' is not a finite number")
   end subroutine fail_at_word

   !> True for a blank line or a comment.
   pure logical function is_empty(text)
      character(*), intent(in) :: text
      integer :: first
      integer :: last
      integer :: position

      position = 1
      call next_word(text, position, first, last)
      is_empty = last < first
      if (.not. is_empty) is_empty = text(first:first) == '#'
   end function is_empty

   !> True for a line of names. A word that begins like a number is a damaged number instead, and so
   !> are NaN and infinity.
   pure logical function is_header(text)
      character(*), intent(in) :: text
      !! line that is not empty
      character(8) :: start
      integer :: first
      integer :: last
      integer :: position

      position = 1
      call next_word(text, position, first, last)
      start = to_lower(text(first:min(last, first + len(start) - 1)))
      is_header = verify(start(1:1), '0123456789+-.*') > 0 .and. start /= 'nan' &
         .and. start /= 'inf' .and. start /= 'infinity'
   end function is_header

   !> First byte of the text, after the byte order mark of UTF-8 if there is one.
   pure integer function first_byte(bytes)
      character(*), intent(in) :: bytes
      character(3), parameter :: mark = char(239)//char(187)//char(191)

      first_byte = 1
      if (len(bytes) < len(mark)) return
      if (bytes(:len(mark)) == mark) first_byte = 1 + len(mark)
   end function first_byte

end module rwmf_input_record_columns
