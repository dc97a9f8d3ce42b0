!> Cost for a host beyond the integration: time of a call, leaks, threads.
!>
!>    stepping_cost cycles N     create, advance and destroy N walls (for valgrind, or to inspect
!>                               the memory afterwards)
!>    stepping_cost threads N    make N short runs in eight threads; all have the same bits
!>    stepping_cost call         microseconds per call above one call for the whole motion
program stepping_cost
   use rwmf, only: advance_stepping, case_t, create_stepping, destroy_stepping, error_t, i8, &
      query_state, read_case_text, stepping_t, wall_state_t, wp
   implicit none
   character(*), parameter :: methods(4) = [character(6) :: 'adams', 'bdf', 'taylor', 'dop853']
   character(16) :: what
   integer :: n
   integer :: status

   call get_command_argument(1, what)
   n = argument(2)
   select case (what)
   case ('cycles')
      call run_cycles(n)
   case ('threads')
      call run_threads(n)
   case default
      call time_calls()
   end select

contains

   integer function argument(i)
      integer, intent(in) :: i
      character(16) :: text

      call get_command_argument(i, text)
      read (text, *, iostat=status) argument
      if (status /= 0) argument = 100
   end function argument

   function scene(method) result(case)
      character(*), intent(in) :: method
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text("&wall h = 2.0, b = 0.5 /"//new_line('a')// &
         "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
         "&impact rule = 'constant', e = 0.9 /"//new_line('a')// &
         "&model formulation = 'symmetric' /"//new_line('a')// &
         "&solver t_end = 4.0, method = '"//trim(method)//"' /", '', case, error)
      if (allocated(error)) error stop 'the scene is bad'
   end function scene

   !> Make a short run and return the rotation at its end [rad].
   real(wp) function short_run(case) result(theta)
      type(case_t), intent(in) :: case
      type(stepping_t) :: wall
      type(wall_state_t) :: state
      type(error_t), allocatable :: error

      call create_stepping(wall, case, error)
      if (.not. allocated(error)) call advance_stepping(wall, [0.0_wp, 0.02_wp, 0.04_wp], &
         [3.0_wp, 4.0_wp, 3.5_wp], error)
      if (.not. allocated(error)) call query_state(wall, state, error)
      if (allocated(error)) error stop 'a run failed'
      theta = state%theta
      call destroy_stepping(wall)
   end function short_run

   subroutine run_cycles(n)
      integer, intent(in) :: n
      type(case_t) :: cases(size(methods))
      real(wp) :: theta
      integer :: i

      do i = 1, size(methods)
         cases(i) = scene(methods(i))
      end do
      theta = 0
      do i = 1, n
         theta = theta + short_run(cases(1 + mod(i, size(methods))))
      end do
      if (abs(theta) <= 0) error stop 'nothing moved'
      print '(i0, a)', n, ' walls created and destroyed'
   end subroutine run_cycles

   subroutine run_threads(n)
      integer, intent(in) :: n
      type(case_t) :: case
      real(wp) :: first
      integer :: different
      integer :: i

      case = scene('adams')
      first = short_run(case)
      different = 0
      !$omp parallel do num_threads(8) schedule(dynamic, 16) reduction(+:different)
      do i = 1, n
         if (abs(short_run(case) - first) > 0) different = different + 1
      end do
      !$omp end parallel do
      print '(i0, a, i0)', n, ' runs in eight threads, different: ', different
      if (different > 0) error stop 1
   end subroutine run_threads

   !> Measure the time of a call. A wall at rest under a weak motion has no integration, so the time
   !> is that of the calls. A rocking wall takes the same steps both ways if the knots are equal.
   subroutine time_calls()
      integer, parameter :: n = 20001
      real(wp), allocatable :: t(:)
      real(wp), allocatable :: a(:)
      real(wp) :: whole
      real(wp) :: pieces
      integer :: i
      integer :: j
      integer :: pass

      allocate (t(n), a(n))
      do pass = 1, 2
         do i = 1, n
            t(i) = (i - 1)*1.0e-3_wp
            a(i) = merge(0.1_wp, 2.5_wp, pass == 1)*sin(6*t(i))
         end do
         do j = 1, 5, 3
            whole = seconds(t, a, n - 1, methods(j))
            pieces = seconds(t, a, 1, methods(j))
            print '(2a, f7.3, a, f7.3, a)', merge('at rest, ', 'rocking, ', pass == 1), &
               methods(j), &
               1.0e6_wp*whole/(n - 1), ' us per step,', 1.0e6_wp*(pieces - whole)/(n - 1), &
               ' us more as a separate call'
         end do
      end do
   end subroutine time_calls

   real(wp) function seconds(t, a, length, method)
      real(wp), intent(in) :: t(:)
      real(wp), intent(in) :: a(:)
      integer, intent(in) :: length
      !! intervals in a call
      character(*), intent(in) :: method
      type(stepping_t) :: wall
      type(error_t), allocatable :: error
      integer(i8) :: begin
      integer(i8) :: end
      integer(i8) :: rate
      integer :: pass
      integer :: k

      ! the least of several times: other programs can only increase a time
      seconds = huge(seconds)
      do pass = 1, 9
         call create_stepping(wall, scene(method), error)
         call system_clock(begin, rate)
         do k = 1, size(t) - 1, length
            call advance_stepping(wall, t(k:k + length), a(k:k + length), error)
            if (allocated(error)) error stop 'a call failed'
         end do
         call system_clock(end)
         seconds = min(seconds, real(end - begin, wp)/real(rate, wp))
         call destroy_stepping(wall)
      end do
   end function seconds

end program stepping_cost
