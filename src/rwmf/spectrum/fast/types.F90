!> Types of the vectorised loops: one array element per lane.
!>
!> A lane is the place in which an ordinate of a spectrum advances. Lanes that take a step together
!> form a block. Steps in which an event is possible leave the block and are followed in a batch of
!> substeps.
module rwmf_spectrum_fast_types
   use, intrinsic :: iso_fortran_env, only: real64, real128
   implicit none
   private

   public :: wp, frame_block_width, block_width, batch_width, degree, short_degree, curves, terms, &
      c_2, c_3, weights
   public :: lane_block_t, lane_constants_t, lane_ground_t, ground_step_t, reduced_equation_t, &
      substep_batch_t, scheme_t, trial_step_t

#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! as in `rwmf_core_kinds`; this module uses no other, so that the vectorised loops, which are
   !! compiled with flags of their own, need nothing else
   integer, parameter :: frame_block_width = 64
   !! bare frames that advance together, a multiple of `block_width`
   integer, parameter :: block_width = 16
   !! lanes of a block, twice the 8 numbers of the widest instructions: the latency of operations on
   !! one vector is hidden by those on the other
   integer, parameter :: batch_width = block_width
   !! substeps of a batch; states of both are `lane_state_t`
   integer, parameter :: degree = 6
   !! of the polynomials in v
   integer, parameter :: short_degree = 4
   !! of those that are accurate enough with it; the higher coefficients are zero then
   integer, parameter :: curves = 4
   !! Q, D1, D2, H
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
      real(wp) :: v(block_width)
      !! |u_s|/(2R) [-]
      real(wp) :: w(block_width)
      !! its rate [1/s]
      real(wp) :: n(block_width)
      !! N [1/s2]
      real(wp) :: n_rate(block_width)
      !! rate of N [1/s3]
      real(wp) :: v_d2(block_width)
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

   !> Ground motion in the step of each lane, as in `ground_step_t`.
   type :: lane_ground_t
      real(wp) :: f(block_width, 0:3)
      real(wp) :: jump(block_width)
      real(wp) :: kink(block_width)
   end type lane_ground_t

   !> Properties common to the steps of all lanes of a block.
   type :: scheme_t
      integer :: stages
      !! evaluations of N: 1, 2 or 3
      logical :: is_short
      !! the polynomials have `short_degree`
      logical :: is_straight
      !! the ground acceleration is linear in every step
      logical :: has_jumps
      !! the ground acceleration jumps later than at the beginning
   end type scheme_t

   !> Constants of the lanes within a step; those of the side change at impacts.
   type :: lane_constants_t
      real(wp) :: h(block_width)
      !! length of the step [s]
      real(wp) :: inverse_h(block_width)
      !! [1/s]
      real(wp) :: side(block_width)
      !! +1 or -1
      real(wp) :: m2(block_width)
      !! M2(0) [1/m]
      real(wp) :: m3(block_width)
      !! M3(0) [1/s2]
      real(wp) :: damping(block_width)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(block_width)
      !! omega_s**2 [1/s2]
      real(wp) :: damping_factor(block_width)
      !! part of an error that the damping leaves after the step [-]
      real(wp) :: coef(block_width, 0:degree, curves)
      !! polynomials of the side, as in `reduced_equation_t`
      real(wp) :: weight(block_width, weights)
      !! from `step_weights`
   end type lane_constants_t

   !> Lanes that step together, each at a time of its own.
   type :: lane_block_t
      type(lane_state_t) :: now
      real(wp) :: error_estimate(block_width)
      !! sum of the corrections of v' by the last evaluations of N, damped as the motion is [1/s]
      real(wp) :: ready(block_width)
      !! 1: steps with the block, 0: waits for an event to be followed, or is idle
      real(wp) :: v_max(block_width)
      !! largest v so far [-]
      real(wp) :: error_at_peak(block_width)
      !! `error_estimate` when `v_max` was reached [1/s]
      type(lane_constants_t) :: constants
      integer :: step(block_width)
      !! number of the step in the array of all grids; 1 for idle lanes
      integer :: length_change(block_width)
      !! the first step whose length differs from the present one, or beyond the last one
   end type lane_block_t

   !> One tentative step of a block. All blocks of a thread share one such work space, which stays
   !> in the innermost cache.
   type :: trial_step_t
      type(lane_state_t) :: next
      !! at the end of the step, if it has no event
      real(wp) :: w_correction(block_width)
      !! |change of v' by the last evaluation of N| [1/s]
      real(wp) :: event(block_width)
      !! 1: an event is possible in the step
      real(wp) :: difference(block_width, 0:3)
      !! divided differences of N on the nodes [1/s2]
      type(lane_ground_t) :: ground
      real(wp) :: n_jump(block_width)
      !! decrease of N by a jump of the ground acceleration [1/s2]
      real(wp) :: n_rate_jump(block_width)
      !! decrease of the rate of N by it [1/s3]
   end type trial_step_t

   !> Equation of motion for all periods of one mass ratio and one width, from
   !> `build_reduced_equation`.
   type :: reduced_equation_t
      real(wp) :: m1
      !! M1(0) [-]
      real(wp) :: m2
      !! M2(0) [1/m]
      real(wp) :: m3
      !! M3(0) [1/s2]
      real(wp) :: m3_1
      !! slope of M3 at 0, mean of both sides [1/s2]
      real(wp) :: coef(0:degree, curves, 2)
      !! coefficients of Q, D1, D2 [1/m], H [1/s2] in powers of v; theta > 0 and theta < 0
      logical :: is_short
      !! the polynomials have `short_degree`
      logical :: is_even
      !! both sides have the same polynomials
      real(wp) :: bound(curves)
      !! largest |Q|, |D1|, |D2|, |H| at v = 0 of both sides
      real(wp) :: threshold
      !! ground acceleration that lifts the resting wall [m/s2]
      real(wp) :: e
      !! velocity factor at impact [-]
      real(wp) :: length
      !! 2R [m]
      real(wp) :: v_high
      !! end of the fit [-]
      real(wp) :: fit_error
      !! largest error of the polynomials, relative to the acceleration that they contribute to [-]
   end type reduced_equation_t

   !> Substeps: steps in which an event is possible, or rests of steps after an impact or lift-off.
   type :: substep_batch_t
      real(wp) :: h_step(batch_width)
      !! length of the whole step [s]
      real(wp) :: f(batch_width, 0:3)
      !! ground motion in the whole step, as in `ground_step_t`
      real(wp) :: x(batch_width)
      !! position of the beginning in the step [-]
      real(wp) :: span(batch_width)
      !! length of the substep over that of the step [-]
      real(wp) :: v(batch_width)
      !! v at the beginning [-]
      real(wp) :: w(batch_width)
      !! rate of v at the beginning [1/s]
      real(wp) :: side(batch_width)
      !! +1 or -1
      real(wp) :: damping(batch_width)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(batch_width)
      !! omega_s**2 [1/s2]
      real(wp) :: m1(batch_width)
      !! M1(0) [-]
      real(wp) :: m2(batch_width)
      !! M2(0) [1/m]
      real(wp) :: m3(batch_width)
      !! M3(0) [1/s2]
      real(wp) :: m3_1(batch_width)
      !! slope of M3 at 0 [1/s2]
      real(wp) :: coef(batch_width, 0:degree, curves)
      !! polynomials of the side; used by substeps that start on the base
      real(wp) :: threshold(batch_width)
      !! ground acceleration that lifts the resting wall [m/s2]
      real(wp) :: e(batch_width)
      !! velocity factor at impact [-]
      real(wp) :: w_begin(batch_width)
      !! rate of v with which the flight began that ends in the step [1/s]
      real(wp) :: negligible_velocity(batch_width)
      !! rate of v below which the wall may be put to rest [1/s]
      real(wp) :: v_max(batch_width)
      !! largest v so far [-]
      real(wp) :: negligible_change(batch_width)
      !! change of v by N that is left out [-]
      real(wp) :: stages(batch_width)
      !! evaluations of N: 1, 2 or 3
      real(wp) :: difference(batch_width, 0:3)
      !! divided differences of N [1/s2]
      real(wp) :: h(batch_width)
      !! length of the substep [s]
      real(wp) :: p(batch_width, 0:terms + 1)
      !! v in powers of the position y in the substep; the last coefficient is zero, so that v/y is
      !! p(:, 1:)
      type(lane_state_t) :: end_state
      !! at the end of the substep, if it has no impact
      real(wp) :: y(batch_width)
      !! position of the first impact in the substep, 1 without one [-]
      real(wp) :: has_impact(batch_width)
      !! 1 with an impact, 0 without
      real(wp) :: w_impact(batch_width)
      !! rate of v at y, per substep [-]
      real(wp) :: x_impact(batch_width)
      !! position of the impact in the step [-]
      real(wp) :: impact_speed(batch_width)
      !! rate towards the base at the impact [1/s]
      real(wp) :: f_impact(batch_width)
      !! ground acceleration at the impact [m/s2]
      real(wp) :: peak(batch_width)
      !! largest v before y, where it can be a new maximum, otherwise 0 [-]
      real(wp) :: needs_search(batch_width)
      !! 1: left to the scalar search of `rwmf_spectrum_fast_scalar_events`
      real(wp) :: may_rest(batch_width)
      !! 1: slower than the flight before, and pressed down at the impact
      integer :: slot(batch_width)
      !! slot of the lane in the pool; 0: the place is free
      integer :: equation(batch_width)
      !! number of the equation whose constants are entered; 0: none
      integer :: polynomial(batch_width)
      !! polynomials in `coef`: number of the equation, negative for theta < 0; 0: none
      integer :: n_steps
      !! number of whole steps entered, at the first places
      integer :: n_filled
      !! last place that has been used; those beyond are clear
   end type substep_batch_t

end module rwmf_spectrum_fast_types
