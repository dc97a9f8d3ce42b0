!> Kernel in quadruple precision as a flat procedure for f2py, in the extension `rwmf._reference`.
!> It is the reference for the errors of all methods.
!>
!> It is compiled from the kernel's own sources with `RWMF_QUAD`. A separate library shares nothing
!> with the double-precision kernel in a process. The numbers of the case are read in double
!> precision.
module rwmf_bindings_python_reference
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t
   use rwmf_bindings_python_handles, only: add_source, make_control, put_error
   use rwmf_bindings_python_timed_run, only: empty_measured, halve_intervals, measure_method, &
      put_measured, timed_run_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_problem_case, only: case_t
   implicit none
   public

contains

   !> Run a case at two tolerances, the second time with the intervals of a record halved as well.
   !> Return the results of the second run and their differences from the first. The differences
   !> bound the error, because it decreases with tolerance and interval.
   !>
   !> `counts` is (steps, right-hand sides, impacts, overturned).
   !> `control` is (finished runs, cancel).
   subroutine solve(text, source, rtol_loose, rtol, control, values, differences, seconds, &
      counts, impact_times, status, message, message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      real(c_double), intent(in) :: rtol_loose
      real(c_double), intent(in) :: rtol
      integer(c_int64_t), intent(inout), target :: control(2)
      real(c_double), intent(inout) :: values(:)
      real(c_double), intent(inout) :: differences(:)
      real(c_double), intent(out) :: seconds
      integer(c_int64_t), intent(out) :: counts(4)
      real(c_double), intent(inout) :: impact_times(:)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      ! f2py declares the C types of int8 and int64 only when they are written this way
      !f2py integer*1 :: message
      !f2py integer*8 :: control
      integer(c_int), intent(out) :: message_length
      character(*), parameter :: method = 'taylor'
      real(wp), parameter :: once = 0
      type(case_t) :: case
      type(timed_run_t) :: loose
      type(timed_run_t) :: tight
      type(error_t), allocatable :: error
      integer :: n
      !f2py threadsafe

      loose = empty_measured()
      tight = empty_measured()
      call read_case_text(text, source(:index(source, '/', back=.true.)), case, error)
      call add_source(source, error)
      if (.not. allocated(error)) then
         call measure_method(case, method, real(rtol_loose, wp), once, &
            make_control(control), loose, error)
         control(1) = control(1) + 1_c_int64_t
      end if
      if (.not. allocated(error)) then
         if (allocated(case%record)) call halve_intervals(case%record)
         if (allocated(case%upward_record)) call halve_intervals(case%upward_record)
         call measure_method(case, method, real(rtol, wp), once, &
            make_control(control), tight, error)
         control(1) = control(1) + 1_c_int64_t
      end if
      seconds = real(loose%seconds + tight%seconds, c_double)
      call put_measured(tight, values, counts, impact_times)
      n = min(size(differences), size(tight%values))
      differences(:n) = real(abs(tight%values(:n) - loose%values(:n)), c_double)
      call put_error(error, status, message, message_length)
   end subroutine solve

end module rwmf_bindings_python_reference
