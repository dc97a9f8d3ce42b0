!> C binding of a case read once (include/rwmf.h).
module rwmf_bindings_c_case
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, &
      c_null_ptr, c_ptr, c_size_t
   use rwmf_bindings_c_pointers, only: require_argument, require_empty, take_handle
   use rwmf_bindings_c_strings, only: get_text, put_message
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_input_reader, only: read_case_file, read_case_text
   use rwmf_input_record_samples, only: samples_from_array, samples_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_record, only: horizontal_group, upward_group
   implicit none
   private

   public :: kept_case_t, c_read_case, c_read_case_with, c_read_case_file, c_destroy_case
   public :: case_of, name_file, read_host_case

   !> Case behind a handle.
   type :: kept_case_t
      type(case_t) :: case
      character(:), allocatable :: path
      !! path of its file; '' for a text
   end type kept_case_t

   !> `rwmf_samples` of the header.
   type, bind(c) :: c_samples_t
      integer(c_size_t) :: n
      type(c_ptr) :: times
      type(c_ptr) :: accelerations
   end type c_samples_t

contains

   !> `rwmf_read_case`.
   integer(c_int) function c_read_case(namelist, folder, handle, message, size) &
      bind(c, name='rwmf_read_case')
      type(c_ptr), value :: namelist
      type(c_ptr), value :: folder
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size

      c_read_case = c_read_case_with(namelist, folder, c_null_ptr, c_null_ptr, handle, message, &
         size)
   end function c_read_case

   !> `rwmf_read_case_with`.
   integer(c_int) function c_read_case_with(namelist, folder, motion, upward, handle, message, &
      size) bind(c, name='rwmf_read_case_with')
      type(c_ptr), value :: namelist
      type(c_ptr), value :: folder
      type(c_ptr), value :: motion
      type(c_ptr), value :: upward
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      character(:), allocatable :: text
      character(:), allocatable :: place
      type(case_t), allocatable :: no_case
      type(samples_t), allocatable :: samples
      type(samples_t), allocatable :: upward_samples
      type(kept_case_t), pointer :: kept
      type(error_t), allocatable :: error

      place = ''
      call require_empty(handle, 'case', error)
      if (.not. allocated(error)) call get_text(namelist, 'namelist text', text, error)
      if (.not. allocated(error) .and. c_associated(folder)) then
         call get_text(folder, 'folder', place, error)
      end if
      call get_samples(motion, horizontal_group, samples, error)
      call get_samples(upward, upward_group, upward_samples, error)
      if (.not. allocated(error)) then
         allocate (kept)
         kept%path = ''
         ! the missing case, and missing samples, are passed as absent arguments
         call read_case_text(text, place, kept%case, error, no_case, samples, upward_samples)
         call hand_over(kept, handle, error)
      end if
      c_read_case_with = put_message(error, message, size)
   end function c_read_case_with

   !> Read the namelist text of an element or a member of a host.
   subroutine read_host_case(namelist, case, error)
      type(c_ptr), intent(in) :: namelist
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if it is no valid case
      character(:), allocatable :: text

      call get_text(namelist, 'namelist text', text, error)
      if (.not. allocated(error)) call read_case_text(text, '', case, error, is_for_host=.true.)
   end subroutine read_host_case

   !> Copy and check samples; not allocated for NULL.
   subroutine get_samples(address, group, samples, error)
      type(c_ptr), intent(in) :: address
      !! address of an `rwmf_samples`
      character(*), intent(in) :: group
      type(samples_t), allocatable, intent(out) :: samples
      type(error_t), allocatable, intent(inout) :: error
      type(c_samples_t), pointer :: given
      real(c_double), pointer :: a(:)
      real(c_double), pointer :: t(:)
      type(error_t), allocatable :: refused

      if (allocated(error) .or. .not. c_associated(address)) return
      call c_f_pointer(address, given)
      call require_argument(c_associated(given%accelerations), 'accelerations of the '//group, &
         error)
      if (allocated(error)) return
      ! a number beyond any memory is a negative size converted to size_t
      if (given%n > int(huge(1), c_size_t) .or. given%n < 0_c_size_t) then
         call fail(error, err_input, '&'//group//': the number of samples is out of range')
         return
      end if
      call c_f_pointer(given%accelerations, a, [given%n])
      allocate (samples)
      if (c_associated(given%times)) then
         call c_f_pointer(given%times, t, [given%n])
         call samples_from_array(a, samples, refused, t)
      else
         call samples_from_array(a, samples, refused)
      end if
      if (.not. allocated(refused)) return
      call add_context(refused, '&'//group)
      call move_alloc(refused, error)
   end subroutine get_samples

   !> `rwmf_read_case_file`.
   integer(c_int) function c_read_case_file(path, handle, message, size) &
      bind(c, name='rwmf_read_case_file')
      type(c_ptr), value :: path
      type(c_ptr), intent(inout), optional :: handle
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
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr) :: address
      type(kept_case_t), pointer :: kept

      address = take_handle(handle)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, kept)
      deallocate (kept)
   end subroutine c_destroy_case

   !> Pass a case to the caller, or free its memory if it could not be read.
   subroutine hand_over(kept, handle, error)
      type(kept_case_t), pointer, intent(inout) :: kept
      type(c_ptr), intent(inout) :: handle
      !! handle in the caller's memory
      type(error_t), allocatable, intent(in) :: error

      if (allocated(error)) then
         deallocate (kept)
      else
         handle = c_loc(kept)
      end if
   end subroutine hand_over

   !> Return the case behind a handle. An earlier `error` is kept.
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

   !> Prefix the message of an error with the file of its case.
   subroutine name_file(kept, error)
      type(kept_case_t), intent(in) :: kept
      type(error_t), allocatable, intent(inout) :: error
      !! error of the case, if any

      if (allocated(error) .and. len(kept%path) > 0) call add_context(error, kept%path)
   end subroutine name_file

end module rwmf_bindings_c_case
