!> Impacts and peaks on the Taylor series of steps: loops to be vectorised.
!>
!> The series is exact in a substep, so that no further evaluation of N is needed. Compiled once for
!> each instruction set, like `rwmf_spectrum_fast_step_kernel`: no operation mixes two lanes.
module rwmf_spectrum_fast_event_kernel
   use rwmf_spectrum_fast_substep_kernel, only: expand_steps
   use rwmf_spectrum_fast_types, only: c_2, c_3, lanes, scheme_t, team_t, terms, wp
   implicit none
   private

   public :: follow_steps

contains

   !> Integrate the steps that are followed if they are substeps, locate their events, and set up
   !> what comes after them.
   pure subroutine follow_steps(are_substeps, scheme, team)
      logical, intent(in) :: are_substeps
      !! the steps that are followed are substeps, still to be integrated
      type(scheme_t), intent(in) :: scheme
      type(team_t), intent(inout) :: team

      call expand_steps(are_substeps, scheme, team)
      call locate_events(team)
      call rebound(team)
   end subroutine follow_steps

   !> First return to v = 0 and the largest v before it.
   pure subroutine locate_events(team)
      type(team_t), intent(inout) :: team
      real(wp), parameter :: last_x = 1 - 1.0e-13_wp
      !! largest position of an impact, so that the rest of the step has a length [-]
      real(wp) :: on_base, v_0, v_1, w_0, w_1, fall, rise, w_sum, dips, lands, x
      integer :: i

      associate (p => team%p, f => team%f)
         !$omp simd private(on_base, v_0, v_1, w_0, w_1, fall, rise, w_sum, dips, lands)
         do i = 1, lanes
            v_0 = p(i, 0)
            v_1 = team%next%v(i)
            w_0 = p(i, 1)
            w_1 = team%h_part(i)*team%next%w(i)
            on_base = merge(0.0_wp, 1.0_wp, v_0 > 0)
            ! v, on the base v/y, falls at the beginning and rises at the end, and may reach zero
            fall = merge(-w_0, -p(i, 2), v_0 > 0)
            rise = w_1 - on_base*v_1
            dips = min(v_1, merge(v_0, w_0, v_0 > 0))
            dips = min(min(v_1, min(fall, rise)), 0.25_wp*(abs(fall) + abs(rise)) - dips)
            ! lifts off, and comes back or not
            lands = merge(1.0_wp, 0.0_wp, v_1 <= 0)
            dips = merge(dips, lands, max(v_0, abs(w_0)) > 0)
            ! v' may change its sign twice: see `may_have_event` of the step kernel
            w_sum = w_0 + w_1
            dips = max(dips, min(w_0*w_1, min(w_sum*(w_sum - 3*(v_1 - v_0)), &
               0.25_wp*abs(w_sum) + max(max(v_0, v_1) - team%v_max(i), -min(v_0, v_1)))))
            team%is_ambiguous(i) = merge(team%is_followed(i), 0.0_wp, dips > 0)
            team%has_impact(i) = merge(team%is_followed(i) - team%is_ambiguous(i), 0.0_wp, &
               v_1 <= 0)
         end do
         call find_impacts(team)
         !$omp simd private(x)
         do i = 1, lanes
            x = min(team%x(i) + team%span(i)*team%y(i), last_x)
            team%x_impact(i) = x
            team%impact_speed(i) = -team%w_impact(i)/team%h_part(i)
            team%f_impact(i) = f(i, 0) + x*(f(i, 1) + (x - c_2)*(f(i, 2) + (x - c_3)*f(i, 3)))
         end do
      end associate
      call find_peaks(team)
   end subroutine locate_events

   !> First return to v = 0. For a flight that starts on the base the root is that of v/y, which
   !> does not vanish there.
   pure subroutine find_impacts(team)
      type(team_t), intent(inout) :: team
      real(wp) :: r(lanes, 0:terms)
      !! v, or v/y
      real(wp) :: ones(lanes)
      !! upper end of the brackets
      real(wp) :: v(lanes)
      integer :: i, j

      associate (p => team%p)
         if (any_of(team%has_impact)) then
            do j = 0, terms
               !$omp simd
               do i = 1, lanes
                  r(i, j) = merge(p(i, j), p(i, j + 1), p(i, 0) > 0)
               end do
            end do
            ones = 1
            call find_roots(r, ones, team%next%v, team%has_impact, team%y)
            call state_at(p(1, 0), team%y, v, team%w_impact)
         else
            team%y = 1
         end if
      end associate
      ! Without an impact it must not depend on whether another lane has one.
      !$omp simd
      do i = 1, lanes
         team%w_impact(i) = merge(team%w_impact(i), team%h_part(i)*team%next%w(i), &
            team%has_impact(i) > 0)
      end do
   end subroutine find_impacts

   !> Set up what follows: the flight after an impact (position, rate, side, length of the
   !> substep), or the end of the step or substep.
   !>
   !> The substep after an impact is the rest of the step, or 1.25 times the expected duration of
   !> the flight where that is much shorter.
   pure subroutine rebound(team)
      type(team_t), intent(inout) :: team
      real(wp), parameter :: tiny_part = 1.0e-12_wp
      real(wp) :: f, w, pressure, slowness, deceleration, span, expected, largest, hit, moved
      integer :: i

      associate (now => team%now, next => team%next, x => team%x, side => team%side)
         !$omp simd private(f, w, pressure, slowness, deceleration, span, expected, largest, hit, &
         !$omp& moved)
         do i = 1, lanes
            hit = team%has_impact(i)
            moved = team%is_followed(i) - team%is_ambiguous(i) - hit
            largest = max(team%peak(i), merge(next%v(i), 0.0_wp, moved > 0))
            team%error_at_peak(i) = merge(team%error_estimate(i), team%error_at_peak(i), &
               largest > team%v_max(i))
            team%v_max(i) = max(team%v_max(i), largest)
            w = team%e(i)*team%impact_speed(i)
            now%v(i) = merge(next%v(i), merge(0.0_wp, now%v(i), hit > 0), moved > 0)
            now%w(i) = merge(next%w(i), merge(w, now%w(i), hit > 0), moved > 0)
            now%n(i) = merge(next%n(i), now%n(i), moved > 0)
            now%n_rate(i) = merge(next%n_rate(i), now%n_rate(i), moved > 0)
            now%v_d2(i) = merge(next%v_d2(i), now%v_d2(i), moved > 0)
            ! Rest is considered where the flights of a chatter begin ever slower; in a step that
            ! can lift the wall only where the velocity left is negligible.
            f = team%f(i, 0) + (team%f(i, 1) + (1 - c_2)*(team%f(i, 2) + (1 - c_3)*team%f(i, 3)))
            f = max(abs(team%f(i, 0)), abs(f))
            pressure = team%m2(i)*(team%least_threshold(i) - abs(team%f_impact(i)))
            slowness = pressure*team%v_max(i)*merge(tiny_part, 1.0_wp, &
               f > team%least_threshold(i))
            slowness = max(team%negligible_velocity(i) - w, slowness - w*w)
            team%may_rest(i) = merge(hit, 0.0_wp, &
               min(pressure, min(team%w_begin(i) - w, slowness)) > 0)
            team%w_begin(i) = merge(w, team%w_begin(i), hit > 0)
            side(i) = merge(-side(i), side(i), hit > 0)
            x(i) = merge(team%x_impact(i), x(i), hit > 0)
            deceleration = (team%m3(i) + team%m2(i)*side(i)*team%f_impact(i) &
               + team%linear_damping(i)*w)*team%h(i)
            span = 1 - x(i)
            expected = 2.5_wp*w
            span = merge(expected/merge(deceleration, 1.0_wp, deceleration > 0), span, &
               expected < 0.5_wp*span*deceleration)
            team%span(i) = merge(span, team%span(i), hit > 0)
         end do
      end associate
   end subroutine rebound

   !> Roots of functions that are positive at 0 and negative at `high_start`: Newton's method from
   !> the parabola through both ends, with bisection where it would leave the bracket.
   pure subroutine find_roots(r, high_start, at_high, wanted, x)
      real(wp), intent(in) :: r(lanes, 0:terms)
      real(wp), intent(in) :: high_start(lanes)
      real(wp), intent(in) :: at_high(lanes)
      !! values at `high_start`
      real(wp), intent(in) :: wanted(lanes)
      !! 1 where there is a root; elsewhere x becomes `high_start`
      real(wp), intent(out) :: x(lanes)
      integer, parameter :: max_iterations = 80
      real(wp), parameter :: near = 1.0e-7_wp
      !! relative correction after which the error, its square, is round-off [-]
      real(wp) :: low(lanes), high(lanes), active(lanes), value(lanes), &
         slope(lanes)
      real(wp) :: bend, drop, next, steep
      integer :: i, iteration

      x = high_start
      !$omp simd private(bend, drop, next)
      do i = 1, lanes
         drop = r(i, 1)*high_start(i)
         bend = at_high(i) - r(i, 0) - drop
         ! the root of the parabola next to that of the secant, without cancellation
         bend = sqrt(max(0.0_wp, drop*drop - 4*bend*r(i, 0))) - drop
         ! from the middle of the bracket where the parabola has no root in it
         next = 2*r(i, 0)/merge(bend, 1.0_wp, bend > 2*abs(r(i, 0)))
         next = merge(next, 0.5_wp, bend > 2*abs(r(i, 0)))
         next = high_start(i)*merge(next, 0.5_wp, next > 0)
         next = improved(r, i, high_start(i), improved(r, i, high_start(i), next))
         low(i) = 0
         high(i) = high_start(i)
         active(i) = wanted(i)
         x(i) = merge(next, high_start(i), wanted(i) > 0)
      end do
      do iteration = 1, max_iterations
         call state_at(r, x, value, slope)
         !$omp simd private(next, steep)
         do i = 1, lanes
            low(i) = merge(x(i), low(i), value(i) > 0)
            high(i) = merge(high(i), x(i), value(i) > 0)
            steep = merge(slope(i), huge(1.0_wp), abs(value(i)) < abs(slope(i))*high_start(i))
            next = x(i) - value(i)/steep
            steep = merge(1.0_wp, -1.0_wp, abs(value(i)) < abs(slope(i))*high_start(i))
            steep = min(steep, min(next - low(i), high(i) - next))
            next = merge(next, low(i) + (high(i) - low(i))*0.5_wp, steep >= 0)
            next = merge(next, x(i), active(i) > 0)
            active(i) = merge(active(i), 0.0_wp, abs(next - x(i)) > near*abs(next))
            x(i) = next
         end do
         if (.not. any_of(active)) exit
      end do
   end subroutine find_roots

   !> A step of Newton's method on the first six powers, where it leads into the bracket.
   pure real(wp) function improved(r, i, high, x)
      real(wp), intent(in) :: r(lanes, 0:terms)
      integer, value :: i
      !! lane
      real(wp), value :: high
      real(wp), value :: x
      real(wp) :: value, slope

      value = r(i, 0) + x*(r(i, 1) + x*(r(i, 2) + x*(r(i, 3) + x*(r(i, 4) + x*r(i, 5)))))
      slope = r(i, 1) + x*(2*r(i, 2) + x*(3*r(i, 3) + x*(4*r(i, 4) + x*(5*r(i, 5)))))
      value = x - value/merge(slope, -huge(1.0_wp), slope < 0)
      improved = merge(value, x, min(value, high - value) > 0)
   end function improved

   !> Is one of the flags set?
   pure logical function any_of(flag)
      real(wp), intent(in) :: flag(lanes)
      real(wp) :: total
      integer :: i

      total = 0
      !$omp simd reduction(max: total)
      do i = 1, lanes
         total = max(total, flag(i))
      end do
      any_of = total > 0
   end function any_of

   !> Largest v of the steps that may bring a new maximum.
   pure subroutine find_peaks(team)
      type(team_t), intent(inout) :: team
      real(wp) :: r(lanes, 0:terms)
      real(wp) :: wanted(lanes)
      real(wp) :: x(lanes)
      real(wp) :: slope(lanes)
      integer :: i, j

      associate (p => team%p)
         !$omp simd
         do i = 1, lanes
            ! A bound of the peak: most peaks are far below the largest one.
            wanted(i) = max(p(i, 0) + 1.5_wp*p(i, 1)*team%y(i) - team%v_max(i), p(i, 2))
            wanted(i) = merge(wanted(i), 1.0_wp, abs(p(i, 1)) > 0)
            wanted(i) = merge(wanted(i), 0.0_wp, p(i, 1) >= 0)
            wanted(i) = merge(team%is_followed(i) - team%is_ambiguous(i), 0.0_wp, &
               min(wanted(i), -team%w_impact(i)) > 0)
            team%peak(i) = 0
         end do
         if (.not. any_of(wanted)) return
         do j = 0, terms
            !$omp simd
            do i = 1, lanes
               r(i, j) = (j + 1)*p(i, j + 1)
            end do
         end do
         call find_roots(r, team%y, team%w_impact, wanted, x)
         call state_at(p(1, 0), x, r(:, 0), slope)
      end associate
      !$omp simd
      do i = 1, lanes
         team%peak(i) = merge(r(i, 0), 0.0_wp, wanted(i) > 0)
      end do
   end subroutine find_peaks

   !> Polynomials and their derivatives at x, summed in pairs to shorten chains of dependent
   !> operations.
   pure subroutine state_at(p, x, value, rate)
      real(wp), intent(in) :: p(lanes, 0:terms)
      real(wp), intent(in) :: x(lanes)
      real(wp), intent(out) :: value(lanes)
      real(wp), intent(out) :: rate(lanes)
      real(wp) :: y, y_2, y_4, y_8
      integer :: i

      !$omp simd private(y, y_2, y_4, y_8)
      do i = 1, lanes
         y = x(i)
         y_2 = y*y
         y_4 = y_2*y_2
         y_8 = y_4*y_4
         value(i) = (((p(i, 0) + y*p(i, 1)) + y_2*(p(i, 2) + y*p(i, 3))) &
            + y_4*((p(i, 4) + y*p(i, 5)) + y_2*(p(i, 6) + y*p(i, 7)))) &
            + y_8*(((p(i, 8) + y*p(i, 9)) + y_2*(p(i, 10) + y*p(i, 11))) + y_4*p(i, 12))
         rate(i) = (((p(i, 1) + y*(2*p(i, 2))) + y_2*(3*p(i, 3) + y*(4*p(i, 4)))) &
            + y_4*((5*p(i, 5) + y*(6*p(i, 6))) + y_2*(7*p(i, 7) + y*(8*p(i, 8))))) &
            + y_8*((9*p(i, 9) + y*(10*p(i, 10))) + y_2*(11*p(i, 11) + y*(12*p(i, 12))))
      end do
   end subroutine state_at

end module rwmf_spectrum_fast_event_kernel
