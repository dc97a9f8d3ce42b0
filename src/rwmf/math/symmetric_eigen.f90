!> Modes of undamped vibration: K v = omega**2 M v with symmetric K and positive definite M.
!>
!> LAPACK's DSYGV solves the problem in double precision. In quadruple precision, Rayleigh quotient
!> iteration then improves each pair: every iteration triples the number of correct digits.
module rwmf_math_symmetric_eigen
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: diagonalise, solve_modes

   interface
      !> All eigenvalues and eigenvectors of A x = lambda B x, by LAPACK.
      subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
         import :: dp
         implicit none
         integer, intent(in) :: itype, n, lda, ldb, lwork
         character, intent(in) :: jobz, uplo
         real(dp), intent(inout) :: a(lda, n), b(ldb, n)
         real(dp), intent(out) :: w(n), work(lwork)
         integer, intent(out) :: info
      end subroutine dsygv
   end interface

contains

   !> Find all modes in the order of their frequencies. Fails with `err_numerical`.
   subroutine solve_modes(stiffness, mass, omega, shape, error)
      real(wp), intent(in) :: stiffness(:, :)
      !! (n, n) symmetric [1/s2 times the unit of mass]
      real(wp), intent(in) :: mass(:, :)
      !! (n, n) symmetric, positive definite [unit of mass]
      real(wp), intent(out) :: omega(:)
      !! (n) [rad/s]
      real(wp), intent(out) :: shape(:, :)
      !! (n, n) one mode in each column, with unit modal mass
      type(error_t), allocatable, intent(out) :: error
      real(dp) :: a(size(omega), size(omega))
      real(dp) :: b(size(omega), size(omega))
      real(dp) :: w(size(omega))
      real(dp) :: work(34*size(omega))
      !! (NB + 2) n for a usual block size
      integer :: info
      integer :: i

      a = real(stiffness, dp)
      b = real(mass, dp)
      call dsygv(1, 'V', 'U', size(w), a, size(w), b, size(w), w, work, size(work), info)
      if (info == 0 .and. .not. w(1) > 0) info = -1
      if (info /= 0) then
         call fail(error, err_numerical, 'the modes of the frame cannot be found: LAPACK DSYGV, ' &
            //'info = '//trim(integer_to_text(info)) &
            //'; masses or stiffnesses differ by too many powers of ten', 'no_modes')
         return
      end if
      omega = sqrt(real(w, wp))
      shape = real(a, wp)
      if (wp == dp) return
      do i = 1, size(omega)
         call improve(stiffness, mass, omega(i), shape(:, i))
      end do
   end subroutine solve_modes

   !> Find all eigenvalues and eigenvectors of a small symmetric matrix by Jacobi's rotations.
   pure subroutine diagonalise(matrix, values, vectors)
      real(wp), intent(in) :: matrix(:, :)
      !! (n, n) symmetric, in any unit
      real(wp), intent(out) :: values(:)
      !! (n) in the unit of the matrix, not in order
      real(wp), intent(out) :: vectors(:, :)
      !! (n, n) one orthonormal vector in each column [-]
      integer, parameter :: most_sweeps = 30
      !! the convergence is quadratic: some 6 sweeps suffice
      real(wp) :: a(size(values), size(values)), kept(size(values)), slope, c, s, negligible
      integer :: i, j, sweep
      logical :: is_done

      a = matrix
      vectors = 0
      do i = 1, size(values)
         vectors(i, i) = 1
      end do
      negligible = maxval(abs(matrix))*epsilon(slope)**2
      do sweep = 1, most_sweeps
         is_done = .true.
         do j = 2, size(values)
            do i = 1, j - 1
               if (abs(a(i, j)) <= negligible) cycle
               is_done = .false.
               ! below 1/epsilon**2: its square cannot overflow
               slope = (a(j, j) - a(i, i))/(2*a(i, j))
               slope = sign(1.0_wp, slope)/(abs(slope) + sqrt(1 + slope**2))
               c = 1/sqrt(1 + slope**2)
               s = slope*c
               kept = a(:, i)
               a(:, i) = c*kept - s*a(:, j)
               a(:, j) = s*kept + c*a(:, j)
               kept = a(i, :)
               a(i, :) = c*kept - s*a(j, :)
               a(j, :) = s*kept + c*a(j, :)
               a(i, j) = 0
               a(j, i) = 0
               kept = vectors(:, i)
               vectors(:, i) = c*kept - s*vectors(:, j)
               vectors(:, j) = s*kept + c*vectors(:, j)
            end do
         end do
         if (is_done) exit
      end do
      values = [(a(i, i), i=1, size(values))]
   end subroutine diagonalise

   !> Improve an eigenpair by Rayleigh quotient iteration; its convergence is cubic.
   pure subroutine improve(stiffness, mass, omega, mode)
      real(wp), intent(in) :: stiffness(:, :)
      real(wp), intent(in) :: mass(:, :)
      real(wp), intent(inout) :: omega
      real(wp), intent(inout) :: mode(:)
      integer :: i

      do i = 1, 3
         omega = sqrt(dot_product(mode, matmul(stiffness, mode)) &
            /dot_product(mode, matmul(mass, mode)))
         if (i == 3) return
         mode = solution(stiffness - omega**2*mass, matmul(mass, mode))
         mode = mode/sqrt(dot_product(mode, matmul(mass, mode)))
      end do
   end subroutine improve

   !> Solution of a linear system by Gaussian elimination with pivoting; the matrix may be singular
   !> to round-off.
   pure function solution(matrix, right) result(x)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(in) :: right(:)
      real(wp) :: x(size(right))
      real(wp) :: rows(size(right), size(right) + 1)
      real(wp) :: kept(size(right) + 1)
      integer :: i, j, n

      n = size(right)
      rows(:, :n) = matrix
      rows(:, n + 1) = right
      do i = 1, n
         j = i - 1 + maxloc(abs(rows(i:, i)), 1)
         kept = rows(i, :)
         rows(i, :) = rows(j, :)
         rows(j, :) = kept
         if (abs(rows(i, i)) <= 0) rows(i, i) = epsilon(x)*maxval(abs(matrix))
         do j = i + 1, n
            rows(j, i:) = rows(j, i:) - rows(j, i)/rows(i, i)*rows(i, i:)
         end do
      end do
      do i = n, 1, -1
         x(i) = (rows(i, n + 1) - dot_product(rows(i, i + 1:n), x(i + 1:)))/rows(i, i)
      end do
   end function solution

end module rwmf_math_symmetric_eigen
