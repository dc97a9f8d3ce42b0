!> Amplitudes of pulses from the keys of a case, and the shapes of pulses other than harmonics, with
!> unit acceleration (largest magnitude 1).
!>
!> Each pulse is cut at its extrema and zeros and is monotone between two cuts. An integrator that
!> stops at the cuts cannot step over a narrow pulse.
module rwmf_motion_near_fault_pulse
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, keep_inside, narrow
   use rwmf_problem_case, only: motion_spec_t
   implicit none
   private

   public :: amplitude_of, angular_frequency
   public :: pulse_t, build_pulse, cut_times, pulse_shape, pulse_series, pulse_slope, &
      pulse_gain, type_c_phase, add_sine

   integer, parameter :: shape_ricker = 1
   integer, parameter :: shape_ricker_antisymmetric = 2
   integer, parameter :: shape_mavroeidis_papageorgiou = 3

   real(wp), parameter :: ricker_ends(2) = [2.1_wp, 2.6_wp]
   !! half durations of the Ricker pulses over T_p, equal in every precision [-]. Beyond them the
   !! acceleration is below the round-off of double precision (3e-17 of its peak).
   real(wp), parameter :: beta = sqrt(6*(3 - sqrt(6.0_wp)))*exp((sqrt(6.0_wp) - 3)/2)
   !! largest magnitude of (x**2 - 3) x exp(-x**2/2), 1.3801... [-]
   real(wp), parameter :: hermite_4(4) = [-1, -1, 1, 1]*sqrt(3 + [1, -1, -1, 1]*sqrt(6.0_wp))
   !! zeros of the Hermite polynomial of order 4 [-]
   real(wp), parameter :: hermite_5(4) = [-1, -1, 1, 1]*sqrt(5 + [1, -1, -1, 1]*sqrt(10.0_wp))
   !! zeros of the Hermite polynomial of order 5 except x = 0 [-]
   real(wp), parameter :: most_of_hermite_6 = 15
   !! largest magnitude of the sixth derivative of exp(-x**2/2), which is at x = 0 [-]
   real(wp), parameter :: most_of_hermite_7 = 36
   !! largest magnitude of the seventh derivative, rounded up from 35.54 [-]

   !> Pulse of one kind, in dimensionless form.
   type :: pulse_t
      integer :: shape = 0
      !! one of the `shape_` numbers
      real(wp) :: rate = 0
      !! rate of the position over time [1/s]
      real(wp) :: centre = 0
      !! [s]
      real(wp) :: half = 0
      !! position of the end [-]
      real(wp) :: gamma = 0
      !! of Mavroeidis and Papageorgiou, number of cycles [-]
      real(wp) :: nu = 0
      !! of Mavroeidis and Papageorgiou, phase [rad]
      real(wp) :: peak = 1
      !! largest magnitude before normalisation [-]
      real(wp) :: fastest = 0
      !! fourth root of the largest fourth derivative of the unit pulse [1/s]
   end type pulse_t

contains

   !> Angular frequency omega_p of a case, given as such or as the period [rad/s].
   pure real(wp) function angular_frequency(spec)
      type(motion_spec_t), intent(in) :: spec

      if (allocated(spec%omega_p)) then
         angular_frequency = spec%omega_p
      else
         angular_frequency = 2*pi/spec%T_p
      end if
   end function angular_frequency

   !> Largest acceleration with its sign, given as such or as the velocity [m/s2].
   pure real(wp) function amplitude_of(spec, g, velocity_factor)
      type(motion_spec_t), intent(in) :: spec
      real(wp), intent(in) :: g
      !! [m/s2]
      real(wp), intent(in) :: velocity_factor
      !! acceleration over v_p [1/s]

      if (allocated(spec%a_max_g)) then
         amplitude_of = spec%a_max_g*g
      else
         amplitude_of = velocity_factor*spec%v_p
      end if
   end function amplitude_of

   !> Build the pulse of a case.
   pure function build_pulse(spec, omega) result(pulse)
      type(motion_spec_t), intent(in) :: spec
      !! of any kind except the harmonics
      real(wp), intent(in) :: omega
      !! angular frequency [rad/s]
      type(pulse_t) :: pulse

      select case (spec%kind)
      case ('ricker')
         pulse%shape = shape_ricker
         pulse%rate = omega/sqrt(2.0_wp)
         pulse%half = 2*pi/sqrt(2.0_wp)*ricker_ends(1)
         pulse%fastest = pulse%rate*most_of_hermite_6**0.25_wp
      case ('ricker_antisymmetric')
         pulse%shape = shape_ricker_antisymmetric
         pulse%rate = omega/sqrt(3.0_wp)
         pulse%half = 2*pi/sqrt(3.0_wp)*ricker_ends(2)
         pulse%peak = beta
         pulse%fastest = pulse%rate*(most_of_hermite_7/beta)**0.25_wp
      case default
         pulse%shape = shape_mavroeidis_papageorgiou
         pulse%rate = omega
         pulse%gamma = spec%gamma_p
         pulse%nu = spec%nu
         ! remove full turns, whose number may exceed the largest integer
         if (abs(pulse%nu) > 2*pi) pulse%nu = atan2(sin(pulse%nu), cos(pulse%nu))
         pulse%half = pi*spec%gamma_p
         pulse%peak = maxval(abs(unit_acceleration(pulse, cycles_cuts(pulse))))
         associate (part => 1/pulse%gamma)
            pulse%fastest = pulse%rate &
               *((1 + ((1 + part)**5 + (1 - part)**5)/2)/pulse%peak)**0.25_wp
         end associate
      end select
      pulse%centre = spec%t_0 + pulse%half/pulse%rate
   end function build_pulse

   !> Unit acceleration at a time inside the pulse [-].
   elemental real(wp) function pulse_shape(pulse, t)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: t
      !! [s]

      pulse_shape = unit_acceleration(pulse, pulse%rate*(t - pulse%centre))/pulse%peak
   end function pulse_shape

   !> Unit acceleration at a position [-]. Ricker pulses (1943) have the form of Vassiliou and
   !> Makris (BSSA 101, 2011), symmetric over a_p, antisymmetric over a_p/beta. Those of Mavroeidis
   !> and Papageorgiou (BSSA 93, 2003) are over A pi f_p.
   elemental real(wp) function unit_acceleration(pulse, x) result(a)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: x
      !! [-]

      select case (pulse%shape)
      case (shape_ricker)
         a = (1 - x**2)*exp(-x**2/2)
      case (shape_ricker_antisymmetric)
         a = (x**2 - 3)*x*exp(-x**2/2)
      case default
         associate (u => x/pulse%gamma)
            a = -(sin(u)*cos(x + pulse%nu)/pulse%gamma + (1 + cos(u))*sin(x + pulse%nu))
         end associate
      end select
   end function unit_acceleration

   !> Taylor series of the unit acceleration at a time inside the pulse [1/s**k].
   pure subroutine pulse_series(pulse, t, series)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: series(0:)
      !! (order) coefficients
      real(wp) :: bell(0:ubound(series, 1) + 3)
      !! series of exp(-x**2/2), of which both Ricker pulses are derivatives
      real(wp) :: x, part
      integer :: k

      x = pulse%rate*(t - pulse%centre)
      if (pulse%shape == shape_mavroeidis_papageorgiou) then
         part = 1/pulse%gamma
         series = 0
         call add_sine(-1.0_wp, 1.0_wp, x + pulse%nu, series)
         call add_sine(-(1 + part)/2, 1 + part, (1 + part)*x + pulse%nu, series)
         call add_sine(-(1 - part)/2, 1 - part, (1 - part)*x + pulse%nu, series)
      else
         bell(0) = exp(-x**2/2)
         bell(1) = -x*bell(0)
         do k = 1, ubound(bell, 1) - 1
            bell(k + 1) = -(x*bell(k) + bell(k - 1))/(k + 1)
         end do
         do k = 0, ubound(series, 1)
            if (pulse%shape == shape_ricker) then
               series(k) = -(k + 1)*(k + 2)*bell(k + 2)
            else
               series(k) = -(k + 1)*(k + 2)*(k + 3)*bell(k + 3)
            end if
         end do
      end if
      series = series*[(pulse%rate**k, k=0, ubound(series, 1))]/pulse%peak

   end subroutine pulse_series

   !> Add the series of size*sin(phase + frequency*x) in x.
   pure subroutine add_sine(size, frequency, phase, series)
      real(wp), intent(in) :: size
      !! unit of the series
      real(wp), intent(in) :: frequency
      !! phase per unit of x [rad]
      real(wp), intent(in) :: phase
      !! [rad]
      real(wp), intent(inout) :: series(0:)
      !! (order) coefficients
      integer, parameter :: highest = 32
      integer :: i
      real(wp), parameter :: ratio(0:highest) = [(1.0_wp/((i + 1)*(i + 2)), i=0, highest)]
      !! of the coefficients of order i and i + 2, without the frequencies
      real(wp) :: term(0:1), square
      integer :: k

      term = size*[sin(phase), frequency*cos(phase)]
      square = -frequency**2
      do k = 0, ubound(series, 1)
         associate (of_parity => term(iand(k, 1)))
            series(k) = series(k) + of_parity
            of_parity = of_parity*(square*ratio(k))
         end associate
      end do
   end subroutine add_sine

   !> Rate of the unit acceleration at a time inside the pulse [1/s].
   elemental real(wp) function pulse_slope(pulse, t)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: t
      !! [s]

      pulse_slope = unit_slope(pulse, pulse%rate*(t - pulse%centre))*pulse%rate/pulse%peak
   end function pulse_slope

   !> Gain in velocity from the beginning of the pulse to a time inside it, over its amplitude [s].
   elemental real(wp) function pulse_gain(pulse, t)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: t
      !! [s]

      pulse_gain = (unit_velocity(pulse, pulse%rate*(t - pulse%centre)) - unit_velocity(pulse, &
         -pulse%half))/(pulse%rate*pulse%peak)
   end function pulse_gain

   !> Antiderivative of the unit acceleration with respect to the position.
   elemental real(wp) function unit_velocity(pulse, x) result(v)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: x
      !! [-]

      select case (pulse%shape)
      case (shape_ricker)
         v = x*exp(-x**2/2)
      case (shape_ricker_antisymmetric)
         v = (1 - x**2)*exp(-x**2/2)
      case default
         v = (1 + cos(x/pulse%gamma))*cos(x + pulse%nu)
      end select
   end function unit_velocity

   !> Derivative of the unit acceleration with respect to the position.
   elemental real(wp) function unit_slope(pulse, x) result(slope)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: x
      !! [-]
      real(wp) :: p
      real(wp) :: q

      select case (pulse%shape)
      case (shape_ricker)
         slope = (x**2 - 3)*x*exp(-x**2/2)
      case (shape_ricker_antisymmetric)
         slope = -((x**2 - 6)*x**2 + 3)*exp(-x**2/2)
      case default
         p = 1 + 1/pulse%gamma**2
         q = 2/pulse%gamma
         associate (u => x/pulse%gamma)
            slope = q*sin(u)*sin(x + pulse%nu) - (1 + p*cos(u))*cos(x + pulse%nu)
         end associate
      end select
   end function unit_slope

   !> Times of the beginning, extrema, zeros and end of a pulse, strictly increasing [s].
   pure function cut_times(pulse, has_bends) result(t)
      type(pulse_t), intent(in) :: pulse
      logical, intent(in) :: has_bends
      !! include the extrema of the slope
      real(wp), allocatable :: t(:)
      !! (cuts)
      real(wp), allocatable :: x(:)
      real(wp) :: least
      !! distance below which two cuts merge: the pulse rises by less than round-off between them
      !! [-]
      integer :: i
      integer :: n

      ! positions of the beginning, extrema, zeros and end; some may coincide
      select case (pulse%shape)
      case (shape_ricker)
         x = [-sqrt(3.0_wp), -1.0_wp, 0.0_wp, 1.0_wp, sqrt(3.0_wp)]
      case (shape_ricker_antisymmetric)
         x = [hermite_4(1), -sqrt(3.0_wp), hermite_4(2), 0.0_wp, hermite_4(3), sqrt(3.0_wp), &
            hermite_4(4)]
      case default
         x = cycles_cuts(pulse)
      end select
      x = [-pulse%half, x, pulse%half]
      if (has_bends) x = [x(1), sorted([x(2:size(x) - 1), bends(pulse)]), x(size(x))]
      least = max(sqrt(epsilon(1.0_wp)), 16*pulse%rate*spacing(abs(pulse%centre) &
         + pulse%half/pulse%rate))
      n = 1
      do i = 2, size(x) - 1
         if (x(i) - x(n) <= least .or. pulse%half - x(i) <= least) cycle
         n = n + 1
         x(n) = x(i)
      end do
      t = pulse%centre + [x(:n), pulse%half]/pulse%rate
   end function cut_times

   !> Positions at which the slope is extremal.
   pure function bends(pulse) result(x)
      type(pulse_t), intent(in) :: pulse
      real(wp), allocatable :: x(:)
      real(wp) :: part
      integer :: first, last, k

      select case (pulse%shape)
      case (shape_ricker)
         x = hermite_4
      case (shape_ricker_antisymmetric)
         ! x = 0 is already a cut
         x = hermite_5
      case default
         ! Positions of extremal slope of a pulse of Mavroeidis and Papageorgiou. Its second
         ! derivative is the imaginary part of the expression in `cycles_cuts`, with p = 1 +
         ! 3/gamma**2, q = (3 + 1/gamma**2)/gamma.
         part = 1/pulse%gamma
         ! phase at the ends: nu -+ (half + pi); a root at an end is the end itself
         first = ceiling((pulse%nu - pulse%half)/pi) - 1
         last = floor((pulse%nu + pulse%half)/pi) + 1
         allocate (x(last - first + 1))
         do k = first, last
            x(k - first + 1) = phase_place(pulse, 1 + 3*part**2, (3 + part**2)*part, k*pi)
         end do
      end select
   end function bends

   !> Sort numbers in ascending order.
   pure function sorted(x) result(y)
      real(wp), intent(in) :: x(:)
      real(wp) :: y(size(x))
      integer :: i, place

      do i = 1, size(x)
         place = 1 + count(x < x(i)) + count(x(:i - 1) <= x(i) .and. x(:i - 1) >= x(i))
         y(place) = x(i)
      end do
   end function sorted

   !> Extrema and zeros of a pulse of Mavroeidis and Papageorgiou.
   !>
   !> Let u = x/gamma. Acceleration and rate are the imaginary and the real part of exp(i(x + nu))
   !> times (1 + p cos(u)) + i q sin(u). The acceleration has p = 1, q = 1/gamma, the rate p = 1 +
   !> 1/gamma**2, q = 2/gamma. The phases of both grow with x, so that zeros and extrema alternate
   !> and none is missed.
   pure function cycles_cuts(pulse) result(x)
      type(pulse_t), intent(in) :: pulse
      real(wp), allocatable :: x(:)
      !! (cuts)
      real(wp) :: part
      integer :: first
      integer :: last
      integer :: k

      part = 1/pulse%gamma
      ! phase at the ends: nu -+ (half + pi/2)
      first = ceiling((pulse%nu - pulse%half)/pi - 0.5_wp)
      last = floor((pulse%nu + pulse%half)/pi + 0.5_wp)
      allocate (x(2*(last - first + 1) + 1))
      x(1) = phase_place(pulse, 1 + part**2, 2*part, (first - 0.5_wp)*pi)
      do k = first, last
         associate (i => 2*(k - first + 1))
            x(i) = phase_place(pulse, 1.0_wp, part, k*pi)
            x(i + 1) = phase_place(pulse, 1 + part**2, 2*part, (k + 0.5_wp)*pi)
         end associate
      end do
   end function cycles_cuts

   !> Find the position where a phase has a given value, by Newton's method inside a bracket [-].
   !> The phase is x + nu + arg((1 + p cos(x/gamma)) + i q sin(x/gamma)).
   pure real(wp) function phase_place(pulse, p, q, phase) result(x)
      type(pulse_t), intent(in) :: pulse
      real(wp), intent(in) :: p
      real(wp), intent(in) :: q
      real(wp), intent(in) :: phase
      !! [rad]
      integer, parameter :: most = 200
      type(bracket_t) :: bracket
      real(wp) :: re
      real(wp) :: im
      real(wp) :: excess
      real(wp) :: before
      integer :: i

      bracket = bracket_between(-pulse%half, pulse%half)
      x = 0
      do i = 1, most
         associate (u => x/pulse%gamma)
            re = 1 + p*cos(u)
            im = q*sin(u)
            excess = x + pulse%nu + atan2(im, re) - phase
            call narrow(bracket, excess > 0, x)
            before = x
            x = keep_inside(bracket, &
               x - excess/(1 + q*(cos(u) + p)/(pulse%gamma*(re**2 + im**2))))
         end associate
         if (abs(x - before) <= 2*epsilon(x)*max(1.0_wp, abs(x))) return
      end do
   end function phase_place

   !> Phase phi of the pulse C_n, after which the ground returns to its initial position [rad]. It
   !> solves (m - phi) tan(phi) = 1 with m = (n + 1/2) pi (Makris and Chang, EESD 29, 2000). The
   !> fixed-point iteration contracts by 1/(1 + (m - phi)**2) < 1/20.
   pure real(wp) function type_c_phase(n) result(phi)
      integer, intent(in) :: n
      !! >= 1
      integer, parameter :: most = 40
      !! 1/20**40 is below the round-off of any precision
      real(wp) :: m
      integer :: i

      m = (n + 0.5_wp)*pi
      phi = 0
      do i = 1, most
         phi = atan(1/(m - phi))
      end do
   end function type_c_phase

end module rwmf_motion_near_fault_pulse
