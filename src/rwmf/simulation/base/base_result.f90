!> Result of a run on a base that gives.
module rwmf_simulation_base_base_result
   use rwmf_core_kinds, only: wp
   use rwmf_model_base_base_regime, only: base_regime_t
   use rwmf_model_base_base_scene, only: base_scene_t, elongations
   use rwmf_model_elements, only: of_fuse
   use rwmf_model_hysteresis_spring_laws, only: spring_loss, spring_residual
   use rwmf_problem_case, only: case_t, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_base_base_record, only: base_record_t, first_floor, first_spring, &
      of_contact, of_drift, of_left, of_middle, of_normal, of_rate, of_right, of_shear, of_slip, &
      of_stress, of_tendon, of_theta, of_total, of_u, stored_energies, stored_t
   use rwmf_simulation_state_result, only: element_extremes_t, event_t, result_t, value_t
   implicit none
   private

   public :: fill_base_result

contains

   !> Fill the components of the result that apply to the scene.
   subroutine fill_base_result(case, scene, regime, record, y, result)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(inout) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(result_t), intent(inout) :: result

      result%method = 'taylor'
      result%rtol = case%solver%rtol
      result%impacts = 0
      result%lift_offs = 0
      result%has_impacts = .false.
      result%theta_min = record%extremes(1, of_theta)
      result%theta_max = record%extremes(2, of_theta)
      result%theta_max_over_alpha = largest(of_theta)/scene%alpha
      result%theta_dot_max = largest(of_rate)
      result%theta_end_over_alpha = y(1)/scene%alpha
      if (scene%frame%n > 0) then
         result%u_s_max = largest(of_u)
         result%t_u_s_max = record%times(merge(1, 2, -record%extremes(1, of_u) &
            > record%extremes(2, of_u)), of_u)
      end if
      if (record%is_sought(of_tendon)) result%cable_increment_max = record%extremes(2, of_tendon) &
         - scene%eta_0
      if (allocated(case%output)) then
         call fill_values(case, scene, regime, record, y, result)
         if (case%output%reactions) call fill_reactions(scene, record, result)
         if (case%output%demands .and. scene%frame%n > 0) call fill_demands(scene, record, result)
         if (case%output%envelopes .and. allocated(case%fuse)) call fill_fuses(scene, record, &
            result)
         if (record%keeps_energy) call fill_energy(scene, regime, record, y, result)
      end if
      if (.not. allocated(record%history)) return
      record%history%values = record%history%values(:record%rows, :)
      call move_alloc(record%history, result%history)
      allocate (result%events(0))

   contains

      !> Largest magnitude of a column.
      pure real(wp) function largest(column)
         integer, intent(in) :: column

         largest = max(record%extremes(2, column), -record%extremes(1, column))
      end function largest
   end subroutine fill_base_result

   !> Collect the values that no component of the result holds.
   subroutine fill_values(case, scene, regime, record, y, result)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(in) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(result_t), intent(inout) :: result
      real(wp) :: stress
      integer :: i

      allocate (result%further(0))
      associate (low => record%extremes(1, :), high => record%extremes(2, :), &
                 sought => record%is_sought)
         call add(sought(of_left), id%toe_settlement_max_m, max(high(of_left), high(of_right)))
         call add(sought(of_middle), id%middle_rise_max_m, high(of_middle))
         call add(.true., id%middle_end_m, y(5))
         call add(sought(of_contact), id%contact_length_min_m, merge(0.0_wp, low(of_contact), &
            regime%flights > 0))
         stress = max(record%stress, high(of_stress), high(of_stress + 1))
         call add(sought(of_stress), id%toe_stress_max_over_k_m, stress)
         call add(sought(of_stress) .and. case%compliant_base%modulus > 0, id%toe_stress_max_Pa, &
            stress*case%compliant_base%modulus)
         call add(sought(of_normal), id%base_normal_max_over_m_w_g, high(of_normal))
         call add(sought(of_normal), id%base_normal_min_over_m_w_g, low(of_normal))
         call add(sought(of_shear), id%base_shear_max_over_m_w_g, max(high(of_shear), &
            -low(of_shear)))
         call add(sought(of_slip), id%slide_max_m, max(high(of_slip), -low(of_slip)))
      end associate
      call add(scene%slides, id%slide_end_m, y(3))
      call add(scene%slides, id%slips, real(regime%slips, wp))
      call add(.true., id%flights, real(regime%flights, wp))
      call add(regime%flights > 0, id%t_flight_first_s, regime%t_flight)
      do i = scene%fuses + 1, size(scene%springs)
         associate (spring => scene%springs(i), u => y(3) + 2*scene%h*sin(y(1)) &
                    + 2*scene%b*sin(y(1)/2)**2)
            call add(.true., id%ductility, result%u_s_max*spring%stiffness/spring%yield)
            call add(.true., id%residual_displacement_m, spring_residual(spring, &
               regime%springs(i), u))
         end associate
      end do
      if (scene%strips == 0) return
      associate (depth => depth_at_end(scene, regime, y))
         call add(.true., id%crushed_depth_max_m, maxval(depth))
         call add(.true., id%crushed_left_m, depth(1))
         call add(.true., id%crushed_right_m, depth(size(depth)))
      end associate

   contains

      !> Add a value if it applies.
      subroutine add(applies, number, value)
         logical, intent(in) :: applies
         integer, intent(in) :: number
         real(wp), intent(in) :: value

         if (applies) result%further = [result%further, value_t(number, value)]
      end subroutine add
   end subroutine fill_values

   !> Crushed depths, those of strips that still crush at the end included [m].
   pure function depth_at_end(scene, regime, y) result(depth)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: y(:)
      real(wp) :: depth(scene%strips)

      depth = max(regime%depth, scene%place*sin(y(1)) - y(5) - scene%d_y)
   end function depth_at_end

   !> Fill base shear, drifts and the force of the tendon.
   subroutine fill_reactions(scene, record, result)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(in) :: record
      type(result_t), intent(inout) :: result

      if (.not. record%is_sought(of_total)) return
      allocate (result%reactions)
      associate (low => record%extremes(1, :), high => record%extremes(2, :), &
                 reactions => result%reactions)
         reactions%base_shear_max = max(high(of_total), -low(of_total))
         reactions%t_base_shear_max = record%times(merge(1, 2, -low(of_total) > high(of_total)), &
            of_total)
         if (record%is_sought(of_drift)) reactions%wall_drift_max = max(high(of_drift), &
            -low(of_drift))
         if (scene%frame%n > 0) reactions%frame_drift_max = result%u_s_max/(2*scene%h)
         if (record%is_sought(of_tendon)) reactions%tendon_force_max = high(of_tendon)
      end associate
   end subroutine fill_reactions

   !> Fill drifts of the storeys and accelerations of the floors.
   subroutine fill_demands(scene, record, result)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(in) :: record
      type(result_t), intent(inout) :: result
      real(wp), allocatable :: largest(:)
      integer :: peak

      allocate (result%demands)
      associate (n => scene%frame%n, demands => result%demands)
         largest = max(record%extremes(2, first_floor:), -record%extremes(1, first_floor:))
         demands%acceleration_max = largest(n + 1:)
         peak = first_floor + n - 1 + maxloc(demands%acceleration_max, dim=1)
         demands%t_acceleration_max = record%times(merge(1, 2, -record%extremes(1, peak) &
            > record%extremes(2, peak)), peak)
         if (.not. allocated(scene%frame%height)) return
         demands%drift_max = largest(:n)
         peak = first_floor - 1 + maxloc(demands%drift_max, dim=1)
         demands%t_drift_max = record%times(merge(1, 2, -record%extremes(1, peak) &
            > record%extremes(2, peak)), peak)
         demands%roof_drift_max = result%u_s_max/sum(scene%frame%height)
         demands%t_roof_drift_max = result%t_u_s_max
      end associate
   end subroutine fill_demands

   !> Fill strokes and forces of the fuses.
   subroutine fill_fuses(scene, record, result)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(in) :: record
      type(result_t), intent(inout) :: result
      integer :: i, stroke, force

      allocate (result%envelopes)
      allocate (result%envelopes%elements(scene%fuses))
      do i = 1, scene%fuses
         stroke = first_spring(scene) + i - 1
         force = stroke + size(scene%springs)
         result%envelopes%elements(i) = element_extremes_t(of_fuse, record%extremes(:, stroke), &
            record%travel(i), record%extremes(:, force), record%series(0, force))
         associate (range => result%envelopes%elements(i)%force)
            range(2) = maxval(abs(range))
         end associate
      end do
   end subroutine fill_fuses

   !> Fill the energy ledger.
   subroutine fill_energy(scene, regime, record, y, result)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(in) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(result_t), intent(inout) :: result
      type(stored_t) :: stored
      real(wp) :: base, plastic
      !! dissipated by base and springs [J/kg]

      stored = stored_energies(scene, regime, y)
      base = record%base_work - (stored%base - record%base_start)
      result%energy = record%energy
      associate (energy => result%energy)
         plastic = sum(spring_loss(scene%springs, regime%springs, elongations(scene, y)))
         energy%final = stored%kinetic + stored%strain + stored%gravity + stored%cable &
            + stored%fuses + stored%base
         energy%hysteretic = base + record%friction + plastic
         energy%numbers = [id%energy_input_J_per_kg, id%energy_kinetic_J_per_kg, &
            id%energy_gravity_J_per_kg, id%energy_effects_J_per_kg, id%energy_viscous_J_per_kg, &
            id%energy_base_J_per_kg]
         energy%values = [energy%input, stored%kinetic, stored%gravity, stored%fuses &
            + stored%base, energy%viscous, base]
         if (scene%frame%n > 0) call add(id%energy_strain_J_per_kg, stored%strain)
         if (scene%has_tendon) call add(id%energy_cable_J_per_kg, stored%cable)
         if (size(scene%springs) > 0) call add(id%energy_hysteretic_J_per_kg, plastic)
         if (scene%slides) call add(id%energy_friction_J_per_kg, record%friction)
      end associate

   contains

      subroutine add(number, value)
         integer, intent(in) :: number
         real(wp), intent(in) :: value

         result%energy%numbers = [result%energy%numbers, number]
         result%energy%values = [result%energy%values, value]
      end subroutine add
   end subroutine fill_energy

end module rwmf_simulation_base_base_result
