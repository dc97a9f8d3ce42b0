!> Checks that all delivered results are finite.
module rwmf_simulation_finite_check
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_problem_quantity_values, only: numbered
   use rwmf_problem_quantity_table, only: id, key_of
   use rwmf_simulation_state_result, only: result_t
   implicit none
   private

   public :: check_numbers, check_result, is_finite, may_report

contains

   !> Return whether a number is neither infinite nor NaN.
   elemental logical function is_finite(number)
      real(wp), intent(in) :: number
      !! in any unit

      is_finite = abs(number) <= huge(number)
   end function is_finite

   !> Return whether a number may be reported: finite, or an infinite friction demand of a pivot
   !> that lifts.
   elemental logical function may_report(quantity, number)
      integer, intent(in) :: quantity
      !! number of the quantity in the table
      real(wp), intent(in) :: number
      !! value in the unit of the key

      may_report = is_finite(number) .or. (quantity == id%friction_demand_max .and. number > 0)
   end function may_report

   !> Fail with `err_numerical` if one of the numbers is not finite.
   subroutine check_numbers(name, numbers, error)
      character(*), intent(in) :: name
      !! name of the numbers, for the message
      real(wp), intent(in) :: numbers(:)
      !! in any unit
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error) .or. all(is_finite(numbers))) return
      call fail(error, err_numerical, name//' is not a finite number: the motion or a parameter ' &
         //'is beyond what double precision can represent', 'not_finite')
   end subroutine check_numbers

   !> Fail with `err_numerical` if a reported scalar or the final state is not finite.
   subroutine check_result(result, error)
      type(result_t), intent(in) :: result
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (allocated(result%final_state)) call check_numbers('the state at the end', &
         result%final_state, error)
      associate (values => result%values)
         if (all(may_report(values%ids(:values%n), values%numbers(:values%n)))) return
         do i = 1, values%n
            if (.not. may_report(values%ids(i), values%numbers(i))) call check_numbers(trim( &
               numbered(trim(key_of(values%ids(i))), values%levels(i))), values%numbers(i:i), error)
         end do
      end associate
   end subroutine check_result

end module rwmf_simulation_finite_check
