!> Integrators by name.
!>
!> The quadruple-precision build has only the project's own integrators: SUNDIALS computes in double
!> precision.
module rwmf_simulation_factory
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_integrator_pairs, only: dormand_prince_853
   use rwmf_integrator_taylor, only: taylor_t
#ifndef RWMF_QUAD
   use rwmf_integrator_sundials_cvode, only: cvode_t
   use rwmf_paper_paper_run, only: paper_t
#endif
   implicit none
   private

   public :: all_methods, old_methods, current_method, new_integrator, run_method

   character(*), parameter :: all_methods = 'auto taylor adams bdf dop853 paper'
   !! values of `&solver method`; `run_method` and spectra define 'auto'
   character(*), parameter :: old_methods = 'fast erk54 extrapolation'
   !! former values, which still select 'auto'

contains

   !> Current value for a value of `&solver method`.
   pure function current_method(word) result(name)
      character(*), intent(in) :: word
      !! one of `all_methods` or `old_methods`
      character(len(word)) :: name

      name = word
      if (index(' '//old_methods//' ', ' '//trim(word)//' ') > 0) name = 'auto'
   end function current_method

   !> Method of a single run; 'auto' selects the most accurate one for its time
   !> (docs/developer/decisions.md).
   pure function run_method(method) result(name)
      character(*), intent(in) :: method
      !! value of the case
      character(16) :: name

      name = method
      if (method == 'auto') name = 'dop853'
   end function run_method

   !> Create the integrator of `&solver method`.
   subroutine new_integrator(method, integrator)
      character(*), intent(in) :: method
      !! one of `all_methods`
      class(integrator_t), allocatable, intent(out) :: integrator

      select case (run_method(method))
      case ('dop853')
         allocate (explicit_pair_t :: integrator)
         select type (integrator)
         type is (explicit_pair_t)
            integrator%pair = dormand_prince_853()
         end select
#ifndef RWMF_QUAD
      case ('adams', 'bdf')
         allocate (cvode_t :: integrator)
         select type (integrator)
         type is (cvode_t)
            integrator%is_stiff = method == 'bdf'
         end select
      case ('paper')
         allocate (paper_t :: integrator)
#endif
      case default
         allocate (taylor_t :: integrator)
      end select
   end subroutine new_integrator

end module rwmf_simulation_factory
