!> Cases with other numbers for a C host (include/rwmf.h).
module rwmf_bindings_c_change
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_ptr, c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_ranges, only: is_number
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: change

contains

   !> Get the number of values of each key: one for each if the caller gives none.
   subroutine get_sizes(address, n, lengths, error)
      type(c_ptr), intent(in) :: address
      !! address of the caller's array; may be NULL
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: lengths(:)
      !! (n)
      type(error_t), allocatable, intent(inout) :: error
      !! a key without a value, or more values than any key takes
      integer, parameter :: most = 10000
      integer(c_size_t), pointer :: given(:)

      allocate (lengths(n), source=1)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, given, [n])
      if (all(given >= 1 .and. given <= most)) then
         lengths = int(given)
      else
         call fail(error, err_input, 'the number of values of a key must be >= 1 and <= 10000')
      end if
   end subroutine get_sizes

   !> Make the changed case with the samples of the first one.
   subroutine change(case, names, sizes, values, changed, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: names(:)
      !! (keys)
      type(c_ptr), intent(in) :: sizes
      !! (keys) number of values of each; NULL for one each
      type(c_ptr), intent(in) :: values
      !! numbers of all keys [unit of each key]
      type(case_t), intent(out) :: changed
      type(error_t), allocatable, intent(out) :: error
      !! values that are no numbers, and errors of `find_changes` and `change_case`
      type(changes_t) :: changes
      integer, allocatable :: lengths(:)
      real(c_double), pointer :: numbers(:)

      call get_sizes(sizes, size(names), lengths, error)
      if (allocated(error)) return
      call c_f_pointer(values, numbers, [sum(lengths)])
      if (.not. all(is_number(numbers))) then
         call fail(error, err_input, 'a value is not a finite number, or too large to be one')
         return
      end if
      call find_changes(case, names, changes, error, lengths)
      if (.not. allocated(error)) call change_case(case, changes, numbers, changed, error)
      if (allocated(error)) return
      if (allocated(changed%record)) then
         changed%record%t = case%record%t
         changed%record%a = case%record%a
      end if
      if (allocated(changed%upward_record)) then
         changed%upward_record%t = case%upward_record%t
         changed%upward_record%a = case%upward_record%a
      end if
   end subroutine change

end module rwmf_bindings_c_change
