!> Section at the base of a rocking wall on a strip of springs without tension (`&base_section`).
!>
!> The normal force N presses the strip of stiffness k per area [N/m3], width B and thickness t. The
!> base is rotated by phi. While the far corner lifts, the contact length is
!> c = sqrt(2 N/(k t phi)). The stress grows linearly over it up to k phi c at the toe. The moment
!> of the stresses about the middle of the base is N (B/2 - c/3). With c >= B the whole base is in
!> contact: the stresses at its ends are N/(B t) +- k phi B/2, the moment is k phi t B**3/12. The
!> strip does not affect the motion.
module rwmf_model_no_tension_strip
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: strip_t, contact_length, toe_stress, base_moment

   !> Strip under the base.
   type :: strip_t
      real(wp) :: width
      !! width B of the wall [m]
      real(wp) :: thickness
      !! thickness t of the wall [m]
      real(wp) :: k
      !! stiffness per area [N/m3]
   end type strip_t

contains

   !> Length of the contact from the toe [m]; zero without a compressive force.
   elemental real(wp) function contact_length(strip, normal, phi) result(length)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: rise
      !! increase of the force per length over a length [N/m2]

      length = 0
      if (.not. normal > 0) return
      length = strip%width
      rise = strip%k*strip%thickness*phi
      if (2*normal < rise*length**2) length = sqrt(2*normal/rise)
   end function contact_length

   !> Compressive stress at the toe [Pa]; zero without a compressive force.
   elemental real(wp) function toe_stress(strip, normal, phi) result(stress)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: length

      length = contact_length(strip, normal, phi)
      stress = strip%k*phi*length
      if (length >= strip%width) stress = stress/2 + normal/(strip%width*strip%thickness)
   end function toe_stress

   !> Moment of the stresses about the middle of the base [N m]; zero without a compressive force.
   elemental real(wp) function base_moment(strip, normal, phi) result(moment)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: length

      length = contact_length(strip, normal, phi)
      if (length < strip%width) then
         moment = max(normal, 0.0_wp)*(strip%width/2 - length/3)
      else
         moment = strip%k*phi*strip%thickness*length**3/12
      end if
   end function base_moment

end module rwmf_model_no_tension_strip
