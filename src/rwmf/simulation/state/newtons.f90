!> Weights that convert reported force ratios to N and moment ratios to N m.
!>
!> For example, `wall_shear_max_N` is `wall_shear_max_over_m_w_g` times m_w g.
module rwmf_simulation_state_newtons
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: has_floors, structure_t
   use rwmf_problem_scene_axes, only: walls_of
   use rwmf_problem_quantity_table, only: key_of
   implicit none
   private

   public :: weight_under

contains

   !> Reference weight of a force ratio; 0 if the case has no mass [N].
   pure real(wp) function weight_under(case, number) result(weight)
      class(structure_t), intent(in) :: case
      !! case with its period and mass ratio
      integer, intent(in) :: number
      !! number of a quantity with a weight in its denominator
      real(wp) :: frame, floors
      !! mass of the frame and total mass of its floors over the unit of mass [-]

      frame = 0
      if (allocated(case%frame)) frame = 1
      if (allocated(case%wall) .and. allocated(case%frame)) frame = case%frame%gamma
      floors = frame
      if (has_floors(case)) then
         floors = sum(case%frame%floors%m)
         associate (shape => case%frame%floors%shape)
            if (.not. allocated(case%wall)) frame = 1/shape(size(shape, 1), 1)**2
         end associate
      end if
      weight = case%unit_mass*case%model%g
      associate (key => key_of(number))
         if (index(key, '_over_m_s_g') > 0) then
            weight = frame*weight
         else if (index(key, '_over_weight') > 0) then
            weight = (merge(walls_of(case), 0, allocated(case%wall)) + floors)*weight
         end if
      end associate
   end function weight_under

end module rwmf_simulation_state_newtons
