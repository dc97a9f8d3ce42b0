!> C binding of a case that is read once: include/rwmf.h.
module rwmf_bindings_c_case
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use rwmf_bindings_c_strings, only: get_text, put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_input_reader, only: read_case_file, read_case_text
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: c_read_case, c_read_case_file, c_destroy_case, case_of, require_empty

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
      type(case_t), pointer :: case
      type(error_t), allocatable :: error

      place = ''
      call require_empty(handle, 'case', error)
      if (.not. allocated(error)) call get_text(namelist, 'namelist text', text, error)
      if (.not. allocated(error) .and. c_associated(folder)) then
         call get_text(folder, 'folder', place, error)
      end if
      if (.not. allocated(error)) then
         allocate (case)
         call read_case_text(text, place, case, error)
         call hand_over(case, handle, error)
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
      type(case_t), pointer :: case
      type(error_t), allocatable :: error

      call require_empty(handle, 'case', error)
      if (.not. allocated(error)) call get_text(path, 'path', text, error)
      if (.not. allocated(error)) then
         allocate (case)
         call read_case_file(text, case, error)
         call hand_over(case, handle, error)
      end if
      c_read_case_file = put_message(error, message, size)
   end function c_read_case_file

   !> `rwmf_destroy_case`.
   subroutine c_destroy_case(handle) bind(c, name='rwmf_destroy_case')
      type(c_ptr), value :: handle
      type(c_ptr), pointer :: kept
      type(case_t), pointer :: case

      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, kept)
      if (.not. c_associated(kept)) return
      call c_f_pointer(kept, case)
      deallocate (case)
      kept = c_null_ptr
   end subroutine c_destroy_case

   !> Give a case to the caller, or its memory back when it could not be read.
   subroutine hand_over(case, handle, error)
      type(case_t), pointer, intent(inout) :: case
      type(c_ptr), intent(in) :: handle
      !! where the caller wants it
      type(error_t), allocatable, intent(in) :: error
      type(c_ptr), pointer :: kept

      if (allocated(error)) then
         deallocate (case)
      else
         call c_f_pointer(handle, kept)
         kept = c_loc(case)
      end if
   end subroutine hand_over

   !> The case behind a handle.
   subroutine case_of(handle, case, error)
      type(c_ptr), intent(in) :: handle
      type(case_t), pointer, intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      !! the handle is NULL

      nullify (case)
      if (c_associated(handle)) then
         call c_f_pointer(handle, case)
      else
         call fail(error, err_input, 'no case: the handle is NULL')
      end if
   end subroutine case_of

   !> Is there a place for a new handle, and nothing in it that would be lost?
   subroutine require_empty(handle, what, error)
      type(c_ptr), intent(in) :: handle
      !! address of the caller's handle
      character(*), intent(in) :: what
      !! 'case', 'wall' or 'element'
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr), pointer :: kept

      if (.not. c_associated(handle)) then
         call fail(error, err_input, 'the address for the handle is NULL')
         return
      end if
      call c_f_pointer(handle, kept)
      if (c_associated(kept)) then
         call fail(error, err_input, 'the handle is not NULL: destroy its '//what//' first')
      end if
   end subroutine require_empty

end module rwmf_bindings_c_case
