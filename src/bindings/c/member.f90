!> C binding of the wall as a member (include/rwmf.h).
!>
!> Matrices of C hold row after row. Numbers of the host are addresses of arrays, whose length
!> follows from the member.
module rwmf_bindings_c_member
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_int32_t, &
      c_loc, c_ptr, c_size_t
   use rwmf_bindings_c_case, only: case_of, kept_case_t, name_file, read_host_case
   use rwmf_bindings_c_pointers, only: require_argument, require_empty, take_handle
   use rwmf_bindings_c_strings, only: put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_member, only: commit_member, create_member, member_info_t, place_member, &
      query_member, restart_member, revert_member, wall_member_t
   use rwmf_embedding_member_events, only: land_member, member_event_t, member_settles, &
      next_member_event
   use rwmf_embedding_member_response, only: link_motion_t, member_response_t, query_links, &
      respond_member
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: c_create_member, c_create_member_from_case, c_destroy_member, c_query_member
   public :: c_respond_member, c_commit_member, c_revert_member, c_restart_member, c_copy_member
   public :: c_query_links, c_next_member_event, c_land_member, c_member_settles, c_place_member

   !> `rwmf_member_info` of the header.
   type, bind(c) :: c_member_info_t
      integer(c_int32_t) :: dofs
      integer(c_int32_t) :: modes
      integer(c_int32_t) :: floors
      integer(c_int32_t) :: links
      integer(c_int32_t) :: side
      integer(c_int32_t) :: broken
      real(c_double) :: u
   end type c_member_info_t

   !> `rwmf_member_response` of the header.
   type, bind(c) :: c_member_response_t
      real(c_double) :: hold(2)
      real(c_double) :: theta
      real(c_double) :: theta_dot
      real(c_double) :: theta_ddot
      real(c_double) :: cable
      real(c_double) :: fuses(2)
   end type c_member_response_t

   !> `rwmf_member_event` of the header.
   type, bind(c) :: c_member_event_t
      real(c_double) :: tau
      integer(c_int32_t) :: kind
      integer(c_int32_t) :: side
   end type c_member_event_t

contains

   !> `rwmf_create_member`.
   integer(c_int) function c_create_member(namelist, handle, message, size) &
      bind(c, name='rwmf_create_member')
      type(c_ptr), value :: namelist
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(case_t) :: case
      type(error_t), allocatable :: error

      call require_empty(handle, 'member', error)
      if (.not. allocated(error)) call read_host_case(namelist, case, error)
      if (.not. allocated(error)) call make_member(case, handle, error)
      c_create_member = put_message(error, message, size)
   end function c_create_member

   !> `rwmf_create_member_from_case`.
   integer(c_int) function c_create_member_from_case(from, handle, message, size) &
      bind(c, name='rwmf_create_member_from_case')
      type(c_ptr), value :: from
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(kept_case_t), pointer :: kept
      type(error_t), allocatable :: error

      call require_empty(handle, 'member', error)
      call case_of(from, kept, error)
      if (.not. allocated(error)) then
         call make_member(kept%case, handle, error)
         call name_file(kept, error)
      end if
      c_create_member_from_case = put_message(error, message, size)
   end function c_create_member_from_case

   !> Make a member on the heap.
   subroutine make_member(case, handle, error)
      type(case_t), intent(in) :: case
      type(c_ptr), intent(inout) :: handle
      type(error_t), allocatable, intent(out) :: error
      type(wall_member_t), pointer :: member

      allocate (member)
      call create_member(member, case, error)
      if (allocated(error)) then
         deallocate (member)
      else
         handle = c_loc(member)
      end if
   end subroutine make_member

   !> `rwmf_destroy_member`.
   subroutine c_destroy_member(handle) bind(c, name='rwmf_destroy_member')
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr) :: address
      type(wall_member_t), pointer :: member

      address = take_handle(handle)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, member)
      deallocate (member)
   end subroutine c_destroy_member

   !> Return the member behind a handle, with its sizes. An earlier `error` is kept.
   subroutine member_of(handle, member, info, error)
      type(c_ptr), intent(in) :: handle
      type(wall_member_t), pointer, intent(out) :: member
      type(member_info_t), intent(out) :: info
      type(error_t), allocatable, intent(inout) :: error
      !! the handle is NULL

      nullify (member)
      if (allocated(error)) return
      if (c_associated(handle)) then
         call c_f_pointer(handle, member)
         call query_member(member, info, error)
      else
         call fail(error, err_input, 'no member: the handle is NULL')
      end if
   end subroutine member_of

   !> Return the numbers behind an address; not associated for NULL. An earlier `error` is kept.
   subroutine numbers_of(address, n, what, numbers, error)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: n
      !! how many
      character(*), intent(in) :: what
      !! name of the argument, for the message; blank: NULL is allowed
      real(c_double), pointer, contiguous, intent(out) :: numbers(:)
      type(error_t), allocatable, intent(inout) :: error

      nullify (numbers)
      if (what /= '') call require_argument(c_associated(address), what, error)
      if (allocated(error) .or. .not. c_associated(address)) return
      call c_f_pointer(address, numbers, [n])
   end subroutine numbers_of

   !> Return the mass matrix of a host; not associated for NULL, which makes an optional argument
   !> absent.
   function mass_of(address, n) result(mass)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: n
      real(c_double), pointer, contiguous :: mass(:, :)

      nullify (mass)
      if (c_associated(address)) call c_f_pointer(address, mass, [n, n])
   end function mass_of

   !> `rwmf_query_member`.
   integer(c_int) function c_query_member(handle, info, message, size) &
      bind(c, name='rwmf_query_member')
      type(c_ptr), value :: handle
      type(c_member_info_t), intent(inout), optional :: info
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: found
      type(error_t), allocatable :: error

      call member_of(handle, member, found, error)
      call require_argument(present(info), 'info', error)
      if (.not. allocated(error)) then
         info = c_member_info_t(int(found%dofs, c_int32_t), int(found%modes, c_int32_t), &
            int(found%floors, c_int32_t), int(found%links, c_int32_t), int(found%side, c_int32_t), &
            merge(1_c_int32_t, 0_c_int32_t, found%is_broken), found%u)
      end if
      c_query_member = put_message(error, message, size)
   end function c_query_member

   !> `rwmf_respond_member`.
   integer(c_int) function c_respond_member(handle, motion, ground, force, tangents, response, &
      message, size) bind(c, name='rwmf_respond_member')
      type(c_ptr), value :: handle
      type(c_ptr), value :: motion
      type(c_ptr), value :: ground
      type(c_ptr), value :: force
      type(c_ptr), value :: tangents
      type(c_member_response_t), intent(inout), optional :: response
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      type(member_response_t) :: found
      real(c_double), pointer, contiguous :: x(:), a(:), f(:), k(:)
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      associate (n => info%dofs)
         call numbers_of(motion, 3*n, 'motion', x, error)
         call numbers_of(ground, 2, 'ground', a, error)
         call numbers_of(force, n, 'force', f, error)
         call numbers_of(tangents, 3*n**2, '', k, error)
         if (.not. allocated(error)) then
            call respond_member(member, reshape(x, [n, 3]), a, found, error, &
               has_tangents=associated(k))
         end if
         if (.not. allocated(error)) then
            f = found%force
            if (associated(k)) k = [transpose(found%stiffness), transpose(found%damping), &
               transpose(found%mass)]
            if (present(response)) response = c_member_response_t(found%hold, found%theta, &
               found%theta_dot, found%theta_ddot, found%cable, found%fuses)
         end if
      end associate
      c_respond_member = put_message(error, message, size)
   end function c_respond_member

   !> Change the state of a member by one of three procedures.
   integer(c_int) function change_member(handle, change, message, size)
      type(c_ptr), intent(in) :: handle
      procedure(commit_member) :: change
      type(c_ptr), intent(in) :: message
      integer(c_size_t), intent(in) :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      if (.not. allocated(error)) call change(member, error)
      change_member = put_message(error, message, size)
   end function change_member

   !> `rwmf_commit_member`.
   integer(c_int) function c_commit_member(handle, message, size) &
      bind(c, name='rwmf_commit_member')
      type(c_ptr), value :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size

      c_commit_member = change_member(handle, commit_member, message, size)
   end function c_commit_member

   !> `rwmf_revert_member`.
   integer(c_int) function c_revert_member(handle, message, size) &
      bind(c, name='rwmf_revert_member')
      type(c_ptr), value :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size

      c_revert_member = change_member(handle, revert_member, message, size)
   end function c_revert_member

   !> `rwmf_restart_member`.
   integer(c_int) function c_restart_member(handle, message, size) &
      bind(c, name='rwmf_restart_member')
      type(c_ptr), value :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size

      c_restart_member = change_member(handle, restart_member, message, size)
   end function c_restart_member

   !> `rwmf_copy_member`.
   integer(c_int) function c_copy_member(handle, copy, message, size) &
      bind(c, name='rwmf_copy_member')
      type(c_ptr), value :: handle
      type(c_ptr), intent(inout), optional :: copy
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member, other
      type(member_info_t) :: info
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      call require_argument(present(copy), 'copy', error)
      if (.not. allocated(error)) then
         if (c_associated(copy)) then
            call c_f_pointer(copy, other)
         else
            allocate (other)
            copy = c_loc(other)
         end if
         if (.not. associated(member, other)) other = member
      end if
      c_copy_member = put_message(error, message, size)
   end function c_copy_member

   !> `rwmf_query_links`.
   integer(c_int) function c_query_links(handle, motion, links, derivatives, message, size) &
      bind(c, name='rwmf_query_links')
      type(c_ptr), value :: handle
      type(c_ptr), value :: motion
      type(c_ptr), value :: links
      type(c_ptr), value :: derivatives
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      type(link_motion_t) :: found
      real(c_double), pointer, contiguous :: x(:), u(:), b(:)
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      call numbers_of(motion, 3*info%dofs, 'motion', x, error)
      call numbers_of(links, 3*info%links, 'links', u, error)
      call numbers_of(derivatives, info%links*info%dofs, 'derivatives', b, error)
      if (.not. allocated(error)) call query_links(member, reshape(x, [info%dofs, 3]), found, error)
      if (.not. allocated(error)) then
         u = reshape(found%motion, shape(u))
         b = reshape(transpose(found%derivatives), shape(b))
      end if
      c_query_links = put_message(error, message, size)
   end function c_query_links

   !> `rwmf_next_member_event`.
   integer(c_int) function c_next_member_event(handle, dt, motions, ground, push, branches, event, &
      message, size) bind(c, name='rwmf_next_member_event')
      type(c_ptr), value :: handle
      real(c_double), value :: dt
      type(c_ptr), value :: motions
      type(c_ptr), value :: ground
      type(c_ptr), value :: push
      integer(c_int), value :: branches
      type(c_member_event_t), intent(inout), optional :: event
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      type(member_event_t) :: found
      real(c_double), pointer, contiguous :: x(:), a(:), p(:)
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      call numbers_of(motions, 6*info%dofs, 'motions', x, error)
      call numbers_of(ground, 4, 'ground', a, error)
      call numbers_of(push, 2, 'push', p, error)
      call require_argument(present(event), 'event', error)
      if (.not. allocated(error)) call next_member_event(member, dt, reshape(x, [info%dofs, 3, &
         2]), reshape(a, [2, 2]), p, found, error, has_branches=branches /= 0)
      if (.not. allocated(error)) event = c_member_event_t(found%tau, int(found%kind, c_int32_t), &
         int(found%side, c_int32_t))
      c_next_member_event = put_message(error, message, size)
   end function c_next_member_event

   !> `rwmf_land_member`.
   integer(c_int) function c_land_member(handle, displacements, host_mass, velocities, side, &
      message, size) bind(c, name='rwmf_land_member')
      type(c_ptr), value :: handle
      type(c_ptr), value :: displacements
      type(c_ptr), value :: host_mass
      type(c_ptr), value :: velocities
      integer(c_int32_t), intent(inout), optional :: side
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      real(c_double), pointer, contiguous :: x(:), m(:, :), v(:)
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      call numbers_of(displacements, info%dofs, 'displacements', x, error)
      call numbers_of(velocities, info%dofs, 'velocities', v, error)
      call require_argument(present(side), 'side', error)
      if (.not. allocated(error)) then
         m => mass_of(host_mass, info%dofs)
         call land_member(member, x, v, error, m)
      end if
      if (.not. allocated(error)) call query_member(member, info, error)
      if (.not. allocated(error)) side = int(info%side, c_int32_t)
      c_land_member = put_message(error, message, size)
   end function c_land_member

   !> `rwmf_member_settles`.
   integer(c_int) function c_member_settles(handle, dt, motion, ground, push, host_mass, rests, &
      message, size) bind(c, name='rwmf_member_settles')
      type(c_ptr), value :: handle
      real(c_double), value :: dt
      type(c_ptr), value :: motion
      type(c_ptr), value :: ground
      real(c_double), value :: push
      type(c_ptr), value :: host_mass
      integer(c_int32_t), intent(inout), optional :: rests
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      real(c_double), pointer, contiguous :: x(:), a(:), m(:, :)
      type(error_t), allocatable :: error
      logical :: found

      found = .false.
      call member_of(handle, member, info, error)
      call numbers_of(motion, 3*info%dofs, 'motion', x, error)
      call numbers_of(ground, 2, 'ground', a, error)
      call require_argument(present(rests), 'rests', error)
      if (.not. allocated(error)) then
         m => mass_of(host_mass, info%dofs)
         found = member_settles(member, dt, reshape(x, [info%dofs, 3]), a, push, error, m)
      end if
      if (.not. allocated(error)) rests = merge(1_c_int32_t, 0_c_int32_t, found)
      c_member_settles = put_message(error, message, size)
   end function c_member_settles

   !> `rwmf_place_member`.
   integer(c_int) function c_place_member(handle, side, message, size) &
      bind(c, name='rwmf_place_member')
      type(c_ptr), value :: handle
      integer(c_int), value :: side
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_member_t), pointer :: member
      type(member_info_t) :: info
      type(error_t), allocatable :: error

      call member_of(handle, member, info, error)
      if (.not. allocated(error)) call place_member(member, int(side), error)
      c_place_member = put_message(error, message, size)
   end function c_place_member

end module rwmf_bindings_c_member
