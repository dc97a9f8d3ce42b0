!> The axes of a spectrum as changes of a scene: period, mass ratio, width of the wall.
module rwmf_problem_scene_axes
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: structure_t
   implicit none
   private

   public :: set_axes

contains

   !> Give a structure the values of its axes; what is absent, or belongs to a part that the
   !> structure does not have, stays as it is.
   pure subroutine set_axes(structure, T_s, gamma, b)
      class(structure_t), intent(inout) :: structure
      real(wp), intent(in), optional :: T_s
      !! period of the frame [s]
      real(wp), intent(in), optional :: gamma
      !! mass ratio of frame and wall [-]
      real(wp), intent(in), optional :: b
      !! half width of the wall [m]

      if (allocated(structure%frame)) then
         if (present(T_s)) structure%frame%T_s = T_s
         if (present(gamma) .and. allocated(structure%wall)) structure%frame%gamma = gamma
      end if
      if (present(b) .and. allocated(structure%wall)) structure%wall%b = b
   end subroutine set_axes

end module rwmf_problem_scene_axes
