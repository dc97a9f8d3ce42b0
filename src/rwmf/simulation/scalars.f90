!> Scalars of a run by their numbers in the table of quantities.
!>
!> This module alone maps the components of a result to these numbers. Summaries, spectra and sweeps
!> use it.
module rwmf_simulation_scalars
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_elements, only: of_cable, of_coupling, of_fuse, of_restraint
   use rwmf_problem_case, only: case_t, has_floors
   use rwmf_problem_quantity_table, only: all_quantities, id, sensitivity_id
   use rwmf_problem_shear_frame, only: modal_height, modal_mass, roof_factor, shear_frame_t
   use rwmf_simulation_state_newtons, only: weight_under
   use rwmf_simulation_state_result, only: demand_extremes_t, element_extremes_t, energy_t, &
      envelope_extremes_t, reaction_extremes_t, result_t
   implicit none
   private

   public :: values_t, scalars_of, is_present, value_of, floors_of

   !> Scalars, indexed by the numbers of the table and, behind them, of its sensitivities.
   type :: values_t
      integer :: count(2*size(all_quantities)) = 0
      !! number of the highest storey or floor for a list, 1 for a single number, 0 if not
      !! applicable
      integer, private :: below(2*size(all_quantities)) = 0
      !! number of the lowest storeys or floors without a value
      integer, private :: first(2*size(all_quantities)) = 0
      !! place of the first value
      integer, private :: n = 0
      !! number of values in use
      real(wp), allocatable, private :: numbers(:)
      !! [unit of each]; counts unchanged, 1 for true, 0 for false
   end type values_t

contains

   !> Collect all scalars of a run that apply.
   pure subroutine scalars_of(case, result, values)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      type(values_t), intent(out) :: values
      integer :: i

      allocate (values%numbers(2*size(all_quantities)))
      call keep_response(result, values)
      if (allocated(result%reactions)) call keep_reactions(result%reactions, values)
      if (allocated(result%demands)) call keep_demands(result%demands, values)
      if (allocated(result%envelopes)) call keep_envelopes(result%envelopes, values)
      if (allocated(result%energy)) call keep_energies(result%energy, values)
      if (allocated(result%further)) then
         do i = 1, size(result%further)
            call keep(values, result%further(i)%number, result%further(i)%value)
         end do
      end if
      if (has_floors(case)) then
         call keep_first_mode(case%frame%floors, values)
         call keep(values, id%T_s_s, case%frame%T_s)
      end if
      if (case%unit_mass > 0) call keep_newtons(case, values)
      if (.not. allocated(result%sensitivities)) return
      do i = 1, size(result%sensitivities)
         associate (found => result%sensitivities(i))
            if (size(found%values) > 0) call keep_list(values, sensitivity_id(found%number), &
               found%values, found%below)
         end associate
      end do
   end subroutine scalars_of

   !> Return whether a scalar applies.
   elemental logical function is_present(values, number, storey)
      type(values_t), intent(in) :: values
      integer, intent(in) :: number
      !! number of the quantity
      integer, intent(in) :: storey
      !! number of the storey from the ground up for a list; otherwise any number up to 1

      is_present = values%count(number) >= max(1, storey) .and. max(1, storey) &
         > values%below(number)
   end function is_present

   !> Numbers of the storeys or floors with a value; 1 for a single number.
   pure function floors_of(values, number) result(floors)
      type(values_t), intent(in) :: values
      integer, intent(in) :: number
      !! number of the quantity
      integer :: floors(values%count(number) - values%below(number))
      integer :: i

      floors = values%below(number) + [(i, i=1, size(floors))]
   end function floors_of

   !> Scalar [unit of its key]: counts unchanged, 1 for true, 0 for false; NaN if not applicable.
   elemental real(wp) function value_of(values, number, storey) result(value)
      type(values_t), intent(in) :: values
      integer, intent(in) :: number, storey
      !! numbers of the quantity in the table, and of the storey from the ground up

      value = ieee_value(1.0_wp, ieee_quiet_nan)
      if (is_present(values, number, storey)) value = values%numbers(values%first(number) &
         + max(1, storey) - 1 - values%below(number))
   end function value_of

   !> Store the response maxima and their times, the end of the run and its cost.
   pure subroutine keep_response(result, values)
      type(result_t), intent(in) :: result
      type(values_t), intent(inout) :: values

      call keep(values, id%u_s_max_m, result%u_s_max)
      call keep(values, id%t_u_s_max_s, result%t_u_s_max)
      call keep(values, id%tip_deflection_max_m, result%tip_deflection_max)
      call keep(values, id%theta_max_over_alpha, result%theta_max_over_alpha)
      call keep(values, id%theta_dot_max_rad_s, result%theta_dot_max)
      call keep(values, id%cable_force_increment_max_over_m_w_g, result%cable_increment_max)
      call keep(values, id%ductility, result%ductility)
      call keep_list(values, id%storey_i_ductility, result%storey_ductility)
      call keep(values, id%cable_prestress_loss_over_m_w_g, result%prestress_loss)
      call keep_logical(values, id%cable_ruptured, result%has_ruptured)
      call keep(values, id%residual_displacement_m, result%residual_displacement)
      call keep(values, id%theta_end_over_alpha, result%theta_end_over_alpha)
      call keep_list(values, id%storey_i_residual_drift, result%storey_residual_drift)
      call keep_list(values, id%storey_i_residual_drift_at_rest, result%storey_at_rest)
      if (result%has_impacts) call keep_count(values, id%impacts, result%impacts)
      if (result%has_impacts) call keep_count(values, id%lift_offs, result%lift_offs)
      if (result%has_impacts .or. allocated(result%theta_max)) call keep_logical(values, &
         id%overturned, result%overturned)
      call keep_logical(values, id%collapsed, result%collapsed)
      call keep(values, id%t_collapse_s, result%t_collapse)
      call keep(values, id%e, result%e)
      call keep(values, id%e_max, result%e_max)
      if (allocated(result%uplift)) then
         call keep(values, id%uplift_right_g, result%uplift(1))
         call keep(values, id%uplift_left_g, result%uplift(2))
      end if
      call keep(values, id%coupling_ratio, result%coupling_ratio)
      if (allocated(result%modal_damping)) then
         call keep_list(values, id%mode_i_damping_contact, result%modal_damping(:, 1))
         call keep_list(values, id%mode_i_damping_rocking, result%modal_damping(:, 2))
      end if
      call keep_count(values, id%steps, result%steps)
      call keep_count(values, id%rhs_evaluations, result%rhs_evaluations)
      call keep(values, id%seconds, result%seconds)
      call keep(values, id%rtol, result%rtol)
      call keep(values, id%estimated_relative_error, result%estimated_relative_error)
      call keep(values, id%estimate_seconds, result%estimate_seconds)
      call keep(values, id%sensitivity, result%sensitivity)
   end subroutine keep_response

   !> Store the reactions of the foundation.
   pure subroutine keep_reactions(reactions, values)
      type(reaction_extremes_t), intent(in) :: reactions
      type(values_t), intent(inout) :: values

      call keep(values, id%base_shear_max_over_weight, reactions%base_shear_max)
      call keep(values, id%t_base_shear_max_s, reactions%t_base_shear_max)
      call keep(values, id%pivot_normal_min_over_m_w_g, reactions%normal_min)
      call keep(values, id%t_pivot_normal_min_s, reactions%t_normal_min)
      call keep_logical(values, id%pivot_lifts, reactions%pivot_lifts)
      call keep(values, id%friction_demand_max, reactions%demand_max)
      call keep(values, id%t_friction_demand_max_s, reactions%t_demand_max)
      call keep(values, id%friction_demand_impact_max, reactions%impact_demand_max)
      call keep(values, id%shear_key_force_max_over_m_w_g, reactions%shear_key_max)
      call keep(values, id%t_shear_key_force_max_s, reactions%t_shear_key_max)
      call keep_logical(values, id%friction_exceeded, reactions%is_exceeded)
      call keep(values, id%t_friction_exceeded_s, reactions%t_exceeded)
      call keep(values, id%wall_drift_max, reactions%wall_drift_max)
      call keep(values, id%frame_drift_max, reactions%frame_drift_max)
      call keep(values, id%tendon_force_max_over_m_w_g, reactions%tendon_force_max)
      call keep(values, id%tendon_stress_max_Pa, reactions%tendon_stress_max)
      call keep(values, id%tendon_strain_max, reactions%tendon_strain_max)
   end subroutine keep_reactions

   !> Store the design demands of the building.
   pure subroutine keep_demands(demands, values)
      type(demand_extremes_t), intent(in) :: demands
      type(values_t), intent(inout) :: values

      call keep_list(values, id%storey_i_drift_max, demands%drift_max)
      call keep_largest(values, id%storey_drift_max, demands%drift_max)
      call keep(values, id%t_storey_drift_max_s, demands%t_drift_max)
      call keep(values, id%roof_drift_max, demands%roof_drift_max)
      call keep(values, id%t_roof_drift_max_s, demands%t_roof_drift_max)
      call keep_largest(values, id%storey_residual_drift_max, demands%residual_drift)
      call keep(values, id%roof_residual_drift, demands%roof_residual_drift)
      call keep(values, id%roof_residual_drift_at_rest, demands%roof_at_rest)
      call keep_list(values, id%floor_i_acceleration_max_g, demands%acceleration_max)
      call keep_largest(values, id%floor_acceleration_max_g, demands%acceleration_max)
      call keep(values, id%t_floor_acceleration_max_s, demands%t_acceleration_max)
      call keep_list(values, id%storey_i_shear_max_over_m_w_g, demands%shear_max)
      call keep(values, id%overturning_moment_max_over_weight_m, demands%overturning_max)
      call keep(values, id%t_overturning_moment_max_s, demands%t_overturning_max)
      call keep(values, id%wall_shear_max_over_m_w_g, demands%wall_shear_max)
      call keep(values, id%wall_shear_max_height_m, demands%wall_shear_height)
      call keep(values, id%wall_moment_max_over_m_w_g_m, demands%wall_moment_max)
      call keep(values, id%wall_moment_max_height_m, demands%wall_moment_height)
   end subroutine keep_demands

   !> Store the design forces of the members.
   pure subroutine keep_envelopes(envelopes, values)
      type(envelope_extremes_t), intent(in) :: envelopes
      type(values_t), intent(inout) :: values
      integer :: links

      call keep_list(values, id%floor_i_velocity_max_m_s, envelopes%velocity_max)
      if (allocated(envelopes%elements)) call keep_elements(envelopes%elements, values)
      call keep(values, id%contact_length_min_m, envelopes%contact_min)
      call keep(values, id%toe_stress_max_Pa, envelopes%toe_stress_max)
      call keep(values, id%toe_strain_max, envelopes%toe_strain_max)
      call keep(values, id%pivot_normal_max_over_m_w_g, envelopes%normal_max)
      if (.not. allocated(envelopes%base)) return
      call keep(values, id%wall_shear_base_max_over_m_w_g, envelopes%base(1))
      call keep(values, id%wall_moment_base_max_over_m_w_g_m, envelopes%base(2))
      call keep(values, id%wall_shear_mid_max_over_m_w_g, envelopes%middle(1))
      call keep(values, id%wall_moment_mid_max_over_m_w_g_m, envelopes%middle(2))
      call keep_list(values, id%wall_shear_i_max_over_m_w_g, envelopes%shear_below)
      call keep_list(values, id%wall_shear_i_above_max_over_m_w_g, envelopes%shear_above)
      call keep_list(values, id%wall_moment_i_max_over_m_w_g_m, envelopes%moment_below)
      call keep_list(values, id%wall_moment_i_above_max_over_m_w_g_m, envelopes%moment_above)
      if (.not. allocated(envelopes%link_max)) return
      links = size(envelopes%link_max)
      call keep_list(values, id%link_i_force_max_over_m_w_g, envelopes%link_max, &
         size(envelopes%velocity_max) - links)
   end subroutine keep_envelopes

   !> Store strokes and forces of the vertical elements.
   pure subroutine keep_elements(elements, values)
      type(element_extremes_t), intent(in) :: elements(:)
      type(values_t), intent(inout) :: values

      associate (group => elements%group, low => elements%stroke(1), high => elements%stroke(2), &
         travel => elements%travel, force => elements%force(2), end => elements%force_end)
         if (any(group == of_fuse)) then
            call keep(values, id%fuse_stroke_max_m, maxval(max(high, -low), group == of_fuse))
            call keep(values, id%fuse_stroke_sum_m, maxval(travel, group == of_fuse))
            call keep_list(values, id%fuse_i_stroke_max_m, pack(high, group == of_fuse))
            call keep_list(values, id%fuse_i_stroke_min_m, pack(low, group == of_fuse))
            call keep_list(values, id%fuse_i_stroke_sum_m, pack(travel, group == of_fuse))
            call keep_list(values, id%fuse_i_force_max_over_m_w_g, pack(force, group == of_fuse))
            call keep_list(values, id%fuse_i_force_end_over_m_w_g, pack(end, group == of_fuse))
         end if
         if (any(group == of_restraint)) then
            call keep_list(values, id%restraint_i_stroke_max_m, pack(high, group == of_restraint))
            call keep_list(values, id%restraint_i_stroke_min_m, pack(low, group == of_restraint))
            call keep_list(values, id%restraint_i_stroke_sum_m, pack(travel, group &
               == of_restraint))
            call keep_list(values, id%restraint_i_force_max_over_m_w_g, pack(force, group &
               == of_restraint))
            call keep_list(values, id%restraint_i_force_end_over_m_w_g, pack(end, group &
               == of_restraint))
         end if
         if (any(group == of_coupling)) then
            call keep(values, id%coupling_stroke_max_m, maxval(max(high, -low), group &
               == of_coupling))
            call keep(values, id%coupling_stroke_sum_m, sum(travel, group == of_coupling))
            call keep(values, id%coupling_force_max_over_m_w_g, sum(force, group == of_coupling))
            call keep(values, id%coupling_force_end_over_m_w_g, sum(end, group == of_coupling))
         end if
         if (any(group == of_cable)) then
            call keep_list(values, id%cable_i_force_max_over_m_w_g, pack(force, group == of_cable))
            call keep_list(values, id%cable_i_force_min_over_m_w_g, pack(elements%force(1), group &
               == of_cable))
            call keep_list(values, id%cable_i_prestress_loss_over_m_w_g, pack(elements%loss, &
               group == of_cable))
         end if
      end associate
   end subroutine keep_elements

   !> Store the energy terms at the end, and the residual over initial plus largest input energy.
   pure subroutine keep_energies(energy, values)
      type(energy_t), intent(in) :: energy
      type(values_t), intent(inout) :: values
      real(wp) :: residual, scale, balance
      integer :: i

      do i = 1, size(energy%values)
         call keep(values, energy%numbers(i), energy%values(i))
      end do
      residual = energy%final + energy%viscous + energy%bending + energy%impact &
         + energy%hysteretic - energy%initial - energy%input
      scale = abs(energy%initial) + energy%input_max
      balance = 0
      if (scale > 0) balance = abs(residual)/scale
      call keep(values, id%energy_balance_relative, balance)
   end subroutine keep_energies

   !> Store the properties of the frame's first mode, including its modal mass ratio.
   pure subroutine keep_first_mode(frame, values)
      type(shear_frame_t), intent(in) :: frame
      type(values_t), intent(inout) :: values

      call keep(values, id%modal_mass_over_m_w, modal_mass(frame, 1))
      call keep(values, id%mass_participation, modal_mass(frame, 1)/sum(frame%m))
      call keep(values, id%modal_height_m, modal_height(frame, 1))
      call keep(values, id%roof_factor, roof_factor(frame, 1))
   end subroutine keep_first_mode

   !> Convert force ratios to N and moment ratios to N m.
   pure subroutine keep_newtons(case, values)
      type(case_t), intent(in) :: case
      type(values_t), intent(inout) :: values
      integer :: i, first

      do i = 1, size(all_quantities)
         associate (ratio => all_quantities(i)%ratio)
            if (ratio == 0) cycle
            if (values%count(ratio) == 0) cycle
            first = values%first(ratio)
            associate (below => values%below(ratio), n => size(floors_of(values, ratio)))
               call keep_list(values, all_quantities(i)%id, values%numbers(first:first + n - 1) &
                  *weight_under(case, ratio), below)
            end associate
         end associate
      end do
   end subroutine keep_newtons

   !> Store a list; skip absent arguments, such as unallocated components.
   pure subroutine keep_list(values, number, list, below)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: number
      !! number of the quantity
      real(wp), intent(in), optional :: list(:)
      !! (storeys or floors)
      integer, intent(in), optional :: below
      !! number of the lowest storeys or floors without a value; absent: 0
      real(wp), allocatable :: longer(:)

      if (.not. present(list)) return
      if (values%n + size(list) > size(values%numbers)) then
         allocate (longer(2*(values%n + size(list))))
         longer(:values%n) = values%numbers(:values%n)
         call move_alloc(longer, values%numbers)
      end if
      if (present(below)) values%below(number) = below
      values%count(number) = values%below(number) + size(list)
      values%first(number) = values%n + 1
      values%numbers(values%n + 1:values%n + size(list)) = list
      values%n = values%n + size(list)
   end subroutine keep_list

   !> Store one number if it is present.
   pure subroutine keep(values, number, value)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: number
      real(wp), intent(in), optional :: value

      if (present(value)) call keep_list(values, number, [value])
   end subroutine keep

   !> Store the largest magnitude of a list.
   pure subroutine keep_largest(values, number, list)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: number
      real(wp), intent(in), optional :: list(:)

      if (present(list)) call keep_list(values, number, [maxval(abs(list))])
   end subroutine keep_largest

   !> Store a count.
   pure subroutine keep_count(values, number, count)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: number
      integer(i8), intent(in) :: count

      call keep_list(values, number, [real(count, wp)])
   end subroutine keep_count

   !> Store a logical value, if present, as 1 for true and 0 for false.
   pure subroutine keep_logical(values, number, value)
      type(values_t), intent(inout) :: values
      integer, intent(in) :: number
      logical, intent(in), optional :: value

      if (present(value)) call keep_list(values, number, [merge(1.0_wp, 0.0_wp, value)])
   end subroutine keep_logical

end module rwmf_simulation_scalars
