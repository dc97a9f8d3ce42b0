!> Loop over lanes of the vertical ground motion.
module rwmf_model_effects_vertical_motion_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   implicit none
   private

   public :: add_vertical

contains

   !> Part of the vertical motion in the equation of motion.
   pure subroutine add_vertical(coef, motion)
      real(wp), intent(in) :: coef(lane_count)
      !! 1/R [1/m]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - coef(i)*motion%vertical(i)*motion%s(i)
      end do
   end subroutine add_vertical

end module rwmf_model_effects_vertical_motion_loop
