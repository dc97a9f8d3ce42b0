!> Forces in N and moments in N m from reported ratios to a weight.
!>
!> For example, `wall_shear_max_N` is `wall_shear_max_over_m_w_g` times m_w g.
module rwmf_simulation_state_newtons
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: has_floors, structure_t
   use rwmf_problem_scene_axes, only: walls_of
   use rwmf_problem_quantity_table, only: all_quantities, key_of
   use rwmf_problem_quantity_values, only: put, values_t
   implicit none
   private

   public :: force_t, forces_of, put_newtons, weight_under

   !> Force in N, or moment in N m, that follows from another value.
   type :: force_t
      integer :: id
      !! number of its quantity
      integer :: place
      !! place of the ratio
      real(wp) :: weight
      !! under the ratio [N]
   end type force_t

contains

   !> List the forces and moments that follow from values over a weight; none without a mass.
   pure function forces_of(case, values) result(forces)
      class(structure_t), intent(in) :: case
      !! case with its period and mass ratio
      type(values_t), intent(in) :: values
      type(force_t), allocatable :: forces(:)
      integer :: i, row

      allocate (forces(0))
      if (.not. case%unit_mass > 0) return
      do i = 1, values%n
         row = findloc(all_quantities%ratio, values%ids(i), dim=1)
         if (row == 0) cycle
         if (any(values%ids(:values%n) == all_quantities(row)%id)) cycle
         forces = [forces, force_t(all_quantities(row)%id, i, weight_under(case, values%ids(i)))]
      end do
   end function forces_of

   !> Append forces and moments.
   pure subroutine put_newtons(values, forces)
      type(values_t), intent(inout) :: values
      type(force_t), intent(in) :: forces(:)
      integer :: i

      do i = 1, size(forces)
         associate (place => forces(i)%place)
            call put(values, forces(i)%id, values%numbers(place:place)*forces(i)%weight, &
               values%levels(place) - 1)
         end associate
      end do
   end subroutine put_newtons

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
