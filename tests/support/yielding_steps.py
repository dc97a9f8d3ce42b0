"""Bare frames whose storeys yield one by one, solved in small steps without the kernel.

DOP853 of SciPy advances displacements, velocities and either plastic displacements or the variable
z of Bouc and Wen, with the branches of the storeys held. A step is at most `STRIDE` of the fastest
mode. Every step is sampled densely. The first sampled change of a branch is refined by Brent's
method, and demands are the largest samples with a parabola through each of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq
from yielding import slowly_unloaded

Array = np.ndarray
STRIDE = 0.25  # angle of the fastest mode in a step [rad]
SAMPLES = 24  # per step
_G = 9.81


class Frame:
    """A shear frame whose storeys yield, from the groups of a case.

    Parameters
    ----------
    groups : dict
        Groups of a case that `is_covered`, with masses and stiffnesses over one unit.
    pairs : list of tuple
        Time [s] and acceleration [m/s2] of the ground, zero after the last.
    """

    def __init__(self, groups: dict[str, dict[str, Any]], pairs: list[tuple[float, float]]) -> None:
        storeys, law = groups["storeys"], groups["yielding"]
        self.m, self.k = (np.array(storeys[key + "_over_m_w"]) for key in "mk")
        self.height, self.u_y = np.array(storeys["height"]), np.array(law["storey_u_y"])
        self.n = n = self.m.size
        self.is_smooth = law.get("law") == "bouc_wen"
        self.hardening = law.get("hardening", 0.0)
        self.breakaway = law.get("breakaway", 1.0)
        self.exponent, self.beta = law.get("exponent", 2.0), law.get("beta", 0.5)
        self.t, self.a = (np.array(values) for values in zip(*pairs, strict=True))
        self.t_end = groups["solver"]["t_end"]
        gravity = groups.get("p_delta", {"m_g_over_m_s": 0.0, "drift_limit": math.inf})
        self.load = _G * gravity["m_g_over_m_s"] * np.cumsum(self.m[::-1])[::-1] / self.height
        limit = gravity.get("drift_limit", 0.1) * self.height
        self.limit = np.minimum(limit, law.get("ultimate", math.inf) * self.u_y)
        self.drift = np.eye(n) - np.eye(n, k=-1)
        root = np.sqrt(self.m)
        square, shape = np.linalg.eigh(
            self.drift.T @ np.diag(self.k) @ self.drift / np.outer(root, root)
        )
        self.omega = np.sqrt(square)
        modal = shape @ np.diag(2 * groups["frame"]["xi_s"] * self.omega) @ shape.T
        self.damping = modal * np.outer(root, root)
        # of each storey: 1 and -1 its direction (smooth) or on a bound, 0 elastic
        self.way, self.sign = np.zeros(n), np.zeros(n)
        self.largest = np.zeros(4 * n)

    def _parts(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """Return displacements and rates of the storeys, memory, and forces of the columns."""
        n = self.n
        d, rate, memory = self.drift @ y[:n], self.drift @ y[n : 2 * n], y[2 * n :]
        if self.is_smooth:
            force = self.hardening * d + (1 - self.hardening) * (memory.T * self.u_y).T
        else:
            force = d - memory
        return d, rate, memory, (force.T * self.k).T

    def _rates(self, t: float | Array, y: Array) -> Array:
        """Return the rates of states, of which each may have a column per time."""
        n = self.n
        d, rate, memory, force = self._parts(y)
        push = self.drift.T @ (force - (d.T * self.load).T) + self.damping @ y[n : 2 * n]
        a = np.interp(t, self.t, self.a, right=0.0)
        flow = np.where(self.way != 0, 1 - self.hardening, 0.0)
        if self.is_smooth:
            lost = np.where(self.way * self.sign < 0, 1 - 2 * self.beta, 1.0)
            power = np.abs(memory.T) ** (self.exponent - 1)
            power = np.where(self.sign != 0, self.sign * memory.T, np.abs(memory.T)) * power
            flow = (1 - lost * power) / self.u_y
        return np.concatenate((y[n : 2 * n], (-push.T / self.m).T - a, (flow * rate.T).T))

    def _margins(self, y: Array) -> Array:
        """Return a function that is positive until a storey changes its branch or collapses."""
        d, rate, memory, force = self._parts(y)
        turn = np.where(self.way != 0, self.way * rate.T, 1.0)
        if self.is_smooth:
            other = np.where(self.sign != 0, self.sign * memory.T, 1.0)
        else:
            over = np.abs(self._over(memory, force))
            other = np.where(self.way == 0, self.breakaway - over, 1.0)
        return np.concatenate((turn, other, self.limit - np.abs(d.T)), axis=-1).T

    def _margin(self, t: float, state: Callable[[float], Array], number: int) -> float:
        return float(self._margins(state(t))[number])

    def _over(self, memory: Array, force: Array) -> Array:
        """Return the forces over those of yielding without hardening, storeys in the last axis."""
        harder = self.hardening / (1 - self.hardening) * self.k * memory.T
        return (force.T - harder) / (self.k * self.u_y)

    def _demands(self, t: Array, y: Array) -> Array:
        d, _, _, force = self._parts(y)
        a = np.interp(t, self.t, self.a, right=0.0)
        v_dot = self._rates(t, y)[self.n : 2 * self.n]
        return np.abs(np.concatenate((d, d, force, v_dot + a)))

    def _observe(self, state: Callable[[Array], Array], t: Array) -> None:
        """Let the samples of a step count, and the vertices of parabolas through the largest."""
        found = self._demands(t, state(t))
        k = np.clip(found.argmax(axis=1), 1, t.size - 2)
        low, top, high = (found[np.arange(k.size), k + i] for i in (-1, 0, 1))
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = np.nan_to_num(0.5 * (low - high) / (low - 2 * top + high))
        vertex = np.clip(t[k] + shift * (t[1] - t[0]), t[0], t[-1])
        near = found.max(axis=1) > 0.99 * self.largest
        self.largest = np.maximum(self.largest, found.max(axis=1))
        if near.any():
            values = np.diagonal(self._demands(vertex[near], state(vertex[near]))[near])
            self.largest[near] = np.maximum(self.largest[near], values)

    def _change(self, number: int, y: Array) -> None:
        """Let a storey go to its next branch at an instant."""
        kind, i = divmod(number, self.n)
        _, _, memory, force = self._parts(y)
        if kind == 0:
            self.way[i] = -self.way[i] if self.is_smooth else 0.0
        elif self.is_smooth:
            self.sign[i] = -self.sign[i]
        else:
            self.way[i] = math.copysign(1.0, self._over(memory, force)[i])
            slip = (self.breakaway - 1) * self.u_y[i] * (1 - self.hardening)
            y[2 * self.n + i] += self.way[i] * slip

    def follow(self) -> dict[str, float]:
        """Return the demands and residual drifts of the run, by the names of the kernel."""
        n = self.n
        t, y = 0.0, np.zeros(3 * n)
        begin = 0.01 / self.omega[-1]  # until then smooth storeys only load
        stops = np.unique([begin, *self.t[self.t < self.t_end], self.t_end])[1:]
        scale = np.concatenate((self.u_y, self.u_y * self.omega[0],
                                np.ones(n) if self.is_smooth else self.u_y))  # fmt: skip
        for stop in stops:
            while t < stop:
                if self.is_smooth and t > 0:
                    self._take_signs(y)
                t, y, number = self._piece(t, y, stop, 1e-13 * scale)
                if number >= 2 * n:
                    return self._results(y)
                if number >= 0:
                    self._change(number, y)
        return self._results(y)

    def _take_signs(self, y: Array) -> None:
        _, rate, memory, _ = self._parts(y)
        self.way = np.where(self.way == 0, np.sign(rate), self.way)
        self.sign = np.where(self.sign == 0, np.sign(memory), self.sign)

    def _piece(self, t: float, y: Array, stop: float, atol: Array) -> tuple[float, Array, int]:
        """Go on to a time or the first change; return time, state and the change or -1."""
        solver = DOP853(self._rates, t, y, stop, max_step=STRIDE / self.omega[-1], rtol=1e-12,
                        atol=atol)  # fmt: skip
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(message)
            state = solver.dense_output()
            times = np.linspace(solver.t_old, solver.t, SAMPLES)
            margins = self._margins(state(times))
            late = np.flatnonzero((margins[:, :2] < 0).all(axis=1))
            if late.size:  # a turn of round-off, or a storey that hardly moves yet
                return solver.t_old, state(solver.t_old), int(late[0])
            passes = (margins[:, 1:] < 0) & (margins[:, :-1] >= 0)
            if passes.any():
                column = int(passes.any(axis=0).argmax())
                low, high = times[column : column + 2]
                roots = {
                    brentq(self._margin, low, high, args=(state, i), xtol=1e-15): i
                    for i in np.flatnonzero(passes[:, column])
                }
                end = min(roots)
                self._observe(state, np.linspace(solver.t_old, end, SAMPLES))
                return end, state(end), int(roots[end])
            self._observe(state, times)
        return float(solver.t), solver.y, -1

    def _results(self, y: Array) -> dict[str, float]:
        d, _, memory, _ = self._parts(y)
        left = memory.copy()
        if self.is_smooth:
            left = np.array([slowly_unloaded(*values, self.hardening, self.beta, self.exponent)
                             for values in zip(d, memory, self.u_y, strict=True)])  # fmt: skip
        elif self.hardening > 0:
            most = (1 - self.hardening) / self.hardening * self.u_y
            left = np.clip(left, -most, most)
        drift, ductility, shear, acceleration = self.largest.reshape(4, self.n)
        columns = {
            "storey_{}_ductility": ductility / self.u_y,
            "storey_{}_residual_drift": left / self.height,
            "storey_{}_drift_max": drift / self.height,
            "storey_{}_shear_max_over_m_w_g": shear / _G,
            "floor_{}_acceleration_max_g": acceleration / _G,
        }
        return {name.format(i + 1): float(value) for name, values in columns.items()
                for i, value in enumerate(values)}  # fmt: skip
