"""A free-standing block: nonlinear quarter periods, restitution, lift-off."""

import math

import numpy as np
import pytest
import rwmf
from scenes import block, coupled
from scipy.integrate import quad

G = 9.81
# kernel at rtol 1e-11 against the quadrature
TOLERANCE = 1e-8

# full nonlinear period times p, digits as published
PERIODS = {
    "0.25 rad": {0.1: 1.876796, 0.25: 3.191928, 0.5: 5.277503, 0.75: 8.260814, 0.9: 11.978546},
    "atan 0.25": {0.1: 1.876468, 0.25: 3.191511, 0.5: 5.277118, 0.75: 8.260532, 0.9: 11.978321},
}
SLENDERNESS = {"0.25 rad": math.tan(0.25), "atan 0.25": 0.25}
# e_max of the momentum balance for tan(alpha) and gamma; gamma = 0 is Housner's
RESTITUTION = {
    (0.25, 0.0): (0.911765, 6),
    (0.25, 1.0): (0.976923, 6),
    (0.25, 5.0): (0.994163, 6),
    (0.25, 10.0): (0.996982, 6),
    (0.25, 100.0): (0.999689, 6),
    (0.25, 1800.0): (0.9999826, 7),
    (0.5, 0.0): (0.700000, 6),
    (0.5, 5.0): (0.976923, 6),
    (0.5, 1800.0): (0.9999306, 7),
}


def _p(h: float, b: float) -> float:
    """Frequency parameter sqrt(3 g / 4 R) [rad/s]."""
    return math.sqrt(3 * G / (4 * math.hypot(h, b)))


def _quarter_period(h: float, b: float, phi: float) -> float:
    """Time from rest at theta_0 = phi alpha to the impact [s].

    theta'^2 / 2 = p^2 (cos(alpha - theta_0) - cos(alpha - theta)); theta = theta_0 - s^2 takes
    the singularity of the start away.
    """
    alpha = math.atan2(b, h)
    beta = alpha * (1 - phi)

    def integrand(s: float) -> float:
        # s / sqrt(sin(s^2/2)) is sqrt(2) at s = 0
        ratio = math.sqrt(2 / np.sinc(s * s / (2 * math.pi)))
        return ratio / math.sqrt(math.sin(beta + s * s / 2))

    value, _ = quad(integrand, 0, math.sqrt(phi * alpha), epsabs=1e-13, epsrel=1e-13)
    return value / _p(h, b)


def _first_impact(h: float, b: float, phi: float, t_end: float, method: str = "adams") -> float:
    case = block(
        wall={"h": h, "b": b},
        initial={"theta_over_alpha": phi},
        solver={"t_end": t_end, "rtol": 1e-11, "method": method},
        output={"dt": t_end},
    )
    events = rwmf.simulate(case)
    return float(events["event_time"].values[events["event"].values == "impact"][0])


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor"])
@pytest.mark.parametrize(("h", "b"), [(2.0, 0.5), (2.0, 1.0), (0.7, 0.1)])
@pytest.mark.parametrize("phi", [-0.9, 0.1, 0.5, 0.9, 0.99])
def test_quarter_period(h: float, b: float, phi: float, method: str) -> None:
    exact = _quarter_period(h, b, abs(phi))
    found = _first_impact(h, b, phi, 1.5 * exact, method)
    assert found == pytest.approx(exact, rel=TOLERANCE)


@pytest.mark.parametrize(("slenderness", "phi"), [(s, phi) for s in PERIODS for phi in PERIODS[s]])
def test_published_periods(slenderness: str, phi: float) -> None:
    h, b = 2.0, 2.0 * SLENDERNESS[slenderness]
    quarter = _first_impact(h, b, phi, 5.0)
    assert 4 * quarter * _p(h, b) == pytest.approx(PERIODS[slenderness][phi], abs=6e-7)


@pytest.mark.parametrize("phi", [0.1, 0.5, 0.9])
def test_slender_limit(phi: float) -> None:
    """Housner's linearised period is the limit of a slender block: p T = 4 arccosh 1/(1-phi)."""
    h, b = 2.0, 0.002
    quarter = _first_impact(h, b, phi, 5.0)
    assert 4 * quarter * _p(h, b) == pytest.approx(4 * math.acosh(1 / (1 - phi)), rel=1e-5)


@pytest.mark.parametrize(("tangent", "gamma"), list(RESTITUTION))
def test_restitution(tangent: float, gamma: float) -> None:
    expected, digits = RESTITUTION[tangent, gamma]
    case = coupled(
        wall={"b": 2.0 * tangent},
        frame={"gamma": gamma},
        impact={"rule": "coupled", "e": None},
        solver={"t_end": 0.0},
    )
    result = rwmf.simulate(case)
    assert float(result["e"]) == pytest.approx(expected, abs=0.51 * 10.0**-digits)
    assert float(result["e_max"]) == float(result["e"])


@pytest.mark.parametrize("tangent", [0.25, 0.5])
def test_housners_restitution_is_that_of_the_block(tangent: float) -> None:
    case = block(
        wall={"b": 2.0 * tangent}, impact={"rule": "housner", "e": None}, solver={"t_end": 0.0}
    )
    result = rwmf.simulate(case)
    sin_2 = tangent**2 / (1 + tangent**2)
    assert float(result["e"]) == pytest.approx(1 - 1.5 * sin_2, rel=1e-15)
    assert float(result["e_max"]) == pytest.approx(1 - 1.5 * sin_2, rel=1e-15)


@pytest.mark.parametrize("tangent", [0.1, 0.25, 1.0])
@pytest.mark.parametrize("gamma", [0.0, 5.0, 1800.0])
@pytest.mark.parametrize("x_over_b", [-0.5, 0.0, 0.3, 1.0])
def test_impulse_inside_the_base(tangent: float, gamma: float, x_over_b: float) -> None:
    """(T25) and (T26): momenta of wall and frame with an impulse at a distance from the corner."""
    h, b = 2.0, 2.0 * tangent
    x, inertia = x_over_b * b, (h**2 + b**2) / 3
    # velocity before: 1 about the left corner. Unknown: velocity after about the right corner,
    # horizontal and vertical impulse of the base, impulse of the link on the wall
    equations = np.array(
        [
            [h, -1.0, 0.0, -1.0],
            [2 * gamma * h, 0.0, 0.0, 1.0],
            [b, 0.0, -1.0, 0.0],
            [inertia, h, b - x, -h],
        ]
    )
    e, horizontal, vertical, _ = np.linalg.solve(equations, [h, 2 * gamma * h, -b, inertia])
    case = coupled(
        wall={"b": b}, frame={"gamma": gamma or 1e-14}, impact={"rule": "coupled", "e": None},
        solver={"t_end": 0.0},
    )  # fmt: skip
    e_max = float(rwmf.simulate(case)["e_max"])
    whole = 4 / 3 * (h**2 + b**2) + gamma * (2 * h) ** 2
    assert e == pytest.approx(e_max + b * (1 + e) * x / whole, rel=1e-12)
    ratio = (1 + 2 * gamma) * (1 - e) / (tangent * (1 + e))
    assert abs(horizontal / vertical) == pytest.approx(ratio, rel=1e-8, abs=1e-9)
    assert (e < e_max - 1e-12) == (x < 0)
    assert x_over_b < 1 or e == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("formulation", ["published", "symmetric", "exact"])
@pytest.mark.parametrize("gamma", [0.0, 5.0, 1800.0])
def test_lift_off_threshold(gamma: float, formulation: str) -> None:
    """Rest ends where |u_g''| = g tan(alpha) (1 + eta_0)/(1 + 2 gamma)."""
    threshold = 0.25 * 2 / (1 + 2 * gamma)
    lifts = {}
    for factor in (1 - 1e-9, 1 + 1e-6):
        case = coupled(
            frame={"gamma": gamma},
            motion={"kind": "one_sine", "a_max_g": threshold * factor},
            model={"formulation": formulation},
            solver={"t_end": 1.0},
        )
        lifts[factor] = int(rwmf.simulate(case)["lift_offs"])
    assert lifts[1 - 1e-9] == 0
    assert lifts[1 + 1e-6] >= 1


@pytest.mark.parametrize(("b", "phi"), [(0.5, 0.5), (2.0, 0.9)])
def test_reactions(b: float, phi: float) -> None:
    """N and H of a block released at rest, up to an impact without rebound, in closed form."""
    case = block(
        wall={"b": b},
        impact={"rule": "constant", "e": 0.0},
        motion={"kind": "none", "a_max_g": None, "omega_p": None},
        initial={"theta_over_alpha": phi},
        solver={"method": "dop853", "rtol": 1e-12},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    alpha = math.atan2(b, case.wall.h)
    x = np.linspace(alpha * (1 - phi), alpha, 200_001)
    normal = 0.25 + 2.25 * np.cos(x) ** 2 - 1.5 * np.cos(x) * np.cos(x[0])
    horizontal = abs(np.sin(x) * (2.25 * np.cos(x) - 1.5 * np.cos(x[0])))
    for key, value in (
        ("pivot_normal_min_over_m_w_g", normal.min()),
        ("friction_demand_max", max(horizontal / normal)),
        ("base_shear_max_over_weight", max(horizontal)),
    ):
        assert float(run[key]) == pytest.approx(value, rel=1e-10), key
