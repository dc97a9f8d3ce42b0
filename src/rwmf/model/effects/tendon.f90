!> Cable that yields or breaks, `&cable eta_y, hardening, rupture_strain`, and the cable given by
!> its strands, whose steel and length determine the forces.
module rwmf_model_effects_tendon
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_group_values, only: derive, get_list, get_real, group_values_t, has_key, &
      real_of, text_of
   use rwmf_problem_key, only: below_one, dimensional, not_negative, optional_key, positive, &
      with_si, usually
   use rwmf_problem_rules, only: check_period, fail_key
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
         with_si('N', usually('[0.001, 200]', &
            optional_key('cable', 'eta_y', 'real', '-', '', positive, &
            'P/(m_w g) at which the tendon yields; absent: it stays elastic'))), &
         optional_key('cable', 'hardening', 'real', '-', '0.0', below_one, &
            'stiffness of the tendon after yield over its elastic one'), &
         usually('[0.003, 0.3]', &
            optional_key('cable', 'rupture_strain', 'real', '-', '', positive, &
            'strain at which it breaks, that of the prestress included; absent: never')), &
         usually('[1, 300]', optional_key('cable', 'length', 'real', 'm', '', positive, &
            'length that is strained, with strands or rupture_strain; absent: 2h')), &
         dimensional('cable', 'strands', 'integer', '', 'eta_0', of_strands, &
            'number of strands: P(0) = strands strand_area initial_stress'), &
         usually('[1e-5, 0.02]', &
            dimensional('cable', 'strand_area', 'real', 'm2', 'eta_0', of_strands, &
            'area of each')), &
         usually('[1e10, 4e11]', &
            dimensional('cable', 'modulus', 'real', 'Pa', 'eta_alpha', of_strands, &
            'of elasticity: P(alpha) follows from the elongation at alpha over length')), &
         usually('[1e7, 2e9]', &
            dimensional('cable', 'initial_stress', 'real', 'Pa', 'eta_0', of_strands, &
            'stress at theta = 0', not_negative)), &
         usually('[1e8, 4e9]', &
            dimensional('cable', 'yield_stress', 'real', 'Pa', 'eta_y', 'strands', &
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
      real(wp) :: area
      !! area over the weight of the wall [m2/N]
      real(wp) :: stress
      !! stress at theta = 0 [Pa]
      real(wp) :: strain
      !! strain from theta = 0 to theta = alpha [-]

      if (.not. has_key(values, 'cable', 'strands')) return
      area = real_of(values, 'cable', 'strands')*real_of(values, 'cable', 'strand_area') &
         /unit_of(values, 'N')
      stress = real_of(values, 'cable', 'initial_stress')
      strain = elongation_at_alpha(text_of(values, 'cable', 'law'), real_of(values, 'wall', 'h'), &
         real_of(values, 'wall', 'b'))/strained_length(values)
      call derive(values, 'cable', 'eta_0', 'initial_stress', [area*stress])
      call derive(values, 'cable', 'eta_alpha', 'modulus', &
         [area*(stress + real_of(values, 'cable', 'modulus')*strain)])
      if (has_key(values, 'cable', 'yield_stress')) then
         call derive(values, 'cable', 'eta_y', 'yield_stress', [area*real_of(values, 'cable', &
            'yield_stress')])
      else if (has_key(values, 'cable', 'eta_y')) then
         call fail_key(values, 'cable', 'eta_y', 'must not be given beside strands: give ' &
            //'yield_stress [Pa] instead', error)
      end if
   end subroutine derive_strands

   !> Length that determines the strain of the cable [m].
   pure real(wp) function strained_length(values) result(length)
      type(group_values_t), intent(in) :: values

      length = 2*real_of(values, 'wall', 'h')
      if (has_key(values, 'cable', 'length')) length = real_of(values, 'cable', 'length')
   end function strained_length

   !> Check that the cable has a stiffness and that its limits exceed the prestress.
   subroutine check_tendon(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(14) :: key
      real(wp) :: eta_0

      if (has_key(values, 'cable', 'length') .and. .not. has_key(values, 'cable', 'strands') &
          .and. .not. has_key(values, 'cable', 'rupture_strain')) then
         call fail_key(values, 'cable', 'length', 'must not be given without strands or ' &
            //'rupture_strain, which it belongs to', error)
         return
      end if
      key = 'eta_y'
      if (.not. has_key(values, 'cable', 'eta_y')) key = 'rupture_strain'
      if (.not. has_key(values, 'cable', trim(key))) then
         if (has_key(values, 'cable', 'hardening')) call fail_key(values, 'cable', 'hardening', &
            'must not be given without eta_y', error)
         return
      end if
      eta_0 = real_of(values, 'cable', 'eta_0')
      if (text_of(values, 'model', 'formulation') == 'published') then
         call fail_key(values, 'cable', trim(key), "must not be given with &model formulation = " &
            //"'published', where the force falls with rocking to one side; " &
            //"'symmetric' and 'exact' allow it", error)
      else if (real_of(values, 'cable', 'eta_alpha') <= eta_0) then
         call fail_key(values, 'cable', trim(key), 'needs eta_alpha > eta_0 = ' &
            //trim(real_to_text(eta_0))//', so that the cable has a stiffness', error)
      else if (has_key(values, 'cable', 'hardening') .and. key /= 'eta_y') then
         call fail_key(values, 'cable', 'hardening', 'must not be given without eta_y', error)
      else if (has_key(values, 'cable', 'eta_y')) then
         if (real_of(values, 'cable', 'eta_y') <= eta_0) then
            call fail_key(values, 'cable', 'eta_y', 'must be > eta_0 = ' &
               //trim(real_to_text(eta_0)), error)
         end if
      end if
      if (.not. allocated(error)) call check_widths(values, eta_0, error)
   end subroutine check_tendon

   !> Check each width of the spectrum. The stiffness of the tendon must give the wall a period
   !> long enough to integrate, and the prestress alone must not break the tendon.
   subroutine check_widths(values, eta_0, error)
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: eta_0
      !! prestress over m_w g [-]
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      real(wp), allocatable :: b(:)
      real(wp), allocatable :: elongation(:)
      !! (widths) elongation up to theta = alpha [m]
      real(wp) :: h
      real(wp) :: rise
      !! increase of the force over m_w g up to theta = alpha [-]
      real(wp) :: strain
      integer :: i

      h = real_of(values, 'wall', 'h')
      rise = real_of(values, 'cable', 'eta_alpha') - eta_0
      call get_list(values, 'spectrum', 'b', b)
      ! strands give the forces of the current width
      if (has_key(values, 'cable', 'strands') .or. .not. allocated(b)) then
         b = [real_of(values, 'wall', 'b')]
      end if
      elongation = [(elongation_at_alpha(text_of(values, 'cable', 'law'), h, b(i)), i=1, size(b))]
      call check_period(sqrt(minval(elongation)), sqrt(rise)*sqrt(real_of(values, 'model', 'g')), &
         problem)
      if (allocated(problem)) then
         call fail_key(values, 'cable', 'eta_alpha', problem, error)
      else if (has_key(values, 'cable', 'rupture_strain')) then
         strain = max(0.0_wp, maxval(eta_0/strained_length(values)*elongation/rise))
         if (real_of(values, 'cable', 'rupture_strain') <= strain) call fail_key(values, 'cable', &
            'rupture_strain', 'must be > '//trim(real_to_text(strain)) &
            //', the strain of the prestress', error)
      end if
   end subroutine check_widths

   !> Elongation of the cable at theta = alpha: b alpha for Eq. (1), else that of a straight cable
   !> [m].
   pure real(wp) function elongation_at_alpha(law, h, b) result(elongation)
      character(*), intent(in) :: law
      real(wp), intent(in) :: h
      !! half height [m]
      real(wp), intent(in) :: b
      !! half width [m]
      real(wp) :: alpha

      alpha = atan2(b, h)
      elongation = b*alpha
      if (law == 'truss') then
         elongation = sqrt(4*h**2 + 2*b**2*(1 - cos(alpha)) + 4*h*b*sin(alpha)) - 2*h
      end if
   end function elongation_at_alpha

   subroutine fill_tendon(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%cable%hardening = real_of(case%values, 'cable', 'hardening')
      call get_real(case%values, 'cable', 'eta_y', case%cable%eta_y)
      call get_real(case%values, 'cable', 'rupture_strain', case%cable%rupture_strain)
      call get_real(case%values, 'cable', 'length', case%cable%length)
      if (has_key(case%values, 'cable', 'strands')) case%cable%area = real_of(case%values, &
         'cable', 'strands')*real_of(case%values, 'cable', 'strand_area')
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
