!> Work space of ordinates that advance together: one array element per lane.
module rwmf_fast_lanes
   use, intrinsic :: iso_fortran_env, only: real64, real128
   implicit none
   private

   public :: wp, lanes, degree, c_2, c_3, weights, lane_state_t, lane_rate_t, step_t

#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! as in rwmf_kinds; this module uses no other, so that the vectorised loops, which are compiled
   !! with flags of their own, need nothing else
   integer, parameter :: lanes = 32
   !! ordinates that advance together
   integer, parameter :: degree = 6
   !! of the polynomials in v
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
      real(wp) :: coef(lanes, 0:degree, 4)
      !! polynomials of the side
      real(wp) :: weight(lanes, weights)
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

end module rwmf_fast_lanes
