!> Checks for arguments of a C host that may be NULL. They are optional in Fortran, rejected and
!> never dereferenced.
!>
!> An `error` from an earlier check is kept, so that a procedure can check all arguments of a call
!> in sequence.
module rwmf_bindings_c_pointers
   use, intrinsic :: iso_c_binding, only: c_associated, c_null_ptr, c_ptr
   use rwmf_core_error, only: err_input, error_t, fail
   implicit none
   private

   public :: require_argument, require_empty, take_handle

contains

   !> Reject an argument that is NULL.
   subroutine require_argument(is_there, what, error)
      logical, intent(in) :: is_there
      !! not NULL
      character(*), intent(in) :: what
      !! name of the argument, for the message
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL

      if (allocated(error) .or. is_there) return
      call fail(error, err_input, 'the address for the '//what//' is NULL')
   end subroutine require_argument

   !> Reject the address of a new handle if it is NULL or holds a handle in use.
   subroutine require_empty(handle, what, error)
      type(c_ptr), intent(in), optional :: handle
      character(*), intent(in) :: what
      !! 'case', 'wall' or 'element'
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL and for a handle in use

      call require_argument(present(handle), 'handle', error)
      if (allocated(error)) return
      if (c_associated(handle)) then
         call fail(error, err_input, 'the handle is not NULL: destroy its '//what//' first')
      end if
   end subroutine require_empty

   !> Take the address out of a handle, which becomes NULL; NULL for no handle or an empty one.
   function take_handle(handle) result(address)
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr) :: address

      address = c_null_ptr
      if (.not. present(handle)) return
      address = handle
      handle = c_null_ptr
   end function take_handle

end module rwmf_bindings_c_pointers
