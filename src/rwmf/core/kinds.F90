!> Working precision of the kernel and the mathematical constants in it.
!>
!> The kernel is compiled in double precision for normal use. With `RWMF_QUAD` defined it is
!> compiled in quadruple precision, the reference for the errors of the methods.
module rwmf_core_kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64, real128
   implicit none
   private

   public :: wp, dp, i8, pi

   integer, parameter :: dp = real64
   !! double precision, the kind of files and interfaces
   integer, parameter :: i8 = int64
   !! kind of counters: a run with 1e6 impacts has more than 2**31 evaluations of the right-hand
   !! side
#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! working precision of the kernel
   real(wp), parameter :: pi = acos(-1.0_wp)
   !! [-]

end module rwmf_core_kinds
