!> Loop over lanes of the corner dampers.
module rwmf_model_effects_corner_damper_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   implicit none
   private

   public :: add_damper

contains

   !> Part of the damper in the equation of motion.
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

end module rwmf_model_effects_corner_damper_loop
