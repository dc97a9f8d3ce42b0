!> Working precision of the kernel and the mathematical constants in it.
!>
!> The kernel is compiled twice: in double precision for work, and with `RWMF_QUAD` defined in
!> quadruple precision as the reference that the errors of the methods are measured against.
module rwmf_core_kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64, real128
   implicit none
   private

   public :: wp, dp, i8, pi

   integer, parameter :: dp = real64
   !! double precision, the kind of files and interfaces
   integer, parameter :: i8 = int64
   !! kind of counters: a chatter of 1e6 impacts has more than 2**31 right-hand sides
#ifdef RWMF_QUAD
   integer, parameter :: wp = real128
#else
   integer, parameter :: wp = real64
#endif
   !! working precision of the kernel
   real(wp), parameter :: pi = acos(-1.0_wp)
   !! [-]

end module rwmf_core_kinds
