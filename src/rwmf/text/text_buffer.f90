!> Text buffer that grows piece by piece in time proportional to its length.
module rwmf_text_text_buffer
   implicit none
   private

   public :: text_buffer_t, append, clear

   !> Text in the first `length` characters of its buffer.
   type :: text_buffer_t
      character(:), allocatable :: room
      integer :: length = 0
   end type text_buffer_t

contains

   !> Append a piece of text.
   pure subroutine append(buffer, piece)
      type(text_buffer_t), intent(inout) :: buffer
      character(*), intent(in) :: piece
      !! text
      integer, parameter :: least_room = 256
      character(:), allocatable :: larger
      integer :: length

      length = buffer%length + len(piece)
      if (.not. allocated(buffer%room)) allocate (character(least_room) :: buffer%room)
      if (length > len(buffer%room)) then
         allocate (character(2*length) :: larger)
         larger(:buffer%length) = buffer%room(:buffer%length)
         call move_alloc(larger, buffer%room)
      end if
      buffer%room(buffer%length + 1:length) = piece
      buffer%length = length
   end subroutine append

   !> Empty the buffer and keep its memory.
   pure subroutine clear(buffer)
      type(text_buffer_t), intent(inout) :: buffer

      buffer%length = 0
      if (.not. allocated(buffer%room)) call append(buffer, '')
   end subroutine clear

end module rwmf_text_text_buffer
