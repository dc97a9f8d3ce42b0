!> The equation of motion with the frame's displacement as its unknown, for the fast spectra.
!>
!> On one side, with v = |u_s|/(2R) and f = sigma u_g'' (docs/theory/fast.md derives it from the
!> general form of `rwmf_model_lanes`):
!>
!>    v'' = - M1 (2 xi_s omega_s v' + omega_s**2 v) - M2 f - M3 - M4 v' + Q v'**2
!>
!> M1 to M4 and Q depend on v alone, neither on the period nor on time; M4 is of dampers. Their
!> values at v = 0 (and a slope of M3) make a linear equation with constant coefficients; what
!> remains,
!>
!>    N = Q v'**2 - v (D1 (2 xi_s omega_s v' + omega_s**2 v) + D2 f + H + D4 v'),
!>
!> is small (of order 1/gamma) and smooth. Q, D1, D2, H and D4 are replaced by polynomials through
!> what the loops of the effects say at single rotations: no effect has a formula of its own here.
module rwmf_spectrum_fast_reduced_equation
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_assembly, only: build_equation
   use rwmf_model_drift_limits, only: count_drifts, drift_ratios
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_equation, only: enter_side, equation_t, frame_motion
   use rwmf_model_impact_rule, only: restitution
   use rwmf_model_lanes, only: lane_motion_t
   use rwmf_model_scene, only: frame_term, scene_t
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_run, only: initial_state
   use rwmf_spectrum_fast_types, only: curves, degree, reduced_equation_t
   implicit none
   private

   public :: build_reduced_equation, is_reducible, probe_t, under_motion

   integer, parameter :: short_degree = 4
   !! of polynomials that are accurate enough with it
   real(wp), parameter :: below_limit = 0.999_wp
   !! part of the limit of a drift up to which there is no doubt that it is kept [-]

   !> The scene on one side, without spring and damping of the frame.
   type :: probe_t
      type(scene_t) :: scene
      real(wp), allocatable :: coef(:, :)
      !! (1, coefficients)
      integer :: side
      !! +1 or -1
      real(wp) :: gamma
      !! [-]
      real(wp) :: g_over_R
      !! [1/s2]
      real(wp) :: ratio
      !! vertical over horizontal ground acceleration [-]
      procedure(lane_rates), pointer, nopass :: rates => lane_rates
      !! equation of motion that is probed
   end type probe_t

contains

   !> Build the equation of a case, with curves fitted on -0.3 v_high <= v <= v_high, or up to where
   !> a drift comes close to its limit: what goes on to it is left to the general lanes.
   subroutine build_reduced_equation(case, motion, v_high, accuracy, reduced)
      type(case_t), intent(in) :: case
      !! supported by `rwmf_spectrum_fast_eligibility`
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: v_high
      !! end of the fit [-]
      real(wp), intent(in) :: accuracy
      !! `fit_error` below which the lower degree is used [-]
      type(reduced_equation_t), intent(out) :: reduced
      type(equation_t) :: equation
      type(probe_t) :: probe(2)
      type(lane_motion_t) :: overturned
      real(wp) :: at_0(curves, 2)
      real(wp), parameter :: step = 1.0e-5_wp
      !! for the slope of M3, of which H is what remains whatever its error [-]
      integer :: side, n

      call build_equation(case, motion, equation)
      do side = 1, 2
         call set_probe(case, equation, 3 - 2*side, probe(side))
         at_0(:, side) = curves_at(probe(side), 0.0_wp)
      end do
      reduced%m1 = at_0(2, 1)
      reduced%m2 = at_0(3, :)
      reduced%m3 = at_0(4, 1)
      reduced%m4 = at_0(5, 1)
      reduced%m3_1 = 0
      do side = 1, 2
         associate (rise => curves_at(probe(side), step) - curves_at(probe(side), -step))
            reduced%m3_1 = reduced%m3_1 + rise(4)/(4*step)
         end associate
      end do
      reduced%threshold = reduced%m3/max(reduced%m2, tiny(1.0_wp))
      reduced%e = restitution(case, equation%p%alpha)
      call set_start(probe, initial_state(case, equation), reduced)
      reduced%length = 2*equation%p%R
      reduced%v_high = min(v_high, below_limit*collapsed_at(equation))
      do n = short_degree, degree, degree - short_degree
         reduced%is_short = n == short_degree
         reduced%fit_error = 0
         do side = 1, 2
            call fit_side(probe(side), side, n, at_0(:, side), reduced)
         end do
         ! what takes stiffness from the frame lets a steady error move it farther
         reduced%fit_error = reduced%fit_error*(1 + max(0.0_wp, -reduced%m3_1)/equation%p%g_over_R)
         ! and flights that all begin without a velocity are moved by little more than such errors
         if (reduced%e <= 0) reduced%fit_error = 10*reduced%fit_error
         if (reduced%fit_error < accuracy) exit
      end do
      reduced%is_even = all(abs(reduced%coef(:, :, 1) - reduced%coef(:, :, 2)) <= 0) &
         .and. abs(reduced%m2(1) - reduced%m2(2)) <= 0
      reduced%bound = max(abs(reduced%coef(0, :, 1)), abs(reduced%coef(0, :, 2)))
      ! a wall that stands, does not overturn within the fit, and is returned by its weight
      do side = 1, 2
         call ask(probe(side), min(case%model%overturning_angle, 1.0_wp), 0.0_wp, 0.0_wp, &
            overturned)
         if (reduced%v_high >= overturned%u(1)/2) reduced%fit_error = huge(1.0_wp)
         if (.not. is_reducible(probe(side), 0.0_wp)) reduced%fit_error = huge(1.0_wp)
         if (.not. is_reducible(probe(side), reduced%v_high/2)) reduced%fit_error = huge(1.0_wp)
      end do
      if (minval(reduced%m2) <= 0 .or. reduced%m3 <= 0) then
         reduced%fit_error = huge(1.0_wp)
      end if
   end subroutine build_reduced_equation

   !> The same equation with the ground motion in another unit: it enters nowhere else. A negative
   !> one exchanges the sides.
   pure type(reduced_equation_t) function under_motion(equation, factor) result(scaled)
      type(reduced_equation_t), intent(in) :: equation
      real(wp), intent(in) :: factor
      !! the new unit of the motion [m/s2 or -]

      scaled = equation
      if (factor < 0) then
         scaled%m2 = equation%m2([2, 1])
         scaled%coef = equation%coef(:, :, [2, 1])
         scaled%threshold = equation%threshold([2, 1])
         scaled%start_side = -equation%start_side
      end if
      scaled%m2 = abs(factor)*scaled%m2
      scaled%coef(:, 3, :) = abs(factor)*scaled%coef(:, 3, :)
      scaled%bound(3) = abs(factor)*scaled%bound(3)
      scaled%threshold = scaled%threshold/abs(factor)
   end function under_motion

   !> v at which a drift reaches its limit [-]; they are in proportion.
   real(wp) function collapsed_at(equation) result(v)
      type(equation_t), intent(in) :: equation
      real(wp) :: ratio(count_drifts(equation)), rate(count_drifts(equation))
      real(wp) :: u_s, u_s_dot

      v = huge(v)
      if (size(rate) == 0) return
      call drift_ratios(equation, [0.0_wp, 1.0_wp], ratio, rate)
      call frame_motion(equation, equation%state%side, [0.0_wp, 1.0_wp], u_s, u_s_dot)
      v = abs(u_s_dot)/(2*equation%p%R*maxval(abs(rate)))
   end function collapsed_at

   !> The scene on a side; what depends on the period is left out of it.
   subroutine set_probe(case, equation, side, probe)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: side
      !! +1 or -1
      type(probe_t), intent(out) :: probe
      integer :: i

      call enter_side(equation%model_t, equation%state, side)
      probe%scene = equation%scene
      probe%coef = equation%state%coef
      probe%side = side
      probe%gamma = case%frame%gamma
      probe%g_over_R = equation%p%g_over_R
      probe%ratio = 0
      if (allocated(case%vertical)) probe%ratio = case%vertical%ratio
      do i = 1, size(probe%scene%terms)
         associate (term => probe%scene%terms(i))
            if (term%effect == frame_term) probe%coef(1, term%coef + 1:term%coef + 2) = 0
         end associate
      end do
   end subroutine set_probe

   !> The state to start with.
   subroutine set_start(probe, y, reduced)
      type(probe_t), intent(in) :: probe(2)
      real(wp), intent(in) :: y(2)
      !! theta [rad] and theta' [rad/s]
      type(reduced_equation_t), intent(inout) :: reduced
      type(lane_motion_t) :: motion
      integer :: side

      side = 1
      if (y(1) < 0 .or. (abs(y(1)) <= 0 .and. y(2) < 0)) side = -1
      call ask(probe(merge(1, 2, side > 0)), side*y(1), side*y(2), 0.0_wp, motion)
      reduced%start_v = motion%u(1)/2
      reduced%start_w = motion%j(1)/2*(side*y(2))
      reduced%start_side = side
   end subroutine set_start

   !> What moves the wall at a rotation, per m_w R**2.
   subroutine ask(probe, phi, rate, ground, motion)
      type(probe_t), intent(in) :: probe
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(in) :: rate
      !! phi' [rad/s]
      real(wp), intent(in) :: ground
      !! towards the side [m/s2]
      type(lane_motion_t), intent(out) :: motion
      real(wp) :: y(1, 2), y_dot(1, 2)

      y(1, 1) = probe%side*phi
      y(1, 2) = probe%side*rate
      motion%ground = probe%side*ground
      motion%vertical = probe%ratio*motion%ground
      call probe%rates(probe%scene, probe%coef, y, motion, y_dot)
   end subroutine ask

   !> Is the moment a parabola in phi' and a straight line in the ground's acceleration, and are
   !> kinematics and inertia independent of both, as the curves assume?
   !>
   !> The curves are formed at phi' = 0, 1 and -1. Further rates over four orders of magnitude
   !> expose every other dependence: powers, friction, dead zones, saturation.
   logical function is_reducible(probe, phi)
      type(probe_t), intent(in) :: probe
      real(wp), intent(in) :: phi
      !! rotation [rad]
      type(lane_motion_t) :: rest, pushed, opening, closing, motion
      real(wp), parameter :: rate(4) = [2.0_wp, -0.125_wp, 32.0_wp, -0.001_wp]
      !! [rad/s]
      real(wp), parameter :: ground(4) = [-3.0_wp, 0.5_wp, 10.0_wp, 0.0_wp]
      !! [m/s2]
      real(wp), parameter :: round_off = 1.0e3_wp*epsilon(1.0_wp)
      real(wp) :: line, bend, expected, largest
      integer :: i

      call ask(probe, phi, 0.0_wp, 0.0_wp, rest)
      call ask(probe, phi, 0.0_wp, 1.0_wp, pushed)
      call ask(probe, phi, 1.0_wp, 0.0_wp, opening)
      call ask(probe, phi, -1.0_wp, 0.0_wp, closing)
      line = (opening%moment(1) - closing%moment(1))/2
      bend = (opening%moment(1) + closing%moment(1))/2 - rest%moment(1)
      is_reducible = .true.
      do i = 1, size(rate)
         call ask(probe, phi, rate(i), ground(i), motion)
         expected = rest%moment(1) + rate(i)*(line + rate(i)*bend) &
            + ground(i)*(pushed%moment(1) - rest%moment(1))
         largest = (1 + rate(i)**2)*(abs(rest%moment(1)) + abs(opening%moment(1)) &
            + abs(closing%moment(1))) + abs(ground(i))*(abs(pushed%moment(1)) &
            + abs(rest%moment(1)))
         is_reducible = is_reducible .and. abs(motion%moment(1) - expected) <= round_off*largest &
            .and. abs(motion%inertia(1) - rest%inertia(1)) <= round_off*abs(rest%inertia(1)) &
            .and. abs(motion%u(1) - rest%u(1)) <= round_off*abs(rest%u(1)) &
            .and. abs(motion%j(1) - rest%j(1)) <= round_off*abs(rest%j(1)) &
            .and. abs(motion%lever(1) - rest%lever(1)) <= round_off*abs(rest%lever(1))
      end do
   end function is_reducible

   !> Q [-], M1 [-], M2 [1/m], M3 [1/s2] and M4 [1/s] at v.
   function curves_at(probe, v) result(values)
      type(probe_t), intent(in) :: probe
      real(wp), intent(in) :: v
      !! |u_s|/(2R) [-]
      real(wp) :: values(curves)
      type(lane_motion_t) :: rest, pushed, opening, closing
      real(wp) :: phi
      real(wp) :: w
      !! dv/dphi
      integer :: i

      phi = v
      do i = 1, 20
         call ask(probe, phi, 0.0_wp, 0.0_wp, rest)
         if (abs(v - rest%u(1)/2) <= 2*epsilon(v)*abs(v)) exit
         phi = phi + (2*v - rest%u(1))/rest%j(1)
      end do
      call ask(probe, phi, 0.0_wp, 1.0_wp, pushed)
      call ask(probe, phi, 1.0_wp, 0.0_wp, opening)
      call ask(probe, phi, -1.0_wp, 0.0_wp, closing)
      w = rest%j(1)/2
      associate (m => rest%moment(1), inertia => rest%inertia(1))
         values(1) = (w*((opening%moment(1) + closing%moment(1))/2 - m)/inertia + rest%k(1)/2) &
            /w**2
         values(2) = probe%gamma*rest%lever(1)*rest%j(1)/inertia
         values(3) = w*(m - pushed%moment(1))/inertia
         values(4) = -w*m/inertia
         values(5) = (closing%moment(1) - opening%moment(1))/(2*inertia)
      end associate
   end function curves_at

   !> Interpolate the curves of a side at Chebyshev's nodes; update the largest error between them.
   subroutine fit_side(probe, side, n, at_0, reduced)
      type(probe_t), intent(in) :: probe
      integer, intent(in) :: side
      !! 1 for theta > 0, 2 for theta < 0
      integer, intent(in) :: n
      !! degree of the polynomials
      real(wp), intent(in) :: at_0(curves)
      !! values at v = 0
      type(reduced_equation_t), intent(inout) :: reduced
      real(wp) :: node(0:n)
      real(wp) :: values(0:n, curves)
      real(wp) :: fitted(curves), deviation(curves)
      real(wp) :: v
      integer :: i, j

      do i = 0, n
         node(i) = chebyshev_node(reduced%v_high, n, i + 0.5_wp)
         values(i, :) = remainder_curves(probe, at_0, reduced%m3_1, node(i))
      end do
      do i = 1, curves
         reduced%coef(:, i, side) = 0
         reduced%coef(:n, i, side) = monomials(node, values(:, i))
      end do
      do i = 0, n + 1
         v = chebyshev_node(reduced%v_high, n, real(i, wp)) + 1.0e-9_wp
         fitted = 0
         do j = degree, 0, -1
            fitted = fitted*v + reduced%coef(j, :, side)
         end do
         deviation = abs(remainder_curves(probe, at_0, reduced%m3_1, v) - fitted)*abs(v)
         ! The errors of Q v'**2 and D4 v v' are relative to omega_s**2 v.
         deviation(3:4) = deviation(3:4)/[at_0(3), probe%g_over_R]
         if (.not. all(deviation < huge(1.0_wp))) deviation = huge(1.0_wp)
         reduced%fit_error = max(reduced%fit_error, maxval(deviation))
      end do
   end subroutine fit_side

   !> Q, D1, D2, H and D4 at v /= 0.
   function remainder_curves(probe, at_0, m3_1, v) result(values)
      type(probe_t), intent(in) :: probe
      real(wp), intent(in) :: at_0(curves)
      real(wp), intent(in) :: m3_1
      real(wp), intent(in) :: v
      real(wp) :: values(curves)

      values = curves_at(probe, v)
      values(2:) = (values(2:) - at_0(2:))/v
      values(4) = values(4) - m3_1
   end function remainder_curves

   !> Point number i (halves: roots, integers: extrema of the error) of the fit's interval [-].
   pure real(wp) function chebyshev_node(v_high, n, i) result(v)
      real(wp), intent(in) :: v_high
      integer, intent(in) :: n
      !! degree of the polynomial
      real(wp), intent(in) :: i

      v = v_high*(0.35_wp + 0.65_wp*cos(i*pi/(n + 1)))
   end function chebyshev_node

   !> Coefficients in powers of v of the polynomial through (node, values): Newton's divided
   !> differences, multiplied out.
   pure function monomials(node, values) result(coef)
      real(wp), intent(in) :: node(0:)
      real(wp), intent(in) :: values(0:)
      real(wp) :: coef(0:size(node) - 1)
      real(wp) :: difference(0:size(node) - 1)
      integer :: i
      integer :: n

      n = size(node) - 1
      difference = values
      do i = 1, n
         difference(i:) = (difference(i:) - difference(i - 1:n - 1))/(node(i:) - node(:n - i))
      end do
      coef = 0
      coef(0) = difference(n)
      do i = n - 1, 0, -1
         coef(1:) = coef(:n - 1) - node(i)*coef(1:)
         coef(0) = difference(i) - node(i)*coef(0)
      end do
   end function monomials

end module rwmf_spectrum_fast_reduced_equation
