!> Check of a value of a case file against the values that its key allows, and its conversion.
module rwmf_input_value_check
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_kinds, only: dp, wp
   use rwmf_problem_key, only: any_real, key_t
   use rwmf_text_strings, only: next_word, parse_integer, parse_real, to_lower
   implicit none
   private

   public :: check_value, check_number, default_number, requirement, usual_bounds

   integer, parameter :: requirement_length = 256

contains

   !> Check a value and convert it to a number.
   pure subroutine check_value(key, value, is_quoted, number, problem)
      type(key_t), intent(in) :: key
      character(*), intent(in) :: value
      !! text of the value in the case, without quotes
      logical, intent(in) :: is_quoted
      !! the value is quoted in the case
      real(dp), intent(out) :: number
      !! value of a number, 1 or 0 for a logical, 0 for texts [unit of the key]
      character(:), allocatable, intent(out) :: problem
      !! requirement 'must be ...'; not allocated if the value is valid
      logical :: ok
      logical :: truth
      integer :: whole

      ok = .false.
      number = 0
      select case (key%type)
      case ('choice')
         ! one of the names, in upper or lower case
         if (is_quoted) ok = len_trim(value) > 0 .and. scan(trim(value), ' ') == 0 .and. index(' ' &
            //trim(key%allowed)//' '//trim(key%former)//' ', ' '//to_lower(trim(value))//' ') > 0
      case ('text', 'text list')
         ok = is_quoted .and. len_trim(value) > 0
      case ('logical')
         call parse_logical(value, truth, ok)
         number = merge(1, 0, truth)
         ok = ok .and. .not. is_quoted
      case ('integer', 'integers')
         call parse_integer(value, whole, ok)
         number = whole
         ok = ok .and. .not. is_quoted .and. is_within(trim(key%allowed), number)
      case default
         call parse_real(value, number, ok)
         ok = ok .and. .not. is_quoted .and. is_within(trim(key%allowed), number)
      end select
      if (ok) return
      problem = 'must be '//trim(requirement(key))
      if (key%type == 'choice' .and. .not. is_quoted) problem = problem//' in quotes'
   end subroutine check_value

   !> Check a number that was not given as text.
   pure subroutine check_number(key, number, problem)
      type(key_t), intent(in) :: key
      !! of type 'real', 'real list', 'integer' or 'logical'
      real(dp), intent(in) :: number
      !! 1 or 0 for a logical [unit of the key]
      character(:), allocatable, intent(out) :: problem
      !! requirement 'must be ...'; not allocated if the number is valid
      logical :: ok

      ok = ieee_is_finite(number)
      select case (key%type)
      case ('logical')
         if (ok) ok = abs(number) <= 0 .or. abs(number - 1) <= 0
      case ('integer', 'integers')
         if (ok) ok = abs(number) <= huge(1)
         if (ok) ok = abs(number - anint(number)) <= 0 .and. is_within(trim(key%allowed), number)
      case default
         if (ok) ok = is_within(trim(key%allowed), number)
      end select
      if (.not. ok) problem = 'must be '//trim(requirement(key))
   end subroutine check_number

   !> Default of a key as a number; 0 for a text [unit of the key].
   pure real(dp) function default_number(key) result(number)
      type(key_t), intent(in) :: key
      logical :: truth
      logical :: ok

      number = 0
      select case (key%type)
      case ('choice', 'text', 'text list')
         return
      case ('logical')
         call parse_logical(trim(key%default), truth, ok)
         number = merge(1, 0, truth)
      case default
         number = parse_bound(trim(key%default))
      end select
   end function default_number

   !> Bounds of the range of a key in real buildings [unit of the key].
   pure function usual_bounds(key) result(bounds)
      type(key_t), intent(in) :: key
      !! key with a range
      real(wp) :: bounds(2)
      integer :: comma

      comma = index(key%usual, ',')
      bounds(1) = real(parse_bound(key%usual(2:comma - 1)), wp)
      bounds(2) = real(parse_bound(key%usual(comma + 1:index(key%usual, ']') - 1)), wp)
   end function usual_bounds

   !> Requirement on the values of a key, for messages: `a number >= 0 [-]`.
   pure function requirement(key) result(text)
      type(key_t), intent(in) :: key
      character(requirement_length) :: text

      select case (key%type)
      case ('choice')
         text = quoted_choices(trim(key%allowed))
      case ('text')
         text = 'a text in quotes'
      case ('text list')
         text = 'texts in quotes'
      case ('logical')
         text = '.true. or .false.'
      case ('integer')
         text = 'an integer '//range_text(key)
      case ('real list')
         text = 'numbers '//range_text(key)
      case ('integers')
         text = 'an integer '//trim(range_text(key))//', or one for each element'
      case ('reals')
         text = 'a number '//trim(range_text(key))//', or one for each element'
      case default
         text = 'a number '//range_text(key)
      end select
      if (key%allowed == any_real) text = any_real
      if (key%unit /= '') text = trim(text)//' ['//trim(key%unit)//']'
   end function requirement

   !> Range of a key, for messages: `>= 0` or `in (0, 1]`.
   pure function range_text(key) result(text)
      type(key_t), intent(in) :: key
      character(len(key%allowed) + 3) :: text

      text = key%allowed
      if (scan(text, '([') == 1) text = 'in '//key%allowed
   end function range_text

   !> List of quoted choices, for messages: `'a', 'b' or 'c'`.
   pure function quoted_choices(names) result(text)
      character(*), intent(in) :: names
      !! names separated by blanks
      character(requirement_length) :: text
      integer :: first
      integer :: last
      integer :: position

      text = ''
      position = 1
      do
         call next_word(names, position, first, last)
         if (last < first) return
         if (first == 1) then
            text = "'"//names(first:last)//"'"
         else if (last == len(names)) then
            text = trim(text)//" or '"//names(first:last)//"'"
         else
            text = trim(text)//", '"//names(first:last)//"'"
         end if
      end do
   end function quoted_choices

   !> Read a logical value such as `.true.` or `T`.
   pure subroutine parse_logical(text, value, ok)
      character(*), intent(in) :: text
      logical, intent(out) :: value
      logical, intent(out) :: ok

      value = .false.
      ok = .true.
      select case (to_lower(text))
      case ('.true.', 'true', 't', '.t.')
         value = .true.
      case ('.false.', 'false', 'f', '.f.')
         value = .false.
      case default
         ok = .false.
      end select
   end subroutine parse_logical

   !> True if a number is in a range such as `> 0`, `>= 0` or `(0, 0.1]`.
   pure logical function is_within(allowed, x)
      character(*), intent(in) :: allowed
      real(dp), intent(in) :: x
      !! [any]
      real(dp) :: low
      real(dp) :: high
      integer :: comma
      integer :: last

      last = len(allowed)
      comma = index(allowed, ',')
      if (index(allowed, '>=') == 1) then
         is_within = x >= parse_bound(allowed(3:))
      else if (index(allowed, '>') == 1) then
         is_within = x > parse_bound(allowed(2:))
      else if (comma == 0) then
         is_within = .true.
      else
         low = parse_bound(allowed(2:comma - 1))
         high = parse_bound(allowed(comma + 1:last - 1))
         is_within = (x > low .or. (allowed(1:1) == '[' .and. x >= low)) &
            .and. (x < high .or. (allowed(last:) == ']' .and. x <= high))
      end if
   end function is_within

   !> Number of the schema; `pi/2` is allowed.
   pure real(dp) function parse_bound(text)
      character(*), intent(in) :: text
      logical :: ok

      if (adjustl(text) == 'pi/2') then
         parse_bound = acos(-1.0_dp)/2
      else
         call parse_real(trim(adjustl(text)), parse_bound, ok)
      end if
   end function parse_bound

end module rwmf_input_value_check
