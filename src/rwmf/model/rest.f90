!> When chatter ends and the wall rests: a question about the ground motion alone.
module rwmf_model_rest
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, interval_of, lift_off_drives
   use rwmf_model_lift_off, only: drive_turns
   use rwmf_motion_ground_motion, only: interval_end, interval_last, is_known_until
   implicit none
   private

   public :: pressing_acceleration, may_rest, inverse_inertia

contains

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

      associate (drive => lift_off_drives(equation, interval, t))
         press = -max(drive(1), drive(2))
      end associate
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
      press = pressing_at(equation, interval_of(equation), t)
      if (press <= 0) return
      ! A flight of a few spacings of the time cannot be followed.
      gain = inverse_inertia(equation)
      may_rest = v <= small_velocity
      ! a spacing is at most epsilon*t, and costs a call
      if (v <= press*gain*64*epsilon(t)*t) may_rest = may_rest .or. v <= press*gain*64*spacing(t)
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

      associate (p => equation%p, c => equation%p%cos_alpha)
         gain = c*(2*p%gamma*equation%floors%excited_mass_ratio &
            + 1)/(p%R*equation%state%inertia_at_rest)
      end associate
   end function inverse_inertia

end module rwmf_model_rest
