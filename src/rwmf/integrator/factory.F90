!> Integrators by name.
!>
!> The quadruple-precision build has only the project's own integrators: SUNDIALS computes in double
!> precision.
module rwmf_integrator_factory
   use rwmf_integrator_explicit_pair, only: explicit_pair_t
   use rwmf_integrator_extrapolation, only: extrapolation_t
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_integrator_pairs, only: dormand_prince_853
   use rwmf_integrator_taylor, only: taylor_t
#ifndef RWMF_QUAD
   use rwmf_integrator_sundials_cvode, only: cvode_t
   use rwmf_integrator_sundials_arkode, only: erk_t
#endif
   implicit none
   private

   public :: new_integrator, run_method, spectrum_method

contains

   !> Method of a single run; 'auto' selects the most accurate one for its time
   !> (docs/developer/decisions.md).
   pure function run_method(method) result(name)
      character(*), intent(in) :: method
      !! value of the case
      character(16) :: name

      name = method
      if (method == 'auto' .or. method == 'fast') name = 'dop853'
   end function run_method

   !> Method of a spectrum; 'auto' is the pair for its tolerance, 'fast' a synonym.
   pure function spectrum_method(method) result(name)
      character(*), intent(in) :: method
      !! value of the case
      character(16) :: name

      name = method
      if (method == 'fast') name = 'auto'
   end function spectrum_method

   !> Create the integrator of `&solver method`.
   subroutine new_integrator(method, integrator)
      character(*), intent(in) :: method
      !! 'auto', 'adams', 'bdf', 'erk54', 'dop853', 'extrapolation' or 'fast'
      class(integrator_t), allocatable, intent(out) :: integrator

      select case (run_method(method))
      case ('taylor')
         allocate (taylor_t :: integrator)
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
      case ('erk54')
         allocate (erk_t :: integrator)
#endif
      case default
         allocate (extrapolation_t :: integrator)
      end select
   end subroutine new_integrator

end module rwmf_integrator_factory
