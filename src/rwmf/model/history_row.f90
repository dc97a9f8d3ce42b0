!> Row of the history whose columns are identified by their numbers in the table of quantities. The
!> first row collects numbers and names of the columns; later rows contain only values.
module rwmf_model_history_row
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_table, only: key_length, key_of
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: history_row_t, create_row, put, numbered

   !> Values of the columns at one instant.
   type :: history_row_t
      integer :: n
      !! columns written to this row so far; not counted while names are collected
      real(wp), allocatable :: values(:)
      !! (columns) in the units of their keys
      character(32), allocatable :: names(:)
      !! (columns) names, allocated only while they are collected
      integer, allocatable :: numbers(:)
      !! (columns) numbers of the quantities, allocated like the names
      integer, allocatable :: below(:)
      !! (columns) number of lower storeys that have no column of this quantity, allocated like the
      !! names
   end type history_row_t

   !> Append one column, or one for each storey from the ground up, to the row.
   interface put
      module procedure :: put_value
      module procedure :: put_values
   end interface put

contains

   !> Create a row without columns that collects their names.
   pure subroutine create_row(row)
      type(history_row_t), intent(out) :: row

      allocate (row%values(0), row%names(0), row%numbers(0), row%below(0))
   end subroutine create_row

   pure subroutine put_value(row, number, value)
      type(history_row_t), intent(inout) :: row
      integer, intent(in) :: number
      !! number of the quantity
      real(wp), intent(in) :: value
      !! in the unit of its key

      call put_values(row, number, [value])
   end subroutine put_value

   pure subroutine put_values(row, number, values, below)
      type(history_row_t), intent(inout) :: row
      integer, intent(in) :: number
      real(wp), intent(in) :: values(:)
      !! (storeys) in the unit of the key
      integer, intent(in), optional :: below
      !! number of lower storeys without a value; 0 if absent
      integer :: n

      n = size(values)
      if (allocated(row%names)) then
         call add_columns(row, number, values, below)
      else
         row%values(row%n + 1:row%n + n) = values
         row%n = row%n + n
      end if
   end subroutine put_values

   pure subroutine add_columns(row, number, values, below)
      type(history_row_t), intent(inout) :: row
      integer, intent(in) :: number
      real(wp), intent(in) :: values(:)
      integer, intent(in), optional :: below
      character(len(row%names)), allocatable :: more_names(:)
      character(key_length) :: key
      integer :: i, n, first

      first = 0
      if (present(below)) first = below
      n = size(row%names)
      allocate (more_names(n + size(values)))
      more_names(:n) = row%names
      do i = 1, size(values)
         key = numbered(trim(key_of(number)), first + i)
         more_names(n + i) = key(:len(more_names))
      end do
      call move_alloc(more_names, row%names)
      row%values = [row%values, values]
      row%numbers = [row%numbers, spread(number, 1, size(values))]
      row%below = [row%below, spread(first, 1, size(values))]
   end subroutine add_columns

   !> Key with a number in place of '{i}'; any other key is unchanged.
   pure character(key_length) function numbered(pattern, number) result(key)
      character(*), intent(in) :: pattern
      !! key of the table of quantities, with or without '{i}'
      integer, intent(in) :: number
      !! number that replaces '{i}'
      integer :: place

      key = pattern
      place = index(pattern, '{i}')
      if (place > 0) key = pattern(:place - 1)//trim(integer_to_text(number))//pattern(place + 3:)
   end function numbered

end module rwmf_model_history_row
