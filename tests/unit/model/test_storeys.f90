!> Frames of several storeys, closed forms of their modes, and both couplings with the wall.
program test_storeys
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      query_forces, query_state, stepping_t, wall_forces_t, wall_state_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_shear_frame, only: damping_matrix, find_modes, modal_height, modal_mass, &
      roof_factor, shear_frame_t
   use scenes, only: rwmf_scene
   implicit none

   type(checks_t) :: checks

   if (checks%wants('uniform_frame')) call check_uniform_frame()
   if (checks%wants('damping_matrix')) call check_damping_matrix()
   if (checks%wants('every_floor')) call check_every_floor()
   if (checks%wants('links_of_every_floor')) call check_links_of_every_floor()
   if (checks%wants('link_spring')) call check_link_spring()
   call checks%finish()

contains

   !> Scene with equal storeys: m over m_w at every floor, and equal heights that sum to the wall's.
   function uniform_case(n, m, T_1, coupling, formulation, method) result(case)
      integer, intent(in) :: n
      real(wp), intent(in) :: m
      !! [-]
      real(wp), intent(in) :: T_1
      !! fundamental period [s]
      character(*), intent(in) :: coupling
      character(*), intent(in) :: formulation
      character(*), intent(in) :: method
      type(case_t) :: case
      type(error_t), allocatable :: error

      case = rwmf_scene(formulation, 0.0_wp, 1.0_wp, method)
      allocate (case%frame%floors)
      case%frame%coupling = coupling
      case%frame%floors%m = spread(m, 1, n)
      case%frame%floors%k = spread(m*(pi/T_1/sin(pi/(4*n + 2)))**2, 1, n)
      case%frame%floors%height = spread(2*case%wall%h/n, 1, n)
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'equivalent frame')
   end function uniform_case

   !> Check omega_j = 2 sqrt(k/m) sin((2j - 1) pi/(4n + 2)). The modal masses sum to the mass, and
   !> their moments to that of the masses. Five storeys have the effective masses and heights of
   !> Chopra.
   subroutine check_uniform_frame()
      integer, parameter :: n = 5
      real(wp), parameter :: chopra_mass(n) = [4.398_wp, 0.436_wp, 0.121_wp, 0.038_wp, 0.008_wp]
      real(wp), parameter :: chopra_height(n) = [3.51_wp, -1.20_wp, 0.76_wp, -0.59_wp, 0.52_wp]
      type(shear_frame_t) :: frame
      type(error_t), allocatable :: error
      real(wp) :: mass(n)
      real(wp) :: height(n)
      integer :: j

      frame%m = spread(2.0_wp, 1, n)
      frame%k = spread(700.0_wp, 1, n)
      frame%height = spread(3.0_wp, 1, n)
      call find_modes(frame, error)
      call checks%no_error(error, 'modes')
      do j = 1, n
         call checks%close_to(frame%omega(j), 2*sqrt(350.0_wp)*sin((2*j - 1)*pi/(4*n + 2)), &
            'frequency of a uniform frame', rtol=1.0e-13_wp)
         mass(j) = modal_mass(frame, j)
         height(j) = modal_height(frame, j)
         call checks%close_to(mass(j)/2, chopra_mass(j), 'Chopra''s effective modal masses', &
            atol=6.0e-4_wp)
         call checks%close_to(height(j)/3, chopra_height(j), 'Chopra''s effective heights', &
            atol=6.0e-3_wp)
      end do
      call checks%close_to(sum(mass), 10.0_wp, 'modal masses add up', rtol=1.0e-13_wp)
      call checks%close_to(sum(mass*height), 90.0_wp, 'and their moments', rtol=1.0e-13_wp)
      call checks%close_to(sum([(roof_factor(frame, j), j=1, n)]), 1.0_wp, &
         'the modes make up the motion of the ground', rtol=1.0e-12_wp)
   end subroutine check_uniform_frame

   !> Check that phi' C phi is 2 xi omega for one mode and zero between two.
   subroutine check_damping_matrix()
      type(shear_frame_t) :: frame
      type(error_t), allocatable :: error
      real(wp) :: c(3, 3)

      frame%m = [1.0_wp, 2.0_wp, 0.5_wp]
      frame%k = [300.0_wp, 200.0_wp, 500.0_wp]
      call find_modes(frame, error)
      call checks%no_error(error, 'modes')
      c = matmul(transpose(frame%shape), matmul(damping_matrix(frame, 0.07_wp), frame%shape))
      c(1, 1) = c(1, 1) - 0.14_wp*frame%omega(1)
      c(2, 2) = c(2, 2) - 0.14_wp*frame%omega(2)
      c(3, 3) = c(3, 3) - 0.14_wp*frame%omega(3)
      call checks%close_to(maxval(abs(c)), 0.0_wp, 'modal damping', atol=1.0e-12_wp)
   end subroutine check_damping_matrix

   !> Check the coupling at every floor. A straight line that turns by a small angle has, about the
   !> base, the inertia sum(m z**2), the stiffness sum(k h**2) and the excitation sum(m z). The
   !> modal mass at the modal height has the same inertia.
   subroutine check_every_floor()
      type(shear_frame_t) :: frame
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: z(3)

      case = uniform_case(3, 2.0_wp, 1.0_wp, 'every_floor', 'exact', 'dop853')
      case%frame%floors%m = [3.0_wp, 2.0_wp, 1.0_wp]
      case%frame%floors%k = [600.0_wp, 500.0_wp, 300.0_wp]
      case%frame%floors%height = [2.0_wp, 1.5_wp, 0.5_wp]
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'every floor')
      frame = case%frame%floors
      z = [2.0_wp, 3.5_wp, 4.0_wp]
      call checks%close_to((2*pi/case%frame%T_s)**2, sum(frame%k*frame%height**2) &
         /sum(frame%m*z**2), 'period', rtol=1.0e-14_wp)
      call checks%close_to(case%frame%gamma*16, sum(frame%m*z**2), 'inertia', rtol=1.0e-14_wp)
      call checks%close_to(case%frame%gamma*roof_factor(frame, 1)*4, sum(frame%m*z), 'push', &
         rtol=1.0e-14_wp)
      call checks%close_to(modal_mass(frame, 1)*modal_height(frame, 1)**2, sum(frame%m*z**2), &
         'inertia of the modal mass', rtol=1.0e-14_wp)
      call checks%close_to(modal_height(frame, 1)*roof_factor(frame, 1), 4.0_wp, &
         'the modal height moves as the mode''s oscillator', rtol=1.0e-14_wp)
   end subroutine check_every_floor

   !> Check that a host obtains the sum of all link forces and the shear of the lowest storey. With
   !> dampers in the storeys, both depend only on the displacement of the line.
   subroutine check_links_of_every_floor()
      type(case_t) :: case
      type(stepping_t) :: stepping
      type(wall_state_t) :: state
      type(wall_forces_t) :: forces
      type(error_t), allocatable :: error
      real(wp), parameter :: share(3) = [0.5_wp, 0.875_wp, 1.0_wp]
      real(wp), parameter :: a = 3.0_wp
      real(wp) :: shear

      case = uniform_case(3, 2.0_wp, 1.0_wp, 'every_floor', 'exact', 'dop853')
      case%wall%m_w = 1000
      case%frame%floors%m = [3.0_wp, 2.0_wp, 1.0_wp]
      case%frame%floors%k = [600.0_wp, 500.0_wp, 300.0_wp]
      case%frame%floors%height = [2.0_wp, 1.5_wp, 0.5_wp]
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'every floor')
      call create_stepping(stepping, case, error)
      call advance_stepping(stepping, [0.0_wp, 0.2_wp], [a, a], error)
      call checks%no_error(error, 'advance')
      call query_state(stepping, state, error)
      call query_forces(stepping, forces, error)
      call checks%that(abs(state%theta) > 0 .and. .not. state%at_rest, 'the wall rocks')
      shear = 600*share(1)*(state%u_s + case%frame%xi_s*case%frame%T_s/pi*state%u_s_dot)
      call checks%close_to(forces%frame_shear, 1000*shear, 'shear of the lowest storey', &
         rtol=1.0e-13_wp)
      call checks%close_to(forces%link, 1000*(sum(case%frame%floors%m*(share*state%u_s_ddot &
         + a)) + shear), 'all links', rtol=1.0e-13_wp)
      call destroy_stepping(stepping)
   end subroutine check_links_of_every_floor

   !> Check that a host obtains the force of the link spring. The force follows from the rotation of
   !> the wall alone; less the elongation k_link, the undamped storey bears the rest.
   subroutine check_link_spring()
      type(case_t) :: case
      type(stepping_t) :: stepping
      type(wall_state_t) :: state
      type(wall_forces_t) :: forces
      type(error_t), allocatable :: error
      real(wp), parameter :: a = 3.0_wp, k_link = 4000.0_wp
      real(wp) :: alpha, R, moment, slope

      case = uniform_case(1, 2.0_wp, 1.0_wp, 'springs', 'exact', 'dop853')
      case%wall%m_w = 1000
      case%frame%xi_s = 0
      case%frame%k_link = [k_link]
      deallocate (case%cable)
      call create_stepping(stepping, case, error)
      call advance_stepping(stepping, [0.0_wp, 0.2_wp], [a, a], error)
      call checks%no_error(error, 'advance')
      call query_state(stepping, state, error)
      call query_forces(stepping, forces, error)
      call checks%that(state%theta < 0 .and. .not. state%at_rest, 'the wall rocks')
      alpha = atan2(case%wall%b, case%wall%h)
      R = hypot(case%wall%b, case%wall%h)
      ! about the left corner, the frame is linked to the corner above it
      slope = 2*case%wall%h*cos(state%theta)
      moment = case%model%g*R*sin(alpha + state%theta) - a*R*cos(alpha + state%theta) &
         - 4*R**2/3*state%theta_ddot
      call checks%close_to(forces%link*slope, 1000*moment, 'force of the spring', rtol=1.0e-12_wp)
      call checks%close_to(forces%frame_shear, 1000*case%frame%floors%k(1)*(state%u_s &
         - forces%link/(1000*k_link)), 'shear of the storey', rtol=1.0e-12_wp)
      call destroy_stepping(stepping)
   end subroutine check_link_spring

end program test_storeys
