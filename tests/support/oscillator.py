"""The linear oscillator under piecewise linear acceleration, solved exactly.

u'' + 2 xi w u' + w^2 u = -a(t): in each interval the state follows from the matrix exponential of
the system that is extended by the acceleration and its slope; peaks are zeros of the velocity.
"""

import math

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq


def exact_peak(T_s: float, xi: float, t: np.ndarray, a: np.ndarray, e: float = 1.0) -> float:
    """Largest |u| [m] over the record; the velocity is multiplied by `e` at every u = 0.

    Parameters
    ----------
    T_s, xi : float
        Period [s] and damping ratio [-].
    t, a : numpy.ndarray
        Times [s] on a uniform grid and ground acceleration [m/s2].
    e : float
        Velocity factor at u = 0.

    Returns
    -------
    float
        Supremum of |u|, between the samples too.
    """
    system = _System(T_s, xi)
    state = np.zeros(2)
    largest = 0.0
    for i in range(t.size - 1):
        left = t[i + 1] - t[i]
        slope = (a[i + 1] - a[i]) / left
        start = a[i]
        while left > 0:
            end, peak, state = system.piece(state, start, slope, left, e < 1)
            largest = max(largest, peak)
            if end < left:
                state = np.array([0.0, e * state[1]])
            start += slope * end
            left -= end
    return largest


class _System:
    """Exact flow of one oscillator."""

    def __init__(self, T_s: float, xi: float) -> None:
        w = 2 * math.pi / T_s
        self.matrix = np.array(
            [[0, 1, 0, 0], [-(w**2), -2 * xi * w, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]], dtype=float
        )
        self.flows: dict[float, np.ndarray] = {}

    def at(self, state: np.ndarray, a: float, slope: float, t: float) -> np.ndarray:
        return (expm(self.matrix * t) @ np.array([state[0], state[1], a, slope]))[:2]

    def grid(self, state: np.ndarray, a: float, slope: float, length: float) -> np.ndarray:
        """States at nine equidistant times; one matrix for all intervals of one length."""
        key = round(length, 12)
        if key not in self.flows:
            self.flows[key] = expm(self.matrix * (length / 8))
        states = [np.array([state[0], state[1], a, slope])]
        for _ in range(8):
            states.append(self.flows[key] @ states[-1])
        return np.array(states)[:, :2]

    def piece(
        self, state: np.ndarray, a: float, slope: float, length: float, stops: bool
    ) -> tuple[float, float, np.ndarray]:
        """Follow one interval to its end, or to u = 0; return time, largest |u| and state."""
        times = np.linspace(0, length, 9)
        states = self.grid(state, a, slope, length)
        peak = 0.0
        for j in range(8):
            u, v = states[j], states[j + 1]
            first = j == 0 and u[0] == 0
            if stops and not first and u[0] * v[0] < 0:
                end = self._root(0, state, a, slope, times[j], times[j + 1])
                return end, peak, self.at(state, a, slope, end)
            peak = max(peak, abs(v[0]))
            if u[1] * v[1] < 0:
                top = self._root(1, state, a, slope, times[j], times[j + 1])
                peak = max(peak, abs(self.at(state, a, slope, top)[0]))
        return length, peak, states[-1]

    def _root(
        self, k: int, state: np.ndarray, a: float, slope: float, low: float, high: float
    ) -> float:
        return float(
            brentq(lambda s: self.at(state, a, slope, s)[k], low, high, xtol=1e-15, rtol=1e-14)
        )
