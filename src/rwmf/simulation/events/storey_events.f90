!> Ends of the branches of storeys that yield, inside the last step of an integrator.
!>
!> A part of the step is so short that a storey turns at most twice in it. The step is cut at the
!> first end of a branch, so that whoever searches it afterwards sees one smooth equation.
module rwmf_simulation_events_storey_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: close_in, secant_between, secant_t, stationary_point
   use rwmf_model_effects_storeys_yielding_storeys, only: branch_limits, hysteretic_states, &
      loading_direction_of, pass_storey_limit, side_beyond_zero, stands_still, stop_at_zero, &
      turn_storey
   use rwmf_model_equation, only: discrete_state_t, model_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_simulation_events_event_time, only: passage
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, is_steady, may_reverse, &
      sample_state, step_view_t
   implicit none
   private

   public :: moment_t, storey_end_t, storey_span_t, sample_storeys, span_of, end_at_turn, &
      stop_at_storey, end_branch, is_quiet
   public :: of_drift

   integer, parameter :: of_drift = 1
   integer, parameter :: of_rate = 2
   integer, parameter :: of_z = 3

   !> The storeys at an instant.
   type :: moment_t
      real(wp) :: t
      !! [s]
      real(wp), allocatable :: motion(:, :)
      !! (n, 3) displacements [m], their rates [m/s], and hysteretic states of smooth storeys [-]
   end type moment_t

   !> One storey between two instants.
   type :: storey_span_t
      type(step_view_t) :: step
      integer :: storey
      real(wp) :: t(2)
      !! [s]
      real(wp) :: motion(3, 2)
      !! displacement [m], its rate [m/s], and hysteretic state of a smooth storey [-] at both
   end type storey_span_t

   !> End of a storey's branch, or of the motion.
   type :: storey_end_t
      integer :: storey = 0
      !! its number, from the ground; 0 when there is none
      real(wp) :: t = huge(1.0_wp)
      !! [s]
      logical :: turns = .false.
      !! it unloads, or begins to move
      logical :: passes_zero = .false.
      !! its hysteretic force does; else it comes to a limit
      logical :: is_rising = .false.
      !! its displacement grows beyond
      logical :: collapses = .false.
      !! it is the number of a drift that passes its limit
   end type storey_end_t

contains

   !> Cut the last step of the integrator at the first end of a branch.
   subroutine stop_at_storey(step, found, error)
      type(step_view_t), intent(inout) :: step
      type(storey_end_t), intent(out) :: found
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(moment_t) :: a, b
      real(wp) :: y(size(step%y_a))
      integer :: n, i

      n = count_parts(step)
      if (n == 1) then
         if (is_quiet(step)) return
      end if
      call sample_storeys(step, step%t_a, b, error)
      do i = 1, n
         a = b
         if (allocated(error)) return
         call sample_storeys(step, end_of_part(step, i, n), b, error)
         if (allocated(error)) return
         call search_storeys(step, a, b, found, error)
         if (allocated(error)) return
         if (found%storey > 0) exit
      end do
      if (found%storey == 0) return
      call step%integrator%state_at(found%t, y, error)
      step%t_b = found%t
      step%integrator%t1 = found%t
      step%integrator%y1(:) = y
   end subroutine stop_at_storey

   !> Is it plain from the ends of a short step that no branch ends in it? Most are: the storey is
   !> far from the limits, or yields on at a rate that hardly changes.
   logical function is_quiet(step)
      type(step_view_t), intent(in) :: step
      real(wp), dimension(step%equation%floors%n, 2) :: d, rate
      real(wp) :: z(step%equation%floors%n)
      real(wp) :: low, high
      integer :: loading_direction, i

      is_quiet = .true.
      associate (equation => step%equation)
         call storey_motion(equation, equation%state%side, step%y_a, d(:, 1), rate(:, 1))
         call storey_motion(equation, equation%state%side, step%y_b, d(:, 2), rate(:, 2))
         z = hysteretic_states(equation, step%y_b)
         do i = 1, size(z)
            loading_direction = loading_direction_of(equation, equation%state, i)
            if (stands_still(equation%state, i)) then
               is_quiet = abs(rate(i, 2)) <= 0
            else if (loading_direction /= 0) then
               is_quiet = is_steady(rate(i, 1), rate(i, 2)) .and. loading_direction*rate(i, 1) > 0 &
                  .and. side_beyond_zero(equation%state, i)*z(i) <= 0
            end if
            if (.not. is_quiet) return
            call branch_limits(equation, i, low, high)
            if (loading_direction > 0) low = -huge(low)
            if (loading_direction < 0) high = huge(high)
            associate (reach => (step%t_b - step%t_a)*maxval(abs(rate(i, :))))
               is_quiet = maxval(d(i, :)) + reach < high .and. minval(d(i, :)) - reach > low
            end associate
            if (.not. is_quiet) return
         end do
      end associate
   end function is_quiet

   !> First end of a branch between two instants.
   subroutine search_storeys(step, a, b, found, error)
      type(step_view_t), intent(in) :: step
      type(moment_t), intent(in) :: a, b
      type(storey_end_t), intent(inout) :: found
      type(error_t), allocatable, intent(out) :: error
      type(storey_span_t) :: span
      type(storey_end_t) :: ending
      integer :: i

      do i = 1, step%equation%floors%n
         span = span_of(step, i, a, b)
         if (stands_still(step%equation%state, i)) then
            ending = storey_end_t(merge(i, 0, abs(span%motion(of_rate, 2)) > 0), a%t, &
               turns=.true., is_rising=span%motion(of_rate, 2) > 0)
         else if (loading_direction_of(step%equation, step%equation%state, i) /= 0) then
            call search_turn(span, ending, error)
         else
            call search_limit(span, ending, error)
         end if
         if (allocated(error)) return
         if (ending%storey > 0 .and. ending%t < found%t) found = ending
         call search_zero(span, ending, error)
         if (allocated(error)) return
         if (ending%storey > 0 .and. ending%t < found%t) found = ending
      end do
   end subroutine search_storeys

   !> One storey between two instants.
   function span_of(step, storey, a, b) result(span)
      type(step_view_t), intent(in) :: step
      integer, intent(in) :: storey
      !! its number, from the ground
      type(moment_t), intent(in) :: a, b
      type(storey_span_t) :: span

      span%step = step
      span%storey = storey
      span%t = [a%t, b%t]
      span%motion(:, 1) = a%motion(storey, :)
      span%motion(:, 2) = b%motion(storey, :)
   end function span_of

   !> Does a storey that yields turn back, or come to the end of its branch before?
   subroutine search_turn(span, ending, error)
      type(storey_span_t), intent(in) :: span
      type(storey_end_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(storey_span_t) :: part
      integer :: loading_direction

      loading_direction = loading_direction_of(span%step%equation, span%step%equation%state, &
         span%storey)
      part = span
      if (loading_direction*span%motion(of_rate, 2) >= 0) then
         call end_at_slowest(part, error)
         if (allocated(error)) return
         if (loading_direction*part%motion(of_rate, 2) >= 0) then
            call search_ahead(span, loading_direction, ending, error)
            return
         end if
      end if
      ending = storey_end_t(span%storey, span%t(1), turns=.true., is_rising=loading_direction < 0)
      if (loading_direction*span%motion(of_rate, 1) <= 0) return
      call find_root(part, of_rate, 0.0_wp, ending%t, error)
      if (allocated(error)) return
      call move_end(part, 2, ending%t, error)
      if (.not. allocated(error)) call search_ahead(part, loading_direction, ending, error)
   end subroutine search_turn

   !> Does a storey that yields on come to the end of its branch?
   subroutine search_ahead(span, loading_direction, ending, error)
      type(storey_span_t), intent(in) :: span
      !! in which it does not turn
      integer, intent(in) :: loading_direction
      !! +1 or -1
      type(storey_end_t), intent(inout) :: ending
      type(error_t), allocatable, intent(inout) :: error
      real(wp) :: limit(2), end_of_branch

      call branch_limits(span%step%equation, span%storey, limit(1), limit(2))
      end_of_branch = merge(limit(2), limit(1), loading_direction > 0)
      if (loading_direction*(span%motion(of_drift, 2) - end_of_branch) <= 0) return
      ending = storey_end_t(span%storey, span%t(1), is_rising=loading_direction > 0)
      if (loading_direction*(span%motion(of_drift, 1) - end_of_branch) >= 0) return
      call find_root(span, of_drift, end_of_branch, ending%t, error)
   end subroutine search_ahead

   !> Does the hysteretic force of a smooth storey pass zero?
   subroutine search_zero(span, ending, error)
      type(storey_span_t), intent(in) :: span
      type(storey_end_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      integer :: side

      side = side_beyond_zero(span%step%equation%state, span%storey)
      if (side*span%motion(of_z, 2) <= 0) return
      ending = storey_end_t(span%storey, span%t(1), passes_zero=.true.)
      if (side*span%motion(of_z, 1) >= 0) return
      call find_root(span, of_z, 0.0_wp, ending%t, error)
   end subroutine search_zero

   !> Let a span end where the storey is about slowest, if it may turn back there and go on again.
   !> Only where the way says that it may, another state is asked for.
   subroutine end_at_slowest(span, error)
      type(storey_span_t), intent(inout) :: span
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: rate(2), h
      real(wp) :: x
      !! place of the parabola's vertex between both ends [-]

      rate = abs(span%motion(of_rate, :))
      h = span%t(2) - span%t(1)
      if (.not. may_reverse(abs(span%motion(of_drift, 2) - span%motion(of_drift, 1)), rate, &
          h)) return
      x = sqrt(rate(1))/max(sqrt(rate(1)) + sqrt(rate(2)), tiny(x))
      call move_end(span, 2, span%t(1) + x*h, error)
   end subroutine end_at_slowest

   !> Does an elastic storey come to a limit?
   subroutine search_limit(span, ending, error)
      type(storey_span_t), intent(in) :: span
      type(storey_end_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(storey_span_t) :: part
      real(wp) :: limit(2)

      call branch_limits(span%step%equation, span%storey, limit(1), limit(2))
      part = span
      call end_at_turn(part, limit, error)
      if (allocated(error)) return
      if (part%t(2) < span%t(2)) call pass_limit(part, limit, ending, error)
      if (ending%storey > 0 .or. allocated(error)) return
      part = span
      call pass_limit(part, limit, ending, error)
   end subroutine search_limit

   !> A limit that a storey has passed at the end of a span.
   subroutine pass_limit(span, limit, ending, error)
      type(storey_span_t), intent(inout) :: span
      !! on return perhaps only the part after a turn
      real(wp), intent(in) :: limit(2)
      !! [m]
      type(storey_end_t), intent(inout) :: ending
      type(error_t), allocatable, intent(out) :: error
      integer :: k, outward
      real(wp) :: t

      k = findloc([span%motion(of_drift, 2) < limit(1), span%motion(of_drift, 2) > limit(2)], &
         .true., dim=1)
      if (k == 0) return
      outward = 2*k - 3
      if (outward*(span%motion(of_drift, 1) - limit(k)) >= 0 &
          .and. outward*span%motion(of_rate, 1) < 0) then
         ! it begins at the limit, where it has turned, and has to turn once more
         if (outward*span%motion(of_rate, 2) < 0) return
         call find_root(span, of_rate, 0.0_wp, t, error)
         if (.not. allocated(error)) call move_end(span, 1, t, error)
         if (allocated(error)) return
      end if
      if (abs(span%motion(of_rate, 1)) <= 0) then
         if (returns_unseen(span, outward)) return
         call leave_turn(span, outward*limit(k), outward, error)
         if (allocated(error)) return
      end if
      ending = storey_end_t(span%storey, span%t(1), turns=.false., is_rising=outward > 0)
      if (outward*(span%motion(of_drift, 1) - limit(k)) >= 0) return
      call find_root(span, of_drift, limit(k), ending%t, error)
   end subroutine pass_limit

   !> Does a storey that begins without a rate come back from its limit, within round-off of where
   !> it began? At a peak of theta a frame of one storey turns as well: theta' is zero there, and
   !> the first step after it may be too short to show where it goes. Only its rate does.
   pure logical function returns_unseen(span, outward)
      type(storey_span_t), intent(in) :: span
      !! in which it is beyond the limit at the end
      integer, intent(in) :: outward
      !! +1 or -1

      associate (d => span%motion(of_drift, :))
         returns_unseen = outward*span%motion(of_rate, 2) <= 0 &
            .and. outward*(d(2) - d(1)) <= 8*spacing(d(1))
      end associate
   end function returns_unseen

   !> A storey that turns at its limit without a rate goes inside before it comes back: let the span
   !> begin there, if there is such a place.
   subroutine leave_turn(span, limit, outward, error)
      type(storey_span_t), intent(inout) :: span
      real(wp), intent(in) :: limit
      !! in the direction outward [m]
      integer, intent(in) :: outward
      !! +1 or -1
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most = 10
      type(storey_span_t) :: part
      integer :: i

      do i = 1, most
         part = span
         call move_end(part, 1, span%t(1) + (span%t(2) - span%t(1))/2**i, error)
         if (allocated(error)) return
         if (outward*part%motion(of_drift, 1) < limit) exit
      end do
      if (i <= most) span = part
   end subroutine leave_turn

   !> Let a span end at the turn of the storey, if that may lie outside of two limits.
   subroutine end_at_turn(span, limit, error)
      type(storey_span_t), intent(inout) :: span
      real(wp), intent(in) :: limit(2)
      !! [m]
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: reach
      !! how far it may go beyond its ends, twice what a steady deceleration allows [m]
      real(wp) :: t

      associate (d => span%motion(of_drift, :), rate => span%motion(of_rate, :))
         if (rate(1)*rate(2) >= 0) return
         reach = (span%t(2) - span%t(1))*maxval(abs(rate))
         if (rate(1) > 0 .and. maxval(d) + reach <= limit(2)) return
         if (rate(1) < 0 .and. minval(d) - reach >= limit(1)) return
      end associate
      call find_root(span, of_rate, 0.0_wp, t, error)
      if (.not. allocated(error)) call move_end(span, 2, t, error)
   end subroutine end_at_turn

   !> Move an end of a span to a time inside.
   subroutine move_end(span, k, t, error)
      type(storey_span_t), intent(inout) :: span
      integer, intent(in) :: k
      !! 1 for the beginning, 2 for the end
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(moment_t) :: now

      call sample_storeys(span%step, t, now, error)
      if (allocated(error)) return
      span%t(k) = t
      span%motion(:, k) = now%motion(span%storey, :)
   end subroutine move_end

   !> Where a storey passes a level that lies between its values at the ends, to round-off of the
   !> time.
   subroutine find_root(span, which, level, t, error)
      type(storey_span_t), intent(in) :: span
      integer, intent(in) :: which
      !! `of_drift`, `of_rate` or `of_z`
      real(wp), intent(in) :: level
      !! [m], [m/s] or [-]
      real(wp), intent(out) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      type(secant_t) :: secant
      type(moment_t) :: now
      real(wp) :: g

      secant = secant_between(span%t, span%motion(which, :) - level)
      if (secant%is_open) call start_search(span, which, level, secant%next)
      do while (secant%is_open)
         t = secant%next
         call sample_storeys(span%step, t, now, error)
         if (allocated(error)) return
         g = now%motion(span%storey, which) - level
         if (abs(g) <= 0) return
         call close_in(secant, g)
      end do
      t = secant%x(2)
   end subroutine find_root

   !> Where to begin to look for a level: by the cubic through drift and rate at both ends.
   pure subroutine start_search(span, which, level, t)
      type(storey_span_t), intent(in) :: span
      integer, intent(in) :: which
      !! `of_drift`, `of_rate` or `of_z`
      real(wp), intent(in) :: level
      !! [m], [m/s] or [-]
      real(wp), intent(inout) :: t
      !! by the secant; on return better, if it can be [s]
      real(wp) :: c(0:5), x

      if (which == of_z) return
      associate (d => span%motion(of_drift, :), h => span%t(2) - span%t(1), rise => span%motion( &
                 of_drift, 2) - span%motion(of_drift, 1), rate => span%motion(of_rate, :))
         if (which == of_rate) then
            x = 0
            if (rate(1)*rate(2) < 0) x = stationary_point(d(1), h*rate(1), d(2), h*rate(2))
         else
            c = 0
            c(:3) = [d(1) - level, h*rate(1), 3*rise - h*(2*rate(1) + rate(2)), &
               h*sum(rate) - 2*rise]
            x = passage(sign(1.0_wp, d(2) - level)*c)
         end if
         if (x > 0 .and. x < 1) t = span%t(1) + x*h
      end associate
   end subroutine start_search

   !> The storeys at a time of the last step.
   subroutine sample_storeys(step, t, now, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      type(moment_t), intent(out) :: now
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: y(size(step%y_a))

      call sample_state(step, t, y, error)
      if (allocated(error)) return
      now%t = t
      allocate (now%motion(step%equation%floors%n, 3))
      call storey_motion(step%equation, step%equation%state%side, y, now%motion(:, of_drift), &
         now%motion(:, of_rate))
      now%motion(:, of_z) = hysteretic_states(step%equation, y)
   end subroutine sample_storeys

   !> The storey whose branch has ended goes over to its next one.
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
