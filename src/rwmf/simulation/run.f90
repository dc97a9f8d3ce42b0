!> A single run of the hybrid system at the tolerances of a valid case.
module rwmf_simulation_run
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_simulation_factory, only: new_integrator, run_method
   use rwmf_integrator_interface_integrator, only: integrator_t, tolerance_t
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_model_system_contributions, only: state_sizes
   use rwmf_model_equation, only: frame_travel
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_system_rest_after_chatter, only: inverse_inertia
   use rwmf_motion_ground_motion, only: motion_t, peak_acceleration
   use rwmf_paper_paper_scene, only: check_paper_scene
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: all_quantities, key_length
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_simulation_base_base_run, only: run_on_base
   use rwmf_simulation_advance, only: advance, begin_advance
   use rwmf_simulation_finite_check, only: check_result
   use rwmf_simulation_hybrid_hybrid_loop, only: start_hybrid
   use rwmf_simulation_lanes_batch, only: batch_t
   use rwmf_simulation_recorder_recorder, only: create_recorder, finish_recorder, &
      recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, is_at_rest
   use rwmf_simulation_run_values, only: fill_result
   use rwmf_simulation_state_result, only: result_t
   use rwmf_simulation_warnings, only: list_case_warnings, warn_of_motion, warn_of_reactions, &
      warn_of_toe
   implicit none
   private

   public :: run_once, guess_size, tolerances, initial_state
   public :: begin_run, is_much_smaller, response_size, most_passes

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
      integer(i8) :: started, finished, rate
      real(wp) :: size_guess(2), size_found(2)
      integer :: pass

      call check_single_run(case, error)
      if (allocated(error)) return
      if (case%solver%method == 'paper') call check_paper_scene(case, error)
      if (allocated(error)) return
      call system_clock(started, rate)
      if (allocated(case%compliant_base)) then
         call run_on_base(case, motion, control, result, error)
         if (allocated(error)) return
         call collect_warnings(case, motion, result)
         call check_result(result, error)
      else
         call build_equation(case, motion, equation)
         call new_integrator(case%solver%method, integrator)
         ! A response much smaller than the guess is integrated again with absolute tolerances for
         ! its size: tiny responses are then as accurate as large ones.
         size_guess = guess_size(case, equation)
         do pass = 1, most_passes
            call integrate(case, equation, integrator, size_guess, size_found, control, result, &
               error)
            if (allocated(error)) exit
            if (.not. is_much_smaller(case, size_found, size_guess)) exit
            size_guess = merge(size_found, size_guess, size_found < 0.1_wp*size_guess)
         end do
         call integrator%destroy()
      end if
      call warn_of_reactions(result)
      call warn_of_toe(case, result)
      call warn_of_motion(case%solver%t_end, result)
      ! measure the wall-clock time of a run
      call system_clock(finished)
      result%seconds = real(finished - started, wp)/real(rate, wp)
   end subroutine run_once

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
      if (.not. allocated(result%warnings)) call collect_warnings(case, equation%motion, result)
      call fill_result(case, equation, hybrid, recorder, result)
      result%steps = integrator%steps
      result%method = trim(run_method(case%solver%method))
      result%rtol = case%solver%rtol
      call check_result(result, error)
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
      type(tolerance_t) :: tolerance
      real(wp) :: noise, duration
      !! round-off of the acceleration [rad/s2]; duration of the response [s]

      equation%rhs_evaluations = 0
      tolerance = tolerances(case, equation, size_guess)
      ! A small difference of large accelerations drives a wall that hardly lifts off. If its
      ! round-off, integrated over the duration of the response, exceeds the tolerance, no step is
      ! short enough.
      if (equation%has_impacts .and. minval(size_guess) > 0) then
         noise = epsilon(1.0_wp)*equation%uplift%threshold*inverse_inertia(equation)
         duration = size_guess(1)/size_guess(2)
         tolerance%atol(:2) = max(tolerance%atol(:2), noise*duration*[duration, 1.0_wp])
      end if
      call integrator%create(equation, tolerance, error)
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

end module rwmf_simulation_run
