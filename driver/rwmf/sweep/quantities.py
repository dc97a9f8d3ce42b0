"""What a sweep can keep of each run: name in the dataset, key of the kernel's summary, unit."""

from __future__ import annotations

from dataclasses import dataclass

from rwmf.errors import InputError

__all__ = ["DISPLACEMENT", "QUANTITIES", "Quantity", "find_quantities"]

# the only one that the kernel returns for a whole grid at once
DISPLACEMENT = "u_s_max"


@dataclass(frozen=True)
class Quantity:
    """One number of a run.

    Attributes
    ----------
    key : str
        Key of the kernel's summary.
    unit : str
        Its unit.
    meaning : str
        What it is.
    """

    key: str
    unit: str
    meaning: str


QUANTITIES = {
    DISPLACEMENT: Quantity("u_s_max_m", "m", "largest displacement of the frame"),
    "theta_max_over_alpha": Quantity(
        "theta_max_over_alpha", "1", "largest rotation over slenderness"
    ),
    "theta_dot_max": Quantity("theta_dot_max_rad_s", "rad/s", "largest angular velocity"),
    "cable_force_increment_max_over_m_w_g": Quantity(
        "cable_force_increment_max_over_m_w_g",
        "1",
        "largest increment of the cable force over weight of wall",
    ),
    "impacts": Quantity("impacts", "1", "number of impacts"),
    "lift_offs": Quantity("lift_offs", "1", "number of times that the wall lifts off from rest"),
}


def find_quantities(names: tuple[str, ...]) -> dict[str, Quantity]:
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
