"""What a run returns: key of the kernel, name in a dataset, unit, meaning, how to ask for it."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["QUANTITIES", "Quantity"]


@dataclass(frozen=True)
class Quantity:
    """A column of the history or a scalar of a run.

    Attributes
    ----------
    key : str
        Column or key of the summary in the kernel.
    name : str
        Variable of a dataset.
    unit : str
        Its unit.
    meaning : str
        What it is.
    asked_by : str
        Key of `&output` that asks for it; '' when every run has it.
    """

    key: str
    name: str
    unit: str
    meaning: str
    asked_by: str = ""


_ALWAYS = [
    Quantity("t_s", "time", "s", "time"),
    Quantity("theta_rad", "theta", "rad", "rotation of the wall"),
    Quantity("theta_dot_rad_s", "theta_dot", "rad/s", "angular velocity of the wall"),
    Quantity("theta_ddot_rad_s2", "theta_ddot", "rad/s2", "angular acceleration of the wall"),
    Quantity("u_s_m", "u_s", "m", "displacement of the frame"),
    Quantity("u_s_dot_m_s", "u_s_dot", "m/s", "velocity of the frame"),
    Quantity("u_g_ddot_m_s2", "u_g_ddot", "m/s2", "ground acceleration"),
    Quantity("v_g_ddot_m_s2", "v_g_ddot", "m/s2", "vertical ground acceleration"),
    Quantity(
        "cable_force_over_m_w_g", "cable_force_over_m_w_g", "1", "cable force over weight of wall"
    ),
    Quantity("cable_force_N", "cable_force", "N", "cable force"),
    Quantity(
        "frame_force_over_m_s_g",
        "frame_force_over_m_s_g",
        "1",
        "force of the yielding frame over weight of its mass",
    ),
    Quantity(
        "fuse_left_force_over_m_w_g",
        "fuse_left_force_over_m_w_g",
        "1",
        "force of the left fuse over weight of wall",
    ),
    Quantity(
        "fuse_right_force_over_m_w_g",
        "fuse_right_force_over_m_w_g",
        "1",
        "force of the right fuse over weight of wall",
    ),
    Quantity("u_s_max_m", "u_s_max", "m", "largest displacement of the frame"),
    Quantity("t_u_s_max_s", "t_u_s_max", "s", "first time of the largest displacement"),
    Quantity(
        "theta_max_over_alpha", "theta_max_over_alpha", "1", "largest rotation over slenderness"
    ),
    Quantity("theta_dot_max_rad_s", "theta_dot_max", "rad/s", "largest angular velocity"),
    Quantity(
        "cable_force_increment_max_over_m_w_g",
        "cable_force_increment_max_over_m_w_g",
        "1",
        "largest increment of the cable force over weight of wall",
    ),
    Quantity(
        "cable_prestress_loss_over_m_w_g",
        "cable_prestress_loss_over_m_w_g",
        "1",
        "cable force at theta = 0 that is lost in the end, over weight of wall",
    ),
    Quantity("cable_ruptured", "cable_ruptured", "1", "whether the cable broke"),
    Quantity("ductility", "ductility", "1", "largest displacement over that at first yield"),
    Quantity(
        "residual_displacement_m",
        "residual_displacement",
        "m",
        "displacement at which the frame alone would be without force in the end",
    ),
    Quantity(
        "theta_end_over_alpha",
        "theta_end_over_alpha",
        "1",
        "rotation in the end over alpha, at which fuses may hold the wall up",
    ),
    Quantity("impacts", "impacts", "1", "number of impacts"),
    Quantity("lift_offs", "lift_offs", "1", "number of times that the wall lifts off from rest"),
    Quantity("overturned", "overturned", "1", "whether the wall overturned"),
    Quantity("e", "e", "1", "velocity factor at impact"),
    Quantity("e_max", "e_max", "1", "velocity factor that the momentum balance allows"),
]
# history columns, then scalars
_REACTIONS = [
    ("base_shear_over_weight", "1", "base shear over weight of wall and frame"),
    ("pivot_normal_over_m_w_g", "1", "vertical reaction of the pivot over weight of wall"),
    ("pivot_horizontal_over_m_w_g", "1", "horizontal reaction of the pivot over weight of wall"),
    ("friction_demand", "1", "horizontal over vertical reaction of the pivot"),
    ("wall_drift", "1", "displacement of the wall's top over its height"),
    ("frame_drift", "1", "displacement of the frame over the wall's height"),
    ("pivot_normal_N", "N", "vertical reaction of the pivot"),
    ("pivot_horizontal_N", "N", "horizontal reaction of the pivot"),
    ("base_shear_max_over_weight", "1", "largest base shear over weight of wall and frame"),
    ("t_base_shear_max_s", "s", "time of the largest base shear"),
    ("pivot_normal_min_over_m_w_g", "1", "smallest pivot reaction over weight of wall"),
    ("t_pivot_normal_min_s", "s", "time of the smallest pivot reaction"),
    ("pivot_lifts", "1", "whether the pivot reaction was not positive at some time"),
    ("friction_demand_max", "1", "required coefficient of friction"),
    ("t_friction_demand_max_s", "s", "time of the largest friction demand"),
    ("friction_exceeded", "1", "whether the friction demand exceeded the limit"),
    ("t_friction_exceeded_s", "s", "first time at which the demand exceeds the limit"),
    ("wall_drift_max", "1", "largest drift of the wall"),
    ("frame_drift_max", "1", "largest drift of the frame"),
]
# history columns, and in the summary their values in the end
_ENERGIES = [
    ("energy_input_J_per_kg", "J/kg", "work of the ground motion"),
    ("energy_kinetic_J_per_kg", "J/kg", "kinetic energy"),
    ("energy_strain_J_per_kg", "J/kg", "strain energy of the frame"),
    ("energy_gravity_J_per_kg", "J/kg", "potential energy of the wall"),
    ("energy_cable_J_per_kg", "J/kg", "work stored in the cable"),
    ("energy_effects_J_per_kg", "J/kg", "energy stored in fuses and other effects"),
    ("energy_viscous_J_per_kg", "J/kg", "energy dissipated by dampers"),
    ("energy_hysteretic_J_per_kg", "J/kg", "energy dissipated by yielding"),
    ("energy_impact_J_per_kg", "J/kg", "energy dissipated by impacts"),
    ("energy_balance_relative", "1", "residual of the energy ledger"),
]
QUANTITIES = {
    quantity.key: quantity
    for quantity in (
        *_ALWAYS,
        *(Quantity(key, key, unit, text, "reactions") for key, unit, text in _REACTIONS),
        *(Quantity(key, key, unit, text, "energy") for key, unit, text in _ENERGIES),
    )
}
