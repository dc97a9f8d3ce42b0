!> Walls that a host advances together, in threads.
!>
!> A call that fails for one wall leaves all of them unchanged. No bit of a wall depends on the
!> other walls or on the number of threads.
module rwmf_embedding_wall_group
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: add_context, err_interrupt, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      query_forces, query_state, restore_stepping, save_stepping, snapshot_t, stepping_t, &
      wall_forces_t, wall_state_t
   use rwmf_embedding_wall_instance, only: save_state
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_threads, only: choose_threads
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: wall_group_t, create_walls, destroy_walls, advance_walls, save_walls, restore_walls
   public :: fill_states, fill_forces

   !> Walls of a host. An assignment copies the handles only.
   type :: wall_group_t
      type(stepping_t), allocatable :: walls(:)
      type(snapshot_t), allocatable :: before(:)
      !! (walls) states at the beginning of a call, if there are several walls
   end type wall_group_t

contains

   !> Append walls of a case to a group; after a failure the group is empty.
   subroutine create_walls(group, case, first, last, error, t_begin, peak)
      type(wall_group_t), intent(inout) :: group
      !! `walls` is allocated
      type(case_t), intent(in) :: case
      integer, intent(in) :: first
      !! number of the first wall that the case describes
      integer, intent(in) :: last
      !! number of the last one
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: t_begin
      !! [s]
      real(wp), intent(in), optional :: peak
      !! as in `create_stepping` [m/s2]
      integer :: i

      do i = first, last
         call create_stepping(group%walls(i), case, error, t_begin, peak)
         if (.not. allocated(error)) cycle
         call destroy_walls(group)
         return
      end do
   end subroutine create_walls

   !> Destroy all walls of a group. A second call has no effect.
   subroutine destroy_walls(group)
      type(wall_group_t), intent(inout) :: group
      integer :: i

      if (.not. allocated(group%walls)) return
      do i = 1, size(group%walls)
         call destroy_stepping(group%walls(i))
      end do
      deallocate (group%walls)
   end subroutine destroy_walls

   !> Advance all walls to the last time.
   subroutine advance_walls(group, t, a, threads, control, error)
      type(wall_group_t), intent(inout) :: group
      real(wp), intent(in) :: t(:)
      !! (times) times of the samples, or the one to advance to under the motion of the case [s]
      real(wp), intent(in) :: a(:, :)
      !! (times, walls), or (times, 1) for the motion of all; (times, 0) for that of the case [m/s2]
      integer, intent(in) :: threads
      !! 0 for all
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error
      !! that of the first wall that fails; `err_interrupt` after a stop
      type(error_t), allocatable :: failed
      logical, allocatable :: has_moved(:)
      integer :: used
      integer :: first
      integer :: i

      call choose_threads(threads, used, error)
      if (allocated(error)) return
      associate (n => size(group%walls))
         allocate (has_moved(n), source=.false.)
         if (n > 1 .and. .not. allocated(group%before)) allocate (group%before(n))
         first = n + 1
         !$omp parallel do num_threads(used) schedule(dynamic, 4) default(shared) &
         !$omp private(failed) if(n > 1)
         do i = 1, n
            call advance_one(group, i, t, a, control, failed)
            has_moved(i) = .not. allocated(failed)
            if (has_moved(i)) cycle
            !$omp critical(rwmf_first_failure)
            if (i < first) then
               first = i
               call move_alloc(failed, error)
            end if
            !$omp end critical(rwmf_first_failure)
         end do
         !$omp end parallel do
         if (first > n .or. n == 1) return
      end associate
      ! a failure of one wall leaves all of them unchanged
      do i = 1, size(has_moved)
         if (has_moved(i)) call restore_stepping(group%walls(i), group%before(i), failed)
      end do
      call add_context(error, 'wall '//trim(integer_to_text(first)))
   end subroutine advance_walls

   subroutine advance_one(group, i, t, a, control, error)
      type(wall_group_t), intent(inout) :: group
      integer, intent(in) :: i
      real(wp), intent(in) :: t(:)
      real(wp), intent(in) :: a(:, :)
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error

      if (is_cancelled(control)) then
         call fail(error, err_interrupt, 'interrupted')
         return
      end if
      ! `save_stepping` would restart multistep methods
      if (size(group%walls) > 1) then
         call save_state(group%walls(i)%instance, group%before(i), goes_on=.true.)
      end if
      associate (wall => group%walls(i))
         wall%instance%control = control
         if (size(a, 2) == 0) then
            call advance_stepping(wall, t(size(t)), error)
         else
            call advance_stepping(wall, t, a(:, min(i, size(a, 2))), error)
         end if
         ! the flag belongs to the caller
         wall%instance%control = control_t()
      end associate
   end subroutine advance_one

   !> Save the states of all walls.
   subroutine save_walls(group, snapshots, error)
      type(wall_group_t), intent(inout) :: group
      type(snapshot_t), allocatable, intent(out) :: snapshots(:)
      !! (walls)
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if a wall does not exist
      integer :: i

      allocate (snapshots(size(group%walls)))
      do i = 1, size(group%walls)
         call save_stepping(group%walls(i), snapshots(i), error)
         if (allocated(error)) return
      end do
   end subroutine save_walls

   !> Restore the states of all walls. A refused snapshot changes no wall.
   subroutine restore_walls(group, snapshots, error)
      type(wall_group_t), intent(inout) :: group
      type(snapshot_t), intent(in) :: snapshots(:)
      !! (walls)
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(group%walls)
         associate (own => group%walls(i)%instance%identity, saved => snapshots(i)%identity)
            if (any(abs(own - saved) > 0)) exit
         end associate
      end do
      ! the first wall that refuses its snapshot comes first, with its error
      if (i <= size(group%walls)) then
         call restore_stepping(group%walls(i), snapshots(i), error)
         return
      end if
      do i = 1, size(group%walls)
         call restore_stepping(group%walls(i), snapshots(i), error)
         if (allocated(error)) return
      end do
   end subroutine restore_walls

   !> Fill tables of states and maxima, one row for each wall.
   subroutine fill_states(group, reals, counts, error)
      type(wall_group_t), intent(in) :: group
      real(wp), intent(inout) :: reals(:, :)
      !! (walls, 11) time reached [s]; t [s], theta [rad], theta', theta'', u_s [m], u_s', u_s'';
      !! largest |u_s| [m], |theta| [rad], |theta'| [rad/s]
      integer(i8), intent(inout) :: counts(:, :)
      !! (walls, 6) impacts, lift_offs, steps; 1 if at rest, overturned, collapsed
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if a wall does not exist
      type(wall_state_t) :: state
      integer :: i

      do i = 1, size(group%walls)
         call query_state(group%walls(i), state, error)
         if (allocated(error)) return
         associate (instance => group%walls(i)%instance)
            reals(i, :) = [instance%t, state%t, state%theta, state%theta_dot, state%theta_ddot, &
               state%u_s, state%u_s_dot, state%u_s_ddot, state%u_s_max, state%theta_max, &
               max(instance%recorder%theta_dot_max, instance%recorder%theta_dot_ends)]
            if (.not. allocated(instance%case%wall)) reals(i, 11) = 0
         end associate
         counts(i, :3) = [state%impacts, state%lift_offs, state%steps]
         counts(i, 4:) = merge(1_i8, 0_i8, [state%at_rest, state%overturned, state%collapsed])
      end do
   end subroutine fill_states

   !> Fill a table of forces, one row for each wall.
   subroutine fill_forces(group, forces, error)
      type(wall_group_t), intent(in) :: group
      real(wp), intent(inout) :: forces(:, :)
      !! (walls, 3) link, frame_shear, cable [N] or [N/kg]
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` if a wall does not exist
      type(wall_forces_t) :: found
      integer :: i

      do i = 1, size(group%walls)
         call query_forces(group%walls(i), found, error)
         if (allocated(error)) return
         forces(i, :) = [found%link, found%frame_shear, found%cable]
      end do
   end subroutine fill_forces

end module rwmf_embedding_wall_group
