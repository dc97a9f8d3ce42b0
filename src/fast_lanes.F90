!> Work space of ordinates that advance together: one array element per lane.
module rwmf_fast_lanes
   use, intrinsic :: iso_fortran_env, only: real64, real128
   implicit none
   private

   public :: wp, lanes, width, degree, curves, terms, c_2, c_3, weights
   public :: lane_state_t, lane_rate_t, step_t, fast_law_t, flights_t

#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! as in rwmf_kinds; this module uses no other, so that the vectorised loops, which are compiled
   !! with flags of their own, need nothing else
   integer, parameter :: lanes = 64
   !! ordinates that advance together, a multiple of `width`
   integer, parameter :: width = 8
   !! flights are padded to a multiple of this: the widest instructions hold so many
   integer, parameter :: degree = 6
   !! of the polynomials in v
   integer, parameter :: curves = 4
   !! Q, D1, D2, H
   integer, parameter :: terms = 12
   !! highest power of a Taylor series: with an angle of 0.7 in a step the next one is 1e-12
   integer, parameter :: weights = 36
   !! of a lane: for each of the nodes c2, c3, 1 what v0, v0', and the four modes of the forcing
   !! contribute to v and to v'
   real(wp), parameter :: c_2 = 0.276393202250021030359_wp
   !! (1 - 1/sqrt(5))/2
   real(wp), parameter :: c_3 = 1 - c_2

   !> What the lanes carry from step to step.
   type :: lane_state_t
      real(wp) :: v(lanes)
      !! |u_s|/(2R) [-]
      real(wp) :: w(lanes)
      !! its rate [1/s]
      real(wp) :: n(lanes)
      !! N [1/s2]
      real(wp) :: s(lanes)
      !! rate of N [1/s3]
      real(wp) :: drive(lanes)
      !! v D2: what the ground acceleration contributes to -N [1/m]
      real(wp) :: doubt(lanes)
      !! what the last evaluation of N changed in the rate; as `now`: summed up and damped [1/s]
   end type lane_state_t

   !> Constants of the lanes; those of the side change at impacts.
   type :: lane_rate_t
      real(wp) :: side(lanes)
      !! +1 or -1
      real(wp) :: m2(lanes)
      !! M2(0) [1/m]
      real(wp) :: m3(lanes)
      !! M3(0) [1/s2]
      real(wp) :: damping(lanes)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(lanes)
      !! omega_s**2 [1/s2]
      real(wp) :: coef(lanes, 0:degree, curves)
      !! polynomials of the side
      real(wp) :: weight(lanes, weights)
      real(wp) :: keep(lanes)
      !! what the damping leaves of an error after the step [-]
   end type lane_rate_t

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
   end type step_t

   !> What all periods of one mass ratio and one width share; `rwmf_fast_law` makes it.
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

   !> Parts of a step, one of each lane in which something happens.
   type :: flights_t
      integer :: used
      integer :: n
      !! `used` padded to a multiple of `width` with copies of the first
      integer :: lane(lanes)
      real(wp) :: x(lanes)
      !! beginning: position in the step [-]
      real(wp) :: span(lanes)
      !! length over that of the step [-]
      real(wp) :: v(lanes)
      !! at the beginning [-]
      real(wp) :: w(lanes)
      !! [1/s]
      real(wp) :: side(lanes)
      !! +1 or -1
      real(wp) :: damping(lanes)
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness(lanes)
      !! omega_s**2 [1/s2]
      real(wp) :: v_max(lanes)
      !! so far [-]
      real(wp) :: small(lanes)
      !! negligible change of v by N [-]
      real(wp) :: n_0(lanes, 0:3)
      !! divided differences of N [1/s2]
      real(wp) :: h(lanes)
      !! length [s]
      real(wp) :: p(lanes, 0:terms + 1)
      !! v in powers of the position y in the part; the last one is zero, so that v/y is p(:, 1:)
      type(lane_state_t) :: finish
      !! at the end of the part, as if nothing happened
      real(wp) :: y(lanes)
      !! first impact, 1 without one [-]
      real(wp) :: hits(lanes)
      !! 1 with an impact, 0 without
      real(wp) :: w_hit(lanes)
      !! rate at y [1/s]
      real(wp) :: peak(lanes)
      !! largest v before y, where it can be a new maximum, otherwise 0 [-]
      real(wp) :: is_odd(lanes)
      !! 1: not such a plain flight; `rwmf_fast_flight` looks again
   end type flights_t

end module rwmf_fast_lanes
