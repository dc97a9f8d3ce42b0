!> Measurements of methods and of fixed steps as flat procedures for f2py, in the extension
!> `rwmf._kernel` beside `rwmf_bindings_python_kernel`, whose conventions they follow.
module rwmf_bindings_python_cost
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t
   use rwmf_bindings_python_fixed_steps, only: run_fixed_steps, usual_interval
   use rwmf_bindings_python_handles, only: complete_case, find, kept_t, make_control, &
      put_error, put_text
   use rwmf_bindings_python_timed_run, only: measure_method, names_of_values => value_names, &
      put_measured, timed_run_t
   use rwmf_core_error, only: error_t
   use rwmf_problem_case, only: case_t
   implicit none
   public

contains

   !> Names of the values of a measurement, one per line.
   subroutine value_names(buffer, length)
      integer(c_int8_t), intent(inout) :: buffer(:)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: buffer
      integer(c_int), intent(out) :: length

      call put_text(names_of_values, buffer, length)
   end subroutine value_names

   !> Run a case with a method and tolerance repeatedly until the budget [s] is spent.
   !>
   !> `counts` is (steps, right-hand sides, impacts, overturned). Impact times beyond the
   !> size of their array are dropped.
   subroutine measure(handle, method, rtol, budget, control, values, seconds, counts, &
      impact_times, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: method
      real(c_double), intent(in) :: rtol
      real(c_double), intent(in) :: budget
      integer(c_int64_t), intent(inout), target :: control(2)
      real(c_double), intent(inout) :: values(:)
      real(c_double), intent(out) :: seconds
      integer(c_int64_t), intent(out) :: counts(4)
      real(c_double), intent(inout) :: impact_times(:)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(case_t) :: case
      type(timed_run_t) :: measured
      type(error_t), allocatable :: error
      !f2py threadsafe

      kept => find(handle)
      call complete_case(kept, case)
      call measure_method(case, method, rtol, budget, make_control(control), measured, error)
      seconds = measured%seconds
      call put_measured(measured, values, counts, impact_times)
      call put_error(error, status, message, message_length)
   end subroutine measure

   !> Run a case with fixed steps: by Newmark's method if `is_newmark` is not 0, otherwise by Runge
   !> and Kutta's. The step is the usual interval of the case over a divisor; `dt` returns it [s].
   !> The other arguments are as in `measure`.
   subroutine measure_fixed_steps(handle, is_newmark, divisor, budget, values, seconds, dt, &
      counts, impact_times, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: is_newmark
      real(c_double), intent(in) :: divisor
      real(c_double), intent(in) :: budget
      real(c_double), intent(inout) :: values(:)
      real(c_double), intent(out) :: seconds
      real(c_double), intent(out) :: dt
      integer(c_int64_t), intent(out) :: counts(4)
      real(c_double), intent(inout) :: impact_times(:)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(case_t) :: case
      type(timed_run_t) :: measured
      integer, parameter :: most_repeats = 1000
      real(c_double) :: fastest, spent
      integer :: repeats
      type(error_t), allocatable :: error
      !f2py threadsafe

      kept => find(handle)
      call complete_case(kept, case)
      dt = usual_interval(case)/divisor
      fastest = huge(fastest)
      spent = 0
      do repeats = 1, most_repeats
         call run_fixed_steps(case, is_newmark /= 0, dt, measured, error)
         fastest = min(fastest, measured%seconds)
         spent = spent + measured%seconds
         if (allocated(error) .or. spent >= budget) exit
      end do
      seconds = fastest
      call put_measured(measured, values, counts, impact_times)
      call put_error(error, status, message, message_length)
   end subroutine measure_fixed_steps

end module rwmf_bindings_python_cost
