!> Effects beyond the paper's scene: each against its limit, its derivative and its energy.
program test_effects
   use check, only: checks_t
   use ledgers, only: check_ledger
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      query_state, stepping_t, wall_state_t
   use rwmf_model_lanes, only: chord_coefficients
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_system_assembly, only: build_equation, enter_side, equation_t, &
      kinematics_at, second_derivative
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_motion_record_lines, only: merged_times
   use rwmf_problem_case, only: case_t, devices_t, inerter_t, link_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('link_geometry')) call check_link_geometry()
   if (checks%wants('long_link')) call check_long_link()
   call check_energy(linked('exact', 5.0_wp), 'link')
   call check_energy(pinned(), 'pinned wall')
   call check_energy(damped(2.0_wp), 'corner dampers')
   call check_energy(with_inerter(0.5_wp), 'corner inerters')
   call check_energy(shaken_vertically(0.65_wp), 'vertical motion')
   if (checks%wants('absent')) call check_absent()
   if (checks%wants('no_inerter')) call check_no_inerter()
   if (checks%wants('host')) call check_host()
   if (checks%wants('merged_times')) call check_merged_times()
   if (checks%wants('no_damping')) call check_no_damping()
   if (checks%wants('damping')) call check_damping()
   if (checks%wants('pinned_is_linear')) call check_pinned_is_linear()
   call checks%finish()

contains

   function linked(formulation, length) result(case)
      character(*), intent(in) :: formulation
      real(wp), intent(in) :: length
      !! [m]
      type(case_t) :: case

      case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'dop853')
      case%link = link_t(length)
   end function linked

   function pinned() result(case)
      type(case_t) :: case

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853')
      deallocate (case%cable)
      case%wall%base = 'pinned'
   end function pinned

   !> Wall and frame with corner dampers.
   function damped(c_over_m_w) result(case)
      real(wp), intent(in) :: c_over_m_w
      !! [1/s]
      type(case_t) :: case

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853')
      case%damper = devices_t(c=spread(c_over_m_w, 1, 2))
   end function damped

   !> Wall and frame with corner inerters.
   function with_inerter(inertance_over_m_w) result(case)
      real(wp), intent(in) :: inertance_over_m_w
      !! [-]
      type(case_t) :: case

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853')
      case%inerter = inerter_t(inertance_over_m_w)
   end function with_inerter

   !> Wall and frame under a vertical motion that is a multiple of the horizontal one.
   function shaken_vertically(ratio) result(case)
      real(wp), intent(in) :: ratio
      !! [-]
      type(case_t) :: case

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'dop853')
      allocate (case%upward)
      case%upward%ratio = ratio
   end function shaken_vertically

   !> Check that a group absent from a case adds no loop, state or coefficient to its equation.
   subroutine check_absent()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: with
      type(equation_t) :: without

      case = damped(2.0_wp)
      motion = motion_from_case(case)
      call build_equation(case, motion, with)
      deallocate (case%damper)
      call build_equation(case, motion, without)
      call checks%that(size(without%elements) == 1, 'the tendon alone')
      call checks%that(size(with%elements) == 3, 'a damper at each corner')
      call checks%that(size(with%scene%terms) == size(without%scene%terms) + 1, 'one loop more')
      call checks%that(with%scene%n == without%scene%n, 'no state more')
      call checks%that(with%scene%n_coef == without%scene%n_coef + chord_coefficients, &
         'the coefficients of the damper alone')
   end subroutine check_absent

   !> Check that a host that advances a wall under the case's motion obtains the bits of one run,
   !> also with restitution from a table. With a separate vertical record, ground samples of the
   !> host are an error.
   subroutine check_host()
      type(case_t) :: case
      type(stepping_t) :: wall
      type(wall_state_t) :: state
      type(result_t) :: whole
      type(error_t), allocatable :: error

      case = shaken_vertically(0.65_wp)
      case%solver%atol = 1.0e-11_wp
      case%impact%rule = 'table'
      case%impact%table_theta_dot = [0.05_wp, 0.5_wp]
      case%impact%table_e = [0.95_wp, 0.8_wp]
      call simulate(case, whole, error)
      call checks%no_error(error, 'one run')
      call create_stepping(wall, case, error)
      ! the end of the pulse, where a run also stops
      call advance_stepping(wall, 1.0_wp, error)
      call advance_stepping(wall, case%solver%t_end, error)
      call query_state(wall, state, error)
      call checks%no_error(error, 'a host')
      call checks%that(all(abs([state%theta, state%theta_dot] - whole%final_state) <= 0), &
         'a host gets the bits of one run')
      call destroy_stepping(wall)
      deallocate (case%upward%ratio)
      allocate (case%upward_record)
      case%upward_record%t = [0.0_wp, 1.0_wp]
      case%upward_record%a = [0.0_wp, 1.0_wp]
      call create_stepping(wall, case, error)
      call advance_stepping(wall, [0.0_wp, 1.0_wp], [0.0_wp, 1.0_wp], error)
      call checks%has_error(error, err_input, '&vertical', 'samples of a host')
      call destroy_stepping(wall)
   end subroutine check_host

   !> Check that samples at the same instant form one knot, even if the last digits of their times
   !> differ.
   subroutine check_merged_times()
      real(wp) :: product(100)
      real(wp) :: quotient(50)
      integer :: i

      product = [(i*0.1_wp, i=1, 100)]
      quotient = [(i/5.0_wp, i=1, 50)]
      call checks%that(any(abs(product(2::2) - quotient) > 0), 'times that differ by round-off')
      call checks%that(all(abs(merged_times(product, quotient) - product) <= 0), &
         'the same knots')
      call checks%that(size(merged_times(product, quotient + 0.05_wp)) == 150, 'knots in between')
      call checks%that(size(merged_times(quotient(:0), quotient)) == 50, 'one sequence alone')
   end subroutine check_merged_times

   !> Compare zero inertance with the scene without the group.
   subroutine check_no_inerter()
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: limit
      type(error_t), allocatable :: error

      case = with_inerter(0.0_wp)
      call simulate(case, result, error)
      call checks%no_error(error, 'no inertance')
      deallocate (case%inerter)
      call simulate(case, limit, error)
      call checks%close_to(result%u_s_max, limit%u_s_max, 'no inertance', rtol=1.0e-10_wp)
   end subroutine check_no_inerter

   !> Compare c = 0 with the scene without the group.
   subroutine check_no_damping()
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: limit
      type(error_t), allocatable :: error

      case = damped(0.0_wp)
      call simulate(case, result, error)
      call checks%no_error(error, 'no damping')
      deallocate (case%damper)
      call simulate(case, limit, error)
      call checks%close_to(result%u_s_max, limit%u_s_max, 'no damping', rtol=1.0e-10_wp)
   end subroutine check_no_damping

   !> Compare the damping moment with its definition: force c d(stroke)/dt along the chord 4b
   !> sin(phi/2).
   subroutine check_damping()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: with
      type(equation_t) :: without
      real(wp), parameter :: phi = 0.1_wp
      real(wp), parameter :: phi_dot = 0.3_wp
      real(wp), parameter :: step = 1.0e-6_wp
      real(wp) :: slope
      real(wp) :: mass

      case = damped(2.0_wp)
      motion = motion_from_case(case)
      call build_equation(case, motion, with)
      deallocate (case%damper)
      call build_equation(case, motion, without)
      slope = 4*case%wall%b*(sin((phi + step)/2) - sin((phi - step)/2))/(2*step)
      mass = with%p%R**2*(4.0_wp/3 + 4*with%p%gamma*cos(with%p%alpha - phi)**2)
      call checks%close_to(second_derivative(with, 20.0_wp, [phi, phi_dot]) &
         - second_derivative(without, 20.0_wp, [phi, phi_dot]), -2*slope**2*phi_dot/mass, &
         'moment of a corner damper', rtol=1.0e-7_wp)
   end subroutine check_damping

   !> Compare the link geometry with Eq. (3), evaluated as printed, on both sides.
   subroutine check_link_geometry()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(kinematics_t) :: kin
      real(wp), parameter :: phi = 0.1_wp
      real(wp), parameter :: length = 5
      real(wp) :: u_t
      real(wp) :: v_t

      case = linked('exact', length)
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      associate (alpha => equation%p%alpha, R => equation%p%R)
         kin = kinematics_at(equation, phi)
         u_t = 2*R*(sin(alpha) - sin(alpha - phi))
         v_t = 2*R*(cos(alpha - phi) - cos(alpha))
         call checks%close_to(R*kin%u, length*(1 + u_t/length - sqrt(1 - (v_t/length)**2)), &
            'Eq. (3), theta > 0', rtol=1.0e-13_wp)
         call enter_side(equation%model_t, equation%state, -1)
         kin = kinematics_at(equation, -phi)
         u_t = -2*case%wall%h*sin(phi)
         v_t = -2*case%wall%h*(1 - cos(phi))
         call checks%close_to(-R*kin%u, length*(1 + u_t/length - sqrt(1 - (v_t/length)**2)), &
            'Eq. (3), theta < 0', rtol=1.0e-13_wp)
      end associate
   end subroutine check_link_geometry

   !> Compare the limit L -> infinity with the scene without the group.
   subroutine check_long_link()
      type(case_t) :: case
      type(result_t) :: result
      type(result_t) :: limit
      type(error_t), allocatable :: error

      case = linked('exact', 1.0e9_wp)
      call simulate(case, result, error)
      call checks%no_error(error, 'long link')
      deallocate (case%link)
      call simulate(case, limit, error)
      call checks%close_to(result%u_s_max, limit%u_s_max, 'long link', rtol=1.0e-9_wp)
   end subroutine check_long_link

   !> Check the energy balance: input = stored + viscous + impact.
   subroutine check_energy(scene, name)
      type(case_t), intent(in) :: scene
      character(*), intent(in) :: name
      type(result_t) :: result

      if (.not. checks%wants('energy, '//name)) return
      call check_ledger(checks, scene, 1.0e-8_wp, 'energy, '//name, result)
   end subroutine check_energy

   !> Compare a small swing of the hinged wall with a linear oscillator, at the first peak in free
   !> vibration. Gravity reduces the stiffness and the wall adds to the mass.
   subroutine check_pinned_is_linear()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: h, b, omega

      case = pinned()
      deallocate (case%motion)
      case%frame%xi_s = 0
      allocate (case%initial)
      case%initial%theta_over_alpha = 1.0e-5_wp
      case%initial%theta_dot = 0
      h = case%wall%h
      b = case%wall%b
      omega = sqrt((case%frame%gamma*(8*atan(1.0_wp)/case%frame%T_s)**2*4*h**2 - case%model%g*h) &
         /(4*h**2/3 + b**2/3 + 4*case%frame%gamma*h**2))
      case%solver%t_end = 8*atan(1.0_wp)/omega
      call simulate(case, result, error)
      call checks%no_error(error, 'pinned wall')
      call checks%close_to(result%final_state(1), 1.0e-5_wp*atan(b/h), 'one period of the hinged ' &
         //'wall', rtol=1.0e-8_wp)
      call checks%that(.not. result%has_impacts, 'a hinged wall has no impacts')
   end subroutine check_pinned_is_linear

end program test_effects
