!> Taylor series of the equation of motion: kinematics, followed by the series of each term of a
!> scene, one coefficient after the other.
module rwmf_model_series_scene_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_numbers, only: bending_effect, inerter_effect, link_effect, &
      nl_damper_effect, p_delta_effect, storeys_effect, vertical_effect, yielding_effect
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: axis_term, chord_term, first_wall, frame_term, line_term, &
      rise_term, scene_t, term_t
   use rwmf_model_series_bending_series, only: bend_series, bending_memory, expand_modes, &
      locate_floors, release_series
   use rwmf_model_series_corner_series, only: expand_excited_mass, expand_inerter, &
      expand_leaning_column, expand_nl_damper, expand_vertical
   use rwmf_model_series_element_series, only: expand_axial, expand_chords, expand_rises, &
      expand_straight_tendons, tendon_memory
   use rwmf_model_series_series_motion, only: expand_bare_frame, expand_frame, expand_link, &
      expand_wall, highest_order, quotient_of, series_motion_t
   use rwmf_model_series_smooth_series, only: expand_bouc_wen, locate_spring
   use rwmf_model_series_storey_series, only: expand_floors, expand_storey_columns, &
      locate_storeys, storey_memory
   implicit none
   private

   public :: expand_states, series_memory, smooth_springs

contains

   !> Number of series that the terms of a scene keep between two coefficients.
   pure integer function series_memory(scene) result(n)
      type(scene_t), intent(in) :: scene
      integer :: i

      n = 0
      do i = 1, size(scene%terms)
         n = n + memory_of(scene%terms(i))
      end do
   end function series_memory

   !> Number of series that a term keeps.
   pure integer function memory_of(term) result(n)
      type(term_t), intent(in) :: term

      n = 0
      if (term%effect == storeys_effect .and. term%n > 0) n = storey_memory(term)
      if (term%effect == bending_effect) n = bending_memory(term)
      if (term%effect == line_term) n = tendon_memory*term%n
   end function memory_of

   !> Continue the series of all states from one order to a higher one. Order 0 is their values at
   !> the start of a step.
   pure subroutine expand_states(scene, coef, known, order, motion, y, memory)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the terms, for the current side and the active branches
      integer, intent(in) :: known
      !! order of the series on entry
      integer, intent(in) :: order
      !! order of the series on return
      type(series_motion_t), intent(inout) :: motion
      !! with the series of the ground motion, and of the kinematics to the same order
      real(wp), intent(inout) :: y(lane_count, 0:highest_order, scene%n)
      !! (coefficients, states) series of the states
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, series_memory(scene))
      !! (coefficients, `series_memory`)
      real(wp) :: rates(lane_count, scene%n)
      integer :: i, n

      do n = known, order - 1
         call expand_rates(scene, coef, n, y, memory, motion, rates)
         do i = 1, scene%n
            y(:, n + 1, i) = rates(:, i)/(n + 1)
         end do
      end do
   end subroutine expand_states

   !> List the smooth springs: state z, and columns of the factor of its power and of the exponent.
   pure function smooth_springs(scene) result(found)
      type(scene_t), intent(in) :: scene
      integer, allocatable :: found(:, :)
      !! (3, springs)
      integer :: i, j, n, first(3)

      allocate (found(3, 0))
      do i = 1, size(scene%terms)
         n = 0
         associate (term => scene%terms(i))
            if (term%effect == yielding_effect) call locate_spring(term, n, first)
            if (term%effect == storeys_effect) call locate_storeys(term, n, first)
            if (term%effect == bending_effect) call locate_floors(term, n, first)
         end associate
         do j = 0, n - 1
            found = reshape([found, first + j], [3, size(found, 2) + 1])
         end do
      end do
   end function smooth_springs

   !> Compute coefficient n of the rates of all states.
   pure subroutine expand_rates(scene, coef, n, y, memory, motion, rates)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(lane_count, 0:highest_order, scene%n)
      !! series of the states, up to coefficient n
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, series_memory(scene))
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: rates(lane_count, scene%n)
      integer :: i, next

      if (scene%has_wall) then
         call expand_wall(n, coef(1, first_wall), y(1, n, 1), y(1, n, 2), motion)
      else
         call expand_bare_frame(n, y(1, n, 1), y(1, n, 2), motion)
      end if
      if (scene%bent > 0) then
         next = 1 + sum([(memory_of(scene%terms(i)), i=1, scene%bent - 1)])
         associate (term => scene%terms(scene%bent))
            call bend_series(n, term, coef(1, term%coef), coef(1, first_wall), &
               y(1, 0, term%state), memory(1, 0, next), motion)
         end associate
      end if
      next = 1
      do i = 1, size(scene%terms)
         call expand_term(n, scene%terms(i), coef(1, scene%terms(i)%coef), y, memory(1, 0, next), &
            motion, rates)
         next = next + memory_of(scene%terms(i))
      end do
      ! the first coefficient is 0 for a wall that is held
      motion%turn(:, n) = coef(:, 1)*quotient_of(n, motion%moment(:, n), motion%inertia, &
         motion%turn)
      rates(:, 1) = y(:, n, 2)
      rates(:, 2) = motion%side*motion%turn(:, n)
      if (scene%bent > 0) then
         associate (term => scene%terms(scene%bent))
            next = 1 + sum([(memory_of(scene%terms(i)), i=1, scene%bent - 1)])
            call release_series(n, term, coef(1, term%coef), y(1, 0, term%state), &
               memory(1, 0, next), motion, rates(1, term%state))
         end associate
      end if
   end subroutine expand_rates

   !> Add coefficient n of a term to the series.
   pure subroutine expand_term(n, term, coef, y, memory, motion, rates)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: y(lane_count, 0:highest_order, max(2, term%state + term%n_states - 1))
      !! series of the states
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, memory_of(term))
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: rates(lane_count, max(2, term%state + term%n_states - 1))

      select case (term%effect)
      case (frame_term)
         call expand_frame(n, coef, motion)
      case (axis_term)
         call expand_axial(n, coef, motion)
      case (line_term)
         call expand_straight_tendons(n, term%n, coef, memory, motion)
      case (chord_term)
         call expand_chords(n, coef, motion)
      case (rise_term)
         call expand_rises(n, coef, motion)
      case (storeys_effect)
         if (term%n > 0) then
            call expand_floors(n, term, coef, y(1, 0, term%state), memory, motion, &
               rates(1, term%state))
         else
            call expand_excited_mass(n, coef, motion)
         end if
      case (link_effect)
         call expand_link(n, coef, motion)
      case (inerter_effect)
         call expand_inerter(n, coef, motion)
      case (yielding_effect)
         call expand_bouc_wen(n, term%law, coef, y(1, 0, term%state), motion, &
            rates(1, term%state))
      case (vertical_effect)
         call expand_vertical(n, coef, motion)
      case (p_delta_effect)
         if (term%n > 0) then
            call expand_storey_columns(n, term%n, term%n_states/2, coef, &
               y(1, 0, term%state), motion, rates(1, term%state))
         else
            call expand_leaning_column(n, coef, motion)
         end if
      case (nl_damper_effect)
         call expand_nl_damper(n, coef, motion)
      case (bending_effect)
         call expand_modes(n, term, coef, y, memory, motion, rates)
      case default
         ! this effect has no loop and therefore no term
      end select
   end subroutine expand_term

end module rwmf_model_series_scene_series
