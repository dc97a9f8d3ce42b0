!> Steps of lanes by Taylor series: the series, their lengths, screens for events, impacts.
!>
!> Each loop is written for one lane. The unit is compiled once for each order, so that the compiler
!> unrolls the recurrences and keeps their coefficients in registers.
module rwmf_integrator_series_series_loops
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_series_series_demand_loops, only: screen_demands
   use rwmf_integrator_series_series_lanes, only: left, right, series_lanes_t, series_width
   use rwmf_model_lanes, only: lane_cosine => cosine, lane_sine => sine
   implicit none
   private

   public :: expand_lanes, screen_lanes, find_roots, end_steps

#ifndef SERIES_ORDER
#define SERIES_ORDER 8
#endif
   integer, parameter :: order = SERIES_ORDER
   !! of the series
   integer, parameter :: plain = 0, with_effects = 1, with_curves = 2, with_rises = 3, &
      with_second_cable = 4
   !! terms of the equation of motion

contains

   !> Compute the series of phi in the time over the length of the series.
   !>
   !> All kinematics are linear combinations of the series of sin(phi) and cos(phi). Their products
   !> with phi' give the rate and the acceleration of the displacement. The third product is that of
   !> the lever and the force at the link. Each round has one unknown, a coefficient of phi''. The
   !> moment `m` acts towards the base.
   pure subroutine expand_lanes(lanes)
      type(series_lanes_t), intent(inout) :: lanes

      ! the compiler makes a copy of the loop for each constant
      if (lanes%is_plain) then
         call expand(plain, lanes)
      else if (lanes%has_curves) then
         call expand(with_curves, lanes)
      else if (lanes%has_second_cable) then
         call expand(with_second_cable, lanes)
      else if (lanes%has_rises) then
         call expand(with_rises, lanes)
      else
         call expand(with_effects, lanes)
      end if
   end subroutine expand_lanes

   !> Compute the series, of plain scenes or with the terms of further effects.
   !>
   !> Terms of some scenes are zero in the others: arrays that are written under conditions would
   !> prevent vectorisation.
   pure subroutine expand(terms, lanes)
      integer, intent(in), value :: terms
      !! `plain`, `with_effects`, effects `with_curves` of the ground motion or `with_rises`, these
      !! `with_second_cable`
      type(series_lanes_t), intent(inout) :: lanes
      real(wp), dimension(0:order) :: p, v, sp, cp, sv, hc, stretch, arm, lever, force, &
         stretch_2, arm_2
      real(wp), dimension(0:order) :: curve, of_cosines, of_sines, s2, c2
      real(wp) :: h, rest, hh, side, ca, sw, sl, sr, x, y, z, push, ramp, damp, stiff, grav, &
         cable, slope, fuse, half, corner, mass, pull, tight, twin, b2, bh, a, b, d, u, w, m, &
         pull_2, tight_2, twin_2, b2_2, bh_2, inverse, j, jv, q, gamma, of_cosine, of_sine, excited
      real(wp) :: e, f, of_s2, of_c2, of_v, of_c2v, of_s2v
      integer :: i, k, n
      logical :: is_plain, has_curves, has_rises, has_fuses, has_inerter, is_straight, has_second

      is_plain = terms == plain
      has_curves = terms == with_curves
      has_rises = terms == with_rises .or. terms == with_second_cable
      has_fuses = lanes%has_fuses .and. .not. is_plain
      has_inerter = lanes%has_inerter .and. .not. is_plain
      is_straight = lanes%has_straight_cable .and. .not. is_plain
      has_second = is_straight .and. terms == with_second_cable
      !$omp simd private(p, v, sp, cp, sv, hc, stretch, arm, lever, force, h, rest, hh, side, ca) &
      !$omp& private(sw, sl, sr, x, y, z, push, ramp, damp, stiff, grav, cable, slope, fuse, half) &
      !$omp& private(corner, mass, pull, tight, twin, b2, bh, a, b, d, u, w, m, inverse, j, jv, q) &
      !$omp& private(gamma, of_cosine, of_sine, excited, curve, of_cosines, of_sines, s2, c2, e) &
      !$omp& private(f, of_s2, of_c2, of_v, of_c2v, of_s2v, k, n) &
      !$omp& private(stretch_2, arm_2, pull_2, tight_2, twin_2, b2_2, bh_2)
      do i = 1, series_width
         rest = lanes%limit(i) - lanes%t(i)
         h = lanes%length(i)
         h = merge(rest, h, rest <= h*1.000001_wp)
         lanes%h(i) = h
         hh = h*h
         side = lanes%side(i)
         ca = lanes%cosine(i)
         sw = lanes%sine_wall(i)
         x = lanes%sine_link(i, left)
         sl = lanes%sine_link(i, right)
         sl = merge(sl, x, side > 0)
         x = lanes%sine_lever(i, left)
         sr = lanes%sine_lever(i, right)
         sr = merge(sr, x, side > 0)
         x = lanes%cable(i, left)
         cable = lanes%cable(i, right)
         cable = hh*merge(cable, x, side > 0)
         x = lanes%cable_slope(i, left)
         slope = lanes%cable_slope(i, right)
         slope = hh*merge(slope, x, side > 0)
         gamma = lanes%mass(i)
         damp = lanes%damping(i)*h
         stiff = lanes%stiffness(i)*hh
         grav = lanes%gravity(i)*hh
         x = side*(lanes%inverse_radius(i)*hh)
         push = x*(lanes%ground(i, 1) + lanes%ground(i, 2)*(lanes%t(i) - lanes%ground(i, 3)))
         ramp = x*lanes%ground(i, 2)*h
         b2 = 0
         if (.not. is_plain) then
            x = lanes%inverse_radius(i)*hh
            grav = grav + x*(lanes%upward(i, 1) + lanes%upward(i, 2)*(lanes%t(i) &
               - lanes%ground(i, 3)))
            b2 = x*lanes%upward(i, 2)*h
         end if
         p(0) = lanes%phi(i)
         v(0) = h*lanes%rate(i)
         p(1) = v(0)
         x = lane_sine(0.5_wp*p(0))
         y = lane_cosine(0.5_wp*p(0))
         hc(0) = y
         sp(0) = 2*x*y
         x = 2*x*x
         cp(0) = 1 - x
         y = ca*sp(0)
         u = 2*(sl*x + y)
         m = (grav*(sw - (sw*x + y)) + ((ca - ca*x) + sw*sp(0))*push) + cable
         lever(0) = 2*((ca - ca*x) + sr*sp(0))
         j = 2*((ca - ca*x) + sl*sp(0))
         mass = lanes%inertia(i) + gamma*(lever(0)*j)
         of_cosine = grav*sw + push*ca
         of_sine = push*sw - grav*ca
         x = ramp*ca
         y = ramp*sw
         if (.not. is_plain) then
            x = x + b2*sw
            y = y - b2*ca
         end if
         if (has_curves) then
            z = hh*h*lanes%inverse_radius(i)
            !GCC$ unroll 16
            do k = 2, order
               z = z*h
               a = side*z*lanes%curve(i, k, 1)
               b = z*lanes%curve(i, k, 2)
               of_cosines(k) = a*ca + b*sw
               of_sines(k) = a*sw - b*ca
               curve(k) = lanes%excited(i)*a
            end do
         end if
         ca = 2*ca
         sl = 2*sl
         sr = 2*sr
         a = cp(0)*v(0)
         b = sp(0)*v(0)
         jv = j*v(0)
         corner = 0
         fuse = 0
         half = 0
         stretch(0) = 0
         arm(0) = 0
         pull = 0
         twin = 0
         tight = 0
         b2 = 0
         bh = 0
         stretch_2(0) = 0
         arm_2(0) = 0
         pull_2 = 0
         twin_2 = 0
         tight_2 = 0
         b2_2 = 0
         bh_2 = 0
         z = 0
         excited = 1
         if (.not. is_plain) then
            excited = lanes%excited(i)
            corner = lanes%damper(i)*h
         end if
         if (has_fuses) then
            d = lanes%fuse(i, left)
            fuse = lanes%fuse(i, right)
            fuse = hh*merge(fuse, d, side > 0)
            d = lanes%fuse_slope(i, left)
            z = lanes%fuse_slope(i, right)
            z = hh*merge(z, d, side > 0)
            half = 0.5_wp/hc(0)
            m = m + (fuse*hc(0) + z*sp(0))
            of_sine = of_sine + z
         end if
         if (has_inerter) mass = mass + lanes%inerter(i)*(1 + cp(0))
         if (is_straight) then
            bh = lanes%straight(i, 3, left, 1)
            b2 = lanes%straight(i, 4, left, 1)
            d = lanes%straight(i, 4, right, 1)
            b2 = merge(d, b2, side > 0)
            ! L**2 = z**2 + rise, and half its derivative is arm*L
            z = (1 - cp(0))*(2*b2)*b2 + (2*bh)*b2*sp(0)
            stretch(0) = sqrt(bh*bh + z)
            tight = 1/stretch(0)
            twin = 0.5_wp*tight
            d = hh*lanes%straight(i, 2, left, 1)
            pull = hh*lanes%straight(i, 1, left, 1)
            arm(0) = b2*(b2*sp(0) + bh*cp(0))*tight
            m = m + (pull + d*(z/(stretch(0) + bh)))*arm(0)
            pull = pull - bh*d
            bh = bh*b2
            b2 = b2*b2
            of_sine = of_sine + d*b2
            of_cosine = of_cosine + d*bh
         end if
         if (has_second) then
            bh_2 = lanes%straight(i, 3, left, 2)
            b2_2 = lanes%straight(i, 4, left, 2)
            d = lanes%straight(i, 4, right, 2)
            b2_2 = merge(d, b2_2, side > 0)
            z = (1 - cp(0))*(2*b2_2)*b2_2 + (2*bh_2)*b2_2*sp(0)
            stretch_2(0) = sqrt(bh_2*bh_2 + z)
            tight_2 = 1/stretch_2(0)
            twin_2 = 0.5_wp*tight_2
            d = hh*lanes%straight(i, 2, left, 2)
            pull_2 = hh*lanes%straight(i, 1, left, 2)
            arm_2(0) = b2_2*(b2_2*sp(0) + bh_2*cp(0))*tight_2
            m = m + (pull_2 + d*(z/(stretch_2(0) + bh_2)))*arm_2(0)
            pull_2 = pull_2 - bh_2*d
            bh_2 = bh_2*b2_2
            b2_2 = b2_2*b2_2
            of_sine = of_sine + d*b2_2
            of_cosine = of_cosine + d*bh_2
         end if
         e = 0
         f = 0
         s2(0) = 0
         c2(0) = 0
         of_s2 = 0
         of_c2 = 0
         of_v = 0
         of_c2v = 0
         of_s2v = 0
         if (has_rises) then
            s2(0) = 2*sp(0)*cp(0)
            c2(0) = 1 - 2*sp(0)*sp(0)
            e = c2(0)*v(0)
            f = s2(0)*v(0)
            z = hh*merge(lanes%rise(i, 1, right), lanes%rise(i, 1, left), side > 0)
            of_cosine = of_cosine + z
            m = m + z*cp(0)
            z = hh*merge(lanes%rise(i, 2, right), lanes%rise(i, 2, left), side > 0)
            of_sine = of_sine + z
            of_s2 = hh*merge(lanes%rise(i, 3, right), lanes%rise(i, 3, left), side > 0)
            of_c2 = hh*merge(lanes%rise(i, 4, right), lanes%rise(i, 4, left), side > 0)
            of_v = h*merge(lanes%rise(i, 5, right), lanes%rise(i, 5, left), side > 0)
            of_c2v = h*merge(lanes%rise(i, 6, right), lanes%rise(i, 6, left), side > 0)
            of_s2v = h*merge(lanes%rise(i, 7, right), lanes%rise(i, 7, left), side > 0)
            m = m + (z*sp(0) + (of_s2*s2(0) + of_c2*c2(0)))
         end if
         inverse = -1/mass
         w = excited*push + hh*side*lanes%offset(i)
         ramp = excited*ramp
         !GCC$ unroll 16
         do n = 0, order - 2
            sp(n + 1) = a*(1.0_wp/(n + 1))
            cp(n + 1) = b*(-1.0_wp/(n + 1))
            if (n > 0) then
               lever(n) = ca*cp(n) + sr*sp(n)
               m = (of_cosine*cp(n) + of_sine*sp(n)) + d
               w = merge(ramp, 0.0_wp, n == 1)
               if (has_curves .and. n > 1) then
                  w = curve(n)
                  !GCC$ unroll 16
                  do k = 2, n
                     m = m + (of_cosines(k)*cp(n - k) + of_sines(k)*sp(n - k))
                  end do
               end if
               if (has_rises) m = m + (of_s2*s2(n) + of_c2*c2(n))
               if (has_fuses) m = m + fuse*hc(n)
               if (is_straight) m = m + pull*arm(n)
               if (has_second) m = m + pull_2*arm_2(n)
            end if
            ! cos(phi/2) is the root of (1 + cos(phi))/2
            z = 0
            if (has_fuses) then
               z = 0.5_wp*cp(n + 1)
               !GCC$ unroll 16
               do k = 1, n
                  z = z - hc(k)*hc(n + 1 - k)
               end do
               z = z*half
            end if
            hc(n + 1) = z
            z = 0
            if (is_straight) then
               z = 2*(bh*sp(n + 1) - b2*cp(n + 1))
               !GCC$ unroll 16
               do k = 1, n
                  z = z - stretch(k)*stretch(n + 1 - k)
               end do
               z = z*twin
            end if
            stretch(n + 1) = z
            z = 0
            if (is_straight) then
               z = b2*sp(n + 1) + bh*cp(n + 1)
               !GCC$ unroll 16
               do k = 1, n + 1
                  z = z - stretch(k)*arm(n + 1 - k)
               end do
               z = z*tight
            end if
            arm(n + 1) = z
            z = 0
            if (has_second) then
               z = 2*(bh_2*sp(n + 1) - b2_2*cp(n + 1))
               !GCC$ unroll 16
               do k = 1, n
                  z = z - stretch_2(k)*stretch_2(n + 1 - k)
               end do
               z = z*twin_2
            end if
            stretch_2(n + 1) = z
            z = 0
            if (has_second) then
               z = b2_2*sp(n + 1) + bh_2*cp(n + 1)
               !GCC$ unroll 16
               do k = 1, n + 1
                  z = z - stretch_2(k)*arm_2(n + 1 - k)
               end do
               z = z*tight_2
            end if
            arm_2(n + 1) = z
            sv(n) = b
            if (.not. is_plain) m = m + corner*(v(n) + a)
            if (has_rises) then
               m = m + (of_v*v(n) + (of_c2v*e - of_s2v*f))
               s2(n + 1) = e*(2.0_wp/(n + 1))
               c2(n + 1) = f*(-2.0_wp/(n + 1))
               e = c2(1)*v(n)
               f = s2(1)*v(n)
               !GCC$ unroll 16
               do k = 2, n + 1
                  e = e + c2(k)*v(n + 1 - k)
                  f = f + s2(k)*v(n + 1 - k)
               end do
            end if
            d = x*cp(n) + y*sp(n)
            m = m + slope*p(n)
            w = w + (damp*jv + stiff*u)
            u = jv*(1.0_wp/(n + 1))
            a = cp(1)*v(n)
            b = sp(1)*v(n)
            !GCC$ unroll 16
            do k = 2, n + 1
               a = a + cp(k)*v(n + 1 - k)
               b = b + sp(k)*v(n + 1 - k)
            end do
            if (has_inerter) then
               ! the inertia force is the rate of (1 + cos(phi)) phi' with sin(phi) phi'**2/2
               z = 0
               !GCC$ unroll 16
               do k = 0, n
                  z = z + sv(k)*v(n - k)
               end do
               m = m + lanes%inerter(i)*((n + 1)*a + 0.5_wp*z)
            end if
            jv = ca*a + sl*b
            w = w + (n + 1)*jv
            z = lever(0)*w
            !GCC$ unroll 16
            do k = 1, n
               z = z + lever(k)*force(n - k)
            end do
            q = (m + gamma*z)*inverse
            force(n) = w + j*q
            v(n + 1) = q*(1.0_wp/(n + 1))
            p(n + 2) = q*(1.0_wp/((n + 1)*(n + 2)))
            a = a + cp(0)*v(n + 1)
            b = b + sp(0)*v(n + 1)
            if (has_rises) then
               e = e + c2(0)*v(n + 1)
               f = f + s2(0)*v(n + 1)
            end if
            jv = jv + j*v(n + 1)
         end do
         !GCC$ unroll 16
         do n = 0, order
            lanes%p(i, n) = p(n)
         end do
      end do
   end subroutine expand

   !> Choose the length of each step from its last terms, and screen it for events.
   !>
   !> Each screen is a proof for the polynomial. The first one bounds the cubic part by its
   !> Bernstein coefficients and the other terms by their sum. The others use a velocity or an
   !> acceleration without a sign change. A known root at the start is divided out.
   pure subroutine screen_lanes(lanes)
      type(series_lanes_t), intent(inout) :: lanes

      if (lanes%has_branches) then
         call screen(.true., lanes)
      else
         call screen(.false., lanes)
      end if
      lanes%some_speed = .false.
      if (lanes%seeks_speed) call screen_speeds(lanes)
      if (allocated(lanes%rows)) call screen_demands(lanes)
   end subroutine screen_lanes

   !> Screen the steps for a larger velocity, by the Bernstein coefficients of its quadratic part.
   pure subroutine screen_speeds(lanes)
      type(series_lanes_t), intent(inout) :: lanes
      real(wp) :: p(0:order), x, speed, before, some
      integer :: i, k

      some = 0
      !$omp simd private(p, x, speed, before, k) reduction(+:some)
      do i = 1, series_width
         x = lanes%x_most(i)
         !GCC$ unroll 16
         do k = 1, order
            p(k) = lanes%p(i, k)
         end do
         speed = 0
         !GCC$ unroll 16
         do k = order, 4, -1
            speed = (speed + k*abs(p(k)))*x
         end do
         speed = speed*(x*x) + max(abs(p(1)), max(abs(p(1) + p(2)*x), &
            abs(p(1) + 2*p(2)*x + 3*p(3)*(x*x))))
         before = lanes%h(i)*max(lanes%top_speed(i), lanes%fastest(i))
         speed = merge(lanes%is_moving(i), 0.0_wp, speed > before)
         lanes%may_race(i) = speed
         some = some + speed
      end do
      lanes%some_speed = some > 0
   end subroutine screen_speeds

   !> Screen the steps with or without ends of branches.
   pure subroutine screen(has_branches, lanes)
      logical, intent(in), value :: has_branches
      type(series_lanes_t), intent(inout) :: lanes
      real(wp), parameter :: third = 1.0_wp/3
      real(wp) :: p(0:order), x, last, size, tol, f, d, x2, x3, tail4, tail5, tail7, slope, bend, &
         root, q0, q1, q2, q3, least, most, rises, falls, up, down, low, one, top, moving, lower, &
         upper, above, turn, keeps
      real(wp) :: roots, opens, peaks, shorts
      integer :: i, k

      roots = 0
      opens = 0
      peaks = 0
      shorts = 0
      !$omp simd private(p, x, last, size, tol, f, d, x2, x3, tail4, tail5, tail7, slope, bend) &
      !$omp& private(root, q0, q1, q2, q3, least, most, rises, falls, up, down, low, one, top, k) &
      !$omp& private(moving, lower, upper, above, turn, keeps) &
      !$omp& reduction(+:roots, opens, peaks, shorts)
      do i = 1, series_width
         !GCC$ unroll 16
         do k = 0, order
            p(k) = lanes%p(i, k)
         end do
         q0 = lanes%top(i, left)
         top = lanes%top(i, right)
         size = lanes%rtol(i)*max(q0, top) + lanes%least_size(i)
         top = merge(top, q0, lanes%side(i) > 0)
         tol = lanes%allowance(i)*size*min(1.0_wp, lanes%frequency(i)*lanes%h(i))
         last = max(abs(p(order)), 0.1_wp*abs(p(order - 1)))
         x = merge(0.7_wp, 1.0_wp, last > tol)
         x = merge(0.5_wp, x, last*0.7_wp**(order - 1) > tol)
         x = merge(0.35_wp, x, last*0.5_wp**(order - 1) > tol)
         x = merge(0.25_wp, x, last*0.35_wp**(order - 1) > tol)
         x = merge(0.125_wp, x, last*0.25_wp**(order - 1) > tol)
         moving = merge(lanes%is_busy(i), 0.0_wp, last*0.125_wp**(order - 1) <= tol)
         lanes%is_moving(i) = moving
         f = p(order)
         d = 0
         !GCC$ unroll 16
         do k = order - 1, 0, -1
            d = d*x + f
            f = f*x + p(k)
         end do
         x2 = x*x
         x3 = x2*x
         tail7 = 0
         bend = 0
         !GCC$ unroll 16
         do k = 4, order
            if (k == 7) tail7 = 0
            tail7 = tail7 + abs(p(k))
            bend = bend + (k*(k - 1))*abs(p(k))
         end do
         tail5 = tail7 + (abs(p(5)) + abs(p(6)))
         tail4 = tail5 + abs(p(4))
         ! k/(k (k - 1)) is at most a third
         slope = third*bend*x3
         bend = bend*x2
         ! values above the lower end
         root = lanes%multiplicity(i)
         lower = 0
         if (has_branches) lower = lanes%lower(i)
         low = p(0) - lower
         q0 = merge(p(3), merge(p(1), low, root > 0.5_wp), root > 1.5_wp)
         q1 = merge(p(4), merge(p(2), p(1), root > 0.5_wp), root > 1.5_wp)*x
         q2 = merge(p(5), merge(p(3), p(2), root > 0.5_wp), root > 1.5_wp)*x2
         q3 = merge(p(6), merge(p(4), p(3), root > 0.5_wp), root > 1.5_wp)*x3
         last = merge(tail7, merge(tail5, tail4, root > 0.5_wp), root > 1.5_wp)
         q3 = q0 + q1 + q2 + q3
         q2 = q0 + third*(2*q1 + q2)
         q1 = q0 + third*q1
         least = min(min(q0, q1), min(q2, q3)) - last*(x2*x2)
         ! below a lift-off at once, the motion begins with phi''
         least = merge(min(least, p(2) + tiny(x)), least, root > 1.5_wp)
         ! largest phi
         q1 = p(0) + third*p(1)*x
         q2 = p(0) + third*(2*p(1)*x + p(2)*x2)
         q3 = p(0) + (p(1)*x + p(2)*x2 + p(3)*x3)
         most = max(max(p(0), q1), max(q2, q3)) + tail4*(x2*x2)
         ! phi' and phi'' without a sign change
         q1 = p(1) + p(2)*x
         q2 = p(1) + 2*p(2)*x + 3*p(3)*x2
         rises = min(p(1), min(q1, q2)) - slope
         falls = -max(p(1), max(q1, q2)) - slope
         q1 = 2*p(2)
         q2 = 2*p(2) + 6*p(3)*x
         up = min(q1, q2) - bend
         down = -max(q1, q2) - bend
         ! the upper end
         q0 = lanes%upper(i, left)
         upper = lanes%upper(i, right)
         upper = merge(upper, q0, lanes%side(i) > 0)
         q0 = (upper - p(0)) + tiny(x)
         keeps = merge(1.0_wp, 0.0_wp, most < upper)
         keeps = merge(1.0_wp, keeps, min(falls, q0) > 0)
         if (has_branches) then
            above = lanes%above(i)
            keeps = merge(1.0_wp, keeps, min(up, min(upper - f, q0)) > 0)
            keeps = merge(1.0_wp, keeps, min(down, min(above, tiny(x) - p(1))) > 0)
            ! a turn that ends a branch
            turn = lanes%turn(i)
            q0 = merge(1.0_wp, 0.0_wp, min(up, min(turn, p(1) + tiny(x))) > 0)
            q0 = merge(1.0_wp, q0, min(down, min(-turn, tiny(x) - p(1))) > 0)
            q0 = merge(1.0_wp, q0, max(min(rises, turn), min(falls, -turn)) > 0)
            q0 = merge(1.0_wp, q0, min(max(up, down), min(turn*p(1), turn*d)) > 0)
            keeps = keeps*merge(q0, 1.0_wp, abs(turn) > 0)
         end if
         ! calm: phi stays above the lower end
         q0 = merge(1.0_wp, 0.0_wp, least > 0)
         q0 = merge(1.0_wp, q0, min(rises, low + tiny(x)) > 0)
         q0 = merge(1.0_wp, q0, min(down, f - lower) > 0)
         q0 = merge(1.0_wp, q0, min(up, min(root, p(1) + tiny(x))) > 0)
         ! one simple root
         one = merge(1.0_wp, 0.0_wp, max(max(down, falls), min(up, 0.5_wp - root)) > 0)
         one = merge(one, 0.0_wp, f < lower)
         one = merge(one, 0.0_wp, max(low, min(root, p(1))) > 0)
         low = q0*(1 - one)
         lanes%has_root(i) = moving*one*keeps
         lanes%is_open(i) = moving*(1 - keeps*max(one, low))
         tol = merge(top, max(top, f), lanes%is_open(i) > 0)
         tol = merge(1.0_wp, 0.0_wp, most > tol)
         tol = merge(0.0_wp, tol, max(max(rises, falls), up) > 0)
         tol = merge(0.0_wp, tol, min(down, d) > 0)
         tol = moving*tol
         lanes%may_peak(i) = tol
         peaks = peaks + tol
         roots = roots + lanes%has_root(i)
         opens = opens + lanes%is_open(i)
         shorts = shorts + (lanes%is_busy(i) - moving)
         lanes%x(i) = x
         lanes%x_most(i) = x
         lanes%phi_end(i) = f
         lanes%rate_end(i) = d
      end do
      lanes%some_root = roots > 0
      lanes%some_open = opens > 0
      lanes%some_peak = peaks > 0
      lanes%some_short = shorts > 0
   end subroutine screen

   !> Find the single roots of phi - lower by Newton's method, from the root of the parabola at the
   !> start.
   pure subroutine find_roots(lanes)
      type(series_lanes_t), intent(inout) :: lanes
      real(wp), parameter :: precision = 1.0e-11_wp
      !! error of a root over its position; errors of many small flights add up [-]
      integer, parameter :: most = 8
      real(wp) :: z(series_width), is_left(series_width), f, d, x, root, left_over
      integer :: i, k, round

      !$omp simd private(f, d, x, root)
      do i = 1, series_width
         f = lanes%p(i, 0) - lanes%lower(i)
         d = lanes%p(i, 1)
         x = lanes%p(i, 2)
         root = sqrt(max(d*d - 4*x*f, 0.0_wp))
         z(i) = merge((d + root)/(-2*x), 2*f/(root - d), d > 0)
         z(i) = merge(z(i), lanes%x(i), x < 0)
         z(i) = merge(z(i), lanes%x(i), min(z(i), lanes%x(i) - z(i)) > 0)
         is_left(i) = lanes%has_root(i)
      end do
      do round = 1, most
         left_over = 0
         !$omp simd private(f, d, x, root, k) reduction(+:left_over)
         do i = 1, series_width
            x = z(i)
            f = lanes%p(i, order)
            d = 0
            !GCC$ unroll 16
            do k = order - 1, 0, -1
               d = d*x + f
               f = f*x + lanes%p(i, k)
            end do
            f = f - lanes%lower(i)
            lanes%x(i) = merge(x, lanes%x(i), is_left(i) > 0)
            lanes%rate_end(i) = merge(d, lanes%rate_end(i), is_left(i) > 0)
            root = x - f/d
            root = merge(root, 0.5_wp*x, root > 0)
            root = merge(root, 0.5_wp*(x + lanes%x_most(i)), d < 0)
            z(i) = min(root, lanes%x_most(i))
            is_left(i) = merge(is_left(i), 0.0_wp, max(d, abs(f) + precision*(d*x)) >= 0)
            left_over = left_over + is_left(i)
         end do
         if (.not. left_over > 0) exit
      end do
      !$omp simd private(f, x)
      do i = 1, series_width
         x = lanes%lower(i)
         f = lanes%phi_end(i)
         lanes%phi_end(i) = merge(x, f, lanes%has_root(i) > 0)
         lanes%has_root(i) = lanes%has_root(i) - is_left(i)
         lanes%is_open(i) = max(lanes%is_open(i), is_left(i))
      end do
      lanes%some_open = lanes%some_open .or. left_over > 0
   end subroutine find_roots

   !> Move all lanes to the ends of their steps, and apply impacts after which the wall rocks on.
   pure subroutine end_steps(lanes)
      type(series_lanes_t), intent(inout) :: lanes

      if (lanes%has_curves) then
         call end_all(.true., lanes)
      else
         call end_all(.false., lanes)
      end if
   end subroutine end_steps

   !> End the steps with or without a curved ground motion.
   pure subroutine end_all(has_curves, lanes)
      logical, intent(in), value :: has_curves
      type(series_lanes_t), intent(inout) :: lanes
      real(wp), parameter :: followable = 64
      !! shortest duration of a flight in spacings of the time [-]
      real(wp) :: moving, h, t, rate, after, speed, ground, rise, ahead, least, hit, care, size, &
         x, cares
      integer :: i, k

      cares = 0
      !$omp simd private(moving, h, t, rate, after, speed, ground, rise, ahead, least, hit, care) &
      !$omp& private(size, x, k) reduction(+:cares)
      do i = 1, series_width
         moving = lanes%is_moving(i)
         h = lanes%h(i)
         x = lanes%x(i)
         hit = moving*lanes%has_root(i)
         care = moving*lanes%needs_care(i)
         t = lanes%t(i) + h*x
         least = merge(1.0_wp, 0.0_wp, min(lanes%limit(i) - t, (1 - x) + (lanes%limit(i) &
            - lanes%t(i) - h)) <= 0)
         t = merge(t, lanes%limit(i), least <= 0)
         lanes%is_at_limit(i) = moving*least
         t = merge(t, lanes%t(i), moving > 0)
         lanes%t(i) = t
         rate = lanes%rate_end(i)/h
         speed = abs(rate)
         lanes%fastest(i) = merge(max(lanes%fastest(i), speed), lanes%fastest(i), moving > 0)
         after = lanes%factor(i)*speed
         ! rest after the impact, or a flight too short to follow
         h = t - lanes%ground(i, 3)
         ground = lanes%ground(i, 1) + lanes%ground(i, 2)*h
         rise = lanes%upward(i, 1) + lanes%upward(i, 2)*h
         if (has_curves) then
            size = 0
            ahead = 0
            !GCC$ unroll 16
            do k = order, 2, -1
               size = (size + lanes%curve(i, k, 1))*h
               ahead = (ahead + lanes%curve(i, k, 2))*h
            end do
            ground = ground + size*h
            rise = rise + ahead*h
         end if
         rise = lanes%weight_share(i)*rise
         ahead = (lanes%uplift(i, left) + rise) - ground
         least = (lanes%uplift(i, right) + rise) + ground
         rise = max(ahead, least)
         size = lanes%gain(i)*max(ahead, least)
         least = lanes%gain(i)*min(ahead, least)
         ahead = max(lanes%negligible(i)*lanes%fastest(i), followable*epsilon(t)*(t*size))
         size = max(lanes%top(i, left), lanes%top(i, right))
         size = 2*least*(lanes%settled(i)*size) - after*after
         ! or without any contact, with which the wall jumps
         size = merge(0.0_wp, 1.0_wp, min(rise, min(after - ahead, -size)) > 0)
         ! the end of a branch
         size = merge(1.0_wp, size, max(lanes%lower(i), abs(lanes%turn(i))) > 0)
         care = max(care, hit*size)
         hit = hit*(1 - care)
         lanes%needs_care(i) = care
         cares = cares + care
         lanes%impacts(i) = lanes%impacts(i) + hit
         lanes%steps(i) = lanes%steps(i) + moving
         x = lanes%side(i)
         lanes%side(i) = merge(-x, x, hit > 0)
         rate = merge(after, rate, hit > 0)
         h = lanes%rate(i)
         lanes%rate(i) = merge(rate, h, moving > 0)
         h = lanes%phi(i)
         lanes%phi(i) = merge(lanes%phi_end(i), h, moving > 0)
         lanes%multiplicity(i) = moving*hit + (1 - moving)*lanes%multiplicity(i)
         lanes%above(i) = (1 - moving)*lanes%above(i)
         ! the largest rotation on the side of this step
         rate = merge(lanes%phi_end(i), 0.0_wp, moving > 0)
         h = lanes%top(i, right)
         hit = merge(h, huge(h), x > 0)
         lanes%top(i, right) = merge(rate, h, rate > hit)
         h = lanes%t_top(i, right)
         lanes%t_top(i, right) = merge(t, h, rate > hit)
         h = lanes%top(i, left)
         hit = merge(huge(h), h, x > 0)
         lanes%top(i, left) = merge(rate, h, rate > hit)
         h = lanes%t_top(i, left)
         lanes%t_top(i, left) = merge(t, h, rate > hit)
         h = lanes%length(i)
         rate = merge(min(lanes%share(i), 2*h), h, lanes%x_most(i) >= 0.7_wp)
         lanes%length(i) = merge(rate, h, moving > 0)
      end do
      lanes%needs_some_care = cares > 0
   end subroutine end_all

end module rwmf_integrator_series_series_loops
