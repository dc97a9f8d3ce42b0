"""Inerters at the corners of the base: inertia that only a lifting corner has."""

import math

import numpy as np
import pytest
import rwmf
from scenes import block, coupled
from scipy.integrate import quad

G = 9.81
METHODS = ("adams", "bdf", "taylor", "dop853")


def _inertia(beta: float, alpha: float, phi: float) -> float:
    """Inertia about the pivot over m_w R^2: the chord 4b sin(phi/2) is the stroke."""
    return 4 / 3 + 4 * beta * (math.sin(alpha) * math.cos(phi / 2)) ** 2


def _speed_squared(beta: float, h: float, b: float, start: float, phi: float) -> float:
    """Square of phi' of a block released at `start`, from its energy [rad2/s2]."""
    alpha, R = math.atan2(b, h), math.hypot(h, b)
    fall = math.cos(alpha - start) - math.cos(alpha - phi)
    return 2 * G / R * fall / _inertia(beta, alpha, phi)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("beta", [0.0, 0.3, 4.0])
@pytest.mark.parametrize(("h", "b"), [(2.0, 0.5), (2.0, 1.5)])
def test_free_swing(h: float, b: float, beta: float, method: str) -> None:
    """Velocity and instant of the first impact of a free-standing block, nonlinear."""
    start = 0.6 * math.atan2(b, h)
    case = block(
        wall={"h": h, "b": b},
        inerter={"inertance_over_m_w": beta},
        impact={"e": 0.0},
        initial={"theta_over_alpha": 0.6},
        solver={"t_end": 6.0, "rtol": 1e-11, "method": method},
        output={"dt": 6.0},
    )
    run = rwmf.simulate(case)
    speed = math.sqrt(_speed_squared(beta, h, b, start, 0.0))
    assert float(run["theta_dot_max"]) == pytest.approx(speed, rel=1e-9)
    # phi = start - s^2 takes the singularity of the start away
    quarter, _ = quad(
        lambda s: 2 * s / math.sqrt(_speed_squared(beta, h, b, start, start - s * s)),
        1e-9,
        math.sqrt(start),
        epsabs=1e-12,
        epsrel=1e-12,
    )
    impact = float(run["event_time"].values[run["event"].values == "impact"][0])
    assert impact == pytest.approx(quarter, rel=1e-8)


def _factor_by_impulses(alpha: float, gamma: float, beta: float) -> float:
    """Ratio of angular velocities at the impact from impulses on the single bodies.

    Per unit m_w and R; x to the right, y upward, clockwise positive. Before, the wall turns about
    the right corner with w = -1 (it falls back onto its left corner); afterwards about the left
    one. Unknown: w, the impulse (X, Y) at the left corner, the link's impulse F on the wall at its
    left top corner, the impulse B of the right inerter on the right corner.
    """
    c, s = math.cos(alpha), math.sin(alpha)

    def velocity(w: float, rx: float, ry: float) -> np.ndarray:
        # clockwise turning about the pivot at the origin
        return np.array([w * ry, -w * rx])

    before = velocity(-1.0, -s, c)
    frame_before = velocity(-1.0, -2 * s, 2 * c)[0]
    # after, for w = 1
    after, frame_after = velocity(1.0, s, c), velocity(1.0, 0.0, 2 * c)[0]
    corner_after = velocity(1.0, 2 * s, 0.0)[1]
    # unknowns w, X, Y, F, B; moments about the centroid, clockwise
    left, top, right = (-s, -c), (-s, c), (s, -c)
    matrix = np.array(
        [
            [after[0], -1, 0, -1, 0],
            [after[1], 0, -1, 0, -1],
            [1 / 3, -left[1], left[0], -top[1], right[0]],
            [gamma * frame_after, 0, 0, 1, 0],
            [beta * corner_after, 0, 0, 0, 1],
        ]
    )
    rest = [before[0], before[1], -1 / 3, gamma * frame_before, 0.0]
    return float(-np.linalg.solve(matrix, rest)[0])


@pytest.mark.parametrize("tangent", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("gamma", [0.0, 5.0])
@pytest.mark.parametrize("beta", [0.0, 0.5, 20.0])
def test_coupled_restitution(tangent: float, gamma: float, beta: float) -> None:
    case = coupled(
        wall={"b": 2.0 * tangent},
        frame={"gamma": gamma},
        inerter={"inertance_over_m_w": beta},
        impact={"rule": "coupled", "e": None},
        solver={"t_end": 0.0},
    )
    run = rwmf.simulate(case)
    expected = _factor_by_impulses(math.atan(tangent), gamma, beta)
    assert float(run["e"]) == pytest.approx(expected, rel=1e-14)
    assert float(run["e_max"]) == float(run["e"])


@pytest.mark.parametrize("e", [1.0, 0.8])
def test_energy(e: float) -> None:
    """With e = 1 the energy of the landing corner's inerter goes to the other one."""
    run = rwmf.simulate(
        coupled(
            inerter={"inertance_over_m_w": 2.0},
            frame={"xi_s": 0.0},
            motion=None,
            impact={"e": e},
            initial={"theta_over_alpha": 0.5},
            solver={"t_end": 8.0},
            output={"energy": True},
        )
    )
    assert int(run["impacts"]) > 5
    assert abs(float(run["energy_balance_relative"])) < 1e-7
    told = run.attrs["warnings"].splitlines()
    assert [line.split(" is below ")[0] for line in told] == (["e = 0.8"] if e < 1 else [])


def test_a_resting_wall_does_not_feel_it() -> None:
    """An inerter holds nothing that does not move: the threshold of lift-off is the same."""
    threshold = 0.25
    lifts = []
    for factor in (1 - 1e-9, 1 + 1e-6):
        motion = {"kind": "one_sine", "a_max_g": threshold * factor, "omega_p": 6.0}
        case = block(motion=motion, inerter={"inertance_over_m_w": 3.0}, solver={"t_end": 0.5})
        lifts.append(int(rwmf.simulate(case)["lift_offs"]))
    assert lifts == [0, 1]
