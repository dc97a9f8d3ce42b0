!> Check of the energy ledger of a scene.
module ledgers
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_result, only: result_t
   implicit none
   private

   public :: check_ledger

contains

   !> Run a case and check initial + input = stored + viscous + hysteretic + impact.
   subroutine check_ledger(checks, scene, rtol, name, result)
      type(checks_t), intent(inout) :: checks
      type(case_t), intent(in) :: scene
      real(wp), intent(in) :: rtol
      !! allowed difference over the largest input [-]
      character(*), intent(in) :: name
      !! of both checks, for the run and for the ledger
      type(result_t), intent(out) :: result

      type(case_t) :: case
      type(error_t), allocatable :: error

      case = scene
      if (.not. allocated(case%output)) allocate (case%output)
      case%output%energy = .true.
      call simulate(case, result, error)
      call checks%no_error(error, name)
      associate (ledger => result%energy)
         call checks%close_to(ledger%final + ledger%viscous + ledger%hysteretic + ledger%impact, &
            ledger%initial + ledger%input, name, atol=rtol*ledger%input_max)
      end associate
   end subroutine check_ledger

end module ledgers
