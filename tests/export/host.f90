!> Program outside the library: one simulation, and one step of a wall.
program host
   use, intrinsic :: iso_fortran_env, only: real64
   use rwmf, only: advance_stepping, case_t, create_stepping, destroy_stepping, error_t, &
      read_case_text, result_t, simulate, stepping_t, version
   implicit none
   type(case_t) :: case
   type(result_t) :: result
   type(stepping_t) :: wall
   type(error_t), allocatable :: error

   call read_case_text("&wall h = 2.0, b = 0.5 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')//"&solver t_end = 3.0 /", '', case, error)
   if (.not. allocated(error)) call simulate(case, result, error)
   if (.not. allocated(error)) call create_stepping(wall, case, error)
   ! the kinds are explicit: they hold under -fdefault-real-8 as well
   if (.not. allocated(error)) call advance_stepping(wall, [0.0_real64, 0.02_real64], &
      [0.0_real64, 1.0_real64], error)
   call destroy_stepping(wall)
   if (allocated(error)) error stop 1
   if (.not. (result%u_s_max > 0.1_real64 .and. result%u_s_max < 1.0_real64)) error stop 2
   print '(3a, f9.6, a)', 'rwmf ', version, ': ', result%u_s_max, ' m'
end program host
