!> Branch ends of yielding storeys, as watched functions of a step.
!>
!> Displacements show limits and reversals; hysteretic states of smooth storeys show where their
!> force passes zero.
module rwmf_simulation_events_storey_events
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: discrete_state_t, equation_t, model_t
   use rwmf_model_floor_motion, only: storey_accelerations, storey_motion
   use rwmf_model_floors_yielding_storeys, only: branch_limits, hysteretic_states, &
      is_softening, loading_direction_of, pass_storey_limit, settle_storeys, &
      side_beyond_zero, stands_still, start_storeys, stop_at_zero, storey_word, turn_storey
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_watched_spans, only: changed_at_begin, functions_t, monotone, &
      span_t, value_at, watch_t
   use rwmf_simulation_state_result, only: event_storey_limit, event_storey_turn, event_storey_zero
   implicit none
   private

   public :: displacements_t, hysteretic_t, end_branch, list_ends, zero_of
   public :: branch_limits, is_softening, loading_direction_of, pass_storey_limit, settle_storeys, &
      start_storeys, storey_word

   !> Displacements of the storeys [m], with rates and accelerations.
   type, extends(functions_t) :: displacements_t
   contains
      procedure :: evaluate => evaluate_storeys
      procedure :: watches => watch_storey
   end type displacements_t

   !> Hysteretic states of smooth storeys [-], with their rates.
   type, extends(functions_t) :: hysteretic_t
   contains
      procedure :: evaluate => evaluate_hysteretic
      procedure :: watches => watch_zero
   end type hysteretic_t

contains

   !> Evaluate the displacements of the storeys at a state.
   subroutine evaluate_storeys(self, t, y, f)
      class(displacements_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      associate (equation => self%step%equation)
         allocate (f(equation%floors%n_storeys, 0:self%derivatives))
         call storey_motion(equation, equation%state%side, y, f(:, 0), f(:, 1))
         if (self%derivatives < 2) return
         call rates_at(equation, t, y, y_dot)
         f(:, 2) = storey_accelerations(equation, equation%state%side, y, y_dot)
      end associate
   end subroutine evaluate_storeys

   !> Declare the events of a storey.
   function watch_storey(self, i, span) result(watches)
      class(displacements_t), intent(in) :: self
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)
      type(watch_t) :: list(2)
      integer :: n

      call list_ends(self%step%equation, i, span, list, n)
      watches = list(:n)
   end function watch_storey

   !> List the events of a storey: the start of its motion, a reversal, limits of its branch.
   pure subroutine list_ends(equation, i, span, watches, n)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(in) :: span
      !! displacements
      type(watch_t), intent(out) :: watches(2)
      integer, intent(out) :: n
      !! number of watches in the list
      real(wp) :: low, high
      integer :: direction
      real(wp) :: way

      n = 2
      if (stands_still(equation%state, i)) then
         ! Watch the start of a storey without previous motion. Its first nonzero derivative gives
         ! the direction.
         associate (a => span%a%f(i, :), b => span%b%f(i, :))
            way = a(2)
            if (abs(way) <= 0) way = a(size(a))
            if (size(a) < 3 .and. abs(way) <= 0) way = b(2)
            if (begins_at_rest(span, i)) way = b(2)
         end associate
         n = merge(1, 0, abs(way) > 0)
         if (n > 0) watches(1) = watch_t(i, 1, side=-sign(1.0_wp, way), kind=event_storey_turn, &
            course=changed_at_begin)
         return
      end if
      direction = loading_direction_of(equation, equation%state, i)
      call branch_limits(equation, i, low, high)
      if (direction /= 0) then
         if (direction < 0) high = low
         watches(1) = reversal(span, i, direction)
         watches(2) = watch_t(i, 0, level=high, side=real(-direction, wp), &
            kind=event_storey_limit, course=monotone)
      else
         ! a storey beyond a limit by round-off starts at the limit
         watches(1) = watch_t(i, 0, level=min(low, span%a%f(i, 0)), kind=event_storey_limit)
         watches(2) = watch_t(i, 0, level=max(high, span%a%f(i, 0)), side=-1.0_wp, &
            kind=event_storey_limit)
      end if
   end subroutine list_ends

   !> Reversal of a yielding storey.
   pure type(watch_t) function reversal(span, i, direction) result(watch)
      type(span_t), intent(in) :: span
      integer, intent(in) :: i
      !! number of the storey from the ground up
      integer, intent(in) :: direction
      !! sign of its rate

      watch = watch_t(i, 1, side=real(direction, wp), kind=event_storey_turn)
      if (.not. begins_at_rest(span, i)) return
      watch%course = monotone
      if (value_at(watch, span%b) < 0) watch%course = changed_at_begin
   end function reversal

   !> Return whether a storey starts with zero rate and acceleration, within round-off. The end of
   !> the span then gives its direction.
   pure logical function begins_at_rest(span, i)
      type(span_t), intent(in) :: span
      integer, intent(in) :: i
      !! number of the storey from the ground up
      integer, parameter :: spacings = 8

      begins_at_rest = ubound(span%a%f, 2) == 2
      if (.not. begins_at_rest) return
      associate (a => span%a%f(i, :), h => span%b%t - span%a%t)
         begins_at_rest = max(abs(a(2)), h*abs(a(3))) <= spacings*epsilon(h)*span%largest(1)
      end associate
   end function begins_at_rest

   !> Evaluate the hysteretic states at a state, and on request their rates.
   subroutine evaluate_hysteretic(self, t, y, f)
      class(hysteretic_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      associate (equation => self%step%equation)
         allocate (f(equation%floors%n_storeys, 0:1))
         f(:, 0) = hysteretic_states(equation, y)
         f(:, 1) = 0
         if (self%derivatives < 2) return
         call rates_at(equation, t, y, y_dot)
         f(:, 1) = hysteretic_states(equation, y_dot)
      end associate
   end subroutine evaluate_hysteretic

   !> Declare the zero of the hysteretic force of a smooth storey.
   function watch_zero(self, i, span) result(watches)
      class(hysteretic_t), intent(in) :: self
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)

      allocate (watches(0))
      if (side_beyond_zero(self%step%equation%state, i) /= 0) watches = [zero_of( &
         self%step%equation, i)]
   end function watch_zero

   !> Zero of the hysteretic force of a smooth storey, which is monotone before a reversal.
   pure type(watch_t) function zero_of(equation, i) result(watch)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: i
      !! number of a storey whose force passes zero

      watch = watch_t(i, 0, side=-real(side_beyond_zero(equation%state, i), wp), &
         kind=event_storey_zero, course=monotone)
   end function zero_of

   !> Move a storey to its next branch after a branch end.
   subroutine end_branch(model, state, ending, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      type(ending_t), intent(in) :: ending
      real(wp), intent(inout) :: y(:)
      !! (states)

      select case (ending%kind)
      case (event_storey_turn)
         call turn_storey(model, state, ending%number, ending%is_rising, y)
      case (event_storey_zero)
         call stop_at_zero(model, ending%number, y)
      case default
         call pass_storey_limit(model, state, ending%number, ending%is_rising)
      end select
   end subroutine end_branch

end module rwmf_simulation_events_storey_events
