!> Turns of the rotation, ends of its window, impact and overturning, as watched functions.
module rwmf_simulation_events_rotation_events
   use rwmf_core_kinds, only: wp
   use rwmf_math_sign_changes, only: change_at_begin, no_change, one_change, polygon_t, roughness, &
      value_polygon
   use rwmf_model_hysteresis_bouc_wen, only: will_pass_zero
   use rwmf_simulation_events_step_view, only: fastest_angle, step_view_t
   use rwmf_simulation_events_watched_spans, only: changed_at_end, changes_in, functions_t, &
      monotone, span_t, watch_t
   use rwmf_simulation_state_result, only: event_branch, event_impact, event_overturned, &
      event_passage, event_peak
   implicit none
   private

   integer, parameter :: most_watches = 7

   public :: rotation_t, frame_state_t, keeps_direction, fastest_in

   !> Rotation, velocity and acceleration: the states 1 and 2. Without limits, turns are the only
   !> events.
   type, extends(functions_t) :: rotation_t
      integer :: direction = 0
      !! sign of theta' at the start of the step where theta' = 0; 0 if unknown
      logical :: knows_direction = .false.
      !! an acceleration against the direction is an error of the state
      logical :: has_limits = .false.
      logical :: is_rocking = .false.
      !! the base is a limit
      real(wp) :: overturning_angle = huge(1.0_wp)
      !! [rad]
      real(wp) :: known(2) = [huge(1.0_wp), -huge(1.0_wp)]
      !! smallest and largest rotation so far; a turn between them needs no search, unless its
      !! motion passes a limit [rad]
      logical :: has_turns = .true.
      !! false if further turns are round-off
   contains
      procedure :: watches => watch_rotation
   end type rotation_t

   !> Hysteretic state of a smooth frame [-], with its rate.
   type, extends(functions_t) :: frame_state_t
   contains
      procedure :: watches => watch_frame
   end type frame_state_t

contains

   !> Declare turns first: before the next turn, the end of a span shows whether the rotation has
   !> passed a limit.
   function watch_rotation(self, i, span) result(watches)
      class(rotation_t), intent(in) :: self
      integer, intent(in) :: i
      !! always 1
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)
      type(watch_t) :: list(most_watches)
      integer :: n

      n = 0
      if (self%has_turns) call watch_turns(self, span, list, n)
      if (self%has_limits) call watch_limits(self, span, list, n)
      list%which = i
      watches = list(:n)
   end function watch_rotation

   !> Watch the sign of theta'. A turn may be omitted that certainly lies inside all limits and
   !> between known rotations.
   subroutine watch_turns(self, span, list, n)
      class(rotation_t), intent(in) :: self
      type(span_t), intent(in) :: span
      type(watch_t), intent(inout) :: list(:)
      integer, intent(inout) :: n
      !! number of watches in the list
      type(watch_t) :: turn
      integer :: changes
      logical :: ends_beyond

      associate (v_a => span%a%f(1, 1), v_b => span%b%f(1, 1))
         ! a frame at standstill keeps its last loading direction
         if (self%step%equation%has_loading_direction .and. max(abs(v_a), abs(v_b)) <= 0) return
         turn = watch_t(1, 1, side=sign(1.0_wp, v_a), kind=event_peak)
         if (abs(v_a) <= 0) turn%side = sign(1.0_wp, merge(real(self%direction, wp), &
            span%a%f(1, 2), self%direction /= 0))
         changes = changes_in(span, turn)
         if (abs(v_a) <= 0 .and. self%direction == 0) then
            if (changes == change_at_begin) turn%side = -turn%side
            ends_beyond = .false.
         else
            ends_beyond = turn%side*v_b < 0 .or. (self%has_limits .and. abs(v_b) <= 0)
         end if
         if (changes == no_change .and. .not. ends_beyond) return
         if (changes == change_at_begin .and. self%knows_direction .and. .not. ends_beyond) return
         ! without acceleration at the start, only the end of the span shows a reversal there
         if (self%direction /= 0 .and. max(abs(v_a), abs(span%a%f(1, 2))) <= 0 &
             .and. .not. ends_beyond) return
         if (changes == one_change) then
            if (is_known(self, span)) return
            turn%course = monotone
         end if
         turn%starts_inside = self%knows_direction .and. abs(v_a) <= 0
         call add(turn, list, n)
         if (.not. ends_beyond .or. changes == one_change) return
         ! a turn within round-off of the end of the span
         turn%course = merge(changed_at_end, monotone, abs(v_b) <= 0)
         call add(turn, list, n)
      end associate
   end subroutine watch_turns

   !> Add a watch to a list.
   pure subroutine add(watch, list, n)
      type(watch_t), intent(in) :: watch
      type(watch_t), intent(inout) :: list(:)
      integer, intent(inout) :: n

      n = n + 1
      list(n) = watch
   end subroutine add

   !> Return whether a single turn lies between known rotations and certainly inside all limits.
   logical function is_known(self, span)
      class(rotation_t), intent(in) :: self
      type(span_t), intent(in) :: span
      real(wp) :: low, high, turn
      type(polygon_t) :: polygon
      real(wp) :: reach

      associate (equation => self%step%equation, state => self%step%equation%state, &
                 theta => span%a%f(1, 0))
         is_known = .not. (state%ends_at_peak .or. equation%has_loading_direction)
         ! from a limit of the window, only the turn shows whether the motion leaves it
         is_known = is_known .and. theta > state%low .and. theta < state%high
         if (.not. is_known) return
         high = min(state%high, self%overturning_angle)
         low = max(state%low, -self%overturning_angle)
         if (self%is_rocking .and. state%side > 0) low = max(low, 0.0_wp)
         if (self%is_rocking .and. state%side < 0) high = min(high, 0.0_wp)
         ! Bound on the rotation at a single turn in a span.
         !
         ! The turn lies within the cubic and its error. The bound also lies beyond the farther end,
         ! by four times the distance under a steady acceleration.
         associate (h => span%b%t - span%a%t, a => span%a%f(1, 0:1), b => span%b%f(1, 0:1))
            reach = 0.5_wp*h*(abs(a(2)) + abs(b(2)))
            polygon = value_polygon(h, a, b, roughness(fastest_angle(self%step, h), h, a, b))
            associate (c => polygon%c(:polygon%n), margin => polygon%margin(:polygon%n))
               if (b(2) > a(2)) then
                  turn = min(minval(c - margin), min(a(1), b(1)) - reach)
               else
                  turn = max(maxval(c + margin), max(a(1), b(1)) + reach)
               end if
            end associate
         end associate
         is_known = turn < min(high, self%known(2)) .and. turn > max(low, self%known(1))
      end associate
   end function is_known

   !> Watch the limits of the rotation. At equal rotations, the end of a window precedes impact and
   !> overturning.
   subroutine watch_limits(self, span, list, n)
      class(rotation_t), intent(in) :: self
      type(span_t), intent(in) :: span
      type(watch_t), intent(inout) :: list(:)
      integer, intent(inout) :: n
      !! number of watches in the list
      real(wp) :: level, side, ends(2)
      !! smallest and largest rotation at the end of the span, in `ends`; a turn may exceed it
      integer :: i

      associate (a => span%a%f(1, :), b => span%b%f(1, :), state => self%step%equation%state, &
                 angle => self%overturning_angle)
         ends = merge([-huge(1.0_wp), huge(1.0_wp)], [b(1), b(1)], n > 0)
         do i = -1, 1, 2
            ! a motion within round-off beyond a limit starts at the limit
            level = merge(max(state%high, a(1)), min(state%low, a(1)), i > 0)
            if (abs(level) >= angle .or. i*(ends((i + 3)/2) - level) <= 0) cycle
            if (self%is_rocking .and. state%side*level < 0) cycle
            call add(watch_t(1, 0, level, real(-i, wp), event_branch, monotone), list, n)
         end do
         side = state%side
         ! The first rotations after lift-off are below the tolerance of a method and may have
         ! either sign.
         if (self%is_rocking .and. .not. (side*a(1) <= 0 .and. side*a(2) >= 0 &
             .and. side*b(2) > 0)) call add(watch_t(1, 0, 0.0_wp, side, event_impact, monotone), &
            list, n)
         do i = -1, 1, 2
            if (i*ends((i + 3)/2) > angle) call add(watch_t(1, 0, i*angle, real(-i, wp), &
               event_overturned, monotone), list, n)
         end do
      end associate
   end subroutine watch_limits

   !> Declare the zero of the hysteretic force, which is monotone between the turns of the rotation.
   function watch_frame(self, i, span) result(watches)
      class(frame_state_t), intent(in) :: self
      integer, intent(in) :: i
      !! always 1
      type(span_t), intent(in) :: span
      type(watch_t), allocatable :: watches(:)

      allocate (watches(0))
      associate (equation => self%step%equation)
         if (will_pass_zero(equation)) watches = [watch_t(i, 0, side=-real( &
            equation%state%signs%loading_direction, wp), kind=event_passage, course=monotone)]
      end associate
   end function watch_frame

   !> Return whether the ends of a step show that theta' keeps its sign.
   pure logical function keeps_direction(step, direction)
      type(step_view_t), intent(in) :: step
      integer, intent(in), optional :: direction
      !! sign of theta' after a start with theta' = 0; absent or 0: unknown
      real(wp) :: middle(2), error

      associate (a => step%y_a(2), b => step%y_b(2))
         keeps_direction = a*b > 0
         if (present(direction) .and. abs(a) <= 0) keeps_direction = direction*b > 0 &
            .or. (direction == 0 .and. abs(b) > 0)
         if (.not. keeps_direction) return
         call bound_velocity(step, middle, error)
         keeps_direction = minval(sign(1.0_wp, b)*middle) > error
      end associate
   end function keeps_direction

   !> Upper bound of |theta'| in a step from its ends.
   pure real(wp) function fastest_in(step) result(fastest)
      type(step_view_t), intent(in) :: step
      real(wp) :: middle(2), error

      call bound_velocity(step, middle, error)
      fastest = max(abs(step%y_a(2)), abs(step%y_b(2)), maxval(abs(middle)) + error)
   end function fastest_in

   !> Compute velocity bounds in a step from the cubic of the rotation.
   !>
   !> This is `rate_polygon` written out, because most steps need nothing else.
   pure subroutine bound_velocity(step, middle, error)
      type(step_view_t), intent(in) :: step
      real(wp), intent(out) :: middle(2)
      !! Bernstein coefficients between both ends [rad/s]
      real(wp), intent(out) :: error
      !! error bound of both coefficients [rad/s]
      real(wp) :: bend(2)
      !! differences of the coefficients at one degree lower [rad/s]
      real(wp) :: mean, angle

      associate (h => step%t_b - step%t_a, a => step%y_a, b => step%y_b)
         mean = 3*((b(1) - a(1))/h) - a(2) - b(2)
         middle = [a(2) + 2*mean, b(2) + 2*mean]/3
         bend = [mean - a(2), b(2) - mean]
         angle = fastest_angle(step, h)
         error = angle*(abs(bend(2) - bend(1)) + angle*maxval(abs(bend)))/18
      end associate
   end subroutine bound_velocity

end module rwmf_simulation_events_rotation_events
