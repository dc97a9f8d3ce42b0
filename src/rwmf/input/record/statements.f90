!> Facts that a record file states in its lines of text: unit, interval and number of its samples.
!> Two statements that differ are an error, and so is another quantity than an acceleration.
module rwmf_input_record_statements
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_unit_names, only: known_units, unit_of, unit_t
   use rwmf_input_record_words, only: has_word, joined_unit, header_word_t, words_of
   use rwmf_text_strings, only: integer_to_text, real_to_text, shown
   implicit none
   private

   public :: stated_t, read_statements, state_unit, state_interval, state_number, fail_at_line
   public :: is_same_interval

   real(dp), parameter :: printed_digits = 2e-3_dp
   !! difference between two statements of an interval that rounding explains [-]

   !> Facts that a file states, each with the number of its line.
   type :: stated_t
      type(unit_t), allocatable :: unit
      character(:), allocatable :: unit_text
      !! as in the file
      integer :: unit_line = 0
      real(dp), allocatable :: dt
      !! interval of the samples [s]
      integer :: dt_line = 0
      integer, allocatable :: n
      !! number of samples
      integer :: n_line = 0
   end type stated_t

contains

   !> Read the statements of a line of text.
   subroutine read_statements(text, line, is_comment, stated, error)
      character(*), intent(in) :: text
      !! line of a header, or a comment
      integer, intent(in) :: line
      !! its number
      logical, intent(in) :: is_comment
      !! its words may mention other things than the samples of the file
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a statement that contradicts one before it, an unknown unit, and a quantity
      !! other than an acceleration
      type(header_word_t), allocatable :: words(:)

      words = words_of(text)
      if (size(words) == 0) return
      if (has_word(words, ['npts']) .and. .not. is_comment) then
         call read_listed_numbers(words, line, stated, error)
      end if
      if (.not. allocated(error)) call read_numbers(words, line, is_comment, stated, error)
      if (.not. allocated(error)) call check_quantity(text, words, line, is_comment, error)
      if (.not. allocated(error)) call read_units(words, line, is_comment, stated, error)
   end subroutine read_statements

   !> Read numbers in front of their names, as '4096    0.0100    NPTS, DT'.
   subroutine read_listed_numbers(words, line, stated, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: line
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      integer :: at_dt
      integer :: at_n

      at_n = findloc(words%text, 'npts', dim=1)
      at_dt = findloc(words%text, 'dt', dim=1)
      if (size(words) < 4 .or. min(at_n, at_dt) /= 3) return
      if (.not. all(words(1:2)%is_number)) return
      call state_number(words(merge(1, 2, at_n < at_dt))%number, line, stated, error)
      if (allocated(error)) return
      call state_interval(words(merge(2, 1, at_n < at_dt))%number, line, stated, error)
   end subroutine read_listed_numbers

   !> Read the numbers that follow a name: of samples, their interval or rate.
   subroutine read_numbers(words, line, is_comment, stated, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: line
      logical, intent(in) :: is_comment
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      character(4) :: fact
      real(dp) :: dt
      integer :: at
      integer :: i
      integer :: n

      do i = 1, size(words)
         call find_fact(words, i, fact, n)
         if (fact == '') cycle
         at = number_after(words, i + n)
         if (at == 0) cycle
         if (fact == 'n') then
            call state_number(words(at)%number, line, stated, error)
         else
            call find_interval(words, i + n, at, fact, is_comment, dt, error)
            if (allocated(error)) error%message = 'line '//trim(integer_to_text(line)) &
               //': '//error%message
            if (.not. allocated(error)) call state_interval(dt, line, stated, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine read_numbers

   !> Recognise a name: 'n', 'dt' or 'rate', and the number of its words.
   pure subroutine find_fact(words, i, fact, n)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i
      character(4), intent(out) :: fact
      !! blank for any other word
      integer, intent(out) :: n
      character(40) :: next
      character(40) :: second

      fact = ''
      n = 1
      next = ''
      second = ''
      if (i < size(words)) next = words(i + 1)%text
      if (i + 1 < size(words)) second = words(i + 2)%text
      select case (words(i)%text)
      case ('npts', 'ndata', 'n_points', 'npoints', 'nsamples')
         fact = 'n'
      case ('number', 'no')
         if (next /= 'of') return
         if (.not. any(second == [character(7) :: 'points', 'samples', 'data', 'values'])) return
         fact = 'n'
         n = 3
      case ('points', 'samples')
         if (next == '=' .or. next == ':') fact = 'n'
      case ('dt', 'delta_t', 'deltat', 'timestep', 'time_step', 'time-step', 'sampling_interval')
         fact = 'dt'
      case ('t', 'interval', 'delta', 'step')
         if (next == '=' .or. next == ':') fact = 'dt'
         if (words(i)%text /= 'delta' .or. next /= 't') return
         fact = 'dt'
         n = 2
      case ('time', 'sampling', 'sample')
         n = 2
         if (any(next == [character(10) :: 'step', 'interval', 'increment', 'spacing', 'period', &
            'time'])) fact = 'dt'
         if (index(next, 'freq') == 1 .or. next == 'rate') fact = 'rate'
      case ('fs', 'sps', 'sampling_rate', 'samplingfrequency', 'sampling_frequency')
         fact = 'rate'
      case default
         fact = ''
      end select
   end subroutine find_fact

   !> Position of the number behind a name; 0 if something else follows.
   pure integer function number_after(words, first) result(at)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: first
      integer, parameter :: most_words = 3

      do at = first, min(size(words), first + most_words)
         if (words(at)%is_number) return
         if (.not. (words(at)%in_brackets .or. words(at)%text == '=' .or. words(at)%text == ':' &
            .or. words(at)%text == 'is' .or. words(at)%text == 'of' .or. words(at)%text == 'in' &
            .or. unit_quantity(words(at)) == 'time' .or. words(at)%text == 'hz')) exit
      end do
      at = 0
   end function number_after

   pure character(12) function unit_quantity(word)
      type(header_word_t), intent(in) :: word
      type(unit_t) :: unit

      unit = unit_of(trim(word%text))
      unit_quantity = unit%quantity
   end function unit_quantity

   !> Interval from a number and the unit in front of it or behind it.
   subroutine find_interval(words, first, at, fact, is_comment, dt, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: first
      !! first word behind the name
      integer, intent(in) :: at
      !! position of the number
      character(*), intent(in) :: fact
      !! 'dt' or 'rate'
      logical, intent(in) :: is_comment
      real(dp), intent(out) :: dt
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      character(4) :: next
      type(unit_t) :: unit
      logical :: is_rate
      integer :: k
      integer :: n

      unit = unit_t('')
      do k = first, at - 1
         if (unit_quantity(words(k)) /= '') unit = unit_of(trim(words(k)%text))
      end do
      k = at + 1
      if (unit%quantity == '' .and. k <= size(words)) then
         call find_fact(words, k, next, n)
         if (.not. words(k)%is_new .and. .not. words(k)%is_number .and. next == '') then
            unit = unit_of(trim(words(k)%text))
            if (index(words(k)%text, 'samples/s') == 1) unit = unit_t('frequency')
            if (unit%quantity == '' .and. (is_duration(words(k)%text) .or. .not. is_comment)) then
               unit%quantity = 'unknown'
            end if
         end if
      end if
      is_rate = fact == 'rate'
      dt = 0
      if (unit%quantity == '' .or. unit%quantity == merge('frequency', 'time     ', is_rate)) then
         dt = words(at)%number*unit%times/unit%over
         if (is_rate .and. dt > 0) dt = unit%over/(words(at)%number*unit%times)
      else if (k <= size(words)) then
         call fail(error, err_input, trim(fact)//' = '//trim(words(at)%text)//" '" &
            //shown(trim(words(min(k, size(words)))%text)) &
            //"': the unit must be one of time, as s or ms; for a rate Hz")
      else
         call fail(error, err_input, trim(fact)//' = '//trim(words(at)%text) &
            //': the unit must be one of time, as s or ms; for a rate Hz')
      end if
   end subroutine find_interval

   !> True for a word that looks like a unit of time.
   pure logical function is_duration(word)
      character(*), intent(in) :: word

      is_duration = index(word, 'sec') > 0 .or. index(word, 'milli') == 1 &
         .or. index(word, 'micro') == 1
   end function is_duration

   !> Refuse velocities, displacements and spectra.
   subroutine check_quantity(text, words, line, is_comment, error)
      character(*), intent(in) :: text
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: line
      logical, intent(in) :: is_comment
      type(error_t), allocatable, intent(out) :: error
      character(7), parameter :: others(4) = [character(7) :: 'veloc', 'displac', 'spectr', &
         'fourier']
      character(4), parameter :: short(3) = [character(4) :: 'vel', 'disp', 'psa']
      logical :: is_other
      integer :: i

      if (has_word(words, [character(6) :: 'accel', 'acc', 'compat', 'match'])) return
      ! comments may mention velocities: only at their beginning it is the quantity
      is_other = has_word(words(:1), others) .or. any(words(1)%text == short)
      if (.not. is_comment .or. has_word(words, [character(7) :: 'histor', 'series'])) then
         is_other = has_word(words, others) &
            .or. any([(any(words(i)%text == short), i=1, size(words))])
      end if
      if (.not. is_other) return
      call fail_at_line(error, line, "'"//shown(trim(adjustl(text)))//"' names another quantity: " &
         //'a record holds accelerations')
   end subroutine check_quantity

   !> Read the units of a line: behind the word units, in brackets, or beside an acceleration.
   subroutine read_units(words, line, is_comment, stated, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: line
      logical, intent(in) :: is_comment
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      type(unit_t) :: unit
      logical :: is_acceleration
      logical :: is_meant
      integer :: i
      integer :: n

      is_acceleration = has_word(words, [character(6) :: 'acc', 'beschl', 'acel'])
      i = 1
      do while (i <= size(words) .and. .not. allocated(error))
         n = 1
         if (words(i)%text == 'units' .or. words(i)%text == 'unit') then
            call read_named_units(words, i, line, stated, error)
         else if (.not. words(i)%is_number .and. .not. is_value(words, i) &
            .and. (words(i)%text /= 'in' .or. words(i)%in_brackets)) then
            call joined_unit(words, i, unit, n)
            is_meant = words(i)%in_brackets .or. (is_acceleration .or. .not. is_comment) &
               .and. is_strong(words(i:i + n - 1)) .or. is_acceleration .and. i + n > size(words) &
               .and. unit%quantity == 'acceleration' .or. unit%quantity == 'time' &
               .and. unit%over > 1 .and. any(index(words%text, 'time') == 1 .or. words%text == 't')
            if (n > 0 .and. is_meant) then
               call take_unit(words, i, unit, n, line, stated, error)
            else if (is_acceleration .and. words(i)%in_brackets) then
               call check_unknown(words(i), line, error)
            end if
            n = max(n, 1)
         end if
         i = i + n
      end do
   end subroutine read_units

   !> True for a unit behind a number, or behind 'from' as in 'converted from cm/s2'.
   pure logical function is_value(words, i)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i

      is_value = .false.
      if (i > 1) is_value = words(i - 1)%is_number .or. words(i - 1)%text == 'from'
   end function is_value

   !> True for words that are a unit in any context, unlike the letters g, m or s.
   pure logical function is_strong(words)
      type(header_word_t), intent(in) :: words(:)

      is_strong = any(scan(words%text, '/%^') > 0 .or. words%text == 'gal' &
         .or. words%text == 'gals' .or. index(words%text, 's-2') > 0)
   end function is_strong

   !> Read the units behind 'units of', 'unit =' and the like.
   subroutine read_named_units(words, i, line, stated, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i
      !! position of the word units
      integer, intent(in) :: line
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      character(6), parameter :: relations(7) = [character(6) :: 'of', '=', ':', 'in', 'are', &
         'is', 'and']
      type(unit_t) :: unit
      logical :: has_relation
      logical :: has_unit
      integer :: k
      integer :: n

      has_relation = .false.
      has_unit = .false.
      k = i + 1
      do while (k <= size(words))
         n = 1
         call joined_unit(words, k, unit, n)
         ! 'in' may be the inch of an acceleration
         if (any(words(k)%text == relations) .and. unit%quantity /= 'acceleration') then
            has_relation = .true.
            n = 1
         else if (.not. has_word(words(k:k), [character(4) :: 'acc', 'samp', 'data', 'valu', &
            'all'])) then
            if (n == 0) exit
            has_unit = .true.
            if (k + n <= size(words)) then
               if (any(words(k + n)%text == [character(5) :: 'x', '*', 'times'])) then
                  unit%quantity = ''
               end if
            end if
            call take_unit(words, k, unit, n, line, stated, error)
            if (allocated(error)) return
         end if
         k = k + max(n, 1)
      end do
      if (has_unit .or. .not. has_relation) return
      if (k > size(words)) return
      call take_unit(words, k, unit_t(''), 1, line, stated, error)
   end subroutine read_named_units

   !> Take a unit of accelerations; refuse one of another quantity.
   subroutine take_unit(words, i, unit, n, line, stated, error)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i
      type(unit_t), intent(in) :: unit
      integer, intent(in) :: n
      !! number of words
      integer, intent(in) :: line
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: k

      text = trim(words(i)%text)
      do k = i + 1, i + n - 1
         text = text//trim(words(k)%text)
      end do
      if (unit%quantity == 'time') then
         if (abs(unit%times/unit%over - 1) <= 0) return
         ! the unit of an interval, as in 'dt (ms) = 10', has been read with its number
         if (number_after(words, i + n) > 0) return
         call fail_at_line(error, line, "times in '"//shown(text)//"': must have a line of names " &
            //"for each column, such as 'time ["//shown(text)//"], a [g]'")
      else if (unit%quantity /= 'displacement' .or. .not. is_initial(words, i)) then
         call state_unit(unit, text, line, stated, error)
      end if
   end subroutine take_unit

   !> True for one letter in brackets in a line without a displacement: '(M)' may be a name.
   pure logical function is_initial(words, i)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i

      is_initial = words(i)%text == 'm' .and. .not. any(words%text == 'units')
   end function is_initial

   !> Refuse brackets beside an acceleration that look like a unit.
   subroutine check_unknown(word, line, error)
      type(header_word_t), intent(in) :: word
      integer, intent(in) :: line
      type(error_t), allocatable, intent(out) :: error

      character(6), parameter :: foreign(9) = [character(6) :: 'kn', 'mn', 'v', 'mv', 'volts', &
         'counts', 'count', 'kpa', 'mpa']
      type(header_word_t), allocatable :: words(:)
      logical :: has_unit
      integer :: i

      words = words_of(word%text)
      has_unit = scan(word%text, '/%*') > 0 .and. verify(trim(word%text), '0123456789/') > 0
      do i = 1, size(words)
         has_unit = has_unit .or. unit_quantity(words(i)) == 'acceleration' &
            .or. any(words(i)%text == foreign)
      end do
      if (.not. has_unit) return
      call fail_at_line(error, line, "the unit '"//shown(trim(word%text))//"' is not known: " &
         //'known are '//known_units)
   end subroutine check_unknown

   !> State the unit of the samples.
   subroutine state_unit(unit, text, line, stated, error)
      type(unit_t), intent(in) :: unit
      character(*), intent(in) :: text
      !! as in the file
      integer, intent(in) :: line
      !! number of the line in the file
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the unit is unknown, not of an acceleration, or contradicts the stated one

      if (unit%quantity == '') then
         call fail_at_line(error, line, "the unit '"//shown(text)//"' is not known: known are " &
            //known_units)
      else if (unit%quantity /= 'acceleration') then
         call fail_at_line(error, line, "the units of "//shown(text)//' are those of a ' &
            //trim(unit%quantity)//': a record holds accelerations')
      else if (.not. allocated(stated%unit)) then
         stated%unit = unit
         stated%unit_text = text
         stated%unit_line = line
      else if (stated%unit%base /= unit%base .or. abs(stated%unit%times - unit%times) > 0 &
         .or. abs(stated%unit%over - unit%over) > 0) then
         call fail_at_line(error, line, "the unit '"//shown(text)//"' contradicts '" &
            //shown(stated%unit_text)//"' of line "//trim(integer_to_text(stated%unit_line)))
      end if
   end subroutine state_unit

   !> State the interval of the samples.
   subroutine state_interval(dt, line, stated, error)
      real(dp), intent(in) :: dt
      !! [s]
      integer, intent(in) :: line
      !! number of the line in the file
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the interval contradicts the stated one

      if (.not. allocated(stated%dt)) then
         stated%dt = dt
         stated%dt_line = line
      else if (.not. is_same_interval(dt, stated%dt)) then
         call fail_at_line(error, line, 'the interval '//trim(real_to_text(real(dt, wp))) &
            //' s contradicts '//trim(real_to_text(real(stated%dt, wp)))//' s of line ' &
            //trim(integer_to_text(stated%dt_line)))
      end if
   end subroutine state_interval

   !> True if the digits of printed intervals explain their difference.
   elemental logical function is_same_interval(one, other)
      real(dp), intent(in) :: one
      !! [s]
      real(dp), intent(in) :: other
      !! [s]

      is_same_interval = abs(one - other) <= printed_digits*abs(other)
   end function is_same_interval

   !> State the number of samples.
   subroutine state_number(number, line, stated, error)
      real(dp), intent(in) :: number
      !! number of samples [-]; 0 is stated for one that is negative or not whole
      integer, intent(in) :: line
      !! number of the line in the file
      type(stated_t), intent(inout) :: stated
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the number contradicts the stated one
      integer :: n

      n = 0
      if (number < huge(n)) n = max(0, nint(number))
      if (abs(n - number) > 0) n = 0
      if (.not. allocated(stated%n)) then
         stated%n = n
         stated%n_line = line
      else if (stated%n /= n) then
         call fail_at_line(error, line, trim(integer_to_text(n))//' samples contradict ' &
            //trim(integer_to_text(stated%n))//' of line '//trim(integer_to_text(stated%n_line)))
      end if
   end subroutine state_number

   !> Fail with the number of a line.
   subroutine fail_at_line(error, line, message)
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`, always
      integer, intent(in) :: line
      !! number of the line in the file
      character(*), intent(in) :: message
      !! message without the number of the line

      call fail(error, err_input, 'line '//trim(integer_to_text(line))//': '//message)
   end subroutine fail_at_line

end module rwmf_input_record_statements
