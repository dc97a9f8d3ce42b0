!> What springs with memory tell: their forces, and what yielding and rupture leave behind.
module rwmf_memory_query
   use rwmf_kinds, only: wp
   use rwmf_memory, only: elongation_of, moves
   use rwmf_scene, only: equation_t, place_frame, place_left, place_right
   use rwmf_spring, only: is_broken, spring_force, spring_plastic, spring_t, turn_spring
   implicit none
   private

   public :: spring_forces, spring_columns, tendon_is_broken, prestress_loss, frame_residual
   public :: frame_residuals, foot_residual
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
      real(wp), allocatable :: forces(:)
      real(wp) :: force(size(equation%springs))
      real(wp) :: x
      integer :: i

      do i = 1, size(force)
         x = 0
         if (moves(equation, equation%springs(i)%place)) then
            x = elongation_of(equation, i, equation%side*theta)
         end if
         force(i) = spring_force(equation%springs(i)%spring, x)/equation%p%g
      end do
      ! under a hinged wall the right fuse, which comes last, mirrors the left one
      i = size(force)
      if (.not. equation%has_impacts .and. i > 1) then
         if (equation%springs(i)%place == place_right) force(i) = -force(i - 1)
      end if
      associate (of_frame => equation%springs%place == place_frame)
         forces = pack(force, .not. of_frame)
         if (any(of_frame)) forces = [sum(force, of_frame), forces]
      end associate
   end function spring_forces

   !> Force with which both fuses push a rocking wall up, over m_w g [-].
   real(wp) function fuse_push(equation, theta) result(push)
      type(equation_t), intent(in) :: equation
      !! with fuses
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp), allocatable :: forces(:)

      ! the fuses come last
      forces = spring_forces(equation, theta)
      push = -sum(forces(size(forces) - 1:))
   end function fuse_push

   !> Names of the columns of these forces in a history; springs of the frame have one together.
   pure function spring_columns(equation) result(names)
      type(equation_t), intent(in) :: equation
      character(32), allocatable :: names(:)
      integer :: i

      allocate (names(0))
      if (any(equation%springs%place == place_frame)) names = [character(32) :: frame_force_column]
      do i = 1, size(equation%springs)
         select case (equation%springs(i)%place)
         case (place_left)
            names = [character(32) :: names, 'fuse_left_force_over_m_w_g']
         case (place_right)
            names = [character(32) :: names, 'fuse_right_force_over_m_w_g']
         case default
            ! the frame's, named above
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

   !> Displacement of the frame that elastic unloading to no force would leave [m].
   real(wp) function frame_residual(equation, theta) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]

      residual = 0
      if (allocated(equation%parts)) residual = sum(equation%parts*frame_residuals(equation, theta))
   end function frame_residual

   !> The same of the lowest storey, as a displacement of the roof: where storeys yield one by one
   !> it is not that of the frame [m].
   real(wp) function foot_residual(equation, theta) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp), allocatable :: residuals(:)

      residual = 0
      if (.not. allocated(equation%parts)) return
      residuals = frame_residuals(equation, theta)
      residual = residuals(1)
   end function foot_residual

   !> The same of each spring of the frame by itself [m].
   function frame_residuals(equation, theta) result(residuals)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta
      !! [rad] or [m]
      real(wp), allocatable :: residuals(:)
      !! (springs of the frame)
      integer :: i

      residuals = pack([(spring_plastic(equation%springs(i)%spring, elongation_of(equation, i, &
         equation%side*theta)), i=1, size(equation%springs))], &
         equation%springs%place == place_frame)
   end function frame_residuals

end module rwmf_memory_query
