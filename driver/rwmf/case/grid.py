"""The grid of a case's spectrum, and heights of its storeys."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rwmf._numbers import to_array
from rwmf.case.case import Case
from rwmf.quantities import keys_of

if TYPE_CHECKING:
    from rwmf.case.case import Case


def heights_of_storeys(case: Case, n: int) -> list[float]:
    """Return the height of each storey, from floor to floor; a frame without storeys has one."""
    if case.storeys is None:
        height = height_of_frame(case)
        return [] if height is None else [height]
    given = case.storeys.height
    return list(given) * (n if len(given) == 1 else 1)


def height_of_frame(case: Case) -> float | None:
    """Return the height of a frame with one degree of freedom."""
    if case.p_delta is not None and "h_f" in case.p_delta.given:
        return case.p_delta.h_f
    return None if case.wall is None else 2 * case.wall.h


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
