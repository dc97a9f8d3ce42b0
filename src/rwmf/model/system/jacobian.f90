!> Derivatives of the right-hand side for implicit methods.
module rwmf_model_system_jacobian
   use rwmf_core_kinds, only: wp
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_equation, only: ground, has_further_effects
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_system_assembly, only: cable_at, equation_t, kinematics_at, rates_at, &
      second_derivative
   implicit none
   private

   public :: jacobian, full_jacobian

contains

   !> Compute the derivatives of all rates with respect to all states.
   subroutine full_jacobian(equation, t, y, values)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: values(:, :)
      !! (states, states)
      real(wp) :: step(size(y))
      real(wp) :: forward(size(y))
      real(wp) :: backward(size(y))
      real(wp) :: h
      integer :: i

      if (equation%n == 2) then
         values(1, :) = [0.0_wp, 1.0_wp]
         call jacobian(equation, t, y, values(2, 1), values(2, 2))
         return
      end if
      do i = 1, equation%n
         h = epsilon(h)**(1.0_wp/3)*max(abs(y(i)), 1.0e-3_wp)
         step = 0
         step(i) = h
         call rates_at(equation, t, y + step, forward)
         call rates_at(equation, t, y - step, backward)
         values(:, i) = (forward - backward)/(2*h)
      end do
      ! A held wall (theta'' = 0 in every case) must stay exactly at zero. For this, the elimination
      ! must find only zeros below its two rows.
      if (all(abs(values(2, :)) <= 0)) values(3:, :2) = 0
   end subroutine full_jacobian

   !> Compute the derivatives of theta'' with respect to theta [1/s2] and theta' [1/s].
   subroutine jacobian(equation, t, y, by_theta, by_theta_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: by_theta
      !! derivative of theta'' with respect to theta [1/s2]
      real(wp), intent(out) :: by_theta_dot
      !! derivative of theta'' with respect to theta' [1/s]
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      real(wp) :: phi_dot
      real(wp) :: force
      real(wp) :: force_1
      real(wp) :: inertia
      real(wp) :: moment_1

      if (has_further_effects(equation)) then
         call difference_quotients(equation, t, y, by_theta, by_theta_dot)
         return
      end if
      associate (p => equation%p)
         if (.not. equation%has_wall) then
            by_theta = -p%omega_s**2
            by_theta_dot = -2*p%xi_s*p%omega_s
            return
         end if
         kin = kinematics_at(equation, y(1))
         cable = cable_at(equation, y(1))
         phi_dot = equation%state%side*y(2)
         force = kin%k*phi_dot**2 + 2*p%xi_s*p%omega_s*kin%j*phi_dot + p%omega_s**2*kin%u
         force_1 = kin%k_1*phi_dot**2 + 2*p%xi_s*p%omega_s*kin%k*phi_dot + p%omega_s**2*kin%j
         inertia = equation%inertia + p%gamma*kin%lever*kin%j
         moment_1 = -p%gamma*(kin%lever_1*force + kin%lever*force_1) &
            - (p%gamma*kin%lever_1 + kin%s)*equation%state%side*ground(equation, t)/p%R &
            - p%g/p%R*(cable%moment_1 - kin%c)
         by_theta = (moment_1 - p%gamma*(kin%lever_1*kin%j + kin%lever*kin%k) &
            *equation%state%side*second_derivative(equation, t, y))/inertia
         by_theta_dot = -2*p%gamma*kin%lever*(kin%k*phi_dot + p%xi_s*p%omega_s*kin%j)/inertia
      end associate
   end subroutine jacobian

   !> Compute the derivatives by central differences, for scenes with further effects. Their
   !> accuracy is sufficient for Newton's iteration.
   subroutine difference_quotients(equation, t, y, by_theta, by_theta_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: by_theta
      real(wp), intent(out) :: by_theta_dot
      real(wp), parameter :: slowest = 1.0e-20_wp
      !! smallest velocity that a steep law distinguishes from zero [rad/s]
      real(wp) :: step(size(y))
      real(wp) :: h

      h = epsilon(h)**(1.0_wp/3)
      step = 0
      step(1) = h
      by_theta = (second_derivative(equation, t, y + step) &
         - second_derivative(equation, t, y - step))/(2*h)
      if (equation%creep > 0) h = h*max(abs(y(2)), slowest)
      step = 0
      step(2) = h
      by_theta_dot = (second_derivative(equation, t, y + step) &
         - second_derivative(equation, t, y - step))/(2*h)
   end subroutine difference_quotients

end module rwmf_model_system_jacobian
