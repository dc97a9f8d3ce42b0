!> Common engineering terms for output quantities, for messages about unknown quantities.
module rwmf_simulation_quantity_words
   use rwmf_problem_quantity_table, only: all_quantities, key_length, look_up
   use rwmf_text_strings, only: nearest_name, to_lower
   implicit none
   private

   public :: list_quantities, meant_quantity, suggest_quantity

   !> Term and corresponding key.
   type :: word_t
      character(32) :: word
      !! term in lower case, with '_' between its parts, without 'peak', 'max' and number
      character(key_length) :: key
      !! key in the table of quantities
   end type word_t

   !> Smallest number of letters for a match with the beginning of a key.
   integer, parameter :: shortest = 4

   type(word_t), parameter :: words(*) = [ &
      word_t('idr', 'storey_drift_max'), &
      word_t('isdr', 'storey_drift_max'), &
      word_t('interstorey_drift', 'storey_drift_max'), &
      word_t('interstory_drift', 'storey_drift_max'), &
      word_t('inter_storey_drift', 'storey_drift_max'), &
      word_t('inter_story_drift', 'storey_drift_max'), &
      word_t('storey_drift', 'storey_drift_max'), &
      word_t('story_drift', 'storey_drift_max'), &
      word_t('drift', 'storey_drift_max'), &
      word_t('rdr', 'roof_drift_max'), &
      word_t('roof_drift', 'roof_drift_max'), &
      word_t('pfa', 'floor_acceleration_max_g'), &
      word_t('floor_acceleration', 'floor_acceleration_max_g'), &
      word_t('absolute_acceleration', 'floor_acceleration_max_g'), &
      word_t('acceleration', 'floor_acceleration_max_g'), &
      word_t('residual_drift', 'storey_residual_drift_max'), &
      word_t('residual_idr', 'storey_residual_drift_max'), &
      word_t('ridr', 'storey_residual_drift_max'), &
      word_t('residual_interstorey_drift', 'storey_residual_drift_max'), &
      word_t('base_shear', 'base_shear_max_over_weight'), &
      word_t('overturning_moment', 'overturning_moment_max_over_weight_m'), &
      word_t('displacement', 'u_s_max_m'), &
      word_t('roof_displacement', 'u_s_max_m'), &
      word_t('sd', 'u_s_max_m'), &
      word_t('u', 'u_s_max_m'), &
      word_t('rotation', 'theta_max_over_alpha'), &
      word_t('uplift', 'theta_max_over_alpha'), &
      word_t('tendon_force', 'tendon_force_max_over_m_w_g'), &
      word_t('cable_force', 'cable_force_increment_max_over_m_w_g'), &
      word_t('ductility_demand', 'ductility'), &
      word_t('friction', 'friction_demand_max')]

   character(key_length), parameter :: ordinates(*) = pack(all_quantities%key, &
      index(all_quantities%outputs, 'ordinate') > 0)
   !! keys of the quantities that a spectrum can report

contains

   !> Key of the quantity that a word may mean, by common terms or by similar spelling; blank if
   !> none matches.
   pure character(key_length) function meant_quantity(word) result(key)
      character(*), intent(in) :: word
      !! word as the user writes it
      character(len(word)) :: plain
      integer :: place, number

      plain = to_lower(adjustl(word))
      do place = 1, len(plain)
         if (place > len_trim(plain)) exit
         if (scan(plain(place:place), '- ') > 0) plain(place:place) = '_'
      end do
      plain = without_extremes(plain)
      place = findloc(words%word == plain, .true., dim=1)
      if (place > 0) then
         key = words(place)%key
         return
      end if
      place = findloc(index(ordinates, to_lower(trim(adjustl(word)))) == 1, .true., dim=1)
      if (place > 0 .and. len_trim(word) >= shortest) then
         key = ordinates(place)
         return
      end if
      key = nearest_name(trim(adjustl(word)), ordinates)
      if (key == '') key = nearest_name(trim(plain)//'_max', words%key)
      call look_up(trim(key), place, number)
      if (place == 0) key = ''
   end function meant_quantity

   !> Append the quantities of a scene to a message, or the page with their requirements.
   pure subroutine list_quantities(keys, problem)
      character(*), intent(in) :: keys(:)
      !! (n) keys of the quantities that apply
      character(:), allocatable, intent(inout) :: problem
      !! message about a quantity that does not apply
      integer, parameter :: most = 12
      integer :: i

      if (size(keys) > most) then
         problem = problem//'; reference/outputs.md lists the requirements of each quantity'
         return
      end if
      problem = problem//'; allowed:'
      do i = 1, size(keys)
         problem = problem//' '//trim(keys(i))
      end do
   end subroutine list_quantities

   !> Append the closest quantity and the page that lists all of them to a message.
   pure subroutine suggest_quantity(near, problem)
      character(*), intent(in) :: near
      !! key of the closest quantity, blank if there is none
      character(:), allocatable, intent(inout) :: problem
      !! message about an unknown quantity

      if (near == '') then
         problem = problem//'; the list: reference/outputs.md'
      else
         problem = problem//', did you mean '//trim(near)//'? The list: reference/outputs.md'
      end if
   end subroutine suggest_quantity

   !> Word without 'peak' and 'max', and without a final storey or floor number.
   pure function without_extremes(word) result(plain)
      character(*), intent(in) :: word
      !! word in lower case
      character(len(word)) :: plain
      character(8), parameter :: before(*) = [character(8) :: 'peak_', 'max_', 'maximum_', &
         'largest_']
      integer :: i, n

      plain = word
      do i = 1, size(before)
         n = len_trim(before(i))
         if (index(plain, trim(before(i))) == 1) plain = plain(n + 1:)
      end do
      n = verify(trim(plain), '0123456789_', back=.true.)
      if (n > 0) plain = plain(:n)
      n = len_trim(plain)
      if (n <= 4) return
      if (plain(n - 3:n) == '_max') plain = plain(:n - 4)
   end function without_extremes

end module rwmf_simulation_quantity_words
