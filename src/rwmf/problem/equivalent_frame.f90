!> Single-degree-of-freedom frame equivalent to the storeys of a case.
module rwmf_problem_equivalent_frame
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_shear_frame, only: enforce_straight_line, find_modes
   implicit none
   private

   public :: set_equivalent_frame, set_single_storey

contains

   !> Find the modes of `&storeys` and set the period and the mass ratio of `&frame` from them.
   !>
   !> The mass ratio refers to the displacement of the roof, which is linked to the wall. With one
   !> mode it is the modal mass 1/phi_n**2. With all modes it is the mass of the roof alone, because
   !> only the deformable storeys connect the lower floors to it. With link springs, no mass moves
   !> with the wall, and it is that of all floors. Fails with `err_numerical`.
   subroutine set_equivalent_frame(case, error)
      type(case_t), intent(inout) :: case
      !! with frame and storeys
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      associate (frame => case%frame%floors)
         n = size(frame%m)
         call find_modes(frame, error)
         if (allocated(error)) return
         if (case%frame%coupling == 'every_floor') call enforce_straight_line(frame)
         case%frame%T_s = 2*pi/frame%omega(1)
         if (.not. allocated(case%wall)) return
         case%frame%gamma = 1/frame%shape(n, 1)**2
         if (case%frame%coupling == 'full') case%frame%gamma = frame%m(n)
         case%frame%is_linked = case%frame%coupling /= 'springs'
         if (.not. case%frame%is_linked) case%frame%gamma = sum(frame%m)
      end associate
   end subroutine set_equivalent_frame

   !> Describe a single mass beside a wall as a frame of one storey as high as the wall, whose roof
   !> is linked to it: the same equation of motion, but its spring follows the displacement of the
   !> roof instead of the rotation. Fails with `err_numerical`.
   subroutine set_single_storey(case, error)
      type(case_t), intent(inout) :: case
      !! with wall and frame, without storeys
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: T_s
      real(wp) :: omega

      ! in a spectrum without its own period, every ordinate scales this frame
      if (allocated(case%frame%T_s)) T_s = case%frame%T_s
      omega = 2*pi
      if (allocated(T_s)) omega = 2*pi/T_s
      allocate (case%frame%floors)
      case%frame%coupling = 'full'
      associate (frame => case%frame%floors)
         frame%m = [case%frame%gamma]
         frame%k = frame%m*omega**2
         frame%height = [2*case%wall%h]
      end associate
      call set_equivalent_frame(case, error)
      if (allocated(error)) return
      deallocate (case%frame%T_s)
      if (allocated(T_s)) case%frame%T_s = T_s
   end subroutine set_single_storey

end module rwmf_problem_equivalent_frame
