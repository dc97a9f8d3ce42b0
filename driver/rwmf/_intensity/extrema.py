"""Largest magnitude of smooth functions between samples, by branch and bound."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "Places", "largest"]

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.int_]

# relative gain below which an interval is no longer divided
_GAIN = 1e-14
# an interval is divided into this many parts; its possible gain falls with the square
_PARTS = 4
_FRACTIONS = np.arange(1, _PARTS) / _PARTS
# far more divisions than doubles can distinguish
_MOST_DIVISIONS = 60


def largest(
    left: Array,
    right: Array,
    widths: Array,
    curvature: Array,
    value: Callable[[Places, Places, Array], Array],
) -> Array:
    """Find the largest magnitude of each row over all steps, ends included.

    Between two points a function exceeds the larger end by at most ``curvature width^2 / 8``. Steps
    that could exceed the largest known value are divided until no such gain is left.
    """
    left, right = np.abs(left), np.abs(right)
    ends = np.maximum(left, right)
    best: Array = ends.max(axis=1)
    widths = np.broadcast_to(widths, ends.shape)
    row, step = np.nonzero(ends + curvature * widths**2 / 8 > best[:, None] * (1 + _GAIN))
    begin, width = np.zeros(row.size), widths[row, step]
    left, right = left[row, step], right[row, step]
    for _ in range(_MOST_DIVISIONS):
        if row.size == 0:
            break
        inside = begin[:, None] + width[:, None] * _FRACTIONS
        found = np.abs(value(row[:, None], step[:, None], inside))
        np.maximum.at(best, row, found.max(axis=1))
        points = np.column_stack([left, found, right])
        width = width / _PARTS
        gain = curvature[row, step] * width**2 / 8
        limit = best[row] * (1 + _GAIN)
        parts = np.maximum(points[:, :-1], points[:, 1:]) + gain[:, None] > limit[:, None]
        which, part = np.nonzero(parts)
        begin = begin[which] + part * width[which]
        left, right = points[which, part], points[which, part + 1]
        row, step, width = row[which], step[which], width[which]
    return best
