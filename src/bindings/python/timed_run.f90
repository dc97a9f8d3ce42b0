!> Results of one simulation for a comparison of methods: numbers, impact times and cost, in one
!> form for every method and for the reference.
module rwmf_bindings_python_timed_run
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, i8, wp
   use rwmf_embedding_ranges, only: not_negative, positive, require_number
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_problem_group_values, only: has_key
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: value_of
   use rwmf_problem_record, only: record_t
   use rwmf_problem_rules, only: fail_key
   use rwmf_simulation_peak, only: ask_for_peak, peak_of
   use rwmf_simulation_run, only: run_once
   use rwmf_simulation_simulate, only: check_peak
   use rwmf_simulation_state_result, only: event_impact, result_t
   implicit none
   private

   public :: timed_run_t, measure_method, value_names, empty_measured
   public :: put_measured, halve_intervals
   public :: at_u_s_max, at_theta_max, at_theta_end, at_theta_dot_end, at_t_end

   integer, parameter :: n_values = 8
   integer, parameter :: at_u_s_max = 1
   integer, parameter :: at_t_u_s_max = 2
   integer, parameter :: at_theta_max = 3
   integer, parameter :: at_theta_dot_max = 4
   integer, parameter :: at_theta_end = 5
   integer, parameter :: at_theta_dot_end = 6
   integer, parameter :: at_t_end = 7
   integer, parameter :: at_peak = 8
   character(1), parameter :: feed = new_line('a')
   character(*), parameter :: value_names = 'u_s_max_m'//feed//'t_u_s_max_s'//feed &
      //'theta_max_rad'//feed//'theta_dot_max_rad_s'//feed//'theta_end_rad'//feed &
      //'theta_dot_end_rad_s'//feed//'t_end_s'//feed//'peak'//feed
   !! one per line; the last one is the quantity of `&solver accuracy_of`, in its unit

   !> Results of one simulation in numbers.
   type :: timed_run_t
      real(wp) :: values(n_values)
      !! in the order and the units of `value_names`; NaN if not applicable to the scene
      real(wp), allocatable :: impact_times(:)
      !! (impacts) [s]
      integer(i8) :: steps = 0_i8
      integer(i8) :: rhs_evaluations = 0_i8
      logical :: overturned = .false.
      real(wp) :: seconds = huge(1.0_wp)
      !! processor time of one run without stored results, the fastest of all repeats [s]
   end type timed_run_t

contains

   !> Return an empty measurement.
   type(timed_run_t) function empty_measured() result(measured)

      measured%values = ieee_value(1.0_wp, ieee_quiet_nan)
      allocate (measured%impact_times(0))
   end function empty_measured

   !> Run a case with another method and tolerance.
   !>
   !> Errors: no duration, an invalid tolerance, and those of `check_peak` and `run_once`.
   subroutine measure_method(case, method, rtol, budget, control, measured, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: method
      !! as `&solver method`
      real(wp), intent(in) :: rtol
      !! in (0, 1), as `&solver rtol` [-]
      real(wp), intent(in) :: budget
      !! total time of repeated runs; 0 for a single run [s]
      type(control_t), intent(in) :: control
      type(timed_run_t), intent(out) :: measured
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_repeats = 1000, least_repeats = 3
      type(case_t) :: trial
      type(motion_t), target :: motion
      type(result_t) :: result
      real(wp) :: spent
      real(wp) :: started
      real(wp) :: finished
      integer :: repeats

      measured = empty_measured()
      call check_measurable(case, rtol, budget, error)
      if (allocated(error)) return
      motion = motion_from_case(case)
      call check_peak(case, motion, error)
      if (allocated(error)) return
      trial = plain_case(case, method, rtol)
      ! two rows of history, because events are stored only with a history
      if (.not. allocated(trial%output)) trial%output = output_t(energy=.false.)
      trial%output%dt = trial%solver%t_end
      call cpu_time(started)
      call run_once(trial, motion, control, result, error)
      if (allocated(error)) return
      call cpu_time(measured%seconds)
      measured%seconds = measured%seconds - started
      associate (values => measured%values)
         values([at_u_s_max, at_t_u_s_max, at_theta_dot_max]) = value_of(result%values, &
            [id%u_s_max_m, id%t_u_s_max_s, id%theta_dot_max_rad_s], 1)
         if (allocated(result%theta_max)) values(at_theta_max) = max(result%theta_max, &
            -result%theta_min)
         values(at_theta_end) = result%final_state(1)
         values(at_theta_dot_end) = result%final_state(2)
         values(at_t_end) = result%t_end
         if (trial%solver%accuracy_of /= '') values(at_peak) = peak_of(trial, result)
      end associate
      measured%impact_times = pack(result%events%t, result%events%kind == event_impact)
      if (.not. result%has_impacts) measured%impact_times = [real(wp) ::]
      measured%steps = result%steps
      measured%rhs_evaluations = result%rhs_evaluations
      measured%overturned = result%overturned
      trial = plain_case(case, method, rtol)
      spent = measured%seconds
      if (.not. budget > 0) return
      do repeats = 0, most_repeats - 1
         if (spent > budget .and. repeats >= least_repeats) exit
         if (spent > 3*budget .and. repeats >= 1) exit
         call cpu_time(started)
         call run_once(trial, motion, control, result, error)
         if (allocated(error)) return
         call cpu_time(finished)
         measured%seconds = min(measured%seconds, finished - started)
         spent = spent + finished - started
      end do
   end subroutine measure_method

   !> Check duration, tolerance and budget of a measurement.
   subroutine check_measurable(case, rtol, budget, error)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: rtol
      !! [-]
      real(wp), intent(in) :: budget
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: problem = 'must be > 0: a run of no duration has no cost'

      call require_number(rtol, 'rtol', positive, error)
      call require_number(budget, 'budget', not_negative, error)
      if (allocated(error)) return
      if (rtol >= 1) then
         call fail(error, err_input, 'rtol must be < 1')
      else if (.not. case%solver%t_end > 0) then
         if (has_key(case%values, 'solver', 't_end')) then
            call fail_key(case%values, 'solver', 't_end', problem, error)
         else
            call fail(error, err_input, '&solver: t_end = 0 '//problem)
         end if
      end if
   end subroutine check_measurable

   !> Return the case without outputs that take time besides the integration, with tolerances
   !> derived from rtol.
   type(case_t) function plain_case(case, method, rtol) result(plain)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: method
      real(wp), intent(in) :: rtol

      plain = case
      plain%solver%method = method
      plain%solver%rtol = rtol
      plain%solver%verify = .false.
      if (allocated(plain%solver%accuracy)) deallocate (plain%solver%accuracy)
      if (allocated(plain%solver%atol)) deallocate (plain%solver%atol)
      if (allocated(plain%output)) deallocate (plain%output)
      call ask_for_peak(plain)
   end function plain_case

   !> Copy a measurement into a caller's arrays in double precision, up to their sizes.
   pure subroutine put_measured(measured, values, counts, impact_times)
      type(timed_run_t), intent(in) :: measured
      real(dp), intent(inout) :: values(:)
      !! in the order and the units of `value_names`; values beyond the eighth are unchanged
      integer(i8), intent(out) :: counts(4)
      !! steps, right-hand sides, impacts, overturned
      real(dp), intent(inout) :: impact_times(:)
      !! [s]
      integer :: n

      n = min(size(values), n_values)
      values(:n) = real(measured%values(:n), dp)
      n = min(size(impact_times), size(measured%impact_times))
      impact_times(:n) = real(measured%impact_times(:n), dp)
      counts = [measured%steps, measured%rhs_evaluations, size(measured%impact_times, kind=i8), &
         merge(1_i8, 0_i8, measured%overturned)]
   end subroutine put_measured

   !> Insert a sample in the middle of each interval of a record. The motion is unchanged, in twice
   !> as many pieces. A method that stops at every sample then takes other steps. Therefore the
   !> results differ by its error even where the samples, not the tolerance, determine the steps.
   pure subroutine halve_intervals(record)
      type(record_t), intent(inout) :: record
      real(wp), allocatable :: t(:)
      real(wp), allocatable :: a(:)
      integer :: n

      n = record%n
      allocate (t(2*n - 1), a(2*n - 1))
      t(1::2) = record%t
      a(1::2) = record%a
      t(2::2) = (record%t(:n - 1) + record%t(2:))/2
      a(2::2) = (record%a(:n - 1) + record%a(2:))/2
      call move_alloc(t, record%t)
      call move_alloc(a, record%a)
      record%n = 2*n - 1
   end subroutine halve_intervals

end module rwmf_bindings_python_timed_run
