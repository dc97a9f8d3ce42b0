!> Table of output quantities: history columns, scalars of a run, and the additional results of
!> spectra, sweeps and method comparisons. The summary, Python and `docs/reference/outputs.md` use
!> this table. Sensitivities follow its last row, see `sensitivity_row`.
module rwmf_problem_quantity_table
   use rwmf_problem_quantity, only: key_length, of_demands, of_displacement, of_energy, &
      of_envelopes, of_reactions, of_storeys, of_velocity, of_verification, quantity_t
   use rwmf_problem_quantity_rows, only: all_quantities, id
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: quantity_t, id, key_of, all_quantities, look_up, canonical_key, is_of_ordinate
   public :: is_peak, key_length, own_key, sensitivity_id, sensitivity_row
   public :: requested_by, name_of
   public :: of_displacement, of_velocity, of_storeys, of_reactions, of_demands, of_energy
   public :: of_envelopes, of_verification

   character(*), parameter :: prefix = 'sensitivity_'
   !! beginning of the key of a sensitivity

contains

   !> Key of the quantity with a given number.
   elemental character(key_length) function key_of(number) result(key)
      integer, intent(in) :: number
      !! one of `id`

      key = all_quantities(number)%key
   end function key_of

   !> Look up the row of an output key in the table, and the number of a floor or storey in the key.
   pure subroutine look_up(key, place, number)
      character(*), intent(in) :: key
      !! key as spelled in an output
      integer, intent(out) :: place
      !! row of `all_quantities`, 0 for an unknown key
      integer, intent(out) :: number
      !! floor or storey number; 0 for a key without one
      integer :: first, behind, status

      number = 0
      place = findloc(all_quantities%key == key, .true., dim=1)
      call find_number(key, first, behind)
      if (place > 0 .or. behind == first .or. behind > first + 4) return
      read (key(first:behind - 1), '(i4)', iostat=status) number
      if (status == 0) place = findloc(all_quantities%key == key(:first - 1)//'{i}'//key(behind:), &
         .true., dim=1)
   end subroutine look_up

   !> Key in the spelling of the outputs. Capitals are accepted, and names of Python, which have no
   !> units. An unknown key is returned in lower case.
   elemental character(key_length) function canonical_key(key)
      character(*), intent(in) :: key
      !! key in the user's spelling
      character(key_length) :: lower, own

      lower = to_lower(key)
      own = own_key(lower)
      canonical_key = canonical_own(own)
      if (own /= lower) canonical_key = prefix//trim(canonical_key)
   end function canonical_key

   !> Spelling of the outputs for a key that is not that of a sensitivity.
   elemental character(key_length) function canonical_own(key) result(canonical_key)
      character(*), intent(in) :: key
      !! key in lower case
      character(key_length) :: row
      integer :: place, first, behind, braces

      canonical_key = key
      place = place_of(trim(canonical_key))
      if (place > 0) then
         canonical_key = all_quantities(place)%key
         return
      end if
      call find_number(canonical_key, first, behind)
      if (behind == first) return
      row = canonical_key(:first - 1)//'{i}'//canonical_key(behind:)
      place = place_of(trim(row))
      if (place == 0) return
      row = all_quantities(place)%key
      braces = index(row, '{i}')
      canonical_key = row(:braces - 1)//canonical_key(first:behind - 1)//row(braces + 3:)
   end function canonical_own

   !> Row of a key or of a name in Python; 0 if there is none.
   pure integer function place_of(key) result(place)
      character(*), intent(in) :: key
      !! key in lower case

      if (key /= '') then
         ! row by row: the keys of the whole table would be a large copy on the stack
         do place = 1, size(all_quantities)
            if (to_lower(all_quantities(place)%key) == key) return
         end do
         do place = 1, size(all_quantities)
            if (to_lower(name_of(all_quantities(place))) == key) return
         end do
      end if
      place = 0
   end function place_of

   !> Variable of a run's dataset in Python: the key without its unit; '' for an attribute, or
   !> outside runs.
   elemental character(key_length) function name_of(quantity) result(name)
      type(quantity_t), intent(in) :: quantity
      character(9) :: suffix
      integer :: i, n

      name = quantity%name
      if (name == '-') name = ''
      if (quantity%name /= '' .or. index(quantity%outputs, 'history') + index(quantity%outputs, &
         'run') == 0) return
      name = quantity%key
      suffix = '_'//quantity%unit
      do i = 1, len_trim(suffix)
         if (scan(suffix(i:i), ' /') == 1) suffix(i:i) = '_'
      end do
      n = len_trim(name) - len_trim(suffix)
      if (n > 0 .and. quantity%unit /= '') then
         if (name(n + 1:) == suffix) name = name(:n)
      end if
   end function name_of

   !> Find the number of a floor or storey in a key: the first number between underscores.
   pure subroutine find_number(key, first, behind)
      character(*), intent(in) :: key
      integer, intent(out) :: first
      integer, intent(out) :: behind
      !! position after the number; equal to `first` if there is none

      integer :: place

      first = 1
      do
         place = index(key(first:), '_')
         first = first + place
         behind = first
         if (place == 0) return
         behind = first + verify(key(first:)//' ', '0123456789') - 1
         if (behind > first .and. scan(key(behind:min(behind, len(key)))//'_', '_ ') == 1) return
      end do
   end subroutine find_number

   !> True if a spectrum can report the quantity.
   elemental logical function is_of_ordinate(quantity)
      type(quantity_t), intent(in) :: quantity

      is_of_ordinate = index(quantity%outputs, 'ordinate') > 0
   end function is_of_ordinate

   !> True for a peak of a run for which a case can require an accuracy. The height of a peak along
   !> the wall is excluded.
   elemental logical function is_peak(quantity)
      type(quantity_t), intent(in) :: quantity

      is_peak = quantity%found == 'peak' .and. index(quantity%outputs, 'run') > 0 &
         .and. index(quantity%key, '_height_m') == 0
   end function is_peak

   !> Number of the sensitivity of a quantity.
   elemental integer function sensitivity_id(number)
      integer, intent(in) :: number
      !! one of `id`

      sensitivity_id = number + size(all_quantities)
   end function sensitivity_id

   !> Row of the sensitivity of a peak.
   elemental type(quantity_t) function sensitivity_row(peak) result(row)
      type(quantity_t), intent(in) :: peak

      row = quantity_t(sensitivity_id(peak%id), prefix//trim(peak%key), '1', 'error', &
         'run ordinate', peak%group, peak%observed, '`conditioning` of `&output`; a motion', &
         'relative change of this peak per relative change of the motion', &
         name=prefix//name_of(peak))
   end function sensitivity_row

   !> Key of the peak of a sensitivity; any other key is unchanged.
   elemental function own_key(key) result(own)
      character(*), intent(in) :: key
      !! key of a quantity
      character(len(key)) :: own

      own = key
      if (index(key, prefix) == 1) own = key(len(prefix) + 1:)
   end function own_key

   !> Key of `&output` that requests a quantity; '' for one that every run reports.
   elemental character(12) function requested_by(quantity)
      type(quantity_t), intent(in) :: quantity

      requested_by = ''
      if (any(quantity%observed == [character(12) :: of_reactions, of_demands, of_envelopes])) then
         requested_by = 'reactions'
      else if (quantity%observed == of_energy) then
         requested_by = 'energy'
      end if
   end function requested_by

end module rwmf_problem_quantity_table
