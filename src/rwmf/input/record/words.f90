!> Words of a line of text in a record file: units in brackets, numbers, marks.
module rwmf_input_record_words
   use rwmf_core_kinds, only: dp
   use rwmf_input_record_unit_names, only: plain_text, unit_of, unit_t
   use rwmf_text_strings, only: parse_real
   implicit none
   private

   public :: header_word_t, words_of, joined_unit, has_word

   integer, parameter :: longest_line = 400, longest_word = 40
   character(*), parameter :: separators = ' ,;"()[]|', marks = '=:'

   !> Word of a line, in lower case.
   type :: header_word_t
      character(longest_word) :: text = ''
      logical :: in_brackets = .false.
      logical :: is_new = .false.
      !! a comma or semicolon comes before it
      logical :: is_number = .false.
      real(dp) :: number = 0
      !! value of a number, in the unit of the words beside it
   end type header_word_t

contains

   !> Split a line, without its comment mark. A number and letters that touch it are two words.
   pure function words_of(line) result(words)
      character(*), intent(in) :: line
      !! line of a file, of which the first 400 characters are used
      type(header_word_t), allocatable :: words(:)

      allocate (words(0))
      call add_words(plain_text(line(:min(len(line), longest_line))), words)
   end function words_of

   pure recursive subroutine add_words(text, words)
      character(*), intent(in) :: text
      type(header_word_t), allocatable, intent(inout) :: words(:)
      type(header_word_t) :: word
      logical :: is_new
      integer :: first
      integer :: last

      first = 1
      is_new = .false.
      do while (first <= len(text))
         last = first
         if (scan(text(first:first), '([') == 1) then
            last = index(text(first:), merge(')', ']', text(first:first) == '(')) + first - 1
            if (last > first + 1) then
               word = header_word_t(text(first + 1:last - 1), in_brackets=.true., is_new=is_new)
               if (is_one_word(text(first + 1:last - 1))) then
                  words = [words, word]
               else
                  call add_words(text(first + 1:last - 1), words)
               end if
            end if
            last = max(last, first)
         else if (scan(text(first:first), marks) == 1) then
            words = [words, header_word_t(text(first:first))]
         else if (scan(text(first:first), separators) == 0) then
            last = scan(text(first:), separators//marks) + first - 2
            if (last < first) last = len(text)
            call add_word(text(first:last), is_new, words)
         end if
         is_new = scan(text(first:first), ',;') == 1
         first = last + 1
      end do
   end subroutine add_words

   !> True for the content of brackets that states nothing but perhaps a unit.
   pure logical function is_one_word(text)
      character(*), intent(in) :: text

      is_one_word = scan(text, '=:') == 0 .and. index(text, 'dt') == 0 &
         .and. index(text, 'npts') == 0 .and. index(text, 'unit') == 0
   end function is_one_word

   !> Append a word, or a number and the letters behind it.
   pure subroutine add_word(text, is_new, words)
      character(*), intent(in) :: text
      logical, intent(in) :: is_new
      type(header_word_t), allocatable, intent(inout) :: words(:)
      type(header_word_t) :: word
      integer :: last
      logical :: ok

      word%is_new = is_new
      ok = .false.
      last = len(text)
      if (scan(text(1:1), '0123456789.+-') == 1) then
         ! the end of a number may be the e or d of a word that follows it
         last = verify(text//'?', '0123456789.+-ed') - 1
         call parse_real(text(:last), word%number, ok)
         if (.not. ok) then
            last = verify(text//'?', '0123456789.+-') - 1
            call parse_real(text(:last), word%number, ok)
         end if
         if (.not. ok) last = len(text)
      end if
      word%is_number = ok
      word%text = without_dot(text(:last), ok)
      words = [words, word]
      if (last < len(text)) words = [words, header_word_t(without_dot(text(last + 1:), .false.))]
   end subroutine add_word

   pure function without_dot(text, is_number) result(short)
      character(*), intent(in) :: text
      logical, intent(in) :: is_number
      character(longest_word) :: short

      short = text
      if (.not. is_number .and. len(text) > 1 .and. text(len(text):) == '.') then
         short = text(:len(text) - 1)
      end if
   end function without_dot

   !> Unit that begins with a word, as 'cm / sec / sec', and the number of its words, the most
   !> possible; 0 for none.
   pure subroutine joined_unit(words, i, unit, n)
      type(header_word_t), intent(in) :: words(:)
      integer, intent(in) :: i
      !! number of the first word
      type(unit_t), intent(out) :: unit
      integer, intent(out) :: n
      !! number of words of the unit, 0 for none
      integer, parameter :: most_words = 6
      character(:), allocatable :: text
      integer :: k

      do n = min(most_words, size(words) - i + 1), 1, -1
         if (any(words(i + 1:i + n - 1)%is_new) .or. any(words(i:i + n - 1)%text == '=')) cycle
         text = ''
         do k = i, i + n - 1
            text = text//trim(words(k)%text)
         end do
         unit = unit_of(text)
         if (unit%quantity /= '') return
      end do
      n = 0
   end subroutine joined_unit

   !> True if a word begins with one of several beginnings.
   pure logical function has_word(words, beginnings)
      type(header_word_t), intent(in) :: words(:)
      character(*), intent(in) :: beginnings(:)
      !! beginnings in lower case, trailing blanks do not count
      integer :: k

      has_word = .false.
      do k = 1, size(beginnings)
         has_word = has_word .or. any(index(words%text, trim(beginnings(k))) == 1)
      end do
   end function has_word

end module rwmf_input_record_words
