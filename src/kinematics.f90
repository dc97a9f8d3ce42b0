!> Kinematics of wall and frame on one side of the motion, per half diagonal R.
!>
!> With phi = |theta| and the frame's displacement |u_s| = R u(phi) away from the pivot,
!> j = du/dphi and k = dj/dphi. `lever` is the arm of the link's force; virtual work says that it
!> equals j, which Eq. (10) of the paper violates (see docs/theory.md).
module rwmf_kinematics
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: kinematics_t, kinematics_i
   public :: top_corner, left_corner, published_negative, pinned_base

   !> Values at one rotation, all [-].
   type :: kinematics_t
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
      pure subroutine kinematics_i(sin_alpha, cos_alpha, phi, kin)
         import :: kinematics_t, wp
         implicit none
         real(wp), intent(in) :: sin_alpha
         !! of the slenderness [-]
         real(wp), intent(in) :: cos_alpha
         !! [-]
         real(wp), intent(in) :: phi
         !! [rad]
         type(kinematics_t), intent(out) :: kin
      end subroutine kinematics_i
   end interface

contains

   !> Link at the top corner above the lifting base corner: Eqs (4) to (6), theta > 0 of all
   !> formulations and both sides of `symmetric`: u = 2 (sin(alpha) - sin(alpha - phi)).
   pure subroutine top_corner(sin_alpha, cos_alpha, phi, kin)
      real(wp), intent(in) :: sin_alpha
      real(wp), intent(in) :: cos_alpha
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin

      call common_part(sin_alpha, cos_alpha, phi, kin)
      kin%j = 2*kin%c
      kin%k = 2*kin%s
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine top_corner

   !> Link at the left top corner while the wall rocks to the left, theta < 0 of `exact`:
   !> u_s = 2h sin(theta).
   pure subroutine left_corner(sin_alpha, cos_alpha, phi, kin)
      real(wp), intent(in) :: sin_alpha
      real(wp), intent(in) :: cos_alpha
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin

      call common_part(sin_alpha, cos_alpha, phi, kin)
      kin%j = 2*cos_alpha*cos(phi)
      kin%u = 2*cos_alpha*sin(phi)
      kin%k = -kin%u
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine left_corner

   !> Eq. (10), theta < 0 of `published`: displacement as at the top corner, lever arm
   !> 2R cos(alpha) cos(theta).
   pure subroutine published_negative(sin_alpha, cos_alpha, phi, kin)
      real(wp), intent(in) :: sin_alpha
      real(wp), intent(in) :: cos_alpha
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin

      call top_corner(sin_alpha, cos_alpha, phi, kin)
      kin%lever = 2*cos_alpha*cos(phi)
      kin%lever_1 = -2*cos_alpha*sin(phi)
   end subroutine published_negative

   !> Wall hinged at the middle of its base, link on its centre line: u_s = 2h sin(theta).
   !> Here s and c are those of the hinged wall: gravity drives it outward, s = -(h/R) sin(phi).
   pure subroutine pinned_base(sin_alpha, cos_alpha, phi, kin)
      real(wp), intent(in) :: sin_alpha
      real(wp), intent(in) :: cos_alpha
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin

      kin%s = -cos_alpha*sin(phi)
      kin%c = cos_alpha*cos(phi)
      kin%j = 2*kin%c
      kin%u = -2*kin%s
      kin%k = -kin%u
      kin%k_1 = -kin%j
      kin%lever = kin%j
      kin%lever_1 = kin%k
   end subroutine pinned_base

   !> s, c and the displacement of the top corner from one half-angle: small rotations keep all
   !> digits.
   pure subroutine common_part(sin_alpha, cos_alpha, phi, kin)
      real(wp), intent(in) :: sin_alpha
      real(wp), intent(in) :: cos_alpha
      real(wp), intent(in) :: phi
      type(kinematics_t), intent(out) :: kin
      real(wp) :: half_sine
      real(wp) :: half_cosine
      real(wp) :: sine
      real(wp) :: versine
      !! 1 - cos(phi)

      half_sine = sin(phi/2)
      half_cosine = cos(phi/2)
      sine = 2*half_sine*half_cosine
      versine = 2*half_sine**2
      kin%s = sin_alpha - (sin_alpha*versine + cos_alpha*sine)
      kin%c = cos_alpha - (cos_alpha*versine - sin_alpha*sine)
      kin%u = 2*(sin_alpha*versine + cos_alpha*sine)
   end subroutine common_part

end module rwmf_kinematics
