"""Nonlinear dampers: limits, an independent integration, every path, velocities near zero."""

import math

import numpy as np
import pytest
import rwmf
from refused import refusals
from scipy.integrate import solve_ivp

G, H, B = 9.81, 2.0, 0.5
FRAME = {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05}
EXPONENTS = (0.15, 0.3, 0.7, 1.0, 2.0)


def scene(**groups: dict[str, object] | None) -> rwmf.Case:
    """Give a wall with a frame, a cable and a pulse, some groups changed."""
    found = {
        "wall": {"h": H, "b": B},
        "frame": FRAME,
        "impact": {"e": 0.9},
        "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
        "motion": {"kind": "one_sine", "a_max_g": 0.6, "T_p": 1.0},
        "solver": {"t_end": 8.0, "rtol": 1e-9},
    } | groups
    return rwmf.Case(**{name: keys for name, keys in found.items() if keys is not None})


def test_the_first_power_is_the_linear_damper() -> None:
    linear = rwmf.simulate(scene(damper={"c_over_m_w": 2.0}, output={"reactions": True}))
    power = rwmf.simulate(
        scene(nl_damper={"eta_1": 2.0 / G, "exponent": 1.0}, output={"reactions": True})
    )
    for name in ("u_s_max", "theta_dot_max", "pivot_normal_min_over_m_w_g", "friction_demand_max"):
        assert float(power[name]) == pytest.approx(float(linear[name]), rel=1e-7), name


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_a_free_block_by_another_program(exponent: float) -> None:
    """Release a block without frame and follow its first swing by SciPy, from virtual work."""
    eta, theta_0 = 0.05, 0.12
    alpha, radius = math.atan2(B, H), math.hypot(B, H)

    def rates(_t: float, y: np.ndarray) -> list[float]:
        v = 2 * B * math.cos(y[0] / 2) * y[1]
        force = eta * G * math.copysign(abs(v) ** exponent, v)
        moment = -G * radius * math.sin(alpha - y[0]) - force * 2 * B * math.cos(y[0] / 2)
        return [y[1], moment / (4 / 3 * radius**2)]

    def base(_t: float, y: np.ndarray) -> float:
        return float(y[0])

    base.terminal = True
    swing = solve_ivp(rates, (0, 5), [theta_0, 0.0], events=base, rtol=1e-11, atol=1e-14)
    run = rwmf.simulate(
        scene(
            frame=None, cable=None, motion={"kind": "one_sine", "a_max_g": 0.0, "T_p": 1.0},
            model={"formulation": "exact"}, initial={"theta_over_alpha": theta_0 / alpha},
            nl_damper={"eta_1": eta, "exponent": exponent},
            solver={"t_end": float(swing.t_events[0][0]) * 1.01, "rtol": 1e-10},
        )
    )  # fmt: skip
    assert int(run["impacts"]) == 1
    fastest = float(np.abs(swing.y[1]).max())
    assert float(run["theta_dot_max"]) == pytest.approx(fastest, rel=1e-8)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_methods_agree_and_the_ledger_closes(exponent: float) -> None:
    """The corner of the law at theta' = 0, creep before lift-off, and impacts."""
    found = {}
    for method in ("dop853", "taylor", "adams", "bdf"):
        case = scene(
            nl_damper={"eta_1": 0.3, "exponent": exponent}, output={"energy": True},
            solver={"t_end": 8.0, "rtol": 1e-9, "method": method, "max_steps": 200_000},
        )  # fmt: skip
        run = rwmf.simulate(case)
        assert float(run["energy_balance_relative"]) < 1e-7, method
        found[method] = float(run["u_s_max"])
    exact = found["dop853"]
    for method, u_s_max in found.items():
        assert u_s_max == pytest.approx(exact, rel=1e-7), method


@pytest.mark.parametrize("exponent", [0.7, 0.9, 1.1, 2.0])
def test_a_series_from_a_lift_off_has_the_damper(exponent: float) -> None:
    """Velocity and acceleration vanish at a lift-off, so that no power of the time is the first."""
    case = scene(
        cable=None, nl_damper={"eta_1": 0.1, "exponent": exponent}, impact={"e": 0.8},
        solver={"t_end": 3.0, "rtol": 1e-11, "method": "taylor"},
    )  # fmt: skip
    tight = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-13}))
    expected = pytest.approx(float(tight["theta_max_over_alpha"]), rel=3e-11)
    assert float(rwmf.simulate(case)["theta_max_over_alpha"]) == expected


def test_newtons() -> None:
    ratio = rwmf.simulate(scene(nl_damper={"eta_1": 0.2, "exponent": 0.4}))
    force = rwmf.simulate(
        scene(wall={"h": H, "b": B, "m_w": 5000.0},
              nl_damper={"F_1": 0.2 * 5000.0 * G, "exponent": 0.4})
    )  # fmt: skip
    assert float(force["u_s_max"]) == pytest.approx(float(ratio["u_s_max"]), rel=1e-12)


test_refused = refusals(
    lambda keys: scene(nl_damper=keys),
    ({"eta_1": 0.2}, "nl_damper"),
    ({"eta_1": 0.2, "exponent": 0.1}, "nl_damper"),
    ({"eta_1": -1.0, "exponent": 1.0}, "nl_damper"),
)


def test_a_damper_that_holds_a_displaced_wall_ends_the_run_early() -> None:
    held = scene(
        wall={"h": 7.8, "b": 1.43}, frame=None, impact={"rule": "coupled"},
        model={"formulation": "exact"}, cable={"eta_0": 0.66, "eta_alpha": 3.46},
        motion={"kind": "one_cosine", "a_max_g": 0.434, "T_p": 0.89},
        nl_damper={"eta_1": 0.5, "exponent": 0.15}, solver={"t_end": 1.5, "rtol": 1e-8},
    )  # fmt: skip
    message = "&nl_damper: exponent = 0.15: the dampers hold the displaced wall almost still at t ="
    with pytest.raises(rwmf.NumericalError, match=message):
        rwmf.simulate(held)
    row = rwmf.sweep(held, points={"scale": [1.0]}, quantities=("theta_max_over_alpha",))
    assert row.status.values.tolist() == [2]  # too many steps
    free = held.replace(nl_damper={"eta_1": 0.5, "exponent": 0.3})
    assert int(rwmf.simulate(free).steps) < 1000
