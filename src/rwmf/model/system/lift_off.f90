!> Lift-off of the resting wall: uplift acceleration, and the first instant at which the motion
!> exceeds it.
!>
!> The uplift demand is monotone where the horizontal motion is monotone in two cases. Both motions
!> are straight lines on the same knots, or one is a multiple of the other. For a pulse with a
!> vertical record the demand has turning points where the slopes are equal (`demand_turns`).
module rwmf_model_system_lift_off
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, narrow
   use rwmf_model_equation, only: discrete_state_t, equation_t, uplift_demands, model_t
   use rwmf_model_system_assembly, only: enter_side, interval_of, uplift_demand, moment_at_rest
   use rwmf_motion_ground_motion, only: interval_end, is_piecewise_linear, line_of, line_t, &
      pass_lines_inside, steep_point, turning_point
   implicit none
   private

   public :: lifting_side, find_lift_off, resting_range, jumps, pull_duration, demand_turns
   public :: find_uplift_acceleration, find_uplift_capacity

contains

   !> True if the uplift demand exceeds the threshold by more than round-off. A NaN demand, from the
   !> motion of a host program, also returns true. The integrator then fails with an error, and the
   !> invalid motion is not skipped.
   elemental logical function lifts(drive, threshold)
      real(wp), intent(in) :: drive
      !! [m/s2]
      real(wp), intent(in) :: threshold
      !! [m/s2]

      lifts = .not. drive <= 4*epsilon(1.0_wp)*threshold
   end function lifts

   !> Find the first lift-off of a resting wall in [t, t_limit].
   !>
   !> Within a monotone piece of the motion the demand on a side is monotone, so its value at the
   !> end of the piece decides. `side` is 0 if the wall stays at rest; t and interval are then those
   !> at the end of the search.
   pure subroutine find_lift_off(equation, t_limit, t, interval, side)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_limit
      !! [s]
      real(wp), intent(inout) :: t
      !! start of the search; on return the instant of lift-off, or t_limit [s]
      integer, intent(inout) :: interval
      !! of the motion at t
      integer, intent(out) :: side
      !! side of the motion after lift-off, +1 or -1; 0 for no lift-off
      real(wp) :: t_end, left, right

      do
         if (is_piecewise_linear(equation%motion) .and. .not. equation%has_vertical) then
            call pass_lines_inside(equation%motion, resting_range(equation), t_limit, t, interval)
         end if
         side = lifting_side(equation, interval, t)
         if (side /= 0 .or. t >= t_limit) return
         t_end = min(demand_turns(equation, interval, t), t_limit)
         side = lifting_side(equation, interval, t_end)
         if (side /= 0) then
            if (jumps(equation, interval, t_end)) then
               ! both sides lift off before t_end: one of them first
               right = t
               call refine_lift_off(equation, interval, 1, right, t_end)
               left = t
               call refine_lift_off(equation, interval, -1, left, t_end)
               side = merge(1, -1, right < left)
            end if
            call refine_lift_off(equation, interval, side, t, t_end)
            return
         end if
         t = t_end
         if (t >= interval_end(equation%motion, interval)) interval = interval + 1
      end do
   end subroutine find_lift_off

   !> Range of the horizontal ground acceleration under which the wall rests, without vertical
   !> motion [m/s2].
   pure function resting_range(equation) result(range)
      type(equation_t), intent(in) :: equation
      real(wp) :: range(2)

      range = [-1, 1]*equation%state%uplift_acceleration([1, -1])/equation%uplift%push_gain
   end function resting_range

   !> First turning point of the uplift demand after t in the interval, or the end of the interval
   !> [s].
   pure real(wp) function demand_turns(equation, interval, t)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      demand_turns = turning_point(equation%motion, interval, t)
      if (equation%has_vertical) demand_turns = min(demand_turns, steep_point(equation%motion, &
         interval, t, equation%uplift%weight_share))
   end function demand_turns

   !> Side on which the wall lifts off at an instant, 0 if it stays. Compressed fuses may push up
   !> both corners; the side with the larger demand is then returned.
   pure integer function lifting_side(equation, interval, t) result(side)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the ground motion
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: drive(2)
      !! demand on the negative and on the positive side [m/s2]

      drive = uplift_demands(equation, interval, t)
      side = merge(1, -1, drive(2) >= drive(1))
      if (.not. lifts(max(drive(1), drive(2)), equation%uplift%threshold)) side = 0
   end function lifting_side

   !> True if both sides lift off at an instant, so that the base has no contact force.
   pure logical function jumps(equation, interval, t)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      !! of the motion
      real(wp), intent(in) :: t
      !! [s]

      jumps = lifts(minval(uplift_demands(equation, interval, t)), equation%uplift%threshold)
   end function jumps

   !> Bisect to the first time at which the demand exceeds the threshold. On a straight line, start
   !> from a bracket of a few spacings around the expected time.
   pure subroutine refine_lift_off(equation, interval, side, t, t_end)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      integer, intent(in) :: side
      real(wp), intent(inout) :: t
      !! a time at rest; on return the time of lift-off [s]
      real(wp), intent(in) :: t_end
      !! a time after lift-off [s]
      type(bracket_t) :: bracket
      type(line_t) :: line
      real(wp) :: drive(2)
      !! demand at both ends [m/s2]
      real(wp) :: guess
      integer :: i

      bracket = bracket_between(t, t_end)
      line = line_of(equation%motion, interval)
      if (line%is_straight) then
         drive = [uplift_demand(equation, side, interval, t), &
            uplift_demand(equation, side, interval, t_end)]
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

   !> Narrow a bracket of the lift-off by a time inside it. A time outside has no effect.
   pure subroutine narrow_at(equation, interval, side, t, bracket)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: interval
      integer, intent(in) :: side
      real(wp), intent(in) :: t
      !! [s]
      type(bracket_t), intent(inout) :: bracket

      if (t > bracket%low .and. t < bracket%high) call narrow(bracket, &
         lifts(uplift_demand(equation, side, interval, t), equation%uplift%threshold), t)
   end subroutine narrow_at

   !> Remaining time during which the ground motion pulls the wall off its base on the current side
   !> [s]. Only the current interval counts; if the pull lasts to its end, the result is the largest
   !> number.
   pure real(wp) function pull_duration(equation, t_begin) result(duration)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_begin
      !! a time at which the demand is positive [s]
      type(bracket_t) :: bracket
      real(wp) :: low, high

      duration = huge(duration)
      high = t_begin
      do
         low = high
         if (low >= interval_end(equation%motion, interval_of(equation))) return
         if (low >= huge(low)) return
         high = demand_turns(equation, interval_of(equation), low)
         if (uplift_demand(equation, equation%state%side, interval_of(equation), high) <= 0) exit
      end do
      bracket = bracket_between(low, high)
      do while (is_wider(bracket, 4) .and. bracket%high - bracket%low &
          > 1.0e-3_wp*(bracket%low - t_begin))
         call narrow(bracket, &
            uplift_demand(equation, equation%state%side, interval_of(equation), &
            bracket%middle) <= 0)
      end do
      duration = bracket%low - t_begin
   end function pull_duration

   !> Compute the ground acceleration at uplift of the resting wall on either side, and the inertia
   !> including further effects. Both follow from the moment about the pivot at theta = 0 without
   !> ground motion.
   !>
   !> Scenes without further effects keep the closed form of `build_equation`. Without further
   !> states, the result changes only with the branches.
   subroutine find_uplift_acceleration(model, state, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states); the first two count as zero
      real(wp) :: at_rest(model%n)
      real(wp) :: moment
      integer :: side
      integer :: i

      if (.not. model%effects_act_at_rest .or. state%uplift_is_known) return
      if (model%beam%n > 0) state%lean = dot_product(model%beam%area, y(model%beam%first: &
         model%beam%first + model%beam%n - 1))/model%beam%half_width
      if (state%capacity_is_known) then
         state%uplift_acceleration([1, -1]) = state%uplift_capacity(:, 2)
         do i = 3, model%n
            state%uplift_acceleration([1, -1]) = state%uplift_acceleration([1, -1]) &
               + state%uplift_capacity(:, i)*y(i)
         end do
         return
      end if
      at_rest(1) = 0
      at_rest(3:) = y(3:)
      ! the current side is the last one and remains set
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

   !> Compute the dependence of the uplift acceleration on the further states. The storey forces on
   !> the wall are linear in them until a branch changes.
   subroutine find_uplift_capacity(model, state)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp) :: y(model%n)
      integer :: i

      if (state%capacity_is_known .or. .not. model%effects_act_at_rest) return
      if (.not. allocated(state%uplift_capacity)) allocate (state%uplift_capacity(2, 2:model%n))
      do i = 2, model%n
         y = 0
         y(i) = 1
         call find_uplift_acceleration(model, state, y)
         state%uplift_capacity(:, i) = state%uplift_acceleration([1, -1])
         if (i > 2) state%uplift_capacity(:, i) = state%uplift_capacity(:, i) &
            - state%uplift_capacity(:, 2)
      end do
      state%capacity_is_known = .true.
   end subroutine find_uplift_capacity

end module rwmf_model_system_lift_off
