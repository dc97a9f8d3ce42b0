!> Run of a wall on a base that gives, by Taylor series (docs/theory/base.md).
!>
!> Contact moves along the base and its forces stay finite, so there is no pivot and no impact. A
!> step ends at a knot of the motion, at the first event of its regime, or where its series ends.
module rwmf_simulation_base_base_run
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_math_polynomial_roots, only: highest_degree
   use rwmf_math_power_series, only: series_value
   use rwmf_model_base_base_regime, only: base_function_t, base_regime_t, begin_regime, &
      change_regime, collect_functions, find_event, of_overturning
   use rwmf_model_base_base_scene, only: base_scene_t, build_base_scene, settlement_at_rest
   use rwmf_model_base_base_series, only: base_series_t, create_series, expand, set_state, &
      state_count
   use rwmf_model_series_series_motion, only: highest_order
   use rwmf_motion_ground_motion, only: expand_ground, interval_at, interval_end, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_base_base_record, only: base_record_t, create_record, observe_step
   use rwmf_simulation_base_base_result, only: fill_base_result
   use rwmf_simulation_state_result, only: result_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: run_on_base

   integer, parameter :: least_order = 6
   real(wp), parameter :: share = 0.1_wp
   !! part of the tolerance for the last term of a series [-]
   real(wp), parameter :: weight = 0.1_wp
   !! of the term before the last one [-]

   !> Progress of a run.
   type :: progress_t
      real(wp) :: t = 0
      !! [s]
      real(wp), allocatable :: y(:)
      !! (states)
      real(wp), allocatable :: allowed(:)
      !! (states) largest last term of their series
      real(wp) :: settlement
      !! largest settlement of an edge so far [m]
      real(wp) :: rtol
      integer :: highest
      !! order beyond which steps become shorter instead
      integer :: events = 0
      !! events since the time last advanced
      integer(i8) :: steps = 0
      integer(i8) :: evaluations = 0
      logical :: has_overturned = .false.
   end type progress_t

contains

   !> Integrate a case with `&base`.
   !>
   !> Errors: `err_input` if the base crushes under the wall at rest; `err_numerical` after too many
   !> steps; `err_interrupt`.
   subroutine run_on_base(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      !! valid case whose frame has T_s
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      type(base_scene_t) :: scene
      type(base_regime_t) :: regime
      type(base_record_t) :: record
      type(base_series_t) :: series
      type(base_function_t), allocatable :: functions(:)
      type(progress_t) :: progress

      if (case%solver%method /= 'auto' .and. case%solver%method /= 'taylor') then
         call fail(error, err_numerical, "&base is integrated by 'taylor' only, not by '" &
            //case%solver%method//"'", 'not_practised')
         return
      end if
      call build_base_scene(case, scene, error)
      if (allocated(error)) return
      call begin_state(case, scene, progress)
      call begin_regime(scene, progress%y, regime)
      call create_series(scene, series)
      call create_record(case, scene, regime, progress%y, record, error)
      if (allocated(error)) return
      allocate (functions(size(regime%passed)))
      do while (progress%t < case%solver%t_end .and. .not. progress%has_overturned)
         call take_step(case, scene, motion, series, functions, regime, record, progress, error)
         if (allocated(error)) return
         call check_work(case, control, progress, error)
         if (allocated(error)) return
      end do
      if (case%solver%t_end <= 0) call observe_start(scene, motion, series, regime, record, &
         progress)
      result%steps = progress%steps
      result%rhs_evaluations = progress%evaluations
      result%t_end = progress%t
      result%final_state = progress%y
      result%overturned = progress%has_overturned
      call fill_base_result(case, scene, regime, record, progress%y, result)
   end subroutine run_on_base

   !> Begin at rest or with the rotation of `&initial`.
   subroutine begin_state(case, scene, progress)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(progress_t), intent(inout) :: progress

      allocate (progress%y(state_count(scene)), progress%allowed(state_count(scene)), source=0.0_wp)
      if (allocated(case%initial)) then
         progress%y(1) = case%initial%theta_over_alpha*scene%alpha
         progress%y(2) = case%initial%theta_dot
      end if
      progress%y(5) = settlement_at_rest(scene, progress%y(1))
      progress%settlement = -scene%z_0
      progress%rtol = case%solver%rtol
      progress%highest = min(max(8, 2*nint(-0.55_wp*log10(progress%rtol)) + 2), &
         highest_order - 1, highest_degree)
   end subroutine begin_state

   !> Take a step, which ends at an event, a knot of the motion or the end of its series.
   subroutine take_step(case, scene, motion, series, functions, regime, record, progress, error)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(motion_t), intent(in) :: motion
      type(base_series_t), intent(inout) :: series
      type(base_function_t), intent(inout) :: functions(:)
      type(base_regime_t), intent(inout) :: regime
      type(base_record_t), intent(inout) :: record
      type(progress_t), intent(inout) :: progress
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_events = 1000
      real(wp) :: h, longest, reach, t_next
      integer :: event, interval, n

      interval = interval_at(motion, progress%t)
      t_next = min(interval_end(motion, interval), case%solver%t_end)
      longest = t_next - progress%t
      call begin_step(motion, interval, longest, series, progress)
      call allow_terms(scene, progress)
      do
         call expand(scene, regime%base_mode_t, min(max(series%order + 2, least_order), &
            progress%highest), series)
         reach = accurate_length(progress, series, longest)
         if (series%order == progress%highest .or. reach >= longest) exit
      end do
      progress%evaluations = progress%evaluations + series%order + 1
      call collect_functions(scene, regime, case%model%overturning_angle, series, functions, n)
      call find_event(functions(:n), series%order, reach, event, h)
      call observe_step(scene, regime, progress%t, h, series, record)
      call move_states(series, h, progress%y)
      progress%steps = progress%steps + 1_i8
      if (event == 0 .and. h >= longest) then
         progress%t = t_next
      else
         progress%t = progress%t + h
      end if
      if (h > 0) then
         progress%events = 0
         regime%passed = .false.
      end if
      progress%settlement = max(progress%settlement, scene%b*abs(sin(progress%y(1))) &
         - progress%y(5))
      if (.not. all(ieee_is_finite(progress%y)) .or. progress%events > most_events) then
         call fail(error, err_numerical, 'the integration fails at t = ' &
            //trim(real_to_text(progress%t))//' s: raise rtol')
      end if
      if (allocated(error) .or. event == 0) return
      progress%events = progress%events + 1
      associate (number => functions(event)%number)
         progress%has_overturned = number == of_overturning .or. number == of_overturning + 1
         call change_regime(scene, number, progress%t, h, progress%y, series, regime)
      end associate
   end subroutine take_step

   !> Begin the series of a step with state and ground motion.
   subroutine begin_step(motion, interval, longest, series, progress)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      real(wp), intent(in) :: longest
      !! [s]
      type(base_series_t), intent(inout) :: series
      type(progress_t), intent(in) :: progress
      real(wp) :: ground(0:highest_order), upward(0:highest_order)
      integer :: known

      ground = 0
      upward = 0
      known = highest_order
      call expand_ground(motion, interval, progress%t, longest, known, ground, upward)
      ground(known + 1:) = 0
      upward(known + 1:) = 0
      call set_state(progress%y, ground, upward, series)
   end subroutine begin_step

   !> Record the start of a run without duration.
   subroutine observe_start(scene, motion, series, regime, record, progress)
      type(base_scene_t), intent(in) :: scene
      type(motion_t), intent(in) :: motion
      type(base_series_t), intent(inout) :: series
      type(base_regime_t), intent(in) :: regime
      type(base_record_t), intent(inout) :: record
      type(progress_t), intent(in) :: progress

      call begin_step(motion, interval_at(motion, 0.0_wp), 0.0_wp, series, progress)
      call expand(scene, regime%base_mode_t, 1, series)
      call observe_step(scene, regime, 0.0_wp, 0.0_wp, series, record)
   end subroutine observe_start

   !> Set the largest last terms of the series. The settlement of the edges, on which all forces
   !> depend, sets the size of the states: it is far smaller than the motion.
   subroutine allow_terms(scene, progress)
      type(base_scene_t), intent(in) :: scene
      type(progress_t), intent(inout) :: progress
      real(wp) :: length, speed
      !! [m], [m/s]
      integer :: free

      free = scene%frame%free
      length = share*progress%rtol*progress%settlement
      speed = length*sqrt(2*scene%b*scene%kappa)
      associate (allowed => progress%allowed)
         allowed(1:6) = [length/scene%b, speed/scene%b, length, speed, length, speed]
         allowed(7:6 + free) = length
         allowed(7 + free:) = speed
      end associate
   end subroutine allow_terms

   !> Length at which the last two terms of all series are small [s].
   pure real(wp) function accurate_length(progress, series, longest) result(h)
      type(progress_t), intent(in) :: progress
      type(base_series_t), intent(in) :: series
      real(wp), intent(in) :: longest
      !! [s]
      integer :: i, free

      h = longest
      free = size(series%q, 2)
      associate (of => series, n => series%order)
         call shorten(of%theta, 1)
         call shorten(of%theta_dot, 2)
         call shorten(of%x, 3)
         call shorten(of%x_dot, 4)
         call shorten(of%z, 5)
         call shorten(of%z_dot, 6)
         do i = 1, free
            call shorten(of%q(:, i), 6 + i)
            call shorten(of%q_dot(:, i), 6 + free + i)
         end do
      end associate

   contains

      !> Shorten the step until the last two terms of a state are allowed.
      pure subroutine shorten(c, i)
         real(wp), intent(in) :: c(0:highest_order)
         integer, intent(in) :: i
         real(wp) :: last, before

         associate (n => series%order, allowed => progress%allowed(i))
            last = abs(c(n))
            before = weight*abs(c(n - 1))
            if (last*h**n > allowed) h = (allowed/last)**(1.0_wp/n)
            if (before*h**(n - 1) > allowed) h = (allowed/before)**(1.0_wp/(n - 1))
         end associate
      end subroutine shorten
   end function accurate_length

   !> Evaluate the states at the end of a step.
   pure subroutine move_states(series, h, y)
      type(base_series_t), intent(in) :: series
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(inout) :: y(:)
      !! (states)
      integer :: i, free

      free = size(series%q, 2)
      associate (of => series, n => series%order)
         y(1:6) = [series_value(of%theta(:n), h), series_value(of%theta_dot(:n), h), &
            series_value(of%x(:n), h), series_value(of%x_dot(:n), h), series_value(of%z(:n), h), &
            series_value(of%z_dot(:n), h)]
         do i = 1, free
            y(6 + i) = series_value(of%q(:n, i), h)
            y(6 + free + i) = series_value(of%q_dot(:n, i), h)
         end do
      end associate
   end subroutine move_states

   !> Check the number of steps and the caller's request to stop.
   subroutine check_work(case, control, progress, error)
      type(case_t), intent(in) :: case
      type(control_t), intent(in) :: control
      type(progress_t), intent(in) :: progress
      type(error_t), allocatable, intent(out) :: error

      if (is_cancelled(control)) then
         call fail(error, err_interrupt, 'interrupted at t = '//trim(real_to_text(progress%t)) &
            //' s')
      else if (progress%steps > case%solver%max_steps) then
         call fail(error, err_numerical, 'more than &solver max_steps steps by t = ' &
            //trim(real_to_text(progress%t))//' s, theta = '//trim(real_to_text(progress%y(1))) &
            //': raise max_steps or rtol, or shorten t_end', 'too_many_steps')
      end if
   end subroutine check_work

end module rwmf_simulation_base_base_run
