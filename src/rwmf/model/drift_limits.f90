!> Drifts with limits that end a run: values that the effects of a scene provide, in their order.
module rwmf_model_drift_limits
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t
   implicit none
   private

   public :: count_drifts, drift_ratios

contains

   !> Number of drifts with limits; 0 means the scene cannot collapse.
   pure integer function count_drifts(equation) result(n)
      type(equation_t), intent(in) :: equation

      n = 0
      if (allocated(equation%effects)) n = sum(equation%effects%drifts)
   end function count_drifts

   !> Compute the ratios of all drifts to their limits, and the rates of these ratios.
   subroutine drift_ratios(equation, y, ratio, rate)
      type(equation_t), intent(in) :: equation
      !! with effects that limit a drift
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: ratio(:)
      !! (drifts) with the sign of the drift; beyond -1 or 1 the scene collapses [-]
      real(wp), intent(out) :: rate(:)
      !! (drifts) [1/s]
      integer :: i, n

      n = 0
      do i = 1, size(equation%effects)
         associate (effect => equation%effects(i))
            if (effect%drifts == 0) cycle
            call effect%put_drifts(effect, equation, y, ratio(n + 1:n + effect%drifts), &
               rate(n + 1:n + effect%drifts))
            n = n + effect%drifts
         end associate
      end do
   end subroutine drift_ratios

end module rwmf_model_drift_limits
