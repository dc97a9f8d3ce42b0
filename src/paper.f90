!> The parameters of the equation of motion in the paper's letters.
module rwmf_paper
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: paper_t

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

end module rwmf_paper
