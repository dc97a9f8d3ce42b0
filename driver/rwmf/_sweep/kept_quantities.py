"""Quantities of a run that a sweep can store: scalars of the kernel's summary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from rwmf import _library, quantities
from rwmf._files.names import shorten
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = [
    "QUANTITIES",
    "default_quantity",
    "find_quantities",
    "find_quantity",
    "refuse_missing",
]


_LIST = "the list: reference/outputs.md"


class _Table(dict[str, quantities.Quantity]):
    """Quantities by name; a name with the number of a floor or storey gets the numbered row."""

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
    """Return the name of the quantity that a sweep stores by default."""
    return quantities.QUANTITIES[case.kernel.default_quantity()].names("ordinate")[0]


def find_quantities(names: tuple[str, ...]) -> dict[str, quantities.Quantity]:
    """Look up the quantities to store."""
    by_key = _Table((quantity.key, quantity) for quantity in QUANTITIES.values())
    requested: dict[str, quantities.Quantity] = {}
    unknown: list[str] = []
    for name, key in zip(names, quantities.keys_of(names), strict=True):
        try:
            quantity = by_key[key]
        except KeyError:
            unknown.append(name)
        else:
            requested[quantity.called(name)] = quantity
    if not names:
        raise InputError(f"quantities: none is given; {_LIST}")
    if unknown:
        hints = [f"{shorten(word)}: is unknown{_hint(word)}" for word in unknown]
        raise InputError(f"quantities: {' '.join(hints)} {_LIST.capitalize()}")
    return requested


def _hint(word: str) -> str:
    meant = _library.meant_quantity(word)
    if not meant:
        return "."
    return f", did you mean {quantities.QUANTITIES[meant].names('ordinate')[0]}?"


def find_quantity(case: Case, names: Sequence[str] | None, study: str) -> str:
    """Look up the quantity of a study; the default is that of the scene."""
    found = find_quantities(tuple(names or (default_quantity(case),)))
    if len(found) > 1:
        raise InputError(f"{study}: quantities = {', '.join(found)}: must be one quantity")
    return next(iter(found))


def refuse_missing(found: xr.Dataset, names: Sequence[str], label: str) -> None:
    """Refuse quantities that no complete run has."""
    words = found["status"].attrs["flag_meanings"].split()
    is_complete = found["status"].values == (words.index("ok") if "ok" in words else -1)
    for name in names:
        if is_complete.any() and np.isnan(found[name].values[is_complete]).all():
            raise InputError(f"{label}: {name}: a run of this case has no such result")
