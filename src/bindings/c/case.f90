!> C binding of a case that is read once: include/rwmf.h.
module rwmf_bindings_c_case
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use rwmf_bindings_c_pointers, only: require_empty, take_handle
   use rwmf_bindings_c_strings, only: get_text, put_message
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_input_reader, only: read_case_file, read_case_text
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: kept_case_t, c_read_case, c_read_case_file, c_destroy_case, case_of, name_file

   !> What the handle of a case stands for.
   type :: kept_case_t
      type(case_t) :: case
      character(:), allocatable :: path
      !! of its file; '' for a text
   end type kept_case_t

contains

   !> `rwmf_read_case`.
   integer(c_int) function c_read_case(namelist, folder, handle, message, size) &
      bind(c, name='rwmf_read_case')
      type(c_ptr), value :: namelist
      type(c_ptr), value :: folder
      type(c_ptr), value :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      character(:), allocatable :: text
      character(:), allocatable :: place
      type(kept_case_t), pointer :: kept
      type(error_t), allocatable :: error

      place = ''
      call require_empty(handle, 'case', error)
      if (.not. allocated(error)) call get_text(namelist, 'namelist text', text, error)
      if (.not. allocated(error) .and. c_associated(folder)) then
         call get_text(folder, 'folder', place, error)
      end if
      if (.not. allocated(error)) then
         allocate (kept)
         kept%path = ''
         call read_case_text(text, place, kept%case, error)
         call hand_over(kept, handle, error)
      end if
      c_read_case = put_message(error, message, size)
   end function c_read_case

   !> `rwmf_read_case_file`.
   integer(c_int) function c_read_case_file(path, handle, message, size) &
      bind(c, name='rwmf_read_case_file')
      type(c_ptr), value :: path
      type(c_ptr), value :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      character(:), allocatable :: text
      type(kept_case_t), pointer :: kept
      type(error_t), allocatable :: error

      call require_empty(handle, 'case', error)
      if (.not. allocated(error)) call get_text(path, 'path', text, error)
      if (.not. allocated(error)) then
         allocate (kept)
         kept%path = text
         call read_case_file(text, kept%case, error)
         call hand_over(kept, handle, error)
      end if
      c_read_case_file = put_message(error, message, size)
   end function c_read_case_file

   !> `rwmf_destroy_case`.
   subroutine c_destroy_case(handle) bind(c, name='rwmf_destroy_case')
      type(c_ptr), value :: handle
      type(c_ptr) :: address
      type(kept_case_t), pointer :: kept

      address = take_handle(handle)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, kept)
      deallocate (kept)
   end subroutine c_destroy_case

   !> Give a case to the caller, or its memory back when it could not be read.
   subroutine hand_over(kept, handle, error)
      type(kept_case_t), pointer, intent(inout) :: kept
      type(c_ptr), intent(in) :: handle
      !! where the caller wants it
      type(error_t), allocatable, intent(in) :: error
      type(c_ptr), pointer :: place

      if (allocated(error)) then
         deallocate (kept)
      else
         call c_f_pointer(handle, place)
         place = c_loc(kept)
      end if
   end subroutine hand_over

   !> The case behind a handle. `error` stays what it is when something was refused before.
   subroutine case_of(handle, kept, error)
      type(c_ptr), intent(in) :: handle
      type(kept_case_t), pointer, intent(out) :: kept
      type(error_t), allocatable, intent(inout) :: error
      !! the handle is NULL

      nullify (kept)
      if (allocated(error)) return
      if (c_associated(handle)) then
         call c_f_pointer(handle, kept)
      else
         call fail(error, err_input, 'no case: the handle is NULL')
      end if
   end subroutine case_of

   !> The message of what a case of a file could not do begins with the file.
   subroutine name_file(kept, error)
      type(kept_case_t), intent(in) :: kept
      type(error_t), allocatable, intent(inout) :: error
      !! what was wrong with the case, if anything

      if (allocated(error) .and. len(kept%path) > 0) call add_context(error, kept%path)
   end subroutine name_file

end module rwmf_bindings_c_case
