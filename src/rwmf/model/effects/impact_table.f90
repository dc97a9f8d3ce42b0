!> Velocity factor at impact from a table over the velocity, `&impact rule = 'table'`.
module rwmf_model_effects_impact_table
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_list, group_values_t, has_key, text_of
   use rwmf_problem_key, only: not_negative, optional_key
   use rwmf_problem_rules, only: fail_group, fail_key
   implicit none
   private

   public :: impact_table_group

   character(15), parameter :: table_keys(2) = [character(15) :: 'table_theta_dot', 'table_e']

contains

   !> Keys that the rule 'table' adds to the group `&impact`.
   type(case_group_t) function impact_table_group() result(group)
      group%name = 'impact'
      group%after = 'impact'
      group%keys = [ &
         optional_key('impact', 'table_theta_dot', 'real list', 'rad/s', '', not_negative, &
            'angular velocities before impact, increasing; required for rule table', &
            'rule=table'), &
         optional_key('impact', 'table_e', 'real list', '-', '', '[0, 1]', &
            'e at them: linear between, constant beyond; required for rule table', 'rule=table')]
      group%check => check_impact_table
      group%fill => fill_impact_table
      group%is_present => has_impact_table
      group%no_element = "&impact rule = 'table': the host applies the velocity factor, and can " &
         //"look it up"
   end function impact_table_group

   !> Check that both columns have equal length and increasing velocities; other rules have none.
   subroutine check_impact_table(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: theta_dot(:)
      real(wp), allocatable :: e(:)
      character(8) :: rule
      integer :: i

      rule = text_of(values, 'impact', 'rule')
      do i = 1, size(table_keys)
         if (has_key(values, 'impact', trim(table_keys(i))) .eqv. rule == 'table') cycle
         if (rule == 'table') then
            call fail_group(values, 'impact', 'the key '//trim(table_keys(i))//' is missing: ' &
               //"must be given with rule = 'table'", error)
         else
            call fail_key(values, 'impact', trim(table_keys(i)), "must not be given with " &
               //"rule = '"//trim(rule)//"', which sets it", error)
         end if
         return
      end do
      if (rule /= 'table') return
      call get_list(values, 'impact', 'table_theta_dot', theta_dot)
      call get_list(values, 'impact', 'table_e', e)
      if (size(theta_dot) /= size(e)) then
         call fail_key(values, 'impact', 'table_e', 'must have as many values as table_theta_dot', &
            error)
      else if (any(theta_dot(2:) <= theta_dot(:size(theta_dot) - 1))) then
         call fail_key(values, 'impact', 'table_theta_dot', 'must increase strictly', error)
      end if
   end subroutine check_impact_table

   subroutine fill_impact_table(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      call get_list(case%values, 'impact', 'table_theta_dot', case%impact%table_theta_dot)
      call get_list(case%values, 'impact', 'table_e', case%impact%table_e)
   end subroutine fill_impact_table

   pure logical function has_impact_table(case)
      type(case_t), intent(in) :: case

      has_impact_table = case%impact%rule == 'table'
   end function has_impact_table

end module rwmf_model_effects_impact_table
