!> Impact, rest and uplift of a wall that a host carries as an element.
!>
!> The host passes its motion at both ends of a time step; these procedures find the instant of
!> the event inside the step. Numbers that are not finite or exceed 1e30 in size are refused with
!> `err_input`. If the caller omits `error`, the result is then no event, at the time NaN.
module rwmf_embedding_element_events
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_element, only: uplift_demand_of, require_element, resting_inertia, &
      velocity_factor, wall_element_t
   use rwmf_embedding_ranges, only: not_negative, require_number, require_numbers
   use rwmf_math_cubic, only: cubic_between, falling_root, monotone_pieces, value_at
   implicit none
   private

   public :: next_impact, next_lift_off, settles

contains

   !> Find the first return of the wall to its base within a step of the host.
   !>
   !> The displacement between the ends is the cubic through values and velocities, which includes
   !> the parabola of Newmark's average acceleration. At the impact the host multiplies the velocity
   !> by `velocity_factor` and changes the side.
   pure subroutine next_impact(side, dt, u_0, u_dot_0, u_1, u_dot_1, found, tau, error)
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: dt
      !! >= 0, length of the step [s]
      real(wp), intent(in) :: u_0
      !! displacement of the link at the beginning of the step [m]
      real(wp), intent(in) :: u_dot_0
      !! velocity at the same instant [m/s]
      real(wp), intent(in) :: u_1
      !! displacement of the link at the end of the step [m]
      real(wp), intent(in) :: u_dot_1
      !! velocity at the same instant [m/s]
      logical, intent(out) :: found
      !! an impact occurs within the step
      real(wp), intent(out) :: tau
      !! time since the beginning; dt without an impact [s]
      type(error_t), allocatable, intent(out), optional :: error
      !! `err_input` for another side, a negative `dt`, or a number that is not finite
      type(error_t), allocatable :: refusal
      real(wp) :: p(0:3)
      !! sigma u as a polynomial of tau/dt [m]
      real(wp) :: ends(0:3)
      integer :: i

      found = .false.
      tau = ieee_value(tau, ieee_quiet_nan)
      if (abs(side) /= 1) call fail(refusal, err_input, 'the side of a rocking wall is 1 or -1')
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([u_0, u_dot_0, u_1, u_dot_1], &
         [character(7) :: 'u_0', 'u_dot_0', 'u_1', 'u_dot_1'], refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      p = side*cubic_between(dt, u_0, u_dot_0, u_1, u_dot_1)
      tau = dt
      ends = monotone_pieces(p)
      do i = 1, 3
         if (value_at(p, ends(i)) < 0) then
            tau = dt*falling_root(p, ends(i - 1), ends(i))
            found = .true.
            return
         end if
      end do
   end subroutine next_impact

   !> Find the first uplift of a resting wall within a step of the host.
   !>
   !> The host's force on the wall and the ground acceleration vary linearly over the step.
   subroutine next_lift_off(element, dt, push_0, push_1, u_g_ddot_0, u_g_ddot_1, side, tau, error)
      type(wall_element_t), intent(in) :: element
      real(wp), intent(in) :: dt
      !! >= 0 [s]
      real(wp), intent(in) :: push_0
      !! force of the host on the wall at the beginning, positive towards positive u [N]
      real(wp), intent(in) :: push_1
      !! force of the host on the wall at the end [N]
      real(wp), intent(in) :: u_g_ddot_0
      !! ground acceleration at the beginning [m/s2]
      real(wp), intent(in) :: u_g_ddot_1
      !! ground acceleration at the end [m/s2]
      integer, intent(out) :: side
      !! side to which the wall lifts off; 0 if it rests throughout
      real(wp), intent(out) :: tau
      !! time since the beginning; dt if the wall rests throughout [s]
      type(error_t), allocatable, intent(out), optional :: error
      !! `err_input` for an element never created, a negative `dt`, or a number that is not finite
      type(error_t), allocatable :: refusal
      real(wp) :: drive_0
      real(wp) :: drive_1
      real(wp) :: root
      integer :: s

      side = 0
      tau = ieee_value(tau, ieee_quiet_nan)
      call require_element(element, refusal)
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([push_0, push_1, u_g_ddot_0, u_g_ddot_1], &
         [character(10) :: 'push_0', 'push_1', 'u_g_ddot_0', 'u_g_ddot_1'], refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      tau = dt
      do s = -1, 1, 2
         drive_0 = uplift_demand_of(element, s, push_0, u_g_ddot_0)
         drive_1 = uplift_demand_of(element, s, push_1, u_g_ddot_1)
         if (max(drive_0, drive_1) <= 0) cycle
         root = 0
         if (drive_0 < 0) root = dt*drive_0/(drive_0 - drive_1)
         if (side /= 0 .and. root >= tau) cycle
         side = s
         tau = root
      end do
   end subroutine next_lift_off

   !> True if the host may put the wall to rest after an impact.
   !>
   !> A wall that is pressed down on both sides bounces, with flights of duration 2 v e**n/a. If
   !> their sum is shorter than a step, the host cannot resolve them. The error of neglecting them
   !> is of second order in the step. A hinged wall never rests.
   logical function settles(element, dt, u_dot, push, u_g_ddot, host_mass, error)
      type(wall_element_t), intent(in) :: element
      real(wp), intent(in) :: dt
      !! >= 0, step of the host [s]
      real(wp), intent(in) :: u_dot
      !! velocity of the link after the impact [m/s]
      real(wp), intent(in) :: push
      !! force of the host on the wall at rest [N]
      real(wp), intent(in) :: u_g_ddot
      !! [m/s2]
      real(wp), intent(in) :: host_mass
      !! >= 0, mass of the host's degree of freedom at the link [kg]
      type(error_t), allocatable, intent(out), optional :: error
      type(error_t), allocatable :: refusal
      real(wp) :: pull
      !! acceleration towards the base [m/s2]

      settles = .false.
      call require_element(element, refusal)
      call require_number(dt, 'dt', not_negative, refusal)
      call require_numbers([u_dot, push, u_g_ddot], &
         [character(8) :: 'u_dot', 'push', 'u_g_ddot'], refusal)
      call require_number(host_mass, 'host_mass', not_negative, refusal)
      if (allocated(refusal)) then
         if (present(error)) call move_alloc(refusal, error)
         return
      end if
      pull = -max(uplift_demand_of(element, 1, push, u_g_ddot), &
         uplift_demand_of(element, -1, push, u_g_ddot))/(resting_inertia(element) + host_mass)
      settles = pull > 0 .and. 2*abs(u_dot) <= pull*(1 - velocity_factor(element))*dt
   end function settles

end module rwmf_embedding_element_events
