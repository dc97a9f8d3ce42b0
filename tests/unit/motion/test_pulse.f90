!> Velocity and displacement of pulses by the formulas in the literature; jumps, monotone pieces,
!> sizes, tails.
program test_pulse
   use check, only: checks_t
   use rwmf_core_kinds, only: dp, pi, wp
   use rwmf_motion_ground_motion, only: acceleration, has_jump, interval_at, interval_end, &
      interval_last, motion_end, motion_from_case, motion_t, peak_acceleration, scaled_motion, &
      turning_point
   use rwmf_motion_near_fault_pulse, only: type_c_phase
   use rwmf_problem_case, only: case_t
   use rwmf_text_strings, only: real_to_text
   use scenes, only: block_scene
   implicit none

   real(wp), parameter :: omega = 5.3_wp, t_0 = 0.7_wp, size = 1.9_wp
   !! [rad/s], [s]; [m/s] or [m/s2]
   real(wp), parameter :: quadrature = 1.0e-12_wp
   !! error of Gauss's rule on 400 parts of a monotone piece, relative to the largest value
   real(wp), parameter :: numbers(9) = [1.0001_wp, 1.5_wp, 2.0_wp, 2.0_wp, 2.5_wp, 3.0_wp, 4.7_wp, &
      13.0_wp, 200.0_wp]
   !! gamma of Mavroeidis and Papageorgiou [-]
   real(wp), parameter :: phases(9) = [0.3_wp, -2.0_wp, pi/2, 0.0_wp, pi, 1.0_wp, 40.0_wp, pi/2, &
      0.1_wp]
   !! nu [rad]

   !> Velocity formula of the literature.
   type :: formula_t
      character(24) :: kind
      real(wp) :: origin
      !! of the time in the formula [s]
      real(wp) :: phase = 0
      !! phi or nu [rad]
      real(wp) :: gamma = 0
      !! [-]
   end type formula_t

   type(checks_t) :: checks
   integer :: i

   if (checks%wants('type_c_phases')) call check_type_c_phases()
   do i = 1, 6
      if (checks%wants('type_c')) call check_type_c(i)
   end do
   call check_ricker('ricker', 2.1_wp, size/omega)
   ! the formula has beta with eight digits
   call check_ricker('ricker_antisymmetric', 2.6_wp, 1.0e5_wp*size/omega)
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

   !> v = v_p (sin(omega t + phi) - sin(phi)), which returns to 0 like the displacement; both ends
   !> jump.
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
      call check_velocity(motion, formula_t('type_c', t_0, phi), size, 'C_n')
      call check_size(motion, omega*size, 'C_n')
      call checks%close_to(final_displacement(motion), 0.0_wp, 'C_n comes back', &
         atol=quadrature*(n + 1)*size/omega)

   end subroutine check_type_c

   !> The integral is a_p t exp(-(pi t/T_p)**2), or of the antisymmetric pulse
   !> (sqrt(3) T_p/(2 pi)) (a_p/beta) (1 - x**2) exp(-x**2/2), x = 2 pi t/(sqrt(3) T_p).
   subroutine check_ricker(kind, half, scale)
      character(*), intent(in) :: kind
      real(wp), intent(in) :: half
      !! duration until the middle over T_p [-]
      real(wp), intent(in) :: scale
      !! reference value of the velocity [m/s]
      type(motion_t) :: motion
      real(wp) :: centre

      if (.not. checks%wants(kind)) return
      motion = pulse_motion(kind, a_max=size)
      centre = (t_0 + motion_end(motion))/2
      call checks%close_to(centre, t_0 + half*2*pi/omega, 'middle of '//kind, &
         rtol=4*epsilon(centre))
      call check_smooth(motion, kind)
      call check_tails(motion, kind)
      call check_velocity(motion, formula_t(kind, centre), scale, kind)
      call check_size(motion, size, kind)
   end subroutine check_ricker

   !> Mavroeidis and Papageorgiou: v = A/2 (1 + cos(omega tau/gamma)) cos(omega tau + nu). The
   !> residual displacement vanishes only for cos(nu) sin(pi gamma) = 0.
   subroutine check_cycles(gamma, nu)
      real(wp), intent(in) :: gamma
      real(wp), intent(in) :: nu
      type(motion_t) :: motion
      real(wp) :: centre

      motion = pulse_motion('mavroeidis_papageorgiou', gamma_p=gamma, nu=nu, v_p=size)
      centre = t_0 + pi*gamma/omega
      call checks%close_to(motion_end(motion), t_0 + 2*pi*gamma/omega, 'gamma periods', &
         rtol=4*epsilon(gamma))
      call check_smooth(motion, 'cycles')
      call check_velocity(motion, formula_t('mavroeidis_papageorgiou', centre, nu, gamma), size, &
         'cycles')
      call check_size(motion, peak_acceleration(motion), 'cycles')
      call checks%close_to(final_displacement(motion), &
         size/omega/(1 - gamma**2)*cos(nu)*sin(pi*gamma), 'residual displacement', &
         atol=quadrature*(1 + gamma)*size/omega, rtol=epsilon(gamma)/(gamma - 1))

   end subroutine check_cycles

   !> Velocity of the ground by a formula of the literature [m/s].
   pure real(wp) function velocity(formula, t) result(v)
      type(formula_t), intent(in) :: formula
      real(wp), intent(in) :: t
      !! [s]
      real(wp), parameter :: beta = 1.3801190_dp
      real(wp) :: x
      real(wp) :: y

      x = omega*(t - formula%origin)
      select case (formula%kind)
      case ('type_c')
         v = size*(sin(x + formula%phase) - sin(formula%phase))
      case ('ricker')
         v = size/omega*x*exp(-(x/2)**2)
      case ('ricker_antisymmetric')
         y = x/sqrt(3.0_wp)
         v = sqrt(3.0_wp)/omega*size/beta*(1 - y**2)*exp(-y**2/2)
      case default
         v = size/2*(1 + cos(x/formula%gamma))*cos(x + formula%phase)
      end select
   end function velocity

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

   !> The integral of the acceleration is the velocity of the formula, at each turning point.
   subroutine check_velocity(motion, formula, scale, name)
      type(motion_t), intent(in) :: motion
      type(formula_t), intent(in) :: formula
      real(wp), intent(in) :: scale
      !! of the velocity [m/s]
      character(*), intent(in) :: name
      real(wp) :: v
      real(wp) :: u
      real(wp) :: t
      real(wp) :: worst
      integer :: interval

      v = velocity(formula, t_0)
      u = 0
      worst = 0
      t = t_0
      interval = 1
      do while (interval < interval_last(motion))
         call integrate(motion, interval, turning_point(motion, interval, t), t, v, u)
         worst = max(worst, abs(v - velocity(formula, t)))
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
      call checks%that(worst <= quadrature*scale, name//': velocity', &
         trim(real_to_text(worst/scale)))
      call checks%close_to(v, 0.0_wp, name//': the ground stops', atol=quadrature*scale)
   end subroutine check_velocity

   !> Final displacement of a motion that begins at rest [m].
   real(wp) function final_displacement(motion) result(u)
      type(motion_t), intent(in) :: motion
      real(wp) :: t
      real(wp) :: v
      integer :: interval

      t = t_0
      v = 0
      u = 0
      interval = 1
      do while (interval < interval_last(motion))
         call integrate(motion, interval, turning_point(motion, interval, t), t, v, u)
         if (t >= interval_end(motion, interval)) interval = interval + 1
      end do
   end function final_displacement

   !> Velocity and displacement at the end of a piece: Gauss's rule of order 6 on 400 parts.
   subroutine integrate(motion, interval, t_end, t, v, u)
      type(motion_t), intent(in) :: motion
      integer, intent(in) :: interval
      real(wp), intent(in) :: t_end
      real(wp), intent(inout) :: t
      real(wp), intent(inout) :: v
      real(wp), intent(inout) :: u
      integer, parameter :: parts = 400
      real(wp), parameter :: x(3) = (1 + sqrt(0.6_wp)*[-1, 0, 1])/2
      real(wp), parameter :: weight(3) = [5, 8, 5]/18.0_wp
      real(wp) :: a(3)
      real(wp) :: h
      integer :: i
      integer :: k

      h = (t_end - t)/parts
      do i = 1, parts
         a = [(acceleration(motion, interval, t + (i - 1 + x(k))*h), k=1, 3)]
         u = u + v*h + h**2*sum(weight*(1 - x)*a)
         v = v + h*sum(weight*a)
      end do
      t = t_end
   end subroutine integrate

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
