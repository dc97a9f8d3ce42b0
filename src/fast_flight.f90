!> What happens to one ordinate inside a step: impacts, peaks, rest and lift-off.
!>
!> In a step the solution is that of a linear equation with a cubic forcing, whose Taylor series is
!> exact: events are located on it, to round-off, and no further evaluation of N is needed. After an
!> impact the rest of the step is integrated like a step of its own.
module rwmf_fast_flight
   use rwmf_fast_grid, only: fast_grid_t, ground_at
   use rwmf_fast_law, only: fast_law_t
   use rwmf_fast_piece, only: depart, end_state_t, linear_damping, linear_stiffness, ordinate_t, &
      weight_of_wall
   use rwmf_fast_rest, only: comes_to_rest, find_wake
   use rwmf_fast_series, only: find_root, newton_to_powers, series, state_at, terms, terms_needed
   use rwmf_fast_lanes, only: step_t
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: pass_events, wake_up, fall_asleep

   integer, parameter :: most_impacts = 200000
   !! of one ordinate: beyond, the general kernel has the better rules

   real(wp), parameter :: negligible = 0.01_wp
   !! part of the tolerance below which a motion may be put to rest

contains

   !> Rest from a position on.
   pure subroutine fall_asleep(law, grid, loud, number, x, ordinate)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! from `loud_steps`
      integer, intent(in) :: number
      !! of the step
      real(wp), intent(in) :: x
      !! position in it [-]
      type(ordinate_t), intent(inout) :: ordinate

      ordinate%rests = .true.
      ordinate%wake_step = number
      ordinate%wake_x = x
      call find_wake(law, grid, loud, ordinate%wake_step, ordinate%wake_x, ordinate%wake_side)
   end subroutine fall_asleep

   !> Lift off in this step and follow the motion to its end.
   pure subroutine wake_up(law, grid, loud, number, ordinate, finish)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      !! of the step, `wake_step` of the ordinate
      type(ordinate_t), intent(inout) :: ordinate
      type(end_state_t), intent(out) :: finish
      real(wp) :: p(0:terms)
      integer :: last
      real(wp) :: x

      x = min(ordinate%wake_x, 1 - 1.0e-13_wp)
      call lift_off(law, grid%step(number), x, ordinate, last, p, finish)
      call pass_pieces(law, grid, loud, number, x, ordinate, last, p, finish)
   end subroutine wake_up

   !> A step in which something happens, from its beginning.
   pure subroutine pass_events(law, grid, loud, number, v, w, difference, ordinate, finish)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      !! of the step
      real(wp), intent(in) :: v
      !! at its beginning [-]
      real(wp), intent(in) :: w
      !! [1/s]
      real(wp), intent(in) :: difference(0:3)
      !! divided differences of N [1/s2]
      type(ordinate_t), intent(inout) :: ordinate
      type(end_state_t), intent(inout) :: finish
      !! in: of the step as if nothing happened; out: at its end
      real(wp) :: p(0:terms)
      integer :: last
      !! highest power of the series

      associate (step => grid%step(number))
         last = terms_needed(linear_damping(ordinate, law), linear_stiffness(ordinate, law), step%h)
         call series(linear_damping(ordinate, law), linear_stiffness(ordinate, law), step%h, v, w, &
            newton_to_powers(difference - law%m2*ordinate%side*step%f - weight_of_wall(law)), &
            last, p)
      end associate
      call pass_pieces(law, grid, loud, number, 0.0_wp, ordinate, last, p, finish)
   end subroutine pass_events

   !> Flight after flight to the end of the step, or to rest.
   pure subroutine pass_pieces(law, grid, loud, number, x_start, ordinate, last, p, finish)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      real(wp), intent(in) :: x_start
      !! position at which the series begins [-]
      type(ordinate_t), intent(inout) :: ordinate
      integer, intent(inout) :: last
      !! highest power of the series
      real(wp), intent(inout) :: p(0:terms)
      !! v in powers of the position in the rest of the step
      type(end_state_t), intent(inout) :: finish
      real(wp) :: x
      real(wp) :: span
      !! what the series covers [-]
      real(wp) :: w
      !! rate at an impact [1/s]
      logical :: hits

      x = x_start
      span = 1 - x
      do
         call look_for_impact(grid%step(number)%h, ordinate, p(:last), span, x, w, hits)
         if (ordinate%failed) return
         if (.not. hits) exit
         call bounce(law, grid, number, x, w, ordinate)
         if (ordinate%failed) return
         if (ordinate%rests) then
            call fall_asleep(law, grid, loud, number, x, ordinate)
            finish = end_state_t(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
            if (ordinate%wake_step /= number) return
            x = min(ordinate%wake_x, 1 - 1.0e-13_wp)
            span = 1 - x
            call lift_off(law, grid%step(number), x, ordinate, last, p, finish)
         else
            call fly(law, grid%step(number), x, law%e*w, ordinate, span, last, p, finish)
         end if
      end do
      ordinate%v_max = max(ordinate%v_max, finish%v)
   end subroutine pass_pieces

   !> Impact and peak within a series; x and w move to the impact.
   pure subroutine look_for_impact(h, ordinate, p, span, x, w, hits)
      real(wp), intent(in) :: h
      !! of the step [s]
      type(ordinate_t), intent(inout) :: ordinate
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: span
      real(wp), intent(inout) :: x
      real(wp), intent(out) :: w
      !! towards the base [1/s]
      logical, intent(out) :: hits
      real(wp) :: v
      real(wp) :: y

      w = 0
      call find_impact(p, y, hits, ordinate%failed)
      if (ordinate%failed) return
      call state_at(p, y, v, w)
      if (w < 0 .and. p(1) >= 0) call note_peak(p, y, ordinate)
      if (.not. hits) return
      w = -w/(span*h)
      ! An impact on the very end of a step leaves a last piece that is only formally one.
      x = min(x + span*y, 1 - 1.0e-13_wp)
   end subroutine look_for_impact

   !> The flight that follows an impact: over the time that it is expected to take, or to the end of
   !> the step.
   pure subroutine fly(law, step, x, w, ordinate, span, last, p, finish)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: x
      real(wp), intent(in) :: w
      !! away from the base [1/s]
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(out) :: span
      !! what the series covers [-]
      integer, intent(out) :: last
      real(wp), intent(out) :: p(0:terms)
      type(end_state_t), intent(inout) :: finish
      real(wp) :: pull
      !! towards the base [1/s2]

      pull = law%m3 + law%m2*ordinate%side*ground_at(step, x) + linear_damping(ordinate, law)*w
      if (2.5_wp*w < 0.5_wp*(1 - x)*step%h*pull) then
         span = 2.5_wp*w/(pull*step%h)
         call depart(ordinate, law, step, x, span, w, last, p, finish)
         if (finish%v < 0) return
      end if
      span = 1 - x
      call depart(ordinate, law, step, x, span, w, last, p, finish)
   end subroutine fly

   !> Begin to move from rest at the position x of a step.
   pure subroutine lift_off(law, step, x, ordinate, last, p, finish)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: x
      !! [-]
      type(ordinate_t), intent(inout) :: ordinate
      integer, intent(out) :: last
      real(wp), intent(inout) :: p(0:terms)
      type(end_state_t), intent(inout) :: finish

      ordinate%rests = .false.
      ordinate%side = ordinate%wake_side
      call depart(ordinate, law, step, x, 1 - x, 0.0_wp, last, p, finish)
   end subroutine lift_off

   !> First return to v = 0 after the beginning of a series.
   !>
   !> A flight that starts on the base is asked for v/y (or v/y**2), which does not vanish there.
   pure subroutine find_impact(p, y, hits, failed)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(out) :: y
      !! position of the impact; 1 without one [-]
      logical, intent(out) :: hits
      logical, intent(inout) :: failed
      integer :: first

      first = 0
      if (p(0) <= 0) first = 1
      if (p(0) <= 0 .and. p(1) <= 0) first = 2
      y = 1
      hits = .false.
      if (sum(p(first:)) <= 0) then
         failed = first == 2 .or. .not. p(first) > 0
         if (failed) return
         hits = .true.
         call find_root(p(first:), 0.0_wp, 1.0_wp, y)
      else if (first < 2 .and. p(first + 1) < 0) then
         call find_dip(p(first:), y, hits)
      end if
   end subroutine find_impact

   !> Does a function that falls at 0 and is positive at 1 become negative between?
   pure subroutine find_dip(r, y, hits)
      real(wp), contiguous, intent(in) :: r(0:)
      real(wp), intent(out) :: y
      logical, intent(out) :: hits
      real(wp) :: lowest
      real(wp) :: value
      real(wp) :: slope

      y = 1
      hits = .false.
      call state_at(r, 1.0_wp, value, slope)
      if (slope <= 0) return
      call find_root(derivative(r), 0.0_wp, 1.0_wp, lowest)
      call state_at(r, lowest, value, slope)
      hits = value < 0
      if (hits) call find_root(r, 0.0_wp, lowest, y)
   end subroutine find_dip

   pure function derivative(r) result(slope)
      real(wp), intent(in) :: r(0:)
      real(wp) :: slope(0:size(r) - 2)
      integer :: i

      do i = 0, size(r) - 2
         slope(i) = (i + 1)*r(i + 1)
      end do
   end function derivative

   !> Keep the largest v before the position y, where v falls.
   pure subroutine note_peak(p, y, ordinate)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: y
      type(ordinate_t), intent(inout) :: ordinate
      real(wp) :: x
      real(wp) :: v
      real(wp) :: slope

      ! A cheap bound: most peaks are far below the largest one.
      if (p(1) > 0 .and. p(0) + 1.5_wp*p(1)*y < ordinate%v_max .and. p(2) < 0) return
      if (p(1) > 0) then
         call find_root(derivative(p), 0.0_wp, y, x)
      else
         call find_root(derivative(p(1:)), 0.0_wp, y, x)
      end if
      call state_at(p, x, v, slope)
      ordinate%v_max = max(ordinate%v_max, v)
   end subroutine note_peak

   !> Impact with the rate w towards the base.
   pure subroutine bounce(law, grid, number, x, w, ordinate)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: w
      !! [1/s]
      type(ordinate_t), intent(inout) :: ordinate

      ordinate%impacts = ordinate%impacts + 1
      ordinate%failed = .not. w > 0 .or. ordinate%impacts > most_impacts
      ordinate%side = -ordinate%side
      ordinate%w_max = max(ordinate%w_max, w)
      ordinate%rests = comes_to_rest(law, grid, number, x, law%e*w, &
         negligible*ordinate%rtol*ordinate%v_max, negligible*ordinate%rtol*ordinate%w_max)
   end subroutine bounce

end module rwmf_fast_flight
