!> Support of a wall by springs instead of the ground: by fuses, couplings or restraints.
module rwmf_simulation_events_wall_support
   use rwmf_core_error, only: err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, narrow
   use rwmf_model_elements, only: element_force, of_coupling, of_fuse, of_restraint
   use rwmf_model_equation, only: cable_force_at, equation_t
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: check_support, ends_on_elements, may_stand_on_elements

contains

   !> Fail at the first time in the step at which springs take a wall off the ground.
   !>
   !> After yielding in tension, fuses push the corners up on the way back. A wall that they hold up
   !> at one corner rocks on the other. If they exceed weight and cable force, they lift the wall
   !> off both corners. Couplings push one of the outer walls up and pull the other one down.
   subroutine check_support(equation, piece, error)
      type(equation_t), intent(in) :: equation
      type(step_view_t), intent(in) :: piece
      !! up to the end of the step, or up to the event that ends it
      type(error_t), allocatable, intent(out) :: error
      type(bracket_t) :: bracket
      real(wp) :: y(equation%n)

      if (.not. may_stand_on_elements(equation)) return
      if (.not. stands_on_elements(equation, piece%y_b(1))) return
      bracket = bracket_between(piece%t_a, piece%t_b)
      do while (bracket%is_open)
         call piece%integrator%state_at(bracket%middle, y, error)
         if (allocated(error)) return
         call narrow(bracket, stands_on_elements(equation, y(1)))
      end do
      call fail(error, err_numerical, 'the wall stands on its fuses, couplings or restraints at ' &
         //'t = '//trim(real_to_text(bracket%high))//' s: together they push it up with more ' &
         //'than weight and cable, and no corner stays on the ground, which is not in the model; ' &
         //'fuses whose eta_y have the sum 1 + eta_0 or less never do that while the cable keeps ' &
         //'its prestress', 'wall_on_fuses')
   end subroutine check_support

   !> Return whether the wall stands on springs at the end of a step. A step beyond the base ends
   !> with an impact.
   logical function ends_on_elements(step)
      type(step_view_t), intent(in) :: step

      associate (equation => step%equation, side => step%equation%state%side)
         ends_on_elements = may_stand_on_elements(equation)
         if (ends_on_elements) ends_on_elements = stands_on_elements(equation, side*max(0.0_wp, &
            side*step%y_b(1)))
      end associate
   end function ends_on_elements

   !> Return whether springs may lift the wall off the ground. The forces of fuses grow with their
   !> strokes, so a check at theta = 0 excludes most cases with fuses alone.
   pure logical function may_stand_on_elements(equation) result(may_stand)
      type(equation_t), intent(in) :: equation
      real(wp) :: push
      integer :: i

      may_stand = .false.
      if (.not. (equation%may_hold .and. equation%has_impacts)) return
      may_stand = any(equation%elements%group == of_coupling .or. equation%elements%group &
         == of_restraint .or. (equation%elements%group == of_fuse &
         .and. abs(equation%elements%offset) > equation%p%R*equation%p%sin_alpha))
      if (may_stand) return
      push = 0
      do i = 1, size(equation%elements)
         if (equation%elements(i)%group == of_fuse) push = push &
            - equation%state%springs(equation%elements(i)%spring)%offset
      end do
      may_stand = push > equation%p%g
   end function may_stand_on_elements

   !> Return whether springs push one of the walls up with more than weight and cable force, beyond
   !> round-off.
   pure logical function stands_on_elements(equation, theta) result(stands)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: force, push(2)
      !! push at the leftmost and the rightmost wall [m/s2]
      integer :: i

      push = 0
      associate (side => equation%state%side)
         do i = 1, size(equation%elements)
            associate (element => equation%elements(i))
               force = element_force(element, equation%state%springs, side, side*theta, 0.0_wp)
               select case (element%group)
               case (of_fuse)
                  push = push - force
               case (of_coupling)
                  push = push + [1, -1]*force
               case (of_restraint)
                  if (element%offset < 0 .or. equation%walls == 1) push(1) = push(1) - force
                  if (element%offset > 0 .or. equation%walls == 1) push(2) = push(2) - force
               case default
                  ! tendons pull down; dampers are left out
               end select
            end associate
         end do
         stands = maxval(push) > equation%p%g*(1 + cable_force_at(equation, theta, side)) &
            *(1 + sqrt(epsilon(theta)))
      end associate
   end function stands_on_elements

end module rwmf_simulation_events_wall_support
