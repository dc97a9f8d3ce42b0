!> First event inside the last step of an integrator: a sign change of a watched function.
!>
!> One search serves the functions of all kinds, and one rule decides whether a step has no event.
!> A span is quiet if the polygon of each function (`rwmf_math_sign_changes`) has no sign change
!> beyond the interpolation error. Otherwise the search halves the span, with a state interpolated
!> by the integrator.
module rwmf_simulation_events_first_change
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: dp, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, close_in, keep_inside, narrow, &
      secant_between, secant_t
   use rwmf_math_sign_changes, only: change_at_begin, newton_root_of, no_change, one_change, root_of
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, sample_state, shorten, &
      step_view_t
   use rwmf_simulation_events_watched_spans, only: changed_at_begin, changed_at_end, changes_in, &
      derivatives_of, functions_t, measure_span, moment_t, monotone, move_moment, noise_in, &
      polygon_in, sample_functions, span_between, span_t, take_moment, value_at, watch_t
   implicit none
   private

   public :: ending_t
   public :: find_event, shows_no_event, stop_at_change, stop_at_event

   !> Event that ends a step.
   type :: ending_t
      integer :: kind = 0
      !! one of the `event_` numbers; 0 without an event
      integer :: number = 0
      !! number of the watched function: storey from the ground up, drift, side of the wall
      real(wp) :: t = huge(1.0_wp)
      !! [s]
      logical :: is_rising = .false.
      !! the rotation or the watched function increases through its level
      real(wp), allocatable :: y(:)
      !! (states) at the event, if the functions know them
   end type ending_t

contains

   !> Return whether the ends of a step show that no event of the functions lies in it.
   !>
   !> The cubics through values and rates show it in most steps, the quintics with second
   !> derivatives in nearly all.
   logical function shows_no_event(functions, step) result(is_quiet)
      class(functions_t), intent(inout) :: functions
      type(step_view_t), intent(in) :: step
      type(moment_t) :: a, b
      type(span_t) :: span
      integer :: derivatives, i

      functions%step = step
      a%t = step%t_a
      b%t = step%t_b
      do derivatives = 1, 2
         functions%derivatives = derivatives
         call functions%evaluate(a%t, step%y_a, a%f)
         call functions%evaluate(b%t, step%y_b, b%f)
         span = span_between(functions, a, b)
         is_quiet = .true.
         do i = 1, functions%n
            is_quiet = are_quiet(span, functions%watches(i, span))
            if (.not. is_quiet) exit
         end do
         if (is_quiet .or. ubound(a%f, 2) < derivatives) exit
      end do
      functions%derivatives = 2
   end function shows_no_event

   !> End a step at the first event of the functions, if any.
   subroutine stop_at_event(functions, step, ending, error)
      class(functions_t), intent(inout) :: functions
      type(step_view_t), intent(inout) :: step
      type(ending_t), intent(inout) :: ending
      !! event at the end of the step
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      logical :: is_found

      if (count_parts(step) == 1) then
         if (shows_no_event(functions, step)) return
      end if
      allocate (functions%samples)
      call find_event(functions, step, ending, is_found, error)
      deallocate (functions%samples)
      if (is_found .and. .not. allocated(error)) call shorten(step, ending%t, error)
   end subroutine stop_at_event

   !> Find the first event of the functions in a step, part by part.
   subroutine find_event(functions, step, ending, is_found, error)
      class(functions_t), intent(inout) :: functions
      type(step_view_t), intent(in) :: step
      type(ending_t), intent(inout) :: ending
      !! on return the event of the functions, if it precedes the given one
      logical, intent(out) :: is_found
      !! true if an event precedes the given one
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(span_t) :: span
      integer :: parts, i, k

      is_found = .false.
      functions%step = step
      parts = count_parts(step)
      call take_moment(functions, step%t_a, step%y_a, span%a)
      do i = 1, parts
         if (i < parts) then
            call sample_functions(functions, end_of_part(step, i, parts), span%b, error)
            if (allocated(error)) return
         else
            call take_moment(functions, step%t_b, step%y_b, span%b)
         end if
         call measure_span(functions, span)
         do k = 1, functions%n
            call stop_at_first(functions, functions%watches(k, span), span, ending, is_found, error)
            if (allocated(error)) return
         end do
         if (is_found) return
         if (i < parts) call move_moment(span%b, span%a)
      end do
   end subroutine find_event

   !> Return whether the ends of a span show that no watched function changes in it.
   pure logical function are_quiet(span, watches)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watches(:)
      integer :: i

      are_quiet = .true.
      do i = 1, size(watches)
         select case (watches(i)%course)
         case (changed_at_begin, changed_at_end)
            are_quiet = .false.
         case (monotone)
            are_quiet = value_at(watches(i), span%b) >= 0
         case default
            are_quiet = changes_in(span, watches(i)) == no_change
         end select
         if (.not. are_quiet) return
      end do
   end function are_quiet

   !> End a span at the first change of several watches. Each change shortens the span, so that the
   !> last one found is the first in time.
   subroutine stop_at_first(functions, watches, span, ending, is_found, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watches(:)
      type(span_t), intent(inout) :: span
      type(ending_t), intent(inout) :: ending
      logical, intent(inout) :: is_found
      !! on return also true if a watch changes
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      logical :: changes
      integer :: i

      do i = 1, size(watches)
         associate (watch => watches(i))
            select case (watch%course)
            case (changed_at_begin)
               changes = .true.
               span%b = span%a
            case (changed_at_end)
               changes = .true.
               call add_states(functions, watch, span%b, error)
            case (monotone)
               changes = value_at(watch, span%b) < 0
               if (changes) call stop_at_root(functions, watch, span, error)
            case default
               call stop_at_change(functions, watch, span, changes, error)
            end select
            if (allocated(error)) return
            if (.not. (changes .and. span%b%t < ending%t)) cycle
            ending = ending_t(watch%kind, watch%which, span%b%t, watch%side < 0)
            if (allocated(span%b%y)) call move_alloc(span%b%y, ending%y)
            is_found = .true.
         end associate
      end do
   end subroutine stop_at_first

   !> End a span at the first change of a watched function, if any.
   !>
   !> The end is the first moment beyond the change, or the root of a state.
   subroutine stop_at_change(functions, watch, span, is_found, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      logical, intent(out) :: is_found
      !! true if the function changes
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      integer :: changes

      is_found = .false.
      if (.not. span%b%t > span%a%t) return
      changes = changes_in(span, watch)
      is_found = changes == one_change
      if (is_found) then
         call stop_at_root(functions, watch, span, error)
      else if (changes /= no_change) then
         call search_halves(functions, watch, span, is_found, error)
      end if
   end subroutine stop_at_change

   !> End a span at the first change of a watched function by halving, if any.
   subroutine search_halves(functions, watch, span, is_found, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      logical, intent(inout) :: is_found
      !! false; on return true if the function changes
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_halvings = 20
      !! largest number of halvings; an excursion in a shorter part is round-off
      integer, parameter :: most_samples = 100
      !! largest number of samples; further parts use only their ends, because the function is far
      !! smaller than others
      type(moment_t) :: ahead(0:most_halvings)
      type(span_t) :: part
      real(wp) :: smallest
      logical :: is_short, is_state
      integer :: depth, samples

      is_state = functions%states(watch%order) > 0
      smallest = max((span%b%t - span%a%t)*0.5_wp**most_halvings, 4*spacing(span%b%t))
      part = span
      ahead(0) = span%b
      depth = 0
      samples = 0
      do
         is_short = part%b%t - part%a%t <= 1.5_wp*smallest .or. samples == most_samples
         select case (changes_in(part, watch))
         case (no_change)
            is_short = .true.
         case (change_at_begin)
            is_found = .true.
            if (is_state .and. value_at(watch, part%a) > 0) then
               ! the value is below the round-off of the polygon, but a state on its level is exact
               is_short = .true.
               is_found = value_at(watch, part%b) < 0
            else if (watch%starts_inside .and. (value_at(watch, part%b) >= 0 &
               .or. .not. is_short)) then
               is_found = .false.
               is_short = value_at(watch, part%b) >= 0
            else
               part%b = part%a
            end if
         case (one_change)
            is_found = .true.
         case default
            if (is_short) is_found = value_at(watch, part%b) < merge(0.0_wp, -noise_in(part, &
               watch), is_state)
         end select
         if (is_found) exit
         if (is_short) then
            if (depth == 0) return
            depth = depth - 1
            call move_moment(part%b, part%a)
         else
            depth = depth + 1
            samples = samples + 1
            call sample_functions(functions, part%a%t + (part%b%t - part%a%t)/2, ahead(depth), &
               error)
            if (allocated(error)) return
         end if
         part%b = ahead(depth)
         call measure_span(functions, part)
      end do
      call stop_at_root(functions, watch, part, error)
      if (allocated(error)) return
      span%b = part%b
      if (.not. is_state) call measure_span(functions, span)
   end subroutine search_halves

   !> End a span at the first root of a function that is beyond its level at the span's end.
   !>
   !> The root is accurate to round-off of the time. If the function starts beyond its level, the
   !> span ends at its start. The span is measured again, except for states: their further watches
   !> are monotone.
   subroutine stop_at_root(functions, watch, span, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(secant_t) :: secant
      type(moment_t) :: now
      real(wp) :: first

      associate (a => span%a, b => span%b)
         if (begins_beyond(watch, a)) then
            b = a
            call add_states(functions, watch, b, error)
         else if (functions%states(watch%order) > 0) then
            call stop_at_state(functions, watch, span, error)
         else
            ! a function that starts on its level has positive values before the root
            secant = secant_between([a%t, b%t], [abs(value_at(watch, a)), value_at(watch, b)])
            first = a%t + root_of(polygon_in(span, watch))*(b%t - a%t)
            if (first > a%t .and. first < b%t) secant%next = first
            do while (secant%is_open)
               call sample_functions(functions, secant%next, now, error)
               if (allocated(error)) return
               if (value_at(watch, now) <= 0) b = now
               if (abs(value_at(watch, now)) <= 0) exit
               call close_in(secant, value_at(watch, now))
            end do
            call measure_span(functions, span)
         end if
      end associate
   end subroutine stop_at_root

   !> Add the states to a sample on the level of a watched state.
   subroutine add_states(functions, watch, moment, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(moment_t), intent(inout) :: moment
      type(error_t), allocatable, intent(out) :: error

      associate (step => functions%step, state => functions%states(watch%order))
         if (state == 0) return
         moment%y = step%y_a
         if (moment%t >= step%t_b) then
            moment%y = step%y_b
         else if (moment%t > step%t_a) then
            call sample_state(step, moment%t, moment%y, error)
         end if
         moment%y(state) = watch%level
         moment%f(watch%which, watch%order) = watch%level
      end associate
   end subroutine add_states

   !> End a span at the root of a state, with all states there.
   !>
   !> A second-order Taylor series makes the last short correction. A few spacings of the time
   !> matter to a flight of a hundred spacings. Without this correction, its impact would be faster
   !> than its start, and lightly damped chatter would never end.
   subroutine stop_at_state(functions, watch, span, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: short = 2.0e-7_wp*(epsilon(1.0_wp)/epsilon(1.0_dp))**0.4_wp
      !! fraction of the span whose third power times a rate is round-off [-]
      integer, parameter :: most_points = 200
      type(bracket_t) :: bracket
      real(wp), dimension(size(functions%step%y_a)) :: y, rates, rates_a
      real(wp) :: f(0:2), t, correction
      integer :: i

      associate (a => span%a, b => span%b, step => functions%step, k => watch%order)
         bracket = bracket_between(a%t, b%t)
         t = keep_inside(bracket, a%t + newton_root_of(polygon_in(span, watch))*(b%t - a%t))
         do i = 1, most_points
            if (i == most_points .or. .not. bracket%is_open) t = bracket%high
            call sample_state(step, t, y, error)
            if (allocated(error)) return
            call rates_at(step%equation, t, y, rates)
            f = derivatives_of(functions%states, y, rates)
            correction = 0
            if (abs(f(k) - watch%level) <= 0 .or. t >= bracket%high) exit
            call narrow(bracket, watch%side*(f(k) - watch%level) <= 0, t)
            correction = correction_at(watch, t, f, a, functions%states(1) > 0)
            if (abs(correction) <= max(short*(b%t - a%t), 2*epsilon(t)*abs(t)) &
                .and. t + correction >= bracket%low .and. t + correction <= bracket%high) exit
            t = keep_inside(bracket, t + correction)
         end do
         if (abs(correction) > 0) then
            call rates_at(step%equation, step%t_a, step%y_a, rates_a)
            y = y + correction*(rates + correction/2*(rates - rates_a)/max(t - step%t_a, tiny(t)))
         end if
         y(functions%states(k)) = watch%level
         b%t = t + correction
         b%y = y
         f = derivatives_of(functions%states, y, rates)
         b%f(1, :) = f(:ubound(b%f, 2))
      end associate
   end subroutine stop_at_state

   !> Distance from a point to the root of the parabola through it; `huge` if its rate leads away
   !> from the level. The rate of a state with errors may contradict the values around it.
   pure real(wp) function correction_at(watch, t, f, a, has_bend) result(correction)
      type(watch_t), intent(in) :: watch
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: f(0:2)
      !! function and derivatives at the point
      type(moment_t), intent(in) :: a
      !! start of the span
      logical, intent(in) :: has_bend
      !! the second derivative of the function is known
      real(wp) :: bend

      correction = huge(t)
      if (watch%side*f(watch%order + 1) >= 0) return
      associate (k => watch%order, h => max(t - a%t, tiny(t)))
         if (k == 0 .and. has_bend) then
            bend = f(2)
         else
            ! of the cubic through values and rates at both times
            bend = (4*f(k + 1) + 2*a%f(1, k + 1) - 6*((f(k) - a%f(1, k))/h))/h
         end if
         correction = correction_of(f(k) - watch%level, f(k + 1), bend)
      end associate
   end function correction_at

   !> Return whether a function starts beyond its level, or at its level and goes beyond it.
   pure logical function begins_beyond(watch, moment)
      type(watch_t), intent(in) :: watch
      type(moment_t), intent(in) :: moment
      integer :: k

      begins_beyond = .not. value_at(watch, moment) > 0
      if (.not. begins_beyond) return
      do k = watch%order + 1, ubound(moment%f, 2)
         associate (rate => watch%side*moment%f(watch%which, k))
            begins_beyond = .not. rate > 0
            if (abs(rate) > 0) return
         end associate
      end do
   end function begins_beyond

   !> Distance to the near root of the parabola with a value, rate and second derivative; `huge`
   !> without a root.
   pure real(wp) function correction_of(g, rate, bend) result(correction)
      real(wp), intent(in) :: g, rate
      real(wp), intent(in) :: bend
      !! second derivative
      real(wp) :: slope

      correction = huge(g)
      slope = rate**2 - 2*g*bend
      if (slope < 0) return
      ! slope of the chord up to the root
      slope = (rate + sign(sqrt(slope), rate))/2
      if (abs(g) < abs(slope)*sqrt(huge(g))) correction = -g/slope
   end function correction_of

end module rwmf_simulation_events_first_change
