!> Fortran host that prints its results bit by bit: `host KIND CASE.nml`.
program bits_host
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: int64
   use rwmf, only: advance_stepping, case_t, compute_spectrum, create_element, create_stepping, &
      destroy_stepping, element_response_t, error_t, event_name, event_t, uplift_demand_of, &
      next_impact, next_lift_off, query_events, query_forces, query_state, read_case_file, &
      respond, restore_stepping, result_t, result_value, save_stepping, settles, simulate, snapshot_t, &
      spectrum_t, stepping_t, velocity_factor, wall_element_t, wall_forces_t, wall_state_t, wp
   implicit none
   type(case_t) :: case
   type(error_t), allocatable :: error
   character(16) :: kind
   character(256) :: path
   character(*), parameter :: keys(27) = [character(48) :: 't_u_s_max_s', 'theta_dot_max_rad_s', &
      'cable_force_increment_max_over_m_w_g', 'cable_prestress_loss_over_m_w_g', 'ductility', &
      'residual_displacement_m', 'theta_end_over_alpha', 'e', 'e_max', &
      'base_shear_max_over_weight', 't_base_shear_max_s', 'pivot_normal_min_over_m_w_g', &
      'friction_demand_max', 't_friction_demand_max_s', 'wall_drift_max', 'frame_drift_max', &
      'energy_input_J_per_kg', 'energy_kinetic_J_per_kg', 'energy_strain_J_per_kg', &
      'energy_gravity_J_per_kg', 'energy_cable_J_per_kg', 'energy_effects_J_per_kg', &
      'energy_viscous_J_per_kg', 'energy_hysteretic_J_per_kg', 'energy_impact_J_per_kg', &
      'energy_bending_J_per_kg', 'energy_bending_damping_J_per_kg']

   call get_command_argument(1, kind)
   call get_command_argument(2, path)
   call read_case_file(trim(path), case, error)
   if (allocated(error)) then
      call put_error('read_case_file', error)
   else
      select case (kind)
      case ('simulate')
         call ask_simulation(case)
      case ('spectrum-1')
         call ask_spectrum(case, 1)
      case ('spectrum-2')
         call ask_spectrum(case, 2)
      case ('stepping')
         call ask_stepping(case)
      case ('element')
         call ask_element(case)
      case default
         print '(2a)', 'unknown kind ', kind
      end select
   end if

contains

   !> Print a number with its bits. An absent argument does not apply to the scene.
   subroutine put(name, x)
      character(*), intent(in) :: name
      real(wp), intent(in), optional :: x
      !! [any]

      if (.not. present(x)) return
      print '(a, 1x, z16.16, 1x, es23.15e3)', name, transfer(x, 0_int64), x
   end subroutine put

   subroutine put_list(name, x)
      character(*), intent(in) :: name
      real(wp), intent(in), optional :: x(:)
      !! [any]

      if (.not. present(x)) return
      print '(a, *(1x, z16.16))', name, transfer(x, [0_int64])
   end subroutine put_list

   subroutine put_error(call_name, error)
      character(*), intent(in) :: call_name
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) then
         print '(2a)', call_name, ': no error'
      else
         print '(2a, i0, 2a)', call_name, ': error ', error%stat, ' ', trim(error%name)
      end if
   end subroutine put_error

   !> Print all results of one simulation.
   subroutine ask_simulation(case)
      type(case_t), intent(in) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: i

      call simulate(case, result, error)
      call put_error('simulate', error)
      if (allocated(error)) return
      call put_result(result)
      if (allocated(result%history)) then
         print '(*(a, 1x))', (trim(result%history%names(i)), i=1, size(result%history%names))
         do i = 1, size(result%history%values, 1)
            call put_list('row', result%history%values(i, :))
         end do
      end if
      if (allocated(result%events)) call put_events(result%events)
   end subroutine ask_simulation

   subroutine put_result(result)
      type(result_t), intent(in) :: result
      real(wp) :: value
      integer :: i

      call put('u_s_max', result%u_s_max)
      call put('theta_max', result%theta_max)
      call put('theta_min', result%theta_min)
      do i = 1, size(keys)
         value = result_value(result, trim(keys(i)))
         if (.not. ieee_is_nan(value)) call put(trim(keys(i)), value)
      end do
      call put('t_end', result%t_end)
      call put_list('final_state', result%final_state)
      call put('estimated_relative_error', result%estimated_relative_error)
      call put('sensitivity', result%sensitivity)
      print '(a, 4(1x, i0), 2(1x, l1), 2a)', 'counts', result%impacts, result%lift_offs, &
         result%steps, result%rhs_evaluations, result%has_impacts, result%overturned, ' ', &
         result%method
      call put('rtol', result%rtol)
   end subroutine put_result

   subroutine put_events(events)
      type(event_t), intent(in) :: events(:)
      integer :: i

      do i = 1, size(events)
         call put_list(event_name(events(i)%kind), [events(i)%t, events(i)%theta, &
            events(i)%theta_dot])
      end do
   end subroutine put_events

   subroutine ask_spectrum(case, threads)
      type(case_t), intent(in) :: case
      integer, intent(in) :: threads
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error
      integer :: i, j, k

      call compute_spectrum(case, threads, spectrum, error)
      call put_error('compute_spectrum', error)
      if (allocated(error)) return
      call put_list('T_s', spectrum%T_s)
      call put_list('gamma', spectrum%gamma)
      call put_list('b', spectrum%b)
      do k = 1, size(spectrum%values, 3)
         do j = 1, size(spectrum%values, 2)
            call put_list('u_s_max', spectrum%values(:, j, k, 1))
            print '(*(a, 1x))', (trim(spectrum%status_names(spectrum%status(i, j, k))), i=1, &
               size(spectrum%T_s))
         end do
      end do
      print '(a, i0)', 'rhs_evaluations ', spectrum%rhs_evaluations
   end subroutine ask_spectrum

   !> Reject every third step as a host, alternately under samples and under the case's own motion.
   subroutine ask_stepping(case)
      type(case_t), intent(in) :: case
      integer, parameter :: steps = 100
      real(wp), parameter :: dt = 0.02_wp
      type(stepping_t) :: wall
      type(snapshot_t) :: before
      type(error_t), allocatable :: error
      integer :: i

      call create_stepping(wall, case, error, peak=4.0_wp)
      call put_error('create_stepping', error)
      if (allocated(error)) return
      do i = 1, steps
         if (mod(i, 3) == 0) then
            call save_stepping(wall, before, error)
            if (.not. allocated(error)) call advance_stepping(wall, i*dt, error)
            if (.not. allocated(error)) call restore_stepping(wall, before, error)
            if (allocated(error)) call put_error('trial', error)
         end if
         if (mod(i/20, 2) == 0) then
            call advance_stepping(wall, i*dt, error)
         else
            call advance_stepping(wall, [i - 1, i]*dt, 4*sin(6*[i - 1, i]*dt), error)
         end if
         if (allocated(error)) then
            call put_error('advance_stepping', error)
            call advance_stepping(wall, i*dt, error)
         end if
         call put_wall(wall)
      end do
      call destroy_stepping(wall)
   end subroutine ask_stepping

   !> Print state, forces and events of a wall that advances in steps.
   subroutine put_wall(wall)
      type(stepping_t), intent(in) :: wall
      type(wall_state_t) :: state
      type(wall_forces_t) :: forces
      type(event_t), allocatable :: events(:)
      type(error_t), allocatable :: error

      call query_state(wall, state, error)
      if (.not. allocated(error)) call query_forces(wall, forces, error)
      if (.not. allocated(error)) call query_events(wall, events, error)
      if (allocated(error)) then
         call put_error('query', error)
         return
      end if
      call put_list('state', [state%t, state%theta, state%theta_dot, state%theta_ddot, &
         state%u_s, state%u_s_dot, state%u_s_ddot, state%u_s_max, state%theta_max])
      print '(3(i0, 1x), 2l1)', state%impacts, state%lift_offs, state%steps, state%at_rest, &
         state%overturned
      call put_list('forces', [forces%link, forces%frame_shear, forces%cable])
      call put_events(events)
   end subroutine put_wall

   !> Print the response of the wall as an element on a grid of motions, and its events.
   subroutine ask_element(case)
      type(case_t), intent(in) :: case
      type(wall_element_t) :: element
      type(element_response_t) :: r
      type(error_t), allocatable :: error
      real(wp) :: tau
      real(wp) :: u
      integer :: i
      integer :: side
      logical :: is_found

      call create_element(element, case, error)
      call put_error('create_element', error)
      if (allocated(error)) return
      call put('velocity_factor', velocity_factor(element))
      do i = 1, 12
         side = 1 - 2*mod(i, 2)
         u = side*0.03_wp*(i - 1)
         call respond(element, side, u, 0.4_wp - 0.1_wp*i, 2.0_wp - 0.3_wp*i, 1.0_wp, r, error)
         if (allocated(error)) then
            call put_error('respond', error)
            cycle
         end if
         call put_list('response', [r%force, r%stiffness, r%damping, r%mass, r%theta, &
            r%theta_dot, r%theta_ddot, r%cable])
         call put('drive', uplift_demand_of(element, side, 3.0_wp*i, 0.5_wp*i))
         call next_impact(side, 0.02_wp, side*0.001_wp*i, -side*0.5_wp, -side*0.002_wp, &
            -side*0.3_wp, is_found, tau)
         print '(a, l1)', 'impact ', is_found
         call put('tau', tau)
         print '(a, l1)', 'settles ', settles(element, 0.02_wp, 10.0_wp**(-i), 0.1_wp, 0.2_wp, &
            5.0_wp)
      end do
      do i = -3, 3
         call next_lift_off(element, 0.02_wp, 0.0_wp, 4.0_wp*i, 0.0_wp, 1.0_wp*i, side, tau)
         print '(a, i0)', 'lift-off ', side
         call put('tau', tau)
      end do
   end subroutine ask_element

end program bits_host
