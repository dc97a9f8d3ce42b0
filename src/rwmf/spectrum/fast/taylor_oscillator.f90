!> Taylor series of a linear oscillator under a cubic forcing: weights of a step, state within it.
!>
!> In z'' = - d z' - k z + F(x) with a cubic F every derivative follows from the two before it. The
!> series converges for every step and for any sign of k; with sqrt(k) h < 1 its terms fall below
!> round-off before the last one that is kept; strong damping asks the same of `fastest_root` h.
module rwmf_spectrum_fast_taylor_oscillator
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_types, only: c_2, c_3
   implicit none
   private

   public :: fastest_root, newton_to_powers, series, series_terms, state_at, step_weights

   integer, parameter :: series_terms = 15
   !! highest power of the series

contains

   !> Largest magnitude of the roots of s**2 + d s + k [1/s].
   pure elemental real(wp) function fastest_root(damping, stiffness) result(root)
      real(wp), intent(in) :: damping
      !! d >= 0 [1/s]
      real(wp), intent(in) :: stiffness
      !! k >= 0 [1/s2]
      real(wp) :: half

      half = damping/2
      root = sqrt(stiffness)
      if (half > root) root = half + sqrt((half - root)*(half + root))
   end function fastest_root

   !> Coefficients of z in powers of x = t/h.
   pure subroutine series(damping, stiffness, h, z, rate, forcing, p)
      real(wp), intent(in) :: damping
      !! d [1/s]
      real(wp), intent(in) :: stiffness
      !! k [1/s2]
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: z
      !! z(0), of any unit
      real(wp), intent(in) :: rate
      !! z'(0), in the unit of z per second
      real(wp), intent(in) :: forcing(0:3)
      !! coefficients of F in powers of x, in the unit of z per second squared
      real(wp), intent(out) :: p(0:series_terms)
      !! the coefficients, in the unit of z
      integer :: j
      real(wp), parameter :: inverse(0:series_terms - 2) = [(1/real((j + 1)*(j + 2), wp), &
         j=0, series_terms - 2)]
      real(wp) :: d
      real(wp) :: k
      integer :: i

      d = damping*h
      k = stiffness*h**2
      p(0) = z
      p(1) = h*rate
      do i = 0, 3
         p(i + 2) = (h**2*forcing(i) - (d*(i + 1)*p(i + 1) + k*p(i)))*inverse(i)
      end do
      do i = 4, series_terms - 2
         p(i + 2) = -(d*(i + 1)*p(i + 1) + k*p(i))*inverse(i)
      end do
   end subroutine series

   !> Polynomial and its derivative at x.
   !>
   !> Even and odd powers are summed apart: two short chains of dependent operations take less time
   !> than one.
   pure subroutine state_at(p, x, value, rate)
      real(wp), contiguous, intent(in) :: p(0:)
      !! coefficients in powers of x, from 0, of any unit
      real(wp), intent(in) :: x
      !! position in the step [-]
      real(wp), intent(out) :: value
      !! in the unit of the coefficients
      real(wp), intent(out) :: rate
      !! derivative by x, in the unit of the coefficients
      real(wp) :: even, even_1, odd, odd_1
      !! polynomials of x**2 and their derivatives
      real(wp) :: square
      integer :: i
      integer :: top
      !! highest even power

      square = x*x
      top = ubound(p, 1) - mod(ubound(p, 1), 2)
      even = p(top)
      odd = 0
      if (top < ubound(p, 1)) odd = p(top + 1)
      even_1 = 0
      odd_1 = 0
      do i = top - 2, 0, -2
         even_1 = even_1*square + even
         odd_1 = odd_1*square + odd
         even = even*square + p(i)
         odd = odd*square + p(i + 1)
      end do
      value = even + x*odd
      rate = 2*x*(even_1 + x*odd_1) + odd
   end subroutine state_at

   !> Powers of x from divided differences on 0, c2, c3, 1 (c2 + c3 = 1, c2 c3 = 1/5).
   pure function newton_to_powers(d) result(p)
      real(wp), intent(in) :: d(0:3)
      !! divided differences: coefficients of 1, x, x (x - c2), x (x - c2)(x - c3), of any unit
      real(wp) :: p(0:3)

      p = [d(0), d(1) - c_2*d(2) + c_2*c_3*d(3), d(2) - d(3), d(3)]
   end function newton_to_powers

   !> Weights of a step as `rwmf_spectrum_fast_step_kernel` orders them.
   pure function step_weights(damping, stiffness, h, middle) result(weight)
      real(wp), intent(in) :: damping
      !! [1/s]
      real(wp), intent(in) :: stiffness
      !! [1/s2]
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: middle
      !! the second node [-]
      real(wp) :: weight(12, 3)
      !! (contributions, nodes): those of z(0) and z'(0) to z, to z', those of the four modes of the
      !! forcing to z, to z'
      real(wp) :: node(3)
      real(wp) :: p(0:series_terms, 6)
      real(wp) :: mode(0:3)
      integer :: i
      integer :: j

      node = [c_2, middle, 1.0_wp]
      call series(damping, stiffness, h, 1.0_wp, 0.0_wp, [real(wp) :: 0, 0, 0, 0], p(:, 1))
      call series(damping, stiffness, h, 0.0_wp, 1.0_wp, [real(wp) :: 0, 0, 0, 0], p(:, 2))
      do j = 0, 3
         mode = 0
         mode(j) = 1
         call series(damping, stiffness, h, 0.0_wp, 0.0_wp, newton_to_powers(mode), &
            p(:, 3 + j))
      end do
      do i = 1, 3
         do j = 1, 2
            call state_at(p(:, j), node(i), weight(j, i), weight(2 + j, i))
         end do
         do j = 0, 3
            call state_at(p(:, 3 + j), node(i), weight(5 + j, i), weight(9 + j, i))
         end do
         weight(3:4, i) = weight(3:4, i)/h
         weight(9:, i) = weight(9:, i)/h
      end do
   end function step_weights

end module rwmf_spectrum_fast_taylor_oscillator
