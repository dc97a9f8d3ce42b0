!> The one list of effects beyond wall, frame and cable. Whatever reads, checks, describes or lists
!> a case walks along it.
module rwmf_model_effects_list
   use rwmf_model_effects_corner_damper, only: damper_group
   use rwmf_model_effects_corner_inerter, only: inerter_group
   use rwmf_model_effects_fuse, only: fuse_group
   use rwmf_model_effects_impact_table, only: impact_table_group
   use rwmf_model_effects_link, only: link_group
   use rwmf_model_effects_pinned_base, only: pinned_base_group
   use rwmf_model_effects_storeys_storeys, only: storeys_group
   use rwmf_model_effects_tendon, only: tendon_group
   use rwmf_model_effects_vertical_motion, only: vertical_group
   use rwmf_model_effects_yielding, only: yielding_group
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   implicit none
   private

   public :: all_effects, has_effects

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
