!> Tables of numbers: one column of accelerations, or times and one or more accelerations.
module rwmf_input_record_columns
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_lines, only: fail_at_word, is_comment, is_number_line, known_formats, &
      behind_mark
   use rwmf_input_record_names, only: begins_with_time, check_columns, column_t, read_names
   use rwmf_input_record_samples, only: samples_t, set_unit
   use rwmf_input_record_statements, only: fail_at_line, is_same_interval, read_statements, &
      state_interval, state_number, state_unit, stated_t
   use rwmf_text_strings, only: integer_to_text, next_line, next_word, parse_real, real_to_text, &
      shown
   implicit none
   private

   public :: table_t, read_table_header, read_table, fill_channels

   integer, parameter :: least_rows = 10
   !! rows below a number that can be their count

   !> Line of a file.
   type :: file_line_t
      integer :: first = 1
      integer :: last = 0
      integer :: line = 0
      !! its number, 0 for none
   end type file_line_t

   !> Header of a table, and then its rows.
   type :: table_t
      type(column_t), allocatable :: columns(:)
      integer :: names_line = 0
      !! number of the line of names, 0 without one
      integer :: time = 0
      !! column of the times, 0 for none
      integer, allocatable :: accelerations(:)
      !! columns of accelerations
      type(stated_t) :: stated
      type(file_line_t) :: begin
      !! first line of numbers
      real(dp), allocatable :: values(:, :)
      !! (columns, lines of the file), each column in its unit
      integer :: n = 0
      !! rows in use
   end type table_t

contains

   !> Read the lines above the numbers: names and units of the columns, statements.
   subroutine read_table_header(bytes, table, error)
      character(*), intent(in) :: bytes
      !! text of the file
      type(table_t), intent(out) :: table
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for statements that contradict each other, unknown units, and names that do not
      !! fit the columns or do not name accelerations
      type(file_line_t) :: names
      integer :: n_columns

      call find_numbers(bytes, table%begin, names)
      n_columns = 0
      if (is_number_line(bytes(table%begin%first:table%begin%last))) then
         n_columns = count_words(row_text(bytes(table%begin%first:table%begin%last)))
      end if
      if (names%line > 0 .and. n_columns > 0) then
         call find_names(bytes(names%first:names%last), n_columns, names%line, table, error)
      end if
      if (.not. allocated(error)) call read_lines(bytes, table, error)
      if (allocated(error)) return
      if (table%names_line == 0) then
         allocate (table%columns(n_columns))
         table%time = merge(1, 0, n_columns > 1)
         table%accelerations = [min(2, n_columns)]
      else
         call check_columns(table%columns, table%names_line, table%time, table%accelerations, error)
         if (allocated(error)) return
      end if
      if (size(table%accelerations) /= 1 .or. table%names_line == 0) return
      associate (column => table%columns(table%accelerations(1)))
         if (column%unit%quantity /= '') call state_unit(column%unit, column%unit_text, &
            table%names_line, table%stated, error)
      end associate
   end subroutine read_table_header

   !> Find the first line of numbers, and the line above it that may hold names: the only line of
   !> text, or else the last comment.
   subroutine find_numbers(bytes, begin, names)
      character(*), intent(in) :: bytes
      type(file_line_t), intent(out) :: begin
      !! first line of numbers, or the second line of text
      type(file_line_t), intent(out) :: names
      integer :: position
      logical :: has_text

      has_text = .false.
      position = 1
      do while (position <= len(bytes))
         call next_line(bytes, position, begin%first, begin%last)
         begin%line = begin%line + 1
         associate (text => bytes(begin%first:begin%last))
            if (is_number_line(text)) return
            if (count_words(text) == 0) cycle
            if (is_comment(text)) then
               if (.not. has_text) names = begin
            else if (has_text) then
               return
            else
               has_text = .true.
               names = begin
            end if
         end associate
      end do
      begin = file_line_t(len(bytes) + 1, len(bytes), begin%line + 1)
   end subroutine find_numbers

   !> Take a line as the names of the columns if it has as many cells, and known words.
   subroutine find_names(text, n_columns, line, table, error)
      character(*), intent(in) :: text
      integer, intent(in) :: n_columns
      integer, intent(in) :: line
      type(table_t), intent(inout) :: table
      type(error_t), allocatable, intent(out) :: error
      type(column_t), allocatable :: columns(:)
      logical :: is_remark
      logical :: is_named

      is_remark = is_comment(text)
      columns = read_names(text(behind_mark(text):))
      is_named = begins_with_time(columns)
      if (size(columns) == n_columns) then
         if (is_remark) then
            is_named = is_named .and. n_columns > 1
         else if (n_columns == 1 .or. scan(text, ',;'//achar(9)) > 0) then
            is_named = any(columns%quantity /= '')
         else
            is_named = is_named .or. any(columns%quantity == 'time') &
               .or. any(columns%unit%quantity /= '')
         end if
         if (.not. is_named) return
         call move_alloc(columns, table%columns)
         table%names_line = line
      else if (is_named .and. .not. is_remark .and. scan(text, ',;'//achar(9)) > 0) then
         call fail_at_line(error, line, trim(integer_to_text(size(columns)))//' names where the ' &
            //'first line of numbers has '//trim(integer_to_text(n_columns))//' columns')
      end if
   end subroutine find_names

   !> Read the statements of the lines above the numbers, but not of the line of names.
   subroutine read_lines(bytes, table, error)
      character(*), intent(in) :: bytes
      type(table_t), intent(inout) :: table
      type(error_t), allocatable, intent(out) :: error
      integer :: first
      integer :: last
      integer :: line
      integer :: position

      position = 1
      do line = 1, table%begin%line - 1
         call next_line(bytes, position, first, last)
         if (line == table%names_line) cycle
         associate (text => bytes(first:last))
            call read_statements(text(behind_mark(text):), line, is_comment(text), table%stated, &
               error)
         end associate
         if (allocated(error)) return
      end do
   end subroutine read_lines

   !> Read the rows.
   subroutine read_table(bytes, table, error)
      character(*), intent(in) :: bytes
      !! text of the file
      type(table_t), intent(inout) :: table
      !! with its header
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a file without numbers, a word that is no number, rows of different length,
      !! and rows that contradict the header
      integer :: first
      integer :: last
      integer :: line
      integer :: n_columns
      integer :: position

      n_columns = size(table%columns)
      if (n_columns > 2 .and. table%names_line == 0 .and. &
         is_number_line(bytes(table%begin%first:table%begin%last))) then
         call fail_at_line(error, table%begin%line, 'more than two columns need a line of names, ' &
            //"such as 'time [s], a [g]'")
         return
      end if
      allocate (table%values(n_columns, rows_of(bytes, n_columns)))
      position = table%begin%first
      line = table%begin%line - 1
      do while (position <= len(bytes))
         call next_line(bytes, position, first, last)
         line = line + 1
         if (first > last) cycle
         if (scan(bytes(first:last), ';#'//achar(9)) == 0) then
            call read_row(bytes(first:last), line, n_columns, table, error)
         else
            call read_row(row_text(bytes(first:last)), line, n_columns, table, error)
         end if
         if (allocated(error)) return
      end do
      if (table%n == 0) then
         call fail(error, err_input, 'the file has no numbers')
      else
         call check_first_row(table, n_columns, error)
      end if
      if (.not. allocated(error)) call check_rows(table, error)
   end subroutine read_table

   !> Largest possible number of rows.
   pure integer function rows_of(bytes, n_columns)
      character(*), intent(in) :: bytes
      integer, intent(in) :: n_columns
      integer :: i

      rows_of = 1
      do i = 1, len(bytes)
         if (bytes(i:i) == achar(10)) rows_of = rows_of + 1
      end do
      ! a number takes at least two bytes; two columns may turn out to be one
      if (n_columns > 2) rows_of = min(rows_of, len(bytes)/(2*n_columns) + 2)
   end function rows_of

   !> Numbers of a row with blanks between them, without the comment behind them. Between semicolons
   !> a comma is a decimal sign. A comma inside numbers that tabs separate stays in them, and so is
   !> reported.
   pure function row_text(line) result(text)
      character(*), intent(in) :: line
      character(len(line)) :: text
      integer :: i
      integer :: last
      logical :: has_semicolon

      last = scan(line, '#') - 1
      if (last < 0) last = len(line)
      text = line(:last)
      has_semicolon = index(text, ';') > 0
      if (.not. has_semicolon .and. index(text, achar(9)) == 0) return
      do i = 1, len(text)
         if (text(i:i) == ';') then
            text(i:i) = ' '
         else if (text(i:i) == ',' .and. has_semicolon) then
            text(i:i) = '.'
         else if (text(i:i) == ',' .and. i > 1 .and. i < len(text)) then
            if (scan(text(i - 1:i - 1), '0123456789') > 0 &
               .and. scan(text(i + 1:i + 1), '0123456789') > 0) text(i:i) = '_'
         end if
      end do
   end function row_text

   pure integer function count_words(text)
      character(*), intent(in) :: text
      integer :: first
      integer :: last
      integer :: position

      count_words = 0
      position = 1
      do
         call next_word(text, position, first, last)
         if (last < first) return
         count_words = count_words + 1
      end do
   end function count_words

   !> Read the numbers of a line, unless it is blank or a comment.
   subroutine read_row(text, line, n_columns, table, error)
      character(*), intent(in) :: text
      integer, intent(in) :: line
      !! its line number, for messages
      integer, intent(inout) :: n_columns
      !! number of columns, at first that of the first row
      type(table_t), intent(inout) :: table
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: value
      logical :: ok
      integer :: first
      integer :: found
      integer :: last
      integer :: position

      found = 0
      position = 1
      do
         call next_word(text, position, first, last)
         if (last < first) exit
         if (found == 0 .and. scan(text(first:first), '#%!/') == 1) then
            if (is_comment(text(first:))) return
         end if
         call parse_real(text(first:last), value, ok)
         if (.not. ok) then
            call fail_at_word(line, text(first:last), error)
            if (table%n == 0) error%message = error%message//'; '//known_formats
            return
         end if
         found = found + 1
         if (found <= size(table%columns)) table%values(found, table%n + 1) = value
      end do
      if (found == 0) return
      table%n = table%n + 1
      if (table%n == 1) table%begin%line = line
      if (found == n_columns) then
         if (found > 1) call check_time(table, line, error)
      else if (table%n == 2 .and. found == 1 .and. n_columns == 2 .and. table%names_line == 0) then
         ! the first row may state interval and number
         n_columns = 1
      else
         call fail_at_line(error, line, trim(integer_to_text(found))//' columns where the ' &
            //trim(merge('header has       ', 'lines before have', table%names_line > 0))//' ' &
            //trim(integer_to_text(n_columns)))
      end if
   end subroutine read_row

   !> Check that the time of the last row follows that of the row before.
   subroutine check_time(table, line, error)
      type(table_t), intent(in) :: table
      integer, intent(in) :: line
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: t(2)

      if (table%time == 0 .or. table%n < 2) return
      t = table%values(table%time, table%n - 1:table%n)
      if (t(2) > t(1)) return
      call fail_at_line(error, line, 'the time '//trim(real_to_text(real(t(2), wp))) &
         //' s follows '//trim(real_to_text(real(t(1), wp)))//' s: times must increase strictly')
   end subroutine check_time

   !> Take or refuse a first row that states the interval and the number of the samples.
   subroutine check_first_row(table, n_columns, error)
      type(table_t), intent(inout) :: table
      integer, intent(in) :: n_columns
      !! of the rows below the first one
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: head(2)
      integer :: at
      integer :: i
      integer :: n

      if (size(table%columns) == 2 .and. n_columns == 1) then
         head = table%values(:, 1)
         n = table%n - 1
         at = findloc(abs(head - n) <= 0, .true., dim=1)
         if (at == 0 .or. n < least_rows) then
            call fail_at_line(error, table%begin%line + 1, '1 columns where the lines before ' &
               //'have 2')
            return
         end if
         do i = 1, n
            table%values(1, i) = table%values(1, i + 1)
         end do
         table%n = n
         deallocate (table%columns)
         allocate (table%columns(1))
         table%time = 0
         table%accelerations = [1]
         call state_number(head(at), table%begin%line, table%stated, error)
         if (allocated(error)) return
         call state_interval(head(3 - at), table%begin%line, table%stated, error)
      else if (table%names_line == 0) then
         call refuse_first_row(table, error)
      end if
   end subroutine check_first_row

   !> Refuse a first number that is the number of rows, or far above all other samples.
   subroutine refuse_first_row(table, error)
      type(table_t), intent(in) :: table
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: first
      real(dp) :: others
      logical :: is_fraction

      if (table%n <= least_rows) return
      associate (a => table%values(table%accelerations(1), :table%n))
         first = a(1)
         others = maxval(abs(a(2:)))
         is_fraction = any(abs(a(2:) - anint(a(2:))) > 0)
      end associate
      if (abs(first - anint(first)) > 0 .or. first < least_rows .or. .not. is_fraction) return
      ! a line with the interval may follow
      if (first <= 10*others .and. all(abs(first - table%n + [1, 2]) > 0)) return
      call fail_at_line(error, table%begin%line, trim(real_to_text(real(first, wp)))//' is no ' &
         //'sample, but looks like a number of samples: write it as a comment, such as ' &
         //"'# NPTS = 120, DT = 0.01 s'")
   end subroutine refuse_first_row

   !> Compare the rows with the number and the interval that the file states.
   subroutine check_rows(table, error)
      type(table_t), intent(in) :: table
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: dt

      associate (stated => table%stated)
         if (allocated(stated%n)) then
            if (stated%n /= table%n) then
               call fail(error, err_input, 'the file has '//trim(integer_to_text(table%n)) &
                  //' samples where line '//trim(integer_to_text(stated%n_line))//' says ' &
                  //trim(integer_to_text(stated%n)))
               return
            end if
         end if
         if (.not. allocated(stated%dt) .or. table%time == 0 .or. table%n < 2) return
         associate (t => table%values(table%time, :table%n), unit => table%columns(table%time)%unit)
            dt = (t(table%n) - t(1))/(table%n - 1)*unit%times/unit%over
            if (is_same_interval(dt, stated%dt) .and. all(abs(t(2:) - t(:table%n - 1) - dt &
               *unit%over/unit%times) <= 0.5_dp*dt*unit%over/unit%times)) return
         end associate
         call fail(error, err_input, 'the times have intervals of ' &
            //trim(real_to_text(real(dt, wp)))//' s where line ' &
            //trim(integer_to_text(stated%dt_line))//' says ' &
            //trim(real_to_text(real(stated%dt, wp)))//' s')
      end associate
   end subroutine check_rows

   !> Make the samples of each column of accelerations, in a base unit.
   subroutine fill_channels(table, channels)
      type(table_t), intent(in) :: table
      type(samples_t), allocatable, intent(out) :: channels(:)
      integer :: i

      allocate (channels(size(table%accelerations)))
      do i = 1, size(channels)
         associate (column => table%columns(table%accelerations(i)), samples => channels(i))
            samples%a = table%values(table%accelerations(i), :table%n)
            if (column%unit%quantity /= '') then
               call set_unit(samples, column%unit, column%unit_text, table%names_line)
            else if (allocated(table%stated%unit)) then
               call set_unit(samples, table%stated%unit, table%stated%unit_text, &
                  table%stated%unit_line)
            end if
            samples%name = ''
            if (allocated(column%name)) samples%name = column%name
            samples%format = 'two columns'
            if (size(table%columns) == 1) samples%format = 'one column'
            if (size(table%columns) > 2) samples%format = 'table'
            if (table%time > 0) then
               associate (unit => table%columns(table%time)%unit)
                  samples%t = table%values(table%time, :table%n)*unit%times/unit%over
               end associate
            else if (allocated(table%stated%dt)) then
               samples%dt = table%stated%dt
               samples%dt_line = table%stated%dt_line
            end if
         end associate
      end do
   end subroutine fill_channels

end module rwmf_input_record_columns
