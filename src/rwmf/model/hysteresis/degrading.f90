!> Spring that loses strength and stiffness: the modified model of Ibarra, Medina and Krawinkler,
!> peak-oriented or pinched.
!>
!> The envelope is the same on both sides. It has the slope k up to F_y and the slope `hardening` k
!> up to the capping point. Beyond it the force falls to the residual force. Unloading follows the
!> unloading stiffness to zero force, where an excursion to the other side begins. The excursion
!> aims straight at the peak, where it rejoins the envelope. It passes through the last reversal if
!> this is lower than the peak and the line to it is stiffer. A pinched spring aims at the pinching
!> point first. Each excursion and each reversal wears the spring by
!>
!>    beta = (E_i/(E_t - sum E_j))**c
!>
!> E_i is the energy of the excursion, E_t the capacity, and the sum includes all excursions so far
!> and the present one. Strength and hardening are multiplied by (1 - beta_s), the falling line by
!> (1 - beta_c), and the elongation of the peak by (1 + beta_a). At a reversal the unloading
!> stiffness is multiplied by (1 - beta_k). The spring breaks when an excursion takes more than the
!> remaining capacity.
!>
!> L. F. Ibarra, R. A. Medina and H. Krawinkler, Earthquake Engng Struct. Dyn. 34 (2005) 1489-1511;
!> D. G. Lignos and H. Krawinkler, J. Struct. Eng. 137 (2011) 1291-1302. Where the papers leave the
!> order of operations open, it is that of `IMKPeakOriented` and `IMKPinching` of OpenSees (2023).
!> Numbers are in the caller's units, see `spring_t`.
module rwmf_model_hysteresis_degrading
   use rwmf_core_kinds, only: wp
   use rwmf_model_spring, only: branch_t, lay_line, line_force, spring_t, wear_t, &
      work_along, worn_side_t
   implicit none
   private

   public :: start_degrading, pass_degrading, turn_degrading, degrading_energy, degrading_loss
   public :: unloaded_elongation, degrading_word

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

   !> Set the initial branch of a spring.
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

   !> Begin the next branch where the elongation passes a limit of the active branch.
   pure subroutine pass_degrading(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows
      real(wp) :: x
      integer :: sense
      !! direction of the motion, +1 or -1

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

   !> Reverse the motion at the elongation x: the spring unloads, less stiff than before.
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

   !> Unload from a point to zero force.
   pure subroutine unload(spring, branch, x, force)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp), intent(in) :: force
      !! force on the current side
      real(wp) :: limits(2)

      call lay_line(branch, unloading, 0, x, branch%side*force, branch%wear%unloading)
      limits = x + branch%side*[-force/branch%wear%unloading, slack(spring, x)]
      branch%low = minval(limits)
      branch%high = maxval(limits)
   end subroutine unload

   !> Begin an excursion at zero force. The energy of the excursion that ends here wears the side
   !> of the new one.
   pure subroutine begin_excursion(spring, branch, side, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      integer, intent(in) :: side
      !! side of the new excursion, +1 or -1
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

   !> Degradation factor beta of one of the four modes of wear, from the energy since the last
   !> excursion began. It is above 1 if this energy exceeds the remaining capacity.
   pure real(wp) function part_lost(spring, branch, mode) result(part)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      integer, intent(in) :: mode
      !! index of the mode in `capacity`
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

   !> Follow a branch outward from the elongation x, or the next one if x is beyond its end.
   pure subroutine follow(spring, branch, x, first)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      integer, intent(in) :: first
      !! kind of the first branch to try
      real(wp) :: start(2), target_event(2), slope
      integer :: kind

      associate (side => branch%side, worn => branch%wear%sides(branch%side))
         start = side*[x, line_force(branch, x)]
         kind = first
         do
            target_event = target_of(spring, branch, worn, kind)
            if (target_event(1) > start(1) + slack(spring, x)) exit
            kind = merge(after_pinch(branch), kind + 1, kind == to_pinch)
         end do
         if (kind == remains .and. .not. target_event(2) > 0) then
            call break_down(branch, x)
            return
         end if
         slope = 0
         if (kind < remains) slope = (target_event(2) - start(2))/(target_event(1) - start(1))
         if (kind >= hardens) start(2) = envelope(spring, worn, start(1))
         if (kind == hardens) slope = worn%slope
         if (kind == softens) slope = -softening(spring)
         call lay_line(branch, kind, side, x, side*start(2), slope)
         if (side > 0) then
            branch%low = x - slack(spring, x)
            branch%high = target_event(1)
         else
            branch%low = -target_event(1)
            branch%high = x + slack(spring, x)
         end if
      end associate
   end subroutine follow

   !> Tolerance of the limits at a reversal and at the beginning of a branch. It prevents wear by a
   !> spurious reversal due to round-off of the state.
   pure real(wp) function slack(spring, x)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: x

      slack = 1.0e-10_wp*max(abs(x), spring%yield/spring%stiffness)
   end function slack

   !> Elongation and force at the end of a branch, on the current side.
   pure function target_of(spring, branch, worn, kind) result(target_event)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      type(worn_side_t), intent(in) :: worn
      !! wear of the current side
      integer, intent(in) :: kind
      !! kind of the branch
      real(wp) :: target_event(2)

      select case (kind)
      case (to_pinch)
         target_event = branch%wear%pinch
      case (to_last)
         target_event = worn%last
      case (to_peak)
         target_event = worn%peak
      case (hardens)
         target_event(1) = capping_point(spring, worn)
         target_event(2) = envelope(spring, worn, target_event(1))
      case (softens)
         target_event = [(worn%falling - spring%backbone%residual)/softening(spring), &
            spring%backbone%residual]
      case default
         target_event = [huge(1.0_wp), spring%backbone%residual]
      end select
   end function target_of

   !> First target on the way from a point to the peak. It is the last reversal if this is lower
   !> than the peak and the line to it is stiffer, else the peak.
   pure integer function stiffer(worn, x, force) result(kind)
      type(worn_side_t), intent(in) :: worn
      real(wp), intent(in) :: x
      !! elongation on the current side
      real(wp), intent(in) :: force
      !! force on the current side

      kind = to_peak
      if (worn%last(1) <= x .or. worn%last(2) <= force .or. worn%last(2) >= worn%peak(2)) return
      if ((worn%last(2) - force)*(worn%peak(1) - x) > (worn%peak(2) - force) &
          *(worn%last(1) - x)) kind = to_last
   end function stiffer

   !> Kind of the branch beyond the pinching point.
   pure integer function after_pinch(branch) result(kind)
      type(branch_t), intent(in) :: branch

      kind = stiffer(branch%wear%sides(branch%side), branch%wear%pinch(1), &
         branch%wear%pinch(2))
   end function after_pinch

   !> Kind of the branch beyond the last reversal, after partial unloading. It aims at the pinching
   !> point if this is ahead and the line to it less stiff, else at the peak.
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

   !> Elongation and force of the pinching point of an excursion that begins at the elongation x.
   pure function pinching_point(spring, branch, x) result(pinch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      !! elongation on the current side
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
      !! elongation, positive on the side

      if (x < worn%yield/spring%stiffness) then
         force = spring%stiffness*x
      else if (x < capping_point(spring, worn)) then
         force = worn%yield + worn%slope*(x - worn%yield/spring%stiffness)
      else
         force = worn%falling - softening(spring)*x
      end if
      force = max(force, spring%backbone%residual)
   end function envelope

   !> Elongation of the capping point of the worn envelope.
   pure real(wp) function capping_point(spring, worn) result(x)
      type(spring_t), intent(in) :: spring
      type(worn_side_t), intent(in) :: worn

      x = (worn%falling - worn%yield*(1 - worn%slope/spring%stiffness)) &
         /(worn%slope + softening(spring))
   end function capping_point

   !> Largest force of the unworn envelope.
   pure real(wp) function capping_force(spring) result(force)
      type(spring_t), intent(in) :: spring

      force = spring%yield + spring%hardening*(spring%stiffness*spring%backbone%cap - spring%yield)
   end function capping_force

   !> Magnitude of the slope of the envelope beyond the capping point.
   pure real(wp) function softening(spring) result(slope)
      type(spring_t), intent(in) :: spring

      slope = capping_force(spring)/spring%backbone%post_cap
   end function softening

   !> Break the spring: its force drops to zero and its stored energy is dissipated.
   pure subroutine break_down(branch, x)
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x

      branch%lost = branch%lost + stored(branch, line_force(branch, x))
      call lay_line(branch, broken, 0, x, 0.0_wp, 0.0_wp)
   end subroutine break_down

   !> Energy dissipated by the spring up to the elongation x, which unloading does not return.
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

   !> Energy that unloading would return.
   elemental real(wp) function stored(branch, force) result(energy)
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: force

      energy = force**2/(2*branch%wear%unloading)
   end function stored

   !> Elongation of zero force after slow unloading from the elongation x.
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

   !> Name of the active branch on the envelope, 'yield', 'capping', 'residual' or 'failure'; else
   !> ''.
   pure function degrading_word(branch) result(word)
      type(branch_t), intent(in) :: branch
      character(8) :: word

      select case (branch%kind)
      case (hardens)
         word = 'yield'
      case (softens)
         word = 'capping'
      case (remains)
         word = 'residual'
      case (broken)
         word = 'failure'
      case default
         word = ''
      end select
   end function degrading_word

end module rwmf_model_hysteresis_degrading
