!> Cable that yields or breaks, `&cable eta_y, hardening, rupture_strain`, and the cable given by
!> its strands, whose steel and length determine the forces.
module rwmf_model_effects_tendon
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_element_lists, only: check_base, check_lists, check_offsets, get_each, &
      number_of_elements
   use rwmf_problem_group_values, only: derive, get_list, group_values_t, has_key, real_of, text_of
   use rwmf_problem_key, only: any_real, below_one, dimensional, not_negative, optional_key, &
      positive, with_si, usually
   use rwmf_problem_rules, only: check_period, fail_key
   use rwmf_problem_tendon_stroke, only: elongation_at_alpha
   use rwmf_problem_units, only: unit_of
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: tendon_group, has_tendon

contains

   !> Describe the tendon keys of the group `&cable` and the procedures that check and read them.
   type(case_group_t) function tendon_group() result(group)
      character(*), parameter :: of_strands = 'strands strand_area modulus initial_stress'

      group%name = 'cable'
      group%after = 'cable'
      group%keys = [ &
         optional_key('cable', 'offset', 'real list', 'm', '', any_real, &
            'place of each tendon to the right of the axis, at most 4 b away; absent: one, at 0'), &
         optional_key('cable', 'height', 'reals', 'm', '', positive, &
            'height of each upper anchor, at most 2h, the default'), &
         with_si('N', usually('[0.001, 200]', &
            optional_key('cable', 'eta_y', 'reals', '-', '', positive, &
            'P/(m_w g) at which the tendon yields; absent: it stays elastic'))), &
         optional_key('cable', 'hardening', 'reals', '-', '0.0', below_one, &
            'stiffness of the tendon after yield over its elastic one'), &
         usually('[0.003, 0.3]', &
            optional_key('cable', 'rupture_strain', 'reals', '-', '', positive, &
            'strain at which it breaks, that of the prestress included; absent: never')), &
         usually('[1, 300]', optional_key('cable', 'length', 'reals', 'm', '', positive, &
            'length that is strained, with strands or rupture_strain; absent: height')), &
         dimensional('cable', 'strands', 'integers', '', 'eta_0', of_strands, &
            'number of strands: P(0) = strands strand_area initial_stress'), &
         usually('[1e-5, 0.02]', &
            dimensional('cable', 'strand_area', 'reals', 'm2', 'eta_0', of_strands, &
            'area of each')), &
         usually('[1e10, 4e11]', &
            dimensional('cable', 'modulus', 'reals', 'Pa', 'eta_alpha', of_strands, &
            'of elasticity: P(alpha) follows from the elongation at alpha over length')), &
         usually('[1e7, 2e9]', &
            dimensional('cable', 'initial_stress', 'reals', 'Pa', 'eta_0', of_strands, &
            'stress at theta = 0', not_negative)), &
         usually('[1e8, 4e9]', &
            dimensional('cable', 'yield_stress', 'reals', 'Pa', 'eta_y', 'strands', &
            'stress at which it yields; absent: it stays elastic'))]
      group%derive => derive_strands
      group%check => check_tendon
      group%fill => fill_tendon
      group%is_present => has_tendon
      group%add_events => add_tendon_events
      group%no_element = '&cable eta_y or rupture_strain: what yields has to be remembered, and ' &
         //'an element holds no state; a wall that steps with the host (create_stepping) does'
   end function tendon_group

   !> Derive forces over the weight of the wall from stresses and from the strain at theta = alpha.
   subroutine derive_strands(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: area(:), length(:), list(:), stress(:)
      !! (tendons) area over the weight of the wall [m2/N], length [m], numbers, stress at theta = 0
      !! [Pa]
      real(wp), allocatable :: x(:)
      !! (tendons) elongation up to theta = alpha [m]

      if (.not. has_key(values, 'cable', 'strands')) return
      call check_lists(values, 'cable', [character(14) :: 'strands', 'strand_area', 'modulus', &
         'initial_stress', 'yield_stress', 'length', 'height'], number_of_elements(values, &
         'cable'), error)
      if (allocated(error)) return
      call get_each(values, 'cable', 'strands', area)
      call get_each(values, 'cable', 'strand_area', list)
      area = area*list/unit_of(values, 'N')
      call get_each(values, 'cable', 'initial_stress', stress)
      call get_lengths(values, length)
      call get_each(values, 'cable', 'modulus', list)
      x = elongations_at_alpha(values, real_of(values, 'wall', 'b'))
      call derive(values, 'cable', 'eta_0', 'initial_stress', area*stress)
      call derive(values, 'cable', 'eta_alpha', 'modulus', area*(stress + list*x/length))
      if (has_key(values, 'cable', 'yield_stress')) then
         call get_each(values, 'cable', 'yield_stress', list)
         call derive(values, 'cable', 'eta_y', 'yield_stress', area*list)
      else if (has_key(values, 'cable', 'eta_y')) then
         call fail_key(values, 'cable', 'eta_y', 'must not be given beside strands: give ' &
            //'yield_stress [Pa] instead', error)
      end if
   end subroutine derive_strands

   !> Heights of the upper anchors [m].
   pure subroutine get_heights(values, height)
      type(group_values_t), intent(in) :: values
      real(wp), allocatable, intent(out) :: height(:)
      !! (tendons)

      call get_each(values, 'cable', 'height', height)
      if (.not. allocated(height)) height = spread(2*real_of(values, 'wall', 'h'), 1, &
         number_of_elements(values, 'cable'))
   end subroutine get_heights

   !> Lengths that determine the strains of the tendons [m].
   pure subroutine get_lengths(values, length)
      type(group_values_t), intent(in) :: values
      real(wp), allocatable, intent(out) :: length(:)
      !! (tendons)

      call get_each(values, 'cable', 'length', length)
      if (.not. allocated(length)) call get_heights(values, length)
   end subroutine get_lengths

   !> Check that the tendons have a stiffness and that their limits exceed the prestress.
   subroutine check_tendon(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(14) :: key
      real(wp), allocatable :: eta_0(:), eta_alpha(:), eta_y(:), height(:)
      integer :: i

      call check_places(values, error)
      if (allocated(error)) return
      if (has_key(values, 'cable', 'length') .and. .not. has_key(values, 'cable', 'strands') &
          .and. .not. has_key(values, 'cable', 'rupture_strain')) then
         call fail_key(values, 'cable', 'length', 'must not be given without strands or ' &
            //'rupture_strain, which it belongs to', error)
         return
      end if
      call get_each(values, 'cable', 'eta_0', eta_0)
      call get_each(values, 'cable', 'eta_alpha', eta_alpha)
      call get_heights(values, height)
      key = ''
      if (has_key(values, 'cable', 'offset')) key = 'offset'
      if (has_key(values, 'cable', 'rupture_strain')) key = 'rupture_strain'
      if (has_key(values, 'cable', 'eta_y')) key = 'eta_y'
      if (has_key(values, 'cable', 'hardening') .and. key /= 'eta_y') then
         call fail_key(values, 'cable', 'hardening', 'must not be given without eta_y', error)
         return
      else if (key == '') then
         return
      end if
      i = findloc(eta_alpha > eta_0, .false., dim=1)
      if (key == 'offset') i = findloc(eta_alpha >= eta_0, .false., dim=1)
      if (text_of(values, 'model', 'formulation') == 'published') then
         call fail_key(values, 'cable', trim(key), "must not be given with &model formulation = " &
            //"'published', where the force falls with rocking to one side; " &
            //"'symmetric' and 'exact' allow it", error)
      else if (i > 0) then
         call fail_key(values, 'cable', trim(key), 'needs eta_alpha > eta_0 = ' &
            //trim(real_to_text(eta_0(i)))//', so that the cable has a stiffness', error)
      else if (has_key(values, 'cable', 'eta_y')) then
         call get_each(values, 'cable', 'eta_y', eta_y)
         i = findloc(eta_y > eta_0, .false., dim=1)
         if (i > 0) call fail_key(values, 'cable', 'eta_y', 'must be > eta_0 = ' &
            //trim(real_to_text(eta_0(i))), error)
      end if
      if (.not. allocated(error)) call check_widths(values, eta_0, eta_alpha, error)
   end subroutine check_tendon

   !> Check the number and the places of the tendons.
   subroutine check_places(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: height(:)

      call check_lists(values, 'cable', [character(14) :: 'eta_0', 'eta_alpha', 'height', 'eta_y', &
         'hardening', 'rupture_strain', 'length'], number_of_elements(values, 'cable'), error)
      if (.not. allocated(error)) call check_offsets(values, 'cable', 4.0_wp, error)
      if (allocated(error) .or. .not. has_key(values, 'cable', 'height')) return
      call check_base(values, 'cable', error)
      call get_heights(values, height)
      if (allocated(error) .or. maxval(height) <= 2*real_of(values, 'wall', 'h')) return
      call fail_key(values, 'cable', 'height', 'must be in (0, 2h] = (0, ' &
         //trim(real_to_text(2*real_of(values, 'wall', 'h')))//'] [m]', error)
   end subroutine check_places

   !> Check each width of the spectrum. The stiffness of a tendon must give the wall a period long
   !> enough to integrate, and the prestress alone must not break it.
   subroutine check_widths(values, eta_0, eta_alpha, error)
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: eta_0(:), eta_alpha(:)
      !! (tendons) forces over m_w g [-]
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      real(wp), allocatable :: b(:), length(:), strain(:), x(:)
      !! widths [m]; of the tendons: lengths [m], strains [-], elongations up to theta = alpha [m]
      integer :: i, k

      call get_list(values, 'spectrum', 'b', b)
      ! strands give the forces of the current width
      if (has_key(values, 'cable', 'strands') .or. .not. allocated(b)) then
         b = [real_of(values, 'wall', 'b')]
      end if
      call get_lengths(values, length)
      call get_each(values, 'cable', 'rupture_strain', strain)
      do i = 1, size(b)
         x = elongations_at_alpha(values, b(i))
         do k = 1, size(x)
            call check_period(sqrt(x(k)), sqrt(max(0.0_wp, eta_alpha(k) - eta_0(k))) &
               *sqrt(real_of(values, 'model', 'g')), problem)
            if (allocated(problem)) then
               call fail_key(values, 'cable', 'eta_alpha', problem, error)
               return
            end if
            if (.not. allocated(strain)) cycle
            associate (least => max(0.0_wp, eta_0(k)/length(k)*x(k)/(eta_alpha(k) - eta_0(k))))
               if (strain(k) > least) cycle
               call fail_key(values, 'cable', 'rupture_strain', 'must be > ' &
                  //trim(real_to_text(least))//', the strain of the prestress', error)
               return
            end associate
         end do
      end do
   end subroutine check_widths

   !> Elongations of the tendons at theta = alpha, each as if it stood on the axis [m].
   function elongations_at_alpha(values, b) result(x)
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: b
      !! half width [m]
      real(wp), allocatable :: x(:)
      !! (tendons)
      real(wp), allocatable :: height(:)
      integer :: i

      call get_heights(values, height)
      x = [(elongation_at_alpha(text_of(values, 'cable', 'law'), real_of(values, 'wall', 'h'), b, &
         height(i)), i=1, size(height))]
   end function elongations_at_alpha

   subroutine fill_tendon(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: strands(:)

      associate (values => case%values, cable => case%cable)
         call get_each(values, 'cable', 'hardening', cable%hardening)
         call get_each(values, 'cable', 'eta_y', cable%eta_y)
         call get_each(values, 'cable', 'rupture_strain', cable%rupture_strain)
         call get_each(values, 'cable', 'length', cable%length)
         call get_each(values, 'cable', 'height', cable%height)
         call get_list(values, 'cable', 'offset', cable%offset)
         if (.not. has_key(values, 'cable', 'strands')) return
         call get_each(values, 'cable', 'strands', strands)
         call get_each(values, 'cable', 'strand_area', cable%area)
         cable%area = strands*cable%area
      end associate
   end subroutine fill_tendon

   !> Return whether the cable of a case can yield or break.
   pure logical function has_tendon(case)
      type(case_t), intent(in) :: case

      has_tendon = .false.
      if (allocated(case%cable)) has_tendon = allocated(case%cable%eta_y) &
         .or. allocated(case%cable%rupture_strain)
   end function has_tendon

   pure subroutine add_tendon_events(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      if (allocated(case%cable%eta_y)) names = [character(name_length) :: names, 'branch']
      if (allocated(case%cable%rupture_strain)) then
         names = [character(name_length) :: names, 'rupture']
      end if
   end subroutine add_tendon_events

end module rwmf_model_effects_tendon
