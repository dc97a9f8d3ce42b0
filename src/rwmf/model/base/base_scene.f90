!> Wall on a base that gives: constants of the equations of docs/theory/base.md, per unit m_w.
!>
!> The generalised displacements of the frame are w = (x, u_r, q): the slip of the base, the
!> displacement of the wall's top over it, and the floors that move by themselves.
module rwmf_model_base_base_scene
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_elements, only: element_t, of_damper, of_fuse
   use rwmf_model_hysteresis_spring_laws, only: load_spring, new_branch, new_spring, spring_force
   use rwmf_model_spring, only: branch_t, spring_t
   use rwmf_problem_case, only: base_t, case_t, devices_t, has_all_modes, has_floors
   use rwmf_problem_frame_strength, only: frame_hardening, frame_law, has_strength, &
      yield_displacement
   use rwmf_problem_shear_frame, only: damping_matrix, roof_factor, shear_frame_t, stiffness_matrix
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: base_scene_t, build_base_scene, settlement_at_rest, elongations, loaded_springs

   !> Floors of the frame and their connection to the wall. All masses are over m_w.
   type :: base_frame_t
      integer :: n = 0
      !! number of floors; 0 without a frame
      integer :: free = 0
      !! number of floors that move by themselves: the lowest
      real(wp), allocatable :: follows(:, :)
      !! (floors, 2 + free) displacement of each floor per unit of w
      real(wp), allocatable :: m(:)
      !! (floors) mass [-]
      real(wp), allocatable :: height(:)
      !! (floors) height of each storey [m]; not allocated for a single mass
      real(wp) :: mass(2, 2) = 0
      !! mass of the linked floors for x and u_r [-]
      real(wp) :: excited(2) = 0
      !! their mass that the ground motion excites [-]
      real(wp), allocatable :: k(:, :)
      !! (2 + free, 2 + free) stiffness for w, without a spring that yields [1/s2]
      real(wp), allocatable :: c(:, :)
      !! (2 + free, 2 + free) damping for w [1/s]
   end type base_frame_t

   !> Constants of one scene.
   type :: base_scene_t
      real(wp) :: g
      !! [m/s2]
      real(wp) :: h, b
      !! half height and half width of the wall [m]
      real(wp) :: alpha
      !! slenderness [rad]
      real(wp) :: inertia
      !! (4 h**2 + b**2)/3, of the wall about the middle of its base [m2]
      real(wp) :: kappa
      !! stiffness of the base per length [1/(m s2)]
      real(wp) :: delay
      !! damping of the base over its stiffness [s]
      real(wp) :: mu
      !! coefficient of friction; infinite without sliding [-]
      logical :: slides
      integer :: strips
      !! number of strips that crush; 0 for an elastic base
      real(wp) :: d_y
      !! settlement at crushing [m]
      real(wp), allocatable :: place(:)
      !! (strips) distance of each strip to the right of the middle [m]
      real(wp) :: width
      !! width of a strip [m]
      real(wp) :: z_0
      !! height of the middle of the base at rest [m]
      logical :: has_tendon
      real(wp) :: eta_0
      !! force of the tendon at rest over m_w g [-]
      real(wp) :: eta_slope
      !! its increase per length over m_w g [1/m]
      real(wp) :: l_0
      !! its length at rest [m]
      type(element_t), allocatable :: devices(:)
      !! fuses and dampers under the base, fuses first
      type(spring_t), allocatable :: springs(:)
      !! those of the fuses, then that of a frame that yields
      integer :: fuses = 0
      !! number of fuses
      type(base_frame_t) :: frame
   end type base_scene_t

contains

   !> Set up the constants of a scene.
   !>
   !> Errors: `err_input` if the base crushes under the wall at rest.
   subroutine build_base_scene(case, scene, error)
      type(case_t), intent(in) :: case
      !! valid case with `&base`, whose frame has T_s
      type(base_scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      scene%g = case%model%g
      scene%h = case%wall%h
      scene%b = case%wall%b
      scene%alpha = atan2(scene%b, scene%h)
      scene%inertia = (4*scene%h**2 + scene%b**2)/3
      associate (base => case%compliant_base)
         scene%kappa = base%stiffness
         scene%delay = 2*base%xi/sqrt(2*scene%b*scene%kappa)
         if (allocated(base%delay)) scene%delay = base%delay
         scene%slides = allocated(base%mu)
         scene%mu = huge(scene%mu)
         if (scene%slides) scene%mu = base%mu
         scene%strips = merge(base%strips, 0, allocated(base%d_y))
         scene%d_y = huge(scene%d_y)
         if (allocated(base%d_y)) scene%d_y = base%d_y
      end associate
      scene%width = 2*scene%b/max(1, scene%strips)
      scene%place = [(-scene%b + (i - 0.5_wp)*scene%width, i=1, scene%strips)]
      scene%has_tendon = allocated(case%cable)
      scene%eta_0 = 0
      if (scene%has_tendon) scene%eta_0 = sum(case%cable%eta_0)
      scene%z_0 = -scene%g*(1 + scene%eta_0)/(2*scene%b*scene%kappa)
      call check_strength(case%compliant_base, scene, error)
      if (.not. allocated(error)) call check_delay(case%compliant_base, scene, error)
      if (allocated(error)) return
      if (scene%has_tendon) call add_tendon(case, scene)
      allocate (scene%devices(0), scene%springs(0))
      if (allocated(case%fuse)) call add_devices(case%fuse, of_fuse, scene)
      scene%fuses = size(scene%springs)
      if (allocated(case%damper)) call add_devices(case%damper, of_damper, scene)
      scene%frame%m = [real(wp) ::]
      if (allocated(case%frame)) call add_frame(case, scene)
   end subroutine build_base_scene

   !> Check that the strip does not nearly crush under the wall at rest.
   subroutine check_strength(base, scene, error)
      type(base_t), intent(in) :: base
      type(base_scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: reserve = 1.2_wp
      !! [-]

      if (scene%strips == 0 .or. scene%d_y > -reserve*scene%z_0) return
      call fail(error, err_input, '&base: d_y = '//trim(real_to_text(scene%d_y))//' m must be > ' &
         //trim(real_to_text(-reserve*scene%z_0))//' m, 1.2 times the settlement under N_0 = ' &
         //trim(real_to_text(1 + scene%eta_0))//' m_w g: p_y > 1.2 N_0/(2 b t)')
      if (base%modulus > 0) error%message = error%message//' = ' &
         //trim(real_to_text(-reserve*scene%z_0*base%modulus))//' Pa'
   end subroutine check_strength

   !> Check that a delay is no more damping than `xi` may be.
   subroutine check_delay(base, scene, error)
      type(base_t), intent(in) :: base
      type(base_scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: most = 3
      !! [-]

      associate (xi => scene%delay*sqrt(2*scene%b*scene%kappa)/2)
         if (.not. allocated(base%delay) .or. xi <= most) return
         call fail(error, err_input, '&base: delay = '//trim(real_to_text(scene%delay)) &
            //' s gives xi = '//trim(real_to_text(xi))//', must be in [0, 3]')
      end associate
   end subroutine check_delay

   !> Add the straight tendon, stressed on the settled wall. Eq. (1) sets its stiffness, between
   !> rest and the rotation alpha about a corner that does not settle.
   pure subroutine add_tendon(case, scene)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(inout) :: scene
      real(wp) :: s, versine
      real(wp) :: stretch
      !! of the tendon at the rotation alpha [m]

      s = sin(scene%alpha)
      versine = 2*sin(scene%alpha/2)**2
      associate (h => scene%h, b => scene%b)
         stretch = 2*b*(2*h*s + b*versine)
         stretch = stretch/(2*h + sqrt(4*h**2 + stretch))
      end associate
      scene%l_0 = 2*scene%h + scene%z_0
      scene%eta_slope = (sum(case%cable%eta_alpha) - scene%eta_0)/stretch
   end subroutine add_tendon

   !> Add the devices of a group, under the corners unless it gives their places.
   subroutine add_devices(devices, group, scene)
      type(devices_t), intent(in) :: devices
      integer, intent(in) :: group
      !! number of the group
      type(base_scene_t), intent(inout) :: scene
      type(element_t) :: device
      real(wp), allocatable :: offset(:)
      integer :: i

      offset = [-scene%b, scene%b]
      if (allocated(devices%offset)) offset = devices%offset
      do i = 1, size(offset)
         device = element_t(group, offset=offset(i))
         if (allocated(devices%c)) device%c = devices%c(i)
         if (allocated(devices%eta_y)) then
            scene%springs = [scene%springs, new_spring(devices%eta_y(i)*scene%g &
               /devices%stroke_y(i), devices%eta_y(i)*scene%g, devices%hardening(i), &
               law=devices%law)]
            device%spring = size(scene%springs)
         end if
         scene%devices = [scene%devices, device]
      end do
   end subroutine add_devices

   !> Add the floors of the frame and their connection to the wall.
   subroutine add_frame(case, scene)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(inout) :: scene
      type(shear_frame_t) :: floors
      real(wp), allocatable :: c(:, :), k(:, :), share(:), bend(:)
      real(wp) :: pace, omega
      integer :: i

      omega = 2*pi/case%frame%T_s
      associate (frame => scene%frame)
         if (has_floors(case)) floors = case%frame%floors
         if (has_floors(case) .and. (has_all_modes(case) .or. case%frame%coupling &
             == 'every_floor')) then
            pace = omega/floors%omega(1)
            frame%m = floors%m
            if (.not. has_all_modes(case)) frame%m = floors%m*case%frame%gamma &
               *floors%shape(size(floors%m), 1)**2
            frame%n = size(frame%m)
            k = stiffness_matrix(floors%k*pace**2*frame%m/floors%m)
            c = damping_matrix(floors, case%frame%xi_s)*pace
            if (.not. has_all_modes(case)) c = case%frame%xi_s*case%frame%T_s/pi*k
         else
            ! a single mass, or the first mode of storeys at the displacement of the roof
            frame%n = 1
            frame%m = [case%frame%gamma]
            k = reshape([case%frame%gamma*omega**2], [1, 1])
            c = 2*case%frame%xi_s/omega*k
            if (has_strength(case)) then
               scene%springs = [scene%springs, new_spring(k(1, 1), k(1, 1) &
                  *yield_displacement(case), frame_hardening(case), law=frame_law(case))]
               k = 0
            end if
         end if
         if (has_floors(case)) frame%height = floors%height
         share = spread(1.0_wp, 1, frame%n)
         if (frame%n > 1) share = [(sum(floors%height(:i)), i=1, frame%n)]/sum(floors%height)
         frame%free = 0
         if (has_all_modes(case)) frame%free = frame%n - 1
         if (allocated(case%frame%k_link)) frame%free = frame%n
         allocate (frame%follows(frame%n, 2 + frame%free), source=0.0_wp)
         do i = 1, frame%n
            if (i <= frame%free) frame%follows(i, 2 + i) = 1
            if (i > frame%free) frame%follows(i, :2) = [1.0_wp, share(i)]
         end do
         associate (P => frame%follows)
            frame%k = matmul(transpose(P), matmul(k, P))
            frame%c = matmul(transpose(P), matmul(c, P))
            do i = frame%free + 1, frame%n
               frame%mass = frame%mass + frame%m(i)*spread(P(i, :2), 1, 2)*spread(P(i, :2), 2, 2)
               frame%excited = frame%excited + frame%m(i)*P(i, :2)
            end do
         end associate
         if (has_floors(case) .and. frame%n == 1) frame%excited = frame%excited &
            *roof_factor(floors, 1)
         if (.not. allocated(case%frame%k_link)) return
         do i = 1, frame%n
            bend = [1.0_wp, share(i), -frame%follows(i, 3:)]
            frame%k = frame%k + case%frame%k_link(i)*spread(bend, 1, size(bend)) &
               *spread(bend, 2, size(bend))
         end do
      end associate
   end subroutine add_frame

   !> Elongations of the springs in a state [m].
   pure function elongations(scene, y) result(x)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states) theta, theta', x, x', z, z' and further ones
      real(wp) :: x(size(scene%springs))

      associate (half => y(1)/2)
         x = y(3) + 2*scene%h*sin(y(1)) + 2*scene%b*sin(half)**2
         x(:scene%fuses) = y(3)*sin(half) + (y(5) - scene%z_0)*cos(half) - 2*sin(half) &
            *scene%devices(:scene%fuses)%offset
      end associate
   end function elongations

   !> Branches of the springs as if they had been loaded slowly up to a state.
   pure function loaded_springs(scene, y) result(branches)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      type(branch_t) :: branches(size(scene%springs))
      real(wp) :: x(size(scene%springs))
      integer :: i

      x = elongations(scene, y)
      branches = new_branch(scene%springs)
      do i = 1, size(x)
         call load_spring(scene%springs(i), branches(i), x(i))
      end do
   end function loaded_springs

   !> Height of the middle of the base under a wall held at a rotation: the base balances the
   !> vertical force of weight, tendon and fuses [m].
   pure real(wp) function settlement_at_rest(scene, theta) result(z)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: theta
      !! [rad]
      integer, parameter :: halvings = 100
      real(wp) :: ends(2)
      !! places where the base bears too much and too little [m]
      integer :: i

      z = scene%z_0
      if (.not. abs(theta) > 0) return
      ends = [z - scene%b*abs(sin(theta)), scene%b*abs(sin(theta))]
      do i = 1, halvings
         if (bearing(scene, theta, ends(1)) > load_on(scene, theta, ends(1))) exit
         ends(1) = 2*ends(1)
      end do
      do i = 1, halvings
         z = sum(ends)/2
         ends(merge(1, 2, bearing(scene, theta, z) > load_on(scene, theta, z))) = z
      end do
   end function settlement_at_rest

   !> Force of the base at rest over m_w [m/s2].
   pure real(wp) function bearing(scene, theta, z) result(force)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp), intent(in) :: z
      !! height of the middle of the base [m]
      real(wp) :: s, deep, contact

      s = abs(sin(theta))
      if (scene%strips > 0) then
         force = scene%kappa*scene%width*sum(min(scene%d_y, max(0.0_wp, scene%place*s - z)))
      else
         deep = max(0.0_wp, scene%b*s - z)
         contact = min(2*scene%b, deep/s)
         force = scene%kappa*contact*(deep - contact*s/2)
      end if
   end function bearing

   !> Weight and vertical force of tendon and fuses on a turned wall, over m_w [m/s2].
   pure real(wp) function load_on(scene, theta, z) result(force)
      type(base_scene_t), intent(in) :: scene
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp), intent(in) :: z
      !! height of the middle of the base [m]
      real(wp) :: span(2), y(6), pull(size(scene%springs))
      !! of the tendon [m], states, forces of the springs [m/s2]

      y = [theta, 0.0_wp, 0.0_wp, 0.0_wp, z, 0.0_wp]
      pull = spring_force(scene%springs, loaded_springs(scene, y), elongations(scene, y))
      force = scene%g + cos(theta/2)*sum(pull(:scene%fuses))
      if (.not. scene%has_tendon) return
      span = [2*scene%h*sin(theta), z + 2*scene%h*cos(theta)]
      force = force + scene%g*max(0.0_wp, scene%eta_0 + scene%eta_slope*(norm2(span) &
         - scene%l_0))*span(2)/norm2(span)
   end function load_on

end module rwmf_model_base_base_scene
