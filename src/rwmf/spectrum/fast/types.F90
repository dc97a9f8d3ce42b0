!> Types of the vectorised loops: one array element per lane.
!>
!> A lane is the place in which an ordinate of a spectrum advances. The lanes of a team take their
!> steps together; a lane in whose step an event is possible waits until such steps are followed,
!> in parts that are called substeps.
module rwmf_spectrum_fast_types
   use, intrinsic :: iso_fortran_env, only: real64, real128
   implicit none
   private

   public :: wp, lanes, degree, curves, terms, c_2, c_3, weights
   public :: ground_step_t, lane_state_t, reduced_equation_t, scheme_t, team_t

#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! as in `rwmf_core_kinds`; this module uses no other, so that the vectorised loops, which are
   !! compiled with flags of their own, need nothing else
   integer, parameter :: lanes = 16
   !! of a team, twice the 8 numbers of the widest instructions: the latency of operations on one
   !! vector is hidden by those on the other
   integer, parameter :: degree = 6
   !! of the polynomials in v
   integer, parameter :: curves = 5
   !! Q, D1, D2, H, D4
   integer, parameter :: terms = 12
   !! highest power of a Taylor series: with an angle of 0.7 in a step the next one is 1e-12
   integer, parameter :: weights = 36
   !! of a lane: for each of the nodes c2, c3, 1 (1/2 in place of c3 with two evaluations) the
   !! contributions of v0, v0' and the four modes of the forcing to v and to v'
   real(wp), parameter :: c_2 = 0.276393202250021030359_wp
   !! (1 - 1/sqrt(5))/2
   real(wp), parameter :: c_3 = 1 - c_2

   !> State of the lanes.
   type :: lane_state_t
      real(wp) :: v(lanes) = 0
      !! |u_s|/(2R) [-]
      real(wp) :: w(lanes) = 0
      !! its rate [1/s]
      real(wp) :: n(lanes) = 0
      !! N [1/s2]
      real(wp) :: n_rate(lanes) = 0
      !! rate of N [1/s3]
      real(wp) :: v_d2(lanes) = 0
      !! v D2, factor of the ground acceleration in -N [1/m]
   end type lane_state_t

   !> Ground motion in one step.
   type :: ground_step_t
      real(wp) :: h
      !! [s]
      real(wp) :: f(0:3)
      !! divided differences on the nodes: coefficients of 1, x, x (x - c2), x (x - c2)(x - c3)
      !! of the acceleration [m/s2]
      real(wp) :: jump
      !! of the acceleration at the beginning [m/s2]
      real(wp) :: kink
      !! of its rate at the beginning [m/s3]
      integer :: equal_steps
      !! number of consecutive steps of this length, from this one on
   end type ground_step_t

   !> Properties common to the steps of all lanes of a team.
   type :: scheme_t
      integer :: stages = 3
      !! evaluations of N: 1, 2 or 3
      logical :: is_short = .false.
      !! no polynomial is of higher degree than 4
      logical :: is_damped = .false.
      !! there is D4
      logical :: is_straight = .true.
      !! the ground acceleration is linear in every step
      logical :: has_jumps = .false.
      !! the ground acceleration jumps later than at the beginning
   end type scheme_t

   !> Equation of motion for all periods of one mass ratio and one width, and the state that it
   !> starts with, from `build_reduced_equation`. Sides: theta > 0, theta < 0.
   type :: reduced_equation_t
      real(wp) :: m1 = 1
      !! M1(0) [-]
      real(wp) :: m2(2) = 1
      !! M2(0) of both sides [1/m]
      real(wp) :: m3 = 0
      !! M3(0) [1/s2]
      real(wp) :: m3_1 = 0
      !! slope of M3 at 0, mean of both sides [1/s2]
      real(wp) :: m4 = 0
      !! M4(0) [1/s]
      real(wp) :: coef(0:degree, curves, 2) = 0
      !! coefficients of Q, D1, D2 [1/m], H [1/s2], D4 [1/s] in powers of v
      logical :: is_short = .false.
      !! the highest two are zero
      logical :: is_even = .true.
      !! both sides have the same polynomials
      real(wp) :: bound(curves) = 0
      !! largest |Q| [-], |D1| [-], |D2| [1/m], |H| [1/s2], |D4| [1/s] at v = 0 of both sides
      real(wp) :: threshold(2) = 0
      !! ground acceleration that lifts the resting wall towards either side, without sign [m/s2]
      real(wp) :: e = 1
      !! velocity factor at impact [-]
      real(wp) :: start_v = 0
      !! v at the beginning [-]
      real(wp) :: start_w = 0
      !! its rate [1/s]
      integer :: start_side = 1
      !! +1 or -1
      real(wp) :: length = 1
      !! 2R [m]
      real(wp) :: v_high = huge(1.0_wp)
      !! end of the fit [-]
      real(wp) :: fit_error = 0
      !! largest error of the polynomials, relative to the acceleration that they contribute to [-]
   end type reduced_equation_t

   !> Lanes that step together, each at a time of its own.
   type :: team_t
      type(lane_state_t) :: now
      !! at the beginning of the step or substep
      type(lane_state_t) :: next
      !! at its end, if it has no event
      real(wp) :: difference(lanes, 0:3) = 0
      !! divided differences of N on the nodes [1/s2]
      real(wp) :: slope(lanes) = 0
      !! rate of N at the beginning, times the length of the step [1/s2]
      real(wp) :: f(lanes, 0:3) = 0
      !! ground motion in the whole step, as in `ground_step_t` [m/s2]
      real(wp) :: jump(lanes) = 0
      !! of the ground acceleration at the beginning of the step [m/s2]
      real(wp) :: kink(lanes) = 0
      !! of its rate there [m/s3]
      real(wp) :: n_jump(lanes) = 0
      !! decrease of N by a jump of the ground acceleration [1/s2]
      real(wp) :: n_rate_jump(lanes) = 0
      !! decrease of the rate of N by it [1/s3]
      real(wp) :: w_correction(lanes) = 0
      !! |change of v' by the last evaluation of N| [1/s]
      real(wp) :: ready(lanes) = 0
      !! 1 where it steps with the team, 0 where it waits for an event to be followed, or is idle
      real(wp) :: v_max(lanes) = 0
      !! largest v so far [-]
      real(wp) :: error_estimate(lanes) = 0
      !! sum of the corrections of v' by the last evaluations of N, damped as the motion is [1/s]
      real(wp) :: error_at_peak(lanes) = 0
      !! `error_estimate` when `v_max` was reached [1/s]
      integer :: step(lanes) = 1
      !! number of the step in the array of all grids; 1 for idle lanes
      integer :: length_change(lanes) = huge(1)
      !! the first step whose length differs from the present one, or beyond the last one

      ! constants of the ordinate; those of the side change at impacts
      real(wp) :: h(lanes) = 1
      !! length of the whole step [s]
      real(wp) :: inverse_h(lanes) = 1
      !! [1/s]
      real(wp) :: side(lanes) = 1
      !! +1 or -1
      real(wp) :: m1(lanes) = 1
      !! M1(0) [-]
      real(wp) :: m2(lanes) = 1
      !! M2(0) of the side [1/m]
      real(wp) :: m3(lanes) = 1
      !! M3(0) [1/s2]
      real(wp) :: linear_damping(lanes) = 0
      !! factor of v' in the linear equation [1/s]
      real(wp) :: linear_stiffness(lanes) = 0
      !! factor of v in it [1/s2]
      real(wp) :: damping(lanes) = 0
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(lanes) = 0
      !! omega_s**2 [1/s2]
      real(wp) :: damping_factor(lanes) = 1
      !! part of an error that the damping leaves after the step [-]
      real(wp) :: coef(lanes, 0:degree, curves) = 0
      !! polynomials of the side: coefficients as in `reduced_equation_t`
      real(wp) :: weight(lanes, weights) = 0
      !! from `step_weights`, each in its unit
      real(wp) :: e(lanes) = 1
      !! velocity factor at impact [-]
      real(wp) :: stages(lanes) = 1
      !! number of evaluations of N in a substep, 1, 2 or 3 [-]
      real(wp) :: least_threshold(lanes) = 1
      !! smaller one of those of both sides [m/s2]

      ! substeps
      real(wp) :: waits(lanes) = 0
      !! 1 where the lane has a step with an event, or a substep, that is to be followed
      real(wp) :: is_substep(lanes) = 0
      !! 1 where it is a substep, which is still to be integrated
      real(wp) :: is_followed(lanes) = 0
      !! 1 where it is in the present turn of following
      real(wp) :: x(lanes) = 0
      !! position of its beginning in the step [-]
      real(wp) :: span(lanes) = 1
      !! its length over that of the step [-]
      real(wp) :: h_part(lanes) = 1
      !! its length [s]
      real(wp) :: p(lanes, 0:terms + 1) = 0
      !! v in powers of the position y in it; the last coefficient is zero, so that v/y is p(:, 1:)
      !! [-]
      real(wp) :: y(lanes) = 1
      !! position of the first impact in it, 1 without one [-]
      real(wp) :: has_impact(lanes) = 0
      !! 1 where there is an impact in it, 0 where not
      real(wp) :: w_impact(lanes) = 0
      !! rate of v at y, per substep [-]
      real(wp) :: x_impact(lanes) = 0
      !! position of the impact in the step [-]
      real(wp) :: impact_speed(lanes) = 0
      !! rate towards the base at the impact [1/s]
      real(wp) :: f_impact(lanes) = 0
      !! ground acceleration at the impact [m/s2]
      real(wp) :: peak(lanes) = 0
      !! largest v before y, where it can be a new maximum, otherwise 0 [-]
      real(wp) :: is_ambiguous(lanes) = 0
      !! 1 where more events are possible than one impact and one peak: to be halved
      real(wp) :: w_begin(lanes) = 0
      !! rate of v with which the flight began that ends in the step [1/s]
      real(wp) :: may_rest(lanes) = 0
      !! 1 where it is slower than the flight before, and pressed down at the impact
      real(wp) :: negligible_velocity(lanes) = 0
      !! rate of v below which the wall may be put to rest [1/s]
      real(wp) :: negligible_change = 0
      !! change of v by N that is left out, over the largest v [-]
   end type team_t

end module rwmf_spectrum_fast_types
