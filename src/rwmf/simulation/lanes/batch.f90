!> Batch of lanes that step together (`batch_t`), with the shared table, pair and lines of the
!> motion.
module rwmf_simulation_lanes_batch
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_lane_columns, only: column_count, line_columns, of_calm, of_fastest, &
      of_high, of_interval, of_known, of_low, of_plain, of_time, of_trial, screen_t
   use rwmf_integrator_lane_kernels, only: lane_kernels_t
   use rwmf_integrator_lane_quiet, only: limit_count
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_math_sign_changes, only: changes_of, one_change, polygon_t, rate_polygon, &
      roughness, unclear
   use rwmf_model_equation, only: enter_interval, equation_t, ground, interval_of, vertical_ground
   use rwmf_motion_ground_motion, only: fastest_rate, interval_end, interval_last, &
      is_piecewise_linear, line_of, line_t, motion_t, step_parts, vertical_line_of
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_events_watched_spans, only: span_t, watch_t
   use rwmf_simulation_hybrid_free_vibration, only: long_rest
   use rwmf_simulation_recorder_recorder, only: needs_all_steps, recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t
   implicit none
   private

   public :: at_storey
   public :: lane_state_t, storey_end_t, batch_t, create_batch, leave_batch, tabulate_lines
   public :: line_row
   public :: longest_step, find_steps_to_inspect, follow_curves, follow_interval
   public :: first_acceleration, turns_in_step

   real(wp), parameter :: longest_angle(2) = [0.7_wp, 1.4_wp]
   !! phase angle of the vibration in a step that still shows its events; second value for a motion
   !! without events except turns [rad]
   real(wp), parameter :: no_limit = -1
   !! limit of an interval that lanes enter one by one only [s]

   integer, parameter :: at_storey = 4
   !! target event in addition to those of the rotation: a storey ends its branch

   !> First end of a storey's branch in the attempted step of a lane.
   type :: storey_end_t
      type(watch_t) :: first
      !! end of a branch found in the step
      real(wp) :: at = huge(1.0_wp)
      !! its position in the step; the largest number without one [-]
      logical :: is_clear = .false.
      !! the ends of the step show all changes of the storeys
      type(watch_t) :: target
      !! end of a branch at the target of the step
      logical :: is_proven = .false.
      !! a longer step has shown that no change precedes the target
      real(wp) :: rest = 0
      !! time from the end of the step to the target, by one step of Newton's method [s]
      real(wp), allocatable :: y(:), rates(:)
      !! (states) at the end of the step, and their rates
      type(span_t) :: span
      !! displacements of the storeys at both ends of the step [m]
      type(span_t) :: states
      !! hysteretic states at both ends [-]
   end type storey_end_t

   !> State of one run of a batch between its steps. Its pointers refer to data of their owners.
   type :: lane_state_t
      type(equation_t), pointer :: equation => null()
      type(hybrid_t), pointer :: hybrid => null()
      type(recorder_t), pointer :: recorder => null()
      type(explicit_pair_t), pointer :: integrator => null()
      !! holds the last step of the lane, for inspection
      real(wp) :: t_end = 0
      !! end time of the run [s]
      type(error_t), allocatable :: error
      logical :: is_smooth = .false.
      !! the ends of the attempted step show its first change
      logical :: is_held = .false.
      !! the wall is held at rest while other states move
      logical :: has_limits = .false.
      !! steps may not be smooth: at a limit of a storey or drift, or at lift-off of a held wall
      integer :: target_event = no_event
      !! event at the target of the next step
      real(wp) :: seen_within = 0
      !! length of the step that contains the event [s]
      integer :: trials = 0
      !! number of trial steps to this event
      type(storey_end_t) :: storey
   end type lane_state_t

   !> Storeys that yield one by one, in the lanes of a batch.
   type :: branches_t
      integer :: n = 0
      !! number of storeys; if 0 the following components are not allocated
      logical :: is_screened = .false.
      !! a loop over the lanes finds the steps without the end of a branch
      integer :: smooth = 0
      !! index of the first hysteretic state; 0 for storeys on straight lines
      real(wp), allocatable :: limits(:, :, :)
      !! (width, storeys, columns) limits of the branches, see `rwmf_integrator_lane_quiet`
      real(wp), allocatable :: frequency(:)
      !! (width) frequency of the fastest vibration [rad/s]
      real(wp), allocatable :: longest(:)
      !! (width) longest step that the loop may find to be without any change of a lane's limits [s]
      real(wp), allocatable :: d(:, :, :, :)
      !! (width, storeys, 0:1, 2) displacements [m] and rates [m/s] at both ends of the steps
      real(wp), allocatable :: is_quiet(:, :)
      !! (width, 0:storeys) 1 if a storey certainly does not end its branch; first column: all
   end type branches_t

   !> Batch of lanes that step together.
   type :: batch_t
      integer :: width
      type(pair_t) :: pair
      type(lane_kernels_t) :: kernels
      real(wp), allocatable :: room(:)
      !! buffer shared by the following arrays, each with its own units
      real(wp), pointer, contiguous :: table(:, :) => null()
      !! (width, columns) with the columns and units of `rwmf_integrator_lane_columns`
      real(wp), pointer, contiguous :: coef(:, :) => null()
      !! (width, coefficients)
      real(wp), pointer, contiguous :: tolerance(:, :) => null()
      !! (width, 0:states)
      real(wp), pointer, contiguous :: ground(:, :, :) => null()
      !! (width, stages, 2) [m/s2]
      real(wp), pointer, contiguous :: y(:, :) => null(), y_new(:, :) => null()
      !! (width, states)
      real(wp), pointer, contiguous :: k(:, :, :) => null()
      !! (width, states, stages)
      real(wp), allocatable :: error(:)
      !! (width) norm of the local error over the tolerance [-]
      real(wp), allocatable :: work(:, :)
      !! (width, powers) work in the last step [J/kg]; not allocated without requested energies
      integer, allocatable :: mark(:)
      !! (width)
      logical :: has_curves
      !! true if the motion is not piecewise linear
      real(wp), allocatable :: lines(:, :)
      !! (columns, intervals of the motion from 0, with an unused last one). Each line has limit
      !! [s], a_0 [m/s2], slope [m/s3], t_0 [s]; vertical a_0, slope
      real(wp) :: max_steps
      !! largest number of steps of a run [-]
      real(wp) :: steps_left = 0
      !! number of batch steps in which no run can exceed its limit of steps [-]
      logical :: has_limits = .false.
      !! true if a lane may have limits, which are then checked in every step
      logical :: has_ended = .true.
      !! true if the step length of a lane is 0: its run is over, or it has no run
      logical, allocatable :: is_busy(:)
      !! (width) true for a lane with an ordinate
      logical :: keeps_more = .false.
      !! true if the requested outputs need more than the events
      logical, allocatable :: is_watched(:)
      !! (width) true if the outputs need this step; the following arrays are then set
      real(wp), allocatable :: t_before(:), y_before(:, :)
      !! (width) time [s] and (width, states) states at the start of the step
      logical :: is_screened = .false.
      !! true if reactions or demands are requested
      logical :: seeks_demands = .false.
      !! true if demands are requested, even if loops over lanes cannot compute them
      type(screen_t) :: screen
      !! requested outputs inside the steps; the following arrays belong to it
      real(wp), allocatable :: values(:, :, :)
      !! (width, reactions and demands, places) values in the step and extrema so far, in the units
      !! of `lane_demands`
      real(wp), allocatable :: constants(:, :)
      !! (width, constants) constants of the buildings
      type(branches_t) :: branches
   end type batch_t

contains

   !> Create the work arrays of a batch, with finite numbers in idle lanes.
   subroutine create_batch(equation, pair, max_steps, width, batch)
      type(equation_t), intent(in) :: equation
      !! equation of any lane: all share one scene
      type(pair_t), intent(in) :: pair
      integer(i8), intent(in) :: max_steps
      !! largest number of steps of a run
      integer, intent(in) :: width
      !! number of lanes: 1, or the width of the kernels, which the caller then sets
      type(batch_t), intent(out), target :: batch
      integer :: i

      batch%width = width
      batch%pair = pair
      call divide_room(equation%n, equation%scene%n_coef, batch)
      do i = 1, width
         batch%coef(i, :) = equation%state%coef(1, :)
      end do
      batch%tolerance(:, :) = 1
      associate (n => equation%n)
         allocate (batch%error(width), source=0.0_wp)
         allocate (batch%mark(width), source=0)
         allocate (batch%is_busy(width), batch%is_watched(width), source=.false.)
         allocate (batch%t_before(width), batch%y_before(width, n))
         batch%table(:, [of_plain, of_calm, of_known]) = 1
         if (equation%floors%yields) call create_storeys(equation, width, batch%branches)
         batch%max_steps = real(max_steps, wp)
         batch%has_curves = .not. is_piecewise_linear(equation%motion)
         allocate (batch%lines(line_columns, 0:1), source=no_limit)
      end associate
   end subroutine create_batch

   !> Create the arrays of storeys that yield one by one.
   subroutine create_storeys(equation, width, branches)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: width
      type(branches_t), intent(out) :: branches

      associate (n => equation%floors%n_storeys)
         branches%n = n
         ! the loop knows storeys whose floors have states
         branches%is_screened = equation%floors%n > 0
         if (allocated(equation%floors%laws)) branches%smooth = equation%floors%laws(1)%place
         allocate (branches%limits(width, n, limit_count), source=0.0_wp)
         allocate (branches%frequency(width), branches%longest(width), source=0.0_wp)
         allocate (branches%d(width, n, 0:1, 2), source=0.0_wp)
         allocate (branches%is_quiet(width, 0:n), source=0.0_wp)
      end associate
   end subroutine create_storeys

   !> Divide the buffer into the arrays of the kernels, all zero.
   !>
   !> The arrays start at cache lines, because a vector across two lines needs two loads.
   subroutine divide_room(n, n_coef, batch)
      use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
      integer, intent(in) :: n
      !! number of states
      integer, intent(in) :: n_coef
      !! number of coefficients
      type(batch_t), intent(inout), target :: batch
      integer, parameter :: line = 8
      !! length of a cache line, in numbers
      real(wp), pointer, contiguous :: part(:)
      !! remaining part of the buffer
      integer(c_intptr_t) :: address
      integer :: first

      allocate (batch%room(batch%width*(column_count + n_coef + 2*most_stages + 3*n + 1 &
         + n*most_stages) + line), source=0.0_wp)
      address = transfer(c_loc(batch%room(1)), address)
      first = 1 + int(modulo(-address/(storage_size(0.0_wp)/8), int(line, c_intptr_t)))
      part => batch%room(first:)
      associate (w => batch%width)
         batch%table(1:w, 1:column_count) => part
         part => part(w*column_count + 1:)
         batch%coef(1:w, 1:n_coef) => part
         part => part(w*n_coef + 1:)
         batch%tolerance(1:w, 0:n) => part
         part => part(w*(n + 1) + 1:)
         batch%ground(1:w, 1:most_stages, 1:2) => part
         part => part(w*2*most_stages + 1:)
         batch%y(1:w, 1:n) => part
         part => part(w*n + 1:)
         batch%y_new(1:w, 1:n) => part
         part => part(w*n + 1:)
         batch%k(1:w, 1:n, 1:most_stages) => part
      end associate
   end subroutine divide_room

   !> Move a lane between two steps into a new batch of one lane.
   subroutine leave_batch(lane, i, batch, alone)
      type(lane_state_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in its present batch
      type(batch_t), intent(inout) :: batch
      type(batch_t), intent(out), target :: alone

      call create_batch(lane%equation, batch%pair, int(batch%max_steps, i8), 1, alone)
      alone%lines = batch%lines
      alone%keeps_more = batch%keeps_more
      alone%has_limits = batch%has_limits
      if (allocated(batch%work)) alone%work = batch%work(i:i, :)
      alone%is_screened = batch%is_screened
      alone%seeks_demands = batch%seeks_demands
      alone%screen = batch%screen
      alone%values = batch%values(i:i, :, :)
      alone%constants = batch%constants(i:i, :)
      if (batch%branches%n > 0) then
         alone%branches%limits = batch%branches%limits(i:i, :, :)
         alone%branches%frequency = batch%branches%frequency(i)
         alone%branches%longest = batch%branches%longest(i)
      end if
      alone%mark = batch%mark(i)
      alone%table(1, :) = batch%table(i, :)
      alone%coef(1, :) = batch%coef(i, :)
      alone%tolerance(1, :) = batch%tolerance(i, :)
      alone%y(1, :) = batch%y(i, :)
      alone%is_busy = .true.
      batch%is_busy(i) = .false.
   end subroutine leave_batch

   !> Tabulate the straight lines of the motion.
   !>
   !> Intervals of a curved motion, and intervals too short or too long for a step, get no limit.
   !> Lanes enter them one by one, as single runs do.
   subroutine tabulate_lines(motion, has_vertical, t_end, batch)
      type(motion_t), intent(in) :: motion
      logical, intent(in) :: has_vertical
      !! true if the scene has vertical ground motion
      real(wp), intent(in) :: t_end
      !! [s]
      type(batch_t), intent(inout) :: batch
      type(line_t) :: line, upward
      real(wp) :: begin, limit
      integer :: i

      deallocate (batch%lines)
      allocate (batch%lines(line_columns, 0:interval_last(motion) + 1), source=no_limit)
      begin = 0
      do i = 0, interval_last(motion)
         line = line_of(motion, i)
         if (has_vertical) upward = vertical_line_of(motion, i, line)
         limit = min(t_end, interval_end(motion, i))
         if (batch%has_curves .or. limit - begin <= 16*epsilon(limit)*limit &
             .or. limit - begin > long_rest) limit = no_limit
         batch%lines(:, i) = line_row(limit, line, upward)
         begin = interval_end(motion, i)
      end do
   end subroutine tabulate_lines

   !> Row of the table with the lines of the ground motion in one interval.
   pure function line_row(limit, line, upward) result(row)
      real(wp), intent(in) :: limit
      !! [s]
      type(line_t), intent(in) :: line, upward
      real(wp) :: row(line_columns)
      !! column `of_limit` and the columns of the lines

      row = [limit, line%a_0, line%slope, line%t_0, upward%a_0, upward%slope]
   end function line_row

   !> Longest step that still shows all events of a lane [s].
   real(wp) function longest_step(equation) result(longest)
      type(equation_t), intent(in) :: equation
      real(wp) :: rate
      !! highest angular frequency of the scene [rad/s]

      rate = max(equation%p%omega_s, equation%floors%max_frequency/2, fastest_rate( &
         equation%motion))
      if (equation%has_wall) rate = max(rate, sqrt(equation%p%g_over_R))
      longest = longest_angle(1)/rate
      if (.not. (equation%has_wall .or. equation%has_bilinear_springs &
          .or. equation%has_loading_direction .or. equation%floors%yields)) longest = &
         longest_angle(2)/rate
      longest = longest/step_parts(equation%motion)
   end function longest_step

   !> Select the steps to inspect for outputs that events do not provide.
   !>
   !> Histories and event lists need all steps. Reactions and demands need the steps that the screen
   !> does not exclude. The remaining ones need inspection if they may contain the peak of |theta'|.
   subroutine find_steps_to_inspect(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch
      logical :: is_watched
      integer :: i

      do i = 1, batch%width
         is_watched = batch%is_busy(i) .and. lanes(i)%is_smooth
         if (is_watched .and. min(batch%table(i, of_plain), batch%table(i, of_calm)) > 0) then
            associate (recorder => lanes(i)%recorder)
               is_watched = needs_all_steps(recorder)
               if (recorder%seeks_velocity .and. .not. is_watched) is_watched = may_be_fastest( &
                  batch, i, recorder%theta_dot_max)
            end associate
         end if
         batch%is_watched(i) = is_watched
         if (.not. is_watched) cycle
         batch%t_before(i) = batch%table(i, of_time)
         batch%y_before(i, :) = batch%y(i, :)
      end do
   end subroutine find_steps_to_inspect

   !> Return whether a step may contain the peak of |theta'|.
   !>
   !> It cannot if its bound is below the largest value so far, or if theta'' keeps its sign. In
   !> most steps the cubic through rotations and velocities at both ends suffices. The quintic with
   !> both accelerations is more accurate; the last stage approximates the acceleration at the end.
   pure logical function may_be_fastest(batch, i, largest) result(may)
      type(batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp), intent(in) :: largest
      !! largest |theta'| so far [rad/s]
      type(polygon_t) :: rate
      real(wp) :: middle, bend(2), error, fastest

      fastest = max(batch%table(i, of_fastest), largest)
      associate (v_a => batch%y(i, 2), v_b => batch%y_new(i, 2))
         middle = 3*((batch%y_new(i, 1) - batch%y(i, 1))/batch%table(i, of_trial)) - v_a - v_b
         bend = [middle - v_a, v_b - middle]
         error = longest_angle(2)*(abs(bend(2) - bend(1)) + longest_angle(2)*maxval(abs(bend)))/18
         may = .not. max(abs(v_a), abs(v_b), max(abs(v_a + 2*middle), abs(v_b + 2*middle))/3 &
            + error) < fastest
         if (may) may = min(minval(sign(1.0_wp, v_b - v_a)*bend)*2, abs(v_b - v_a)/2) <= 3*error
      end associate
      if (.not. may) return
      rate = rate_in_step(batch, i)
      associate (c => rate%c, margin => rate%margin, n => rate%n)
         may = .not. maxval(abs(c(:n)) + margin(:n)) < fastest
         if (may) may = any(sign(1.0_wp, c(n) - c(0))*(c(1:n) - c(:n - 1)) &
            <= margin(1:n) + margin(:n - 1))
      end associate
   end function may_be_fastest

   !> Acceleration at the start of a step [rad/s2]. A wall that lifts off moves away from its base,
   !> where round-off may give the zero either sign.
   pure real(wp) function first_acceleration(batch, i) result(acceleration)
      type(batch_t), intent(in) :: batch
      integer, intent(in) :: i
      !! lane

      acceleration = batch%k(i, 2, 1)
      if (max(abs(batch%y(i, 1)), abs(batch%y(i, 2))) > 0) return
      associate (low => batch%table(i, of_low), high => batch%table(i, of_high))
         if (abs(low) <= 0 .and. high > 0) acceleration = max(tiny(low), acceleration)
         if (abs(high) <= 0 .and. low < 0) acceleration = min(-tiny(low), acceleration)
      end associate
   end function first_acceleration

   !> Polygon of theta' in the last trial step of a lane, with the interpolation error.
   pure type(polygon_t) function rate_in_step(batch, i) result(rate)
      type(batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp), dimension(0:2) :: a, b

      associate (h => batch%table(i, of_trial), last => batch%pair%stages)
         a = [batch%y(i, 1), batch%y(i, 2), first_acceleration(batch, i)]
         b = [batch%y_new(i, 1), batch%y_new(i, 2), batch%k(i, 2, last)]
         rate = rate_polygon(h, a, b, roughness(longest_angle(2), h, a, b))
      end associate
   end function rate_in_step

   !> Sign changes of theta' in the last trial step of a lane, as one of the constants of
   !> `rwmf_math_sign_changes`.
   pure integer function turns_in_step(batch, i) result(turns)
      type(batch_t), intent(in) :: batch
      integer, intent(in) :: i
      !! number of the lane
      type(polygon_t) :: rate
      real(wp) :: noise

      associate (h => batch%table(i, of_trial), y => batch%y, y_new => batch%y_new)
         noise = 8*epsilon(h)*(max(abs(y(i, 2)), abs(y_new(i, 2))) &
            + max(abs(y(i, 1)), abs(y_new(i, 1)))/h)
         rate = rate_in_step(batch, i)
         ! after a turn, the motion follows its acceleration
         if (abs(y(i, 2)) <= 0) rate%c(0) = sign(2*noise, rate%c(1))
         rate%c = sign(1.0_wp, rate%c(0))*rate%c
         turns = changes_of(rate, noise)
      end associate
   end function turns_in_step

   !> Update the run's interval of the motion.
   subroutine follow_interval(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! lane of the batch
      type(batch_t), intent(in) :: batch

      associate (interval => int(batch%table(i, of_interval)))
         if (interval_of(lane%equation) /= interval) call enter_interval(lane%equation%model_t, &
            lane%equation%state, interval)
      end associate
   end subroutine follow_interval

   !> Evaluate ground accelerations that are not on a straight line.
   subroutine follow_curves(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(batch_t), intent(inout) :: batch
      real(wp) :: t
      integer :: i, s

      if (.not. batch%has_curves) return
      do i = 1, batch%width
         if (.not. batch%is_busy(i)) cycle
         associate (equation => lanes(i)%equation)
            if (equation%state%line%is_straight) cycle
            do s = 1, batch%pair%stages
               t = batch%table(i, of_time) + batch%pair%c(s)*batch%table(i, of_trial)
               batch%ground(i, s, 1) = ground(equation, t)
               if (equation%has_vertical) batch%ground(i, s, 2) = vertical_ground(equation, t)
            end do
         end associate
      end do
   end subroutine follow_curves

end module rwmf_simulation_lanes_batch
