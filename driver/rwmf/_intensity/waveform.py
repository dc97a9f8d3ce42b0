"""A ground acceleration with straight lines between its samples, integrals and extrema."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf.case import Motion
from rwmf.errors import InputError

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


_UNITS = {"g": None, "m/s2": 1.0, "cm/s2": 0.01}
# share of the Arias intensity at begin and end of the significant duration
_SIGNIFICANT = (0.05, 0.95)
# far above any acceleration; squares and their sums are still finite [m/s2]
_LARGEST = 1e100
# halvings that exhaust a double
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class Waveform:
    """Accelerations of the ground, linear between samples and zero outside them.

    Leading axes of `a` are further motions at the same times.

    Attributes
    ----------
    t : array, shape (n,)
        Times of the samples, increasing strictly [s].
    a : array, shape (n,) or (rows, n)
        Accelerations [m/s2].
    """

    t: Array
    a: Array

    @property
    def h(self) -> Array:
        """Lengths of the steps [s], shape (n - 1,)."""
        return np.diff(self.t)

    @property
    def rows(self) -> Array:
        """Accelerations with one row per motion [m/s2]."""
        return np.atleast_2d(self.a)

    @property
    def slope(self) -> Array:
        """Slopes of the steps [m/s3], shape (rows, n - 1)."""
        return np.diff(self.rows) / self.h

    def scaled(self, factor: float) -> Waveform:
        """Return the motion times a factor."""
        return Waveform(self.t, self.a * factor)

    def velocities(self) -> Array:
        """Integrate the accelerations from rest."""
        a = self.rows
        return _accumulated(self.h * (a[:, :-1] + a[:, 1:]) / 2)

    def displacements(self) -> Array:
        """Integrate the velocities from rest, without correction of the baseline."""
        a, h = self.rows, self.h
        return _accumulated(h * self.velocities()[:, :-1] + h**2 * (2 * a[:, :-1] + a[:, 1:]) / 6)

    def peak_acceleration(self) -> Array:
        """Largest |acceleration|."""
        peak: Array = np.abs(self.rows).max(axis=1)
        return peak

    def peak_velocity(self) -> Array:
        """Largest |velocity|, between the samples as well."""
        a, v, slope = self.rows, self.velocities(), self.slope

        def value(row: Places, step: Places, tau: Array) -> Array:
            inside: Array = v[row, step] + tau * (a[row, step] + tau * slope[row, step] / 2)
            return inside

        return largest(v[:, :-1], v[:, 1:], self.h, np.abs(slope), value)

    def peak_displacement(self) -> Array:
        """Largest |displacement|, between the samples as well."""
        a, v, u, slope = self.rows, self.velocities(), self.displacements(), self.slope

        def value(row: Places, step: Places, tau: Array) -> Array:
            jerk = tau * slope[row, step] / 6
            inside: Array = u[row, step] + tau * (v[row, step] + tau * (a[row, step] / 2 + jerk))
            return inside

        bound = np.maximum(np.abs(a[:, :-1]), np.abs(a[:, 1:]))
        return largest(u[:, :-1], u[:, 1:], self.h, bound, value)

    def arias(self, g: float) -> Array:
        """Arias intensity, pi/(2 g) times the integral of the squared acceleration."""
        total: Array = math.pi / (2 * g) * self._squares().sum(axis=1)
        return total

    def _squares(self) -> Array:
        """Integrals of the squared acceleration over each step [m2/s3]."""
        a, b = self.rows[:, :-1], self.rows[:, 1:]
        squares: Array = self.h * (a * a + a * b + b * b) / 3
        return squares

    def husid(self) -> Array:
        """Share of the Arias intensity up to each sample."""
        done = _accumulated(self._squares())
        total = done[:, -1:]
        return done / np.where(total > 0, total, 1.0)

    def cumulative_absolute_velocity(self) -> Array:
        """Integral of |acceleration|; a step with a change of sign has two triangles."""
        a, b = self.rows[:, :-1], self.rows[:, 1:]
        ends = np.abs(a) + np.abs(b)
        crossed = np.where(ends > 0, (a * a + b * b) / np.where(ends > 0, ends, 1.0), 0.0)
        total: Array = (self.h * np.where(a * b < 0, crossed, ends)).sum(axis=1) / 2
        return total

    def significant_duration(self) -> Array:
        """Time between 5 % and 95 % of the Arias intensity."""
        done = _accumulated(self._squares())
        first, last = (self._reached(done, share * done[:, -1]) for share in _SIGNIFICANT)
        return np.where(done[:, -1] > 0, last - first, 0.0)

    def _reached(self, done: Array, wanted: Array) -> Array:
        """Return the times at which the integrals of the squares reach given values."""
        rows = np.arange(len(done))
        i = np.maximum((done < wanted[:, None]).sum(axis=1), 1) - 1
        a, slope = self.rows[rows, i], self.slope[rows, i]
        low, high = np.zeros(rows.size), self.h[i]
        for _ in range(_HALVINGS):
            tau = (low + high) / 2
            part = tau * (a * a + tau * slope * (a + tau * slope / 3))
            is_below = done[rows, i] + part < wanted
            low, high = np.where(is_below, tau, low), np.where(is_below, high, tau)
        reached: Array = self.t[i] + high
        return reached


def waveform_of(motion: Motion, g: float, scale: float = 1.0) -> Waveform:
    """Convert a motion to SI units."""
    unit = _UNITS[motion.unit]
    wave = Waveform(motion.times, motion.values * (scale * (g if unit is None else unit)))
    peak = float(wave.peak_acceleration()[0])
    if peak > _LARGEST:
        raise InputError(f"{motion.name}: peak of {peak:.3g} m/s2: must be at most {_LARGEST:g}")
    return wave


def aligned(pair: tuple[Waveform, Waveform]) -> tuple[Waveform, Waveform]:
    """Give two components the same times; the shorter one ends with zeros."""
    first, second = sorted(pair, key=lambda item: item.t.size)
    n = first.t.size
    if not np.allclose(first.t, second.t[:n], rtol=0, atol=1e-4 * float(second.h.min())):
        raise InputError("pair: both components need the same times of the samples")
    x, y = (Waveform(second.t, np.pad(i.a, (0, second.t.size - i.a.size))) for i in pair)
    return x, y


def rotated(pair: tuple[Waveform, Waveform], angles: Array) -> Waveform:
    """Rotate two horizontal components."""
    x, y = pair
    return Waveform(x.t, np.outer(np.cos(angles), x.a) + np.outer(np.sin(angles), y.a))


def _accumulated(parts: Array) -> Array:
    """Sum up steps from zero, shape (rows, n)."""
    total: Array = np.cumsum(np.pad(parts, ((0, 0), (1, 0))), axis=1)
    return total
