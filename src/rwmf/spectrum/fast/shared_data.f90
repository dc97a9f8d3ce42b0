!> Data shared by all ordinates of a fast spectrum: time grids and reduced equations.
module rwmf_spectrum_fast_shared_data
   use rwmf_core_control, only: control_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_time_grid, only: time_grid_t, uplift_steps
   use rwmf_spectrum_fast_types, only: ground_step_t, reduced_equation_t, scheme_t
   implicit none
   private

   public :: task_t, shared_data_t, max_stages, kinds, kind_of, pair_of, describe_kinds, &
      list_uplift_steps

   integer, parameter :: max_stages = 3
   !! largest number of evaluations of N in a step
   integer, parameter :: kinds = 2*max_stages
   !! kinds of steps: the number of evaluations of N, with polynomials of full or short degree

   !> One ordinate to be computed.
   type :: task_t
      real(wp) :: T_s
      !! [s]
      integer :: equation
      !! number of its reduced equation; that of a wider range once it has left the first one
      integer :: grid
      !! number of its time grid
      integer :: kind
      !! kind of its steps, from `kind_of`
   end type task_t

   !> List of steps that can lift a resting wall.
   type :: step_list_t
      integer, allocatable :: next(:)
      !! (steps + 1) from `uplift_steps`
   end type step_list_t

   !> Data shared by all threads.
   type :: shared_data_t
      type(control_t) :: control
      integer :: instructions
      !! instruction set, from `best_level`
      type(scheme_t) :: scheme(kinds)
      real(wp) :: xi_s
      !! damping ratio of the frame [-]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: pairs = 1
      !! number of pairs of a mass ratio and a width
      type(case_t), allocatable :: case(:)
      !! (pairs) the model of each pair
      type(reduced_equation_t), allocatable :: equation(:)
      !! (pairs*ranges) those of all pairs on the narrowest range of v, then on the next one ...
      logical, allocatable :: is_fitted(:)
      !! (pairs*ranges) the equation has been built
      logical, allocatable :: is_usable(:)
      !! (pairs*ranges) and it is accurate enough
      type(time_grid_t), allocatable :: grid(:)
      type(ground_step_t), allocatable :: ground(:)
      !! steps of all grids, one after the other, to which the grids point
      type(step_list_t), allocatable :: uplift(:, :)
      !! (pairs, grids), where a task needs them
   end type shared_data_t

contains

   !> Number of a kind of steps; those with more evaluations of N come first.
   pure integer function kind_of(stages, is_short)
      integer, intent(in) :: stages
      !! evaluations of N in a step
      logical, intent(in) :: is_short
      !! the polynomials have `short_degree`

      kind_of = 2*(max_stages - stages) + merge(2, 1, is_short)
   end function kind_of

   !> Number of the pair of mass ratio and width that an equation belongs to.
   pure integer function pair_of(shared, equation)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: equation

      pair_of = mod(equation - 1, shared%pairs) + 1
   end function pair_of

   !> Set the scheme of each kind of steps.
   pure subroutine describe_kinds(shared)
      type(shared_data_t), intent(inout) :: shared
      logical :: is_straight, has_jumps
      integer :: i

      is_straight = all(shared%grid%is_straight)
      has_jumps = any(shared%grid%has_jumps)
      do i = 1, max_stages
         shared%scheme(kind_of(i, .false.)) = scheme_t(i, .false., is_straight, has_jumps)
         shared%scheme(kind_of(i, .true.)) = scheme_t(i, .true., is_straight, has_jumps)
      end do
   end subroutine describe_kinds

   !> List the steps that can lift a resting wall, for the pairs and grids of the tasks.
   subroutine list_uplift_steps(task, threads, shared)
      type(task_t), intent(in) :: task(:)
      integer, intent(in) :: threads
      type(shared_data_t), intent(inout) :: shared
      integer :: equation(shared%pairs, size(shared%grid))
      !! equation of one of the tasks of a pair and grid; 0: there is none
      integer :: i, pair, grid

      equation = 0
      do i = 1, size(task)
         equation(pair_of(shared, task(i)%equation), task(i)%grid) = task(i)%equation
      end do
      allocate (shared%uplift(shared%pairs, size(shared%grid)))
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) private(pair, grid) &
      !$omp if (count(equation > 0) > 2)
      do i = 1, size(equation)
         pair = pair_of(shared, i)
         grid = (i - 1)/shared%pairs + 1
         if (equation(pair, grid) == 0) cycle
         shared%uplift(pair, grid)%next = uplift_steps(shared%grid(grid), &
            shared%equation(equation(pair, grid))%threshold)
      end do
      !$omp end parallel do
   end subroutine list_uplift_steps

end module rwmf_spectrum_fast_shared_data
