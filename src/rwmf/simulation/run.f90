!> A single run of the hybrid system at the tolerances of a valid case.
module rwmf_simulation_run
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_simulation_factory, only: new_integrator, run_method
   use rwmf_integrator_interface_integrator, only: integrator_t, tolerance_t
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_model_elements, only: tendon_strain
   use rwmf_model_system_contributions, only: state_sizes
   use rwmf_model_system_demands, only: building_t
   use rwmf_model_floors_yielding_storeys, only: storey_residuals
   use rwmf_model_effects_tendon, only: has_tendon
   use rwmf_model_equation, only: cable_force_at, discrete_state_t, frame_displacement, frame_travel
   use rwmf_model_system_energy, only: dissipates_hysteretically
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_residual
   use rwmf_model_hysteresis_spring_set, only: broken_tendons, frame_residual, frame_residuals, &
      prestress_loss
   use rwmf_model_impact_rule, only: balanced_restitution, impact_law
   use rwmf_model_system_rest_after_chatter, only: inverse_inertia
   use rwmf_motion_ground_motion, only: motion_t, peak_acceleration
   use rwmf_paper_paper_scene, only: check_paper_scene
   use rwmf_problem_case, only: case_t
   use rwmf_problem_frame_strength, only: has_strength, storey_strengths, yield_displacement, &
      storeys_have_strengths
   use rwmf_problem_quantity_table, only: all_quantities, key_length
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_simulation_base_base_run, only: run_on_base
   use rwmf_simulation_advance, only: advance, begin_advance
   use rwmf_simulation_finite_check, only: check_result
   use rwmf_simulation_hybrid_hybrid_loop, only: start_hybrid
   use rwmf_simulation_lanes_batch, only: batch_t
   use rwmf_simulation_recorder_demand_extremes, only: demand_extremes
   use rwmf_simulation_recorder_element_demands, only: coupling_ratio, has_places, resting_uplift
   use rwmf_simulation_recorder_force_envelopes, only: envelope_extremes
   use rwmf_simulation_recorder_reaction_columns, only: force_extremes
   use rwmf_simulation_recorder_recorder, only: create_recorder, finish_recorder, &
      recorder_t
   use rwmf_simulation_state_hybrid_state, only: has_ended, hybrid_t, is_at_rest, mode_collapsed, &
      mode_overturned
   use rwmf_simulation_state_result, only: result_t
   use rwmf_simulation_static_rest, only: come_to_rest
   use rwmf_simulation_warnings, only: list_case_warnings, warn_of_chatter, warn_of_grazing, &
      warn_of_reactions, warn_of_short_history, warn_of_toe
   implicit none
   private

   public :: run_once, guess_size, tolerances, initial_state
   public :: begin_run, fill_result, is_much_smaller, response_size, most_passes

   integer, parameter :: most_passes = 5

contains

   !> Integrate a case under a ground motion owned by the caller and shared by many runs.
   !>
   !> Errors: the frame has no period, or the integration fails.
   subroutine run_once(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in), target :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(equation_t), target :: equation
      class(integrator_t), allocatable :: integrator
      integer(i8) :: started, rate

      call check_single_run(case, error)
      if (allocated(error)) return
      if (case%solver%method == 'paper') call check_paper_scene(case, error)
      if (allocated(error)) return
      call system_clock(started, rate)
      if (allocated(case%compliant_base)) then
         call run_on_base(case, motion, control, result, error)
         if (allocated(error)) return
         call collect_warnings(case, motion, result)
         call check_result(case, result, error)
      else
         call build_equation(case, motion, equation)
         call new_integrator(case%solver%method, integrator)
         call repeat_until_scaled(case, equation, integrator, control, result, error)
         call integrator%destroy()
      end if
      if (allocated(result%reactions)) call warn_of_reactions(result)
      call warn_of_toe(case, result)
      call warn_of_grazing(result)
      call warn_of_chatter(result)
      call warn_of_short_history(case%solver%t_end, result)
      call measure_time(started, rate, result)
   end subroutine run_once

   !> Measure the wall-clock time of a run.
   subroutine measure_time(started, rate, result)
      integer(i8), intent(in) :: started, rate
      type(result_t), intent(inout) :: result
      integer(i8) :: finished

      call system_clock(finished)
      result%seconds = real(finished - started, wp)/real(rate, wp)
   end subroutine measure_time

   !> Integrate with absolute tolerances for an estimated size of the response.
   !>
   !> If the response is much smaller, integrate again for its true size. Tiny responses are then as
   !> accurate as large ones.
   subroutine repeat_until_scaled(case, equation, integrator, control, result, error)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout) :: integrator
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: size_guess(2)
      real(wp) :: size_found(2)
      integer :: pass

      size_guess = guess_size(case, equation)
      do pass = 1, most_passes
         call integrate(case, equation, integrator, size_guess, size_found, control, result, error)
         if (allocated(error)) return
         if (.not. is_much_smaller(case, size_found, size_guess)) return
         size_guess = merge(size_found, size_guess, size_found < 0.1_wp*size_guess)
      end do
   end subroutine repeat_until_scaled

   !> Cautious (small) first guess of the largest |theta| and |theta'| (bare frame: |u|, |u'|).
   function guess_size(case, equation) result(guess)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp) :: guess(2)
      !! [rad], [rad/s] or [m], [m/s]
      real(wp) :: rate
      !! ratio of the two sizes, an angular frequency [rad/s]
      real(wp) :: length
      !! displacement per unit of rotation [m/rad]

      length = frame_travel(equation)
      rate = sqrt(equation%p%g/equation%p%R)
      if (equation%has_frame) rate = max(2.0_wp, 2*pi/case%frame%T_s)
      guess(1) = 0.02_wp*peak_acceleration(equation%motion)/rate**2/length
      if (equation%has_wall) guess(1) = min(guess(1), 0.01_wp*equation%p%alpha)
      guess(2) = rate*guess(1)
      if (allocated(case%initial)) then
         guess(1) = max(guess(1), 0.1_wp*abs(case%initial%theta_over_alpha)*equation%p%alpha)
         guess(2) = max(guess(2), 0.1_wp*abs(case%initial%theta_dot))
         guess = max(guess, [guess(2)/rate, guess(1)*rate]*0.1_wp)
      end if
   end function guess_size

   !> Run the hybrid system once from 0 to t_end.
   subroutine integrate(case, equation, integrator, size_guess, size_found, control, result, error)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout) :: integrator
      real(wp), intent(in) :: size_guess(2)
      real(wp), intent(out) :: size_found(2)
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(batch_t), target :: batch

      size_found = 0
      call begin_run(case, size_guess, equation, integrator, hybrid, recorder, error)
      if (allocated(error)) return
      call begin_advance(hybrid, equation, integrator, case%solver%t_end, batch)
      call advance(hybrid, equation, integrator, recorder, case%solver%t_end, control, batch, error)
      if (allocated(error)) return
      call finish_recorder(recorder, equation, hybrid%t, hybrid%y, is_at_rest(hybrid))
      size_found = response_size(recorder)
      call fill_result(case, equation, hybrid, recorder, result)
      result%steps = integrator%steps
      result%method = trim(run_method(case%solver%method))
      result%rtol = case%solver%rtol
      call check_result(case, result, error)
   end subroutine integrate

   !> Initialise integrator, hybrid state and recorder at t = 0, with tolerances for an expected
   !> size.
   subroutine begin_run(case, size_guess, equation, integrator, hybrid, recorder, error)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: size_guess(2)
      !! expected sizes of theta and theta' [rad], [rad/s], or of u and u' [m], [m/s]
      type(equation_t), intent(inout), target :: equation
      class(integrator_t), intent(inout) :: integrator
      type(hybrid_t), intent(out) :: hybrid
      type(recorder_t), intent(out) :: recorder
      type(error_t), allocatable, intent(out) :: error
      !! errors of the integrator's `create` and of `create_recorder`

      equation%rhs_evaluations = 0
      call integrator%create(equation, above_round_off(tolerances(case, equation, size_guess), &
         equation, size_guess), error)
      if (allocated(error)) return
      hybrid%restitution = impact_law(case, equation%p%alpha)
      hybrid%overturning_angle = case%model%overturning_angle
      hybrid%rtol = case%solver%rtol
      hybrid%max_steps = case%solver%max_steps
      call start_hybrid(hybrid, equation, 0.0_wp, initial_state(case, equation))
      call create_recorder(recorder, case, equation, case%solver%t_end, hybrid%y, error)
   end subroutine begin_run

   !> Largest |theta| and |theta'| (bare frame: |u|, |u'|) of a run [rad], [rad/s] or [m], [m/s].
   pure function response_size(recorder) result(found)
      type(recorder_t), intent(in) :: recorder
      real(wp) :: found(2)

      found = [max(recorder%theta_max, -recorder%theta_min), recorder%theta_dot_ends]
   end function response_size

   !> Return whether the response is so much smaller than expected that the run must be repeated.
   pure logical function is_much_smaller(case, size_found, size_guess) result(is_smaller)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: size_found(2)
      !! largest |theta| and |theta'| of the run [rad], [rad/s]; bare frame |u|, |u'| [m], [m/s]
      real(wp), intent(in) :: size_guess(2)
      !! expected sizes [rad], [rad/s] or [m], [m/s]

      is_smaller = .not. allocated(case%solver%atol) .and. any(size_found > 0) &
         .and. any(size_found <= 0.1_wp*size_guess)
   end function is_much_smaller

   !> Tolerances of the local error per step for the tolerance of the case.
   type(tolerance_t) function tolerances(case, equation, size_guess) result(tolerance)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! expected largest |theta| and |theta'| [rad], [rad/s]; bare frame |u|, |u'| [m], [m/s]
      real(wp), parameter :: tightest = 1.0e-14_wp
      !! below this value round-off governs

      tolerance%rtol = case%solver%rtol
      if (allocated(equation%floors%k) .and. equation%floors%yields) then
         tolerance%rtol = max(min(tolerance%rtol, tightest), &
            tolerance%rtol*stiffest_share(equation%floors%m, equation%floors%k))
      end if
      if (allocated(case%solver%atol)) then
         tolerance%atol = case%solver%atol/max(size_guess(1), tiny(1.0_wp)) &
            *state_sizes(equation, size_guess)
         tolerance%atol(1) = case%solver%atol
      else
         tolerance%atol = max(tolerance%rtol*state_sizes(equation, size_guess), &
            1.0e3_wp*tiny(1.0_wp))
      end if
   end function tolerances

   !> Displacement of the stiffest storey over the roof displacement, under equal accelerations of
   !> all floors [-].
   !>
   !> The displacement of a storey is the difference of two states, so this ratio amplifies their
   !> relative errors. The storey shear governs the accelerations of both floors.
   pure real(wp) function stiffest_share(m, k) result(share)
      real(wp), intent(in) :: m(:), k(:)
      !! floor masses and storey stiffnesses from the ground up, over any reference mass
      real(wp) :: d(size(m))
      real(wp) :: shear
      integer :: i

      shear = 0
      do i = size(m), 1, -1
         shear = shear + m(i)
         d(i) = shear/k(i)
      end do
      share = minval(d)/sum(d)
   end function stiffest_share

   !> Raise tolerances to the round-off of the acceleration.
   !>
   !> A small difference of large accelerations drives a wall that hardly lifts off. If its
   !> round-off, integrated over the duration of the response, exceeds the tolerance, no step is
   !> short enough.
   pure type(tolerance_t) function above_round_off(tolerance, equation, size_guess) result(floored)
      type(tolerance_t), intent(in) :: tolerance
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      real(wp) :: noise
      !! [rad/s2]
      real(wp) :: duration
      !! [s]

      floored = tolerance
      if (.not. equation%has_impacts .or. minval(size_guess) <= 0) return
      noise = epsilon(1.0_wp)*equation%uplift%threshold*inverse_inertia(equation)
      duration = size_guess(1)/size_guess(2)
      floored%atol(:2) = max(floored%atol(:2), noise*duration*[duration, 1.0_wp])
   end function above_round_off

   !> State at t = 0 from `&initial`; zero without it.
   pure function initial_state(case, equation) result(y)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp) :: y(equation%n)
      !! (states)

      y = 0
      if (allocated(case%initial)) then
         y(1) = case%initial%theta_over_alpha*equation%p%alpha
         y(2) = case%initial%theta_dot
      end if
   end function initial_state

   !> Fill the components of the result that apply to the scene.
   subroutine fill_result(case, equation, hybrid, recorder, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(inout) :: recorder
      type(result_t), intent(inout) :: result

      result%impacts = recorder%impacts
      result%lift_offs = recorder%lift_offs
      result%has_impacts = equation%has_impacts
      result%overturned = hybrid%mode == mode_overturned
      if (hybrid%drifts > 0) result%collapsed = hybrid%mode == mode_collapsed
      ! a pass at coarser tolerances may have a different ending
      if (allocated(result%t_collapse)) deallocate (result%t_collapse)
      if (hybrid%mode == mode_collapsed) result%t_collapse = hybrid%t
      if (allocated(result%t_grazing)) deallocate (result%t_grazing)
      if (recorder%t_grazing >= 0) result%t_grazing = recorder%t_grazing
      if (allocated(result%t_chatter)) deallocate (result%t_chatter)
      if (recorder%t_chatter >= 0) result%t_chatter = recorder%t_chatter
      result%rhs_evaluations = equation%rhs_evaluations
      result%t_end = hybrid%t
      result%final_state = hybrid%y
      if (.not. allocated(result%warnings)) call collect_warnings(case, equation%motion, result)
      if (equation%has_frame) then
         result%u_s_max = recorder%u_max
         result%t_u_s_max = recorder%t_u_max
      end if
      if (allocated(recorder%top)) result%tip_deflection_max = recorder%top(2)
      if (dissipates_hysteretically(equation)) then
         call fill_hysteresis(case, equation, hybrid, result)
      end if
      if (storeys_have_strengths(case)) call fill_storeys(case, equation, hybrid, recorder, result)
      if (equation%has_wall) call fill_wall(case, equation, hybrid, recorder, result)
      if (recorder%keeps_energy) result%energy = recorder%energy
      if (allocated(recorder%forces)) then
         result%reactions = force_extremes(recorder%forces, equation, recorder%theta_min, &
            recorder%theta_max, recorder%u_max)
         if (allocated(recorder%top)) result%reactions%wall_drift_max = recorder%top(3)
         if (equation%has_cable) call fill_tendon(case, equation, recorder, result)
      end if
      if (allocated(recorder%demands)) then
         if (.not. allocated(result%demands)) allocate (result%demands)
         call demand_extremes(recorder%demands, equation, recorder%u_max, recorder%t_u_max, &
            result%demands)
         if (has_strength(case)) call fill_residuals(recorder%demands%building, result)
      end if
      if (allocated(recorder%envelopes)) then
         if (.not. allocated(result%envelopes)) allocate (result%envelopes)
         call envelope_extremes(recorder%envelopes, equation, [recorder%theta_min, &
            recorder%theta_max], hybrid%y, result%envelopes)
      end if
      if (equation%has_frame) call fill_rest(case, equation, hybrid, recorder, result)
      if (recorder%keeps_history) then
         call move_alloc(recorder%events, result%events)
         call move_alloc(recorder%history, result%history)
      end if
   end subroutine fill_result

   !> Add the largest force of the cable, the largest stress of its strands and the largest strain.
   subroutine fill_tendon(case, equation, recorder, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      !! equation with a cable
      type(recorder_t), intent(in) :: recorder
      type(result_t), intent(inout) :: result
      !! result with reactions

      real(wp) :: strain
      integer :: i

      associate (force => equation%p%eta_0 + result%cable_increment_max)
         result%reactions%tendon_force_max = force
         if (allocated(case%cable%area)) then
            if (size(case%cable%area) == 1) result%reactions%tendon_stress_max = force &
               *case%unit_mass*equation%p%g/case%cable%area(1)
         end if
      end associate
      do i = 1, size(case%cable%eta_0)
         if (.not. equation%elements(i)%length > 0) return
         strain = max(tendon_strain(equation%elements(i), recorder%theta_max), &
            tendon_strain(equation%elements(i), recorder%theta_min))
         if (allocated(case%cable%rupture_strain)) strain = min(strain, &
            case%cable%rupture_strain(i))
         if (i > 1) strain = max(strain, result%reactions%tendon_strain_max)
         result%reactions%tendon_strain_max = strain
      end do
   end subroutine fill_tendon

   !> Add the residual values after yielding and rupture.
   subroutine fill_hysteresis(case, equation, hybrid, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(result_t), intent(inout) :: result
      integer :: i

      if (has_tendon(case)) then
         result%prestress_loss = sum([(prestress_loss(equation, equation%elements(i), &
            hybrid%y(1)), i=1, size(case%cable%eta_0))])
         result%has_ruptured = broken_tendons(equation%state) > 0
      end if
      if (equation%may_hold) result%theta_end_over_alpha = hybrid%y(1) &
         /equation%p%alpha
      if (has_strength(case)) then
         if (.not. storeys_have_strengths(case)) result%ductility = result%u_s_max &
            /yield_displacement(case)
         if (equation%floors%yields) then
            result%residual_displacement = sum(storey_residuals(equation, hybrid%y))
         else if (equation%has_loading_direction) then
            result%residual_displacement = bouc_wen_residual(equation, hybrid%y)
         else
            result%residual_displacement = frame_residual(equation, hybrid%y(1))
         end if
      end if
   end subroutine fill_hysteresis

   !> Add residual drifts of roof and storeys. Storeys that yield together keep their shares.
   subroutine fill_residuals(building, result)
      type(building_t), intent(in) :: building
      type(result_t), intent(inout) :: result
      !! result with demands

      associate (demands => result%demands, u => result%residual_displacement)
         if (building%roof_height > 0) demands%roof_residual_drift = u/building%roof_height
         if (allocated(result%storey_residual_drift)) then
            demands%residual_drift = result%storey_residual_drift
         else if (building%drifts > 0) then
            demands%residual_drift = u*building%bend/building%height
         end if
      end associate
   end subroutine fill_residuals

   !> Add ductilities and residual drifts of individually yielding storeys.
   !>
   !> If a straight line links all storeys to the roof, the residual displacement of the roof gives
   !> their shares.
   subroutine fill_storeys(case, equation, hybrid, recorder, result)
      type(case_t), intent(in) :: case
      !! case with `&yielding storey_u_y`
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(result_t), intent(inout) :: result
      real(wp) :: share(size(case%frame%floors%m))
      !! share of each storey in the height [-]

      associate (height => case%frame%floors%height)
         if (equation%floors%yields) then
            if (allocated(recorder%drifts)) result%storey_ductility = recorder%drifts &
               /storey_strengths(case)
            result%storey_residual_drift = storey_residuals(equation, hybrid%y)
            result%residual_displacement = sum(result%storey_residual_drift)
            result%storey_residual_drift = result%storey_residual_drift/height
         else
            share = height/sum(height)
            result%storey_ductility = result%u_s_max*share/storey_strengths(case)
            result%storey_residual_drift = frame_residuals(equation, hybrid%y(1))/sum(height)
         end if
      end associate
      if (allocated(result%storey_ductility)) result%ductility = maxval(result%storey_ductility)
   end subroutine fill_storeys

   !> Add the drifts in static equilibrium after the motion, if yielding can leave the frame
   !> displaced.
   subroutine fill_rest(case, equation, hybrid, recorder, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(result_t), intent(inout) :: result
      type(discrete_state_t) :: state
      real(wp) :: y(equation%n), u, height
      real(wp) :: d(equation%floors%n_storeys), d_dot(equation%floors%n_storeys)
      logical :: of_storeys, of_roof, is_found

      ! a pass at coarser tolerances may have a different ending
      if (allocated(result%storey_at_rest)) deallocate (result%storey_at_rest)
      if (allocated(result%demands)) then
         if (allocated(result%demands%roof_at_rest)) deallocate (result%demands%roof_at_rest)
      end if
      if (has_ended(hybrid)) return
      of_storeys = allocated(result%storey_residual_drift)
      of_roof = allocated(recorder%demands) .and. (has_strength(case) &
         .or. equation%may_hold)
      if (of_roof) of_roof = recorder%demands%building%roof_height > 0
      if (.not. (of_storeys .or. of_roof)) return
      state = equation%state
      y = hybrid%y
      call come_to_rest(equation%model_t, state, hybrid%overturning_angle, y, is_found)
      if (.not. is_found) return
      u = frame_displacement(equation, state%side, y)
      if (of_roof) result%demands%roof_at_rest = u/recorder%demands%building%roof_height
      if (.not. of_storeys) return
      associate (heights => case%frame%floors%height)
         height = sum(heights)
         result%storey_at_rest = spread(u/height, 1, size(heights))
         if (.not. equation%floors%yields) return
         call storey_motion(equation, state%side, y, d, d_dot)
         result%storey_at_rest = d/heights
      end associate
   end subroutine fill_rest

   !> Collect the warnings about the case itself.
   subroutine collect_warnings(case, motion, result)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(result_t), intent(inout) :: result
      character(key_length), allocatable :: keys(:)

      allocate (keys(0))
      if (allocated(case%output)) then
         if (case%output%reactions) keys = all_quantities%key
      end if
      call list_case_warnings(case, motion, .false., keys, result%warnings)
   end subroutine collect_warnings

   !> Add the maxima of the wall and its velocity factors to the result.
   subroutine fill_wall(case, equation, hybrid, recorder, result)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid
      type(recorder_t), intent(in) :: recorder
      type(result_t), intent(inout) :: result

      result%theta_max = recorder%theta_max
      result%theta_min = recorder%theta_min
      result%theta_max_over_alpha = max(recorder%theta_max, -recorder%theta_min)/equation%p%alpha
      result%theta_dot_max = max(recorder%theta_dot_max, recorder%theta_dot_ends)
      if (equation%has_impacts) then
         ! a velocity-dependent table has no single factor
         if (.not. allocated(hybrid%restitution%speed)) result%e = hybrid%restitution%e
         result%e_max = balanced_restitution(case, equation%p%alpha)
      end if
      if (equation%beam%n > 0) result%modal_damping = equation%beam%ratios
      if (equation%has_cable) result%cable_increment_max = largest_increment(equation, recorder)
      if (equation%has_impacts .and. (equation%walls > 1 .or. has_places(equation))) then
         result%uplift = resting_uplift(equation)
      end if
      if (allocated(case%coupling)) then
         if (allocated(case%coupling%eta_y)) result%coupling_ratio = coupling_ratio(case)
      end if
   end subroutine fill_wall

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
         1), &
         cable_force_at(equation, max(0.0_wp, recorder%theta_min), 1))
      if (recorder%theta_min <= 0) increment = max(increment, cable_force_at(equation, &
         recorder%theta_min, -1), cable_force_at(equation, min(0.0_wp, recorder%theta_max), -1))
      increment = increment - equation%p%eta_0
   end function largest_increment

end module rwmf_simulation_run
