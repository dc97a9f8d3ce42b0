!> Equations of motion as a person writes a program for one of them: the measure for what the
!> kernel's right-hand sides cost (bench/effects.py).
!>
!> Each procedure knows one scene. Whatever does not change during a flight is computed before, once
!> (`hand_t`), and nothing is done twice. Formulas are the printed ones, also where those lose
!> digits of a small rotation that the kernel keeps.
module effects_by_hand
   use rwmf, only: case_t, wp
   use rwmf_core_kinds, only: pi
   use rwmf_problem_shear_frame, only: damping_matrix, roof_factor
   implicit none
   private

   public :: hand_t, hand_i, prepare, follow_loading_direction, choose, mark

   !> Constants of a scene, and what holds during one flight in one interval of the record.
   type :: hand_t
      integer :: n = 2
      !! number of states
      real(wp) :: alpha, sin_alpha, cos_alpha
      real(wp) :: g, g_over_R, three_quarters_over_R
      real(wp) :: gamma, two_gamma, four_gamma, one_plus_two_gamma_over_R, over_R
      real(wp) :: omega_squared, two_xi_omega
      real(wp) :: eta_0, eta_rate
      real(wp) :: inertia
      !! of the wall over m_w R**2, about its pivot
      real(wp) :: truss_rate, two_h, two_h_squared, b_squared, two_h_b
      !! of the straight cable
      real(wp) :: link, link_squared
      !! length over R
      real(wp) :: damper
      real(wp) :: inertance
      real(wp) :: fuse_stiffness, fuse_yield, fuse_hard
      !! moment over m_w R**2: elastic, over sin(phi/2) cos(phi/2); yielding, at 0 and over
      !! sin(phi/2)
      real(wp) :: yield, yield_drop, soft
      !! of the frame, over R: displacement at yield, the rest times omega**2; slope beyond it
      real(wp) :: tendon_0, tendon_rate
      !! force of the yielding tendon
      real(wp) :: ratio_over_R
      !! of the vertical motion
      real(wp) :: t_k, a_k, slope
      !! straight line of the record in force
      real(wp) :: a_p, omega_p
      !! pulse
      real(wp) :: side
      !! +1 or -1
      real(wp) :: hold, over_u_y, exponent
      !! smooth hysteresis of the frame: force of z = 1 over m_s (with a wall 2/R times
      !! that and gamma), velocity of z over u_s' (with a wall over theta' cos(alpha - phi)), n
      real(wp) :: grow_lost, fall_lost
      !! part of |z|**n that is lost while |z| grows and while it falls
      real(wp) :: lost, signed_lost
      !! of both, the one in force, and that times the sign of z
      integer :: floors = 0
      !! number of floors of a frame with all its modes
      real(wp), allocatable :: k(:), over_m(:), offset(:)
      !! stiffness of each storey over m_w, 1/m_i, shear of its branch at no displacement
      real(wp), allocatable :: drag(:, :)
      !! damping, a row in each column: of the floors over their mass, of the roof over m_w
      real(wp) :: two_R, two_over_R
      real(wp) :: push_over_R
      !! (1 + 2 gamma push)/R of a frame of which one mode moves
   end type hand_t

   abstract interface
      !> y_dot of y = (theta, theta', further states of the scene).
      subroutine hand_i(p, t, y, y_dot)
         import :: hand_t, wp
         implicit none
         type(hand_t), intent(in) :: p
         real(wp), intent(in) :: t
         real(wp), intent(in) :: y(p%n)
         real(wp), intent(out) :: y_dot(p%n)
      end subroutine hand_i
   end interface

contains

   !> What the case says, in the constants of the equations.
   subroutine prepare(case, p)
      type(case_t), intent(in) :: case
      type(hand_t), intent(out) :: p
      real(wp) :: R, rise

      p%g = case%model%g
      if (allocated(case%wall)) then
         R = hypot(case%wall%h, case%wall%b)
         p%alpha = atan2(case%wall%b, case%wall%h)
         p%sin_alpha = sin(p%alpha)
         p%cos_alpha = cos(p%alpha)
         p%inertia = 4.0_wp/3
         if (case%wall%base == 'pinned') p%inertia = (4*p%cos_alpha**2 + p%sin_alpha**2)/3
         p%over_R = 1/R
         p%g_over_R = p%g/R
         p%three_quarters_over_R = 0.75_wp/R
         p%two_h = 2*case%wall%h
         p%two_h_squared = p%two_h**2
         p%b_squared = case%wall%b**2
         p%two_h_b = p%two_h*case%wall%b
      end if
      if (allocated(case%frame)) then
         p%omega_squared = (2*pi/case%frame%T_s)**2
         p%two_xi_omega = 2*case%frame%xi_s*2*pi/case%frame%T_s
         if (allocated(case%frame%gamma)) then
            p%gamma = case%frame%gamma
            p%four_gamma = 4*case%frame%gamma
            p%two_gamma = 2*case%frame%gamma
            p%one_plus_two_gamma_over_R = (1 + 2*case%frame%gamma)*p%over_R
         end if
      end if
      if (allocated(case%cable)) then
         p%eta_0 = case%cable%eta_0
         rise = case%cable%eta_alpha - case%cable%eta_0
         p%eta_rate = rise/p%alpha
         p%truss_rate = rise/(sqrt(p%two_h_squared + 2*p%b_squared*(1 - p%cos_alpha) &
            + 2*p%two_h_b*p%sin_alpha) - p%two_h)
      end if
      if (allocated(case%link)) then
         p%link = case%link%L*p%over_R
         p%link_squared = p%link**2
      end if
      call prepare_springs(case, p)
      if (allocated(case%storeys)) call prepare_storeys(case, p)
      if (allocated(case%vertical)) p%ratio_over_R = case%vertical%ratio*p%over_R
      if (allocated(case%inerter)) p%inertance = case%inerter%inertance_over_m_w*p%sin_alpha**2
      if (allocated(case%damper)) p%damper = 4*p%sin_alpha**2*case%damper%c_over_m_w
      if (allocated(case%motion)) then
         if (allocated(case%motion%a_max_g)) p%a_p = case%motion%a_max_g*p%g
         if (allocated(case%motion%omega_p)) p%omega_p = case%motion%omega_p
      end if
   end subroutine prepare

   !> Floors of a frame with all its modes; of one mode what the ground pushes.
   subroutine prepare_storeys(case, p)
      type(case_t), intent(in) :: case
      type(hand_t), intent(inout) :: p
      integer :: i

      associate (frame => case%storeys%frame)
         p%push_over_R = (1 + p%two_gamma*roof_factor(frame, 1))*p%over_R
         if (case%storeys%coupling /= 'full') return
         p%floors = size(frame%m)
         p%two_R = 2/p%over_R
         p%two_over_R = 2*p%over_R
         p%k = frame%k
         p%over_m = 1/frame%m
         p%drag = damping_matrix(frame, case%frame%xi_s)
         do i = 1, p%floors - 1
            p%drag(:, i) = p%drag(:, i)/frame%m(i)
         end do
         allocate (p%offset(p%floors), source=0.0_wp)
      end associate
   end subroutine prepare_storeys

   !> What yields, elastic and on its first plastic branch, where F = F_y + h k (x - x_y).
   subroutine prepare_springs(case, p)
      type(case_t), intent(in) :: case
      type(hand_t), intent(inout) :: p
      real(wp) :: four_b, k

      if (allocated(case%fuse)) then
         four_b = 4*case%wall%b
         associate (fuse => case%fuse)
            k = fuse%eta_y*p%g/fuse%stroke_y*2*p%sin_alpha*p%over_R
            p%fuse_stiffness = k*four_b
            p%fuse_yield = k*fuse%stroke_y*(1 - fuse%hardening)
            p%fuse_hard = k*four_b*fuse%hardening
         end associate
      end if
      if (allocated(case%yielding) .and. .not. allocated(case%storeys)) then
         associate (h => case%yielding%hardening)
            if (case%yielding%law == 'bouc_wen') then
               p%hold = (1 - h)*p%omega_squared*case%yielding%u_y
               p%over_u_y = 1/case%yielding%u_y
               if (allocated(case%wall)) then
                  p%hold = p%two_gamma*p%over_R*p%hold
                  p%over_u_y = 2*p%over_u_y/p%over_R
               end if
               p%exponent = case%yielding%exponent
               p%grow_lost = 1
               p%fall_lost = 1 - 2*case%yielding%beta
            end if
            p%soft = h*p%omega_squared
            p%yield_drop = (1 - h)*p%omega_squared*case%yielding%u_y
            if (allocated(case%wall)) p%yield_drop = p%yield_drop*p%over_R/2
         end associate
      end if
      if (allocated(case%cable)) then
         if (.not. allocated(case%cable%eta_y)) return
         p%tendon_rate = case%cable%hardening*p%eta_rate
         p%tendon_0 = case%cable%eta_y - (case%cable%eta_y - p%eta_0)*case%cable%hardening
      end if
   end subroutine prepare_springs

   !> Smooth hysteresis in the piece of motion that begins: what the signs of theta' and z say.
   subroutine follow_loading_direction(loading_direction, z, p)
      integer, intent(in) :: loading_direction
      !! sign of theta'
      real(wp), intent(in) :: z
      type(hand_t), intent(inout) :: p

      p%lost = p%grow_lost
      if (loading_direction*z < 0) p%lost = p%fall_lost
      p%signed_lost = p%lost
      if (z < 0) p%signed_lost = -p%lost
   end subroutine follow_loading_direction

   !> Program of a scene, by its name.
   subroutine choose(name, right_hand_side)
      character(*), intent(in) :: name
      procedure(hand_i), pointer, intent(out) :: right_hand_side

      select case (name)
      case ('frame')
         right_hand_side => frame
      case ('block')
         right_hand_side => block_alone
      case ('block_linear')
         right_hand_side => block_linear
      case ('block_truss')
         right_hand_side => block_truss
      case ('published')
         right_hand_side => published
      case ('symmetric')
         right_hand_side => symmetric
      case ('exact')
         right_hand_side => exact
      case ('truss')
         right_hand_side => symmetric_truss
      case ('pulse')
         right_hand_side => symmetric_pulse
      case ('link')
         right_hand_side => linked
      case ('pinned')
         right_hand_side => pinned
      case ('damper')
         right_hand_side => damped
      case ('fuse')
         right_hand_side => fused
      case ('fuse_yielding')
         right_hand_side => fused_yielding
      case ('oscillator')
         right_hand_side => frame
      case ('oscillator_yielding')
         right_hand_side => frame_yielding
      case ('yielding')
         right_hand_side => symmetric
      case ('yielding_yielding')
         right_hand_side => symmetric_yielding
      case ('tendon')
         right_hand_side => symmetric
      case ('smooth_1')
         right_hand_side => smooth_1
      case ('smooth_2')
         right_hand_side => smooth_2
      case ('smooth_3')
         right_hand_side => smooth_3
      case ('smooth_n')
         right_hand_side => smooth_n
      case ('frame_smooth_1')
         right_hand_side => frame_smooth_1
      case ('frame_smooth_2')
         right_hand_side => frame_smooth_2
      case ('frame_smooth_3')
         right_hand_side => frame_smooth_3
      case ('frame_smooth_n')
         right_hand_side => frame_smooth_n
      case ('tendon_yielding')
         right_hand_side => tendon_yielding
      case ('inerter')
         right_hand_side => with_inerter
      case ('vertical')
         right_hand_side => with_vertical
      case ('one_mode')
         right_hand_side => with_one_mode
      case ('storeys_2')
         right_hand_side => with_two_storeys
      case ('storeys')
         right_hand_side => with_storeys
      case ('storeys_on_branches')
         right_hand_side => with_storeys_on_branches
      case default
         right_hand_side => null()
      end select
   end subroutine choose

   !> Callgrind ends a section of its counts where this is called.
   subroutine mark()
   end subroutine mark

   !> Linear oscillator, y = (u, u').
   subroutine frame(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%omega_squared*y(1) - (p%a_k + p%slope*(t - p%t_k))
   end subroutine frame

   !> Eqs (11), (12) without a cable.
   subroutine block_alone(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: angle

      angle = p%alpha - p%side*y(1)
      y_dot(1) = y(2)
      y_dot(2) = -p%three_quarters_over_R*(cos(angle)*(p%a_k + p%slope*(t - p%t_k)) &
         + p%side*p%g*sin(angle))
   end subroutine block_alone

   !> Eqs (11), (12).
   subroutine block_linear(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi

      phi = p%side*y(1)
      y_dot(1) = y(2)
      y_dot(2) = -p%three_quarters_over_R*(cos(p%alpha - phi)*(p%a_k + p%slope*(t - p%t_k)) &
         + p%side*p%g*(sin(p%alpha - phi) + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha))
   end subroutine block_linear

   !> Block with a straight cable of length l: force eta_0 + rate (l - 2h), arm dl/dphi.
   subroutine block_truss(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi

      phi = p%side*y(1)
      y_dot(1) = y(2)
      y_dot(2) = -p%three_quarters_over_R*(cos(p%alpha - phi)*(p%a_k + p%slope*(t - p%t_k)) &
         + p%side*p%g*(sin(p%alpha - phi) + truss_moment(p, phi)))
   end subroutine block_truss

   !> Over m_w g R.
   real(wp) function truss_moment(p, phi)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: phi
      real(wp) :: s, c, l

      s = sin(phi)
      c = cos(phi)
      l = sqrt(p%two_h_squared + 2*(p%b_squared*(1 - c) + p%two_h_b*s))
      truss_moment = (p%eta_0 + p%truss_rate*(l - p%two_h))*(p%b_squared*s + p%two_h_b*c)/l &
         *p%over_R
   end function truss_moment

   !> Eq. (15).
   subroutine published(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: s, c, lever

      y_dot(1) = y(2)
      associate (theta => y(1), theta_dot => y(2), a => p%a_k + p%slope*(t - p%t_k))
         if (p%side > 0) then
            s = sin(p%alpha - theta)
            c = cos(p%alpha - theta)
            y_dot(2) = (-p%four_gamma*c*(s*theta_dot**2 + p%two_xi_omega*c*theta_dot &
               + p%omega_squared*(p%sin_alpha - s)) - p%one_plus_two_gamma_over_R*c*a &
               - p%g_over_R*(s + (p%eta_0 + p%eta_rate*theta)*p%sin_alpha)) &
               /(p%inertia + p%four_gamma*c**2)
         else
            lever = p%cos_alpha*cos(theta)
            s = sin(p%alpha + theta)
            c = cos(p%alpha + theta)
            y_dot(2) = (-p%four_gamma*lever*(-s*theta_dot**2 + p%two_xi_omega*c*theta_dot &
               - p%omega_squared*(p%sin_alpha - s)) - (p%two_gamma*lever + c)*p%over_R*a &
               + p%g_over_R*(s + (p%eta_0 + p%eta_rate*theta)*p%sin_alpha)) &
               /(p%inertia + p%four_gamma*lever*c)
         end if
      end associate
   end subroutine published

   !> Eq. (8) and its mirror image.
   subroutine symmetric(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + p%one_plus_two_gamma_over_R*c &
         *(p%a_k + p%slope*(t - p%t_k)))/(p%inertia + p%four_gamma*c**2)
   end subroutine symmetric

   !> The same under a one-sine pulse that begins at t = 0.
   subroutine symmetric_pulse(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + p%one_plus_two_gamma_over_R*c &
         *p%a_p*sin(p%omega_p*t))/(p%inertia + p%four_gamma*c**2)
   end subroutine symmetric_pulse

   !> Eq. (8) and its mirror image with a straight cable.
   subroutine symmetric_truss(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s + truss_moment(p, phi))) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine symmetric_truss

   !> Eq. (8); theta < 0 with the link at the left corner, u_s = 2h sin(theta).
   subroutine exact(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, s, c, j, u

      if (p%side > 0) then
         call symmetric(p, t, y, y_dot)
         return
      end if
      phi = -y(1)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      j = p%cos_alpha*cos(phi)
      u = p%cos_alpha*sin(phi)
      y_dot(1) = y(2)
      y_dot(2) = (p%four_gamma*j*(-u*y(2)**2 - p%two_xi_omega*j*y(2) + p%omega_squared*u) &
         + p%g_over_R*(s + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) &
         - (p%two_gamma*j + c)*p%over_R*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*j**2)
   end subroutine exact

   !> Link of length L at the top corner, Eqs (2), (3).
   subroutine linked(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c, v, v_1, root, tilt_1, u, j, k

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      ! rise of the corner, what the link's tilt adds, and the derivatives by phi
      v = 2*(c - p%cos_alpha)
      v_1 = 2*s
      root = sqrt(p%link_squared - v**2)
      tilt_1 = v*v_1/root
      u = 2*(p%sin_alpha - s) + p%link - root
      j = 2*c + tilt_1
      k = v_1 + (v_1**2 - 2*v*c + tilt_1**2)/root
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%gamma*j*(k*phi_dot**2 + p%two_xi_omega*j*phi_dot &
         + p%omega_squared*u) + p%g_over_R*(s + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) &
         + (p%gamma*j + c)*p%over_R*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%gamma*j**2)
   end subroutine linked

   !> Wall hinged at the middle of its base, u_s = 2h sin(theta).
   subroutine pinned(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: s, c

      s = p%cos_alpha*sin(y(1))
      c = p%cos_alpha*cos(y(1))
      y_dot(1) = y(2)
      y_dot(2) = (p%g_over_R*s - p%four_gamma*c*(-s*y(2)**2 + p%two_xi_omega*c*y(2) &
         + p%omega_squared*s) - p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine pinned

   !> Eq. (8) with viscous dampers under the corners of the base.
   subroutine damped(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) + p%damper*cos(phi/2)**2*phi_dot) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine damped

   !> Eq. (8) with fuses at the corners of the base that stay elastic: stroke 4b sin(phi/2).
   subroutine fused(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) + p%fuse_stiffness*sin(phi/2)*cos(phi/2)) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine fused

   !> The same with fuses that yield.
   subroutine fused_yielding(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) + (p%fuse_yield + &
         p%fuse_hard*sin(phi/2))*cos(phi/2)) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine fused_yielding

   !> Eq. (8) with a frame that yields.
   subroutine symmetric_yielding(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%yield_drop + p%soft*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine symmetric_yielding

   !> Eq. (8) with a tendon that yields.
   subroutine tendon_yielding(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%tendon_0 + p%tendon_rate*phi)*p%sin_alpha)) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2)
   end subroutine tendon_yielding

   !> Eq. (8) with inerters at the corners of the base.
   subroutine with_inerter(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) &
         - p%inertance*sin(phi)*phi_dot**2) &
         + p%one_plus_two_gamma_over_R*c*(p%a_k + p%slope*(t - p%t_k))) &
         /(p%inertia + p%four_gamma*c**2 &
         + 2*p%inertance*(1 + cos(phi)))
   end subroutine with_inerter

   !> Eq. (8) with a vertical motion of the ground, a multiple of the horizontal one.
   subroutine with_vertical(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c, a

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      a = p%a_k + p%slope*(t - p%t_k)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha) + p%ratio_over_R*a*s) &
         + p%one_plus_two_gamma_over_R*c*a)/(p%inertia + p%four_gamma*c**2)
   end subroutine with_vertical

   !> Eq. (8) with a frame after Bouc and Wen, n = 1.
   subroutine smooth_1(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%soft*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%hold*y(3) &
         + p%one_plus_two_gamma_over_R*(p%a_k + p%slope*(t - p%t_k)))) &
         /(p%inertia + p%four_gamma*c**2)
      y_dot(3) = p%over_u_y*c*y(2)*(1 - p%signed_lost*y(3))
   end subroutine smooth_1

   !> The same, n = 2.
   subroutine smooth_2(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%soft*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%hold*y(3) &
         + p%one_plus_two_gamma_over_R*(p%a_k + p%slope*(t - p%t_k)))) &
         /(p%inertia + p%four_gamma*c**2)
      y_dot(3) = p%over_u_y*c*y(2)*(1 - p%lost*y(3)**2)
   end subroutine smooth_2

   !> The same, n = 3.
   subroutine smooth_3(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%soft*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%hold*y(3) &
         + p%one_plus_two_gamma_over_R*(p%a_k + p%slope*(t - p%t_k)))) &
         /(p%inertia + p%four_gamma*c**2)
      y_dot(3) = p%over_u_y*c*y(2)*(1 - p%signed_lost*y(3)**3)
   end subroutine smooth_3

   !> The same, any n.
   subroutine smooth_n(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%soft*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%hold*y(3) &
         + p%one_plus_two_gamma_over_R*(p%a_k + p%slope*(t - p%t_k)))) &
         /(p%inertia + p%four_gamma*c**2)
      y_dot(3) = p%over_u_y*c*y(2)*(1 - p%lost*abs(y(3))**p%exponent)
   end subroutine smooth_n

   !> Oscillator after Bouc and Wen, n = 1.
   subroutine frame_smooth_1(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%soft*y(1) - p%hold*y(3) &
         - (p%a_k + p%slope*(t - p%t_k))
      y_dot(3) = p%over_u_y*y(2)*(1 - p%signed_lost*y(3))
   end subroutine frame_smooth_1

   !> The same, n = 2.
   subroutine frame_smooth_2(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%soft*y(1) - p%hold*y(3) &
         - (p%a_k + p%slope*(t - p%t_k))
      y_dot(3) = p%over_u_y*y(2)*(1 - p%lost*y(3)**2)
   end subroutine frame_smooth_2

   !> The same, n = 3.
   subroutine frame_smooth_3(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%soft*y(1) - p%hold*y(3) &
         - (p%a_k + p%slope*(t - p%t_k))
      y_dot(3) = p%over_u_y*y(2)*(1 - p%signed_lost*y(3)**3)
   end subroutine frame_smooth_3

   !> The same, any n.
   subroutine frame_smooth_n(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%soft*y(1) - p%hold*y(3) &
         - (p%a_k + p%slope*(t - p%t_k))
      y_dot(3) = p%over_u_y*y(2)*(1 - p%lost*abs(y(3))**p%exponent)
   end subroutine frame_smooth_n

   !> Linear oscillator beyond its yield displacement.
   subroutine frame_yielding(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)

      y_dot(1) = y(2)
      y_dot(2) = -p%two_xi_omega*y(2) - p%soft*y(1) - p%yield_drop &
         - (p%a_k + p%slope*(t - p%t_k))
   end subroutine frame_yielding

   !> Eq. (8) with a frame of which one mode moves: the ground pushes more of it than moves.
   subroutine with_one_mode(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, phi_dot, s, c

      phi = p%side*y(1)
      phi_dot = p%side*y(2)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*(s*phi_dot**2 + p%two_xi_omega*c*phi_dot &
         + p%omega_squared*(p%sin_alpha - s)) + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + p%push_over_R*c &
         *(p%a_k + p%slope*(t - p%t_k)))/(p%inertia + p%four_gamma*c**2)
   end subroutine with_one_mode

   !> Two storeys, the upper one linked to the wall: y = (theta, theta', u, v) with its u, v.
   subroutine with_two_storeys(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, s, c, a, v_roof, shear

      phi = p%side*y(1)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      a = p%a_k + p%slope*(t - p%t_k)
      v_roof = p%two_R*c*y(2)
      shear = p%k(2)*(p%side*p%two_R*(p%sin_alpha - s) - y(3))
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*s*y(2)**2 + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%two_over_R*(shear &
         + p%drag(1, 2)*y(4) + p%drag(2, 2)*v_roof) + p%one_plus_two_gamma_over_R*a)) &
         /(p%inertia + p%four_gamma*c**2)
      y_dot(3) = y(4)
      y_dot(4) = (shear - p%k(1)*y(3))*p%over_m(1) - p%drag(1, 1)*y(4) - p%drag(2, 1)*v_roof - a
   end subroutine with_two_storeys

   !> Any number of storeys, the uppermost linked to the wall.
   subroutine with_storeys(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, s, c, a, u_roof, v_roof, shear, above, drag
      integer :: i, j, n

      n = p%floors
      phi = p%side*y(1)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      a = p%a_k + p%slope*(t - p%t_k)
      u_roof = p%side*p%two_R*(p%sin_alpha - s)
      v_roof = p%two_R*c*y(2)
      shear = p%k(1)*y(3)
      do i = 1, n - 1
         drag = p%drag(n, i)*v_roof
         do j = 1, n - 1
            drag = drag + p%drag(j, i)*y(n + 1 + j)
         end do
         if (i < n - 1) then
            above = p%k(i + 1)*(y(3 + i) - y(2 + i))
         else
            above = p%k(n)*(u_roof - y(n + 1))
         end if
         y_dot(2 + i) = y(n + 1 + i)
         y_dot(n + 1 + i) = (above - shear)*p%over_m(i) - drag - a
         shear = above
      end do
      shear = shear + p%drag(n, n)*v_roof
      do j = 1, n - 1
         shear = shear + p%drag(j, n)*y(n + 1 + j)
      end do
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*s*y(2)**2 + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%two_over_R*shear &
         + p%one_plus_two_gamma_over_R*a))/(p%inertia + p%four_gamma*c**2)
   end subroutine with_storeys

   !> The same with storeys on branches, straight lines that do not pass through zero.
   subroutine with_storeys_on_branches(p, t, y, y_dot)
      type(hand_t), intent(in) :: p
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(p%n)
      real(wp), intent(out) :: y_dot(p%n)
      real(wp) :: phi, s, c, a, u_roof, v_roof, shear, above, drag
      integer :: i, j, n

      n = p%floors
      phi = p%side*y(1)
      s = sin(p%alpha - phi)
      c = cos(p%alpha - phi)
      a = p%a_k + p%slope*(t - p%t_k)
      u_roof = p%side*p%two_R*(p%sin_alpha - s)
      v_roof = p%two_R*c*y(2)
      shear = p%offset(1) + p%k(1)*y(3)
      do i = 1, n - 1
         drag = p%drag(n, i)*v_roof
         do j = 1, n - 1
            drag = drag + p%drag(j, i)*y(n + 1 + j)
         end do
         if (i < n - 1) then
            above = p%offset(i + 1) + p%k(i + 1)*(y(3 + i) - y(2 + i))
         else
            above = p%offset(n) + p%k(n)*(u_roof - y(n + 1))
         end if
         y_dot(2 + i) = y(n + 1 + i)
         y_dot(n + 1 + i) = (above - shear)*p%over_m(i) - drag - a
         shear = above
      end do
      shear = shear + p%drag(n, n)*v_roof
      do j = 1, n - 1
         shear = shear + p%drag(j, n)*y(n + 1 + j)
      end do
      y_dot(1) = y(2)
      y_dot(2) = -(p%side*(p%four_gamma*c*s*y(2)**2 + p%g_over_R*(s &
         + (p%eta_0 + p%eta_rate*phi)*p%sin_alpha)) + c*(p%two_over_R*shear &
         + p%one_plus_two_gamma_over_R*a))/(p%inertia + p%four_gamma*c**2)
   end subroutine with_storeys_on_branches

end module effects_by_hand
