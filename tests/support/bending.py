"""Rocking walls that bend, integrated by Gauss collocation without the kernel.

The equations are those of Lagrange for the rotation of the base, the modes of the cantilever and
the free floors. One step has twenty Gauss nodes; its solution is a polynomial in time, from which
impacts, lift-offs and the largest demands follow by root finding. A step that contains an event is
integrated again up to the event. Sections of the wall are in equilibrium with the mass, the links
and the tendon above them.

Masses, forces and energies are over the mass of the wall.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from bending_demands import Demands
from bending_parts import (
    ANGLE,
    AT_END,
    AT_FINE,
    AT_POINTS,
    FINE,
    NODES,
    ONCE,
    POINTS,
    TINY,
    TO_LEGENDRE,
    TWICE,
    WEIGHTS,
    Array,
    Frame,
    Fuse,
    Ground,
    Groups,
    Shapes,
    basis_at,
)
from numpy.polynomial import legendre
from scipy.optimize import brentq, minimize_scalar


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
    storeys: list[Fuse] = field(default_factory=list)  # springs of yielding storeys
    stored: dict[str, float] = field(default_factory=dict)  # integrals of powers at its begin
    v_g: float = 0.0  # velocity of the ground at its begin

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
        self.storeys: list[Fuse] = self.frame.springs
        self.size = 1 + self.n + self.frame.free
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
        """Return linked displacements, their gradient by (theta, q), and velocity terms."""
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
        self, x: Array, v: Array, a_g: Array, a_v: Array, side: int, fuses: list[Fuse],
        storeys: list[Fuse], *, held: bool,
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
        if storeys:
            d_s = u @ frame.rows.T
            k = np.array([s.k for s in storeys])
            force = force + (frame.pulls(storeys, d_s) - k * d_s) @ frame.rows
            k = 1 + self.n
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
        and floors do not change. The old velocities enter with the gradients about the new corner.
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
        """Return inertia of the wall and of the masses rigidly linked to it."""
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
        a = self.accelerate(x_all, v_all, zero, zero, side, self.fuses, self.storeys, held=held).a
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
        state = tuple(f.on for f in [*self.fuses, *self.storeys])
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
            matrix -= np.kron(h**2 * TWICE, by_x) + np.kron(h * ONCE, by_v)
            self._inverses[key] = np.linalg.inv(matrix)
        return self._inverses[key]

    def step(self, piece: Piece, guess: Array | None = None) -> bool:
        """Solve for the accelerations of a piece; return whether the iteration converges."""
        t, h = piece.t + piece.h * POINTS, piece.h
        a_g, a_v = piece.a_g(t), piece.a_v(t)
        shift = piece.x + h * POINTS[:, None] * piece.v
        a = np.zeros((NODES, self.size)) if guess is None else guess
        last, fresh = math.inf, False
        inverse = self._inverse(piece.x, piece.side, h, held=piece.held, fresh=False)
        for count in range(60):
            flow = self.accelerate(shift + h**2 * TWICE @ a, piece.v + h * ONCE @ a, a_g, a_v,
                                   piece.side, piece.fuses, piece.storeys,
                                   held=piece.held)  # fmt: skip
            change = (inverse @ (flow.a - a).ravel()).reshape(a.shape)
            a = a + change
            scale = np.abs(a).max(axis=0) + 1e-5 * np.abs(a).max() + TINY
            size = float((np.abs(change) / scale).max())
            if not math.isfinite(size):
                return False
            if size < 1e-15 or (last < 1e-6 and size > 0.2 * last):
                piece.coefficients = TO_LEGENDRE @ a
                return True
            last = size
            if count == 14 and not fresh:
                inverse = self._inverse(piece.x, piece.side, h, held=piece.held, fresh=True)
                fresh = True
        return False

    def _end(self, piece: Piece) -> tuple[Array, Array]:
        x, v = piece.at(AT_END, np.ones(1))
        return x[0], v[0]

    def follow(self, t_end: float | None = None) -> Course:
        """Follow the motion up to a time, an overturning or a collapse."""
        return _Run(self, t_end or self.groups["solver"]["t_end"]).go()

    # demands

    def drive(self, piece: Piece, t: Array, x: Array, v: Array, side: int) -> Array:
        """Return the acceleration away from the base that rocking on a side would have."""
        time = piece.t + piece.h * t
        flow = self.accelerate(x, v, piece.a_g(time), piece.a_v(time), side, piece.fuses,
                               piece.storeys, held=False)  # fmt: skip
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
        """Return the powers of the ground and of dissipation."""
        x, v = piece.at(basis, t)
        flow = self.flow(piece, t, x, v)
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
        if piece.storeys:
            lost = np.array([abs(s.on) * s.force_y * (1 - s.ratio) for s in piece.storeys])
            plastic = plastic + np.abs(flow.u_t @ self.frame.rows.T) @ lost
        bending = v[:, 1 : 1 + n] ** 2 @ self.decay
        return dict(zip(POWERS, (given, viscous, bending, plastic), strict=True))

    def flow(self, piece: Piece, t: Array, x: Array, v: Array) -> Flow:
        """Return accelerations and forces at shares of a piece."""
        time = piece.t + piece.h * t
        return self.accelerate(x, v, piece.a_g(time), piece.a_v(time), piece.side, piece.fuses,
                               piece.storeys, held=piece.held)  # fmt: skip

    def energies(self, course: Course, piece: Piece, share: float = 1.0) -> dict[str, float]:
        """Return stored and dissipated energies at a share of a piece [J/kg]."""
        at = np.array([share])
        x, v = piece.at(basis_at(at), at)
        flow, n, side = self.flow(piece, at, x, v), self.n, piece.side
        theta, k = float(x[0, 0]), 1 + n
        u, u_t, frame = flow.u[0], flow.u_t[0], self.frame
        kinetic = v[0, :k] @ self.inertia(x, side)[0] @ v[0, :k] + frame.m @ u_t**2
        rise = side * self.b * math.sin(theta) - 2 * self.h * math.sin(theta / 2) ** 2
        spun = 4 * self.inerter * self.b**2 * math.cos(theta / 2) ** 2 * v[0, 0] ** 2
        kinetic -= spun
        gap = flow.linked[0] - x[0, k:] if frame.link_k.size else np.zeros(0)
        q, strain = x[0, 1:k], u @ frame.stiff @ u
        if piece.storeys:
            d_s = frame.rows @ u
            strain = 2 * sum(s.stored(d) for s, d in zip(piece.storeys, d_s, strict=True))
        found = {
            "kinetic": kinetic / 2,
            "strain": (strain + frame.link_k @ gap**2) / 2,
            "gravity": self.g * (rise - math.sin(theta) * (q @ self.area)),
            "bending": self.mass * self.omega**2 @ q**2 / 2,
            "cable": float(self.cable_force(side * x[:, 0])[2][0]),
            "effects": (spun - u @ frame.lean @ u) / 2,
        }
        for s, fuse in zip((1, -1), piece.fuses, strict=False):
            found["effects"] += fuse.stored(max(0.0, 4 * self.b * s * math.sin(theta / 2)))
        nodes = share * POINTS
        powers = self.powers(piece, nodes, basis_at(nodes))
        for name in POWERS:
            found[name] = piece.stored[name] + share * piece.h * float(WEIGHTS @ powers[name])
        losses = zip(course.impacts, course.losses, strict=True)
        found["impact"] = sum(loss for t, loss in losses if t < piece.t + share * piece.h)
        return {name: float(value) for name, value in found.items()}

    def balance(self, course: Course, piece: Piece, share: float = 1.0) -> float:
        """Return the residual of the ledger [J/kg]."""
        first = self.energies(course, course.pieces[0], 0.0)
        now = self.energies(course, piece, share)
        gone = ("viscous", "bending_damping", "hysteretic", "impact")
        kept = ("kinetic", "strain", "gravity", "bending", "cable", "effects")
        return sum(now[x] - first[x] for x in (*gone, *kept)) - now["input"]

    def largest(self, course: Course) -> dict[str, float]:
        """Return the largest demands, over time and height."""
        return Demands(self).largest(course)


@dataclass
class Course:
    """Results of the program."""

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


CHATTER = 3e-8  # duration of the flight that ends a chatter [s]
POWERS = ("input", "viscous", "bending_damping", "hysteretic")


class _Run:
    """One run of a scene."""

    def __init__(self, wall: BentWall, t_end: float) -> None:
        self.wall, self.t_end, self.course = wall, t_end, Course()
        wall.fuses = [copy.copy(f) for f in wall.fuses]
        wall.storeys = [copy.copy(s) for s in wall.frame.springs]
        for fuse in wall.fuses:
            fuse.p, fuse.on = 0.0, 0
        first = wall.groups.get("initial", {})
        self.x, self.v = np.zeros(wall.size), np.zeros(wall.size)
        self.x[0] = first.get("theta_over_alpha", 0.0) * wall.alpha
        self.v[0] = first.get("theta_dot", 0.0)
        self.t, self.v_g, self.ledger = 0.0, 0.0, dict.fromkeys(POWERS, 0.0)
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
                          np.zeros(0), a_g, a_v, [copy.copy(f) for f in wall.fuses],
                          [copy.copy(s) for s in wall.storeys])  # fmt: skip
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
        piece.stored, piece.v_g = dict(self.ledger), self.v_g
        self.v_g += piece.h * float(WEIGHTS @ piece.a_g(piece.t + piece.h * POINTS))
        powers = self.wall.powers(piece, POINTS, AT_POINTS)
        for name, power in powers.items():
            self.ledger[name] += piece.h * float(WEIGHTS @ power)
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
        found += self._storey_events(piece)
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

        loads = ("yield 1", lambda t, x, v: drawn(x) - fuse.limit(1))
        if self.power:
            # the stroke grows from zero, where a fuse that closed in yielding has its lower limit
            return [loads]
        return [loads, ("yield -1", lambda t, x, v: fuse.limit(-1) - drawn(x))]

    def _storey_events(self, piece: Piece) -> list[tuple[str, Callable[..., Array]]]:
        found: list[tuple[str, Callable[..., Array]]] = []
        for i, s in enumerate(piece.storeys):
            if s.on:
                found.append((f"storey {i} 0", lambda t, x, v, i=i, s=s: (
                    -s.on * self._storeys(x, v, piece.side)[1][:, i])))  # fmt: skip
                continue
            for way in (1, -1):
                found.append((f"storey {i} {way}", lambda t, x, v, i=i, s=s, way=way: (
                    way * (self._storeys(x, v, piece.side)[0][:, i] - s.limit(way)))))  # fmt: skip
        return found

    def _storeys(self, x: Array, v: Array, side: int) -> tuple[Array, Array]:
        """Return the displacements of yielding storeys and their rates."""
        wall, k = self.wall, 1 + self.wall.n
        u, u_t = x[:, k:], v[:, k:]
        if not wall.frame.link_k.size:
            linked, d, _ = wall._jacobian(x, v, side)
            u = np.hstack([u, linked])
            u_t = np.hstack([u_t, np.einsum("tij,tj->ti", d, v[:, :k])])
        return u @ wall.frame.rows.T, u_t @ wall.frame.rows.T

    def _rotation(self, piece: Piece, t: Array) -> Array:
        """Return the rotation over time or its square, for a start at zero."""
        # the mean of (1 - r) theta''(r t) over r, twice the integral of theta'' over t^2
        at = legendre.legvander(2 * np.outer(t, POINTS) - 1, NODES - 1)
        lifted = piece.h**2 * ((at @ piece.coefficients[:, 0]) @ (WEIGHTS * (1 - POINTS)))
        return piece.h * piece.v[0] + lifted * t if self.power == 1 else lifted

    def _first(self, piece: Piece) -> tuple[str, float] | None:
        """Return the first event in a piece and its share of it."""
        x, v = piece.at(AT_FINE, FINE)
        found: list[tuple[float, str]] = []
        for name, function in self._watched(piece):
            values = function(FINE, x, v)
            begin = 0
            if name == "impact" and self.power == 2:
                # round-off of the acceleration, which is zero at lift-off
                values[:3] = min(values[3], -TINY)
            if values[0] >= 0:  # an event that has just happened, or round-off at the start
                later = np.flatnonzero(values < 0)
                if name in ("over", "collapse") or not later.size:
                    found.append((float(FINE[0]), name))
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
        low, high = FINE[i - 1], FINE[min(i + 1, FINE.size - 1)]
        best = minimize_scalar(lambda t: -self._value(piece, function, t), bounds=(low, high),
                               method="bounded", options={"xatol": 1e-12})  # fmt: skip
        if -best.fun < 0:
            return np.zeros(0, int)
        self._peak = float(best.x)
        return np.array([-1])

    def _value(self, piece: Piece, function: Callable[..., Array], t: float) -> float:
        at = np.array([t])
        return float(function(at, *piece.at(basis_at(at), at))[0])

    def _root(self, piece: Piece, function: Callable[..., Array], i: int) -> float:
        high = self._peak if i < 0 else FINE[i]
        low = 0.0 if i < 0 else FINE[i - 1]
        if i < 0:
            before = FINE[high > FINE]
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
        elif name.startswith("storey"):
            i, way = (int(x) for x in name.split()[1:])
            if way:
                self.wall.storeys[i].on = way
            else:
                d = self._storeys(self.x[None], self.v[None], self.side)[0]
                self.wall.storeys[i].turn(float(d[0, i]))
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
                      np.zeros((NODES, self.wall.size)), a_g, a_v, self.wall.fuses,
                      self.wall.storeys)  # fmt: skip
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
        d, d_t = self._storeys(x[None], v[None], side) if wall.storeys else (x[None], v[None])
        for i, s in enumerate(wall.storeys):
            if s.on * d_t[0, i] < 0:
                s.turn(float(d[0, i]))
        if not goes:
            course.contacts.append(self.t)

    def _is_chatter(self, x: Array, v: Array, side: int) -> bool:
        """Return whether the next flight is too short to matter."""
        a_g, a_v = self._motion(self.t, self.t + 1e-9)
        t = np.array([self.t])
        a = self.wall.accelerate(x[None], v[None], a_g(t), a_v(t), side, self.wall.fuses,
                                 self.wall.storeys, held=False).a[0, 0] * side  # fmt: skip
        return a < 0 and 2 * abs(v[0]) / -a < CHATTER
