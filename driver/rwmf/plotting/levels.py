"""Drifts at which a frame or its storeys yield first, and at which they count as collapsed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf.case import Case
from rwmf.plotting.style import LIMIT, YIELD

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Levels", "draw_levels", "height_of_frame", "levels_of_frame", "levels_of_storeys"]

Array = npt.NDArray[np.float64]

# a level is drawn where it is no further from zero than this many times the largest value
_IN_REACH = 1.5


@dataclass(frozen=True)
class Levels:
    """Sizes of drifts or displacements, one for each storey.

    Attributes
    ----------
    first_yield : numpy.ndarray, shape (n,) or (0,)
        Where it yields first; empty when it cannot.
    limit : numpy.ndarray, shape (n,) or (0,)
        Where it has collapsed; empty when nothing limits it.
    """

    first_yield: Array
    limit: Array


def levels_of_storeys(dataset: xr.Dataset, case: Case, n: int) -> Levels:
    """Find the drifts of the storeys.

    Parameters
    ----------
    dataset : xarray.Dataset
        Its response, from `rwmf.simulate`.
    case : Case
        The case that was simulated.
    n : int
        Number of storeys.

    Returns
    -------
    Levels
        Drifts over the heights of the storeys [-].
    """
    law = case.yielding
    first: Array = np.empty(0)
    # given, or derived from forces: the key of the case does not matter
    if law is not None and "storey_u_y" in law:
        first = np.broadcast_to(law.storey_u_y, n) / np.broadcast_to(case.storeys.height, n)
    elif law is not None:
        # the storeys of one spring share its ductility
        largest = [float(dataset[f"storey_{i + 1}_drift_max"]) for i in range(n)]
        first = np.array(largest) * _first_share(dataset)
    return _with_limits(first, case, n, 1.0)


def levels_of_frame(dataset: xr.Dataset, case: Case) -> Levels:
    """Find the displacements of a frame of a single degree of freedom.

    Parameters
    ----------
    dataset : xarray.Dataset
        Its response, from `rwmf.simulate`.
    case : Case
        The case that was simulated.

    Returns
    -------
    Levels
        Displacements [m], one each.
    """
    first: Array = np.empty(0)
    if case.yielding is not None:
        first = np.array([float(dataset["u_s_max"]) * _first_share(dataset)])
    return _with_limits(first, case, 1, height_of_frame(case) or np.nan)


def height_of_frame(case: Case) -> float | None:
    """Find the height of a single degree of freedom.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    float or None
        Height [m]; None when nothing says it.
    """
    if case.p_delta is not None and "h_f" in case.p_delta.given:
        return float(case.p_delta.h_f)
    return None if case.wall is None else 2 * float(case.wall.h)


def _first_share(dataset: xr.Dataset) -> float:
    """First yield over the largest displacement; not a number where nothing has moved."""
    ductility = float(dataset["ductility"])
    return 1 / ductility if ductility > 0 else np.nan


def _with_limits(first: Array, case: Case, n: int, height: float) -> Levels:
    """Take the first limit to be reached of the drift's and the ductility's."""
    limits = np.full(n, np.inf)
    if case.p_delta is not None:
        limits = np.minimum(limits, float(case.p_delta.drift_limit) * height)
    if first.size and "ultimate" in case.yielding:
        limits = np.minimum(limits, first * float(case.yielding.ultimate))
    return Levels(first[np.isfinite(first)], limits[np.isfinite(limits)])


def draw_levels(ax: Axes, levels: Levels, factor: float, unit: str) -> None:
    """Draw levels on both sides of zero behind the lines of an axes, and name them above it.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        With the response over time.
    levels : Levels
        Its levels, of storeys that differ the lowest and the highest. Those far beyond the response
        are named but not drawn: it would be flat.
    factor : float
        Unit of the levels over that of the axes.
    unit : str
        Of the axes.
    """
    from matplotlib.lines import Line2D

    lines = []
    largest = max(
        (np.nanmax(np.abs(line.get_ydata()), initial=0.0) for line in ax.lines), default=0
    )
    for name, values, look in (
        ("yield", levels.first_yield, YIELD),
        ("limit", levels.limit, LIMIT),
    ):
        sizes = np.unique((factor * values).round(9))
        if not sizes.size:
            continue
        ends = " to ".join(f"{size:.3g}" for size in sorted({sizes[0], sizes[-1]}))
        lines.append(Line2D([], [], label=f"{name} {ends} {unit}", **look))
        if sizes[0] > _IN_REACH * largest:
            continue
        for size in {sizes[0], sizes[-1], -sizes[0], -sizes[-1]}:
            ax.axhline(size, **look)
    if lines:
        legend = ax.legend(
            handles=lines, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderpad=0.0
        )
        # another legend of the axes does not take its place, and nothing cuts it off
        ax.add_artist(legend)
        legend.set_clip_on(False)
