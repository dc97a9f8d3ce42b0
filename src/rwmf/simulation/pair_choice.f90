!> Runge-Kutta pair for a tolerance.
module rwmf_simulation_pair_choice
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_pairs, only: dormand_prince_853, pair_t, tsitouras_papakostas_64, &
      tsitouras_papakostas_75
   use rwmf_model_assembly, only: equation_t
   use rwmf_motion_ground_motion, only: is_piecewise_linear
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: pair_for

contains

   !> Runge-Kutta pair for a tolerance, unless the case names one.
   !>
   !> Some runs need the highest order: runs at several tolerances, motions without knots that limit
   !> the steps, and laws with a corner. Frames without a wall need it, too, because they accumulate
   !> the errors of many steps. For the same reason smooth hysteresis gets at least one order more.
   pure type(pair_t) function pair_for(case, equation) result(pair)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation

      if (case%solver%rtol < 1.0e-11_wp .or. case%solver%method == 'dop853' &
          .or. allocated(case%solver%accuracy) &
          .or. .not. is_piecewise_linear(equation%motion) .or. equation%creep > 0 &
          .or. .not. equation%has_wall) then
         pair = dormand_prince_853()
      else if (case%solver%rtol < 1.0e-8_wp .or. equation%has_loading_direction &
               .or. equation%floors%n > 1) then
         pair = tsitouras_papakostas_75()
      else
         pair = tsitouras_papakostas_64()
      end if
   end function pair_for

end module rwmf_simulation_pair_choice
