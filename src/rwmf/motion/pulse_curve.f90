!> Pulse of ground acceleration in numbers, derived from its kind, size and period, before it is
!> converted to a motion.
!>
!> With a vertical record a pulse needs further knots. The resting wall bears the horizontal motion
!> less a straight line, which turns where the slope of the pulse equals that of the line
!> (`steep_time`).
module rwmf_motion_pulse_curve
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_motion_record_lines, only: next_extremum
   use rwmf_motion_near_fault_pulse, only: add_sine, amplitude_of, angular_frequency, &
      build_pulse, cut_times, pulse_gain, pulse_series, pulse_shape, pulse_slope, pulse_t, &
      type_c_phase
   use rwmf_problem_case, only: motion_spec_t
   implicit none
   private

   public :: curve_t, build_curve, knots_with_bends, curve_value, curve_turn, curve_rate
   public :: steep_time, curve_gain, curve_series

   !> A pulse: amplitude*sin(omega*(t - t_0) + phase), or amplitude*pulse_shape(pulse, t).
   type :: curve_t
      logical :: is_harmonic = .true.
      real(wp) :: amplitude = 0
      !! amplitude with its sign [m/s2]
      real(wp) :: omega = 0
      !! [rad/s]
      real(wp) :: phase = 0
      !! [rad]
      real(wp) :: t_0 = 0
      !! beginning [s]
      type(pulse_t) :: pulse
      !! unused for a harmonic
      real(wp), allocatable :: knot(:)
      !! (knots) from the beginning to the end: a harmonic may turn in between, others are monotone
      !! [s]
      integer :: first = 0
      !! first knot of the pulse in a motion
      integer :: last = 0
      !! last knot of the pulse in a motion
   end type curve_t

contains

   !> Build the pulse of a case. The kinds are the one-sine pulse (16), the one-cosine pulse (17),
   !> several cycles of a sine, the pulse C_n, Ricker pulses, and that of Mavroeidis and
   !> Papageorgiou. C_n is a cosine of the phase phi that lasts until the ground returns to its
   !> initial position. The v_p of Mavroeidis and Papageorgiou is A, the amplitude of the velocity's
   !> envelope.
   !>
   !> Eq. (16) has the amplitude omega_p v_p/2, the cosines omega_p v_p.
   pure type(curve_t) function build_curve(spec, g) result(curve)
      type(motion_spec_t), intent(in) :: spec
      !! specification of a pulse
      real(wp), intent(in) :: g
      !! unit of `a_max_g` [m/s2]
      real(wp) :: cycles
      real(wp) :: velocity_factor

      curve%omega = angular_frequency(spec)
      curve%t_0 = spec%t_0
      cycles = spec%cycles
      velocity_factor = curve%omega
      select case (spec%kind)
      case ('ricker', 'ricker_antisymmetric', 'mavroeidis_papageorgiou')
         curve%is_harmonic = .false.
         curve%pulse = build_pulse(spec, curve%omega)
         curve%amplitude = amplitude_of(spec, g, curve%omega*curve%pulse%peak/2)
         curve%knot = cut_times(curve%pulse, has_bends=.false.)
         return
      case ('one_cosine')
         curve%phase = pi/2
      case ('type_c')
         curve%phase = pi/2 + type_c_phase(spec%n_pulses)
         cycles = spec%n_pulses + 0.5_wp - type_c_phase(spec%n_pulses)/pi
      case default
         velocity_factor = curve%omega/2
      end select
      curve%amplitude = amplitude_of(spec, g, velocity_factor)
      curve%knot = [spec%t_0, spec%t_0 + cycles*(2*pi/curve%omega)]
   end function build_curve

   !> Knots between which the slope of a pulse is monotone as well; for a harmonic its own knots
   !> [s].
   pure function knots_with_bends(curve) result(t)
      type(curve_t), intent(in) :: curve
      real(wp), allocatable :: t(:)
      !! (knots)

      t = curve%knot
      if (.not. curve%is_harmonic) t = cut_times(curve%pulse, has_bends=.true.)
   end function knots_with_bends

   !> Acceleration at a time between beginning and end [m/s2].
   pure real(wp) function curve_value(curve, t)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      !! [s]

      if (curve%is_harmonic) then
         curve_value = curve%amplitude*sin(curve%omega*(t - curve%t_0) + curve%phase)
      else
         curve_value = curve%amplitude*pulse_shape(curve%pulse, t)
      end if
   end function curve_value

   !> Taylor series of the acceleration at a time between beginning and end [m/s2/s**k].
   pure subroutine curve_series(curve, t, series)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: series(0:)
      !! (order) coefficients [m/s2] per power of s

      if (curve%is_harmonic) then
         series = 0
         call add_sine(curve%amplitude, curve%omega, curve%omega*(t - curve%t_0) + curve%phase, &
            series)
      else
         call pulse_series(curve%pulse, t, series)
         series = curve%amplitude*series
      end if
   end subroutine curve_series

   !> Rate of the acceleration at a time between beginning and end [m/s3].
   pure real(wp) function curve_slope(curve, t)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      !! [s]

      if (curve%is_harmonic) then
         curve_slope = curve%amplitude*curve%omega*cos(curve%omega*(t - curve%t_0) + curve%phase)
      else
         curve_slope = curve%amplitude*pulse_slope(curve%pulse, t)
      end if
   end function curve_slope

   !> Gain in velocity from the beginning to a time before the end [m/s].
   pure real(wp) function curve_gain(curve, t)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      !! [s]
      real(wp) :: half
      !! of the phase angle since the beginning [rad]

      if (curve%is_harmonic) then
         half = curve%omega*(t - curve%t_0)/2
         curve_gain = 2*curve%amplitude/curve%omega*sin(half)*sin(half + curve%phase)
      else
         curve_gain = curve%amplitude*pulse_gain(curve%pulse, t)
      end if
   end function curve_gain

   !> Rate of variation of a pulse, the fourth root of its largest fourth derivative over its peak
   !> [1/s].
   pure real(wp) function curve_rate(curve)
      type(curve_t), intent(in) :: curve

      curve_rate = curve%omega
      if (.not. curve%is_harmonic) curve_rate = curve%pulse%fastest
   end function curve_rate

   !> First time after t at which a harmonic is extremal; all other pulses are monotone between
   !> knots [s].
   pure real(wp) function curve_turn(curve, t)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      !! [s]

      curve_turn = huge(curve_turn)
      if (curve%is_harmonic) curve_turn = next_extremum(curve%omega, curve%phase, curve%t_0, t)
   end function curve_turn

   !> First time after t and before t_end at which the slope has a given magnitude; otherwise t_end
   !> [s].
   pure real(wp) function steep_time(curve, slope, t, t_end) result(time)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: slope
      !! > 0 [m/s3]
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: t_end
      !! with t between two knots of `knots_with_bends` [s]

      if (curve%is_harmonic) then
         time = min(steep_time_of_harmonic(curve, slope, t), t_end)
      else
         time = steep_time_of_pulse(curve, slope, t, t_end)
      end if
   end function steep_time

   !> First time after t at which the slope of a harmonic has a given magnitude [s]. There
   !> |cos(psi)| = slope/(amplitude*omega), where psi is k pi +- the arccosine of this ratio.
   pure real(wp) function steep_time_of_harmonic(curve, slope, t) result(time)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: slope
      real(wp), intent(in) :: t
      real(wp) :: half_turns
      !! integral
      real(wp) :: inside
      !! angle inside a quarter turn [rad]
      real(wp) :: candidate
      integer :: i

      time = huge(time)
      if (slope >= abs(curve%amplitude*curve%omega)) return
      inside = acos(slope/abs(curve%amplitude*curve%omega))
      half_turns = aint((curve%omega*(t - curve%t_0) + curve%phase)/pi)
      do i = 4, -4, -1
         candidate = curve%t_0 - curve%phase/curve%omega &
            + ((half_turns + i/2)*pi + merge(inside, -inside, modulo(i, 2) == 0))/curve%omega
         if (candidate > t) time = min(time, candidate)
      end do
   end function steep_time_of_harmonic

   !> Find `steep_time` of other pulses by bisection; their slope keeps its sign and is monotone.
   pure real(wp) function steep_time_of_pulse(curve, slope, t, t_end) result(time)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: slope
      real(wp), intent(in) :: t
      real(wp), intent(in) :: t_end
      type(bracket_t) :: bracket
      logical :: is_steep
      !! the slope at t_end exceeds the given magnitude

      time = t_end
      is_steep = abs(curve_slope(curve, t_end)) > slope
      if ((abs(curve_slope(curve, t)) > slope) .eqv. is_steep) return
      bracket = bracket_between(t, t_end)
      do while (bracket%is_open)
         call narrow(bracket, (abs(curve_slope(curve, bracket%middle)) > slope) .eqv. is_steep)
      end do
      time = bracket%high
   end function steep_time_of_pulse

end module rwmf_motion_pulse_curve
