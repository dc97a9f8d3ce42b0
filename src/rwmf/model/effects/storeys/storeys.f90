!> Storeys of the frame, `&storeys`: their lists, and how they are linked to the wall.
module rwmf_model_effects_storeys_storeys
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_storeys_storeys_loop, only: floor_coefficients, floor_states, &
      no_hysteresis
   use rwmf_model_effects_storeys_shear_building, only: excited_mass_coefficients, &
      set_storeys, storey_coefficients, storey_energy, storey_sizes
   use rwmf_model_effects_storeys_yielding_storeys, only: choose_storey_springs
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t, name_length
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_group_values, only: get_list, group_values_t, has_group, has_key, real_of, &
      text_of
   use rwmf_problem_key, only: optional_key, positive, required
   use rwmf_problem_rules, only: check_period, fail_key
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: storeys_group, prepare_storeys

contains

   !> The group `&storeys`: its keys, and how they are checked and read.
   type(case_group_t) function storeys_group() result(group)
      group%name = 'storeys'
      group%needs(1) = 'frame'
      group%reasons(1) = 'its xi_s damps their modes'
      group%keys = [ &
         required('storeys', 'm_over_m_w', 'real list', '-', positive, &
            'mass of each floor over m_w (no wall: over any mass), from the ground up'), &
         required('storeys', 'k_over_m_w', 'real list', '1/s2', positive, &
            'stiffness of the storey below each floor over the same mass'), &
         required('storeys', 'height', 'real list', 'm', positive, &
            'height of each storey; with &wall their sum is 2h'), &
         optional_key('storeys', 'coupling', 'choice', '', 'reduced', &
            'reduced every_floor full', &
            'roof linked: first mode or all modes; every floor linked: a straight line')]
      group%check => check_storeys
      group%fill => fill_storeys
      group%is_present => has_storeys
      group%add_states => add_floor_states
      group%refuse_element => refuse_element
   end function storeys_group

   !> Storeys say what period and mass ratio would say; their lists belong together.
   subroutine check_storeys(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      call check_excluded(values, error)
      if (.not. allocated(error)) call check_lists(values, error)
   end subroutine check_storeys

   !> What storeys set themselves, and the link that needs a wall.
   subroutine check_excluded(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: keys(2) = [character(5) :: 'T_s', 'gamma']
      real(wp), allocatable :: gamma(:)
      integer :: i

      if (text_of(values, 'storeys', 'coupling') == 'every_floor' &
          .and. .not. has_group(values, 'wall')) then
         call fail_key(values, 'storeys', 'coupling', "must not be 'every_floor' without &wall, " &
            //'which the floors are linked to', error)
         return
      end if
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

   !> One mass, stiffness and height a storey, none too stiff, as high as the wall.
   subroutine check_lists(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: k(:)
      real(wp), allocatable :: height(:)
      real(wp) :: top
      character(:), allocatable :: problem

      call get_list(values, 'storeys', 'm_over_m_w', m)
      call get_list(values, 'storeys', 'k_over_m_w', k)
      call get_list(values, 'storeys', 'height', height)
      call check_length('k_over_m_w', size(k))
      if (.not. allocated(error)) call check_length('height', size(height))
      if (allocated(error)) return
      call check_period(minval(sqrt(m/2)/sqrt(k/2 + [k(2:)/2, 0.0_wp])), 1.0_wp, problem)
      if (allocated(problem)) call fail_key(values, 'storeys', 'k_over_m_w', 'between its ' &
         //'storeys a floor is too stiff: '//problem, error)
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

   !> Storeys with their modes, which give the frame its period and mass ratio.
   subroutine fill_storeys(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%storeys)
      call get_list(case%values, 'storeys', 'm_over_m_w', case%storeys%frame%m)
      call get_list(case%values, 'storeys', 'k_over_m_w', case%storeys%frame%k)
      call get_list(case%values, 'storeys', 'height', case%storeys%frame%height)
      case%storeys%coupling = text_of(case%values, 'storeys', 'coupling')
      call set_equivalent_frame(case, error)
   end subroutine fill_storeys

   !> All modes, whose storeys may yield one by one, or one mode.
   subroutine prepare_storeys(case, equation, storeys)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: storeys

      storeys%is_present = has_storeys(case)
      if (.not. storeys%is_present) return
      equation%floors%first = equation%scene%n + 1
      call set_storeys(case, equation)
      if (case%storeys%coupling /= 'full') then
         storeys%n_coef = 1
         storeys%coefficients => excited_mass_coefficients
         return
      end if
      storeys%n = equation%floors%n
      storeys%law = no_hysteresis
      if (allocated(case%yielding)) then
         call choose_storey_springs(case, equation)
         if (allocated(equation%floors%laws)) storeys%law = equation%floors%laws(1)%factors
      end if
      storeys%states = floor_states(storeys%n, storeys%law)
      storeys%n_coef = floor_coefficients(storeys%n, storeys%law)
      storeys%coefficients => storey_coefficients
      storeys%frame_energy => storey_energy
      storeys%sizes => storey_sizes
   end subroutine prepare_storeys

   pure logical function has_storeys(case)
      type(case_t), intent(in) :: case

      has_storeys = allocated(case%storeys)
   end function has_storeys

   !> With all modes, displacements and velocities of the floors below the roof.
   pure subroutine add_floor_states(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)
      character(name_length) :: states(size(case%storeys%frame%m) - 1, 2)
      integer :: i

      if (case%storeys%coupling /= 'full') return
      do i = 1, size(states, 1)
         states(i, 1) = 'floor_'//trim(integer_to_text(i))//'_m'
         states(i, 2) = 'floor_'//trim(integer_to_text(i))//'_dot_m_s'
      end do
      names = [character(name_length) :: names, states(:, 1), states(:, 2)]
   end subroutine add_floor_states

   subroutine refuse_element(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error

      call fail(error, err_input, 'an element has no &storeys: the frame is the host''s own')
   end subroutine refuse_element

end module rwmf_model_effects_storeys_storeys
