!> The ground motion cut into the steps of the fast spectra, once for all ordinates.
!>
!> Steps end at every knot of the motion and at every extremum of a pulse, so that the acceleration
!> is monotone within a step. In a step it is the cubic through its values on Lobatto's nodes, which
!> is exact for a record.
module rwmf_spectrum_fast_time_grid
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_motion_ground_motion, only: acceleration, fastest_rate, interval_at, interval_end, &
      interval_last, is_piecewise_linear, line_of, line_t, motion_t, peak_acceleration, &
      turning_point
   use rwmf_problem_case, only: case_t, solver_t
   use rwmf_spectrum_fast_types, only: c_2, c_3, ground_step_t
   implicit none
   private

   public :: time_grid_t, build_grids, ground_at, pulse_step, longest_interval, shared_step

   integer, parameter :: max_grid_steps = 1000000
   !! steps of a grid: 64 MB
   integer, parameter :: max_tail_steps = 65536
   !! stored steps after the motion; a longer tail repeats all of them but the first
   real(wp), parameter :: round_off = 1.0e-11_wp
   !! bound of the round-off of differences of accelerations, over the largest acceleration [-]

   real(wp), parameter :: negligible_step = 1.0e-9_wp
   !! length of a step, over the longest one, below which it is left out and becomes a jump [-]

   !> Steps from 0 to the end of the simulation.
   type :: time_grid_t
      integer(i8) :: repetitions = 0
      !! of the steps behind `motion_end_step` until the end of the simulation
      logical :: is_cut = .false.
      !! they end before it: more would exceed `max_steps`
      type(ground_step_t), pointer, contiguous :: step(:) => null()
      !! (steps) in the array of all grids; null: there is no grid
      real(wp), allocatable :: t(:)
      !! (steps) beginnings [s]
      integer :: first = 1
      !! number of the first step in the array of all grids
      real(wp) :: longest_step = 0
      !! [s]
      real(wp), allocatable :: largest(:)
      !! (steps) largest |acceleration| [m/s2]
      integer :: motion_end_step = 1
      !! first step from which on the ground stands still
      logical :: is_straight = .true.
      !! the acceleration is linear in every step
      logical :: has_jumps = .false.
      !! the acceleration jumps later than at the beginning
   end type time_grid_t

contains

   !> Cut [0, t_end] into steps, once for every longest step that is asked for.
   !>
   !> A grid with more steps than the case or `max_grid_steps` allows is left out; of a long time
   !> after the motion only the beginning is stored. The steps of all grids follow each other in one
   !> array, which is large: it is written once and not copied.
   subroutine build_grids(case, motion, threads, h_max, ground, grid)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      !! number of threads to use
      real(wp), intent(in) :: h_max(:)
      !! (grids) [s]; 0: not asked for
      type(ground_step_t), allocatable, target, intent(out) :: ground(:)
      type(time_grid_t), intent(out) :: grid(:)
      !! (grids)
      integer :: number(size(h_max))
      integer :: i

      number = 0
      do i = 1, size(h_max)
         if (.not. h_max(i) > 0) cycle
         call cut_steps(motion, case%solver, h_max(i), grid(i), number(i))
         if (number(i) > min(max_grid_steps, case%solver%max_steps)) number(i) = 0
      end do
      allocate (ground(sum(number)))
      ! From the last grid on: it has the shortest steps and takes longest.
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) &
      !$omp if (count(number > 0) > 1)
      do i = size(h_max), 1, -1
         if (number(i) == 0) cycle
         grid(i)%first = sum(number(:i - 1)) + 1
         grid(i)%step => ground(grid(i)%first:grid(i)%first + number(i) - 1)
         allocate (grid(i)%t(number(i)), grid(i)%largest(number(i)))
         call cut_steps(motion, case%solver, h_max(i), grid(i), number(i))
         call set_kinks(round_off*peak_acceleration(motion), grid(i))
         call count_equal_steps(grid(i))
         grid(i)%longest_step = maxval(grid(i)%step%h)
      end do
      !$omp end parallel do
   end subroutine build_grids

   !> Longest interval between knots of a motion of straight lines; 0 of pulses, whose intervals are
   !> cut anyway [s].
   pure real(wp) function longest_interval(motion) result(longest)
      type(motion_t), intent(in) :: motion
      integer :: i

      longest = 0
      if (.not. is_piecewise_linear(motion)) return
      do i = 1, interval_last(motion) - 1
         longest = max(longest, interval_end(motion, i) - interval_end(motion, i - 1))
      end do
   end function longest_interval

   !> The longest step of a grid that rows with different longest steps share: a part of the longest
   !> interval of the motion, or one of four in each octave [s].
   pure real(wp) function shared_step(longest, interval) result(h)
      real(wp), intent(in) :: longest
      !! that a row allows [s]
      real(wp), intent(in) :: interval
      !! from `longest_interval` [s]
      real(wp), parameter :: quarters(4) = [0.5_wp, 0.594603557501360533359_wp, &
         0.707106781186547524401_wp, 0.840896415253714543031_wp]
      !! powers of the fourth root of 2

      if (longest < interval) then
         h = interval/real(ceiling(interval/longest*(1 - 1.0e-9_wp), i8), wp)
      else
         h = quarters(count(quarters <= fraction(longest)))
         h = max(interval, set_exponent(h, exponent(longest)))
      end if
   end function shared_step

   !> Longest step in which a cubic represents the pulse of a case within its tolerance [s].
   pure real(wp) function pulse_step(case, motion) result(h)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp) :: share

      h = huge(h)
      if (.not. fastest_rate(motion) > 0) return
      ! The error of the cubic falls with the fourth power of the step.
      share = 0.01_wp*min(1.0_wp, (case%solver%rtol/1.0e-9_wp)**0.25_wp)
      h = share*2*pi/fastest_rate(motion)
   end function pulse_step

   !> Count the steps of a grid, and store them if it is allocated.
   !>
   !> Round-off may put an extremum at which a pulse ends before that end. There is no step between
   !> the two: over so short a time rates are round-off.
   pure subroutine cut_steps(motion, solver, h_max, grid, number)
      type(motion_t), intent(in) :: motion
      type(solver_t), intent(in) :: solver
      real(wp), intent(in) :: h_max
      type(time_grid_t), intent(inout) :: grid
      integer, intent(out) :: number
      !! beyond `max_grid_steps` some larger number
      real(wp) :: t
      real(wp) :: t_next
      real(wp) :: h
      integer :: interval
      integer :: parts
      integer :: i

      number = 0
      t = 0
      interval = interval_at(motion, t)
      do while (t < solver%t_end .and. number <= max_grid_steps)
         t_next = min(turning_point(motion, interval, t), solver%t_end)
         parts = ceiling(min((t_next - t)/h_max*(1 - 1.0e-9_wp), max_grid_steps + 1.0_wp))
         parts = max(1, parts)
         h = (t_next - t)/parts
         if (t_next - t < negligible_step*h_max) parts = 0
         if (interval >= interval_last(motion) .and. parts > max_tail_steps) then
            parts = max_tail_steps
            call repeat_tail(t_next - t, h_max, solver%max_steps - number, grid, h)
         end if
         if (associated(grid%step)) then
            do i = 1, parts
               call store_step(motion, interval, t + (i - 1)*h, h, number + i, grid)
            end do
         end if
         number = number + parts
         t = t_next
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
   end subroutine cut_steps

   !> Length of the steps of a long time after the motion, and how often all but the first of those
   !> that are stored are repeated.
   pure subroutine repeat_tail(span, h_max, most_steps, grid, h)
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(in) :: h_max
      !! [s]
      integer, intent(in) :: most_steps
      !! that are left to the case
      type(time_grid_t), intent(inout) :: grid
      real(wp), intent(out) :: h
      !! [s]
      real(wp) :: rounds
      !! of the repeated steps

      rounds = max(1.0_wp, aint(span/h_max/(max_tail_steps - 1)) + 1)
      h = span/(1 + rounds*(max_tail_steps - 1))
      grid%is_cut = 1 + rounds*(max_tail_steps - 1) > most_steps
      grid%repetitions = int(min(rounds, real(max(most_steps, 0), wp)/(max_tail_steps - 1)), i8) - 1
   end subroutine repeat_tail

   !> Store one step, with the cubic of the acceleration in it.
   pure subroutine store_step(motion, interval, t, h, number, grid)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: h
      !! [s]
      integer, intent(in) :: number
      type(time_grid_t), intent(inout) :: grid
      type(line_t) :: line
      real(wp) :: f(0:3)
      real(wp) :: second
      real(wp) :: third

      grid%t(number) = t
      associate (step => grid%step(number))
         step%h = h
         ! Equal steps of a record differ by round-off; each difference would cost new weights.
         if (number > 1) then
            if (abs(grid%step(number - 1)%h - h) < 1.0e-11_wp*h) step%h = grid%step(number - 1)%h
         end if
         f(0) = acceleration(motion, interval, t)
         f(3) = acceleration(motion, interval, t + h)
         step%f = [f(0), f(3) - f(0), 0.0_wp, 0.0_wp]
         line = line_of(motion, interval)
         if (line%is_straight) return
         f(1) = acceleration(motion, interval, t + c_2*h)
         f(2) = acceleration(motion, interval, t + c_3*h)
         second = ((f(2) - f(0))/c_3 - (f(1) - f(0))/c_2)/(c_3 - c_2)
         if (abs(second) > round_off*peak_acceleration(motion)) then
            third = ((f(3) - f(0) - (f(1) - f(0))/c_2)/(1 - c_2) - second)/(1 - c_3)
            step%f(1:) = [(f(1) - f(0))/c_2, second, third]
            grid%is_straight = .false.
         end if
      end associate
   end subroutine store_step

   !> Set the discontinuities of the acceleration and of its rate between the steps.
   pure subroutine set_kinks(negligible_jump, grid)
      real(wp), intent(in) :: negligible_jump
      !! jumps of the acceleration that are round-off [m/s2]
      type(time_grid_t), intent(inout) :: grid
      real(wp) :: f
      real(wp) :: rate
      integer :: i

      f = 0
      rate = 0
      do i = 1, size(grid%step)
         associate (step => grid%step(i))
            step%jump = step%f(0) - f
            if (abs(step%jump) <= negligible_jump) step%jump = 0
            if (i > 1 .and. abs(step%jump) > 0) grid%has_jumps = .true.
            step%kink = (step%f(1) - c_2*step%f(2) + c_2*c_3*step%f(3))/step%h - rate
            f = ground_at(step, 1.0_wp)
            grid%largest(i) = max(abs(step%f(0)), abs(f))
            rate = (step%f(1) + (2 - c_2)*step%f(2) &
               + ((1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2))*step%f(3))/step%h
         end associate
      end do
      grid%motion_end_step = findloc(grid%largest > 0, .true., dim=1, back=.true.) + 1
   end subroutine set_kinks

   !> Count the steps of the same length that follow each other.
   pure subroutine count_equal_steps(grid)
      type(time_grid_t), intent(inout) :: grid
      integer :: i

      do i = size(grid%step), 1, -1
         grid%step(i)%equal_steps = 1
         if (i == size(grid%step)) cycle
         if (abs(grid%step(i + 1)%h - grid%step(i)%h) > 0) cycle
         grid%step(i)%equal_steps = grid%step(i + 1)%equal_steps + 1
      end do
   end subroutine count_equal_steps

   !> Ground acceleration at the position x of a step [m/s2].
   pure real(wp) function ground_at(step, x)
      type(ground_step_t), intent(in) :: step
      real(wp), intent(in) :: x
      !! from 0 to 1 [-]

      ground_at = step%f(0) + x*(step%f(1) + (x - c_2)*(step%f(2) + (x - c_3)*step%f(3)))
   end function ground_at

end module rwmf_spectrum_fast_time_grid
