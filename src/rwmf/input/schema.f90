!> The one table of groups and keys of a case file.
!>
!> Validation, messages, the namelist reference and the typing of the Python package are all made
!> from it.
module rwmf_input_schema
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: key_t, all_keys, keys_of, group_names, find_key, schema_text, belongs_to, pulse_kinds

   character(*), parameter :: velocity_kinds = &
      'one_sine one_cosine sine type_c mavroeidis_papageorgiou'
   !! pulses with a velocity amplitude
   character(*), parameter :: pulse_kinds = velocity_kinds//' ricker ricker_antisymmetric'
   !! kinds of motion that are pulses
   character(*), parameter :: all_methods = 'auto adams bdf erk54 dop853 extrapolation fast'
   !! integrators; `rwmf_integrator_factory` says what 'auto' is

   character(*), parameter :: any_real = 'any finite number'
   character(*), parameter :: positive = '> 0'
   character(*), parameter :: below_one = '[0, 1)'
   character(*), parameter :: not_negative = '>= 0'

   !> One key. Texts are padded with blanks.
   type :: key_t
      character(12) :: group
      character(20) :: key
      !! as the documentation spells it; letters may be small or capital in a case
      character(9) :: type
      !! 'real', 'real list', 'integer', 'logical', 'choice' or 'text'
      character(6) :: unit
      !! of a number; '-' for a ratio, '' for texts and counts
      character(16) :: default
      !! value when it is not given, or the name of the key of the group that has it; '' for none
      logical :: is_required
      !! must be given whenever the group is (conditions on other groups: rwmf_case_rules)
      character(104) :: allowed
      !! of a number: `> 0`, `>= 0` or an interval; of a choice: its names
      character(90) :: help
      character(88) :: kinds
      !! of `&motion`: the kinds that the key belongs to; '' for all
   end type key_t

contains

   !> Every key, in the order of the documentation.
   pure function all_keys() result(keys)
      type(key_t), allocatable :: keys(:)

      keys = [structure_keys(), motion_keys(), run_keys()]
   end function all_keys

   !> Keys of the structure: wall, frame, cable, impact.
   pure function structure_keys() result(keys)
      type(key_t), allocatable :: keys(:)

      keys = [ &
         required('wall', 'h', 'real', 'm', positive, 'half height of the wall'), &
         required('wall', 'b', 'real', 'm', positive, 'half width of the wall'), &
         optional_key('wall', 'm_w', 'real', 'kg', '', positive, &
            'mass of the wall; given: forces are reported in N as well'), &
         optional_key('wall', 'base', 'choice', '', 'rocking', 'rocking pinned', &
            'on two corners with impacts, or hinged in the middle'), &
         optional_key('frame', 'T_s', 'real', 's', '', positive, &
            'undamped period; required without &spectrum'), &
         optional_key('frame', 'gamma', 'real', '-', '', not_negative, &
            'mass ratio m_s/m_w; required with &wall, refused without'), &
         required('frame', 'xi_s', 'real', '-', not_negative, 'viscous damping ratio'), &
         required('storeys', 'm_over_m_w', 'real list', '-', positive, &
            'mass of each floor over m_w (no wall: over any mass), from the ground up'), &
         required('storeys', 'k_over_m_w', 'real list', '1/s2', positive, &
            'stiffness of the storey below each floor over the same mass'), &
         required('storeys', 'height', 'real list', 'm', positive, &
            'height of each storey; with &wall their sum is 2h'), &
         optional_key('storeys', 'coupling', 'choice', '', 'reduced', &
            'reduced every_floor full', &
            'roof linked: first mode or all modes; every floor linked: a straight line'), &
         required('link', 'L', 'real', 'm', positive, &
            'length of the link, Eqs (2), (3); absent: infinitely long'), &
         required('damper', 'c_over_m_w', 'real', '1/s', not_negative, &
            'viscous damper under each corner of the base: its constant over m_w'), &
         required('fuse', 'eta_y', 'real', '-', positive, &
            'yield force of the fuse under each corner of the base over m_w g'), &
         required('fuse', 'stroke_y', 'real', 'm', positive, 'stroke at which it yields first'), &
         optional_key('fuse', 'hardening', 'real', '-', '0.0', below_one, &
            'stiffness of the yielding fuse over its elastic one'), &
         optional_key('yielding', 'u_y', 'real', 'm', '', positive, &
            'displacement at which the frame yields first, the same for all periods of a ' &
            //'spectrum'), &
         optional_key('yielding', 'f_y_over_m_s_g', 'real', '-', '', positive, &
            'or its yield force over the weight of its mass: u_y = f_y_over_m_s_g g/omega_s**2'), &
         optional_key('yielding', 'storey_u_y', 'real list', 'm', '', positive, &
            'or, &storeys full and every_floor, u_i - u_(i-1) at which storeys yield: one for ' &
            //'all or one each'), &
         optional_key('yielding', 'hardening', 'real', '-', '0.0', below_one, &
            'stiffness of the yielding frame over its elastic one'), &
         optional_key('yielding', 'law', 'choice', '', 'elastic_plastic', &
            'elastic_plastic bouc_wen', &
            'bilinear with kinematic hardening, or a smooth hysteresis'), &
         optional_key('yielding', 'exponent', 'real', '-', '2.0', '[1, 1000]', &
            'sharpness n of the knee; bouc_wen only'), &
         optional_key('yielding', 'beta', 'real', '-', '0.5', '[0.5, 1]', &
            'of Bouc and Wen, with gamma = 1 - beta; bouc_wen only'), &
         required('inerter', 'inertance_over_m_w', 'real', '-', not_negative, &
            'inerter under each corner of the base: its inertance over m_w'), &
         required('cable', 'eta_0', 'real', '-', not_negative, 'P(0)/(m_w g), Eq. (1)'), &
         optional_key('cable', 'eta_alpha', 'real', '-', 'eta_0', not_negative, &
            'P(alpha)/(m_w g)'), &
         optional_key('cable', 'law', 'choice', '', 'linear', 'linear truss', &
            'Eq. (1), or the exact length of the straight cable'), &
         optional_key('cable', 'eta_y', 'real', '-', '', positive, &
            'P/(m_w g) at which the tendon yields; absent: it stays elastic'), &
         optional_key('cable', 'hardening', 'real', '-', '0.0', below_one, &
            'stiffness of the yielding tendon over its elastic one'), &
         optional_key('cable', 'rupture_strain', 'real', '-', '', positive, &
            'strain at which it breaks, that of the prestress included; absent: never'), &
         optional_key('impact', 'rule', 'choice', '', 'constant', &
            'constant housner coupled table', &
            'constant: exactly one of e and r; table: e by speed; the others set e themselves'), &
         optional_key('impact', 'e', 'real', '-', '', '[0, 1]', &
            'factor on the angular velocity at impact'), &
         optional_key('impact', 'r', 'real', '-', '', '[0, 1]', 'e squared'), &
         optional_key('impact', 'table_theta_dot', 'real list', 'rad/s', '', not_negative, &
            'angular velocities before impact, increasing; required for rule table'), &
         optional_key('impact', 'table_e', 'real list', '-', '', '[0, 1]', &
            'e at them: linear between, constant beyond; required for rule table')]
   end function structure_keys

   !> Keys of the excitation.
   pure function motion_keys() result(keys)
      type(key_t), allocatable :: keys(:)
      character(*), parameter :: kinds = 'none '//pulse_kinds//' record'

      keys = [ &
         required('motion', 'kind', 'choice', '', kinds, &
            'one_sine: Eq. (16), one_cosine: Eq. (17), sine: cycles; all: docs/pulses.md'), &
         of_kind(pulse_kinds, 'a_max_g', 'real', '-', '', any_real, &
            'largest acceleration over g; exactly one of a_max_g and v_p'), &
         of_kind(velocity_kinds, 'v_p', 'real', 'm/s', '', any_real, &
            'velocity amplitude of Eqs (16), (17) and docs/pulses.md; no Ricker pulse has it'), &
         of_kind(pulse_kinds, 'omega_p', 'real', 'rad/s', '', positive, &
            'angular frequency; exactly one of omega_p and T_p'), &
         of_kind(pulse_kinds, 'T_p', 'real', 's', '', positive, 'period of the pulse'), &
         of_kind('sine', 'cycles', 'real', '-', '1.0', positive, 'number of cycles'), &
         of_kind('type_c', 'n_pulses', 'integer', '', '1', '>= 1', 'n of the pulse C_n'), &
         of_kind('mavroeidis_papageorgiou', 'gamma_p', 'real', '-', '', '(1, 1000]', &
            'gamma, the number of cycles in the envelope; required for this kind'), &
         of_kind('mavroeidis_papageorgiou', 'nu', 'real', 'rad', '0.0', any_real, &
            'phase of the carrier: 0 symmetric, pi/2 antisymmetric velocity'), &
         of_kind(pulse_kinds, 't_0', 'real', 's', '0.0', any_real, 'start of the pulse'), &
         of_kind('record', 'file', 'text', '', '', '', &
            'path, relative to the case file; required for a record'), &
         of_kind('record', 'dt', 'real', 's', '', positive, &
            'sampling interval; required for one column, refused for two columns and AT2'), &
         of_kind('record', 'unit', 'choice', '', '', 'g m/s2 cm/s2', &
            'of the accelerations; required but for AT2, where it is refused'), &
         of_kind('record', 'scale', 'real', '-', '1.0', any_real, 'factor on the accelerations'), &
         optional_key('vertical', 'ratio', 'real', '-', '', any_real, &
            'vertical over horizontal ground acceleration; exactly one of ratio and file'), &
         optional_key('vertical', 'file', 'text', '', '', '', &
            'record of the vertical acceleration (positive upward), relative to the case file'), &
         optional_key('vertical', 'dt', 'real', 's', '', positive, &
            'sampling interval; required for one column, refused for two columns and AT2'), &
         optional_key('vertical', 'unit', 'choice', '', '', 'g m/s2 cm/s2', &
            'of the accelerations; required but for AT2, where it is refused'), &
         optional_key('vertical', 'scale', 'real', '-', '1.0', any_real, &
            'factor on the record'), &
         optional_key('initial', 'theta_over_alpha', 'real', '-', '0.0', any_real, &
            'rotation over slenderness; within the overturning angle'), &
         optional_key('initial', 'theta_dot', 'real', 'rad/s', '0.0', any_real, &
            'angular velocity')]
   end function motion_keys

   !> Keys of the model and of the computation.
   pure function run_keys() result(keys)
      type(key_t), allocatable :: keys(:)

      keys = [ &
         optional_key('model', 'formulation', 'choice', '', 'published', &
            'published symmetric exact', 'Eq. (15) as printed, or one that conserves energy'), &
         optional_key('model', 'g', 'real', 'm/s2', '9.81', positive, 'gravity'), &
         optional_key('model', 'overturning_angle', 'real', 'rad', 'pi/2', '(0, pi/2]', &
            'rotation at which the wall counts as overturned'), &
         optional_key('solver', 'method', 'choice', '', 'auto', all_methods, &
            'integrator; auto: fast for the ordinates of a spectrum, adams for other runs'), &
         optional_key('solver', 'rtol', 'real', '-', '1.0e-9', '(0, 0.1]', 'relative tolerance'), &
         optional_key('solver', 'accuracy', 'real', '-', '', '(0, 0.1]', &
            'relative error of u_s_max (no frame: theta_max) asked instead of rtol'), &
         optional_key('solver', 'verify', 'logical', '', '.false.', '', &
            'estimate error and sensitivity by further runs'), &
         optional_key('solver', 'atol', 'real', 'rad', '', positive, &
            'absolute tolerance (bare frame: m); absent: from rtol and the response'), &
         optional_key('solver', 't_end', 'real', 's', '', not_negative, &
            'end of the simulation; required but for a record: its last sample'), &
         optional_key('solver', 'max_steps', 'integer', '', '50000000', '>= 1', &
            'most steps of one simulation'), &
         optional_key('output', 'dt', 'real', 's', '', positive, &
            'interval of the history; absent: no history'), &
         optional_key('output', 'energy', 'logical', '', '.false.', '', &
            'energy ledger: its parts in the end, with dt in every row'), &
         optional_key('output', 'reactions', 'logical', '', '.false.', '', &
            'reactions of the base, friction demand, base shear, drifts: extrema, with dt rows'), &
         optional_key('output', 'friction_limit', 'real', '-', '', positive, &
            'coefficient of friction: whether and when the friction demand exceeds it'), &
         optional_key('spectrum', 'T_s', 'real list', 's', '', positive, &
            'periods one by one; otherwise T_s_min, T_s_max and n are required'), &
         optional_key('spectrum', 'T_s_min', 'real', 's', '', positive, 'shortest period'), &
         optional_key('spectrum', 'T_s_max', 'real', 's', '', positive, 'longest period'), &
         optional_key('spectrum', 'n', 'integer', '', '', '[1, 1000000]', &
            'number of periods, both ends included'), &
         optional_key('spectrum', 'spacing', 'choice', '', 'linear', 'linear log', &
            'spacing of the periods'), &
         optional_key('spectrum', 'gamma', 'real list', '-', '', not_negative, &
            'mass ratios; absent: that of &frame'), &
         optional_key('spectrum', 'b', 'real list', 'm', '', positive, &
            'half widths; absent: that of &wall')]
   end function run_keys

   !> A key that must be given.
   pure type(key_t) function required(group, key, type, unit, allowed, help)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: type
      character(*), intent(in) :: unit
      character(*), intent(in) :: allowed
      character(*), intent(in) :: help

      required = key_t(group, key, type, unit, '', .true., allowed, help, '')
   end function required

   !> A key that may be left out.
   pure type(key_t) function optional_key(group, key, type, unit, default, allowed, help)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: type
      character(*), intent(in) :: unit
      character(*), intent(in) :: default
      character(*), intent(in) :: allowed
      character(*), intent(in) :: help

      optional_key = key_t(group, key, type, unit, default, .false., allowed, help, '')
   end function optional_key

   !> A key of some kinds of motion.
   pure type(key_t) function of_kind(kinds, key, type, unit, default, allowed, help)
      character(*), intent(in) :: kinds
      character(*), intent(in) :: key
      character(*), intent(in) :: type
      character(*), intent(in) :: unit
      character(*), intent(in) :: default
      character(*), intent(in) :: allowed
      character(*), intent(in) :: help

      of_kind = key_t('motion', key, type, unit, default, .false., allowed, help, kinds)
   end function of_kind

   !> The keys of a group.
   pure function keys_of(group) result(keys)
      character(*), intent(in) :: group
      !! name in small letters
      type(key_t), allocatable :: keys(:)
      type(key_t), allocatable :: all(:)
      integer :: i
      integer :: n

      ! Most of the work is to write the table: only the part in which the group stands.
      all = structure_keys()
      if (.not. any(all%group == group)) all = motion_keys()
      if (.not. any(all%group == group)) all = run_keys()
      n = 0
      do i = 1, size(all)
         if (all(i)%group /= group) cycle
         n = n + 1
         all(n) = all(i)
      end do
      keys = all(:n)
   end function keys_of

   !> The groups in the order of the documentation.
   pure function group_names() result(names)
      character(12), allocatable :: names(:)
      type(key_t), allocatable :: keys(:)
      integer :: i

      keys = all_keys()
      names = [keys(1)%group]
      do i = 2, size(keys)
         if (keys(i)%group /= keys(i - 1)%group) names = [names, keys(i)%group]
      end do
   end function group_names

   !> Place of a key in a list of keys, 0 when it is not there.
   pure integer function find_key(keys, name)
      type(key_t), intent(in) :: keys(:)
      character(*), intent(in) :: name
      !! letters may be small or capital

      do find_key = size(keys), 1, -1
         if (to_lower(trim(keys(find_key)%key)) == to_lower(name)) exit
      end do
   end function find_key

   !> Does the key belong to this kind of motion? Always true in other groups.
   pure logical function belongs_to(key, kind)
      type(key_t), intent(in) :: key
      character(*), intent(in) :: kind

      belongs_to = key%kinds == '' .or. index(' '//key%kinds//' ', ' '//kind//' ') > 0
   end function belongs_to

   !> The table as text: group, key, type, unit, default, what is allowed and help, separated by
   !> tabs, one key a line. The default of a required key is 'required', of one without 'none'.
   pure function schema_text() result(text)
      character(:), allocatable :: text
      character(*), parameter :: tab = achar(9)
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: default
      integer :: i

      keys = all_keys()
      text = ''
      do i = 1, size(keys)
         associate (key => keys(i))
            default = trim(key%default)
            if (default == '') default = trim(merge('required', 'none    ', key%is_required))
            text = text//trim(key%group)//tab//trim(key%key)//tab//trim(key%type)//tab &
               //trim(key%unit)//tab//default//tab//trim(key%allowed)//tab//trim(key%help) &
               //new_line('a')
         end associate
      end do
   end function schema_text

end module rwmf_input_schema
