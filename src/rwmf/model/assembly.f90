!> Right-hand side of the equation of motion, put together once per run from the effects of a case.
!>
!> Per unit m_w R**2, with phi = |theta|, f = sigma u_g'' and the kinematics u, j, k of the side:
!>
!>    (4/3 + gamma lever j) phi'' = - gamma lever (k phi'**2 + 2 xi_s omega_s j phi' + omega_s**2 u)
!>                                  - (gamma lever + c) f/R - (g/R) (s + q r)
!>
!> where q r is the moment of the cable. With lever = j = 2c this is Eq. (8) and its mirror image.
module rwmf_model_assembly
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_model_cable, only: cable_elongation, linear_cable, no_cable, signed_linear_cable, &
      signed_linear_moment, spring_cable, truss_moment, yielding_moment
   use rwmf_model_contributions, only: are_lines, choose_contributions, is_smooth_hysteresis
   use rwmf_model_effects_tendon, only: has_tendon
   use rwmf_model_equation, only: cable_at, enter_interval, equation_t, frame_displacement, &
      interval_of, kinematics_at, lift_off_drive, right_hand_side_i
   use rwmf_model_hysteresis_bilinear, only: new_spring
   use rwmf_model_hysteresis_spring_set, only: follow_branches
   use rwmf_model_kinematics, only: geometry_t, left_corner, linked_left_corner, &
      linked_pinned_base, linked_top_corner, pinned_base, published_negative, top_corner
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_published, only: published
   use rwmf_model_right_hand_sides, only: bare_frame, corner, corner_with_floors, &
      corner_with_hysteresis, corner_with_lines, frame_with_effects, frame_with_hysteresis, &
      frame_with_lines, hinged, wall_alone, wall_and_frame, with_effects
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: equation_t, build_equation, enter_interval, interval_of
   public :: rhs, rates_at, second_derivative, kinematics_at, cable_at, lift_off_drive
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
      equation%p = parameters_of(case)
      equation%sin_alpha = sin(equation%p%alpha)
      equation%cos_alpha = cos(equation%p%alpha)
      equation%has_impacts = equation%has_wall
      if (equation%has_wall) then
         equation%geometry = geometry_t(equation%sin_alpha, equation%cos_alpha, link=0)
         if (allocated(case%link)) equation%geometry%link = case%link%L/equation%p%R
         equation%has_impacts = case%wall%base == 'rocking'
         call choose_kinematics(case%model%formulation, equation)
         call choose_cable(case, equation)
         call choose_acceleration(case%model%formulation, equation)
         if (.not. equation%has_impacts) call hinge_base(equation)
         call choose_contributions(case, equation)
         equation%effective_mass_ratio = 2*equation%p%gamma*equation%excited_mass_ratio + 1
         equation%threshold = equation%p%g*tan(equation%p%alpha)*(1 + equation%p%eta_0) &
            /equation%effective_mass_ratio
         equation%uplift_acceleration = equation%threshold
         equation%effects_act_at_rest = equation%has_impacts &
            .and. (allocated(equation%effects) .or. equation%has_bilinear_springs)
         if (allocated(equation%effects)) then
            equation%rates_positive => with_effects
            equation%rates_negative => with_effects
            if (equation%has_frame .and. equation%has_impacts) call write_out(equation)
         end if
      else
         call choose_contributions(case, equation)
         equation%rates_positive => bare_frame
         if (allocated(equation%effects)) then
            equation%rates_positive => frame_with_effects
            if (are_lines(equation) .and. .not. allocated(case%storeys)) then
               equation%rates_positive => frame_with_lines
            end if
            if (is_smooth_hysteresis(equation)) equation%rates_positive => frame_with_hysteresis
         end if
         equation%rates_negative => equation%rates_positive
      end if
   end subroutine build_equation

   !> Effects that are straight lines, the smooth hysteresis, or all modes of a frame whose storeys
   !> are straight lines, alone, with the link at the top corner, have their terms written out.
   subroutine write_out(equation)
      type(equation_t), intent(inout) :: equation
      procedure(right_hand_side_i), pointer :: written_out

      if (are_lines(equation)) then
         equation%frame_slope = equation%p%omega_squared
         call follow_branches(equation)
         written_out => corner_with_lines
      else if (equation%floors%below > 0 .and. size(equation%effects) == 1 &
               .and. .not. allocated(equation%floors%laws)) then
         written_out => corner_with_floors
      else if (is_smooth_hysteresis(equation)) then
         written_out => corner_with_hysteresis
      else
         return
      end if
      if (associated(equation%kinematics_positive, top_corner)) then
         equation%rates_positive => written_out
      end if
      if (associated(equation%kinematics_negative, top_corner)) then
         equation%rates_negative => written_out
      end if
   end subroutine write_out

   !> Parameters of Eq. (15); zero where the effect is absent, which is Eqs (11) and (12).
   pure type(parameters_t) function parameters_of(case) result(p)
      type(case_t), intent(in) :: case

      p = parameters_t(0, 1, 0, 0, 0, 0, 0, case%model%g)
      if (allocated(case%wall)) then
         p%alpha = atan2(case%wall%b, case%wall%h)
         p%R = hypot(case%wall%h, case%wall%b)
         p%sin_alpha = sin(p%alpha)
         p%cos_alpha = cos(p%alpha)
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
      p%g_over_R = p%g/p%R
      p%two_xi_omega = 2*p%xi_s*p%omega_s
      p%omega_squared = p%omega_s**2
   end function parameters_of

   !> A wall hinged at the middle of its base: m_w (4/3 h**2 + b**2/3) about the hinge, one smooth
   !> equation for both signs of theta.
   subroutine hinge_base(equation)
      type(equation_t), intent(inout) :: equation

      equation%inertia = (4*equation%cos_alpha**2 + equation%sin_alpha**2)/3
      equation%kinematics_positive => pinned_base
      equation%kinematics_negative => pinned_base
      equation%rates_positive => hinged
      if (equation%geometry%link > 0) then
         equation%kinematics_positive => linked_pinned_base
         equation%kinematics_negative => linked_pinned_base
         equation%rates_positive => wall_and_frame
      end if
      equation%rates_negative => equation%rates_positive
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
      real(wp) :: elongation
      !! at alpha [m]
      real(wp) :: arm

      equation%cable_law => no_cable
      equation%has_plain_cable = .not. equation%has_cable
      if (.not. equation%has_cable) return
      equation%cable%eta_0 = case%cable%eta_0
      equation%cable%R = equation%p%R
      equation%cable%h = case%wall%h
      equation%cable%b = case%wall%b
      if (case%cable%law == 'truss') then
         equation%cable_law => spring_cable
         equation%cable_moment => truss_moment
         equation%cable%is_straight = .true.
         call cable_elongation(equation%cable, equation%p%alpha, elongation, arm)
         equation%cable%rate = (case%cable%eta_alpha - case%cable%eta_0)/elongation
         equation%cable%tendon = new_spring(equation%cable%rate, huge(arm), 0.0_wp, &
            case%cable%eta_0)
      else
         equation%cable_law => linear_cable
         equation%cable%rate = (case%cable%eta_alpha - case%cable%eta_0)/equation%p%alpha
         if (case%model%formulation == 'published') then
            equation%cable_law => signed_linear_cable
            equation%cable_moment => signed_linear_moment
         end if
         equation%has_plain_cable = case%model%formulation /= 'published'
         equation%cable%line_0 = equation%cable%eta_0
         equation%cable%line_rate = equation%cable%rate
      end if
      if (has_tendon(case)) call choose_tendon(case, equation)
   end subroutine choose_cable

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
      equation%cable_law => spring_cable
      equation%cable_moment => yielding_moment
   end subroutine choose_tendon

   subroutine choose_acceleration(formulation, equation)
      character(*), intent(in) :: formulation
      type(equation_t), intent(inout) :: equation

      equation%rates_negative => wall_and_frame
      equation%rates_positive => wall_and_frame
      if (.not. equation%has_frame) then
         equation%rates_positive => wall_alone
         equation%rates_negative => wall_alone
      else if (equation%geometry%link <= 0) then
         equation%rates_positive => corner
         if (formulation == 'symmetric') equation%rates_negative => corner
         if (formulation == 'published') then
            equation%rates_positive => published
            equation%rates_negative => published
         end if
      end if
   end subroutine choose_acceleration

   !> First-order form: y' = (theta', theta'', rates of further states).
   subroutine rhs(equation, t, y, y_dot)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp), intent(out) :: y_dot(equation%n)
      !! (states)

      equation%rhs_evaluations = equation%rhs_evaluations + 1_i8
      call rates_at(equation, t, y, y_dot)
   end subroutine rhs

   !> The same without counting an evaluation: for events, outputs and the Jacobian.
   subroutine rates_at(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp), intent(out) :: y_dot(equation%n)
      !! (states)

      if (equation%side > 0) then
         call equation%rates_positive(equation, t, y, y_dot)
      else
         call equation%rates_negative(equation, t, y, y_dot)
      end if
   end subroutine rates_at

   !> theta'' alone [rad/s2].
   real(wp) function second_derivative(equation, t, y)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp) :: y_dot(equation%n)

      call rates_at(equation, t, y, y_dot)
      second_derivative = y_dot(2)
   end function second_derivative

end module rwmf_model_assembly
