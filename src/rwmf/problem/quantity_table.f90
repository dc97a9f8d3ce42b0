!> Table of output quantities: history columns, scalars of a run, and the additional results of
!> spectra, sweeps and method comparisons. The summary, Python and `docs/reference/outputs.md` use
!> this table.
module rwmf_problem_quantity_table
   use rwmf_problem_quantity_ids, only: id
   use rwmf_text_strings, only: to_lower
   implicit none
   private

   public :: quantity_t, id, key_of, row_of, all_quantities, look_up, canonical_key, is_of_ordinate
   public :: is_peak, key_length, own_key, sensitivity_id, sensitivity_row
   public :: requested_by, name_of
   public :: of_displacement, of_velocity, of_storeys, of_reactions, of_demands, of_energy
   public :: of_envelopes, of_verification

   integer, parameter :: key_length = 52
   !! length of the longest key: that of a sensitivity
   character(*), parameter :: prefix = 'sensitivity_'
   !! beginning of the key of a sensitivity

   ! The observer skips calculations that no requested quantity needs. A quantity whose row lists
   ! too few needs is therefore wrong when it is requested without others. Demands and reactions are
   ! requested one by one: their recorders list the rows that each search serves.
   character(*), parameter :: of_nothing = 'nothing'
   !! known before the run or independent of it
   character(*), parameter :: of_displacement = 'displacement'
   !! follows from the largest displacement if both sides of the scene are alike
   character(*), parameter :: of_events = 'events'
   !! known from events and the final state
   character(*), parameter :: of_velocity = 'velocity'
   !! largest angular velocity, inside steps
   character(*), parameter :: of_storeys = 'storeys'
   !! velocity reversals of yielding storeys, inside steps
   character(*), parameter :: of_reactions = 'reactions'
   !! reactions of the foundation, inside steps
   character(*), parameter :: of_demands = 'demands'
   !! drifts, accelerations, shears and moments, inside steps
   character(*), parameter :: of_envelopes = 'envelopes'
   !! forces along the wall and in the links, velocities of floors, travel of fuses, in all steps
   character(*), parameter :: of_energy = 'energy'
   !! work over each step
   character(*), parameter :: of_rows = 'rows'
   !! rows of a history
   character(*), parameter :: of_verification = 'verification'
   !! further runs that estimate errors

   !> One output quantity.
   type :: quantity_t
      integer :: id
      !! number of the quantity, one of `id`
      character(key_length) :: key
      !! name with unit suffix; '{i}' is a placeholder for the floor or storey number, from the
      !! ground up
      character(8) :: unit
      !! '1' for dimensionless numbers, '' for texts
      character(8) :: found
      !! way it is found: 'row' (in each row of a history), 'peak' (located supremum), 'time' (of a
      !! peak), 'end' (final value), 'count' or 'whether'. Others are 'before' (known before the
      !! run), 'axis' (of a grid), 'work' (computational work) and 'error' (estimate or comparison).
      character(32) :: outputs
      !! outputs that contain it: 'history', 'run', 'ordinate' (of a spectrum, on request),
      !! 'spectrum', 'sweep', 'cost'
      character(12) :: group
      !! group of the case that it requires; '' for none
      character(12) :: observed
      !! required observation of a run, one of the names above
      character(56) :: needs
      !! other requirements, in Markdown
      character(80) :: meaning
      integer :: ratio = 0
      !! for a force in N or a moment in N m: number of the same quantity over a weight
      character(8) :: kind = 'real'
      !! 'real', 'int', 'logical', 'text' or 'list'
      character(key_length) :: name = ''
      !! variable of a run's dataset in Python, if not as in `name_of`; '-' for none
   end type quantity_t

   !> Columns of the history.
   type(quantity_t), parameter :: columns(*) = [ &
      quantity_t(id%t_s, 't_s', 's', 'row', 'history', '', of_rows, '', 'time', name='time'), &
      quantity_t(id%theta_rad, 'theta_rad', 'rad', 'row', 'history', 'wall', of_rows, '', &
      'rotation of the wall'), &
      quantity_t(id%theta_dot_rad_s, 'theta_dot_rad_s', 'rad/s', 'row', 'history', 'wall', &
      of_rows, '', 'angular velocity of the wall'), &
      quantity_t(id%theta_ddot_rad_s2, 'theta_ddot_rad_s2', 'rad/s2', 'row', 'history', 'wall', &
      of_rows, '', 'angular acceleration of the wall'), &
      quantity_t(id%u_s_m, 'u_s_m', 'm', 'row', 'history', 'frame', of_rows, '', &
      'displacement of the frame'), &
      quantity_t(id%u_s_dot_m_s, 'u_s_dot_m_s', 'm/s', 'row', 'history', 'frame', of_rows, '', &
      'velocity of the frame'), &
      quantity_t(id%u_g_ddot_m_s2, 'u_g_ddot_m_s2', 'm/s2', 'row', 'history', '', of_rows, '', &
      'ground acceleration'), &
      quantity_t(id%v_g_ddot_m_s2, 'v_g_ddot_m_s2', 'm/s2', 'row', 'history', 'vertical', of_rows, &
      '', 'vertical ground acceleration'), &
      quantity_t(id%cable_force_over_m_w_g, 'cable_force_over_m_w_g', '1', 'row', 'history', &
      'cable', of_rows, '', 'cable force over weight of wall'), &
      quantity_t(id%cable_force_N, 'cable_force_N', 'N', 'row', 'history', 'cable', of_rows, &
      '`m_w` of `&wall`', 'cable force', id%cable_force_over_m_w_g), &
      quantity_t(id%frame_force_over_m_s_g, 'frame_force_over_m_s_g', '1', 'row', 'history', &
      'yielding', of_rows, 'not with `coupling` `full` or `springs`', &
      'force of the yielding frame over weight of its mass'), &
      quantity_t(id%fuse_left_force_over_m_w_g, 'fuse_left_force_over_m_w_g', '1', 'row', &
      'history', 'fuse', of_rows, '', 'force of the left fuse over weight of wall'), &
      quantity_t(id%fuse_right_force_over_m_w_g, 'fuse_right_force_over_m_w_g', '1', 'row', &
      'history', 'fuse', of_rows, '', 'force of the right fuse over weight of wall'), &
      quantity_t(id%cable_i_force_over_m_w_g, 'cable_{i}_force_over_m_w_g', '1', 'row', 'history', &
      'cable', of_rows, '`offset`', 'force of tendon {i} over weight of wall'), &
      quantity_t(id%fuse_i_force_over_m_w_g, 'fuse_{i}_force_over_m_w_g', '1', 'row', 'history', &
      'fuse', of_rows, '`offset`', 'force of fuse {i} over weight of wall'), &
      quantity_t(id%restraint_i_force_over_m_w_g, 'restraint_{i}_force_over_m_w_g', '1', 'row', &
      'history', &
      'restraint', of_rows, '', 'force of restraint {i} over weight of wall'), &
      quantity_t(id%coupling_force_over_m_w_g, 'coupling_force_over_m_w_g', '1', 'row', 'history', &
      'coupling', of_rows, '', 'force of a coupling over weight of wall'), &
      quantity_t(id%base_height_m, 'base_height_m', 'm', 'row', 'history', 'base', of_rows, '', &
      'height of the middle of the base'), &
      quantity_t(id%base_slip_m, 'base_slip_m', 'm', 'row', 'history', 'base', of_rows, '`mu`', &
      'slip of the base to the right'), &
      quantity_t(id%base_normal_over_m_w_g, 'base_normal_over_m_w_g', '1', 'row', 'history', &
      'base', of_rows, '', 'normal force of the base over weight of wall'), &
      quantity_t(id%base_normal_N, 'base_normal_N', 'N', 'row', 'history', 'base', of_rows, &
      'a mass', 'normal force of the base', id%base_normal_over_m_w_g), &
      quantity_t(id%base_shear_over_m_w_g, 'base_shear_over_m_w_g', '1', 'row', 'history', &
      'base', of_rows, '', 'horizontal force of the base over weight of wall'), &
      quantity_t(id%q_i_m, 'q_{i}_m', 'm', 'row', 'history', 'bending', of_rows, '', &
      'deflection of the top in mode {i} of the wall'), &
      quantity_t(id%floor_i_m, 'floor_{i}_m', 'm', 'row', 'history', 'storeys', of_rows, &
      '`coupling` `full` or `springs`', 'displacement of floor {i}'), &
      quantity_t(id%storey_i_drift, 'storey_{i}_drift', '1', 'row', 'history', 'storeys', of_rows, &
      '`coupling` `full`, `springs`; or `reactions`', 'drift of storey {i} over its height'), &
      quantity_t(id%storey_i_shear_over_m_w_g, 'storey_{i}_shear_over_m_w_g', '1', 'row', &
      'history', 'storeys', of_rows, '`reactions`, or `storey_u_y` with `full`, `springs`', &
      'shear of the columns of storey {i} over the weight that its mass is over'), &
      quantity_t(id%base_shear_over_weight, 'base_shear_over_weight', '1', 'row', 'history', '', &
      of_reactions, '', 'base shear over weight of wall and frame'), &
      quantity_t(id%pivot_normal_over_m_w_g, 'pivot_normal_over_m_w_g', '1', 'row', 'history', &
      'wall', of_reactions, '', 'vertical reaction of the pivot over weight of wall'), &
      quantity_t(id%pivot_horizontal_over_m_w_g, 'pivot_horizontal_over_m_w_g', '1', 'row', &
      'history', 'wall', of_reactions, '', &
      'horizontal reaction of the pivot over weight of wall'), &
      quantity_t(id%friction_demand, 'friction_demand', '1', 'row', 'history', 'wall', &
      of_reactions, 'no `shear_key`', 'horizontal over vertical reaction of the pivot'), &
      quantity_t(id%wall_drift, 'wall_drift', '1', 'row', 'history', 'wall', of_reactions, '', &
      'displacement of the wall''s top over its height'), &
      quantity_t(id%frame_drift, 'frame_drift', '1', 'row', 'history', 'frame', of_reactions, &
      '`&wall`', 'displacement of the frame, that of its roof, over the wall''s height'), &
      quantity_t(id%pivot_normal_N, 'pivot_normal_N', 'N', 'row', 'history', 'wall', of_reactions, &
      '`m_w`', 'vertical reaction of the pivot', id%pivot_normal_over_m_w_g, &
      name='pivot_normal_N'), &
      quantity_t(id%pivot_horizontal_N, 'pivot_horizontal_N', 'N', 'row', 'history', 'wall', &
      of_reactions, '`m_w`', 'horizontal reaction of the pivot', id%pivot_horizontal_over_m_w_g, &
      name='pivot_horizontal_N'), &
      quantity_t(id%floor_i_acceleration_g, 'floor_{i}_acceleration_g', '1', 'row', 'history', &
      'frame', of_demands, '', 'absolute acceleration of floor {i} over g'), &
      quantity_t(id%overturning_moment_over_weight_m, 'overturning_moment_over_weight_m', 'm', &
      'row', 'history', '', of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'moment of all horizontal inertia about the ground over the weight'), &
      quantity_t(id%wall_shear_over_m_w_g, 'wall_shear_over_m_w_g', '1', 'row', 'history', 'wall', &
      of_demands, '', 'largest shear along the wall over its weight'), &
      quantity_t(id%wall_moment_over_m_w_g_m, 'wall_moment_over_m_w_g_m', 'm', 'row', 'history', &
      'wall', of_demands, '', 'largest bending moment along the wall over its weight'), &
      quantity_t(id%wall_shear_base_over_m_w_g, 'wall_shear_base_over_m_w_g', '1', 'row', &
      'history', 'wall', of_envelopes, '', 'shear in the wall at its base over its weight'), &
      quantity_t(id%wall_moment_base_over_m_w_g_m, 'wall_moment_base_over_m_w_g_m', 'm', 'row', &
      'history', 'wall', of_envelopes, '', &
      'bending moment in the wall at its base over its weight'), &
      quantity_t(id%link_i_force_over_m_w_g, 'link_{i}_force_over_m_w_g', '1', 'row', 'history', &
      'frame', of_envelopes, '`&wall`', &
      'axial force of the link at floor {i} over weight of wall'), &
      quantity_t(id%contact_length_m, 'contact_length_m', 'm', 'row', 'history', 'base_section', &
      of_envelopes, '', 'contact length of the base'), &
      quantity_t(id%toe_stress_Pa, 'toe_stress_Pa', 'Pa', 'row', 'history', 'base_section', &
      of_envelopes, '', 'compressive stress at the toe of the wall'), &
      quantity_t(id%toe_strain, 'toe_strain', '1', 'row', 'history', 'base_section', of_envelopes, &
      '`E` or `length`', 'compressive strain at the toe of the wall'), &
      quantity_t(id%frame_force_N, 'frame_force_N', 'N', 'row', 'history', 'yielding', of_rows, &
      'a mass; not with `full`, `springs`', 'force of the yielding frame', &
      id%frame_force_over_m_s_g), &
      quantity_t(id%fuse_left_force_N, 'fuse_left_force_N', 'N', 'row', 'history', 'fuse', &
      of_rows, 'a mass', 'force of the left fuse', id%fuse_left_force_over_m_w_g), &
      quantity_t(id%fuse_right_force_N, 'fuse_right_force_N', 'N', 'row', 'history', 'fuse', &
      of_rows, 'a mass', 'force of the right fuse', id%fuse_right_force_over_m_w_g), &
      quantity_t(id%cable_i_force_N, 'cable_{i}_force_N', 'N', 'row', 'history', 'cable', &
      of_rows, 'a mass; `offset`', 'force of tendon {i}', id%cable_i_force_over_m_w_g), &
      quantity_t(id%fuse_i_force_N, 'fuse_{i}_force_N', 'N', 'row', 'history', 'fuse', &
      of_rows, 'a mass; `offset`', 'force of fuse {i}', id%fuse_i_force_over_m_w_g), &
      quantity_t(id%restraint_i_force_N, 'restraint_{i}_force_N', 'N', 'row', 'history', &
      'restraint', &
      of_rows, 'a mass', 'force of restraint {i}', id%restraint_i_force_over_m_w_g), &
      quantity_t(id%coupling_force_N, 'coupling_force_N', 'N', 'row', 'history', 'coupling', &
      of_rows, 'a mass', 'force of a coupling', id%coupling_force_over_m_w_g), &
      quantity_t(id%storey_i_shear_N, 'storey_{i}_shear_N', 'N', 'row', 'history', 'storeys', &
      of_rows, 'as storey_{i}_shear_over_m_w_g; a mass', 'shear of the columns of storey {i}', &
      id%storey_i_shear_over_m_w_g), &
      quantity_t(id%base_shear_N, 'base_shear_N', 'N', 'row', 'history', '', of_reactions, &
      'a mass', 'base shear', id%base_shear_over_weight), &
      quantity_t(id%overturning_moment_N_m, 'overturning_moment_N_m', 'N m', 'row', 'history', '', &
      of_demands, 'a mass; a height: `&wall`, `&storeys` or `h_f`', &
      'moment of all horizontal inertia about the ground', id%overturning_moment_over_weight_m), &
      quantity_t(id%wall_shear_N, 'wall_shear_N', 'N', 'row', 'history', 'wall', of_demands, &
      'a mass', 'largest shear along the wall', id%wall_shear_over_m_w_g), &
      quantity_t(id%wall_moment_N_m, 'wall_moment_N_m', 'N m', 'row', 'history', 'wall', &
      of_demands, 'a mass', 'largest bending moment along the wall', id%wall_moment_over_m_w_g_m), &
      quantity_t(id%wall_shear_base_N, 'wall_shear_base_N', 'N', 'row', 'history', 'wall', &
      of_envelopes, 'a mass', 'shear in the wall at its base', id%wall_shear_base_over_m_w_g), &
      quantity_t(id%wall_moment_base_N_m, 'wall_moment_base_N_m', 'N m', 'row', 'history', 'wall', &
      of_envelopes, 'a mass', 'bending moment in the wall at its base', &
      id%wall_moment_base_over_m_w_g_m), &
      quantity_t(id%link_i_force_N, 'link_{i}_force_N', 'N', 'row', 'history', 'frame', &
      of_envelopes, 'a mass; `&wall`', 'axial force of the link at floor {i}', &
      id%link_i_force_over_m_w_g)]

   !> Scalars of a run.
   type(quantity_t), parameter :: scalars(*) = [ &
      quantity_t(id%u_s_max_m, 'u_s_max_m', 'm', 'peak', 'run ordinate spectrum sweep cost', &
      'frame', of_displacement, '', 'largest displacement of the frame'), &
      quantity_t(id%tip_deflection_max_m, 'tip_deflection_max_m', 'm', 'peak', 'run ordinate', &
      'bending', of_events, '', 'largest deflection of the top from the straight axis'), &
      quantity_t(id%toe_settlement_max_m, 'toe_settlement_max_m', 'm', 'peak', 'run ordinate', &
      'base', of_events, '', 'largest settlement of an edge of the base'), &
      quantity_t(id%middle_rise_max_m, 'middle_rise_max_m', 'm', 'peak', 'run ordinate', &
      'base', of_events, '', 'largest height of the middle of the base'), &
      quantity_t(id%middle_end_m, 'middle_end_m', 'm', 'end', 'run ordinate', 'base', &
      of_events, '', 'height of the middle of the base at the end'), &
      quantity_t(id%toe_stress_max_over_k_m, 'toe_stress_max_over_k_m', 'm', 'peak', &
      'run ordinate', 'base', of_events, '', 'largest stress of the base over its stiffness'), &
      quantity_t(id%base_normal_max_over_m_w_g, 'base_normal_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'base', of_events, '', &
      'largest normal force of the base over weight of wall'), &
      quantity_t(id%base_normal_min_over_m_w_g, 'base_normal_min_over_m_w_g', '1', 'peak', &
      'run ordinate', 'base', of_events, '', &
      'smallest normal force of the base over weight of wall'), &
      quantity_t(id%base_normal_max_N, 'base_normal_max_N', 'N', 'peak', 'run ordinate', &
      'base', of_events, 'a mass', 'largest normal force of the base', &
      id%base_normal_max_over_m_w_g), &
      quantity_t(id%base_normal_min_N, 'base_normal_min_N', 'N', 'peak', 'run ordinate', &
      'base', of_events, 'a mass', 'smallest normal force of the base', &
      id%base_normal_min_over_m_w_g), &
      quantity_t(id%base_shear_max_over_m_w_g, 'base_shear_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'base', of_events, '', &
      'largest horizontal force of the base over weight of wall'), &
      quantity_t(id%slide_max_m, 'slide_max_m', 'm', 'peak', 'run ordinate', 'base', of_events, &
      '`mu`', 'largest slip of the base'), &
      quantity_t(id%slide_end_m, 'slide_end_m', 'm', 'end', 'run ordinate', 'base', of_events, &
      '`mu`', 'slip of the base to the right at the end'), &
      quantity_t(id%slips, 'slips', '1', 'count', 'run ordinate', 'base', of_events, '`mu`', &
      'slips of the base that began or reversed', kind='int'), &
      quantity_t(id%crushed_depth_max_m, 'crushed_depth_max_m', 'm', 'end', 'run ordinate', &
      'base', of_events, '`d_y`', 'largest crushed depth of the base'), &
      quantity_t(id%crushed_left_m, 'crushed_left_m', 'm', 'end', 'run ordinate', 'base', &
      of_events, '`d_y`', 'crushed depth of the leftmost strip'), &
      quantity_t(id%crushed_right_m, 'crushed_right_m', 'm', 'end', 'run ordinate', 'base', &
      of_events, '`d_y`', 'crushed depth of the rightmost strip'), &
      quantity_t(id%flights, 'flights', '1', 'count', 'run ordinate', 'base', of_events, '', &
      'times that the wall has left its base', kind='int'), &
      quantity_t(id%t_flight_first_s, 't_flight_first_s', 's', 'time', 'run ordinate', 'base', &
      of_events, '', 'first of these times'), &
      quantity_t(id%t_u_s_max_s, 't_u_s_max_s', 's', 'time', 'run ordinate cost', 'frame', &
      of_events, '', 'first time of the largest displacement'), &
      quantity_t(id%theta_max_over_alpha, 'theta_max_over_alpha', '1', 'peak', 'run ordinate', &
      'wall', of_displacement, '', 'largest rotation over slenderness'), &
      quantity_t(id%theta_dot_max_rad_s, 'theta_dot_max_rad_s', 'rad/s', 'peak', &
      'run ordinate cost', 'wall', of_velocity, '', 'largest angular velocity'), &
      quantity_t(id%cable_force_increment_max_over_m_w_g, 'cable_force_increment_max_over_m_w_g', &
      '1', 'peak', 'run ordinate', 'cable', of_displacement, '', &
      'largest increment of the cable force over weight of wall'), &
      quantity_t(id%cable_prestress_loss_over_m_w_g, 'cable_prestress_loss_over_m_w_g', '1', &
      'end', 'run ordinate', 'cable', of_events, '`eta_y` or `rupture_strain`', &
      'cable force at theta = 0 that is lost at the end, over weight of wall'), &
      quantity_t(id%cable_ruptured, 'cable_ruptured', '1', 'whether', 'run ordinate', 'cable', &
      of_events, '`eta_y` or `rupture_strain`', 'whether the cable broke', kind='logical'), &
      quantity_t(id%ductility, 'ductility', '1', 'peak', 'run ordinate', 'yielding', of_storeys, &
      '', 'largest displacement over that at first yield'), &
      quantity_t(id%residual_displacement_m, 'residual_displacement_m', 'm', 'end', &
      'run ordinate', 'yielding', of_events, '', &
      'displacement at which the frame alone would be without force at the end'), &
      quantity_t(id%theta_end_over_alpha, 'theta_end_over_alpha', '1', 'end', 'run ordinate', &
      'wall', of_events, 'springs that may hold the wall up, or `&base`', &
      'rotation at the end over slenderness'), &
      quantity_t(id%storey_i_ductility, 'storey_{i}_ductility', '1', 'peak', 'run ordinate', &
      'yielding', of_storeys, '`storey_u_y`', &
      'largest displacement of storey {i} over that at first yield'), &
      quantity_t(id%storey_i_residual_drift, 'storey_{i}_residual_drift', '1', 'end', &
      'run ordinate', 'yielding', of_events, '`storey_u_y`', &
      'drift of storey {i} that unloading would leave at the end'), &
      quantity_t(id%storey_i_residual_drift_at_rest, 'storey_{i}_residual_drift_at_rest', '1', &
      'end', 'run ordinate', 'yielding', of_events, '`storey_u_y`; an equilibrium', &
      'drift of storey {i} in static equilibrium after the motion'), &
      quantity_t(id%impacts, 'impacts', '1', 'count', 'run ordinate cost', 'wall', of_events, &
      '`base = ''rocking''`', 'number of impacts', kind='int'), &
      quantity_t(id%lift_offs, 'lift_offs', '1', 'count', 'run ordinate', 'wall', of_events, &
      '`base = ''rocking''`', 'number of times that the wall lifts off from rest', kind='int'), &
      quantity_t(id%overturned, 'overturned', '1', 'whether', 'run ordinate cost', 'wall', &
      of_displacement, '', 'whether the wall overturned', kind='logical'), &
      quantity_t(id%collapsed, 'collapsed', '1', 'whether', 'run ordinate', '', of_displacement, &
      'an effect that limits a drift', 'whether a drift passed the limit of the effect', &
      kind='logical'), &
      quantity_t(id%t_collapse_s, 't_collapse_s', 's', 'time', 'run ordinate', '', of_events, &
      'an effect that limits a drift, collapsed', 'when it did, which ends the run'), &
      quantity_t(id%e, 'e', '1', 'before', 'run ordinate', 'wall', of_displacement, &
      '`base = ''rocking''`, no table of e', 'velocity factor at impact'), &
      quantity_t(id%e_max, 'e_max', '1', 'before', 'run ordinate', 'wall', of_displacement, &
      '`base = ''rocking''`', 'velocity factor of the momentum balance about the new corner'), &
      quantity_t(id%uplift_right_g, 'uplift_right_g', '1', 'before', 'run', 'wall', of_nothing, &
      'elements off the axis, `&coupling` or `&restraint`', &
      'ground acceleration at which the wall at rest lifts off to theta > 0, over g'), &
      quantity_t(id%uplift_left_g, 'uplift_left_g', '1', 'before', 'run', 'wall', of_nothing, &
      'elements off the axis, `&coupling` or `&restraint`', &
      'ground acceleration at which the wall at rest lifts off to theta < 0, over g'), &
      quantity_t(id%coupling_ratio, 'coupling_ratio', '1', 'before', 'run', 'coupling', &
      of_nothing, '`eta_y`', 'share of the couplings in the moment of all walls at yield'), &
      quantity_t(id%mode_i_damping_contact, 'mode_{i}_damping_contact', '1', 'before', 'run', &
      'bending', of_nothing, 'the first three modes', &
      'damping ratio of mode {i} of the wall with its floors, in contact'), &
      quantity_t(id%mode_i_damping_rocking, 'mode_{i}_damping_rocking', '1', 'before', 'run', &
      'bending', of_nothing, 'the first three modes', &
      'damping ratio of mode {i} of the wall with its floors, rocking'), &
      quantity_t(id%T_s_s, 'T_s_s', 's', 'before', 'run spectrum', 'frame', of_nothing, &
      'in a run `&storeys`', 'period of the frame'), &
      quantity_t(id%modal_mass_over_m_w, 'modal_mass_over_m_w', '1', 'before', 'run', 'storeys', &
      of_nothing, '', 'mass of the first mode over that of the wall'), &
      quantity_t(id%mass_participation, 'mass_participation', '1', 'before', 'run', 'storeys', &
      of_nothing, '', 'mass of the first mode over that of all floors'), &
      quantity_t(id%modal_height_m, 'modal_height_m', 'm', 'before', 'run', 'storeys', of_nothing, &
      '', 'height at which the mass of the first mode acts'), &
      quantity_t(id%roof_factor, 'roof_factor', '1', 'before', 'run', 'storeys', of_nothing, '', &
      'displacement of the roof over that of the first mode'), &
      quantity_t(id%base_shear_max_over_weight, 'base_shear_max_over_weight', '1', 'peak', &
      'run ordinate', '', of_reactions, '', 'largest base shear over weight of wall and frame'), &
      quantity_t(id%t_base_shear_max_s, 't_base_shear_max_s', 's', 'time', 'run ordinate', '', &
      of_reactions, '', 'time of the largest base shear'), &
      quantity_t(id%pivot_normal_min_over_m_w_g, 'pivot_normal_min_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_reactions, '', 'smallest pivot reaction over weight of wall'), &
      quantity_t(id%t_pivot_normal_min_s, 't_pivot_normal_min_s', 's', 'time', 'run ordinate', &
      'wall', of_reactions, '', 'time of the smallest pivot reaction'), &
      quantity_t(id%pivot_lifts, 'pivot_lifts', '1', 'whether', 'run ordinate', 'wall', &
      of_reactions, '', 'whether the pivot reaction was not positive at some time', &
      kind='logical'), &
      quantity_t(id%friction_demand_max, 'friction_demand_max', '1', 'peak', 'run ordinate', &
      'wall', of_reactions, 'no `shear_key`', 'required coefficient of friction'), &
      quantity_t(id%t_friction_demand_max_s, 't_friction_demand_max_s', 's', 'time', &
      'run ordinate', 'wall', of_reactions, 'no lift of the pivot, no `shear_key`', &
      'time of the largest friction demand'), &
      quantity_t(id%friction_demand_impact_max, 'friction_demand_impact_max', '1', 'peak', &
      'run ordinate', 'wall', of_reactions, '`&impact`; no `shear_key`', &
      'largest horizontal over vertical impulse of the base at an impact'), &
      quantity_t(id%shear_key_force_max_over_m_w_g, 'shear_key_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_reactions, '`shear_key`', &
      'largest force of the shear key over weight of wall'), &
      quantity_t(id%t_shear_key_force_max_s, 't_shear_key_force_max_s', 's', 'time', &
      'run ordinate', 'wall', of_reactions, '`shear_key`', 'time of that force'), &
      quantity_t(id%friction_exceeded, 'friction_exceeded', '1', 'whether', 'run ordinate', &
      'wall', of_reactions, '`friction_limit` of `&output`', &
      'whether a friction demand, also of impacts, exceeded the limit', kind='logical'), &
      quantity_t(id%t_friction_exceeded_s, 't_friction_exceeded_s', 's', 'time', 'run ordinate', &
      'wall', of_reactions, '`friction_limit` of `&output`, exceeded', &
      'first time at which a demand exceeds the limit'), &
      quantity_t(id%wall_drift_max, 'wall_drift_max', '1', 'peak', 'run ordinate', 'wall', &
      of_reactions, '', 'largest drift of the wall'), &
      quantity_t(id%frame_drift_max, 'frame_drift_max', '1', 'peak', 'run ordinate', 'frame', &
      of_reactions, '`&wall`', &
      'largest displacement of the frame, that of its roof, over the wall''s height'), &
      quantity_t(id%cable_force_increment_max_N, 'cable_force_increment_max_N', 'N', 'peak', &
      'run ordinate', 'cable', of_displacement, 'a mass', 'largest increment of the cable force', &
      id%cable_force_increment_max_over_m_w_g), &
      quantity_t(id%cable_prestress_loss_N, 'cable_prestress_loss_N', 'N', 'end', 'run ordinate', &
      'cable', of_events, 'a mass; `eta_y` or `rupture_strain`', &
      'cable force at theta = 0 that is lost at the end', id%cable_prestress_loss_over_m_w_g), &
      quantity_t(id%base_shear_max_N, 'base_shear_max_N', 'N', 'peak', 'run ordinate', '', &
      of_reactions, 'a mass', 'largest base shear', id%base_shear_max_over_weight), &
      quantity_t(id%pivot_normal_min_N, 'pivot_normal_min_N', 'N', 'peak', 'run ordinate', 'wall', &
      of_reactions, 'a mass', 'smallest pivot reaction', id%pivot_normal_min_over_m_w_g), &
      quantity_t(id%shear_key_force_max_N, 'shear_key_force_max_N', 'N', 'peak', 'run ordinate', &
      'wall', of_reactions, 'a mass; `shear_key`', 'largest force of the shear key', &
      id%shear_key_force_max_over_m_w_g), &
      quantity_t(id%tendon_force_max_over_m_w_g, 'tendon_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'cable', of_reactions, '', &
      'largest force of the cable over weight of wall'), &
      quantity_t(id%tendon_force_max_N, 'tendon_force_max_N', 'N', 'peak', 'run ordinate', &
      'cable', of_reactions, 'a mass', 'largest force of the cable', &
      id%tendon_force_max_over_m_w_g), &
      quantity_t(id%tendon_stress_max_Pa, 'tendon_stress_max_Pa', 'Pa', 'peak', 'run ordinate', &
      'cable', of_reactions, '`strands`', 'largest stress of the strands of the cable'), &
      quantity_t(id%tendon_strain_max, 'tendon_strain_max', '1', 'peak', 'run ordinate', 'cable', &
      of_reactions, '`strands` or `rupture_strain`', &
      'largest strain of the cable, that of the prestress included'), &
      quantity_t(id%steps, 'steps', '1', 'work', 'run cost', '', of_nothing, '', &
      'accepted steps of the integrator', kind='int', name='-'), &
      quantity_t(id%rhs_evaluations, 'rhs_evaluations', '1', 'work', 'run spectrum cost', '', &
      of_nothing, '', 'evaluations of the right-hand side', kind='int', name='-'), &
      quantity_t(id%seconds, 'seconds', 's', 'work', 'run spectrum cost', '', of_nothing, '', &
      'wall-clock time of the integration', name='-'), &
      quantity_t(id%method, 'method', '', 'before', 'run spectrum cost', '', of_nothing, '', &
      'integrator, or procedure that is compared', kind='text', name='-'), &
      quantity_t(id%rtol, 'rtol', '1', 'before', 'run cost', '', of_nothing, '', &
      'its relative tolerance', name='-'), &
      quantity_t(id%estimated_relative_error, 'estimated_relative_error', '1', 'error', &
      'run ordinate', '', of_verification, '`accuracy` or `verify` of `&solver`', &
      'estimated error of the peak of `accuracy_of`, over it; absent: none can be made', &
      name='-'), &
      quantity_t(id%estimate_seconds, 'estimate_seconds', 's', 'work', 'run', '', of_nothing, &
      '`accuracy` or `verify` of `&solver`', &
      'wall-clock time that the estimate took beyond `seconds`', name='-'), &
      quantity_t(id%sensitivity, 'sensitivity', '1', 'error', 'run ordinate', '', of_verification, &
      '`verify` of `&solver`', &
      'relative change of the same peak per relative change of the motion', name='-'), &
      quantity_t(id%effects, 'effects', '', 'before', 'run', '', of_nothing, '', &
      'names of the effects that are simulated', kind='list', name='-'), &
      quantity_t(id%warnings, 'warnings', '', 'end', 'run spectrum', '', of_events, '', &
      'what the user should know', kind='list', name='-')]

   !> Demands of a run, used for the design of a building. The error of accelerations is at most
   !> 100 rtol times their value times their sensitivity to the motion (at least 1).
   type(quantity_t), parameter :: demands(*) = [ &
      quantity_t(id%storey_i_drift_max, 'storey_{i}_drift_max', '1', 'peak', 'run ordinate', &
      'storeys', of_demands, '', 'largest drift of storey {i} over its height'), &
      quantity_t(id%storey_drift_max, 'storey_drift_max', '1', 'peak', 'run ordinate', 'storeys', &
      of_demands, '', 'largest drift of all storeys over their heights'), &
      quantity_t(id%t_storey_drift_max_s, 't_storey_drift_max_s', 's', 'time', 'run ordinate', &
      'storeys', of_demands, '', 'time of the largest drift of a storey'), &
      quantity_t(id%roof_drift_max, 'roof_drift_max', '1', 'peak', 'run ordinate', 'frame', &
      of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'largest displacement of the roof over its height'), &
      quantity_t(id%t_roof_drift_max_s, 't_roof_drift_max_s', 's', 'time', 'run ordinate', &
      'frame', of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'time of the largest drift of the roof'), &
      quantity_t(id%storey_residual_drift_max, 'storey_residual_drift_max', '1', 'end', &
      'run ordinate', 'yielding', of_demands, '`&storeys`', &
      'largest drift of a storey that unloading would leave at the end'), &
      quantity_t(id%roof_residual_drift, 'roof_residual_drift', '1', 'end', 'run ordinate', &
      'yielding', of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'displacement of the roof that unloading would leave over its height'), &
      quantity_t(id%roof_residual_drift_at_rest, 'roof_residual_drift_at_rest', '1', 'end', &
      'run ordinate', 'frame', of_demands, '`&yielding` or `&fuse`; a height; an equilibrium', &
      'drift of the roof in static equilibrium after the motion'), &
      quantity_t(id%floor_i_acceleration_max_g, 'floor_{i}_acceleration_max_g', '1', 'peak', &
      'run ordinate', 'frame', of_demands, '', &
      'largest absolute acceleration of floor {i} over g'), &
      quantity_t(id%floor_acceleration_max_g, 'floor_acceleration_max_g', '1', 'peak', &
      'run ordinate', 'frame', of_demands, '', &
      'largest absolute acceleration of all floors over g'), &
      quantity_t(id%t_floor_acceleration_max_s, 't_floor_acceleration_max_s', 's', 'time', &
      'run ordinate', 'frame', of_demands, '', 'time of the largest acceleration of a floor'), &
      quantity_t(id%storey_i_shear_max_over_m_w_g, 'storey_{i}_shear_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'storeys', of_demands, '', &
      'largest shear of the columns of storey {i} over the weight that its mass is over'), &
      quantity_t(id%overturning_moment_max_over_weight_m, 'overturning_moment_max_over_weight_m', &
      'm', 'peak', 'run ordinate', '', of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'largest moment of all horizontal inertia about the ground over the weight'), &
      quantity_t(id%t_overturning_moment_max_s, 't_overturning_moment_max_s', 's', 'time', &
      'run ordinate', '', of_demands, 'a height: `&wall`, `&storeys` or `h_f`', &
      'time of the largest overturning moment'), &
      quantity_t(id%wall_shear_max_over_m_w_g, 'wall_shear_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_demands, '', 'largest shear inside the wall over its weight'), &
      quantity_t(id%wall_shear_max_height_m, 'wall_shear_max_height_m', 'm', 'peak', &
      'run ordinate', 'wall', of_demands, '', 'where, above the base'), &
      quantity_t(id%wall_moment_max_over_m_w_g_m, 'wall_moment_max_over_m_w_g_m', 'm', 'peak', &
      'run ordinate', 'wall', of_demands, '', &
      'largest bending moment inside the wall over its weight'), &
      quantity_t(id%wall_moment_max_height_m, 'wall_moment_max_height_m', 'm', 'peak', &
      'run ordinate', 'wall', of_demands, '', 'where, above the base'), &
      quantity_t(id%storey_i_shear_max_N, 'storey_{i}_shear_max_N', 'N', 'peak', 'run ordinate', &
      'storeys', of_demands, 'a mass', 'largest shear of the columns of storey {i}', &
      id%storey_i_shear_max_over_m_w_g), &
      quantity_t(id%overturning_moment_max_N_m, 'overturning_moment_max_N_m', 'N m', 'peak', &
      'run ordinate', '', of_demands, 'a mass; a height: `&wall`, `&storeys` or `h_f`', &
      'largest moment of all horizontal inertia about the ground', &
      id%overturning_moment_max_over_weight_m), &
      quantity_t(id%wall_shear_max_N, 'wall_shear_max_N', 'N', 'peak', 'run ordinate', 'wall', &
      of_demands, 'a mass', 'largest shear inside the wall', id%wall_shear_max_over_m_w_g), &
      quantity_t(id%wall_moment_max_N_m, 'wall_moment_max_N_m', 'N m', 'peak', 'run ordinate', &
      'wall', of_demands, 'a mass', 'largest bending moment inside the wall', &
      id%wall_moment_max_over_m_w_g_m)]

   !> Envelopes of a run: forces for the design of members, and related quantities.
   type(quantity_t), parameter :: envelopes(*) = [ &
      quantity_t(id%wall_shear_base_max_over_m_w_g, 'wall_shear_base_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_envelopes, '', &
      'largest shear in the wall at its base over its weight'), &
      quantity_t(id%wall_moment_base_max_over_m_w_g_m, 'wall_moment_base_max_over_m_w_g_m', 'm', &
      'peak', 'run ordinate', 'wall', of_envelopes, '', &
      'largest bending moment in the wall at its base over its weight'), &
      quantity_t(id%wall_shear_mid_max_over_m_w_g, 'wall_shear_mid_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_envelopes, '', &
      'largest shear in the wall at mid-height over its weight'), &
      quantity_t(id%wall_moment_mid_max_over_m_w_g_m, 'wall_moment_mid_max_over_m_w_g_m', 'm', &
      'peak', 'run ordinate', 'wall', of_envelopes, '', &
      'largest bending moment in the wall at mid-height over its weight'), &
      quantity_t(id%wall_shear_i_max_over_m_w_g, 'wall_shear_{i}_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'frame', of_envelopes, '`&wall`', &
      'largest shear in the wall just below floor {i} over its weight'), &
      quantity_t(id%wall_shear_i_above_max_over_m_w_g, 'wall_shear_{i}_above_max_over_m_w_g', '1', &
      'peak', 'run ordinate', 'frame', of_envelopes, '`&wall`', &
      'largest shear in the wall just above floor {i} over its weight'), &
      quantity_t(id%wall_moment_i_max_over_m_w_g_m, 'wall_moment_{i}_max_over_m_w_g_m', 'm', &
      'peak', 'run ordinate', 'frame', of_envelopes, '`&wall`', &
      'largest moment in the wall just below floor {i} over its weight'), &
      quantity_t(id%wall_moment_i_above_max_over_m_w_g_m, &
      'wall_moment_{i}_above_max_over_m_w_g_m', 'm', 'peak', 'run ordinate', 'frame', &
      of_envelopes, '`&wall`', 'largest moment in the wall just above floor {i} over its weight'), &
      quantity_t(id%link_i_force_max_over_m_w_g, 'link_{i}_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'frame', of_envelopes, '`&wall`', &
      'largest axial force of the link at floor {i} over weight of wall'), &
      quantity_t(id%pivot_normal_max_over_m_w_g, 'pivot_normal_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'wall', of_envelopes, '', 'largest pivot reaction over weight of wall'), &
      quantity_t(id%fuse_stroke_max_m, 'fuse_stroke_max_m', 'm', 'peak', 'run ordinate', 'fuse', &
      of_envelopes, '', 'largest stroke of a fuse'), &
      quantity_t(id%fuse_stroke_sum_m, 'fuse_stroke_sum_m', 'm', 'peak', 'run ordinate', 'fuse', &
      of_envelopes, '', 'travel of a fuse there and back, of both the longer one'), &
      quantity_t(id%cable_i_force_max_over_m_w_g, 'cable_{i}_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'cable', of_envelopes, '`offset`', &
      'largest force of tendon {i} over weight of wall'), &
      quantity_t(id%cable_i_force_min_over_m_w_g, 'cable_{i}_force_min_over_m_w_g', '1', 'peak', &
      'run ordinate', 'cable', of_envelopes, '`offset`', &
      'smallest force of tendon {i} over weight of wall'), &
      quantity_t(id%cable_i_prestress_loss_over_m_w_g, 'cable_{i}_prestress_loss_over_m_w_g', &
      '1', 'end', &
      'run ordinate', 'cable', of_envelopes, '`offset`', &
      'force of tendon {i} at theta = 0 that is lost at the end over weight of wall'), &
      quantity_t(id%fuse_i_stroke_max_m, 'fuse_{i}_stroke_max_m', 'm', 'peak', 'run ordinate', &
      'fuse', of_envelopes, '', 'largest stroke of fuse {i}'), &
      quantity_t(id%fuse_i_stroke_min_m, 'fuse_{i}_stroke_min_m', 'm', 'peak', 'run ordinate', &
      'fuse', of_envelopes, '', 'smallest stroke of fuse {i}, negative where the point sinks'), &
      quantity_t(id%fuse_i_stroke_sum_m, 'fuse_{i}_stroke_sum_m', 'm', 'peak', 'run ordinate', &
      'fuse', of_envelopes, '', 'travel of fuse {i} there and back'), &
      quantity_t(id%fuse_i_force_max_over_m_w_g, 'fuse_{i}_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'fuse', of_envelopes, '', &
      'largest magnitude of the force of fuse {i} over weight of wall'), &
      quantity_t(id%fuse_i_force_end_over_m_w_g, 'fuse_{i}_force_end_over_m_w_g', '1', 'end', &
      'run ordinate', 'fuse', of_envelopes, '', &
      'force of fuse {i} at the end over weight of wall'), &
      quantity_t(id%restraint_i_stroke_max_m, 'restraint_{i}_stroke_max_m', 'm', 'peak', &
      'run ordinate', &
      'restraint', of_envelopes, '', 'largest stroke of restraint {i}'), &
      quantity_t(id%restraint_i_stroke_min_m, 'restraint_{i}_stroke_min_m', 'm', 'peak', &
      'run ordinate', &
      'restraint', of_envelopes, '', &
      'smallest stroke of restraint {i}, negative where the point sinks'), &
      quantity_t(id%restraint_i_stroke_sum_m, 'restraint_{i}_stroke_sum_m', 'm', 'peak', &
      'run ordinate', &
      'restraint', of_envelopes, '', 'travel of restraint {i} there and back'), &
      quantity_t(id%restraint_i_force_max_over_m_w_g, 'restraint_{i}_force_max_over_m_w_g', '1', &
      'peak', &
      'run ordinate', 'restraint', of_envelopes, '', &
      'largest magnitude of the force of restraint {i} over weight of wall'), &
      quantity_t(id%restraint_i_force_end_over_m_w_g, 'restraint_{i}_force_end_over_m_w_g', '1', &
      'end', &
      'run ordinate', 'restraint', of_envelopes, '', &
      'force of restraint {i} at the end over weight of wall'), &
      quantity_t(id%coupling_stroke_max_m, 'coupling_stroke_max_m', 'm', 'peak', 'run ordinate', &
      'coupling', of_envelopes, '', 'largest magnitude of the stroke of a coupling'), &
      quantity_t(id%coupling_stroke_sum_m, 'coupling_stroke_sum_m', 'm', 'peak', 'run ordinate', &
      'coupling', of_envelopes, '', 'travel of a coupling there and back'), &
      quantity_t(id%coupling_force_max_over_m_w_g, 'coupling_force_max_over_m_w_g', '1', 'peak', &
      'run ordinate', 'coupling', of_envelopes, '', &
      'largest magnitude of the force of a coupling over weight of wall'), &
      quantity_t(id%coupling_force_end_over_m_w_g, 'coupling_force_end_over_m_w_g', '1', 'end', &
      'run ordinate', 'coupling', of_envelopes, '', &
      'force of a coupling at the end over weight of wall'), &
      quantity_t(id%cable_i_force_max_N, 'cable_{i}_force_max_N', 'N', 'peak', 'run ordinate', &
      'cable', of_envelopes, 'a mass; `offset`', 'largest force of tendon {i}', &
      id%cable_i_force_max_over_m_w_g), &
      quantity_t(id%cable_i_force_min_N, 'cable_{i}_force_min_N', 'N', 'peak', 'run ordinate', &
      'cable', of_envelopes, 'a mass; `offset`', 'smallest force of tendon {i}', &
      id%cable_i_force_min_over_m_w_g), &
      quantity_t(id%cable_i_prestress_loss_N, 'cable_{i}_prestress_loss_N', 'N', 'end', &
      'run ordinate', &
      'cable', of_envelopes, 'a mass; `offset`', &
      'force of tendon {i} at theta = 0 that is lost at the end', &
      id%cable_i_prestress_loss_over_m_w_g), &
      quantity_t(id%fuse_i_force_max_N, 'fuse_{i}_force_max_N', 'N', 'peak', 'run ordinate', &
      'fuse', of_envelopes, 'a mass', 'largest magnitude of the force of fuse {i}', &
      id%fuse_i_force_max_over_m_w_g), &
      quantity_t(id%fuse_i_force_end_N, 'fuse_{i}_force_end_N', 'N', 'end', 'run ordinate', &
      'fuse', of_envelopes, 'a mass', 'force of fuse {i} at the end', &
      id%fuse_i_force_end_over_m_w_g), &
      quantity_t(id%restraint_i_force_max_N, 'restraint_{i}_force_max_N', 'N', 'peak', &
      'run ordinate', &
      'restraint', of_envelopes, 'a mass', 'largest magnitude of the force of restraint {i}', &
      id%restraint_i_force_max_over_m_w_g), &
      quantity_t(id%restraint_i_force_end_N, 'restraint_{i}_force_end_N', 'N', 'end', &
      'run ordinate', &
      'restraint', of_envelopes, 'a mass', 'force of restraint {i} at the end', &
      id%restraint_i_force_end_over_m_w_g), &
      quantity_t(id%coupling_force_max_N, 'coupling_force_max_N', 'N', 'peak', 'run ordinate', &
      'coupling', of_envelopes, 'a mass', 'largest magnitude of the force of a coupling', &
      id%coupling_force_max_over_m_w_g), &
      quantity_t(id%coupling_force_end_N, 'coupling_force_end_N', 'N', 'end', 'run ordinate', &
      'coupling', of_envelopes, 'a mass', 'force of a coupling at the end', &
      id%coupling_force_end_over_m_w_g), &
      quantity_t(id%floor_i_velocity_max_m_s, 'floor_{i}_velocity_max_m_s', 'm/s', 'peak', &
      'run ordinate', 'frame', of_envelopes, '', 'largest absolute velocity of floor {i}'), &
      quantity_t(id%wall_shear_base_max_N, 'wall_shear_base_max_N', 'N', 'peak', 'run ordinate', &
      'wall', of_envelopes, 'a mass', 'largest shear in the wall at its base', &
      id%wall_shear_base_max_over_m_w_g), &
      quantity_t(id%wall_moment_base_max_N_m, 'wall_moment_base_max_N_m', 'N m', 'peak', &
      'run ordinate', 'wall', of_envelopes, 'a mass', &
      'largest bending moment in the wall at its base', id%wall_moment_base_max_over_m_w_g_m), &
      quantity_t(id%wall_shear_mid_max_N, 'wall_shear_mid_max_N', 'N', 'peak', 'run ordinate', &
      'wall', of_envelopes, 'a mass', 'largest shear in the wall at mid-height', &
      id%wall_shear_mid_max_over_m_w_g), &
      quantity_t(id%wall_moment_mid_max_N_m, 'wall_moment_mid_max_N_m', 'N m', 'peak', &
      'run ordinate', 'wall', of_envelopes, 'a mass', &
      'largest bending moment in the wall at mid-height', id%wall_moment_mid_max_over_m_w_g_m), &
      quantity_t(id%wall_shear_i_max_N, 'wall_shear_{i}_max_N', 'N', 'peak', 'run ordinate', &
      'frame', of_envelopes, 'a mass; `&wall`', 'largest shear in the wall just below floor {i}', &
      id%wall_shear_i_max_over_m_w_g), &
      quantity_t(id%wall_shear_i_above_max_N, 'wall_shear_{i}_above_max_N', 'N', 'peak', &
      'run ordinate', 'frame', of_envelopes, 'a mass; `&wall`', &
      'largest shear in the wall just above floor {i}', id%wall_shear_i_above_max_over_m_w_g), &
      quantity_t(id%wall_moment_i_max_N_m, 'wall_moment_{i}_max_N_m', 'N m', 'peak', &
      'run ordinate', 'frame', of_envelopes, 'a mass; `&wall`', &
      'largest moment in the wall just below floor {i}', id%wall_moment_i_max_over_m_w_g_m), &
      quantity_t(id%wall_moment_i_above_max_N_m, 'wall_moment_{i}_above_max_N_m', 'N m', 'peak', &
      'run ordinate', 'frame', of_envelopes, 'a mass; `&wall`', &
      'largest moment in the wall just above floor {i}', id%wall_moment_i_above_max_over_m_w_g_m), &
      quantity_t(id%link_i_force_max_N, 'link_{i}_force_max_N', 'N', 'peak', 'run ordinate', &
      'frame', of_envelopes, 'a mass; `&wall`', 'largest axial force of the link at floor {i}', &
      id%link_i_force_max_over_m_w_g), &
      quantity_t(id%pivot_normal_max_N, 'pivot_normal_max_N', 'N', 'peak', 'run ordinate', 'wall', &
      of_envelopes, 'a mass', 'largest pivot reaction', id%pivot_normal_max_over_m_w_g), &
      quantity_t(id%contact_length_min_m, 'contact_length_min_m', 'm', 'peak', 'run ordinate', &
      '', of_envelopes, '`&base_section` or `&base`', 'smallest contact length of the base'), &
      quantity_t(id%toe_stress_max_Pa, 'toe_stress_max_Pa', 'Pa', 'peak', 'run ordinate', &
      '', of_envelopes, '`&base_section` or `&base`', &
      'largest compressive stress at the toe of the wall'), &
      quantity_t(id%toe_strain_max, 'toe_strain_max', '1', 'peak', 'run ordinate', 'base_section', &
      of_envelopes, '`E` or `length`', 'largest compressive strain at the toe of the wall')]

   !> Parts of the energy ledger, and its residual. Their error is at most 100 rtol times the
   !> largest part times their sensitivity to the motion (at least 1).
   type(quantity_t), parameter :: energies(*) = [ &
      quantity_t(id%energy_input_J_per_kg, 'energy_input_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', '', of_energy, '', &
      'work of the ground (energies over m_w; no wall: over m_s, `full`: of the roof)'), &
      quantity_t(id%energy_kinetic_J_per_kg, 'energy_kinetic_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', '', of_energy, '', 'kinetic energy of wall and floors'), &
      quantity_t(id%energy_strain_J_per_kg, 'energy_strain_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', 'frame', of_energy, '', &
      'energy that the springs of the frame hold'), &
      quantity_t(id%energy_gravity_J_per_kg, 'energy_gravity_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', 'wall', of_energy, '', 'potential energy of the wall'), &
      quantity_t(id%energy_cable_J_per_kg, 'energy_cable_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', 'cable', of_energy, '', 'work stored in the cable'), &
      quantity_t(id%energy_effects_J_per_kg, 'energy_effects_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', '', of_energy, 'an effect that stores energy', &
      'energy stored in fuses and other effects'), &
      quantity_t(id%energy_viscous_J_per_kg, 'energy_viscous_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', '', of_energy, 'a frame or a further effect', &
      'energy dissipated by dampers'), &
      quantity_t(id%energy_hysteretic_J_per_kg, 'energy_hysteretic_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', '', of_energy, 'springs that yield or break', &
      'energy dissipated by yielding'), &
      quantity_t(id%energy_impact_J_per_kg, 'energy_impact_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', 'wall', of_energy, '`base = ''rocking''`', &
      'energy dissipated by impacts'), &
      quantity_t(id%energy_bending_J_per_kg, 'energy_bending_J_per_kg', 'J/kg', 'end', &
      'history run ordinate', 'bending', of_energy, '', 'strain energy of the wall that bends'), &
      quantity_t(id%energy_bending_damping_J_per_kg, 'energy_bending_damping_J_per_kg', 'J/kg', &
      'end', 'history run ordinate', 'bending', of_energy, '', &
      'energy dissipated by the modes of the wall'), &
      quantity_t(id%energy_base_J_per_kg, 'energy_base_J_per_kg', 'J/kg', 'end', &
      'run ordinate', 'base', of_energy, '', &
      'energy dissipated by damping and crushing of the base'), &
      quantity_t(id%energy_friction_J_per_kg, 'energy_friction_J_per_kg', 'J/kg', 'end', &
      'run ordinate', 'base', of_energy, '`mu`', 'energy dissipated by slip of the base'), &
      quantity_t(id%energy_balance_relative, 'energy_balance_relative', '1', 'error', &
      'run ordinate', '', of_energy, '', 'residual of the energy ledger')]

   !> Additional results of spectra, sweeps and method comparisons.
   type(quantity_t), parameter :: others(*) = [ &
      quantity_t(id%b_m, 'b_m', 'm', 'axis', 'spectrum', 'wall', of_nothing, '', &
      'half width of the wall'), &
      quantity_t(id%gamma, 'gamma', '1', 'axis', 'spectrum', 'frame', of_nothing, '`&wall`', &
      'mass ratio'), &
      quantity_t(id%status, 'status', '', 'end', 'spectrum sweep cost', '', of_nothing, '', &
      'how the run ended', kind='text'), &
      quantity_t(id%threads, 'threads', '1', 'work', 'spectrum', '', of_nothing, '', &
      'threads of the kernel', kind='int'), &
      quantity_t(id%theta_max_rad, 'theta_max_rad', 'rad', 'peak', 'cost', 'wall', of_nothing, '', &
      'largest rotation of the wall'), &
      quantity_t(id%theta_end_rad, 'theta_end_rad', 'rad', 'end', 'cost', 'wall', of_nothing, '', &
      'rotation of the wall at the end'), &
      quantity_t(id%theta_dot_end_rad_s, 'theta_dot_end_rad_s', 'rad/s', 'end', 'cost', 'wall', &
      of_nothing, '', 'angular velocity of the wall at the end'), &
      quantity_t(id%t_end_s, 't_end_s', 's', 'end', 'cost', '', of_nothing, '', &
      'end of the simulation'), &
      quantity_t(id%relative_error, 'relative_error', '1', 'error', 'cost', '', of_nothing, '', &
      'of the peak, against the reference'), &
      quantity_t(id%theta_max_relative_error, 'theta_max_relative_error', '1', 'error', 'cost', &
      'wall', of_nothing, '', 'of the largest rotation, against the reference'), &
      quantity_t(id%impact_time_error_s, 'impact_time_error_s', 's', 'error', 'cost', 'wall', &
      of_nothing, '`base = ''rocking''`', &
      'largest distance of an impact from that of the reference, chatter left out'), &
      quantity_t(id%end_state_relative_error, 'end_state_relative_error', '1', 'error', 'cost', &
      '', of_nothing, '', &
      'of the state at the end, over the largest rotation and angular velocity'), &
      quantity_t(id%error_estimate, 'error_estimate', '', 'before', 'cost', '', of_nothing, '', &
      'how the error of the reference is estimated', kind='text'), &
      quantity_t(id%peak, 'peak', '', 'before', 'cost', '', of_nothing, '', &
      'key of the peak whose error is compared', kind='text'), &
      quantity_t(id%good_enough, 'good_enough', '1', 'whether', 'cost', '', of_nothing, '', &
      'whether the reference is two digits better than the best method', kind='logical')]

   !> All quantities. A summary and the columns of a history have this order. Sensitivities follow,
   !> see `sensitivity_row`.
   type(quantity_t), parameter :: all_quantities(*) = [columns, scalars, demands, envelopes, &
      energies, others]

contains

   !> Row of the quantity with a given number.
   elemental type(quantity_t) function row_of(number) result(row)
      integer, intent(in) :: number
      !! one of `id`

      row = all_quantities(findloc(all_quantities%id, number, dim=1))
   end function row_of

   !> Key of the quantity with a given number.
   elemental character(key_length) function key_of(number) result(key)
      integer, intent(in) :: number
      !! one of `id`

      key = all_quantities(findloc(all_quantities%id, number, dim=1))%key
   end function key_of

   !> Look up the row of an output key in the table, and the number of a floor or storey in the key.
   pure subroutine look_up(key, place, number)
      character(*), intent(in) :: key
      !! key as spelled in an output
      integer, intent(out) :: place
      !! row of `all_quantities`, 0 for an unknown key
      integer, intent(out) :: number
      !! floor or storey number; 0 for a key without one
      integer :: first, behind, status

      number = 0
      place = findloc(all_quantities%key == key, .true., dim=1)
      call find_number(key, first, behind)
      if (place > 0 .or. behind == first .or. behind > first + 4) return
      read (key(first:behind - 1), '(i4)', iostat=status) number
      if (status == 0) place = findloc(all_quantities%key == key(:first - 1)//'{i}'//key(behind:), &
         .true., dim=1)
   end subroutine look_up

   !> Key in the spelling of the outputs. Capitals are accepted, and names of Python, which have no
   !> units. An unknown key is returned in lower case.
   elemental character(key_length) function canonical_key(key)
      character(*), intent(in) :: key
      !! key in the user's spelling
      character(key_length) :: lower, own

      lower = to_lower(key)
      own = own_key(lower)
      canonical_key = canonical_own(own)
      if (own /= lower) canonical_key = prefix//trim(canonical_key)
   end function canonical_key

   !> Spelling of the outputs for a key that is not that of a sensitivity.
   elemental character(key_length) function canonical_own(key) result(canonical_key)
      character(*), intent(in) :: key
      !! key in lower case
      character(key_length) :: row
      integer :: place, first, behind, braces

      canonical_key = key
      place = place_of(trim(canonical_key))
      if (place > 0) then
         canonical_key = all_quantities(place)%key
         return
      end if
      call find_number(canonical_key, first, behind)
      if (behind == first) return
      row = canonical_key(:first - 1)//'{i}'//canonical_key(behind:)
      place = place_of(trim(row))
      if (place == 0) return
      row = all_quantities(place)%key
      braces = index(row, '{i}')
      canonical_key = row(:braces - 1)//canonical_key(first:behind - 1)//row(braces + 3:)
   end function canonical_own

   !> Row of a key or of a name in Python; 0 if there is none.
   pure integer function place_of(key) result(place)
      character(*), intent(in) :: key
      !! key in lower case

      if (key /= '') then
         ! row by row: the keys of the whole table would be a large copy on the stack
         do place = 1, size(all_quantities)
            if (to_lower(all_quantities(place)%key) == key) return
         end do
         do place = 1, size(all_quantities)
            if (to_lower(name_of(all_quantities(place))) == key) return
         end do
      end if
      place = 0
   end function place_of

   !> Variable of a run's dataset in Python: the key without its unit; '' for an attribute, or
   !> outside runs.
   elemental character(key_length) function name_of(quantity) result(name)
      type(quantity_t), intent(in) :: quantity
      character(9) :: suffix
      integer :: i, n

      name = quantity%name
      if (name == '-') name = ''
      if (quantity%name /= '' .or. index(quantity%outputs, 'history') + index(quantity%outputs, &
         'run') == 0) return
      name = quantity%key
      suffix = '_'//quantity%unit
      do i = 1, len_trim(suffix)
         if (scan(suffix(i:i), ' /') == 1) suffix(i:i) = '_'
      end do
      n = len_trim(name) - len_trim(suffix)
      if (n > 0 .and. quantity%unit /= '') then
         if (name(n + 1:) == suffix) name = name(:n)
      end if
   end function name_of

   !> Find the number of a floor or storey in a key: the first number between underscores.
   pure subroutine find_number(key, first, behind)
      character(*), intent(in) :: key
      integer, intent(out) :: first
      integer, intent(out) :: behind
      !! position after the number; equal to `first` if there is none

      integer :: place

      first = 1
      do
         place = index(key(first:), '_')
         first = first + place
         behind = first
         if (place == 0) return
         behind = first + verify(key(first:)//' ', '0123456789') - 1
         if (behind > first .and. scan(key(behind:min(behind, len(key)))//'_', '_ ') == 1) return
      end do
   end subroutine find_number

   !> True if a spectrum can report the quantity.
   elemental logical function is_of_ordinate(quantity)
      type(quantity_t), intent(in) :: quantity

      is_of_ordinate = index(quantity%outputs, 'ordinate') > 0
   end function is_of_ordinate

   !> True for a peak of a run for which a case can require an accuracy. The height of a peak along
   !> the wall is excluded.
   elemental logical function is_peak(quantity)
      type(quantity_t), intent(in) :: quantity

      is_peak = quantity%found == 'peak' .and. index(quantity%outputs, 'run') > 0 &
         .and. index(quantity%key, '_height_m') == 0
   end function is_peak

   !> Number of the sensitivity of a quantity.
   elemental integer function sensitivity_id(number)
      integer, intent(in) :: number
      !! one of `id`

      sensitivity_id = number + size(all_quantities)
   end function sensitivity_id

   !> Row of the sensitivity of a peak.
   elemental type(quantity_t) function sensitivity_row(peak) result(row)
      type(quantity_t), intent(in) :: peak

      row = quantity_t(sensitivity_id(peak%id), prefix//trim(peak%key), '1', 'error', &
         'run ordinate', peak%group, peak%observed, '`conditioning` of `&output`; a motion', &
         'relative change of this peak per relative change of the motion', &
         name=prefix//name_of(peak))
   end function sensitivity_row

   !> Key of the peak of a sensitivity; any other key is unchanged.
   elemental function own_key(key) result(own)
      character(*), intent(in) :: key
      !! key of a quantity
      character(len(key)) :: own

      own = key
      if (index(key, prefix) == 1) own = key(len(prefix) + 1:)
   end function own_key

   !> Key of `&output` that requests a quantity; '' for one that every run reports.
   elemental character(12) function requested_by(quantity)
      type(quantity_t), intent(in) :: quantity

      requested_by = ''
      if (any(quantity%observed == [character(12) :: of_reactions, of_demands, of_envelopes])) then
         requested_by = 'reactions'
      else if (quantity%observed == of_energy) then
         requested_by = 'energy'
      end if
   end function requested_by

end module rwmf_problem_quantity_table
