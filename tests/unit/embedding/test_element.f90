!> The wall as an element: tangents against differences, inverse kinematics, events of a step.
program test_element
   use check, only: checks_t
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_positive_inf, ieee_quiet_nan, &
      ieee_value
   use rwmf, only: case_t, create_element, element_response_t, err_input, error_t, &
      uplift_demand_of, next_impact, next_lift_off, read_case_text, respond, settles, &
      velocity_factor, wall_element_t, wp
   use rwmf_problem_case, only: devices_t, inerter_t
   use scenes, only: rwmf_scene
   implicit none

   character(9), parameter :: formulations(3) = [character(9) :: 'published', 'symmetric', 'exact']
   character(*), parameter :: corners = '&damper c_over_m_w = 3.0 /'//new_line('a') &
      //'&inerter inertance_over_m_w = 1.5 /'//new_line('a') &
      //"&motion kind = 'one_sine', a_max_g = 0.5, omega_p = 5.0 /"//new_line('a') &
      //'&vertical ratio = 0.65 /'
   type(checks_t) :: checks
   integer :: i

   do i = 1, 3
      call test_tangents(trim(formulations(i)), 'linear', '')
      if (i > 1) call test_tangents(trim(formulations(i)), 'truss', '')
      if (i > 1) call test_tangents(trim(formulations(i)), 'linear', '&link L = 6.0 /')
      call test_tangents(trim(formulations(i)), 'linear', corners)
      if (i > 1) call test_tangents(trim(formulations(i)), 'truss', '&link L = 6.0 /'//corners)
   end do
   if (checks%wants('statics')) call test_statics()
   if (checks%wants('impact')) call test_impact()
   if (checks%wants('lift_off')) call test_lift_off()
   if (checks%wants('hinged')) call test_hinged()
   if (checks%wants('period')) call test_period()
   if (checks%wants('default_rule')) call test_default_rule()
   if (checks%wants('bad_calls')) call test_bad_calls()
   if (checks%wants('bad_steps')) call test_bad_steps()
   call checks%finish()

contains

   function element_of(formulation, law, more) result(element)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      character(*), intent(in) :: more
      !! further groups
      type(wall_element_t) :: element
      type(case_t) :: case
      type(error_t), allocatable :: error
      character(*), parameter :: nl = new_line('a')
      character(:), allocatable :: frame

      frame = ''
      if (len(more) > 0) frame = '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'
      call read_case_text('&wall h = 2.0, b = 0.5, m_w = 1.0e4 /'//nl &
         //'&cable eta_0 = 1.0, eta_alpha = 5.0, law = "'//law//'" /'//nl//frame//nl//more//nl &
         //'&impact rule = "constant", e = 0.9 /'//nl &
         //'&model formulation = "'//formulation//'" /'//nl//'&solver t_end = 1.0 /', '', case, &
         error)
      if (.not. allocated(error)) call create_element(element, case, error)
      call checks%no_error(error, 'element '//formulation//' '//law//more)
   end function element_of

   !> Compare the tangents with central differences of the force by u, u' and u''.
   subroutine test_tangents(formulation, law, more)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      character(*), intent(in) :: more
      type(wall_element_t) :: element
      type(element_response_t) :: response
      type(error_t), allocatable :: error
      real(wp) :: motion(3)
      real(wp) :: slope(3)
      integer :: side
      integer :: k

      if (.not. checks%wants('tangents, '//formulation)) return
      element = element_of(formulation, law, more)
      do side = -1, 1, 2
         motion = side*[0.15_wp, -0.8_wp, 3.0_wp]
         call respond(element, side, motion(1), motion(2), motion(3), 1.7_wp, response, error)
         call checks%no_error(error, 'response')
         do k = 1, 3
            slope(k) = difference(element, side, motion, k)
         end do
         ! The difference has a truncation error of 1e-10 and a round-off error of the same size.
         call checks%close_to(response%stiffness, slope(1), formulation//law//more//': stiffness', &
            rtol=1.0e-7_wp)
         call checks%close_to(response%damping, slope(2), formulation//law//more//': damping', &
            rtol=1.0e-7_wp)
         call checks%close_to(response%mass, slope(3), formulation//law//more//': mass', &
            rtol=1.0e-7_wp)
         call checks%that(side*response%theta > 0, 'rotation to the side of the motion')
      end do
   end subroutine test_tangents

   real(wp) function difference(element, side, motion, k) result(slope)
      type(wall_element_t), intent(in) :: element
      integer, intent(in) :: side
      real(wp), intent(in) :: motion(3)
      !! u [m], u' [m/s], u'' [m/s2]
      integer, intent(in) :: k
      !! index of the argument that changes
      type(element_response_t) :: up
      type(element_response_t) :: down
      type(error_t), allocatable :: error
      real(wp) :: step(3)

      step = 0
      step(k) = 1.0e-5_wp
      associate (x => motion + step, y => motion - step)
         call respond(element, side, x(1), x(2), x(3), 1.7_wp, up, error)
         call respond(element, side, y(1), y(2), y(3), 1.7_wp, down, error)
      end associate
      slope = (up%force - down%force)/(2*step(k))
   end function difference

   !> At rest and without motion the force is that of gravity and cable: half the overturning moment
   !> over the height, m_w g tan(alpha)/2 (1 + eta_0).
   subroutine test_statics()
      type(wall_element_t) :: element
      type(element_response_t) :: response
      type(error_t), allocatable :: error
      real(wp) :: expected

      element = element_of('exact', 'linear', '')
      expected = 1.0e4_wp*9.81_wp*0.25_wp/2*2
      call respond(element, 1, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%close_to(response%force, expected, 'static force', rtol=1.0e-13_wp)
      call respond(element, -1, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%close_to(response%force, -expected, 'on the other side', rtol=1.0e-13_wp)
      call checks%close_to(uplift_demand_of(element, 1, expected, 0.0_wp), 0.0_wp, &
         'the push that lifts', atol=1.0e-9_wp*expected)
      ! u = 2h sin(theta) for theta < 0
      call respond(element, -1, -4*sin(0.3_wp), 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%close_to(response%theta, -0.3_wp, 'rotation', rtol=1.0e-14_wp)
      call respond(element, 1, 1.0e-9_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%close_to(response%theta, 1.0e-9_wp/4, 'small rotation', rtol=1.0e-9_wp)
      call checks%close_to(velocity_factor(element), 0.9_wp, 'velocity factor', rtol=1.0e-15_wp)
   end subroutine test_statics

   !> Cubics with known roots.
   subroutine test_impact()
      logical :: found
      real(wp) :: tau

      call next_impact(1, 0.1_wp, 0.02_wp, 0.1_wp, 0.03_wp, 0.1_wp, found, tau)
      call checks%that(.not. found, 'no impact')
      ! u = 0.01 - 4 t**2
      call next_impact(1, 0.1_wp, 0.01_wp, 0.0_wp, -0.03_wp, -0.8_wp, found, tau)
      call checks%that(found, 'impact')
      call checks%close_to(tau, 0.05_wp, 'its time', rtol=1.0e-14_wp)
      ! -u = (t - 0.02) (t - 0.04) is positive again at the end
      call next_impact(-1, 0.1_wp, -0.0008_wp, 0.06_wp, -0.0048_wp, -0.14_wp, found, tau)
      call checks%that(found, 'two returns in one step')
      call checks%close_to(tau, 0.02_wp, 'the first of them', rtol=1.0e-12_wp)
      ! u = 0.5 t - 10 t**2 begins on the base
      call next_impact(1, 0.1_wp, 0.0_wp, 0.5_wp, -0.05_wp, -1.5_wp, found, tau)
      call checks%that(found, 'flight from the base')
      call checks%close_to(tau, 0.05_wp, 'its end', rtol=1.0e-14_wp)
   end subroutine test_impact

   subroutine test_lift_off()
      type(wall_element_t) :: element
      real(wp) :: hold
      !! largest push without uplift [N]
      real(wp) :: tau
      integer :: side

      element = element_of('symmetric', 'linear', '')
      hold = -uplift_demand_of(element, 1, 0.0_wp, 0.0_wp)
      call next_lift_off(element, 0.1_wp, 0.0_wp, 0.9_wp*hold, 0.0_wp, 0.0_wp, side, tau)
      call checks%that(side == 0, 'stays at rest')
      call next_lift_off(element, 0.1_wp, 0.0_wp, -2*hold, 0.0_wp, 0.0_wp, side, tau)
      call checks%that(side == -1, 'lifts off to the left')
      call checks%close_to(tau, 0.05_wp, 'its time', rtol=1.0e-13_wp)
      call next_lift_off(element, 0.1_wp, 2*hold, 3*hold, 0.0_wp, 0.0_wp, side, tau)
      call checks%that(side == 1 .and. tau <= 0, 'at once')
      call next_lift_off(element, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, -9.81_wp, side, tau)
      call checks%that(side == 1, 'by the ground alone')
      call checks%that(settles(element, 0.01_wp, 1.0e-6_wp, 0.0_wp, 0.0_wp, 5.0e4_wp), 'settles')
      call checks%that(.not. settles(element, 0.01_wp, 0.1_wp, 0.0_wp, 0.0_wp, 5.0e4_wp), &
         'too fast to settle')
      call checks%that(.not. settles(element, 0.01_wp, 0.0_wp, 2*hold, 0.0_wp, 5.0e4_wp), &
         'pushed too hard to settle')
   end subroutine test_lift_off

   !> A hinged wall has no sides: the side does not change the response, any push turns the wall,
   !> and it never settles.
   subroutine test_hinged()
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: more(2) = [character(90) :: '', '&link L = 6.0 /'//nl &
         //'&damper c_over_m_w = 3.0 /'//nl//'&inerter inertance_over_m_w = 1.5 /']
      type(wall_element_t) :: element
      type(element_response_t) :: right, left
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: tau
      integer :: side
      integer :: i, k

      do i = 1, size(more)
         call read_case_text("&wall h = 2.0, b = 0.5, m_w = 1.0e4, base = 'pinned' /"//nl &
            //'&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /'//nl//trim(more(i))//nl &
            //"&model formulation = 'exact' /"//nl//'&solver t_end = 1.0 /', '', case, error)
         if (.not. allocated(error)) call create_element(element, case, error)
         call checks%no_error(error, 'hinged wall')
         do k = -1, 1, 2
            call respond(element, 1, 0.3_wp*k, -0.8_wp, 3.0_wp, 1.7_wp, right, error)
            call respond(element, -1, 0.3_wp*k, -0.8_wp, 3.0_wp, 1.7_wp, left, error)
            call checks%no_error(error, 'a hinged wall on the side -1')
            call checks%that(k*right%theta > 0, 'hinged: the side of the displacement')
            call checks%that(all(abs(numbers_of(left) - numbers_of(right)) <= 0), &
               'hinged: the side has no effect')
         end do
         call next_lift_off(element, 0.1_wp, -1.0_wp, -2.0_wp, 0.0_wp, 0.0_wp, side, tau)
         call checks%that(side == -1 .and. tau <= 0, 'hinged: turns at once')
         call checks%close_to(uplift_demand_of(element, 1, 3.0_wp, 1.7_wp), &
            -uplift_demand_of(element, -1, 3.0_wp, 1.7_wp), 'hinged: drive', rtol=1.0e-15_wp)
         call checks%that(.not. settles(element, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, 5.0e4_wp), &
            'hinged: never rests')
      end do
   end subroutine test_hinged

   !> Response of an element as one array.
   pure function numbers_of(response) result(numbers)
      type(element_response_t), intent(in) :: response
      real(wp) :: numbers(8)

      numbers = [response%force, response%stiffness, response%damping, response%mass, &
         response%theta, response%theta_dot, response%theta_ddot, response%cable]
   end function numbers_of

   !> The frame's period has no effect, and `&spectrum` may contain it.
   subroutine test_period()
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: frames(3) = [character(70) :: &
         '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /', &
         '&frame T_s = 0.1, gamma = 5.0, xi_s = 0.5 /', &
         '&frame gamma = 5.0, xi_s = 0.05 /'//nl//'&spectrum T_s = 1.0 /']
      type(wall_element_t) :: element
      type(element_response_t) :: response
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: answers(9, size(frames))
      integer :: i

      do i = 1, size(frames)
         call read_case_text('&wall h = 2.0, b = 0.5 /'//nl//trim(frames(i))//nl &
            //"&impact rule = 'coupled' /"//nl//'&solver t_end = 1.0 /', '', case, error)
         if (.not. allocated(error)) call create_element(element, case, error)
         if (.not. allocated(error)) call respond(element, 1, 0.1_wp, -0.8_wp, 3.0_wp, 1.7_wp, &
            response, error)
         call checks%no_error(error, 'element of '//trim(frames(i)))
         answers(:, i) = [numbers_of(response), velocity_factor(element)]
      end do
      call checks%that(all(abs(answers(:, 2:) - answers(:, [1, 1])) <= 0), &
         'the period of the frame has no effect on the element')
   end subroutine test_period

   !> Without a rule the momentum balance of the case applies: of the wall, and with `&frame` of
   !> its mass too.
   subroutine test_default_rule()
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: frames(2) = [character(50) :: &
         '', '&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /']
      type(wall_element_t) :: element
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: sine
      integer :: i

      sine = sin(atan2(0.5_wp, 2.0_wp))
      do i = 1, size(frames)
         call read_case_text('&wall h = 2.0, b = 0.5 /'//nl//trim(frames(i))//nl//'&impact /' &
            //nl//'&solver t_end = 1.0 /', '', case, error)
         if (.not. allocated(error)) call create_element(element, case, error)
         call checks%no_error(error, 'element without a rule')
         call checks%close_to(velocity_factor(element), &
            1 - 1.5_wp*sine**2/(1 + (i - 1)*15*(1 - sine**2)), 'its factor', rtol=1.0e-15_wp)
      end do
   end subroutine test_default_rule

   !> Invalid steps are refused; without an error argument they report no event and no time.
   subroutine test_bad_steps()
      type(wall_element_t) :: element
      type(wall_element_t) :: none
      type(error_t), allocatable :: error
      real(wp) :: bad(4)
      real(wp) :: tau
      logical :: found
      integer :: side
      integer :: i

      element = element_of('exact', 'linear', '')
      bad = [ieee_value(1.0_wp, ieee_quiet_nan), ieee_value(1.0_wp, ieee_positive_inf), &
         1.0e300_wp, -0.1_wp]
      do i = 1, size(bad)
         call next_impact(1, bad(i), 0.01_wp, -1.0_wp, -0.01_wp, -1.0_wp, found, tau, error)
         call checks%has_error(error, err_input, 'dt = ', 'impact in a step that is none')
         call checks%that(ieee_is_nan(tau) .and. .not. found, 'no impact')
         call next_lift_off(element, bad(i), 0.0_wp, 1.0e6_wp, 0.0_wp, 0.0_wp, side, tau, error)
         call checks%has_error(error, err_input, 'dt = ', 'lift-off in a step that is none')
         call checks%that(ieee_is_nan(tau) .and. side == 0, 'no lift-off')
         found = settles(element, 0.1_wp, 0.0_wp, 0.0_wp, 0.0_wp, bad(i), error)
         call checks%has_error(error, err_input, 'host_mass = ', 'rest on a mass that is none')
         call checks%that(.not. found, 'no rest')
      end do
      call next_impact(2, 0.1_wp, 0.01_wp, -1.0_wp, -0.01_wp, -1.0_wp, found, tau)
      call checks%that(ieee_is_nan(tau) .and. .not. found, 'no side')
      call next_lift_off(none, 0.1_wp, 0.0_wp, 1.0e6_wp, 0.0_wp, 0.0_wp, side, tau, error)
      call checks%has_error(error, err_input, 'never created', 'lift-off of no element')
      bad(1) = uplift_demand_of(element, 0, 1.0_wp, 0.0_wp)
      bad(2) = uplift_demand_of(none, 1, 1.0_wp, 0.0_wp)
      bad(3) = velocity_factor(none)
      call checks%that(all(ieee_is_nan(bad(:3))), 'no side, no element, no number')
   end subroutine test_bad_steps

   subroutine test_bad_calls()
      type(wall_element_t) :: element
      type(element_response_t) :: response
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: nan

      nan = ieee_value(1.0_wp, ieee_quiet_nan)
      call respond(element, 1, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%has_error(error, err_input, 'never created', 'no element')
      case = rwmf_scene('exact', 5.0_wp, 1.0_wp, 'adams')
      call create_element(element, case, error)
      call respond(element, 0, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%has_error(error, err_input, 'side', 'at rest')
      call respond(element, 1, nan, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%has_error(error, err_input, 'u = nan is not a finite', 'motion that is no number')
      call respond(element, 1, 0.0_wp, 1.0e300_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%has_error(error, err_input, 'u_dot = 1.0e300', 'motion of no possible size')
      call checks%that(abs(response%force) <= 0, 'no force')
      call respond(element, 1, 50.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, response, error)
      call checks%has_error(error, err_input, 'more than the wall', 'beyond overturning')
      case%inerter = inerter_t(1.0_wp)
      call create_element(element, case, error)
      call checks%no_error(error, 'inerters')
      case%fuse = devices_t(eta_y=[0.4_wp, 0.4_wp], stroke_y=[0.002_wp, 0.002_wp], &
         hardening=[0.02_wp, 0.02_wp])
      call create_element(element, case, error)
      call checks%has_error(error, err_input, '&fuse', 'fuses')
      deallocate (case%fuse)
      case%impact%rule = 'table'
      call create_element(element, case, error)
      call checks%has_error(error, err_input, "rule = 'table'", 'losses by a table')
      allocate (case%upward, case%upward_record)
      call create_element(element, case, error)
      call checks%has_error(error, err_input, '&vertical', 'vertical record')
      deallocate (case%wall)
      call create_element(element, case, error)
      call checks%has_error(error, err_input, '&wall', 'no wall')
   end subroutine test_bad_calls

end program test_element
