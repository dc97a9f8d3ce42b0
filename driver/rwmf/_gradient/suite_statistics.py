"""Statistics over the records of a suite, and their scatter over resampled suites."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

from rwmf._numbers import float_of, show
from rwmf.errors import InputError

__all__ = ["Statistic", "SuiteStatistic"]

Array = npt.NDArray[np.float64]
Statistic = float | Callable[[Array], float]
# resampled suites, with a fixed seed so that results repeat
_SUITES, _SEED = 200, 1963


class SuiteStatistic:
    """A statistic over dimensions of the scenes, of which the first are the records."""

    def __init__(self, statistic: Statistic, axes: tuple[int, ...], sizes: tuple[int, ...]) -> None:
        share = float_of(statistic)
        if not callable(statistic) and not (share is not None and 0 <= share <= 1):
            wanted = "a share in [0, 1] or a function of an array"
            raise InputError(f"statistic = {show(statistic)}: must be {wanted}")
        self._statistic = statistic
        self._axes, self._sizes = axes, sizes

    def of(self, values: Array) -> Array:
        """Compute the statistic."""
        return self._reduce(self._records_first(values))

    def first(self, values: Array) -> Array:
        """Return the values of the first record."""
        known = self._records_first(values)
        found: Array = known[(0,) * len(self._axes)]
        return found

    def of_resampled(self, values: Array) -> Iterator[Array]:
        """Compute the statistic of suites drawn with replacement."""
        known = self._records_first(values)
        random = np.random.default_rng(_SEED)
        for _ in range(_SUITES):
            yield self._reduce(known[random.integers(0, len(known), len(known))])

    def _records_first(self, values: Array) -> Array:
        """Return the values over the dimensions of the statistic, cells, and the others."""
        shaped = values.reshape((*self._sizes, *values.shape[1:]))
        n = len(self._axes)
        moved = np.moveaxis(shaped, self._axes, range(n))
        return moved.reshape((*moved.shape[:n], -1, *values.shape[1:]))

    def _reduce(self, values: Array) -> Array:
        n = len(self._axes)
        shape = values.shape[n:]
        if callable(self._statistic):
            columns = np.moveaxis(values.reshape((*values.shape[:n], -1)), -1, 0)
            # lanes that were not run have no statistic
            found = [
                math.nan if np.isnan(column).any() else _number(self._statistic(column))
                for column in columns
            ]
            return np.array(found, dtype=float).reshape(shape)
        # by ranks; between two ranks their mean, so the median of an even suite is the usual one
        flat = values.reshape((-1, *shape))
        with np.errstate(invalid="ignore"):
            ranked = np.quantile(flat, self._statistic, axis=0, method="averaged_inverted_cdf")
        # a rank among collapses
        return np.where(np.isnan(ranked) & ~np.isnan(flat).any(axis=0), np.inf, ranked)


def _number(value: object) -> float:
    """Return the result of a user's statistic."""
    number = float_of(value)
    if number is None:
        raise InputError(f"statistic: returns {show(value)}: must be one number")
    return number
