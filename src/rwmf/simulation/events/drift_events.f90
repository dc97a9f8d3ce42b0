!> The instant at which a drift passes its limit, and the scene collapses, inside the last step of
!> an integrator.
!>
!> Drifts are no functions of the rotation alone, so that they are looked for in the states. A part
!> of the step is so short that a drift turns at most twice in it. The step is cut at the first
!> passage: whoever searches it afterwards finds what comes before, and then nothing has collapsed.
module rwmf_simulation_events_drift_events
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: close_in, secant_between, secant_t
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_drift_limits, only: drift_ratios
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, may_reverse, &
      sample_state, step_view_t
   use rwmf_simulation_events_storey_events, only: is_quiet, stop_at_storey, storey_end_t
   implicit none
   private

   public :: cut_step, has_collapsed, is_uncut

   integer, parameter :: of_ratio = 1
   integer, parameter :: of_rate = 2
   integer, parameter :: most_turns = 2
   !! of a drift in a part of the step

   !> One drift between two instants.
   type :: drift_span_t
      type(step_view_t) :: step
      integer :: drift
      !! its number
      integer :: n
      !! number of all drifts
      real(wp) :: t(2)
      !! [s]
      real(wp) :: motion(2, 2)
      !! drift over its limit [-] and its rate [1/s] at both
   end type drift_span_t

contains

   !> Is a drift at its limit, or beyond it?
   logical function has_collapsed(equation, n, y)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: n
      !! number of drifts with a limit; 0: nothing can collapse
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: motion(n, 2)

      has_collapsed = .false.
      if (n == 0) return
      call drift_ratios(equation, y, motion(:, of_ratio), motion(:, of_rate))
      has_collapsed = any(abs(motion(:, of_ratio)) >= 1)
   end function has_collapsed

   !> Is it plain from the ends of a step that `cut_step` would leave it whole?
   logical function is_uncut(step, drifts)
      type(step_view_t), intent(in) :: step
      !! without an integrator
      integer, intent(in) :: drifts
      !! number of those with a limit
      real(wp) :: motion(drifts, 2, 2)
      !! (drifts, ratio and rate, ends)

      is_uncut = count_parts(step) == 1
      if (is_uncut .and. step%equation%floors%yields) is_uncut = is_quiet(step)
      if (.not. is_uncut .or. drifts == 0) return
      call drift_ratios(step%equation, step%y_a, motion(:, 1, 1), motion(:, 2, 1))
      call drift_ratios(step%equation, step%y_b, motion(:, 1, 2), motion(:, 2, 2))
      is_uncut = .not. any(comes_near(motion, step%t_b - step%t_a))
   end function is_uncut

   !> May drifts come to their limits between two instants, at the rates that they have there?
   pure function comes_near(motion, duration)
      real(wp), intent(in) :: motion(:, :, :)
      !! (drifts, ratio and rate, ends) [-], [1/s]
      real(wp), intent(in) :: duration
      !! [s]
      logical :: comes_near(size(motion, 1))

      associate (largest => maxval(abs(motion), dim=3))
         comes_near = largest(:, of_ratio) + duration*largest(:, of_rate) >= 1
      end associate
   end function comes_near

   !> Cut the last step of the integrator at the first end of a storey's branch, or where a drift
   !> passes its limit before.
   subroutine cut_step(step, drifts, ending, error)
      type(step_view_t), intent(inout) :: step
      integer, intent(in) :: drifts
      !! number of those with a limit
      type(storey_end_t), intent(out) :: ending
      !! what happens at its end
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails

      if (step%equation%floors%yields) call stop_at_storey(step, ending, error)
      if (allocated(error) .or. drifts == 0) return
      call stop_at_collapse(step, drifts, ending, error)
   end subroutine cut_step

   !> Cut a step where the first drift passes its limit.
   subroutine stop_at_collapse(step, n, ending, error)
      type(step_view_t), intent(inout) :: step
      integer, intent(in) :: n
      !! number of drifts with a limit, > 0
      type(storey_end_t), intent(inout) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(storey_end_t) :: collapse
      real(wp) :: motion(n, 2, 2)
      !! (drifts, ratio and rate, ends of the part)
      real(wp) :: t(2)
      integer :: parts, i

      parts = count_parts(step)
      t(2) = step%t_a
      call drift_ratios(step%equation, step%y_a, motion(:, 1, 2), motion(:, 2, 2))
      do i = 1, parts
         t = [t(2), end_of_part(step, i, parts)]
         motion(:, :, 1) = motion(:, :, 2)
         call sample_drifts(step, t(2), motion(:, :, 2), error)
         if (allocated(error)) return
         call search_part(step, t, motion, collapse, error)
         if (allocated(error)) return
         if (collapse%storey > 0) exit
      end do
      if (collapse%storey == 0) return
      ending = collapse
      call shorten(step, collapse%t, error)
   end subroutine stop_at_collapse

   !> Let the last step of the integrator end at a time inside.
   subroutine shorten(step, t, error)
      type(step_view_t), intent(inout) :: step
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(size(step%y_a))

      call sample_state(step, t, y, error)
      if (allocated(error)) return
      step%t_b = t
      step%integrator%t1 = t
      step%integrator%y1(:) = y
   end subroutine shorten

   !> First passage of any drift in a part of the step. Most parts cannot have one: the drifts are
   !> farther from their limits than they could go.
   subroutine search_part(step, t, motion, collapse, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t(2)
      !! its ends [s]
      real(wp), intent(in) :: motion(:, :, :)
      !! (drifts, ratio and rate, ends)
      type(storey_end_t), intent(out) :: collapse
      type(error_t), allocatable, intent(out) :: error
      type(drift_span_t) :: span
      real(wp) :: t_pass
      logical :: passes, is_near(size(motion, 1))
      integer :: i

      is_near = comes_near(motion, t(2) - t(1))
      do i = 1, size(motion, 1)
         if (.not. is_near(i)) cycle
         span = drift_span_t(step, i, size(motion, 1), t, motion(i, :, :))
         call search_span(span, passes, t_pass, error)
         if (allocated(error)) return
         if (passes .and. t_pass < collapse%t) collapse = storey_end_t(i, t_pass, collapses=.true.)
      end do
   end subroutine search_part

   !> First passage of one drift, monotone piece by monotone piece.
   subroutine search_span(span, passes, t, error)
      type(drift_span_t), intent(in) :: span
      logical, intent(out) :: passes
      real(wp), intent(out) :: t
      !! of the passage [s]
      type(error_t), allocatable, intent(out) :: error
      type(drift_span_t) :: piece
      real(wp) :: level
      integer :: i

      t = span%t(1)
      passes = abs(span%motion(of_ratio, 1)) >= 1
      if (passes) return
      piece = span
      do i = 0, most_turns
         if (i < most_turns) call end_at_turn(piece, error)
         if (allocated(error)) return
         passes = abs(piece%motion(of_ratio, 2)) >= 1
         if (passes) exit
         if (piece%t(2) >= span%t(2)) return
         piece%t = [piece%t(2), span%t(2)]
         piece%motion = reshape([piece%motion(:, 2), span%motion(:, 2)], [2, 2])
      end do
      if (.not. passes) return
      level = sign(1.0_wp, piece%motion(of_ratio, 2))
      call move_end(piece, of_ratio, level, error)
      t = piece%t(2)
   end subroutine search_span

   !> Let a span end where the drift turns first, if it does. Where it turns twice, the rate has the
   !> same sign at both ends, and the way says whether another state is worth asking for.
   subroutine end_at_turn(span, error)
      type(drift_span_t), intent(inout) :: span
      type(error_t), allocatable, intent(out) :: error
      type(drift_span_t) :: part
      real(wp) :: rate(2), way
      real(wp) :: x
      !! place of the parabola's vertex between both ends [-]

      part = span
      if (part%motion(of_rate, 1)*part%motion(of_rate, 2) > 0) then
         rate = abs(part%motion(of_rate, :))
         way = sign(1.0_wp, part%motion(of_rate, 1)) &
            *(part%motion(of_ratio, 2) - part%motion(of_ratio, 1))
         if (.not. may_reverse(way, rate, part%t(2) - part%t(1))) return
         x = sqrt(rate(1))/(sqrt(rate(1)) + sqrt(rate(2)))
         part%t(2) = part%t(1) + x*(part%t(2) - part%t(1))
         call sample_drift(part, part%t(2), part%motion(:, 2), error)
         if (allocated(error)) return
      end if
      if (part%motion(of_rate, 1)*part%motion(of_rate, 2) >= 0) return
      span = part
      call move_end(span, of_rate, 0.0_wp, error)
   end subroutine end_at_turn

   !> Let a span end where its drift or the rate of it passes a level that lies between its values
   !> at the ends, to round-off of the time: at the first number found beyond.
   subroutine move_end(span, which, level, error)
      type(drift_span_t), intent(inout) :: span
      integer, intent(in) :: which
      !! `of_ratio` or `of_rate`
      real(wp), intent(in) :: level
      !! [-] or [1/s]
      type(error_t), allocatable, intent(out) :: error
      type(secant_t) :: secant
      real(wp) :: motion(2)

      secant = secant_between(span%t, span%motion(which, :) - level)
      do while (secant%is_open)
         span%t(2) = secant%next
         call sample_drift(span, secant%next, motion, error)
         if (allocated(error)) return
         if (abs(motion(which) - level) <= 0) exit
         call close_in(secant, motion(which) - level)
         span%t(2) = secant%x(2)
      end do
      call sample_drift(span, span%t(2), span%motion(:, 2), error)
   end subroutine move_end

   !> One drift and its rate at a time of the step.
   subroutine sample_drift(span, t, motion, error)
      type(drift_span_t), intent(in) :: span
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: motion(2)
      !! [-] and [1/s]
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: all_drifts(span%n, 2)

      call sample_drifts(span%step, t, all_drifts, error)
      if (.not. allocated(error)) motion = all_drifts(span%drift, :)
   end subroutine sample_drift

   !> All drifts over their limits and their rates at a time of the step.
   subroutine sample_drifts(step, t, motion, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: motion(:, :)
      !! (drifts, 2) [-] and [1/s]
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: y(size(step%y_a))

      call sample_state(step, t, y, error)
      if (allocated(error)) return
      call drift_ratios(step%equation, y, motion(:, of_ratio), motion(:, of_rate))
   end subroutine sample_drifts

end module rwmf_simulation_events_drift_events
