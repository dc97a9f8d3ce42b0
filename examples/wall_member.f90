!> The wall as a member: trial, commit and revert of a wall with fuses, and its impact.
program wall_member
   use rwmf, only: case_t, commit_member, create_member, error_t, event_impact, land_member, &
      member_event_t, member_response_t, next_member_event, place_member, read_case_text, &
      respond_member, revert_member, wall_member_t, wp
   implicit none
   real(wp), parameter :: ground(2) = [1.0_wp, 0.0_wp]
   type(case_t) :: case
   type(wall_member_t) :: wall
   type(member_response_t) :: r
   type(member_event_t) :: event
   type(error_t), allocatable :: error
   real(wp) :: motions(1, 3, 2), velocity(1)

   call read_case_text("&wall h = 2.0, b = 0.5, m_w = 2.0e4 /"//new_line('a')// &
      "&fuse eta_y = 0.3, stroke_y = 0.01 /"//new_line('a')// &
      "&impact rule = 'coupled' /", '', case, error, is_for_host=.true.)
   if (.not. allocated(error)) call create_member(wall, case, error)
   ! a lift-off to the right, then a trial that the host rejects: u = 0.2 m, u' = 0.5 m/s
   if (.not. allocated(error)) call place_member(wall, 1, error)
   if (.not. allocated(error)) call respond_member(wall, &
      reshape([0.2_wp, 0.5_wp, 2.0_wp], [1, 3]), ground, r, error)
   if (.not. allocated(error)) call revert_member(wall, error)
   ! the step that it keeps; the fuse has yielded, so the tangent is that of the yielding fuse
   if (.not. allocated(error)) call respond_member(wall, &
      reshape([0.1_wp, 0.5_wp, 2.0_wp], [1, 3]), ground, r, error)
   if (.not. allocated(error)) call commit_member(wall, error)
   if (allocated(error)) error stop 1
   print '(3(a, es10.3))', 'force', r%force, '  stiffness', r%stiffness, '  fuse', r%fuses(1)
   ! a step of 0.02 s that ends on the other side of the base
   motions(1, :, 1) = [0.009_wp, -0.5_wp, 0.0_wp]
   motions(1, :, 2) = [-0.001_wp, -0.5_wp, 0.0_wp]
   call next_member_event(wall, 0.02_wp, motions, reshape([ground, ground], [2, 2]), &
      [0.0_wp, 0.0_wp], event, error)
   if (allocated(error) .or. event%kind /= event_impact) error stop 1
   ! the host repeats the step up to the impact, at u = 0, and commits it
   call respond_member(wall, reshape([0.0_wp, -0.5_wp, 0.0_wp], [1, 3]), ground, r, error)
   if (.not. allocated(error)) call commit_member(wall, error)
   ! momentum over the host's mass of 100 t
   velocity = -0.5_wp
   if (.not. allocated(error)) call land_member(wall, [0.0_wp], velocity, error, &
      reshape([1.0e5_wp], [1, 1]))
   if (allocated(error)) error stop 1
   print '(2(a, f7.4), a)', 'impact after ', event%tau, ' s, velocity ', velocity(1), ' m/s'
end program wall_member
