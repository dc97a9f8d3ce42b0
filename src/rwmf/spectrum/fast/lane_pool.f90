!> Pool of the lanes of a thread, and queues of lanes that wait.
module rwmf_spectrum_fast_lane_pool
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int8_t, c_intptr_t, c_loc
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_shared_data, only: kinds
   use rwmf_spectrum_fast_types, only: batch_width, block_width, lane_block_t, substep_batch_t, &
      trial_step_t
   implicit none
   private

   public :: lane_pool_t, queue_t, new_pool, is_block_empty, push, append, dequeue, pop, block_of, &
      lane_of

   !> Queue of slots, or of tasks.
   type :: queue_t
      integer :: n = 0
      integer, allocatable :: slot(:)
   end type queue_t

   !> Work space of a thread. A slot is the number of a lane, counted over all blocks.
   type :: lane_pool_t
      type(lane_block_t), pointer :: block(:) => null()
      !! in `store`
      integer, allocatable :: n_active(:)
      !! (blocks) number of lanes that step with the block
      logical, allocatable :: needs_update(:)
      !! (blocks) a lane has reached a step of another length, or its end
      integer, allocatable :: kind(:)
      !! (blocks) kind of the steps, from `kind_of`
      type(ordinate_t), allocatable :: ordinate(:)
      !! (slots) state of the lanes between steps
      type(trial_step_t), pointer :: trial => null()
      !! in `store`
      type(substep_batch_t), pointer :: step_batch => null()
      !! in `store`: waiting steps in which an event is possible
      type(substep_batch_t), pointer :: flight_batch => null()
      !! in `store`: flights that start on the base
      integer :: first_task = 1
      !! lowest number of a task in the pool
      type(queue_t) :: start_queue
      !! slots whose flight starts on the base
      type(queue_t) :: finished_queue
      !! slots whose ordinate is finished
      type(queue_t) :: repeat_queue(kinds)
      !! tasks (not slots) to be repeated, by the kind of their steps
      integer(c_int8_t), allocatable :: store(:)
      !! memory of the blocks, the tentative step and the batches
   end type lane_pool_t

contains

   !> Allocate a pool without ordinates; all numbers are finite.
   subroutine new_pool(blocks, pool)
      integer, intent(in) :: blocks
      type(lane_pool_t), target, intent(out) :: pool
      integer :: k

      call allocate_aligned(blocks, pool)
      allocate (pool%n_active(blocks), pool%needs_update(blocks), pool%kind(blocks), &
         pool%ordinate(blocks*block_width))
      allocate (pool%start_queue%slot(blocks*block_width), &
         pool%finished_queue%slot(blocks*block_width))
      do k = 1, kinds
         allocate (pool%repeat_queue(k)%slot(block_width))
      end do
      pool%n_active = 0
      pool%needs_update = .false.
      pool%kind = 1
      pool%ordinate%task = 0
      do k = 1, blocks
         pool%block(k)%step = 1
         pool%block(k)%length_change = huge(1)
      end do
   end subroutine new_pool

   !> Allocate blocks and batches at the beginning of cache lines: a vector across two lines costs
   !> twice.
   subroutine allocate_aligned(blocks, pool)
      integer, intent(in) :: blocks
      type(lane_pool_t), target, intent(inout) :: pool
      integer, parameter :: cache_line = 64
      !! bytes
      type(lane_block_t), pointer :: block(:)
      type(lane_block_t) :: one_block
      type(substep_batch_t) :: batch
      type(trial_step_t) :: trial
      integer(c_intptr_t) :: address
      integer :: first(4)

      first(1) = 1
      first(2) = first(1) + whole_lines(blocks*(storage_size(one_block)/8))
      first(3) = first(2) + whole_lines(storage_size(trial)/8)
      first(4) = first(3) + whole_lines(storage_size(batch)/8)
      allocate (pool%store(first(4) + whole_lines(storage_size(batch)/8) + cache_line))
      ! Bytes of zero are zeros in real and integer components.
      pool%store = 0
      address = transfer(c_loc(pool%store(1)), address)
      first = first + int(modulo(-address, int(cache_line, c_intptr_t)))
      call c_f_pointer(c_loc(pool%store(first(1))), block, [blocks])
      pool%block => block
      call c_f_pointer(c_loc(pool%store(first(2))), pool%trial)
      call c_f_pointer(c_loc(pool%store(first(3))), pool%step_batch)
      call c_f_pointer(c_loc(pool%store(first(4))), pool%flight_batch)
      pool%step_batch%n_filled = batch_width
      pool%flight_batch%n_filled = batch_width

   contains

      !> Bytes rounded up to whole cache lines.
      pure integer function whole_lines(bytes)
         integer, intent(in) :: bytes

         whole_lines = cache_line*((bytes + cache_line - 1)/cache_line)
      end function whole_lines

   end subroutine allocate_aligned

   !> Append a slot to a queue with room for it.
   pure subroutine push(slot, queue)
      integer, intent(in) :: slot
      type(queue_t), intent(inout) :: queue

      queue%n = queue%n + 1
      queue%slot(queue%n) = slot
   end subroutine push

   !> Append a number to a queue, which grows if it is full.
   pure subroutine append(number, queue)
      integer, intent(in) :: number
      type(queue_t), intent(inout) :: queue

      if (queue%n == size(queue%slot)) queue%slot = [queue%slot, queue%slot]
      call push(number, queue)
   end subroutine append

   !> Remove the first elements of a queue, in the order in which they came.
   pure subroutine dequeue(queue, slot)
      type(queue_t), intent(inout) :: queue
      integer, intent(out) :: slot(:)
      !! no more than the queue holds
      integer :: i

      do i = 1, size(slot)
         slot(i) = queue%slot(i)
      end do
      do i = size(slot) + 1, queue%n
         queue%slot(i - size(slot)) = queue%slot(i)
      end do
      queue%n = queue%n - size(slot)
   end subroutine dequeue

   !> Remove the last element of a queue whose order does not matter; 0: the queue is empty.
   pure subroutine pop(queue, number)
      type(queue_t), intent(inout) :: queue
      integer, intent(out) :: number

      number = 0
      if (queue%n == 0) return
      number = queue%slot(queue%n)
      queue%n = queue%n - 1
   end subroutine pop

   !> Has a block no ordinates?
   pure logical function is_block_empty(pool, k)
      type(lane_pool_t), intent(in) :: pool
      integer, intent(in) :: k
      !! number of the block

      is_block_empty = all(pool%ordinate((k - 1)*block_width + 1:k*block_width)%task == 0)
   end function is_block_empty

   !> Number of the block of a slot.
   pure integer function block_of(slot)
      integer, intent(in) :: slot

      block_of = (slot - 1)/block_width + 1
   end function block_of

   !> Number of the lane of a slot in its block.
   pure integer function lane_of(slot)
      integer, intent(in) :: slot

      lane_of = mod(slot - 1, block_width) + 1
   end function lane_of

end module rwmf_spectrum_fast_lane_pool
