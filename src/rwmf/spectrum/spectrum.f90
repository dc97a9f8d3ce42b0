!> Response spectra: the loop over frame periods, mass ratios and widths of the wall, in parallel.
module rwmf_spectrum_spectrum
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_error, only: err_input, err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_factory, only: spectrum_method
   use rwmf_model_assembly, only: build_equation, equation_t
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, spectrum_spec_t
   use rwmf_simulation_result, only: ending_name, result_t
   use rwmf_simulation_simulate, only: simulate_with_motion
   use rwmf_simulation_warnings, only: broken_laws, tell_broken_laws
   use rwmf_spectrum_estimates, only: run_with_estimates
   use rwmf_spectrum_fast_bare_frame, only: run_frames
   use rwmf_spectrum_fast_driver, only: run_fast
   use rwmf_spectrum_fast_eligibility, only: is_supported
   use rwmf_spectrum_fast_schedule, only: order_by_cost
   use rwmf_spectrum_lanes, only: ordinate_t
   use rwmf_spectrum_quantities, only: asked_of, asked_t, check_asked, follow_from_displacement, &
      take_values, values_from_displacement
   use rwmf_spectrum_threads, only: choose_threads
   implicit none
   private

   public :: spectrum_t, compute_spectrum, spectrum_periods

   !> What is reported over the grid of a `&spectrum` group.
   type :: spectrum_t
      real(wp), allocatable :: T_s(:)
      !! (n_T) periods [s]
      real(wp), allocatable :: gamma(:)
      !! (n_gamma) mass ratios [-]; absent for the bare frame
      real(wp), allocatable :: b(:)
      !! (n_b) half widths [m]; absent for the bare frame
      real(wp), allocatable :: u_s_max(:, :, :)
      !! (n_T, n_gamma, n_b) [m]; NaN where the simulation failed
      character(40), allocatable :: quantities(:)
      !! (n_quantities) keys of what was asked for
      real(wp), allocatable :: values(:, :, :, :)
      !! (n_T, n_gamma, n_b, n_quantities) [unit of each]; a count or yes (1) or no (0) is a number,
      !! too; NaN where the simulation failed, or where there is nothing to report
      character(24), allocatable :: status(:, :, :)
      !! (n_T, n_gamma, n_b) 'ok', 'overturned', 'collapsed', 'inaccurate' (the values are the best
      !! that there are, but err by more than `accuracy`) or the name of an error
      integer(i8) :: rhs_evaluations
      real(wp) :: seconds
      !! wall-clock time [s]
      integer :: threads
      !! number of threads used
      character(160), allocatable :: warnings(:)
      !! what the user should know about all ordinates
   end type spectrum_t

contains

   !> Compute the spectrum of a case's `&spectrum` group.
   !>
   !> Each ordinate is a simulation of its own, so that the result has the same bits for every
   !> number of threads. An ordinate that fails gets NaN and the name of its error; the others go
   !> on.
   subroutine compute_spectrum(case, threads, spectrum, error, control, known_motion)
      type(case_t), intent(in) :: case
      integer, intent(in) :: threads
      !! number of threads; 0 for all that OpenMP offers
      type(spectrum_t), intent(out) :: spectrum
      type(error_t), allocatable, intent(out) :: error
      !! no `&spectrum`, quantities that do not apply, too many threads, no memory, or interrupted
      type(control_t), intent(in), optional :: control
      type(motion_t), intent(in), optional :: known_motion
      !! of the case, when the caller holds it
      type(asked_t) :: asked
      type(motion_t), target :: motion
      type(control_t) :: signals
      integer(i8) :: started
      integer(i8) :: finished
      integer(i8) :: rate
      integer :: threads_to_use
      logical :: is_broken(2)

      if (.not. allocated(case%spectrum)) then
         call fail(error, err_input, 'no &spectrum group: nothing to loop over')
         return
      end if
      call choose_threads(threads, threads_to_use, error)
      if (allocated(error)) return
      if (present(control)) signals = control
      call system_clock(started, rate)
      if (present(known_motion)) then
         motion = known_motion
      else
         motion = motion_from_case(case)
      end if
      call check_asked(case, motion, error)
      if (allocated(error)) return
      asked = asked_of(case)
      call prepare_grid(case, asked, spectrum, error)
      if (allocated(error)) return
      spectrum%threads = threads_to_use
      is_broken = broken_laws(case, .true.)
      spectrum%warnings = pack([tell_broken_laws(is_broken)], [any(is_broken)])
      call run_all(case, asked, motion, signals, spectrum)
      if (asked%is_displacement) spectrum%values(:, :, :, 1) = spectrum%u_s_max
      call system_clock(finished)
      spectrum%seconds = real(finished - started, wp)/real(rate, wp)
      if (is_cancelled(signals)) call fail(error, err_interrupt, 'spectrum interrupted')
   end subroutine compute_spectrum

   !> Allocate the results on the grid of a case's `&spectrum` group.
   pure subroutine prepare_grid(case, asked, spectrum, error)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(spectrum_t), intent(inout) :: spectrum
      type(error_t), allocatable, intent(out) :: error
      integer :: n_gamma
      integer :: n_b
      integer :: status

      spectrum%T_s = spectrum_periods(case%spectrum)
      n_gamma = 1
      n_b = 1
      if (allocated(case%wall)) then
         if (allocated(case%spectrum%gamma)) then
            spectrum%gamma = case%spectrum%gamma
         else
            spectrum%gamma = [case%frame%gamma]
         end if
         spectrum%b = [case%wall%b]
         if (allocated(case%spectrum%b)) spectrum%b = case%spectrum%b
         n_gamma = size(spectrum%gamma)
         n_b = size(spectrum%b)
      end if
      allocate (spectrum%u_s_max(size(spectrum%T_s), n_gamma, n_b), stat=status)
      if (status == 0) then
         allocate (spectrum%status(size(spectrum%T_s), n_gamma, n_b), stat=status)
      end if
      if (status == 0) then
         allocate (spectrum%values(size(spectrum%T_s), n_gamma, n_b, size(asked%keys)), stat=status)
      end if
      if (status /= 0) then
         call fail(error, err_numerical, 'out of memory for the spectrum', 'out_of_memory')
         return
      end if
      spectrum%quantities = asked%keys
      spectrum%u_s_max = ieee_value(1.0_wp, ieee_quiet_nan)
      spectrum%values = ieee_value(1.0_wp, ieee_quiet_nan)
      spectrum%status = 'interrupted'
      spectrum%rhs_evaluations = 0_i8
   end subroutine prepare_grid

   !> Periods of a `&spectrum`: the list, or the grid with both ends included [s].
   pure function spectrum_periods(spec) result(T_s)
      type(spectrum_spec_t), intent(in) :: spec
      real(wp), allocatable :: T_s(:)
      !! (n_T)
      real(wp) :: x
      integer :: i

      if (allocated(spec%T_s)) then
         T_s = spec%T_s
         return
      end if
      allocate (T_s(spec%n))
      do i = 1, spec%n
         x = real(i - 1, wp)/real(max(1, spec%n - 1), wp)
         if (spec%spacing == 'log') then
            T_s(i) = spec%T_s_min*(spec%T_s_max/spec%T_s_min)**x
         else
            T_s(i) = spec%T_s_min + x*(spec%T_s_max - spec%T_s_min)
         end if
      end do
      if (spec%n > 1) T_s(spec%n) = spec%T_s_max
   end function spectrum_periods

   !> Compute all ordinates, with dynamic scheduling because short periods cost more.
   subroutine run_all(case, asked, motion, control, spectrum)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(spectrum_t), intent(inout) :: spectrum
      integer(i8) :: evaluations
      integer :: i

      if (spectrum_method(case%solver%method) == 'fast') then
         call run_lanes(case, asked, motion, control, spectrum)
      end if
      if (spectrum_method(case%solver%method) == 'fast' .or. case%solver%method == 'dop853') then
         call run_general_lanes(case, asked, motion, control, spectrum)
         return
      end if
      evaluations = 0_i8
      !$omp parallel do num_threads(spectrum%threads) schedule(dynamic) default(shared) &
      !$omp reduction(+:evaluations)
      do i = 1, size(spectrum%u_s_max)
         call run_one(case, asked, motion, control, spectrum, i, evaluations)
      end do
      !$omp end parallel do
      spectrum%rhs_evaluations = evaluations
   end subroutine run_all

   !> Compute the ordinates that method 'fast' covers, when all that is asked for follows from their
   !> displacements; the others keep their status.
   subroutine run_lanes(case, asked, motion, control, spectrum)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(spectrum_t), intent(inout) :: spectrum
      logical :: is_done(size(spectrum%T_s), size(spectrum%u_s_max, 2), size(spectrum%u_s_max, 3))
      type(case_t) :: column
      type(equation_t) :: equation
      real(wp), allocatable :: values(:, :)
      integer, allocatable :: done(:)
      integer :: i, j, k

      is_done = .false.
      if (.not. is_supported(case, motion)) return
      call begin_column(case, spectrum, 1, 1, column)
      call build_equation(column, motion, equation)
      if (.not. follow_from_displacement(asked, equation)) return
      if (allocated(case%wall)) then
         call run_fast(case, motion, spectrum%threads, control, spectrum%T_s, spectrum%gamma, &
            spectrum%b, spectrum%u_s_max, is_done)
      else
         call run_frames(case, motion, spectrum%threads, control, spectrum%T_s, &
            spectrum%u_s_max(:, 1, 1), is_done(:, 1, 1))
      end if
      where (is_done) spectrum%status = 'ok'
      if (asked%is_displacement) return
      do k = 1, size(is_done, 3)
         do j = 1, size(is_done, 2)
            call begin_column(case, spectrum, j, k, column)
            done = pack([(i, i=1, size(is_done, 1))], is_done(:, j, k))
            allocate (values(size(done), size(asked%keys)))
            call values_from_displacement(asked, column, motion, spectrum%u_s_max(done, j, k), &
               values)
            spectrum%values(done, j, k, :) = values
            deallocate (values)
         end do
      end do
   end subroutine run_lanes

   !> The case of the first ordinate of one mass ratio and width.
   subroutine begin_column(case, spectrum, j, k, column)
      type(case_t), intent(in) :: case
      type(spectrum_t), intent(in) :: spectrum
      integer, intent(in) :: j, k
      type(case_t), intent(out) :: column

      column%structure_t = case%structure_t
      column%solver = case%solver
      column%frame%T_s = spectrum%T_s(1)
      if (.not. allocated(column%wall)) return
      column%frame%gamma = spectrum%gamma(j)
      column%wall%b = spectrum%b(k)
   end subroutine begin_column

   !> Compute the ordinates that are still to be done in general lanes, the shortest periods first.
   subroutine run_general_lanes(case, asked, motion, control, spectrum)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(spectrum_t), intent(inout) :: spectrum
      type(ordinate_t), allocatable :: ordinates(:)
      integer, allocatable :: order(:), place(:)
      integer :: i, j, k, n, m

      order = order_by_cost(spectrum%T_s, spread(0, 1, size(spectrum%T_s)), 0)
      allocate (ordinates(size(spectrum%u_s_max)), place(size(spectrum%u_s_max)))
      n = 0
      do m = 1, size(order)
         i = order(m)
         do k = 1, size(spectrum%u_s_max, 3)
            do j = 1, size(spectrum%u_s_max, 2)
               if (spectrum%status(i, j, k) == 'ok') cycle
               n = n + 1
               ordinates(n)%T_s = spectrum%T_s(i)
               if (allocated(spectrum%gamma)) ordinates(n)%gamma = spectrum%gamma(j)
               if (allocated(spectrum%b)) ordinates(n)%b = spectrum%b(k)
               place(n) = i + size(spectrum%T_s)*(j - 1 + size(spectrum%u_s_max, 2)*(k - 1))
            end do
         end do
      end do
      call run_with_estimates(case, asked, motion, spectrum%threads, control, ordinates(:n))
      if (is_cancelled(control)) return
      spectrum%rhs_evaluations = sum(ordinates(:n)%rhs_evaluations)
      do m = 1, n
         i = mod(place(m) - 1, size(spectrum%T_s)) + 1
         j = mod((place(m) - 1)/size(spectrum%T_s), size(spectrum%u_s_max, 2)) + 1
         k = (place(m) - 1)/(size(spectrum%T_s)*size(spectrum%u_s_max, 2)) + 1
         spectrum%status(i, j, k) = ordinates(m)%failure
         if (ordinates(m)%failure /= '') cycle
         spectrum%u_s_max(i, j, k) = ordinates(m)%u_s_max
         if (allocated(ordinates(m)%values)) spectrum%values(i, j, k, :) = ordinates(m)%values
         spectrum%status(i, j, k) = merge('overturned', 'ok        ', ordinates(m)%overturned)
         if (ordinates(m)%collapsed) spectrum%status(i, j, k) = 'collapsed'
         if (ordinates(m)%is_inaccurate) spectrum%status(i, j, k) = 'inaccurate'
      end do
   end subroutine run_general_lanes

   !> Compute one ordinate by the general kernel, with local work space only: threads run it at
   !> once.
   subroutine run_one(case, asked, motion, control, spectrum, number, evaluations)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(spectrum_t), intent(inout) :: spectrum
      integer, intent(in) :: number
      !! number of the ordinate, T_s running fastest
      integer(i8), intent(inout) :: evaluations
      type(case_t) :: ordinate
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: i, j, k

      if (is_cancelled(control)) return
      i = mod(number - 1, size(spectrum%T_s)) + 1
      j = mod((number - 1)/size(spectrum%T_s), size(spectrum%u_s_max, 2)) + 1
      k = (number - 1)/(size(spectrum%T_s)*size(spectrum%u_s_max, 2)) + 1
      if (spectrum%status(i, j, k) == 'ok') return
      call begin_column(case, spectrum, j, k, ordinate)
      ordinate%solver%method = trim(spectrum_method(case%solver%method))
      ordinate%frame%T_s = spectrum%T_s(i)
      if (allocated(asked%output)) ordinate%output = asked%output
      call simulate_with_motion(ordinate, motion, control, result, error)
      call count_done(control)
      if (allocated(error)) then
         spectrum%status(i, j, k) = error%name
         return
      end if
      spectrum%u_s_max(i, j, k) = result%u_s_max
      call take_values(asked, ordinate, result, spectrum%values(i, j, k, :))
      spectrum%status(i, j, k) = ending_name(result)
      evaluations = evaluations + result%rhs_evaluations
   end subroutine run_one

end module rwmf_spectrum_spectrum
