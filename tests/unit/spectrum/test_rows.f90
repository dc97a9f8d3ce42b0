!> Rows of a table: each has the bits of the single run, or of the spectrum, of its own case.
program test_rows
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_result, only: ending_name, result_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_spectrum_spectrum, only: compute_rows, compute_spectrum, spectrum_t, status_of
   implicit none

   integer, parameter :: n = 20
   !! rows, more than a team has lanes
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
   call check_runs('fuses', wall//loss//pulses//'&fuse eta_y=0.3, stroke_y=0.005, hardening=0.02 / ' &
      //'&yielding u_y=0.02, hardening=0.05 /', [character(20) :: 'fuse.eta_y', 'fuse.stroke_y', &
      'yielding.u_y', 'yielding.hardening'])
   call check_runs('smooth', wall//loss//pulses//"&yielding u_y=0.02, law='bouc_wen', exponent=2 /", &
      [character(20) :: 'yielding.exponent', 'yielding.beta'])
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
   call checks%finish()

contains

   subroutine read_scene(text, case)
      character(*), intent(in) :: text
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_text(text//' &solver t_end=4.0, rtol=1.0e-7, method=''dop853'' /', 'scene', &
         case, error)
      call checks%no_error(error, text)
   end subroutine read_scene

   !> Rows with other numbers of some keys against single runs of texts with these numbers, by the
   !> same method; with two threads and in another order the same bits.
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

   !> Numbers around those of the case.
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
         ! a factor of impacts stays below one; each second exponent is a natural number
         if (keys(k) == 'impact.e') values(k) = 0.9_wp + 0.05_wp*sin(real(i, wp))
         if (keys(k) == 'yielding.exponent' .and. mod(i, 2) == 0) values(k) = 2
         if (keys(k) == 'yielding.beta') values(k) = 0.5_wp
         if (keys(k) == 'solver.rtol') values(k) = 10.0_wp**(-6 - mod(i, 4))
      end do
   end function numbers_of_row

   !> The case that a text with these numbers says.
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
