!> The ordinates of one thread, each at a time of its own, in the lanes of a team.
!>
!> The lanes step together. A lane in whose step an event is possible waits until as many wait as
!> still step; then these steps are followed, and the flights after their impacts with them. A wall
!> at rest continues in the step in which it lifts off. The lane of a finished ordinate is given to
!> the next task. No operation mixes two lanes: the bits of a result do not depend on the others.
module rwmf_spectrum_fast_team
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int8_t, c_intptr_t, c_loc
   use rwmf_core_control, only: count_done, is_cancelled
   use rwmf_core_kinds, only: pi, wp
   use rwmf_spectrum_fast_reduced_equation, only: under_motion
   use rwmf_spectrum_fast_rest_rule, only: find_next_uplift, find_rest, velocity_share
   use rwmf_spectrum_fast_shared_data, only: max_stages, ordinate_t, scheme_of, shared_data_t, &
      task_t
   use rwmf_spectrum_fast_taylor_oscillator, only: step_weights
   use rwmf_spectrum_fast_time_grid, only: ground_at
   use rwmf_spectrum_fast_types, only: c_3, curves, degree, ground_step_t, lanes, scheme_t, &
      team_t, weights
   implicit none
   private

   public :: ordinate_result_t, run_team

   integer, parameter :: check_every = 64
   !! rounds between two checks of the caller's stop flag
   integer, parameter :: max_impacts = 200000
   !! of one ordinate; beyond them it is left to the general lanes and their rules for chatter
   real(wp), parameter :: remainder_share = 1.0e-4_wp
   !! part of the tolerance below which a change of v by N is left out
   real(wp), parameter :: least_span = 1.0e-6_wp
   !! of a substep: what is ambiguous in less is left to the general lanes [-]
   real(wp), parameter :: last_x = 1 - 1.0e-13_wp
   !! largest position of a lift-off, so that the rest of the step has a length [-]
   real(wp), parameter :: error_share(3) = [0.06_wp, 0.02_wp, 0.2_wp]
   !! error over the correction by the last of 1, 2, 3 evaluations of N, calibrated on spectra whose
   !! errors are known (docs/theory/fast.md) [-]
   real(wp), parameter :: large_angle = 0.95_wp
   !! omega_s h beyond which the error estimate is not damped [rad]
   real(wp), parameter :: wide_angle = 0.7_wp
   !! omega_s h beyond which substeps take three evaluations of N instead of two, because their
   !! errors are not in the estimate [rad]
   real(wp), parameter :: large_angle_factor = 2
   !! factor of the error estimate beyond `large_angle` with one or two evaluations [-]

   !> Result of a task.
   type :: ordinate_result_t
      real(wp) :: v_max = 0
      !! largest |u_s|/(2R) [-]
      real(wp) :: error = 0
      !! estimate of its relative error [-]
      logical :: failed = .true.
      !! v has left the range of the equation, or the ordinate is left to the general lanes
   end type ordinate_result_t

   !> What a thread has in work.
   type :: work_t
      type(team_t), pointer :: team => null()
      !! in `store`
      type(ordinate_t) :: ordinate(lanes)
      type(scheme_t) :: scheme
      !! of the steps of the team
      integer :: held = 0
      !! task that has been drawn, but needs steps of another kind
      logical :: has_idle = .true.
      !! a lane waits for a task
      integer(c_int8_t), allocatable :: store(:)
      !! memory of the team
   end type work_t

contains

   !> Compute tasks until none is left; called once by each thread.
   subroutine run_team(shared, task, next, result)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      !! (n) those with steps of one kind follow each other
      integer, intent(inout) :: next
      !! number of tasks that have been taken, by all threads
      type(ordinate_result_t), intent(inout) :: result(:)
      !! (n)
      type(work_t), target :: work
      integer :: event_bits, n_events, n_ready, n_waiting, round
      logical :: needs_update

      call create_team(work)
      work%team%negligible_change = remainder_share*shared%rtol
      round = 0
      do
         if (work%has_idle) call fill_lanes(shared, task, next, work, result)
         if (all(work%ordinate%task == 0)) exit
         associate (team => work%team)
            n_ready = count(team%ready > 0)
            n_waiting = count(team%waits > 0)
            needs_update = .false.
            do while (n_ready > n_waiting .and. .not. needs_update)
               call shared%kernels%step_team(shared%ground, work%scheme, team, event_bits, &
                  needs_update)
               if (event_bits == 0) cycle
               call mark_events(event_bits, team)
               n_events = popcnt(event_bits)
               n_ready = n_ready - n_events
               n_waiting = n_waiting + n_events
            end do
            if (needs_update) call enter_steps(shared, work)
            if (n_ready <= n_waiting) then
               call follow(.false., shared, work)
               call follow(.true., shared, work)
            end if
         end associate
         round = round + 1
         if (mod(round, check_every) == 0) then
            if (is_cancelled(shared%control)) exit
         end if
      end do
   end subroutine run_team

   !> Allocate a team at the beginning of a cache line: a vector across two lines costs twice.
   subroutine create_team(work)
      type(work_t), target, intent(inout) :: work
      integer, parameter :: cache_line = 64
      !! bytes
      type(team_t) :: empty
      integer(c_intptr_t) :: address

      allocate (work%store(storage_size(empty)/8 + cache_line))
      address = transfer(c_loc(work%store(1)), address)
      call c_f_pointer(c_loc(work%store(1 + int(modulo(-address, &
         int(cache_line, c_intptr_t))))), work%team)
      work%team = empty
   end subroutine create_team

   !> Store the results of finished ordinates and start the next tasks in their lanes. A task with
   !> steps of another kind is held until all lanes are idle.
   subroutine fill_lanes(shared, task, next, work, result)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task(:)
      integer, intent(inout) :: next
      type(work_t), intent(inout) :: work
      type(ordinate_result_t), intent(inout) :: result(:)
      type(scheme_t) :: scheme
      integer :: number, i

      work%has_idle = .false.
      do i = 1, lanes
         associate (ordinate => work%ordinate(i))
            do while (work%team%ready(i) + work%team%waits(i) <= 0)
               if (ordinate%task > 0) then
                  result(ordinate%task) = result_of(shared, work%scheme%stages, ordinate, i, &
                     work%team)
                  if (.not. result(ordinate%task)%failed &
                      .and. result(ordinate%task)%error <= shared%rtol) then
                     call count_done(shared%control)
                  end if
                  ordinate%task = 0
               end if
               number = work%held
               if (number == 0) then
                  !$omp atomic capture
                  next = next + 1
                  number = next
                  !$omp end atomic
               end if
               work%held = 0
               if (number > size(task)) exit
               scheme = scheme_of(shared, task(number))
               if (any(work%ordinate%task > 0) .and. (scheme%stages /= work%scheme%stages &
                   .or. (scheme%is_short .neqv. work%scheme%is_short) &
                   .or. (scheme%is_damped .neqv. work%scheme%is_damped))) then
                  work%held = number
                  exit
               end if
               work%scheme = scheme
               call start_ordinate(shared, task(number), number, i, work)
            end do
         end associate
      end do
   end subroutine fill_lanes

   !> Result of the ordinate in a lane.
   pure type(ordinate_result_t) function result_of(shared, stages, ordinate, i, team) result(result)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: stages
      type(ordinate_t), intent(in) :: ordinate
      integer, intent(in) :: i
      !! lane
      type(team_t), intent(in) :: team
      real(wp) :: omega_s

      result%v_max = team%v_max(i)
      omega_s = sqrt(ordinate%stiffness)
      result%error = error_share(stages)*team%error_at_peak(i) &
         /max(tiny(1.0_wp), ordinate%w_max, omega_s*result%v_max)
      if (omega_s*team%h(i) > large_angle .and. stages < max_stages) then
         result%error = large_angle_factor*result%error
      end if
      result%failed = ordinate%failed .or. .not. abs(team%now%v(i)) < huge(1.0_wp) &
         .or. .not. result%v_max <= ordinate%equation%v_high .or. .not. result%error <= huge(1.0_wp)
   end function result_of

   !> Start a task in a lane.
   pure subroutine start_ordinate(shared, task, number, i, work)
      type(shared_data_t), intent(in) :: shared
      type(task_t), intent(in) :: task
      integer, intent(in) :: number
      !! of the task
      integer, intent(in) :: i
      !! lane
      type(work_t), intent(inout) :: work
      real(wp) :: omega_s

      omega_s = 2*pi/task%T_s
      associate (team => work%team, equation => work%ordinate(i)%equation, &
         grid => shared%grid(task%grid))
         work%ordinate(i) = ordinate_t(task=number, grid=task%grid, offset=grid%first - 1, &
            equation=under_motion(shared%equation(task%equation), task%factor), &
            damping=2*task%xi_s*omega_s, stiffness=omega_s**2)
         team%damping(i) = 2*task%xi_s*omega_s
         team%stiffness(i) = omega_s**2
         team%m1(i) = equation%m1
         team%m3(i) = equation%m3
         team%linear_damping(i) = team%damping(i)*equation%m1 + equation%m4
         team%linear_stiffness(i) = team%stiffness(i)*equation%m1 + equation%m3_1
         team%e(i) = equation%e
         team%least_threshold(i) = minval(equation%threshold)
         team%stages(i) = merge(max_stages, task%stages, task%stages == 2 &
            .and. omega_s*grid%longest_step > wide_angle)
         team%error_estimate(i) = 0
         team%error_at_peak(i) = 0
         team%v_max(i) = equation%start_v
         team%negligible_velocity(i) = 0
         team%h(i) = -1
         ! no step has this length
         team%length_change(i) = 0
         team%side(i) = 1
         call enter_side(i, work)
         if (equation%start_v > equation%v_high) then
            work%ordinate(i)%failed = .true.
            call finish(i, work)
         else if (equation%start_v > 0 .or. equation%start_w > 0) then
            work%ordinate(i)%w_max = abs(equation%start_w)
            ! inside the step, where N is that of the state and not of the step before
            call begin_flight(shared, 1, tiny(1.0_wp), equation%start_side, equation%start_v, &
               equation%start_w, i, work)
            call start_remainder(grid%step(1), i, team)
         else
            call put_to_rest(shared, 1, 0.0_wp, i, work)
         end if
      end associate
   end subroutine start_ordinate

   !> N and its rate at the beginning of a step, for a flight that begins in the air.
   pure subroutine start_remainder(step, i, team)
      type(ground_step_t), intent(in) :: step
      integer, intent(in) :: i
      type(team_t), intent(inout) :: team
      real(wp), parameter :: x = 1.0e-4_wp
      !! positions between which the rate is a difference, with errors of x**2 and round-off/x [-]
      real(wp) :: v_d2

      team%now%n(i) = remainder_at(step, 0.0_wp, 0.0_wp, i, team)
      v_d2 = team%now%n(i) - team%m2(i)*team%side(i)*ground_at(step, 0.0_wp) - team%m3(i) &
         - team%linear_damping(i)*team%now%w(i) - team%linear_stiffness(i)*team%now%v(i)
      team%now%n_rate(i) = (remainder_at(step, x, v_d2, i, team) &
         - remainder_at(step, -x, v_d2, i, team))/(2*x*step%h)
   end subroutine start_remainder

   !> N at a position near the beginning of a step [1/s2].
   pure real(wp) function remainder_at(step, x, v_d2, i, team) result(n)
      type(ground_step_t), intent(in) :: step
      real(wp), intent(in) :: x
      !! [-]
      real(wp), intent(in) :: v_d2
      !! v'' at the beginning [1/s2]
      integer, intent(in) :: i
      type(team_t), intent(in) :: team
      real(wp) :: c(curves)
      real(wp) :: v, w
      integer :: j

      v = team%now%v(i) + x*step%h*team%now%w(i)
      w = team%now%w(i) + x*step%h*v_d2
      c = 0
      do j = degree, 0, -1
         c = c*v + team%coef(i, j, :)
      end do
      n = c(1)*w**2 - v*(c(2)*(team%damping(i)*w + team%stiffness(i)*v) &
         + c(3)*team%side(i)*ground_at(step, x) + c(4) + c(5)*w)
   end function remainder_at

   !> Lanes in which an event is possible wait until it is followed.
   pure subroutine mark_events(event_bits, team)
      integer, intent(in) :: event_bits
      !! bit i - 1: an event is possible in lane i
      type(team_t), intent(inout) :: team
      integer :: left, i

      left = event_bits
      do while (left /= 0)
         i = trailz(left) + 1
         left = iand(left, left - 1)
         team%ready(i) = 0
         team%waits(i) = 1
         team%x(i) = 0
         team%span(i) = 1
      end do
   end subroutine mark_events

   !> Let the lanes that step follow the length of their steps.
   pure subroutine enter_steps(shared, work)
      type(shared_data_t), intent(in) :: shared
      type(work_t), intent(inout) :: work
      integer :: i

      do i = 1, lanes
         if (work%team%ready(i) > 0) call enter_step(shared, i, work)
      end do
   end subroutine enter_steps

   !> Set the weights of a lane if its next step has another length; beyond the last step its
   !> ordinate is finished.
   pure subroutine enter_step(shared, i, work)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work
      real(wp) :: second_node

      associate (team => work%team, ordinate => work%ordinate(i))
         if (team%step(i) < team%length_change(i)) return
         associate (grid => shared%grid(ordinate%grid))
            if (team%step(i) - ordinate%offset > size(grid%step)) then
               if (ordinate%repetitions >= grid%repetitions) then
                  ordinate%failed = grid%is_cut
                  call finish(i, work)
                  return
               end if
               ordinate%repetitions = ordinate%repetitions + 1
               team%step(i) = ordinate%offset + grid%motion_end_step + 1
            end if
         end associate
         associate (ground => shared%ground(team%step(i)))
            team%length_change(i) = team%step(i) + ground%equal_steps
            if (abs(ground%h - team%h(i)) <= 0) return
            team%h(i) = ground%h
            team%inverse_h(i) = 1/ground%h
            team%damping_factor(i) = max(0.0_wp, 1 - 0.5_wp*ground%h*team%linear_damping(i))
            if (ground%h*sqrt(team%stiffness(i)) > large_angle) team%damping_factor(i) = 1
            second_node = merge(0.5_wp, c_3, work%scheme%stages == 2)
            team%weight(i, :) = reshape(step_weights(team%linear_damping(i), &
               team%linear_stiffness(i), ground%h, second_node), [weights])
         end associate
      end associate
   end subroutine enter_step

   !> The ordinate of a lane is finished.
   pure subroutine finish(i, work)
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work

      work%has_idle = .true.
      associate (team => work%team)
         team%ready(i) = 0
         team%waits(i) = 0
         team%is_substep(i) = 0
         team%step(i) = 1
         team%length_change(i) = huge(1)
      end associate
   end subroutine finish

   !> The constants of the side come into force.
   pure subroutine enter_side(i, work)
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work
      integer :: side, n

      side = merge(1, 2, work%team%side(i) > 0)
      n = merge(curves, curves - 1, work%scheme%is_damped)
      associate (equation => work%ordinate(i)%equation)
         work%team%m2(i) = equation%m2(side)
         work%team%coef(i, :, :n) = equation%coef(:, :n, side)
      end associate
   end subroutine enter_side

   !> Put the wall to rest at the position x of a step: until it lifts off, or to the end.
   pure subroutine put_to_rest(shared, number, x, i, work)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: number
      !! of the step in the grid
      real(wp), intent(in) :: x
      !! position in the step [-]
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work
      integer :: uplift, side
      real(wp) :: uplift_x

      associate (team => work%team, ordinate => work%ordinate(i))
         associate (equation => ordinate%equation, grid => shared%grid(ordinate%grid))
            uplift = number
            uplift_x = x
            call find_next_uplift(equation, grid, uplift, uplift_x, side)
            team%step(i) = ordinate%offset + uplift
            team%now%v(i) = 0
            team%now%w(i) = 0
            if (uplift > size(grid%step)) then
               call finish(i, work)
            else
               call begin_flight(shared, uplift, uplift_x, side, 0.0_wp, 0.0_wp, i, work)
            end if
         end associate
      end associate
   end subroutine put_to_rest

   !> Begin a flight inside a step.
   pure subroutine begin_flight(shared, number, x, side, v, w, i, work)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: number
      !! of the step in the grid
      real(wp), intent(in) :: x
      !! position in the step [-]
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: v
      real(wp), intent(in) :: w
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work

      associate (team => work%team, ordinate => work%ordinate(i))
         team%step(i) = ordinate%offset + number
         team%f(i, :) = shared%ground(team%step(i))%f
         team%now%v(i) = v
         team%now%w(i) = w
         team%side(i) = side
         if (.not. ordinate%equation%is_even) call enter_side(i, work)
         team%x(i) = min(x, last_x)
         team%span(i) = 1 - team%x(i)
         team%w_begin(i) = w
         team%ready(i) = 0
         team%waits(i) = 1
         team%is_substep(i) = 1
         call enter_step(shared, i, work)
      end associate
   end subroutine begin_flight

   !> Follow the steps with an event, or the substeps.
   subroutine follow(are_substeps, shared, work)
      logical, intent(in) :: are_substeps
      type(shared_data_t), intent(in) :: shared
      type(work_t), intent(inout) :: work
      integer :: i

      associate (team => work%team)
         team%is_followed = merge(team%is_substep, team%waits - team%is_substep, are_substeps)
         if (.not. any(team%is_followed > 0)) return
         call shared%kernels%follow_steps(are_substeps, work%scheme, team)
         do i = 1, lanes
            if (team%is_followed(i) > 0) call classify(shared, i, work)
         end do
      end associate
   end subroutine follow

   !> What follows a step with an event or a substep: failure, half of what was ambiguous, another
   !> flight, rest, the other part of the step, or the next step.
   pure subroutine classify(shared, i, work)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work
      logical :: is_at_rest

      associate (team => work%team, ordinate => work%ordinate(i))
         team%is_substep(i) = 1
         is_at_rest = .false.
         if (team%is_ambiguous(i) > 0) then
            team%span(i) = team%span(i)/2
            ordinate%failed = team%span(i) < least_span
         else if (team%has_impact(i) > 0) then
            call apply_impact(shared, i, work, is_at_rest)
         else if (team%span(i) < 1 - team%x(i)) then
            team%x(i) = team%x(i) + team%span(i)
            team%span(i) = 1 - team%x(i)
         else
            team%is_substep(i) = 0
            team%waits(i) = 0
            team%ready(i) = 1
            team%step(i) = team%step(i) + 1
            call enter_step(shared, i, work)
         end if
         if (ordinate%failed) then
            call finish(i, work)
         else if (is_at_rest) then
            call put_to_rest(shared, team%step(i) - ordinate%offset, team%x(i), i, work)
         end if
      end associate
   end subroutine classify

   !> Apply an impact to an ordinate: the next flight is set up, or the wall comes to rest.
   pure subroutine apply_impact(shared, i, work, is_at_rest)
      type(shared_data_t), intent(in) :: shared
      integer, intent(in) :: i
      type(work_t), intent(inout) :: work
      logical, intent(out) :: is_at_rest

      associate (team => work%team, ordinate => work%ordinate(i))
         ordinate%impacts = ordinate%impacts + 1
         ordinate%failed = .not. team%impact_speed(i) > 0 .or. ordinate%impacts > max_impacts &
            .or. team%v_max(i) > ordinate%equation%v_high
         ordinate%w_max = max(ordinate%w_max, team%impact_speed(i))
         ordinate%v_max = team%v_max(i)
         ordinate%negligible_velocity = velocity_share*shared%rtol*ordinate%w_max
         team%negligible_velocity(i) = ordinate%negligible_velocity
         associate (equation => ordinate%equation, grid => shared%grid(ordinate%grid), &
            number => team%step(i) - ordinate%offset)
            ! without a velocity it rests, even if only until the motion lifts it at once
            is_at_rest = equation%e <= 0
            if (is_at_rest) return
            if (team%may_rest(i) > 0 .or. number >= grid%motion_end_step) then
               call find_rest(equation, grid, number, team%x(i), team%f_impact(i), &
                  team%now%w(i), ordinate, is_at_rest)
            end if
            if (.not. (is_at_rest .or. equation%is_even)) call enter_side(i, work)
         end associate
      end associate
   end subroutine apply_impact

end module rwmf_spectrum_fast_team
