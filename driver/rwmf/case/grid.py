"""The grid of a case's spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from rwmf._numbers import to_array
from rwmf.case.case import Case
from rwmf.quantities import keys_of

__all__ = ["Values", "with_grid"]

Values = Sequence[float] | npt.NDArray[np.float64] | float


def with_grid(
    case: Case,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    quantities: Sequence[str] | None = None,
) -> Case:
    """Return the case with another grid, or other quantities, in its `&spectrum`."""
    grid: dict[str, npt.NDArray[np.float64] | list[str] | None] = {}
    if T_s is not None:
        # the list replaces the uniform grid
        grid |= dict.fromkeys(("T_s_min", "T_s_max", "n", "spacing"))
        grid["T_s"] = to_array("T_s", T_s, least=1)
    if gamma is not None:
        grid["gamma"] = to_array("gamma", gamma, least=1)
    if b is not None:
        grid["b"] = to_array("b", b, least=1)
    if quantities is not None:
        grid["quantities"] = keys_of(quantities)
    return case.replace(spectrum=grid) if grid else case
