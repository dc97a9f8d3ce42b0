!> A spring that loses strength and stiffness: the modified model of Ibarra, Medina and Krawinkler,
!> peak-oriented or pinched.
!>
!> Envelope, to both sides: slope k up to F_y, `hardening` k up to the capping point, down from
!> there to the residual force. What unloads does so with the stiffness of unloading to zero force,
!> and begins an excursion to the other side there: straight to the peak beyond which it is on the
!> envelope again, by way of the last turn where that way is stiffer and lower; pinched, first to
!> the pinching point. Each excursion and each turn wears the spring by
!>
!>    beta = (E_i/(E_t - sum E_j))**c
!>
!> with the energy E_i of the excursion, the capacity E_t and those of all so far, this one
!> included: strength and hardening by (1 - beta_s), the line beyond the capping point by
!> (1 - beta_c), the peak moves out by (1 + beta_a), and at a turn the stiffness of unloading falls
!> by (1 - beta_k). Where an excursion takes more than is left of a capacity the spring breaks.
!>
!> L. F. Ibarra, R. A. Medina and H. Krawinkler, Earthquake Engng Struct. Dyn. 34 (2005) 1489-1511;
!> D. G. Lignos and H. Krawinkler, J. Struct. Eng. 137 (2011) 1291-1302. Where the papers leave the
!> order of things open it is that of `IMKPeakOriented` and `IMKPinching` of OpenSees (2023).
!> Numbers are in the caller's units, see `spring_t`.
module rwmf_model_hysteresis_degrading
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_spring, only: branch_t, lay_line, line_force, spring_t, wear_t, &
      work_along, worn_side_t
   implicit none
   private

   public :: start_degrading, pass_degrading, turn_degrading, degrading_energy, degrading_loss
   public :: unloaded_elongation

   integer, parameter :: unyielded = 0
   integer, parameter :: unloading = 1
   integer, parameter :: to_pinch = 2
   integer, parameter :: to_last = 3
   integer, parameter :: to_peak = 4
   integer, parameter :: hardens = 5
   integer, parameter :: softens = 6
   integer, parameter :: remains = 7
   integer, parameter :: broken = 8

contains

   !> Branch of a spring to which nothing has happened yet.
   pure subroutine start_degrading(spring, branch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      type(worn_side_t) :: side

      associate (k => spring%stiffness, u_y => spring%yield/spring%stiffness)
         call lay_line(branch, unyielded, 0, 0.0_wp, 0.0_wp, k)
         branch%low = -u_y
         branch%high = u_y
         side%yield = spring%yield
         side%slope = spring%hardening*k
         side%falling = capping_force(spring) + softening(spring)*spring%backbone%cap
         side%peak = [u_y, spring%yield]
         side%last = side%peak
         branch%wear = wear_t(sides=[side, side, side], unloading=k)
      end associate
   end subroutine start_degrading

   !> The elongation passes a limit of the branch.
   pure subroutine pass_degrading(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows
      real(wp) :: x
      integer :: sense
      !! of the motion

      sense = merge(1, -1, is_rising)
      x = merge(branch%high, branch%low, is_rising)
      if (branch%direction == -sense) then
         call turn_degrading(spring, branch, x)
         return
      end if
      branch%lost = degrading_loss(branch, x)
      if (branch%kind == unyielded) then
         branch%side = sense
         call follow(spring, branch, x, hardens)
      else if (branch%kind /= unloading) then
         call follow(spring, branch, x, merge(after_pinch(branch), branch%kind + 1, &
            branch%kind == to_pinch))
      else if (sense == branch%side) then
         call follow(spring, branch, x, after_turn(spring, branch))
      else
         call begin_excursion(spring, branch, sense, x)
      end if
   end subroutine pass_degrading

   !> The motion turns back at the elongation x: the spring unloads, less stiff than before.
   pure subroutine turn_degrading(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp) :: point(2)
      real(wp) :: wear

      if (branch%direction == 0) return
      branch%lost = degrading_loss(branch, x)
      point = branch%side*[x, line_force(branch, x)]
      if (point(2) <= 0) then
         call begin_excursion(spring, branch, -branch%side, x)
         return
      end if
      associate (worn => branch%wear, side => branch%wear%sides(branch%side))
         side%last = point
         if (point(1) > side%peak(1)) side%peak = point
         wear = part_lost(spring, branch, 4)
         if (wear > 1) then
            call break_down(branch, x)
            return
         end if
         branch%lost = branch%lost + stored(branch, point(2))
         worn%unloading = worn%unloading*(1 - wear)
         branch%lost = branch%lost - stored(branch, point(2))
         call unload(spring, branch, x, point(2))
      end associate
   end subroutine turn_degrading

   !> Unload from a point to where the force is zero.
   pure subroutine unload(spring, branch, x, force)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp), intent(in) :: force
      !! on the side in force
      real(wp) :: limits(2)

      call lay_line(branch, unloading, 0, x, branch%side*force, branch%wear%unloading)
      limits = x + branch%side*[-force/branch%wear%unloading, slack(spring, x)]
      branch%low = minval(limits)
      branch%high = maxval(limits)
   end subroutine unload

   !> The force passes zero: what the excursion that ends here has taken wears the side to which the
   !> next one goes.
   pure subroutine begin_excursion(spring, branch, side, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      integer, intent(in) :: side
      !! of the new excursion
      real(wp), intent(in) :: x
      real(wp) :: wear(3)
      integer :: i

      wear = [(part_lost(spring, branch, i), i=1, 3)]
      branch%side = side
      associate (worn => branch%wear%sides(side))
         branch%wear%spent = branch%wear%spent + max(0.0_wp, branch%lost - branch%wear%counted)
         branch%wear%counted = branch%lost
         worn%yield = worn%yield*(1 - wear(1))
         worn%slope = worn%slope*(1 - wear(1))
         worn%falling = worn%falling*(1 - wear(2))
         worn%peak(1) = worn%peak(1)*(1 + wear(3))
         worn%peak(2) = envelope(spring, worn, worn%peak(1))
         if (any(wear > 1) .or. worn%peak(2) <= 0) then
            call break_down(branch, x)
            return
         end if
         call lay_line(branch, unyielded, 0, x, 0.0_wp, branch%wear%unloading)
         branch%wear%pinch = pinching_point(spring, branch, side*x)
         if (spring%backbone%is_pinched .and. side*x < branch%wear%pinch(1)) then
            call follow(spring, branch, x, to_pinch)
         else
            call follow(spring, branch, x, stiffer(worn, side*x, 0.0_wp))
         end if
      end associate
   end subroutine begin_excursion

   !> Part that one of the four modes of wear takes now, by the energy since the last excursion
   !> began; above 1 where that is more than is left of its capacity.
   pure real(wp) function part_lost(spring, branch, mode) result(part)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      integer, intent(in) :: mode
      !! place in `capacity`
      real(wp) :: energy, left

      part = 0
      associate (capacity => spring%backbone%capacity(mode))
         energy = branch%lost - branch%wear%counted
         if (capacity >= huge(part) .or. energy <= 0) return
         left = capacity - branch%wear%spent - energy
         part = 2
         if (left >= energy) part = (energy/left)**spring%backbone%exponents(mode)
      end associate
   end function part_lost

   !> Follow a branch outward from the elongation x, or that after it where nothing is left of it.
   pure subroutine follow(spring, branch, x, first)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      integer, intent(in) :: first
      !! kind of the branch
      real(wp) :: start(2), goal(2), slope
      integer :: kind

      associate (side => branch%side, worn => branch%wear%sides(branch%side))
         start = side*[x, line_force(branch, x)]
         kind = first
         do
            goal = goal_of(spring, branch, worn, kind)
            if (goal(1) > start(1) + slack(spring, x)) exit
            kind = merge(after_pinch(branch), kind + 1, kind == to_pinch)
         end do
         if (kind == remains .and. .not. goal(2) > 0) then
            call break_down(branch, x)
            return
         end if
         slope = 0
         if (kind < remains) slope = (goal(2) - start(2))/(goal(1) - start(1))
         if (kind >= hardens) start(2) = envelope(spring, worn, start(1))
         if (kind == hardens) slope = worn%slope
         if (kind == softens) slope = -softening(spring)
         call lay_line(branch, kind, side, x, side*start(2), slope)
         if (side > 0) then
            branch%low = x - slack(spring, x)
            branch%high = goal(1)
         else
            branch%low = -goal(1)
            branch%high = x + slack(spring, x)
         end if
      end associate
   end subroutine follow

   !> How far beyond a turn, or behind the beginning of a branch, the spring is still there: a turn
   !> that round-off makes of the state at either would wear it.
   pure real(wp) function slack(spring, x)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: x

      slack = 1.0e-10_wp*max(abs(x), spring%yield/spring%stiffness)
   end function slack

   !> Elongation and force at which a branch ends on the side in force.
   pure function goal_of(spring, branch, worn, kind) result(goal)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      type(worn_side_t), intent(in) :: worn
      !! the side
      integer, intent(in) :: kind
      !! of the branch
      real(wp) :: goal(2)

      select case (kind)
      case (to_pinch)
         goal = branch%wear%pinch
      case (to_last)
         goal = worn%last
      case (to_peak)
         goal = worn%peak
      case (hardens)
         goal(1) = capping_point(spring, worn)
         goal(2) = envelope(spring, worn, goal(1))
      case (softens)
         goal = [(worn%falling - spring%backbone%residual)/softening(spring), &
            spring%backbone%residual]
      case default
         goal = [huge(1.0_wp), spring%backbone%residual]
      end select
   end function goal_of

   !> Where the way to the peak goes first from a point: to the last turn where this is lower than
   !> the peak, and the way there stiffer.
   pure integer function stiffer(worn, x, force) result(kind)
      type(worn_side_t), intent(in) :: worn
      real(wp), intent(in) :: x
      !! on the side in force
      real(wp), intent(in) :: force
      !! on the side in force

      kind = to_peak
      if (worn%last(1) <= x .or. worn%last(2) <= force .or. worn%last(2) >= worn%peak(2)) return
      if ((worn%last(2) - force)*(worn%peak(1) - x) > (worn%peak(2) - force) &
          *(worn%last(1) - x)) kind = to_last
   end function stiffer

   !> The branch beyond the pinching point.
   pure integer function after_pinch(branch) result(kind)
      type(branch_t), intent(in) :: branch

      kind = stiffer(branch%wear%sides(branch%side), branch%wear%pinch(1), &
         branch%wear%pinch(2))
   end function after_pinch

   !> The branch by which a spring that has unloaded only in part goes on beyond its last turn: by
   !> the pinching point where that is ahead and the way to it less stiff, else to the peak.
   pure integer function after_turn(spring, branch) result(kind)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch

      kind = to_peak
      if (.not. spring%backbone%is_pinched) return
      associate (worn => branch%wear%sides(branch%side), pinch => branch%wear%pinch)
         if (any(worn%last >= pinch) .or. any(pinch >= worn%peak)) return
         if ((pinch(2) - worn%last(2))*(worn%peak(1) - worn%last(1)) &
             < (worn%peak(2) - worn%last(2))*(pinch(1) - worn%last(1))) kind = to_pinch
      end associate
   end function after_turn

   !> Elongation and force of the pinching point of an excursion that begins at an elongation.
   pure function pinching_point(spring, branch, x) result(pinch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! on the side in force
      real(wp) :: pinch(2)

      pinch = 0
      if (.not. spring%backbone%is_pinched) return
      associate (peak => branch%wear%sides(branch%side)%peak)
         pinch(1) = (1 - spring%backbone%pinch(2))*(peak(1) - peak(2)/branch%wear%unloading)
         pinch(2) = spring%backbone%pinch(1)*peak(2)*(pinch(1) - x)/(peak(1) - x)
      end associate
   end function pinching_point

   !> Force on the envelope at an elongation.
   pure real(wp) function envelope(spring, worn, x) result(force)
      type(spring_t), intent(in) :: spring
      type(worn_side_t), intent(in) :: worn
      real(wp), intent(in) :: x
      !! positive on the side

      if (x < worn%yield/spring%stiffness) then
         force = spring%stiffness*x
      else if (x < capping_point(spring, worn)) then
         force = worn%yield + worn%slope*(x - worn%yield/spring%stiffness)
      else
         force = worn%falling - softening(spring)*x
      end if
      force = max(force, spring%backbone%residual)
   end function envelope

   !> Elongation at which the worn envelope turns down.
   pure real(wp) function capping_point(spring, worn) result(x)
      type(spring_t), intent(in) :: spring
      type(worn_side_t), intent(in) :: worn

      x = (worn%falling - worn%yield*(1 - worn%slope/spring%stiffness)) &
         /(worn%slope + softening(spring))
   end function capping_point

   !> Largest force of the envelope that nothing has worn.
   pure real(wp) function capping_force(spring) result(force)
      type(spring_t), intent(in) :: spring

      force = spring%yield + spring%hardening*(spring%stiffness*spring%backbone%cap - spring%yield)
   end function capping_force

   !> How steep the envelope falls beyond the capping point.
   pure real(wp) function softening(spring) result(slope)
      type(spring_t), intent(in) :: spring

      slope = capping_force(spring)/spring%backbone%post_cap
   end function softening

   !> The spring has no force any more, and what it held is lost.
   pure subroutine break_down(branch, x)
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x

      branch%lost = branch%lost + stored(branch, line_force(branch, x))
      call lay_line(branch, broken, 0, x, 0.0_wp, 0.0_wp)
   end subroutine break_down

   !> Energy that the spring has taken up to the elongation x: what unloading does not give back.
   elemental real(wp) function degrading_loss(branch, x) result(loss)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      loss = branch%lost
      if (branch%direction /= 0) loss = loss + work_along(branch, x) &
         - stored(branch, line_force(branch, x)) + stored(branch, line_force(branch, branch%begin))
   end function degrading_loss

   !> Stored energy at the elongation x.
   elemental real(wp) function degrading_energy(branch, x) result(energy)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      energy = stored(branch, line_force(branch, x))
   end function degrading_energy

   !> Energy that unloading would give back.
   elemental real(wp) function stored(branch, force) result(energy)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: force

      energy = force**2/(2*branch%wear%unloading)
   end function stored

   !> Elongation at which the spring would have no force, unloaded slowly from the elongation x.
   elemental real(wp) function unloaded_elongation(spring, branch, x) result(residual)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      type(branch_t) :: turned

      turned = branch
      call turn_degrading(spring, turned, x)
      residual = x
      if (turned%slope > 0) residual = -turned%offset/turned%slope
   end function unloaded_elongation

end module rwmf_model_hysteresis_degrading
