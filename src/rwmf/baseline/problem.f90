!> Common parts of today's procedures for rocking walls: the scene, the impact rule, rest and
!> uplift, and the reported results.
!>
!> The equation of motion is the kernel's own. All other parts follow common practice, not the best
!> method. The ground motion is an interpolated table, uplift is detected at a sample, and maxima
!> are those of the recorded points.
module rwmf_baseline_problem
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_restitution, only: factor_at, restitution_t
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      frame_displacement, uplift_demand, rhs
   use rwmf_motion_ground_motion, only: interval_at, motion_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: baseline_t, problem_t
   public :: create_problem, evaluate, observe, apply_impact, try_lift_off, finish_problem, &
      usual_interval

   real(wp), parameter :: small_velocity = 1.0e-6_wp
   !! a wall pressed onto its base stops after an impact below this velocity [rad/s]
   integer(i8), parameter :: most_steps = 1000000_i8
   !! limit of the steps, because every impact of a chatter is followed
   real(wp), parameter :: interval_without_motion = 0.01_wp
   !! [s]

   !> Results of a procedure.
   type :: baseline_t
      real(wp), allocatable :: u_s_max
      !! largest |u_s| of the recorded points [m]; absent without a frame
      real(wp), allocatable :: theta_max
      !! largest |theta| of the recorded points [rad]; absent without a wall
      real(wp), allocatable :: impact_times(:)
      !! (impacts) [s]
      real(wp), allocatable :: final_state(:)
      !! (states)
      real(wp) :: t_end
      !! end of the run, the end of the case or overturning [s]
      logical :: overturned
      integer(i8) :: steps
      integer(i8) :: rhs_evaluations
      real(wp) :: seconds
      !! processor time [s]
   end type baseline_t

   !> Scene with its current state.
   type :: problem_t
      type(equation_t) :: equation
      type(restitution_t) :: restitution
      !! restitution of the velocity at impact
      real(wp) :: overturning_angle
      !! [rad]
      real(wp) :: t_end
      !! [s]
      real(wp) :: t
      !! current time [s]
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

   !> Create the scene of a case at t = 0.
   subroutine create_problem(case, motion, scene)
      type(case_t), intent(in) :: case
      !! valid case, with the frame's T_s
      type(motion_t), intent(in), target :: motion
      !! motion of the case; must outlive the scene
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

   !> Usual sampling interval of a case: that of the record, a hundredth of the pulse's period, or
   !> 0.01 s without a motion [s].
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

   !> Evaluate the first-order form of the equation of motion on the current side.
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

   !> Include a recorded point in the maxima.
   subroutine observe(scene, y)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: y(2)
      !! theta [rad], theta' [rad/s]
      integer :: side

      side = scene%equation%state%side
      ! after a fixed step theta is beyond 0 until the impact is applied
      if (y(1)*side < 0) call enter_side(scene%equation%model_t, scene%equation%state, -side)
      scene%u_max = max(scene%u_max, abs(frame_displacement(scene%equation, &
         scene%equation%state%side, y)))
      scene%angle_max = max(scene%angle_max, abs(y(1)))
      call enter_side(scene%equation%model_t, scene%equation%state, side)
   end subroutine observe

   !> Apply an impact at the current time: multiply the velocity by the factor e and change the
   !> side, or stop the wall.
   subroutine apply_impact(scene, least_flight)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: least_flight
      !! flights shorter than this end in rest; 0 without a limit [s]
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
      if (uplift_demand(scene%equation, 1, interval, t) > 0) side = 1
      if (uplift_demand(scene%equation, -1, interval, t) > 0) side = -1
   end function lifting_side

   !> Start uplift of the resting wall if the ground motion lifts it at the current time.
   subroutine try_lift_off(scene)
      type(problem_t), intent(inout) :: scene
      integer :: side

      side = lifting_side(scene, scene%t)
      if (side == 0) return
      call enter_side(scene%equation%model_t, scene%equation%state, side)
      scene%rests = .false.
   end subroutine try_lift_off

   !> Collect the results that apply to the scene.
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
