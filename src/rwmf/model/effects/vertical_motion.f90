!> Vertical ground motion: in the frame of the ground the wall weighs m_w (g + v_g'').
!>
!> The cable pulls with its own force P, which no motion of the ground changes; the frame's mass
!> moves horizontally only. What is left is the arm of the wall's weight times m_w v_g''.
module rwmf_model_effects_vertical_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, kinematics_at, vertical_ground
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_motion_ground_motion, only: interval_end, interval_last, motion_t, turning_point, &
      vertical_acceleration
   implicit none
   private

   public :: add_vertical, vertical_power, lowest_vertical

contains

   !> Part of the vertical motion in the equation of motion.
   subroutine add_vertical(equation, t, y, kin, inertia, moment, y_dot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp), intent(inout) :: y_dot(equation%n)

      moment = moment - vertical_ground(equation, t)*kin%s/equation%p%R
   end subroutine add_vertical

   !> Power that it puts in while the wall's centroid rises [W/kg].
   real(wp) function vertical_power(equation, t, y) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      type(kinematics_t) :: kin

      kin = kinematics_at(equation, y(1))
      power = -vertical_ground(equation, t)*equation%p%R*kin%s*equation%side*y(2)
   end function vertical_power

   !> Lowest vertical acceleration of all times, at most zero [m/s2].
   pure real(wp) function lowest_vertical(motion) result(lowest)
      type(motion_t), intent(in) :: motion
      real(wp) :: t
      !! [s]
      integer :: i

      lowest = 0
      do i = 1, interval_last(motion) - 1
         t = interval_end(motion, i - 1)
         lowest = min(lowest, vertical_acceleration(motion, i, t))
         do while (t < interval_end(motion, i))
            t = turning_point(motion, i, t)
            lowest = min(lowest, vertical_acceleration(motion, i, t))
         end do
      end do
   end function lowest_vertical

end module rwmf_model_effects_vertical_motion
