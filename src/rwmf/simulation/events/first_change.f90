!> First sign change of a function of time and state inside the last step of an integrator.
!>
!> All functions of a kind (storey displacements, drifts, rotation) share the samples of values,
!> rates and second derivatives. A span is quiet if the polygon of each function
!> (`rwmf_math_sign_changes`) has no sign change beyond the interpolation error. Otherwise the
!> search halves the span, with a state interpolated by the integrator.
!>
!> Functions are in the caller's units.
module rwmf_simulation_events_first_change
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: close_in, secant_between, secant_t
   use rwmf_math_sign_changes, only: change_at_begin, changes_of, no_change, one_change, &
      polygon_t, rate_polygon, root_of, roughness, value_polygon
   use rwmf_simulation_events_step_view, only: fastest_angle, sample_state, step_view_t
   implicit none
   private

   public :: functions_t, moment_t, samples_t, span_t, watch_t, are_quiet, changes_in, &
      sample_functions, span_between, stop_at_change, stop_at_first, stop_at_root, value_at

   !> Values of the functions at one time.
   type :: moment_t
      real(wp) :: t
      !! [s]
      real(wp), allocatable :: f(:, :)
      !! (functions, 0:derivatives)
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
   type :: samples_t
      integer :: n = 0
      type(moment_t), allocatable :: moments(:)
   end type samples_t

   !> Functions of one kind in a step.
   type, abstract :: functions_t
      type(step_view_t) :: step
      type(samples_t), pointer :: samples => null()
      !! samples of this step; null: no storage
   contains
      procedure(evaluate_i), deferred :: evaluate
   end type functions_t

   abstract interface
      !> Evaluate functions at a state, with their first one or two time derivatives.
      subroutine evaluate_i(self, t, y, f)
         import :: functions_t, wp
         implicit none
         class(functions_t), intent(in) :: self
         real(wp), intent(in) :: t
         !! [s]
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp), allocatable, intent(out) :: f(:, :)
         !! (functions, 0:derivatives)
      end subroutine evaluate_i
   end interface

   !> Expected side of a level for a function or its rate.
   type :: watch_t
      integer :: which
      !! number of the function
      integer :: order
      !! order of the watched derivative: 0 for the value, 1 for the rate
      real(wp) :: level = 0
      real(wp) :: side = 1
      !! +1 for values at the level or above, -1 for values at the level or below
   end type watch_t

contains

   !> Sample the functions at a time of the step.
   subroutine sample_functions(functions, t, moment, error)
      class(functions_t), intent(in) :: functions
      real(wp), intent(in) :: t
      !! [s]
      type(moment_t), intent(out) :: moment
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
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
      moment%t = t
      call functions%evaluate(t, y, moment%f)
      if (associated(functions%samples)) call keep_moment(functions%samples, moment)
   end subroutine sample_functions

   !> Store a sample while there is space.
   pure subroutine keep_moment(samples, moment)
      type(samples_t), intent(inout) :: samples
      type(moment_t), intent(in) :: moment
      integer, parameter :: most = 256

      if (.not. allocated(samples%moments)) allocate (samples%moments(most))
      if (samples%n == most) return
      samples%n = samples%n + 1
      samples%moments(samples%n) = moment
   end subroutine keep_moment

   !> Span between two samples.
   !>
   !> The functions of a kind drive each other. A vibration that cancels in one of them at both ends
   !> appears in another, so the roughness of the least smooth one applies to all.
   function span_between(functions, a, b) result(span)
      class(functions_t), intent(in) :: functions
      type(moment_t), intent(in) :: a, b
      type(span_t) :: span
      real(wp) :: angle
      integer :: i

      span%a = a
      span%b = b
      do i = 0, 1
         span%largest(i) = max(maxval(abs(a%f(:, i))), maxval(abs(b%f(:, i))))
      end do
      angle = fastest_angle(functions%step, b%t - a%t)
      span%rough = 0
      do i = 1, size(a%f, 1)
         span%rough = max(span%rough, roughness(angle, b%t - a%t, a%f(i, :), b%f(i, :)))
      end do
   end function span_between

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

      changes = changes_of(polygon_in(span, watch), noise_in(span, watch))
   end function changes_in

   !> Return whether the ends of a span show that no watched function changes in it.
   pure logical function are_quiet(span, watches)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watches(:)
      integer :: i

      do i = 1, size(watches)
         are_quiet = changes_in(span, watches(i)) == no_change
         if (.not. are_quiet) return
      end do
      are_quiet = .true.
   end function are_quiet

   !> Round-off of a watched function.
   !>
   !> The functions of a kind are differences of the same states. The polygon of a rate contains
   !> five times the mean rate, which has large round-off in a short span. A reversal hidden by it
   !> changes the values only by round-off.
   pure real(wp) function noise_in(span, watch) result(noise)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      integer, parameter :: spacings = 8

      noise = max(abs(watch%level), span%largest(0))
      if (watch%order == 1) noise = span%largest(1) + 5*span%largest(0)/(span%b%t - span%a%t)
      noise = spacings*epsilon(noise)*noise
   end function noise_in

   !> Polygon of a watched function in a span.
   pure type(polygon_t) function polygon_in(span, watch) result(polygon)
      type(span_t), intent(in) :: span
      type(watch_t), intent(in) :: watch
      real(wp), dimension(0:ubound(span%a%f, 2)) :: a, b

      a = watch%side*span%a%f(watch%which, :)
      b = watch%side*span%b%f(watch%which, :)
      a(watch%order) = a(watch%order) - watch%side*watch%level
      b(watch%order) = b(watch%order) - watch%side*watch%level
      associate (h => span%b%t - span%a%t)
         if (watch%order == 0) then
            polygon = value_polygon(h, a, b, span%rough)
         else
            polygon = rate_polygon(h, a, b, span%rough)
         end if
      end associate
   end function polygon_in

   !> End a span at the first change of several watched functions. Each change shortens the span, so
   !> that the last one found is the first in time.
   subroutine stop_at_first(functions, watches, span, which, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watches(:)
      type(span_t), intent(inout) :: span
      integer, intent(out) :: which
      !! number of the watch; 0 if no function changes
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      logical :: is_found
      integer :: i

      which = 0
      do i = 1, size(watches)
         call stop_at_change(functions, watches(i), span, is_found, error)
         if (allocated(error)) return
         if (is_found) which = i
      end do
   end subroutine stop_at_first

   !> End a span at the first change of a watched function, if any: at the first moment beyond it.
   subroutine stop_at_change(functions, watch, span, is_found, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      logical, intent(out) :: is_found
      !! true if the function changes
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      integer, parameter :: most_halvings = 20
      !! largest number of halvings; an excursion in a shorter part is round-off
      integer, parameter :: most_samples = 100
      !! largest number of samples; further parts use only their ends, because the function is far
      !! smaller than others
      type(moment_t) :: ahead(0:most_halvings)
      type(span_t) :: part
      real(wp) :: smallest
      logical :: is_short
      integer :: depth, samples

      is_found = .false.
      if (.not. span%b%t > span%a%t) return
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
            part%b = part%a
            is_found = .true.
         case (one_change)
            is_found = .true.
         case default
            if (is_short) is_found = value_at(watch, part%b) < -noise_in(part, watch)
         end select
         if (is_found) exit
         if (is_short) then
            if (depth == 0) return
            depth = depth - 1
            part = span_between(functions, part%b, ahead(depth))
         else
            depth = depth + 1
            samples = samples + 1
            call sample_functions(functions, part%a%t + (part%b%t - part%a%t)/2, ahead(depth), &
               error)
            if (allocated(error)) return
            part = span_between(functions, part%a, ahead(depth))
         end if
      end do
      call stop_at_root(functions, watch, part, error)
      if (.not. allocated(error)) span = span_between(functions, span%a, part%b)
   end subroutine stop_at_change

   !> End a span at the first root of a function that is beyond its level at the span's end.
   !>
   !> The root is accurate to round-off of the time. If the function starts beyond its level, the
   !> span ends at its start.
   subroutine stop_at_root(functions, watch, span, error)
      class(functions_t), intent(in) :: functions
      type(watch_t), intent(in) :: watch
      type(span_t), intent(inout) :: span
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(secant_t) :: secant
      type(moment_t) :: now
      real(wp) :: first

      if (.not. value_at(watch, span%a) > 0) then
         span = span_between(functions, span%a, span%a)
         return
      end if
      associate (a => span%a, b => span%b)
         secant = secant_between([a%t, b%t], [value_at(watch, a), value_at(watch, b)])
         first = a%t + root_of(polygon_in(span, watch))*(b%t - a%t)
         if (first > a%t .and. first < b%t) secant%next = first
         do while (secant%is_open)
            call sample_functions(functions, secant%next, now, error)
            if (allocated(error)) return
            if (value_at(watch, now) <= 0) b = now
            if (abs(value_at(watch, now)) <= 0) exit
            call close_in(secant, value_at(watch, now))
         end do
      end associate
      span = span_between(functions, span%a, span%b)
   end subroutine stop_at_root

end module rwmf_simulation_events_first_change
