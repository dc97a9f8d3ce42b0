!> What the Python wrapper needs besides the kernel: cases and results kept behind integer handles,
!> text as bytes, errors as numbers.
module rwmf_bindings_python_handles
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_int64_t, c_int8_t, c_loc, &
      c_null_ptr
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: add_context, error_t
   use rwmf_input_reader, only: read_case_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_result, only: result_t
   use rwmf_spectrum_spectrum, only: spectrum_t
   implicit none
   private

   public :: kept_t, keep, find, put_text, put_error, read_source, split_names, make_control

   !> What a handle stands for: a case, or the result or the spectrum computed of one.
   type :: kept_t
      type(case_t), allocatable :: case
      !! never changes once it is kept, so that any number of threads may compute of it
      type(result_t), allocatable :: result
      type(spectrum_t), allocatable :: spectrum
   end type kept_t

contains

   !> Handle of something on the heap: its address. Nothing is kept of what has failed.
   subroutine keep(kept, error, handle)
      type(kept_t), pointer, intent(inout) :: kept
      !! given back on failure
      type(error_t), allocatable, intent(in) :: error
      integer(c_int64_t), intent(out) :: handle
      !! 0 on failure

      handle = 0_c_int64_t
      if (allocated(error)) then
         deallocate (kept)
      else
         handle = transfer(c_loc(kept), handle)
      end if
   end subroutine keep

   !> What a handle stands for.
   function find(handle) result(kept)
      integer(c_int64_t), intent(in) :: handle
      !! from `keep`, not freed
      type(kept_t), pointer :: kept

      call c_f_pointer(transfer(handle, c_null_ptr), kept)
   end function find

   !> Copy a text into a buffer of bytes, as much of it as there is room for.
   pure subroutine put_text(text, buffer, length)
      character(*), intent(in) :: text
      !! any length; its trailing blanks are copied as well
      integer(c_int8_t), intent(inout) :: buffer(:)
      !! (bytes)
      integer(c_int), intent(out) :: length
      !! bytes of the text; larger than the buffer: ask again with a larger one
      integer :: i

      length = len(text, c_int)
      do i = 1, min(len(text), size(buffer))
         buffer(i) = transfer(text(i:i), buffer(i))
      end do
   end subroutine put_text

   !> A failure, or its absence, as a number and a message.
   pure subroutine put_error(error, status, message, length)
      type(error_t), allocatable, intent(in) :: error
      integer(c_int), intent(out) :: status
      !! 0, or one of the `err_` numbers
      integer(c_int8_t), intent(inout) :: message(:)
      !! (bytes)
      integer(c_int), intent(out) :: length
      !! bytes of the message

      status = 0_c_int
      length = 0_c_int
      if (allocated(error)) then
         status = int(error%stat, c_int)
         call put_text(error%message, message, length)
      end if
   end subroutine put_error

   !> Names that tabs separate.
   pure subroutine split_names(text, names)
      character(*), intent(in) :: text
      !! '' for none
      character(40), allocatable, intent(out) :: names(:)
      !! (n) padded with blanks
      integer :: first, n

      allocate (names(0))
      first = 1
      do while (first <= len(text))
         n = index(text(first:)//achar(9), achar(9))
         names = [character(40) :: names, text(first:first + n - 2)]
         first = first + n
      end do
   end subroutine split_names

   !> Read and validate a case; messages begin with the name of its file.
   subroutine read_source(text, source, case, error, known)
      character(*), intent(in) :: text
      !! namelist text
      character(*), intent(in) :: source
      !! path of its file, '' when it was made in memory
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      !! the case is not acceptable, or a record cannot be read
      type(case_t), intent(in), optional :: known
      !! as in `read_case_text`

      call read_case_text(text, source(:index(source, '/', back=.true.)), case, error, known)
      if (allocated(error) .and. len(source) > 0) call add_context(error, source)
   end subroutine read_source

   !> Progress counter and cancel flag in the caller's memory.
   function make_control(counters) result(control)
      integer(c_int64_t), target, intent(inout) :: counters(2)
      !! finished simulations; non-zero to stop
      type(control_t) :: control

      control%done => counters(1)
      control%cancel => counters(2)
   end function make_control

end module rwmf_bindings_python_handles
