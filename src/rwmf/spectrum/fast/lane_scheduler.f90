!> A pool of ordinates, each at its own time, on one thread.
!>
!> Sixteen form a team, which steps together. An ordinate in whose step something may happen leaves
!> its team and waits until there are enough to fill a row; the others go on without it.
!> Whoever rests goes straight to the step in which it lifts off, and who is at the end gives its
!> place to the next one. So rows and teams are full whatever periods, mass ratios and steps are. No
!> operation mixes two ordinates: the company changes no bit of a result.
module rwmf_spectrum_fast_lane_scheduler
   use rwmf_core_control, only: count_done, is_cancelled
   use rwmf_spectrum_fast_task_queue, only: deal, deck_t, draw
   use rwmf_spectrum_fast_polynomial_fit, only: widen
   use rwmf_spectrum_fast_lane_events, only: depart_row, enter_step, fall_asleep, follow_row, &
      most_impacts
   use rwmf_spectrum_fast_compaction, only: gather_up
   use rwmf_spectrum_fast_types, only: c_3, fast_law_t, seats, step_t, team_t, weights, width
   use rwmf_spectrum_fast_simd_dispatch, only: advance
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_shared_data, only: fast_scope_t, fast_task_t, kind_of, kinds, &
      most_stages, pair_of
   use rwmf_spectrum_fast_taylor_oscillator, only: step_weights
   use rwmf_spectrum_fast_lane_pool, only: append, is_empty, lane_of, new_pool, pool_t, pop, push, &
      team_of
   use rwmf_core_kinds, only: pi, wp
   implicit none
   private

   public :: fast_result_t, run_pool

   integer, parameter :: gather_every = 16
   !! sweeps
   integer, parameter :: urgent = 4
   !! members of the pool, those whose periods were begun first: the shortest ones
   integer, parameter :: enough = 3*width/4
   !! flights in a row with one of theirs
   integer, parameter :: check_every = 64
   !! rounds between two looks at the caller's stop flag
   real(wp), parameter :: error_share(3) = [0.06_wp, 0.02_wp, 0.2_wp]
   !! of what the last of 1, 2, 3 evaluations of N changes is taken for an error; found with spectra
   !! whose errors are known (docs/fast.md)
   real(wp), parameter :: large_angle = 0.95_wp
   !! omega_s h beyond which what is wrong does not fade with the damping [rad]
   real(wp), parameter :: wide_angle = 0.7_wp
   !! omega_s h beyond which flights within a step take three evaluations of N, not two [rad]: their
   !! errors are not in the estimate
   real(wp), parameter :: more = 2
   !! times as much is taken for an error there, with fewer than all evaluations

   !> What was found of a task.
   type :: fast_result_t
      real(wp) :: v_max = 0
      !! largest |u_s|/(2R) [-]
      real(wp) :: error = 0
      !! estimate of its relative error [-]
      logical :: failed = .true.
      !! left to the general kernel
   end type fast_result_t

contains

   !> Compute tasks until none is left; each thread runs a pool.
   subroutine run_pool(scope, task, thread, deck, result)
      type(fast_scope_t), intent(inout) :: scope
      !! shared
      type(fast_task_t), intent(inout) :: task(:)
      !! (n) shared; one that leaves the range of its law gets a wider one
      integer, intent(in) :: thread
      !! its number
      type(deck_t), intent(inout) :: deck
      !! shared: the tasks that nobody has begun
      type(fast_result_t), intent(inout) :: result(:)
      !! (n)
      type(pool_t) :: pool
      integer :: sweep
      integer :: k
      logical :: stands

      call new_pool(deck%teams, pool)
      call take_places(scope, task, thread, deck, pool)
      sweep = 0
      do
         stands = .true.
         do k = 1, size(pool%team)
            call take_turn(scope, k, pool, stands)
         end do
         call refill(scope, task, deck, pool, result)
         if (stands .and. waiting(pool) == 0) then
            if (all(pool%ordinate%task == 0)) call employ(scope, task, deck, pool)
            if (all(pool%ordinate%task == 0)) exit
         end if
         call pass_events(scope, pool)
         sweep = sweep + 1
         if (mod(sweep, gather_every) == 0) then
            call gather_up(pool)
            pool%first = minval(pool%ordinate%task, mask=pool%ordinate%task > 0)
            call employ(scope, task, deck, pool)
         end if
         if (mod(sweep, check_every) == 0) then
            if (is_cancelled(scope%control)) exit
         end if
      end do
   end subroutine run_pool

   !> The first members of the teams.
   pure subroutine take_places(scope, task, thread, deck, pool)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      integer, intent(in) :: thread
      type(deck_t), intent(in) :: deck
      type(pool_t), intent(inout) :: pool
      integer :: number(seats)
      integer :: k, i, n

      do k = 1, size(pool%team)
         call deal(deck, k, thread, pool%kind(k), number, n)
         do i = 1, n
            call begin(scope, task, number(i), (k - 1)*seats + i, pool)
         end do
      end do
   end subroutine take_places

   !> Enter the results of those that are at the end, and give their places to others.
   subroutine refill(scope, task, deck, pool, result)
      type(fast_scope_t), intent(inout) :: scope
      type(fast_task_t), intent(inout) :: task(:)
      type(deck_t), intent(inout) :: deck
      type(pool_t), intent(inout) :: pool
      type(fast_result_t), intent(inout) :: result(:)
      integer :: slot
      integer :: number

      do
         call pop(pool%finished, slot)
         if (slot == 0) exit
         call finish(scope, slot, task, pool, result)
         call choose_task(pool%kind(team_of(slot)), deck, pool, number)
         if (number > 0) call begin(scope, task, number, slot, pool)
      end do
   end subroutine refill

   !> An ordinate leaves its place. It will be repeated if it has left the range of its law, and
   !> with all evaluations of N if its error is too large.
   subroutine finish(scope, slot, task, pool, result)
      type(fast_scope_t), intent(inout) :: scope
      integer, intent(in) :: slot
      type(fast_task_t), intent(inout) :: task(:)
      type(pool_t), intent(inout) :: pool
      type(fast_result_t), intent(inout) :: result(:)
      integer :: number, stages
      logical :: again

      number = pool%ordinate(slot)%task
      stages = scope%scheme(pool%kind(team_of(slot)))%stages
      associate (found => result(number))
         found = result_of(stages, pool%ordinate(slot), lane_of(slot), pool%team(team_of(slot)))
         again = .false.
         if (pool%ordinate(slot)%impacts > most_impacts) then
            found%failed = .true.
         else if (found%failed .or. .not. found%v_max <= scope%law(task(number)%law)%v_high) then
            call widen(scope, task(number), again)
         else if (found%error > scope%rtol) then
            again = stages < most_stages
            stages = most_stages
         else
            ! The others are counted where they are done in the end.
            call count_done(scope%control)
         end if
      end associate
      if (again) then
         call append(number, pool%again(kind_of(stages, scope%law(task(number)%law)%is_short)))
      end if
      pool%ordinate(slot)%task = 0
   end subroutine finish

   !> What is begun next with steps of a kind; 0: nothing.
   subroutine choose_task(kind, deck, pool, number)
      integer, intent(in) :: kind
      type(deck_t), intent(inout) :: deck
      type(pool_t), intent(inout) :: pool
      integer, intent(out) :: number

      number = 0
      call pop(pool%again(kind), number)
      if (number == 0) call draw(deck, kind, number)
   end subroutine choose_task

   !> Teams without members begin what is left, of whatever kind.
   subroutine employ(scope, task, deck, pool)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      type(deck_t), intent(inout) :: deck
      type(pool_t), intent(inout) :: pool
      integer :: k, kind, i, number

      do k = 1, size(pool%team)
         if (.not. is_empty(pool, k)) cycle
         do kind = 1, kinds
            do i = 1, seats
               call choose_task(kind, deck, pool, number)
               if (number == 0) exit
               pool%kind(k) = kind
               call begin(scope, task, number, (k - 1)*seats + i, pool)
            end do
            if (i > 1) exit
         end do
      end do
   end subroutine employ

   pure type(fast_result_t) function result_of(stages, ordinate, i, team) result(result)
      integer, intent(in) :: stages
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(team_t), intent(in) :: team
      real(wp) :: doubt
      real(wp) :: omega_s

      result%v_max = max(team%v_max(i), ordinate%v_max)
      doubt = merge(team%now%doubt(i), team%worst(i), ordinate%v_max > team%v_max(i))
      omega_s = sqrt(ordinate%stiffness)
      result%error = error_share(stages)*doubt &
         /max(tiny(1.0_wp), ordinate%w_max, omega_s*result%v_max)
      if (omega_s*team%rate%h(i) > large_angle .and. stages < most_stages) then
         result%error = more*result%error
      end if
      result%failed = ordinate%failed .or. .not. abs(team%now%v(i)) < huge(1.0_wp)
   end function result_of

   !> An ordinate takes its place, at rest.
   pure subroutine begin(scope, task, number, slot, pool)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      integer, intent(in) :: number
      !! of the task
      integer, intent(in) :: slot
      type(pool_t), intent(inout) :: pool
      real(wp) :: omega_s
      integer :: stages
      integer :: i

      i = lane_of(slot)
      omega_s = 2*pi/task(number)%T_s
      stages = scope%scheme(pool%kind(team_of(slot)))%stages
      associate (team => pool%team(team_of(slot)), law => scope%law(task(number)%law))
         associate (grid => scope%grid(task(number)%grid))
            pool%ordinate(slot) = ordinate_t(task=number, law=task(number)%law, &
               pair=pair_of(scope, task(number)%law), grid=task(number)%grid, &
               offset=grid%first - 1, quiet=grid%quiet, &
               stages=stages_of_flights(stages, omega_s*grid%longest), &
               damping=2*scope%xi_s*omega_s, stiffness=omega_s**2, rtol=scope%rtol)
         end associate
         team%rate%m2(i) = law%m2
         team%rate%m3(i) = law%m3
         team%rate%damping(i) = pool%ordinate(slot)%damping
         team%rate%stiffness(i) = pool%ordinate(slot)%stiffness
         team%rate%side(i) = 1
         team%rate%coef(i, :, :) = law%coef(:, :, 1)
         team%now%doubt(i) = 0
         team%v_max(i) = 0
         team%worst(i) = 0
         team%rate%h(i) = 0
         team%ready(i) = 0
         team%stop(i) = huge(1)
      end associate
      call fall_asleep(scope, slot, 1, 0.0_wp, pool)
   end subroutine begin

   !> Evaluations of N in flights that begin within a step.
   pure integer function stages_of_flights(stages, angle)
      integer, intent(in) :: stages
      !! in whole steps
      real(wp), intent(in) :: angle
      !! omega_s h [rad]

      stages_of_flights = stages
      if (stages == 2 .and. angle > wide_angle) stages_of_flights = most_stages
   end function stages_of_flights

   !> One step of a team. Those in whose step something may happen leave it.
   pure subroutine take_turn(scope, k, pool, stands)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      !! the team
      type(pool_t), intent(inout) :: pool
      logical, intent(inout) :: stands
      !! nobody could step so far
      integer :: marks

      if (pool%is_called(k)) call line_up(scope, k, pool)
      if (pool%present(k) == 0) return
      stands = .false.
      call advance(scope%instructions, scope%ground, scope%scheme(pool%kind(k)), pool%team(k), &
         pool%trial, marks, pool%is_called(k))
      if (marks /= 0) call dismiss(scope, k, marks, pool)
   end subroutine take_turn

   !> Those in whose step something may happen wait until there are enough of them.
   pure subroutine dismiss(scope, k, marks, pool)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      !! the team
      integer, intent(in) :: marks
      !! bit i - 1: lane i
      type(pool_t), intent(inout) :: pool
      integer :: slot
      integer :: left
      integer :: i

      pool%present(k) = pool%present(k) - popcnt(marks)
      left = marks
      do while (left /= 0)
         i = trailz(left) + 1
         left = iand(left, left - 1)
         pool%team(k)%ready(i) = 0
         slot = (k - 1)*seats + i
         call enter_step(scope, pool%team(k), pool%trial, i, slot, pool%ordinate(slot), &
            pool%events)
         if (pool%events%used == width) call follow_row(scope, pool)
      end do
   end subroutine dismiss

   !> New weights where the length of the steps changes; who is at the end leaves the team.
   pure subroutine line_up(scope, k, pool)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      type(pool_t), intent(inout) :: pool
      real(wp) :: middle
      integer :: i

      middle = merge(0.5_wp, c_3, scope%scheme(pool%kind(k))%stages == 2)
      associate (team => pool%team(k))
         do i = 1, seats
            if (.not. team%ready(i) > 0 .or. team%at(i) < team%stop(i)) cycle
            associate (one => pool%ordinate((k - 1)*seats + i))
               if (team%at(i) > one%offset + size(scope%grid(one%grid)%step)) then
                  team%ready(i) = 0
                  pool%present(k) = pool%present(k) - 1
                  team%at(i) = 1
                  team%stop(i) = huge(1)
                  call push((k - 1)*seats + i, pool%finished)
               else
                  call weigh(scope%law(one%law), scope%ground(team%at(i)), middle, one, i, team)
               end if
            end associate
         end do
      end associate
   end subroutine line_up

   !> Weights of the steps that come now.
   pure subroutine weigh(law, step, middle, ordinate, i, team)
      type(fast_law_t), intent(in) :: law
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: middle
      !! the second node [-]
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(team_t), intent(inout) :: team

      team%stop(i) = team%at(i) + step%alike
      if (abs(step%h - team%rate%h(i)) <= 0) return
      team%rate%h(i) = step%h
      team%rate%per_h(i) = 1/step%h
      team%rate%keep(i) = max(0.0_wp, 1 - 0.5_wp*step%h*ordinate%damping*law%m1)
      if (step%h*sqrt(ordinate%stiffness) > large_angle) team%rate%keep(i) = 1
      team%rate%weight(i, :) = reshape(step_weights(ordinate%damping*law%m1, &
         ordinate%stiffness*law%m1 + law%m3_1, step%h, middle), [weights])
   end subroutine weigh

   !> Follow those that wait: flights that start on the base in full rows, and the rest together
   !> when they are no fewer than those who could still join them, or if someone is in a hurry.
   pure subroutine pass_events(scope, pool)
      type(fast_scope_t), intent(in) :: scope
      type(pool_t), intent(inout) :: pool

      do while (pool%starts%n >= width)
         call depart_row(scope, pool)
      end do
      if (waiting(pool) >= max(1, sum(pool%present)) .or. hurries(pool)) then
         call follow_row(scope, pool)
      end if
   end subroutine pass_events

   !> How many wait for a row.
   pure integer function waiting(pool)
      type(pool_t), intent(in) :: pool

      waiting = pool%events%used + pool%starts%n
   end function waiting

   !> Does one of those that take longest wait, with enough company?
   !>
   !> Their flights follow one after the other; what keeps them waiting delays the end of all.
   pure logical function hurries(pool)
      type(pool_t), intent(in) :: pool
      integer :: i

      hurries = .false.
      if (waiting(pool) < enough) return
      do i = 1, pool%events%used
         hurries = hurries .or. pool%ordinate(pool%events%slot(i))%task - pool%first < urgent
      end do
      do i = 1, pool%starts%n
         hurries = hurries .or. pool%ordinate(pool%starts%slot(i))%task - pool%first < urgent
      end do
   end function hurries

end module rwmf_spectrum_fast_lane_scheduler
