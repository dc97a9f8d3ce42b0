!> Fuses that together lift a wall off both corners, which is not in the model.
module rwmf_simulation_events_fuse_support
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_equation, only: cable_at, equation_t
   use rwmf_model_hysteresis_spring_set, only: fuse_uplift
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: check_fuses, ends_on_fuses, may_stand_on_fuses

contains

   !> Fail at the first time in the step at which the wall rests on its fuses.
   !>
   !> After yielding in tension, fuses push both corners up on the way back. A wall that one fuse
   !> holds up at one corner rocks on the other corner. If both fuses together exceed weight and
   !> cable force, they lift the wall off both corners.
   subroutine check_fuses(equation, piece, error)
      type(equation_t), intent(in) :: equation
      type(step_view_t), intent(in) :: piece
      !! up to the end of the step, or up to the event that ends it
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      real(wp) :: y(equation%n)

      if (.not. may_stand_on_fuses(equation)) return
      if (.not. stands_on_fuses(equation, piece%y_b(1))) return
      bracket = bracket_between(piece%t_a, piece%t_b)
      do while (bracket%is_open)
         call piece%integrator%state_at(bracket%middle, y, error)
         if (allocated(error)) return
         call narrow(bracket, stands_on_fuses(equation, y(1)))
      end do
      call fail(error, err_numerical, 'the wall stands on its fuses at t = ' &
         //trim(real_to_text(bracket%high)) &
         //' s: drawn out before, both together push it up with more than weight and cable, and ' &
         //'no corner stays on the ground, which is not in the model; fuses with eta_y <= ' &
         //'(1 + eta_0)/2 never do that while the cable keeps its prestress', 'wall_on_fuses')
   end subroutine check_fuses

   !> Return whether the wall rests on its fuses at the end of a step. A step beyond the base ends
   !> with an impact.
   logical function ends_on_fuses(step)
      type(step_view_t), intent(in) :: step

      associate (equation => step%equation, side => step%equation%state%side)
         ends_on_fuses = may_stand_on_fuses(equation)
         if (ends_on_fuses) ends_on_fuses = stands_on_fuses(equation, side*max(0.0_wp, &
            side*step%y_b(1)))
      end associate
   end function ends_on_fuses

   !> Return whether the fuses may lift the wall off the ground. The fuse forces grow with the
   !> stroke, so the cheap check at theta = 0 excludes most cases.
   pure logical function may_stand_on_fuses(equation)
      type(equation_t), intent(in) :: equation

      may_stand_on_fuses = .false.
      if (.not. equation%has_fuses) return
      may_stand_on_fuses = -sum(equation%state%springs(size(equation%springs) - 1:)%offset) &
         > equation%p%g
   end function may_stand_on_fuses

   !> Return whether the fuse force exceeds weight plus cable force beyond round-off.
   logical function stands_on_fuses(equation, theta)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      type(cable_state_t) :: cable

      cable = cable_at(equation, theta)
      stands_on_fuses = fuse_uplift(equation, theta) > (1 + cable%force)*(1 + sqrt(epsilon(theta)))
   end function stands_on_fuses

end module rwmf_simulation_events_fuse_support
