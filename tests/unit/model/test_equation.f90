!> Equation of motion compared with the printed coefficients, and the truss law.
program test_equation
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: cable_at, cable_state_t
   use rwmf_model_hysteresis_spring_set, only: elements_energy
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      interval_of, second_derivative
   use rwmf_paper_coefficients, only: coefficients_a, coefficients_b
   use rwmf_motion_ground_motion, only: acceleration, interval_at, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use scenes, only: rwmf_scene
   implicit none

   real(wp), parameter :: t = 0.3_wp
   !! inside the pulse [s]
   type(checks_t) :: checks

   if (checks%wants('printed_coefficients')) call check_printed_coefficients()
   if (checks%wants('truss')) call check_truss()
   call checks%finish()

contains

   !> Compare the coefficients with Eq. (15), A_1 to A_4 and B_1 to B_4 as printed.
   subroutine check_printed_coefficients()
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp) :: y(2)
      real(wp) :: C(4)
      integer :: side

      do side = -1, 1, 2
         call build(rwmf_scene('published', 5.0_wp, 1.0_wp, 'adams'), motion, side, equation)
         y = [side*0.07_wp, 0.4_wp]
         if (side < 0) then
            C = printed_a(equation%p, y(1))
            call checks%that(all(abs(coefficients_a(equation%p, y(1)) - C) <= 1.0e-12_wp*abs(C)), &
               'A_1 to A_4')
         else
            C = printed_b(equation%p, y(1))
            call checks%that(all(abs(coefficients_b(equation%p, y(1)) - C) <= 1.0e-12_wp*abs(C)), &
               'B_1 to B_4')
         end if
         call checks%close_to(second_derivative(equation, t, y), C(1)*y(2)**2 + C(2)*y(2) &
            + C(3)*acceleration(motion, interval_of(equation), t) + C(4), 'Eq. (15)', &
            rtol=1.0e-12_wp)
      end do
   end subroutine check_printed_coefficients

   !> Eq. (15a), theta < 0.
   function printed_a(p, theta) result(A)
      type(parameters_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: A(4)
      real(wp) :: a_1, a_2, a_3, a_4, a_5, a_6, a_7
      real(wp) :: c

      c = cos(-p%alpha - theta)
      a_1 = 1/(4.0_wp/3 + 4*p%gamma*cos(p%alpha)*cos(theta)*c)
      a_2 = -4*p%gamma*cos(p%alpha)*cos(theta)
      a_3 = -(2*p%gamma*cos(p%alpha)*cos(theta) + c)/p%R
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha)
      a_5 = 2*p%omega_s*p%xi_s*c
      a_6 = sin(-p%alpha - theta)
      a_7 = -p%omega_s**2*(sin(-p%alpha - theta) + sin(p%alpha))
      ! The printed a_7 already carries the sign of the spring force's moment on this side.
      A = [a_1*a_2*a_6, a_1*a_2*a_5, a_1*a_3, a_1*a_2*a_7 - p%g/p%R*a_1*(a_6 - a_4)]
   end function printed_a

   !> Eq. (15b), theta > 0.
   function printed_b(p, theta) result(B)
      type(parameters_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: B(4)
      real(wp) :: a_4, b_1, b_2, b_3, b_4, b_5
      real(wp) :: c, s

      c = cos(p%alpha - theta)
      s = sin(p%alpha - theta)
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha)
      b_1 = 1/(4.0_wp/3 + 4*p%gamma*c**2)
      b_2 = -4*p%gamma*c*s
      b_3 = -8*p%gamma*p%omega_s*p%xi_s*c**2
      b_4 = -(2*p%gamma + 1)/p%R*c
      b_5 = -4*p%gamma*c*p%omega_s**2*(sin(p%alpha) - s) - p%g/p%R*s
      B = [b_1*b_2, b_1*b_3, b_1*b_4, b_1*b_5 - p%g/p%R*b_1*a_4]
   end function printed_b

   !> Build the equation of a scene during the pulse, on one side.
   subroutine build(case, motion, side, equation)
      type(case_t), intent(in) :: case
      type(motion_t), intent(inout), target :: motion
      integer, intent(in) :: side
      type(equation_t), intent(out) :: equation

      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      call enter_side(equation%model_t, equation%state, side)
      call enter_interval(equation%model_t, equation%state, interval_at(motion, t))
   end subroutine build

   !> Check the truss law: it keeps P(0) and P(alpha), and its moment is the derivative of its
   !> energy.
   subroutine check_truss()
      real(wp), parameter :: step = 1.0e-5_wp
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(cable_state_t) :: cable, before, after
      real(wp) :: stored(2, 2)
      !! energy of cable and other elements before and after [J/kg]

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
      stored = reshape([elements_energy(equation, 0.1_wp - step), elements_energy(equation, &
         0.1_wp + step)], [2, 2])
      call checks%close_to(cable%moment, (stored(1, 2) - stored(1, 1))/(2*step*equation%p%g &
         *equation%p%R), &
         'moment of the truss is the slope of its energy', rtol=1.0e-8_wp)
   end subroutine check_truss

end program test_equation
