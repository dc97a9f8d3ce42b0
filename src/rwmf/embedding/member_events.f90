!> Impact, rest, uplift and branch ends of a member of a host program.
!>
!> The host passes its motion at both ends of a time step; the events are located inside the step.
!> Between the ends u is the cubic through displacements and velocities, which includes the parabola
!> of Newmark's average acceleration.
module rwmf_embedding_member_events
   use rwmf_core_error, only: err_input, err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_member, only: place_member, require_member, require_on_base, wall_member_t
   use rwmf_embedding_member_response, only: link_motion_t, member_response_t, query_links, &
      require_ground, require_motion, respond_member
   use rwmf_embedding_ranges, only: any_number, is_number, not_negative, require_number, &
      require_numbers
   use rwmf_math_cubic, only: cubic_between, falling_root, monotone_pieces, value_at
   use rwmf_model_bent_wall, only: solution
   use rwmf_model_equation, only: discrete_state_t, straight_displacement
   use rwmf_model_hysteresis_spring_set, only: renew_window, turn_back
   use rwmf_model_restitution, only: factor_at, largest_factor
   use rwmf_simulation_hybrid_transitions, only: reason_of_jump
   use rwmf_simulation_state_result, only: event_branch, event_impact, event_lift_off, event_peak
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: member_event_t
   public :: next_member_event, find_first_uplift, land_member, member_settles

   !> First event of a step.
   type :: member_event_t
      integer :: kind = 0
      !! `event_impact`, `event_lift_off`, `event_peak`, `event_branch`; 0: none
      real(wp) :: tau = 0
      !! time since the beginning of the step; its length without an event [s]
      integer :: side = 0
      !! side of a lift-off, otherwise that of the wall
   end type member_event_t

   !> Step of a host program.
   type :: member_step_t
      real(wp) :: dt
      !! length [s]
      real(wp) :: u(0:3)
      !! sigma u as a polynomial of tau/dt [m]
      logical :: has_branches
      !! branch ends are events
   end type member_step_t

contains

   !> Find the first event of a step from the committed state.
   !>
   !> The events of a rocking wall are impacts and, on request, ends of branches and the peaks where
   !> a spring begins to unload. That of a resting wall is lift-off, where the force of the host on
   !> u passes the holding force; both vary linearly over the step.
   subroutine next_member_event(member, dt, motions, grounds, push, event, error, has_branches)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: dt
      !! >= 0, length of the step [s]
      real(wp), intent(in) :: motions(:, :, :)
      !! (dofs, 3, 2) displacements [m], velocities [m/s] and accelerations [m/s2] at both ends
      real(wp), intent(in) :: grounds(2, 2)
      !! horizontal and vertical ground acceleration at both ends [m/s2]
      real(wp), intent(in) :: push(2)
      !! force of the host on u at both ends, for a wall at rest [N]
      type(member_event_t), intent(out) :: event
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a negative `dt`, and as in `respond_member`; `err_numerical` for a wall
      !! that would leave its base on both sides at once
      logical, intent(in), optional :: has_branches
      !! also report ends of branches and peaks; default false
      type(member_step_t) :: step
      integer :: i

      call require_member(member, error)
      call require_number(dt, 'dt', not_negative, error)
      call require_numbers(push, [character(6) :: 'push_0', 'push_1'], error)
      do i = 1, 2
         call require_motion(member, motions(:, :, min(i, size(motions, 3))), error)
         call require_ground(member, grounds(:, i), error)
      end do
      if (allocated(error)) return
      event%tau = dt
      event%side = member%committed%side
      if (event%side == 0) then
         call find_lift_off(member, dt, motions, grounds, push, event, error)
         return
      end if
      step%dt = dt
      step%has_branches = .false.
      if (present(has_branches)) step%has_branches = has_branches
      step%u = event%side*cubic_between(dt, motions(1, 1, 1), motions(1, 2, 1), motions(1, 1, 2), &
         motions(1, 2, 2))
      call find_first(member, step, event)
   end subroutine next_member_event

   !> Find the first impact, branch end or peak of a rocking or hinged wall.
   subroutine find_first(member, step, event)
      type(wall_member_t), intent(in) :: member
      type(member_step_t), intent(in) :: step
      type(member_event_t), intent(inout) :: event
      type(discrete_state_t) :: state
      real(wp) :: ends(0:3)
      integer :: i, direction, before

      state = member%committed_state
      ends = monotone_pieces(step%u)
      before = 0
      do i = 1, 3
         if (.not. ends(i) > ends(i - 1)) cycle
         direction = merge(1, -1, value_at(step%u, ends(i)) >= value_at(step%u, ends(i - 1)))
         if (step%has_branches .and. before /= 0 .and. direction /= before &
             .and. state%ends_at_peak) then
            event%kind = event_peak
            event%tau = step%dt*ends(i - 1)
            return
         end if
         before = direction
         if (member%equation%has_impacts .and. value_at(step%u, ends(i)) < 0) then
            event%kind = event_impact
            event%tau = step%dt*falling_root(step%u, ends(i - 1), ends(i))
         end if
         if (step%has_branches) call find_branch(member, step, ends(i - 1:i), direction, state, &
            event)
         if (event%kind /= 0) return
      end do
   end subroutine find_first

   !> Find the end of a branch in a monotone piece, before an impact in it.
   subroutine find_branch(member, step, ends, direction, state, event)
      type(wall_member_t), intent(in) :: member
      type(member_step_t), intent(in) :: step
      real(wp), intent(in) :: ends(2)
      !! of the piece
      integer, intent(in) :: direction
      !! +1 if sigma u grows
      type(discrete_state_t), intent(inout) :: state
      !! branches at the beginning of the piece; on return also their limits
      type(member_event_t), intent(inout) :: event
      real(wp) :: limit, level(0:3)
      integer :: s

      s = member%committed%side
      associate (equation => member%equation)
         if (.not. equation%has_bilinear_springs) return
         call renew_window(equation%model_t, state)
         call turn_back(equation%model_t, state, member%committed%theta, onward=s*direction)
         call renew_window(equation%model_t, state)
         limit = merge(state%high, state%low, s*direction > 0)
         if (abs(limit) > member%largest_angle) return
         ! falls through zero at the limit
         level = -direction*step%u
         level(0) = level(0) + direction*s*straight_displacement(equation, s, limit)
         if (value_at(level, ends(1)) <= 0 .or. value_at(level, ends(2)) > 0) return
         limit = step%dt*falling_root(level, ends(1), ends(2))
         if (event%kind /= 0 .and. event%tau <= limit) return
         event%kind = event_branch
         event%tau = limit
      end associate
   end subroutine find_branch

   !> Find the first uplift of a wall at rest.
   subroutine find_lift_off(member, dt, motions, grounds, push, event, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: motions(:, :, :)
      real(wp), intent(in) :: grounds(2, 2)
      real(wp), intent(in) :: push(2)
      type(member_event_t), intent(inout) :: event
      type(error_t), allocatable, intent(out) :: error
      type(wall_member_t) :: trial
      type(member_response_t) :: response
      real(wp) :: demand(2, 2)
      !! uplift demand to the left and to the right, at both ends [N]
      integer :: i

      trial = member
      do i = 1, 2
         call respond_member(trial, motions(:, :, i), grounds(:, i), response, error, &
            has_tangents=.false.)
         if (allocated(error)) return
         demand(:, i) = [response%hold(1) - push(i), push(i) - response%hold(2)]
      end do
      if (any(minval(demand, dim=1) > 0)) then
         call fail(error, err_numerical, 'the wall jumps: '//reason_of_jump, 'wall_jumps')
         return
      end if
      call find_first_uplift(dt, demand, event%side, event%tau)
      if (event%side /= 0) event%kind = event_lift_off
   end subroutine find_lift_off

   !> Find the first uplift in a step over which the demands are linear.
   pure subroutine find_first_uplift(dt, demand, side, tau)
      real(wp), intent(in) :: dt
      !! [s]
      real(wp), intent(in) :: demand(2, 2)
      !! uplift demand to the left and to the right, at both ends [N]
      integer, intent(out) :: side
      !! +1 or -1, 0 without uplift
      real(wp), intent(out) :: tau
      !! time since the beginning; dt without uplift [s]
      real(wp) :: root
      integer :: i

      side = 0
      tau = dt
      do i = 1, 2
         if (maxval(demand(i, :)) <= 0) cycle
         root = 0
         if (demand(i, 1) < 0) root = dt*demand(i, 1)/(demand(i, 1) - demand(i, 2))
         if (side /= 0 .and. root >= tau) cycle
         side = 2*i - 3
         tau = root
      end do
   end subroutine find_first_uplift

   !> Apply an impact of a wall that is committed at u = 0: change velocities and side.
   !>
   !> The rule 'coupled' balances momentum: the impulse acts at the new corner, so the momenta
   !> conjugate to the rotation about it and to each mode are conserved. If the wall would turn back
   !> into its base, both corners stay on it: u' = 0, and the modes take their momenta. Other rules
   !> multiply u' by their factor. Floors on link springs keep their velocities. A trial state is
   !> forgotten.
   subroutine land_member(member, displacements, velocities, error, host_mass)
      type(wall_member_t), intent(inout) :: member
      !! on return on the new side, or at rest
      real(wp), intent(in) :: displacements(:)
      !! (dofs) [m]
      real(wp), intent(inout) :: velocities(:)
      !! (dofs) before the impact, on return after it [m/s]
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a wall at rest, away from its base, or moving away from it, for masses that
      !! couple the wall with floors on link springs, and for numbers that are not finite
      real(wp), intent(in), optional :: host_mass(:, :)
      !! (dofs, dofs) masses of the host; default: those of the case's frame [kg]
      real(wp), allocatable :: given(:, :)
      !! masses of the host; not allocated: those of the case's frame [kg]
      real(wp) :: after(size(velocities))
      integer :: side

      if (present(host_mass)) given = host_mass
      call require_landing(member, displacements, velocities, given, error)
      if (allocated(error)) return
      side = -member%committed%side
      after = velocities
      if (member%balances) then
         call balance_momentum(member, displacements, after, given, error)
      else
         after(1) = velocities(1)*factor_at(member%restitution, abs(velocities(1) &
            /(2*member%equation%p%R*member%equation%p%cos_alpha)))
      end if
      if (allocated(error)) return
      if (abs(after(1)) <= 0) side = 0
      call place_member(member, side, error)
      if (.not. allocated(error)) velocities = after
   end subroutine land_member

   !> Check the arguments of a landing.
   subroutine require_landing(member, displacements, velocities, given, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: displacements(:)
      real(wp), intent(in) :: velocities(:)
      real(wp), allocatable, intent(in) :: given(:, :)
      !! as in `land_member`
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: motion(size(displacements), 3)

      call require_on_base(member, error)
      if (allocated(error)) return
      if (size(velocities) /= size(displacements)) then
         call fail(error, err_input, 'displacements and velocities differ in number')
         return
      end if
      motion(:, 1) = displacements
      motion(:, 2) = velocities
      motion(:, 3) = 0
      call require_motion(member, motion, error)
      call require_masses(member, given, error)
      if (allocated(error)) return
      if (member%committed%side == 0) then
         call fail(error, err_input, 'the wall is at rest: it has no impact')
      else if (member%committed%side*velocities(1) > 0) then
         call fail(error, err_input, 'the wall moves away from its base: u'' = ' &
            //trim(real_to_text(velocities(1)))//' m/s on the side of u')
      end if
   end subroutine require_landing

   !> Check the masses of the host. An earlier `error` is kept.
   subroutine require_masses(member, given, error)
      type(wall_member_t), intent(in) :: member
      real(wp), allocatable, intent(in) :: given(:, :)
      !! as in `land_member`
      type(error_t), allocatable, intent(inout) :: error
      integer :: i, n

      if (allocated(error) .or. .not. allocated(given)) return
      if (any(shape(given) /= member%n)) then
         call fail(error, err_input, 'host_mass must have one row and one column for each degree ' &
            //'of freedom')
         return
      end if
      n = 1 + member%equation%beam%n
      if (.not. all(is_number(given))) then
         call fail(error, err_input, 'host_mass has a number that is not finite, or exceeds 1e30 ' &
            //'in size')
      else if (any(abs(given - transpose(given)) > 1.0e-9_wp*maxval(abs(given)))) then
         call fail(error, err_input, 'host_mass is not symmetric')
      else if (any([(given(i, i) < 0, i=1, member%n)])) then
         call fail(error, err_input, 'host_mass has a negative mass')
      else if (any(abs(given(:n, n + 1:)) > 0)) then
         call fail(error, err_input, 'host_mass couples the wall with floors on link springs: ' &
            //'their velocities are continuous at an impact')
      end if
   end subroutine require_masses

   !> Balance the momentum of wall, modes and host masses at an impact.
   subroutine balance_momentum(member, displacements, velocities, given, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: displacements(:)
      real(wp), intent(inout) :: velocities(:)
      real(wp), allocatable, intent(in) :: given(:, :)
      !! as in `land_member`
      type(error_t), allocatable, intent(out) :: error
      real(wp), dimension(1 + member%equation%beam%n, 1 + member%equation%beam%n) :: mass, host
      real(wp), dimension(1 + member%equation%beam%n) :: momentum, after
      real(wp) :: leverage, before
      !! stroke of the link per rotation [m]; moment of momentum per rotation [kg m2]
      integer :: n

      n = size(momentum)
      call find_masses(member, displacements, mass, host, given, error)
      if (allocated(error)) return
      associate (model => member%equation%model_t, beam => member%equation%beam, &
                 R => member%equation%p%R, v => velocities(:n))
         leverage = 2*R*member%equation%p%cos_alpha
         ! about the new corner, of the motion about the old one
         before = model%inertia*R**2 - 2*(R*model%p%sin_alpha)**2
         if (beam%n > 0) before = before + sum(beam%mass*displacements(2:n)**2)
         momentum = matmul(mass + host, v)
         momentum(1) = momentum(1) + (member%m_w*before/leverage**2 - mass(1, 1))*v(1)
         mass = mass + host
         after = solution(mass, momentum)
         if (after(1)*v(1) <= 0) then
            after(1) = 0
            if (n > 1) after(2:) = solution(mass(2:, 2:), momentum(2:))
         end if
         v = after
      end associate
   end subroutine balance_momentum

   !> Find the masses of the wall after an impact, and of the host or of the case's frame.
   subroutine find_masses(member, displacements, mass, host, given, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: displacements(:)
      real(wp), intent(out) :: mass(:, :), host(:, :)
      real(wp), allocatable, intent(in) :: given(:, :)
      !! as in `land_member`
      type(error_t), allocatable, intent(out) :: error
      type(wall_member_t) :: landed
      type(member_response_t) :: response
      type(link_motion_t) :: links
      real(wp) :: motion(size(displacements), 3)
      integer :: i, j, n

      n = size(mass, 1)
      landed = member
      motion = 0
      motion(2:, 1) = displacements(2:)
      call place_member(landed, merge(1, -1, member%committed%side <= 0), error)
      if (.not. allocated(error)) call respond_member(landed, motion, [0.0_wp, 0.0_wp], response, &
         error)
      if (.not. allocated(error)) call query_links(landed, motion, links, error)
      if (allocated(error)) return
      mass = response%mass(:n, :n)
      if (allocated(given)) then
         host = given(:n, :n)
         return
      end if
      do j = 1, n
         do i = 1, n
            host(i, j) = sum(member%frame_mass*links%derivatives(:, i)*links%derivatives(:, j))
         end do
      end do
   end subroutine find_masses

   !> True if the host may put a wall that has just landed to rest.
   !>
   !> A wall that is pressed down on both sides bounces, with flights of duration 2 v e**n/a. If
   !> their sum is shorter than a step, the host cannot resolve them. The error of neglecting them
   !> is of second order in the step. The host then sets u' to zero and the side to 0.
   logical function member_settles(member, dt, motion, ground, push, error, host_mass) &
      result(settles)
      type(wall_member_t), intent(in) :: member
      !! committed at u = 0
      real(wp), intent(in) :: dt
      !! >= 0, step of the host [s]
      real(wp), intent(in) :: motion(:, :)
      !! (dofs, 3) motion after the impact [m], [m/s], [m/s2]
      real(wp), intent(in) :: ground(2)
      !! horizontal and vertical ground acceleration [m/s2]
      real(wp), intent(in) :: push
      !! force of the host on u of the wall at rest [N]
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a hinged wall or a wall away from its base, and as in `respond_member`
      real(wp), intent(in), optional :: host_mass(:, :)
      !! (dofs, dofs) masses of the host; default: those of the case's frame [kg]
      real(wp), allocatable :: given(:, :)
      !! masses of the host; not allocated: those of the case's frame [kg]
      type(wall_member_t) :: resting
      type(member_response_t) :: response
      real(wp), dimension(1 + member%equation%beam%n, 1 + member%equation%beam%n) :: mass, host
      real(wp) :: pull, e
      !! acceleration towards the base [m/s2]; velocity factor of the next impact [-]

      settles = .false.
      if (present(host_mass)) given = host_mass
      call require_on_base(member, error)
      call require_number(dt, 'dt', not_negative, error)
      call require_number(push, 'push', any_number, error)
      call require_motion(member, motion, error)
      call require_ground(member, ground, error)
      call require_masses(member, given, error)
      if (allocated(error)) return
      resting = member
      call find_masses(member, motion(:, 1), mass, host, given, error)
      if (.not. allocated(error)) call place_member(resting, 0, error)
      if (.not. allocated(error)) call respond_member(resting, motion, ground, response, error, &
         has_tangents=.false.)
      if (.not. allocated(error)) call next_factor(member, motion, e, given, error)
      if (allocated(error)) return
      pull = -max(response%hold(1) - push, push - response%hold(2))/(mass(1, 1) + host(1, 1))
      settles = pull > 0 .and. 2*abs(motion(1, 2)) <= pull*(1 - e)*dt
   end function member_settles

   !> Velocity factor of the next impact, at least 0 [-].
   subroutine next_factor(member, motion, e, given, error)
      type(wall_member_t), intent(in) :: member
      real(wp), intent(in) :: motion(:, :)
      real(wp), intent(out) :: e
      real(wp), allocatable, intent(in) :: given(:, :)
      !! as in `land_member`
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: v(size(motion, 1))

      if (.not. member%balances) then
         e = largest_factor(member%restitution, abs(motion(1, 2)) &
            /(2*member%equation%p%R*member%equation%p%cos_alpha))
         return
      end if
      v = 0
      v(1) = -member%committed%side
      e = 0
      if (member%committed%side == 0) return
      call balance_momentum(member, motion(:, 1), v, given, error)
      e = abs(v(1))
   end subroutine next_factor

end module rwmf_embedding_member_events
