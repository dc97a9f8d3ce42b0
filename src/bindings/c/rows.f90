!> Rows of a table of a C host: many runs of one case in one call (include/rwmf.h).
module rwmf_bindings_c_rows
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int32_t, c_ptr
   use rwmf_bindings_c_arguments, only: require_argument, require_count
   use rwmf_bindings_c_strings, only: get_names
   use rwmf_bindings_c_types, only: rwmf_rows
   use rwmf_core_error, only: error_t
   use rwmf_embedding_ranges, only: any_number, is_number, require_number
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_lane_rows, only: refused
   use rwmf_spectrum_ordinates, only: compute_rows, spectrum_t
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: run_rows

contains

   !> Run the rows of the caller's table.
   subroutine run_rows(case, rows, threads, results, status, error)
      type(case_t), intent(in) :: case
      type(rwmf_rows), intent(in) :: rows
      integer, intent(in) :: threads
      !! 0 for all
      type(c_ptr), intent(in) :: results
      !! (quantities, rows) in the caller's memory
      type(c_ptr), intent(in) :: status
      !! (rows) in the caller's memory
      type(error_t), allocatable, intent(out) :: error
      !! errors of the table and of `compute_rows`
      real(c_double), pointer, contiguous :: values(:, :)
      character(:), allocatable :: columns(:)
      character(:), allocatable :: quantities(:)
      type(spectrum_t) :: spectrum

      call take_table(rows, columns, values, quantities, error)
      if (allocated(error)) return
      call compute_rows(case, columns, values, quantities, threads, spectrum, error)
      if (.not. allocated(error)) call hand_over(spectrum, results, status)
   end subroutine run_rows

   !> Get and check the contents of the caller's table.
   subroutine take_table(rows, columns, values, quantities, error)
      type(rwmf_rows), intent(in) :: rows
      character(:), allocatable, intent(out) :: columns(:)
      !! (columns)
      real(c_double), pointer, contiguous, intent(out) :: values(:, :)
      !! (columns, rows) in the caller's memory
      character(:), allocatable, intent(out) :: quantities(:)
      !! (quantities)
      type(error_t), allocatable, intent(out) :: error
      !! NULL, sizes out of range, values that are not numbers

      nullify (values)
      call require_count(rows%n_columns, 1, 'columns', error)
      call require_count(rows%n, 1, 'rows', error)
      call require_count(rows%n_quantities, 1, 'quantities', error)
      call require_argument(c_associated(rows%columns), 'columns', error)
      call require_argument(c_associated(rows%values), 'values', error)
      call require_argument(c_associated(rows%quantities), 'quantities', error)
      call get_names(rows%columns, rows%n_columns, 'name of a column', columns, error)
      call get_names(rows%quantities, rows%n_quantities, 'key of a quantity', quantities, error)
      if (allocated(error)) return
      call c_f_pointer(rows%values, values, [rows%n_columns, rows%n])
      call require_values(values, columns, error)
   end subroutine take_table

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
