!> Standard calls of a host; `tools/counts` counts their instructions (docs/developer/bench.md).
!>
!>    standard_calls KIND NAME FILE [KIND NAME FILE ...]
!>
!> KIND is `run`, `spectrum`, `stepping` or `element`. FILE is a case; reading it is not counted.
!> Every call is first made once uncounted, to exclude the work of a first call.
!> The first line of the output is the instruction set of the lanes; one line per call follows.
program standard_calls
   use, intrinsic :: iso_c_binding, only: c_loc, c_null_char, c_ptr
   use rwmf, only: advance_stepping, case_t, compute_spectrum, create_element, create_stepping, &
      destroy_stepping, element_response_t, error_t, instruction_set, next_impact, &
      query_state, read_case_file, respond, result_t, simulate, spectrum_t, stepping_t, &
      wall_element_t, wall_state_t, wp
   implicit none

   interface
      subroutine begin_count() bind(c, name='rwmf_begin_count')
         implicit none
      end subroutine begin_count

      subroutine end_count(name) bind(c, name='rwmf_end_count')
         import :: c_ptr
         implicit none
         type(c_ptr), value :: name
         !! text that ends with a null
      end subroutine end_count
   end interface

   integer :: i

   print '(a)', trim(instruction_set())
   do i = 1, command_argument_count() - 2, 3
      call count_call(argument(i), argument(i + 1), argument(i + 2))
   end do

contains

   function argument(i) result(text)
      integer, intent(in) :: i
      character(512) :: text

      call get_command_argument(i, text)
   end function argument

   subroutine count_call(kind, name, file)
      character(*), intent(in) :: kind
      character(*), intent(in) :: name
      character(*), intent(in) :: file
      character(64), target :: label
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: answer
      !! number that depends on everything that the call computes

      call read_case_file(trim(file), case, error)
      call check(error)
      call make_call(kind, case, answer)
      call begin_count()
      call make_call(kind, case, answer)
      label = trim(name)//c_null_char
      call end_count(c_loc(label))
      print '(2a, es24.16)', trim(name), ' ', answer
   end subroutine count_call

   subroutine make_call(kind, case, answer)
      character(*), intent(in) :: kind
      type(case_t), intent(in) :: case
      real(wp), intent(out) :: answer

      select case (kind)
      case ('run')
         call run(case, answer)
      case ('spectrum')
         call fill_spectrum(case, answer)
      case ('stepping')
         call step_through(case, answer)
      case ('element')
         call ask_element(case, answer)
      case default
         error stop 'standard_calls: no such kind of call'
      end select
   end subroutine make_call

   subroutine run(case, answer)
      type(case_t), intent(in) :: case
      real(wp), intent(out) :: answer
      !! largest |u_s| [m]
      type(result_t) :: result
      type(error_t), allocatable :: error

      call simulate(case, result, error)
      call check(error)
      answer = result%u_s_max
   end subroutine run

   subroutine fill_spectrum(case, answer)
      type(case_t), intent(in) :: case
      real(wp), intent(out) :: answer
      !! sum of the ordinates [m]
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error

      call compute_spectrum(case, 1, spectrum, error)
      call check(error)
      answer = sum(spectrum%values)
   end subroutine fill_spectrum

   !> Advance a wall by 200 host steps of 0.02 s.
   subroutine step_through(case, answer)
      type(case_t), intent(in) :: case
      real(wp), intent(out) :: answer
      !! displacement at the end [m]
      real(wp), parameter :: dt = 0.02_wp
      type(stepping_t) :: wall
      type(wall_state_t) :: state
      type(error_t), allocatable :: error
      integer :: k

      call create_stepping(wall, case, error)
      do k = 1, 200
         call check(error)
         call advance_stepping(wall, [k - 1, k]*dt, 4*sin(6*[k - 1, k]*dt), error)
      end do
      call check(error)
      call query_state(wall, state, error)
      call check(error)
      answer = state%u_s
      call destroy_stepping(wall)
   end subroutine step_through

   !> Evaluate 1000 host steps: response with tangent, and the instant of an impact.
   subroutine ask_element(case, answer)
      type(case_t), intent(in) :: case
      real(wp), intent(out) :: answer
      !! sum of forces and instants [N], [s]
      type(wall_element_t) :: element
      type(element_response_t) :: response
      type(error_t), allocatable :: error
      real(wp) :: u
      real(wp) :: tau
      logical :: found
      integer :: k

      call create_element(element, case, error)
      call check(error)
      answer = 0
      do k = 1, 1000
         u = 0.0002_wp*k
         call respond(element, 1, u, -0.5_wp, 2.0_wp, 1.0_wp, response, error)
         call check(error)
         call next_impact(1, 0.02_wp, 0.05_wp*u, -0.5_wp, 0.05_wp*u - 0.01_wp, -0.5_wp, found, tau)
         answer = answer + response%force + tau
      end do
   end subroutine ask_element

   subroutine check(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      print '(a)', error%message
      error stop 'standard_calls: a call failed'
   end subroutine check
end program standard_calls
