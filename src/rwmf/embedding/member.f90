!> The rocking wall as a member of a host program: an element with memory.
!>
!> Its degrees of freedom are u, the displacement of the straight wall at the link, then q_i of
!> `&bending`, then the floors on link springs of `&storeys`. The host integrates all of them; a
!> member is algebraic in their motion and remembers the side on which the wall rocks, u, and the
!> branches of its springs.
!>
!> A response leaves the committed state as it is. Its trial state follows from the committed one
!> alone, along the straight path in u; so no sequence of trials changes the committed path.
!> Assignment copies a member with its state.
module rwmf_embedding_member
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_math_cantilever, only: deflection
   use rwmf_model_equation, only: discrete_state_t, equation_t
   use rwmf_model_hysteresis_spring_set, only: broken_tendons, pass_window, renew_window, &
      turn_back
   use rwmf_model_impact_rule, only: impact_law
   use rwmf_model_restitution, only: restitution_t
   use rwmf_model_system_assembly, only: build_equation, enter_side
   use rwmf_motion_ground_motion, only: motion_t, piecewise_linear_motion
   use rwmf_problem_case, only: case_t, copy_without_frame, list_links, upward_ratio
   use rwmf_problem_single_run, only: check_corners
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: wall_member_t, member_info_t, place_t
   public :: create_member, query_member, commit_member, revert_member, restart_member
   public :: place_member, require_member, require_on_base, follow_path

   !> Position of the wall, committed or tried.
   type :: place_t
      integer :: side = 0
      !! +1 or -1 while the wall rocks, 0 at rest; +1 for a hinged wall
      real(wp) :: u = 0
      !! displacement of the straight wall at the link [m]
      real(wp) :: theta = 0
      !! rotation [rad]
   end type place_t

   !> Wall and cable without frame, with the links to the frame of the host. The components are
   !> those of `rwmf_embedding_member` and its companions.
   type :: wall_member_t
      type(equation_t) :: equation
      !! equation of the wall alone; its discrete state is the tried one
      real(wp) :: m_w = 0
      !! mass of the wall [kg]; 0 before creation
      real(wp) :: vertical_ratio = 0
      !! ratio of the vertical to the horizontal ground acceleration [-]
      logical :: takes_vertical = .false.
      !! the host hands over the vertical ground acceleration
      type(restitution_t) :: restitution
      !! velocity factor of impacts, for rules other than 'coupled'
      logical :: balances = .false.
      !! rule 'coupled': velocities after an impact follow from the balance of momentum
      real(wp) :: largest_angle = 0
      !! rotation at which the wall counts as overturned [rad]
      integer :: n = 0
      !! number of degrees of freedom
      real(wp), allocatable :: share(:)
      !! (links) height of each link over that of the wall [-]
      real(wp), allocatable :: phi(:, :)
      !! (links, modes) deflection of each mode at each link [-]
      real(wp), allocatable :: k_link(:)
      !! (links) stiffness of the link springs [N/m]; not allocated with rigid links
      real(wp), allocatable :: frame_mass(:)
      !! (links) masses of the case that move with the wall at an impact [kg]
      type(place_t) :: tried
      type(place_t) :: committed
      type(discrete_state_t) :: committed_state
      type(discrete_state_t) :: first_state
      !! state after creation
   end type wall_member_t

   !> Sizes and committed state of a member.
   type :: member_info_t
      integer :: dofs = 0
      !! degrees of freedom
      integer :: modes = 0
      !! modes of `&bending`
      integer :: floors = 0
      !! floors on link springs
      integer :: links = 0
      !! links between wall and host: 1, or one for each floor
      integer :: side = 0
      !! +1 or -1 while the wall rocks, 0 at rest; +1 for a hinged wall
      logical :: is_broken = .false.
      !! the tendon has broken
      real(wp) :: u = 0
      !! displacement of the straight wall at the link [m]
   end type member_info_t

contains

   !> Create a member from a case with `&wall`, at rest or hinged, with springs that have not moved.
   !>
   !> The frame is the host's: of `&frame` and `&storeys` only the links and the masses for the rule
   !> 'coupled' apply. Fails with `err_input`.
   subroutine create_member(member, case, error)
      type(wall_member_t), intent(out) :: member
      type(case_t), intent(in) :: case
      !! valid case
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: wall_alone
      type(motion_t), target :: none
      integer :: i, j

      if (.not. allocated(case%wall)) then
         call fail(error, err_input, 'a member needs the group &wall')
      else
         call check_corners(case, 'a member of a host', error)
      end if
      if (allocated(error)) return
      member%takes_vertical = ieee_is_nan(upward_ratio(case))
      if (.not. member%takes_vertical) member%vertical_ratio = upward_ratio(case)
      call copy_without_frame(case, wall_alone)
      none = piecewise_linear_motion([real(wp) ::], [real(wp) ::])
      call build_equation(wall_alone, none, member%equation)
      member%equation%motion => null()
      ! the rates of the modes are then those without rotation
      member%equation%state%coef(1, 1) = 0
      member%m_w = 1
      if (allocated(case%wall%m_w)) member%m_w = case%wall%m_w
      member%largest_angle = case%model%overturning_angle
      ! set the links to the frame of the host: one at the top, or one for each floor
      call list_links(case, member%share, member%k_link, member%frame_mass)
      member%frame_mass = member%m_w*member%frame_mass
      member%n = 1 + member%equation%beam%n
      if (allocated(member%k_link)) then
         member%k_link = member%m_w*member%k_link
         member%n = member%n + size(member%k_link)
      end if
      allocate (member%phi(size(member%share), member%equation%beam%n))
      do j = 1, member%equation%beam%n
         do i = 1, size(member%share)
            member%phi(i, j) = deflection(member%equation%beam%modes(j), member%share(i))
         end do
      end do
      ! set the rule of impacts
      member%restitution = impact_law(case, member%equation%p%alpha)
      member%balances = case%impact%rule == 'coupled'
      if (.not. member%equation%has_impacts) member%tried%side = 1
      member%first_state = member%equation%state
      member%committed_state = member%first_state
      member%committed = member%tried
   end subroutine create_member

   !> Return sizes and committed state.
   subroutine query_member(member, info, error)
      type(wall_member_t), intent(in) :: member
      type(member_info_t), intent(out) :: info
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a member never created

      call require_member(member, error)
      if (allocated(error)) return
      info = member_info_t(member%n, member%equation%beam%n, 0, size(member%share), &
         member%committed%side, broken_tendons( &
         member%committed_state) > 0, member%committed%u)
      if (allocated(member%k_link)) info%floors = size(member%k_link)
   end subroutine query_member

   !> Check that a member has been created. An earlier `error` is kept.
   pure subroutine require_member(member, error)
      type(wall_member_t), intent(in) :: member
      type(error_t), allocatable, intent(inout) :: error
      !! `err_input` if it has not

      if (allocated(error) .or. member%m_w > 0) return
      call fail(error, err_input, 'no member: it was never created')
   end subroutine require_member

   !> Keep the state of the last response.
   subroutine commit_member(member, error)
      type(wall_member_t), intent(inout) :: member
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a member never created

      call require_member(member, error)
      if (allocated(error)) return
      member%committed = member%tried
      member%committed_state = member%equation%state
   end subroutine commit_member

   !> Return to the committed state.
   subroutine revert_member(member, error)
      type(wall_member_t), intent(inout) :: member
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a member never created

      call require_member(member, error)
      if (allocated(error)) return
      member%tried = member%committed
      member%equation%state = member%committed_state
   end subroutine revert_member

   !> Return to the state after creation.
   subroutine restart_member(member, error)
      type(wall_member_t), intent(inout) :: member
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a member never created

      call require_member(member, error)
      if (allocated(error)) return
      member%committed = place_t(merge(0, 1, member%equation%has_impacts))
      member%committed_state = member%first_state
      call revert_member(member, error)
   end subroutine restart_member

   !> Set the side of a wall that is committed on its base: +1 or -1 after a lift-off or an impact,
   !> 0 for rest.
   !>
   !> The springs pass through u = 0. A trial state is forgotten.
   subroutine place_member(member, side, error)
      type(wall_member_t), intent(inout) :: member
      integer, intent(in) :: side
      !! +1, -1 or 0
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a hinged wall, another side, or a wall away from its base

      call require_on_base(member, error)
      if (allocated(error)) return
      if (abs(side) > 1) then
         call fail(error, err_input, 'the side of a wall is 1 or -1, or 0 at rest, not ' &
            //trim(integer_to_text(side)))
         return
      end if
      call revert_member(member, error)
      ! move the tried state of a wall near its base to u = 0 and to a side
      associate (model => member%equation%model_t, state => member%equation%state)
         if (member%tried%side /= 0) then
            call follow_path(member%equation, state, member%tried%theta, 0.0_wp, -member%tried%side)
            call turn_back(model, state, 0.0_wp, goes_on=side /= 0)
         end if
         if (side /= 0) call enter_side(model, state, side)
         call renew_window(model, state)
      end associate
      member%tried = place_t(side)
      call commit_member(member, error)
   end subroutine place_member

   !> Check that a rocking wall is committed at u = 0.
   subroutine require_on_base(member, error)
      type(wall_member_t), intent(in) :: member
      type(error_t), allocatable, intent(out) :: error
      !! `err_input` for a hinged wall, a wall away from its base, or before creation
      real(wp), parameter :: near = 1.0e-6_wp
      !! displacement that counts as zero, over R [-]

      call require_member(member, error)
      if (allocated(error)) return
      if (.not. member%equation%has_impacts) then
         call fail(error, err_input, 'a hinged wall has no sides')
      else if (abs(member%committed%u) > near*member%equation%p%R) then
         call fail(error, err_input, 'the wall is not on its base: the committed u = ' &
            //trim(real_to_text(member%committed%u))//' m, allowed are at most ' &
            //trim(real_to_text(near*member%equation%p%R))//' m')
      end if
   end subroutine require_on_base

   !> Follow the branches of the springs from one rotation to another on the present side. A branch
   !> that ends at the final rotation is left: the next one holds from there on.
   subroutine follow_path(equation, state, begin, end, direction)
      type(equation_t), intent(in) :: equation
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: begin, end
      !! [rad]
      integer, intent(in) :: direction
      !! sign of the motion of theta; 0: none, the branches stay
      real(wp) :: limit, passed

      if (.not. equation%has_bilinear_springs .or. direction == 0) return
      call renew_window(equation%model_t, state)
      call turn_back(equation%model_t, state, begin, onward=direction)
      call renew_window(equation%model_t, state)
      passed = huge(passed)
      do
         limit = merge(state%high, state%low, direction > 0)
         if (direction*(end - limit) < 0) return
         ! a branch of no length ends where it begins
         if (abs(limit - end) <= 0 .and. abs(limit - passed) <= 0) return
         passed = limit
         call pass_window(equation%model_t, state, is_rising=direction > 0)
      end do
   end subroutine follow_path

end module rwmf_embedding_member
