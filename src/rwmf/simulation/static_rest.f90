!> Static equilibrium of wall and frame after the motion.
!>
!> The search removes ground motion and velocities. It then reduces the remaining unbalanced forces
!> to zero in proportion, by Newton's method along straight pieces. On the way, springs enter their
!> next branch or unload.
!>
!> If the stiffness is not positive or branch changes form a cycle, the path follows damped
!> motion instead (implicit Euler steps in a fictitious time). This path releases energy in each
!> piece and cannot converge to an unstable equilibrium.
module rwmf_simulation_static_rest
   use rwmf_core_kinds, only: wp
   use rwmf_model_bent_wall, only: bent_mass_matrix
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_equation, only: discrete_state_t, enter_side, frame_travel, model_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_floors_yielding_storeys, only: pass_storey_limit, settle_storeys
   use rwmf_model_hysteresis_bouc_wen, only: follow_loading_direction
   use rwmf_model_hysteresis_spring_laws, only: loading_direction, spring_limits
   use rwmf_model_hysteresis_spring_set, only: pass_window, renew_window, turn_back
   use rwmf_model_lanes, only: lane_motion_t
   use rwmf_model_system_rest_after_chatter, only: hold_wall, release_wall
   implicit none
   private

   public :: come_to_rest, directions, turn_along, turn_springs, still_rates

   integer, parameter :: most_pieces = 2000
   !! largest number of pieces of a path, each up to the end of a branch
   real(wp), parameter :: still = 1.0e-13_wp
   !! relative change of a position below which the path ends [-]
   real(wp), parameter :: short = 0.1_wp
   !! largest change in one piece: of a smooth spring over its yield displacement, of theta over
   !! alpha [-]

   !> Path through static states.
   type :: path_t
      type(discrete_state_t) :: state
      real(wp), allocatable :: y(:)
      !! (states) with zero velocities
      logical :: is_held = .false.
      !! both corners of the wall are on the base
      integer, allocatable :: q(:)
      !! (free positions) their indices among the states
      integer, allocatable :: v(:)
      !! (free positions) indices of their velocities
      integer, allocatable :: z(:)
      !! (smooth springs) indices of their states
      real(wp) :: damping = 0
      !! damping of the masses over the fictitious time of a piece [1/s2]
      integer :: ends = 0
      !! number of consecutive branch ends without displacement between them
      integer :: solutions = 0
      !! number of linear systems solved so far
   end type path_t

   !> First branch end in a piece.
   type :: branch_end_t
      real(wp) :: part = 1
      !! fraction of the piece up to the branch end [-]
      integer :: storey = 0
      !! number of the storey whose branch ends
      logical :: of_window = .false.
      !! the branch of a spring that follows the rotation ends
      logical :: of_flight = .false.
      !! the wall returns to its base
      logical :: is_rising = .false.
      !! the displacement increases
   end type branch_end_t

contains

   !> Find the static equilibrium that a state reaches.
   !>
   !> The search fails if the wall overturns, if no equilibrium exists, or if it takes too long for
   !> hundreds of storeys.
   subroutine come_to_rest(model, state, overturning_angle, y, is_found)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      !! state at the end of the run, with the side of y; on return at rest
      real(wp), intent(in) :: overturning_angle
      !! [rad]
      real(wp), intent(inout) :: y(:)
      !! (states) at the end of the run; on return at rest
      logical, intent(out) :: is_found
      !! true if y is an equilibrium
      type(path_t) :: path
      real(wp) :: largest
      !! largest displacement so far [m]
      real(wp), allocatable :: change(:)
      integer :: i
      logical :: lifts

      path%state = state
      path%y = y
      ! list the indices of the states of smooth springs
      allocate (path%z(0))
      if (model%has_loading_direction) path%z = [model%hysteresis%place]
      if (allocated(model%floors%laws)) path%z = model%floors%laws%place
      path%is_held = model%has_impacts .and. abs(y(1)) <= 0
      call free_positions(model, path)
      largest = 0
      is_found = .false.
      do i = 1, most_pieces
         call find_change(model, path, change)
         if (takes_too_long(path)) return
         ! displacements of all positions, free or held [m]
         largest = max(largest, maxval(abs([frame_travel(model)*path%y(1), path%y(path%q) &
            *unit_lengths(model, path)])))
         if (all(abs(change*unit_lengths(model, path)) <= still*largest)) then
            lifts = .false.
            if (path%is_held) call lift_wall(model, path, lifts)
            is_found = .not. lifts
            if (is_found) exit
         else
            call follow_piece(model, path, change)
         end if
         if (model%has_wall .and. abs(path%y(1)) >= overturning_angle) return
         if (.not. all(abs(path%y) < sqrt(huge(largest)))) return
      end do
      if (.not. is_found) return
      state = path%state
      y = path%y
   end subroutine come_to_rest

   !> List the free positions: the wall or the bare frame, the floors with states, and the modes of
   !> the wall. Set their velocities to zero.
   pure subroutine free_positions(model, path)
      type(model_t), intent(in) :: model
      type(path_t), intent(inout) :: path
      integer :: i

      associate (first => model%floors%first, n => model%floors%free)
         path%q = [1, (first + i, i=0, n - 1)]
         path%v = [2, (first + n + i, i=0, n - 1)]
      end associate
      associate (first => model%beam%first, n => model%beam%n)
         path%q = [path%q, (first + i, i=0, n - 1)]
         path%v = [path%v, (first + n + i, i=0, n - 1)]
      end associate
      path%y(path%v) = 0
      call release_wall(path%state)
      if (path%is_held) then
         call hold_wall(path%state)
         path%q = path%q(2:)
         path%v = path%v(2:)
      end if
   end subroutine free_positions

   !> Displacement per unit of each free position [m/rad], [-].
   pure function unit_lengths(model, path) result(unit)
      type(model_t), intent(in) :: model
      type(path_t), intent(in) :: path
      real(wp) :: unit(size(path%q))

      unit = 1
      where (path%q == 1) unit = frame_travel(model)
   end function unit_lengths

   !> Compute motion and rates of a state without ground motion.
   subroutine still_rates(model, state, y, motion, rates)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(in) :: y(:)
      !! (states)
      type(lane_motion_t), intent(out) :: motion
      real(wp), intent(out) :: rates(:)
      !! (states)

      motion%ground = 0
      motion%upward = 0
      call lane_rates(model%scene, state%coef, y, motion, rates)
   end subroutine still_rates

   !> Compute the change of the free positions to equilibrium on the current branches. Springs whose
   !> velocity reverses in this change unload.
   subroutine find_change(model, path, change)
      type(model_t), intent(in) :: model
      type(path_t), intent(inout) :: path
      real(wp), allocatable, intent(out) :: change(:)
      !! (free positions)
      real(wp), allocatable :: stiffness(:, :)
      real(wp) :: rates(size(path%y))
      logical :: is_settled
      integer :: i
      type(lane_motion_t) :: motion

      allocate (change(size(path%q)), stiffness(size(path%q), size(path%q)))
      if (model%has_bilinear_springs) call renew_window(model, path%state)
      ! each spring unloads at most once; smooth springs may reverse again
      do i = 1, 2*(size(path%q) + 2)
         path%solutions = path%solutions + 1
         if (takes_too_long(path)) exit
         call still_rates(model, path%state, path%y, motion, rates)
         call stiffness_of(model, path, stiffness)
         call solve_stable(stiffness, path%damping, rates(path%v), mass_of(model, path), change)
         call turn_along(model, path%state, path%y, path%v, change, is_settled)
         if (is_settled) exit
      end do
   end subroutine find_change

   !> Return whether the linear solutions so far exceed a few seconds; each costs the cube of the
   !> positions.
   pure logical function takes_too_long(path)
      type(path_t), intent(in) :: path
      real(wp), parameter :: most_operations = 3.0e9_wp

      takes_too_long = path%solutions > max(2.0_wp, most_operations/(size(path%q) + 1.0_wp)**3)
   end function takes_too_long

   !> Loading directions of the current branches of all springs, 0 for either direction.
   pure function directions(model, state) result(direction)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, allocatable :: direction(:)

      direction = [state%signs%loading_direction]
      if (model%has_bilinear_springs) direction = [direction, &
         loading_direction(model%springs%spring, state%springs)]
      if (allocated(model%floors%springs)) direction = [direction, &
         loading_direction(model%floors%springs, state%storey_branches)]
      if (allocated(state%storey_signs)) direction = [direction, &
         state%storey_signs%loading_direction]
   end function directions

   !> Unload springs whose displacement changes against their loading direction, at the rates of the
   !> positions.
   subroutine turn_along(model, state, y, v, rates, is_settled)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states)
      integer, intent(in) :: v(:)
      !! (positions) indices of their velocities
      real(wp), intent(in) :: rates(:)
      !! (positions) in the unit of each per any time
      logical, intent(out) :: is_settled
      !! no spring has turned
      real(wp) :: along(size(y))
      integer, allocatable :: before(:)

      along = y
      along(v) = rates
      before = directions(model, state)
      call turn_springs(model, state, along)
      is_settled = all(before == directions(model, state))
   end subroutine turn_along

   !> Unload springs whose displacement changes against their loading direction.
   subroutine turn_springs(model, state, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states) their velocities have the signs of the change

      if (model%floors%yields) call settle_storeys(model, state, y, .false.)
      if (abs(y(2)) <= 0) return
      call turn_back(model, state, y(1), onward=int(sign(1.0_wp, y(2))))
      if (model%has_bilinear_springs) call renew_window(model, state)
      if (.not. model%has_loading_direction) return
      state%signs%loading_direction = int(sign(1.0_wp, y(2)))
      call follow_loading_direction(model, state, y)
   end subroutine turn_springs

   !> Stiffness over mass: decrease of the accelerations with the free positions, by central
   !> differences. States of smooth springs follow the positions [1/s2].
   subroutine stiffness_of(model, path, stiffness)
      type(model_t), intent(in) :: model
      type(path_t), intent(in) :: path
      real(wp), intent(out) :: stiffness(:, :)
      !! (free positions, free positions)
      real(wp), parameter :: small = 1.0e-6_wp
      !! displacement [m]
      real(wp), dimension(size(path%y)) :: y, along, forward, backward
      integer :: i
      type(lane_motion_t) :: motion

      associate (unit => unit_lengths(model, path))
         do i = 1, size(path%q)
            y = path%y
            y(path%v(i)) = 1
            call still_rates(model, path%state, y, motion, forward)
            along = 0
            along(path%q(i)) = small/unit(i)
            along(path%z) = forward(path%z)*small/unit(i)
            call still_rates(model, path%state, path%y + along, motion, forward)
            call still_rates(model, path%state, path%y - along, motion, backward)
            stiffness(:, i) = (backward(path%v) - forward(path%v))*(unit(i)/(2*small))
         end do
      end associate
   end subroutine stiffness_of

   !> Mass matrix of rotation and modes among the free positions, which a bending wall couples; of
   !> size 0 for a rigid wall.
   pure function mass_of(model, path) result(mass)
      type(model_t), intent(in) :: model
      type(path_t), intent(in) :: path
      real(wp), allocatable :: mass(:, :)
      !! (free positions, free positions)
      real(wp) :: full(0:model%beam%n, 0:model%beam%n)
      integer, allocatable :: own(:)
      integer :: i, n

      allocate (mass(0, 0))
      if (model%beam%n == 0) return
      n = size(path%q)
      full = bent_mass_matrix(model)
      own = [(i, i=n - model%beam%n + 1, n)]
      deallocate (mass)
      allocate (mass(n, n), source=0.0_wp)
      do i = 1, n
         mass(i, i) = 1
      end do
      if (path%is_held) then
         mass(own, own) = full(1:, 1:)
      else
         own = [1, own]
         mass(own, own) = full
      end if
   end function mass_of

   !> Solve for the change of the positions.
   !>
   !> If the stiffness is not positive, use a fictitious time step so short that the damped motion
   !> leaves its unstable equilibrium.
   pure subroutine solve_stable(stiffness, least_damping, push, mass, change)
      real(wp), intent(in) :: stiffness(:, :)
      real(wp), intent(in) :: least_damping
      !! damping of the masses over the fictitious time [1/s2]
      real(wp), intent(in) :: push(:)
      !! accelerations of the free positions
      real(wp), intent(in) :: mass(:, :)
      !! mass matrix that makes the stiffness symmetric; of size 0 if it is diagonal
      real(wp), intent(out) :: change(:)
      real(wp), allocatable :: a(:, :), b(:)
      real(wp) :: damping
      logical :: is_positive
      integer :: i

      damping = least_damping
      do
         a = stiffness
         do i = 1, size(push)
            a(i, i) = a(i, i) + damping
         end do
         b = push
         if (size(mass) > 0) then
            a = matmul(mass, a)
            b = matmul(mass, b)
         end if
         call eliminate(a, b, change, is_positive)
         if (is_positive) return
         ! a stiffness that is not finite gives no solution
         if (.not. damping < huge(damping)) then
            change = huge(change)
            return
         end if
         damping = max(4*damping, 1.0e-3_wp*maxval(abs(stiffness)), 1.0e-3_wp)
      end do
   end subroutine solve_stable

   !> Gaussian elimination in the given order.
   !>
   !> All pivots are positive if the symmetric matrix is positive definite; its rows may have been
   !> divided by masses.
   pure subroutine eliminate(a, b, x, is_positive)
      real(wp), intent(inout) :: a(:, :)
      real(wp), intent(in) :: b(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: is_positive
      real(wp), parameter :: negligible = 1.0e-9_wp
      !! pivot over its diagonal, for errors of the difference quotients [-]
      real(wp) :: diagonal(size(b))
      integer :: i, j

      diagonal = [(abs(a(i, i)), i=1, size(b))]
      x = b
      do i = 1, size(b)
         is_positive = a(i, i) > negligible*diagonal(i)
         if (.not. is_positive) return
         do j = i + 1, size(b)
            ! only neighbouring floors are coupled
            if (abs(a(j, i)) <= 0) cycle
            associate (factor => a(j, i)/a(i, i))
               x(j) = x(j) - factor*x(i)
               a(j, i:) = a(j, i:) - factor*a(i, i:)
            end associate
         end do
      end do
      is_positive = .true.
      do i = size(b), 1, -1
         x(i) = (x(i) - dot_product(a(i, i + 1:), x(i + 1:)))/a(i, i)
      end do
   end subroutine eliminate

   !> Apply a change of the positions up to the first branch end.
   subroutine follow_piece(model, path, change)
      type(model_t), intent(in) :: model
      type(path_t), intent(inout) :: path
      real(wp), intent(in) :: change(:)
      !! (free positions)
      type(branch_end_t) :: ending
      integer, parameter :: most_ends = 8
      !! largest number of consecutive branch ends per position
      real(wp), parameter :: least = 1.0_wp, most = 1.0e9_wp
      !! bounds of the damping [1/s2]

      call find_end(model, path, change, ending)
      ! Adapt the damping if consecutive branch ends form a cycle.
      !
      ! Springs whose loading directions depend on each other may reverse each other without end.
      ! Damping ends this cycle, because the forces alone then determine the change.
      path%ends = path%ends + 1
      if (ending%part > 0) then
         path%ends = 0
         path%damping = path%damping/4
         if (path%damping < least) path%damping = 0
      else if (path%ends > most_ends*(size(path%q) + 1)) then
         path%ends = 0
         path%damping = min(max(16*path%damping, least), most)
      end if
      call move_along(model, path, ending%part*change)
      if (ending%storey > 0) then
         call pass_storey_limit(model, path%state, ending%storey, ending%is_rising)
      else if (ending%of_window) then
         path%y(1) = merge(path%state%high, path%state%low, ending%is_rising)
         call pass_window(model, path%state, ending%is_rising)
      else if (ending%of_flight) then
         path%y(1) = 0
         path%is_held = .true.
         call free_positions(model, path)
      end if
   end subroutine follow_piece

   !> Find the first branch end of a piece.
   subroutine find_end(model, path, change, ending)
      type(model_t), intent(in) :: model
      type(path_t), intent(in) :: path
      real(wp), intent(in) :: change(:)
      type(branch_end_t), intent(out) :: ending
      real(wp), dimension(model%floors%n_storeys, 2) :: d
      real(wp) :: rate(model%floors%n_storeys), y(size(path%y)), limit, low, high
      integer :: i

      y = path%y
      y(path%q) = y(path%q) + change
      associate (from => path%y(1), to => y(1))
         limit = short*model%p%alpha
         if (model%has_wall .and. abs(to - from) > limit) ending%part = limit/abs(to - from)
         if (model%has_loading_direction) call cut(frame_travel(model)*abs(to - from), &
            short*model%hysteresis%u_y, ending)
         if (model%has_impacts .and. path%state%side*to < 0) call cut_at(from, to, 0.0_wp, &
            branch_end_t(of_flight=.true.), ending)
         if (model%has_bilinear_springs) then
            if (to > path%state%high) call cut_at(from, to, path%state%high, &
               branch_end_t(of_window=.true., is_rising=.true.), ending)
            if (to < path%state%low) call cut_at(from, to, path%state%low, &
               branch_end_t(of_window=.true.), ending)
         end if
      end associate
      if (.not. model%floors%yields) return
      call storey_motion(model, path%state%side, path%y, d(:, 1), rate)
      call storey_motion(model, path%state%side, y, d(:, 2), rate)
      do i = 1, model%floors%n_storeys
         if (allocated(model%floors%laws)) then
            call cut(abs(d(i, 2) - d(i, 1)), short*model%floors%laws(i)%u_y, ending)
            cycle
         end if
         call spring_limits(model%floors%springs(i), path%state%storey_branches(i), low, high)
         if (d(i, 2) > d(i, 1) .and. d(i, 2) > high) call cut_at(d(i, 1), d(i, 2), high, &
            branch_end_t(storey=i, is_rising=.true.), ending)
         if (d(i, 2) < d(i, 1) .and. d(i, 2) < low) call cut_at(d(i, 1), d(i, 2), low, &
            branch_end_t(storey=i), ending)
      end do
   end subroutine find_end

   !> Shorten a piece to a largest displacement.
   pure subroutine cut(distance, limit, ending)
      real(wp), intent(in) :: distance
      real(wp), intent(in) :: limit
      type(branch_end_t), intent(inout) :: ending

      if (distance*ending%part > limit) ending = branch_end_t(part=limit/distance)
   end subroutine cut

   !> End a piece where a displacement reaches a limit.
   pure subroutine cut_at(from, to, limit, candidate, ending)
      real(wp), intent(in) :: from, to
      !! displacements at both ends of the whole piece
      real(wp), intent(in) :: limit
      type(branch_end_t), intent(in) :: candidate
      !! branch end at this limit
      type(branch_end_t), intent(inout) :: ending
      real(wp) :: part

      part = min(max((limit - from)/(to - from), 0.0_wp), 1.0_wp)
      if (part >= ending%part .and. ending%part < 1) return
      ending = candidate
      ending%part = part
   end subroutine cut_at

   !> Move the free positions and integrate the states of smooth springs (fourth-order Runge-Kutta).
   subroutine move_along(model, path, change)
      type(model_t), intent(in) :: model
      type(path_t), intent(inout) :: path
      real(wp), intent(in) :: change(:)
      integer, parameter :: n = 16
      !! number of steps for a change of `short`
      real(wp), parameter :: halves(4) = [0.0_wp, 0.5_wp, 0.5_wp, 1.0_wp]
      real(wp), parameter :: weights(4) = [1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp]/6
      real(wp), dimension(size(path%y)) :: y, rates, total
      logical :: is_settled
      integer :: i, j
      type(lane_motion_t) :: motion

      do i = 1, merge(n, 0, size(path%z) > 0)
         y = path%y
         y(path%v) = change/n
         rates = 0
         total = 0
         do j = 1, 4
            y(path%z) = path%y(path%z) + halves(j)*rates(path%z)
            y(path%q) = path%y(path%q) + halves(j)*change/n
            call still_rates(model, path%state, y, motion, rates)
            total(path%z) = total(path%z) + weights(j)*rates(path%z)
         end do
         path%y(path%z) = path%y(path%z) + total(path%z)
         path%y(path%q) = path%y(path%q) + change/n
         call turn_along(model, path%state, path%y, path%v, change, is_settled)
      end do
      if (size(path%z) == 0) path%y(path%q) = path%y(path%q) + change
   end subroutine move_along

   !> Release a wall on its base if it lifts off on a side.
   subroutine lift_wall(model, path, lifts)
      type(model_t), intent(in) :: model
      type(path_t), intent(inout) :: path
      logical, intent(out) :: lifts
      real(wp), parameter :: negligible = 1.0e-12_wp
      !! angular acceleration over g/R [-]
      real(wp) :: rates(size(path%y))
      integer :: side
      type(lane_motion_t) :: motion

      call release_wall(path%state)
      do side = -1, 1, 2
         call enter_side(model, path%state, side)
         call still_rates(model, path%state, path%y, motion, rates)
         lifts = side*rates(2) > negligible*model%p%g_over_R
         if (.not. lifts) cycle
         path%is_held = .false.
         call free_positions(model, path)
         return
      end do
   end subroutine lift_wall

end module rwmf_simulation_static_rest
