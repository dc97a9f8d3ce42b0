!> Many cases in one call: two hundred walls, each with its own width and tendon, under one motion.
program many_rows
   use rwmf, only: case_t, compute_rows, error_t, read_case_text, spectrum_t, status_of, wp
   implicit none
   integer, parameter :: n = 200
   character(*), parameter :: text = &
      "&wall h = 2.0, b = 0.5 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&cable eta_0 = 1.0 /"//new_line('a')// &
      "&impact rule = 'coupled' /"//new_line('a')// &
      "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')// &
      "&solver method = 'dop853', t_end = 5.0 /"
   type(case_t) :: case
   type(spectrum_t) :: found
   type(error_t), allocatable :: error
   real(wp) :: values(3, n)
   integer :: i

   do i = 1, n
      values(:, i) = [0.3_wp + 0.002_wp*i, 0.01_wp*i, 1.0_wp + 0.005_wp*i]
   end do
   call read_case_text(text, '', case, error)
   ! a column of `values` is a row of the table: b [m], eta_0 [-], factor on the motion [-]
   if (.not. allocated(error)) call compute_rows(case, [character(11) :: 'wall.b', 'cable.eta_0', &
      'scale'], values, [character(20) :: 'u_s_max_m', 'theta_max_over_alpha'], 0, found, error)
   if (allocated(error)) then
      print '(a)', error%message
      stop 1
   end if
   ! (rows, 1, 1, quantities); a row that the rules of the case refuse, or that fails, is NaN
   associate (u_s_max => found%values(:, 1, 1, 1), rotation => found%values(:, 1, 1, 2), &
      status => status_of(found))
      print '(2(i0, a), 2(f9.6, a))', count(status == 'ok'), ' of ', n, ' rows: u_s_max up to ', &
         maxval(u_s_max), ' m, theta/alpha up to ', maxval(rotation)
   end associate
end program many_rows
