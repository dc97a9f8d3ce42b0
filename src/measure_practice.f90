!> Measurements of what practitioners run today, in the form of those of the methods.
module rwmf_measure_practice
   use rwmf_case, only: case_t
   use rwmf_errors, only: error_t
   use rwmf_kinds, only: wp
   use rwmf_measure, only: at_t_end, at_theta_dot_end, at_theta_end, at_theta_max, at_u_s_max, &
      empty_measured, measured_t
   use rwmf_practice, only: ode45_atol, ode45_rtol, practice_t, run_practice
   implicit none
   private

   public :: repeat_practice

contains

   !> Run one of today's procedures again and again until the budget is spent.
   !>
   !> Errors: those of `run_practice`.
   subroutine repeat_practice(the_case, name, dt, budget, measured, error)
      type(case_t), intent(in) :: the_case
      character(*), intent(in) :: name
      !! 'ode45', 'rk4' or 'newmark'
      real(wp), intent(in) :: dt
      !! [s]
      real(wp), intent(in) :: budget
      !! [s]
      type(measured_t), intent(out) :: measured
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_repeats = 1000
      type(practice_t) :: practice
      real(wp) :: spent

      measured = empty_measured()
      spent = 0
      do while (measured%repeats < most_repeats .and. (measured%repeats < 1 .or. spent < budget))
         call run_practice(the_case, name, dt, ode45_rtol, ode45_atol, practice, error)
         if (allocated(error)) return
         measured%repeats = measured%repeats + 1
         measured%seconds = min(measured%seconds, practice%seconds)
         spent = spent + practice%seconds
      end do
      call take_practice(practice, measured)
   end subroutine repeat_practice

   subroutine take_practice(practice, measured)
      type(practice_t), intent(in) :: practice
      type(measured_t), intent(inout) :: measured

      if (allocated(practice%u_s_max)) measured%values(at_u_s_max) = practice%u_s_max
      if (allocated(practice%theta_max)) measured%values(at_theta_max) = practice%theta_max
      measured%values([at_theta_end, at_theta_dot_end]) = practice%final_state
      measured%values(at_t_end) = practice%t_end
      measured%impact_times = practice%impact_times
      measured%steps = practice%steps
      measured%rhs_evaluations = practice%rhs_evaluations
      measured%overturned = practice%overturned
   end subroutine take_practice

end module rwmf_measure_practice
