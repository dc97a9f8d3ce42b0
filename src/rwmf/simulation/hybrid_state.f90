!> State of the hybrid system, and what a knot of the motion does to it.
module rwmf_simulation_hybrid_state
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_assembly, only: enter_interval, equation_t, interval_of
   use rwmf_model_restitution, only: restitution_t
   use rwmf_motion_ground_motion, only: has_jump, interval_end
   implicit none
   private

   public :: hybrid_t, hybrid_state_t, count_steps, has_ended, is_at_rest, pass_knot
   public :: mode_rest, mode_held, mode_rocking, mode_overturned, mode_no_impacts, mode_collapsed

   integer, parameter :: mode_rest = 0
   !! both corners on the base, and nothing but the ground moves
   integer, parameter :: mode_rocking = 1
   integer, parameter :: mode_overturned = 2
   integer, parameter :: mode_no_impacts = 3
   !! bare frame or hinged wall: one smooth regime
   integer, parameter :: mode_collapsed = 4
   !! a drift has passed its limit
   integer, parameter :: mode_held = 5
   !! both corners on the base, theta = 0, while further states move

   integer(i8), parameter :: cost_of_restart = 30_i8
   !! steps that a multistep method takes to be up to speed

   !> State of the hybrid system.
   type :: hybrid_state_t
      integer :: mode = mode_rest
      real(wp) :: t = 0
      !! [s]
      real(wp), allocatable :: y(:)
      !! (states)
      logical :: must_restart = .true.
      !! the integrator has to begin anew at (t, y)
   end type hybrid_state_t

   !> The same with the numbers that its transitions need.
   type, extends(hybrid_state_t) :: hybrid_t
      type(restitution_t) :: restitution
      !! what an impact leaves of the velocity
      logical :: is_rising = .false.
      !! theta grows where a branch of a spring ends or the wall lifts off
      real(wp) :: overturning_angle
      !! [rad]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer(i8) :: max_steps
      real(wp) :: settled_angle = 0
      !! part of the largest rotation below which chatter may be dropped that ends by itself: not 0
      !! where the largest displacement alone counts [-]
      real(wp) :: t_pulled = 0
      !! time at which the motion pulls a side of the wall again, where it is known [s]
      integer :: drifts = 0
      !! number of drifts with a limit at which the scene collapses
      real(wp) :: flight = 0
      !! estimated duration of the flight that begins; 0: not known [s]
      real(wp) :: t_turn = -huge(1.0_wp)
      !! last turn of a storey since an impact or a lift-off: its direction is known there, whatever
      !! round-off leaves of its rate [s]
      integer(i8) :: steps_at_knot = 0_i8
      !! of the integrator when the present interval of the motion began
   end type hybrid_t

contains

   !> Is the motion over before its time: has the wall overturned, or the scene collapsed?
   pure logical function has_ended(hybrid)
      type(hybrid_t), intent(in) :: hybrid

      has_ended = hybrid%mode == mode_overturned .or. hybrid%mode == mode_collapsed
   end function has_ended

   !> Return true if both corners of the wall are on the base.
   elemental logical function is_at_rest(hybrid)
      type(hybrid_t), intent(in) :: hybrid

      is_at_rest = hybrid%mode == mode_rest .or. hybrid%mode == mode_held
   end function is_at_rest

   !> Begin to count the steps of the interval in force: at the first knot of the motion there are
   !> enough of them for a restart.
   subroutine count_steps(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation

      hybrid%steps_at_knot = 0_i8
      if (interval_of(equation) == 0) hybrid%steps_at_knot = -cost_of_restart - 1_i8
   end subroutine count_steps

   !> Enter the next interval of the motion when the present one is over.
   !>
   !> A multistep method that carries its past over a kink loses two digits there, and a restart
   !> costs it some 30 small steps. So it begins anew at jumps, and where an interval has taken more
   !> steps than that; not at the samples of a record, where a step is about as long as an interval.
   !>
   !> Before the first knot nothing may have moved, and steps have grown without bound: the first
   !> one into a pulse would reach to its end, where the acceleration is zero again, and miss it. So
   !> the count of steps begins with those of a restart there (`count_steps`). At later knots, which
   !> a vertical record may put before a pulse, it is a state of nothing but zeros that says so.
   subroutine pass_knot(hybrid, equation, steps)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      integer(i8), intent(in) :: steps
      !! that the integrator has taken

      if (hybrid%t < interval_end(equation%motion, interval_of(equation))) return
      call enter_interval(equation%model_t, equation%state, interval_of(equation) + 1)
      if (has_jump(equation%motion, interval_of(equation))) hybrid%must_restart = .true.
      if (steps - hybrid%steps_at_knot > cost_of_restart) hybrid%must_restart = .true.
      if (all(abs(hybrid%y) <= 0)) hybrid%must_restart = .true.
      hybrid%steps_at_knot = steps
   end subroutine pass_knot

end module rwmf_simulation_hybrid_state
