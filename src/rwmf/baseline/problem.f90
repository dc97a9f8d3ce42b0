!> What today's procedures for rocking walls share: the scene, the impact rule, rest and lift-off,
!> and what they report.
!>
!> The equation of motion is the kernel's own. The treatment of everything around it is meant to be
!> what is usually programmed, not what is best: the ground motion is a table that is interpolated,
!> lift-off is noticed at a sample, maxima are those of the points that are kept.
module rwmf_baseline_problem
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      frame_displacement, lift_off_drive, rhs
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_restitution, only: factor_at, restitution_t
   use rwmf_motion_ground_motion, only: interval_at, motion_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: baseline_t, problem_t
   public :: create_problem, evaluate, observe, apply_impact, try_lift_off, finish_problem, &
      usual_interval

   real(wp), parameter :: small_velocity = 1.0e-6_wp
   !! a wall that is pressed down and leaves an impact with less comes to rest [rad/s]
   integer(i8), parameter :: most_steps = 1000000_i8
   !! a procedure that follows every impact of a chatter must end
   real(wp), parameter :: interval_without_motion = 0.01_wp
   !! [s]

   !> What such a procedure reports.
   type :: baseline_t
      real(wp), allocatable :: u_s_max
      !! largest |u_s| of the points kept [m]; absent without a frame
      real(wp), allocatable :: theta_max
      !! largest |theta| of the points kept [rad]; absent without a wall
      real(wp), allocatable :: impact_times(:)
      !! (impacts) [s]
      real(wp), allocatable :: final_state(:)
      !! (states)
      real(wp) :: t_end
      !! where it ended: the case's end, or overturning [s]
      logical :: overturned
      integer(i8) :: steps
      integer(i8) :: rhs_evaluations
      real(wp) :: seconds
      !! wall-clock time [s]
   end type baseline_t

   !> A scene while it is computed.
   type :: problem_t
      type(equation_t) :: equation
      type(restitution_t) :: restitution
      !! what an impact leaves of the velocity
      real(wp) :: overturning_angle
      !! [rad]
      real(wp) :: t_end
      !! [s]
      real(wp) :: t
      !! present time [s]
      real(wp) :: y(2)
      !! theta [rad] and theta' [rad/s]; bare frame u [m] and u' [m/s]
      logical :: rests
      logical :: overturned
      integer(i8) :: steps
      integer(i8) :: max_steps
      real(wp) :: u_max
      !! [m]
      real(wp) :: angle_max
      !! [rad]
      real(wp), allocatable :: impact_times(:)
      !! (capacity) [s]
      integer :: impacts
   end type problem_t

contains

   !> The scene of a case at t = 0.
   subroutine create_problem(case, motion, scene)
      type(case_t), intent(in) :: case
      !! valid, with the frame's T_s given
      type(motion_t), intent(in), target :: motion
      !! of the case; outlives the scene
      type(problem_t), intent(out) :: scene

      call build_equation(case, motion, scene%equation)
      scene%restitution = impact_law(case, scene%equation%p%alpha)
      scene%overturning_angle = case%model%overturning_angle
      scene%t_end = case%solver%t_end
      scene%max_steps = min(int(case%solver%max_steps, i8), most_steps)
      scene%t = 0
      scene%y = 0
      if (allocated(case%initial)) then
         scene%y = [case%initial%theta_over_alpha*scene%equation%p%alpha, case%initial%theta_dot]
      end if
      scene%rests = scene%equation%has_wall .and. all(abs(scene%y) <= 0)
      scene%overturned = .false.
      scene%steps = 0_i8
      scene%u_max = 0
      scene%angle_max = 0
      scene%impacts = 0
      allocate (scene%impact_times(64))
      if (scene%y(1) < 0 .or. (abs(scene%y(1)) <= 0 .and. scene%y(2) < 0)) then
         call enter_side(scene%equation%model_t, scene%equation%state, -1)
      end if
      call observe(scene, scene%y)
   end subroutine create_problem

   !> The interval of time at which such a case is usually sampled: the record's own, a hundredth of
   !> the pulse's period, 0.01 s without a motion [s].
   pure real(wp) function usual_interval(case) result(dt)
      type(case_t), intent(in) :: case

      dt = interval_without_motion
      if (allocated(case%record)) then
         dt = (case%record%t(case%record%n) - case%record%t(1))/(case%record%n - 1)
      else if (allocated(case%motion)) then
         if (allocated(case%motion%T_p)) then
            dt = case%motion%T_p/100
         else if (allocated(case%motion%omega_p)) then
            dt = 2*acos(-1.0_wp)/case%motion%omega_p/100
         end if
      end if
   end function usual_interval

   !> First-order form of the equation of the side in force, until the impact is applied.
   subroutine evaluate(scene, t, y, y_dot)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(2)
      !! theta [rad], theta' [rad/s]
      real(wp), intent(out) :: y_dot(2)
      !! rates of the states

      call enter_interval(scene%equation%model_t, scene%equation%state, &
         interval_at(scene%equation%motion, t))
      call rhs(scene%equation, t, y, y_dot)
   end subroutine evaluate

   !> Let a point that is kept take part in the maxima.
   subroutine observe(scene, y)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: y(2)
      !! theta [rad], theta' [rad/s]
      integer :: side

      side = scene%equation%state%side
      ! a fixed step leaves theta beyond 0 before the impact is applied
      if (y(1)*side < 0) call enter_side(scene%equation%model_t, scene%equation%state, -side)
      scene%u_max = max(scene%u_max, abs(frame_displacement(scene%equation, &
         scene%equation%state%side, y)))
      scene%angle_max = max(scene%angle_max, abs(y(1)))
      call enter_side(scene%equation%model_t, scene%equation%state, side)
   end subroutine observe

   !> Impact at the present time: the velocity falls by the factor e and the other side begins, or
   !> the wall comes to rest.
   subroutine apply_impact(scene, least_flight)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: least_flight
      !! a flight that would be shorter ends in rest; 0 for no such limit [s]
      real(wp), allocatable :: grown(:)
      real(wp) :: slope(2)

      if (scene%impacts == size(scene%impact_times)) then
         allocate (grown(2*scene%impacts))
         grown(:scene%impacts) = scene%impact_times
         call move_alloc(grown, scene%impact_times)
      end if
      scene%impacts = scene%impacts + 1
      scene%impact_times(scene%impacts) = scene%t
      call enter_side(scene%equation%model_t, scene%equation%state, -scene%equation%state%side)
      scene%y(2) = factor_at(scene%restitution, abs(scene%y(2)))*scene%y(2)
      if (lifting_side(scene, scene%t) /= 0) return
      call evaluate(scene, scene%t, scene%y, slope)
      if (abs(scene%y(2)) > max(small_velocity, abs(slope(2))*least_flight/2)) return
      scene%y = 0
      scene%rests = .true.
   end subroutine apply_impact

   !> Side on which the ground motion lifts the wall at an instant, 0 for none.
   pure integer function lifting_side(scene, t) result(side)
      type(problem_t), intent(in) :: scene
      real(wp), intent(in) :: t
      !! [s]
      integer :: interval

      interval = interval_at(scene%equation%motion, t)
      side = 0
      if (lift_off_drive(scene%equation, 1, interval, t) > 0) side = 1
      if (lift_off_drive(scene%equation, -1, interval, t) > 0) side = -1
   end function lifting_side

   !> Does the ground motion lift the resting wall at the present time?
   subroutine try_lift_off(scene)
      type(problem_t), intent(inout) :: scene
      integer :: side

      side = lifting_side(scene, scene%t)
      if (side == 0) return
      call enter_side(scene%equation%model_t, scene%equation%state, side)
      scene%rests = .false.
   end subroutine try_lift_off

   !> What applies to the scene.
   subroutine finish_problem(scene, baseline)
      type(problem_t), intent(in) :: scene
      type(baseline_t), intent(inout) :: baseline

      if (scene%equation%has_frame) baseline%u_s_max = scene%u_max
      if (scene%equation%has_wall) baseline%theta_max = scene%angle_max
      baseline%impact_times = scene%impact_times(:scene%impacts)
      baseline%final_state = scene%y
      baseline%t_end = scene%t
      baseline%overturned = scene%overturned
      baseline%steps = scene%steps
      baseline%rhs_evaluations = scene%equation%rhs_evaluations
   end subroutine finish_problem

end module rwmf_baseline_problem
