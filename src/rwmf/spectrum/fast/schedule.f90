!> Order in which the ordinates of a fast spectrum are started.
module rwmf_spectrum_fast_schedule
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: order_by_cost

contains

   !> Indices of the periods, the most expensive ones first: by the length of their steps, then in
   !> rising order. Adjacent periods have similar motions, and no expensive one is left to the end.
   pure function order_by_cost(T_s, level, last_level) result(order)
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      integer, intent(in) :: level(:)
      !! (n_T) halvings of the step
      integer, intent(in) :: last_level
      !! periods beyond it are left out
      integer, allocatable :: order(:)
      integer :: rising(size(T_s))
      integer :: l

      rising = sorted(T_s)
      allocate (order(0))
      do l = last_level, 0, -1
         order = [order, pack(rising, level(rising) == l)]
      end do
   end function order_by_cost

   !> Indices of a list in rising order, by merging sorted runs.
   pure function sorted(x) result(order)
      real(wp), intent(in) :: x(:)
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
   end function sorted

   !> Indices of two sorted lists, merged in rising order.
   pure function merged(x, left, right) result(order)
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: left(:)
      !! indices in the order of x
      integer, intent(in) :: right(:)
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

end module rwmf_spectrum_fast_schedule
