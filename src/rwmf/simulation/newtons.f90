!> Weights for forces in N and moments in N m from those that runs report over a weight:
!> `wall_shear_max_N` is `wall_shear_max_over_m_w_g` times m_w g.
module rwmf_simulation_newtons
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: structure_t
   use rwmf_problem_quantity_table, only: key_of
   implicit none
   private

   public :: weight_under

contains

   !> Weight that the forces of a quantity are over; 0 where the case has no mass [N].
   pure real(wp) function weight_under(case, number) result(weight)
      class(structure_t), intent(in) :: case
      !! with its period and mass ratio
      integer, intent(in) :: number
      !! of a quantity over a weight
      real(wp) :: frame, floors
      !! masses of its spring and of all its floors over the unit of mass [-]

      frame = 0
      if (allocated(case%frame)) frame = 1
      if (allocated(case%wall) .and. allocated(case%frame)) frame = case%frame%gamma
      floors = frame
      if (allocated(case%storeys)) then
         floors = sum(case%storeys%frame%m)
         associate (shape => case%storeys%frame%shape)
            if (.not. allocated(case%wall)) frame = 1/shape(size(shape, 1), 1)**2
         end associate
      end if
      weight = case%unit_mass*case%model%g
      associate (key => key_of(number))
         if (index(key, '_over_m_s_g') > 0) then
            weight = frame*weight
         else if (index(key, '_over_weight') > 0) then
            weight = (merge(1, 0, allocated(case%wall)) + floors)*weight
         end if
      end associate
   end function weight_under

end module rwmf_simulation_newtons
