!> Group `&limits`: the user's limits of demands. Its keys are those of the table of quantities.
!>
!> A limit requests its demand as `&spectrum quantities` or `&output reactions` do. Python compares
!> the two (`rwmf.checks`).
module rwmf_input_groups_limits
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_values, only: numbered
   use rwmf_model_system_demands, only: floor_count, lowest_link
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: applies, get_list, group_values_t, has_group, has_key, &
      logical_of
   use rwmf_problem_key, only: optional_key, positive
   use rwmf_problem_quantity_table, only: all_quantities, is_of_ordinate, is_peak, key_length, &
      of_energy, of_demands, of_envelopes, of_reactions, quantity_t
   use rwmf_problem_rules, only: fail_key
   use rwmf_problem_units, only: unit_of
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: limits_group

   character(*), parameter :: name = 'limits'
   !! name of the group

contains

   !> Group `&limits` with its keys and hooks.
   type(case_group_t) function limits_group() result(group)
      integer, allocatable :: rows(:)
      integer :: i
      character(104) :: text
      integer :: braces

      group%name = name
      group%is_of_scene = .false.
      rows = pack([(i, i=1, size(all_quantities))], is_limited(all_quantities))
      allocate (group%keys(size(rows)))
      do i = 1, size(rows)
         associate (quantity => all_quantities(rows(i)))
            ! meaning of the limit
            text = quantity%meaning
            braces = index(text, ' {i}')
            if (braces > 0) text = text(:braces - 1)//text(braces + 4:)
            if (braces > 0) text = trim(text)//': one for all, or one each'
            group%keys(i) = optional_key(name, trim(limit_key(quantity)), trim(merge('real list', &
               'real     ', has_levels(quantity))), trim(merge('-     ', quantity%unit(:6), &
               quantity%unit == '1')), '', positive, trim(text))
         end associate
      end do
      group%check => check_limits
      group%fill => fill_limits
   end function limits_group

   !> True for a quantity of every floor or storey.
   elemental logical function has_levels(quantity)
      type(quantity_t), intent(in) :: quantity

      has_levels = index(quantity%key, '{i}') > 0
   end function has_levels

   !> Check that the demands of all limits can exist, and the number of values of the lists.
   subroutine check_limits(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (.not. has_group(values, name)) return
      do i = 1, size(all_quantities)
         if (.not. is_limited(all_quantities(i))) cycle
         if (.not. has_key(values, name, trim(limit_key(all_quantities(i))))) cycle
         call check_limit(values, all_quantities(i), error)
         if (allocated(error)) return
      end do
   end subroutine check_limits

   !> Check one limit against groups and masses of the case.
   subroutine check_limit(values, quantity, error)
      type(group_values_t), intent(in) :: values
      type(quantity_t), intent(in) :: quantity
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: key, lacking

      key = trim(limit_key(quantity))
      lacking = ''
      if (quantity%group /= '') then
         if (.not. has_group(values, trim(quantity%group))) lacking = '&'//trim(quantity%group)
      end if
      if (lacking == '') call find_lacking(values, quantity, lacking)
      if (lacking == '' .and. quantity%ratio > 0 .and. unit_of(values, 'N') <= 0) then
         lacking = 'the mass of the wall, or of the frame without a wall,'
      end if
      if (lacking /= '') then
         call fail_key(values, name, key, 'needs '//lacking//' to have this demand', error)
      end if
   end subroutine check_limit

   !> Find the first requirement of a quantity that a case does not meet; '' if it meets all.
   subroutine find_lacking(values, quantity, lacking)
      type(group_values_t), intent(in) :: values
      type(quantity_t), intent(in) :: quantity
      character(:), allocatable, intent(out) :: lacking
      integer :: first, last, i

      first = 1
      do while (first <= len_trim(quantity%needs))
         last = index(quantity%needs(first:)//';', ';') + first - 2
         lacking = ''
         associate (need => quantity%needs(first:last))
            if (.not. is_met(values, trim(quantity%group), need)) then
               do i = 1, len(need)
                  if (need(i:i) /= '`') lacking = lacking//need(i:i)
               end do
               if (index(need, '&') == 0) lacking = trim(lacking)//' of &'//trim(quantity%group)
               lacking = trim(adjustl(lacking))
               return
            end if
         end associate
         first = last + 2
      end do
      lacking = ''
   end subroutine find_lacking

   !> True if a case has one of the groups and keys in backticks, or with 'no ' none of them. Other
   !> requirements count as met.
   pure logical function is_met(values, group, need)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! group of keys without another one
      character(*), intent(in) :: need
      !! such as '`strands` or `rupture_strain`'
      integer :: first, length
      logical :: is_named
      logical :: is_given

      first = 1
      is_met = .false.
      is_named = .false.
      do while (index(need(first:), '`') > 0)
         first = first + index(need(first:), '`')
         length = index(need(first:), '`') - 1
         associate (word => need(first:first + length - 1))
            is_named = .true.
            ! the case has a group, or a key that is not .false.
            if (word(:1) == '&') then
               is_given = applies(values, word(2:))
            else if (word == 'h_f') then
               is_given = has_key(values, 'p_delta', word)
            else
               is_given = has_key(values, group, word)
               if (word == 'shear_key') is_given = logical_of(values, group, word)
            end if
            is_met = is_met .or. is_given
         end associate
         first = first + length + 1
      end do
      if (index(adjustl(need), 'no ') == 1) is_met = .not. is_met
      is_met = is_met .or. .not. is_named
   end function is_met

   !> Request the demands of the limits.
   subroutine fill_limits(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      type(quantity_t), allocatable :: given(:)
      integer :: i
      real(wp), allocatable :: limits(:)
      integer :: j, first

      allocate (given(0))
      do i = 1, size(all_quantities)
         if (.not. is_limited(all_quantities(i))) cycle
         if (has_key(case%values, name, trim(limit_key(all_quantities(i))))) given = [given, &
            all_quantities(i)]
      end do
      if (size(given) == 0) return
      associate (output => case%output)
         do i = 1, size(given)
            output%reactions = output%reactions .or. given(i)%observed == of_reactions
            output%demands = output%demands .or. given(i)%observed == of_demands
            output%envelopes = output%envelopes .or. given(i)%observed == of_envelopes
         end do
      end associate
      do i = 1, size(given)
         ! check that a list has one value, or one for each floor or storey
         if (has_levels(given(i))) then
            call get_list(case%values, name, trim(limit_key(given(i))), limits)
            if (size(limits) /= 1 .and. size(limits) /= floor_count(case)) call fail_key( &
               case%values, name, trim(limit_key(given(i))), &
               'must have one value, or one for each of '//trim(integer_to_text(floor_count( &
               case)))//' from the ground up', error)
         end if
         if (allocated(error)) return
      end do
      ! list the keys of the limited demands, those of floors and storeys with their numbers
      allocate (case%output%limited(0))
      do i = 1, size(given)
         if (.not. has_levels(given(i))) then
            case%output%limited = [case%output%limited, given(i)%key]
            cycle
         end if
         first = 1
         if (index(given(i)%key, 'link_') == 1) first = lowest_link(case)
         case%output%limited = [case%output%limited, (numbered(given(i)%key, j), j=first, &
            floor_count(case))]
      end do
   end subroutine fill_limits

   !> True if `&limits` can have a limit of the quantity: peaks and final values.
   elemental logical function is_limited(quantity)
      type(quantity_t), intent(in) :: quantity

      is_limited = .false.
      if (.not. is_of_ordinate(quantity) .or. quantity%kind /= 'real') return
      if (quantity%found == 'end') then
         is_limited = index(quantity%outputs, 'run') > 0 .and. quantity%observed /= of_energy
      else if (is_peak(quantity)) then
         is_limited = index(quantity%key, '_normal_min') + index(quantity%key, &
            '_stroke_min') + index(quantity%key, '_force_min') == 0
      end if
   end function is_limited

   !> Key of `&limits` for a quantity; a list over floors or storeys is a plural.
   elemental character(key_length) function limit_key(quantity) result(key)
      type(quantity_t), intent(in) :: quantity
      integer :: braces

      key = quantity%key
      braces = index(key, '_{i}')
      if (braces > 0) key = key(:braces - 1)//'s'//key(braces + 4:)
   end function limit_key

end module rwmf_input_groups_limits
