!> What all ordinates of a fast spectrum share: the ground motion in steps and the laws of motion.
module rwmf_spectrum_fast_shared_data
   use rwmf_problem_case, only: case_t
   use rwmf_core_control, only: control_t
   use rwmf_spectrum_fast_time_grid, only: fast_grid_t, loud_steps
   use rwmf_spectrum_fast_types, only: fast_law_t, scheme_t, step_t
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: fast_task_t, fast_scope_t, most_stages, kinds, kind_of, pair_of, describe_kinds, &
      list_loud_steps

   integer, parameter :: most_stages = 3
   !! evaluations of N in a step
   integer, parameter :: kinds = 2*most_stages
   !! of steps: so many evaluations of N, with polynomials of the full or the short degree

   !> One ordinate to be computed.
   type :: fast_task_t
      real(wp) :: T_s
      !! [s]
      integer :: law
      !! its number in the scope; a wider one once it has left the range of the first
      integer :: grid
      !! its number in the scope
      integer :: kind
      !! of its steps, from `kind_of`
   end type fast_task_t

   !> Numbers of steps.
   type :: loud_t
      integer, allocatable :: next(:)
      !! (steps + 1) from `loud_steps`
   end type loud_t

   type :: fast_scope_t
      type(control_t) :: control
      integer :: instructions
      !! from `best_level`
      type(scheme_t) :: scheme(kinds)
      real(wp) :: xi_s
      !! [-]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: pairs = 1
      !! of a mass ratio and a width
      type(case_t), allocatable :: scene(:)
      !! (pairs)
      type(fast_law_t), allocatable :: law(:)
      !! (pairs*ranges) of all pairs on the narrowest range of v, on the next one ...
      logical, allocatable :: is_fitted(:)
      !! (pairs*ranges) there is such a law
      logical, allocatable :: holds(:)
      !! (pairs*ranges) and it may be used
      type(fast_grid_t), allocatable :: grid(:)
      type(step_t), allocatable :: ground(:)
      !! steps of all grids, one after the other, to which the grids point
      type(loud_t), allocatable :: loud(:, :)
      !! (pairs, grids), where a task needs them
   end type fast_scope_t

contains

   !> Number of a kind of steps; those with more evaluations of N come first.
   pure integer function kind_of(stages, is_short)
      integer, intent(in) :: stages
      !! evaluations of N in a step
      logical, intent(in) :: is_short
      !! the polynomials have `short_degree`

      kind_of = 2*(most_stages - stages) + merge(2, 1, is_short)
   end function kind_of

   !> The pair of mass ratio and width that a law belongs to.
   pure integer function pair_of(scope, law)
      type(fast_scope_t), intent(in) :: scope
      integer, intent(in) :: law

      pair_of = mod(law - 1, scope%pairs) + 1
   end function pair_of

   !> What the steps of each kind are like.
   pure subroutine describe_kinds(scope)
      type(fast_scope_t), intent(inout) :: scope
      logical :: is_straight, has_jumps
      integer :: i

      is_straight = all(scope%grid%is_straight)
      has_jumps = any(scope%grid%has_jumps)
      do i = 1, most_stages
         scope%scheme(kind_of(i, .false.)) = scheme_t(i, .false., is_straight, has_jumps)
         scope%scheme(kind_of(i, .true.)) = scheme_t(i, .true., is_straight, has_jumps)
      end do
   end subroutine describe_kinds

   !> The steps that can lift a resting wall, for the pairs and grids of the tasks.
   subroutine list_loud_steps(task, threads, scope)
      type(fast_task_t), intent(in) :: task(:)
      integer, intent(in) :: threads
      type(fast_scope_t), intent(inout) :: scope
      integer :: law(scope%pairs, size(scope%grid))
      !! of one of the tasks; 0: there is none
      integer :: i, pair, grid

      law = 0
      do i = 1, size(task)
         law(pair_of(scope, task(i)%law), task(i)%grid) = task(i)%law
      end do
      allocate (scope%loud(scope%pairs, size(scope%grid)))
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) private(pair, grid) &
      !$omp if (count(law > 0) > 2)
      do i = 1, size(law)
         pair = pair_of(scope, i)
         grid = (i - 1)/scope%pairs + 1
         if (law(pair, grid) == 0) cycle
         scope%loud(pair, grid)%next = loud_steps(scope%grid(grid), &
            scope%law(law(pair, grid))%threshold)
      end do
      !$omp end parallel do
   end subroutine list_loud_steps

end module rwmf_spectrum_fast_shared_data
