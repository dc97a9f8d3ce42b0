!> Force of the unbonded cable over the weight of the wall, and its lever arm.
module rwmf_model_cable
   use rwmf_core_kinds, only: wp
   use rwmf_model_bilinear_spring, only: bilinear_energy, bilinear_force, bilinear_tangent
   use rwmf_model_lanes, only: cable_coefficients
   use rwmf_model_spring, only: branch_t, spring_t
   implicit none
   private

   public :: cable_law_t, cable_state_t, no_cable, linear_cable, signed_linear_cable
   public :: cable_law_i, spring_cable, cable_elongation, cable_row, cable_stiffness, cable_strain

   !> Parameters of the cable.
   type :: cable_law_t
      real(wp) :: eta_0 = 0
      !! P(0)/(m_w g) [-]
      real(wp) :: rate = 0
      !! linear law, (eta_alpha - eta_0)/alpha [1/rad]; truss law, the same increase of force over
      !! the elongation at alpha [1/m]
      real(wp) :: R = 0
      !! half diagonal [m]
      real(wp) :: h = 0
      !! half height [m]
      real(wp) :: b = 0
      !! half width [m]
      real(wp) :: length = 0
      !! length that is strained [m]; 0: unknown
      logical :: is_signed = .false.
      !! Eq. (1) as printed: the force falls with rocking for theta < 0
      logical :: is_straight = .false.
      !! 'truss', else 'linear'
      logical :: is_tendon = .false.
      !! the cable can yield or break
      type(spring_t) :: tendon
      !! spring of the tendon, or of the straight elastic cable; force over m_w g, elongation in m
   end type cable_law_t

   !> Force, moment and stored energy at one rotation, over m_w g R.
   type :: cable_state_t
      real(wp) :: force
      !! q = P/(m_w g) [-]
      real(wp) :: moment
      !! q times the arm over R [-]
      real(wp) :: moment_1
      !! derivative of the moment with respect to phi [1/rad]
      real(wp) :: energy
      !! work stored since phi = 0 over m_w g R [-]
   end type cable_state_t

   abstract interface
      !> Compute the state of the cable at |theta| = phi on the side sigma.
      pure subroutine cable_law_i(law, branch, sin_alpha, phi, side, cable)
         import :: branch_t, cable_law_t, cable_state_t, wp
         implicit none
         type(cable_law_t), intent(in) :: law
         type(branch_t), intent(in) :: branch
         !! branch of the tendon
         real(wp), intent(in) :: sin_alpha
         !! sine of the slenderness [-]
         real(wp), intent(in) :: phi
         !! [rad]
         integer, intent(in) :: side
         !! +1 or -1
         type(cable_state_t), intent(out) :: cable
      end subroutine cable_law_i

   end interface

   !> Straight cable at one rotation.
   type :: straight_t
      real(wp) :: elongation
      !! [m]
      real(wp) :: arm
      !! derivative of the elongation with respect to phi [m]
      real(wp) :: length
      !! [m]
      real(wp) :: sine
      !! of phi
      real(wp) :: cosine
   end type straight_t

contains

   !> Return zero force, moment and energy, for a scene without a cable.
   pure subroutine no_cable(law, branch, sin_alpha, phi, side, cable)
      type(cable_law_t), intent(in) :: law
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: sin_alpha
      !! sine of the slenderness [-]
      real(wp), intent(in) :: phi
      !! [rad]
      integer, intent(in) :: side
      !! +1 or -1, the current side
      type(cable_state_t), intent(out) :: cable

      cable%force = 0
      cable%moment = 0
      cable%moment_1 = 0
      cable%energy = 0
   end subroutine no_cable

   !> Evaluate Eq. (1) with |theta|: the force rises with rocking on both sides.
   pure subroutine linear_cable(law, branch, sin_alpha, phi, side, cable)
      type(cable_law_t), intent(in) :: law
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: sin_alpha
      !! sine of the slenderness [-]
      real(wp), intent(in) :: phi
      !! [rad]
      integer, intent(in) :: side
      !! +1 or -1, the current side
      type(cable_state_t), intent(out) :: cable

      call signed_linear_cable(law, branch, sin_alpha, phi, abs(side), cable)
   end subroutine linear_cable

   !> Evaluate Eq. (1) as printed: for theta < 0 the force falls with rocking (kept for
   !> `published`).
   pure subroutine signed_linear_cable(law, branch, sin_alpha, phi, side, cable)
      type(cable_law_t), intent(in) :: law
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: sin_alpha
      !! sine of the slenderness [-]
      real(wp), intent(in) :: phi
      !! [rad]
      integer, intent(in) :: side
      !! +1 or -1, the current side
      type(cable_state_t), intent(out) :: cable

      cable%force = law%eta_0 + side*law%rate*phi
      cable%moment = cable%force*sin_alpha
      cable%moment_1 = side*law%rate*sin_alpha
      cable%energy = sin_alpha*phi*(law%eta_0 + side*law%rate*phi/2)
   end subroutine signed_linear_cable

   !> Straight cable from the middle of the base to the middle of the top. Its length is l =
   !> sqrt(4h^2 + 2b^2 (1 - cos(phi)) + 4hb sin(phi)), computed from the sine of half the angle.
   pure type(straight_t) function stretched(law, half_sine) result(straight)
      type(cable_law_t), intent(in) :: law
      real(wp), intent(in) :: half_sine
      real(wp) :: rise
      !! l**2 - (2h)**2 [m2]

      straight%sine = 2*half_sine*sqrt(1 - half_sine**2)
      straight%cosine = 1 - 2*half_sine**2
      rise = 4*law%b*(law%b*half_sine**2 + law%h*straight%sine)
      straight%length = sqrt(4*law%h**2 + rise)
      straight%elongation = rise/(straight%length + 2*law%h)
      straight%arm = law%b*(law%b*straight%sine + 2*law%h*straight%cosine)/straight%length
   end function stretched

   !> Coefficients of the lane loop `add_linear_cable` or `add_straight_cable`, on the active
   !> branch.
   pure function cable_row(law, branch, side, g_over_R) result(row)
      type(cable_law_t), intent(in) :: law
      type(branch_t), intent(in) :: branch
      !! branch of a straight cable or a tendon
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: g_over_R
      !! [1/s2]
      real(wp) :: row(cable_coefficients)

      row = 0
      if (law%is_straight) then
         row = [g_over_R/law%R*[branch%offset, branch%slope], law%h, law%b]
      else if (law%is_tendon) then
         row(:2) = g_over_R*law%b/law%R*[branch%offset, branch%slope*law%b]
      else
         row(:2) = g_over_R*law%b/law%R*[law%eta_0, law%rate]
         if (law%is_signed) row(2) = side*row(2)
      end if
   end function cable_row

   !> Compute the elongation and the lever arm, its derivative with respect to phi [m]. They hold
   !> for a straight cable or for a tendon with the linear law. With that law the arm of Eq. (1) is
   !> R sin(alpha) = b.
   pure subroutine cable_elongation(law, phi, elongation, arm, arm_1)
      type(cable_law_t), intent(in) :: law
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(out) :: elongation
      !! increase of the length over that at rest [m]
      real(wp), intent(out) :: arm
      !! derivative of the elongation with respect to phi [m]
      real(wp), intent(out), optional :: arm_1
      !! derivative of the arm [m]
      type(straight_t) :: straight

      if (law%is_straight) then
         straight = stretched(law, sin(phi/2))
         elongation = straight%elongation
         arm = straight%arm
         if (present(arm_1)) arm_1 = (law%b*(law%b*straight%cosine &
            - 2*law%h*straight%sine) - arm**2)/straight%length
      else
         elongation = law%b*phi
         arm = law%b
         if (present(arm_1)) arm_1 = 0
      end if
   end subroutine cable_elongation

   !> Elastic stiffness of the cable over m_w g [1/m].
   pure real(wp) function cable_stiffness(law) result(stiffness)
      type(cable_law_t), intent(in) :: law

      stiffness = law%rate
      if (.not. law%is_straight) stiffness = stiffness/law%b
   end function cable_stiffness

   !> Strain of a cable with a known length, that of the prestress included [-].
   pure real(wp) function cable_strain(law, theta) result(strain)
      type(cable_law_t), intent(in) :: law
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: elongation, arm

      call cable_elongation(law, abs(theta), elongation, arm)
      if (law%is_signed .and. theta < 0) elongation = -elongation
      strain = (law%eta_0/cable_stiffness(law) + elongation)/law%length
   end function cable_strain

   !> Evaluate the cable as a spring on its elongation. It is a straight cable, or a tendon with
   !> either law that yields, goes slack or breaks.
   pure subroutine spring_cable(law, branch, sin_alpha, phi, side, cable)
      type(cable_law_t), intent(in) :: law
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: sin_alpha
      !! sine of the slenderness [-]
      real(wp), intent(in) :: phi
      !! [rad]
      integer, intent(in) :: side
      !! +1 or -1, the current side
      type(cable_state_t), intent(out) :: cable
      real(wp) :: elongation
      real(wp) :: arm
      real(wp) :: arm_1

      call cable_elongation(law, phi, elongation, arm, arm_1)
      cable%force = bilinear_force(law%tendon, branch, elongation)
      cable%moment = cable%force*arm/law%R
      cable%moment_1 = (bilinear_tangent(law%tendon, branch)*arm**2 + cable%force*arm_1)/law%R
      cable%energy = bilinear_energy(law%tendon, branch, elongation)/law%R
   end subroutine spring_cable

end module rwmf_model_cable
