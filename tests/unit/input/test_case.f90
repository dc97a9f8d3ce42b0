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
   type(checks_t) :: checks

   if (checks%wants('defaults')) call test_defaults()
   if (checks%wants('values')) call test_values()
   if (checks%wants('spectrum')) call test_spectrum()
   if (checks%wants('record')) call test_record()
   if (checks%wants('stiff_springs')) call test_stiff_springs()
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

   !> A fuse's stiffness over m_w g just below (2 pi)**2 1e10/g = 4.024e10 1/m, a period of 1e-5 s.
   subroutine test_stiff_springs()
      type(case_t) :: case

      call accept('&model formulation = ''exact'' /'//nl//wall//ends &
         //'&fuse eta_y = 40, stroke_y = 1e-9 /', case)
   end subroutine test_stiff_springs

end program test_case
