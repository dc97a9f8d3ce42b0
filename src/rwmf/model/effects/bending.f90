!> Effect `&bending`: the wall bends in modes of the uniform cantilever, in the frame that turns
!> with the base (docs/theory/bending.md).
module rwmf_model_effects_bending
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_beam, only: linked_floors_t, set_beam, set_damping_ratios, set_floors, &
      set_links, set_vectors
   use rwmf_model_bent_wall, only: bent_mass_matrix, landing
   use rwmf_model_effects_bending_loop, only: bending_coefficients, fixed_columns, mode_columns, &
      shape_columns
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, frame_travel, &
      model_t
   use rwmf_problem_case, only: case_t, has_numbers, keep_numbers, numbers_of
   use rwmf_problem_case_group, only: case_group_t, name_length, two_corners
   use rwmf_problem_frame_strength, only: count_linked_smooth
   use rwmf_problem_group_values, only: derive, group_values_t, has_group, has_key, integer_of, &
      real_of, text_of
   use rwmf_problem_key, only: dimensional, key_t, not_negative, optional_key, positive, required, &
      usually, with_si
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: bending_group, prepare_bending

   real(wp), parameter :: shear_factor = 5.0_wp/6
   !! kappa of a rectangle [-]

contains

   !> Define the group `&bending` with its keys and checks.
   type(case_group_t) function bending_group() result(group)
      type(key_t) :: damping, reference

      damping = optional_key('bending', 'damping', 'choice', '', 'modal', 'modal stiffness', &
         'equal ratios in all modes of the cantilever, or in proportion to the stiffness')
      reference = optional_key('bending', 'xi_of', 'choice', '', 'cantilever', &
         'cantilever rocking', &
         'wall whose modes have xi: bare on a fixed base, or rocking with its floors (first mode)')
      group%name = 'bending'
      group%needs(1) = 'wall'
      group%not_on_base = two_corners
      group%reasons(1) = 'it describes the stiffness of the wall'
      group%keys = [ &
         with_si('N m2', usually('[1, 1e8]', required('bending', 'EI_over_m_w', 'real', 'm3/s2', &
            positive, 'bending stiffness of the wall over m_w'))), &
         usually('[1e6, 1e13]', dimensional('bending', 'EI', 'real', 'N m2', 'EI_over_m_w', '', &
            'or the bending stiffness')), &
         usually('[1e8, 1e12]', dimensional('bending', 'E', 'real', 'Pa', 'EI_over_m_w', '', &
            'or the modulus of elasticity, with &wall thickness')), &
         optional_key('bending', 'cracking', 'real', '-', '1.0', '(0, 1]', &
            'factor on the moment of inertia of the gross section; only with E'), &
         optional_key('bending', 'modes', 'integer', '', '3', '[1, 12]', 'number of modes'), &
         usually('[0.001, 0.2]', optional_key('bending', 'xi', 'real', '-', '0.02', not_negative, &
            'damping ratio, in the first mode of damping stiffness')), &
         reference, &
         damping, &
         optional_key('bending', 'nu', 'real', '-', '', '[0, 0.5]', &
            'Poisson''s ratio; if given, the wall also deforms in shear')]
      group%derive => derive_bending
      group%check => check_bending
      group%fill => fill_bending
      group%is_present => has_bending
      group%add_states => add_mode_states
      group%no_element = '&bending: the modes are states, and an element holds none; a stepping ' &
         //'wall (create_stepping) allows it'
   end function bending_group

   !> Derive EI from the modulus of elasticity and the section.
   subroutine derive_bending(values, error)
      type(group_values_t), intent(inout) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: mass

      if (.not. has_key(values, 'bending', 'E')) return
      mass = real_of(values, 'wall', 'm_w')
      if (.not. has_key(values, 'wall', 'thickness')) then
         call fail_key(values, 'bending', 'E', 'needs &wall thickness, for the moment of inertia', &
            error)
      else if (.not. mass > 0) then
         call fail_key(values, 'bending', 'E', 'needs the mass of the wall: m_w, or density and ' &
            //'thickness, of &wall must be given', error)
      else
         call derive(values, 'bending', 'EI_over_m_w', 'E', [real_of(values, 'bending', &
            'cracking')*real_of(values, 'bending', 'E')*real_of(values, 'wall', 'thickness') &
            *(2*real_of(values, 'wall', 'b'))**3/(12*mass)])
      end if
   end subroutine derive_bending

   !> Refuse the groups and values that a bending wall excludes.
   subroutine check_bending(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error

      if (has_key(values, 'bending', 'cracking') .and. .not. has_key(values, 'bending', 'E')) then
         call fail_key(values, 'bending', 'cracking', 'must not be given without E: EI and ' &
            //'EI_over_m_w contain it', error)
      else if (text_of(values, 'model', 'formulation') /= 'exact') then
         call fail_group(values, 'bending', "must not be given with &model formulation = '" &
            //trim(text_of(values, 'model', 'formulation'))//"': it needs 'exact'", error)
      else if (text_of(values, 'wall', 'base') == 'pinned') then
         call fail_group(values, 'bending', "must not be given with &wall base = 'pinned': modes " &
            //'of a cantilever describe a rocking wall', error)
      else if (has_group(values, 'coupling') .or. has_group(values, 'restraint')) then
         call fail_group(values, 'bending', 'must not be given with &coupling or &restraint: ' &
            //'their forces at the edges bend the wall, which its equations leave out', error)
      else if (has_key(values, 'cable', 'offset') .or. has_key(values, 'cable', 'height')) then
         call fail_group(values, 'bending', 'must not be given with offset or height of &cable: ' &
            //'a force off the axis or below the top bends the wall', error)
      else if (has_group(values, 'link')) then
         call fail_group(values, 'bending', 'must not be given with &link: the equations of ' &
            //'a bending wall have no tilted link', error)
      else if (text_of(values, 'impact', 'rule') /= 'coupled') then
         call fail_group(values, 'bending', "needs &impact rule = 'coupled': the momentum " &
            //'balance of the modes gives the velocities after an impact', error)
      end if
   end subroutine check_bending

   !> Store the values of the group in the case.
   subroutine fill_bending(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: nu, cracking

      nu = -1
      if (has_key(case%values, 'bending', 'nu')) nu = real_of(case%values, 'bending', 'nu')
      cracking = 1
      if (has_key(case%values, 'bending', 'E')) cracking = real_of(case%values, 'bending', &
         'cracking')
      call keep_numbers(case, 'bending', [real_of(case%values, 'bending', 'EI_over_m_w'), &
         real(integer_of(case%values, 'bending', 'modes'), wp), real_of(case%values, 'bending', &
         'xi'), merge(1.0_wp, 0.0_wp, text_of(case%values, 'bending', 'damping') == 'stiffness'), &
         nu, cracking, merge(1.0_wp, 0.0_wp, text_of(case%values, 'bending', 'xi_of') &
         == 'rocking')])
   end subroutine fill_bending

   !> True if the wall bends.
   pure logical function has_bending(case)
      type(case_t), intent(in) :: case

      has_bending = has_numbers(case, 'bending')
   end function has_bending

   !> Add the names of the displacements and velocities of the modes to the states. States of smooth
   !> storeys that are linked to the wall floor by floor follow.
   pure subroutine add_mode_states(case, names)
      type(case_t), intent(in) :: case
      character(name_length), allocatable, intent(inout) :: names(:)
      real(wp) :: numbers(7)
      character(name_length), allocatable :: states(:, :), smooth(:)
      integer :: i

      numbers = numbers_of(case, 'bending')
      allocate (states(nint(numbers(2)), 2))
      do i = 1, size(states, 1)
         states(i, 1) = 'q_'//trim(integer_to_text(i))//'_m'
         states(i, 2) = 'q_'//trim(integer_to_text(i))//'_dot_m_s'
      end do
      names = [character(name_length) :: names, states(:, 1), states(:, 2)]
      allocate (smooth(count_linked_smooth(case)))
      do i = 1, size(smooth)
         smooth(i) = 'z_'//trim(integer_to_text(i))
      end do
      names = [character(name_length) :: names, smooth]
   end subroutine add_mode_states

   !> Prepare the contribution of the modes to the equation. Effects that act on the frame come
   !> before them in the scene, all others after them.
   subroutine prepare_bending(case, equation, bending)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(out) :: bending
      real(wp) :: numbers(7)
      real(wp) :: flexibility
      integer :: i

      bending%is_present = has_bending(case)
      if (.not. bending%is_present) return
      numbers = numbers_of(case, 'bending')
      flexibility = 0
      associate (h => case%wall%h, b => case%wall%b, nu => numbers(5), cracking => numbers(6))
         if (nu >= 0) flexibility = cracking*(2*b)**2/12*2*(1 + nu)/(shear_factor*(2*h)**2)
         call set_beam(equation%beam, nint(numbers(2)), h, b, numbers(1), flexibility, &
            numbers(3), numbers(4) > 0)
      end associate
      equation%beam%first = equation%scene%n + 1
      if (allocated(equation%beam%floors)) then
         call set_floors(equation%beam)
      else if (allocated(equation%floors%k_link)) then
         call set_links(equation%beam, equation%floors%share)
         bending%n = equation%floors%n
         equation%floors%max_frequency = sqrt(equation%floors%max_frequency**2 + maxval( &
            equation%beam%omega)**2 + sum(equation%floors%k_link)/minval(equation%beam%mass))
      else if (equation%has_frame) then
         equation%beam%linked_mass = equation%p%gamma
      end if
      call set_vectors(equation%beam)
      equation%moves_at_rest = .true.
      equation%floors%max_frequency = max(equation%floors%max_frequency, &
         maxval(equation%beam%omega), equation%p%omega_s)
      bending%constants = [0.0_wp]
      if (allocated(case%inerter)) bending%constants = [case%inerter%inertance_over_m_w]
      call damp(equation, bending%constants(1), numbers(3), numbers(7) > 0)
      bending%law = equation%beam%n
      bending%states = 2*equation%beam%n
      if (allocated(equation%beam%floors)) then
         bending%n = size(equation%beam%floors%m)
         if (allocated(equation%floors%laws)) then
            ! the loop computes a power of any exponent
            equation%floors%laws%factors = 0
            equation%floors%laws%place = [(equation%beam%first - 1 + bending%states + i, &
               i=1, bending%n)]
            bending%states = bending%states + bending%n
         end if
      end if
      bending%n_coef = bending_coefficients(bending%law, bending%n, &
         allocated(equation%beam%link_phi), bending%states > 2*bending%law)
      bending%coefficients => coefficients_of_bending
      bending%sizes => mode_sizes
      bending%land => land
   end subroutine prepare_bending

   !> Set damping and damping ratios of the modes.
   pure subroutine damp(equation, inertance, xi, is_of_rocking)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: inertance
      !! inertance of the inerter under a corner over m_w [-]
      real(wp), intent(in) :: xi
      !! damping ratio [-]
      logical, intent(in) :: is_of_rocking
      !! it is that of the first mode of the rocking wall; otherwise of the cantilever
      real(wp), dimension(0:equation%beam%n, 0:equation%beam%n) :: mass
      integer :: i

      mass = bent_mass_matrix(equation)
      mass(0, 0) = mass(0, 0) + inertance*(2*equation%beam%half_width)**2
      if (allocated(equation%beam%link_phi)) then
         do i = 1, size(equation%beam%link_phi, 1)
            associate (shape => [equation%beam%length*equation%floors%share(i), &
                       equation%beam%link_phi(i, :)])
               mass = mass + equation%floors%m(i)*spread(shape, 2, size(shape)) &
                  *spread(shape, 1, size(shape))
            end associate
         end do
      end if
      if (is_of_rocking) then
         call set_damping_ratios(equation%beam, mass, xi)
      else
         call set_damping_ratios(equation%beam, mass)
      end if
   end subroutine damp

   !> Fill in the coefficients of the loops.
   pure subroutine coefficients_of_bending(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)
      integer :: i, next

      associate (beam => model%beam, n => model%beam%n)
         coef(:fixed_columns) = [model%p%R, beam%half_width, model%p%g_over_R, model%p%g]
         next = fixed_columns + (mode_columns + n)*n
         coef(fixed_columns + 1:next) = [beam%area, beam%arm, beam%mass, beam%mass*beam%omega**2, &
            beam%mass*beam%damping, beam%linked_ratio, beam%vectors]
         if (allocated(beam%floors)) then
            call put_shapes(model, state, coef(next + 1:next + shape_columns*(n + 1) &
               + 3*(n + 1)**2))
            next = next + shape_columns*(n + 1) + 3*(n + 1)**2
            if (allocated(model%floors%laws)) coef(next + 1:) = [model%floors%laws%force_at_z1, &
               1/model%floors%laws%u_y, state%storey_signs%lost, model%floors%laws%exponent, &
               bends_of(beam%floors, n)]
         else if (allocated(beam%link_phi)) then
            coef(next + 1:) = [([1/model%floors%m(i), model%floors%k_link(i), &
               model%floors%share(i), beam%link_phi(i, :)], i=1, effect%n)]
         end if
      end associate
   end subroutine coefficients_of_bending

   !> Fill in the matrices of linked floors in the shapes of the wall: the straight wall and the
   !> modes.
   pure subroutine put_shapes(model, state, coef)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      !! its storeys are on their branches
      real(wp), intent(out) :: coef(shape_columns + 3*(model%beam%n + 1), 0:model%beam%n)
      real(wp), dimension(model%floors%n_storeys, 0:model%beam%n) :: shape, bend
      real(wp) :: offset(model%floors%n_storeys)
      integer :: i

      offset = 0
      if (allocated(model%floors%springs)) offset = state%storey_branches%offset
      associate (floors => model%beam%floors, slope => state%storey_branches%slope)
         shape(:, 0) = floors%share
         shape(:, 1:) = floors%phi
         bend = bends_of(floors, model%beam%n)
         do i = 0, model%beam%n
            coef(:, i) = [sum(floors%m*shape(:, i)), sum(offset*bend(:, i)), &
               matmul(floors%m*shape(:, i), shape), &
               matmul((slope - floors%load)*bend(:, i), bend), &
               matmul(floors%viscous_time*floors%k*bend(:, i), bend)]
         end do
      end associate
   end subroutine put_shapes

   !> Displacement of each storey in each shape of the wall: the straight wall and the modes [-].
   pure function bends_of(floors, n) result(bend)
      type(linked_floors_t), intent(in) :: floors
      integer, intent(in) :: n
      !! number of modes
      real(wp) :: bend(size(floors%m), 0:n)
      integer :: floor

      bend(:, 0) = floors%share
      bend(:, 1:) = floors%phi
      do floor = size(floors%m), 2, -1
         bend(floor, :) = bend(floor, :) - bend(floor - 1, :)
      end do
   end function bends_of

   !> Expected sizes of the modes: the modes move about as much as the top of the wall.
   subroutine mode_sizes(effect, equation, size_guess, sizes)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! of theta and theta' [rad], [rad/s]
      real(wp), intent(out) :: sizes(:)
      !! of q_i [m] and q_i' [m/s], and of smooth storeys [-]

      associate (n => equation%beam%n)
         sizes(:n) = frame_travel(equation)*size_guess(1)
         sizes(n + 1:2*n) = frame_travel(equation)*size_guess(2)
         if (size(sizes) > 2*n) sizes(2*n + 1:) = min(1.0_wp, frame_travel(equation) &
            *size_guess(1)/equation%floors%laws%u_y)
      end associate
   end subroutine mode_sizes

   !> Apply an impact. Wall and modes share the impulse at the new corner. If the wall would turn
   !> back into its base, it stays there.
   subroutine land(effect, equation, y, after, stays)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      !! equation on the side before the impact
      real(wp), intent(inout) :: y(:)
      !! (states) at theta = 0, with theta' before the impact; the modes change
      real(wp), intent(inout) :: after
      !! theta' after the impact [rad/s]
      logical, intent(inout) :: stays

      call landing(equation, effect%constants(1), y, after, stays)
   end subroutine land

   !> Refuse an element of a host program.
end module rwmf_model_effects_bending
