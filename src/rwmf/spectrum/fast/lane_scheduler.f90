!> Lane scheduler of one thread: ordinates, each at a time of its own, advance in the lanes of a
!> pool.
!>
!> The lanes of a block step together. A lane in whose step an event is possible leaves the block
!> until a batch of such steps is followed; the other lanes go on. A wall at rest continues in the
!> step in which it lifts off. The lane of a finished ordinate is given to the next task. Blocks and
!> batches thus stay full for any mixture of periods, mass ratios and steps. No operation mixes two
!> lanes: the bits of a result do not depend on the other lanes.
module rwmf_spectrum_fast_lane_scheduler
   use rwmf_core_control, only: count_done, is_cancelled
   use rwmf_core_kinds, only: pi, wp
   use rwmf_spectrum_fast_compaction, only: compact_blocks
   use rwmf_spectrum_fast_lane_events, only: follow_new_flights, follow_steps, load_step, &
      max_impacts, put_to_rest
   use rwmf_spectrum_fast_lane_pool, only: append, block_of, is_block_empty, lane_of, lane_pool_t, &
      new_pool, pop, push
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_polynomial_fit, only: widen_range
   use rwmf_spectrum_fast_shared_data, only: kind_of, kinds, max_stages, pair_of, shared_data_t, &
      task_t
   use rwmf_spectrum_fast_simd_dispatch, only: advance_block
   use rwmf_spectrum_fast_task_queue, only: assign_first, take_next_task, task_queue_t
   use rwmf_spectrum_fast_taylor_oscillator, only: step_weights
   use rwmf_spectrum_fast_types, only: batch_width, block_width, c_3, ground_step_t, lane_block_t, &
      reduced_equation_t, weights
   implicit none
   private

   public :: ordinate_result_t, run_scheduler

   integer, parameter :: compact_every = 16
   !! rounds between two compactions of the blocks
   integer, parameter :: critical_tasks = 4
   !! number of tasks, the first ones of those in the pool, that take longest: the shortest periods
   integer, parameter :: critical_batch = 3*batch_width/4
   !! flights that make a batch if one of them belongs to a critical task
   integer, parameter :: check_every = 64
   !! rounds between two checks of the caller's stop flag
   real(wp), parameter :: error_share(3) = [0.06_wp, 0.02_wp, 0.2_wp]
   !! error over the correction by the last of 1, 2, 3 evaluations of N, calibrated on spectra whose
   !! errors are known (docs/fast.md) [-]
   real(wp), parameter :: large_angle = 0.95_wp
   !! omega_s h beyond which the error estimate is not damped [rad]
   real(wp), parameter :: wide_angle = 0.7_wp
   !! omega_s h beyond which substeps take three evaluations of N instead of two, because their
   !! errors are not in the estimate [rad]
   real(wp), parameter :: large_angle_factor = 2
   !! factor of the error estimate beyond `large_angle` with one or two evaluations [-]

   !> Result of a task.
   type :: ordinate_result_t
      real(wp) :: v_max = 0
      !! largest |u_s|/(2R) [-]
      real(wp) :: error = 0
      !! estimate of its relative error [-]
      logical :: failed = .true.
      !! left to the general kernel
   end type ordinate_result_t

contains

   !> Compute tasks until none is left; called once by each thread.
   subroutine run_scheduler(shared, task, thread, queue, result)
      type(shared_data_t), intent(inout) :: shared
      !! by all threads
      type(task_t), intent(inout) :: task(:)
      !! (n) shared; a task that leaves the range of its equation gets a wider one
      integer, intent(in) :: thread
      !! number of the thread, from 1
      type(task_queue_t), intent(inout) :: queue
      !! shared: the tasks that have not been started
      type(ordinate_result_t), intent(inout) :: result(:)
      !! (n)
      type(lane_pool_t) :: pool
      integer :: round
      integer :: k
      logical :: is_stalled

      call new_pool(queue%blocks, pool)
      call load_lanes(shared, task, thread, queue, pool)
      round = 0
      do
         is_stalled = .true.
         do k = 1, size(pool%block)
            call advance_lanes(shared, k, pool, is_stalled)
         end do
         call replace_finished(shared, task, queue, pool, result)
         if (is_stalled .and. n_waiting(pool) == 0) then
            if (all(pool%ordinate%task == 0)) call fill_idle_lanes(shared, task, queue, pool)
            if (all(pool%ordinate%task == 0)) exit
         end if
         call follow_waiting(shared, pool)
         round = round + 1
         if (mod(round, compact_every) == 0) then
            call compact_blocks(pool)
            pool%first_task = minval(pool%ordinate%task, mask=pool%ordinate%task > 0)
            call fill_idle_lanes(shared, task, queue, pool)
         end if
         if (mod(round, check_every) == 0) then
            if (is_cancelled(shared%control)) exit
         end if
      end do
   end subroutine run_scheduler

   !> Load the lanes with the tasks assigned to the thread.
   pure subroutine load_lanes(shared, task, thread, queue, pool)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      integer, intent(in) :: thread
      type(task_queue_t), intent(in) :: queue
      type(lane_pool_t), intent(inout) :: pool
      integer :: number(block_width)
      integer :: k, i, n

      do k = 1, size(pool%block)
         call assign_first(queue, k, thread, pool%kind(k), number, n)
         do i = 1, n
            call start_ordinate(shared, task, number(i), (k - 1)*block_width + i, pool)
         end do
      end do
   end subroutine load_lanes

   !> Store the results of finished ordinates and start the next tasks in their lanes.
   subroutine replace_finished(shared, task, queue, pool, result)
      type(shared_data_t), intent(inout) :: shared
      type(task_t), intent(inout) :: task(:)
      type(task_queue_t), intent(inout) :: queue
      type(lane_pool_t), intent(inout) :: pool
      type(ordinate_result_t), intent(inout) :: result(:)
      integer :: slot
      integer :: number

      do
         call pop(pool%finished_queue, slot)
         if (slot == 0) exit
         call finish_ordinate(shared, slot, task, pool, result)
         call choose_task(pool%kind(block_of(slot)), queue, pool, number)
         if (number > 0) call start_ordinate(shared, task, number, slot, pool)
      end do
   end subroutine replace_finished

   !> Store the result of an ordinate and free its lane. The task is queued for repetition on a
   !> wider range if it has left that of its equation, and with all evaluations of N if its error is
   !> too large.
   subroutine finish_ordinate(shared, slot, task, pool, result)
      type(shared_data_t), intent(inout) :: shared
      integer, intent(in) :: slot
      type(task_t), intent(inout) :: task(:)
      type(lane_pool_t), intent(inout) :: pool
      type(ordinate_result_t), intent(inout) :: result(:)
      integer :: number, stages
      logical :: is_repeated

      number = pool%ordinate(slot)%task
      stages = shared%scheme(pool%kind(block_of(slot)))%stages
      associate (outcome => result(number))
         outcome = result_of(stages, pool%ordinate(slot), lane_of(slot), pool%block(block_of(slot)))
         is_repeated = .false.
         if (pool%ordinate(slot)%impacts > max_impacts) then
            outcome%failed = .true.
         else if (outcome%failed &
            .or. .not. outcome%v_max <= shared%equation(task(number)%equation)%v_high) then
            call widen_range(shared, task(number), is_repeated)
         else if (outcome%error > shared%rtol) then
            is_repeated = stages < max_stages
            stages = max_stages
         else
            ! Other ordinates are counted where they are computed in the end.
            call count_done(shared%control)
         end if
      end associate
      if (is_repeated) then
         call append(number, &
            pool%repeat_queue(kind_of(stages, shared%equation(task(number)%equation)%is_short)))
      end if
      pool%ordinate(slot)%task = 0
   end subroutine finish_ordinate

   !> Next task with steps of a kind, repetitions first; 0: none.
   subroutine choose_task(kind, queue, pool, number)
      integer, intent(in) :: kind
      type(task_queue_t), intent(inout) :: queue
      type(lane_pool_t), intent(inout) :: pool
      integer, intent(out) :: number

      number = 0
      call pop(pool%repeat_queue(kind), number)
      if (number == 0) call take_next_task(queue, kind, number)
   end subroutine choose_task

   !> Start tasks of any kind in blocks without ordinates.
   subroutine fill_idle_lanes(shared, task, queue, pool)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      type(task_queue_t), intent(inout) :: queue
      type(lane_pool_t), intent(inout) :: pool
      integer :: k, kind, i, number

      do k = 1, size(pool%block)
         if (.not. is_block_empty(pool, k)) cycle
         do kind = 1, kinds
            do i = 1, block_width
               call choose_task(kind, queue, pool, number)
               if (number == 0) exit
               pool%kind(k) = kind
               call start_ordinate(shared, task, number, (k - 1)*block_width + i, pool)
            end do
            if (i > 1) exit
         end do
      end do
   end subroutine fill_idle_lanes

   !> Result of the ordinate in a lane.
   pure type(ordinate_result_t) function result_of(stages, ordinate, i, lanes) result(result)
      integer, intent(in) :: stages
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(lane_block_t), intent(in) :: lanes
      real(wp) :: error_estimate
      real(wp) :: omega_s

      result%v_max = max(lanes%v_max(i), ordinate%v_max)
      error_estimate = merge(lanes%error_estimate(i), lanes%error_at_peak(i), &
         ordinate%v_max > lanes%v_max(i))
      omega_s = sqrt(ordinate%stiffness)
      result%error = error_share(stages)*error_estimate &
         /max(tiny(1.0_wp), ordinate%w_max, omega_s*result%v_max)
      if (omega_s*lanes%constants%h(i) > large_angle .and. stages < max_stages) then
         result%error = large_angle_factor*result%error
      end if
      result%failed = ordinate%failed .or. .not. abs(lanes%now%v(i)) < huge(1.0_wp)
   end function result_of

   !> Start a task in a lane, with the wall at rest.
   pure subroutine start_ordinate(shared, task, number, slot, pool)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      integer, intent(in) :: number
      !! number of the task
      integer, intent(in) :: slot
      type(lane_pool_t), intent(inout) :: pool
      real(wp) :: omega_s
      integer :: stages
      integer :: i

      i = lane_of(slot)
      omega_s = 2*pi/task(number)%T_s
      stages = shared%scheme(pool%kind(block_of(slot)))%stages
      associate (lanes => pool%block(block_of(slot)), &
         equation => shared%equation(task(number)%equation))
         associate (grid => shared%grid(task(number)%grid))
            pool%ordinate(slot) = ordinate_t(task=number, equation=task(number)%equation, &
               pair=pair_of(shared, task(number)%equation), grid=task(number)%grid, &
               offset=grid%first - 1, motion_end_step=grid%motion_end_step, &
               stages=stages_of_substeps(stages, omega_s*grid%longest_step), &
               damping=2*shared%xi_s*omega_s, stiffness=omega_s**2, rtol=shared%rtol)
         end associate
         lanes%constants%m2(i) = equation%m2
         lanes%constants%m3(i) = equation%m3
         lanes%constants%damping(i) = pool%ordinate(slot)%damping
         lanes%constants%stiffness(i) = pool%ordinate(slot)%stiffness
         lanes%constants%side(i) = 1
         lanes%constants%coef(i, :, :) = equation%coef(:, :, 1)
         lanes%error_estimate(i) = 0
         lanes%v_max(i) = 0
         lanes%error_at_peak(i) = 0
         lanes%constants%h(i) = 0
         lanes%ready(i) = 0
         lanes%length_change(i) = huge(1)
      end associate
      call put_to_rest(shared, slot, 1, 0.0_wp, pool)
   end subroutine start_ordinate

   !> Evaluations of N in substeps.
   pure integer function stages_of_substeps(stages, angle)
      integer, intent(in) :: stages
      !! evaluations in whole steps
      real(wp), intent(in) :: angle
      !! omega_s h [rad]

      stages_of_substeps = stages
      if (stages == 2 .and. angle > wide_angle) stages_of_substeps = max_stages
   end function stages_of_substeps

   !> One step of a block. Lanes in which an event is possible leave it.
   pure subroutine advance_lanes(shared, k, pool, is_stalled)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: k
      !! number of the block
      type(lane_pool_t), intent(inout) :: pool
      logical, intent(inout) :: is_stalled
      !! in: no block before this one could step; out: neither could this one
      integer :: event_bits

      if (pool%needs_update(k)) call update_step_size(shared, k, pool)
      if (pool%n_active(k) == 0) return
      is_stalled = .false.
      call advance_block(shared%instructions, shared%ground, shared%scheme(pool%kind(k)), &
         pool%block(k), pool%trial, event_bits, pool%needs_update(k))
      if (event_bits /= 0) call remove_lanes(shared, k, event_bits, pool)
   end subroutine advance_lanes

   !> Move lanes in which an event is possible to the batch of waiting steps, which is followed when
   !> it is full.
   pure subroutine remove_lanes(shared, k, event_bits, pool)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: k
      !! number of the block
      integer, intent(in) :: event_bits
      !! bit i - 1: an event is possible in lane i
      type(lane_pool_t), intent(inout) :: pool
      integer :: slot
      integer :: left
      integer :: i

      pool%n_active(k) = pool%n_active(k) - popcnt(event_bits)
      left = event_bits
      do while (left /= 0)
         i = trailz(left) + 1
         left = iand(left, left - 1)
         pool%block(k)%ready(i) = 0
         slot = (k - 1)*block_width + i
         call load_step(shared, pool%block(k), pool%trial, i, slot, pool%ordinate(slot), &
            pool%step_batch)
         if (pool%step_batch%n_steps == batch_width) call follow_steps(shared, pool)
      end do
   end subroutine remove_lanes

   !> Set the weights of lanes whose step changes its length; lanes at the end leave the block.
   pure subroutine update_step_size(shared, k, pool)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: k
      type(lane_pool_t), intent(inout) :: pool
      real(wp) :: second_node
      integer :: i

      second_node = merge(0.5_wp, c_3, shared%scheme(pool%kind(k))%stages == 2)
      associate (lanes => pool%block(k))
         do i = 1, block_width
            if (.not. lanes%ready(i) > 0 .or. lanes%step(i) < lanes%length_change(i)) cycle
            associate (ordinate => pool%ordinate((k - 1)*block_width + i))
               if (lanes%step(i) > ordinate%offset + size(shared%grid(ordinate%grid)%step)) then
                  lanes%ready(i) = 0
                  pool%n_active(k) = pool%n_active(k) - 1
                  lanes%step(i) = 1
                  lanes%length_change(i) = huge(1)
                  call push((k - 1)*block_width + i, pool%finished_queue)
               else
                  call set_step_weights(shared%equation(ordinate%equation), &
                     shared%ground(lanes%step(i)), second_node, ordinate, i, lanes)
               end if
            end associate
         end do
      end associate
   end subroutine update_step_size

   !> Set the length of the next steps of a lane and the weights for it.
   pure subroutine set_step_weights(equation, ground, second_node, ordinate, i, lanes)
      type(reduced_equation_t), intent(in) :: equation
      type(ground_step_t), intent(in) :: ground
      real(wp), intent(in) :: second_node
      !! the second node [-]
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(lane_block_t), intent(inout) :: lanes

      lanes%length_change(i) = lanes%step(i) + ground%equal_steps
      if (abs(ground%h - lanes%constants%h(i)) <= 0) return
      lanes%constants%h(i) = ground%h
      lanes%constants%inverse_h(i) = 1/ground%h
      lanes%constants%damping_factor(i) = max(0.0_wp, &
         1 - 0.5_wp*ground%h*ordinate%damping*equation%m1)
      if (ground%h*sqrt(ordinate%stiffness) > large_angle) lanes%constants%damping_factor(i) = 1
      lanes%constants%weight(i, :) = reshape(step_weights(ordinate%damping*equation%m1, &
         ordinate%stiffness*equation%m1 + equation%m3_1, ground%h, second_node), [weights])
   end subroutine set_step_weights

   !> Follow waiting lanes: flights that start on the base in full batches; steps, with flights at
   !> the free places, when as many lanes wait as still step, or when a critical lane waits.
   pure subroutine follow_waiting(shared, pool)
      type(shared_data_t), intent(in) :: shared
      type(lane_pool_t), intent(inout) :: pool

      do while (pool%start_queue%n >= batch_width)
         call follow_new_flights(shared, pool)
      end do
      if (n_waiting(pool) >= max(1, sum(pool%n_active)) .or. has_critical_lane(pool)) then
         call follow_steps(shared, pool)
      end if
   end subroutine follow_waiting

   !> Number of lanes that wait for a batch.
   pure integer function n_waiting(pool)
      type(lane_pool_t), intent(in) :: pool

      n_waiting = pool%step_batch%n_steps + pool%start_queue%n
   end function n_waiting

   !> Does the lane of a critical task wait, with enough others for a batch?
   !>
   !> Critical tasks are long chains of flights: a delay of one of them delays the end of the run.
   pure logical function has_critical_lane(pool)
      type(lane_pool_t), intent(in) :: pool
      integer :: i

      has_critical_lane = .false.
      if (n_waiting(pool) < critical_batch) return
      do i = 1, pool%step_batch%n_steps
         has_critical_lane = has_critical_lane &
            .or. pool%ordinate(pool%step_batch%slot(i))%task - pool%first_task < critical_tasks
      end do
      do i = 1, pool%start_queue%n
         has_critical_lane = has_critical_lane &
            .or. pool%ordinate(pool%start_queue%slot(i))%task - pool%first_task < critical_tasks
      end do
   end function has_critical_lane

end module rwmf_spectrum_fast_lane_scheduler
