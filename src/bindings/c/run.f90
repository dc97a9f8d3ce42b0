!> C binding of a whole simulation (include/rwmf.h).
module rwmf_bindings_c_run
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int32_t, c_int64_t, c_null_ptr, &
      c_ptr, c_size_t
   use rwmf_bindings_c_case, only: c_destroy_case, c_read_case, case_of, kept_case_t, name_file
   use rwmf_bindings_c_pointers, only: require_argument
   use rwmf_bindings_c_strings, only: put_message, put_text
   use rwmf_core_error, only: error_t
   use rwmf_core_version, only: version
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   implicit none
   private

   public :: c_version, c_run, c_run_case, c_run_case_ending
   public :: c_ending_t, ending_of

   !> `rwmf_result` of the header.
   type, bind(c) :: c_result_t
      real(c_double) :: u_s_max
      real(c_double) :: theta_max
      real(c_double) :: theta_dot_max
      real(c_double) :: cable_increment_max
      real(c_double) :: t_end
      integer(c_int64_t) :: impacts
      integer(c_int64_t) :: lift_offs
      integer(c_int64_t) :: steps
      integer(c_int32_t) :: overturned
   end type c_result_t

   !> `rwmf_ending` of the header.
   type, bind(c) :: c_ending_t
      real(c_double) :: t
      integer(c_int32_t) :: overturned
      integer(c_int32_t) :: collapsed
   end type c_ending_t

contains

   !> `rwmf_version`.
   subroutine c_version(text, size) bind(c, name='rwmf_version')
      type(c_ptr), value :: text
      integer(c_size_t), value :: size

      call put_text(version, text, size)
   end subroutine c_version

   !> `rwmf_run`.
   integer(c_int) function c_run(namelist, result, message, size) bind(c, name='rwmf_run')
      type(c_ptr), value :: namelist
      type(c_result_t), intent(inout), optional :: result
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(c_ptr) :: case

      case = c_null_ptr
      c_run = c_read_case(namelist, c_null_ptr, case, message, size)
      if (c_run == 0) c_run = c_run_case(case, result, message, size)
      call c_destroy_case(case)
   end function c_run

   !> `rwmf_run_case`.
   integer(c_int) function c_run_case(handle, result, message, size) bind(c, name='rwmf_run_case')
      type(c_ptr), value :: handle
      type(c_result_t), intent(inout), optional :: result
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(result_t) :: found
      type(error_t), allocatable :: error

      call run_into(handle, result, found, error)
      c_run_case = put_message(error, message, size)
   end function c_run_case

   !> `rwmf_run_case_ending`.
   integer(c_int) function c_run_case_ending(handle, result, ending, message, size) &
      bind(c, name='rwmf_run_case_ending')
      type(c_ptr), value :: handle
      type(c_result_t), intent(inout), optional :: result
      type(c_ending_t), intent(inout), optional :: ending
      type(c_ptr), value :: message
      integer(c_size_t), value :: size
      type(result_t) :: found
      type(error_t), allocatable :: error

      call require_argument(present(ending), 'ending', error)
      call run_into(handle, result, found, error)
      if (.not. allocated(error)) then
         ending = ending_of(found%t_end, found%overturned, allocated(found%t_collapse))
      end if
      c_run_case_ending = put_message(error, message, size)
   end function c_run_case_ending

   !> Return how a motion has ended by a time [s].
   pure type(c_ending_t) function ending_of(t, overturned, collapsed)
      real(c_double), intent(in) :: t
      !! [s]
      logical, intent(in) :: overturned
      !! the wall overturned
      logical, intent(in) :: collapsed
      !! the frame or a storey exceeded its drift limit

      ending_of = c_ending_t(t, merge(1_c_int32_t, 0_c_int32_t, overturned), &
         merge(1_c_int32_t, 0_c_int32_t, collapsed))
   end function ending_of

   !> Run a case and fill the caller's result, unless an earlier check failed.
   subroutine run_into(handle, result, found, error)
      type(c_ptr), intent(in) :: handle
      type(c_result_t), intent(inout), optional :: result
      type(result_t), intent(out) :: found
      type(error_t), allocatable, intent(inout) :: error
      type(kept_case_t), pointer :: kept

      call case_of(handle, kept, error)
      call require_argument(present(result), 'result', error)
      if (allocated(error)) return
      call simulate(kept%case, found, error)
      call name_file(kept, error)
      if (allocated(error)) return
      call fill_result(found, result)
   end subroutine run_into

   subroutine fill_result(found, result)
      type(result_t), intent(in) :: found
      type(c_result_t), intent(out) :: result
      real(c_double) :: nan

      nan = ieee_value(nan, ieee_quiet_nan)
      result = c_result_t(nan, nan, nan, nan, found%t_end, found%impacts, found%lift_offs, &
         found%steps, merge(1_c_int32_t, 0_c_int32_t, found%overturned))
      if (allocated(found%u_s_max)) result%u_s_max = found%u_s_max
      if (allocated(found%theta_max)) result%theta_max = max(found%theta_max, -found%theta_min)
      if (allocated(found%theta_dot_max)) result%theta_dot_max = found%theta_dot_max
      if (allocated(found%cable_increment_max)) then
         result%cable_increment_max = found%cable_increment_max
      end if
   end subroutine fill_result

end module rwmf_bindings_c_run
