!> The scalars of a run by the keys of the table of quantities: the one place that says which number
!> of a result each key stands for. Summaries, spectra and sweeps read it.
module rwmf_simulation_scalars
   use rwmf_core_kinds, only: i8, wp
   use rwmf_problem_case, only: case_t, storeys_t
   use rwmf_problem_shear_frame, only: modal_height, modal_mass, roof_factor
   use rwmf_simulation_newtons, only: ratios, weight_under
   use rwmf_simulation_result, only: demand_extremes_t, energy_t, reaction_extremes_t, result_t
   implicit none
   private

   public :: scalar_t, scalar_of

   !> One scalar.
   type :: scalar_t
      logical :: is_present = .false.
      !! it applies to the scene
      real(wp) :: number = 0
      !! of a 'real' [unit of the key]
      integer(i8) :: count = 0
      !! of an 'int'; of a 'logical' 1 for yes
   end type scalar_t

contains

   !> The number that a key stands for; not present: it does not apply, or is no number.
   pure type(scalar_t) function scalar_of(case, result, key, storey) result(scalar)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key
      !! as it stands in the table
      integer, intent(in) :: storey
      !! its number from the ground up, for a key with '{i}'

      integer :: behind, i

      scalar = number_of(case, result, key, storey)
      behind = index(key, '_N', back=.true.)
      if (scalar%is_present .or. behind == 0 .or. .not. case%unit_mass > 0) return
      ! a force in N, a moment in N m
      do i = 1, size(ratios)
         associate (ratio => key(:behind - 1)//trim(ratios(i))//key(behind + 2:))
            scalar = number_of(case, result, ratio, storey)
            if (scalar%is_present) scalar%number = scalar%number*weight_under(case, ratio)
         end associate
         if (scalar%is_present) return
      end do
   end function scalar_of

   !> The same of what is not in N.
   pure type(scalar_t) function number_of(case, result, key, storey) result(scalar)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key
      integer, intent(in) :: storey

      scalar = peak_of(result, key, storey)
      if (.not. scalar%is_present) scalar = ending_of(result, key, storey)
      if (.not. scalar%is_present) scalar = effort_of(result, key)
      if (allocated(result%reactions) .and. .not. scalar%is_present) then
         scalar = reaction_of(result%reactions, key)
      end if
      if (allocated(result%demands) .and. .not. scalar%is_present) then
         scalar = demand_of(result%demands, key, storey)
      end if
      if (allocated(result%energy) .and. .not. scalar%is_present) then
         scalar = energy_of(result%energy, key)
      end if
      if (allocated(case%storeys) .and. .not. scalar%is_present) then
         scalar = storeys_of(case%storeys, key)
         if (key == 'T_s_s') scalar = of_real(case%frame%T_s)
      end if
   end function number_of

   !> Suprema of the response, and their times.
   pure type(scalar_t) function peak_of(result, key, storey) result(scalar)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key
      integer, intent(in) :: storey

      ! an unallocated component is an absent argument
      select case (key)
      case ('u_s_max_m')
         scalar = of_real(result%u_s_max)
      case ('t_u_s_max_s')
         scalar = of_real(result%t_u_s_max)
      case ('theta_max_over_alpha')
         scalar = of_real(result%theta_max_over_alpha)
      case ('theta_dot_max_rad_s')
         scalar = of_real(result%theta_dot_max)
      case ('cable_force_increment_max_over_m_w_g')
         scalar = of_real(result%cable_increment_max)
      case ('ductility')
         scalar = of_real(result%ductility)
      case ('storey_{i}_ductility')
         scalar = of_list(result%storey_ductility, storey)
      case default
         ! not here
      end select
   end function peak_of

   !> What is left in the end, and how often something happened until then.
   pure type(scalar_t) function ending_of(result, key, storey) result(scalar)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key
      integer, intent(in) :: storey

      select case (key)
      case ('cable_prestress_loss_over_m_w_g')
         scalar = of_real(result%prestress_loss)
      case ('cable_ruptured')
         scalar = of_logical(result%has_ruptured)
      case ('residual_displacement_m')
         scalar = of_real(result%residual_displacement)
      case ('theta_end_over_alpha')
         scalar = of_real(result%theta_end_over_alpha)
      case ('storey_{i}_residual_drift')
         scalar = of_list(result%storey_residual_drift, storey)
      case ('storey_{i}_residual_drift_at_rest')
         scalar = of_list(result%storey_at_rest, storey)
      case ('impacts')
         if (result%has_impacts) scalar = of_count(result%impacts)
      case ('lift_offs')
         if (result%has_impacts) scalar = of_count(result%lift_offs)
      case ('overturned')
         if (result%has_impacts .or. allocated(result%theta_max)) scalar = of_logical( &
            result%overturned)
      case ('collapsed')
         scalar = of_logical(result%collapsed)
      case ('t_collapse_s')
         scalar = of_real(result%t_collapse)
      case ('e')
         scalar = of_real(result%e)
      case ('e_max')
         scalar = of_real(result%e_max)
      case default
         ! not here
      end select
   end function ending_of

   !> What the integration took, and how far it can be trusted.
   pure type(scalar_t) function effort_of(result, key) result(scalar)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: key

      select case (key)
      case ('steps')
         scalar = of_count(result%steps)
      case ('rhs_evaluations')
         scalar = of_count(result%rhs_evaluations)
      case ('seconds')
         scalar = of_real(result%seconds)
      case ('rtol')
         scalar = of_real(result%rtol)
      case ('estimated_relative_error')
         scalar = of_real(result%estimated_relative_error)
      case ('estimate_seconds')
         scalar = of_real(result%estimate_seconds)
      case ('sensitivity')
         scalar = of_real(result%sensitivity)
      case default
         ! not here
      end select
   end function effort_of

   !> What the foundation bears.
   pure type(scalar_t) function reaction_of(reactions, key) result(scalar)
      type(reaction_extremes_t), intent(in) :: reactions
      character(*), intent(in) :: key

      select case (key)
      case ('base_shear_max_over_weight')
         scalar = of_real(reactions%base_shear_max)
      case ('t_base_shear_max_s')
         scalar = of_real(reactions%t_base_shear_max)
      case ('pivot_normal_min_over_m_w_g')
         scalar = of_real(reactions%normal_min)
      case ('t_pivot_normal_min_s')
         scalar = of_real(reactions%t_normal_min)
      case ('pivot_lifts')
         scalar = of_logical(reactions%pivot_lifts)
      case ('friction_demand_max')
         scalar = of_real(reactions%demand_max)
      case ('t_friction_demand_max_s')
         scalar = of_real(reactions%t_demand_max)
      case ('shear_key_force_max_over_m_w_g')
         scalar = of_real(reactions%shear_key_max)
      case ('t_shear_key_force_max_s')
         scalar = of_real(reactions%t_shear_key_max)
      case ('friction_exceeded')
         scalar = of_logical(reactions%is_exceeded)
      case ('t_friction_exceeded_s')
         scalar = of_real(reactions%t_exceeded)
      case ('wall_drift_max')
         scalar = of_real(reactions%wall_drift_max)
      case ('frame_drift_max')
         scalar = of_real(reactions%frame_drift_max)
      case default
         ! not here
      end select
   end function reaction_of

   !> What the building is designed for.
   pure type(scalar_t) function demand_of(demands, key, storey) result(scalar)
      type(demand_extremes_t), intent(in) :: demands
      character(*), intent(in) :: key
      integer, intent(in) :: storey

      select case (key)
      case ('storey_{i}_drift_max')
         scalar = of_list(demands%drift_max, storey)
      case ('storey_drift_max')
         scalar = of_largest(demands%drift_max)
      case ('t_storey_drift_max_s')
         scalar = of_real(demands%t_drift_max)
      case ('roof_drift_max')
         scalar = of_real(demands%roof_drift_max)
      case ('t_roof_drift_max_s')
         scalar = of_real(demands%t_roof_drift_max)
      case ('storey_residual_drift_max')
         scalar = of_largest(demands%residual_drift)
      case ('roof_residual_drift')
         scalar = of_real(demands%roof_residual_drift)
      case ('roof_residual_drift_at_rest')
         scalar = of_real(demands%roof_at_rest)
      case ('floor_{i}_acceleration_max_g')
         scalar = of_list(demands%acceleration_max, storey)
      case ('floor_acceleration_max_g')
         scalar = of_largest(demands%acceleration_max)
      case ('t_floor_acceleration_max_s')
         scalar = of_real(demands%t_acceleration_max)
      case ('storey_{i}_shear_max_over_m_w_g')
         scalar = of_list(demands%shear_max, storey)
      case ('overturning_moment_max_over_weight_m')
         scalar = of_real(demands%overturning_max)
      case ('t_overturning_moment_max_s')
         scalar = of_real(demands%t_overturning_max)
      case ('wall_shear_max_over_m_w_g')
         scalar = of_real(demands%wall_shear_max)
      case ('wall_shear_max_height_m')
         scalar = of_real(demands%wall_shear_height)
      case ('wall_moment_max_over_m_w_g_m')
         scalar = of_real(demands%wall_moment_max)
      case ('wall_moment_max_height_m')
         scalar = of_real(demands%wall_moment_height)
      case default
         ! not here
      end select
   end function demand_of

   !> The ledger: its parts in the end, and what they miss.
   pure type(scalar_t) function energy_of(energy, key) result(scalar)
      type(energy_t), intent(in) :: energy
      character(*), intent(in) :: key
      integer :: i

      if (key == 'energy_balance_relative') then
         scalar = of_real(energy_balance(energy))
         return
      end if
      i = findloc(energy%names == key, .true., dim=1)
      if (i > 0) scalar = of_real(energy%values(i))
   end function energy_of

   !> Residual of the energy ledger over initial plus largest input energy [-].
   pure real(wp) function energy_balance(energy)
      type(energy_t), intent(in) :: energy
      real(wp) :: residual
      real(wp) :: scale

      residual = energy%final + energy%viscous + energy%impact + energy%hysteretic &
         - energy%initial - energy%input
      scale = abs(energy%initial) + energy%input_max
      energy_balance = 0.0_wp
      if (scale > 0.0_wp) energy_balance = abs(residual)/scale
   end function energy_balance

   !> The first mode of the frame's storeys, and its share in the mass: what a reduction keeps.
   pure type(scalar_t) function storeys_of(storeys, key) result(scalar)
      type(storeys_t), intent(in) :: storeys
      character(*), intent(in) :: key

      associate (frame => storeys%frame)
         select case (key)
         case ('modal_mass_over_m_w')
            scalar = of_real(modal_mass(frame, 1))
         case ('mass_participation')
            scalar = of_real(modal_mass(frame, 1)/sum(frame%m))
         case ('modal_height_m')
            scalar = of_real(modal_height(frame, 1))
         case ('roof_factor')
            scalar = of_real(roof_factor(frame, 1))
         case default
            ! not here
         end select
      end associate
   end function storeys_of

   !> A real, unless it is absent.
   pure type(scalar_t) function of_real(number) result(scalar)
      real(wp), intent(in), optional :: number

      if (present(number)) scalar = scalar_t(.true., number=number)
   end function of_real

   !> One of a list of reals, unless it is absent or too short.
   pure type(scalar_t) function of_list(numbers, i) result(scalar)
      real(wp), intent(in), optional :: numbers(:)
      integer, intent(in) :: i

      if (.not. present(numbers)) return
      if (i >= 1 .and. i <= size(numbers)) scalar = scalar_t(.true., number=numbers(i))
   end function of_list

   !> The largest magnitude in a list of reals, unless it is absent.
   pure type(scalar_t) function of_largest(numbers) result(scalar)
      real(wp), intent(in), optional :: numbers(:)

      if (present(numbers)) scalar = scalar_t(.true., number=maxval(abs(numbers)))
   end function of_largest

   !> A counter.
   pure type(scalar_t) function of_count(count) result(scalar)
      integer(i8), intent(in) :: count

      scalar = scalar_t(.true., count=count)
   end function of_count

   !> A yes or no, unless it is absent.
   pure type(scalar_t) function of_logical(value) result(scalar)
      logical, intent(in), optional :: value

      if (present(value)) scalar = scalar_t(.true., count=merge(1_i8, 0_i8, value))
   end function of_logical

end module rwmf_simulation_scalars
