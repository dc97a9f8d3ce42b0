!> Integrator whose steps are motions in closed form.
module known_motions
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_interface_integrator, only: integrator_t, tolerance_t
   use rwmf_model_system_assembly, only: equation_t
   implicit none
   private

   public :: known_t

   !> Known motion: cos(omega (t - t_peak)), or a cubic in t - t0 for omega = 0.
   type, extends(integrator_t) :: known_t
      real(wp) :: omega = 0, t_peak = 0
      !! [rad/s], [s]
      real(wp) :: u = 0, v = 0, a = 0, j = 0
      !! at t0 [rad], [rad/s], [rad/s2], [rad/s3]
   contains
      procedure :: create
      procedure :: start
      procedure :: step
      procedure :: state_at
      procedure :: destroy
   end type known_t

contains

   subroutine state_at(self, t, y, error)
      class(known_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(:)
      type(error_t), allocatable, intent(out) :: error

      if (self%omega > 0) then
         associate (angle => self%omega*(t - self%t_peak))
            y = [cos(angle), -self%omega*sin(angle)]
         end associate
      else
         associate (h => t - self%t0)
            y = [self%u + h*(self%v + h*(self%a/2 + h*self%j/6)), &
               self%v + h*(self%a + h*self%j/2)]
         end associate
      end if
   end subroutine state_at

   subroutine create(self, equation, tolerance, error)
      class(known_t), intent(inout) :: self
      type(equation_t), intent(inout), target :: equation
      type(tolerance_t), intent(in) :: tolerance
      type(error_t), allocatable, intent(out) :: error

      error stop 'not called'
   end subroutine create

   subroutine start(self, t, y, span, error)
      class(known_t), intent(inout) :: self
      real(wp), intent(in) :: t, y(:), span
      type(error_t), allocatable, intent(out) :: error

      error stop 'not called'
   end subroutine start

   subroutine step(self, t_limit, error)
      class(known_t), intent(inout) :: self
      real(wp), intent(in) :: t_limit
      type(error_t), allocatable, intent(out) :: error

      error stop 'not called'
   end subroutine step

   subroutine destroy(self)
      class(known_t), intent(inout) :: self

      error stop 'not called'
   end subroutine destroy

end module known_motions

!> Events of the rotation inside one step, on motions in closed form.
program test_rotation_events
   use check, only: checks_t
   use known_motions, only: known_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, equation_t, &
      rates_at
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_events_first_change, only: ending_t
   use rwmf_simulation_events_step_quartic, only: at_low, first_event, quartic_t
   use rwmf_simulation_events_step_view, only: step_view_t, view_step
   use rwmf_simulation_hybrid_step_events, only: list_turns, search_step
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, mode_no_impacts, mode_rocking
   use rwmf_simulation_state_result, only: event_branch, event_impact, event_peak
   use scenes, only: block_scene, frame_scene
   implicit none

   type(checks_t) :: checks
   type(motion_t), target :: motion
   type(equation_t), target :: equation

   if (checks%wants('turns')) call check_turns()
   if (checks%wants('round-off')) call check_round_off()
   if (checks%wants('windows')) call check_windows()
   if (checks%wants('flights')) call check_flights()
   if (checks%wants('dips')) call check_dips()
   call checks%finish()

contains

   !> Find every turn of a free vibration in steps from a thirtieth to three periods.
   subroutine check_turns()
      type(known_t), target :: known
      type(recorder_t) :: recorder
      type(step_view_t) :: step
      type(error_t), allocatable :: error
      real(wp) :: half, t
      integer :: i, j, k, first, wrong
      real(wp) :: worst

      call build(frame_scene(0.4_wp, 'adams'))
      half = pi/equation%p%omega_s
      known%omega = equation%p%omega_s
      known%t_peak = 1
      wrong = 0
      worst = 0
      do k = 1, 90
         do i = 1, 40
            call set_step(known, 1 + half*(i - 0.3_wp)/20, 1 + half*((i - 0.3_wp)/20 &
               + k/15.0_wp), step)
            recorder%keeps_events = .true.
            recorder%n_events = 0
            if (.not. allocated(recorder%events)) allocate (recorder%events(0))
            call list_turns(recorder, step, error)
            call checks%no_error(error, 'turns')
            first = ceiling((known%t0 - 1)/half)
            do j = 1, recorder%n_events
               t = 1 + half*(first + j - 1)
               worst = max(worst, abs(recorder%events(j)%t - t))
            end do
            if (recorder%n_events /= floor((known%t1 - 1)/half) - first + 1) wrong = wrong + 1
         end do
      end do
      call checks%that(wrong == 0, 'every turn is listed once')
      call checks%close_to(worst, 0.0_wp, 'times of the turns', atol=8*spacing(2.0_wp))
   end subroutine check_turns

   !> Find turns whose velocities are below the round-off of the polygon at their time. Find no
   !> further turn where the equation of motion contradicts the motion.
   subroutine check_round_off()
      type(known_t), target :: known
      type(ending_t) :: ending
      type(hybrid_t) :: hybrid
      type(recorder_t) :: recorder
      type(step_view_t) :: step
      type(error_t), allocatable :: error
      real(wp) :: h, worst
      integer :: k, missed, turns

      call build(frame_scene(0.4_wp, 'adams'))
      known%omega = equation%p%omega_s
      known%t_peak = 1
      equation%state%ends_at_peak = .true.
      missed = 0
      worst = 0
      do k = 3, 13
         h = 10.0_wp**(-k)
         call search(known, 1 - 0.3_wp*h, 1 + 0.7_wp*h, mode_no_impacts, hybrid, ending)
         if (ending%kind /= event_peak) missed = missed + 1
         worst = max(worst, abs(hybrid%t - 1))
      end do
      call checks%that(missed == 0, 'turns in short steps')
      call checks%close_to(worst, 0.0_wp, 'their times', atol=4*spacing(1.0_wp))
      equation%state%ends_at_peak = .false.
      call search(known, 0.9_wp, 1.0_wp, mode_no_impacts, hybrid, ending, turns)
      call checks%that(ending%kind == 0 .and. turns == 1, 'a turn at the end is recorded once')
      known%omega = 0
      known%u = -1
      known%v = 1.0e-9_wp
      known%a = -3.0e-9_wp
      call search(known, 1.0_wp, 2.0_wp, mode_no_impacts, hybrid, ending, turns)
      call checks%that(turns == 1, 'a turn against the equation of motion is recorded once')
      recorder%keeps_events = .true.
      recorder%n_events = 0
      allocate (recorder%events(0))
      call set_step(known, 1.0_wp, 2.0_wp, step)
      call list_turns(recorder, step, error)
      call checks%no_error(error, 'list')
      call checks%that(recorder%n_events == 1, 'and listed once')
      call checks%close_to(recorder%events(1)%t, 4.0_wp/3, 'its time', atol=4*spacing(2.0_wp))
   end subroutine check_round_off

   !> Leave a window within a step, before or after a turn, and from its limit.
   subroutine check_windows()
      type(known_t), target :: known
      type(ending_t) :: ending
      type(hybrid_t) :: hybrid
      real(wp) :: half

      call build(frame_scene(0.4_wp, 'adams'))
      half = pi/equation%p%omega_s
      known%omega = equation%p%omega_s
      known%t_peak = 1
      equation%state%high = 0.5_wp
      call search(known, 1 - half/2, 1 + half/4, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_branch .and. ending%is_rising, 'upper limit')
      call checks%close_to(hybrid%t, 1 - half/3, 'its time', atol=4*spacing(1.0_wp))
      call checks%close_to(hybrid%y(2), known%omega*sqrt(0.75_wp), 'its velocity', rtol=1.0e-13_wp)
      equation%state%high = cos(0.01_wp)
      call search(known, 1 - half/4, 1 + half/4, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_branch, 'limit just before the turn')
      call checks%close_to(hybrid%t, 1 - 0.01_wp/known%omega, 'its time', atol=1.0e-14_wp)
      equation%state%high = 1 + epsilon(1.0_wp)
      equation%state%low = 0.9_wp
      call search(known, 1 - half/8, 1 + half/4, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_branch .and. .not. ending%is_rising, &
         'lower limit after the turn')
      call checks%close_to(hybrid%t, 1 + acos(0.9_wp)/known%omega, 'its time', &
         atol=4*spacing(1.0_wp))
      equation%state%high = cos(pi/8)
      call search(known, 1 - half/8, 1 - half/10, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_branch .and. hybrid%t < 1 - half/8 + 1.0e-15_wp, &
         'a step from the limit outwards ends at once')
      call search(known, 1 + half/8, 1 + half/7, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == 0, 'a step from the limit inwards has no event')
      equation%state%ends_at_peak = .true.
      equation%state%high = huge(1.0_wp)
      equation%state%low = -huge(1.0_wp)
      call search(known, 1 - half/4, 1 + half/4, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_peak, 'a spring unloads at the turn')
      call checks%close_to(hybrid%t, 1.0_wp, 'its time', atol=4*spacing(1.0_wp))
      call search(known, 1.0_wp, 1 + half/4, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == 0, 'a step from the turn has no event')
      call search(known, 1 - half/4, 1.0_wp, mode_no_impacts, hybrid, ending)
      call checks%that(ending%kind == event_peak, 'a turn at the end of the step')
   end subroutine check_windows

   !> Find the impact of flights that start on the base and end within the step, down to a hundred
   !> spacings of the time. No impact is faster than its start.
   subroutine check_flights()
      type(known_t), target :: known
      type(ending_t) :: ending
      type(hybrid_t) :: hybrid
      real(wp) :: rates(2), fastest, latest
      integer :: k, side, missed, turns

      call build(block_scene('adams'))
      missed = 0
      fastest = 0
      latest = 0
      do side = -1, 1, 2
         call enter_side(equation%model_t, equation%state, side)
         call rates_at(equation, 5.0_wp, [0.0_wp, 0.0_wp], rates)
         known%a = rates(2)
         do k = 50, 150
            known%v = side*10**(-k/10.0_wp)
            if (abs(2*known%v/known%a) < 100*spacing(5.0_wp)) cycle
            call search(known, 5.0_wp, 5 + 3*abs(known%v/known%a), mode_rocking, hybrid, ending)
            if (ending%kind /= event_impact) missed = missed + 1
            latest = max(latest, abs(hybrid%t - 5 - abs(2*known%v/known%a)))
            fastest = max(fastest, -hybrid%y(2)/known%v)
         end do
      end do
      call checks%that(missed == 0, 'every flight ends with its impact')
      call checks%close_to(latest, 0.0_wp, 'times of the impacts', atol=4*spacing(5.0_wp))
      call checks%that(fastest <= 1 + 1.0e-12_wp, 'no impact is faster than its start')
      ! the equation of motion without ground motion contradicts the lift-off
      known%v = 0
      call enter_side(equation%model_t, equation%state, -1)
      known%a = -1.0e-3_wp
      known%j = 4.0e-3_wp
      call search(known, 5.0_wp, 6.0_wp, mode_rocking, hybrid, ending, turns)
      call checks%that(ending%kind == event_impact .and. turns == 1, 'lift-off, turn and impact')
      call checks%close_to(hybrid%t, 5.75_wp, 'time of the impact', atol=1.0e-12_wp)
   end subroutine check_flights

   !> Search a step of a known motion as the hybrid loop does.
   subroutine search(known, t_a, t_b, mode, hybrid, ending, turns)
      type(known_t), intent(inout), target :: known
      real(wp), intent(in) :: t_a, t_b
      integer, intent(in) :: mode
      type(hybrid_t), intent(out) :: hybrid
      type(ending_t), intent(out) :: ending
      integer, intent(out), optional :: turns
      !! number of recorded turns
      type(recorder_t) :: recorder
      type(step_view_t) :: step
      type(error_t), allocatable :: error

      hybrid%mode = mode
      hybrid%overturning_angle = pi/2
      hybrid%rtol = 1.0e-9_wp
      allocate (hybrid%y(2))
      recorder%keeps_events = .true.
      recorder%n_events = 0
      allocate (recorder%events(0))
      call set_step(known, t_a, t_b, step)
      call search_step(hybrid, step, recorder, ending, error)
      call checks%no_error(error, 'search')
      if (present(turns)) turns = recorder%n_events
   end subroutine search

   !> Find the first of two passages of zero in a step that begins within round-off of a peak, on
   !> either side of it.
   subroutine check_dips()
      type(quartic_t) :: quartic
      real(wp) :: x
      integer :: event, k, side

      do k = 1, 16
         do side = -1, 1
            quartic%c = [0.05_wp, side*10.0_wp**(-k)/8, -1.0_wp, 4.0_wp/3, 0.0_wp, 0.0_wp]
            call first_event(quartic, [0.0_wp, 1.0_wp], [-huge(x), huge(x)], event, x)
            call checks%that(event == at_low .and. x < 0.5_wp, 'first passage of zero')
            associate (c => quartic%c)
               call checks%close_to(c(0) + x*(c(1) + x*(c(2) + x*c(3))), 0.0_wp, 'its place', &
                  atol=1.0e-3_wp)
            end associate
         end do
      end do
   end subroutine check_dips

   !> Build the equation of a scene without ground motion.
   subroutine build(scene)
      type(case_t), intent(in) :: scene
      type(case_t) :: case

      case = scene
      if (allocated(case%frame)) case%frame%xi_s = 0
      case%motion%t_0 = 100
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      call enter_interval(equation%model_t, equation%state, 0)
      call enter_side(equation%model_t, equation%state, 1)
   end subroutine build

   !> Let a known motion have a step.
   subroutine set_step(known, t_a, t_b, step)
      type(known_t), intent(inout), target :: known
      real(wp), intent(in) :: t_a, t_b
      type(step_view_t), intent(inout) :: step
      type(error_t), allocatable :: error

      known%t0 = t_a
      known%t1 = t_b
      if (.not. allocated(known%y0)) allocate (known%y0(2), known%y1(2))
      call known%state_at(t_a, known%y0, error)
      call known%state_at(t_b, known%y1, error)
      call view_step(step, equation, known)
   end subroutine set_step

end program test_rotation_events
