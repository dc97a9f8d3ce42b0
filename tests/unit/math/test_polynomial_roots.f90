!> First roots and largest values of polynomials with known roots: twice within the span, grazing,
!> at the start, and as pairs close together.
program test_polynomial_roots
   use check, only: checks_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_polynomial_roots, only: evaluate, find_largest, first_negative
   implicit none

   type(checks_t) :: checks

   if (checks%wants('twice')) call check_twice()
   if (checks%wants('graze')) call check_graze()
   if (checks%wants('start')) call check_start()
   if (checks%wants('random')) call check_random()
   if (checks%wants('largest')) call check_largest()
   call checks%finish()

contains

   !> Two roots inside the span, far apart and down to a distance of 1e-6: the first one is found.
   subroutine check_twice()
      real(wp), allocatable :: c(:)
      real(wp) :: first, gap
      integer :: i, k, missed

      missed = 0
      do i = 1, 19
         do k = 1, 6
            first = 0.05_wp*i - 1.0e-3_wp
            gap = 0.05_wp*10.0_wp**(-k + 0.3_wp)
            if (gap < 1.0e-6_wp) gap = 1.0e-6_wp
            c = product_of([1.0_wp], [first, first + gap, -0.7_wp, 1.9_wp, -3.1_wp, 2.3_wp])
            if (c(1) < 0) c = -c
            if (abs(first_negative(c, 1.0_wp) - first) > 1.0e-3_wp*gap) missed = missed + 1
         end do
      end do
      call checks%that(missed == 0, 'the first of two roots is found')
   end subroutine check_twice

   !> A minimum just above zero is no root; one just below zero is one.
   subroutine check_graze()
      real(wp) :: c(0:8), height, error
      integer :: k, wrong

      wrong = 0
      do k = 2, 12
         height = 10.0_wp**(-k)
         ! (x - 0.4)**2 + height, with a term of high degree
         c = 0
         c(:2) = [0.16_wp + height, -0.8_wp, 1.0_wp]
         if (first_negative(c, 1.0_wp) <= 1) wrong = wrong + 1
         c(0) = 0.16_wp - height
         error = abs(first_negative(c, 1.0_wp) - (0.4_wp - sqrt(height)))
         if (error > 1.0e-3_wp*sqrt(height)) wrong = wrong + 1
      end do
      call checks%that(wrong == 0, 'a graze is told from two roots')
   end subroutine check_graze

   !> A root at the start whose power is divided out is not found again; one that stays counts only
   !> where the polynomial falls.
   subroutine check_start()
      real(wp), allocatable :: c(:)

      c = product_of([1.0_wp], [-0.5_wp, 2.0_wp, 0.25_wp])
      call checks%that(abs(first_negative(c, 1.0_wp) - 0.25_wp) < 1.0e-14_wp, 'after division')
      call checks%that(first_negative([0.0_wp, 1.0_wp, -0.1_wp], 1.0_wp) > 1, 'rising from zero')
      call checks%that(first_negative([0.0_wp, -1.0_wp, 0.1_wp], 1.0_wp) < 1.0e-12_wp, &
         'falling from zero')
      call checks%that(first_negative([-1.0_wp, 1.0_wp], 1.0_wp) <= 0, 'negative at the start')
   end subroutine check_start

   !> Polynomials of degree 8 with random coefficients: no sample before the found root is negative,
   !> and samples behind a missing root are not negative either.
   subroutine check_random()
      integer, parameter :: polynomials = 20000, samples = 64
      real(wp) :: c(0:8), root, value, slope
      integer :: i, k, wrong, found

      wrong = 0
      found = 0
      call random_init(repeatable=.true., image_distinct=.false.)
      do i = 1, polynomials
         call random_number(c)
         c = (2*c - 1)*[(1.5_wp**k/gamma(k + 1.0_wp), k=0, 8)]
         c(0) = abs(c(0))
         root = first_negative(c, 1.0_wp)
         if (root <= 1) found = found + 1
         do k = 1, samples
            call evaluate(c, min(root, 1.0_wp)*(k - 0.5_wp)/samples, value, slope)
            if (value < -1.0e-14_wp) wrong = wrong + 1
         end do
         if (root > 1) cycle
         call evaluate(c, root, value, slope)
         if (abs(value) > 1.0e-14_wp .or. slope > 1.0e-6_wp) wrong = wrong + 1
      end do
      call checks%that(wrong == 0, 'all first roots are right')
      call checks%that(found > polynomials/8, 'many polynomials have one')
   end subroutine check_random

   !> The largest value is that of dense samples, to the square of their distance.
   subroutine check_largest()
      integer, parameter :: polynomials = 4000, samples = 400
      real(wp) :: c(0:8), largest, place, best, value, slope
      integer :: i, k, wrong

      wrong = 0
      call random_init(repeatable=.true., image_distinct=.false.)
      do i = 1, polynomials
         call random_number(c)
         c = (2*c - 1)*[(3.0_wp**k/gamma(k + 1.0_wp), k=0, 8)]
         call find_largest(c, 0.9_wp, largest, place)
         call evaluate(c, place, value, slope)
         if (abs(value - largest) > 1.0e-13_wp) wrong = wrong + 1
         best = -huge(best)
         do k = 0, samples
            call evaluate(c, 0.9_wp*k/samples, value, slope)
            best = max(best, value)
         end do
         if (largest < best - 1.0e-14_wp .or. largest > best + 1.0e-4_wp) wrong = wrong + 1
      end do
      call checks%that(wrong == 0, 'no larger value, and none too large')
   end subroutine check_largest

   !> Coefficients of a polynomial times (x - root) for each root.
   pure function product_of(factor, roots) result(c)
      real(wp), intent(in) :: factor(0:)
      real(wp), intent(in) :: roots(:)
      real(wp), allocatable :: c(:)
      integer :: i, n

      n = size(factor) - 1
      allocate (c(0:n + size(roots)), source=0.0_wp)
      c(0:n) = factor
      do i = 1, size(roots)
         c(1:n + i) = c(0:n + i - 1) - roots(i)*c(1:n + i)
         c(0) = -roots(i)*c(0)
      end do
   end function product_of

end program test_polynomial_roots
