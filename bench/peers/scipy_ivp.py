"""SciPy: solve_ivp with events, as its manual has it for a bouncing ball.

One call per flight and knot: a Runge-Kutta method loses nothing at a kink of the motion. A
multistep method (LSODA) cannot stop at a kink without ending.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from peers.problem import Array, Peer, Record, Solver, Wall
from peers.walk import Flight, solver

# absolute tolerance [rad], [rad/s]: below rtol times the smallest peak
ATOL = 1e-13


def _impact(_: float, y: Array) -> float:
    return float(y[0])


def _turn(_: float, y: Array) -> float:
    return float(y[1])


_impact.terminal, _impact.direction = True, -1  # type: ignore[attr-defined]
_turn.direction = -1  # type: ignore[attr-defined]


class _Flight(Flight):
    def __init__(self, wall: Wall, method: str, rtol: float) -> None:
        self.wall, self.method, self.rtol = wall, method, rtol
        self.t, self.y = 0.0, [0.0, 0.0]

    def start(self, t: float, phi: float, phi_dot: float) -> None:
        self.t, self.y = t, [phi, phi_dot]

    def advance(self, t_end: float) -> tuple[float, float, float, bool]:
        from scipy.integrate import solve_ivp

        if self.t >= t_end:
            return t_end, self.y[1], self.y[0], False
        found = solve_ivp(
            self._rhs, (self.t, t_end), self.y, self.method, events=(_impact, _turn),
            rtol=self.rtol, atol=ATOL,
        )  # fmt: skip
        if found.status < 0:
            return t_end, math.nan, math.nan, False
        self.t, self.y = float(found.t[-1]), found.y[:, -1].tolist()
        high = max(self.y[0], *(float(state[0]) for state in found.y_events[1]), 0.0)
        return self.t, self.y[1], high, found.status == 1

    def _rhs(self, t: float, y: Array) -> list[float]:
        return [y[1], self.wall.acceleration(t, y[0], y[1])]


def _maker(method: str) -> Callable[[Record, float, float], Solver]:
    def make(record: Record, gamma: float, rtol: float) -> Solver:
        return solver(record, gamma, lambda wall: _Flight(wall, method, rtol))

    return make


PEERS = tuple(
    Peer(f"SciPy {method}, events", rtol, _maker(method), "scipy", per_band=2)
    for method, rtol in (("RK45", 1e-7), ("DOP853", 1e-7), ("LSODA", 1e-8))
)
