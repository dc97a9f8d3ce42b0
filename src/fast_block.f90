!> Ordinates of one mass ratio and one width that advance together, with everything that happens to
!> each of them.
module rwmf_fast_block
   use rwmf_control, only: control_t, is_cancelled
   use rwmf_fast_flight, only: fall_asleep, pass_events
   use rwmf_fast_grid, only: fast_grid_t
   use rwmf_fast_lanes, only: fast_law_t, flights_t, lane_rate_t, lane_state_t, lanes, &
      weights, width
   use rwmf_fast_machine, only: advance_lanes
   use rwmf_fast_ordinate, only: ordinate_t
   use rwmf_fast_series, only: step_weights
   use rwmf_kinds, only: pi, wp
   implicit none
   private

   public :: run_block

   integer, parameter :: check_every = 256
   !! steps between two looks at the caller's stop flag
   real(wp), parameter :: error_share = 0.2_wp
   !! of what the last evaluation of N changes is taken for an error; found with random scenes,
   !! on the sum before it was damped and read at the peak

   !> Work space of a block.
   type :: block_t
      integer :: n
      !! lanes in use, padded to a multiple of `width`
      type(lane_rate_t) :: rate
      type(lane_state_t) :: now
      type(lane_state_t) :: next
      real(wp) :: awake(lanes)
      !! 1 in motion, 0 at rest
      real(wp) :: event(lanes)
      !! 1: something may happen in the step
      real(wp) :: v_max(lanes)
      !! [-]
      real(wp) :: worst(lanes)
      !! doubt when `v_max` was reached [1/s]
      real(wp) :: difference(lanes, 0:3)
      !! divided differences of N [1/s2]
      type(ordinate_t) :: ordinate(lanes)
      type(flights_t) :: flights
      !! of the lanes in which something happens
      integer :: next_wake
      !! first step in which a resting lane lifts off
   end type block_t

contains

   !> Peaks of up to `lanes` periods.
   subroutine run_block(control, law, grid, loud, T_s, xi_s, rtol, level, v_max, failed, &
      error)
      type(control_t), intent(in) :: control
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      !! (steps + 1) from `loud_steps`
      real(wp), intent(in) :: T_s(:)
      !! (n <= lanes) [s]
      real(wp), intent(in) :: xi_s
      !! [-]
      real(wp), intent(in) :: rtol
      !! [-]
      integer, intent(in) :: level
      !! instruction set, from `best_level`
      real(wp), intent(out) :: v_max(:)
      !! (n) largest |u_s|/(2R) [-]
      logical, intent(out) :: failed(:)
      !! (n) left to the general kernel
      real(wp), intent(out) :: error(:)
      !! (n) estimate of the relative error of v_max [-]
      type(block_t) :: block
      real(wp) :: h
      integer :: number
      integer :: n

      n = size(T_s)
      call begin_block(law, grid, loud, T_s, xi_s, rtol, block)
      h = 0
      number = block%next_wake
      do while (number <= size(grid%step))
         if (abs(grid%step(number)%h - h) > 0) then
            h = grid%step(number)%h
            call weigh(law, h, block)
         end if
         call advance_lanes(level, block%n, block%rate, grid%step(number), block%awake, block%now, &
            block%next, block%difference, block%v_max, block%worst, block%event)
         if (any(block%event(:block%n) > 0) .or. number == block%next_wake) then
            call attend(level, law, grid, loud, number, n, block)
         end if
         number = number + 1
         if (mod(number, check_every) == 0) then
            if (is_cancelled(control)) exit
         end if
         if (.not. any(block%awake(:block%n) > 0)) number = block%next_wake
      end do
      v_max = block%v_max(:n)
      associate (one => block%ordinate(:n))
         error = error_share*block%worst(:n) &
            /max(tiny(h), one%w_max, sqrt(one%stiffness)*v_max)
         failed = one%failed .or. .not. abs(block%now%v(:n)) < huge(v_max)
      end associate
      if (is_cancelled(control)) failed = .true.
   end subroutine run_block

   !> All at rest; lanes without an ordinate stay there.
   pure subroutine begin_block(law, grid, loud, T_s, xi_s, rtol, block)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      real(wp), intent(in) :: T_s(:)
      real(wp), intent(in) :: xi_s
      real(wp), intent(in) :: rtol
      type(block_t), intent(out) :: block
      real(wp) :: omega_s
      integer :: i

      block%n = width*((size(T_s) + width - 1)/width)
      block%rate%m2 = law%m2
      block%rate%m3 = law%m3
      block%v_max = 0
      block%awake = 0
      block%now%v = 0
      block%now%w = 0
      block%now%n = 0
      block%now%s = 0
      block%now%drive = 0
      block%now%doubt = 0
      block%worst = 0
      do i = 1, block%n
         omega_s = 2*pi/T_s(min(i, size(T_s)))
         block%ordinate(i) = ordinate_t(2*xi_s*omega_s, omega_s**2, rtol, 1, 0.0_wp, 0.0_wp, 0, &
            .true., 0, 0.0_wp, 1, .false.)
         block%rate%damping(i) = block%ordinate(i)%damping
         block%rate%stiffness(i) = block%ordinate(i)%stiffness
         call fall_asleep(law, grid, loud, 1, 0.0_wp, block%ordinate(i))
         call turn(law, i, block)
      end do
      block%ordinate(size(T_s) + 1:block%n)%wake_step = size(loud)
      block%next_wake = minval(block%ordinate(:size(T_s))%wake_step)
   end subroutine begin_block

   !> Weights of the step size h.
   pure subroutine weigh(law, h, block)
      type(fast_law_t), intent(in) :: law
      real(wp), intent(in) :: h
      !! [s]
      type(block_t), intent(inout) :: block
      integer :: i

      do i = 1, block%n
         associate (one => block%ordinate(i))
            block%rate%keep(i) = max(0.0_wp, 1 - 0.5_wp*h*one%damping*law%m1)
            block%rate%weight(i, :) = reshape(step_weights(one%damping*law%m1, &
               one%stiffness*law%m1 + law%m3_1, h), [weights])
         end associate
      end do
   end subroutine weigh

   !> Follow the lanes in which something happens in this step.
   pure subroutine attend(level, law, grid, loud, number, n, block)
      integer, intent(in) :: level
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      integer, intent(in) :: n
      !! lanes in use
      type(block_t), intent(inout) :: block
      integer :: touched(lanes)
      !! numbers of the lanes in question
      integer :: i, k, m
      logical :: wakes

      call gather(n, block)
      m = block%flights%used
      touched(:m) = block%flights%lane(:m)
      wakes = number == block%next_wake
      if (wakes) then
         do i = 1, n
            if (.not. block%ordinate(i)%rests .or. block%ordinate(i)%wake_step /= number) cycle
            m = m + 1
            touched(m) = i
         end do
      end if
      call pass_events(level, law, grid, loud, number, wakes, block%flights, &
         block%ordinate(:n), block%now)
      do k = 1, m
         i = touched(k)
         associate (one => block%ordinate(i))
            if (one%v_max > block%v_max(i)) block%worst(i) = block%now%doubt(i)
            block%v_max(i) = one%v_max
            block%awake(i) = merge(0.0_wp, 1.0_wp, one%rests)
            if (one%rests) block%next_wake = min(block%next_wake, one%wake_step)
            if (abs(block%rate%side(i) - one%side) > 0) call turn(law, i, block)
         end associate
      end do
      if (wakes) block%next_wake = minval(block%ordinate(:n)%wake_step, &
         mask=block%ordinate(:n)%rests)
      block%next_wake = min(block%next_wake, size(loud))
   end subroutine attend

   !> Put the marked lanes in a row.
   pure subroutine gather(n, block)
      integer, intent(in) :: n
      !! lanes in use
      type(block_t), intent(inout) :: block
      integer :: i

      associate (flights => block%flights, k => block%flights%used)
         k = 0
         do i = 1, n
            if (.not. block%event(i) > 0) cycle
            k = k + 1
            block%ordinate(i)%v_max = block%v_max(i)
            flights%lane(k) = i
            flights%x(k) = 0
            flights%span(k) = 1
            flights%v(k) = block%now%v(i)
            flights%w(k) = block%now%w(i)
            flights%side(k) = block%rate%side(i)
            flights%damping(k) = block%rate%damping(i)
            flights%stiffness(k) = block%rate%stiffness(i)
            flights%v_max(k) = block%v_max(i)
            flights%n_0(k, :) = block%difference(i, :)
            flights%finish%v(k) = block%next%v(i)
            flights%finish%w(k) = block%next%w(i)
            flights%finish%n(k) = block%next%n(i)
            flights%finish%s(k) = block%next%s(i)
            flights%finish%drive(k) = block%next%drive(i)
         end do
      end associate
   end subroutine gather

   !> Constants of the side on which a lane moves.
   pure subroutine turn(law, i, block)
      type(fast_law_t), intent(in) :: law
      integer, intent(in) :: i
      type(block_t), intent(inout) :: block

      block%rate%side(i) = block%ordinate(i)%side
      block%rate%coef(i, :, :) = law%coef(:, :, merge(1, 2, block%ordinate(i)%side > 0))
   end subroutine turn

end module rwmf_fast_block
