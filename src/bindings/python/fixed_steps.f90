!> Runs with fixed steps, as in common practice, for a comparison of methods.
!>
!> The methods are Runge and Kutta's of order 4, and Newmark's with average acceleration. The
!> equation of motion is the kernel's own. Everything else is common practice and not the best
!> method: lift-off is detected at the beginning of a step, an impact ends the step in which theta
!> changes its sign, and maxima are those of the ends of steps.
module rwmf_bindings_python_fixed_steps
   use rwmf_bindings_python_timed_run, only: at_t_end, at_theta_dot_end, at_theta_end, &
      at_theta_max, at_u_s_max, empty_measured, timed_run_t
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_embedding_ranges, only: positive, require_number
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_restitution, only: factor_at, restitution_t
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      frame_displacement, rhs
   use rwmf_model_system_jacobian, only: find_jacobian
   use rwmf_model_system_lift_off, only: lifting_side
   use rwmf_motion_ground_motion, only: interval_at, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_simulation_run, only: initial_state
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: run_fixed_steps, usual_interval

   !> Scene with its current state.
   type :: stepped_scene_t
      type(equation_t) :: equation
      type(restitution_t) :: restitution
      real(wp) :: t = 0
      !! [s]
      real(wp) :: y(2)
      !! theta [rad] and theta' [rad/s]; bare frame u [m] and u' [m/s]
      logical :: rests
   end type stepped_scene_t

contains

   !> Usual sampling interval of a case: that of the record, a hundredth of the pulse's period, or
   !> 0.01 s without a motion [s].
   pure real(wp) function usual_interval(case) result(dt)
      type(case_t), intent(in) :: case

      dt = 0.01_wp
      if (allocated(case%record)) then
         dt = (case%record%t(case%record%n) - case%record%t(1))/(case%record%n - 1)
      else if (allocated(case%motion)) then
         if (allocated(case%motion%T_p)) then
            dt = case%motion%T_p/100
         else if (allocated(case%motion%omega_p)) then
            dt = 2*pi/case%motion%omega_p/100
         end if
      end if
   end function usual_interval

   !> Compute the response of a scene of two states without springs that yield.
   !>
   !> Errors: an invalid step, no period of the frame, a scene with more states, too many steps, a
   !> state that is not finite, or no convergence.
   subroutine run_fixed_steps(case, is_newmark, dt, measured, error)
      type(case_t), intent(in) :: case
      !! valid
      logical, intent(in) :: is_newmark
      !! Newmark's method, otherwise Runge and Kutta's
      real(wp), intent(in) :: dt
      !! [s]
      type(timed_run_t), intent(out) :: measured
      type(error_t), allocatable, intent(out) :: error
      integer(i8), parameter :: most_steps = 1000000_i8
      type(motion_t), target :: motion
      type(stepped_scene_t) :: scene
      real(wp) :: started

      measured = empty_measured()
      call check_single_run(case, error)
      call require_number(dt, 'dt', positive, error)
      if (allocated(error)) return
      if (allocated(case%compliant_base)) then
         call fail(error, err_numerical, 'fixed steps know a wall on two rigid corners only', &
            'not_practised')
         return
      end if
      motion = motion_from_case(case)
      call cpu_time(started)
      call build_equation(case, motion, scene%equation)
      if (scene%equation%n > 2 .or. scene%equation%has_bilinear_springs) then
         call fail(error, err_numerical, 'fixed steps know theta and its rate only: no floors ' &
            //'with all modes, and no springs that yield', 'not_practised')
      else if (case%solver%t_end > min(case%solver%max_steps*1.0_wp, most_steps*1.0_wp)*dt) then
         call fail(error, err_numerical, 'fixed steps of '//trim(real_to_text(dt)) &
            //' s: more than the most steps by t_end', 'too_many_steps')
      end if
      if (allocated(error)) return
      scene%restitution = impact_law(case, scene%equation%p%alpha)
      scene%y = initial_state(case, scene%equation)
      scene%rests = scene%equation%has_wall .and. all(abs(scene%y) <= 0)
      if (scene%y(1) < 0 .or. (abs(scene%y(1)) <= 0 .and. scene%y(2) < 0)) then
         call enter_side(scene%equation%model_t, scene%equation%state, -1)
      end if
      call follow(scene, case, is_newmark, dt, measured, error)
      measured%values([at_theta_end, at_theta_dot_end, at_t_end]) = [scene%y, scene%t]
      measured%rhs_evaluations = scene%equation%rhs_evaluations
      call cpu_time(measured%seconds)
      measured%seconds = measured%seconds - started
   end subroutine run_fixed_steps

   !> Integrate from the beginning of the scene to its end or to overturning.
   subroutine follow(scene, case, is_newmark, dt, measured, error)
      type(stepped_scene_t), intent(inout) :: scene
      type(case_t), intent(in) :: case
      logical, intent(in) :: is_newmark
      real(wp), intent(in) :: dt
      type(timed_run_t), intent(inout) :: measured
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: impact_times(:)
      !! [s]
      integer(i8) :: k
      integer :: impacts

      allocate (impact_times(int(case%solver%t_end/dt) + 2))
      impacts = 0
      k = 0_i8
      if (scene%equation%has_frame) measured%values(at_u_s_max) = 0
      if (scene%equation%has_wall) measured%values(at_theta_max) = 0
      call observe(scene, measured)
      do while (scene%t < case%solver%t_end .and. .not. measured%overturned)
         k = k + 1_i8
         if (scene%rests) call try_lift_off(scene)
         if (.not. scene%rests) then
            call take_step(scene, is_newmark, min(k*dt, case%solver%t_end) - scene%t, error)
            if (allocated(error)) return
            measured%steps = measured%steps + 1_i8
         end if
         scene%t = min(k*dt, case%solver%t_end)
         call observe(scene, measured)
         if (scene%rests .or. .not. scene%equation%has_wall) cycle
         measured%overturned = abs(scene%y(1)) >= case%model%overturning_angle
         if (measured%overturned .or. scene%equation%state%side*scene%y(1) >= 0) cycle
         impacts = impacts + 1
         impact_times(impacts) = scene%t
         call apply_impact(scene, dt)
      end do
      measured%impact_times = impact_times(:impacts)
   end subroutine follow

   !> Include the present state in the maxima.
   subroutine observe(scene, measured)
      type(stepped_scene_t), intent(in) :: scene
      type(timed_run_t), intent(inout) :: measured
      integer :: side

      associate (equation => scene%equation, values => measured%values)
         ! theta is beyond 0 until the impact is applied
         side = equation%state%side
         if (side*scene%y(1) < 0) side = -side
         if (equation%has_frame) values(at_u_s_max) = max(values(at_u_s_max), &
            abs(frame_displacement(equation, side, scene%y)))
         if (equation%has_wall) values(at_theta_max) = max(values(at_theta_max), abs(scene%y(1)))
      end associate
   end subroutine observe

   !> Start uplift of the resting wall if the ground motion lifts it at the current time.
   subroutine try_lift_off(scene)
      type(stepped_scene_t), intent(inout) :: scene
      integer :: side

      side = lifting_side(scene%equation, interval_at(scene%equation%motion, scene%t), scene%t)
      if (side == 0) return
      call enter_side(scene%equation%model_t, scene%equation%state, side)
      scene%rests = .false.
   end subroutine try_lift_off

   !> Apply an impact: reduce the velocity and change the side. A pressed wall rests if its next
   !> flight would be shorter than a step.
   subroutine apply_impact(scene, dt)
      type(stepped_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: dt
      !! [s]
      real(wp) :: f(2)

      associate (equation => scene%equation)
         call enter_side(equation%model_t, equation%state, -equation%state%side)
         scene%y(2) = factor_at(scene%restitution, abs(scene%y(2)))*scene%y(2)
         if (lifting_side(equation, interval_at(equation%motion, scene%t), scene%t) /= 0) return
         call evaluate(scene, scene%t, scene%y, f)
         if (abs(scene%y(2)) > abs(f(2))*dt/2) return
         scene%y = 0
         scene%rests = .true.
      end associate
   end subroutine apply_impact

   !> Evaluate the first-order form of the equation of motion on the current side.
   subroutine evaluate(scene, t, y, y_dot)
      type(stepped_scene_t), intent(inout) :: scene
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

   !> Advance the state by a step of length h.
   subroutine take_step(scene, is_newmark, h, error)
      type(stepped_scene_t), intent(inout) :: scene
      logical, intent(in) :: is_newmark
      real(wp), intent(in) :: h
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! the state is not finite, or no convergence
      real(wp) :: f(2, 4)

      if (is_newmark) then
         call newmark_step(scene, h, error)
      else
         call evaluate(scene, scene%t, scene%y, f(:, 1))
         call evaluate(scene, scene%t + h/2, scene%y + h/2*f(:, 1), f(:, 2))
         call evaluate(scene, scene%t + h/2, scene%y + h/2*f(:, 2), f(:, 3))
         call evaluate(scene, scene%t + h, scene%y + h*f(:, 3), f(:, 4))
         scene%y = scene%y + h/6*(f(:, 1) + 2*f(:, 2) + 2*f(:, 3) + f(:, 4))
      end if
      if (all(abs(scene%y) < huge(1.0_wp)) .or. allocated(error)) return
      call fail(error, err_numerical, 'fixed steps: the state is not finite at t = ' &
         //trim(real_to_text(scene%t + h))//' s')
   end subroutine take_step

   !> Take a Newmark step with average acceleration (beta = 1/4, gamma = 1/2). Newton's iteration
   !> finds the acceleration at its end.
   subroutine newmark_step(scene, h, error)
      type(stepped_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: h
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! no convergence
      integer, parameter :: most_iterations = 50
      real(wp), parameter :: enough = 1.0e-10_wp
      !! correction over the sum of both accelerations [-]
      real(wp) :: f(2), y(2)
      real(wp) :: a(2)
      !! accelerations at both ends [rad/s2]
      real(wp) :: jacobian(2, 2)
      real(wp) :: correction
      integer :: i

      call evaluate(scene, scene%t, scene%y, f)
      a = f(2)
      do i = 1, most_iterations
         y = scene%y + [h*scene%y(2) + h**2/4*sum(a), h/2*sum(a)]
         call evaluate(scene, scene%t + h, y, f)
         call find_jacobian(scene%equation, scene%t + h, y, jacobian)
         correction = (f(2) - a(2))/(1 - h**2/4*jacobian(2, 1) - h/2*jacobian(2, 2))
         a(2) = a(2) + correction
         if (abs(correction) <= enough*sum(abs(a))) exit
      end do
      scene%y = scene%y + [h*scene%y(2) + h**2/4*sum(a), h/2*sum(a)]
      if (i > most_iterations) call fail(error, err_numerical, 'newmark: no convergence at t = ' &
         //trim(real_to_text(scene%t))//' s')
   end subroutine newmark_step

end module rwmf_bindings_python_fixed_steps
