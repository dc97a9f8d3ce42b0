!> Frame with smooth hysteresis in the equation of motion, for all lanes.
module rwmf_model_effects_yielding_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_hysteresis_bouc_wen_loop, only: hysteretic_rate, raise_state
   use rwmf_model_lanes, only: lane_count, lane_motion_t, of_plastic, power_count
   implicit none
   private

   public :: add_bouc_wen, add_bouc_wen_power

contains

   !> Add the hysteretic part of the frame's force to the moment and compute the rate of its state.
   pure subroutine add_bouc_wen(factors, coef, z, motion, z_dot)
      integer, intent(in) :: factors
      !! factors of the power, see `raise_state`
      real(wp), intent(in) :: coef(lane_count, 4)
      !! force at z = 1 over m_w R [1/s2]; R over the yield displacement [-]; lost part [-];
      !! exponent [-]
      real(wp), intent(in) :: z(lane_count)
      !! hysteretic state [-]
      type(lane_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: z_dot(lane_count)
      !! rate of the hysteretic state [1/s]
      real(wp) :: power(lane_count)
      integer :: i

      call raise_state(factors, coef(1, 4), z, power)
      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - motion%side(i)*coef(i, 1)*motion%lever(i)*z(i)
         z_dot(i) = hysteretic_rate(motion%side(i)*coef(i, 2)*motion%j(i)*motion%rate(i), &
            coef(i, 3), power(i))
      end do
      if (motion%is_bent) z_dot = z_dot + hysteretic_rate(motion%side*coef(:, 2)*motion%w_rate, &
         coef(:, 3), power)
   end subroutine add_bouc_wen

   !> Add the power dissipated by plastic flow: hysteretic force times plastic velocity.
   pure subroutine add_bouc_wen_power(weight, coef, z, z_dot, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count, 4)
      !! coefficients of `add_bouc_wen`
      real(wp), intent(in) :: z(lane_count)
      !! hysteretic state [-]
      real(wp), intent(in) :: z_dot(lane_count)
      !! rate of the hysteretic state [1/s]
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      integer :: i

      !$omp simd
      do i = 1, lane_count
         total(i, of_plastic) = total(i, of_plastic) + weight*(coef(i, 1)*z(i)*(motion%side(i) &
            *motion%j(i)*motion%rate(i) - z_dot(i)/coef(i, 2)))
      end do
      if (motion%is_bent) total(:, of_plastic) = total(:, of_plastic) + weight*coef(:, 1)*z &
         *motion%side*motion%w_rate
   end subroutine add_bouc_wen_power

end module rwmf_model_effects_yielding_loop
