!> Ground motion of the host.
module motion
   use, intrinsic :: iso_c_binding, only: c_double, c_ptr
   implicit none
   private

   public :: ground

contains

   !> Ground acceleration at the time t [m/s2].
   real(c_double) function ground(t, data) bind(c)
      real(c_double), value :: t !< time [s]
      type(c_ptr), value :: data !< unused

      ground = 4.0_c_double*sin(6.283_c_double*t)
   end function ground

end module motion

!> Host of another Fortran compiler: one simulation, and one step of a wall under a ground motion.
program host
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funloc, c_int, c_null_char, &
      c_null_ptr, c_ptr, c_size_t
   use motion, only: ground
   use rwmf_c, only: RWMF_INPUT, rwmf_advance_ground, rwmf_create, rwmf_destroy, &
      rwmf_query_state, rwmf_result, rwmf_run, rwmf_state, rwmf_version
   implicit none
   integer(c_size_t), parameter :: room = 200
   character(*), parameter :: text = &
      "&wall h = 2.0, b = 0.5 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')//"&solver t_end = 3.0 /"//c_null_char
   type(rwmf_result) :: result
   type(rwmf_state) :: state
   type(c_ptr) :: wall
   character(kind=c_char, len=room) :: message, version

   call check(rwmf_run(text, result, message, room))
   wall = c_null_ptr
   call check(rwmf_create(text, 0.0_c_double, 4.0_c_double, wall, message, room))
   call check(rwmf_advance_ground(wall, 0.2_c_double, c_funloc(ground), c_null_ptr, message, room))
   call check(rwmf_query_state(wall, state, message, room))
   call rwmf_destroy(wall)
   if (state%u_s >= 0.0_c_double) error stop 2
   ! a fault has a number and, if the host wants it, a message
   if (rwmf_run('&wall h = 2.0 /'//c_null_char, result, size=0_c_size_t) /= RWMF_INPUT) error stop 3
   call rwmf_version(version, room)
   print '(3a, f9.6, a)', 'rwmf ', until_null(version), ': ', result%u_s_max, ' m'

contains

   !> Stop with the message of a call that has failed.
   subroutine check(status)
      integer(c_int), intent(in) :: status !< result of the call

      if (status == 0) return
      print '(a)', until_null(message)
      error stop 1
   end subroutine check

   !> Text before its end in C.
   function until_null(text) result(found)
      character(kind=c_char, len=*), intent(in) :: text !< with a null character
      character(:), allocatable :: found !< without it

      found = text(:index(text, c_null_char) - 1)
   end function until_null

end program host
