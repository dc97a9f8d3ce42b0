!> Which periods advance together: those whose steps are equal, in the order of the periods.
module rwmf_fast_order
   use rwmf_fast_lanes, only: lanes
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: group_t, list_groups

   !> Periods with the same step, at most `lanes`.
   type :: group_t
      integer :: level
      !! halvings of the step
      integer :: n
      integer :: member(lanes)
      !! indices of the periods
   end type group_t

contains

   !> Group the periods; the shortest steps first, so that no thread is left alone with an expensive
   !> group at the end. Periods beyond the last level are in none.
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
            do i = 1, size(members), lanes
               n = min(lanes, size(members) - i + 1)
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

   !> Indices of a list in rising order.
   pure function sorted(x) result(order)
      real(wp), intent(in) :: x(:)
      integer :: order(size(x))
      integer :: i, j

      do i = 1, size(x)
         do j = i, 2, -1
            if (x(order(j - 1)) <= x(i)) exit
            order(j) = order(j - 1)
         end do
         order(max(1, j)) = i
      end do
   end function sorted

end module rwmf_fast_order
