!> Text helpers: conversion of numbers, lines and words, and the nearest name to a typing error.
module rwmf_text_strings
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use rwmf_core_kinds, only: dp, i8, wp
   use rwmf_text_decimal, only: digit_count, shortest_digits
   implicit none
   private

   public :: string_t
   public :: integer_to_text, real_to_text, rounded_text, parse_real, parse_integer
   public :: to_lower, shown, next_line, next_word, is_separator, nearest_name

   !> Element of an array of texts of different lengths.
   type :: string_t
      character(:), allocatable :: text
   end type string_t

   !> Integer as text, padded with blanks.
   interface integer_to_text
      module procedure :: default_integer_to_text
      module procedure :: long_integer_to_text
   end interface integer_to_text

contains

   pure function default_integer_to_text(value) result(text)
      integer, intent(in) :: value
      character(20) :: text

      text = long_integer_to_text(int(value, i8))
   end function default_integer_to_text

   pure function long_integer_to_text(value) result(text)
      integer(i8), intent(in) :: value
      character(20) :: text
      integer :: status

      write (text, '(i0)', iostat=status) value
      if (status /= 0) text = repeat('*', len(text))
   end function long_integer_to_text

   !> Real as the shortest text that reads back as the same double precision number, padded with
   !> blanks.
   pure function real_to_text(x) result(text)
      real(wp), intent(in) :: x
      !! [any]; in the quadruple build rounded to double precision
      character(25) :: text
      character(digit_count) :: letters
      real(dp) :: value
      integer(i8) :: digits
      integer :: exponent
      integer :: i
      logical :: is_decided

      value = real(x, dp)
      if (ieee_is_nan(value)) then
         text = 'nan'
         return
      else if (.not. ieee_is_finite(value)) then
         text = merge('inf ', '-inf', value > 0)
         return
      end if
      is_decided = abs(value) > 0
      if (is_decided) call shortest_digits(abs(value), digits, exponent, is_decided)
      if (is_decided) then
         do i = digit_count, 1, -1
            letters(i:i) = achar(iachar('0') + int(mod(digits, 10_i8)))
            digits = digits/10
         end do
      else
         call find_digits(abs(value), letters, exponent)
      end if
      text = plain_number(sign(1.0_dp, value) < 0, letters, exponent)
   end function real_to_text

   !> Real with four significant digits, for a message; padded with blanks.
   pure function rounded_text(x) result(text)
      real(wp), intent(in) :: x
      !! [any]
      character(25) :: text
      character(12) :: buffer
      real(wp) :: rounded
      integer :: status

      write (buffer, '(es12.3e3)', iostat=status) x
      if (status == 0) read (buffer, *, iostat=status) rounded
      if (status /= 0) rounded = x
      text = real_to_text(rounded)
   end function rounded_text

   !> Find the shortest digits by trial, for zero and for numbers that `shortest_digits` leaves
   !> open.
   pure subroutine find_digits(x, digits, exponent)
      real(dp), intent(in) :: x
      !! >= 0, finite
      character(digit_count), intent(out) :: digits
      !! with trailing zeros
      integer, intent(out) :: exponent
      !! of the first digit
      character(40) :: buffer
      character(12) :: form
      real(dp) :: read_back
      integer :: count
      integer :: letter
      integer :: stat
      logical :: ok

      ! Fewer digits than 15 only add trailing zeros, which plain_number drops.
      do count = 15, digit_count
         form = '(es40.'//trim(integer_to_text(count - 1))//'e3)'
         write (buffer, form, iostat=stat) x
         if (stat == 0) read (buffer, *, iostat=stat) read_back
         if (stat == 0 .and. abs(read_back - x) <= 0) exit
      end do
      buffer = adjustl(buffer)
      letter = index(buffer, 'E')
      call parse_integer(trim(buffer(letter + 1:)), exponent, ok)
      digits = buffer(1:1)//buffer(3:letter - 1)//repeat('0', digit_count)
   end subroutine find_digits

   !> Number from digits and exponent, as -0.0125 or -1.25e-20 depending on its size.
   pure function plain_number(is_negative, digits, exponent) result(text)
      logical, intent(in) :: is_negative
      character(digit_count), intent(in) :: digits
      !! trailing zeros are ignored
      integer, intent(in) :: exponent
      !! of the first digit
      character(25) :: text
      integer :: at
      !! position of the last character so far
      integer :: last
      !! position of the last non-zero digit
      integer :: point
      !! number of digits before the decimal point

      text = ''
      if (is_negative) text(1:1) = '-'
      at = merge(1, 0, is_negative)
      last = max(1, verify(digits, '0', back=.true.))
      point = exponent + 1
      if (exponent >= 15 .or. exponent < -4) point = 1
      if (point <= 0) then
         text(at + 1:at + 2 - point) = '0.0000'
         text(at + 3 - point:) = digits(:last)
         return
      end if
      text(at + 1:at + point) = digits(:point)
      text(at + point + 1:at + point + 1) = '.'
      last = max(point + 1, last)
      text(at + point + 2:) = digits(point + 1:last)
      if (point == 1 .and. exponent /= 0) text(at + last + 2:) = 'e'//integer_to_text(exponent)
   end function plain_number

   !> Read a decimal number; reject lists, repeat counts, NaN and infinity.
   !>
   !> The decimal point, the exponent (`e` or `d`) and a zero before or after the point are
   !> optional. The result is the nearest double precision number in every working precision, so
   !> that all builds read the same input.
   pure subroutine parse_real(text, value, ok)
      character(*), intent(in) :: text
      !! without blanks
      real(dp), intent(out) :: value
      !! [any], zero if the text is not such a number
      logical, intent(out) :: ok
      !! the text is a number of magnitude below 1e308
      integer, parameter :: most_digits = 15, most_exponent = 22
      integer(i8) :: mantissa
      integer :: digits
      integer :: exponent
      integer :: stat

      value = 0
      call split_number(text, mantissa, digits, exponent, ok)
      if (.not. ok) return
      if (digits == 0) then
         return
      else if (digits + exponent > range(value) + 1) then
         ok = .false.
      else if (digits <= most_digits .and. abs(exponent) <= most_exponent) then
         ! Both factors are exact, hence the result is correctly rounded; 20 times faster than
         ! `read`.
         value = real(mantissa, dp)
         if (exponent < 0) value = value/10.0_dp**(-exponent)
         if (exponent > 0) value = value*10.0_dp**exponent
         if (text(1:1) == '-') value = -value
      else
         read (text, *, iostat=stat) value
         ok = stat == 0
      end if
   end subroutine parse_real

   !> Split a number into its digits, as an integer, and its decimal exponent.
   pure subroutine split_number(text, mantissa, digits, exponent, ok)
      character(*), intent(in) :: text
      integer(i8), intent(out) :: mantissa
      !! the first 15 significant digits
      integer, intent(out) :: digits
      !! number of significant digits
      integer, intent(out) :: exponent
      !! decimal exponent of the last digit
      logical, intent(out) :: ok
      integer, parameter :: most_shift = 100000
      logical :: has_digit
      logical :: has_point
      integer :: shift
      integer :: i

      mantissa = 0
      digits = 0
      exponent = 0
      has_digit = .false.
      has_point = .false.
      ok = .true.
      i = 1
      if (scan(text(:min(1, len(text))), '+-') == 1) i = 2
      do i = i, len(text)
         select case (text(i:i))
         case ('0':'9')
            has_digit = .true.
            if (has_point) exponent = exponent - 1
            if (digits > 0 .or. text(i:i) /= '0') digits = digits + 1
            if (digits <= 15) mantissa = 10*mantissa + (iachar(text(i:i)) - iachar('0'))
         case ('.')
            ok = ok .and. .not. has_point
            has_point = .true.
         case ('e', 'E', 'd', 'D')
            call parse_integer(text(i + 1:), shift, ok)
            ! beyond this bound the result is zero or too large in any case
            exponent = exponent + max(-most_shift, min(most_shift, shift))
            exit
         case default
            ok = .false.
         end select
         if (.not. ok) exit
      end do
      ok = ok .and. has_digit
   end subroutine split_number

   !> Read an integer; reject any other text.
   pure subroutine parse_integer(text, value, ok)
      character(*), intent(in) :: text
      !! without blanks
      integer, intent(out) :: value
      !! zero if the text is not an integer or out of range
      logical, intent(out) :: ok
      !! the text is an integer in the range of the default kind
      integer(i8) :: long
      integer :: first
      integer :: i

      value = 0
      long = 0
      first = 1
      if (scan(text(:min(1, len(text))), '+-') == 1) first = 2
      ok = len(text) >= first .and. verify(text(first:), '0123456789') == 0
      if (.not. ok) return
      do i = first, len(text)
         long = 10*long + (iachar(text(i:i)) - iachar('0'))
         ok = long <= huge(value)
         if (.not. ok) return
      end do
      value = int(long)
      if (text(1:1) == '-') value = -value
   end subroutine parse_integer

   !> Text converted to lower case.
   elemental function to_lower(text) result(lower)
      character(*), intent(in) :: text
      !! only A to Z are converted
      character(len(text)) :: lower
      integer :: i

      lower = text
      do i = 1, len(text)
         if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
      end do
   end function to_lower

   !> Part of a file prepared for a message: short, on one line, printable.
   pure function shown(text) result(short)
      character(*), intent(in) :: text
      !! of any length and with any bytes
      integer, parameter :: longest = 60
      character(min(len(text), longest) + merge(3, 0, len(text) > longest)) :: short
      integer :: i

      short = text(:min(len(text), longest))//'...'
      do i = 1, min(len(text), longest)
         if (iachar(short(i:i)) < 32 .or. iachar(short(i:i)) >= 127) short(i:i) = '?'
      end do
   end function shown

   !> Find the line that begins at `position`, and advance `position` to the next line.
   pure subroutine next_line(text, position, first, last)
      character(*), intent(in) :: text
      !! lines, of which the last may lack its line feed
      integer, intent(inout) :: position
      !! start of the line; on return the start of the next line
      integer, intent(out) :: first
      !! where the line begins
      integer, intent(out) :: last
      !! the line is text(first:last), without line feed and carriage return
      integer :: length

      first = position
      length = index(text(first:), achar(10))
      if (length == 0) length = len(text) - first + 2
      last = first + length - 2
      position = last + 2
      if (last >= first) then
         if (text(last:last) == achar(13)) last = last - 1
      end if
   end subroutine next_line

   !> Find the first word at or after `position`, and advance `position` past it.
   pure subroutine next_word(line, position, first, last)
      character(*), intent(in) :: line
      !! one line, without its line feed
      integer, intent(inout) :: position
      !! start of the search; on return the position after the word
      integer, intent(out) :: first
      !! where the word begins
      integer, intent(out) :: last
      !! the word is line(first:last), empty at the end of the line

      do first = position, len(line)
         if (.not. is_separator(line(first:first))) exit
      end do
      do last = first, len(line)
         if (is_separator(line(last:last))) exit
      end do
      position = last
      last = last - 1
   end subroutine next_word

   !> True for a blank, tab, carriage return or comma.
   elemental logical function is_separator(letter)
      character(1), intent(in) :: letter
      !! character to test

      is_separator = scan(letter, ' ,'//achar(9)//achar(13)) > 0
   end function is_separator

   !> Known name closest to a mistyped one, padded with blanks; blank if none is close.
   pure function nearest_name(word, names) result(name)
      character(*), intent(in) :: word
      !! word as the user wrote it, in upper or lower case
      character(*), intent(in) :: names(:)
      !! (n), padded with blanks
      character(len(names)) :: name
      integer :: best
      integer :: i
      integer :: found

      name = ''
      best = 1 + len(word)/3
      if (len(word) > 2*len(names)) return
      do i = 1, size(names)
         found = distance(to_lower(word), to_lower(trim(names(i))))
         if (found <= best .and. found < len_trim(names(i))) then
            if (found == best .and. name /= '') cycle
            best = found
            name = names(i)
         end if
      end do
   end function nearest_name

   !> Least number of characters to insert, delete or replace (Levenshtein distance).
   pure integer function distance(a, b)
      character(*), intent(in) :: a
      character(*), intent(in) :: b
      integer :: row(0:len(b))
      integer :: diagonal
      integer :: above
      integer :: i
      integer :: j

      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
            diagonal = above
         end do
      end do
      distance = row(len(b))
   end function distance

end module rwmf_text_strings
