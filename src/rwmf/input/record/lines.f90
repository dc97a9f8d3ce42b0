!> Lines of a record file: comments, lines of numbers, the messages about their words.
module rwmf_input_record_lines
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_strings, only: integer_to_text, next_word, shown, to_lower
   implicit none
   private

   public :: fail_at_word, is_comment, is_number_line, behind_mark, known_formats

   character(*), parameter :: marks = '#%!'
   !! first letters of comments, beside '//'
   character(*), parameter :: known_formats = 'known formats are AT2, ESM, K-NET, CSMNC, ' &
      //'COSMOS, CGS, and numbers below one line of names'

contains

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

   !> True for a comment.
   pure logical function is_comment(text)
      character(*), intent(in) :: text
      !! one line

      is_comment = behind_mark(text) > 1
   end function is_comment

   !> First position behind the mark of a comment, 1 without one.
   pure integer function behind_mark(text)
      character(*), intent(in) :: text
      !! one line
      integer :: first
      integer :: last
      integer :: position

      position = 1
      call next_word(text, position, first, last)
      behind_mark = 1
      ! a blank line has no mark
      if (last < first) return
      if (scan(text(first:first), marks) == 1) then
         behind_mark = first + 1
      else if (text(first:min(last, first + 1)) == '//') then
         behind_mark = first + 2
      end if
   end function behind_mark

   !> True for a line that begins like a number, damaged numbers, NaN and infinity included.
   pure logical function is_number_line(text)
      character(*), intent(in) :: text
      !! one line
      character(8) :: start
      integer :: first
      integer :: last
      integer :: position

      position = 1
      call next_word(text, position, first, last)
      is_number_line = last >= first
      if (.not. is_number_line) return
      start = to_lower(text(first:min(last, first + len(start) - 1)))
      is_number_line = scan(start(1:1), '0123456789+-.*') == 1 .or. start == 'nan' &
         .or. start == 'inf' .or. start == 'infinity'
   end function is_number_line

end module rwmf_input_record_lines
