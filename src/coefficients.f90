!> The coefficients A_i and B_i of Eq. (15), in the paper's letters.
!>
!>    theta'' = A_1 theta'**2 + A_2 theta' + A_3 u_g'' + A_4   for theta < 0   (15a)
!>    theta'' = B_1 theta'**2 + B_2 theta' + B_3 u_g'' + B_4   for theta > 0   (15b)
!>
!> Two expressions are written in another but equal form, because the printed one loses all digits
!> of a small rotation: sin(alpha) - sin(alpha - theta) = 2 cos(alpha - theta/2) sin(theta/2), in
!> b_5 and, with theta < 0, in a_7.
module rwmf_coefficients
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: paper_t, coefficients_a, coefficients_b, sine_difference

   !> Parameters of Eq. (15).
   type :: paper_t
      real(wp) :: alpha
      !! slenderness [rad]
      real(wp) :: R
      !! half diagonal of the wall [m]
      real(wp) :: gamma
      !! mass ratio m_s/m_w [-]
      real(wp) :: omega_s
      !! undamped frequency of the frame [rad/s]
      real(wp) :: xi_s
      !! viscous damping ratio of the frame [-]
      real(wp) :: eta_0
      !! P(0)/(m_w g) [-]
      real(wp) :: eta_alpha
      !! P(alpha)/(m_w g) [-]
      real(wp) :: g
      !! [m/s2]
   end type paper_t

contains

   !> A_1 to A_4 of Eq. (15a), theta < 0.
   pure function coefficients_a(p, theta) result(A)
      type(paper_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! rotation, <= 0 [rad]
      real(wp) :: A(4)
      !! [-], [1/s], [1/m], [1/s2]
      real(wp) :: a_1, a_2, a_3, a_4, a_5, a_6, a_7
      real(wp) :: lever
      !! cos(alpha) cos(theta) [-]
      real(wp) :: c
      !! cos(-alpha - theta) [-]

      lever = cos(p%alpha)*cos(theta)
      c = cos(-p%alpha - theta)
      a_1 = 1/(4.0_wp/3 + 4*p%gamma*lever*c)
      a_2 = -4*p%gamma*lever
      a_3 = -(2*p%gamma*lever + c)/p%R
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha)
      a_5 = 2*p%omega_s*p%xi_s*c
      a_6 = sin(-p%alpha - theta)
      a_7 = -p%omega_s**2*sine_difference(p%alpha, -theta)
      A(1) = a_1*a_2*a_6
      A(2) = a_1*a_2*a_5
      A(3) = a_1*a_3
      ! The printed a_7 already carries the sign of the spring force's moment on this side.
      A(4) = a_1*a_2*a_7 - p%g/p%R*a_1*(a_6 - a_4)
   end function coefficients_a

   !> B_1 to B_4 of Eq. (15b), theta > 0.
   pure function coefficients_b(p, theta) result(B)
      type(paper_t), intent(in) :: p
      real(wp), intent(in) :: theta
      !! rotation, >= 0 [rad]
      real(wp) :: B(4)
      !! [-], [1/s], [1/m], [1/s2]
      real(wp) :: a_4, b_1, b_2, b_3, b_4, b_5
      real(wp) :: c
      !! cos(alpha - theta) [-]
      real(wp) :: s
      !! sin(alpha - theta) [-]

      c = cos(p%alpha - theta)
      s = sin(p%alpha - theta)
      a_4 = (p%eta_0 + (p%eta_alpha - p%eta_0)*theta/p%alpha)*sin(p%alpha)
      b_1 = 1/(4.0_wp/3 + 4*p%gamma*c**2)
      b_2 = -4*p%gamma*c*s
      b_3 = -8*p%gamma*p%omega_s*p%xi_s*c**2
      b_4 = -(2*p%gamma + 1)/p%R*c
      b_5 = -4*p%gamma*c*p%omega_s**2*sine_difference(p%alpha, theta) - p%g/p%R*s
      B(1) = b_1*b_2
      B(2) = b_1*b_3
      B(3) = b_1*b_4
      B(4) = b_1*b_5 - p%g/p%R*b_1*a_4
   end function coefficients_b

   !> sin(alpha) - sin(alpha - phi) without cancellation at small phi [-].
   pure elemental real(wp) function sine_difference(alpha, phi)
      real(wp), intent(in) :: alpha
      !! [rad]
      real(wp), intent(in) :: phi
      !! [rad]

      sine_difference = 2*cos(alpha - phi/2)*sin(phi/2)
   end function sine_difference

end module rwmf_coefficients
