!> Result of one simulation: maxima, counts, and the requested history and events.
module rwmf_simulation_state_result
   use rwmf_core_kinds, only: i8, wp
   implicit none
   private

   public :: result_t, history_t, event_t, energy_t, reaction_extremes_t, demand_extremes_t
   public :: envelope_extremes_t, element_extremes_t, sensitivities_t
   public :: value_t, append_event, shorten_events, add_warning
   public :: event_impact, event_peak, event_lift_off, event_rest, event_overturned, event_name
   public :: event_branch, event_rupture, event_passage, event_collapsed, ending_name
   public :: event_storey_limit, event_storey_turn, event_storey_zero

   integer, parameter :: event_impact = 1
   integer, parameter :: event_peak = 2
   integer, parameter :: event_lift_off = 3
   integer, parameter :: event_rest = 4
   integer, parameter :: event_overturned = 5
   integer, parameter :: event_branch = 6
   !! a spring starts to yield, becomes slack or becomes taut again
   integer, parameter :: event_rupture = 7
   !! the tendon ruptures
   integer, parameter :: event_passage = 8
   !! the hysteretic force of the frame passes zero; ends a piece of motion and is not reported
   integer, parameter :: event_collapsed = 9
   !! a drift exceeds the collapse limit
   integer, parameter :: event_storey_limit = 10
   !! a storey reaches a limit of its branch; reported as the end of a branch
   integer, parameter :: event_storey_turn = 11
   !! a storey unloads, or starts to move; reported as the end of a branch
   integer, parameter :: event_storey_zero = 12
   !! the hysteretic force of a storey passes zero; not reported

   !> Change of the regime of motion, or a peak of the rotation.
   type :: event_t
      integer :: kind
      !! one of the `event_` numbers
      real(wp) :: t
      !! [s]
      real(wp) :: theta
      !! rotation [rad]; for the bare frame the displacement u_s [m]
      real(wp) :: theta_dot
      !! angular velocity [rad/s], at an impact the value before it; velocity of the bare frame
      !! [m/s]
   end type event_t

   !> Response on a uniform grid of times.
   type :: history_t
      character(32), allocatable :: names(:)
      !! (columns), with unit suffix as in the CSV file: 't_s', 'theta_rad', ...
      real(wp), allocatable :: values(:, :)
      !! (rows, columns) in the units of the names; rows end at overturning or collapse
   end type history_t

   !> Energy balance per unit m_w (bare frame: per unit m_s) [J/kg].
   type :: energy_t
      real(wp) :: initial
      !! at t = 0
      real(wp) :: final
      !! kinetic and potential energy at the end
      real(wp) :: input
      !! total work of the ground motion
      real(wp) :: input_max
      !! largest magnitude of that work over time
      real(wp) :: viscous
      !! dissipated by the frame's damper and by additional dampers
      real(wp) :: impact
      !! dissipated by impacts
      real(wp) :: hysteretic = 0
      !! dissipated by yielding and rupture
      real(wp) :: flow = 0
      !! part of it that is not a function of the state: smooth hysteresis and rupture
      real(wp) :: bending = 0
      !! dissipated by the dampers of the modes
      character(32), allocatable :: names(:)
      !! names of the energy terms that apply to the scene
      integer, allocatable :: numbers(:)
      !! (terms) numbers in the table of quantities
      real(wp), allocatable :: values(:)
      !! (terms) values at the end
   end type energy_t

   !> Extrema of the reactions of the foundation. Components that do not apply are not allocated.
   type :: reaction_extremes_t
      real(wp) :: base_shear_max
      !! base shear of wall and frame over their weight [-]
      real(wp) :: t_base_shear_max
      !! time of its first occurrence [s]
      real(wp), allocatable :: normal_min
      !! smallest pivot reaction N over m_w g [-]; absent without a wall, as are the following
      real(wp), allocatable :: t_normal_min
      !! [s]
      logical, allocatable :: pivot_lifts
      !! true if N <= 0 at some time, where the model is not valid
      real(wp), allocatable :: demand_max
      !! largest |H|/N [-]; infinite if the pivot lifts; absent with a shear key, as is the next
      real(wp), allocatable :: t_demand_max
      !! [s]; absent if the pivot lifts
      real(wp), allocatable :: impact_demand_max
      !! largest horizontal over vertical impulse of the base at an impact, 0 without one [-];
      !! absent with a shear key and for a hinged wall
      real(wp), allocatable :: shear_key_max
      !! largest |H| over m_w g [-]; absent without a shear key, as is the next
      real(wp), allocatable :: t_shear_key_max
      !! [s]
      logical, allocatable :: is_exceeded
      !! true if the demand exceeds the limit; absent without a limit
      real(wp), allocatable :: t_exceeded
      !! first time of exceedance [s]
      real(wp), allocatable :: wall_drift_max
      !! displacement of the mid-width of the wall's top over its height [-]
      real(wp), allocatable :: frame_drift_max
      !! displacement of the frame over the same height [-]
      real(wp), allocatable :: tendon_force_max
      !! largest cable force over m_w g [-]; absent without a cable
      real(wp), allocatable :: tendon_stress_max
      !! largest cable stress in the area of its strands [Pa]; absent without strands
      real(wp), allocatable :: tendon_strain_max
      !! largest cable strain, that of the prestress included [-]; absent without its length
   end type reaction_extremes_t

   !> Largest demands on the building. Components that do not apply are not allocated.
   type :: demand_extremes_t
      real(wp), allocatable :: drift_max(:)
      !! (storeys) peak interstorey drifts over the storey heights [-]
      real(wp), allocatable :: t_drift_max
      !! time of the largest value [s]
      real(wp), allocatable :: acceleration_max(:)
      !! (floors) peak absolute accelerations over g [-]
      real(wp), allocatable :: t_acceleration_max
      !! time of the largest value [s]
      real(wp), allocatable :: shear_max(:)
      !! (storeys) peak shears of the columns, without dampers, over g and the unit of the floor
      !! masses [-]
      real(wp), allocatable :: roof_drift_max
      !! peak roof displacement over the roof's height [-]; absent if the height is unknown
      real(wp), allocatable :: t_roof_drift_max
      !! time of the peak [s]
      real(wp), allocatable :: overturning_max
      !! peak moment of the horizontal inertia forces about the ground over the weight [m]; absent
      !! if the height is unknown
      real(wp), allocatable :: t_overturning_max
      !! time of the peak [s]
      real(wp), allocatable :: residual_drift(:)
      !! (storeys) residual drifts after unloading at the end over the storey heights [-]; absent
      !! unless the frame yields
      real(wp), allocatable :: roof_residual_drift
      !! residual roof displacement over the roof's height [-]
      real(wp), allocatable :: roof_at_rest
      !! roof displacement in static equilibrium after the motion over the roof's height [-]; absent
      !! without an equilibrium, and unless frame or fuses yield
      real(wp), allocatable :: wall_shear_max
      !! peak shear in the wall over m_w g [-]; absent without a wall, as are the following
      real(wp), allocatable :: wall_shear_height
      !! its height above the base [m]
      real(wp), allocatable :: wall_moment_max
      !! peak bending moment in the wall over m_w g [m]
      real(wp), allocatable :: wall_moment_height
      !! its height above the base [m]
   end type demand_extremes_t

   !> Strokes and forces of one vertical element.
   type :: element_extremes_t
      integer :: group = 0
      !! its group, as in `rwmf_model_elements`
      real(wp) :: stroke(2) = 0
      !! smallest and largest stroke [m]
      real(wp) :: travel = 0
      !! sum of all strokes there and back [m]
      real(wp) :: force(2) = 0
      !! smallest force of a tendon, and largest magnitude, over m_w g [-]
      real(wp) :: force_end = 0
      !! force at the end over m_w g [-]
      real(wp) :: loss = 0
      !! lost force at theta = 0 over m_w g [-]
   end type element_extremes_t

   !> Envelopes of forces over m_w g. Components that do not apply are not allocated.
   type :: envelope_extremes_t
      real(wp), allocatable :: velocity_max(:)
      !! (floors) peak absolute velocities [m/s]; absent without a frame
      type(element_extremes_t), allocatable :: elements(:)
      !! vertical elements with own outputs; absent without any
      real(wp), allocatable :: normal_max
      !! largest pivot reaction [-]; absent without a wall, as are the following
      real(wp), allocatable :: base(:), middle(:)
      !! shear [-] and moment [m] at the base and at mid-height of the wall
      real(wp), allocatable :: shear_below(:), shear_above(:)
      !! (floors) peak wall shears just below and just above each floor [-]; absent without a frame,
      !! as are the following
      real(wp), allocatable :: moment_below(:), moment_above(:)
      !! (floors) peak wall moments at the same places [m]
      real(wp), allocatable :: link_max(:)
      !! (links) peak axial forces, the roof link last [-]
      real(wp), allocatable :: contact_min
      !! smallest contact length of the base [m]; absent without `&base_section`, as is the next
      real(wp), allocatable :: toe_stress_max
      !! [Pa]
      real(wp), allocatable :: toe_strain_max
      !! [-]; absent if the modulus of the strip is unknown
   end type envelope_extremes_t

   !> Value of a quantity.
   type :: value_t
      integer :: number = 0
      !! in the table of quantities
      real(wp) :: value = 0
      !! [unit of its key]
   end type value_t

   !> Sensitivities of one reported peak.
   type :: sensitivities_t
      integer :: number = 0
      !! number of the peak in the table of quantities
      integer :: below = 0
      !! number of the lowest storeys or floors without a value
      real(wp), allocatable :: values(:)
      !! (levels, or 1) relative change of the peak per relative change of the motion [-]
   end type sensitivities_t

   !> Result of one simulation. Components that do not apply to the scene are not allocated.
   type :: result_t
      real(wp), allocatable :: u_s_max
      !! supremum of |u_s| over [0, t_end] [m]; absent without a frame
      real(wp), allocatable :: tip_deflection_max
      !! largest deflection of the wall's top from its straight axis [m]; absent without `&bending`
      real(wp), allocatable :: t_u_s_max
      !! time of its first occurrence [s]
      real(wp), allocatable :: theta_max
      !! largest theta [rad]; absent without a wall, as are the following
      real(wp), allocatable :: theta_min
      !! smallest theta [rad]
      real(wp), allocatable :: theta_max_over_alpha
      !! maximum of |theta|/alpha [-]
      real(wp), allocatable :: theta_dot_max
      !! maximum of |theta_dot|, velocities before impacts included [rad/s]
      real(wp), allocatable :: cable_increment_max
      !! maximum of P/(m_w g) - eta_0 [-]; absent without a cable
      real(wp), allocatable :: prestress_loss
      !! eta_0 minus P/(m_w g) at theta = 0 at the end [-]; absent unless the tendon can yield or
      !! break
      logical, allocatable :: has_ruptured
      !! true if the tendon has ruptured; absent unless it can rupture
      real(wp), allocatable :: ductility
      !! u_s_max over u_y, or the largest storey ductility if storeys yield individually [-]; absent
      !! unless the frame yields
      real(wp), allocatable :: residual_displacement
      !! displacement of the frame without force at the end [m]; absent unless the frame yields
      real(wp), allocatable :: storey_ductility(:)
      !! (storeys) largest |u_i - u_(i-1)| over its value at first yield [-]; absent unless storeys
      !! yield individually
      real(wp), allocatable :: storey_residual_drift(:)
      !! (storeys) residual drifts after unloading at the end over the storey heights [-]; absent
      !! unless storeys yield individually
      real(wp), allocatable :: storey_at_rest(:)
      !! (storeys) drifts in static equilibrium after the motion [-]; absent without an equilibrium,
      !! and unless storeys yield individually
      real(wp), allocatable :: theta_end_over_alpha
      !! theta/alpha at the end [-]; absent unless springs may hold the wall up
      real(wp), allocatable :: uplift(:)
      !! ground acceleration over g at which the wall at rest lifts off, to theta > 0 and to theta <
      !! 0 [-]; absent unless elements stand off the axis
      real(wp), allocatable :: coupling_ratio
      !! share of the couplings in the moment of all walls at yield [-]; absent without them
      real(wp), allocatable :: e
      !! velocity factor at impact [-]; absent without impacts
      real(wp), allocatable :: modal_damping(:, :)
      !! (up to 3 modes, 2) damping ratios of a bending wall in contact and rocking [-]
      real(wp), allocatable :: e_max
      !! e of the momentum balance: that of an impulse at the new corner [-]
      integer(i8) :: impacts
      integer(i8) :: lift_offs
      logical :: has_impacts
      !! true if the scene has a rocking wall, with impacts and lift-offs
      logical :: overturned
      logical, allocatable :: collapsed
      !! true if a drift exceeds the limit of an effect; absent without such a limit
      real(wp), allocatable :: t_collapse
      !! time of collapse [s]; absent without collapse
      real(wp), allocatable :: t_grazing
      !! first time at which the wall turns back on its base or just above it [s]; absent if it
      !! never does
      real(wp), allocatable :: t_chatter
      !! first time of averaged bounces below the resolution [s]; absent without such bounces
      integer(i8) :: steps
      !! number of accepted steps of the integrator
      integer(i8) :: rhs_evaluations
      real(wp) :: t_end
      !! end of the simulation: the case's end, overturning or collapse [s]
      real(wp), allocatable :: final_state(:)
      !! state at that time
      real(wp) :: seconds
      !! wall-clock time of the integration [s]
      character(:), allocatable :: method
      !! integrator in use
      real(wp) :: rtol
      !! relative tolerance of the integrator [-]
      real(wp), allocatable :: estimated_relative_error
      !! error of u_s_max (without a frame: of theta_max) [-]; absent unless requested
      real(wp), allocatable :: estimate_seconds
      !! additional wall-clock time for the estimate, beyond `seconds` [s]
      real(wp), allocatable :: sensitivity
      !! relative change of this peak per relative change of the motion [-]
      type(sensitivities_t), allocatable :: sensitivities(:)
      !! of the reported peaks; absent unless requested, and without a motion
      type(energy_t), allocatable :: energy
      type(reaction_extremes_t), allocatable :: reactions
      !! absent unless requested, as is the energy
      type(demand_extremes_t), allocatable :: demands
      !! absent unless requested
      type(envelope_extremes_t), allocatable :: envelopes
      !! absent unless requested
      type(value_t), allocatable :: further(:)
      !! values that no component holds
      type(history_t), allocatable :: history
      type(event_t), allocatable :: events(:)
      !! in chronological order; stored only with a history
      character(256), allocatable :: warnings(:)
   end type result_t

contains

   !> Name of an event in the outputs.
   pure function event_name(kind) result(name)
      integer, intent(in) :: kind
      !! one of the `event_` numbers
      character(*), parameter :: names(0:9) = [character(10) :: 'overturned', 'impact', 'peak', &
         'lift_off', 'rest', 'overturned', 'branch', 'rupture', 'passage', 'collapsed']
      character(len_trim(names(merge(kind, 0, kind > 0 .and. kind <= ubound(names, 1))))) :: name

      name = names(merge(kind, 0, kind > 0 .and. kind <= ubound(names, 1)))
   end function event_name

   !> Ending of a simulation: 'ok' at its end time, 'overturned' or 'collapsed'.
   pure function ending_name(result) result(name)
      type(result_t), intent(in) :: result
      character(10) :: name

      name = 'ok'
      if (allocated(result%t_collapse)) name = 'collapsed'
      if (result%overturned) name = 'overturned'
   end function ending_name

   !> Append an event to a list; double the capacity if it is full.
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

   !> Release the unused capacity of an event list.
   !>
   !> The copy is on the heap: chatter can have more events than the stack holds, and compilers put
   !> the right-hand side of a self-assignment there.
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

   !> Add a warning for the user.
   pure subroutine add_warning(result, text)
      type(result_t), intent(inout) :: result
      character(*), intent(in) :: text
      !! warning of at most 256 characters
      character(256), allocatable :: longer(:)
      integer :: n

      n = 0
      if (allocated(result%warnings)) n = size(result%warnings)
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = result%warnings
      longer(n + 1) = text
      call move_alloc(longer, result%warnings)
   end subroutine add_warning

end module rwmf_simulation_state_result
