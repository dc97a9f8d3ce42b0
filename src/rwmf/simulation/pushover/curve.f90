!> Static curve: rows of values over the steps of a path, and marks at some of the steps.
module rwmf_simulation_pushover_curve
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_table, only: key_length
   implicit none
   private

   public :: static_curve_t, mark_t, add_row, add_mark, mark_length

   integer, parameter :: mark_length = 32
   !! length of the longest name of a mark

   !> Named event of the path.
   type :: mark_t
      character(mark_length) :: name = ''
      !! for example 'uplift' or 'storey_2_yield'
      integer :: step = 0
      !! row at which it happens
   end type mark_t

   !> Static curve.
   type :: static_curve_t
      character(key_length), allocatable :: names(:)
      !! (columns) names with units
      real(wp), allocatable :: values(:, :)
      !! (columns, rows) only the first `n` rows are in use; in the units of their names
      integer :: n = 0
      !! number of rows
      type(mark_t), allocatable :: marks(:)
      !! (marks) in the order of the path
      real(wp), allocatable :: pattern(:)
      !! (loads) share of each floor in the load [-]
      real(wp) :: weight = 0
      !! weight of wall and frame, under base shear and overturning moment, over the unit of mass
      !! [m/s2]
      real(wp) :: height = 0
      !! height of the roof, under its drift [m]
      character(mark_length) :: ending = 'complete'
      !! 'complete', 'overturned', 'collapsed', 'no_equilibrium' or 'no_contact'
   end type static_curve_t

contains

   !> Append a row.
   pure subroutine add_row(curve, values)
      type(static_curve_t), intent(inout) :: curve
      real(wp), intent(in) :: values(:)
      !! (columns) in the units of their names
      real(wp), allocatable :: more(:, :)

      if (.not. allocated(curve%values)) allocate (curve%values(size(values), 64))
      if (curve%n == size(curve%values, 2)) then
         allocate (more(size(values), 2*curve%n))
         more(:, :curve%n) = curve%values
         call move_alloc(more, curve%values)
      end if
      curve%n = curve%n + 1
      curve%values(:, curve%n) = values
   end subroutine add_row

   !> Mark the last row.
   pure subroutine add_mark(curve, name)
      type(static_curve_t), intent(inout) :: curve
      character(*), intent(in) :: name
      !! name of the mark

      if (.not. allocated(curve%marks)) allocate (curve%marks(0))
      curve%marks = [curve%marks, mark_t(name, curve%n)]
   end subroutine add_mark

end module rwmf_simulation_pushover_curve
