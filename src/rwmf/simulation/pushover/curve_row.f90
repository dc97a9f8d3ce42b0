!> Values of one step of a static curve, with the words and signs of the history of a run.
module rwmf_simulation_pushover_curve_row
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: kinematics_at
   use rwmf_model_system_bent_sections, only: find_bent_extremes, find_bent_sections
   use rwmf_model_system_demands, only: demands_at, demands_t
   use rwmf_model_system_energy, only: mechanical_energy, yielding_loss
   use rwmf_model_floors_yielding_storeys, only: put_shears
   use rwmf_model_equation, only: cable_force_at, frame_displacement, has_elements
   use rwmf_model_floor_motion, only: follows_roof
   use rwmf_problem_quantity_values, only: keys_of, put, values_t
   use rwmf_model_system_reactions, only: has_section_forces, link_tilt, plastic_part, &
      reactions_at, reactions_t
   use rwmf_model_system_wall_sections, only: find_forces_beside, find_section_extremes, &
      link_places, links_t, section_extremes_t
   use rwmf_problem_quantity_table, only: id, key_length
   use rwmf_simulation_pushover_curve, only: add_row, static_curve_t
   use rwmf_simulation_pushover_demand_columns, only: instant_key, put_demands
   use rwmf_simulation_pushover_static_scene, only: loaded_displacements, static_scene_t
   use rwmf_simulation_recorder_element_demands, only: put_element_forces, put_frame_force
   implicit none
   private

   public :: record_row, dissipated_energy

   character(key_length), parameter :: own_names(5) = [character(key_length) :: 'roof_drift', &
      'roof_displacement_m', 'energy_stored_J_per_kg', 'energy_work_J_per_kg', &
      'energy_released_J_per_kg']

contains

   !> Append the present equilibrium to the curve.
   subroutine record_row(scene, work, curve)
      type(static_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: work
      !! work of the load since the beginning [J/kg]
      type(static_curve_t), intent(inout) :: curve
      type(values_t) :: row
      real(wp) :: u(size(scene%pattern)), own(5)

      u = loaded_displacements(scene, scene%y)
      own = [u(size(u))/curve%height, u(size(u)), mechanical_energy(scene%equation, scene%y), &
         work, scene%released]
      call put_loads(scene, curve, row)
      call put_structure(scene, row)
      if (scene%equation%has_wall) call put_wall(scene, row)
      if (.not. allocated(curve%names)) curve%names = [own_names, &
         instant_key(keys_of(row))]
      call add_row(curve, [own, row%numbers(:row%n)])
   end subroutine record_row

   !> Write base shear and overturning moment of the load, displacements of the floors, and the
   !> dissipated energy.
   subroutine put_loads(scene, curve, row)
      type(static_scene_t), intent(in) :: scene
      type(static_curve_t), intent(in) :: curve
      type(values_t), intent(inout) :: row
      real(wp) :: u(size(scene%pattern)), arm, unit

      u = loaded_displacements(scene, scene%y)
      arm = curve%height
      if (allocated(scene%building%z)) arm = dot_product(scene%pattern, scene%building%z)
      ! the mass that the equation of motion has as its unit, without a wall
      unit = scene%building%unit
      if (.not. (scene%equation%has_wall .or. scene%equation%floors%n > 0)) then
         ! floors in proportion to the roof move the mass sum(m share**2)
         if (allocated(scene%building%share)) unit = sum(scene%building%m &
            *scene%building%share**2)
      end if
      associate (ratio => scene%load*unit/scene%building%weight)
         call put(row, id%base_shear_over_weight, ratio)
         call put(row, id%overturning_moment_over_weight_m, ratio*arm)
      end associate
      if (scene%equation%has_frame) call put(row, id%u_s_m, frame_displacement(scene%equation, &
         scene%equation%state%side, scene%y))
      if (scene%building%drifts > 0) call put(row, id%floor_i_m, u)
      call put(row, id%energy_hysteretic_J_per_kg, dissipated_energy(scene))
   end subroutine put_loads

   !> Energy dissipated by all springs [J/kg].
   real(wp) function dissipated_energy(scene) result(energy)
      type(static_scene_t), intent(in) :: scene

      energy = yielding_loss(scene%equation, scene%y) + scene%spent
   end function dissipated_energy

   !> Write forces of the cable, the fuses and the frame, drifts and shears of the storeys.
   subroutine put_structure(scene, row)
      type(static_scene_t), intent(inout) :: scene
      type(values_t), intent(inout) :: row
      type(demands_t) :: demands

      associate (equation => scene%equation, y => scene%y, p => scene%equation%p)
         if (equation%has_cable) then
            call put(row, id%cable_force_over_m_w_g, cable_force_at(equation, y(1), &
               equation%state%side))
         end if
         if (allocated(equation%springs)) call put_frame_force(row, equation, y(1))
         if (has_elements(equation)) call put_element_forces(row, equation, scene%has_offsets, y)
         if (equation%floors%yields .and. follows_roof(equation)) call put_shears(row, equation, y)
         if (scene%building%drifts > 0) then
            call demands_at(scene%building, equation, 0.0_wp, y, 0*y, demands)
            call put(row, id%storey_i_drift, demands%drift)
            call put(row, id%storey_i_shear_over_m_w_g, demands%shear/p%g)
         else if (equation%has_frame .and. .not. allocated(equation%springs)) then
            call put(row, id%frame_force_over_m_s_g, p%omega_squared*(frame_displacement(equation, &
               equation%state%side, y) - plastic_part(equation, y))/p%g)
         end if
      end associate
   end subroutine put_structure

   !> Write rotation, forces of the links, forces at the base and inside the wall.
   subroutine put_wall(scene, row)
      type(static_scene_t), intent(inout) :: scene
      type(values_t), intent(inout) :: row
      type(links_t) :: links
      type(reactions_t) :: reactions
      type(section_extremes_t) :: extremes
      real(wp) :: added(2), base(2), below(2, 1), above(2, 1)
      !! forces of the load on linked floors; shear [m/s2] and moment [m2/s2] over m_w

      call find_links(scene, links, added)
      associate (equation => scene%equation, y => scene%y, g => scene%equation%p%g)
         ! largest section forces of the wall, and those at its base
         if (has_section_forces(equation) .and. equation%beam%n > 0) then
            call find_bent_extremes(scene%building%sections, equation, 0.0_wp, y, 0*y, links, &
               extremes)
            call find_bent_sections(scene%building%sections, equation, 0.0_wp, y, 0*y, links)
            base = scene%building%sections%below_node(:, 0)
         else if (has_section_forces(equation)) then
            call find_section_extremes(equation, 0.0_wp, y, 0.0_wp, links, extremes)
            call find_forces_beside(equation, 0.0_wp, y, 0.0_wp, links, [0.0_wp], below, above)
            base = below(:, 1)
         end if
         reactions = reactions_at(equation, 0.0_wp, y, 0*y)
         reactions%normal = reactions%normal - added(2)
         reactions%horizontal = reactions%horizontal - added(1)
         call put(row, id%theta_rad, y(1))
         call put(row, id%pivot_normal_over_m_w_g, reactions%normal/g)
         call put(row, id%pivot_horizontal_over_m_w_g, reactions%horizontal/g)
         if (has_section_forces(equation)) then
            call put(row, id%wall_shear_over_m_w_g, extremes%shear/g)
            call put(row, id%wall_moment_over_m_w_g_m, extremes%moment/g)
            call put(row, id%wall_shear_base_over_m_w_g, base(1)/g)
            call put(row, id%wall_moment_base_over_m_w_g_m, base(2)/g)
         end if
         if (equation%has_frame) call put(row, id%link_i_force_over_m_w_g, sign(norm2(links%force, &
            dim=1), links%force(1, :))/g, scene%building%floors - size(links%force, 2))
      end associate
      call put_demands(row, scene, links, reactions)
   end subroutine put_wall

   !> Find the forces of the links on the wall: those that frame and springs would exert without the
   !> load, and the load on linked floors.
   subroutine find_links(scene, links, added)
      type(static_scene_t), intent(inout) :: scene
      type(links_t), intent(out) :: links
      real(wp), intent(out) :: added(2)
      !! sum of the load on linked floors, horizontal and upward [m/s2]
      type(demands_t) :: demands
      real(wp), allocatable :: push(:)
      !! (links) load on the floor of each link [m/s2]
      real(wp) :: tilt

      associate (equation => scene%equation, y => scene%y)
         if (.not. equation%has_frame) then
            allocate (links%place(2, 1), links%force(2, 1), source=0.0_wp)
            links%place(:, :) = link_places(equation, [1.0_wp])
            if (equation%beam%n > 0) links%place(1, :) = links%place(1, :) &
               + sum(y(equation%beam%first:equation%beam%first + equation%beam%n - 1))
            push = [scene%load]
         else
            call demands_at(scene%building, equation, 0.0_wp, y, 0*y, demands)
            links = demands%links
            if (allocated(equation%floors%k_link)) then
               push = [real(wp) ::]
            else if (equation%floors%are_linked) then
               push = scene%load*scene%pattern
            else if (equation%floors%n > 0) then
               push = [scene%load*scene%pattern(size(scene%pattern))]
            else
               push = [scene%load*dot_product(scene%pattern, scene%building%share)]
            end if
         end if
         added = 0
         if (size(push) == 0) return
         added(1) = sum(push)
         tilt = 0
         if (equation%has_frame) tilt = link_tilt(equation, kinematics_at(equation, y(1)))
         added(2) = tilt*added(1)
         links%force(1, :) = links%force(1, :) + push
         links%force(2, :) = links%force(2, :) + tilt*push
      end associate
   end subroutine find_links

end module rwmf_simulation_pushover_curve_row
