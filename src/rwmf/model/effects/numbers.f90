!> Numbers of the effects: their indices in `all_effects`, which the loops over lanes use as well.
module rwmf_model_effects_numbers
   implicit none
   private

   public :: storeys_effect, link_effect, damper_effect, inerter_effect, fuse_effect, &
      yielding_effect, vertical_effect, pinned_base_effect, impact_table_effect, tendon_effect, &
      p_delta_effect, nl_damper_effect, bending_effect, &
      coupling_effect, restraint_effect, compliant_base_effect, effect_count

   integer, parameter :: storeys_effect = 1
   integer, parameter :: link_effect = 2
   integer, parameter :: damper_effect = 3
   integer, parameter :: inerter_effect = 4
   integer, parameter :: fuse_effect = 5
   integer, parameter :: yielding_effect = 6
   integer, parameter :: vertical_effect = 7
   integer, parameter :: pinned_base_effect = 8
   integer, parameter :: impact_table_effect = 9
   integer, parameter :: tendon_effect = 10
   integer, parameter :: p_delta_effect = 11
   integer, parameter :: nl_damper_effect = 12
   integer, parameter :: bending_effect = 13
   integer, parameter :: coupling_effect = 14
   integer, parameter :: restraint_effect = 15
   integer, parameter :: compliant_base_effect = 16
   integer, parameter :: effect_count = 16

end module rwmf_model_effects_numbers
