!> What happens to the lanes inside a step: impacts, peaks, rest and lift-off.
!>
!> The flights of all lanes concerned are integrated and searched together (`fast_piece.F90`); here
!> each one's outcome is judged. What goes on after an impact is put in a row with the others again,
!> until nothing is left.
module rwmf_fast_flight
   use rwmf_fast_energy, only: is_over
   use rwmf_fast_grid, only: fast_grid_t, ground_at
   use rwmf_fast_lanes, only: fast_law_t, flights_t, lane_state_t, step_t, width
   use rwmf_fast_machine, only: depart, follow, locate
   use rwmf_fast_ordinate, only: ordinate_t
   use rwmf_fast_rest, only: comes_to_rest, find_wake
   use rwmf_fast_search, only: search_again
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: pass_events, fall_asleep

   integer, parameter :: most_impacts = 200000
   !! of one ordinate: beyond, the general kernel has the better rules
   real(wp), parameter :: negligible_n = 1.0e-4_wp
   !! part of the tolerance below which a change of v by N is left out
   real(wp), parameter :: last_x = 1 - 1.0e-13_wp
   !! an impact on the very end of a step leaves a last part that is only formally one

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

   !> Follow the lanes in which something happens to the end of the step, or to rest.
   pure subroutine pass_events(level, law, grid, loud, number, wakes, flights, ordinate, now)
      integer, intent(in) :: level
      !! instruction set
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! from `loud_steps`
      integer, intent(in) :: number
      !! of the step
      logical, intent(in) :: wakes
      !! a resting lane may lift off in it
      type(flights_t), intent(inout) :: flights
      !! in: the lanes in motion at its beginning
      type(ordinate_t), intent(inout) :: ordinate(:)
      !! (lanes)
      type(lane_state_t), intent(inout) :: now
      !! out: at its end, for these lanes and those that wake in it

      associate (step => grid%step(number))
         if (flights%used > 0) then
            call pad(flights)
            call follow(level, law, step, flights)
            call locate(level, 0, flights)
            call judge(law, grid, loud, number, flights, ordinate, now)
         end if
         if (wakes) call wake_up(number, flights, ordinate)
         do while (flights%used > 0)
            call pad(flights)
            call depart(level, law, step, flights)
            call locate(level, 1, flights)
            call judge(law, grid, loud, number, flights, ordinate, now)
         end do
      end associate
   end subroutine pass_events

   !> Fill up to whole vectors.
   pure subroutine pad(flights)
      type(flights_t), intent(inout) :: flights
      integer :: k

      flights%n = width*((flights%used + width - 1)/width)
      do k = flights%used + 1, flights%n
         call copy_flight(1, k, flights)
      end do
   end subroutine pad

   pure subroutine copy_flight(from, to, flights)
      integer, intent(in) :: from
      integer, intent(in) :: to
      type(flights_t), intent(inout) :: flights

      flights%lane(to) = flights%lane(from)
      flights%x(to) = flights%x(from)
      flights%span(to) = flights%span(from)
      flights%v(to) = flights%v(from)
      flights%w(to) = flights%w(from)
      flights%side(to) = flights%side(from)
      flights%damping(to) = flights%damping(from)
      flights%stiffness(to) = flights%stiffness(from)
      flights%v_max(to) = flights%v_max(from)
      flights%small(to) = flights%small(from)
      flights%n_0(to, :) = flights%n_0(from, :)
      flights%finish%v(to) = flights%finish%v(from)
      flights%finish%w(to) = flights%finish%w(from)
   end subroutine copy_flight

   !> Add the lanes that lift off in this step.
   pure subroutine wake_up(number, flights, ordinate)
      integer, intent(in) :: number
      type(flights_t), intent(inout) :: flights
      type(ordinate_t), intent(inout) :: ordinate(:)
      integer :: i

      do i = 1, size(ordinate)
         if (.not. ordinate(i)%rests .or. ordinate(i)%wake_step /= number) cycle
         ordinate(i)%rests = .false.
         ordinate(i)%side = ordinate(i)%wake_side
         call start_flight(i, min(ordinate(i)%wake_x, last_x), 0.0_wp, ordinate(i), flights)
      end do
   end subroutine wake_up

   !> Put a flight that starts on the base in the row.
   pure subroutine start_flight(lane, x, w, ordinate, flights)
      integer, intent(in) :: lane
      real(wp), intent(in) :: x
      !! [-]
      real(wp), intent(in) :: w
      !! [1/s]
      type(ordinate_t), intent(in) :: ordinate
      type(flights_t), intent(inout) :: flights

      flights%used = flights%used + 1
      associate (k => flights%used)
         flights%lane(k) = lane
         flights%x(k) = x
         flights%span(k) = 1 - x
         flights%v(k) = 0
         flights%w(k) = w
         flights%side(k) = ordinate%side
         flights%damping(k) = ordinate%damping
         flights%stiffness(k) = ordinate%stiffness
         flights%v_max(k) = ordinate%v_max
         flights%small(k) = negligible_n*ordinate%rtol*ordinate%v_max
         flights%n_0(k, :) = 0
      end associate
   end subroutine start_flight

   !> Draw the conclusions from what the flights met; those that go on move to the front.
   pure subroutine judge(law, grid, loud, number, flights, ordinate, now)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      type(flights_t), intent(inout) :: flights
      type(ordinate_t), intent(inout) :: ordinate(:)
      type(lane_state_t), intent(inout) :: now
      integer :: used
      integer :: k

      used = flights%used
      flights%used = 0
      do k = 1, used
         associate (one => ordinate(flights%lane(k)))
            if (flights%is_odd(k) > 0) call search_again(k, flights, one%failed)
            one%v_max = max(one%v_max, flights%peak(k))
            if (one%failed) then
               call give_up(flights%lane(k), size(loud), one, now)
            else if (flights%hits(k) > 0) then
               call hit(law, grid, loud, number, k, one, flights, now)
            else if (flights%span(k) < 1 - flights%x(k)) then
               ! It was followed for as long as the flight was expected to take.
               call start_flight(flights%lane(k), flights%x(k), flights%w(k), one, flights)
            else
               one%v_max = max(one%v_max, flights%finish%v(k))
               call land(k, flights, now)
            end if
         end associate
      end do
   end subroutine judge

   !> State of a lane at the end of the step.
   pure subroutine land(k, flights, now)
      integer, intent(in) :: k
      type(flights_t), intent(in) :: flights
      type(lane_state_t), intent(inout) :: now

      associate (i => flights%lane(k), finish => flights%finish)
         now%v(i) = finish%v(k)
         now%w(i) = finish%w(k)
         now%n(i) = finish%n(k)
         now%s(i) = finish%s(k)
         now%drive(i) = finish%drive(k)
      end associate
   end subroutine land

   !> No motion.
   pure subroutine stop_lane(i, now)
      integer, intent(in) :: i
      type(lane_state_t), intent(inout) :: now

      now%v(i) = 0
      now%w(i) = 0
      now%n(i) = 0
      now%s(i) = 0
      now%drive(i) = 0
   end subroutine stop_lane

   !> Leave an ordinate to the general kernel.
   pure subroutine give_up(i, never, ordinate, now)
      integer, intent(in) :: i
      !! lane
      integer, intent(in) :: never
      !! a step beyond the last one
      type(ordinate_t), intent(inout) :: ordinate
      type(lane_state_t), intent(inout) :: now

      ordinate%failed = .true.
      ordinate%rests = .true.
      ordinate%wake_step = never
      call stop_lane(i, now)
   end subroutine give_up

   !> A flight ends on the base: another one begins, or the wall rests.
   pure subroutine hit(law, grid, loud, number, k, ordinate, flights, now)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      integer, intent(in) :: k
      !! number of the flight
      type(ordinate_t), intent(inout) :: ordinate
      type(flights_t), intent(inout) :: flights
      type(lane_state_t), intent(inout) :: now
      real(wp) :: x
      real(wp) :: w
      !! rate after the impact [1/s]
      integer :: i

      i = flights%lane(k)
      x = min(flights%x(k) + flights%span(k)*flights%y(k), last_x)
      w = -flights%w_hit(k)/(flights%span(k)*grid%step(number)%h)
      call bounce(law, grid, loud, number, x, w, ordinate)
      w = law%e*w
      if (ordinate%failed) then
         call give_up(i, size(loud), ordinate, now)
      else if (ordinate%rests) then
         call fall_asleep(law, grid, loud, number, x, ordinate)
         call stop_lane(i, now)
         if (ordinate%wake_step /= number) return
         ordinate%rests = .false.
         ordinate%side = ordinate%wake_side
         call start_flight(i, min(ordinate%wake_x, last_x), 0.0_wp, ordinate, flights)
      else
         call start_flight(i, x, w, ordinate, flights)
         call shorten(law, grid%step(number), flights)
      end if
   end subroutine hit

   !> A flight after an impact is followed over the time that it is expected to take only, when
   !> that is much less than the rest of the step.
   pure subroutine shorten(law, step, flights)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      type(flights_t), intent(inout) :: flights
      real(wp) :: pull
      !! towards the base [1/s2]

      associate (k => flights%used)
         pull = law%m3 + law%m2*flights%side(k)*ground_at(step, flights%x(k)) &
            + law%m1*flights%damping(k)*flights%w(k)
         if (2.5_wp*flights%w(k) < 0.5_wp*flights%span(k)*step%h*pull) then
            flights%span(k) = 2.5_wp*flights%w(k)/(pull*step%h)
         end if
      end associate
   end subroutine shorten

   !> Impact with the rate w towards the base.
   pure subroutine bounce(law, grid, loud, number, x, w, ordinate)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      real(wp), intent(in) :: x
      real(wp), intent(in) :: w
      !! [1/s]
      type(ordinate_t), intent(inout) :: ordinate

      ordinate%impacts = ordinate%impacts + 1
      ordinate%failed = .not. w > 0 .or. ordinate%impacts > most_impacts
      ordinate%side = -ordinate%side
      ordinate%w_max = max(ordinate%w_max, w)
      ordinate%rests = comes_to_rest(law, grid, loud, number, x, law%e*w, ordinate)
      ! Not at rest yet, but nothing larger will come.
      if (number >= grid%quiet) ordinate%rests = ordinate%rests .or. is_over(law, ordinate, law%e*w)
   end subroutine bounce

end module rwmf_fast_flight
