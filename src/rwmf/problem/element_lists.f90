!> Lists of the groups of vertical elements: `offset` sets the number of elements, and every other
!> key has one number for all or one for each.
module rwmf_problem_element_lists
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_group_values, only: get_list, group_values_t, has_key, real_of, text_of
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: number_of_elements, check_lists, check_offsets, get_each, check_base

contains

   !> Number of elements of a group: of its offsets, else one tendon, coupling, or two devices.
   pure integer function number_of_elements(values, group) result(n)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      real(wp), allocatable :: offset(:)

      n = 2
      if (group == 'cable' .or. group == 'coupling') n = 1
      call get_list(values, group, 'offset', offset)
      if (allocated(offset)) n = size(offset)
   end function number_of_elements

   !> Check that each key has one number, or one for each element.
   subroutine check_lists(values, group, keys, n, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: keys(:)
      !! keys, given or not
      integer, intent(in) :: n
      !! number of elements
      type(error_t), allocatable, intent(out) :: error
      !! names the key and the allowed numbers
      real(wp), allocatable :: list(:)
      integer :: i

      do i = 1, size(keys)
         call get_list(values, group, trim(keys(i)), list)
         if (.not. allocated(list)) cycle
         if (size(list) == 1 .or. size(list) == n) cycle
         if (n == 1) then
            call fail_key(values, group, trim(keys(i)), 'must be one number', error)
         else
            call fail_key(values, group, trim(keys(i)), 'has '//trim(integer_to_text(size(list))) &
               //' numbers: must be one, or one for each of the '//trim(integer_to_text(n)) &
               //' elements', error)
         end if
         return
      end do
   end subroutine check_lists

   !> Check the offsets of a group: their range, and that formulation and base allow them.
   subroutine check_offsets(values, group, most, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      real(wp), intent(in) :: most
      !! largest |offset| over b [-]
      type(error_t), allocatable, intent(out) :: error
      !! names the key and the allowed range
      real(wp), allocatable :: offset(:), b(:)

      if (.not. has_key(values, group, 'offset')) return
      call check_base(values, group, error)
      if (allocated(error)) return
      call get_list(values, group, 'offset', offset)
      call get_list(values, 'spectrum', 'b', b)
      if (.not. allocated(b)) b = [real_of(values, 'wall', 'b')]
      if (maxval(abs(offset)) > most*minval(b)) call fail_key(values, group, 'offset', &
         'must be in ['//trim(real_to_text(-most))//' b, '//trim(real_to_text(most))//' b] = [' &
         //trim(real_to_text(-most*minval(b)))//', '//trim(real_to_text(most*minval(b)))//'] [m]', &
         error)
   end subroutine check_offsets

   !> Refuse elements at any place beside `published` and on a hinged wall.
   subroutine check_base(values, group, error)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: place

      place = ''
      if (has_key(values, group, 'offset')) place = 'offset '
      if (text_of(values, 'model', 'formulation') == 'published') then
         call fail_group(values, group, place//"must not be given with &model formulation = " &
            //"'published'; 'symmetric' and 'exact' allow it", error)
      else if (text_of(values, 'wall', 'base') == 'pinned') then
         call fail_group(values, group, place//"must not be given with &wall base = 'pinned': " &
            //'the arms are those of a wall that rocks', error)
      end if
   end subroutine check_base

   !> Get the numbers of a key, one for each element; not allocated if the key has none.
   pure subroutine get_each(values, group, key, list)
      type(group_values_t), intent(in) :: values
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! key of the group
      real(wp), allocatable, intent(out) :: list(:)
      !! (elements) [unit of the key]

      call get_list(values, group, key, list)
      if (.not. allocated(list)) return
      if (size(list) == 1) list = spread(list(1), 1, number_of_elements(values, group))
   end subroutine get_each

end module rwmf_problem_element_lists
