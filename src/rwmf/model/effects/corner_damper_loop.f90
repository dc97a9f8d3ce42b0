!> Corner dampers in the equation of motion, for all lanes.
module rwmf_model_effects_corner_damper_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_viscous, power_count
   implicit none
   private

   public :: add_damper, add_damper_power

contains

   !> Add the moment of the damper under the lifting corner.
   pure subroutine add_damper(coef, motion)
      real(wp), intent(in) :: coef(lane_count)
      !! c (2b)**2 over m_w R**2 [1/s]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - coef(i)*motion%half_cosine(i)*motion%half_cosine(i) &
            *motion%rate(i)
      end do
   end subroutine add_damper

   !> Add the power that this damper dissipates.
   pure subroutine add_damper_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count)
      !! coefficient of `add_damper` [1/s]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: rate
      integer :: i

      !$omp simd private(rate)
      do i = 1, lane_count
         rate = motion%half_cosine(i)*motion%rate(i)
         total(i, of_viscous) = total(i, of_viscous) + weight*(coef(i)*rate*rate)
      end do
   end subroutine add_damper_power

end module rwmf_model_effects_corner_damper_loop
