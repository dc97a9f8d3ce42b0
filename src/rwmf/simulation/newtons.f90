!> Forces in N and moments in N m from those that runs report over a weight: `wall_shear_max_N` is
!> `wall_shear_max_over_m_w_g` times m_w g, and so for every key of the table of quantities.
module rwmf_simulation_newtons
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: structure_t
   implicit none
   private

   public :: in_newtons, weight_under, ratios

   character(*), parameter :: ratios(3) = [character(12) :: '_over_m_w_g', '_over_weight', &
      '_over_m_s_g']
   !! how the keys name the weight that they are over

contains

   !> Key in N or N m of a force or moment over a weight; '' for other keys.
   elemental character(40) function in_newtons(key)
      character(*), intent(in) :: key
      !! with unit suffix
      integer :: i, first, last

      in_newtons = ''
      do i = 1, size(ratios)
         first = index(key, trim(ratios(i)))
         last = first + len_trim(ratios(i)) - 1
         if (first == 0) cycle
         if (key(last + 1:) == '') in_newtons = key(:first - 1)//'_N'
         if (key(last + 1:) == '_m') in_newtons = key(:first - 1)//'_N_m'
      end do
   end function in_newtons

   !> The weight that the forces of a key are over; 0 where the case has no mass [N].
   pure real(wp) function weight_under(case, key) result(weight)
      class(structure_t), intent(in) :: case
      !! with its period and mass ratio
      character(*), intent(in) :: key
      !! with one of `ratios`
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
      if (index(key, trim(ratios(3))) > 0) then
         weight = frame*weight
      else if (index(key, trim(ratios(2))) > 0) then
         weight = (merge(1, 0, allocated(case%wall)) + floors)*weight
      end if
   end function weight_under

end module rwmf_simulation_newtons
