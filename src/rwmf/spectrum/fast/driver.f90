!> Method 'fast': the ordinates of a spectrum in lanes.
!>
!> The step of an ordinate depends on its own case only, so that the bits of its result do not
!> depend on the other ordinates. Ordinates outside the validated range of the method are left to
!> the general lanes. All rows share one motion, in its own unit: what they multiply it with is a
!> factor in their equations.
module rwmf_spectrum_fast_driver
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: motion_t, motion_unit, unit_motion
   use rwmf_problem_case, only: case_t
   use rwmf_problem_scene_axes, only: set_axes
   use rwmf_spectrum_fast_bare_frame, only: run_frames
   use rwmf_spectrum_fast_eligibility, only: is_supported
   use rwmf_spectrum_fast_reduced_equation, only: build_reduced_equation
   use rwmf_spectrum_fast_schedule, only: order_by_cost
   use rwmf_spectrum_fast_shared_data, only: max_stages, shared_data_t, task_t
   use rwmf_spectrum_fast_simd_dispatch, only: best_level, kernels_of
   use rwmf_spectrum_fast_taylor_oscillator, only: fastest_root
   use rwmf_spectrum_fast_team, only: ordinate_result_t, run_team
   use rwmf_spectrum_fast_time_grid, only: build_grids, longest_interval, pulse_step, shared_step
   use rwmf_spectrum_fast_types, only: reduced_equation_t
   use rwmf_spectrum_rows, only: rows_t, scene_of, take_row
   implicit none
   private

   public :: exponential_t, begin_fast, run_fast

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
   real(wp), parameter :: largest_angle = 0.69_wp
   !! of the vibration in a step at rtol = 1e-8; twice as much converges still [rad]
   real(wp), parameter :: fit_share = 0.1_wp
   !! error of the fit over the tolerance: a steady error of the acceleration is amplified by
   !! (g/R)/(omega_s**2 v), about 10 for flexible frames

   !> What is kept from one block of rows to the next.
   type :: exponential_t
      logical :: is_used = .false.
      !! the method covers the scene
      type(rows_t), pointer :: rows => null()
      integer :: threads
      !! number of threads to use
      type(motion_t) :: motion
      !! of all rows, in its own unit
      real(wp) :: interval
      !! the longest between its knots [s]
      real(wp), allocatable :: h(:)
      !! (grids) their longest steps [s]
      type(shared_data_t) :: shared
      logical :: keeps_rows = .false.
      !! the following is wanted
      type(case_t), allocatable :: row(:)
      !! (rows of the block) their structures and solvers, where they are not refused
   end type exponential_t

   !> An ordinate to be computed, and the step for it.
   type :: attempt_t
      integer :: i
      !! number of the row in its block
      real(wp) :: T_s
      !! [s]
      real(wp) :: xi_s
      !! damping ratio of the frame [-]
      real(wp) :: unit
      !! of the motion [m/s2]
      real(wp) :: h
      !! longest step that the scene allows [s]
      integer :: scene
      !! number of its scene in the block
      integer :: range = 1
      !! of v
      integer :: level
      !! halvings of the step
      integer :: stages
      !! evaluations of N in a step; 0: nothing is to be computed
      integer :: grid = 0
      !! number of its time grid
      logical :: is_finer = .false.
      !! the step is halved once more because the estimated error was too large
   end type attempt_t

contains

   !> Does the method cover the rows, and what do they share?
   subroutine begin_fast(rows, threads, control, fast)
      type(rows_t), intent(in), target :: rows
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      type(exponential_t), intent(out) :: fast

      if (rows%n == 0 .or. rows%has_own_shape .or. rows%has_own_method) return
      fast%motion = unit_motion(rows%case, rows%origin)
      fast%is_used = is_supported(rows%case, fast%motion)
      if (.not. fast%is_used) return
      fast%rows => rows
      fast%threads = threads
      fast%interval = longest_interval(fast%motion)
      allocate (fast%h(0), fast%shared%grid(0))
      fast%shared%control = control
      fast%shared%kernels = kernels_of(best_level())
      fast%shared%rtol = rows%case%solver%rtol
   end subroutine begin_fast

   !> Compute the ordinates of a block of rows that the method covers; the others keep `is_done`
   !> false.
   subroutine run_fast(fast, first, u_s_max, is_done)
      type(exponential_t), intent(inout), target :: fast
      integer, intent(in) :: first
      !! number of the first row of the block
      real(wp), intent(inout) :: u_s_max(:)
      !! (rows) [m]
      logical, intent(out) :: is_done(:)
      !! (rows) the ordinate has its u_s_max
      logical, allocatable :: is_fitted(:, :)
      type(attempt_t), allocatable :: attempt(:)
      integer :: scenes

      is_done = .false.
      associate (rows => fast%rows, shared => fast%shared)
         scenes = scene_of(rows, first + size(is_done) - 1) - scene_of(rows, first) + 1
         allocate (is_fitted(scenes, size(fit_range)), source=.false.)
         if (allocated(shared%equation)) deallocate (shared%equation)
         allocate (shared%equation(size(is_fitted)), attempt(size(is_done)))
         if (allocated(fast%row)) deallocate (fast%row)
         if (fast%keeps_rows) allocate (fast%row(size(is_done)))
         call first_attempts(fast, first, is_fitted(:, 1), attempt)
         if (.not. allocated(rows%case%wall)) then
            call run_frames(rows%case, fast%motion, fast%threads, shared%control, attempt%T_s, &
               attempt%xi_s, u_s_max, is_done)
            where (is_done) u_s_max = abs(attempt%unit)*u_s_max
            return
         end if
         attempt = pack(attempt, attempt%stages > 0)
         attempt = attempt(order_by_cost(attempt%T_s, attempt%level, halvings))
         ! of a grid: lanes of one scene, at adjacent periods, have their events at about one time
         if (.not. associated(rows%table)) attempt = attempt(grouped(attempt%scene, scenes))
         do while (size(attempt) > 0)
            call fit_equations(fast, first, scenes, is_fitted, attempt)
            call cut_motion(fast, attempt)
            call run_attempts(fast, scenes, attempt, u_s_max, is_done)
            if (is_cancelled(shared%control)) exit
         end do
      end associate
   end subroutine run_fast

   !> Indices of a list of numbers with equal ones together, in their order.
   pure function grouped(number, most) result(order)
      integer, intent(in) :: number(:)
      !! from 1 to `most`
      integer, intent(in) :: most
      integer :: order(size(number))
      integer :: before(most + 1)
      integer :: i

      before = 0
      do i = 1, size(number)
         before(number(i) + 1) = before(number(i) + 1) + 1
      end do
      do i = 2, most + 1
         before(i) = before(i) + before(i - 1)
      end do
      do i = 1, size(number)
         before(number(i)) = before(number(i)) + 1
         order(before(number(i))) = i
      end do
   end function grouped

   !> First attempts: all rows. The equation of a scene is fitted by the way where its first row is.
   subroutine first_attempts(fast, first, is_fitted, attempt)
      type(exponential_t), intent(inout) :: fast
      integer, intent(in) :: first
      logical, intent(inout) :: is_fitted(:)
      !! (scenes)
      type(attempt_t), intent(out) :: attempt(:)
      !! (rows)
      type(case_t) :: row
      type(error_t), allocatable :: error
      integer :: i

      !$omp parallel do num_threads(fast%threads) schedule(dynamic, 16) default(shared) &
      !$omp private(row, error)
      do i = 1, size(attempt)
         attempt(i)%i = i
         attempt(i)%stages = 0
         attempt(i)%level = halvings + 1
         attempt(i)%T_s = 1
         call take_row(fast%rows, first + i - 1, row, error)
         if (allocated(error)) cycle
         if (fast%keeps_rows) then
            fast%row(i)%structure_t = row%structure_t
            fast%row(i)%solver = row%solver
         end if
         attempt(i)%T_s = row%frame%T_s
         attempt(i)%xi_s = row%frame%xi_s
         attempt(i)%unit = unit_of(fast%rows, row)
         if (.not. allocated(row%wall)) cycle
         if (row%frame%gamma < min_gamma .or. .not. abs(attempt(i)%unit) > 0) cycle
         attempt(i)%scene = scene_of(fast%rows, first + i - 1) - scene_of(fast%rows, first) + 1
         attempt(i)%stages = stages_for(row, row%frame%gamma)
         attempt(i)%h = longest_step(row, fast%motion)
         attempt(i)%level = level_for(row, attempt(i)%h)
         if (i > 1) then
            if (scene_of(fast%rows, first + i - 2) == scene_of(fast%rows, first + i - 1)) cycle
         end if
         call fit(row, fast%motion, 1, fast%shared, fast%shared%equation(attempt(i)%scene))
         is_fitted(attempt(i)%scene) = .true.
      end do
      !$omp end parallel do
   end subroutine first_attempts

   !> Unit of the motion of a row [m/s2].
   pure real(wp) function unit_of(rows, row) result(unit)
      type(rows_t), intent(in) :: rows
      type(case_t), intent(in) :: row

      if (rows%has_own_motion) then
         unit = motion_unit(row)
      else
         unit = motion_unit(rows%case)
      end if
   end function unit_of

   !> Fit the equation of a row on a range of v, whatever its period.
   subroutine fit(row, motion, range, shared, equation)
      type(case_t), intent(inout) :: row
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: range
      type(shared_data_t), intent(in) :: shared
      type(reduced_equation_t), intent(out) :: equation

      ! the equations of rows with other periods have the same bits
      call set_axes(row, T_s=1.0_wp)
      call build_reduced_equation(row, motion, fit_range(range), fit_share*shared%rtol, equation)
   end subroutine fit

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

   !> Halvings of the step; `halvings` + 1 where no step is short enough.
   pure integer function level_for(case, longest) result(level)
      type(case_t), intent(in) :: case
      !! with the period
      real(wp), intent(in) :: longest
      !! step without any [s]
      real(wp) :: angle
      !! omega_s h allowed [rad]

      angle = largest_angle*fineness(case)
      level = max(0, ceiling(log(2*pi*longest/(case%frame%T_s*angle))/log(2.0_wp)))
      level = min(level, halvings + 1)
   end function level_for

   !> Fit the equations of the attempts that are not yet known; attempts that have none which is
   !> accurate enough are dropped.
   subroutine fit_equations(fast, first, scenes, is_fitted, attempt)
      type(exponential_t), intent(inout) :: fast
      integer, intent(in) :: first
      integer, intent(in) :: scenes
      !! number of them in the block
      logical, intent(inout) :: is_fitted(:, :)
      !! (scenes, ranges)
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      type(case_t) :: row
      type(error_t), allocatable :: error
      integer, allocatable :: wanted(:)
      integer :: i, k

      allocate (wanted(size(is_fitted)), source=0)
      do i = 1, size(attempt)
         if (.not. is_fitted(attempt(i)%scene, attempt(i)%range)) wanted(equation_of(attempt(i), &
            scenes)) = i
      end do
      wanted = pack(wanted, wanted > 0)
      !$omp parallel do num_threads(fast%threads) schedule(dynamic) default(shared) &
      !$omp private(i, row, error) if (size(wanted) > 2)
      do k = 1, size(wanted)
         i = wanted(k)
         call take_row(fast%rows, first + attempt(i)%i - 1, row, error)
         call fit(row, fast%motion, attempt(i)%range, fast%shared, &
            fast%shared%equation(equation_of(attempt(i), scenes)))
         is_fitted(attempt(i)%scene, attempt(i)%range) = .true.
      end do
      !$omp end parallel do
      attempt = pack(attempt, fast%shared%equation(equation_of(attempt, scenes))%fit_error &
         < fit_share*fast%shared%rtol)
      do i = 1, size(attempt)
         call shorten_step(fast%shared%equation(equation_of(attempt(i), scenes)), attempt(i))
      end do
      attempt = pack(attempt, attempt%stages > 0)
   end subroutine fit_equations

   !> Halve the step of an overdamped frame until its series converges; an attempt for which no step
   !> is short enough has no stages afterwards.
   pure subroutine shorten_step(equation, attempt)
      type(reduced_equation_t), intent(in) :: equation
      type(attempt_t), intent(inout) :: attempt
      real(wp) :: omega_s, damping, stiffness, angle

      omega_s = 2*pi/attempt%T_s
      damping = 2*attempt%xi_s*omega_s*equation%m1 + equation%m4
      stiffness = max(0.0_wp, omega_s**2*equation%m1 + equation%m3_1)
      angle = fastest_root(damping, stiffness)*attempt%h
      if (damping**2 > 4*stiffness) then
         do while (attempt%level <= halvings .and. angle > largest_angle*2.0_wp**attempt%level)
            attempt%level = attempt%level + 1
         end do
      end if
      if (.not. angle <= 2.1_wp*largest_angle*2.0_wp**attempt%level) attempt%stages = 0
   end subroutine shorten_step

   !> Number of the equation of an attempt.
   pure elemental integer function equation_of(attempt, scenes)
      type(attempt_t), intent(in) :: attempt
      integer, intent(in) :: scenes

      equation_of = attempt%scene + (attempt%range - 1)*scenes
   end function equation_of

   !> Cut the motion into the steps that the attempts ask for, beside those that are there; attempts
   !> that would need too many are dropped.
   subroutine cut_motion(fast, attempt)
      type(exponential_t), intent(inout), target :: fast
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      real(wp), allocatable :: h(:)
      real(wp) :: own
      integer :: i

      h = fast%h
      do i = 1, size(attempt)
         own = shared_step(attempt(i)%h/2.0_wp**attempt(i)%level, fast%interval)
         attempt(i)%grid = findloc(abs(h - own) <= 0, .true., dim=1)
         if (attempt(i)%grid > 0) cycle
         h = [h, own]
         attempt(i)%grid = size(h)
      end do
      if (size(h) > size(fast%h)) then
         deallocate (fast%shared%grid)
         allocate (fast%shared%grid(size(h)))
         call build_grids(fast%rows%case, fast%motion, fast%threads, h, fast%shared%ground, &
            fast%shared%grid)
         fast%h = h
      end if
      attempt = pack(attempt, [(associated(fast%shared%grid(attempt(i)%grid)%step), &
         i=1, size(attempt))])
   end subroutine cut_motion

   !> Compute the ordinates; those that are to be computed again remain: on a wider range once v has
   !> left that of the equation, with all evaluations of N, then on the halved step where the
   !> estimated error is too large.
   subroutine run_attempts(fast, scenes, attempt, u_s_max, is_done)
      type(exponential_t), intent(in) :: fast
      integer, intent(in) :: scenes
      type(attempt_t), allocatable, intent(inout) :: attempt(:)
      real(wp), intent(inout) :: u_s_max(:)
      logical, intent(inout) :: is_done(:)
      type(task_t), allocatable :: task(:)
      type(ordinate_result_t), allocatable :: found(:)
      logical, allocatable :: is_repeated(:)
      integer, allocatable :: kind(:), order(:)
      integer :: thread, next, i, k

      ! With one evaluation the slope of N would oscillate after a jump of the acceleration.
      where (fast%shared%grid(attempt%grid)%has_jumps) attempt%stages = max(2, attempt%stages)
      kind = 2*attempt%stages + merge(0, 1, &
         fast%shared%equation(equation_of(attempt, scenes))%is_short)
      allocate (order(0))
      do i = 2*max_stages + 1, 2, -1
         order = [order, pack([(k, k=1, size(attempt))], kind == i)]
      end do
      attempt = attempt(order)
      task = [(task_t(attempt(i)%T_s, equation_of(attempt(i), scenes), attempt(i)%grid, &
         attempt(i)%stages, attempt(i)%xi_s, attempt(i)%unit), i=1, size(attempt))]
      allocate (found(size(task)))
      next = 0
      !$omp parallel do num_threads(fast%threads) schedule(static, 1) default(shared)
      do thread = 1, fast%threads
         call run_team(fast%shared, task, next, found)
      end do
      !$omp end parallel do
      allocate (is_repeated(size(attempt)), source=.false.)
      do i = 1, size(attempt)
         associate (current => attempt(i))
            if (found(i)%failed) then
               is_repeated(i) = current%range < size(fit_range) &
                  .and. fast%shared%equation(task(i)%equation)%v_high >= fit_range(current%range)
               current%range = current%range + 1
            else if (found(i)%error > fast%shared%rtol .and. current%stages < max_stages) then
               current%stages = max_stages
               is_repeated(i) = .true.
            else if (found(i)%error > fast%shared%rtol) then
               is_repeated(i) = .not. current%is_finer
               current%is_finer = .true.
               current%level = current%level + 1
            else
               u_s_max(current%i) = fast%shared%equation(task(i)%equation)%length*found(i)%v_max
               is_done(current%i) = .true.
            end if
         end associate
      end do
      attempt = pack(attempt, is_repeated)
   end subroutine run_attempts

end module rwmf_spectrum_fast_driver
