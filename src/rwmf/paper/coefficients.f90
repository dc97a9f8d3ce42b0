!> Coefficients A_i and B_i of Eq. (15) with the paper's symbols.
!>
!>    theta'' = A_1 theta'**2 + A_2 theta' + A_3 u_g'' + A_4   for theta < 0   (15a)
!>    theta'' = B_1 theta'**2 + B_2 theta' + B_3 u_g'' + B_4   for theta > 0   (15b)
!>
!> Differences of sines are written in an equivalent form, because the printed one loses all digits
!> at a small rotation. This is sin(alpha) - sin(alpha - phi) in b_5 and a_7, with phi = |theta|.
module rwmf_paper_coefficients
   use rwmf_core_kinds, only: wp
   use rwmf_model_parameters, only: parameters_t
   implicit none
   private

   public :: coefficients_a, coefficients_b

contains

   !> A_1 to A_4 of (15a), theta < 0.
   pure function coefficients_a(p, theta) result(A)
      type(parameters_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! rotation, <= 0 [rad]
      real(wp) :: A(4)
      !! [-], [1/s], [1/m], [1/s2]
      real(wp) :: a_1, a_2, a_3, a_4, a_5, a_6, a_7
      real(wp) :: lever
      !! cos(alpha) cos(theta) [-]
      real(wp) :: lift
      real(wp) :: c
      !! cos(-alpha - theta) [-]
      real(wp) :: cosine
      !! of theta

      call half_angle_kinematics(p, -theta, lift, c, cosine)
      lever = p%cos_alpha*cosine
      a_1 = 1/(4.0_wp/3 + 4*p%gamma*lever*c)
      a_2 = -4*p%gamma*lever
      a_3 = -(2*p%gamma*lever + c)/p%R
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*p%sin_alpha
      a_5 = p%two_xi_omega*c
      a_6 = lift - p%sin_alpha
      a_7 = -p%omega_squared*lift
      A(1) = a_1*a_2*a_6
      A(2) = a_1*a_2*a_5
      A(3) = a_1*a_3
      ! The printed a_7 already has the sign of the spring force's moment on this side.
      A(4) = a_1*(a_2*a_7 - p%g_over_R*(a_6 - a_4))
   end function coefficients_a

   !> B_1 to B_4 of (15b), theta > 0.
   pure function coefficients_b(p, theta) result(B)
      type(parameters_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! rotation, >= 0 [rad]
      real(wp) :: B(4)
      !! [-], [1/s], [1/m], [1/s2]
      real(wp) :: a_4, b_1, b_2, b_3, b_4, b_5
      real(wp) :: lift
      real(wp) :: s
      !! sin(alpha - theta) [-]
      real(wp) :: c
      !! cos(alpha - theta) [-]
      real(wp) :: cosine
      !! of theta

      call half_angle_kinematics(p, theta, lift, c, cosine)
      s = p%sin_alpha - lift
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*p%sin_alpha
      b_1 = 1/(4.0_wp/3 + 4*p%gamma*c**2)
      b_2 = -4*p%gamma*c*s
      b_3 = -4*p%gamma*p%two_xi_omega*c**2
      b_4 = -(2*p%gamma + 1)/p%R*c
      b_5 = -4*p%gamma*c*p%omega_squared*lift - p%g_over_R*s
      B(1) = b_1*b_2
      B(2) = b_1*b_3
      B(3) = b_1*b_4
      B(4) = b_1*(b_5 - p%g_over_R*a_4)
   end function coefficients_b

   !> Compute all sines and cosines from one sine of the half angle.
   pure subroutine half_angle_kinematics(p, phi, lift, c, cosine)
      type(parameters_t), intent(in) :: p
      real(wp), intent(in) :: phi
      !! |theta| [rad]
      real(wp), intent(out) :: lift
      !! sin(alpha) - sin(alpha - phi) [-]
      real(wp), intent(out) :: c
      !! cos(alpha - phi) [-]
      real(wp), intent(out) :: cosine
      !! cos(phi) [-]
      real(wp) :: half_sine
      real(wp) :: half_cosine

      half_sine = sin(phi/2)
      half_cosine = sqrt(1 - half_sine**2)
      lift = 2*half_sine*(p%sin_alpha*half_sine + p%cos_alpha*half_cosine)
      c = p%cos_alpha - 2*half_sine*(p%cos_alpha*half_sine - p%sin_alpha*half_cosine)
      cosine = 1 - 2*half_sine**2
   end subroutine half_angle_kinematics

end module rwmf_paper_coefficients
