!> Ground motion that the host defines.
module host_sine
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf, only: ground_t, wp
   implicit none
   private

   public :: gap_t, sine_t

   !> Sine that the host defines.
   type, extends(ground_t) :: sine_t
      real(wp) :: amplitude
      !! [m/s2]
      real(wp) :: omega
      !! [rad/s]
   contains
      procedure :: acceleration_at => sine_at
   end type sine_t

   !> Sine that is NaN during an interval.
   type, extends(sine_t) :: gap_t
      real(wp) :: begin
      !! [s]
      real(wp) :: end
      !! [s]
   contains
      procedure :: acceleration_at => gap_at
   end type gap_t

contains

   pure real(wp) function gap_at(self, t) result(acceleration)
      class(gap_t), intent(in) :: self
      real(wp), intent(in) :: t

      acceleration = self%sine_t%acceleration_at(t)
      if (self%begin < t .and. t < self%end) acceleration = ieee_value(t, ieee_quiet_nan)
   end function gap_at

   pure real(wp) function sine_at(self, t) result(acceleration)
      class(sine_t), intent(in) :: self
      real(wp), intent(in) :: t

      acceleration = self%amplitude*sin(self%omega*t)
   end function sine_at

end module host_sine

!> A wall inside the time loop of a host: pieces, rejected steps, threads.
program test_stepping
   use check, only: checks_t
   use host_sine, only: gap_t, sine_t
   use rwmf, only: advance_stepping, case_t, create_stepping, destroy_stepping, err_numerical, &
      error_t, event_impact, event_t, i8, query_events, query_state, result_t, simulate, &
      stepping_t, wall_state_t, wp
   use rwmf_core_kinds, only: pi
   use scenes, only: rwmf_scene
   implicit none

   integer, parameter :: n = 601
   !! samples of the record
   real(wp), parameter :: dt = 0.02_wp
   !! [s]
   character(6), parameter :: methods(4) = [character(6) :: 'adams', 'bdf', 'taylor', 'dop853']
   type(checks_t) :: checks
   integer :: i

   do i = 1, size(methods)
      if (checks%wants('pieces')) call test_pieces(trim(methods(i)), i > 3, 0.0_wp)
      if (checks%wants('pieces')) call test_pieces(trim(methods(i)), i > 3, 0.65_wp)
      if (checks%wants('motion_with_gap')) call test_motion_with_gap(trim(methods(i)), 5.0_wp)
      if (checks%wants('motion_with_gap')) call test_motion_with_gap(trim(methods(i)), 0.1_wp)
   end do
   if (checks%wants('own_motion')) call test_own_motion()
   if (checks%wants('failure_takes_back')) call test_failure_takes_back()
   call checks%finish()

contains

   !> Make a record that causes uplift, then rest, then uplift again.
   pure subroutine make_record(t, a)
      real(wp), intent(out) :: t(n)
      real(wp), intent(out) :: a(n)
      integer :: k

      t = [((k - 1)*dt, k=1, n)]
      a = 5*sin(7*t)*sin(0.8_wp*t) + 1.5_wp*sin(23*t)*sin(0.5_wp*t)
      a(n) = 0
      where (t > 5 .and. t < 7) a = 0
   end subroutine make_record

   !> Case of this record with a fixed tolerance; otherwise `simulate` may run twice.
   function record_scene(method) result(case)
      character(*), intent(in) :: method
      type(case_t) :: case

      case = rwmf_scene('exact', 5.0_wp, 0.8_wp, method)
      case%motion%kind = 'record'
      allocate (case%record)
      allocate (case%record%t(n), case%record%a(n))
      call make_record(case%record%t, case%record%a)
      case%solver%t_end = (n - 1)*dt
      case%solver%atol = 1.0e-11_wp
   end function record_scene

   !> Compare one run with the record advanced in pieces of one to six intervals.
   subroutine test_pieces(method, is_exact, ratio)
      character(*), intent(in) :: method
      logical, intent(in) :: is_exact
      !! to the bit
      real(wp), intent(in) :: ratio
      !! of a vertical motion that follows the horizontal one
      type(case_t) :: case
      type(result_t) :: whole
      type(wall_state_t) :: state
      type(error_t), allocatable :: error
      integer(i8) :: impacts

      case = record_scene(method)
      if (ratio > 0) then
         allocate (case%upward)
         case%upward%ratio = ratio
      end if
      call simulate(case, whole, error)
      call checks%no_error(error, method//': one run')
      if (allocated(error)) return
      call run_in_pieces(case, state, impacts)
      call checks%close_to(state%u_s_max, whole%u_s_max, method//': largest displacement', &
         1.0e-7_wp)
      call checks%that(impacts == state%impacts, method//': the events of the calls add up')
      if (.not. is_exact) return
      call checks%that(same_bits([state%theta, state%theta_dot], whole%final_state), &
         method//': pieces have the bits of one run')
      call checks%that(state%impacts == whole%impacts .and. state%lift_offs == whole%lift_offs &
         .and. state%steps == whole%steps, method//': counts of one run')
   end subroutine test_pieces

   subroutine run_in_pieces(case, state, impacts)
      type(case_t), intent(in) :: case
      type(wall_state_t), intent(out) :: state
      integer(i8), intent(out) :: impacts
      !! sum over the events of the calls
      type(stepping_t) :: wall
      type(event_t), allocatable :: events(:)
      type(error_t), allocatable :: error
      integer :: first
      integer :: last

      impacts = 0_i8
      call create_stepping(wall, case, error)
      first = 1
      do while (first < n .and. .not. allocated(error))
         last = min(n, first + 1 + mod(first, 6))
         call advance_stepping(wall, case%record%t(first:last), case%record%a(first:last), error)
         if (.not. allocated(error)) call query_events(wall, events, error)
         if (.not. allocated(error)) impacts = impacts + count(events%kind == event_impact)
         first = last
      end do
      if (.not. allocated(error)) call query_state(wall, state, error)
      call checks%no_error(error, 'pieces')
      call destroy_stepping(wall)
   end subroutine run_in_pieces

   !> With the case's own pulse, cuts anywhere give the digits of one run.
   subroutine test_own_motion()
      type(case_t) :: case
      type(stepping_t) :: wall
      type(wall_state_t) :: state
      type(result_t) :: whole
      type(error_t), allocatable :: error
      integer :: k

      case = rwmf_scene('symmetric', 10.0_wp, 1.0_wp, 'dop853')
      case%solver%atol = 1.0e-11_wp
      call simulate(case, whole, error)
      call create_stepping(wall, case, error)
      do k = 1, 1000
         call advance_stepping(wall, k*case%solver%t_end/1000, error)
      end do
      call query_state(wall, state, error)
      call checks%no_error(error, 'own motion')
      call checks%close_to(state%u_s_max, whole%u_s_max, 'cut anywhere', 1.0e-7_wp)
      call destroy_stepping(wall)
   end subroutine test_own_motion

   !> A motion that is NaN for a while ends the advance there, for a rocking and a resting wall,
   !> long before the number of steps reaches its limit.
   subroutine test_motion_with_gap(method, amplitude)
      character(*), intent(in) :: method
      real(wp), intent(in) :: amplitude
      !! [m/s2]
      type(case_t) :: case
      type(stepping_t) :: wall
      type(wall_state_t) :: state
      type(error_t), allocatable :: error
      integer :: k

      do k = 1, 2
         case = record_scene(method)
         if (k == 2) deallocate (case%wall, case%cable)
         call create_stepping(wall, case, error)
         call advance_stepping(wall, 2.0_wp, gap_t(amplitude, 2*pi, 0.7_wp, 1.3_wp), error)
         call checks%has_error(error, err_numerical, 'not finite', method//', motion with a gap')
         call query_state(wall, state, error)
         call checks%that(abs(state%t) <= 0 .and. state%steps == 0, 'a failure takes back')
         call advance_stepping(wall, 2.0_wp, sine_t(amplitude, 2*pi), error)
         call checks%no_error(error, method//', after a motion with a gap')
         call destroy_stepping(wall)
      end do
   end subroutine test_motion_with_gap

   !> A failure of the integration restores the state before the call; the host may then continue.
   subroutine test_failure_takes_back()
      type(case_t) :: case
      type(stepping_t) :: wall
      type(wall_state_t) :: before
      type(wall_state_t) :: after
      type(error_t), allocatable :: error

      case = record_scene('adams')
      case%solver%max_steps = 400
      call create_stepping(wall, case, error)
      call advance_stepping(wall, case%record%t(:2), case%record%a(:2), error)
      call query_state(wall, before, error)
      call advance_stepping(wall, case%record%t(2:n), case%record%a(2:n), error)
      call checks%has_error(error, err_numerical, 'max_steps', 'too many steps')
      call query_state(wall, after, error)
      call checks%that(same_bits([before%t, before%theta, before%theta_dot, before%u_s_max], &
         [after%t, after%theta, after%theta_dot, after%u_s_max]), 'a failure takes back')
      call advance_stepping(wall, case%record%t(2:10), case%record%a(2:10), error)
      call checks%no_error(error, 'after a failure')
      call destroy_stepping(wall)
   end subroutine test_failure_takes_back

   !> True if the reals are equal to the last bit.
   logical function same_bits(a, b)
      real(wp), intent(in) :: a(:)
      real(wp), intent(in) :: b(:)
      integer(i8), allocatable :: x(:)
      integer(i8), allocatable :: y(:)

      x = transfer(a, x)
      y = transfer(b, y)
      same_bits = size(x) == size(y)
      if (same_bits) same_bits = all(x == y)
   end function same_bits

end program test_stepping
