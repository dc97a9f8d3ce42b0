!> Cases with other numbers, derived from a valid case. Neither text nor records are read again, and
!> all rules of the reader apply.
!>
!> `find_changes` looks up the changed keys once; `change_case` then takes microseconds. The result
!> is the case that the reader would return for a text with those numbers. It lacks the text and the
!> samples of records, which stay in the original case (`motion_from_case` takes both).
module rwmf_input_change
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_reader, only: end_with_records, fill_case
   use rwmf_input_schema, only: all_groups, find_key, keys_of
   use rwmf_input_schema_check, only: append, check_groups, check_values, &
      enter_defaults, suggest
   use rwmf_input_unit_conversion, only: check_units, convert_units
   use rwmf_input_value_check, only: check_number, requirement
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: applies, as_given, group_place, group_values_t, &
      key_values_t, value_text
   use rwmf_problem_key, only: key_t, takes_list
   use rwmf_problem_record, only: record_source_t, record_t, set_factor, sets_motion
   use rwmf_problem_rules, only: fail_key
   use rwmf_text_strings, only: shown, to_lower
   implicit none
   private

   public :: changes_t, find_changes, change_case, is_motion_changed

   !> Keys to be changed, after look-up.
   type :: changes_t
      private
      type(case_group_t), allocatable :: groups(:)
      type(group_values_t) :: values
      !! values of the case, with space for each changed number
      type(key_t), allocatable :: keys(:)
      !! (names)
      integer, allocatable :: first(:)
      !! (names) index of the first number among all values
      integer, allocatable :: n(:)
      !! (names) number of values
   end type changes_t

contains

   !> Look up the keys to be changed.
   !>
   !> Errors: a name that is not `group.key`, an unknown group or key, a repeated name, or a group
   !> that the case lacks. Keys without numbers and keys that control the reading of files cannot
   !> change. Required keys cannot be removed.
   subroutine find_changes(case, names, changes, error, n_values)
      type(case_t), intent(in) :: case
      !! case that was read or changed
      character(*), intent(in) :: names(:)
      !! (n) 'group.key', padded with blanks; the key must hold numbers (a logical is 0 or 1)
      type(changes_t), intent(out) :: changes
      type(error_t), allocatable, intent(out) :: error
      integer, intent(in), optional :: n_values(:)
      !! (n) number of values of each key: one, any number for a list, or none, which removes the
      !! key; absent: one for each key
      type(key_t), allocatable :: keys(:)
      integer :: places(size(names))
      integer :: i

      changes%groups = all_groups()
      keys = keys_of(changes%groups)
      do i = 1, size(names)
         call find_place(case%values, keys, trim(names(i)), places(i), error)
         if (allocated(error)) return
         if (.not. any(places(:i - 1) == places(i))) cycle
         call fail(error, err_input, trim(names(i))//': the key is given twice')
         return
      end do
      changes%keys = keys(places)
      allocate (changes%n(size(names)), source=1)
      if (present(n_values)) changes%n(:) = n_values
      do i = 1, size(names)
         call check_size(changes%keys(i), changes%n(i), error)
         if (allocated(error)) return
      end do
      call lay_out(case%values, keys, places, changes)
      call check_groups(changes%values, changes%groups, error)
      if (.not. allocated(error)) call check_units(changes%values, keys, error)
   end subroutine find_changes

   !> Find the index of a key by its name `group.key`.
   subroutine find_place(values, keys, name, place, error)
      type(group_values_t), intent(in) :: values
      type(key_t), intent(in) :: keys(:)
      character(*), intent(in) :: name
      integer, intent(out) :: place
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: group
      character(:), allocatable :: known
      integer :: dot, at

      place = 0
      dot = index(name, '.')
      group = to_lower(name(:dot - 1))
      at = group_place(values, group)
      if (dot == 0) then
         call fail(error, err_input, shown(name)//': must be group.key, for example frame.T_s')
         return
      else if (at == 0) then
         call suggest(group, '', values%groups%name, known)
         call fail(error, err_input, shown(name)//': unknown group'//known)
         return
      end if
      place = find_key(keys, group, name(dot + 1:))
      if (place == 0) then
         call suggest(name(dot + 1:), '', pack(keys%key, keys%group == group), known)
         call fail(error, err_input, shown(name)//': unknown key'//known)
      else if (keys(place)%is_fixed_by /= '') then
         call fail(error, err_input, name//': must be given where the case is made, because ' &
            //trim(keys(place)%is_fixed_by))
      else if (.not. (applies(values, group) .or. is_of_method(group))) then
         call fail(error, err_input, name//': the case has no group &'//group)
      end if
   end subroutine find_place

   !> True for groups that every case may have and that have no required key.
   pure logical function is_of_method(group)
      character(*), intent(in) :: group

      is_of_method = any(group == [character(8) :: 'output', 'spectrum'])
   end function is_of_method

   !> Check the number of values: one, or several for a list; none for keys without numbers.
   subroutine check_size(key, n, error)
      type(key_t), intent(in) :: key
      integer, intent(in) :: n
      type(error_t), allocatable, intent(out) :: error

      select case (key%type)
      case ('choice', 'text', 'text list')
         if (n == 0 .and. .not. key%is_required) return
         call fail(error, err_input, trim(key%group)//'.'//trim(key%key) &
            //': must be a key that holds numbers')
         return
      case default
         continue
      end select
      if (n == 1 .or. (n > 1 .and. takes_list(key))) return
      if (n == 0 .and. .not. key%is_required) return
      call fail(error, err_input, '&'//trim(key%group)//': '//trim(key%key)//': must be ' &
         //trim(requirement(key)))
   end subroutine check_size

   !> Arrange the values of the case with space for the changed numbers, and enter the defaults.
   subroutine lay_out(old, keys, places, changes)
      type(group_values_t), intent(in) :: old
      type(key_t), intent(in) :: keys(:)
      integer, intent(in) :: places(:)
      !! (names)
      type(changes_t), intent(inout) :: changes
      integer :: order(size(keys))
      !! index of the name of each key, 0 for none
      integer :: length
      !! length of all texts
      type(key_values_t) :: given
      integer :: n
      integer :: i, k

      n = count_values(old) + sum(changes%n) + size(keys)
      length = old%ends(count_values(old)) + len(keys%default)*size(keys)
      order = 0
      order(places) = [(i, i=1, size(places))]
      allocate (changes%first(size(places)), source=0)
      associate (values => changes%values)
         values%groups = old%groups
         values%keys = as_given(old%keys)
         values%codes = old%codes
         allocate (values%numbers(n), values%ends(0:n))
         allocate (character(length) :: values%texts)
         values%ends(0) = 0
         n = 0
         do i = 1, size(keys)
            given = values%keys(i)
            values%keys(i)%n = 0
            values%keys(i)%first = 0
            if (order(i) > 0) then
               changes%first(order(i)) = n + 1
               values%groups(group_place(old, trim(keys(i)%group)))%is_given = .true.
               values%keys(i)%is_given = changes%n(order(i)) > 0
               values%keys(i)%is_quoted = .false.
               values%keys(i)%line = 0
               do k = 1, changes%n(order(i))
                  call append(values, i, n, 0.0_dp, '')
               end do
            else if (given%is_given) then
               do k = given%first, given%first + given%n - 1
                  call append(values, i, n, old%numbers(k), value_text(old, k))
               end do
            end if
         end do
         call enter_defaults(keys, values, n)
      end associate
   end subroutine lay_out

   !> Number of values in use; the arrays may be larger.
   pure integer function count_values(values)
      type(group_values_t), intent(in) :: values

      count_values = maxval(values%keys%first + values%keys%n) - 1
   end function count_values

   !> Make the case with other numbers.
   !>
   !> Errors: a number that its key does not allow, and violated rules between keys and groups, with
   !> the messages of the reader.
   subroutine change_case(case, changes, numbers, changed, error)
      type(case_t), intent(in) :: case
      !! case of `find_changes`; its records need no samples
      type(changes_t), intent(in) :: changes
      real(dp), intent(in) :: numbers(:)
      !! one per name, for lists all their values in sequence [unit of each key]
      type(case_t), intent(out) :: changed
      !! without text and samples
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      integer :: n
      integer :: i

      changed%values = changes%values
      n = 0
      do i = 1, size(changes%keys)
         changed%values%numbers(changes%first(i):changes%first(i) + changes%n(i) - 1) = &
            numbers(n + 1:n + changes%n(i))
         call check_numbers(changes%keys(i), numbers(n + 1:n + changes%n(i)), problem)
         if (allocated(problem)) then
            call fail_key(changed%values, trim(changes%keys(i)%group), &
               trim(changes%keys(i)%key), problem, error)
            return
         end if
         n = n + changes%n(i)
      end do
      call convert_units(changed%values, changes%groups, error)
      if (.not. allocated(error)) call check_values(changed%values, changes%groups, error)
      if (.not. allocated(error)) call fill_case(changed, changes%groups, error)
      ! copy the records without their samples, and update their factors
      if (.not. allocated(error)) then
         if (allocated(case%record)) call keep_record(case%motion%path, case%record, &
            changed%model%g, changed%motion, changed%record, error)
         if (allocated(error)) return
         if (allocated(case%upward_record)) call keep_record(case%upward%path, case%upward_record, &
            changed%model%g, changed%upward, changed%upward_record, error)
         if (.not. allocated(error)) call end_with_records(changed, error)
      end if
   end subroutine change_case

   !> Check the numbers of a key. Allowed values form an interval, so the extremes suffice.
   pure subroutine check_numbers(key, numbers, problem)
      type(key_t), intent(in) :: key
      real(dp), intent(in) :: numbers(:)
      character(:), allocatable, intent(out) :: problem

      if (size(numbers) == 0) return
      call check_number(key, minval(numbers), problem)
      if (.not. allocated(problem)) call check_number(key, maxval(numbers), problem)
      if (allocated(problem)) return
      ! minval and maxval ignore NaN, the sum does not
      if (.not. all(ieee_is_finite(numbers))) call check_number(key, sum(numbers), problem)
   end subroutine check_numbers

   !> True if a changed key affects the ground motion.
   pure logical function is_motion_changed(changes)
      type(changes_t), intent(in) :: changes

      is_motion_changed = any(sets_motion(changes%keys%group) &
         .or. (changes%keys%group == 'model' .and. changes%keys%key == 'g'))
   end function is_motion_changed

   subroutine keep_record(path, record, g, source, kept, error)
      character(*), intent(in) :: path
      type(record_t), intent(in) :: record
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      class(record_source_t), intent(inout) :: source
      type(record_t), allocatable, intent(out) :: kept
      type(error_t), allocatable, intent(out) :: error

      source%path = path
      allocate (kept)
      kept%n = record%n
      if (allocated(record%dt)) kept%dt = record%dt
      kept%t_last = record%t_last
      kept%largest = record%largest
      kept%t_peak = record%t_peak
      kept%format = record%format
      kept%unit = record%unit
      kept%crc32 = record%crc32
      call set_factor(kept, source%scale, g, error)
   end subroutine keep_record

end module rwmf_input_change
