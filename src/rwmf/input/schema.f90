!> Schema of a case file: the table of all groups and keys, with the basic groups and the effects of
!> `rwmf_model_effects_list`.
!>
!> Validation, messages, the namelist reference and the type hints of the Python package use it.
module rwmf_input_schema
   use rwmf_input_groups_analysis, only: model_group, output_group, solver_group
   use rwmf_input_groups_base_section, only: base_section_group
   use rwmf_input_groups_design, only: design_group
   use rwmf_input_groups_excitation, only: motion_group
   use rwmf_input_groups_limits, only: limits_group
   use rwmf_input_groups_sensitivity, only: sensitivity_group
   use rwmf_input_groups_spectrum, only: spectrum_group
   use rwmf_input_groups_structure, only: cable_group, frame_group, impact_group, initial_group, &
      wall_group
   use rwmf_model_effects_list, only: all_effects
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_key, only: key_t
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: all_groups, all_keys, keys_of, names_of, find_key, write_schema, write_groups

contains

   !> All groups, each effect after its basic group; cases are read, documented and reported in this
   !> order.
   function all_groups() result(groups)
      type(case_group_t), allocatable :: groups(:)
      type(case_group_t), allocatable :: basic(:)
      type(case_group_t), allocatable :: effects(:)
      integer :: n
      integer :: i
      integer :: j

      ! assigned one by one: gfortran 12 loses the keys of elements of an array constructor
      allocate (basic(14))
      basic(1) = wall_group()
      basic(2) = frame_group()
      basic(3) = cable_group()
      basic(4) = impact_group()
      basic(5) = motion_group()
      basic(6) = initial_group()
      basic(7) = model_group()
      basic(8) = solver_group()
      basic(9) = output_group()
      basic(10) = base_section_group()
      basic(11) = limits_group()
      basic(12) = sensitivity_group()
      basic(13) = design_group()
      basic(14) = spectrum_group()
      effects = all_effects()
      allocate (groups(size(basic) + size(effects)))
      n = 0
      do i = 1, size(basic)
         n = n + 1
         groups(n) = basic(i)
         do j = 1, size(effects)
            if (effects(j)%after /= basic(i)%name) cycle
            n = n + 1
            groups(n) = effects(j)
         end do
      end do
   end function all_groups

   !> All keys in the order of the documentation.
   function all_keys() result(keys)
      type(key_t), allocatable :: keys(:)

      keys = keys_of(all_groups())
   end function all_keys

   !> Keys of all groups, one group after the other.
   pure function keys_of(groups) result(keys)
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      type(key_t), allocatable :: keys(:)
      integer :: i
      integer :: n

      allocate (keys(sum([(size(groups(i)%keys), i=1, size(groups))])))
      n = 0
      do i = 1, size(groups)
         keys(n + 1:n + size(groups(i)%keys)) = groups(i)%keys
         n = n + size(groups(i)%keys)
      end do
   end function keys_of

   !> Names of groups, once each; an effect may add its keys to a group that exists.
   pure function names_of(groups) result(names)
      type(case_group_t), intent(in) :: groups(:)
      !! `all_groups`
      character(12), allocatable :: names(:)
      integer :: i

      names = pack(groups%name, [(.not. any(groups(:i - 1)%name == groups(i)%name), &
         i=1, size(groups))])
   end function names_of

   !> Index of a key of a group; 0 if there is none of that name.
   pure integer function find_key(keys, group, name)
      type(key_t), intent(in) :: keys(:)
      character(*), intent(in) :: group
      !! name of the group, in lower case
      character(*), intent(in) :: name
      !! name of the key, in upper or lower case

      do find_key = size(keys), 1, -1
         if (keys(find_key)%group /= group) cycle
         if (to_lower(trim(keys(find_key)%key)) == to_lower(name)) exit
      end do
   end function find_key

   !> Write the table of keys as text, one tab-separated line per key.
   !>
   !> The columns are group, key, type, unit, default, allowed values, help, range in real
   !> buildings, and the key that this one replaces. The default is 'required' for required keys and
   !> 'none' for keys without one.
   subroutine write_schema(text)
      character(:), allocatable, intent(out) :: text
      !! the lines, each with its line feed
      character(*), parameter :: tab = achar(9)
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: line
      integer :: i
      integer :: n

      keys = all_keys()
      where (keys%default == '')
         keys%default = merge('required        ', 'none            ', keys%is_required)
      end where
      where (keys%scales) keys%gives = ''
      ! allocated at full length: appending line by line would copy the text each time
      allocate (character(sum(len_trim(keys%group) + len_trim(keys%key) + len_trim(keys%type) &
         + len_trim(keys%unit) + len_trim(keys%default) + len_trim(keys%allowed) &
         + len_trim(keys%help) + len_trim(keys%usual) + len_trim(keys%gives) + 9)) :: text)
      n = 0
      do i = 1, size(keys)
         associate (key => keys(i))
            line = trim(key%group)//tab//trim(key%key)//tab//trim(key%type)//tab &
               //trim(key%unit)//tab//trim(key%default)//tab//trim(key%allowed)//tab &
               //trim(key%help)//tab//trim(key%usual)//tab//trim(key%gives)//new_line('a')
         end associate
         text(n + 1:n + len(line)) = line
         n = n + len(line)
      end do
   end subroutine write_schema

   !> Write the groups as text: each line has the name of a group and of the groups that it
   !> requires, separated by tabs.
   subroutine write_groups(text)
      character(:), allocatable, intent(out) :: text
      !! the lines, each with its line feed
      type(case_group_t), allocatable :: groups(:)
      integer :: i
      integer :: j

      groups = all_groups()
      text = ''
      do i = 1, size(groups)
         text = text//trim(groups(i)%name)
         do j = 1, count(groups(i)%needs /= '')
            text = text//achar(9)//trim(groups(i)%needs(j))
         end do
         text = text//new_line('a')
      end do
   end subroutine write_groups

end module rwmf_input_schema
