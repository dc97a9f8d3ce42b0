!> Energy ledger of a run: work done over each piece of motion, and the parts that are shown.
module rwmf_simulation_recorder_energy_balance
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: equation_t
   use rwmf_model_energy, only: dissipates_hysteretically, hysteretic_power, input_power, &
      stored_energy, stored_energy_t, viscous_power
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_simulation_result, only: energy_t
   implicit none
   private

   public :: integrate_powers, energy_names, energy_values

contains

   !> Add the work of ground and dissipation over a piece of the last step, by the Gauss rule with
   !> five points.
   subroutine integrate_powers(energy, step, error)
      type(energy_t), intent(inout) :: energy
      type(step_view_t), intent(in) :: step
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: inner = sqrt(5 - 2*sqrt(10.0_wp/7))/3
      real(wp), parameter :: outer = sqrt(5 + 2*sqrt(10.0_wp/7))/3
      real(wp), parameter :: node(5) = [-outer, -inner, 0.0_wp, inner, outer]
      real(wp), parameter :: weight(5) = [322 - 13*sqrt(70.0_wp), 322 + 13*sqrt(70.0_wp), &
         512.0_wp, 322 + 13*sqrt(70.0_wp), 322 - 13*sqrt(70.0_wp)]/900
      real(wp) :: y(step%equation%n)
      real(wp) :: t, h, share
      integer :: i

      h = step%t_b - step%t_a
      associate (equation => step%equation)
         do i = 1, size(node)
            t = step%t_a + h*(1 + node(i))/2
            call step%integrator%state_at(t, y, error)
            if (allocated(error)) return
            share = weight(i)*h/2
            energy%input = energy%input + share*input_power(equation, t, y)
            energy%viscous = energy%viscous + share*viscous_power(equation, t, y)
            energy%hysteretic = energy%hysteretic + share*hysteretic_power(equation, t, y)
         end do
      end associate
      energy%input_max = max(energy%input_max, abs(energy%input))
   end subroutine integrate_powers

   !> Parts of the ledger that apply to the scene: names of history columns and of scalars.
   pure function energy_names(equation) result(names)
      type(equation_t), intent(in) :: equation
      character(32), allocatable :: names(:)

      names = pack([character(32) :: 'energy_input_J_per_kg', 'energy_kinetic_J_per_kg', &
         'energy_strain_J_per_kg', 'energy_gravity_J_per_kg', 'energy_cable_J_per_kg', &
         'energy_effects_J_per_kg', 'energy_viscous_J_per_kg', 'energy_hysteretic_J_per_kg', &
         'energy_impact_J_per_kg'], &
         applies(equation))
   end function energy_names

   !> Their values with a state: work since t = 0, and what is stored.
   function energy_values(energy, equation, y) result(values)
      type(energy_t), intent(in) :: energy
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), allocatable :: values(:)
      !! (parts) [J/kg]
      type(stored_energy_t) :: stored

      stored = stored_energy(equation, y)
      values = pack([energy%input, stored%kinetic, stored%strain, stored%gravity, stored%cable, &
         stored%effects, energy%viscous, energy%hysteretic, energy%impact], applies(equation))
   end function energy_values

   pure function applies(equation) result(does)
      type(equation_t), intent(in) :: equation
      logical :: does(9)
      !! the parts in their order

      does = [.true., .true., equation%has_frame, equation%has_wall, equation%has_cable, &
         stores_in_effects(equation), &
         equation%has_frame .or. allocated(equation%effects), &
         dissipates_hysteretically(equation), equation%has_impacts]
   end function applies

   !> Do further effects store energy?
   pure logical function stores_in_effects(equation) result(does)
      type(equation_t), intent(in) :: equation
      integer :: i

      does = .false.
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         does = does .or. associated(equation%effects(i)%energy)
      end do
   end function stores_in_effects

end module rwmf_simulation_recorder_energy_balance
