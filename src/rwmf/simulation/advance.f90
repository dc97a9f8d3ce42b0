!> Advance a run: explicit pairs as a batch of one lane, other methods in the hybrid loop.
module rwmf_simulation_advance
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_simulation_hybrid_hybrid_loop, only: advance_hybrid
   use rwmf_simulation_lanes_batch, only: create_batch, tabulate_lines, batch_t
   use rwmf_simulation_lanes_loop, only: advance_lane
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t
   implicit none
   private

   public :: advance, begin_advance

contains

   !> Prepare the batch for a run that reaches t_end in one call of `advance`.
   subroutine begin_advance(hybrid, equation, integrator, t_end, batch)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      class(integrator_t), intent(in) :: integrator
      real(wp), intent(in) :: t_end
      !! [s]
      type(batch_t), intent(inout), target :: batch

      select type (integrator)
      type is (explicit_pair_t)
         call create_batch(equation, integrator%pair, hybrid%max_steps, 1, batch)
         call tabulate_lines(equation%motion, equation%has_vertical, t_end, batch)
      end select
   end subroutine begin_advance

   !> Integrate the system up to t_target, overturning or collapse.
   subroutine advance(hybrid, equation, integrator, recorder, t_target, control, batch, error)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      class(integrator_t), intent(inout) :: integrator
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      type(control_t), intent(in) :: control
      type(batch_t), intent(inout), target :: batch
      !! used by methods that step in lanes; kept from call to call
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails, the wall jumps or rests on its fuses, too many steps, or an interrupt

      select type (integrator)
      type is (explicit_pair_t)
         call advance_lane(hybrid, equation, integrator, recorder, t_target, control, batch, error)
      class default
         call advance_hybrid(hybrid, equation, integrator, recorder, t_target, control, error)
      end select
   end subroutine advance

end module rwmf_simulation_advance
