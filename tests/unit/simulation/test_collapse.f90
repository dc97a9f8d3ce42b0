!> Effect that only limits the drifts of a frame.
module drift_limit
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, equation_t, frame_motion
   use rwmf_model_floor_motion, only: storey_motion
   implicit none
   private

   public :: limit, limit_drifts

   real(wp), parameter :: limit = 0.02_wp
   !! of the frame's displacement, and of each storey drift [m]

contains

   !> Add the effect to the list of an equation.
   subroutine limit_drifts(equation)
      type(equation_t), intent(inout) :: equation
      type(contribution_t) :: effect

      if (.not. allocated(equation%effects)) allocate (equation%effects(0))
      effect = contribution_t(drifts=max(1, equation%floors%n), put_drifts=put_drifts)
      equation%effects = [equation%effects, effect]
   end subroutine limit_drifts

   subroutine put_drifts(effect, equation, y, ratio, rate)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: ratio(:)
      real(wp), intent(out) :: rate(:)

      if (equation%floors%n > 0) then
         call storey_motion(equation, equation%state%side, y, ratio, rate)
      else
         call frame_motion(equation, equation%state%side, y, ratio(1), rate(1))
      end if
      ratio = ratio/limit
      rate = rate/limit
   end subroutine put_drifts

end module drift_limit

!> End of a run at a drift limit, its instant and the response before it; no run continues after it.
program test_collapse
   use check, only: checks_t
   use drift_limit, only: limit, limit_drifts
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_simulation_factory, only: new_integrator
   use rwmf_integrator_interface_integrator, only: integrator_t
   use rwmf_model_system_assembly, only: build_equation, equation_t
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_simulation_hybrid_hybrid_loop, only: advance_hybrid, start_hybrid
   use rwmf_simulation_recorder_recorder, only: create_recorder, recorder_t
   use rwmf_simulation_run, only: guess_size, tolerances
   use rwmf_simulation_simulate, only: simulate
   use rwmf_simulation_state_hybrid_state, only: has_ended, hybrid_t, mode_collapsed
   use rwmf_simulation_state_result, only: ending_name, event_collapsed, event_name, result_t
   use scenes, only: frame_scene, rwmf_scene
   implicit none

   character(6), parameter :: methods(4) = [character(6) :: 'adams', 'bdf', 'taylor', 'dop853']
   real(wp), parameter :: excess(3) = [0.5_wp, 1.0e-3_wp, 1.0e-7_wp]
   !! excess of a peak over the limit [-]; the last peak exceeds it for less than 1e-3 of the period
   type(checks_t) :: checks
   integer :: i, j

   do i = 1, size(methods)
      do j = 1, size(excess)
         if (checks%wants('instant')) call check_instant(trim(methods(i)), excess(j))
      end do
      if (checks%wants('peak_below')) call check_peak_below(trim(methods(i)))
      if (checks%wants('storeys')) call check_storeys(trim(methods(i)), rests=.false.)
   end do
   if (checks%wants('storeys')) call check_storeys('dop853', rests=.true.)
   if (checks%wants('end_is_final')) call check_end_is_final()
   if (checks%wants('absence')) call check_absence()
   call checks%finish()

contains

   !> Scene with an undamped frame of 0.7 s under a pulse of 1 s.
   function undamped_scene(method, amplitude) result(case)
      character(*), intent(in) :: method
      real(wp), intent(in) :: amplitude
      !! over g [-]
      type(case_t) :: case

      case = frame_scene(0.7_wp, method)
      case%frame%xi_s = 0
      case%motion%a_max_g = amplitude
      case%solver%rtol = 1.0e-11_wp
      if (any(methods(:3) == method)) case%solver%rtol = 1.0e-9_wp
      case%solver%t_end = 3
   end function undamped_scene

   !> Displacement of this frame during the pulse, for an amplitude of g [m].
   pure real(wp) function displacement(t) result(u)
      real(wp), intent(in) :: t
      !! [s]
      real(wp), parameter :: omega = 2*pi/0.7_wp

      u = -9.81_wp/(omega**2 - 4*pi**2)*(sin(2*pi*t) - 2*pi/omega*sin(omega*t))
   end function displacement

   !> Compute the first peak, where the velocity, proportional to cos(2 pi t) - cos(omega t), is
   !> zero.
   subroutine first_peak(t, u)
      real(wp), intent(out) :: t
      !! [s]
      real(wp), intent(out) :: u
      !! magnitude for an amplitude of g [m]
      real(wp), parameter :: omega = 2*pi/0.7_wp

      t = 2*pi/(omega + 2*pi)
      u = abs(displacement(t))
   end subroutine first_peak

   !> Run the scene of a case with the drift limit, from rest to its end.
   subroutine follow(case, hybrid, recorder, error)
      type(case_t), intent(in) :: case
      type(hybrid_t), intent(out) :: hybrid
      type(recorder_t), intent(out) :: recorder
      type(error_t), allocatable, intent(out) :: error
      type(motion_t), target :: motion
      type(equation_t), target :: equation
      class(integrator_t), allocatable :: integrator
      real(wp), allocatable :: y(:)

      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      call limit_drifts(equation)
      call new_integrator(case%solver%method, integrator)
      call integrator%create(equation, tolerances(case, equation, guess_size(case, equation)), &
         error)
      if (allocated(error)) return
      hybrid%restitution = impact_law(case, equation%p%alpha)
      hybrid%overturning_angle = case%model%overturning_angle
      hybrid%rtol = case%solver%rtol
      hybrid%max_steps = case%solver%max_steps
      allocate (y(equation%n), source=0.0_wp)
      call start_hybrid(hybrid, equation, 0.0_wp, y)
      call create_recorder(recorder, case, equation, case%solver%t_end, y, error)
      recorder%keeps_events = .true.
      if (.not. allocated(error)) call advance_hybrid(hybrid, equation, integrator, recorder, &
         case%solver%t_end, control_t(), error)
      if (.not. allocated(error) .and. has_ended(hybrid)) then
         call advance_hybrid(hybrid, equation, integrator, recorder, case%solver%t_end + 1, &
            control_t(), error)
      end if
      call integrator%destroy()
   end subroutine follow

   !> Compare the instant of collapse with the closed form.
   subroutine check_instant(method, over)
      character(*), intent(in) :: method
      real(wp), intent(in) :: over
      !! excess of the first peak over the limit [-]
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(error_t), allocatable :: error
      real(wp) :: t, u, low, high
      integer :: k

      call first_peak(t, u)
      call follow(undamped_scene(method, limit*(1 + over)/u), hybrid, recorder, error)
      call checks%no_error(error, 'collapses, '//method)
      call checks%that(hybrid%mode == mode_collapsed, 'collapses, '//method)
      low = 0
      high = t
      do k = 1, 60
         t = (low + high)/2
         if (abs(displacement(t))*(1 + over) > u) then
            high = t
         else
            low = t
         end if
      end do
      ! near its peak the displacement is insensitive to time
      call checks%close_to(hybrid%t, high, 'instant of collapse, '//method, &
         atol=1.0e-7_wp/sqrt(over))
      call checks%close_to(abs(hybrid%y(1)), limit, 'displacement there, '//method, rtol=1.0e-13_wp)
      associate (last => recorder%events(recorder%n_events))
         call checks%that(last%kind == event_collapsed .and. abs(last%t - hybrid%t) <= 0, &
            'the last event is the collapse, '//method)
         call checks%that(event_name(last%kind) == 'collapsed', 'its name')
      end associate
      call checks%that(recorder%u_max <= limit*(1 + 1.0e-12_wp), 'nothing beyond it, '//method)
   end subroutine check_instant

   !> Check that a run continues to its end if the largest displacement stays below the limit.
   subroutine check_peak_below(method)
      character(*), intent(in) :: method
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(result_t) :: result
      type(error_t), allocatable :: error

      call simulate(undamped_scene(method, 1.0_wp), result, error)
      call checks%no_error(error, 'frame, '//method)
      call follow(undamped_scene(method, limit*(1 - 1.0e-6_wp)/result%u_s_max), hybrid, recorder, &
         error)
      call checks%no_error(error, 'below, '//method)
      call checks%that(.not. has_ended(hybrid), 'goes on below the limit, '//method)
      call checks%close_to(hybrid%t, 3.0_wp, 'to its end, '//method)
   end subroutine check_peak_below

   !> Compare the first passage of three storeys with all modes with a history of the same run. The
   !> frame has no wall, or a wall that a stiff cable keeps at rest while the floors move.
   subroutine check_storeys(method, rests)
      character(*), intent(in) :: method
      logical, intent(in) :: rests
      type(case_t) :: case
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: d(3, 2), t
      integer :: row, column, k

      case = storeys_scene(method, rests)
      call follow(case, hybrid, recorder, error)
      call checks%no_error(error, 'storeys, '//method)
      call checks%that(hybrid%mode == mode_collapsed, 'storeys collapse, '//method)
      allocate (case%output)
      case%output%energy = .false.
      case%output%dt = 1.0e-4_wp
      call simulate(case, result, error)
      call checks%no_error(error, 'storeys with history, '//method)
      call checks%that(result%lift_offs == 0, 'the wall rests')
      column = findloc(result%history%names, 'storey_1_drift', dim=1)
      d = 0
      t = huge(t)
      do row = 2, size(result%history%values, 1)
         d(:, 1) = d(:, 2)
         d(:, 2) = abs(result%history%values(row, column:column + 2)*2)
         if (all(d(:, 2) < limit)) cycle
         do k = 1, 3
            if (d(k, 2) >= limit) t = min(t, result%history%values(row, 1) &
               - case%output%dt*(d(k, 2) - limit)/(d(k, 2) - d(k, 1)))
         end do
         exit
      end do
      call checks%close_to(hybrid%t, t, 'instant in the history, '//method, atol=1.0e-6_wp)
   end subroutine check_storeys

   !> Scene with three unequal storeys of 2 m under a pulse of 0.3 s, shorter than their first
   !> periods.
   function storeys_scene(method, rests) result(case)
      character(*), intent(in) :: method
      logical, intent(in) :: rests
      type(case_t) :: case
      type(error_t), allocatable :: error

      case = rwmf_scene('exact', 0.0_wp, 1.0_wp, method)
      case%cable%eta_0 = [200.0_wp]
      case%cable%eta_alpha = [200.0_wp]
      case%wall%h = 3
      if (.not. rests) deallocate (case%wall, case%cable)
      case%motion%omega_p = 2*pi/0.3_wp
      case%motion%a_max_g = 0.5_wp
      case%solver%t_end = 4
      allocate (case%frame%floors)
      case%frame%coupling = 'full'
      case%frame%floors%m = [2.0_wp, 2.0_wp, 1.0_wp]
      case%frame%floors%k = [300.0_wp, 200.0_wp, 150.0_wp]
      case%frame%floors%height = [2.0_wp, 2.0_wp, 2.0_wp]
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'equivalent frame')
   end function storeys_scene

   !> Check that a collapsed scene keeps its state.
   subroutine check_end_is_final()
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(error_t), allocatable :: error

      call follow(undamped_scene('dop853', 1.0_wp), hybrid, recorder, error)
      call checks%no_error(error, 'beyond the end')
      call checks%that(hybrid%mode == mode_collapsed .and. hybrid%t < 1, 'stays collapsed')
   end subroutine check_end_is_final

   !> Check that a result without drift limit has no collapse fields.
   subroutine check_absence()
      type(result_t) :: result
      type(error_t), allocatable :: error

      call simulate(undamped_scene('dop853', 1.0_wp), result, error)
      call checks%no_error(error, 'no limit')
      call checks%that(.not. allocated(result%collapsed) .and. .not. allocated(result%t_collapse), &
         'no collapse without a limit')
      call checks%that(ending_name(result) == 'ok', 'its ending')
   end subroutine check_absence

end program test_collapse
