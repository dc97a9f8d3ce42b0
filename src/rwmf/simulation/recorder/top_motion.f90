!> Largest displacement of the frame and largest deflection of a wall that bends: unlike those of a
!> rigid wall they do not belong to the turns of theta.
module rwmf_simulation_recorder_top_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_assembly, only: rates_at
   use rwmf_model_beam, only: tip_deflection, tip_rate
   use rwmf_model_equation, only: equation_t, frame_acceleration, frame_motion
   use rwmf_simulation_events_storey_events, only: displacements_t
   implicit none
   private

   public :: top_motion_t, top_displacements

   !> Displacement of the frame and deflection of the top [m], with two derivatives.
   type, extends(displacements_t) :: top_motion_t
   contains
      procedure :: evaluate => evaluate_top
   end type top_motion_t

contains

   !> Displacement of the frame and deflection of the top [m].
   pure function top_displacements(equation, y) result(u)
      type(equation_t), intent(in) :: equation
      !! with a wall that bends
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u(2)
      real(wp) :: rate

      call frame_motion(equation, equation%state%side, y, u(1), rate)
      u(2) = tip_deflection(equation%beam, y)
   end function top_displacements

   subroutine evaluate_top(self, t, y, f)
      class(top_motion_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: f(:, :)
      real(wp) :: y_dot(size(y))

      associate (equation => self%step%equation)
         allocate (f(2, 0:self%derivatives))
         call frame_motion(equation, equation%state%side, y, f(1, 0), f(1, 1))
         f(2, :1) = [tip_deflection(equation%beam, y), tip_rate(equation%beam, y)]
         if (self%derivatives < 2) return
         call rates_at(equation, t, y, y_dot)
         f(:, 2) = [frame_acceleration(equation, equation%state%side, y, y_dot), &
            tip_rate(equation%beam, y_dot)]
      end associate
   end subroutine evaluate_top

end module rwmf_simulation_recorder_top_motion
