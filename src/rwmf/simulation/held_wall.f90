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
   use rwmf_math_sign_changes, only: no_change
   use rwmf_model_assembly, only: equation_t, interval_of, lift_off_drive, rates_at, rhs
   use rwmf_model_effects_storeys_yielding_storeys, only: settle_storeys
   use rwmf_model_equation, only: discrete_state_t
   use rwmf_model_lift_off, only: find_bearing, find_uplift_acceleration, lifts
   use rwmf_model_rest, only: inverse_inertia, pressing_acceleration
   use rwmf_motion_ground_motion, only: interval_end, is_known_until
   use rwmf_simulation_events_drift_events, only: cut_step
   use rwmf_simulation_events_first_change, only: changes_in, functions_t, moment_t, &
      sample_functions, span_between, span_t, stop_at_change, watch_t
   use rwmf_simulation_events_step_view, only: sample_state, step_view_t, view_step
   use rwmf_simulation_events_storey_events, only: storey_end_t
   use rwmf_simulation_hybrid_state, only: change_storey, hybrid_t, pass_knot
   use rwmf_simulation_recorder_recorder, only: observe_piece, recorder_t
   implicit none
   private

   public :: hold_wall, move_at_rest, may_rest_moving, begin_held_step, end_held_step, stays_down
   public :: elastic_loss

   real(wp), parameter :: elastic_loss = 1.0_wp/640
   !! part of the velocity lost at an impact up to which bounces may have no end [-]

   !> What is left until the wall lifts off to the right and to the left [m/s2], with its rates.
   type, extends(functions_t) :: bearing_t
   contains
      procedure :: evaluate => evaluate_bearing
   end type bearing_t

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
         equation%model_t, equation%state, hybrid%y, hybrid%t <= hybrid%t_turn)
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
   logical function stays_down(step, rates_a, rates_b)
      type(step_view_t), intent(in) :: step
      !! without an integrator
      real(wp), intent(in) :: rates_a(:), rates_b(:)
      !! (states) at both ends
      type(bearing_t) :: bearing
      type(moment_t) :: a, b
      type(span_t) :: span

      bearing%step = step
      a%t = step%t_a
      b%t = step%t_b
      allocate (a%f(2, 0:1), b%f(2, 0:1))
      a%f = bearing_at(step, a%t, step%y_a, rates_a)
      b%f = bearing_at(step, b%t, step%y_b, rates_b)
      span = span_between(bearing, a, b)
      stays_down = changes_in(span, watch_lift_off(step, 1)) == no_change
      if (stays_down) stays_down = changes_in(span, watch_lift_off(step, 2)) == no_change
   end function stays_down

   subroutine evaluate_bearing(self, t, y, f)
      class(bearing_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: rates(size(y))

      call rates_at(self%step%equation, t, y, rates)
      allocate (f(2, 0:1))
      f = bearing_at(self%step, t, y, rates)
   end subroutine evaluate_bearing

   !> What is left until the wall lifts off to the right and to the left [m/s2], and its rates. What
   !> the wall bears is linear in the other states.
   function bearing_at(step, t, y, rates) result(f)
      type(step_view_t), intent(in) :: step
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:), rates(:)
      !! (states), and their rates
      real(wp) :: f(2, 0:1)
      real(wp), parameter :: part = 1.0e-5_wp
      !! of the step, in which the motion of the ground is nearly straight [-]
      real(wp) :: later(2), h

      associate (equation => step%equation)
         h = step%t_b - step%t_a
         later = -drives(equation, t, y + h*rates)
         f(:, 0) = -drives(equation, t, y)
         f(:, 1) = (later - f(:, 0))/h - (drives_of(equation, t + part*h) &
            - drives_of(equation, t - part*h))/(2*part*h)
      end associate
   end function bearing_at

   !> The wall stays on a side, the first one being the right.
   pure type(watch_t) function watch_lift_off(step, which) result(watch)
      type(step_view_t), intent(in) :: step
      integer, intent(in) :: which

      watch = watch_t(which, 0, level=-4*epsilon(1.0_wp)*step%equation%threshold)
   end function watch_lift_off

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
   subroutine search_lift_off(hybrid, step, side, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(step_view_t), intent(in) :: step
      integer, intent(out) :: side
      type(error_t), allocatable, intent(out) :: error
      type(bearing_t) :: bearing
      type(moment_t) :: a, b
      type(span_t) :: span
      logical :: is_found
      integer :: i

      hybrid%t = step%t_a
      hybrid%y(:) = step%y_a
      side = lifting_side(drives(step%equation, step%t_a, step%y_a), step%equation%threshold)
      if (side /= 0) return
      bearing%step = step
      call sample_functions(bearing, step%t_a, a, error)
      if (.not. allocated(error)) call sample_functions(bearing, step%t_b, b, error)
      if (allocated(error)) return
      span = span_between(bearing, a, b)
      do i = 1, 2
         call stop_at_change(bearing, watch_lift_off(step, i), span, is_found, error)
         if (allocated(error)) return
         if (is_found) side = merge(1, -1, i == 1)
      end do
      hybrid%t = span%b%t
      call sample_state(step, hybrid%t, hybrid%y, error)
      call find_uplift_acceleration(step%equation%model_t, step%equation%state, hybrid%y)
   end subroutine search_lift_off

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
