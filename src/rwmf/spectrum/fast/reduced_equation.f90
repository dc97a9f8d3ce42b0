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
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_types, only: curves, degree, fast_law_t, short_degree
   use rwmf_core_kinds, only: wp
   use rwmf_simulation_run, only: restitution
   implicit none
   private

   public :: build_law

   integer, parameter :: qp = real128

   !> Scene in quadruple precision.
   type :: scene_t
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
      real(qp) :: rate
      !! of the cable: per rad (linear) or per 2R of elongation (truss)
      logical :: is_truss
      logical :: is_published
      logical :: is_exact
   end type scene_t

contains

   !> Fit the curves of a case on -0.3 v_high <= v <= v_high.
   subroutine build_law(case, v_high, accuracy, law)
      type(case_t), intent(in) :: case
      !! with wall and frame
      real(wp), intent(in) :: v_high
      !! [-]
      real(wp), intent(in) :: accuracy
      !! `fit_error` that is good enough [-]; a lower degree does if it has it
      type(fast_law_t), intent(out) :: law
      type(scene_t) :: scene
      real(qp) :: at_0(curves)
      real(qp) :: slope(2)
      integer :: side
      integer :: sides
      integer :: top

      scene = scene_of(case)
      at_0 = curves_at(scene, 1, 0.0_qp)
      law%m1 = real(at_0(2), wp)
      law%m2 = real(at_0(3), wp)
      law%m3 = real(at_0(4), wp)
      slope = [slope_at_rest(scene, 1), slope_at_rest(scene, 2)]
      law%m3_1 = real(sum(slope)/2, wp)
      law%threshold = law%m3/law%m2
      law%e = restitution(case, real(scene%alpha, wp))
      law%length = real(2*scene%R, wp)
      law%v_high = v_high
      law%is_even = .not. (scene%is_published .or. scene%is_exact)
      sides = merge(1, 2, law%is_even)
      do top = short_degree, degree, degree - short_degree
         law%is_short = top == short_degree
         law%fit_error = 0
         do side = 1, sides
            call fit_side(scene, side, top, at_0, real(law%m3_1, qp), law)
         end do
         if (law%fit_error < accuracy) exit
      end do
      if (law%is_even) law%coef(:, :, 2) = law%coef(:, :, 1)
      law%bound = max(abs(law%coef(0, :, 1)), abs(law%coef(0, :, 2)))
   end subroutine build_law

   pure type(scene_t) function scene_of(case) result(scene)
      type(case_t), intent(in) :: case
      real(qp) :: h
      real(qp) :: b

      h = real(case%wall%h, qp)
      b = real(case%wall%b, qp)
      scene%gamma = real(case%frame%gamma, qp)
      scene%R = hypot(h, b)
      scene%alpha = atan2(b, h)
      scene%sin_alpha = sin(scene%alpha)
      scene%cos_alpha = cos(scene%alpha)
      scene%g = real(case%model%g, qp)
      scene%is_published = case%model%formulation == 'published'
      scene%is_exact = case%model%formulation == 'exact'
      scene%is_truss = .false.
      scene%eta_0 = 0
      scene%rate = 0
      if (.not. allocated(case%cable)) return
      scene%eta_0 = real(case%cable%eta_0, qp)
      scene%is_truss = case%cable%law == 'truss'
      scene%rate = real(case%cable%eta_alpha, qp) - scene%eta_0
      if (scene%is_truss) then
         scene%rate = scene%rate/elongation(scene, scene%alpha)
      else
         scene%rate = scene%rate/scene%alpha
      end if
   end function scene_of

   !> Length of the straight cable over 2R at the rotation phi: with h = R cos(alpha) and
   !> b = R sin(alpha) the square root of the truss law (section 2 of docs/theory.md).
   pure real(qp) function cable_length(scene, phi)
      type(scene_t), intent(in) :: scene
      real(qp), intent(in) :: phi
      !! [rad]

      associate (s => scene%sin_alpha, c => scene%cos_alpha)
         cable_length = sqrt(c**2 + s**2*(1 - cos(phi))/2 + s*c*sin(phi))
      end associate
   end function cable_length

   pure real(qp) function elongation(scene, phi)
      type(scene_t), intent(in) :: scene
      real(qp), intent(in) :: phi
      !! [rad]

      elongation = cable_length(scene, phi) - scene%cos_alpha
   end function elongation

   !> Moment of the cable over m_w g R [-].
   pure real(qp) function cable_moment(scene, side, phi) result(moment)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: side
      !! 1: theta > 0, 2: theta < 0
      real(qp), intent(in) :: phi
      !! |theta| [rad]

      associate (s => scene%sin_alpha, c => scene%cos_alpha)
         if (scene%is_truss) then
            moment = (scene%eta_0 + scene%rate*elongation(scene, phi)) &
               *(s**2*sin(phi) + 2*s*c*cos(phi))/(2*cable_length(scene, phi))
         else if (scene%is_published .and. side == 2) then
            moment = (scene%eta_0 - scene%rate*phi)*s
         else
            moment = (scene%eta_0 + scene%rate*phi)*s
         end if
      end associate
   end function cable_moment

   !> Q [-], M1 [-], M2 [1/m] and M3 [1/s2] at v.
   pure function curves_at(scene, side, v) result(values)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: side
      real(qp), intent(in) :: v
      !! [-]
      real(qp) :: values(curves)
      real(qp) :: phi
      real(qp) :: s
      real(qp) :: c
      real(qp) :: w
      !! dv/dphi
      real(qp) :: half_k
      !! its derivative by phi
      real(qp) :: lever
      real(qp) :: per_inertia

      if (scene%is_exact .and. side == 2) then
         phi = asin(v/scene%cos_alpha)
         w = scene%cos_alpha*cos(phi)
         half_k = -v
      else
         phi = scene%alpha - asin(scene%sin_alpha - v)
         w = cos(scene%alpha - phi)
         half_k = sin(scene%alpha - phi)
      end if
      s = sin(scene%alpha - phi)
      c = cos(scene%alpha - phi)
      lever = 2*w
      if (scene%is_published .and. side == 2) lever = 2*scene%cos_alpha*cos(phi)
      per_inertia = w/(4/3.0_qp + 2*scene%gamma*lever*w)
      values(2) = 2*scene%gamma*lever*per_inertia
      values(1) = half_k/w**2*(1 - values(2))
      values(3) = per_inertia*(scene%gamma*lever + c)/scene%R
      values(4) = per_inertia*scene%g/scene%R*(s + cable_moment(scene, side, phi))
   end function curves_at

   !> dM3/dv at v = 0 [1/s2]; the central difference is exact to 20 digits here.
   pure real(qp) function slope_at_rest(scene, side) result(slope)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: side
      real(qp), parameter :: step = 1.0e-10_qp
      real(qp) :: after(curves)
      real(qp) :: before(curves)

      after = curves_at(scene, side, step)
      before = curves_at(scene, side, -step)
      slope = (after(4) - before(4))/(2*step)
   end function slope_at_rest

   !> Q, D1, D2 and H at v /= 0.
   pure function remainder_curves(scene, side, at_0, m3_1, v) result(values)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: side
      real(qp), intent(in) :: at_0(curves)
      !! values at v = 0
      real(qp), intent(in) :: m3_1
      real(qp), intent(in) :: v
      real(qp) :: values(curves)

      values = curves_at(scene, side, v)
      values(2:) = (values(2:) - at_0(2:))/v
      values(4) = values(4) - m3_1
   end function remainder_curves

   !> Interpolate at Chebyshev's nodes and keep the largest error found between them.
   pure subroutine fit_side(scene, side, top, at_0, m3_1, law)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: side
      integer, intent(in) :: top
      !! degree of the polynomials
      real(qp), intent(in) :: at_0(curves)
      real(qp), intent(in) :: m3_1
      type(fast_law_t), intent(inout) :: law
      real(qp) :: node(0:top)
      real(qp) :: values(0:top, curves)
      real(qp) :: v
      real(qp) :: miss(curves)
      integer :: i

      do i = 0, top
         node(i) = chebyshev_node(real(law%v_high, qp), top, i + 0.5_qp)
         values(i, :) = remainder_curves(scene, side, at_0, m3_1, node(i))
      end do
      do i = 1, curves
         law%coef(:, i, side) = 0
         law%coef(:top, i, side) = real(monomials(node, values(:, i)), wp)
      end do
      do i = 0, top + 1
         v = chebyshev_node(real(law%v_high, qp), top, real(i, qp)) + 1.0e-9_qp
         miss = abs(remainder_curves(scene, side, at_0, m3_1, v) - polynomials(law, side, v))
         miss(2:) = miss(2:)*abs(v)/[1.0_qp, at_0(3), scene%g/scene%R]
         ! Q v'**2 is measured against omega_s**2 v.
         miss(1) = miss(1)*abs(v)
         law%fit_error = max(law%fit_error, real(maxval(miss), wp))
      end do
   end subroutine fit_side

   !> Point number i (halves: roots, integers: extrema of the error) of the fit's interval [-].
   pure real(qp) function chebyshev_node(v_high, top, i) result(v)
      real(qp), intent(in) :: v_high
      integer, intent(in) :: top
      !! degree of the polynomial
      real(qp), intent(in) :: i

      v = v_high*(0.35_qp + 0.65_qp*cos(i*acos(-1.0_qp)/(top + 1)))
   end function chebyshev_node

   pure function polynomials(law, side, v) result(values)
      type(fast_law_t), intent(in) :: law
      integer, intent(in) :: side
      real(qp), intent(in) :: v
      real(qp) :: values(curves)
      integer :: i

      values = 0
      do i = degree, 0, -1
         values = values*v + law%coef(i, :, side)
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
