!> The wall as an element: its response, its impact on the base and its uplift.
program wall_element
   use rwmf, only: case_t, create_element, element_response_t, error_t, next_impact, &
      next_lift_off, read_case_text, respond, velocity_factor, wall_element_t, wp
   implicit none
   type(case_t) :: case
   type(wall_element_t) :: element
   type(element_response_t) :: r
   type(error_t), allocatable :: error
   real(wp) :: tau
   integer :: side
   logical :: found

   call read_case_text("&wall h = 2.0, b = 0.5, m_w = 2.0e4 /"//new_line('a')// &
      "&cable eta_0 = 1.0, eta_alpha = 5.0 /"//new_line('a')// &
      "&impact rule = 'constant', e = 0.9 /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')//"&solver t_end = 1.0 /", '', case, error)
   if (.not. allocated(error)) call create_element(element, case, error)
   ! u = 0.1 m, u' = -0.5 m/s, u'' = 2 m/s2, u_g'' = 1 m/s2, rocking to the right
   if (.not. allocated(error)) call respond(element, 1, 0.1_wp, -0.5_wp, 2.0_wp, 1.0_wp, r, error)
   if (allocated(error)) error stop 1
   print '(4(a, es10.3))', 'force', r%force, '  stiffness', r%stiffness, '  damping', r%damping, &
      '  mass', r%mass
   ! a step of 0.02 s that ends at u = -0.001 m
   call next_impact(1, 0.02_wp, 0.009_wp, -0.5_wp, -0.001_wp, -0.5_wp, found, tau)
   if (found) print '(2(a, f7.4))', 'impact after ', tau, ' s, velocity times ', &
      velocity_factor(element)
   ! at rest, while the host's push on the wall grows from 0 to 100 kN
   call next_lift_off(element, 0.02_wp, 0.0_wp, 1.0e5_wp, 0.0_wp, 0.0_wp, side, tau)
   if (side /= 0) print '(a, f7.4, a, i0)', 'lift-off after ', tau, ' s to side ', side
end program wall_element
