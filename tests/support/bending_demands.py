"""Demands of walls that bend: forces on sections and pivot, floors, links, and their peaks.

Sections are in equilibrium with all above them. Peaks are searched in the pieces of motion whose
samples can hold the largest value, with polynomials over time and height. See `bending.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from bending_parts import (
    ABOVE,
    AT_LOBATTO,
    DENSE,
    FINE,
    LOBATTO,
    NODES,
    POINTS,
    TINY,
    TO_CHEBYSHEV,
    TO_LEGENDRE,
    UP,
    UP_CHEBYSHEV,
    Array,
    basis_at,
)
from numpy.polynomial import chebyshev
from scipy.optimize import minimize_scalar

if TYPE_CHECKING:
    from bending import BentWall, Course, Flow, Piece


class Demands:
    """Forces and demands of a scene.

    Parameters
    ----------
    wall : BentWall
        The scene.
    """

    def __init__(self, wall: BentWall) -> None:
        self.wall = wall
        self.frame, self.n, self.g = wall.frame, wall.n, wall.g
        self.h, self.b, self.length = wall.h, wall.b, wall.length
        self._sections()

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
        self.nodes = self.ends[:-1, None] + self.width[:, None] * UP
        self.bent = self.wall.shape(self.nodes.ravel())

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
            place = side * b - self.wall.line[j] * b * (1 + side)
            place = place + (x[:, 1 : 1 + n] @ self.wall.p[j])[:, None]
            shear = shear + (pull * c)[..., None]
            lever = (height - z) * c[..., None] - (place[..., None] - w) * s[..., None]
            moment = moment + pull[..., None] * lever
            base += flow.links[:, j] * s[:, 0]
        if self.wall.cable:
            across_top, along_top = self._anchor(x[:, 0], side)
            shear = shear - across_top[:, None, None]
            moment = moment - (self.length - z) * across_top[:, None, None]
            base -= along_top
        return shear, moment, base

    def _above(self, values: Array) -> Array:
        """Return integrals from each node to the top, over the mass per length."""
        inside = np.einsum("ij,tpj->tpi", ABOVE, values) * (self.width / self.length)[:, None]
        whole = inside[..., 0]
        above = np.cumsum(whole[:, ::-1], axis=1)[:, ::-1] - whole
        return inside + above[..., None]

    def _anchor(self, theta: Array, side: int) -> tuple[Array, Array]:
        """Return the force of the cable at the top, across and along the wall."""
        size = self.wall.cable_force(side * theta)[0]
        if not self.wall.cable or self.wall.cable.get("law", "linear") == "linear":
            return 0 * size, -size
        across = 2 * side * self.b * np.sin(theta / 2) ** 2
        along = self.length + side * self.b * np.sin(theta)
        length = np.hypot(across, along)
        return size * across / length, -size * along / length

    def columns(self, piece: Piece, t: Array, basis: tuple[Array, Array, Array]
                ) -> tuple[dict[str, Array], Array, Array]:  # fmt: skip
        """Return signed demands at shares of a piece, and shear and moment of all sections."""
        x, v = piece.at(basis, t)
        flow, g, side = self.wall.flow(piece, t, x, v), self.g, piece.side
        theta, n, time = x[:, 0], self.n, piece.t + piece.h * t
        shear, moment, axial = self.forces(piece, t, x, v, flow)
        force = self.wall.cable_force(side * theta)[0]
        found = {"theta_max_over_alpha": theta / self.wall.alpha, "theta_dot_max_rad_s": v[:, 0]}
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
        across, along = self._anchor(theta, side)
        # momentum of the wall: forces from below, of the links and of the cable change it
        push = pivot[0] - flow.links.sum(axis=1) + c * across + s * along
        push = push + flow.u_tt @ self.frame.push + self.frame.total * piece.a_g(time)
        found["base_shear_max_over_weight"] = push / (g * (1 + self.frame.total))
        pivot = pivot + self.corner(piece, x, v, flow)
        found["pivot_horizontal_max_over_m_w_g"] = pivot[0] / g
        found["pivot_normal_over_m_w_g"] = pivot[1] / g
        if piece.fuses:
            found["fuse_stroke_max_m"] = 4 * self.b * np.sin(theta / 2)
        v_g = piece.v_g + piece.h * (basis[1] @ TO_LEGENDRE @ piece.a_g(piece.t + piece.h * POINTS))
        found |= self._frame_columns(piece, piece.a_g(time), v_g, flow)
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
        """Return the part of the pivot reaction due to devices under the corners."""
        half, side = x[:, 0] / 2, piece.side
        rate, turn = side * v[:, 0], side * flow.a[:, 0]
        opens = 2 * self.b * np.cos(half)
        size = self.wall.damper * opens * rate
        size = size + self.wall.inerter * (opens * turn - self.b * np.abs(np.sin(half)) * rate**2)
        standing = 0.0
        if piece.fuses:
            size = size + self.wall.lifting(piece.fuses, side).force(
                4 * self.b * side * np.sin(half)
            )
            standing = float(self.wall.lifting(piece.fuses, -side).force(np.zeros(1))[0])
        return np.array([size * np.sin(half), size * np.cos(half) + standing])

    def _frame_columns(self, piece: Piece, a_g: Array, v_g: Array, flow: Flow) -> dict[str, Array]:
        """Return demands of floors, storeys and links."""
        frame = self.frame
        if frame.coupling == "none":
            return {}
        found: dict[str, Array] = {}
        u, u_t, u_tt = (frame.floors(y) for y in (flow.u, flow.u_t, flow.u_tt))
        drift = np.diff(u, prepend=0.0)
        shear = frame.k * drift
        if piece.storeys:
            d = flow.u @ frame.rows.T
            shear = frame.pulls(piece.storeys, d)
            for i, s in enumerate(piece.storeys):
                key = "ductility" if len(piece.storeys) == 1 else f"storey_{i + 1}_ductility"
                found[key] = d[:, i] * s.k / s.force_y
            if frame.coupling == "reduced":
                shear = shear / frame.stiff[0] * frame.k * np.diff(frame.share, prepend=0.0)
        u_roof = flow.linked[:, -1]
        found["u_s_max_m"], found["roof_drift_max"] = u_roof, u_roof / self.length
        for i in range(u.shape[1]):
            found[f"floor_{i + 1}_max_m"] = u[:, i]
            found[f"floor_{i + 1}_acceleration_max_g"] = (u_tt[:, i] + a_g) / self.g
            found[f"floor_{i + 1}_velocity_max_m_s"] = u_t[:, i] + v_g
            if frame.coupling != "single":
                found[f"storey_{i + 1}_drift_max"] = drift[:, i] / frame.heights[i]
                found[f"storey_{i + 1}_shear_max_over_m_w_g"] = shear[:, i] / self.g
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
            rows.append(self.columns(piece, share, basis_at(share))[0])
        return {name: np.array([row[name][0] for row in rows]) for name in rows[0]}


class _Peaks:
    """Search of the largest demands: samples first, then the pieces that can hold the largest."""

    def __init__(self, demands: Demands, course: Course) -> None:
        self.demands, self.pieces = demands, course.pieces
        self.course = course
        bounds, whole = [], []
        for piece in self.pieces:
            columns, shear, moment = demands.columns(piece, LOBATTO, AT_LOBATTO)
            dense = DENSE @ np.array(list(columns.values())).T
            size = np.abs(dense)
            reach = 0.01 * np.ptp(dense, axis=0)
            i = list(columns).index("pivot_normal_over_m_w_g")
            normal = [dense[:, i].max() + reach[i], -dense[:, i].min() + reach[i]]
            bounds.append([*(size.max(axis=0) + reach), *normal])
            inside = [DENSE @ y.reshape(len(LOBATTO), -1) for y in (shear, moment)]
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
                key = (
                    name if not sign else f"pivot_normal_{'max' if sign > 0 else 'min'}_over_m_w_g"
                )
                found[key] = -value if sign < 0 else value
        for q, name in enumerate(("shear", "moment")):
            found[f"wall_{name}"] = self._largest(
                self.whole[:, q], lambda p, q=q: self._inside(p, q))  # fmt: skip
        return self._renamed(found) | {
            "impacts": len(self.course.impacts), "lift_offs": len(self.course.lift_offs),
            "overturned": self.course.overturned, "e": self.demands.wall.straight_e(),
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
        values = self.demands.columns(piece, LOBATTO, AT_LOBATTO)[0][name]
        values = values if sign >= 0 else -values
        return _highest(values, is_signed=sign != 0)

    def _inside(self, piece: Piece, q: int) -> float:
        """Return the largest shear or moment over a piece of time and all heights."""
        values = self.demands.columns(piece, LOBATTO, AT_LOBATTO)[1 + q]
        in_time = np.tensordot(TO_CHEBYSHEV, values, 1)
        dense = np.abs(np.tensordot(DENSE, values, 1))
        tops, best = dense.max(axis=(0, 2)), -math.inf
        for p in np.flatnonzero(tops >= 0.98 * tops.max()):

            def over_height(t: float, p: int = int(p)) -> float:
                at = chebyshev.chebvander(np.array([2 * t - 1]), NODES + 5)[0]
                return _highest(at @ in_time[:, p], UP_CHEBYSHEV)

            i = int(dense[:, p].max(axis=1).argmax())
            ends = FINE[2:][[max(i - 1, 0), min(i + 1, len(dense) - 1)]]
            inner = minimize_scalar(lambda t: -over_height(t), bounds=(max(ends[0], 0.0), ends[1]),
                                    method="bounded", options={"xatol": 1e-11})  # fmt: skip
            best = max(best, -float(inner.fun), over_height(0.0), over_height(1.0))
        return best


def _highest(values: Array, to: Array = TO_CHEBYSHEV, *, is_signed: bool = False) -> float:
    """Return the largest (magnitude of a) polynomial from its values at Lobatto nodes."""
    series = to @ values
    slope = chebyshev.chebder(series)
    turns = chebyshev.chebroots(chebyshev.chebtrim(slope, 1e-15 * (np.abs(slope).max() + TINY)))
    turns = turns[np.abs(np.imag(turns)) < 1e-6].real
    turns = np.clip(turns, -1, 1)
    found = np.concatenate([values[[0, -1]], chebyshev.chebval(turns, series)])
    return float(found.max() if is_signed else np.abs(found).max())
