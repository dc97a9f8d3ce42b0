!> Spectra of the bare frame: the exact linear recursion, with exact peaks between samples.
!>
!> The same Taylor series as for the walls: the step is halved until the faster root of the
!> oscillator times h is at most 0.6, so that its sixteen terms are exact to round-off. A record is
!> linear in a step; a pulse is the cubic through its values on Lobatto's nodes. The free vibration
!> after the motion ends as soon as its energy no longer reaches the largest displacement.
module rwmf_spectrum_fast_bare_frame
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_kinds, only: i8, pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_taylor_oscillator, only: fastest_root, newton_to_powers, series, &
      state_at, step_weights, terms => series_terms
   use rwmf_spectrum_fast_time_grid, only: build_grids, pulse_step, time_grid_t
   use rwmf_spectrum_fast_types, only: ground_step_t
   implicit none
   private

   public :: run_frames

   real(wp), parameter :: base_step = 0.1_wp
   !! longest step [s]
   integer, parameter :: halvings = 12

contains

   !> Largest |u| of frames that start at rest, over the unit of the motion; `is_done` becomes true
   !> for those computed.
   subroutine run_frames(case, motion, threads, control, T_s, xi_s, u_max, is_done)
      type(case_t), intent(in) :: case
      !! how to integrate
      type(motion_t), intent(in) :: motion
      !! in any unit
      integer, intent(in) :: threads
      !! number of threads to use
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: T_s(:)
      !! (frames) [s]
      real(wp), intent(in) :: xi_s(:)
      !! (frames) damping ratios [-]
      real(wp), intent(inout) :: u_max(:)
      !! (frames) [m per unit of m/s2]
      logical, intent(inout) :: is_done(:)
      !! (frames)
      type(ground_step_t), allocatable, target :: ground(:)
      type(time_grid_t) :: grid(0:halvings)
      real(wp) :: h_max(0:halvings)
      integer :: level(size(T_s))
      integer :: i

      level = halvings_for(fastest_root(4*pi*xi_s/T_s, (2*pi/T_s)**2))
      h_max = [(merge(min(base_step/2.0_wp**i, pulse_step(case, motion)), 0.0_wp, &
         any(level == i)), i=0, halvings)]
      call build_grids(case, motion, threads, h_max, ground, grid)
      !$omp parallel do num_threads(threads) schedule(dynamic, 4) default(shared)
      do i = 1, size(T_s)
         if (is_cancelled(control)) cycle
         if (level(i) > halvings) cycle
         if (.not. associated(grid(level(i))%step)) cycle
         call run_frame(grid(level(i)), 4*pi*xi_s(i)/T_s(i), (2*pi/T_s(i))**2, u_max(i), &
            is_done(i))
         if (is_done(i)) call count_done(control)
      end do
      !$omp end parallel do
   end subroutine run_frames

   !> Halvings of the step for the faster root of an oscillator; `halvings` + 1 where they do not
   !> suffice.
   pure elemental integer function halvings_for(root) result(level)
      real(wp), intent(in) :: root
      !! [1/s]
      real(wp) :: ratio
      !! of the longest step to that which the series allows [-]

      ratio = base_step*root/0.6_wp
      level = halvings + 1
      if (ratio <= 2.0_wp**halvings) level = max(0, ceiling(log(ratio)/log(2.0_wp)))
   end function halvings_for

   !> Advance a frame from rest to the end.
   pure subroutine run_frame(grid, damping, stiffness, u_max, is_done)
      type(time_grid_t), intent(in) :: grid
      real(wp), intent(in) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp), intent(in) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp), intent(out) :: u_max
      !! largest |u| [m]
      logical, intent(out) :: is_done
      !! it is that of the whole time, and finite
      real(wp), parameter :: round_off = 1 + 64*epsilon(1.0_wp)
      real(wp) :: a(12), weight(12, 3)
      real(wp) :: h, u, w, u_0, w_0, rise
      integer(i8) :: repetitions
      integer :: number
      logical :: is_at_rest
      !! the ground has not moved yet

      h = 0
      u = 0
      w = 0
      u_max = 0
      is_at_rest = .true.
      is_done = .not. grid%is_cut
      repetitions = grid%repetitions
      number = 0
      do
         if (number >= size(grid%step)) then
            if (repetitions == 0) exit
            repetitions = repetitions - 1
            number = grid%motion_end_step
         end if
         number = number + 1
         ! free vibration gains no energy
         if (number >= grid%motion_end_step) then
            is_done = is_done .or. u**2 + w**2/stiffness <= (round_off*u_max)**2
            if (u**2 + w**2/stiffness <= (round_off*u_max)**2) exit
         end if
         associate (step => grid%step(number), f => grid%step(number)%f)
            if (abs(step%h - h) > 0) then
               h = step%h
               weight = step_weights(damping, stiffness, h, 0.5_wp)
               a = weight(:, 3)
            end if
            u_0 = u
            w_0 = w
            u = a(1)*u_0 + a(2)*w_0 - (a(5)*f(0) + a(6)*f(1) + a(7)*f(2) + a(8)*f(3))
            w = a(3)*u_0 + a(4)*w_0 - (a(9)*f(0) + a(10)*f(1) + a(11)*f(2) + a(12)*f(3))
            u_max = max(u_max, abs(u))
            ! A parabola rises above its ends by at most h/8 of this sum; the bound is twice that.
            ! In the step that begins without a velocity its sign does not indicate a peak.
            rise = 0.25_wp*h*(abs(w) + abs(w_0)) + max(abs(u), abs(u_0)) - u_max
            if ((rise > 0 .and. w*w_0 < 0) .or. (is_at_rest .and. any(abs(f) > 0))) then
               call update_peak(damping, stiffness, h, u_0, w_0, f, u_max)
               is_at_rest = .false.
            end if
         end associate
      end do
      is_done = is_done .and. u_max <= huge(u_max)
   end subroutine run_frame

   !> Update the largest |u| by a peak within a step. For a motion that begins with u' = 0 the root
   !> is that of u'/x or u'/x**2, which does not vanish there.
   pure subroutine update_peak(damping, stiffness, h, u_0, w_0, f, u_max)
      real(wp), intent(in) :: damping
      real(wp), intent(in) :: stiffness
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(in) :: u_0
      !! [m]
      real(wp), intent(in) :: w_0
      !! [m/s]
      real(wp), intent(in) :: f(0:3)
      real(wp), intent(inout) :: u_max
      type(bracket_t) :: bracket
      real(wp) :: p(0:terms)
      real(wp) :: rate(0:terms - 1)
      real(wp) :: x, x_last, value, slope
      integer :: i, first

      call series(damping, stiffness, h, u_0, w_0, -newton_to_powers(f), p)
      rate = [((i + 1)*p(i + 1), i=0, terms - 1)]
      first = findloc(abs(rate(:2)) > 0, .true., dim=1) - 1
      if (first < 0) return
      if (rate(first)*sum(rate(first:)) >= 0) return
      bracket = bracket_between(0.0_wp, 1.0_wp)
      x = 0.5_wp
      do i = 1, 80
         call state_at(rate(first:), x, value, slope)
         call narrow(bracket, rate(first)*value <= 0, x)
         x_last = x
         x = bracket%middle
         if (abs(value) < abs(slope)) x = keep_inside(bracket, x_last - value/slope, &
            may_be_end=.true.)
         ! Newton's method is quadratic: the error after a small correction is round-off.
         if (abs(x - x_last) <= 1.0e-9_wp*x) exit
      end do
      call state_at(p, x, value, slope)
      u_max = max(u_max, abs(value))
   end subroutine update_peak

end module rwmf_spectrum_fast_bare_frame
