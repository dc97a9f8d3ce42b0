!> Order in which the ordinates of a fast spectrum are started; groups of bare frames.
module rwmf_spectrum_fast_schedule
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_types, only: frame_block_width
   implicit none
   private

   public :: order_by_cost, group_t, list_groups

   !> At most `frame_block_width` periods with the same step.
   type :: group_t
      integer :: level
      !! halvings of the step
      integer :: n
      !! number of periods
      integer :: member(frame_block_width)
      !! indices of the periods
   end type group_t

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

   !> Group the periods, the shortest steps first, so that no expensive group is left to the end,
   !> when other threads are idle. Periods beyond the last level are in no group.
   pure function list_groups(T_s, level, last_level) result(group)
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      integer, intent(in) :: level(:)
      !! (n_T) halvings of the step
      integer, intent(in) :: last_level
      type(group_t), allocatable :: group(:)
      integer :: order(size(T_s))
      integer :: i, l, n

      order = sorted(T_s)
      allocate (group(0))
      do l = last_level, 0, -1
         associate (members => pack(order, level(order) == l))
            do i = 1, size(members), frame_block_width
               n = min(frame_block_width, size(members) - i + 1)
               group = [group, group_of(l, members(i:i + n - 1))]
            end do
         end associate
      end do
   end function list_groups

   pure type(group_t) function group_of(level, member) result(group)
      integer, intent(in) :: level
      integer, intent(in) :: member(:)

      group%level = level
      group%n = size(member)
      group%member = 0
      group%member(:group%n) = member
   end function group_of

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
