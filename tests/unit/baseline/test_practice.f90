!> Convergence of the procedures of today's practice to the kernel's result, each with its order.
program test_practice
   use check, only: checks_t
   use rwmf_baseline_baseline_run, only: baseline_t, ode45_atol, ode45_rtol, &
      run_baseline, usual_interval
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: block_scene, frame_scene, rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('tight_ode45')) call test_tight_ode45(checks)
   if (checks%wants('default_ode45')) call test_default_ode45(checks)
   if (checks%wants('first_order')) call test_first_order(checks, 'rk4')
   if (checks%wants('first_order')) call test_first_order(checks, 'newmark')
   if (checks%wants('smooth_order')) call test_smooth_order(checks, 'rk4', 4)
   if (checks%wants('smooth_order')) call test_smooth_order(checks, 'newmark', 2)
   if (checks%wants('rest')) call test_rest(checks)
   if (checks%wants('overturning')) call test_overturning(checks)
   if (checks%wants('unknown_name')) call test_unknown_name(checks)
   if (checks%wants('no_period')) call test_no_period(checks)
   call checks%finish()

contains

   !> A frame without a period is an error.
   subroutine test_no_period(checks)
      type(checks_t), intent(inout) :: checks
      type(case_t) :: case
      type(baseline_t) :: baseline
      type(error_t), allocatable :: error

      case = rocking_scene()
      deallocate (case%frame%T_s)
      call run_baseline(case, 'rk4', 0.01_wp, ode45_rtol, ode45_atol, baseline, error)
      call checks%has_error(error, err_input, '&frame: the key T_s is missing', 'no period')
   end subroutine test_no_period

   !> A wall that begins to rock at once, so that uplift is no source of error.
   type(case_t) function rocking_scene() result(case)

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853')
      case%motion%kind = 'one_cosine'
      case%solver%rtol = 1.0e-12_wp
      case%solver%t_end = 3
   end function rocking_scene

   !> With tight tolerances the paper's procedure is accurate.
   subroutine test_tight_ode45(checks)
      type(checks_t), intent(inout) :: checks
      real(wp), parameter :: tight = 1.0e-11_wp
      real(wp), parameter :: allowed = 1.0e-8_wp
      !! error of some hundred steps of order 5
      real(wp), parameter :: allowed_of_maximum = 1.0e-5_wp
      !! the maximum is one of the stored points: (omega dt)**2/8
      type(case_t) :: case
      type(baseline_t) :: baseline
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = rocking_scene()
      call simulate(case, result, error)
      call checks%no_error(error, 'reference of ode45')
      call run_baseline(case, 'ode45', 0.01_wp, tight, tight, baseline, error)
      call checks%no_error(error, 'ode45 with tight tolerances')
      call checks%close_to(baseline%u_s_max, result%u_s_max, 'tight ode45: u_s_max', &
         rtol=allowed_of_maximum)
      call checks%close_to(baseline%final_state(1), result%final_state(1), 'tight ode45: theta', &
         rtol=allowed)
      call checks%that(size(baseline%impact_times) == result%impacts, 'tight ode45: impacts')
      case%model%formulation = 'published'
      call simulate(case, result, error)
      call run_baseline(case, 'ode45', 0.01_wp, tight, tight, baseline, error)
      call checks%close_to(baseline%final_state(1), result%final_state(1), &
         'tight ode45, published: theta', rtol=allowed)
   end subroutine test_tight_ode45

   !> MATLAB's default tolerances give only the first digits.
   subroutine test_default_ode45(checks)
      type(checks_t), intent(inout) :: checks
      type(case_t) :: case
      type(baseline_t) :: baseline
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: found

      case = rocking_scene()
      call simulate(case, result, error)
      call run_baseline(case, 'ode45', 0.01_wp, ode45_rtol, ode45_atol, baseline, error)
      call checks%no_error(error, 'ode45 with default tolerances')
      found = abs(baseline%u_s_max/result%u_s_max - 1)
      call checks%that(found < 0.05_wp .and. found > 1.0e-7_wp, 'default ode45: first digits')
      call checks%that(baseline%steps > 20 .and. baseline%steps < 500, 'default ode45: steps')
   end subroutine test_default_ode45

   !> An impact that is placed at the end of its step causes an error of the order of the step.
   subroutine test_first_order(checks, name)
      type(checks_t), intent(inout) :: checks
      character(*), intent(in) :: name
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: coarse
      real(wp) :: fine

      case = rocking_scene()
      call simulate(case, result, error)
      coarse = end_error(checks, case, name, 1.0e-3_wp, result%final_state)
      fine = end_error(checks, case, name, 1.0e-5_wp, result%final_state)
      ! the missed part of a step differs from impact to impact, so the ratio is not exactly 100
      call checks%that(coarse/fine > 20 .and. coarse/fine < 500, name//': first order at impacts')
      call checks%that(fine < 1.0e-3_wp, name//': tends to the kernel''s answer')
   end subroutine test_first_order

   !> Without impacts each method has its own order.
   subroutine test_smooth_order(checks, name, order)
      type(checks_t), intent(inout) :: checks
      character(*), intent(in) :: name
      integer, intent(in) :: order
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: coarse
      real(wp) :: fine

      case = frame_scene(0.7_wp, 'dop853')
      case%solver%rtol = 1.0e-13_wp
      case%solver%t_end = 2
      call simulate(case, result, error)
      call checks%no_error(error, name//': reference of the frame')
      coarse = end_error(checks, case, name, 0.01_wp, result%final_state)
      fine = end_error(checks, case, name, 0.005_wp, result%final_state)
      call checks%close_to(log(coarse/fine)/log(2.0_wp), real(order, wp), name//': order', &
         atol=0.2_wp)
   end subroutine test_smooth_order

   !> Difference of the states at the end, relative to the state.
   real(wp) function end_error(checks, case, name, dt, expected) result(found)
      type(checks_t), intent(inout) :: checks
      type(case_t), intent(in) :: case
      character(*), intent(in) :: name
      real(wp), intent(in) :: dt
      !! [s]
      real(wp), intent(in) :: expected(:)
      !! (states)
      type(baseline_t) :: baseline
      type(error_t), allocatable :: error

      call run_baseline(case, name, dt, 0.0_wp, 0.0_wp, baseline, error)
      call checks%no_error(error, name)
      found = norm2(baseline%final_state - expected)/norm2(expected)
   end function end_error

   !> A weak motion causes no uplift; a free block comes to rest.
   subroutine test_rest(checks)
      type(checks_t), intent(inout) :: checks
      character(7), parameter :: names(3) = ['ode45  ', 'rk4    ', 'newmark']
      type(case_t) :: weak
      type(case_t) :: free
      type(baseline_t) :: baseline
      type(error_t), allocatable :: error
      integer :: i

      weak = block_scene('dop853')
      weak%motion%a_max_g = 0.2_wp
      free = block_scene('dop853')
      free%motion%kind = 'none'
      allocate (free%initial)
      free%initial%theta_over_alpha = 0.3_wp
      free%initial%theta_dot = 0
      free%impact%rule = 'housner'
      free%solver%t_end = 30
      do i = 1, size(names)
         call run_baseline(weak, trim(names(i)), 0.01_wp, ode45_rtol, ode45_atol, baseline, error)
         call checks%that(baseline%steps == 0 .and. baseline%theta_max <= 0 &
            .and. baseline%t_end >= 10, trim(names(i))//': a weak motion lifts nothing')
         call run_baseline(free, trim(names(i)), 1.0e-3_wp, ode45_rtol, ode45_atol, baseline, error)
         call checks%no_error(error, trim(names(i))//': free rocking')
         ! the overshoot at an impact adds energy: walls with fixed steps may rattle forever
         call checks%that(abs(baseline%final_state(1)) < 1.0e-3_wp, trim(names(i))//': calms down')
         call checks%that(size(baseline%impact_times) > 5, trim(names(i))//': rocks before')
      end do
      call checks%close_to(usual_interval(weak), 0.01_wp, 'a hundredth of the pulse', &
         rtol=4*epsilon(1.0_wp))
      weak%motion%T_p = 2
      call checks%close_to(usual_interval(weak), 0.02_wp, 'the period given as such', &
         rtol=4*epsilon(1.0_wp))
      free%motion%omega_p = pi
   end subroutine test_rest

   !> A strong pulse overturns the block in all methods.
   subroutine test_overturning(checks)
      type(checks_t), intent(inout) :: checks
      character(7), parameter :: names(3) = ['ode45  ', 'rk4    ', 'newmark']
      type(case_t) :: case
      type(baseline_t) :: baseline
      type(error_t), allocatable :: error
      integer :: i

      case = block_scene('dop853')
      case%motion%a_max_g = 1.5_wp
      case%motion%omega_p = 3
      do i = 1, size(names)
         call run_baseline(case, trim(names(i)), 0.01_wp, ode45_rtol, ode45_atol, baseline, error)
         call checks%no_error(error, trim(names(i))//': strong pulse')
         call checks%that(baseline%overturned .and. baseline%t_end < case%solver%t_end, &
            trim(names(i))//': overturns')
      end do
   end subroutine test_overturning

   subroutine test_unknown_name(checks)
      type(checks_t), intent(inout) :: checks
      type(case_t) :: case
      type(baseline_t) :: baseline
      type(error_t), allocatable :: error

      case = block_scene('dop853')
      call run_baseline(case, 'euler', 0.01_wp, 0.0_wp, 0.0_wp, baseline, error)
      call checks%has_error(error, err_input, 'euler', 'a name that is not known')
   end subroutine test_unknown_name

end program test_practice
