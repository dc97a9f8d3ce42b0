!> Lateral load pattern: share of each floor in the load.
module rwmf_simulation_pushover_load_pattern
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_demands, only: building_t
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: find_pattern

contains

   !> Find the pattern by its name. Without a frame the load acts on the top of the wall.
   subroutine find_pattern(building, name, forces, pattern, error)
      type(building_t), intent(in) :: building
      character(*), intent(in) :: name
      !! 'first_mode', 'floors' or 'roof'
      real(wp), intent(in) :: forces(:)
      !! forces on the floors from the ground up, for 'floors' only; in any unit
      real(wp), allocatable, intent(out) :: pattern(:)
      !! (loads) sum 1 [-]
      type(error_t), allocatable, intent(out) :: error
      !! unknown name, or forces that do not fit the floors

      allocate (pattern(max(1, building%floors)), source=0.0_wp)
      pattern(size(pattern)) = 1
      if (name /= 'floors' .and. size(forces) > 0) then
         call fail(error, err_input, "forces: must only be given with the pattern 'floors', not '" &
            //name//"'")
         return
      end if
      select case (name)
      case ('roof')
         return
      case ('first_mode')
         if (building%floors > 0) pattern = building%m*building%share
      case ('floors')
         if (size(forces) /= size(pattern)) then
            call fail(error, err_input, 'forces: has '//trim(integer_to_text(size(forces))) &
               //' values, must have one for each floor that is loaded: ' &
               //trim(integer_to_text(size(pattern))))
            return
         end if
         pattern = forces
      case default
         call fail(error, err_input, "pattern = '"//name//"': must be 'first_mode', 'floors' or " &
            //"'roof'")
         return
      end select
      if (.not. (sum(pattern) > 0 .and. all(abs(pattern) < huge(1.0_wp)))) then
         call fail(error, err_input, 'forces: the sum is '//trim(real_to_text(sum(pattern))) &
            //', must be a finite number > 0')
         return
      end if
      pattern = pattern/sum(pattern)
   end subroutine find_pattern

end module rwmf_simulation_pushover_load_pattern
