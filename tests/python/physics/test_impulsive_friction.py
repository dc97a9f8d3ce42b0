"""Friction that the impulse of an impact needs: balances of momentum of single bodies."""

import math

import numpy as np
import pytest
import rwmf
from bodies import Body, Building, Ground, Scene
from scenes import block, coupled

KEY = "friction_demand_impact_max"
FALL = {"theta_over_alpha": 0.3}
ALL = {"reactions": True}
QUIET = {"kind": "none", "a_max_g": None, "omega_p": None}


def falling(**changes: dict[str, object] | None) -> rwmf.Case:
    """Return a wall with a frame that falls back from a rotation, without ground motion."""
    start = {"motion": QUIET, "initial": FALL, "solver": {"t_end": 4.0}, "output": ALL}
    return coupled(**start).replace(**changes)


def demand_of(case: rwmf.Case) -> float:
    """Return the largest friction demand of impacts of a run that has some."""
    run = rwmf.simulate(case)
    assert int(run.impacts) > 0
    return float(run[KEY])


@pytest.mark.parametrize(
    ("tangent", "gamma", "impact", "expected"),
    [
        (0.25, 0.0, {}, "0.185"),
        (0.5, 0.0, {}, "0.353"),
        (0.25, 5.0, {}, "0.129"),
        (0.25, 5.0, {"e": 0.9}, "2.32"),
        (0.25, 1800.0, {"e": 0.9}, "758"),
        (0.25, 5.0, {"rule": "none"}, "0"),
        (0.5, 0.0, {"r": 0.64}, "0.222"),
        (0.25, 5.0, {"rule": "housner"}, "2.03"),
    ],
)
def test_ratio_of_the_impulses(
    tangent: float, gamma: float, impact: dict[str, object], expected: str
) -> None:
    case = falling(wall={"b": 2.0 * tangent}, frame={"gamma": gamma}, impact=None)
    case = case.replace(impact=impact)
    if gamma == 0:
        case = case.replace(frame=None)
    found = demand_of(case)
    assert f"{found:.3g}" == expected or found < 1e-12 > float(expected)
    e = float(rwmf.simulate(case).e)
    assert found == pytest.approx(
        (1 + 2 * gamma) * (1 - e) / (tangent * (1 + e)), rel=1e-12, abs=1e-12
    )


@pytest.mark.parametrize("formulation", ["published", "symmetric", "exact"])
@pytest.mark.parametrize("e", [None, 0.85])
@pytest.mark.parametrize("coupling", ["reduced", "every_floor", "full"])
def test_impulses_of_single_bodies(coupling: str, e: float | None, formulation: str) -> None:
    m, k, height = [1.2, 0.7, 1.9], [300.0, 500.0, 250.0], [1.6, 1.4, 1.0]
    wall = Body(2.0, 0.6, e, formulation)
    building = Building(Scene(m, k, height, Ground([0.0, 9.0], [0.0, 0.0]), coupling, wall=wall))
    factor, horizontal, normal = building.impulses(np.zeros(2 + 2 * 2), 1)
    case = falling(
        wall={"b": 0.6},
        frame={"T_s": None, "gamma": None},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
        impact={"rule": None, "e": e},
        model={"formulation": formulation},
    )
    assert float(rwmf.simulate(case).e) == pytest.approx(factor, rel=1e-12)
    assert demand_of(case) == pytest.approx(abs(horizontal / normal), rel=1e-11)


def test_link_springs_give_no_impulse() -> None:
    storeys = {"m_over_m_w": [3.0, 2.0], "k_over_m_w": [300.0, 200.0], "height": [2.0, 2.0]}
    case = falling(
        frame={"T_s": None, "gamma": None},
        storeys=storeys | {"coupling": "springs", "k_link_over_m_w": [1e3, 1e3]},
    )
    assert demand_of(case) == pytest.approx(0.1 / (0.25 * 1.9), rel=1e-12)


@pytest.mark.parametrize("e", [None, 0.9])
@pytest.mark.parametrize("beta", [0.5, 20.0])
def test_inerters_press_the_landing_corner(beta: float, e: float | None) -> None:
    """Balance the vertical momentum of the wall and both inerters, the horizontal one of the frame.

    The corners move by 2b times the rotation: one inerter stops, the other one starts.
    """
    h, b, gamma = 2.0, 0.5, 3.0
    case = falling(
        frame={"gamma": gamma},
        inerter={"inertance_over_m_w": beta},
        impact={"rule": None, "e": e},
    )
    factor = float(rwmf.simulate(case).e)
    before, after = np.array([-h, -b, -2 * h, -2 * b, 0.0]), np.array([-h, b, -2 * h, 0.0, 2 * b])
    change = factor * after - before
    wall_x, wall_y, frame_x, landing, lifting = change
    normal = wall_y + beta * (landing + lifting)
    assert demand_of(case) == pytest.approx((wall_x + gamma * frame_x) / normal, rel=1e-12)


@pytest.mark.parametrize("vertical", [None, {"ratio": 0.4}])
def test_factors_of_a_table_count_at_their_velocities(vertical: dict[str, object] | None) -> None:
    speeds, factors = [0.05, 0.4], [0.97, 0.8]
    case = coupled(
        impact={"rule": None, "e": None, "table_theta_dot": speeds, "table_e": factors},
        vertical=vertical,
        output=ALL,
    )
    run = rwmf.simulate(case, dt=0.1)
    velocity = np.abs(run["event_theta_dot"].values[run["event"].values == "impact"])
    assert velocity.size > 3
    e = np.interp(velocity, speeds, factors)
    assert float(run[KEY]) == pytest.approx(max(11 * (1 - e) / (0.25 * (1 + e))), rel=1e-10)


def test_the_first_impact_exceeds_a_limit() -> None:
    case = falling(impact={"e": 0.9})
    run = rwmf.simulate(case, dt=0.1)
    first = float(run["event_time"].values[run["event"].values == "impact"][0])
    assert float(run.friction_demand_max) < 1.5 < float(run[KEY])
    told = rwmf.simulate(case.replace(output={"friction_limit": 1.5}))
    assert bool(told.friction_exceeded)
    assert float(told.t_friction_exceeded) == first
    assert "or that of an impact, exceeds the friction_limit" in told.attrs["warnings"]
    assert not bool(rwmf.simulate(case.replace(output={"friction_limit": 2.4})).friction_exceeded)
    alone = rwmf.sweep(
        case.replace(output={"friction_limit": 1.5}),
        {"T_s": [1.0]},
        quantities=("friction_exceeded", "t_friction_exceeded_s"),
    )
    assert float(alone.t_friction_exceeded.squeeze()) == pytest.approx(first, rel=1e-8)


def test_where_there_is_no_such_demand() -> None:
    still = falling(initial=None)
    assert float(rwmf.simulate(still)[KEY]) == 0.0
    for absent in ({"base": "pinned"}, {"shear_key": True}):
        case = falling(wall=absent, cable=None, impact=None)
        assert KEY not in rwmf.simulate(case)
        assert np.isnan(rwmf.sweep(case, {"T_s": [1.0]}, quantities=(KEY,))[KEY]).all()
        with pytest.raises(rwmf.InputError, match=rf"{KEY} = 1.0: needs (&impact|no shear_key)"):
            case.replace(limits={KEY: 1.0})


@pytest.mark.parametrize("method", ["auto", "dop853", "adams"])
def test_ordinates_and_hosts(method: str) -> None:
    case = coupled(impact={"e": 0.9}, solver={"method": method})
    found = rwmf.spectrum(case, T_s=[0.5, 1.0], gamma=[2.0, 5.0], quantities=(KEY,))
    expected = [(1 + 2 * gamma) * 0.1 / (0.25 * 1.9) for gamma in (2.0, 5.0)]
    for i, gamma in enumerate((2.0, 5.0)):
        values = found[KEY].sel(gamma=gamma).values.ravel()
        assert values == pytest.approx(np.full(2, expected[i]), rel=1e-12)
    rows = rwmf.sweep(case, {"T_s": [0.5], "e": [0.7, 0.9]}, quantities=("u_s_max", KEY))
    assert rows[KEY].values.ravel() == pytest.approx(
        [11 * (1 - e) / (0.25 * (1 + e)) for e in (0.7, 0.9)], rel=1e-12
    )
    limit = case.replace(limits={KEY: 1.0}, output=ALL)
    assert not rwmf.checks(limit, rwmf.simulate(limit)).is_met


@pytest.mark.parametrize("gamma", [0.0, 2.0])
def test_a_wall_that_bends(gamma: float) -> None:
    """A wall of one mode in free fall: momenta from the energy and the velocity of the top."""
    h, b = 4.0, 0.8
    case = block(
        wall={"h": h, "b": b},
        initial={"theta_over_alpha": 0.3},
        bending={"EI_over_m_w": 2e4, "modes": 1, "xi": 0.0},
        impact={"rule": "coupled", "e": None},
        model={"formulation": "exact"},
        solver={"t_end": 3.0},
        output=ALL,
    )
    if gamma:
        case = case.replace(frame={"T_s": 1.0, "gamma": gamma, "xi_s": 0.05})
    run = rwmf.simulate(case, dt=1e-4)
    t = run["time"].values
    hits = run["event_time"].values[run["event"].values == "impact"]
    assert hits.size > 0
    # mean of the first mode of a cantilever over its top
    mean = 0.39149
    first = int(np.searchsorted(t, hits[0]))
    q_dot = np.gradient(run["q_1"].values, t)
    # one-sided rates beside the impact
    rates = []
    for side in (slice(first - 8, first - 2), slice(first + 2, first + 8)):
        at, near = hits[0], t[side] - hits[0]
        assert abs(near).max() < 1e-3 < at
        rates.append([float(np.polyfit(near, values[side], 2)[-1])
                      for values in (run["theta_dot"].values, q_dot)])  # fmt: skip
    (w_1, q_1), (w_2, q_2) = rates
    horizontal = h * (w_2 - w_1) + mean * (q_2 - q_1)
    horizontal += gamma * (2 * h * (w_2 - w_1) + (q_2 - q_1))
    normal = b * (abs(w_1) + abs(w_2))
    short = case.replace(solver={"t_end": float(hits[0]) + 1e-3})
    assert demand_of(short) == pytest.approx(abs(horizontal) / normal, rel=2e-2)
    assert math.isfinite(demand_of(case))
