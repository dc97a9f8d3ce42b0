!> Table of output quantities as text, for the Python package and `docs/reference/outputs.md`.
module rwmf_problem_quantity_text
   use rwmf_problem_quantity_table, only: all_quantities, is_peak, name_of, quantity_t, &
      requested_by, sensitivity_row
   implicit none
   private

   public :: quantities_text

contains

   !> Write the table as text: tab-separated components in their order, one quantity per line.
   pure subroutine quantities_text(text)
      character(:), allocatable, intent(out) :: text
      !! the lines, each with its line feed
      integer :: i

      text = ''
      do i = 1, size(all_quantities)
         call append_line(all_quantities(i), text)
      end do
      do i = 1, size(all_quantities)
         if (is_peak(all_quantities(i))) call append_line(sensitivity_row(all_quantities(i)), text)
      end do
   end subroutine quantities_text

   !> Append the components of a row, separated by tabs, and a line feed.
   pure subroutine append_line(row, text)
      type(quantity_t), intent(in) :: row
      character(:), allocatable, intent(inout) :: text
      character(*), parameter :: tab = achar(9)

      text = text//trim(row%key)//tab//trim(name_of(row))//tab//trim(row%unit)//tab &
         //trim(row%kind)//tab//trim(row%found)//tab//trim(row%outputs)//tab//trim(row%group)//tab &
         //trim(requested_by(row))//tab//trim(row%needs)//tab//trim(row%meaning)//new_line('a')
   end subroutine append_line

end module rwmf_problem_quantity_text
