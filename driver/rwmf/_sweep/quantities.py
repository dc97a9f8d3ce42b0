"""What a sweep can keep of each run: scalars of the kernel's summary."""

from __future__ import annotations

from rwmf import quantities
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = ["QUANTITIES", "default_quantity", "find_quantities"]


class _Table(dict[str, quantities.Quantity]):
    """By name; that of a floor or storey is its row with its number."""

    def __missing__(self, name: str) -> quantities.Quantity:
        try:
            found = quantities.find(*quantities.keys_of([name]))
        except (KeyError, StopIteration):
            raise KeyError(name) from None
        if "ordinate" not in found.outputs.split():
            raise KeyError(name)
        return found


QUANTITIES = _Table(
    (name, quantity)
    for quantity in quantities.QUANTITIES.values()
    if "ordinate" in quantity.outputs.split()
    for name in quantity.names("ordinate")
)


def default_quantity(case: Case) -> str:
    """Name what is kept of each run where nothing else is asked for.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    str
        The displacement of the frame; without a frame the rotation of the wall.
    """
    return quantities.QUANTITIES[case.kernel.default_quantity()].names("ordinate")[0]


def find_quantities(names: tuple[str, ...]) -> dict[str, quantities.Quantity]:
    """Look up what is to be kept.

    Parameters
    ----------
    names : tuple of str
        Names in the dataset, or keys; the case of their letters does not matter.

    Returns
    -------
    dict of str to Quantity
        By their names in the dataset, in their order. A quantity with two names in a dataset comes
        back under each that is requested.

    Raises
    ------
    InputError
        When there is none, or one is not known.
    """
    by_key = _Table((quantity.key, quantity) for quantity in QUANTITIES.values())
    asked: dict[str, quantities.Quantity] = {}
    unknown: list[str] = []
    for name, key in zip(names, quantities.keys_of(names), strict=True):
        try:
            quantity = by_key[key]
        except KeyError:
            unknown.append(name)
        else:
            asked[quantity.called(name)] = quantity
    if unknown or not names:
        wrong = ", ".join(unknown) or "nothing"
        raise InputError(f"quantities: {wrong}: known are {', '.join(QUANTITIES)}")
    return asked
