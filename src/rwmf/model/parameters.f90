!> Parameters of the equation of motion, with the symbols of the paper.
module rwmf_model_parameters
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: parameters_t

   !> Parameters of the paper's equation of motion (15).
   type :: parameters_t
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
      real(wp) :: sin_alpha = 0
      !! sine of the slenderness [-]
      real(wp) :: cos_alpha = 1
      !! cosine of the slenderness [-]
      real(wp) :: g_over_R = 0
      !! [1/s2]
      real(wp) :: two_xi_omega = 0
      !! 2 xi_s omega_s [1/s]
      real(wp) :: omega_squared = 0
      !! omega_s**2 [1/s2]
   end type parameters_t

end module rwmf_model_parameters
