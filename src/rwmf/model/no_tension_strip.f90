!> Section at the base of a rocking wall on a strip of springs without tension (`&base_section`).
!>
!> The normal force N presses the strip of stiffness k per area [N/m3], width B and thickness t. The
!> base is rotated by phi. While the far corner lifts, the contact length is
!> c = sqrt(2 N/(k t phi)). The stress grows linearly over it up to k phi c at the toe. The moment
!> of the stresses about the middle of the base is N (B/2 - c/3). With c >= B the whole base is in
!> contact: the stresses at its ends are N/(B t) +- k phi B/2, the moment is k phi t B**3/12. The
!> strip does not affect the motion.
!>
!> A stress does not exceed the strength f_c. Where the elastic one would, it is f_c from the toe
!> on, and linear over the length f_c/(k phi) beyond. The contact length is
!> c = N/(t f_c) + f_c/(2 k phi). Where this is at least B,
!> c = B + f_c/(k phi) - sqrt(2 (f_c B - N/t)/(k phi)). A force above f_c B t has no equilibrium.
!> The settlement of the toe, phi c, continues linearly there.
module rwmf_model_no_tension_strip
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: strip_t, contact_length, settlement_stress, toe_stress, base_moment

   !> Strip under the base.
   type :: strip_t
      real(wp) :: width
      !! width B of the wall [m]
      real(wp) :: thickness
      !! thickness t of the wall [m]
      real(wp) :: k
      !! stiffness per area [N/m3]
      real(wp) :: strength = huge(1.0_wp)
      !! largest stress f_c [Pa]
   end type strip_t

contains

   !> Length of the contact from the toe [m]; zero without a compressive force.
   elemental real(wp) function contact_length(strip, normal, phi) result(length)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]

      length = elastic_length(strip, normal, phi)
      if (.not. elastic_stress(strip, normal, phi) > strip%strength) return
      associate (stress => settlement_stress(strip, normal, phi), rise => strip%k*phi)
         length = strip%width
         if (stress < rise*strip%width) length = stress/rise
      end associate
   end function contact_length

   !> Compressive stress at the toe [Pa]; zero without a compressive force.
   elemental real(wp) function toe_stress(strip, normal, phi) result(stress)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]

      stress = min(elastic_stress(strip, normal, phi), strip%strength)
   end function toe_stress

   !> Settlement of the toe times the stiffness of the strip: its stress without a strength [Pa].
   elemental real(wp) function settlement_stress(strip, normal, phi) result(stress)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: spare
      !! force that the whole base resists beyond the normal force, over the thickness [N/m]

      stress = elastic_stress(strip, normal, phi)
      if (.not. stress > strip%strength) return
      associate (width => strip%width, strength => strip%strength, rise => strip%k*phi)
         spare = strength*width - normal/strip%thickness
         if (spare > 0) then
            stress = rise*normal/(strip%thickness*strength) + strength/2
            if (stress > rise*width) stress = strength + rise*width - sqrt(2*rise*spare)
         else
            stress = normal/(width*strip%thickness) + rise*width
         end if
      end associate
   end function settlement_stress

   !> Moment of the stresses about the middle of the base [N m]; zero without a compressive force.
   elemental real(wp) function base_moment(strip, normal, phi) result(moment)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: length

      length = elastic_length(strip, normal, phi)
      if (elastic_stress(strip, normal, phi) > strip%strength) then
         moment = crushed_moment(strip, normal, strip%k*phi, settlement_stress(strip, normal, phi))
      else if (length < strip%width) then
         moment = max(normal, 0.0_wp)*(strip%width/2 - length/3)
      else
         moment = strip%k*phi*strip%thickness*length**3/12
      end if
   end function base_moment

   !> Moment about the middle of the base with the strength at the toe [N m].
   elemental real(wp) function crushed_moment(strip, normal, rise, stress) result(moment)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: rise
      !! increase of the stress over a length [Pa/m]
      real(wp), intent(in) :: stress
      !! settlement stress of the toe [Pa]
      real(wp) :: plateau, slope, cut
      !! lengths of the strength, of the linear stress, and of its part beyond the base [m]

      moment = 0
      if (normal >= strip%strength*strip%width*strip%thickness) return
      slope = strip%strength/rise
      plateau = stress/rise - slope
      cut = max(stress/rise - strip%width, 0.0_wp)
      moment = normal*strip%width/2 - strip%thickness*(strip%strength*(plateau**2/2 &
         + slope/2*(plateau + slope/3)) - rise*cut**2/2*(strip%width + cut/3))
   end function crushed_moment

   !> Length of the contact of the elastic strip from the toe [m].
   elemental real(wp) function elastic_length(strip, normal, phi) result(length)
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
   end function elastic_length

   !> Compressive stress at the toe of the elastic strip [Pa].
   elemental real(wp) function elastic_stress(strip, normal, phi) result(stress)
      type(strip_t), intent(in) :: strip
      real(wp), intent(in) :: normal
      !! compressive normal force [N]
      real(wp), intent(in) :: phi
      !! magnitude of the rotation [rad]
      real(wp) :: length

      length = elastic_length(strip, normal, phi)
      stress = strip%k*phi*length
      if (length >= strip%width) stress = stress/2 + normal/(strip%width*strip%thickness)
   end function elastic_stress

end module rwmf_model_no_tension_strip
