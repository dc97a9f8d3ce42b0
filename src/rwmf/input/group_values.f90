!> What checked namelist groups say: values by group and key, defaults of the schema filled in.
!>
!> The groups have passed `check_groups`, so that nothing here can fail.
module rwmf_input_group_values
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_namelist, only: entry_t, group_t
   use rwmf_input_schema, only: find_key, key_t, keys_of
   use rwmf_input_value_check, only: parse_bound, parse_logical
   use rwmf_text_strings, only: parse_integer, string_t, to_lower
   implicit none
   private

   public :: has_group, has_key, group_of, entry_of
   public :: values_of, values_for, text_of, real_of, integer_of, logical_of
   public :: get_real, get_text, get_list

   character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'

contains

   !> Place of a group, 0 when it is not there.
   pure integer function group_of(groups, name)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: name
      !! in small letters

      do group_of = size(groups), 1, -1
         if (groups(group_of)%name == name) exit
      end do
   end function group_of

   !> Place of a key in its group, 0 when it is not there.
   pure integer function entry_of(group, key)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: key
      !! letters may be small or capital

      do entry_of = size(group%entries), 1, -1
         if (group%entries(entry_of)%key == to_lower(key)) exit
      end do
   end function entry_of

   !> Is the group given?
   pure logical function has_group(groups, name)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: name

      has_group = group_of(groups, name) > 0
   end function has_group

   !> Is the key given?
   pure logical function has_key(groups, group, key)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      integer :: at

      at = group_of(groups, group)
      has_key = .false.
      if (at > 0) has_key = entry_of(groups(at), key) > 0
   end function has_key

   !> The values of a key: given, by default, or none.
   pure function values_of(groups, group, key) result(values)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      type(string_t), allocatable :: values(:)
      !! (n) as they stand in the case, names of choices in small letters
      type(key_t), allocatable :: keys(:)

      keys = keys_of(group)
      values = values_for(groups, keys(find_key(keys, key)))
   end function values_of

   !> The same for a row of the schema, which is then read again only where a default may be the
   !> name of another key.
   pure recursive function values_for(groups, row) result(values)
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: row
      type(string_t), allocatable :: values(:)
      !! (n) as they stand in the case, names of choices in small letters
      type(key_t), allocatable :: keys(:)
      integer :: at

      if (has_key(groups, trim(row%group), trim(row%key))) then
         at = group_of(groups, trim(row%group))
         values = groups(at)%entries(entry_of(groups(at), trim(row%key)))%values
         if (row%type == 'choice') values(1)%text = to_lower(trim(values(1)%text))
         return
      end if
      if (row%default == '') then
         allocate (values(0))
         return
      end if
      if (scan(row%default(1:1), letters) > 0) then
         keys = keys_of(trim(row%group))
         at = find_key(keys, trim(row%default))
         if (at > 0) then
            values = values_for(groups, keys(at))
            return
         end if
      end if
      allocate (values(1))
      values(1)%text = trim(row%default)
   end function values_for

   !> The value of a key as text, '' when there is none.
   pure function text_of(groups, group, key) result(text)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(:), allocatable :: text
      type(string_t), allocatable :: values(:)

      values = values_of(groups, group, key)
      text = ''
      if (size(values) > 0) text = values(1)%text
   end function text_of

   !> The value of a real key, zero when there is none [its unit].
   pure real(wp) function real_of(groups, group, key)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key

      real_of = real(parse_bound(text_of(groups, group, key)), wp)
   end function real_of

   !> The value of an integer key, zero when there is none.
   pure integer function integer_of(groups, group, key)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      logical :: ok

      call parse_integer(text_of(groups, group, key), integer_of, ok)
   end function integer_of

   !> The value of a logical key, false when there is none.
   pure logical function logical_of(groups, group, key)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      logical :: ok

      call parse_logical(text_of(groups, group, key), logical_of, ok)
   end function logical_of

   !> Set a real that stays unallocated when the key has no value.
   pure subroutine get_real(groups, group, key, value)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      real(wp), allocatable, intent(out) :: value
      !! [unit of the key]

      if (text_of(groups, group, key) /= '') value = real_of(groups, group, key)
   end subroutine get_real

   !> Set a text that stays unallocated when the key has no value.
   pure subroutine get_text(groups, group, key, value)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(:), allocatable, intent(out) :: value

      value = text_of(groups, group, key)
      if (value == '') deallocate (value)
   end subroutine get_text

   !> Set a list that stays unallocated when the key has no value.
   pure subroutine get_list(groups, group, key, list)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      real(wp), allocatable, intent(out) :: list(:)
      !! (n) [unit of the key]
      type(string_t), allocatable :: values(:)
      real(dp) :: number
      integer :: i

      values = values_of(groups, group, key)
      if (size(values) == 0) return
      allocate (list(size(values)))
      do i = 1, size(values)
         number = parse_bound(values(i)%text)
         list(i) = real(number, wp)
      end do
   end subroutine get_list

end module rwmf_input_group_values
