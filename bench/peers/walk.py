"""The hybrid loop around an integrator that knows flights only: knots, impacts, lift-off, rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from peers.problem import Array, E, Record, Solver, Wall

# A root finder that starts on theta = 0 finds it again: a flight starts this high [rad]. Impact
# velocities below sqrt(2 height acceleration) are not resolved.
START = 1e-20
# After an impact slower than this, on a wall that is pressed down, the rest of the chatter lasts
# less than 1e-8 s [rad/s].
REST = 1e-9


class Flight(Protocol):
    """An integrator of one ordinate between impacts."""

    wall: Wall

    def start(self, t: float, phi: float, phi_dot: float) -> None:
        """Begin a flight."""

    def advance(self, t_end: float) -> tuple[float, float, float, bool]:
        """Go on to t_end or to an impact.

        Returns time [s], velocity [rad/s], largest |theta| since the last call [rad], and whether
        it ended with an impact. The motion has a kink at t_end.
        """


def solver(record: Record, gamma: float, make_flight: Callable[[Wall], Flight]) -> Solver:
    """Make a solver of an integrator."""

    def solve(T_s: Array) -> Array:
        walls = [Wall(float(period), gamma) for period in T_s]
        return np.array([peak(make_flight(wall), record) for wall in walls])

    return solve


def peak(flight: Flight, record: Record) -> float:
    """Follow an ordinate from rest to the end of the record."""
    wall, t, a = flight.wall, record.t.tolist(), record.a.tolist()
    largest, rests = 0.0, True
    for i in range(len(t) - 1):
        wall.origin, wall.ground = t[i], a[i]
        wall.slope = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
        hit = True
        while hit:
            if rests and abs(a[i + 1]) <= wall.threshold:
                break
            if rests:
                flight.start(lift_off(wall, a[i + 1]), START, 0.0)
            now, velocity, high, hit = flight.advance(t[i + 1])
            largest, rests = max(largest, high), False
            if hit:
                wall.side, velocity = -wall.side, -E * velocity
                rests = velocity < REST and wall.is_pressed(now)
                if not rests:
                    flight.start(now, START, velocity)
    return wall.displacement(largest)


def lift_off(wall: Wall, end: float) -> float:
    """Find the instant at which the motion lifts a wall at rest [s], and the side."""
    wall.side = -math.copysign(1.0, end)
    late = (-wall.side * wall.threshold - wall.ground) / wall.slope if wall.slope else 0.0
    return wall.origin + max(late, 0.0)
