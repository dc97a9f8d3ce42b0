!> Vertical ground motion in the equation of motion, for all lanes.
module rwmf_model_effects_vertical_motion_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_input, power_count
   implicit none
   private

   public :: add_vertical, add_vertical_power

contains

   !> Add the moment of the vertical ground motion.
   pure subroutine add_vertical(coef, motion)
      real(wp), intent(in) :: coef(lane_count)
      !! 1/R [1/m]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - coef(i)*motion%upward(i)*motion%s(i)
      end do
   end subroutine add_vertical

   !> Add the power of the vertical ground motion on the rising wall.
   pure subroutine add_vertical_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count)
      !! coefficient of `add_vertical`, 1/R [1/m]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      integer :: i

      !$omp simd
      do i = 1, lane_count
         total(i, of_input) = total(i, of_input) - weight*(coef(i)*motion%upward(i)*motion%s(i) &
            *motion%rate(i))
      end do
   end subroutine add_vertical_power

end module rwmf_model_effects_vertical_motion_loop
