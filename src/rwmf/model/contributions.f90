!> Effects beyond wall, frame and cable: which of them a case calls for, and what they have in
!> common. One line in `choose_contributions` for each.
module rwmf_model_contributions
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_corner_damper, only: add_damper, damper_force, damper_power
   use rwmf_model_effects_corner_inerter, only: add_inerter, inerter_energy, inerter_force
   use rwmf_model_effects_storeys_shear_building, only: add_excited_mass, add_storeys, &
      excited_mass_input, prepare_storeys, storey_energy, storey_input, storey_power, storey_sizes
   use rwmf_model_effects_storeys_yielding_storeys, only: choose_storey_springs, &
      storeys_plastic_power
   use rwmf_model_effects_vertical_motion, only: add_vertical
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_model_hysteresis_bouc_wen, only: add_bouc_wen, bouc_wen_energy, bouc_wen_power, &
      bouc_wen_sizes, prepare_bouc_wen
   use rwmf_model_hysteresis_spring_set, only: add_fuses, add_springs, add_yielding, &
      choose_springs, is_elastic_plastic, springs_energy, springs_force, springs_power
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: choose_contributions, are_lines, is_smooth_hysteresis
   public :: state_sizes, effects_energy, effects_power, effects_input

contains

   !> Put the further effects of a case on the list. Scenes without any have no list.
   subroutine choose_contributions(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      logical :: is_bilinear
      !! the frame is elastic-plastic, all of it together
      logical :: is_smooth
      !! it has one smooth hysteresis
      logical :: is_full
      !! it has all its modes

      call look_at_frame(case, is_bilinear, is_smooth, is_full)
      ! first of all, as `rates_with_floors` knows
      if (is_full) call add_floors(case, equation)
      if (allocated(case%damper)) then
         equation%damper_c = corner_share(equation)*case%damper%c_over_m_w
         call append_contribution(equation, contribution_t(add=add_damper, power=damper_power, &
            force=damper_force))
      end if
      if (allocated(case%fuse) .or. is_bilinear .or. equation%cable%is_tendon) then
         call choose_springs(case, is_bilinear, equation)
      end if
      if (allocated(case%fuse) .or. is_bilinear) then
         call append_contribution(equation, contribution_t(add=add_springs, plastic_power=springs_power, &
            energy=springs_energy, force=springs_force))
         associate (extra => equation%effects(size(equation%effects)))
            if (.not. is_bilinear) extra%add => add_fuses
            if (.not. allocated(case%fuse)) extra%add => add_yielding
         end associate
      end if
      if (is_smooth) then
         call prepare_bouc_wen(case, equation)
         call append_contribution(equation, contribution_t(add=add_bouc_wen, plastic_power=bouc_wen_power, &
            energy=bouc_wen_energy, states=1, sizes=bouc_wen_sizes))
      end if
      if (allocated(case%storeys) .and. .not. is_full) then
         call prepare_storeys(case, equation)
         call append_contribution(equation, contribution_t(add=add_excited_mass, input=excited_mass_input, &
            is_motion=.true.))
      end if
      if (allocated(case%inerter)) then
         equation%inertance = corner_share(equation)*case%inerter%inertance_over_m_w
         call append_contribution(equation, contribution_t(add=add_inerter, energy=inerter_energy, &
            force=inerter_force))
      end if
      if (allocated(case%vertical)) then
         equation%has_vertical = .true.
         equation%weight_share = tan(equation%p%alpha)/(1 + &
            2*equation%p%gamma*equation%excited_mass_ratio)
         call append_contribution(equation, contribution_t(add=add_vertical, is_motion=.true.))
      end if
   end subroutine choose_contributions

   !> Has the frame all its modes, or else a yielding spring of its own, and which?
   pure subroutine look_at_frame(case, is_bilinear, is_smooth, is_full)
      type(case_t), intent(in) :: case
      logical, intent(out) :: is_bilinear
      logical, intent(out) :: is_smooth
      logical, intent(out) :: is_full

      is_bilinear = .false.
      is_smooth = .false.
      is_full = .false.
      if (allocated(case%storeys)) is_full = case%storeys%coupling == 'full'
      if (is_full .or. .not. allocated(case%yielding)) return
      is_bilinear = is_elastic_plastic(case%yielding)
      is_smooth = .not. is_bilinear
   end subroutine look_at_frame

   !> A rocking wall has one corner that moves, at the arm 2b; a hinged one two with half the arm
   !> and so half the moment [-].
   pure real(wp) function corner_share(equation)
      type(equation_t), intent(in) :: equation

      corner_share = merge(1.0_wp, 0.5_wp, equation%has_impacts)
   end function corner_share

   !> Are all further effects those that `corner_with_lines` and `frame_with_lines` have written
   !> out?
   pure logical function are_lines(equation)
      type(equation_t), intent(in) :: equation
      integer :: i

      are_lines = .true.
      do i = 1, size(equation%effects)
         associate (extra => equation%effects(i))
            if (associated(extra%add, add_yielding) .or. associated(extra%add, add_vertical) &
                .or. associated(extra%add, add_excited_mass)) cycle
            are_lines = .false.
         end associate
      end do
   end function are_lines

   !> Is the smooth hysteresis the only further effect? It has a right-hand side of its own.
   pure logical function is_smooth_hysteresis(equation)
      type(equation_t), intent(in) :: equation

      is_smooth_hysteresis = .false.
      if (size(equation%effects) == 1) is_smooth_hysteresis = &
         associated(equation%effects(1)%add, add_bouc_wen)
   end function is_smooth_hysteresis

   !> The floors of a frame with all its modes, whose storeys may yield.
   subroutine add_floors(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t) :: floors

      call prepare_storeys(case, equation)
      equation%floors%first = equation%n + 1
      floors = contribution_t(add=add_storeys, power=storey_power, energy=storey_energy, &
         input=storey_input, states=2*equation%floors%n - 2, sizes=storey_sizes)
      if (allocated(case%yielding)) then
         call choose_storey_springs(case, equation)
         floors%plastic_power => storeys_plastic_power
         if (allocated(equation%floors%laws)) floors%states = floors%states + equation%floors%n
      end if
      call append_contribution(equation, floors)
   end subroutine add_floors

   !> Append an effect; its states come after those that are there.
   subroutine append_contribution(equation, extra)
      type(equation_t), intent(inout) :: equation
      type(contribution_t), intent(in) :: extra

      if (.not. allocated(equation%effects)) allocate (equation%effects(0))
      equation%effects = [equation%effects, extra]
      ! what acts at both corners of a hinged wall is a couple
      if (.not. equation%has_impacts) equation%effects(size(equation%effects))%force => null()
      equation%effects(size(equation%effects))%first = equation%n + 1
      equation%n = equation%n + extra%states
   end subroutine append_contribution

   !> Expected sizes of all states from those of the first two, for absolute tolerances.
   function state_sizes(equation, size_guess) result(sizes)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
      real(wp) :: sizes(equation%n)
      integer :: i

      sizes(:2) = size_guess
      if (equation%n == 2) return
      do i = 1, size(equation%effects)
         associate (extra => equation%effects(i))
            if (extra%states == 0) cycle
            call extra%sizes(equation, size_guess, &
               sizes(extra%first:extra%first + extra%states - 1))
         end associate
      end do
   end function state_sizes

   !> Energy that further effects store [J/kg].
   real(wp) function effects_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      integer :: i

      energy = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         if (associated(equation%effects(i)%energy)) then
            energy = energy + equation%effects(i)%energy(equation, y)
         end if
      end do
   end function effects_energy

   !> Power that further effects dissipate [W/kg].
   real(wp) function effects_power(equation, t, y, is_hysteretic) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      logical, intent(in) :: is_hysteretic
      !! by yielding, or else by the others
      integer :: i

      power = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         associate (extra => equation%effects(i))
            if (is_hysteretic) then
               if (associated(extra%plastic_power)) power = power &
                  + extra%plastic_power(equation, t, y)
            else
               if (associated(extra%power)) power = power + extra%power(equation, t, y)
            end if
         end associate
      end do
   end function effects_power

   !> Power of the ground motion on masses of further effects [W/kg].
   real(wp) function effects_input(equation, t, y) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      integer :: i

      power = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         if (associated(equation%effects(i)%input)) then
            power = power + equation%effects(i)%input(equation, t, y)
         end if
      end do
   end function effects_input

end module rwmf_model_contributions
