!> Taylor series of a linear oscillator under a cubic forcing: weights of a step, state within it.
!>
!> In z'' = - d z' - k z + F(x) with a cubic F every derivative follows from the two before it. The
!> series converges for every step and for any sign of k; with sqrt(k) h < 1 its terms fall below
!> round-off before the last one that is kept.
module rwmf_spectrum_fast_taylor_oscillator
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   use rwmf_spectrum_fast_types, only: c_2, c_3
   implicit none
   private

   public :: series_terms, series, state_at, newton_to_powers, step_weights, find_root

   integer, parameter :: series_terms = 15
   !! highest power of the series

contains

   !> Coefficients of z in powers of x = t/h.
   pure subroutine series(damping, stiffness, h, z, rate, forcing, p)
      real(wp), intent(in) :: damping
      !! d [1/s]
      real(wp), intent(in) :: stiffness
      !! k [1/s2]
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: z
      !! z(0)
      real(wp), intent(in) :: rate
      !! z'(0) per second
      real(wp), intent(in) :: forcing(0:3)
      !! coefficients of F in powers of x, per second squared
      real(wp), intent(out) :: p(0:series_terms)
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
      real(wp), intent(in) :: x
      real(wp), intent(out) :: value
      real(wp), intent(out) :: rate
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
      !! (contributions, nodes), as in `lane_constants_t`
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

   !> Root of a polynomial in a bracket: Newton's method from the parabola through both ends,
   !> with bisection where it would leave the bracket.
   pure subroutine find_root(p, low_start, high_start, x)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: low_start
      real(wp), intent(in) :: high_start
      !! the polynomial has different signs at both ends
      real(wp), intent(out) :: x
      integer, parameter :: max_iterations = 80
      type(bracket_t) :: bracket
      real(wp) :: p_high, value, slope, next
      integer :: i

      bracket = bracket_between(low_start, high_start)
      call first_guess(p, low_start, high_start, p_high, x)
      do i = 1, max_iterations
         call state_at(p, x, value, slope)
         if (abs(value) <= 0) return
         call narrow(bracket, (value > 0) .eqv. (p_high > 0), x)
         next = bracket%middle
         if (abs(value) < abs(slope)*(high_start - low_start)) then
            next = keep_inside(bracket, x - value/slope, may_be_end=.true.)
         end if
         ! Newton's method is quadratic: the error after a small correction is round-off.
         if (abs(next - x) <= 1.0e-9_wp*abs(next)) exit
         x = next
      end do
      x = next
   end subroutine find_root

   !> Start of the iteration: root of the parabola through both ends and the slope at the lower one.
   pure subroutine first_guess(p, low, high, p_high, x)
      real(wp), contiguous, intent(in) :: p(0:)
      real(wp), intent(in) :: low
      real(wp), intent(in) :: high
      real(wp), intent(out) :: p_high
      real(wp), intent(out) :: x
      !! strictly inside the bracket
      real(wp) :: p_low, slope, bend, ignored

      call state_at(p, high, p_high, ignored)
      call state_at(p, low, p_low, slope)
      slope = slope*(high - low)
      bend = p_high - p_low - slope
      ! The root of the parabola next to that of the secant, without cancellation.
      bend = sqrt(max(0.0_wp, slope**2 - 4*bend*p_low))
      x = 2*p_low/(sign(bend, p_low) - slope)
      if (.not. (x > 0 .and. x < 1)) x = 0.5_wp
      x = low + x*(high - low)
   end subroutine first_guess

end module rwmf_spectrum_fast_taylor_oscillator
