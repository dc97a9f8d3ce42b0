!> Ends of the branches of storeys in steps of lanes. The loop over lanes agrees with the rule for
!> one step, and both ends of a step give the position.
program test_lane_limits
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_reader, only: read_case_text
   use rwmf_integrator_lane_columns, only: column_count, of_trial
   use rwmf_integrator_lane_kernels, only: batch_width, best_level, lane_kernels_of, &
      lane_kernels_t
   use rwmf_integrator_lane_quiet, only: find_quiet_one => find_quiet_steps, limit_count, &
      of_direction, of_high_end, of_low_end, of_side
   use rwmf_model_equation, only: equation_t
   use rwmf_model_floors_yielding_storeys, only: branch_limits, loading_direction_of, &
      pass_storey_limit, settle_storeys, side_beyond_zero
   use rwmf_model_system_assembly, only: build_equation
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_events_storey_events, only: displacements_t, hysteretic_t, list_ends, zero_of
   use rwmf_simulation_events_watched_spans, only: any_course, changed_at_begin, changes_in, &
      expect_change, measure_smoothness, moment_t, monotone, span_between, span_t, value_at, &
      watch_t
   implicit none

   character(*), parameter :: wall = "&wall h=2.0, b=0.5 / &model formulation='exact' / "
   character(*), parameter :: storeys = '&frame xi_s=0.05 / &storeys m_over_m_w=3*2.0, ' &
      //'k_over_m_w=3*600.0, height=1.5, 1.5, 1.0'
   character(*), parameter :: yielding = "&yielding storey_u_y=0.01, hardening=0.05"
   type(checks_t) :: checks

   call check_loop(wall//storeys//", coupling='full' / "//yielding//' /', 'linked roof')
   call check_loop(wall//storeys//", coupling='full' / &link L=5.0 / "//yielding//' /', 'link')
   call check_loop(wall//storeys//", coupling='springs', k_link_over_m_w=3*900.0 / "//yielding &
      //' /', 'link springs')
   call check_loop(storeys//", coupling='full' / "//yielding//' /', 'bare frame')
   call check_loop(wall//storeys//", coupling='full' / "//yielding//", law='bouc_wen' /", &
      'smooth storeys')
   call check_position()
   call checks%finish()

contains

   !> Compare the loop over lanes with the rule for one step, in random steps on several branches.
   subroutine check_loop(text, name)
      character(*), intent(in) :: text
      character(*), intent(in) :: name
      integer, parameter :: levels(3) = [1, 3, 4]
      type(case_t) :: case
      type(motion_t), target :: motion
      type(equation_t), target :: equation
      type(error_t), allocatable :: error
      type(lane_kernels_t) :: kernels
      real(wp), allocatable :: coef(:, :), y(:, :), y_new(:, :), limits(:, :, :), d(:, :, :, :)
      real(wp), allocatable :: is_quiet(:, :), alone(:, :), d_alone(:, :, :, :)
      real(wp) :: table(batch_width, column_count), frequency(batch_width)
      integer :: i, j, k, n, smooth, quiet, differ
      logical :: expected

      if (.not. checks%wants('loop, '//name)) return
      call read_case_text(text//' &solver t_end=1.0 /', 'scene', case, error)
      call checks%no_error(error, name)
      motion = motion_from_case(case)
      call build_equation(case, motion, equation)
      n = equation%floors%n_storeys
      smooth = 0
      if (allocated(equation%floors%laws)) smooth = equation%floors%laws(1)%place
      allocate (y(batch_width, equation%n), y_new(batch_width, equation%n))
      allocate (limits(batch_width, n, limit_count), d(batch_width, n, 0:1, 2))
      allocate (is_quiet(batch_width, 0:n), alone(1, 0:n), d_alone(1, n, 0:1, 2))
      quiet = 0
      differ = 0
      frequency = 50
      do k = 1, 40
         call draw_steps(equation, y, y_new, table(:, of_trial))
         ! a storey that yields upwards, and signs of smooth storeys
         if (k == 15 .and. smooth == 0) call pass_storey_limit(equation%model_t, equation%state, &
            2, .true.)
         if (smooth > 0) call settle_storeys(equation%model_t, equation%state, y(k/3 + 1, :), &
            .false.)
         do j = 1, n
            call branch_limits(equation, j, limits(1, j, of_low_end), limits(1, j, of_high_end))
            limits(1, j, of_direction) = loading_direction_of(equation, equation%state, j)
            limits(1, j, of_side) = side_beyond_zero(equation%state, j)
         end do
         limits = spread(limits(1, :, :), 1, batch_width)
         coef = spread(equation%state%coef(1, :), 1, batch_width)
         do i = 1, size(levels)
            if (levels(i) > best_level()) cycle
            kernels = lane_kernels_of(levels(i))
            call kernels%find_quiet_steps(equation%scene, n, smooth, coef, y, y_new, limits, &
               frequency, table, d, is_quiet)
         end do
         do i = 1, batch_width
            call find_quiet_one(equation%scene, n, smooth, equation%state%coef, y(i:i, :), &
               y_new(i:i, :), limits(i:i, :, :), frequency(i:i), table(i:i, :), d_alone, alone)
            call checks%that(all(abs(alone(1, :) - is_quiet(i, :)) <= 0) &
               .and. all(abs(d_alone(1, :, :, :) - d(i, :, :, :)) <= 0), 'bits of a lane, '//name)
            do j = 1, n
               expected = is_quiet_storey(equation, j, table(i, of_trial), y(i, :), y_new(i, :))
               quiet = quiet + merge(1, 0, expected)
               if (expected .neqv. is_quiet(i, j) > 0) differ = differ + 1
            end do
            call checks%that(abs(is_quiet(i, 0) - minval(is_quiet(i, 1:))) <= 0, 'all storeys, ' &
               //name)
         end do
      end do
      call checks%that(differ == 0, 'rule for one step, '//name)
      call checks%that(quiet > 40*batch_width*n/10 .and. quiet < 40*batch_width*n*9/10, &
         'steps of both kinds, '//name)
   end subroutine check_loop

   !> Draw states at both ends of steps, with displacements that follow their rates.
   subroutine draw_steps(equation, y, y_new, h)
      type(equation_t), intent(in) :: equation
      real(wp), intent(out) :: y(:, :), y_new(:, :)
      !! (lanes, states)
      real(wp), intent(out) :: h(:)
      !! [s]
      real(wp) :: size_of(size(y, 2)), dice(size(y, 1), size(y, 2), 2)
      integer :: m

      call random_number(dice)
      call random_number(h)
      h = 0.002_wp + 0.01_wp*h
      associate (first => equation%floors%first, free => equation%floors%free)
         size_of = 0.5_wp
         size_of(1:2) = [0.003_wp, 0.05_wp]
         size_of(first:first + free - 1) = 0.02_wp
         size_of(first + free:first + 2*free - 1) = 0.3_wp
         y = (2*dice(:, :, 1) - 1)*spread(size_of, 1, size(y, 1))
         y_new = y + 0.2_wp*(dice(:, :, 2) - 0.5_wp)*spread(size_of, 1, size(y, 1))
         y_new(:, 1) = y(:, 1) + h*(y(:, 2) + y_new(:, 2))/2
         do m = first, first + free - 1
            y_new(:, m) = y(:, m) + h*(y(:, m + free) + y_new(:, m + free))/2
         end do
      end associate
   end subroutine draw_steps

   !> Return whether the cubic of a storey shows no end of its branch.
   logical function is_quiet_storey(equation, j, h, y_a, y_b) result(is_quiet)
      type(equation_t), intent(in), target :: equation
      integer, intent(in) :: j
      !! number of the storey
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: y_a(:), y_b(:)
      !! (states) at both ends
      type(displacements_t) :: floors
      type(hysteretic_t) :: states
      type(moment_t) :: a, b
      type(span_t) :: span
      type(watch_t) :: watches(2)
      integer :: k, n

      floors%step%equation => equation
      floors%derivatives = 1
      states%step = floors%step
      states%derivatives = 1
      a%t = 0
      b%t = h
      call floors%evaluate(a%t, y_a, a%f)
      call floors%evaluate(b%t, y_b, b%f)
      span = span_between(floors, a, b)
      call measure_smoothness(max(1.0_wp, 50*h), span)
      call list_ends(equation, j, span, watches, n)
      is_quiet = .true.
      do k = 1, n
         if (watches(k)%course == monotone) then
            is_quiet = is_quiet .and. value_at(watches(k), span%b) >= 0
         else
            is_quiet = is_quiet .and. changes_in(span, watches(k)) == 0
         end if
      end do
      if (side_beyond_zero(equation%state, j) == 0) return
      call states%evaluate(b%t, y_b, b%f)
      is_quiet = is_quiet .and. value_at(zero_of(equation, j), b) >= 0
   end function is_quiet_storey

   !> Check the position of a change from both ends of a span. Vibrations pass a level, turn, or
   !> pass a level twice.
   subroutine check_position()
      type(span_t) :: span
      real(wp) :: x
      logical :: is_clear

      if (.not. checks%wants('position')) return
      span = vibration(0.2_wp, 0.7_wp)
      call expect_change(span, watch_t(1, 0, level=sin(0.5_wp), side=-1.0_wp), x, is_clear)
      call checks%that(is_clear, 'one passage is clear')
      call checks%close_to(x, 0.6_wp, 'passage of a level', atol=1.0e-6_wp)
      span = vibration(1.4_wp, 1.8_wp)
      call expect_change(span, watch_t(1, 1), x, is_clear)
      call checks%that(is_clear, 'one turn is clear')
      call checks%close_to(x, (acos(0.0_wp) - 1.4_wp)/0.4_wp, 'turn', atol=1.0e-6_wp)
      call expect_change(span, watch_t(1, 0, level=0.9_wp), x, is_clear)
      call checks%that(is_clear .and. x > 1, 'no passage')
      ! both ends lie below the level, the middle above it
      span = vibration(1.2_wp, 1.9_wp)
      call expect_change(span, watch_t(1, 0, level=0.97_wp, side=-1.0_wp), x, is_clear)
      call checks%that(.not. is_clear .and. x > 1, 'two passages are not clear')
      call expect_change(span, watch_t(1, 0, level=0.9_wp, side=-1.0_wp), x, is_clear)
      call checks%that(.not. is_clear, 'a function beyond its level at the start is not clear')
      call expect_change(span, watch_t(1, 1, course=changed_at_begin), x, is_clear)
      call checks%that(.not. is_clear, 'a change at the start is not clear')
      call expect_change(span, watch_t(1, 0, level=0.9_wp, course=any_course), x, is_clear)
      call checks%that(is_clear, 'inside the level')
   end subroutine check_position

   !> Span of a vibration of unit frequency.
   type(span_t) function vibration(t_a, t_b) result(span)
      real(wp), intent(in) :: t_a, t_b

      span%a%t = t_a
      span%b%t = t_b
      allocate (span%a%f(1, 0:2), span%b%f(1, 0:2))
      span%a%f(1, :) = [sin(t_a), cos(t_a), -sin(t_a)]
      span%b%f(1, :) = [sin(t_b), cos(t_b), -sin(t_b)]
      call measure_smoothness(1.0_wp, span)
   end function vibration

end program test_lane_limits
