!> One step of all lanes by an explicit pair, with stages, solution and error estimate.
module rwmf_integrator_lane_step
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_pairs, only: most_stages, most_terms, pair_t, sum_t
   use rwmf_model_effects_loops, only: lane_powers, lane_rates, power_unit
   use rwmf_model_lanes, only: lane_count, lane_motion_t, power_count
   use rwmf_model_scene, only: scene_t
   implicit none
   private

   public :: attempt_step

contains

   !> Advance every lane by its own step length.
   !>
   !> The local error is Hairer's combination of two estimators, or the root mean square of one.
   subroutine attempt_step(scene, pair, coef, ground, h, tolerance, y, has_rates, k, y_new, &
      error, work)
      type(scene_t), intent(in) :: scene
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the loops, for the current side and branches
      real(wp), intent(in) :: ground(lane_count, most_stages, 2)
      !! acceleration of the ground at the nodes, horizontal and vertical [m/s2]
      real(wp), intent(in) :: h(lane_count)
      !! [s]
      real(wp), intent(in) :: tolerance(lane_count, 0:scene%n)
      !! relative tolerance, and absolute tolerance of each state
      real(wp), intent(in) :: y(lane_count, scene%n)
      !! (states)
      logical, intent(in) :: has_rates
      !! the rates at the beginning are known; requires `work` to be absent
      real(wp), intent(inout) :: k(lane_count, scene%n, most_stages)
      !! rates of the states at the nodes; the first ones are those at the beginning
      real(wp), intent(out) :: y_new(lane_count, scene%n)
      !! states at the end; during the step, those at each node
      real(wp), intent(out) :: error(lane_count)
      !! square of the norm of the local error over the tolerance [-]
      real(wp), intent(out), optional :: work(lane_count, power_count)
      !! work of the ground motion, dampers and smooth plastic flow, to the order of the pair [J/kg]
      type(lane_motion_t) :: motion
      integer :: s

      if (.not. has_rates) then
         motion%ground = ground(:, 1, 1)
         motion%upward = ground(:, 1, 2)
         call lane_rates(scene, coef, y, motion, k(:, :, 1))
      end if
      if (present(work)) then
         work = 0
         call lane_powers(scene, pair%weight(1), coef, y, k(:, :, 1), motion, work)
      end if
      do s = 2, pair%stages
         call advance(scene%n, pair%a(s), h, y, k, y_new)
         motion%ground = ground(:, s, 1)
         motion%upward = ground(:, s, 2)
         call lane_rates(scene, coef, y_new, motion, k(:, :, s))
         if (.not. present(work)) cycle
         if (abs(pair%weight(s)) > 0) call lane_powers(scene, pair%weight(s), coef, y_new, &
            k(:, :, s), motion, work)
      end do
      if (present(work)) call scale_work(scene, coef, h, work)
      call advance(scene%n, pair%b, h, y, k, y_new)
      call estimate_error(scene%n, pair, h, tolerance, y, y_new, k, error)
   end subroutine attempt_step

   !> Convert the mean powers over a step to work.
   subroutine scale_work(scene, coef, h, work)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(inout) :: work(lane_count, power_count)
      real(wp) :: unit(lane_count)
      integer :: i, m

      call power_unit(scene, coef, unit)
      do m = 1, power_count
         !$omp simd
         do i = 1, lane_count
            work(i, m) = h(i)*unit(i)*work(i, m)
         end do
      end do
   end subroutine scale_work

   !> Compute y + h times a weighted sum of stages.
   pure subroutine advance(n, weights, h, y, k, y_new)
      integer, intent(in) :: n
      type(sum_t), intent(in) :: weights
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: y_new(lane_count, n)

      ! with a constant number of terms the compiler keeps a sum in registers
      select case (weights%terms)
      case (1)
         call add_stages(1, n, weights, h, y, k, y_new)
      case (2)
         call add_stages(2, n, weights, h, y, k, y_new)
      case (3)
         call add_stages(3, n, weights, h, y, k, y_new)
      case (4)
         call add_stages(4, n, weights, h, y, k, y_new)
      case (5)
         call add_stages(5, n, weights, h, y, k, y_new)
      case (6)
         call add_stages(6, n, weights, h, y, k, y_new)
      case (7)
         call add_stages(7, n, weights, h, y, k, y_new)
      case (8)
         call add_stages(8, n, weights, h, y, k, y_new)
      case default
         call add_stages(most_terms, n, weights, h, y, k, y_new)
      end select
   end subroutine advance

   !> Compute y + h times a weighted sum of a given number of stages.
   pure subroutine add_stages(terms, n, weights, h, y, k, y_new)
      integer, intent(in) :: terms
      integer, intent(in) :: n
      type(sum_t), intent(in) :: weights
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: y_new(lane_count, n)
      real(wp) :: total
      integer :: i, m

      associate (w => weights%weight, s => weights%stage)
         do m = 1, n
            !$omp simd private(total)
            do i = 1, lane_count
               total = w(1)*k(i, m, s(1))
               if (terms > 1) total = total + w(2)*k(i, m, s(2))
               if (terms > 2) total = total + w(3)*k(i, m, s(3))
               if (terms > 3) total = total + w(4)*k(i, m, s(4))
               if (terms > 4) total = total + w(5)*k(i, m, s(5))
               if (terms > 5) total = total + w(6)*k(i, m, s(6))
               if (terms > 6) total = total + w(7)*k(i, m, s(7))
               if (terms > 7) total = total + w(8)*k(i, m, s(8))
               if (terms > 8) total = total + w(9)*k(i, m, s(9))
               y_new(i, m) = y(i, m) + h(i)*total
            end do
         end do
      end associate
   end subroutine add_stages

   pure subroutine estimate_error(n, pair, h, tolerance, y, y_new, k, error)
      integer, intent(in) :: n
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: h(lane_count)
      real(wp), intent(in) :: tolerance(lane_count, 0:n)
      real(wp), intent(in) :: y(lane_count, n)
      real(wp), intent(in) :: y_new(lane_count, n)
      real(wp), intent(in) :: k(lane_count, n, most_stages)
      real(wp), intent(out) :: error(lane_count)
      real(wp) :: zero(lane_count, n)
      real(wp) :: total(lane_count, n), total_low(lane_count, n)
      real(wp) :: square(lane_count), square_low(lane_count)
      real(wp) :: scale
      integer :: i, m

      !$omp simd
      do i = 1, lane_count
         square(i) = 0
         square_low(i) = 0
      end do
      do m = 1, n
         !$omp simd
         do i = 1, lane_count
            zero(i, m) = 0
         end do
      end do
      call advance(n, pair%e, h, zero, k, total)
      if (pair%e_low%terms > 0) call advance(n, pair%e_low, h, zero, k, total_low)
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
            square_low(i) = square_low(i) &
               + total_low(i, m)*total(i, m)*(total_low(i, m)*total(i, m))
         end do
      end do
      if (pair%e_low%terms > 0) then
         !$omp simd
         do i = 1, lane_count
            error(i) = square(i)*square(i)/(n*(square(i) + 0.01_wp*square_low(i)) + tiny(1.0_wp))
         end do
      else
         ! scale the norm as if it decreased with nearly the eighth power of h
         !$omp simd
         do i = 1, lane_count
            square(i) = square(i)*(1/real(n, wp))
            error(i) = square(i)*sqrt(square(i))
         end do
      end if
   end subroutine estimate_error

end module rwmf_integrator_lane_step
