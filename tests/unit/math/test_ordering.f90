!> Order of numbers.
program test_ordering
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_ordering, only: rising_order
   implicit none

   type(checks_t) :: checks

   if (checks%wants('rising')) call check_rising()
   call checks%finish()

contains

   !> Lists of all lengths up to 40, with equal numbers.
   subroutine check_rising()
      real(wp), allocatable :: x(:)
      integer, allocatable :: order(:)
      integer :: i, n

      do n = 0, 40
         x = [(real(modulo(17*i**2 + 5*i, 13), wp), i=1, n)]
         order = rising_order(x)
         call checks%that(size(order) == n .and. all([(any(order == i), i=1, n)]), &
            'every index once')
         call checks%that(all(x(order(2:)) >= x(order(:n - 1))), 'rising')
         call checks%that(all(x(order(2:)) > x(order(:n - 1)) .or. order(2:) > order(:n - 1)), &
            'equal numbers keep their order')
      end do
   end subroutine check_rising

end program test_ordering
