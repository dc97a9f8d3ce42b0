!> Rules between the keys and groups of a case file, on top of what the schema says of each alone.
module rwmf_case_rules
   use rwmf_errors, only: err_input, error_t, fail
   use rwmf_given, only: entry_of, get_list, group_of, has_group, has_key, real_of, integer_of, &
      text_of
   use rwmf_kinds, only: wp
   use rwmf_namelist, only: group_t
   use rwmf_schema, only: belongs_to, key_t, keys_of, pulse_kinds
   use rwmf_text, only: integer_to_text, real_to_text
   use rwmf_validation, only: fail_at_entry, fail_at_group
   implicit none
   private

   public :: check_rules

contains

   !> Check the groups of a case against each other.
   !>
   !> Errors: a group without the one it acts on, keys that exclude each other, keys that the
   !> presence of another key or group requires.
   subroutine check_rules(groups, error)
      type(group_t), intent(in) :: groups(:)
      !! have passed `check_groups`
      type(error_t), allocatable, intent(out) :: error

      call check_presence(groups, error)
      if (.not. allocated(error)) call check_frame(groups, error)
      if (.not. allocated(error)) call check_storeys(groups, error)
      if (.not. allocated(error)) call check_impact(groups, error)
      if (.not. allocated(error)) call check_base(groups, error)
      if (.not. allocated(error)) call check_link(groups, error)
      if (.not. allocated(error)) call check_cable(groups, error)
      if (.not. allocated(error)) call check_motion(groups, error)
      if (.not. allocated(error)) call check_initial(groups, error)
      if (.not. allocated(error)) call check_solver(groups, error)
      if (.not. allocated(error)) call check_spectrum(groups, error)
      if (.not. allocated(error)) call check_end(groups, error)
   end subroutine check_rules

   !> Which groups need which others?
   subroutine check_presence(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, 'wall') .and. .not. has_group(groups, 'frame')) then
         call fail(error, err_input, '&wall, &frame: at least one of these groups must be given')
         return
      end if
      call check_needs(groups, 'cable', 'wall', 'a cable holds a wall', error)
      if (.not. allocated(error)) then
         call check_needs(groups, 'impact', 'wall', 'only a wall has impacts', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'link', 'wall', 'a link joins wall and frame', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'damper', 'wall', 'dampers work at corners that lift', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'link', 'frame', 'a link joins wall and frame', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'storeys', 'frame', 'its xi_s damps their modes', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'initial', 'wall', 'theta is the rotation of the wall', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'spectrum', 'frame', 'its periods are those of the frame', &
            error)
      end if
   end subroutine check_presence

   !> A group that is given needs another one.
   subroutine check_needs(groups, group, other, reason, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: other
      character(*), intent(in) :: reason
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, group) .or. has_group(groups, other)) return
      call fail_group(groups, group, 'must not be given without &'//other//' ('//reason//')', error)
   end subroutine check_needs

   !> Mass ratio and period of the frame.
   subroutine check_frame(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, 'frame') .or. has_group(groups, 'storeys')) return
      if (has_group(groups, 'wall') .and. .not. has_key(groups, 'frame', 'gamma')) then
         call fail_group(groups, 'frame', 'the key gamma is missing (mass ratio m_s/m_w): must ' &
            //'be given with &wall, a number >= 0 [-]', error)
      else if (has_key(groups, 'frame', 'gamma') .and. .not. has_group(groups, 'wall')) then
         call fail_key(groups, 'frame', 'gamma', 'must not be given without &wall (the bare ' &
            //'frame has no mass ratio)', error)
      else if (.not. has_key(groups, 'frame', 'T_s') .and. .not. has_group(groups, 'spectrum')) then
         call fail_group(groups, 'frame', 'the key T_s is missing (undamped period): must be ' &
            //'given without &spectrum, a number > 0 [s]', error)
      end if
   end subroutine check_frame

   !> Storeys say what period and mass ratio would say; their lists belong together.
   subroutine check_storeys(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: k(:)
      real(wp), allocatable :: height(:)
      real(wp) :: top
      character(5), parameter :: keys(2) = ['T_s  ', 'gamma']
      integer :: i

      if (.not. has_group(groups, 'storeys')) return
      do i = 1, size(keys)
         if (.not. has_key(groups, 'frame', trim(keys(i)))) cycle
         call fail_key(groups, 'frame', trim(keys(i)), 'must not be given with &storeys, which ' &
            //'set it', error)
         return
      end do
      if (has_key(groups, 'spectrum', 'gamma')) then
         call fail_key(groups, 'spectrum', 'gamma', 'must not be given with &storeys, which ' &
            //'set it', error)
         return
      end if
      call get_list(groups, 'storeys', 'm_over_m_w', m)
      call get_list(groups, 'storeys', 'k_over_m_w', k)
      call get_list(groups, 'storeys', 'height', height)
      if (size(k) /= size(m)) call fail_length('k_over_m_w', size(k))
      if (size(height) /= size(m)) call fail_length('height', size(height))
      if (allocated(error) .or. .not. has_group(groups, 'wall')) return
      top = 2*real_of(groups, 'wall', 'h')
      if (abs(sum(height) - top) <= 1.0e-6_wp*top) return
      call fail_key(groups, 'storeys', 'height', 'their sum is '//real_to_text(sum(height)) &
         //' m, must be the height of the wall that the roof is linked to, 2h = ' &
         //real_to_text(top)//' m', error)

   contains

      subroutine fail_length(key, n)
         character(*), intent(in) :: key
         integer, intent(in) :: n

         call fail_key(groups, 'storeys', key, 'has '//integer_to_text(n)//' values, must have ' &
            //'one for each of the '//integer_to_text(size(m))//' storeys of m_over_m_w', error)
      end subroutine fail_length
   end subroutine check_storeys

   !> Exactly one of e and r for rule 'constant', none for the others.
   subroutine check_impact(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: rule

      if (.not. has_group(groups, 'impact')) return
      rule = text_of(groups, 'impact', 'rule')
      if (rule == 'constant') then
         call check_one_of(groups, 'impact', 'e', 'r', "with rule = 'constant'", error)
      else if (has_key(groups, 'impact', 'e')) then
         call fail_key(groups, 'impact', 'e', "must not be given with rule = '"//rule &
            //"', which sets it", error)
      else if (has_key(groups, 'impact', 'r')) then
         call fail_key(groups, 'impact', 'r', "must not be given with rule = '"//rule &
            //"', which sets it", error)
      end if
   end subroutine check_impact

   !> What a wall hinged in the middle of its base excludes.
   subroutine check_base(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(6), parameter :: excluded(4) = [character(6) :: 'impact', 'cable', 'link', &
         'damper']
      character(60), parameter :: reasons(4) = [character(60) :: &
         'a hinged wall has no impacts', &
         'a straight cable through the hinge is not stretched', &
         'the link of a hinged wall is infinitely long', &
         'the dampers work at corners that lift']
      integer :: i

      if (.not. has_group(groups, 'wall')) return
      if (text_of(groups, 'wall', 'base') /= 'pinned') return
      do i = 1, size(excluded)
         if (.not. has_group(groups, trim(excluded(i)))) cycle
         call fail_group(groups, trim(excluded(i)), "must not be given with &wall base = " &
            //"'pinned' ("//trim(reasons(i))//')', error)
         return
      end do
   end subroutine check_base

   !> The link must stay shorter than vertical: longer than the corner ever rises or sinks.
   subroutine check_link(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: limit
      real(wp) :: travel

      if (.not. has_group(groups, 'link')) return
      if (text_of(groups, 'model', 'formulation') == 'published') then
         call fail_group(groups, 'link', "must not be given with &model formulation = " &
            //"'published' (its default), where the link is infinitely long; 'symmetric' and " &
            //"'exact' allow it", error)
         return
      end if
      limit = real_of(groups, 'model', 'overturning_angle')
      travel = max(2*real_of(groups, 'wall', 'h')*(1 - cos(limit)), &
         2*(hypot(real_of(groups, 'wall', 'h'), real_of(groups, 'wall', 'b')) &
         - real_of(groups, 'wall', 'h')))
      if (real_of(groups, 'link', 'L') > travel) return
      call fail_key(groups, 'link', 'L', 'must be > '//real_to_text(travel)//' m, the travel of ' &
         //'the corner up to the overturning angle', error)
   end subroutine check_link

   !> Cable law and formulation.
   subroutine check_cable(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, 'cable')) return
      if (text_of(groups, 'cable', 'law') == 'truss' &
          .and. text_of(groups, 'model', 'formulation') == 'published') then
         call fail_key(groups, 'cable', 'law', "must be 'linear' with &model formulation = " &
            //"'published' (its default); 'truss' needs 'symmetric' or 'exact'", error)
      end if
   end subroutine check_cable

   !> Keys of the kind of motion, and no others.
   subroutine check_motion(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      type(key_t), allocatable :: keys(:)
      character(:), allocatable :: kind
      integer :: i

      if (.not. has_group(groups, 'motion')) return
      kind = text_of(groups, 'motion', 'kind')
      keys = keys_of('motion')
      do i = 1, size(keys)
         if (belongs_to(keys(i), kind)) cycle
         if (.not. has_key(groups, 'motion', trim(keys(i)%key))) cycle
         call fail_key(groups, 'motion', trim(keys(i)%key), "must not be given with kind = '" &
            //kind//"'", error)
         return
      end do
      if (index(' '//pulse_kinds//' ', ' '//kind//' ') > 0) then
         call check_one_of(groups, 'motion', 'a_max_g', 'v_p', "with kind = '"//kind//"'", error)
         if (allocated(error)) return
         call check_one_of(groups, 'motion', 'omega_p', 'T_p', "with kind = '"//kind//"'", error)
      else if (kind == 'record' .and. .not. has_key(groups, 'motion', 'file')) then
         call fail_group(groups, 'motion', 'the key file is missing: must be the path of the ' &
            //'record in quotes', error)
      end if
   end subroutine check_motion

   !> The start must not be overturned already, for any width of the spectrum.
   subroutine check_initial(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: b(:)
      real(wp) :: limit
      real(wp) :: theta

      if (.not. has_key(groups, 'initial', 'theta_over_alpha')) return
      call get_list(groups, 'spectrum', 'b', b)
      if (.not. allocated(b)) b = [real_of(groups, 'wall', 'b')]
      theta = abs(real_of(groups, 'initial', 'theta_over_alpha')) &
         *atan2(maxval(b), real_of(groups, 'wall', 'h'))
      limit = real_of(groups, 'model', 'overturning_angle')
      if (theta < limit) return
      call fail_key(groups, 'initial', 'theta_over_alpha', '|theta| = '//real_to_text(theta) &
         //' rad must be < overturning_angle = '//real_to_text(limit)//' rad', error)
   end subroutine check_initial

   !> The tolerance is given or chosen for an accuracy, not both.
   subroutine check_solver(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (has_key(groups, 'solver', 'rtol') .and. has_key(groups, 'solver', 'accuracy')) then
         call fail_key(groups, 'solver', 'accuracy', 'must not be given beside rtol, which it ' &
            //'replaces', error)
      end if
   end subroutine check_solver

   !> Periods as a list or a grid; lists of gamma and b only with a wall.
   subroutine check_spectrum(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: lists(2) = ['gamma', 'b    ']
      integer :: i

      if (.not. has_group(groups, 'spectrum')) return
      call check_grid_keys(groups, error)
      if (.not. (allocated(error) .or. has_key(groups, 'spectrum', 'T_s'))) then
         call check_grid(groups, error)
      end if
      do i = 1, size(lists)
         if (allocated(error) .or. has_group(groups, 'wall')) return
         if (.not. has_key(groups, 'spectrum', trim(lists(i)))) cycle
         call fail_key(groups, 'spectrum', trim(lists(i)), 'must not be given without &wall (the ' &
            //'bare frame does not depend on it)', error)
      end do
   end subroutine check_spectrum

   !> The grid needs all of its keys, and a list of periods none.
   subroutine check_grid_keys(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(7), parameter :: grid(4) = ['T_s_min', 'T_s_max', 'n      ', 'spacing']
      integer, parameter :: needed = 3
      logical :: has_list
      integer :: i

      has_list = has_key(groups, 'spectrum', 'T_s')
      do i = 1, size(grid)
         if (has_list .and. has_key(groups, 'spectrum', trim(grid(i)))) then
            call fail_key(groups, 'spectrum', trim(grid(i)), 'must not be given beside the ' &
               //'list T_s', error)
         else if (.not. has_list .and. .not. has_key(groups, 'spectrum', trim(grid(i))) &
                  .and. i <= needed) then
            call fail_group(groups, 'spectrum', 'the key '//trim(grid(i))//' is missing: must be ' &
               //'given without the list T_s', error)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_grid_keys

   !> Ends in order, and as many periods as ends at least.
   subroutine check_grid(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: shortest
      real(wp) :: longest

      shortest = real_of(groups, 'spectrum', 'T_s_min')
      longest = real_of(groups, 'spectrum', 'T_s_max')
      if (longest < shortest) then
         call fail_key(groups, 'spectrum', 'T_s_max', 'must be >= T_s_min = ' &
            //real_to_text(shortest)//' [s]', error)
      else if (integer_of(groups, 'spectrum', 'n') == 1 .and. longest > shortest) then
         call fail_key(groups, 'spectrum', 'n', 'must be >= 2 when T_s_min and T_s_max differ', &
            error)
      end if
   end subroutine check_grid

   !> Only a record says by itself when the simulation ends.
   subroutine check_end(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(*), parameter :: problem = 'the key t_end is missing (end of the simulation): ' &
         //'must be a number >= 0 [s]; only a record gives it by default'

      if (has_key(groups, 'solver', 't_end')) return
      if (has_group(groups, 'motion')) then
         if (text_of(groups, 'motion', 'kind') == 'record') return
      end if
      if (has_group(groups, 'solver')) then
         call fail_group(groups, 'solver', problem, error)
      else
         call fail(error, err_input, '&solver: '//problem)
      end if
   end subroutine check_end

   !> Exactly one of two keys must be given.
   subroutine check_one_of(groups, group, a, b, condition, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: a
      character(*), intent(in) :: b
      character(*), intent(in) :: condition
      !! 'with ...'
      type(error_t), allocatable, intent(out) :: error

      if (has_key(groups, group, a) .and. has_key(groups, group, b)) then
         call fail_key(groups, group, b, 'must not be given beside '//a//': exactly one of both ' &
            //condition, error)
      else if (.not. has_key(groups, group, a) .and. .not. has_key(groups, group, b)) then
         call fail_group(groups, group, 'exactly one of the keys '//a//' and '//b &
            //' must be given '//condition, error)
      end if
   end subroutine check_one_of

   !> Report a group by its name.
   subroutine fail_group(groups, group, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error

      call fail_at_group(groups(group_of(groups, group)), problem, error)
   end subroutine fail_group

   !> Report a key by its name.
   subroutine fail_key(groups, group, key, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      at = group_of(groups, group)
      call fail_at_entry(groups(at), groups(at)%entries(entry_of(groups(at), key)), problem, error)
   end subroutine fail_key

end module rwmf_case_rules
