!> Gravity on a displaced frame (P-Delta) in the equation of motion, for all lanes.
module rwmf_model_effects_p_delta_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   implicit none
   private

   public :: add_p_delta

contains

   !> Add the push of the leaning column to a frame of one coordinate, or to floors and roof.
   pure subroutine add_p_delta(n, free, coef, y, motion, y_dot)
      integer, intent(in) :: n
      !! number of storeys with all modes; 0: one coordinate
      integer, intent(in) :: free
      !! number of floors with states: n - 1 below a linked roof, n with link springs
      real(wp), intent(in) :: coef(lane_count, 1 + n + free)
      !! one coordinate: push per displacement over m_w [1/s2]; storeys: R [m], push of each per
      !! displacement [1/s2], reciprocal mass of each floor with states [-]
      real(wp), intent(in) :: y(lane_count, 2*free)
      !! displacements [m] and velocities of these floors
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: y_dot(lane_count, 2*free)
      !! rates of these states [m/s], [m/s2]; the push adds to those of the velocities
      real(wp) :: above(lane_count), below(lane_count)
      !! displacements of two floors [m]
      real(wp) :: push(lane_count, n + 1)
      !! push of each storey; zero above the roof [m/s2]
      integer :: i, j

      if (n == 0) then
         !$omp simd
         do i = 1, lane_count
            motion%moment(i) = motion%moment(i) + coef(i, 1)*(motion%lever(i)*motion%u(i))
         end do
         return
      end if
      below = 0
      do j = 1, n
         if (j <= free) then
            above = y(:, j)
         else
            above = coef(:, 1)*(motion%side*motion%u)
         end if
         !$omp simd
         do i = 1, lane_count
            push(i, j) = coef(i, 1 + j)*(above(i) - below(i))
            below(i) = above(i)
         end do
      end do
      push(:, n + 1) = 0
      do j = 1, free
         !$omp simd
         do i = 1, lane_count
            y_dot(i, free + j) = y_dot(i, free + j) + coef(i, n + 1 + j)*(push(i, j) &
               - push(i, j + 1))
         end do
      end do
      if (free == n) return
      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) + motion%lever(i)*(motion%side(i)*push(i, n) &
            /coef(i, 1))
      end do
   end subroutine add_p_delta

end module rwmf_model_effects_p_delta_loop
