!> Forces and tangents of a member: the wall with memory in the equations of a host program.
!>
!> The loops of the effects give inertia I and moment M over m_w R**2 and the forces of the modes,
!> for phi = |theta| and q~ = sigma q. With the stroke du = sigma R lever dphi of the link,
!>
!>    sigma f = m_w R/lever [I phi'' + sum S_i q~_i''/R**2 - M]
!>    sigma f_i = m_w [m_i q~_i'' + S_i phi'' - Q_i]
!>
!> Link springs add their forces on wall, modes and floors. The derivatives of M and Q_i by phi,
!> phi', q~ and q~' are central differences of order four on the active branches, which are smooth
!> beyond their ends. So the tangents are those of the branch that the path has entered.
module rwmf_embedding_member_response
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_link_rotation, only: find_rotation, slope_of_phi_ddot
   use rwmf_embedding_member, only: follow_path, place_t, require_member, wall_member_t
   use rwmf_embedding_ranges, only: any_number, is_number, require_number, require_numbers
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_elements, only: element_force, of_fuse
   use rwmf_model_equation, only: cable_force_at, discrete_state_t, enter_side
   use rwmf_model_kinematics, only: kinematics_of, kinematics_t
   use rwmf_model_lanes, only: lane_motion_t, set_ground
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: member_response_t, link_motion_t
   public :: respond_member, find_response, query_links, require_motion, require_ground

   !> Response of a member to a motion.
   type :: member_response_t
      real(wp), allocatable :: force(:)
      !! (dofs) resisting forces [N]
      real(wp), allocatable :: stiffness(:, :)
      !! (dofs, dofs) derivatives of the forces by the displacements [N/m]
      real(wp), allocatable :: damping(:, :)
      !! (dofs, dofs) by the velocities [N s/m]
      real(wp), allocatable :: mass(:, :)
      !! (dofs, dofs) by the accelerations [kg]
      real(wp) :: hold(2) = 0
      !! smallest and largest force of the host on u at which a wall at rest stays there, NaN while
      !! it rocks [N]
      real(wp) :: theta = 0
      !! rotation [rad]
      real(wp) :: theta_dot = 0
      !! [rad/s]
      real(wp) :: theta_ddot = 0
      !! [rad/s2]
      real(wp) :: cable = 0
      !! tension [N]
      real(wp) :: fuses(2) = 0
      !! tension of the left and of the right fuse [N]
   end type member_response_t

   !> Motion of the wall at its links.
   type :: link_motion_t
      real(wp), allocatable :: motion(:, :)
      !! (links, 3) displacement [m], velocity [m/s] and acceleration [m/s2]
      real(wp), allocatable :: derivatives(:, :)
      !! (links, dofs) derivatives of the displacements by the degrees of freedom [-]
   end type link_motion_t

   !> Wall at one motion, with the side, its kinematics and its rotation.
   type :: pose_t
      integer :: side = 1
      !! whose kinematics apply
      logical :: rests = .false.
      type(kinematics_t) :: kin
      real(wp), allocatable :: z(:, :)
      !! (0:modes, 0:2) phi [rad] and q~ [m] with their first and second derivatives
      real(wp) :: ground(2) = 0
      !! horizontal and vertical ground acceleration [m/s2]
   end type pose_t

contains

   !> Compute forces and tangents at a motion, and set the trial state.
   !>
   !> The displacement u may lie slightly on the wrong side of zero. At rest it counts as zero, and
   !> its force, row and column are zero. After a failure the trial state is as before.
   subroutine respond_member(member, motion, ground, response, error, has_tangents)
      type(wall_member_t), intent(inout) :: member
      real(wp), intent(in) :: motion(:, :)
      !! (dofs, 3) displacements [m], velocities [m/s] and accelerations [m/s2]
      real(wp), intent(in) :: ground(2)
      !! horizontal and vertical ground acceleration; the latter is 0 unless the case has a vertical
      !! record [m/s2]
      type(member_response_t), intent(out) :: response
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for numbers that are not finite or exceed 1e30 in size, for a displacement that
      !! the wall cannot reach, and for forces that are not finite
      logical, intent(in), optional :: has_tangents
      !! compute the tangents; default true
      type(discrete_state_t) :: state
      type(place_t) :: place
      integer, allocatable :: fuses(:)
      integer :: i

      call require_member(member, error)
      call require_motion(member, motion, error)
      call require_ground(member, ground, error)
      if (allocated(error)) return
      place = member%committed
      state = member%committed_state
      call find_response(member, place, state, motion, ground, response, error, has_tangents)
      if (allocated(error)) return
      member%tried = place
      member%equation%state = state
      ! fill in the forces of cable and fuses in the tried state
      associate (equation => member%equation)
         if (equation%has_cable) then
            response%cable = member%m_w*equation%p%g*cable_force_at(equation, response%theta, &
               equation%state%side)
         end if
         if (.not. allocated(equation%elements)) return
         fuses = pack([(i, i=1, size(equation%elements))], equation%elements%group == of_fuse)
         response%fuses(:) = 0
         do i = 1, min(size(fuses), 2)
            response%fuses(i) = member%m_w*element_force(equation%elements(fuses(i)), &
               equation%state%springs, equation%state%side, equation%state%side*response%theta, &
               0.0_wp)
         end do
      end associate
   end subroutine respond_member

   !> Compute forces and tangents on the path from a place, without the forces of cable and fuses.
   subroutine find_response(member, place, state, motion, ground, response, error, has_tangents)
      type(wall_member_t), intent(in) :: member
      type(place_t), intent(inout) :: place
      !! beginning of the path, on return its end
      type(discrete_state_t), intent(inout) :: state
      !! branches at the beginning, on return at the end
      real(wp), intent(in) :: motion(:, :)
      !! (dofs, 3) displacements [m], velocities [m/s] and accelerations [m/s2]
      real(wp), intent(in) :: ground(2)
      !! horizontal and vertical ground acceleration [m/s2]
      type(member_response_t), intent(out) :: response
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` as in `respond_member`
      logical, intent(in), optional :: has_tangents
      !! compute the tangents; default true
      type(pose_t) :: pose
      logical :: is_complete, is_finite
      integer :: direction
      real(wp) :: way

      call find_pose(member, place, state, motion, ground, pose, error)
      if (allocated(error)) return
      ! sign of the path from a rotation, or of theta' where there is no path
      if (.not. pose%rests) then
         way = pose%side*pose%z(0, 0) - place%theta
         if (.not. abs(way) > 0) way = pose%side*pose%z(0, 1)
         direction = 0
         if (abs(way) > 0) direction = int(sign(1.0_wp, way))
         call follow_path(member%equation, state, place%theta, pose%side*pose%z(0, 0), direction)
      end if
      is_complete = .true.
      if (present(has_tangents)) is_complete = has_tangents
      call fill_response(member, state, pose, is_complete, response)
      if (.not. pose%rests) response%hold = ieee_value(response%hold, ieee_quiet_nan)
      if (pose%rests) response%hold = holds(member, state, pose)
      call add_link_springs(member, motion, pose, is_complete, response)
      is_finite = all(ieee_is_finite(response%force)) .and. all(ieee_is_finite([response%theta, &
         response%theta_dot, response%theta_ddot]))
      if (is_complete .and. is_finite) is_finite = all(ieee_is_finite(response%stiffness)) &
         .and. all(ieee_is_finite(response%damping)) .and. all(ieee_is_finite(response%mass))
      if (.not. is_finite) then
         call fail(error, err_input, 'the force at this motion of wall and ground is not a ' &
            //'finite number')
         response = member_response_t()
         return
      end if
      place%u = merge(0.0_wp, motion(1, 1), pose%rests)
      place%theta = pose%side*pose%z(0, 0)
   end subroutine find_response

   !> Check the shape and the numbers of a motion. An earlier `error` is kept.
   subroutine require_motion(member, motion, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: motion(:, :)
      !! (dofs, 3) displacements, velocities, accelerations [m], [m/s], [m/s2]
      type(error_t), allocatable, intent(inout) :: error
      character(12), parameter :: names(3) = [character(12) :: 'displacement', 'velocity', &
         'acceleration']
      integer :: i, j

      if (allocated(error)) return
      if (size(motion, 1) /= member%n .or. size(motion, 2) /= 3) then
         call fail(error, err_input, 'a motion of this member has '//trim(integer_to_text( &
            member%n))//' x 3 numbers, not '//trim(integer_to_text(size(motion, 1)))//' x ' &
            //trim(integer_to_text(size(motion, 2))))
         return
      end if
      do j = 1, 3
         do i = 1, member%n
            if (is_number(motion(i, j))) cycle
            call require_number(motion(i, j), trim(names(j))//' of degree of freedom ' &
               //trim(integer_to_text(i)), any_number, error)
         end do
      end do
   end subroutine require_motion

   !> Check the ground acceleration. An earlier `error` is kept.
   subroutine require_ground(member, ground, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: ground(2)
      !! [m/s2]
      type(error_t), allocatable, intent(inout) :: error

      call require_numbers(ground, [character(8) :: 'u_g_ddot', 'v_g_ddot'], error)
      if (allocated(error) .or. member%takes_vertical .or. .not. abs(ground(2)) > 0) return
      call fail(error, err_input, 'v_g_ddot must be 0: the case has no record of the upward ' &
         //'acceleration of the ground; a ratio to u_g_ddot needs none')
   end subroutine require_ground

   !> Find side, rotation and its rates at a motion.
   subroutine find_pose(member, place, state, motion, ground, pose, error)
      type(wall_member_t), intent(in) :: member
      type(place_t), intent(in) :: place
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(in) :: motion(:, :)
      real(wp), intent(in) :: ground(2)
      type(pose_t), intent(out) :: pose
      type(error_t), allocatable, intent(out) :: error

      associate (modes => member%equation%beam%n, s => pose%side, R => member%equation%p%R, &
                 kin => pose%kin)
         pose%rests = place%side == 0
         s = state%side
         pose%ground = [ground(1), ground(2) + member%vertical_ratio*ground(1)]
         allocate (pose%z(0:modes, 0:2), source=0.0_wp)
         pose%z(1:, :) = s*motion(2:modes + 1, :)
         if (pose%rests) then
            pose%kin = kinematics_of(member%equation%geometry, s, 0.0_wp)
            return
         end if
         call find_rotation(member%equation, member%largest_angle, s, s*motion(1, 1), &
            pose%z(0, 0), pose%kin, error)
         if (allocated(error)) return
         pose%z(0, 1) = s*motion(1, 2)/(R*kin%j)
         pose%z(0, 2) = (s*motion(1, 3)/R - kin%k*pose%z(0, 1)**2)/kin%j
      end associate
   end subroutine find_pose

   !> Compute forces and tangents of the wall, without link springs.
   subroutine fill_response(member, state, pose, has_tangents, response)
      type(wall_member_t), intent(in) :: member
      type(discrete_state_t), intent(in) :: state
      type(pose_t), intent(in) :: pose
      logical, intent(in) :: has_tangents
      type(member_response_t), intent(out) :: response
      real(wp), dimension(0:member%equation%beam%n) :: force, unit
      real(wp) :: mass(0:member%equation%beam%n, 0:member%equation%beam%n)
      integer :: n

      n = member%equation%beam%n
      allocate (response%force(member%n), source=0.0_wp)
      call find_balance(member, state, pose, pose%z, force, mass)
      unit = pose%side*member%m_w
      unit(0) = unit(0)*member%equation%p%R/pose%kin%lever
      response%force(:n + 1) = unit*force
      if (has_tangents) call fill_tangents(member, state, pose, unit, mass, response)
      if (pose%rests) then
         response%force(1) = 0
         ! set row and column of u to zero
         if (has_tangents) then
            response%stiffness(1, :) = 0
            response%stiffness(:, 1) = 0
            response%damping(1, :) = 0
            response%damping(:, 1) = 0
            response%mass(1, :) = 0
            response%mass(:, 1) = 0
         end if
      else
         response%theta = pose%side*pose%z(0, 0)
         response%theta_dot = pose%side*pose%z(0, 1)
         response%theta_ddot = pose%side*pose%z(0, 2)
      end if
   end subroutine fill_response

   !> Compute the balance of moments over m_w R**2 and the forces of the modes over m_w, for phi and
   !> q~, with their derivatives by phi'' and q~''.
   subroutine find_balance(member, state, pose, z, force, mass)
      type(wall_member_t), intent(in) :: member
      type(discrete_state_t), intent(in) :: state
      !! on the side of the pose
      type(pose_t), intent(in) :: pose
      !! side and ground; its motion does not count
      real(wp), intent(in) :: z(0:, 0:)
      !! (0:modes, 0:2) motion
      real(wp), intent(out) :: force(0:)
      !! (0:modes) [1/s2], [m/s2]
      real(wp), intent(out) :: mass(0:, 0:)
      !! (0:modes, 0:modes) [-], [1/m]; [m], [-]
      type(lane_motion_t) :: motion
      real(wp), dimension(member%equation%n) :: y, rates
      integer :: i

      call set_ground(motion, pose%ground)
      associate (beam => member%equation%beam, n => member%equation%beam%n, s => pose%side, &
                 R => member%equation%p%R)
         y(1:2) = s*z(0, :1)
         if (n > 0) then
            y(beam%first:beam%first + n - 1) = s*z(1:, 0)
            y(beam%first + n:beam%first + 2*n - 1) = s*z(1:, 1)
         end if
         call lane_rates(member%equation%scene, state%coef, y, motion, rates)
         mass = 0
         mass(0, 0) = motion%inertia(1)
         force(0) = -motion%moment(1)
         do i = 1, n
            ! the loop has eliminated the modes with the accelerations in `rates`
            associate (own => beam%mass(i)*s*rates(beam%first + n + i - 1))
               mass(0, 0) = mass(0, 0) + beam%arm(i)**2/(beam%mass(i)*R**2)
               force(0) = force(0) - beam%arm(i)*own/(beam%mass(i)*R**2)
               force(i) = -own
            end associate
            mass(0, i) = beam%arm(i)/R**2
            mass(i, 0) = beam%arm(i)
            mass(i, i) = beam%mass(i)
         end do
      end associate
      force = force + matmul(mass, z(:, 2))
   end subroutine find_balance

   !> Compute the tangents of the wall.
   subroutine fill_tangents(member, state, pose, unit, mass, response)
      type(wall_member_t), intent(in) :: member
      type(discrete_state_t), intent(in) :: state
      type(pose_t), intent(in) :: pose
      real(wp), intent(in) :: unit(0:)
      !! (0:modes) force per balance [kg m], [kg]
      real(wp), intent(in) :: mass(0:, 0:)
      !! (0:modes, 0:modes) derivatives of the balance by phi'' and q~''
      type(member_response_t), intent(inout) :: response
      real(wp) :: by(0:member%equation%beam%n, 0:member%equation%beam%n, 0:1)
      !! derivatives of the balance by phi and q~, and by phi' and q~'
      real(wp) :: per_u
      !! dphi/du [1/m]
      integer :: i, j, n

      n = member%equation%beam%n
      do j = 0, 1
         do i = 0, n
            by(:, i, j) = balance_slope(member, state, pose, i, j)
         end do
      end do
      allocate (response%stiffness(member%n, member%n), response%damping(member%n, member%n), &
         response%mass(member%n, member%n), source=0.0_wp)
      associate (kin => pose%kin, rate => pose%z(0, 1), R => member%equation%p%R)
         per_u = pose%side/(R*kin%j)
         response%stiffness(:n + 1, 1) = unit*per_u*(by(:, 0, 0) - by(:, 0, 1)*kin%k/kin%j*rate &
            + mass(:, 0)*slope_of_phi_ddot(kin, pose%z(0, 1:)))
         response%stiffness(1, 1) = response%stiffness(1, 1) - kin%lever_1/kin%lever*per_u &
            *response%force(1)
         response%damping(:n + 1, 1) = unit*per_u*(by(:, 0, 1) - mass(:, 0)*2*kin%k/kin%j*rate)
         response%mass(:n + 1, 1) = unit*per_u*mass(:, 0)
      end associate
      do i = 1, n
         response%stiffness(:n + 1, i + 1) = unit*pose%side*by(:, i, 0)
         response%damping(:n + 1, i + 1) = unit*pose%side*by(:, i, 1)
         response%mass(:n + 1, i + 1) = unit*pose%side*mass(:, i)
      end do
   end subroutine fill_tangents

   !> Derivative of the balance by one coordinate or its rate. The accelerations stay.
   function balance_slope(member, state, pose, coordinate, order) result(slope)
      type(wall_member_t), intent(in) :: member
      type(discrete_state_t), intent(in) :: state
      type(pose_t), intent(in) :: pose
      integer, intent(in) :: coordinate
      !! 0 for phi, i for q~_i
      integer, intent(in) :: order
      !! 0 by the coordinate, 1 by its rate
      real(wp) :: slope(0:member%equation%beam%n)
      real(wp), parameter :: relative = 1.0e-3_wp
      real(wp) :: force(0:member%equation%beam%n, 4)
      real(wp) :: mass(0:member%equation%beam%n, 0:member%equation%beam%n)
      real(wp) :: z(0:member%equation%beam%n, 0:2)
      real(wp) :: step
      integer, parameter :: places(4) = [-2, -1, 1, 2]
      integer :: i

      step = relative
      if (coordinate > 0) step = relative*member%equation%beam%length
      ! a law with a corner at rest is smooth only on one side of it
      if (coordinate == 0 .and. order == 1 .and. member%equation%creep > 0 &
          .and. abs(pose%z(0, 1)) > 0) step = relative*abs(pose%z(0, 1))
      do i = 1, 4
         z = pose%z
         z(coordinate, order) = z(coordinate, order) + places(i)*step
         call find_balance(member, state, pose, z, force(:, i), mass)
      end do
      slope = (8*(force(:, 3) - force(:, 2)) - (force(:, 4) - force(:, 1)))/(12*step)
   end function balance_slope

   !> Smallest and largest force on u at which the wall stays at rest [N].
   function holds(member, state, pose) result(hold)
      type(wall_member_t), intent(in) :: member
      type(discrete_state_t), intent(in) :: state
      type(pose_t), intent(in) :: pose
      real(wp) :: hold(2)
      type(discrete_state_t) :: towards
      type(pose_t) :: leaving
      real(wp) :: force(0:member%equation%beam%n)
      real(wp) :: mass(0:member%equation%beam%n, 0:member%equation%beam%n)
      integer :: i, s

      do i = 1, 2
         s = 2*i - 3
         towards = state
         call enter_side(member%equation%model_t, towards, s)
         leaving = pose
         leaving%side = s
         leaving%z(:, :) = s*pose%side*pose%z
         leaving%kin = kinematics_of(member%equation%geometry, s, 0.0_wp)
         call find_balance(member, towards, leaving, leaving%z, force, mass)
         hold(i) = s*member%m_w*member%equation%p%R/leaving%kin%lever*force(0)
      end do
   end function holds

   !> Add the forces and tangents of the link springs.
   subroutine add_link_springs(member, motion, pose, has_tangents, response)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: motion(:, :)
      type(pose_t), intent(in) :: pose
      logical, intent(in) :: has_tangents
      type(member_response_t), intent(inout) :: response
      type(link_motion_t) :: links
      real(wp), dimension(size(member%share)) :: pull, w
      real(wp), allocatable :: slope(:, :)
      real(wp) :: bend(2)
      !! second derivatives of the links' displacements: by u twice per w [1/m2]; by u and q_i per
      !! phi_i [1/m]
      integer :: i, j, n, first
      real(wp) :: theta, per_u, per_u_1

      if (.not. allocated(member%k_link)) return
      n = member%equation%beam%n
      first = n + 1
      call find_links(member, motion, pose, links)
      pull = member%k_link*(links%motion(:, 1) - motion(first + 1:, 1))
      associate (slopes => links%derivatives)
         if (pose%rests) response%hold = response%hold + sum(slopes(:, 1)*pull)
         slope = slopes
         if (pose%rests) slope(:, 1) = 0
         do i = 1, size(pull)
            slope(i, first + i) = -1
         end do
         response%force(:) = response%force + matmul(pull, slope)
         if (.not. has_tangents) return
         do j = 1, member%n
            do i = 1, member%n
               response%stiffness(i, j) = response%stiffness(i, j) + sum(member%k_link*slope(:, i) &
                  *slope(:, j))
            end do
         end do
         if (pose%rests .or. n == 0) return
         ! second derivatives of cos(theta) w by u and w: twice by u, per w; and by both
         theta = pose%side*pose%z(0, 0)
         associate (R => member%equation%p%R, kin => pose%kin)
            per_u = 1/(R*kin%j)
            per_u_1 = -pose%side*kin%k/(R**2*kin%j**3)
            bend = [-(cos(theta)*per_u**2 + sin(theta)*per_u_1), -sin(theta)*per_u]
         end associate
         w = matmul(member%phi, motion(2:n + 1, 1))
         response%stiffness(1, 1) = response%stiffness(1, 1) + bend(1)*sum(pull*w)
         do i = 1, n
            response%stiffness(1, i + 1) = response%stiffness(1, i + 1) + bend(2)*sum(pull &
               *member%phi(:, i))
            response%stiffness(i + 1, 1) = response%stiffness(i + 1, 1) + bend(2)*sum(pull &
               *member%phi(:, i))
         end do
      end associate
   end subroutine add_link_springs

   !> Return motion of the wall at its links, with its derivatives by the degrees of freedom.
   !>
   !> With rigid links this is the motion of the host's floors.
   subroutine query_links(member, motion, links, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: motion(:, :)
      !! (dofs, 3) displacements [m], velocities [m/s] and accelerations [m/s2]
      type(link_motion_t), intent(out) :: links
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` as in `respond_member`
      type(pose_t) :: pose

      call require_member(member, error)
      call require_motion(member, motion, error)
      if (allocated(error)) return
      call find_pose(member, member%committed, member%committed_state, motion, [0.0_wp, 0.0_wp], &
         pose, error)
      if (.not. allocated(error)) call find_links(member, motion, pose, links)
   end subroutine query_links

   !> Compute the motion of the wall at its links.
   subroutine find_links(member, motion, pose, links)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: motion(:, :)
      type(pose_t), intent(in) :: pose
      type(link_motion_t), intent(out) :: links
      real(wp) :: theta(0:2)
      real(wp) :: u(3)
      real(wp) :: w(size(member%share), 3)
      integer :: i, n

      n = member%equation%beam%n
      theta = pose%side*pose%z(0, :)
      u = motion(1, :)
      if (pose%rests) u = 0
      w = matmul(member%phi, motion(2:n + 1, :))
      allocate (links%motion(size(member%share), 3))
      allocate (links%derivatives(size(member%share), member%n), source=0.0_wp)
      associate (share => member%share, x => links%motion, c => cos(theta(0)), s => sin(theta(0)))
         x(:, 1) = share*u(1) + c*w(:, 1)
         x(:, 2) = share*u(2) + c*w(:, 2) - s*theta(1)*w(:, 1)
         x(:, 3) = share*u(3) + c*(w(:, 3) - theta(1)**2*w(:, 1)) - s*(2*theta(1)*w(:, 2) &
            + theta(2)*w(:, 1))
         links%derivatives(:, 1) = share - s/(member%equation%p%R*pose%kin%j)*w(:, 1)
         do i = 1, n
            links%derivatives(:, i + 1) = c*member%phi(:, i)
         end do
      end associate
   end subroutine find_links

end module rwmf_embedding_member_response
