!> The ground motion cut into the steps of the fast spectra, once for all ordinates.
!>
!> Steps end at every knot of the motion and at every extremum of a pulse, so that the acceleration
!> is monotone within a step. In a step it is the cubic through its values on Lobatto's nodes, which
!> is exact for a record.
module rwmf_spectrum_fast_time_grid
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_types, only: c_2, c_3, step_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: acceleration, fastest_rate, interval_at, interval_end, &
      line_of, line_t, motion_t, peak_acceleration, turning_point
   implicit none
   private

   public :: fast_grid_t, build_grids, ground_at, ground_end, loud_steps, pulse_step

   integer, parameter :: most_steps = 1000000
   !! of a grid: 64 MB
   real(wp), parameter :: round_off = 1.0e-11_wp
   !! of differences of accelerations over the largest one, with much to spare [-]

   real(wp), parameter :: vanishing = 1.0e-9_wp
   !! length of a step over the longest one that is left out: what happens in it is a jump [-]

   !> Steps from 0 to the end of the simulation.
   type :: fast_grid_t
      type(step_t), pointer, contiguous :: step(:) => null()
      !! (steps) in the array of all grids; null: there is no grid
      real(wp), allocatable :: t(:)
      !! (steps) beginnings [s]
      integer :: first = 1
      !! number of the first step in the array of all grids
      real(wp) :: longest = 0
      !! step [s]
      integer :: quiet = 1
      !! first step from which on the ground stands still
      logical :: is_straight = .true.
      !! the acceleration is linear in every step
      logical :: has_jumps = .false.
      !! the acceleration jumps later than at the beginning
   end type fast_grid_t

contains

   !> Cut [0, t_end] into steps, once for every longest step that is asked for.
   !>
   !> When that makes more steps than the case allows, or than memory should hold, there is no such
   !> grid. The steps of all grids follow each other in one array, which is large: it is written
   !> once and not copied.
   subroutine build_grids(case, motion, threads, h_max, ground, grid)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      real(wp), intent(in) :: h_max(:)
      !! (grids) [s]; 0: not asked for
      type(step_t), allocatable, target, intent(out) :: ground(:)
      type(fast_grid_t), intent(out) :: grid(:)
      !! (grids)
      integer :: number(size(h_max))
      integer :: i

      number = 0
      do i = 1, size(h_max)
         if (.not. h_max(i) > 0) cycle
         call walk(motion, case%solver%t_end, h_max(i), grid(i), number(i))
         if (number(i) > min(most_steps, case%solver%max_steps)) number(i) = 0
      end do
      allocate (ground(sum(number)))
      ! those with the shortest steps are last, and take longest
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) &
      !$omp if (count(number > 0) > 1)
      do i = size(h_max), 1, -1
         if (number(i) == 0) cycle
         grid(i)%first = sum(number(:i - 1)) + 1
         grid(i)%step => ground(grid(i)%first:grid(i)%first + number(i) - 1)
         allocate (grid(i)%t(number(i)))
         call walk(motion, case%solver%t_end, h_max(i), grid(i), number(i))
         call find_kinks(round_off*peak_acceleration(motion), grid(i))
         call count_alike(grid(i))
         grid(i)%longest = maxval(grid(i)%step%h)
      end do
      !$omp end parallel do
   end subroutine build_grids

   !> Longest step for which a cubic is as good as the pulse of a case [s].
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

   !> Count the steps, and store them once there is room for them.
   !>
   !> A pulse may end at an extremum, which round-off puts before the end. There is no step between
   !> the two: over so short a time rates are round-off.
   pure subroutine walk(motion, t_end, h_max, grid, number)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t_end
      real(wp), intent(in) :: h_max
      type(fast_grid_t), intent(inout) :: grid
      integer, intent(out) :: number
      real(wp) :: t
      real(wp) :: t_next
      real(wp) :: h
      integer :: interval
      integer :: parts
      integer :: i

      number = 0
      t = 0
      interval = interval_at(motion, t)
      do while (t < t_end)
         t_next = min(turning_point(motion, interval, t), t_end)
         parts = max(1, ceiling((t_next - t)/h_max*(1 - 1.0e-9_wp)))
         if (t_next - t < vanishing*h_max) parts = 0
         if (associated(grid%step)) then
            h = (t_next - t)/max(1, parts)
            do i = 1, parts
               call store(motion, interval, t + (i - 1)*h, h, number + i, grid)
            end do
         end if
         number = number + parts
         t = t_next
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
   end subroutine walk

   pure subroutine store(motion, interval, t, h, number, grid)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: h
      !! [s]
      integer, intent(in) :: number
      type(fast_grid_t), intent(inout) :: grid
      type(line_t) :: line
      real(wp) :: f(0:3)
      real(wp) :: second
      real(wp) :: third

      grid%t(number) = t
      associate (step => grid%step(number))
         step%h = h
         ! Equal steps of a record differ by round-off, which would only cost new weights.
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
   end subroutine store

   !> Discontinuities of the acceleration and of its rate between the steps.
   pure subroutine find_kinks(negligible, grid)
      real(wp), intent(in) :: negligible
      !! jumps of the acceleration that are none [m/s2]
      type(fast_grid_t), intent(inout) :: grid
      real(wp) :: f
      real(wp) :: rate
      integer :: i

      f = 0
      rate = 0
      do i = 1, size(grid%step)
         associate (step => grid%step(i))
            step%jump = step%f(0) - f
            if (abs(step%jump) <= negligible) step%jump = 0
            if (i > 1 .and. abs(step%jump) > 0) grid%has_jumps = .true.
            step%kink = (step%f(1) - c_2*step%f(2) + c_2*c_3*step%f(3))/step%h - rate
            f = ground_end(step)
            rate = (step%f(1) + (2 - c_2)*step%f(2) &
               + ((1 - c_2)*(1 - c_3) + (1 - c_3) + (1 - c_2))*step%f(3))/step%h
         end associate
      end do
   end subroutine find_kinks

   !> How many steps of the same length follow each other, and from which on nothing moves.
   pure subroutine count_alike(grid)
      type(fast_grid_t), intent(inout) :: grid
      integer :: i

      do i = size(grid%step), 1, -1
         grid%step(i)%alike = 1
         if (i == size(grid%step)) cycle
         if (abs(grid%step(i + 1)%h - grid%step(i)%h) > 0) cycle
         grid%step(i)%alike = grid%step(i + 1)%alike + 1
      end do
      do i = size(grid%step), 1, -1
         if (any(abs(grid%step(i)%f) > 0)) exit
      end do
      grid%quiet = i + 1
   end subroutine count_alike

   !> Ground acceleration at the position x of a step [m/s2].
   pure real(wp) function ground_at(step, x)
      type(step_t), intent(in) :: step
      real(wp), intent(in) :: x
      !! from 0 to 1 [-]

      ground_at = step%f(0) + x*(step%f(1) + (x - c_2)*(step%f(2) + (x - c_3)*step%f(3)))
   end function ground_at

   !> Ground acceleration at the end of a step [m/s2].
   pure real(wp) function ground_end(step)
      type(step_t), intent(in) :: step

      ground_end = ground_at(step, 1.0_wp)
   end function ground_end

   !> For each step the next one, itself included, that can lift a resting wall; the number of steps
   !> plus one for none.
   pure function loud_steps(grid, threshold) result(next)
      type(fast_grid_t), intent(in) :: grid
      real(wp), intent(in) :: threshold
      !! [m/s2]
      integer, allocatable :: next(:)
      !! (steps + 1)
      integer :: i

      allocate (next(size(grid%step) + 1))
      next(size(next)) = size(next)
      do i = size(grid%step), 1, -1
         next(i) = next(i + 1)
         if (max(abs(grid%step(i)%f(0)), abs(ground_end(grid%step(i)))) > threshold) next(i) = i
      end do
   end function loud_steps

end module rwmf_spectrum_fast_time_grid
