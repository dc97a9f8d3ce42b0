!> Steps of the paper's procedure (`rwmf_paper_paper_run`) in the hybrid loop.
module rwmf_simulation_hybrid_paper_step
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: equation_t, interval_of
   use rwmf_model_system_reactions, only: impulse_from_rest
   use rwmf_motion_ground_motion, only: interval_end
   use rwmf_paper_paper_run, only: at_impact, at_overturning, at_peak, paper_t
   use rwmf_simulation_events_step_view, only: step_view_t, view_step
   use rwmf_simulation_recorder_reaction_extremes, only: observe_impulse
   use rwmf_simulation_recorder_recorder, only: observe_event, observe_impact, observe_piece, &
      observe_state, recorder_t, sees_impulses
   use rwmf_simulation_state_hybrid_state, only: advance_interval, hybrid_t, mode_overturned, &
      mode_rest
   use rwmf_simulation_state_result, only: event_impact, event_overturned, event_peak, event_rest
   implicit none
   private

   public :: follow_paper_step

contains

   !> Take a step, record it, and apply the event at its end.
   subroutine follow_paper_step(hybrid, equation, paper, recorder, t_target, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout), target :: equation
      type(paper_t), intent(inout), target :: paper
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(error_t), allocatable, intent(out) :: error
      !! CVODE fails, or its root search misses an impact
      type(step_view_t) :: step

      paper%scene%overturning_angle = hybrid%overturning_angle
      if (hybrid%must_restart) call paper%start(hybrid%t, hybrid%y, huge(t_target), error)
      if (allocated(error)) return
      hybrid%must_restart = .false.
      call paper%step(min(t_target, interval_end(equation%motion, interval_of(equation))), error)
      if (allocated(error)) return
      hybrid%t = paper%t1
      hybrid%y(:) = paper%y1
      call view_step(step, equation, paper)
      if (paper%t1 > paper%t0) call observe_piece(recorder, step, error)
      if (allocated(error)) return
      select case (paper%root)
      case (at_impact)
         call follow_impact(hybrid, equation, paper, recorder)
      case (at_peak)
         call observe_state(recorder, equation, hybrid%t, hybrid%y)
         call observe_event(recorder, event_peak, hybrid%t, hybrid%y)
      case (at_overturning)
         hybrid%mode = mode_overturned
         call observe_event(recorder, event_overturned, hybrid%t, hybrid%y)
      case default
         ! no event
      end select
      call advance_interval(hybrid, equation, paper%steps)
   end subroutine follow_paper_step

   !> Apply and record an impact.
   subroutine follow_impact(hybrid, equation, paper, recorder)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(paper_t), intent(inout) :: paper
      type(recorder_t), intent(inout) :: recorder
      real(wp) :: before
      !! [rad/s]
      real(wp) :: impulse(2)

      call observe_event(recorder, event_impact, hybrid%t, hybrid%y)
      before = hybrid%y(2)
      if (sees_impulses(recorder)) impulse = impulse_from_rest(equation, hybrid%t, hybrid%y)
      call paper%land(hybrid%restitution%e, hybrid%y)
      call observe_impact(recorder, equation, before, hybrid%y(2))
      if (sees_impulses(recorder)) call observe_impulse(recorder%forces, hybrid%t, &
         impulse_from_rest(equation, hybrid%t, hybrid%y) - impulse)
      hybrid%must_restart = .true.
      if (any(abs(hybrid%y) > 0)) return
      hybrid%mode = mode_rest
      call observe_event(recorder, event_rest, hybrid%t, hybrid%y)
   end subroutine follow_impact

end module rwmf_simulation_hybrid_paper_step
