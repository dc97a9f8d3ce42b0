!> Lanes that step together, and what they have in common: their table, the pair, the lines of the
!> motion.
module rwmf_simulation_lanes_team
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_lane_columns, only: column_count, line_columns, of_calm, of_fastest, &
      of_plain, of_time, of_trial, screen_t
   use rwmf_integrator_lane_kernels, only: lane_kernels_t
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_math_sign_changes, only: changes_of, polygon_t, rate_polygon, roughness, unclear
   use rwmf_model_equation, only: equation_t, ground, vertical_ground
   use rwmf_motion_ground_motion, only: fastest_rate, interval_end, interval_last, &
      is_piecewise_linear, line_of, line_t, motion_t, step_parts, vertical_line_of
   use rwmf_simulation_events_step_quartic, only: no_event
   use rwmf_simulation_free_vibration, only: long_rest
   use rwmf_simulation_hybrid_state, only: hybrid_t
   use rwmf_simulation_recorder_recorder, only: needs_all_steps, recorder_t
   implicit none
   private

   public :: lane_t, team_t, create_team, leave_team, tabulate_lines, line_row
   public :: longest_step, find_steps_to_watch, follow_curves, may_hide_turns

   real(wp), parameter :: longest_angle(2) = [0.7_wp, 1.4_wp]
   !! of the vibration in a step, so that its events can be seen; where it only turns [rad]
   real(wp), parameter :: no_limit = -1
   !! of an interval that no lane steps into without a look [s]

   !> One run of a team between its steps. It points to what its owner holds.
   type :: lane_t
      type(equation_t), pointer :: equation => null()
      type(hybrid_t), pointer :: hybrid => null()
      type(recorder_t), pointer :: recorder => null()
      type(explicit_pair_t), pointer :: integrator => null()
      !! the last step of the lane, for whoever looks into it
      real(wp) :: t_end = 0
      !! until when it runs [s]
      type(error_t), allocatable :: error
      logical :: is_smooth = .false.
      !! between its events all is seen in the rotation
      logical :: is_held = .false.
      !! the wall rests while other states move
      logical :: has_limits = .false.
      !! not so where a storey or a drift comes to a limit, or a held wall lifts off
      integer :: goal = no_event
      !! event that the lane steps to
      real(wp) :: seen_within = 0
      !! length of the step that has shown it [s]
      integer :: trials = 0
      !! steps that it has taken for that
      integer :: idle = 0
      !! looks since the clock has moved last
      real(wp) :: t_last = -huge(1.0_wp)
      !! time of the last look [s]
   end type lane_t

   !> Lanes that step together.
   type :: team_t
      integer :: width
      type(pair_t) :: pair
      type(lane_kernels_t) :: kernels
      real(wp), allocatable :: room(:)
      !! memory that the following arrays share, each with units of its own
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
      !! (width, powers) in the last step [J/kg]; not allocated: nobody asks for energies
      integer, allocatable :: mark(:)
      !! (width)
      logical :: has_curves
      !! the motion is not one of straight lines
      real(wp), allocatable :: lines(:, :)
      !! (columns of a line, intervals of the motion from 0, and one more that nobody enters) limit
      !! [s], a_0 [m/s2], slope [m/s3], t_0 [s]; vertical a_0, slope
      real(wp) :: max_steps
      !! number of steps that a run may take [-]
      real(wp) :: steps_left = 0
      !! no run can have taken more than its steps before so many of the team [-]
      logical :: has_limits = .false.
      !! a lane may have: it is asked in every step
      logical :: has_ended = .true.
      !! a lane has no length of a step: its run is over, or it has none
      logical, allocatable :: is_busy(:)
      !! (width) the lane has an ordinate
      logical :: keeps_more = .false.
      !! more is asked for than the events tell
      logical, allocatable :: is_watched(:)
      !! (width) the step has to be looked into for it; then the following is set
      real(wp), allocatable :: t_before(:), y_before(:, :)
      !! (width) [s], (width, states) at the beginning of the step
      type(screen_t) :: screen
      !! what is asked for inside the steps; the following belongs to it
      real(wp), allocatable :: values(:, :, :)
      !! (width, reactions and demands, places) in the step, and the extrema so far, in the units
      !! of `lane_demands`
      real(wp), allocatable :: constants(:, :)
      !! (width, constants) of the buildings
      logical, allocatable :: is_known(:)
      !! (width) those at the beginning of the step are
   end type team_t

contains

   !> Work space of a team, with numbers that are finite in idle lanes.
   subroutine create_team(equation, pair, max_steps, width, team)
      type(equation_t), intent(in) :: equation
      !! of any lane: the scene is the same
      type(pair_t), intent(in) :: pair
      integer(i8), intent(in) :: max_steps
      !! of a run
      integer, intent(in) :: width
      !! number of lanes: 1, or that of the kernels, which are then to be set
      type(team_t), intent(out), target :: team
      integer :: i

      team%width = width
      team%pair = pair
      call divide_room(equation%n, equation%scene%n_coef, team)
      do i = 1, width
         team%coef(i, :) = equation%state%coef(1, :)
      end do
      team%tolerance(:, :) = 1
      associate (n => equation%n)
         allocate (team%error(width), source=0.0_wp)
         allocate (team%mark(width), source=0)
         allocate (team%is_busy(width), team%is_watched(width), source=.false.)
         allocate (team%t_before(width), team%y_before(width, n))
         team%table(:, [of_plain, of_calm]) = 1
         allocate (team%is_known(width), source=.false.)
         team%max_steps = real(max_steps, wp)
         team%has_curves = .not. is_piecewise_linear(equation%motion)
         allocate (team%lines(line_columns, 0:1), source=no_limit)
      end associate
   end subroutine create_team

   !> The arrays of the kernels, filled with zeros. They begin at lines of the cache, because a
   !> vector that crosses one is loaded in two pieces.
   subroutine divide_room(n, n_coef, team)
      use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
      integer, intent(in) :: n
      !! number of states
      integer, intent(in) :: n_coef
      !! number of coefficients
      type(team_t), intent(inout), target :: team
      integer, parameter :: line = 8
      !! of the cache, in numbers
      real(wp), pointer, contiguous :: part(:)
      !! the room that is left
      integer(c_intptr_t) :: address
      integer :: first

      allocate (team%room(team%width*(column_count + n_coef + 2*most_stages + 3*n + 1 &
         + n*most_stages) + line), source=0.0_wp)
      address = transfer(c_loc(team%room(1)), address)
      first = 1 + int(modulo(-address/(storage_size(0.0_wp)/8), int(line, c_intptr_t)))
      part => team%room(first:)
      associate (w => team%width)
         team%table(1:w, 1:column_count) => part
         part => part(w*column_count + 1:)
         team%coef(1:w, 1:n_coef) => part
         part => part(w*n_coef + 1:)
         team%tolerance(1:w, 0:n) => part
         part => part(w*(n + 1) + 1:)
         team%ground(1:w, 1:most_stages, 1:2) => part
         part => part(w*2*most_stages + 1:)
         team%y(1:w, 1:n) => part
         part => part(w*n + 1:)
         team%y_new(1:w, 1:n) => part
         part => part(w*n + 1:)
         team%k(1:w, 1:n, 1:most_stages) => part
      end associate
   end subroutine divide_room

   !> A lane goes on between two steps in a team of its own.
   subroutine leave_team(lane, i, team, alone)
      type(lane_t), intent(in) :: lane
      integer, intent(in) :: i
      !! number of the lane in the team that it leaves
      type(team_t), intent(inout) :: team
      type(team_t), intent(out), target :: alone

      call create_team(lane%equation, team%pair, int(team%max_steps, i8), 1, alone)
      alone%lines = team%lines
      alone%keeps_more = team%keeps_more
      alone%has_limits = team%has_limits
      if (allocated(team%work)) alone%work = team%work(i:i, :)
      alone%screen = team%screen
      alone%values = team%values(i:i, :, :)
      alone%constants = team%constants(i:i, :)
      alone%is_known = team%is_known(i)
      alone%mark = team%mark(i)
      alone%table(1, :) = team%table(i, :)
      alone%coef(1, :) = team%coef(i, :)
      alone%tolerance(1, :) = team%tolerance(i, :)
      alone%y(1, :) = team%y(i, :)
      alone%is_busy = .true.
      team%is_busy(i) = .false.
   end subroutine leave_team

   !> The straight lines of the motion; without a limit where they are none, or too short for a
   !> step: such an interval is entered as single runs do.
   subroutine tabulate_lines(motion, has_vertical, t_end, team)
      type(motion_t), intent(in) :: motion
      logical, intent(in) :: has_vertical
      !! the scene has a vertical motion of the ground
      real(wp), intent(in) :: t_end
      !! [s]
      type(team_t), intent(inout) :: team
      type(line_t) :: line, vertical
      real(wp) :: begin, limit
      integer :: i

      deallocate (team%lines)
      allocate (team%lines(line_columns, 0:interval_last(motion) + 1), source=no_limit)
      begin = 0
      do i = 0, interval_last(motion)
         line = line_of(motion, i)
         if (has_vertical) vertical = vertical_line_of(motion, i, line)
         limit = min(t_end, interval_end(motion, i))
         if (team%has_curves .or. limit - begin <= 16*epsilon(limit)*limit &
             .or. limit - begin > long_rest) limit = no_limit
         team%lines(:, i) = line_row(limit, line, vertical)
         begin = interval_end(motion, i)
      end do
   end subroutine tabulate_lines

   !> Lines of the ground motion in one interval as a row of the table.
   pure function line_row(limit, line, vertical) result(row)
      real(wp), intent(in) :: limit
      !! [s]
      type(line_t), intent(in) :: line, vertical
      real(wp) :: row(line_columns)
      !! `of_limit` and the columns of the lines

      row = [limit, line%a_0, line%slope, line%t_0, vertical%a_0, vertical%slope]
   end function line_row

   !> Longest step in which the events of a lane can be seen [s].
   real(wp) function longest_step(equation) result(longest)
      type(equation_t), intent(in) :: equation
      real(wp) :: rate
      !! the fastest in the scene [rad/s]

      rate = max(equation%p%omega_s, equation%floors%max_frequency/2, fastest_rate( &
         equation%motion))
      if (equation%has_wall) rate = max(rate, sqrt(equation%p%g_over_R))
      longest = longest_angle(1)/rate
      if (.not. (equation%has_wall .or. equation%has_bilinear_springs &
          .or. equation%has_loading_direction .or. equation%floors%yields)) longest = &
         longest_angle(2)/rate
      longest = longest/step_parts(equation%motion)
   end function longest_step

   !> Which steps have to be looked into for what no event tells? All of them for histories and
   !> lists of events, those that are not plain for reactions or demands, and those that may hold
   !> the peak of |theta'|.
   subroutine find_steps_to_watch(lanes, team)
      type(lane_t), intent(in) :: lanes(:)
      type(team_t), intent(inout) :: team
      logical :: is_watched
      integer :: i

      do i = 1, team%width
         is_watched = team%is_busy(i) .and. lanes(i)%is_smooth
         if (is_watched .and. minval(team%table(i, [of_plain, of_calm])) > 0) then
            is_watched = needs_all_steps(lanes(i)%recorder)
            if (.not. is_watched) is_watched = may_be_fastest(team, i, &
               lanes(i)%recorder%theta_dot_max)
         end if
         team%is_watched(i) = is_watched
         if (.not. is_watched) cycle
         team%t_before(i) = team%table(i, of_time)
         team%y_before(i, :) = team%y(i, :)
      end do
   end subroutine find_steps_to_watch

   !> May a step hold the peak of |theta'|? Not where its bound is below what was largest so far,
   !> nor where theta'' keeps its sign. The cubic through both ends and velocities mostly shows it,
   !> the quintic with both accelerations more sharply: the last stage knows that at the end nearly.
   pure logical function may_be_fastest(team, i, largest) result(may)
      type(team_t), intent(in) :: team
      integer, intent(in) :: i
      real(wp), intent(in) :: largest
      !! |theta'| so far [rad/s]
      type(polygon_t) :: rate
      real(wp) :: middle, bend(2), error, fastest

      fastest = max(team%table(i, of_fastest), largest)
      associate (v_a => team%y(i, 2), v_b => team%y_new(i, 2))
         middle = 3*((team%y_new(i, 1) - team%y(i, 1))/team%table(i, of_trial)) - v_a - v_b
         bend = [middle - v_a, v_b - middle]
         error = longest_angle(2)*(abs(bend(2) - bend(1)) + longest_angle(2)*maxval(abs(bend)))/18
         may = .not. max(abs(v_a), abs(v_b), max(abs(v_a + 2*middle), abs(v_b + 2*middle))/3 &
            + error) < fastest
         if (may) may = min(minval(sign(1.0_wp, v_b - v_a)*bend)*2, abs(v_b - v_a)/2) <= 3*error
      end associate
      if (.not. may) return
      rate = rate_in_step(team, i)
      associate (c => rate%c, margin => rate%margin, n => rate%n)
         may = .not. maxval(abs(c(:n)) + margin(:n)) < fastest
         if (may) may = any(sign(1.0_wp, c(n) - c(0))*(c(1:n) - c(:n - 1)) &
            <= margin(1:n) + margin(:n - 1))
      end associate
   end function may_be_fastest

   !> theta' in the step of a lane that was tried last, with the error of the interpolation.
   pure type(polygon_t) function rate_in_step(team, i) result(rate)
      type(team_t), intent(in) :: team
      integer, intent(in) :: i
      real(wp), dimension(0:2) :: a, b

      associate (h => team%table(i, of_trial), last => team%pair%stages)
         a = [team%y(i, 1), team%y(i, 2), team%k(i, 2, 1)]
         b = [team%y_new(i, 1), team%y_new(i, 2), team%k(i, 2, last)]
         rate = rate_polygon(h, a, b, roughness(longest_angle(2), h, a, b))
      end associate
   end function rate_in_step

   !> May theta' change its sign in a step where the quartic does not show it?
   pure logical function may_hide_turns(team, i) result(may)
      type(team_t), intent(in) :: team
      integer, intent(in) :: i
      !! number of the lane
      type(polygon_t) :: rate
      real(wp) :: noise

      associate (h => team%table(i, of_trial), y => team%y, y_new => team%y_new)
         noise = 8*epsilon(h)*(max(abs(y(i, 2)), abs(y_new(i, 2))) &
            + max(abs(y(i, 1)), abs(y_new(i, 1)))/h)
         may = .not. turns_plainly(team, i, noise)
         if (.not. may) return
         rate = rate_in_step(team, i)
         ! from a turn on the motion goes where it is accelerated to
         if (abs(y(i, 2)) <= 0) rate%c(0) = sign(2*noise, rate%c(1))
         rate%c = sign(1.0_wp, rate%c(0))*rate%c
         may = changes_of(rate, noise) == unclear
      end associate
   end function may_hide_turns

   !> Does theta' plainly keep its sign in a step, or change it once? All coefficients of
   !> `rate_in_step` then lie beyond their margins: the same numbers, written out for most steps.
   pure logical function turns_plainly(team, i, noise) result(is_plain)
      type(team_t), intent(in) :: team
      integer, intent(in) :: i
      real(wp), intent(in) :: noise
      !! round-off of theta' [rad/s]
      real(wp) :: rise, rise_new, way, bend(2), r(0:4), c(0:5), margin

      associate (h => team%table(i, of_trial), y => team%y, y_new => team%y_new, &
                 last => team%pair%stages)
         rise = h*team%k(i, 2, 1)
         rise_new = h*team%k(i, 2, last)
         r(0) = y(i, 2)
         r(1) = r(0) + 0.25_wp*rise
         r(4) = y_new(i, 2)
         r(3) = r(4) - 0.25_wp*rise_new
         way = (y_new(i, 1) - y(i, 1))/h
         r(2) = 5*way - 2*(r(0) + r(4)) - 0.25_wp*(rise - rise_new)
         ! fourth differences of the points of the quintic, over h
         bend(1) = 0.2_wp*(r(3) - 3*r(2) + 3*r(1) - r(0))
         bend(2) = 0.2_wp*(r(4) - 3*r(3) + 3*r(2) - r(1))
         margin = longest_angle(2)*(abs(bend(2) - bend(1)) + longest_angle(2)*maxval(abs(bend)))/20
         c(0) = r(0)
         c(1) = 0.2_wp*(r(0) + 4*r(1))
         c(2) = 0.2_wp*(2*r(1) + 3*r(2))
         c(3) = 0.2_wp*(3*r(2) + 2*r(3))
         c(4) = 0.2_wp*(4*r(3) + r(4))
         c(5) = r(4)
         is_plain = min(abs(c(0)), abs(c(1)), abs(c(2)) - margin, abs(c(3)) - margin, abs(c(4)), &
            abs(c(5))) > 2*noise .and. count(c(1:)*c(:4) < 0) <= 1
      end associate
   end function turns_plainly

   !> Accelerations of the ground where they are not on a straight line.
   subroutine follow_curves(lanes, team)
      type(lane_t), intent(in) :: lanes(:)
      type(team_t), intent(inout) :: team
      real(wp) :: t
      integer :: i, s

      if (.not. team%has_curves) return
      do i = 1, team%width
         if (.not. team%is_busy(i)) cycle
         associate (equation => lanes(i)%equation)
            if (equation%state%line%is_straight) cycle
            do s = 1, team%pair%stages
               t = team%table(i, of_time) + team%pair%c(s)*team%table(i, of_trial)
               team%ground(i, s, 1) = ground(equation, t)
               if (equation%has_vertical) team%ground(i, s, 2) = vertical_ground(equation, t)
            end do
         end associate
      end do
   end subroutine follow_curves

end module rwmf_simulation_lanes_team
