!> The equation of motion against the printed coefficients, its Jacobian and its other forms.
program test_equation
   use check, only: checks_t
   use rwmf_cable, only: cable_state_t
   use rwmf_case, only: case_t
   use rwmf_coefficients, only: coefficients_a, coefficients_b, paper_t
   use rwmf_equation, only: build_equation, cable_at, equation_t, kinematics_at, &
      second_derivative
   use rwmf_jacobian, only: jacobian
   use rwmf_kinds, only: wp
   use rwmf_kinematics, only: kinematics_t
   use rwmf_motion, only: acceleration, interval_at, motion_from_case, motion_t
   use scenes, only: block_scene, rwmf_scene
   implicit none

   real(wp), parameter :: t = 0.3_wp
   !! inside the pulse [s]
   type(checks_t) :: checks

   call check_printed_coefficients()
   call check_published_form()
   call check_displacement_form()
   call check_reductions()
   call check_jacobian('published', 'linear')
   call check_jacobian('symmetric', 'linear')
   call check_jacobian('symmetric', 'truss')
   call check_jacobian('exact', 'linear')
   call check_jacobian('exact', 'truss')
   call check_truss()
   call checks%finish()

contains

   !> Eq. (15) as it is printed, without the rearrangement that saves digits.
   subroutine check_printed_coefficients()
      type(paper_t) :: p
      real(wp) :: A(4), B(4)
      real(wp) :: theta
      real(wp) :: a1, a2, a7, b1, b5

      p = paper_t(0.3_wp, 2.1_wp, 5.0_wp, 6.0_wp, 0.05_wp, 1.0_wp, 5.0_wp, 9.81_wp)
      theta = -0.07_wp
      A = coefficients_a(p, theta)
      a1 = 1/(4.0_wp/3 + 4*p%gamma*cos(p%alpha)*cos(theta)*cos(-p%alpha - theta))
      a2 = -4*p%gamma*cos(p%alpha)*cos(theta)
      a7 = -p%omega_s**2*(sin(-p%alpha - theta) + sin(p%alpha))
      call checks%close_to(A(1), a1*a2*sin(-p%alpha - theta), 'A_1', rtol=1.0e-13_wp)
      call checks%close_to(A(2), a1*a2*2*p%omega_s*p%xi_s*cos(-p%alpha - theta), 'A_2', &
         rtol=1.0e-13_wp)
      call checks%close_to(A(4), a1*a2*a7 - p%g/p%R*a1*(sin(-p%alpha - theta) &
         - (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha)), 'A_4', &
         rtol=1.0e-12_wp)
      theta = 0.07_wp
      B = coefficients_b(p, theta)
      b1 = 1/(4.0_wp/3 + 4*p%gamma*cos(p%alpha - theta)**2)
      b5 = -4*p%gamma*cos(p%alpha - theta)*p%omega_s**2*(sin(p%alpha) - sin(p%alpha - theta)) &
         - p%g/p%R*sin(p%alpha - theta)
      call checks%close_to(B(3), -b1*(2*p%gamma + 1)/p%R*cos(p%alpha - theta), 'B_3', &
         rtol=1.0e-13_wp)
      call checks%close_to(B(4), b1*b5 - p%g/p%R*b1*(p%eta_0 &
         + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha), 'B_4', rtol=1.0e-12_wp)
   end subroutine check_printed_coefficients

   !> Equation of a scene during the pulse, on one side.
   subroutine build(case, motion, side, equation)
      type(case_t), intent(in) :: case
      type(motion_t), intent(inout), target :: motion
      integer, intent(in) :: side
      type(equation_t), intent(out) :: equation

      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      equation%side = side
      equation%interval = interval_at(motion, t)
   end subroutine build

   !> A_i and B_i against the general form with its lever arm.
   subroutine check_published_form()
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      real(wp) :: y(2)
      real(wp) :: expected
      integer :: side

      do side = -1, 1, 2
         call build(rwmf_scene('published', 5.0_wp, 1.0_wp, 'adams'), motion, side, equation)
         y = side*[0.06_wp, -0.4_wp]
         kin = kinematics_at(equation, y(1))
         cable = cable_at(equation, y(1))
         associate (p => equation%p, f => side*acceleration(motion, equation%interval, t))
            expected = -side*(p%gamma*kin%lever*(kin%k*y(2)**2 + p%omega_s**2*kin%u &
               + 2*p%xi_s*p%omega_s*kin%j*side*y(2)) + (p%gamma*kin%lever + kin%c)*f/p%R &
               + p%g/p%R*(kin%s + cable%moment))/(4.0_wp/3 + p%gamma*kin%lever*kin%j)
         end associate
         call checks%close_to(second_derivative(equation, t, y), expected, &
            'Eq. (15) equals the general form', rtol=1.0e-13_wp)
      end do
   end subroutine check_published_form

   !> The same equation with v = |u_s|/(2R) as the unknown (docs/theory.md).
   subroutine check_displacement_form()
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp) :: y(2)
      real(wp) :: angle, c, s, v, v_dot, v_ddot, f, q

      call build(rwmf_scene('symmetric', 5.0_wp, 1.0_wp, 'adams'), motion, -1, equation)
      y = [-0.06_wp, 0.4_wp]
      associate (p => equation%p)
         angle = p%alpha - abs(y(1))
         c = cos(angle)
         s = sin(angle)
         v = sin(p%alpha) - s
         v_dot = c*(-y(2))
         f = -acceleration(motion, equation%interval, t)
         q = p%eta_0 + (p%eta_alpha - p%eta_0)*abs(y(1))/p%alpha
         v_ddot = (4.0_wp/3*s*v_dot**2/c**4 - 8*p%gamma*p%omega_s*p%xi_s*v_dot &
            - 4*p%gamma*p%omega_s**2*v - (2*p%gamma + 1)/p%R*f &
            - p%g/p%R*(s + q*sin(p%alpha))/c)/(4*p%gamma + 4/(3*c**2))
         ! v'' = c phi'' + s phi'**2
         call checks%close_to(second_derivative(equation, t, y), -(v_ddot - s*y(2)**2)/c, &
            'theta form equals the u_s form', rtol=1.0e-13_wp)
      end associate
   end subroutine check_displacement_form

   !> No frame: Eq. (11); gamma = 0 is the same wall.
   subroutine check_reductions()
      type(motion_t), target :: motion
      type(motion_t), target :: other
      type(equation_t) :: with_frame
      type(equation_t) :: without
      type(case_t) :: case
      real(wp) :: y(2)

      case = rwmf_scene('symmetric', 0.0_wp, 1.0_wp, 'adams')
      call build(case, motion, 1, with_frame)
      deallocate (case%frame)
      call build(case, other, 1, without)
      y = [0.05_wp, -0.3_wp]
      call checks%close_to(second_derivative(without, t, y), &
         second_derivative(with_frame, t, y), 'no frame equals gamma = 0', rtol=1.0e-13_wp)
      call build(block_scene('adams'), other, -1, without)
      y = [-0.05_wp, -0.3_wp]
      associate (p => without%p, a => acceleration(other, without%interval, t))
         call checks%close_to(second_derivative(without, t, y), &
            -0.75_wp/p%R*(a*cos(-p%alpha - y(1)) + p%g*sin(-p%alpha - y(1))), 'Eq. (12b)', &
            rtol=1.0e-13_wp)
      end associate
   end subroutine check_reductions

   !> Analytic derivatives against central differences.
   subroutine check_jacobian(formulation, law)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      real(wp), parameter :: step = 1.0e-5_wp
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp) :: y(2)
      real(wp) :: by_theta
      real(wp) :: by_theta_dot
      integer :: side

      case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'adams')
      case%cable%law = law
      do side = -1, 1, 2
         call build(case, motion, side, equation)
         y = side*[0.06_wp, -0.4_wp]
         call jacobian(equation, t, y, by_theta, by_theta_dot)
         call checks%close_to(by_theta, (second_derivative(equation, t, y + [step, 0.0_wp]) &
            - second_derivative(equation, t, y - [step, 0.0_wp]))/(2*step), &
            'd theta_ddot/d theta, '//formulation//' '//law, rtol=1.0e-7_wp)
         call checks%close_to(by_theta_dot, (second_derivative(equation, t, y + [0.0_wp, step]) &
            - second_derivative(equation, t, y - [0.0_wp, step]))/(2*step), &
            'd theta_ddot/d theta_dot, '//formulation//' '//law, rtol=1.0e-7_wp)
      end do
   end subroutine check_jacobian

   !> The truss keeps P(0), P(alpha); its moment is the derivative of its energy.
   subroutine check_truss()
      real(wp), parameter :: step = 1.0e-5_wp
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(cable_state_t) :: cable, before, after

      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'adams')
      case%cable%law = 'truss'
      call build(case, motion, 1, equation)
      cable = cable_at(equation, 0.0_wp)
      call checks%close_to(cable%force, 1.0_wp, 'truss at rest', rtol=1.0e-14_wp)
      cable = cable_at(equation, equation%p%alpha)
      call checks%close_to(cable%force, 5.0_wp, 'truss at alpha', rtol=1.0e-14_wp)
      cable = cable_at(equation, 0.1_wp)
      before = cable_at(equation, 0.1_wp - step)
      after = cable_at(equation, 0.1_wp + step)
      call checks%close_to(cable%moment, (after%energy - before%energy)/(2*step), &
         'moment of the truss is the slope of its energy', rtol=1.0e-8_wp)
   end subroutine check_truss

end program test_equation
