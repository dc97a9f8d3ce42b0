!> Steps of the hybrid system: rest, rocking on either corner, overturned or collapsed.
!>
!> Between events an integrator solves the equation of motion for one side and one interval of the
!> ground motion. The event search (`step_events`) covers each of its steps, so that it also finds
!> two impacts in one step, or a peak and an impact. The hybrid state stores the side of a flight,
!> so that a start at theta = 0 is no event.
module rwmf_simulation_hybrid_hybrid_loop
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_model_drift_limits, only: count_drifts
   use rwmf_model_hysteresis_bouc_wen, only: load_bouc_wen
   use rwmf_model_hysteresis_spring_set, only: load_to, reset_springs
   use rwmf_model_system_assembly, only: enter_interval, enter_side, equation_t, interval_of, &
      second_derivative
   use rwmf_model_system_lift_off, only: find_uplift_capacity, find_lift_off, &
      find_uplift_acceleration
   use rwmf_model_system_rest_after_chatter, only: release_wall
   use rwmf_motion_ground_motion, only: fastest_rate, interval_at, interval_end, is_curved
#ifndef RWMF_QUAD
   use rwmf_paper_paper_run, only: paper_t
   use rwmf_simulation_hybrid_paper_step, only: follow_paper_step
#endif
   use rwmf_simulation_events_drift_events, only: has_collapsed
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_wall_support, only: check_support
   use rwmf_simulation_events_held_wall_lift_off, only: side_pulled
   use rwmf_simulation_events_step_view, only: step_view_t, view_step
   use rwmf_simulation_events_storey_events, only: start_storeys
   use rwmf_simulation_hybrid_elastic_chatter, only: skip_chatter
   use rwmf_simulation_hybrid_free_vibration, only: follow_free_vibration
   use rwmf_simulation_hybrid_step_events, only: search_step
   use rwmf_simulation_hybrid_transitions, only: apply_event, begin_piece, enter_rest, lift_off, &
      negligible
   use rwmf_simulation_recorder_recorder, only: observe_piece, observe_rest, recorder_t, sees_rest
   use rwmf_simulation_state_hybrid_state, only: advance_interval, check_creep, check_progress, &
      count_steps, creep_t, has_ended, hybrid_t, mode_collapsed, mode_held, mode_no_impacts, &
      mode_overturned, mode_rest, mode_rocking, progress_t
   use rwmf_simulation_state_result, only: event_lift_off
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: start_hybrid, advance_hybrid, begin_step, end_step, stay_at_rest, check_steps

contains

   !> Start the hybrid system at time t with the state y.
   subroutine start_hybrid(hybrid, equation, t, y)
      type(hybrid_t), intent(inout) :: hybrid
      !! hybrid system with restitution, overturning_angle, rtol and max_steps set
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)

      hybrid%t = t
      hybrid%y = y
      hybrid%must_restart = .true.
      hybrid%t_turn = -huge(t)
      hybrid%drifts = count_drifts(equation)
      call watch_creep(hybrid, equation)
      call enter_interval(equation%model_t, equation%state, interval_at(equation%motion, t))
      call count_steps(hybrid, equation)
      call enter_side(equation%model_t, equation%state, 1)
      call release_wall(equation%state)
      equation%state%signs%loading_direction = 1
      if (equation%has_impacts) then
         if (y(1) < 0 .or. (abs(y(1)) <= 0 .and. y(2) < 0)) call enter_side(equation%model_t, &
            equation%state, -1)
      end if
      call reset_springs(equation%model_t, equation%state)
      call load_to(equation%model_t, equation%state, y(1))
      ! Start smooth hysteresis without previous motion at the initial rotation. From rest, the
      ! acceleration gives the loading direction.
      if (equation%has_loading_direction .and. abs(y(1)) > 0) then
         call load_bouc_wen(equation, hybrid%y)
         equation%state%signs%loading_direction = 1
         if (abs(hybrid%y(2)) <= 0) equation%state%signs%loading_direction = int(sign(1.0_wp, &
            second_derivative(equation, hybrid%t, hybrid%y)))
      end if
      call start_storeys(equation%model_t, equation%state, y)
      if (.not. equation%has_impacts) then
         hybrid%mode = mode_no_impacts
         if (has_collapsed(equation, hybrid%drifts, y)) hybrid%mode = mode_collapsed
         return
      end if
      call find_uplift_acceleration(equation%model_t, equation%state, y)
      hybrid%mode = mode_rocking
      if (all(abs(y(:2)) <= 0)) call enter_rest(hybrid, equation)
      if (has_collapsed(equation, hybrid%drifts, y)) hybrid%mode = mode_collapsed
      if (abs(y(1)) >= hybrid%overturning_angle) hybrid%mode = mode_overturned
   end subroutine start_hybrid

   !> Prepare the count of the steps of a wall with nonlinear dampers.
   pure subroutine watch_creep(hybrid, equation)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: short = 1.0e-3_wp
      !! part of the time unit of the wall in which a wall that moves needs far fewer steps [-]
      integer :: i

      hybrid%creep = creep_t(t=hybrid%t)
      if (.not. equation%creep > 0) return
      do i = 1, size(equation%effects)
         associate (effect => equation%effects(i))
            if (effect%has_corner_at_turn) hybrid%creep%exponent = effect%constants(1)
         end associate
      end do
      hybrid%creep%shortest = short/sqrt(equation%p%g_over_R)
   end subroutine watch_creep

   !> Integrate the system up to t_target, overturning or collapse.
   subroutine advance_hybrid(hybrid, equation, integrator, recorder, t_target, control, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error
      !! as `advance`

      hybrid%progress = progress_t()
      do while (hybrid%t < t_target .and. .not. (has_ended(hybrid) .or. hybrid%is_stopped))
         if (hybrid%mode == mode_rest) then
            call stay_at_rest(hybrid, equation, recorder, t_target, error)
         else
            select type (integrator)
#ifndef RWMF_QUAD
            type is (paper_t)
               call follow_paper_step(hybrid, equation, integrator, recorder, t_target, error)
#endif
            class default
               call integrate_step(hybrid, equation, integrator, recorder, t_target, error)
            end select
         end if
         if (allocated(error)) return
         ! check the number of steps, the progress in time and the caller's request to stop
         call check_progress(hybrid%progress, size(hybrid%y), hybrid%t, error)
         if (.not. allocated(error)) call check_steps(hybrid, integrator, control, error)
         if (allocated(error)) return
      end do
   end subroutine advance_hybrid

   !> Check the number of steps, the advance of a creeping wall and the caller's request to stop.
   subroutine check_steps(hybrid, integrator, control, error)
      type(hybrid_t), intent(inout) :: hybrid
      class(integrator_t), intent(in) :: integrator
      type(control_t), intent(in) :: control
      type(error_t), allocatable, intent(out) :: error
      !! as `check_work`

      call check_creep(hybrid%creep, integrator%steps, hybrid%t, error)
      if (allocated(error)) return
      if (.not. is_cancelled(control) .and. integrator%steps <= hybrid%max_steps) return
      if (is_cancelled(control)) then
         call fail(error, err_interrupt, 'interrupted at t = '//trim(real_to_text(hybrid%t))//' s')
      else
         call fail(error, err_numerical, 'more than &solver max_steps steps by t = ' &
            //trim(real_to_text(hybrid%t))//' s, theta = '//trim(real_to_text(hybrid%y(1))) &
            //': raise max_steps or rtol, or shorten t_end', 'too_many_steps')
      end if
   end subroutine check_steps

   !> Keep the wall at rest until the ground motion lifts it.
   subroutine stay_at_rest(hybrid, equation, recorder, t_target, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps
      real(wp) :: t_begin
      real(wp) :: t_limit
      integer :: interval
      integer :: side

      side = 0
      interval = interval_of(equation)
      do while (side == 0 .and. hybrid%t < t_target)
         t_begin = hybrid%t
         t_limit = t_target
         ! Advance interval by interval if history or reactions show the ground motion.
         if (sees_rest(recorder)) t_limit = min(t_target, interval_end(equation%motion, interval))
         call find_lift_off(equation, t_limit, hybrid%t, interval, side)
         ! A motion that begins with a jump lifts the wall at once, without any rest.
         if (hybrid%t > t_begin) call observe_rest(recorder, equation, hybrid%y, t_begin, hybrid%t)
         call enter_interval(equation%model_t, equation%state, interval)
      end do
      if (side /= 0) call lift_off(hybrid, equation, recorder, side, error)
   end subroutine stay_at_rest

   !> Take one step of the integrator and end it at the first event.
   subroutine integrate_step(hybrid, equation, integrator, recorder, t_target, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: t_limit
      real(wp) :: span

      call begin_step(hybrid, equation, recorder, integrator%steps, t_target, t_limit, span, error)
      if (allocated(error) .or. t_limit <= hybrid%t) return
      if (hybrid%must_restart) then
         ! Below the absolute tolerance, a multistep method may take its first step over several
         ! periods of a vibration. The end of such a step contradicts the rates at its beginning. A
         ! frame that has just turned would then turn again at once, without end.
         if (equation%floors%yields .or. equation%has_loading_direction) span = min(span, &
            1/max(equation%p%omega_s, equation%floors%max_frequency))
         call integrator%start(hybrid%t, hybrid%y, span, error)
         if (allocated(error)) return
      end if
      hybrid%must_restart = .false.
      t_limit = min(t_limit, hybrid%t + longest_step(equation))
      call integrator%step(t_limit, error)
      if (.not. allocated(error)) call end_step(hybrid, equation, integrator, recorder, error)
   end subroutine integrate_step

   !> Longest step under a pulse far shorter than the periods of the scene, else no limit [s].
   !>
   !> Such a pulse leaves much less velocity than its largest value. The tolerance is relative to
   !> the largest value, so long steps could lose all of the remaining velocity.
   pure real(wp) function longest_step(equation) result(longest)
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: short = 10
      !! ratio of the pulse's rate to the frequencies of the scene [-]
      real(wp), parameter :: angle = 0.1_wp
      !! phase angle of the pulse per step [rad]
      real(wp) :: rate

      longest = huge(longest)
      rate = fastest_rate(equation%motion)
      if (rate <= short*max(equation%p%omega_s, equation%floors%max_frequency)) return
      if (equation%has_wall) then
         if (rate <= short*sqrt(equation%p%g_over_R)) return
      end if
      if (is_curved(equation%motion, interval_of(equation))) longest = angle/rate
   end function longest_step

   !> Prepare the next step: its limit, and the discrete state if a new piece of motion begins.
   subroutine begin_step(hybrid, equation, recorder, steps, t_target, t_limit, span, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(recorder_t), intent(inout) :: recorder
      integer(i8), intent(in) :: steps
      !! number of steps of the integrator so far
      real(wp), intent(in) :: t_target
      !! [s]
      real(wp), intent(out) :: t_limit
      !! limit of the step; equals the current time if a held wall lifts off or a knot is passed [s]
      real(wp), intent(out) :: span
      !! expected time until the motion changes its course, if a new piece begins [s]
      type(error_t), allocatable, intent(out) :: error
      !! the wall jumps
      integer :: side

      span = huge(span)
      if (hybrid%mode == mode_held) then
         t_limit = hybrid%t
         side = side_pulled(equation, hybrid%t, hybrid%y)
         if (side /= 0) call lift_off(hybrid, equation, recorder, side, error)
         if (side /= 0) return
      end if
      t_limit = min(t_target, interval_end(equation%motion, interval_of(equation)))
      if (hybrid%must_restart) call skip_chatter(hybrid, equation, recorder, &
         negligible*hybrid%rtol*max(recorder%theta_max, -recorder%theta_min), t_limit)
      call follow_free_vibration(hybrid, equation, recorder, t_target, t_limit)
      if (t_limit - hybrid%t <= 8*epsilon(t_limit)*t_limit) then
         ! An event within round-off of a knot: the remaining interval is too short for a step.
         hybrid%flight = 0
         hybrid%t = t_limit
         call advance_interval(hybrid, equation, steps)
         return
      end if
      if (hybrid%must_restart) call begin_piece(hybrid, equation, span)
      if (hybrid%mode == mode_held) call find_uplift_capacity(equation%model_t, equation%state)
   end subroutine begin_step

   !> Search the integrator's last step and apply its first event.
   subroutine end_step(hybrid, equation, integrator, recorder, error)
      type(hybrid_t), intent(inout), target :: hybrid
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout), target :: integrator
      type(recorder_t), intent(inout) :: recorder
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails, the wall jumps or rests on its fuses
      type(ending_t) :: ending
      type(step_view_t) :: step

      call view_step(step, equation, integrator)
      call search_step(hybrid, step, recorder, ending, error)
      if (allocated(error)) return
      step%t_b = hybrid%t
      step%y_b => hybrid%y
      if (equation%may_hold) call check_support(equation, step, error)
      if (allocated(error)) return
      ! A motion that jumps at the start of the step lifts a held wall at once, without any rest.
      if (ending%kind /= event_lift_off .or. step%t_b > step%t_a) call observe_piece(recorder, &
         step, error)
      if (allocated(error)) return
      call apply_event(hybrid, equation, recorder, ending, error)
      if (allocated(error)) return
      ! Without an event, the flight continues with the next step.
      call advance_interval(hybrid, equation, integrator%steps)
   end subroutine end_step

end module rwmf_simulation_hybrid_hybrid_loop
