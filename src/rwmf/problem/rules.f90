!> Helpers for the rules between keys and groups: conditions, and errors that name a group or a key
!> with its line and value.
module rwmf_problem_rules
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_group_values, only: as_given, group_place, group_values_t, has_group, &
      has_key, key_place, key_values_t, value_text
   use rwmf_text_strings, only: integer_to_text, real_to_text, shown
   implicit none
   private

   public :: check_needs, check_one_of, fail_group, fail_key, fail_at_group, fail_at_key
   public :: check_period, append_value

contains

   !> Check that a spring is not too stiff for the integration of its mass.
   !>
   !> The limit, a period of 1e-5 s, is a thousandth of the period of any part of a building. At far
   !> shorter periods, the displacement of the mass is below the round-off of the rotation.
   pure subroutine check_period(root_mass, root_stiffness, problem)
      real(wp), intent(in) :: root_mass
      !! square root of the mass, or of its mass ratio: neither overflows [sqrt(kg)]
      real(wp), intent(in) :: root_stiffness
      !! > 0, square root of the stiffness [sqrt(N/m)]
      character(:), allocatable, intent(out) :: problem
      !! description of the error with the period; not allocated if the spring is valid
      real(wp), parameter :: shortest = 1.0e-5_wp
      !! [s]

      if (2*pi*root_mass >= shortest*root_stiffness) return
      problem = 'the period 2 pi sqrt(mass/stiffness) is ' &
         //trim(real_to_text(2*pi*root_mass/root_stiffness))//' s, must be >= ' &
         //trim(real_to_text(shortest))//' s: lower the stiffness'
   end subroutine check_period

   !> Check that a group is given only together with another one.
   subroutine check_needs(values, group, other, reason, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: other
      !! name of the required group, without &
      character(*), intent(in) :: reason
      !! reason for the requirement, for the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if the other group is missing

      if (.not. has_group(values, group) .or. has_group(values, other)) return
      call fail_group(values, group, 'must not be given without &'//other//' ('//reason//')', error)
   end subroutine check_needs

   !> Check that exactly one of two keys is given.
   subroutine check_one_of(values, group, a, b, condition, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: a
      !! name of one key
      character(*), intent(in) :: b
      !! name of the other key
      character(*), intent(in) :: condition
      !! 'with ...'
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if both or none are given

      if (has_key(values, group, a) .and. has_key(values, group, b)) then
         call fail_key(values, group, b, 'must not be given beside '//a//': exactly one of both ' &
            //condition, error)
      else if (.not. has_key(values, group, a) .and. .not. has_key(values, group, b)) then
         call fail_group(values, group, 'exactly one of the keys '//a//' and '//b &
            //' must be given '//condition, error)
      end if
   end subroutine check_one_of

   !> Report an error of a group by its name.
   subroutine fail_group(values, group, problem, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: problem
      !! description of the error, which continues the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail_at_group(group, values%groups(group_place(values, group))%line, problem, error)
   end subroutine fail_group

   !> Report an error of a key by its name: `&frame: gamma = -1.0 (line 7): must be ...`.
   !>
   !> A number of a changed case has no text, so the message shows its value. For a derived value
   !> the message names its source: `&frame: k_s = 1.0e6 (line 8): T_s = 0.2: must be ...`.
   subroutine fail_key(values, group, key, problem, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: problem
      !! description of the error, which continues the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`
      type(key_values_t) :: given
      character(:), allocatable :: shown_values
      character(:), allocatable :: followed

      associate (row => values%keys(key_place(values, group, key)))
         followed = ''
         given = row
         if (row%source > 0) then
            given = as_given(values%keys(row%source))
            call show_values(values, row, shown_values)
            if (given%key /= row%key) followed = trim(row%key)//' = '//shown_values//': '
         end if
      end associate
      call show_values(values, given, shown_values)
      call fail_at_key(group, trim(given%key), shown_values, given%line, followed//problem, error)
   end subroutine fail_key

   !> List the values of a key for a message.
   pure subroutine show_values(values, row, text)
      type(group_values_t), intent(in) :: values
      type(key_values_t), intent(in) :: row
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = ''
      do i = row%first, row%first + row%n - 1
         if (values%ends(i) > values%ends(i - 1)) then
            call append_value(i - row%first + 1, row%is_quoted, value_text(values, i), text)
         else
            call append_value(i - row%first + 1, row%is_quoted, &
               trim(real_to_text(real(values%numbers(i), wp))), text)
         end if
      end do
   end subroutine show_values

   !> Append a value to the list of a message, which shows only the first few.
   pure subroutine append_value(number, is_quoted, value, text)
      integer, intent(in) :: number
      !! index of the value in its key
      logical, intent(in) :: is_quoted
      !! the value is quoted in the case
      character(*), intent(in) :: value
      !! text of the value in the case, without quotes
      character(:), allocatable, intent(inout) :: text
      !! earlier values, separated by commas; this one is appended
      integer, parameter :: most = 8

      if (number == most + 1) text = text//', ...'
      if (number > most) return
      if (number > 1) text = text//', '
      if (is_quoted) then
         text = text//"'"//shown(value)//"'"
      else
         text = text//shown(value)
      end if
   end subroutine append_value

   !> Report a key with its values: `&frame: gamma = -1.0 (line 7): must be ...`.
   subroutine fail_at_key(group, key, shown_values, line, problem, error)
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: shown_values
      !! its values as `append_value` lists them
      integer, intent(in) :: line
      !! line number of the key; 0 if it has none
      character(*), intent(in) :: problem
      !! description of the error, which continues the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail(error, err_input, '&'//group//': '//key//' = '//shown_values &
         //trim(line_note(line))//': '//problem)
   end subroutine fail_at_key

   !> Report a group with its line: `&frame (line 5): ...`.
   subroutine fail_at_group(group, line, problem, error)
      character(*), intent(in) :: group
      !! name of the group, without &
      integer, intent(in) :: line
      !! line number of the beginning of the group; 0 if it has none
      character(*), intent(in) :: problem
      !! description of the error, which continues the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail(error, err_input, '&'//shown(group)//trim(line_note(line))//': '//problem)
   end subroutine fail_at_group

   !> Note ` (line 7)`, padded with blanks; blank for line 0.
   pure function line_note(line) result(note)
      integer, intent(in) :: line
      character(28) :: note

      note = ''
      if (line > 0) note = ' (line '//trim(integer_to_text(line))//')'
   end function line_note

end module rwmf_problem_rules
