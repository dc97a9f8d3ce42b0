!> Ordinates of one mass ratio and one width that advance together, with everything that happens to
!> each of them.
module rwmf_fast_block
   use rwmf_fast_flight, only: fall_asleep, pass_events, wake_up
   use rwmf_fast_grid, only: fast_grid_t
   use rwmf_fast_law, only: fast_law_t
   use rwmf_fast_piece, only: end_state_t, ordinate_t
   use rwmf_fast_series, only: step_weights
   use rwmf_fast_lanes, only: lane_rate_t, lane_state_t, lanes, weights
   use rwmf_fast_machine, only: advance_lanes
   use rwmf_kinds, only: pi, wp
   implicit none
   private

   public :: run_block

   !> Work space of a block.
   type :: block_t
      type(lane_rate_t) :: rate
      type(lane_state_t) :: now
      type(lane_state_t) :: next
      real(wp) :: awake(lanes)
      !! 1 in motion, 0 at rest
      real(wp) :: event(lanes)
      !! 1: something may happen in the step
      real(wp) :: v_max(lanes)
      !! [-]
      real(wp) :: difference(lanes, 0:3)
      !! divided differences of N [1/s2]
      type(ordinate_t) :: ordinate(lanes)
      integer :: next_wake
      !! first step in which a resting lane lifts off
   end type block_t

contains

   !> Peaks of up to `lanes` periods.
   pure subroutine run_block(law, grid, loud, T_s, xi_s, rtol, level, v_max, failed)
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
         call advance_lanes(level, block%rate, grid%step(number), block%awake, block%now, &
            block%next, block%difference, block%v_max, block%event)
         if (any(block%event > 0) .or. number == block%next_wake) then
            call attend(law, grid, loud, number, n, block)
         end if
         number = number + 1
         if (.not. any(block%awake > 0)) number = block%next_wake
      end do
      v_max = block%v_max(:n)
      failed = block%ordinate(:n)%failed .or. .not. abs(block%now%v(:n)) < huge(v_max)
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

      block%rate%m2 = law%m2
      block%rate%m3 = law%m3
      block%v_max = 0
      do i = 1, lanes
         omega_s = 2*pi/T_s(min(i, size(T_s)))
         block%ordinate(i) = ordinate_t(2*xi_s*omega_s, omega_s**2, rtol, 1, 0.0_wp, 0.0_wp, 0, &
            .true., 0, 0.0_wp, 1, .false.)
         block%rate%damping(i) = block%ordinate(i)%damping
         block%rate%stiffness(i) = block%ordinate(i)%stiffness
         call fall_asleep(law, grid, loud, 1, 0.0_wp, block%ordinate(i))
         call enter(i, end_state_t(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp), block)
         call turn(law, i, block)
      end do
      block%ordinate(size(T_s) + 1:)%wake_step = size(loud)
      block%next_wake = minval(block%ordinate%wake_step)
   end subroutine begin_block

   !> Weights of the step size h.
   pure subroutine weigh(law, h, block)
      type(fast_law_t), intent(in) :: law
      real(wp), intent(in) :: h
      !! [s]
      type(block_t), intent(inout) :: block
      integer :: i

      do i = 1, lanes
         associate (one => block%ordinate(i))
            block%rate%weight(i, :) = reshape(step_weights(one%damping*law%m1, &
               one%stiffness*law%m1 + law%m3_1, h), [weights])
         end associate
      end do
   end subroutine weigh

   !> Follow the lanes in which something happens in this step.
   pure subroutine attend(law, grid, loud, number, n, block)
      type(fast_law_t), intent(in) :: law
      type(fast_grid_t), intent(in) :: grid
      integer, intent(in) :: loud(:)
      integer, intent(in) :: number
      integer, intent(in) :: n
      !! lanes in use
      type(block_t), intent(inout) :: block
      type(end_state_t) :: finish
      integer :: i
      integer :: side

      do i = 1, n
         side = block%ordinate(i)%side
         if (block%event(i) > 0) then
            finish = end_state_t(block%next%v(i), block%next%w(i), block%next%n(i), &
               block%next%s(i), block%next%drive(i))
            block%ordinate(i)%v_max = block%v_max(i)
            call pass_events(law, grid, loud, number, block%now%v(i), block%now%w(i), &
               block%difference(i, :), block%ordinate(i), finish)
         else if (block%ordinate(i)%rests .and. block%ordinate(i)%wake_step == number) then
            call wake_up(law, grid, loud, number, block%ordinate(i), finish)
         else
            cycle
         end if
         if (block%ordinate(i)%failed) then
            block%ordinate(i)%rests = .true.
            block%ordinate(i)%wake_step = size(loud)
         end if
         call enter(i, finish, block)
         if (block%ordinate(i)%side /= side) call turn(law, i, block)
      end do
      block%next_wake = minval(block%ordinate%wake_step, mask=block%ordinate%rests)
      block%next_wake = min(block%next_wake, size(loud))
   end subroutine attend

   !> Put the state after an event into its lane.
   pure subroutine enter(i, finish, block)
      integer, intent(in) :: i
      type(end_state_t), intent(in) :: finish
      type(block_t), intent(inout) :: block

      block%now%v(i) = finish%v
      block%now%w(i) = finish%w
      block%now%n(i) = finish%n
      block%now%s(i) = finish%s
      block%now%drive(i) = finish%drive
      block%v_max(i) = block%ordinate(i)%v_max
      block%awake(i) = merge(0.0_wp, 1.0_wp, block%ordinate(i)%rests)
   end subroutine enter

   !> Constants of the side on which a lane moves.
   pure subroutine turn(law, i, block)
      type(fast_law_t), intent(in) :: law
      integer, intent(in) :: i
      type(block_t), intent(inout) :: block

      block%rate%side(i) = block%ordinate(i)%side
      block%rate%coef(i, :, :) = law%coef(:, :, merge(1, 2, block%ordinate(i)%side > 0))
   end subroutine turn

end module rwmf_fast_block
