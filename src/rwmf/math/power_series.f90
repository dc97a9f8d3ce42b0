!> Terms of products, quotients and roots of power series, one coefficient at a time.
!>
!> Coefficient n of an operation needs coefficients 0 to n of its arguments. All numbers are in the
!> caller's units.
module rwmf_math_power_series
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: product_term, quotient_term, root_term, series_value

contains

   !> Coefficient n of the product of two series.
   pure real(wp) function product_term(n, a, b) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(0:n), b(0:n)
      !! coefficients
      real(wp) :: odd
      integer :: k

      ! two sums, which the processor computes side by side
      c = a(0)*b(n)
      odd = 0
      do k = 1, n - 1, 2
         odd = odd + a(k)*b(n - k)
         c = c + a(k + 1)*b(n - k - 1)
      end do
      if (modulo(n, 2) == 1) odd = odd + a(n)*b(0)
      c = c + odd
   end function product_term

   !> Coefficient n of a quotient.
   pure real(wp) function quotient_term(n, top, b, quotient) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: top
      !! coefficient n of the dividend
      real(wp), intent(in) :: b(0:n)
      !! coefficients of the divisor
      real(wp), intent(in) :: quotient(0:n)
      !! coefficients below n
      integer :: k

      c = top
      do k = 1, n
         c = c - b(k)*quotient(n - k)
      end do
      c = c/b(0)
   end function quotient_term

   !> Coefficient n > 0 of a square root.
   pure real(wp) function root_term(n, square, root) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: square
      !! coefficient n of the square
      real(wp), intent(in) :: root(0:n)
      !! coefficients below n
      integer :: k

      c = square
      do k = 1, n - 1
         c = c - root(k)*root(n - k)
      end do
      c = c/(2*root(0))
   end function root_term

   !> Value of a series.
   pure real(wp) function series_value(c, x) result(value)
      real(wp), intent(in) :: c(0:)
      !! coefficients
      real(wp), intent(in) :: x
      integer :: k

      value = 0
      do k = ubound(c, 1), 0, -1
         value = value*x + c(k)
      end do
   end function series_value

end module rwmf_math_power_series
