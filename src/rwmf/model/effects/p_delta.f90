!> Gravity on the displaced frame (P-Delta), `&p_delta`: a massless leaning column with the weight
!> m_g g.
!>
!> In a storey with relative displacement d it pushes the two floors apart with W d/height, where W
!> is the weight above. This is a negative storey stiffness. Theory: docs/theory/storeys.md.
module rwmf_model_effects_p_delta
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, frame_mass, &
      model_t
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_problem_case, only: case_t, has_floors, has_numbers, keep_numbers, numbers_of
   use rwmf_problem_case_group, only: case_group_t, name_length, two_corners
   use rwmf_problem_group_values, only: derive, group_values_t, has_group, has_key, real_of
   use rwmf_problem_key, only: dimensional, not_negative, optional_key, positive, unless, usually
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_problem_shear_frame, only: floors_group
   use rwmf_problem_units, only: mass_keys, mass_of_frame
   implicit none
   private

   public :: p_delta_group, prepare_p_delta, leaning_height, leaning_loads

   integer, parameter :: of_mass = 1
   integer, parameter :: of_height = 2
   !! index of the height; 0 for the height of the wall or of the storeys
   integer, parameter :: of_limit = 3
   !! indices of the keys among the numbers of the group

contains

   !> Describe the group `&p_delta`: its keys and the procedures that check and read them.
   type(case_group_t) function p_delta_group() result(group)
      group%name = 'p_delta'
      group%needs(1) = 'frame'
      group%not_on_base = two_corners
      group%reasons(1) = 'its displacement is what gravity acts on'
      group%keys = [ &
         usually('[0.01, 100]', &
            optional_key('p_delta', 'm_g_over_m_s', 'real', '-', '1.0', not_negative, &
            'mass whose weight leans on the frame, over the mass of the frame or of each floor')), &
         usually('[500, 1e9]', dimensional('p_delta', 'm_g', 'real', 'kg', 'm_g_over_m_s', '', &
            'or that mass; of a frame with floors, the sum of all', not_negative)), &
         unless(floors_group, &
            usually('[1, 300]', optional_key('p_delta', 'h_f', 'real', 'm', '2h', positive, &
            'height of the frame; required without &wall, refused with &'//floors_group))), &
         usually('[0.002, 0.5]', &
            optional_key('p_delta', 'drift_limit', 'real', '-', '0.1', positive, &
            'drift of the frame or of a storey at which it has collapsed, which ends the run'))]
      group%derive => derive_p_delta
      group%check => check_p_delta
      group%fill => fill_p_delta
      group%is_present => has_p_delta
      group%add_events => add_collapse
      group%no_element = "&p_delta: the frame is the host's"
   end function p_delta_group

   subroutine derive_p_delta(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_key(values, 'p_delta', 'm_g')) return
      if (mass_of_frame(values) > 0) then
         call derive(values, 'p_delta', 'm_g_over_m_s', 'm_g', &
            [real_of(values, 'p_delta', 'm_g')/mass_of_frame(values)])
      else
         call fail_key(values, 'p_delta', 'm_g', 'needs the mass of the frame: '//mass_keys &
            //' must be given, > 0', error)
      end if
   end subroutine derive_p_delta

   subroutine check_p_delta(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_group(values, floors_group)) then
         if (has_key(values, 'p_delta', 'h_f')) call fail_key(values, 'p_delta', 'h_f', &
            'must not be given with &'//floors_group//', which sets the height of the frame', error)
      else if (.not. has_group(values, 'wall') .and. .not. has_key(values, 'p_delta', 'h_f')) then
         call fail_group(values, 'p_delta', 'the key h_f is missing (height of the frame): ' &
            //'required without &wall, a number > 0 [m]', error)
      end if
   end subroutine check_p_delta

   subroutine fill_p_delta(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: numbers(3)

      numbers = 0
      numbers(of_mass) = real_of(case%values, 'p_delta', 'm_g_over_m_s')
      numbers(of_limit) = real_of(case%values, 'p_delta', 'drift_limit')
      if (has_key(case%values, 'p_delta', 'h_f')) numbers(of_height) = real_of(case%values, &
         'p_delta', 'h_f')
      call keep_numbers(case, 'p_delta', numbers)
   end subroutine fill_p_delta

   pure logical function has_p_delta(case)
      type(case_t), intent(in) :: case

      has_p_delta = has_numbers(case, 'p_delta')
   end function has_p_delta

   !> Height of the frame given by a case; 0 if it gives none [m].
   pure real(wp) function leaning_height(case) result(height)
      type(case_t), intent(in) :: case
      real(wp) :: numbers(3)

      height = 0
      if (.not. has_p_delta(case)) return
      numbers = numbers_of(case, 'p_delta')
      height = numbers(of_height)
   end function leaning_height

   !> P-Delta push on each storey per storey displacement, over the unit of the floors' masses. It
   !> is zero without `&p_delta` [1/s2].
   pure function leaning_loads(case) result(loads)
      type(case_t), intent(in) :: case
      !! case with `&storeys`
      real(wp) :: loads(size(case%frame%floors%m))
      real(wp) :: numbers(3)
      integer :: i

      loads = 0
      if (.not. has_p_delta(case)) return
      numbers = numbers_of(case, 'p_delta')
      associate (frame => case%frame%floors)
         loads = [(numbers(of_mass)*case%model%g*sum(frame%m(i:)), i=1, size(loads))] &
            /leaning_heights(case)
      end associate
   end function leaning_loads

   !> Heights over which the loads of the storeys lean [m]. Only a single mass has its own height;
   !> beside a bending wall it yields as one storey.
   pure function leaning_heights(case) result(height)
      type(case_t), intent(in) :: case
      !! case with `&storeys`
      real(wp) :: height(size(case%frame%floors%m))

      height = case%frame%floors%height
      if (leaning_height(case) > 0) height = leaning_height(case)
   end function leaning_heights

   pure subroutine add_collapse(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)

      names = [character(name_length) :: names, 'collapsed']
   end subroutine add_collapse

   !> Prepare the P-Delta push on a single degree of freedom, on one mode, or on storeys with
   !> states.
   subroutine prepare_p_delta(case, equation, effect)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: effect
      real(wp) :: numbers(3)

      effect%is_present = has_p_delta(case)
      if (.not. effect%is_present) return
      numbers = numbers_of(case, 'p_delta')
      effect%coefficients => p_delta_coefficients
      effect%energy => p_delta_energy
      effect%frame_force => p_delta_force
      effect%put_drifts => p_delta_drifts
      associate (g => numbers(of_mass)*equation%p%g, limit => numbers(of_limit))
         if (has_floors(case)) then
            call prepare_storeys(case, equation, limit, effect)
         else
            if (numbers(of_height) <= 0) numbers(of_height) = 2*case%wall%h
            effect%drifts = 1
            effect%constants = [frame_mass(equation)*g/numbers(of_height)*[1, 1], &
               1/(limit*numbers(of_height))]
         end if
      end associate
      effect%n_coef = 1 + effect%n + effect%reads/2
   end subroutine prepare_p_delta

   !> Set the constants of a frame with storeys, in this order.
   !>
   !> The first is the push per displacement of each storey with states, or of the roof, over m_w
   !> [1/s2]. Without such states, the part of the roof's push that the links do not bear follows
   !> [1/s2]. The last are the drifts over their limit per displacement [1/m]. Without wall, the
   !> mass of the frame or of the roof replaces m_w.
   subroutine prepare_storeys(case, equation, limit, effect)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: limit
      !! limit of the drifts [-]
      type(contribution_t), intent(inout) :: effect
      real(wp), allocatable :: load(:), bend(:), height(:)
      real(wp) :: push

      associate (frame => case%frame%floors, n => size(case%frame%floors%m))
         effect%drifts = n
         load = leaning_loads(case)
         height = leaning_heights(case)
         if (equation%floors%n > 0) then
            effect%n = n
            effect%first = equation%floors%first
            effect%reads = 2*equation%floors%free
            effect%constants = [load/equation%floors%unit, 1/(limit*height)]
            return
         end if
         if (allocated(equation%beam%floors)) then
            equation%beam%floors%load = load*frame_mass(equation)*frame%shape(n, 1)**2
            effect%constants = [equation%beam%floors%load, 1/(limit*height)]
            return
         end if
         bend = (frame%shape(:, 1) - [0.0_wp, frame%shape(:n - 1, 1)])/frame%shape(n, 1)
         push = frame_mass(equation)*sum(load*bend**2)*frame%shape(n, 1)**2
         effect%constants = [push, merge(load(1)*bend(1), push, equation%floors%are_linked), &
            bend/(limit*height)]
      end associate
   end subroutine prepare_storeys

   !> Coefficients of `add_p_delta`.
   pure subroutine p_delta_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)

      associate (n => model%floors%n, free => model%floors%free)
         if (n > 0) then
            coef = [model%p%R, effect%constants(:n), 1/model%floors%m(:free)]
         else
            coef = effect%constants(:1)
         end if
      end associate
   end subroutine p_delta_coefficients

   !> Potential energy of the sinking weights.
   real(wp) function p_delta_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), allocatable :: d(:), rate(:)

      call displacements(equation, y, d, rate)
      energy = -sum(effect%constants(:size(d))*d**2)/2
   end function p_delta_energy

   !> Force at the links to the wall, and sum of the forces on the floors. They are negative where
   !> gravity pushes the frame [m/s2].
   function p_delta_force(effect, equation, y) result(force)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: force(2)
      real(wp), allocatable :: d(:), rate(:)

      call displacements(equation, y, d, rate)
      associate (n => size(d))
         if (equation%floors%n > 0) then
            ! link springs let the uppermost storey push a floor with states
            force(1) = -effect%constants(n)*d(n)
            if (equation%floors%free == n) force(1) = 0
            force(2) = -effect%constants(1)*d(1) - force(1)
         else if (allocated(equation%beam%floors)) then
            ! part of the forces of the linked floors
            force = 0
         else
            force = [-effect%constants(2)*d(1), 0.0_wp]
         end if
      end associate
   end function p_delta_force

   subroutine p_delta_drifts(effect, equation, y, ratio, rate)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: ratio(:)
      real(wp), intent(out) :: rate(:)

      real(wp), allocatable :: d(:), d_dot(:)

      call displacements(equation, y, d, d_dot)
      associate (share => effect%constants(size(effect%constants) - size(ratio) + 1:))
         if (size(d) == size(ratio)) then
            ratio = d*share
            rate = d_dot*share
         else
            ratio = d(1)*share
            rate = d_dot(1)*share
         end if
      end associate
   end subroutine p_delta_drifts

   !> Displacement and velocity of each storey that moves by itself, or else of the roof.
   subroutine displacements(equation, y, d, rate)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), allocatable, intent(out) :: d(:)
      !! displacement [m]
      real(wp), allocatable, intent(out) :: rate(:)
      !! velocity [m/s]

      allocate (d(max(1, equation%floors%n_storeys)), rate(max(1, equation%floors%n_storeys)))
      call storey_motion(equation, equation%state%side, y, d, rate)
   end subroutine displacements

end module rwmf_model_effects_p_delta
