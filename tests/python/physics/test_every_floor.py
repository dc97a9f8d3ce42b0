"""Reactions of a wall whose floors are all linked, against a program that solves for every force.

The kernel has one equation in the rotation, and takes the reactions from the balance of momentum
of the whole. Here wall and floors are single bodies: accelerations, both forces of the foundation
and the force of every link are the unknowns of one linear system at every instant.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import rwmf
from scenes import coupled
from scipy.integrate import solve_ivp

G = 9.81
H, B = 6.0, 1.5
E = 0.9
OMEGA, PEAK = 4.0, 0.35
PULSE_END = 2 * math.pi / OMEGA
T_END = 3.0  # the program below follows every impact: it stops before any chatter
DT = 0.01
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}


def ground(t: float) -> float:
    """Return the ground acceleration of the pulse [m/s2]."""
    return PEAK * G * math.sin(OMEGA * t) if t < PULSE_END else 0.0


class Bodies:
    """A wall and its floors; the link of floor i sits at its share of the way to the roof's corner.

    Parameters
    ----------
    m, k, height : list of float
        Masses and stiffnesses over the mass of the wall, heights of the storeys, from the ground
        up [-], [1/s2], [m].
    xi : float
        Damping ratio of the straight line [-].
    """

    def __init__(self, m: list[float], k: list[float], height: list[float], xi: float) -> None:
        self.m = np.array(m)
        self.share = np.cumsum(height) / (2 * H)
        self.k = np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
        omega = math.sqrt(self.share @ self.k @ self.share / (self.m @ self.share**2))
        self.c = 2 * xi / omega * self.k

    def solve(self, t: float, y: np.ndarray, side: int) -> np.ndarray:
        """Return theta'', H, N and the links' forces, all over m_w, at rotation and velocity."""
        theta, rate = y
        turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
        quarter = np.array([[0.0, 1.0], [-1.0, 0.0]])  # d turn/d theta = quarter @ turn
        centre = turn @ [-side * B, H]  # from the pivot
        roof = turn @ [-B - side * B, 2 * H]
        slope = (quarter @ roof)[0]  # of the roof's displacement over theta
        u = roof[0] - (-B - side * B)
        n = self.m.size
        a, b = np.zeros((n + 3, n + 3)), np.zeros(n + 3)
        # momentum of the wall, horizontal and vertical, and moments about its centroid
        a[:2, 0] = quarter @ centre
        a[0, 1], a[1, 2], a[0, 3:] = -1, -1, 1
        b[:2] = centre * rate**2 - [ground(t), G]
        a[2, 0] = (H**2 + B**2) / 3
        a[2, 1:3] = [centre[1], -centre[0]]
        a[2, 3:] = self.share * roof[1] - centre[1]
        # every floor: m (u'' + u_g'') + K u + C u' = the pull of its link
        a[3:, 0] = self.m * self.share * slope
        a[3:, 3:] = -np.eye(n)
        b[3:] = self.m * (self.share * roof[0] * rate**2 - ground(t))
        b[3:] -= self.k @ self.share * u + self.c @ self.share * slope * rate
        return np.linalg.solve(a, b)

    def base_shear(self, x: np.ndarray, t: float, y: np.ndarray, side: int) -> float:
        """Return the rate of the horizontal momentum of everything, over the weight [-]."""
        roof = np.array([-B - side * B, 2 * H])
        place = roof[0] * math.cos(y[0]) + roof[1] * math.sin(y[0])
        slope = -roof[0] * math.sin(y[0]) + roof[1] * math.cos(y[0])
        roof_ddot = slope * x[0] - place * y[1] ** 2
        wall = x[1] - x[3:].sum()
        floors = self.m @ (self.share * roof_ddot + ground(t))
        return (wall + floors) / (G * (1 + self.m.sum()))

    def run(self, lift: float) -> tuple[list[float], np.ndarray]:
        """Return the times of impacts [s] and rows of t, theta, N, H over m_w g and base shear."""
        t, y = lift, np.zeros(2)
        side = -1 if ground(t) > 0 else 1
        impacts: list[float] = []
        rows: list[list[float]] = []
        while t < T_END:
            stop = PULSE_END if t < PULSE_END else T_END

            def base(_t: float, y: np.ndarray) -> float:
                return float(y[0])

            base.terminal, base.direction = True, -side
            piece = solve_ivp(
                lambda t, y, s=side: [y[1], self.solve(t, y, s)[0]],
                (t, stop), y, events=base, dense_output=True, **TIGHT,
            )  # fmt: skip
            for instant in np.arange(math.ceil(t / DT), T_END / DT) * DT:
                if instant < piece.t[-1]:
                    state = piece.sol(instant)
                    x = self.solve(instant, state, side)
                    shear = self.base_shear(x, instant, state, side)
                    rows.append([instant, state[0], x[2] / G, x[1] / G, shear])
            t, y = float(piece.t[-1]), piece.y[:, -1]
            if piece.status == 1:
                impacts.append(t)
                y, side = np.array([0.0, E * y[1]]), -side
        return impacts, np.array(rows)


@pytest.mark.parametrize(
    ("m", "k", "height"),
    [
        ([2.0, 2.0, 2.0], [700.0, 600.0, 400.0], [4.0, 4.0, 4.0]),
        ([1.5, 1.0, 0.5, 2.0], [900.0, 300.0, 500.0, 200.0], [5.0, 3.0, 2.0, 2.0]),
    ],
)
def test_forces_of_all_bodies(m: list[float], k: list[float], height: list[float]) -> None:
    case = coupled(
        wall={"h": H, "b": B},
        frame={"T_s": None, "gamma": None, "xi_s": 0.04},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": "every_floor"},
        cable=None,
        impact={"e": E},
        motion={"kind": "one_sine", "a_max_g": PEAK, "omega_p": OMEGA},
        model={"formulation": "exact"},
        solver={"t_end": T_END, "rtol": 1e-12, "method": "dop853"},
        output={"reactions": True, "energy": True},
    )
    run = rwmf.simulate(case, dt=DT)
    bodies = Bodies(m, k, height, 0.04)
    kind = run["event"].to_numpy()
    times = run["event_time"].to_numpy()
    lift = float(times[kind == "lift_off"][0])
    # all links and the wall lift it: (1 + 2 sum(m s)) u_g'' = g tan(alpha)
    push = 1 + 2 * bodies.m @ bodies.share
    assert ground(lift) == pytest.approx(G * B / H / push, rel=1e-12)
    impacts, rows = bodies.run(lift)
    assert len(impacts) >= 3
    assert times[kind == "impact"] == pytest.approx(impacts, rel=1e-9)
    found = run.sel(time=rows[:, 0], method="nearest")
    assert np.abs(found["time"].values - rows[:, 0]).max() < 1e-12
    for i, name in enumerate(
        [
            "theta",
            "pivot_normal_over_m_w_g",
            "pivot_horizontal_over_m_w_g",
            "base_shear_over_weight",
        ]
    ):
        size = np.abs(rows[:, i + 1]).max()
        assert found[name].values == pytest.approx(rows[:, i + 1], abs=1e-8 * size), name
    assert float(run["pivot_normal_min_over_m_w_g"]) <= rows[:, 2].min() + 1e-9
    assert abs(float(run["energy_balance_relative"])) < 1e-9


def test_one_storey_is_the_ordinary_frame() -> None:
    """Forces equal those without `&storeys`, to round-off."""
    output = {"reactions": True, "friction_limit": 0.2}
    plain = rwmf.simulate(coupled(output=output))
    storeys = {
        "m_over_m_w": [5.0],
        "k_over_m_w": [5.0 * (2 * math.pi) ** 2],
        "height": [4.0],
        "coupling": "every_floor",
    }
    other = rwmf.simulate(
        coupled(frame={"T_s": None, "gamma": None}, storeys=storeys, output=output)
    )
    for name in (
        "u_s_max",
        "base_shear_max_over_weight",
        "friction_demand_max",
        "pivot_normal_min_over_m_w_g",
        "t_friction_exceeded",
    ):
        assert float(other[name]) == pytest.approx(float(plain[name]), rel=1e-8), name
