!> Sensitivity of the motion: derivative of the states by a factor on the ground motion.
!>
!> Between events the derivative obeys the linearised equation of motion. Each piece applies one
!> velocity increment at its middle, from a difference of the rates. A change of the factor also
!> shifts impacts, which adds the jump of the rates times the shift. Springs keep their branches.
module rwmf_simulation_recorder_nearby_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: equation_t, ground_at
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_lanes, only: lane_motion_t
   use rwmf_simulation_events_step_view, only: step_view_t
   implicit none
   private

   public :: nearby_t, begin_nearby, follow_nearby, note_impact

   !> Derivative of the states, and sensitivity of the peak.
   type :: nearby_t
      real(wp), allocatable :: by_factor(:)
      !! (states) derivative by the factor of the ground motion
      real(wp), allocatable :: before(:)
      !! (states) rates before an impact that is still to be applied; otherwise not allocated
      real(wp) :: kept = 1
      !! velocity factor of this impact [-]
      real(wp) :: largest = 0
      !! largest |theta| so far, of a bare frame |u| [rad] or [m]
      real(wp) :: sensitivity = 0
      !! relative change of this value per relative change of the ground motion [-]
      real(wp) :: t = 0
      !! end of the last piece [s]
   end type nearby_t

   real(wp), parameter :: small = 1.0e-7_wp
   !! step of the difference over the size of the motion [-]

contains

   !> Initialise the derivative: the initial state is independent of the ground motion.
   pure subroutine begin_nearby(nearby, n)
      type(nearby_t), intent(out) :: nearby
      integer, intent(in) :: n
      !! number of states

      allocate (nearby%by_factor(n), source=0.0_wp)
   end subroutine begin_nearby

   !> Advance the derivative over a piece of smooth motion.
   subroutine follow_nearby(nearby, piece)
      type(nearby_t), intent(inout) :: nearby
      type(step_view_t), intent(in) :: piece
      real(wp), dimension(size(piece%y_a)) :: y, change, rates
      real(wp) :: step, t
      integer :: n

      associate (equation => piece%equation, by_factor => nearby%by_factor, h => piece%t_b &
                 - piece%t_a)
         if (equation%has_impacts .and. all(abs(piece%y_a(:2)) <= 0)) by_factor(:2) = 0
         if (allocated(nearby%before)) call pass_impact(nearby, piece)
         n = equation%floors%free
         y = (piece%y_a + piece%y_b)/2
         t = piece%t_a + h/2
         call drift(equation, n, h/2, by_factor)
         ! the step must exceed round-off, but stay on the branch
         step = small*max(nearby%largest, maxval(abs(y(:2))), tiny(step)) &
            /max(maxval(abs(by_factor)), 1.0_wp)
         call rates_of(equation, t, 1.0_wp, y, rates)
         call rates_of(equation, t, 1 + step, y + step*by_factor, change)
         change = (change - rates)/step
         change(1) = 0
         change(equation%floors%first:equation%floors%first + n - 1) = 0
         by_factor = by_factor + h*change
         call drift(equation, n, h/2, by_factor)
         ! beyond these bounds the derivative has no meaning
         by_factor = max(min(by_factor, 1/epsilon(h)**2), -1/epsilon(h)**2)
         nearby%t = piece%t_b
         if (abs(piece%y_b(1)) > nearby%largest) then
            nearby%largest = abs(piece%y_b(1))
            nearby%sensitivity = abs(by_factor(1))/nearby%largest
         end if
      end associate
   end subroutine follow_nearby

   !> Advance the derivatives of displacements with those of velocities.
   pure subroutine drift(equation, n, h, by_factor)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: n
      !! number of floors with states
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(inout) :: by_factor(:)

      by_factor(1) = by_factor(1) + h*by_factor(2)
      associate (first => equation%floors%first)
         by_factor(first:first + n - 1) = by_factor(first:first + n - 1) &
            + h*by_factor(first + n:first + 2*n - 1)
      end associate
   end subroutine drift

   !> Compute the rates under a multiple of the ground motion.
   subroutine rates_of(equation, t, factor, y, rates)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: factor
      !! [-]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: rates(:)
      !! (states)
      type(lane_motion_t) :: motion

      call ground_at(equation, t, motion)
      motion%ground = factor*motion%ground
      motion%vertical = factor*motion%vertical
      call lane_rates(equation%scene, equation%state%coef, y, motion, rates)
   end subroutine rates_of

   !> Note an impact, before the wall changes its side.
   subroutine note_impact(nearby, equation, y, kept)
      type(nearby_t), intent(inout) :: nearby
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) before the impact
      real(wp), intent(in) :: kept
      !! velocity factor [-]

      if (.not. allocated(nearby%before)) then
         allocate (nearby%before(size(y)))
         call rates_of(equation, nearby%t, 1.0_wp, y, nearby%before)
         nearby%kept = 1
      end if
      nearby%kept = nearby%kept*kept
   end subroutine note_impact

   !> Apply an impact to the derivative, with the shift of its time.
   subroutine pass_impact(nearby, piece)
      type(nearby_t), intent(inout) :: nearby
      type(step_view_t), intent(in) :: piece
      !! piece that begins after the impact
      real(wp) :: rates(size(piece%y_a)), delay

      call rates_of(piece%equation, piece%t_a, 1.0_wp, piece%y_a, rates)
      associate (by_factor => nearby%by_factor, before => nearby%before)
         if (abs(before(1)) > 0 .and. nearby%kept > 0) then
            delay = -by_factor(1)/before(1)
            by_factor(2) = nearby%kept*by_factor(2)
            before(2) = nearby%kept*before(2)
            by_factor = by_factor - (rates - before)*delay
         end if
      end associate
      deallocate (nearby%before)
   end subroutine pass_impact

end module rwmf_simulation_recorder_nearby_motion
