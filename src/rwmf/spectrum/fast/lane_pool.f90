!> The places of a pool in which ordinates advance, and the queues of those that wait.
module rwmf_spectrum_fast_lane_pool
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int8_t, c_intptr_t, c_loc
   use rwmf_spectrum_fast_types, only: flights_t, seats, team_t, tried_step_t, width
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_shared_data, only: kinds
   implicit none
   private

   public :: pool_t, queue_t, new_pool, is_empty, push, append, pull, pop, team_of, lane_of

   !> Slots that wait for a row of flights.
   type :: queue_t
      integer :: n = 0
      integer, allocatable :: slot(:)
   end type queue_t

   !> Work space of a thread. A slot is a lane of a team.
   type :: pool_t
      type(team_t), pointer :: team(:) => null()
      !! in `store`
      integer, allocatable :: present(:)
      !! (teams) how many step with it
      logical, allocatable :: is_called(:)
      !! (teams) the next step of one of them may be another one than the last
      integer, allocatable :: kind(:)
      !! (teams) of their steps
      type(ordinate_t), allocatable :: ordinate(:)
      !! (slots)
      type(tried_step_t), pointer :: trial => null()
      !! in `store`
      type(flights_t), pointer :: events => null()
      !! in `store`: steps in which something may happen, until they are enough for a row
      type(flights_t), pointer :: flights => null()
      !! in `store`: flights that begin on the base
      integer :: first = 1
      !! the lowest task that a member has
      type(queue_t) :: starts
      !! a flight begins on the base
      type(queue_t) :: finished
      type(queue_t) :: again(kinds)
      !! by the kind of their steps: tasks, not slots, to be repeated
      integer(c_int8_t), allocatable :: store(:)
   end type pool_t

contains

   !> Nobody is there yet; all numbers are finite.
   subroutine new_pool(teams, pool)
      integer, intent(in) :: teams
      type(pool_t), target, intent(out) :: pool
      integer :: k

      call lay_out(teams, pool)
      allocate (pool%present(teams), pool%is_called(teams), pool%kind(teams), &
         pool%ordinate(teams*seats))
      allocate (pool%starts%slot(teams*seats), pool%finished%slot(teams*seats))
      do k = 1, kinds
         allocate (pool%again(k)%slot(seats))
      end do
      pool%present = 0
      pool%is_called = .false.
      pool%kind = 1
      pool%ordinate%task = 0
      do k = 1, teams
         pool%team(k)%at = 1
         pool%team(k)%stop = huge(1)
      end do
   end subroutine new_pool

   !> Teams and flights begin on a line of the cache: vectors that lie across two lines cost twice.
   subroutine lay_out(teams, pool)
      integer, intent(in) :: teams
      type(pool_t), target, intent(inout) :: pool
      integer, parameter :: line = 64
      !! bytes
      type(team_t), pointer :: team(:)
      type(team_t) :: one
      type(flights_t) :: row
      type(tried_step_t) :: trial
      integer(c_intptr_t) :: address
      integer :: first(4)

      first(1) = 1
      first(2) = first(1) + whole_lines(teams*(storage_size(one)/8))
      first(3) = first(2) + whole_lines(storage_size(trial)/8)
      first(4) = first(3) + whole_lines(storage_size(row)/8)
      allocate (pool%store(first(4) + whole_lines(storage_size(row)/8) + line))
      ! Zeros in bytes are zeros in numbers.
      pool%store = 0
      address = transfer(c_loc(pool%store(1)), address)
      first = first + int(modulo(-address, int(line, c_intptr_t)))
      call c_f_pointer(c_loc(pool%store(first(1))), team, [teams])
      pool%team => team
      call c_f_pointer(c_loc(pool%store(first(2))), pool%trial)
      call c_f_pointer(c_loc(pool%store(first(3))), pool%events)
      call c_f_pointer(c_loc(pool%store(first(4))), pool%flights)
      pool%events%filled = width
      pool%flights%filled = width

   contains

      !> The bytes of so many, and those that are left of their last line.
      pure integer function whole_lines(bytes)
         integer, intent(in) :: bytes

         whole_lines = line*((bytes + line - 1)/line)
      end function whole_lines

   end subroutine lay_out

   pure subroutine push(slot, queue)
      integer, intent(in) :: slot
      type(queue_t), intent(inout) :: queue

      queue%n = queue%n + 1
      queue%slot(queue%n) = slot
   end subroutine push

   !> As `push`, for a queue that grows.
   pure subroutine append(number, queue)
      integer, intent(in) :: number
      type(queue_t), intent(inout) :: queue

      if (queue%n == size(queue%slot)) queue%slot = [queue%slot, queue%slot]
      call push(number, queue)
   end subroutine append

   !> The first ones of a queue: nobody waits while others overtake.
   pure subroutine pull(queue, slot)
      type(queue_t), intent(inout) :: queue
      integer, intent(out) :: slot(:)
      !! no more than wait
      integer :: i

      do i = 1, size(slot)
         slot(i) = queue%slot(i)
      end do
      do i = size(slot) + 1, queue%n
         queue%slot(i - size(slot)) = queue%slot(i)
      end do
      queue%n = queue%n - size(slot)
   end subroutine pull

   !> The last one of a queue whose order does not matter; 0: nobody waits.
   pure subroutine pop(queue, number)
      type(queue_t), intent(inout) :: queue
      integer, intent(out) :: number

      number = 0
      if (queue%n == 0) return
      number = queue%slot(queue%n)
      queue%n = queue%n - 1
   end subroutine pop

   !> Has a team no members?
   pure logical function is_empty(pool, k)
      type(pool_t), intent(in) :: pool
      integer, intent(in) :: k
      !! the team

      is_empty = all(pool%ordinate((k - 1)*seats + 1:k*seats)%task == 0)
   end function is_empty

   pure integer function team_of(slot)
      integer, intent(in) :: slot

      team_of = (slot - 1)/seats + 1
   end function team_of

   pure integer function lane_of(slot)
      integer, intent(in) :: slot

      lane_of = mod(slot - 1, seats) + 1
   end function lane_of

end module rwmf_spectrum_fast_lane_pool
