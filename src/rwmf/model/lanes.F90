!> Lanes and the kinematics that all effects of a lane share. Lanes are runs of one scene that
!> advance together, each with its own time. The first index of every array is the lane.
!>
!> The module is compiled for one lane, for single runs, and for sixteen (`lane_count`). A lane
!> never depends on the others, so each result is bitwise identical to that of a single run.
!>
!> With phi = |theta| and the displacement |u_s| = R u(phi) of the frame away from the pivot, j =
!> du/dphi and k = dj/dphi. `lever` is the arm of the link's force. By virtual work it equals j,
!> which Eq. (10) of the paper violates (docs/theory/theory.md).
module rwmf_model_lanes
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: lane_count, lane_motion_t, set_ground
   public :: wall_coefficients, frame_coefficients, link_coefficients
   public :: axis_coefficients, line_coefficients, chord_coefficients, rise_coefficients
   public :: move_wall, move_bare_frame, tilt_link, add_frame, cosine, sine
   public :: add_wall_power, add_frame_power
   public :: power_count, of_input, of_viscous, of_plastic, of_bending

#ifdef RWMF_LANES
   integer, parameter :: lane_count = RWMF_LANES
#else
   integer, parameter :: lane_count = 1
#endif

   integer, parameter :: wall_coefficients = 8
   integer, parameter :: frame_coefficients = 4
   integer, parameter :: axis_coefficients = 4
   integer, parameter :: line_coefficients = 4
   !! of each tendon
   integer, parameter :: chord_coefficients = 7
   integer, parameter :: rise_coefficients = 7
   integer, parameter :: link_coefficients = 4

   integer, parameter :: power_count = 4
   integer, parameter :: of_input = 1
   !! power of the ground motion
   integer, parameter :: of_viscous = 2
   !! power dissipated by dampers
   integer, parameter :: of_plastic = 3
   !! power dissipated by smooth hysteresis
   integer, parameter :: of_bending = 4
   !! power dissipated by the dampers of the modes

   !> Motion of the lanes at one instant. Effects add to inertia and moment of the equation
   !> inertia*phi'' = moment, per m_w R**2. For a bare frame u replaces phi, R is 1 and m_s replaces
   !> m_w.
   type :: lane_motion_t
      real(wp) :: ground(lane_count)
      !! horizontal acceleration of the ground [m/s2]
      real(wp) :: upward(lane_count)
      !! vertical acceleration of the ground, positive upward [m/s2]
      real(wp) :: side(lane_count)
      !! +1 or -1, the current side; for a rocking wall the sign of theta
      real(wp) :: push(lane_count)
      !! horizontal acceleration of the ground towards that side, over R [1/s2]
      real(wp) :: phi(lane_count)
      !! [rad]
      real(wp) :: rate(lane_count)
      !! phi' [rad/s]
      real(wp) :: half_sine(lane_count)
      !! sin(phi/2) [-]
      real(wp) :: half_cosine(lane_count)
      !! cos(phi/2) [-]
      real(wp) :: s(lane_count)
      !! arm of gravity over R; sin(alpha - phi) for a rocking wall [-]
      real(wp) :: c(lane_count)
      !! arm of the ground's inertia force over R; cos(alpha - phi) for a rocking wall [-]
      real(wp) :: u(lane_count)
      !! displacement of the frame away from the pivot, over R [-]
      real(wp) :: j(lane_count)
      !! du/dphi [-]
      real(wp) :: k(lane_count)
      !! dj/dphi [-]
      real(wp) :: w_rate(lane_count)
      !! rate of u due to bending alone; set only for a bending wall [1/s]
      real(wp) :: w_bias(lane_count)
      !! acceleration of u due to this rate and the rotation; set as w_rate [1/s2]
      real(wp) :: lever(lane_count)
      !! arm of the link's force, over R [-]
      real(wp) :: inertia(lane_count)
      !! [-]
      real(wp) :: moment(lane_count)
      !! moment away from the base [1/s2]
      logical :: is_bent = .false.
      !! the wall bends, which moves its top by w; behind the arrays, which thus stay aligned
   end type lane_motion_t

contains

   !> Set the acceleration of the ground of all lanes.
   pure subroutine set_ground(motion, ground)
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(in) :: ground(2)
      !! horizontal and vertical [m/s2]

      motion%ground = ground(1)
      motion%upward = ground(2)
   end subroutine set_ground

   !> Compute the kinematics of a wall on a corner or on a hinge, with its own inertia and weight.
   !>
   !> One formula covers all positions of the link and keeps all digits of a small rotation. At the
   !> top corner above the lifting base corner, u = 2 (sin(alpha) - sin(alpha - phi)). At a point
   !> above the pivot, 0 replaces sin(alpha). Such points are the other top corner, and all points
   !> of a hinged wall.
   pure subroutine move_wall(coef, theta, theta_dot, motion)
      real(wp), intent(in) :: coef(lane_count, wall_coefficients)
      !! side; 1/R [1/m]; cos(alpha); three values of sin(alpha), each 0 above the pivot; inertia
      !! over m_w R**2; g/R [1/s2]. The three values are for gravity, for the link's displacement
      !! and for the arm of its force.
      real(wp), intent(in) :: theta(lane_count)
      !! [rad]
      real(wp), intent(in) :: theta_dot(lane_count)
      !! [rad/s]
      type(lane_motion_t), intent(inout) :: motion
      !! on input with the acceleration of the ground
      real(wp) :: x, y, sine_phi, fall, rise
      integer :: i

      !$omp simd private(x, y, sine_phi, fall, rise)
      do i = 1, lane_count
         motion%side(i) = coef(i, 1)
         motion%phi(i) = coef(i, 1)*theta(i)
         motion%rate(i) = coef(i, 1)*theta_dot(i)
         motion%push(i) = coef(i, 1)*motion%ground(i)*coef(i, 2)
         x = sine(0.5_wp*motion%phi(i))
         y = cosine(0.5_wp*motion%phi(i))
         motion%half_sine(i) = x
         motion%half_cosine(i) = y
         ! sin(phi), and cos(alpha) cos(phi)
         sine_phi = 2*x*y
         x = 2*x*x
         fall = coef(i, 3)*sine_phi
         y = coef(i, 3) - coef(i, 3)*x
         motion%s(i) = coef(i, 4) - (coef(i, 4)*x + fall)
         motion%c(i) = y + coef(i, 4)*sine_phi
         rise = 2*(coef(i, 5)*x + fall)
         motion%u(i) = rise
         motion%j(i) = 2*(y + coef(i, 5)*sine_phi)
         motion%k(i) = 2*coef(i, 5) - rise
         motion%lever(i) = 2*(y + coef(i, 6)*sine_phi)
         motion%inertia(i) = coef(i, 7)
         motion%moment(i) = -(coef(i, 8)*motion%s(i) + motion%c(i)*motion%push(i))
      end do
   end subroutine move_wall

   !> Compute the kinematics of a frame without a wall. Its displacement is the rotation of an arm
   !> of one metre.
   pure subroutine move_bare_frame(u, u_dot, motion)
      real(wp), intent(in) :: u(lane_count)
      !! [m]
      real(wp), intent(in) :: u_dot(lane_count)
      !! [m/s]
      type(lane_motion_t), intent(inout) :: motion
      !! on input with the acceleration of the ground
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%side(i) = 1
         motion%phi(i) = u(i)
         motion%rate(i) = u_dot(i)
         motion%push(i) = motion%ground(i)
         motion%half_sine(i) = 0
         motion%half_cosine(i) = 1
         motion%s(i) = 0
         motion%c(i) = 0
         motion%u(i) = u(i)
         motion%j(i) = 1
         motion%k(i) = 0
         motion%lever(i) = 1
         motion%inertia(i) = 0
         motion%moment(i) = 0
      end do
   end subroutine move_bare_frame

   !> Add the tilt of a link of finite length l, Eqs (2), (3). Its end rises by v on a circle, which
   !> adds +-(l - sqrt(l**2 - v**2)) to the displacement.
   pure subroutine tilt_link(coef, motion)
      real(wp), intent(in) :: coef(lane_count, link_coefficients)
      !! l over R [-]; sign of the tilt; 4 cos(alpha) [-]; 4 sin(alpha) [-]. The sign is +1 where
      !! the tilt pushes the frame away and -1 where it pulls the frame back. The last value is 0
      !! with the link above the pivot.
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: v, root, tilt_1
      integer :: i

      !$omp simd private(v, root, tilt_1)
      do i = 1, lane_count
         v = motion%half_sine(i)*(coef(i, 4)*motion%half_cosine(i) - coef(i, 3)*motion%half_sine(i))
         root = sqrt(max(coef(i, 1)*coef(i, 1) - v*v, 0.0_wp))
         ! tilt = l - root gives root*tilt' = v v', to be differentiated twice; v' = k, v'' = -j
         tilt_1 = v*motion%k(i)/root
         motion%u(i) = motion%u(i) + coef(i, 2)*(v*v/(coef(i, 1) + root))
         motion%k(i) = motion%k(i) + coef(i, 2)*((motion%k(i)*motion%k(i) - v*motion%j(i) &
            + tilt_1*tilt_1)/root)
         motion%j(i) = motion%j(i) + coef(i, 2)*tilt_1
         motion%lever(i) = motion%j(i)
      end do
   end subroutine tilt_link

   !> Add mass, damper and spring of the frame. The force of the spring is linear in the
   !> displacement.
   pure subroutine add_frame(coef, motion)
      real(wp), intent(in) :: coef(lane_count, frame_coefficients)
      !! gamma; 2 xi_s omega_s [1/s]; slope of the spring's line over m_s [1/s2]; its force at zero
      !! displacement over m_s R [1/s2]
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: force
      integer :: i

      !$omp simd private(force)
      do i = 1, lane_count
         force = motion%k(i)*motion%rate(i)*motion%rate(i) + coef(i, 2)*(motion%j(i)*motion%rate(i))
         force = force + (coef(i, 3)*motion%u(i) + (motion%side(i)*coef(i, 4) + motion%push(i)))
         motion%inertia(i) = motion%inertia(i) + coef(i, 1)*(motion%lever(i)*motion%j(i))
         motion%moment(i) = motion%moment(i) - coef(i, 1)*(motion%lever(i)*force)
      end do
      if (.not. motion%is_bent) return
      !$omp simd private(force)
      do i = 1, lane_count
         force = motion%w_bias(i) + coef(i, 2)*motion%w_rate(i)
         motion%moment(i) = motion%moment(i) - coef(i, 1)*(motion%lever(i)*force)
      end do
   end subroutine add_frame

   !> Add the power of the ground motion on the wall's mass.
   pure subroutine add_wall_power(weight, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      integer :: i

      !$omp simd
      do i = 1, lane_count
         total(i, of_input) = total(i, of_input) - weight*(motion%c(i)*motion%push(i) &
            *motion%rate(i))
      end do
   end subroutine add_wall_power

   !> Add the powers of the ground motion on the frame's mass, and of its damper.
   pure subroutine add_frame_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, frame_coefficients)
      !! coefficients of `add_frame`
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: rate, share
      integer :: i

      !$omp simd private(rate, share)
      do i = 1, lane_count
         rate = motion%j(i)*motion%rate(i)
         if (motion%is_bent) rate = rate + motion%w_rate(i)
         share = weight*coef(i, 1)*rate
         total(i, of_input) = total(i, of_input) - share*motion%push(i)
         total(i, of_viscous) = total(i, of_viscous) + share*(coef(i, 2)*rate)
      end do
   end subroutine add_frame_power

   !> sin(x) for |x| <= pi/4 from a polynomial, because a library call would prevent vectorisation.
   !> The next term is 5e-17 of the result. Quadruple precision calls the library.
   elemental real(wp) function sine(x)
      real(wp), intent(in) :: x
      !! [rad]
#ifdef RWMF_QUAD

      sine = sin(x)
#else
      real(wp) :: s
      real(wp) :: s_2

      s = x*x
      s_2 = s*s
      sine = x - x*s*((1/6.0_wp - s*(1/120.0_wp)) + s_2*((1/5040.0_wp - s*(1/362880.0_wp)) &
         + s_2*((1/39916800.0_wp - s*(1/6227020800.0_wp)) + s_2*(1/1307674368000.0_wp))))
#endif
   end function sine

   !> cos(x) for |x| <= pi/4 from a polynomial. It is faster than the root of 1 - sin(x)**2.
   elemental real(wp) function cosine(x)
      real(wp), intent(in) :: x
      !! [rad]
#ifdef RWMF_QUAD

      cosine = cos(x)
#else
      real(wp) :: s
      real(wp) :: s_2

      s = x*x
      s_2 = s*s
      cosine = (1 - 0.5_wp*s) + s_2*((1/24.0_wp - s*(1/720.0_wp)) + s_2*((1/40320.0_wp &
         - s*(1/3628800.0_wp)) + s_2*((1/479001600.0_wp - s*(1/87178291200.0_wp)) &
         + s_2*(1/20922789888000.0_wp))))
#endif
   end function cosine

end module rwmf_model_lanes
