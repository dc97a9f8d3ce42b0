!> Right-hand side of the equation of motion, put together once per run from the effects of a case.
!>
!> Per unit m_w R**2, with phi = |theta|, f = sigma u_g'' and the kinematics u, j, k of the side:
!>
!>    (4/3 + gamma lever j) phi'' = - gamma lever (k phi'**2 + 2 xi_s omega_s j phi' + omega_s**2 u)
!>                                  - (gamma lever + c) f/R - (g/R) (s + q r)
!>
!> where q r is the moment of the cable. With lever = j = 2c this is Eq. (8) and its mirror image.
module rwmf_equation
   use rwmf_cable, only: cable_law_t, cable_state_t, linear_cable, no_cable, signed_linear_cable, &
      truss_cable, yielding_cable
   use rwmf_case, only: cable_t, case_t
   use rwmf_coefficients, only: coefficients_a, coefficients_b, paper_t
   use rwmf_extras, only: choose_extras, extra_rates
   use rwmf_kinds, only: i8, pi, wp
   use rwmf_kinematics, only: geometry_t, kinematics_t, left_corner, linked_left_corner, &
      linked_top_corner, pinned_base, published_negative, top_corner
   use rwmf_motion, only: motion_t
   use rwmf_scene, only: cable_at, cable_moment, equation_t, frame_displacement, &
      ground, kinematics_at, lift_off_drive, second_derivative_i
   use rwmf_spring, only: new_spring
   implicit none
   private

   public :: equation_t, build_equation
   public :: rhs, rates_of_state, second_derivative, kinematics_at, cable_at, lift_off_drive
   public :: frame_displacement

contains

   !> Choose the terms that the case calls for.
   subroutine build_equation(case, motion, equation)
      type(case_t), intent(in) :: case
      !! valid, with the frame's T_s given
      type(motion_t), intent(in), target :: motion
      !! outlives the equation
      type(equation_t), intent(out) :: equation

      equation%has_wall = allocated(case%wall)
      equation%has_frame = allocated(case%frame)
      equation%has_cable = allocated(case%cable)
      equation%motion => motion
      equation%p = paper_parameters(case)
      equation%sin_alpha = sin(equation%p%alpha)
      equation%cos_alpha = cos(equation%p%alpha)
      equation%has_impacts = equation%has_wall
      if (equation%has_wall) then
         equation%geometry = geometry_t(equation%sin_alpha, equation%cos_alpha, link=0)
         if (allocated(case%link)) equation%geometry%link = case%link%L/equation%p%R
         equation%has_impacts = case%wall%base == 'rocking'
         call choose_kinematics(case%model%formulation, equation)
         call choose_cable(case, equation)
         if (equation%has_cable) then
            call choose_acceleration(case%model%formulation, case%cable%law, equation)
         else
            call choose_acceleration(case%model%formulation, '', equation)
         end if
         if (.not. equation%has_impacts) call hinge_base(equation)
         call choose_extras(case, equation)
         equation%threshold = equation%p%g*tan(equation%p%alpha)*(1 + equation%p%eta_0) &
            /(1 + 2*equation%p%gamma*equation%push)
         equation%bearing = equation%threshold
         equation%bears_extras = equation%has_impacts &
            .and. (allocated(equation%extras) .or. equation%has_memory)
         if (allocated(equation%extras)) then
            equation%acceleration_positive => with_extras
            equation%acceleration_negative => with_extras
         else if (abs(equation%push - 1) > 0) then
            equation%acceleration_positive => wall_and_frame
            equation%acceleration_negative => wall_and_frame
         end if
      else
         call choose_extras(case, equation)
         equation%acceleration_positive => bare_frame
         if (allocated(equation%extras)) equation%acceleration_positive => frame_with_extras
         equation%acceleration_negative => equation%acceleration_positive
      end if
   end subroutine build_equation

   !> Parameters of Eq. (15); zero where the effect is absent, which is Eqs (11) and (12).
   pure type(paper_t) function paper_parameters(case) result(p)
      type(case_t), intent(in) :: case

      p = paper_t(0, 1, 0, 0, 0, 0, 0, case%model%g)
      if (allocated(case%wall)) then
         p%alpha = atan2(case%wall%b, case%wall%h)
         p%R = hypot(case%wall%h, case%wall%b)
      end if
      if (allocated(case%frame)) then
         if (allocated(case%frame%gamma)) p%gamma = case%frame%gamma
         p%omega_s = 2*pi/case%frame%T_s
         p%xi_s = case%frame%xi_s
      end if
      if (allocated(case%cable)) then
         p%eta_0 = case%cable%eta_0
         p%eta_alpha = case%cable%eta_alpha
      end if
   end function paper_parameters

   !> A wall hinged at the middle of its base: m_w (4/3 h**2 + b**2/3) about the hinge, one smooth
   !> equation for both signs of theta.
   subroutine hinge_base(equation)
      type(equation_t), intent(inout) :: equation

      equation%inertia = (4*equation%cos_alpha**2 + equation%sin_alpha**2)/3
      equation%kinematics_positive => pinned_base
      equation%kinematics_negative => pinned_base
      equation%acceleration_positive => wall_and_frame
      equation%acceleration_negative => wall_and_frame
   end subroutine hinge_base

   subroutine choose_kinematics(formulation, equation)
      character(*), intent(in) :: formulation
      type(equation_t), intent(inout) :: equation

      if (equation%geometry%link > 0) then
         equation%kinematics_positive => linked_top_corner
         equation%kinematics_negative => linked_left_corner
         if (formulation == 'symmetric') equation%kinematics_negative => linked_top_corner
         return
      end if
      equation%kinematics_positive => top_corner
      select case (formulation)
      case ('symmetric')
         equation%kinematics_negative => top_corner
      case ('exact')
         equation%kinematics_negative => left_corner
      case default
         equation%kinematics_negative => published_negative
      end select
   end subroutine choose_kinematics

   subroutine choose_cable(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(cable_law_t) :: unit_law
      type(cable_state_t) :: at_alpha

      equation%cable_law => no_cable
      if (.not. equation%has_cable) return
      equation%cable%eta_0 = case%cable%eta_0
      equation%cable%R = equation%p%R
      equation%cable%h = case%wall%h
      equation%cable%b = case%wall%b
      if (case%cable%law == 'truss') then
         equation%cable_law => truss_cable
         equation%cable%is_straight = .true.
         unit_law = equation%cable
         unit_law%eta_0 = 0
         unit_law%rate = 1
         call truss_cable(unit_law, equation%sin_alpha, equation%p%alpha, 1, at_alpha)
         equation%cable%rate = (case%cable%eta_alpha - case%cable%eta_0)/at_alpha%force
      else
         equation%cable_law => linear_cable
         equation%cable%rate = (case%cable%eta_alpha - case%cable%eta_0)/equation%p%alpha
         if (case%model%formulation == 'published') equation%cable_law => signed_linear_cable
      end if
      if (can_yield(case%cable)) call choose_tendon(case, equation)
   end subroutine choose_cable

   !> Can the cable yield or break?
   pure logical function can_yield(cable)
      type(cable_t), intent(in) :: cable

      can_yield = allocated(cable%eta_y) .or. allocated(cable%rupture_strain)
   end function can_yield

   !> Tendon with the elastic stiffness that eta_0 and eta_alpha say.
   subroutine choose_tendon(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      real(wp) :: stiffness
      !! over m_w g [1/m]
      real(wp) :: yield
      real(wp) :: rupture
      !! elongation since theta = 0 [m]

      stiffness = equation%cable%rate
      if (.not. equation%cable%is_straight) stiffness = stiffness/case%wall%b
      yield = huge(yield)
      if (allocated(case%cable%eta_y)) yield = case%cable%eta_y
      rupture = huge(rupture)
      if (allocated(case%cable%rupture_strain)) then
         rupture = 2*case%wall%h*case%cable%rupture_strain - case%cable%eta_0/stiffness
      end if
      equation%cable%is_tendon = .true.
      equation%cable%tendon = new_spring(stiffness, yield, case%cable%hardening, &
         case%cable%eta_0, is_tendon=.true., rupture=rupture)
      equation%cable_law => yielding_cable
   end subroutine choose_tendon

   subroutine choose_acceleration(formulation, law, equation)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      !! of the cable; '' without one
      type(equation_t), intent(inout) :: equation

      equation%acceleration_negative => wall_and_frame
      equation%acceleration_positive => wall_and_frame
      if (law /= 'truss' .and. equation%geometry%link <= 0 &
          .and. .not. equation%cable%is_tendon) then
         equation%acceleration_positive => corner_linear
         if (formulation == 'symmetric') equation%acceleration_negative => corner_linear
      end if
      if (formulation == 'published') then
         equation%acceleration_negative => published
         equation%acceleration_positive => published
      end if
      if (.not. equation%has_frame) then
         equation%acceleration_negative => wall_alone
         equation%acceleration_positive => wall_alone
      end if
   end subroutine choose_acceleration

   !> First-order form: y' = (theta', theta'', rates of further states).
   subroutine rhs(equation, t, y, y_dot)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: y_dot(:)
      !! (states)

      equation%rhs_evaluations = equation%rhs_evaluations + 1_i8
      call rates_of_state(equation, t, y, y_dot)
   end subroutine rhs

   !> The same without counting.
   subroutine rates_of_state(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: y_dot(:)
      !! (states)

      y_dot(1) = y(2)
      y_dot(2) = second_derivative(equation, t, y)
      if (equation%n > 2) call extra_rates(equation, t, y, y_dot)
   end subroutine rates_of_state

   !> theta'' without counting an evaluation: for events and outputs [rad/s2].
   real(wp) function second_derivative(equation, t, y)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      if (equation%side > 0) then
         second_derivative = equation%acceleration_positive(equation, t, y)
      else
         second_derivative = equation%acceleration_negative(equation, t, y)
      end if
   end function second_derivative

   !> Eq. (15) with the printed coefficients.
   real(wp) function published(equation, t, y)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: C(4)
      !! A_i or B_i

      if (equation%side > 0) then
         C = coefficients_b(equation%p, y(1))
      else
         C = coefficients_a(equation%p, y(1))
      end if
      published = C(1)*y(2)**2 + C(2)*y(2) + C(3)*ground(equation, t) + C(4)
   end function published

   !> Eq. (8), link at the top corner and linear cable (or none): the commonest scene written out,
   !> because calls through pointers would cost as much as the arithmetic.
   real(wp) function corner_linear(equation, t, y) result(theta_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: phi
      real(wp) :: phi_dot
      real(wp) :: half_sine
      real(wp) :: half_cosine
      real(wp) :: lift
      !! sin(alpha) - sin(alpha - phi)
      real(wp) :: c
      !! cos(alpha - phi)

      phi = equation%side*y(1)
      phi_dot = equation%side*y(2)
      half_sine = sin(phi/2)
      half_cosine = cos(phi/2)
      lift = 2*half_sine*(equation%sin_alpha*half_sine + equation%cos_alpha*half_cosine)
      c = equation%cos_alpha - 2*half_sine*(equation%cos_alpha*half_sine &
         - equation%sin_alpha*half_cosine)
      associate (p => equation%p, s => equation%sin_alpha - lift)
         theta_ddot = -(equation%side*(4*p%gamma*c*(s*phi_dot**2 &
            + p%omega_s*(2*p%xi_s*c*phi_dot + p%omega_s*lift)) + p%g/p%R*(s &
            + (p%eta_0 + equation%cable%rate*phi)*equation%sin_alpha)) &
            + (2*p%gamma + 1)*c*ground(equation, t)/p%R)/(equation%inertia + 4*p%gamma*c**2)
      end associate
   end function corner_linear

   !> Wall and frame, any kinematics and cable law.
   real(wp) function wall_and_frame(equation, t, y) result(theta_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t) :: kin
      real(wp) :: phi_dot
      real(wp) :: force
      !! of the frame's spring and damper and the centripetal term, over gamma m_w R [1/s2]

      kin = kinematics_at(equation, y(1))
      phi_dot = equation%side*y(2)
      associate (p => equation%p)
         force = kin%k*phi_dot**2 + 2*p%xi_s*p%omega_s*kin%j*phi_dot + p%omega_s**2*kin%u
         theta_ddot = -(equation%side*(p%gamma*kin%lever*force &
            + p%g/p%R*(kin%s + cable_moment(equation, y(1)))) &
            + (p%gamma*equation%push*kin%lever + kin%c)*ground(equation, t)/p%R) &
            /(equation%inertia + p%gamma*kin%lever*kin%j)
      end associate
   end function wall_and_frame

   !> Wall, with or without frame, and further effects.
   real(wp) function with_extras(equation, t, y) result(theta_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t) :: kin
      real(wp) :: phi_dot
      real(wp) :: inertia
      real(wp) :: moment
      integer :: i

      theta_ddot = 0
      if (equation%is_held) return
      kin = kinematics_at(equation, y(1))
      phi_dot = equation%side*y(2)
      associate (p => equation%p)
         inertia = equation%inertia + p%gamma*kin%lever*kin%j
         moment = -p%gamma*kin%lever*(kin%k*phi_dot**2 + 2*p%xi_s*p%omega_s*kin%j*phi_dot &
            + p%omega_s**2*kin%u) - p%g/p%R*(kin%s + cable_moment(equation, y(1))) &
            - (p%gamma*equation%push*kin%lever + kin%c)*equation%side*ground(equation, t)/p%R
      end associate
      do i = 1, size(equation%extras)
         call equation%extras(i)%add(equation, t, y, kin, inertia, moment)
      end do
      theta_ddot = equation%side*moment/inertia
   end function with_extras

   !> Frame without wall, and further effects: lever arm and inertia are those of a mass.
   real(wp) function frame_with_extras(equation, t, y) result(u_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t) :: kin
      real(wp) :: inertia
      integer :: i

      kin = kinematics_t(s=0.0_wp, c=0.0_wp, u=y(1), j=1.0_wp, k=0.0_wp, k_1=0.0_wp, &
         lever=1.0_wp, lever_1=0.0_wp)
      inertia = 1
      u_ddot = bare_frame(equation, t, y)
      do i = 1, size(equation%extras)
         call equation%extras(i)%add(equation, t, y, kin, inertia, u_ddot)
      end do
      u_ddot = u_ddot/inertia
   end function frame_with_extras

   !> Wall without frame, Eqs (11) and (12).
   real(wp) function wall_alone(equation, t, y) result(theta_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: angle
      !! alpha - phi [rad]

      angle = equation%p%alpha - equation%side*y(1)
      theta_ddot = -0.75_wp/equation%p%R*(cos(angle)*ground(equation, t) &
         + equation%side*equation%p%g*(sin(angle) + cable_moment(equation, y(1))))
   end function wall_alone

   !> Frame without wall: u'' + 2 xi omega u' + omega**2 u = -u_g''; a reduced frame's roof: times
   !> its factor.
   real(wp) function bare_frame(equation, t, y) result(u_ddot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)

      associate (p => equation%p)
         u_ddot = -2*p%xi_s*p%omega_s*y(2) - p%omega_s**2*y(1) - equation%push*ground(equation, t)
      end associate
   end function bare_frame

end module rwmf_equation
