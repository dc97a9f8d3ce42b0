!> Reactions of a run: columns of the history, their extrema, found by
!> `rwmf_simulation_recorder_peak_search`, and the friction that the impulses of impacts need.
!>
!> The friction demand |H|/N has sharp peaks where N is small. The angle of the force under the
!> pivot is smooth there, also where N vanishes, and has its peaks at the same instants.
module rwmf_simulation_recorder_reaction_extremes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_roots, only: bracket_between, bracket_t, is_wider, narrow
   use rwmf_model_equation, only: tip_displacement
   use rwmf_model_system_assembly, only: equation_t
   use rwmf_model_system_reactions, only: friction_demand, normal_range, reactions_at, &
      reactions_t, wall_drift
   use rwmf_model_system_reactions_loop, only: demand, low_normal, reaction_count, shear
   use rwmf_problem_case, only: case_t, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: put, values_t
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_simulation_recorder_peak_search, only: begin_search, find_at, peak_search_t, &
      search_piece, search_rest
   use rwmf_simulation_recorder_step_states, only: step_states_t
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
   implicit none
   private

   public :: reaction_extremes_recorder_t, create_reaction_extremes
   public :: extremes_for_lanes, infinite_where_lifted, put_reactions, put_reaction_extremes
   public :: observe_impulse, observe_moving, observe_resting, backward

   integer, parameter :: backward = reaction_count + 1
   !! the demand with H to the left; `demand` is that with H to the right

   !> Running maxima of -N [m/s2], of the angle of the force under the pivot [rad] or with a shear
   !> key of H [m/s2], in both directions, and of |V| [m/s2].
   type, extends(peak_search_t) :: reaction_extremes_recorder_t
      real(wp) :: present_demand = 0
      !! |H|/N [-], or with a shear key |H| [m/s2], at the last evaluated instant
      real(wp) :: largest_demand = -huge(1.0_wp)
      real(wp) :: t_demand = 0
      !! time of the largest demand [s]
      real(wp), allocatable :: limit
      !! coefficient of friction, as a limit of the demand [-]
      real(wp), allocatable :: t_exceeded
      !! first time at which the demand of the motion between impacts exceeds the limit [s]
      real(wp), allocatable :: t_impulse
      !! first time at which the demand of an impact exceeds the limit [s]
      real(wp) :: t_above = 0
      !! earliest evaluated instant of the present piece with a demand above the limit [s]
      logical :: sees_impulses = .false.
      !! the friction at impacts is requested
      real(wp) :: impact_demand = 0
      !! largest horizontal over vertical impulse of the base [-]
   contains
      procedure :: find => find_reactions
      procedure :: note_place => note_demand
   end type reaction_extremes_recorder_t

contains

   !> Initialise the extrema if the case requests reactions.
   subroutine create_reaction_extremes(forces, case, equation, y)
      type(reaction_extremes_recorder_t), allocatable, intent(out) :: forces
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) at the beginning
      logical :: is_sought(backward)

      if (.not. allocated(case%output)) return
      if (.not. case%output%reactions) return
      allocate (forces)
      call begin_search(forces, equation, y, spread(-huge(1.0_wp), 1, backward))
      is_sought(low_normal) = seeks(case%output, [id%pivot_normal_min_over_m_w_g, &
         id%t_pivot_normal_min_s, id%pivot_lifts])
      is_sought([demand, backward]) = seeks(case%output, [id%friction_demand_max, &
         id%t_friction_demand_max_s, id%shear_key_force_max_over_m_w_g, &
         id%t_shear_key_force_max_s, id%friction_exceeded, id%t_friction_exceeded_s])
      is_sought = is_sought .and. equation%has_wall
      is_sought(shear) = seeks(case%output, [id%base_shear_max_over_weight, id%t_base_shear_max_s])
      where (.not. is_sought) forces%leader = 0
      forces%pool(backward) = demand
      forces%sees_impulses = equation%has_impacts .and. .not. equation%parts%has_shear_key &
         .and. seeks(case%output, [id%friction_demand_impact_max, id%friction_exceeded, &
         id%t_friction_exceeded_s])
      if (.not. (is_sought(demand) .or. forces%sees_impulses)) return
      if (allocated(case%output%friction_limit)) forces%limit = case%output%friction_limit
   end subroutine create_reaction_extremes

   !> Update the friction demand of impacts with the impulse of the foundation at one of them.
   pure subroutine observe_impulse(forces, t, impulse)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: impulse(2)
      !! horizontal and vertical, over m_w [m/s]
      real(wp) :: demand_of_impact

      if (.not. impulse(2) > 0) return
      demand_of_impact = abs(impulse(1))/impulse(2)
      forces%impact_demand = max(forces%impact_demand, demand_of_impact)
      if (.not. allocated(forces%limit) .or. allocated(forces%t_impulse)) return
      if (demand_of_impact > forces%limit) forces%t_impulse = t
   end subroutine observe_impulse

   !> First time at which any demand exceeds the limit; `huge` without one [s].
   !>
   !> The search of the demand between impacts ignores impulses. Its bits then do not depend on
   !> whether the friction at impacts is requested.
   pure real(wp) function first_exceedance(forces) result(t)
      type(reaction_extremes_recorder_t), intent(in) :: forces

      t = huge(t)
      if (allocated(forces%t_exceeded)) t = forces%t_exceeded
      if (allocated(forces%t_impulse)) t = min(t, forces%t_impulse)
   end function first_exceedance

   !> Compute the quantities at a state.
   subroutine find_reactions(self, equation, t, y, y_dot, found)
      class(reaction_extremes_recorder_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      real(wp), intent(out) :: found(:)
      !! (quantities)
      type(reactions_t) :: reactions

      reactions = reactions_at(equation, t, y, y_dot)
      found(low_normal) = -minval(normal_range(equation, reactions%normal, y))
      found(shear) = abs(reactions%base_shear)
      if (equation%parts%has_shear_key) then
         self%present_demand = abs(reactions%horizontal)
         found(demand) = reactions%horizontal
      else
         self%present_demand = friction_demand(reactions)
         ! a frame has no pivot
         found(demand) = 0
         if (equation%has_wall) found(demand) = atan2(reactions%horizontal, reactions%normal)
      end if
      found(backward) = -found(demand)
      if (.not. allocated(self%limit)) return
      if (self%present_demand > self%limit) self%t_above = min(self%t_above, t)
   end subroutine find_reactions

   !> Note a new largest demand.
   subroutine note_demand(self, q)
      class(reaction_extremes_recorder_t), intent(inout) :: self
      integer, intent(in) :: q
      !! number of the quantity

      if (q /= demand .and. q /= backward) return
      if (.not. self%present_demand > self%largest_demand) return
      self%largest_demand = self%present_demand
      self%t_demand = self%t_largest(q)
   end subroutine note_demand

   !> Update the extrema over smooth motion inside the last step of the integrator.
   subroutine observe_moving(forces, piece, states, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: piece
      type(step_states_t), allocatable, intent(inout) :: states
      !! as for `search_piece`
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails

      forces%t_above = huge(forces%t_above)
      call search_piece(forces, piece, states, error)
      if (.not. allocated(error)) call find_exceedance(forces, piece, error)
   end subroutine observe_moving

   !> Update the extrema over the current interval of the motion, with the wall at rest.
   subroutine observe_resting(forces, equation, y, t_a, t_b)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(equation_t), intent(in), target :: equation
      real(wp), intent(in), contiguous, target :: y(:)
      !! (states), of which the first two are zero
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      type(error_t), allocatable :: error
      !! never set: no integrator is involved
      type(step_view_t) :: rest

      forces%t_above = huge(forces%t_above)
      call search_rest(forces, equation, y, t_a, t_b)
      rest%equation => equation
      rest%y_a => y
      rest%t_a = t_a
      call find_exceedance(forces, rest, error)
   end subroutine observe_resting

   !> Find the first instant at which the demand exceeds the limit, by bisection.
   subroutine find_exceedance(forces, piece, error)
      type(reaction_extremes_recorder_t), intent(inout) :: forces
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: found(backward)
      type(bracket_t) :: bracket

      if (allocated(forces%t_exceeded) .or. .not. forces%t_above < huge(forces%t_above)) return
      bracket = bracket_between(piece%t_a, forces%t_above)
      do while (is_wider(bracket, 2))
         call find_at(forces, piece, bracket%middle, found, error)
         if (allocated(error)) return
         call narrow(bracket, forces%present_demand > forces%limit)
      end do
      forces%t_exceeded = bracket%high
   end subroutine find_exceedance

   !> Return the extrema in the order and units of `lane_reactions`.
   pure subroutine extremes_for_lanes(forces, largest, smallest)
      type(reaction_extremes_recorder_t), intent(in) :: forces
      real(wp), intent(out) :: largest(reaction_count), smallest(reaction_count)
      !! [m/s2], [-] (with a shear key [m/s2]), [m/s2]

      largest = forces%largest(:reaction_count)
      smallest = forces%smallest(:reaction_count)
      largest(demand) = forces%largest_demand
      smallest(demand) = 0
   end subroutine extremes_for_lanes

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

   !> Friction demand to report: infinite without a compressive force on the pivot [-].
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

end module rwmf_simulation_recorder_reaction_extremes
