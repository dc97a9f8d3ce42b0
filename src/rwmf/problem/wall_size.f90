!> Size of a wall: its half diagonal, and the period 2 pi/p of a free-standing wall.
module rwmf_problem_wall_size
   use, intrinsic :: iso_fortran_env, only: real128
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: wall_t
   implicit none
   private

   public :: half_diagonal, block_period, scale_to_period

contains

   !> Half diagonal R of a wall [m].
   !>
   !> Computed in quadruple precision instead of by `hypot`, whose last digit depends on the C
   !> library. Its symbol also makes a wheel unusable on systems older than glibc 2.35.
   pure real(wp) function half_diagonal(h, b)
      real(wp), intent(in) :: h
      !! half height of the wall [m]
      real(wp), intent(in) :: b
      !! half width of the wall [m]

      half_diagonal = real(sqrt(real(h, real128)**2 + real(b, real128)**2), wp)
   end function half_diagonal

   !> Period 2 pi/p of a rectangular block, p = sqrt(3 g/(4 R)) [s]: the abscissa of rocking
   !> spectra.
   pure real(wp) function block_period(wall, g)
      type(wall_t), intent(in) :: wall
      real(wp), intent(in) :: g
      !! [m/s2]

      block_period = 2*pi*sqrt(4*half_diagonal(wall%h, wall%b)/(3*g))
   end function block_period

   !> Scale a block to a required 2 pi/p at constant slenderness. The block stays bitwise unchanged
   !> if it already has that period.
   pure subroutine scale_to_period(wall, g, T)
      type(wall_t), intent(inout) :: wall
      real(wp), intent(in) :: g
      !! [m/s2]
      real(wp), intent(in) :: T
      !! 2 pi/p [s]
      real(wp) :: factor

      factor = (T/block_period(wall, g))**2
      wall%h = factor*wall%h
      wall%b = factor*wall%b
   end subroutine scale_to_period

end module rwmf_problem_wall_size
