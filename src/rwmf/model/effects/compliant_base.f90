!> Base that gives, slides and crushes, `&base`: a strip of springs without tension under the wall.
module rwmf_model_effects_compliant_base
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: base_t, case_t
   use rwmf_problem_case_group, only: case_group_t, two_corners
   use rwmf_problem_group_values, only: derive, get_real, group_values_t, has_group, has_key, &
      integer_of, logical_of, real_of, text_of
   use rwmf_problem_key, only: dimensional, not_negative, optional_key, positive, &
      required, usually
   use rwmf_problem_rules, only: fail_key
   implicit none
   private

   public :: compliant_base_group

   character(*), parameter :: name = 'base'
   !! name of the group

contains

   !> Describe the group `&base`: its keys and the procedures that check and read them.
   type(case_group_t) function compliant_base_group() result(group)
      group%name = name
      group%after = 'wall'
      group%needs(1) = 'wall'
      group%reasons(1) = 'it lies under its base'
      group%keys = [ &
         usually('[1e2, 1e7]', required(name, 'k_t_over_m_w', 'real', '1/m/s2', '[10, 1e7]', &
            'stiffness per length of the base over m_w')), &
         usually('[1e6, 1e13]', dimensional(name, 'k', 'real', 'N/m3', 'k_t_over_m_w', '', &
            'or the subgrade modulus: stress per settlement, with &wall thickness')), &
         usually('[1e7, 1e12]', dimensional(name, 'E', 'real', 'Pa', 'k_t_over_m_w', 'length', &
            'or the modulus of elasticity of the strip: k = E/length')), &
         usually('[0.01, 20]', optional_key(name, 'length', 'real', 'm', '', positive, &
            'height of the strip; beside E')), &
         optional_key(name, 'xi', 'real', '-', '0.0', '[0, 3]', &
            'damping ratio of the bounce in full contact'), &
         optional_key(name, 'delay', 'real', 's', '', not_negative, &
            'or the damping over the stiffness, c/k'), &
         dimensional(name, 'c', 'real', 'N s/m3', 'delay', 'k', &
            'or the damping per area', not_negative), &
         usually('[0.2, 1]', optional_key(name, 'mu', 'real', '-', '', '[0.01, 3]', &
            'coefficient of friction; absent: the base does not slide')), &
         optional_key(name, 'd_y', 'real', 'm', '', positive, &
            'settlement at which the strip crushes; absent: it is elastic'), &
         usually('[1e4, 2e8]', dimensional(name, 'p_y', 'real', 'Pa', 'd_y', 'k|E', &
            'or the stress at which it crushes')), &
         optional_key(name, 'strips', 'integer', '', '20', '[8, 200]', &
            'number of strips that crush one by one; beside d_y or p_y')]
      group%derive => derive_base
      group%check => check_base
      group%fill => fill_base
      group%is_present => has_base
      group%no_element = '&base: its settlement and slip are states, and an element holds no state'
   end function compliant_base_group

   !> Derive stiffness, delay and settlement at crushing from stresses.
   subroutine derive_base(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      character(1) :: source
      real(wp) :: k

      k = modulus_of(values)
      if (.not. k > 0) return
      source = merge('k', 'E', has_key(values, name, 'k'))
      if (.not. has_key(values, 'wall', 'thickness')) then
         call fail_key(values, name, source, 'needs &wall thickness and density: the stress is ' &
            //'in the area of the base', error)
         return
      end if
      call derive(values, name, 'k_t_over_m_w', source, [k*real_of(values, 'wall', 'thickness') &
         /real_of(values, 'wall', 'm_w')])
      if (has_key(values, name, 'c')) call derive(values, name, 'delay', 'c', &
         [real_of(values, name, 'c')/k])
      if (has_key(values, name, 'p_y')) call derive(values, name, 'd_y', 'p_y', &
         [real_of(values, name, 'p_y')/k])
   end subroutine derive_base

   !> Subgrade modulus; 0 if the case gives none [N/m3].
   pure real(wp) function modulus_of(values) result(k)
      type(group_values_t), intent(in) :: values

      k = 0
      if (has_key(values, name, 'k')) then
         k = real_of(values, name, 'k')
      else if (has_key(values, name, 'E') .and. has_key(values, name, 'length')) then
         k = real_of(values, name, 'E')/real_of(values, name, 'length')
      end if
   end function modulus_of

   !> Refuse what the equations of a base that gives exclude.
   subroutine check_base(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(values, name)) return
      call check_keys(values, error)
      if (.not. allocated(error)) call check_scene(values, error)
      if (.not. allocated(error)) call check_tendon(values, error)
   end subroutine check_base

   !> Check keys that exclude or need each other.
   subroutine check_keys(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_key(values, name, 'length') .and. .not. has_key(values, name, 'E')) then
         call fail_key(values, name, 'length', 'must not be given without E', error)
      else if (has_key(values, name, 'delay') .and. has_key(values, name, 'xi')) then
         call fail_key(values, name, 'xi', 'must not be given beside delay or c: exactly one of ' &
            //'them sets the damping', error)
      else if (has_key(values, name, 'mu') .and. has_key(values, name, 'd_y')) then
         call fail_key(values, name, 'mu', 'must not be given with d_y or p_y: a base either ' &
            //'slides or crushes', error)
      else if (has_key(values, name, 'strips') .and. .not. has_key(values, name, 'd_y')) then
         call fail_key(values, name, 'strips', 'must not be given without d_y or p_y: an elastic ' &
            //'strip has closed integrals', error)
      end if
   end subroutine check_keys

   !> Check keys of other groups.
   subroutine check_scene(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: with = ' with &base'
      character(:), allocatable :: method

      method = text_of(values, 'solver', 'method')
      if (text_of(values, 'model', 'formulation') /= 'exact') then
         call fail_key(values, 'model', 'formulation', "must be 'exact'"//with, error)
      else if (text_of(values, 'wall', 'base') /= 'rocking') then
         call fail_key(values, 'wall', 'base', "must not be 'pinned'"//with, error)
      else if (integer_of(values, 'wall', 'walls') /= 1) then
         call fail_key(values, 'wall', 'walls', 'must be 1'//with, error)
      else if (has_key(values, name, 'mu') .and. logical_of(values, 'wall', 'shear_key')) then
         call fail_key(values, 'wall', 'shear_key', 'must not be true with &base mu: a key keeps ' &
            //'the base from sliding', error)
      else if (has_group(values, 'cable') .and. text_of(values, 'cable', 'law') /= 'truss') then
         call fail_key(values, 'cable', 'law', "must be 'truss'"//with//', whose rise the linear ' &
            //'law does not have', error)
      else if (method /= 'auto' .and. method /= 'taylor') then
         call fail_key(values, 'solver', 'method', "must be 'auto' or 'taylor'"//with, error)
      end if
   end subroutine check_scene

   !> Refuse keys of the cable that the equations do not have.
   subroutine check_tendon(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(14), parameter :: keys(*) = [character(14) :: 'offset', 'height', 'eta_y', &
         'rupture_strain']
      integer :: i

      do i = 1, size(keys)
         if (.not. has_key(values, 'cable', trim(keys(i)))) cycle
         call fail_key(values, 'cable', trim(keys(i)), 'must not be given with &base (' &
            //two_corners//')', error)
         return
      end do
   end subroutine check_tendon

   subroutine fill_base(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%compliant_base)
      associate (base => case%compliant_base, values => case%values)
         base%stiffness = real_of(values, name, 'k_t_over_m_w')
         base%modulus = modulus_of(values)
         base%xi = real_of(values, name, 'xi')
         call get_real(values, name, 'delay', base%delay)
         call get_real(values, name, 'mu', base%mu)
         call get_real(values, name, 'd_y', base%d_y)
         base%strips = integer_of(values, name, 'strips')
      end associate
   end subroutine fill_base

   pure logical function has_base(case)
      type(case_t), intent(in) :: case

      has_base = allocated(case%compliant_base)
   end function has_base

end module rwmf_model_effects_compliant_base
