!> Springs with memory in the equation of motion: a branch is a straight line, whose two numbers are
!> kept until it changes.
module rwmf_branches
   use rwmf_kinds, only: wp
   use rwmf_kinematics, only: kinematics_t
   use rwmf_scene, only: equation_t, frame_mass, place_frame, place_left
   use rwmf_spring, only: spring_force, spring_tangent
   implicit none
   private

   public :: add_fuses, add_springs, add_yielding, follow_branches

contains

   !> Part of the yielding frame in the equation of motion, beyond the elastic one that is in the
   !> equation already.
   subroutine add_yielding(equation, t, y, kin, inertia, moment, y_dot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp), intent(inout) :: y_dot(equation%n)

      associate (p => equation%p)
         moment = moment + frame_mass(equation)*kin%lever*((p%omega_squared &
            - equation%frame_slope)*kin%u - equation%side*equation%frame_offset/p%R)
      end associate
   end subroutine add_yielding

   !> Part of the fuses in the equation of motion: of the one whose corner lifts.
   subroutine add_fuses(equation, t, y, kin, inertia, moment, y_dot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp), intent(inout) :: y_dot(equation%n)
      integer :: n

      ! the fuses come last, left and right
      n = size(equation%springs)
      if (equation%side == place_left) n = n - 1
      associate (fuse => equation%springs(n), R => equation%p%R)
         moment = moment - 2*equation%sin_alpha*kin%half_cosine*(fuse%offset/R &
            + 4*equation%sin_alpha*kin%half_sine*fuse%slope)
      end associate
   end subroutine add_fuses

   !> Both.
   subroutine add_springs(equation, t, y, kin, inertia, moment, y_dot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp), intent(inout) :: y_dot(equation%n)

      call add_yielding(equation, t, y, kin, inertia, moment, y_dot)
      call add_fuses(equation, t, y, kin, inertia, moment, y_dot)
   end subroutine add_springs

   !> Straight lines of the branches that are in force; to be called when one has changed.
   subroutine follow_branches(equation)
      type(equation_t), intent(inout) :: equation
      integer :: i

      if (.not. equation%has_memory) return
      if (any(equation%springs%place == place_frame)) then
         equation%frame_offset = 0
         equation%frame_slope = 0
      end if
      do i = 1, size(equation%springs)
         associate (sprung => equation%springs(i))
            sprung%offset = spring_force(sprung%spring, 0.0_wp)
            sprung%slope = spring_tangent(sprung%spring)
            if (sprung%place == place_frame) then
               equation%frame_offset = equation%frame_offset + sprung%offset
               equation%frame_slope = equation%frame_slope + sprung%slope
            end if
         end associate
      end do
      associate (cable => equation%cable)
         if (.not. cable%is_tendon .or. cable%is_straight) return
         cable%line_0 = spring_force(cable%tendon, 0.0_wp)
         cable%line_rate = spring_tangent(cable%tendon)*cable%b
      end associate
   end subroutine follow_branches

end module rwmf_branches
