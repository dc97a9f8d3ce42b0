!> The axes of a spectrum as changes of a scene: period, mass ratio, width of the wall; and what
!> each of them is in that scene.
module rwmf_problem_scene_axes
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: structure_t
   use rwmf_problem_shear_frame, only: scale_masses
   use rwmf_problem_wall_size, only: block_period, scale_to_period
   implicit none
   private

   public :: axis_t, list_axes, set_axes

   !> An axis of a scene.
   type :: axis_t
      character(5) :: name = ''
      !! of its key in `&spectrum`
      character(8) :: column = ''
      !! of an output
      character(2) :: unit = '1'
      !! '1' for none
      character(140) :: meaning = ''
      !! what it is in this scene, and what it changes
      logical :: is_plain = .true.
      !! it sets a key of the case and nothing else
      logical :: has_value = .false.
      !! the scene has one without the axis
      real(wp) :: value = 0
      !! that it has [unit]
   end type axis_t

contains

   !> Give a structure the values of its axes; what is absent, or belongs to a part that the
   !> structure does not have, stays as it is.
   !>
   !> Of storeys T_s scales all stiffnesses, gamma all masses with the stiffnesses, so that the
   !> period stays. A block, whose width is set first, gets the size of its 2 pi/p at its
   !> slenderness.
   pure subroutine set_axes(structure, T_s, gamma, b)
      class(structure_t), intent(inout) :: structure
      real(wp), intent(in), optional :: T_s
      !! period of the frame, of a block 2 pi/p [s]
      real(wp), intent(in), optional :: gamma
      !! mass ratio of frame and wall [-]; > 0 with storeys
      real(wp), intent(in), optional :: b
      !! half width of the wall [m]

      if (present(b) .and. allocated(structure%wall)) structure%wall%b = b
      if (.not. allocated(structure%frame)) then
         if (present(T_s)) call scale_to_period(structure%wall, structure%model%g, T_s)
         return
      end if
      if (present(gamma) .and. allocated(structure%wall)) then
         if (allocated(structure%storeys)) call scale_masses(structure%storeys%frame, &
            gamma/structure%frame%gamma)
         structure%frame%gamma = gamma
      end if
      if (present(T_s)) structure%frame%T_s = T_s
   end subroutine set_axes

   !> The axes that a scene has, the slowest of a grid first.
   pure subroutine list_axes(structure, axes)
      class(structure_t), intent(in) :: structure
      type(axis_t), allocatable, intent(out) :: axes(:)
      type(axis_t) :: b, gamma, T_s

      b = axis_t('b', 'b_m', 'm', 'half width of the wall')
      gamma = axis_t('gamma', 'gamma', '1', 'mass ratio')
      T_s = axis_t('T_s', 'T_s_s', 's', 'period of the frame')
      if (allocated(structure%wall)) then
         b%has_value = .true.
         b%value = structure%wall%b
         b%is_plain = .not. structure%follows_size
         if (structure%follows_size) b%meaning = trim(b%meaning) &
            //'; with it its mass, and all ratios that follow from masses and forces'
      end if
      if (allocated(structure%frame)) then
         T_s%has_value = allocated(structure%frame%T_s)
         if (T_s%has_value) T_s%value = structure%frame%T_s
         gamma%has_value = allocated(structure%frame%gamma)
         if (gamma%has_value) gamma%value = structure%frame%gamma
         if (allocated(structure%storeys)) call name_axes_of_storeys(structure, T_s, gamma)
         if (structure%follows_size) then
            gamma%is_plain = .false.
            gamma%meaning = trim(gamma%meaning)//'; if not asked for, at the width of the case'
         end if
         axes = [T_s]
         if (b%has_value) axes = [b, gamma, T_s]
      else if (structure%wall%base == 'pinned') then
         axes = [b]
      else
         b%is_plain = .false.
         b%meaning = 'half width of the block; where T_s varies, at the height of the case'
         T_s%is_plain = .false.
         T_s%meaning = '2 pi/p of the block; its size follows, its slenderness stays'
         T_s%has_value = .true.
         T_s%value = block_period(structure%wall, structure%model%g)
         axes = [b, T_s]
      end if
   end subroutine list_axes

   !> What period and mass ratio are follows from how the storeys are linked to the wall.
   pure subroutine name_axes_of_storeys(structure, T_s, gamma)
      class(structure_t), intent(in) :: structure
      type(axis_t), intent(inout) :: T_s
      type(axis_t), intent(inout) :: gamma
      character(*), parameter :: scaled = '; all masses and stiffnesses follow'

      T_s%is_plain = .false.
      gamma%is_plain = .false.
      T_s%meaning = 'first period of the storeys; all stiffnesses follow'
      select case (structure%storeys%coupling)
      case ('full')
         gamma%meaning = 'mass of the roof over that of the wall'//scaled
      case ('every_floor')
         T_s%meaning = 'period of the storeys on a straight line; all stiffnesses follow'
         gamma%meaning = 'mass ratio of the storeys on a straight line'//scaled
      case default
         gamma%meaning = 'mass ratio of the first mode of the storeys'//scaled
      end select
   end subroutine name_axes_of_storeys

end module rwmf_problem_scene_axes
