!> Kinematics of wall and frame on one side of the motion, per half diagonal R.
!>
!> With phi = |theta| and the frame's displacement |u_s| = R u(phi) away from the pivot,
!> j = du/dphi and k = dj/dphi. `lever` is the arm of the link's force; virtual work says that it
!> equals j, which Eq. (10) of the paper violates (see docs/theory.md).
module rwmf_model_kinematics
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: geometry_t, kinematics_t, kinematics_i
   public :: top_corner, left_corner, published_negative, pinned_base
   public :: linked_top_corner, linked_left_corner, linked_pinned_base
   public :: rise_of_top_corner, rise_of_left_corner

   !> Shape of the wall and length of the link.
   type :: geometry_t
      real(wp) :: sin_alpha = 0
      !! of the slenderness [-]
      real(wp) :: cos_alpha = 1
      real(wp) :: link = 0
      !! length of the link over R [-]; 0: infinitely long
   end type geometry_t

   !> Values at one rotation, all [-].
   type :: kinematics_t
      real(wp) :: half_sine
      !! sin(phi/2)
      real(wp) :: half_cosine
      !! cos(phi/2)
      real(wp) :: s
      !! sin(alpha - phi): arm of gravity over R
      real(wp) :: c
      !! cos(alpha - phi): arm of the ground's inertia force over R
      real(wp) :: u
      !! displacement of the frame over R
      real(wp) :: j
      !! du/dphi
      real(wp) :: k
      !! dj/dphi
      real(wp) :: k_1
      !! dk/dphi
      real(wp) :: lever
      !! arm of the link's force over R
      real(wp) :: lever_1
      !! its derivative by phi
   end type kinematics_t

   abstract interface
      !> Kinematics at the rotation phi.
      pure subroutine kinematics_i(geometry, phi, kin)
         import :: geometry_t, kinematics_t, wp
         implicit none
         type(geometry_t), intent(in) :: geometry
         real(wp), value :: phi
         !! [rad]
         type(kinematics_t), intent(out) :: kin
      end subroutine kinematics_i
   end interface

contains

   !> Link at the top corner above the lifting base corner: Eqs (4) to (6), theta > 0 of all
   !> formulations and both sides of `symmetric`: u = 2 (sin(alpha) - sin(alpha - phi)).
   pure subroutine top_corner(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call common_part(geometry, phi, kin)
      kin%j = 2*kin%c
      kin%k = 2*kin%s
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine top_corner

   !> Link at the left top corner while the wall rocks to the left, theta < 0 of `exact`:
   !> u_s = 2h sin(theta).
   pure subroutine left_corner(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call common_part(geometry, phi, kin)
      kin%j = 2*geometry%cos_alpha*cosine(kin)
      kin%u = 2*geometry%cos_alpha*sine(kin)
      kin%k = -kin%u
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine left_corner

   !> Eq. (10), theta < 0 of `published`: displacement as at the top corner, lever arm
   !> 2R cos(alpha) cos(theta).
   pure subroutine published_negative(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call top_corner(geometry, phi, kin)
      kin%lever = 2*geometry%cos_alpha*cosine(kin)
      kin%lever_1 = -2*geometry%cos_alpha*sine(kin)
   end subroutine published_negative

   !> Wall hinged at the middle of its base, link on its centre line: u_s = 2h sin(theta).
   !> Here s and c are those of the hinged wall: gravity drives it outward, s = -(h/R) sin(phi).
   pure subroutine pinned_base(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call halve(phi, kin%half_sine, kin%half_cosine)
      kin%s = -geometry%cos_alpha*sine(kin)
      kin%c = geometry%cos_alpha*cosine(kin)
      kin%j = 2*kin%c
      kin%u = -2*kin%s
      kin%k = -kin%u
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine pinned_base

   !> Link of finite length at the rising top corner, theta > 0 and both sides of `symmetric`,
   !> Eqs (2), (3): the link tilts while the corner rises by v = 2 (cos(alpha - phi) - cos(alpha)).
   pure subroutine linked_top_corner(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call top_corner(geometry, phi, kin)
      call add_tilt(geometry%link, 1.0_wp, rise_of_top_corner(geometry, kin), 2*kin%s, kin)
   end subroutine linked_top_corner

   !> Link of finite length at the left top corner, theta < 0 of `exact`: the corner sinks by
   !> 2 cos(alpha) (1 - cos(phi)), and the tilt of the link acts against the displacement.
   pure subroutine linked_left_corner(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call left_corner(geometry, phi, kin)
      call add_tilt(geometry%link, -1.0_wp, rise_of_left_corner(geometry, kin), -kin%u, kin)
   end subroutine linked_left_corner

   !> Link of finite length at the middle of a hinged wall's top, the frame to the left of it: that
   !> point sinks by 2 cos(alpha) (1 - cos(theta)) on both sides.
   pure subroutine linked_pinned_base(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), value :: phi
      type(kinematics_t), intent(out) :: kin

      call pinned_base(geometry, phi, kin)
      call add_tilt(geometry%link, 1.0_wp, rise_of_left_corner(geometry, kin), -kin%u, kin)
   end subroutine linked_pinned_base

   !> How far the top corner above the lifting base corner has risen, over R [-].
   pure real(wp) function rise_of_top_corner(geometry, kin) result(rise)
      type(geometry_t), intent(in) :: geometry
      type(kinematics_t), intent(in) :: kin
      !! at the rotation

      rise = 4*kin%half_sine*(geometry%sin_alpha*kin%half_cosine &
         - geometry%cos_alpha*kin%half_sine)
   end function rise_of_top_corner

   !> The same for a point of the top above the pivot, which sinks [-].
   pure real(wp) function rise_of_left_corner(geometry, kin) result(rise)
      type(geometry_t), intent(in) :: geometry
      type(kinematics_t), intent(in) :: kin
      !! at the rotation

      rise = -4*geometry%cos_alpha*kin%half_sine**2
   end function rise_of_left_corner

   !> Add sign*(l - sqrt(l**2 - v**2)) and its derivatives to the displacement. The corner moves on
   !> a circle: the second derivative of v is -j of the infinitely long link, the third is -v_1.
   pure subroutine add_tilt(l, sign_of_tilt, v, v_1, kin)
      real(wp), intent(in) :: l
      !! length of the link over R [-]
      real(wp), intent(in) :: sign_of_tilt
      !! +1: the tilt pushes the frame on, -1: it holds it back
      real(wp), intent(in) :: v
      !! rise of the corner over R [-]
      real(wp), intent(in) :: v_1
      !! and its derivative by phi
      type(kinematics_t), intent(inout) :: kin
      real(wp) :: root
      real(wp) :: tilt_1, tilt_2, tilt_3

      root = sqrt(l**2 - v**2)
      ! tilt = l - root has root*tilt' = v v', which is differentiated twice
      tilt_1 = v*v_1/root
      tilt_2 = (v_1**2 - v*kin%j + tilt_1**2)/root
      tilt_3 = (3*(tilt_1*tilt_2 - v_1*kin%j) - v*v_1)/root
      kin%u = kin%u + sign_of_tilt*v**2/(l + root)
      kin%j = kin%j + sign_of_tilt*tilt_1
      kin%k = kin%k + sign_of_tilt*tilt_2
      kin%k_1 = kin%k_1 + sign_of_tilt*tilt_3
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine add_tilt

   !> s, c and the displacement of the top corner from one half-angle: small rotations keep all
   !> digits.
   pure subroutine common_part(geometry, phi, kin)
      type(geometry_t), intent(in) :: geometry
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin
      real(wp) :: lift

      call halve(phi, kin%half_sine, kin%half_cosine)
      associate (sin_alpha => geometry%sin_alpha, cos_alpha => geometry%cos_alpha)
         lift = 2*kin%half_sine*(sin_alpha*kin%half_sine + cos_alpha*kin%half_cosine)
         kin%s = sin_alpha - lift
         kin%c = cos_alpha - 2*kin%half_sine*(cos_alpha*kin%half_sine &
            - sin_alpha*kin%half_cosine)
         kin%u = 2*lift
      end associate
   end subroutine common_part

   !> Sine and cosine of half the rotation. A root takes the place of the cosine, whose call would
   !> cost as much as the rest of a right-hand side; it is as accurate for |phi| < pi, and no wall
   !> turns beyond pi/2.
   pure subroutine halve(phi, half_sine, half_cosine)
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(out) :: half_sine
      real(wp), intent(out) :: half_cosine

      half_sine = sin(phi/2)
      half_cosine = sqrt(1 - half_sine**2)
   end subroutine halve

   !> sin(phi) of kinematics whose half angle is known.
   pure real(wp) function sine(kin)
      type(kinematics_t), intent(in) :: kin

      sine = 2*kin%half_sine*kin%half_cosine
   end function sine

   !> cos(phi).
   pure real(wp) function cosine(kin)
      type(kinematics_t), intent(in) :: kin

      cosine = 1 - 2*kin%half_sine**2
   end function cosine

end module rwmf_model_kinematics
