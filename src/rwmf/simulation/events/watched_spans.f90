!> Watched functions of time and state: samples at the ends of a span, and their changes in it.
!>
!> Functions of a kind declare their events as watches: value or rate, level, expected side and
!> consequence. All functions of a kind (storey displacements, drifts, rotation) share the samples
!> of values, rates and second derivatives.
!>
!> Functions are in the caller's units.
module rwmf_simulation_events_watched_spans
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_sign_changes, only: change_at_begin, changes_of, is_positive, newton_root_of, &
      no_change, one_change, polygon_t, rate_polygon, roughness, value_polygon
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_step_view, only: fastest_angle, sample_state, step_view_t
   implicit none
   private

   public :: functions_t, moment_t, kept_samples_t, span_t, watch_t
   public :: any_course, monotone, changed_at_begin, changed_at_end
   public :: sample_functions, take_moment, move_moment, derivatives_of
   public :: span_between, span_of, measure_span, measure_smoothness
   public :: value_at, changes_in, expect_change, noise_in, polygon_in

   integer, parameter :: spacings = 8
   !! round-off of the functions [spacings of their largest values]
   integer, parameter :: any_course = 0
   !! the function may change and return
   integer, parameter :: monotone = 1
   !! the function cannot return, so the end of a span shows its change
   integer, parameter :: changed_at_begin = 2
   !! the function changes at the beginning of the span
   integer, parameter :: changed_at_end = 3
   !! the function is zero at the end of the span

   !> Values of the functions at one time.
   type :: moment_t
      real(wp) :: t
      !! [s]
      real(wp), allocatable :: f(:, :)
      !! (functions, 0:derivatives)
      real(wp), allocatable :: y(:)
      !! (states) at an event of a state
   end type moment_t

   !> Functions in a span between two times.
   type :: span_t
      type(moment_t) :: a, b
      real(wp) :: rough
      !! `roughness` of the least smooth function
      real(wp) :: largest(0:1)
      !! largest value and rate at the ends
   end type span_t

   !> Stored samples of one step; consecutive searches of its functions share the halved spans.
   type :: kept_samples_t
      integer :: n = 0
      type(moment_t), allocatable :: moments(:)
   end type kept_samples_t

   !> Functions of one kind in a step. By default the function is a state.
   type :: functions_t
      type(step_view_t) :: step
      type(kept_samples_t), pointer :: samples => null()
      !! samples of this step; null: no storage
      integer :: n = 0
      !! number of functions with events
      integer :: derivatives = 2
      !! 1 if derivatives that cost an evaluation of the right-hand side are not required
      integer :: states(0:1) = 0
      !! numbers of the states that are the function and its rate; 0 if they are none. An event of a
      !! state is the root itself, any other the first moment beyond the root
   contains
      procedure :: evaluate => evaluate_state
      procedure :: watches => no_watches
   end type functions_t

   !> Expected side of a level for a function or its rate.
   type :: watch_t
      integer :: which
      !! number of the function
      integer :: order
      !! order of the watched derivative: 0 for the value, 1 for the rate
      real(wp) :: level = 0
      real(wp) :: side = 1
      !! +1 for values at the level or above, -1 for values at the level or below
      integer :: kind = 0
      !! event at the change: one of the `event_` numbers
      integer :: course = any_course
      !! `any_course`, `monotone`, `changed_at_begin` or `changed_at_end`
      logical :: starts_inside = .false.
      !! a state that starts on its level has its side at first, even if its rate contradicts it
   end type watch_t

contains

   !> Evaluate functions at a state, with their first one or two time derivatives. By default the
   !> function is a state.
   subroutine evaluate_state(self, t, y, f)
      class(functions_t), intent(in) :: self
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), allocatable, intent(out) :: f(:, :)
      !! (functions, 0:derivatives)
      real(wp) :: rates(size(y)), found(0:2)

      call rates_at(self%step%equation, t, y, rates)
      found = derivatives_of(self%states, y, rates)
      allocate (f(1, 0:merge(2, 1, self%states(1) > 0)))
      f(1, :) = found(:ubound(f, 2))
   end subroutine evaluate_state

   !> Function and its derivatives from states and rates; a second derivative that is unknown is 0.
   pure function derivatives_of(states, y, rates) result(f)
      integer, intent(in) :: states(0:1)
      !! as in `functions_t`
      real(wp), intent(in) :: y(:), rates(:)
      !! (states)
      real(wp) :: f(0:2)

      f = [y(states(0)), rates(states(0)), 0.0_wp]
      if (states(1) > 0) f(1:) = [y(states(1)), rates(states(1))]
   end function derivatives_of

   !> Declare the events of a function in a span. By default there is none.
   function no_watches(self, i, span) result(watches)
      class(functions_t), intent(in) :: self
      integer, intent(in) :: i
      !! number of the function
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)

      allocate (watches(0))
   end function no_watches

   !> Sample the functions at a time of the step.
   subroutine sample_functions(functions, t, moment, error)
      class(functions_t), intent(in) :: functions
      real(wp), intent(in) :: t
      !! [s]
      type(moment_t), intent(out) :: moment
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      integer, parameter :: most = 256
      !! number of samples that are kept
      real(wp) :: y(size(functions%step%y_a))
      integer :: i

      if (associated(functions%samples)) then
         do i = 1, functions%samples%n
            if (abs(functions%samples%moments(i)%t - t) > 0) cycle
            moment = functions%samples%moments(i)
            return
         end do
      end if
      call sample_state(functions%step, t, y, error)
      if (allocated(error)) return
      call take_moment(functions, t, y, moment)
      if (.not. associated(functions%samples)) return
      associate (samples => functions%samples)
         if (.not. allocated(samples%moments)) allocate (samples%moments(most))
         if (samples%n == most) return
         samples%n = samples%n + 1
         samples%moments(samples%n) = moment
      end associate
   end subroutine sample_functions

   !> Evaluate the functions at a state.
   subroutine take_moment(functions, t, y, moment)
      class(functions_t), intent(in) :: functions
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(moment_t), intent(out) :: moment

      moment%t = t
      call functions%evaluate(t, y, moment%f)
   end subroutine take_moment

   !> Move a sample.
   pure subroutine move_moment(from, to)
      type(moment_t), intent(inout) :: from
      type(moment_t), intent(inout) :: to

      to%t = from%t
      call move_alloc(from%f, to%f)
   end subroutine move_moment

   !> Span of a whole step.
   function span_of(functions) result(span)
      class(functions_t), intent(in) :: functions
      type(span_t) :: span

      associate (step => functions%step)
         call take_moment(functions, step%t_a, step%y_a, span%a)
         call take_moment(functions, step%t_b, step%y_b, span%b)
      end associate
      call measure_span(functions, span)
   end function span_of

   !> Span between two samples.
   function span_between(functions, a, b) result(span)
      class(functions_t), intent(in) :: functions
      type(moment_t), intent(in) :: a, b
      type(span_t) :: span

      span%a = a
      span%b = b
      call measure_span(functions, span)
   end function span_between

   !> Compute roughness and largest values of the functions in a span of a step.
   subroutine measure_span(functions, span)
      class(functions_t), intent(in) :: functions
      type(span_t), intent(inout) :: span

      call measure_smoothness(fastest_angle(functions%step, span%b%t - span%a%t), span)
   end subroutine measure_span

   !> Compute roughness and largest values of functions between two samples.
   !>
   !> The functions of a kind drive each other. A vibration that cancels in one of them at both ends
   !> appears in another, so the roughness of the least smooth one applies to all.
   pure subroutine measure_smoothness(angle, span)
      real(wp), intent(in) :: angle
      !! phase of the fastest vibration over the span, at least 1 [rad]
      type(span_t), intent(inout) :: span
      integer :: i

      associate (a => span%a, b => span%b)
         do i = 0, 1
            span%largest(i) = max(maxval(abs(a%f(:, i))), maxval(abs(b%f(:, i))))
         end do
         span%rough = 0
         do i = 1, size(a%f, 1)
            span%rough = max(span%rough, roughness(angle, b%t - a%t, a%f(i, :), b%f(i, :)))
         end do
      end associate
   end subroutine measure_smoothness

   !> Distance of a watched function from its level; negative on the unexpected side.
   pure real(wp) function value_at(watch, moment) result(value)
      type(watch_t), intent(in) :: watch
      type(moment_t), intent(in) :: moment

      value = watch%side*(moment%f(watch%which, watch%order) - watch%level)
   end function value_at

   !> Kind of change of a watched function in a span: a constant of `rwmf_math_sign_changes`.
   pure integer function changes_in(span, watch) result(changes)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp), dimension(0:ubound(span%a%f, 2)) :: a, b

      call see_from_level(span, watch, a, b)
      changes = no_change
      if (is_positive(span%b%t - span%a%t, a, b, span%rough, noise_in(span, watch), &
         watch%order)) return
      changes = changes_of(polygon_in(span, watch), noise_in(span, watch), noise_at_ends(span, &
         watch))
   end function changes_in

   !> Find the position of a change in a span from its ends alone.
   pure subroutine expect_change(span, watch, x, is_clear)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp), intent(out) :: x
      !! approximate position of a single change, from 0 to 1; the largest number without one [-]
      logical, intent(out) :: is_clear
      !! the ends show that the function has at most one change, and not at the beginning
      integer :: changes

      x = huge(x)
      select case (watch%course)
      case (changed_at_begin)
         changes = change_at_begin
      case (monotone)
         changes = merge(no_change, one_change, value_at(watch, span%b) >= 0)
         if (changes == one_change .and. .not. value_at(watch, span%a) > 0) changes = &
            change_at_begin
      case default
         changes = changes_in(span, watch)
      end select
      is_clear = changes == no_change .or. changes == one_change
      if (changes == one_change) x = newton_root_of(polygon_in(span, watch))
   end subroutine expect_change

   !> Values and derivatives of a watched function at both ends of a span, positive on its side of
   !> the level.
   pure subroutine see_from_level(span, watch, a, b)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp), intent(out) :: a(0:), b(0:)

      a(:) = watch%side*span%a%f(watch%which, :)
      b(:) = watch%side*span%b%f(watch%which, :)
      a(watch%order) = a(watch%order) - watch%side*watch%level
      b(watch%order) = b(watch%order) - watch%side*watch%level
   end subroutine see_from_level

   !> Round-off of a watched function.
   !>
   !> The functions of a kind are differences of the same states. Inside a span, the polygon of a
   !> rate contains five times the mean rate, which has large round-off in a short span. A reversal
   !> hidden by it changes the values only by round-off.
   pure real(wp) function noise_in(span, watch) result(noise)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch

      noise = max(abs(watch%level), span%largest(0))
      if (watch%order == 1) noise = span%largest(1) + 5*span%largest(0)/(span%b%t - span%a%t)
      noise = spacings*epsilon(noise)*noise
   end function noise_in

   !> Round-off of a watched function at the ends of a span: of its value and of the time.
   pure real(wp) function noise_at_ends(span, watch) result(noise)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp) :: fastest

      noise = noise_in(span, watch)
      if (watch%order == 0 .or. size(span%a%f, 2) < 3) return
      fastest = max(maxval(abs(span%a%f(:, 2))), maxval(abs(span%b%f(:, 2))))
      noise = min(noise, spacings*epsilon(noise)*(span%largest(1) + abs(span%b%t)*fastest))
   end function noise_at_ends

   !> Polygon of a watched function in a span.
   pure type(polygon_t) function polygon_in(span, watch) result(polygon)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp), dimension(0:ubound(span%a%f, 2)) :: a, b

      call see_from_level(span, watch, a, b)
      associate (h => span%b%t - span%a%t)
         if (watch%order == 0) then
            polygon = value_polygon(h, a, b, span%rough)
         else
            polygon = rate_polygon(h, a, b, span%rough)
         end if
      end associate
   end function polygon_in

end module rwmf_simulation_events_watched_spans
