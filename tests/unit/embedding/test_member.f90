!> The wall as a member: forces of the kernel along a run, tangents, commit and revert, events,
!> impacts.
program test_member
   use check, only: checks_t
   use member_cases, only: leaning, member_case, member_case_count, member_case_name
   use rwmf, only: case_t, commit_member, create_element, create_member, error_t, i8, land_member, &
      link_motion_t, member_event_t, member_response_t, member_settles, next_member_event, &
      place_member, query_links, read_case_text, respond_member, restart_member, revert_member, &
      velocity_factor, wall_element_t, wall_member_t, wp
   use rwmf, only: advance_stepping, create_stepping, destroy_stepping, event_branch, &
      event_impact, event_lift_off, event_peak, event_rest, event_t, query_events, stepping_t
   use rwmf_model_equation, only: equation_t, ground, kinematics_at, straight_displacement
   use rwmf_model_floors_floor_forces, only: forces_of_linked_floors, link_pulls
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_model_system_reactions, only: link_force
   use rwmf_simulation_state_hybrid_state, only: has_ended, is_at_rest
   implicit none

   real(wp), parameter :: m_w = 2.0e4_wp, g = 9.81_wp
   type(checks_t) :: checks
   integer :: i

   do i = 1, member_case_count
      if (checks%wants('forces, '//member_case_name(i))) call test_forces(i)
      if (checks%wants('tangents, '//member_case_name(i))) call test_tangents(i)
      if (checks%wants('fuzz, '//member_case_name(i))) call test_fuzz(i)
   end do
   if (checks%wants('branch_ends')) call test_branch_ends()
   if (checks%wants('impact_rules')) call test_impact_rules()
   if (checks%wants('host_masses')) call test_host_masses()
   if (checks%wants('events')) call test_events()
   call checks%finish()

contains

   !> Follow a run of the kernel with a member: on every motion of the wall, its forces balance
   !> those of the kernel's links, to 1e-9 of the weight.
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
            if (n > 0) motion(2:n + 1, :) = reshape([y(first:first + n - 1), &
               y(first + n:first + 2*n - 1), y_dot(first + n:first + 2*n - 1)], [n, 3])
         end associate
         associate (first => equation%floors%first, floors => size(motion, 1) - n - 1)
            if (floors > 0) motion(n + 2:, :) = reshape([y(first:first + floors - 1), &
               y(first + floors:first + 2*floors - 1), &
               y_dot(first + floors:first + 2*floors - 1)], [floors, 3])
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

   !> Member of a case. Its springs have moved to a rotation and back, to another branch.
   type(wall_member_t) function member_of(number)
      integer, intent(in) :: number
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(member_case(number, ''), '', case, error, is_for_host=.true.)
      if (.not. allocated(error)) call create_member(member_of, case, error)
      call checks%no_error(error, 'member of '//member_case_name(number))
   end function member_of

   !> Motion of a member with numbers of the size that occurs, different in each degree of freedom.
   pure function motion_of(member, side) result(motion)
      type(wall_member_t), intent(in) :: member
      integer, intent(in) :: side
      real(wp) :: motion(member%n, 3)
      integer :: k

      motion(1, :) = side*[0.15_wp, -0.8_wp, 3.0_wp]
      do k = 2, member%n
         motion(k, :) = [0.02_wp, 0.3_wp, -2.0_wp]*(-1)**k/k
      end do
   end function motion_of

   !> Compare the tangents with central differences of the forces by every number of the motion, on
   !> the elastic branch and after a long way on a later one.
   subroutine test_tangents(number)
      integer, intent(in) :: number
      type(wall_member_t) :: member
      type(member_response_t) :: here, up, down
      type(error_t), allocatable :: error
      real(wp), allocatable :: motion(:, :), other(:, :), slope(:)
      real(wp) :: worst(3)
      real(wp), parameter :: step = 1.0e-5_wp, ground(2) = [1.7_wp, 0.0_wp]
      integer :: side, j, k, way

      worst = 0
      do way = 1, 2
         do side = -1, 1, 2
            member = member_of(number)
            call place(member, side)
            motion = motion_of(member, side)
            ! a way that ends before the trial, so that differences keep its direction
            call move(member, side*merge(0.001_wp, 0.08_wp, way == 1))
            call respond_member(member, motion, ground, here, error)
            call checks%no_error(error, 'response')
            do j = 1, 3
               do k = 1, member%n
                  other = motion
                  other(k, j) = motion(k, j) + step
                  call respond_member(member, other, ground, up, error, has_tangents=.false.)
                  other(k, j) = motion(k, j) - step
                  call respond_member(member, other, ground, down, error, has_tangents=.false.)
                  slope = (up%force - down%force)/(2*step)
                  select case (j)
                  case (1)
                     slope = slope - here%stiffness(:, k)
                  case (2)
                     slope = slope - here%damping(:, k)
                  case default
                     slope = slope - here%mass(:, k)
                  end select
                  worst(j) = max(worst(j), maxval(abs(slope)))
               end do
            end do
            worst(1) = worst(1)/maxval(abs(here%stiffness))
            worst(2) = worst(2)/max(maxval(abs(here%damping)), m_w)
            worst(3) = worst(3)/maxval(abs(here%mass))
         end do
      end do
      ! truncation and round-off of the difference
      call checks%close_to(worst(1), 0.0_wp, member_case_name(number)//': stiffness', &
         atol=1.0e-7_wp)
      call checks%close_to(worst(2), 0.0_wp, member_case_name(number)//': damping', atol=1.0e-7_wp)
      call checks%close_to(worst(3), 0.0_wp, member_case_name(number)//': mass', atol=1.0e-7_wp)
   end subroutine test_tangents

   !> At the end of a branch the stiffness is the one-sided derivative in the direction of the path:
   !> past first yield that of the yielding spring, and at a reversal that of the elastic one.
   subroutine test_branch_ends()
      type(wall_member_t) :: member
      type(member_response_t) :: here, next
      type(error_t), allocatable :: error
      real(wp) :: motion(1, 3), found(4), expected(4), yield
      real(wp), parameter :: step = 1.0e-7_wp, still(2) = 0
      character(13), parameter :: springs(3) = [character(13) :: 'fuse', 'flag', 'tendon yields']
      integer :: number, k

      do number = 1, member_case_count
         if (all(member_case_name(number) /= springs)) cycle
         member = member_of(number)
         call place(member, 1)
         motion = 0
         yield = first_limit(member)
         do k = 1, 4
            motion(1, 2) = 0
            select case (k)
            case (1)
               ! to first yield exactly, and on
               motion(1, 1) = yield
            case (2)
               ! beyond it, committed
               motion(1, 1) = 1.5_wp*yield
            case (3)
               ! without a path: by the sign of the velocity, onwards
               motion(1, 2) = 1.0e-3_wp
            case default
               motion(1, 2) = -1.0e-3_wp
            end select
            call respond_member(member, motion, still, here, error)
            found(k) = here%stiffness(1, 1)
            associate (way => merge(-step, step, k == 4))
               motion(1, 1) = motion(1, 1) + way
               call respond_member(member, motion, still, next, error, has_tangents=.false.)
               expected(k) = (next%force(1) - here%force(1))/way
               motion(1, 1) = motion(1, 1) - way
            end associate
            call respond_member(member, motion, still, next, error, has_tangents=.false.)
            if (k == 2) call commit_member(member, error)
         end do
         call checks%close_to(maxval(abs(found/expected - 1)), 0.0_wp, &
            'one-sided tangents of '//member_case_name(number), atol=1.0e-5_wp)
         call checks%that(found(4) > 1.2_wp*found(3), 'stiffer on the way back: ' &
            //member_case_name(number))
      end do
   end subroutine test_branch_ends

   !> Displacement at which the first branch ends [m].
   real(wp) function first_limit(member) result(u)
      type(wall_member_t), intent(in) :: member
      type(wall_member_t) :: copy
      type(member_event_t) :: event
      type(error_t), allocatable :: error
      real(wp) :: motions(1, 3, 2), still(2, 2), push(2)

      copy = member
      still = 0
      push = 0
      motions = 0
      ! uniform motion to the side within one second
      motions(1, 2, :) = 0.8_wp
      motions(1, 1, 2) = 0.8_wp
      call next_member_event(copy, 1.0_wp, motions, still, push, event, error, has_branches=.true.)
      call checks%that(event%kind == event_branch, 'a branch ends')
      u = 0.8_wp*event%tau
   end function first_limit

   !> Trials, reverts, copies and commits in random order: the committed path has the same bits as
   !> that of a member that only commits.
   subroutine test_fuzz(number)
      integer, intent(in) :: number
      type(wall_member_t) :: tried, straight, saved
      type(member_response_t) :: one, other
      type(error_t), allocatable :: error
      real(wp), allocatable :: motion(:, :), noise(:, :)
      real(wp) :: dice
      logical :: is_same
      integer :: k, trials, side

      call random_init(repeatable=.true., image_distinct=.false.)
      straight = member_of(number)
      side = 1
      call place(straight, side)
      tried = straight
      is_same = .true.
      motion = motion_of(straight, side)
      noise = motion
      do k = 1, 200
         if (modulo(k, 40) == 0 .and. straight%equation%has_impacts) then
            motion(1, :) = [0.0_wp, -side*0.5_wp, 0.0_wp]
         else
            call random_number(noise)
            motion = motion_of(straight, side)*2*noise
         end if
         call random_number(dice)
         do trials = 1, int(4*dice)
            call random_number(noise)
            call respond_member(tried, motion*(2*noise - 0.3_wp), [noise(1, 1), 0.0_wp], one, error)
            call random_number(dice)
            if (dice < 0.3_wp) call revert_member(tried, error)
            if (dice > 0.7_wp) saved = tried
            if (dice > 0.9_wp) tried = saved
            if (dice > 0.5_wp) call respond_member(tried, 1.0e40_wp*motion, [0.0_wp, 0.0_wp], one, &
               error)
         end do
         call respond_member(tried, motion, [0.3_wp, 0.0_wp], one, error)
         call respond_member(straight, motion, [0.3_wp, 0.0_wp], other, error)
         call checks%no_error(error, 'step of the fuzz')
         if (allocated(error)) return
         is_same = is_same .and. are_same(one, other)
         call commit_member(tried, error)
         call commit_member(straight, error)
         if (modulo(k, 40) == 0 .and. straight%equation%has_impacts) then
            side = -side
            call place(tried, side)
            call place(straight, side)
         end if
      end do
      call checks%that(is_same, member_case_name(number)//': the committed path keeps its bits')
      call restart_member(tried, error)
      straight = member_of(number)
      call place(tried, 1)
      call place(straight, 1)
      motion = motion_of(straight, 1)
      call respond_member(tried, motion, [0.3_wp, 0.0_wp], one, error)
      call respond_member(straight, motion, [0.3_wp, 0.0_wp], other, error)
      call checks%that(are_same(one, other), member_case_name(number)//': a restart forgets all')
   end subroutine test_fuzz

   !> True if two responses have the same bits.
   pure logical function are_same(one, other)
      type(member_response_t), intent(in) :: one, other

      are_same = all(transfer(one%force, [0_i8]) == transfer(other%force, [0_i8])) &
         .and. all(transfer(one%stiffness, [0_i8]) == transfer(other%stiffness, [0_i8])) &
         .and. all(transfer(one%damping, [0_i8]) == transfer(other%damping, [0_i8])) &
         .and. all(transfer(one%mass, [0_i8]) == transfer(other%mass, [0_i8])) &
         .and. all(transfer([one%cable, one%fuses, one%theta], [0_i8]) &
         == transfer([other%cable, other%fuses, other%theta], [0_i8]))
   end function are_same

   !> Rules of impacts: factors of the existing element, also of a table.
   subroutine test_impact_rules()
      character(*), parameter :: nl = new_line('a')
      character(*), parameter :: wall = '&wall h = 2.0, b = 0.5, m_w = 2.0e4 /'//nl &
         //'&frame gamma = 5.0 /'//nl//"&model formulation = 'exact' /"//nl
      character(*), parameter :: rules(5) = [character(90) :: &
         '&inerter inertance_over_m_w = 1.0 /', &
         "&impact rule = 'constant', e = 0.8 /", "&impact rule = 'housner' /", &
         "&impact rule = 'coupled' /", &
         "&impact rule = 'coupled' / &inerter inertance_over_m_w = 1.0 /"]
      type(wall_member_t) :: member
      type(wall_element_t) :: element
      type(case_t) :: case
      type(error_t), allocatable :: error
      real(wp) :: velocity(1)
      integer :: k

      do k = 1, size(rules)
         call read_case_text(wall//trim(rules(k)), '', case, error, is_for_host=.true.)
         if (.not. allocated(error)) call create_element(element, case, error)
         if (.not. allocated(error)) call create_member(member, case, error)
         call checks%no_error(error, 'case of '//rules(k))
         call place(member, -1)
         velocity = 0.7_wp
         call land_member(member, [0.0_wp], velocity, error)
         call checks%no_error(error, 'landing')
         call checks%close_to(velocity(1), 0.7_wp*velocity_factor(element), 'factor: '//rules(k), &
            rtol=1.0e-13_wp)
         call checks%that(member%committed%side == 1, 'the wall goes on')
      end do
      call read_case_text(wall//"&impact rule = 'table', table_theta_dot = 0.1, 1.0, " &
         //'table_e = 0.95, 0.7 /', '', case, error, is_for_host=.true.)
      if (.not. allocated(error)) call create_member(member, case, error)
      call place(member, 1)
      velocity = -4*0.55_wp
      call land_member(member, [0.0_wp], velocity, error)
      call checks%no_error(error, 'landing by a table')
      call checks%close_to(velocity(1), -4*0.55_wp*0.825_wp, 'factor of a table', rtol=1.0e-13_wp)
   end subroutine test_impact_rules

   !> The rule 'coupled' over masses of the host: those of the case give its factor, none Housner's.
   subroutine test_host_masses()
      type(wall_member_t) :: member
      type(error_t), allocatable :: error
      real(wp) :: velocity(1), expected(1), sine
      real(wp) :: modes(3), modes_given(3)
      integer :: number

      number = 1
      member = member_of(number)
      call place(member, 1)
      expected = -0.7_wp
      call land_member(member, [0.0_wp], expected, error)
      call place(member, 1)
      velocity = -0.7_wp
      call land_member(member, [0.0_wp], velocity, error, reshape([5*m_w], [1, 1]))
      call checks%close_to(velocity(1), expected(1), 'the masses of the case', rtol=1.0e-13_wp)
      call place(member, 1)
      velocity = -0.7_wp
      call land_member(member, [0.0_wp], velocity, error, reshape([0.0_wp], [1, 1]))
      sine = sin(atan2(0.5_wp, 2.0_wp))
      call checks%close_to(velocity(1), -0.7_wp*(1 - 1.5_wp*sine**2), 'no masses', rtol=1.0e-13_wp)
      do number = 1, member_case_count
         if (member_case_name(number) == 'bending') exit
      end do
      member = member_of(number)
      call place(member, 1)
      modes = [-0.7_wp, 0.3_wp, -0.2_wp]
      modes_given = modes
      call land_member(member, [0.0_wp, 0.01_wp, 0.02_wp], modes, error)
      call place(member, 1)
      call land_member(member, [0.0_wp, 0.01_wp, 0.02_wp], modes_given, error, &
         spread(spread(5*m_w, 1, 3), 1, 3))
      call checks%no_error(error, 'landing of a wall that bends')
      call checks%close_to(maxval(abs(modes - modes_given)), 0.0_wp, 'masses at the top', &
         atol=1.0e-13_wp)
      call checks%that(.not. allocated(error) .and. abs(modes(2) - 0.3_wp) > 0.01_wp, &
         'the modes take momentum')
   end subroutine test_host_masses

   !> Events of a step: impact, peak, end of a branch, lift-off and rest.
   subroutine test_events()
      type(wall_member_t) :: member
      type(member_event_t) :: event
      type(member_response_t) :: response
      type(error_t), allocatable :: error
      real(wp) :: motions(1, 3, 2), still(2, 2), push(2), u_0
      integer :: number

      still = 0
      push = 0
      motions = 0
      number = 8
      call checks%that(member_case_name(number) == 'fuse', 'the fuse')
      member = member_of(number)
      call respond_member(member, 0*motions(:, :, 1), still(:, 1), response, error)
      call checks%close_to(response%hold(2), m_w*g*0.25_wp/2, 'hold of the resting wall', &
         rtol=1.0e-12_wp)
      call checks%close_to(response%hold(1), -response%hold(2), 'on both sides', rtol=1.0e-12_wp)
      push = [0.5_wp, 1.5_wp]*response%hold(2)
      call next_member_event(member, 0.1_wp, motions, still, push, event, error)
      call checks%that(event%kind == event_lift_off .and. event%side == 1, 'lift-off to the right')
      call checks%close_to(event%tau, 0.05_wp, 'its time', rtol=1.0e-12_wp)
      call next_member_event(member, 0.1_wp, motions, still, -push/2, event, error)
      call checks%that(event%kind == 0 .and. abs(event%tau - 0.1_wp) <= 0, 'rest')
      call place(member, 1)
      call move(member, 0.0075_wp)
      ! u = u_0 + 0.4 t - t**2 returns to the base after 0.4 s; the fuse yields before the peak
      u_0 = member%committed%u
      motions(1, :, 1) = [u_0, 0.4_wp, -2.0_wp]
      motions(1, :, 2) = [u_0 + 0.4_wp*0.6_wp - 0.6_wp**2, -0.8_wp, -2.0_wp]
      call next_member_event(member, 0.6_wp, motions, still, push, event, error)
      call checks%that(event%kind == event_impact, 'impact')
      call checks%close_to(event%tau, 0.2_wp + sqrt(0.04_wp + u_0), 'its time', rtol=1.0e-12_wp)
      call next_member_event(member, 0.6_wp, motions, still, push, event, error, &
         has_branches=.true.)
      call checks%that(event%kind == event_branch, 'the fuse yields')
      call checks%close_to(u_0 + 0.4_wp*event%tau - event%tau**2, first_limit(member), &
         'its displacement', rtol=1.0e-12_wp)
      motions(1, :, 1) = [u_0 + 0.03_wp, 0.2_wp, -2.0_wp]
      motions(1, :, 2) = [u_0 + 0.03_wp, -0.2_wp, -2.0_wp]
      call respond_member(member, motions(:, :, 1), still(:, 1), response, error)
      call commit_member(member, error)
      call next_member_event(member, 0.2_wp, motions, still, push, event, error, &
         has_branches=.true.)
      call checks%that(event%kind == event_peak, 'the fuse turns at the peak')
      call checks%close_to(event%tau, 0.1_wp, 'the time of the peak', rtol=1.0e-12_wp)
      call checks%that(.not. settles_after(member, 0.1_wp), 'too fast to settle')
      call checks%that(settles_after(member, 1.0e-6_wp), 'settles')
   end subroutine test_events

   !> True if a wall that has landed with a velocity settles within 10 ms.
   logical function settles_after(member, velocity) result(settles)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: velocity
      !! [m/s]
      type(wall_member_t) :: landed
      type(error_t), allocatable :: error
      real(wp) :: motion(1, 3), v(1)

      landed = member
      call move(landed, 0.0_wp)
      v = -velocity
      call land_member(landed, [0.0_wp], v, error)
      call checks%no_error(error, 'landing')
      motion(1, :) = [0.0_wp, v(1), 0.0_wp]
      settles = member_settles(landed, 0.01_wp, motion, [0.0_wp, 0.0_wp], 0.0_wp, error)
      call checks%no_error(error, 'settles')
   end function settles_after

end program test_member
