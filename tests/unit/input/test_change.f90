!> A changed case equals the case that is read from a text with the same numbers: description,
!> messages and results. The change reads no text and no file.
program test_change
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use check, only: checks_t
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: dp, i8, wp
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_input_describe, only: describe_case
   use rwmf_input_reader, only: read_case_text
   use rwmf_motion_ground_motion, only: motion_from_case
   use rwmf_output_summary, only: summarise, summary_item_t, summary_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_simulate, only: simulate_with_motion
   use rwmf_simulation_state_result, only: result_t
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: wall = '&wall h = 2.0, b = 0.5 /'//nl
   character(*), parameter :: scene = wall//'&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl &
      //'&motion kind = ''sine'', a_max_g = 0.5, T_p = 0.5 /'//nl//'&solver t_end = 3.0 /'//nl
   character(*), parameter :: cable = '&cable eta_0 = 0.5 /'//nl
   character(*), parameter :: storeys = wall//'&frame xi_s = 0.05 /'//nl &
      //'&storeys m_over_m_w = 1.0, 2.0, k_over_m_w = 900, 800, height = 2.0, 2.0, ' &
      //'coupling = ''full'' /'//nl &
      //'&motion kind = ''sine'', a_max_g = 0.5, T_p = 0.5 /'//nl//'&solver t_end = 3.0 /'//nl
   type(checks_t) :: checks

   if (checks%wants('numbers')) call test_numbers()
   if (checks%wants('defaults')) call test_defaults()
   if (checks%wants('lists')) call test_lists()
   if (checks%wants('chain')) call test_chain()
   if (checks%wants('records')) call test_records()
   if (checks%wants('bad_names')) call test_bad_names()
   if (checks%wants('bad_numbers')) call test_bad_numbers()
   if (checks%wants('units')) call test_units()
   if (checks%wants('cost')) call test_cost()
   call checks%finish()

contains

   subroutine test_numbers()
      call same(scene, [character(9) :: 'frame.T_s', 'WALL.B'], [0.7_dp, 0.4_dp], &
         '&wall h = 2.0, b = 0.4 /'//nl//'&frame T_s = 0.7, gamma = 5.0, xi_s = 0.05 /'//nl &
         //'&motion kind = ''sine'', a_max_g = 0.5, T_p = 0.5 /'//nl//'&solver t_end = 3.0 /')
      call same(scene, [character(15) :: 'motion.T_p', 'motion.a_max_g', 'motion.cycles'], &
         [0.7_dp, -0.4_dp, 2.0_dp], wall//'&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl &
         //'&motion kind = ''sine'', a_max_g = -0.4, T_p = 0.7, cycles = 2.0 /'//nl &
         //'&solver t_end = 3.0 /')
      call same(scene, ['output.energy   ', 'solver.max_steps', 'model.g         '], &
         [1.0_dp, 1.0e6_dp, 9.8_dp], &
         scene(:len(scene) - 2)//' max_steps = 1000000 / &output energy = T / &model g = 9.8 /')
   end subroutine test_numbers

   !> A changed key has the same implications as in a text; defaults follow it.
   subroutine test_defaults()
      call same(scene//cable, ['cable.eta_0'], [0.75_dp], scene//'&cable eta_0 = 0.75 /')
      call same(scene//cable, ['cable.eta_alpha'], [0.75_dp], &
         scene//'&cable eta_0 = 0.5, eta_alpha = 0.75 /')
      call same(scene//'&impact /', ['impact.e'], [0.75_dp], scene//'&impact e = 0.75 /')
      call same(scene//'&impact r = 0.5 /', ['impact.r'], [0.75_dp], scene//'&impact r = 0.75 /')
   end subroutine test_defaults

   subroutine test_lists()
      call same(storeys, ['storeys.m_over_m_w', 'storeys.height    '], &
         [1.5_dp, 2.5_dp, 1.0_dp, 3.0_dp], wall//'&frame xi_s = 0.05 /'//nl &
         //'&storeys m_over_m_w = 1.5, 2.5, k_over_m_w = 900, 800, height = 1.0, 3.0, ' &
         //'coupling = ''full'' /'//nl//'&motion kind = ''sine'', a_max_g = 0.5, T_p = 0.5 /'//nl &
         //'&solver t_end = 3.0 /', [2, 2])
      call same(scene//'&spectrum T_s_min = 1, T_s_max = 2, n = 3 /', &
         [character(16) :: 'spectrum.T_s_min', 'spectrum.T_s', 'spectrum.T_s_max', 'spectrum.n'], &
         [0.5_dp, 0.75_dp], scene//'&spectrum T_s = 0.5, 0.75 /', [0, 2, 0, 0])
      call same(scene, ['spectrum.T_s'], [0.5_dp], scene//'&spectrum T_s = 0.5 /')
      call same(scene//'&cable eta_0 = 0.5, eta_alpha = 0.75 /', ['cable.eta_alpha'], &
         [real(dp) ::], scene//cable, [0])
   end subroutine test_lists

   !> A change recomputes ratios from dimensional keys; messages name the key that is given.
   subroutine test_units()
      character(*), parameter :: heavy = '&wall h = 2.0, b = 0.5, density = 2500, ' &
         //'thickness = 0.3 /'//nl//'&frame m_s = 5000, k_s = 2e5, xi_s = 0.05 /'//nl &
         //'&cable strands = 2, strand_area = 1e-4, modulus = 2e11, initial_stress = 1e8, ' &
         //'yield_stress = 4e8 /'//nl
      character(*), parameter :: tall = '&frame xi_s = 0.05 /'//nl//'&storeys n = 3, m = 1000, ' &
         //'height = 3, T_1 = 0.4, distribution = ''straight_mode'' /'//nl
      character(*), parameter :: motion = '&motion kind = ''sine'', a_max_g = 0.5, T_p = 0.5 /' &
         //nl//'&solver t_end = 3.0 /'//nl

      call same(heavy//motion, ['wall.b   ', 'frame.k_s'], [0.6_dp, 3.0e5_dp], &
         '&wall h = 2.0, b = 0.6, density = 2500, thickness = 0.3 /'//nl &
         //'&frame m_s = 5000, k_s = 3e5, xi_s = 0.05 /'//nl//'&cable strands = 2, ' &
         //'strand_area = 1e-4, modulus = 2e11, initial_stress = 1e8, yield_stress = 4e8 /'//nl &
         //motion)
      call same(tall//motion, ['storeys.height', 'storeys.T_1   '], [2.0_dp, 3.0_dp, 4.0_dp, &
         0.5_dp], '&frame xi_s = 0.05 /'//nl//'&storeys n = 3, m = 1000, height = 2, 3, 4, ' &
         //'T_1 = 0.5, distribution = ''straight_mode'' /'//nl//motion, [3, 1])
      call same(tall//motion, ['storeys.T_1'], [0.5_dp], '&frame xi_s = 0.05 /'//nl//'&storeys ' &
         //'n = 3, m = 1000, height = 3, T_1 = 0.5, distribution = ''straight_mode'' /'//nl//motion)
      call refuse(heavy//motion, ['cable.yield_stress'], [0.5e8_dp], &
         '&cable: yield_stress = 50000000.0: eta_y = ')
      call refuse(heavy//motion, ['frame.m_s'], [0.0_dp], &
         '&frame: k_s = 2e5 (line 2): T_s = 0.0: must be a number > 0 [s]')
      call refuse(heavy//motion, ['frame.gamma'], [2.0_dp], &
         '&frame: m_s = 5000 (line 2): must not be given beside gamma')
      call refuse(tall//motion, ['storeys.n'], [2.0_dp], 'must be given where the case is made')
   end subroutine test_units

   !> A changed case can change again and does not grow.
   subroutine test_chain()
      type(case_t) :: first
      type(case_t) :: case
      type(case_t) :: changed
      type(changes_t) :: changes
      type(error_t), allocatable :: error
      character(:), allocatable :: text
      integer :: i

      call read_case_text(scene//cable, '', case, error)
      do i = 1, 50
         call find_changes(case, ['cable.eta_0'], changes, error)
         if (.not. allocated(error)) call change_case(case, changes, [0.1_dp*i], changed, error)
         call checks%no_error(error, 'a change of a changed case')
         if (allocated(error)) return
         case = changed
         if (i == 1) first = case
      end do
      call checks%close_to(case%cable%eta_alpha(1), 5.0_wp, 'the last number holds', rtol=1e-15_wp)
      call checks%that(size(case%values%numbers) <= size(first%values%numbers) &
         .and. len(case%values%texts) <= len(first%values%texts), 'values do not pile up')
      call describe_case(case, text)
      call checks%that(index(text, 'cable.law') > 0, 'a changed case is described')
   end subroutine test_chain

   !> Unit, scale and gravity apply to the stored samples, which are not read again.
   subroutine test_records()
      character(*), parameter :: name = 'test_change_record.txt'
      character(*), parameter :: at = '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl//wall &
         //'&motion kind = ''record'', file = '''//name//''', dt = 0.2, unit = ''g'''
      character(*), parameter :: vertical = ' &vertical file = '''//name//''', dt = 0.15, ' &
         //'unit = ''m/s2'''
      integer :: unit
      integer :: stat

      open (newunit=unit, file=name, access='stream', form='unformatted', status='replace', &
         iostat=stat)
      call checks%that(stat == 0, 'open a record')
      write (unit, iostat=stat) '0.1'//nl//'0.3'//nl//'-0.4'//nl//'0.2'//nl//'0.1'//nl//'0.45'//nl
      call checks%that(stat == 0, 'write a record')
      flush (unit, iostat=stat)
      call checks%that(stat == 0, 'flush a record')
      call same(at//' /', ['wall.b'], [0.4_dp], '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl &
         //'&wall h = 2.0, b = 0.4 /'//at(index(at, '&motion') - 1:)//' /')
      call same(at//' /', [character(12) :: 'motion.scale', 'model.g'], [1.5_dp, 9.8_dp], &
         at//', scale = 1.5 / &model g = 9.8 /')
      call same(at//', scale = 1.5 /', ['solver.t_end'], [3.0_dp], &
         at//', scale = 1.5 / &solver t_end = 3.0 /')
      call same(at//' /'//vertical//' /', ['vertical.scale'], [0.5_dp], &
         at//' /'//vertical//', scale = 0.5 /')
      call refuse(at//' /', ['motion.dt'], [0.3_dp], &
         'motion.dt: must be given where the case is made')
      call refuse(at//' /', ['motion.scale'], [1.0e308_dp], 'overflow')
      close (unit, status='delete')
   end subroutine test_records

   subroutine test_bad_names()
      call refuse(scene, ['frame.Ts '], [1.0_dp], 'frame.Ts: unknown key, did you mean T_s?')
      call refuse(scene, ['fram.T_s'], [1.0_dp], 'fram.T_s: unknown group, did you mean frame?')
      call refuse(scene, ['T_s'], [1.0_dp], 'T_s: must be group.key')
      call refuse(scene, ['cable.eta_0'], [1.0_dp], 'cable.eta_0: the case has no group &cable')
      call refuse(scene, ['motion.kind'], [1.0_dp], 'motion.kind: must be a key that holds numbers')
      call refuse(scene, ['frame.T_s', 'frame.t_s'], [1.0_dp, 1.0_dp], 'the key is given twice')
   end subroutine test_bad_names

   !> The messages equal those of reading, without the line of the changed key.
   subroutine test_bad_numbers()
      call refuse(scene, ['frame.T_s'], [-1.0_dp], '&frame: T_s = -1.0: must be a number > 0 [s]')
      call refuse(scene, ['frame.T_s'], [ieee_value(1.0_dp, ieee_quiet_nan)], &
         '&frame: T_s = nan: must be a number > 0')
      call refuse(scene, ['solver.max_steps'], [1.5_dp], 'max_steps = 1.5: must be an integer >= 1')
      call refuse(scene, ['solver.verify'], [2.0_dp], 'verify = 2.0: must be .true. or .false.')
      call refuse(scene//'&impact rule = ''housner'' /', ['impact.e'], [0.5_dp], &
         "&impact: e = 0.5: must not be given with rule = 'housner'")
      call refuse(scene//'&initial theta_dot = 0 /', ['initial.theta_over_alpha'], [50.0_dp], &
         '&initial: theta_over_alpha = 50.0: |theta| =')
      call refuse(storeys, ['frame.T_s'], [0.5_dp], '&frame: T_s = 0.5: must not be given with')
      call refuse(storeys, ['wall.h'], [5.0_dp], '&storeys: height = 2.0, 2.0 (line 3): their sum')
   end subroutine test_bad_numbers

   !> A change takes a hundredth of a millisecond; the limit is a large multiple of this.
   subroutine test_cost()
      integer, parameter :: repeats = 2000
      type(case_t) :: case
      type(case_t) :: changed
      type(changes_t) :: changes
      type(error_t), allocatable :: error
      integer(i8) :: started, finished, rate
      real(wp) :: seconds
      integer :: i

      call read_case_text(scene//cable//'&impact e = 0.9 /', '', case, error)
      call checks%no_error(error, 'the case')
      call find_changes(case, ['frame.T_s  ', 'cable.eta_0'], changes, error)
      call checks%no_error(error, 'the changes')
      call system_clock(started, rate)
      do i = 1, repeats
         call change_case(case, changes, [0.5_dp + 1.0e-6_dp*i, 0.5_dp], changed, error)
         if (allocated(error)) exit
      end do
      call system_clock(finished)
      call checks%no_error(error, 'a cheap change')
      seconds = real(finished - started, wp)/real(rate, wp)/repeats
      call checks%that(seconds < 2.0e-4_wp, 'seconds of a change', real_to_text(seconds))
   end subroutine test_cost

   !> Check that the changed case equals the case that is read from `expected`.
   subroutine same(text, names, numbers, expected, n_values)
      character(*), intent(in) :: text
      character(*), intent(in) :: names(:)
      real(dp), intent(in) :: numbers(:)
      character(*), intent(in) :: expected
      integer, intent(in), optional :: n_values(:)
      type(case_t) :: case
      type(case_t) :: changed
      type(case_t) :: other
      type(changes_t) :: changes
      type(error_t), allocatable :: error
      character(:), allocatable :: found
      character(:), allocatable :: wanted

      call read_case_text(text, '', case, error)
      if (.not. allocated(error)) call read_case_text(expected, '', other, error)
      if (.not. allocated(error)) call find_changes(case, names, changes, error, n_values)
      if (.not. allocated(error)) call change_case(case, changes, numbers, changed, error)
      call checks%no_error(error, 'change of '//names(1))
      if (allocated(error)) return
      call checks%that(.not. allocated(changed%text), 'no text')
      call describe_case(changed, found)
      call describe_case(other, wanted)
      call compare('description', found, wanted)
      call respond(changed, case, found)
      call respond(other, other, wanted)
      call compare('response', found, wanted)
   end subroutine same

   !> Report of a run of the case with the samples of another case.
   subroutine respond(case, origin, text)
      type(case_t), intent(in) :: case
      type(case_t), intent(in) :: origin
      character(:), allocatable, intent(out) :: text
      type(control_t) :: control
      type(result_t) :: result
      type(summary_item_t), allocatable :: items(:)
      type(error_t), allocatable :: error

      call simulate_with_motion(case, motion_from_case(case, origin), control, result, error)
      call checks%no_error(error, 'a run')
      text = ''
      if (allocated(error)) return
      result%seconds = 0
      call summarise(case, result, items)
      call summary_text(items, text)
   end subroutine respond

   subroutine compare(what, found, expected)
      character(*), intent(in) :: what
      character(*), intent(in) :: found
      character(*), intent(in) :: expected
      integer :: i

      i = 1
      do while (i <= min(len(found), len(expected)))
         if (found(i:i) /= expected(i:i)) exit
         i = i + 1
      end do
      call checks%that(found == expected, what, 'from letter '//trim(integer_to_text(i))//': ' &
         //found(max(1, i - 30):min(len(found), i + 30))//' | ' &
         //expected(max(1, i - 30):min(len(expected), i + 30)))
   end subroutine compare

   subroutine refuse(text, names, numbers, message)
      character(*), intent(in) :: text
      character(*), intent(in) :: names(:)
      real(dp), intent(in) :: numbers(:)
      character(*), intent(in) :: message
      !! required part of the message
      type(case_t) :: case
      type(case_t) :: changed
      type(changes_t) :: changes
      type(error_t), allocatable :: error

      call read_case_text(text, '', case, error)
      call checks%no_error(error, 'the case')
      call find_changes(case, names, changes, error)
      if (.not. allocated(error)) call change_case(case, changes, numbers, changed, error)
      call checks%has_error(error, err_input, message, 'refused: '//message)
   end subroutine refuse

end program test_change
