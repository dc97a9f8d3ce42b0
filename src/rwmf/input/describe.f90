!> A validated case as a table: what it says and what the defaults add.
module rwmf_input_describe
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_group_values, only: has_group, has_key, text_of, values_for
   use rwmf_input_namelist, only: group_t, parse_namelist
   use rwmf_input_schema, only: all_keys, belongs_to, key_t
   use rwmf_input_value_check, only: parse_bound, parse_logical
   use rwmf_problem_case, only: case_t
   use rwmf_text_strings, only: integer_to_text, parse_integer, real_to_text, string_t
   implicit none
   private

   public :: describe_case

   character(*), parameter :: tab = achar(9)

contains

   !> One line for every key that has a value, in the order of the schema: `group.key`, type, value,
   !> unit, and `given` or `default`, separated by tabs.
   !>
   !> Groups that are absent have no lines, but `&model` and `&solver` always have. Reals are
   !> written with the digits that give the same double precision number again, lists with
   !> commas. It is the case as it was read: changes of its components do not show.
   function describe_case(case) result(text)
      type(case_t), intent(in) :: case
      character(:), allocatable :: text
      type(error_t), allocatable :: error
      type(group_t), allocatable :: groups(:)
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: value
      integer :: i

      text = ''
      if (.not. allocated(case%text)) return
      call parse_namelist(case%text, groups, error)
      if (allocated(error)) return
      keys = all_keys()
      do i = 1, size(keys)
         if (.not. is_in_scene(groups, keys(i))) cycle
         value = value_text(groups, case, keys(i))
         if (value == '') cycle
         text = text//trim(keys(i)%group)//'.'//trim(keys(i)%key)//tab//trim(keys(i)%type)//tab &
            //value//tab//trim(keys(i)%unit)//tab//origin(groups, keys(i))//new_line('a')
      end do
   end function describe_case

   !> Does the key apply to the case?
   pure logical function is_in_scene(groups, key)
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: key

      is_in_scene = has_group(groups, trim(key%group)) &
         .or. key%group == 'model' .or. key%group == 'solver'
      if (.not. is_in_scene) return
      select case (key%group)
      case ('motion')
         is_in_scene = belongs_to(key, text_of(groups, 'motion', 'kind'))
      case ('vertical')
         is_in_scene = key%key /= 'scale' .or. has_key(groups, 'vertical', 'file')
      case ('solver')
         ! the tolerance is then found by the run
         is_in_scene = key%key /= 'rtol' .or. .not. has_key(groups, 'solver', 'accuracy')
      case ('spectrum')
         is_in_scene = key%key /= 'spacing' .or. .not. has_key(groups, 'spectrum', 'T_s')
      case default
         is_in_scene = .true.
      end select
   end function is_in_scene

   !> Where the value comes from.
   pure function origin(groups, key) result(text)
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: key
      character(:), allocatable :: text

      text = 'default'
      if (has_key(groups, trim(key%group), trim(key%key))) text = 'given'
   end function origin

   !> The value of a key, '' when it has none.
   pure function value_text(groups, case, key) result(text)
      type(group_t), intent(in) :: groups(:)
      type(case_t), intent(in) :: case
      type(key_t), intent(in) :: key
      character(:), allocatable :: text
      type(string_t), allocatable :: values(:)
      integer :: i

      values = values_for(groups, key)
      text = ''
      do i = 1, size(values)
         if (i > 1) text = text//', '
         text = text//canonical(trim(key%type), values(i)%text)
      end do
      ! the one default that only the validated case knows: the last sample of the record
      if (key%key == 't_end' .and. text == '') text = real_to_text(case%solver%t_end)
   end function value_text

   !> A value in the form in which equal values are equal texts.
   pure function canonical(type, value) result(text)
      character(*), intent(in) :: type
      character(*), intent(in) :: value
      !! as it stands in the case
      character(:), allocatable :: text
      integer :: number
      logical :: ok
      logical :: truth

      select case (type)
      case ('real', 'real list')
         text = real_to_text(real(parse_bound(value), wp))
      case ('integer')
         call parse_integer(value, number, ok)
         text = integer_to_text(number)
      case ('logical')
         call parse_logical(value, truth, ok)
         text = trim(merge('.true. ', '.false.', truth))
      case default
         text = value
      end select
   end function canonical

end module rwmf_input_describe
