!> C binding of the wall as an element (include/rwmf.h).
!>
!> Query functions return their result directly; on error they return a status code outside the
!> range of valid results.
module rwmf_bindings_c_element
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, &
      c_loc, c_ptr, c_size_t
   use rwmf_bindings_c_case, only: case_of, kept_case_t, name_file, read_host_case
   use rwmf_bindings_c_pointers, only: require_argument, require_empty, take_handle
   use rwmf_bindings_c_strings, only: put_message
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_embedding_element, only: create_element, element_response_t, next_impact, &
      next_lift_off, respond, settles, velocity_factor, wall_element_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: c_create_element, c_create_element_from_case, c_destroy_element, c_respond
   public :: c_velocity_factor, c_next_impact, c_next_lift_off, c_settles

   !> `rwmf_response` of the header.
   type, bind(c) :: c_response_t
      real(c_double) :: force
      real(c_double) :: stiffness
      real(c_double) :: damping
      real(c_double) :: mass
      real(c_double) :: theta
      real(c_double) :: theta_dot
      real(c_double) :: theta_ddot
      real(c_double) :: cable
   end type c_response_t

contains

   !> `rwmf_create_element`.
   integer(c_int) function c_create_element(namelist, handle, message, size) &
      bind(c, name='rwmf_create_element')
      type(c_ptr), value :: namelist
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(case_t) :: case
      type(error_t), allocatable :: error

      call require_empty(handle, 'element', error)
      if (.not. allocated(error)) call read_host_case(namelist, case, error)
      if (.not. allocated(error)) call make_element(case, handle, error)
      c_create_element = put_message(error, message, size)
   end function c_create_element

   !> `rwmf_create_element_from_case`.
   integer(c_int) function c_create_element_from_case(from, handle, message, size) &
      bind(c, name='rwmf_create_element_from_case')
      type(c_ptr), value :: from
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(kept_case_t), pointer :: kept
      type(error_t), allocatable :: error

      call require_empty(handle, 'element', error)
      call case_of(from, kept, error)
      if (.not. allocated(error)) then
         call make_element(kept%case, handle, error)
         call name_file(kept, error)
      end if
      c_create_element_from_case = put_message(error, message, size)
   end function c_create_element_from_case

   !> Make an element on the heap.
   subroutine make_element(case, handle, error)
      type(case_t), intent(in) :: case
      type(c_ptr), intent(inout) :: handle
      type(error_t), allocatable, intent(out) :: error
      type(wall_element_t), pointer :: element

      allocate (element)
      call create_element(element, case, error)
      if (allocated(error)) then
         deallocate (element)
      else
         handle = c_loc(element)
      end if
   end subroutine make_element

   !> `rwmf_destroy_element`.
   subroutine c_destroy_element(handle) bind(c, name='rwmf_destroy_element')
      type(c_ptr), intent(inout), optional :: handle
      type(c_ptr) :: address
      type(wall_element_t), pointer :: element

      address = take_handle(handle)
      if (.not. c_associated(address)) return
      call c_f_pointer(address, element)
      deallocate (element)
   end subroutine c_destroy_element

   !> Return the element behind a handle. An earlier `error` is kept.
   subroutine element_of(handle, element, error)
      type(c_ptr), intent(in) :: handle
      type(wall_element_t), pointer, intent(out) :: element
      type(error_t), allocatable, intent(inout) :: error
      !! the handle is NULL

      nullify (element)
      if (allocated(error)) return
      if (c_associated(handle)) then
         call c_f_pointer(handle, element)
      else
         call fail(error, err_input, 'no element: the handle is NULL')
      end if
   end subroutine element_of

   !> `rwmf_respond`.
   integer(c_int) function c_respond(handle, side, u, u_dot, u_ddot, u_g_ddot, response, message, &
      size) bind(c, name='rwmf_respond')
      type(c_ptr), value :: handle
      integer(c_int), value :: side
      real(c_double), value :: u
      real(c_double), value :: u_dot
      real(c_double), value :: u_ddot
      real(c_double), value :: u_g_ddot
      type(c_response_t), intent(inout), optional :: response
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(wall_element_t), pointer :: element
      type(element_response_t) :: found
      type(error_t), allocatable :: error

      call element_of(handle, element, error)
      call require_argument(present(response), 'response', error)
      if (.not. allocated(error)) then
         call respond(element, int(side), u, u_dot, u_ddot, u_g_ddot, found, error)
      end if
      if (.not. allocated(error)) then
         response = c_response_t(found%force, found%stiffness, found%damping, found%mass, &
            found%theta, found%theta_dot, found%theta_ddot, found%cable)
      end if
      c_respond = put_message(error, message, size)
   end function c_respond

   !> `rwmf_velocity_factor`.
   real(c_double) function c_velocity_factor(handle) bind(c, name='rwmf_velocity_factor')
      type(c_ptr), value :: handle
      type(wall_element_t), pointer :: element
      type(wall_element_t) :: none
      type(error_t), allocatable :: error

      call element_of(handle, element, error)
      if (allocated(error)) then
         c_velocity_factor = velocity_factor(none)
      else
         c_velocity_factor = velocity_factor(element)
      end if
   end function c_velocity_factor

   !> `rwmf_next_impact`.
   integer(c_int) function c_next_impact(side, dt, u_0, u_dot_0, u_1, u_dot_1, tau) &
      bind(c, name='rwmf_next_impact')
      integer(c_int), value :: side
      real(c_double), value :: dt
      real(c_double), value :: u_0
      real(c_double), value :: u_dot_0
      real(c_double), value :: u_1
      real(c_double), value :: u_dot_1
      real(c_double), intent(inout), optional :: tau
      real(c_double) :: found_tau
      type(error_t), allocatable :: error
      logical :: found

      found = .false.
      call require_argument(present(tau), 'time', error)
      if (.not. allocated(error)) then
         call next_impact(int(side), dt, u_0, u_dot_0, u_1, u_dot_1, found, found_tau, error)
      end if
      c_next_impact = answer(merge(1, 0, found), error)
      if (.not. allocated(error)) tau = found_tau
   end function c_next_impact

   !> `rwmf_next_lift_off`.
   integer(c_int) function c_next_lift_off(handle, dt, push_0, push_1, u_g_ddot_0, u_g_ddot_1, &
      tau) bind(c, name='rwmf_next_lift_off')
      type(c_ptr), value :: handle
      real(c_double), value :: dt
      real(c_double), value :: push_0
      real(c_double), value :: push_1
      real(c_double), value :: u_g_ddot_0
      real(c_double), value :: u_g_ddot_1
      real(c_double), intent(inout), optional :: tau
      type(wall_element_t), pointer :: element
      real(c_double) :: found_tau
      type(error_t), allocatable :: error
      integer :: side

      side = 0
      call element_of(handle, element, error)
      call require_argument(present(tau), 'time', error)
      if (.not. allocated(error)) then
         call next_lift_off(element, dt, push_0, push_1, u_g_ddot_0, u_g_ddot_1, side, found_tau, &
            error)
      end if
      c_next_lift_off = answer(side, error)
      if (.not. allocated(error)) tau = found_tau
   end function c_next_lift_off

   !> `rwmf_settles`.
   integer(c_int) function c_settles(handle, dt, u_dot, push, u_g_ddot, host_mass) &
      bind(c, name='rwmf_settles')
      type(c_ptr), value :: handle
      real(c_double), value :: dt
      real(c_double), value :: u_dot
      real(c_double), value :: push
      real(c_double), value :: u_g_ddot
      real(c_double), value :: host_mass
      type(wall_element_t), pointer :: element
      type(error_t), allocatable :: error
      logical :: found

      found = .false.
      call element_of(handle, element, error)
      if (.not. allocated(error)) then
         found = settles(element, dt, u_dot, push, u_g_ddot, host_mass, error)
      end if
      c_settles = answer(merge(1, 0, found), error)
   end function c_settles

   !> Return the result, or the number of the error.
   pure integer(c_int) function answer(found, error)
      integer, intent(in) :: found
      type(error_t), allocatable, intent(in) :: error

      answer = int(found, c_int)
      if (allocated(error)) answer = int(error%stat, c_int)
   end function answer

end module rwmf_bindings_c_element
