"""Demands of rocking walls with storeys against a program that solves for every force.

Wall and floors are single bodies: the acceleration of the wall, both forces of the foundation and
the force of every link are the unknowns of one linear system at every instant. What a section of
the wall bears is summed over the mass above it, particle by particle; between two links shear and
moment are polynomials of the height, whose largest values are taken at their ends and roots.
Nothing is shared with the kernel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import rwmf
from numpy.polynomial import Polynomial
from scenes import coupled
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

G = 9.81
H, B = 6.0, 1.5
E, XI = 0.9, 0.04
ETA = (0.8, 2.5)
OMEGA, PEAK = 4.0, 0.35
PULSE_END = 2 * math.pi / OMEGA
T_END = 3.0  # the program follows every impact: it stops before any chatter
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
GAUSS = np.polynomial.legendre.leggauss(4)
QUARTER = np.array([[0.0, 1.0], [-1.0, 0.0]])  # d turn/d theta = QUARTER @ turn


def ground(t: float) -> float:
    """Return the ground acceleration of the pulse [m/s2]."""
    return PEAK * G * math.sin(OMEGA * t) if t < PULSE_END else 0.0


def turned(theta: float) -> np.ndarray:
    """Return the matrix that turns clockwise."""
    return np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])


@dataclass
class Instant:
    """Everything at one instant, forces over m_w."""

    theta_ddot: float
    links: np.ndarray
    absolute: np.ndarray
    drift: np.ndarray
    shear: np.ndarray


class Building:
    """A wall on its corners, a straight cable, and a frame linked to its left top corner."""

    def __init__(
        self, m: list[float], k: list[float], height: list[float], coupling: str, lean: float
    ) -> None:
        self.n, self.coupling = len(m), coupling
        self.m, self.columns, self.height = np.array(m), np.array(k), np.array(height)
        self.z = np.cumsum(height)
        self.k = self.stiffness(k)
        squares, modes = eigh(self.k, np.diag(m))
        momentum = self.m[:, None] * modes
        self.c = momentum @ np.diag(2 * XI * np.sqrt(squares)) @ momentum.T
        self.share = modes[:, 0] / modes[-1, 0]
        self.places = np.array([1.0])
        if coupling == "every_floor":
            self.share = self.places = self.z / (2 * H)
            omega = math.sqrt(self.share @ self.k @ self.share / (self.m @ self.share**2))
            self.c = 2 * XI / omega * self.k
        # a leaning column pushes neighbouring floors apart
        weights = lean * G * np.cumsum(self.m[::-1])[::-1]
        self.k = self.k - self.stiffness(list(weights / self.height))
        self.rate = (ETA[1] - ETA[0]) / (self.cable(math.atan2(B, H), 1)[1] - 2 * H)

    @staticmethod
    def stiffness(k: list[float]) -> np.ndarray:
        """Assemble the matrix of storeys."""
        return np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)

    def cable(self, theta: float, side: int) -> tuple[np.ndarray, float]:
        """Return direction and length of the straight cable, from its foot to its head."""
        head = turned(theta) @ [-side * B, 2 * H] + [side * B, 0.0]
        return head / np.linalg.norm(head), float(np.linalg.norm(head))

    def pull(self, theta: float, side: int) -> np.ndarray:
        """Return the force of the cable on the wall."""
        direction, length = self.cable(theta, side)
        return -G * (ETA[0] + self.rate * (length - 2 * H)) * direction

    def roof(self, theta: float, side: int) -> tuple[float, float, float]:
        """Return the displacement of the linked corner and its derivatives by theta."""
        corner = turned(theta) @ [-B - side * B, 2 * H]
        return corner[0] + B + side * B, corner[1], -corner[0]

    def instant(self, t: float, y: np.ndarray, side: int, *, rests: bool) -> Instant:
        """Solve for all accelerations and forces."""
        theta, rate = y[:2]
        u_n, slope, bend = self.roof(theta, side)
        u, v = self.share * u_n, self.share * slope * rate
        if self.coupling == "full":
            u[:-1], v[:-1] = y[2 : self.n + 1], y[self.n + 1 :]
        resisting = self.k @ u + self.c @ v
        free = -resisting / self.m
        # links pull with: inertia of the roof's motion, and the rest that is known
        if self.coupling == "full":
            inertia = self.m[-1:]
            known = np.array([self.m[-1] * ground(t) + resisting[-1]])
        elif self.coupling == "reduced":
            inertia = np.array([self.m @ self.share**2])
            known = np.array([self.m @ self.share * ground(t) + self.share @ resisting])
        else:
            inertia = self.m * self.share
            known = self.m * ground(t) + resisting
        known = known + inertia * bend * rate**2
        links = known
        theta_ddot = 0.0
        if not rests:
            a, b = self.wall(t, y, side, known.size)
            a[3:, 0] = inertia * slope
            a[3:, 3:] = -np.eye(known.size)
            b[3:] = -known
            x = np.linalg.solve(a, b)
            theta_ddot, links = x[0], x[3:]
        u_ddot = self.share * (slope * theta_ddot + bend * rate**2)
        if self.coupling == "full":
            u_ddot[:-1] = free[:-1] - ground(t)
        drift = np.diff(u, prepend=0.0)
        return Instant(
            theta_ddot, links, u_ddot + ground(t), drift / self.height, self.columns * drift
        )

    def wall(self, t: float, y: np.ndarray, side: int, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Momentum of the wall and moments about its centroid; unknown theta'', H, N, links."""
        turn = turned(y[0])
        centre = turn @ [-side * B, H]
        arms = turn @ (self.attached(side) - np.array([side * B, 0.0])).T - centre[:, None]
        pull = self.pull(y[0], side)
        top = turn @ [0.0, H]
        a, b = np.zeros((n + 3, n + 3)), np.zeros(n + 3)
        a[:2, 0] = QUARTER @ centre
        a[0, 1], a[1, 2], a[0, 3:] = -1, -1, 1
        b[:2] = centre * y[1] ** 2 - [ground(t), G] + pull
        a[2, 0] = (H**2 + B**2) / 3
        a[2, 1:3] = [centre[1], -centre[0]]
        a[2, 3:] = arms[1]
        b[2] = top[1] * pull[0] - top[0] * pull[1]
        return a, b

    def attached(self, side: int) -> np.ndarray:
        """Return the places of the links, from the middle of the base."""
        pivot, corner = np.array([side * B, 0.0]), np.array([-B, 2 * H])
        return pivot + self.places[:, None] * (corner - pivot)

    def section(self, z: float, t: float, y: np.ndarray, side: int, now: Instant) -> np.ndarray:
        """Return the shear and the moment that the wall above a height needs from below."""
        turn = turned(y[0])
        nodes, weights = GAUSS
        up = z + (2 * H - z) * (nodes + 1) / 2
        across, high = np.meshgrid(B * nodes, up)
        part = np.outer(weights * (2 * H - z) / 2, weights * B) / (4 * H * B)
        arm = turn @ np.array([across.ravel() - side * B, high.ravel()])
        force = QUARTER @ arm * now.theta_ddot - arm * y[1] ** 2 + np.array([[ground(t)], [G]])
        force = turn.T @ (force * part.ravel())
        shear = force[0].sum()
        moment = ((high.ravel() - z) * force[0] - across.ravel() * force[1]).sum()
        outside = [(np.array([0.0, 2 * H]), self.pull(y[0], side))]
        outside += [
            (point, np.array([-pull, 0.0]))
            for point, pull in zip(self.attached(side), now.links, strict=True)
        ]
        for point, pull in outside:
            if point[1] < z:
                continue
            own = turn.T @ pull
            shear -= own[0]
            moment -= (point[1] - z) * own[0] - point[0] * own[1]
        return np.array([shear, moment])

    def inside(self, t: float, y: np.ndarray, side: int, now: Instant) -> tuple[float, float]:
        """Return the largest shear and moment over the height."""
        found = [0.0, 0.0]
        ends = np.concatenate([[0.0], 2 * H * self.places])
        for low, high in pairwise(ends):
            at = low + (high - low) * np.linspace(0.1, 0.9, 4)
            values = np.array([self.section(z, t, y, side, now) for z in at])
            for q in range(2):
                line = Polynomial.fit(at, values[:, q], 3, domain=[low, high])
                turns = line.deriv().roots()
                turns = turns[np.abs(turns.imag) < 1e-9].real
                inside = turns[(turns > low) & (turns < high)]
                found[q] = max(found[q], *np.abs(line(np.array([low, high, *inside]))))
        return found[0], found[1]

    def demands(self, t: float, y: np.ndarray, side: int, *, rests: bool) -> np.ndarray:
        """Drifts, shears, accelerations, overturning moment over weight, shear and moment."""
        now = self.instant(t, y, side, rests=rests)
        nodes, weights = GAUSS
        across, high = np.meshgrid(B * nodes, H * (nodes + 1))
        part = np.outer(weights, weights).ravel() / 4
        arm = turned(y[0]) @ np.array([across.ravel() - side * B, high.ravel()])
        push = (QUARTER @ arm * now.theta_ddot - arm * y[1] ** 2)[0] + ground(t)
        overturning = (part * push) @ arm[1] + (self.m * self.z) @ now.absolute
        overturning /= G * (1 + self.m.sum())
        shear, moment = self.inside(t, y, side, now)
        rest = [overturning, shear / G, moment / G]
        return np.abs(np.concatenate([now.drift, now.shear / G, now.absolute / G, rest]))

    def rates(self, t: float, y: np.ndarray, side: int, *, rests: bool) -> np.ndarray:
        """Return the derivative of the state."""
        now = self.instant(t, y, side, rests=rests)
        result = np.zeros_like(y)
        if not rests:
            result[:2] = [y[1], now.theta_ddot]
        if self.coupling == "full":
            result[2 : self.n + 1] = y[self.n + 1 :]
            result[self.n + 1 :] = now.absolute[:-1] - ground(t)
        return result

    def lift(self, t: float, y: np.ndarray, side: int) -> float:
        """Return the acceleration away from the base on a side."""
        return side * self.instant(t, y, side, rests=False).theta_ddot

    def largest(self) -> tuple[int, np.ndarray]:
        """Return the number of impacts, and the largest demands over all pieces of motion."""
        t, side, rests, impacts = 0.0, 1, True, 0
        y = np.zeros(2 + (2 * self.n - 2 if self.coupling == "full" else 0))
        pieces: list[tuple[Any, int, bool]] = []
        while t < T_END:
            stop = PULSE_END if t < PULSE_END else T_END
            if rests:
                events = [lambda t, y: self.lift(t, y, 1), lambda t, y: self.lift(t, y, -1)]
                for event in events:
                    event.terminal, event.direction = True, 1.0
            else:
                events = [lambda _t, y: y[0]]
                events[0].terminal, events[0].direction = True, -side
            piece = solve_ivp(
                lambda t, y, s=side, r=rests: self.rates(t, y, s, rests=r),
                (t, stop), y, events=events, dense_output=True, **TIGHT,
            )  # fmt: skip
            pieces.append((piece, side, rests))
            t, y = float(piece.t[-1]), piece.y[:, -1].copy()
            if rests and piece.status == 1:
                side, rests = (1 if piece.t_events[0].size else -1), False
            elif piece.status == 1:
                impacts += 1
                y[:2], side = [0.0, E * y[1]], -side
        return impacts, self.over_pieces(pieces)

    def over_pieces(self, pieces: list[tuple[Any, int, bool]]) -> np.ndarray:
        """Return the largest demands, between samples of 4 ms as well."""
        found = np.zeros(3 * self.n + 3)
        sampled = []
        for piece, side, rests in pieces:
            times = np.linspace(
                piece.t[0], piece.t[-1], 2 + int((piece.t[-1] - piece.t[0]) / 0.004)
            )
            values = np.array([self.demands(t, piece.sol(t), side, rests=rests) for t in times])
            sampled.append((times, values))
            found = np.maximum(found, values.max(axis=0))
        coarse = found.copy()
        for (piece, side, rests), (times, values) in zip(pieces, sampled, strict=True):
            for q in range(found.size):
                for i in np.flatnonzero(values[:, q] > 0.99 * coarse[q]):
                    low, high = times[max(i - 1, 0)], times[min(i + 1, times.size - 1)]

                    def height(t: float, now: tuple = (piece, side, rests, q)) -> float:
                        p, s, r, k = now
                        return -self.demands(t, p.sol(t), s, rests=r)[k]

                    if values[i, q] < values[max(i - 1, 0) : i + 2, q].max():
                        continue
                    best = minimize_scalar(
                        height, bounds=(low, high), method="bounded", options={"xatol": 1e-8}
                    )
                    found[q] = max(found[q], -best.fun)
        return found


@pytest.mark.parametrize("coupling", ["full", "reduced", "every_floor"])
@pytest.mark.parametrize(
    ("m", "k", "height", "lean"),
    [
        ([2.0, 2.0, 1.5], [700.0, 600.0, 400.0], [4.0, 4.0, 4.0], 0.0),
        ([1.0, 0.5, 2.0, 1.0], [900.0, 500.0, 700.0, 300.0], [4.0, 3.0, 3.0, 2.0], 1.0),
    ],
)
def test_demands_of_all_bodies(
    m: list[float], k: list[float], height: list[float], lean: float, coupling: str
) -> None:
    """Every coupling, with and without gravity on the displaced frame."""
    case = coupled(
        wall={"h": H, "b": B},
        frame={"T_s": None, "gamma": None, "xi_s": XI},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
        p_delta={"m_g_over_m_s": lean, "drift_limit": 0.5} if lean > 0 else None,
        cable={"eta_0": ETA[0], "eta_alpha": ETA[1], "law": "truss"},
        impact={"e": E},
        motion={"kind": "one_sine", "a_max_g": PEAK, "omega_p": OMEGA},
        model={"formulation": "exact"},
        solver={"t_end": T_END, "rtol": 1e-12, "method": "dop853"},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    impacts, expected = Building(m, k, height, coupling, lean).largest()
    assert int(run["impacts"]) == impacts >= 3
    numbers = range(1, len(m) + 1)
    keys = [
        *(f"storey_{i}_drift_max" for i in numbers),
        *(f"storey_{i}_shear_max_over_m_w_g" for i in numbers),
        *(f"floor_{i}_acceleration_max_g" for i in numbers),
        "overturning_moment_max_over_weight",
        "wall_shear_max_over_m_w_g",
        "wall_moment_max_over_m_w_g",
    ]
    found = [float(run[key]) for key in keys]
    assert found == pytest.approx(expected, rel=1e-7)


def test_wall_that_stands() -> None:
    """It moves with the ground: closed forms, largest at the base."""
    peak, gamma = 0.1, 0.5
    case = coupled(
        wall={"h": H, "b": B},
        frame={"gamma": gamma},
        motion={"kind": "one_sine", "a_max_g": peak, "omega_p": OMEGA},
        model={"formulation": "exact"},
        solver={"t_end": T_END},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    assert int(run["lift_offs"]) == 0
    expected = {
        "floor_1_acceleration_max_g": peak,
        "wall_shear_max_over_m_w_g": peak * (1 + gamma),
        "wall_moment_max_over_m_w_g": peak * H * (1 + 2 * gamma),
        "overturning_moment_max_over_weight": peak * H * (1 + 2 * gamma) / (1 + gamma),
    }
    # the wall's own part of the overturning moment is that of its slices: m_w u_g'' h
    for name, value in expected.items():
        assert float(run[name]) == pytest.approx(value, rel=1e-14), name
    assert float(run["wall_shear_max_height"]) == 0
    assert float(run["wall_moment_max_height"]) == 0
    assert float(run["roof_drift_max"]) == 0


def test_residual_drifts() -> None:
    """Of a frame that yields as one spring the storeys keep their shares, which add up."""
    m, k, height = [2.0, 2.0, 1.5], [700.0, 600.0, 400.0], [4.0, 4.0, 4.0]
    for coupling, strength in (
        ("reduced", {"u_y": 0.05}),
        ("every_floor", {"u_y": 0.05}),
        ("every_floor", {"storey_u_y": 0.02}),
        ("full", {"storey_u_y": 0.02}),
    ):
        case = coupled(
            wall={"h": H, "b": B},
            frame={"T_s": None, "gamma": None, "xi_s": XI},
            storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
            yielding=strength | {"hardening": 0.1},
            motion={"kind": "one_sine", "a_max_g": PEAK, "omega_p": OMEGA},
            model={"formulation": "exact"},
            solver={"t_end": T_END},
            output={"reactions": True},
        )
        run = rwmf.simulate(case)
        residual = float(run["residual_displacement"])
        assert abs(residual) > 1e-4
        assert float(run["roof_residual_drift"]) == pytest.approx(residual / (2 * H), rel=1e-14)
        largest = float(run["storey_residual_drift_max"])
        assert largest >= abs(residual) / (2 * H) * (1 - 1e-12)
        if "storey_u_y" in strength:
            drifts = [float(run[f"storey_{i}_residual_drift"]) for i in (1, 2, 3)]
            assert largest == max(map(abs, drifts))
        # the columns that yield bear no more than strength and hardening allow
        for i in (1, 2, 3):
            shear = float(run[f"storey_{i}_shear_max_over_m_w_g"])
            elastic = k[i - 1] * float(run[f"storey_{i}_drift_max"]) * height[i - 1] / G
            assert shear < elastic
