"""Storeys that yield individually against an independent program in SciPy.

The plastic displacements are states here, which flow while a storey yields; the kernel has them in
closed form on each branch. Nothing but masses, stiffnesses and geometry is shared.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import rwmf
import xarray as xr
from scenes import bare_frame, coupled
from scipy.integrate import solve_ivp
from test_storeys import PULSE, PULSE_END, TIGHT, B, H, Storeys, ground
from yielding import slowly_unloaded

XI = 0.04
LEDGER = {"energy": True, "dt": 0.01}
SOLVER = {"rtol": 1e-11, "method": "dop853"}


class YieldingStoreys(Storeys):
    """`Storeys` whose columns yield, with or without the wall.

    Parameters
    ----------
    m, k, u_y : list of float
        Masses, stiffnesses [1/s2] and displacements at first yield [m] from the ground up.
    hardening : float
        Stiffness of a yielding storey over its elastic one [-].
    wall : bool
        Whether the roof is linked to a wall, with restitution 0.9.
    every_floor : bool
        Whether all floors are, on a straight line.
    """

    def __init__(
        self,
        m: list[float],
        k: list[float],
        u_y: list[float],
        hardening: float,
        *,
        wall: bool = True,
        every_floor: bool = False,
    ) -> None:
        super().__init__(m, k, XI, 0.9)
        self.stiffness, self.strength = np.array(k), np.array(k) * np.array(u_y)
        self.flow = 1 - hardening  # plastic part of the displacement of a yielding storey
        self.modulus = self.stiffness * hardening / (1 - hardening)
        self.wall, self.every_floor = wall, every_floor
        self.line = np.arange(1, self.n + 1) / self.n
        # displacement of the floors per displacement of the roof, through the links
        self.link = self.line if every_floor else np.append(np.zeros(self.n - 1), 1.0)
        if every_floor:
            mass = self.line**2 @ self.m
            omega = math.sqrt(sum(k) / self.n**2 / mass)
            self.c = np.diag([*np.zeros(self.n - 1), 2 * XI * omega * mass])

    def floors(self, state: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Return displacements and velocities of floors and roof."""
        roof = (state[0], state[1])
        if self.wall:
            place, slope, _ = self.roof(state[0], side)
            roof = (place, slope * state[1])
        if self.every_floor:
            return self.line * roof[0], self.line * roof[1]
        below = state[2 : 2 * self.n].reshape(2, self.n - 1)
        return np.append(below[0], roof[0]), np.append(below[1], roof[1])

    def drifts(self, state: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Return displacements of the storeys and their rates."""
        u, v = self.floors(state, side)
        return np.diff(u, prepend=0.0), np.diff(v, prepend=0.0)

    def forces(self, state: np.ndarray, side: int) -> np.ndarray:
        """Return the resistance of the storeys to the motion of the floors [m/s2]."""
        plastic = state[-self.n :]
        shear = self.stiffness * (self.drifts(state, side)[0] - plastic)
        _, v = self.floors(state, side)
        return self.c @ v + shear - np.append(shear[1:], 0.0)

    def rates_of(
        self, t: float, state: np.ndarray, side: int, modes: np.ndarray, *, rests: bool
    ) -> np.ndarray:
        """Return the rate of every state, of which the last n are the plastic displacements."""
        result = np.zeros_like(state)
        force, n = self.forces(state, side), self.n
        if not self.every_floor:
            result[2 : n + 1] = state[n + 1 : 2 * n]
            result[n + 1 : 2 * n] = -force[:-1] / self.m[:-1] - ground(t)
        if not self.wall:
            result[:2] = state[1], -force[-1] / self.m[-1] - ground(t)
        elif not rests:
            _, slope, bend = self.roof(state[0], side)
            mass = self.link**2 @ self.m
            inertia = 4 / 3 * self.radius**2 + mass * slope**2
            moment = self.moment(t, state, side) - mass * slope * bend * state[1] ** 2
            result[:2] = state[1], moment / inertia
        result[-n:] = np.where(modes != 0, self.flow * self.drifts(state, side)[1], 0.0)
        return result

    def moment(self, t: float, state: np.ndarray, side: int) -> float:
        """Return the moment about the corner without the inertia of the motion [m2/s2]."""
        _, slope, _ = self.roof(state[0], side)
        angle = self.alpha - side * state[0]
        push = self.radius * math.cos(angle) + self.link @ self.m * slope
        weight = side * 9.81 * self.radius * math.sin(angle)
        return -push * ground(t) - weight - slope * (self.link @ self.forces(state, side))

    def over(self, state: np.ndarray, side: int) -> np.ndarray:
        """Return the forces over those at which the storeys yield, without hardening."""
        plastic = state[-self.n :]
        shear = self.stiffness * (self.drifts(state, side)[0] - plastic)
        return (shear - self.modulus * plastic) / self.strength

    def _watch(self, side: int, modes: np.ndarray) -> list[Callable[[float, np.ndarray], float]]:
        """Return one event for each storey: first yield, or the turn of one that yields."""

        def of(storey: int) -> Callable[[float, np.ndarray], float]:
            if modes[storey]:
                sign = modes[storey]
                return lambda _t, y: sign * self.drifts(y, side)[1][storey]
            return lambda _t, y: 1 - abs(self.over(y, side)[storey])

        events = [of(storey) for storey in range(self.n)]
        for event in events:
            event.terminal, event.direction = True, -1.0
        return events

    def follow(self, t_end: float) -> dict[str, np.ndarray]:
        """Return times of impacts and of branches [s], the final state and the ductilities."""
        t, side, rests = 0.0, 1, self.wall
        state = np.zeros((2 if self.every_floor else 2 * self.n) + self.n)
        modes = np.zeros(self.n, dtype=int)
        impacts, branches = [], []
        farthest = np.zeros(self.n)
        while t < t_end:
            stop = PULSE_END if t < PULSE_END else t_end
            watch = self._watch(side, modes)
            if self.wall:
                watch += self._lift_offs() if rests else self._flight(side)[:1]
            now = modes.copy()
            flow = solve_ivp(
                lambda t, y, s=side, m=now, r=rests: self.rates_of(t, y, s, m, rests=r),
                (t, stop), state, events=watch, **TIGHT,
            )  # fmt: skip
            t, state = float(flow.t[-1]), flow.y[:, -1].copy()
            farthest = np.maximum(farthest, abs(self.drifts(state, side)[0]))
            fired = [i for i, times in enumerate(flow.t_events) if times.size]
            for i in fired:
                if i < self.n:
                    over = self.over(state, side)[i]
                    modes[i] = 0 if modes[i] else int(math.copysign(1, over))
                    branches.append(t)
                elif rests:
                    side, rests = (1 if i == self.n else -1), False
                else:
                    impacts.append(t)
                    state[0], state[1], side = 0.0, self.e * state[1], -side
            # an impact turns storeys as well, and on a straight line all turn at once
            modes[modes * self.drifts(state, side)[1] < 1e-11] = 0
        return {"impacts": np.array(impacts), "branches": np.array(branches), "state": state,
                "farthest": farthest}  # fmt: skip


def _check_ductility(run: xr.Dataset, found: dict[str, np.ndarray], u_y: list[float]) -> None:
    """Hold the ductilities of storeys that yield, which turn at events, against the program's."""
    ductility = np.array(_of_storeys(run, "ductility", len(u_y)))
    assert float(run["ductility"]) == ductility.max()
    yields = ductility > 1
    assert yields.any()
    assert ductility[yields] == pytest.approx((found["farthest"] / u_y)[yields], rel=1e-7)
    assert (found["farthest"][~yields] <= np.array(u_y)[~yields]).all()


def _groups(m: list[float], k: list[float], coupling: str, height: float) -> dict[str, dict]:
    return {
        "frame": {"T_s": None, "gamma": None, "xi_s": XI},
        "storeys": {
            "m_over_m_w": m,
            "k_over_m_w": k,
            "height": [height / len(m)] * len(m),
            "coupling": coupling,
        },
    }


def _of_storeys(run: xr.Dataset, what: str, n: int) -> list[float]:
    return [float(run[f"storey_{i + 1}_{what}"]) for i in range(n)]


@pytest.mark.parametrize(
    ("m", "k", "u_y", "hardening"),
    [
        ([2.0, 2.0, 2.0], [700.0, 600.0, 400.0], [0.03, 0.025, 0.03], 0.05),
        ([2.0, 2.0, 2.0], [700.0, 600.0, 400.0], [0.008, 0.02, 0.015], 0.0),
        ([4.0, 1.0], [500.0, 900.0], [0.02, 0.01], 0.1),
    ],
)
def test_with_wall_against_scipy(
    m: list[float], k: list[float], u_y: list[float], hardening: float
) -> None:
    """Check impacts, beginnings and ends of yielding, residuals, and peak drifts."""
    t_end, n = 2.5, len(m)
    case = coupled(
        **_groups(m, k, "full", 2 * H),
        wall={"h": H, "b": B},
        yielding={"storey_u_y": u_y, "hardening": hardening},
        cable=None,
        impact={"e": 0.9},
        motion=PULSE,
        model={"formulation": "exact"},
        solver=SOLVER | {"t_end": t_end},
        output=LEDGER,
    )
    run = rwmf.simulate(case)
    found = YieldingStoreys(m, k, u_y, hardening).follow(t_end)
    kind, times = run["event"].to_numpy(), run["event_time"].to_numpy()
    assert found["branches"].size >= 6
    assert found["impacts"].size >= 1
    assert times[kind == "impact"] == pytest.approx(found["impacts"], rel=1e-7)
    assert times[kind == "branch"] == pytest.approx(found["branches"], rel=1e-6)
    _check_ductility(run, found, u_y)
    left = found["state"][-n:]
    assert np.array(_of_storeys(run, "residual_drift", n)) * 2 * H / n == pytest.approx(
        left, abs=1e-8
    )
    assert float(run["residual_displacement"]) == pytest.approx(left.sum(), abs=1e-8)
    assert float(run["energy_balance_relative"]) < 1e-9


@pytest.mark.parametrize("hardening", [0.0, 0.08])
def test_without_wall_against_scipy(hardening: float) -> None:
    """Three storeys by themselves: the columns of the history hold the loops."""
    m, k, u_y = [3.0, 2.0, 1.5], [600.0, 500.0, 300.0], [0.02, 0.015, 0.02]
    case = bare_frame(
        **_groups(m, k, "full", 9.0),
        yielding={"storey_u_y": u_y, "hardening": hardening},
        motion=PULSE,
        solver=SOLVER | {"t_end": 4.0},
        output=LEDGER,
    )
    run = rwmf.simulate(case)
    model = YieldingStoreys(m, k, u_y, hardening, wall=False)
    found = model.follow(4.0)
    assert found["branches"].size >= 10
    times = run["event_time"].to_numpy()[run["event"].to_numpy() == "branch"]
    assert times == pytest.approx(found["branches"], rel=1e-6)
    _check_ductility(run, found, u_y)
    assert float(run["u_s"][-1]) == pytest.approx(found["state"][0], abs=1e-8)
    shear = model.stiffness * (model.drifts(found["state"], 1)[0] - found["state"][-3:])
    for i in range(3):
        column = run[f"storey_{i + 1}_shear_over_m_w_g"]
        assert float(column[-1]) == pytest.approx(shear[i] / 9.81, abs=1e-7)
        if not hardening:
            assert abs(column).max() <= k[i] * u_y[i] / 9.81 * (1 + 1e-12)
    assert float(run["energy_balance_relative"]) < 1e-9


def test_every_floor_against_scipy() -> None:
    """On a straight line the storeys yield one after the other."""
    m, k, u_y = [2.0, 2.0, 2.0], [700.0, 600.0, 400.0], [0.015, 0.02, 0.03]
    case = coupled(
        **_groups(m, k, "every_floor", 2 * H),
        wall={"h": H, "b": B},
        yielding={"storey_u_y": u_y, "hardening": 0.05},
        cable=None,
        impact={"e": 0.9},
        motion=PULSE,
        model={"formulation": "exact"},
        solver=SOLVER | {"t_end": 2.5},
        output=LEDGER,
    )
    run = rwmf.simulate(case)
    found = YieldingStoreys(m, k, u_y, 0.05, every_floor=True).follow(2.5)
    kind, times = run["event"].to_numpy(), run["event_time"].to_numpy()
    assert found["impacts"].size >= 1
    assert times[kind == "impact"] == pytest.approx(found["impacts"], rel=1e-7)
    _check_ductility(run, found, u_y)
    left = np.array(_of_storeys(run, "residual_drift", 3)) * 4.0
    assert left == pytest.approx(found["state"][-3:], abs=1e-8)
    assert float(run["energy_balance_relative"]) < 1e-9


@pytest.mark.slow
def test_smooth_storeys_against_scipy() -> None:
    """Bouc and Wen's law in each storey, with the present signs of its rate."""
    m, k, u_y = np.array([3.0, 2.0, 1.5]), np.array([600.0, 500.0, 300.0]), 0.015
    hardening, beta = 0.1, 0.7
    model = Storeys(list(m), list(k), XI, 1.0)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        u, v, z = y.reshape(3, 3)
        drift, speed = np.diff(u, prepend=0.0), np.diff(v, prepend=0.0)
        shear = k * (hardening * drift + (1 - hardening) * u_y * z)
        force = shear - np.append(shear[1:], 0.0) + model.c @ v
        lost = z**2 * (1 - beta + beta * np.sign(speed * z))
        return np.concatenate([v, -force / m - ground(t), speed / u_y * (1 - lost)])

    y, path = np.zeros(9), []
    for begin, end in ((0.0, PULSE_END), (PULSE_END, 2.0)):
        # short steps: the corners of the law cost the program its order
        flow = solve_ivp(rates, (begin, end), y, max_step=2e-4, **TIGHT)
        y = flow.y[:, -1]
        path.append(flow.y)
    drifts = np.diff(np.hstack(path)[:3], axis=0, prepend=0.0)
    case = bare_frame(
        **_groups(list(m), list(k), "full", 9.0),
        yielding={
            "storey_u_y": [u_y],
            "hardening": hardening,
            "law": "bouc_wen",
            "exponent": 2.0,
            "beta": beta,
        },
        motion=PULSE,
        solver=SOLVER | {"t_end": 2.0},
        output=LEDGER,
    )
    run = rwmf.simulate(case)
    assert float(run["u_s"][-1]) == pytest.approx(y[2], abs=1e-7)
    farthest = abs(drifts).max(axis=1) / u_y
    assert _of_storeys(run, "ductility", 3) == pytest.approx(farthest, rel=1e-5)
    left = [
        slowly_unloaded(d, z, u_y, hardening, beta, 2.0)
        for d, z in zip(np.diff(y[:3], prepend=0.0), y[6:], strict=True)
    ]
    residual = np.array(_of_storeys(run, "residual_drift", 3)) * 3.0
    assert residual == pytest.approx(left, abs=1e-7)
    shear = k * (hardening * np.diff(y[:3], prepend=0.0) + (1 - hardening) * u_y * y[6:])
    for i in range(3):
        column = run[f"storey_{i + 1}_shear_over_m_w_g"]
        assert float(column[-1]) == pytest.approx(shear[i] / 9.81, abs=1e-6)
    assert float(run["energy_balance_relative"]) < 1e-9


@pytest.mark.parametrize("wall", [True, False])
def test_smooth_storeys_become_bilinear(*, wall: bool) -> None:
    """The difference falls as the square of the exponent, where that is large."""
    m, k = [2.0, 2.0, 2.0], [700.0, 600.0, 400.0]
    groups = _groups(m, k, "full", 2 * H) | {
        "motion": PULSE,
        "solver": SOLVER | {"t_end": 1.5},
    }
    law = {"storey_u_y": [0.02, 0.015, 0.02], "hardening": 0.1}
    make = bare_frame
    if wall:
        make = coupled
        groups |= {
            "wall": {"h": H, "b": B},
            "cable": None,
            "impact": {"e": 0.9},
            "model": {"formulation": "exact"},
        }

    def ductility(**more: object) -> np.ndarray:
        run = rwmf.simulate(make(**groups, yielding=law | more))
        return np.array(_of_storeys(run, "ductility", 3))

    sharp = ductility()
    assert (sharp > 1).any()
    coarse, fine = (
        ductility(law="bouc_wen", exponent=n, beta=0.5) / sharp - 1 for n in (400.0, 800.0)
    )
    assert abs(fine).max() < 2e-5
    assert abs(fine).max() < abs(coarse).max() / 3.8
    if wall:
        assert coarse / fine == pytest.approx(np.full(3, 4.0), rel=0.02)


def test_states_of_smooth_storeys() -> None:
    """Each storey has one more."""
    case = bare_frame(
        **_groups([2.0, 1.0], [500.0, 300.0], "full", 6.0),
        yielding={"storey_u_y": [0.01], "law": "bouc_wen"},
        motion=PULSE,
        solver={"t_end": 1.0},
    )
    assert case.kernel.inventory()["states"] == [
        "u_s_m",
        "u_s_dot_m_s",
        "floor_1_m",
        "floor_1_dot_m_s",
        "z_1",
        "z_2",
    ]


@pytest.mark.parametrize("law", ["elastic_plastic", "bouc_wen"])
def test_base_shear_is_that_of_the_lowest_storey(law: str) -> None:
    """Without dampers: masses times accelerations on one side, the columns on the other."""
    m = [3.0, 2.0, 1.5]
    groups = _groups(m, [600.0, 500.0, 300.0], "full", 9.0)
    groups["frame"]["xi_s"] = 0.0
    case = bare_frame(
        **groups,
        yielding={"storey_u_y": [0.015], "hardening": 0.05, "law": law},
        motion=PULSE,
        solver=SOLVER | {"t_end": 3.0},
        output={"reactions": True, "dt": 0.01},
    )
    run = rwmf.simulate(case)
    assert float(run["ductility"]) > 3
    shear = run["storey_1_shear_over_m_w_g"].values / sum(m)
    assert run["base_shear_over_weight"].values == pytest.approx(-shear, abs=1e-9)


def test_wall_at_rest_bears_what_the_storeys_have_left() -> None:
    """After the motion the roof is held, and the link carries the shear of the uppermost storey."""
    m, k = [2.0, 2.0, 2.0], [700.0, 600.0, 400.0]
    case = coupled(
        **_groups(m, k, "full", 2 * H),
        wall={"h": H, "b": B},
        yielding={"storey_u_y": [0.008, 0.02, 0.015], "hardening": 0.05},
        cable={"eta_0": 10.0, "eta_alpha": 12.0, "law": "linear"},
        impact={"e": 0.0},
        motion=PULSE | {"a_max_g": 0.5},
        model={"formulation": "exact"},
        solver={"rtol": 1e-9, "method": "dop853", "t_end": 60.0},
        output={"reactions": True, "dt": 1.0},
    )
    run = rwmf.simulate(case)
    kind = run["event"].to_numpy()
    assert kind[kind != "branch"][-1] == "rest"
    # storeys have yielded while the wall was held as well
    assert kind[-1] == "branch"
    left = run["storey_3_shear_over_m_w_g"].values[-1]
    assert abs(left) > 1e-3
    # at rest the base balances the pull of the link
    assert float(run["pivot_horizontal_over_m_w_g"][-1]) == pytest.approx(left, abs=1e-5)
    shears = [float(run[f"storey_{i}_shear_over_m_w_g"][-1]) for i in (1, 2, 3)]
    assert shears == pytest.approx([left] * 3, abs=1e-5)


def test_storey_that_turns_with_a_rate_of_exactly_zero() -> None:
    """At its limit it goes inside before it comes back to it: no branch begins where it turned."""
    case = rwmf.Case(
        wall={"h": 4.72821674327399, "b": 2.109281385380181},
        frame={"xi_s": 0.05},
        storeys={
            "m_over_m_w": [0.904811082730141] * 3,
            "k_over_m_w": [268.1793064615956] * 3,
            "height": [3.152144495515993] * 3,
            "coupling": "full",
        },
        cable={"eta_0": 0.6622591369520591, "eta_alpha": 0.8011861659103058},
        impact={"rule": "constant", "e": 0.8},
        model={"formulation": "symmetric"},
        motion={"kind": "ricker", "a_max_g": 0.6965615292661229, "T_p": 0.7264338244651015},
        yielding={"storey_u_y": 0.016562044076574085, "hardening": 0.05},
        solver={"t_end": 6.0, "rtol": 1e-7, "method": "dop853"},
    )
    trusted = rwmf.simulate(case.replace(solver={"method": "taylor", "rtol": 1e-12}))
    found = rwmf.simulate(case)
    assert float(found["u_s_max"]) == pytest.approx(float(trusted["u_s_max"]), rel=1e-7)
