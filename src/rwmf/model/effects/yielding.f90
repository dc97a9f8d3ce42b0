!> Inelastic frame, `&yielding`: its strength as one spring or storey by storey, its law, and the
!> ductility at collapse.
module rwmf_model_effects_yielding
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, frame_mass, &
      frame_travel, model_t, sprung_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_energy, bouc_wen_sizes, &
      prepare_bouc_wen
   use rwmf_model_hysteresis_spring_laws, only: new_spring
   use rwmf_model_hysteresis_spring_set, only: add_springs, yielding_energy
   use rwmf_model_hysteresis_storey_springs, only: choose_storey_springs
   use rwmf_model_scene, only: through_link
   use rwmf_problem_case, only: case_t, has_all_modes, has_floors, has_numbers, spring_law_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_equivalent_frame, only: set_single_storey
   use rwmf_problem_frame_strength, only: has_branches, storey_strengths, yield_displacement, &
      storeys_have_strengths
   use rwmf_problem_group_values, only: derive, get_list, get_real, group_values_t, has_group, &
      has_key, real_of, text_of
   use rwmf_problem_key, only: below_one, dimensional, optional_key, positive, usually
   use rwmf_problem_rules, only: check_one_of, fail_group, fail_key
   use rwmf_problem_units, only: mass_of_frame, unit_mass
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: yielding_group, prepare_yielding

contains

   !> Describe the group `&yielding`: its keys and the procedures that check and read them.
   type(case_group_t) function yielding_group() result(group)
      group%name = 'yielding'
      group%needs(1) = 'frame'
      group%reasons(1) = 'the frame is what yields'
      group%keys = [ &
         usually('[1e-4, 3]', optional_key('yielding', 'u_y', 'real', 'm', '', positive, &
            'displacement at which the frame yields first, the same for all periods of a ' &
            //'spectrum')), &
         usually('[0.002, 10]', &
            optional_key('yielding', 'f_y_over_m_s_g', 'real', '-', '', positive, &
            'or its yield force over the weight of its mass: u_y = f_y_over_m_s_g g/omega_s**2')), &
         usually('[1e-4, 0.5]', &
            optional_key('yielding', 'storey_u_y', 'real list', 'm', '', positive, &
            'or, &storeys unless reduced, u_i - u_(i-1) at which storeys yield: one for ' &
            //'all or one each')), &
         usually('[1e3, 1e10]', dimensional('yielding', 'F_y', 'real', 'N', 'f_y_over_m_s_g', '', &
            'or the yield force of a frame without &storeys')), &
         usually('[1e3, 1e10]', &
            dimensional('yielding', 'storey_F_y', 'real list', 'N', 'storey_u_y', '', &
            'or the forces at which storeys yield: one for all or one each')), &
         optional_key('yielding', 'hardening', 'real', '-', '0.0', '(-1, 1)', &
            'stiffness of the yielding frame over its elastic one; < 0: it softens'), &
         optional_key('yielding', 'ultimate', 'real', '-', '', '> 1', &
            'ductility of frame or storey at which it has collapsed, which ends the run'), &
         optional_key('yielding', 'law', 'choice', '', 'elastic_plastic', &
            'elastic_plastic friction flag peak_oriented pinched bouc_wen', &
            'bilinear, slipping, self-centring, two that lose strength, or a smooth hysteresis'), &
         optional_key('yielding', 'breakaway', 'real', '-', '1.0', '[1, 10]', &
            'force at which friction lets go over that at which it slips; friction only'), &
         optional_key('yielding', 'flag_height', 'real', '-', '1.0', '(0, 1]', &
            'force by which a flag unloads lower, over its yield force; flag only'), &
         optional_key('yielding', 'exponent', 'real', '-', '2.0', '[1, 1000]', &
            'sharpness n of the knee; bouc_wen only'), &
         optional_key('yielding', 'beta', 'real', '-', '0.5', '[0.5, 1]', &
            'of Bouc and Wen, with gamma = 1 - beta; bouc_wen only'), &
         optional_key('yielding', 'cap', 'real', '-', '', '> 1', &
            'ductility at the largest force; required by peak_oriented, pinched'), &
         optional_key('yielding', 'post_cap', 'real', '-', '', positive, &
            'ductility from there to zero force; required by peak_oriented, pinched'), &
         optional_key('yielding', 'residual', 'real', '-', '0.0', below_one, &
            'strength that remains over that at first yield; peak_oriented, pinched'), &
         optional_key('yielding', 'lambda', 'real list', '-', '', positive, &
            'capacity E_t/(F_y u_y) of strength, cap, reloading, unloading: one, or four'), &
         optional_key('yielding', 'lambda_exponent', 'real list', '-', '1.0', '[1, 10]', &
            'exponents c of the wear (E_i/(E_t - sum E_j))**c, as lambda'), &
         optional_key('yielding', 'pinch_force', 'real', '-', '1.0', '(0, 1]', &
            'kappa_F: force at the pinching point over that on the straight way; pinched only'), &
         optional_key('yielding', 'pinch_displacement', 'real', '-', '1.0', '[0, 1]', &
            'kappa_D: part of the plastic displacement left before that point; pinched only')]
      group%derive => derive_yielding
      group%check => check_yielding
      group%fill => fill_yielding
      group%is_present => has_yielding
      group%add_states => add_hysteretic_states
      group%add_events => add_yielding_events
      group%no_element = "&yielding: the frame is the host's"
   end function yielding_group

   !> Derive yield forces over the weight of the frame, and those of storeys over their stiffness.
   subroutine derive_yielding(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: force(:)
      real(wp), allocatable :: k(:)
      !! stiffnesses over the unit of mass [1/s2]
      real(wp), allocatable :: m(:)
      !! masses over the same unit

      if (has_key(values, 'yielding', 'F_y')) then
         if (has_group(values, 'storeys')) then
            call fail_key(values, 'yielding', 'F_y', 'must not be given with &storeys: ' &
               //"storey_F_y says the forces of storeys (coupling = 'full', 'springs' or " &
               //"'every_floor'), u_y the displacement of the roof ('reduced', 'every_floor')", &
               error)
         else if (mass_of_frame(values) > 0) then
            call derive(values, 'yielding', 'f_y_over_m_s_g', 'F_y', [real_of(values, 'yielding', &
               'F_y')/(mass_of_frame(values)*real_of(values, 'model', 'g'))])
         else
            call fail_key(values, 'yielding', 'F_y', 'needs the mass of the frame: &frame m_s ' &
               //'(with &wall m_s or gamma) must be given, > 0', error)
         end if
      end if
      if (allocated(error) .or. .not. has_key(values, 'yielding', 'storey_F_y')) return
      call get_list(values, 'yielding', 'storey_F_y', force)
      call get_list(values, 'storeys', 'k_over_m_w', k)
      if (.not. (allocated(k) .and. unit_mass(values) > 0)) then
         call fail_key(values, 'yielding', 'storey_F_y', 'needs the stiffness of the storeys in ' &
            //'N/m: k and m of &storeys, or k_over_m_w beside a wall with a mass', error)
         return
      end if
      call get_list(values, 'storeys', 'm_over_m_w', m)
      ! the rules of &storeys refuse lists of different lengths
      if (size(k) /= size(m)) return
      if (size(force) == 1) force = spread(force(1), 1, size(k))
      if (size(force) == size(k)) then
         call derive(values, 'yielding', 'storey_u_y', 'storey_F_y', force/(k*unit_mass(values)))
      else
         call fail_key(values, 'yielding', 'storey_F_y', 'has ' &
            //trim(integer_to_text(size(force)))//' values, must have one for all storeys or ' &
            //'one for each of the '//trim(integer_to_text(size(k))), error)
      end if
   end subroutine derive_yielding

   subroutine check_yielding(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_group(values, 'base') .and. (has_group(values, 'storeys') .or. has_key(values, &
          'yielding', 'ultimate') .or. text_of(values, 'yielding', 'law') == 'bouc_wen')) then
         call fail_group(values, 'yielding', 'must not be given with &base beside &storeys, ' &
            //"ultimate or law = 'bouc_wen'", error)
         return
      end if
      call check_law(values, error)
      if (.not. allocated(error)) call check_keys_of_law(values, error)
      if (.not. allocated(error)) call check_softening(values, error)
      if (.not. allocated(error)) call check_mass(values, error)
      if (allocated(error)) return
      if (yields_by_storey(values)) then
         call check_storey_strengths(values, error)
      else
         call check_one_of(values, 'yielding', 'u_y', 'f_y_over_m_s_g', 'as the strength', error)
      end if
      if (.not. allocated(error)) call check_rotation(values, error)
   end subroutine check_yielding

   !> Check that smooth storeys with all modes start at zero; their initial loading is undefined.
   subroutine check_law(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: beside

      if (text_of(values, 'yielding', 'law') /= 'bouc_wen') return
      if (abs(real_of(values, 'initial', 'theta_over_alpha')) <= 0) return
      if (has_modes(values)) then
         beside = "&storeys coupling = '"//trim(coupling(values))//"'"
      else if (has_group(values, 'bending')) then
         beside = '&bending'
      else
         return
      end if
      call fail_key(values, 'initial', 'theta_over_alpha', "must be 0 with &yielding law = " &
         //"'bouc_wen' and "//beside//', whose hysteresis begins at zero', error)
   end subroutine check_law

   !> Check that keys of a law are given only with it, and that its required keys are present.
   subroutine check_keys_of_law(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(18), parameter :: keys(11) = [character(18) :: 'cap', 'post_cap', 'exponent', &
         'beta', 'breakaway', 'flag_height', 'residual', 'lambda', 'lambda_exponent', &
         'pinch_force', 'pinch_displacement']
      character(28), parameter :: degrading = "'peak_oriented' or 'pinched'"
      character(28), parameter :: laws(size(keys)) = [character(28) :: degrading, degrading, &
         "'bouc_wen'", "'bouc_wen'", "'friction'", "'flag'", degrading, degrading, degrading, &
         "'pinched'", "'pinched'"]
      logical :: fits
      integer :: i

      do i = 1, size(keys)
         fits = index(laws(i), "'"//text_of(values, 'yielding', 'law')//"'") > 0
         if (fits .and. i <= 2 .and. .not. has_key(values, 'yielding', trim(keys(i)))) then
            call fail_group(values, 'yielding', 'the key '//trim(keys(i))//' is missing (a ' &
               //"ductility): must be given with law = '"//text_of(values, 'yielding', 'law') &
               //"', a number > 0", error)
         else if (has_key(values, 'yielding', trim(keys(i))) .and. .not. fits) then
            call fail_key(values, 'yielding', trim(keys(i)), 'belongs to law = '//trim(laws(i)), &
               error)
         end if
         if (allocated(error)) return
      end do
      call check_four(values, 'lambda', error)
      if (.not. allocated(error)) call check_four(values, 'lambda_exponent', error)
   end subroutine check_keys_of_law

   !> Check that a list of wear parameters has one number for all modes of wear, or four.
   subroutine check_four(values, key, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: key
      !! name of the key
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: list(:)

      call get_list(values, 'yielding', key, list)
      if (.not. allocated(list)) return
      if (size(list) == 1 .or. size(list) == 4) return
      call fail_key(values, 'yielding', key, 'has '//trim(integer_to_text(size(list))) &
         //' values, must have one for all or four (strength, cap, reloading, unloading)', error)
   end subroutine check_four

   !> Check that a softening law has an event that ends the run, because a softening frame
   !> collapses. Laws that lose strength soften beyond their cap; the others cannot soften.
   subroutine check_softening(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (real_of(values, 'yielding', 'hardening') >= 0) return
      if (all(text_of(values, 'yielding', 'law') /= [character(15) :: 'elastic_plastic', &
                                                      'friction'])) then
         call fail_key(values, 'yielding', 'hardening', "must be >= 0 with law = '" &
            //text_of(values, 'yielding', 'law')//"'; elastic_plastic and friction may soften, " &
            //'peak_oriented and pinched do beyond their cap', error)
      else if (.not. (has_key(values, 'yielding', 'ultimate') .or. has_group(values, &
                      'p_delta'))) then
         call fail_key(values, 'yielding', 'hardening', 'needs the key ultimate (or &p_delta), ' &
            //'at which the run ends: a frame that softens runs away', error)
      end if
   end subroutine check_softening

   !> Coupling of the storeys to the wall; '' without storeys.
   pure function coupling(values)
      type(group_values_t), intent(in) :: values
      character(11) :: coupling

      coupling = ''
      if (has_group(values, 'storeys')) coupling = text_of(values, 'storeys', 'coupling')
   end function coupling

   !> True if the storeys move independently (`has_all_modes`).
   pure logical function has_modes(values)
      type(group_values_t), intent(in) :: values

      has_modes = coupling(values) == 'full' .or. coupling(values) == 'springs'
   end function has_modes

   !> Check that the frame has mass: its springs follow from its period and mass.
   subroutine check_mass(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(8), parameter :: places(2) = [character(8) :: 'frame', 'spectrum']
      real(wp), allocatable :: gamma(:)
      integer :: i

      do i = 1, size(places)
         call get_list(values, trim(places(i)), 'gamma', gamma)
         if (.not. allocated(gamma)) cycle
         if (all(gamma > 0)) cycle
         call fail_key(values, trim(places(i)), 'gamma', 'must be > 0 with &yielding (a frame ' &
            //'without mass has no stiffness, and nothing yields)', error)
         return
      end do
   end subroutine check_mass

   !> Return whether the strength is given storey by storey, or must be.
   pure logical function yields_by_storey(values)
      type(group_values_t), intent(in) :: values

      yields_by_storey = has_key(values, 'yielding', 'storey_u_y') .or. has_modes(values)
   end function yields_by_storey

   !> Check the frames that allow yielding storeys, and the number of strengths.
   subroutine check_storey_strengths(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(14), parameter :: keys(2) = [character(14) :: 'u_y', 'f_y_over_m_s_g']
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: u_y(:)
      integer :: i

      if (.not. has_modes(values) .and. coupling(values) /= 'every_floor') then
         call fail_key(values, 'yielding', 'storey_u_y', "must not be given without &storeys " &
            //"coupling = 'full', 'springs' or 'every_floor': other frames yield as one spring, " &
            //'u_y', error)
         return
      end if
      do i = 1, size(keys)
         if (.not. has_key(values, 'yielding', trim(keys(i)))) cycle
         call fail_key(values, 'yielding', trim(keys(i)), "must not be given where the storeys " &
            //"yield one by one (&storeys coupling = 'full' or 'springs', or storey_u_y): " &
            //'give storey_u_y instead', error)
         return
      end do
      call get_list(values, 'storeys', 'm_over_m_w', m)
      call get_list(values, 'yielding', 'storey_u_y', u_y)
      if (.not. allocated(u_y)) then
         call fail_group(values, 'yielding', "the key storey_u_y is missing (u_i - u_(i-1) at " &
            //"first yield): must be given with &storeys coupling = '"//trim(coupling(values)) &
            //"', numbers > 0 [m]", error)
      else if (size(u_y) /= 1 .and. size(u_y) /= size(m)) then
         call fail_key(values, 'yielding', 'storey_u_y', 'has ' &
            //trim(integer_to_text(size(u_y)))//' values, must have one for all storeys or one ' &
            //'for each of the '//trim(integer_to_text(size(m)))//' of m_over_m_w', error)
      else if (text_of(values, 'yielding', 'law') == 'bouc_wen' &
               .and. .not. (has_modes(values) .or. has_group(values, 'bending'))) then
         call fail_key(values, 'yielding', 'law', "must not be 'bouc_wen' with storey_u_y and " &
            //"&storeys coupling = 'every_floor' beside a rigid wall; 'full' and 'springs' allow " &
            //'all laws', error)
      end if
   end subroutine check_storey_strengths

   !> Check the range of rotations with a short link. Its frame displacement reverses at a large
   !> rotation, and the frame's spring is defined only while both grow together.
   subroutine check_rotation(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: limit

      if (.not. has_group(values, 'link')) return
      if (text_of(values, 'model', 'formulation') /= 'exact' &
          .and. text_of(values, 'wall', 'base') /= 'pinned') return
      ! with all modes, storeys do not follow the rotation
      if (has_modes(values)) return
      limit = turning_rotation(real_of(values, 'wall', 'h'), real_of(values, 'link', 'L'))
      if (real_of(values, 'model', 'overturning_angle') <= limit) return
      call fail_key(values, 'link', 'L', 'needs &model overturning_angle <= ' &
         //trim(real_to_text(limit))//' rad with &yielding: at larger rotations the frame turns ' &
         //'back while the wall goes on', error)
   end subroutine check_rotation

   !> Rotation to the left at which the displacement of the link's far end is largest [rad].
   !>
   !> Bisection on the slope of u = 2h sin(phi) - (L - sqrt(L**2 - v**2)), v = 2h (1 - cos(phi)).
   pure real(wp) function turning_rotation(h, L) result(low)
      real(wp), intent(in) :: h
      !! half height [m]
      real(wp), intent(in) :: L
      !! length of the link [m]
      type(bracket_t) :: bracket
      real(wp) :: v
      logical :: grows

      bracket = bracket_between(0.0_wp, pi/2)
      do while (bracket%is_open)
         associate (phi => bracket%middle)
            v = 4*h*sin(phi/2)**2
            grows = v < L .and. cos(phi)*sqrt(max(0.0_wp, L**2 - v**2)) > v*sin(phi)
         end associate
         call narrow(bracket, is_beyond=.not. grows)
      end do
      low = bracket%low
   end function turning_rotation

   subroutine fill_yielding(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%yielding)
      call get_real(case%values, 'yielding', 'u_y', case%yielding%u_y)
      call get_real(case%values, 'yielding', 'f_y_over_m_s_g', case%yielding%f_y_over_m_s_g)
      call get_list(case%values, 'yielding', 'storey_u_y', case%yielding%storey_u_y)
      case%yielding%hardening = real_of(case%values, 'yielding', 'hardening')
      call get_real(case%values, 'yielding', 'ultimate', case%yielding%ultimate)
      call fill_law(case%values, case%yielding%law)
      if (has_group(case%values, 'bending')) call yield_by_storey(case, error)
   end subroutine fill_yielding

   !> Let the storeys of a frame beside a bending wall yield one by one, and a single mass as one
   !> storey. A strength at the roof is that of all storeys at equal drifts. Storeys that follow one
   !> mode yield together.
   subroutine yield_by_storey(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: u_y

      if (allocated(case%yielding%storey_u_y)) return
      ! the strength may follow the period (`storey_strengths`)
      u_y = 0
      if (allocated(case%yielding%u_y)) u_y = case%yielding%u_y
      if (.not. has_floors(case)) then
         case%yielding%storey_u_y = [u_y]
         call set_single_storey(case, error)
      else if (case%frame%coupling == 'every_floor') then
         associate (height => case%frame%floors%height)
            case%yielding%storey_u_y = u_y*(height/sum(height))
         end associate
      end if
   end subroutine yield_by_storey

   !> Read the hysteresis law.
   subroutine fill_law(values, law)
      type(group_values_t), intent(in) :: values
      type(spring_law_t), intent(inout) :: law
      real(wp), allocatable :: list(:)

      law%name = text_of(values, 'yielding', 'law')
      law%exponent = real_of(values, 'yielding', 'exponent')
      law%beta = real_of(values, 'yielding', 'beta')
      law%breakaway = real_of(values, 'yielding', 'breakaway')
      law%flag_height = real_of(values, 'yielding', 'flag_height')
      if (has_key(values, 'yielding', 'cap')) law%cap = real_of(values, 'yielding', 'cap')
      if (has_key(values, 'yielding', 'post_cap')) law%post_cap = real_of(values, 'yielding', &
         'post_cap')
      law%residual = real_of(values, 'yielding', 'residual')
      call get_list(values, 'yielding', 'lambda', list)
      if (allocated(list)) law%lambda = spread_out(list)
      call get_list(values, 'yielding', 'lambda_exponent', list)
      if (allocated(list)) law%lambda_exponent = spread_out(list)
      law%pinch_force = real_of(values, 'yielding', 'pinch_force')
      law%pinch_displacement = real_of(values, 'yielding', 'pinch_displacement')
   end subroutine fill_law

   !> Expand one number to four, or copy four.
   pure function spread_out(list) result(four)
      real(wp), intent(in) :: list(:)
      !! (1 or 4)
      real(wp) :: four(4)

      four = list(1)
      if (size(list) == size(four)) four = list
   end function spread_out

   pure logical function has_yielding(case)
      type(case_t), intent(in) :: case

      has_yielding = allocated(case%yielding)
   end function has_yielding

   !> Prepare the contribution of the yielding frame. Springs on straight lines use the loop of the
   !> frame; the smooth law has a loop. Storeys that yield one by one belong to `&storeys`.
   subroutine prepare_yielding(case, equation, yielding)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: yielding

      yielding%is_present = has_yielding(case)
      if (.not. yielding%is_present) return
      if (allocated(case%yielding%ultimate)) call prepare_collapse(case, equation, yielding)
      if (equation%floors%yields) return
      if (has_numbers(case, 'bending')) then
         call prepare_roof(case, equation, yielding)
      else if (has_branches(case)) then
         call add_springs(frame_springs(case, equation%p%omega_squared), &
            case%model%overturning_angle, equation)
         yielding%frame_energy => yielding_energy
      else
         call prepare_bouc_wen(case, equation)
         yielding%law = equation%hysteresis%factors
         yielding%frame_energy => bouc_wen_energy
         yielding%sizes => bouc_wen_sizes
      end if
      if (has_branches(case)) return
      yielding%n_coef = 4
      yielding%coefficients => bouc_wen_coefficients
      yielding%acts = through_link
      yielding%states = 1
   end subroutine prepare_yielding

   !> Create the spring of the frame, or one for each storey if the floors are linked to the wall
   !> along a straight line. All of them follow the roof.
   function frame_springs(case, stiffness) result(springs)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: stiffness
      !! stiffness of the frame over m_s [1/s2]
      type(sprung_t), allocatable :: springs(:)
      real(wp), allocatable :: shares(:)
      !! (springs) shares of the stiffness [-]
      real(wp), allocatable :: u_y(:)
      !! (springs) displacement of the roof at first yield of each [m]
      integer :: i

      shares = [1.0_wp]
      if (.not. storeys_have_strengths(case)) then
         u_y = [yield_displacement(case)]
      else
         associate (floors => case%frame%floors)
            shares = floors%k*floors%height**2
            shares = shares/sum(shares)
            u_y = storey_strengths(case)*sum(floors%height)/floors%height
         end associate
      end if
      allocate (springs(size(shares)))
      do i = 1, size(shares)
         springs(i) = sprung_t(new_spring(stiffness*shares(i), stiffness*shares(i)*u_y(i), &
            case%yielding%hardening, law=case%yielding%law), share=shares(i))
      end do
   end function frame_springs

   !> Let the frame beside a bending wall yield as one spring at the roof.
   subroutine prepare_roof(case, equation, yielding)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(inout) :: yielding

      equation%floors%n_storeys = 1
      call choose_storey_springs(case, [frame_mass(equation)*equation%p%omega_squared], equation)
      equation%state%frame_slope = equation%state%storey_branches(1)%slope/frame_mass(equation)
      if (.not. allocated(equation%floors%laws)) return
      equation%floors%laws%place = equation%scene%n + 1
      yielding%law = equation%floors%laws(1)%factors
      yielding%sizes => smooth_sizes
   end subroutine prepare_roof

   !> Estimate the size of the state of this spring: u/u_y, at most 1.
   subroutine smooth_sizes(effect, equation, size_guess, sizes)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! of theta and theta' [rad], [rad/s]
      real(wp), intent(out) :: sizes(:)
      !! of z [-]

      sizes = min(1.0_wp, frame_travel(equation)*size_guess(1)/equation%floors%laws%u_y)
   end subroutine smooth_sizes

   !> Set the displacements at which frame or storeys collapse. If the storeys are linked along a
   !> straight line, the weakest storey determines that of the roof.
   subroutine prepare_collapse(case, equation, yielding)
      type(case_t), intent(in) :: case
      !! case with `&yielding ultimate`
      type(equation_t), intent(in) :: equation
      type(contribution_t), intent(inout) :: yielding
      real(wp), allocatable :: u_y(:)
      !! displacement of the frame or of each storey at first yield [m]

      if (.not. allocated(case%yielding%storey_u_y)) then
         u_y = [yield_displacement(case)]
      else
         u_y = storey_strengths(case)
         associate (height => case%frame%floors%height)
            if (equation%floors%n_storeys == 0) u_y = [sum(height)*minval(u_y/height)]
         end associate
      end if
      yielding%drifts = size(u_y)
      yielding%constants = 1/(case%yielding%ultimate*u_y)
      yielding%put_drifts => ductilities
   end subroutine prepare_collapse

   !> Ductilities over the ultimate ductility, and their rates.
   subroutine ductilities(effect, equation, y, ratio, rate)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: ratio(:)
      real(wp), intent(out) :: rate(:)

      call storey_motion(equation, equation%state%side, y, ratio, rate)
      ratio = ratio*effect%constants
      rate = rate*effect%constants
   end subroutine ductilities

   pure subroutine bouc_wen_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      if (allocated(model%floors%laws)) then
         associate (law => model%floors%laws(1), R => model%p%R)
            coef = [law%force_at_z1/R, R/law%u_y, state%storey_signs(1)%lost, law%exponent]
         end associate
         return
      end if
      associate (law => model%hysteresis, R => model%p%R)
         coef = [frame_mass(model)*law%force_at_z1/R, R/law%u_y, state%signs%lost, law%exponent]
      end associate
   end subroutine bouc_wen_coefficients

   !> Add the names of the states z of the smooth law: one for the frame, or one for each storey.
   pure subroutine add_hysteretic_states(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)
      character(name_length), allocatable :: states(:)
      integer :: i

      if (has_branches(case)) return
      if (has_floors(case)) then
         ! states of floors that are linked to a bending wall one by one follow those of its modes
         if (case%frame%coupling == 'every_floor' .and. has_numbers(case, 'bending')) return
      end if
      if (has_all_modes(case)) then
         allocate (states(size(case%frame%floors%m)))
         do i = 1, size(states)
            states(i) = 'z_'//trim(integer_to_text(i))
         end do
      else
         states = [character(name_length) :: 'z']
      end if
      names = [character(name_length) :: names, states]
   end subroutine add_hysteretic_states

   pure subroutine add_yielding_events(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      names = [character(name_length) :: names, 'branch']
      if (allocated(case%yielding%ultimate)) names = [character(name_length) :: names, 'collapsed']
   end subroutine add_yielding_events

end module rwmf_model_effects_yielding
