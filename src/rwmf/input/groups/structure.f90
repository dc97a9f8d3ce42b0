!> Basic groups of the structure: `&wall`, `&frame`, `&cable`, `&impact`, `&initial`.
module rwmf_input_groups_structure
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t, frame_t, initial_t, wall_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_element_lists, only: check_base, get_each
   use rwmf_problem_group_values, only: derive, get_list, get_real, group_values_t, has_group, &
      has_key, integer_of, logical_of, real_of, text_of
   use rwmf_problem_key, only: any_real, dimensional, not_negative, optional_key, positive, &
      required, unless, usually, with_si
   use rwmf_problem_rules, only: check_one_of, fail_group, fail_key
   use rwmf_problem_shear_frame, only: floors_group
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: wall_group, frame_group, cable_group, impact_group, initial_group

contains

   !> Group `&wall` with its keys and hooks.
   type(case_group_t) function wall_group() result(group)
      group%name = 'wall'
      group%keys = [ &
         usually('[0.5, 150]', &
            required('wall', 'h', 'real', 'm', positive, 'half height of the wall')), &
         usually('[0.05, 20]', &
            required('wall', 'b', 'real', 'm', positive, 'half width of the wall')), &
         usually('[500, 1e8]', optional_key('wall', 'm_w', 'real', 'kg', '', positive, &
            'mass of the wall; given: forces are reported in N as well')), &
         usually('[300, 8000]', &
            dimensional('wall', 'density', 'real', 'kg/m3', 'm_w', 'thickness', &
            'or its density and thickness: m_w = 4 h b thickness density')), &
         usually('[0.05, 3]', dimensional('wall', 'thickness', 'real', 'm', 'm_w', 'density', &
            'across the plane of the motion')), &
         optional_key('wall', 'walls', 'integer', '', '1', '[1, 50]', &
            'number of equal walls side by side that turn together; m_w, h, b are those of one'), &
         optional_key('wall', 'shear_key', 'logical', '', '.false.', '', &
            'a key keeps the base from sliding: its force is reported, not the friction demand')]
      group%derive => derive_wall
      group%check => check_wall
      group%fill => fill_wall
      group%is_present => has_wall
   end function wall_group

   subroutine derive_wall(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_key(values, 'wall', 'density')) call derive(values, 'wall', 'm_w', 'density', &
         [4*real_of(values, 'wall', 'h')*real_of(values, 'wall', 'b') &
         *real_of(values, 'wall', 'thickness')*real_of(values, 'wall', 'density')])
   end subroutine derive_wall

   !> Refuse several walls where the equations hold for one.
   subroutine check_wall(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (integer_of(values, 'wall', 'walls') == 1) return
      call check_base(values, 'wall', error)
      if (.not. allocated(error) .and. has_group(values, 'bending')) call fail_key(values, 'wall', &
         'walls', 'must be 1 with &bending: its equations are those of one wall', error)
   end subroutine check_wall

   subroutine fill_wall(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%wall = wall_t(real_of(case%values, 'wall', 'h'), real_of(case%values, 'wall', 'b'))
      call get_real(case%values, 'wall', 'm_w', case%wall%m_w)
      case%wall%walls = integer_of(case%values, 'wall', 'walls')
      case%wall%shear_key = logical_of(case%values, 'wall', 'shear_key')
   end subroutine fill_wall

   pure logical function has_wall(case)
      type(case_t), intent(in) :: case

      has_wall = allocated(case%wall)
   end function has_wall

   !> Group `&frame` with its keys and hooks.
   type(case_group_t) function frame_group() result(group)
      group%name = 'frame'
      group%keys = [ &
         usually('[0.02, 15]', optional_key('frame', 'T_s', 'real', 's', '', positive, &
            'undamped period; required without &spectrum')), &
         with_si('kg', usually('[0.01, 1e5]', &
            optional_key('frame', 'gamma', 'real', '-', '', not_negative, &
            'mass ratio m_s/m_w; required with &wall, refused without'))), &
         usually('[500, 1e9]', dimensional('frame', 'm_s', 'real', 'kg', 'gamma', '', &
            'or the mass of the frame, with and without &wall', not_negative)), &
         usually('[1e4, 1e11]', dimensional('frame', 'k_s', 'real', 'N/m', 'T_s', 'm_s', &
            'stiffness of the frame: T_s = 2 pi sqrt(m_s/k_s)')), &
         usually('[0.001, 0.5]', &
            required('frame', 'xi_s', 'real', '-', not_negative, 'viscous damping ratio'))]
      group%derive => derive_frame
      group%check => check_frame
      group%fill => fill_frame
      group%is_present => has_frame
   end function frame_group

   subroutine derive_frame(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_key(values, 'frame', 'k_s')) call derive(values, 'frame', 'T_s', 'k_s', &
         [2*pi*sqrt(real_of(values, 'frame', 'm_s')/real_of(values, 'frame', 'k_s'))])
   end subroutine derive_frame

   !> Check mass ratio and period of the frame, unless storeys set them.
   subroutine check_frame(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_group(values, floors_group)) return
      if (has_group(values, 'wall') .and. .not. has_key(values, 'frame', 'gamma')) then
         call fail_group(values, 'frame', 'the key gamma is missing (mass ratio m_s/m_w): must ' &
            //'be given with &wall, a number >= 0 [-]', error)
      else if (has_key(values, 'frame', 'gamma') .and. .not. has_group(values, 'wall')) then
         call fail_key(values, 'frame', 'gamma', 'must not be given without &wall (the bare ' &
            //'frame has no mass ratio)', error)
      else if (.not. has_key(values, 'frame', 'T_s') .and. .not. has_group(values, 'spectrum')) then
         call fail_group(values, 'frame', 'the key T_s is missing (undamped period): must be ' &
            //'given without &spectrum, a number > 0 [s]', error)
      end if
   end subroutine check_frame

   subroutine fill_frame(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%frame = frame_t(xi_s=real_of(case%values, 'frame', 'xi_s'))
      call get_real(case%values, 'frame', 'T_s', case%frame%T_s)
      call get_real(case%values, 'frame', 'gamma', case%frame%gamma)
   end subroutine fill_frame

   pure logical function has_frame(case)
      type(case_t), intent(in) :: case

      has_frame = allocated(case%frame)
   end function has_frame

   !> Group `&cable` with its keys and hooks.
   type(case_group_t) function cable_group() result(group)
      group%name = 'cable'
      group%needs(1) = 'wall'
      group%reasons(1) = 'a cable holds a wall'
      group%keys = [ &
         with_si('N', usually('[0.001, 30]', required('cable', 'eta_0', 'reals', '-', &
            not_negative, 'P(0)/(m_w g), Eq. (1)'))), &
         with_si('N', usually('[0.001, 200]', &
            optional_key('cable', 'eta_alpha', 'reals', '-', 'eta_0', not_negative, &
            'P(alpha)/(m_w g) of such a tendon on the axis: sets its stiffness'))), &
         optional_key('cable', 'law', 'choice', '', 'linear', 'linear truss', &
            'Eq. (1), or the exact length of the straight cable')]
      group%check => check_cable
      group%fill => fill_cable
      group%is_present => has_cable
   end function cable_group

   !> Check that cable law and formulation are compatible.
   subroutine check_cable(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (text_of(values, 'cable', 'law') == 'truss' &
          .and. text_of(values, 'model', 'formulation') == 'published') then
         call fail_key(values, 'cable', 'law', "must be 'linear' with &model formulation = " &
            //"'published'; 'truss' needs 'symmetric' or 'exact'", error)
      end if
   end subroutine check_cable

   subroutine fill_cable(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%cable)
      call get_each(case%values, 'cable', 'eta_0', case%cable%eta_0)
      call get_each(case%values, 'cable', 'eta_alpha', case%cable%eta_alpha)
      case%cable%law = text_of(case%values, 'cable', 'law')
   end subroutine fill_cable

   pure logical function has_cable(case)
      type(case_t), intent(in) :: case

      has_cable = allocated(case%cable)
   end function has_cable

   !> Group `&impact` with its keys and hooks.
   type(case_group_t) function impact_group() result(group)
      group%name = 'impact'
      group%needs(1) = 'wall'
      group%not_on_base = 'contact takes the place of impacts'
      group%reasons(1) = 'only a wall has impacts'
      group%keys = [ &
         unless('base', optional_key('impact', 'rule', 'choice', '', 'coupled', &
            'constant housner coupled table none', &
            'coupled: momentum balance of wall and frame; e, r imply constant, table_e table; ' &
            //'none: e = 1')), &
         optional_key('impact', 'e', 'real', '-', '', '[0, 1]', &
            'factor on the angular velocity at impact; constant: exactly one of e and r', &
            'rule=constant'), &
         optional_key('impact', 'r', 'real', '-', '', '[0, 1]', 'e squared', 'rule=constant')]
      group%check => check_impact
      group%fill => fill_impact
      group%is_present => has_impact
   end function impact_group

   !> Check that rule 'constant' has exactly one of e and r, and other rules have none.
   subroutine check_impact(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(1), parameter :: keys(2) = ['e', 'r']
      character(8) :: rule
      integer :: i

      rule = text_of(values, 'impact', 'rule')
      if (rule == 'constant') then
         call check_one_of(values, 'impact', 'e', 'r', "with rule = 'constant'", error)
         return
      end if
      do i = 1, size(keys)
         if (.not. has_key(values, 'impact', keys(i))) cycle
         call fail_key(values, 'impact', keys(i), "must not be given with rule = '"//trim(rule) &
            //"', which sets it", error)
         return
      end do
   end subroutine check_impact

   !> Fill the case with e, also if the group gives r.
   subroutine fill_impact(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%impact%rule = text_of(case%values, 'impact', 'rule')
      case%impact%given_as_r = has_key(case%values, 'impact', 'r')
      if (case%impact%given_as_r) then
         case%impact%e = sqrt(real_of(case%values, 'impact', 'r'))
      else
         call get_real(case%values, 'impact', 'e', case%impact%e)
      end if
   end subroutine fill_impact

   !> True if impacts take energy: the wall rocks, and the rule is not 'none'.
   pure logical function has_impact(case)
      type(case_t), intent(in) :: case

      has_impact = allocated(case%wall) .and. case%impact%rule /= 'none'
      if (has_impact) has_impact = case%wall%base == 'rocking' &
         .and. .not. allocated(case%compliant_base)
   end function has_impact

   !> Group `&initial` with its keys and hooks.
   type(case_group_t) function initial_group() result(group)
      group%name = 'initial'
      group%needs(1) = 'wall'
      group%reasons(1) = 'theta is the rotation of the wall'
      group%keys = [ &
         optional_key('initial', 'theta_over_alpha', 'real', '-', '0.0', any_real, &
            'rotation over slenderness; within the overturning angle'), &
         optional_key('initial', 'theta_dot', 'real', 'rad/s', '0.0', any_real, &
            'angular velocity')]
      group%check => check_initial
      group%fill => fill_initial
      group%is_present => has_initial
   end function initial_group

   !> Check that the initial rotation is not already overturned, for any width of the spectrum.
   subroutine check_initial(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: b(:)
      real(wp) :: limit
      real(wp) :: theta

      if (.not. has_key(values, 'initial', 'theta_over_alpha')) return
      call get_list(values, 'spectrum', 'b', b)
      if (.not. allocated(b)) b = [real_of(values, 'wall', 'b')]
      theta = abs(real_of(values, 'initial', 'theta_over_alpha')) &
         *atan2(maxval(b), real_of(values, 'wall', 'h'))
      limit = real_of(values, 'model', 'overturning_angle')
      if (theta < limit) return
      call fail_key(values, 'initial', 'theta_over_alpha', '|theta| = ' &
         //trim(real_to_text(theta))//' rad must be < overturning_angle = ' &
         //trim(real_to_text(limit))//' rad', error)
   end subroutine check_initial

   subroutine fill_initial(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%initial = initial_t(real_of(case%values, 'initial', 'theta_over_alpha'), &
         real_of(case%values, 'initial', 'theta_dot'))
   end subroutine fill_initial

   pure logical function has_initial(case)
      type(case_t), intent(in) :: case

      has_initial = allocated(case%initial)
   end function has_initial

end module rwmf_input_groups_structure
