!> C binding of cases with other numbers (include/rwmf.h).
module rwmf_bindings_c_change
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, &
      c_ptr, c_size_t
   use rwmf_bindings_c_case, only: case_of, kept_case_t, name_file
   use rwmf_bindings_c_pointers, only: require_argument, require_empty
   use rwmf_bindings_c_strings, only: get_names, put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_ranges, only: is_number
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: c_change_case

contains

   !> `rwmf_change_case`.
   integer(c_int) function c_change_case(from, n, keys, sizes, values, handle, message, size) &
      bind(c, name='rwmf_change_case')
      type(c_ptr), value :: from
      integer(c_size_t), value :: n
      type(c_ptr), value :: keys
      type(c_ptr), value :: sizes
      type(c_ptr), value :: values
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(kept_case_t), pointer :: kept, changed
      character(:), allocatable :: names(:)
      integer, allocatable :: lengths(:)
      real(c_double), pointer :: numbers(:)
      type(error_t), allocatable :: error

      call require_empty(handle, 'case', error)
      call case_of(from, kept, error)
      if (.not. allocated(error) .and. (n < 1 .or. n > huge(1))) then
         call fail(error, err_input, 'the number of keys must be >= 1 and < 2**31')
      end if
      call require_argument(c_associated(keys), 'keys', error)
      call require_argument(c_associated(values), 'values', error)
      call get_names(keys, n, 'key', names, error)
      if (.not. allocated(error)) call get_sizes(sizes, int(n), lengths, error)
      if (.not. allocated(error)) then
         call c_f_pointer(values, numbers, [sum(lengths)])
         if (.not. all(is_number(numbers))) call fail(error, err_input, &
            'a value is not a finite number, or too large to be one')
      end if
      if (.not. allocated(error)) then
         allocate (changed)
         changed%path = kept%path
         call change(kept%case, names, lengths, numbers, changed%case, error)
         call name_file(kept, error)
         if (allocated(error)) then
            deallocate (changed)
         else
            handle = c_loc(changed)
         end if
      end if
      c_change_case = put_message(error, message, size)
   end function c_change_case

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
   subroutine change(case, names, lengths, numbers, changed, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: names(:)
      !! (keys)
      integer, intent(in) :: lengths(:)
      !! (keys) number of values of each
      real(c_double), intent(in) :: numbers(:)
      !! (values) [unit of each key]
      type(case_t), intent(out) :: changed
      type(error_t), allocatable, intent(out) :: error
      !! errors of `find_changes` and `change_case`
      type(changes_t) :: changes

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
