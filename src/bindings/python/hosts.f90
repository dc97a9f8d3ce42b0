!> Walls and elements of a host in Python. Flat procedures for f2py in the extension `rwmf._kernel`
!> beside `rwmf_bindings_python_kernel`, with the same conventions. Only one thread at a time may
!> use a wall.
module rwmf_bindings_python_hosts
   use, intrinsic :: iso_c_binding, only: c_double, c_f_procpointer, c_int, c_int64_t, c_int8_t, &
      c_null_funptr, c_null_ptr
   use rwmf_bindings_c_stepping, only: c_ground_t
   use rwmf_bindings_python_handles, only: complete_case, find, keep, kept_t, make_control, &
      put_error
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: dp
   use rwmf_embedding_element, only: create_element, element_response_t, respond, velocity_factor
   use rwmf_embedding_element_events, only: next_impact, next_lift_off, settles
   use rwmf_embedding_stepping, only: advance_stepping
   use rwmf_embedding_wall_group, only: advance_walls, create_walls, fill_forces, fill_states, &
      restore_walls, save_walls
   use rwmf_problem_case, only: case_t
   implicit none
   public

contains

   !> Create n walls: of one case, or each of its own.
   subroutine walls_create(cases, n, t_begin, peak, handle, status, message, message_length)
      integer(c_int64_t), intent(in) :: cases(:)
      !! one handle, or n
      integer(c_int64_t), intent(in) :: n
      real(c_double), intent(in) :: t_begin
      real(c_double), intent(in) :: peak
      !! 0 for the default
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: message
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(kept_t), pointer :: from
      type(case_t) :: case
      type(error_t), allocatable :: error
      integer :: i
      integer :: last
      !f2py threadsafe

      allocate (kept)
      allocate (kept%group)
      allocate (kept%group%walls(n))
      do i = 1, size(cases)
         from => find(cases(i))
         call complete_case(from, case)
         last = merge(int(n), i, size(cases) == 1)
         if (abs(peak) > 0) then
            call create_walls(kept%group, case, i, last, error, real(t_begin, dp), real(peak, dp))
         else
            call create_walls(kept%group, case, i, last, error, real(t_begin, dp))
         end if
         if (allocated(error)) exit
      end do
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine walls_create

   !> Advance all walls to the last of the times. `a` is (times, walls) or (times, 1); (times, 0)
   !> for the motion of the case. `control` is (unused, cancel), read between the walls.
   subroutine walls_advance(handle, t, a, threads, control, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: t(:)
      real(c_double), intent(in) :: a(:, :)
      integer(c_int), intent(in) :: threads
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      !f2py threadsafe

      kept => find(handle)
      call advance_walls(kept%group, t, a, int(threads), make_control(control), error)
      call put_error(error, status, message, message_length)
   end subroutine walls_advance

   !> Advance the only wall of a handle under a function at an address, as `rwmf_advance_ground`.
   subroutine wall_advance_ground(handle, t, address, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: t
      integer(c_int64_t), intent(in) :: address
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(c_ground_t) :: ground
      type(error_t), allocatable :: error
      !f2py threadsafe

      kept => find(handle)
      call c_f_procpointer(transfer(address, c_null_funptr), ground%compute)
      ground%data = c_null_ptr
      call advance_stepping(kept%group%walls(1), t, ground, error)
      call put_error(error, status, message, message_length)
   end subroutine wall_advance_ground

   !> Fill states and maxima as `fill_states`: `reals` is (walls, 11), `counts` (walls, 6).
   subroutine walls_state(handle, reals, counts, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(inout) :: reals(:, :)
      integer(c_int64_t), intent(inout) :: counts(:, :)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      kept => find(handle)
      call fill_states(kept%group, reals, counts, error)
      call put_error(error, status, message, message_length)
   end subroutine walls_state

   !> Fill forces: (walls, 3) link, frame_shear, cable.
   subroutine walls_forces(handle, forces, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(inout) :: forces(:, :)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      kept => find(handle)
      call fill_forces(kept%group, forces, error)
      call put_error(error, status, message, message_length)
   end subroutine walls_forces

   !> Count the events of the last advance of each wall.
   subroutine walls_event_counts(handle, counts)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(inout) :: counts(:)
      type(kept_t), pointer :: kept
      integer :: i

      kept => find(handle)
      do i = 1, size(kept%group%walls)
         counts(i) = kept%group%walls(i)%instance%recorder%n_events
      end do
   end subroutine walls_event_counts

   !> Copy the events of all walls, wall after wall: `reals` is (events, 3) t, theta, theta_dot.
   subroutine walls_events(handle, kinds, reals)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(inout) :: kinds(:)
      real(c_double), intent(inout) :: reals(:, :)
      type(kept_t), pointer :: kept
      integer :: i
      integer :: j
      integer :: k

      kept => find(handle)
      k = 0
      do i = 1, size(kept%group%walls)
         associate (recorder => kept%group%walls(i)%instance%recorder)
            do j = 1, recorder%n_events
               k = k + 1
               kinds(k) = recorder%events(j)%kind
               reals(k, :) = [recorder%events(j)%t, recorder%events(j)%theta, &
                  recorder%events(j)%theta_dot]
            end do
         end associate
      end do
   end subroutine walls_events

   !> Save the states of all walls in a new object.
   subroutine walls_save(handle, saved, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: saved
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      !f2py threadsafe

      from => find(handle)
      allocate (kept)
      call save_walls(from%group, kept%snapshots, error)
      call keep(kept, error, saved)
      call put_error(error, status, message, message_length)
   end subroutine walls_save

   !> Restore the states of all walls; the number of walls is that of the snapshot.
   subroutine walls_restore(handle, saved, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: saved
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(kept_t), pointer :: from
      type(error_t), allocatable :: error
      !f2py threadsafe

      kept => find(handle)
      from => find(saved)
      call restore_walls(kept%group, from%snapshots, error)
      call put_error(error, status, message, message_length)
   end subroutine walls_restore

   !> Create an element.
   subroutine element_create(case, handle, status, message, message_length)
      integer(c_int64_t), intent(in) :: case
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      from => find(case)
      allocate (kept)
      allocate (kept%element)
      call create_element(kept%element, from%case, error)
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine element_create

   !> Compute responses to n motions: `motion` is (n, 4) u, u', u'', u_g'', `responses` (n, 8) as
   !> `rwmf_response`. After an error `failed` is the number of the motion.
   subroutine element_respond(handle, sides, motion, responses, failed, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: sides(:)
      real(c_double), intent(in) :: motion(:, :)
      real(c_double), intent(inout) :: responses(:, :)
      integer(c_int64_t), intent(out) :: failed
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(element_response_t) :: r
      type(error_t), allocatable :: error
      integer :: i
      !f2py threadsafe

      kept => find(handle)
      failed = 0_c_int64_t
      do i = 1, size(sides)
         call respond(kept%element, int(sides(i)), motion(i, 1), motion(i, 2), motion(i, 3), &
            motion(i, 4), r, error)
         if (allocated(error)) then
            failed = i
            exit
         end if
         responses(i, :) = [r%force, r%stiffness, r%damping, r%mass, r%theta, r%theta_dot, &
            r%theta_ddot, r%cable]
      end do
      call put_error(error, status, message, message_length)
   end subroutine element_respond

   !> Velocity factor of an element at an impact [-].
   subroutine element_factor(handle, factor)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: factor
      type(kept_t), pointer :: kept

      kept => find(handle)
      factor = velocity_factor(kept%element)
   end subroutine element_factor

   !> First impact in a step, as `rwmf_next_impact`; `motion` is dt, u_0, u_dot_0, u_1, u_dot_1.
   subroutine element_next_impact(side, motion, found, tau, status, message, message_length)
      integer(c_int), intent(in) :: side
      real(c_double), intent(in) :: motion(5)
      integer(c_int), intent(out) :: found
      real(c_double), intent(out) :: tau
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      logical :: is_found
      type(error_t), allocatable :: error

      call next_impact(int(side), motion(1), motion(2), motion(3), motion(4), motion(5), is_found, &
         tau, error)
      found = merge(1_c_int, 0_c_int, is_found)
      call put_error(error, status, message, message_length)
   end subroutine element_next_impact

   !> First lift-off in a step, as `rwmf_next_lift_off`; `motion` is dt, push_0, push_1, u_g_ddot_0,
   !> u_g_ddot_1.
   subroutine element_next_lift_off(handle, motion, side, tau, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: motion(5)
      integer(c_int), intent(out) :: side
      real(c_double), intent(out) :: tau
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      integer :: found

      kept => find(handle)
      call next_lift_off(kept%element, motion(1), motion(2), motion(3), motion(4), motion(5), &
         found, tau, error)
      side = int(found, c_int)
      call put_error(error, status, message, message_length)
   end subroutine element_next_lift_off

   !> 1 if the host may put the wall to rest, as `rwmf_settles`; `motion` is dt, u_dot, push,
   !> u_g_ddot, host_mass.
   subroutine element_settles(handle, motion, answer, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: motion(5)
      integer(c_int), intent(out) :: answer
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      logical :: is_settled

      kept => find(handle)
      is_settled = settles(kept%element, motion(1), motion(2), motion(3), motion(4), motion(5), &
         error)
      answer = merge(1_c_int, 0_c_int, is_settled)
      call put_error(error, status, message, message_length)
   end subroutine element_settles

end module rwmf_bindings_python_hosts
