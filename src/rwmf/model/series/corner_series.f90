!> Taylor series of the effects that read the motion of the wall alone.
!>
!> They are the devices at the corners, the vertical ground motion, and gravity on a frame with one
!> mass and its excited mass.
module rwmf_model_series_corner_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_series_element_series, only: expand_half_angle
   use rwmf_model_series_series_motion, only: power_of, product_of, pushed, series_motion_t
   implicit none
   private

   public :: expand_inerter, expand_nl_damper, expand_vertical
   public :: expand_leaning_column, expand_excited_mass, negligible_time, &
      rate_after

contains

   !> Add the inertia and moment of the inerter under the lifting corner.
   pure subroutine expand_inerter(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count)
      !! coefficients as of `add_inerter`
      type(series_motion_t), intent(inout) :: motion

      motion%inertia(:, n) = motion%inertia(:, n) + 0.5_wp*coef*motion%cosine(:, n)
      if (n == 0) motion%inertia(:, 0) = motion%inertia(:, 0) + 0.5_wp*coef
      motion%moment(:, n) = motion%moment(:, n) + 0.25_wp*coef*product_of(n, motion%sine_rate, &
         motion%rate)
   end subroutine expand_inerter

   !> Add the force of the nonlinear dampers, none up to a negligible velocity.
   pure subroutine expand_nl_damper(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, 4)
      !! coefficients as of `add_nl_damper`
      type(series_motion_t), intent(inout) :: motion
      integer, parameter :: speed = 1, power = 2
      !! velocity of the stroke [m/s]; its power with its sign [-]

      call expand_half_angle(n, motion)
      associate (of => motion%laws%power)
         of(:, n, speed) = coef(:, 1)*product_of(n, motion%half_cosine, motion%rate)
         if (n == 0) then
            of(:, 0, power) = sign(abs(of(:, 0, speed))**coef(:, 3), of(:, 0, speed))
            where (abs(motion%rate(:, 0)) <= motion%laws%negligible_rate) of(:, 0, power) = 0
         else
            of(:, n, power) = power_of(n, of(1, 0, speed), coef(:, 3), of(1, 0, power))
         end if
         where (abs(coef(:, 3) - 1) <= 0) of(:, n, power) = of(:, n, speed)
         motion%moment(:, n) = motion%moment(:, n) - coef(:, 2)*product_of(n, &
            motion%half_cosine, of(1, 0, power))
      end associate
   end subroutine expand_nl_damper

   !> Time from a turn on in which the impulse of the nonlinear dampers is negligible, and their
   !> moment far below the one that moves the wall [s].
   pure real(wp) function negligible_time(coef, turn, inertia, impulse) result(time)
      real(wp), intent(in) :: coef(4)
      !! coefficients as of `add_nl_damper`
      real(wp), intent(in) :: turn(:)
      !! coefficients of |phi''| in powers of the time since the turn, without the dampers. At a
      !! lift-off from rest the first one is zero [rad/s2/s**k]
      real(wp), intent(in) :: inertia
      !! over m_w R**2 [-]
      real(wp), intent(in) :: impulse
      !! change of phi' that is negligible [rad/s]
      real(wp), parameter :: far = 0.1_wp
      integer, parameter :: most = 60
      integer :: k

      time = sqrt(huge(time))
      associate (at_unit => coef(2)*coef(1)**coef(3)/inertia, a => coef(3), n => size(turn))
         do k = 1, n
            ! the largest of n terms is at least the n-th part of their sum
            time = min(time, (impulse/(at_unit*max(n*turn(k)/k, tiny(time))**a))**(1/(1 + k*a)))
         end do
         do k = 1, most
            if (at_unit*rate_after(turn, time)**a <= far**a*acceleration_after(turn, time)) exit
            time = 0.5_wp*time
         end do
      end associate

   contains

      !> Acceleration at a time after the turn [rad/s2].
      pure real(wp) function acceleration_after(turn, time)
         real(wp), intent(in) :: turn(:), time

         acceleration_after = sum(turn*[(time**(k - 1), k=1, size(turn))])
      end function acceleration_after
   end function negligible_time

   !> Velocity at a time after a turn [rad/s].
   pure real(wp) function rate_after(turn, time)
      real(wp), intent(in) :: turn(:)
      !! coefficients of |phi''| in powers of the time since the turn [rad/s2/s**k]
      real(wp), intent(in) :: time
      !! [s]
      integer :: k

      rate_after = sum(turn*[(time**k/k, k=1, size(turn))])
   end function rate_after

   !> Add the moment of the vertical ground motion.
   pure subroutine expand_vertical(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count)
      !! coefficients as of `add_vertical`
      type(series_motion_t), intent(inout) :: motion
      integer :: k

      do k = 0, min(n, motion%ground_order)
         motion%moment(:, n) = motion%moment(:, n) - coef*motion%upward(:, k)*motion%s(:, n - k)
      end do
   end subroutine expand_vertical

   !> Add the push of the leaning column to a frame of one coordinate.
   pure subroutine expand_leaning_column(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count)
      !! push per displacement over m_w [1/s2]
      type(series_motion_t), intent(inout) :: motion

      motion%moment(:, n) = motion%moment(:, n) + coef*product_of(n, motion%lever, motion%u)
   end subroutine expand_leaning_column

   !> Add the ground force on the excited mass that does not move with the roof (one mode).
   pure subroutine expand_excited_mass(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count)
      !! excited mass minus mass moving with the roof, over m_w [-]
      type(series_motion_t), intent(inout) :: motion

      motion%moment(:, n) = motion%moment(:, n) - coef*pushed(n, motion%lever, motion)
   end subroutine expand_excited_mass

end module rwmf_model_series_corner_series
