!> What the Python wrapper needs besides the kernel: results kept behind integer handles, text as
!> bytes, errors as numbers.
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

   public :: run_t, sweep_t, keep_run, find_run, keep_sweep, find_sweep
   public :: put_text, put_error, join_status, read_source, make_control

   !> A simulation that Python holds.
   type :: run_t
      type(case_t) :: case
      type(result_t) :: result
   end type run_t

   !> A spectrum that Python holds.
   type :: sweep_t
      type(case_t) :: case
      type(spectrum_t) :: spectrum
   end type sweep_t

contains

   !> Handle of a result on the heap: its address.
   function keep_run(run) result(handle)
      type(run_t), pointer, intent(in) :: run
      integer(c_int64_t) :: handle

      handle = transfer(c_loc(run), handle)
   end function keep_run

   !> The result behind a handle.
   function find_run(handle) result(run)
      integer(c_int64_t), intent(in) :: handle
      !! from `keep_run`, not freed
      type(run_t), pointer :: run

      call c_f_pointer(transfer(handle, c_null_ptr), run)
   end function find_run

   !> Handle of a spectrum on the heap: its address.
   function keep_sweep(sweep) result(handle)
      type(sweep_t), pointer, intent(in) :: sweep
      integer(c_int64_t) :: handle

      handle = transfer(c_loc(sweep), handle)
   end function keep_sweep

   !> The spectrum behind a handle.
   function find_sweep(handle) result(sweep)
      integer(c_int64_t), intent(in) :: handle
      !! from `keep_sweep`, not freed
      type(sweep_t), pointer :: sweep

      call c_f_pointer(transfer(handle, c_null_ptr), sweep)
   end function find_sweep

   !> Copy a text into a buffer of bytes, as much of it as there is room for.
   pure subroutine put_text(text, buffer, length)
      character(*), intent(in) :: text
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

   !> What became of the ordinates, one a line in the order of the array (T_s, gamma, b).
   pure subroutine join_status(sweep, text)
      type(sweep_t), intent(in) :: sweep
      character(:), allocatable, intent(out) :: text
      integer :: length
      integer :: i
      integer :: j
      integer :: k
      integer :: n

      ! the room is taken once: a text that grows a line at a time is copied as often
      associate (status => sweep%spectrum%status)
         allocate (character(sum(len_trim(status) + 1)) :: text)
         length = 0
         do k = 1, size(status, 3)
            do j = 1, size(status, 2)
               do i = 1, size(status, 1)
                  n = len_trim(status(i, j, k)) + 1
                  text(length + 1:length + n) = trim(status(i, j, k))//new_line('a')
                  length = length + n
               end do
            end do
         end do
      end associate
   end subroutine join_status

   !> Read and validate a case; messages begin with the name of its file.
   subroutine read_source(text, source, case, error)
      character(*), intent(in) :: text
      !! namelist text
      character(*), intent(in) :: source
      !! path of its file, '' when it was made in memory
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error

      call read_case_text(text, source(:index(source, '/', back=.true.)), case, error)
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
