!> Largest displacement of the frame, tip deflection and drift of a bending wall. Unlike those of a
!> rigid wall, they do not occur at the turning points of theta.
module rwmf_simulation_recorder_top_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_beam, only: tip_deflection, tip_rate
   use rwmf_model_equation, only: equation_t, frame_acceleration, frame_motion, tip_acceleration, &
      tip_displacement, tip_velocity
   use rwmf_model_system_assembly, only: rates_at
   use rwmf_model_system_reactions, only: wall_drift
   use rwmf_simulation_events_storey_events, only: displacements_t
   implicit none
   private

   public :: top_motion_t, top_displacements, top_count

   integer, parameter :: top_count = 3
   !! displacement of the frame [m], tip deflection [m], drift of the wall [-]

   !> The three displacements with two derivatives.
   type, extends(displacements_t) :: top_motion_t
   contains
      procedure :: evaluate => evaluate_top
   end type top_motion_t

contains

   !> Compute the three displacements at a state.
   pure function top_displacements(equation, y) result(u)
      type(equation_t), intent(in) :: equation
      !! equation of a bending wall
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u(top_count)
      real(wp) :: rate

      call frame_motion(equation, equation%state%side, y, u(1), rate)
      u(2) = tip_deflection(equation%beam, y)
      u(3) = wall_drift(equation, y(1)) + tip_displacement(equation, y)/equation%beam%length
   end function top_displacements

   !> Compute the displacements with their derivatives.
   subroutine evaluate_top(self, t, y, f)
      class(top_motion_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y)), arm

      associate (equation => self%step%equation, beam => self%step%equation%beam, &
                 sine => sin(y(1)), cosine => cos(y(1)))
         allocate (f(top_count, 0:self%derivatives))
         f(:, 0) = top_displacements(equation, y)
         call frame_motion(equation, equation%state%side, y, f(1, 0), f(1, 1))
         f(2, 1) = tip_rate(beam, y)
         ! distance from the axis to the pivot
         arm = equation%state%side*beam%half_width
         f(3, 1) = tip_velocity(equation, y)/beam%length + (cosine + arm/beam%length*sine)*y(2)
         if (self%derivatives < 2) return
         call rates_at(equation, t, y, y_dot)
         f(1, 2) = frame_acceleration(equation, equation%state%side, y, y_dot)
         f(2, 2) = tip_rate(beam, y_dot)
         f(3, 2) = tip_acceleration(equation, y, y_dot)/beam%length + (cosine + arm/beam%length &
            *sine)*y_dot(2) + (arm/beam%length*cosine - sine)*y(2)**2
      end associate
   end subroutine evaluate_top

end module rwmf_simulation_recorder_top_motion
