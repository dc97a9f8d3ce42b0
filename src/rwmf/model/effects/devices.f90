!> Devices on a wall: the groups `&fuse`, `&damper` and `&nl_damper` under its base, `&coupling`
!> between adjacent walls and `&restraint` against columns that stand still.
module rwmf_model_effects_devices
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t, devices_t
   use rwmf_problem_case_group, only: case_group_t, name_length, two_corners
   use rwmf_problem_element_lists, only: check_base, check_lists, check_offsets, &
      get_each, number_of_elements
   use rwmf_problem_group_values, only: derive, get_list, group_values_t, has_key, integer_of, &
      real_of, text_of
   use rwmf_problem_key, only: any_real, below_one, dimensional, key_t, not_negative, &
      optional_key, positive, required, usually, with_si
   use rwmf_problem_rules, only: check_period, fail_group, fail_key
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: fuse_group, damper_group, nl_damper_group, coupling_group, restraint_group

contains

   !> Describe the group `&fuse`: its keys and the procedures that check and read them.
   type(case_group_t) function fuse_group() result(group)
      group%name = 'fuse'
      group%needs(1) = 'wall'
      group%reasons(1) = 'fuses work under its base'
      group%keys = [offset_key('fuse'), spring_keys('fuse')]
      group%keys(2:3)%is_required = .true.
      group%derive => derive_fuse
      group%check => check_fuse
      group%fill => fill_fuse
      group%is_present => has_fuse
      group%add_events => add_branch_event
      group%no_element = '&fuse: what yields has to be remembered, and an element holds no ' &
         //'state; a wall that steps with the host (create_stepping) does'
   end function fuse_group

   !> Describe the group `&damper`: its keys and the procedures that check and read them.
   type(case_group_t) function damper_group() result(group)
      group%name = 'damper'
      group%needs(1) = 'wall'
      group%reasons(1) = 'dampers work under its base'
      group%keys = [offset_key('damper'), damper_keys('damper')]
      group%keys(2)%is_required = .true.
      group%check => check_damper
      group%fill => fill_damper
      group%is_present => has_damper
   end function damper_group

   !> Describe the group `&nl_damper`: its keys and the procedures that check and read them.
   type(case_group_t) function nl_damper_group() result(group)
      group%name = 'nl_damper'
      group%needs(1) = 'wall'
      group%not_on_base = two_corners
      group%reasons(1) = 'dampers work under its base'
      group%keys = [offset_key('nl_damper'), &
         with_si('N', usually('[1e-4, 10]', required('nl_damper', 'eta_1', 'reals', '-', &
            not_negative, 'force at 1 m/s of the damper under each corner over m_w g'))), &
         usually('[1e3, 1e8]', dimensional('nl_damper', 'F_1', 'reals', 'N', 'eta_1', '', &
            'or that force', not_negative)), &
         required('nl_damper', 'exponent', 'real', '-', '[0.15, 2]', &
            'power of the velocity of the stroke that the force follows; 1 is &damper')]
      group%check => check_nl_damper
      group%fill => fill_nl_damper
      group%is_present => has_nl_damper
   end function nl_damper_group

   !> Describe the group `&coupling`: its keys and the procedures that check and read them.
   type(case_group_t) function coupling_group() result(group)
      group%name = 'coupling'
      group%needs(1) = 'wall'
      group%not_on_base = two_corners
      group%reasons(1) = 'it acts between adjacent walls'
      group%keys = [spring_keys('coupling'), linear_keys('coupling'), damper_keys('coupling'), &
         usually('[0, 10]', optional_key('coupling', 'span', 'real', 'm', '0.0', not_negative, &
            'clear span of coupling beams clamped in both walls; 0: plates or dampers'))]
      group%derive => derive_coupling
      group%check => check_coupling
      group%fill => fill_coupling
      group%is_present => has_coupling
      group%add_events => add_coupling_event
      group%no_element = '&coupling: what yields has to be remembered, and an element holds no ' &
         //'state; a wall that steps with the host (create_stepping) does'
   end function coupling_group

   !> Describe the group `&restraint`: its keys and the procedures that check and read them.
   type(case_group_t) function restraint_group() result(group)
      group%name = 'restraint'
      group%needs(1) = 'wall'
      group%not_on_base = two_corners
      group%reasons(1) = 'it holds points of the wall'
      group%keys = [required('restraint', 'offset', 'real list', 'm', any_real, &
         'place of each held point to the right of the axis, at most 20 b away'), &
         required('restraint', 'height', 'reals', 'm', not_negative, &
         'height of each held point above the base, at most 2h'), &
         spring_keys('restraint'), linear_keys('restraint'), damper_keys('restraint')]
      group%derive => derive_restraint
      group%check => check_restraint
      group%fill => fill_restraint
      group%is_present => has_restraint
      group%add_events => add_restraint_event
      group%no_element = '&restraint: what yields has to be remembered, and an element holds no ' &
         //'state; a wall that steps with the host (create_stepping) does'
   end function restraint_group

   !> Key of the places of devices under the base.
   pure type(key_t) function offset_key(group) result(key)
      character(*), intent(in) :: group

      key = optional_key(group, 'offset', 'real list', 'm', '', any_real, &
         'place of each to the right of the axis, at most 4 b away; absent: two, at -b and b')
   end function offset_key

   !> Keys of springs that yield.
   pure function spring_keys(group) result(keys)
      character(*), intent(in) :: group
      type(key_t) :: keys(8)

      keys = [ &
         with_si('N', usually('[1e-4, 10]', optional_key(group, 'eta_y', 'reals', '-', '', &
            positive, 'yield force of each over m_w g'))), &
         usually('[1e-5, 0.2]', optional_key(group, 'stroke_y', 'reals', 'm', '', positive, &
            'stroke at which it yields first')), &
         usually('[1e3, 1e8]', dimensional(group, 'F_y', 'reals', 'N', 'eta_y', '', &
            'or the yield force')), &
         usually('[1e5, 1e11]', dimensional(group, 'k', 'reals', 'N/m', 'stroke_y', 'F_y', &
            'or the stiffness until then: stroke_y = F_y/k')), &
         optional_key(group, 'hardening', 'reals', '-', '0.0', below_one, &
            'stiffness after yield over the elastic one'), &
         optional_key(group, 'law', 'choice', '', 'elastic_plastic', &
            'elastic_plastic friction flag', 'bilinear, slipping, or self-centring'), &
         optional_key(group, 'breakaway', 'real', '-', '1.0', '[1, 10]', &
            'force at which friction lets go over that at which it slips; friction only'), &
         optional_key(group, 'flag_height', 'real', '-', '1.0', '(0, 1]', &
            'force by which a flag unloads lower, over its yield force; flag only')]
      ! alone it is the stiffness of a linear spring
      if (group /= 'fuse') then
         keys(4)%gives = 'k_over_m_w'
         keys(4)%needs = ''
         keys(4)%help = 'or the stiffness; with F_y, that until it yields'
      end if
   end function spring_keys

   !> Keys of linear springs.
   pure function linear_keys(group) result(keys)
      character(*), intent(in) :: group
      type(key_t) :: keys(1)

      keys = [with_si('N/m', optional_key(group, 'k_over_m_w', 'reals', '1/s2', '', positive, &
         'stiffness of each linear spring over m_w'))]
   end function linear_keys

   !> Keys of viscous dampers.
   pure function damper_keys(group) result(keys)
      character(*), intent(in) :: group
      type(key_t) :: keys(2)

      keys = [ &
         with_si('N s/m', optional_key(group, 'c_over_m_w', 'reals', '1/s', '', not_negative, &
            'constant of each viscous damper over m_w')), &
         usually('[100, 1e9]', dimensional(group, 'c', 'reals', 'N s/m', 'c_over_m_w', '', &
            'or its constant', not_negative))]
   end function damper_keys

   subroutine derive_fuse(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      call derive_stroke(values, 'fuse', error)
   end subroutine derive_fuse

   subroutine derive_coupling(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      call derive_stroke(values, 'coupling', error)
   end subroutine derive_coupling

   subroutine derive_restraint(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      call derive_stroke(values, 'restraint', error)
   end subroutine derive_restraint

   !> Derive the stroke at first yield from strength and stiffness.
   subroutine derive_stroke(values, group, error)
      type(group_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: strength(:), stiffness(:)
      integer :: n

      if (.not. (has_key(values, group, 'k') .and. has_key(values, group, 'F_y'))) return
      if (has_key(values, group, 'stroke_y')) then
         call fail_key(values, group, 'k', 'must not be given beside stroke_y, which follows ' &
            //'from it', error)
         return
      end if
      call get_list(values, group, 'F_y', strength)
      call get_list(values, group, 'k', stiffness)
      n = max(size(strength), size(stiffness))
      call check_lists(values, group, [character(3) :: 'F_y', 'k'], n, error)
      if (allocated(error)) return
      if (size(strength) == 1) strength = spread(strength(1), 1, n)
      if (size(stiffness) == 1) stiffness = spread(stiffness(1), 1, n)
      call derive(values, group, 'stroke_y', 'k', strength/stiffness)
   end subroutine derive_stroke

   subroutine check_fuse(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      call check_offsets(values, 'fuse', 4.0_wp, error)
      if (.not. allocated(error)) call check_springs(values, 'fuse', error)
   end subroutine check_fuse

   subroutine check_damper(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      call check_offsets(values, 'damper', 4.0_wp, error)
      if (.not. allocated(error)) call check_lists(values, 'damper', ['c_over_m_w'], &
         number_of_elements(values, 'damper'), error)
   end subroutine check_damper

   subroutine check_nl_damper(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      call check_offsets(values, 'nl_damper', 4.0_wp, error)
      if (.not. allocated(error)) call check_lists(values, 'nl_damper', ['eta_1'], &
         number_of_elements(values, 'nl_damper'), error)
   end subroutine check_nl_damper

   !> Check that coupled walls stand side by side and that the coupling has a spring or a damper.
   subroutine check_coupling(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (integer_of(values, 'wall', 'walls') < 2) then
         call fail_group(values, 'coupling', 'needs walls of &wall >= 2: it acts between ' &
            //'adjacent walls', error)
      else if (real_of(values, 'coupling', 'span') > 10*real_of(values, 'wall', 'b')) then
         call fail_key(values, 'coupling', 'span', 'must be in [0, 10 b] = [0, ' &
            //trim(real_to_text(10*real_of(values, 'wall', 'b')))//'] [m]', error)
      else
         call check_base(values, 'coupling', error)
         if (.not. allocated(error)) call check_linear(values, 'coupling', error)
      end if
   end subroutine check_coupling

   !> Check the places of the held points, and that each has a spring or a damper.
   subroutine check_restraint(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: d(:), z(:), b(:)

      call check_offsets(values, 'restraint', 20.0_wp, error)
      if (.not. allocated(error)) call check_base(values, 'restraint', error)
      if (.not. allocated(error)) call check_lists(values, 'restraint', ['height'], &
         number_of_elements(values, 'restraint'), error)
      if (.not. allocated(error)) call check_linear(values, 'restraint', error)
      if (allocated(error)) return
      call get_list(values, 'restraint', 'height', z)
      call get_list(values, 'restraint', 'offset', d)
      call get_list(values, 'spectrum', 'b', b)
      if (.not. allocated(b)) b = [real_of(values, 'wall', 'b')]
      if (maxval(z) > 2*real_of(values, 'wall', 'h')) then
         call fail_key(values, 'restraint', 'height', 'must be in [0, 2h] = [0, ' &
            //trim(real_to_text(2*real_of(values, 'wall', 'h')))//'] [m]', error)
      else if (integer_of(values, 'wall', 'walls') > 1 .and. minval(abs(d)) < maxval(b)) then
         call fail_key(values, 'restraint', 'offset', 'must be >= b = ' &
            //trim(real_to_text(maxval(b)))//' m or <= -b with several walls: a column stands ' &
            //'beside the outer edge of the leftmost or the rightmost wall', error)
      end if
   end subroutine check_restraint

   !> Check that a group has linear springs, springs that yield, or dampers alone.
   subroutine check_linear(values, group, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(error_t), allocatable, intent(out) :: error
      logical :: has_stiffness

      has_stiffness = has_key(values, group, 'k_over_m_w')
      if (has_key(values, group, 'eta_y')) then
         if (has_stiffness .and. .not. has_key(values, group, 'F_y')) then
            call fail_key(values, group, 'k_over_m_w', 'must not be given beside eta_y: give ' &
               //'stroke_y, or F_y and k', error)
         else if (.not. has_key(values, group, 'stroke_y')) then
            call fail_key(values, group, 'eta_y', 'needs stroke_y, the stroke at first yield, or ' &
               //'F_y with k', error)
         else
            call check_springs(values, group, error)
         end if
      else if (has_key(values, group, 'stroke_y')) then
         call fail_key(values, group, 'stroke_y', 'must not be given without eta_y or F_y', error)
      else if (.not. (has_stiffness .or. has_key(values, group, 'c_over_m_w'))) then
         call fail_group(values, group, 'needs a spring (eta_y with stroke_y, F_y with k, or ' &
            //'k_over_m_w or k alone) or a damper (c_over_m_w or c)', error)
      end if
      if (.not. allocated(error)) call check_lists(values, group, [character(10) :: &
         'k_over_m_w', 'c_over_m_w'], number_of_elements(values, group), error)
   end subroutine check_linear

   !> Check that keys of a law are given only with it, and that each spring leaves the wall a period
   !> long enough to integrate.
   subroutine check_springs(values, group, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      character(11), parameter :: keys(2) = [character(11) :: 'breakaway', 'flag_height']
      character(8), parameter :: laws(2) = [character(8) :: 'friction', 'flag']
      real(wp), allocatable :: strength(:), stroke(:)
      integer :: i

      do i = 1, size(keys)
         if (.not. has_key(values, group, trim(keys(i)))) cycle
         if (text_of(values, group, 'law') == laws(i)) cycle
         call fail_key(values, group, trim(keys(i)), "belongs to law = '"//trim(laws(i))//"'", &
            error)
         return
      end do
      call check_lists(values, group, [character(9) :: 'eta_y', 'stroke_y', 'hardening'], &
         number_of_elements(values, group), error)
      if (allocated(error)) return
      call get_each(values, group, 'eta_y', strength)
      call get_each(values, group, 'stroke_y', stroke)
      do i = 1, size(stroke)
         call check_period(sqrt(stroke(i)), sqrt(strength(i))*sqrt(real_of(values, 'model', 'g')), &
            problem)
         if (.not. allocated(problem)) cycle
         call fail_key(values, group, 'stroke_y', problem//', eta_y m_w g/stroke_y', error)
         return
      end do
   end subroutine check_springs

   subroutine fill_fuse(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%fuse)
      call fill_devices(case, 'fuse', case%fuse)
   end subroutine fill_fuse

   subroutine fill_damper(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%damper)
      call fill_devices(case, 'damper', case%damper)
   end subroutine fill_damper

   subroutine fill_nl_damper(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%nl_damper)
      call fill_devices(case, 'nl_damper', case%nl_damper)
   end subroutine fill_nl_damper

   subroutine fill_coupling(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%coupling)
      call fill_devices(case, 'coupling', case%coupling)
   end subroutine fill_coupling

   subroutine fill_restraint(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%restraint)
      call fill_devices(case, 'restraint', case%restraint)
   end subroutine fill_restraint

   !> Read the values of a group, one for each device.
   subroutine fill_devices(case, group, devices)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: group
      type(devices_t), intent(inout) :: devices

      associate (values => case%values)
         call get_list(values, group, 'offset', devices%offset)
         call get_each(values, group, 'height', devices%height)
         call get_each(values, group, 'c_over_m_w', devices%c)
         call get_each(values, group, 'eta_1', devices%eta_1)
         if (group == 'nl_damper') call get_each(values, group, 'exponent', devices%exponent)
         if (group == 'coupling') devices%span = real_of(values, group, 'span')
         call get_each(values, group, 'eta_y', devices%eta_y)
         if (.not. allocated(devices%eta_y)) then
            call get_each(values, group, 'k_over_m_w', devices%k)
            return
         end if
         call get_each(values, group, 'stroke_y', devices%stroke_y)
         call get_each(values, group, 'hardening', devices%hardening)
         devices%law%name = text_of(values, group, 'law')
         devices%law%breakaway = real_of(values, group, 'breakaway')
         devices%law%flag_height = real_of(values, group, 'flag_height')
      end associate
   end subroutine fill_devices

   pure logical function has_fuse(case)
      type(case_t), intent(in) :: case

      has_fuse = allocated(case%fuse)
   end function has_fuse

   pure logical function has_damper(case)
      type(case_t), intent(in) :: case

      has_damper = allocated(case%damper)
   end function has_damper

   pure logical function has_nl_damper(case)
      type(case_t), intent(in) :: case

      has_nl_damper = allocated(case%nl_damper)
   end function has_nl_damper

   pure logical function has_coupling(case)
      type(case_t), intent(in) :: case

      has_coupling = allocated(case%coupling)
   end function has_coupling

   pure logical function has_restraint(case)
      type(case_t), intent(in) :: case

      has_restraint = allocated(case%restraint)
   end function has_restraint

   pure subroutine add_branch_event(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      names = [character(name_length) :: names, 'branch']
   end subroutine add_branch_event

   pure subroutine add_coupling_event(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      if (allocated(case%coupling%eta_y)) call add_branch_event(case, names)
   end subroutine add_coupling_event

   pure subroutine add_restraint_event(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      if (allocated(case%restraint%eta_y)) call add_branch_event(case, names)
   end subroutine add_restraint_event

end module rwmf_model_effects_devices
