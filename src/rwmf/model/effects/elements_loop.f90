!> Vertical elements in the equation of motion, for all lanes. The coefficients are sums over all
!> elements with the same kind of stroke (`rwmf_model_elements`).
module rwmf_model_effects_elements_loop
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: axis_coefficients, chord_coefficients, lane_count, lane_motion_t, &
      line_coefficients, of_viscous, power_count, rise_coefficients
   implicit none
   private

   public :: add_axial, add_straight_tendons, add_chords, add_chord_power, add_rises, add_rise_power

contains

   !> Add the tendons along the axis, Eq. (1), whose force and moment are linear in the rotation.
   pure subroutine add_axial(coef, motion)
      real(wp), intent(in) :: coef(lane_count, axis_coefficients)
      !! moment at phi = 0 over m_w R**2 [1/s2] and its rate [1/(rad s2)]; force at phi = 0 over m_w
      !! [m/s2] and its rate [m/(rad s2)]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - (coef(i, 1) + coef(i, 2)*motion%phi(i))
      end do
   end subroutine add_axial

   !> Add straight tendons. The force is linear in the elongation, with l**2 = z**2 + 2a**2 (1 -
   !> cos(phi)) + 2za sin(phi).
   pure subroutine add_straight_tendons(n, coef, motion)
      integer, intent(in) :: n
      !! number of tendons
      real(wp), intent(in) :: coef(lane_count, line_coefficients, n)
      !! force at zero elongation, over m_w R**2 [1/(m s2)]; its slope [1/(m2 s2)]; length z at rest
      !! [m]; arm a [m]
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: sine_phi, rise, length, arm
      integer :: i, k

      do k = 1, n
         !$omp simd private(sine_phi, rise, length, arm)
         do i = 1, lane_count
            associate (z => coef(i, 3, k), a => coef(i, 4, k), half_sine => motion%half_sine(i))
               sine_phi = 2*half_sine*motion%half_cosine(i)
               rise = 2*a*(2*a*half_sine*half_sine + z*sine_phi)
               length = sqrt(z*z + rise)
               arm = a*(a*sine_phi + z*(1 - 2*half_sine*half_sine))/length
               motion%moment(i) = motion%moment(i) - (coef(i, 1, k) + coef(i, 2, k)*(rise/(length &
                  + z)))*arm
            end associate
         end do
      end do
   end subroutine add_straight_tendons

   !> Add the devices under the base: springs on the strokes 2a sin(phi/2), and viscous dampers.
   pure subroutine add_chords(coef, motion)
      real(wp), intent(in) :: coef(lane_count, chord_coefficients)
      !! sums over the devices, over R**2: a times the force at zero stroke [1/s2], 2a**2 times the
      !! slope [1/s2], a**2 times the damper constant [1/s]; then the same without a/R**2 [m/s2],
      !! [m/s2], [m/s], and the force of those under the pivot [m/s2]
      type(lane_motion_t), intent(inout) :: motion
      integer :: i

      !$omp simd
      do i = 1, lane_count
         motion%moment(i) = motion%moment(i) - motion%half_cosine(i)*(coef(i, 1) &
            + coef(i, 2)*motion%half_sine(i) + coef(i, 3)*motion%half_cosine(i)*motion%rate(i))
      end do
   end subroutine add_chords

   !> Add the power that these dampers dissipate.
   pure subroutine add_chord_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count, chord_coefficients)
      !! coefficients of `add_chords`
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: rate
      integer :: i

      !$omp simd private(rate)
      do i = 1, lane_count
         rate = motion%half_cosine(i)*motion%rate(i)
         total(i, of_viscous) = total(i, of_viscous) + weight*(coef(i, 3)*rate*rate)
      end do
   end subroutine add_chord_power

   !> Add restraints and couplings: springs and viscous dampers on the strokes a sin(phi) - z (1 -
   !> cos(phi)).
   pure subroutine add_rises(coef, motion)
      real(wp), intent(in) :: coef(lane_count, rise_coefficients)
      !! factors of cos(phi), sin(phi), sin(2 phi), cos(2 phi) in the moment over m_w R**2 [1/s2];
      !! then of phi', phi' cos(2 phi) and -phi' sin(2 phi) [1/s]
      type(lane_motion_t), intent(inout) :: motion
      real(wp) :: sine, cosine, sine_2, cosine_2
      integer :: i

      !$omp simd private(sine, cosine, sine_2, cosine_2)
      do i = 1, lane_count
         sine = 2*motion%half_sine(i)*motion%half_cosine(i)
         cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
         sine_2 = 2*sine*cosine
         cosine_2 = 1 - 2*sine*sine
         motion%moment(i) = motion%moment(i) - (coef(i, 1)*cosine + coef(i, 2)*sine &
            + coef(i, 3)*sine_2 + coef(i, 4)*cosine_2) - (coef(i, 5) + coef(i, 6)*cosine_2 &
            - coef(i, 7)*sine_2)*motion%rate(i)
      end do
   end subroutine add_rises

   !> Add the power that these dampers dissipate.
   pure subroutine add_rise_power(weight, coef, motion, total)
      real(wp), intent(in) :: weight
      !! weight of the power in the sum [-]
      real(wp), intent(in) :: coef(lane_count, rise_coefficients)
      !! coefficients of `add_rises`
      type(lane_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: total(lane_count, power_count)
      !! sum of powers over m_w R**2 [1/s3]
      real(wp) :: sine, cosine, sine_2, cosine_2
      integer :: i

      !$omp simd private(sine, cosine, sine_2, cosine_2)
      do i = 1, lane_count
         sine = 2*motion%half_sine(i)*motion%half_cosine(i)
         cosine = 1 - 2*motion%half_sine(i)*motion%half_sine(i)
         sine_2 = 2*sine*cosine
         cosine_2 = 1 - 2*sine*sine
         total(i, of_viscous) = total(i, of_viscous) + weight*((coef(i, 5) + coef(i, 6)*cosine_2 &
            - coef(i, 7)*sine_2)*motion%rate(i)*motion%rate(i))
      end do
   end subroutine add_rise_power

end module rwmf_model_effects_elements_loop
