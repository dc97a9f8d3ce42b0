!> Taylor series of the kinematics that all effects of a lane share, and of wall, frame and cable.
!>
!> The series are those of the time since the start of a step. Index n is the coefficient of the
!> n-th power, in the unit of the quantity over s**n. Round n computes coefficient n of everything
!> from coefficients 0 to n of the states. Coefficient 0 is the value at the start of the step.
!> The first index of every array is the lane, as in `rwmf_model_lanes`, which explains the symbols.
module rwmf_model_series_series_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: frame_coefficients, lane_cosine => cosine, lane_count, &
      lane_sine => sine, link_coefficients, wall_coefficients
   implicit none
   private

   public :: highest_order, series_motion_t, set_ground
   public :: product_of, root_of, quotient_of, power_of, pushed
   public :: expand_weight, expand_wall, expand_bare_frame, expand_link, expand_frame

#ifdef RWMF_QUAD
   integer, parameter :: highest_order = 32
#else
   integer, parameter :: highest_order = 16
#endif

   !> Series of single effects.
   type :: law_series_t
      real(wp) :: twice(lane_count, 0:highest_order, 2)
      !! sin(2 phi) and cos(2 phi), set beside restraints and couplings [-]
      real(wp) :: tilt(lane_count, 0:highest_order, 8)
      !! series of a link of finite length in the units of `expand_link`
      real(wp) :: hysteresis(lane_count, 0:highest_order, 7)
      !! powers of the state of a smooth frame, up to the eighth [-]
      real(wp) :: power(lane_count, 0:highest_order, 2)
      !! series of nonlinear dampers in the units of `expand_nl_damper`
      real(wp) :: negligible_rate(lane_count) = 0
      !! |phi'| up to which they exert no force [rad/s]
      real(wp) :: negligible_state(lane_count) = 0
      !! |z| up to which the power of z in a smooth law is 0 [-]
   end type law_series_t

   !> Series of the motion of the lanes. Effects add to inertia and moment of the equation
   !> inertia*phi'' = moment, per m_w R**2. For a bare frame u replaces phi, R is 1 and m_s replaces
   !> m_w.
   type :: series_motion_t
      integer :: ground_order = 1
      !! highest power in the series of the ground motion
      real(wp) :: ground(lane_count, 0:highest_order)
      !! horizontal acceleration of the ground [m/s2]
      real(wp) :: upward(lane_count, 0:highest_order)
      !! vertical acceleration of the ground, positive upward [m/s2]
      real(wp) :: side(lane_count)
      !! +1 or -1, the current side; for a rocking wall the sign of theta
      real(wp) :: push(lane_count, 0:highest_order)
      !! horizontal acceleration of the ground towards that side, over R [1/s2]
      real(wp) :: phi(lane_count, 0:highest_order)
      !! [rad]
      real(wp) :: rate(lane_count, 0:highest_order)
      !! phi' [rad/s]
      real(wp) :: sine(lane_count, 0:highest_order)
      !! sin(phi) [-]
      real(wp) :: cosine(lane_count, 0:highest_order)
      !! cos(phi) [-]
      real(wp) :: sine_rate(lane_count, 0:highest_order)
      !! sin(phi) phi' [1/s]
      real(wp) :: cosine_rate(lane_count, 0:highest_order)
      !! cos(phi) phi' [1/s]
      real(wp) :: half_sine(lane_count, 0:highest_order)
      !! sin(phi/2), of which only effects at the corners set more than coefficient 0 [-]
      real(wp) :: half_cosine(lane_count, 0:highest_order)
      !! cos(phi/2), as half_sine [-]
      real(wp) :: s(lane_count, 0:highest_order)
      !! arm of gravity over R; sin(alpha - phi) for a rocking wall [-]
      real(wp) :: c(lane_count, 0:highest_order)
      !! arm of the ground's inertia force over R; cos(alpha - phi) for a rocking wall [-]
      real(wp) :: u(lane_count, 0:highest_order)
      !! displacement of the frame away from the pivot, over R [-]
      real(wp) :: u_rate(lane_count, 0:highest_order)
      !! u' [1/s]
      real(wp) :: j(lane_count, 0:highest_order)
      !! du/dphi [-]
      real(wp) :: j_rate(lane_count, 0:highest_order)
      !! rate of j beside a link without tilt [1/s]
      real(wp) :: bias(lane_count, 0:highest_order)
      !! u'' - j phi'', the acceleration of the frame for phi'' = 0, over R [1/s2]
      real(wp) :: lever(lane_count, 0:highest_order)
      !! arm of the link's force, over R [-]
      real(wp) :: inertia(lane_count, 0:highest_order)
      !! [-]
      real(wp) :: moment(lane_count, 0:highest_order)
      !! moment away from the base [1/s2]
      real(wp) :: wall_moment(lane_count, 0:highest_order)
      !! part of the wall's weight and inertia in the moment [1/s2]
      real(wp) :: roof_force(lane_count, 0:highest_order)
      !! force of storeys on the wall over m_w R [1/s2]
      real(wp) :: column_push(lane_count, 0:highest_order)
      !! push of their leaning column at the roof over m_w R [1/s2]
      real(wp) :: force(lane_count, 0:highest_order)
      !! force of the frame with one mass at the link, over m_s R [1/s2]
      real(wp) :: turn(lane_count, 0:highest_order)
      !! phi'' [rad/s2]
      type(law_series_t) :: laws
   end type series_motion_t

contains

   !> Set the series of the ground motion of all lanes.
   pure subroutine set_ground(order, ground, upward, motion)
      integer, intent(in) :: order
      !! highest power
      real(wp), intent(in) :: ground(0:order)
      !! horizontal acceleration [m/s2]
      real(wp), intent(in) :: upward(0:order)
      !! vertical acceleration [m/s2]
      type(series_motion_t), intent(inout) :: motion
      integer :: n

      motion%ground_order = order
      motion%ground = 0
      motion%upward = 0
      do n = 0, order
         motion%ground(:, n) = ground(n)
         motion%upward(:, n) = upward(n)
      end do
   end subroutine set_ground

   !> Coefficient n of the product of two series. Even and odd terms have separate sums, which the
   !> processor computes side by side.
   pure function product_of(n, a, b) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(lane_count, 0:n), b(lane_count, 0:n)
      !! coefficients of the series
      real(wp) :: c(lane_count)
      real(wp) :: odd(lane_count)
      integer :: i, k

      do i = 1, lane_count
         c(i) = a(i, 0)*b(i, n)
         odd(i) = 0
      end do
      do k = 1, n - 1, 2
         do i = 1, lane_count
            odd(i) = odd(i) + a(i, k)*b(i, n - k)
            c(i) = c(i) + a(i, k + 1)*b(i, n - k - 1)
         end do
      end do
      if (modulo(n, 2) == 1) odd = odd + a(:, n)*b(:, 0)
      c = c + odd
   end function product_of

   !> Coefficient n of a/b, with the coefficients below n of the quotient.
   pure function quotient_of(n, a, b, quotient) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(lane_count)
      !! coefficient n of a, in the unit of a
      real(wp), intent(in) :: b(lane_count, 0:n), quotient(lane_count, 0:n)
      !! coefficients of the series
      real(wp) :: c(lane_count)
      integer :: i, k

      c = a
      do k = 1, n
         !$omp simd
         do i = 1, lane_count
            c(i) = c(i) - b(i, k)*quotient(i, n - k)
         end do
      end do
      c = c/b(:, 0)
   end function quotient_of

   !> Coefficient n > 0 of the square root of a, with the coefficients below n of the root.
   pure function root_of(n, a, root) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(lane_count)
      !! coefficient n of a, in the unit of a
      real(wp), intent(in) :: root(lane_count, 0:n)
      !! coefficients of the series
      real(wp) :: c(lane_count)
      integer :: i, k

      c = a
      do k = 1, n - 1
         !$omp simd
         do i = 1, lane_count
            c(i) = c(i) - root(i, k)*root(i, n - k)
         end do
      end do
      c = c/(2*root(:, 0))
   end function root_of

   !> Coefficient n > 0 of a**exponent, with the coefficients below n of the power. Zero if a(0) is.
   pure function power_of(n, a, exponent, power) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(lane_count, 0:n)
      !! coefficients of the series
      real(wp), intent(in) :: exponent(lane_count)
      !! coefficients
      real(wp), intent(in) :: power(lane_count, 0:n)
      !! coefficients of the series
      real(wp) :: c(lane_count)
      integer :: i, k

      c = 0
      do k = 1, n
         !$omp simd
         do i = 1, lane_count
            c(i) = c(i) + (exponent(i)*k - (n - k))*(a(i, k)*power(i, n - k))
         end do
      end do
      do i = 1, lane_count
         if (abs(a(i, 0)) > 0) then
            c(i) = c(i)/(n*a(i, 0))
         else
            c(i) = 0
         end if
      end do
   end function power_of

   !> Expand the kinematics of a wall on a corner or on a hinge, its inertia and weight.
   pure subroutine expand_wall(n, coef, theta, theta_dot, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, wall_coefficients)
      !! coefficients as of `move_wall`
      real(wp), intent(in) :: theta(lane_count), theta_dot(lane_count)
      !! coefficients n of theta [rad] and theta' [rad/s]
      type(series_motion_t), intent(inout) :: motion
      !! with the ground motion
      real(wp) :: versine, fall
      integer :: i

      do i = 1, lane_count
         motion%side(i) = coef(i, 1)
         motion%phi(i, n) = coef(i, 1)*theta(i)
         motion%rate(i, n) = coef(i, 1)*theta_dot(i)
         motion%push(i, n) = coef(i, 1)*motion%ground(i, n)*coef(i, 2)
         motion%inertia(i, n) = 0
      end do
      if (n == 0) then
         do i = 1, lane_count
            motion%half_sine(i, 0) = lane_sine(0.5_wp*motion%phi(i, 0))
            motion%half_cosine(i, 0) = lane_cosine(0.5_wp*motion%phi(i, 0))
            motion%sine(i, 0) = 2*motion%half_sine(i, 0)*motion%half_cosine(i, 0)
            versine = 2*motion%half_sine(i, 0)*motion%half_sine(i, 0)
            motion%cosine(i, 0) = 1 - versine
            fall = coef(i, 3)*motion%sine(i, 0)
            motion%s(i, 0) = coef(i, 4) - (coef(i, 4)*versine + fall)
            motion%u(i, 0) = 2*(coef(i, 5)*versine + fall)
            motion%c(i, 0) = (coef(i, 3) - coef(i, 3)*versine) + coef(i, 4)*motion%sine(i, 0)
            motion%j(i, 0) = 2*((coef(i, 3) - coef(i, 3)*versine) + coef(i, 5)*motion%sine(i, 0))
            motion%lever(i, 0) = 2*((coef(i, 3) - coef(i, 3)*versine) &
               + coef(i, 6)*motion%sine(i, 0))
            motion%inertia(i, 0) = coef(i, 7)
         end do
      else
         do i = 1, lane_count
            motion%sine(i, n) = motion%cosine_rate(i, n - 1)/n
            motion%cosine(i, n) = -motion%sine_rate(i, n - 1)/n
            fall = coef(i, 3)*motion%sine(i, n)
            motion%s(i, n) = coef(i, 4)*motion%cosine(i, n) - fall
            motion%u(i, n) = 2*(fall - coef(i, 5)*motion%cosine(i, n))
            fall = coef(i, 3)*motion%cosine(i, n)
            motion%c(i, n) = fall + coef(i, 4)*motion%sine(i, n)
            motion%j(i, n) = 2*(fall + coef(i, 5)*motion%sine(i, n))
            motion%lever(i, n) = 2*(fall + coef(i, 6)*motion%sine(i, n))
         end do
      end if
      motion%sine_rate(:, n) = product_of(n, motion%sine, motion%rate)
      motion%cosine_rate(:, n) = product_of(n, motion%cosine, motion%rate)
      do i = 1, lane_count
         motion%u_rate(i, n) = 2*(coef(i, 3)*motion%cosine_rate(i, n) &
            + coef(i, 5)*motion%sine_rate(i, n))
         motion%j_rate(i, n) = 2*(coef(i, 5)*motion%cosine_rate(i, n) &
            - coef(i, 3)*motion%sine_rate(i, n))
      end do
      motion%bias(:, n) = product_of(n, motion%j_rate, motion%rate)
      call expand_weight(n, coef, motion)
   end subroutine expand_wall

   !> Set the moment to that of the weight and of the ground motion on the wall.
   pure subroutine expand_weight(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, wall_coefficients)
      !! coefficients as of `move_wall`
      type(series_motion_t), intent(inout) :: motion

      motion%moment(:, n) = -(coef(:, 8)*motion%s(:, n) + pushed(n, motion%c, motion))
      motion%wall_moment(:, n) = motion%moment(:, n)
   end subroutine expand_weight

   !> Coefficient n of a series times the push of the ground [1/s2].
   pure function pushed(n, a, motion) result(c)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: a(lane_count, 0:n)
      !! coefficients of the series
      type(series_motion_t), intent(in) :: motion
      real(wp) :: c(lane_count)
      integer :: k

      c = 0
      do k = 0, min(n, motion%ground_order)
         c = c + motion%push(:, k)*a(:, n - k)
      end do
   end function pushed

   !> Expand the kinematics of a frame without a wall: the rotation of an arm of one metre.
   pure subroutine expand_bare_frame(n, u, u_dot, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: u(lane_count), u_dot(lane_count)
      !! coefficients n of displacement [m] and velocity [m/s]
      type(series_motion_t), intent(inout) :: motion
      !! with the ground motion

      motion%side = 1
      motion%phi(:, n) = u
      motion%rate(:, n) = u_dot
      motion%push(:, n) = motion%ground(:, n)
      motion%u(:, n) = u
      motion%u_rate(:, n) = u_dot
      motion%bias(:, n) = 0
      motion%j(:, n) = merge(1, 0, n == 0)
      motion%lever(:, n) = motion%j(:, n)
      motion%sine(:, n) = 0
      motion%cosine(:, n) = motion%j(:, n)
      motion%inertia(:, n) = 0
      motion%moment(:, n) = 0
   end subroutine expand_bare_frame

   !> Add the tilt of a link of finite length l, Eqs (2), (3), as `tilt_link`. Its end rises by v,
   !> and tilt = l - sqrt(l**2 - v**2).
   pure subroutine expand_link(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, link_coefficients)
      !! coefficients as of `tilt_link`
      type(series_motion_t), intent(inout) :: motion
      integer, parameter :: rise = 1, root = 2, gain = 3, slope = 4, speed = 5, plain = 6, &
         spin = 7, bent = 8
      !! v; sqrt(l**2 - v**2); dv/dphi; d(tilt)/dphi; tilt'; u' without tilt, and its product with
      !! phi'; tilt'' for phi'' = 0
      real(wp) :: tilt(lane_count), top(lane_count)

      associate (of => motion%laws%tilt)
         if (n == 0) then
            of(:, 0, rise) = motion%half_sine(:, 0)*(coef(:, 4)*motion%half_cosine(:, 0) &
               - coef(:, 3)*motion%half_sine(:, 0))
            of(:, 0, root) = sqrt(max(coef(:, 1)**2 - of(:, 0, rise)**2, 0.0_wp))
            tilt = of(:, 0, rise)**2/(coef(:, 1) + of(:, 0, root))
         else
            ! dv/dphi is that of j, so that both have one rate
            of(:, n, rise) = motion%j_rate(:, n - 1)/n
            of(:, n, root) = root_of(n, -product_of(n, of(1, 0, rise), of(1, 0, rise)), &
               of(1, 0, root))
            tilt = -of(:, n, root)
         end if
         of(:, n, gain) = 0.5_wp*(coef(:, 4)*motion%cosine(:, n) - coef(:, 3)*motion%sine(:, n))
         of(:, n, slope) = quotient_of(n, product_of(n, of(1, 0, rise), of(1, 0, gain)), &
            of(1, 0, root), of(1, 0, slope))
         of(:, n, speed) = quotient_of(n, product_of(n, of(1, 0, rise), motion%j_rate), &
            of(1, 0, root), of(1, 0, speed))
         of(:, n, plain) = motion%u_rate(:, n)
         of(:, n, spin) = product_of(n, of(1, 0, plain), motion%rate)
         top = product_of(n, motion%j_rate, motion%j_rate) + product_of(n, of(1, 0, speed), &
            of(1, 0, speed)) - product_of(n, of(1, 0, rise), of(1, 0, spin))
         of(:, n, bent) = quotient_of(n, top, of(1, 0, root), of(1, 0, bent))
         motion%u(:, n) = motion%u(:, n) + coef(:, 2)*tilt
         motion%u_rate(:, n) = motion%u_rate(:, n) + coef(:, 2)*of(:, n, speed)
         motion%bias(:, n) = motion%bias(:, n) + coef(:, 2)*of(:, n, bent)
         motion%j(:, n) = motion%j(:, n) + coef(:, 2)*of(:, n, slope)
         motion%lever(:, n) = motion%j(:, n)
      end associate
   end subroutine expand_link

   !> Add mass, damper and spring of the frame. The force of the spring is linear in the
   !> displacement.
   pure subroutine expand_frame(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, frame_coefficients)
      !! coefficients as of `add_frame`
      type(series_motion_t), intent(inout) :: motion

      motion%force(:, n) = motion%bias(:, n) + coef(:, 2)*motion%u_rate(:, n) &
         + coef(:, 3)*motion%u(:, n) + motion%push(:, n)
      if (n == 0) motion%force(:, 0) = motion%force(:, 0) + motion%side*coef(:, 4)
      motion%inertia(:, n) = motion%inertia(:, n) + coef(:, 1)*product_of(n, motion%lever, motion%j)
      motion%moment(:, n) = motion%moment(:, n) - coef(:, 1)*product_of(n, motion%lever, &
         motion%force)
   end subroutine expand_frame

end module rwmf_model_series_series_motion
