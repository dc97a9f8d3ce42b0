!> Checks of the arguments of a C host, and conversion of results. Arguments that may be NULL are
!> optional in Fortran, rejected and never dereferenced.
!>
!> An `error` from an earlier check is kept, so that a procedure can check all arguments of a call
!> in sequence.
module rwmf_bindings_c_arguments
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int32_t, c_null_ptr, c_ptr, &
      c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: require_argument, require_count, require_empty, require_handle, take_handle
   public :: or_nan, truth

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

   !> Check that a number of objects is valid for an array.
   subroutine require_count(n, least, what, error)
      integer(c_size_t), intent(in) :: n
      !! number of objects
      integer, intent(in) :: least
      !! smallest valid number
      character(*), intent(in) :: what
      !! name of the counted objects, for the message
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for a number out of range

      ! size_t beyond the largest integer of Fortran is negative
      if (allocated(error) .or. (n >= least .and. n <= huge(1))) return
      call fail(error, err_input, 'the number of '//what//' must be >= ' &
         //trim(integer_to_text(least))//' and < 2**31')
   end subroutine require_count

   !> Reject a handle that is NULL.
   subroutine require_handle(handle, what, error)
      type(c_ptr), intent(in) :: handle
      character(*), intent(in) :: what
      !! 'case', 'wall', 'element', 'member' or 'snapshot'
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL

      if (allocated(error) .or. c_associated(handle)) return
      call fail(error, err_input, 'no '//what//': the handle is NULL')
   end subroutine require_handle

   !> Reject the address of a new handle if it is NULL or holds a handle in use.
   subroutine require_empty(handle, what, error)
      type(c_ptr), intent(in), optional :: handle
      character(*), intent(in) :: what
      !! 'case', 'wall', 'element' or 'member'
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

   !> Number, or NaN in place of one that does not apply.
   pure real(c_double) function or_nan(x)
      real(c_double), intent(in), optional :: x
      !! [any]

      or_nan = ieee_value(1.0_c_double, ieee_quiet_nan)
      if (present(x)) or_nan = x
   end function or_nan

   !> 1 for true, 0 for false.
   pure integer(c_int32_t) function truth(is_true)
      logical, intent(in) :: is_true
      !! any condition

      truth = merge(1_c_int32_t, 0_c_int32_t, is_true)
   end function truth

end module rwmf_bindings_c_arguments
