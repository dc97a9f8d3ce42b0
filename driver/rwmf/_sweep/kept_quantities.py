"""What a sweep can keep of each run: scalars of the kernel's summary."""

from __future__ import annotations

from collections.abc import Sequence

from rwmf import _library, quantities
from rwmf._files.names import shorten
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = ["QUANTITIES", "default_quantity", "find_quantities", "find_quantity"]


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
    if not names:
        raise InputError(f"quantities: none is given; known are {', '.join(QUANTITIES)}")
    if unknown:
        hints = [f"{shorten(word)}: is unknown{_hint(word)}" for word in unknown]
        raise InputError(f"quantities: {' '.join(hints)} Known are {', '.join(QUANTITIES)}")
    return asked


def _hint(word: str) -> str:
    meant = _library.meant_quantity(word)
    if not meant:
        return "."
    return f", did you mean {quantities.QUANTITIES[meant].names('ordinate')[0]}?"


def find_quantity(case: Case, names: Sequence[str] | None, study: str) -> str:
    """Look up the one quantity of a study, by default what the scene reports by itself.

    Parameters
    ----------
    case : Case
        The case.
    names : sequence of str, optional
        Its name, in a list of one.
    study : str
        Name of the study in messages.

    Returns
    -------
    str
        Its name in a dataset.

    Raises
    ------
    InputError
        When it is not known, or when there are several.
    """
    found = find_quantities(tuple(names or (default_quantity(case),)))
    if len(found) > 1:
        raise InputError(f"{study}: quantities = {', '.join(found)}: must be one quantity")
    return next(iter(found))
