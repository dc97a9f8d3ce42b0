!> A wall that rests while other parts of the scene go on moving: the floors of a frame whose roof
!> is linked to it.
!>
!> theta is held at 0 and the other states are integrated. What the wall bears then depends on them,
!> so that lift-off is a root of a drive that is known only step by step, and no rest can be
!> promised from the ground motion alone.
module rwmf_simulation_held_wall
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_integrator, only: integrator_t
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, narrow
   use rwmf_model_assembly, only: equation_t, interval_of, lift_off_drive, rhs
   use rwmf_model_effects_storeys_yielding_storeys, only: settle_storeys
   use rwmf_model_equation, only: discrete_state_t
   use rwmf_model_lift_off, only: drive_turns, find_bearing, find_uplift_acceleration, lifts
   use rwmf_model_rest, only: inverse_inertia, pressing_acceleration
   use rwmf_motion_ground_motion, only: interval_end, is_known_until
   use rwmf_simulation_events_drift_events, only: cut_step
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, sample_state, &
      step_view_t, view_step
   use rwmf_simulation_events_storey_events, only: storey_end_t
   use rwmf_simulation_hybrid_state, only: change_storey, hybrid_t, pass_knot
   use rwmf_simulation_recorder_recorder, only: observe_piece, recorder_t
   implicit none
   private

   public :: hold_wall, move_at_rest, may_rest_moving, begin_held_step, end_held_step, stays_down
   public :: elastic_loss

   real(wp), parameter :: elastic_loss = 1.0_wp/640
   !! part of the velocity lost at an impact up to which bounces may have no end [-]

contains

   !> Hold the resting wall while further states move, or let it go.
   subroutine hold_wall(state, is_held)
      type(discrete_state_t), intent(inout) :: state
      logical, intent(in) :: is_held
      !! the wall stays where it is

      state%coef(1, 1) = merge(0, 1, is_held)
   end subroutine hold_wall

   !> One step of the other states, cut where the wall lifts off.
   subroutine move_at_rest(hybrid, equation, integrator, recorder, t_target, side, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      integer, intent(out) :: side
      !! of the motion that begins, +1 or -1; 0 for none
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: t_limit

      call begin_held_step(hybrid, equation, integrator%steps, t_target, t_limit, side)
      if (t_limit <= hybrid%t) return
      if (hybrid%must_restart) then
         call integrator%start(hybrid%t, hybrid%y, huge(t_limit), error)
         if (allocated(error)) return
      end if
      hybrid%must_restart = .false.
      call integrator%step(t_limit, error)
      if (.not. allocated(error)) call end_held_step(hybrid, equation, integrator, recorder, side, &
         error)
   end subroutine move_at_rest

   !> How far the other states may go in the next step while the wall is held.
   subroutine begin_held_step(hybrid, equation, steps, t_target, t_limit, side)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      integer(i8), intent(in) :: steps
      !! that the integrator has taken
      real(wp), intent(in) :: t_target
      !! [s]
      real(wp), intent(out) :: t_limit
      !! not beyond the present time: the wall lifts off, or a knot has been passed [s]
      integer, intent(out) :: side
      !! on which it lifts off at once, 0 if it stays

      t_limit = hybrid%t
      side = lifting_side(drives(equation, hybrid%t, hybrid%y), equation%threshold)
      if (side /= 0) return
      t_limit = min(t_target, interval_end(equation%motion, interval_of(equation)))
      if (t_limit - hybrid%t <= 8*spacing(t_limit)) then
         hybrid%t = t_limit
         call pass_knot(hybrid, equation, steps)
         return
      end if
      call hold_wall(equation%state, .true.)
      if (hybrid%must_restart .and. equation%floors%yields) call settle_storeys( &
         equation%model_t, equation%state, hybrid%y)
      call find_bearing(equation%model_t, equation%state)
   end subroutine begin_held_step

   !> Look at the last step: the wall may lift off in it.
   subroutine end_held_step(hybrid, equation, integrator, recorder, side, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      integer, intent(out) :: side
      !! to which the wall lifts off, +1 or -1; 0 when it goes on resting
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(storey_end_t) :: ending
      type(step_view_t) :: step

      side = 0
      call view_step(step, equation, integrator)
      call cut_step(step, hybrid%drifts, ending, error)
      if (allocated(error)) return
      call search_lift_off(hybrid, step, side, error)
      if (allocated(error)) return
      ! an implicit method solves for all states together, which leaves round-off in those held
      hybrid%y(:2) = 0
      ! a motion that jumps where the step begins lifts the wall at once: that is no rest
      if (side /= 0 .and. hybrid%t <= step%t_a) return
      step%t_b = hybrid%t
      step%y_b => hybrid%y
      call observe_piece(recorder, step, error)
      if (allocated(error)) return
      if (side /= 0) return
      if (ending%storey > 0) call change_storey(hybrid, equation, recorder, ending)
      call pass_knot(hybrid, equation, integrator%steps)
   end subroutine end_held_step

   !> Is it plain from the ends of a step that the held wall stays down in it?
   !>
   !> What it bears follows the other states, along a cubic inside the polygon of its Bezier points.
   logical function stays_down(step, rates_a, rates_b)
      type(step_view_t), intent(in) :: step
      !! without an integrator
      real(wp), intent(in) :: rates_a(:), rates_b(:)
      !! (states) at both ends
      real(wp), parameter :: margin = 0.1_wp
      !! for what the cubic errs, over the size of the polygon [-]
      real(wp) :: push(2, 2)
      !! of the motion to the right and to the left, at both ends [m/s2]
      real(wp) :: borne(2, 4)
      !! points of what is borne [m/s2]

      ! the push of the ground is largest at an end, if it does not turn in between
      stays_down = drive_turns(step%equation, interval_of(step%equation), step%t_a) >= step%t_b
      if (.not. stays_down) return
      associate (equation => step%equation, h => step%t_b - step%t_a)
         borne(:, 2) = borne_at(equation, step%y_a + h/3*rates_a)
         borne(:, 1) = borne_at(equation, step%y_a)
         push(:, 1) = borne(:, 1) + drives_of(equation, step%t_a)
         borne(:, 3) = borne_at(equation, step%y_b - h/3*rates_b)
         borne(:, 4) = borne_at(equation, step%y_b)
         push(:, 2) = borne(:, 4) + drives_of(equation, step%t_b)
      end associate
      stays_down = all(maxval(push, dim=2) < minval(borne, dim=2) &
         - margin*(maxval(borne, dim=2) - minval(borne, dim=2)))
   end function stays_down

   !> Ground acceleration that the held wall bears to the right and to the left [m/s2].
   function borne_at(equation, y) result(borne)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: borne(2)

      call find_uplift_acceleration(equation%model_t, equation%state, y)
      borne = equation%state%uplift_acceleration([1, -1])
   end function borne_at

   !> How far the scene exceeds what the resting wall bears, to the right and to the left [m/s2].
   function drives(equation, t, y) result(drive)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! in the interval in force [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: drive(2)

      call find_uplift_acceleration(equation%model_t, equation%state, y)
      drive = drives_of(equation, t)
   end function drives

   !> The same for what the wall bears at present.
   pure function drives_of(equation, t) result(drive)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! in the interval in force [s]
      real(wp) :: drive(2)

      drive(1) = lift_off_drive(equation, 1, interval_of(equation), t)
      drive(2) = lift_off_drive(equation, -1, interval_of(equation), t)
   end function drives_of

   !> Side on which the wall lifts off, 0 if it stays.
   pure integer function lifting_side(drive, threshold) result(side)
      real(wp), intent(in) :: drive(2)
      real(wp), intent(in) :: threshold

      side = 0
      if (lifts(drive(1), threshold)) side = 1
      if (lifts(drive(2), threshold)) side = -1
   end function lifting_side

   !> First lift-off in the last step; leaves time and state of it, or of the end of the step, in
   !> hybrid.
   !>
   !> The step is searched in parts of a quarter of the shortest period. A maximum inside a part
   !> shows in the parabola through its ends and its middle.
   subroutine search_lift_off(hybrid, step, side, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: step
      integer, intent(out) :: side
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t(3)
      real(wp) :: d(2, 3)
      !! drives at both ends and the middle of a part [m/s2]
      real(wp) :: x
      integer :: i, n

      n = count_parts(step)
      hybrid%y(:) = step%y_a
      t(3) = step%t_a
      d(:, 3) = drives(step%equation, t(3), hybrid%y)
      hybrid%t = t(3)
      side = lifting_side(d(:, 3), step%equation%threshold)
      if (side /= 0) return
      do i = 1, n
         t = [t(3), end_of_part(step, 2*i - 1, 2*n), end_of_part(step, 2*i, 2*n)]
         d(:, 1) = d(:, 3)
         call sample_drive(t(2), t(1), d(:, 2))
         if (allocated(error) .or. side /= 0) return
         call sample_drive(t(3), t(2), d(:, 3))
         if (allocated(error) .or. side /= 0) return
         x = promising_place(d)
         if (x > 0 .and. x < 1) call sample_drive(t(1) + x*(t(3) - t(1)), t(1), d(:, 1))
         if (allocated(error) .or. side /= 0) return
      end do
      hybrid%t = step%t_b
      hybrid%y(:) = step%y_b

   contains

      !> Drives at a time; when the wall has lifted by then, the first time at which it has.
      subroutine sample_drive(at, before, drive)
         real(wp), intent(in) :: at
         real(wp), intent(in) :: before
         !! a time at which it rests [s]
         real(wp), intent(out) :: drive(2)

         call sample_state(step, at, hybrid%y, error)
         if (allocated(error)) return
         drive = drives(step%equation, at, hybrid%y)
         side = lifting_side(drive, step%equation%threshold)
         hybrid%t = at
         if (side /= 0) call refine(hybrid, step, before, side, error)
      end subroutine sample_drive
   end subroutine search_lift_off

   !> Place in a part at which the drive of a side may exceed zero between three values that do
   !> not, 0 for none [-].
   pure real(wp) function promising_place(d) result(x)
      real(wp), intent(in) :: d(2, 3)
      real(wp) :: slope
      real(wp) :: bend
      real(wp) :: top
      integer :: i

      x = 0
      do i = 1, 2
         slope = (d(i, 3) - d(i, 1))/2
         bend = d(i, 3) - 2*d(i, 2) + d(i, 1)
         if (.not. bend < -abs(slope)) cycle
         top = d(i, 2) - slope**2/(2*bend)
         if (top > 0.1_wp*bend) x = 0.5_wp - slope/(2*bend)
      end do
   end function promising_place

   !> Bisect to the first time at which the wall has lifted, from the time in hybrid.
   subroutine refine(hybrid, step, before, side, error)
      type(hybrid_t), intent(inout) :: hybrid
      !! at a time when it has; on return at the first
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: before
      integer, intent(inout) :: side
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      real(wp) :: y(size(step%y_a))
      integer :: side_there

      bracket = bracket_between(before, hybrid%t)
      do while (is_wider(bracket, 1))
         call step%integrator%state_at(bracket%middle, y, error)
         if (allocated(error)) return
         side_there = lifting_side(drives(step%equation, bracket%middle, y), &
            step%equation%threshold)
         call narrow(bracket, side_there /= 0)
         if (side_there == 0) cycle
         hybrid%y(:) = y
         side = side_there
      end do
      hybrid%t = bracket%high
      call find_uplift_acceleration(step%equation%model_t, step%equation%state, hybrid%y)
   end subroutine refine

   !> May the wall be put to rest after an impact that leaves it the velocity v?
   !>
   !> As `may_rest` of `rest.f90`, but the pressure changes with the other states. So the chatter
   !> must end within a tenth of their shortest period, and the pressure is reduced by twice what
   !> their present rates make of it in that time, and by a bound on their acceleration.
   !>
   !> Bounces that hardly lose energy would go on below the resolution; the wall rests when many of
   !> them are sure to follow within the shortest period over 2 pi. What is dropped is less than
   !> the tolerance of the energy.
   logical function may_rest_moving(equation, t, y, v, e, small_angle, small_velocity) &
      result(may_rest)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: small_velocity
      !! negligible angular velocity [rad/s]
      real(wp), parameter :: flights = 64
      real(wp) :: press
      real(wp) :: gain
      real(wp) :: loss
      !! of velocity at an impact, or over half the number of flights [-]
      real(wp) :: chatter
      !! how long it may last [s]
      real(wp) :: longest
      !! the same over the shortest period over 2 pi [-]
      real(wp) :: change
      !! of the pressure in that time [m/s2]

      may_rest = .false.
      press = pressing_acceleration(equation, t, t)
      if (press <= 0) return
      gain = inverse_inertia(equation)
      may_rest = v <= max(small_velocity, press*gain*64*spacing(t))
      if (may_rest .or. v**2 > 2*press*gain*small_angle) return
      loss = 1 - e
      longest = 0.1_wp
      if (loss <= elastic_loss) then
         loss = 2/flights
         longest = 1
      end if
      chatter = 4*v/(press*gain*loss)
      if (chatter*equation%floors%max_frequency > longest) return
      if (.not. is_known_until(equation%motion, interval_of(equation), t + chatter)) return
      call bound_change(equation, t, y, chatter, change)
      press = pressing_acceleration(equation, t, t + chatter) - change
      may_rest = press > 0 .and. 2*v <= press*gain*loss*chatter
   end function may_rest_moving

   !> By how much the other states may change what the wall bears within a time.
   subroutine bound_change(equation, t, y, duration, change)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: duration
      !! much shorter than their shortest period [s]
      real(wp), intent(out) :: change
      !! [m/s2]
      real(wp) :: held(size(y))
      real(wp) :: rates(size(y))
      real(wp) :: present(-1:1)
      real(wp) :: later(-1:1)
      real(wp) :: displaced

      held = y
      held(:2) = 0
      present = equation%state%uplift_acceleration
      call hold_wall(equation%state, .true.)
      call rhs(equation, t, held, rates)
      call hold_wall(equation%state, .false.)
      call find_uplift_acceleration(equation%model_t, equation%state, held + duration*rates)
      later = equation%state%uplift_acceleration
      call find_uplift_acceleration(equation%model_t, equation%state, y)
      displaced = maxval(abs(present([-1, 1]) - equation%threshold))
      change = 2*maxval(abs(later([-1, 1]) - present([-1, 1]))) &
         + (duration*equation%floors%max_frequency)**2*displaced
   end subroutine bound_change

end module rwmf_simulation_held_wall
