!> Conversion of dimensional keys: masses in kg, stiffnesses in N/m and forces in N become ratios
!> before the rules are checked.
!>
!> The table of keys maps each dimensional key to its ratio (`key_t`); a group's `derive` handles
!> anything other than a division (`case_group_t`).
module rwmf_input_unit_conversion
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_value_check, only: check_number
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: derive, get_list, group_values_t, has_group, has_key
   use rwmf_problem_key, only: key_t
   use rwmf_problem_rules, only: fail_key
   use rwmf_problem_units, only: unit_of
   use rwmf_text_strings, only: next_word
   implicit none
   private

   public :: check_units, convert_units

contains

   !> Check that the dimensional keys are consistent and complete, independent of their values.
   !>
   !> Errors: a dimensional key together with the key derived from it, without the keys that it
   !> requires, or for a wall without a mass.
   subroutine check_units(values, keys, error)
      type(group_values_t), intent(inout) :: values
      !! values as given; on return `has_units` marks a case with dimensional keys
      type(key_t), intent(in) :: keys(:)
      !! `all_keys`
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      values%has_units = .false.
      do i = 1, size(keys)
         if (.not. values%keys(i)%is_given) cycle
         if (keys(i)%needs /= '') call check_required_keys(values, keys(i), error)
         if (allocated(error)) return
         if (keys(i)%gives == '') cycle
         values%has_units = .true.
         if (keys(i)%scales) cycle
         if (has_key(values, trim(keys(i)%group), trim(keys(i)%gives))) then
            call fail_key(values, trim(keys(i)%group), trim(keys(i)%key), &
               'must not be given beside '//trim(keys(i)%gives)//', which follows from it', error)
         else if (keys(i)%group /= 'wall' .and. has_group(values, 'wall') .and. .not. &
                  (has_key(values, 'wall', 'm_w') .or. has_key(values, 'wall', 'density'))) then
            call fail_key(values, trim(keys(i)%group), trim(keys(i)%key), 'needs the mass of the ' &
               //'wall: m_w, or density and thickness, of &wall must be given', error)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_units

   !> Check that the other keys that a key requires are given.
   subroutine check_required_keys(values, key, error)
      type(group_values_t), intent(in) :: values
      type(key_t), intent(in) :: key
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: names
      integer :: position, first, last
      integer :: bar
      !! position of the '|' between two alternatives

      position = 1
      do
         call next_word(key%needs, position, first, last)
         if (last < first) return
         bar = first + index(key%needs(first:last)//'|', '|') - 1
         if (has_key(values, trim(key%group), key%needs(first:bar - 1))) cycle
         names = key%needs(first:bar - 1)
         if (bar < last) then
            if (has_key(values, trim(key%group), key%needs(bar + 1:last))) cycle
            names = names//' or '//key%needs(bar + 1:last)
         end if
         call fail_key(values, trim(key%group), trim(key%key), 'must not be given without ' &
            //names, error)
         return
      end do
   end subroutine check_required_keys

   !> Set the keys that are derived from dimensional ones, group by group.
   !>
   !> Errors: derived values that are not allowed, and those of the groups.
   subroutine convert_units(values, groups, error)
      type(group_values_t), intent(inout) :: values
      !! values as given, after `check_units`
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      integer :: behind
      !! index of the last key of the groups before

      if (.not. values%has_units) return
      behind = 0
      do i = 1, size(groups)
         if (has_group(values, trim(groups(i)%name))) then
            call divide(values, groups(i)%keys)
            if (associated(groups(i)%derive)) call groups(i)%derive(values, error)
            if (.not. allocated(error)) call check_derived(values, groups(i)%keys, behind, error)
            if (allocated(error)) return
         end if
         behind = behind + size(groups(i)%keys)
      end do
   end subroutine convert_units

   !> Divide by mass or weight. The reference of a frame without a wall is its own mass: no
   !> division.
   subroutine divide(values, keys)
      type(group_values_t), intent(inout) :: values
      type(key_t), intent(in) :: keys(:)
      !! keys of one group
      real(wp), allocatable :: numbers(:)
      integer :: i
      integer :: to
      !! index of the derived key in the group

      do i = 1, size(keys)
         if (keys(i)%gives == '') cycle
         to = findloc(keys%key == keys(i)%gives, .true., dim=1)
         if (to == 0 .or. .not. has_key(values, trim(keys(i)%group), trim(keys(i)%key))) cycle
         if (keys(to)%si == '' .or. keys(to)%si /= keys(i)%unit) cycle
         if (keys(i)%group == 'frame' .and. .not. has_group(values, 'wall')) cycle
         call get_list(values, trim(keys(i)%group), trim(keys(i)%key), numbers)
         call derive(values, trim(keys(i)%group), trim(keys(i)%gives), trim(keys(i)%key), &
            numbers/unit_of(values, keys(to)%si))
      end do
   end subroutine divide

   !> Check that derived values are in the range of their keys: finite, and without underflow.
   subroutine check_derived(values, keys, behind, error)
      type(group_values_t), intent(in) :: values
      type(key_t), intent(in) :: keys(:)
      !! keys of one group
      integer, intent(in) :: behind
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      integer :: i, j

      do i = 1, size(keys)
         associate (row => values%keys(behind + i))
            if (row%source == 0) cycle
            do j = row%first, row%first + row%n - 1
               call check_number(keys(i), values%numbers(j), problem)
               if (.not. allocated(problem)) cycle
               call fail_key(values, trim(keys(i)%group), trim(keys(i)%key), problem, error)
               return
            end do
         end associate
      end do
   end subroutine check_derived

end module rwmf_input_unit_conversion
