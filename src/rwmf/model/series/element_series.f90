!> Taylor series of the vertical elements of a wall.
module rwmf_model_series_element_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: axis_coefficients, chord_coefficients, lane_count, &
      line_coefficients, rise_coefficients
   use rwmf_model_series_series_motion, only: highest_order, product_of, quotient_of, root_of, &
      series_motion_t
   implicit none
   private

   public :: expand_axial, expand_straight_tendons, expand_chords, expand_rises, expand_half_angle
   public :: tendon_memory

   integer, parameter :: tendon_memory = 3
   !! number of series that a straight tendon keeps

contains

   !> Add the tendons along the axis, Eq. (1), whose force and moment are linear in the rotation.
   pure subroutine expand_axial(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, axis_coefficients)
      !! coefficients as of `add_axial`
      type(series_motion_t), intent(inout) :: motion

      motion%moment(:, n) = motion%moment(:, n) - coef(:, 2)*motion%phi(:, n)
      if (n == 0) motion%moment(:, 0) = motion%moment(:, 0) - coef(:, 1)
   end subroutine expand_axial

   !> Add straight tendons, as `add_straight_tendons`.
   pure subroutine expand_straight_tendons(n, count, coef, memory, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      integer, intent(in) :: count
      !! number of tendons
      real(wp), intent(in) :: coef(lane_count, line_coefficients, count)
      !! coefficients as of `add_straight_tendons`
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, tendon_memory, count)
      !! length [m], arm [m] and force as its coefficients
      type(series_motion_t), intent(inout) :: motion
      integer, parameter :: length = 1, arm = 2, force = 3
      real(wp) :: rise(lane_count)
      !! change of the squared length [m2]
      integer :: k

      do k = 1, count
         associate (z => coef(:, 3, k), a => coef(:, 4, k))
            if (n == 0) then
               rise = 2*a*(2*a*motion%half_sine(:, 0)**2 + z*motion%sine(:, 0))
               memory(:, 0, length, k) = sqrt(z*z + rise)
               memory(:, 0, force, k) = coef(:, 1, k) + coef(:, 2, k)*(rise/(memory(:, 0, length, &
                  k) + z))
            else
               rise = 2*a*(z*motion%sine(:, n) - a*motion%cosine(:, n))
               memory(:, n, length, k) = root_of(n, rise, memory(1, 0, length, k))
               memory(:, n, force, k) = coef(:, 2, k)*memory(:, n, length, k)
            end if
            memory(:, n, arm, k) = quotient_of(n, a*(a*motion%sine(:, n) + z*motion%cosine(:, n)), &
               memory(1, 0, length, k), memory(1, 0, arm, k))
         end associate
         motion%moment(:, n) = motion%moment(:, n) - product_of(n, memory(1, 0, force, k), &
            memory(1, 0, arm, k))
      end do
   end subroutine expand_straight_tendons

   !> Expand sine and cosine of half the rotation.
   pure subroutine expand_half_angle(n, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      type(series_motion_t), intent(inout) :: motion

      if (n == 0) return
      motion%half_sine(:, n) = product_of(n - 1, motion%half_cosine, motion%rate)/(2*n)
      motion%half_cosine(:, n) = -product_of(n - 1, motion%half_sine, motion%rate)/(2*n)
   end subroutine expand_half_angle

   !> Add the devices under the base: springs on their strokes, and viscous dampers.
   pure subroutine expand_chords(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, chord_coefficients)
      !! coefficients as of `add_chords`
      type(series_motion_t), intent(inout) :: motion

      motion%moment(:, n) = motion%moment(:, n) - 0.5_wp*(coef(:, 2)*motion%sine(:, n) &
         + coef(:, 3)*(motion%rate(:, n) + motion%cosine_rate(:, n)))
      if (all(abs(coef(:, 1)) <= 0)) return
      call expand_half_angle(n, motion)
      motion%moment(:, n) = motion%moment(:, n) - coef(:, 1)*motion%half_cosine(:, n)
   end subroutine expand_chords

   !> Add restraints and couplings: springs on their strokes, and viscous dampers.
   pure subroutine expand_rises(n, coef, motion)
      integer, intent(in) :: n
      !! number of the coefficient
      real(wp), intent(in) :: coef(lane_count, rise_coefficients)
      !! coefficients as of `add_rises`
      type(series_motion_t), intent(inout) :: motion
      integer, parameter :: sine = 1, cosine = 2
      integer :: k

      associate (twice => motion%laws%twice)
         twice(:, n, sine) = 2*product_of(n, motion%sine, motion%cosine)
         twice(:, n, cosine) = -2*product_of(n, motion%sine, motion%sine)
         if (n == 0) twice(:, 0, cosine) = 1 + twice(:, 0, cosine)
         motion%moment(:, n) = motion%moment(:, n) - (coef(:, 1)*motion%cosine(:, n) &
            + coef(:, 2)*motion%sine(:, n) + coef(:, 3)*twice(:, n, sine) &
            + coef(:, 4)*twice(:, n, cosine) + coef(:, 5)*motion%rate(:, n))
         if (all(abs(coef(:, 5)) <= 0)) return
         do k = 0, n
            motion%moment(:, n) = motion%moment(:, n) - (coef(:, 6)*twice(:, k, cosine) &
               - coef(:, 7)*twice(:, k, sine))*motion%rate(:, n - k)
         end do
      end associate
   end subroutine expand_rises

end module rwmf_model_series_element_series
