!> Procedure of the paper, MATLAB's `ode45` with an event function and a restart after each impact.
!>
!> It uses Dormand and Prince's pair 5(4). Step control, event location and the four output points
!> per step are those of Shampine and Reichelt (The MATLAB ODE Suite, SIAM J. Sci. Comput. 18,
!> 1997). Its steps ignore the samples of a record.
module rwmf_baseline_ode45
   use rwmf_baseline_problem, only: apply_impact, evaluate, observe, problem_t, try_lift_off
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_math_roots, only: close_in, secant_between, secant_t
   use rwmf_model_equation, only: enter_side
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: follow_with_ode45

   integer, parameter :: stages = 7
   integer, parameter :: points_per_step = 4
   !! `Refine` of ode45
   real(wp), parameter :: power = 0.2_wp

   real(wp), parameter :: nodes(stages) = [0.0_wp, 0.2_wp, 0.3_wp, 0.8_wp, 8.0_wp/9, 1.0_wp, 1.0_wp]
   real(wp), parameter :: weights(stages, 2:stages) = reshape([ &
      1.0_wp/5, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      3.0_wp/40, 9.0_wp/40, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      44.0_wp/45, -56.0_wp/15, 32.0_wp/9, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      19372.0_wp/6561, -25360.0_wp/2187, 64448.0_wp/6561, -212.0_wp/729, 0.0_wp, 0.0_wp, 0.0_wp, &
      9017.0_wp/3168, -355.0_wp/33, 46732.0_wp/5247, 49.0_wp/176, -5103.0_wp/18656, 0.0_wp, &
      0.0_wp, &
      35.0_wp/384, 0.0_wp, 500.0_wp/1113, 125.0_wp/192, -2187.0_wp/6784, 11.0_wp/84, 0.0_wp], &
      [stages, stages - 1])
   !! weights(:, i): stage i; the last one is the solution of order 5
   real(wp), parameter :: error_weights(stages) = [71.0_wp/57600, 0.0_wp, -71.0_wp/16695, &
      71.0_wp/1920, -17253.0_wp/339200, 22.0_wp/525, -1.0_wp/40]
   real(wp), parameter :: dense_weights(stages, 4) = reshape([ &
      1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      -183.0_wp/64, 0.0_wp, 1500.0_wp/371, -125.0_wp/32, 9477.0_wp/3392, -11.0_wp/7, 1.5_wp, &
      37.0_wp/12, 0.0_wp, -1000.0_wp/159, 125.0_wp/12, -729.0_wp/106, 11.0_wp/3, -4.0_wp, &
      -145.0_wp/128, 0.0_wp, 1000.0_wp/371, -375.0_wp/64, 25515.0_wp/6784, -55.0_wp/28, 2.5_wp], &
      [stages, 4])
   !! dense_weights(:, k): coefficient of the k-th power of the position in the step

   !> Accepted step.
   type :: step_t
      real(wp) :: t
      !! beginning [s]
      real(wp) :: h
      !! length [s]
      real(wp) :: y(2)
      !! state at the beginning
      real(wp) :: y_new(2)
      !! state at the end
      real(wp) :: f(2, stages)
      !! derivatives of the stages
   end type step_t

contains

   !> Integrate from the beginning of the scene to its end.
   !>
   !> Errors: `too_many_steps`; a step that becomes too small.
   subroutine follow_with_ode45(scene, rtol, atol, dt, error)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: rtol
      !! `RelTol` [-]
      real(wp), intent(in) :: atol
      !! `AbsTol`, for all states
      real(wp), intent(in) :: dt
      !! interval of the samples at which uplift is checked [s]
      type(error_t), allocatable, intent(out) :: error
      logical :: hit

      do while (scene%t < scene%t_end .and. .not. scene%overturned)
         if (scene%rests) then
            call wait_for_lift_off(scene, dt)
            cycle
         end if
         call follow_flight(scene, rtol, atol, hit, error)
         if (allocated(error)) return
         if (hit) call apply_impact(scene, 0.0_wp)
      end do
   end subroutine follow_with_ode45

   !> Advance to the next sample at which the ground motion lifts the wall, or to the end.
   subroutine wait_for_lift_off(scene, dt)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: dt
      integer(i8) :: k

      k = ceiling(scene%t/dt, i8)
      do
         scene%t = max(scene%t, k*dt)
         if (scene%t >= scene%t_end) exit
         call try_lift_off(scene)
         if (.not. scene%rests) return
         k = k + 1_i8
      end do
      scene%t = scene%t_end
   end subroutine wait_for_lift_off

   !> Integrate as in one call of ode45, from the current state to the end, an impact or
   !> overturning.
   subroutine follow_flight(scene, rtol, atol, hit, error)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: rtol
      real(wp), intent(in) :: atol
      logical, intent(out) :: hit
      !! an impact ended the flight
      type(error_t), allocatable, intent(out) :: error
      type(step_t) :: step
      real(wp) :: h
      real(wp) :: h_max

      h_max = (scene%t_end - scene%t)/10
      step%t = scene%t
      step%y = scene%y
      call evaluate(scene, step%t, step%y, step%f(:, 1))
      h = first_length(step, rtol, atol, h_max)
      hit = .false.
      do while (step%t < scene%t_end)
         if (scene%steps >= scene%max_steps) then
            call fail(error, err_numerical, 'ode45: more than the most steps by t = ' &
               //trim(real_to_text(step%t))//' s', 'too_many_steps')
            return
         end if
         call advance(scene, step, rtol, atol, h, h_max, error)
         if (allocated(error)) return
         call find_impact(scene, step, hit)
         call keep_points(scene, step, merge(scene%t - step%t, step%h, hit))
         scene%overturned = scene%equation%has_wall &
            .and. abs(scene%y(1)) >= scene%overturning_angle
         if (hit .or. scene%overturned) return
         step%t = scene%t
         step%y = step%y_new
         step%f(:, 1) = step%f(:, stages)
      end do
   end subroutine follow_flight

   !> Compute the first step length [s].
   pure real(wp) function first_length(step, rtol, atol, h_max) result(h)
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: rtol
      real(wp), intent(in) :: atol
      real(wp), intent(in) :: h_max
      !! [s]
      real(wp) :: rate

      h = h_max
      rate = maxval(abs(step%f(:, 1))/max(abs(step%y), atol/rtol))/(0.8_wp*rtol**power)
      if (h*rate > 1) h = 1/rate
      h = max(h, least_length(step%t))
   end function first_length

   !> Shortest step length of ode45 [s].
   pure real(wp) function least_length(t) result(h)
      real(wp), intent(in) :: t
      !! [s]

      h = 16*spacing(t)
   end function least_length

   !> Take one step that satisfies the tolerances; store time and state at its end in the scene.
   subroutine advance(scene, step, rtol, atol, h, h_max, error)
      type(problem_t), intent(inout) :: scene
      type(step_t), intent(inout) :: step
      real(wp), intent(in) :: rtol
      real(wp), intent(in) :: atol
      real(wp), intent(inout) :: h
      !! proposed length of this step, on return of the next one [s]
      real(wp), intent(in) :: h_max
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: local_error
      real(wp) :: shrink
      logical :: has_failed

      h = min(h_max, max(h, least_length(step%t)))
      has_failed = .false.
      do
         if (1.1_wp*h >= scene%t_end - step%t) h = scene%t_end - step%t
         step%h = h
         call attempt(scene, step)
         local_error = h*maxval(abs(matmul(step%f, error_weights)) &
            /max(abs(step%y), abs(step%y_new), atol/rtol))
         if (local_error <= rtol) exit
         if (h <= least_length(step%t)) then
            call fail(error, err_numerical, 'ode45: no step is short enough at t = ' &
               //trim(real_to_text(step%t))//' s')
            return
         end if
         shrink = 0.5_wp
         if (.not. has_failed) shrink = max(0.1_wp, 0.8_wp*(rtol/local_error)**power)
         has_failed = .true.
         h = max(least_length(step%t), h*shrink)
      end do
      if (.not. has_failed) h = h/max(0.2_wp, 1.25_wp*(local_error/rtol)**power)
      scene%steps = scene%steps + 1_i8
      scene%t = step%t + step%h
      if (step%h >= scene%t_end - step%t) scene%t = scene%t_end
      scene%y = step%y_new
   end subroutine advance

   !> Compute the stages of a step of given length.
   subroutine attempt(scene, step)
      type(problem_t), intent(inout) :: scene
      type(step_t), intent(inout) :: step
      real(wp) :: y(2)
      integer :: i

      do i = 2, stages
         y = step%y + step%h*matmul(step%f(:, :i - 1), weights(:i - 1, i))
         call evaluate(scene, step%t + nodes(i)*step%h, y, step%f(:, i))
      end do
      step%y_new = y
   end subroutine attempt

   !> Compute the state inside the step by the continuous extension.
   pure function state_inside(step, t) result(y)
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: y(2)
      real(wp) :: x
      !! position in the step [-]

      x = (t - step%t)/step%h
      y = step%y + step%h*matmul(step%f, matmul(dense_weights, [x, x**2, x**3, x**4]))
   end function state_inside

   !> Record the points between the ends of the step, and its end.
   subroutine keep_points(scene, step, length)
      type(problem_t), intent(inout) :: scene
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: length
      !! length of the step, or of its part before the impact [s]
      integer :: i

      do i = 1, points_per_step - 1
         call observe(scene, state_inside(step, step%t + length*i/points_per_step))
      end do
      call observe(scene, scene%y)
   end subroutine keep_points

   !> Find the event theta = 0, a change of sign between the ends of the step.
   !>
   !> For a flight that begins at theta = 0 the sign is evaluated half the resolution later.
   subroutine find_impact(scene, step, hit)
      type(problem_t), intent(inout) :: scene
      type(step_t), intent(in) :: step
      logical, intent(out) :: hit
      real(wp) :: left, resolution
      !! [s]
      type(secant_t) :: secant
      real(wp) :: y(2)
      real(wp) :: side

      hit = .false.
      if (.not. scene%equation%has_wall) return
      left = step%t
      resolution = min(128*max(spacing(left), spacing(scene%t)), scene%t - left)
      y = step%y
      if (abs(y(1)) <= 0) then
         left = left + resolution/2
         y = state_inside(step, left)
      end if
      hit = y(1)*step%y_new(1) < 0 .or. (abs(y(1)) > 0 .and. abs(step%y_new(1)) <= 0)
      if (.not. hit) return
      side = sign(1.0_wp, y(1))
      secant = secant_between([left, scene%t], [y(1), step%y_new(1)], resolution)
      do while (secant%is_open)
         y = state_inside(step, secant%next)
         call close_in(secant, y(1))
      end do
      scene%t = secant%x(2)
      scene%y = state_inside(step, scene%t)
      scene%y(1) = 0
      call enter_side(scene%equation%model_t, scene%equation%state, nint(side))
   end subroutine find_impact

end module rwmf_baseline_ode45
