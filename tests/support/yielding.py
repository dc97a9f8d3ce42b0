"""Linear and elastic-plastic oscillators under piecewise linear acceleration, solved exactly.

u'' + 2 xi w u' + f = -a(t), where f = w^2 (u - p) between the yield forces and f = +-w^2 u_y beyond
them (perfectly plastic; in the linear one u_y is infinite). Within a branch and an interval the
system is linear: the state follows from a matrix exponential, the ends of a branch are roots.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

_PARTS = 8


def slowly_unloaded(
    u: float, z: float, u_y: float, hardening: float, beta: float, exponent: float
) -> float:
    """Displacement [m] at which Bouc and Wen's force is gone after a slow motion back.

    Parameters
    ----------
    u, z : float
        Displacement [m] and hysteretic state [-] where it begins.
    u_y, hardening, beta, exponent : float
        The law: `&yielding`.
    """

    def force(_way: float, y: np.ndarray) -> float:
        return hardening * float(y[0]) + (1 - hardening) * u_y * float(y[1])

    force.terminal = True
    direction = -math.copysign(1, force(0, np.array([u, z])))

    def rates(_way: float, y: np.ndarray) -> list[float]:
        lost = abs(y[1]) ** exponent * (1 - beta + math.copysign(beta, direction * y[1]))
        return [direction, direction / u_y * (1 - lost)]

    path = solve_ivp(
        rates, (0, 10 * abs(u) + 10 * u_y), [u, z], events=force, rtol=1e-11, atol=1e-14,
        max_step=u_y / 100,
    )  # fmt: skip
    return float(path.y_events[0][0][0])


def exact_yielding(
    T_s: float, xi: float, u_y: float, t: np.ndarray, a: np.ndarray
) -> tuple[float, float]:
    """Largest |u| and plastic displacement at the end [m].

    Parameters
    ----------
    T_s, xi : float
        Period [s] and damping ratio [-].
    u_y : float
        Displacement at first yield [m].
    t, a : numpy.ndarray
        Times [s] and ground acceleration [m/s2], linear between them.

    Returns
    -------
    tuple of float
        Supremum of |u|, between the samples too, and u - f/w^2 at the end.
    """
    oscillator = _Oscillator(T_s, xi, u_y)
    oscillator.follow(t, a)
    return oscillator.largest, oscillator.plastic()


def exact_peak(T_s: float, xi: float, t: np.ndarray, a: np.ndarray, e: float = 1.0) -> float:
    """Largest |u| of the linear oscillator [m].

    Parameters
    ----------
    T_s, xi : float
        Period [s] and damping ratio [-].
    t, a : numpy.ndarray
        Times [s] and ground acceleration [m/s2], linear between them.
    e : float
        Velocity factor at u = 0.

    Returns
    -------
    float
        Supremum of |u|, between the samples too.
    """
    oscillator = _Oscillator(T_s, xi, math.inf, e)
    oscillator.follow(t, a)
    return oscillator.largest


class _Oscillator:
    """State, branch (0 elastic, +-1 yielding) and plastic displacement p of the elastic branch."""

    def __init__(self, T_s: float, xi: float, u_y: float, e: float = 1.0) -> None:
        w = 2 * math.pi / T_s
        self.k, self.c, self.u_y, self.e = w**2, 2 * xi * w, u_y, e
        self.u = np.zeros(2)
        self.branch, self.p, self.largest = 0, 0.0, 0.0
        self.flows: dict[tuple[bool, float], np.ndarray] = {}

    def plastic(self) -> float:
        """Displacement without force."""
        return self.u[0] - self.branch * self.u_y if self.branch else self.p

    def follow(self, t: np.ndarray, a: np.ndarray) -> None:
        for i in range(t.size - 1):
            self._pass(a[i], (a[i + 1] - a[i]) / (t[i + 1] - t[i]), t[i + 1] - t[i])

    def _pass(self, a: float, slope: float, length: float) -> None:
        left = length
        while left > 0:
            spent = self._piece(a, slope, left)
            a, left = a + slope * spent, left - spent

    def _piece(self, a: float, slope: float, length: float) -> float:
        """Go on to the end of the interval or of the branch; return the time that it took."""
        force = self.k * self.u_y * self.branch if self.branch else -self.k * self.p
        state = np.array([*self.u, a, slope, force])
        step = length / _PARTS
        flow = self._flow(step)
        for j in range(_PARTS):
            after = flow @ state
            end = self._end(state, after, step)
            if end is not None:
                self._go_to(self._at(state, end))
                self._change()
                return j * step + end
            if state[1] * after[1] < 0:
                top = brentq(lambda s, y=state: self._at(y, s)[1], 0, step, xtol=1e-16)
                self._go_to(self._at(state, top))
            self._go_to(after)
            state = after
        return length

    def _end(self, state: np.ndarray, after: np.ndarray, step: float) -> float | None:
        """Time within a part at which the branch ends, or the velocity jumps."""
        if self.e < 1 and state[0] * after[0] < 0:
            return float(brentq(lambda s: self._at(state, s)[0], 0, step, xtol=1e-16))
        if math.isinf(self.u_y):
            return None
        if self.branch:
            if self.branch * after[1] >= 0:
                return None
            if self.branch * state[1] <= 0:
                return 0.0
            return float(brentq(lambda s: self._at(state, s)[1], 0, step, xtol=1e-16))
        for sign in (1, -1):
            level = self.p + sign * self.u_y
            stop, last = step, after
            if state[1] * after[1] < 0:
                # the displacement is monotone up to its peak only
                stop = float(brentq(lambda s: self._at(state, s)[1], 0, step, xtol=1e-16))
                last = self._at(state, stop)
            for begin, first, end, final in ((0.0, state, stop, last), (stop, last, step, after)):
                if sign * (final[0] - level) <= 1e-15 or sign * (final[0] - first[0]) <= 0:
                    continue
                if sign * (first[0] - level) >= 0:
                    return begin
                return float(
                    brentq(lambda s, x=level: self._at(state, s)[0] - x, begin, end, xtol=1e-16)
                )
        return None

    def _change(self) -> None:
        if self.e < 1:
            self.u = np.array([0.0, self.e * self.u[1]])
        elif self.branch:
            self.p, self.branch = self.u[0] - self.branch * self.u_y, 0
        else:
            self.branch = 1 if self.u[0] > self.p else -1

    def _go_to(self, state: np.ndarray) -> None:
        self.u = state[:2].copy()
        self.largest = max(self.largest, abs(float(self.u[0])))

    def _matrix(self) -> np.ndarray:
        k = 0.0 if self.branch else self.k
        matrix = np.zeros((5, 5))
        matrix[0, 1] = 1
        matrix[1] = [-k, -self.c, -1, 0, -1]
        matrix[2, 3] = 1
        return matrix

    def _at(self, state: np.ndarray, t: float) -> np.ndarray:
        return expm(self._matrix() * t) @ state

    def _flow(self, step: float) -> np.ndarray:
        key = (self.branch != 0, round(step, 12))
        if key not in self.flows:
            self.flows[key] = expm(self._matrix() * key[1])
        return self.flows[key]
