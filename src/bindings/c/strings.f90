!> Conversion of texts and errors between C and Fortran.
module rwmf_bindings_c_strings
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_null_char, &
      c_ptr, c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   implicit none
   private

   public :: put_text, put_message, get_text, get_names

   interface
      !> Length of a C string without its null.
      pure function c_length(text) result(length) bind(c, name='strlen')
         import :: c_ptr, c_size_t
         implicit none
         type(c_ptr), value :: text
         integer(c_size_t) :: length
      end function c_length
   end interface

contains

   !> Copy a text with its terminating null, truncated to the size of the buffer.
   subroutine put_text(text, buffer, size)
      character(*), intent(in) :: text
      !! any length; its trailing blanks are copied as well
      type(c_ptr), intent(in) :: buffer
      !! may be NULL to discard the text
      integer(c_size_t), intent(in) :: size
      !! bytes of the buffer
      character(kind=c_char), pointer :: bytes(:)
      integer(c_size_t) :: i
      integer(c_size_t) :: n

      if (size < 1_c_size_t .or. .not. c_associated(buffer)) return
      call c_f_pointer(buffer, bytes, [size])
      n = min(len(text, c_size_t), size - 1_c_size_t)
      do i = 1, n
         bytes(i) = text(i:i)
      end do
      bytes(n + 1) = c_null_char
   end subroutine put_text

   !> Return the number of an error, 0 without one, and copy its message into the caller's buffer.
   !> After a success the message is empty.
   integer(c_int) function put_message(error, message, size) result(status)
      type(error_t), allocatable, intent(in) :: error
      type(c_ptr), intent(in) :: message
      !! may be NULL to discard the text
      integer(c_size_t), intent(in) :: size
      !! bytes of the message

      if (allocated(error)) then
         status = int(error%stat, c_int)
         call put_text(error%message, message, size)
      else
         status = 0_c_int
         call put_text('', message, size)
      end if
   end function put_message

   !> Convert a C string.
   subroutine get_text(address, what, text, error)
      type(c_ptr), intent(in) :: address
      character(*), intent(in) :: what
      !! name of the text, for the message
      character(:), allocatable, intent(out) :: text
      !! without the terminating null; not allocated after an error
      type(error_t), allocatable, intent(out) :: error
      !! the address is NULL
      character(kind=c_char), pointer :: bytes(:)
      integer :: i

      if (.not. c_associated(address)) then
         call fail(error, err_input, 'the '//what//' is NULL')
         return
      end if
      call c_f_pointer(address, bytes, [c_length(address)])
      allocate (character(size(bytes)) :: text)
      do i = 1, size(bytes)
         text(i:i) = bytes(i)
      end do
   end subroutine get_text

   !> Convert several C strings, unless an earlier check failed.
   subroutine get_names(address, n, what, names, error)
      type(c_ptr), intent(in) :: address
      !! address of the array of their addresses
      integer(c_size_t), intent(in) :: n
      !! at least 1
      character(*), intent(in) :: what
      !! name of each text, for the message
      character(:), allocatable, intent(out) :: names(:)
      !! (n) without the terminating nulls, padded with blanks; not allocated after an error
      type(error_t), allocatable, intent(inout) :: error
      !! one of the addresses is NULL
      type(c_ptr), pointer :: places(:)
      character(:), allocatable :: text
      integer(c_size_t) :: i, longest

      if (allocated(error)) return
      call c_f_pointer(address, places, [n])
      longest = 0
      do i = 1, n
         call get_text(places(i), what, text, error)
         if (allocated(error)) return
         longest = max(longest, len(text, c_size_t))
      end do
      allocate (character(longest) :: names(n))
      do i = 1, n
         call get_text(places(i), what, text, error)
         names(i) = text
      end do
   end subroutine get_names

end module rwmf_bindings_c_strings
