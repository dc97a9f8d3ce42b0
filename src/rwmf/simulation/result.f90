!> What one simulation returns: maxima, counts, the history and the events that were asked for.
module rwmf_simulation_result
   use rwmf_core_kinds, only: i8, wp
   implicit none
   private

   public :: result_t, history_t, event_t, energy_t, reaction_extremes_t, demand_extremes_t
   public :: envelope_extremes_t
   public :: append_event, shorten_events, add_warning
   public :: event_impact, event_peak, event_lift_off, event_rest, event_overturned, event_name
   public :: event_branch, event_rupture, event_passage, event_collapsed, ending_name

   integer, parameter :: event_impact = 1
   integer, parameter :: event_peak = 2
   integer, parameter :: event_lift_off = 3
   integer, parameter :: event_rest = 4
   integer, parameter :: event_overturned = 5
   integer, parameter :: event_branch = 6
   !! a spring begins to yield, goes slack or is taut again
   integer, parameter :: event_rupture = 7
   !! the tendon breaks
   integer, parameter :: event_passage = 8
   !! the hysteretic force of the frame passes zero: ends a piece of motion, is not reported
   integer, parameter :: event_collapsed = 9
   !! a drift passes the limit at which the scene has collapsed

   !> An instant at which the regime of motion changes, or a peak of the rotation.
   type :: event_t
      integer :: kind
      !! one of the `event_` numbers
      real(wp) :: t
      !! [s]
      real(wp) :: theta
      !! rotation [rad]; for the bare frame the displacement u_s [m]
      real(wp) :: theta_dot
      !! angular velocity [rad/s], at an impact the one before it; bare frame [m/s]
   end type event_t

   !> Response on a uniform grid of times.
   type :: history_t
      character(32), allocatable :: names(:)
      !! (columns), with unit suffix as in the CSV file: 't_s', 'theta_rad', ...
      real(wp), allocatable :: values(:, :)
      !! (rows, columns) in the units of the names; after overturning or collapse there are no more
      !! rows
   end type history_t

   !> Energy ledger per unit m_w (bare frame: per unit m_s) [J/kg].
   type :: energy_t
      real(wp) :: initial
      !! at t = 0
      real(wp) :: final
      !! kinetic and potential at the end
      real(wp) :: input
      !! work of the ground motion in the end
      real(wp) :: input_max
      !! largest magnitude of that work at any time
      real(wp) :: viscous
      !! dissipated by the frame's damper and further dampers
      real(wp) :: impact
      !! dissipated by impacts
      real(wp) :: hysteretic = 0
      !! dissipated by yielding and rupture in the end
      real(wp) :: flow = 0
      !! part of it that no state tells: of smooth hysteresis and of rupture
      real(wp) :: bending = 0
      !! dissipated by the dampers of a bent wall's modes
      character(32), allocatable :: names(:)
      !! of the parts that apply to the scene
      integer, allocatable :: numbers(:)
      !! (parts) in the table of quantities
      real(wp), allocatable :: values(:)
      !! (parts) in the end
   end type energy_t

   !> Extrema of what the foundation bears. A component that is not allocated does not apply.
   type :: reaction_extremes_t
      real(wp) :: base_shear_max
      !! of wall and frame over their weight [-]
      real(wp) :: t_base_shear_max
      !! its first time [s]
      real(wp), allocatable :: normal_min
      !! smallest pivot reaction N over m_w g [-]; absent without a wall, as the following
      real(wp), allocatable :: t_normal_min
      !! [s]
      logical, allocatable :: pivot_lifts
      !! N was not positive at some time: the model no longer holds
      real(wp), allocatable :: demand_max
      !! largest |H|/N [-]; infinite when the pivot lifts; absent with a shear key, as the next
      real(wp), allocatable :: t_demand_max
      !! [s]; absent when the pivot lifts
      real(wp), allocatable :: shear_key_max
      !! largest |H| over m_w g [-]; absent without a shear key, as the next
      real(wp), allocatable :: t_shear_key_max
      !! [s]
      logical, allocatable :: is_exceeded
      !! the demand exceeded the limit; absent without one
      real(wp), allocatable :: t_exceeded
      !! first time of that [s]
      real(wp), allocatable :: wall_drift_max
      !! displacement of the middle of the wall's top over its height [-]
      real(wp), allocatable :: frame_drift_max
      !! displacement of the frame over the same height [-]
      real(wp), allocatable :: tendon_force_max
      !! largest force of the cable over m_w g [-]; absent without a cable
      real(wp), allocatable :: tendon_stress_max
      !! the same over the area of its strands [Pa]; absent without strands
   end type reaction_extremes_t

   !> The largest demands. A component that is not allocated does not apply.
   type :: demand_extremes_t
      real(wp), allocatable :: drift_max(:)
      !! (storeys) over their heights [-]
      real(wp), allocatable :: t_drift_max
      !! time of the largest of them [s]
      real(wp), allocatable :: acceleration_max(:)
      !! (floors) absolute, over g [-]
      real(wp), allocatable :: t_acceleration_max
      !! time of the largest of them [s]
      real(wp), allocatable :: shear_max(:)
      !! (storeys) of columns without dampers, over g and the unit of the floors' masses [-]
      real(wp), allocatable :: roof_drift_max
      !! displacement of the roof over its height [-]; absent where that is unknown
      real(wp), allocatable :: t_roof_drift_max
      !! its time [s]
      real(wp), allocatable :: overturning_max
      !! moment of the horizontal forces of inertia about the ground over the weight [m]; likewise
      real(wp), allocatable :: t_overturning_max
      !! its time [s]
      real(wp), allocatable :: residual_drift(:)
      !! (storeys) what unloading would leave in the end over the height of each [-]; absent unless
      !! the frame yields
      real(wp), allocatable :: roof_residual_drift
      !! the same of the roof over its height [-]
      real(wp), allocatable :: roof_at_rest
      !! displacement of the roof in static equilibrium after the motion over its height [-]; absent
      !! unless frame or fuses yield, and where there is none
      real(wp), allocatable :: wall_shear_max
      !! inside the wall over m_w g [-]; absent without a wall, as the following
      real(wp), allocatable :: wall_shear_height
      !! where, above the base [m]
      real(wp), allocatable :: wall_moment_max
      !! bending moment inside the wall over m_w g [m]
      real(wp), allocatable :: wall_moment_height
      !! where, above the base [m]
   end type demand_extremes_t

   !> Envelopes of forces, all over m_w g. A component that is not allocated does not apply.
   type :: envelope_extremes_t
      real(wp), allocatable :: velocity_max(:)
      !! (floors) absolute [m/s]; absent without a frame
      real(wp), allocatable :: fuse_stroke_max
      !! [m]; absent without fuses, as the next
      real(wp), allocatable :: fuse_stroke_sum
      !! travel of the fuse that has the longer one [m]
      real(wp), allocatable :: normal_max
      !! largest pivot reaction [-]; absent without a wall, as the following
      real(wp), allocatable :: base(:), middle(:)
      !! shear [-] and moment [m] at the base and at mid-height of the wall
      real(wp), allocatable :: shear_below(:), shear_above(:)
      !! (floors) just below and just above each [-]; absent without a frame, as the following
      real(wp), allocatable :: moment_below(:), moment_above(:)
      !! (floors) likewise [m]
      real(wp), allocatable :: link_max(:)
      !! (links) axial forces, that of the roof is the last [-]
   end type envelope_extremes_t

   !> Result of one simulation. A component that is not allocated does not apply to the scene.
   type :: result_t
      real(wp), allocatable :: u_s_max
      !! supremum of |u_s| over [0, t_end] [m]; absent without a frame
      real(wp), allocatable :: tip_deflection_max
      !! largest deflection of a bent wall's top from its straight axis [m]; absent without `&bending`
      real(wp), allocatable :: t_u_s_max
      !! its first time [s]
      real(wp), allocatable :: theta_max
      !! largest theta [rad]; absent without a wall, as the following
      real(wp), allocatable :: theta_min
      !! smallest theta [rad]
      real(wp), allocatable :: theta_max_over_alpha
      !! maximum of |theta|/alpha [-]
      real(wp), allocatable :: theta_dot_max
      !! maximum of |theta_dot|, velocities before impacts included [rad/s]
      real(wp), allocatable :: cable_increment_max
      !! maximum of P/(m_w g) - eta_0 [-]; absent without a cable
      real(wp), allocatable :: prestress_loss
      !! eta_0 less P/(m_w g) at theta = 0 in the end [-]; absent unless the tendon can yield or
      !! break
      logical, allocatable :: has_ruptured
      !! the tendon has broken; absent unless it can
      real(wp), allocatable :: ductility
      !! u_s_max over u_y, of storeys that yield one by one the largest [-]; absent unless the frame
      !! yields
      real(wp), allocatable :: residual_displacement
      !! of the frame without force in the end [m]; absent unless the frame yields
      real(wp), allocatable :: storey_ductility(:)
      !! (storeys) largest |u_i - u_(i-1)| over that at first yield [-]; absent unless they yield
      !! one by one
      real(wp), allocatable :: storey_residual_drift(:)
      !! (storeys) what unloading would leave in the end over the height of each [-]; likewise
      real(wp), allocatable :: storey_at_rest(:)
      !! (storeys) drift in static equilibrium after the motion [-]; likewise, absent without one
      real(wp), allocatable :: theta_end_over_alpha
      !! theta/alpha in the end [-]; absent unless fuses may hold the wall up
      real(wp), allocatable :: e
      !! velocity factor at impact [-]; absent without impacts
      real(wp), allocatable :: e_max
      !! what the momentum balance allows [-]
      integer(i8) :: impacts
      integer(i8) :: lift_offs
      logical :: has_impacts
      !! the scene has a rocking wall: impacts and lift-offs apply
      logical :: overturned
      logical, allocatable :: collapsed
      !! a drift passed the limit of an effect; absent unless an effect has one
      real(wp), allocatable :: t_collapse
      !! when it did [s]; absent unless it has
      real(wp), allocatable :: t_grazing
      !! when the wall first turned back on its base, or hardly above it [s]; absent unless it has
      real(wp), allocatable :: t_chatter
      !! when bounces below the resolution were first averaged [s]; absent unless they were
      integer(i8) :: steps
      !! accepted steps of the integrator
      integer(i8) :: rhs_evaluations
      real(wp) :: t_end
      !! where the simulation ended: the case's end, overturning or collapse [s]
      real(wp), allocatable :: final_state(:)
      !! state at that time
      real(wp) :: seconds
      !! wall-clock time of the integration [s]
      character(:), allocatable :: method
      !! integrator in use
      real(wp) :: rtol
      !! its relative tolerance [-]
      real(wp), allocatable :: estimated_relative_error
      !! of u_s_max (without a frame: of theta_max) [-]; only when an estimate was asked for
      real(wp), allocatable :: estimate_seconds
      !! wall-clock time that the estimate took beyond `seconds` [s]
      real(wp), allocatable :: sensitivity
      !! relative change of the same peak per relative change of the motion [-]
      real(wp) :: peak_sensitivity = 0
      !! the same of the largest rotation, estimated along the run of a rocking wall whose steps are
      !! all observed; else 0 [-]
      type(energy_t), allocatable :: energy
      type(reaction_extremes_t), allocatable :: reactions
      !! only when they were asked for, as the energy
      type(demand_extremes_t), allocatable :: demands
      !! likewise
      type(envelope_extremes_t), allocatable :: envelopes
      !! likewise
      type(history_t), allocatable :: history
      type(event_t), allocatable :: events(:)
      !! in order of time; kept only together with a history
      character(256), allocatable :: warnings(:)
   end type result_t

contains

   !> Name of an event as it stands in the outputs.
   pure function event_name(kind) result(name)
      integer, intent(in) :: kind
      !! one of the `event_` numbers
      character(*), parameter :: names(0:9) = [character(10) :: 'overturned', 'impact', 'peak', &
         'lift_off', 'rest', 'overturned', 'branch', 'rupture', 'passage', 'collapsed']
      character(len_trim(names(merge(kind, 0, kind > 0 .and. kind <= ubound(names, 1))))) :: name

      name = names(merge(kind, 0, kind > 0 .and. kind <= ubound(names, 1)))
   end function event_name

   !> How a simulation ended: 'ok' at the end of its time, 'overturned' or 'collapsed'.
   pure function ending_name(result) result(name)
      type(result_t), intent(in) :: result
      character(10) :: name

      name = 'ok'
      if (allocated(result%t_collapse)) name = 'collapsed'
      if (result%overturned) name = 'overturned'
   end function ending_name

   !> Append to a list that doubles its room when full.
   pure subroutine append_event(events, n, event)
      type(event_t), allocatable, intent(inout) :: events(:)
      !! (capacity >= n)
      integer, intent(inout) :: n
      !! events in use
      type(event_t), intent(in) :: event
      type(event_t), allocatable :: grown(:)

      if (n == size(events)) then
         allocate (grown(max(64, 2*n)))
         grown(:n) = events(:n)
         call move_alloc(grown, events)
      end if
      n = n + 1
      events(n) = event
   end subroutine append_event

   !> Give back the room that a list does not use. On the heap: the events of a chatter are more
   !> than a stack holds, where the compiler puts the right-hand side of an assignment to itself.
   pure subroutine shorten_events(events, n)
      type(event_t), allocatable, intent(inout) :: events(:)
      !! (capacity >= n)
      integer, intent(in) :: n
      !! events in use
      type(event_t), allocatable :: kept(:)

      allocate (kept(n))
      kept(:) = events(:n)
      call move_alloc(kept, events)
   end subroutine shorten_events

   !> Add a sentence for the user.
   pure subroutine add_warning(result, text)
      type(result_t), intent(inout) :: result
      character(*), intent(in) :: text
      !! the sentence, of at most 256 letters
      character(256), allocatable :: longer(:)
      integer :: n

      n = 0
      if (allocated(result%warnings)) n = size(result%warnings)
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = result%warnings
      longer(n + 1) = text
      call move_alloc(longer, result%warnings)
   end subroutine add_warning

end module rwmf_simulation_result
