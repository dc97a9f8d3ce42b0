!> State of the hybrid system and its change at knots of the motion.
module rwmf_simulation_state_hybrid_state
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_restitution, only: restitution_t
   use rwmf_model_system_assembly, only: enter_interval, equation_t, interval_of
   use rwmf_motion_ground_motion, only: has_jump, interval_end
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: hybrid_t, hybrid_state_t, creep_t, progress_t, count_steps, has_ended, is_at_rest
   public :: advance_interval, check_progress, check_creep, most_creeping
   public :: mode_rest, mode_held, mode_rocking, mode_overturned, mode_no_impacts, mode_collapsed

   integer, parameter :: mode_rest = 0
   !! both corners on the base; only the ground moves
   integer, parameter :: mode_rocking = 1
   integer, parameter :: mode_overturned = 2
   integer, parameter :: mode_no_impacts = 3
   !! bare frame or hinged wall: a single smooth regime
   integer, parameter :: mode_collapsed = 4
   !! a drift has exceeded its limit
   integer, parameter :: mode_held = 5
   !! both corners on the base, theta = 0, while further states move

   integer(i8), parameter :: cost_of_restart = 30_i8
   !! steps that a multistep method needs after a restart to reach its full step length

   !> State of the hybrid system.
   type :: hybrid_state_t
      integer :: mode = mode_rest
      real(wp) :: t = 0
      !! [s]
      real(wp), allocatable :: y(:)
      !! (states)
      logical :: must_restart = .true.
      !! the integrator must restart at (t, y)
   end type hybrid_state_t

   !> Progress of a run in time, over a number of steps and events.
   type :: progress_t
      integer :: count = 0
      !! number of steps and events since `t`
      real(wp) :: t = -huge(1.0_wp)
      !! [s]
   end type progress_t

   !> Progress of a wall whose nonlinear dampers may hold it almost still while it is displaced.
   type :: creep_t
      real(wp) :: exponent = 0
      !! of the dampers; 0 without them [-]
      real(wp) :: shortest = 0
      !! time by which `most_creeping` steps must advance the run [s]
      integer(i8) :: steps = 0_i8
      !! number of steps of the integrator at the beginning of the count
      real(wp) :: t = -huge(1.0_wp)
      !! [s]
   end type creep_t

   integer(i8), parameter :: most_creeping = 30000_i8
   !! number of steps over which the progress of a creeping wall counts

   !> State of the hybrid system with the parameters of its transitions.
   type, extends(hybrid_state_t) :: hybrid_t
      type(restitution_t) :: restitution
      !! velocity factor at impact
      real(wp) :: overturning_angle
      !! [rad]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer(i8) :: max_steps
      real(wp) :: settled_angle = 0
      !! fraction of the largest rotation below which decaying chatter may be omitted; nonzero only
      !! if the largest displacement is the only requested output [-]
      real(wp) :: t_pulled = 0
      !! next time at which the motion pulls a side of the wall up, if known [s]
      integer :: drifts = 0
      !! number of drifts with a collapse limit
      real(wp) :: flight = 0
      !! estimated duration of the new flight; 0 if unknown [s]
      real(wp) :: t_turn = -huge(1.0_wp)
      !! time of a storey's last velocity reversal since an impact or a lift-off. The new direction
      !! is then known, despite round-off in the rate [s]
      integer(i8) :: steps_at_knot = 0_i8
      !! number of steps of the integrator at the start of the current interval
      type(progress_t) :: progress
      !! progress in the present advance
      type(creep_t) :: creep
      logical :: stops_at_impact = .false.
      !! an advance ends at the first impact
      logical :: is_stopped = .false.
      !! the advance has ended at an impact
   end type hybrid_t

contains

   !> Return whether overturning or collapse has ended the motion early.
   pure logical function has_ended(hybrid)
      type(hybrid_t), intent(in) :: hybrid

      has_ended = hybrid%mode == mode_overturned .or. hybrid%mode == mode_collapsed
   end function has_ended

   !> Count a step or an event, and fail if round-off holds the run at nearly the same time.
   !>
   !> The shortest flights last 64 spacings of the time and take a few steps each. All storeys may
   !> reverse at one instant.
   subroutine check_progress(progress, n_states, t, error)
      type(progress_t), intent(inout) :: progress
      integer, intent(in) :: n_states
      !! number of states
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most = 1000
      !! number of steps and events, without those of the storeys, in which the time must advance by
      !! as many of its spacings

      progress%count = progress%count + 1
      if (progress%count < most + 4*n_states) return
      if (t - progress%t <= most*spacing(t)) call fail(error, err_numerical, &
         'no step leads on from t = '//trim(real_to_text(t)) &
         //' s: the motion is lost in round-off; raise rtol', 'too_many_steps')
      progress = progress_t(t=t)
   end subroutine check_progress

   !> Fail if nonlinear dampers hold the displaced wall almost still.
   !>
   !> Below the exponent 1 the slope of their force grows without bound at zero velocity. A creeping
   !> wall then makes the equation so stiff that no step gets ahead.
   subroutine check_creep(creep, steps, t, error)
      type(creep_t), intent(inout) :: creep
      integer(i8), intent(in) :: steps
      !! number of steps of the integrator so far
      real(wp), intent(in) :: t
      !! [s]
      type(error_t), allocatable, intent(out) :: error

      if (.not. creep%exponent > 0 .or. steps - creep%steps < most_creeping) return
      if (t - creep%t < creep%shortest) call fail(error, err_numerical, '&nl_damper: exponent = ' &
         //trim(real_to_text(creep%exponent))//': the dampers hold the displaced wall almost ' &
         //'still at t = '//trim(real_to_text(t))//' s, and steps become too short: ' &
         //trim(advice_on(creep%exponent)), 'too_many_steps')
      creep%steps = steps
      creep%t = t
   end subroutine check_creep

   !> Advice on a creeping wall that makes no progress.
   pure function advice_on(exponent) result(advice)
      real(wp), intent(in) :: exponent
      !! of the dampers [-]
      character(80) :: advice

      if (exponent < 0.5_wp) then
         advice = 'increase exponent (from 0.5 on the wall does not stick) or reduce eta_1'
      else
         advice = 'raise rtol, reduce eta_1 or choose method = ''auto'''
      end if
   end function advice_on

   !> Return whether both corners of the wall are on the base.
   elemental logical function is_at_rest(hybrid)
      type(hybrid_t), intent(in) :: hybrid

      is_at_rest = hybrid%mode == mode_rest .or. hybrid%mode == mode_held
   end function is_at_rest

   !> Start the step count of the current interval; at the first knot the count always suffices for
   !> a restart.
   subroutine count_steps(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation

      hybrid%steps_at_knot = 0_i8
      if (interval_of(equation) == 0) hybrid%steps_at_knot = -cost_of_restart - 1_i8
   end subroutine count_steps

   !> Enter the next interval of the motion at the end of the current one.
   !>
   !> A multistep method that keeps its past values across a kink loses two digits there, but a
   !> restart costs some 30 small steps. The integrator therefore restarts at jumps, and after
   !> intervals with more steps than a restart costs. It does not restart at the samples of a
   !> record, where a step is about as long as an interval.
   !>
   !> Before the first knot the system may be at rest, and steps have grown without bound. The first
   !> step into a pulse could then reach the pulse's end, where the acceleration is zero again, and
   !> miss it. `count_steps` therefore starts with the cost of a restart. At later knots, for
   !> example of a vertical record before a pulse, a state of zeros triggers the restart.
   subroutine advance_interval(hybrid, equation, steps)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      integer(i8), intent(in) :: steps
      !! number of steps of the integrator so far

      if (hybrid%t < interval_end(equation%motion, interval_of(equation))) return
      call enter_interval(equation%model_t, equation%state, interval_of(equation) + 1)
      if (has_jump(equation%motion, interval_of(equation))) hybrid%must_restart = .true.
      if (steps - hybrid%steps_at_knot > cost_of_restart) hybrid%must_restart = .true.
      if (all(abs(hybrid%y) <= 0)) hybrid%must_restart = .true.
      hybrid%steps_at_knot = steps
   end subroutine advance_interval

end module rwmf_simulation_state_hybrid_state
