"""scikit-sundae: CVODE from Python, callbacks in Python, with CVODE's own root finder.

Knots are stop times, so that the method keeps its order there; an impact begins a new run.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from peers.problem import Array, Peer, Record, Solver, Wall
from peers.walk import Flight, solver

# status of a step that ended with an event
ROOT = 2


class _Flight(Flight):
    def __init__(self, wall: Wall, method: str, rtol: float) -> None:
        from sksundae.cvode import CVODE

        def rhs(t: float, y: Array, y_dot: Array) -> None:
            y_dot[0] = y[1]
            y_dot[1] = wall.acceleration(t, float(y[0]), float(y[1]))

        def roots(_: float, y: Array, g: Array) -> None:
            g[0], g[1] = y[0], y[1]

        roots.terminal = [True, True]  # type: ignore[attr-defined]
        roots.direction = [-1, -1]  # type: ignore[attr-defined]
        self.wall = wall
        self.solver = CVODE(
            rhs, method=method, rtol=rtol, atol=rtol * np.array([1e-3, 1e-3 * wall.omega]),
            eventsfn=roots, num_events=2, max_num_steps=100_000,
        )  # fmt: skip
        self.t, self.high = 0.0, 0.0

    def start(self, t: float, phi: float, phi_dot: float) -> None:
        self.t = t
        self.solver.init_step(t, [phi, phi_dot])

    def advance(self, t_end: float) -> tuple[float, float, float, bool]:
        high = 0.0
        while self.t < t_end:
            found = self.solver.step(t_end, tstop=t_end)
            if found.status < 0:
                return t_end, math.nan, math.nan, False
            self.t = float(found.t)
            phi, phi_dot = (float(value) for value in found.y)
            high = max(high, phi)
            # the list of events grows from the start of the run
            if found.status == ROOT and found.i_events[-1][0]:
                return self.t, phi_dot, high, True
        return t_end, math.nan, high, False


def _maker(method: str) -> Callable[[Record, float, float], Solver]:
    def make(record: Record, gamma: float, rtol: float) -> Solver:
        return solver(record, gamma, lambda wall: _Flight(wall, method, rtol))

    return make


PEERS = tuple(
    Peer(f"scikit-sundae {method}", 1e-9, _maker(method), "sksundae", "scikit-sundae", per_band=2)
    for method in ("Adams", "BDF")
)
