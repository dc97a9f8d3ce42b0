"""A rocking ordinate as a user of SciPy would compute it: solve_ivp with events, knot by knot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
G = 9.81


@dataclass
class Wall:
    """Eq. (8) and its mirror image with a linear cable; the piece of motion in force."""

    h: float
    b: float
    T_s: float
    gamma: float
    xi: float
    eta_0: float
    eta_alpha: float
    side: float = 1.0
    origin: float = 0.0
    ground: float = 0.0
    slope: float = 0.0

    def __post_init__(self) -> None:
        """Derive what the equation needs."""
        self.alpha, self.radius = math.atan2(self.b, self.h), math.hypot(self.h, self.b)
        self.omega = 2 * math.pi / self.T_s
        self.rate = (self.eta_alpha - self.eta_0) / self.alpha
        self.threshold = G * math.tan(self.alpha) * (1 + self.eta_0) / (1 + 2 * self.gamma)

    def rhs(self, t: float, y: Array) -> list[float]:
        """Return the derivatives of |theta| and its rate."""
        s, c = math.sin(self.alpha - y[0]), math.cos(self.alpha - y[0])
        lift = math.sin(self.alpha) - s
        ground = self.side * (self.ground + self.slope * (t - self.origin))
        frame = s * y[1] ** 2 + self.omega * (2 * self.xi * c * y[1] + self.omega * lift)
        gravity = s + (self.eta_0 + self.rate * y[0]) * math.sin(self.alpha)
        force = 4 * self.gamma * c * frame + G / self.radius * gravity
        force += (2 * self.gamma + 1) * c * ground / self.radius
        return [y[1], -force / (4 / 3 + 4 * self.gamma * c**2)]

    def displacement(self, phi: float) -> float:
        """Return |u_s| [m]."""
        return 2 * self.radius * (math.sin(self.alpha) - math.sin(self.alpha - phi))


def _impact(_: float, y: Array) -> float:
    return float(y[0])


def _turn(_: float, y: Array) -> float:
    return float(y[1])


_impact.terminal, _impact.direction = True, -1  # type: ignore[attr-defined]


def read_record(path: Path) -> tuple[Array, Array]:
    """Return times [s] and accelerations [m/s2] of a two-column record in g."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line[:1].isdigit()]
    samples = np.array([[float(word) for word in line.split(",")] for line in lines])
    return samples[:, 0], G * samples[:, 1]


def peak(wall: Wall, e: float, rtol: float, t: Array, a: Array) -> float:
    """Return the largest |u_s| [m] by DOP853, stopped at every knot and at every impact."""
    from scipy.integrate import solve_ivp

    y, largest, rests = np.zeros(2), 0.0, True
    for i in range(t.size - 1):
        wall.origin, wall.ground = t[i], a[i]
        wall.slope = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
        start = t[i]
        if rests:
            if abs(a[i + 1]) <= wall.threshold:
                continue
            # the instant at which the line through both samples passes the threshold
            wall.side = -math.copysign(1.0, a[i + 1])
            start = max(start, start + (-wall.side * wall.threshold - a[i]) / wall.slope)
            y, rests = np.zeros(2), False
        while start < t[i + 1]:
            found = solve_ivp(
                wall.rhs, (start, t[i + 1]), y, "DOP853", None, False, (_impact, _turn),
                rtol=rtol, atol=1e-13,
            )  # fmt: skip
            y = found.y[:, -1]
            largest = max([largest, y[0], *(state[0] for state in found.y_events[1])])
            if found.status == 0:
                break
            start = found.t[-1]
            # SciPy finds the contact that it starts on a second time unless it is moved
            y, wall.side = np.array([1e-15, -e * y[1]]), -wall.side
            rests = max(abs(a[i]), abs(a[i + 1])) < wall.threshold and y[1] < 1e-7
            if rests:
                break
    return wall.displacement(largest)
