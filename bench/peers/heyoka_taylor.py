"""heyoka: Taylor's method of adaptive order 10 to 20, compiled for the problem, with its events.

The batch solves as many periods at once as the processor has lanes (`recommended_simd_size`). As
its manual recommends, impacts are terminal events whose callback reverses the motion, and peaks are
non-terminal events read from the dense output. Parameters of ordinates and knots are run-time
parameters, so that one compilation serves all.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from peers.problem import ETA_0, ETA_ALPHA, XI, Array, E, G, Peer, Record, Solver, Wall
from peers.walk import REST, START, lift_off

# run-time parameters: omega, side, ground, slope, origin, 1 in motion and 0 at rest
OMEGA, SIDE, GROUND, SLOPE, ORIGIN, AWAKE = range(6)
# where a lane at rest waits, away from all events [rad]
PARKED = 1.0


def _equations(gamma: float) -> list[tuple[Any, Any]]:
    """Write the equation of Wall.acceleration in heyoka's expressions."""
    import heyoka as hy

    wall = Wall(1.0, gamma)
    phi, phi_dot = hy.make_vars("phi", "phi_dot")
    omega = hy.par[OMEGA]
    s, c = hy.sin(wall.alpha - phi), hy.cos(wall.alpha - phi)
    ground = hy.par[SIDE] * (hy.par[GROUND] + hy.par[SLOPE] * (hy.time - hy.par[ORIGIN]))
    frame = s * phi_dot**2 + omega * (2 * XI * c * phi_dot + omega * (math.sin(wall.alpha) - s))
    rate = (ETA_ALPHA - ETA_0) / wall.alpha
    gravity = s + (ETA_0 + rate * phi) * math.sin(wall.alpha)
    force = 4 * gamma * c * frame + G / wall.radius * gravity
    force += (2 * gamma + 1) * c * ground / wall.radius
    moving = -hy.par[AWAKE] * force / (4 / 3 + 4 * gamma * c**2)
    return [(phi, hy.par[AWAKE] * phi_dot), (phi_dot, moving)]


class _Batch:
    """Some ordinates side by side; the state that its callbacks need."""

    def __init__(self, gamma: float, lanes: int, rtol: float) -> None:
        import heyoka as hy

        self.lanes = lanes
        self.walls: list[Wall] = []
        self.high = np.zeros(lanes)
        self.awake = np.zeros(lanes, dtype=bool)
        phi, phi_dot = hy.make_vars("phi", "phi_dot")
        down = hy.event_direction.negative
        self.solver = hy.taylor_adaptive_batch(
            _equations(gamma), np.zeros((2, lanes)), pars=np.zeros((6, lanes)), tol=rtol,
            t_events=[hy.t_event_batch(phi, callback=_Callback(self.hit), direction=down,
                                       cooldown=0.0)],
            nt_events=[hy.nt_event_batch(phi_dot, callback=_Callback(self.turn), direction=down)],
        )  # fmt: skip

    def turn(self, _: object, t: float, sign: int, lane: int) -> None:
        """Remember a peak."""
        now = np.array(self.solver.time)
        now[lane] = t
        state = self.solver.update_d_output(now)
        self.high[lane] = max(self.high[lane], float(state[0, lane]))

    def hit(self, _: object, sign: int, lane: int) -> bool:
        """Reverse the motion, or put the wall to rest."""
        solver = self.solver
        velocity = -E * float(solver.state[1, lane])
        if velocity < REST and self.walls[lane].is_pressed(float(solver.time[lane])):
            self.park(lane)
        else:
            solver.state[:, lane] = START, velocity
            solver.pars[SIDE, lane] *= -1
        return True

    def park(self, lane: int) -> None:
        """Take a lane out of the motion."""
        self.awake[lane] = False
        self.solver.pars[AWAKE, lane] = 0.0
        self.solver.state[:, lane] = PARKED, -1.0

    def lift(self, lane: int, end: float) -> float:
        """Set a wall at rest in motion; return the instant [s]."""
        wall = self.walls[lane]
        instant = lift_off(wall, end)
        self.solver.state[:, lane] = START, 0.0
        self.solver.pars[SIDE, lane], self.solver.pars[AWAKE, lane] = wall.side, 1.0
        self.awake[lane] = True
        return instant

    def peaks(self, record: Record, walls: list[Wall]) -> Array:
        """Follow as many ordinates as there are lanes through the record."""
        solver, t, a = self.solver, record.t.tolist(), record.a.tolist()
        self.walls, self.high[:] = walls, 0.0
        thresholds = np.array([wall.threshold for wall in walls])
        solver.pars[OMEGA] = [wall.omega for wall in walls]
        for lane in range(self.lanes):
            self.park(lane)
        for i in range(len(t) - 1):
            slope = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
            solver.pars[GROUND], solver.pars[SLOPE], solver.pars[ORIGIN] = a[i], slope, t[i]
            for wall in walls:
                wall.origin, wall.ground, wall.slope = t[i], a[i], slope
            begin, end = np.full(self.lanes, t[i]), np.full(self.lanes, t[i + 1])
            lifts = ~self.awake & (abs(a[i + 1]) > thresholds)
            moves = self.awake.any() or lifts.any()
            while moves:
                for lane in np.flatnonzero(lifts):
                    begin[lane] = self.lift(lane, a[i + 1])
                solver.set_time(begin)
                solver.propagate_until(end)
                self.high = np.maximum(self.high, np.where(self.awake, solver.state[0], 0.0))
                # a wall that came to rest in the interval may be lifted before its end
                begin = end.copy()
                lifts = ~self.awake & (abs(a[i + 1]) > thresholds)
                moves = lifts.any()
        return np.array(
            [wall.displacement(high) for wall, high in zip(walls, self.high, strict=True)]
        )


class _Callback:
    """Return the object itself, because heyoka copies its callbacks deeply."""

    def __init__(self, call: Callable[..., bool | None]) -> None:
        self.call = call

    def __call__(self, *arguments: object) -> bool | None:
        return self.call(*arguments)

    def __deepcopy__(self, _: object) -> _Callback:
        return self


def _make(record: Record, gamma: float, rtol: float) -> Solver:
    import heyoka as hy

    lanes = hy.recommended_simd_size()
    batch = _Batch(gamma, lanes, rtol)

    def solve(T_s: Array) -> Array:
        found = []
        for first in range(0, T_s.size, lanes):
            group = T_s[first : first + lanes]
            full = np.pad(group, (0, lanes - group.size), mode="edge")
            walls = [Wall(float(period), gamma) for period in full]
            found.append(batch.peaks(record, walls)[: group.size])
        return np.concatenate(found)

    return solve


PEERS = (Peer("heyoka, batch with events", 1e-8, _make, "heyoka"),)
