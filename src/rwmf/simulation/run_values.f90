!> Result of a run from its recorder, its last state and its case.
module rwmf_simulation_run_values
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_tendon, only: has_tendon
   use rwmf_model_elements, only: tendon_strain
   use rwmf_model_equation, only: cable_force_at, discrete_state_t, frame_displacement
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_floors_yielding_storeys, only: storey_residuals
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_residual
   use rwmf_model_hysteresis_spring_set, only: broken_tendons, frame_residual, frame_residuals, &
      prestress_loss
   use rwmf_model_impact_rule, only: balanced_restitution
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_energy, only: dissipates_hysteretically
   use rwmf_problem_case, only: case_t
   use rwmf_problem_frame_strength, only: has_strength, storey_strengths, &
      storeys_have_strengths, yield_displacement
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: clear, put, values_t
   use rwmf_simulation_recorder_demand_extremes, only: put_demand_extremes
   use rwmf_simulation_recorder_element_demands, only: coupling_ratio, has_places, resting_uplift
   use rwmf_simulation_recorder_energy_balance, only: put_balance
   use rwmf_simulation_recorder_force_envelopes, only: put_envelope_extremes
   use rwmf_simulation_recorder_reaction_extremes, only: put_reaction_extremes
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_state_hybrid_state, only: has_ended, hybrid_t, mode_collapsed, &
      mode_overturned
   use rwmf_simulation_state_result, only: complete_values, result_t
   use rwmf_simulation_static_rest, only: come_to_rest
   implicit none
   private

   public :: fill_result

contains

   !> Fill the components and values of the result that apply to the scene.
   subroutine fill_result(case, equation, hybrid, recorder, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(inout) :: recorder
      !! complete; without its history on return
      type(result_t), intent(inout) :: result
      integer :: i

      result%counts_t = recorder%counts_t
      result%has_impacts = equation%has_impacts
      result%overturned = hybrid%mode == mode_overturned
      result%has_collapsed = hybrid%mode == mode_collapsed
      result%rhs_evaluations = equation%rhs_evaluations
      result%t_end = hybrid%t
      result%final_state = hybrid%y
      if (equation%has_frame) result%u_s_max = recorder%u_max
      if (equation%has_wall) result%theta_max = recorder%theta_max
      if (equation%has_wall) result%theta_min = recorder%theta_min
      associate (values => result%values)
         ! an earlier pass at coarser tolerances has left its own
         call clear(values)
         if (equation%has_frame) then
            call put(values, id%u_s_max_m, recorder%u_max)
            call put(values, id%t_u_s_max_s, recorder%t_u_max)
         end if
         if (allocated(recorder%top)) call put(values, id%tip_deflection_max_m, recorder%top(2))
         if (equation%has_wall) call put_wall(case, equation, hybrid, recorder, values)
         ! put the losses of the tendon, and the rotation in which springs may hold the wall
         if (dissipates_hysteretically(equation)) then
            if (has_tendon(case)) then
               call put(values, id%cable_prestress_loss_over_m_w_g, sum([(prestress_loss(equation, &
                  equation%elements(i), hybrid%y(1)), i=1, size(case%cable%eta_0))]))
               call put(values, id%cable_ruptured, broken_tendons(equation%state) > 0)
            end if
            if (equation%may_hold) call put(values, id%theta_end_over_alpha, hybrid%y(1) &
               /equation%p%alpha)
         end if
         if (has_strength(case)) call put_yielding(case, equation, hybrid, recorder, values)
         if (hybrid%drifts > 0) call put(values, id%collapsed, result%has_collapsed)
         if (result%has_collapsed) call put(values, id%t_collapse_s, hybrid%t)
         if (allocated(recorder%forces)) call put_reactions(case, equation, recorder, values)
         if (allocated(recorder%demands)) call put_demand_extremes(values, recorder%demands, &
            equation, recorder%u_max, recorder%t_u_max)
         if (allocated(recorder%envelopes)) call put_envelope_extremes(values, &
            recorder%envelopes, equation, [recorder%theta_min, recorder%theta_max], hybrid%y)
         if (equation%has_frame) call put_rest(case, equation, hybrid, recorder, values)
         if (recorder%keeps_energy) call put_balance(values, recorder%energy)
      end associate
      call complete_values(case, result)
      if (recorder%keeps_history) then
         call move_alloc(recorder%events, result%events)
         call move_alloc(recorder%history, result%history)
      end if
   end subroutine fill_result

   !> Put the maxima of the wall, its velocity factors and what its elements give at rest.
   subroutine put_wall(case, equation, hybrid, recorder, values)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(values_t), intent(inout) :: values
      real(wp) :: uplift(2)

      call put(values, id%theta_max_over_alpha, max(recorder%theta_max, -recorder%theta_min) &
         /equation%p%alpha)
      call put(values, id%theta_dot_max_rad_s, max(recorder%theta_dot_max, &
         recorder%theta_dot_ends))
      if (equation%has_impacts) then
         ! a velocity-dependent table has no single factor
         if (.not. allocated(hybrid%restitution%speed)) call put(values, id%e, &
            hybrid%restitution%e)
         call put(values, id%e_max, balanced_restitution(case, equation%p%alpha))
      end if
      if (equation%beam%n > 0) then
         call put(values, id%mode_i_damping_contact, equation%beam%ratios(:, 1))
         call put(values, id%mode_i_damping_rocking, equation%beam%ratios(:, 2))
      end if
      if (equation%has_cable) call put(values, id%cable_force_increment_max_over_m_w_g, &
         largest_increment(equation, recorder))
      if (equation%has_impacts .and. (equation%walls > 1 .or. has_places(equation))) then
         uplift = resting_uplift(equation)
         call put(values, id%uplift_right_g, uplift(1))
         call put(values, id%uplift_left_g, uplift(2))
      end if
      if (.not. allocated(case%coupling)) return
      if (allocated(case%coupling%eta_y)) call put(values, id%coupling_ratio, coupling_ratio(case))
   end subroutine put_wall

   !> Maximum of P/(m_w g) - eta_0: the force is monotone in |theta| on each side [-].
   real(wp) function largest_increment(equation, recorder) result(increment)
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(in) :: recorder

      if (recorder%follows_cable) then
         increment = recorder%cable_max - equation%p%eta_0
         return
      end if
      increment = -huge(increment)
      if (recorder%theta_max >= 0) increment = max(cable_force_at(equation, recorder%theta_max, &
         1), cable_force_at(equation, max(0.0_wp, recorder%theta_min), 1))
      if (recorder%theta_min <= 0) increment = max(increment, cable_force_at(equation, &
         recorder%theta_min, -1), cable_force_at(equation, min(0.0_wp, recorder%theta_max), -1))
      increment = increment - equation%p%eta_0
   end function largest_increment

   !> Put ductilities and residual displacements of a frame that yields.
   !>
   !> If a straight line links all storeys to the roof, the residual displacement of the roof gives
   !> their shares. Storeys that yield together keep their shares as well.
   subroutine put_yielding(case, equation, hybrid, recorder, values)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(values_t), intent(inout) :: values
      real(wp), allocatable :: drifts(:), ductility(:)
      !! (storeys) residual drifts [-], ductilities [-]
      real(wp) :: u
      !! residual displacement of the roof [m]

      if (equation%floors%yields) then
         u = sum(storey_residuals(equation, hybrid%y))
      else if (equation%has_loading_direction) then
         u = bouc_wen_residual(equation, hybrid%y)
      else
         u = frame_residual(equation, hybrid%y(1))
      end if
      call put(values, id%residual_displacement_m, u)
      if (storeys_have_strengths(case)) then
         associate (height => case%frame%floors%height)
            if (equation%floors%yields) then
               if (allocated(recorder%drifts)) ductility = recorder%drifts/storey_strengths(case)
               drifts = storey_residuals(equation, hybrid%y)/height
            else
               ductility = recorder%u_max*(height/sum(height))/storey_strengths(case)
               drifts = frame_residuals(equation, hybrid%y(1))/sum(height)
            end if
         end associate
         call put(values, id%storey_i_residual_drift, drifts)
         if (allocated(ductility)) call put(values, id%storey_i_ductility, ductility)
      else
         ductility = [recorder%u_max/yield_displacement(case)]
      end if
      if (allocated(ductility)) call put(values, id%ductility, maxval(ductility))
      if (.not. allocated(recorder%demands)) return
      associate (building => recorder%demands%building)
         if (building%roof_height > 0) call put(values, id%roof_residual_drift, &
            u/building%roof_height)
         if (.not. allocated(drifts) .and. building%drifts > 0) drifts = u*building%bend &
            /building%height
      end associate
      if (allocated(drifts)) call put(values, id%storey_residual_drift_max, maxval(abs(drifts)))
   end subroutine put_yielding

   !> Put the reactions, drifts over the wall's height, and the demands on the cable.
   subroutine put_reactions(case, equation, recorder, values)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(in) :: recorder
      type(values_t), intent(inout) :: values
      real(wp) :: force, strain, largest
      integer :: i

      call put_reaction_extremes(values, recorder%forces, equation, recorder%theta_min, &
         recorder%theta_max, recorder%u_max)
      if (allocated(recorder%top)) call put(values, id%wall_drift_max, recorder%top(3))
      if (.not. equation%has_cable) return
      force = equation%p%eta_0 + largest_increment(equation, recorder)
      call put(values, id%tendon_force_max_over_m_w_g, force)
      if (allocated(case%cable%area)) then
         if (size(case%cable%area) == 1) call put(values, id%tendon_stress_max_Pa, force &
            *case%unit_mass*equation%p%g/case%cable%area(1))
      end if
      largest = -huge(largest)
      do i = 1, size(case%cable%eta_0)
         if (.not. equation%elements(i)%length > 0) return
         strain = max(tendon_strain(equation%elements(i), recorder%theta_max), &
            tendon_strain(equation%elements(i), recorder%theta_min))
         if (allocated(case%cable%rupture_strain)) strain = min(strain, &
            case%cable%rupture_strain(i))
         largest = max(largest, strain)
      end do
      call put(values, id%tendon_strain_max, largest)
   end subroutine put_reactions

   !> Put the drifts in static equilibrium after the motion, if yielding can leave the frame
   !> displaced.
   subroutine put_rest(case, equation, hybrid, recorder, values)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(values_t), intent(inout) :: values
      type(discrete_state_t) :: state
      real(wp) :: y(equation%n), u
      real(wp) :: d(equation%floors%n_storeys), d_dot(equation%floors%n_storeys)
      logical :: of_roof, is_found

      if (has_ended(hybrid)) return
      of_roof = allocated(recorder%demands) .and. (has_strength(case) .or. equation%may_hold)
      if (of_roof) of_roof = recorder%demands%building%roof_height > 0
      if (.not. (storeys_have_strengths(case) .or. of_roof)) return
      state = equation%state
      y = hybrid%y
      call come_to_rest(equation%model_t, state, hybrid%overturning_angle, y, is_found)
      if (.not. is_found) return
      u = frame_displacement(equation, state%side, y)
      if (of_roof) call put(values, id%roof_residual_drift_at_rest, &
         u/recorder%demands%building%roof_height)
      if (.not. storeys_have_strengths(case)) return
      associate (heights => case%frame%floors%height)
         if (equation%floors%yields) then
            call storey_motion(equation, state%side, y, d, d_dot)
            call put(values, id%storey_i_residual_drift_at_rest, d/heights)
         else
            call put(values, id%storey_i_residual_drift_at_rest, spread(u/sum(heights), 1, &
               size(heights)))
         end if
      end associate
   end subroutine put_rest

end module rwmf_simulation_run_values
