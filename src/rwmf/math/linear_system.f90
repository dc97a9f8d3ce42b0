!> Small dense system of linear equations.
module rwmf_math_linear_system
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: solve_system

contains

   !> Solve a system by Gaussian elimination with scaled partial pivoting.
   pure subroutine solve_system(a, b, x, is_regular)
      real(wp), intent(in) :: a(:, :)
      !! (n, n) matrix, in any units
      real(wp), intent(in) :: b(:)
      !! (n) right-hand side, in any units
      real(wp), intent(out) :: x(:)
      !! (n) solution, in any units that follow; undefined for a singular matrix
      logical, intent(out) :: is_regular
      !! no pivot vanishes
      real(wp), allocatable :: work(:, :), swap(:)
      real(wp) :: largest
      integer :: i, j, pivot

      associate (n => size(b))
         is_regular = .false.
         allocate (work(n, n + 1))
         do i = 1, n
            largest = maxval(abs(a(i, :)))
            if (.not. (largest > 0 .and. largest < huge(largest))) return
            work(i, :) = [a(i, :), b(i)]/largest
         end do
         do i = 1, n
            pivot = i - 1 + maxloc(abs(work(i:, i)), dim=1)
            if (.not. abs(work(pivot, i)) > 0) return
            swap = work(i, :)
            work(i, :) = work(pivot, :)
            work(pivot, :) = swap
            do j = i + 1, n
               work(j, i:) = work(j, i:) - work(j, i)/work(i, i)*work(i, i:)
            end do
         end do
         do i = n, 1, -1
            x(i) = (work(i, n + 1) - dot_product(work(i, i + 1:n), x(i + 1:)))/work(i, i)
         end do
         is_regular = all(abs(x) < huge(largest))
      end associate
   end subroutine solve_system

end module rwmf_math_linear_system
