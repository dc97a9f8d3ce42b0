!> Storeys of the frame, `&storeys`: their lists, or the rule that generates them, and their link
!> to the wall.
module rwmf_model_effects_storeys_storeys
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_effects_storeys_storeys_loop, only: floor_coefficients, floor_states, &
      no_hysteresis
   use rwmf_model_effects_storeys_shear_building, only: excited_mass_coefficients, &
      set_storeys, storey_coefficients, storey_energy, storey_sizes
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_model_hysteresis_storey_springs, only: choose_storey_springs
   use rwmf_model_scene, only: through_link
   use rwmf_problem_case, only: case_t, has_all_modes, has_floors
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_frame_strength, only: has_strength
   use rwmf_problem_group_values, only: derive, get_list, group_values_t, has_group, has_key, &
      integer_of, real_of, text_of
   use rwmf_problem_key, only: dimensional, key_t, optional_key, positive, required, with_si, &
      usually, fixed_by
   use rwmf_problem_rules, only: check_period, fail_group, fail_key
   use rwmf_problem_shear_frame, only: find_modes, shear_frame_t
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: storeys_group, prepare_storeys

contains

   !> Describe the group `&storeys`: its keys and the procedures that check and read them.
   type(case_group_t) function storeys_group() result(group)
      type(key_t) :: distribution

      distribution = optional_key('storeys', 'distribution', 'choice', '', '', &
         'uniform linear straight_mode', &
         'of stiffnesses from the lowest storey up; straight_mode: a straight first mode')
      distribution%needs = 'n'
      group%name = 'storeys'
      group%needs(1) = 'frame'
      group%reasons(1) = 'its xi_s damps their modes'
      group%keys = [ &
         with_si('kg', usually('[1e-4, 1e5]', &
            required('storeys', 'm_over_m_w', 'real list', '-', positive, &
            'mass of each floor over m_w (no wall: over any mass), from the ground up'))), &
         with_si('N/m', optional_key('storeys', 'k_over_m_w', 'real list', '1/s2', '', positive, &
            'stiffness of the storey below each floor over the same mass')), &
         usually('[500, 1e8]', &
            dimensional('storeys', 'm', 'real list', 'kg', 'm_over_m_w', 'k|T_1', &
            'or the masses')), &
         usually('[1e5, 1e12]', &
            dimensional('storeys', 'k', 'real list', 'N/m', 'k_over_m_w', 'm', &
            'or the stiffnesses')), &
         usually('[1.5, 20]', required('storeys', 'height', 'real list', 'm', positive, &
            'height of each storey; with &wall their sum is 2h')), &
         fixed_by('it sets the degrees of freedom', &
            scaling(dimensional('storeys', 'n', 'integer', '', 'height', '', &
            'number of storeys; masses, heights, stiffnesses: one number for all or one each', &
            '[1, 1000]'))), &
         distribution, &
         scaling(usually('[0.02, 15]', &
            dimensional('storeys', 'T_1', 'real', 's', 'k_over_m_w', '', &
            'period of the first mode of the frame by itself: it scales all stiffnesses'))), &
         optional_key('storeys', 'coupling', 'choice', '', 'reduced', &
            'reduced every_floor full springs', &
            'roof linked: first mode or all modes; each floor: a straight line, or by a spring'), &
         with_si('N/m', optional_key('storeys', 'k_link_over_m_w', 'real list', '1/s2', '', &
            positive, 'stiffness of each link spring, or one for all, over the same mass')), &
         usually('[1e5, 1e12]', dimensional('storeys', 'k_link', 'real list', 'N/m', &
            'k_link_over_m_w', '', 'or the stiffnesses'))]
      group%derive => derive_storeys
      group%check => check_storeys
      group%fill => fill_storeys
      group%is_present => has_storeys
      group%add_states => add_floor_states
      group%no_element = "&storeys: the frame is the host's own"
   end function storeys_group

   !> Mark a key as one that scales another key and may be given with it.
   pure type(key_t) function scaling(key)
      type(key_t), intent(in) :: key

      scaling = key
      scaling%scales = .true.
   end function scaling

   !> Derive the lists of `n` storeys from a rule, and the stiffnesses from a given first period.
   subroutine derive_storeys(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      type(shear_frame_t) :: frame
      real(wp), allocatable :: k(:)
      character(10) :: m_key, k_key

      ! without a wall its stiffness is over no mass
      if (has_key(values, 'storeys', 'k_link')) call check_coupling(values, error)
      if (allocated(error)) return
      if (has_key(values, 'storeys', 'm') .and. has_key(values, 'storeys', 'k_over_m_w')) then
         if (.not. has_key(values, 'storeys', 'k')) then
            call fail_key(values, 'storeys', 'k_over_m_w', 'must not be given beside m: give ' &
               //'the stiffness k [N/m] instead', error)
            return
         end if
      end if
      m_key = merge('m         ', 'm_over_m_w', has_key(values, 'storeys', 'm'))
      k_key = merge('k         ', 'k_over_m_w', has_key(values, 'storeys', 'k'))
      call get_list(values, 'storeys', 'm_over_m_w', frame%m)
      call get_list(values, 'storeys', 'k_over_m_w', frame%k)
      call get_list(values, 'storeys', 'height', frame%height)
      if (has_key(values, 'storeys', 'n')) then
         call spread_out('height', frame%height)
         call spread_out(trim(m_key), frame%m)
         ! T_1 alone may determine the stiffnesses
         if (.not. allocated(frame%k) .and. has_key(values, 'storeys', 'T_1')) frame%k = [1.0_wp]
         if (allocated(error) .or. .not. allocated(frame%k)) return
         if (size(frame%k) == 1) then
            k = stiffnesses(text_of(values, 'storeys', 'distribution'), frame)
            call move_alloc(k, frame%k)
         else if (has_key(values, 'storeys', 'distribution')) then
            call fail_key(values, 'storeys', 'distribution', 'must not be given with more than ' &
               //'one stiffness', error)
         end if
         call spread_out(trim(k_key), frame%k)
         if (allocated(error)) return
         call derive(values, 'storeys', 'height', 'height', frame%height)
         call derive(values, 'storeys', 'm_over_m_w', trim(m_key), frame%m)
         call derive(values, 'storeys', 'k_over_m_w', trim(k_key), frame%k)
      end if
      if (.not. (has_key(values, 'storeys', 'T_1') .and. allocated(frame%k))) return
      ! check_lists refuses lists of different lengths
      if (size(frame%k) /= size(frame%m)) return
      call find_modes(frame, error)
      if (allocated(error)) return
      call derive(values, 'storeys', 'k_over_m_w', 'T_1', &
         frame%k*(2*pi/(frame%omega(1)*real_of(values, 'storeys', 'T_1')))**2)

   contains

      !> Expand one number to all storeys.
      subroutine spread_out(key, list)
         character(*), intent(in) :: key
         real(wp), allocatable, intent(inout) :: list(:)
         real(wp) :: one
         integer :: i, n

         n = integer_of(values, 'storeys', 'n')
         if (size(list) == 1) then
            ! not by self-assignment: gfortran 12 reads the list after deallocating it
            one = list(1)
            list = [(one, i=1, n)]
         end if
         if (size(list) /= n .and. .not. allocated(error)) call fail_key(values, 'storeys', key, &
            'has '//trim(integer_to_text(size(list)))//' values, must have one for all or one ' &
            //'for each of the n = '//trim(integer_to_text(n))//' storeys', error)
      end subroutine spread_out
   end subroutine derive_storeys

   !> Compute the stiffness of each storey from that of the lowest.
   pure function stiffnesses(distribution, frame) result(k)
      character(*), intent(in) :: distribution
      type(shear_frame_t), intent(in) :: frame
      !! masses and heights, and the stiffness of the lowest storey
      real(wp) :: k(size(frame%height))
      real(wp) :: moment(size(frame%height))
      !! first moment of each floor's mass about the ground
      integer :: i

      select case (distribution)
      case ('linear')
         ! proportional to the height of the roof above the bottom of the storey
         k = [(sum(frame%height(i:)), i=1, size(k))]/sum(frame%height)
      case ('straight_mode')
         ! each storey bears the inertia of the floors above it, proportional to their height
         moment = frame%m*[(sum(frame%height(:i)), i=1, size(k))]
         do i = 1, size(k)
            k(i) = sum(moment(i:))/frame%height(i)
         end do
         k = k/k(1)
      case default
         k = 1
      end select
      k = frame%k(1)*k
   end function stiffnesses

   !> Check that no key contradicts the storeys and that their lists agree.
   subroutine check_storeys(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      call check_coupling(values, error)
      if (.not. allocated(error)) call check_excluded(values, error)
      if (.not. allocated(error)) call check_lists(values, error)
   end subroutine check_storeys

   !> Check that floors are linked to a wall, and that link springs have their stiffnesses.
   subroutine check_coupling(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(15), parameter :: keys(2) = [character(15) :: 'k_link_over_m_w', 'k_link']
      character(:), allocatable :: coupling
      integer :: i

      coupling = text_of(values, 'storeys', 'coupling')
      if (any(coupling == [character(11) :: 'every_floor', 'springs']) &
          .and. .not. has_group(values, 'wall')) then
         call fail_key(values, 'storeys', 'coupling', "must not be '"//coupling//"' without " &
            //'&wall, which the floors are linked to', error)
      else if (coupling == 'springs' .and. .not. has_key(values, 'storeys', trim(keys(1)))) then
         call fail_group(values, 'storeys', 'the key k_link_over_m_w is missing (stiffness of ' &
            //"the link springs): must be given with coupling = 'springs', numbers > 0 " &
            //'[1/s2]; or k_link [N/m]', error)
      else if (coupling == 'springs' .and. has_group(values, 'link')) then
         call fail_group(values, 'link', "must not be given with &storeys coupling = " &
            //"'springs', whose links are springs", error)
      else if (coupling /= 'springs') then
         do i = size(keys), 1, -1
            if (.not. has_key(values, 'storeys', trim(keys(i)))) cycle
            call fail_key(values, 'storeys', trim(keys(i)), "must not be given with coupling " &
               //"= '"//coupling//"', whose links are rigid; 'springs' needs it", error)
            return
         end do
      end if
   end subroutine check_coupling

   !> Refuse keys that the storeys determine.
   subroutine check_excluded(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: keys(2) = [character(5) :: 'T_s', 'gamma']
      real(wp), allocatable :: gamma(:)
      integer :: i

      do i = 1, size(keys)
         if (.not. has_key(values, 'frame', trim(keys(i)))) cycle
         call fail_key(values, 'frame', trim(keys(i)), 'must not be given with &storeys, which ' &
            //'set it; T_s and gamma of &spectrum scale them', error)
         return
      end do
      call get_list(values, 'spectrum', 'gamma', gamma)
      if (.not. allocated(gamma)) return
      if (any(gamma <= 0)) call fail_key(values, 'spectrum', 'gamma', 'must be > 0 with ' &
         //'&storeys, whose masses it scales', error)
   end subroutine check_excluded

   !> Check one mass, stiffness and height for each storey, the periods, and the total height.
   subroutine check_lists(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: k(:)
      real(wp), allocatable :: height(:), k_link(:)
      real(wp) :: top
      character(:), allocatable :: problem

      call get_list(values, 'storeys', 'm_over_m_w', m)
      call get_list(values, 'storeys', 'k_over_m_w', k)
      call get_list(values, 'storeys', 'height', height)
      call get_list(values, 'storeys', 'k_link_over_m_w', k_link)
      if (.not. allocated(k)) then
         call fail_group(values, 'storeys', 'the key k_over_m_w is missing (stiffness of the ' &
            //'storey below each floor over the same mass): must be numbers > 0 [1/s2]; or k ' &
            //'[N/m], or T_1 with n', error)
         return
      end if
      call check_length('k_over_m_w', size(k))
      if (.not. allocated(error)) call check_length('height', size(height))
      if (allocated(error)) return
      call check_period(minval(sqrt(m/2)/sqrt(k/2 + [k(2:)/2, 0.0_wp])), 1.0_wp, problem)
      if (allocated(problem)) call fail_key(values, 'storeys', 'k_over_m_w', 'between its ' &
         //'storeys a floor is too stiff: '//problem, error)
      if (.not. allocated(error) .and. allocated(k_link)) call check_links(values, m, k_link, error)
      if (allocated(error) .or. .not. has_group(values, 'wall')) return
      top = 2*real_of(values, 'wall', 'h')
      if (abs(sum(height) - top) <= 1.0e-6_wp*top) return
      call fail_key(values, 'storeys', 'height', 'their sum is '//trim(real_to_text(sum(height))) &
         //' m, must be the height of the wall that the roof is linked to, 2h = ' &
         //trim(real_to_text(top))//' m', error)

   contains

      subroutine check_length(key, n)
         character(*), intent(in) :: key
         integer, intent(in) :: n

         if (n /= size(m)) call fail_key(values, 'storeys', key, 'has ' &
            //trim(integer_to_text(n))//' values, must have one for each of the ' &
            //trim(integer_to_text(size(m)))//' storeys of m_over_m_w', error)
      end subroutine check_length
   end subroutine check_lists

   !> Check the number of link springs, and their periods with floor or wall.
   subroutine check_links(values, m, k_link, error)
      type(group_values_t), intent(in) :: values
      real(wp), intent(in) :: m(:)
      !! (floors) mass over m_w [-]
      real(wp), intent(in) :: k_link(:)
      !! (1 or floors) stiffness over m_w [1/s2]
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: wall_share = 1.0_wp/3
      !! mass at the roof with about the inertia of the wall, over m_w [-]
      character(:), allocatable :: problem, key

      key = 'k_link_over_m_w'
      if (has_key(values, 'storeys', 'k_link')) key = 'k_link'
      if (size(k_link) == 1) then
         call check_period(sqrt(min(minval(m), wall_share)), sqrt(k_link(1)), problem)
      else if (size(k_link) == size(m)) then
         call check_period(minval(sqrt(min(m, wall_share))/sqrt(k_link)), 1.0_wp, problem)
      else
         problem = 'has '//trim(integer_to_text(size(k_link)))//' values, must have one for all ' &
            //'floors or one for each of the '//trim(integer_to_text(size(m)))//' of m_over_m_w'
      end if
      if (allocated(problem)) call fail_key(values, 'storeys', key, problem, error)
   end subroutine check_links

   !> Read the storeys and compute their modes, which set the period and mass ratio of the frame.
   subroutine fill_storeys(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: k_link(:)
      !! (1 or floors) [1/s2]

      allocate (case%frame%floors)
      call get_list(case%values, 'storeys', 'm_over_m_w', case%frame%floors%m)
      call get_list(case%values, 'storeys', 'k_over_m_w', case%frame%floors%k)
      call get_list(case%values, 'storeys', 'height', case%frame%floors%height)
      case%frame%coupling = text_of(case%values, 'storeys', 'coupling')
      call get_list(case%values, 'storeys', 'k_link_over_m_w', k_link)
      if (allocated(k_link)) then
         allocate (case%frame%k_link, source=0*case%frame%floors%m + k_link(1))
         if (size(k_link) > 1) case%frame%k_link(:) = k_link
      end if
      call set_equivalent_frame(case, error)
   end subroutine fill_storeys

   !> Prepare the contribution of the storeys: one mode, or all modes, whose storeys may yield.
   subroutine prepare_storeys(case, equation, storeys)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: storeys
      integer :: i

      storeys%is_present = has_storeys(case)
      if (.not. storeys%is_present) return
      equation%floors%first = equation%scene%n + 1
      call set_storeys(case, equation)
      if (.not. has_all_modes(case)) then
         storeys%n_coef = 1
         storeys%coefficients => excited_mass_coefficients
         if (has_strength(case) .and. allocated(equation%beam%floors)) then
            call choose_storey_springs(case, equation%beam%floors%k, equation)
         end if
         return
      end if
      if (.not. equation%floors%are_linked) storeys%acts = through_link
      storeys%n = equation%floors%n
      storeys%law = no_hysteresis
      if (has_strength(case)) then
         call choose_storey_springs(case, equation%floors%k, equation)
         if (allocated(equation%floors%laws)) then
            storeys%law = equation%floors%laws(1)%factors
            equation%floors%laws%place = [(equation%floors%first + 2*equation%floors%free - 1 + i, &
               i=1, storeys%n)]
         end if
      end if
      storeys%states = floor_states(storeys%n, equation%floors%free, storeys%law)
      storeys%n_coef = floor_coefficients(storeys%n, equation%floors%free, storeys%law)
      storeys%coefficients => storey_coefficients
      storeys%frame_energy => storey_energy
      storeys%sizes => storey_sizes
   end subroutine prepare_storeys

   pure logical function has_storeys(case)
      type(case_t), intent(in) :: case

      has_storeys = has_floors(case)
   end function has_storeys

   !> Add the names of the floor states: with all modes, displacement and velocity of each floor
   !> below a linked roof, or of all floors with link springs.
   pure subroutine add_floor_states(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)
      character(name_length), allocatable :: states(:, :)
      integer :: i, n

      if (.not. has_all_modes(case)) return
      n = size(case%frame%floors%m)
      if (.not. allocated(case%frame%k_link)) n = n - 1
      allocate (states(n, 2))
      do i = 1, size(states, 1)
         states(i, 1) = 'floor_'//trim(integer_to_text(i))//'_m'
         states(i, 2) = 'floor_'//trim(integer_to_text(i))//'_dot_m_s'
      end do
      names = [character(name_length) :: names, states(:, 1), states(:, 2)]
   end subroutine add_floor_states

end module rwmf_model_effects_storeys_storeys
