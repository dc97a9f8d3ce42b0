!> Values of a case by group and key, converted once, including the defaults of absent keys.
!>
!> The keys are those of the schema, in its order. They have passed its checks, so no access can
!> fail. All values share a few arrays, which makes a copy of a case cheap.
module rwmf_problem_group_values
   use rwmf_core_kinds, only: dp, wp
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: group_values_t, key_values_t, group_place_t
   public :: has_group, has_key, applies, group_place, key_place, key_code, key_line, value_text
   public :: text_of, real_of, integer_of, logical_of
   public :: get_real, get_text, get_list, get_texts
   public :: derive, as_given

   !> Position of a group in the text of the case.
   type :: group_place_t
      character(12) :: name
      logical :: is_given
      integer :: line
      !! 0 if it is not given
      integer :: code
      !! `key_code` of the group
      integer :: first_key = 1
      !! index of its first key
      integer :: last_key = 0
      !! index of its last key
   end type group_place_t

   !> The values of one key.
   type :: key_values_t
      character(12) :: group
      character(40) :: key
      !! in the spelling of the documentation
      character(40) :: name
      !! in lower case
      logical :: is_given
      !! given by the case, not a default
      logical :: is_quoted
      integer :: line
      !! 0 if it is not given
      integer :: n
      !! number of values
      integer :: first
      !! index of the first value in the arrays of all values
      integer :: source = 0
      !! index of the key from which it is derived, possibly the key itself; 0 for values as given
      integer :: n_given = 0
      !! for derived values: number of values that the case gives
      integer :: first_given = 0
      !! index of the first of these
      character(6) :: unit = '-'
      !! unit of the values
      real(wp) :: usual(2) = [0.0_wp, huge(1.0_wp)]
      !! range of their magnitudes in real buildings, in that unit
   end type key_values_t

   !> All values of a case.
   type :: group_values_t
      type(group_place_t), allocatable :: groups(:)
      !! (groups of the schema)
      type(key_values_t), allocatable :: keys(:)
      !! (keys of the schema)
      integer, allocatable :: codes(:)
      !! (keys of the schema) `key_code` of each
      real(dp), allocatable :: numbers(:)
      !! (values) [unit of the key]; 1 or 0 for a logical, 0 for texts
      integer, allocatable :: ends(:)
      !! (0:values) end of the text of each value; 0 at the beginning of the first
      character(:), allocatable :: texts
      !! concatenated texts as given in the case; names of choices in lower case
      logical :: has_units = .false.
      !! some of its keys are derived from others (`derive`)
   end type group_values_t

contains

   !> Index of a group; 0 if there is none of that name.
   pure integer function group_place(values, name) result(place)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: name
      !! name of the group, in lower case
      integer :: code

      place = 0
      if (.not. allocated(values%groups)) return
      code = key_code(name, '')
      do place = size(values%groups), 1, -1
         if (values%groups(place)%code /= code) cycle
         if (values%groups(place)%name == name) exit
      end do
   end function group_place

   !> Index of a key; 0 if there is none of that name.
   pure integer function key_place(values, group, key) result(place)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key, in upper or lower case
      integer :: at
      integer :: code

      at = group_place(values, group)
      place = 0
      if (at == 0) return
      ! Filling a case takes some hundred look-ups: the code avoids most comparisons of texts.
      code = continued(values%groups(at)%code, key)
      do place = values%groups(at)%last_key, values%groups(at)%first_key, -1
         if (values%codes(place) /= code) cycle
         if (values%keys(place)%name /= to_lower(key)) cycle
         if (values%keys(place)%group == group) return
      end do
      place = 0
   end function key_place

   !> Hash of a group and key; most keys have a unique one.
   pure integer function key_code(group, key) result(code)
      character(*), intent(in) :: group
      !! name of the group, without &, in lower case
      character(*), intent(in) :: key
      !! name of the key, '' for the group itself; in upper or lower case

      code = continued(continued(0, group), key)
   end function key_code

   !> Hash of a name that continues an earlier hash.
   pure integer function continued(before, name) result(code)
      integer, intent(in) :: before
      character(*), intent(in) :: name
      !! name in upper or lower case
      integer, parameter :: most = 2**24 - 1
      !! 31 times this number still fits in an integer
      integer :: letter
      integer :: i

      code = before
      do i = 1, len_trim(name)
         letter = iachar(name(i:i))
         if (name(i:i) >= 'A' .and. name(i:i) <= 'Z') letter = letter + 32
         code = iand(31*code + letter, most)
      end do
   end function continued

   !> True if the case gives the group.
   pure logical function has_group(values, name)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: name
      !! name of the group, without &
      integer :: place

      place = group_place(values, name)
      has_group = .false.
      if (place > 0) has_group = values%groups(place)%is_given
   end function has_group

   !> True if a group applies to the case: it is given, or its defaults hold without it.
   pure logical function applies(values, name)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: name
      !! name of the group, without &

      select case (name)
      case ('model', 'solver')
         applies = .true.
      case ('impact')
         applies = has_group(values, name) .or. (has_group(values, 'wall') &
            .and. text_of(values, 'wall', 'base') == 'rocking')
      case default
         applies = has_group(values, name)
      end select
   end function applies

   !> True if the case gives the key.
   pure logical function has_key(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      integer :: place

      place = key_place(values, group, key)
      has_key = .false.
      if (place > 0) has_key = values%keys(place)%is_given
   end function has_key

   !> Line of a key in the text of the case; 0 if it is not given.
   pure integer function key_line(values, group, key) result(line)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      integer :: place

      place = key_place(values, group, key)
      line = 0
      if (place > 0) line = values%keys(place)%line
   end function key_line

   !> Length of the text of a value.
   pure integer function value_length(values, number) result(length)
      type(group_values_t), intent(in) :: values
      integer, intent(in) :: number
      !! index of the value among all; 0 for none

      length = 0
      if (number > 0) length = values%ends(number) - values%ends(number - 1)
   end function value_length

   !> Text of a value.
   pure function value_text(values, number) result(text)
      type(group_values_t), intent(in) :: values
      integer, intent(in) :: number
      !! index of the value among all; 0 for none
      character(value_length(values, number)) :: text

      if (number > 0) text = values%texts(values%ends(number - 1) + 1:values%ends(number))
   end function value_text

   !> Index of the first value of a key among all; 0 if it has none.
   pure integer function first_value(values, group, key) result(number)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      integer :: place

      number = 0
      place = key_place(values, group, key)
      if (place == 0) return
      if (values%keys(place)%n > 0) number = values%keys(place)%first
   end function first_value

   !> Value of a key as text; '' if it has none.
   pure function text_of(values, group, key) result(text)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(value_length(values, first_value(values, group, key))) :: text

      text = value_text(values, first_value(values, group, key))
   end function text_of

   !> Value of a real key; zero if it has none [its unit].
   pure real(wp) function real_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      integer :: number

      number = first_value(values, group, key)
      real_of = 0
      if (number > 0) real_of = real(values%numbers(number), wp)
   end function real_of

   !> Value of an integer key; zero if it has none.
   pure integer function integer_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key

      integer_of = nint(real_of(values, group, key))
   end function integer_of

   !> Value of a logical key; false if it has none.
   pure logical function logical_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key

      logical_of = real_of(values, group, key) > 0
   end function logical_of

   !> Get a real value; it stays unallocated if the key has none.
   pure subroutine get_real(values, group, key, value)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      real(wp), allocatable, intent(out) :: value
      !! [unit of the key]
      integer :: number

      number = first_value(values, group, key)
      if (number > 0) value = real(values%numbers(number), wp)
   end subroutine get_real

   !> Get a text; it stays unallocated if the key has no value.
   pure subroutine get_text(values, group, key, value)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(:), allocatable, intent(out) :: value
      !! not allocated if the key has no value
      integer :: number

      number = first_value(values, group, key)
      if (number > 0) value = value_text(values, number)
   end subroutine get_text

   !> Get a list; it stays unallocated if the key has no value.
   pure subroutine get_list(values, group, key, list)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      real(wp), allocatable, intent(out) :: list(:)
      !! (n) [unit of the key]
      integer :: place

      place = key_place(values, group, key)
      if (place == 0) return
      associate (row => values%keys(place))
         if (row%n > 0) list = real(values%numbers(row%first:row%first + row%n - 1), wp)
      end associate
   end subroutine get_list

   !> Get a list of texts; it stays unallocated if the key has no value.
   pure subroutine get_texts(values, group, key, list)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(:), allocatable, intent(out) :: list(:)
      !! (n) padded with blanks
      integer :: place
      integer :: i

      place = key_place(values, group, key)
      if (place == 0) return
      associate (row => values%keys(place))
         if (row%n == 0) return
         allocate (character(maxval([(value_length(values, i), i=row%first, row%first + row%n &
            - 1)])) :: list(row%n))
         do i = 1, row%n
            list(i) = value_text(values, row%first + i - 1)
         end do
      end associate
   end subroutine get_texts

   !> Set the values of a key that are derived from another key, or from its own values.
   subroutine derive(values, group, key, source, numbers)
      type(group_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: source
      !! name of the key of the group that the case gives, for messages
      real(wp), intent(in) :: numbers(:)
      !! (n) [unit of the key]
      integer :: n

      n = maxval(values%keys%first + values%keys%n) - 1
      if (n + size(numbers) > size(values%numbers)) call grow(values, n + size(numbers))
      associate (row => values%keys(key_place(values, group, key)))
         if (row%source == 0 .and. row%is_given) then
            row%n_given = row%n
            row%first_given = row%first
         end if
         row%source = key_place(values, group, source)
         row%is_given = .true.
         row%first = n + 1
         row%n = size(numbers)
      end associate
      values%numbers(n + 1:n + size(numbers)) = real(numbers, dp)
      ! derived values have no text
      values%ends(n + 1:n + size(numbers)) = values%ends(n)
   end subroutine derive

   !> Enlarge the arrays of all values.
   subroutine grow(values, n)
      type(group_values_t), intent(inout) :: values
      integer, intent(in) :: n
      !! required number of values
      integer, parameter :: spare = 64
      real(dp), allocatable :: numbers(:)
      integer, allocatable :: ends(:)
      integer :: old

      old = size(values%numbers)
      allocate (numbers(n + spare), ends(0:n + spare))
      numbers(:old) = values%numbers
      ends(0:old) = values%ends
      call move_alloc(numbers, values%numbers)
      call move_alloc(ends, values%ends)
   end subroutine grow

   !> Key as the case gives it, without derived values.
   elemental type(key_values_t) function as_given(row) result(given)
      type(key_values_t), intent(in) :: row

      given = row
      if (row%source == 0) return
      given%is_given = row%n_given > 0
      given%n = row%n_given
      given%first = row%first_given
      given%source = 0
      given%n_given = 0
      given%first_given = 0
   end function as_given

end module rwmf_problem_group_values
