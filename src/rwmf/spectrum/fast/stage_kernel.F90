!> What the steps of `rwmf_spectrum_fast_step_kernel` are made of: functions of one lane.
!>
!> The compiler sees both modules at once and puts the functions in the place of their calls.
!> Compiled once for each instruction set, like that module (see
!> `rwmf_spectrum_fast_simd_dispatch`): FAST_NODE is the name of the module. What all lanes have in
!> common is literal at the calls:
!>
!>    is_plain   the ground acceleration is linear in the steps, without jumps between them
!>    is_short   the polynomials have `short_degree`
!>
!> i is the number of the lane.
#ifndef FAST_NODE
#define FAST_NODE rwmf_spectrum_fast_stage_kernel
#endif
module FAST_NODE
   use rwmf_spectrum_fast_types, only: c_2, c_3, curves, degree, lane_ground_t, lane_rate_t, &
      seats, team_t, tried_step_t, weights, wp
   implicit none
   private

   public :: value_before, slope_before, mode, state, drive_at, remainder, enter_end, take_end, &
      mark_of

contains

   !> N at the beginning of a step [1/s2].
   pure real(wp) function value_before(is_plain, i, team, trial) result(n)
      logical, value :: is_plain
      integer, value :: i
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(in) :: trial

      n = team%now%n(i)
      if (.not. is_plain) n = n - trial%n_jump(i)
   end function value_before

   !> Its slope there, per step [1/s2].
   pure real(wp) function slope_before(is_plain, i, team, trial) result(slope)
      logical, value :: is_plain
      integer, value :: i
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(in) :: trial

      slope = team%now%s(i) - team%now%drive(i)*team%rate%side(i)*trial%ground%kink(i)
      if (.not. is_plain) slope = slope - trial%s_jump(i)
      slope = team%rate%h(i)*slope
   end function slope_before

   !> One of the higher modes of the forcing: a difference of N and one of the ground motion, which
   !> is zero where that is linear [1/s2].
   pure real(wp) function mode(is_plain, difference, pull, f)
      logical, value :: is_plain
      real(wp), value :: difference
      !! of N [1/s2]
      real(wp), value :: pull
      !! -M2 sigma [1/m]
      real(wp), value :: f
      !! [m/s2]

      mode = difference
      if (.not. is_plain) mode = mode + pull*f
   end function mode

   !> v or v' at a node: what those at the beginning and the modes of the forcing make of it.
   pure real(wp) function state(modes, a, i, k, m, v, w, g_0, g_1, g_2, g_3)
      integer, value :: modes
      !! how many of the four are not zero, two at least; literal at the calls
      real(wp), intent(in) :: a(seats, weights)
      integer, value :: i
      integer, value :: k
      !! number of the weight of v
      integer, value :: m
      !! of that of g_0
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: g_0
      real(wp), value :: g_1
      real(wp), value :: g_2
      real(wp), value :: g_3

      state = a(i, m)*g_0 + a(i, m + 1)*g_1
      if (modes == 3) state = state + a(i, m + 2)*g_2
      if (modes == 4) state = state + (a(i, m + 2)*g_2 + a(i, m + 3)*g_3)
      state = (a(i, k)*v + a(i, k + 1)*w) + state
   end function state

   !> v D2 at v [1/m].
   pure real(wp) function drive_at(is_short, rate, i, v)
      logical, value :: is_short
      type(lane_rate_t), intent(in) :: rate
      integer, value :: i
      real(wp), value :: v

      drive_at = v*curve(is_short, rate%coef, i, 3, v)
   end function drive_at

   !> N at a state and a position in the step [1/s2].
   pure real(wp) function remainder(is_plain, is_short, rate, ground, i, y, v, w, drive) result(n)
      logical, value :: is_plain
      logical, value :: is_short
      type(lane_rate_t), intent(in) :: rate
      type(lane_ground_t), intent(in) :: ground
      integer, value :: i
      real(wp), value :: y
      !! position [-]
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: drive
      !! v D2 [1/m]

      n = curve(is_short, rate%coef, i, 1, v)*w*w - v*(curve(is_short, rate%coef, i, 2, v) &
         *(rate%damping(i)*w + rate%stiffness(i)*v) + curve(is_short, rate%coef, i, 4, v)) &
         - drive*(rate%side(i)*force(is_plain, ground, i, y))
   end function remainder

   !> One of the polynomials at v.
   pure real(wp) function curve(is_short, c, i, k, v)
      logical, value :: is_short
      real(wp), intent(in) :: c(seats, 0:degree, curves)
      integer, value :: i
      integer, value :: k
      !! which one
      real(wp), value :: v
      real(wp) :: v_2

      v_2 = v*v
      curve = (c(i, 0, k) + v*c(i, 1, k)) + v_2*(c(i, 2, k) + v*c(i, 3, k))
      if (is_short) then
         curve = curve + (v_2*v_2)*c(i, 4, k)
      else
         curve = curve + (v_2*v_2)*((c(i, 4, k) + v*c(i, 5, k)) + v_2*c(i, 6, k))
      end if
   end function curve

   !> Ground acceleration at the position y of a step [m/s2].
   pure real(wp) function force(is_plain, ground, i, y)
      logical, value :: is_plain
      type(lane_ground_t), intent(in) :: ground
      integer, value :: i
      real(wp), value :: y

      associate (f => ground%f)
         if (is_plain) then
            force = f(i, 0) + y*f(i, 1)
         else
            force = f(i, 0) + y*(f(i, 1) + (y - c_2)*(f(i, 2) + (y - c_3)*f(i, 3)))
         end if
      end associate
   end function force

   !> The end of a step as it is tried.
   pure subroutine enter_end(i, v, w, n, s, drive, doubt, trial)
      integer, value :: i
      real(wp), value :: v
      real(wp), value :: w
      real(wp), value :: n
      real(wp), value :: s
      real(wp), value :: drive
      real(wp), value :: doubt
      type(tried_step_t), intent(inout) :: trial

      trial%next%v(i) = v
      trial%next%w(i) = w
      trial%next%n(i) = n
      trial%next%s(i) = s
      trial%next%drive(i) = drive
      trial%next%doubt(i) = abs(doubt)
   end subroutine enter_end

   !> Take the step if the lane is ready and nothing happens.
   pure subroutine take_end(is_plain, i, team, trial)
      logical, value :: is_plain
      integer, value :: i
      type(team_t), intent(inout) :: team
      type(tried_step_t), intent(inout) :: trial
      real(wp) :: event, largest, higher, doubt, faded
      logical :: taken

      associate (now => team%now, next => trial%next)
         largest = team%v_max(i)
         doubt = now%doubt(i)
         faded = team%rate%keep(i)*doubt
         event = merge(team%ready(i), 0.0_wp, happens(i, team, trial))
         taken = team%ready(i) > event
         trial%event(i) = event
         now%v(i) = merge(next%v(i), now%v(i), taken)
         now%w(i) = merge(next%w(i), now%w(i), taken)
         now%n(i) = merge(next%n(i), now%n(i), taken)
         now%s(i) = merge(next%s(i), now%s(i), taken)
         now%drive(i) = merge(next%drive(i), now%drive(i), taken)
         if (is_plain) then
            faded = faded + next%doubt(i)
         else
            ! A jump of the acceleration changes the slope of N in a way that the prediction
            ! leaves out; the change of N then says nothing about what is wrong after it.
            faded = faded + merge(0.0_wp, next%doubt(i), abs(trial%ground%jump(i)) > 0)
         end if
         doubt = merge(faded, doubt, taken)
         now%doubt(i) = doubt
         higher = merge(next%v(i), 0.0_wp, taken)
         team%worst(i) = merge(doubt, team%worst(i), higher > largest)
         team%v_max(i) = max(largest, higher)
      end associate
      team%at(i) = team%at(i) + merge(1, 0, taken)
   end subroutine take_end

   !> Is an impact or a new maximum possible within the step?
   pure logical function happens(i, team, trial)
      integer, value :: i
      type(team_t), intent(in) :: team
      type(tried_step_t), intent(in) :: trial
      real(wp), parameter :: margin = 0.25_wp
      !! of h (|w_0| + |w|): a rate that is a parabola takes v at most 4/27 of it beyond its ends
      real(wp) :: v_0, w_0, v, w, h, room, both, twice, peak, dip

      v_0 = team%now%v(i)
      w_0 = team%now%w(i)
      v = trial%next%v(i)
      w = trial%next%w(i)
      h = team%rate%h(i)
      room = margin*h*(abs(w_0) + abs(w))
      ! v' may change its sign twice: its mean is then less than a third of the sum of its ends.
      both = w_0 + w
      twice = min(w_0*w, both*(h*both - 3*(v - v_0)))
      peak = max(min(w_0, -w), twice)
      peak = min(peak, room + max(v_0, v) - team%v_max(i))
      dip = max(min(-w_0, w), twice)
      dip = min(dip, room - min(v_0, v))
      happens = v <= 0 .or. max(peak, dip) > 0
   end function happens

   !> The bit of a lane in which something may happen.
   pure integer function mark_of(i, trial) result(mark)
      integer, value :: i
      type(tried_step_t), intent(in) :: trial

      mark = merge(ishft(1, i - 1), 0, trial%event(i) > 0)
   end function mark_of

end module FAST_NODE
