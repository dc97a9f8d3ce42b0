"""Lognormal fits to counts, capacities and clouds of demands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import erfcx, log_ndtr, ndtr

Array = npt.NDArray[np.float64]


def exceedance(intensity: npt.ArrayLike, median: npt.ArrayLike, dispersion: npt.ArrayLike) -> Array:
    """Compute the probability that a lognormal capacity is exceeded."""
    x, median, dispersion = (np.asarray(a, dtype=float) for a in (intensity, median, dispersion))
    with np.errstate(divide="ignore", invalid="ignore"):
        argument = np.log(x / median) / dispersion
    return np.where(dispersion > 0, ndtr(np.nan_to_num(argument, nan=0.0)), x > median) * 1.0


# kinds of observations: of the value itself, of a value above, of a value below
EXACT, OVER, BELOW = 0, -1, 1
_ITERATIONS = 200
_CONVERGED = 1e-13
_HALVINGS = 40


@dataclass(frozen=True)
class Observations:
    """Observations of standard normal variables z = coefficients @ parameters.

    Attributes
    ----------
    coefficients : numpy.ndarray, shape (n, p)
        Linear map from the parameters to z. Where observations are exact, the last parameter is
        the inverse standard deviation.
    kinds : numpy.ndarray of int, shape (n,)
        ``EXACT`` (density of z), ``BELOW`` (probability up to z) or ``OVER`` (above z).
    """

    coefficients: Array
    kinds: npt.NDArray[np.int64]

    def value(self, weights: Array, parameters: Array) -> tuple[Array, Array, Array]:
        """Compute log-likelihoods with gradient and Hessian."""
        p = parameters.shape[1]
        z = parameters @ self.coefficients.T
        exact = self.kinds == EXACT
        value, slope, curvature = -0.5 * z**2, -z, -np.ones_like(z)
        sign = self.kinds[~exact]
        if sign.size:
            argument = sign * z[:, ~exact]
            # density over distribution function
            hazard = math.sqrt(2 / math.pi) / erfcx(-argument / math.sqrt(2))
            value[:, ~exact] = log_ndtr(argument)
            slope[:, ~exact] = sign * hazard
            curvature[:, ~exact] = -hazard * (argument + hazard)
        total = np.sum(weights * value, axis=1)
        gradient = (weights * slope) @ self.coefficients
        squares = np.einsum("np,nq->npq", self.coefficients, self.coefficients).reshape(
            len(z.T), -1
        )
        hessian = ((weights * curvature) @ squares).reshape(-1, p, p)
        if exact.any():
            n = weights[:, exact].sum(axis=1)
            scale = parameters[:, -1]
            with np.errstate(invalid="ignore", divide="ignore"):
                total = np.where(scale > 0, total + n * np.log(scale), -np.inf)
            gradient[:, -1] += n / scale
            hessian[:, -1, -1] -= n / scale**2
        return total, gradient, hessian


def maximise(observations: Observations, weights: Array, start: Array) -> Array:
    """Find the parameters of maximum likelihood of every resample."""
    found = np.tile(start.astype(float), (len(weights), 1))
    value, gradient, hessian = observations.value(weights, found)
    active = np.arange(len(weights))
    for _ in range(_ITERATIONS):
        # pseudo-inverse: a resample may leave one direction undetermined
        inverse = np.linalg.pinv(hessian, rcond=1e-14, hermitian=True)
        step = -np.einsum("bpq,bq->bp", inverse, gradient)
        for _ in range(_HALVINGS):
            trial = found[active] + step
            new = observations.value(weights[active], trial)
            worse = ~(new[0] >= value - 1e-13 * np.abs(value))
            if not worse.any():
                break
            step[worse] *= 0.5
        found[active] = trial
        size = np.abs(step).max(axis=1) / np.abs(trial).max(axis=1)
        kept = size > _CONVERGED
        active = active[kept]
        if not active.size:
            break
        value, gradient, hessian = (part[kept] for part in new)
    return found


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

    def __getitem__(self, part: slice) -> Fit:
        """Return the fits of some resamples."""
        optional = (None if item is None else item[part] for item in (self.slope, self.scatter))
        return Fit(self.median[part], self.dispersion[part], *optional)


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
        elif (
            np.ptp(exact) <= _ROUNDING * max(1.0, np.abs(exact).max())
            and (y[kind == OVER] <= exact[0]).all()
            and (y[kind == BELOW] >= exact[0]).all()
        ):
            # one value satisfies all bounds
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
