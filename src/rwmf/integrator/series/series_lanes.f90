!> Lanes of runs that advance by Taylor series: their state, coefficients, windows and records.
!>
!> The first index of every array is the lane. Flags are reals, 0 or 1, because logical variables
!> prevent vectorisation.
module rwmf_integrator_series_series_lanes
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: line_coefficients, rise_coefficients
   implicit none
   private

   public :: series_lanes_t, series_width, most_lines, &
      most_terms_of_series, left, right
   public :: demand_terms, axial_terms, motion_terms
   public :: of_sine_2, of_cosine_2, of_ground, of_upward, of_sine_1, of_cosine_1, of_sine, &
      of_cosine, of_phi_sine, of_phi_cosine, of_phi, of_rate, of_half_sine, of_half_cosine, &
      of_inverse, of_sine_over, of_cosine_over, of_constant

   integer, parameter :: series_width = 8
   !! number of lanes
   integer, parameter :: most_terms_of_series = 12
   !! highest order
   integer, parameter :: most_lines = 2
   !! number of straight tendons; beyond one, with the loop of the restraints
   integer, parameter :: left = 1
   !! index of values for theta < 0
   integer, parameter :: right = 2
   !! index of values for theta > 0

   integer, parameter :: of_sine_2 = 1, of_cosine_2 = 2, of_ground = 3, of_upward = 4
   !! terms of the demands: second derivatives of S = sin(phi) and K = 1 - cos(phi), accelerations
   !! of the ground
   integer, parameter :: of_sine_1 = 5, of_cosine_1 = 6, of_sine = 7, of_cosine = 8, &
      of_phi_sine = 9, of_phi_cosine = 10, of_phi = 11, of_rate = 12
   !! first derivatives of S and K, their values and products with phi, phi and phi'
   integer, parameter :: of_half_sine = 13, of_half_cosine = 14, of_inverse = 15, &
      of_sine_over = 16, of_cosine_over = 17, of_constant = 18
   !! sine and cosine of phi/2; 1, S and K over the length of a straight tendon [1/m]
   integer, parameter :: motion_terms = of_upward, axial_terms = of_phi, demand_terms = of_constant
   !! number of the terms of accelerations, of drifts and forces without devices and straight
   !! tendons, and of all terms

   !> Lanes that step together.
   type :: series_lanes_t
      ! time and ground motion
      real(wp) :: t(series_width)
      !! current time [s]
      real(wp) :: limit(series_width)
      !! end of the interval of the motion, or of the run [s]
      real(wp) :: length(series_width)
      !! length of a step that divides the interval into equal parts [s]
      real(wp) :: share(series_width)
      !! largest such length [s]
      real(wp) :: longest(series_width)
      !! longest step of the lane [s]
      real(wp) :: ground(series_width, 3)
      !! line of the ground acceleration: a_0 [m/s2], slope [m/s3], t_0 [s]
      real(wp) :: upward(series_width, 2)
      !! line of the vertical acceleration: a_0 [m/s2], slope [m/s3], the same t_0
      real(wp) :: curve(series_width, 2:most_terms_of_series, 2)
      !! horizontal and vertical acceleration less these lines, inside a pulse: coefficients over
      !! powers of the time since t_0 [m/s2/s**k]
      ! state
      real(wp) :: side(series_width)
      !! sign of theta: +1 or -1 [-]
      real(wp) :: phi(series_width)
      !! |theta| [rad]
      real(wp) :: rate(series_width)
      !! phi' [rad/s]
      real(wp) :: multiplicity(series_width)
      !! order of the root of phi - lower at the start of the step: 1 after an impact, 2 after a
      !! lift-off, 0 away from that bound [-]
      real(wp) :: above(series_width)
      !! order of the root of upper - phi at the start of the step, 0 away from that bound [-]
      ! coefficients of the equation of motion, per m_w R**2
      real(wp) :: inverse_radius(series_width)
      !! 1/R [1/m]
      real(wp) :: cosine(series_width)
      !! cos(alpha) [-]
      real(wp) :: sine_wall(series_width)
      !! sin(alpha), for gravity [-]
      real(wp) :: sine_link(series_width, 2)
      !! by side: sin(alpha), or 0 with the link above the pivot, for its displacement [-]
      real(wp) :: sine_lever(series_width, 2)
      !! by side: the same for the arm of its force [-]
      real(wp) :: inertia(series_width)
      !! inertia of the wall [-]
      real(wp) :: gravity(series_width)
      !! g/R [1/s2]
      real(wp) :: mass(series_width)
      !! gamma [-]
      real(wp) :: damping(series_width)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(series_width)
      !! slope of the frame's spring over m_s [1/s2]
      real(wp) :: offset(series_width)
      !! force of that spring at zero displacement, over m_s R [1/s2]
      real(wp) :: cable(series_width, 2)
      !! by side: moment of the cable at phi = 0 [1/s2]
      real(wp) :: cable_slope(series_width, 2)
      !! by side: its rate [1/(rad s2)]
      real(wp) :: fuse(series_width, 2)
      !! by side: moment of the fuses at zero stroke [1/s2]
      real(wp) :: fuse_slope(series_width, 2)
      !! by side: factor of sin(phi) in this moment [1/s2]
      real(wp) :: damper(series_width)
      !! half the coefficient of the corner damper [1/s]
      real(wp) :: inerter(series_width)
      !! half the coefficient of the corner inerter [-]
      real(wp) :: excited(series_width)
      !! mass of the frame excited by the ground motion over the moving mass [-]
      real(wp) :: straight(series_width, line_coefficients, 2, most_lines)
      !! straight tendons, by side: coefficients of `add_straight_tendons`
      real(wp) :: rise(series_width, rise_coefficients, 2)
      !! by side: factors of cos(phi), sin(phi), sin(2 phi), cos(2 phi) in the moment of restraints
      !! and couplings [1/s2]; then of phi', phi' cos(2 phi) and -phi' sin(2 phi) [1/s]
      logical :: has_rises = .false.
      logical :: has_fuses = .false.
      logical :: has_inerter = .false.
      logical :: has_second_cable = .false.
      !! it has two straight cables
      logical :: has_straight_cable = .false.
      logical :: has_curves = .false.
      !! the motion is a pulse
      logical :: is_plain = .true.
      !! none of the terms since `fuse`, no vertical motion and no pulse
      ! control of the step
      real(wp) :: rtol(series_width)
      !! requested relative tolerance [-]
      real(wp) :: least_size(series_width)
      !! part of the expected size of the rotation [rad]
      real(wp) :: allowance(series_width)
      !! part of the tolerance for the last term of a step [-]
      real(wp) :: frequency(series_width)
      !! frequency whose phase angle scales the tolerance of a step [rad/s]
      ! window and records
      real(wp) :: lower(series_width)
      !! lower end of the window of phi, 0 for the base [rad]
      real(wp) :: upper(series_width, 2)
      !! by side: upper end of the window of phi [rad]
      logical :: has_branches = .false.
      !! windows change during the runs
      real(wp) :: turn(series_width)
      !! sign that phi' keeps until the end of a branch; 0: either [-]
      real(wp) :: top(series_width, 2)
      !! by side: largest phi so far [rad]
      real(wp) :: t_top(series_width, 2)
      !! first time of this value [s]
      real(wp) :: fastest(series_width)
      !! largest |phi'| at the ends of steps [rad/s]
      real(wp) :: top_speed(series_width)
      !! largest |phi'| inside steps, if sought [rad/s]
      logical :: seeks_speed = .false.
      ! demands: sums of terms
      real(wp), allocatable :: rows(:, :, :, :)
      !! (lanes, terms, sides, demands) factors of the terms [unit of the demand over that of the
      !! term]; not allocated without demands
      real(wp), allocatable :: level(:, :)
      !! (lanes, demands) largest value so far [unit of the demand]
      real(wp), allocatable :: two_sided(:)
      !! (demands) 1 if the magnitude counts, 0 if only the value does [-]
      real(wp), allocatable :: exceeds(:, :)
      !! (lanes, demands) the present step may exceed the level [-]
      real(wp) :: base(series_width, 0:most_terms_of_series - 2, demand_terms - 1)
      !! series of the terms in the time over the length h [m/s2] for the ground, else [rad] and its
      !! rates
      integer :: terms = motion_terms
      !! number of the terms of all demands: `motion_terms`, `axial_terms` or `demand_terms` - 1
      ! impacts
      real(wp) :: factor(series_width)
      !! velocity factor e [-]
      real(wp) :: uplift(series_width, 2)
      !! by side: ground acceleration at uplift of the resting wall [m/s2]
      real(wp) :: weight_share(series_width)
      !! increase of `uplift` per vertical ground acceleration [-]
      real(wp) :: gain(series_width)
      !! angular acceleration per ground acceleration beyond it [1/m]
      real(wp) :: settled(series_width)
      !! part of the largest rotation below which chatter may be omitted [-]
      real(wp) :: negligible(series_width)
      !! part of the largest velocity below which a wall may rest [-]
      real(wp) :: impacts(series_width)
      !! number of impacts [-]
      real(wp) :: steps(series_width)
      !! number of steps [-]
      ! the present step
      real(wp) :: is_busy(series_width)
      !! the lane has a run in motion [-]
      real(wp) :: is_moving(series_width)
      !! the lane has a run in motion whose series converges in an eighth of its length [-]
      real(wp) :: p(series_width, 0:most_terms_of_series)
      !! series of phi in the time over the length h [rad]
      real(wp) :: h(series_width)
      !! length of the series [s]
      real(wp) :: x(series_width)
      !! end of the step over h [-]
      real(wp) :: x_most(series_width)
      !! end of the step without an event, over h [-]
      real(wp) :: phi_end(series_width)
      !! phi at the end of the step [rad]
      real(wp) :: rate_end(series_width)
      !! h phi' there [rad]
      real(wp) :: has_root(series_width)
      !! the step crosses the lower end of the window exactly once, and no other end or turn ends
      !! its branch [-]
      real(wp) :: is_open(series_width)
      !! a search must show whether phi leaves its window, or turns on a branch that ends there [-]
      real(wp) :: may_peak(series_width)
      !! phi may have a maximum above the largest one so far [-]
      real(wp) :: may_exceed(series_width)
      !! a demand may exceed its level [-]
      real(wp) :: may_race(series_width)
      !! |phi'| may have a maximum above the largest one so far [-]
      real(wp) :: needs_care(series_width)
      !! the step ends at an event that no loop applies [-]
      real(wp) :: is_at_limit(series_width)
      !! the step ends at the limit [-]
      ! of any lane
      logical :: some_root
      logical :: some_open
      logical :: some_peak
      logical :: some_speed
      logical :: some_demand = .false.
      logical :: some_short
      !! a series has to be shortened
      logical :: needs_some_care
   end type series_lanes_t

end module rwmf_integrator_series_series_lanes
