"""Response of linear oscillators to ground accelerations with straight lines between samples.

Each step has a solution in closed form, so that all errors are those of round-off::

    u'' + 2 xi omega u' + omega^2 u = -(a + slope tau)
    u = alpha + beta tau + exp(-xi omega tau) (C cos(omega_d tau) + D sin(omega_d tau))
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rwmf._intensity.waveform import Array, Places, Waveform, largest

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
            inside: Array = steady + free * np.exp(-xi * w[row, 0] * tau)
            return inside

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
        both: Array = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
        return both

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
    peak: Array = omega[:, 0] ** 2 * np.maximum(steps.largest(), free.largest())
    return peak


def _curvature(wave: Waveform, history: History) -> Array:
    """Bound on |u''| in each step of one oscillator [m/s2]."""
    w, xi = history.omega[0], history.xi
    alpha, beta = _steady(w, xi, wave.rows[0][:-1], wave.slope[0])
    c = history.u[0][:-1] - alpha
    d = (history.v[0][:-1] - beta + xi * w * c) / (w * math.sqrt(1 - xi * xi))
    bound: Array = w**2 * np.hypot(c, d)
    return bound
