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

   public :: base_motion_t, run_on_base, begin_on_base, advance_on_base, expand_present
   public :: result_on_base

   integer, parameter :: least_order = 6
   real(wp), parameter :: share = 0.01_wp
   !! part of the tolerance for the last term of a series [-]
   real(wp), parameter :: weight = 0.1_wp
   !! of the term before the last one [-]

   !> Scene, state and records of a run.
   type :: base_motion_t
      type(base_scene_t) :: scene
      type(base_regime_t) :: regime
      type(base_record_t) :: record
      type(base_series_t) :: series
      !! that of the last step, or of the present state
      type(base_function_t), allocatable :: functions(:)
      !! functions that end the regime
      real(wp) :: t = 0
      !! [s]
      real(wp), allocatable :: y(:)
      !! (states) as of `set_state`
      real(wp), allocatable :: allowed(:)
      !! (states) largest last term of their series
      real(wp) :: settlement
      !! largest settlement of an edge so far [m]
      real(wp) :: rtol
      !! relative tolerance [-]
      integer :: highest
      !! order beyond which steps become shorter instead
      integer :: events = 0
      !! events since the time last advanced
      integer(i8) :: steps = 0
      integer(i8) :: evaluations = 0
      logical :: has_overturned = .false.
   end type base_motion_t

contains

   !> Integrate a case with `&base`.
   !>
   !> Errors: those of `begin_on_base` and `advance_on_base`.
   subroutine run_on_base(case, motion, control, result, error)
      type(case_t), intent(in) :: case
      !! valid case whose frame has T_s
      type(motion_t), intent(in) :: motion
      type(control_t), intent(in) :: control
      type(result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error
      type(base_motion_t) :: wall

      call begin_on_base(case, 0.0_wp, wall, error)
      if (allocated(error)) return
      call advance_on_base(case, motion, case%solver%t_end, control, wall, error)
      if (allocated(error)) return
      call expand_present(motion, wall, wall%record)
      call result_on_base(case, wall, result)
   end subroutine run_on_base

   !> Begin at rest or with the rotation of `&initial`.
   !>
   !> Errors: `err_numerical` for another method, `err_input` if the base crushes under the wall at
   !> rest.
   subroutine begin_on_base(case, t_begin, wall, error)
      type(case_t), intent(in) :: case
      !! valid case whose frame has T_s
      real(wp), intent(in) :: t_begin
      !! [s]
      type(base_motion_t), intent(out) :: wall
      type(error_t), allocatable, intent(out) :: error

      if (case%solver%method /= 'auto' .and. case%solver%method /= 'taylor') then
         call fail(error, err_numerical, "&base is integrated by 'taylor' only, not by '" &
            //case%solver%method//"'", 'not_practised')
         return
      end if
      call build_base_scene(case, wall%scene, error)
      if (allocated(error)) return
      allocate (wall%y(state_count(wall%scene)), wall%allowed(state_count(wall%scene)), &
         source=0.0_wp)
      if (allocated(case%initial)) then
         wall%y(1) = case%initial%theta_over_alpha*wall%scene%alpha
         wall%y(2) = case%initial%theta_dot
      end if
      wall%t = t_begin
      wall%y(5) = settlement_at_rest(wall%scene, wall%y(1))
      wall%settlement = -wall%scene%z_0
      wall%rtol = case%solver%rtol
      wall%highest = min(max(8, 2*nint(-0.55_wp*log10(wall%rtol)) + 2), highest_order - 1, &
         highest_degree)
      call begin_regime(wall%scene, wall%y, wall%regime)
      call create_series(wall%scene, wall%series)
      call create_record(case, wall%scene, wall%regime, wall%y, wall%record, error)
      allocate (wall%functions(size(wall%regime%passed)))
   end subroutine begin_on_base

   !> Advance to a time, or until the wall overturns.
   !>
   !> Errors: `err_numerical` after too many steps, `err_interrupt`.
   subroutine advance_on_base(case, motion, t_end, control, wall, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t_end
      !! [s]
      type(control_t), intent(in) :: control
      type(base_motion_t), intent(inout) :: wall
      type(error_t), allocatable, intent(out) :: error

      do while (wall%t < t_end .and. .not. wall%has_overturned)
         call take_step(case, motion, t_end, wall, error)
         if (allocated(error)) return
         ! check the number of steps and the caller's request to stop
         if (is_cancelled(control)) then
            call fail(error, err_interrupt, 'interrupted at t = '//trim(real_to_text(wall%t))//' s')
         else if (wall%steps > case%solver%max_steps) then
            call fail(error, err_numerical, 'more than &solver max_steps steps by t = '//trim( &
               real_to_text(wall%t))//' s, theta = '//trim(real_to_text(wall%y(1))) &
               //': raise max_steps or rtol, or shorten t_end', 'too_many_steps')
         end if
         if (allocated(error)) return
      end do
   end subroutine advance_on_base

   !> Expand the series of the present state, and record it.
   subroutine expand_present(motion, wall, record)
      type(motion_t), intent(in) :: motion
      type(base_motion_t), intent(inout) :: wall
      type(base_record_t), intent(inout) :: record

      call begin_step(motion, interval_at(motion, wall%t), 0.0_wp, wall)
      call expand(wall%scene, wall%regime%base_mode_t, 1, wall%series)
      call observe_step(wall%scene, wall%regime, wall%t, 0.0_wp, wall%series, record)
   end subroutine expand_present

   !> Fill the result of a run that ends at the present time.
   subroutine result_on_base(case, wall, result)
      type(case_t), intent(in) :: case
      type(base_motion_t), intent(inout) :: wall
      type(result_t), intent(inout) :: result

      result%steps = wall%steps
      result%rhs_evaluations = wall%evaluations
      result%t_end = wall%t
      result%final_state = wall%y
      result%overturned = wall%has_overturned
      call fill_base_result(case, wall%scene, wall%regime, wall%record, wall%y, result)
   end subroutine result_on_base

   !> Take a step, which ends at an event, a knot of the motion or the end of its series.
   subroutine take_step(case, motion, t_end, wall, error)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t_end
      type(base_motion_t), intent(inout) :: wall
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_events = 1000
      real(wp) :: h, longest, reach, t_next
      integer :: event, interval, n
      integer :: i, free

      interval = interval_at(motion, wall%t)
      t_next = min(interval_end(motion, interval), t_end)
      longest = t_next - wall%t
      call begin_step(motion, interval, longest, wall)
      call allow_terms(wall)
      associate (scene => wall%scene, regime => wall%regime, series => wall%series)
         do
            call expand(scene, regime%base_mode_t, min(max(series%order + 2, least_order), &
               wall%highest), series)
            reach = accurate_length(wall, longest)
            if (series%order == wall%highest .or. reach >= longest) exit
         end do
         wall%evaluations = wall%evaluations + series%order + 1
         call collect_functions(scene, regime, case%model%overturning_angle, series, &
            wall%functions, n)
         call find_event(wall%functions(:n), series%order, reach, event, h)
         call observe_step(scene, regime, wall%t, h, series, wall%record)
         ! evaluate the states at the end of a step
         free = size(series%q, 2)
         associate (of => series, n => series%order)
            wall%y(1:6) = [series_value(of%theta(:n), h), series_value(of%theta_dot(:n), h), &
               series_value(of%x(:n), h), series_value(of%x_dot(:n), h), series_value(of%z(:n), &
               h), series_value(of%z_dot(:n), h)]
            do i = 1, free
               wall%y(6 + i) = series_value(of%q(:n, i), h)
               wall%y(6 + free + i) = series_value(of%q_dot(:n, i), h)
            end do
         end associate
         wall%steps = wall%steps + 1_i8
         if (event == 0 .and. h >= longest) then
            wall%t = t_next
         else
            wall%t = wall%t + h
         end if
         if (h > 0) then
            wall%events = 0
            regime%passed = .false.
         end if
         wall%settlement = max(wall%settlement, scene%b*abs(sin(wall%y(1))) - wall%y(5))
         if (.not. all(ieee_is_finite(wall%y)) .or. wall%events > most_events) then
            call fail(error, err_numerical, 'the integration fails at t = ' &
               //trim(real_to_text(wall%t))//' s: raise rtol')
         end if
         if (allocated(error) .or. event == 0) return
         wall%events = wall%events + 1
         associate (number => wall%functions(event)%number)
            wall%has_overturned = number == of_overturning .or. number == of_overturning + 1
            call change_regime(scene, number, wall%t, h, wall%y, series, regime)
         end associate
      end associate
   end subroutine take_step

   !> Begin the series of a step with state and ground motion.
   subroutine begin_step(motion, interval, longest, wall)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      real(wp), intent(in) :: longest
      !! [s]
      type(base_motion_t), intent(inout) :: wall
      real(wp) :: ground(0:highest_order), upward(0:highest_order)
      integer :: known

      ground = 0
      upward = 0
      known = highest_order
      call expand_ground(motion, interval, wall%t, longest, known, ground, upward)
      ground(known + 1:) = 0
      upward(known + 1:) = 0
      call set_state(wall%y, ground, upward, wall%series)
   end subroutine begin_step

   !> Set the largest last terms of the series. The settlement of the edges, on which all forces
   !> depend, sets the size of the states: it is far smaller than the motion.
   subroutine allow_terms(wall)
      type(base_motion_t), intent(inout) :: wall
      real(wp) :: length, speed
      !! [m], [m/s]

      associate (scene => wall%scene, free => wall%scene%frame%free, allowed => wall%allowed)
         length = share*wall%rtol*wall%settlement
         speed = length*sqrt(2*scene%b*scene%kappa)
         allowed(1:6) = [length/scene%b, speed/scene%b, length, speed, length, speed]
         allowed(7:6 + free) = length
         allowed(7 + free:) = speed
      end associate
   end subroutine allow_terms

   !> Length at which the last two terms of all series are small [s].
   pure real(wp) function accurate_length(wall, longest) result(h)
      type(base_motion_t), intent(in) :: wall
      real(wp), intent(in) :: longest
      !! [s]
      integer :: i, free

      h = longest
      free = wall%scene%frame%free
      associate (of => wall%series)
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

         associate (n => wall%series%order, allowed => wall%allowed(i))
            last = abs(c(n))
            before = weight*abs(c(n - 1))
            if (last*h**n > allowed) h = (allowed/last)**(1.0_wp/n)
            if (before*h**(n - 1) > allowed) h = (allowed/before)**(1.0_wp/(n - 1))
         end associate
      end subroutine shorten
   end function accurate_length

end module rwmf_simulation_base_base_run
