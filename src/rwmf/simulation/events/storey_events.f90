!> Branch ends of yielding storeys inside the last step of an integrator.
!>
!> The search ends the step at the first branch end, so that all later searches use one smooth
!> equation.
module rwmf_simulation_events_storey_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: rates_at
   use rwmf_model_effects_storeys_yielding_storeys, only: branch_limits, hysteretic_states, &
      is_softening, loading_direction_of, pass_storey_limit, side_beyond_zero, stands_still, &
      stop_at_zero, storey_word, turn_storey
   use rwmf_model_equation, only: discrete_state_t, model_t
   use rwmf_model_floor_motion, only: storey_accelerations, storey_motion
   use rwmf_simulation_events_first_change, only: are_quiet, functions_t, moment_t, &
      sample_functions, samples_t, span_between, span_t, stop_at_change, stop_at_first, &
      stop_at_root, value_at, watch_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, sample_state, step_view_t
   implicit none
   private

   public :: storey_end_t, displacements_t, stop_at_storey, end_branch, is_quiet
   public :: branch_limits, is_softening, loading_direction_of, pass_storey_limit, storey_word

   !> Displacements of the storeys [m], with rates and accelerations.
   type, extends(functions_t) :: displacements_t
      integer :: derivatives = 2
      !! number of required derivatives; the second costs an evaluation of the right-hand side
   contains
      procedure :: evaluate => evaluate_storeys
   end type displacements_t

   !> Hysteretic states of smooth storeys [-], with their rates.
   type, extends(functions_t) :: hysteretic_t
   contains
      procedure :: evaluate => evaluate_hysteretic
   end type hysteretic_t

   !> Branch end of a storey, or end of the motion.
   type :: storey_end_t
      integer :: storey = 0
      !! number of the storey from the ground up; 0 without an event
      real(wp) :: t = huge(1.0_wp)
      !! [s]
      logical :: turns = .false.
      !! the storey unloads, or starts to move
      logical :: passes_zero = .false.
      !! the hysteretic force passes zero; otherwise the storey reaches a limit
      logical :: is_rising = .false.
      !! the displacement increases after the event
      logical :: collapses = .false.
      !! `storey` is the number of a drift that exceeds its limit
   end type storey_end_t

contains

   !> Evaluate the displacements of the storeys at a state.
   subroutine evaluate_storeys(self, t, y, f)
      class(displacements_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      associate (equation => self%step%equation)
         allocate (f(equation%floors%storeys, 0:self%derivatives))
         call storey_motion(equation, equation%state%side, y, f(:, 0), f(:, 1))
         if (self%derivatives < 2) return
         call rates_at(equation, t, y, y_dot)
         f(:, 2) = storey_accelerations(equation, equation%state%side, y, y_dot)
      end associate
   end subroutine evaluate_storeys

   !> Evaluate the hysteretic states at a state.
   subroutine evaluate_hysteretic(self, t, y, f)
      class(hysteretic_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      associate (equation => self%step%equation)
         allocate (f(equation%floors%storeys, 0:1))
         call rates_at(equation, t, y, y_dot)
         f(:, 0) = hysteretic_states(equation, y)
         f(:, 1) = hysteretic_states(equation, y_dot)
      end associate
   end subroutine evaluate_hysteretic

   !> End the last step of the integrator at the first branch end.
   subroutine stop_at_storey(step, found, error)
      type(step_view_t), intent(inout) :: step
      type(storey_end_t), intent(out) :: found
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(displacements_t) :: storeys
      type(samples_t), target :: samples
      type(moment_t) :: a, b
      type(span_t) :: span
      real(wp) :: y(size(step%y_a))
      integer :: n, i

      n = count_parts(step)
      if (n == 1) then
         if (is_quiet(step)) return
      end if
      storeys%step = step
      storeys%samples => samples
      call sample_functions(storeys, step%t_a, b, error)
      do i = 1, n
         a = b
         if (allocated(error)) return
         call sample_functions(storeys, end_of_part(step, i, n), b, error)
         if (allocated(error)) return
         span = span_between(storeys, a, b)
         call search_storeys(storeys, span, found, error)
         if (allocated(error)) return
         if (found%storey > 0) exit
      end do
      if (found%storey == 0) return
      call step%integrator%state_at(found%t, y, error)
      step%t_b = found%t
      step%integrator%t1 = found%t
      step%integrator%y1(:) = y
   end subroutine stop_at_storey

   !> Return whether the ends of a step show that no branch ends in it.
   !>
   !> The cubics through displacements and rates show it in most steps, the quintics with
   !> accelerations in nearly all.
   logical function is_quiet(step)
      type(step_view_t), intent(in) :: step
      type(displacements_t) :: storeys
      type(moment_t) :: a, b
      type(span_t) :: span
      integer :: derivatives, i

      storeys%step = step
      a%t = step%t_a
      b%t = step%t_b
      do derivatives = 1, 2
         storeys%derivatives = derivatives
         call storeys%evaluate(a%t, step%y_a, a%f)
         call storeys%evaluate(b%t, step%y_b, b%f)
         span = span_between(storeys, a, b)
         do i = 1, step%equation%floors%storeys
            is_quiet = stays_on_branch(storeys, i, span)
            if (.not. is_quiet) exit
         end do
         if (is_quiet) exit
      end do
      if (.not. is_quiet) return
      associate (z => hysteretic_states(step%equation, step%y_b))
         do i = 1, size(z)
            ! z is monotone if the storey does not turn
            is_quiet = side_beyond_zero(step%equation%state, i)*z(i) <= 0
            if (.not. is_quiet) return
         end do
      end associate
   end function is_quiet

   !> Return whether the displacement of a storey certainly stays on its branch in a span.
   logical function stays_on_branch(storeys, i, span) result(stays)
      type(displacements_t), intent(in) :: storeys
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(in) :: span
      integer :: direction
      real(wp) :: limit(2)

      associate (equation => storeys%step%equation, a => span%a, b => span%b)
         if (stands_still(equation%state, i)) then
            stays = all(abs(b%f(i, 1:)) <= 0) .and. all(abs(a%f(i, 1:)) <= 0)
            return
         end if
         direction = loading_direction_of(equation, equation%state, i)
         if (direction == 0) then
            stays = are_quiet(span, watches_of_limits(storeys, i, a))
         else
            stays = are_quiet(span, [watch_t(i, 1, side=real(direction, wp))])
            call branch_limits(equation, i, limit(1), limit(2))
            stays = stays .and. direction*b%f(i, 0) <= direction*limit((3 + direction)/2)
         end if
      end associate
   end function stays_on_branch

   !> Limits of an elastic storey. A storey beyond a limit by round-off starts at the limit.
   function watches_of_limits(storeys, i, a) result(watch)
      type(displacements_t), intent(in) :: storeys
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(moment_t), intent(in) :: a
      type(watch_t) :: watch(2)
      real(wp) :: low, high

      call branch_limits(storeys%step%equation, i, low, high)
      watch(1) = watch_t(i, 0, level=min(low, a%f(i, 0)), side=1.0_wp)
      watch(2) = watch_t(i, 0, level=max(high, a%f(i, 0)), side=-1.0_wp)
   end function watches_of_limits

   !> Find the first branch end in a span. Each branch end found shortens the span, so that earlier
   !> ones remain visible.
   subroutine search_storeys(storeys, span, found, error)
      type(displacements_t), intent(in) :: storeys
      type(span_t), intent(inout) :: span
      type(storey_end_t), intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(size(storeys%step%y_a)), z(storeys%step%equation%floors%storeys)
      real(wp) :: t_z
      !! time of `y` and `z`
      integer :: i

      t_z = -huge(t_z)
      do i = 1, storeys%step%equation%floors%storeys
         associate (equation => storeys%step%equation)
            if (stands_still(equation%state, i)) then
               call leave_standstill(i, span, found)
            else if (loading_direction_of(equation, equation%state, i) /= 0) then
               call search_turn(storeys, i, span, found, error)
            else
               call search_limits(storeys, i, span, found, error)
            end if
         end associate
         if (allocated(error)) return
         if (side_beyond_zero(storeys%step%equation%state, i) == 0) cycle
         if (abs(span%b%t - t_z) > 0) call sample_state(storeys%step, span%b%t, y, error)
         if (allocated(error)) return
         ! one sample serves all storeys until the span is shortened
         if (abs(span%b%t - t_z) > 0) z = hysteretic_states(storeys%step%equation, y)
         t_z = span%b%t
         if (.not. z(i)*side_beyond_zero(storeys%step%equation%state, i) > 0) cycle
         call search_zero(storeys, i, span, found, error)
         if (allocated(error)) return
      end do
   end subroutine search_storeys

   !> Start a storey without previous motion. Its first nonzero derivative gives the direction.
   pure subroutine leave_standstill(i, span, found)
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(inout) :: span
      type(storey_end_t), intent(inout) :: found
      real(wp) :: way

      associate (a => span%a, b => span%b)
         way = a%f(i, 1)
         if (abs(way) <= 0) way = a%f(i, 2)
         if (begins_at_rest(span, i)) way = b%f(i, 1)
         if (abs(way) <= 0) return
         if (a%t < found%t) found = storey_end_t(i, a%t, turns=.true., is_rising=way > 0)
         b = a
      end associate
   end subroutine leave_standstill

   !> Search a yielding storey for a velocity reversal, or for an earlier limit of its branch.
   subroutine search_turn(storeys, i, span, found, error)
      type(displacements_t), intent(in) :: storeys
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(inout) :: span
      type(storey_end_t), intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      type(watch_t) :: watch
      real(wp) :: limit(2)
      integer :: direction
      logical :: is_found

      direction = loading_direction_of(storeys%step%equation, storeys%step%equation%state, i)
      watch = watch_t(i, 1, side=real(direction, wp))
      if (begins_at_rest(span, i)) then
         is_found = value_at(watch, span%b) < 0
         if (is_found) span = span_between(storeys, span%a, span%a)
      else
         call stop_at_change(storeys, watch, span, is_found, error)
         if (allocated(error)) return
      end if
      if (is_found .and. span%b%t < found%t) found = storey_end_t(i, span%b%t, turns=.true., &
         is_rising=direction < 0)
      call branch_limits(storeys%step%equation, i, limit(1), limit(2))
      watch = watch_t(i, 0, level=limit((3 + direction)/2), side=real(-direction, wp))
      if (.not. value_at(watch, span%b) < 0) return
      call stop_at_root(storeys, watch, span, error)
      if (.not. allocated(error) .and. span%b%t < found%t) found = storey_end_t(i, span%b%t, &
         is_rising=direction > 0)
   end subroutine search_turn

   !> Return whether a storey starts with zero rate and acceleration, within round-off. The end of
   !> the span then gives its direction.
   pure logical function begins_at_rest(span, i)
      type(span_t), intent(in) :: span
      integer, intent(in) :: i
      !! number of the storey from the ground up
      integer, parameter :: spacings = 8

      associate (a => span%a%f(i, :), h => span%b%t - span%a%t)
         begins_at_rest = max(abs(a(1)), h*abs(a(2))) <= spacings*epsilon(h)*span%largest(1)
      end associate
   end function begins_at_rest

   !> Search an elastic storey for its limits.
   subroutine search_limits(storeys, i, span, found, error)
      type(displacements_t), intent(in) :: storeys
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(inout) :: span
      type(storey_end_t), intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      call stop_at_first(storeys, watches_of_limits(storeys, i, span%a), span, k, error)
      if (allocated(error)) return
      if (k > 0 .and. span%b%t < found%t) found = storey_end_t(i, span%b%t, is_rising=k == 2)
   end subroutine search_limits

   !> Find the zero of the hysteretic force of a smooth storey, which is monotone before a turn.
   subroutine search_zero(storeys, i, span, found, error)
      type(displacements_t), intent(in) :: storeys
      integer, intent(in) :: i
      !! number of the storey from the ground up
      type(span_t), intent(inout) :: span
      type(storey_end_t), intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      type(hysteretic_t) :: states
      type(moment_t) :: a, b
      type(span_t) :: z
      type(watch_t) :: watch
      integer :: side

      side = side_beyond_zero(storeys%step%equation%state, i)
      states%step = storeys%step
      watch = watch_t(i, 0, side=real(-side, wp))
      call sample_functions(states, span%b%t, b, error)
      if (allocated(error)) return
      call sample_functions(states, span%a%t, a, error)
      if (allocated(error)) return
      z = span_between(states, a, b)
      call stop_at_root(states, watch, z, error)
      if (allocated(error)) return
      if (.not. z%b%t < found%t) return
      found = storey_end_t(i, z%b%t, passes_zero=.true.)
      call sample_functions(storeys, z%b%t, b, error)
      if (.not. allocated(error)) span = span_between(storeys, span%a, b)
   end subroutine search_zero

   !> Move a storey to its next branch after a branch end.
   subroutine end_branch(model, state, ending, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      type(storey_end_t), intent(in) :: ending
      real(wp), intent(inout) :: y(:)
      !! (states)

      if (ending%turns) then
         call turn_storey(model, state, ending%storey, ending%is_rising, y)
      else if (ending%passes_zero) then
         call stop_at_zero(model, ending%storey, y)
      else
         call pass_storey_limit(model, state, ending%storey, ending%is_rising)
      end if
   end subroutine end_branch

end module rwmf_simulation_events_storey_events
