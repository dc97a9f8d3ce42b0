!> One ordinate of a spectrum in lanes: its constants, and what it has met so far.
module rwmf_spectrum_fast_ordinate
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: ordinate_t

   !> The part of a lane that only events read and write.
   type :: ordinate_t
      integer :: task = 0
      !! its number in the list of tasks; 0: nobody is there
      integer :: law
      !! numbers of its law, its pair of mass ratio and width, its grid in the scope
      integer :: pair
      integer :: grid
      integer :: offset
      !! steps of other grids before those of its own
      integer :: quiet
      !! first step of its grid from which on the ground stands still
      integer :: stages
      !! evaluations of N in a flight that begins within a step
      real(wp) :: damping
      !! 2 xi_s omega_s [1/s]
      real(wp) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp) :: rtol
      !! requested relative tolerance [-]
      integer :: side = 1
      !! +1 or -1
      real(wp) :: v_max = 0
      !! [-]
      real(wp) :: w_max = 0
      !! largest rate at an impact [1/s]
      integer :: impacts = 0
      logical :: failed = .false.
      !! left to the general kernel
      integer :: number = 1
      !! of the step in its grid in which its next flight begins
      real(wp) :: x = 0
      !! where in the step that flight begins [-]
      real(wp) :: span = 1
      !! for how much of the step it is followed [-]
      real(wp) :: w = 0
      !! rate with which it begins [1/s]
   end type ordinate_t

end module rwmf_spectrum_fast_ordinate
