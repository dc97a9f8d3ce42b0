!> Reference mass of a case's dimensionless ratios.
module rwmf_problem_units
   use rwmf_core_kinds, only: wp
   use rwmf_problem_group_values, only: get_list, group_values_t, has_group, has_key, real_of
   use rwmf_problem_shear_frame, only: floors_group
   implicit none
   private

   public :: unit_of, unit_mass, mass_of_frame, mass_keys

   character(*), parameter :: mass_keys = '&frame m_s or &'//floors_group//' m (with &wall its ' &
      //'ratio as well)'
   !! keys that give the mass of the frame, for messages

contains

   !> Factor that converts a ratio to a number with a unit; 0 if the case has no mass.
   pure real(wp) function unit_of(values, si) result(unit)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: si
      !! unit of the result: 'N' for ratios to the weight, others for ratios to the mass

      unit = unit_mass(values)
      if (si == 'N') unit = unit*real_of(values, 'model', 'g')
   end function unit_of

   !> Reference mass of masses, stiffnesses and forces [kg]: mass of the wall, or without a wall of
   !> the frame. It is 1 kg for storeys in kg, and 0 if the case gives no mass.
   pure real(wp) function unit_mass(values) result(mass)
      type(group_values_t), intent(in) :: values

      if (has_group(values, 'wall')) then
         mass = real_of(values, 'wall', 'm_w')
      else if (has_group(values, floors_group)) then
         mass = merge(1, 0, has_key(values, floors_group, 'm'))
      else
         mass = real_of(values, 'frame', 'm_s')
      end if
   end function unit_mass

   !> Mass of the frame including all its floors; 0 if the case gives none [kg].
   pure real(wp) function mass_of_frame(values) result(mass)
      type(group_values_t), intent(in) :: values
      real(wp), allocatable :: m(:)

      mass = unit_mass(values)
      if (has_group(values, floors_group)) then
         call get_list(values, floors_group, 'm_over_m_w', m)
         if (allocated(m)) mass = sum(m)*mass
      else if (has_group(values, 'wall')) then
         mass = real_of(values, 'frame', 'gamma')*mass
      end if
   end function mass_of_frame

end module rwmf_problem_units
