"""Programs beside rwmf that solve the same problem: displacement spectra of the paper's wall.

The problem: formulation `symmetric`, linear cable, constant e; Eq. (8) of the paper and its mirror
image in |theta|. `Wall` has the equation, `case` states it to the kernel. Packages of peers are
imported when they are used.
"""

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import rwmf

Array = npt.NDArray[np.float64]

G = 9.81
H, B, XI, ETA_0, ETA_ALPHA, E = 2.0, 0.5, 0.05, 1.0, 5.0, 0.9
GAMMAS = (5.0, 1800.0)
# absolute tolerance [rad], [rad/s]: below rtol times the smallest peak
ATOL = 1e-13
# A root finder that starts on theta = 0 finds it again: a flight starts this high [rad]. Impact
# velocities below sqrt(2 height acceleration) are not resolved.
START = 1e-20
# After an impact slower than this, on a wall that is pressed down, the rest of the chatter lasts
# less than 1e-8 s [rad/s].
REST = 1e-9


class Record(NamedTuple):
    """Ground motion: its file, times [s] and accelerations [m/s2], both (samples,)."""

    path: Path
    t: Array
    a: Array


class Peer(NamedTuple):
    """A program to compare with."""

    name: str  # as in the table
    package: str  # that it imports
    rtol: float  # that it is given [-]
    per_band: int  # periods of each band that it is measured on, 0 for all
    # Peaks |u_s| [m] from record, gamma, rtol and periods [s]
    peaks: Callable[[Record, float, float, Array], Array]

    @property
    def is_installed(self) -> bool:
        """Tell whether its package can be imported."""
        return importlib.util.find_spec(self.package) is not None


def read_record(path: Path) -> Record:
    """Read a two-column record in g."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line[:1].isdigit()]
    t, a = np.array([[float(word) for word in line.split(",")] for line in lines]).T
    return Record(path, t, G * a)


def case(record: Record, method: str, rtol: float) -> rwmf.Case:
    """State the problem to the kernel."""
    return rwmf.Case(
        wall={"h": H, "b": B},
        frame={"gamma": GAMMAS[0], "xi_s": XI},
        cable={"eta_0": ETA_0, "eta_alpha": ETA_ALPHA},
        impact={"e": E},
        model={"formulation": "symmetric", "g": G},
        motion={"kind": "record", "file": str(record.path), "unit": "g"},
        solver={"method": method, "rtol": rtol},
        spectrum={"T_s": [1.0]},
    )


@dataclass
class Wall:
    """The equation of one ordinate, in |theta|; the interval of the motion in force."""

    T_s: float
    gamma: float
    side: float = 1.0  # sign of theta
    origin: float = 0.0  # beginning of the interval [s]
    ground: float = 0.0  # ground acceleration there [m/s2]
    slope: float = 0.0  # its rate in the interval [m/s3]

    def __post_init__(self) -> None:
        """Derive the coefficients of the equation."""
        self.alpha, self.radius = math.atan2(B, H), math.hypot(H, B)
        self.omega = 2 * math.pi / self.T_s
        self.rate = (ETA_ALPHA - ETA_0) / self.alpha
        self.threshold = G * math.tan(self.alpha) * (1 + ETA_0) / (1 + 2 * self.gamma)

    def rates(self, t: float, y: Array) -> list[float]:
        """Return the rates of |theta| and of its velocity."""
        phi, phi_dot = y
        s, c = math.sin(self.alpha - phi), math.cos(self.alpha - phi)
        lift = math.sin(self.alpha) - s
        frame = s * phi_dot**2 + self.omega * (2 * XI * c * phi_dot + self.omega * lift)
        gravity = s + (ETA_0 + self.rate * phi) * math.sin(self.alpha)
        force = 4 * self.gamma * c * frame + G / self.radius * gravity
        force += (2 * self.gamma + 1) * c * self.side * self.motion(t) / self.radius
        return [phi_dot, -force / (4 / 3 + 4 * self.gamma * c**2)]

    def motion(self, t: float) -> float:
        """Return the acceleration of the ground [m/s2]."""
        return self.ground + self.slope * (t - self.origin)

    def lift_off(self, end: float) -> float:
        """Find the instant at which the motion lifts a wall at rest [s], and the side."""
        self.side = -math.copysign(1.0, end)
        late = (-self.side * self.threshold - self.ground) / self.slope if self.slope else 0.0
        return self.origin + max(late, 0.0)

    def displacement(self, phi: float) -> float:
        """|u_s| [m]."""
        return 2 * self.radius * (math.sin(self.alpha) - math.sin(self.alpha - phi))


def _impact(_: float, y: Array) -> float:
    return float(y[0])


def _turn(_: float, y: Array) -> float:
    return float(y[1])


_impact.terminal, _impact.direction = True, -1  # type: ignore[attr-defined]
_turn.direction = -1  # type: ignore[attr-defined]


def _by_scipy(record: Record, gamma: float, rtol: float, T_s: Array) -> Array:
    """Call `solve_ivp` with events, as its manual has it, once per flight and knot."""
    return np.array([_peak(rtol, record, Wall(float(x), gamma)) for x in T_s])


def _peak(rtol: float, record: Record, wall: Wall) -> float:
    from scipy.integrate import solve_ivp

    t, a = record.t.tolist(), record.a.tolist()
    largest, rests, now, y = 0.0, True, 0.0, [0.0, 0.0]
    for i in range(len(t) - 1):
        wall.origin, wall.ground = t[i], a[i]
        wall.slope = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
        hit = True
        while hit and not (rests and abs(a[i + 1]) <= wall.threshold):
            if rests:
                now, y = wall.lift_off(a[i + 1]), [START, 0.0]
            rests = hit = False
            if now >= t[i + 1]:
                break
            found = solve_ivp(wall.rates, (now, t[i + 1]), y, "DOP853", events=(_impact, _turn),
                              rtol=rtol, atol=ATOL)  # fmt: skip
            if found.status < 0:
                return math.nan
            now, y, hit = float(found.t[-1]), found.y[:, -1].tolist(), found.status == 1
            largest = max(largest, y[0], *(float(top[0]) for top in found.y_events[1]))
            if hit:
                wall.side, y = -wall.side, [START, -E * y[1]]
                rests = y[1] < REST and abs(wall.motion(now)) < wall.threshold
    return wall.displacement(largest)


# Dormand and Prince (1980), Table 2
TABLEAU = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
PLACES = TABLEAU.sum(axis=1)
ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@cache
def _compiled() -> Callable[..., Any]:
    """Compile the pair of Dormand and Prince as one loop over a record for one ordinate.

    This is the program of a numba user who knows the problem. Steps end at knots; a step with an
    impact or a peak is repeated with a shorter length.
    """
    import numba

    jit = numba.njit(fastmath=True, error_model="numpy")

    @jit
    def acceleration(p: Array, ground: float, phi: float, phi_dot: float) -> float:
        alpha, sin_alpha, omega, gamma, radius, rate = p[0], p[1], p[2], p[3], p[4], p[5]
        s, c = math.sin(alpha - phi), math.cos(alpha - phi)
        frame = s * phi_dot**2 + omega * (2 * XI * c * phi_dot + omega * (sin_alpha - s))
        gravity = s + (ETA_0 + rate * phi) * sin_alpha
        force = 4 * gamma * c * frame + G / radius * gravity
        force += (2 * gamma + 1) * c * ground / radius
        return -force / (4 / 3 + 4 * gamma * c * c)

    @jit
    def step(
        p: Array, ground: float, slope: float, h: float, phi: float, v: float, k: Array
    ) -> tuple[float, float, float, float]:
        """State after h, and the estimated errors."""
        x, y = phi, v
        for i in range(7):
            x, y = phi, v
            for j in range(i):
                x += h * TABLEAU[i, j] * k[j, 0]
                y += h * TABLEAU[i, j] * k[j, 1]
            k[i, 0], k[i, 1] = y, acceleration(p, ground + PLACES[i] * h * slope, x, y)
        off_x = off_y = 0.0
        for i in range(7):
            off_x += h * ERROR[i] * k[i, 0]
            off_y += h * ERROR[i] * k[i, 1]
        return x, y, off_x, off_y

    @jit
    def locate(
        p: Array, ground: float, slope: float, low: float, high: float, phi: float, v: float,
        k: Array, which: int,
    ) -> tuple[float, float, float]:  # fmt: skip
        """Length at which phi (0) or its rate (1) falls through 0, and the state there."""
        h = 0.5 * (low + high)
        x = y = 0.0
        for _ in range(60):
            x, y, _, _ = step(p, ground, slope, h, phi, v, k)
            value, rate = (x, y) if which == 0 else (y, k[6, 1])
            low, high = (h, high) if value > 0 else (low, h)
            new = h - value / rate
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - h) <= 1e-15 + 4e-16 * h:
                break
            h = new
        return h, x, y

    @jit
    def peak(p: Array, threshold: float, rtol: float, t: Array, a: Array) -> float:
        """Largest |theta| from rest to the end of the record [rad]."""
        k = np.zeros((7, 2))
        phi = v = largest = 0.0
        side, rests, trial = 1.0, True, t[1] - t[0]
        for i in range(t.size - 1):
            now, slope = t[i], (a[i + 1] - a[i]) / (t[i + 1] - t[i])
            while now < t[i + 1]:
                if rests:
                    if abs(a[i + 1]) <= threshold:
                        break
                    side = -1.0 if a[i + 1] > 0 else 1.0
                    if slope != 0:
                        now = max(now, t[i] + (-side * threshold - a[i]) / slope)
                    phi, v, rests = 0.0, 0.0, False
                left = t[i + 1] - now
                h = min(trial, left)
                ground = side * (a[i] + slope * (now - t[i]))
                x, y, off_x, off_y = step(p, ground, side * slope, h, phi, v, k)
                ratio = max(
                    abs(off_x) / (ATOL + rtol * max(abs(phi), abs(x))),
                    abs(off_y) / (ATOL + rtol * max(abs(v), abs(y))),
                )
                trial = h * min(5.0, max(0.2, 0.9 * max(ratio, 1e-10) ** -0.2))
                if ratio > 1:
                    continue
                low = 0.0
                if v > 0 and y < 0:
                    low, top, _ = locate(p, ground, side * slope, 0.0, h, phi, v, k, 1)
                    largest = max(largest, top)
                largest = max(largest, x)
                if x < 0:
                    h, _, y = locate(p, ground, side * slope, low, h, phi, v, k, 0)
                    x, y, side = 0.0, -E * y, -side
                    rests = y < REST and abs(a[i] + slope * (now + h - t[i])) < threshold
                phi, v = x, y
                now = t[i + 1] if h == left else now + h
        return largest

    return peak


def _by_numba(record: Record, gamma: float, rtol: float, T_s: Array) -> Array:
    found = []
    for wall in (Wall(float(x), gamma) for x in T_s):
        p = np.array([wall.alpha, math.sin(wall.alpha), wall.omega, gamma, wall.radius, wall.rate])
        phi = _compiled()(p, wall.threshold, rtol, record.t, record.a)
        found.append(wall.displacement(phi))
    return np.array(found)


PEERS = (
    Peer("numba, Dormand-Prince 5(4)", "numba", 1e-7, 0, _by_numba),
    Peer("SciPy DOP853, events", "scipy", 1e-7, 2, _by_scipy),
)
