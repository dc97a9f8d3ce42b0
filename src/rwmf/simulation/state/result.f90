!> Result of one simulation: maxima, counts, and the requested history and events.
module rwmf_simulation_state_result
   use rwmf_core_kinds, only: i8, wp
   use rwmf_problem_case, only: case_t, has_floors
   use rwmf_problem_quantity_table, only: all_quantities, id, look_up, sensitivity_id
   use rwmf_problem_quantity_values, only: put, value_of, values_t
   use rwmf_problem_shear_frame, only: modal_height, modal_mass, roof_factor
   use rwmf_simulation_state_history, only: history_t
   use rwmf_simulation_state_newtons, only: forces_of, put_newtons
   implicit none
   private

   public :: result_t, counts_t, event_t, energy_t, append_event, shorten_events, add_warning
   public :: complete_values, result_values, result_value
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
      type(values_t) :: terms
      !! reported terms at the end
   end type energy_t

   !> Counts and first times of a run.
   type :: counts_t
      integer(i8) :: impacts = 0
      integer(i8) :: lift_offs = 0
      real(wp) :: t_grazing = -1
      !! first time at which the wall turns back on its base or just above it; negative: never [s]
      real(wp) :: t_chatter = -1
      !! first time of averaged bounces below the resolution; negative: none [s]
   end type counts_t

   !> Result of one simulation. Components that do not apply to the scene are not allocated.
   type, extends(counts_t) :: result_t
      type(values_t) :: values
      !! scalars that apply to the scene and are requested; `result_values` adds those of the run
      real(wp), allocatable :: u_s_max
      !! supremum of |u_s| over [0, t_end] [m]; absent without a frame
      real(wp), allocatable :: theta_max
      !! largest theta [rad]; absent without a wall, as is the following
      real(wp), allocatable :: theta_min
      !! smallest theta [rad]
      logical :: has_impacts = .false.
      !! true if the scene has a rocking wall, with impacts and lift-offs
      logical :: overturned = .false.
      logical :: has_collapsed = .false.
      !! a drift exceeds the limit of an effect
      integer(i8) :: steps = 0
      !! number of accepted steps of the integrator
      integer(i8) :: rhs_evaluations = 0
      real(wp) :: t_end = 0
      !! end of the simulation: the case's end, overturning or collapse [s]
      real(wp), allocatable :: final_state(:)
      !! state at that time
      real(wp) :: seconds = 0
      !! wall-clock time of the integration [s]
      character(:), allocatable :: method
      !! integrator in use
      real(wp) :: rtol = 0
      !! relative tolerance of the integrator [-]
      real(wp), allocatable :: estimated_relative_error
      !! error of u_s_max (without a frame: of theta_max) [-]; absent unless requested
      real(wp), allocatable :: estimate_seconds
      !! additional wall-clock time for the estimate, beyond `seconds` [s]
      real(wp), allocatable :: sensitivity
      !! relative change of this peak per relative change of the motion [-]
      type(values_t), allocatable :: sensitivities
      !! relative changes of the reported peaks per relative change of the motion [-]; absent unless
      !! requested, and without a motion
      type(history_t), allocatable :: history
      type(event_t), allocatable :: events(:)
      !! in chronological order; stored only with a history
      character(256), allocatable :: warnings(:)
   end type result_t

contains

   !> Add impacts, overturning, properties of the frame's first mode, forces in N, moments in N m.
   subroutine complete_values(case, result)
      type(case_t), intent(in) :: case
      type(result_t), intent(inout) :: result

      associate (values => result%values)
         if (result%has_impacts) then
            call put(values, id%impacts, result%impacts)
            call put(values, id%lift_offs, result%lift_offs)
         end if
         if (allocated(result%theta_max)) call put(values, id%overturned, result%overturned)
         if (has_floors(case)) then
            associate (floors => case%frame%floors)
               call put(values, id%modal_mass_over_m_w, modal_mass(floors, 1))
               call put(values, id%mass_participation, modal_mass(floors, 1)/sum(floors%m))
               call put(values, id%modal_height_m, modal_height(floors, 1))
               call put(values, id%roof_factor, roof_factor(floors, 1))
            end associate
            call put(values, id%T_s_s, case%frame%T_s)
         end if
         call put_newtons(values, forces_of(case, values))
      end associate
   end subroutine complete_values

   !> All scalars of a result: those of the response, of the run and of the error estimates.
   pure type(values_t) function result_values(result) result(values)
      type(result_t), intent(in) :: result
      integer :: i

      values = result%values
      call put(values, id%steps, result%steps)
      call put(values, id%rhs_evaluations, result%rhs_evaluations)
      call put(values, id%seconds, result%seconds)
      call put(values, id%rtol, result%rtol)
      if (allocated(result%estimated_relative_error)) call put(values, &
         id%estimated_relative_error, result%estimated_relative_error)
      if (allocated(result%estimate_seconds)) call put(values, id%estimate_seconds, &
         result%estimate_seconds)
      if (allocated(result%sensitivity)) call put(values, id%sensitivity, result%sensitivity)
      if (.not. allocated(result%sensitivities)) return
      associate (found => result%sensitivities)
         do i = 1, found%n
            call put(values, sensitivity_id(found%ids(i)), found%numbers(i:i), found%levels(i) - 1)
         end do
      end associate
   end function result_values

   !> Scalar of a result by its key; NaN if it does not apply or is not requested.
   pure real(wp) function result_value(result, key) result(value)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key
      !! key as in the summary: 'base_shear_max_over_weight', 'storey_2_drift_max'
      integer :: place, level

      call look_up(key, place, level)
      value = value_of(values_t(), 0, 0)
      if (place > 0) value = value_of(result_values(result), all_quantities(place)%id, level)
   end function result_value

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
      if (result%has_collapsed) name = 'collapsed'
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
