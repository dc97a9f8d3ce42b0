!> Rules between the keys and groups of a case file, on top of what the schema says of each alone.
module rwmf_input_rules_scene
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_input_group_values, only: get_list, has_group, has_key, integer_of, logical_of, &
      real_of, text_of
   use rwmf_input_namelist, only: group_t
   use rwmf_input_rules_common, only: check_needs, check_one_of, fail_group, fail_key
   use rwmf_input_rules_effects, only: check_impact, check_massless, check_vertical
   use rwmf_input_rules_frame, only: check_frame, check_hysteresis, check_storeys
   use rwmf_input_rules_springs, only: check_fuse, check_tendon, check_yielding
   use rwmf_input_schema, only: belongs_to, find_key, key_t, keys_of, pulse_kinds
   use rwmf_text_strings, only: real_to_text
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
      if (.not. allocated(error)) call check_hysteresis(groups, error)
      if (.not. allocated(error)) call check_impact(groups, error)
      if (.not. allocated(error)) call check_base(groups, error)
      if (.not. allocated(error)) call check_massless(groups, error)
      if (.not. allocated(error)) call check_link(groups, error)
      if (.not. allocated(error)) call check_cable(groups, error)
      if (.not. allocated(error)) call check_yielding(groups, error)
      if (.not. allocated(error)) call check_fuse(groups, error)
      if (.not. allocated(error)) call check_motion(groups, error)
      if (.not. allocated(error)) call check_vertical(groups, error)
      if (.not. allocated(error)) call check_initial(groups, error)
      if (.not. allocated(error)) call check_solver(groups, error)
      if (.not. allocated(error)) call check_output(groups, error)
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
         call check_needs(groups, 'damper', 'wall', 'dampers work under its corners', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'fuse', 'wall', 'fuses work under its corners', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'yielding', 'frame', 'the frame is what yields', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'inerter', 'wall', 'inerters work under its corners', error)
      end if
      if (.not. allocated(error)) then
         call check_needs(groups, 'vertical', 'wall', 'a frame moves horizontally only', error)
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


   !> What a wall hinged in the middle of its base excludes.
   subroutine check_base(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(6), parameter :: excluded(*) = [character(6) :: 'impact', 'cable']
      character(60), parameter :: reasons(size(excluded)) = [character(60) :: &
         'a hinged wall has no impacts', &
         'a straight cable through the hinge is not stretched']
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
      else if (has_key(groups, 'cable', 'eta_y') .or. has_key(groups, 'cable', &
         'rupture_strain')) then
         call check_tendon(groups, error)
      else if (has_key(groups, 'cable', 'hardening')) then
         call fail_key(groups, 'cable', 'hardening', 'must not be given without eta_y', error)
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
         call check_pulse(groups, keys, kind, error)
      else if (kind == 'record' .and. .not. has_key(groups, 'motion', 'file')) then
         call fail_group(groups, 'motion', 'the key file is missing: must be the path of the ' &
            //'record in quotes', error)
      end if
   end subroutine check_motion

   !> Amplitude and period of a pulse, and what its kind requires.
   subroutine check_pulse(groups, keys, kind, error)
      type(group_t), intent(in) :: groups(:)
      type(key_t), intent(in) :: keys(:)
      !! of `&motion`
      character(*), intent(in) :: kind
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: condition

      condition = "with kind = '"//kind//"'"
      if (belongs_to(keys(find_key(keys, 'v_p')), kind)) then
         call check_one_of(groups, 'motion', 'a_max_g', 'v_p', condition, error)
      else if (.not. has_key(groups, 'motion', 'a_max_g')) then
         call fail_group(groups, 'motion', 'the key a_max_g is missing (largest acceleration ' &
            //'over g): must be given '//condition//', any finite number [-]', error)
      end if
      if (allocated(error)) return
      call check_one_of(groups, 'motion', 'omega_p', 'T_p', condition, error)
      if (allocated(error) .or. has_key(groups, 'motion', 'gamma_p')) return
      if (.not. belongs_to(keys(find_key(keys, 'gamma_p')), kind)) return
      call fail_group(groups, 'motion', 'the key gamma_p is missing (number of cycles in the ' &
         //'envelope): must be given '//condition//', a number in (1, 1000] [-]', error)
   end subroutine check_pulse

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

   !> A limit of friction belongs to the reactions of a wall.
   subroutine check_output(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_key(groups, 'output', 'friction_limit')) return
      if (.not. logical_of(groups, 'output', 'reactions')) then
         call fail_key(groups, 'output', 'friction_limit', 'needs reactions = .true. in the same ' &
            //'group', error)
      else if (.not. has_group(groups, 'wall')) then
         call fail_key(groups, 'output', 'friction_limit', 'must not be given without &wall ' &
            //'(friction holds the wall)', error)
      end if
   end subroutine check_output

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
         //'must be a number >= 0 [s]; only records without a pulse give it by default'
      character(:), allocatable :: kind

      if (has_key(groups, 'solver', 't_end')) return
      kind = 'none'
      if (has_group(groups, 'motion')) kind = text_of(groups, 'motion', 'kind')
      if (kind == 'record') return
      if (has_group(groups, 'vertical') .and. kind == 'none') then
         if (has_key(groups, 'vertical', 'file')) return
      end if
      if (has_group(groups, 'solver')) then
         call fail_group(groups, 'solver', problem, error)
      else
         call fail(error, err_input, '&solver: '//problem)
      end if
   end subroutine check_end

end module rwmf_input_rules_scene
