!> A frame of several storeys whose roof is linked to the wall, with all its modes.
!>
!> The rotation moves the roof; the floors below it are free. Their displacements u_i and
!> velocities v_i relative to the ground are states of their own, so that an impact, which gives the
!> roof a jump of velocity, leaves them as they are:
!>
!>    m_i (v_i' + u_g'') = k_(i+1) (u_(i+1) - u_i) - k_i (u_i - u_(i-1)) - (C v)_i,   i < n
!>
!> The roof's own mass and the stiffness of the storey below it are the frame of `equation.f90`
!> (gamma and omega_s); this file adds what the floors below do to it.
module rwmf_storeys
   use rwmf_case, only: case_t
   use rwmf_kinds, only: pi, wp
   use rwmf_kinematics, only: kinematics_t
   use rwmf_scene, only: equation_t, frame_displacement, frame_mass, frame_travel, &
      frame_velocity, ground
   use rwmf_shear_frame, only: damping_matrix, foot_share, roof_factor, shear_frame_t
   implicit none
   private

   public :: prepare_storeys, add_push, push_input, add_storeys, storey_rates, storey_sizes
   public :: storey_power, storey_energy, storey_input, resistance, floor_inertia
   public :: floor_columns, floor_values

contains

   !> Put the frame's storeys into the equation. In a spectrum all stiffnesses follow the period.
   subroutine prepare_storeys(case, equation)
      type(case_t), intent(in) :: case
      !! with `&storeys` and its modes
      type(equation_t), intent(inout) :: equation
      type(shear_frame_t) :: frame
      real(wp) :: unit
      !! mass that energies are per, over m_w: the wall's, without wall the roof's [-]
      real(wp) :: pace
      !! of the frame in this scene [-]
      integer :: n

      frame = case%storeys%frame
      n = size(frame%m)
      if (case%storeys%coupling /= 'full') then
         equation%push = roof_factor(frame, 1)
         equation%foot = equation%push
         equation%links_floors = case%storeys%coupling == 'every_floor'
         if (equation%links_floors) equation%foot = foot_share(frame)
         equation%floor_mass = frame_mass(equation)*(sum(frame%m)*frame%shape(n, 1)**2 - 1)
         return
      end if
      unit = 1
      if (.not. allocated(case%wall)) unit = frame%m(n)
      pace = 2*pi/case%frame%T_s/frame%omega(1)
      equation%floors%m = frame%m/unit
      equation%floors%height = frame%height
      equation%floors%k = frame%k*pace**2/unit
      equation%floor_mass = sum(equation%floors%m(:n - 1))
      equation%floors%c = damping_matrix(frame, case%frame%xi_s)*(pace/unit)
      equation%quickest = frame%omega(n)*pace
      equation%p%omega_s = sqrt(equation%floors%k(n)/equation%floors%m(n))
      equation%p%omega_squared = equation%p%omega_s**2
      equation%p%xi_s = 0
      equation%p%two_xi_omega = 0
      equation%moves_at_rest = equation%has_impacts .and. n > 1
   end subroutine prepare_storeys

   !> One mode: the ground pushes more of the frame than moves with the roof.
   subroutine add_push(equation, t, y, kin, inertia, moment)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment

      moment = moment - frame_mass(equation)*(equation%push - 1)*kin%lever*equation%side &
         *ground(equation, t)/equation%p%R
   end subroutine add_push

   !> Power of that push [W/kg].
   real(wp) function push_input(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)

      power = -frame_mass(equation)*(equation%push - 1)*ground(equation, t) &
         *frame_velocity(equation, y)
   end function push_input

   !> Force of the storeys on the roof beyond that of the spring between roof and ground.
   subroutine add_storeys(equation, t, y, kin, inertia, moment)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp) :: force(size(equation%floors%m))
      integer :: n

      n = size(force)
      force = resistance(equation, y)
      moment = moment - kin%lever*(equation%side*force(n)/equation%p%R &
         - equation%floors%k(n)*kin%u)
   end subroutine add_storeys

   !> Velocities and accelerations of the floors below the roof.
   subroutine storey_rates(equation, t, y, rates)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: rates(:)
      real(wp) :: force(size(equation%floors%m))
      integer :: n

      n = size(force)
      force = resistance(equation, y)
      rates(:n - 1) = velocities(equation, y)
      rates(n:) = -force(:n - 1)/equation%floors%m(:n - 1) - ground(equation, t)
   end subroutine storey_rates

   !> Forces K u + C v with which the storeys resist the motion of floors and roof [m/s2].
   function resistance(equation, y) result(force)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: force(size(equation%floors%m))
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))
      real(wp) :: shear(size(equation%floors%m))
      !! of each storey's columns
      integer :: n

      n = size(force)
      call floor_motion(equation, y, u, v)
      shear = equation%floors%k*(u(1:) - u(:n - 1))
      force = matmul(equation%floors%c, v) + shear
      force(:n - 1) = force(:n - 1) - shear(2:)
   end function resistance

   !> Rate of momentum of the floors below the roof that its own motion does not say; zero without
   !> storeys [m/s2].
   !>
   !> One mode: they move as their share of the roof, and the modes that are left out follow the
   !> ground. All modes: what the storeys do to them.
   real(wp) function floor_inertia(equation, t, y, u_ddot) result(inertia)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: u_ddot
      !! acceleration of the roof relative to the ground [m/s2]
      real(wp), allocatable :: force(:)

      if (allocated(equation%floors%m)) then
         force = resistance(equation, y)
         inertia = -sum(force(:size(force) - 1))
      else
         inertia = frame_mass(equation)*(equation%push - 1)*u_ddot &
            + equation%floor_mass*ground(equation, t)
      end if
   end function floor_inertia

   !> Displacements and velocities of ground, floors and roof relative to the ground.
   subroutine floor_motion(equation, y, u, v)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: u(0:)
      !! (0:n) [m]
      real(wp), intent(out) :: v(:)
      !! (n) [m/s]
      integer :: n

      n = size(v)
      u(0) = 0
      u(1:n - 1) = y(equation%floors%first:equation%floors%first + n - 2)
      v(:n - 1) = velocities(equation, y)
      u(n) = frame_displacement(equation, y(1))
      v(n) = frame_velocity(equation, y)
   end subroutine floor_motion

   !> Columns of the history of a frame with all its modes; none for others.
   pure function floor_columns(equation) result(names)
      class(equation_t), intent(in) :: equation
      character(32), allocatable :: names(:)
      integer :: n
      integer :: i

      allocate (names(0))
      if (.not. allocated(equation%floors%m)) return
      n = size(equation%floors%m)
      deallocate (names)
      allocate (names(2*n - 1))
      do i = 1, n
         if (i < n) write (names(i), '(a, i0, a)') 'floor_', i, '_m'
         write (names(n - 1 + i), '(a, i0, a)') 'storey_', i, '_drift'
      end do
   end function floor_columns

   !> Their values: displacements of the floors below the roof relative to the ground [m], and what
   !> each storey is displaced by over its height [-].
   function floor_values(equation, y) result(values)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: values(2*size(equation%floors%m) - 1)
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))
      integer :: n

      n = size(v)
      call floor_motion(equation, y, u, v)
      values(:n - 1) = u(1:n - 1)
      values(n:) = (u(1:) - u(:n - 1))/equation%floors%height
   end function floor_values

   !> Of the floors below the roof [m/s].
   pure function velocities(equation, y) result(v)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: v(size(equation%floors%m) - 1)

      associate (first => equation%floors%first + size(v))
         v = y(first:first + size(v) - 1)
      end associate
   end function velocities

   !> The floors move about as much as the roof.
   subroutine storey_sizes(equation, size_guess, sizes)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      real(wp), intent(out) :: sizes(:)

      sizes(:size(sizes)/2) = frame_travel(equation)*size_guess(1)
      sizes(size(sizes)/2 + 1:) = frame_travel(equation)*size_guess(2)
   end subroutine storey_sizes

   !> Power that the frame's dampers take [W/kg].
   real(wp) function storey_power(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))

      call floor_motion(equation, y, u, v)
      power = dot_product(v, matmul(equation%floors%c, v))
   end function storey_power

   !> Energy of the floors and storeys; the roof by itself is counted elsewhere [J/kg].
   real(wp) function storey_energy(equation, y) result(energy)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))
      integer :: n

      n = size(v)
      call floor_motion(equation, y, u, v)
      energy = (sum(equation%floors%m(:n - 1)*v(:n - 1)**2) &
         + sum(equation%floors%k*(u(1:) - u(:n - 1))**2) - equation%floors%k(n)*u(n)**2)/2
   end function storey_energy

   !> Power of the ground motion on the floors below the roof [W/kg].
   real(wp) function storey_input(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      integer :: n

      n = size(equation%floors%m)
      power = -ground(equation, t)*dot_product(equation%floors%m(:n - 1), velocities(equation, y))
   end function storey_input

end module rwmf_storeys
