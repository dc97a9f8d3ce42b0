!> Warnings about values outside the range of real buildings, mostly unit mistakes.
module rwmf_problem_usual_ranges
   use rwmf_core_kinds, only: wp
   use rwmf_problem_group_values, only: group_values_t, has_group, key_place, key_values_t
   use rwmf_text_strings, only: real_to_text, rounded_text
   implicit none
   private

   public :: list_unusual, unusual_text, unusual_record

   !> Unit that the user may have meant instead of that of the key.
   type :: slip_t
      character(6) :: unit
      !! unit of the key
      character(6) :: meant
      real(wp) :: factor
      !! factor from the unit meant to that of the key
   end type slip_t

   type(slip_t), parameter :: slips(*) = [ &
      slip_t('Pa', 'MPa', 1.0e6_wp), slip_t('Pa', 'GPa', 1.0e9_wp), &
      slip_t('Pa', 'ksi', 6.894757e6_wp), slip_t('m', 'mm', 1.0e-3_wp), &
      slip_t('m', 'cm', 1.0e-2_wp), slip_t('m', 'ft', 0.3048_wp), slip_t('m', 'in', 0.0254_wp), &
      slip_t('m2', 'mm2', 1.0e-6_wp), slip_t('m2', 'cm2', 1.0e-4_wp), &
      slip_t('m2', 'in2', 6.4516e-4_wp), slip_t('kg', 't', 1.0e3_wp), &
      slip_t('kg', 'g', 1.0e-3_wp), slip_t('N', 'kN', 1.0e3_wp), slip_t('N', 'MN', 1.0e6_wp), &
      slip_t('N/m', 'kN/m', 1.0e3_wp), slip_t('N/m', 'kN/mm', 1.0e6_wp), &
      slip_t('N s/m', 'kN s/m', 1.0e3_wp), slip_t('kg/m3', 't/m3', 1.0e3_wp), &
      slip_t('-', '%', 1.0e-2_wp), slip_t('s', 'ms', 1.0e-3_wp), &
      slip_t('m/s', 'cm/s', 1.0e-2_wp), slip_t('m/s', 'mm/s', 1.0e-3_wp), &
      slip_t('m/s2', 'cm/s2', 1.0e-2_wp)]

contains

   !> List one line for each key with a value outside its range. Zero disables an effect and is
   !> always allowed. Derived values are listed only if all given values are usual.
   pure subroutine list_unusual(values, lines)
      type(group_values_t), intent(in) :: values
      character(256), allocatable, intent(out) :: lines(:)
      !! (keys outside their ranges)
      type(key_values_t) :: row
      real(wp) :: number
      integer :: i, k, pass

      allocate (lines(0))
      if (.not. allocated(values%keys)) return
      do pass = 1, 2
         if (size(lines) > 0) return
         do i = 1, size(values%keys)
            row = values%keys(i)
            if (row%n == 0 .or. .not. has_group(values, trim(row%group))) cycle
            if (is_over_any_mass(values, row) .or. (row%source > 0 .neqv. pass == 2)) cycle
            do k = row%first, row%first + row%n - 1
               number = real(values%numbers(k), wp)
               if (is_usual(row, number)) cycle
               lines = [character(256) :: lines, unusual_text(values, row%group, row%key, number)]
               exit
            end do
         end do
      end do
   end subroutine list_unusual

   !> Warning about a number of a key; '' if it is within the range.
   pure character(256) function unusual_text(values, group, key, number) result(text)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      real(wp), intent(in) :: number
      !! [unit of the key]
      character(25) :: shown_number
      integer :: i, place

      text = ''
      place = key_place(values, group, key)
      if (place == 0) return
      associate (row => values%keys(place))
         if (is_usual(row, number)) return
         ! a given number as the file has it, a derived one rounded
         shown_number = merge(rounded_text(number), real_to_text(number), row%source > 0)
         text = '&'//trim(row%group)//' '//trim(row%key)//' = ' &
            //trim(with_unit(shown_number, row%unit)) &
            //' is outside the range of real buildings, '//trim(real_to_text(row%usual(1))) &
            //' to '//with_unit(real_to_text(row%usual(2)), row%unit)
         do i = 1, size(slips)
            if (slips(i)%unit /= row%unit .or. .not. is_usual(row, number*slips(i)%factor)) cycle
            text = trim(text)//': '//trim(shown_number)//' '//trim(slips(i)%meant) &
               //' would be ' &
               //with_unit(rounded_text(number*slips(i)%factor), row%unit)
            return
         end do
      end associate
   end function unusual_text

   !> Warning about a record that is no earthquake in these units; '' for a usual one.
   pure character(256) function unusual_record(peak, interval, duration) result(text)
      real(wp), intent(in) :: peak
      !! largest acceleration over g [-]
      real(wp), intent(in) :: interval
      !! mean distance of the samples [s]
      real(wp), intent(in) :: duration
      !! [s]
      real(wp), parameter :: usual_peak(2) = [1.0e-5_wp, 5.0_wp]
      real(wp), parameter :: longest_interval = 0.1_wp
      real(wp), parameter :: longest_duration = 3600
      real(wp), parameter :: round_off = 1.0e-9_wp

      text = ''
      if (peak < usual_peak(1) .or. peak > usual_peak(2)) then
         text = 'peak of '//trim(rounded_text(peak))//' g is outside the range of records, ' &
            //trim(real_to_text(usual_peak(1)))//' to '//trim(real_to_text(usual_peak(2))) &
            //' g: check the unit'
      end if
      if (interval > longest_interval*(1 + round_off)) text = joined(text, 'interval of ' &
         //trim(rounded_text(interval))//' s exceeds '//trim(real_to_text(longest_interval)) &
         //' s: check dt')
      if (duration > longest_duration*(1 + round_off)) text = joined(text, 'duration of ' &
         //trim(rounded_text(duration))//' s exceeds '//trim(real_to_text(longest_duration)) &
         //' s: check dt')
   end function unusual_record

   !> Join two texts by a semicolon.
   pure character(256) function joined(first, second)
      character(*), intent(in) :: first
      !! may be empty
      character(*), intent(in) :: second

      joined = second
      if (first /= '') joined = trim(first)//'; '//second
   end function joined

   !> Number with its unit.
   pure character(48) function with_unit(number, unit) result(text)
      character(*), intent(in) :: number
      character(*), intent(in) :: unit
      !! '-' for a ratio

      text = number
      if (unit /= '-' .and. unit /= '') text = trim(text)//' '//unit
   end function with_unit

   !> True if a number is zero or its magnitude lies within the range of a key.
   pure logical function is_usual(row, number)
      type(key_values_t), intent(in) :: row
      real(wp), intent(in) :: number

      is_usual = abs(number) <= 0 .or. (abs(number) >= row%usual(1) .and. abs(number) <= &
         row%usual(2))
   end function is_usual

   !> True for ratios to the mass of a wall that is absent: their reference mass is arbitrary.
   pure logical function is_over_any_mass(values, row)
      type(group_values_t), intent(in) :: values
      type(key_values_t), intent(in) :: row

      is_over_any_mass = index(row%key, '_over_m_w') > 0 .and. .not. has_group(values, 'wall')
   end function is_over_any_mass

end module rwmf_problem_usual_ranges
