!> A row of the history. Whoever reports a column puts its key and its value; a first row gathers
!> the names of the columns, the later ones take the values alone and do not look at the keys.
module rwmf_model_history_row
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: history_row_t, create_row, put, numbered

   !> Values of the columns at one instant.
   type :: history_row_t
      integer :: n
      !! columns that have been put into this row; not counted while names are gathered
      real(wp), allocatable :: values(:)
      !! (columns) in the units of their keys
      character(32), allocatable :: names(:)
      !! (columns); allocated only while they are gathered
   end type history_row_t

   !> Put one column, or one for each storey from the ground up, into the row.
   interface put
      module procedure :: put_value
      module procedure :: put_values
   end interface put

contains

   !> A row without columns, which gathers their names.
   pure subroutine create_row(row)
      type(history_row_t), intent(out) :: row

      allocate (row%values(0), row%names(0))
   end subroutine create_row

   pure subroutine put_value(row, key, value)
      type(history_row_t), intent(inout) :: row
      character(*), intent(in) :: key
      !! with unit suffix
      real(wp), intent(in) :: value
      !! in that unit

      call put_values(row, key, [value])
   end subroutine put_value

   pure subroutine put_values(row, pattern, values)
      type(history_row_t), intent(inout) :: row
      character(*), intent(in) :: pattern
      !! key with '{i}' in the place of the number
      real(wp), intent(in) :: values(:)
      !! (storeys) in the unit of the key
      integer :: n

      n = size(values)
      if (allocated(row%names)) then
         call add_columns(row, pattern, values)
      else
         row%values(row%n + 1:row%n + n) = values
         row%n = row%n + n
      end if
   end subroutine put_values

   pure subroutine add_columns(row, pattern, values)
      type(history_row_t), intent(inout) :: row
      character(*), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      real(wp), allocatable :: more_values(:)
      character(len(row%names)), allocatable :: more_names(:)
      character(40) :: key
      integer :: i
      integer :: n

      n = size(row%names)
      allocate (more_names(n + size(values)), more_values(n + size(values)))
      more_names(:n) = row%names
      more_values(:n) = row%values
      do i = 1, size(values)
         key = numbered(pattern, i)
         more_names(n + i) = key(:len(more_names))
         more_values(n + i) = values(i)
      end do
      call move_alloc(more_names, row%names)
      call move_alloc(more_values, row%values)
   end subroutine add_columns

   !> A key with a number in the place of '{i}'; another key is left as it is.
   pure character(40) function numbered(pattern, number) result(key)
      character(*), intent(in) :: pattern
      !! key of the table of quantities, with or without '{i}'
      integer, intent(in) :: number
      !! which takes the place of '{i}'
      integer :: place

      key = pattern
      place = index(pattern, '{i}')
      if (place > 0) write (key, '(a, i0, a)') pattern(:place - 1), number, pattern(place + 3:)
   end function numbered

end module rwmf_model_history_row
