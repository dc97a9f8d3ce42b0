!> Elastic-plastic spring with memory: linear kinematic hardening or softening, friction,
!> slackness, rupture.
!>
!> Its force depends on the elongation x, on the active branch and on the plastic elongation p.
!> Within a branch the force is a smooth function of x. A branch ends at a known elongation
!> (`bilinear_limits`) or where the motion reverses (`turn_bilinear`).
!>
!>    elastic   F = F_0 + k (x - p)
!>    yielding  F = +-F_y + H p, with p following from x
!>    slack     F = 0, a tendon that plastic elongation has slackened
!>    broken    F = 0 permanently
!>
!> A spring with H < 0 softens. A friction spring with `breakaway` above 1 sticks with a larger
!> force than it slips with. When it begins to slip, the force drops, p grows accordingly and the
!> released energy is dissipated. Numbers are in the caller's units, see `spring_t`.
module rwmf_model_bilinear_spring
   use rwmf_core_kinds, only: wp
   use rwmf_model_spring, only: branch_t, spring_t
   implicit none
   private

   public :: draw_line
   public :: bilinear_force, bilinear_tangent, bilinear_plastic, bilinear_residual
   public :: bilinear_energy, bilinear_loss
   public :: bilinear_limits, pass_bilinear, turn_bilinear, is_yielding, is_broken
   public :: bilinear_word

   integer, parameter :: elastic = 0
   integer, parameter :: yields_up = 1
   integer, parameter :: yields_down = -1
   integer, parameter :: is_slack = 2
   integer, parameter :: broken = 3

contains

   !> Compute the straight line of the active branch.
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

   !> Derivative of the force by x.
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

   !> Plastic elongation at the elongation x, which remains after elastic unloading.
   elemental real(wp) function bilinear_plastic(spring, branch, x) result(plastic)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      plastic = branch%plastic
      if (.not. is_yielding(branch)) return
      plastic = (spring%force_0 + spring%stiffness*x - branch%kind*spring%yield) &
         /(spring%stiffness + spring%modulus)
   end function bilinear_plastic

   !> Elongation of zero force after slow unloading of a spring without prestress. This is its
   !> plastic part, unless hardening is so large that the spring yields during unloading.
   elemental real(wp) function bilinear_residual(spring, plastic) result(residual)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: plastic
      !! plastic part of the elongation

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
      !! elastic part of the elongation

      plastic = bilinear_plastic(spring, branch, x)
      elastic_part = x - plastic
      if (branch%kind == is_slack .or. branch%kind == broken) then
         elastic_part = -spring%force_0/spring%stiffness
      end if
      energy = elastic_part*(spring%force_0 + spring%stiffness*elastic_part/2)
      ! a broken spring returns no energy
      if (branch%kind /= broken) energy = energy + spring%modulus*plastic**2/2
   end function bilinear_energy

   !> Energy dissipated by plastic flow up to the elongation x: F_y |dp|, summed over all branches.
   elemental real(wp) function bilinear_loss(spring, branch, x) result(loss)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      loss = branch%lost
      if (is_yielding(branch)) loss = loss + branch%kind*spring%yield*(bilinear_plastic(spring, &
         branch, x) - branch%plastic)
   end function bilinear_loss

   !> Elongations between which the active branch is valid.
   !>
   !> If yielding begins within round-off of a reversal, the spring could keep yielding while it
   !> unloads. So the branch also ends where x returns below the elongation at which it began. For
   !> friction the limit has a margin, so that round-off does not make a slipping spring stick
   !> again.
   pure subroutine bilinear_limits(spring, branch, low, high)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(out) :: low
      !! -huge if there is no lower limit
      real(wp), intent(out) :: high
      !! huge if there is no upper limit
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
         ! a broken spring has no limits
      end select
   end subroutine bilinear_limits

   !> Elongation at which a spring begins to yield in one direction; for slipping friction, the
   !> elongation at which it began to slip.
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

   !> Begin the next branch where the elongation passes a limit of the active branch.
   pure subroutine pass_bilinear(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows
      type(branch_t) :: held
      real(wp) :: x
      !! elongation at the limit

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
         ! this branch has no limits
      end select
      call draw_line(spring, branch)
   end subroutine pass_bilinear

   !> Release the stored energy when friction begins to slip or the spring breaks at the elongation
   !> x. The energy released by the drop of the force is dissipated.
   pure subroutine let_go(spring, held, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: held
      !! branch before the event
      type(branch_t), intent(inout) :: branch
      !! branch after the event, whose kind is set
      real(wp), intent(in) :: x

      branch%lost = branch%lost + bilinear_energy(spring, held, x) - bilinear_energy(spring, &
         branch, x)
      branch%plastic = bilinear_plastic(spring, branch, x)
   end subroutine let_go

   !> Reverse the motion at the elongation x: a yielding spring begins to unload elastically.
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

   !> Return whether a branch is a yielding one.
   elemental logical function is_yielding(branch)
      type(branch_t), intent(in) :: branch

      is_yielding = abs(branch%kind) == yields_up
   end function is_yielding

   !> Return whether the spring has broken.
   elemental logical function is_broken(branch)
      type(branch_t), intent(in) :: branch

      is_broken = branch%kind == broken
   end function is_broken

   !> Name of the active branch: 'yield', 'slack', 'rupture', or '' while elastic.
   pure function bilinear_word(branch) result(word)
      type(branch_t), intent(in) :: branch
      character(8) :: word

      word = ''
      if (is_yielding(branch)) word = 'yield'
      if (branch%kind == is_slack) word = 'slack'
      if (branch%kind == broken) word = 'rupture'
   end function bilinear_word

end module rwmf_model_bilinear_spring
