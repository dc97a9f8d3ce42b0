!> Rows of a table, each bitwise identical to the single run, or the spectrum, of the same case.
program test_rows
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: ending_name, result_t
   use rwmf_spectrum_ordinates, only: compute_rows, compute_spectrum, spectrum_t, status_of
   use scenes, only: frame_scene, rwmf_scene
   implicit none

   integer, parameter :: n = 20
   !! rows, more than the lanes of a batch
   character(*), parameter :: wall = '&wall h=2.0, b=0.5 / &frame T_s=0.8, gamma=3, xi_s=0.05 / ' &
      //"&model formulation='exact' / &cable eta_0=1.0, eta_alpha=5.0 / "
   character(*), parameter :: loss = "&impact rule='constant', e=0.9 / "
   character(*), parameter :: pulses = "&motion kind='sine', a_max_g=0.5, T_p=0.6, cycles=4 / "
   character(*), parameter :: storeys = "&wall h=2.0, b=0.5 / &frame xi_s=0.05 / &storeys " &
      //"m_over_m_w=3*2.0, k_over_m_w=3*600.0, height=1.5, 1.5, 1.0, coupling='full' / " &
      //"&model formulation='exact' / "
   type(checks_t) :: checks

   call check_runs('wall', wall//loss//pulses, [character(20) :: 'frame.T_s', 'frame.gamma', &
      'wall.b', 'wall.h', 'frame.xi_s', 'cable.eta_0', 'cable.eta_alpha', 'impact.e'])
   call check_runs('devices', wall//loss//pulses//'&damper c_over_m_w=0.5 / &inerter ' &
      //'inertance_over_m_w=0.2 / &vertical ratio=0.5 / &link L=15.0 / ', [character(26) :: &
      'damper.c_over_m_w', 'inerter.inertance_over_m_w', 'vertical.ratio', 'link.L', 'model.g'])
   call check_runs('fuses', wall//loss//pulses//'&fuse eta_y=0.3, stroke_y=0.005, ' &
      //'hardening=0.02 / &yielding u_y=0.02, hardening=0.05 /', [character(20) :: 'fuse.eta_y', &
      'fuse.stroke_y', 'yielding.u_y', 'yielding.hardening'])
   call check_runs('smooth', wall//loss//pulses &
      //"&yielding u_y=0.02, law='bouc_wen', exponent=2 /", [character(20) :: &
      'yielding.exponent', 'yielding.beta'])
   call check_runs('pulse', wall//loss//pulses//'&initial theta_over_alpha=0.1 /', &
      [character(24) :: 'motion.a_max_g', 'motion.T_p', 'initial.theta_over_alpha'])
   call check_runs('tolerance', wall//loss//pulses, [character(20) :: 'solver.rtol', &
      'solver.t_end'])
   call check_runs('storeys', storeys//loss//pulses//'&yielding storey_u_y=0.01 /', &
      [character(20) :: 'frame.xi_s', 'impact.e'])
   call check_runs('bare', '&frame T_s=1.0, xi_s=0.05 / '//pulses//'&yielding u_y=0.02 /', &
      [character(20) :: 'frame.T_s', 'yielding.u_y'])
   call check_runs('block', '&wall h=2.0, b=0.5 / '//loss//pulses, [character(20) :: 'wall.h', &
      'wall.b', 'motion.T_p'], 'theta_max_over_alpha')
   call check_spectra('published', 'one_sine')
   call check_spectra('symmetric', 'record')
   call check_spectra('exact', 'record')
   call check_spectra('bare', 'record')
   call check_motions()
   call check_refused()
   call check_accuracy()
   call check_own_accuracy()
   call checks%finish()

contains

   !> Scene under a record without any pattern, or under a pulse, in memory.
   function shaken_scene(formulation, kind) result(case)
      character(*), intent(in) :: formulation
      !! or 'bare', a frame without wall
      character(*), intent(in) :: kind
      type(case_t) :: case
      integer :: i

      if (formulation == 'bare') then
         case = frame_scene(1.0_wp, 'auto')
      else
         case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'auto')
      end if
      case%solver%rtol = 1.0e-7_wp
      case%motion%kind = kind
      if (kind /= 'record') return
      allocate (case%record)
      deallocate (case%motion%a_max_g, case%motion%omega_p)
      case%record%t = [(0.02_wp*i, i=0, 400)]
      case%record%a = [(0.9_wp*(sin(6.1_wp*0.02_wp*i) + sin(1.7_wp + 14.3_wp*0.02_wp*i) &
         + 0.7_wp*sin(0.3_wp + 37.9_wp*0.02_wp*i)), i=0, 400)]
   end function shaken_scene

   !> Check that rows by method 'auto' have the bits of the spectra of their cases. They run on two
   !> threads, and some of them fall back to the general lanes.
   subroutine check_spectra(formulation, kind)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: kind
      character(5), parameter :: columns(4) = [character(5) :: 'T_s', 'scale', 'gamma', 'b']
      character(20) :: wanted(2)
      type(case_t) :: case, single
      type(spectrum_t) :: rows, alone
      type(error_t), allocatable :: error
      real(wp) :: values(4, n)
      integer :: i, n_columns, n_wanted

      if (.not. checks%wants('spectra of '//formulation//', '//kind)) return
      wanted = [character(20) :: 'u_s_max_m', 'theta_max_over_alpha']
      ! if the rotation does not follow from the displacement, requesting it would select general
      ! lanes
      n_wanted = merge(2, 1, formulation /= 'exact' .and. formulation /= 'bare')
      n_columns = merge(2, 4, formulation == 'bare')
      case = shaken_scene(formulation, kind)
      do i = 1, n
         values(:, i) = [0.15_wp*i, 1.5_wp*sin(0.9_wp*i), 0.3_wp*i, 0.4_wp + 0.01_wp*i]
      end do
      call compute_rows(case, columns(:n_columns), values(:n_columns, :), wanted(:n_wanted), 2, &
         rows, error)
      call checks%no_error(error, formulation)
      do i = 1, n
         single = case
         allocate (single%spectrum)
         single%spectrum%quantities = wanted(:n_wanted)
         single%spectrum%T_s = values(1:1, i)
         if (allocated(single%motion%a_max_g)) single%motion%a_max_g = values(2, i) &
            *single%motion%a_max_g
         if (allocated(single%record)) single%record%factor = values(2, i)
         if (formulation /= 'bare') then
            single%frame%gamma = values(3, i)
            single%wall%b = values(4, i)
         end if
         call compute_spectrum(single, 1, alone, error)
         call checks%no_error(error, formulation//', alone')
         call checks%that(all(abs(rows%values(i, 1, 1, :) - alone%values(1, 1, 1, :)) <= 0), &
            'bits of a spectrum, '//formulation//', '//kind)
         call checks%that(rows%rhs_evaluations < n*10000, 'few in general lanes')
      end do
   end subroutine check_spectra

   !> Compare rows under multiples of a record with single runs, bit by bit. The vertical motion is
   !> a fraction of the record, and the rows run in general lanes.
   subroutine check_motions()
      type(case_t) :: case, single
      type(spectrum_t) :: rows
      type(result_t) :: run
      type(error_t), allocatable :: error
      real(wp) :: values(2, n)
      integer :: i

      if (.not. checks%wants('motions')) return
      case = shaken_scene('exact', 'record')
      case%solver%method = 'dop853'
      case%record%factor = 0.7_wp
      allocate (case%upward)
      case%upward%ratio = 0.6_wp
      do i = 1, n
         values(:, i) = [0.4_wp + 0.1_wp*i, 1.5_wp*sin(0.9_wp*i)]
      end do
      values(2, 5) = 0
      call compute_rows(case, [character(5) :: 'T_s', 'scale'], values, [character(20) ::], 1, &
         rows, error)
      call checks%no_error(error, 'motions')
      do i = 1, n
         single = case
         single%frame%T_s = values(1, i)
         single%record%factor = values(2, i)*case%record%factor
         call simulate(single, run, error)
         call checks%no_error(error, 'motions, single run')
         call checks%that(abs(rows%values(i, 1, 1, 1) - run%u_s_max) <= 0, 'motions: bits')
      end do
      call checks%that(abs(rows%values(5, 1, 1, 1)) <= 0, 'motions: none')
   end subroutine check_motions

   !> Check that rows with invalid values are refused while the others run, and that unknown columns
   !> are an error.
   subroutine check_refused()
      character(6), parameter :: methods(3) = [character(6) :: 'auto', 'dop853', 'adams']
      type(case_t) :: case
      type(spectrum_t) :: rows
      type(error_t), allocatable :: error
      character(24) :: status(4, 1, 1)
      integer :: i

      if (.not. checks%wants('refused')) return
      do i = 1, size(methods)
         call read_scene(wall//loss//pulses, case)
         case%solver%method = trim(methods(i))
         call compute_rows(case, [character(12) :: 'T_s', 'wall.b'], reshape([1.0_wp, 0.5_wp, &
            -1.0_wp, 0.5_wp, 0.7_wp, -0.5_wp, 0.7_wp, 0.6_wp], [2, 4]), [character(20) ::], 1, &
            rows, error)
         call checks%no_error(error, 'refused')
         status = status_of(rows)
         call checks%that(all(status(:, 1, 1) == [character(24) :: 'ok', 'refused', 'refused', &
            'ok']), 'refused: status, '//trim(methods(i)))
         call checks%that(all((rows%values(:, 1, 1, 1) > 0) .eqv. status(:, 1, 1) == 'ok'), &
            'refused: no value, '//trim(methods(i)))
      end do
      call compute_rows(case, [character(12) :: 'wall.width'], reshape([1.0_wp], [1, 1]), &
         [character(20) ::], 1, rows, error)
      call checks%that(allocated(error), 'refused: unknown column')
      call check_twice('T_s', 'frame.T_s')
      call check_twice('gamma', 'Frame.Gamma')
      call check_twice('wall.b', 'b')
      call compute_rows(case, [character(12) :: 'T_s'], reshape([1.0_wp], [1, 1]), &
         [character(20) :: 'drift'], 1, rows, error)
      call checks%that(allocated(error), 'refused: unknown quantity')
      call read_scene(wall//loss//pulses//"&spectrum T_s=1.0, quantities='impacts' /", case)
      call compute_rows(case, [character(12) :: 'T_s'], reshape([1.0_wp], [1, 1]), &
         [character(20) :: 'drift'], 1, rows, error)
      call checks%that(allocated(error), 'refused: unknown quantity, another in the case')
      if (.not. allocated(error)) return
      call checks%that(index(error%message, '&spectrum') == 0, 'refused: asked by the call')
   end subroutine check_refused

   !> Check that the message names both when a table has an axis and its key.
   subroutine check_twice(first, second)
      character(*), intent(in) :: first, second
      type(case_t) :: case
      type(spectrum_t) :: rows
      type(error_t), allocatable :: error
      character(12) :: columns(2)

      columns(1) = first
      columns(2) = second
      call read_scene(wall//loss//pulses, case)
      call compute_rows(case, columns, reshape([1.0_wp, 2.0_wp], [2, 1]), [character(20) ::], 1, &
         rows, error)
      call checks%that(allocated(error), 'twice: '//first//', '//second)
      if (.not. allocated(error)) return
      call checks%that(index(error%message, first) > 0 .and. index(error%message, second) > 0, &
         'twice: names both, '//first)
   end subroutine check_twice

   !> Check that `accuracy` and `verify` of rows give the values of their single runs.
   subroutine check_accuracy()
      type(case_t) :: case, single
      type(spectrum_t) :: rows
      type(result_t) :: run
      type(error_t), allocatable :: error
      real(wp) :: values(2, 4)
      integer :: i

      if (.not. checks%wants('accuracy')) return
      case = shaken_scene('exact', 'record')
      case%solver%method = 'dop853'
      case%solver%verify = .true.
      case%solver%accuracy = 1.0e-6_wp
      values = reshape([0.5_wp, 1.0_wp, 0.8_wp, 1.2_wp, 1.1_wp, -0.9_wp, 1.7_wp, 1.1_wp], [2, 4])
      call compute_rows(case, [character(5) :: 'T_s', 'scale'], values, [character(24) :: &
         'u_s_max_m', 'sensitivity', 'estimated_relative_error'], 1, rows, error)
      call checks%no_error(error, 'accuracy')
      do i = 1, size(values, 2)
         single = case
         single%frame%T_s = values(1, i)
         single%record%factor = values(2, i)
         call simulate(single, run, error)
         call checks%no_error(error, 'accuracy, single run')
         call checks%that(all(abs(rows%values(i, 1, 1, :) - [run%u_s_max, run%sensitivity, &
            run%estimated_relative_error]) <= 0), 'accuracy: bits')
      end do
   end subroutine check_accuracy

   !> Check that rows with separate accuracies have the bits of their single runs, by every method.
   !> Rows whose accuracy is below round-off are 'inaccurate'.
   subroutine check_own_accuracy()
      character(6), parameter :: methods(3) = [character(6) :: 'auto', 'dop853', 'adams']
      type(case_t) :: case, single
      type(spectrum_t) :: rows
      type(result_t) :: run
      type(error_t), allocatable :: error
      character(24) :: status(n, 1, 1), expected
      real(wp) :: values(2, n)
      integer :: i, k

      if (.not. checks%wants('own accuracy')) return
      do i = 1, n
         values(:, i) = [0.5_wp + 0.1_wp*i, merge(6.1e-14_wp, 10.0_wp**(-2 - mod(i, 7)), i > n/2)]
      end do
      do k = 1, size(methods)
         call read_case_text(wall//loss//pulses//" &solver t_end=8.0, method='" &
            //trim(methods(k))//"' /", 'scene', case, error)
         call checks%no_error(error, 'own accuracy, '//methods(k))
         call compute_rows(case, [character(15) :: 'T_s', 'solver.accuracy'], values, &
            [character(20) ::], 2, rows, error)
         call checks%no_error(error, 'own accuracy, rows, '//methods(k))
         status = status_of(rows)
         do i = 1, n
            single = case
            single%frame%T_s = values(1, i)
            single%solver%accuracy = values(2, i)
            call simulate(single, run, error)
            call checks%no_error(error, 'own accuracy, single run')
            call checks%that(abs(rows%values(i, 1, 1, 1) - run%u_s_max) <= 0, &
               'own accuracy: bits, '//methods(k))
            expected = 'ok'
            if (allocated(run%estimated_relative_error)) expected = merge('inaccurate', &
               'ok        ', run%estimated_relative_error > values(2, i))
            call checks%that(status(i, 1, 1) == expected, 'own accuracy: status, '//methods(k))
         end do
      end do
      call checks%that(any(status == 'inaccurate'), 'own accuracy: round-off of adams')
   end subroutine check_own_accuracy

   subroutine read_scene(text, case)
      character(*), intent(in) :: text
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_text(text//' &solver t_end=4.0, rtol=1.0e-7, method=''dop853'' /', 'scene', &
         case, error)
      call checks%no_error(error, text)
   end subroutine read_scene

   !> Compare rows with other values of some keys with single runs of the same values, by the same
   !> method. Two threads and another order give the same bits.
   subroutine check_runs(name, text, keys, quantity)
      character(*), intent(in) :: name
      character(*), intent(in) :: text
      character(*), intent(in) :: keys(:)
      character(*), intent(in), optional :: quantity
      type(case_t) :: case, single
      type(spectrum_t) :: rows, reversed
      type(result_t) :: run
      type(error_t), allocatable :: error
      real(wp) :: values(size(keys), n)
      character(40) :: wanted(1)
      character(24) :: status(n, 1, 1)
      real(wp) :: found
      integer :: i

      if (.not. checks%wants(name)) return
      wanted = 'u_s_max_m'
      if (present(quantity)) wanted = quantity
      call read_scene(text, case)
      do i = 1, n
         values(:, i) = numbers_of_row(case, keys, i)
      end do
      call compute_rows(case, keys, values, wanted, 1, rows, error)
      call checks%no_error(error, name)
      if (allocated(error)) return
      status = status_of(rows)
      do i = 1, n
         call set_numbers(case, keys, values(:, i), single)
         call simulate(single, run, error)
         call checks%no_error(error, name//', single run')
         if (allocated(run%u_s_max)) then
            found = run%u_s_max
         else
            found = run%theta_max_over_alpha
         end if
         call checks%that(abs(rows%values(i, 1, 1, 1) - found) <= 0, name//': bits of a single run')
         call checks%that(status(i, 1, 1) == ending_name(run), name//': status')
      end do
      call compute_rows(case, keys, values(:, n:1:-1), wanted, 2, reversed, error)
      call checks%that(all(abs(rows%values - reversed%values(n:1:-1, :, :, :)) <= 0), &
         name//': bits in another order and in two threads')
   end subroutine check_runs

   !> Values around those of the case.
   function numbers_of_row(case, keys, i) result(values)
      use rwmf_problem_group_values, only: real_of
      type(case_t), intent(in) :: case
      character(*), intent(in) :: keys(:)
      integer, intent(in) :: i
      real(wp) :: values(size(keys))
      integer :: k, dot

      do k = 1, size(keys)
         dot = index(keys(k), '.')
         values(k) = real_of(case%values, keys(k)(:dot - 1), trim(keys(k)(dot + 1:))) &
            *(1 + 0.3_wp*sin(real(7*i + 3*k, wp)))
         ! a coefficient of restitution stays below one; each second exponent is a natural number
         if (keys(k) == 'impact.e') values(k) = 0.9_wp + 0.05_wp*sin(real(i, wp))
         if (keys(k) == 'yielding.exponent' .and. mod(i, 2) == 0) values(k) = 2
         if (keys(k) == 'yielding.beta') values(k) = 0.5_wp
         if (keys(k) == 'solver.rtol') values(k) = 10.0_wp**(-6 - mod(i, 4))
      end do
   end function numbers_of_row

   !> Read the text of a case with these values of the keys.
   subroutine set_numbers(case, keys, values, single)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: keys(:)
      real(wp), intent(in) :: values(:)
      type(case_t), intent(out) :: single
      character(:), allocatable :: text
      type(error_t), allocatable :: error
      character(26) :: number
      integer :: k, dot, first, last

      text = case%text
      do k = 1, size(keys)
         dot = index(keys(k), '.')
         write (number, '(es25.17e3)') values(k)
         first = index(text, '&'//keys(k)(:dot - 1)//' ')
         if (first == 0) then
            text = text//' &'//keys(k)(:dot - 1)//' '//trim(keys(k)(dot + 1:))//'=' &
               //trim(adjustl(number))//' /'
            cycle
         end if
         last = first + index(text(first:), '/') - 2
         dot = index(text(first:last), ' '//trim(keys(k)(dot + 1:))//'=')
         if (dot == 0) then
            text = text(:last)//', '//trim(keys(k)(index(keys(k), '.') + 1:))//'=' &
               //trim(adjustl(number))//text(last + 1:)
            cycle
         end if
         first = first + dot + index(text(first + dot:), '=') - 1
         dot = first + scan(text(first + 1:), ' ,/')
         text = text(:first)//trim(adjustl(number))//text(dot:)
      end do
      call read_case_text(text, 'scene', single, error)
      call checks%no_error(error, text)
   end subroutine set_numbers

end program test_rows
