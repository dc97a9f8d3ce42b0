"""What a sweep can keep of each run: scalars of the kernel's summary."""

from __future__ import annotations

from rwmf import quantities
from rwmf.errors import InputError

__all__ = ["DISPLACEMENT", "QUANTITIES", "find_quantities"]

# the only one that the kernel returns for a whole grid at once
DISPLACEMENT = "u_s_max"
_SCALARS = (
    "u_s_max_m",
    "theta_max_over_alpha",
    "theta_dot_max_rad_s",
    "cable_force_increment_max_over_m_w_g",
    "impacts",
    "lift_offs",
    "friction_demand_max",
    "pivot_normal_min_over_m_w_g",
    "pivot_lifts",
    "base_shear_max_over_weight",
    "wall_drift_max",
    "frame_drift_max",
    "cable_prestress_loss_over_m_w_g",
    "cable_ruptured",
    "ductility",
    "residual_displacement_m",
    "energy_input_J_per_kg",
    "energy_viscous_J_per_kg",
    "energy_hysteretic_J_per_kg",
    "energy_impact_J_per_kg",
    "energy_balance_relative",
)
QUANTITIES = {
    quantity.name: quantity for quantity in (quantities.QUANTITIES[key] for key in _SCALARS)
}


def find_quantities(names: tuple[str, ...]) -> dict[str, quantities.Quantity]:
    """Look up what is to be kept.

    Parameters
    ----------
    names : tuple of str
        Names in the dataset.

    Returns
    -------
    dict of str to Quantity
        In the order of the names.

    Raises
    ------
    InputError
        When there is none, or one is not known.
    """
    unknown = [name for name in names if name not in QUANTITIES]
    if unknown or not names:
        wrong = ", ".join(unknown) or "nothing"
        raise InputError(f"quantities: {wrong}: known are {', '.join(QUANTITIES)}")
    return {name: QUANTITIES[name] for name in names}
