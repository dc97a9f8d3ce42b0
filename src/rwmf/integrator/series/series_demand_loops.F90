!> Screens of the steps of lanes for larger demands, by the series of their terms.
!>
!> Each loop is written for one lane.
module rwmf_integrator_series_series_demand_loops
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_lanes, only: axial_terms, demand_terms, left, motion_terms, &
      of_constant, of_cosine, of_cosine_1, of_cosine_2, of_cosine_over, of_ground, &
      of_half_cosine, of_half_sine, of_inverse, of_phi, of_phi_cosine, of_phi_sine, of_rate, &
      of_sine, of_sine_1, of_sine_2, of_sine_over, of_upward, right, series_lanes_t, series_width
   use rwmf_model_lanes, only: lane_cosine => cosine, lane_sine => sine
   implicit none
   private

   public :: screen_demands

#ifndef SERIES_ORDER
#define SERIES_ORDER 8
#endif
   integer, parameter :: order = SERIES_ORDER
   !! of the series

contains

   !> Screen the steps for larger demands.
   pure subroutine screen_demands(lanes)
      type(series_lanes_t), intent(inout) :: lanes
      integer :: q

      ! the compiler makes a copy of each loop for each constant
      lanes%may_exceed = 0
      select case (lanes%terms)
      case (motion_terms)
         call expand_terms(motion_terms, lanes)
         do q = 1, size(lanes%level, 2)
            call screen_demand(motion_terms, q, lanes)
         end do
      case (axial_terms)
         call expand_terms(axial_terms, lanes)
         do q = 1, size(lanes%level, 2)
            call screen_demand(axial_terms, q, lanes)
         end do
      case default
         call expand_terms(demand_terms - 1, lanes)
         do q = 1, size(lanes%level, 2)
            call screen_demand(demand_terms - 1, q, lanes)
         end do
      end select
      lanes%some_demand = any(lanes%may_exceed > 0)
   end subroutine screen_demands

   !> Compute the series of the terms of the demands.
   pure subroutine expand_terms(terms, lanes)
      integer, intent(in), value :: terms
      !! number of terms
      type(series_lanes_t), intent(inout) :: lanes
      real(wp), dimension(0:order) :: p, s, c, hs, hc, l, q
      real(wp) :: h, x, y, z, rate, b, hb
      integer :: i, k, n

      !$omp simd private(p, s, c, hs, hc, l, q, h, x, y, z, rate, b, hb, k, n)
      do i = 1, series_width
         !GCC$ unroll 16
         do k = 0, order
            p(k) = lanes%p(i, k)
         end do
         x = lane_sine(0.5_wp*p(0))
         y = lane_cosine(0.5_wp*p(0))
         hs(0) = x
         hc(0) = y
         s(0) = 2*x*y
         ! the value 1 - cos(phi) stands apart
         z = 2*x*x
         c(0) = 1 - z
         !GCC$ unroll 16
         do n = 0, order - 1
            x = c(0)*((n + 1)*p(n + 1))
            y = s(0)*((n + 1)*p(n + 1))
            !GCC$ unroll 16
            do k = 1, n
               x = x + c(k)*((n + 1 - k)*p(n + 1 - k))
               y = y + s(k)*((n + 1 - k)*p(n + 1 - k))
            end do
            s(n + 1) = x*(1.0_wp/(n + 1))
            c(n + 1) = y*(-1.0_wp/(n + 1))
         end do
         h = lanes%h(i)
         rate = 1/h
         x = lanes%t(i) - lanes%ground(i, 3)
         lanes%base(i, 0, of_ground) = lanes%ground(i, 1) + lanes%ground(i, 2)*x
         lanes%base(i, 0, of_upward) = lanes%upward(i, 1) + lanes%upward(i, 2)*x
         lanes%base(i, 1, of_ground) = lanes%ground(i, 2)*h
         lanes%base(i, 1, of_upward) = lanes%upward(i, 2)*h
         y = h
         !GCC$ unroll 16
         do n = 2, order - 2
            y = y*h
            lanes%base(i, n, of_ground) = lanes%curve(i, n, 1)*y
            lanes%base(i, n, of_upward) = lanes%curve(i, n, 2)*y
         end do
         !GCC$ unroll 16
         do n = 0, order - 2
            lanes%base(i, n, of_sine_2) = ((n + 1)*(n + 2))*(rate*rate)*s(n + 2)
            lanes%base(i, n, of_cosine_2) = ((n + 1)*(n + 2))*(-rate*rate)*c(n + 2)
         end do
         if (terms <= motion_terms) cycle
         !GCC$ unroll 16
         do n = 0, order - 2
            lanes%base(i, n, of_sine_1) = (n + 1)*rate*s(n + 1)
            lanes%base(i, n, of_cosine_1) = (n + 1)*(-rate)*c(n + 1)
            lanes%base(i, n, of_sine) = s(n)
            lanes%base(i, n, of_phi) = p(n)
            lanes%base(i, n, of_cosine) = merge(z, -c(n), n == 0)
         end do
         !GCC$ unroll 16
         do n = 0, order - 2
            x = p(n)*s(0)
            y = p(n)*z
            !GCC$ unroll 16
            do k = 1, n
               x = x + p(n - k)*s(k)
               y = y - p(n - k)*c(k)
            end do
            lanes%base(i, n, of_phi_sine) = x
            lanes%base(i, n, of_phi_cosine) = y
         end do
         if (terms <= axial_terms) cycle
         ! the squared length of a straight tendon is (2h)**2 + 2 b**2 K + 4 h b S
         x = lanes%straight(i, 4, left, 1)
         b = lanes%straight(i, 4, right, 1)
         b = merge(b, x, lanes%side(i) > 0)
         hb = 2*lanes%straight(i, 3, left, 1)*b
         b = 2*b*b
         l(0) = sqrt(lanes%straight(i, 3, left, 1)**2 + b*z + hb*s(0))
         q(0) = 1/l(0)
         !GCC$ unroll 16
         do n = 0, order - 2
            x = 0
            y = 0
            !GCC$ unroll 16
            do k = 0, n
               x = x + hc(k)*((n + 1 - k)*p(n + 1 - k))
               y = y + hs(k)*((n + 1 - k)*p(n + 1 - k))
            end do
            hs(n + 1) = x*(0.5_wp/(n + 1))
            hc(n + 1) = y*(-0.5_wp/(n + 1))
            x = hb*s(n + 1) - b*c(n + 1)
            !GCC$ unroll 16
            do k = 1, n
               x = x - l(k)*l(n + 1 - k)
            end do
            l(n + 1) = 0.5_wp*x*q(0)
            x = 0
            !GCC$ unroll 16
            do k = 1, n + 1
               x = x - l(k)*q(n + 1 - k)
            end do
            q(n + 1) = x*q(0)
            lanes%base(i, n, of_rate) = (n + 1)*rate*p(n + 1)
            lanes%base(i, n, of_half_sine) = hs(n)
            lanes%base(i, n, of_half_cosine) = hc(n)
            lanes%base(i, n, of_inverse) = q(n)
            x = q(n)*s(0)
            y = q(n)*z
            !GCC$ unroll 16
            do k = 1, n
               x = x + q(n - k)*s(k)
               y = y - q(n - k)*c(k)
            end do
            lanes%base(i, n, of_sine_over) = x
            lanes%base(i, n, of_cosine_over) = y
         end do
      end do
   end subroutine expand_terms

   !> Screen the steps for a larger value of one demand.
   !>
   !> A function between its values at both ends of a step rises above them by at most an eighth of
   !> its second derivative. The last terms bound those that are omitted.
   pure subroutine screen_demand(terms, q, lanes)
      integer, intent(in), value :: terms
      !! number of terms with factors
      integer, intent(in) :: q
      !! number of the demand
      type(series_lanes_t), intent(inout) :: lanes
      real(wp) :: c(0:order - 2), x, y, f, bend, last, factor
      integer :: i, k, n

      !$omp simd private(c, x, y, f, bend, last, factor, k, n)
      do i = 1, series_width
         x = lanes%rows(i, of_constant, left, q)
         c(0) = lanes%rows(i, of_constant, right, q)
         c(0) = merge(c(0), x, lanes%side(i) > 0)
         !GCC$ unroll 16
         do k = 1, order - 2
            c(k) = 0
         end do
         !GCC$ unroll 16
         do n = 1, terms
            x = lanes%rows(i, n, left, q)
            factor = lanes%rows(i, n, right, q)
            factor = merge(factor, x, lanes%side(i) > 0)
            !GCC$ unroll 16
            do k = 0, order - 2
               c(k) = c(k) + factor*lanes%base(i, k, n)
            end do
         end do
         x = lanes%x_most(i)
         f = c(order - 2)
         bend = ((order - 2)*(order - 3))*abs(f)
         !GCC$ unroll 16
         do k = order - 3, 0, -1
            f = f*x + c(k)
            if (k > 1) bend = bend*x + (k*(k - 1))*abs(c(k))
         end do
         last = x**(order - 3)*(abs(c(order - 2))*x + abs(c(order - 3)))
         bend = 0.125_wp*bend*(x*x) + last
         y = bend + max(max(c(0), f), merge(max(-c(0), -f), c(0), lanes%two_sided(q) > 0))
         factor = merge(lanes%is_moving(i), 0.0_wp, y > lanes%level(i, q))
         lanes%exceeds(i, q) = factor
         lanes%may_exceed(i) = max(lanes%may_exceed(i), factor)
      end do
   end subroutine screen_demand

end module rwmf_integrator_series_series_demand_loops
