!> Result of a run on a base that gives.
module rwmf_simulation_base_base_result
   use rwmf_core_kinds, only: wp
   use rwmf_model_base_base_regime, only: base_regime_t
   use rwmf_model_base_base_scene, only: base_scene_t, elongations
   use rwmf_model_elements, only: of_fuse
   use rwmf_model_hysteresis_spring_laws, only: spring_loss, spring_residual
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: clear, put, values_t
   use rwmf_simulation_base_base_record, only: base_record_t, first_floor, first_spring, &
      of_contact, of_drift, of_left, of_middle, of_normal, of_rate, of_right, of_shear, of_slip, &
      of_stress, of_tendon, of_theta, of_total, of_u, stored_energies, stored_t
   use rwmf_simulation_recorder_element_demands, only: element_extremes_t, put_elements
   use rwmf_simulation_recorder_energy_balance, only: put_balance
   use rwmf_simulation_state_history, only: shorten_history
   use rwmf_simulation_state_result, only: complete_values, result_t
   implicit none
   private

   public :: fill_base_result

contains

   !> Fill the components and values of the result that apply to the scene.
   subroutine fill_base_result(case, scene, regime, record, y, result)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(inout) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(result_t), intent(inout) :: result
      type(element_extremes_t) :: fuses(scene%fuses)
      integer :: i, stroke, force

      result%method = 'taylor'
      result%rtol = case%solver%rtol
      result%theta_min = record%extremes(1, of_theta)
      result%theta_max = record%extremes(2, of_theta)
      if (scene%frame%n > 0) result%u_s_max = largest(record, of_u)
      associate (values => result%values, sought => record%is_sought)
         if (scene%frame%n > 0) then
            call put(values, id%u_s_max_m, result%u_s_max)
            call put(values, id%t_u_s_max_s, time_of(record, of_u))
         end if
         call put(values, id%theta_max_over_alpha, largest(record, of_theta)/scene%alpha)
         call put(values, id%theta_dot_max_rad_s, largest(record, of_rate))
         call put(values, id%theta_end_over_alpha, y(1)/scene%alpha)
         if (sought(of_tendon)) call put(values, id%cable_force_increment_max_over_m_w_g, &
            record%extremes(2, of_tendon) - scene%eta_0)
         if (allocated(case%output)) then
            call put_base(case, scene, regime, record, y, values)
            if (case%output%reactions) call put_reactions(scene, record, result)
            if (case%output%demands .and. scene%frame%n > 0) call put_demands(scene, record, result)
            ! put strokes and forces of the fuses
            if (case%output%envelopes .and. allocated(case%fuse)) then
               do i = 1, size(fuses)
                  stroke = first_spring(scene) + i - 1
                  force = stroke + size(scene%springs)
                  fuses(i) = element_extremes_t(of_fuse, record%extremes(:, stroke), &
                     record%travel(i), [record%extremes(1, force), largest(record, force)], &
                     record%series(0, force))
               end do
               call put_elements(values, fuses)
            end if
            if (record%keeps_energy) then
               call fill_energy(scene, regime, record, y)
               call put_balance(values, record%energy)
            end if
         end if
      end associate
      call complete_values(case, result)
      if (.not. allocated(record%history)) return
      call shorten_history(record%history, record%rows)
      call move_alloc(record%history, result%history)
      allocate (result%events(0))
   end subroutine fill_base_result

   !> Largest magnitude of a column.
   pure real(wp) function largest(record, column)
      type(base_record_t), intent(in) :: record
      integer, intent(in) :: column

      largest = max(record%extremes(2, column), -record%extremes(1, column))
   end function largest

   !> Time of the largest magnitude of a column [s].
   pure real(wp) function time_of(record, column) result(t)
      type(base_record_t), intent(in) :: record
      integer, intent(in) :: column

      t = record%times(merge(1, 2, -record%extremes(1, column) > record%extremes(2, column)), &
         column)
   end function time_of

   !> Put settlements, stresses, forces, slip and crushing of the base.
   subroutine put_base(case, scene, regime, record, y, values)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(in) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(values_t), intent(inout) :: values
      real(wp) :: stress
      integer :: i

      associate (low => record%extremes(1, :), high => record%extremes(2, :), &
                 sought => record%is_sought)
         if (sought(of_left)) call put(values, id%toe_settlement_max_m, max(high(of_left), &
            high(of_right)))
         if (sought(of_middle)) call put(values, id%middle_rise_max_m, high(of_middle))
         call put(values, id%middle_end_m, y(5))
         if (sought(of_contact)) call put(values, id%contact_length_min_m, merge(0.0_wp, &
            low(of_contact), regime%flights > 0))
         if (sought(of_stress)) then
            stress = max(record%stress, high(of_stress), high(of_stress + 1))
            call put(values, id%toe_stress_max_over_k_m, stress)
            if (case%compliant_base%modulus > 0) call put(values, id%toe_stress_max_Pa, stress &
               *case%compliant_base%modulus)
         end if
         if (sought(of_normal)) then
            call put(values, id%base_normal_max_over_m_w_g, high(of_normal))
            call put(values, id%base_normal_min_over_m_w_g, low(of_normal))
         end if
      end associate
      if (record%is_sought(of_shear)) call put(values, id%base_shear_max_over_m_w_g, &
         largest(record, of_shear))
      if (record%is_sought(of_slip)) call put(values, id%slide_max_m, largest(record, of_slip))
      if (scene%slides) then
         call put(values, id%slide_end_m, y(3))
         call put(values, id%slips, real(regime%slips, wp))
      end if
      call put(values, id%flights, real(regime%flights, wp))
      if (regime%flights > 0) call put(values, id%t_flight_first_s, regime%t_flight)
      do i = scene%fuses + 1, size(scene%springs)
         associate (spring => scene%springs(i), u => y(3) + 2*scene%h*sin(y(1)) &
                    + 2*scene%b*sin(y(1)/2)**2)
            call put(values, id%ductility, largest(record, of_u)*spring%stiffness/spring%yield)
            call put(values, id%residual_displacement_m, spring_residual(spring, &
               regime%springs(i), u))
         end associate
      end do
      if (scene%strips == 0) return
      associate (depth => depth_at_end(scene, regime, y))
         call put(values, id%crushed_depth_max_m, maxval(depth))
         call put(values, id%crushed_left_m, depth(1))
         call put(values, id%crushed_right_m, depth(size(depth)))
      end associate
   end subroutine put_base

   !> Crushed depths, those of strips that still crush at the end included [m].
   pure function depth_at_end(scene, regime, y) result(depth)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: y(:)
      real(wp) :: depth(scene%strips)

      depth = max(regime%depth, scene%place*sin(y(1)) - y(5) - scene%d_y)
   end function depth_at_end

   !> Put the base shear of wall and frame, drifts over the wall's height, and the tendon's force.
   subroutine put_reactions(scene, record, result)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(in) :: record
      type(result_t), intent(inout) :: result

      if (.not. record%is_sought(of_total)) return
      associate (values => result%values)
         call put(values, id%base_shear_max_over_weight, largest(record, of_total))
         call put(values, id%t_base_shear_max_s, time_of(record, of_total))
         if (record%is_sought(of_drift)) call put(values, id%wall_drift_max, largest(record, &
            of_drift))
         if (scene%frame%n > 0) call put(values, id%frame_drift_max, result%u_s_max/(2*scene%h))
         if (record%is_sought(of_tendon)) call put(values, id%tendon_force_max_over_m_w_g, &
            record%extremes(2, of_tendon))
      end associate
   end subroutine put_reactions

   !> Put drifts of the storeys and accelerations of the floors.
   subroutine put_demands(scene, record, result)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(in) :: record
      type(result_t), intent(inout) :: result
      integer :: i

      associate (values => result%values, n => scene%frame%n, &
                 found => [(largest(record, i), i=first_floor, first_floor + 2*scene%frame%n - 1)])
         call put(values, id%floor_i_acceleration_max_g, found(n + 1:))
         call put(values, id%floor_acceleration_max_g, maxval(found(n + 1:)))
         call put(values, id%t_floor_acceleration_max_s, time_of(record, first_floor - 1 + n &
            + maxloc(found(n + 1:), dim=1)))
         if (.not. allocated(scene%frame%height)) return
         call put(values, id%storey_i_drift_max, found(:n))
         call put(values, id%storey_drift_max, maxval(found(:n)))
         call put(values, id%t_storey_drift_max_s, time_of(record, first_floor - 1 &
            + maxloc(found(:n), dim=1)))
         call put(values, id%roof_drift_max, result%u_s_max/sum(scene%frame%height))
         call put(values, id%t_roof_drift_max_s, time_of(record, of_u))
      end associate
   end subroutine put_demands

   !> Complete the energy ledger.
   subroutine fill_energy(scene, regime, record, y)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(inout) :: record
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(stored_t) :: stored
      real(wp) :: base, plastic
      !! dissipated by base and springs [J/kg]

      stored = stored_energies(scene, regime, y)
      base = record%base_work - (stored%base - record%base_start)
      associate (energy => record%energy, terms => record%energy%terms)
         plastic = sum(spring_loss(scene%springs, regime%springs, elongations(scene, y)))
         energy%final = stored%kinetic + stored%strain + stored%gravity + stored%cable &
            + stored%fuses + stored%base
         energy%hysteretic = base + record%friction + plastic
         call clear(terms)
         call put(terms, id%energy_input_J_per_kg, energy%input)
         call put(terms, id%energy_kinetic_J_per_kg, stored%kinetic)
         call put(terms, id%energy_gravity_J_per_kg, stored%gravity)
         call put(terms, id%energy_effects_J_per_kg, stored%fuses + stored%base)
         call put(terms, id%energy_viscous_J_per_kg, energy%viscous)
         call put(terms, id%energy_base_J_per_kg, base)
         if (scene%frame%n > 0) call put(terms, id%energy_strain_J_per_kg, stored%strain)
         if (scene%has_tendon) call put(terms, id%energy_cable_J_per_kg, stored%cable)
         if (size(scene%springs) > 0) call put(terms, id%energy_hysteretic_J_per_kg, plastic)
         if (scene%slides) call put(terms, id%energy_friction_J_per_kg, record%friction)
      end associate
   end subroutine fill_energy

end module rwmf_simulation_base_base_result
