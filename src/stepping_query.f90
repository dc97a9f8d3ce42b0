!> What a host asks a wall between two calls: state, forces, events.
module rwmf_stepping_query
   use rwmf_bouc_wen, only: bouc_wen_residual
   use rwmf_cable, only: cable_state_t
   use rwmf_equation, only: cable_at, frame_displacement, kinematics_at, second_derivative
   use rwmf_errors, only: error_t
   use rwmf_hybrid, only: mode_overturned, mode_rest
   use rwmf_kinds, only: i8, wp
   use rwmf_kinematics, only: kinematics_t
   use rwmf_machine, only: machine_t
   use rwmf_memory_query, only: foot_residual, frame_residual
   use rwmf_result, only: event_t
   use rwmf_stepping, only: require, stepping_t
   use rwmf_storeys, only: resistance
   implicit none
   private

   public :: wall_state_t, wall_forces_t, query_state, query_forces, query_events

   !> Where the wall is. What the scene has not is zero.
   type :: wall_state_t
      real(wp) :: t
      !! time of this state: that of the last advance, or of overturning [s]
      logical :: at_rest
      logical :: overturned
      real(wp) :: theta
      !! rotation [rad]
      real(wp) :: theta_dot
      !! [rad/s]
      real(wp) :: theta_ddot
      !! [rad/s2]
      real(wp) :: u_s
      !! displacement of the frame relative to the ground [m]
      real(wp) :: u_s_dot
      !! [m/s]
      real(wp) :: u_s_ddot
      !! [m/s2]
      real(wp) :: u_s_max
      !! largest |u_s| so far [m]
      real(wp) :: theta_max
      !! largest |theta| so far [rad]
      integer(i8) :: impacts
      !! so far
      integer(i8) :: lift_offs
      !! so far
      integer(i8) :: steps
      !! of the integrator so far
   end type wall_state_t

   !> Forces in N; in N per kg of the wall when the case has no m_w (bare frame: of the frame).
   type :: wall_forces_t
      real(wp) :: link
      !! from the wall on the frame, positive towards positive u_s
      real(wp) :: frame_shear
      !! of spring and damper of the frame on its mass, with the sign of u_s
      real(wp) :: cable
      !! tension
   end type wall_forces_t

contains

   !> State at the present time.
   subroutine query_state(stepping, state, error)
      type(stepping_t), intent(in) :: stepping
      type(wall_state_t), intent(out) :: state
      type(error_t), allocatable, intent(out) :: error

      call require(stepping, error)
      if (allocated(error)) return
      associate (hybrid => stepping%machine%hybrid, observer => stepping%machine%observer)
         state%t = hybrid%t
         state%at_rest = hybrid%mode == mode_rest
         state%overturned = hybrid%mode == mode_overturned
         state%impacts = observer%impacts
         state%lift_offs = observer%lift_offs
         state%steps = stepping%machine%steps
         state%u_s_max = 0
         state%theta_max = 0
         if (stepping%machine%equation%has_wall) then
            state%theta_max = max(abs(hybrid%y(1)), observer%theta_max, -observer%theta_min)
         end if
      end associate
      call fill_motion(stepping%machine, state)
   end subroutine query_state

   !> Rotation and displacement with their rates.
   subroutine fill_motion(machine, state)
      type(machine_t), intent(in) :: machine
      type(wall_state_t), intent(inout) :: state
      type(kinematics_t) :: kin
      real(wp) :: y_ddot

      associate (equation => machine%equation, y => machine%hybrid%y)
         y_ddot = 0
         if (.not. state%at_rest) y_ddot = second_derivative(equation, machine%hybrid%t, y)
         state%theta = 0
         state%theta_dot = 0
         state%theta_ddot = 0
         state%u_s = 0
         state%u_s_dot = 0
         state%u_s_ddot = 0
         if (.not. equation%has_wall) then
            state%u_s = y(1)
            state%u_s_dot = y(2)
            state%u_s_ddot = y_ddot
         else
            state%theta = y(1)
            state%theta_dot = y(2)
            state%theta_ddot = y_ddot
            kin = kinematics_at(equation, y(1))
            if (equation%has_frame) then
               state%u_s = frame_displacement(equation, y(1))
               state%u_s_dot = equation%p%R*kin%j*y(2)
               state%u_s_ddot = equation%p%R*(equation%side*kin%k*y(2)**2 + kin%j*y_ddot)
            end if
         end if
         if (equation%has_frame) state%u_s_max = max(abs(state%u_s), machine%observer%u_max)
      end associate
   end subroutine fill_motion

   !> Forces at the present time.
   !>
   !> The link carries what the frame's mass needs beyond its own spring and damper, also at rest.
   subroutine query_forces(stepping, forces, error)
      type(stepping_t), intent(in) :: stepping
      type(wall_forces_t), intent(out) :: forces
      type(error_t), allocatable, intent(out) :: error
      type(wall_state_t) :: state
      type(cable_state_t) :: cable
      real(wp) :: frame_mass
      !! [kg]
      real(wp) :: restoring
      !! force of spring and damper on the mass at the link [N]
      real(wp), allocatable :: floor_forces(:)
      !! (floors) of `&storeys` with all modes [N]

      call query_state(stepping, state, error)
      if (allocated(error)) return
      forces = wall_forces_t(0, 0, 0)
      associate (machine => stepping%machine, p => stepping%machine%equation%p)
         frame_mass = machine%mass
         if (machine%equation%has_wall) frame_mass = p%gamma*machine%mass
         if (machine%equation%has_frame) then
            restoring = frame_mass*p%omega_s*(p%omega_s*(state%u_s - plastic_part(machine)) &
               + 2*p%xi_s*state%u_s_dot)
            forces%frame_shear = machine%equation%foot*(restoring + frame_mass*p%omega_squared &
               *uneven_part(machine))
         end if
         if (allocated(machine%equation%floors%m)) then
            floor_forces = machine%mass*resistance(machine%equation, machine%hybrid%y)
            forces%frame_shear = sum(floor_forces)
            restoring = floor_forces(size(floor_forces))
         end if
         if (machine%equation%has_frame .and. machine%equation%has_wall) then
            forces%link = frame_mass*(state%u_s_ddot + machine%equation%push*machine%ground) &
               + restoring
            if (machine%equation%links_floors) forces%link = link_of_floors(machine, state) &
               + forces%frame_shear
         end if
         if (machine%equation%has_cable) then
            cable = cable_at(machine%equation, machine%hybrid%y(1))
            forces%cable = machine%mass*p%g*cable%force
         end if
      end associate
   end subroutine query_forces

   !> What the floors' momentum takes from links at every floor, beyond the shear of the lowest
   !> storey [N].
   real(wp) function link_of_floors(machine, state) result(force)
      type(machine_t), intent(in) :: machine
      type(wall_state_t), intent(in) :: state

      associate (equation => machine%equation)
         force = machine%mass*(equation%p%gamma*(equation%push*state%u_s_ddot + machine%ground) &
            + equation%floor_mass*machine%ground)
      end associate
   end function link_of_floors

   !> Displacement of the frame by which its force is smaller than that of an elastic one [m].
   real(wp) function plastic_part(machine)
      type(machine_t), intent(in) :: machine

      plastic_part = 0
      if (machine%equation%has_course) then
         plastic_part = bouc_wen_residual(machine%equation, machine%hybrid%y)
      else if (machine%equation%has_memory) then
         plastic_part = frame_residual(machine%equation, machine%hybrid%y(1))
      end if
   end function plastic_part

   !> How far it differs from that of the lowest storey, where storeys yield one by one [m].
   real(wp) function uneven_part(machine)
      type(machine_t), intent(in) :: machine

      uneven_part = 0
      if (machine%equation%has_course .or. .not. machine%equation%has_memory) return
      associate (equation => machine%equation, theta => machine%hybrid%y(1))
         uneven_part = frame_residual(equation, theta) - foot_residual(equation, theta)
      end associate
   end function uneven_part

   !> Events of the last advance, in the order of time.
   subroutine query_events(stepping, events, error)
      type(stepping_t), intent(in) :: stepping
      type(event_t), allocatable, intent(out) :: events(:)
      !! (events)
      type(error_t), allocatable, intent(out) :: error

      call require(stepping, error)
      if (allocated(error)) return
      associate (observer => stepping%machine%observer)
         events = observer%events(:observer%n_events)
      end associate
   end subroutine query_events

end module rwmf_stepping_query
