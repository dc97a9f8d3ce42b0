!> Instants inside the last step of an integrator where a state passes a level, to round-off.
module rwmf_simulation_events_event_time
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, keep_inside, narrow
   use rwmf_model_assembly, only: rhs
   use rwmf_simulation_events_step_view, only: step_view_t
   implicit none
   private

   public :: find_event_time, passage

   integer, parameter :: most_iterations = 200
   !! a bisection of the whole range of exponents takes fewer

contains

   !> Find t in a piece of a step with y(component) = level.
   !>
   !> Newton's method from the polynomial through both ends, kept inside a bracket that every
   !> evaluation tightens. A short correction is carried out by Taylor's formula of second order,
   !> whose remainder is then round-off: mostly one state is asked of the integrator.
   subroutine find_event_time(step, component, level, t, y, error)
      type(step_view_t), intent(in) :: step
      !! at its end y - level has the other sign than at its beginning, or is zero
      integer, intent(in) :: component
      !! 1 for theta, 2 for theta', or the number of a further state
      real(wp), intent(in) :: level
      !! [rad], [rad/s] or of the further state
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states) there
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp), parameter :: short = 2.0e-7_wp
      !! part of the piece whose third power times a rate is round-off [-]
      type(bracket_t) :: bracket
      !! [s]
      real(wp) :: g, correction
      real(wp), dimension(size(y)) :: y_dot, slope_a, slope_b, bend
      logical :: is_falling
      !! y - level is positive at t_a, or zero there and negative at t_b
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
      ! A few spacings of the time are not nothing to a flight of a hundred: without this its impact
      ! would be faster than its start, and hardly damped chatter would never end.
      call rhs(step%equation, t, y, y_dot)
      correction = newton_correction(y(component) - level, y_dot(component), 0.0_wp)
      if (abs(correction) <= 2*spacing(t)) y = y + correction*y_dot
   end subroutine find_event_time

   !> Newton's correction, with the bend of the curve where it is slight; a vanishing rate gives one
   !> that leaves every bracket.
   pure real(wp) function newton_correction(g, rate, bend) result(correction)
      real(wp), intent(in) :: g, rate
      real(wp), intent(in) :: bend
      !! second derivative

      correction = huge(g)
      if (.not. abs(g) < abs(rate)*sqrt(huge(g))) return
      correction = -g/rate
      if (abs(correction*bend) < 0.1_wp*abs(rate)) correction = -g/(rate + correction/2*bend)
   end function newton_correction

   !> Powers of the position in a piece, from 0 to 1, of a state less a level: of theta as the
   !> polynomial of fifth order through both ends, their velocities and accelerations, of theta' as
   !> its derivative, of further states as a cubic.
   pure function polynomial_of(component, level, h, y_a, y_b, slope_a, slope_b) result(c)
      integer, intent(in) :: component
      real(wp), intent(in) :: level
      real(wp), intent(in) :: h
      !! length of the piece [s]
      real(wp), intent(in), dimension(:) :: y_a, y_b, slope_a, slope_b
      !! (states) at the ends, and their rates
      real(wp) :: c(0:5)
      real(wp) :: rise, turn, bend
      !! what the powers above the second make of value, slope and bend at the end
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

   !> Where a polynomial rises through zero between 0 and 1; the middle where it does not.
   pure real(wp) function passage(c) result(x)
      real(wp), intent(in) :: c(0:5)
      !! coefficients in powers of the place x
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
