!> When the wall rests, and when it lifts off again: questions about the ground motion alone.
!>
!> Straight lines of horizontal and vertical motion on the same knots, or one that is a multiple of
!> the other, make a drive that is monotone where the horizontal motion is. A pulse beside a
!> vertical record makes one that turns where their slopes meet (`drive_turns`).
module rwmf_model_rest
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, narrow
   use rwmf_model_assembly, only: equation_t, interval_of, lift_off_drive
   use rwmf_motion_ground_motion, only: interval_end, interval_last, is_known_until, steep_point, &
      turning_point
   implicit none
   private

   public :: lifts, find_lift_off, jumps, pressing_acceleration, may_rest, inverse_inertia
   public :: pull_duration

contains

   !> Does the drive exceed the threshold by more than round-off?
   elemental logical function lifts(drive, threshold)
      real(wp), intent(in) :: drive
      !! [m/s2]
      real(wp), intent(in) :: threshold
      !! [m/s2]

      lifts = drive > 4*epsilon(1.0_wp)*threshold
   end function lifts

   !> First lift-off of a resting wall in [t, t_limit].
   !>
   !> Within a monotone piece of the motion the drive of a side is monotone, so that its value at
   !> the end of the piece decides. `side` is 0 when the wall stays at rest; t and interval then
   !> stand at the end of the search.
   pure subroutine find_lift_off(equation, t_limit, t, interval, side)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_limit
      !! [s]
      real(wp), intent(inout) :: t
      !! begin of the search; on return the instant of lift-off, or t_limit [s]
      integer, intent(inout) :: interval
      !! of the motion at t
      integer, intent(out) :: side
      !! of the motion that begins, +1 or -1; 0 for none
      real(wp) :: t_end

      do
         side = lifting_side(equation, interval, t)
         if (side /= 0 .or. t >= t_limit) return
         t_end = min(drive_turns(equation, interval, t), t_limit)
         side = lifting_side(equation, interval, t_end)
         if (side /= 0) then
            if (jumps(equation, interval, t_end)) side = first_side(equation, interval, t, t_end)
            call refine_lift_off(equation, interval, side, t, t_end)
            return
         end if
         t = t_end
         if (t >= interval_end(equation%motion, interval)) interval = interval + 1
      end do
   end subroutine find_lift_off

   !> First time after t at which the drive of a side turns inside the interval, else its end [s].
   pure real(wp) function drive_turns(equation, interval, t)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      drive_turns = turning_point(equation%motion, interval, t)
      if (equation%has_vertical) drive_turns = min(drive_turns, steep_point(equation%motion, &
         interval, t, equation%weight_share))
   end function drive_turns

   !> Side on which the wall lifts off at an instant, 0 if it stays. Compressed fuses may push up
   !> both corners; then it is the one that is pushed more.
   pure integer function lifting_side(equation, interval, t) result(side)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: drive(2)
      !! on the negative and on the positive side [m/s2]

      drive = [lift_off_drive(equation, -1, interval, t), lift_off_drive(equation, 1, interval, t)]
      side = merge(1, -1, drive(2) >= drive(1))
      if (.not. lifts(maxval(drive), equation%threshold)) side = 0
   end function lifting_side

   !> Do both sides lift off at an instant? Then the base bears nothing.
   pure logical function jumps(equation, interval, t)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      jumps = lifts(lift_off_drive(equation, 1, interval, t), equation%threshold) &
         .and. lifts(lift_off_drive(equation, -1, interval, t), equation%threshold)
   end function jumps

   !> Of two sides that lift off between two times, the one that does so first.
   pure integer function first_side(equation, interval, t, t_end) result(side)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      real(wp), intent(in) :: t
      !! a time at rest [s]
      real(wp), intent(in) :: t_end
      !! a time at which both lift off [s]
      real(wp) :: right
      real(wp) :: left

      right = t
      call refine_lift_off(equation, interval, 1, right, t_end)
      left = t
      call refine_lift_off(equation, interval, -1, left, t_end)
      side = merge(1, -1, right < left)
   end function first_side

   !> Bisect to the first time at which the drive exceeds the threshold.
   pure subroutine refine_lift_off(equation, interval, side, t, t_end)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      integer, intent(in) :: side
      real(wp), intent(inout) :: t
      !! in: a time at rest; out: the lift-off [s]
      real(wp), intent(in) :: t_end
      !! a time after lift-off [s]
      type(bracket_t) :: bracket

      bracket = bracket_between(t, t_end)
      do while (is_wider(bracket, 1))
         call narrow(bracket, &
            lifts(lift_off_drive(equation, side, interval, bracket%middle), equation%threshold))
      end do
      t = bracket%high
   end subroutine refine_lift_off

   !> How long the ground motion goes on pulling the wall off its base on the side in force, within
   !> the interval in force [s]; no limit when that is to its end.
   pure real(wp) function pull_duration(equation, t_begin) result(duration)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_begin
      !! a time at which it pulls [s]
      type(bracket_t) :: bracket
      real(wp) :: low, high

      duration = huge(duration)
      high = t_begin
      do
         low = high
         if (low >= interval_end(equation%motion, interval_of(equation))) return
         if (low >= huge(low)) return
         high = drive_turns(equation, interval_of(equation), low)
         if (lift_off_drive(equation, equation%side, interval_of(equation), high) <= 0) exit
      end do
      bracket = bracket_between(low, high)
      do while (is_wider(bracket, 4) .and. bracket%high - bracket%low &
          > 1.0e-3_wp*(bracket%low - t_begin))
         call narrow(bracket, &
            lift_off_drive(equation, equation%side, interval_of(equation), bracket%middle) <= 0)
      end do
      duration = bracket%low - t_begin
   end function pull_duration

   !> Smallest ground acceleration that presses the wall down on both sides over a span [m/s2];
   !> not positive when one side lets go.
   pure real(wp) function pressing_acceleration(equation, t_begin, t_end) result(press)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_begin
      !! in the interval that is in force [s]
      real(wp), intent(in) :: t_end
      !! [s]
      integer :: interval
      real(wp) :: t

      interval = interval_of(equation)
      t = t_begin
      press = pressing_at(equation, interval, t)
      do while (t < t_end .and. press > 0)
         t = min(drive_turns(equation, interval, t), t_end)
         press = min(press, pressing_at(equation, interval, t))
         if (t >= interval_end(equation%motion, interval)) then
            interval = interval + 1
            press = min(press, pressing_at(equation, interval, t))
         end if
      end do
   end function pressing_acceleration

   pure real(wp) function pressing_at(equation, interval, t) result(press)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      real(wp), intent(in) :: t
      !! [s]

      press = -max(lift_off_drive(equation, 1, interval, t), &
         lift_off_drive(equation, -1, interval, t))
   end function pressing_at

   !> May the wall be put to rest after an impact that leaves it the velocity v?
   !>
   !> Impacts with e < 1 accumulate: flights of duration 2 v e**n/a end after 2 v/(a (1 - e)).
   !> If the wall is pressed down throughout that time, the true motion has ended by then and stays
   !> below v**2/(2a) meanwhile: when that is negligible, resting at once changes nothing else. The
   !> same holds when the ground has come to rest for good, whatever e.
   !> Otherwise only a velocity that is itself negligible may be dropped.
   pure logical function may_rest(equation, t, v, e, small_angle, small_velocity)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: v
      !! magnitude of the angular velocity after the impact [rad/s]
      real(wp), intent(in) :: e
      !! velocity factor [-]
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: small_velocity
      !! negligible angular velocity [rad/s]
      real(wp) :: gain
      !! angular acceleration per ground acceleration [1/m]
      real(wp) :: press
      real(wp) :: chatter

      may_rest = .false.
      press = pressing_acceleration(equation, t, t)
      if (press <= 0) return
      ! A flight of a few spacings of the time cannot be followed.
      gain = inverse_inertia(equation)
      may_rest = v <= max(small_velocity, press*gain*64*spacing(t))
      if (may_rest .or. v**2 > 2*press*gain*small_angle) return
      ! With e = 1 the chatter has no end, but nothing can come of it after the last knot.
      may_rest = interval_of(equation) >= interval_last(equation%motion)
      if (may_rest .or. e >= 1) return
      ! Twice the time that the present pressure allows leaves room for a smaller one meanwhile.
      chatter = 4*v/(press*gain*(1 - e))
      if (.not. is_known_until(equation%motion, interval_of(equation), t + chatter)) return
      press = pressing_acceleration(equation, t, t + chatter)
      may_rest = press > 0 .and. 2*v <= press*gain*(1 - e)*chatter
   end function may_rest

   !> Angular acceleration of the resting wall per ground acceleration beyond the threshold [1/m].
   pure real(wp) function inverse_inertia(equation) result(gain)
      type(equation_t), intent(in) :: equation

      associate (p => equation%p, c => equation%cos_alpha)
         gain = c*(2*p%gamma*equation%excited_mass_ratio + 1)/(p%R*(4.0_wp/3 + 4*p%gamma*c**2 &
            + equation%added_inertia))
      end associate
   end function inverse_inertia

end module rwmf_model_rest
