!> Forces between foundation and wall, from the balance of momentum (docs/theory, "Reactions"). All
!> forces are over m_w (bare frame: over m_s), positive as u_g'' and upward.
module rwmf_model_system_reactions
   use rwmf_core_kinds, only: wp
   use rwmf_model_bent_wall, only: mean_acceleration
   use rwmf_model_effects_numbers, only: inerter_effect
   use rwmf_model_elements, only: element_force, of_cable, of_coupling, of_damper, of_fuse, &
      of_restraint, sum_of_forces
   use rwmf_model_equation, only: equation_t, frame_displacement, frame_mass, ground, &
      kinematics_at, tip_acceleration, tip_displacement, tip_velocity, vertical_ground
   use rwmf_model_floor_motion, only: floor_accelerations, follows_roof
   use rwmf_model_floors_floor_forces, only: column_shears, floor_inertia, &
      forces_of_linked_floors, link_pulls, resistance
   use rwmf_model_hysteresis_bouc_wen, only: lagging_displacement
   use rwmf_model_hysteresis_spring_set, only: plastic_displacement, uneven_plastic_part
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_system_contributions, only: effects_frame_force
   use rwmf_model_system_reactions_loop, only: inerter_force
   implicit none
   private

   public :: normal_range, has_section_forces
   public :: reactions_t, reactions_at, friction_demand, link_force, cable_force, wall_drift
   public :: corner_force, plastic_part, roof_acceleration, link_tilt, impulse_from_rest

   !> Forces of the foundation on the structure at one instant.
   type :: reactions_t
      real(wp) :: normal
      !! normal force N on the base of the wall [m/s2]
      real(wp) :: horizontal
      !! horizontal force H on the base of the wall [m/s2]
      real(wp) :: base_shear
      !! force on wall and frame together, including anchors of cable and dampers [m/s2]
   end type reactions_t

contains

   !> Compute the reactions at a state of motion. For a wall at rest, pass zeros for its motion; N
   !> and H are then the resultants on the base in contact.
   type(reactions_t) function reactions_at(equation, t, y, y_dot) result(reactions)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      type(kinematics_t) :: kin
      real(wp) :: mean(2)
      !! acceleration of the wall's centroid [m/s2]
      real(wp) :: applied(2)
      !! force on the wall in addition to weight and foundation [m/s2]
      real(wp) :: on_frame(2)
      !! forces of further effects on the frame [m/s2]
      real(wp) :: u_ddot

      on_frame = effects_frame_force(equation, y)
      if (.not. equation%has_wall) then
         reactions = reactions_t(0, 0, y_dot(2) + ground(equation, t) &
            + floor_inertia(equation, t, y, y_dot(2)) - on_frame(2))
         return
      end if
      kin = kinematics_at(equation, y(1))
      mean = equation%p%R*[kin%c*y_dot(2) + equation%state%side*kin%s*y(2)**2, &
         equation%state%side*kin%s*y_dot(2) - kin%c*y(2)**2]
      if (equation%beam%n > 0) mean = mean + mean_acceleration(equation, y, y_dot)
      mean(1) = mean(1) + ground(equation, t)
      if (equation%has_vertical) mean(2) = mean(2) + vertical_ground(equation, t)
      applied = link_force(equation, kin, t, y, y_dot) + cable_force(equation, y(1)) &
         + corner_force(equation, y, y_dot(2))
      reactions%horizontal = mean(1) - applied(1)
      reactions%normal = mean(2) + equation%p%g - applied(2)
      reactions%base_shear = mean(1)
      if (.not. equation%has_frame) return
      if (allocated(equation%beam%floors)) then
         reactions%base_shear = reactions%base_shear + dot_product(equation%beam%floors%m, &
            floor_accelerations(equation, equation%state%side, y, y_dot) + ground(equation, t))
         return
      end if
      u_ddot = roof_acceleration(equation, kin, y, y_dot)
      reactions%base_shear = reactions%base_shear + equation%p%gamma*(u_ddot &
         + ground(equation, t)) + floor_inertia(equation, t, y, u_ddot) - on_frame(2)
   end function reactions_at

   !> Smallest and largest normal force on the base of a wall, of all walls. Couplings push one of
   !> the outer walls up and pull the other one down; restraints act on their wall alone [m/s2].
   function normal_range(equation, normal, y) result(range)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: normal
      !! mean over all walls [m/s2]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: range(2)
      real(wp) :: inner, force, outer(2)
      integer :: i

      range = normal
      if (equation%walls == 1 .or. .not. allocated(equation%elements)) return
      inner = normal
      outer = 0
      associate (side => equation%state%side)
         do i = 1, size(equation%elements)
            associate (element => equation%elements(i))
               if (element%group /= of_coupling .and. element%group /= of_restraint) cycle
               force = element_force(element, equation%state%springs, side, side*y(1), side*y(2))
               if (element%group == of_coupling) then
                  outer = outer + [-1, 1]*force
               else
                  inner = inner - element%weight*force
                  outer(merge(1, 2, element%offset < 0)) = outer(merge(1, 2, element%offset < 0)) &
                     + force
               end if
            end associate
         end do
      end associate
      outer = inner + outer
      range = [minval(outer), maxval(outer)]
      if (equation%walls > 2) range = [min(range(1), inner), max(range(2), inner)]
   end function normal_range

   !> True if shear and moment along the wall are known. Those of coupled walls are not, because the
   !> heights of the couplings are unknown.
   pure logical function has_section_forces(equation)
      type(equation_t), intent(in) :: equation

      has_section_forces = .true.
      if (allocated(equation%elements)) has_section_forces = all(equation%elements%group &
         /= of_coupling)
   end function has_section_forces

   !> Horizontal and vertical impulse of the foundation over m_w [m/s]. It sets a wall on its base,
   !> with all masses linked to it, from rest into motion on the present side.
   !>
   !> The reactions are linear in the accelerations. An impulse is to velocities as a force is to
   !> accelerations. Springs, dampers and ground motion give none. The difference of this impulse
   !> over an impact is that of the impact.
   function impulse_from_rest(equation, t, y) result(impulse)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states) at theta = 0
      real(wp) :: impulse(2)
      type(reactions_t) :: still, moving
      real(wp) :: y_dot(size(y)), scale

      y_dot = 0
      still = reactions_at(equation, t, y, y_dot)
      y_dot(2) = y(2)
      associate (n => equation%beam%n, first => equation%beam%first)
         if (n > 0) y_dot(first + n:first + 2*n - 1) = y(first + n:first + 2*n - 1)
      end associate
      ! forces of the size of the inertia, so that the difference has full precision
      scale = maxval(abs(y_dot))
      impulse = 0
      if (.not. scale > 0) return
      moving = reactions_at(equation, t, y, y_dot/scale)
      impulse = scale*[moving%horizontal - still%horizontal, moving%normal - still%normal]
   end function impulse_from_rest

   !> Friction demand |H|/N, the coefficient of friction that prevents sliding of the pivot [-].
   !> Without a compressive force on the pivot, it is the largest number.
   elemental real(wp) function friction_demand(reactions) result(demand)
      type(reactions_t), intent(in) :: reactions

      demand = huge(demand)
      if (abs(reactions%horizontal) < reactions%normal*sqrt(huge(demand))) then
         demand = abs(reactions%horizontal)/reactions%normal
      end if
   end function friction_demand

   !> Force of the links on the wall. That of a rigid link is the inertia force of the frame less
   !> the forces of its spring and damper. The rise of its corner tilts a link of finite length.
   function link_force(equation, kin, t, y, y_dot) result(force)
      type(equation_t), intent(in) :: equation
      type(kinematics_t), intent(in) :: kin
      !! kinematics at the current rotation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      real(wp) :: force(2)
      !! [m/s2]
      real(wp) :: resisting(equation%floors%n)
      !! forces of the storeys [m/s2]
      real(wp) :: on_frame(2)
      !! forces of further effects on the frame [m/s2]
      real(wp) :: u_ddot, at_roof
      !! acceleration of the roof [m/s2]; force of spring and damper there [m/s2]

      force = 0
      if (.not. equation%has_frame) return
      if (allocated(equation%beam%floors)) then
         force(1) = sum(forces_of_linked_floors(equation, t, y, y_dot))
         return
      else if (allocated(equation%floors%k_link)) then
         force(1) = -sum(link_pulls(equation, y))
         return
      end if
      associate (p => equation%p)
         u_ddot = roof_acceleration(equation, kin, y, y_dot)
         force(1) = -p%gamma*(u_ddot + equation%floors%excited_mass_ratio*ground(equation, t))
         if (allocated(equation%floors%m)) then
            resisting = resistance(equation, y)
            force(1) = force(1) - resisting(equation%floors%n)
         else
            force(1) = force(1) - p%gamma*p%omega_s*p%R &
               *(p%omega_s*equation%state%side*kin%u + 2*p%xi_s*kin%j*y(2))
            if (equation%beam%n > 0) force(1) = force(1) - p%gamma*p%omega_s*(p%omega_s &
               *tip_displacement(equation, y) + 2*p%xi_s*tip_velocity(equation, y))
         end if
         if (equation%has_bilinear_springs .or. equation%has_loading_direction &
             .or. yields_at_roof(equation)) then
            force(1) = force(1) + p%gamma*p%omega_squared*plastic_part(equation, y)
         end if
         if (equation%floors%are_linked) then
            ! With links at every floor the frame deflects in a straight line, and the storey shears
            ! are proportional to k_i h_i. They include dampers and yielding, except in storeys that
            ! yield separately. The lowest shear goes to the ground; the links carry the remaining
            ! momentum of the floors.
            at_roof = -force(1) - p%gamma*(u_ddot + equation%floors%excited_mass_ratio &
               *ground(equation, t))
            if (equation%has_bilinear_springs) at_roof = at_roof + p%gamma*p%omega_squared &
               *uneven_plastic_part(equation, y(1))
            force(1) = -p%gamma*(u_ddot + ground(equation, t)) - floor_inertia(equation, t, y, &
               u_ddot) - equation%floors%base_shear_ratio*at_roof
         end if
      end associate
      on_frame = effects_frame_force(equation, y)
      force(1) = force(1) - on_frame(1)
      force(2) = link_tilt(equation, kin)*force(1)
   end function link_force

   !> Ratio of vertical to horizontal force of the links on the wall [-]. All links have the tilt of
   !> the roof link.
   pure real(wp) function link_tilt(equation, kin) result(tilt)
      type(equation_t), intent(in) :: equation
      type(kinematics_t), intent(in) :: kin
      !! kinematics at the current rotation
      real(wp) :: side_of_frame
      !! 1, or -1 with the frame to the right of the wall

      tilt = 0
      if (equation%geometry%link <= 0) return
      ! with `symmetric` the frame changes its place with the side
      side_of_frame = equation%state%side*equation%geometry%tilt(equation%state%side)
      tilt = side_of_frame*kin%rise/sqrt(equation%geometry%link**2 - kin%rise**2)
   end function link_tilt

   !> Plastic displacement of the frame: the reduction of its force from the elastic one, over its
   !> elastic stiffness [m].
   real(wp) function plastic_part(equation, y)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      if (yields_at_roof(equation)) then
         plastic_part = frame_displacement(equation, equation%state%side, y) - sum(column_shears( &
            equation, y))/(frame_mass(equation)*equation%p%omega_squared)
      else if (equation%has_loading_direction) then
         plastic_part = lagging_displacement(equation, y)
      else
         plastic_part = plastic_displacement(equation, y(1))
      end if
   end function plastic_part

   !> True if the frame beside a bending wall yields as one spring at the roof.
   pure logical function yields_at_roof(equation)
      type(equation_t), intent(in) :: equation

      yields_at_roof = equation%floors%yields .and. follows_roof(equation)
   end function yields_at_roof

   !> Force of the tendons on the wall. With the law 'truss' they act along their straight lines,
   !> otherwise along the wall's axis. The axis is the only direction fixed to the wall in which a
   !> tendon on it has the arm R sin(alpha) about both corners.
   function cable_force(equation, theta) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: force(2)
      !! [m/s2]

      force = 0
      if (.not. equation%has_cable) return
      associate (state => equation%state)
         force = sum_of_forces(equation%elements, [of_cable], state%springs, state%side, &
            state%side*theta, 0.0_wp)
      end associate
   end function cable_force

   !> Force of devices and restraints on the wall, as a mean over all walls. On a hinged wall the
   !> devices at both corners form a couple without resultant.
   function corner_force(equation, y, y_ddot) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      real(wp) :: force(2)
      !! [m/s2]
      integer :: i

      force = 0
      associate (state => equation%state, side => equation%state%side, &
         terms => equation%scene%terms)
         if (allocated(equation%elements)) force = sum_of_forces(equation%elements, [of_fuse, &
            of_damper, of_restraint], state%springs, side, side*y(1), side*y(2))
         if (.not. equation%has_impacts) return
         do i = 1, size(terms)
            if (terms(i)%effect /= inerter_effect) cycle
            force = force - inerter_force(state%coef(1, terms(i)%coef), equation%p%R, &
               equation%p%sin_alpha, side*y(1), side*y(2), side*y_ddot) &
               *[sin(y(1)/2), cos(y(1)/2)]
         end do
      end associate
   end function corner_force

   !> Displacement of the middle of a rigid wall's top over its height [-]. It grows with |theta|.
   pure real(wp) function wall_drift(equation, theta) result(drift)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]

      drift = sin(theta)
      if (equation%has_impacts) then
         drift = drift + sign(sin(theta/2)**2, theta)*equation%p%sin_alpha/equation%p%cos_alpha
      end if
   end function wall_drift

   !> Acceleration u_s'' of the frame, at its roof, relative to the ground [m/s2].
   pure real(wp) function roof_acceleration(equation, kin, y, y_dot) result(u_ddot)
      type(equation_t), intent(in) :: equation
      type(kinematics_t), intent(in) :: kin
      !! kinematics at the current rotation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      u_ddot = equation%p%R*(equation%state%side*kin%k*y(2)**2 + kin%j*y_dot(2))
      if (equation%beam%n > 0) u_ddot = u_ddot + tip_acceleration(equation, y, y_dot)
   end function roof_acceleration

end module rwmf_model_system_reactions
