!> Lines of names above the columns of a table: 'Time (ms),Acc (g),Vel (cm/s)'.
module rwmf_input_record_names
   use rwmf_core_error, only: error_t
   use rwmf_input_record_statements, only: fail_at_line
   use rwmf_input_record_unit_names, only: known_units, plain_text, unit_of, unit_t
   use rwmf_text_strings, only: shown, string_t
   implicit none
   private

   public :: column_t, read_names, check_columns, begins_with_time

   character(*), parameter :: spectrum = 'spectrum', counter = 'counter'
   character(*), parameter :: separators = ';'//achar(9)//','

   !> Column of a table.
   type :: column_t
      character(:), allocatable :: name
      !! as in the file, without unit; '' without a line of names
      character(:), allocatable :: unit_text
      !! as in the file, '' for none
      type(unit_t) :: unit
      character(12) :: quantity = ''
      !! as of a unit, or 'spectrum', 'counter' or 'other'; blank for an unknown name
   end type column_t

contains

   !> Read a line of names.
   pure function read_names(text) result(columns)
      character(*), intent(in) :: text
      !! one line, without its comment mark
      type(column_t), allocatable :: columns(:)
      type(string_t), allocatable :: cells(:)
      integer :: i

      cells = cells_of(text)
      allocate (columns(size(cells)))
      do i = 1, size(cells)
         columns(i) = column_of(cells(i)%text)
      end do
   end function read_names

   !> Split a line at semicolons, tabs or commas, the first of them that it has; or else at blanks,
   !> which may stand before a bracket. Quotes and brackets hold a cell together.
   pure function cells_of(text) result(cells)
      character(*), intent(in) :: text
      type(string_t), allocatable :: cells(:)
      character(1) :: mark
      character(1) :: letter
      logical :: is_quoted
      integer :: depth
      integer :: first
      integer :: i

      mark = ' '
      do i = len(separators), 1, -1
         if (index(text, separators(i:i)) > 0) mark = separators(i:i)
      end do
      allocate (cells(0))
      is_quoted = .false.
      depth = 0
      first = 1
      do i = 1, len(text) + 1
         letter = mark
         if (i <= len(text)) letter = text(i:i)
         if (letter == '"') is_quoted = .not. is_quoted
         if (scan(letter, '([') == 1) depth = depth + 1
         if (scan(letter, ')]') == 1) depth = max(0, depth - 1)
         if (i <= len(text)) then
            if (letter /= mark .or. is_quoted .or. depth > 0) cycle
            if (mark == ' ') then
               if (scan(adjustl(text(i:)), '([') == 1) cycle
            end if
         end if
         if (mark /= ' ' .or. i > first) cells = [cells, string_t(text(first:i - 1))]
         first = i + 1
      end do
   end function cells_of

   !> Split 'a [m/s2]', 'a (g)', 'a/g', 'a_m_s2', 'a in g' and 'a g' into name and unit.
   pure type(column_t) function column_of(cell) result(column)
      character(*), intent(in) :: cell
      character(:), allocatable :: text
      integer :: first
      integer :: i
      integer :: last
      character(:), allocatable :: name

      text = trim(adjustl(without_quotes(cell)))
      column = column_t(text, '')
      ! the first bracket with a unit counts, or else the first one
      i = 1
      do
         first = scan(text(i:), '([') + i - 1
         if (first < i) exit
         last = index(text(first:), merge(')', ']', text(first:first) == '(')) + first - 1
         if (last < first) last = len(text) + 1
         if (first == scan(text, '([') .or. is_unit(text(first + 1:last - 1))) then
            call set_unit(text(:scan(text, '([') - 1), text(first + 1:last - 1), column)
         end if
         if (column%unit%quantity /= '' .or. last >= len(text)) exit
         i = last + 1
      end do
      if (column%unit_text == '') call split_name(text, column)
      ! a unit may take the place of the name; 'h' is a direction rather than hours
      if (column%unit_text == '' .and. is_unit(text) .and. plain_text(text) /= 'h') call set_unit( &
         text, text, column)
      ! quantity of a column by its name and unit
      name = trim(plain_text(column%name))
      column%quantity = quantity_of_name(name)
      if (column%quantity == '') column%quantity = column%unit%quantity
      ! a single letter is the weaker statement
      if (len(name) == 1 .and. column%unit%quantity /= '' .and. column%quantity /= spectrum) then
         column%quantity = column%unit%quantity
      end if
   end function column_of

   pure function without_quotes(cell) result(text)
      character(*), intent(in) :: cell
      character(len(cell)) :: text
      integer :: i
      integer :: n

      text = ''
      n = 0
      do i = 1, len(cell)
         if (scan(cell(i:i), '"'//achar(9)) > 0) cycle
         n = n + 1
         text(n:n) = cell(i:i)
      end do
   end function without_quotes

   pure logical function is_unit(text)
      character(*), intent(in) :: text
      type(unit_t) :: unit

      unit = unit_of(text)
      is_unit = unit%quantity /= ''
   end function is_unit

   pure subroutine set_unit(name, unit, column)
      character(*), intent(in) :: name
      character(*), intent(in) :: unit
      type(column_t), intent(inout) :: column

      column%name = trim(adjustl(name))
      column%unit_text = trim(adjustl(unit))
      column%unit = unit_of(unit)
      if (column%unit%quantity == '' .and. is_direction(plain_text(column%unit_text))) then
         column%unit_text = ''
      end if
   end subroutine set_unit

   !> True for words in brackets that are no unit: directions, numbers, the kind of processing.
   pure logical function is_direction(text)
      character(*), intent(in) :: text

      is_direction = verify(text, 'nsewudzxy-+ ') == 0 .or. index(text, 'vert') == 1 &
         .or. verify(text, '0123456789. ') == 0 &
         .or. (verify(text, '0123456789. deg') == 0 .and. index(text, 'deg') > 0) &
         .or. any(text == [character(10) :: 'h1', 'h2', 'h3', 'v', 'h', 'up', 'raw', 'corrected', &
         'filtered', 'horizontal', 'down', 'north', 'south', 'east', 'west', 'long', &
         'trans', 'l', 't'])
   end function is_direction

   !> Split a name without brackets at the first mark behind which a unit stands.
   pure subroutine split_name(text, column)
      character(*), intent(in) :: text
      type(column_t), intent(inout) :: column
      character(*), parameter :: grounds = 'uvdx'
      !! letters in front of '_g', the index of the ground
      character(:), allocatable :: unit
      integer :: i
      integer :: k

      do i = 2, len(text) - 1
         if (scan(text(i:i), '/_ ') == 0) cycle
         unit = text(i + 1:)
         if (text(i:i) == '_') then
            do k = 1, len(unit)
               if (unit(k:k) == '_') unit(k:k) = '/'
            end do
            if (i == 2 .and. scan(text(1:1), grounds//'UVDX') == 1 .and. unit == 'g') cycle
         else if (text(i:i) == ' ') then
            if (index(plain_text(unit), 'in ') == 1) cycle
            if (unit_quantity(unit) == 'displacement') cycle
         end if
         if (.not. is_unit(unit)) cycle
         call set_unit(text(:i - 1), unit, column)
         return
      end do
   end subroutine split_name

   pure character(12) function unit_quantity(text)
      character(*), intent(in) :: text
      type(unit_t) :: unit

      unit = unit_of(text)
      unit_quantity = unit%quantity
   end function unit_quantity

   pure character(12) function quantity_of_name(name) result(quantity)
      character(*), intent(in) :: name
      !! in lower case

      quantity = ''
      select case (name)
      case ('t', 'time', 'times', 'zeit', 'temps', 'tempo', 'tiempo', 'sec', 'secs', 'seconds', &
            'second', 's', 'relativetime', 'relative time', 'ms', 'msec', 'elapsed time')
         quantity = 'time'
      case ('i', 'n', 'no', 'no.', 'nr', 'nr.', '#', 'index', 'sample', 'samples', 'step', &
            'steps', 'point', 'points', 'id', 'count', 'line', 'row')
         quantity = counter
      case ('sa', 'psa', 'sv', 'psv', 'sd', 'psd', 'fas', 'f', 'tn', 't_n', 'pga', 'target', &
            'rsa', 'im', 'afe', 'lambda')
         quantity = spectrum
      case ('counts', 'digits', 'rad', 'radians', 'deg', 'degrees', 'volt', 'volts', 'mv')
         quantity = 'other'
      case ('v', 'pgv')
         quantity = 'velocity'
      case ('d', 'pgd')
         quantity = 'displacement'
      case ('a', 'ag', 'a_g')
         quantity = 'acceleration'
      case default
         if (starts(name, 'time_ time- time. time,')) quantity = 'time'
         if (starts(name, 'acc beschl acel a.')) quantity = 'acceleration'
         if (starts(name, 'vel geschw')) quantity = 'velocity'
         if (starts(name, 'disp depl versch')) quantity = 'displacement'
         if (starts(name, 'period freq spectr sa( sa_ sa- sa. psa( psa_ pseudo fourier hz omega ' &
            //'poe rate hazard annual return intensity probab') &
            .or. index(name, 'spectr') > 0) quantity = spectrum
         if (starts(name, 'sa psa sv psv sd') .and. index(name, ' ') > 0) then
            if (index(' sa psa sv psv sd ', ' '//name(:index(name, ' '))) > 0) quantity = spectrum
         end if
         if (index(name, 'ddot') > 0) quantity = 'acceleration'
      end select
   end function quantity_of_name

   !> True if a text begins with one of several words.
   pure logical function starts(text, words)
      character(*), intent(in) :: text
      character(*), intent(in) :: words
      !! separated by blanks
      integer :: first
      integer :: last

      starts = .false.
      first = 1
      do while (first <= len(words))
         last = index(words(first:)//' ', ' ') + first - 2
         starts = starts .or. index(text, words(first:last)) == 1
         first = last + 2
      end do
   end function starts

   !> True if the first column is one of times, of periods or frequencies.
   pure logical function begins_with_time(columns)
      type(column_t), intent(in) :: columns(:)

      begins_with_time = .false.
      if (size(columns) == 0) return
      begins_with_time = any(columns(1)%quantity == [character(12) :: 'time', spectrum, &
         'frequency'])
   end function begins_with_time

   !> Check the names of a table, and find its times and accelerations.
   subroutine check_columns(columns, line, time, accelerations, error)
      type(column_t), intent(inout) :: columns(:)
      integer, intent(in) :: line
      !! number of the line of names
      integer, intent(out) :: time
      !! column of the times, 0 for a single column
      integer, allocatable, intent(out) :: accelerations(:)
      !! columns of accelerations, at least one
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` without a column of times beside others, with two of them, for a column that is
      !! refused, and without accelerations
      integer :: i

      time = findloc(columns%quantity, 'time', dim=1)
      call name_single_letters(columns)
      do i = 1, size(columns)
         call check_column(columns(i), line, error)
         if (allocated(error)) return
      end do
      accelerations = pack([(i, i=1, size(columns))], &
         columns%quantity == 'acceleration' .or. columns%quantity == '')
      if (count(columns%quantity == 'time') > 1) then
         call fail_at_line(error, line, 'two columns are times')
      else if (size(columns) > 1 .and. time == 0) then
         call fail_at_line(error, line, "no column is named 'time' or 't'")
      else if (any(columns%quantity == 'acceleration') .and. any(columns%quantity == 'velocity' &
         .or. columns%quantity == 'displacement')) then
         accelerations = pack(accelerations, columns(accelerations)%quantity == 'acceleration')
      end if
      if (allocated(error)) return
      if (size(accelerations) > 0) return
      call fail_at_line(error, line, 'no column holds accelerations: a record needs one')
   end subroutine check_columns

   !> In a table of components 'v' and 'd' without units may be directions.
   pure subroutine name_single_letters(columns)
      type(column_t), intent(inout) :: columns(:)
      integer :: i

      if (any(columns%quantity == 'acceleration') .or. count(columns%quantity == '') == 0) return
      do i = 1, size(columns)
         if (len(columns(i)%name) == 1 .and. columns(i)%unit_text == '' &
            .and. (columns(i)%quantity == 'velocity' .or. columns(i)%quantity == 'displacement')) &
            then
            columns(i)%quantity = ''
         end if
      end do
   end subroutine name_single_letters

   !> Refuse a column that is no part of a record, or whose unit contradicts its name.
   subroutine check_column(column, line, error)
      type(column_t), intent(in) :: column
      integer, intent(in) :: line
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: named

      named = "the column '"//shown(column%name)//"'"
      if (column%quantity == spectrum .or. column%quantity == 'frequency') then
         call fail_at_line(error, line, named//' belongs to a spectrum: a record has times and ' &
            //'accelerations')
      else if (column%quantity == counter) then
         call fail_at_line(error, line, named//' counts samples: a record has times and ' &
            //'accelerations')
      else if (column%unit_text /= '' .and. column%unit%quantity == '' &
         .and. any(column%quantity == [character(12) :: '', 'time', 'acceleration'])) then
         call fail_at_line(error, line, named//" has the unit '"//shown(column%unit_text) &
            //"', which is not known: known are "//known_units)
      else if (column%unit%quantity /= '' .and. column%unit%quantity /= column%quantity) then
         call fail_at_line(error, line, named//" has '"//shown(column%unit_text) &
            //"', the unit of a "//trim(column%unit%quantity))
      end if
   end subroutine check_column

end module rwmf_input_record_names
