"""Ground acceleration with straight lines between samples, and the response of oscillators to it.

Each step of an oscillator has a solution in closed form, so that all errors are those of
round-off::

    u'' + 2 xi omega u' + omega^2 u = -(a + slope tau)
    u = alpha + beta tau + exp(-xi omega tau) (C cos(omega_d tau) + D sin(omega_d tau))
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf.case import Motion
from rwmf.errors import InputError
from rwmf.kernel.numbers import Array

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
        return np.asarray(np.abs(self.rows).max(axis=1))

    def peak_velocity(self) -> Array:
        """Largest |velocity|, between the samples as well."""
        a, v, slope = self.rows, self.velocities(), self.slope

        def value(row: Places, step: Places, tau: Array) -> Array:
            return v[row, step] + tau * (a[row, step] + tau * slope[row, step] / 2)

        return largest(v[:, :-1], v[:, 1:], self.h, np.abs(slope), value)

    def peak_displacement(self) -> Array:
        """Largest |displacement|, between the samples as well."""
        a, v, u, slope = self.rows, self.velocities(), self.displacements(), self.slope

        def value(row: Places, step: Places, tau: Array) -> Array:
            jerk = tau * slope[row, step] / 6
            return u[row, step] + tau * (v[row, step] + tau * (a[row, step] / 2 + jerk))

        bound = np.maximum(np.abs(a[:, :-1]), np.abs(a[:, 1:]))
        return largest(u[:, :-1], u[:, 1:], self.h, bound, value)

    def arias(self, g: float) -> Array:
        """Arias intensity, pi/(2 g) times the integral of the squared acceleration."""
        return np.asarray(math.pi / (2 * g) * self._squares().sum(axis=1))

    def _squares(self) -> Array:
        """Integrals of the squared acceleration over each step [m2/s3]."""
        a, b = self.rows[:, :-1], self.rows[:, 1:]
        return self.h * (a * a + a * b + b * b) / 3

    def husid(self) -> Array:
        """Share of the Arias intensity up to each sample."""
        done = _accumulated(self._squares())
        total = done[:, -1:]
        return done / np.where(total > 0, total, 1.0)

    def cav(self) -> Array:
        """Integral of |acceleration|; a step with a change of sign has two triangles."""
        a, b = self.rows[:, :-1], self.rows[:, 1:]
        ends = np.abs(a) + np.abs(b)
        crossed = np.where(ends > 0, (a * a + b * b) / np.where(ends > 0, ends, 1.0), 0.0)
        return np.asarray((self.h * np.where(a * b < 0, crossed, ends)).sum(axis=1) / 2)

    def duration_5_95(self) -> Array:
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
        return np.asarray(self.t[i] + high)


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
    return np.cumsum(np.pad(parts, ((0, 0), (1, 0))), axis=1)


# numbers of one array; longer lists of periods are computed in parts
_PART = 400_000
# angles that bound the smallest rotated response from below
_COARSE = 180


@dataclass(frozen=True, eq=False)
class History:
    """States of oscillators at the samples of the ground motion.

    Attributes
    ----------
    omega : array, shape (rows,)
        Circular frequencies [rad/s].
    xi : float
        Damping ratio, at least 0 and below 1 [-].
    u : array, shape (rows, n)
        Relative displacements [m].
    v : array, shape (rows, n)
        Relative velocities [m/s].
    """

    omega: Array
    xi: float
    u: Array
    v: Array


def histories(wave: Waveform, periods: Array, xi: float) -> History:
    """Compute the states of oscillators that start from rest.

    The recurrence runs in blocks of about sqrt(n) steps at once; each starts from zero and then
    gets the state at its begin.
    """
    omega = 2 * math.pi / periods
    h, place = np.unique(wave.h, return_inverse=True)
    k, m = place.size, omega.size
    length = math.isqrt(k - 1) + 1
    blocks = -(-k // length)
    # transition of each step, as (place in the block, block, row); the last block is padded
    order = np.pad(place, (0, blocks * length - k)).reshape(blocks, length).T
    transition = _transition(omega, xi, h)[:, :, order.ravel()].reshape(4, m, length, blocks)
    a = np.pad(wave.rows[0], (0, blocks * length + 1 - wave.t.size))
    slope = np.pad(wave.slope[0], (0, blocks * length - k))
    forced = _forced(
        omega, xi, transition, _blocked(a[:-1], length), _blocked(slope, length), h[order]
    )
    whole = np.empty((6, length, m, blocks))
    now = np.zeros((6, m, blocks))
    now[0] = now[3] = 1.0
    for j in range(length):
        uu, uv, vu, vv = transition[:, :, j]
        top, bottom = now[[0, 1, 4]], now[[2, 3, 5]]
        now = np.empty_like(now)
        now[[0, 1, 4]] = uu * top + uv * bottom
        now[[2, 3, 5]] = vu * top + vv * bottom
        now[4] += forced[0][:, j]
        now[5] += forced[1][:, j]
        whole[:, j] = now
    begin = np.zeros((2, m, blocks))
    for i in range(1, blocks):
        uu, uv, vu, vv, u, v = whole[:, -1, :, i - 1]
        begin[0, :, i] = uu * begin[0, :, i - 1] + uv * begin[1, :, i - 1] + u
        begin[1, :, i] = vu * begin[0, :, i - 1] + vv * begin[1, :, i - 1] + v
    uu, uv, vu, vv, u, v = whole
    states = (uu * begin[0] + uv * begin[1] + u, vu * begin[0] + vv * begin[1] + v)
    u, v = (item.transpose(1, 2, 0).reshape(m, -1)[:, :k] for item in states)
    return History(omega, xi, np.pad(u, ((0, 0), (1, 0))), np.pad(v, ((0, 0), (1, 0))))


def _blocked(values: Array, length: int) -> Array:
    """Arrange steps as (place in the block, block)."""
    return values.reshape(-1, length).T


def _transition(omega: Array, xi: float, h: Array) -> Array:
    """Return the matrices of free vibration, shape (4, rows, steps): uu, uv, vu, vv."""
    w = omega[:, None]
    omega_d = w * math.sqrt(1 - xi * xi)
    decay = np.exp(-xi * w * h)
    c, s = decay * np.cos(omega_d * h), decay * np.sin(omega_d * h) / omega_d
    return np.stack([c + xi * w * s, s, -w * w * s, c - xi * w * s])


def _forced(
    omega: Array, xi: float, transition: Array, a: Array, slope: Array, h: Array
) -> tuple[Array, Array]:
    """Return the state at the end of each step that begins at rest."""
    uu, uv, vu, vv = transition
    w = omega[:, None, None]
    alpha, beta = _steady(w, xi, a, slope)
    return alpha + beta * h - uu * alpha - uv * beta, beta - vu * alpha - vv * beta


def _steady(w: Array, xi: float, a: Array, slope: Array) -> tuple[Array, Array]:
    """Return offset and slope of the steady part of the response."""
    return (2 * xi * slope / w - a) / w**2, -slope / w**2


def _largest_displacements(wave: Waveform, history: History) -> Array:
    """Find the largest |u| during the motion and in the free vibration behind it."""
    during = _Steps(
        history.omega[:, None],
        history.xi,
        history.u[:, :-1],
        history.v[:, :-1],
        history.u[:, 1:],
        wave.rows[:, :-1],
        wave.slope,
        wave.h,
    )
    return np.maximum(during.largest(), _free(history).largest())


def _free(history: History) -> _Steps:
    """Return the free vibration behind the motion, whose largest value comes within a period."""
    w = history.omega[:, None]
    u, v, zero = history.u[:, -1:], history.v[:, -1:], np.zeros_like(w)
    return _Steps(w, history.xi, u, v, u, zero, zero, 2 * math.pi / w)


@dataclass(frozen=True, eq=False)
class _Steps:
    """Steps of oscillators from given states: arrays of shape (rows, steps) or (1, steps).

    The shape of `w` is (rows, 1), that of `h` (steps,) or (rows, 1). `u` and `v` are the states at
    the begin, `end` is the displacement at the end. `a` and `slope` give the ground acceleration.
    """

    w: Array
    xi: float
    u: Array
    v: Array
    end: Array
    a: Array
    slope: Array
    h: Array

    def largest(self) -> Array:
        """Largest |u| of each row."""
        w, xi = self.w, self.xi
        omega_d = w * math.sqrt(1 - xi * xi)
        alpha, beta = _steady(w, xi, self.a, self.slope)
        c = self.u - alpha
        d = (self.v - beta + xi * w * c) / omega_d

        def value(row: Places, step: Places, tau: Array) -> Array:
            angle = omega_d[row, 0] * tau
            free = c[row, step] * np.cos(angle) + d[row, step] * np.sin(angle)
            steady = alpha[row, step] + beta[row, step] * tau
            return np.asarray(steady + free * np.exp(-xi * w[row, 0] * tau))

        return largest(self.u, self.end, self.h, w**2 * np.hypot(c, d), value)


def pseudo_accelerations(wave: Waveform, periods: Array, xi: float) -> Array:
    """Compute a response spectrum."""
    rows = max(1, _PART // wave.t.size)
    found = []
    for first in range(0, periods.size, rows):
        part = periods[first : first + rows]
        history = histories(wave, part, xi)
        found.append(history.omega**2 * _largest_displacements(wave, history))
    return np.concatenate(found)


def rotated_pseudo_accelerations(
    pair: tuple[Waveform, Waveform], period: float, xi: float, angles: Array
) -> Array:
    """Compute the pseudo-acceleration of a pair at many angles."""
    x, y = (histories(item, np.array([period]), xi) for item in pair)
    omega = np.full((angles.size, 1), x.omega[0])

    def turn(first: Array, second: Array) -> Array:
        return np.asarray(np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second))

    # the largest value at any angle is at least that at the samples; no other step matters
    coarse = np.abs(turn(x.u[0], y.u[0])[:: max(1, angles.size // _COARSE)])
    radius = np.hypot(x.u[0], y.u[0])
    floor = coarse.max(axis=1).min() - radius.max() * math.pi / min(_COARSE, angles.size)
    h = pair[0].h
    gains = [
        _curvature(item, history) * h**2 / 8 for item, history in zip(pair, (x, y), strict=True)
    ]
    bound = np.maximum(radius[:-1], radius[1:]) + np.hypot(*gains)
    at = np.flatnonzero(bound >= floor)
    steps = _Steps(
        omega,
        xi,
        turn(x.u[0][at], y.u[0][at]),
        turn(x.v[0][at], y.v[0][at]),
        turn(x.u[0][at + 1], y.u[0][at + 1]),
        turn(pair[0].rows[0][at], pair[1].rows[0][at]),
        turn(pair[0].slope[0][at], pair[1].slope[0][at]),
        h[at],
    )
    ends = [turn(getattr(x, name)[0][-1:], getattr(y, name)[0][-1:]) for name in ("u", "v")]
    free = _free(History(omega[:, 0], xi, *ends))
    return omega[:, 0] ** 2 * np.maximum(steps.largest(), free.largest())


def _curvature(wave: Waveform, history: History) -> Array:
    """Bound on |u''| in each step of one oscillator [m/s2]."""
    w, xi = history.omega[0], history.xi
    alpha, beta = _steady(w, xi, wave.rows[0][:-1], wave.slope[0])
    c = history.u[0][:-1] - alpha
    d = (history.v[0][:-1] - beta + xi * w * c) / (w * math.sqrt(1 - xi * xi))
    return np.asarray(w**2 * np.hypot(c, d))
