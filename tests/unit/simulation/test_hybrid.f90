!> Hybrid system: bounces that are averaged, and a time that stands.
program test_hybrid
   use check, only: checks_t
   use rwmf_core_error, only: err_numerical, error_t
   use rwmf_core_kinds, only: wp
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
   use rwmf_simulation_state_result, only: result_t, result_value
   use scenes, only: rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('time_stands')) call check_time_stands()
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
      call checks%close_to(recorder%energy%viscous/energy, result_value(single, &
         'energy_viscous_J_per_kg')/energy, 'work of the dampers', rtol=0.01_wp)
      call checks%close_to(recorder%energy%input/energy, result_value(single, &
         'energy_input_J_per_kg')/energy, 'work of the ground motion', rtol=0.02_wp, atol=0.01_wp)
      call checks%close_to(energy + recorder%energy%input - recorder%energy%viscous, &
         impact_loss(equation, hybrid%y(2), 0.0_wp), 'ledger', rtol=1.0e-12_wp, &
         atol=1.0e-12_wp*energy)
   end subroutine check_averaged_bounces

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

end program test_hybrid
