!> Instants inside the last step of an integrator: where a state passes a level, to round-off, and
!> where theta' turns unseen between the ends.
module rwmf_simulation_events_event_time
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, keep_inside, narrow, &
      stationary_point
   use rwmf_model_assembly, only: rhs
   use rwmf_simulation_events_step_view, only: accelerations, may_reverse, step_view_t
   implicit none
   private

   public :: find_event_time, find_reversal

   integer, parameter :: most_iterations = 200
   !! a bisection of the whole range of exponents takes fewer

contains

   !> Find t in a piece of a step with y(component) = level.
   !>
   !> Newton's method from the inverse cubic through both ends, kept inside a bracket that every
   !> evaluation tightens. A correction below sqrt(epsilon) of the step is carried out by Taylor's
   !> formula, whose remainder is then round-off: usually two states are asked of the integrator.
   subroutine find_event_time(step, component, level, t, y, error)
      type(step_view_t), intent(in) :: step
      !! at its end y - level has the other sign than at its beginning, or is zero
      integer, intent(in) :: component
      !! 1: theta, 2: theta', or a further state
      real(wp), intent(in) :: level
      !! [rad], [rad/s] or of the further state
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: y(:)
      !! (states) there
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      !! [s]
      real(wp) :: g, correction
      real(wp) :: y_dot(size(y))
      logical :: is_falling
      !! y - level is positive at t_a, or zero there and negative at t_b
      integer :: i

      bracket = bracket_between(step%t_a, step%t_b)
      is_falling = step%y_a(component) > level &
         .or. (step%y_a(component) >= level .and. step%y_b(component) < level)
      t = first_guess(step, component, level)
      do i = 1, most_iterations
         call step%integrator%state_at(t, y, error)
         if (allocated(error)) return
         g = y(component) - level
         if (abs(g) <= tiny(g)) return
         call narrow(bracket, (g > 0) .neqv. is_falling, t)
         if (.not. is_wider(bracket, 2)) exit
         call rhs(step%equation, t, y, y_dot)
         correction = newton_correction(g, y_dot(component))
         if (abs(correction) <= sqrt(epsilon(g))/10*(step%t_b - step%t_a) &
             .and. t + correction >= step%t_a .and. t + correction <= step%t_b) then
            t = t + correction
            y = y + correction*y_dot
            return
         end if
         t = keep_inside(bracket, t + correction)
      end do
      t = bracket%high
      call step%integrator%state_at(t, y, error)
      if (allocated(error)) return
      ! A few spacings of the time are not nothing to a flight of a hundred: without this its impact
      ! would be faster than its start, and hardly damped chatter would never end.
      call rhs(step%equation, t, y, y_dot)
      correction = newton_correction(y(component) - level, y_dot(component))
      if (abs(correction) <= 2*spacing(t)) y = y + correction*y_dot
   end subroutine find_event_time

   !> Newton's correction; a vanishing rate gives one that leaves every bracket.
   pure real(wp) function newton_correction(g, rate) result(correction)
      real(wp), intent(in) :: g, rate

      correction = huge(g)
      if (abs(g) < abs(rate)*sqrt(huge(g))) correction = -g/rate
   end function newton_correction

   !> Time as the cubic function of the state through both ends, at the level [s].
   real(wp) function first_guess(step, component, level) result(t)
      type(step_view_t), intent(in) :: step
      integer, intent(in) :: component
      real(wp), intent(in) :: level
      real(wp), dimension(size(step%y_a)) :: slope_a, slope_b
      real(wp) :: h, rise
      real(wp) :: x
      !! position between the end values [-]
      real(wp) :: s_a, s_b
      !! slopes of time over state, per unit of x [s]

      h = step%t_b - step%t_a
      t = step%t_a + h/2
      rise = step%y_b(component) - step%y_a(component)
      if (abs(rise) <= tiny(rise)) return
      x = (level - step%y_a(component))/rise
      call rhs(step%equation, step%t_a, step%y_a, slope_a)
      call rhs(step%equation, step%t_b, step%y_b, slope_b)
      ! A slope far from the secant's means that time is no smooth function of the state here.
      s_a = inverse_slope(slope_a(component))
      s_b = inverse_slope(slope_b(component))
      t = step%t_a + x*h + x*(1 - x)*((1 - x)*(s_a - h) - x*(s_b - h))
      if (.not. (t > step%t_a .and. t < step%t_b)) t = step%t_a + x*h
      if (.not. (t > step%t_a .and. t < step%t_b)) t = step%t_a + h/2

   contains

      !> Slope of the time from that of the state; one that vanishes has the sign of the rise, so
      !> that the mirrored motion gives the mirrored bits.
      pure real(wp) function inverse_slope(slope)
         real(wp), intent(in) :: slope

         inverse_slope = max(abs(slope), abs(rise)/(4*h))
         inverse_slope = abs(rise)/inverse_slope
         if (slope*rise < 0) inverse_slope = -inverse_slope
      end function inverse_slope
   end function first_guess

   !> Does theta' pass through zero and back between two times at which it has the same sign? Only
   !> where the rotation says that it may, slopes and a state are evaluated.
   subroutine find_reversal(step, t, y, found, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(out) :: t
      !! when found: a time between both sign changes [s]
      real(wp), intent(out) :: y(:)
      !! (states) there
      logical, intent(out) :: found
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: h
      real(wp) :: v(2)
      !! theta' at the ends, not negative [rad/s]
      real(wp) :: slope(2)
      !! of it over the span [rad/s]

      found = .false.
      associate (y_a => step%y_a, y_b => step%y_b)
         h = step%t_b - step%t_a
         v = abs([y_a(2), y_b(2)])
         if (.not. may_reverse(sign(1.0_wp, y_a(2) + y_b(2))*(y_b(1) - y_a(1)), v, h)) return
         slope = accelerations(step)*sign(h, y_a(2) + y_b(2))
         if (slope(1) >= 0 .or. slope(2) <= 0) return
         t = step%t_a + stationary_point(v(1), slope(1), v(2), slope(2))*h
         call step%integrator%state_at(t, y, error)
         if (allocated(error)) return
         found = y(2)*(y_a(2) + y_b(2)) < 0
      end associate
   end subroutine find_reversal

end module rwmf_simulation_events_event_time
