!> Rows in lanes: runs of one scene, sixteen at a time.
!>
!> Each lane has its own numbers, time, step and events. When its run ends, it takes the next
!> ordinate from the queue, the shortest periods first.
module rwmf_spectrum_lane_rows
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_lane_columns, only: of_length
   use rwmf_integrator_lane_kernels, only: best_level, lane_kernels_of, batch_width
   use rwmf_integrator_series_series_kernels, only: series_order
   use rwmf_integrator_series_series_lanes, only: series_width
   use rwmf_integrator_pairs, only: dormand_prince_853, pair_t, &
      tsitouras_papakostas_64
   use rwmf_model_scene, only: is_same_scene, scene_t
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_motion_ground_motion, only: is_piecewise_linear, motion_t, refined_motion, &
      scaled_motion
   use rwmf_problem_case, only: case_t, has_floors
   use rwmf_simulation_peak_sensitivity, only: perturb
   use rwmf_simulation_finite_check, only: is_finite
   use rwmf_simulation_lanes_batch, only: create_batch, lane_state_t, leave_batch, &
      tabulate_lines, batch_t
   use rwmf_simulation_lanes_lane_loading, only: join_batch
   use rwmf_simulation_lanes_loop, only: step_batch
   use rwmf_simulation_peak, only: peak_of
   use rwmf_simulation_recorder_recorder, only: finish_recorder, recorder_t
   use rwmf_simulation_run_values, only: fill_result
   use rwmf_simulation_run, only: begin_run, guess_size, is_much_smaller, &
      most_passes, response_size
   use rwmf_simulation_series_series_batch, only: create_series_batch, is_served, series_batch_t
   use rwmf_simulation_series_series_demands, only: serves_demands
   use rwmf_simulation_series_series_events, only: step_series
   use rwmf_simulation_series_series_loading, only: join_series
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, is_at_rest, mode_collapsed, &
      mode_overturned
   use rwmf_simulation_state_result, only: result_t
   use rwmf_spectrum_quantities, only: request_t, take_values
   use rwmf_spectrum_rows, only: row_motion, rows_t, take_row
   implicit none
   private

   public :: ordinate_t, queue_t, run_ordinates, refused

   character(*), parameter :: refused = 'refused'
   !! failure name of a row whose numbers the rules of the case do not allow

   character(*), parameter :: not_finite = 'not_finite'
   !! failure name of a row with an infinite or NaN result

   integer, parameter :: most_storeys = 64
   !! storeys of a frame in a batch: its state vectors are on the stack of a thread
   integer, parameter :: few_lanes = 2
   !! number of lanes that run faster one by one than in a batch

   !> A row to run, and its results.
   type :: ordinate_t
      integer :: row = 0
      !! number of the row
      real(wp) :: peak = 0
      !! u_s_max [m], without a frame the largest |theta| [rad], or the quantity of `accuracy_of`
      logical :: overturned = .false.
      logical :: collapsed = .false.
      integer(i8) :: rhs_evaluations = 0
      real(wp) :: rtol = 0
      !! relative tolerance; 0 for that of the case [-]
      real(wp) :: estimate = -1
      !! estimate of the relative error of the peak; not positive: none [-]
      real(wp) :: sensitivity = -1
      !! relative change of the peak per relative change of the motion; negative: none [-]
      logical :: is_inaccurate = .false.
      !! no tolerance has reduced the error to the requested accuracy
      character(24) :: failure = ''
      !! name of the error; blank: none
      real(wp), allocatable :: values(:)
      !! (quantities) requested values in their units; not allocated for the displacement only
      real(wp), allocatable :: round_off(:)
      !! (quantities) changes that round-off can cause [unit of each]; only with sensitivities
   end type ordinate_t

   !> Common data of all runs of a queue.
   type :: queue_t
      type(rows_t), pointer :: rows => null()
      type(motion_t), pointer :: motion => null()
      !! motion of all runs without a separate one
      type(request_t) :: request
      logical :: verifies = .false.
      !! runs use the pair of the highest order and the tolerance of the ordinate only
      integer :: parts = 1
      !! number of parts of each interval of the motion
      real(wp) :: shaken = 1
      !! factor on separate motions of rows, and on their initial states [-]
   end type queue_t

   !> Run of a lane.
   type :: lane_run_t
      integer :: ordinate = 0
      !! number of the ordinate; 0: the lane is idle
      integer :: pass = 0
      type(case_t) :: case
      type(motion_t) :: motion
      !! motion of a row with a separate one
      type(equation_t) :: equation
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(explicit_pair_t) :: integrator
      real(wp) :: size_guess(2)
   end type lane_run_t

   !> Common properties of all runs of a batch.
   type :: kind_t
      type(scene_t) :: scene
      logical :: has_vertical
      logical :: has_loading_direction
      logical :: is_pulse
      !! the motion is curved
      integer :: place
      !! place of the hysteretic state
      integer :: stages
      !! number of stages of the pair
      integer :: order
      !! order of the series; 0 for a pair
      integer :: max_steps
      real(wp) :: t_end
      !! [s]
   end type kind_t

contains

   !> Run all ordinates of a queue. The result is bitwise identical for every number of threads.
   subroutine run_ordinates(queue, threads, control, ordinates)
      type(queue_t), intent(in) :: queue
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      integer :: next, width

      if (size(ordinates) == 0) return
      next = 0
      width = 1
      if (size(ordinates) >= 2*threads) width = batch_width
      if (has_floors(queue%rows%case)) then
         if (size(queue%rows%case%frame%floors%m) > most_storeys) width = 1
      end if
      !$omp parallel num_threads(min(threads, size(ordinates))) default(shared)
      call run_batch(queue, control, width, next, ordinates)
      !$omp end parallel
   end subroutine run_ordinates

   !> Step one batch until the queue is empty and its lanes are idle.
   !>
   !> The last few lanes run one by one, because a step of sixteen lanes takes as long as two to
   !> three steps of one.
   subroutine run_batch(queue, control, width, next, ordinates)
      type(queue_t), intent(in) :: queue
      type(control_t), intent(in) :: control
      integer, intent(in) :: width
      !! number of lanes
      integer, intent(inout) :: next
      !! number of ordinates taken by all threads
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(lane_state_t), allocatable, target :: lanes(:)
      type(lane_run_t), allocatable, target :: runs(:)
      type(batch_t), target :: batch, alone
      type(kind_t), allocatable :: kind
      integer :: i

      allocate (lanes(max(width, series_width)), runs(max(width, series_width)))
      call take_ordinate(queue, control, next, ordinates, kind, runs(1), lanes(1))
      if (runs(1)%ordinate == 0) return
      if (kind%order > 0) then
         call run_series(queue, control, next, ordinates, kind, runs(:series_width), &
            lanes(:series_width))
         return
      end if
      do i = 2, width
         call take_ordinate(queue, control, next, ordinates, kind, runs(i), lanes(i))
      end do
      call create_batch(runs(1)%equation, pair_for(runs(1)%case, runs(1)%equation), &
         runs(1)%hybrid%max_steps, width, batch)
      batch%kernels = lane_kernels_of(best_level())
      ! lanes with separate motions use no table
      if (.not. queue%rows%has_own_motion) call tabulate_lines(queue%motion, kind%has_vertical, &
         kind%t_end, batch)
      batch%keeps_more = queue%request%is_watched
      do i = 1, width
         if (runs(i)%ordinate > 0) call join_batch(lanes(i), i, batch)
      end do
      call step_lanes(lanes, runs, few_lanes, batch)
      do i = 1, width
         if (.not. batch%is_busy(i)) cycle
         call leave_batch(lanes(i), i, batch, alone)
         call step_lanes(lanes(i:i), runs(i:i), 0, alone)
      end do

   contains

      !> Step until the queue is empty and no more lanes than `fewest` are busy.
      subroutine step_lanes(lanes, runs, fewest, batch)
         type(lane_state_t), intent(inout), target :: lanes(:)
         type(lane_run_t), intent(inout), target :: runs(:)
         integer, intent(in) :: fewest
         type(batch_t), intent(inout) :: batch
         integer :: i

         do
            if (batch%has_ended) then
               do i = 1, batch%width
                  do while (batch%is_busy(i) .and. .not. batch%table(i, of_length) > 0)
                     call finish_ordinate(queue%request, control, runs(i), lanes(i)%error, &
                        ordinates(runs(i)%ordinate))
                     if (runs(i)%ordinate == 0) call take_ordinate(queue, control, next, &
                        ordinates, kind, runs(i), lanes(i))
                     batch%is_busy(i) = runs(i)%ordinate > 0
                     if (batch%is_busy(i)) call join_batch(lanes(i), i, batch)
                  end do
               end do
               if (count(batch%is_busy) <= fewest) return
               batch%has_ended = .false.
            end if
            if (is_cancelled(control)) return
            call step_batch(lanes, batch)
         end do
      end subroutine step_lanes
   end subroutine run_batch

   !> Advance lanes by Taylor series until the queue is empty.
   subroutine run_series(queue, control, next, ordinates, kind, runs, lanes)
      type(queue_t), intent(in) :: queue
      type(control_t), intent(in) :: control
      integer, intent(inout) :: next
      !! number of ordinates taken by all threads
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(kind_t), allocatable, intent(inout) :: kind
      type(lane_run_t), intent(inout), target :: runs(:)
      !! runs of the lanes, the first one set up
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t) :: batch
      integer :: i

      if (queue%rows%has_own_motion) then
         call create_series_batch(best_level(), kind%order, batch, &
            seeks_speed=queue%request%seeks_velocity)
      else
         call create_series_batch(best_level(), kind%order, batch, queue%motion, kind%t_end, &
            queue%request%seeks_velocity)
      end if
      call join_series(lanes(1), 1, batch)
      do
         if (batch%has_ended) then
            batch%has_ended = .false.
            do i = 1, series_width
               do while (.not. batch%lanes%is_busy(i) > 0)
                  if (runs(i)%ordinate > 0) call finish_ordinate(queue%request, control, runs(i), &
                     lanes(i)%error, ordinates(runs(i)%ordinate))
                  if (runs(i)%ordinate == 0) call take_ordinate(queue, control, next, ordinates, &
                     kind, runs(i), lanes(i))
                  batch%is_busy(i) = runs(i)%ordinate > 0
                  if (.not. batch%is_busy(i)) exit
                  call join_series(lanes(i), i, batch)
               end do
            end do
            if (.not. any(batch%is_busy)) return
            batch%has_ended = .false.
         end if
         if (is_cancelled(control)) return
         call step_series(lanes, batch)
      end do
   end subroutine run_series

   !> Take the next ordinate from the queue and begin its run.
   !>
   !> If the queue is empty, the lane stays idle. Refused rows, and rows that cannot step with the
   !> batch, are completed here.
   subroutine take_ordinate(queue, control, next, ordinates, kind, run, lane)
      type(queue_t), intent(in) :: queue
      type(control_t), intent(in) :: control
      integer, intent(inout) :: next
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(kind_t), allocatable, intent(inout) :: kind
      !! kind of the batch; not allocated: this run sets it
      type(lane_run_t), intent(inout), target :: run
      type(lane_state_t), intent(inout) :: lane
      type(error_t), allocatable :: error
      integer :: number
      logical :: is_of_kind
      type(kind_t) :: own

      run%ordinate = 0
      do
         if (is_cancelled(control)) return
         !$omp atomic capture
         next = next + 1
         number = next
         !$omp end atomic
         if (number > size(ordinates)) return
         call set_up(queue, ordinates(number), run, lane, error)
         if (allocated(error)) then
            ordinates(number)%failure = refused
            call count_done(control)
            cycle
         end if
         run%ordinate = number
         if (.not. allocated(kind)) kind = kind_of(queue%request, run)
         ! the run can step in a batch of this kind
         own = kind_of(queue%request, run)
         is_of_kind = is_same_scene(own%scene, kind%scene) .and. (own%has_vertical .eqv. &
            kind%has_vertical) .and. (own%has_loading_direction .eqv. kind%has_loading_direction) &
            .and. (own%is_pulse .eqv. kind%is_pulse) .and. own%place == kind%place &
            .and. own%stages == kind%stages .and. own%order == kind%order .and. own%max_steps &
            == kind%max_steps .and. abs(own%t_end - kind%t_end) <= 0
         if (is_of_kind) return
         call run_alone(queue, control, run, lane, ordinates(number))
         run%ordinate = 0
      end do
   end subroutine take_ordinate

   !> Set up the run of a row. Errors: those of `take_row`.
   subroutine set_up(queue, ordinate, run, lane, error)
      type(queue_t), intent(in) :: queue
      type(ordinate_t), intent(in) :: ordinate
      type(lane_run_t), intent(inout), target :: run
      type(lane_state_t), intent(inout) :: lane
      type(error_t), allocatable, intent(out) :: error
      type(motion_t), pointer :: motion

      call take_row(queue%rows, ordinate%row, run%case, error)
      if (allocated(error)) return
      if (ordinate%rtol > 0) run%case%solver%rtol = ordinate%rtol
      if (queue%verifies) then
         run%case%solver%method = 'dop853'
         if (allocated(run%case%solver%atol)) deallocate (run%case%solver%atol)
      end if
      call perturb(run%case, queue%shaken)
      if (allocated(run%case%output)) deallocate (run%case%output)
      if (allocated(queue%request%output)) run%case%output = queue%request%output
      motion => queue%motion
      if (queue%rows%has_own_motion) then
         run%motion = row_motion(queue%rows, run%case)
         if (queue%parts > 1) run%motion = refined_motion(run%motion, queue%parts)
         if (abs(queue%shaken - 1) > 0) run%motion = scaled_motion(run%motion, queue%shaken)
         motion => run%motion
      end if
      lane%equation => run%equation
      lane%hybrid => run%hybrid
      lane%recorder => run%recorder
      lane%integrator => run%integrator
      lane%t_end = run%case%solver%t_end
      call build_equation(run%case, motion, run%equation)
      run%size_guess = guess_size(run%case, run%equation)
      run%pass = 1
      call begin_lane(queue%request, run, lane%error)
   end subroutine set_up

   type(kind_t) function kind_of(request, run) result(kind)
      type(request_t), intent(in) :: request
      type(lane_run_t), intent(in) :: run
      type(pair_t) :: pair
      integer :: order

      ! Order of the series for a run; 0 if a pair has to integrate it.
      !
      ! Runs at several tolerances and runs that verify others use the pair of the highest order.
      order = 0
      if (serves_demands(run%recorder, run%equation) .and. run%case%solver%method /= 'dop853' &
         .and. run%case%solver%rtol >= 1.0e-11_wp .and. .not. allocated(run%case%solver%accuracy) &
         .and. is_served(run%equation)) then
         order = series_order(run%case%solver%rtol)
      end if
      if (order == 0) pair = pair_for(run%case, run%equation)
      kind = kind_t(run%equation%scene, run%equation%has_vertical, &
         run%equation%has_loading_direction, .not. is_piecewise_linear(run%equation%motion), &
         run%equation%hysteresis%place, pair%stages, order, run%case%solver%max_steps, &
         run%case%solver%t_end)
   end function kind_of

   !> Run an ordinate in a separate batch of one lane.
   subroutine run_alone(queue, control, run, lane, ordinate)
      type(queue_t), intent(in) :: queue
      type(control_t), intent(in) :: control
      type(lane_run_t), intent(inout), target :: run
      type(lane_state_t), intent(in) :: lane
      type(ordinate_t), intent(inout) :: ordinate
      type(lane_state_t), target :: lanes(1)
      type(batch_t), target :: batch

      lanes(1) = lane
      call create_batch(run%equation, pair_for(run%case, run%equation), run%hybrid%max_steps, 1, &
         batch)
      batch%keeps_more = queue%request%is_watched
      do while (run%ordinate > 0)
         call join_batch(lanes(1), 1, batch)
         do while (batch%table(1, of_length) > 0)
            if (is_cancelled(control)) return
            call step_batch(lanes, batch)
         end do
         call finish_ordinate(queue%request, control, run, lanes(1)%error, ordinate)
      end do
   end subroutine run_alone

   !> Begin the run of a lane, with tolerances for its expected response.
   subroutine begin_lane(request, run, error)
      type(request_t), intent(in) :: request
      type(lane_run_t), intent(inout), target :: run
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: settled = 0.03_wp
      !! chatter below this part of the largest rotation so far is not resolved [-]

      run%integrator%pair = pair_for(run%case, run%equation)
      call begin_run(run%case, run%size_guess, run%equation, run%integrator, run%hybrid, &
         run%recorder, error)
      associate (equation => run%equation)
         ! an explicit dop853 is bitwise identical to single runs, which resolve all impacts
         if (request%has_only_peaks .and. run%case%solver%method /= 'dop853' .and. equation%n == 2 &
             .and. .not. (equation%has_loading_direction .or. equation%creep > 0)) then
            run%hybrid%settled_angle = settled
         end if
      end associate
   end subroutine begin_lane

   !> Runge-Kutta pair for a tolerance, unless the case names one.
   !>
   !> Some runs need the highest order: runs at several tolerances, motions without knots that limit
   !> the steps, and laws with a corner. Frames without a wall need it, too, because they accumulate
   !> the errors of many steps. For the same reason smooth hysteresis and storeys need it.
   pure type(pair_t) function pair_for(case, equation) result(pair)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation

      if (case%solver%rtol < 1.0e-11_wp .or. case%solver%method == 'dop853' &
          .or. allocated(case%solver%accuracy) &
          .or. .not. is_piecewise_linear(equation%motion) .or. equation%creep > 0 &
          .or. .not. equation%has_wall .or. equation%has_loading_direction &
          .or. equation%floors%free > 0) then
         pair = dormand_prince_853()
      else
         pair = tsitouras_papakostas_64()
      end if
   end function pair_for

   !> Keep the result of a completed run, or restart it for a smaller response.
   subroutine finish_ordinate(request, control, run, error, ordinate)
      type(request_t), intent(in) :: request
      type(control_t), intent(in) :: control
      type(lane_run_t), intent(inout), target :: run
      type(error_t), allocatable, intent(inout) :: error
      !! error that ended the run
      type(ordinate_t), intent(inout) :: ordinate
      real(wp) :: size_found(2)
      type(result_t) :: result
      logical :: are_finite

      ordinate%rhs_evaluations = ordinate%rhs_evaluations + run%equation%rhs_evaluations &
         + run%integrator%pair%stages*run%integrator%steps
      if (.not. allocated(error)) then
         call finish_recorder(run%recorder, run%equation, run%hybrid%t, run%hybrid%y, &
            is_at_rest(run%hybrid))
         ordinate%peak = run%recorder%u_max
         if (.not. run%equation%has_frame) ordinate%peak = max(run%recorder%theta_max, &
            -run%recorder%theta_min)
         ordinate%overturned = run%hybrid%mode == mode_overturned
         ordinate%collapsed = run%hybrid%mode == mode_collapsed
         size_found = response_size(run%recorder)
         if (is_much_smaller(run%case, size_found, run%size_guess) &
             .and. run%pass < most_passes) then
            run%pass = run%pass + 1
            run%size_guess = merge(size_found, run%size_guess, size_found < 0.1_wp*run%size_guess)
            call begin_lane(request, run, error)
            return
         end if
         ! compute the requested quantities, as a single run does
         if (.not. request%is_displacement) then
            call fill_result(run%case, run%equation, run%hybrid, run%recorder, result)
            if (.not. allocated(ordinate%values)) allocate (ordinate%values(size(request%place)))
            call take_values(request, result, ordinate%values, are_finite, ordinate%round_off)
            if (.not. are_finite) ordinate%failure = not_finite
            if (request%has_peak) ordinate%peak = peak_of(run%case, result)
         end if
         if (.not. is_finite(ordinate%peak)) ordinate%failure = not_finite
      else
         ordinate%failure = error%name
         deallocate (error)
      end if
      call count_done(control)
      run%ordinate = 0
   end subroutine finish_ordinate

end module rwmf_spectrum_lane_rows
