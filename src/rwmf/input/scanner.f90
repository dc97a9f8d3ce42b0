!> Scanner that splits namelist text into words, quoted strings and signs.
module rwmf_input_scanner
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_strings, only: integer_to_text, shown, to_lower
   implicit none
   private

   public :: scanner_t, token_t, next_token, skip_blanks, start_scanner
   public :: token_end, token_word, token_string, token_equals, token_comma, token_slash
   public :: token_group

   integer, parameter :: token_end = 0
   !! end of the text
   integer, parameter :: token_word = 1
   integer, parameter :: token_string = 2
   integer, parameter :: token_equals = 3
   integer, parameter :: token_comma = token_equals + 1
   integer, parameter :: token_slash = token_equals + 2
   integer, parameter :: token_group = 6
   !! an ampersand followed by a name

   character(*), parameter :: line_feed = achar(10), carriage_return = achar(13), tab = achar(9)
   character(*), parameter :: word_ends = " ,=/!&'"""//line_feed//carriage_return//tab

   !> Reading position.
   type :: scanner_t
      integer :: position
      !! position of the next character
      integer :: line
      !! line of that character
      integer :: ampersands
      !! ampersands in the whole text, an upper bound of the number of groups
      integer :: equals_signs
      !! equals signs in the whole text, an upper bound of the number of keys
   end type scanner_t

   !> One token of the text.
   type :: token_t
      integer :: kind
      !! one of the `token_` numbers
      integer :: line
      !! line of its beginning
      character(:), allocatable :: text
      !! the word, the content of the string, or the name of the group in lower case
   end type token_t

contains

   !> Start at the beginning of a text.
   !>
   !> Error: a control character that is not allowed in a text file.
   subroutine start_scanner(text, scanner, error)
      character(*), intent(in) :: text
      !! the whole namelist text, lines with their line feeds
      type(scanner_t), intent(out) :: scanner
      type(error_t), allocatable, intent(out) :: error
      character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      integer :: i

      scanner%position = 1
      scanner%line = 1
      scanner%ampersands = 0
      scanner%equals_signs = 0
      if (index(text(:min(len(text), 3)), byte_order_mark) == 1) scanner%position = 4
      do i = 1, len(text)
         if (text(i:i) == '&') scanner%ampersands = scanner%ampersands + 1
         if (text(i:i) == '=') scanner%equals_signs = scanner%equals_signs + 1
         if ((iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) &
            .and. scan(text(i:i), tab//line_feed//carriage_return) == 0) then
            call fail(error, err_input, 'byte '//trim(integer_to_text(i)) &
               //' is a control character: this is not a text file')
            return
         end if
      end do
   end subroutine start_scanner

   !> Read the next token.
   !>
   !> Error: a string that is not closed on its line, is too long or contains a tab.
   subroutine next_token(text, scanner, token, error)
      character(*), intent(in) :: text
      !! text that was passed to `start_scanner`
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(out) :: token
      type(error_t), allocatable, intent(out) :: error

      call skip_blanks(text, scanner)
      token%line = scanner%line
      token%kind = token_end
      token%text = ''
      if (scanner%position > len(text)) return
      select case (text(scanner%position:scanner%position))
      case ("'", '"')
         token%kind = token_string
         call take_string(text, scanner, token, error)
      case ('=', ',', '/')
         token%text = text(scanner%position:scanner%position)
         token%kind = token_equals + index('=,/', token%text) - 1
         scanner%position = scanner%position + 1
      case ('&')
         scanner%position = scanner%position + 1
         call take_word(text, scanner, token)
         token%kind = token_group
         token%text = to_lower(token%text)
      case default
         token%kind = token_word
         call take_word(text, scanner, token)
      end select
   end subroutine next_token

   !> Skip blanks, line feeds and comments.
   pure subroutine skip_blanks(text, scanner)
      character(*), intent(in) :: text
      !! text that was passed to `start_scanner`
      type(scanner_t), intent(inout) :: scanner
      logical :: in_comment

      in_comment = .false.
      do while (scanner%position <= len(text))
         select case (text(scanner%position:scanner%position))
         case (line_feed)
            in_comment = .false.
            scanner%line = scanner%line + 1
         case (carriage_return)
            in_comment = .false.
         case (' ', tab)
            continue
         case ('!')
            in_comment = .true.
         case default
            if (.not. in_comment) return
         end select
         scanner%position = scanner%position + 1
      end do
   end subroutine skip_blanks

   !> Take all characters up to a blank or a sign.
   pure subroutine take_word(text, scanner, token)
      character(*), intent(in) :: text
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(inout) :: token
      integer :: length

      length = scan(text(scanner%position:), word_ends) - 1
      if (length < 0) length = len(text) - scanner%position + 1
      token%text = text(scanner%position:scanner%position + length - 1)
      scanner%position = scanner%position + length
   end subroutine take_word

   !> Take a string in single or double quotes; a doubled quote inside is one quote.
   subroutine take_string(text, scanner, token, error)
      character(*), intent(in) :: text
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(inout) :: token
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: longest = 4096
      character(1) :: quote
      integer :: length

      quote = text(scanner%position:scanner%position)
      scanner%position = scanner%position + 1
      do
         length = scan(text(scanner%position:), quote//line_feed//carriage_return)
         if (length == 0) length = len(text) - scanner%position + 2
         token%text = token%text//text(scanner%position:scanner%position + length - 2)
         scanner%position = scanner%position + length
         if (is_at(text, scanner%position - 1, quote)) then
            if (.not. is_at(text, scanner%position, quote)) then
               if (index(token%text, tab) > 0) call fail(error, err_input, &
                  'line '//trim(integer_to_text(token%line))//': the string '//quote &
                  //shown(token%text)//' contains a tab')
               return
            end if
            token%text = token%text//quote
            scanner%position = scanner%position + 1
         end if
         if (len(token%text) > longest) then
            call fail(error, err_input, 'line '//trim(integer_to_text(token%line)) &
               //': the string '//quote//shown(token%text)//' is longer than ' &
               //trim(integer_to_text(longest))//' bytes')
            return
         else if (.not. is_at(text, scanner%position - 1, quote)) then
            call fail(error, err_input, 'line '//trim(integer_to_text(token%line)) &
               //': the string '//quote//shown(token%text)//' is not closed on its line')
            return
         end if
      end do
   end subroutine take_string

   !> True if a character is at a position; false beyond the end of the text.
   pure logical function is_at(text, position, letter)
      character(*), intent(in) :: text
      integer, intent(in) :: position
      character(1), intent(in) :: letter

      is_at = .false.
      if (position <= len(text)) is_at = text(position:position) == letter
   end function is_at

end module rwmf_input_scanner
