!> The ordinates that nobody has begun, by the kind of their steps: what all threads draw from.
module rwmf_spectrum_fast_task_queue
   use rwmf_spectrum_fast_types, only: seats
   use rwmf_spectrum_fast_shared_data, only: fast_task_t, kinds
   implicit none
   private

   public :: deck_t, new_deck, deal, draw

   integer, parameter :: most_teams = 16
   !! of a thread; more do not stay in the cache
   integer, parameter :: enough_teams = 4
   !! that stay in the innermost cache; more only where the end, when teams are not full any more,
   !! is a small part of all

   !> Tasks in the order in which they are begun.
   type :: deck_t
      integer, allocatable :: task(:)
      !! (tasks) their numbers, kind by kind
      integer :: last(0:kinds) = 0
      !! where each kind ends
      integer :: next(kinds) = 1
      !! shared: the next one of each kind to be drawn
      integer :: teams = 0
      !! of each thread, among which the first ones are dealt
      integer :: threads = 1
   end type deck_t

contains

   !> Sort the tasks by their kinds; the first ones will be dealt, not drawn.
   pure subroutine new_deck(task, threads, deck)
      type(fast_task_t), intent(in) :: task(:)
      !! (tasks) in the order in which those of a kind are begun
      integer, intent(in) :: threads
      type(deck_t), intent(out) :: deck
      integer :: kind, i, chunks, left

      deck%threads = threads
      allocate (deck%task(0))
      do kind = 1, kinds
         deck%task = [deck%task, pack([(i, i=1, size(task))], task%kind == kind)]
         deck%last(kind) = size(deck%task)
         deck%teams = deck%teams + chunks_of(deck, kind)
      end do
      deck%teams = min(deck%teams, max(enough_teams, deck%teams/16), most_teams)
      left = deck%teams
      do kind = 1, kinds
         chunks = min(chunks_of(deck, kind), left)
         left = left - chunks
         deck%next(kind) = min(deck%last(kind - 1) + chunks*seats*threads, deck%last(kind)) + 1
      end do
   end subroutine new_deck

   !> How many chunks of tasks, a team for each thread, a kind makes.
   pure integer function chunks_of(deck, kind) result(chunks)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: kind

      chunks = (deck%last(kind) - deck%last(kind - 1) + seats*deck%threads - 1) &
         /(seats*deck%threads)
   end function chunks_of

   !> The first members of a team. A chunk of tasks is dealt to the threads in turn, one by one: all
   !> of them get their share of the expensive ones.
   pure subroutine deal(deck, team, thread, kind, number, n)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: team
      !! from 1 to `teams`
      integer, intent(in) :: thread
      !! from 1 to `threads`
      integer, intent(out) :: kind
      integer, intent(out) :: number(seats)
      !! of the tasks, the first n
      integer, intent(out) :: n
      integer :: chunk, i

      chunk = team
      do kind = 1, kinds - 1
         if (chunk <= chunks_of(deck, kind)) exit
         chunk = chunk - chunks_of(deck, kind)
      end do
      n = 0
      do i = deck%last(kind - 1) + (chunk - 1)*seats*deck%threads + thread, &
         min(deck%last(kind), deck%last(kind - 1) + chunk*seats*deck%threads), deck%threads
         n = n + 1
         number(n) = deck%task(i)
      end do
   end subroutine deal

   !> The next task of a kind; 0: there is none.
   subroutine draw(deck, kind, number)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: kind
      integer, intent(out) :: number
      integer :: i

      number = 0
      !$omp atomic read
      i = deck%next(kind)
      !$omp end atomic
      if (i > deck%last(kind)) return
      !$omp atomic capture
      i = deck%next(kind)
      deck%next(kind) = deck%next(kind) + 1
      !$omp end atomic
      if (i <= deck%last(kind)) number = deck%task(i)
   end subroutine draw

end module rwmf_spectrum_fast_task_queue
