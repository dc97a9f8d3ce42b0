"""Normal and lognormal distributions of arrays, without SciPy."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["exceedance", "log_normal_cdf", "normal_cdf", "normal_density"]

Array = npt.NDArray[np.float64]

_erfc = np.frompyfunc(math.erfc, 1, 1)
_ROOT_2 = math.sqrt(2.0)
_ROOT_2_PI = math.sqrt(2.0 * math.pi)
# below this argument erfc loses digits, then underflows
_FAR = -30.0


def normal_cdf(x: npt.ArrayLike) -> Array:
    """Compute the standard normal distribution function."""
    return 0.5 * np.asarray(_erfc(-np.asarray(x, dtype=float) / _ROOT_2), dtype=float)


def normal_density(x: Array) -> Array:
    """Compute the standard normal density."""
    return np.asarray(np.exp(-0.5 * x**2) / _ROOT_2_PI)


def log_normal_cdf(x: Array) -> tuple[Array, Array]:
    """Compute the logarithm of the standard normal distribution function, and its derivative."""
    near = np.maximum(x, _FAR)
    p = normal_cdf(near)
    value, slope = np.log(p), normal_density(near) / p
    far = np.minimum(x, _FAR)
    series = 1 - 1 / far**2 + 3 / far**4 - 15 / far**6
    tail = -0.5 * far**2 - np.log(-far * _ROOT_2_PI) + np.log(series)
    is_far = x < _FAR
    return np.where(is_far, tail, value), np.where(is_far, -far / series, slope)


def exceedance(intensity: npt.ArrayLike, median: npt.ArrayLike, dispersion: npt.ArrayLike) -> Array:
    """Compute the probability that a lognormal capacity is exceeded."""
    x, median, dispersion = (np.asarray(a, dtype=float) for a in (intensity, median, dispersion))
    with np.errstate(divide="ignore", invalid="ignore"):
        argument = np.log(x / median) / dispersion
    return np.where(dispersion > 0, normal_cdf(np.nan_to_num(argument, nan=0.0)), x > median) * 1.0
