!> From text to a validated case: defaults, values, rules between groups, messages, description.
program test_case
   use check, only: checks_t
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: dp, i8, pi, wp
   use rwmf_input_describe, only: describe_case
   use rwmf_input_reader, only: read_case_file, read_case_text
   use rwmf_input_schema, only: all_groups, all_keys, names_of, write_schema
   use rwmf_model_effects_numbers, only: effect_count
   use rwmf_problem_case, only: case_t
   use rwmf_problem_key, only: key_t
   use rwmf_text_strings, only: integer_to_text
   implicit none

   character(*), parameter :: nl = new_line('a'), tab = achar(9)
   character(*), parameter :: wall = '&wall h = 2.0, b = 0.5 /'//nl
   character(*), parameter :: frame = '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl
   character(*), parameter :: bare = '&frame T_s = 1.0, xi_s = 0.05 /'//nl
   character(*), parameter :: ends = '&solver t_end = 10.0 /'//nl
   character(*), parameter :: scene = wall//frame//ends
   character(*), parameter :: shaken = '&motion kind = ''sine'', v_p = 1, T_p = 1 /'//nl
   type(checks_t) :: checks

   if (checks%wants('defaults')) call test_defaults()
   if (checks%wants('values')) call test_values()
   if (checks%wants('spectrum')) call test_spectrum()
   if (checks%wants('record')) call test_record()
   if (checks%wants('bad_names')) call test_bad_names()
   if (checks%wants('stiff_springs')) call test_stiff_springs()
   if (checks%wants('bad_values')) call test_bad_values()
   if (checks%wants('bad_scenes')) call test_bad_scenes()
   if (checks%wants('bad_motions')) call test_bad_motions()
   if (checks%wants('bad_runs')) call test_bad_runs()
   if (checks%wants('files')) call test_files()
   if (checks%wants('implied_rules')) call test_implied_rules()
   if (checks%wants('description')) call test_description()
   if (checks%wants('schema')) call test_schema()
   call checks%finish()

contains

   subroutine test_defaults()
      type(case_t) :: case

      call accept(scene//'&cable eta_0 = 2.0 /', case)
      call checks%close_to(case%cable%eta_alpha(1), 2.0_wp, 'eta_alpha is eta_0')
      call checks%that(case%cable%law == 'linear', 'law')
      call checks%that(case%model%formulation == 'exact', 'formulation')
      call checks%close_to(case%model%g, real(9.81_dp, wp), 'g')
      call checks%close_to(case%model%overturning_angle, pi/2, 'overturning angle', &
         rtol=epsilon(1.0_wp) + real(epsilon(1.0_dp), wp))
      call checks%that(case%solver%method == 'auto', 'method')
      call checks%close_to(case%solver%rtol, real(1.0e-9_dp, wp), 'rtol')
      call checks%that(case%solver%max_steps == 50000000, 'max_steps')
      call checks%that(.not. (case%solver%verify .or. allocated(case%solver%atol) &
         .or. allocated(case%solver%accuracy)), 'no atol, no accuracy')
      call checks%that(case%impact%rule == 'coupled', 'rule of impacts')
      call checks%that(.not. (allocated(case%motion) &
         .or. allocated(case%initial) .or. allocated(case%spectrum) &
         .or. allocated(case%record) .or. allocated(case%wall%m_w)), 'what is absent is absent')
   end subroutine test_defaults

   subroutine test_values()
      type(case_t) :: case

      call accept(scene//'&Impact R = 0.81 / &MOTION Kind = "Sine", v_p = -1, t_p = 2, ' &
         //'cycles = 4, t_0 = -1d0 / &model formulation = ''exact'' / ' &
         //'&cable eta_0 = 0, law = ''truss'' / &output dt = 0.1, energy = T / ' &
         //'&initial theta_dot = 1 /', case)
      call checks%that(case%impact%given_as_r, 'r is given')
      call checks%close_to(case%impact%e, sqrt(real(0.81_dp, wp)), 'e is the root of r')
      call checks%that(case%motion%kind == 'sine', 'letters of a choice do not matter')
      call checks%close_to(case%motion%v_p, -1.0_wp, 'v_p')
      call checks%that(.not. allocated(case%motion%a_max_g), 'no a_max_g')
      call checks%close_to(case%motion%T_p, 2.0_wp, 'T_p')
      call checks%close_to(case%motion%cycles, 4.0_wp, 'cycles')
      call checks%close_to(case%motion%t_0, -1.0_wp, 't_0')
      call checks%that(case%cable%law == 'truss', 'law')
      call checks%that(case%output%energy, 'energy')
      call checks%close_to(case%initial%theta_over_alpha, 0.0_wp, 'theta_over_alpha')
      call accept(scene//'&impact rule = ''coupled'' /', case)
      call checks%that(.not. allocated(case%impact%e), 'coupled has no own e')
      call accept(scene//'&motion kind = ''type_c'', v_p = 1, T_p = 1 /', case)
      call checks%that(case%motion%n_pulses == 1, 'C_1 unless n is given')
      call accept(scene//'&motion kind = ''mavroeidis_papageorgiou'', v_p = 1, T_p = 1, ' &
         //'gamma_p = 2.5 /', case)
      call checks%close_to(case%motion%gamma_p, 2.5_wp, 'gamma_p')
      call checks%close_to(case%motion%nu, 0.0_wp, 'nu')
      call accept(bare//ends, case)
      call checks%that(.not. (allocated(case%wall) .or. allocated(case%frame%gamma)), 'bare frame')
   end subroutine test_values

   subroutine test_spectrum()
      type(case_t) :: case

      call accept(wall//'&frame gamma = 5, xi_s = 0 /'//ends//'&spectrum T_s_min = 0.1, ' &
         //'T_s_max = 3, n = 30, spacing = ''log'', gamma = 5, 2*10 /', case)
      call checks%that(.not. allocated(case%frame%T_s), 'T_s may be absent')
      call checks%that(case%spectrum%n == 30 .and. case%spectrum%spacing == 'log', 'grid')
      call checks%that(size(case%spectrum%gamma) == 3, 'list of mass ratios')
      call checks%that(.not. allocated(case%spectrum%b), 'no list of widths')
      call accept(scene//'&spectrum T_s = 0.1, 0.5 /', case)
      call checks%that(size(case%spectrum%T_s) == 2, 'list of periods')
      call accept(scene//'&spectrum T_s_min = 1, T_s_max = 1, n = 1 /', case)
      call checks%that(case%spectrum%spacing == 'linear', 'spacing')
   end subroutine test_spectrum

   !> A record beside the case file; its last sample ends the simulation.
   subroutine test_record()
      character(:), allocatable :: folder
      character(:), allocatable :: name
      type(case_t) :: case
      type(error_t), allocatable :: error
      integer :: unit
      character(:), allocatable :: text

      call scratch_file('0'//nl//'0.1'//nl//'0', folder, name, unit)
      call read_case_text(wall//'&motion kind = ''record'', file = '''//name//''', dt = 0.5, ' &
         //'unit = ''g'' /', folder, case, error)
      call checks%no_error(error, 'a record beside the case')
      if (.not. allocated(error)) then
         call checks%close_to(case%solver%t_end, 1.0_wp, 'the record ends the simulation')
         call checks%that(case%record%n == 3 .and. case%motion%file == name, 'the record is there')
         call describe_case(case, text)
         call checks%that(index(text, 'solver.t_end'//tab//'real'//tab//'1.0'//tab//'s'//tab &
            //'default') > 0, 'the end is described as a default')
      end if
      call read_case_text(wall//nl//'&motion kind = ''record'', file = '''//name//''', ' &
         //'unit = ''g'' /', folder, case, error)
      call checks%has_error(error, err_input, "&motion: file = '"//name//"' (line 3): "//folder &
         //'/'//name//': the record has one column: it needs the key dt', 'dt is missing')
      close (unit, status='delete')
   end subroutine test_record

   !> Create a file with this content; the caller deletes it.
   subroutine scratch_file(content, folder, name, unit)
      character(*), intent(in) :: content
      character(:), allocatable, intent(out) :: folder
      character(:), allocatable, intent(out) :: name
      integer, intent(out) :: unit
      character(200) :: temporary
      integer(i8) :: ticks
      integer :: stat

      call get_environment_variable('TMPDIR', temporary, status=stat)
      folder = '/tmp'
      if (stat == 0 .and. temporary /= '') folder = trim(temporary)
      call system_clock(ticks)
      name = 'rwmf-test-'//trim(integer_to_text(ticks))//'.txt'
      open (newunit=unit, file=folder//'/'//name, access='stream', form='unformatted', &
         status='new', action='readwrite', iostat=stat)
      call checks%that(stat == 0, 'open a scratch file')
      write (unit, iostat=stat) content
      call checks%that(stat == 0, 'write a scratch file')
      flush (unit, iostat=stat)
      call checks%that(stat == 0, 'flush a scratch file')
   end subroutine scratch_file

   subroutine test_bad_names()
      call refuse('&wal h = 1 /', '&wal (line 1): unknown group, did you mean &wall?')
      call refuse(scene//'&nonsense /', '&nonsense (line 4): unknown group; allowed: &wall')
      call refuse('&frame gama = 1 /', &
         '&frame: gama = 1 (line 1): unknown key, did you mean gamma?')
      call refuse(scene//wall, '&wall (line 4): the group is given twice, before in line 1')
      call refuse('&wall h = 1, H = 2 /', '&wall: h = 2 (line 1): the key is given twice')
      call refuse('&wall h = ,2 /', '&wall: line 1: h has an empty value')
      call refuse('&wall h = 2 /', '&wall (line 1): the key b is missing')
   end subroutine test_bad_names

   !> Invalid values of every type and for every kind of bound.
   subroutine test_bad_values()
      call refuse('&wall h = 0 /', '&wall: h = 0 (line 1): must be a number > 0 [m]')
      call refuse('&wall h = nan /', 'h = nan (line 1): must be a number > 0 [m]')
      call refuse('&wall h = 1.0abc /', 'must be a number')
      call refuse('&wall h = "1.0" /', "h = '1.0' (line 1): must be a number > 0 [m]")
      call refuse('&wall h = 1 2 /', 'h = 1, 2 (line 1): must be one value')
      call refuse('&frame gamma = -1.0 /', 'gamma = -1.0 (line 1): must be a number >= 0 [-]')
      call refuse('&frame t_s = 1e999 /', '&frame: T_s = 1e999 (line 1): must be a number > 0 [s]')
      call refuse('&impact e = 1.0001 /', 'must be a number in [0, 1] [-]')
      call refuse('&impact r = -1 /', 'must be a number in [0, 1] [-]')
      call refuse('&solver rtol = 0 /', 'must be a number in [1.0e-14, 0.1] [-]')
      call refuse('&solver rtol = 0.11 /', 'must be a number in [1.0e-14, 0.1] [-]')
      call refuse('&solver max_steps = 0 /', 'must be an integer >= 1')
      call refuse('&solver max_steps = 1.5 /', 'must be an integer >= 1')
      call refuse('&solver max_steps = 3000000000 /', 'must be an integer >= 1')
      call refuse('&solver method = ''rk4'' /', &
         "must be 'auto', 'taylor', 'adams', 'bdf', 'dop853' or 'paper'")
      call refuse('&solver method = adams /', 'in quotes')
      call refuse('&solver method = ''adams bdf'' /', "method = 'adams bdf'")
      call refuse('&model overturning_angle = 1.6 /', 'must be a number in (0, pi/2] [rad]')
      call refuse('&motion v_p = inf /', 'must be any finite number [m/s]')
      call refuse('&motion file = '''' /', 'must be a text in quotes')
      call refuse('&output energy = yes /', 'must be .true. or .false.')
      call refuse('&spectrum n = 0 /', 'must be an integer in [1, 1000000]')
      call refuse('&spectrum gamma = 1, -2 /', 'gamma = 1, -2 (line 1): must be numbers >= 0 [-]')
   end subroutine test_bad_values

   !> Groups that contradict each other.
   subroutine test_bad_scenes()
      call refuse(ends, 'at least one of these groups')
      call refuse('', 'at least one of these groups')
      call refuse(bare//ends//'&cable eta_0 = 1 /', '&cable (line 3): must not be given without')
      call refuse(bare//ends//'&impact e = 1 /', '&impact (line 3): must not be given without')
      call refuse(bare//ends//'&initial /', '&initial (line 3): must not be given without &wall')
      call refuse(wall//ends//'&spectrum T_s = 1, gamma = 1 /', 'must not be given without &frame')
      call refuse('&wall h = 2, b = 0.5, base = ''pinned'' /'//ends//'&spectrum T_s = 1 /', &
         'must not be given without &frame when &wall base = ''pinned''')
      call refuse(frame//ends, '&frame: gamma = 5.0 (line 1): must not be given without &wall')
      call refuse(wall//bare//ends, '&frame (line 2): the key gamma is missing')
      call refuse('&frame xi_s = 0 /'//ends, '&frame (line 1): the key T_s is missing')
      call refuse(wall//frame, 'the key t_end is missing')
      call refuse(wall//'&motion kind = ''none'' / &solver /', '&solver (line 2): the key t_end')
      call refuse(scene//"&impact rule = 'constant' /", &
         'exactly one of the keys e and r must be given')
      call refuse(scene//'&impact e = 1, r = 1 /', 'r = 1 (line 4): must not be given beside e')
      call refuse(scene//'&impact rule = ''housner'', e = 1 /', "with rule = 'housner'")
      call refuse(scene//'&impact rule = ''coupled'', r = 1 /', "with rule = 'coupled'")
      call refuse(scene//'&impact e = 1, table_e = 1 /', "with rule = 'constant'")
      call refuse(scene//'&impact rule = ''table'', e = 1 /', "with rule = 'table'")
      call refuse(scene//'&impact rule = ''table'', table_e = 1 /', 'the key table_theta_dot is')
      call refuse(scene//'&impact rule = ''table'', table_e = 1, 0.9, table_theta_dot = 1 /', &
         'must have as many values as table_theta_dot')
      call refuse(scene//'&impact rule = ''table'', table_e = 1, 0.9, table_theta_dot = 1, 1 /', &
         'must increase strictly')
      call refuse(scene//'&impact rule = ''table'', table_e = 1.1, table_theta_dot = 1 /', &
         'must be numbers in [0, 1]')
      call refuse(bare//ends//'&inerter inertance_over_m_w = 1 /', 'be given without &wall')
      call refuse('&wall h = 2, b = 0.5, base = ''pinned'' /'//frame//ends &
         //'&cable eta_0 = 1 /', 'a straight cable through the hinge is not stretched')
      call refuse(scene//"&model formulation = 'published' / &cable eta_0 = 1, law = 'truss' /", &
         "law = 'truss' (line 4): must be " &
         //"'linear' with &model formulation = 'published'")
   end subroutine test_bad_scenes

   subroutine test_bad_motions()
      character(*), parameter :: pulse = scene//'&motion kind = ''one_sine'', '

      call refuse(pulse//'T_p = 1 /', 'exactly one of the keys a_max_g and v_p')
      call refuse(pulse//'T_p = 1, v_p = 1, a_max_g = 1 /', 'must not be given beside a_max_g')
      call refuse(pulse//'v_p = 1 /', 'exactly one of the keys omega_p and T_p')
      call refuse(pulse//'v_p = 1, T_p = 1, omega_p = 1 /', 'must not be given beside omega_p')
      call refuse(pulse//'v_p = 1, T_p = 1, cycles = 2 /', "cycles = 2 (line 4): must not be " &
         //"given with kind = 'one_sine'")
      call refuse(pulse//'v_p = 1, T_p = 1, file = ''a'' /', "must not be given with kind")
      call refuse(pulse//'v_p = 1, T_p = 1, n_pulses = 2 /', "must not be given with kind")
      call refuse(scene//'&motion kind = ''type_c'', v_p = 1, T_p = 1, n_pulses = 0 /', &
         'n_pulses = 0 (line 4): must be an integer >= 1')
      call refuse(scene//'&motion kind = ''ricker'', v_p = 1, T_p = 1 /', &
         "v_p = 1 (line 4): must not be given with kind = 'ricker'")
      call refuse(scene//'&motion kind = ''ricker_antisymmetric'', T_p = 1 /', &
         "the key a_max_g is missing (largest acceleration over g): must be given with kind = " &
         //"'ricker_antisymmetric'")
      call refuse(scene//'&motion kind = ''ricker'', a_max_g = 1 /', &
         'exactly one of the keys omega_p and T_p')
      call refuse(scene//'&motion kind = ''mavroeidis_papageorgiou'', v_p = 1, T_p = 1 /', &
         'the key gamma_p is missing (number of cycles in the envelope)')
      call refuse(scene//'&motion kind = ''mavroeidis_papageorgiou'', v_p = 1, T_p = 1, ' &
         //'gamma_p = 1 /', 'gamma_p = 1 (line 4): must be a number in (1, 1000] [-]')
      call refuse(scene//'&motion kind = ''none'', t_0 = 1 /', "with kind = 'none'")
      call refuse(bare//ends//shaken//'&vertical ratio = 1 /', 'must not be given without &wall')
      call refuse(scene//'&vertical ratio = 1 /', 'without a horizontal &motion')
      call refuse(scene//shaken//'&vertical /', 'exactly one of the keys ratio and file')
      call refuse(scene//shaken//'&vertical ratio = 1, dt = 1 /', 'it belongs to a record')
      call refuse(scene//'&vertical file = ''none.txt'' /', "&vertical: file = 'none.txt' (line 4)")
      call refuse(scene//'&motion kind = ''record'', a_max_g = 1, file = ''a'' /', &
         "a_max_g = 1 (line 4): must not be given with kind = 'record'")
      call refuse(scene//'&motion kind = ''record'' /', '&motion (line 4): the key file is missing')
      call refuse(scene//'&motion kind = ''record'', file = ''none.txt'' /', &
         "file = 'none.txt' (line 4): the file does not exist")
   end subroutine test_bad_motions

   subroutine test_bad_runs()
      call refuse(wall//'&solver t_end = 1, rtol = 1e-3, accuracy = 1e-3 /', &
         'must not be given beside rtol')
      call refuse(scene//'&initial theta_over_alpha = -7 /', 'must be < overturning_angle')
      call refuse(scene//'&initial theta_over_alpha = 2 / &spectrum T_s = 1, b = 0.5, 3 /', &
         'must be < overturning_angle')
      call refuse(scene//'&spectrum T_s_min = 2, T_s_max = 1, n = 3 /', 'must be >= T_s_min = 2.0')
      call refuse(scene//'&spectrum T_s_min = 1, T_s_max = 2, n = 1 /', 'must be >= 2 when')
      call refuse(scene//'&spectrum T_s_min = 1, n = 1 /', 'the key T_s_max is missing')
      call refuse(scene//'&spectrum T_s = 1, spacing = ''log'' /', 'beside the list T_s')
      call refuse(bare//ends//'&spectrum T_s = 1, gamma = 2 /', 'must not be given without &wall')
      call refuse(bare//ends//'&spectrum T_s = 1, b = 2 /', 'must not be given without &wall')
   end subroutine test_bad_runs

   !> The given keys determine the impact rule.
   subroutine test_implied_rules()
      character(*), parameter :: keys(6) = [character(40) :: '', 'e = 0.9', 'r = 0.81', &
         'table_e = 1, 0.9, table_theta_dot = 1, 2', "rule = 'housner'", "rule = 'constant', e = 1"]
      character(*), parameter :: rules(size(keys)) = [character(8) :: 'coupled', 'constant', &
         'constant', 'table', 'housner', 'constant']
      type(case_t) :: case
      integer :: i

      do i = 1, size(keys)
         call accept(scene//'&impact '//trim(keys(i))//' /', case)
         call checks%that(case%impact%rule == trim(rules(i)), 'rule of &impact '//trim(keys(i)))
      end do
   end subroutine test_implied_rules

   subroutine test_files()
      character(*), parameter :: names(3) = [character(9) :: 'none.nml', '.', '/dev/zero']
      type(case_t) :: case
      type(error_t), allocatable :: error
      integer :: i

      do i = 1, size(names)
         call read_case_file(trim(names(i)), case, error)
         call checks%has_error(error, err_input, trim(names(i))//': the file', &
            'refused: '//names(i))
      end do
   end subroutine test_files

   subroutine test_description()
      type(case_t) :: case
      character(:), allocatable :: text

      call accept(scene//'&impact r = 0.81 / &motion kind = ''one_sine'', a_max_g = 4d-1, ' &
         //'T_p = 1 / &output / &spectrum T_s_min = 1, T_s_max = 2, n = 5, gamma = 5, 1e6 /', case)
      call describe_case(case, text)
      text = nl//text
      call says(text, 'wall.h'//tab//'real'//tab//'2.0'//tab//'m'//tab//'given')
      call says(text, 'impact.r'//tab//'real'//tab//'0.81'//tab//'-'//tab//'given')
      call says(text, 'impact.rule'//tab//'choice'//tab//'constant'//tab//tab//'default')
      call says(text, 'motion.a_max_g'//tab//'real'//tab//'0.4'//tab//'-'//tab//'given')
      call says(text, 'motion.t_0'//tab//'real'//tab//'0.0'//tab//'s'//tab//'default')
      call says(text, 'model.g'//tab//'real'//tab//'9.81'//tab//'m/s2'//tab//'default')
      call says(text, 'output.energy'//tab//'logical'//tab//'.false.'//tab//tab//'default')
      call says(text, 'spectrum.n'//tab//'integer'//tab//'5'//tab//tab//'given')
      call says(text, 'spectrum.gamma'//tab//'real list'//tab//'5.0, 1000000.0'//tab//'-'//tab &
         //'given')
      call checks%that(index(text, 'cable') == 0 .and. index(text, 'motion.cycles') == 0 &
         .and. index(text, 'impact.e') == 0 .and. index(text, 'atol') == 0, &
         'what does not apply is not described')
   end subroutine test_description

   !> The table is complete: nine columns, and a help text for every key.
   subroutine test_schema()
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: text
      integer :: i
      integer :: lines
      integer :: tabs

      keys = all_keys()
      call write_schema(text)
      lines = 0
      tabs = 0
      do i = 1, len(text)
         if (text(i:i) == nl) lines = lines + 1
         if (text(i:i) == tab) tabs = tabs + 1
      end do
      call checks%that(lines == size(keys) .and. tabs == 8*lines, 'columns of the schema')
      do i = 1, size(keys)
         call checks%that(keys(i)%help /= '', 'help of '//keys(i)%key)
      end do
      call checks%that(index(text, tab//'m_over_m_w'//nl) > 0, 'a key that replaces another')
      call checks%that(index(text, tab//'height'//nl) == 0, 'a key that scales another')
      call checks%that(size(names_of(all_groups())) == 11 + effect_count, &
         'eleven groups, and the effects')
   end subroutine test_schema

   subroutine says(text, line)
      character(*), intent(in) :: text
      character(*), intent(in) :: line

      call checks%that(index(text, nl//line//nl) > 0, 'described: '//line)
   end subroutine says

   subroutine accept(text, case)
      character(*), intent(in) :: text
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_text(text, '', case, error)
      call checks%no_error(error, 'accepted')
      if (allocated(error)) call checks%finish()
   end subroutine accept

   !> Springs that give a part of the scene a period below 1e-5 s, on both sides of the limit:
   !> a fuse's stiffness over m_w g of (2 pi)**2 1e10/g = 4.024e10 1/m.
   subroutine test_stiff_springs()
      character(*), parameter :: exact = '&model formulation = ''exact'' /'//nl//wall//ends
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(exact//'&fuse eta_y = 40, stroke_y = 1e-9 /', '', case, error)
      call checks%no_error(error, 'a fuse just below the limit')
      call refuse(exact//'&fuse eta_y = 41, stroke_y = 1e-9 /', 'must be >= 1.0e-5 s')
      call refuse(exact//'&fuse eta_y = 1e300, stroke_y = 1e-9 /', '&fuse: stroke_y = 1e-9')
      call refuse(exact//'&cable eta_0 = 1, eta_alpha = 1e300, eta_y = 2 /', &
         '&cable: eta_alpha = 1e300 (line 4): the period 2 pi sqrt(mass/stiffness) is')
      call refuse(exact//'&cable eta_0 = 1, eta_alpha = 1e12, eta_y = 2, law = ''truss'' /', &
         'lower the stiffness')
   end subroutine test_stiff_springs

   subroutine refuse(text, message)
      character(*), intent(in) :: text
      character(*), intent(in) :: message
      !! required part of the message
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(text, '', case, error)
      call checks%has_error(error, err_input, message, 'refused: '//message)
   end subroutine refuse

end program test_case
