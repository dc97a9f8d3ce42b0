!> Extrema of the reactions and the energy ledger in the rows of a history, computed only on
!> request.
program test_extrema
   use check, only: checks_t
   use reaction_scenes, only: column, damped, scene
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t, output_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('extremes')) call check_extremes('adams', 1.0e-9_wp, 'one_sine')
   if (checks%wants('extremes')) call check_extremes('dop853', 1.0e-9_wp, 'one_sine')
   if (checks%wants('extremes')) call check_extremes('dop853', 1.0e-3_wp, 'one_sine')
   if (checks%wants('extremes')) call check_extremes('taylor', 1.0e-6_wp, 'one_sine')
   if (checks%wants('extremes')) call check_extremes('dop853', 1.0e-9_wp, 'one_cosine')
   if (checks%wants('first_exceedance')) call check_first_exceedance()
   if (checks%wants('energy_rows')) call check_energy_rows()
   if (checks%wants('only_if_asked')) call check_only_if_asked()
   call checks%finish()

contains

   !> Compare extrema with a history that is finer than any feature of the response.
   subroutine check_extremes(method, rtol, kind)
      character(*), intent(in) :: method
      real(wp), intent(in) :: rtol
      character(*), intent(in) :: kind
      !! of the pulse; a cosine begins with a jump, which lifts the wall at once
      real(wp), parameter :: dt = 1.0e-4_wp
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:)
      character(:), allocatable :: name

      name = kind//', '//method
      case = rwmf_scene('exact', 5.0_wp, 0.7_wp, method)
      case%motion%kind = kind
      case%solver%rtol = rtol
      case%solver%t_end = 5
      case%output = output_t(dt=dt, energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'extrema, '//name)
      rows = column(result, 'base_shear_over_weight')
      call compare(result%reactions%base_shear_max, maxval(abs(rows)), 'base shear, '//name)
      rows = column(result, 'pivot_normal_over_m_w_g')
      call compare(-result%reactions%normal_min, maxval(-rows), 'N, '//name)
      rows = column(result, 'friction_demand')
      call compare(result%reactions%demand_max, maxval(rows), 'demand, '//name)
      rows = column(result, 'wall_drift')
      call compare(result%reactions%wall_drift_max, maxval(abs(rows)), 'wall drift, '//name)
      rows = column(result, 'frame_drift')
      call compare(result%reactions%frame_drift_max, maxval(abs(rows)), 'frame drift, '//name)
   end subroutine check_extremes

   !> Check that an extremum is at least the largest row and exceeds it only by the variation within
   !> a row interval. A reaction jumps at an impact, so a row may precede the one-sided value by up
   !> to dt.
   subroutine compare(extreme, largest_row, name)
      real(wp), intent(in) :: extreme
      real(wp), intent(in) :: largest_row
      character(*), intent(in) :: name
      real(wp), parameter :: within_a_row = 1.0e-3_wp

      call checks%that(extreme >= largest_row - 1.0e-13_wp*abs(largest_row), name//': not missed')
      call checks%close_to(extreme, largest_row, name, rtol=within_a_row)
   end subroutine compare

   !> Check the first exceedance of a limit, between two peaks of the demand.
   subroutine check_first_exceedance()
      real(wp), parameter :: dt = 1.0e-4_wp
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:)
      integer :: first

      case = rwmf_scene('exact', 5.0_wp, 0.7_wp, 'dop853')
      case%output = output_t(dt=dt, energy=.false., reactions=.true.)
      case%output%friction_limit = 0.16_wp
      call simulate(case, result, error)
      call checks%no_error(error, 'excess')
      rows = column(result, 'friction_demand')
      first = findloc(rows > case%output%friction_limit, .true., dim=1)
      call checks%that(first > 2, 'exceeded after the beginning')
      call checks%close_to(result%reactions%t_exceeded, (first - 1.5_wp)*dt, 'first excess', &
         atol=0.51_wp*dt)
   end subroutine check_first_exceedance

   !> Check that the ledger closes in every row: input = stored + dissipated.
   subroutine check_energy_rows()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: residual(:)
      character(*), parameter :: out(6) = [character(9) :: 'kinetic', 'strain', 'gravity', &
         'cable', 'viscous', 'impact']
      integer :: i

      case = damped()
      case%output = output_t(dt=0.013_wp, energy=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'ledger')
      residual = column(result, 'energy_input_J_per_kg')
      do i = 1, size(out)
         residual = residual - column(result, 'energy_'//trim(out(i))//'_J_per_kg')
      end do
      call checks%that(maxval(abs(residual)) <= 1.0e-8_wp*result%energy%input_max, &
         'the ledger closes at all times')
      call checks%that(size(result%energy%names) == size(out) + 1, 'no part that does not apply')
      deallocate (case%damper, case%cable, case%frame)
      call simulate(case, result, error)
      call checks%that(size(result%energy%names) == 4, 'a block: input, kinetic, gravity, impact')
   end subroutine check_energy_rows

   !> Check that a run records only the requested outputs, and that outputs do not change the
   !> response.
   subroutine check_only_if_asked()
      type(case_t) :: case
      type(result_t) :: plain
      type(result_t) :: request
      type(error_t), allocatable :: error

      case = scene('exact', 'truss')
      call simulate(case, plain, error)
      call checks%that(.not. allocated(plain%reactions), 'no reactions unless asked')
      case%output = output_t(dt=0.01_wp, energy=.true., reactions=.true.)
      call simulate(case, request, error)
      call checks%that(abs(request%u_s_max - plain%u_s_max) <= 0 &
         .and. all(abs(request%final_state - plain%final_state) <= 0), 'the same bits')
   end subroutine check_only_if_asked

end program test_extrema
