!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period, so that its result has the same bits in every
!> company. What the method has no proof for is left undone and to the general kernel.
module rwmf_spectrum_fast_driver
   use rwmf_problem_case, only: case_t
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_spectrum_fast_task_queue, only: deck_t, new_deck
   use rwmf_spectrum_fast_time_grid, only: build_grids, pulse_step
   use rwmf_spectrum_fast_polynomial_fit, only: fit_laws, ranges
   use rwmf_spectrum_fast_simd_dispatch, only: best_level
   use rwmf_spectrum_fast_schedule, only: order_by_cost
   use rwmf_spectrum_fast_lane_scheduler, only: fast_result_t, run_pool
   use rwmf_spectrum_fast_shared_data, only: describe_kinds, fast_scope_t, fast_task_t, kind_of, &
      list_loud_steps, most_stages
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: motion_t
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: least_gamma = 5
   !! mass ratio below which N is no small remainder [-]
   integer, parameter :: halvings = 5
   !! step sizes: the longest one halved up to so often
   integer, parameter :: most_pairs = 32
   !! that are worked on at a time: each needs a number for every step
   real(wp), parameter :: enough_for_one = 220
   !! mass ratio from which on one evaluation of N in a step does at rtol = 1e-7, where the step is
   !! longest [-]: the share of N is 1/gamma
   real(wp), parameter :: enough_for_two(2) = [5.0_wp, 25.0_wp]
   !! two evaluations; the second where the levers are the published ones, which makes N larger [-]
   !> An ordinate that is not done yet, and how it is tried.
   type :: trial_t
      integer :: i
      !! indices of the period, the mass ratio, the width
      integer :: j
      integer :: k
      integer :: law
      !! its number in the scope: that of the pair among those that are worked on, on the narrowest
      !! range; a higher one after it has left that
      integer :: level
      !! halvings of the step
      integer :: stages
      !! evaluations of N in a step
      logical :: is_finer
      !! the step is halved once more because the estimated error was too large
   end type trial_t

   !> What is given.
   type :: inquiry_t
      type(case_t) :: case
      integer :: first = 1
      !! the first one of the pairs that are worked on, the mass ratio running fastest
      integer :: last = 1
      !! the last one
      type(control_t) :: control
      integer :: threads
      real(wp), allocatable :: T_s(:)
      !! (n_T) [s]
      real(wp), allocatable :: gamma(:)
      !! (n_gamma) [-]
      real(wp), allocatable :: b(:)
      !! (n_b) [m]
   end type inquiry_t

contains

   !> Compute what the fast method can; `is_done` tells the rest from it.
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
      type(inquiry_t) :: inquiry
      type(trial_t), allocatable :: trial(:)
      integer :: pair

      is_done = .false.
      inquiry%case = scene_of(case, case%frame%gamma, case%wall%b)
      inquiry%case%solver = case%solver
      inquiry%control = control
      inquiry%threads = threads
      inquiry%T_s = T_s
      inquiry%gamma = gamma
      inquiry%b = b
      do pair = 1, size(gamma)*size(b), most_pairs
         inquiry%first = pair
         inquiry%last = min(pair + most_pairs - 1, size(gamma)*size(b))
         trial = first_trials(inquiry, motion)
         do while (size(trial) > 0)
            if (is_cancelled(control)) exit
            call run_trials(inquiry, motion, trial, u_s_max, is_done)
         end do
      end do
   end subroutine run_fast

   !> All periods of some pairs of mass ratio and width.
   pure function first_trials(inquiry, motion) result(trial)
      type(inquiry_t), intent(in) :: inquiry
      type(motion_t), intent(in) :: motion
      type(trial_t), allocatable :: trial(:)
      integer, allocatable :: level(:)
      integer, allocatable :: order(:)
      integer :: i, n, pair, j, k

      level = levels(inquiry%case, motion, inquiry%T_s)
      order = order_by_cost(inquiry%T_s, level, halvings)
      allocate (trial(size(order)*(inquiry%last - inquiry%first + 1)))
      n = 0
      do pair = inquiry%first, inquiry%last
         call split_pair(inquiry, pair, j, k)
         if (inquiry%gamma(j) < least_gamma) cycle
         do i = 1, size(order)
            n = n + 1
            trial(n) = trial_t(order(i), j, k, pair - inquiry%first + 1, level(order(i)), &
               stages_for(inquiry%case, inquiry%gamma(j)), .false.)
         end do
      end do
      trial = trial(:n)
   end function first_trials

   !> Indices of the mass ratio and the width of a pair.
   pure subroutine split_pair(inquiry, pair, j, k)
      type(inquiry_t), intent(in) :: inquiry
      integer, intent(in) :: pair
      integer, intent(out) :: j
      integer, intent(out) :: k

      j = mod(pair - 1, size(inquiry%gamma)) + 1
      k = (pair - 1)/size(inquiry%gamma) + 1
   end subroutine split_pair

   !> Evaluations of N that a mass ratio calls for.
   pure integer function stages_for(case, gamma)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: gamma
      !! [-]
      real(wp) :: enough(2)

      enough(1) = enough_for_one*sqrt(max(1.0_wp, 1.0e-7_wp/case%solver%rtol))
      enough(2) = merge(enough_for_two(2), enough_for_two(1), &
         case%model%formulation == 'published')
      stages_for = most_stages - count(gamma >= enough)
   end function stages_for

   !> Longest step [s]: a fraction of the wall's own time.
   pure real(wp) function longest_step(case, motion) result(h)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion

      h = min(fineness(case)*0.024_wp*sqrt(case%wall%h/case%model%g), pulse_step(case, motion))
   end function longest_step

   !> What the tolerance makes of the step: the scheme converges with its third power.
   pure real(wp) function fineness(case)
      type(case_t), intent(in) :: case

      fineness = min(2.0_wp, (case%solver%rtol/1.0e-8_wp)**(1.0_wp/3))
   end function fineness

   !> Halvings that a period calls for; one more than there are: no step is short enough.
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

   !> Try the ordinates; those whose estimated error is too large with all evaluations of N are
   !> tried again on the halved step.
   subroutine run_trials(inquiry, motion, trial, u_s_max, is_done)
      type(inquiry_t), intent(in) :: inquiry
      type(motion_t), intent(in) :: motion
      type(trial_t), allocatable, intent(inout) :: trial(:)
      !! out: what is to be tried again
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      type(fast_scope_t), target :: scope
      type(fast_task_t), allocatable :: task(:)
      type(fast_result_t), allocatable :: result(:)
      type(deck_t) :: deck
      integer :: thread

      call prepare(inquiry, motion, trial, scope, task)
      allocate (result(size(task)))
      call new_deck(task, inquiry%threads, deck)
      !$omp parallel do num_threads(inquiry%threads) schedule(static, 1) default(shared)
      do thread = 1, inquiry%threads
         call run_pool(scope, task, thread, deck, result)
      end do
      !$omp end parallel do
      call conclude(inquiry, scope, task, result, trial, u_s_max, is_done)
   end subroutine run_trials

   !> Laws and grids of the trials; those for which there are none are dropped.
   subroutine prepare(inquiry, motion, trial, scope, task)
      type(inquiry_t), intent(in) :: inquiry
      type(motion_t), intent(in) :: motion
      type(trial_t), allocatable, intent(inout) :: trial(:)
      type(fast_scope_t), target, intent(out) :: scope
      type(fast_task_t), allocatable, intent(out) :: task(:)
      real(wp) :: h_max(halvings + 2)
      integer :: i

      scope%control = inquiry%control
      scope%instructions = best_level()
      scope%xi_s = inquiry%case%frame%xi_s
      scope%rtol = inquiry%case%solver%rtol
      call prepare_laws(inquiry, trial, scope)
      allocate (scope%grid(halvings + 2))
      h_max = [(merge(longest_step(inquiry%case, motion)/2.0_wp**i, 0.0_wp, &
         any(trial%level == i)), i=0, halvings + 1)]
      call build_grids(inquiry%case, motion, inquiry%threads, h_max, scope%ground, scope%grid)
      trial = pack(trial, [(scope%holds(trial(i)%law) &
         .and. associated(scope%grid(trial(i)%level + 1)%step), i=1, size(trial))])
      call describe_kinds(scope)
      task = [(task_of(inquiry%T_s(trial(i)%i), trial(i), scope), i=1, size(trial))]
      call list_loud_steps(task, inquiry%threads, scope)
   end subroutine prepare

   !> The scenes of the pairs, and the laws that the trials begin with.
   subroutine prepare_laws(inquiry, trial, scope)
      type(inquiry_t), intent(in) :: inquiry
      type(trial_t), intent(in) :: trial(:)
      type(fast_scope_t), intent(inout) :: scope
      logical, allocatable :: wanted(:)
      integer :: i, j, k

      scope%pairs = inquiry%last - inquiry%first + 1
      allocate (scope%scene(scope%pairs))
      do i = 1, scope%pairs
         call split_pair(inquiry, inquiry%first + i - 1, j, k)
         scope%scene(i) = scene_of(inquiry%case, inquiry%gamma(j), inquiry%b(k))
      end do
      allocate (wanted(scope%pairs*ranges))
      wanted = .false.
      wanted(trial%law) = .true.
      call fit_laws(inquiry%threads, wanted, scope)
   end subroutine prepare_laws

   pure type(fast_task_t) function task_of(T_s, trial, scope) result(task)
      real(wp), intent(in) :: T_s
      !! [s]
      type(trial_t), intent(in) :: trial
      type(fast_scope_t), intent(in) :: scope
      integer :: stages

      ! After a jump of the acceleration the slope of N would swing about its value for long.
      stages = max(trial%stages, merge(2, 1, scope%scheme(1)%has_jumps))
      task = fast_task_t(T_s, trial%law, trial%level + 1, &
         kind_of(stages, scope%law(trial%law)%is_short))
   end function task_of

   !> Enter what is done; list what is to be tried again.
   subroutine conclude(inquiry, scope, task, result, trial, u_s_max, is_done)
      type(inquiry_t), intent(in) :: inquiry
      type(fast_scope_t), intent(in) :: scope
      type(fast_task_t), intent(in) :: task(:)
      type(fast_result_t), intent(in) :: result(:)
      type(trial_t), allocatable, intent(inout) :: trial(:)
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      logical, allocatable :: again(:)
      integer :: n

      allocate (again(size(trial)))
      again = .false.
      do n = 1, size(trial)
         associate (one => trial(n), law => scope%law(task(n)%law), found => result(n))
            if (found%failed .or. .not. found%v_max <= law%v_high) cycle
            if (found%error > inquiry%case%solver%rtol) then
               again(n) = .not. one%is_finer
               one%is_finer = .true.
               one%law = task(n)%law
               one%level = one%level + 1
               one%stages = most_stages
            else
               u_s_max(one%i, one%j, one%k) = law%length*found%v_max
               is_done(one%i, one%j, one%k) = .true.
            end if
         end associate
      end do
      trial = pack(trial, again)
   end subroutine conclude

   !> The scene of one mass ratio and one width.
   pure function scene_of(case, gamma, b) result(scene)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: gamma
      !! [-]
      real(wp), intent(in) :: b
      !! [m]
      type(case_t) :: scene

      scene%wall = case%wall
      scene%frame = case%frame
      if (allocated(case%cable)) scene%cable = case%cable
      if (allocated(case%impact)) scene%impact = case%impact
      scene%model = case%model
      scene%wall%b = b
      scene%frame%gamma = gamma
   end function scene_of

end module rwmf_spectrum_fast_driver
