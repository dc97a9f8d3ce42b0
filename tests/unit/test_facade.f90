!> Public interface as a host program uses it, with `use rwmf` only.
program test_facade
   use check, only: checks_t
   use rwmf, only: case_t, compute_spectrum, control_t, err_input, err_interrupt, err_numerical, &
      error_t, i8, read_case_text, result_t, simulate, spectrum_t, status_of, &
      version, wp
   implicit none

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: scene = '&wall h = 2.0, b = 0.5 /'//nl &
      //'&cable eta_0 = 1.0, eta_alpha = 5.0 /'//nl &
      //'&impact rule = "constant", e = 0.9 /'//nl &
      //'&motion kind = "one_cosine", a_max_g = 0.5, T_p = 1.0 /'//nl &
      //'&model formulation = "symmetric" /'//nl &
      //'&solver t_end = 5.0 /'//nl
   character(*), parameter :: frame = '&frame T_s = 1.0, gamma = 10.0, xi_s = 0.02 /'//nl
   character(*), parameter :: history = '&output dt = 0.01 /'//nl
   character(*), parameter :: periods = &
      '&spectrum T_s_min = 1.0, T_s_max = 2.0, n = 3, gamma = 10.0, 100.0 /'//nl
   type(checks_t) :: checks

   call checks%that(len(version) > 0, 'version')
   if (checks%wants('simulate')) call test_simulate()
   if (checks%wants('history_changes_nothing')) call test_history_changes_nothing()
   if (checks%wants('spectrum_is_simulate')) call test_spectrum_is_simulate()
   if (checks%wants('bad_case')) call test_bad_case()
   if (checks%wants('bad_modes')) call test_bad_modes()
   if (checks%wants('no_period')) call test_no_period()
   if (checks%wants('cancel')) call test_cancel()
   if (checks%wants('many_threads')) call test_many_threads()
   if (checks%wants('threads')) call test_threads()
   call checks%finish()

contains

   !> A run gives the maxima that apply; a second run has the same bits.
   subroutine test_simulate()
      type(result_t) :: first
      type(result_t) :: second

      call run(scene//frame, first)
      call run(scene//frame, second)
      call checks%that(allocated(first%u_s_max), 'a frame has a displacement')
      call checks%that(allocated(first%cable_increment_max), 'a cable has a force')
      call checks%that(.not. allocated(first%history), 'no &output, no history')
      call checks%that(first%u_s_max > 0.0_wp, 'the frame moves')
      call checks%that(same_bits(first%u_s_max, second%u_s_max), 'the same bits again')
   end subroutine test_simulate

   !> The grid of the output does not influence the integration.
   subroutine test_history_changes_nothing()
      type(result_t) :: without
      type(result_t) :: with

      call run(scene//frame, without)
      call run(scene//frame//history, with)
      call checks%that(allocated(with%history) .and. allocated(with%events), 'history')
      call checks%that(same_bits(with%u_s_max, without%u_s_max), 'history changes nothing')
      call checks%that(with%steps == without%steps, 'history takes no steps')
   end subroutine test_history_changes_nothing

   !> An ordinate of a spectrum has the bits of its simulation with the same method.
   subroutine test_spectrum_is_simulate()
      type(case_t) :: case
      type(spectrum_t) :: spectrum
      type(result_t) :: result
      type(error_t), allocatable :: error

      call run(scene//frame, result)
      call read_case_text(scene//frame//periods, '', case, error)
      if (.not. allocated(error)) then
         case%solver%method = result%method
         call compute_spectrum(case, 2, spectrum, error)
      end if
      call checks%no_error(error, 'spectrum')
      if (allocated(error)) return
      call checks%that(all(shape(spectrum%values) == [3, 2, 1, 1]), 'shape of the spectrum')
      call checks%that(all(status_of(spectrum) == 'ok'), 'all ordinates')
      call checks%that(same_bits(spectrum%values(1, 1, 1, 1), result%u_s_max), &
         'ordinate is simulation')
   end subroutine test_spectrum_is_simulate

   !> An invalid case gives an error value.
   subroutine test_bad_case()
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text('&wall h = -2.0, b = 0.5 /', '', case, error)
      call checks%has_error(error, err_input, '&wall: h = -2', 'negative height')
   end subroutine test_bad_case

   !> An error of an eigenvalue computation during reading is returned as the error of the case.
   subroutine test_bad_modes()
      character(*), parameter :: storeys = '&frame xi_s = 0.05 /'//nl &
         //'&storeys m_over_m_w = 1.0 1.0 1.0 1.0 1.0, '//nl &
         //'   k_over_m_w = 1e9 1e-9 1e9 1e-9 1e-9, '//nl &
         //'   height = 0.8 0.8 0.8 0.8 0.8, coupling = "full" /'//nl
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(scene//storeys, '', case, error)
      call checks%has_error(error, err_numerical, 'DSYGV', 'modes that cannot be found')
   end subroutine test_bad_modes

   !> A frame whose periods are those of `&spectrum` has a spectrum; `simulate` returns an error.
   subroutine test_no_period()
      type(case_t) :: case
      type(result_t) :: result
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error
      integer :: i

      call read_case_text(scene//'&frame gamma = 10.0, xi_s = 0.02 /'//nl//periods, '', case, error)
      call checks%no_error(error, 'a frame without period')
      do i = 1, 3
         if (i == 2) case%solver%verify = .true.
         if (i == 3) case%solver%accuracy = 1.0e-3_wp
         call simulate(case, result, error)
         call checks%has_error(error, err_input, '&frame (line 7): the key T_s', 'no period')
      end do
      case%solver%verify = .false.
      deallocate (case%solver%accuracy)
      call compute_spectrum(case, 1, spectrum, error)
      call checks%no_error(error, 'its spectrum')
   end subroutine test_no_period

   !> A set flag stops a run and a spectrum.
   subroutine test_cancel()
      type(case_t) :: case
      type(result_t) :: result
      type(spectrum_t) :: spectrum
      type(control_t) :: control
      type(error_t), allocatable :: error
      integer(i8), target :: done
      integer(i8), target :: cancel

      done = 0_i8
      cancel = 1_i8
      control%done => done
      control%cancel => cancel
      call read_case_text(scene//frame//periods, '', case, error)
      if (.not. allocated(error)) call simulate(case, result, error, control)
      call checks%has_error(error, err_interrupt, 'interrupted', 'cancelled run')
      call compute_spectrum(case, 1, spectrum, error, control)
      call checks%has_error(error, err_interrupt, 'interrupted', 'cancelled spectrum')
   end subroutine test_cancel

   !> Unreasonable numbers of threads.
   subroutine test_many_threads()
      integer, parameter :: none(3) = [-1, 100000, huge(1)]
      type(case_t) :: case
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error
      integer :: i

      call read_case_text(scene//frame//periods, '', case, error)
      do i = 1, size(none)
         call compute_spectrum(case, none(i), spectrum, error)
         call checks%has_error(error, err_input, 'threads = ', 'threads')
      end do
      call compute_spectrum(case, 40, spectrum, error)
      call checks%no_error(error, 'forty threads')
   end subroutine test_many_threads

   !> Simulations in several threads do not influence each other.
   subroutine test_threads()
      integer, parameter :: runs = 8
      type(result_t) :: results(runs)
      logical :: equal
      integer :: i

      !$omp parallel do
      do i = 1, runs
         call run(scene//frame, results(i))
      end do
      !$omp end parallel do
      equal = .true.
      do i = 2, runs
         equal = equal .and. same_bits(results(i)%u_s_max, results(1)%u_s_max)
      end do
      call checks%that(equal, 'the same bits in all threads')
   end subroutine test_threads

   !> Read and run a valid case.
   subroutine run(text, result)
      character(*), intent(in) :: text
      type(result_t), intent(out) :: result
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(text, '', case, error)
      if (.not. allocated(error)) call simulate(case, result, error)
      if (.not. allocated(error)) return
      !$omp critical
      call checks%that(.false., 'run: '//error%message)
      !$omp end critical
   end subroutine run

   !> True if two reals are equal to the last bit.
   logical function same_bits(a, b)
      real(wp), intent(in) :: a
      real(wp), intent(in) :: b
      character(storage_size(1.0_wp)/8) :: mould

      same_bits = transfer(a, mould) == transfer(b, mould)
   end function same_bits

end program test_facade
