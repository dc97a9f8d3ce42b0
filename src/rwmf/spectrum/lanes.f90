!> Ordinates of a spectrum in lanes: runs of one scene, sixteen at a time, each with its own clock,
!> step and events. A lane whose run is over takes the next ordinate from the queue, the shortest
!> periods first.
module rwmf_spectrum_lanes
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_lane_columns, only: of_length
   use rwmf_integrator_lane_kernels, only: lane_kernels_of, team_width
   use rwmf_integrator_pairs, only: dormand_prince_853, pair_t, verner_65
   use rwmf_model_assembly, only: build_equation, equation_t
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_scene_axes, only: set_axes
   use rwmf_simulation_hybrid_loop, only: hybrid_t, mode_collapsed, mode_overturned, mode_rest
   use rwmf_simulation_lanes_loop, only: join_team, step_team
   use rwmf_simulation_lanes_team, only: create_team, lane_t, leave_team, &
      tabulate_lines, team_t
   use rwmf_simulation_recorder_recorder, only: finish_recorder, recorder_t
   use rwmf_simulation_result, only: result_t
   use rwmf_simulation_run, only: begin_run, fill_result, guess_size, is_much_smaller, &
      most_passes, response_size
   use rwmf_spectrum_fast_simd_dispatch, only: best_level
   use rwmf_spectrum_quantities, only: asked_t, take_values
   implicit none
   private

   public :: ordinate_t, run_ordinates

   integer, parameter :: few_lanes = 2
   !! that are faster alone than in a team

   !> What is asked for, and what comes of it.
   type :: ordinate_t
      real(wp) :: T_s = 0
      !! period of the frame, of a block 2 pi/p [s]
      real(wp) :: gamma = 0
      !! mass ratio [-]; of a wall, as the following
      real(wp) :: b = 0
      !! half width [m]
      real(wp) :: peak = 0
      !! u_s_max [m], without a frame the largest |theta| [rad]
      logical :: overturned = .false.
      logical :: collapsed = .false.
      integer(i8) :: rhs_evaluations = 0
      real(wp) :: rtol = 0
      !! tolerance, where it is not that of the case [-]
      real(wp) :: estimate = -1
      !! of the relative error of the peak; negative: there is none [-]
      real(wp) :: sensitivity = -1
      !! relative change of the peak per relative change of the motion, likewise [-]
      logical :: is_inaccurate = .false.
      !! no tolerance has brought the error down to what is asked for
      character(24) :: failure = ''
      !! name of the error
      real(wp), allocatable :: values(:)
      !! (quantities) that were asked for, in their units, where it is more than the displacement
   end type ordinate_t

   !> The run of a lane.
   type :: lane_run_t
      integer :: ordinate = 0
      !! its number; 0: the lane is idle
      integer :: pass = 0
      type(case_t) :: case
      type(equation_t) :: equation
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(explicit_pair_t) :: integrator
      real(wp) :: size_guess(2)
   end type lane_run_t

contains

   !> Run all ordinates of a case; the number of threads changes no bit.
   subroutine run_ordinates(case, asked, motion, threads, control, ordinates)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      type(ordinate_t), intent(inout) :: ordinates(:)
      integer :: next

      if (size(ordinates) == 0) return
      next = 0
      !$omp parallel num_threads(min(threads, size(ordinates))) default(shared)
      call run_team(case, asked, motion, control, min(team_width, 1 + (team_width - 1) &
         *min(1, size(ordinates)/(2*threads))), next, ordinates)
      !$omp end parallel
   end subroutine run_ordinates

   !> Steps of one team, until the queue is empty and its lanes are idle; the last ones go on alone,
   !> because a step of sixteen lanes takes as long as two to three of one.
   subroutine run_team(case, asked, motion, control, width, next, ordinates)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      integer, intent(in) :: width
      !! number of lanes
      integer, intent(inout) :: next
      !! number of ordinates that have been taken, by all threads
      type(ordinate_t), intent(inout) :: ordinates(:)
      type(lane_t), allocatable, target :: lanes(:)
      type(lane_run_t), allocatable, target :: runs(:)
      type(team_t), target :: team, alone
      integer :: i

      allocate (lanes(width), runs(width))
      do i = 1, width
         call take_ordinate(case, asked, motion, control, next, ordinates, runs(i), lanes(i))
      end do
      if (all(runs%ordinate == 0)) return
      call create_team(runs(1)%equation, pair_for(case, runs(1)%equation), &
         runs(1)%hybrid%max_steps, width, team)
      team%kernels = lane_kernels_of(best_level())
      call tabulate_lines(motion, runs(1)%equation%has_vertical, case%solver%t_end, team)
      team%keeps_more = asked%is_watched
      do i = 1, width
         if (runs(i)%ordinate > 0) call join_team(lanes(i), i, team)
      end do
      call step_lanes(lanes, runs, few_lanes, team)
      do i = 1, width
         if (.not. team%is_busy(i)) cycle
         call leave_team(lanes(i), i, team, alone)
         call step_lanes(lanes(i:i), runs(i:i), 0, alone)
      end do

   contains

      !> Step until the queue is empty and no more lanes than `fewest` are busy.
      subroutine step_lanes(lanes, runs, fewest, team)
         type(lane_t), intent(inout), target :: lanes(:)
         type(lane_run_t), intent(inout), target :: runs(:)
         integer, intent(in) :: fewest
         type(team_t), intent(inout) :: team
         integer :: i

         do
            if (team%has_ended) then
               do i = 1, team%width
                  do while (team%is_busy(i) .and. .not. team%table(i, of_length) > 0)
                     call finish_ordinate(asked, control, runs(i), lanes(i)%error, &
                        ordinates(runs(i)%ordinate))
                     if (runs(i)%ordinate == 0) call take_ordinate(case, asked, motion, control, &
                        next, ordinates, runs(i), lanes(i))
                     team%is_busy(i) = runs(i)%ordinate > 0
                     if (team%is_busy(i)) call join_team(lanes(i), i, team)
                  end do
               end do
               if (count(team%is_busy) <= fewest) return
               team%has_ended = .false.
            end if
            if (is_cancelled(control)) return
            call step_team(lanes, team)
         end do
      end subroutine step_lanes
   end subroutine run_team

   !> Take the next ordinate from the queue and begin its run; none: the lane stays idle.
   subroutine take_ordinate(case, asked, motion, control, next, ordinates, run, lane)
      type(case_t), intent(in) :: case
      type(asked_t), intent(in) :: asked
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      integer, intent(inout) :: next
      type(ordinate_t), intent(in) :: ordinates(:)
      type(lane_run_t), intent(inout), target :: run
      type(lane_t), intent(inout) :: lane
      integer :: number

      run%ordinate = 0
      if (is_cancelled(control)) return
      !$omp atomic capture
      next = next + 1
      number = next
      !$omp end atomic
      if (number > size(ordinates)) return
      run%ordinate = number
      run%case%structure_t = case%structure_t
      run%case%solver = case%solver
      if (ordinates(number)%rtol > 0) run%case%solver%rtol = ordinates(number)%rtol
      if (allocated(asked%output)) run%case%output = asked%output
      call set_axes(run%case, ordinates(number)%T_s, ordinates(number)%gamma, ordinates(number)%b)
      lane%equation => run%equation
      lane%hybrid => run%hybrid
      lane%recorder => run%recorder
      lane%integrator => run%integrator
      lane%t_end = case%solver%t_end
      call build_equation(run%case, motion, run%equation)
      run%size_guess = guess_size(run%case, run%equation)
      run%pass = 1
      call begin_lane(run, lane%error)
   end subroutine take_ordinate

   !> Begin the run of a lane for its expected size.
   subroutine begin_lane(run, error)
      type(lane_run_t), intent(inout), target :: run
      type(error_t), allocatable, intent(out) :: error

      run%integrator%pair = pair_for(run%case, run%equation)
      call begin_run(run%case, run%size_guess, run%equation, run%integrator, run%hybrid, &
         run%recorder, error)
   end subroutine begin_lane

   !> The pair for a tolerance, unless the case names it; of runs at several tolerances the higher
   !> order. The local errors of smooth hysteresis add up, so that it gets that as well.
   pure type(pair_t) function pair_for(case, equation) result(pair)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation

      if (case%solver%rtol < 1.0e-8_wp .or. equation%has_loading_direction &
          .or. equation%floors%n > 1 .or. case%solver%method == 'dop853' &
          .or. allocated(case%solver%accuracy)) then
         pair = dormand_prince_853()
      else
         pair = verner_65()
      end if
   end function pair_for

   !> The run of a lane is over: keep its result, or run it again for a smaller response.
   subroutine finish_ordinate(asked, control, run, error, ordinate)
      type(asked_t), intent(in) :: asked
      type(control_t), intent(in) :: control
      type(lane_run_t), intent(inout), target :: run
      type(error_t), allocatable, intent(inout) :: error
      !! that ended the run
      type(ordinate_t), intent(inout) :: ordinate
      real(wp) :: size_found(2)

      ordinate%rhs_evaluations = ordinate%rhs_evaluations + run%equation%rhs_evaluations &
         + run%integrator%pair%stages*run%integrator%steps
      if (.not. allocated(error)) then
         call finish_recorder(run%recorder, run%equation, run%hybrid%t, run%hybrid%y, &
            run%hybrid%mode == mode_rest)
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
            call begin_lane(run, error)
            return
         end if
         if (.not. asked%is_displacement) call report(asked, run, ordinate)
      else
         ordinate%failure = error%name
         deallocate (error)
      end if
      call count_done(control)
      run%ordinate = 0
   end subroutine finish_ordinate

   !> All that is asked for, as a run reports it.
   subroutine report(asked, run, ordinate)
      type(asked_t), intent(in) :: asked
      type(lane_run_t), intent(inout) :: run
      type(ordinate_t), intent(inout) :: ordinate
      type(result_t) :: result

      ! its warnings are no quantities
      allocate (result%warnings(0))
      call fill_result(run%case, run%equation, run%hybrid, run%recorder, result)
      if (.not. allocated(ordinate%values)) allocate (ordinate%values(size(asked%place)))
      call take_values(asked, run%case, result, ordinate%values)
   end subroutine report

end module rwmf_spectrum_lanes
