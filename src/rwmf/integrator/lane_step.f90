!> One step of the lanes by an explicit pair: stages, solution and the estimate of its error.
module rwmf_integrator_lane_step
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_pairs, only: most_stages, pair_t
   use rwmf_model_effects_loops, only: lane_rates
   use rwmf_model_lanes, only: lane_count, lane_motion_t
   use rwmf_model_scene, only: scene_t
   implicit none
   private

   public :: attempt_step

contains

   !> Advance every lane by a length of its own.
   !>
   !> The local error is Hairer's combination of two estimators, or the root mean square of one.
   subroutine attempt_step(scene, pair, coef, ground, h, tolerance, y, has_rates, k, y_new, &
      error)
      type(scene_t), intent(in) :: scene
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: ground(lane_count, most_stages, 2)
      !! acceleration of the ground at the nodes, horizontal and vertical [m/s2]
      real(wp), intent(in) :: h(lane_count)
      !! [s]
      real(wp), intent(in) :: tolerance(lane_count, 0:scene%n)
      !! relative, and absolute of each state
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! (states)
      logical, intent(in) :: has_rates
      !! those at the beginning are known
      real(wp), intent(inout) :: k(lane_count, scene%n, most_stages)
      !! rates at the nodes
      real(wp), intent(out) :: y_new(lane_count, scene%n)
      real(wp), intent(out) :: error(lane_count)
      !! norm of the local error over the tolerance [-]
      type(lane_motion_t) :: motion
      real(wp) :: stage(lane_count, scene%n)
      integer :: s

      if (.not. has_rates) then
         motion%ground = ground(:, 1, 1)
         motion%vertical = ground(:, 1, 2)
         call lane_rates(scene, coef, y, motion, k(:, :, 1))
      end if
      do s = 2, pair%stages
         call advance(scene%n, s - 1, pair%a(:, s), h, y, k, stage)
         motion%ground = ground(:, s, 1)
         motion%vertical = ground(:, s, 2)
         call lane_rates(scene, coef, stage, motion, k(:, :, s))
      end do
      call advance(scene%n, pair%stages, pair%b, h, y, k, y_new)
      call estimate_error(scene%n, pair, h, tolerance, y, y_new, k, error)
   end subroutine attempt_step

   !> y + h times the weighted sum of the first stages.
   pure subroutine advance(n, stages, weight, h, y, k, y_new)
      integer, intent(in) :: n
      integer, intent(in) :: stages
      real(wp), intent(in) :: weight(most_stages)
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: y_new(lane_count, n)
      real(wp) :: total(lane_count)
      integer :: i, j, m

      do m = 1, n
         total = weight(1)*k(:, m, 1)
         do j = 2, stages
            if (abs(weight(j)) <= 0) cycle
            !$omp simd
            do i = 1, lane_count
               total(i) = total(i) + weight(j)*k(i, m, j)
            end do
         end do
         !$omp simd
         do i = 1, lane_count
            y_new(i, m) = y(i, m) + h(i)*total(i)
         end do
      end do
   end subroutine advance

   pure subroutine estimate_error(n, pair, h, tolerance, y, y_new, k, error)
      integer, intent(in) :: n
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: tolerance(lane_count, 0:n)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: y_new(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: error(lane_count)
      real(wp) :: total(lane_count), total_low(lane_count)
      real(wp) :: square(lane_count), square_low(lane_count)
      real(wp) :: scale
      integer :: i, j, m

      square = 0
      square_low = 0
      do m = 1, n
         total = 0
         total_low = 0
         do j = 1, pair%stages
            !$omp simd
            do i = 1, lane_count
               total(i) = total(i) + pair%e(j)*k(i, m, j)
               total_low(i) = total_low(i) + pair%e_low(j)*k(i, m, j)
            end do
         end do
         !$omp simd private(scale)
         do i = 1, lane_count
            scale = 1/(tolerance(i, m) + tolerance(i, 0)*max(abs(y(i, m)), abs(y_new(i, m))))
            square(i) = square(i) + total(i)*scale*(total(i)*scale)
            square_low(i) = square_low(i) + total_low(i)*scale*(total_low(i)*scale)
         end do
      end do
      !$omp simd
      do i = 1, lane_count
         error(i) = h(i)*square(i)/sqrt(n*(square(i) + 0.01_wp*square_low(i)) &
            + tiny(1.0_wp))
      end do
   end subroutine estimate_error

end module rwmf_integrator_lane_step
