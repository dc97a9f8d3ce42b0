!> Frame of several storeys with all its modes. Its roof is linked to the wall, or each floor by a
!> link spring.
!>
!> The rotation of the wall moves a linked roof; the floors below it are free. Their displacements
!> u_i and velocities v_i relative to the ground are states. An impact changes the roof's velocity
!> suddenly and leaves these states unchanged:
!>
!>    m_i (v_i' + u_g'') = k_(i+1) (u_(i+1) - u_i) - k_i (u_i - u_(i-1)) - (C v)_i + l_i,   i < n
!>
!> The frame of `equation_t` (gamma and omega_s) represents the roof's mass and the stiffness of
!> the uppermost storey. With link springs the roof is a free floor as well, the frame of
!> `equation_t` has no mass, and l_i = k_link_i (z_i/(2h) u_s - u_i). Each yielding storey is on one
!> of the branches of `yielding_storeys`.
module rwmf_model_effects_storeys_shear_building
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, frame_mass, &
      frame_travel, model_t
   use rwmf_model_floor_motion, only: floor_motion
   use rwmf_model_floors_floor_forces, only: link_pulls, storey_strain
   use rwmf_problem_case, only: case_t, has_all_modes, has_numbers
   use rwmf_problem_shear_frame, only: base_shear_share, damping_matrix, roof_factor, shear_frame_t
   implicit none
   private

   public :: set_storeys, storey_coefficients, excited_mass_coefficients
   public :: storey_sizes, storey_energy

contains

   !> Add the frame's storeys to the equation. In a spectrum all stiffnesses scale with the period.
   subroutine set_storeys(case, equation)
      type(case_t), intent(in) :: case
      !! case with `&storeys` and its modes
      type(equation_t), intent(inout) :: equation
      type(shear_frame_t) :: frame
      real(wp) :: unit
      !! reference mass of energies over m_w: 1, or without wall the roof's mass [-]
      real(wp) :: pace
      !! frequency of this scene over that of the case's storeys [-]
      integer :: n

      frame = case%frame%floors
      n = size(frame%m)
      if (.not. has_all_modes(case)) then
         equation%floors%excited_mass_ratio = roof_factor(frame, 1)
         equation%floors%base_shear_ratio = equation%floors%excited_mass_ratio
         equation%floors%are_linked = case%frame%coupling == 'every_floor'
         if (equation%floors%are_linked) equation%floors%base_shear_ratio = base_shear_share(frame)
         equation%floors%mass = frame_mass(equation)*(sum(frame%m)*frame%shape(n, 1)**2 - 1)
         if (equation%floors%are_linked .and. has_numbers(case, 'bending')) then
            call set_linked_floors(case, equation)
         end if
         return
      end if
      unit = 1
      if (.not. allocated(case%wall)) unit = frame%m(n)
      pace = 2*pi/case%frame%T_s/frame%omega(1)
      equation%floors%n = n
      equation%floors%n_storeys = n
      equation%floors%free = n - 1
      equation%floors%unit = unit
      equation%floors%m = frame%m/unit
      equation%floors%height = frame%height
      equation%floors%k = frame%k*pace**2/unit
      equation%floors%mass = sum(equation%floors%m(:n - 1))
      equation%floors%c = damping_matrix(frame, case%frame%xi_s)
      equation%floors%c(:, :) = equation%floors%c*(pace/unit)
      allocate (equation%state%storey_branches(n))
      equation%state%storey_branches%slope = equation%floors%k
      equation%floors%max_frequency = frame%omega(n)*pace
      equation%p%omega_s = sqrt(equation%floors%k(n)/equation%floors%m(n))
      equation%p%omega_squared = equation%p%omega_s**2
      equation%state%frame_slope = 0
      equation%p%xi_s = 0
      equation%p%two_xi_omega = 0
      if (allocated(case%frame%k_link)) call set_link_springs(case%frame%k_link, equation)
      equation%moves_at_rest = equation%has_impacts .and. equation%floors%free > 0
   end subroutine set_storeys

   !> Collect the floors that are linked to a bending wall one by one.
   subroutine set_linked_floors(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      real(wp) :: unit, pace
      !! unit of the masses over m_w [-]; frequency over that of the case's storeys [-]
      integer :: i

      allocate (equation%beam%floors)
      associate (frame => case%frame%floors, floors => equation%beam%floors)
         unit = frame_mass(equation)*frame%shape(size(frame%m), 1)**2
         pace = 2*pi/case%frame%T_s/frame%omega(1)
         floors%share = [(sum(frame%height(:i)), i=1, size(frame%m))]/sum(frame%height)
         floors%m = unit*frame%m
         floors%k = unit*frame%k*pace**2
         floors%load = 0*frame%m
         floors%viscous_time = case%frame%xi_s*case%frame%T_s/pi
         equation%floors%n_storeys = size(floors%k)
         allocate (equation%state%storey_branches(size(floors%k)))
         equation%state%storey_branches%slope = floors%k
      end associate
   end subroutine set_linked_floors

   !> Release the roof from the wall and link each floor to the wall by a spring. No mass of the
   !> frame moves with the wall (`is_linked` of the case's frame).
   subroutine set_link_springs(k_link, equation)
      real(wp), intent(in) :: k_link(:)
      !! stiffness of each spring over m_w [1/s2]
      type(equation_t), intent(inout) :: equation
      integer :: i

      associate (floors => equation%floors)
         floors%free = floors%n
         floors%are_linked = .true.
         floors%k_link = k_link
         floors%share = [(sum(floors%height(:i)), i=1, floors%n)]/sum(floors%height)
         floors%mass = sum(floors%m)
         ! no energy of the springs exceeds the sum of those with the wall and with the floors held
         floors%max_frequency = sqrt(floors%max_frequency**2 + maxval(k_link/floors%m) &
            + sum(k_link*floors%share**2)*4*equation%p%cos_alpha**2/equation%inertia)
      end associate
   end subroutine set_link_springs

   !> Coefficients of `add_floors`, for all modes.
   pure subroutine storey_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)
      !! coefficients of `add_floors`
      integer :: i

      associate (floors => model%floors, n => model%floors%n)
         coef(:2*n + 1) = [model%p%R, state%storey_branches%slope, state%storey_branches%offset]
         coef(2*n + 2:3*n + 1) = 1/floors%m
         do i = 1, n
            coef(3*n + 2 + (i - 1)*n:3*n + 1 + i*n) = floors%c(i, :)
         end do
         if (allocated(floors%laws)) coef(3*n + 2 + n**2:7*n + 1 + n**2) = &
            [floors%laws%force_at_z1, 1/floors%laws%u_y, state%storey_signs%lost, &
            floors%laws%exponent]
         if (.not. allocated(floors%k_link)) return
         coef(effect%n_coef - 2*n + 1:) = [floors%share, floors%k_link]
         ! the loop of the modes applies the springs of a bending wall
         if (model%beam%n > 0) coef(effect%n_coef - n + 1:) = 0
      end associate
   end subroutine storey_coefficients

   !> Coefficient of `add_excited_mass`: mass excited by the ground minus mass moving with the
   !> roof.
   pure subroutine excited_mass_coefficients(effect, model, state, coef)
      type(contribution_t), intent(in) :: effect
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      real(wp), intent(out) :: coef(:)
      !! coefficient of `add_excited_mass` [-]

      coef(1) = frame_mass(model)*(model%floors%excited_mass_ratio - 1)
   end subroutine excited_mass_coefficients

   !> Estimate the size of the states: floors move about as much as the roof, z is at most d/u_y
   !> and 1.
   subroutine storey_sizes(effect, equation, size_guess, sizes)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! sizes of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
      real(wp), intent(out) :: sizes(:)
      !! (states of the effect) sizes of displacements [m] and velocities [m/s] of the floors, and
      !! of z [-]

      associate (n => equation%floors%free)
         sizes(:n) = frame_travel(equation)*size_guess(1)
         sizes(n + 1:2*n) = frame_travel(equation)*size_guess(2)
         if (allocated(equation%floors%laws)) sizes(2*n + 1:) = min(1.0_wp, &
            frame_travel(equation)*size_guess(1)/equation%floors%laws%u_y)
      end associate
   end subroutine storey_sizes

   !> Kinetic energy of the floors with states, and strain energy of storeys and link springs
   !> [J/kg]. The latter excludes the energy of the frame of `equation_t`, the uppermost spring at
   !> the displacement of a linked roof.
   function storey_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! states
      real(wp) :: energy(2)
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))
      integer :: n

      n = size(v)
      call floor_motion(equation, equation%state%side, y, u, v)
      associate (free => equation%floors%free)
         energy(1) = sum(equation%floors%m(:free)*v(:free)**2)/2
      end associate
      if (allocated(equation%floors%k_link)) then
         energy(2) = sum(link_pulls(equation, y)**2/equation%floors%k_link)/2
      else
         energy(2) = -equation%floors%k(n)*u(n)**2/2
      end if
      energy(2) = energy(2) + storey_strain(equation, y, u(1:) - u(:n - 1))
   end function storey_energy

end module rwmf_model_effects_storeys_shear_building
