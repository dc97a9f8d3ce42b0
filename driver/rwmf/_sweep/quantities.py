"""What a sweep can keep of each run: scalars of the kernel's summary."""

from __future__ import annotations

from rwmf import quantities
from rwmf.errors import InputError

__all__ = ["DISPLACEMENT", "QUANTITIES", "find_quantities"]

# the only one that the kernel returns for a whole grid at once
DISPLACEMENT = "u_s_max"
QUANTITIES = {
    name: quantity
    for quantity in quantities.QUANTITIES.values()
    if "ordinate" in quantity.outputs.split() and "{i}" not in quantity.name
    for name in quantity.names("ordinate")
}


def find_quantities(names: tuple[str, ...]) -> dict[str, quantities.Quantity]:
    """Look up what is to be kept.

    Parameters
    ----------
    names : tuple of str
        Names in the dataset, or keys; the case of their letters does not matter.

    Returns
    -------
    dict of str to Quantity
        By their names in the dataset, in their order; of two names the one that was asked for.

    Raises
    ------
    InputError
        When there is none, or one is not known.
    """
    by_key = {quantity.key: quantity for quantity in QUANTITIES.values()}
    keys = quantities.keys_of(names)
    unknown = [name for name, key in zip(names, keys, strict=True) if key not in by_key]
    if unknown or not names:
        wrong = ", ".join(unknown) or "nothing"
        raise InputError(f"quantities: {wrong}: known are {', '.join(QUANTITIES)}")
    asked = {key: by_key[key].called(name) for key, name in zip(keys, names, strict=True)}
    return {name: by_key[key] for key, name in asked.items()}
