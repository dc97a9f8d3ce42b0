"""Parts of the reference program for walls that bend: polynomials, shapes, motions, frames.

A step of the integration has Gauss nodes, of which the accelerations are Legendre series; their
integrals are displacements and velocities. Demands are sampled at Lobatto nodes. See `bending.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy.linalg import eigh
from scipy.optimize import brentq

Array = np.ndarray
Groups = dict[str, dict[str, Any]]
NODES = 20  # of a step
ANGLE = 5.0  # of the fastest vibration in a step [rad]
TINY = 1e-300


# polynomials of a step


def basis_at(t: Array) -> tuple[Array, Array, Array]:
    """Return Legendre polynomials of [0, 1], their integrals from 0, and those of the integrals."""
    x = 2 * np.asarray(t, float) - 1
    p = legendre.legvander(x, NODES + 1)
    n = np.arange(1, NODES + 1)
    first = np.empty_like(p[:, : NODES + 1])
    first[:, 0] = t
    first[:, 1:] = (p[:, 2:] - p[:, :NODES]) / (2 * (2 * n + 1))
    second = np.empty_like(p[:, :NODES])
    second[:, 0] = t**2 / 2
    # the first integral is t = (1 + x)/2, a sum of two polynomials
    second[:, 1] = (first[:, 2] - t) / 6
    for k in range(2, NODES):
        second[:, k] = (first[:, k + 1] - first[:, k - 1]) / (2 * (2 * k + 1))
    return p[:, :NODES], first[:, :NODES], second


POINTS, WEIGHTS = np.polynomial.legendre.leggauss(NODES)
POINTS, WEIGHTS = (POINTS + 1) / 2, WEIGHTS / 2
_ODD = 2 * np.arange(NODES) + 1
TO_LEGENDRE = _ODD[:, None] * (legendre.legvander(2 * POINTS - 1, NODES - 1).T * WEIGHTS)
AT_POINTS = basis_at(POINTS)
ONCE, TWICE = AT_POINTS[1] @ TO_LEGENDRE, AT_POINTS[2] @ TO_LEGENDRE
AT_END = basis_at(np.array([1.0]))
# Lobatto points of a step, at which demands are sampled, and a fine grid on it
LOBATTO = (1 - np.cos(np.pi * np.arange(NODES + 6) / (NODES + 5))) / 2
AT_LOBATTO = basis_at(LOBATTO)
FINE = np.concatenate([[1e-9, 1e-6, 1e-4], (1 - np.cos(np.pi * np.arange(1, 61) / 60)) / 2])
AT_FINE = basis_at(FINE)
TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(2 * LOBATTO - 1, NODES + 5))
DENSE = chebyshev.chebvander(2 * FINE[2:] - 1, NODES + 5) @ TO_CHEBYSHEV
HEIGHTS = 13  # nodes of a piece of the wall
UP = (1 - np.cos(np.pi * np.arange(HEIGHTS) / (HEIGHTS - 1))) / 2
UP_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(2 * UP - 1, HEIGHTS - 1))


def _integrals_above() -> Array:
    """Return the matrix from values at the nodes of a piece to integrals up to its upper end."""
    columns = []
    for c in UP_CHEBYSHEV.T:
        whole = chebyshev.chebint(c)
        columns.append(chebyshev.chebval(1.0, whole) - chebyshev.chebval(2 * UP - 1, whole))
    return np.array(columns).T / 2


ABOVE = _integrals_above()


# shapes of the cantilever


def cantilever_roots(n: int, shear: float = 0.0) -> Array:
    """Return x = mu L of the first modes of a cantilever that bends and shears.

    With the shear flexibility s = EI/(k G A L^2), the deflection obeys
    w'''' + s K w''/L^2 - K w/L^4 = 0, K = m omega^2 L^4/EI. The characteristic roots are +-y/L
    and +-i x/L: x^2 y^2 = K, x^2 - y^2 = s K, therefore y^2 = x^2/(1 + s x^2). The conditions at
    both ends give the frequency equation:

        2 + (r^2 + 1/r^2) cosh y cos x - (r - 1/r) sinh y sin x = 0,  r = x/y.
    """

    def frequency(x: float) -> float:
        y = x / math.sqrt(1 + shear * x * x)
        r, small = x / y, math.exp(-y)
        low, high = (1 - small**2) / 2, (1 + small**2) / 2
        return (2 * small + (r * r + 1 / r**2) * high * math.cos(x)
                - (r - 1 / r) * low * math.sin(x))  # fmt: skip

    roots: list[float] = []
    x, step = 0.3, 0.02
    while len(roots) < n:
        if frequency(x) * frequency(x + step) < 0:
            roots.append(float(brentq(frequency, x, x + step, xtol=1e-15, rtol=1e-15)))
        x += step
    return np.array(roots)


class Shapes:
    """Modes of the cantilever of length L, 1 at the tip, with scaled exponentials."""

    def __init__(self, n: int, length: float, shear: float = 0.0) -> None:
        self.n, self.length = n, length
        self.x = cantilever_roots(n, shear)
        self.y = self.x / np.sqrt(1 + shear * self.x**2)
        self.squares = self.x**2 * self.y**2  # over EI/(m L^4)
        self.tip = np.ones(n)
        self.tip = self(np.array([length]))[0]
        z, weight = self.rule()
        phi = self(z)
        self.mass = weight @ phi**2 / length  # m_i over m_w
        self.area = weight @ phi / length  # A_i
        self.arm = (weight * z) @ phi / length  # S_i

    def __call__(self, z: Array) -> Array:
        """Return the deflections at heights, a column per mode.

        The rotation of the section, with x and y times z/L, is

            c_1 (cosh y - cos x) + c_2 (sinh y + (y/x)^3 sin x).

        Its third derivative is the deflection, up to a factor. c_1 and c_2 follow
        from the moment at the tip. The growing exponential has its own small coefficient.
        """
        x, y, share = self.x, self.y, np.asarray(z)[:, None] / self.length
        small, ratio = np.exp(-y), y / x
        # moments of both parts at the tip, over exp(y)/2: one = y sinh + x sin, two is alike
        one = y * (1 - small**2) + 2 * small * x * np.sin(x)
        two = y * (1 + small**2) + 2 * small * y * ratio**2 * np.cos(x)
        # (two - one), without the cancellation of sinh and cosh
        left = small * (2 * y * small + 2 * y * ratio**2 * np.cos(x) - 2 * x * np.sin(x))
        grows = left / two * np.exp(y * share) / 2
        falls = -(one + two) / two * np.exp(-y * share) / 2
        wave = -np.sin(x * share) * (x / y) ** 3 + one / two * np.cos(x * share)
        return (grows + falls + wave) / self.tip

    def rule(self) -> tuple[Array, Array]:
        """Return nodes and weights that integrate products of shapes over the height."""
        points, weights = np.polynomial.legendre.leggauss(20)
        ends = np.linspace(0, self.length, 2 + int(self.x[-1]))
        width = np.diff(ends)
        z = ends[:-1, None] + width[:, None] * (points + 1) / 2
        return z.ravel(), (width[:, None] / 2 * weights).ravel()


# ground motion


@dataclass
class Ground:
    """Ground acceleration: smooth between its knots, with one-sided values at them.

    Attributes
    ----------
    knots : list of float
        Times between which the motion is smooth [s].
    pieces : list of callable
        Acceleration between a knot and the next [m/s2]; zero outside all knots.
    period : float
        Shortest period of a piece [s].
    """

    knots: list[float]
    pieces: list[Callable[[Array], Array]]
    period: float = math.inf

    @classmethod
    def lines(cls, times: Sequence[float], values: Sequence[float]) -> Ground:
        """Return straight lines between samples [s], [m/s2]."""

        def line(i: int) -> Callable[[Array], Array]:
            slope = (values[i + 1] - values[i]) / (times[i + 1] - times[i])
            return lambda t: values[i] + slope * (t - times[i])

        return cls(list(times), [line(i) for i in range(len(times) - 1)])

    @classmethod
    def pulse(cls, motion: dict[str, Any], g: float) -> Ground:
        """Return the pulse of `&motion`: one_sine, one_cosine, sine or ricker."""
        kind, begin = motion["kind"], motion.get("t_0", 0.0)
        if kind == "none":
            return cls([], [])
        period = motion.get("T_p") or 2 * math.pi / motion["omega_p"]
        omega = 2 * math.pi / period
        if "v_p" in motion:
            peak = motion["v_p"] * omega * (1.0 if kind == "one_cosine" else 0.5)
        else:
            peak = motion["a_max_g"] * g
        peak *= motion.get("scale", 1.0)
        if kind == "ricker":
            middle = begin + 2.1 * period
            knots = [begin + 2.1 * period * i / 8 for i in range(17)]

            def ricker(t: Array) -> Array:
                x = (np.pi * (t - middle) / period) ** 2
                return peak * (1 - 2 * x) * np.exp(-x)

            return cls(knots, [ricker] * 16, period / 4)
        wave = np.cos if kind == "one_cosine" else np.sin
        end = begin + period * (motion.get("cycles", 1.0) if kind == "sine" else 1.0)
        return cls([begin, end], [lambda t: peak * wave(omega * (t - begin))], period)

    def between(self, t: float, later: float) -> Callable[[Array], Array]:
        """Return the motion in an interval without a knot."""
        middle = (t + later) / 2
        i = int(np.searchsorted(self.knots, middle)) - 1
        if 0 <= i < len(self.pieces):
            return self.pieces[i]
        return lambda t: 0.0 * np.asarray(t, float)


# the wall and its frame


@dataclass
class Fuse:
    """A bilinear spring under a corner or of a storey: force over m_w."""

    k: float
    force_y: float
    ratio: float
    p: float = 0.0
    on: int = 0  # direction in which it yields

    def force(self, x: Array) -> Array:
        """Return the force at an elongation."""
        if self.on:
            return self.on * self.force_y * (1 - self.ratio) + self.ratio * self.k * x
        return self.k * (x - self.p)

    def turn(self, x: float) -> None:
        """Unload elastically from an elongation."""
        self.p, self.on = x - float(self.force(np.array(x))) / self.k, 0

    def limit(self, way: int) -> float:
        """Return the elongation at which it yields."""
        # k (x - p) = way F_y (1 - a) + a k x
        return self.k * self.p / (self.k * (1 - self.ratio)) + way * self.force_y / self.k

    def stored(self, x: float) -> float:
        """Return the elastic energy, that of hardening included."""
        force = float(self.force(np.array(x)))
        p = x - force / self.k
        return force**2 / (2 * self.k) + self.ratio * self.k / (1 - self.ratio) * p**2 / 2


class Frame:
    """The frame of a case: its masses, stiffnesses, and the points of the wall it is linked to.

    `u`, the displacements of its coordinates, are the free floors followed by the linked ones.
    """

    def __init__(self, groups: Groups, height: float, g: float) -> None:
        frame, storeys = groups.get("frame"), groups.get("storeys")
        self.coupling = storeys.get("coupling", "reduced") if storeys else "single"
        self.z, self.link_k = np.zeros(0), np.zeros(0)
        self.m = self.push = self.k = np.zeros(0)
        self.stiff = self.damping = self.lean = np.zeros((0, 0))
        self.free, self.storey_z, self.share = 0, np.zeros(0), np.zeros(0)
        self.heights, self.total = np.zeros(0), 0.0
        self.rows, self.springs = np.zeros((0, 0)), []
        if not frame or (not storeys and not frame.get("gamma")):
            self.coupling = "none"
            return
        gravity = groups.get("p_delta")
        lean = gravity.get("m_g_over_m_s", 1.0) * g if gravity else 0.0
        if not storeys:
            omega, m = 2 * math.pi / frame["T_s"], frame["gamma"]
            self.m = self.push = np.array([m])
            self.total = m
            self.stiff = np.array([[m * omega**2]])
            self.damping = np.array([[2 * frame["xi_s"] * omega * m]])
            self.heights = np.array([(gravity or {}).get("h_f") or height])
            self.lean = np.array([[m * lean / self.heights[0]]])
            self.z, self.k, self.share = np.array([height]), self.stiff[0], np.ones(1)
        else:
            self._storeys(storeys, frame["xi_s"], lean)
        if "yielding" in groups:
            self._yield(groups["yielding"])

    def _storeys(self, storeys: dict[str, Any], xi: float, lean: float) -> None:
        m = np.array(storeys["m_over_m_w"], float)
        self.k, heights = (np.array(storeys[x], float) for x in ("k_over_m_w", "height"))
        n = m.size
        drift = np.eye(n) - np.eye(n, k=-1)
        stiff = drift.T @ np.diag(self.k) @ drift
        weights = lean * np.cumsum(m[::-1])[::-1] / heights
        leaning = drift.T @ np.diag(weights) @ drift
        squares, modes = eigh(stiff, np.diag(m))
        momentum = m[:, None] * modes
        damping = momentum @ np.diag(2 * xi * np.sqrt(squares)) @ momentum.T
        self.heights, z = heights, np.cumsum(heights)
        self.share = np.ones(n)
        self.m, self.push, self.z, self.total = m, m, z[-1:], float(m.sum())
        self.stiff, self.damping, self.lean = stiff, damping, leaning
        if self.coupling == "reduced":
            self.share = modes[:, 0] / modes[-1, 0]
            mass = m @ self.share**2
            self.m, self.push = np.array([mass]), np.array([m @ self.share])
            self.stiff = np.array([[mass * squares[0]]])
            self.damping = np.array([[2 * xi * math.sqrt(squares[0]) * mass]])
            self.lean = np.array([[self.share @ leaning @ self.share]])
        elif self.coupling == "every_floor":
            line = z / z[-1]
            omega = math.sqrt(line @ stiff @ line / (m @ line**2))
            self.z, self.damping = z, 2 * xi / omega * stiff
        else:
            self.free = n - 1 if self.coupling == "full" else n
        if self.coupling == "springs":
            self.z = z
            given = np.atleast_1d(np.array(storeys["k_link_over_m_w"], float))
            self.link_k = np.broadcast_to(given, z.shape)

    def _yield(self, yielding: dict[str, Any]) -> None:
        """Let the storeys yield; a frame that follows its roof yields as one spring."""
        if self.coupling in ("single", "reduced"):
            self.rows, k = np.ones((1, 1)), self.stiff[0]
            u_y = np.array([yielding["u_y"]])
        else:
            self.rows, k = np.eye(self.k.size) - np.eye(self.k.size, k=-1), self.k
            if "storey_u_y" in yielding:
                u_y = np.broadcast_to(np.atleast_1d(yielding["storey_u_y"]), k.shape)
            else:
                u_y = yielding["u_y"] * self.heights / self.heights.sum()
        ratio = yielding.get("hardening", 0.0)
        self.springs = [Fuse(*numbers, ratio) for numbers in zip(k, k * u_y, strict=True)]

    def pulls(self, springs: list[Fuse], d: Array) -> Array:
        """Return the forces of yielding storeys at their displacements."""
        return np.array([s.force(x) for s, x in zip(springs, d.T, strict=True)]).T

    @property
    def linked(self) -> int:
        """Number of links."""
        return int(self.z.size)

    def floors(self, u: Array) -> Array:
        """Return the displacements of all floors from those of the coordinates."""
        return u * self.share if self.coupling == "reduced" else u
