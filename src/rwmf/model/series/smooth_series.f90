!> Taylor series of smooth hysteresis: the state z of Bouc and Wen, of the frame and of storeys.
module rwmf_model_series_smooth_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: term_t
   use rwmf_model_series_series_motion, only: highest_order, power_of, product_of, &
      series_motion_t
   implicit none
   private

   public :: expand_power, expand_bouc_wen, locate_spring

contains

   !> Expand z**m for a small natural m, else |z|**m, as `raise_state`. At 0 the latter has no
   !> series.
   pure subroutine expand_power(n, factors, exponent, negligible, z, powers)
      integer, intent(in) :: n
      !! number of the coefficient
      integer, intent(in) :: factors
      !! m if it is a small natural number; else 0
      real(wp), intent(in) :: exponent(lane_count)
      !! m [-]
      real(wp), intent(in) :: negligible(lane_count)
      !! |z| up to which |z|**m is 0 [-]
      real(wp), intent(in) :: z(lane_count, 0:n)
      !! coefficients of z [-]
      real(wp), intent(inout) :: powers(lane_count, 0:highest_order, max(1, factors - 1))
      !! the last of its max(1, factors - 1) series is the power [-]
      integer :: m

      if (factors == 0) then
         if (n == 0) then
            powers(:, 0, 1) = abs(z(:, 0))**exponent
            where (abs(z(:, 0)) <= negligible) powers(:, 0, 1) = 0
         else
            powers(:, n, 1) = power_of(n, z, exponent, powers)
         end if
         return
      end if
      powers(:, n, 1) = z(:, n)
      if (factors > 1) powers(:, n, 1) = product_of(n, z, z)
      do m = 3, factors
         powers(:, n, m - 1) = product_of(n, powers(1, 0, m - 2), z)
      end do
   end subroutine expand_power

   !> Add the hysteretic part of the frame's force to the moment and expand the rate of its state.
   pure subroutine expand_bouc_wen(n, factors, coef, z, motion, z_dot)
      integer, intent(in) :: n
      !! number of the coefficient
      integer, intent(in) :: factors
      !! factors of the power, see `expand_power`
      real(wp), intent(in) :: coef(lane_count, 4)
      !! coefficients as of `add_bouc_wen`
      real(wp), intent(in) :: z(lane_count, 0:n)
      !! hysteretic state [-]
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: z_dot(lane_count)
      !! coefficient n of its rate [1/s]

      call expand_power(n, factors, coef(1, 4), motion%laws%negligible_state, z, &
         motion%laws%hysteresis)
      motion%moment(:, n) = motion%moment(:, n) - motion%side*coef(:, 1)*product_of(n, &
         motion%lever, z)
      z_dot = motion%side*coef(:, 2)*(motion%u_rate(:, n) - coef(:, 3)*product_of(n, &
         motion%u_rate, motion%laws%hysteresis(1, 0, max(1, factors - 1))))
   end subroutine expand_bouc_wen

   !> Locate the smooth spring of a frame.
   pure subroutine locate_spring(term, n, first)
      type(term_t), intent(in) :: term
      integer, intent(out) :: n
      !! number of springs: 1
      integer, intent(out) :: first(3)
      !! numbers of the state, and of the columns of its factor and of the exponent

      n = 1
      first = [term%state, term%coef + 2, term%coef + 3]
   end subroutine locate_spring

end module rwmf_model_series_smooth_series
