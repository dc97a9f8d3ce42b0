!> What springs with memory tell: their forces, and what yielding and rupture leave behind.
module rwmf_memory_query
   use rwmf_kinds, only: wp
   use rwmf_memory, only: elongation_of, moves
   use rwmf_scene, only: equation_t, place_frame, place_left, place_right
   use rwmf_spring, only: is_broken, spring_force, spring_plastic, spring_t, turn_spring
   implicit none
   private

   public :: spring_forces, spring_columns, tendon_is_broken, prestress_loss, frame_residual
   public :: frame_force_column, fuse_push

   character(*), parameter :: frame_force_column = 'frame_force_over_m_s_g'
   !! of every law

contains

   !> Forces of frame and fuses, over the weight of m_s and of m_w, in the order of
   !> `spring_columns` [-].
   function spring_forces(equation, theta) result(forces)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp) :: forces(size(equation%springs))
      real(wp) :: x
      integer :: i

      do i = 1, size(forces)
         x = 0
         if (moves(equation, equation%springs(i)%place)) then
            x = elongation_of(equation, i, equation%side*theta)
         end if
         forces(i) = spring_force(equation%springs(i)%spring, x)/equation%p%g
      end do
      if (equation%has_impacts .or. size(forces) < 2) return
      ! under a hinged wall the right fuse, which comes last, mirrors the left one
      i = size(forces)
      if (equation%springs(i)%place == place_right) forces(i) = -forces(i - 1)
   end function spring_forces

   !> Force with which both fuses push a rocking wall up, over m_w g [-].
   real(wp) function fuse_push(equation, theta) result(push)
      type(equation_t), intent(in) :: equation
      !! with fuses
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: forces(size(equation%springs))
      integer :: n

      ! the fuses come last
      n = size(forces)
      forces = spring_forces(equation, theta)
      push = -sum(forces(n - 1:))
   end function fuse_push

   !> Names of the columns of these forces in a history.
   pure function spring_columns(equation) result(names)
      type(equation_t), intent(in) :: equation
      character(32) :: names(size(equation%springs))
      integer :: i

      do i = 1, size(names)
         select case (equation%springs(i)%place)
         case (place_frame)
            names(i) = frame_force_column
         case (place_left)
            names(i) = 'fuse_left_force_over_m_w_g'
         case default
            names(i) = 'fuse_right_force_over_m_w_g'
         end select
      end do
   end function spring_columns

   !> Has the tendon broken?
   pure logical function tendon_is_broken(equation)
      type(equation_t), intent(in) :: equation

      tendon_is_broken = equation%cable%is_tendon .and. is_broken(equation%cable%tendon)
   end function tendon_is_broken

   !> What the tendon has lost of its force at theta = 0, over m_w g [-].
   real(wp) function prestress_loss(equation, theta) result(loss)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! present rotation [rad]
      type(spring_t) :: tendon

      tendon = equation%cable%tendon
      call turn_spring(tendon, elongation_of(equation, 0, equation%side*theta))
      loss = equation%cable%eta_0 - max(0.0_wp, spring_force(tendon, 0.0_wp))
   end function prestress_loss

   !> Plastic displacement of the frame at a state [m].
   real(wp) function frame_residual(equation, theta) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      integer :: i

      residual = 0
      do i = 1, size(equation%springs)
         if (equation%springs(i)%place /= place_frame) cycle
         residual = spring_plastic(equation%springs(i)%spring, &
            elongation_of(equation, i, equation%side*theta))
      end do
   end function frame_residual

end module rwmf_memory_query
