!> What lanes that step together have in common: their table, the pair, the lines of the motion.
module rwmf_spectrum_lane_team
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: column_count, line_columns
   use rwmf_integrator_lane_kernels, only: lane_kernels_of, lane_kernels_t
   use rwmf_integrator_pairs, only: dormand_prince_853, most_stages, pair_t, verner_65
   use rwmf_model_equation, only: equation_t
   use rwmf_motion_ground_motion, only: fastest_rate, interval_end, interval_last, line_of, &
      line_t, motion_t, vertical_line_of
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_simd_dispatch, only: best_level
   implicit none
   private

   public :: team_t, create_team, tabulate_lines, line_row, pair_for, caution

   real(wp), parameter :: no_limit = -1
   !! of an interval that no lane steps into without a look [s]

   !> Lanes that step together.
   type :: team_t
      integer :: width
      type(pair_t) :: pair
      type(lane_kernels_t) :: kernels
      real(wp), allocatable :: table(:, :)
      !! (width, columns)
      real(wp), allocatable :: coef(:, :)
      !! (width, coefficients)
      real(wp), allocatable :: tolerance(:, :)
      !! (width, 0:states)
      real(wp), allocatable :: ground(:, :, :)
      !! (width, stages, 2) [m/s2]
      real(wp), allocatable :: y(:, :), y_new(:, :)
      !! (width, states)
      real(wp), allocatable :: k(:, :, :)
      !! (width, states, stages)
      real(wp), allocatable :: error(:)
      !! (width)
      integer, allocatable :: mark(:)
      !! (width)
      logical :: has_curves
      !! the motion is not one of straight lines
      real(wp), allocatable :: lines(:, :)
      !! (columns of a line, intervals of the motion from 0, and one more that nobody enters)
      real(wp) :: max_steps
      logical :: has_ended = .true.
      !! a lane has no length of a step: its run is over, or it has none
      logical, allocatable :: is_busy(:)
      !! (width) the lane has an ordinate
   end type team_t

contains

   !> Work space of a team, with numbers that are finite in idle lanes.
   subroutine create_team(case, equation, width, team)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      !! of any lane: the scene is the same
      integer, intent(in) :: width
      type(team_t), intent(out) :: team

      team%width = width
      team%pair = pair_for(case, equation)
      team%kernels = lane_kernels_of(best_level())
      associate (n => equation%n)
         allocate (team%table(width, column_count), source=0.0_wp)
         team%coef = spread(equation%coef(1, :), 1, width)
         allocate (team%tolerance(width, 0:n), source=1.0_wp)
         allocate (team%ground(width, most_stages, 2), team%y(width, n), team%y_new(width, n), &
            team%k(width, n, most_stages), source=0.0_wp)
         allocate (team%error(width), source=0.0_wp)
         allocate (team%mark(width), source=0)
         allocate (team%is_busy(width), source=.false.)
         team%max_steps = real(case%solver%max_steps, wp)
      end associate
   end subroutine create_team

   !> The straight lines of the motion; without a limit where they are none, or too short for a
   !> step: such an interval is entered as single runs do.
   subroutine tabulate_lines(motion, has_vertical, t_end, team)
      type(motion_t), intent(in) :: motion
      logical, intent(in) :: has_vertical
      real(wp), intent(in) :: t_end
      type(team_t), intent(inout) :: team
      type(line_t) :: line, vertical
      real(wp) :: begin, limit
      integer :: i

      team%has_curves = fastest_rate(motion) > 0
      allocate (team%lines(line_columns, 0:interval_last(motion) + 1), source=no_limit)
      begin = 0
      do i = 0, interval_last(motion)
         line = line_of(motion, i)
         if (has_vertical) vertical = vertical_line_of(motion, i, line)
         limit = min(t_end, interval_end(motion, i))
         if (team%has_curves .or. limit - begin <= 16*epsilon(limit)*limit) limit = no_limit
         team%lines(:, i) = line_row(limit, line, vertical)
         begin = interval_end(motion, i)
      end do
   end subroutine tabulate_lines

   pure function line_row(limit, line, vertical) result(row)
      real(wp), intent(in) :: limit
      !! [s]
      type(line_t), intent(in) :: line, vertical
      real(wp) :: row(line_columns)
      !! `of_limit` and the columns of the lines

      row = [limit, line%a_0, line%slope, line%t_0, vertical%a_0, vertical%slope]
   end function line_row

   !> The pair for a tolerance. The local errors of smooth hysteresis add up, so that it gets the
   !> higher order.
   pure type(pair_t) function pair_for(case, equation) result(pair)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation

      if (case%solver%rtol < 1.0e-8_wp .or. equation%has_loading_direction &
          .or. equation%floors%n > 1) then
         pair = dormand_prince_853()
      else
         pair = verner_65()
      end if
   end function pair_for

   !> Part of the tolerance that a step may use up: the errors of the lower order add up where the
   !> steps are as long as they allow, under pulses and at short periods.
   pure real(wp) function caution(pair)
      type(pair_t), intent(in) :: pair

      caution = merge(0.2_wp, 1.0_wp, pair%error_order < 8)
   end function caution

end module rwmf_spectrum_lane_team
