!> Text and failures between C and Fortran.
module rwmf_c_text
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_null_char, &
      c_ptr, c_size_t
   use rwmf_case, only: case_t
   use rwmf_case_reader, only: read_case_text
   use rwmf_errors, only: error_t
   implicit none
   private

   public :: put_text, put_message, read_case

contains

   !> Copy a text with its terminating null, as much of it as there is room for.
   pure subroutine put_text(text, buffer, size)
      character(*), intent(in) :: text
      character(kind=c_char), intent(inout) :: buffer(*)
      integer(c_size_t), intent(in) :: size
      !! bytes of the buffer
      integer(c_size_t) :: i
      integer(c_size_t) :: n

      if (size < 1_c_size_t) return
      n = min(len(text, c_size_t), size - 1_c_size_t)
      do i = 1, n
         buffer(i) = text(i:i)
      end do
      buffer(n + 1) = c_null_char
   end subroutine put_text

   !> Number of a failure, 0 without one; its message into the caller's buffer.
   integer(c_int) function put_message(error, message, size) result(status)
      type(error_t), allocatable, intent(in) :: error
      type(c_ptr), intent(in) :: message
      !! NULL: nobody asks
      integer(c_size_t), intent(in) :: size
      character(kind=c_char), pointer :: buffer(:)

      status = 0_c_int
      if (allocated(error)) status = int(error%stat, c_int)
      if (.not. allocated(error) .or. .not. c_associated(message)) return
      call c_f_pointer(message, buffer, [size])
      call put_text(error%message, buffer, size)
   end function put_message

   !> A case from namelist text that ends with a null; paths in it are relative to the working folder.
   subroutine read_case(namelist, case, error)
      character(kind=c_char), intent(in) :: namelist(*)
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: n
      integer :: i

      n = 0
      do while (namelist(n + 1) /= c_null_char)
         n = n + 1
      end do
      allocate (character(n) :: text)
      do i = 1, n
         text(i:i) = namelist(i)
      end do
      call read_case_text(text, '', case, error)
   end subroutine read_case

end module rwmf_c_text
