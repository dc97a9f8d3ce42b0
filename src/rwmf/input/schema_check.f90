!> Check of namelist text against the schema: known groups and keys, once each, with allowed values.
!> The result is the values by group and key.
module rwmf_input_schema_check
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp
   use rwmf_input_namelist, only: entry_t, group_t
   use rwmf_input_schema, only: names_of
   use rwmf_input_value_check, only: check_value, default_number, requirement, usual_bounds
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: group_place_t, group_values_t, has_group, has_key, &
      key_code, key_place, key_values_t, text_of
   use rwmf_problem_key, only: belongs_to, key_t, takes_list
   use rwmf_problem_rules, only: append_value, check_needs, fail_at_group, fail_at_key, &
      fail_group, fail_key
   use rwmf_text_strings, only: integer_to_text, nearest_name, shown, to_lower
   implicit none
   private

   public :: collect_values, check_groups, check_values, enter_defaults, append, suggest

   character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'

contains

   !> Check each group and collect the values of all keys, given or by default.
   !>
   !> Errors: unknown or repeated group, unknown or repeated key, wrong type, value out of range,
   !> missing required key. The message names group, key, value, line and the allowed values.
   subroutine collect_values(given, groups, keys, values, error)
      type(group_t), intent(in) :: given(:)
      !! groups of the text
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(key_t), intent(in) :: keys(:)
      !! `all_keys`
      type(group_values_t), intent(out) :: values
      type(error_t), allocatable, intent(out) :: error
      integer :: n
      !! number of values so far
      integer :: i

      call make_room(given, names_of(groups), keys, values)
      n = 0
      do i = 1, size(given)
         call enter_group(given(i), values, error)
         if (.not. allocated(error)) call enter_entries(given(i), keys, values, n, error)
         if (allocated(error)) return
      end do
      call enter_defaults(keys, values, n)
   end subroutine collect_values

   !> Check the combination of given groups and keys, independent of their values.
   !>
   !> Errors: a group without the one that it requires, keys that the kind of motion does not have.
   subroutine check_groups(values, groups, error)
      type(group_values_t), intent(in) :: values
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      integer :: j

      if (.not. has_group(values, 'wall') .and. .not. has_group(values, 'frame')) then
         call fail(error, err_input, '&wall, &frame: at least one of these groups must be given')
         return
      end if
      do i = 1, size(groups)
         do j = 1, count(groups(i)%needs /= '')
            call check_needs(values, trim(groups(i)%name), trim(groups(i)%needs(j)), &
               trim(groups(i)%reasons(j)), error)
            if (allocated(error)) return
         end do
         if (groups(i)%not_on_base == '' .or. .not. (has_group(values, 'base') &
             .and. has_group(values, trim(groups(i)%name)))) cycle
         call fail_group(values, trim(groups(i)%name), 'must not be given with &base (' &
            //trim(groups(i)%not_on_base)//')', error)
         return
      end do
      do i = 1, size(groups)
         if (.not. must_be_checked(values, groups(i))) cycle
         call check_kinds(values, groups(i)%keys, error)
         if (allocated(error)) return
      end do
   end subroutine check_groups

   !> Check the rules between the values of a case with a valid combination of groups.
   !>
   !> Errors: keys that exclude each other, missing keys that another key or group requires.
   subroutine check_values(values, groups, error)
      type(group_values_t), intent(in) :: values
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(groups)
         if (.not. must_be_checked(values, groups(i))) cycle
         call groups(i)%check(values, error)
         if (allocated(error)) return
      end do
   end subroutine check_values

   !> True if a group has rules that apply to a case. Rules of groups outside the scene, such as
   !> `&solver`, always apply.
   pure logical function must_be_checked(values, group) result(must)
      type(group_values_t), intent(in) :: values
      type(case_group_t), intent(in) :: group

      must = associated(group%check)
      if (must .and. group%is_of_scene) must = has_group(values, trim(group%name))
   end function must_be_checked

   !> Check that all given keys belong to the kind of motion.
   subroutine check_kinds(values, keys, error)
      type(group_values_t), intent(in) :: values
      type(key_t), intent(in) :: keys(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: kind
      integer :: i

      do i = 1, size(keys)
         if (keys(i)%kinds == '') cycle
         if (.not. has_key(values, keys(i)%group, keys(i)%key)) cycle
         kind = text_of(values, trim(keys(i)%group), 'kind')
         if (belongs_to(keys(i), kind)) cycle
         call fail_key(values, trim(keys(i)%group), trim(keys(i)%key), &
            "must not be given with kind = '"//kind//"'", error)
         return
      end do
   end subroutine check_kinds

   !> Allocate space for all values: the given ones, and one default for each key.
   subroutine make_room(groups, names, keys, values)
      type(group_t), intent(in) :: groups(:)
      character(12), intent(in) :: names(:)
      !! names of all groups
      type(key_t), intent(in) :: keys(:)
      type(group_values_t), intent(inout) :: values
      integer :: n
      integer :: length
      integer :: i, j, k

      n = 0
      length = 0
      do i = 1, size(groups)
         do j = 1, size(groups(i)%entries)
            associate (given => groups(i)%entries(j)%values)
               n = n + size(given)
               length = length + sum([(len(given(k)%text), k=1, size(given))])
            end associate
         end do
      end do
      allocate (values%numbers(n + size(keys)), values%ends(0:n + size(keys)))
      allocate (character(2*length + len(keys%default)*size(keys)) :: values%texts)
      values%ends(0) = 0
      allocate (values%groups(size(names)), values%keys(size(keys)), values%codes(size(keys)))
      values%groups(:) = [(group_place_t(names(i), .false., 0, key_code(names(i), '')), &
         i=1, size(names))]
      do i = 1, size(keys)
         values%keys(i) = key_values_t(keys(i)%group, keys(i)%key, to_lower(keys(i)%key), &
            .false., .false., 0, 0, 0, unit=keys(i)%unit)
         if (keys(i)%usual /= '') values%keys(i)%usual = usual_bounds(keys(i))
         values%codes(i) = key_code(keys(i)%group, keys(i)%key)
      end do
      do i = 1, size(names)
         values%groups(i)%first_key = findloc(keys%group, names(i), dim=1)
         values%groups(i)%last_key = findloc(keys%group, names(i), dim=1, back=.true.)
      end do
   end subroutine make_room

   !> Enter a group; it must be known and given once.
   subroutine enter_group(group, values, error)
      type(group_t), intent(in) :: group
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: known
      integer :: i

      do i = 1, size(values%groups)
         if (values%groups(i)%name /= group%name) cycle
         if (values%groups(i)%is_given) then
            call fail_at_group(group%name, group%line, 'the group is given twice, before in line ' &
               //trim(integer_to_text(values%groups(i)%line)), error)
         end if
         values%groups(i)%is_given = .true.
         values%groups(i)%line = group%line
         return
      end do
      call suggest(group%name, '&', values%groups%name, known)
      call fail_at_group(group%name, group%line, 'unknown group'//known, error)
   end subroutine enter_group

   !> Write the closest known name and the allowed names, for a message about an unknown name.
   pure subroutine suggest(name, sign, names, text)
      character(*), intent(in) :: name
      !! unknown name
      character(*), intent(in) :: sign
      !! prefix of each name: '&' or ''
      character(*), intent(in) :: names(:)
      !! (n) allowed names, padded with blanks
      character(:), allocatable, intent(out) :: text
      !! continuation of 'unknown key' or a similar message
      character(len(names)) :: near
      integer :: i

      near = nearest_name(name, names)
      text = ''
      if (near /= '') text = ', did you mean '//sign//trim(near)//'?'
      text = text//'; allowed:'
      do i = 1, size(names)
         text = text//' '//sign//trim(names(i))
      end do
   end subroutine suggest

   !> Check the keys of a group and keep their values.
   subroutine enter_entries(group, keys, values, n, error)
      type(group_t), intent(in) :: group
      type(key_t), intent(in) :: keys(:)
      type(group_values_t), intent(inout) :: values
      integer, intent(inout) :: n
      type(error_t), allocatable, intent(out) :: error
      integer :: at
      integer :: i
      character(:), allocatable :: known

      do i = 1, size(group%entries)
         at = key_place(values, group%name, group%entries(i)%key)
         if (at == 0) then
            ! report a key that the group does not have
            call suggest(group%entries(i)%key, '', pack(keys%key, keys%group == group%name), known)
            call fail_at_entry(group, group%entries(i), shown(group%entries(i)%key), 'unknown key' &
               //known, error)
         else if (values%keys(at)%is_given) then
            call fail_at_entry(group, group%entries(i), trim(keys(at)%key), &
               'the key is given twice', error)
         else
            call enter_values(group, group%entries(i), keys(at), values, at, n, error)
         end if
         if (allocated(error)) return
      end do
      do i = 1, size(keys)
         if (keys(i)%group /= group%name) cycle
         if (values%keys(i)%is_given .or. .not. keys(i)%is_required) cycle
         ! a dimensional key may replace it
         if (any(values%keys%is_given .and. keys%group == group%name &
                 .and. keys%gives == keys(i)%key .and. .not. keys%scales)) cycle
         call fail_at_group(group%name, group%line, 'the key '//trim(keys(i)%key) &
            //' is missing ('//trim(keys(i)%help)//'): must be '//trim(requirement(keys(i))), error)
         return
      end do
   end subroutine enter_entries

   !> Check number, type and range of the values of a key, and keep them.
   subroutine enter_values(group, entry, key, values, at, n, error)
      type(group_t), intent(in) :: group
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: key
      type(group_values_t), intent(inout) :: values
      integer, intent(in) :: at
      !! index of the key
      integer, intent(inout) :: n
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      real(dp) :: number
      integer :: i

      if (.not. takes_list(key) .and. size(entry%values) > 1) then
         call fail_at_entry(group, entry, trim(key%key), 'must be one value: ' &
            //trim(requirement(key)), error)
         return
      end if
      values%keys(at)%is_given = .true.
      values%keys(at)%is_quoted = entry%is_quoted
      values%keys(at)%line = entry%line
      do i = 1, size(entry%values)
         call check_value(key, entry%values(i)%text, entry%is_quoted, number, problem)
         if (allocated(problem)) then
            call fail_at_entry(group, entry, trim(key%key), problem, error)
            return
         end if
         if (key%type == 'choice') then
            call append(values, at, n, number, to_lower(trim(entry%values(i)%text)))
         else
            call append(values, at, n, number, entry%values(i)%text)
         end if
      end do
   end subroutine enter_values

   !> Report an error of an entry with all its values.
   subroutine fail_at_entry(group, entry, key, problem, error)
      type(group_t), intent(in) :: group
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: key
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: shown_values
      integer :: i

      shown_values = ''
      do i = 1, size(entry%values)
         call append_value(i, entry%is_quoted, entry%values(i)%text, shown_values)
      end do
      call fail_at_key(group%name, key, shown_values, entry%line, problem, error)
   end subroutine fail_at_entry

   !> Enter the values of absent keys: implied by a given key, the default, or the value of the key
   !> that the default names.
   subroutine enter_defaults(keys, values, n)
      type(key_t), intent(in) :: keys(:)
      !! `all_keys`
      type(group_values_t), intent(inout) :: values
      !! values with space for one value of each key
      integer, intent(inout) :: n
      !! number of values so far
      integer :: source
      integer :: i

      do i = 1, size(keys)
         if (values%keys(i)%is_given .or. keys(i)%default == '') cycle
         source = 0
         if (scan(keys(i)%default(1:1), letters) > 0) source = key_place(values, &
            trim(keys(i)%group), trim(keys(i)%default))
         if (source == 0) then
            call append(values, i, n, default_number(keys(i)), &
               trim(default_text(keys, values%keys%is_given, i)))
         else
            values%keys(i)%n = values%keys(source)%n
            values%keys(i)%first = values%keys(source)%first
         end if
      end do
   end subroutine enter_defaults

   !> Text of a default: the choice implied by a given key of the same group, otherwise the default.
   pure function default_text(keys, is_given, at) result(text)
      type(key_t), intent(in) :: keys(:)
      logical, intent(in) :: is_given(:)
      !! (keys)
      integer, intent(in) :: at
      !! index of the absent key
      character(len(keys%default)) :: text
      integer :: equals
      integer :: i

      text = keys(at)%default
      if (keys(at)%type /= 'choice') return
      do i = 1, size(keys)
         if (.not. is_given(i) .or. keys(i)%group /= keys(at)%group) cycle
         equals = index(keys(i)%implies, '=')
         if (equals == 0) cycle
         if (keys(i)%implies(:equals - 1) /= keys(at)%key) cycle
         text = keys(i)%implies(equals + 1:)
         return
      end do
   end function default_text

   !> Append a value to a key.
   pure subroutine append(values, at, n, number, text)
      type(group_values_t), intent(inout) :: values
      !! values with space for it
      integer, intent(in) :: at
      !! index of the key
      integer, intent(inout) :: n
      !! number of values so far
      real(dp), intent(in) :: number
      !! value of a number, 1 or 0 for a logical, 0 for a text [unit of the key]
      character(*), intent(in) :: text
      !! text of the value in the case; '' for a number without text
      integer :: start

      start = values%ends(n)
      n = n + 1
      values%numbers(n) = number
      values%ends(n) = start + len(text)
      values%texts(start + 1:start + len(text)) = text
      if (values%keys(at)%n == 0) values%keys(at)%first = n
      values%keys(at)%n = values%keys(at)%n + 1
   end subroutine append

end module rwmf_input_schema_check
