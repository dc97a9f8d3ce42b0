!> The largest demands of a run, found while the observer passes by.
!>
!> Demands are smooth between two events or knots. Both ends of a piece of motion count with their
!> one-sided values, so that those on both sides of an impact do. A step that is short, and whose
!> ends stay below the largest so far by what a vibration can rise between them, is left alone. Any
!> other is searched in parts of a quarter of the shortest period at most, at five places each; a
!> maximum that shows between them is closed in on, to sqrt(epsilon) of the part in time, which
!> leaves round-off in the value.
module rwmf_simulation_recorder_demand_extremes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: climb, maximum_between, maximum_t, vertex_of_parabola
   use rwmf_model_assembly, only: equation_t, interval_of, rates_at
   use rwmf_model_demands, only: building_of, building_t, demands_at, demands_t
   use rwmf_model_history_row, only: history_row_t, put
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, is_short, sample_state, &
      step_view_t
   use rwmf_simulation_recorder_reaction_estimates, only: fastest_of, inside, n_nodes, node, &
      place_of_peak
   use rwmf_simulation_result, only: demand_extremes_t
   implicit none
   private

   public :: demand_recorder_t, create_demands, observe_demands, observe_demands_at
   public :: observe_demands_at_rest, put_storeys, put_demands, demand_extremes

   !> Running maxima of the magnitudes: drifts and shears of the storeys [-], [m/s2], accelerations
   !> of the floors [m/s2], overturning moment [m], shear [m/s2] and moment [m2/s2] in the wall.
   type :: demand_recorder_t
      type(building_t) :: building
      type(demands_t) :: present
      !! of the last instant that was asked for
      real(wp), allocatable :: largest(:)
      !! (demands)
      real(wp), allocatable :: smallest(:)
      !! (demands) which tells how far they vary
      logical, allocatable :: is_led(:)
      !! (demands) it is in a fixed proportion to one before it
      real(wp) :: z_shear = 0, z_moment = 0
      !! height of the largest forces in the wall above its base [m]
   end type demand_recorder_t

contains

   !> Begin, when the case asks for demands.
   subroutine create_demands(recorder, case, equation)
      type(demand_recorder_t), allocatable, intent(out) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      integer :: n

      if (.not. allocated(case%output)) return
      if (.not. case%output%demands) return
      allocate (recorder)
      call building_of(case, equation, recorder%building)
      associate (building => recorder%building, storeys => recorder%building%storeys)
         n = 2*storeys + building%floors + 3
         allocate (recorder%largest(n), source=-1.0_wp)
         allocate (recorder%smallest(n), source=huge(1.0_wp))
         allocate (recorder%is_led(n), source=.false.)
         if (building%is_linear) recorder%is_led(storeys + 1:2*storeys) = .true.
         if (equation%floors%n == 0) then
            recorder%is_led(2:storeys) = .true.
            if (.not. allocated(case%yielding)) return
            recorder%is_led(storeys + 2:2*storeys) = .not. allocated(case%yielding%storey_u_y)
         end if
      end associate
   end subroutine create_demands

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

      call demands_at(recorder%building, equation, t, y, y_dot, recorder%present)
      call keep_largest(recorder, found)
   end subroutine observe_demands_at

   !> Let the present demands take part.
   pure subroutine keep_largest(recorder, found)
      type(demand_recorder_t), intent(inout) :: recorder
      real(wp), intent(out) :: found(:)
      !! (demands) their magnitudes

      associate (present => recorder%present, n => size(found))
         found(:n - 3) = abs([present%drift, present%shear, present%acceleration])
         found(n - 2:) = [abs(present%overturning), present%wall%shear, present%wall%moment]
         if (found(n - 1) > recorder%largest(n - 1)) recorder%z_shear = present%wall%z_shear
         if (found(n) > recorder%largest(n)) recorder%z_moment = present%wall%z_moment
      end associate
      recorder%largest = max(recorder%largest, found)
      recorder%smallest = min(recorder%smallest, found)
   end subroutine keep_largest

   !> Smooth motion inside the last step of the integrator.
   subroutine observe_demands(recorder, piece, error)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: t(2)
      logical :: is_plain
      integer :: i, n

      call look_at_ends(recorder, piece, is_plain)
      if (is_plain) return
      n = count_parts(piece)
      t(2) = piece%t_a
      do i = 1, n
         t = [t(2), end_of_part(piece, i, n)]
         call search_part(recorder, piece, t, error)
         if (allocated(error)) return
      end do
   end subroutine observe_demands

   !> Let both ends of a piece take part. Is it plain from them that nothing larger lies between?
   subroutine look_at_ends(recorder, piece, is_plain)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      logical, intent(out) :: is_plain
      real(wp), parameter :: short = 1
      !! angle of the fastest vibration in a step that may be plain [rad]
      real(wp), parameter :: rise = 0.5_wp
      !! of the range so far over the angle squared: by so much a second harmonic rises above both
      !! ends, a vibration by a quarter of it [-]
      real(wp), parameter :: least_rise = 0.02_wp
      real(wp), dimension(size(recorder%largest), 2) :: found
      real(wp) :: margin

      call sample(recorder, piece, piece%t_a, piece%y_a, found(:, 1))
      call sample(recorder, piece, piece%t_b, piece%y_b, found(:, 2))
      is_plain = is_short(piece, short, fastest_of(piece%equation))
      if (.not. is_plain) return
      margin = max(least_rise, rise*((piece%t_b - piece%t_a)*fastest_of(piece%equation))**2)
      is_plain = all(recorder%is_led .or. maxval(found, 2) + margin*(recorder%largest &
         - recorder%smallest) <= recorder%largest)
   end subroutine look_at_ends

   !> Demands at a state of the piece; they take part.
   subroutine sample(recorder, piece, t, y, found)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: found(:)
      real(wp) :: y_dot(size(y))

      call rates_at(piece%equation, t, y, y_dot)
      call demands_at(recorder%building, piece%equation, t, y, y_dot, recorder%present)
      call keep_largest(recorder, found)
   end subroutine sample

   !> Extrema in a part in which nothing vibrates by more than a quarter of its period.
   subroutine search_part(recorder, piece, t, error)
      type(demand_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      real(wp), intent(in) :: t(2)
      !! its ends [s]
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: found(size(recorder%largest), n_nodes), at_point(size(recorder%largest))
      real(wp) :: y(size(piece%y_b)), times(n_nodes), vertex
      type(maximum_t) :: search
      integer :: i, k, q

      times = t(1) + (t(2) - t(1))*node
      times(n_nodes) = t(2)
      do i = 1, n_nodes
         call sample_inside(times(i), found(:, i))
         if (allocated(error)) return
      end do
      do q = 1, size(found, 1)
         if (recorder%is_led(q)) cycle
         if (place_of_peak(found(q, :), recorder%largest(q)) /= inside) cycle
         k = min(max(maxloc(found(q, :), dim=1), 2), n_nodes - 1)
         vertex = vertex_of_parabola(times(k - 1:k + 1), found(q, k - 1:k + 1))
         if (.not. (vertex > times(k - 1) .and. vertex < times(k + 1))) vertex = times(k)
         search = maximum_between(times(k - 1), times(k + 1), vertex)
         do while (search%is_open)
            call sample_inside(search%next, at_point)
            if (allocated(error)) return
            call climb(search, at_point(q))
         end do
      end do

   contains

      subroutine sample_inside(at, found)
         real(wp), intent(in) :: at
         real(wp), intent(out) :: found(:)

         ! an event at an end of the piece has been placed more exactly than the integrator knows
         if (at <= piece%t_a) then
            y = piece%y_a
         else if (at >= piece%t_b) then
            y = piece%y_b
         else
            call sample_state(piece, at, y, error)
         end if
         if (.not. allocated(error)) call sample(recorder, piece, at, y, found)
      end subroutine sample_inside
   end subroutine search_part

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
         if (equation%floors%n == 0) call put(row, 'storey_{i}_drift', present%drift)
         if (.not. equation%floors%yields) call put(row, 'storey_{i}_shear_over_m_w_g', &
            present%shear/g)
      end associate
   end subroutine put_storeys

   !> Columns of floors and wall, with the demands that `put_storeys` has found.
   subroutine put_demands(row, recorder, equation)
      type(history_row_t), intent(inout) :: row
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation

      associate (present => recorder%present, g => equation%p%g)
         call put(row, 'floor_{i}_acceleration_g', present%acceleration/g)
         if (recorder%building%roof_height > 0) call put(row, 'overturning_moment_over_weight_m', &
            present%overturning)
         if (.not. equation%has_wall) return
         call put(row, 'wall_shear_over_m_w_g', present%wall%shear/g)
         call put(row, 'wall_moment_over_m_w_g_m', present%wall%moment/g)
      end associate
   end subroutine put_demands

   !> What the run has seen.
   subroutine demand_extremes(recorder, equation, u_s_max, extremes)
      type(demand_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: u_s_max
      !! largest |u_s| [m]
      type(demand_extremes_t), intent(out) :: extremes
      integer :: n

      associate (building => recorder%building, largest => recorder%largest, g => equation%p%g, &
                 storeys => recorder%building%storeys)
         n = size(largest)
         if (building%floors > 0) then
            extremes%acceleration_max = largest(2*storeys + 1:n - 3)/g
            if (building%roof_height > 0) extremes%roof_drift_max = u_s_max/building%roof_height
         end if
         if (storeys > 0) then
            extremes%drift_max = largest(:storeys)
            if (equation%floors%n == 0) extremes%drift_max = u_s_max*abs(building%bend) &
               /building%height
            extremes%shear_max = largest(storeys + 1:2*storeys)/g
         end if
         if (building%roof_height > 0) extremes%overturning_max = largest(n - 2)
         if (.not. equation%has_wall) return
         extremes%wall_shear_max = largest(n - 1)/g
         extremes%wall_shear_height = recorder%z_shear
         extremes%wall_moment_max = largest(n)/g
         extremes%wall_moment_height = recorder%z_moment
      end associate
   end subroutine demand_extremes

end module rwmf_simulation_recorder_demand_extremes
