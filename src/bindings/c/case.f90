!> Case of a C host: its handle and the samples of its records (include/rwmf.h).
module rwmf_bindings_c_case
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_size_t
   use rwmf_bindings_c_arguments, only: require_argument
   use rwmf_bindings_c_types, only: rwmf_samples
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_input_record_samples, only: samples_from_array, samples_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: kept_case_t, get_samples, name_file

   !> Case behind a handle.
   type :: kept_case_t
      type(case_t) :: case
      character(:), allocatable :: path
      !! path of its file; not allocated for a text
   end type kept_case_t

contains

   !> Copy and check samples; not allocated for NULL.
   subroutine get_samples(given, group, samples, error)
      type(rwmf_samples), intent(in), optional :: given
      character(*), intent(in) :: group
      !! name of the group that they belong to
      type(samples_t), allocatable, intent(out) :: samples
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` for NULL in place of the accelerations, and for samples that are no record
      real(c_double), pointer :: a(:)
      real(c_double), pointer :: t(:)
      type(error_t), allocatable :: refused

      if (allocated(error) .or. .not. present(given)) return
      call require_argument(c_associated(given%accelerations), 'accelerations of the '//group, &
         error)
      if (allocated(error)) return
      ! a number beyond any memory is a negative size converted to size_t
      if (given%n > int(huge(1), c_size_t) .or. given%n < 0_c_size_t) then
         call fail(error, err_input, '&'//group//': the number of samples is out of range')
         return
      end if
      call c_f_pointer(given%accelerations, a, [given%n])
      ! disassociated: the argument is absent
      nullify (t)
      if (c_associated(given%times)) call c_f_pointer(given%times, t, [given%n])
      allocate (samples)
      call samples_from_array(a, samples, refused, t)
      if (.not. allocated(refused)) return
      call add_context(refused, '&'//group)
      call move_alloc(refused, error)
   end subroutine get_samples

   !> Prefix the message of an error with the file of its case.
   subroutine name_file(kept, error)
      type(kept_case_t), intent(in) :: kept
      type(error_t), allocatable, intent(inout) :: error
      !! error of the case, if any

      if (allocated(error) .and. allocated(kept%path)) call add_context(error, kept%path)
   end subroutine name_file

end module rwmf_bindings_c_case
