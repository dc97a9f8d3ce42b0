!> Columns of a static curve for demands that no other column holds: sections of the wall beside the
!> floors, base section, friction, fuses, tendon.
!>
!> They carry the numbers of the largest values of a run; `instant_key` makes their keys.
module rwmf_simulation_pushover_demand_columns
   use rwmf_core_kinds, only: wp
   use rwmf_model_elements, only: of_cable, of_fuse, tendon_strain
   use rwmf_model_equation, only: cable_force_at, frame_displacement, has_elements, tip_displacement
   use rwmf_problem_quantity_values, only: put, values_t
   use rwmf_model_system_reactions, only: friction_demand, has_section_forces, reactions_t, &
      wall_drift
   use rwmf_model_system_wall_sections, only: links_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: id, key_length
   use rwmf_simulation_pushover_static_scene, only: static_scene_t
   use rwmf_simulation_recorder_element_demands, only: largest_stroke
   use rwmf_simulation_recorder_force_envelopes, only: find_sections, lay_strip, place_sections, &
      put_strip
   use rwmf_simulation_recorder_reaction_extremes, only: infinite_where_lifted
   implicit none
   private

   public :: prepare_demands, put_demands, instant_key

contains

   !> Set up the sections of the wall, the strip under the base, and the unit of the tendon stress.
   subroutine prepare_demands(case, scene)
      type(case_t), intent(in) :: case
      type(static_scene_t), intent(inout) :: scene
      !! with equation and building

      if (.not. scene%equation%has_wall) return
      scene%sections%building = scene%building
      call place_sections(scene%sections, scene%equation)
      call lay_strip(scene%sections, case, scene%equation)
      if (allocated(case%fuse)) scene%has_offsets = allocated(case%fuse%offset)
      if (.not. scene%equation%has_cable) return
      if (allocated(case%cable%area)) scene%tendon_stress = case%unit_mass*scene%equation%p%g &
         /case%cable%area(1)
      if (allocated(case%cable%rupture_strain)) scene%tendon_rupture = case%cable%rupture_strain
   end subroutine prepare_demands

   !> Append the columns of a scene with a wall.
   subroutine put_demands(row, scene, links, reactions)
      type(values_t), intent(inout) :: row
      type(static_scene_t), intent(inout) :: scene
      type(links_t), intent(in) :: links
      !! with the load on linked floors
      type(reactions_t), intent(in) :: reactions
      !! with the load
      real(wp) :: drift

      associate (equation => scene%equation, y => scene%y, sections => scene%sections)
         drift = wall_drift(equation, y(1))
         if (equation%beam%n > 0) then
            drift = drift + tip_displacement(equation, y)/equation%beam%length
            call put(row, id%tip_deflection_max_m, tip_displacement(equation, y))
         end if
         call put(row, id%wall_drift, drift)
         if (equation%has_frame) call put(row, id%frame_drift, frame_displacement(equation, &
            equation%state%side, y)/(2*equation%p%R*equation%p%cos_alpha))
         if (equation%parts%has_shear_key) then
            call put(row, id%shear_key_force_max_over_m_w_g, abs(reactions%horizontal) &
               /equation%p%g)
         else
            call put(row, id%friction_demand, &
               infinite_where_lifted(friction_demand(reactions)))
         end if
         if (has_elements(equation)) then
            if (any(equation%elements%group == of_fuse)) call put(row, id%fuse_stroke_max_m, &
               largest_stroke(equation, y(1)))
         end if
         if (equation%has_cable) call put_tendon(row, scene)
         sections%links = links
         if (has_section_forces(equation)) call put_sections(row, scene)
         if (allocated(sections%strip)) call put_strip(row, sections, reactions%normal, y(1))
      end associate
   end subroutine put_demands

   !> Append stress and strain of the tendon where its strands and its length are known.
   subroutine put_tendon(row, scene)
      type(values_t), intent(inout) :: row
      type(static_scene_t), intent(in) :: scene

      real(wp) :: strain
      integer :: i

      associate (equation => scene%equation)
         if (scene%tendon_stress > 0 .and. count(equation%elements%group == of_cable) == 1) then
            call put(row, id%tendon_stress_max_Pa, cable_force_at(equation, scene%y(1), &
            equation%state%side)*scene%tendon_stress)
         end if
         strain = -huge(strain)
         do i = 1, count(equation%elements%group == of_cable)
            if (.not. equation%elements(i)%length > 0) return
            strain = max(strain, tendon_strain(equation%elements(i), scene%y(1)))
            if (allocated(scene%tendon_rupture)) strain = min(strain, scene%tendon_rupture(i))
         end do
         call put(row, id%tendon_strain_max, strain)
      end associate
   end subroutine put_tendon

   !> Append shear and moment of the wall at mid-height and on both sides of the floors.
   subroutine put_sections(row, scene)
      type(values_t), intent(inout) :: row
      type(static_scene_t), intent(inout) :: scene
      !! with the forces of the links
      real(wp) :: middle(2)

      associate (sections => scene%sections, g => scene%equation%p%g)
         call find_sections(sections, scene%equation, 0.0_wp, scene%y, 0*scene%y)
         associate (below => abs(sections%below)/g, above => abs(sections%above)/g, &
                    floors => sections%of_floor)
            middle = max(below(:, sections%middle), above(:, sections%middle))
            call put(row, id%wall_shear_mid_max_over_m_w_g, middle(1))
            call put(row, id%wall_moment_mid_max_over_m_w_g_m, middle(2))
            if (size(floors) == 0) return
            call put(row, id%wall_shear_i_max_over_m_w_g, below(1, floors))
            call put(row, id%wall_shear_i_above_max_over_m_w_g, above(1, floors))
            call put(row, id%wall_moment_i_max_over_m_w_g_m, below(2, floors))
            call put(row, id%wall_moment_i_above_max_over_m_w_g_m, above(2, floors))
         end associate
      end associate
   end subroutine put_sections

   !> Key of a column: that of a largest value without its '_max'.
   elemental character(key_length) function instant_key(key)
      character(*), intent(in) :: key
      !! key of the table of quantities
      integer :: place

      instant_key = key
      place = index(key, '_max')
      if (place > 0) instant_key = key(:place - 1)//key(place + 4:)
   end function instant_key

end module rwmf_simulation_pushover_demand_columns
