!> Cubic polynomials on [0, 1], for the motion within a step of a host program.
module rwmf_math_cubic
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   implicit none
   private

   public :: cubic_between, value_at, monotone_pieces, falling_root

contains

   !> Coefficients of the cubic through values and rates at both ends of a step, over its length.
   pure function cubic_between(dt, value_0, rate_0, value_1, rate_1) result(p)
      real(wp), intent(in) :: dt
      !! length of the step [s]
      real(wp), intent(in) :: value_0, rate_0
      !! value at the beginning in any unit, and its derivative by time in that unit over s
      real(wp), intent(in) :: value_1, rate_1
      !! the same at the end, in the same units
      real(wp) :: p(0:3)

      p = [value_0, dt*rate_0, 3*(value_1 - value_0) - dt*(2*rate_0 + rate_1), &
         2*(value_0 - value_1) + dt*(rate_0 + rate_1)]
   end function cubic_between

   !> Value of a cubic.
   pure real(wp) function value_at(p, x)
      real(wp), intent(in) :: p(0:)
      !! (0:3) coefficients, in any unit
      real(wp), intent(in) :: x
      !! place over the length of the step [-]

      value_at = p(0) + x*(p(1) + x*(p(2) + x*p(3)))
   end function value_at

   !> Ends of the monotone pieces of a cubic on [0, 1]; a piece may be empty.
   pure function monotone_pieces(p) result(ends)
      real(wp), intent(in) :: p(0:)
      !! (0:3) coefficients, in any unit
      real(wp) :: ends(0:3)
      real(wp) :: discriminant
      real(wp) :: q
      real(wp) :: x(2)

      ends = [0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
      discriminant = p(2)**2 - 3*p(3)*p(1)
      if (discriminant <= 0) return
      ! this form avoids cancellation and retains the one root of a parabola
      q = -(p(2) + sign(sqrt(discriminant), p(2)))
      x = 0
      if (abs(q) > abs(p(1))) x(1) = p(1)/q
      if (abs(q) < abs(3*p(3))) x(2) = q/(3*p(3))
      x = max(0.0_wp, min(1.0_wp, x))
      ends(1) = minval(x)
      ends(2) = maxval(x)
   end function monotone_pieces

   !> Root of a falling piece, to the spacing of floating-point numbers.
   pure real(wp) function falling_root(p, begin, end) result(x)
      real(wp), intent(in) :: p(0:)
      !! (0:3) coefficients, in any unit
      real(wp), intent(in) :: begin
      !! begin of the piece over the length of the step [-]
      real(wp), intent(in) :: end
      !! its end [-]
      type(bracket_t) :: bracket

      bracket = bracket_between(begin, end)
      do while (bracket%is_open)
         call narrow(bracket, value_at(p, bracket%middle) < 0)
      end do
      x = bracket%high
   end function falling_root

end module rwmf_math_cubic
