!> C binding of the stepping walls (include/rwmf.h).
!>
!> Handles are addresses on the heap. A function that fails returns the number of its error, puts
!> the message into the caller's buffer and changes nothing.
module rwmf_bindings_c_stepping
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, &
      c_f_procpointer, c_funptr, c_int, c_int32_t, c_int64_t, c_loc, c_null_ptr, c_ptr, c_size_t
   use rwmf_bindings_c_case, only: c_destroy_case, c_read_case, case_of, kept_case_t, name_file
   use rwmf_bindings_c_pointers, only: require_argument, require_empty, take_handle
   use rwmf_bindings_c_run, only: c_ending_t, ending_of
   use rwmf_bindings_c_strings, only: put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_ranges, only: any_number, require_number
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      query_events, query_forces, query_state, require, restore_stepping, save_stepping, &
      snapshot_t, stepping_t, wall_forces_t, wall_state_t
   use rwmf_motion_ground_motion, only: ground_t
   use rwmf_simulation_state_result, only: event_t
   implicit none
   private

   public :: c_create, c_create_from_case, c_destroy
   public :: c_advance, c_advance_samples, c_advance_ground
   public :: c_query_state, c_query_ending, c_query_forces, c_query_events
   public :: c_save, c_restore, c_destroy_snapshot
   public :: c_ground_t, wall_of

   !> `rwmf_state` of the header.
   type, bind(c) :: c_state_t
      real(c_double) :: t
      real(c_double) :: theta
      real(c_double) :: theta_dot
      real(c_double) :: theta_ddot
      real(c_double) :: u_s
      real(c_double) :: u_s_dot
      real(c_double) :: u_s_ddot
      real(c_double) :: u_s_max
      real(c_double) :: theta_max
      integer(c_int64_t) :: impacts
      integer(c_int64_t) :: lift_offs
      integer(c_int64_t) :: steps
      integer(c_int32_t) :: at_rest
      integer(c_int32_t) :: overturned
   end type c_state_t

   !> `rwmf_forces` of the header.
   type, bind(c) :: c_forces_t
      real(c_double) :: link
      real(c_double) :: frame_shear
      real(c_double) :: cable
   end type c_forces_t

   !> `rwmf_event` of the header.
   type, bind(c) :: c_event_t
      real(c_double) :: t
      real(c_double) :: theta
      real(c_double) :: theta_dot
      integer(c_int32_t) :: kind
   end type c_event_t

   abstract interface
      !> Acceleration that the host computes [m/s2].
      pure function c_ground_i(t, data) result(a) bind(c)
         import :: c_double, c_ptr
         implicit none
         real(c_double), value :: t
         !! [s]
         type(c_ptr), value :: data
         real(c_double) :: a
      end function c_ground_i
   end interface

   !> Function of the host as a ground motion.
   type, extends(ground_t) :: c_ground_t
      procedure(c_ground_i), pointer, nopass :: compute => null()
      type(c_ptr) :: data
   contains
      procedure :: acceleration_at
   end type c_ground_t

contains

   pure real(c_double) function acceleration_at(self, t)
      class(c_ground_t), intent(in) :: self
      real(c_double), intent(in) :: t

      acceleration_at = self%compute(t, self%data)
   end function acceleration_at

   !> Return the wall behind a handle; for NULL an empty one, which every procedure rejects.
   function wall_of(handle) result(wall)
      type(c_ptr), intent(in) :: handle
      type(stepping_t) :: wall
      type(stepping_t), pointer :: kept

      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, kept)
      wall = kept
   end function wall_of

   !> `rwmf_create`.
   integer(c_int) function c_create(namelist, t_begin, peak, handle, message, size) &
      bind(c, name='rwmf_create')
      type(c_ptr), value :: namelist
      real(c_double), value :: t_begin
      !! [s]
      real(c_double), value :: peak
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(c_ptr) :: case

      case = c_null_ptr
      c_create = c_read_case(namelist, c_null_ptr, case, message, size)
      if (c_create == 0) c_create = c_create_from_case(case, t_begin, peak, handle, message, size)
      call c_destroy_case(case)
   end function c_create

   !> `rwmf_create_from_case`.
   integer(c_int) function c_create_from_case(from, t_begin, peak, handle, message, size) &
      bind(c, name='rwmf_create_from_case')
      type(c_ptr), value :: from
      real(c_double), value :: t_begin
      !! [s]
      real(c_double), value :: peak
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(kept_case_t), pointer :: kept
      type(stepping_t), pointer :: wall
      type(error_t), allocatable :: error

      call require_empty(handle, 'wall', error)
      call case_of(from, kept, error)
      call require_number(peak, 'peak', any_number, error)
      if (.not. allocated(error)) then
         allocate (wall)
         if (peak > 0) then
            call create_stepping(wall, kept%case, error, t_begin, peak)
         else
            call create_stepping(wall, kept%case, error, t_begin)
         end if
         call name_file(kept, error)
         if (allocated(error)) then
            deallocate (wall)
         else
            handle = c_loc(wall)
         end if
      end if
      c_create_from_case = put_message(error, message, size)
   end function c_create_from_case

   !> `rwmf_destroy`.
   subroutine c_destroy(handle) bind(c, name='rwmf_destroy')
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr) :: address
      type(stepping_t), pointer :: wall

      address = take_handle(handle)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, wall)
      call destroy_stepping(wall)
      deallocate (wall)
   end subroutine c_destroy

   !> `rwmf_advance`.
   integer(c_int) function c_advance(handle, t, message, size) bind(c, name='rwmf_advance')
      type(c_ptr), value :: handle
      real(c_double), value :: t
      !! [s]
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      call advance_stepping(wall, t, error)
      c_advance = put_message(error, message, size)
   end function c_advance

   !> `rwmf_advance_samples`.
   integer(c_int) function c_advance_samples(handle, n, t, a, message, size) &
      bind(c, name='rwmf_advance_samples')
      type(c_ptr), value :: handle
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional :: t(n)
      !! [s]
      real(c_double), intent(in), optional :: a(n)
      !! [m/s2]
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      call require_argument(present(t), 'times', error)
      call require_argument(present(a), 'accelerations', error)
      if (.not. allocated(error) .and. (n < 2 .or. n > huge(1))) then
         call fail(error, err_input, 'the number of samples must be >= 2 and < 2**31')
      end if
      if (.not. allocated(error)) call advance_stepping(wall, t, a, error)
      c_advance_samples = put_message(error, message, size)
   end function c_advance_samples

   !> `rwmf_advance_ground`.
   integer(c_int) function c_advance_ground(handle, t, compute, data, message, size) &
      bind(c, name='rwmf_advance_ground')
      type(c_ptr), value :: handle
      real(c_double), value :: t
      !! [s]
      type(c_funptr), value :: compute
      type(c_ptr), value :: data
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(c_ground_t) :: ground
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      if (.not. c_associated(compute)) then
         call fail(error, err_input, 'the function for the ground acceleration is NULL')
      else
         call c_f_procpointer(compute, ground%compute)
         ground%data = data
         call advance_stepping(wall, t, ground, error)
      end if
      c_advance_ground = put_message(error, message, size)
   end function c_advance_ground

   !> `rwmf_query_state`.
   integer(c_int) function c_query_state(handle, state, message, size) &
      bind(c, name='rwmf_query_state')
      type(c_ptr), value :: handle
      type(c_state_t), intent(inout), optional :: state
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_state_t) :: found
      type(error_t), allocatable :: error

      call require_argument(present(state), 'state', error)
      if (.not. allocated(error)) call query_state(wall_of(handle), found, error)
      if (.not. allocated(error)) then
         state = c_state_t(found%t, found%theta, found%theta_dot, found%theta_ddot, found%u_s, &
            found%u_s_dot, found%u_s_ddot, found%u_s_max, found%theta_max, found%impacts, &
            found%lift_offs, found%steps, merge(1_c_int32_t, 0_c_int32_t, found%at_rest), &
            merge(1_c_int32_t, 0_c_int32_t, found%overturned))
      end if
      c_query_state = put_message(error, message, size)
   end function c_query_state

   !> `rwmf_query_ending`.
   integer(c_int) function c_query_ending(handle, ending, message, size) &
      bind(c, name='rwmf_query_ending')
      type(c_ptr), value :: handle
      type(c_ending_t), intent(inout), optional :: ending
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_state_t) :: found
      type(error_t), allocatable :: error

      call require_argument(present(ending), 'ending', error)
      if (.not. allocated(error)) call query_state(wall_of(handle), found, error)
      if (.not. allocated(error)) ending = ending_of(found%t, found%overturned, found%collapsed)
      c_query_ending = put_message(error, message, size)
   end function c_query_ending

   !> `rwmf_query_forces`.
   integer(c_int) function c_query_forces(handle, forces, message, size) &
      bind(c, name='rwmf_query_forces')
      type(c_ptr), value :: handle
      type(c_forces_t), intent(inout), optional :: forces
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_forces_t) :: found
      type(error_t), allocatable :: error

      call require_argument(present(forces), 'forces', error)
      if (.not. allocated(error)) call query_forces(wall_of(handle), found, error)
      if (.not. allocated(error)) forces = c_forces_t(found%link, found%frame_shear, found%cable)
      c_query_forces = put_message(error, message, size)
   end function c_query_forces

   !> `rwmf_query_events`.
   integer(c_int) function c_query_events(handle, capacity, events, count, message, size) &
      bind(c, name='rwmf_query_events')
      type(c_ptr), value :: handle
      integer(c_size_t), value :: capacity
      type(c_ptr), value :: events
      integer(c_size_t), intent(inout), optional :: count
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(c_event_t), pointer :: places(:)
      type(event_t), allocatable :: found(:)
      type(error_t), allocatable :: error
      integer(c_size_t) :: i

      call require_argument(present(count), 'count', error)
      ! a host that only counts the events needs no buffer
      if (capacity /= 0) call require_argument(c_associated(events), 'events', error)
      if (.not. allocated(error)) call query_events(wall_of(handle), found, error)
      if (.not. allocated(error)) then
         count = ubound(found, 1, c_size_t)
         ! a size_t beyond the largest integer of Fortran is negative and exceeds the number of
         ! events
         call c_f_pointer(events, places, [merge(count, min(capacity, count), capacity < 0)])
         do i = 1, ubound(places, 1, c_size_t)
            places(i) = c_event_t(found(i)%t, found(i)%theta, found(i)%theta_dot, &
               int(found(i)%kind, c_int32_t))
         end do
      end if
      c_query_events = put_message(error, message, size)
   end function c_query_events

   !> `rwmf_save`.
   integer(c_int) function c_save(handle, snapshot, message, size) bind(c, name='rwmf_save')
      type(c_ptr), value :: handle
      type(c_ptr), intent(inout), optional :: snapshot
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(snapshot_t), pointer :: kept
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      call require(wall, error)
      call require_argument(present(snapshot), 'snapshot', error)
      if (.not. allocated(error)) then
         if (.not. c_associated(snapshot)) then
            allocate (kept)
            snapshot = c_loc(kept)
         end if
         call c_f_pointer(snapshot, kept)
         call save_stepping(wall, kept, error)
      end if
      c_save = put_message(error, message, size)
   end function c_save

   !> `rwmf_restore`.
   integer(c_int) function c_restore(handle, snapshot, message, size) bind(c, name='rwmf_restore')
      type(c_ptr), value :: handle
      type(c_ptr), value :: snapshot
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(stepping_t) :: wall
      type(snapshot_t), pointer :: kept
      type(error_t), allocatable :: error

      wall = wall_of(handle)
      if (.not. c_associated(snapshot)) then
         call fail(error, err_input, 'the snapshot is NULL')
      else
         call c_f_pointer(snapshot, kept)
         call restore_stepping(wall, kept, error)
      end if
      c_restore = put_message(error, message, size)
   end function c_restore

   !> `rwmf_destroy_snapshot`.
   subroutine c_destroy_snapshot(snapshot) bind(c, name='rwmf_destroy_snapshot')
      type(c_ptr), intent(inout), optional :: snapshot
      type(c_ptr) :: address
      type(snapshot_t), pointer :: kept

      address = take_handle(snapshot)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, kept)
      deallocate (kept)
   end subroutine c_destroy_snapshot

end module rwmf_bindings_c_stepping
