"""numba: the pair of Dormand and Prince, 5(4), as one compiled loop of our own.

This is the program of a numba user who knows the problem. Steps end at knots; a step with an impact
or a peak is repeated with a shorter length. `fastmath` and `error_model="numpy"` are those of its
manual. One thread; compilation is not timed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from peers.problem import ETA_0, ETA_ALPHA, XI, Array, E, G, Peer, Record, Solver, Wall
from peers.walk import REST

ATOL = 1e-13
# Dormand and Prince (1980), Table 2
A = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
C = A.sum(axis=1)
ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@cache
def _compiled() -> Callable[..., Any]:
    """Compile the loop over one record for one ordinate."""
    import numba

    jit = numba.njit(fastmath=True, error_model="numpy")

    @jit
    def acceleration(p: Array, ground: float, phi: float, phi_dot: float) -> float:
        alpha, sin_alpha, omega, gamma, radius, rate = p[0], p[1], p[2], p[3], p[4], p[5]
        s, c = math.sin(alpha - phi), math.cos(alpha - phi)
        frame = s * phi_dot**2 + omega * (2 * XI * c * phi_dot + omega * (sin_alpha - s))
        gravity = s + (ETA_0 + rate * phi) * sin_alpha
        force = 4 * gamma * c * frame + G / radius * gravity
        force += (2 * gamma + 1) * c * ground / radius
        return -force / (4 / 3 + 4 * gamma * c * c)

    @jit
    def step(
        p: Array, ground: float, slope: float, h: float, phi: float, v: float, k: Array
    ) -> tuple[float, float, float, float]:
        """State after h, and the estimated errors."""
        x, y = phi, v
        for i in range(7):
            x, y = phi, v
            for j in range(i):
                x += h * A[i, j] * k[j, 0]
                y += h * A[i, j] * k[j, 1]
            k[i, 0], k[i, 1] = y, acceleration(p, ground + C[i] * h * slope, x, y)
        off_x = off_y = 0.0
        for i in range(7):
            off_x += h * ERROR[i] * k[i, 0]
            off_y += h * ERROR[i] * k[i, 1]
        return x, y, off_x, off_y

    @jit
    def locate(
        p: Array, ground: float, slope: float, low: float, high: float, phi: float, v: float,
        k: Array, which: int,
    ) -> tuple[float, float, float]:  # fmt: skip
        """Length at which phi (0) or its rate (1) falls through 0, and the state there."""
        h = 0.5 * (low + high)
        x = y = 0.0
        for _ in range(60):
            x, y, _, _ = step(p, ground, slope, h, phi, v, k)
            value, rate = (x, y) if which == 0 else (y, k[6, 1])
            if value > 0:
                low = h
            else:
                high = h
            new = h - value / rate
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - h) <= 1e-15 + 4e-16 * h:
                break
            h = new
        return h, x, y

    @jit
    def peak(p: Array, threshold: float, rtol: float, t: Array, a: Array) -> float:
        """Largest |theta| from rest to the end of the record [rad]."""
        k = np.zeros((7, 2))
        phi = v = largest = 0.0
        side, rests, trial = 1.0, True, t[1] - t[0]
        for i in range(t.size - 1):
            now, slope = t[i], (a[i + 1] - a[i]) / (t[i + 1] - t[i])
            while now < t[i + 1]:
                if rests:
                    if abs(a[i + 1]) <= threshold:
                        break
                    side = -1.0 if a[i + 1] > 0 else 1.0
                    if slope != 0:
                        now = max(now, t[i] + (-side * threshold - a[i]) / slope)
                    phi, v, rests = 0.0, 0.0, False
                left = t[i + 1] - now
                h = min(trial, left)
                ground = side * (a[i] + slope * (now - t[i]))
                x, y, off_x, off_y = step(p, ground, side * slope, h, phi, v, k)
                ratio = max(
                    abs(off_x) / (ATOL + rtol * max(abs(phi), abs(x))),
                    abs(off_y) / (ATOL + rtol * max(abs(v), abs(y))),
                )
                trial = h * min(5.0, max(0.2, 0.9 * max(ratio, 1e-10) ** -0.2))
                if ratio > 1:
                    continue
                low = 0.0
                if v > 0 and y < 0:
                    low, top, _ = locate(p, ground, side * slope, 0.0, h, phi, v, k, 1)
                    largest = max(largest, top)
                largest = max(largest, x)
                if x < 0:
                    h, _, y = locate(p, ground, side * slope, low, h, phi, v, k, 0)
                    x, y, side = 0.0, -E * y, -side
                    rests = y < REST and abs(a[i] + slope * (now + h - t[i])) < threshold
                phi, v = x, y
                now = t[i + 1] if h == left else now + h
        return largest

    return peak


def _make(record: Record, gamma: float, rtol: float) -> Solver:
    peak = _compiled()

    def solve(T_s: Array) -> Array:
        found = []
        for period in T_s:
            wall = Wall(float(period), gamma)
            rate = (ETA_ALPHA - ETA_0) / wall.alpha
            p = np.array([wall.alpha, math.sin(wall.alpha), wall.omega, gamma, wall.radius, rate])
            found.append(wall.displacement(peak(p, wall.threshold, rtol, record.t, record.a)))
        return np.array(found)

    # compiles
    solve(np.array([1.0]))
    return solve


PEERS = (Peer("numba, Dormand-Prince 5(4)", 1e-7, _make, "numba"),)
