!> Times inside the last step of an integrator at which a state passes a level, to round-off.
module rwmf_simulation_events_event_time
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, keep_inside, narrow
   use rwmf_model_system_assembly, only: rhs
   use rwmf_simulation_events_step_view, only: step_view_t
   implicit none
   private

   public :: find_event_time, passage

   integer, parameter :: most_iterations = 200
   !! bisection of the whole range of exponents takes fewer iterations

contains

   !> Find t in a piece of a step with y(component) = level.
   !>
   !> Newton's method starts from the polynomial through both ends, inside a bracket that every
   !> evaluation narrows. A second-order Taylor series applies a short correction, with a remainder
   !> at round-off. In most cases the integrator interpolates one state only.
   subroutine find_event_time(step, component, level, t, y, error)
      type(step_view_t), intent(in) :: step
      !! piece with opposite signs of y - level at both ends, or zero at its end
      integer, intent(in) :: component
      !! 1 for theta, 2 for theta', or the number of a further state
      real(wp), intent(in) :: level
      !! [rad], [rad/s] or in the unit of the further state
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states) at t
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp), parameter :: short = 2.0e-7_wp
      !! fraction of the piece whose third power times a rate is round-off [-]
      type(bracket_t) :: bracket
      !! [s]
      real(wp) :: g, correction
      real(wp), dimension(size(y)) :: y_dot, slope_a, slope_b, bend
      logical :: is_falling
      !! y - level is positive at t_a, or zero at t_a and negative at t_b
      integer :: i

      bracket = bracket_between(step%t_a, step%t_b)
      is_falling = step%y_a(component) > level &
         .or. (step%y_a(component) >= level .and. step%y_b(component) < level)
      call rhs(step%equation, step%t_a, step%y_a, slope_a)
      call rhs(step%equation, step%t_b, step%y_b, slope_b)
      associate (h => step%t_b - step%t_a)
         t = keep_inside(bracket, step%t_a + h*passage(merge(-1, 1, is_falling)*polynomial_of( &
            component, level, h, step%y_a, step%y_b, slope_a, slope_b)))
         do i = 1, most_iterations
            call step%integrator%state_at(t, y, error)
            if (allocated(error)) return
            g = y(component) - level
            if (abs(g) <= tiny(g)) return
            call narrow(bracket, (g > 0) .neqv. is_falling, t)
            if (.not. is_wider(bracket, 2)) exit
            call rhs(step%equation, t, y, y_dot)
            bend = (y_dot - slope_a)/max(t - step%t_a, tiny(t))
            bend(1) = y_dot(2)
            correction = newton_correction(g, y_dot(component), bend(component))
            if (abs(correction) <= short*h .and. t + correction >= step%t_a &
                .and. t + correction <= step%t_b) then
               t = t + correction
               y = y + correction*(y_dot + correction/2*bend)
               return
            end if
            t = keep_inside(bracket, t + correction)
         end do
      end associate
      t = bracket%high
      call step%integrator%state_at(t, y, error)
      if (allocated(error)) return
      ! A few spacings of the time matter to a flight of a hundred spacings. Without this
      ! correction, its impact would be faster than its start, and lightly damped chatter would
      ! never end.
      call rhs(step%equation, t, y, y_dot)
      correction = newton_correction(y(component) - level, y_dot(component), 0.0_wp)
      if (abs(correction) <= 2*spacing(t)) y = y + correction*y_dot
   end subroutine find_event_time

   !> Newton's correction with a slight curvature; for a vanishing rate it lies outside every
   !> bracket.
   pure real(wp) function newton_correction(g, rate, bend) result(correction)
      real(wp), intent(in) :: g, rate
      real(wp), intent(in) :: bend
      !! second derivative of the function

      correction = huge(g)
      if (.not. abs(g) < abs(rate)*sqrt(huge(g))) return
      correction = -g/rate
      if (abs(correction*bend) < 0.1_wp*abs(rate)) correction = -g/(rate + correction/2*bend)
   end function newton_correction

   !> Coefficients of y - level in powers of the position in a piece, from 0 to 1.
   !>
   !> For theta, the polynomial of fifth order fits rotation, velocity and acceleration at both
   !> ends. For theta' it is the derivative of that polynomial, and for further states a cubic.
   pure function polynomial_of(component, level, h, y_a, y_b, slope_a, slope_b) result(c)
      integer, intent(in) :: component
      real(wp), intent(in) :: level
      real(wp), intent(in) :: h
      !! length of the piece [s]
      real(wp), intent(in), dimension(:) :: y_a, y_b, slope_a, slope_b
      !! (states) at the ends, and their rates
      real(wp) :: c(0:5)
      real(wp) :: rise, turn, bend
      !! value, slope and second derivative at the end, without the powers up to the second
      integer :: i, k

      k = merge(1, component, component == 2)
      c = 0
      c(0) = y_a(k)
      c(1) = h*slope_a(k)
      turn = h*slope_b(k) - c(1)
      rise = y_b(k) - c(0) - c(1)
      if (component > 2) then
         c(2:3) = [3*rise - turn, turn - 2*rise]
      else
         c(2) = h*h*slope_a(2)/2
         rise = rise - c(2)
         turn = turn - 2*c(2)
         bend = h*h*slope_b(2) - 2*c(2)
         c(3:) = [10*rise - 4*turn + bend/2, 7*turn - 15*rise - bend, 6*rise - 3*turn + bend/2]
      end if
      if (component == 2) c = [(i*c(i)/h, i=1, 5), 0.0_wp]
      c(0) = y_a(component) - level
   end function polynomial_of

   !> Position between 0 and 1 where a polynomial rises through zero; 0.5 if there is none.
   pure real(wp) function passage(c) result(x)
      real(wp), intent(in) :: c(0:5)
      !! coefficients in powers of the position x
      real(wp), parameter :: resolution = 1.0e-10_wp
      type(bracket_t) :: bracket
      real(wp) :: value, slope, last
      integer :: i

      bracket = bracket_between(0.0_wp, 1.0_wp)
      x = bracket%middle
      if (.not. sum(c) > 0) return
      x = keep_inside(bracket, c(0)/(c(0) - sum(c)))
      do i = 1, most_iterations
         value = c(0) + x*(c(1) + x*(c(2) + x*(c(3) + x*(c(4) + x*c(5)))))
         slope = c(1) + x*(2*c(2) + x*(3*c(3) + x*(4*c(4) + x*5*c(5))))
         call narrow(bracket, value >= 0, x)
         last = x
         x = x + newton_correction(value, slope, 0.0_wp)
         if (abs(x - last) <= resolution) return
         x = keep_inside(bracket, x)
         if (.not. bracket%is_open) return
      end do
   end function passage

end module rwmf_simulation_events_event_time
