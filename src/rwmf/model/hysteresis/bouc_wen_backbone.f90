!> Where Bouc and Wen's hysteresis stands after its first loading, from nothing to a displacement.
!>
!> While u grows for the first time z' = u'/u_y (1 - z**n), so that x = u/u_y is the integral of
!> 1/(1 - z**n). With z = 1 - exp(-w) it is that of h(w) = exp(-w)/(1 - (1 - exp(-w))**n), which is
!> bounded, 1/n <= h <= 1, and smooth but for w = 0: tanh-sinh quadrature gives all digits.
module rwmf_model_hysteresis_bouc_wen_backbone
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   implicit none
   private

   public :: virgin_displacement

contains

   !> z after the first loading to x = u/u_y [-].
   pure real(wp) function virgin_displacement(x, n) result(z)
      real(wp), intent(in) :: x
      !! [-]
      real(wp), intent(in) :: n
      !! exponent, >= 1 [-]
      integer, parameter :: most = 100
      type(bracket_t) :: bracket
      real(wp) :: w
      real(wp) :: excess
      integer :: i

      ! a w beyond 2 - log(epsilon) leaves nothing of 1 - z
      bracket = bracket_between(abs(x), min(n*abs(x), 2 - log(epsilon(x))))
      w = min(bracket%low, bracket%high)
      do i = 1, most
         if (w <= 0 .or. bracket%high <= bracket%low) exit
         excess = distance(w, n) - abs(x)
         call narrow(bracket, excess > 0, w)
         if (abs(excess) <= 2*epsilon(x)*abs(x)) exit
         w = keep_inside(bracket, w - excess/integrand(w, n))
      end do
      ! 1 - exp(-w) without loss of digits
      z = sign(2*sinh(w/2)*exp(-w/2), x)
   end function virgin_displacement

   !> Integral of h from 0 to w [-].
   pure real(wp) function distance(w, n)
      real(wp), intent(in) :: w
      !! > 0 [-]
      real(wp), intent(in) :: n
      real(wp), parameter :: step = 1.0_wp/64
      integer, parameter :: points = 300
      !! on either side; beyond them the weights are below round-off
      real(wp) :: t
      real(wp) :: part
      !! of the way to w [-]
      real(wp) :: weight
      integer :: i

      distance = 0
      do i = -points, points
         t = i*step
         part = 1/(1 + exp(-pi*sinh(t)))
         weight = pi*cosh(t)*part*(1/(1 + exp(pi*sinh(t))))
         distance = distance + weight*integrand(w*part, n)
      end do
      distance = w*step*distance
   end function distance

   !> h(w) [-]; logarithm and power of numbers close to 1 keep their digits.
   pure real(wp) function integrand(w, n) result(h)
      real(wp), intent(in) :: w
      !! >= 0 [-]
      real(wp), intent(in) :: n
      real(wp) :: rest
      !! 1 - z
      real(wp) :: power
      !! log(z**n)

      rest = exp(-w)
      h = rest
      if (1 - rest <= epsilon(w)**2) return
      power = -2*n*atanh(rest/(2 - rest))
      if (power > log(tiny(w))) h = -rest/(2*sinh(power/2)*exp(power/2))
   end function integrand

end module rwmf_model_hysteresis_bouc_wen_backbone
