!> The equation of motion with the frame's displacement as its unknown, for the fast spectra.
!>
!> On one side, with v = |u_s|/(2R), f = sigma u_g'' and the kinematics of `rwmf_model_kinematics`
!> as functions of v (docs/fast.md derives it from the general form of `rwmf_model_assembly`):
!>
!>    v'' = - M1 (2 xi_s omega_s v' + omega_s**2 v) - M2 f - M3 + Q v'**2
!>
!> M1, M2, M3 and Q depend on v alone, neither on the period nor on time. Their values at v = 0 (and
!> a slope of M3) make a linear equation with constant coefficients; what remains,
!>
!>    N = Q v'**2 - v (D1 (2 xi_s omega_s v' + omega_s**2 v) + D2 f + H),
!>
!> is small (of order 1/gamma) and smooth. Q, D1, D2 and H are replaced by polynomials. They are
!> fitted in quadruple precision because D1, D2 and H are differences over a small v.
module rwmf_spectrum_fast_reduced_equation
   use, intrinsic :: iso_fortran_env, only: real128
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_run, only: restitution
   use rwmf_spectrum_fast_types, only: curves, degree, reduced_equation_t, short_degree
   implicit none
   private

   public :: build_reduced_equation

   integer, parameter :: qp = real128

   !> Parameters of wall, frame and cable in quadruple precision.
   type :: parameters_t
      real(qp) :: gamma
      !! [-]
      real(qp) :: R
      !! [m]
      real(qp) :: sin_alpha
      real(qp) :: cos_alpha
      real(qp) :: alpha
      !! [rad]
      real(qp) :: g
      !! [m/s2]
      real(qp) :: eta_0
      !! [-]
      real(qp) :: cable_rate
      !! increase of the cable force over m_w g, per rad (linear) or per 2R of elongation (truss)
      !! [-]
      logical :: is_truss
      logical :: is_published
      logical :: is_exact
   end type parameters_t

contains

   !> Build the equation of a case, with curves fitted on -0.3 v_high <= v <= v_high.
   subroutine build_reduced_equation(case, v_high, accuracy, equation)
      type(case_t), intent(in) :: case
      !! with wall and frame
      real(wp), intent(in) :: v_high
      !! end of the fit [-]
      real(wp), intent(in) :: accuracy
      !! `fit_error` below which the lower degree is used [-]
      type(reduced_equation_t), intent(out) :: equation
      type(parameters_t) :: param
      real(qp) :: at_0(curves)
      real(qp) :: slope(2)
      integer :: side
      integer :: sides
      integer :: n

      param = parameters_of(case)
      at_0 = curves_at(param, 1, 0.0_qp)
      equation%m1 = real(at_0(2), wp)
      equation%m2 = real(at_0(3), wp)
      equation%m3 = real(at_0(4), wp)
      slope = [slope_at_rest(param, 1), slope_at_rest(param, 2)]
      equation%m3_1 = real(sum(slope)/2, wp)
      equation%threshold = equation%m3/equation%m2
      equation%e = restitution(case, real(param%alpha, wp))
      equation%length = real(2*param%R, wp)
      equation%v_high = v_high
      equation%is_even = .not. (param%is_published .or. param%is_exact)
      sides = merge(1, 2, equation%is_even)
      do n = short_degree, degree, degree - short_degree
         equation%is_short = n == short_degree
         equation%fit_error = 0
         do side = 1, sides
            call fit_side(param, side, n, at_0, real(equation%m3_1, qp), equation)
         end do
         if (equation%fit_error < accuracy) exit
      end do
      if (equation%is_even) equation%coef(:, :, 2) = equation%coef(:, :, 1)
      equation%bound = max(abs(equation%coef(0, :, 1)), abs(equation%coef(0, :, 2)))
   end subroutine build_reduced_equation

   pure type(parameters_t) function parameters_of(case) result(param)
      type(case_t), intent(in) :: case
      real(qp) :: h
      real(qp) :: b

      h = real(case%wall%h, qp)
      b = real(case%wall%b, qp)
      param%gamma = real(case%frame%gamma, qp)
      param%R = hypot(h, b)
      param%alpha = atan2(b, h)
      param%sin_alpha = sin(param%alpha)
      param%cos_alpha = cos(param%alpha)
      param%g = real(case%model%g, qp)
      param%is_published = case%model%formulation == 'published'
      param%is_exact = case%model%formulation == 'exact'
      param%is_truss = .false.
      param%eta_0 = 0
      param%cable_rate = 0
      if (.not. allocated(case%cable)) return
      param%eta_0 = real(case%cable%eta_0, qp)
      param%is_truss = case%cable%law == 'truss'
      param%cable_rate = real(case%cable%eta_alpha, qp) - param%eta_0
      if (param%is_truss) then
         param%cable_rate = param%cable_rate/elongation(param, param%alpha)
      else
         param%cable_rate = param%cable_rate/param%alpha
      end if
   end function parameters_of

   !> Length of the straight cable over 2R at the rotation phi: with h = R cos(alpha) and
   !> b = R sin(alpha) the square root of the truss law (section 2 of docs/theory.md).
   pure real(qp) function cable_length(param, phi)
      type(parameters_t), intent(in) :: param
      real(qp), intent(in) :: phi
      !! [rad]

      associate (s => param%sin_alpha, c => param%cos_alpha)
         cable_length = sqrt(c**2 + s**2*(1 - cos(phi))/2 + s*c*sin(phi))
      end associate
   end function cable_length

   !> Elongation of the straight cable over 2R at the rotation phi.
   pure real(qp) function elongation(param, phi)
      type(parameters_t), intent(in) :: param
      real(qp), intent(in) :: phi
      !! [rad]

      elongation = cable_length(param, phi) - param%cos_alpha
   end function elongation

   !> Moment of the cable over m_w g R [-].
   pure real(qp) function cable_moment(param, side, phi) result(moment)
      type(parameters_t), intent(in) :: param
      integer, intent(in) :: side
      !! 1: theta > 0, 2: theta < 0
      real(qp), intent(in) :: phi
      !! |theta| [rad]

      associate (s => param%sin_alpha, c => param%cos_alpha)
         if (param%is_truss) then
            moment = (param%eta_0 + param%cable_rate*elongation(param, phi)) &
               *(s**2*sin(phi) + 2*s*c*cos(phi))/(2*cable_length(param, phi))
         else if (param%is_published .and. side == 2) then
            moment = (param%eta_0 - param%cable_rate*phi)*s
         else
            moment = (param%eta_0 + param%cable_rate*phi)*s
         end if
      end associate
   end function cable_moment

   !> Q [-], M1 [-], M2 [1/m] and M3 [1/s2] at v.
   pure function curves_at(param, side, v) result(values)
      type(parameters_t), intent(in) :: param
      integer, intent(in) :: side
      real(qp), intent(in) :: v
      !! |u_s|/(2R) [-]
      real(qp) :: values(curves)
      real(qp) :: phi
      real(qp) :: s
      real(qp) :: c
      real(qp) :: w
      !! dv/dphi
      real(qp) :: half_k
      !! derivative of w by phi
      real(qp) :: lever
      real(qp) :: per_inertia

      if (param%is_exact .and. side == 2) then
         phi = asin(v/param%cos_alpha)
         w = param%cos_alpha*cos(phi)
         half_k = -v
      else
         phi = param%alpha - asin(param%sin_alpha - v)
         w = cos(param%alpha - phi)
         half_k = sin(param%alpha - phi)
      end if
      s = sin(param%alpha - phi)
      c = cos(param%alpha - phi)
      lever = 2*w
      if (param%is_published .and. side == 2) lever = 2*param%cos_alpha*cos(phi)
      per_inertia = w/(4/3.0_qp + 2*param%gamma*lever*w)
      values(2) = 2*param%gamma*lever*per_inertia
      values(1) = half_k/w**2*(1 - values(2))
      values(3) = per_inertia*(param%gamma*lever + c)/param%R
      values(4) = per_inertia*param%g/param%R*(s + cable_moment(param, side, phi))
   end function curves_at

   !> dM3/dv at v = 0 [1/s2]; the central difference is exact to 20 digits here.
   pure real(qp) function slope_at_rest(param, side) result(slope)
      type(parameters_t), intent(in) :: param
      integer, intent(in) :: side
      real(qp), parameter :: step = 1.0e-10_qp
      real(qp) :: after(curves)
      real(qp) :: before(curves)

      after = curves_at(param, side, step)
      before = curves_at(param, side, -step)
      slope = (after(4) - before(4))/(2*step)
   end function slope_at_rest

   !> Q, D1, D2 and H at v /= 0.
   pure function remainder_curves(param, side, at_0, m3_1, v) result(values)
      type(parameters_t), intent(in) :: param
      integer, intent(in) :: side
      real(qp), intent(in) :: at_0(curves)
      !! values at v = 0
      real(qp), intent(in) :: m3_1
      real(qp), intent(in) :: v
      real(qp) :: values(curves)

      values = curves_at(param, side, v)
      values(2:) = (values(2:) - at_0(2:))/v
      values(4) = values(4) - m3_1
   end function remainder_curves

   !> Interpolate the curves of a side at Chebyshev's nodes; update the largest error between them.
   pure subroutine fit_side(param, side, n, at_0, m3_1, equation)
      type(parameters_t), intent(in) :: param
      integer, intent(in) :: side
      integer, intent(in) :: n
      !! degree of the polynomials
      real(qp), intent(in) :: at_0(curves)
      real(qp), intent(in) :: m3_1
      type(reduced_equation_t), intent(inout) :: equation
      real(qp) :: node(0:n)
      real(qp) :: values(0:n, curves)
      real(qp) :: v
      real(qp) :: deviation(curves)
      integer :: i

      do i = 0, n
         node(i) = chebyshev_node(real(equation%v_high, qp), n, i + 0.5_qp)
         values(i, :) = remainder_curves(param, side, at_0, m3_1, node(i))
      end do
      do i = 1, curves
         equation%coef(:, i, side) = 0
         equation%coef(:n, i, side) = real(monomials(node, values(:, i)), wp)
      end do
      do i = 0, n + 1
         v = chebyshev_node(real(equation%v_high, qp), n, real(i, qp)) + 1.0e-9_qp
         deviation = abs(remainder_curves(param, side, at_0, m3_1, v) &
            - polynomials(equation, side, v))
         deviation(2:) = deviation(2:)*abs(v)/[1.0_qp, at_0(3), param%g/param%R]
         ! The error of Q v'**2 is relative to omega_s**2 v.
         deviation(1) = deviation(1)*abs(v)
         equation%fit_error = max(equation%fit_error, real(maxval(deviation), wp))
      end do
   end subroutine fit_side

   !> Point number i (halves: roots, integers: extrema of the error) of the fit's interval [-].
   pure real(qp) function chebyshev_node(v_high, n, i) result(v)
      real(qp), intent(in) :: v_high
      integer, intent(in) :: n
      !! degree of the polynomial
      real(qp), intent(in) :: i

      v = v_high*(0.35_qp + 0.65_qp*cos(i*acos(-1.0_qp)/(n + 1)))
   end function chebyshev_node

   !> Values of the fitted polynomials at v.
   pure function polynomials(equation, side, v) result(values)
      type(reduced_equation_t), intent(in) :: equation
      integer, intent(in) :: side
      real(qp), intent(in) :: v
      real(qp) :: values(curves)
      integer :: i

      values = 0
      do i = degree, 0, -1
         values = values*v + equation%coef(i, :, side)
      end do
   end function polynomials

   !> Coefficients in powers of v of the polynomial through (node, values): Newton's divided
   !> differences, multiplied out.
   pure function monomials(node, values) result(coef)
      real(qp), intent(in) :: node(0:)
      real(qp), intent(in) :: values(0:)
      real(qp) :: coef(0:size(node) - 1)
      real(qp) :: difference(0:size(node) - 1)
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
