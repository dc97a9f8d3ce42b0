!> The rocking wall as an element of a host program that owns the frame.
!>
!> The host's equation of motion at the link is m u'' + c u' + k u + f(u, u', u'') = -m u_g''. The
!> wall's resisting force f is that of a member with one degree of freedom and no memory.
!>
!> An element is a value: it has no state, needs no destruction, and any number of threads may use
!> it. The host keeps the side (+1 or -1 while the wall rocks, 0 at rest), the displacement and its
!> rates. It passes its motion at both ends of a time step to find impact, rest and lift-off.
!> Numbers that are not finite or exceed 1e30 in size are refused with `err_input`. If the caller
!> omits `error`, the result is then no event, at the time NaN.
module rwmf_embedding_element
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_member, only: create_member, place_t, wall_member_t
   use rwmf_embedding_member_events, only: find_first_uplift
   use rwmf_embedding_member_response, only: find_response, member_response_t
   use rwmf_embedding_ranges, only: not_negative, require_number, require_numbers
   use rwmf_math_cubic, only: cubic_between, falling_root, monotone_pieces, value_at
   use rwmf_model_effects_list, only: all_effects
   use rwmf_model_equation, only: cable_force_at, discrete_state_t, enter_side
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   implicit none
   private

   public :: wall_element_t, element_response_t
   public :: create_element, respond, velocity_factor, uplift_demand_of
   public :: next_impact, next_lift_off, settles

   !> Wall and cable without frame. Assignment copies an element.
   type :: wall_element_t
      private
      type(wall_member_t) :: member
      !! at rest or hinged; its state never changes
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
      call create_member(element%member, case, error)
   end subroutine create_element

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
      type(member_response_t) :: found

      call require_element(element, error)
      if (.not. allocated(error) .and. element%member%equation%has_impacts &
          .and. abs(side) /= 1) then
         call fail(error, err_input, 'the side of a rocking wall is 1 or -1; at rest it only holds')
      end if
      call require_numbers([u, u_dot, u_ddot, u_g_ddot], &
         [character(8) :: 'u', 'u_dot', 'u_ddot', 'u_g_ddot'], error)
      if (allocated(error)) return
      call respond_on_side(element, side, [u, u_dot, u_ddot], u_g_ddot, found, error)
      if (allocated(error)) return
      response = element_response_t(found%force(1), found%stiffness(1, 1), found%damping(1, 1), &
         found%mass(1, 1), found%theta, found%theta_dot, found%theta_ddot)
      associate (equation => element%member%equation)
         if (.not. equation%has_cable) return
         response%cable = element%member%m_w*equation%p%g*cable_force_at(equation, found%theta, &
            side)
      end associate
   end subroutine respond

   !> Check that an element has been created.
   pure subroutine require_element(element, error)
      type(wall_element_t), intent(in) :: element
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` if it has not

      if (allocated(error) .or. element%member%m_w > 0) return
      call fail(error, err_input, 'no element: it was never created')
   end subroutine require_element

   !> Compute the response of the member on a side.
   subroutine respond_on_side(element, side, motion, u_g_ddot, response, error)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      !! +1 or -1 while the wall rocks, 0 at rest; ignored for a hinged wall
      real(wp), intent(in) :: motion(3)
      !! u [m], u' [m/s], u'' [m/s2]
      real(wp), intent(in) :: u_g_ddot
      !! [m/s2]
      type(member_response_t), intent(out) :: response
      type(error_t), allocatable, intent(out) :: error
      type(place_t) :: place
      type(discrete_state_t) :: state

      place = element%member%committed
      state = element%member%committed_state
      if (element%member%equation%has_impacts) then
         place%side = side
         if (side /= 0) call enter_side(element%member%equation%model_t, state, side)
      end if
      call find_response(element%member, place, state, reshape(motion, [1, 3]), &
         [u_g_ddot, 0.0_wp], response, error, has_tangents=place%side /= 0)
   end subroutine respond_on_side

   !> Factor for the velocity of the link at an impact [-].
   !>
   !> It equals that of the rotation, because the kinematics of both sides agree at u = 0. The
   !> result is NaN for an element that was never created.
   pure real(wp) function velocity_factor(element)
      type(wall_element_t), intent(in) :: element

      velocity_factor = element%member%restitution%e
      if (.not. element%member%m_w > 0) velocity_factor = ieee_value(velocity_factor, &
         ieee_quiet_nan)
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
      real(wp) :: drives(2)

      drive = ieee_value(drive, ieee_quiet_nan)
      if (abs(side) /= 1 .or. .not. element%member%m_w > 0) return
      drives = uplift_demands(element, push, u_g_ddot)
      drive = drives(merge(1, 2, side < 0))
   end function uplift_demand_of

   !> Uplift demands minus capacities of the resting wall to the left and to the right [N].
   function uplift_demands(element, push, u_g_ddot) result(drives)
      type(wall_element_t), intent(in) :: element
      real(wp), intent(in) :: push
      !! [N]
      real(wp), intent(in) :: u_g_ddot
      !! [m/s2]
      real(wp) :: drives(2)
      type(member_response_t) :: response
      type(error_t), allocatable :: error

      drives = ieee_value(1.0_wp, ieee_quiet_nan)
      call respond_on_side(element, 0, [0.0_wp, 0.0_wp, 0.0_wp], u_g_ddot, response, error)
      if (allocated(error)) return
      if (.not. element%member%equation%has_impacts) response%hold = response%force(1)
      drives = [response%hold(1) - push, push - response%hold(2)]
   end function uplift_demands

   !> Find the first return of the wall to its base within a step of the host.
   !>
   !> The displacement between the ends is the cubic through values and velocities, which includes
   !> the parabola of Newmark's average acceleration. At the impact the host multiplies the velocity
   !> by `velocity_factor` and changes the side.
   pure subroutine next_impact(side, dt, u_0, u_dot_0, u_1, u_dot_1, found, tau, error)
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: dt
      !! >= 0, length of the step [s]
      real(wp), intent(in) :: u_0
      !! displacement of the link at the beginning of the step [m]
      real(wp), intent(in) :: u_dot_0
      !! velocity at the same instant [m/s]
      real(wp), intent(in) :: u_1
      !! displacement of the link at the end of the step [m]
      real(wp), intent(in) :: u_dot_1
      !! velocity at the same instant [m/s]
      logical, intent(out) :: found
      !! an impact occurs within the step
      real(wp), intent(out) :: tau
      !! time since the beginning; dt without an impact [s]
      type(error_t), allocatable, intent(out), optional :: error
      !! `err_input` for another side, a negative `dt`, or a number that is not finite
      type(error_t), allocatable :: refusal
      real(wp) :: p(0:3)
      !! sigma u as a polynomial of tau/dt [m]
      real(wp) :: ends(0:3)
      integer :: i

      found = .false.
      tau = ieee_value(tau, ieee_quiet_nan)
      if (abs(side) /= 1) call fail(refusal, err_input, 'the side of a rocking wall is 1 or -1')
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([u_0, u_dot_0, u_1, u_dot_1], &
         [character(7) :: 'u_0', 'u_dot_0', 'u_1', 'u_dot_1'], refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      p = side*cubic_between(dt, u_0, u_dot_0, u_1, u_dot_1)
      tau = dt
      ends = monotone_pieces(p)
      do i = 1, 3
         if (value_at(p, ends(i)) < 0) then
            tau = dt*falling_root(p, ends(i - 1), ends(i))
            found = .true.
            return
         end if
      end do
   end subroutine next_impact

   !> Find the first uplift of a resting wall within a step of the host.
   !>
   !> The host's force on the wall and the ground acceleration vary linearly over the step.
   subroutine next_lift_off(element, dt, push_0, push_1, u_g_ddot_0, u_g_ddot_1, side, tau, error)
      type(wall_element_t), intent(in) :: element
      real(wp), intent(in) :: dt
      !! >= 0 [s]
      real(wp), intent(in) :: push_0
      !! force of the host on the wall at the beginning, positive towards positive u [N]
      real(wp), intent(in) :: push_1
      !! force of the host on the wall at the end [N]
      real(wp), intent(in) :: u_g_ddot_0
      !! ground acceleration at the beginning [m/s2]
      real(wp), intent(in) :: u_g_ddot_1
      !! ground acceleration at the end [m/s2]
      integer, intent(out) :: side
      !! side to which the wall lifts off; 0 if it rests throughout
      real(wp), intent(out) :: tau
      !! time since the beginning; dt if the wall rests throughout [s]
      type(error_t), allocatable, intent(out), optional :: error
      !! `err_input` for an element never created, a negative `dt`, or a number that is not finite
      type(error_t), allocatable :: refusal

      side = 0
      tau = ieee_value(tau, ieee_quiet_nan)
      call require_element(element, refusal)
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([push_0, push_1, u_g_ddot_0, u_g_ddot_1], &
         [character(10) :: 'push_0', 'push_1', 'u_g_ddot_0', 'u_g_ddot_1'], refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      call find_first_uplift(dt, reshape([uplift_demands(element, push_0, u_g_ddot_0), &
         uplift_demands(element, push_1, u_g_ddot_1)], [2, 2]), side, tau)
   end subroutine next_lift_off

   !> True if the host may put the wall to rest after an impact.
   !>
   !> A wall that is pressed down on both sides bounces, with flights of duration 2 v e**n/a. If
   !> their sum is shorter than a step, the host cannot resolve them. The error of neglecting them
   !> is of second order in the step. A hinged wall never rests.
   logical function settles(element, dt, u_dot, push, u_g_ddot, host_mass, error)
      type(wall_element_t), intent(in) :: element
      real(wp), intent(in) :: dt
      !! >= 0, step of the host [s]
      real(wp), intent(in) :: u_dot
      !! velocity of the link after the impact [m/s]
      real(wp), intent(in) :: push
      !! force of the host on the wall at rest [N]
      real(wp), intent(in) :: u_g_ddot
      !! [m/s2]
      real(wp), intent(in) :: host_mass
      !! >= 0, mass of the host's degree of freedom at the link [kg]
      type(error_t), allocatable, intent(out), optional :: error
      type(error_t), allocatable :: refusal
      type(member_response_t) :: lifted
      real(wp) :: pull
      !! acceleration towards the base [m/s2]

      settles = .false.
      call require_element(element, refusal)
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([u_dot, push, u_g_ddot], &
         [character(8) :: 'u_dot', 'push', 'u_g_ddot'], refusal)
      call require_number(host_mass, 'host_mass', not_negative, refusal)
      if (.not. allocated(refusal)) call respond_on_side(element, 1, [0.0_wp, 0.0_wp, 0.0_wp], &
         0.0_wp, lifted, refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      pull = -maxval(uplift_demands(element, push, u_g_ddot))/(lifted%mass(1, 1) + host_mass)
      settles = pull > 0 .and. 2*abs(u_dot) <= pull*(1 - velocity_factor(element))*dt
   end function settles

end module rwmf_embedding_element
