!> Scene under static lateral loads: unbalanced forces, displacements of the loaded floors, and
!> equilibrium with one prescribed quantity.
!>
!> The positions are the rotation of the wall (bare frame: its displacement), the floors with states
!> and the modes of the wall. The unbalanced force of a position is its generalised mass times its
!> acceleration without ground motion, so that all loops of the equation of motion apply. The load
!> adds the virtual work of the pattern. States of smooth springs follow the positions.
module rwmf_simulation_pushover_static_scene
   use rwmf_core_kinds, only: wp
   use rwmf_math_linear_system, only: solve_system
   use rwmf_model_equation, only: frame_displacement, frame_mass, frame_motion, frame_travel, &
      hysteresis_t
   use rwmf_model_floor_motion, only: floor_motion, follows_roof, storey_motion
   use rwmf_model_hysteresis_bouc_wen_backbone, only: follow_state, state_slope
   use rwmf_model_kinematics, only: kinematics_of, kinematics_t
   use rwmf_model_lanes, only: lane_motion_t
   use rwmf_model_system_assembly, only: enter_side, equation_t
   use rwmf_model_system_demands, only: building_t
   use rwmf_model_system_energy, only: mechanical_energy
   use rwmf_simulation_recorder_force_envelopes, only: envelope_recorder_t
   use rwmf_simulation_static_rest, only: still_rates
   implicit none
   private

   public :: static_scene_t, prescribed_t, start_scene
   public :: loaded_displacements, loaded_slopes, static_forces, corner_moments
   public :: follow_positions, control_value, find_equilibrium, find_tangent, roof_can_move
   public :: of_roof, of_rotation, of_storey, of_smooth_frame, of_load, of_uplift
   public :: of_decompression, of_drift

   integer, parameter :: of_roof = 1
   !! displacement of the roof [m]
   integer, parameter :: of_rotation = 2
   !! rotation of the wall [rad]; bare frame, its displacement [m]
   integer, parameter :: of_storey = 3
   !! displacement of storey `number` over the one below [m]
   integer, parameter :: of_smooth_frame = 4
   !! displacement of a frame of a single mass [m]
   integer, parameter :: of_load = 5
   !! total load over the reference mass [m/s2]
   integer, parameter :: of_uplift = 6
   !! moment that lifts the resting wall towards the side `number` [m2/s2]
   integer, parameter :: of_decompression = 7
   !! moment at the base towards the side `number`, less that at which the pressure at the other
   !! edge vanishes [m2/s2]
   integer, parameter :: of_drift = 8
   !! drift `number` of the effect `effect` over its limit [-]

   !> Prescribed quantity.
   type :: prescribed_t
      integer :: kind = of_roof
      !! one of the `of_` numbers
      integer :: number = 0
      !! storey, side or drift
      integer :: effect = 0
      !! effect with limited drifts
      real(wp) :: target_value = 0
      !! prescribed value, in the unit of its kind
   end type prescribed_t

   !> Scene in static equilibrium.
   type :: static_scene_t
      type(equation_t) :: equation
      type(building_t) :: building
      real(wp), allocatable :: pattern(:)
      !! (loads) share of each floor in the load, sum 1; a wall without a frame has one load [-]
      integer, allocatable :: q(:)
      !! (positions) their indices among the states
      integer, allocatable :: v(:)
      !! (positions) indices of their velocities
      integer, allocatable :: z(:)
      !! (smooth springs) indices of their states
      real(wp), allocatable :: unit(:)
      !! (positions) displacement per unit [m]
      real(wp), allocatable :: y(:)
      !! (states) with zero velocities
      real(wp) :: load = 0
      !! total load over the reference mass [m/s2]
      real(wp) :: spent = 0
      !! energy dissipated by smooth springs [J/kg]
      real(wp) :: released = 0
      !! energy that jumps of the path would give to motion [J/kg]
      logical :: is_held = .false.
      !! both corners of the wall are on the base
      type(envelope_recorder_t) :: sections
      !! sections of the wall, and the strip under its base
      real(wp) :: tendon_stress = 0
      !! stress of the strands per force over m_w g [Pa]; 0: unknown
      real(wp), allocatable :: tendon_rupture(:)
      !! (tendons) strains at which they break [-]; absent if they do not
      logical :: has_offsets = .false.
      !! the case gives the places of the fuses
   end type static_scene_t

contains

   !> Set up the positions of a scene at rest.
   subroutine start_scene(scene)
      type(static_scene_t), intent(inout) :: scene
      !! with equation, building and pattern
      integer :: i

      associate (model => scene%equation%model_t)
         scene%q = [1, (model%floors%first + i, i=0, model%floors%free - 1)]
         scene%v = [2, (model%floors%first + model%floors%free + i, i=0, model%floors%free - 1)]
         scene%q = [scene%q, (model%beam%first + i, i=0, model%beam%n - 1)]
         scene%v = [scene%v, (model%beam%first + model%beam%n + i, i=0, model%beam%n - 1)]
         allocate (scene%unit(size(scene%q)), source=1.0_wp)
         scene%unit(1) = frame_travel(model)
         allocate (scene%z(0))
         if (model%has_loading_direction) scene%z = [model%hysteresis%place]
         if (allocated(model%floors%laws)) scene%z = model%floors%laws%place
         scene%is_held = model%has_impacts
      end associate
      allocate (scene%y(scene%equation%n), source=0.0_wp)
   end subroutine start_scene

   !> Displacements of the loaded floors, and the velocities that the velocities of y cause.
   subroutine move_floors(scene, y, u, u_dot)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: u(:)
      !! (loads) [m]
      real(wp), intent(out) :: u_dot(:)
      !! (loads) [m/s]
      real(wp) :: with_ground(0:size(u)), roof, roof_dot

      associate (equation => scene%equation)
         if (.not. follows_roof(equation)) then
            call floor_motion(equation, equation%state%side, y, with_ground, u_dot)
            u = with_ground(1:)
         else
            call frame_motion(equation, equation%state%side, y, roof, roof_dot)
            u = roof
            u_dot = roof_dot
            if (.not. allocated(scene%building%share)) return
            u = u*scene%building%share
            u_dot = u_dot*scene%building%share
         end if
      end associate
   end subroutine move_floors

   !> Displacements of the loaded floors relative to the ground [m].
   function loaded_displacements(scene, y) result(u)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u(size(scene%pattern)), u_dot(size(scene%pattern))

      call move_floors(scene, y, u, u_dot)
   end function loaded_displacements

   !> Derivatives of these displacements with respect to the positions [m/rad], [-].
   function loaded_slopes(scene, y) result(slopes)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: slopes(size(scene%pattern), size(scene%q))
      real(wp) :: along(size(y)), u(size(scene%pattern))
      integer :: k

      do k = 1, size(scene%q)
         along = y
         along(scene%v) = 0
         along(scene%v(k)) = 1
         call move_floors(scene, along, u, slopes(:, k))
      end do
   end function loaded_slopes

   !> Unbalanced forces of all positions, positive in their direction [m2/s2], [m/s2].
   function static_forces(scene, y, load) result(force)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states) with zero velocities
      real(wp), intent(in) :: load
      !! total load over the reference mass [m/s2]
      real(wp) :: force(size(scene%q))
      type(lane_motion_t) :: motion
      real(wp) :: rates(size(y)), slopes(size(scene%pattern), size(scene%q))
      type(kinematics_t) :: kin

      associate (equation => scene%equation, floors => scene%equation%floors)
         call still_rates(equation%model_t, equation%state, y, motion, rates)
         force = rates(scene%v)
         force(2:1 + floors%free) = floors%m(:floors%free)*force(2:1 + floors%free)
         slopes = loaded_slopes(scene, y)
         if (equation%beam%n > 0) then
            call weigh_modes(scene, y, force)
         else
            force(1) = equation%p%R**2*motion%side(1)*motion%moment(1)
            if (equation%has_wall) then
               ! `published` gives the link another arm
               kin = kinematics_of(equation%geometry, equation%state%side, &
                  equation%state%side*y(1))
               slopes(:, 1) = slopes(:, 1)*(kin%lever/kin%j)
            end if
         end if
      end associate
      force = force + load*matmul(scene%pattern, slopes)
   end function static_forces

   !> Multiply the accelerations of rotation and modes by their mass matrix. Its elements follow
   !> from the kinetic energy, a quadratic form of the velocities.
   subroutine weigh_modes(scene, y, force)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(inout) :: force(:)
      !! (positions) accelerations; on return forces
      real(wp) :: mass(0:scene%equation%beam%n, 0:scene%equation%beam%n)
      real(wp) :: along(size(y)), still, energy(0:scene%equation%beam%n)
      integer :: own(0:scene%equation%beam%n), i, j

      associate (n => scene%equation%beam%n)
         own = [1, (size(force) - n + i, i=1, n)]
         still = mechanical_energy(scene%equation, y)
         do i = 0, n
            do j = i, 0, -1
               along = y
               along(scene%v(own(i))) = 1
               if (j < i) along(scene%v(own(j))) = 1
               mass(i, j) = mechanical_energy(scene%equation, along) - still
               if (j == i) then
                  energy(i) = mass(i, i)
                  mass(i, i) = 2*energy(i)
               else
                  mass(i, j) = mass(i, j) - energy(i) - energy(j)
                  mass(j, i) = mass(i, j)
               end if
            end do
         end do
         force(own) = matmul(mass, force(own))
      end associate
   end subroutine weigh_modes

   !> Moments that lift the resting wall towards the left and the right side [m2/s2].
   function corner_moments(scene, y, load) result(moment)
      type(static_scene_t), intent(inout) :: scene
      !! its side remains
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: load
      !! [m/s2]
      real(wp) :: moment(-1:1)
      real(wp) :: force(size(scene%q))
      integer :: i, side

      moment = 0
      side = -scene%equation%state%side
      do i = 1, 2
         call enter_side(scene%equation%model_t, scene%equation%state, side)
         force = static_forces(scene, y, load)
         moment(side) = side*force(1)
         side = -side
      end do
   end function corner_moments

   !> Let the states of smooth springs follow the positions from those of the scene.
   subroutine follow_positions(scene, y, spent)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(inout) :: y(:)
      !! (states)
      real(wp), intent(out) :: spent
      !! energy dissipated on the way [J/kg]
      real(wp), dimension(scene%equation%floors%n_storeys) :: d, d_dot, before
      integer :: i

      spent = 0
      associate (equation => scene%equation, side => scene%equation%state%side)
         if (equation%has_loading_direction) then
            call follow_one(equation%hysteresis, frame_displacement(equation, side, y) &
               - frame_displacement(equation, side, scene%y), frame_mass(equation))
         else if (allocated(equation%floors%laws)) then
            call storey_motion(equation, side, scene%y, before, d_dot)
            call storey_motion(equation, side, y, d, d_dot)
            do i = 1, size(d)
               call follow_one(equation%floors%laws(i), d(i) - before(i), 1.0_wp)
            end do
         end if
      end associate

   contains

      !> Follow one spring.
      subroutine follow_one(law, change, mass)
         type(hysteresis_t), intent(in) :: law
         real(wp), intent(in) :: change
         real(wp), intent(in) :: mass
         real(wp) :: lost

         y(law%place) = scene%y(law%place)
         call follow_state(change/law%u_y, law%beta, law%exponent, y(law%place), lost)
         spent = spent + mass*law%force_at_z1*law%u_y*lost
      end subroutine follow_one
   end subroutine follow_positions

   !> Value of a quantity that may be prescribed, in its unit.
   real(wp) function control_value(scene, control, y, load) result(value)
      type(static_scene_t), intent(inout) :: scene
      type(prescribed_t), intent(in) :: control
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: load
      !! [m/s2]
      real(wp) :: u(size(scene%pattern)), moment(-1:1)
      real(wp), dimension(scene%equation%floors%n_storeys) :: d, d_dot
      real(wp), allocatable :: ratio(:), rate(:)

      associate (equation => scene%equation, side => scene%equation%state%side)
         select case (control%kind)
         case (of_roof)
            u = loaded_displacements(scene, y)
            value = u(size(u))
         case (of_rotation)
            value = y(1)
         case (of_storey)
            call storey_motion(equation, side, y, d, d_dot)
            value = d(control%number)
         case (of_smooth_frame)
            value = frame_displacement(equation, side, y)
         case (of_uplift)
            moment = corner_moments(scene, y, load)
            value = moment(control%number)
         case (of_decompression)
            ! M - N b and -M - N b on both corners; the pressure at an edge vanishes at M = N b/3
            moment = corner_moments(scene, y, load)
            value = control%number*(moment(1) - moment(-1))/2 + (moment(1) + moment(-1))/6
         case (of_drift)
            associate (effect => equation%effects(control%effect))
               allocate (ratio(effect%drifts), rate(effect%drifts))
               call effect%put_drifts(effect, equation, y, ratio, rate)
               value = ratio(control%number)
            end associate
         case default
            value = load
         end select
      end associate
   end function control_value

   !> Unbalanced forces of the free positions, then the prescribed quantity.
   function equations_of(scene, control, y, load) result(values)
      type(static_scene_t), intent(inout) :: scene
      type(prescribed_t), intent(in) :: control
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: load
      !! [m/s2]
      real(wp) :: values(size(scene%q) + merge(0, 1, scene%is_held))
      real(wp) :: force(size(scene%q))

      force = static_forces(scene, y, load)
      values = [force(merge(2, 1, scene%is_held):), control_value(scene, control, y, load)]
   end function equations_of

   !> Derivatives of `equations_of` with respect to the free positions and the load, by central
   !> differences. States of smooth springs follow the positions.
   subroutine differentiate(scene, control, y, load, slopes)
      type(static_scene_t), intent(inout) :: scene
      type(prescribed_t), intent(in) :: control
      real(wp), intent(in) :: y(:)
      !! (states) with zero velocities
      real(wp), intent(in) :: load
      !! [m/s2]
      real(wp), intent(out) :: slopes(:, :)
      !! (equations, unknowns)
      real(wp), parameter :: small = 1.0e-6_wp
      !! displacement [m]
      real(wp) :: along(size(y)), step
      integer :: k, first

      first = merge(2, 1, scene%is_held)
      do k = first, size(scene%q)
         step = small/scene%unit(k)
         along = 0
         if (size(scene%z) > 0) along(scene%z) = step*smooth_rates(scene, y, k)
         along(scene%q(k)) = step
         slopes(:, k - first + 1) = (equations_of(scene, control, y + along, load) &
            - equations_of(scene, control, y - along, load))/(2*step)
      end do
      ! all are linear in the load
      associate (step => scene%equation%p%g)
         slopes(:, size(slopes, 2)) = (equations_of(scene, control, y, load + step) &
            - equations_of(scene, control, y, load - step))/(2*step)
      end associate
   end subroutine differentiate

   !> Rates of the states of smooth springs per rate of a position, in the direction in which the
   !> springs have moved since the state of the scene.
   function smooth_rates(scene, y, k) result(rates)
      type(static_scene_t), intent(in) :: scene
      real(wp), intent(in) :: y(:)
      !! (states)
      integer, intent(in) :: k
      !! number of the position
      real(wp) :: rates(size(scene%z))
      real(wp) :: along(size(y))
      real(wp), dimension(scene%equation%floors%n_storeys) :: d, d_dot, before
      real(wp) :: u, u_dot, u_before
      integer :: i

      along = y
      along(scene%v(k)) = 1
      associate (equation => scene%equation, state => scene%equation%state)
         if (equation%has_loading_direction) then
            call frame_motion(equation, state%side, along, u, u_dot)
            u_before = frame_displacement(equation, state%side, scene%y)
            rates(1) = u_dot*slope_of(equation%hysteresis, u - u_before, &
               state%signs%loading_direction)
            return
         end if
         call storey_motion(equation, state%side, scene%y, before, d_dot)
         call storey_motion(equation, state%side, along, d, d_dot)
         do i = 1, size(rates)
            rates(i) = d_dot(i)*slope_of(equation%floors%laws(i), d(i) - before(i), &
               state%storey_signs(i)%loading_direction)
         end do
      end associate

   contains

      !> Slope of one spring [1/m].
      pure real(wp) function slope_of(law, change, direction) result(slope)
         type(hysteresis_t), intent(in) :: law
         real(wp), intent(in) :: change
         integer, intent(in) :: direction
         !! for a spring that has not moved
         real(wp) :: onward

         onward = change
         if (abs(change) <= 0) onward = direction
         slope = state_slope(onward, law%beta, law%exponent, y(law%place))/law%u_y
      end function slope_of
   end function smooth_rates

   !> Find the equilibrium with a prescribed quantity by Newton's method.
   !>
   !> Smooth springs have a corner where they turn. Between two corners full steps may alternate;
   !> some half steps end this.
   subroutine find_equilibrium(scene, control, y, load, is_found)
      type(static_scene_t), intent(inout) :: scene
      type(prescribed_t), intent(in) :: control
      real(wp), intent(inout) :: y(:)
      !! (states) first guess; on return in equilibrium
      real(wp), intent(inout) :: load
      !! [m/s2]
      logical, intent(out) :: is_found
      !! Newton's method has converged
      integer, parameter :: most_steps = 60, full = 12, half = 24
      !! largest number of steps; of full steps, and of these and half steps, at the beginning
      real(wp), parameter :: settled = 1.0e-9_wp
      !! relative change below which the changes must not grow [-]
      real(wp), parameter :: least = 1.0e-3_wp
      !! size of a small displacement [m], and of a small load over g [-]
      real(wp), allocatable :: slopes(:, :), values(:), change(:)
      real(wp) :: size_of_change, last, spent
      integer :: i, m, first

      first = merge(2, 1, scene%is_held)
      m = size(scene%q) - first + 2
      allocate (slopes(m, m), values(m), change(m))
      last = huge(last)
      do i = 1, most_steps
         call follow_positions(scene, y, spent)
         values = equations_of(scene, control, y, load)
         values(m) = values(m) - control%target_value
         call differentiate(scene, control, y, load, slopes)
         call solve_system(slopes, -values, change, is_found)
         if (.not. is_found) return
         if (i > full .and. i <= half) change = change/2
         y(scene%q(first:)) = y(scene%q(first:)) + change(:m - 1)
         load = load + change(m)
         ! largest change of the unknowns over their sizes [-]
         size_of_change = maxval(abs(change(:m - 1)*scene%unit(first:)))/(least &
            + maxval(abs(y(scene%q)*scene%unit)))
         size_of_change = max(size_of_change, abs(change(m))/(least*scene%equation%p%g + abs(load)))
         is_found = size_of_change <= epsilon(last) .or. (size_of_change < settled &
            .and. size_of_change >= last/2)
         if (is_found) exit
         last = size_of_change
         if (.not. last < huge(last)) return
      end do
      call follow_positions(scene, y, spent)
   end subroutine find_equilibrium

   !> Find the rates of positions and load per rate of a quantity.
   subroutine find_tangent(scene, control, rates, load_rate, is_found)
      type(static_scene_t), intent(inout) :: scene
      type(prescribed_t), intent(in) :: control
      !! its quantity has the rate `target_value`
      real(wp), intent(out) :: rates(:)
      !! (positions) 0 for a wall on its base [rad/m], [-]
      real(wp), intent(out) :: load_rate
      !! [1/s2]
      logical, intent(out) :: is_found
      !! the system is regular
      real(wp), allocatable :: slopes(:, :), right(:), found(:)
      integer :: m, first

      first = merge(2, 1, scene%is_held)
      m = size(scene%q) - first + 2
      allocate (slopes(m, m), right(m), found(m))
      call differentiate(scene, control, scene%y, scene%load, slopes)
      right = 0
      right(m) = control%target_value
      rates = 0
      load_rate = 0
      call solve_system(slopes, right, found, is_found)
      if (.not. is_found) return
      rates(first:) = found(:m - 1)
      load_rate = found(m)
   end subroutine find_tangent

   !> True if the roof can move in the present contact.
   logical function roof_can_move(scene)
      type(static_scene_t), intent(in) :: scene
      real(wp) :: slopes(size(scene%pattern), size(scene%q))

      slopes = loaded_slopes(scene, scene%y)
      roof_can_move = any(abs(slopes(size(scene%pattern), merge(2, 1, scene%is_held):)) > 0)
   end function roof_can_move

end module rwmf_simulation_pushover_static_scene
