!> When the resting wall lifts off: the ground acceleration that it bears, and the first instant at
!> which the motion exceeds it.
!>
!> Straight lines of horizontal and vertical motion on the same knots, or one that is a multiple of
!> the other, make a drive that is monotone where the horizontal motion is. A pulse beside a
!> vertical record makes one that turns where their slopes meet (`drive_turns`).
module rwmf_model_lift_off
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, narrow
   use rwmf_model_assembly, only: enter_side, interval_of, lift_off_drive, moment_at_rest
   use rwmf_model_equation, only: discrete_state_t, equation_t, lift_off_drives, model_t
   use rwmf_motion_ground_motion, only: interval_end, line_of, line_t, steep_point, turning_point
   implicit none
   private

   public :: lifting_side, find_lift_off, jumps, pull_duration, drive_turns
   public :: find_uplift_acceleration, find_bearing

contains

   !> Does the drive exceed the threshold by more than round-off? One that is no number (a motion of
   !> a host) does, so that it comes to the integrator, which fails, and is not slept through.
   elemental logical function lifts(drive, threshold)
      real(wp), intent(in) :: drive
      !! [m/s2]
      real(wp), intent(in) :: threshold
      !! [m/s2]

      lifts = .not. drive <= 4*epsilon(1.0_wp)*threshold
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
      !! of the ground motion
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: drive(2)
      !! on the negative and on the positive side [m/s2]

      drive = lift_off_drives(equation, interval, t)
      side = merge(1, -1, drive(2) >= drive(1))
      if (.not. lifts(max(drive(1), drive(2)), equation%threshold)) side = 0
   end function lifting_side

   !> Do both sides lift off at an instant? Then the base bears nothing.
   pure logical function jumps(equation, interval, t)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      jumps = lifts(minval(lift_off_drives(equation, interval, t)), equation%threshold)
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

   !> Bisect to the first time at which the drive exceeds the threshold; on a straight line from a
   !> few spacings around the time at which it should.
   pure subroutine refine_lift_off(equation, interval, side, t, t_end)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      integer, intent(in) :: side
      real(wp), intent(inout) :: t
      !! a time at rest; on return that of the lift-off [s]
      real(wp), intent(in) :: t_end
      !! a time after lift-off [s]
      type(bracket_t) :: bracket
      type(line_t) :: line
      real(wp) :: drive(2)
      !! at the ends [m/s2]
      real(wp) :: guess
      integer :: i

      bracket = bracket_between(t, t_end)
      line = line_of(equation%motion, interval)
      if (line%is_straight) then
         drive = [lift_off_drive(equation, side, interval, t), &
            lift_off_drive(equation, side, interval, t_end)]
         guess = t + (t_end - t)*(drive(1)/(drive(1) - drive(2)))
         do i = -2, 2, 4
            call narrow_at(equation, interval, side, guess + i*spacing(t_end), bracket)
         end do
      end if
      do while (is_wider(bracket, 1))
         call narrow_at(equation, interval, side, bracket%middle, bracket)
      end do
      t = bracket%high
   end subroutine refine_lift_off

   !> Narrow a bracket of the lift-off by a time inside it; others leave it as it is.
   pure subroutine narrow_at(equation, interval, side, t, bracket)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      integer, intent(in) :: side
      real(wp), intent(in) :: t
      !! [s]
      type(bracket_t), intent(inout) :: bracket

      if (t > bracket%low .and. t < bracket%high) call narrow(bracket, &
         lifts(lift_off_drive(equation, side, interval, t), equation%threshold), t)
   end subroutine narrow_at

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
         if (lift_off_drive(equation, equation%state%side, interval_of(equation), high) <= 0) exit
      end do
      bracket = bracket_between(low, high)
      do while (is_wider(bracket, 4) .and. bracket%high - bracket%low &
          > 1.0e-3_wp*(bracket%low - t_begin))
         call narrow(bracket, &
            lift_off_drive(equation, equation%state%side, interval_of(equation), &
            bracket%middle) <= 0)
      end do
      duration = bracket%low - t_begin
   end function pull_duration

   !> Ground acceleration at which the resting wall lifts off on either side, and the inertia that
   !> further effects add there: from the moment about the pivot at theta = 0 without ground motion.
   !>
   !> Scenes without further effects keep the closed form of `build_equation`; where there are no
   !> further states, it changes with the branches alone.
   subroutine find_uplift_acceleration(model, state, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states); the first two are taken as zero
      real(wp) :: at_rest(model%n)
      real(wp) :: moment
      integer :: side
      integer :: i

      if (.not. model%effects_act_at_rest .or. state%uplift_is_known) return
      if (state%bearing_is_known) then
         state%uplift_acceleration([1, -1]) = state%bearing(:, 2)
         do i = 3, model%n
            state%uplift_acceleration([1, -1]) = state%uplift_acceleration([1, -1]) &
               + state%bearing(:, i)*y(i)
         end do
         return
      end if
      at_rest(1) = 0
      at_rest(3:) = y(3:)
      ! the side in force is the last, and stays
      side = -state%side
      do i = 1, 2
         call enter_side(model, state, side)
         at_rest(2) = side*model%creep
         call moment_at_rest(model%scene, state%coef, at_rest, moment, state%inertia_at_rest)
         ! at theta = 0 the arms of the link and of the centroid are 2 cos(alpha) and cos(alpha)
         state%uplift_acceleration(side) = -moment*model%p%R/(model%p%gamma &
            *model%floors%excited_mass_ratio*(2*model%p%cos_alpha) + model%p%cos_alpha)
         side = -side
      end do
      state%uplift_is_known = model%n == 2
   end subroutine find_uplift_acceleration

   !> How what the resting wall bears depends on the further states: the storeys' forces on it are
   !> linear in them as long as no branch changes.
   subroutine find_bearing(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp) :: y(model%n)
      integer :: i

      if (state%bearing_is_known .or. .not. model%effects_act_at_rest) return
      if (.not. allocated(state%bearing)) allocate (state%bearing(2, 2:model%n))
      do i = 2, model%n
         y = 0
         y(i) = 1
         call find_uplift_acceleration(model, state, y)
         state%bearing(:, i) = state%uplift_acceleration([1, -1])
         if (i > 2) state%bearing(:, i) = state%bearing(:, i) - state%bearing(:, 2)
      end do
      state%bearing_is_known = .true.
   end subroutine find_bearing

end module rwmf_model_lift_off
