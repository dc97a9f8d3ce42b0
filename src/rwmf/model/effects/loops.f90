!> Equation of motion of the lanes: kinematics, followed by the loop of each term of a scene.
module rwmf_model_effects_loops
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_bending_loop, only: add_mode_power, add_modes, bend_wall, release_modes
   use rwmf_model_effects_corner_inerter_loop, only: add_inerter
   use rwmf_model_effects_elements_loop, only: add_axial, add_chord_power, add_chords, &
      add_rise_power, add_rises, add_straight_tendons
   use rwmf_model_effects_nl_damper_loop, only: add_nl_damper, add_nl_damper_power
   use rwmf_model_effects_numbers, only: bending_effect, inerter_effect, link_effect, &
      nl_damper_effect, p_delta_effect, storeys_effect, vertical_effect, yielding_effect
   use rwmf_model_effects_p_delta_loop, only: add_p_delta
   use rwmf_model_effects_storeys_storeys_loop, only: add_excited_mass, add_excited_mass_power, &
      add_floor_power, add_floors, follow_storeys, move_storeys
   use rwmf_model_effects_vertical_motion_loop, only: add_vertical, add_vertical_power
   use rwmf_model_effects_yielding_loop, only: add_bouc_wen, add_bouc_wen_power
   use rwmf_model_lanes, only: add_frame, add_frame_power, add_wall_power, lane_count, &
      lane_motion_t, move_bare_frame, move_wall, power_count, tilt_link
   use rwmf_model_scene, only: axis_term, chord_term, first_wall, frame_term, line_term, &
      rise_term, scene_t
   implicit none
   private

   public :: lane_rates, lane_powers, power_unit, follow_storeys, lane_storeys

contains

   !> Compute the rates of all states: kinematics, then the inertia and moment of each term of the
   !> scene and the rates of its states.
   subroutine lane_rates(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms, for the current side and the active branches
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! theta [rad] and theta' [rad/s], bare frame u [m] and u' [m/s]; then states of effects
      type(lane_motion_t), intent(inout) :: motion
      !! ground accelerations on entry; on return also kinematics, inertia and moment
      real(wp), intent(out) :: y_dot(lane_count, scene%n)
      !! rates of the states
      integer :: i

      call move_scene(scene, coef, y, motion)
      do i = 1, size(scene%terms)
         associate (term => scene%terms(i), own => scene%terms(i)%coef)
            select case (term%effect)
            case (frame_term)
               call add_frame(coef(1, own), motion)
            case (axis_term)
               call add_axial(coef(1, own), motion)
            case (line_term)
               call add_straight_tendons(term%n, coef(1, own), motion)
            case (chord_term)
               call add_chords(coef(1, own), motion)
            case (rise_term)
               call add_rises(coef(1, own), motion)
            case (storeys_effect)
               if (term%n > 0) then
                  call add_floors(term, coef(1, own), y(1, term%state), motion, &
                     y_dot(1, term%state))
               else
                  call add_excited_mass(coef(1, own), motion)
               end if
            case (link_effect)
               call tilt_link(coef(1, own), motion)
            case (inerter_effect)
               call add_inerter(coef(1, own), motion)
            case (yielding_effect)
               call add_bouc_wen(term%law, coef(1, own), y(1, term%state), motion, &
                  y_dot(1, term%state))
            case (vertical_effect)
               call add_vertical(coef(1, own), motion)
            case (p_delta_effect)
               ! a term with one coordinate has no states and reads none of y
               call add_p_delta(term%n, term%n_states/2, coef(1, own), &
                  y(1, min(term%state, scene%n)), motion, y_dot(1, min(term%state, scene%n)))
            case (nl_damper_effect)
               call add_nl_damper(coef(1, own), motion)
            case (bending_effect)
               call add_modes(term, coef(1, own), y, coef(1, first_wall + 6), motion, y_dot)
            case default
               ! this effect has no loop and therefore no term
            end select
         end associate
      end do
      !$omp simd
      do i = 1, lane_count
         y_dot(i, 1) = y(i, 2)
         y_dot(i, 2) = coef(i, 1)*(motion%side(i)*motion%moment(i)/motion%inertia(i))
      end do
      if (scene%bent > 0) then
         associate (term => scene%terms(scene%bent))
            call release_modes(term%law, coef(1, term%coef), y(1, term%state), motion%side, &
               y_dot(1, 2), y_dot(1, term%state))
         end associate
      end if
   end subroutine lane_rates

   !> Compute the kinematics of the wall, or of the bare frame, before the terms.
   subroutine move_scene(scene, coef, y, motion)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! states
      type(lane_motion_t), intent(inout) :: motion

      if (scene%has_wall) then
         call move_wall(coef(1, first_wall), y(1, 1), y(1, 2), motion)
      else
         call move_bare_frame(y(1, 1), y(1, 2), motion)
      end if
      if (scene%bent == 0) return
      associate (term => scene%terms(scene%bent))
         call bend_wall(term%law, coef(1, term%coef), y(1, term%state), coef(1, first_wall + 6), &
            motion)
      end associate
   end subroutine move_scene

   !> Compute the displacements of the storeys with states, and their rates.
   subroutine lane_storeys(scene, n, coef, y, d)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: n
      !! number of storeys
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! states
      real(wp), intent(out) :: d(lane_count, n, 0:1)
      !! displacements [m] and rates [m/s] of the storeys
      type(lane_motion_t) :: motion
      integer :: i

      motion%ground = 0
      motion%upward = 0
      call move_scene(scene, coef, y, motion)
      do i = 1, size(scene%terms)
         associate (term => scene%terms(i), own => scene%terms(i)%coef)
            if (term%effect == link_effect) call tilt_link(coef(1, own), motion)
            if (term%effect == storeys_effect) call move_storeys(term, coef(1, own), &
               y(1, term%state), motion, d)
         end associate
      end do
   end subroutine lane_storeys

   !> Add the powers of ground motion, dampers and smooth plastic flow to a sum. The dissipation of
   !> springs on straight lines is computed from their elongations instead.
   subroutine lane_powers(scene, weight, coef, y, y_dot, motion, total)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: weight
      !! weight of the powers in the sum [-]
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms, for the current side and the active branches
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! states
      real(wp), intent(in) :: y_dot(lane_count, scene%n)
      !! rates of the states
      type(lane_motion_t), intent(in) :: motion
      !! motion as set by `lane_rates`
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over `power_unit` [W/kg]
      integer :: i

      if (scene%has_wall) call add_wall_power(weight, motion, total)
      do i = 1, size(scene%terms)
         associate (term => scene%terms(i), own => scene%terms(i)%coef)
            select case (term%effect)
            case (frame_term)
               call add_frame_power(weight, coef(1, own), motion, total)
            case (storeys_effect)
               if (term%n > 0) then
                  call add_floor_power(term, weight, coef(1, own), y(1, term%state), &
                     y_dot(1, term%state), motion, total)
               else
                  call add_excited_mass_power(weight, coef(1, own), motion, total)
               end if
            case (chord_term)
               call add_chord_power(weight, coef(1, own), motion, total)
            case (rise_term)
               call add_rise_power(weight, coef(1, own), motion, total)
            case (yielding_effect)
               call add_bouc_wen_power(weight, coef(1, own), y(1, term%state), &
                  y_dot(1, term%state), motion, total)
            case (vertical_effect)
               call add_vertical_power(weight, coef(1, own), motion, total)
            case (nl_damper_effect)
               call add_nl_damper_power(weight, coef(1, own), motion, total)
            case (bending_effect)
               call add_mode_power(term, weight, coef(1, own), y(1, term%state), &
                  y_dot(1, term%state), motion, total)
            case default
               ! this term stores energy only, or dissipates on straight lines
            end select
         end associate
      end do
   end subroutine lane_powers

   !> Unit of these powers: R**2, for a bare frame 1 [m2].
   pure subroutine power_unit(scene, coef, unit)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms, for the current side and the active branches
      real(wp), intent(out) :: unit(lane_count)
      !! R**2, for a bare frame 1 [m2]
      integer :: i

      !$omp simd
      do i = 1, lane_count
         unit(i) = 1
      end do
      if (.not. scene%has_wall) return
      !$omp simd
      do i = 1, lane_count
         unit(i) = 1/(coef(i, first_wall + 1)*coef(i, first_wall + 1))
      end do
   end subroutine power_unit

end module rwmf_model_effects_loops
