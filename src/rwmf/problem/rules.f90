!> What the rules between keys and groups have in common: conditions, and errors that name a group
!> or a key with its line and value.
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

   !> A spring must not be so stiff that no method follows its mass.
   !>
   !> A period of 1e-5 s is a thousandth of what any part of a building has; far below, the motion
   !> of the mass is lost in the round-off of its rotation. `problem` is not allocated for others.
   pure subroutine check_period(root_mass, root_stiffness, problem)
      real(wp), intent(in) :: root_mass
      !! square root of the mass, or of its part of a quotient: neither overflows [sqrt(kg)]
      real(wp), intent(in) :: root_stiffness
      !! > 0, square root of the stiffness [sqrt(N/m)]
      character(:), allocatable, intent(out) :: problem
      !! what is wrong, and with which period; not allocated when nothing is
      real(wp), parameter :: shortest = 1.0e-5_wp
      !! [s]

      if (2*pi*root_mass >= shortest*root_stiffness) return
      problem = 'the period 2 pi sqrt(mass/stiffness) is ' &
         //trim(real_to_text(2*pi*root_mass/root_stiffness))//' s, must be >= ' &
         //trim(real_to_text(shortest))//' s: lower the stiffness'
   end subroutine check_period

   !> A group that is given needs another one.
   subroutine check_needs(values, group, other, reason, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: other
      !! name of the group that it needs, without &
      character(*), intent(in) :: reason
      !! why it does, for the message
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` when it is missing

      if (.not. has_group(values, group) .or. has_group(values, other)) return
      call fail_group(values, group, 'must not be given without &'//other//' ('//reason//')', error)
   end subroutine check_needs

   !> Exactly one of two keys must be given.
   subroutine check_one_of(values, group, a, b, condition, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: a
      !! name of one key
      character(*), intent(in) :: b
      !! name of the other key
      character(*), intent(in) :: condition
      !! 'with ...'
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` when both or none are given

      if (has_key(values, group, a) .and. has_key(values, group, b)) then
         call fail_key(values, group, b, 'must not be given beside '//a//': exactly one of both ' &
            //condition, error)
      else if (.not. has_key(values, group, a) .and. .not. has_key(values, group, b)) then
         call fail_group(values, group, 'exactly one of the keys '//a//' and '//b &
            //' must be given '//condition, error)
      end if
   end subroutine check_one_of

   !> Report a group by its name.
   subroutine fail_group(values, group, problem, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: problem
      !! what is wrong with it, as the message goes on
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail_at_group(group, values%groups(group_place(values, group))%line, problem, error)
   end subroutine fail_group

   !> Report a key that is given by its name: `&frame: gamma = -1.0 (line 7): must be ...`. A number
   !> of a changed case has no text: it is shown as it is. What follows from another key is reported
   !> by that key: `&frame: k_s = 1.0e6 (line 8): T_s = 0.2: must be ...`.
   subroutine fail_key(values, group, key, problem, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: problem
      !! what is wrong with it, as the message goes on
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

   !> The values of a key as a message lists them.
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

   !> Append a value to those that a message shows; of many only the first.
   pure subroutine append_value(number, is_quoted, value, text)
      integer, intent(in) :: number
      !! of the value in its key
      logical, intent(in) :: is_quoted
      !! it stands in quotes in the case
      character(*), intent(in) :: value
      !! as it stands in the case, without quotes
      character(:), allocatable, intent(inout) :: text
      !! those before it, with commas between; this one is appended
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
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: shown_values
      !! its values as `append_value` lists them
      integer, intent(in) :: line
      !! number of the line of the key; 0 when it stands in no text
      character(*), intent(in) :: problem
      !! what is wrong with it, as the message goes on
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail(error, err_input, '&'//group//': '//key//' = '//shown_values &
         //trim(line_note(line))//': '//problem)
   end subroutine fail_at_key

   !> Report a group with its line: `&frame (line 5): ...`.
   subroutine fail_at_group(group, line, problem, error)
      character(*), intent(in) :: group
      !! its name, without &
      integer, intent(in) :: line
      !! number of the line where the group begins; 0 when it stands in no text
      character(*), intent(in) :: problem
      !! what is wrong with it, as the message goes on
      type(error_t), allocatable, intent(out) :: error
      !! `err_input`

      call fail(error, err_input, '&'//shown(group)//trim(line_note(line))//': '//problem)
   end subroutine fail_at_group

   !> ` (line 7)`, with blanks behind; blank for line 0.
   pure function line_note(line) result(note)
      integer, intent(in) :: line
      character(28) :: note

      note = ''
      if (line > 0) note = ' (line '//trim(integer_to_text(line))//')'
   end function line_note

end module rwmf_problem_rules
