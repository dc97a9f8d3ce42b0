!> The largest demands of a run, found while the observer passes by.
!>
!> Demands are smooth between two events or knots. Both ends of a piece of motion count with their
!> one-sided values, so that those on both sides of an impact do. A step that is short, and whose
!> ends stay below the largest so far by what a vibration can rise between them, is left alone. Any
!> other is searched at five places, in parts of a quarter of the shortest period at most. A maximum
!> that can be the largest so far is closed in on until nothing but round-off is to be gained: in a
!> short step by polynomials of the states, then with the integrator's own state.
module rwmf_simulation_recorder_demand_extremes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: climb, maximum_between, maximum_t, vertex_of_parabola
   use rwmf_model_assembly, only: equation_t, interval_of, rates_at
   use rwmf_model_demands, only: building_of, building_t, demands_at, demands_t
   use rwmf_model_history_row, only: history_row_t, put
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, sample_state, step_view_t
   use rwmf_simulation_recorder_reaction_estimates, only: fastest_of, inside, n_nodes, node, &
      place_of_peak
   use rwmf_simulation_recorder_step_states, only: fit_states, may_interpolate, state_inside, &
      step_states_t
   use rwmf_simulation_result, only: demand_extremes_t
   implicit none
   private

   public :: demand_recorder_t, create_demands, observe_demands, observe_demands_at
   public :: observe_demands_at_rest, put_storeys, put_demands, demand_extremes
   public :: put_constants, count_demands

   !> Running maxima of the magnitudes: drifts and shears of the storeys [-], [m/s2], accelerations
   !> of the floors [m/s2], overturning moment [m], shear [m/s2] and moment [m2/s2] in the wall.
   type :: demand_recorder_t
      type(building_t) :: building
      type(demands_t) :: present
      !! of the last instant that was asked for
      real(wp), allocatable :: largest(:)
      !! (demands)
      real(wp), allocatable :: t_largest(:)
      !! (demands) [s]
      real(wp), allocatable :: smallest(:)
      !! (demands) which tells how far they vary
      logical, allocatable :: is_led(:)
      !! (demands) it is in a fixed proportion to one before it
      real(wp) :: frequency = 0
      !! of the fastest vibration, before anything yields [rad/s]
      real(wp) :: z_shear = 0, z_moment = 0
      !! height of the largest forces in the wall above its base [m]
      real(wp) :: t_end = -1
      !! where the last piece ended [s]
      real(wp), allocatable :: y_end(:)
      !! (states) there
      real(wp), allocatable :: rates(:, :)
      !! (states, 2) of the states at both ends of the last piece
      real(wp), allocatable :: at_ends(:, :)
      !! (demands, 2)
   end type demand_recorder_t

contains

   !> Begin, when the case asks for demands.
   subroutine create_demands(recorder, case, equation, y)
      type(demand_recorder_t), allocatable, intent(out) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) at the beginning
      integer :: n

      if (.not. allocated(case%output)) return
      if (.not. case%output%demands) return
      allocate (recorder)
      recorder%frequency = max(fastest_of(equation), wall_frequency(equation, y))
      call building_of(case, equation, recorder%building)
      associate (building => recorder%building, storeys => recorder%building%drifts)
         n = 2*storeys + building%floors + 3
         allocate (recorder%largest(n), source=-1.0_wp)
         allocate (recorder%t_largest(n), source=0.0_wp)
         allocate (recorder%smallest(n), source=huge(1.0_wp))
         allocate (recorder%is_led(n), source=.false.)
         allocate (recorder%y_end(equation%n), recorder%rates(equation%n, 2))
         allocate (recorder%at_ends(n, 2))
         if (building%is_linear) recorder%is_led(storeys + 1:2*storeys) = .true.
         if (equation%floors%n == 0) then
            recorder%is_led(2:storeys) = .true.
            if (.not. allocated(case%yielding)) return
            recorder%is_led(storeys + 2:2*storeys) = .not. allocated(case%yielding%storey_u_y)
         end if
      end associate
   end subroutine create_demands

   !> Frequency of the wall on its springs and cable, which may vibrate faster than the frame
   !> [rad/s].
   real(wp) function wall_frequency(equation, y) result(frequency)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), parameter :: small = 1.0e-6_wp
      !! [rad]
      real(wp), dimension(size(y)) :: beside, rates, rates_beside

      frequency = 0
      if (.not. equation%has_wall) return
      beside = y
      beside(1) = y(1) + sign(small, y(1))
      call rates_at(equation, 0.0_wp, y, rates)
      call rates_at(equation, 0.0_wp, beside, rates_beside)
      frequency = sqrt(max(0.0_wp, (rates(2) - rates_beside(2))/(beside(1) - y(1))))
   end function wall_frequency

   !> Numbers of a building for loops over lanes.
   pure subroutine count_demands(recorder, equation, floors, storeys, are_known)
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      integer, intent(out) :: floors, storeys
      !! number of them
      logical, intent(out) :: are_known
      !! the loops find its demands: not where storeys follow one mode

      floors = recorder%building%floors
      storeys = recorder%building%drifts
      are_known = storeys == 0 .or. equation%floors%n > 0
   end subroutine count_demands

   !> Constants of the building for loops over lanes.
   pure subroutine put_constants(recorder, constants)
      type(demand_recorder_t), intent(in) :: recorder
      real(wp), intent(out) :: constants(:)
      !! as `lane_demands` reads them, each in its unit

      associate (building => recorder%building)
         constants = 0
         constants(:2) = [building%unit, 1/building%weight]
         if (allocated(building%z)) constants(3:2 + building%floors) = building%m*building%z &
            /building%weight
         constants(3 + building%floors:) = 1/building%height
      end associate
   end subroutine put_constants

   !> One state of motion, or of a wall at rest with zeros for its rates.
   subroutine observe_demands_at(recorder, equation, t, y, y_dot)
      type(demand_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      real(wp) :: found(size(recorder%largest))

      call find_demands(recorder, equation, t, y, y_dot, found)
      call keep_largest(recorder, t, found)
   end subroutine observe_demands_at

   !> Magnitudes of the demands at a state.
   subroutine find_demands(recorder, equation, t, y, y_dot, found)
      type(demand_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      real(wp), intent(out) :: found(:)
      !! (demands)

      call demands_at(recorder%building, equation, t, y, y_dot, recorder%present)
      associate (present => recorder%present, n => size(found), s => recorder%building%drifts)
         found(:s) = abs(present%drift)
         found(s + 1:2*s) = abs(present%shear)
         found(2*s + 1:n - 3) = abs(present%acceleration)
         found(n - 2:) = [abs(present%overturning), present%wall%shear, present%wall%moment]
      end associate
   end subroutine find_demands

   !> Let the demands that have been found last take part.
   pure subroutine keep_largest(recorder, t, found)
      type(demand_recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t
      real(wp), intent(in) :: found(:)
      !! (demands) their magnitudes
      integer :: q

      associate (wall => recorder%present%wall, n => size(found))
         if (found(n - 1) > recorder%largest(n - 1)) recorder%z_shear = wall%z_shear
         if (found(n) > recorder%largest(n)) recorder%z_moment = wall%z_moment
      end associate
      do q = 1, size(found)
         recorder%smallest(q) = min(recorder%smallest(q), found(q))
         if (.not. found(q) > recorder%largest(q)) cycle
         recorder%largest(q) = found(q)
         recorder%t_largest(q) = t
      end do
   end subroutine keep_largest

   !> Smooth motion inside the last step of the integrator.
   subroutine observe_demands(recorder, piece, error)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      type(step_states_t), allocatable :: states
      real(wp) :: found(size(recorder%largest), n_nodes)
      real(wp), parameter :: most_parts = 1000
      real(wp) :: t(2), angle
      integer :: i, n

      call look_at_ends(recorder, piece)
      n = 1
      angle = (piece%t_b - piece%t_a)*recorder%frequency
      if (may_interpolate(piece, recorder%frequency)) then
         if (is_plain(recorder, angle, max(recorder%at_ends(:, 1), recorder%at_ends(:, 2)))) return
         allocate (states)
         call fit_states(piece, recorder%rates, states, error)
         if (allocated(error)) return
      else
         n = max(count_parts(piece), ceiling(min(2*angle/pi, most_parts)))
      end if
      found(:, n_nodes) = recorder%at_ends(:, 1)
      t(2) = piece%t_a
      do i = 1, n
         found(:, 1) = found(:, n_nodes)
         t = [t(2), end_of_part(piece, i, n)]
         call search_part(recorder, piece, states, t, found, error)
         if (allocated(error)) return
      end do
   end subroutine observe_demands

   !> Let both ends of a piece take part. It begins where the one before has ended, unless something
   !> jumped there.
   subroutine look_at_ends(recorder, piece)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      real(wp), parameter :: slack = 1.0e-12_wp
      logical :: goes_on

      associate (found => recorder%at_ends, rates => recorder%rates)
         goes_on = abs(recorder%t_end - piece%t_a) <= 0
         if (goes_on) goes_on = all(abs(recorder%y_end - piece%y_a) <= 0)
         call rates_at(piece%equation, piece%t_a, piece%y_a, rates(:, 1))
         if (goes_on) goes_on = all(abs(rates(:, 1) - rates(:, 2)) <= slack*abs(rates(:, 1)))
         if (goes_on) then
            found(:, 1) = found(:, 2)
         else
            call find_demands(recorder, piece%equation, piece%t_a, piece%y_a, rates(:, 1), &
               found(:, 1))
            call keep_largest(recorder, piece%t_a, found(:, 1))
         end if
         call rates_at(piece%equation, piece%t_b, piece%y_b, rates(:, 2))
         call find_demands(recorder, piece%equation, piece%t_b, piece%y_b, rates(:, 2), found(:, 2))
         call keep_largest(recorder, piece%t_b, found(:, 2))
      end associate
      recorder%t_end = piece%t_b
      recorder%y_end(:) = piece%y_b
   end subroutine look_at_ends

   !> Is it plain from samples of a short step that nothing larger lies between them?
   pure logical function is_plain(recorder, angle, highest)
      type(demand_recorder_t), intent(in) :: recorder
      real(wp), intent(in) :: angle
      !! of the fastest vibration between two samples [rad]
      real(wp), intent(in) :: highest(:)
      !! (demands) the largest of the samples
      real(wp), parameter :: rise = 0.5_wp
      !! of the range so far over the angle squared: by so much a second harmonic rises above both
      !! ends, a vibration by a quarter of it [-]
      real(wp), parameter :: least_rise = 0.02_wp, stiff_rise = 100
      !! the same where a stiff cable, which is not asked, vibrates faster
      real(wp) :: margin
      integer :: q

      margin = max(min(least_rise, stiff_rise*angle**2), rise*angle**2)
      is_plain = .false.
      do q = 1, size(recorder%largest)
         if (.not. highest(q) + margin*(recorder%largest(q) - recorder%smallest(q)) &
             <= recorder%largest(q) .and. .not. recorder%is_led(q)) return
      end do
      is_plain = .true.
   end function is_plain

   !> Extrema in a part in which nothing vibrates by more than a quarter of its period.
   subroutine search_part(recorder, piece, states, t, found, error)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(step_states_t), intent(in), allocatable :: states
      real(wp), intent(in) :: t(2)
      !! its ends [s]
      real(wp), intent(inout) :: found(:, :)
      !! (demands, nodes) the first is known
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: times(n_nodes)
      integer :: i, q

      times = t(1) + (t(2) - t(1))*node
      times(n_nodes) = t(2)
      do i = 2, n_nodes
         if (times(i) >= piece%t_b) then
            found(:, i) = recorder%at_ends(:, 2)
         else
            call sample(recorder, piece, times(i), found(:, i), error, states)
         end if
         if (allocated(error)) return
      end do
      do q = 1, size(found, 1)
         if (recorder%is_led(q)) cycle
         if (place_of_peak(found(q, :), recorder%largest(q)) /= inside) cycle
         call close_in(recorder, piece, states, q, times, found(q, :), error)
         if (allocated(error)) return
      end do
   end subroutine search_part

   !> The maximum of a demand between the nodes.
   subroutine close_in(recorder, piece, states, q, times, found, error)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(step_states_t), intent(in), allocatable :: states
      integer, intent(in) :: q
      !! which demand
      real(wp), intent(in) :: times(n_nodes)
      !! [s]
      real(wp), intent(in) :: found(n_nodes)
      !! the demand there, nearly
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: miss = 0.1_wp
      !! of the range in the part, by which the first point may miss the maximum
      type(maximum_t) :: search
      real(wp) :: at_point(size(recorder%largest))
      real(wp) :: vertex
      integer :: k

      k = min(max(maxloc(found, dim=1), 2), n_nodes - 1)
      vertex = vertex_of_parabola(times(k - 1:k + 1), found(k - 1:k + 1))
      if (.not. (vertex > times(k - 1) .and. vertex < times(k + 1))) vertex = times(k)
      search = maximum_between(times(k - 1), times(k + 1), vertex, is_near=.true.)
      do while (search%is_open)
         call sample(recorder, piece, search%next, at_point, error, states)
         if (allocated(error)) return
         if (at_point(q) + miss*(maxval(found) - minval(found)) < recorder%largest(q)) return
         call climb(search, at_point(q))
      end do
      if (allocated(states)) call sample(recorder, piece, search%x(1), at_point, error)
   end subroutine close_in

   !> Demands inside a piece. Those of the integrator's own state take part.
   subroutine sample(recorder, piece, t, found, error, states)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: t
      real(wp), intent(out) :: found(:)
      type(error_t), allocatable, intent(out) :: error
      type(step_states_t), intent(in), optional :: states
      !! which tell the state nearly
      real(wp), dimension(size(piece%y_b)) :: y, y_dot

      if (present(states)) then
         call state_inside(states, t, y)
      else
         call sample_state(piece, t, y, error)
         if (allocated(error)) return
      end if
      call rates_at(piece%equation, t, y, y_dot)
      call find_demands(recorder, piece%equation, t, y, y_dot, found)
      if (.not. present(states)) call keep_largest(recorder, t, found)
   end subroutine sample

   !> The wall stays at rest while the motion goes through the interval in force. All demands then
   !> are in proportion to the ground's acceleration, or a straight line over it: largest where it
   !> turns, or at the ends.
   subroutine observe_demands_at_rest(recorder, equation, y, t_a, t_b)
      type(demand_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      real(wp) :: t, still(size(y))

      still = 0
      t = t_a
      call observe_demands_at(recorder, equation, t, y, still)
      do while (t < t_b)
         t = min(turning_point(equation%motion, interval_of(equation), t), t_b)
         call observe_demands_at(recorder, equation, t, y, still)
      end do
   end subroutine observe_demands_at_rest

   !> Columns of the storeys that a history without demands does not have; finds the demands.
   subroutine put_storeys(row, recorder, equation, t, y, y_dot)
      type(history_row_t), intent(inout) :: row
      type(demand_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      call demands_at(recorder%building, equation, t, y, y_dot, recorder%present)
      associate (present => recorder%present, g => equation%p%g)
         if (equation%floors%n == 0) call put(row, id%storey_i_drift, present%drift)
         if (.not. equation%floors%yields) call put(row, id%storey_i_shear_over_m_w_g, &
            present%shear/g)
      end associate
   end subroutine put_storeys

   !> Columns of floors and wall, with the demands that `put_storeys` has found.
   subroutine put_demands(row, recorder, equation)
      type(history_row_t), intent(inout) :: row
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation

      associate (present => recorder%present, g => equation%p%g)
         call put(row, id%floor_i_acceleration_g, present%acceleration/g)
         if (recorder%building%roof_height > 0) call put(row, id%overturning_moment_over_weight_m, &
            present%overturning)
         if (.not. equation%has_wall) return
         call put(row, id%wall_shear_over_m_w_g, present%wall%shear/g)
         call put(row, id%wall_moment_over_m_w_g_m, present%wall%moment/g)
      end associate
   end subroutine put_demands

   !> What the run has seen.
   subroutine demand_extremes(recorder, equation, u_s_max, t_u_s_max, extremes)
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: u_s_max
      !! largest |u_s| [m]
      real(wp), intent(in) :: t_u_s_max
      !! its time [s]
      type(demand_extremes_t), intent(out) :: extremes
      integer :: n

      associate (building => recorder%building, largest => recorder%largest, g => equation%p%g, &
                 t => recorder%t_largest, storeys => recorder%building%drifts)
         n = size(largest)
         if (building%floors > 0) then
            extremes%acceleration_max = largest(2*storeys + 1:n - 3)/g
            extremes%t_acceleration_max = t(2*storeys + maxloc(extremes%acceleration_max, dim=1))
            if (building%roof_height > 0) then
               extremes%roof_drift_max = u_s_max/building%roof_height
               extremes%t_roof_drift_max = t_u_s_max
            end if
         end if
         if (storeys > 0) then
            extremes%drift_max = largest(:storeys)
            extremes%t_drift_max = t(maxloc(extremes%drift_max, dim=1))
            if (equation%floors%n == 0) then
               extremes%drift_max = u_s_max*abs(building%bend)/building%height
               extremes%t_drift_max = t_u_s_max
            end if
            extremes%shear_max = largest(storeys + 1:2*storeys)/g
         end if
         if (building%roof_height > 0) then
            extremes%overturning_max = largest(n - 2)
            extremes%t_overturning_max = t(n - 2)
         end if
         if (.not. equation%has_wall) return
         extremes%wall_shear_max = largest(n - 1)/g
         extremes%wall_shear_height = recorder%z_shear
         extremes%wall_moment_max = largest(n)/g
         extremes%wall_moment_height = recorder%z_moment
      end associate
   end subroutine demand_extremes

end module rwmf_simulation_recorder_demand_extremes
