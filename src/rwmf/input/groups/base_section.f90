!> Group `&base_section`: the strip of springs under the base, for its contact and its stress.
module rwmf_input_groups_base_section
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t, keep_numbers
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: group_values_t, has_group, has_key, real_of, &
      text_of
   use rwmf_problem_key, only: optional_key, positive, usually
   use rwmf_problem_rules, only: fail_group, fail_key
   implicit none
   private

   public :: base_section_group

   character(*), parameter :: name = 'base_section'
   !! name of the group

contains

   !> Group `&base_section` with its keys and hooks.
   type(case_group_t) function base_section_group() result(group)
      group%name = name
      group%is_of_scene = .false.
      group%needs(1) = 'wall'
      group%not_on_base = 'its numbers are outputs of &base'
      group%reasons(1) = 'the strip lies under its base'
      group%keys = [ &
         usually('[1e7, 1e13]', optional_key(name, 'k', 'real', 'N/m3', '', positive, &
            'subgrade modulus: stress per settlement of the strip, which takes no tension')), &
         usually('[1e8, 1e12]', optional_key(name, 'E', 'real', 'Pa', '', positive, &
            'modulus of elasticity: toe strain = k settlement/E; beside length: k = E/length')), &
         usually('[0.01, 20]', optional_key(name, 'length', 'real', 'm', '', positive, &
            'height of the strip over which it is strained; beside k: E = k length')), &
         usually('[5e6, 2e8]', optional_key(name, 'f_c', 'real', 'Pa', '', positive, &
            'compressive strength: largest stress; a toe stress above 0.6 f_c gives a warning'))]
      group%check => check_base_section
      group%fill => fill_base_section
   end function base_section_group

   !> Check that stiffness and strain are defined once, and that force and rotation have a corner.
   subroutine check_base_section(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      if (.not. has_group(values, name)) return
      n = count([has_key(values, name, 'k'), has_key(values, name, 'E'), &
         has_key(values, name, 'length')])
      if (n == 3) then
         call fail_key(values, name, 'k', 'must not be given beside E and length, which give ' &
            //'k = E/length', error)
      else if (n < 2 .and. .not. has_key(values, name, 'k')) then
         call fail_group(values, name, 'the key k is missing (subgrade modulus): must be a ' &
            //'number > 0 [N/m3], or E [Pa] and length [m] with k = E/length', error)
      else if (.not. has_key(values, 'wall', 'thickness')) then
         call fail_group(values, name, 'must not be given without thickness and density of ' &
            //'&wall (the stress is in the area of the base)', error)
      else if (text_of(values, 'wall', 'base') == 'pinned') then
         call fail_group(values, name, "must not be given with &wall base = 'pinned' (a hinged " &
            //'wall does not rock on its corners)', error)
      end if
   end subroutine check_base_section

   !> Keep stiffness [N/m3], thickness [m] and strength [Pa], and the modulus [Pa] if it is known.
   subroutine fill_base_section(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: k, modulus, strength

      k = real_of(case%values, name, 'k')
      modulus = real_of(case%values, name, 'E')
      if (has_key(case%values, name, 'length')) then
         associate (length => real_of(case%values, name, 'length'))
            if (has_key(case%values, name, 'k')) modulus = k*length
            if (.not. has_key(case%values, name, 'k')) k = modulus/length
         end associate
      end if
      strength = huge(1.0_wp)
      if (has_key(case%values, name, 'f_c')) strength = real_of(case%values, name, 'f_c')
      call keep_numbers(case, name, [k, real_of(case%values, 'wall', 'thickness'), strength])
      if (modulus > 0) call keep_numbers(case, 'toe_strain', [modulus])
   end subroutine fill_base_section

end module rwmf_input_groups_base_section
