"""What a sweep can keep of each run: scalars of the kernel's summary."""

from __future__ import annotations

from rwmf import quantities
from rwmf.errors import InputError

__all__ = ["DISPLACEMENT", "QUANTITIES", "find_quantities"]

# the only one that the kernel returns for a whole grid at once
DISPLACEMENT = "u_s_max"
QUANTITIES = {
    quantity.name: quantity
    for quantity in quantities.QUANTITIES.values()
    if quantity.name and "run" in quantity.outputs.split()
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
