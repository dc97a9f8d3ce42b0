!> Energies and powers of wall, frame and cable per unit m_w (bare frame: m_s).
!>
!> The energies follow the virtual work of the kinematics u, j. The `published` formulation violates
!> it for theta < 0. Its energy balance therefore does not close, and the residual measures the
!> error.
module rwmf_model_system_energy
   use rwmf_core_kinds, only: wp
   use rwmf_model_bent_wall, only: bending_strain, bent_gravity, bent_kinetic_energy
   use rwmf_model_effects_loops, only: lane_powers, lane_rates, power_unit
   use rwmf_model_floors_floor_forces, only: bent_frame_strain
   use rwmf_model_floors_yielding_storeys, only: storeys_loss
   use rwmf_model_hysteresis_spring_set, only: elements_energy, springs_loss
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_lanes, only: lane_motion_t, power_count
   use rwmf_model_system_assembly, only: equation_t, ground_at, kinematics_at
   use rwmf_model_system_contributions, only: effects_energy, effects_frame_energy
   implicit none
   private

   public :: stored_energy_t, stored_energy, mechanical_energy, impact_loss
   public :: powers_at, yielding_loss, dissipates_hysteretically

   !> Energy of a state by part [J/kg].
   type :: stored_energy_t
      real(wp) :: kinetic = 0
      real(wp) :: strain = 0
      !! strain energy of the frame
      real(wp) :: gravity = 0
      !! potential energy of the wall, zero at rest
      real(wp) :: cable = 0
      !! energy of the cable relative to the resting wall
      real(wp) :: effects = 0
      !! energy of further effects
      real(wp) :: bending = 0
      !! strain energy of a bending wall
   end type stored_energy_t

contains

   !> Sum of kinetic energy, strain energy of the frame, and work stored in cable and gravity
   !> [J/kg].
   real(wp) function mechanical_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(stored_energy_t) :: stored

      stored = stored_energy(equation, y)
      energy = stored%kinetic + stored%strain + stored%gravity + stored%cable + stored%effects &
         + stored%bending
   end function mechanical_energy

   !> Compute the stored energy part by part.
   type(stored_energy_t) function stored_energy(equation, y) result(stored)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(kinematics_t) :: kin
      real(wp) :: elements(2)
      !! energy of tendons and of other elements [J/kg]
      real(wp) :: beyond(2)
      !! kinetic and strain energy in addition to those of an elastic frame with a single mass
      !! [J/kg]
      real(wp) :: phi
      !! [rad]

      stored%effects = effects_energy(equation, y)
      beyond = effects_frame_energy(equation, y)
      associate (p => equation%p)
         if (.not. equation%has_wall) then
            stored%kinetic = y(2)**2/2 + beyond(1)
            stored%strain = (p%omega_s*y(1))**2/2 + beyond(2)
            return
         end if
         kin = kinematics_at(equation, y(1))
         elements = elements_energy(equation, y(1))
         stored%kinetic = p%R**2*(equation%inertia + p%gamma*kin%j**2)*y(2)**2/2 &
            + beyond(1)
         stored%strain = p%gamma*(p%R*p%omega_s*kin%u)**2/2 + beyond(2)
         phi = equation%state%side*y(1)
         if (equation%has_impacts) then
            stored%gravity = p%g*p%R*(2*sin(phi/2)*sin(p%alpha - phi/2))
         else
            ! the centroid of a hinged wall can only move down
            stored%gravity = p%g*p%R*(-2*equation%p%cos_alpha*sin(phi/2)**2)
         end if
         stored%cable = elements(1)
         stored%effects = stored%effects + elements(2)
         if (equation%beam%n == 0) return
         stored%kinetic = bent_kinetic_energy(equation, y) + beyond(1)
         stored%strain = bent_frame_strain(equation, y) + beyond(2)
         stored%gravity = stored%gravity + bent_gravity(equation, y)
         stored%bending = bending_strain(equation, y)
      end associate
   end function stored_energy

   !> Compute the powers of the ground motion, of dampers and of smooth plastic flow [W/kg].
   subroutine powers_at(equation, t, y, power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp), intent(out) :: power(power_count)
      !! input by the ground motion, then dissipation by dampers and by smooth plastic flow [W/kg]
      type(lane_motion_t) :: motion
      real(wp) :: y_dot(equation%n), unit(1)

      call ground_at(equation, t, motion)
      associate (scene => equation%scene, coef => equation%state%coef)
         call lane_rates(scene, coef, y, motion, y_dot)
         power = 0
         call lane_powers(scene, 1.0_wp, coef, y, y_dot, motion, power)
         call power_unit(scene, coef, unit)
      end associate
      power = unit(1)*power
   end subroutine powers_at

   !> Energy dissipated since t = 0 by yielding with piecewise linear laws [J/kg].
   real(wp) function yielding_loss(equation, y) result(loss)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      loss = 0
      if (equation%has_bilinear_springs) loss = springs_loss(equation, y(1))
      if (equation%floors%yields) loss = loss + storeys_loss(equation, y)
   end function yielding_loss

   !> True if the scene has effects that yield.
   pure logical function dissipates_hysteretically(equation) result(does)
      type(equation_t), intent(in) :: equation

      does = equation%has_bilinear_springs .or. equation%has_loading_direction &
         .or. equation%floors%yields
   end function dissipates_hysteretically

   !> Kinetic energy lost in an impact [J/kg].
   real(wp) function impact_loss(equation, before, after) result(loss)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: before
      !! angular velocity before the impact [rad/s]
      real(wp), intent(in) :: after
      !! angular velocity after the impact [rad/s]

      loss = equation%p%R**2*equation%state%inertia_at_rest*(before**2 - after**2)/2
   end function impact_loss

end module rwmf_model_system_energy
