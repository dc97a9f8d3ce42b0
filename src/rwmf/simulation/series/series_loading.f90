!> Loading of the lanes of a series: new runs, next intervals of the motion, states after events.
!> `leave_series` returns the states to the runs.
module rwmf_simulation_series_series_loading
   use rwmf_core_control, only: control_t
   use rwmf_core_error, only: err_numerical, fail
   use rwmf_core_kinds, only: i8, wp
   use rwmf_integrator_interface_integrator, only: step_too_small
   use rwmf_integrator_series_series_lanes, only: left, most_terms_of_series, right, &
      series_lanes_t, series_width
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   use rwmf_model_elements, only: axis_row, chord_row, line_rows, rise_row
   use rwmf_model_drift_limits, only: drift_ratios
   use rwmf_model_effects_numbers, only: inerter_effect, p_delta_effect
   use rwmf_model_lanes, only: line_coefficients
   use rwmf_model_equation, only: cable_force_at, enter_interval, enter_side, equation_t, &
      frame_displacement, frame_mass, interval_of
   use rwmf_model_hysteresis_spring_set, only: renew_window
   use rwmf_model_scene, only: axis_term, chord_term, line_term, rise_term
   use rwmf_model_system_assembly, only: second_derivative
   use rwmf_model_system_lift_off, only: find_uplift_acceleration
   use rwmf_model_system_rest_after_chatter, only: inverse_inertia
   use rwmf_motion_ground_motion, only: expand_ground, fastest_rate, interval_end, &
      interval_last, is_curved, is_piecewise_linear, line_of, line_t, vertical_line_of
   use rwmf_simulation_hybrid_elastic_chatter, only: skip_chatter
   use rwmf_simulation_hybrid_hybrid_loop, only: check_steps, stay_at_rest
   use rwmf_simulation_hybrid_transitions, only: negligible
   use rwmf_simulation_lanes_batch, only: lane_state_t
   use rwmf_simulation_recorder_recorder, only: recorder_t
   use rwmf_simulation_series_series_batch, only: needs_rises, series_batch_t
   use rwmf_simulation_series_series_demands, only: follow_lane, list_demands, &
      load_demands
   use rwmf_simulation_state_hybrid_state, only: check_progress, has_ended, mode_rest, progress_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: join_series, load_coefficients, load_curves, enter_series, leave_series, pass_knots, &
      shorten_steps, check_work

contains

   !> Add a lane with a new run to the batch.
   subroutine join_series(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      real(wp), parameter :: angle = 1.5_wp
      !! phase angle of the fastest vibration in a step [rad]
      real(wp), parameter :: part = 0.1_wp
      !! part of the absolute tolerance beside that of the largest rotation so far [-]
      real(wp), parameter :: most = 0.3_wp, most_with_pulse = 0.05_wp
      !! largest part of the tolerance for the last term of a step [-]. The knots of a record
      !! shorten most steps beyond need, those of a pulse do not
      real(wp), parameter :: span = 30
      !! phase angle over which errors may add up with this part [rad]

      batch%is_busy(i) = .true.
      batch%lanes%is_busy(i) = 0
      if (allocated(lane%error)) return
      lane%hybrid%progress = progress_t()
      call load_coefficients(lane%equation, i, batch)
      associate (lanes => batch%lanes, equation => lane%equation, hybrid => lane%hybrid, &
         tolerance => lane%integrator%tolerance)
         lanes%rtol(i) = tolerance%rtol
         lanes%least_size(i) = part*tolerance%atol(1)
         lanes%frequency(i) = max(equation%p%omega_s, sqrt(equation%p%g_over_R))
         ! The error of a step is a small part of the last term. Damping bounds the sum of the
         ! errors; without damping they add up over the run.
         lanes%allowance(i) = merge(most, most_with_pulse, is_piecewise_linear(equation%motion)) &
            *min(1.0_wp, span*max(equation%p%xi_s, 1/(lanes%frequency(i)*lane%t_end)))
         lanes%longest(i) = angle/max(lanes%frequency(i), fastest_rate(equation%motion))
         lanes%lower(i) = 0
         call find_last(equation, hybrid%drifts, hybrid%overturning_angle, batch%last(i, :))
         lanes%upper(i, :) = batch%last(i, :)
         lanes%turn(i) = 0
         lanes%above(i) = 0
         lanes%top(i, :) = 0
         lanes%t_top(i, :) = 0
         lanes%fastest(i) = lane%recorder%theta_dot_ends
         lanes%top_speed(i) = 0
         lanes%factor(i) = hybrid%restitution%e
         ! a table of factors is for the common transitions
         if (allocated(hybrid%restitution%speed)) lanes%factor(i) = 0
         lanes%negligible(i) = negligible*hybrid%rtol
         lanes%settled(i) = max(hybrid%settled_angle, lanes%negligible(i))
         lanes%impacts(i) = 0
         lanes%steps(i) = 0
      end associate
      if (.not. allocated(batch%demands)) call list_demands(lane%recorder, &
         lane%equation, batch)
      call enter_series(lane, i, batch)
   end subroutine join_series

   !> Find the rotations at which the run ends: overturned, or with a drift at its limit.
   subroutine find_last(equation, drifts, overturning, last)
      type(equation_t), intent(inout) :: equation
      !! unchanged on return
      integer, intent(in) :: drifts
      !! number of drifts with a limit
      real(wp), intent(in) :: overturning
      !! [rad]
      real(wp), intent(out) :: last(2)
      !! by side [rad]
      integer, parameter :: most = 80
      type(bracket_t) :: bracket
      real(wp) :: ratio(drifts), rate(drifts), phi, step
      integer :: i, k, m, side

      last = overturning
      if (drifts == 0) return
      side = equation%state%side
      do m = left, right
         equation%state%side = 2*m - 3
         phi = overturning
         bracket = bracket_between(0.0_wp, overturning)
         do k = 1, most
            call drift_ratios(equation, equation%state%side*[phi, 1.0_wp], ratio, rate)
            i = maxloc(abs(ratio), 1)
            if (abs(ratio(i)) < 1 .and. k == 1) exit
            call narrow(bracket, abs(ratio(i)) >= 1, phi)
            step = (1 - abs(ratio(i)))/abs(rate(i))
            last(m) = phi
            if (.not. bracket%is_open .or. abs(step) <= 4*epsilon(phi)*phi) exit
            phi = keep_inside(bracket, phi + step)
         end do
      end do
      equation%state%side = side
   end subroutine find_last

   !> Load the coefficients of the equation of motion, for both sides.
   subroutine load_coefficients(equation, i, batch)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      integer :: m

      associate (lanes => batch%lanes, p => equation%p, geometry => equation%geometry)
         lanes%inverse_radius(i) = 1/p%R
         lanes%cosine(i) = geometry%cos_alpha
         lanes%sine_wall(i) = geometry%sine_wall
         lanes%inertia(i) = equation%inertia
         lanes%gravity(i) = p%g_over_R
         lanes%mass(i) = merge(frame_mass(equation), 0.0_wp, equation%has_frame)
         lanes%damping(i) = p%two_xi_omega
         do m = left, right
            lanes%sine_link(i, m) = geometry%sine_link(2*m - 3)
            lanes%sine_lever(i, m) = geometry%sine_lever(2*m - 3)
         end do
         lanes%cable(i, :) = 0
         lanes%cable_slope(i, :) = 0
         lanes%excited(i) = equation%floors%excited_mass_ratio
         lanes%weight_share(i) = equation%uplift%weight_share
         associate (terms => equation%scene%terms)
            lanes%has_straight_cable = any(terms%effect == line_term)
            lanes%has_second_cable = any(terms%effect == line_term .and. terms%n > 1)
            lanes%has_fuses = equation%may_hold .and. any(terms%effect == chord_term)
         end associate
         lanes%has_rises = needs_rises(equation)
         lanes%has_branches = equation%has_bilinear_springs
         lanes%has_curves = .not. is_piecewise_linear(equation%motion)
         lanes%curve(i, :, :) = 0
         lanes%is_plain = .not. (lanes%has_curves .or. equation%has_vertical &
            .or. any(equation%scene%terms%effect == chord_term) .or. lanes%has_rises &
            .or. lanes%has_straight_cable) &
            .and. abs(lanes%excited(i) - 1) <= 0
         do m = 1, size(equation%scene%terms)
            associate (coef => equation%state%coef(1, equation%scene%terms(m)%coef))
               select case (equation%scene%terms(m)%effect)
               case (inerter_effect)
                  lanes%inerter(i) = 0.5_wp*coef
                  lanes%has_inerter = .true.
                  lanes%is_plain = .false.
               case default
                  ! `load_branches` loads springs, gravity on the frame and cable
               end select
            end associate
         end do
      end associate
      call load_branches(equation, i, batch, has_all=.true.)
   end subroutine load_coefficients

   !> Load the coefficients that change with the branches of the springs, for both sides.
   subroutine load_branches(equation, i, batch, has_all)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      logical, intent(in) :: has_all
      !! load terms without springs, too
      integer :: j, k, m, side

      associate (lanes => batch%lanes, p => equation%p, state => equation%state)
         lanes%stiffness(i) = state%frame_slope
         lanes%offset(i) = state%frame_offset/p%R
         do m = left, right
            lanes%uplift(i, m) = state%uplift_acceleration(2*m - 3)
         end do
         lanes%gain(i) = inverse_inertia(equation)
         do k = 1, size(equation%scene%terms)
            if (equation%scene%terms(k)%effect == p_delta_effect) lanes%stiffness(i) &
               = lanes%stiffness(i) - state%coef(1, equation%scene%terms(k)%coef)/lanes%mass(i)
            if (.not. (has_all .or. equation%scene%terms(k)%has_springs)) cycle
            do m = left, right
               side = 2*m - 3
               select case (equation%scene%terms(k)%effect)
               case (axis_term)
                  associate (row => axis_row(equation%elements, state%springs, side, p%R))
                     lanes%cable(i, m) = row(1)
                     lanes%cable_slope(i, m) = row(2)
                  end associate
               case (line_term)
                  associate (rows => line_rows(equation%elements, state%springs, side, p%R))
                     do j = 1, equation%scene%terms(k)%n
                        lanes%straight(i, :, m, j) = rows(line_coefficients*(j - 1) &
                           + 1:line_coefficients*j)
                     end do
                  end associate
               case (chord_term)
                  associate (row => chord_row(equation%elements, state%springs, side, p%R))
                     lanes%fuse(i, m) = row(1)
                     lanes%fuse_slope(i, m) = 0.5_wp*row(2)
                     lanes%damper(i) = 0.5_wp*row(3)
                  end associate
               case (rise_term)
                  lanes%rise(i, :, m) = rise_row(equation%elements, state%springs, side, p%R)
               case default
                  ! loaded with the coefficients that do not change
               end select
            end do
         end do
      end associate
   end subroutine load_branches

   !> Load the series of a pulse at the times of all lanes inside it.
   subroutine load_curves(lanes, batch)
      type(lane_state_t), intent(in) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      real(wp) :: ground(0:most_terms_of_series), upward(0:most_terms_of_series)
      integer :: i, k, order

      do i = 1, series_width
         if (.not. batch%lanes%is_busy(i) > 0) cycle
         associate (equation => lanes(i)%equation, series => batch%lanes)
            if (.not. is_curved(equation%motion, batch%interval(i))) then
               if (batch%is_curved(i)) series%curve(i, :, :) = 0
               batch%is_curved(i) = .false.
               cycle
            end if
            batch%is_curved(i) = .true.
            order = batch%kernels%order
            call expand_ground(equation%motion, batch%interval(i), series%t(i), 0.0_wp, order, &
               ground, upward)
            series%ground(i, :) = [ground(0:1), series%t(i)]
            do k = 2, order
               series%curve(i, k, 1) = ground(k)
            end do
            if (.not. equation%has_vertical) cycle
            series%upward(i, :) = upward(0:1)
            do k = 2, order
               series%curve(i, k, 2) = upward(k)
            end do
         end associate
      end do
   end subroutine load_curves

   !> Load the branches of the springs and their window of the rotation.
   !>
   !> A bound within round-off of the rotation, from which the motion leads away, is the end of the
   !> previous branch or its turn. It then equals the rotation.
   subroutine load_window(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      real(wp), parameter :: near(2) = [1.0e-17_wp, 1.0e-13_wp]
      !! round-off of the ends of a window, absolute [rad] and relative [-]
      logical, allocatable :: has_turned(:)
      real(wp) :: ahead
      integer :: k, m, side

      associate (lanes => batch%lanes, equation => lane%equation, state => lane%equation%state)
         ! the strokes that have turned on the present side
         if (allocated(state%is_beyond)) has_turned = state%is_beyond
         call find_uplift_acceleration(equation%model_t, state, lane%hybrid%y)
         call load_branches(equation, i, batch, has_all=.false.)
         side = state%side
         ! the present side is the last one
         do k = 1, 2
            state%side = -state%side
            m = (3 + state%side)/2
            if (allocated(has_turned)) state%is_beyond = has_turned .and. k == 2
            call renew_window(equation%model_t, state)
            lanes%upper(i, m) = min(batch%last(i, m), merge(state%high, -state%low, state%side > 0))
            lanes%lower(i) = max(0.0_wp, merge(state%low, -state%high, state%side > 0))
         end do
         ahead = lanes%rate(i)
         if (abs(ahead) <= 0) then
            ahead = 1
            if (lanes%phi(i) > 0) ahead = side*second_derivative(equation, lane%hybrid%t, &
               lane%hybrid%y)
         end if
         lanes%turn(i) = 0
         if (state%ends_at_peak) lanes%turn(i) = sign(1.0_wp, ahead)
         if (lanes%lower(i) > 0 .and. ahead > 0 .and. abs(lanes%phi(i) - lanes%lower(i)) &
             <= near(1) + near(2)*lanes%phi(i)) then
            lanes%lower(i) = lanes%phi(i)
            lanes%multiplicity(i) = merge(1, 2, lanes%rate(i) > 0)
         end if
         lanes%above(i) = 0
         if (ahead < 0 .and. abs(lanes%phi(i) - lanes%upper(i, m)) <= near(1) &
             + near(2)*lanes%phi(i)) then
            lanes%upper(i, m) = lanes%phi(i)
            lanes%above(i) = merge(1, 2, lanes%rate(i) < 0)
         end if
      end associate
   end subroutine load_window

   !> Prepare a lane for a common step. If its run is over, the lane does not move.
   subroutine enter_series(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      type(control_t) :: no_control

      batch%lanes%is_busy(i) = 0
      batch%has_ended = .true.
      associate (hybrid => lane%hybrid, equation => lane%equation)
         do
            if (allocated(lane%error)) return
            if (hybrid%t >= lane%t_end .or. has_ended(hybrid)) return
            call check_steps(hybrid, lane%integrator, no_control, lane%error)
            if (allocated(lane%error)) return
            if (hybrid%mode /= mode_rest) exit
            call stay_at_rest(hybrid, equation, lane%recorder, lane%t_end, lane%error)
            if (allocated(lane%error)) return
            call check_progress(hybrid%progress, size(hybrid%y), hybrid%t, lane%error)
         end do
         call skip_chatter(hybrid, equation, lane%recorder, negligible*hybrid%rtol &
            *max(lane%recorder%theta_max, -lane%recorder%theta_min), min(lane%t_end, &
            interval_end(equation%motion, interval_of(equation))))
         if (hybrid%t >= lane%t_end) return
         batch%lanes%is_busy(i) = 1
         batch%lanes%t(i) = hybrid%t
         batch%lanes%side(i) = equation%state%side
         batch%lanes%phi(i) = abs(hybrid%y(1))
         batch%lanes%rate(i) = equation%state%side*hybrid%y(2)
         batch%lanes%multiplicity(i) = 0
         if (.not. abs(hybrid%y(1)) > 0) batch%lanes%multiplicity(i) = merge(1, 2, &
            batch%lanes%rate(i) > 0)
         if (equation%has_bilinear_springs) call load_window(lane, i, batch)
         batch%interval(i) = interval_of(equation) - 1
         call enter_next_interval(lane, i, batch)
         call load_demands(lane, i, batch)
      end associate
   end subroutine enter_series

   !> Move lanes at the ends of their intervals to the next ones.
   subroutine pass_knots(lanes, batch)
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      integer :: i, left_over

      call pass_plain_knots(ubound(batch%lines, 2), batch%lines, batch%interval, batch%lanes, &
         left_over)
      if (left_over == 0) return
      do i = 1, series_width
         if (batch%lanes%is_at_limit(i) > 0) call enter_next_interval(lanes(i), i, batch)
      end do
   end subroutine pass_knots

   !> Move lanes to the next intervals if these are in the table and last for one step, as most
   !> intervals of a record do.
   pure subroutine pass_plain_knots(last, lines, interval, lanes, left_over)
      integer, intent(in) :: last
      !! number of the last interval in the table
      real(wp), intent(in) :: lines(6, 0:last)
      !! see `series_batch_t`
      integer, intent(inout) :: interval(series_width)
      type(series_lanes_t), intent(inout) :: lanes
      integer, intent(out) :: left_over
      !! number of lanes that remain at their limits
      real(wp) :: rest
      integer :: i, k

      left_over = 0
      do i = 1, series_width
         if (.not. lanes%is_at_limit(i) > 0) cycle
         k = min(interval(i) + 1, last)
         rest = lines(1, k) - lanes%t(i)
         if (.not. (rest > 0 .and. rest <= lanes%longest(i))) then
            left_over = left_over + 1
            cycle
         end if
         interval(i) = k
         lanes%is_at_limit(i) = 0
         lanes%limit(i) = lines(1, k)
         lanes%share(i) = rest
         lanes%length(i) = rest
         lanes%ground(i, 1) = lines(2, k)
         lanes%ground(i, 2) = lines(3, k)
         lanes%ground(i, 3) = lines(4, k)
         lanes%upward(i, 1) = lines(5, k)
         lanes%upward(i, 2) = lines(6, k)
      end do
   end subroutine pass_plain_knots

   !> Load the interval of the motion after the present one. At the end of the run the lane stops.
   subroutine enter_next_interval(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      type(line_t) :: line
      real(wp) :: limit, rest

      associate (lanes => batch%lanes, k => batch%interval(i))
         do
            if (lanes%t(i) >= lane%t_end) then
               call leave_series(lane, i, batch)
               batch%has_ended = .true.
               return
            end if
            k = k + 1
            limit = min(interval_end(lane%equation%motion, k), lane%t_end)
            line = line_of(lane%equation%motion, k)
            lanes%ground(i, 1) = line%a_0
            lanes%ground(i, 2) = line%slope
            lanes%ground(i, 3) = line%t_0
            line = vertical_line_of(lane%equation%motion, k, line)
            lanes%upward(i, 1) = line%a_0
            lanes%upward(i, 2) = line%slope
            rest = limit - lanes%t(i)
            if (rest > 8*epsilon(limit)*limit) exit
            lanes%t(i) = max(limit, lanes%t(i))
         end do
         lanes%limit(i) = limit
         lanes%share(i) = rest
         if (rest > lanes%longest(i)) lanes%share(i) = rest/(aint(rest/lanes%longest(i)) + 1)
         lanes%length(i) = lanes%share(i)
      end associate
   end subroutine enter_next_interval

   !> Return the state of a lane to its run. The lane does not move afterwards.
   subroutine leave_series(lane, i, batch)
      type(lane_state_t), intent(inout) :: lane
      integer, intent(in) :: i
      !! number of the lane in the batch
      type(series_batch_t), intent(inout) :: batch
      real(wp) :: u
      integer :: m, side

      associate (lanes => batch%lanes, hybrid => lane%hybrid, equation => lane%equation, &
                 recorder => lane%recorder)
         lanes%is_busy(i) = 0
         hybrid%t = lanes%t(i)
         side = nint(lanes%side(i))
         hybrid%y(:) = side*[lanes%phi(i), lanes%rate(i)]
         call follow_lane(lane, i, batch)
         call renew_window(equation%model_t, equation%state)
         lane%integrator%steps = lane%integrator%steps + nint(lanes%steps(i), i8)
         lanes%steps(i) = 0
         recorder%impacts = recorder%impacts + nint(lanes%impacts(i), i8)
         lanes%impacts(i) = 0
         recorder%theta_dot_ends = max(recorder%theta_dot_ends, lanes%fastest(i))
         recorder%theta_dot_max = max(recorder%theta_dot_max, lanes%top_speed(i))
         recorder%theta_max = max(recorder%theta_max, lanes%top(i, right))
         recorder%theta_min = min(recorder%theta_min, -lanes%top(i, left))
         ! Maxima of cable and frame at the largest rotations on both sides. The force of a tendon
         ! that yields or has yielded is largest at the largest rotation so far.
         do m = left, right
            side = 2*m - 3
            if (recorder%follows_cable) recorder%cable_max = max(recorder%cable_max, &
               cable_force_at(equation, side*lanes%top(i, m), side))
            if (.not. equation%has_frame) cycle
            u = abs(frame_displacement(equation, side, [side*lanes%top(i, m)]))
            if (.not. u > recorder%u_max) cycle
            recorder%u_max = u
            recorder%t_u_max = lanes%t_top(i, m)
         end do
      end associate
   end subroutine leave_series

   !> Shorten the series of lanes whose terms do not decay. Fail if a series is below the resolution
   !> of the time.
   subroutine shorten_steps(lanes, batch)
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      real(wp), parameter :: eighth = 0.125_wp
      integer :: i

      do i = 1, series_width
         if (batch%lanes%is_moving(i) >= batch%lanes%is_busy(i)) cycle
         batch%lanes%length(i) = eighth*batch%lanes%h(i)
         if (batch%lanes%length(i) > 8*spacing(batch%lanes%t(i))) cycle
         call leave_series(lanes(i), i, batch)
         batch%has_ended = .true.
         call fail(lanes(i)%error, err_numerical, step_too_small//'; t = ' &
            //trim(real_to_text(lanes(i)%hybrid%t))//' s')
      end do
   end subroutine shorten_steps

   !> Check the numbers of steps of all runs, and that their times advance.
   subroutine check_work(lanes, batch)
      type(lane_state_t), intent(inout) :: lanes(:)
      type(series_batch_t), intent(inout) :: batch
      integer, parameter :: few = 1000, many = 1000000
      !! number of common steps between two checks; a count at which a run must have advanced
      type(control_t) :: no_control
      real(wp) :: most
      integer :: i

      most = few
      do i = 1, series_width
         if (.not. batch%lanes%is_busy(i) > 0) cycle
         associate (lane => lanes(i), hybrid => lanes(i)%hybrid)
            lane%integrator%steps = lane%integrator%steps + nint(batch%lanes%steps(i), i8)
            batch%lanes%steps(i) = 0
            hybrid%t = batch%lanes%t(i)
            call check_steps(hybrid, lane%integrator, no_control, lane%error)
            hybrid%progress%count = many
            if (.not. allocated(lane%error)) call check_progress(hybrid%progress, 2, hybrid%t, &
               lane%error)
            most = min(most, real(hybrid%max_steps - lane%integrator%steps, wp))
            if (.not. allocated(lane%error)) cycle
            call leave_series(lane, i, batch)
            batch%has_ended = .true.
         end associate
      end do
      batch%steps_left = int(max(most, 0.0_wp))
   end subroutine check_work

end module rwmf_simulation_series_series_loading
