!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period and mass ratio only, so that the bits of its
!> result do not depend on the other ordinates. Ordinates outside the validated range of the method
!> are left to the general kernel.
module rwmf_spectrum_fast_driver
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_lane_scheduler, only: ordinate_result_t, run_scheduler
   use rwmf_spectrum_fast_polynomial_fit, only: fit_equations, ranges
   use rwmf_spectrum_fast_schedule, only: order_by_cost
   use rwmf_spectrum_fast_shared_data, only: describe_kinds, kind_of, list_uplift_steps, &
      max_stages, shared_data_t, task_t
   use rwmf_spectrum_fast_simd_dispatch, only: best_level
   use rwmf_spectrum_fast_task_queue, only: new_task_queue, task_queue_t
   use rwmf_spectrum_fast_time_grid, only: build_grids, pulse_step
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: min_gamma = 5
   !! mass ratio below which N is not small against the linear part [-]
   integer, parameter :: halvings = 5
   !! largest number of halvings of the longest step
   integer, parameter :: max_pairs = 32
   !! pairs in work at a time: each needs a number for every step of a grid
   real(wp), parameter :: gamma_one_stage = 220
   !! mass ratio from which on one evaluation of N in a step suffices at rtol = 1e-7, where the step
   !! is longest; the share of N is 1/gamma [-]
   real(wp), parameter :: gamma_two_stages(2) = [5.0_wp, 25.0_wp]
   !! mass ratio from which on two evaluations suffice; the second value is for the published
   !! levers, with which N is larger [-]

   !> An ordinate to be computed, and the step for it.
   type :: attempt_t
      integer :: i
      !! index of the period
      integer :: j
      !! index of the mass ratio
      integer :: k
      !! index of the width
      integer :: equation
      !! number of its reduced equation: that of the pair among those in work, on the narrowest
      !! range; that of a wider range after it has left it
      integer :: level
      !! halvings of the step
      integer :: stages
      !! evaluations of N in a step
      logical :: is_finer
      !! the step is halved once more because the estimated error was too large
   end type attempt_t

   !> Request for a spectrum.
   type :: spectrum_request_t
      type(case_t) :: case
      integer :: first = 1
      !! first of the pairs in work, the mass ratio running fastest
      integer :: last = 1
      !! last of the pairs in work
      type(control_t) :: control
      integer :: threads
      real(wp), allocatable :: T_s(:)
      !! (n_T) [s]
      real(wp), allocatable :: gamma(:)
      !! (n_gamma) [-]
      real(wp), allocatable :: b(:)
      !! (n_b) [m]
   end type spectrum_request_t

contains

   !> Compute the ordinates that the method covers; the others keep `is_done` false.
   subroutine run_fast(case, motion, threads, control, T_s, gamma, b, u_s_max, is_done)
      type(case_t), intent(in) :: case
      !! with wall and frame, supported by `rwmf_spectrum_fast_eligibility`
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      real(wp), intent(in) :: gamma(:)
      !! (n_gamma) [-]
      real(wp), intent(in) :: b(:)
      !! (n_b) [m]
      real(wp), intent(inout) :: u_s_max(:, :, :)
      !! (n_T, n_gamma, n_b) [m]
      logical, intent(out) :: is_done(:, :, :)
      !! (n_T, n_gamma, n_b)
      type(spectrum_request_t) :: request
      type(attempt_t), allocatable :: attempt(:)
      integer :: pair

      is_done = .false.
      request%case = case_of_pair(case, case%frame%gamma, case%wall%b)
      request%case%solver = case%solver
      request%control = control
      request%threads = threads
      request%T_s = T_s
      request%gamma = gamma
      request%b = b
      do pair = 1, size(gamma)*size(b), max_pairs
         request%first = pair
         request%last = min(pair + max_pairs - 1, size(gamma)*size(b))
         attempt = first_attempts(request, motion)
         do while (size(attempt) > 0)
            if (is_cancelled(control)) exit
            call run_attempts(request, motion, attempt, u_s_max, is_done)
         end do
      end do
   end subroutine run_fast

   !> First attempts: all periods of the pairs in work.
   pure function first_attempts(request, motion) result(attempt)
      type(spectrum_request_t), intent(in) :: request
      type(motion_t), intent(in) :: motion
      type(attempt_t), allocatable :: attempt(:)
      integer, allocatable :: level(:)
      integer, allocatable :: order(:)
      integer :: i, n, pair, j, k

      level = levels(request%case, motion, request%T_s)
      order = order_by_cost(request%T_s, level, halvings)
      allocate (attempt(size(order)*(request%last - request%first + 1)))
      n = 0
      do pair = request%first, request%last
         call split_pair(request, pair, j, k)
         if (request%gamma(j) < min_gamma) cycle
         do i = 1, size(order)
            n = n + 1
            attempt(n) = attempt_t(order(i), j, k, pair - request%first + 1, level(order(i)), &
               stages_for(request%case, request%gamma(j)), .false.)
         end do
      end do
      attempt = attempt(:n)
   end function first_attempts

   !> Indices of the mass ratio and the width of a pair.
   pure subroutine split_pair(request, pair, j, k)
      type(spectrum_request_t), intent(in) :: request
      integer, intent(in) :: pair
      integer, intent(out) :: j
      integer, intent(out) :: k

      j = mod(pair - 1, size(request%gamma)) + 1
      k = (pair - 1)/size(request%gamma) + 1
   end subroutine split_pair

   !> Evaluations of N in a step for a mass ratio.
   pure integer function stages_for(case, gamma)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: gamma
      !! [-]
      real(wp) :: gamma_limit(2)

      gamma_limit(1) = gamma_one_stage*sqrt(max(1.0_wp, 1.0e-7_wp/case%solver%rtol))
      gamma_limit(2) = merge(gamma_two_stages(2), gamma_two_stages(1), &
         case%model%formulation == 'published')
      stages_for = max_stages - count(gamma >= gamma_limit)
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

      fineness = min(2.0_wp, (case%solver%rtol/1.0e-8_wp)**(1.0_wp/3))
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

   !> Compute the ordinates; those whose estimated error is too large with all evaluations of N are
   !> attempted again on the halved step.
   subroutine run_attempts(request, motion, attempt, u_s_max, is_done)
      type(spectrum_request_t), intent(in) :: request
      type(motion_t), intent(in) :: motion
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      !! out: those to be attempted again
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      type(shared_data_t), target :: shared
      type(task_t), allocatable :: task(:)
      type(ordinate_result_t), allocatable :: result(:)
      type(task_queue_t) :: queue
      integer :: thread

      call prepare_attempts(request, motion, attempt, shared, task)
      allocate (result(size(task)))
      call new_task_queue(task, request%threads, queue)
      !$omp parallel do num_threads(request%threads) schedule(static, 1) default(shared)
      do thread = 1, request%threads
         call run_scheduler(shared, task, thread, queue, result)
      end do
      !$omp end parallel do
      call store_results(request, shared, task, result, attempt, u_s_max, is_done)
   end subroutine run_attempts

   !> Prepare equations and grids of the attempts; attempts without them are dropped.
   subroutine prepare_attempts(request, motion, attempt, shared, task)
      type(spectrum_request_t), intent(in) :: request
      type(motion_t), intent(in) :: motion
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      type(shared_data_t), target, intent(out) :: shared
      type(task_t), allocatable, intent(out) :: task(:)
      real(wp) :: h_max(halvings + 2)
      integer :: i

      shared%control = request%control
      shared%instructions = best_level()
      shared%xi_s = request%case%frame%xi_s
      shared%rtol = request%case%solver%rtol
      call prepare_equations(request, attempt, shared)
      allocate (shared%grid(halvings + 2))
      h_max = [(merge(longest_step(request%case, motion)/2.0_wp**i, 0.0_wp, &
         any(attempt%level == i)), i=0, halvings + 1)]
      call build_grids(request%case, motion, request%threads, h_max, shared%ground, shared%grid)
      attempt = pack(attempt, [(shared%is_usable(attempt(i)%equation) &
         .and. associated(shared%grid(attempt(i)%level + 1)%step), i=1, size(attempt))])
      call describe_kinds(shared)
      task = [(task_of(request%T_s(attempt(i)%i), attempt(i), shared), i=1, size(attempt))]
      call list_uplift_steps(task, request%threads, shared)
   end subroutine prepare_attempts

   !> Prepare the models of the pairs and the equations that the attempts begin with.
   subroutine prepare_equations(request, attempt, shared)
      type(spectrum_request_t), intent(in) :: request
      type(attempt_t), intent(in) :: attempt(:)
      type(shared_data_t), intent(inout) :: shared
      logical, allocatable :: wanted(:)
      integer :: i, j, k

      shared%pairs = request%last - request%first + 1
      allocate (shared%case(shared%pairs))
      do i = 1, shared%pairs
         call split_pair(request, request%first + i - 1, j, k)
         shared%case(i) = case_of_pair(request%case, request%gamma(j), request%b(k))
      end do
      allocate (wanted(shared%pairs*ranges))
      wanted = .false.
      wanted(attempt%equation) = .true.
      call fit_equations(request%threads, wanted, shared)
   end subroutine prepare_equations

   !> Task of an attempt.
   pure type(task_t) function task_of(T_s, attempt, shared) result(task)
      real(wp), intent(in) :: T_s
      !! [s]
      type(attempt_t), intent(in) :: attempt
      type(shared_data_t), intent(in) :: shared
      integer :: stages

      ! With one evaluation the slope of N would oscillate after a jump of the acceleration.
      stages = max(attempt%stages, merge(2, 1, shared%scheme(1)%has_jumps))
      task = task_t(T_s, attempt%equation, attempt%level + 1, &
         kind_of(stages, shared%equation(attempt%equation)%is_short))
   end function task_of

   !> Store the results; keep the attempts that are to be repeated on the halved step.
   subroutine store_results(request, shared, task, result, attempt, u_s_max, is_done)
      type(spectrum_request_t), intent(in) :: request
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      type(ordinate_result_t), intent(in) :: result(:)
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      logical, allocatable :: is_repeated(:)
      integer :: n

      allocate (is_repeated(size(attempt)))
      is_repeated = .false.
      do n = 1, size(attempt)
         associate (current => attempt(n), equation => shared%equation(task(n)%equation), &
            outcome => result(n))
            if (outcome%failed .or. .not. outcome%v_max <= equation%v_high) cycle
            if (outcome%error > request%case%solver%rtol) then
               is_repeated(n) = .not. current%is_finer
               current%is_finer = .true.
               current%equation = task(n)%equation
               current%level = current%level + 1
               current%stages = max_stages
            else
               u_s_max(current%i, current%j, current%k) = equation%length*outcome%v_max
               is_done(current%i, current%j, current%k) = .true.
            end if
         end associate
      end do
      attempt = pack(attempt, is_repeated)
   end subroutine store_results

   !> Model of one mass ratio and one width.
   pure function case_of_pair(case, gamma, b) result(pair_case)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: gamma
      !! [-]
      real(wp), intent(in) :: b
      !! [m]
      type(case_t) :: pair_case

      pair_case%wall = case%wall
      pair_case%frame = case%frame
      if (allocated(case%cable)) pair_case%cable = case%cable
      if (allocated(case%impact)) pair_case%impact = case%impact
      pair_case%model = case%model
      pair_case%wall%b = b
      pair_case%frame%gamma = gamma
   end function case_of_pair

end module rwmf_spectrum_fast_driver
