!> Numbers of the table of quantities, and forces in N that follow from those over a weight.
program test_quantity_table
   use check, only: checks_t
   use rwmf_problem_quantity_table, only: all_quantities, id, key_of, look_up
   implicit none

   type(checks_t) :: checks

   if (checks%wants('numbers')) call check_numbers()
   if (checks%wants('newtons')) call check_newtons()
   call checks%finish()

contains

   !> Every number from 1 to the last belongs to one row.
   subroutine check_numbers()
      integer :: i, place, storey

      do i = 1, size(all_quantities)
         call checks%that(count(all_quantities%id == i) == 1, 'one row has the number')
         call look_up(trim(all_quantities(i)%key), place, storey)
         call checks%that(place == i, 'one row has the key '//trim(all_quantities(i)%key))
      end do
      call checks%that(key_of(id%u_s_max_m) == 'u_s_max_m', 'the key of a number')
      call checks%that(key_of(id%storey_i_drift_max) == 'storey_{i}_drift_max', 'of storeys')
   end subroutine check_numbers

   !> Each quantity in N names its ratio to a weight, and each ratio to a weight has a quantity
   !> in N.
   subroutine check_newtons()
      character(*), parameter :: weights(3) = [character(12) :: '_over_m_w_g', '_over_weight', &
         '_over_m_s_g']
      character(len(all_quantities%key)) :: key, newtons
      integer :: i, j, first, place, storey

      do i = 1, size(all_quantities)
         key = all_quantities(i)%key
         ! the name in N is that of wall and frame together
         if (any(all_quantities(i)%id == [id%base_shear_over_m_w_g, &
            id%base_shear_max_over_m_w_g])) cycle
         do j = 1, size(weights)
            first = index(key, trim(weights(j)))
            if (first == 0) cycle
            newtons = key(:first - 1)//'_N'//key(first + len_trim(weights(j)):)
            call look_up(trim(newtons), place, storey)
            call checks%that(place > 0, trim(newtons)//' is in the table')
            if (place > 0) call checks%that(all_quantities(place)%ratio == all_quantities(i)%id, &
               trim(newtons)//' follows from '//trim(key))
         end do
         if (all_quantities(i)%unit == 'N' .or. all_quantities(i)%unit == 'N m') call checks%that( &
            all_quantities(i)%ratio > 0, trim(key)//' has its ratio')
      end do
   end subroutine check_newtons

end program test_quantity_table
