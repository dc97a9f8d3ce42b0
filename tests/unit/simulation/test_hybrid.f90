!> Hybrid system: agreement of all methods, and hard cases of impact integration.
program test_hybrid
   use check, only: checks_t
   use rwmf_core_error, only: err_numerical, error_t
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_pairs, only: dormand_prince_853
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_model_system_energy, only: impact_loss
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, initial_t, output_t
   use rwmf_simulation_hybrid_elastic_chatter, only: skip_chatter
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_run, only: begin_run
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_hybrid_state, only: check_progress, hybrid_t, progress_t
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: block_scene, rwmf_scene
   implicit none

   character(6), parameter :: methods(4) = [character(6) :: 'adams', 'bdf', 'taylor', 'dop853']
   type(checks_t) :: checks
   integer :: i

   do i = 1, size(methods)
      if (checks%wants('chatter_ends')) call check_chatter_ends(trim(methods(i)))
      if (checks%wants('small_arch')) call check_small_arch(trim(methods(i)))
      if (checks%wants('small_response')) call check_small_response(trim(methods(i)))
   end do
   if (checks%wants('bound_on_work')) call check_bound_on_work()
   if (checks%wants('time_stands')) call check_time_stands()
   if (checks%wants('ground_at_rest')) call check_ground_at_rest()
   if (checks%wants('averaged_bounces')) call check_averaged_bounces()
   call checks%finish()

contains

   !> Compare averaged bounces with single ones, under a contact pressure that falls to a fifth.
   !> Their number and the work of dampers and ground motion agree.
   subroutine check_averaged_bounces()
      type(case_t) :: case
      type(result_t) :: single
      type(error_t), allocatable :: error
      type(motion_t), target :: motion
      type(equation_t), target :: equation
      type(explicit_pair_t) :: integrator
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      real(wp), parameter :: v = 1.0e-5_wp
      !! [rad/s]
      real(wp) :: energy, t
      integer :: jumps

      case = rwmf_scene('symmetric', 5.0_wp, 0.2_wp, 'dop853')
      deallocate (case%cable, case%motion%a_max_g, case%motion%omega_p)
      case%impact%e = 1
      case%initial = initial_t(0.0_wp, v)
      case%motion%kind = 'record'
      allocate (case%record)
      case%record%t = [0.0_wp, 2.0_wp, 2.1_wp]
      case%record%a = [0.0_wp, 0.18_wp, 0.18_wp]
      case%solver%t_end = 2
      case%solver%rtol = 1.0e-6_wp
      case%output = output_t(energy=.true.)
      call simulate(case, single, error)
      call checks%no_error(error, 'single bounces')
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      integrator%pair = dormand_prince_853()
      call begin_run(case, [v, v], equation, integrator, hybrid, recorder, error)
      call checks%no_error(error, 'averaged bounces')
      energy = impact_loss(equation, v, 0.0_wp)
      do jumps = 1, 100
         t = hybrid%t
         call skip_chatter(hybrid, equation, recorder, 1.0_wp, case%solver%t_end)
         if (.not. hybrid%t > t) exit
      end do
      call checks%that(hybrid%t > 1.99_wp, 'nearly all of the time is averaged')
      call checks%close_to(real(recorder%impacts, wp), real(single%impacts, wp), 'their number', &
         rtol=0.02_wp)
      call checks%close_to(recorder%energy%viscous/energy, single%energy%viscous/energy, &
         'work of the dampers', rtol=0.01_wp)
      call checks%close_to(recorder%energy%input/energy, single%energy%input/energy, &
         'work of the ground motion', rtol=0.02_wp, atol=0.01_wp)
      call checks%close_to(energy + recorder%energy%input - recorder%energy%viscous, &
         impact_loss(equation, hybrid%y(2), 0.0_wp), 'ledger', rtol=1.0e-12_wp, &
         atol=1.0e-12_wp*energy)
   end subroutine check_averaged_bounces

   !> Check that free vibration of a block ends in finite time; the wall then rests.
   subroutine check_chatter_ends(method)
      character(*), intent(in) :: method
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = block_scene(method)
      deallocate (case%motion)
      allocate (case%initial)
      case%initial%theta_over_alpha = 0.5_wp
      case%initial%theta_dot = 0
      case%impact%rule = 'constant'
      case%impact%e = 0.9_wp
      case%solver%t_end = 100
      call simulate(case, result, error)
      call checks%no_error(error, 'chatter, '//method)
      call checks%that(all(abs(result%final_state) <= 0), 'chatter ends in rest, '//method)
      call checks%that(result%impacts > 50_i8 .and. result%impacts < 400_i8, &
         'impacts of the chatter, '//method)
   end subroutine check_chatter_ends

   !> Check arches from theta = 0 with a tiny velocity. Each ends well within the integrator's usual
   !> step.
   subroutine check_small_arch(method)
      character(*), intent(in) :: method
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: pull
      real(wp), parameter :: v = 1.0e-6_wp

      case = block_scene(method)
      deallocate (case%motion)
      allocate (case%initial)
      case%initial%theta_over_alpha = 0
      case%initial%theta_dot = v
      pull = 0.75_wp*9.81_wp*sin(atan(0.25_wp))/hypot(2.0_wp, 0.5_wp)
      case%solver%t_end = 201*v/pull
      call simulate(case, result, error)
      call checks%no_error(error, 'small arches, '//method)
      call checks%that(result%impacts == 100_i8, 'a hundred small arches, '//method)
      call checks%close_to(result%theta_max, v**2/(2*pull), 'height of a small arch, '//method, &
         rtol=1.0e-6_wp)
   end subroutine check_small_arch

   !> Check the accuracy of a response of some nanometres against a run with a tight tolerance.
   subroutine check_small_response(method)
      character(*), intent(in) :: method
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: tight
      type(error_t), allocatable :: error

      case = rwmf_scene('symmetric', 5.0_wp, 1.0_wp, method)
      case%motion%a_max_g = 0.25_wp*2/11*(1 + 1.0e-5_wp)
      call simulate(case, result, error)
      call checks%no_error(error, 'small response, '//method)
      case%solver%method = 'dop853'
      case%solver%rtol = 1.0e-13_wp
      call simulate(case, tight, error)
      call checks%that(tight%u_s_max < 1.0e-6_wp, 'small response is small, '//method)
      call checks%close_to(result%u_s_max, tight%u_s_max, 'small response, '//method, &
         rtol=1.0e-7_wp)
   end subroutine check_small_response

   subroutine check_bound_on_work()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = rwmf_scene('exact', 5.0_wp, 0.4_wp, 'adams')
      case%solver%max_steps = 100
      call simulate(case, result, error)
      call checks%has_error(error, err_numerical, 'max_steps', 'bound on the work')
   end subroutine check_bound_on_work

   !> Let the time advance by two, by half and by none of its spacings per step on average: a run
   !> that stands fails.
   subroutine check_time_stands()
      type(progress_t) :: progress
      type(error_t), allocatable :: error
      integer, parameter :: half_spacings(3) = [4, 1, 0]
      real(wp) :: t
      integer :: i, k

      do k = 1, size(half_spacings)
         progress = progress_t()
         do i = 0, 2500
            t = 1 + (i*half_spacings(k)/2)*spacing(1.0_wp)
            call check_progress(progress, 0, t, error)
            if (allocated(error)) exit
         end do
         if (k == 1) then
            call checks%no_error(error, 'a run whose time advances')
         else
            call checks%has_error(error, err_numerical, 'no step leads on', &
               'a run whose time stands')
         end if
      end do
   end subroutine check_time_stands

   !> Check that the history of a wall at rest has the motion of each interval, not of the next one.
   subroutine check_ground_at_rest()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: t
      real(wp) :: expected
      integer :: i

      case = block_scene('dop853')
      case%motion%a_max_g = 0.1_wp
      case%motion%t_0 = 0.3_wp
      case%solver%t_end = 2
      allocate (case%output)
      case%output%dt = 0.05_wp
      case%output%energy = .false.
      call simulate(case, result, error)
      call checks%no_error(error, 'ground at rest')
      call checks%that(result%lift_offs == 0, 'the wall rests')
      do i = 1, size(result%history%values, 1)
         t = result%history%values(i, 1)
         expected = 0
         if (t > 0.3_wp .and. t < 1.3_wp) expected = 0.981_wp*sin(2*pi*(t - 0.3_wp))
         call checks%close_to(result%history%values(i, 5), expected, 'ground at rest', &
            atol=1.0e-12_wp)
      end do
   end subroutine check_ground_at_rest

end program test_hybrid
