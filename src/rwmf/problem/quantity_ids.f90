!> Numbers of the output quantities, by which the kernel names them.
module rwmf_problem_quantity_ids
   implicit none
   private

   public :: id

   !> Index numbers of the quantities, in any order.
   type :: ids_t
      integer :: t_s = 1, theta_rad = 2, theta_dot_rad_s = 3, theta_ddot_rad_s2 = 4, u_s_m = 5
      integer :: u_s_dot_m_s = 6, u_g_ddot_m_s2 = 7, v_g_ddot_m_s2 = 8, cable_force_over_m_w_g = 9
      integer :: cable_force_N = 10, frame_force_over_m_s_g = 11, fuse_left_force_over_m_w_g = 12
      integer :: fuse_right_force_over_m_w_g = 13, floor_i_m = 14, storey_i_drift = 15
      integer :: storey_i_shear_over_m_w_g = 16, base_shear_over_weight = 17
      integer :: pivot_normal_over_m_w_g = 18, pivot_horizontal_over_m_w_g = 19
      integer :: friction_demand = 20, wall_drift = 21, frame_drift = 22, pivot_normal_N = 23
      integer :: pivot_horizontal_N = 24, floor_i_acceleration_g = 25
      integer :: overturning_moment_over_weight_m = 26, wall_shear_over_m_w_g = 27
      integer :: wall_moment_over_m_w_g_m = 28, frame_force_N = 29, fuse_left_force_N = 30
      integer :: fuse_right_force_N = 31, storey_i_shear_N = 32, base_shear_N = 33
      integer :: overturning_moment_N_m = 34, wall_shear_N = 35, wall_moment_N_m = 36
      integer :: u_s_max_m = 37, t_u_s_max_s = 38, theta_max_over_alpha = 39
      integer :: theta_dot_max_rad_s = 40, cable_force_increment_max_over_m_w_g = 41
      integer :: cable_prestress_loss_over_m_w_g = 42, cable_ruptured = 43, ductility = 44
      integer :: residual_displacement_m = 45, theta_end_over_alpha = 46, storey_i_ductility = 47
      integer :: storey_i_residual_drift = 48, storey_i_residual_drift_at_rest = 49, impacts = 50
      integer :: lift_offs = 51, overturned = 52, collapsed = 53, t_collapse_s = 54, e = 55
      integer :: e_max = 56, T_s_s = 57, modal_mass_over_m_w = 58, mass_participation = 59
      integer :: modal_height_m = 60, roof_factor = 61, base_shear_max_over_weight = 62
      integer :: t_base_shear_max_s = 63, pivot_normal_min_over_m_w_g = 64
      integer :: t_pivot_normal_min_s = 65, pivot_lifts = 66, friction_demand_max = 67
      integer :: t_friction_demand_max_s = 68, shear_key_force_max_over_m_w_g = 69
      integer :: t_shear_key_force_max_s = 70, friction_exceeded = 71, t_friction_exceeded_s = 72
      integer :: wall_drift_max = 73, frame_drift_max = 74, cable_force_increment_max_N = 75
      integer :: cable_prestress_loss_N = 76, base_shear_max_N = 77, pivot_normal_min_N = 78
      integer :: shear_key_force_max_N = 79, steps = 80, rhs_evaluations = 81, seconds = 82
      integer :: method = 83, rtol = 84, estimated_relative_error = 85, estimate_seconds = 86
      integer :: sensitivity = 87, effects = 88, warnings = 89, storey_i_drift_max = 90
      integer :: storey_drift_max = 91, t_storey_drift_max_s = 92, roof_drift_max = 93
      integer :: t_roof_drift_max_s = 94, storey_residual_drift_max = 95, roof_residual_drift = 96
      integer :: roof_residual_drift_at_rest = 97, floor_i_acceleration_max_g = 98
      integer :: floor_acceleration_max_g = 99, t_floor_acceleration_max_s = 100
      integer :: storey_i_shear_max_over_m_w_g = 101, overturning_moment_max_over_weight_m = 102
      integer :: t_overturning_moment_max_s = 103, wall_shear_max_over_m_w_g = 104
      integer :: wall_shear_max_height_m = 105, wall_moment_max_over_m_w_g_m = 106
      integer :: wall_moment_max_height_m = 107, storey_i_shear_max_N = 108
      integer :: overturning_moment_max_N_m = 109, wall_shear_max_N = 110
      integer :: wall_moment_max_N_m = 111, energy_input_J_per_kg = 112
      integer :: energy_kinetic_J_per_kg = 113, energy_strain_J_per_kg = 114
      integer :: energy_gravity_J_per_kg = 115, energy_cable_J_per_kg = 116
      integer :: energy_effects_J_per_kg = 117, energy_viscous_J_per_kg = 118
      integer :: energy_hysteretic_J_per_kg = 119, energy_impact_J_per_kg = 120
      integer :: energy_balance_relative = 121, b_m = 122, gamma = 123, status = 124, threads = 125
      integer :: theta_max_rad = 126, theta_end_rad = 127, theta_dot_end_rad_s = 128, t_end_s = 129
      integer :: relative_error = 130, theta_max_relative_error = 131, impact_time_error_s = 132
      integer :: end_state_relative_error = 133, error_estimate = 134, peak = 135
      integer :: good_enough = 136
      integer :: wall_shear_base_over_m_w_g = 137, wall_moment_base_over_m_w_g_m = 138
      integer :: link_i_force_over_m_w_g = 139, wall_shear_base_N = 140
      integer :: wall_moment_base_N_m = 141, link_i_force_N = 142
      integer :: tendon_force_max_over_m_w_g = 143, tendon_force_max_N = 144
      integer :: tendon_stress_max_Pa = 145, wall_shear_base_max_over_m_w_g = 146
      integer :: wall_moment_base_max_over_m_w_g_m = 147, wall_shear_mid_max_over_m_w_g = 148
      integer :: wall_moment_mid_max_over_m_w_g_m = 149, wall_shear_i_max_over_m_w_g = 150
      integer :: wall_shear_i_above_max_over_m_w_g = 151, wall_moment_i_max_over_m_w_g_m = 152
      integer :: wall_moment_i_above_max_over_m_w_g_m = 153, link_i_force_max_over_m_w_g = 154
      integer :: pivot_normal_max_over_m_w_g = 155, fuse_stroke_max_m = 156
      integer :: fuse_stroke_sum_m = 157, floor_i_velocity_max_m_s = 158
      integer :: wall_shear_base_max_N = 159, wall_moment_base_max_N_m = 160
      integer :: wall_shear_mid_max_N = 161, wall_moment_mid_max_N_m = 162
      integer :: wall_shear_i_max_N = 163, wall_shear_i_above_max_N = 164
      integer :: wall_moment_i_max_N_m = 165, wall_moment_i_above_max_N_m = 166
      integer :: link_i_force_max_N = 167, pivot_normal_max_N = 168
      integer :: q_i_m = 169, tip_deflection_max_m = 170, energy_bending_J_per_kg = 171
      integer :: energy_bending_damping_J_per_kg = 172
      integer :: contact_length_m = 173, toe_stress_Pa = 174, toe_strain = 175
      integer :: contact_length_min_m = 176, toe_stress_max_Pa = 177, toe_strain_max = 178
      integer :: tendon_strain_max = 179, friction_demand_impact_max = 180
      integer :: mode_i_damping_contact = 181, mode_i_damping_rocking = 182
      integer :: cable_i_force_over_m_w_g = 183, fuse_i_force_over_m_w_g = 184
      integer :: restraint_i_force_over_m_w_g = 185, coupling_force_over_m_w_g = 186
      integer :: cable_i_force_N = 187, fuse_i_force_N = 188
      integer :: restraint_i_force_N = 189, coupling_force_N = 190
      integer :: cable_i_force_max_over_m_w_g = 191, cable_i_force_max_N = 192
      integer :: cable_i_force_min_over_m_w_g = 193, cable_i_force_min_N = 194
      integer :: cable_i_prestress_loss_over_m_w_g = 195, cable_i_prestress_loss_N = 196
      integer :: fuse_i_stroke_max_m = 197, fuse_i_stroke_min_m = 198
      integer :: fuse_i_stroke_sum_m = 199, fuse_i_force_max_over_m_w_g = 200
      integer :: fuse_i_force_max_N = 201, fuse_i_force_end_over_m_w_g = 202
      integer :: fuse_i_force_end_N = 203, restraint_i_stroke_max_m = 204
      integer :: restraint_i_stroke_min_m = 205, restraint_i_stroke_sum_m = 206
      integer :: restraint_i_force_max_over_m_w_g = 207, restraint_i_force_max_N = 208
      integer :: restraint_i_force_end_over_m_w_g = 209, restraint_i_force_end_N = 210
      integer :: coupling_stroke_max_m = 211, coupling_stroke_sum_m = 212
      integer :: coupling_force_max_over_m_w_g = 213, coupling_force_max_N = 214
      integer :: coupling_force_end_over_m_w_g = 215, coupling_force_end_N = 216
      integer :: coupling_ratio = 217, uplift_left_g = 218
      integer :: uplift_right_g = 219
      integer :: base_height_m = 220, base_slip_m = 221, base_normal_over_m_w_g = 222
      integer :: base_normal_N = 223, base_shear_over_m_w_g = 224
      integer :: toe_settlement_max_m = 225, middle_rise_max_m = 226
      integer :: toe_stress_max_over_k_m = 227, base_normal_max_over_m_w_g = 228
      integer :: base_normal_min_over_m_w_g = 229, base_normal_max_N = 230
      integer :: base_normal_min_N = 231, base_shear_max_over_m_w_g = 232
      integer :: slide_max_m = 233, slide_end_m = 234, slips = 235
      integer :: crushed_depth_max_m = 236, crushed_left_m = 237, crushed_right_m = 238
      integer :: middle_end_m = 239, flights = 240, t_flight_first_s = 241
      integer :: energy_base_J_per_kg = 242, energy_friction_J_per_kg = 243
   end type ids_t

   type(ids_t), parameter :: id = ids_t()

end module rwmf_problem_quantity_ids
