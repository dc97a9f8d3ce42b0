!> Walls and members of a host in Python. Flat procedures for f2py in the extension `rwmf._kernel`
!> beside `rwmf_bindings_python_kernel`, with the same conventions. Only one thread at a time may
!> use a wall or a member.
module rwmf_bindings_python_hosts
   use, intrinsic :: iso_c_binding, only: c_double, c_f_procpointer, c_int, c_int64_t, c_int8_t, &
      c_null_funptr, c_null_ptr
   use rwmf_bindings_c_stepping, only: c_ground_t
   use rwmf_bindings_python_handles, only: complete_case, find, keep, kept_t, make_control, &
      put_error
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: dp
   use rwmf_embedding_member, only: commit_member, create_member, member_info_t, place_member, &
      query_member, restart_member, revert_member, wall_member_t
   use rwmf_embedding_member_events, only: land_member, member_event_t, member_settles, &
      next_member_event
   use rwmf_embedding_member_response, only: link_motion_t, member_response_t, query_links, &
      respond_member
   use rwmf_embedding_stepping, only: advance_stepping
   use rwmf_embedding_wall_group, only: advance_walls, create_walls, fill_forces, fill_states, &
      restore_walls, save_walls
   use rwmf_problem_case, only: case_t
   implicit none
   public

contains

   !> Create n walls of one case, or of n cases.
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
   !> for the motion of the case. `control` is (unused, cancel).
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

   !> Create the member of a case.
   subroutine member_create(case, handle, status, message, message_length)
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
      allocate (kept%member)
      call create_member(kept%member, from%case, error)
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine member_create

   !> Return sizes and committed state: dofs, modes, floors, links, side, 1 with a broken tendon.
   subroutine member_info(handle, counts, u)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: counts(6)
      real(c_double), intent(out) :: u
      type(kept_t), pointer :: kept
      type(member_info_t) :: info
      type(error_t), allocatable :: error

      kept => find(handle)
      call query_member(kept%member, info, error)
      counts = [info%dofs, info%modes, info%floors, info%links, info%side, &
         merge(1, 0, info%is_broken)]
      u = info%u
   end subroutine member_info

   !> Compute responses to m trial motions; the last one sets the trial state.
   !>
   !> A side of 1 or -1 belongs to a wall with springs that have not moved; the state then neither
   !> matters nor changes. After an error `failed` is the number of the motion.
   subroutine member_respond(handle, sides, motion, found, failed, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: sides(:)
      !! (m) 0 for the committed state
      real(c_double), intent(in) :: motion(:, :)
      !! (3*dofs + 2, m) displacements, velocities, accelerations, u_g'', v_g''
      real(c_double), intent(inout) :: found(:, :)
      !! (dofs + 3*dofs**2 + 8, m) forces; stiffness, damping and mass row after row; hold (2),
      !! theta, theta', theta'', cable, fuses (2)
      integer(c_int64_t), intent(out) :: failed
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(wall_member_t) :: fresh
      type(member_response_t) :: r
      type(error_t), allocatable :: error
      integer :: i
      integer :: n
      !f2py threadsafe

      kept => find(handle)
      n = kept%member%n
      failed = 0_c_int64_t
      do i = 1, size(sides)
         associate (q => reshape(motion(:3*n, i), [n, 3]), ground => motion(3*n + 1:, i))
            if (sides(i) == 0) then
               call respond_member(kept%member, q, ground, r, error)
            else
               fresh = kept%member
               call restart_member(fresh, error)
               call place_member(fresh, int(sides(i)), error)
               if (.not. allocated(error)) call respond_member(fresh, q, ground, r, error)
            end if
         end associate
         if (allocated(error)) then
            failed = i
            exit
         end if
         found(:, i) = [r%force, transpose(r%stiffness), transpose(r%damping), transpose(r%mass), &
            r%hold, r%theta, r%theta_dot, r%theta_ddot, r%cable, r%fuses]
      end do
      call put_error(error, status, message, message_length)
   end subroutine member_respond

   !> Change the state: keep the trial state (1), return to the committed (2) or first one (3).
   subroutine member_change(handle, change, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: change
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      kept => find(handle)
      select case (change)
      case (1)
         call commit_member(kept%member, error)
      case (2)
         call revert_member(kept%member, error)
      case default
         call restart_member(kept%member, error)
      end select
      call put_error(error, status, message, message_length)
   end subroutine member_change

   !> Set the side of a wall that is committed at u = 0.
   subroutine member_place(handle, side, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: side
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      kept => find(handle)
      call place_member(kept%member, int(side), error)
      call put_error(error, status, message, message_length)
   end subroutine member_place

   !> Copy a member into a new object.
   subroutine member_save(handle, saved)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: saved
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: none

      from => find(handle)
      allocate (kept)
      kept%member = from%member
      call keep(kept, none, saved)
   end subroutine member_save

   !> Overwrite a member with a saved one.
   subroutine member_restore(handle, saved)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: saved
      type(kept_t), pointer :: kept
      type(kept_t), pointer :: from

      kept => find(handle)
      from => find(saved)
      kept%member = from%member
   end subroutine member_restore

   !> Motion of the wall at its links: (links, 3 + dofs) displacement, velocity, acceleration, and
   !> the derivatives by the degrees of freedom.
   subroutine member_links(handle, motion, links, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: motion(:)
      real(c_double), intent(inout) :: links(:, :)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(link_motion_t) :: found
      type(error_t), allocatable :: error

      kept => find(handle)
      call query_links(kept%member, reshape(motion, [kept%member%n, 3]), found, error)
      if (.not. allocated(error)) then
         links(:, :3) = found%motion
         links(:, 4:) = found%derivatives
      end if
      call put_error(error, status, message, message_length)
   end subroutine member_links

   !> First event in a step: `numbers` are dt, the pushes (2), the grounds (4) and motions (6*dofs)
   !> at both ends; `event` is kind, time since the beginning, side.
   subroutine member_next_event(handle, numbers, branches, event, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: numbers(:)
      integer(c_int), intent(in) :: branches
      !! 0 to leave out the ends of branches
      real(c_double), intent(out) :: event(3)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(member_event_t) :: found
      type(error_t), allocatable :: error

      kept => find(handle)
      call next_member_event(kept%member, numbers(1), reshape(numbers(8:), [kept%member%n, 3, 2]), &
         reshape(numbers(4:7), [2, 2]), numbers(2:3), found, error, branches /= 0)
      event = [real(found%kind, dp), found%tau, real(found%side, dp)]
      call put_error(error, status, message, message_length)
   end subroutine member_next_event

   !> Apply an impact: `mass` is that of the host, or empty for that of the case.
   subroutine member_land(handle, displacements, velocities, mass, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: displacements(:)
      real(c_double), intent(inout) :: velocities(:)
      real(c_double), intent(in) :: mass(:, :)
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      real(c_double), allocatable :: given(:, :)

      kept => find(handle)
      if (size(mass) > 0) given = mass
      ! not allocated: the argument is absent
      call land_member(kept%member, displacements, velocities, error, given)
      call put_error(error, status, message, message_length)
   end subroutine member_land

   !> 1 if the wall that has landed may be put to rest: `numbers` are dt, push, ground (2) and
   !> motion (3*dofs); `mass` as in `member_land`.
   subroutine member_rests(handle, numbers, mass, answer, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: numbers(:)
      real(c_double), intent(in) :: mass(:, :)
      integer(c_int), intent(out) :: answer
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      real(c_double), allocatable :: given(:, :)
      logical :: rests

      kept => find(handle)
      if (size(mass) > 0) given = mass
      rests = member_settles(kept%member, numbers(1), reshape(numbers(5:), [kept%member%n, 3]), &
         numbers(3:4), numbers(2), error, given)
      answer = merge(1_c_int, 0_c_int, rests)
      call put_error(error, status, message, message_length)
   end subroutine member_rests

end module rwmf_bindings_python_hosts
