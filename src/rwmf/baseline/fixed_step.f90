!> Integration with fixed steps by Runge and Kutta's method of order 4, or by Newmark's with average
!> acceleration.
!>
!> The impact is applied at the end of the step in which theta changes its sign; theta keeps its
!> value at that time.
module rwmf_baseline_fixed_step
   use rwmf_baseline_problem, only: apply_impact, evaluate, observe, problem_t, try_lift_off
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_system_jacobian, only: find_jacobian
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: follow_with_fixed_steps

contains

   !> Integrate from the beginning of the scene to its end.
   !>
   !> Errors: `too_many_steps`; a state that is not finite; no convergence of Newton's iteration in
   !> Newmark's method.
   subroutine follow_with_fixed_steps(scene, is_newmark, dt, error)
      type(problem_t), intent(inout) :: scene
      logical, intent(in) :: is_newmark
      !! Newmark's method, otherwise Runge and Kutta's
      real(wp), intent(in) :: dt
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      integer(i8) :: k

      if (scene%t_end > scene%max_steps*dt) then
         call fail(error, err_numerical, 'fixed steps of '//trim(real_to_text(dt)) &
            //' s: more than the most steps by t_end', 'too_many_steps')
         return
      end if
      k = 0_i8
      do while (scene%t < scene%t_end .and. .not. scene%overturned)
         k = k + 1_i8
         if (scene%rests) call try_lift_off(scene)
         call take_step(scene, is_newmark, min(k*dt, scene%t_end), error)
         if (allocated(error)) return
         if (scene%equation%has_wall .and. .not. scene%rests) call end_step(scene, dt)
      end do
   end subroutine follow_with_fixed_steps

   !> Advance to the next sample.
   subroutine take_step(scene, is_newmark, t_new, error)
      type(problem_t), intent(inout) :: scene
      logical, intent(in) :: is_newmark
      real(wp), intent(in) :: t_new
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      if (.not. scene%rests) then
         if (is_newmark) then
            call newmark_step(scene, t_new - scene%t, error)
         else
            call runge_kutta_step(scene, t_new - scene%t)
         end if
         scene%steps = scene%steps + 1_i8
         if (.not. allocated(error) .and. .not. all(abs(scene%y) < huge(1.0_wp))) then
            call fail(error, err_numerical, 'fixed steps: the state is not finite at t = ' &
               //trim(real_to_text(t_new))//' s')
         end if
      end if
      scene%t = t_new
      call observe(scene, scene%y)
   end subroutine take_step

   !> Apply an impact or overturning at the end of a step.
   subroutine end_step(scene, dt)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: dt
      !! shortest flight that the step resolves [s]

      scene%overturned = abs(scene%y(1)) >= scene%overturning_angle
      if (scene%overturned) return
      if (scene%equation%state%side*scene%y(1) < 0) call apply_impact(scene, dt)
   end subroutine end_step

   subroutine runge_kutta_step(scene, h)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: h
      !! [s]
      real(wp) :: f(2, 4)

      call evaluate(scene, scene%t, scene%y, f(:, 1))
      call evaluate(scene, scene%t + h/2, scene%y + h/2*f(:, 1), f(:, 2))
      call evaluate(scene, scene%t + h/2, scene%y + h/2*f(:, 2), f(:, 3))
      call evaluate(scene, scene%t + h, scene%y + h*f(:, 3), f(:, 4))
      scene%y = scene%y + h/6*(f(:, 1) + 2*f(:, 2) + 2*f(:, 3) + f(:, 4))
   end subroutine runge_kutta_step

   !> Take a Newmark step with average acceleration (beta = 1/4, gamma = 1/2), with Newton's
   !> iteration on the acceleration at its end.
   subroutine newmark_step(scene, h, error)
      type(problem_t), intent(inout) :: scene
      real(wp), intent(in) :: h
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_iterations = 50
      real(wp), parameter :: enough = 1.0e-10_wp
      !! correction over the sum of both accelerations [-]
      real(wp) :: f(2)
      real(wp) :: y(2)
      real(wp) :: a_old
      real(wp) :: a_new
      !! [rad/s2]
      real(wp) :: jacobian(2, 2)
      real(wp) :: correction
      integer :: i

      call evaluate(scene, scene%t, scene%y, f)
      a_old = f(2)
      a_new = f(2)
      do i = 1, most_iterations
         y = average_acceleration(scene%y, a_old, a_new, h)
         call evaluate(scene, scene%t + h, y, f)
         call find_jacobian(scene%equation, scene%t + h, y, jacobian)
         correction = (f(2) - a_new)/(1 - h**2/4*jacobian(2, 1) - h/2*jacobian(2, 2))
         a_new = a_new + correction
         if (abs(correction) <= enough*(abs(a_old) + abs(a_new))) exit
      end do
      scene%y = average_acceleration(scene%y, a_old, a_new, h)
      if (i > most_iterations) then
         call fail(error, err_numerical, 'newmark: no convergence at t = ' &
            //trim(real_to_text(scene%t))//' s')
      end if
   end subroutine newmark_step

   !> Compute the state after a step with the mean of two accelerations.
   pure function average_acceleration(y_old, a_old, a_new, h) result(y)
      real(wp), intent(in) :: y_old(2)
      !! theta [rad], theta' [rad/s]
      real(wp), intent(in) :: a_old
      !! [rad/s2]
      real(wp), intent(in) :: a_new
      !! [rad/s2]
      real(wp), intent(in) :: h
      !! [s]
      real(wp) :: y(2)

      y(1) = y_old(1) + h*y_old(2) + h**2/4*(a_old + a_new)
      y(2) = y_old(2) + h/2*(a_old + a_new)
   end function average_acceleration

end module rwmf_baseline_fixed_step
