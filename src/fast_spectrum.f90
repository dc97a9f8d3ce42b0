!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period, so that its result has the same bits in every
!> company. What the method has no proof for is left undone and to the general kernel.
module rwmf_fast_spectrum
   use rwmf_case, only: case_t
   use rwmf_control, only: control_t, count_done, is_cancelled
   use rwmf_fast_block, only: run_block
   use rwmf_fast_grid, only: build_grid, fast_grid_t, loud_steps, pulse_step
   use rwmf_fast_lanes, only: fast_law_t, lanes
   use rwmf_fast_law, only: build_law
   use rwmf_fast_machine, only: best_level
   use rwmf_fast_order, only: group_t, list_groups
   use rwmf_kinds, only: pi, wp
   use rwmf_motion, only: motion_t
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: least_gamma = 5
   !! mass ratio below which N is no small remainder [-]
   integer, parameter :: halvings = 5
   !! step sizes: the longest one halved up to so often
   real(wp), parameter :: fit_range(4) = [0.1_wp, 0.14_wp, 0.2_wp, 0.3_wp]
   !! of |u_s|/(2R) [-]
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

   !> What all tasks share.
   type :: scope_t
      type(case_t) :: case
      type(control_t) :: control
      integer :: instructions
      !! from `best_level`
      real(wp), allocatable :: T_s(:)
      !! (n_T) [s]
      real(wp), allocatable :: gamma(:)
      !! (n_gamma) [-]
      real(wp), allocatable :: b(:)
      !! (n_b) [m]
      type(fast_grid_t) :: grid(0:halvings + 1)
      !! by halvings of the step
      type(fast_law_t), allocatable :: law(:, :)
      !! (n_gamma, n_b) on the narrowest range
   end type scope_t

   !> A group of periods for one mass ratio and one width.
   type :: task_t
      integer :: j
      !! index of the mass ratio
      integer :: k
      !! index of the width
      type(group_t) :: group
   end type task_t

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
      type(scope_t) :: scope
      type(task_t), allocatable :: task(:)
      integer :: i

      is_done = .false.
      call prepare(case, motion, threads, T_s, gamma, b, scope)
      scope%control = control
      task = list_tasks(case, motion, T_s, gamma, b)
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared)
      do i = 1, size(task)
         if (.not. is_cancelled(control)) then
            call run_group(scope, 1, 0, task(i), task(i)%group%member(:task(i)%group%n), u_s_max, &
               is_done)
         end if
      end do
      !$omp end parallel do
   end subroutine run_fast

   !> Everything that is computed once: grids of steps, laws.
   subroutine prepare(case, motion, threads, T_s, gamma, b, scope)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: b(:)
      type(scope_t), intent(out) :: scope
      integer :: i

      scope%case = scene_of(case, case%frame%gamma, case%wall%b)
      scope%case%solver = case%solver
      scope%instructions = best_level()
      scope%T_s = T_s
      scope%gamma = gamma
      scope%b = b
      allocate (scope%law(size(gamma), size(b)))
      do i = 0, halvings + 1
         if (any(levels(case, motion, T_s) == i) .or. any(levels(case, motion, T_s) + 1 == i)) then
            call build_grid(case, motion, case%solver%t_end, longest_step(case, motion)/2.0_wp**i, &
               scope%grid(i))
         end if
      end do
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared) if (size(b) > 8)
      do i = 1, size(scope%law)
         associate (j => mod(i - 1, size(gamma)) + 1, k => (i - 1)/size(gamma) + 1)
            call build_law(scene_of(case, gamma(j), b(k)), fit_range(1), scope%law(j, k))
         end associate
      end do
      !$omp end parallel do
   end subroutine prepare

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

   !> The groups of periods for every mass ratio and width.
   pure function list_tasks(case, motion, T_s, gamma, b) result(task)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: b(:)
      type(task_t), allocatable :: task(:)
      type(group_t), allocatable :: group(:)
      integer :: i, j, k

      group = list_groups(T_s, levels(case, motion, T_s), halvings)
      allocate (task(0))
      do i = 1, size(group)
         do k = 1, size(b)
            do j = 1, size(gamma)
               if (gamma(j) >= least_gamma) task = [task, task_t(j, k, group(i))]
            end do
         end do
      end do
   end function list_tasks

   !> Halvings that a period calls for; one more than there are: no step is short enough.
   pure function levels(case, motion, T_s)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      integer :: levels(size(T_s))
      real(wp) :: angle
      !! omega_s h allowed [rad]

      angle = 0.5_wp*fineness(case)
      levels = max(0, ceiling(log(2*pi*longest_step(case, motion)/(T_s*angle))/log(2.0_wp)))
      levels = min(levels, halvings + 1)
   end function levels

   !> Ordinates of one task; those that leave the fit are repeated on a wider one, those whose
   !> estimated error is too large once on the halved step. What is not done then is left to the
   !> general kernel.
   recursive subroutine run_group(scope, range, halving, task, member, u_s_max, is_done)
      type(scope_t), intent(in) :: scope
      integer, intent(in) :: range
      !! of the fit
      integer, intent(in) :: halving
      !! of the task's step
      type(task_t), intent(in) :: task
      integer, intent(in) :: member(:)
      !! (n) indices of the periods
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      type(fast_law_t) :: law
      real(wp) :: v_max(size(member))
      real(wp) :: error(size(member))
      logical :: failed(size(member))
      logical :: is_wide(size(member))
      logical :: is_poor(size(member))
      integer :: i

      if (size(member) == 0 .or. range > size(fit_range) .or. halving > 1) return
      if (range == 1) then
         law = scope%law(task%j, task%k)
      else
         call build_law(scene_of(scope%case, scope%gamma(task%j), scope%b(task%k)), &
            fit_range(range), law)
      end if
      if (.not. is_usable(scope%case, law)) return
      associate (grid => scope%grid(task%group%level + halving))
         if (.not. allocated(grid%step)) return
         call run_block(scope%control, law, grid, loud_steps(grid, law%threshold), &
            scope%T_s(member), scope%case%frame%xi_s, scope%case%solver%rtol, &
            scope%instructions, v_max, failed, error)
      end associate
      is_wide = failed .or. .not. v_max <= law%v_high
      is_poor = .not. is_wide .and. error > scope%case%solver%rtol
      do i = 1, size(member)
         if (is_wide(i) .or. is_poor(i)) cycle
         u_s_max(member(i), task%j, task%k) = law%length*v_max(i)
         is_done(member(i), task%j, task%k) = .true.
         call count_done(scope%control)
      end do
      call run_group(scope, range + 1, halving, task, pack(member, is_wide), u_s_max, is_done)
      call run_group(scope, range, halving + 1, task, pack(member, is_poor), u_s_max, is_done)
   end subroutine run_group

   !> Does the fit hold what the tolerance asks, and end before the wall overturns?
   pure logical function is_usable(case, law)
      type(case_t), intent(in) :: case
      type(fast_law_t), intent(in) :: law
      real(wp) :: alpha
      !! slenderness [rad]

      alpha = atan2(case%wall%b, case%wall%h)
      is_usable = law%fit_error < fit_share*case%solver%rtol .and. law%e > 0 &
         .and. law%v_high < sin(min(case%model%overturning_angle, 1.0_wp)/2)*cos(alpha)
   end function is_usable

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
