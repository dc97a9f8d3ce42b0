!> Ends, jumps, monotone pieces, sizes and tails of pulses, and the phases of C_n.
program test_pulse
   use check, only: checks_t
   use rwmf_core_kinds, only: dp, pi, wp
   use rwmf_motion_ground_motion, only: acceleration, has_jump, interval_end, interval_last, &
      motion_end, motion_from_case, motion_t, peak_acceleration, scaled_motion, turning_point
   use rwmf_motion_near_fault_pulse, only: type_c_phase
   use rwmf_problem_case, only: case_t
   use rwmf_text_strings, only: real_to_text
   use scenes, only: block_scene
   implicit none

   real(wp), parameter :: omega = 5.3_wp, t_0 = 0.7_wp, size = 1.9_wp
   !! [rad/s], [s]; [m/s] or [m/s2]
   real(wp), parameter :: numbers(9) = [1.0001_wp, 1.5_wp, 2.0_wp, 2.0_wp, 2.5_wp, 3.0_wp, 4.7_wp, &
      13.0_wp, 200.0_wp]
   !! gamma of Mavroeidis and Papageorgiou [-]
   real(wp), parameter :: phases(9) = [0.3_wp, -2.0_wp, pi/2, 0.0_wp, pi, 1.0_wp, 40.0_wp, pi/2, &
      0.1_wp]
   !! nu [rad]

   type(checks_t) :: checks
   integer :: i

   if (checks%wants('type_c_phases')) call check_type_c_phases()
   do i = 1, 6
      if (checks%wants('type_c')) call check_type_c(i)
   end do
   call check_ricker('ricker', 2.1_wp)
   call check_ricker('ricker_antisymmetric', 2.6_wp)
   do i = 1, ubound(numbers, 1)
      if (checks%wants('cycles')) call check_cycles(numbers(i), phases(i))
   end do
   call checks%finish()

contains

   !> Published to four digits (Makris and Chang 2000: 0.0697 pi, 0.0410 pi); with m = (n + 1/2) pi
   !> m - phi is a root of tan(x) = x.
   subroutine check_type_c_phases()
      real(wp), parameter :: published(2) = [0.0697_wp, 0.0410_wp]
      real(wp) :: x
      integer :: n

      do n = 1, 2
         call checks%close_to(type_c_phase(n)/pi, published(n), 'published phase', atol=0.5e-4_wp)
      end do
      do n = 1, 50
         x = (n + 0.5_wp)*pi - type_c_phase(n)
         call checks%close_to(sin(x), x*cos(x), 'tan(x) = x', atol=2*epsilon(x)*x**2)
      end do
   end subroutine check_type_c_phases

   !> Both ends of C_n jump.
   subroutine check_type_c(n)
      integer, intent(in) :: n
      type(motion_t) :: motion
      real(wp) :: phi

      motion = pulse_motion('type_c', n_pulses=n, v_p=size)
      phi = type_c_phase(n)
      call checks%that(has_jump(motion, 1) .and. has_jump(motion, interval_last(motion)), &
         'C_n jumps at both ends')
      call checks%close_to(motion_end(motion), t_0 + (2*n + 1 - 2*phi/pi)*pi/omega, 'end of C_n', &
         rtol=4*epsilon(phi))
      call check_pieces(motion, 'C_n')
      call check_size(motion, omega*size, 'C_n')
   end subroutine check_type_c

   !> Middle of a smooth pulse, at half of its duration.
   subroutine check_ricker(kind, half)
      character(*), intent(in) :: kind
      real(wp), intent(in) :: half
      !! duration until the middle over T_p [-]
      type(motion_t) :: motion
      real(wp) :: centre

      if (.not. checks%wants(kind)) return
      motion = pulse_motion(kind, a_max=size)
      centre = (t_0 + motion_end(motion))/2
      call checks%close_to(centre, t_0 + half*2*pi/omega, 'middle of '//kind, &
         rtol=4*epsilon(centre))
      call check_smooth(motion, kind)
      call check_tails(motion, kind)
      call check_size(motion, size, kind)
   end subroutine check_ricker

   !> The pulse of Mavroeidis and Papageorgiou lasts gamma periods.
   subroutine check_cycles(gamma, nu)
      real(wp), intent(in) :: gamma
      real(wp), intent(in) :: nu
      type(motion_t) :: motion

      motion = pulse_motion('mavroeidis_papageorgiou', gamma_p=gamma, nu=nu, v_p=size)
      call checks%close_to(motion_end(motion), t_0 + 2*pi*gamma/omega, 'gamma periods', &
         rtol=4*epsilon(gamma))
      call check_smooth(motion, 'cycles')
      call check_size(motion, peak_acceleration(motion), 'cycles')
   end subroutine check_cycles

   !> The motion has no jump, and the given number of monotone pieces.
   subroutine check_smooth(motion, name)
      type(motion_t), intent(in) :: motion
      character(*), intent(in) :: name
      integer :: interval

      do interval = 1, interval_last(motion)
         call checks%that(.not. has_jump(motion, interval), name//' has no jump')
      end do
      call check_pieces(motion, name)
   end subroutine check_smooth

   !> Between two turning points the acceleration rises or falls, to round-off.
   subroutine check_pieces(motion, name)
      type(motion_t), intent(in) :: motion
      character(*), intent(in) :: name
      integer, parameter :: n = 200
      real(wp) :: a(0:n)
      real(wp) :: t
      real(wp) :: t_next
      integer :: interval
      integer :: k

      t = t_0
      interval = 1
      do while (interval < interval_last(motion))
         t_next = turning_point(motion, interval, t)
         call checks%that(t_next > t, name//': turning points advance')
         if (t_next <= t) return
         a = [(acceleration(motion, interval, t + (t_next - t)*k/n), k=0, n)]
         associate (step => sign(1.0_wp, a(n) - a(0))*(a(1:) - a(:n - 1)))
            call checks%that(all(step >= -32*epsilon(t)*peak_acceleration(motion)), &
               name//': monotone', trim(real_to_text(minval(step)))//' at '//trim(real_to_text(t)))
         end associate
         t = t_next
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
   end subroutine check_pieces

   !> The truncated tails are below the round-off of double precision.
   subroutine check_tails(motion, name)
      type(motion_t), intent(in) :: motion
      character(*), intent(in) :: name
      real(wp) :: tails

      tails = max(abs(acceleration(motion, 1, t_0)), &
         abs(acceleration(motion, interval_last(motion) - 1, motion_end(motion))))
      call checks%that(tails > 0 .and. tails < epsilon(1.0_dp)/2*peak_acceleration(motion), &
         name//': tails', trim(real_to_text(tails/size)))
   end subroutine check_tails

   !> The largest acceleration equals the given size; a factor of -2 doubles and mirrors the motion.
   subroutine check_size(motion, a_max, name)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: a_max
      !! [m/s2]
      character(*), intent(in) :: name
      type(motion_t) :: mirrored
      real(wp) :: found
      real(wp) :: t
      integer :: interval

      found = 0
      mirrored = scaled_motion(motion, -2.0_wp)
      t = t_0
      interval = 1
      do while (interval < interval_last(motion))
         t = turning_point(motion, interval, t)
         associate (a => acceleration(motion, interval, t))
            found = max(found, abs(a))
            call checks%close_to(acceleration(mirrored, interval, t), -2*a, name//' mirrored')
         end associate
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
      call checks%close_to(found, a_max, name//': largest acceleration', rtol=8*epsilon(found))
      call checks%close_to(peak_acceleration(mirrored), 2*a_max, name//': peak', &
         rtol=8*epsilon(found))
   end subroutine check_size

   !> Motion of a pulse, given by its velocity [m/s] or by its largest acceleration [m/s2].
   function pulse_motion(kind, n_pulses, gamma_p, nu, v_p, a_max) result(motion)
      character(*), intent(in) :: kind
      integer, intent(in), optional :: n_pulses
      real(wp), intent(in), optional :: gamma_p
      real(wp), intent(in), optional :: nu
      real(wp), intent(in), optional :: v_p
      real(wp), intent(in), optional :: a_max
      type(motion_t) :: motion
      type(case_t) :: case

      case = block_scene('dop853')
      case%motion%kind = kind
      case%motion%omega_p = omega
      case%motion%t_0 = t_0
      if (present(n_pulses)) case%motion%n_pulses = n_pulses
      if (present(gamma_p)) case%motion%gamma_p = gamma_p
      if (present(nu)) case%motion%nu = nu
      deallocate (case%motion%a_max_g)
      if (present(v_p)) case%motion%v_p = v_p
      if (present(a_max)) case%motion%a_max_g = a_max/case%model%g
      motion = motion_from_case(case)
   end function pulse_motion

end program test_pulse
