!> Units as files write them: 'cm/sec/sec', 'M/S**2', '%g', 'msec'.
module rwmf_input_record_unit_names
   use rwmf_core_kinds, only: dp
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: unit_t, unit_of, plain_text, known_units

   character(*), parameter :: known_units = 'g, %g, mg, m/s2, cm/s2, gal, mm/s2, in/s2, ft/s2'
   !! units of accelerations, for messages

   !> Unit of a column or a number: x in the unit is x*times/over in its base.
   type :: unit_t
      character(12) :: quantity = ''
      !! 'acceleration', 'velocity', 'displacement', 'time' or 'frequency'; blank if unknown
      character(5) :: base = ''
      !! of an acceleration: 'g', 'm/s2' or 'cm/s2'; blank for the unit s of a time
      real(dp) :: times = 1
      !! factor of the unit on its base [-]
      real(dp) :: over = 1
      !! divisor of the unit on its base [-]
   end type unit_t

contains

   !> Return the unit that a text names; its quantity is blank if the text names none.
   pure type(unit_t) function unit_of(text) result(unit)
      character(*), intent(in) :: text
      !! any text
      character(:), allocatable :: word

      word = trim(squeezed(text))
      select case (word)
      case ('g', 'gs', 'g0', 'gn', 'g_n', 'gravity', 'gravities')
         unit = unit_t('acceleration', 'g')
      case ('%g', '%ofg', 'percentg', 'percentofg', 'pctg', 'g%')
         unit = unit_t('acceleration', 'g', over=100.0_dp)
      case ('mg', 'mgs', 'millig', 'milli-g', 'milligs')
         unit = unit_t('acceleration', 'g', over=1e3_dp)
      case ('ug', 'microg', 'micro-g')
         unit = unit_t('acceleration', 'g', over=1e6_dp)
      case ('gal', 'gals', 'galileo')
         unit = unit_t('acceleration', 'cm/s2')
      case ('mgal', 'mgals', 'milligal', 'milligals')
         unit = unit_t('acceleration', 'cm/s2', over=1e3_dp)
      case ('s', 'sec', 'secs', 'second', 'seconds')
         unit = unit_t('time')
      case ('ms', 'msec', 'msecs', 'millisec', 'millisecs', 'millisecond', 'milliseconds')
         unit = unit_t('time', over=1e3_dp)
      case ('us', 'usec', 'microsec', 'microsecs', 'microsecond', 'microseconds')
         unit = unit_t('time', over=1e6_dp)
      case ('ns', 'nanosecond', 'nanoseconds')
         unit = unit_t('time', over=1e9_dp)
      case ('min', 'mins', 'minute', 'minutes')
         unit = unit_t('time', times=60.0_dp)
      case ('h', 'hr', 'hrs', 'hour', 'hours')
         unit = unit_t('time', times=3600.0_dp)
      case ('hz', 'hertz', 'sps', '1/s', '1/sec', 's-1', 's^-1', 'rad/s', 'rad/sec')
         unit = unit_t('frequency')
      case ('khz')
         unit = unit_t('frequency', times=1e3_dp)
      case default
         unit = length_per_time(word)
      end select
   end function unit_of

   !> Unit of a length over a power of a second.
   pure type(unit_t) function length_per_time(word) result(unit)
      character(*), intent(in) :: word
      character(11), parameter :: lengths(26) = [character(11) :: &
         'centimeters', 'centimetres', 'centimeter', 'centimetre', 'cm', &
         'millimeters', 'millimetres', 'millimeter', 'millimetre', 'mm', &
         'micrometers', 'micrometer', 'um', 'inches', 'inch', 'in', 'feet', 'foot', 'ft', &
         'kilometers', 'km', 'meters', 'metres', 'meter', 'metre', 'm']
      character(12), parameter :: quantities(0:2) = &
         [character(12) :: 'displacement', 'velocity', 'acceleration']
      integer :: i
      integer :: n
      integer :: power

      do i = 1, size(lengths)
         n = len_trim(lengths(i))
         if (index(word, lengths(i) (:n)) == 1) exit
      end do
      if (i > size(lengths)) return
      power = power_of_second(word(n + 1:))
      if (power < 0 .or. power > ubound(quantities, 1)) return
      unit%quantity = quantities(power)
      unit%base = 'm/s2'
      select case (i)
      case (:5)
         unit%base = 'cm/s2'
      case (6:10)
         unit%over = 1e3_dp
      case (11:13)
         unit%over = 1e6_dp
      case (14:16)
         unit%times = 0.0254_dp
      case (17:19)
         unit%times = 0.3048_dp
      case (20:21)
         unit%times = 1e3_dp
      case default
         unit%times = 1
      end select
   end function length_per_time

   !> Power of the second in the rest of a unit, as '/s/s', '/sec^2', 's-2': the sum of the
   !> exponents, whatever the operators. -1 for any other text.
   pure integer function power_of_second(text) result(power)
      character(*), intent(in) :: text
      character(7), parameter :: seconds(5) = [character(7) :: &
         'seconds', 'second', 'secs', 'sec', 's']
      character(*), parameter :: operators = '/.*^-+_'
      integer :: first
      integer :: i
      integer :: n

      power = 0
      first = 1
      do while (first <= len(text))
         if (scan(text(first:first), operators) == 1) then
            first = first + 1
         else if (index(text(first:), 'per') == 1) then
            first = first + 3
         else
            do i = 1, size(seconds)
               n = len_trim(seconds(i))
               if (index(text(first:), seconds(i) (:n)) /= 1) cycle
               if (is_end(text(first + n:))) exit
            end do
            if (i > size(seconds)) then
               power = -1
               return
            end if
            first = first + n
            n = verify(text(first:)//'?', operators) - 1
            if (scan(text(first + n:), '123456789') == 1) then
               power = power + iachar(text(first + n:first + n)) - iachar('0')
               first = first + n + 1
            else if (index(text(first:), 'squared') == 1) then
               power = power + 2
               first = first + 7
            else
               power = power + 1
            end if
         end if
      end do
   end function power_of_second

   !> True if a word for a second may end in front of a text.
   pure logical function is_end(rest)
      character(*), intent(in) :: rest

      is_end = .true.
      if (len(rest) == 0) return
      is_end = rest(1:1) < 'a' .or. rest(1:1) > 'z' .or. index(rest, 'squared') == 1 &
         .or. verify(rest, 's2') == 0 .or. index(rest, 'per') == 1
   end function is_end

   !> Text without blanks, quotes, brackets and marks at its end.
   pure function squeezed(text) result(word)
      character(*), intent(in) :: text
      character(len(text)) :: word
      character(:), allocatable :: plain
      integer :: i
      integer :: n

      plain = plain_text(text)
      word = ''
      n = 0
      do i = 1, len(plain)
         if (scan(plain(i:i), ' "''$\(){}[]<>`') > 0) cycle
         n = n + 1
         word(n:n) = plain(i:i)
      end do
      do while (n > 0)
         if (scan(word(n:n), '.,;:') == 0) exit
         word(n:n) = ' '
         n = n - 1
      end do
   end function squeezed

   !> Text in lower case and ASCII: superscripts, dots and signs of Unicode and Latin-1 replaced,
   !> tabs as blanks.
   pure function plain_text(text) result(plain)
      character(*), intent(in) :: text
      !! UTF-8 or Latin-1
      character(len(text)) :: plain
      character(3), parameter :: signs(25) = [character(3) :: &
         char(194)//char(178), char(194)//char(179), char(194)//char(185), char(194)//char(183), &
         char(194)//char(181), char(206)//char(188), char(194)//char(160), char(195)//char(151), &
         char(206)//char(148), char(226)//char(136)//char(134), char(226)//char(129)//char(187), &
         char(226)//char(136)//char(146), char(226)//char(139)//char(133), &
         char(226)//char(136)//char(153), char(226)//char(128)//char(147), &
         char(226)//char(129)//char(132), char(226)//char(136)//char(149), &
         char(226)//char(128)//char(153), char(178), char(253), char(179), char(181), char(183), &
         char(160), achar(9)]
      character(*), parameter :: ascii = '231.uu *dd--..-//''223u.  '
      !! replacement of each
      integer :: i
      integer :: k
      integer :: n
      integer :: last

      plain = ''
      last = 0
      i = 1
      do while (i <= len(text))
         last = last + 1
         plain(last:last) = to_lower(text(i:i))
         n = 1
         if (iachar(text(i:i)) > 127 .or. text(i:i) == achar(9)) then
            do k = 1, size(signs)
               associate (width => len_trim(signs(k)))
                  if (text(i:min(i + width - 1, len(text))) /= signs(k) (:width)) cycle
                  plain(last:last) = ascii(k:k)
                  n = width
                  exit
               end associate
            end do
         end if
         i = i + n
      end do
   end function plain_text

end module rwmf_input_record_unit_names
