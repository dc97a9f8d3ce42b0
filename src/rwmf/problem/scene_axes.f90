!> Axes of a spectrum as changes of a scene (period, mass ratio, width of the wall), with their
!> meaning in that scene.
module rwmf_problem_scene_axes
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: has_floors, structure_t
   use rwmf_problem_shear_frame, only: scale_masses
   use rwmf_problem_wall_size, only: block_period, scale_to_period
   implicit none
   private

   public :: axis_t, list_axes, set_axes, share_frame, walls_of

   !> One axis of a scene.
   type :: axis_t
      character(5) :: name = ''
      !! name of its key in `&spectrum`
      character(8) :: column = ''
      !! column of an output
      character(2) :: unit = '1'
      !! '1' for none
      character(140) :: meaning = ''
      !! meaning in this scene, and quantities that follow it
      logical :: is_plain = .true.
      !! it sets one key of the case and changes nothing else
      logical :: has_value = .false.
      !! the scene without the axis has a value
      real(wp) :: value = 0
      !! that value [unit]
   end type axis_t

contains

   !> Set the values of the axes in a structure. Absent values, and values of parts that the
   !> structure does not have, change nothing.
   !>
   !> For storeys, T_s scales all stiffnesses. The mass ratio gamma scales all masses and
   !> stiffnesses, which keeps the period. The width of a block is set first; its size then follows
   !> from 2 pi/p at its slenderness.
   pure subroutine set_axes(structure, T_s, gamma, b)
      class(structure_t), intent(inout) :: structure
      real(wp), intent(in), optional :: T_s
      !! period of the frame, or 2 pi/p of a block [s]
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
         if (has_floors(structure)) call scale_masses(structure%frame%floors, &
            gamma/structure%frame%gamma)
         structure%frame%gamma = gamma
      end if
      if (present(T_s)) structure%frame%T_s = T_s
   end subroutine set_axes

   !> Number of equal walls that share the frame.
   pure integer function walls_of(structure) result(walls)
      class(structure_t), intent(in) :: structure

      walls = 1
      if (allocated(structure%wall)) walls = structure%wall%walls
   end function walls_of

   !> Replace the frame by the part of one of several equal walls: masses and stiffnesses over their
   !> number.
   pure subroutine share_frame(structure)
      class(structure_t), intent(inout) :: structure

      if (.not. allocated(structure%frame)) return
      associate (walls => walls_of(structure))
         if (allocated(structure%frame%gamma)) call set_axes(structure, &
            gamma=structure%frame%gamma/walls)
         if (allocated(structure%frame%k_link)) structure%frame%k_link = structure%frame%k_link &
            /walls
      end associate
   end subroutine share_frame

   !> List the axes of a scene, the slowest axis of a grid first.
   pure subroutine list_axes(structure, axes)
      class(structure_t), intent(in) :: structure
      type(axis_t), allocatable, intent(out) :: axes(:)
      type(axis_t) :: b, gamma, T_s
      character(*), parameter :: scaled = '; all masses and stiffnesses follow'

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
         ! describe period and mass ratio according to the coupling between floors and wall
         if (has_floors(structure)) then
            T_s%is_plain = .false.
            gamma%is_plain = .false.
            T_s%meaning = 'first period of the frame; all stiffnesses follow'
            select case (structure%frame%coupling)
            case ('full')
               gamma%meaning = 'mass of the roof over that of the wall'//scaled
            case ('springs')
               T_s%meaning = 'first period of the frame alone; its stiffnesses follow'
               gamma%meaning = 'mass of all floors over that of the wall; their stiffnesses follow'
            case ('every_floor')
               T_s%meaning = 'period of the frame on a straight line; all stiffnesses follow'
               gamma%meaning = 'mass ratio of the frame on a straight line'//scaled
            case default
               gamma%meaning = 'mass ratio of the first mode of the frame'//scaled
            end select
         end if
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

end module rwmf_problem_scene_axes
