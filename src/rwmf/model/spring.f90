!> Spring with memory, for all laws: its parameters and its active branch.
!>
!> A branch is a straight line of force over elongation x. It ends at a known elongation. A branch
!> with a direction also ends where the motion reverses.
!>
!> Numbers are in the caller's units. Elongations are in m, forces over a mass [m/s2] or over the
!> weight of the wall [-], energies in the product of both.
module rwmf_model_spring
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: spring_t, branch_t, backbone_t, wear_t, worn_side_t
   public :: law_bilinear, law_flag, law_degrading
   public :: line_force, lay_line, work_along

   integer, parameter :: law_bilinear = 0
   integer, parameter :: law_flag = 1
   integer, parameter :: law_degrading = 2

   !> Envelope of a spring that loses strength, equal on both sides, and its wear parameters.
   type :: backbone_t
      real(wp) :: cap = huge(1.0_wp)
      !! elongation of the largest force
      real(wp) :: post_cap = huge(1.0_wp)
      !! elongation from the largest force to zero force on the falling line
      real(wp) :: residual = 0
      !! residual force
      real(wp) :: capacity(4) = huge(1.0_wp)
      !! energy capacities of the four modes of wear: strength, post-capping strength, reloading
      !! stiffness and unloading stiffness
      real(wp) :: exponents(4) = 1
      !! exponents of these four modes [-]
      logical :: is_pinched = .false.
      real(wp) :: pinch(2) = 1
      !! kappa_F, the force at the pinching point over that on the straight line to the peak.
      !! kappa_D, the part of the plastic elongation that remains before this point [-]
   end type backbone_t

   !> Parameters of a spring, in the caller's units.
   type :: spring_t
      integer :: law = law_bilinear
      !! one of the `law_` numbers
      real(wp) :: stiffness = 1
      !! elastic stiffness, k
      real(wp) :: force_0 = 0
      !! force at x = 0 before any yielding, F_0
      real(wp) :: yield = huge(1.0_wp)
      !! magnitude of the force at first yield, F_y
      real(wp) :: hardening = 0
      !! stiffness after yielding over elastic stiffness [-]
      real(wp) :: modulus = 0
      !! plastic modulus H = dF_y/dp
      real(wp) :: rupture = huge(1.0_wp)
      !! elongation at rupture
      logical :: is_tendon = .false.
      !! true if it bears tension only
      real(wp) :: breakaway = 1
      !! force at which it begins to slip over that at which it continues to slip [-]
      real(wp) :: flag_height = 1
      !! drop of a flag's unloading force over F_y [-]
      type(backbone_t) :: backbone
      !! envelope of a spring that loses strength
   end type spring_t

   !> Worn envelope of one side of a spring; elongations and forces are positive on that side.
   type :: worn_side_t
      real(wp) :: yield = 0
      !! force at first yield
      real(wp) :: slope = 0
      !! slope of the line from first yield to the capping point
      real(wp) :: falling = 0
      !! force at x = 0 of the falling line beyond the capping point
      real(wp) :: peak(2) = 0
      !! elongation and force at which reloading reaches the envelope
      real(wp) :: last(2) = 0
      !! elongation and force of the last reversal
   end type worn_side_t

   !> Wear of a spring that loses strength.
   type :: wear_t
      type(worn_side_t) :: sides(-1:1)
      !! sides x < 0 (number -1) and x > 0 (number 1)
      real(wp) :: unloading = 1
      !! unloading stiffness
      real(wp) :: pinch(2) = 0
      !! elongation and force of the pinching point, positive on the current side
      real(wp) :: spent = 0
      !! energy of all completed excursions
      real(wp) :: counted = 0
      !! part of the branch's lost energy that belongs to completed excursions
   end type wear_t

   !> Active branch of a spring.
   type :: branch_t
      integer :: kind = 0
      !! kind of branch of its law; 0 before any event
      real(wp) :: plastic = 0
      !! plastic elongation p at its beginning, bilinear only
      real(wp) :: lost = 0
      !! energy dissipated before its beginning
      real(wp) :: offset = 0
      !! force at zero elongation of its straight line
      real(wp) :: slope = 0
      !! slope of its straight line
      integer :: direction = 0
      !! sign that x' keeps on it; 0: either. Bilinear springs do not use this and the following
      real(wp) :: begin = 0
      !! elongation at its beginning
      real(wp) :: low = -huge(1.0_wp)
      !! lower limit of its elongation
      real(wp) :: high = huge(1.0_wp)
      !! upper limit of its elongation
      integer :: side = 1
      !! sign of the elongations of its side
      type(wear_t) :: wear
      !! wear of a spring that loses strength
   end type branch_t

contains

   !> Force on the straight line of a branch.
   elemental real(wp) function line_force(branch, x) result(force)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! elongation

      force = branch%offset + branch%slope*x
   end function line_force

   !> Begin a branch on the straight line through a point.
   pure subroutine lay_line(branch, kind, direction, x, force, slope)
      type(branch_t), intent(inout) :: branch
      integer, intent(in) :: kind
      !! kind of branch of the law
      integer, intent(in) :: direction
      !! sign that x' keeps on it; 0: either
      real(wp), intent(in) :: x
      !! elongation at its beginning
      real(wp), intent(in) :: force
      real(wp), intent(in) :: slope

      branch%kind = kind
      branch%direction = direction
      branch%begin = x
      branch%offset = force - slope*x
      branch%slope = slope
      ! a reversal within round-off of the beginning is located at the beginning
      branch%low = merge(x, -huge(x), direction > 0)
      branch%high = merge(x, huge(x), direction < 0)
   end subroutine lay_line

   !> Work done on the spring since the beginning of the branch.
   elemental real(wp) function work_along(branch, x) result(work)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! elongation

      work = (line_force(branch, branch%begin) + line_force(branch, x))/2*(x - branch%begin)
   end function work_along

end module rwmf_model_spring
