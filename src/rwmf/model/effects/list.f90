!> List of all effects beyond wall, frame and cable. The procedures that read, check, describe or
!> list a case iterate over it.
module rwmf_model_effects_list
   use rwmf_model_effects_bending, only: bending_group, prepare_bending
   use rwmf_model_effects_corner_inerter, only: inerter_group, prepare_inerter
   use rwmf_model_effects_devices, only: coupling_group, damper_group, fuse_group, &
      nl_damper_group, restraint_group
   use rwmf_model_effects_impact_table, only: impact_table_group
   use rwmf_model_effects_link, only: link_group, prepare_link
   use rwmf_model_effects_nl_damper, only: prepare_nl_damper
   use rwmf_model_effects_numbers, only: bending_effect, coupling_effect, damper_effect, &
      effect_count, fuse_effect, impact_table_effect, inerter_effect, link_effect, &
      nl_damper_effect, p_delta_effect, pinned_base_effect, restraint_effect, storeys_effect, &
      compliant_base_effect, tendon_effect, vertical_effect, yielding_effect
   use rwmf_model_effects_p_delta, only: p_delta_group, prepare_p_delta
   use rwmf_model_effects_pinned_base, only: pinned_base_group
   use rwmf_model_effects_compliant_base, only: compliant_base_group
   use rwmf_model_effects_storeys_storeys, only: prepare_storeys, storeys_group
   use rwmf_model_effects_tendon, only: tendon_group
   use rwmf_model_effects_vertical_motion, only: prepare_vertical, vertical_group
   use rwmf_model_effects_yielding, only: prepare_yielding, yielding_group
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   implicit none
   private

   public :: all_effects, prepare_effect

contains

   !> Create the list of all effects, in the order of their evaluation.
   function all_effects() result(effects)
      type(case_group_t), allocatable :: effects(:)

      ! assigned one by one: gfortran 12 loses the keys of elements of an array constructor
      allocate (effects(effect_count))
      effects(storeys_effect) = storeys_group()
      effects(link_effect) = link_group()
      effects(damper_effect) = damper_group()
      effects(inerter_effect) = inerter_group()
      effects(fuse_effect) = fuse_group()
      effects(yielding_effect) = yielding_group()
      effects(vertical_effect) = vertical_group()
      effects(pinned_base_effect) = pinned_base_group()
      effects(impact_table_effect) = impact_table_group()
      effects(tendon_effect) = tendon_group()
      effects(p_delta_effect) = p_delta_group()
      effects(nl_damper_effect) = nl_damper_group()
      effects(bending_effect) = bending_group()
      effects(coupling_effect) = coupling_group()
      effects(restraint_effect) = restraint_group()
      effects(compliant_base_effect) = compliant_base_group()
   end function all_effects

   !> Prepare the contribution of one effect to the equation of motion, if the case has the effect.
   subroutine prepare_effect(number, case, equation, effect)
      integer, intent(in) :: number
      !! index of the effect in the list
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: effect

      select case (number)
      case (storeys_effect)
         call prepare_storeys(case, equation, effect)
      case (link_effect)
         call prepare_link(case, effect)
      case (inerter_effect)
         call prepare_inerter(case, equation, effect)
      case (yielding_effect)
         call prepare_yielding(case, equation, effect)
      case (vertical_effect)
         call prepare_vertical(case, equation, effect)
      case (p_delta_effect)
         call prepare_p_delta(case, equation, effect)
      case (nl_damper_effect)
         call prepare_nl_damper(case, effect)
      case (bending_effect)
         call prepare_bending(case, equation, effect)
      case default
         ! base, rule of impacts: no contribution; tendons and devices are vertical elements
      end select
   end subroutine prepare_effect

end module rwmf_model_effects_list
