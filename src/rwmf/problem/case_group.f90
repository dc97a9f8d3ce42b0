!> One group of a case file, or the keys that an effect adds to one: what it is asked for by all
!> that read, check, describe and list cases.
!>
!> The basic groups are in `input/groups`, those of the effects in `model/effects`, one file each.
module rwmf_problem_case_group
   use rwmf_core_error, only: error_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: group_values_t
   use rwmf_problem_key, only: key_t
   implicit none
   private

   public :: case_group_t, name_length

   integer, parameter :: name_length = 24
   !! of states and events

   !> A group. What is not associated does not apply.
   type :: case_group_t
      character(12) :: name = ''
      !! of the group, in small letters
      character(12) :: after = 'frame'
      !! of an effect: the basic group that its keys follow in the documentation
      logical :: is_of_scene = .true.
      !! says what is simulated, not how or what is reported
      character(12) :: needs(2) = ''
      !! groups without which it must not be given
      character(40) :: reasons(2) = ''
      !! why
      type(key_t), allocatable :: keys(:)
      !! in the order of the documentation
      procedure(check_i), pointer, nopass :: check => null()
      !! rules between keys and groups, beyond what each key allows by itself
      procedure(derive_i), pointer, nopass :: derive => null()
      !! values that follow from dimensional keys, beyond quotients by mass or weight of the wall
      procedure(fill_i), pointer, nopass :: fill => null()
      procedure(is_present_i), pointer, nopass :: is_present => null()
      !! whether a case calls for it
      procedure(add_names_i), pointer, nopass :: add_states => null()
      !! names of the states that it brings
      procedure(add_names_i), pointer, nopass :: add_events => null()
      !! names of the events that it brings
      procedure(refusal_i), pointer, nopass :: refuse_element => null()
      !! why an element of a host cannot have it
   end type case_group_t

   abstract interface
      !> Check the values of a case whose keys are each allowed. Asked only where a key of the
      !> group is given, or the group itself. The error names group, key and what is allowed.
      subroutine check_i(values, error)
         import :: error_t, group_values_t
         implicit none
         type(group_values_t), intent(in) :: values
         type(error_t), allocatable, intent(out) :: error
      end subroutine check_i

      !> Set the keys of the group that follow from others; the groups before this one are done. The
      !> error names group, key and what is allowed.
      subroutine derive_i(values, error)
         import :: error_t, group_values_t
         implicit none
         type(group_values_t), intent(inout) :: values
         type(error_t), allocatable, intent(out) :: error
      end subroutine derive_i

      !> Put what its values say into the case; the groups before this one are there already.
      subroutine fill_i(case, error)
         import :: case_t, error_t
         implicit none
         type(case_t), intent(inout) :: case
         type(error_t), allocatable, intent(out) :: error
      end subroutine fill_i

      !> Does the case call for it?
      pure logical function is_present_i(case)
         import :: case_t
         implicit none
         type(case_t), intent(in) :: case
      end function is_present_i

      !> Append names to a list.
      pure subroutine add_names_i(case, names)
         import :: case_t, name_length
         implicit none
         type(case_t), intent(in) :: case
         !! in which it is present
         character(name_length), allocatable, intent(inout) :: names(:)
      end subroutine add_names_i

      !> Fail with `err_input` when the case has what an element cannot have.
      subroutine refusal_i(case, error)
         import :: case_t, error_t
         implicit none
         type(case_t), intent(in) :: case
         !! in which it is present
         type(error_t), allocatable, intent(out) :: error
      end subroutine refusal_i
   end interface

end module rwmf_problem_case_group
