!> What a case says: the values of its keys by group and key, each converted once, with the defaults
!> of the keys that are not given.
!>
!> The keys are those of the schema, in its order. They have passed its checks, so that no access
!> can fail. A few arrays hold all values, so that a copy of a case stays cheap.
module rwmf_problem_group_values
   use rwmf_core_kinds, only: dp, wp
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: group_values_t, key_values_t, group_place_t
   public :: has_group, has_key, group_place, key_place, key_code, key_line, value_text
   public :: text_of, real_of, integer_of, logical_of
   public :: get_real, get_text, get_list, get_texts
   public :: derive, as_given

   !> Where a group stands in the text of the case.
   type :: group_place_t
      character(12) :: name
      logical :: is_given
      integer :: line
      !! 0 when it is not given
      integer :: code
      !! `key_code` of the group
      integer :: first_key = 1
      !! place of its first key
      integer :: last_key = 0
      !! and of its last
   end type group_place_t

   !> The values of one key.
   type :: key_values_t
      character(12) :: group
      character(20) :: key
      !! as the documentation spells it
      character(20) :: name
      !! in small letters
      logical :: is_given
      !! by the case, not by default
      logical :: is_quoted
      integer :: line
      !! 0 when it is not given
      integer :: n
      !! number of values
      integer :: first
      !! place of the first value among all
      integer :: source = 0
      !! place of the key that it follows from, which may be the key itself; 0 for values as given
      integer :: n_given = 0
      !! of values that follow from others: number of those that the case gives
      integer :: first_given = 0
      !! and place of the first of them
      character(6) :: unit = '-'
      !! of the values
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
      !! (values) [unit of the key]; of a logical 1 or 0, of texts 0
      integer, allocatable :: ends(:)
      !! (0:values) where the text of each ends; 0 where the first begins
      character(:), allocatable :: texts
      !! one after the other, as they stand in the case, names of choices in small letters
      logical :: has_units = .false.
      !! some of its keys follow from others (`derive`)
   end type group_values_t

contains

   !> Place of a group; 0 when there is no such group.
   pure integer function group_place(values, name) result(place)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: name
      !! in small letters
      integer :: code

      place = 0
      if (.not. allocated(values%groups)) return
      code = key_code(name, '')
      do place = size(values%groups), 1, -1
         if (values%groups(place)%code /= code) cycle
         if (values%groups(place)%name == name) exit
      end do
   end function group_place

   !> Place of a key; 0 when there is no such key.
   pure integer function key_place(values, group, key) result(place)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! letters may be small or capital
      integer :: at
      integer :: code

      at = group_place(values, group)
      place = 0
      if (at == 0) return
      ! a case is filled with some hundred look-ups: few of them compare letters
      code = continued(values%groups(at)%code, key)
      do place = values%groups(at)%last_key, values%groups(at)%first_key, -1
         if (values%codes(place) /= code) cycle
         if (values%keys(place)%name /= to_lower(key)) cycle
         if (values%keys(place)%group == group) return
      end do
      place = 0
   end function key_place

   !> A number that most keys have for themselves.
   pure integer function key_code(group, key) result(code)
      character(*), intent(in) :: group
      !! its name, without &, in small letters
      character(*), intent(in) :: key
      !! its name, '' for the group itself; letters may be small or capital

      code = continued(continued(0, group), key)
   end function key_code

   !> The number that a name makes of the one before it.
   pure integer function continued(before, name) result(code)
      integer, intent(in) :: before
      character(*), intent(in) :: name
      !! letters may be small or capital
      integer, parameter :: most = 2**24 - 1
      !! 31 times as much is still an integer
      integer :: letter
      integer :: i

      code = before
      do i = 1, len_trim(name)
         letter = iachar(name(i:i))
         if (name(i:i) >= 'A' .and. name(i:i) <= 'Z') letter = letter + 32
         code = iand(31*code + letter, most)
      end do
   end function continued

   !> Is the group given?
   pure logical function has_group(values, name)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: name
      !! its name, without &
      integer :: place

      place = group_place(values, name)
      has_group = .false.
      if (place > 0) has_group = values%groups(place)%is_given
   end function has_group

   !> Is the key given?
   pure logical function has_key(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      integer :: place

      place = key_place(values, group, key)
      has_key = .false.
      if (place > 0) has_key = values%keys(place)%is_given
   end function has_key

   !> Line of a key in the text of the case; 0 when it is not given.
   pure integer function key_line(values, group, key) result(line)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      integer :: place

      place = key_place(values, group, key)
      line = 0
      if (place > 0) line = values%keys(place)%line
   end function key_line

   !> Length of the text of a value.
   pure integer function value_length(values, number) result(length)
      type(group_values_t), intent(in) :: values
      integer, intent(in) :: number
      !! of the value among all; 0 for none

      length = 0
      if (number > 0) length = values%ends(number) - values%ends(number - 1)
   end function value_length

   !> The text of a value.
   pure function value_text(values, number) result(text)
      type(group_values_t), intent(in) :: values
      integer, intent(in) :: number
      !! of the value among all; 0 for none
      character(value_length(values, number)) :: text

      if (number > 0) text = values%texts(values%ends(number - 1) + 1:values%ends(number))
   end function value_text

   !> Number of the first value of a key among all; 0 when it has none.
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

   !> The value of a key as text, '' when there is none.
   pure function text_of(values, group, key) result(text)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(value_length(values, first_value(values, group, key))) :: text

      text = value_text(values, first_value(values, group, key))
   end function text_of

   !> The value of a real key, zero when there is none [its unit].
   pure real(wp) function real_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      integer :: number

      number = first_value(values, group, key)
      real_of = 0
      if (number > 0) real_of = real(values%numbers(number), wp)
   end function real_of

   !> The value of an integer key, zero when there is none.
   pure integer function integer_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name

      integer_of = nint(real_of(values, group, key))
   end function integer_of

   !> The value of a logical key, false when there is none.
   pure logical function logical_of(values, group, key)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name

      logical_of = real_of(values, group, key) > 0
   end function logical_of

   !> Set a real that stays unallocated when the key has no value.
   pure subroutine get_real(values, group, key, value)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      real(wp), allocatable, intent(out) :: value
      !! [unit of the key]
      integer :: number

      number = first_value(values, group, key)
      if (number > 0) value = real(values%numbers(number), wp)
   end subroutine get_real

   !> Set a text that stays unallocated when the key has no value.
   pure subroutine get_text(values, group, key, value)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(:), allocatable, intent(out) :: value
      !! not allocated when the key has no value
      integer :: number

      number = first_value(values, group, key)
      if (number > 0) value = value_text(values, number)
   end subroutine get_text

   !> Set a list that stays unallocated when the key has no value.
   pure subroutine get_list(values, group, key, list)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      real(wp), allocatable, intent(out) :: list(:)
      !! (n) [unit of the key]
      integer :: place

      place = key_place(values, group, key)
      if (place == 0) return
      associate (row => values%keys(place))
         if (row%n > 0) list = real(values%numbers(row%first:row%first + row%n - 1), wp)
      end associate
   end subroutine get_list

   !> Set a list of texts that stays unallocated when the key has no value.
   pure subroutine get_texts(values, group, key, list)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
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

   !> Let the values of a key follow from another key, or from those that it has itself.
   subroutine derive(values, group, key, source, numbers)
      type(group_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: source
      !! name of the key of the group that the user gives, for messages
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
      ! they stand in no text
      values%ends(n + 1:n + size(numbers)) = values%ends(n)
   end subroutine derive

   !> Make room for values.
   subroutine grow(values, n)
      type(group_values_t), intent(inout) :: values
      integer, intent(in) :: n
      !! that are needed
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

   !> A key as the case gives it, before anything follows from it.
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
