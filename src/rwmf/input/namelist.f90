!> Parser of namelist text into groups of keys with values, independent of the schema.
!>
!> As in Fortran, names may be in upper or lower case and `!` begins a comment. Values are separated
!> by blanks or commas, may continue over several lines and may be repeated (`3*1.0`). A group ends
!> with `/` or `&end`. Unlike in Fortran, no input is skipped silently: text outside the groups,
!> empty values and subscripts are errors.
module rwmf_input_namelist
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_input_scanner, only: next_token, scanner_t, skip_blanks, start_scanner, token_comma, &
      token_end, token_equals, token_group, token_slash, token_string, token_t, token_word
   use rwmf_text_strings, only: integer_to_text, parse_integer, shown, string_t, to_lower
   implicit none
   private

   public :: entry_t, group_t, parse_namelist

   integer, parameter :: most_values = 10000
   !! largest number of values of one key: a repeat count must not exhaust the memory
   integer, parameter :: most_keys = 1000
   !! largest number of keys of one group and of groups of one text: more would take long to reject

   !> One entry `key = value, value, ...`
   type :: entry_t
      character(:), allocatable :: key
      !! in lower case
      integer :: line
      !! line of the key
      type(string_t), allocatable :: values(:)
      !! (n) as in the text, strings without their quotes
      logical :: is_quoted
      !! all values are in quotes
   end type entry_t

   !> One group `&name ... /`
   type :: group_t
      character(:), allocatable :: name
      !! in lower case, without the ampersand
      integer :: line
      !! line of its beginning
      type(entry_t), allocatable :: entries(:)
      !! (n) in the order of the text
   end type group_t

contains

   !> Parse a namelist text.
   !>
   !> Errors, each with its line: text outside a group, an unclosed group or string, a key without
   !> value, an empty value, a subscript. A word that is neither key nor value is an error too.
   subroutine parse_namelist(text, groups, error)
      character(*), intent(in) :: text
      !! the whole namelist text, lines with their line feeds
      type(group_t), allocatable, intent(out) :: groups(:)
      !! (n) in the order of the text
      type(error_t), allocatable, intent(out) :: error
      type(group_t) :: group
      type(scanner_t) :: scanner
      type(token_t) :: token
      integer :: n

      n = 0
      call start_scanner(text, scanner, error)
      allocate (groups(min(scanner%ampersands, most_keys) + 1))
      do while (.not. allocated(error))
         call next_token(text, scanner, token, error)
         if (allocated(error)) exit
         if (token%kind == token_end) exit
         if (token%kind /= token_group .or. .not. is_name(token%text)) then
            call fail_at(token, 'is outside a group (&name ... /)', error)
            exit
         end if
         call read_group(text, scanner, token, group, error)
         n = n + 1
         groups(n) = group
         if (n > most_keys) call fail_at(token, 'follows too many groups', error)
      end do
      groups = groups(:n)
   end subroutine parse_namelist

   !> Read a group from after its name to its end.
   subroutine read_group(text, scanner, name, group, error)
      character(*), intent(in) :: text
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(in) :: name
      type(group_t), intent(out) :: group
      type(error_t), allocatable, intent(out) :: error
      type(entry_t) :: entry
      type(token_t) :: token
      integer :: n

      group%name = name%text
      group%line = name%line
      allocate (group%entries(min(scanner%equals_signs, most_keys) + 1))
      n = 0
      call next_token(text, scanner, token, error)
      do while (.not. allocated(error))
         select case (token%kind)
         case (token_slash)
            exit
         case (token_end, token_group)
            if (token%kind == token_group .and. token%text == 'end') exit
            call fail(error, err_input, 'line '//trim(integer_to_text(group%line)) &
               //': the group &'//shown(group%name)//' is not closed with /')
         case (token_word)
            call read_entry(text, scanner, token, entry, error)
            if (allocated(error)) call add_context(error, '&'//shown(group%name))
            n = n + 1
            group%entries(n) = entry
            if (n > most_keys) call fail_at(token, 'follows too many keys', error)
         case default
            call fail_at(token, 'is found where a key or / is expected', error)
         end select
      end do
      group%entries = group%entries(:n)
   end subroutine read_group

   !> Read a key and its values.
   subroutine read_entry(text, scanner, token, entry, error)
      character(*), intent(in) :: text
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(inout) :: token
      !! the key; on return the token after the values
      type(entry_t), intent(out) :: entry
      type(error_t), allocatable, intent(out) :: error

      entry%key = to_lower(token%text)
      entry%line = token%line
      entry%is_quoted = .true.
      if (.not. is_name(entry%key)) then
         call fail_at(token, 'is not a key: a plain name is expected', error)
      else if (.not. is_key(text, scanner)) then
         call fail_at(token, 'is not followed by =', error)
      else
         call next_token(text, scanner, token, error)
         if (.not. allocated(error)) call read_values(text, scanner, token, entry, error)
      end if
   end subroutine read_entry

   !> Read values up to the next key or the end of the group.
   subroutine read_values(text, scanner, token, entry, error)
      character(*), intent(in) :: text
      type(scanner_t), intent(inout) :: scanner
      type(token_t), intent(inout) :: token
      !! the equals sign; on return the token after the values
      type(entry_t), intent(inout) :: entry
      type(error_t), allocatable, intent(out) :: error
      logical :: after_value
      integer :: n

      allocate (entry%values(1))
      n = 0
      after_value = .false.
      do
         call next_token(text, scanner, token, error)
         if (allocated(error)) return
         if (token%kind == token_comma) then
            if (.not. after_value) exit
            after_value = .false.
         else if (token%kind == token_string) then
            call append_values(entry, n, 1, token%text, error)
            after_value = .true.
         else if (token%kind == token_word .and. .not. is_key(text, scanner)) then
            entry%is_quoted = .false.
            call append_word(entry, n, token, error)
            after_value = .true.
         else
            exit
         end if
         if (allocated(error)) return
      end do
      entry%values = entry%values(:n)
      if (n == 0 .or. token%kind == token_comma .or. token%kind == token_equals) then
         call fail(error, err_input, 'line '//trim(integer_to_text(token%line))//': ' &
            //shown(entry%key)//' has an empty value')
      end if
   end subroutine read_values

   !> Append a word, which may be a repeated value.
   subroutine append_word(entry, n, token, error)
      type(entry_t), intent(inout) :: entry
      integer, intent(inout) :: n
      !! number of values in use
      type(token_t), intent(in) :: token
      type(error_t), allocatable, intent(out) :: error
      logical :: ok
      integer :: count
      integer :: star

      star = index(token%text, '*')
      if (star == 0) then
         call append_values(entry, n, 1, token%text, error)
         return
      end if
      call parse_integer(token%text(:star - 1), count, ok)
      if (.not. ok .or. count < 1 .or. star == len(token%text)) then
         call fail_at(token, 'is not a repeated value such as 3*1.0', error)
      else
         call append_values(entry, n, count, token%text(star + 1:), error)
      end if
   end subroutine append_word

   !> Append a value once or several times; double the array when it is full.
   subroutine append_values(entry, n, count, value, error)
      type(entry_t), intent(inout) :: entry
      integer, intent(inout) :: n
      !! number of values in use
      integer, intent(in) :: count
      character(*), intent(in) :: value
      type(error_t), allocatable, intent(out) :: error
      type(string_t), allocatable :: grown(:)
      integer :: i

      if (count > most_values - n) then
         call fail(error, err_input, 'line '//trim(integer_to_text(entry%line))//': ' &
            //shown(entry%key)//' has more than '//trim(integer_to_text(most_values))//' values')
         return
      end if
      if (n + count > size(entry%values)) then
         allocate (grown(2*(n + count)))
         grown(:n) = entry%values(:n)
         call move_alloc(grown, entry%values)
      end if
      do i = n + 1, n + count
         entry%values(i)%text = value
      end do
      n = n + count
   end subroutine append_values

   !> True if the last word is a key, followed by an equals sign.
   pure logical function is_key(text, scanner)
      character(*), intent(in) :: text
      type(scanner_t), intent(in) :: scanner
      type(scanner_t) :: ahead

      ahead = scanner
      call skip_blanks(text, ahead)
      is_key = .false.
      if (ahead%position <= len(text)) is_key = text(ahead%position:ahead%position) == '='
   end function is_key

   !> True for a letter followed by letters, digits and underscores.
   pure logical function is_name(text)
      character(*), intent(in) :: text
      character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz'

      is_name = len(text) > 0 .and. scan(text, letters) == 1 &
         .and. verify(text, letters//'0123456789_') == 0
   end function is_name

   !> Report an error at a token.
   subroutine fail_at(token, problem, error)
      type(token_t), intent(in) :: token
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error

      call fail(error, err_input, 'line '//trim(integer_to_text(token%line))//": '" &
         //shown(token%text)//"' "//problem)
   end subroutine fail_at

end module rwmf_input_namelist
