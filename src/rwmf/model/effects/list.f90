!> The one list of effects beyond wall, frame and cable. Whatever reads, checks, describes or lists
!> a case walks along it.
module rwmf_model_effects_list
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_corner_damper, only: add_damper, damper_group, prepare_damper
   use rwmf_model_effects_corner_inerter, only: add_inerter, inerter_group, &
      prepare_inerter
   use rwmf_model_effects_fuse, only: add_fuse, fuse_group, prepare_fuse
   use rwmf_model_effects_impact_table, only: impact_table_group
   use rwmf_model_effects_link, only: link_group, prepare_link
   use rwmf_model_effects_pinned_base, only: pinned_base_group
   use rwmf_model_effects_storeys_floors, only: add_excited_mass, add_floors
   use rwmf_model_effects_storeys_storeys, only: prepare_storeys, storeys_group
   use rwmf_model_effects_tendon, only: tendon_group
   use rwmf_model_effects_vertical_motion, only: add_vertical, prepare_vertical, &
      vertical_group
   use rwmf_model_effects_yielding, only: add_bouc_wen, prepare_yielding, yielding_group
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_model_lanes, only: add_frame, add_linear_cable, add_straight_cable, lane_count, &
      lane_motion_t, move_bare_frame, move_wall, tilt_link
   use rwmf_model_scene, only: first_wall, frame_term, linear_cable_term, scene_t, &
      straight_cable_term, term_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   implicit none
   private

   public :: all_effects, has_effects, prepare_effect, lane_rates

contains

   !> Every effect, in the order in which it is asked.
   function all_effects() result(effects)
      type(case_group_t), allocatable :: effects(:)

      ! one by one: gfortran 12 loses the keys of what stands in an array constructor
      allocate (effects(10))
      effects(1) = storeys_group()
      effects(2) = link_group()
      effects(3) = damper_group()
      effects(4) = inerter_group()
      effects(5) = fuse_group()
      effects(6) = yielding_group()
      effects(7) = vertical_group()
      effects(8) = pinned_base_group()
      effects(9) = impact_table_group()
      effects(10) = tendon_group()
   end function all_effects

   !> What an effect of the list brings into the equation of motion.
   subroutine prepare_effect(number, case, equation, effect)
      integer, intent(in) :: number
      type(case_t), intent(in) :: case
      !! in which it is present
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: effect

      select case (number)
      case (1)
         call prepare_storeys(case, equation, effect)
      case (2)
         call prepare_link(effect)
      case (3)
         call prepare_damper(case, equation, effect)
      case (4)
         call prepare_inerter(case, equation, effect)
      case (5)
         call prepare_fuse(case, equation, effect)
      case (6)
         call prepare_yielding(case, equation, effect)
      case (7)
         call prepare_vertical(case, equation, effect)
      case default
         ! a base, a rule of impacts, a law of the cable: nothing beyond wall and cable
      end select
   end subroutine prepare_effect

   !> First-order form of the equation of motion: kinematics, then what each loop of the scene adds
   !> to inertia and moment, and the rates of its own states.
   subroutine lane_rates(scene, coef, y, motion, y_dot)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! states: theta [rad] and theta' [rad/s], bare frame u [m] and u' [m/s]; those of effects
      type(lane_motion_t), intent(inout) :: motion
      !! in: accelerations of the ground; out: kinematics, inertia and moment
      real(wp), intent(out) :: y_dot(lane_count, scene%n)
      integer :: i

      if (scene%has_wall) then
         call move_wall(coef(1, first_wall), y(1, 1), y(1, 2), motion)
      else
         call move_bare_frame(y(1, 1), y(1, 2), motion)
      end if
      do i = 1, size(scene%terms)
         ! without states of its own none is read
         associate (term => scene%terms(i), own => min(scene%terms(i)%state, scene%n))
            call add_effect(term, coef(1, term%coef), y(1, own), motion, y_dot(1, own))
         end associate
      end do
      !$omp simd
      do i = 1, lane_count
         y_dot(i, 1) = y(i, 2)
         y_dot(i, 2) = coef(i, 1)*(motion%side(i)*motion%moment(i)/motion%inertia(i))
      end do
   end subroutine lane_rates

   !> What one loop of a scene adds.
   pure subroutine add_effect(term, coef, own, motion, own_dot)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      real(wp), intent(in) :: own(lane_count, term%n_states)
      !! its states
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: own_dot(lane_count, term%n_states)
      !! their rates

      select case (term%effect)
      case (frame_term)
         call add_frame(coef, motion)
      case (linear_cable_term)
         call add_linear_cable(coef, motion)
      case (straight_cable_term)
         call add_straight_cable(coef, motion)
      case (1)
         if (term%n > 0) then
            call add_floors(term%n, term%law, coef, own, motion, own_dot)
         else
            call add_excited_mass(coef, motion)
         end if
      case (2)
         call tilt_link(coef, motion)
      case (3)
         call add_damper(coef, motion)
      case (4)
         call add_inerter(coef, motion)
      case (5)
         call add_fuse(coef, motion)
      case (6)
         call add_bouc_wen(term%law, coef, own, motion, own_dot)
      case (7)
         call add_vertical(coef, motion)
      case default
         ! has no loop, and therefore no term
      end select
   end subroutine add_effect

   !> Does the case call for any effect of the list?
   logical function has_effects(case)
      type(case_t), intent(in) :: case
      type(case_group_t), allocatable :: effects(:)
      integer :: i

      effects = all_effects()
      has_effects = .false.
      do i = 1, size(effects)
         has_effects = has_effects .or. effects(i)%is_present(case)
      end do
   end function has_effects

end module rwmf_model_effects_list
