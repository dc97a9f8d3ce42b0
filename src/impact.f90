!> Velocity factor e = sqrt(r) of the impacts at theta = 0.
module rwmf_impact
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: restitution_housner, restitution_momentum

contains

   !> Free-standing block, momentum balance about the new pivot (Housner 1963) [-].
   !> Negative for squat walls (sin(alpha)**2 > 2/3): then nothing bounces and the factor is 0.
   pure elemental real(wp) function restitution_housner(alpha) result(e)
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      e = max(0.0_wp, 1 - 1.5_wp*sin(alpha)**2)
   end function restitution_housner

   !> Momentum balance of wall and frame mass about the new pivot [-]:
   !> e_max = 1 - 1.5 sin(alpha)**2/(1 + 3 gamma cos(alpha)**2).
   pure elemental real(wp) function restitution_momentum(alpha, gamma) result(e)
      real(wp), intent(in) :: alpha
      !! slenderness [rad]
      real(wp), intent(in) :: gamma
      !! mass ratio m_s/m_w, 0 without a frame [-]

      e = max(0.0_wp, 1 - 1.5_wp*sin(alpha)**2/(1 + 3*gamma*cos(alpha)**2))
   end function restitution_momentum

end module rwmf_impact
