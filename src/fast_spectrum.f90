!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period, so that its result has the same bits in every
!> company. What the method has no proof for is left undone and to the general kernel.
module rwmf_fast_spectrum
   use rwmf_case, only: case_t
   use rwmf_control, only: control_t, is_cancelled
   use rwmf_fast_deck, only: deck_t, new_deck
   use rwmf_fast_grid, only: build_grids, pulse_step
   use rwmf_fast_lanes, only: fast_law_t
   use rwmf_fast_law, only: build_law
   use rwmf_fast_machine, only: best_level
   use rwmf_fast_order, only: order_by_cost
   use rwmf_fast_pool, only: fast_result_t, run_pool
   use rwmf_fast_scope, only: describe_kinds, fast_scope_t, fast_task_t, kind_of, &
      list_loud_steps, most_stages
   use rwmf_kinds, only: pi, wp
   use rwmf_motion, only: motion_t
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: least_gamma = 5
   !! mass ratio below which N is no small remainder [-]
   integer, parameter :: halvings = 5
   !! step sizes: the longest one halved up to so often
   integer, parameter :: most_laws = 32
   !! that are worked on at a time: each needs a number for every step
   real(wp), parameter :: fit_range(4) = [0.1_wp, 0.14_wp, 0.2_wp, 0.3_wp]
   !! of |u_s|/(2R) [-]
   real(wp), parameter :: enough_for_one = 220
   !! mass ratio from which on one evaluation of N in a step does at rtol = 1e-7, where the step is
   !! longest [-]: the share of N is 1/gamma
   real(wp), parameter :: enough_for_two(2) = [5.0_wp, 25.0_wp]
   !! two evaluations; the second where the levers are the published ones, which makes N larger [-]
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

   !> An ordinate that is not done yet, and how it is tried.
   type :: trial_t
      integer :: i
      !! indices of the period, the mass ratio, the width
      integer :: j
      integer :: k
      integer :: range
      !! of the fit
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
      !! with wall and frame, supported by `rwmf_fast_support`
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
      do pair = 1, size(gamma)*size(b), most_laws
         trial = first_trials(inquiry, motion, pair, min(pair + most_laws - 1, &
            size(gamma)*size(b)))
         do while (size(trial) > 0)
            if (is_cancelled(control)) exit
            call run_trials(inquiry, motion, trial, u_s_max, is_done)
         end do
      end do
   end subroutine run_fast

   !> All periods of some pairs of mass ratio and width.
   pure function first_trials(inquiry, motion, first, last) result(trial)
      type(inquiry_t), intent(in) :: inquiry
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: first
      !! number of the pair, the mass ratio running fastest
      integer, intent(in) :: last
      type(trial_t), allocatable :: trial(:)
      integer, allocatable :: level(:)
      integer, allocatable :: order(:)
      integer :: i, n, pair, j, k

      level = levels(inquiry%case, motion, inquiry%T_s)
      order = order_by_cost(inquiry%T_s, level, halvings)
      allocate (trial(size(order)*(last - first + 1)))
      n = 0
      do pair = first, last
         j = mod(pair - 1, size(inquiry%gamma)) + 1
         k = (pair - 1)/size(inquiry%gamma) + 1
         if (inquiry%gamma(j) < least_gamma) cycle
         do i = 1, size(order)
            n = n + 1
            trial(n) = trial_t(order(i), j, k, 1, level(order(i)), &
               stages_for(inquiry%case, inquiry%gamma(j)), .false.)
         end do
      end do
      trial = trial(:n)
   end function first_trials

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

   !> Try the ordinates; those that leave the fit are tried again on a wider one, those whose
   !> estimated error is too large with all evaluations of N on the halved step.
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
      integer, allocatable :: law_of(:)
      logical, allocatable :: is_usable(:)
      integer :: i

      scope%control = inquiry%control
      scope%instructions = best_level()
      scope%xi_s = inquiry%case%frame%xi_s
      scope%rtol = inquiry%case%solver%rtol
      call build_laws(inquiry, trial, scope%law, law_of)
      allocate (scope%grid(halvings + 2))
      h_max = [(merge(longest_step(inquiry%case, motion)/2.0_wp**i, 0.0_wp, &
         any(trial%level == i)), i=0, halvings + 1)]
      call build_grids(inquiry%case, motion, h_max, scope%ground, scope%grid)
      allocate (is_usable(size(trial)))
      do i = 1, size(trial)
         is_usable(i) = holds(inquiry%case, inquiry%b(trial(i)%k), scope%law(law_of(i))) &
            .and. associated(scope%grid(trial(i)%level + 1)%step)
      end do
      trial = pack(trial, is_usable)
      law_of = pack(law_of, is_usable)
      call describe_kinds(scope)
      task = [(task_of(inquiry%T_s(trial(i)%i), trial(i), law_of(i), scope), i=1, size(trial))]
      call list_loud_steps(task, scope)
   end subroutine prepare

   pure type(fast_task_t) function task_of(T_s, trial, law, scope) result(task)
      real(wp), intent(in) :: T_s
      !! [s]
      type(trial_t), intent(in) :: trial
      integer, intent(in) :: law
      type(fast_scope_t), intent(in) :: scope
      integer :: stages

      ! After a jump of the acceleration the slope of N would swing about its value for long.
      stages = max(trial%stages, merge(2, 1, scope%scheme(1)%has_jumps))
      task = fast_task_t(T_s, law, trial%level + 1, kind_of(stages, scope%law(law)%is_short))
   end function task_of

   !> The law of each trial; trials of the same pair and range follow each other.
   subroutine build_laws(inquiry, trial, law, law_of)
      type(inquiry_t), intent(in) :: inquiry
      type(trial_t), intent(in) :: trial(:)
      type(fast_law_t), allocatable, intent(out) :: law(:)
      integer, allocatable, intent(out) :: law_of(:)
      !! (trials) index of the law
      integer, allocatable :: first(:)
      !! (laws) trial that calls for it
      integer :: i

      allocate (law_of(size(trial)), first(0))
      do i = 1, size(trial)
         if (size(first) == 0) then
            first = [i]
         else if (.not. is_same_law(trial(first(size(first))), trial(i))) then
            first = [first, i]
         end if
         law_of(i) = size(first)
      end do
      allocate (law(size(first)))
      !$omp parallel do num_threads(inquiry%threads) schedule(dynamic) default(shared) &
      !$omp if (size(law) > 2)
      do i = 1, size(law)
         associate (one => trial(first(i)))
            call build_law(scene_of(inquiry%case, inquiry%gamma(one%j), inquiry%b(one%k)), &
               fit_range(one%range), fit_share*inquiry%case%solver%rtol, law(i))
         end associate
      end do
      !$omp end parallel do
   end subroutine build_laws

   pure logical function is_same_law(one, other)
      type(trial_t), intent(in) :: one
      type(trial_t), intent(in) :: other

      is_same_law = one%j == other%j .and. one%k == other%k .and. one%range == other%range
   end function is_same_law

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
            if (found%failed .or. .not. found%v_max <= law%v_high) then
               one%range = one%range + 1
               again(n) = one%range <= size(fit_range)
            else if (found%error > inquiry%case%solver%rtol) then
               again(n) = .not. one%is_finer
               one%is_finer = .true.
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

   !> Does the fit hold what the tolerance asks, and end before the wall overturns?
   pure logical function holds(case, b, law)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: b
      !! [m]
      type(fast_law_t), intent(in) :: law
      real(wp) :: alpha
      !! slenderness [rad]

      alpha = atan2(b, case%wall%h)
      holds = law%fit_error < fit_share*case%solver%rtol .and. law%e > 0 &
         .and. law%v_high < sin(min(case%model%overturning_angle, 1.0_wp)/2)*cos(alpha)
   end function holds

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

end module rwmf_fast_spectrum
