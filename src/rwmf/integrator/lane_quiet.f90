!> Steps of lanes in which no storey ends its branch.
!>
!> The rule is that of `rwmf_math_sign_changes` for the cubic through displacements and rates at
!> both ends, written out for all lanes. It holds in most steps; the others need further tests.
module rwmf_integrator_lane_quiet
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_lane_columns, only: column_count, of_trial
   use rwmf_model_effects_loops, only: lane_storeys
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: scene_t
   implicit none
   private

   public :: find_quiet_steps
   public :: of_low_end, of_high_end, of_direction, of_side, limit_count

   integer, parameter :: of_low_end = 1
   !! displacement at which the branch of a storey ends downwards [m]
   integer, parameter :: of_high_end = 2
   !! displacement at which it ends upwards [m]
   integer, parameter :: of_direction = 3
   !! sign of the rate that the branch requires; 0 for either
   integer, parameter :: of_side = 4
   !! sign of the hysteretic state beyond its zero; 0 if it does not pass zero
   integer, parameter :: limit_count = 4

   integer, parameter :: of_rough = 1
   !! column of the roughness of displacements [m]
   integer, parameter :: of_noise = 2
   !! column of the round-off of displacements [m]
   integer, parameter :: of_rate_noise = 3
   !! column of the round-off of rates [m/s]
   integer, parameter :: spacings = 8
   !! round-off of a function, in spacings of its largest value

contains

   !> Find the steps whose ends show that no storey ends its branch.
   subroutine find_quiet_steps(scene, n, smooth, coef, y, y_new, limits, frequency, table, d, &
      is_quiet)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: n
      !! number of storeys
      integer, intent(in) :: smooth
      !! index of the first hysteretic state; 0 for storeys on straight lines
      real(wp), intent(in) :: coef(lane_count, scene%n_coef)
      !! coefficients of the loops, on the current side and the active branches
      real(wp), intent(in) :: y(lane_count, scene%n), y_new(lane_count, scene%n)
      !! states at both ends of the attempted steps
      real(wp), intent(in) :: limits(lane_count, n, limit_count)
      !! limits of the branches, in the columns above [m], [-]
      real(wp), intent(in) :: frequency(lane_count)
      !! frequency of the fastest vibration [rad/s]
      real(wp), intent(in) :: table(lane_count, column_count)
      !! one row per lane, with the columns and units of `rwmf_integrator_lane_columns`
      real(wp), intent(inout) :: d(lane_count, n, 0:1, 2)
      !! work array of the displacements [m] and rates [m/s] of the storeys at both ends
      real(wp), intent(out) :: is_quiet(lane_count, 0:n)
      !! 1 if a storey does not end its branch, 0 if it may; the first column is for all storeys [-]
      real(wp) :: h(lane_count), scales(lane_count, of_rate_noise)
      integer :: i, j

      call lane_storeys(scene, n, coef, y, d(1, 1, 0, 1))
      call lane_storeys(scene, n, coef, y_new, d(1, 1, 0, 2))
      !$omp simd
      do i = 1, lane_count
         ! idle lanes get any nonzero length
         h(i) = merge(table(i, of_trial), 1.0_wp, table(i, of_trial) > 0)
         is_quiet(i, 0) = 1
      end do
      call measure_steps(n, h, frequency, d, scales)
      do j = 1, n
         call check_storey(n, j, h, scales, d, limits, is_quiet(1, j))
         if (smooth > 0) then
            !$omp simd
            do i = 1, lane_count
               is_quiet(i, j) = merge(0.0_wp, is_quiet(i, j), limits(i, j, of_side)*y_new(i, &
                  smooth + j - 1) > 0)
            end do
         end if
         !$omp simd
         do i = 1, lane_count
            is_quiet(i, 0) = min(is_quiet(i, 0), is_quiet(i, j))
         end do
      end do
   end subroutine find_quiet_steps

   !> Compute the roughness of the least smooth displacement, and round-off.
   pure subroutine measure_steps(n, h, frequency, d, scales)
      integer, intent(in) :: n
      !! number of storeys
      real(wp), intent(in) :: h(lane_count)
      !! [s]
      real(wp), intent(in) :: frequency(lane_count)
      !! [rad/s]
      real(wp), intent(in) :: d(lane_count, n, 0:1, 2)
      !! displacements [m] and rates [m/s] at both ends
      real(wp), intent(out) :: scales(lane_count, of_rate_noise)
      !! in the columns above
      real(wp) :: angle, way, first, last
      integer :: i, j

      scales = 0
      do j = 1, n
         !$omp simd private(angle, way, first, last)
         do i = 1, lane_count
            angle = max(1.0_wp, h(i)*frequency(i))
            way = d(i, j, 0, 2) - d(i, j, 0, 1)
            first = way - h(i)*(2*d(i, j, 1, 1) + d(i, j, 1, 2))/3
            last = h(i)*(d(i, j, 1, 1) + 2*d(i, j, 1, 2))/3 - way
            scales(i, of_rough) = max(scales(i, of_rough), angle*abs(last - first) &
               + angle*angle*max(abs(first), abs(last)))
            scales(i, of_noise) = max(scales(i, of_noise), abs(d(i, j, 0, 1)), abs(d(i, j, 0, 2)))
            scales(i, of_rate_noise) = max(scales(i, of_rate_noise), abs(d(i, j, 1, 1)), &
               abs(d(i, j, 1, 2)))
         end do
      end do
      !$omp simd
      do i = 1, lane_count
         scales(i, of_rate_noise) = spacings*epsilon(h)*(scales(i, of_rate_noise) &
            + 5*scales(i, of_noise)/h(i))
         scales(i, of_noise) = spacings*epsilon(h)*scales(i, of_noise)
      end do
   end subroutine measure_steps

   !> Check one storey for the end of its branch: at a limit, or at a reversal on a branch with a
   !> direction.
   pure subroutine check_storey(n, j, h, scales, d, limits, is_quiet)
      integer, intent(in) :: n, j
      !! number of storeys, and of this storey
      real(wp), intent(in) :: h(lane_count)
      !! [s]
      real(wp), intent(in) :: scales(lane_count, of_rate_noise)
      !! in the columns above
      real(wp), intent(in) :: d(lane_count, n, 0:1, 2)
      !! displacements [m] and rates [m/s] at both ends
      real(wp), intent(in) :: limits(lane_count, n, limit_count)
      !! in the columns above
      real(wp), intent(out) :: is_quiet(lane_count)
      !! 1 if the storey does not end its branch, 0 if it may
      real(wp) :: low, high, low_noise, high_noise, direction
      !! limits, their round-off, required sign of the rate
      real(wp) :: begin, first, middle, last, end
      !! coefficients in Bernstein form of displacement or rate
      real(wp) :: inside, onward
      !! positive if displacement or rate keep their side
      integer :: i

      !$omp simd private(low, high, low_noise, high_noise, direction, begin, first, middle, last) &
      !$omp& private(end, inside, onward)
      do i = 1, lane_count
         direction = limits(i, j, of_direction)
         begin = d(i, j, 0, 1)
         end = d(i, j, 0, 2)
         ! a storey beyond a limit by round-off starts at the limit
         low = min(limits(i, j, of_low_end), begin)
         high = max(limits(i, j, of_high_end), begin)
         low_noise = max(scales(i, of_noise), spacings*epsilon(low)*abs(low))
         high_noise = max(scales(i, of_noise), spacings*epsilon(high)*abs(high))
         first = begin + h(i)*d(i, j, 1, 1)/4
         last = end - h(i)*d(i, j, 1, 2)/4
         middle = (begin + end)/2 + h(i)*(d(i, j, 1, 1) - d(i, j, 1, 2))/6
         inside = min(begin, first, last, end) - low + low_noise
         inside = min(inside, middle - low - max(scales(i, of_rough)/24, low_noise))
         inside = min(inside, high + high_noise - max(begin, first, last, end))
         inside = min(inside, high - middle - max(scales(i, of_rough)/24, high_noise))
         ! on a branch with a direction, only the limit ahead counts
         onward = direction*(merge(limits(i, j, of_high_end), limits(i, j, of_low_end), &
            direction > 0) - end)
         middle = 3*((end - begin)/h(i)) - d(i, j, 1, 1) - d(i, j, 1, 2)
         begin = direction*d(i, j, 1, 1)
         end = direction*d(i, j, 1, 2)
         first = (begin + 2*direction*middle)/3
         last = (end + 2*direction*middle)/3
         onward = merge(min(min(begin, end) + scales(i, of_rate_noise), min(first, last) &
            - max(scales(i, of_rough)/(6*h(i)), scales(i, of_rate_noise))), -1.0_wp, onward >= 0)
         is_quiet(i) = merge(1.0_wp, 0.0_wp, merge(onward, inside, abs(direction) > 0) > 0)
      end do
   end subroutine check_storey

end module rwmf_integrator_lane_quiet
