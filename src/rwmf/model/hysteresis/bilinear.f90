!> Elastic-plastic spring that remembers: linear kinematic hardening, slackness, rupture.
!>
!> Its force depends on the elongation x and on what has happened to it: on the branch in force and
!> on the plastic elongation p. Within a branch the force is a smooth function of x; a branch ends
!> at a known elongation (`spring_limits`), or where the motion turns back (`turn_spring`).
!>
!>    elastic   F = F_0 + k (x - p)
!>    yielding  F = +-F_y + H p, with p following from x
!>    slack     F = 0, a tendon that is too long
!>    broken    F = 0 for good
!>
!> Numbers are in the caller's units: elongations in m, forces over a mass [m/s2] or over the weight
!> of the wall [-], energies in the product of both.
module rwmf_model_hysteresis_bilinear
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: spring_t, branch_t, new_spring, new_branch
   public :: spring_force, spring_tangent, spring_plastic, spring_residual
   public :: spring_energy, spring_loss, forget_loss
   public :: spring_limits, pass_limit, turn_spring, yield_direction, is_yielding, is_broken

   integer, parameter :: elastic = 0
   integer, parameter :: yields_up = 1
   integer, parameter :: yields_down = -1
   integer, parameter :: slack = 2
   integer, parameter :: broken = 3

   !> Parameters; units are those of the one who uses it.
   type :: spring_t
      private
      real(wp) :: stiffness = 1
      !! elastic, k
      real(wp) :: force_0 = 0
      !! at x = 0 before any yielding, F_0
      real(wp) :: yield = huge(1.0_wp)
      !! magnitude of the force at which it yields first, F_y
      real(wp) :: modulus = 0
      !! plastic modulus H = dF_y/dp
      real(wp) :: rupture = huge(1.0_wp)
      !! elongation at which it breaks
      logical :: is_tendon = .false.
      !! bears tension only
   end type spring_t

   !> Branch that is in force.
   type :: branch_t
      integer, private :: kind = elastic
      real(wp), private :: plastic = 0
      !! plastic elongation p when it began
      real(wp), private :: lost = 0
      !! energy that plastic flow has taken before it began
      real(wp) :: offset = 0
      !! force at the elongation zero: a branch is a straight line
      real(wp) :: slope = 0
      !! and its derivative
   end type branch_t

contains

   !> A spring that has not moved yet.
   elemental type(spring_t) function new_spring(stiffness, yield, hardening, force_0, is_tendon, &
      rupture) result(spring)
      real(wp), intent(in) :: stiffness
      !! > 0
      real(wp), intent(in) :: yield
      !! > 0
      real(wp), intent(in) :: hardening
      !! stiffness after yielding over elastic stiffness, in [0, 1)
      real(wp), intent(in), optional :: force_0
      !! force at x = 0, below `yield`; 0
      logical, intent(in), optional :: is_tendon
      !! bears tension only; no
      real(wp), intent(in), optional :: rupture
      !! elongation at which it breaks; never

      spring%stiffness = stiffness
      spring%yield = yield
      spring%modulus = hardening*stiffness/(1 - hardening)
      if (present(force_0)) spring%force_0 = force_0
      if (present(is_tendon)) spring%is_tendon = is_tendon
      if (present(rupture)) spring%rupture = rupture
   end function new_spring

   !> Branch of a spring to which nothing has happened yet.
   elemental type(branch_t) function new_branch(spring) result(branch)
      type(spring_t), intent(in) :: spring

      call draw_line(spring, branch)
   end function new_branch

   !> Straight line of the branch that is in force.
   elemental subroutine draw_line(spring, branch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch

      branch%offset = spring_force(spring, branch, 0.0_wp)
      branch%slope = spring_tangent(spring, branch)
   end subroutine draw_line

   !> Force at the elongation x.
   elemental real(wp) function spring_force(spring, branch, x) result(force)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      select case (branch%kind)
      case (elastic)
         force = spring%force_0 + spring%stiffness*(x - branch%plastic)
      case (yields_up, yields_down)
         force = branch%kind*spring%yield + spring%modulus*spring_plastic(spring, branch, x)
      case default
         force = 0
      end select
   end function spring_force

   !> Its derivative by x.
   elemental real(wp) function spring_tangent(spring, branch) result(tangent)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch

      select case (branch%kind)
      case (elastic)
         tangent = spring%stiffness
      case (yields_up, yields_down)
         tangent = spring%stiffness*spring%modulus/(spring%stiffness + spring%modulus)
      case default
         tangent = 0
      end select
   end function spring_tangent

   !> Plastic elongation at the elongation x: that part of it that unloading would leave.
   elemental real(wp) function spring_plastic(spring, branch, x) result(plastic)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      plastic = branch%plastic
      if (.not. is_yielding(branch)) return
      plastic = (spring%force_0 + spring%stiffness*x - branch%kind*spring%yield) &
         /(spring%stiffness + spring%modulus)
   end function spring_plastic

   !> Elongation at which a spring without prestress would have no force, unloaded slowly: its
   !> plastic part, but for much hardening, where it yields on the way back.
   elemental real(wp) function spring_residual(spring, plastic) result(residual)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: plastic
      !! part of its elongation

      residual = plastic
      if (spring%modulus*abs(plastic) > spring%yield) residual = sign(spring%yield/spring%modulus, &
         plastic)
   end function spring_residual

   !> Stored energy beyond that at x = 0 before any yielding: elastic part and hardening.
   elemental real(wp) function spring_energy(spring, branch, x) result(energy)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      real(wp) :: plastic
      real(wp) :: elastic_part
      !! of the elongation

      plastic = spring_plastic(spring, branch, x)
      elastic_part = x - plastic
      if (branch%kind == slack .or. branch%kind == broken) then
         elastic_part = -spring%force_0/spring%stiffness
      end if
      energy = elastic_part*(spring%force_0 + spring%stiffness*elastic_part/2)
      ! what has broken gives nothing back
      if (branch%kind /= broken) energy = energy + spring%modulus*plastic**2/2
   end function spring_energy

   !> Energy that plastic flow has taken up to the elongation x: F_y |dp|, summed over all branches.
   elemental real(wp) function spring_loss(spring, branch, x) result(loss)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      loss = branch%lost
      if (is_yielding(branch)) loss = loss + branch%kind*spring%yield*(spring_plastic(spring, &
         branch, x) - branch%plastic)
   end function spring_loss

   !> Count what plastic flow takes from here on.
   elemental subroutine forget_loss(branch)
      type(branch_t), intent(inout) :: branch
      !! that does not yield

      branch%lost = 0
   end subroutine forget_loss

   !> Elongations between which the branch in force holds.
   !>
   !> Yielding that begins within round-off of a turn would go on while the spring unloads: going
   !> back beyond the elongation at which it began ends it as well.
   pure subroutine spring_limits(spring, branch, low, high)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(out) :: low
      !! or -huge where there is none
      real(wp), intent(out) :: high
      !! or huge where there is none

      low = -huge(low)
      high = huge(high)
      select case (branch%kind)
      case (elastic)
         high = min(first_yield(spring, branch, +1), spring%rupture)
         if (spring%is_tendon) then
            low = branch%plastic - spring%force_0/spring%stiffness
         else
            low = first_yield(spring, branch, -1)
         end if
      case (yields_up)
         low = first_yield(spring, branch, +1)
         high = spring%rupture
      case (yields_down)
         high = first_yield(spring, branch, -1)
      case (slack)
         high = branch%plastic - spring%force_0/spring%stiffness
      case default
         ! broken for good
      end select
   end subroutine spring_limits

   !> Elongation at which an elastic spring begins to yield in one direction.
   pure real(wp) function first_yield(spring, branch, direction) result(x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      integer, intent(in) :: direction
      !! +1 or -1

      x = direction*huge(x)
      if (spring%yield >= huge(x)) return
      x = branch%plastic + (direction*spring%yield + spring%modulus*branch%plastic &
         - spring%force_0)/spring%stiffness
   end function first_yield

   !> The elongation passes a limit of the branch.
   pure subroutine pass_limit(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows
      real(wp) :: x
      !! where it happens

      select case (branch%kind)
      case (elastic)
         x = min(first_yield(spring, branch, +1), spring%rupture)
         if (is_rising) then
            branch%kind = merge(broken, yields_up, x >= spring%rupture)
         else
            branch%kind = merge(slack, yields_down, spring%is_tendon)
         end if
      case (yields_up)
         if (is_rising) then
            branch%lost = spring_loss(spring, branch, spring%rupture)
            branch%plastic = spring_plastic(spring, branch, spring%rupture)
            branch%kind = broken
         else
            branch%kind = elastic
         end if
      case (yields_down, slack)
         branch%kind = elastic
      case default
         ! no limits
      end select
      call draw_line(spring, branch)
   end subroutine pass_limit

   !> The motion turns back at the elongation x: what yielded unloads elastically.
   pure subroutine turn_spring(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x

      if (.not. is_yielding(branch)) return
      branch%lost = spring_loss(spring, branch, x)
      branch%plastic = spring_plastic(spring, branch, x)
      branch%kind = elastic
      call draw_line(spring, branch)
   end subroutine turn_spring

   !> Direction in which a spring yields, +1 or -1; 0 on other branches.
   elemental integer function yield_direction(branch)
      type(branch_t), intent(in) :: branch

      yield_direction = 0
      if (is_yielding(branch)) yield_direction = branch%kind
   end function yield_direction

   !> Does it follow a line of yielding?
   elemental logical function is_yielding(branch)
      type(branch_t), intent(in) :: branch

      is_yielding = abs(branch%kind) == yields_up
   end function is_yielding

   !> Has it broken?
   pure logical function is_broken(branch)
      type(branch_t), intent(in) :: branch

      is_broken = branch%kind == broken
   end function is_broken

end module rwmf_model_hysteresis_bilinear
