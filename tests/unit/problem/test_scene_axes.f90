!> Effect of the axes period, mass ratio and width on a frame, on storeys and on a block.
program test_scene_axes
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t, frame_t, wall_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_scene_axes, only: axis_t, list_axes, set_axes
   implicit none

   real(wp), parameter :: tolerance = 1.0e-14_wp
   type(checks_t) :: checks

   if (checks%wants('frame')) call check_frame()
   if (checks%wants('storeys')) call check_storeys('reduced')
   if (checks%wants('storeys')) call check_storeys('every_floor')
   if (checks%wants('storeys')) call check_storeys('full')
   if (checks%wants('storeys')) call check_storeys('springs')
   if (checks%wants('block')) call check_block()
   if (checks%wants('pinned')) call check_pinned()
   call checks%finish()

contains

   !> A wall, with or without a frame.
   function scene(has_frame) result(case)
      logical, intent(in) :: has_frame
      type(case_t) :: case

      case%wall = wall_t(h=3.0_wp, b=0.75_wp)
      case%model%g = 9.81_wp
      if (has_frame) case%frame = frame_t(T_s=0.8_wp, gamma=5.0_wp, xi_s=0.05_wp)
   end function scene

   !> Compare number by number.
   subroutine check_list(actual, expected, name, rtol)
      real(wp), intent(in) :: actual(:)
      real(wp), intent(in) :: expected(:)
      character(*), intent(in) :: name
      real(wp), intent(in) :: rtol
      integer :: i

      do i = 1, size(expected)
         call checks%close_to(actual(i), expected(i), name, rtol=rtol)
      end do
   end subroutine check_list

   !> Names of axes with blanks between them.
   function names_of(axes) result(names)
      type(axis_t), intent(in) :: axes(:)
      character(:), allocatable :: names
      integer :: i

      names = ''
      do i = 1, size(axes)
         names = names//trim(axes(i)%name)//' '
      end do
   end function names_of

   !> Each axis sets one number.
   subroutine check_frame()
      type(case_t) :: case
      type(axis_t), allocatable :: axes(:)

      case = scene(.true.)
      call set_axes(case, T_s=1.5_wp, gamma=0.0_wp, b=1.0_wp)
      call list_axes(case, axes)
      call checks%that(names_of(axes) == 'b gamma T_s ', 'axes of wall and frame')
      call checks%that(all(axes%has_value) .and. all(axes%is_plain), 'they are plain')
      call check_list(axes%value, [1.0_wp, 0.0_wp, 1.5_wp], 'what is set', rtol=0.0_wp)
      call checks%close_to(case%wall%h, 3.0_wp, 'the height stays', rtol=0.0_wp)
      deallocate (case%wall, case%frame%gamma, case%frame%T_s)
      call set_axes(case, gamma=2.0_wp, b=2.0_wp)
      call list_axes(case, axes)
      call checks%that(names_of(axes) == 'T_s ' .and. .not. axes(1)%has_value, 'frame alone')
      call checks%that(.not. allocated(case%frame%gamma), 'it gets no mass ratio')
   end subroutine check_frame

   !> Lists that are scaled by hand give the same mass ratio and modes as the axes.
   subroutine check_storeys(coupling)
      character(*), intent(in) :: coupling
      type(case_t) :: case, by_hand
      type(error_t), allocatable :: error
      type(axis_t), allocatable :: axes(:)
      real(wp), parameter :: factor = 2.5_wp
      real(wp) :: T_s

      case = scene(.true.)
      allocate (case%frame%floors)
      case%frame%coupling = coupling
      case%frame%floors%m = [1.0_wp, 1.5_wp, 0.7_wp]
      case%frame%floors%k = [900.0_wp, 700.0_wp, 300.0_wp]
      case%frame%floors%height = [2.5_wp, 2.0_wp, 1.5_wp]
      by_hand = case
      by_hand%frame%floors%m = factor*case%frame%floors%m
      by_hand%frame%floors%k = factor*case%frame%floors%k
      call set_equivalent_frame(case, error)
      call checks%no_error(error, 'modes')
      call set_equivalent_frame(by_hand, error)
      call checks%no_error(error, 'modes by hand')
      T_s = case%frame%T_s
      call set_axes(case, gamma=factor*case%frame%gamma)
      call checks%close_to(by_hand%frame%gamma, case%frame%gamma, coupling//': mass ratio', &
         rtol=tolerance)
      call checks%close_to(by_hand%frame%T_s, T_s, coupling//': the period stays', rtol=tolerance)
      call check_list(case%frame%floors%m, by_hand%frame%floors%m, 'masses', rtol=tolerance)
      call check_list(case%frame%floors%k, by_hand%frame%floors%k, 'stiffnesses', &
         rtol=tolerance)
      call check_list(abs(case%frame%floors%shape(:, 1)), &
         abs(by_hand%frame%floors%shape(:, 1)), 'first mode', rtol=1.0e-12_wp)
      call set_axes(case, T_s=2.0_wp)
      call list_axes(case, axes)
      call checks%that(names_of(axes) == 'b gamma T_s ', coupling//': axes')
      call checks%that(.not. any(axes(2:)%is_plain), coupling//': more follows than a key')
      call checks%close_to(axes(3)%value, 2.0_wp, coupling//': period', rtol=0.0_wp)
   end subroutine check_storeys

   !> The axes T_s = 2 pi/p, p**2 = 3 g/(4 R), and b set size and slenderness of a block; the period
   !> that it has leaves it unchanged.
   subroutine check_block()
      type(case_t) :: case
      type(axis_t), allocatable :: axes(:)
      real(wp), parameter :: T = 5.0_wp
      real(wp) :: R

      case = scene(.false.)
      call list_axes(case, axes)
      call checks%that(names_of(axes) == 'b T_s ', 'axes of a block')
      R = hypot(3.0_wp, 0.75_wp)
      call checks%close_to(axes(2)%value, 2*pi/sqrt(3*9.81_wp/(4*R)), '2 pi/p', rtol=tolerance)
      call set_axes(case, T_s=axes(2)%value)
      call check_list([case%wall%h, case%wall%b], [3.0_wp, 0.75_wp], 'its own period', &
         rtol=0.0_wp)
      call set_axes(case, T_s=T, b=1.5_wp)
      call checks%close_to(case%wall%b/case%wall%h, 0.5_wp, 'slenderness of width and height', &
         rtol=tolerance)
      R = hypot(case%wall%h, case%wall%b)
      call checks%close_to(R, 3*9.81_wp/4*(T/(2*pi))**2, 'size of the period', rtol=tolerance)
      call list_axes(case, axes)
      call checks%close_to(axes(2)%value, T, 'period of the size', rtol=tolerance)
   end subroutine check_block

   !> A hinged wall without a frame has no period.
   subroutine check_pinned()
      type(case_t) :: case
      type(axis_t), allocatable :: axes(:)

      case = scene(.false.)
      case%wall%base = 'pinned'
      call list_axes(case, axes)
      call checks%that(names_of(axes) == 'b ', 'axes of a hinged wall')
   end subroutine check_pinned

end program test_scene_axes
