!> Right-hand side of each kind of scene, with the terms that it has and no others.
!> `build_equation` chooses.
module rwmf_model_right_hand_sides
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, ground, hysteresis_t, vertical_ground
   use rwmf_model_kinematics, only: kinematics_t
   implicit none
   private

   public :: bare_frame, corner, corner_with_floors, corner_with_hysteresis, corner_with_lines
   public :: frame_with_effects, frame_with_hysteresis, frame_with_lines
   public :: hinged, kept_part, wall_alone, wall_and_frame, with_effects

contains

   !> Eq. (8), link at the top corner: the commonest scene written out, because a call through a
   !> pointer would cost as much as its arithmetic.
   subroutine corner(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: half_sine
      real(wp) :: lift
      real(wp) :: c

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      phi_dot = equation%side*y(2)
      call half_angle_kinematics(equation, phi, half_sine, lift, c)
      associate (p => equation%p, s => equation%sin_alpha - lift)
         y_dot(2) = -(equation%side*(4*p%gamma*c*(s*phi_dot**2 &
            + p%omega_s*(2*p%xi_s*c*phi_dot + p%omega_s*lift)) + p%g_over_R*(s &
            + cable_now(equation, phi, half_sine))) &
            + (2*p%gamma + 1)*c*ground_now(equation, t)/p%R)/(equation%inertia + 4*p%gamma*c**2)
      end associate
   end subroutine corner

   !> The same with a frame on a branch of its spring and with vertical motion.
   subroutine corner_with_lines(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: half_sine
      real(wp) :: lift
      real(wp) :: c

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      phi_dot = equation%side*y(2)
      call half_angle_kinematics(equation, phi, half_sine, lift, c)
      associate (p => equation%p, s => equation%sin_alpha - lift)
         y_dot(2) = -(equation%side*(4*p%gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
            + equation%frame_slope*lift) + p%g_over_R*(s &
            + cable_now(equation, phi, half_sine))) &
            + (2*p%gamma*c*equation%frame_offset + equation%side*s*vertical_now(equation, t) &
            + equation%effective_mass_ratio*c*ground_now(equation, t))/p%R)/(equation%inertia &
            + 4*p%gamma*c**2)
      end associate
   end subroutine corner_with_lines

   !> The same with a frame whose hysteresis is smooth, which has the third state.
   subroutine corner_with_hysteresis(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: half_sine
      real(wp) :: lift
      real(wp) :: c

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      phi_dot = equation%side*y(2)
      call half_angle_kinematics(equation, phi, half_sine, lift, c)
      associate (p => equation%p, s => equation%sin_alpha - lift, law => equation%hysteresis)
         y_dot(2) = -(equation%side*(4*p%gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
            + equation%frame_slope*lift) + p%g_over_R*(s &
            + cable_now(equation, phi, half_sine))) &
            + c*(2*p%gamma*law%force_at_z1*y(3) + (2*p%gamma + 1)*ground_now(equation, t))/p%R) &
            /(equation%inertia + 4*p%gamma*c**2)
         y_dot(3) = 2*p%R*c*y(2)/law%u_y*kept_part(law, y(3))
      end associate
   end subroutine corner_with_hysteresis

   !> The same with a frame that has all its modes.
   subroutine corner_with_floors(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: phi
      real(wp) :: half_sine
      real(wp) :: lift
      real(wp) :: c
      real(wp) :: side
      real(wp) :: a_g
      !! acceleration of the ground [m/s2]
      real(wp) :: force
      !! of storeys and dampers on it, over m_w [m/s2]

      side = equation%side
      phi = side*y(1)
      call half_angle_kinematics(equation, phi, half_sine, lift, c)
      a_g = ground_now(equation, t)
      associate (p => equation%p, s => equation%sin_alpha - lift, floors => equation%floors)
         call move_floors(floors%below, floors%rows, y(3), y(3 + floors%below), &
            2*p%R*(side*lift), 2*p%R*c*y(2), a_g, y_dot(3), force)
         y_dot(1) = y(2)
         y_dot(2) = -(side*(4*p%gamma*c*s*y(2)**2 + p%g_over_R*(s &
            + cable_now(equation, phi, half_sine))) + c*((2*p%gamma + 1)*a_g + 2*force)/p%R) &
            /(equation%inertia + 4*p%gamma*c**2)
      end associate
   end subroutine corner_with_floors

   !> Rates of the floors below the roof, and the force on it. One loop for the uppermost two.
   ! allow(assumed-size): the caller's array goes on as it is, without a descriptor
   pure subroutine move_floors(n, rows, u, v, u_roof, v_roof, a_g, y_dot, force)
      integer, intent(in) :: n
      !! number of floors below the roof, > 0
      real(wp), intent(in) :: rows(*)
      !! see `floors_t`
      real(wp), intent(in) :: u(n)
      !! their displacements [m]
      real(wp), intent(in) :: v(n)
      !! their velocities [m/s]
      real(wp), intent(in) :: u_roof, v_roof
      !! displacement and velocity of the roof [m], [m/s]
      real(wp), intent(in) :: a_g
      !! acceleration of the ground [m/s2]
      real(wp), intent(inout) :: y_dot(2*n)
      !! rates of u and v
      real(wp), intent(out) :: force
      !! over m_w [m/s2]
      real(wp) :: below, above
      !! displacements of the storeys below and above a floor [m]
      real(wp) :: rate
      integer :: at
      !! constants used so far
      integer :: i, j

      below = u(1)
      at = 7 + 2*n
      do i = 1, n - 1
         above = u(i + 1) - u(i)
         rate = rows(at + 1) - a_g + rows(at + 2)*below + rows(at + 3)*above + rows(at + 4)*v_roof
         do j = 1, n
            rate = rate + rows(at + 4 + j)*v(j)
         end do
         y_dot(i) = v(i)
         y_dot(n + i) = rate
         below = above
         at = at + 4 + n
      end do
      above = u_roof - u(n)
      rate = rows(1) - a_g + rows(2)*below + rows(3)*above + rows(4)*v_roof
      force = rows(5) + rows(6)*above + rows(7)*v_roof
      do j = 1, n
         rate = rate + rows(6 + 2*j)*v(j)
         force = force + rows(7 + 2*j)*v(j)
      end do
      y_dot(n) = v(n)
      y_dot(2*n) = rate
   end subroutine move_floors

   !> Wall without frame, Eqs (11) and (12).
   subroutine wall_alone(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: phi
      real(wp) :: half_sine
      real(wp) :: lift
      real(wp) :: c

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      call half_angle_kinematics(equation, phi, half_sine, lift, c)
      associate (p => equation%p)
         y_dot(2) = -0.75_wp/p%R*(c*ground_now(equation, t) + equation%side*p%g &
            *(equation%sin_alpha - lift + cable_now(equation, phi, half_sine)))
      end associate
   end subroutine wall_alone

   !> The same as `kinematics` says of the top corner: lift = sin(alpha) - sin(alpha - phi) and
   !> c = cos(alpha - phi).
   pure subroutine half_angle_kinematics(equation, phi, half_sine, lift, c)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(out) :: half_sine
      real(wp), intent(out) :: lift
      real(wp), intent(out) :: c
      real(wp) :: half_cosine

      half_sine = sin(phi/2)
      half_cosine = sqrt(1 - half_sine**2)
      associate (sin_alpha => equation%sin_alpha, cos_alpha => equation%cos_alpha)
         lift = 2*half_sine*(sin_alpha*half_sine + cos_alpha*half_cosine)
         c = cos_alpha - 2*half_sine*(cos_alpha*half_sine - sin_alpha*half_cosine)
      end associate
   end subroutine half_angle_kinematics

   !> Ground acceleration of the interval in force [m/s2]: the line of a record without a call.
   real(wp) function ground_now(equation, t)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]

      associate (line => equation%line)
         if (line%is_straight) then
            ground_now = line%a_0 + line%slope*(t - line%t_0)
         else
            ground_now = ground(equation, t)
         end if
      end associate
   end function ground_now

   !> Vertical ground acceleration of the interval in force [m/s2], likewise.
   real(wp) function vertical_now(equation, t)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]

      associate (line => equation%vertical_line)
         if (line%is_straight) then
            vertical_now = line%a_0 + line%slope*(t - line%t_0)
         else
            vertical_now = vertical_ground(equation, t)
         end if
      end associate
   end function vertical_now

   !> Moment of the cable over m_w g R [-]: the linear law, also a tendon's, or none, without a
   !> call.
   real(wp) function cable_now(equation, phi, half_sine) result(moment)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(in) :: half_sine
      !! sin(phi/2)

      if (equation%has_plain_cable) then
         moment = (equation%cable%line_0 + equation%cable%line_rate*phi)*equation%sin_alpha
      else
         moment = equation%cable_moment(equation%cable, equation%sin_alpha, phi, half_sine, &
            equation%side)
      end if
   end function cable_now

   !> Smooth hysteresis: part of the frame's velocity that does not go into plastic flow [-].
   !>
   !> Beyond zero, where only trial states of a step and its search go, a natural power goes on as
   !> it comes: a step sees no corner.
   elemental real(wp) function kept_part(law, z)
      type(hysteresis_t), intent(in) :: law
      real(wp), intent(in) :: z
      !! [-]
      real(wp), parameter :: angle_limit = 1.26_wp
      !! |z| of a trial state that no step keeps; its power of 1000 is a number [-]
      real(wp), parameter :: largest = 1.0e3_wp
      !! of such powers: the next trial state stays a number as well
      real(wp) :: factor
      real(wp) :: power
      integer :: i

      select case (law%factors)
      case (1)
         kept_part = 1 - law%lost*z
      case (2)
         kept_part = 1 - law%lost*min(abs(z), angle_limit)**2
      case (3:)
         factor = max(-angle_limit, min(z, angle_limit))
         power = factor**2
         ! as many factors as are common: no call for the power
         do i = 3, law%factors
            power = power*factor
         end do
         kept_part = 1 - law%lost*power
      case default
         kept_part = 1 - law%lost*min(min(abs(z), angle_limit)**law%exponent, largest)
      end select
   end function kept_part

   !> Kinematics of the side in force.
   subroutine kinematics_of_side(equation, phi, kin)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: phi
      !! [rad]
      type(kinematics_t), intent(out) :: kin

      if (equation%side > 0) then
         call equation%kinematics_positive(equation%geometry, phi, kin)
      else
         call equation%kinematics_negative(equation%geometry, phi, kin)
      end if
   end subroutine kinematics_of_side

   !> Wall, with or without frame, any kinematics and cable law. With the kinematics of Eq. (10) and
   !> the cable of Eq. (1) it equals Eq. (15a), with those of Eq. (4) Eq. (15b).
   subroutine wall_and_frame(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      type(kinematics_t) :: kin
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: force
      !! of the frame's spring and damper and the centripetal term, over gamma m_w R [1/s2]

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      call kinematics_of_side(equation, phi, kin)
      phi_dot = equation%side*y_dot(1)
      associate (p => equation%p)
         force = kin%k*phi_dot**2 + p%two_xi_omega*kin%j*phi_dot + p%omega_squared*kin%u
         y_dot(2) = -(equation%side*(p%gamma*kin%lever*force &
            + p%g_over_R*(kin%s + cable_now(equation, phi, kin%half_sine))) &
            + (p%gamma*kin%lever + kin%c)*ground_now(equation, t)/p%R) &
            /(equation%inertia + p%gamma*kin%lever*kin%j)
      end associate
   end subroutine wall_and_frame

   !> Wall hinged at the middle of its base, with or without frame: `pinned_base` written out.
   subroutine hinged(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      real(wp) :: half_sine
      real(wp) :: sine
      !! of theta times cos(alpha)
      real(wp) :: cosine
      !! likewise

      y_dot(1) = y(2)
      half_sine = sin(y(1)/2)
      sine = 2*equation%cos_alpha*half_sine*sqrt(1 - half_sine**2)
      cosine = equation%cos_alpha*(1 - 2*half_sine**2)
      associate (p => equation%p)
         y_dot(2) = (p%g_over_R*sine - 4*p%gamma*cosine*(p%two_xi_omega*cosine*y(2) &
            + sine*(p%omega_squared - y(2)**2)) - (2*p%gamma + 1)*cosine*ground_now(equation, t) &
            /p%R)/(equation%inertia + 4*p%gamma*cosine**2)
      end associate
   end subroutine hinged

   !> Wall, with or without frame, and further effects.
   subroutine with_effects(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      type(kinematics_t) :: kin
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: inertia
      real(wp) :: moment
      integer :: i

      y_dot(1) = y(2)
      phi = equation%side*y(1)
      phi_dot = equation%side*y(2)
      call kinematics_of_side(equation, phi, kin)
      associate (p => equation%p)
         inertia = equation%inertia + p%gamma*kin%lever*kin%j
         moment = -p%gamma*kin%lever*(kin%k*phi_dot**2 + p%two_xi_omega*kin%j*phi_dot &
            + p%omega_squared*kin%u) - p%g_over_R*(kin%s &
            + cable_now(equation, phi, kin%half_sine)) &
            - (p%gamma*kin%lever + kin%c)*equation%side*ground_now(equation, t)/p%R
      end associate
      do i = 1, size(equation%effects)
         call equation%effects(i)%add(equation, t, y, kin, inertia, moment, y_dot)
      end do
      y_dot(2) = equation%side*moment/inertia
   end subroutine with_effects

   !> Frame without wall, and further effects: lever arm and inertia are those of a mass.
   subroutine frame_with_effects(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)
      type(kinematics_t) :: kin
      real(wp) :: inertia
      real(wp) :: force
      integer :: i

      kin = kinematics_t(half_sine=0.0_wp, half_cosine=1.0_wp, s=0.0_wp, c=0.0_wp, u=y(1), &
         j=1.0_wp, k=0.0_wp, k_1=0.0_wp, &
         lever=1.0_wp, lever_1=0.0_wp)
      inertia = 1
      call bare_frame(equation, t, y, y_dot)
      force = y_dot(2)
      do i = 1, size(equation%effects)
         call equation%effects(i)%add(equation, t, y, kin, inertia, force, y_dot)
      end do
      y_dot(2) = force/inertia
   end subroutine frame_with_effects

   !> Frame without wall on a branch of its spring.
   subroutine frame_with_lines(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)

      y_dot(1) = y(2)
      y_dot(2) = -equation%p%two_xi_omega*y(2) - equation%frame_slope*y(1) - equation%frame_offset &
         - ground_now(equation, t)
   end subroutine frame_with_lines

   !> Frame without wall whose hysteresis is smooth.
   subroutine frame_with_hysteresis(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)

      y_dot(1) = y(2)
      associate (law => equation%hysteresis)
         y_dot(2) = -equation%p%two_xi_omega*y(2) - equation%frame_slope*y(1) - &
            law%force_at_z1*y(3) &
            - ground_now(equation, t)
         y_dot(3) = y(2)/law%u_y*kept_part(law, y(3))
      end associate
   end subroutine frame_with_hysteresis

   !> Frame without wall: u'' + 2 xi omega u' + omega**2 u = -u_g''.
   subroutine bare_frame(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      real(wp), intent(out) :: y_dot(equation%n)

      y_dot(1) = y(2)
      associate (p => equation%p)
         y_dot(2) = -p%two_xi_omega*y(2) - p%omega_squared*y(1) - ground_now(equation, t)
      end associate
   end subroutine bare_frame

end module rwmf_model_right_hand_sides
