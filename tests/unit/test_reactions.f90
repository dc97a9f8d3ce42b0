!> Reactions of the base: the balance that they did not come from, closed forms, extrema.
program test_reactions
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use check, only: checks_t
   use rwmf_bouc_wen, only: bouc_wen_residual
   use rwmf_case, only: case_t, damper_t, fuse_t, inerter_t, initial_t, link_t, output_t
   use rwmf_equation, only: build_equation, enter_interval, equation_t, kinematics_at, &
      second_derivative
   use rwmf_equivalent_frame, only: set_equivalent_frame
   use rwmf_errors, only: error_t
   use rwmf_kinds, only: pi, wp
   use rwmf_memory, only: load_to
   use rwmf_memory_query, only: frame_residual
   use rwmf_kinematics, only: kinematics_t
   use rwmf_motion, only: interval_at, motion_from_case, motion_t
   use rwmf_reactions, only: cable_force, link_force, reactions_at, reactions_t
   use rwmf_result, only: result_t
   use rwmf_scene, only: ground
   use rwmf_shear_frame, only: damping_matrix, modal_mass
   use rwmf_simulation, only: simulate
   use scenes, only: block_scene, frame_scene, rwmf_scene
   implicit none

   real(wp), parameter :: t = 0.3_wp
   real(wp), parameter :: round_off = 1.0e-13_wp
   type(checks_t) :: checks

   call check_balance(scene('published', 'linear'), 'published')
   call check_balance(scene('symmetric', 'linear'), 'symmetric')
   call check_balance(scene('exact', 'linear'), 'exact')
   call check_balance(scene('exact', 'truss'), 'truss')
   call check_balance(linked('symmetric'), 'link, symmetric')
   call check_balance(linked('exact'), 'link, exact')
   call check_balance(damped(), 'dampers')
   call check_balance(pinned(), 'pinned')
   call check_balance(linked_pinned(), 'pinned, link')
   call check_balance(pinned_with_corners(), 'pinned, dampers, fuses, inerters')
   call check_balance(fused(), 'fuses')
   call check_balance(with_inerter(), 'inerters')
   call check_balance(shaken_vertically(), 'vertical motion')
   call check_balance(with_tendon('linear'), 'tendon')
   call check_balance(with_tendon('truss'), 'straight tendon')
   call check_balance(hysteretic('exact'), 'Bouc and Wen')
   call check_balance(hysteretic('symmetric'), 'Bouc and Wen, symmetric')
   call check_balance(storeys('reduced', 'exact'), 'one mode')
   call check_balance(storeys('reduced', 'symmetric'), 'one mode, symmetric')
   call check_balance(storeys('full', 'exact'), 'all modes')
   call check_balance(storeys('full', 'published'), 'all modes, published')
   call check_balance(storeys('every_floor', 'exact'), 'every floor')
   call check_balance(storeys('every_floor', 'symmetric'), 'every floor, symmetric')
   call check_balance(storeys('every_floor', 'published'), 'every floor, published')
   call check_balance(linked_storeys('every_floor'), 'every floor, link')
   call check_balance(storeys_of_pinned_wall(), 'every floor, pinned')
   call check_balance(yielding_storeys('elastic_plastic'), 'every floor, yielding')
   call check_balance(yielding_storeys('bouc_wen'), 'every floor, Bouc and Wen')
   call check_balance(linked_storeys('full'), 'all modes, link')
   call check_balance(linked_storeys('reduced'), 'one mode, link')
   call check_modal_base_shear('full')
   call check_modal_base_shear('reduced')
   call check_storeys_at_rest()
   call check_damper_power()
   call check_static()
   call check_at_rest()
   call check_friction_limit_at_rest()
   call check_free_block(0.5_wp, 0.6_wp)
   call check_free_block(1.6_wp, 0.5_wp)
   call check_bare_frame()
   call check_pivot_lifts()
   call check_extremes('adams', 1.0e-9_wp, 'one_sine')
   call check_extremes('dop853', 1.0e-9_wp, 'one_sine')
   call check_extremes('dop853', 1.0e-3_wp, 'one_sine')
   call check_extremes('extrapolation', 1.0e-6_wp, 'one_sine')
   call check_extremes('dop853', 1.0e-9_wp, 'one_cosine')
   call check_first_exceedance()
   call check_energy_rows()
   call check_only_if_asked()
   call checks%finish()

contains

   function scene(formulation, law) result(case)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      type(case_t) :: case

      case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'dop853')
      case%cable%law = law
   end function scene

   function linked(formulation) result(case)
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'truss')
      case%link = link_t(5.0_wp)
   end function linked

   function damped() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%damper = damper_t(2.0_wp)
   end function damped

   function pinned() result(case)
      type(case_t) :: case

      case = scene('exact', 'linear')
      deallocate (case%cable, case%impact)
      case%wall%base = 'pinned'
   end function pinned

   function linked_pinned() result(case)
      type(case_t) :: case

      case = pinned()
      case%link = link_t(5.0_wp)
   end function linked_pinned

   !> All that acts under both corners of a hinged wall.
   function pinned_with_corners() result(case)
      type(case_t) :: case

      case = pinned()
      case%damper = damper_t(2.0_wp)
      case%fuse = fuse_t(0.4_wp, 0.002_wp, 0.02_wp)
      case%inerter = inerter_t(1.5_wp)
   end function pinned_with_corners

   !> Fuses that yield far below the rotation of the test.
   function fused() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%fuse = fuse_t(0.4_wp, 0.002_wp, 0.02_wp)
   end function fused

   function with_inerter() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%inerter = inerter_t(1.5_wp)
   end function with_inerter

   function shaken_vertically() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      allocate (case%vertical)
      case%vertical%ratio = 0.65_wp
   end function shaken_vertically

   !> A tendon that yields below the rotation of the test.
   function with_tendon(law) result(case)
      character(*), intent(in) :: law
      type(case_t) :: case

      case = scene('exact', law)
      case%cable%eta_y = 1.3_wp
      case%cable%hardening = 0.02_wp
   end function with_tendon

   !> The frame yields smoothly.
   function hysteretic(formulation) result(case)
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'linear')
      allocate (case%yielding)
      case%yielding%law = 'bouc_wen'
      case%yielding%u_y = 0.1_wp
      case%yielding%hardening = 0.07_wp
      case%yielding%exponent = 2
      case%yielding%beta = 0.6_wp
   end function hysteretic

   !> Three unequal storeys under the roof at the wall's top.
   function storeys(coupling, formulation) result(case)
      character(*), intent(in) :: coupling
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'linear')
      call add_storeys(case, coupling)
   end function storeys

   function linked_storeys(coupling) result(case)
      character(*), intent(in) :: coupling
      type(case_t) :: case

      case = linked('exact')
      call add_storeys(case, coupling)
   end function linked_storeys

   !> Every floor linked to a hinged wall.
   function storeys_of_pinned_wall() result(case)
      type(case_t) :: case

      case = pinned()
      call add_storeys(case, 'every_floor')
   end function storeys_of_pinned_wall

   !> Every floor linked; all storeys yield at the same drift, far below that of the test.
   function yielding_storeys(law) result(case)
      character(*), intent(in) :: law
      type(case_t) :: case

      case = hysteretic('exact')
      case%yielding%law = law
      call add_storeys(case, 'every_floor')
   end function yielding_storeys

   subroutine add_storeys(case, coupling)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: coupling
      type(error_t), allocatable :: error

      allocate (case%storeys)
      case%storeys%coupling = coupling
      case%storeys%frame%m = [3.0_wp, 2.0_wp, 1.5_wp]
      case%storeys%frame%k = [600.0_wp, 500.0_wp, 300.0_wp]
      case%storeys%frame%height = [2.0_wp, 1.5_wp, 0.5_wp]
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'storeys')
   end subroutine add_storeys

   !> Moments of all forces about the centroid give its moment of inertia times theta'', although
   !> the reactions come from the balance of momentum alone; and the foundation's forces on wall,
   !> frame, cable and dampers together are the base shear, which comes from the accelerations.
   subroutine check_balance(case, name)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: name
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(reactions_t) :: reactions
      real(wp), allocatable :: y(:)
      real(wp) :: y_ddot
      real(wp) :: moment
      real(wp) :: shear
      real(wp) :: damper(2)
      integer :: side
      integer :: i
      integer :: j

      motion = motion_from_case(case)
      do side = -1, 1, 2
         call build_equation(case, motion, equation)
         call enter_interval(equation, interval_at(motion, t))
         if (equation%has_impacts) equation%side = side
         ! what yields has done so, and unloads
         if (equation%has_memory) call load_to(equation, side*0.13_wp)
         do i = -1, 1, 2
            y = [side*0.11_wp, i*0.7_wp, (0.1_wp*j*i, j=3, equation%n)]
            y_ddot = second_derivative(equation, t, y)
            reactions = reactions_at(equation, t, y, y_ddot)
            damper = 0
            if (allocated(equation%extras)) then
               if (associated(equation%extras(1)%force)) call equation%extras(1)%force(equation, &
                  t, y, y_ddot, damper)
            end if
            moment = turn(pivot(equation), [reactions%horizontal, reactions%normal], equation, y) &
               + turn_of_links(equation, case, y, y_ddot) &
               + turn(cable_point(equation, y), cable_force(equation, y(1)), equation, y) &
               + turn(lifting_corner(equation, y), damper, equation, y) &
               + couple(equation, case, y, y_ddot)
            call checks%close_to(moment, equation%p%R**2/3*y_ddot, 'moments about the centroid, ' &
               //name, atol=round_off*equation%p%g*equation%p%R*(1 + equation%p%gamma))
            shear = reactions%horizontal + sum([1.0_wp, 0.0_wp]*(cable_force(equation, y(1)) &
               + damper)) - frame_shear(equation, case, y)
            call checks%close_to(reactions%base_shear, shear, 'base shear, '//name, &
               atol=round_off*equation%p%g*(1 + equation%p%gamma))
         end do
      end do
   end subroutine check_balance

   !> Clockwise moment about the centroid of a force at a point of the space.
   real(wp) function turn(point, force, equation, y)
      real(wp), intent(in) :: point(2)
      !! from the centre of the base of the resting wall [m]
      real(wp), intent(in) :: force(2)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: arm(2)

      arm = point - place(equation, y(1), [0.0_wp, 0.0_wp])
      turn = arm(2)*force(1) - arm(1)*force(2)
   end function turn

   !> Clockwise moment of the devices under both corners of a hinged wall: each is drawn out or
   !> pressed by s = 2b sin(theta/2). The fuses have yielded up to 0.13 rad and unload.
   real(wp) function couple(equation, case, y, y_ddot)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      real(wp) :: force
      real(wp) :: largest
      !! stroke of the fuses [m]

      couple = 0
      if (equation%has_impacts .or. .not. allocated(case%fuse)) return
      associate (b => case%wall%b, half => y(1)/2, fuse => case%fuse, g => case%model%g)
         force = case%damper%c_over_m_w*b*cos(half)*y(2) + case%inerter%inertance_over_m_w &
            *(b*cos(half)*y_ddot - b*sin(half)*y(2)**2/2)
         largest = 2*b*sin(0.13_wp/2)
         force = force + sign(fuse%eta_y*g*(1 + fuse%hardening*(largest/fuse%stroke_y - 1)), half) &
            + fuse%eta_y*g/fuse%stroke_y*(2*b*sin(half) - sign(largest, half))
         couple = -2*force*b*cos(half)
      end associate
   end function couple

   !> Moment of what the links do to the wall: of one at the roof, or of one at every floor, on the
   !> line from the pivot to the roof's corner.
   real(wp) function turn_of_links(equation, case, y, y_ddot) result(moment)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      real(wp) :: force(2)
      real(wp), allocatable :: pulls(:)
      !! of the floors on their links [m/s2]
      real(wp), allocatable :: share(:)
      !! of the floors in the height [-]
      real(wp) :: resists
      integer :: i

      force = link_force(equation, kinematics_at(equation, y(1)), t, y, y_ddot)
      moment = turn(link_corner(equation, case, y), force, equation, y)
      if (.not. has_all_links(case)) return
      associate (frame => case%storeys%frame)
         share = [(sum(frame%height(:i)), i=1, size(frame%m))]/sum(frame%height)
         resists = resisting_roof(equation, case, y)
         pulls = frame%m*(share*roof_ddot_of(equation, y, y_ddot) + ground(equation, t)) &
            + resists*[frame%k*frame%height/sum(frame%height)]
         pulls(:2) = pulls(:2) - resists*frame%k(2:)*frame%height(2:)/sum(frame%height)
      end associate
      call checks%close_to(-force(1), sum(pulls), 'all links', rtol=1.0e-12_wp)
      moment = 0
      do i = 1, size(pulls)
         moment = moment + turn(pivot(equation) + share(i)*(link_corner(equation, case, y) &
            - pivot(equation)), force*pulls(i)/sum(pulls), equation, y)
      end do
   end function turn_of_links

   !> Displacement that the elastic storeys would need for the force of spring and damper [m]:
   !> the same line for both, and for what has yielded.
   real(wp) function resisting_roof(equation, case, y) result(u)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      type(kinematics_t) :: kin

      kin = kinematics_at(equation, y(1))
      u = equation%p%R*(equation%side*kin%u + 2*case%frame%xi_s*case%frame%T_s/(2*pi)*kin%j*y(2))
      if (.not. allocated(case%yielding)) return
      if (equation%has_course) then
         u = u - bouc_wen_residual(equation, y)
      else
         u = u - frame_residual(equation, y(1))
      end if
   end function resisting_roof

   real(wp) function roof_ddot_of(equation, y, y_ddot) result(u_ddot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      type(kinematics_t) :: kin

      kin = kinematics_at(equation, y(1))
      u_ddot = equation%p%R*(equation%side*kin%k*y(2)**2 + kin%j*y_ddot)
   end function roof_ddot_of

   !> Where a point of the wall is, given from its centroid [m].
   function place(equation, theta, point) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      real(wp), intent(in) :: point(2)
      real(wp) :: x(2)
      real(wp) :: arm(2)

      arm = point + [0.0_wp, equation%p%R*equation%cos_alpha] - pivot(equation)
      x = pivot(equation) + [cos(theta)*arm(1) + sin(theta)*arm(2), &
         -sin(theta)*arm(1) + cos(theta)*arm(2)]
   end function place

   function pivot(equation) result(x)
      type(equation_t), intent(in) :: equation
      real(wp) :: x(2)

      x = 0
      if (equation%has_impacts) x(1) = equation%side*equation%p%R*equation%sin_alpha
   end function pivot

   !> Left top corner; of `symmetric` the one opposite to the pivot; of a hinged wall the middle.
   function link_corner(equation, case, y) result(x)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = [-case%wall%b, case%wall%h]
      if (case%model%formulation == 'symmetric') x(1) = -equation%side*case%wall%b
      if (.not. equation%has_impacts) x(1) = 0
      x = place(equation, y(1), x)
   end function link_corner

   !> The cable is fixed in the middle of the wall's top.
   function cable_point(equation, y) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = place(equation, y(1), [0.0_wp, equation%p%R*equation%cos_alpha])
   end function cable_point

   function lifting_corner(equation, y) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = place(equation, y(1), -equation%p%R*[equation%side*equation%sin_alpha, &
         equation%cos_alpha])
   end function lifting_corner

   !> Spring and damper of the frame on its mass, against its motion.
   real(wp) function frame_shear(equation, case, y) result(shear)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp), parameter :: step = 1.0e-30_wp
      real(wp) :: u
      real(wp) :: slope
      real(wp) :: phi
      complex(wp) :: w
      complex(wp) :: root
      complex(wp) :: rise

      ! u_s(theta) once more from the geometry, its derivative by a complex step
      phi = equation%side*y(1)
      w = cmplx(phi, step, wp)
      associate (s => equation%sin_alpha, c => equation%cos_alpha, L => equation%geometry%link)
         rise = 2*(c*cos(w) + s*sin(w) - c)
         if (.not. equation%has_impacts) then
            w = cmplx(y(1), step, wp)
            rise = 2*c*(cos(w) - 1)
            root = 2*c*sin(w)
         else if (is_left(equation)) then
            rise = 2*c*(cos(w) - 1)
            root = 2*c*sin(w)
         else
            root = 2*(s - s*cos(w) + c*sin(w))
         end if
         if (L > 0) root = root + merge(-1, 1, is_left(equation))*(L - sqrt(L**2 - rise**2))
      end associate
      u = equation%side*equation%p%R*root%re
      slope = equation%p%R*root%im/step
      shear = equation%p%gamma*equation%p%omega_s*(equation%p%omega_s*u &
         + 2*equation%p%xi_s*slope*y(2))
      if (has_all_links(case)) then
         shear = case%storeys%frame%k(1)*case%storeys%frame%height(1) &
            /sum(case%storeys%frame%height)*resisting_roof(equation, case, y)
      else if (allocated(case%yielding)) then
         associate (law => case%yielding)
            shear = shear + equation%p%gamma*equation%p%omega_s**2*(1 - law%hardening) &
               *(law%u_y*y(3) - u)
         end associate
      else if (allocated(case%storeys)) then
         shear = storey_shear(equation, case, y, u, slope*y(2))
      end if
   end function frame_shear

   pure logical function has_all_links(case)
      type(case_t), intent(in) :: case

      has_all_links = .false.
      if (allocated(case%storeys)) has_all_links = case%storeys%coupling == 'every_floor'
   end function has_all_links

   !> The columns of the lowest storey and all dampers; one mode: what its floors need less what
   !> the link brings.
   real(wp) function storey_shear(equation, case, y, roof, rate) result(shear)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: roof
      !! its displacement [m]
      real(wp), intent(in) :: rate
      !! and velocity [m/s]
      real(wp) :: link(2)
      real(wp) :: roof_ddot
      type(kinematics_t) :: kin

      associate (frame => case%storeys%frame)
         if (case%storeys%coupling == 'full') then
            shear = frame%k(1)*y(3) + sum(matmul(damping_matrix(frame, case%frame%xi_s), &
               [y(5:6), rate]))
            return
         end if
         kin = kinematics_at(equation, y(1))
         link = link_force(equation, kin, t, y, second_derivative(equation, t, y))
         roof_ddot = equation%p%R*(equation%side*kin%k*y(2)**2 &
            + kin%j*second_derivative(equation, t, y))
         ! the link holds the roof's modal equation, every floor has the acceleration of its share
         call checks%close_to(-link(1), sum(frame%shape(:, 1)*(frame%m*(frame%shape(:, 1) &
            *roof_ddot/frame%shape(3, 1) + ground(equation, t)) + (frame%omega(1)**2*roof &
            + 2*case%frame%xi_s*frame%omega(1)*rate)*frame%m*frame%shape(:, 1) &
            /frame%shape(3, 1)))/frame%shape(3, 1), 'link of one mode', rtol=1.0e-12_wp)
         shear = -link(1) - sum(frame%m*(frame%shape(:, 1)/frame%shape(3, 1)*roof_ddot &
            + ground(equation, t)))
      end associate
   end function storey_shear

   !> Without wall and damping: all modes, the sum over the modes of the base shear M*_j omega_j**2
   !> D_j(t) (Chopra, section 13.2); one mode, its own, and the rest of the mass with the ground.
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
      associate (frame => case%storeys%frame)
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

   !> A wall that rests throughout while its floors move: the roof goes with the ground, so that the
   !> base shear is what wall, roof and the ground's shear of the others need; one mode is rigid.
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
         allocate (case%storeys)
         case%storeys%coupling = trim(couplings(i))
         case%storeys%frame%m = [3.0_wp, 2.0_wp]
         case%storeys%frame%k = [600.0_wp, 500.0_wp]
         case%storeys%frame%height = [2.0_wp, 2.0_wp]
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
            ! link: the roof's mass and the upper storey's columns
            demand = maxval(abs(3*a*sin(rate*t) + 500*a/(omega**2 - rate**2)*(sin(rate*t) &
               - rate/omega*sin(omega*t))))/2
            call checks%close_to(result%reactions%demand_max, demand, 'its demand', &
               rtol=1.0e-3_wp)
         end associate
      end do
   end subroutine check_storeys_at_rest

   !> Does the link's end move as the left top corner while the wall rocks to the left?
   logical function is_left(equation)
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: large = 0.5_wp

      ! 2h sin(phi) of `exact` against 2R (sin(alpha) - sin(alpha - phi))
      is_left = .false.
      if (equation%side < 0) is_left = abs(kinematic_u(equation, large) &
         - 2*equation%cos_alpha*sin(large)) < 0.05_wp
   end function is_left

   real(wp) function kinematic_u(equation, phi) result(u)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: phi
      type(kinematics_t) :: kin

      call equation%kinematics_negative(equation%geometry, phi, kin)
      u = kin%u
   end function kinematic_u

   !> Force times velocity of the lifting corner is the power that the damper takes.
   subroutine check_damper_power()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      real(wp), parameter :: y(2) = [0.2_wp, 0.7_wp]
      real(wp), parameter :: step = 1.0e-6_wp
      real(wp) :: force(2)
      real(wp) :: velocity(2)

      case = damped()
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      force = 0
      call equation%extras(1)%force(equation, t, y, 0.0_wp, force)
      velocity = (lifting_corner(equation, y + step) - lifting_corner(equation, y - step)) &
         /(2*step)*y(2)
      call checks%close_to(-sum(force*velocity), equation%extras(1)%power(equation, t, y), &
         'power of the damper', rtol=1.0e-9_wp)
   end subroutine check_damper_power

   !> A wall that nothing moves carries its weight and the cable.
   subroutine check_static()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      case = scene('exact', 'linear')
      case%motion%kind = 'none'
      case%output = output_t(energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'static')
      call checks%close_to(result%reactions%normal_min, 1 + case%cable%eta_0, 'weight and cable', &
         rtol=round_off)
      call checks%close_to(result%reactions%demand_max, 0.0_wp, 'no demand')
      call checks%close_to(result%reactions%base_shear_max, 0.0_wp, 'no base shear')
   end subroutine check_static

   !> At rest H = (1 + gamma) m_w u_g'', so that the wall lifts off at a demand of
   !> tan(alpha) (1 + gamma)/(1 + 2 gamma), whatever the cable; there the rocking wall takes over
   !> without a jump.
   subroutine check_at_rest()
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(reactions_t) :: resting
      type(reactions_t) :: rocking
      real(wp) :: at(2)
      real(wp) :: expected
      real(wp) :: t_lift

      case = scene('exact', 'linear')
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      t_lift = asin(equation%threshold/(case%motion%a_max_g*case%model%g))/case%motion%omega_p
      call enter_interval(equation, interval_at(motion, t_lift))
      equation%side = -1
      at = 0
      resting = reactions_at(equation, t_lift, at, 0.0_wp)
      rocking = reactions_at(equation, t_lift, at, second_derivative(equation, t_lift, at))
      expected = tan(equation%p%alpha)*6/11.0_wp
      call checks%close_to(resting%horizontal/resting%normal, expected, 'demand at lift-off', &
         rtol=round_off)
      call checks%close_to(rocking%horizontal, resting%horizontal, 'H at lift-off', &
         rtol=1.0e-12_wp)
      call checks%close_to(rocking%normal, resting%normal, 'N at lift-off', rtol=1.0e-12_wp)
   end subroutine check_at_rest

   !> A wall that rests throughout: the demand follows the ground, and passes a limit in time.
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
      call checks%that(size(result%warnings) == 1, 'a warning')
      case%output%friction_limit = 1.01_wp*peak
      call simulate(case, result, error)
      call checks%that(.not. result%reactions%is_exceeded, 'limit kept')
      call checks%that(.not. allocated(result%reactions%t_exceeded), 'no time of excess')
   end subroutine check_friction_limit_at_rest

   !> A free block that is let go from x_0 = alpha - phi_0: with x = alpha - phi,
   !> N/(m_w g) = 1/4 + 9/4 cos(x)**2 - 3/2 cos(x) cos(x_0),
   !> |H|/(m_w g) = sin(x) (9/4 cos(x) - 3/2 cos(x_0)) up to the first impact at x = alpha; after
   !> an impact without rebound it stands still.
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
      allocate (case%impact)
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

   !> Base shear of a frame over its weight is what spring and damper carry.
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

   !> A block that is hit so hard that it would fly, and then overturns: with x = alpha - phi,
   !> N/(m_w g) = 1 - 3/4 sin(x)**2 - R cos(x) theta'**2/g, R theta'**2/g from energy.
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

   !> Extrema against a history that is finer than any feature of the response.
   subroutine check_extremes(method, rtol, kind)
      character(*), intent(in) :: method
      real(wp), intent(in) :: rtol
      character(*), intent(in) :: kind
      !! of the pulse; a cosine begins with a jump, which lifts the wall at once
      real(wp), parameter :: dt = 1.0e-4_wp
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:)
      character(:), allocatable :: name

      name = kind//', '//method
      case = rwmf_scene('exact', 5.0_wp, 0.7_wp, method)
      case%motion%kind = kind
      case%solver%rtol = rtol
      case%solver%t_end = 5
      case%output = output_t(dt=dt, energy=.false., reactions=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'extrema, '//name)
      rows = column(result, 'base_shear_over_weight')
      call compare(result%reactions%base_shear_max, maxval(abs(rows)), 'base shear, '//name)
      rows = column(result, 'pivot_normal_over_m_w_g')
      call compare(-result%reactions%normal_min, maxval(-rows), 'N, '//name)
      rows = column(result, 'friction_demand')
      call compare(result%reactions%demand_max, maxval(rows), 'demand, '//name)
      rows = column(result, 'wall_drift')
      call compare(result%reactions%wall_drift_max, maxval(abs(rows)), 'wall drift, '//name)
      rows = column(result, 'frame_drift')
      call compare(result%reactions%frame_drift_max, maxval(abs(rows)), 'frame drift, '//name)
   end subroutine check_extremes

   !> Not below the largest row, and above it by no more than a row's interval allows: at an impact
   !> a reaction jumps, so that a row lies up to dt before its one-sided value.
   subroutine compare(extreme, largest_row, name)
      real(wp), intent(in) :: extreme
      real(wp), intent(in) :: largest_row
      character(*), intent(in) :: name
      real(wp), parameter :: within_a_row = 1.0e-3_wp

      call checks%that(extreme >= largest_row - 1.0e-13_wp*abs(largest_row), name//': not missed')
      call checks%close_to(extreme, largest_row, name, rtol=within_a_row)
   end subroutine compare

   !> The first excess of a limit that is first exceeded between two peaks of the demand.
   subroutine check_first_exceedance()
      real(wp), parameter :: dt = 1.0e-4_wp
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:)
      integer :: first

      case = rwmf_scene('exact', 5.0_wp, 0.7_wp, 'dop853')
      case%output = output_t(dt=dt, energy=.false., reactions=.true.)
      case%output%friction_limit = 0.16_wp
      call simulate(case, result, error)
      call checks%no_error(error, 'excess')
      rows = column(result, 'friction_demand')
      first = findloc(rows > case%output%friction_limit, .true., dim=1)
      call checks%that(first > 2, 'exceeded after the beginning')
      call checks%close_to(result%reactions%t_exceeded, (first - 1.5_wp)*dt, 'first excess', &
         atol=0.51_wp*dt)
   end subroutine check_first_exceedance

   !> The ledger closes in every row: what came in is stored or dissipated.
   subroutine check_energy_rows()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp), allocatable :: residual(:)
      character(*), parameter :: out(6) = [character(9) :: 'kinetic', 'strain', 'gravity', &
         'cable', 'viscous', 'impact']
      integer :: i

      case = damped()
      case%output = output_t(dt=0.013_wp, energy=.true.)
      call simulate(case, result, error)
      call checks%no_error(error, 'ledger')
      residual = column(result, 'energy_input_J_per_kg')
      do i = 1, size(out)
         residual = residual - column(result, 'energy_'//trim(out(i))//'_J_per_kg')
      end do
      call checks%that(maxval(abs(residual)) <= 1.0e-8_wp*result%energy%input_max, &
         'the ledger closes at all times')
      call checks%that(size(result%energy%names) == size(out) + 1, 'no part that does not apply')
      deallocate (case%damper, case%cable, case%impact, case%frame)
      call simulate(case, result, error)
      call checks%that(size(result%energy%names) == 4, 'a block: input, kinetic, gravity, impact')
   end subroutine check_energy_rows

   !> A run that asks for nothing keeps nothing, and the response does not depend on it.
   subroutine check_only_if_asked()
      type(case_t) :: case
      type(result_t) :: plain
      type(result_t) :: asked
      type(error_t), allocatable :: error

      case = scene('exact', 'truss')
      call simulate(case, plain, error)
      call checks%that(.not. allocated(plain%reactions), 'no reactions unless asked')
      case%output = output_t(dt=0.01_wp, energy=.true., reactions=.true.)
      call simulate(case, asked, error)
      call checks%that(abs(asked%u_s_max - plain%u_s_max) <= 0 &
         .and. all(abs(asked%final_state - plain%final_state) <= 0), 'the same bits')
   end subroutine check_only_if_asked

   !> A column of the history.
   function column(result, name) result(values)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: name
      real(wp), allocatable :: values(:)
      integer :: i

      i = findloc(result%history%names == name, .true., dim=1)
      call checks%that(i > 0, 'a column '//name)
      values = result%history%values(:, max(i, 1))
   end function column

end program test_reactions
