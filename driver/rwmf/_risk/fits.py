"""Lognormal capacities from counts, from capacities of records, and from clouds of demands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf._risk.likelihood import BELOW, EXACT, OVER, Observations, maximise

__all__ = ["Fit", "fit_capacities", "fit_cloud", "fit_counts"]

Array = npt.NDArray[np.float64]
Kinds = npt.NDArray[np.int64]
# a smaller deviation of logarithms is rounding
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Fit:
    """Fitted distributions of the sample or of its resamples.

    Attributes
    ----------
    median : numpy.ndarray, shape (b,)
        Medians; infinite where no run exceeds, 0 where every run does, NaN where the probability
        does not grow.
    dispersion : numpy.ndarray, shape (b,)
        Standard deviations of the logarithm [-]; NaN without a fit, 0 for a step.
    slope : numpy.ndarray, shape (b,), optional
        Exponent of the intensity in the median demand of a cloud.
    scatter : numpy.ndarray, shape (b,), optional
        Standard deviation of the logarithm of its demand [-].
    """

    median: Array
    dispersion: Array
    slope: Array | None = None
    scatter: Array | None = None


def fit_counts(levels: Array, exceeded: Array, runs: Array) -> Fit:
    """Fit counts of exceedance by maximum likelihood (Baker 2015, Earthquake Spectra 31(1))."""
    n = len(exceeded)
    median, dispersion = np.full(n, math.nan), np.full(n, math.nan)
    regular = np.zeros(n, dtype=bool)
    for i in range(n):
        used = runs[i] > 0
        step = _step(levels[used], exceeded[i, used], runs[i, used])
        if step is None:
            regular[i] = True
        else:
            median[i] = step
            dispersion[i] = 0.0 if 0 < step < math.inf else math.nan
    if regular.any():
        x = np.log(levels)
        centre, spread = float(x.mean()), float(x.std())
        rows = np.column_stack([np.ones(x.size), (x - centre) / spread])
        sample = Observations(np.vstack([rows, rows]), np.repeat([BELOW, OVER], x.size))
        weights = np.hstack([exceeded, runs - exceeded])[regular]
        a, b = maximise(sample, weights, np.array([0.0, 1.0])).T
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            grows = b > _ROUNDING
            median[regular] = np.where(grows, np.exp(centre - spread * a / b), math.nan)
            dispersion[regular] = np.where(grows, spread / b, math.nan)
    return Fit(median, dispersion)


def _step(levels: Array, exceeded: Array, runs: Array) -> float | None:
    """Return the median of counts that step from none to all, None for others."""
    if not exceeded.any():
        return math.inf
    if (exceeded == runs).all():
        return 0.0
    none, every = exceeded == 0, exceeded == runs
    last = levels[~every].max()
    first = levels[~none].min()
    if first > last:
        return math.sqrt(first * last)
    if first < last:
        return None
    # a single level between none and all has an ever steeper curve; at an end its median may lie
    # anywhere beyond
    share = float(exceeded[levels == first][0] / runs[levels == first][0])
    if first == levels.max() and share <= 0.5:
        return math.inf
    return 0.0 if first == levels.min() and share >= 0.5 else float(first)


def fit_capacities(logarithms: Array, kinds: Kinds, weights: Array) -> Fit:
    """Fit capacities of records; the dispersion has n - 1 degrees of freedom."""
    n = len(weights)
    mean, scatter = np.full(n, math.nan), np.full(n, math.nan)
    regular = np.zeros(n, dtype=bool)
    for i in range(n):
        y, kind = logarithms[weights[i] > 0], kinds[weights[i] > 0]
        exact = y[kind == EXACT]
        if exact.size == 0:
            mean[i] = math.inf if (kind == OVER).all() else -math.inf
        elif np.ptp(exact) <= _ROUNDING * max(1.0, np.abs(exact).max()) and _holds(
            exact[0], y, kind
        ):
            mean[i], scatter[i] = exact[0], 0.0
        else:
            regular[i] = True
    if regular.any():
        exact_y = logarithms[kinds == EXACT]
        centre, spread = float(exact_y.mean()), float(exact_y.std()) or 1.0
        y = (logarithms - centre) / spread
        sample = Observations(np.column_stack([-np.ones(y.size), y]), kinds)
        d, g = maximise(sample, weights[regular], np.array([0.0, 1.0])).T
        mean[regular] = centre + spread * d / g
        scatter[regular] = spread / g
    total = weights.sum(axis=1)
    return Fit(np.exp(mean), scatter * np.sqrt(total / np.maximum(total - 1, 1)))


def _holds(value: float, y: Array, kind: Kinds) -> bool:
    """Return True when a single value satisfies all bounds."""
    return bool((y[kind == OVER] <= value).all() and (y[kind == BELOW] >= value).all())


def fit_cloud(
    intensities: Array, demands: Array, kinds: Kinds, weights: Array, limit: float
) -> Fit:
    """Fit a power law of the intensity with lognormal scatter to a cloud of demands."""
    n = len(weights)
    median, scatter, slope = (np.full(n, math.nan) for _ in range(3))
    exact = kinds == EXACT
    line = np.linalg.lstsq(_powers(intensities[exact]), demands[exact])[0]
    rest = demands - _powers(intensities) @ line
    spread = float(rest[exact].std())
    is_line = spread <= _ROUNDING * max(1.0, np.abs(demands[exact]).max())
    if is_line and (rest[~exact] <= _ROUNDING).all():
        scatter[:], slope[:] = 0.0, line[1]
        median[:] = np.exp((limit - line[0]) / line[1])
        return Fit(median, scatter * 0.0, slope, scatter)
    distinct = np.array([np.unique(intensities[exact & (row > 0)]).size for row in weights])
    # three different points determine line and scatter
    regular = distinct > 2
    centre = float(intensities.mean())
    spread = spread if not is_line else 1.0
    x, y = intensities - centre, rest / spread
    sample = Observations(np.column_stack([-np.ones(x.size), -x, y]), kinds)
    d, e, g = maximise(sample, weights[regular], np.array([0.0, 0.0, 1.0])).T
    b = line[1] + spread * e / g
    a = line[0] + line[1] * centre + spread * d / g
    total = weights[regular].sum(axis=1)
    sigma = spread / g * np.sqrt(total / (total - 2))
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        median[regular] = np.where(b > _ROUNDING, np.exp(centre + (limit - a) / b), math.nan)
        slope[regular], scatter[regular] = b, sigma
        dispersion = np.where(np.isnan(median), math.nan, scatter / slope)
    return Fit(median, dispersion, slope, scatter)


def _powers(x: Array) -> Array:
    return np.column_stack([np.ones(x.size), x])
