!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own period, so that its result has the same bits in every
!> company. What the method has no proof for is left undone and to the general kernel.
module rwmf_fast_spectrum
   use rwmf_case, only: case_t
   use rwmf_control, only: control_t, count_done, is_cancelled
   use rwmf_fast_block, only: run_block
   use rwmf_fast_grid, only: build_grid, fast_grid_t, loud_steps
   use rwmf_fast_law, only: build_law, fast_law_t
   use rwmf_fast_lanes, only: lanes
   use rwmf_fast_machine, only: best_level
   use rwmf_kinds, only: pi, wp
   use rwmf_motion, only: fastest_rate, motion_t
   implicit none
   private

   public :: run_fast

   real(wp), parameter :: least_gamma = 5
   !! mass ratio below which N is no small remainder [-]
   integer, parameter :: halvings = 5
   !! step sizes: the longest one halved up to so often
   real(wp), parameter :: fit_range(3) = [0.1_wp, 0.2_wp, 0.3_wp]
   !! of |u_s|/(2R) [-]

   !> Ordinates of one mass ratio, width and step size, at most `lanes`.
   type :: task_t
      integer :: j
      !! index of the mass ratio
      integer :: k
      !! index of the width
      integer :: level
      !! halvings of the step
      integer :: n
      integer :: member(lanes)
      !! indices of the periods
   end type task_t

contains

   !> Compute what the fast method can; `is_done` tells the rest from it.
   subroutine run_fast(case, motion, threads, control, T_s, gamma, b, u_s_max, is_done)
      type(case_t), intent(in) :: case
      !! with wall, frame and `&spectrum`
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
      type(fast_grid_t) :: grid(0:halvings)
      type(fast_law_t) :: law(size(gamma), size(b))
      type(task_t), allocatable :: task(:)
      integer :: level
      integer :: i

      is_done = .false.
      if (.not. is_supported(case)) return
      do i = 0, halvings
         if (any(levels(case, motion, T_s) == i)) call build_grid(motion, case%solver%t_end, &
            longest_step(case, motion)/2.0_wp**i, grid(i))
      end do
      task = list_tasks(levels(case, motion, T_s), T_s, gamma, b)
      level = best_level()
      do i = 1, size(law)
         associate (j => mod(i - 1, size(gamma)) + 1, k => (i - 1)/size(gamma) + 1)
            call build_law(scene_of(case, gamma(j), b(k)), fit_range(1), law(j, k))
         end associate
      end do
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared)
      do i = 1, size(task)
         if (.not. is_cancelled(control)) then
            call run_task(case, grid(task(i)%level), law(task(i)%j, task(i)%k), task(i), level, &
               control, T_s, gamma, b, u_s_max, is_done)
         end if
      end do
      !$omp end parallel do
   end subroutine run_fast

   !> Scenes that start at rest, with impacts that bounce, and no second run asked for.
   pure logical function is_supported(case)
      type(case_t), intent(in) :: case

      is_supported = allocated(case%wall) .and. allocated(case%frame) &
         .and. .not. allocated(case%initial) .and. .not. allocated(case%solver%accuracy) &
         .and. .not. allocated(case%link) .and. .not. allocated(case%damper) &
         .and. .not. allocated(case%storeys) &
         .and. .not. allocated(case%fuse) .and. .not. allocated(case%yielding) &
         .and. .not. allocated(case%inerter) .and. .not. allocated(case%vertical) &
         .and. .not. case%solver%verify .and. .not. allocated(case%solver%atol)
      if (is_supported) is_supported = case%wall%base == 'rocking'
      if (is_supported .and. allocated(case%impact)) is_supported = case%impact%rule /= 'table'
      if (is_supported .and. allocated(case%cable)) is_supported = &
         .not. (allocated(case%cable%eta_y) .or. allocated(case%cable%rupture_strain))
   end function is_supported

   !> Longest step [s]: a fraction of the wall's own time, and of the time in which the acceleration
   !> of a pulse varies, which is a cubic in a step.
   pure real(wp) function longest_step(case, motion) result(h)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion

      h = 0.024_wp*sqrt(case%wall%h/case%model%g)
      h = h*fineness(case)
      if (fastest_rate(motion) > 0) h = min(h, 0.06_wp/fastest_rate(motion))
   end function longest_step

   !> What the tolerance makes of the step: the scheme converges with its third power.
   pure real(wp) function fineness(case)
      type(case_t), intent(in) :: case

      fineness = min(2.0_wp, (case%solver%rtol/1.0e-8_wp)**(1.0_wp/3))
   end function fineness

   !> Group the ordinates by mass ratio, width and step, in the order of their periods.
   pure function list_tasks(level, T_s, gamma, b) result(task)
      integer, intent(in) :: level(:)
      !! (n_T) halvings of the step
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: b(:)
      type(task_t), allocatable :: task(:)
      integer :: order(size(T_s))
      integer :: j, k, l, n

      order = sorted(T_s)
      allocate (task(0))
      do k = 1, size(b)
         do j = 1, size(gamma)
            if (gamma(j) < least_gamma) cycle
            ! The expensive ones first, so that no thread is left alone with one at the end.
            do l = halvings, 0, -1
               do n = 1, count(level == l), lanes
                  task = [task, task_of(j, k, l, n, order, level)]
               end do
            end do
         end do
      end do
   end function list_tasks

   pure type(task_t) function task_of(j, k, l, first, order, level) result(task)
      integer, intent(in) :: j
      integer, intent(in) :: k
      integer, intent(in) :: l
      integer, intent(in) :: first
      !! number of the task's first period within its level
      integer, intent(in) :: order(:)
      integer, intent(in) :: level(:)
      integer :: members(size(order))

      members(:count(level == l)) = pack(order, level(order) == l)
      task%j = j
      task%k = k
      task%level = l
      task%n = min(lanes, count(level == l) - first + 1)
      task%member(:task%n) = members(first:first + task%n - 1)
   end function task_of

   !> Halvings that a period calls for; one more than there are: no step is short enough.
   pure function levels(case, motion, T_s)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      integer :: levels(size(T_s))
      real(wp) :: angle
      !! omega_s h allowed [rad]

      angle = 0.35_wp*fineness(case)
      levels = max(0, ceiling(log(2*pi*longest_step(case, motion)/(T_s*angle))/log(2.0_wp)))
      levels = min(levels, halvings + 1)
   end function levels

   !> Indices of a list in rising order.
   pure function sorted(x) result(order)
      real(wp), intent(in) :: x(:)
      integer :: order(size(x))
      integer :: i, j

      do i = 1, size(x)
         do j = i, 2, -1
            if (x(order(j - 1)) <= x(i)) exit
            order(j) = order(j - 1)
         end do
         order(max(1, j)) = i
      end do
   end function sorted

   !> One block, with ever wider fits for the ordinates that leave the first one.
   subroutine run_task(case, grid, first_law, task, level, control, T_s, gamma, b, u_s_max, &
      is_done)
      type(case_t), intent(in) :: case
      type(fast_grid_t), intent(in) :: grid
      type(fast_law_t), intent(in) :: first_law
      !! on the narrowest range
      type(task_t), intent(in) :: task
      integer, intent(in) :: level
      !! instruction set
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: b(:)
      real(wp), intent(inout) :: u_s_max(:, :, :)
      logical, intent(inout) :: is_done(:, :, :)
      type(fast_law_t) :: law
      real(wp) :: v_max(lanes)
      logical :: failed(lanes)
      logical :: good(lanes)
      integer :: left(lanes)
      integer :: n, i, range

      n = task%n
      left(:n) = task%member(:n)
      law = first_law
      do range = 1, size(fit_range)
         if (range > 1) then
            call build_law(scene_of(case, gamma(task%j), b(task%k)), fit_range(range), law)
         end if
         if (.not. is_usable(case, law)) return
         call run_block(law, grid, loud_steps(grid, law%threshold), T_s(left(:n)), &
            case%frame%xi_s, case%solver%rtol, level, v_max(:n), failed(:n))
         good(:n) = .not. failed(:n) .and. v_max(:n) <= law%v_high
         do i = 1, n
            if (.not. good(i)) cycle
            u_s_max(left(i), task%j, task%k) = law%length*v_max(i)
            is_done(left(i), task%j, task%k) = .true.
            call count_done(control)
         end do
         i = count(.not. good(:n))
         left(:i) = pack(left(:n), .not. good(:n))
         n = i
         if (n == 0) return
      end do
   end subroutine run_task

   !> Does the fit hold what the tolerance asks, and end before the wall overturns?
   pure logical function is_usable(case, law)
      type(case_t), intent(in) :: case
      type(fast_law_t), intent(in) :: law
      real(wp) :: alpha
      !! slenderness [rad]

      alpha = atan2(case%wall%b, case%wall%h)
      is_usable = law%fit_error < max(10*case%solver%rtol, 2.0e-8_wp) .and. law%e > 0 &
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
