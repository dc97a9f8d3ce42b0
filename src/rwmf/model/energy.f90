!> Energies and powers of wall, frame and cable per unit m_w (bare frame: per unit m_s).
!>
!> They belong to the virtual work of the kinematics u, j. The `published` formulation violates it
!> for theta < 0; its ledger therefore does not close, and the residual shows by how much.
module rwmf_model_energy
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: cable_at, equation_t, interval_of, kinematics_at
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_contributions, only: effects_energy, effects_input, effects_power
   use rwmf_model_effects_vertical_motion, only: vertical_power
   use rwmf_model_hysteresis_spring_set, only: tendon_power
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_motion_ground_motion, only: acceleration
   implicit none
   private

   public :: stored_energy_t, stored_energy, mechanical_energy, input_power, impact_loss
   public :: viscous_power, hysteretic_power, dissipates_hysteretically

   !> What a state holds [J/kg].
   type :: stored_energy_t
      real(wp) :: kinetic = 0
      real(wp) :: strain = 0
      !! of the frame
      real(wp) :: gravity = 0
      !! of the wall, zero at rest
      real(wp) :: cable = 0
      !! beyond that of the resting wall
      real(wp) :: effects = 0
      !! of further effects
   end type stored_energy_t

contains

   !> Kinetic energy, strain energy of the frame, work stored in cable and gravity [J/kg].
   real(wp) function mechanical_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(stored_energy_t) :: stored

      stored = stored_energy(equation, y)
      energy = stored%kinetic + stored%strain + stored%gravity + stored%cable + stored%effects
   end function mechanical_energy

   !> The same part by part.
   type(stored_energy_t) function stored_energy(equation, y) result(stored)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      real(wp) :: phi
      !! [rad]

      stored%effects = effects_energy(equation, y)
      associate (p => equation%p)
         if (.not. equation%has_wall) then
            stored%kinetic = y(2)**2/2
            stored%strain = (p%omega_s*y(1))**2/2
            return
         end if
         kin = kinematics_at(equation, y(1))
         cable = cable_at(equation, y(1))
         stored%kinetic = p%R**2*(equation%inertia + p%gamma*kin%j**2)*y(2)**2/2
         stored%strain = p%gamma*(p%R*p%omega_s*kin%u)**2/2
         phi = equation%state%side*y(1)
         if (equation%has_impacts) then
            stored%gravity = p%g*p%R*(2*sin(phi/2)*sin(p%alpha - phi/2))
         else
            ! the centroid of a hinged wall only sinks
            stored%gravity = p%g*p%R*(-2*equation%p%cos_alpha*sin(phi/2)**2)
         end if
         stored%cable = p%g*p%R*cable%energy
      end associate
   end function stored_energy

   !> Power of the ground motion [W/kg].
   real(wp) function input_power(equation, t, y) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(kinematics_t) :: kin

      power = -acceleration(equation%motion, interval_of(equation), t)*y(2)
      if (equation%has_wall) then
         kin = kinematics_at(equation, y(1))
         power = power*equation%p%R*(equation%p%gamma*kin%j + kin%c)
         if (equation%has_vertical) power = power + vertical_power(equation, t, y)
      end if
      power = power + effects_input(equation, t, y)
   end function input_power

   !> Power that the frame's damper and further viscous effects take [W/kg].
   real(wp) function viscous_power(equation, t, y) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(kinematics_t) :: kin

      associate (p => equation%p)
         power = 2*p%xi_s*p%omega_s*y(2)**2
         if (equation%has_wall) then
            kin = kinematics_at(equation, y(1))
            power = power*p%gamma*(p%R*kin%j)**2
         end if
      end associate
      power = power + effects_power(equation, t, y, is_hysteretic=.false.)
   end function viscous_power

   !> Power that effects take which yield [W/kg].
   real(wp) function hysteretic_power(equation, t, y) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      power = effects_power(equation, t, y, is_hysteretic=.true.)
      if (equation%cable%is_tendon) power = power + tendon_power(equation, y)
   end function hysteretic_power

   !> Has the scene effects that yield?
   pure logical function dissipates_hysteretically(equation) result(does)
      type(equation_t), intent(in) :: equation
      integer :: i

      does = equation%cable%is_tendon
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         does = does .or. associated(equation%effects(i)%plastic_power)
      end do
   end function dissipates_hysteretically

   !> Kinetic energy that an impact takes [J/kg].
   real(wp) function impact_loss(equation, before, after) result(loss)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: before
      !! angular velocity before [rad/s]
      real(wp), intent(in) :: after
      !! and after [rad/s]

      loss = equation%p%R**2*equation%state%inertia_at_rest*(before**2 - after**2)/2
   end function impact_loss

end module rwmf_model_energy
