!> Elastic-plastic spring that remembers: linear kinematic hardening or softening, friction,
!> slackness, rupture.
!>
!> Its force depends on the elongation x and on what has happened to it: on the branch in force and
!> on the plastic elongation p. Within a branch the force is a smooth function of x; a branch ends
!> at a known elongation (`bilinear_limits`), or where the motion turns back (`turn_bilinear`).
!>
!>    elastic   F = F_0 + k (x - p)
!>    yielding  F = +-F_y + H p, with p following from x
!>    slack     F = 0, a tendon that is too long
!>    broken    F = 0 for good
!>
!> H < 0 is a spring that softens. Friction that holds more than it bears while it slips, with a
!> `breakaway` above 1, lets go at once: p grows by what the drop of the force sets free, and the
!> energy is lost. Numbers are in the caller's units, see `spring_t`.
module rwmf_model_hysteresis_bilinear
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_spring, only: branch_t, spring_t
   implicit none
   private

   public :: draw_line
   public :: bilinear_force, bilinear_tangent, bilinear_plastic, bilinear_residual
   public :: bilinear_energy, bilinear_loss
   public :: bilinear_limits, pass_bilinear, turn_bilinear, is_yielding, is_broken

   integer, parameter :: elastic = 0
   integer, parameter :: yields_up = 1
   integer, parameter :: yields_down = -1
   integer, parameter :: is_slack = 2
   integer, parameter :: broken = 3

contains

   !> Straight line of the branch that is in force.
   elemental subroutine draw_line(spring, branch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch

      branch%offset = bilinear_force(spring, branch, 0.0_wp)
      branch%slope = bilinear_tangent(spring, branch)
   end subroutine draw_line

   !> Force at the elongation x.
   elemental real(wp) function bilinear_force(spring, branch, x) result(force)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      select case (branch%kind)
      case (elastic)
         force = spring%force_0 + spring%stiffness*(x - branch%plastic)
      case (yields_up, yields_down)
         force = branch%kind*spring%yield + spring%modulus*bilinear_plastic(spring, branch, x)
      case default
         force = 0
      end select
   end function bilinear_force

   !> Its derivative by x.
   elemental real(wp) function bilinear_tangent(spring, branch) result(tangent)
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
   end function bilinear_tangent

   !> Plastic elongation at the elongation x: that part of it that unloading would leave.
   elemental real(wp) function bilinear_plastic(spring, branch, x) result(plastic)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      plastic = branch%plastic
      if (.not. is_yielding(branch)) return
      plastic = (spring%force_0 + spring%stiffness*x - branch%kind*spring%yield) &
         /(spring%stiffness + spring%modulus)
   end function bilinear_plastic

   !> Elongation at which a spring without prestress would have no force, unloaded slowly: its
   !> plastic part, but for much hardening, where it yields on the way back.
   elemental real(wp) function bilinear_residual(spring, plastic) result(residual)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: plastic
      !! part of its elongation

      residual = plastic
      if (spring%modulus*abs(plastic) > spring%yield) residual = sign(spring%yield/spring%modulus, &
         plastic)
   end function bilinear_residual

   !> Stored energy beyond that at x = 0 before any yielding: elastic part and hardening.
   elemental real(wp) function bilinear_energy(spring, branch, x) result(energy)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      real(wp) :: plastic
      real(wp) :: elastic_part
      !! of the elongation

      plastic = bilinear_plastic(spring, branch, x)
      elastic_part = x - plastic
      if (branch%kind == is_slack .or. branch%kind == broken) then
         elastic_part = -spring%force_0/spring%stiffness
      end if
      energy = elastic_part*(spring%force_0 + spring%stiffness*elastic_part/2)
      ! what has broken gives nothing back
      if (branch%kind /= broken) energy = energy + spring%modulus*plastic**2/2
   end function bilinear_energy

   !> Energy that plastic flow has taken up to the elongation x: F_y |dp|, summed over all branches.
   elemental real(wp) function bilinear_loss(spring, branch, x) result(loss)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      loss = branch%lost
      if (is_yielding(branch)) loss = loss + branch%kind*spring%yield*(bilinear_plastic(spring, &
         branch, x) - branch%plastic)
   end function bilinear_loss

   !> Elongations between which the branch in force holds.
   !>
   !> Yielding that begins within round-off of a turn would go on while the spring unloads: going
   !> back beyond the elongation at which it began ends it as well. Friction that let go is not held
   !> again by round-off.
   pure subroutine bilinear_limits(spring, branch, low, high)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(out) :: low
      !! or -huge where there is none
      real(wp), intent(out) :: high
      !! or huge where there is none
      real(wp) :: slack

      slack = 0
      if (spring%breakaway > 1) slack = 1.0e-10_wp*max(abs(branch%plastic), &
         spring%yield/spring%stiffness)
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
         low = first_yield(spring, branch, +1) - slack
         high = spring%rupture
      case (yields_down)
         high = first_yield(spring, branch, -1) + slack
      case (is_slack)
         high = branch%plastic - spring%force_0/spring%stiffness
      case default
         ! broken for good
      end select
   end subroutine bilinear_limits

   !> Elongation at which a spring begins to yield in one direction; friction that slips: at which
   !> it began to.
   pure real(wp) function first_yield(spring, branch, direction) result(x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      integer, intent(in) :: direction
      !! +1 or -1
      real(wp) :: strength

      x = direction*huge(x)
      strength = spring%yield
      if (strength >= huge(x)) return
      if (branch%kind == elastic) strength = spring%breakaway*strength
      x = branch%plastic + (direction*strength + spring%modulus*branch%plastic &
         - spring%force_0)/spring%stiffness
   end function first_yield

   !> The elongation passes a limit of the branch.
   pure subroutine pass_bilinear(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows
      type(branch_t) :: held
      real(wp) :: x
      !! where it happens

      held = branch
      select case (branch%kind)
      case (elastic)
         if (is_rising) then
            x = min(first_yield(spring, branch, +1), spring%rupture)
            branch%kind = merge(broken, yields_up, x >= spring%rupture)
         else
            x = first_yield(spring, branch, -1)
            branch%kind = merge(is_slack, yields_down, spring%is_tendon)
         end if
         if (spring%breakaway > 1 .or. branch%kind == broken) call let_go(spring, held, branch, x)
      case (yields_up)
         if (is_rising) then
            branch%lost = bilinear_loss(spring, branch, spring%rupture)
            branch%plastic = bilinear_plastic(spring, branch, spring%rupture)
            held = branch
            branch%kind = broken
            call let_go(spring, held, branch, spring%rupture)
         else
            branch%kind = elastic
         end if
      case (yields_down, is_slack)
         branch%kind = elastic
      case default
         ! no limits
      end select
      call draw_line(spring, branch)
   end subroutine pass_bilinear

   !> Friction lets go at the elongation x, and its force drops to that at which it slips; or what
   !> holds breaks. What this sets free is lost.
   pure subroutine let_go(spring, held, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: held
      !! the branch before
      type(branch_t), intent(inout) :: branch
      !! that of another kind which has begun
      real(wp), intent(in) :: x

      branch%lost = branch%lost + bilinear_energy(spring, held, x) - bilinear_energy(spring, &
         branch, x)
      branch%plastic = bilinear_plastic(spring, branch, x)
   end subroutine let_go

   !> The motion turns back at the elongation x: what yielded unloads elastically.
   pure subroutine turn_bilinear(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x

      if (.not. is_yielding(branch)) return
      branch%lost = bilinear_loss(spring, branch, x)
      branch%plastic = bilinear_plastic(spring, branch, x)
      branch%kind = elastic
      call draw_line(spring, branch)
   end subroutine turn_bilinear

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
