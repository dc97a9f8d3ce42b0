!> Corner inerters in the equation of motion, for all lanes.
module rwmf_model_effects_corner_inerter_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   implicit none
   private

   public :: add_inerter

contains

   !> Add the inertia and moment of the inerter under the lifting corner.
   pure subroutine add_inerter(coef, motion)
      real(wp), intent(in) :: coef(lane_count)
      !! B (2b)**2 over m_w R**2 [-]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%inertia(i) = motion%inertia(i) + coef(i)*motion%half_cosine(i)*motion%half_cosine(i)
         motion%moment(i) = motion%moment(i) + 0.5_wp*coef(i)*motion%half_sine(i) &
            *motion%half_cosine(i)*motion%rate(i)*motion%rate(i)
      end do
   end subroutine add_inerter

end module rwmf_model_effects_corner_inerter_loop
