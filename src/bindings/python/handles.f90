!> Support for the Python wrapper: cases and results behind integer handles, text as bytes, errors
!> as numbers.
module rwmf_bindings_python_handles
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_int64_t, c_int8_t, c_loc, &
      c_null_ptr
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: add_context, error_t
   use rwmf_embedding_member, only: wall_member_t
   use rwmf_embedding_stepping, only: snapshot_t
   use rwmf_embedding_wall_group, only: destroy_walls, wall_group_t
   use rwmf_input_change, only: changes_t
   use rwmf_input_record_samples, only: samples_t
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: key_length
   use rwmf_simulation_pushover_curve, only: static_curve_t
   use rwmf_simulation_state_result, only: result_t
   use rwmf_spectrum_ordinates, only: spectrum_t
   implicit none
   private

   public :: control_t, kept_t, keep, find, free, put_text, put_error, add_source, split_names, &
      make_control
   public :: keep_motion, motion_of, complete_case, sampled_case, samples_of, get_text, &
      join_lines

   !> Object behind a handle: a case, samples of a motion or of a file, or changed keys. Others are
   !> the result, the spectrum or the static curve computed from a case. For a host it is walls, a
   !> member, or saved states of walls.
   type :: kept_t
      type(case_t), allocatable :: case
      !! constant once stored, so that any number of threads may use it
      type(motion_t), allocatable :: motion
      !! motion of the case, tabulated once; absent if it is that of `origin`, or its record is
      !! scaled
      type(kept_t), pointer :: origin => null()
      !! original of a changed case, with the samples of its records; the caller keeps it alive
      logical :: is_motion_of_origin = .false.
      !! the ground motion is unchanged
      type(samples_t), allocatable :: samples
      type(samples_t), allocatable :: channels(:)
      !! of a record file
      type(changes_t), allocatable :: changes
      type(result_t), allocatable :: result
      type(spectrum_t), allocatable :: spectrum
      type(wall_group_t), allocatable :: group
      type(snapshot_t), allocatable :: snapshots(:)
      type(wall_member_t), allocatable :: member
      type(static_curve_t), allocatable :: curve
   end type kept_t

contains

   !> Create the handle of an object on the heap, its address. After an error the object is freed.
   subroutine keep(kept, error, handle)
      type(kept_t), pointer, intent(inout) :: kept
      !! freed on failure
      type(error_t), allocatable, intent(in) :: error
      integer(c_int64_t), intent(out) :: handle
      !! 0 on failure

      handle = 0_c_int64_t
      if (allocated(error)) then
         call free(kept)
      else
         handle = transfer(c_loc(kept), handle)
      end if
   end subroutine keep

   !> Free an object and all that belongs to it.
   subroutine free(kept)
      type(kept_t), pointer, intent(inout) :: kept

      if (allocated(kept%group)) call destroy_walls(kept%group)
      deallocate (kept)
   end subroutine free

   !> Return the object behind a handle.
   function find(handle) result(kept)
      integer(c_int64_t), intent(in) :: handle
      !! handle from `keep`, not freed
      type(kept_t), pointer :: kept

      call c_f_pointer(transfer(handle, c_null_ptr), kept)
   end function find

   !> Return the case with the samples for the handle of a case, which may be changed; null for 0.
   function sampled_case(handle) result(case)
      integer(c_int64_t), intent(in) :: handle
      !! handle of a case, or 0
      type(case_t), pointer :: case
      type(kept_t), pointer :: kept

      nullify (case)
      if (handle == 0_c_int64_t) return
      kept => find(handle)
      case => kept%case
      if (associated(kept%origin)) case => kept%origin%case
   end function sampled_case

   !> Return the samples behind a handle; null for 0.
   function samples_of(handle) result(samples)
      integer(c_int64_t), intent(in) :: handle
      !! handle of samples, or 0
      type(samples_t), pointer :: samples
      type(kept_t), pointer :: kept

      nullify (samples)
      if (handle == 0_c_int64_t) return
      kept => find(handle)
      samples => kept%samples
   end function samples_of

   !> Copy a text into a buffer of bytes, truncated to the size of the buffer.
   pure subroutine put_text(text, buffer, length)
      character(*), intent(in) :: text
      !! any length; its trailing blanks are copied as well
      integer(c_int8_t), intent(inout) :: buffer(:)
      !! (bytes)
      integer(c_int), intent(out) :: length
      !! bytes of the text; if larger than the buffer, call again with a larger one
      integer :: i

      length = len(text, c_int)
      do i = 1, min(len(text), size(buffer))
         buffer(i) = transfer(text(i:i), buffer(i))
      end do
   end subroutine put_text

   !> Convert bytes to a text. As a character argument of f2py it would end at the first null byte.
   pure subroutine get_text(bytes, text)
      integer(c_int8_t), intent(in) :: bytes(:)
      !! (bytes) one for each character of the text
      character(:), allocatable, intent(out) :: text
      !! (bytes) characters
      integer :: i

      allocate (character(size(bytes)) :: text)
      do i = 1, size(bytes)
         text(i:i) = char(iand(int(bytes(i)), 255))
      end do
   end subroutine get_text

   !> Convert an error, or its absence, to a number and a message.
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

   !> Split names separated by tabs.
   pure subroutine split_names(text, names)
      character(*), intent(in) :: text
      !! '' for none
      character(key_length), allocatable, intent(out) :: names(:)
      !! (n) padded with blanks
      integer :: first, n

      allocate (names(0))
      first = 1
      do while (first <= len(text))
         n = index(text(first:)//achar(9), achar(9))
         names = [character(key_length) :: names, text(first:first + n - 2)]
         first = first + n
      end do
   end subroutine split_names

   !> Join names to a text, one per line.
   pure subroutine join_lines(names, text)
      character(*), intent(in) :: names(:)
      !! (n) padded with blanks
      character(:), allocatable, intent(out) :: text
      !! (n) lines
      integer :: i

      text = ''
      do i = 1, size(names)
         text = text//trim(names(i))//new_line('a')
      end do
   end subroutine join_lines

   !> Prefix the message of an error with the name of the case's file.
   pure subroutine add_source(source, error)
      character(*), intent(in) :: source
      !! path of its file, '' for a case made in memory
      type(error_t), allocatable, intent(inout) :: error
      !! error of the case, if any

      if (allocated(error) .and. len(source) > 0) call add_context(error, source)
   end subroutine add_source

   !> Tabulate the motion of a case, unless its samples belong to another one: copies of a long
   !> scaled record would fill the memory.
   subroutine keep_motion(kept)
      type(kept_t), intent(inout) :: kept
      !! with its case set

      if (kept%is_motion_of_origin) return
      if (associated(kept%origin)) then
         if (allocated(kept%case%record) .or. allocated(kept%case%upward_record)) return
      end if
      kept%motion = motion_from_case(kept%case)
   end subroutine keep_motion

   !> Return the motion of a case: the tabulated one, or one built in `room`.
   subroutine motion_of(kept, room, motion)
      type(kept_t), pointer, intent(in) :: kept
      !! object of a case
      type(motion_t), target, intent(inout) :: room
      type(motion_t), pointer, intent(out) :: motion

      if (allocated(kept%motion)) then
         motion => kept%motion
      else if (kept%is_motion_of_origin) then
         motion => kept%origin%motion
      else
         room = motion_from_case(kept%case, kept%origin%case)
         motion => room
      end if
   end subroutine motion_of

   !> Copy a case and the samples of its records.
   subroutine complete_case(kept, case)
      type(kept_t), intent(in) :: kept
      !! object of a case
      type(case_t), intent(out) :: case

      case = kept%case
      if (.not. associated(kept%origin)) return
      if (allocated(case%record)) then
         case%record%t = kept%origin%case%record%t
         case%record%a = kept%origin%case%record%a
      end if
      if (.not. allocated(case%upward_record)) return
      case%upward_record%t = kept%origin%case%upward_record%t
      case%upward_record%a = kept%origin%case%upward_record%a
   end subroutine complete_case

   !> Create a control with progress counter and cancel flag in the caller's memory.
   function make_control(counters) result(control)
      integer(c_int64_t), target, intent(inout) :: counters(2)
      !! finished simulations; non-zero to stop
      type(control_t) :: control

      control%done => counters(1)
      control%cancel => counters(2)
   end function make_control

end module rwmf_bindings_python_handles
