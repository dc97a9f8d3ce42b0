!> Group `&sensitivity`: derivatives that `rwmf run` computes beside the results.
!>
!> The kernel checks the keys; the command evaluates them (`rwmf.gradient`).
module rwmf_input_groups_sensitivity
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_key, only: optional_key, required
   implicit none
   private

   public :: sensitivity_group

   character(*), parameter :: name = 'sensitivity'
   !! name of the group

contains

   !> Group `&sensitivity` with its keys.
   type(case_group_t) function sensitivity_group() result(group)
      group%name = name
      group%is_of_scene = .false.
      group%keys = [ &
         required(name, 'parameters', 'text list', '', 'keys with real numbers', &
            'keys by which `rwmf run` and `rwmf gradient` differentiate'), &
         optional_key(name, 'quantities', 'text list', '', '', 'see outputs.md', &
            'results to differentiate; absent: u_s_max_m, of a block theta_max_over_alpha')]
   end function sensitivity_group

end module rwmf_input_groups_sensitivity
