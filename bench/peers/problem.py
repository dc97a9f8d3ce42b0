"""Problem that all programs of the comparison solve, and interface of a peer.

A wall of the paper under El Centro, `symmetric`, linear cable, constant e: Eq. (8) of the paper
and its mirror image in |theta|. The numbers stand here once; `case` states them to the kernel.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf

Array = npt.NDArray[np.float64]
Solver = Callable[[Array], Array]
"""Periods [s] to peaks |u_s| [m]."""

G = 9.81
H, B, XI, ETA_0, ETA_ALPHA, E = 2.0, 0.5, 0.05, 1.0, 5.0, 0.9
GAMMAS = (5.0, 1800.0)
BANDS = ((0.05, 0.2), (0.2, 0.5), (0.5, 3.0))
"""Periods [s] in which an ordinate costs about the same; the last one includes its end."""


@dataclass(frozen=True)
class Record:
    """Ground motion: its file, times [s] and accelerations [m/s2], both (samples,)."""

    path: Path
    t: Array
    a: Array

    @property
    def interval(self) -> float:
        """Interval of the samples, which is constant [s]."""
        return float(self.t[-1]) / (self.t.size - 1)


@dataclass(frozen=True)
class Peer:
    """A program to compare with."""

    name: str
    """As in the table."""
    rtol: float
    """Relative tolerance that it is given [-]; nan where it has none."""
    make: Callable[[Record, float, float], Solver]
    """Make a solver from record, gamma and rtol, with all compilation and allocation."""
    package: str = ""
    """That it imports; '' for none."""
    distribution: str = ""
    """Name under which that is installed, if it is another one."""
    per_band: int = 0
    """Periods of each band that it is measured on, 0 for all: a slow one."""

    @property
    def is_installed(self) -> bool:
        """Tell whether its package can be imported."""
        return not self.package or importlib.util.find_spec(self.package) is not None


def read_record(path: Path) -> Record:
    """Read a two-column record in g with equal intervals."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line[:1].isdigit()]
    samples = np.array([[float(word) for word in line.split(",")] for line in lines])
    return Record(path, samples[:, 0], G * samples[:, 1])


def case(record: Record, method: str, rtol: float, **groups: object) -> rwmf.Case:
    """State the problem to the kernel."""
    scene: dict[str, object] = {
        "wall": {"h": H, "b": B},
        "frame": {"gamma": GAMMAS[0], "xi_s": XI},
        "cable": {"eta_0": ETA_0, "eta_alpha": ETA_ALPHA},
        "impact": {"e": E},
        "model": {"formulation": "symmetric", "g": G},
    }
    return rwmf.Case(
        **{
            **scene,
            "motion": {"kind": "record", "file": str(record.path), "unit": "g"},
            "solver": {"method": method, "rtol": rtol},
            "spectrum": {"T_s": [1.0]},
            **groups,
        }
    )


def bands(T_s: Array) -> list[npt.NDArray[np.int64]]:
    """Sort periods into the bands."""
    edges = [band[0] for band in BANDS[1:]]
    number = np.searchsorted(edges, T_s, side="right")
    found = [np.flatnonzero(number == k) for k in range(len(BANDS))]
    return [indices for indices in found if indices.size > 0]


@dataclass
class Wall:
    """The equation of one ordinate, in |theta|; the interval of the motion in force."""

    T_s: float
    gamma: float
    side: float = 1.0
    """Sign of theta."""
    origin: float = 0.0
    """Beginning of the interval [s]."""
    ground: float = 0.0
    """Ground acceleration there [m/s2]."""
    slope: float = 0.0
    """Its rate in the interval [m/s3]."""

    def __post_init__(self) -> None:
        """Derive the coefficients of the equation."""
        self.alpha, self.radius = math.atan2(B, H), math.hypot(H, B)
        self.omega = 2 * math.pi / self.T_s
        self.rate = (ETA_ALPHA - ETA_0) / self.alpha
        self.threshold = G * math.tan(self.alpha) * (1 + ETA_0) / (1 + 2 * self.gamma)

    def acceleration(self, t: float, phi: float, phi_dot: float) -> float:
        """Second derivative of |theta| [rad/s2]."""
        s, c = math.sin(self.alpha - phi), math.cos(self.alpha - phi)
        lift = math.sin(self.alpha) - s
        ground = self.side * (self.ground + self.slope * (t - self.origin))
        frame = s * phi_dot**2 + self.omega * (2 * XI * c * phi_dot + self.omega * lift)
        gravity = s + (ETA_0 + self.rate * phi) * math.sin(self.alpha)
        force = 4 * self.gamma * c * frame + G / self.radius * gravity
        force += (2 * self.gamma + 1) * c * ground / self.radius
        return -force / (4 / 3 + 4 * self.gamma * c**2)

    def is_pressed(self, t: float) -> bool:
        """Tell whether the motion presses a wall at rest down at t [s]."""
        return abs(self.ground + self.slope * (t - self.origin)) < self.threshold

    def displacement(self, phi: float) -> float:
        """|u_s| [m]."""
        return 2 * self.radius * (math.sin(self.alpha) - math.sin(self.alpha - phi))
