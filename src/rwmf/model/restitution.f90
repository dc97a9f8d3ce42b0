!> Velocity factor e = sqrt(r) of the impacts at theta = 0. It follows from the momentum balance, is
!> constant, or depends on the angular velocity before the impact.
module rwmf_model_restitution
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: restitution_t, factor_at, largest_factor
   public :: restitution_housner, restitution_momentum

   !> Restitution law of impacts.
   type :: restitution_t
      real(wp) :: e = 1
      !! constant velocity factor [-]
      real(wp), allocatable :: speed(:)
      !! (n) increasing angular velocities of a table; not allocated without one [rad/s]
      real(wp), allocatable :: factor(:)
      !! (n) velocity factors of the table [-]
   end type restitution_t

contains

   !> Velocity factor of an impact at a given speed [-].
   pure real(wp) function factor_at(restitution, speed) result(e)
      type(restitution_t), intent(in) :: restitution
      real(wp), intent(in) :: speed
      !! magnitude of the angular velocity before the impact [rad/s]
      integer :: i

      e = restitution%e
      if (.not. allocated(restitution%speed)) return
      i = count(restitution%speed <= speed)
      e = restitution%factor(max(1, i))
      if (i == 0 .or. i == size(restitution%speed)) return
      associate (v => restitution%speed, f => restitution%factor)
         e = f(i) + (f(i + 1) - f(i))*((speed - v(i))/(v(i + 1) - v(i)))
      end associate
   end function factor_at

   !> Largest velocity factor of all impacts up to a speed, an upper bound for decaying bounces [-].
   pure real(wp) function largest_factor(restitution, speed) result(e)
      type(restitution_t), intent(in) :: restitution
      real(wp), intent(in) :: speed
      !! [rad/s]

      e = restitution%e
      if (.not. allocated(restitution%speed)) return
      e = max(restitution%factor(1), factor_at(restitution, speed), &
         maxval(restitution%factor, mask=restitution%speed <= speed))
   end function largest_factor

   !> Velocity factor of a free-standing block, from the momentum balance about the new pivot
   !> (Housner 1963) [-]. The balance is negative for squat walls (sin(alpha)**2 > 2/3); they do not
   !> bounce and the factor is 0.
   pure elemental real(wp) function restitution_housner(alpha) result(e)
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      e = max(0.0_wp, 1 - 1.5_wp*sin(alpha)**2)
   end function restitution_housner

   !> Velocity factor from the momentum balance about the new pivot, for wall, frame mass and
   !> inerters [-].
   !>
   !> The factor is e_max = 1 - 1.5 sin(alpha)**2 (1 + 2 beta)/(1 + 3 gamma cos(alpha)**2 + 3 beta
   !> sin(alpha)**2).
   !>
   !> An impulse at the new pivot stops the inerter of the landing corner; it has no arm. The
   !> inerter of the other corner was at rest and must be accelerated.
   pure elemental real(wp) function restitution_momentum(alpha, gamma, beta) result(e)
      real(wp), intent(in) :: alpha
      !! slenderness [rad]
      real(wp), intent(in) :: gamma
      !! mass ratio m_s/m_w, 0 without a frame [-]
      real(wp), intent(in) :: beta
      !! inertance of a corner over m_w, 0 without inerters [-]

      e = max(0.0_wp, 1 - 1.5_wp*sin(alpha)**2*(1 + 2*beta)/(1 + 3*gamma*cos(alpha)**2 &
         + 3*beta*sin(alpha)**2))
   end function restitution_momentum

end module rwmf_model_restitution
