!> The standard streams of the batch program.
module rwmf_app_streams
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_long, c_null_char, c_ptr, &
      c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_atomic_file, only: c_fileno
   use rwmf_text_file, only: c_fclose, c_fopen
   implicit none
   private

   public :: fill_standard_streams, put

   ! allow(assumed-size): the shape of a C string
   interface
      function c_write(descriptor, bytes, count) bind(c, name='write') result(written)
         import :: c_char, c_int, c_long, c_size_t
         implicit none
         integer(c_int), intent(in), value :: descriptor
         character(kind=c_char), intent(in) :: bytes(*)
         integer(c_size_t), intent(in), value :: count
         integer(c_long) :: written
      end function c_write
   end interface

contains

   !> Open the standard streams that the caller has closed on the null device. Otherwise a result
   !> file could get the number of a stream, and printed text would enter it. The substitutes are
   !> read-only, so that printing fails.
   subroutine fill_standard_streams()
      type(c_ptr) :: stream
      integer(c_int) :: descriptor
      integer(c_int) :: status

      do
         stream = c_fopen('/dev/null'//c_null_char, 'rb'//c_null_char)
         if (.not. c_associated(stream)) return
         descriptor = c_fileno(stream)
         if (descriptor > 2_c_int) exit
      end do
      ! nothing was written
      status = c_fclose(stream)
   end subroutine fill_standard_streams

   !> Print a line. Fails if the standard output is closed or its disk is full, which `write` and
   !> `flush` of gfortran 12 do not report.
   subroutine put(line, error)
      character(*), intent(in) :: line
      !! line without its line feed
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), parameter :: standard_output = 1_c_int
      character(:), allocatable :: text
      integer(c_long) :: written

      text = line//new_line('a')
      do while (len(text) > 0)
         written = c_write(standard_output, text, len(text, c_size_t))
         if (written < 0_c_long) then
            call fail(error, err_input, 'the standard output cannot be written')
            return
         end if
         text = text(written + 1:)
      end do
   end subroutine put

end module rwmf_app_streams
