!> Fuses in the equation of motion, for all lanes.
module rwmf_model_effects_fuse_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   implicit none
   private

   public :: add_fuse

contains

   !> Add the force of the fuse to the moment. The force is linear in the stroke 4b sin(phi/2), and
   !> its arm is 2b cos(phi/2).
   pure subroutine add_fuse(coef, motion)
      real(wp), intent(in) :: coef(lane_count, 3)
      !! 2b times the force at zero stroke over m_w R**2 [1/s2]; 8b**2 times the slope over m_w
      !! R**2 [1/s2]; force of the fuse under the pivot, which has no arm, over m_w [m/s2]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - motion%half_cosine(i)*(coef(i, 1) &
            + coef(i, 2)*motion%half_sine(i))
      end do
   end subroutine add_fuse

end module rwmf_model_effects_fuse_loop
