!> Self-centring spring with a flag-shaped loop, as for prestress with friction or a shape-memory
!> alloy.
!>
!>    F = k x                                   near the origin
!>    F = F_y + a k (x - x_y)                   while x grows beyond x_y = F_y/k
!>    F = (1 - h) F_y + a k (x - (1 - h) x_y)   while x decreases
!>    slope k between both lines, which are h x_y apart
!>
!> The loop is mirrored for x < 0 (h: `flag_height`, a: `hardening`). A closed cycle from zero to
!> x_m dissipates h F_y (1 - a) (x_m - x_y). The law is `SelfCentering` of OpenSees without its
!> slip and bearing. The stored energy is the work recovered by unloading to zero. Numbers are in
!> the caller's units, see `spring_t`.
module rwmf_model_hysteresis_flag
   use rwmf_core_kinds, only: wp
   use rwmf_model_spring, only: branch_t, lay_line, line_force, spring_t, work_along
   implicit none
   private

   public :: start_flag, pass_flag, turn_flag, flag_energy, flag_loss, flag_word

   integer, parameter :: at_origin = 0
   integer, parameter :: upper = 1
   integer, parameter :: lower = 2
   integer, parameter :: between = 3

contains

   !> Begin the branch through the origin, for a new spring or one that has returned.
   pure subroutine start_flag(spring, branch)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch

      call lay_line(branch, at_origin, 0, 0.0_wp, 0.0_wp, spring%stiffness)
      branch%high = spring%yield/spring%stiffness
      branch%low = -branch%high
   end subroutine start_flag

   !> Begin the next branch where the elongation passes a limit of the active branch.
   pure subroutine pass_flag(spring, branch, is_rising)
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
         call turn_flag(spring, branch, x)
         return
      end if
      branch%lost = flag_loss(spring, branch, x)
      if (branch%kind == at_origin) branch%side = sense
      if (branch%kind == lower) then
         call start_flag(spring, branch)
      else if (sense == branch%side) then
         call lay_line(branch, upper, sense, x, line_force(branch, x), &
            spring%hardening*spring%stiffness)
      else
         call come_back(spring, branch, x)
      end if
   end subroutine pass_flag

   !> Follow the lower line to its intersection with the line through the origin, if x is beyond
   !> it.
   pure subroutine come_back(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp) :: meets

      meets = (1 - spring%flag_height)*spring%yield/spring%stiffness
      if (branch%side*x <= meets) then
         call start_flag(spring, branch)
         return
      end if
      call lay_line(branch, lower, -branch%side, x, lower_force(spring, branch%side*x) &
         *branch%side, spring%hardening*spring%stiffness)
      if (branch%side > 0) then
         branch%low = meets
      else
         branch%high = -meets
      end if
   end subroutine come_back

   !> Reverse the motion at the elongation x: follow the slope k to the other line.
   pure subroutine turn_flag(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp) :: width
      integer :: sense
      !! direction of the motion after the reversal, +1 or -1

      if (branch%direction == 0) return
      branch%lost = flag_loss(spring, branch, x)
      sense = -branch%direction
      width = spring%flag_height*spring%yield/spring%stiffness
      call lay_line(branch, between, 0, x, line_force(branch, x), spring%stiffness)
      branch%low = x - merge(0.0_wp, width, sense > 0)
      branch%high = x + merge(width, 0.0_wp, sense > 0)
   end subroutine turn_flag

   !> Energy dissipated up to the elongation x. Only the upper line dissipates; all others return
   !> the energy that they store.
   elemental real(wp) function flag_loss(spring, branch, x) result(loss)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      loss = branch%lost
      if (branch%kind == upper) loss = loss + work_along(branch, x) &
         - flag_energy(spring, branch, x) + flag_energy(spring, branch, branch%begin)
   end function flag_loss

   !> Stored energy at the elongation x, recovered by unloading to zero with the slope k and along
   !> the lower line.
   elemental real(wp) function flag_energy(spring, branch, x) result(energy)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x
      real(wp) :: force, low, meets
      real(wp) :: below
      !! elongation at which unloading reaches the lower line

      associate (k => spring%stiffness)
         force = branch%side*line_force(branch, x)
         if (branch%kind == at_origin) then
            energy = force**2/(2*k)
            return
         end if
         ! F - k (X - X_l) = F_l(X_l) for the two lines
         below = branch%side*x - (force - lower_force(spring, branch%side*x)) &
            /(k*(1 - spring%hardening))
         low = lower_force(spring, below)
         meets = (1 - spring%flag_height)*spring%yield
         energy = (force**2 - low**2 + meets**2)/(2*k) + (low + meets)/2*(below - meets/k)
      end associate
   end function flag_energy

   !> Force on the lower line at an elongation to the side of the flag.
   elemental real(wp) function lower_force(spring, x) result(force)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: x
      !! elongation, positive on the side of the flag

      associate (level => (1 - spring%flag_height)*spring%yield)
         force = level + spring%hardening*(spring%stiffness*x - level)
      end associate
   end function lower_force

   !> Name of the active branch: 'yield' on the upper line, else ''.
   pure function flag_word(branch) result(word)
      type(branch_t), intent(in) :: branch
      character(8) :: word

      word = ''
      if (branch%kind == upper) word = 'yield'
   end function flag_word

end module rwmf_model_hysteresis_flag
