!> Response on a uniform grid of times.
module rwmf_simulation_state_history
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_table, only: key_length
   use rwmf_problem_quantity_values, only: keys_of, values_t
   implicit none
   private

   public :: history_t, create_history, shorten_history

   !> Response on a uniform grid of times.
   type :: history_t
      character(32), allocatable :: names(:)
      !! (columns), with unit suffix as in the CSV file: 't_s', 'theta_rad', ...
      real(wp), allocatable :: values(:, :)
      !! (rows, columns) in the units of the names; rows end at overturning or collapse
   end type history_t

contains

   !> Allocate the rows of a history.
   subroutine create_history(history, row, t_end, dt, error)
      type(history_t), intent(out) :: history
      type(values_t), intent(in) :: row
      !! any row
      real(wp), intent(in) :: t_end, dt
      !! duration and interval [s]
      type(error_t), allocatable, intent(out) :: error
      !! the history does not fit into memory
      character(key_length) :: keys(row%n)
      real(wp) :: rows
      integer :: status

      keys = keys_of(row)
      history%names = keys(:)(:len(history%names))
      rows = aint(t_end/dt*(1 + 8*epsilon(1.0_wp))) + 1
      status = 1
      if (rows < real(huge(1), wp)) allocate (history%values(int(rows), row%n), stat=status)
      if (status /= 0) call fail(error, err_numerical, 'out of memory for the history: &output ' &
         //'dt gives more rows than fit; raise dt or lower t_end', 'out_of_memory')
   end subroutine create_history

   !> Keep the first rows of a history.
   !>
   !> The copy is allocated explicitly, because a temporary array could exceed the stack.
   pure subroutine shorten_history(history, n)
      type(history_t), intent(inout) :: history
      integer, intent(in) :: n
      !! number of rows to keep
      real(wp), allocatable :: kept(:, :)

      if (n == size(history%values, 1)) return
      allocate (kept(n, size(history%values, 2)))
      kept(:, :) = history%values(:n, :)
      call move_alloc(kept, history%values)
   end subroutine shorten_history

end module rwmf_simulation_state_history
