!> Reactions against balances that their computation does not use: moments about the centroid, and
!> the foundation's forces on every part.
program test_balance
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_model_equation, only: ground
   use rwmf_model_hysteresis_bouc_wen, only: lagging_displacement
   use rwmf_model_hysteresis_spring_set, only: load_to, plastic_parts
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      kinematics_at, rates_at, second_derivative
   use rwmf_model_system_demands, only: building_of, building_t, links_of
   use rwmf_model_system_reactions, only: cable_force, corner_force, link_force, reactions_at, &
      reactions_t
   use rwmf_model_system_wall_sections, only: find_forces_beside, links_t
   use rwmf_motion_ground_motion, only: interval_at, motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_shear_frame, only: damping_matrix
   implicit none

   real(wp), parameter :: t = 0.3_wp
   real(wp), parameter :: round_off = 1.0e-13_wp
   character(*), parameter :: pulse = "&motion kind='one_sine', a_max_g=0.4, T_p=1.0 / " &
      //'&solver t_end=1 /'
   character(*), parameter :: wall = '&wall h=2.0, b=0.5 / &impact e=0.9 / ', &
      hinged = "&wall h=2.0, b=0.5, base='pinned' / ", &
      frame = '&frame T_s=1.0, gamma=5.0, xi_s=0.05 / ', link = '&link L=5.0 / ', &
      cable = '&cable eta_0=1.0, eta_alpha=5.0 / ', &
      truss = "&cable eta_0=1.0, eta_alpha=5.0, law='truss' / ", &
      damper = '&damper c_over_m_w=2.0 / ', inerter = '&inerter inertance_over_m_w=1.5 / '
   ! fuses, tendons, frames and storeys that yield far below the motion of the test
   character(*), parameter :: fuse = '&fuse eta_y=0.4, stroke_y=0.002, hardening=0.02 / ', &
      tendon = '&cable eta_0=1.0, eta_alpha=5.0, eta_y=1.3, hardening=0.02, law=', &
      smooth = "&yielding u_y=0.1, hardening=0.07, law='bouc_wen', exponent=2.0, beta=0.6 / ", &
      yields = "&yielding u_y=0.1, hardening=0.07, law='elastic_plastic' / ", &
      each_yields = '&yielding storey_u_y=0.02,0.05,0.01, hardening=0.07 / ', &
      storeys = '&frame xi_s=0.05 / &storeys m_over_m_w=3.0,2.0,1.5, ' &
      //'k_over_m_w=600.0,500.0,300.0, height=2.0,1.5,0.5, coupling=', &
      full = wall//cable//storeys//"'full' / ", reduced = wall//cable//storeys//"'reduced' / ", &
      every = wall//cable//storeys//"'every_floor' / "
   type(checks_t) :: checks

   call check_balance(wall//frame//cable, 'published', 'published')
   call check_balance(wall//frame//cable, 'symmetric', 'symmetric')
   call check_balance(wall//frame//cable, 'exact', 'exact')
   call check_balance(wall//frame//truss, 'exact', 'truss')
   call check_balance(wall//frame//truss//link, 'symmetric', 'link, symmetric')
   call check_balance(wall//frame//truss//link, 'exact', 'link, exact')
   call check_balance(wall//frame//truss//damper, 'exact', 'dampers')
   call check_balance(hinged//frame, 'exact', 'pinned')
   call check_balance(hinged//frame//link, 'exact', 'pinned, link')
   call check_balance(hinged//frame//damper//fuse//inerter, 'exact', &
      'pinned, dampers, fuses, inerters')
   call check_balance(wall//frame//truss//fuse, 'exact', 'fuses')
   call check_balance(wall//frame//truss//inerter, 'exact', 'inerters')
   call check_balance(wall//frame//truss//'&vertical ratio=0.65 / ', 'exact', 'vertical motion')
   call check_balance(wall//frame//tendon//"'linear' / ", 'exact', 'tendon')
   call check_balance(wall//frame//tendon//"'truss' / ", 'exact', 'straight tendon')
   call check_balance(wall//frame//cable//smooth, 'exact', 'Bouc and Wen')
   call check_balance(wall//frame//cable//smooth, 'symmetric', 'Bouc and Wen, symmetric')
   call check_balance(reduced, 'exact', 'one mode')
   call check_balance(reduced, 'symmetric', 'one mode, symmetric')
   call check_balance(full, 'exact', 'all modes')
   call check_balance(full, 'published', 'all modes, published')
   call check_balance(every, 'exact', 'every floor')
   call check_balance(every, 'symmetric', 'every floor, symmetric')
   call check_balance(every, 'published', 'every floor, published')
   call check_balance(every//link, 'exact', 'every floor, link')
   call check_balance(hinged//storeys//"'every_floor' / ", 'exact', 'every floor, pinned')
   call check_balance(every//yields, 'exact', 'every floor, yielding')
   call check_balance(every//smooth, 'exact', 'every floor, Bouc and Wen')
   call check_balance(every//each_yields, 'exact', 'every floor, storeys that yield one by one')
   call check_balance(full//link, 'exact', 'all modes, link')
   call check_balance(reduced//link, 'exact', 'one mode, link')
   call checks%finish()

contains

   !> Check the balances of moments and of horizontal forces. The moments of all forces about the
   !> centroid equal its moment of inertia times theta''; the reactions follow from the balance of
   !> momentum only. The foundation's forces on wall, frame, cable and dampers sum to the base
   !> shear, which follows from the accelerations.
   subroutine check_balance(text, formulation, name)
      character(*), intent(in) :: text
      character(*), intent(in) :: formulation
      character(*), intent(in) :: name
      type(case_t) :: case
      type(error_t), allocatable :: error
      type(motion_t), target :: motion
      type(equation_t) :: equation
      type(reactions_t) :: reactions
      real(wp), allocatable :: y(:)
      real(wp), allocatable :: y_dot(:)
      real(wp) :: moment
      real(wp) :: shear
      real(wp) :: damper(2)
      integer :: side
      integer :: i
      integer :: j

      if (.not. checks%wants(name)) return
      call read_case_text(text//"&model formulation='"//formulation//"' / "//pulse, '', case, error)
      call checks%no_error(error, name//' is read')
      if (allocated(error)) return
      motion = motion_from_case(case)
      do side = -1, 1, 2
         call build_equation(case, motion, equation)
         call enter_interval(equation%model_t, equation%state, interval_at(motion, t))
         if (equation%has_impacts) call enter_side(equation%model_t, equation%state, side)
         ! the bilinear springs have yielded and unload
         if (equation%has_bilinear_springs) call load_to(equation%model_t, equation%state, &
            side*0.13_wp)
         do i = -1, 1, 2
            y = [side*0.11_wp, i*0.7_wp, (0.1_wp*j*i, j=3, equation%n)]
            y_dot = rates_of(equation, y)
            reactions = reactions_at(equation, t, y, y_dot)
            damper = corner_force(equation, y, y_dot(2))
            moment = turn(pivot(equation), [reactions%horizontal, reactions%normal], equation, y) &
               + turn_of_links(equation, case, y, y_dot) &
               + turn(cable_point(equation, y), cable_force(equation, y(1)), equation, y) &
               + turn(lifting_corner(equation, y), damper, equation, y) &
               + couple(equation, case, y, y_dot(2))
            call checks%close_to(moment, equation%p%R**2/3*y_dot(2), 'moments about centroid, ' &
               //name, atol=round_off*equation%p%g*equation%p%R*(1 + equation%p%gamma))
            shear = reactions%horizontal + sum([1.0_wp, 0.0_wp]*(cable_force(equation, y(1)) &
               + damper)) - frame_shear(equation, case, y)
            call checks%close_to(reactions%base_shear, shear, 'base shear, '//name, &
               atol=round_off*equation%p%g*(1 + equation%p%gamma))
            call check_base(equation, case, y, reactions, damper, name)
         end do
      end do
   end subroutine check_balance

   !> Check shear and moment in the wall just above its base. The library computes them from the
   !> forces above; the test computes them from the foundation's forces below.
   subroutine check_base(equation, case, y, reactions, damper, name)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      type(reactions_t), intent(in) :: reactions
      real(wp), intent(in) :: damper(2)
      character(*), intent(in) :: name
      type(building_t) :: building
      type(links_t) :: links
      real(wp) :: base(2), arm(2), inside(2), outside(2), below(2, 1), above(2, 1), y_dot(size(y))
      character(:), allocatable :: words

      y_dot = rates_of(equation, y)
      call building_of(case, equation, building)
      call links_of(building, equation, kinematics_at(equation, y(1)), t, y, y_dot, links)
      call find_forces_beside(equation, t, y, y_dot(2), links, [0.0_wp], below, above)
      inside = above(:, 1)
      base = place(equation, y(1), [0.0_wp, -case%wall%h])
      outside(1) = dot_product([cos(y(1)), -sin(y(1))], [reactions%horizontal, reactions%normal] &
         + damper)
      arm = pivot(equation) - base
      words = 'shear above the base, '//name
      call checks%close_to(inside(1), outside(1), words, atol=round_off*equation%p%g*(1 &
         + equation%p%gamma))
      outside(2) = arm(2)*reactions%horizontal - arm(1)*reactions%normal
      arm = lifting_corner(equation, y) - base
      outside(2) = outside(2) + arm(2)*damper(1) - arm(1)*damper(2) + couple(equation, case, y, &
         y_dot(2))
      words = 'moment above the base, '//name
      call checks%close_to(inside(2), outside(2), words, atol=round_off*equation%p%g &
         *equation%p%R*(1 + equation%p%gamma))
   end subroutine check_base

   !> Clockwise moment about the centroid of a force at a point in space.
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

   !> Clockwise moment of the devices under both corners of a hinged wall. Each device has the
   !> stroke s = 2b sin(theta/2). The fuses have yielded up to 0.13 rad and unload.
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
         force = case%damper%c(1)*b*cos(half)*y(2) + case%inerter%inertance_over_m_w &
            *(b*cos(half)*y_ddot - b*sin(half)*y(2)**2/2)
         largest = 2*b*sin(0.13_wp/2)
         force = force + sign(fuse%eta_y(1)*g*(1 + fuse%hardening(1)*(largest/fuse%stroke_y(1) &
            - 1)), half) &
            + fuse%eta_y(1)*g/fuse%stroke_y(1)*(2*b*sin(half) - sign(largest, half))
         couple = -2*force*b*cos(half)
      end associate
   end function couple

   !> Moment of the link forces on the wall. The wall has one link at the roof, or one at every
   !> floor on the line from the pivot to the roof's corner.
   real(wp) function turn_of_links(equation, case, y, y_dot) result(moment)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      real(wp) :: force(2)
      real(wp), allocatable :: pulls(:)
      !! of the floors on their links [m/s2]
      real(wp), allocatable :: share(:)
      !! height of the floors over the height of the frame [-]
      real(wp), allocatable :: forces(:)
      !! spring and damper force of the storeys [m/s2]
      integer :: i

      force = link_force(equation, kinematics_at(equation, y(1)), t, y, y_dot)
      moment = turn(link_corner(equation, case, y), force, equation, y)
      if (.not. has_all_links(case)) return
      associate (frame => case%frame%floors)
         share = [(sum(frame%height(:i)), i=1, size(frame%m))]/sum(frame%height)
         forces = resisting_roof(equation, case, y)*frame%k*frame%height/sum(frame%height)
         pulls = frame%m*(share*roof_ddot_of(equation, y, y_dot(2)) + ground(equation, t)) + forces
         pulls(:2) = pulls(:2) - forces(2:)
      end associate
      call checks%close_to(-force(1), sum(pulls), 'all links', rtol=1.0e-12_wp)
      moment = 0
      do i = 1, size(pulls)
         moment = moment + turn(pivot(equation) + share(i)*(link_corner(equation, case, y) &
            - pivot(equation)), force*pulls(i)/sum(pulls), equation, y)
      end do
   end function turn_of_links

   !> Roof displacement at which each storey, if elastic, would carry its spring and damper force
   !> [m]. All storeys share it, unless they yield one by one.
   function resisting_roof(equation, case, y) result(u)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp) :: u(size(case%frame%floors%m))
      type(kinematics_t) :: kin
      real(wp), allocatable :: parts(:)

      kin = kinematics_at(equation, y(1))
      u = equation%p%R*(equation%state%side*kin%u &
         + 2*case%frame%xi_s*case%frame%T_s/(2*pi)*kin%j*y(2))
      if (.not. allocated(case%yielding)) return
      if (equation%has_loading_direction) then
         u = u - lagging_displacement(equation, y)
      else
         parts = plastic_parts(equation, y(1))
         if (size(parts) == 1) parts = spread(parts(1), 1, size(u))
         u = u - parts
      end if
   end function resisting_roof

   real(wp) function roof_ddot_of(equation, y, y_ddot) result(u_ddot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      type(kinematics_t) :: kin

      kin = kinematics_at(equation, y(1))
      u_ddot = equation%p%R*(equation%state%side*kin%k*y(2)**2 + kin%j*y_ddot)
   end function roof_ddot_of

   !> Position of a point of the wall, given relative to its centroid [m].
   function place(equation, theta, point) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      real(wp), intent(in) :: point(2)
      real(wp) :: x(2)
      real(wp) :: arm(2)

      arm = point + [0.0_wp, equation%p%R*equation%p%cos_alpha] - pivot(equation)
      x = pivot(equation) + [cos(theta)*arm(1) + sin(theta)*arm(2), &
         -sin(theta)*arm(1) + cos(theta)*arm(2)]
   end function place

   function pivot(equation) result(x)
      type(equation_t), intent(in) :: equation
      real(wp) :: x(2)

      x = 0
      if (equation%has_impacts) x(1) = equation%state%side*equation%p%R*equation%p%sin_alpha
   end function pivot

   !> Point of the wall at the link. It is the top left corner; for `symmetric` the corner opposite
   !> the pivot; for a hinged wall the middle of the top.
   function link_corner(equation, case, y) result(x)
      type(equation_t), intent(in) :: equation
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = [-case%wall%b, case%wall%h]
      if (case%model%formulation == 'symmetric') x(1) = -equation%state%side*case%wall%b
      if (.not. equation%has_impacts) x(1) = 0
      x = place(equation, y(1), x)
   end function link_corner

   !> Anchor of the cable in the middle of the wall's top.
   function cable_point(equation, y) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = place(equation, y(1), [0.0_wp, equation%p%R*equation%p%cos_alpha])
   end function cable_point

   function lifting_corner(equation, y) result(x)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: x(2)

      x = place(equation, y(1), -equation%p%R*[equation%state%side*equation%p%sin_alpha, &
         equation%p%cos_alpha])
   end function lifting_corner

   !> Spring and damper force of the frame on its mass, against its motion.
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

      ! recompute u_s(theta) from the geometry; the derivative is a complex step
      phi = equation%state%side*y(1)
      w = cmplx(phi, step, wp)
      associate (s => equation%p%sin_alpha, c => equation%p%cos_alpha, L => equation%geometry%link)
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
      u = equation%state%side*equation%p%R*root%re
      slope = equation%p%R*root%im/step
      shear = equation%p%gamma*equation%p%omega_s*(equation%p%omega_s*u &
         + 2*equation%p%xi_s*slope*y(2))
      if (has_all_links(case)) then
         shear = case%frame%floors%k(1)*case%frame%floors%height(1) &
            /sum(case%frame%floors%height)*sum(resisting_roof(equation, case, y), &
            [.true., .false., .false.])
      else if (allocated(case%yielding)) then
         associate (law => case%yielding)
            shear = shear + equation%p%gamma*equation%p%omega_s**2*(1 - law%hardening) &
               *(law%u_y*y(3) - u)
         end associate
      else if (allocated(case%frame%floors)) then
         shear = storey_shear(equation, case, y, u, slope*y(2))
      end if
   end function frame_shear

   pure logical function has_all_links(case)
      type(case_t), intent(in) :: case

      has_all_links = .false.
      if (allocated(case%frame%floors)) has_all_links = case%frame%coupling == 'every_floor'
   end function has_all_links

   !> Shear of the columns of the lowest storey and of all dampers. With one mode it is the force on
   !> the floors minus the link force.
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

      associate (frame => case%frame%floors)
         if (case%frame%coupling == 'full') then
            shear = frame%k(1)*y(3) + sum(matmul(damping_matrix(frame, case%frame%xi_s), &
               [y(5:6), rate]))
            return
         end if
         kin = kinematics_at(equation, y(1))
         link = link_force(equation, kin, t, y, rates_of(equation, y))
         roof_ddot = equation%p%R*(equation%state%side*kin%k*y(2)**2 &
            + kin%j*second_derivative(equation, t, y))
         ! the link force balances the roof's modal equation; floor accelerations follow the mode
         ! shape
         call checks%close_to(-link(1), sum(frame%shape(:, 1)*(frame%m*(frame%shape(:, 1) &
            *roof_ddot/frame%shape(3, 1) + ground(equation, t)) + (frame%omega(1)**2*roof &
            + 2*case%frame%xi_s*frame%omega(1)*rate)*frame%m*frame%shape(:, 1) &
            /frame%shape(3, 1)))/frame%shape(3, 1), 'link of one mode', rtol=1.0e-12_wp)
         shear = -link(1) - sum(frame%m*(frame%shape(:, 1)/frame%shape(3, 1)*roof_ddot &
            + ground(equation, t)))
      end associate
   end function storey_shear

   function rates_of(equation, y) result(y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), allocatable :: y_dot(:)

      allocate (y_dot(size(y)))
      call rates_at(equation, t, y, y_dot)
   end function rates_of

   !> Return whether the link's end follows the top left corner while the wall rocks to the left.
   logical function is_left(equation)
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: large = 0.5_wp

      ! 2h sin(phi) of `exact` against 2R (sin(alpha) - sin(alpha - phi))
      is_left = .false.
      if (equation%state%side < 0) is_left = abs(kinematic_u(equation, large) &
         - 2*equation%p%cos_alpha*sin(large)) < 0.05_wp
   end function is_left

   real(wp) function kinematic_u(equation, phi) result(u)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: phi
      type(kinematics_t) :: kin

      kin = kinematics_at(equation, -phi, -1)
      u = kin%u
   end function kinematic_u

end program test_balance
