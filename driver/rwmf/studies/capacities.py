"""Statistics of capacities over a suite, smooth enough for `rwmf.gradient`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from rwmf._arguments import checked
from rwmf._numbers import show, to_array, to_number
from rwmf.errors import InputError

__all__ = ["annual_frequency", "fragility_median"]


@checked
def fragility_median(
    limit: float, levels: Sequence[float]
) -> Callable[[npt.NDArray[np.float64]], float]:
    """Make the statistic of `rwmf.gradient` for the median of a fragility.

    The capacity of a record is the intensity at which its demand first reaches the limit, between
    two levels by a line in logarithms. The median is the geometric mean of the capacities, a smooth
    function, unlike one fitted to counts.

    Parameters
    ----------
    limit : float
        Limit of the demand in its unit.
    levels : sequence of float
        The values of ``scale`` in the grid.

    Returns
    -------
    callable
        Median intensity of an array over ``record`` and ``scale``.

    Raises
    ------
    InputError
        When a record does not reach the limit between the first and the last level.
    """
    numbers = _levels_of(levels)
    return lambda values: math.exp(float(np.mean(_capacities(values, limit, numbers))))


@checked
def annual_frequency(
    limit: float, levels: Sequence[float], k0: float, k: float
) -> Callable[[npt.NDArray[np.float64]], float]:
    """Make the statistic of `rwmf.gradient` for the mean annual frequency of exceedance.

    With the hazard k0 s^-k and a lognormal fragility the frequency is
    k0 theta^-k exp(k^2 beta^2/2) (Cornell and others 2002).

    Parameters
    ----------
    limit : float
        Limit of the demand in its unit.
    levels : sequence of float
        The values of ``scale`` in the grid.
    k0, k : float
        Annual frequency of the level 1 [1/year], and slope of the hazard [-].

    Returns
    -------
    callable
        Frequency [1/year] of an array over ``record`` and ``scale``.

    Raises
    ------
    InputError
        When a record does not reach the limit between the first and the last level.
    """
    numbers = _levels_of(levels)
    k0, k = to_number("k0", k0, above=0.0), to_number("k", k, above=0.0)

    def frequency(values: npt.NDArray[np.float64]) -> float:
        logarithms = _capacities(values, limit, numbers)
        median, variance = math.exp(float(np.mean(logarithms))), float(np.var(logarithms, ddof=1))
        return float(k0 * median**-k * math.exp(k**2 * variance / 2))

    return frequency


def _levels_of(levels: Sequence[float]) -> npt.NDArray[np.float64]:
    numbers = to_array("levels", levels, above=0.0, least=2)
    if not (np.diff(numbers) > 0).all():
        raise InputError(f"levels = {show(levels)}: must increase")
    return numbers


def _capacities(
    values: npt.NDArray[np.float64], limit: float, levels: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the logarithms of the intensities at which records first reach the limit."""
    above = values > limit
    if not above.any(axis=1).all() or above[:, 0].any():
        raise InputError(
            f"levels: every record must reach the limit {limit:g} between the first and the last"
        )
    at = above.argmax(axis=1)
    rows = np.arange(len(values))
    low, high = np.log(values[rows, at - 1]), np.log(values[rows, at])
    # beside a collapse the middle of the two levels
    part = np.where(np.isinf(high), 0.5, (math.log(limit) - low) / (high - low))
    logs = np.log(levels)
    capacities: npt.NDArray[np.float64] = logs[at - 1] + part * (logs[at] - logs[at - 1])
    return capacities
