!> Taylor series of lanes: the equation of motion along a step, and the bits of every instruction
!> set and of lanes in another order.
program test_series
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_integrator_lane_kernels, only: best_level
   use rwmf_integrator_series_series_kernels, only: series_kernels_of, series_kernels_t
   use rwmf_integrator_series_series_lanes, only: series_lanes_t, series_width
   use rwmf_model_hysteresis_spring_set, only: load_to
   use rwmf_model_system_assembly, only: build_equation, enter_interval, enter_side, &
      equation_t, second_derivative
   use rwmf_motion_ground_motion, only: acceleration, interval_at, interval_end, motion_from_case, &
      motion_t, pass_lines_inside, piecewise_linear_motion, scan_lines
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_lanes_batch, only: lane_state_t
   use rwmf_simulation_series_series_batch, only: create_series_batch, is_served, series_batch_t
   use rwmf_simulation_series_series_loading, only: load_coefficients, load_curves
   implicit none

   character(*), parameter :: wall = "&wall h=2.0, b=0.5 / &impact rule='constant', e=0.9 / " &
      //"&motion kind='sine', a_max_g=0.5, T_p=0.6, cycles=4 / "
   character(*), parameter :: frame = '&frame T_s=0.8, gamma=3, xi_s=0.05 / '
   character(*), parameter :: cable = '&cable eta_0=1.0, eta_alpha=5.0 / '
   character(*), parameter :: springs = "&fuse eta_y=0.3, stroke_y=0.005, hardening=0.02 / " &
      //'&yielding u_y=0.02, hardening=0.05 / '
   character(*), parameter :: scenes(6) = [character(220) :: frame//cable, frame//cable//springs, &
      frame//"&cable eta_0=1.0, eta_alpha=5.0, law='truss' /", &
      frame//cable//'&damper c_over_m_w=0.5 / &inerter inertance_over_m_w=0.3 / ' &
      //'&vertical ratio=0.4 / &p_delta m_g_over_m_s=1.0 / ', &
      '&storeys m_over_m_w=3*1.0, k_over_m_w=3*400.0, height=1.5,1.0,1.5 / ' &
      //'&frame xi_s=0.05 / ', frame//springs//"&inerter inertance_over_m_w=0.3 / " &
      //"&cable eta_0=1.0, eta_alpha=5.0, law='truss', eta_y=1.1 / "]
   type(checks_t) :: checks

   if (checks%wants('equation')) call check_equation(is_pulse=.false.)
   if (checks%wants('pulse')) call check_equation(is_pulse=.true.)
   if (checks%wants('bits')) call check_bits()
   if (checks%wants('scans')) call check_scans()
   call checks%finish()

contains

   !> The second derivative of the series satisfies the equation of motion along the step, on both
   !> sides, in all formulations and with all effects, under a straight line or inside a pulse.
   subroutine check_equation(is_pulse)
      logical, intent(in) :: is_pulse
      integer, parameter :: order = 10
      real(wp), parameter :: h = 0.02_wp
      type(motion_t), target :: motion
      type(equation_t), target :: equation
      type(lane_state_t) :: lanes(series_width)
      type(series_batch_t) :: batch
      real(wp) :: x, phi, rate, bend, known, error
      character(9) :: formulation
      integer :: f, i, k, side

      do f = 1, 2*size(scenes) + 1
         formulation = merge('symmetric', 'exact    ', f <= size(scenes))
         if (f > 2*size(scenes)) formulation = 'published'
         motion = piecewise_linear_motion([0.0_wp, 1.0_wp], [0.7_wp, -2.0_wp], &
            vertical_ratio=0.4_wp)
         if (is_pulse) motion = pulse()
         call build(wall//trim(scenes(mod(f - 1, size(scenes)) + 1))//"&model formulation='" &
            //trim(formulation)//"' /", motion, equation)
         ! to the side of the yielded fuse and back
         call load_to(equation%model_t, equation%state, 0.03_wp)
         call checks%that(is_served(equation), 'the series serves the scene')
         do side = -1, 1, 2
            call create_series_batch(1, order, batch)
            call fill(equation, side, h, batch)
            batch%interval = 1
            do i = 1, series_width
               lanes(i)%equation => equation
            end do
            call load_curves(lanes, batch)
            call batch%kernels%expand_lanes(batch%lanes)
            call enter_side(equation%model_t, equation%state, side)
            error = 0
            do i = 1, series_width
               do k = 0, 4
                  x = 0.25_wp*k
                  call evaluate_series(batch%lanes%p(i, :order), x, phi, rate, bend)
                  known = side*second_derivative(equation, batch%lanes%t(i) + x*h, &
                     side*[phi, rate/h])
                  error = max(error, abs(bend/h**2 - known)/max(1.0_wp, abs(known)))
               end do
            end do
            call checks%that(error < 1.0e-10_wp, 'equation of motion, '//trim(scenes(mod(f - 1, &
               size(scenes)) + 1)))
         end do
      end do
   end subroutine check_equation

   !> Motion of `wall`, with a vertical one.
   function pulse() result(motion)
      type(motion_t) :: motion
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(wall//'&vertical ratio=0.4 / &solver t_end=4.0 /', 'pulse', case, error)
      call checks%no_error(error, 'pulse')
      motion = motion_from_case(case)
   end function pulse

   !> Lanes at one level and in one order against those at other levels and in reverse, with and
   !> without the ends of branches.
   subroutine check_bits()
      integer, parameter :: orders(2) = [8, 10]
      type(motion_t), target :: motion
      type(equation_t) :: equation
      integer :: k, m

      motion = piecewise_linear_motion([0.0_wp, 1.0_wp], [0.7_wp, -2.0_wp])
      do m = 1, size(scenes)
         call build(wall//trim(scenes(m))//"&model formulation='symmetric' /", motion, equation)
         do k = 1, size(orders)
            call check_bits_of(equation, orders(k))
         end do
      end do
   end subroutine check_bits

   subroutine check_bits_of(equation, order)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: order
      integer, parameter :: levels(3) = [1, 3, 4]
      type(series_batch_t) :: start
      type(series_lanes_t) :: first, other
      type(series_kernels_t) :: kernels
      integer :: i, level

      call create_series_batch(1, order, start)
      call fill(equation, 1, 0.02_wp, start)
      start%lanes%rate = -abs(start%lanes%rate)
      start%lanes%phi = 0.01_wp*start%lanes%phi
      first = start%lanes
      call step(series_kernels_of(1, order), first)
      call checks%that(sum(first%impacts) > 1 .and. sum(first%impacts) < series_width, &
         'some lanes have an impact')
      do level = 1, size(levels)
         if (levels(level) > best_level()) cycle
         kernels = series_kernels_of(levels(level), order)
         other = start%lanes
         call step(kernels, other)
         call checks%that(same(first, other, [(i, i=1, series_width)]), 'bits of a level')
         call fill_reversed(start%lanes, other)
         call step(kernels, other)
         call checks%that(same(first, other, [(i, i=series_width, 1, -1)]), &
            'bits of lanes in reverse')
      end do
   end subroutine check_bits_of

   !> Scans along a record against its values at the knots, jumps at both ends included.
   subroutine check_scans()
      integer, parameter :: n = 40
      real(wp), parameter :: bounds(2) = [-0.8_wp, 0.7_wp], most = 1.0e30_wp
      type(motion_t) :: motion
      real(wp) :: a(n), begin, end, t, least, variation, before, now, known(2)
      integer :: i, k, interval

      a = [(0.9_wp*sin(0.2_wp*i*i), i=1, n)]
      motion = piecewise_linear_motion([(0.1_wp*i, i=1, n)], a)
      do i = 0, n + 1
         begin = 0.1_wp*i + 0.03_wp
         end = begin + 0.7_wp
         t = begin
         call scan_lines(motion, interval_at(motion, begin), bounds, most, end, t, least, variation)
         before = acceleration(motion, interval_at(motion, begin), begin)
         known = [min(bounds(2) - before, before - bounds(1)), 0.0_wp]
         interval = interval_at(motion, begin)
         do k = interval, interval_at(motion, end)
            if (known(1) < 0) exit
            now = acceleration(motion, k, interval_end(motion, k - 1))
            if (k == interval) now = before
            known = look(known, now, before, bounds)
            before = acceleration(motion, k, min(end, interval_end(motion, k)))
            known = look(known, before, now, bounds)
         end do
         call checks%that(abs(least - known(1)) < 1.0e-12_wp, 'distance from bounds')
         if (least > 0) call checks%that(abs(variation - known(2)) < 1.0e-12_wp, 'variation')
         call pass_lines_inside(motion, bounds, 5.0_wp, begin, interval)
         if (interval < 1 .or. interval >= n) cycle
         call checks%that(maxval(abs(a(interval:interval + 1))) > 0.7_wp, &
            'the line leaves the bounds')
      end do
   end subroutine check_scans

   !> Distance from two bounds and variation after a further value.
   pure function look(known, a, before, bounds) result(now)
      real(wp), intent(in) :: known(2), a, before, bounds(2)
      real(wp) :: now(2)

      now = [min(known(1), bounds(2) - a, a - bounds(1)), known(2) + abs(a - before)]
   end function look

   !> Take a step of all lanes.
   subroutine step(kernels, lanes)
      type(series_kernels_t), intent(in) :: kernels
      type(series_lanes_t), intent(inout) :: lanes

      call kernels%expand_lanes(lanes)
      call kernels%screen_lanes(lanes)
      call kernels%find_roots(lanes)
      call kernels%end_steps(lanes)
   end subroutine step

   !> True if the lanes have the same state, those of the second batch in another order.
   pure logical function same(one, other, place)
      type(series_lanes_t), intent(in) :: one, other
      integer, intent(in) :: place(series_width)

      same = all(abs(one%phi - other%phi(place)) <= 0) .and. all(abs(one%rate &
         - other%rate(place)) <= 0) .and. all(abs(one%t - other%t(place)) <= 0) &
         .and. all(abs(one%side - other%side(place)) <= 0) &
         .and. all(abs(one%is_open - other%is_open(place)) <= 0)
   end function same

   !> Copy the states of lanes that share all coefficients in reverse order.
   pure subroutine fill_reversed(lanes, reversed)
      type(series_lanes_t), intent(in) :: lanes
      type(series_lanes_t), intent(out) :: reversed

      reversed = lanes
      reversed%phi = lanes%phi(series_width:1:-1)
      reversed%rate = lanes%rate(series_width:1:-1)
      reversed%t = lanes%t(series_width:1:-1)
      reversed%limit = lanes%limit(series_width:1:-1)
   end subroutine fill_reversed

   !> Fill lanes with states on a side.
   subroutine fill(equation, side, h, batch)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: side
      real(wp), intent(in) :: h
      !! length of the series [s]
      type(series_batch_t), intent(inout) :: batch
      integer :: i

      associate (lanes => batch%lanes)
         do i = 1, series_width
            call load_coefficients(equation, i, batch)
            lanes%phi(i) = 0.02_wp*i*abs(sin(3.0_wp*i)) + 0.001_wp
            lanes%rate(i) = 0.2_wp*cos(2.0_wp*i)
            lanes%t(i) = 0.03_wp*i
            lanes%limit(i) = lanes%t(i) + h
         end do
         lanes%side = side
         lanes%length = h
         lanes%share = h
         lanes%ground(:, 1) = 0.7_wp
         lanes%ground(:, 2) = -2.7_wp
         lanes%ground(:, 3) = 0
         if (equation%has_vertical) lanes%upward = 0.4_wp*lanes%ground(:, :2)
         lanes%frequency = 8
         lanes%rtol = 1.0e-3_wp
         lanes%top = 0.1_wp
         lanes%is_busy = 1
      end associate
   end subroutine fill

   !> Evaluate a series and its first two derivatives.
   pure subroutine evaluate_series(p, x, value, rate, bend)
      real(wp), intent(in) :: p(0:)
      real(wp), intent(in) :: x
      real(wp), intent(out) :: value, rate, bend
      integer :: k

      value = 0
      rate = 0
      bend = 0
      do k = size(p) - 1, 0, -1
         bend = bend*x + 2*rate
         rate = rate*x + value
         value = value*x + p(k)
      end do
   end subroutine evaluate_series

   !> Build the equation of a scene under a motion.
   subroutine build(text, motion, equation)
      character(*), intent(in) :: text
      type(motion_t), intent(in), target :: motion
      type(equation_t), intent(out) :: equation
      type(case_t) :: case
      type(error_t), allocatable :: error

      call read_case_text(text//' &solver t_end=4.0 /', 'scene', case, error)
      call checks%no_error(error, 'case')
      call build_equation(case, motion, equation)
      call enter_interval(equation%model_t, equation%state, 1)
   end subroutine build

end program test_series
