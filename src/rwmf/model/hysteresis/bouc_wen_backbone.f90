!> State of Bouc and Wen's hysteresis after slow loading from rest to a displacement, or after slow
!> unloading from a state to zero force.
!>
!> With x = u/u_y, and z >= 0 measured from its zero, dx = dz/(1 - c z**n). c = 1 while |z| grows
!> and 1 - 2 beta <= 0 while it decreases. With z = 1 - exp(-w) the change of x is the integral of
!> h(w) = exp(-w)/(1 - c (1 - exp(-w))**n). h is bounded, for c = 1 by 1/n <= h <= 1, and smooth
!> except at w = 0. Tanh-sinh quadrature is therefore accurate to round-off. Above some w, z is 1
!> to round-off; h is then 1/n, or zero while |z| decreases.
module rwmf_model_hysteresis_bouc_wen_backbone
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_gauss, only: gauss_node
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   implicit none
   private

   public :: virgin_displacement, unloaded_displacement, follow_state, state_slope

   real(wp), parameter :: growing = 1
   !! c while |z| grows [-]
   integer, parameter :: points = 16
   !! of Gauss's rule in a panel

contains

   !> z after the first loading to x = u/u_y [-].
   pure real(wp) function virgin_displacement(x, n) result(z)
      real(wp), intent(in) :: x
      !! displacement over u_y [-]
      real(wp), intent(in) :: n
      !! exponent, >= 1 [-]
      real(wp) :: w

      w = position_of(abs(x), 1.0_wp, n, growing, n*abs(x))
      z = sign(state_of(w), x)
   end function virgin_displacement

   !> x = u/u_y of zero force a x + (1 - a) z after slow unloading [-].
   pure elemental real(wp) function unloaded_displacement(x, z, a, beta, n) result(rest)
      real(wp), intent(in) :: x
      !! x at the beginning of unloading [-]
      real(wp), intent(in) :: z
      !! z at the beginning of unloading [-]
      real(wp), intent(in) :: a
      !! hardening ratio [-]
      real(wp), intent(in) :: beta
      !! shape factor while |z| decreases, >= 0.5 [-]
      real(wp), intent(in) :: n
      !! exponent, >= 1 [-]
      real(wp) :: w, direction, x_0, c
      logical :: falls

      rest = x
      if (abs(a*x + (1 - a)*z) <= 0) return
      direction = -sign(1.0_wp, a*x + (1 - a)*z)
      w = min(2*atanh(min(1.0_wp, abs(z))/(2 - min(1.0_wp, abs(z)))), largest())
      falls = direction*z < 0
      c = merge(1 - 2*beta, growing, falls)
      ! x at which z is zero on the first branch of the unloading
      x_0 = x + merge(direction, -direction, falls)*distance(w, n, c)
      if (falls .and. direction*x_0 < 0) then
         falls = .false.
         c = growing
      end if
      if (.not. falls) w = n*abs(x_0)
      w = position_of(a*abs(x_0), a, n, c, w)
      rest = x_0 + merge(-direction, direction, falls)*distance(w, n, c)
   end function unloaded_displacement

   !> The w at which a x + (1 - a) z, measured from z = 0, reaches a level.
   pure real(wp) function position_of(level, a, n, c, w_max) result(w)
      real(wp), intent(in) :: level
      !! >= 0 [-]
      real(wp), intent(in) :: a
      !! hardening ratio, from 0 to 1 [-]
      real(wp), intent(in) :: n
      real(wp), intent(in) :: c
      real(wp), intent(in) :: w_max
      !! upper bound of the result
      integer, parameter :: most = 100
      type(bracket_t) :: bracket
      real(wp) :: excess
      integer :: i

      bracket = bracket_between(level, w_max)
      w = min(bracket%low, bracket%high)
      do i = 1, most
         if (w <= 0 .or. bracket%high <= bracket%low) exit
         excess = a*distance(w, n, c) + (1 - a)*state_of(w) - level
         call narrow(bracket, excess > 0, w)
         if (abs(excess) <= 2*epsilon(level)*level) exit
         w = keep_inside(bracket, w - excess/(a*integrand(min(w, largest()), n, c) &
            + (1 - a)*exp(-w)))
      end do
   end function position_of

   !> z = 1 - exp(-w), accurate to round-off [-].
   pure real(wp) function state_of(w) result(z)
      real(wp), intent(in) :: w
      !! >= 0 [-]

      associate (part => min(w, largest())/2)
         z = 2*sinh(part)*exp(-part)
      end associate
   end function state_of

   !> The w above which 1 - z is below round-off.
   pure real(wp) function largest()

      largest = 2 - log(epsilon(1.0_wp))
   end function largest

   !> Integral of h from 0 to w [-].
   pure real(wp) function distance(w, n, c)
      real(wp), intent(in) :: w
      !! >= 0 [-]
      real(wp), intent(in) :: n
      real(wp), intent(in) :: c
      real(wp), parameter :: step = 1.0_wp/64
      integer, parameter :: nodes = 300
      !! number of points on either side; beyond them the weights are below round-off
      real(wp) :: curved
      !! range of w over which h varies
      real(wp) :: t
      real(wp) :: part
      !! fraction of this range [-]
      real(wp) :: weight
      integer :: i

      curved = min(w, largest())
      distance = 0
      do i = -nodes, nodes
         t = i*step
         part = 1/(1 + exp(-pi*sinh(t)))
         weight = pi*cosh(t)*part*(1/(1 + exp(pi*sinh(t))))
         distance = distance + weight*integrand(curved*part, n, c)
      end do
      distance = curved*step*distance
      if (c >= growing) distance = distance + (w - curved)/n
   end function distance

   !> h(w) [-], with logarithms and powers of numbers close to 1 accurate to round-off.
   pure real(wp) function integrand(w, n, c) result(h)
      real(wp), intent(in) :: w
      !! >= 0 [-]
      real(wp), intent(in) :: n
      real(wp), intent(in) :: c
      real(wp) :: rest
      !! 1 - z
      real(wp) :: power
      !! log(z**n)

      rest = exp(-w)
      h = rest
      if (1 - rest <= epsilon(w)**2) return
      power = -2*n*atanh(rest/(2 - rest))
      if (power > log(tiny(w))) h = rest/((1 - c)*exp(power) - 2*sinh(power/2)*exp(power/2))
   end function integrand

   !> Follow z along a slow, monotone change of x = u/u_y.
   pure subroutine follow_state(x, beta, n, z, spent)
      real(wp), intent(in) :: x
      !! change of the displacement over u_y [-]
      real(wp), intent(in) :: beta
      !! shape factor while |z| decreases [-]
      real(wp), intent(in) :: n
      !! exponent, >= 1 [-]
      real(wp), intent(inout) :: z
      !! hysteretic state before and after the change [-]
      real(wp), intent(out) :: spent
      !! energy dissipated, over u_y and the force at z = 1 [-]
      real(wp) :: left, w, whole, part, rule(2, points)
      integer :: j

      spent = 0
      left = abs(x)
      if (left <= 0) return
      do j = 1, points
         call gauss_node(points, j, rule(1, j), rule(2, j))
      end do
      w = min(2*atanh(min(1.0_wp, abs(z))/(2 - min(1.0_wp, abs(z)))), largest())
      if (x*z < 0) then
         call integrate_piece(rule, 0.0_wp, w, n, 1 - 2*beta, whole, spent)
         if (left < whole) then
            call find_end(rule, w, -left, n, 1 - 2*beta, part, spent)
            z = sign(state_of(part), z)
            return
         end if
         left = left - whole
         w = 0
      end if
      call find_end(rule, w, left, n, growing, part, whole)
      spent = spent + whole
      z = sign(state_of(part), x)
   end subroutine follow_state

   !> Slope dz/dx, x = u/u_y, in a direction of the motion [-].
   pure real(wp) function state_slope(direction, beta, n, z) result(slope)
      real(wp), intent(in) :: direction
      !! any number with the sign of the change of x [-]
      real(wp), intent(in) :: beta
      !! shape factor while |z| decreases [-]
      real(wp), intent(in) :: n
      !! exponent, >= 1 [-]
      real(wp), intent(in) :: z
      !! hysteretic state [-]

      slope = 1 - merge(1 - 2*beta, growing, direction*z < 0)*min(1.0_wp, abs(z))**n
   end function state_slope

   !> Find the w at a distance from another one, by Newton's method inside a bracket.
   pure subroutine find_end(rule, from, x, n, c, w, spent)
      real(wp), intent(in) :: rule(2, points)
      !! nodes and weights
      real(wp), intent(in) :: from
      !! w at the beginning
      real(wp), intent(in) :: x
      !! change of x, negative towards smaller w [-]
      real(wp), intent(in) :: n
      real(wp), intent(in) :: c
      real(wp), intent(out) :: w
      !! w at the end
      real(wp), intent(out) :: spent
      !! dissipated energy [-]
      integer, parameter :: most = 60
      type(bracket_t) :: bracket
      real(wp) :: passed
      integer :: i

      bracket = bracket_between(merge(from, 0.0_wp, x > 0), max(from, from + n*x))
      w = keep_inside(bracket, from + x/max(integrand(from, n, c), 1/n))
      do i = 1, most
         call integrate_piece(rule, from, w, n, c, passed, spent)
         if (abs(passed - x) <= 4*epsilon(x)*max(abs(x), epsilon(x))) exit
         if (bracket%high <= bracket%low) exit
         call narrow(bracket, passed > x, w)
         w = keep_inside(bracket, w - (passed - x)/integrand(w, n, c))
      end do
   end subroutine find_end

   !> Integrate h, and the energy dissipated, over a piece of w by Gauss's rule.
   pure subroutine integrate_piece(rule, w_begin, w_end, n, c, x, spent)
      real(wp), intent(in) :: rule(2, points)
      !! nodes and weights
      real(wp), intent(in) :: w_begin, w_end
      real(wp), intent(in) :: n
      real(wp), intent(in) :: c
      real(wp), intent(out) :: x
      !! integral of h [-]
      real(wp), intent(out) :: spent
      !! integral of z |h - dz/dw| [-]
      real(wp), parameter :: longest = 1.0_wp, shortest = 1.0e-3_wp
      !! panels grow from the end at w = 0, where |z|**n is not smooth
      real(wp) :: low, high, weight, w, h
      integer :: j

      x = 0
      spent = 0
      low = min(w_begin, w_end)
      do while (low < max(w_begin, w_end))
         high = min(low + min(max(low, shortest), longest), max(w_begin, w_end))
         do j = 1, points
            w = low + (high - low)*(1 + rule(1, j))/2
            h = integrand(w, n, c)
            weight = rule(2, j)*(high - low)/2
            x = x + weight*h
            spent = spent + weight*state_of(w)*abs(h - exp(-w))
         end do
         low = high
      end do
      x = sign(x, w_end - w_begin)
   end subroutine integrate_piece

end module rwmf_model_hysteresis_bouc_wen_backbone
