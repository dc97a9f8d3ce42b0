!> Queue of the tasks that have not been started, by the kind of their steps, shared by all threads.
module rwmf_spectrum_fast_task_queue
   use rwmf_spectrum_fast_shared_data, only: kinds, task_t
   use rwmf_spectrum_fast_types, only: block_width
   implicit none
   private

   public :: task_queue_t, new_task_queue, assign_first, take_next_task

   integer, parameter :: max_blocks = 16
   !! blocks of a thread; more do not stay in the second cache
   integer, parameter :: cached_blocks = 4
   !! blocks that stay in the innermost cache; more are used only where the final phase with
   !! partly filled blocks is a small part of the run

   !> Tasks in the order in which they are started.
   type :: task_queue_t
      integer, allocatable :: task(:)
      !! (tasks) numbers of the tasks, kind by kind
      integer :: last(0:kinds) = 0
      !! position of the last task of each kind
      integer :: next(kinds) = 1
      !! position of the next task of each kind that is not assigned
      integer :: blocks = 0
      !! blocks of each thread, to which the first tasks are assigned
      integer :: threads = 1
   end type task_queue_t

contains

   !> Sort the tasks by kind; the first of each kind are reserved for `assign_first`.
   pure subroutine new_task_queue(task, threads, queue)
      type(task_t), intent(in) :: task(:)
      !! (tasks) in the order in which those of a kind are started
      integer, intent(in) :: threads
      type(task_queue_t), intent(out) :: queue
      integer :: kind, i, chunks, left

      queue%threads = threads
      allocate (queue%task(0))
      do kind = 1, kinds
         queue%task = [queue%task, pack([(i, i=1, size(task))], task%kind == kind)]
         queue%last(kind) = size(queue%task)
         queue%blocks = queue%blocks + chunks_of(queue, kind)
      end do
      queue%blocks = min(queue%blocks, max(cached_blocks, queue%blocks/16), max_blocks)
      left = queue%blocks
      do kind = 1, kinds
         chunks = min(chunks_of(queue, kind), left)
         left = left - chunks
         queue%next(kind) = min(queue%last(kind - 1) + chunks*block_width*threads, &
            queue%last(kind)) + 1
      end do
   end subroutine new_task_queue

   !> Number of chunks of a kind; a chunk fills one block of each thread.
   pure integer function chunks_of(queue, kind) result(chunks)
      type(task_queue_t), intent(in) :: queue
      integer, intent(in) :: kind

      chunks = (queue%last(kind) - queue%last(kind - 1) + block_width*queue%threads - 1) &
         /(block_width*queue%threads)
   end function chunks_of

   !> First tasks of a block. The tasks of a chunk are assigned to the threads in turn, so that each
   !> gets its share of the expensive ones.
   pure subroutine assign_first(queue, block, thread, kind, number, n)
      type(task_queue_t), intent(in) :: queue
      integer, intent(in) :: block
      !! from 1 to `blocks`
      integer, intent(in) :: thread
      !! from 1 to `threads`
      integer, intent(out) :: kind
      integer, intent(out) :: number(block_width)
      !! numbers of the tasks, the first n
      integer, intent(out) :: n
      integer :: chunk, i

      chunk = block
      do kind = 1, kinds - 1
         if (chunk <= chunks_of(queue, kind)) exit
         chunk = chunk - chunks_of(queue, kind)
      end do
      n = 0
      do i = queue%last(kind - 1) + (chunk - 1)*block_width*queue%threads + thread, &
         min(queue%last(kind), queue%last(kind - 1) + chunk*block_width*queue%threads), &
         queue%threads
         n = n + 1
         number(n) = queue%task(i)
      end do
   end subroutine assign_first

   !> Take the next task of a kind; 0: there is none.
   subroutine take_next_task(queue, kind, number)
      type(task_queue_t), intent(inout) :: queue
      integer, intent(in) :: kind
      integer, intent(out) :: number
      integer :: i

      number = 0
      !$omp atomic read
      i = queue%next(kind)
      !$omp end atomic
      if (i > queue%last(kind)) return
      !$omp atomic capture
      i = queue%next(kind)
      queue%next(kind) = queue%next(kind) + 1
      !$omp end atomic
      if (i <= queue%last(kind)) number = queue%task(i)
   end subroutine take_next_task

end module rwmf_spectrum_fast_task_queue
