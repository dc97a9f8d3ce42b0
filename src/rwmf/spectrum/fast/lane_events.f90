!> What happens to the ordinates inside a step: impacts, peaks, rest and lift-off.
!>
!> Flights are integrated and searched in rows (`fast_piece.F90`, `fast_locate.F90`), whoever they
!> belong to; here each one's outcome is judged.
module rwmf_spectrum_fast_lane_events
   use rwmf_spectrum_fast_energy_bound, only: is_over
   use rwmf_spectrum_fast_types, only: fast_law_t, flights_t, team_t, tried_step_t, width
   use rwmf_spectrum_fast_event_kernel, only: place_impacts
   use rwmf_spectrum_fast_simd_dispatch, only: depart, follow, rebound
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_rest_rule, only: comes_to_rest, find_wake, negligible
   use rwmf_spectrum_fast_shared_data, only: fast_scope_t
   use rwmf_spectrum_fast_scalar_events, only: search_again
   use rwmf_spectrum_fast_lane_pool, only: lane_of, pool_t, pull, push, team_of
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: most_impacts, enter_step, follow_row, depart_row, fall_asleep

   integer, parameter :: most_impacts = 200000
   !! of one ordinate: beyond, the general kernel has the better rules
   real(wp), parameter :: negligible_n = 1.0e-4_wp
   !! part of the tolerance below which a change of v by N is left out
   real(wp), parameter :: last_x = 1 - 1.0e-13_wp
   !! an impact on the very end of a step leaves a last part that is only formally one

contains

   !> Rest from the position x of a step on: until a flight begins, or for good.
   pure subroutine fall_asleep(scope, slot, number, x, pool)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: slot
      integer, intent(in) :: number
      !! of the step in the grid
      real(wp), intent(in) :: x
      !! [-]
      type(pool_t), intent(inout) :: pool
      integer :: wake
      real(wp) :: wake_x

      associate (one => pool%ordinate(slot))
         associate (law => scope%law(one%law), grid => scope%grid(one%grid))
            wake = number
            wake_x = x
            call find_wake(law, grid, scope%loud(one%pair, one%grid)%next, wake, wake_x, one%side)
            call stop_lane(slot, pool)
            if (wake > size(grid%step)) then
               call push(slot, pool%finished)
            else
               call plan_flight(wake, min(wake_x, last_x), 0.0_wp, one)
               call push(slot, pool%starts)
            end if
         end associate
      end associate
   end subroutine fall_asleep

   !> No motion.
   pure subroutine stop_lane(slot, pool)
      integer, intent(in) :: slot
      type(pool_t), intent(inout) :: pool

      associate (now => pool%team(team_of(slot))%now, i => lane_of(slot))
         now%v(i) = 0
         now%w(i) = 0
         now%n(i) = 0
         now%s(i) = 0
         now%drive(i) = 0
      end associate
   end subroutine stop_lane

   !> A flight that starts on the base.
   pure subroutine plan_flight(number, x, w, ordinate)
      integer, intent(in) :: number
      !! of the step
      real(wp), intent(in) :: x
      !! [-]
      real(wp), intent(in) :: w
      !! [1/s]
      type(ordinate_t), intent(inout) :: ordinate

      ordinate%number = number
      ordinate%x = x
      ordinate%span = 1 - x
      ordinate%w = w
   end subroutine plan_flight

   !> Search the steps that wait for what was announced there. The flights that begin with the
   !> impacts follow in the same row, with others that wait.
   pure subroutine follow_row(scope, pool)
      type(fast_scope_t), intent(in) :: scope
      type(pool_t), intent(inout) :: pool
      integer :: k

      associate (row => pool%events)
         call blank(row%used + 1, row%filled, row)
         row%filled = row%used
         if (row%used > 0) then
            row%v(row%used + 1:) = 1
            row%finish%v(row%used + 1:) = 1
            call follow(scope%instructions, row)
            call search_odd(row, pool)
            call rebound(scope%instructions, negligible_n*scope%rtol, row)
            do k = 1, row%used
               call judge(scope, k, row, pool)
               if (row%slot(k) == 0) then
                  call blank(k, k, row)
               else
                  call enter_side(scope, pool%ordinate(row%slot(k)), k, row)
               end if
            end do
         end if
         call take_in(scope, row, pool)
         call fly(scope, row, pool)
         row%used = 0
      end associate
   end subroutine follow_row

   !> A row of flights that start on the base.
   pure subroutine depart_row(scope, pool)
      type(fast_scope_t), intent(in) :: scope
      type(pool_t), intent(inout) :: pool

      associate (row => pool%flights)
         call blank(1, row%filled, row)
         row%filled = 0
         call take_in(scope, row, pool)
         call fly(scope, row, pool)
      end associate
   end subroutine depart_row

   !> Planned flights take the free places of a row.
   pure subroutine take_in(scope, row, pool)
      type(fast_scope_t), intent(in) :: scope
      type(flights_t), intent(inout) :: row
      type(pool_t), intent(inout) :: pool
      integer :: slot(width)
      integer :: k, n, taken

      n = min(pool%starts%n, count(row%slot == 0))
      if (n == 0) return
      call pull(pool%starts, slot(:n))
      taken = 0
      do k = 1, width
         if (row%slot(k) /= 0) cycle
         if (taken == n) exit
         taken = taken + 1
         row%slot(k) = slot(taken)
         row%filled = max(row%filled, k)
         call enter_flight(scope, pool%ordinate(slot(taken)), k, row)
      end do
   end subroutine take_in

   !> Integrate flights that start on the base, and search them; who begins another one waits.
   pure subroutine fly(scope, row, pool)
      type(fast_scope_t), intent(in) :: scope
      type(flights_t), intent(inout) :: row
      type(pool_t), intent(inout) :: pool
      integer :: k

      call depart(scope%instructions, row)
      call search_odd(row, pool)
      call rebound(scope%instructions, negligible_n*scope%rtol, row)
      do k = 1, width
         if (row%slot(k) == 0) cycle
         call judge(scope, k, row, pool)
         if (row%slot(k) == 0) cycle
         pool%ordinate(row%slot(k))%span = row%span(k)
         call push(row%slot(k), pool%starts)
      end do
   end subroutine fly

   !> The constants of an ordinate.
   pure subroutine seat(law, ordinate, k, row)
      type(fast_law_t), intent(in) :: law
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: k
      !! its place in the row
      type(flights_t), intent(inout) :: row

      row%damping(k) = ordinate%damping
      row%stiffness(k) = ordinate%stiffness
      row%stages(k) = ordinate%stages
      row%w_begin(k) = ordinate%w
      ! of the impacts so far; `comes_to_rest` knows the last one too
      row%idle(k) = negligible*ordinate%rtol*ordinate%w_max
      row%v_max(k) = ordinate%v_max
      if (row%law(k) == ordinate%law) return
      row%law(k) = ordinate%law
      row%m1(k) = law%m1
      row%m2(k) = law%m2
      row%m3(k) = law%m3
      row%m3_1(k) = law%m3_1
      row%threshold(k) = law%threshold
      row%e(k) = law%e
   end subroutine seat

   !> A whole step joins those that wait, as its team has tried it.
   pure subroutine enter_step(scope, team, trial, i, slot, one, row)
      type(fast_scope_t), intent(in) :: scope
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(in) :: trial
      integer, intent(in) :: i
      !! lane
      integer, intent(in) :: slot
      type(ordinate_t), intent(inout) :: one
      type(flights_t), intent(inout) :: row
      integer :: k

      one%number = team%at(i) - one%offset
      one%v_max = team%v_max(i)
      k = row%used + 1
      row%used = k
      row%slot(k) = slot
      call seat(scope%law(one%law), one, k, row)
      row%step(k) = team%rate%h(i)
      row%f(k, :) = trial%ground%f(i, :)
      row%x(k) = 0
      row%span(k) = 1
      row%v(k) = team%now%v(i)
      row%w(k) = team%now%w(i)
      row%side(k) = team%rate%side(i)
      row%n_0(k, :) = trial%difference(i, :)
      row%finish%v(k) = trial%next%v(i)
      row%finish%w(k) = trial%next%w(i)
      row%finish%n(k) = trial%next%n(i)
      row%finish%s(k) = trial%next%s(i)
      row%finish%drive(k) = trial%next%drive(i)
   end subroutine enter_step

   !> A flight as it is planned.
   pure subroutine enter_flight(scope, one, k, row)
      type(fast_scope_t), intent(in) :: scope
      type(ordinate_t), intent(in) :: one
      integer, intent(in) :: k
      type(flights_t), intent(inout) :: row

      associate (law => scope%law(one%law), step => scope%ground(one%offset + one%number))
         call seat(law, one, k, row)
         row%step(k) = step%h
         row%f(k, :) = step%f
         row%x(k) = one%x
         row%span(k) = one%span
         row%w(k) = one%w
         row%side(k) = one%side
         row%small(k) = negligible_n*one%rtol*one%v_max
      end associate
      call enter_side(scope, one, k, row)
   end subroutine enter_flight

   !> The polynomials of the side on which a flight takes place.
   pure subroutine enter_side(scope, one, k, row)
      type(fast_scope_t), intent(in) :: scope
      type(ordinate_t), intent(in) :: one
      integer, intent(in) :: k
      type(flights_t), intent(inout) :: row

      associate (law => scope%law(one%law))
         if (row%curve(k) == curve_of(law, one)) return
         row%curve(k) = curve_of(law, one)
         row%coef(k, :, :) = law%coef(:, :, merge(1, 2, one%side > 0))
      end associate
   end subroutine enter_side

   !> Which polynomials an ordinate is on: the number of its law, negative for theta < 0 where the
   !> sides differ.
   pure integer function curve_of(law, ordinate) result(curve)
      type(fast_law_t), intent(in) :: law
      type(ordinate_t), intent(in) :: ordinate

      curve = ordinate%law
      if (ordinate%side < 0 .and. .not. law%is_even) curve = -curve
   end function curve_of

   !> Flights that need no search where there are none: their other numbers may be of any flight.
   pure subroutine blank(first, last, row)
      integer, intent(in) :: first
      integer, intent(in) :: last
      type(flights_t), intent(inout) :: row
      integer :: k

      do k = first, last
         row%slot(k) = 0
         row%step(k) = 1.0e-3_wp
         row%f(k, :) = 0
         row%x(k) = 0
         row%span(k) = 1
         row%v(k) = 1
         row%w(k) = 1
         row%v_max(k) = huge(1.0_wp)
         row%stages(k) = 1
         row%small(k) = huge(1.0_wp)
         row%n_0(k, :) = 0
         row%finish%v(k) = 1
         row%finish%w(k) = 1
      end do
   end subroutine blank

   !> Flights that are no plain ones.
   pure subroutine search_odd(row, pool)
      type(flights_t), intent(inout) :: row
      type(pool_t), intent(inout) :: pool
      integer :: k

      if (.not. any(row%is_odd > 0)) return
      do k = 1, width
         if (.not. row%is_odd(k) > 0 .or. row%slot(k) == 0) cycle
         call search_again(k, row, pool%ordinate(row%slot(k))%failed)
      end do
      call place_impacts(row)
   end subroutine search_odd

   !> Draw the conclusions from what a flight met. Where no flight follows in this step its place in
   !> the row is nobody's.
   pure subroutine judge(scope, k, row, pool)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      type(flights_t), intent(inout) :: row
      type(pool_t), intent(inout) :: pool
      logical :: rests

      associate (slot => row%slot(k))
         associate (one => pool%ordinate(slot))
            one%v_max = row%v_max(k)
            if (row%hits(k) > 0 .and. .not. one%failed) then
               call bounce(scope, k, row, one, rests)
               if (one%failed) then
                  call push(slot, pool%finished)
                  slot = 0
               else if (rests) then
                  call fall_asleep(scope, slot, one%number, row%x_hit(k), pool)
                  slot = 0
               end if
            else if (one%failed) then
               call push(slot, pool%finished)
               slot = 0
            else if (row%span(k) < 1 - row%x(k)) then
               ! It was followed for as long as the flight was expected to take.
               row%span(k) = 1 - row%x(k)
            else
               one%v_max = max(one%v_max, row%finish%v(k))
               call land(scope, row, k, pool)
               slot = 0
            end if
         end associate
      end associate
   end subroutine judge

   !> The end of the step: the ordinate goes on with its team.
   pure subroutine land(scope, row, k, pool)
      type(fast_scope_t), intent(in) :: scope
      type(flights_t), intent(in) :: row
      integer, intent(in) :: k
      type(pool_t), intent(inout) :: pool

      associate (finish => row%finish, slot => row%slot(k))
         associate (team => pool%team(team_of(slot)), i => lane_of(slot), &
            one => pool%ordinate(slot))
            team%now%v(i) = finish%v(k)
            team%now%w(i) = finish%w(k)
            team%now%n(i) = finish%n(k)
            team%now%s(i) = finish%s(k)
            team%now%drive(i) = finish%drive(k)
            call enter_peak(one%v_max, i, team)
            if (abs(team%rate%side(i) - one%side) > 0) then
               team%rate%side(i) = one%side
               associate (law => scope%law(one%law))
                  if (.not. law%is_even) team%rate%coef(i, :, :) = law%coef(:, :, &
                     merge(1, 2, one%side > 0))
               end associate
            end if
            one%number = one%number + 1
            team%at(i) = one%offset + one%number
            if (team%stop(i) == huge(1)) team%stop(i) = 0
            pool%is_called(team_of(slot)) = pool%is_called(team_of(slot)) &
               .or. team%at(i) >= team%stop(i)
            pool%present(team_of(slot)) = pool%present(team_of(slot)) + 1
            team%ready(i) = 1
         end associate
      end associate
   end subroutine land

   !> The largest v so far, and how doubtful it is.
   pure subroutine enter_peak(v_max, i, team)
      real(wp), intent(in) :: v_max
      integer, intent(in) :: i
      !! lane
      type(team_t), intent(inout) :: team

      if (v_max > team%v_max(i)) team%worst(i) = team%now%doubt(i)
      team%v_max(i) = max(team%v_max(i), v_max)
   end subroutine enter_peak

   !> A flight ends on the base: another one begins, or the wall rests.
   pure subroutine bounce(scope, k, row, one, rests)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      !! number of the flight in the row
      type(flights_t), intent(in) :: row
      type(ordinate_t), intent(inout) :: one
      logical, intent(out) :: rests

      one%impacts = one%impacts + 1
      one%failed = .not. row%speed(k) > 0 .or. one%impacts > most_impacts
      one%side = -one%side
      one%w_max = max(one%w_max, row%speed(k))
      one%x = row%x(k)
      one%w = row%w(k)
      rests = .false.
      if (row%may_rest(k) > 0) then
         rests = comes_to_rest(scope%law(one%law), scope%grid(one%grid), &
            scope%loud(one%pair, one%grid)%next, one%number, one%x, row%f_hit(k), one%w, one)
      end if
      ! Not at rest yet, but nothing larger will come.
      if (one%number >= one%quiet) rests = rests .or. is_over(scope%law(one%law), one, one%w)
   end subroutine bounce

end module rwmf_spectrum_fast_lane_events
