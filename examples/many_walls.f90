!> A host with many walls that several threads advance together, step by step.
program many_walls
   use rwmf, only: advance_stepping, case_t, create_stepping, destroy_stepping, error_t, &
      query_state, read_case_text, stepping_t, wall_state_t, wp
   implicit none
   integer, parameter :: n = 64
   integer, parameter :: steps = 200
   real(wp), parameter :: dt = 0.02_wp
   type(case_t) :: case
   type(error_t), allocatable :: error
   real(wp) :: largest(n)
   real(wp) :: again(n)
   logical :: failed

   call read_case_text( &
      "&wall h = 2.0, b = 0.5 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&impact rule = 'constant', e = 0.9 /"//new_line('a')// &
      "&model formulation = 'symmetric' /"//new_line('a')// &
      "&solver t_end = 4.0 /", '', case, error)
   if (allocated(error)) error stop 1
   call march(4, largest, failed)
   if (failed) error stop 2
   call march(1, again, failed)
   if (failed .or. any(abs(largest - again) > 0)) error stop 3
   print '(a, f8.6, a, f8.6, a)', 'largest |u_s| from ', minval(largest), ' to ', maxval(largest), &
      ' m, the same in one thread and in four'

contains

   !> Advance all walls through all steps; each wall has its own frame period.
   subroutine march(threads, u_max, failed)
      integer, intent(in) :: threads
      real(wp), intent(out) :: u_max(n)
      !! [m]
      logical, intent(out) :: failed
      type(stepping_t) :: walls(n)
      logical :: bad(n)
      integer :: i, k

      do i = 1, n
         call start(walls(i), 0.3_wp + 0.04_wp*i, bad(i))
      end do
      do k = 1, steps
         !$omp parallel do num_threads(threads) schedule(dynamic)
         do i = 1, n
            if (.not. bad(i)) call advance(walls(i), k, bad(i))
         end do
         !$omp end parallel do
      end do
      do i = 1, n
         call finish(walls(i), u_max(i))
      end do
      failed = any(bad)
   end subroutine march

   subroutine start(wall, T_s, bad)
      type(stepping_t), intent(inout) :: wall
      real(wp), intent(in) :: T_s
      !! [s]
      logical, intent(out) :: bad
      type(case_t) :: own
      type(error_t), allocatable :: error

      own = case
      own%frame%T_s = T_s
      call create_stepping(wall, own, error)
      bad = allocated(error)
   end subroutine start

   subroutine advance(wall, k, bad)
      type(stepping_t), intent(inout) :: wall
      integer, intent(in) :: k
      !! step
      logical, intent(out) :: bad
      type(error_t), allocatable :: error

      call advance_stepping(wall, [k - 1, k]*dt, 4*sin(6*[k - 1, k]*dt), error)
      bad = allocated(error)
   end subroutine advance

   subroutine finish(wall, u_max)
      type(stepping_t), intent(inout) :: wall
      real(wp), intent(out) :: u_max
      !! [m]
      type(wall_state_t) :: state
      type(error_t), allocatable :: error

      call query_state(wall, state, error)
      u_max = state%u_s_max
      call destroy_stepping(wall)
   end subroutine finish

end program many_walls
