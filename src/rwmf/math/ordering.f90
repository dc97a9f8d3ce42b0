!> Sorting of numbers.
module rwmf_math_ordering
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: rising_order

contains

   !> Indices that sort a list in rising order, by a stable merge sort.
   pure function rising_order(x) result(order)
      real(wp), intent(in) :: x(:)
      !! of any unit
      integer :: order(size(x))
      integer :: i, n

      order = [(i, i=1, size(x))]
      n = 1
      do while (n < size(x))
         do i = 1, size(x) - n, 2*n
            associate (last => min(i + 2*n - 1, size(x)))
               order(i:last) = merged(x, order(i:i + n - 1), order(i + n:last))
            end associate
         end do
         n = 2*n
      end do
   end function rising_order

   !> Indices of two sorted lists, merged in rising order.
   pure function merged(x, left, right) result(order)
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: left(:), right(:)
      !! indices of rising x
      integer :: order(size(left) + size(right))
      integer :: i, j, k
      logical :: takes_left

      i = 1
      j = 1
      do k = 1, size(order)
         takes_left = j > size(right)
         if (.not. takes_left .and. i <= size(left)) takes_left = x(left(i)) <= x(right(j))
         if (takes_left) then
            order(k) = left(i)
            i = i + 1
         else
            order(k) = right(j)
            j = j + 1
         end if
      end do
   end function merged

end module rwmf_math_ordering
