!> Spectra of the bare frame: the exact linear recursion in lanes, with exact peaks between samples.
!>
!> The same Taylor series as for the walls: the step is halved until omega_s h is at most 0.6, so
!> that its sixteen terms are exact to round-off. A record is linear in a step; a pulse is the cubic
!> through its values on Lobatto's nodes.
module rwmf_spectrum_fast_bare_frame
   use rwmf_core_control, only: control_t, count_done, is_cancelled
   use rwmf_core_kinds, only: pi, wp
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_spectrum_fast_schedule, only: group_t, list_groups
   use rwmf_spectrum_fast_simd_dispatch, only: advance_frames, best_level
   use rwmf_spectrum_fast_taylor_oscillator, only: find_root, newton_to_powers, series, state_at, &
      step_weights, terms => series_terms
   use rwmf_spectrum_fast_time_grid, only: build_grids, pulse_step, time_grid_t
   use rwmf_spectrum_fast_types, only: block_width, frame_block_width, ground_step_t
   implicit none
   private

   public :: run_frames

   real(wp), parameter :: base_step = 0.1_wp
   !! longest step [s]
   integer, parameter :: halvings = 12
   integer, parameter :: check_every = 1024
   !! steps between two checks of the caller's stop flag

   !> Frames that advance together.
   type :: frames_t
      real(wp) :: u(frame_block_width, 2)
      !! at the end and at the beginning of the step [m]
      real(wp) :: w(frame_block_width, 2)
      !! rates of u [m/s]
      real(wp) :: u_max(frame_block_width)
      !! largest |u| so far [m]
      real(wp) :: event(frame_block_width)
      !! 1: a peak is possible within the step
      real(wp) :: damping(frame_block_width)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(frame_block_width)
      !! omega_s**2 [1/s2]
      real(wp) :: weight(frame_block_width, 12)
   end type frames_t

contains

   !> Largest |u| of frames that start at rest; `is_done` becomes true for those computed.
   subroutine run_frames(case, motion, threads, control, T_s, u_max, is_done)
      type(case_t), intent(in) :: case
      !! with frame, supported by `rwmf_spectrum_fast_eligibility`
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: threads
      type(control_t), intent(in) :: control
      real(wp), intent(in) :: T_s(:)
      !! (n_T) [s]
      real(wp), intent(inout) :: u_max(:)
      !! (n_T) [m]
      logical, intent(inout) :: is_done(:)
      !! (n_T)
      type(group_t), allocatable :: group(:)
      type(ground_step_t), allocatable, target :: ground(:)
      type(time_grid_t) :: grid(0:halvings)
      real(wp) :: h_max(0:halvings)
      integer :: instructions
      integer :: i, k

      h_max = [(merge(min(base_step/2.0_wp**i, pulse_step(case, motion)), 0.0_wp, &
         any(levels(T_s) == i)), i=0, halvings)]
      call build_grids(case, motion, threads, h_max, ground, grid)
      group = list_groups(T_s, levels(T_s), halvings)
      instructions = best_level()
      !$omp parallel do num_threads(threads) schedule(dynamic) default(shared)
      do i = 1, size(group)
         if (.not. associated(grid(group(i)%level)%step)) cycle
         associate (member => group(i)%member(:group(i)%n))
            call run_block(control, grid(group(i)%level), T_s(member), case%frame%xi_s, &
               instructions, u_max, member)
            if (is_cancelled(control)) cycle
            is_done(member) = .true.
            do k = 1, group(i)%n
               call count_done(control)
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine run_frames

   !> Halvings of the longest step for a period; `halvings` + 1 where no step is short enough.
   pure elemental integer function levels(T_s)
      real(wp), intent(in) :: T_s
      !! [s]

      levels = max(0, ceiling(log(2*pi*base_step/(0.6_wp*T_s))/log(2.0_wp)))
      levels = min(levels, halvings + 1)
   end function levels

   !> Compute up to `frame_block_width` frames together.
   subroutine run_block(control, grid, T_s, xi_s, instructions, u_max, member)
      type(control_t), intent(in) :: control
      type(time_grid_t), intent(in) :: grid
      real(wp), intent(in) :: T_s(:)
      !! (n) [s]
      real(wp), intent(in) :: xi_s
      integer, intent(in) :: instructions
      real(wp), intent(inout) :: u_max(:)
      !! [m]
      integer, intent(in) :: member(:)
      !! (n) indices of the periods, for the results
      type(frames_t) :: frames
      real(wp) :: h
      integer :: i, n, number
      logical :: is_at_rest
      !! the ground has not moved yet

      n = block_width*((size(T_s) + block_width - 1)/block_width)
      do i = 1, n
         associate (omega_s => 2*pi/T_s(min(i, size(T_s))))
            frames%damping(i) = 2*xi_s*omega_s
            frames%stiffness(i) = omega_s**2
         end associate
      end do
      frames%u(:n, :) = 0
      frames%w(:n, :) = 0
      frames%u_max(:n) = 0
      h = 0
      is_at_rest = .true.
      do number = 1, size(grid%step)
         if (mod(number, check_every) == 0) then
            if (is_cancelled(control)) return
         end if
         associate (step => grid%step(number))
            if (abs(step%h - h) > 0) then
               h = step%h
               call set_weights(n, h, frames)
            end if
            call advance_frames(instructions, n, h, step%f, frames%weight, frames%u, frames%w, &
               frames%u_max, frames%event)
            ! In the step that begins without a velocity its sign does not indicate a peak.
            if (is_at_rest .and. any(abs(step%f) > 0)) then
               frames%event(:n) = 1
               is_at_rest = .false.
            end if
            if (any(frames%event(:n) > 0)) call update_peaks(size(T_s), h, step%f, frames)
         end associate
      end do
      u_max(member) = frames%u_max(:size(T_s))
   end subroutine run_block

   !> Set the weights of the frames for a step h.
   pure subroutine set_weights(n, h, frames)
      integer, intent(in) :: n
      real(wp), intent(in) :: h
      !! [s]
      type(frames_t), intent(inout) :: frames
      real(wp) :: weight(12, 3)
      integer :: i

      do i = 1, n
         weight = step_weights(frames%damping(i), frames%stiffness(i), h, 0.5_wp)
         frames%weight(i, :) = weight(:, 3)
      end do
   end subroutine set_weights

   !> Update the largest |u| by peaks within a step. For a motion that begins with u' = 0 the root
   !> is that of u'/x or u'/x**2, which does not vanish there.
   pure subroutine update_peaks(n, h, f, frames)
      integer, intent(in) :: n
      real(wp), intent(in) :: h
      real(wp), intent(in) :: f(0:3)
      type(frames_t), intent(inout) :: frames
      real(wp) :: p(0:terms)
      real(wp) :: rate(0:terms - 1)
      real(wp) :: x, u, w
      integer :: i, j, first

      do i = 1, n
         if (.not. frames%event(i) > 0) cycle
         call series(frames%damping(i), frames%stiffness(i), h, frames%u(i, 2), frames%w(i, 2), &
            -newton_to_powers(f), p)
         do j = 0, terms - 1
            rate(j) = (j + 1)*p(j + 1)
         end do
         first = findloc(abs(rate(:2)) > 0, .true., dim=1) - 1
         if (first < 0) cycle
         if (rate(first)*sum(rate(first:)) >= 0) cycle
         call find_root(rate(first:), 0.0_wp, 1.0_wp, x)
         call state_at(p, x, u, w)
         frames%u_max(i) = max(frames%u_max(i), abs(u))
      end do
   end subroutine update_peaks

end module rwmf_spectrum_fast_bare_frame
