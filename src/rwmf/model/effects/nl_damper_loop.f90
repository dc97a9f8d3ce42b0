!> Nonlinear dampers in the equation of motion, for all lanes.
module rwmf_model_effects_nl_damper_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_viscous, power_count
   implicit none
   private

   public :: add_nl_damper, add_nl_damper_power, raise_rate

contains

   !> Add the force of the dampers to the moment.
   pure subroutine add_nl_damper(coef, motion)
      real(wp), intent(in) :: coef(lane_count, 4)
      !! largest arm a [m]; a times the force at 1 m/s over m_w R**2 [1/s2]; exponent [-]; that
      !! force [m/s2]
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: power(lane_count)
      integer :: i

      call raise_rate(coef, motion, power)
      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - coef(i, 2)*motion%half_cosine(i)*sign(power(i), &
            motion%rate(i))
      end do
   end subroutine add_nl_damper

   !> Add the power that the dampers dissipate.
   pure subroutine add_nl_damper_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count, 4)
      !! coefficients of `add_nl_damper` [m], [1/s2], [-]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: power(lane_count)
      integer :: i

      call raise_rate(coef, motion, power)
      !$omp simd
      do i = 1, lane_count
         total(i, of_viscous) = total(i, of_viscous) + weight*(coef(i, 2)*motion%half_cosine(i) &
            *power(i)*abs(motion%rate(i)))
      end do
   end subroutine add_nl_damper_power

   !> Raise the velocity of the stroke over 1 m/s to the exponent, |v|**exponent.
   pure subroutine raise_rate(coef, motion, power)
      real(wp), intent(in) :: coef(lane_count, 4)
      !! coefficients of `add_nl_damper` [m], [1/s2], [-], [m/s2]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(out) :: power(lane_count)
      !! |v|**exponent, with v in m/s [-]
      integer :: i

      ! libm's scalar power, lane by lane: the vectorised power differs in the last bits
      !GCC$ novector
      do i = 1, lane_count
         power(i) = abs(coef(i, 1)*motion%half_cosine(i)*motion%rate(i))**coef(i, 3)
      end do
   end subroutine raise_rate

end module rwmf_model_effects_nl_damper_loop
