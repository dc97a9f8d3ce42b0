!> Recorder of a simulation: maxima, counts, and on request history, events and energy.
!>
!> The recorder reads the states of the hybrid loop and never changes them.
module rwmf_simulation_recorder_recorder
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_math_roots, only: close_in, secant_between, secant_t, stationary_point
   use rwmf_math_sign_changes, only: no_change, one_change
   use rwmf_model_equation, only: cable_force_at, enter_interval, frame_motion, has_elements, &
      has_tendons
   use rwmf_model_floors_floor_forces, only: put_floors
   use rwmf_model_floors_yielding_storeys, only: put_shears
   use rwmf_problem_quantity_values, only: clear, put, values_t
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_force
   use rwmf_model_system_assembly, only: equation_t, frame_displacement, interval_of, &
      rates_at, second_derivative
   use rwmf_model_system_energy, only: impact_loss, mechanical_energy, yielding_loss
   use rwmf_motion_ground_motion, only: acceleration, interval_end, vertical_acceleration
   use rwmf_problem_case, only: case_t, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_events_first_change, only: stop_at_change
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, from, is_short, &
      sample_state, step_view_t, until
   use rwmf_simulation_events_storey_events, only: displacements_t
   use rwmf_simulation_events_rotation_events, only: fastest_in
   use rwmf_simulation_events_watched_spans, only: changes_in, functions_t, moment_t, &
      span_between, span_of, span_t, watch_t
   use rwmf_simulation_recorder_demand_extremes, only: create_demands, demand_recorder_t, &
      put_demands, put_storeys
   use rwmf_simulation_recorder_element_demands, only: put_element_forces, put_frame_force
   use rwmf_simulation_recorder_energy_balance, only: integrate_powers, put_energies
   use rwmf_simulation_recorder_force_envelopes, only: create_envelopes, envelope_recorder_t, &
      follow_elements, put_envelopes
   use rwmf_simulation_recorder_peak_search, only: search_piece, search_rest, search_state
   use rwmf_simulation_recorder_reaction_extremes, only: create_reaction_extremes, &
      observe_moving, observe_resting, put_reactions, reaction_extremes_recorder_t
   use rwmf_simulation_recorder_step_states, only: step_states_t
   use rwmf_simulation_recorder_storey_drifts, only: observe_drifts, observe_turns
   use rwmf_simulation_recorder_top_motion, only: top_count, top_displacements, &
      top_motion_t
   use rwmf_simulation_state_history, only: create_history, history_t, shorten_history
   use rwmf_simulation_state_newtons, only: force_t, forces_of, put_newtons
   use rwmf_simulation_state_result, only: append_event, counts_t, energy_t, &
      event_t, shorten_events
   use rwmf_text_decimal, only: short_decimal
   implicit none
   private

   public :: recorder_t, peaks_t, create_recorder, observe_state, observe_piece
   public :: has_more_than_peaks, needs_all_steps, sees_forces, sees_impulses, sees_rest
   public :: observe_rest, observe_still
   public :: observe_impact, observe_event, observe_grazing, finish_recorder
   public :: observe_chatter, observe_present, create_columns, find_columns, find_rates

   !> Counts and running maxima.
   type, extends(counts_t) :: peaks_t
      real(wp) :: u_max = 0
      !! largest |u_s| [m]
      real(wp) :: t_u_max = 0
      !! first time of this value [s]
      real(wp) :: theta_max = 0
      !! largest theta [rad]; bare frame: displacement [m]
      real(wp) :: theta_min = 0
      !! smallest theta [rad]; bare frame: displacement [m]
      real(wp) :: theta_dot_max = 0
      !! largest |theta'| [rad/s]
      real(wp) :: theta_dot_ends = 0
      !! largest |theta'| at the ends of steps only [rad/s]
   end type peaks_t

   !> Running maxima, counts and records.
   type, extends(peaks_t) :: recorder_t
      real(wp) :: cable_max = 0
      !! largest P/(m_w g) of tendons that can yield, go slack or break [-]
      logical :: follows_cable = .false.
      !! a tendon can do that
      logical :: has_offsets = .false.
      !! the case gives the places of the fuses
      logical :: seeks_velocity = .true.
      !! the largest |theta'| is requested
      logical :: keeps_energy = .false.
      type(energy_t) :: energy
      real(wp), allocatable :: drifts(:)
      !! largest |u_i - u_(i-1)| of storeys that can yield [m]; not allocated without such storeys
      real(wp), allocatable :: t_drifts(:)
      !! their times [s]
      real(wp), allocatable :: top(:)
      !! largest displacement of the frame [m], tip deflection [m] and drift of the wall [-];
      !! allocated with `&bending`
      type(reaction_extremes_recorder_t), allocatable :: forces
      !! allocated only if reactions are requested
      type(demand_recorder_t), allocatable :: demands
      !! allocated only if demands are requested
      type(envelope_recorder_t), allocatable :: envelopes
      !! allocated only if envelopes are requested
      real(wp) :: t_settled = -huge(1.0_wp)
      !! end of the chatter that a rest omits: the forces of rest begin there [s]
      logical :: keeps_history = .false.
      logical :: keeps_events = .false.
      !! set with a history, or for a host that steps the wall
      type(history_t), allocatable :: history
      type(values_t) :: row
      !! next row to write
      real(wp) :: dt
      !! interval of the history [s]
      real(wp) :: m_w_g
      !! weight of the wall, 0 if the case gives no mass [N]
      type(force_t), allocatable :: newtons(:)
      !! columns in N and N m that follow from others
      integer :: next_row
      !! first row of the history that is still empty
      type(event_t), allocatable :: events(:)
      integer :: n_events = 0
   end type recorder_t

contains

   !> Initialise a recorder with the state at t = 0.
   subroutine create_recorder(recorder, case, equation, t_end, y, error)
      type(recorder_t), intent(out) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_end
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(error_t), allocatable, intent(out) :: error
      !! the history does not fit into memory

      recorder%u_max = -1
      recorder%theta_max = -huge(1.0_wp)
      recorder%theta_min = huge(1.0_wp)
      recorder%follows_cable = has_tendons(equation)
      if (allocated(case%fuse)) recorder%has_offsets = allocated(case%fuse%offset)
      allocate (recorder%events(0))
      if (equation%floors%yields) then
         allocate (recorder%drifts(equation%floors%n_storeys), source=0.0_wp)
         allocate (recorder%t_drifts(equation%floors%n_storeys), source=0.0_wp)
      end if
      if (equation%beam%n > 0) allocate (recorder%top(top_count), source=0.0_wp)
      call observe_state(recorder, equation, 0.0_wp, y)
      if (.not. allocated(case%output)) return
      recorder%seeks_velocity = seeks(case%output, [id%theta_dot_max_rad_s])
      ! only ductilities need these drifts
      if (allocated(recorder%drifts) .and. .not. seeks(case%output, [id%ductility, &
         id%storey_i_ductility])) deallocate (recorder%drifts, recorder%t_drifts)
      recorder%keeps_energy = case%output%energy
      recorder%energy = energy_t(mechanical_energy(equation, y), 0, 0, 0, 0, 0)
      call create_reaction_extremes(recorder%forces, case, equation, y)
      call create_demands(recorder%demands, case, equation, y)
      call create_envelopes(recorder%envelopes, case, equation, y)
      if (.not. allocated(case%output%dt)) return
      recorder%keeps_history = .true.
      recorder%keeps_events = .true.
      recorder%dt = case%output%dt
      recorder%next_row = 1
      call create_columns(recorder, case, equation, y)
      allocate (recorder%history)
      call create_history(recorder%history, recorder%row, t_end, recorder%dt, error)
   end subroutine create_recorder

   !> Collect the columns that apply to the scene.
   subroutine create_columns(recorder, case, equation, y)
      type(recorder_t), intent(inout) :: recorder
      !! its `row` receives the columns
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) any possible state

      recorder%m_w_g = 0
      if (equation%has_wall) then
         if (allocated(case%wall%m_w)) recorder%m_w_g = case%wall%m_w*equation%p%g
      end if
      ! without forces in N at first
      recorder%newtons = [force_t ::]
      call put_columns(recorder, equation, 0.0_wp, y, 0*y, recorder%energy)
      recorder%newtons = forces_of(case, recorder%row)
      call put_columns(recorder, equation, 0.0_wp, y, 0*y, recorder%energy)
   end subroutine create_columns

   !> Compute the columns at one instant.
   subroutine find_columns(recorder, equation, t, y, is_at_rest)
      type(recorder_t), intent(inout) :: recorder
      !! after `create_columns`; its `row` receives the values
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      logical, intent(in) :: is_at_rest
      !! the wall rests, so its acceleration is 0
      real(wp) :: y_dot(size(y))

      call find_rates(equation, t, y, is_at_rest, y_dot)
      call put_columns(recorder, equation, t, y, y_dot, recorder%energy)
   end subroutine find_columns

   !> Update the maxima with a state.
   subroutine observe_state(recorder, equation, t, y)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u

      recorder%theta_max = max(recorder%theta_max, y(1))
      recorder%theta_min = min(recorder%theta_min, y(1))
      recorder%theta_dot_ends = max(recorder%theta_dot_ends, abs(y(2)))
      if (recorder%follows_cable) recorder%cable_max = max(recorder%cable_max, &
         cable_force_at(equation, y(1), equation%state%side))
      if (allocated(recorder%top)) then
         recorder%top = max(recorder%top, abs(top_displacements(equation, y)))
      end if
      if (.not. equation%has_frame) return
      if (allocated(recorder%drifts)) call observe_drifts(recorder%drifts, equation, y)
      u = abs(frame_displacement(equation, equation%state%side, y))
      if (u > recorder%u_max) then
         recorder%u_max = u
         recorder%t_u_max = t
      end if
   end subroutine observe_state

   !> True if the recorder keeps running values besides its `peaks_t`.
   pure logical function has_more_than_peaks(recorder) result(has_more)
      type(recorder_t), intent(in) :: recorder

      has_more = sees_forces(recorder) .or. recorder%keeps_energy .or. recorder%follows_cable &
         .or. allocated(recorder%drifts) .or. allocated(recorder%top)
   end function has_more_than_peaks

   !> True if every step must be observed.
   !>
   !> Otherwise only steps with events, or with possible extrema of reactions, need it.
   pure logical function needs_all_steps(recorder) result(needs_all)
      type(recorder_t), intent(in) :: recorder

      needs_all = recorder%keeps_history .or. recorder%keeps_events &
         .or. allocated(recorder%drifts) .or. allocated(recorder%top) &
         .or. allocated(recorder%envelopes)
   end function needs_all_steps

   !> True if the requested outputs depend on the ground motion while the wall rests.
   pure logical function sees_rest(recorder)
      type(recorder_t), intent(in) :: recorder

      sees_rest = recorder%keeps_history .or. sees_forces(recorder)
   end function sees_rest

   !> Return true if the impulses at impacts are requested.
   pure logical function sees_impulses(recorder)
      type(recorder_t), intent(in) :: recorder

      sees_impulses = allocated(recorder%forces)
      if (sees_impulses) sees_impulses = recorder%forces%sees_impulses
   end function sees_impulses

   !> Return true if forces, accelerations or velocities are requested.
   pure logical function sees_forces(recorder)
      type(recorder_t), intent(in) :: recorder

      sees_forces = allocated(recorder%forces) .or. allocated(recorder%demands) &
         .or. allocated(recorder%envelopes)
   end function sees_forces

   !> Record a piece of smooth motion inside the last step of the integrator.
   subroutine observe_piece(recorder, piece, error, has_plain_reactions, has_calm_demands)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      logical, intent(in), optional :: has_plain_reactions
      !! the piece is known to have no extremum of the reactions
      logical, intent(in), optional :: has_calm_demands
      !! the piece is known to have no extremum of the demands
      type(displacements_t) :: floors
      type(top_motion_t) :: top
      real(wp) :: times(top_count)
      type(step_view_t) :: seen
      !! part of the piece with its own forces
      type(step_states_t), allocatable :: states
      real(wp), target :: y_seen(size(piece%y_b)), rates(size(piece%y_b), 2)
      logical :: is_seen, has_forces, has_demands, has_envelopes

      seen = piece
      is_seen = piece%t_b > recorder%t_settled
      if (is_seen .and. piece%t_a < recorder%t_settled) then
         call sample_state(piece, recorder%t_settled, y_seen, error)
         if (allocated(error)) return
         seen = from(piece, recorder%t_settled, y_seen)
      end if
      has_forces = allocated(recorder%forces) .and. is_seen
      if (present(has_plain_reactions)) has_forces = has_forces .and. .not. has_plain_reactions
      has_demands = allocated(recorder%demands) .and. is_seen
      if (present(has_calm_demands)) has_demands = has_demands .and. .not. has_calm_demands
      has_envelopes = allocated(recorder%envelopes) .and. is_seen
      if (has_forces .or. has_demands .or. has_envelopes) then
         call rates_at(seen%equation, seen%t_a, seen%y_a, rates(:, 1))
         call rates_at(seen%equation, seen%t_b, seen%y_b, rates(:, 2))
         seen%rates_a => rates(:, 1)
         seen%rates_b => rates(:, 2)
      end if
      call observe_fastest(recorder, piece, error)
      if (allocated(error)) return
      if (has_forces) call observe_moving(recorder%forces, seen, states, error)
      if (allocated(error)) return
      if (allocated(recorder%drifts)) call observe_turns(recorder%drifts, &
         recorder%t_drifts, floors, piece, error)
      if (allocated(error)) return
      if (allocated(recorder%top)) then
         call observe_turns(recorder%top, times, top, piece, error)
         if (piece%equation%has_frame .and. recorder%top(1) > recorder%u_max) then
            recorder%u_max = recorder%top(1)
            recorder%t_u_max = times(1)
         end if
      end if
      if (allocated(error)) return
      if (has_demands) call search_piece(recorder%demands, seen, states, error)
      if (allocated(error)) return
      if (has_envelopes) then
         call search_piece(recorder%envelopes, seen, states, error)
         if (.not. allocated(error)) call follow_elements(recorder%envelopes, seen, error)
      end if
      if (allocated(error)) return
      if (recorder%keeps_history) call sample_piece(recorder, piece, error)
      if (allocated(error)) return
      if (recorder%keeps_energy) call integrate_powers(recorder%energy, piece, error)
   end subroutine observe_piece

   !> Update the maximum of |theta'| inside a piece, at theta'' = 0.
   !>
   !> The search is skipped if no value can exceed the largest so far. A long piece is searched in
   !> parts.
   subroutine observe_fastest(recorder, piece, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: short = 1
      !! limit of a short piece, times the fastest rate of the scene [-]
      real(wp), dimension(size(piece%y_b)), target :: y_a, y_b
      type(step_view_t) :: part
      integer :: i, n

      ! impacts depend on this maximum, with any request
      recorder%theta_dot_ends = max(recorder%theta_dot_ends, abs(piece%y_b(2)))
      if (.not. recorder%seeks_velocity) return
      recorder%theta_dot_max = max(recorder%theta_dot_max, recorder%theta_dot_ends)
      n = 1
      if (.not. is_short(piece, short, sqrt(piece%equation%p%g/piece%equation%p%R))) then
         n = count_parts(piece)
      end if
      if (n == 1) then
         call observe_turn(recorder, piece, error)
         return
      end if
      y_b = piece%y_a
      part = piece
      do i = 1, n
         y_a = y_b
         part = from(part, part%t_b, y_a)
         if (i == 1) part%t_a = piece%t_a
         call sample_state(piece, end_of_part(piece, i, n), y_b, error)
         if (allocated(error)) return
         part = until(part, end_of_part(piece, i, n), y_b)
         recorder%theta_dot_max = max(recorder%theta_dot_max, abs(y_b(2)))
         call observe_turn(recorder, part, error)
         if (allocated(error)) return
      end do
   end subroutine observe_fastest

   !> Update the maximum of |theta'| in a piece of at most a quarter of a period.
   !>
   !> Candidates are the instants at which theta'' changes its sign.
   subroutine observe_turn(recorder, piece, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      type(functions_t) :: velocity
      type(moment_t) :: b
      type(span_t) :: span
      type(watch_t) :: watch
      logical :: is_found
      integer, parameter :: most_turns = 20
      !! further ones in a part are round-off
      integer :: i

      if (fastest_in(piece) < recorder%theta_dot_max) return
      velocity%step = piece
      velocity%states = [2, 0]
      span = span_of(velocity)
      b = span%b
      watch = watch_t(1, 1, side=sign(1.0_wp, span%a%f(1, 1)))
      select case (changes_in(span, watch))
      case (no_change)
         return
      case (one_change)
         call observe_extremum(recorder, piece, [span%a%f(1, 1), b%f(1, 1)], error)
      case default
         do i = 1, most_turns
            if (stays_within(recorder%theta_dot_max, span)) return
            call stop_at_change(velocity, watch, span, is_found, error)
            if (allocated(error) .or. .not. is_found) return
            recorder%theta_dot_max = max(recorder%theta_dot_max, abs(span%b%f(1, 0)))
            watch%side = -watch%side
            span = span_between(velocity, span%b, b)
         end do
      end select
   end subroutine observe_turn

   !> True if |theta'| provably does not exceed a value in a span.
   pure logical function stays_within(largest, span)
      real(wp), intent(in) :: largest
      !! [rad/s]
      type(span_t), intent(in) :: span

      stays_within = all([changes_in(span, watch_t(1, 0, level=-largest, side=1.0_wp)), &
         changes_in(span, watch_t(1, 0, level=largest, side=-1.0_wp))] == no_change)
   end function stays_within

   !> Update the maximum of |theta'| in a piece where theta'' changes its sign once.
   !>
   !> The cubic through values and slopes at both ends gives a first instant. A secant method
   !> refines it until the value no longer changes.
   subroutine observe_extremum(recorder, piece, slope, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: slope(2)
      !! theta'' at both ends [rad/s2]
      type(error_t), allocatable, intent(out) :: error
      type(secant_t) :: search
      real(wp) :: h, t, found
      real(wp) :: y(size(piece%y_b))

      h = piece%t_b - piece%t_a
      search = secant_between([piece%t_a, piece%t_b], slope)
      t = piece%t_a + h*stationary_point(piece%y_a(2), slope(1)*h, piece%y_b(2), slope(2)*h)
      if (t > piece%t_a .and. t < piece%t_b) search%next = t
      do while (search%is_open)
         t = search%next
         call piece%integrator%state_at(t, y, error)
         if (allocated(error)) return
         recorder%theta_dot_max = max(recorder%theta_dot_max, abs(y(2)))
         found = second_derivative(piece%equation, t, y)
         call close_in(search, found)
         if (abs(found*(search%next - t)) <= epsilon(t)*recorder%theta_dot_max) return
      end do
   end subroutine observe_extremum

   !> Write the rows of the history in a piece, from the integrator's last step.
   subroutine sample_piece(recorder, piece, error)
      type(recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      type(energy_t) :: energy
      !! energy up to the row; the sum of the run uses whole pieces and is independent of the rows
      real(wp), target :: y(size(piece%y_b))
      real(wp) :: y_dot(size(piece%y_b))
      real(wp) :: t

      do while (recorder%next_row <= size(recorder%history%values, 1))
         t = next_time(recorder)
         if (t > piece%t_b) exit
         call piece%integrator%state_at(t, y, error)
         if (allocated(error)) return
         energy = recorder%energy
         if (recorder%keeps_energy) call integrate_powers(energy, until(piece, t, y), error)
         if (allocated(error)) return
         call rates_at(piece%equation, t, y, y_dot)
         call write_row(recorder, piece%equation, t, y, y_dot, energy)
      end do
   end subroutine sample_piece

   !> Time of the next row of the history [s].
   pure real(wp) function next_time(recorder)
      type(recorder_t), intent(in) :: recorder

      next_time = short_decimal((recorder%next_row - 1)*recorder%dt)
   end function next_time

   !> Record a wall at rest from t_a to t_b, inside the current interval of the motion.
   subroutine observe_rest(recorder, equation, y, t_a, t_b)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in), contiguous, target :: y(:)
      !! (states), of which the first two are zero
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      real(wp) :: t, y_dot(size(y))

      t = max(t_a, recorder%t_settled)
      if (t <= t_b) then
         if (allocated(recorder%forces)) call observe_resting(recorder%forces, equation, y, t, t_b)
         if (allocated(recorder%demands)) call search_rest(recorder%demands, equation, y, t, t_b)
         if (allocated(recorder%envelopes)) call search_rest(recorder%envelopes, equation, y, &
            t, t_b)
      end if
      if (.not. recorder%keeps_history) return
      do while (recorder%next_row <= size(recorder%history%values, 1))
         t = next_time(recorder)
         if (t > t_b) exit
         call find_rates_at_rest(equation, t, y, y_dot)
         call write_row(recorder, equation, t, y, y_dot, recorder%energy)
      end do
   end subroutine observe_rest

   !> Record a wall on its base without velocity.
   subroutine observe_still(recorder, equation, t, y)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: y_dot(size(y))

      call rates_at(equation, t, y, y_dot)
      if (allocated(recorder%forces)) call search_state(recorder%forces, equation, t, y, y_dot)
      if (allocated(recorder%demands)) call search_state(recorder%demands, equation, t, y, y_dot)
      if (allocated(recorder%envelopes)) call search_state(recorder%envelopes, equation, t, y, &
         y_dot)
   end subroutine observe_still

   !> Compute the rates of all states, whether the wall moves or rests.
   subroutine find_rates(equation, t, y, is_at_rest, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! time [s]
      real(wp), intent(in) :: y(:)
      !! states, each in its unit
      logical, intent(in) :: is_at_rest
      !! the wall rests on both corners
      real(wp), intent(out) :: y_dot(:)
      !! rates of the states, each in its unit over s

      if (is_at_rest) then
         call find_rates_at_rest(equation, t, y, y_dot)
      else
         call rates_at(equation, t, y, y_dot)
      end if
   end subroutine find_rates

   !> Compute the rates of all states while the wall rests.
   subroutine find_rates_at_rest(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: y_dot(:)

      y_dot = 0
      if (equation%floors%free > 0 .or. equation%beam%n > 0) call rates_at(equation, t, y, y_dot)
      y_dot(2) = 0
   end subroutine find_rates_at_rest

   !> Write the next row of the history.
   subroutine write_row(recorder, equation, t, y, y_dot, energy)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      type(energy_t), intent(in) :: energy
      !! energy with the work up to t

      call put_columns(recorder, equation, t, y, y_dot, energy)
      recorder%history%values(recorder%next_row, :) = recorder%row%numbers(:recorder%row%n)
      recorder%next_row = recorder%next_row + 1
   end subroutine write_row

   !> Fill in the columns that apply to the scene, in their order.
   subroutine put_columns(recorder, equation, t, y, y_dot, energy)
      type(recorder_t), intent(inout) :: recorder
      !! its `row` receives the columns
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      type(energy_t), intent(in) :: energy
      real(wp) :: u_s
      !! [m]
      real(wp) :: u_s_dot
      !! [m/s]
      real(wp) :: cable
      !! force of all tendons over m_w g [-]

      u_s = 0
      call clear(recorder%row)
      associate (row => recorder%row, m_w_g => recorder%m_w_g)
         call put(row, id%t_s, t)
         if (equation%has_wall) then
            call put(row, id%theta_rad, y(1))
            call put(row, id%theta_dot_rad_s, y(2))
            call put(row, id%theta_ddot_rad_s2, y_dot(2))
         end if
         if (equation%has_frame) then
            call frame_motion(equation, equation%state%side, y, u_s, u_s_dot)
            call put(row, id%u_s_m, u_s)
            call put(row, id%u_s_dot_m_s, u_s_dot)
         end if
         call put(row, id%u_g_ddot_m_s2, acceleration(equation%motion, interval_of(equation), t))
         if (equation%has_vertical) call put(row, id%v_g_ddot_m_s2, &
            vertical_acceleration(equation%motion, interval_of(equation), t))
         if (equation%has_cable) then
            cable = cable_force_at(equation, y(1), equation%state%side)
            call put(row, id%cable_force_over_m_w_g, cable)
            if (m_w_g > 0) call put(row, id%cable_force_N, cable*m_w_g)
         end if
         if (equation%has_loading_direction) call put(row, id%frame_force_over_m_s_g, &
            bouc_wen_force(equation, y)/equation%p%g)
         if (equation%has_bilinear_springs) call put_frame_force(row, equation, y(1))
         if (has_elements(equation)) call put_element_forces(row, equation, &
            recorder%has_offsets, y)
         if (equation%beam%n > 0) call put(row, id%q_i_m, y(equation%beam%first: &
            equation%beam%first + equation%beam%n - 1))
         if (allocated(equation%floors%m)) call put_floors(row, equation, y)
         if (equation%floors%yields) call put_shears(row, equation, y)
         if (allocated(recorder%demands)) call put_storeys(row, recorder%demands, equation, t, y, &
            y_dot)
         if (allocated(recorder%forces)) then
            call put_reactions(row, equation, m_w_g, t, y, y_dot, u_s)
         end if
         if (allocated(recorder%demands)) call put_demands(row, recorder%demands, equation)
         if (allocated(recorder%envelopes)) call put_envelopes(row, recorder%envelopes, equation, &
            t, y, y_dot)
         call put_newtons(row, recorder%newtons)
         if (recorder%keeps_energy) call put_energies(row, energy, equation, y)
         ! turns -0 of a wall at rest on its left side into 0
         row%numbers(:row%n) = row%numbers(:row%n) + 0.0_wp
      end associate
   end subroutine put_columns

   !> Record an impact with the angular velocities before and after it.
   subroutine observe_impact(recorder, equation, before, after)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: before
      !! [rad/s]
      real(wp), intent(in) :: after
      !! [rad/s]

      recorder%impacts = recorder%impacts + 1_i8
      ! the modes take part in the loss of a wall that bends
      if (recorder%keeps_energy .and. equation%beam%n == 0) then
         recorder%energy%impact = recorder%energy%impact + impact_loss(equation, before, after)
      end if
   end subroutine observe_impact

   !> Record grazing: the wall returns to its base and is driven away again.
   !>
   !> A rotation error of rtol times the largest rotation changes the velocity there by half the
   !> ratio of this error to the clearance. Grazing counts if this relative change reaches 1e-4.
   subroutine observe_grazing(recorder, rtol, t, clearance)
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: rtol
      !! [-]
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: clearance
      !! remaining rotation, or rotation beyond the base [rad]
      real(wp), parameter :: seen = 1.0e-4_wp
      real(wp), parameter :: largest = 0.01_wp
      !! upper limit of clearance over largest rotation for grazing [-]

      if (recorder%t_grazing >= 0) return
      associate (largest_rotation => max(recorder%theta_max, -recorder%theta_min))
         if (clearance > min(largest, rtol/(2*seen))*largest_rotation) return
      end associate
      recorder%t_grazing = t
   end subroutine observe_grazing

   !> Record bounces that are averaged because they are below the resolution.
   pure subroutine observe_chatter(recorder, t, impacts)
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t
      !! [s]
      integer(i8), intent(in) :: impacts
      !! number of averaged impacts

      recorder%impacts = recorder%impacts + impacts
      if (recorder%t_chatter < 0) recorder%t_chatter = t
   end subroutine observe_chatter

   !> Append an event to the list, if events are kept.
   subroutine observe_event(recorder, kind, t, y)
      type(recorder_t), intent(inout) :: recorder
      integer, intent(in) :: kind
      !! kind of the event, one of the `event_` numbers
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      if (recorder%keeps_events) then
         call append_event(recorder%events, recorder%n_events, event_t(kind, t, y(1), y(2)))
      end if
   end subroutine observe_event

   !> Complete the records at the end of a simulation.
   subroutine finish_recorder(recorder, equation, t, y, is_at_rest)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      logical, intent(in) :: is_at_rest
      !! the wall rests at the end, so its acceleration is 0
      real(wp) :: y_dot(size(y))
      integer :: before
      !! interval of the motion that ends at the last knot

      ! the ground motion after a knot at the end does not belong to the run
      before = max(0, interval_of(equation) - 1)
      if (t <= interval_end(equation%motion, before)) call enter_interval(equation%model_t, &
         equation%state, before)
      call find_rates(equation, t, y, is_at_rest, y_dot)
      call observe_present(recorder, equation, t, y, y_dot)
      if (.not. recorder%keeps_history) return
      call shorten_events(recorder%events, recorder%n_events)
      if (recorder%next_row > size(recorder%history%values, 1)) return
      ! The last row may lie within round-off beyond the end.
      if (next_time(recorder) <= t*(1 + 16*epsilon(t))) then
         call write_row(recorder, equation, t, y, y_dot, recorder%energy)
      end if
      ! overturning and collapse end the history early
      call shorten_history(recorder%history, recorder%next_row - 1)
   end subroutine finish_recorder

   !> Update the maxima with the last state of a motion, and complete its energy.
   subroutine observe_present(recorder, equation, t, y, y_dot)
      type(recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      call observe_state(recorder, equation, t, y)
      if (allocated(recorder%forces)) call search_state(recorder%forces, equation, t, y, y_dot)
      if (allocated(recorder%demands)) call search_state(recorder%demands, equation, t, y, y_dot)
      if (allocated(recorder%envelopes)) call search_state(recorder%envelopes, equation, t, y, &
         y_dot)
      if (recorder%keeps_energy) then
         recorder%energy%final = mechanical_energy(equation, y)
         recorder%energy%hysteretic = recorder%energy%flow + yielding_loss(equation, y)
         call clear(recorder%energy%terms)
         call put_energies(recorder%energy%terms, recorder%energy, equation, y)
      end if
   end subroutine observe_present

end module rwmf_simulation_recorder_recorder
