!> A pool of ordinates, each at its own time, on one thread.
!>
!> Sixteen form a team, which steps together. An ordinate in whose step something may happen leaves
!> its team and waits until there are enough of its kind to fill a row; the others go on without it.
!> Whoever rests goes straight to the step in which it lifts off, and who is at the end gives its
!> place to the next one. So rows and teams are full whatever periods, mass ratios and steps are. No
!> operation mixes two ordinates: the company changes no bit of a result.
module rwmf_fast_pool
   use rwmf_control, only: count_done, is_cancelled
   use rwmf_fast_flight, only: depart_row, fall_asleep, follow_row
   use rwmf_fast_gather, only: gather_up
   use rwmf_fast_lanes, only: c_3, fast_law_t, seats, step_t, team_t, weights, width
   use rwmf_fast_machine, only: advance
   use rwmf_fast_ordinate, only: ordinate_t
   use rwmf_fast_scope, only: fast_scope_t, fast_task_t
   use rwmf_fast_series, only: step_weights
   use rwmf_fast_slots, only: lane_of, new_pool, pool_t, pull, push, team_of
   use rwmf_kinds, only: pi, wp
   implicit none
   private

   public :: fast_result_t, run_pool

   integer, parameter :: most_teams = 16
   !! of a pool; more do not stay in the cache
   integer, parameter :: gather_every = 16
   !! sweeps
   integer, parameter :: check_every = 64
   !! rounds between two looks at the caller's stop flag
   real(wp), parameter :: error_share(3) = [0.06_wp, 0.02_wp, 0.2_wp]
   !! of what the last of 1, 2, 3 evaluations of N changes is taken for an error; found with spectra
   !! whose errors are known

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
   subroutine run_pool(scope, task, thread, threads, next, result)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      !! (n)
      integer, intent(in) :: thread
      !! from 1 to `threads`
      integer, intent(in) :: threads
      integer, intent(inout) :: next
      !! shared: number of the next task that nobody has begun; 0 at first
      type(fast_result_t), intent(inout) :: result(:)
      !! (n)
      type(pool_t) :: pool
      integer :: teams
      integer :: sweep
      integer :: k
      logical :: stands

      teams = teams_for(size(task), threads)
      call new_pool(teams, pool)
      call deal(scope, task, thread, threads, pool)
      sweep = 0
      do
         stands = .true.
         do k = 1, teams
            call take_turn(scope, k, pool, stands)
         end do
         call refill(scope, task, teams*threads*seats, next, pool, result)
         if (stands .and. pool%events%n + pool%starts%n == 0) exit
         call pass_events(scope, pool)
         sweep = sweep + 1
         if (mod(sweep, gather_every) == 0) call gather_up(pool)
         if (mod(sweep, check_every) == 0) then
            if (is_cancelled(scope%control)) exit
         end if
      end do
   end subroutine run_pool

   pure integer function teams_for(n, threads)
      integer, intent(in) :: n
      !! tasks
      integer, intent(in) :: threads

      teams_for = min(most_teams, (n - 1)/(seats*threads) + 1)
   end function teams_for

   !> The first tasks: neighbours share a team, and teams go to the threads in turn.
   pure subroutine deal(scope, task, thread, threads, pool)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      integer, intent(in) :: thread
      integer, intent(in) :: threads
      type(pool_t), intent(inout) :: pool
      integer :: k, i, number

      do k = 1, size(pool%team)
         do i = 1, seats
            number = ((k - 1)*threads + thread - 1)*seats + i
            if (number <= size(task)) call begin(scope, task, number, (k - 1)*seats + i, pool)
         end do
      end do
   end subroutine deal

   !> Enter the results of those that are at the end, and give their places to others.
   subroutine refill(scope, task, dealt, next, pool, result)
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      integer, intent(in) :: dealt
      !! tasks that were dealt at first
      integer, intent(inout) :: next
      type(pool_t), intent(inout) :: pool
      type(fast_result_t), intent(inout) :: result(:)
      integer :: slot(1)
      integer :: number, n

      do while (pool%finished%n > 0)
         call pull(pool%finished, slot, n)
         associate (one => pool%ordinate(slot(1)))
            result(one%task) = result_of(scope%scheme%stages, one, lane_of(slot(1)), &
               pool%team(team_of(slot(1))))
            call count_done(scope%control)
            one%task = 0
         end associate
         !$omp atomic capture
         next = next + 1
         number = next
         !$omp end atomic
         if (dealt + number <= size(task)) call begin(scope, task, dealt + number, &
            slot(1), pool)
      end do
   end subroutine refill

   pure type(fast_result_t) function result_of(stages, ordinate, i, team) result(result)
      integer, intent(in) :: stages
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(team_t), intent(in) :: team
      real(wp) :: doubt

      result%v_max = max(team%v_max(i), ordinate%v_max)
      doubt = merge(team%now%doubt(i), team%worst(i), ordinate%v_max > team%v_max(i))
      result%error = error_share(stages)*doubt &
         /max(tiny(1.0_wp), ordinate%w_max, sqrt(ordinate%stiffness)*result%v_max)
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
      integer :: i

      i = lane_of(slot)
      omega_s = 2*pi/task(number)%T_s
      associate (team => pool%team(team_of(slot)), law => scope%law(task(number)%law))
         pool%ordinate(slot) = ordinate_t(number, task(number)%law, task(number)%grid, &
            scope%offset(task(number)%grid), 2*scope%xi_s*omega_s, omega_s**2, &
            scope%rtol, 1, 0.0_wp, 0.0_wp, 0, .false., 1, &
            0.0_wp, 1.0_wp, 0.0_wp)
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

   !> One step of a team. Those in whose step something may happen leave it.
   pure subroutine take_turn(scope, k, pool, stands)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      !! the team
      type(pool_t), intent(inout) :: pool
      logical, intent(inout) :: stands
      !! nobody could step so far
      logical :: has_event
      integer :: marked(seats)
      integer :: n
      integer :: i

      associate (team => pool%team(k))
         if (pool%is_called(k)) call line_up(scope, k, pool)
         if (pool%present(k) == 0) return
         stands = .false.
         call advance(scope%instructions, scope%ground, scope%scheme, team, has_event, &
            pool%is_called(k))
         if (.not. has_event) return
         call list_marked(team%event, marked, n)
         pool%present(k) = pool%present(k) - n
         do i = 1, n
            team%ready(marked(i)) = 0
            associate (slot => (k - 1)*seats + marked(i))
               pool%ordinate(slot)%number = team%at(marked(i)) - pool%ordinate(slot)%offset
               call push(slot, pool%events)
            end associate
         end do
      end associate
   end subroutine take_turn

   !> The lanes with a mark. Where they are is not to be guessed: a branch for each would cost more.
   pure subroutine list_marked(mark, list, n)
      real(wp), intent(in) :: mark(seats)
      integer, intent(out) :: list(seats)
      !! the first n
      integer, intent(out) :: n
      integer :: i

      n = 0
      do i = 1, seats
         list(min(n + 1, seats)) = i
         n = n + merge(1, 0, mark(i) > 0)
      end do
   end subroutine list_marked

   !> New weights where the length of the steps changes; who is at the end leaves the team.
   pure subroutine line_up(scope, k, pool)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: k
      type(pool_t), intent(inout) :: pool
      real(wp) :: middle
      integer :: i

      middle = merge(0.5_wp, c_3, scope%scheme%stages == 2)
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
      team%rate%weight(i, :) = reshape(step_weights(ordinate%damping*law%m1, &
         ordinate%stiffness*law%m1 + law%m3_1, step%h, middle), [weights])
   end subroutine weigh

   !> Follow those that wait, in full rows; one more row when those who wait are no fewer than those
   !> who could still join them.
   pure subroutine pass_events(scope, pool)
      type(fast_scope_t), intent(in) :: scope
      type(pool_t), intent(inout) :: pool

      do while (max(pool%events%n, pool%starts%n) >= width)
         call pass_row(scope, pool)
      end do
      if (pool%events%n + pool%starts%n >= max(1, sum(pool%present))) call pass_row(scope, pool)
   end subroutine pass_events

   !> A row of the longer queue.
   pure subroutine pass_row(scope, pool)
      type(fast_scope_t), intent(in) :: scope
      type(pool_t), intent(inout) :: pool

      if (pool%starts%n >= pool%events%n) then
         call depart_row(scope, pool)
      else
         call follow_row(scope, pool)
      end if
   end subroutine pass_row

end module rwmf_fast_pool
