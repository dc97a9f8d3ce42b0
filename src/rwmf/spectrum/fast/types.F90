!> Work space of ordinates that advance together: one array element per lane.
module rwmf_spectrum_fast_types
   use, intrinsic :: iso_fortran_env, only: real64, real128
   implicit none
   private

   public :: wp, lanes, seats, width, degree, short_degree, curves, terms, c_2, c_3, weights
   public :: team_t, lane_rate_t, lane_ground_t, step_t, fast_law_t, flights_t, &
      scheme_t, tried_step_t

#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! as in rwmf_kinds; this module uses no other, so that the vectorised loops, which are compiled
   !! with flags of their own, need nothing else
   integer, parameter :: lanes = 64
   !! bare frames that advance together, a multiple of `width`
   integer, parameter :: seats = 16
   !! ordinates of a team, a multiple of the 8 that the widest instructions hold: while one vector
   !! waits for its results another one is worked on
   integer, parameter :: width = 16
   !! flights of a row, likewise
   integer, parameter :: degree = 6
   !! of the polynomials in v
   integer, parameter :: short_degree = 4
   !! of those where it does: the other coefficients are zero then
   integer, parameter :: curves = 4
   !! Q, D1, D2, H
   integer, parameter :: terms = 12
   !! highest power of a Taylor series: with an angle of 0.7 in a step the next one is 1e-12
   integer, parameter :: weights = 36
   !! of a lane: for each of the nodes c2, c3, 1 (1/2 in place of c3 with two evaluations) what v0,
   !! v0', and the four modes of the forcing contribute to v and to v'
   real(wp), parameter :: c_2 = 0.276393202250021030359_wp
   !! (1 - 1/sqrt(5))/2
   real(wp), parameter :: c_3 = 1 - c_2

   !> What the lanes carry from step to step.
   type :: lane_state_t
      real(wp) :: v(seats)
      !! |u_s|/(2R) [-]
      real(wp) :: w(seats)
      !! its rate [1/s]
      real(wp) :: n(seats)
      !! N [1/s2]
      real(wp) :: s(seats)
      !! rate of N [1/s3]
      real(wp) :: drive(seats)
      !! v D2: what the ground acceleration contributes to -N [1/m]
      real(wp) :: doubt(seats)
      !! what the last evaluation of N changed in the rate; as `now`: summed up and damped [1/s]
   end type lane_state_t

   !> Ground motion in one step.
   type :: step_t
      real(wp) :: h
      !! [s]
      real(wp) :: f(0:3)
      !! divided differences on the nodes: coefficients of 1, x, x (x - c2), x (x - c2)(x - c3)
      !! [m/s2]
      real(wp) :: jump
      !! of the acceleration at the beginning [m/s2]
      real(wp) :: kink
      !! of its rate at the beginning [m/s3]
      integer :: alike
      !! steps from here on, itself included, that have the same length
   end type step_t

   !> Ground motion in the step of each lane, as in `step_t`.
   type :: lane_ground_t
      real(wp) :: f(seats, 0:3)
      real(wp) :: jump(seats)
      real(wp) :: kink(seats)
   end type lane_ground_t

   !> What the steps of all lanes of a team have in common.
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

   !> Constants of the lanes; those of the side change at impacts.
   type :: lane_rate_t
      real(wp) :: h(seats)
      !! length of the step [s]
      real(wp) :: per_h(seats)
      !! [1/s]
      real(wp) :: side(seats)
      !! +1 or -1
      real(wp) :: m2(seats)
      !! M2(0) [1/m]
      real(wp) :: m3(seats)
      !! M3(0) [1/s2]
      real(wp) :: damping(seats)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(seats)
      !! omega_s**2 [1/s2]
      real(wp) :: keep(seats)
      !! what the damping leaves of an error after the step [-]
      real(wp) :: coef(seats, 0:degree, curves)
      !! polynomials of the side
      real(wp) :: weight(seats, weights)
   end type lane_rate_t

   !> Ordinates that step together, each in a step of its own.
   type :: team_t
      type(lane_state_t) :: now
      real(wp) :: ready(seats)
      !! 1: steps with the team, 0: waits until an event is followed, or nobody is there
      real(wp) :: v_max(seats)
      !! [-]
      real(wp) :: worst(seats)
      !! doubt when `v_max` was reached [1/s]
      type(lane_rate_t) :: rate
      integer :: at(seats)
      !! number of the step; 1 where nobody is
      integer :: stop(seats)
      !! the first step that is not of the present length, or beyond the last one
   end type team_t

   !> One step of a team. All teams use the same one in turn, which stays in the innermost cache.
   type :: tried_step_t
      type(lane_state_t) :: next
      !! as if nothing happened in the step
      real(wp) :: event(seats)
      !! 1: something may happen in the step
      real(wp) :: difference(seats, 0:3)
      !! divided differences of N on the nodes [1/s2]
      type(lane_ground_t) :: ground
      real(wp) :: n_jump(seats)
      !! what a jump of the ground acceleration takes off N [1/s2]
      real(wp) :: s_jump(seats)
      !! and off its rate [1/s3]
   end type tried_step_t

   !> What all periods of one mass ratio and one width share; `rwmf_spectrum_fast_reduced_equation`
   !> makes it.
   type :: fast_law_t
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
   end type fast_law_t

   !> States at the ends of flights; see `lane_state_t`.
   type :: landing_t
      real(wp) :: v(width)
      real(wp) :: w(width)
      real(wp) :: n(width)
      real(wp) :: s(width)
      real(wp) :: drive(width)
   end type landing_t

   !> Parts of a step, of a row of lanes in which something happens.
   type :: flights_t
      real(wp) :: step(width)
      !! length of the whole step [s]
      real(wp) :: f(width, 0:3)
      !! ground motion in the whole step, as in `step_t`
      real(wp) :: x(width)
      !! beginning: position in the step [-]
      real(wp) :: span(width)
      !! length over that of the step [-]
      real(wp) :: v(width)
      !! at the beginning [-]
      real(wp) :: w(width)
      !! [1/s]
      real(wp) :: side(width)
      !! +1 or -1
      real(wp) :: damping(width)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(width)
      !! omega_s**2 [1/s2]
      real(wp) :: m1(width)
      !! M1(0) [-]
      real(wp) :: m2(width)
      !! M2(0) [1/m]
      real(wp) :: m3(width)
      !! M3(0) [1/s2]
      real(wp) :: m3_1(width)
      !! slope of M3 at 0 [1/s2]
      real(wp) :: coef(width, 0:degree, curves)
      !! polynomials of the side; for flights that start on the base
      real(wp) :: threshold(width)
      !! ground acceleration that lifts the resting wall [m/s2]
      real(wp) :: e(width)
      !! velocity factor at impact [-]
      real(wp) :: w_begin(width)
      !! rate with which a flight began that ends in the step [1/s]
      real(wp) :: idle(width)
      !! rate that may be dropped [1/s]
      real(wp) :: v_max(width)
      !! so far [-]
      real(wp) :: small(width)
      !! negligible change of v by N [-]
      real(wp) :: stages(width)
      !! evaluations of N: 1, 2 or 3
      real(wp) :: n_0(width, 0:3)
      !! divided differences of N [1/s2]
      real(wp) :: h(width)
      !! length [s]
      real(wp) :: p(width, 0:terms + 1)
      !! v in powers of the position y in the part; the last one is zero, so that v/y is p(:, 1:)
      type(landing_t) :: finish
      !! at the end of the part, as if nothing happened
      real(wp) :: y(width)
      !! first impact, 1 without one [-]
      real(wp) :: hits(width)
      !! 1 with an impact, 0 without
      real(wp) :: w_hit(width)
      !! rate at y [1/s]
      real(wp) :: x_hit(width)
      !! the impact: position in the step [-]
      real(wp) :: speed(width)
      !! there towards the base [1/s]
      real(wp) :: f_hit(width)
      !! ground acceleration there [m/s2]
      real(wp) :: peak(width)
      !! largest v before y, where it can be a new maximum, otherwise 0 [-]
      real(wp) :: is_odd(width)
      !! 1: not such a plain flight; `rwmf_spectrum_fast_scalar_events` looks again
      real(wp) :: may_rest(width)
      !! 1: slower than before, and pressed down at the impact
      integer :: slot(width)
      !! whose flights they are; 0: nobody's
      integer :: law(width)
      !! whose constants are entered; 0: none's
      integer :: curve(width)
      !! whose polynomials are in `coef`: number of the law, negative for theta < 0; 0: none
      integer :: used
      !! how many whole steps have been entered, one after the other
      integer :: filled
      !! places from the first one to the last one that has been anybody's; beyond they are empty
   end type flights_t

end module rwmf_spectrum_fast_types
