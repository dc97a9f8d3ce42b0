"""Adjustment of collapse margin ratios by FEMA P-695 (2009), sections 7.2 and B.4."""

from __future__ import annotations

import math

from rwmf._numbers import show, to_items, to_number
from rwmf.errors import InputError

__all__ = ["shape_factor_of", "spectral_shape_factor"]

# expected epsilon of the rare motion by seismic design category
_EPSILONS = dict.fromkeys(("B", "C", "DMIN"), 1.0) | {"DMAX": 1.5}
_NAMES = "B, C, Dmin, Dmax"


def spectral_shape_factor(period: float, ductility: float, category: str) -> float:
    """Compute the spectral shape factor of the far-field record set of FEMA P-695.

    This is the formula behind Tables 7-1a and 7-1b. As in the tables, the factor is constant below
    0.5 s, above 1.5 s and above a ductility of 8.
    """
    period = to_number("shape factor: period", period, above=0.0)
    ductility = to_number("shape factor: ductility", ductility)
    if ductility < 1:
        raise InputError(f"shape factor: ductility = {ductility:g}: must be >= 1")
    expected = _EPSILONS.get(str(category).upper())
    if expected is None:
        raise InputError(f"shape factor: category = {show(category)}: must be one of {_NAMES}")
    of_records = 0.6 * (1.5 - min(max(period, 0.5), 1.5))
    slope = 0.14 * (min(ductility, 8.0) - 1.0) ** 0.42
    return math.exp(slope * (expected - of_records))


def shape_factor_of(value: object) -> float:
    """Return the spectral shape factor of an argument."""
    items = to_items(value)
    if items is not None and len(items) == 3:
        return spectral_shape_factor(items[0], items[1], str(items[2]))
    if items is not None:
        raise InputError(
            f"shape_factor = {show(value)}: must be a number, or period, ductility and category"
        )
    return to_number("shape_factor", value, above=0.0)
