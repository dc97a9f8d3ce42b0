!> Rate of the hysteretic state of Bouc and Wen, z' = u'/u_y (1 - lost*power): the loop over lanes
!> that frame and storeys share.
!>
!> `lost` is the factor of |z|**n in the current piece of motion: 1 while |z| grows, 1 - 2 beta
!> while it decreases. Where z**n replaces |z|**n and n is odd, `lost` carries the sign of z.
module rwmf_model_hysteresis_bouc_wen_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count
   implicit none
   private

   public :: raise_state, hysteretic_rate

contains

   !> Rate of the hysteretic state [1/s].
   elemental real(wp) function hysteretic_rate(speed, lost, power) result(z_dot)
      real(wp), intent(in) :: speed
      !! velocity over the yield displacement [1/s]
      real(wp), intent(in) :: lost
      !! see above [-]
      real(wp), intent(in) :: power
      !! result of `raise_state` [-]

      z_dot = speed*(1 - lost*power)
   end function hysteretic_rate

   !> Compute z**n, or |z|**n if n is even or not a small natural number.
   !>
   !> Only trial states of a step and of the event search pass zero. A natural power continues
   !> smoothly there, so that no step contains a kink.
   pure subroutine raise_state(factors, exponent, z, power)
      integer, intent(in) :: factors
      !! n if it is a small natural number, so that the power is a product; else 0
      real(wp), intent(in) :: exponent(lane_count)
      !! n [-]
      real(wp), intent(in) :: z(lane_count)
      !! hysteretic state [-]
      real(wp), intent(out) :: power(lane_count)
      !! its power [-]
      real(wp), parameter :: largest_state = 1.26_wp
      !! bound of |z| of trial states, all of which are rejected; its power 1000 is finite [-]
      real(wp), parameter :: largest = 1.0e3_wp
      !! bound of such powers, which keeps the next trial state finite
      real(wp) :: factor(lane_count)
      integer :: i, n

      if (factors == 1) then
         power = z
      else if (factors > 1) then
         !$omp simd
         do i = 1, lane_count
            factor(i) = max(-largest_state, min(z(i), largest_state))
            power(i) = factor(i)*factor(i)
         end do
         do n = 3, factors
            !$omp simd
            do i = 1, lane_count
               power(i) = power(i)*factor(i)
            end do
         end do
      else
         ! libm's scalar power, lane by lane: the vectorised power differs in the last bits
         !GCC$ novector
         do i = 1, lane_count
            power(i) = min(min(abs(z(i)), largest_state)**exponent(i), largest)
         end do
      end if
   end subroutine raise_state

end module rwmf_model_hysteresis_bouc_wen_loop
