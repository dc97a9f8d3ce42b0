!> Description of a validated case as a table of given, default and derived values.
module rwmf_input_describe
   use rwmf_core_kinds, only: wp
   use rwmf_input_schema, only: all_keys
   use rwmf_problem_case, only: case_t
   use rwmf_problem_group_values, only: applies, as_given, group_values_t, has_group, has_key, &
      key_values_t, text_of, value_text
   use rwmf_problem_key, only: belongs_to, key_t
   use rwmf_problem_units, only: unit_of
   use rwmf_text_strings, only: integer_to_text, real_to_text
   use rwmf_text_text_buffer, only: append, clear, text_buffer_t
   implicit none
   private

   public :: describe_case

   character(*), parameter :: tab = achar(9)

contains

   !> Write one tab-separated line for each key with a value, in the order of the schema.
   !>
   !> The columns are `group.key`, type, value, unit and origin: `given`, `default` or `derived`
   !> (from dimensional keys). For a ratio in a case with a mass, the next columns are the
   !> dimensional value and its unit (kg, N, ...). If the value is derived from the given value of
   !> the same key, as for `n` of `&storeys`, the last column is the given value.
   !>
   !> Absent groups have no lines, except `&model`, `&solver` and `&impact` of a rocking wall. Reals
   !> are written with the digits that read back as the same double precision number, lists with
   !> commas. The table describes the case as read, without later changes of its components.
   subroutine describe_case(case, text)
      type(case_t), intent(in) :: case
      character(:), allocatable, intent(out) :: text
      !! lines, each with its line feed; '' for a case that was not read from text
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: value, in_si, given
      character(7) :: origin
      type(text_buffer_t) :: lines
      integer :: i

      text = ''
      if (.not. allocated(case%values%keys)) return
      keys = all_keys()
      do i = 1, size(keys)
         if (.not. is_in_scene(case%values, keys(i))) cycle
         associate (row => case%values%keys(i))
            call canonical_values(case, row, keys(i), 1.0_wp, value)
            if (value == '') cycle
            origin = merge('given  ', 'default', row%is_given)
            given = ''
            if (row%source > 0) origin = 'derived'
            if (row%source > 0 .and. row%n_given > 0) then
               origin = 'given'
               call canonical_values(case, as_given(row), keys(i), 1.0_wp, given)
            end if
            in_si = ''
            if (keys(i)%si /= '' .and. case%unit_mass > 0) then
               call canonical_values(case, row, keys(i), unit_of(case%values, keys(i)%si), in_si)
               in_si = in_si//tab//trim(keys(i)%si)
            end if
         end associate
         call append(lines, trim(keys(i)%group)//'.'//trim(keys(i)%key)//tab//trim(keys(i)%type) &
            //tab//value//tab//trim(keys(i)%unit)//tab//trim(origin))
         if (in_si == '' .and. given /= '') in_si = tab
         if (in_si /= '') call append(lines, tab//in_si//tab//given)
         call append(lines, new_line('a'))
      end do
      if (lines%length > 0) text = lines%room(:lines%length)
   end subroutine describe_case

   !> True if the key applies to the case.
   pure logical function is_in_scene(values, key)
      type(group_values_t), intent(in) :: values
      type(key_t), intent(in) :: key
      integer :: dot

      is_in_scene = applies(values, trim(key%group))
      if (.not. is_in_scene) return
      if (key%kinds /= '') is_in_scene = belongs_to(key, text_of(values, 'motion', 'kind'))
      if (key%unless == '') return
      dot = index(key%unless, '.')
      if (dot == 0) then
         is_in_scene = .not. has_group(values, trim(key%unless))
      else
         is_in_scene = .not. has_key(values, key%unless(:dot - 1), trim(key%unless(dot + 1:)))
      end if
   end function is_in_scene

   !> Write the values of a key in canonical form, so that equal values give equal texts; '' for
   !> none.
   pure subroutine canonical_values(case, row, key, factor, text)
      type(case_t), intent(in) :: case
      type(key_values_t), intent(in) :: row
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: factor
      !! factor on reals
      character(:), allocatable, intent(out) :: text
      type(text_buffer_t) :: list
      integer :: i

      call clear(list)
      associate (numbers => case%values%numbers)
         do i = row%first, row%first + row%n - 1
            if (i > row%first) call append(list, ', ')
            select case (key%type)
            case ('real', 'reals', 'real list')
               call append(list, trim(real_to_text(factor*real(numbers(i), wp))))
            case ('integer', 'integers')
               call append(list, trim(integer_to_text(nint(numbers(i)))))
            case ('logical')
               call append(list, trim(merge('.true. ', '.false.', numbers(i) > 0)))
            case default
               call append(list, value_text(case%values, i))
            end select
         end do
      end associate
      text = list%room(:list%length)
      ! defaults that depend on the validated case: last sample of the record, height
      if (key%key == 't_end' .and. text == '') text = trim(real_to_text(case%solver%t_end))
      if (key%default == '2h' .and. .not. row%is_given) text = trim(real_to_text(2*case%wall%h))
   end subroutine canonical_values

end module rwmf_input_describe
