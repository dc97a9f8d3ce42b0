!> Energy balance of a run: work over each piece of motion, and the reported parts.
!>
!> Explicit pairs integrate the powers over their stages like a further state, with their full
!> order. Other methods provide states inside the piece for a Gauss rule.
module rwmf_simulation_recorder_energy_balance
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_model_elements, only: of_cable
   use rwmf_model_equation, only: has_elements, has_further_effects
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_lanes, only: of_bending, of_input, of_plastic, of_viscous, &
      power_count
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_energy, only: dissipates_hysteretically, powers_at, stored_energy, &
      stored_energy_t, yielding_loss
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_simulation_state_result, only: energy_t
   implicit none
   private

   public :: integrate_powers, add_work, put_balance, put_energies

contains

   !> Add the input and the dissipated energy over a piece that begins with the last step.
   subroutine integrate_powers(energy, piece, error)
      type(energy_t), intent(inout) :: energy
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp), parameter :: inner = sqrt(5 - 2*sqrt(10.0_wp/7))/3
      real(wp), parameter :: outer = sqrt(5 + 2*sqrt(10.0_wp/7))/3
      real(wp), parameter :: node(5) = [-outer, -inner, 0.0_wp, inner, outer]
      real(wp), parameter :: weight(5) = [322 - 13*sqrt(70.0_wp), 322 + 13*sqrt(70.0_wp), &
         512.0_wp, 322 + 13*sqrt(70.0_wp), 322 - 13*sqrt(70.0_wp)]/900
      real(wp) :: work(power_count), power(power_count), y(piece%equation%n), t, h
      integer :: i

      select type (integrator => piece%integrator)
      type is (explicit_pair_t)
         call integrator%find_work(piece%t_b, piece%y_b, work)
      class default
         ! a Gauss rule of five states inside the piece
         work = 0
         h = piece%t_b - piece%t_a
         do i = 1, size(node)
            t = piece%t_a + h*(1 + node(i))/2
            call piece%integrator%state_at(t, y, error)
            if (allocated(error)) return
            call powers_at(piece%equation, t, y, power)
            work = work + weight(i)*h/2*power
         end do
      end select
      call add_work(energy, work)
   end subroutine integrate_powers

   !> Add the work over a piece.
   pure subroutine add_work(energy, work)
      type(energy_t), intent(inout) :: energy
      real(wp), intent(in) :: work(power_count)
      !! work of the ground motion, dampers and smooth plastic flow [J/kg]

      energy%input = energy%input + work(of_input)
      energy%viscous = energy%viscous + work(of_viscous)
      energy%flow = energy%flow + work(of_plastic)
      energy%bending = energy%bending + work(of_bending)
      energy%input_max = max(energy%input_max, abs(energy%input))
   end subroutine add_work

   !> Fill in the parts of the energy balance that apply to the scene.
   !>
   !> These are the work since t = 0 and the stored energy at a state, for history and scalars.
   subroutine put_energies(row, energy, equation, y)
      type(values_t), intent(inout) :: row
      type(energy_t), intent(in) :: energy
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      type(stored_energy_t) :: stored

      stored = stored_energy(equation, y)
      call put(row, id%energy_input_J_per_kg, energy%input)
      call put(row, id%energy_kinetic_J_per_kg, stored%kinetic)
      if (equation%has_frame) call put(row, id%energy_strain_J_per_kg, stored%strain)
      if (equation%has_wall) call put(row, id%energy_gravity_J_per_kg, stored%gravity)
      if (equation%has_cable) call put(row, id%energy_cable_J_per_kg, stored%cable)
      if (stores_in_effects(equation)) call put(row, id%energy_effects_J_per_kg, stored%effects)
      if (equation%has_frame .or. has_further_effects(equation)) then
         call put(row, id%energy_viscous_J_per_kg, energy%viscous)
      end if
      if (dissipates_hysteretically(equation)) then
         call put(row, id%energy_hysteretic_J_per_kg, energy%flow &
            + yielding_loss(equation, y))
      end if
      if (equation%has_impacts) call put(row, id%energy_impact_J_per_kg, energy%impact)
      if (equation%beam%n > 0) then
         call put(row, id%energy_bending_J_per_kg, stored%bending)
         call put(row, id%energy_bending_damping_J_per_kg, energy%bending)
      end if
   end subroutine put_energies

   !> Put the terms at the end, and the residual over initial plus largest input energy.
   pure subroutine put_balance(values, energy)
      type(values_t), intent(inout) :: values
      type(energy_t), intent(in) :: energy
      real(wp) :: residual, scale, balance
      integer :: i

      do i = 1, energy%terms%n
         call put(values, energy%terms%ids(i), energy%terms%numbers(i))
      end do
      residual = energy%final + energy%viscous + energy%bending + energy%impact &
         + energy%hysteretic - energy%initial - energy%input
      scale = abs(energy%initial) + energy%input_max
      balance = 0
      if (scale > 0) balance = abs(residual)/scale
      call put(values, id%energy_balance_relative, balance)
   end subroutine put_balance

   !> True if further effects store energy.
   pure logical function stores_in_effects(equation) result(does)
      type(equation_t), intent(in) :: equation
      integer :: i

      does = .false.
      if (has_elements(equation)) does = any(equation%elements%group /= of_cable &
         .and. (equation%elements%spring > 0 .or. equation%elements%stiffness > 0))
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         does = does .or. associated(equation%effects(i)%energy)
      end do
   end function stores_in_effects

end module rwmf_simulation_recorder_energy_balance
