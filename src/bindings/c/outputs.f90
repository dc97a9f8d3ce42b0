!> C binding of the outputs of a stepping wall (include/rwmf.h).
module rwmf_bindings_c_outputs
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_int32_t, &
      c_ptr, c_size_t
   use rwmf_bindings_c_pointers, only: require_argument
   use rwmf_bindings_c_stepping, only: wall_of
   use rwmf_bindings_c_strings, only: get_text, put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_outputs, only: find_output, query_outputs
   use rwmf_embedding_stepping, only: stepping_t, stop_at_impacts
   implicit none
   private

   public :: c_find_output, c_query_outputs, c_stop_at_impacts

contains

   !> `rwmf_find_output`.
   integer(c_int) function c_find_output(key, number, message, size) &
      bind(c, name='rwmf_find_output')
      type(c_ptr), value :: key
      integer(c_int32_t), intent(inout), optional :: number
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      character(:), allocatable :: text
      integer :: found
      type(error_t), allocatable :: error

      call get_text(key, 'key', text, error)
      call require_argument(present(number), 'number', error)
      if (.not. allocated(error)) call find_output(text, found, error)
      if (.not. allocated(error)) number = int(found, c_int32_t)
      c_find_output = put_message(error, message, size)
   end function c_find_output

   !> `rwmf_query_outputs`.
   integer(c_int) function c_query_outputs(handle, n, numbers, values, message, size) &
      bind(c, name='rwmf_query_outputs')
      type(c_ptr), value :: handle
      integer(c_size_t), value :: n
      type(c_ptr), value :: numbers
      type(c_ptr), value :: values
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      integer(c_int32_t), pointer :: wanted(:)
      real(c_double), pointer :: places(:)
      real(c_double), allocatable :: found(:)
      type(error_t), allocatable :: error

      call require_argument(c_associated(numbers), 'numbers', error)
      call require_argument(c_associated(values), 'values', error)
      if (.not. allocated(error) .and. (n < 1 .or. n > huge(1))) then
         call fail(error, err_input, 'the number of outputs must be >= 1 and < 2**31')
      end if
      if (.not. allocated(error)) then
         call c_f_pointer(numbers, wanted, [n])
         call c_f_pointer(values, places, [n])
         allocate (found(n))
         call query_outputs(wall_of(handle), int(wanted), found, error)
         if (.not. allocated(error)) places = found
      end if
      c_query_outputs = put_message(error, message, size)
   end function c_query_outputs

   !> `rwmf_stop_at_impacts`.
   integer(c_int) function c_stop_at_impacts(handle, stops, message, size) &
      bind(c, name='rwmf_stop_at_impacts')
      type(c_ptr), value :: handle
      integer(c_int), value :: stops
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      if (stops == 0 .or. stops == 1) then
         call stop_at_impacts(wall, stops == 1, error)
      else
         call fail(error, err_input, 'stop at impacts: must be 1 or 0')
      end if
      c_stop_at_impacts = put_message(error, message, size)
   end function c_stop_at_impacts

end module rwmf_bindings_c_outputs
