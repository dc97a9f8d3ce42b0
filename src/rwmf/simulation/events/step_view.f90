!> View of a step of an integrator: its ends, the rates at the ends, and states inside on request.
module rwmf_simulation_events_step_view
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_model_system_assembly, only: equation_t, interval_of, rates_at, second_derivative
   use rwmf_motion_ground_motion, only: fastest_rate, interval_end, turning_point
   implicit none
   private

   public :: step_view_t, view_step, until, from, shorten, rates_in
   public :: count_parts, end_of_part, sample_state, accelerations
   public :: fastest_angle, is_short, turning_frequency

   !> Piece of the last step, from a to b. Its pointers refer to data of other owners.
   type :: step_view_t
      type(equation_t), pointer :: equation => null()
      class(integrator_t), pointer :: integrator => null()
      !! null if the wall rests and only the ground moves
      real(wp) :: t_a, t_b
      !! [s]
      real(wp), pointer, contiguous :: y_a(:) => null(), y_b(:) => null()
      !! (states) at both ends
      real(wp), pointer, contiguous :: rates_a(:) => null(), rates_b(:) => null()
      !! (states) rates at both ends, if known
   end type step_view_t

contains

   !> View the whole step.
   subroutine view_step(step, equation, integrator)
      type(step_view_t), intent(inout) :: step
      type(equation_t), intent(in), target :: equation
      class(integrator_t), intent(in), target :: integrator

      step%equation => equation
      step%integrator => integrator
      step%t_a = integrator%t0
      step%t_b = integrator%t1
      step%y_a => integrator%y0
      step%y_b => integrator%y1
   end subroutine view_step

   !> Return the piece up to a time [s] with the states y(:) at that time.
   function until(step, t, y) result(piece)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in), contiguous, target :: y(:)
      !! states
      type(step_view_t) :: piece

      piece = step
      piece%t_b = t
      piece%y_b => y
      nullify (piece%rates_b)
   end function until

   !> Return the piece from a time [s] with the states y(:) at that time.
   function from(step, t, y) result(piece)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in), contiguous, target :: y(:)
      !! states
      type(step_view_t) :: piece

      piece = step
      piece%t_a = t
      piece%y_a => y
      nullify (piece%rates_a)
   end function from

   !> Shorten the last step of an integrator to a time inside it.
   subroutine shorten(step, t, error)
      type(step_view_t), intent(inout) :: step
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: y(size(step%y_a))

      call sample_state(step, t, y, error)
      if (allocated(error)) return
      step%t_b = t
      step%integrator%t1 = t
      step%integrator%y1(:) = y
   end subroutine shorten

   !> Compute the rates of a state in a step; those at its ends may be known.
   subroutine rates_in(step, t, y, rates)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) at t
      real(wp), intent(out) :: rates(:)
      !! (states)

      if (associated(step%rates_a) .and. t <= step%t_a) then
         rates = step%rates_a
      else if (associated(step%rates_b) .and. t >= step%t_b) then
         rates = step%rates_b
      else
         call rates_at(step%equation, t, y, rates)
      end if
   end subroutine rates_in

   !> Number of parts for the search of a step.
   !>
   !> In each part, frame and ground motion complete at most a quarter of their periods. A
   !> high-order method with a loose tolerance may take steps of a full period.
   integer function count_parts(step) result(n)
      type(step_view_t), intent(in) :: step
      integer, parameter :: most = 1000
      real(wp) :: quarter
      !! quarter of the shortest period [s]
      real(wp) :: first, second

      associate (equation => step%equation, motion => step%equation%motion, &
         interval => interval_of(step%equation))
         quarter = huge(quarter)
         if (equation%has_frame) quarter = pi/2/max(equation%p%omega_s, &
            equation%floors%max_frequency)
         first = turning_point(motion, interval, step%t_a)
         if (first < min(step%t_b, interval_end(motion, interval))) then
            second = turning_point(motion, interval, first)
            if (second < interval_end(motion, interval)) quarter = min(quarter, (second - first)/2)
         end if
      end associate
      n = max(1, ceiling(min((step%t_b - step%t_a)/quarter, real(most, wp))))
   end function count_parts

   !> Time at the end of one of n equal parts [s].
   pure real(wp) function end_of_part(step, i, n) result(t)
      type(step_view_t), intent(in) :: step
      integer, intent(in) :: i, n
      !! number of the part, from 1, and number of all parts

      t = step%t_b
      if (i < n) t = step%t_a + i*((step%t_b - step%t_a)/n)
   end function end_of_part

   !> Compute the state at a time inside the integrator's step, or copy it at the ends.
   subroutine sample_state(step, t, y, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states)
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails

      if (t <= step%integrator%t0) then
         y = step%integrator%y0
      else if (t >= step%integrator%t1) then
         y = step%integrator%y1
      else
         call step%integrator%state_at(t, y, error)
      end if
   end subroutine sample_state

   !> Accelerations theta'' or u'' at both ends.
   function accelerations(step) result(y_ddot)
      type(step_view_t), intent(in) :: step
      real(wp) :: y_ddot(2)

      y_ddot = [second_derivative(step%equation, step%t_a, step%y_a), &
         second_derivative(step%equation, step%t_b, step%y_b)]
   end function accelerations

   !> Phase angle of the fastest vibration of scene or ground in a duration, at least 1 [rad].
   pure real(wp) function fastest_angle(step, duration) result(angle)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: duration
      !! [s]
      real(wp) :: frequency

      associate (equation => step%equation)
         frequency = max(equation%p%omega_s, equation%floors%max_frequency, &
            fastest_rate(equation%motion))
         if (equation%has_wall) frequency = max(frequency, sqrt(equation%p%g_over_R))
      end associate
      angle = max(1.0_wp, duration*frequency)
   end function fastest_angle

   !> Return whether a step is short: its ground acceleration is monotone, and all phase angles in
   !> it are below a limit.
   pure logical function is_short(step, angle, frequency)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: angle
      !! [rad]
      real(wp), intent(in) :: frequency
      !! frequency of other moving parts [rad/s]

      associate (equation => step%equation)
         is_short = (step%t_b - step%t_a)*max(equation%p%omega_s, equation%floors%max_frequency, &
            frequency, turning_frequency(step)) < angle
         if (is_short) is_short = turning_point(equation%motion, interval_of(equation), step%t_a) &
            >= step%t_b
      end associate
   end function is_short

   !> Frequency with which forces of a wall change because it turns: they contain sines and cosines
   !> of twice its rotation. Near overturning this exceeds the frequencies of all vibrations.
   pure real(wp) function turning_frequency(step) result(frequency)
      type(step_view_t), intent(in) :: step

      frequency = 0
      if (step%equation%has_wall) frequency = 2*max(abs(step%y_a(2)), abs(step%y_b(2)))
   end function turning_frequency

end module rwmf_simulation_events_step_view
