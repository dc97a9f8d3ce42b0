!> Reactions of the base against closed forms.
program test_reactions
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use check, only: checks_t
   use reaction_scenes, only: add_storeys, column, scene
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      rates_at
   use rwmf_model_system_reactions, only: reactions_at, reactions_t
   use rwmf_motion_ground_motion, only: interval_at, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, initial_t, output_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_shear_frame, only: modal_mass
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: block_scene, frame_scene
   implicit none

   real(wp), parameter :: round_off = 1.0e-13_wp
   type(checks_t) :: checks

   if (checks%wants('modal_base_shear')) call check_modal_base_shear('full')
   if (checks%wants('modal_base_shear')) call check_modal_base_shear('reduced')
   if (checks%wants('storeys_at_rest')) call check_storeys_at_rest()
   if (checks%wants('static')) call check_static()
   if (checks%wants('at_rest')) call check_at_rest()
   if (checks%wants('friction_limit_at_rest')) call check_friction_limit_at_rest()
   if (checks%wants('free_block')) call check_free_block(0.5_wp, 0.6_wp)
   if (checks%wants('free_block')) call check_free_block(1.6_wp, 0.5_wp)
   if (checks%wants('bare_frame')) call check_bare_frame()
   if (checks%wants('pivot_lifts')) call check_pivot_lifts()
   call checks%finish()

contains

   !> Check the base shear without wall and damping. With all modes it is the sum of M*_j omega_j**2
   !> D_j(t) over the modes (Chopra, section 13.2). With one mode it is the shear of this mode and
   !> the remaining mass times the ground acceleration.
   subroutine check_modal_base_shear(coupling)
      character(*), intent(in) :: coupling
      type(case_t) :: case
      type(case_t) :: mode
      type(result_t) :: result
      type(result_t) :: part
      type(error_t), allocatable :: error
      real(wp), allocatable :: shear(:)
      real(wp), allocatable :: found(:)
      integer :: modes
      integer :: j

      case = frame_scene(1.0_wp, 'dop853')
      call add_storeys(case, coupling)
      case%frame%xi_s = 0
      case%solver%t_end = 3
      case%solver%rtol = 1.0e-11_wp
      case%output = output_t(dt=0.01_wp, energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'base shear of '//coupling)
      modes = merge(3, 1, coupling == 'full')
      associate (frame => case%frame%floors)
         shear = (sum(frame%m) - sum([(modal_mass(frame, j), j=1, modes)])) &
            *column(result, 'u_g_ddot_m_s2')
         do j = 1, modes
            mode = frame_scene(2*pi/frame%omega(j), 'dop853')
            mode%frame%xi_s = 0
            mode%solver = case%solver
            mode%output = output_t(dt=0.01_wp, energy=.false., reactions=.false.)
            call simulate(mode, part, error)
            call checks%no_error(error, 'oscillator of a mode')
            shear = shear - modal_mass(frame, j)*frame%omega(j)**2*column(part, 'u_s_m')
         end do
         found = column(result, 'base_shear_over_weight')*sum(frame%m)*case%model%g
      end associate
      call checks%close_to(maxval(abs(found - shear))/maxval(abs(shear)), 0.0_wp, &
         'base shear of the modes, '//coupling, atol=1.0e-8_wp)
      call checks%close_to(result%reactions%base_shear_max, &
         maxval(abs(column(result, 'base_shear_over_weight'))), 'its largest', rtol=1.0e-3_wp)
   end subroutine check_modal_base_shear

   !> Check a wall that rests throughout while its floors move. The roof follows the ground, so the
   !> base shear is the force on wall and roof and the ground-storey shear of the other floors. With
   !> one mode, the frame is rigid.
   subroutine check_storeys_at_rest()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: floors(:)
      character(9), parameter :: couplings(2) = [character(9) :: 'reduced', 'full']
      real(wp) :: omega
      real(wp) :: demand
      integer :: i

      do i = 1, size(couplings)
         case = scene('exact', 'linear')
         case%motion%a_max_g = 0.01_wp
         allocate (case%frame%floors)
         case%frame%coupling = trim(couplings(i))
         case%frame%floors%m = [3.0_wp, 2.0_wp]
         case%frame%floors%k = [600.0_wp, 500.0_wp]
         case%frame%floors%height = [2.0_wp, 2.0_wp]
         call set_equivalent_frame(case, error)
         case%frame%xi_s = 0
         case%solver%t_end = 0.999_wp
         case%output = output_t(dt=0.001_wp, energy=.false., reactions=.true.)
         call simulate(case, result, error)
         call checks%no_error(error, 'storeys at rest')
         call checks%that(result%lift_offs == 0, 'the wall rests')
         if (couplings(i) == 'reduced') then
            call checks%close_to(result%reactions%base_shear_max, case%motion%a_max_g, &
               'base shear of a rigid whole', rtol=1.0e-12_wp)
            cycle
         end if
         ! the floor is an oscillator between two springs under a sine
         omega = sqrt(1100/3.0_wp)
         associate (t => column(result, 't_s'), rate => case%motion%omega_p, &
            a => case%motion%a_max_g)
            floors = 6*a*sin(rate*t) + 3*a/(omega**2 - rate**2)*(rate**2*sin(rate*t) &
               - rate*omega*sin(omega*t))
            call checks%close_to(maxval(abs(column(result, 'base_shear_over_weight')*6 &
               - floors)), 0.0_wp, 'base shear over a moving floor', atol=1.0e-9_wp)
            ! link force: inertia of the roof's mass and shear of the upper storey's columns
            demand = maxval(abs(3*a*sin(rate*t) + 500*a/(omega**2 - rate**2)*(sin(rate*t) &
               - rate/omega*sin(omega*t))))/2
            call checks%close_to(result%reactions%demand_max, demand, 'its demand', &
               rtol=1.0e-3_wp)
         end associate
      end do
   end subroutine check_storeys_at_rest

   !> Check that a wall at rest without ground motion carries its weight and the cable force.
   subroutine check_static()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = scene('exact', 'linear')
      case%motion%kind = 'none'
      case%output = output_t(energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'static')
      call checks%close_to(result%reactions%normal_min, 1 + case%cable%eta_0(1), &
         'weight and cable', &
         rtol=round_off)
      call checks%close_to(result%reactions%demand_max, 0.0_wp, 'no demand')
      call checks%close_to(result%reactions%base_shear_max, 0.0_wp, 'no base shear')
   end subroutine check_static

   !> Check H = (1 + gamma) m_w u_g'' at rest. The wall therefore lifts off at a demand of
   !> tan(alpha) (1 + gamma)/(1 + 2 gamma), for any cable. At lift-off the demand continues without
   !> a jump.
   subroutine check_at_rest()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(reactions_t) :: resting
      type(reactions_t) :: rocking
      real(wp) :: at(2)
      real(wp) :: y_dot(2)
      real(wp) :: expected
      real(wp) :: t_lift

      case = scene('exact', 'linear')
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      t_lift = asin(equation%uplift%threshold/(case%motion%a_max_g*case%model%g)) &
         /case%motion%omega_p
      call enter_interval(equation%model_t, equation%state, interval_at(motion, t_lift))
      call enter_side(equation%model_t, equation%state, -1)
      at = 0
      resting = reactions_at(equation, t_lift, at, [0.0_wp, 0.0_wp])
      call rates_at(equation, t_lift, at, y_dot)
      rocking = reactions_at(equation, t_lift, at, y_dot)
      expected = tan(equation%p%alpha)*6/11.0_wp
      call checks%close_to(resting%horizontal/resting%normal, expected, 'demand at lift-off', &
         rtol=round_off)
      call checks%close_to(rocking%horizontal, resting%horizontal, 'H at lift-off', &
         rtol=1.0e-12_wp)
      call checks%close_to(rocking%normal, resting%normal, 'N at lift-off', rtol=1.0e-12_wp)
   end subroutine check_at_rest

   !> Check a wall that rests throughout: the demand follows the ground and exceeds a limit at a
   !> known time.
   subroutine check_friction_limit_at_rest()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: peak

      case = scene('exact', 'linear')
      case%motion%a_max_g = 0.03_wp
      peak = 6*case%motion%a_max_g/2
      case%output = output_t(energy=.false., reactions=.true.)
      case%output%friction_limit = 0.6_wp*peak
      call simulate(case, result, error)
      call checks%no_error(error, 'rest')
      call checks%that(result%lift_offs == 0, 'the wall rests')
      call checks%close_to(result%reactions%demand_max, peak, 'demand at rest', rtol=round_off)
      call checks%close_to(result%reactions%t_demand_max, 0.25_wp, 'its time', rtol=round_off)
      call checks%close_to(result%reactions%base_shear_max, case%motion%a_max_g, &
         'base shear of a rigid whole', rtol=round_off)
      call checks%that(result%reactions%is_exceeded, 'limit exceeded')
      call checks%close_to(result%reactions%t_exceeded, asin(0.6_wp)/(2*pi), &
         'first time of excess', rtol=round_off)
      call checks%that(count(index(result%warnings, 'friction demand') > 0) == 1, 'a warning')
      case%output%friction_limit = 1.01_wp*peak
      call simulate(case, result, error)
      call checks%that(.not. result%reactions%is_exceeded, 'limit kept')
      call checks%that(.not. allocated(result%reactions%t_exceeded), 'no time of excess')
   end subroutine check_friction_limit_at_rest

   !> Check a free block released from x_0 = alpha - phi_0. With x = alpha - phi, up to the first
   !> impact at x = alpha,
   !> N/(m_w g) = 1/4 + 9/4 cos(x)**2 - 3/2 cos(x) cos(x_0),
   !> |H|/(m_w g) = sin(x) (9/4 cos(x) - 3/2 cos(x_0)).
   !> After an impact without rebound the block rests.
   subroutine check_free_block(b, theta_over_alpha)
      real(wp), intent(in) :: b
      !! half width [m]
      real(wp), intent(in) :: theta_over_alpha
      integer, parameter :: n = 200000
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: alpha
      real(wp) :: x_0
      real(wp) :: x(0:n)
      real(wp) :: normal(0:n)
      real(wp) :: horizontal(0:n)
      integer :: i

      case = block_scene('dop853')
      case%wall%b = b
      case%motion%kind = 'none'
      case%solver%rtol = 1.0e-12_wp
      case%impact%rule = 'constant'
      case%impact%e = 0
      case%initial = initial_t(theta_over_alpha, 0.0_wp)
      case%output = output_t(energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'free block')
      alpha = atan2(b, case%wall%h)
      x_0 = alpha*(1 - theta_over_alpha)
      x = [(x_0 + (alpha - x_0)*i/n, i=0, n)]
      normal = 0.25_wp + 2.25_wp*cos(x)**2 - 1.5_wp*cos(x)*cos(x_0)
      horizontal = abs(sin(x)*(2.25_wp*cos(x) - 1.5_wp*cos(x_0)))
      call checks%close_to(result%reactions%normal_min, normal(n), 'N of a free block', &
         rtol=1.0e-10_wp)
      call checks%close_to(result%reactions%demand_max, maxval(horizontal/normal), &
         'demand of a free block', rtol=1.0e-10_wp)
      call checks%close_to(result%reactions%base_shear_max, maxval(horizontal), &
         'base shear of a free block', rtol=1.0e-10_wp)
      if (b > 1) call checks%that(maxloc(horizontal, dim=1) < n, 'an extremum inside')
   end subroutine check_free_block

   !> Check that the base shear of a frame over its weight is the force of spring and damper.
   subroutine check_bare_frame()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: omega

      case = frame_scene(0.8_wp, 'dop853')
      case%frame%xi_s = 0
      case%output = output_t(energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'bare frame')
      omega = 2*pi/0.8_wp
      call checks%close_to(result%reactions%base_shear_max, omega**2*result%u_s_max/case%model%g, &
         'pseudo-acceleration', rtol=1.0e-10_wp)
      call checks%that(.not. allocated(result%reactions%normal_min), 'no pivot')
      call checks%that(.not. allocated(result%reactions%wall_drift_max), 'no wall drift')
   end subroutine check_bare_frame

   !> Check a block with an initial velocity large enough to lift the pivot; the block then
   !> overturns. With x = alpha - phi, N/(m_w g) = 1 - 3/4 sin(x)**2 - R cos(x) theta'**2/g. R
   !> theta'**2/g follows from the energy.
   subroutine check_pivot_lifts()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer, parameter :: n = 200000
      real(wp), parameter :: rate = 3
      real(wp) :: alpha
      real(wp) :: spin(0:n)
      !! R theta'**2/g [-]
      real(wp) :: x(0:n)
      integer :: i

      case = block_scene('dop853')
      case%motion%kind = 'none'
      case%solver%rtol = 1.0e-12_wp
      case%initial = initial_t(0.0_wp, rate)
      case%output = output_t(energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'pivot')
      alpha = atan2(case%wall%b, case%wall%h)
      x = [(alpha - (pi/2)*i/n, i=0, n)]
      spin = hypot(case%wall%b, case%wall%h)*rate**2/case%model%g + 1.5_wp*(cos(alpha) - cos(x))
      call checks%close_to(result%reactions%normal_min, minval(1 - 0.75_wp*sin(x)**2 &
         - cos(x)*spin), 'N of a block that is hit', rtol=1.0e-9_wp)
      call checks%that(result%reactions%pivot_lifts, 'pivot lifts')
      call checks%that(.not. ieee_is_finite(result%reactions%demand_max), 'no friction suffices')
      call checks%that(any(index(result%warnings, 'pivot reaction') > 0), 'a warning about it')
   end subroutine check_pivot_lifts

end program test_reactions
