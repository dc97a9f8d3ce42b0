program embedding
   use rwmf, only: case_t, error_t, read_case_text, result_t, simulate
   implicit none
   character(*), parameter :: text = &
      "&wall h = 2.0, b = 0.5 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&impact rule = 'coupled' /"//new_line('a')// &
      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')// &
      "&solver t_end = 10.0 /"
   type(case_t) :: case
   type(result_t) :: result
   type(error_t), allocatable :: error

   call read_case_text(text, '', case, error)
   if (.not. allocated(error)) call simulate(case, result, error)
   if (allocated(error)) then
      print '(a)', error%message
      stop 1
   end if
   print '(a, f9.6, a, i0, a)', 'u_s_max = ', result%u_s_max, ' m, ', result%impacts, ' impacts'
end program embedding
