!> One ordinate of a spectrum in lanes: its constants, and what it has met so far.
module rwmf_fast_ordinate
   use rwmf_kinds, only: wp
   implicit none
   private

   public :: ordinate_t

   !> The part of a lane that only events read and write.
   type :: ordinate_t
      real(wp) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: side
      !! +1 or -1
      real(wp) :: v_max
      !! [-]
      real(wp) :: w_max
      !! largest rate at an impact [1/s]
      integer :: impacts
      logical :: rests
      integer :: wake_step
      !! number of the step in which it lifts off; beyond the last one: never
      real(wp) :: wake_x
      !! where it lifts off [-]
      integer :: wake_side
      logical :: failed
      !! left to the general kernel
   end type ordinate_t

end module rwmf_fast_ordinate
