!> The wall as a member: forces of the kernel along a run, tangents, commit and revert, events,
!> impacts, a host program that integrates frame and member.
program test_member
   use check, only: checks_t
   use member_cases, only: leaning, member_case, member_case_count, member_case_name
   use rwmf, only: case_t, create_member, error_t, link_motion_t, member_response_t, &
      query_links, read_case_text, respond_member, wall_member_t, wp
   use rwmf, only: advance_stepping, create_stepping, destroy_stepping, event_impact, &
      event_lift_off, event_peak, event_rest, event_t, query_events, stepping_t
   use rwmf, only: commit_member, place_member
   use rwmf_model_assembly, only: rates_at
   use rwmf_model_bent_wall, only: forces_of_linked_floors
   use rwmf_model_effects_storeys_shear_building, only: link_pulls
   use rwmf_model_equation, only: equation_t, frame_acceleration, frame_motion, ground, &
      kinematics_at, straight_displacement, vertical_ground
   use rwmf_model_reactions, only: link_force
   use rwmf_simulation_hybrid_state, only: has_ended, is_at_rest
   implicit none

   real(wp), parameter :: m_w = 2.0e4_wp, g = 9.81_wp
   type(checks_t) :: checks
   integer :: i

   do i = 1, member_case_count
      if (checks%wants('forces, '//member_case_name(i))) call test_forces(i)
   end do
   call checks%finish()

contains

   !> Follow a run of the kernel with a member: on every motion of the wall, its forces balance those
   !> of the kernel's links, to 1e-9 of the weight.
   subroutine test_forces(number)
      integer, intent(in) :: number
      type(case_t) :: case
      type(stepping_t) :: wall
      type(wall_member_t) :: member
      type(error_t), allocatable :: error
      real(wp) :: largest
      integer :: k, compared

      call read_case_text(member_case(number, leaning), '', case, error)
      call checks%no_error(error, 'case '//member_case_name(number))
      call create_stepping(wall, case, error)
      call checks%no_error(error, 'stepping wall '//member_case_name(number))
      call create_member(member, case, error)
      call checks%no_error(error, 'member '//member_case_name(number))
      call place(member, 1)
      call move(member, wall%instance%hybrid%y(1))
      largest = 0
      compared = 0
      do k = 1, 400
         call advance_stepping(wall, k*0.005_wp, error)
         call checks%no_error(error, 'advance')
         call follow_events(wall, member)
         if (has_ended(wall%instance%hybrid)) exit
         if (is_at_rest(wall%instance%hybrid) .and. wall%instance%equation%beam%n == 0) cycle
         call compare(wall, member, largest)
         compared = compared + 1
      end do
      call checks%that(compared > 50, member_case_name(number)//': instants compared')
      call checks%close_to(largest, 0.0_wp, member_case_name(number)//': forces', &
         atol=1.0e-9_wp*m_w*g)
      call destroy_stepping(wall)
   end subroutine test_forces

   !> Set the side, which has no effect on a hinged wall.
   subroutine place(member, side)
      type(wall_member_t), intent(inout) :: member
      integer, intent(in) :: side
      type(error_t), allocatable :: error

      if (member%equation%has_impacts) call place_member(member, side, error)
      call checks%no_error(error, 'side')
   end subroutine place

   !> Commit the peaks of the last advance, and change sides at its impacts.
   subroutine follow_events(wall, member)
      type(stepping_t), intent(in) :: wall
      type(wall_member_t), intent(inout) :: member
      type(event_t), allocatable :: events(:)
      type(error_t), allocatable :: error
      integer :: k

      call query_events(wall, events, error)
      do k = 1, size(events)
         select case (events(k)%kind)
         case (event_peak)
            call move(member, events(k)%theta)
         case (event_impact)
            call move(member, 0.0_wp)
            call place(member, -member%committed%side)
         case (event_lift_off)
            call place(member, merge(1, -1, later_side(wall, events, k) > 0))
         case (event_rest)
            call place(member, 0)
         case default
            ! the member finds ends of branches by itself
         end select
      end do
   end subroutine follow_events

   !> Side after a lift-off: that of the next peak, or of the wall.
   integer function later_side(wall, events, k) result(side)
      type(stepping_t), intent(in) :: wall
      type(event_t), intent(in) :: events(:)
      integer, intent(in) :: k
      integer :: j

      side = wall%instance%equation%state%side
      do j = size(events), k + 1, -1
         if (events(j)%kind == event_impact) side = -side
      end do
   end function later_side

   !> Commit a rotation.
   subroutine move(member, theta)
      type(wall_member_t), intent(inout) :: member
      real(wp), intent(in) :: theta
      type(member_response_t) :: response
      type(error_t), allocatable :: error
      real(wp) :: motion(member%n, 3)

      motion = 0
      motion(1, 1) = straight_displacement(member%equation, member%committed%side, theta)
      call respond_member(member, motion, [0.0_wp, 0.0_wp], response, error, has_tangents=.false.)
      call checks%no_error(error, 'move')
      call commit_member(member, error)
   end subroutine move

   !> Compare at the present motion of the wall.
   subroutine compare(wall, member, largest)
      type(stepping_t), intent(in) :: wall
      type(wall_member_t), intent(inout) :: member
      real(wp), intent(inout) :: largest
      type(member_response_t) :: response
      type(link_motion_t) :: links
      type(equation_t) :: roof
      type(error_t), allocatable :: error
      real(wp) :: motion(member%n, 3), force(member%n)
      real(wp), allocatable :: y_dot(:), pull(:)
      real(wp) :: link(2)
      integer :: s, n

      associate (equation => wall%instance%equation, y => wall%instance%hybrid%y, &
                 t => wall%instance%t)
         allocate (y_dot(size(y)))
         call rates_at(equation, t, y, y_dot)
         s = equation%state%side
         n = equation%beam%n
         ! the straight wall alone
         associate (kin => kinematics_at(equation, y(1)), R => equation%p%R)
            motion(1, :) = [straight_displacement(equation, s, y(1)), R*kin%j*y(2), &
               R*(s*kin%k*y(2)**2 + kin%j*y_dot(2))]
         end associate
         associate (first => equation%beam%first)
            if (n > 0) motion(2:n + 1, :) = reshape([y(first:first + n - 1), y(first + n:first + 2*n &
               - 1), y_dot(first + n:first + 2*n - 1)], [n, 3])
         end associate
         associate (first => equation%floors%first, floors => size(motion, 1) - n - 1)
            if (floors > 0) motion(n + 2:, :) = reshape([y(first:first + floors - 1), &
               y(first + floors:first + 2*floors - 1), y_dot(first + floors:first + 2*floors - 1)], &
               [floors, 3])
         end associate
         call respond_member(member, motion, [ground(equation, t), 0.0_wp], response, error)
         call checks%no_error(error, 'response')
         if (allocated(error)) return
         call commit_member(member, error)
         call query_links(member, motion, links, error)
         ! by virtual work of the links
         if (allocated(equation%floors%k_link)) then
            force = 0
            force(n + 2:) = -link_pulls(equation, y)
         else if (allocated(equation%beam%floors)) then
            pull = forces_of_linked_floors(equation, t, y, y_dot)
            force = matmul(pull, links%derivatives)
         else
            roof = equation
            roof%floors%are_linked = .false.
            link = link_force(roof, kinematics_at(roof, y(1)), t, y, y_dot)
            ! links of every floor: as a single force on u
            force(1) = link(1)
            if (n > 0) force = link(1)*links%derivatives(1, :)
         end if
         force = m_w*force
         if (is_at_rest(wall%instance%hybrid)) force(1) = 0
         largest = max(largest, maxval(abs(response%force - force)))
      end associate
   end subroutine compare

end program test_member
