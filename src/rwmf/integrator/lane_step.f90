!> One step of the lanes by an explicit pair: stages, solution and the estimate of its error.
module rwmf_integrator_lane_step
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_pairs, only: most_stages, pair_t, sum_t
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
         call advance(scene%n, pair%a(s), h, y, k, stage)
         motion%ground = ground(:, s, 1)
         motion%vertical = ground(:, s, 2)
         call lane_rates(scene, coef, stage, motion, k(:, :, s))
      end do
      call advance(scene%n, pair%b, h, y, k, y_new)
      call estimate_error(scene%n, pair, h, tolerance, y, y_new, k, error)
   end subroutine attempt_step

   !> y + h times a weighted sum of stages.
   pure subroutine advance(n, weights, h, y, k, y_new)
      integer, intent(in) :: n
      type(sum_t), intent(in) :: weights
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: y_new(lane_count, n)
      integer :: i, m

      call add_stages(lane_count*n, weights, k, y_new)
      do m = 1, n
         !$omp simd
         do i = 1, lane_count
            y_new(i, m) = y(i, m) + h(i)*y_new(i, m)
         end do
      end do
   end subroutine advance

   !> Weighted sum of stages, for all states of all lanes at once.
   pure subroutine add_stages(n, weights, k, total)
      integer, intent(in) :: n
      !! number of lanes times that of states
      type(sum_t), intent(in) :: weights
      real(wp), intent(in) :: k(n, most_stages)
      real(wp), intent(out) :: total(n)
      integer :: j

      call start_sum(n, weights%weight(1), k(1, weights%stage(1)), total)
      do j = 2, weights%terms - 1, 2
         call add_two(n, weights%weight(j), k(1, weights%stage(j)), k(1, weights%stage(j + 1)), &
            total)
      end do
      if (modulo(weights%terms, 2) == 0) call add_one(n, weights%weight(weights%terms), k(1, &
         weights%stage(weights%terms)), total)
   end subroutine add_stages

   pure subroutine start_sum(n, weight, k_1, total)
      integer, intent(in) :: n
      real(wp), intent(in) :: weight
      real(wp), intent(in) :: k_1(n)
      real(wp), intent(out) :: total(n)
      integer :: i

      !$omp simd
      do i = 1, n
         total(i) = weight*k_1(i)
      end do
   end subroutine start_sum

   pure subroutine add_one(n, weight, k_1, total)
      integer, intent(in) :: n
      real(wp), intent(in) :: weight
      real(wp), intent(in) :: k_1(n)
      real(wp), intent(inout) :: total(n)
      integer :: i

      !$omp simd
      do i = 1, n
         total(i) = total(i) + weight*k_1(i)
      end do
   end subroutine add_one

   pure subroutine add_two(n, weight, k_1, k_2, total)
      integer, intent(in) :: n
      real(wp), intent(in) :: weight(2)
      real(wp), intent(in), dimension(n) :: k_1, k_2
      real(wp), intent(inout) :: total(n)
      integer :: i

      !$omp simd
      do i = 1, n
         total(i) = total(i) + (weight(1)*k_1(i) + weight(2)*k_2(i))
      end do
   end subroutine add_two

   pure subroutine estimate_error(n, pair, h, tolerance, y, y_new, k, error)
      integer, intent(in) :: n
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: tolerance(lane_count, 0:n)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: y_new(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: error(lane_count)
      real(wp) :: total(lane_count, n), total_low(lane_count, n)
      real(wp) :: square(lane_count), square_low(lane_count)
      real(wp) :: scale
      integer :: i, m

      !$omp simd
      do i = 1, lane_count
         square(i) = 0
         square_low(i) = 0
      end do
      call add_stages(lane_count*n, pair%e, k, total)
      if (pair%e_low%terms > 0) call add_stages(lane_count*n, pair%e_low, k, total_low)
      do m = 1, n
         !$omp simd private(scale)
         do i = 1, lane_count
            scale = 1/(tolerance(i, m) + tolerance(i, 0)*max(abs(y(i, m)), abs(y_new(i, m))))
            square(i) = square(i) + total(i, m)*scale*(total(i, m)*scale)
            total(i, m) = scale
         end do
         if (pair%e_low%terms == 0) cycle
         !$omp simd
         do i = 1, lane_count
            square_low(i) = square_low(i) + total_low(i, m)*total(i, m)*(total_low(i, m)*total(i, m))
         end do
      end do
      !$omp simd
      do i = 1, lane_count
         error(i) = h(i)*square(i)/sqrt(n*(square(i) + 0.01_wp*square_low(i)) + tiny(1.0_wp))
      end do
   end subroutine estimate_error

end module rwmf_integrator_lane_step
