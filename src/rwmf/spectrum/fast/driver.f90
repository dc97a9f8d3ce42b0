!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period and mass ratio only, so that the bits of its
!> result do not depend on the other ordinates. Ordinates outside the validated range of the method
!> are left to the general lanes.
module rwmf_spectrum_fast_driver
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_scene_axes, only: set_axes
   use rwmf_spectrum_fast_reduced_equation, only: build_reduced_equation
   use rwmf_spectrum_fast_schedule, only: order_by_cost
   use rwmf_spectrum_fast_shared_data, only: max_stages, shared_data_t, task_t
   use rwmf_spectrum_fast_simd_dispatch, only: best_level, kernels_of
   use rwmf_spectrum_fast_team, only: ordinate_result_t, run_team
   use rwmf_spectrum_fast_time_grid, only: build_grids, pulse_step
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: min_gamma = 0.5_wp
   !! mass ratio below which N is not small against the linear part [-]
   integer, parameter :: halvings = 5
   !! largest number of halvings of the longest step
   real(wp), parameter :: gamma_one_stage = 220
   !! mass ratio from which on one evaluation of N in a step suffices at rtol = 1e-7, where the step
   !! is longest; the share of N is 1/gamma [-]
   real(wp), parameter :: gamma_two_stages(2) = [5.0_wp, 25.0_wp]
   !! mass ratio from which on two evaluations suffice; the second value is for the published
   !! levers, with which N is larger [-]
   real(wp), parameter :: fit_range(4) = [0.1_wp, 0.14_wp, 0.2_wp, 0.3_wp]
   !! ends of the ranges of v on which equations are fitted: a narrow one, and wider ones for
   !! ordinates that leave it [-]
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

   !> An ordinate to be computed, and the step for it.
   type :: attempt_t
      integer :: i
      !! index of the period
      integer :: pair
      !! of mass ratio and width, the mass ratio running fastest
      integer :: range = 1
      !! of v
      integer :: level
      !! halvings of the step
      integer :: stages
      !! evaluations of N in a step
      logical :: is_finer = .false.
      !! the step is halved once more because the estimated error was too large
   end type attempt_t

contains

   !> Compute the ordinates that the method covers; the others keep `is_done` false.
   subroutine run_fast(case, motion, threads, control, T_s, gamma, b, u_s_max, is_done)
      type(case_t), intent(in) :: case
      !! with wall and frame, supported by `rwmf_spectrum_fast_eligibility`
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      real(wp), intent(in) :: gamma(:)
      !! (n_gamma) [-]
      real(wp), intent(in) :: b(:)
      !! (n_b) [m]
      real(wp), intent(inout) :: u_s_max(size(T_s), size(gamma)*size(b))
      !! (n_T, n_gamma n_b) [m]
      logical, intent(out) :: is_done(size(T_s), size(gamma)*size(b))
      !! (n_T, n_gamma n_b) the ordinate has its u_s_max
      type(shared_data_t), target :: shared
      type(case_t), allocatable :: pair_case(:)
      logical, allocatable :: is_fitted(:, :)
      type(attempt_t), allocatable :: attempt(:)
      integer :: pair

      is_done = .false.
      allocate (pair_case(size(gamma)*size(b)))
      do pair = 1, size(pair_case)
         pair_case(pair)%structure_t = case%structure_t
         ! any period: the equations do not depend on it
         call set_axes(pair_case(pair), T_s=1.0_wp, gamma=gamma(mod(pair - 1, size(gamma)) + 1), &
            b=b((pair - 1)/size(gamma) + 1))
      end do
      shared%control = control
      shared%kernels = kernels_of(best_level())
      shared%xi_s = case%frame%xi_s
      shared%rtol = case%solver%rtol
      allocate (is_fitted(size(pair_case), size(fit_range)))
      allocate (shared%equation(size(is_fitted)), shared%grid(halvings + 2))
      is_fitted = .false.
      attempt = first_attempts(case, motion, T_s, gamma, size(b))
      do while (size(attempt) > 0)
         call fit_equations(pair_case, motion, threads, attempt, is_fitted, shared)
         call cut_motion(case, motion, threads, attempt, shared)
         call run_attempts(threads, T_s, shared, attempt, u_s_max, is_done)
         if (is_cancelled(control)) exit
      end do
   end subroutine run_fast

   !> First attempts: all periods of all pairs.
   pure function first_attempts(case, motion, T_s, gamma, n_b) result(attempt)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: gamma(:)
      integer, intent(in) :: n_b
      !! number of widths
      type(attempt_t), allocatable :: attempt(:)
      integer :: level(size(T_s))
      integer, allocatable :: order(:)
      integer :: i, n, pair

      level = levels(case, motion, T_s)
      order = order_by_cost(T_s, level, halvings)
      allocate (attempt(size(order)*size(gamma)*n_b))
      n = 0
      do pair = 1, size(gamma)*n_b
         associate (gamma_of_pair => gamma(mod(pair - 1, size(gamma)) + 1))
            if (gamma_of_pair < min_gamma) cycle
            do i = 1, size(order)
               n = n + 1
               attempt(n) = attempt_t(i=order(i), pair=pair, level=level(order(i)), &
                  stages=stages_for(case, gamma_of_pair))
            end do
         end associate
      end do
      attempt = attempt(:n)
   end function first_attempts

   !> Evaluations of N in a step for a mass ratio. The largest motion from a given state may be over
   !> within two steps, too soon for the estimate of its error: nothing is saved there.
   pure integer function stages_for(case, gamma)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: gamma
      !! [-]
      real(wp) :: gamma_limit(2)

      gamma_limit(1) = gamma_one_stage*sqrt(max(1.0_wp, 1.0e-7_wp/case%solver%rtol))
      gamma_limit(2) = merge(gamma_two_stages(2), gamma_two_stages(1), &
         case%model%formulation == 'published')
      stages_for = max_stages
      if (.not. allocated(case%initial)) stages_for = stages_for - count(gamma >= gamma_limit)
   end function stages_for

   !> Longest step: a fraction of the wall's time scale sqrt(h/g), or that of the pulse [s].
   pure real(wp) function longest_step(case, motion) result(h)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion

      h = min(fineness(case)*0.024_wp*sqrt(case%wall%h/case%model%g), pulse_step(case, motion))
   end function longest_step

   !> Factor of the step for the tolerance: the scheme converges with the third power of the step.
   pure real(wp) function fineness(case)
      type(case_t), intent(in) :: case

      fineness = min(merge(1.0_wp, 2.0_wp, allocated(case%initial)), &
         (case%solver%rtol/1.0e-8_wp)**(1.0_wp/3))
   end function fineness

   !> Halvings of the step for each period; `halvings` + 1 where no step is short enough.
   pure function levels(case, motion, T_s)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      integer :: levels(size(T_s))
      real(wp) :: angle
      !! omega_s h allowed [rad]

      angle = 0.69_wp*fineness(case)
      levels = max(0, ceiling(log(2*pi*longest_step(case, motion)/(T_s*angle))/log(2.0_wp)))
      levels = min(levels, halvings + 1)
   end function levels

   !> Fit the equations of the attempts that are not yet known; attempts that have none which is
   !> accurate enough are dropped.
   subroutine fit_equations(pair_case, motion, threads, attempt, is_fitted, shared)
      type(case_t), intent(in) :: pair_case(:)
      !! (pairs)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      logical, intent(inout) :: is_fitted(:, :)
      !! (pairs, ranges)
      type(shared_data_t), intent(inout) :: shared
      logical, allocatable :: is_wanted(:)
      integer, allocatable :: number(:)
      integer :: i

      number = equation_of(attempt, size(pair_case))
      allocate (is_wanted(size(is_fitted)), source=.false.)
      is_wanted(number) = .true.
      is_wanted = is_wanted .and. .not. reshape(is_fitted, [size(is_fitted)])
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) &
      !$omp if (count(is_wanted) > 2)
      do i = 1, size(is_wanted)
         if (is_wanted(i)) call build_reduced_equation(pair_case(mod(i - 1, size(pair_case)) + 1), &
            motion, fit_range((i - 1)/size(pair_case) + 1), fit_share*shared%rtol, &
            shared%equation(i))
      end do
      !$omp end parallel do
      is_fitted = is_fitted .or. reshape(is_wanted, shape(is_fitted))
      attempt = pack(attempt, shared%equation(number)%fit_error < fit_share*shared%rtol)
   end subroutine fit_equations

   !> Number of the equation of an attempt.
   pure elemental integer function equation_of(attempt, pairs)
      type(attempt_t), intent(in) :: attempt
      integer, intent(in) :: pairs

      equation_of = attempt%pair + (attempt%range - 1)*pairs
   end function equation_of

   !> Cut the motion into the steps that the attempts ask for; attempts that would need too many are
   !> dropped.
   subroutine cut_motion(case, motion, threads, attempt, shared)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      type(shared_data_t), target, intent(inout) :: shared
      real(wp) :: h_max(size(shared%grid))
      integer :: i

      h_max = [(merge(longest_step(case, motion)/2.0_wp**(i - 1), 0.0_wp, &
         any(attempt%level + 1 == i)), i=1, size(h_max))]
      call build_grids(case, motion, threads, h_max, shared%ground, shared%grid)
      attempt = pack(attempt, [(associated(shared%grid(attempt(i)%level + 1)%step), &
         i=1, size(attempt))])
   end subroutine cut_motion

   !> Compute the ordinates; those that are to be computed again remain: on a wider range once v has
   !> left that of the equation, with all evaluations of N, then on the halved step where the
   !> estimated error is too large.
   subroutine run_attempts(threads, T_s, shared, attempt, u_s_max, is_done)
      integer, intent(in) :: threads
      real(wp), intent(in) :: T_s(:)
      type(shared_data_t), intent(in) :: shared
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      real(wp), intent(inout) :: u_s_max(:, :)
      logical, intent(inout) :: is_done(:, :)
      type(task_t), allocatable :: task(:)
      type(ordinate_result_t), allocatable :: found(:)
      logical, allocatable :: is_repeated(:)
      integer, allocatable :: kind(:), order(:)
      integer :: thread, next, i, k, pairs

      pairs = size(is_done, 2)
      ! With one evaluation the slope of N would oscillate after a jump of the acceleration.
      where (shared%grid(attempt%level + 1)%has_jumps) attempt%stages = max(2, attempt%stages)
      kind = 2*attempt%stages + merge(0, 1, shared%equation(equation_of(attempt, pairs))%is_short)
      allocate (order(0))
      do i = 2*max_stages + 1, 2, -1
         order = [order, pack([(k, k=1, size(attempt))], kind == i)]
      end do
      attempt = attempt(order)
      task = [(task_t(T_s(attempt(i)%i), equation_of(attempt(i), pairs), attempt(i)%level + 1, &
         attempt(i)%stages), i=1, size(attempt))]
      allocate (found(size(task)))
      next = 0
      !$omp parallel do num_threads(threads) schedule(static, 1) default(shared)
      do thread = 1, threads
         call run_team(shared, task, next, found)
      end do
      !$omp end parallel do
      allocate (is_repeated(size(attempt)), source=.false.)
      do i = 1, size(attempt)
         associate (current => attempt(i))
            if (found(i)%failed) then
               is_repeated(i) = current%range < size(fit_range) &
                  .and. shared%equation(task(i)%equation)%v_high >= fit_range(current%range)
               current%range = current%range + 1
            else if (found(i)%error > shared%rtol .and. current%stages < max_stages) then
               current%stages = max_stages
               is_repeated(i) = .true.
            else if (found(i)%error > shared%rtol) then
               is_repeated(i) = .not. current%is_finer
               current%is_finer = .true.
               current%level = current%level + 1
            else
               u_s_max(current%i, current%pair) = &
                  shared%equation(task(i)%equation)%length*found(i)%v_max
               is_done(current%i, current%pair) = .true.
            end if
         end associate
      end do
      attempt = pack(attempt, is_repeated)
   end subroutine run_attempts

end module rwmf_spectrum_fast_driver
