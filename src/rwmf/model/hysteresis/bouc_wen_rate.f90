!> Rate of the hysteretic state of Bouc and Wen, z' = u'/u_y (1 - lost*power): the loop over lanes
!> that frame and storeys share.
!>
!> `lost` is the part of |z|**n that is lost in the piece of motion in force: 1 while |z| grows,
!> 1 - 2 beta while it falls; with the sign of z where z**n takes the place of |z|**n and n is odd.
module rwmf_model_hysteresis_bouc_wen_rate
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count
   implicit none
   private

   public :: raise_state

contains

   !> z**n, or |z|**n where n is even or no small natural number.
   !>
   !> Beyond zero, where only trial states of a step and its search go, a natural power goes on as
   !> it comes: a step sees no corner.
   pure subroutine raise_state(factors, exponent, z, power)
      integer, intent(in) :: factors
      !! n where it is a small natural number, so that the power is a product; else 0
      real(wp), intent(in) :: exponent(lane_count)
      !! n [-]
      real(wp), intent(in) :: z(lane_count)
      !! [-]
      real(wp), intent(out) :: power(lane_count)
      !! [-]
      real(wp), parameter :: largest_state = 1.26_wp
      !! |z| of a trial state that no step keeps; its power of 1000 is a number [-]
      real(wp), parameter :: largest = 1.0e3_wp
      !! of such powers: the next trial state stays a number as well
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
         ! the power of libm for one lane after the other: vectorised ones have other last bits
         !GCC$ novector
         do i = 1, lane_count
            power(i) = min(min(abs(z(i)), largest_state)**exponent(i), largest)
         end do
      end if
   end subroutine raise_state

end module rwmf_model_hysteresis_bouc_wen_rate
