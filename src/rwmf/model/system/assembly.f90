!> Right-hand side of the equation of motion, assembled once per run from the effects of a case.
!>
!> Per unit m_w R**2, with phi = |theta|, f = sigma u_g'' and the kinematics u, j, k of the side:
!>
!>    (4/3 + gamma lever j) phi'' = - gamma lever (k phi'**2 + 2 xi_s omega_s j phi' + omega_s**2 u)
!>                                  - (gamma lever + c) f/R - (g/R) (s + q r)
!>
!> where q r is the moment of the cable. With lever = j = 2c this is Eq. (8) and its mirror image.
module rwmf_model_system_assembly
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_equation, only: cable_at, enter_interval, enter_side, equation_t, &
      frame_displacement, ground, has_further_effects, interval_of, kinematics_at, uplift_demand, &
      renew_coefficients, vertical_ground
   use rwmf_model_kinematics, only: geometry_of
   use rwmf_model_lanes, only: frame_coefficients, lane_motion_t, wall_coefficients
   use rwmf_model_parameters, only: parameters_t
   use rwmf_model_scene, only: add_term, first_wall, force_parts_of, frame_term, scene_t, term_t, &
      through_link
   use rwmf_model_system_contributions, only: choose_contributions
   use rwmf_model_system_placement, only: add_element_terms, place_elements
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_scene_axes, only: share_frame, walls_of
   use rwmf_problem_wall_size, only: half_diagonal
   implicit none
   private

   public :: equation_t, build_equation, parameters_of, enter_interval, enter_side, interval_of
   public :: rhs, rates_at, ground_at, moment_at_rest, second_derivative, kinematics_at, cable_at
   public :: uplift_demand, frame_displacement

contains

   !> Assemble the terms of the equation of motion that a case requires.
   subroutine build_equation(case, motion, equation)
      type(case_t), intent(in) :: case
      !! a valid case whose frame has T_s
      type(motion_t), intent(in), target :: motion
      !! must outlive the equation, which points to it
      type(equation_t), intent(out) :: equation
      type(case_t) :: shared

      if (walls_of(case) == 1) then
         call assemble(case, motion, equation)
      else
         shared = case
         call share_frame(shared)
         call assemble(shared, motion, equation)
      end if
   end subroutine build_equation

   !> Assemble the equation of one wall and its part of the frame.
   subroutine assemble(case, motion, equation)
      type(case_t), intent(in) :: case
      !! a valid case whose frame has T_s
      type(motion_t), intent(in), target :: motion
      type(equation_t), intent(out) :: equation

      equation%has_wall = allocated(case%wall)
      equation%has_frame = allocated(case%frame)
      equation%has_cable = allocated(case%cable)
      equation%motion => motion
      equation%p = parameters_of(case)
      equation%state%frame_slope = equation%p%omega_squared
      equation%has_impacts = .false.
      allocate (equation%scene%terms(0))
      if (equation%has_wall) call add_wall(case, equation)
      if (equation%has_frame) call add_term(equation%scene, term_t(frame_term, &
         n_coef=frame_coefficients, acts=through_link))
      call choose_contributions(case, equation)
      call place_elements(case, equation)
      call add_element_terms(equation)
      equation%n = equation%scene%n
      equation%parts = force_parts_of(equation%scene)
      equation%parts%is_complete = equation%parts%is_complete .and. (equation%has_impacts &
         .or. .not. equation%has_wall) .and. equation%walls == 1
      if (equation%has_wall) equation%parts%has_shear_key = case%wall%shear_key
      allocate (equation%state%coef(1, equation%scene%n_coef))
      equation%state%coef(1, 1) = 1
      call renew_coefficients(equation%model_t, equation%state)
      associate (p => equation%p, &
         pushed => 2*equation%p%gamma*equation%floors%excited_mass_ratio + 1)
         equation%uplift%threshold = p%g*tan(p%alpha)*(1 + p%eta_0)/pushed
         equation%uplift%weight_share = tan(p%alpha)/pushed
      end associate
      equation%state%uplift_acceleration = equation%uplift%threshold
      equation%state%inertia_at_rest = 4.0_wp/3 + 4*equation%p%gamma*equation%p%cos_alpha**2
      if (equation%beam%n > 0) call find_push_gain(equation)
      equation%effects_act_at_rest = equation%has_impacts &
         .and. (has_further_effects(equation) .or. equation%has_bilinear_springs)
   end subroutine assemble

   !> Find the moment of the ground acceleration on a bending wall over that on a rigid wall. The
   !> modes follow the ground and carry most of it.
   subroutine find_push_gain(equation)
      type(equation_t), intent(inout) :: equation
      type(lane_motion_t) :: motion
      real(wp) :: rates(equation%n), still(equation%n), moment(2)
      integer :: i

      still = 0
      do i = 1, 2
         motion%ground = i - 1
         motion%upward = 0
         call lane_rates(equation%scene, equation%state%coef, still, motion, rates)
         moment(i) = motion%moment(1)
      end do
      associate (p => equation%p)
         equation%uplift%push_gain = (moment(1) - moment(2))*equation%state%side*p%R/(p%gamma &
            *equation%floors%excited_mass_ratio*(2*p%cos_alpha) + p%cos_alpha)
      end associate
   end subroutine find_push_gain

   !> Set up the wall: rocking on its corners, or hinged in the middle of its base. About the hinge
   !> its inertia is m_w (4/3 h**2 + b**2/3). One smooth equation then holds for both signs of
   !> theta.
   subroutine add_wall(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      real(wp) :: link
      !! length of the link over R [-]; 0 means infinitely long

      equation%has_impacts = case%wall%base == 'rocking'
      link = 0
      if (allocated(case%link)) link = case%link%L/equation%p%R
      equation%geometry = geometry_of(equation%p%alpha, case%model%formulation, &
         equation%has_impacts, link)
      if (.not. equation%has_impacts) equation%inertia = (4*equation%p%cos_alpha**2 &
         + equation%p%sin_alpha**2)/3
      equation%scene%has_wall = .true.
      equation%scene%n_coef = first_wall + wall_coefficients - 1
   end subroutine add_wall

   !> Parameters of the equation of motion (15). Those of absent effects are zero, which gives (11)
   !> and (12).
   pure type(parameters_t) function parameters_of(case) result(p)
      type(case_t), intent(in) :: case

      p = parameters_t(0, 1, 0, 0, 0, 0, 0, case%model%g)
      if (allocated(case%wall)) then
         p%alpha = atan2(case%wall%b, case%wall%h)
         p%R = half_diagonal(case%wall%h, case%wall%b)
         p%sin_alpha = sin(p%alpha)
         p%cos_alpha = cos(p%alpha)
      end if
      if (allocated(case%frame)) then
         if (allocated(case%frame%gamma) .and. case%frame%is_linked) p%gamma = case%frame%gamma
         p%omega_s = 2*pi/case%frame%T_s
         p%xi_s = case%frame%xi_s
      end if
      if (allocated(case%cable)) then
         p%eta_0 = sum(case%cable%eta_0)
         p%eta_alpha = sum(case%cable%eta_alpha)
      end if
      p%g_over_R = p%g/p%R
      p%two_xi_omega = 2*p%xi_s*p%omega_s
      p%omega_squared = p%omega_s**2
   end function parameters_of

   !> Compute the rates of the first-order form, y' = (theta', theta'', rates of further states).
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

   !> Compute the rates like `rhs`, without counting an evaluation. Events, outputs and the Jacobian
   !> use it.
   subroutine rates_at(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp), intent(out) :: y_dot(equation%n)
      !! (states)

      type(lane_motion_t) :: motion

      call ground_at(equation, t, motion)
      call lane_rates(equation%scene, equation%state%coef, y, motion, y_dot)
   end subroutine rates_at

   !> Evaluate the ground motion for the loops of one lane.
   subroutine ground_at(equation, t, motion)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      type(lane_motion_t), intent(inout) :: motion

      motion%ground = ground(equation, t)
      motion%upward = 0
      if (equation%has_vertical) motion%upward = vertical_ground(equation, t)
   end subroutine ground_at

   !> Compute the moment away from the base and the inertia of the wall, over m_w R**2. They hold at
   !> theta = 0 without velocity and without ground motion.
   subroutine moment_at_rest(scene, coef, at_rest, moment, inertia)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(1, scene%n_coef)
      !! coefficients of the loops, on the side towards which the moment acts
      real(wp), intent(in) :: at_rest(scene%n)
      !! (states) the first two are zero
      real(wp), intent(out) :: moment
      !! [1/s2]
      real(wp), intent(out) :: inertia
      !! [-]
      type(lane_motion_t) :: motion
      real(wp) :: rates(scene%n)

      motion%ground = 0
      motion%upward = 0
      call lane_rates(scene, coef, at_rest, motion, rates)
      moment = motion%moment(1)
      inertia = motion%inertia(1)
   end subroutine moment_at_rest

   !> Angular acceleration theta'' [rad/s2].
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

end module rwmf_model_system_assembly
