!> Addresses that a host in C hands over: NULL is refused, never followed.
!>
!> `error` enters with what was refused before and stays that, so that all addresses of a call are
!> checked one after the other.
module rwmf_bindings_c_pointers
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_null_ptr, c_ptr
   use rwmf_core_error, only: err_input, error_t, fail
   implicit none
   private

   public :: require_address, require_empty, take_handle

contains

   !> Is there an address?
   subroutine require_address(address, what, error)
      type(c_ptr), intent(in) :: address
      character(*), intent(in) :: what
      !! lies there, for the message
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL

      if (allocated(error) .or. c_associated(address)) return
      call fail(error, err_input, 'the address for the '//what//' is NULL')
   end subroutine require_address

   !> Is there a place for a new handle, and nothing in it that would be lost?
   subroutine require_empty(handle, what, error)
      type(c_ptr), intent(in) :: handle
      !! address of the caller's handle
      character(*), intent(in) :: what
      !! 'case', 'wall' or 'element'
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL and for a handle in use
      type(c_ptr), pointer :: kept

      call require_address(handle, 'handle', error)
      if (allocated(error)) return
      call c_f_pointer(handle, kept)
      if (c_associated(kept)) then
         call fail(error, err_input, 'the handle is not NULL: destroy its '//what//' first')
      end if
   end subroutine require_empty

   !> What a handle that is to be destroyed stands for, and the handle becomes NULL; NULL when there
   !> is neither.
   function take_handle(handle) result(address)
      type(c_ptr), intent(in) :: handle
      !! address of the caller's handle
      type(c_ptr) :: address
      type(c_ptr), pointer :: kept

      address = c_null_ptr
      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, kept)
      address = kept
      kept = c_null_ptr
   end function take_handle

end module rwmf_bindings_c_pointers
