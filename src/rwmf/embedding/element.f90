!> The rocking wall as an element of a host program that owns the frame.
!>
!> The host's equation of motion at the link is m u'' + c u' + k u + f(u, u', u'') = -m u_g''.
!> The wall's resisting force f follows from its balance of moments about the pivot. With
!> phi = |theta|, w = sigma u = R u_phi(phi), w' = R j phi' and w'' = R (k phi'**2 + j phi''):
!>
!>    sigma f = m_w/lever [inertia R phi'' + c sigma u_g'' + g (s + q r)]
!>
!> Further effects add R (I phi'' - M) to the bracket. Their loops compute the inertia I and the
!> moment M(phi, phi'). Vertical motion adds v_g'' s.
!>
!> An element is a value: it has no state, needs no destruction, and any number of threads may use
!> it. The host keeps the side (+1 or -1 while the wall rocks, 0 at rest), the displacement and its
!> rates. It finds impact, rest and lift-off with `rwmf_embedding_element_events`.
module rwmf_embedding_element
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_link_rotation, only: find_rotation, slope_of_phi_ddot
   use rwmf_embedding_ranges, only: require_numbers
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_effects_list, only: all_effects
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_equation, only: cable_at, discrete_state_t, enter_side, equation_t, &
      has_further_effects, kinematics_at
   use rwmf_model_impact_rule, only: restitution
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_lanes, only: lane_motion_t, wall_coefficients
   use rwmf_model_scene, only: first_wall, scene_t
   use rwmf_model_system_assembly, only: build_equation
   use rwmf_motion_ground_motion, only: motion_t, piecewise_linear_motion
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   implicit none
   private

   public :: wall_element_t, element_response_t
   public :: create_element, respond, velocity_factor, uplift_demand_of, resting_inertia
   public :: require_element

   !> Wall and cable without frame. Assignment copies an element.
   type :: wall_element_t
      private
      type(equation_t) :: equation
      real(wp) :: m_w = 0
      !! mass of the wall [kg]; 0 before creation
      real(wp) :: vertical_ratio = 0
      !! ratio of the vertical to the horizontal ground acceleration [-]
      real(wp) :: e = 1
      !! velocity factor at impact [-]
      type(scene_t) :: effects
      !! scene with the loops of further effects
      real(wp) :: largest_angle = 0
      !! rotation at which the wall counts as overturned [rad]
   end type wall_element_t

   !> Response of the wall to a motion of the link.
   type :: element_response_t
      real(wp) :: force = 0
      !! resisting force f on the host's degree of freedom [N]
      real(wp) :: stiffness = 0
      !! df/du [N/m]
      real(wp) :: damping = 0
      !! df/du' [N s/m]
      real(wp) :: mass = 0
      !! df/du'' [kg]
      real(wp) :: theta = 0
      !! rotation [rad]
      real(wp) :: theta_dot = 0
      !! [rad/s]
      real(wp) :: theta_ddot = 0
      !! [rad/s2]
      real(wp) :: cable = 0
      !! tension [N]
   end type element_response_t

contains

   !> Create an element from a case with `&wall` and any effects that allow an element.
   !>
   !> `&frame` provides only the mass ratio for the rule 'coupled'; the period of the frame is
   !> unused. Fails with `err_input`.
   subroutine create_element(element, case, error)
      type(wall_element_t), intent(out) :: element
      type(case_t), intent(in) :: case
      !! valid case
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: wall_alone
      type(motion_t), target :: none

      call check_element(case, error)
      if (allocated(error)) return
      wall_alone = case
      if (allocated(wall_alone%frame)) deallocate (wall_alone%frame)
      if (allocated(wall_alone%upward)) then
         if (allocated(case%upward%ratio)) element%vertical_ratio = case%upward%ratio
         deallocate (wall_alone%upward)
      end if
      none = piecewise_linear_motion([real(wp) ::], [real(wp) ::])
      call build_equation(wall_alone, none, element%equation)
      element%equation%motion => null()
      element%m_w = 1
      if (allocated(case%wall%m_w)) element%m_w = case%wall%m_w
      element%e = restitution(case, element%equation%p%alpha)
      element%effects = element%equation%scene
      element%effects%terms = pack(element%effects%terms, element%effects%terms%effect > 0)
      element%largest_angle = case%model%overturning_angle
   end subroutine create_element

   !> Check that a case has a wall, and no effect that an element cannot have.
   subroutine check_element(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      type(case_group_t), allocatable :: effects(:)
      logical :: is_beyond
      integer :: i

      if (.not. allocated(case%wall)) then
         call fail(error, err_input, 'an element needs the group &wall')
         return
      end if
      effects = all_effects()
      do i = 1, size(effects)
         if (effects(i)%no_element == '') cycle
         is_beyond = effects(i)%is_present(case)
         if (is_beyond .and. associated(effects(i)%is_beyond_element)) is_beyond &
            = effects(i)%is_beyond_element(case)
         if (.not. is_beyond) cycle
         call fail(error, err_input, 'an element has no '//trim(effects(i)%no_element))
         return
      end do
   end subroutine check_element

   !> Compute force and tangents at a motion of the link.
   !>
   !> The displacement may lie slightly on the wrong side of zero: trial states of a host do so
   !> before the host has located the impact. Fails with `err_input` and a zero `response` if the
   !> wall cannot reach this displacement. The same holds for numbers that are not finite or exceed
   !> 1e30 in size.
   subroutine respond(element, side, u, u_dot, u_ddot, u_g_ddot, response, error)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      !! +1 or -1: the side on which the wall rocks; ignored for a hinged wall
      real(wp), intent(in) :: u
      !! displacement of the link relative to the ground [m]
      real(wp), intent(in) :: u_dot
      !! [m/s]
      real(wp), intent(in) :: u_ddot
      !! [m/s2]
      real(wp), intent(in) :: u_g_ddot
      !! ground acceleration [m/s2]
      type(element_response_t), intent(out) :: response
      type(error_t), allocatable, intent(out) :: error
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      type(element_response_t) :: found
      real(wp) :: phi
      real(wp) :: rates(2)
      !! phi' [rad/s], phi'' [rad/s2]
      integer :: s
      !! side whose kinematics apply

      call require_element(element, error)
      call require_side(element, side, error)
      call require_numbers([u, u_dot, u_ddot, u_g_ddot], &
         [character(8) :: 'u', 'u_dot', 'u_ddot', 'u_g_ddot'], error)
      if (allocated(error)) return
      s = side_of(element, side)
      call find_rotation(element%equation, element%largest_angle, s, s*u, phi, kin, error)
      if (allocated(error)) return
      cable = cable_at(element%equation, s*phi, s)
      associate (R => element%equation%p%R)
         rates(1) = s*u_dot/(R*kin%j)
         rates(2) = (s*u_ddot/R - kin%k*rates(1)**2)/kin%j
      end associate
      call fill_force(element, kin, cable, rates, s*u_g_ddot, found)
      call add_effects(element, s, kin, [phi, rates], element%vertical_ratio*u_g_ddot, found)
      found%force = s*found%force
      found%theta = s*phi
      found%theta_dot = s*rates(1)
      found%theta_ddot = s*rates(2)
      if (.not. all(ieee_is_finite([found%force, found%stiffness, found%damping, found%mass, &
         found%theta_dot, found%theta_ddot, found%cable]))) then
         call fail(error, err_input, 'the force at this motion of link and ground is not a ' &
            //'finite number')
         return
      end if
      response = found
   end subroutine respond

   !> Check that an element has been created.
   pure subroutine require_element(element, error)
      type(wall_element_t), intent(in) :: element
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` if it has not

      if (allocated(error) .or. element%m_w > 0) return
      call fail(error, err_input, 'no element: it was never created')
   end subroutine require_element

   !> Check that a side is one on which the wall can rock.
   pure subroutine require_side(element, side, error)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (abs(side_of(element, side)) == 1) return
      call fail(error, err_input, 'the side of a rocking wall is 1 or -1; at rest it only holds')
   end subroutine require_side

   !> Side whose kinematics apply: a hinged wall uses those of +1 for both signs of theta.
   pure integer function side_of(element, side)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side

      side_of = side
      if (.not. element%equation%has_impacts) side_of = 1
   end function side_of

   !> Compute force and tangents in the direction of the motion (sigma f against sigma u).
   pure subroutine fill_force(element, kin, cable, rates, ground, response)
      type(wall_element_t), intent(in) :: element
      type(kinematics_t), intent(in) :: kin
      type(cable_state_t), intent(in) :: cable
      real(wp), intent(in) :: rates(2)
      !! phi' [rad/s], phi'' [rad/s2]
      real(wp), intent(in) :: ground
      !! sigma u_g'' [m/s2]
      type(element_response_t), intent(inout) :: response
      real(wp) :: inertia
      !! moment of inertia of the wall about its pivot over m_w R [m]
      real(wp) :: unit
      !! [kg]
      real(wp) :: by_phi
      !! derivative of phi'' by phi at fixed w', w'' [1/s2]

      associate (p => element%equation%p, phi_dot => rates(1), phi_ddot => rates(2))
         inertia = element%equation%inertia*p%R
         unit = element%m_w/kin%lever
         response%force = unit*(inertia*phi_ddot + kin%c*ground + p%g*(kin%s + cable%moment))
         by_phi = slope_of_phi_ddot(kin, rates)
         response%stiffness = (unit*(inertia*by_phi + kin%s*ground + p%g*(cable%moment_1 - kin%c)) &
            - kin%lever_1/kin%lever*response%force)/(p%R*kin%j)
         response%damping = -unit*inertia*2*kin%k*phi_dot/(p%R*kin%j**2)
         response%mass = unit*inertia/(p%R*kin%j)
         response%cable = element%m_w*p%g*cable%force
      end associate
   end subroutine fill_force

   !> Add vertical motion and further effects to force and tangents.
   !>
   !> The derivatives of further effects by phi and phi' are central differences.
   subroutine add_effects(element, side, kin, motion, upward, response)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(in) :: motion(3)
      !! phi [rad], phi' [rad/s], phi'' [rad/s2]
      real(wp), intent(in) :: upward
      !! v_g'' [m/s2]
      type(element_response_t), intent(inout) :: response
      real(wp), parameter :: step = 1.0e-5_wp
      real(wp) :: here(2), by_phi(2), by_rate(2)
      !! moment [1/s2] and inertia [-], and their derivatives
      real(wp) :: unit
      !! [kg m]
      real(wp) :: moment
      !! moment against the motion [1/s2]
      real(wp) :: moment_1
      !! derivative of the moment by phi at fixed w', w'' [1/s2]

      associate (p => element%equation%p, phi => motion(1), phi_dot => motion(2), &
                 phi_ddot => motion(3))
         unit = element%m_w*p%R/kin%lever
         moment = upward*kin%s/p%R
         moment_1 = -upward*kin%c/p%R
         if (has_further_effects(element%equation)) then
            here = moment_of_effects(element, side, phi, phi_dot)
            by_phi = (moment_of_effects(element, side, phi + step, phi_dot) &
               - moment_of_effects(element, side, phi - step, phi_dot))/(2*step)
            by_rate = (moment_of_effects(element, side, phi, phi_dot + step) &
               - moment_of_effects(element, side, phi, phi_dot - step))/(2*step)
            moment = moment + here(2)*phi_ddot - here(1)
            moment_1 = moment_1 + by_phi(2)*phi_ddot - by_phi(1) &
               + here(2)*slope_of_phi_ddot(kin, motion(2:)) + by_rate(1)*kin%k/kin%j*phi_dot
            response%damping = response%damping - unit*(by_rate(1) &
               + 2*here(2)*kin%k/kin%j*phi_dot)/(p%R*kin%j)
            response%mass = response%mass + unit*here(2)/(p%R*kin%j)
         end if
         response%force = response%force + unit*moment
         response%stiffness = response%stiffness + unit*(moment_1 - kin%lever_1/kin%lever*moment) &
            /(p%R*kin%j)
      end associate
   end subroutine add_effects

   !> Moment of further effects away from the base [1/s2] and their inertia [-], over m_w R**2.
   !>
   !> The loops run for a wall of unit inertia and without weight.
   function moment_of_effects(element, side, phi, phi_dot) result(sums)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp), intent(in) :: phi_dot
      !! [rad/s]
      real(wp) :: sums(2)
      type(discrete_state_t) :: state
      type(lane_motion_t) :: motion
      real(wp) :: rates(2)

      state = element%equation%state
      call enter_side(element%equation%model_t, state, side)
      state%coef(1, first_wall + wall_coefficients - 2:first_wall + wall_coefficients - 1) &
         = [1.0_wp, 0.0_wp]
      motion%ground = 0
      motion%upward = 0
      call lane_rates(element%effects, state%coef, side*[phi, phi_dot], motion, rates)
      sums = [motion%moment(1), motion%inertia(1) - 1]
   end function moment_of_effects

   !> Factor for the velocity of the link at an impact [-].
   !>
   !> It equals that of the rotation, because the kinematics of both sides agree at u = 0. The
   !> result is NaN for an element that was never created.
   pure real(wp) function velocity_factor(element)
      type(wall_element_t), intent(in) :: element

      velocity_factor = element%e
      if (.not. element%m_w > 0) velocity_factor = ieee_value(velocity_factor, ieee_quiet_nan)
   end function velocity_factor

   !> Uplift demand minus uplift capacity of the resting wall towards one side [N].
   !>
   !> A positive value means uplift. A hinged wall has no capacity: any force turns it at once. The
   !> result is NaN for an element that was never created, and for a side other than +1 or -1.
   real(wp) function uplift_demand_of(element, side, push, u_g_ddot) result(drive)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: push
      !! force of the host on the resting wall, positive towards positive u [N]
      real(wp), intent(in) :: u_g_ddot
      !! ground acceleration [m/s2]
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      real(wp) :: effects(2)
      integer :: s
      !! side whose kinematics apply

      drive = ieee_value(drive, ieee_quiet_nan)
      if (abs(side) /= 1 .or. .not. element%m_w > 0) return
      s = side_of(element, side)
      kin = kinematics_at(element%equation, 0.0_wp, s)
      cable = cable_at(element%equation, 0.0_wp, s)
      drive = s*push - element%m_w/kin%lever*(kin%c*s*u_g_ddot &
         + element%equation%p%g*(kin%s + cable%moment))
      drive = drive - element%m_w/kin%lever*element%vertical_ratio*u_g_ddot*kin%s
      effects = moment_of_effects(element, s, 0.0_wp, 0.0_wp)
      drive = s*side*(drive + element%m_w/kin%lever*element%equation%p%R*effects(1))
   end function uplift_demand_of

   !> Inertia that the wall adds to the link at uplift [kg].
   real(wp) function resting_inertia(element)
      type(wall_element_t), intent(in) :: element
      type(kinematics_t) :: kin
      real(wp) :: effects(2)

      kin = kinematics_at(element%equation, 0.0_wp, 1)
      effects = moment_of_effects(element, 1, 0.0_wp, 0.0_wp)
      resting_inertia = element%m_w*(element%equation%inertia + effects(2))/(kin%lever*kin%j)
   end function resting_inertia

end module rwmf_embedding_element
