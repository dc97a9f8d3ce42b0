!> A storey of the frame enters another branch, while the wall moves or rests.
module rwmf_storey_change
   use rwmf_equation, only: equation_t
   use rwmf_observer, only: observe_event, observe_state, observer_t
   use rwmf_regime, only: hybrid_t
   use rwmf_result, only: event_branch
   use rwmf_storey_search, only: end_branch, storey_end_t
   implicit none
   private

   public :: change_storey

contains

   !> The branch of a storey ends at the present state.
   subroutine change_storey(hybrid, equation, observer, ending)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(inout) :: equation
      type(observer_t), intent(inout) :: observer
      type(storey_end_t), intent(in) :: ending

      call observe_state(observer, equation, hybrid%t, hybrid%y)
      call end_branch(equation, ending, hybrid%y)
      if (.not. allocated(equation%floors%laws)) call observe_event(observer, event_branch, &
         hybrid%t, hybrid%y)
      hybrid%must_restart = .true.
   end subroutine change_storey

end module rwmf_storey_change
