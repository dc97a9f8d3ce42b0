!> Interface of one group of a case file, or of the keys that an effect adds to one.
!>
!> Reading, checking, describing and listing of cases use this interface. The basic groups are in
!> `input/groups`, those of the effects in `model/effects`, one file each.
module rwmf_problem_case_group
   use rwmf_core_error, only: error_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: group_values_t
   use rwmf_problem_key, only: key_t
   implicit none
   private

   public :: case_group_t, name_length, two_corners

   integer, parameter :: name_length = 24
   !! length of names of states and events

   character(*), parameter :: two_corners = 'its equations are those of two corners'
   !! reason for `not_on_base`

   !> One group. Null pointers mean that the hook is not used.
   type :: case_group_t
      character(12) :: name = ''
      !! name of the group, in lower case
      character(12) :: after = 'frame'
      !! of an effect: basic group that precedes its keys in the documentation
      logical :: is_of_scene = .true.
      !! the group describes the simulated scene, not its integration or its output
      character(12) :: needs(2) = ''
      !! groups without which this one must not be given
      character(40) :: reasons(2) = ''
      !! reasons for `needs`, for messages
      character(40) :: not_on_base = ''
      !! reason why `&base` excludes the group; '' if it does not
      type(key_t), allocatable :: keys(:)
      !! in the order of the documentation
      procedure(check_i), pointer, nopass :: check => null()
      !! rules between keys and groups, in addition to the allowed values of each key
      procedure(derive_i), pointer, nopass :: derive => null()
      !! values derived from dimensional keys, except quotients by mass or weight of the wall
      procedure(fill_i), pointer, nopass :: fill => null()
      procedure(is_present_i), pointer, nopass :: is_present => null()
      !! true if a case includes the effect
      procedure(add_names_i), pointer, nopass :: add_states => null()
      !! names of the states that the effect adds
      procedure(add_names_i), pointer, nopass :: add_events => null()
      !! names of the events that the effect adds
      character(160) :: no_element = ''
      !! reason why an element of a host cannot include the effect; '' if it can
      procedure(is_present_i), pointer, nopass :: is_beyond_element => null()
      !! true if the reason concerns a case with the effect; null: it concerns all of them
   end type case_group_t

   abstract interface
      !> Check the values of a case in which each key by itself is valid. Called only if the group
      !> or one of its keys is given. The error names group, key and the allowed values.
      subroutine check_i(values, error)
         import :: error_t, group_values_t
         implicit none
         type(group_values_t), intent(in) :: values
         type(error_t), allocatable, intent(out) :: error
      end subroutine check_i

      !> Set the keys of the group that follow from others; the groups before this one are complete.
      !> The error names group, key and the allowed values.
      subroutine derive_i(values, error)
         import :: error_t, group_values_t
         implicit none
         type(group_values_t), intent(inout) :: values
         type(error_t), allocatable, intent(out) :: error
      end subroutine derive_i

      !> Copy the values of the group into the case, which already has those of the groups before.
      subroutine fill_i(case, error)
         import :: case_t, error_t
         implicit none
         type(case_t), intent(inout) :: case
         type(error_t), allocatable, intent(out) :: error
      end subroutine fill_i

      !> True if the case includes the effect.
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
         !! case that includes the effect
         character(name_length), allocatable, intent(inout) :: names(:)
      end subroutine add_names_i
   end interface

end module rwmf_problem_case_group
