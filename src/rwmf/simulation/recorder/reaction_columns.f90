!> Reported reactions of a run: columns of the history, and extrema.
module rwmf_simulation_recorder_reaction_columns
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: tip_displacement
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_reactions, only: friction_demand, reactions_at, reactions_t, wall_drift
   use rwmf_model_system_reactions_loop, only: low_normal, shear
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_recorder_reaction_extremes, only: first_exceedance, &
      reaction_extremes_recorder_t
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
   implicit none
   private

   public :: put_reactions, put_reaction_extremes

contains

   !> Fill in the columns of the history at one instant.
   subroutine put_reactions(row, equation, m_w_g, t, y, y_dot, u_s)
      type(values_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: m_w_g
      !! weight of the wall, 0 if it is unknown [N]
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      real(wp), intent(in) :: u_s
      !! displacement of the frame, if present [m]
      type(reactions_t) :: reactions
      real(wp) :: drift

      reactions = reactions_at(equation, t, y, y_dot)
      call put(row, id%base_shear_over_weight, reactions%base_shear/weight(equation))
      if (.not. equation%has_wall) return
      associate (g => equation%p%g)
         call put(row, id%pivot_normal_over_m_w_g, reactions%normal/g)
         call put(row, id%pivot_horizontal_over_m_w_g, reactions%horizontal/g)
         if (.not. equation%parts%has_shear_key) call put(row, id%friction_demand, &
            infinite_where_lifted(friction_demand(reactions)))
         drift = wall_drift(equation, y(1))
         if (equation%beam%n > 0) drift = drift + tip_displacement(equation, y)/equation%beam%length
         call put(row, id%wall_drift, drift)
         if (equation%has_frame) call put(row, id%frame_drift, u_s/roof_height(equation))
         if (m_w_g > 0) then
            call put(row, id%pivot_normal_N, reactions%normal*m_w_g/g)
            call put(row, id%pivot_horizontal_N, reactions%horizontal*m_w_g/g)
         end if
      end associate
   end subroutine put_reactions

   !> Put the extrema of the reactions over the run, and the drifts of wall and frame.
   subroutine put_reaction_extremes(values, forces, equation, theta_min, theta_max, u_s_max)
      type(values_t), intent(inout) :: values
      type(reaction_extremes_recorder_t), intent(in) :: forces
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta_min
      !! [rad]
      real(wp), intent(in) :: theta_max
      !! [rad]
      real(wp), intent(in) :: u_s_max
      !! largest |u_s| [m]
      real(wp) :: largest_demand
      logical :: lifts, is_exceeded

      call put(values, id%base_shear_max_over_weight, forces%largest(shear)/weight(equation))
      call put(values, id%t_base_shear_max_s, forces%t_largest(shear))
      if (.not. equation%has_wall) return
      lifts = -forces%largest(low_normal)/equation%p%g <= 0
      call put(values, id%pivot_normal_min_over_m_w_g, -forces%largest(low_normal)/equation%p%g)
      call put(values, id%t_pivot_normal_min_s, forces%t_largest(low_normal))
      call put(values, id%pivot_lifts, lifts)
      if (equation%parts%has_shear_key) then
         call put(values, id%shear_key_force_max_over_m_w_g, forces%largest_demand/equation%p%g)
         call put(values, id%t_shear_key_force_max_s, forces%t_demand)
      else
         largest_demand = merge(huge(largest_demand), forces%largest_demand, lifts)
         call put(values, id%friction_demand_max, infinite_where_lifted(largest_demand))
         if (.not. lifts) call put(values, id%t_friction_demand_max_s, forces%t_demand)
         if (equation%has_impacts) call put(values, id%friction_demand_impact_max, &
            forces%impact_demand)
      end if
      if (allocated(forces%limit)) then
         is_exceeded = allocated(forces%t_exceeded) .or. allocated(forces%t_impulse)
         call put(values, id%friction_exceeded, is_exceeded)
         if (is_exceeded) call put(values, id%t_friction_exceeded_s, first_exceedance(forces))
      end if
      ! drifts of a rigid wall are monotone in the rotation, whose peaks are located as events
      if (equation%beam%n == 0) call put(values, id%wall_drift_max, max(wall_drift(equation, &
         theta_max), -wall_drift(equation, theta_min)))
      if (equation%has_frame) call put(values, id%frame_drift_max, u_s_max/roof_height(equation))
   end subroutine put_reaction_extremes

   elemental real(wp) function infinite_where_lifted(largest) result(shown)
      real(wp), intent(in) :: largest
      !! demand [-]

      shown = largest
      if (largest >= huge(largest)) shown = ieee_value(largest, ieee_positive_inf)
   end function infinite_where_lifted

   !> Weight of wall and frame over m_w (bare frame: over m_s) [m/s2].
   pure real(wp) function weight(equation)
      type(equation_t), intent(in) :: equation

      weight = equation%p%g*(1 + equation%p%gamma + equation%floors%mass)
   end function weight

   pure real(wp) function roof_height(equation)
      type(equation_t), intent(in) :: equation

      roof_height = 2*equation%p%R*equation%p%cos_alpha
   end function roof_height

end module rwmf_simulation_recorder_reaction_columns
