!> One ordinate of a spectrum in a lane: its constants and its history.
module rwmf_spectrum_fast_ordinate
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: ordinate_t

   !> The state of a lane that changes only with events.
   type :: ordinate_t
      integer :: task = 0
      !! number of the task; 0: the lane is idle
      integer :: equation
      !! number of the reduced equation
      integer :: pair
      !! number of the pair of mass ratio and width
      integer :: grid
      !! number of the time grid
      integer :: offset
      !! steps of other grids before those of this grid
      integer :: motion_end_step
      !! first step of the grid from which on the ground stands still
      integer :: stages
      !! evaluations of N in a substep
      real(wp) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: side = 1
      !! sign of theta of the current or next flight, +1 or -1
      real(wp) :: v_max = 0
      !! largest v so far [-]
      real(wp) :: w_max = 0
      !! largest rate at an impact [1/s]
      integer :: impacts = 0
      logical :: failed = .false.
      !! left to the general kernel
      integer :: step = 1
      !! number of the step in the grid in which the next flight begins
      real(wp) :: x = 0
      !! position in the step where that flight begins [-]
      real(wp) :: span = 1
      !! length of its substep over that of the step [-]
      real(wp) :: w = 0
      !! rate of v with which it begins [1/s]
   end type ordinate_t

end module rwmf_spectrum_fast_ordinate
