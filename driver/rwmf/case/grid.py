"""The grid of a case's spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from rwmf.case.case import Case
from rwmf.quantities import keys_of

__all__ = ["Values", "count_ordinates", "with_grid"]

Values = Sequence[float] | npt.NDArray[np.float64] | float


def with_grid(
    case: Case,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    quantities: Sequence[str] | None = None,
) -> Case:
    """Return the case with another grid, or other quantities, in its `&spectrum`.

    Parameters
    ----------
    case : Case
        The case.
    T_s, gamma, b : float or sequence of float, optional
        As in `spectrum`; None leaves what the case has.
    quantities : sequence of str, optional
        Likewise.

    Returns
    -------
    Case
        The edited case, or the same one when there is nothing to edit.

    Raises
    ------
    InputError
        When the grid is not acceptable.
    """
    grid: dict[str, list[float] | list[str] | None] = {}
    if T_s is not None:
        # the list takes the place of the whole uniform grid
        grid |= dict.fromkeys(("T_s_min", "T_s_max", "n", "spacing"))
        grid["T_s"] = _floats(T_s)
    if gamma is not None:
        grid["gamma"] = _floats(gamma)
    if b is not None:
        grid["b"] = _floats(b)
    if quantities is not None:
        grid["quantities"] = keys_of(quantities)
    return case.replace(spectrum=grid) if grid else case


def count_ordinates(case: Case) -> int:
    """Count the simulations of a case's spectrum.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    int
        Their number, 0 without `&spectrum`.
    """
    grid = case.groups.get("spectrum")
    if grid is None:
        return 0
    periods = len(grid["T_s"]) if "T_s" in grid else int(grid["n"])
    return periods * len(grid.get("gamma", (0,))) * len(grid.get("b", (0,)))


def _floats(values: Values) -> list[float]:
    return np.atleast_1d(np.asarray(values, dtype=np.float64)).ravel().tolist()
