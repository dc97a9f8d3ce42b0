!> C binding of table rows: many runs of one case in one call (include/rwmf.h).
module rwmf_bindings_c_rows
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_int32_t, &
      c_ptr, c_size_t
   use rwmf_bindings_c_case, only: case_of, kept_case_t, name_file
   use rwmf_bindings_c_pointers, only: require_argument
   use rwmf_bindings_c_strings, only: get_names, put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_ranges, only: any_number, is_number, require_number
   use rwmf_spectrum_lane_rows, only: refused
   use rwmf_spectrum_ordinates, only: compute_rows, spectrum_t
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: c_run_rows

   !> `rwmf_rows` of the header.
   type, bind(c) :: c_rows_t
      integer(c_size_t) :: n_columns
      type(c_ptr) :: columns
      integer(c_size_t) :: n
      type(c_ptr) :: values
      integer(c_size_t) :: n_quantities
      type(c_ptr) :: quantities
   end type c_rows_t

contains

   !> `rwmf_run_rows`.
   integer(c_int) function c_run_rows(handle, rows, threads, results, status, message, size) &
      bind(c, name='rwmf_run_rows')
      type(c_ptr), value :: handle
      type(c_rows_t), intent(in), optional :: rows
      integer(c_int), value :: threads
      type(c_ptr), value :: results
      type(c_ptr), value :: status
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(kept_case_t), pointer :: kept
      real(c_double), pointer, contiguous :: values(:, :)
      character(:), allocatable :: columns(:)
      character(:), allocatable :: quantities(:)
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error

      call case_of(handle, kept, error)
      call require_argument(present(rows), 'rows', error)
      call require_argument(c_associated(results), 'results', error)
      call require_argument(c_associated(status), 'status', error)
      call take_table(rows, columns, values, quantities, error)
      if (.not. allocated(error)) then
         call compute_rows(kept%case, columns, values, quantities, int(threads), spectrum, error)
         call name_file(kept, error)
      end if
      if (.not. allocated(error)) call hand_over(spectrum, results, status)
      c_run_rows = put_message(error, message, size)
   end function c_run_rows

   !> Get the contents of the caller's table, unless an earlier check failed.
   subroutine take_table(rows, columns, values, quantities, error)
      type(c_rows_t), intent(in), optional :: rows
      character(:), allocatable, intent(out) :: columns(:)
      !! (columns)
      real(c_double), pointer, contiguous, intent(out) :: values(:, :)
      !! (columns, rows) in the caller's memory
      character(:), allocatable, intent(out) :: quantities(:)
      !! (quantities)
      type(error_t), allocatable, intent(inout) :: error
      !! NULL, sizes out of range, values that are not numbers

      nullify (values)
      if (allocated(error)) return
      call require_size(rows%n_columns, 'columns', error)
      call require_size(rows%n, 'rows', error)
      call require_size(rows%n_quantities, 'quantities', error)
      call require_argument(c_associated(rows%columns), 'columns', error)
      call require_argument(c_associated(rows%values), 'values', error)
      call require_argument(c_associated(rows%quantities), 'quantities', error)
      call get_names(rows%columns, rows%n_columns, 'name of a column', columns, error)
      call get_names(rows%quantities, rows%n_quantities, 'key of a quantity', quantities, error)
      if (allocated(error)) return
      call c_f_pointer(rows%values, values, [rows%n_columns, rows%n])
      call require_values(values, columns, error)
   end subroutine take_table

   !> Check that a size is valid for an array.
   subroutine require_size(n, what, error)
      integer(c_size_t), intent(in) :: n
      character(*), intent(in) :: what
      !! name of the counted objects, for the message
      type(error_t), allocatable, intent(inout) :: error
      !! the size is out of range (`err_input`)

      ! size_t beyond the largest integer of Fortran is negative
      if (allocated(error) .or. (n >= 1 .and. n <= huge(1))) return
      call fail(error, err_input, 'the number of '//what//' must be >= 1 and < 2**31')
   end subroutine require_size

   !> Check that all values are numbers. The case checks their ranges row by row.
   subroutine require_values(values, columns, error)
      real(c_double), intent(in) :: values(:, :)
      !! (columns, rows) each in the unit of its key
      character(*), intent(in) :: columns(:)
      !! (columns)
      type(error_t), allocatable, intent(inout) :: error
      !! a value is not a number (`err_input`)
      integer :: column, row

      do row = 1, size(values, 2)
         if (all(is_number(values(:, row)))) cycle
         column = findloc(is_number(values(:, row)), .false., dim=1)
         call require_number(values(column, row), 'values: row '//trim(integer_to_text(row - 1)) &
            //', '//trim(columns(column)), any_number, error)
         return
      end do
   end subroutine require_values

   !> Copy the results into the caller's arrays.
   subroutine hand_over(spectrum, results, status)
      type(spectrum_t), intent(in) :: spectrum
      type(c_ptr), intent(in) :: results
      !! (quantities, rows)
      type(c_ptr), intent(in) :: status
      !! (rows)
      character(24), parameter :: names(5) = [character(24) :: 'ok', 'overturned', 'collapsed', &
         'inaccurate', refused]
      !! names of RWMF_ROW_OK and the following codes
      real(c_double), pointer :: numbers(:, :)
      integer(c_int32_t), pointer :: codes(:)
      integer :: i

      associate (found => spectrum%values(:, 1, 1, :))
         call c_f_pointer(results, numbers, [size(found, 2), size(found, 1)])
         call c_f_pointer(status, codes, [size(found, 1)])
         do i = 1, size(found, 2)
            numbers(i, :) = found(:, i)
         end do
      end associate
      ! every other name is an error: RWMF_ROW_FAILED
      codes = size(names)
      do i = 1, size(names)
         where (spectrum%status(:, 1, 1) == findloc(spectrum%status_names, names(i), dim=1)) &
            codes = i - 1
      end do
   end subroutine hand_over

end module rwmf_bindings_c_rows
