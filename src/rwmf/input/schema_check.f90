!> Does namelist text hold to the schema: known groups and keys, once each, with allowed values?
module rwmf_input_schema_check
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_input_namelist, only: entry_t, group_t
   use rwmf_input_schema, only: find_key, group_names, key_t, keys_of
   use rwmf_input_value_check, only: requirement, value_problem
   use rwmf_text_strings, only: integer_to_text, nearest_name, shown
   implicit none
   private

   public :: check_groups, fail_at_entry, fail_at_group

contains

   !> Check groups one by one. Rules between groups are those of rwmf_case_rules.
   !>
   !> Errors: unknown or repeated group, unknown or repeated key, wrong type, value out of range,
   !> required key that is missing. The message names group, key, value, line and what is allowed.
   subroutine check_groups(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      integer :: j

      do i = 1, size(groups)
         call check_name(groups(i), error)
         if (allocated(error)) return
         do j = 1, i - 1
            if (groups(j)%name /= groups(i)%name) cycle
            call fail_at_group(groups(i), 'the group is given twice, before in line ' &
               //integer_to_text(groups(j)%line), error)
            return
         end do
         call check_entries(groups(i), error)
         if (allocated(error)) return
      end do
   end subroutine check_groups

   !> Is the group known?
   subroutine check_name(group, error)
      type(group_t), intent(in) :: group
      type(error_t), allocatable, intent(out) :: error
      character(12), allocatable :: names(:)
      character(:), allocatable :: known
      character(:), allocatable :: near
      integer :: i

      names = group_names()
      if (any(names == group%name)) return
      near = nearest_name(group%name, names)
      if (near /= '') near = ', did you mean &'//near//'?'
      known = '; allowed:'
      do i = 1, size(names)
         known = known//' &'//trim(names(i))
      end do
      call fail_at_group(group, 'unknown group'//near//known, error)
   end subroutine check_name

   !> Check the keys of a group.
   subroutine check_entries(group, error)
      type(group_t), intent(in) :: group
      type(error_t), allocatable, intent(out) :: error
      type(key_t), allocatable :: keys(:)
      logical, allocatable :: is_given(:)
      integer :: at
      integer :: i

      keys = keys_of(group%name)
      allocate (is_given(size(keys)))
      is_given(:) = .false.
      do i = 1, size(group%entries)
         at = find_key(keys, group%entries(i)%key)
         if (at == 0) then
            call fail_unknown_key(group, group%entries(i), keys, error)
         else if (is_given(at)) then
            call fail_at_entry(group, group%entries(i), 'the key is given twice', error)
         else
            is_given(at) = .true.
            call check_values(group, group%entries(i), keys(at), error)
         end if
         if (allocated(error)) return
      end do
      do i = 1, size(keys)
         if (is_given(i) .or. .not. keys(i)%is_required) cycle
         call fail_at_group(group, 'the key '//trim(keys(i)%key)//' is missing (' &
            //trim(keys(i)%help)//'): must be '//requirement(keys(i)), error)
         return
      end do
   end subroutine check_entries

   !> Report a key that the group does not have.
   subroutine fail_unknown_key(group, entry, keys, error)
      type(group_t), intent(in) :: group
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: keys(:)
      type(error_t), allocatable, intent(out) :: error
      character(len(keys%key)), allocatable :: names(:)
      character(:), allocatable :: known
      character(:), allocatable :: near
      integer :: i

      known = '; allowed:'
      allocate (names(size(keys)))
      do i = 1, size(keys)
         names(i) = keys(i)%key
         known = known//' '//trim(names(i))
      end do
      near = nearest_name(entry%key, names)
      if (near /= '') near = ', did you mean '//near//'?'
      call fail_at_entry(group, entry, 'unknown key'//near//known, error)
   end subroutine fail_unknown_key

   !> Check number, type and range of the values of a key.
   subroutine check_values(group, entry, key, error)
      type(group_t), intent(in) :: group
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: key
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      integer :: i

      if (key%type /= 'real list' .and. size(entry%values) > 1) then
         call fail_at_entry(group, entry, 'must be one value: '//requirement(key), error)
         return
      end if
      do i = 1, size(entry%values)
         problem = value_problem(key, entry%values(i)%text, entry%is_quoted)
         if (problem /= '') then
            call fail_at_entry(group, entry, problem, error)
            return
         end if
      end do
   end subroutine check_values

   !> Report a key with its value: `&frame: gamma = -1.0 (line 7): must be ...`.
   subroutine fail_at_entry(group, entry, problem, error)
      type(group_t), intent(in) :: group
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: key
      integer :: at

      key = shown(entry%key)
      associate (keys => keys_of(group%name))
         at = find_key(keys, entry%key)
         if (at > 0) key = trim(keys(at)%key)
      end associate
      call fail(error, err_input, '&'//group%name//': '//key//' = '//shown_values(entry) &
         //' (line '//integer_to_text(entry%line)//'): '//problem)
   end subroutine fail_at_entry

   !> The values of an entry as they may stand in a message.
   pure function shown_values(entry) result(text)
      type(entry_t), intent(in) :: entry
      character(:), allocatable :: text
      integer, parameter :: most = 8
      integer :: i

      text = ''
      do i = 1, min(size(entry%values), most)
         if (i > 1) text = text//', '
         if (entry%is_quoted) then
            text = text//"'"//shown(entry%values(i)%text)//"'"
         else
            text = text//shown(entry%values(i)%text)
         end if
      end do
      if (size(entry%values) > most) text = text//', ...'
   end function shown_values

   !> Report a group: `&frame (line 5): ...`.
   subroutine fail_at_group(group, problem, error)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error

      call fail(error, err_input, '&'//shown(group%name)//' (line ' &
         //integer_to_text(group%line)//'): '//problem)
   end subroutine fail_at_group

end module rwmf_input_schema_check
