!> What a spring with memory is, whatever its law: its parameters, and the branch that is in force.
!>
!> A branch is a straight line of force over elongation x. It ends at a known elongation, or, if it
!> has a direction, where the motion turns back.
!>
!> Numbers are in the caller's units: elongations in m, forces over a mass [m/s2] or over the weight
!> of the wall [-], energies in the product of both.
module rwmf_model_hysteresis_spring
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: spring_t, branch_t, backbone_t, wear_t, worn_side_t
   public :: law_bilinear, law_flag, law_degrading
   public :: line_force, lay_line, work_along

   integer, parameter :: law_bilinear = 0
   integer, parameter :: law_flag = 1
   integer, parameter :: law_degrading = 2

   !> Envelope of a spring that loses strength, to both sides alike, and how it wears.
   type :: backbone_t
      real(wp) :: cap = huge(1.0_wp)
      !! elongation at which its force is largest
      real(wp) :: post_cap = huge(1.0_wp)
      !! elongation from there to where it would have no force
      real(wp) :: residual = 0
      !! force that remains
      real(wp) :: capacity(4) = huge(1.0_wp)
      !! energies that take the strength, the strength after capping, the stiffness of reloading and
      !! that of unloading
      real(wp) :: exponents(4) = 1
      !! of these four [-]
      logical :: is_pinched = .false.
      real(wp) :: pinch(2) = 1
      !! force at the pinching point over that on the straight way to the peak, kappa_F, and the
      !! part of the plastic elongation that is still left before it, kappa_D [-]
   end type backbone_t

   !> Parameters; units are those of the one who uses it.
   type :: spring_t
      integer :: law = law_bilinear
      !! one of the `law_` numbers
      real(wp) :: stiffness = 1
      !! elastic, k
      real(wp) :: force_0 = 0
      !! at x = 0 before any yielding, F_0
      real(wp) :: yield = huge(1.0_wp)
      !! magnitude of the force at which it yields first, F_y
      real(wp) :: hardening = 0
      !! stiffness after yielding over elastic stiffness [-]
      real(wp) :: modulus = 0
      !! plastic modulus H = dF_y/dp
      real(wp) :: rupture = huge(1.0_wp)
      !! elongation at which it breaks
      logical :: is_tendon = .false.
      !! bears tension only
      real(wp) :: breakaway = 1
      !! force that makes it slip over that at which it slips on [-]
      real(wp) :: flag_height = 1
      !! force by which a flag unloads lower, over F_y [-]
      type(backbone_t) :: backbone
      !! of a spring that loses strength
   end type spring_t

   !> What wear has left of one side of a spring; elongations and forces positive on that side.
   type :: worn_side_t
      real(wp) :: yield = 0
      !! force at first yield
      real(wp) :: slope = 0
      !! of the line from there to the capping point
      real(wp) :: falling = 0
      !! force at x = 0 of the line beyond it
      real(wp) :: peak(2) = 0
      !! elongation and force at which reloading comes back to the envelope
      real(wp) :: last(2) = 0
      !! elongation and force where it has turned last
   end type worn_side_t

   !> What wear has left of a spring that loses strength.
   type :: wear_t
      type(worn_side_t) :: sides(-1:1)
      !! x < 0 and, with number 1, x > 0
      real(wp) :: unloading = 1
      !! stiffness
      real(wp) :: pinch(2) = 0
      !! elongation and force of the pinching point, positive on the side in force
      real(wp) :: spent = 0
      !! energy of all excursions that have ended
      real(wp) :: counted = 0
      !! of the loss, what belongs to them
   end type wear_t

   !> Branch that is in force.
   type :: branch_t
      integer :: kind = 0
      !! of its law; 0 before anything happens
      real(wp) :: plastic = 0
      !! plastic elongation p when it began, bilinear only
      real(wp) :: lost = 0
      !! energy that it has taken before it began
      real(wp) :: offset = 0
      !! force at the elongation zero: a branch is a straight line
      real(wp) :: slope = 0
      !! and its derivative
      integer :: direction = 0
      !! sign that x' keeps on it; 0: either. This and the following are of all laws but bilinear
      real(wp) :: begin = 0
      !! elongation at which it began
      real(wp) :: low = -huge(1.0_wp)
      !! elongation down to which it holds
      real(wp) :: high = huge(1.0_wp)
      !! and up to which it does
      integer :: side = 1
      !! sign of the elongations that it leads to, or comes from
      type(wear_t) :: wear
      !! of a spring that loses strength
   end type branch_t

contains

   !> Force on the straight line of a branch.
   elemental real(wp) function line_force(branch, x) result(force)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! elongation

      force = branch%offset + branch%slope*x
   end function line_force

   !> Begin a branch on the line through a point.
   pure subroutine lay_line(branch, kind, direction, x, force, slope)
      type(branch_t), intent(inout) :: branch
      integer, intent(in) :: kind
      !! of the law
      integer, intent(in) :: direction
      !! sign that x' keeps on it; 0: either
      real(wp), intent(in) :: x
      !! where it begins
      real(wp), intent(in) :: force
      real(wp), intent(in) :: slope

      branch%kind = kind
      branch%direction = direction
      branch%begin = x
      branch%offset = force - slope*x
      branch%slope = slope
      ! a direction that is lost within round-off of the beginning is lost there
      branch%low = merge(x, -huge(x), direction > 0)
      branch%high = merge(x, huge(x), direction < 0)
   end subroutine lay_line

   !> Work that the elongation has done on a branch since it began.
   elemental real(wp) function work_along(branch, x) result(work)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! elongation

      work = (line_force(branch, branch%begin) + line_force(branch, x))/2*(x - branch%begin)
   end function work_along

end module rwmf_model_hysteresis_spring
