"""Rocking walls that bend, integrated by Gauss collocation without the kernel.

The equations are those of Lagrange for the rotation of the base, the modes of the cantilever and
the free floors. One step has twenty Gauss nodes; its solution is a polynomial in time, from which
impacts, lift-offs and the largest demands follow by root finding. A step that contains an event is
integrated again up to the event. Sections of the wall are in equilibrium with the mass, the links
and the tendon above them.

Masses, forces and energies are over the mass of the wall.
`python tests/support/bending.py --scenes N` prints demands of random scenes as JSON.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev, legendre
from scipy.linalg import eigh
from scipy.optimize import brentq, minimize_scalar

Array = np.ndarray
Groups = dict[str, dict[str, Any]]
NODES = 20  # of a step
ANGLE = 5.0  # of the fastest vibration in a step [rad]
_TINY = 1e-300


# polynomials of a step


def _basis(t: Array) -> tuple[Array, Array, Array]:
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


_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(NODES)
_POINTS, _WEIGHTS = (_POINTS + 1) / 2, _WEIGHTS / 2
_ODD = 2 * np.arange(NODES) + 1
_TO_LEGENDRE = (legendre.legvander(2 * _POINTS - 1, NODES - 1) * _WEIGHTS[:, None]).T * _ODD[:, None]
_P, _P1, _P2 = _basis(_POINTS)
_ONCE, _TWICE = _P1 @ _TO_LEGENDRE, _P2 @ _TO_LEGENDRE
_END = _basis(np.array([1.0]))
# Lobatto points of a step, at which demands are sampled, and a fine grid on it
_LOBATTO = (1 - np.cos(np.pi * np.arange(NODES + 6) / (NODES + 5))) / 2
_AT_LOBATTO = _basis(_LOBATTO)
_FINE = np.concatenate([[1e-9, 1e-6, 1e-4], (1 - np.cos(np.pi * np.arange(1, 61) / 60)) / 2])
_AT_FINE = _basis(_FINE)
_TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(2 * _LOBATTO - 1, NODES + 5))
_DENSE = chebyshev.chebvander(2 * _FINE[2:] - 1, NODES + 5) @ _TO_CHEBYSHEV
_CLENSHAW = 13  # nodes of a piece of the wall
_UP = (1 - np.cos(np.pi * np.arange(_CLENSHAW) / (_CLENSHAW - 1))) / 2
_UP_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(2 * _UP - 1, _CLENSHAW - 1))


def _integrals_above() -> Array:
    """Return the matrix from values at the nodes of a piece to integrals up to its upper end."""
    columns = []
    for c in _UP_CHEBYSHEV.T:
        whole = chebyshev.chebint(c)
        columns.append(chebyshev.chebval(1.0, whole) - chebyshev.chebval(2 * _UP - 1, whole))
    return np.array(columns).T / 2


_ABOVE = _integrals_above()


# shapes of the cantilever


def cantilever_roots(n: int, shear: float = 0.0) -> Array:
    """Return x = mu L of the first modes of a cantilever that bends and shears.

    With the shear flexibility s = EI/(k G A L^2), the deflection obeys
    w'''' + s K w''/L^2 - K w/L^4 = 0, K = m omega^2 L^4/EI, whose characteristic roots are +-y/L
    and +-i x/L: x^2 y^2 = K, x^2 - y^2 = s K, therefore y^2 = x^2/(1 + s x^2). The clamped end
    without rotation and the free end without moment and shear give

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

        The rotation of the section is c_1 (cosh y - cos x) + c_2 (sinh y + (y/x)^3 sin x) of the
        height over L. Its third derivative is the deflection, up to a factor; c_1 and c_2 follow
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
    """A bilinear spring under a corner: force over m_w."""

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
        return (self.k * self.p + way * self.force_y * (1 - self.ratio)) / (self.k * (1 - self.ratio))

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
        self.heights = np.zeros(0)
        if not frame or (not storeys and not frame.get("gamma")):
            self.coupling = "none"
            return
        gravity = groups.get("p_delta")
        lean = gravity.get("m_g_over_m_s", 1.0) * g if gravity else 0.0
        if not storeys:
            omega, m = 2 * math.pi / frame["T_s"], frame["gamma"]
            self.m = self.push = np.array([m])
            self.stiff = np.array([[m * omega**2]])
            self.damping = np.array([[2 * frame["xi_s"] * omega * m]])
            self.heights = np.array([(gravity or {}).get("h_f") or height])
            self.lean = np.array([[m * lean / self.heights[0]]])
            self.z, self.k, self.share = np.array([height]), self.stiff[0], np.ones(1)
            return
        self._storeys(storeys, frame["xi_s"], lean)

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
        self.m, self.push, self.z = m, m, z[-1:]
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

    @property
    def linked(self) -> int:
        """Number of links."""
        return int(self.z.size)

    def floors(self, u: Array) -> Array:
        """Return the displacements of all floors from those of the coordinates."""
        return u * self.share if self.coupling == "reduced" else u


@dataclass
class Flow:
    """Accelerations and forces at instants, a row each."""

    a: Array  # of rotation, modes, free floors
    u: Array  # coordinates of the frame
    u_t: Array
    u_tt: Array
    links: Array  # force with which each link pulls the frame along
    linked: Array  # displacement of the linked points of the wall


@dataclass
class Piece:
    """A polynomial piece of motion."""

    t: float
    h: float
    side: int
    held: bool
    x: Array
    v: Array
    coefficients: Array  # of the accelerations, Legendre
    a_g: Callable[[Array], Array]
    a_v: Callable[[Array], Array]
    fuses: list[Fuse]
    stored: dict[str, float] = field(default_factory=dict)  # integrals of powers at its begin

    def at(self, basis: tuple[Array, Array, Array], t: Array) -> tuple[Array, Array]:
        """Return displacements and velocities at shares of the piece."""
        _, once, twice = basis
        x = self.x + self.h * t[:, None] * self.v + self.h**2 * (twice @ self.coefficients)
        return x, self.v + self.h * (once @ self.coefficients)


class BentWall:
    """A scene with `&wall` and, unless the wall is rigid, `&bending`.

    Parameters
    ----------
    groups : dict
        Groups of the case; ratios over the mass of the wall.
    ground, vertical : Ground, optional
        Motions; absent: the pulse of `&motion`, and `ratio` of `&vertical`.
    """

    def __init__(
        self, groups: Groups, ground: Ground | None = None, vertical: Ground | None = None
    ) -> None:
        self.groups = groups
        wall, model = groups["wall"], groups.get("model", {})
        self.h, self.b, self.g = wall["h"], wall["b"], model.get("g", 9.81)
        self.alpha, self.length = math.atan2(self.b, self.h), 2 * self.h
        self.limit = model.get("overturning_angle", math.pi / 2)
        self.ground = ground or Ground.pulse(groups.get("motion", {"kind": "none"}), self.g)
        self.vertical, self.ratio = vertical, groups.get("vertical", {}).get("ratio", 0.0)
        knots = set(self.ground.knots) | set(vertical.knots if vertical else [])
        self.knots = sorted(knots)
        self._bending(groups.get("bending"))
        self.frame = Frame(groups, self.length, self.g)
        self.line = self.frame.z / self.length
        self.p = self.shape(self.frame.z)
        self.damper = groups.get("damper", {}).get("c_over_m_w", 0.0)
        self.inerter = groups.get("inerter", {}).get("inertance_over_m_w", 0.0)
        self.cable = groups.get("cable")
        self.fuses = self._fuses(groups.get("fuse"))
        self.size = 1 + self.n + self.frame.free
        self._sections()
        self._inverses: dict[tuple[Any, ...], Array] = {}
        self._slopes: dict[tuple[int, bool], tuple[Array, Array]] = {}

    def _bending(self, bending: dict[str, Any] | None) -> None:
        self.n = bending.get("modes", 3) if bending else 0
        self.omega = self.mass = self.area = self.arm = np.zeros(0)
        self.shape: Callable[[Array], Array] = lambda z: np.zeros((np.size(z), 0))
        self.decay = np.zeros(0)
        if not bending or not self.n:
            return
        shear = 0.0
        if "nu" in bending:
            # 5/6 E A/(2 (1 + nu)) with A/I = 3/b^2; cracking reduces I only
            shear = (1 + bending["nu"]) * self.b**2 / (5 * self.h**2)
            shear *= bending.get("cracking", 1.0)
        shapes = Shapes(self.n, self.length, shear)
        self.shape = shapes
        self.mass, self.area, self.arm = shapes.mass, shapes.area, shapes.arm
        self.omega = np.sqrt(shapes.squares * bending["EI_over_m_w"] / self.length**3)
        xi = np.full(self.n, bending.get("xi", 0.02))
        if bending.get("damping", "modal") == "stiffness":
            xi = xi * self.omega / self.omega[0]
        self.decay = 2 * xi * self.omega * self.mass

    def _fuses(self, fuse: dict[str, Any] | None) -> list[Fuse]:
        if not fuse:
            return []
        force = fuse["eta_y"] * self.g
        one = Fuse(force / fuse["stroke_y"], force, fuse.get("hardening", 0.0))
        return [one, copy.copy(one)]

    def lifting(self, fuses: list[Fuse], side: int) -> Fuse:
        """Return the fuse under the corner that lifts: the left one for a positive rotation."""
        return fuses[0 if side > 0 else 1]

    # equations of motion

    def cable_force(self, phi: Array) -> tuple[Array, Array, Array]:
        """Return the tendon force over m_w, its arm, and the stored energy beyond rest."""
        if not self.cable:
            return 0 * phi, 0 * phi, 0 * phi
        first = self.cable["eta_0"]
        last = self.cable.get("eta_alpha", first)
        if self.cable.get("law", "linear") == "linear":
            x, arm, end = self.b * phi, self.b + 0 * phi, self.b * self.alpha
        else:
            x, arm, end = self._straight(phi)
        k = (last - first) / end
        return self.g * (first + k * x), arm, self.g * (first * x + k * x**2 / 2)

    def _straight(self, phi: Array) -> tuple[Array, Array, float]:
        """Return elongation and arm of a straight cable, and its elongation at alpha."""
        h, b = self.h, self.b

        def longer(phi: Any) -> Any:  # noqa: ANN401
            gain = 4 * b**2 * np.sin(phi / 2) ** 2 + 4 * h * b * np.sin(phi)
            return gain / (np.sqrt(4 * h**2 + gain) + 2 * h)

        x = longer(phi)
        arm = (b**2 * np.sin(phi) + 2 * h * b * np.cos(phi)) / (2 * h + x)
        return x, arm, float(longer(self.alpha))

    def roof(self, theta: Array, side: int) -> tuple[Array, Array, Array]:
        """Return displacement of the left top corner of the rigid wall, and two derivatives."""
        wide, high = (1 + side) * self.b, self.length
        s, c = np.sin(theta), np.cos(theta)
        u = 2 * wide * np.sin(theta / 2) ** 2 + high * s
        return u, wide * s + high * c, wide * c - high * s

    def _jacobian(self, x: Array, v: Array, side: int) -> tuple[Array, Array, Array]:
        """Return linked displacements, their gradient by (theta, q), and what velocities add."""
        theta, n = x[:, 0], self.n
        u, slope, bend = self.roof(theta, side)
        s, c = np.sin(theta)[:, None], np.cos(theta)[:, None]
        w, w_t = x[:, 1 : 1 + n] @ self.p.T, v[:, 1 : 1 + n] @ self.p.T
        rate = v[:, :1]
        linked = u[:, None] * self.line + w * c
        d = np.empty((*linked.shape, 1 + n))
        d[..., 0] = slope[:, None] * self.line - w * s
        d[..., 1:] = self.p * c[..., None]
        extra = (bend[:, None] * self.line - w * c) * rate**2 - 2 * w_t * s * rate
        return linked, d, extra

    def inertia(self, x: Array, side: int) -> Array:
        """Return the matrix of inertia of the wall by itself, with inerters."""
        q, n = x[:, 1 : 1 + self.n], self.n
        m = np.zeros((len(x), 1 + n, 1 + n))
        turning = 4 / 3 * (self.h**2 + self.b**2) - 2 * side * self.b * (q @ self.area)
        m[:, 0, 0] = turning + q**2 @ self.mass
        m[:, 0, 0] += 4 * self.inerter * self.b**2 * np.cos(x[:, 0] / 2) ** 2
        m[:, 0, 1:] = m[:, 1:, 0] = self.arm
        m[:, range(1, 1 + n), range(1, 1 + n)] = self.mass
        return m

    def _push(
        self, x: Array, v: Array, a_g: Array, a_v: Array, side: int, fuses: list[Fuse]
    ) -> Array:
        """Return generalised forces on the wall without frame, accelerations apart."""
        n, b, h = self.n, self.b, self.h
        theta, rate = x[:, 0], v[:, 0]
        q, q_t = x[:, 1 : 1 + n], v[:, 1 : 1 + n]
        s, c, weight = np.sin(theta), np.cos(theta), self.g + a_v
        w, w_t = q @ self.area, q_t @ self.area
        f = np.empty((len(x), 1 + n))
        f[:, 0] = 2 * rate * (side * b * w_t - (q * q_t) @ self.mass)
        f[:, 0] -= weight * (side * b * c - h * s - w * c)
        f[:, 0] -= a_g * (side * b * s + h * c - w * s)
        force, arm, _ = self.cable_force(side * theta)
        f[:, 0] -= side * force * arm
        half, twice = np.cos(theta / 2), np.sin(theta)
        f[:, 0] -= 4 * self.damper * b**2 * half**2 * rate
        # d/dt of the momentum of inerters, less the derivative of their energy
        f[:, 0] += self.inerter * b**2 * twice * rate**2
        if fuses:
            pull = self.lifting(fuses, side).force(4 * b * side * np.sin(theta / 2))
            f[:, 0] -= side * 2 * b * half * pull
        f[:, 1:] = (rate**2)[:, None] * (self.mass * q - side * b * self.area)
        f[:, 1:] += (weight * s - a_g * c)[:, None] * self.area
        f[:, 1:] -= self.mass * self.omega**2 * q + self.decay * q_t
        return f

    def accelerate(
        self, x: Array, v: Array, a_g: Array, a_v: Array, side: int, fuses: list[Fuse], *,
        held: bool,
    ) -> Flow:  # fmt: skip
        """Solve the equations of motion; `held`: both corners touch."""
        frame, k = self.frame, 1 + self.n
        linked, d, extra = self._jacobian(x, v, side)
        matrix, right = self.inertia(x, side), self._push(x, v, a_g, a_v, side, fuses)
        free, free_t = x[:, k:], v[:, k:]
        is_rigid = not frame.link_k.size
        u, u_t = free, free_t
        if is_rigid:
            moved = np.einsum("tij,tj->ti", d, v[:, :k])
            u, u_t = np.hstack([free, linked]), np.hstack([free_t, moved])
        force = u @ (frame.stiff - frame.lean) + u_t @ frame.damping + a_g[:, None] * frame.push
        a = np.zeros_like(x)
        if is_rigid:
            m = frame.m[frame.free :]
            pulls = force[:, frame.free :] + m * extra
            matrix = matrix + np.einsum("tia,i,tib->tab", d, m, d)
            tension = 0 * linked
        else:
            pulls = tension = frame.link_k * (linked - free)
        right = right - np.einsum("tia,ti->ta", d, pulls)
        begin = 1 if held else 0
        if k > begin:
            part = np.linalg.solve(matrix[:, begin:, begin:], right[:, begin:, None])
            a[:, begin:k] = part[..., 0]
        pulled = -force[:, : frame.free] + (0 if is_rigid else tension)
        a[:, k:] = pulled / frame.m[: frame.free]
        u_tt, links = a[:, k:], tension
        if is_rigid:
            moved = np.einsum("tij,tj->ti", d, a[:, :k]) + extra
            u_tt = np.hstack([u_tt, moved])
            links = force[:, frame.free :] + frame.m[frame.free :] * moved
        return Flow(a, u, u_t, u_tt, links, linked)

    def landing(self, x: Array, v: Array, side: int) -> tuple[Array, int, float, bool]:
        """Return velocities after an impact, the next side, the loss, and whether it goes on.

        `side` is that before. Momenta conjugate to turning about the new corner and to the modes
        and floors do not change; the old velocities enter with the gradients about the new corner.
        """
        k, one = 1 + self.n, np.zeros((1, self.size))
        one[0] = x
        one[0, 0] = 0.0
        before, after = self._energy_matrix(one, side), self._energy_matrix(one, -side)
        mixed = after.copy()
        # (w - s b) (w + s b) in place of (w + s b)^2, and the inerter under the other corner
        w = float(x[1:k] @ self.area)
        mixed[0, 0] -= 2 * self.b**2 + 2 * side * self.b * w + 4 * self.inerter * self.b**2
        momentum = mixed @ v[:k]
        new = v.copy()
        new[:k] = np.linalg.solve(after, momentum)
        goes = new[0] * -side > 0
        if not goes:
            new[0] = 0.0
            new[1:k] = np.linalg.solve(after[1:, 1:], momentum[1:])
        loss = 0.5 * (v[:k] @ before @ v[:k] - new[:k] @ after @ new[:k])
        return new, -side, float(loss), bool(goes)

    def _energy_matrix(self, x: Array, side: int) -> Array:
        """Return inertia of the wall with what is rigidly linked to it."""
        matrix = self.inertia(x, side)[0]
        if not self.frame.link_k.size:
            _, d, _ = self._jacobian(x, 0 * x, side)
            matrix = matrix + np.einsum("ia,i,ib->ab", d[0], self.frame.m[self.frame.free :], d[0])
        return matrix

    def straight_e(self) -> float:
        """Return the factor of the angular velocity at an impact of the straight wall."""
        linked = 0.0 if self.frame.link_k.size else self.frame.m[self.frame.free :] @ self.line**2
        whole = 4 / 3 * (self.h**2 + self.b**2) + 4 * self.h**2 * linked
        own = 4 * self.inerter * self.b**2
        return 1 - (2 * self.b**2 + own) / (whole + own)

    # integration

    def _slope(self, x: Array, side: int, *, held: bool) -> tuple[Array, Array]:
        """Return derivatives of the accelerations by displacements and velocities."""
        n = self.size
        step = 1e-6
        x_all = np.repeat(x[None], 4 * n, axis=0)
        v_all = np.zeros_like(x_all)
        i = np.arange(n)
        x_all[i, i] += step
        x_all[n + i, i] -= step
        v_all[2 * n + i, i] += step
        v_all[3 * n + i, i] -= step
        zero = np.zeros(4 * n)
        a = self.accelerate(x_all, v_all, zero, zero, side, self.fuses, held=held).a
        a = a.reshape(4, n, n)
        by_x, by_v = (a[0] - a[1]).T / (2 * step), (a[2] - a[3]).T / (2 * step)
        if held:
            by_x[:, 0] = by_v[:, 0] = 0.0
        return by_x, by_v

    def _fastest(self) -> float:
        """Return the largest rate among rocking and contact about a straight wall."""
        rates = [2 * math.pi / self.ground.period, math.sqrt(self.g / self.h)]
        n = self.size
        for side, held in ((1, False), (-1, False), (1, True)):
            by_x, by_v = self._slope(np.zeros(n), side, held=held)
            whole = np.block([[np.zeros((n, n)), np.eye(n)], [by_x, by_v]])
            rates.append(float(np.abs(np.linalg.eigvals(whole)).max()))
        return max(rates)

    def _inverse(self, x: Array, side: int, h: float, *, held: bool, fresh: bool) -> Array:
        """Return the inverse of the Newton matrix of a step, kept for alike steps."""
        state = tuple(f.on for f in self.fuses)
        key = (side, held, float(f"{h:.9e}"), state)
        if fresh or (side, held, state) not in self._slopes:
            at = x if fresh else np.zeros(self.size)
            self._slopes[side, held, state] = self._slope(at, side, held=held)
            self._inverses = {k: m for k, m in self._inverses.items() if k[:2] != key[:2]}
        if key not in self._inverses:
            if len(self._inverses) > 60:
                self._inverses.clear()
            by_x, by_v = self._slopes[side, held, state]
            matrix = np.eye(NODES * self.size)
            matrix -= np.kron(h**2 * _TWICE, by_x) + np.kron(h * _ONCE, by_v)
            self._inverses[key] = np.linalg.inv(matrix)
        return self._inverses[key]

    def step(self, piece: Piece, guess: Array | None = None) -> bool:
        """Solve for the accelerations of a piece; return whether the iteration converges."""
        t, h = piece.t + piece.h * _POINTS, piece.h
        a_g, a_v = piece.a_g(t), piece.a_v(t)
        shift = piece.x + h * _POINTS[:, None] * piece.v
        a = np.zeros((NODES, self.size)) if guess is None else guess
        last, fresh = math.inf, False
        inverse = self._inverse(piece.x, piece.side, h, held=piece.held, fresh=False)
        for count in range(60):
            flow = self.accelerate(shift + h**2 * _TWICE @ a, piece.v + h * _ONCE @ a, a_g, a_v,
                                   piece.side, piece.fuses, held=piece.held)  # fmt: skip
            change = (inverse @ (flow.a - a).ravel()).reshape(a.shape)
            a = a + change
            scale = np.abs(a).max(axis=0) + 1e-5 * np.abs(a).max() + _TINY
            size = float((np.abs(change) / scale).max())
            if not math.isfinite(size):
                return False
            if size < 1e-15 or (last < 1e-6 and size > 0.2 * last):
                piece.coefficients = _TO_LEGENDRE @ a
                return True
            last = size
            if count == 14 and not fresh:
                inverse = self._inverse(piece.x, piece.side, h, held=piece.held, fresh=True)
                fresh = True
        return False

    def _end(self, piece: Piece) -> tuple[Array, Array]:
        x, v = piece.at(_END, np.ones(1))
        return x[0], v[0]

    def follow(self, t_end: float | None = None) -> Course:
        """Follow the motion up to a time, an overturning or a collapse."""
        return _Run(self, t_end or self.groups["solver"]["t_end"]).go()

    # demands

    def drive(self, piece: Piece, t: Array, x: Array, v: Array, side: int) -> Array:
        """Return the acceleration away from the base that rocking on a side would have."""
        time = piece.t + piece.h * t
        flow = self.accelerate(x, v, piece.a_g(time), piece.a_v(time), side, piece.fuses,
                               held=False)  # fmt: skip
        return side * flow.a[:, 0]

    def _floors(self, x: Array, side: int) -> Array:
        """Return the displacements of all floors."""
        linked = self._jacobian(x, 0 * x, side)[0]
        free = x[:, 1 + self.n :]
        return self.frame.floors(free if self.frame.link_k.size else np.hstack([free, linked]))

    def drifts(self, x: Array, v: Array, side: int) -> Array:
        """Return the drifts of all storeys."""
        del v
        if self.frame.coupling == "none":
            return np.zeros((len(x), 1))
        return np.diff(self._floors(x, side), prepend=0.0) / self.frame.heights

    def powers(self, piece: Piece, t: Array, basis: tuple[Array, Array, Array]) -> dict[str, Array]:
        """Return the powers of the ground and of what dissipates."""
        x, v = piece.at(basis, t)
        flow = self._flow(piece, t, x, v)
        time, n = piece.t + piece.h * t, self.n
        theta, rate, side = x[:, 0], v[:, 0], piece.side
        s, c = np.sin(theta), np.cos(theta)
        w, w_t = x[:, 1 : 1 + n] @ self.area, v[:, 1 : 1 + n] @ self.area
        across = (side * self.b * s + self.h * c - w * s) * rate + c * w_t
        rise = (side * self.b * c - self.h * s - w * c) * rate - s * w_t
        pushed = across + flow.u_t @ self.frame.push
        given = -piece.a_g(time) * pushed - piece.a_v(time) * rise
        viscous = np.einsum("ti,ij,tj->t", flow.u_t, self.frame.damping, flow.u_t)
        viscous += 4 * self.damper * self.b**2 * np.cos(theta / 2) ** 2 * rate**2
        plastic = 0 * theta
        if piece.fuses and not piece.held:
            fuse = self.lifting(piece.fuses, side)
            stroke = 2 * self.b * np.cos(theta / 2) * np.abs(rate)
            plastic = abs(fuse.on) * fuse.force_y * (1 - fuse.ratio) * stroke
        bending = v[:, 1 : 1 + n] ** 2 @ self.decay
        return dict(zip(POWERS, (given, viscous, bending, plastic), strict=True))

    def _flow(self, piece: Piece, t: Array, x: Array, v: Array) -> Flow:
        time = piece.t + piece.h * t
        return self.accelerate(x, v, piece.a_g(time), piece.a_v(time), piece.side, piece.fuses,
                               held=piece.held)  # fmt: skip

    def energies(self, course: Course, piece: Piece, share: float = 1.0) -> dict[str, float]:
        """Return what is stored and dissipated at a share of a piece [J/kg]."""
        at = np.array([share])
        x, v = piece.at(_basis(at), at)
        flow, n, side = self._flow(piece, at, x, v), self.n, piece.side
        theta, k = float(x[0, 0]), 1 + n
        u, u_t, frame = flow.u[0], flow.u_t[0], self.frame
        kinetic = v[0, :k] @ self.inertia(x, side)[0] @ v[0, :k] + frame.m @ u_t**2
        rise = side * self.b * math.sin(theta) - 2 * self.h * math.sin(theta / 2) ** 2
        spun = 4 * self.inerter * self.b**2 * math.cos(theta / 2) ** 2 * v[0, 0] ** 2
        kinetic -= spun
        gap = flow.linked[0] - x[0, k:] if frame.link_k.size else np.zeros(0)
        q = x[0, 1:k]
        found = {
            "kinetic": kinetic / 2,
            "strain": (u @ frame.stiff @ u + frame.link_k @ gap**2) / 2,
            "gravity": self.g * (rise - math.sin(theta) * (q @ self.area)),
            "bending": self.mass * self.omega**2 @ q**2 / 2,
            "cable": float(self.cable_force(side * x[:, 0])[2][0]),
            "effects": (spun - u @ frame.lean @ u) / 2,
        }
        for s, fuse in zip((1, -1), piece.fuses, strict=False):
            found["effects"] += fuse.stored(max(0.0, 4 * self.b * s * math.sin(theta / 2)))
        nodes = share * _POINTS
        powers = self.powers(piece, nodes, _basis(nodes))
        for name in POWERS:
            found[name] = piece.stored[name] + share * piece.h * float(_WEIGHTS @ powers[name])
        losses = zip(course.impacts, course.losses, strict=True)
        found["impact"] = sum(loss for t, loss in losses if t < piece.t + share * piece.h)
        return {name: float(value) for name, value in found.items()}

    def balance(self, course: Course, piece: Piece, share: float = 1.0) -> float:
        """Return what the ledger misses [J/kg]."""
        first = self.energies(course, course.pieces[0], 0.0)
        now = self.energies(course, piece, share)
        gone = ("viscous", "bending_damping", "hysteretic", "impact")
        kept = ("kinetic", "strain", "gravity", "bending", "cable", "effects")
        return sum(now[x] - first[x] for x in (*gone, *kept)) - now["input"]

    # sections of the wall

    def _sections(self) -> None:
        """Lay pieces of the wall between floors, with a boundary at mid-height."""
        z = {0.0, self.h, self.length, *self.frame.z, *np.cumsum(self.frame.heights)}
        if self.frame.coupling in ("single", "none"):
            z = {0.0, self.h, self.length}
        ends = [0.0]
        longest = self.length * 4 / (math.pi * max(1, self.n))
        for high in sorted(z)[1:]:
            if high - ends[-1] < 1e-9 * self.length:
                ends[-1] = high
                continue
            count = math.ceil((high - ends[-1]) / longest)
            ends += [float(x) for x in np.linspace(ends[-1], high, count + 1)[1:]]
        self.ends = np.array(ends)
        self.width = np.diff(self.ends)
        self.nodes = self.ends[:-1, None] + self.width[:, None] * _UP
        self.bent = self.shape(self.nodes.ravel())

    def forces(
        self, piece: Piece, t: Array, x: Array, v: Array, flow: Flow
    ) -> tuple[Array, Array, Array]:
        """Return shear, moment [time, piece, node], and the axial force at the base."""
        n, side, time = self.n, piece.side, piece.t + piece.h * t
        shape = (len(t), *self.nodes.shape)
        theta, rate, turn = (y[:, 0][:, None, None] for y in (x, v, flow.a))
        s, c = np.sin(theta), np.cos(theta)
        w, w_t, w_tt = ((y[:, 1 : 1 + n] @ self.bent.T).reshape(shape) for y in (x, v, flow.a))
        a_g, weight = piece.a_g(time)[:, None, None], self.g + piece.a_v(time)[:, None, None]
        z, b = self.nodes, self.b
        across = w_tt + z * turn - (w - side * b) * rate**2 + a_g * c - weight * s
        along = -(2 * w_t * rate + z * rate**2 + (w - side * b) * turn) + a_g * s + weight * c
        one, arm, axial, lever = (self._above(y) for y in (across, z * across, along, w * along))
        shear = one
        moment = arm - z * one - (lever - w * axial)
        moment = moment + b**2 / 3 * turn * (1 - z / self.length)
        base = axial[:, 0, 0].copy()
        s, c = s[..., 0], c[..., 0]
        for j, height in enumerate(self.frame.z):
            below = self.ends[:-1] < height * (1 - 1e-9)
            pull = np.zeros(shape[:2])
            pull[:, below] = flow.links[:, j : j + 1]
            place = side * b - self.line[j] * b * (1 + side)
            place = place + (x[:, 1 : 1 + n] @ self.p[j])[:, None]
            shear = shear + (pull * c)[..., None]
            lever = (height - z) * c[..., None] - (place[..., None] - w) * s[..., None]
            moment = moment + pull[..., None] * lever
            base += flow.links[:, j] * s[:, 0]
        if self.cable:
            across_top, along_top = self._anchor(x[:, 0], side)
            shear = shear - across_top[:, None, None]
            moment = moment - (self.length - z) * across_top[:, None, None]
            base -= along_top
        return shear, moment, base

    def _above(self, values: Array) -> Array:
        """Return integrals from each node to the top, over the mass per length."""
        inside = np.einsum("ij,tpj->tpi", _ABOVE, values) * (self.width / self.length)[:, None]
        whole = inside[..., 0]
        above = np.cumsum(whole[:, ::-1], axis=1)[:, ::-1] - whole
        return inside + above[..., None]

    def _anchor(self, theta: Array, side: int) -> tuple[Array, Array]:
        """Return the force of the cable at the top, across and along the wall."""
        size = self.cable_force(side * theta)[0]
        if not self.cable or self.cable.get("law", "linear") == "linear":
            return 0 * size, -size
        across = 2 * side * self.b * np.sin(theta / 2) ** 2
        along = self.length + side * self.b * np.sin(theta)
        length = np.hypot(across, along)
        return size * across / length, -size * along / length

    def columns(self, piece: Piece, t: Array, basis: tuple[Array, Array, Array]
                ) -> tuple[dict[str, Array], Array, Array]:  # fmt: skip
        """Return signed demands at shares of a piece, and shear and moment of all sections."""
        x, v = piece.at(basis, t)
        flow, g, side = self._flow(piece, t, x, v), self.g, piece.side
        theta, n, time = x[:, 0], self.n, piece.t + piece.h * t
        shear, moment, axial = self.forces(piece, t, x, v, flow)
        force = self.cable_force(side * theta)[0]
        found = {"theta_max_over_alpha": theta / self.alpha, "theta_dot_max_rad_s": v[:, 0]}
        found |= {f"q_{i + 1}_max_m": x[:, 1 + i] for i in range(n)}
        tip = x[:, 1 : 1 + n].sum(axis=1)
        if n:
            found["tip_deflection_max_m"] = tip
        found["wall_drift_max"] = (
            np.sin(theta) + 2 * side * self.b / self.length * np.sin(theta / 2) ** 2
            + tip * np.cos(theta) / self.length
        )  # fmt: skip
        found["tendon_force_max_over_m_w_g"] = force / g
        s, c = np.sin(theta), np.cos(theta)
        pivot = np.array([c * shear[:, 0, 0] + s * axial, c * axial - s * shear[:, 0, 0]])
        pivot = pivot + self.corner(piece, x, v, flow)
        found["pivot_horizontal_max_over_m_w_g"] = pivot[0] / g
        found["pivot_normal_over_m_w_g"] = pivot[1] / g
        found |= self._frame_columns(piece, time, flow)
        at = {0.0: "base", self.h: "mid"} | self._names()
        for i, (low, high) in enumerate(pairwise(self.ends)):
            for end, node, place in ((low, 0, "above"), (high, -1, "below")):
                for z, name in at.items():
                    if abs(end - z) < 1e-9 * self.length:
                        key = name if name == "base" else f"{name}_{place}"
                        found[f"wall_shear_{key}"] = shear[:, i, node] / g
                        found[f"wall_moment_{key}"] = moment[:, i, node] / g
        return found, shear / g, moment / g

    def _names(self) -> dict[float, str]:
        if self.frame.coupling == "none":
            return {}
        if self.frame.coupling == "single":
            return {self.length: "1"}
        return {float(z): str(i + 1) for i, z in enumerate(np.cumsum(self.frame.heights))}

    def corner(self, piece: Piece, x: Array, v: Array, flow: Flow) -> Array:
        """Return what devices under the corners add to the reaction of the pivot."""
        half, side = x[:, 0] / 2, piece.side
        rate, turn = side * v[:, 0], side * flow.a[:, 0]
        opens = 2 * self.b * np.cos(half)
        size = self.damper * opens * rate
        size = size + self.inerter * (opens * turn - self.b * np.abs(np.sin(half)) * rate**2)
        standing = 0.0
        if piece.fuses:
            size = size + self.lifting(piece.fuses, side).force(4 * self.b * side * np.sin(half))
            standing = float(self.lifting(piece.fuses, -side).force(np.zeros(1))[0])
        return np.array([size * np.sin(half), size * np.cos(half) + standing])

    def _frame_columns(self, piece: Piece, time: Array, flow: Flow) -> dict[str, Array]:
        """Return demands of floors, storeys and links."""
        frame, a_g = self.frame, piece.a_g(time)
        if frame.coupling == "none":
            return {}
        found: dict[str, Array] = {}
        u, u_tt = frame.floors(flow.u), frame.floors(flow.u_tt)
        drift = np.diff(u, prepend=0.0)
        u_roof = flow.linked[:, -1]
        found["u_s_max_m"], found["roof_drift_max"] = u_roof, u_roof / self.length
        for i in range(u.shape[1]):
            found[f"floor_{i + 1}_max_m"] = u[:, i]
            found[f"floor_{i + 1}_acceleration_max_g"] = (u_tt[:, i] + a_g) / self.g
            if frame.coupling != "single":
                found[f"storey_{i + 1}_drift_max"] = drift[:, i] / frame.heights[i]
                found[f"storey_{i + 1}_shear_max_over_m_w_g"] = frame.k[i] * drift[:, i] / self.g
        first = 1 + u.shape[1] - frame.linked
        for j in range(frame.linked):
            found[f"link_{first + j}_force_max_over_m_w_g"] = flow.links[:, j] / self.g
        return found

    def largest(self, course: Course) -> dict[str, float]:
        """Return the largest demands, over time and height."""
        return _Peaks(self, course).find()

    def history(self, course: Course, times: Array) -> dict[str, Array]:
        """Return demands at times, after an event if a time meets one."""
        begins = np.array([p.t for p in course.pieces])
        rows = []
        for t in times:
            piece = course.pieces[max(0, int(np.searchsorted(begins, t, side="right")) - 1)]
            share = np.array([min(1.0, (t - piece.t) / piece.h)])
            rows.append(self.columns(piece, share, _basis(share))[0])
        return {name: np.array([row[name][0] for row in rows]) for name in rows[0]}


@dataclass
class Course:
    """What the program finds."""

    pieces: list[Piece] = field(default_factory=list)
    impacts: list[float] = field(default_factory=list)
    lift_offs: list[float] = field(default_factory=list)
    contacts: list[float] = field(default_factory=list)
    losses: list[float] = field(default_factory=list)
    overturned: bool = False
    collapsed: bool = False
    jumps: bool = False  # both corners let go at once
    t_end: float = 0.0
    energy: dict[str, float] = field(default_factory=dict)


POWERS = ("input", "viscous", "bending_damping", "hysteretic")


class _Run:
    """One run of a scene."""

    def __init__(self, wall: BentWall, t_end: float) -> None:
        self.wall, self.t_end, self.course = wall, t_end, Course()
        wall.fuses = [copy.copy(f) for f in wall.fuses]
        for fuse in wall.fuses:
            fuse.p, fuse.on = 0.0, 0
        first = wall.groups.get("initial", {})
        self.x, self.v = np.zeros(wall.size), np.zeros(wall.size)
        self.x[0] = first.get("theta_over_alpha", 0.0) * wall.alpha
        self.v[0] = first.get("theta_dot", 0.0)
        self.t, self.ledger = 0.0, dict.fromkeys(POWERS, 0.0)
        self.fastest = wall._fastest()
        self.side = 1 if (self.x[0] or self.v[0]) >= 0 else -1
        self.held = not self.x[0] and not self.v[0]
        self.power = 0 if self.x[0] else 1  # of time with which the rotation starts
        if wall.fuses and self.x[0]:
            self._settle()

    def go(self) -> Course:
        """Follow the motion."""
        course = self.course
        while self.t < self.t_end - 1e-13 and not (course.overturned or course.collapsed):
            later = [k for k in self.wall.knots if k > self.t + 1e-12]
            stop = min([self.t_end, *later])
            if self.held:
                self._lift_at_once(stop)
            self._stretch(stop)
        course.t_end = self.t
        return course

    def _motion(self, t: float, stop: float) -> tuple[Callable[[Array], Array], ...]:
        wall = self.wall
        a_g = wall.ground.between(t, stop)
        if wall.vertical:
            return a_g, wall.vertical.between(t, stop)
        return a_g, lambda t: wall.ratio * a_g(t)

    def _stretch(self, stop: float) -> None:
        """Go on to a time without a knot before it, or to an event."""
        begin, wall = self.t, self.wall
        count = max(1, math.ceil((stop - begin) * self.fastest / ANGLE))
        h, i = (stop - begin) / count, 0
        a_g, a_v = self._motion(begin, stop)
        while i < count:
            piece = Piece(begin + i * h, h, self.side, self.held, self.x, self.v,
                          np.zeros(0), a_g, a_v, [copy.copy(f) for f in wall.fuses])  # fmt: skip
            if not wall.step(piece):
                count, i, h = 2 * count, 2 * i, h / 2
                if h < 1e-12:
                    raise ArithmeticError(f"no step at {self.t} s")
                continue
            event = self._first(piece)
            if event:
                self._cut(piece, *event)
                return
            self._accept(piece)
            i += 1
        self.t = stop

    def _accept(self, piece: Piece) -> None:
        piece.stored = dict(self.ledger)
        powers = self.wall.powers(piece, _POINTS, (_P, _P1, _P2))
        for name, power in powers.items():
            self.ledger[name] += piece.h * float(_WEIGHTS @ power)
        self.course.pieces.append(piece)
        self.x, self.v = self.wall._end(piece)
        self.t, self.power = piece.t + piece.h, 0

    # events

    def _watched(self, piece: Piece) -> list[tuple[str, Callable[..., Array]]]:
        """Return names and functions that become positive at an event; rows are instants."""
        wall, side = self.wall, piece.side
        found: list[tuple[str, Callable[..., Array]]] = []
        if piece.held:
            for s in (1, -1):
                found.append((f"lift {s}", lambda t, x, v, s=s: wall.drive(piece, t, x, v, s)))
        else:
            power = self.power
            # divided by the power of time with which the rotation starts
            found.append(("impact", lambda t, x, v: -side * (
                self._rotation(piece, t) if power else x[:, 0])))  # fmt: skip
            found.append(("over", lambda t, x, v: side * x[:, 0] - wall.limit))
            if piece.fuses:
                found += self._fuse_events(piece)
        limit = wall.groups.get("p_delta", {}).get("drift_limit", 0.1)
        if "p_delta" in wall.groups:
            found.append(("collapse", lambda t, x, v: (
                np.abs(wall.drifts(x, v, side)).max(axis=1) - limit)))  # fmt: skip
        return found

    def _fuse_events(self, piece: Piece) -> list[tuple[str, Callable[..., Array]]]:
        fuse, side = self.wall.lifting(piece.fuses, piece.side), piece.side
        if fuse.on:
            return [("unload", lambda t, x, v: -fuse.on * side * v[:, 0])]

        def drawn(x: Array) -> Array:
            return 4 * self.wall.b * side * np.sin(x[:, 0] / 2)

        return [("yield 1", lambda t, x, v: drawn(x) - fuse.limit(1)),
                ("yield -1", lambda t, x, v: fuse.limit(-1) - drawn(x))]  # fmt: skip

    def _rotation(self, piece: Piece, t: Array) -> Array:
        """Return the rotation over time or its square, for a start at zero."""
        # the mean of (1 - r) theta''(r t) over r, twice the integral of theta'' over t^2
        at = legendre.legvander(2 * np.outer(t, _POINTS) - 1, NODES - 1)
        lifted = piece.h**2 * ((at @ piece.coefficients[:, 0]) @ (_WEIGHTS * (1 - _POINTS)))
        return piece.h * piece.v[0] + lifted * t if self.power == 1 else lifted

    def _first(self, piece: Piece) -> tuple[str, float] | None:
        """Return the first event in a piece and its share of it."""
        x, v = piece.at(_AT_FINE, _FINE)
        found: list[tuple[float, str]] = []
        for name, function in self._watched(piece):
            values = function(_FINE, x, v)
            begin = 0
            if name == "impact" and self.power == 2:
                # round-off of the acceleration, which is zero at lift-off
                values[:3] = min(values[3], -_TINY)
            if values[0] >= 0:  # an event that has just happened, or round-off at the start
                later = np.flatnonzero(values < 0)
                if name in ("over", "collapse") or not later.size:
                    found.append((float(_FINE[0]), name))
                    continue
                begin = int(later[0])
            up = np.flatnonzero(values[begin:] >= 0) + begin
            if not up.size and values.max() > -0.02 * np.ptp(values):
                up = self._between(piece, function, values)
            if up.size:
                found.append((self._root(piece, function, int(up[0])), name))
        if not found:
            return None
        share, name = min(found)
        return name, share

    def _between(self, piece: Piece, function: Callable[..., Array], values: Array) -> Array:
        """Look for a root between samples, at the peak next to the largest sample."""
        i = int(values.argmax())
        if i < 4:
            return np.zeros(0, int)
        low, high = _FINE[i - 1], _FINE[min(i + 1, _FINE.size - 1)]
        best = minimize_scalar(lambda t: -self._value(piece, function, t), bounds=(low, high),
                               method="bounded", options={"xatol": 1e-12})  # fmt: skip
        if -best.fun < 0:
            return np.zeros(0, int)
        self._peak = float(best.x)
        return np.array([-1])

    def _value(self, piece: Piece, function: Callable[..., Array], t: float) -> float:
        at = np.array([t])
        return float(function(at, *piece.at(_basis(at), at))[0])

    def _root(self, piece: Piece, function: Callable[..., Array], i: int) -> float:
        high = self._peak if i < 0 else _FINE[i]
        low = 0.0 if i < 0 else _FINE[i - 1]
        if i < 0:
            before = _FINE[_FINE < high]
            low = float(before[-1]) if before.size else 0.0
        if i == 0 or self._value(piece, function, low) >= 0:
            return float(high)
        return float(brentq(lambda t: self._value(piece, function, t), low, high, xtol=1e-16))

    def _cut(self, piece: Piece, name: str, share: float) -> None:
        """Integrate up to an event, and let it happen."""
        for _ in range(3):
            piece.h *= share
            if not self.wall.step(piece):
                raise ArithmeticError(f"no step at {piece.t} s")
            function = dict(self._watched(piece))[name]
            # one secant step of the length: the rate of the function at the end
            near = self._value(piece, function, 1 - 1e-6), self._value(piece, function, 1.0)
            share = 1 - near[1] / (near[1] - near[0]) * 1e-6 if near[1] != near[0] else 1.0
            if abs(share - 1) < 1e-13 or not 0.5 < share < 2:
                break
        self._accept(piece)
        self._happen(name)

    def _happen(self, name: str) -> None:
        """Change the state at an event."""
        course = self.course
        self.power = 0
        if name == "impact":
            self._impact()
        elif name.startswith("lift"):
            self._lift(int(name.split()[1]))
            self.power = 2
        elif name in ("over", "collapse"):
            course.overturned, course.collapsed = name == "over", name == "collapse"
        elif name == "unload":
            self._fuse().turn(self._drawn())
        else:
            self._fuse().on = int(name.split()[1])

    def _fuse(self) -> Fuse:
        return self.wall.lifting(self.wall.fuses, self.side)

    def _drawn(self) -> float:
        return 4 * self.wall.b * self.side * math.sin(self.x[0] / 2)

    def _settle(self) -> None:
        """Load the fuse up to the first rotation."""
        fuse, x = self._fuse(), self._drawn()
        if x > fuse.limit(1):
            fuse.on = 1
            self.ledger["hysteretic"] += fuse.force_y * (1 - fuse.ratio) * (x - fuse.limit(1))
            fuse.turn(x)

    def _lift(self, side: int) -> None:
        self.course.lift_offs.append(self.t)
        self.held, self.side = False, side
        self.x, self.v = self.x.copy(), self.v.copy()
        self.x[0] = self.v[0] = 0.0

    def _lift_at_once(self, stop: float) -> None:
        """Let a wall go whose contact has no duration."""
        a_g, a_v = self._motion(self.t, stop)
        piece = Piece(self.t, 0.0, self.side, True, self.x, self.v,
                      np.zeros((NODES, self.wall.size)), a_g, a_v, self.wall.fuses)  # fmt: skip
        zero = np.zeros(1)
        drive = {s: float(self.wall.drive(piece, zero, self.x[None], self.v[None], s)[0])
                 for s in (1, -1)}  # fmt: skip
        up = [s for s in drive if drive[s] > 1e-12]
        if not up:
            return
        self.course.jumps |= len(up) == 2
        self._lift(max(up, key=lambda s: drive[s]))
        self.power = 2

    def _impact(self) -> None:
        """Pass to the other corner, or come into contact."""
        wall, course = self.wall, self.course
        course.impacts.append(self.t)
        if wall.fuses and self._fuse().on:
            self._fuse().turn(0.0)
        x = self.x.copy()
        x[0] = 0.0
        v, side, loss, goes = wall.landing(x, self.v, self.side)
        if goes and self._is_chatter(x, v, side):
            held = v.copy()
            matrix = wall._energy_matrix(x[None], side)
            k = 1 + wall.n
            if wall.n:
                held[1:k] += np.linalg.solve(matrix[1:, 1:], matrix[1:, 0] * v[0])
            held[0] = 0.0
            loss += 0.5 * float(v[:k] @ matrix @ v[:k] - held[:k] @ matrix @ held[:k])
            v, goes = held, False
        course.losses.append(loss)
        self.x, self.v, self.side, self.held, self.power = x, v, side, not goes, 1
        if not goes:
            course.contacts.append(self.t)

    def _is_chatter(self, x: Array, v: Array, side: int) -> bool:
        """Return whether the next flight is too short to matter."""
        a_g, a_v = self._motion(self.t, self.t + 1e-9)
        t = np.array([self.t])
        a = self.wall.accelerate(x[None], v[None], a_g(t), a_v(t), side, self.wall.fuses,
                                 held=False).a[0, 0] * side  # fmt: skip
        return a < 0 and 2 * abs(v[0]) / -a < 3e-8


class _Peaks:
    """Search of the largest demands: samples first, then the pieces that can hold the largest."""

    def __init__(self, wall: BentWall, course: Course) -> None:
        self.wall, self.pieces = wall, course.pieces
        self.course = course
        bounds, whole = [], []
        for piece in self.pieces:
            columns, shear, moment = wall.columns(piece, _LOBATTO, _AT_LOBATTO)
            dense = _DENSE @ np.array(list(columns.values())).T
            size = np.abs(dense)
            reach = 0.01 * np.ptp(dense, axis=0)
            i = list(columns).index("pivot_normal_over_m_w_g")
            normal = [dense[:, i].max() + reach[i], -dense[:, i].min() + reach[i]]
            bounds.append([*(size.max(axis=0) + reach), *normal])
            inside = [_DENSE @ y.reshape(len(_LOBATTO), -1) for y in (shear, moment)]
            whole.append([np.abs(y).max() + 0.01 * np.ptp(y, axis=0).max() for y in inside])
        self.names = list(columns)
        self.bounds, self.whole = np.array(bounds), np.array(whole)

    def find(self) -> dict[str, float]:
        """Return all peaks by the names of the kernel."""
        found = {}
        signs = [(name, 0) for name in self.names]
        signs += [("pivot_normal_over_m_w_g", 1), ("pivot_normal_over_m_w_g", -1)]
        for q, (name, sign) in enumerate(signs):
            value = self._largest(self.bounds[:, q], lambda p, n=name, s=sign: self._peak(p, n, s))
            if sign or name != "pivot_normal_over_m_w_g":
                key = name if not sign else f"pivot_normal_{'max' if sign > 0 else 'min'}_over_m_w_g"
                found[key] = -value if sign < 0 else value
        for q, name in enumerate(("shear", "moment")):
            found[f"wall_{name}"] = self._largest(
                self.whole[:, q], lambda p, q=q: self._inside(p, q))  # fmt: skip
        return self._renamed(found) | {
            "impacts": len(self.course.impacts), "lift_offs": len(self.course.lift_offs),
            "overturned": self.course.overturned, "e": self.wall.straight_e(),
        }  # fmt: skip

    def _renamed(self, found: dict[str, float]) -> dict[str, float]:
        """Give sections the names of the kernel; the larger of both sides at mid-height."""
        result = {}
        for name, unit in (("shear", "over_m_w_g"), ("moment", "over_m_w_g_m")):
            sides = [found.pop(f"wall_{name}_mid_{x}") for x in ("below", "above")]
            result[f"wall_{name}_mid_max_{unit}"] = max(sides)
            for key in [k for k in found if k.startswith(f"wall_{name}")]:
                place = key.removeprefix(f"wall_{name}").removesuffix("_below")
                result[f"wall_{name}{place}_max_{unit}"] = found.pop(key)
        drifts = [v for k, v in found.items() if k.startswith("storey") and k.endswith("drift_max")]
        if drifts:
            result["storey_drift_max"] = max(drifts)
        return found | result

    def _largest(self, bounds: Array, peak: Callable[[Piece], float]) -> float:
        best = -math.inf
        for i in np.argsort(-bounds):
            if bounds[i] <= best:
                break
            best = max(best, peak(self.pieces[i]))
        return best

    def _peak(self, piece: Piece, name: str, sign: int) -> float:
        values = self.wall.columns(piece, _LOBATTO, _AT_LOBATTO)[0][name]
        values = values if sign >= 0 else -values
        return _highest(values, is_signed=sign != 0)

    def _inside(self, piece: Piece, q: int) -> float:
        """Return the largest shear or moment over a piece of time and all heights."""
        values = self.wall.columns(piece, _LOBATTO, _AT_LOBATTO)[1 + q]
        in_time = np.tensordot(_TO_CHEBYSHEV, values, 1)
        dense = np.abs(np.tensordot(_DENSE, values, 1))
        tops, best = dense.max(axis=(0, 2)), -math.inf
        for p in np.flatnonzero(tops >= 0.98 * tops.max()):
            def over_height(t: float, p: int = int(p)) -> float:
                at = chebyshev.chebvander(np.array([2 * t - 1]), NODES + 5)[0]
                return _highest(at @ in_time[:, p], _UP_CHEBYSHEV)

            i = int(dense[:, p].max(axis=1).argmax())
            ends = _FINE[2:][[max(i - 1, 0), min(i + 1, len(dense) - 1)]]
            inner = minimize_scalar(lambda t: -over_height(t), bounds=(max(ends[0], 0.0), ends[1]),  # noqa: B023
                                    method="bounded", options={"xatol": 1e-11})  # fmt: skip
            best = max(best, -float(inner.fun), over_height(0.0), over_height(1.0))
        return best


def _highest(values: Array, to: Array = _TO_CHEBYSHEV, *, is_signed: bool = False) -> float:
    """Return the largest (magnitude of a) polynomial from its values at Lobatto nodes."""
    series = to @ values
    slope = chebyshev.chebder(series)
    turns = chebyshev.chebroots(chebyshev.chebtrim(slope, 1e-15 * (np.abs(slope).max() + _TINY)))
    turns = turns[np.abs(np.imag(turns)) < 1e-6].real
    turns = np.clip(turns, -1, 1)
    found = np.concatenate([values[[0, -1]], chebyshev.chebval(turns, series)])
    return float(found.max() if is_signed else np.abs(found).max())
