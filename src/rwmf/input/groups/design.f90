!> Group `&design`: bounds, cost, suite and targets of the command `rwmf design`.
!>
!> The targets are the limits of `&limits` and the probability of collapse.
module rwmf_input_groups_design
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_list, get_texts, group_values_t, has_group, has_key
   use rwmf_problem_key, only: any_real, below_one, optional_key, positive, required
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: design_group

   character(*), parameter :: name = 'design'
   !! name of the group

contains

   !> Group `&design` with its keys and hooks.
   type(case_group_t) function design_group() result(group)
      group%name = name
      group%is_of_scene = .false.
      group%keys = [ &
         required(name, 'parameters', 'text list', '', 'keys with numbers', &
            'keys that the design chooses'), &
         required(name, 'low', 'real list', '', any_real, 'least value of each parameter'), &
         required(name, 'high', 'real list', '', any_real, 'largest value of each parameter'), &
         required(name, 'cost', 'real list', '', any_real, &
            'cost of a unit of each parameter; the design has the least sum'), &
         optional_key(name, 'percentile', 'real', '%', '', '(0, 100]', &
            'percentile of the suite that meets &limits; 84 without probability'), &
         optional_key(name, 'probability', 'real', '-', '', below_one, &
            'share of the suite that may exceed a limit of &limits; beside no percentile'), &
         optional_key(name, 'collapse_probability', 'real', '-', '', below_one, &
            'share of the suite that may collapse or overturn'), &
         optional_key(name, 'collapse_scale', 'real', '-', '1', positive, &
            'factor on the motions for the collapse, such as 1.5 from design level to MCE'), &
         optional_key(name, 'records', 'text list', '', '', 'files or patterns', &
            'the suite, from the folder of the case; absent: the motion of the case'), &
         optional_key(name, 'left_out', 'text list', '', '', 'files or patterns', &
            'records that judge the design; absent: every fourth of the suite'), &
         optional_key(name, 'unit', 'choice', '', '', 'g m/s2 cm/s2', 'unit of the records'), &
         optional_key(name, 'designs', 'integer', '', '300', '[1, 1000000]', &
            'number of designs of the first stage')]
      group%check => check_design
   end function design_group

   !> Check the lengths of the lists, the bounds, and that there is a target.
   subroutine check_design(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(4), parameter :: lists(3) = ['low ', 'high', 'cost']
      character(:), allocatable :: parameters(:)
      real(wp), allocatable :: numbers(:)
      integer :: i

      if (.not. has_group(values, name)) return
      call get_texts(values, name, 'parameters', parameters)
      do i = 1, size(lists)
         call get_list(values, name, trim(lists(i)), numbers)
         if (size(numbers) == size(parameters)) cycle
         call fail_key(values, name, trim(lists(i)), 'must have one number for each of the ' &
            //trim(integer_to_text(size(parameters)))//' parameters', error)
         return
      end do
      call check_bounds(values, error)
      if (allocated(error)) return
      if (has_key(values, name, 'percentile') .and. has_key(values, name, 'probability')) then
         call fail_key(values, name, 'probability', 'must not be given beside percentile', error)
      else if (.not. (has_group(values, 'limits') &
                      .or. has_key(values, name, 'collapse_probability'))) then
         call fail_group(values, name, 'has no target: must be given with the group &limits, or ' &
            //'with the key collapse_probability', error)
      else if (has_key(values, name, 'left_out') .and. .not. has_key(values, name, 'records')) then
         call fail_key(values, name, 'left_out', 'must not be given without records', error)
      end if
   end subroutine check_design

   !> Check that each lower bound is below its upper bound.
   subroutine check_bounds(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: low(:), high(:)
      integer :: i

      call get_list(values, name, 'low', low)
      call get_list(values, name, 'high', high)
      i = findloc(low < high, .false., 1)
      if (i == 0) return
      call fail_key(values, name, 'low', 'must be below high: number ' &
         //trim(integer_to_text(i))//' is not', error)
   end subroutine check_bounds

end module rwmf_input_groups_design
