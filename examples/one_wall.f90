!> A host that advances one wall: a record step by step, steps that it rejects, forces and events.
program one_wall
   use rwmf, only: advance_stepping, case_t, create_stepping, destroy_stepping, error_t, &
      event_name, event_peak, event_t, query_events, query_forces, query_state, read_case_text, &
      restore_stepping, save_stepping, snapshot_t, stepping_t, wall_forces_t, wall_state_t, wp
   implicit none
   character(*), parameter :: text = &
      "&wall h = 2.0, b = 0.5, m_w = 2.0e4 /"//new_line('a')// &
      "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"//new_line('a')// &
      "&impact rule = 'coupled' /"//new_line('a')// &
      "&model formulation = 'exact' /"//new_line('a')// &
      "&solver method = 'dop853', t_end = 2.0 /"
   real(wp), parameter :: dt = 0.02_wp
   type(case_t) :: case
   type(stepping_t) :: wall
   type(snapshot_t) :: before
   type(wall_state_t) :: state
   type(wall_forces_t) :: forces
   type(event_t), allocatable :: events(:)
   type(error_t), allocatable :: error
   integer :: i, j

   call read_case_text(text, '', case, error)
   if (.not. allocated(error)) call create_stepping(wall, case, error)
   do i = 1, 100
      if (allocated(error)) exit
      call save_stepping(wall, before, error)
      ! a trial that the host rejects, then the step itself
      call advance_stepping(wall, [i - 1, i]*dt, [0.0_wp, 9.0_wp], error)
      if (.not. allocated(error)) call restore_stepping(wall, before, error)
      if (allocated(error)) exit
      call advance_stepping(wall, [i - 1, i]*dt, 4*sin(6*[i - 1, i]*dt), error)
      if (.not. allocated(error)) call query_events(wall, events, error)
      if (allocated(error)) exit
      do j = 1, size(events)
         if (events(j)%kind == event_peak) cycle
         print '(f9.6, 2a)', events(j)%t, ' s ', event_name(events(j)%kind)
      end do
   end do
   if (.not. allocated(error)) call query_state(wall, state, error)
   if (.not. allocated(error)) call query_forces(wall, forces, error)
   if (allocated(error)) error stop 1
   print '(a, f9.6, a, f9.1, a)', 'u_s = ', state%u_s, ' m, link force ', forces%link, ' N'
   call destroy_stepping(wall)
end program one_wall
