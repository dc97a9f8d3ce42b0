"""End of chatter, of which the last flights are not followed, small arches, and rest."""

import math
from pathlib import Path

import combinations
import numpy as np
import pytest
import rwmf
from hard_scenes import METHODS
from scenes import block, coupled


@pytest.mark.parametrize("method", ["dop853", "taylor"])
def test_the_moment_of_floors_that_go_on(method: str, tmp_path: Path) -> None:
    """The floors move on during the flights left out: without that the moment errs by 233 rtol."""
    scene = combinations.further_combination(65)

    def largest(**solver: object) -> float:
        run = rwmf.simulate(scene.build(tmp_path, solver=solver))
        return float(run["overturning_moment_max_over_weight"])

    exact = largest(method="dop853", rtol=1e-13)
    assert largest(method=method, rtol=1e-9) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_chatter_ends_in_rest(method: str) -> None:
    solver = {"t_end": 100.0, "method": method}
    run = rwmf.simulate(block(initial={"theta_over_alpha": 0.5}, solver=solver), dt=50.0)
    assert run["theta"].values[-1] == run["theta_dot"].values[-1] == 0
    assert 50 < int(run["impacts"]) < 400


@pytest.mark.parametrize("method", METHODS)
def test_a_hundred_small_arches(method: str) -> None:
    """Each ends well within the usual step."""
    velocity = 1e-6
    pull = 0.75 * 9.81 * math.sin(math.atan(0.25)) / math.hypot(2.0, 0.5)
    case = block(
        initial={"theta_dot": velocity},
        impact={"rule": "none", "e": None},
        solver={"t_end": 201 * velocity / pull, "method": method},
    )
    run = rwmf.simulate(case)
    assert int(run["impacts"]) == 100
    theta = float(run["theta_max_over_alpha"]) * math.atan(0.25)
    assert theta == pytest.approx(velocity**2 / (2 * pull), rel=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_a_response_of_less_than_a_micrometre(method: str) -> None:
    motion = {"kind": "one_sine", "a_max_g": 0.25 * 2 / 11 * (1 + 1e-5)}
    case = coupled(motion=motion, solver={"method": method})
    tight = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-13}))
    assert float(tight["u_s_max"]) < 1e-6
    assert float(rwmf.simulate(case)["u_s_max"]) == pytest.approx(float(tight["u_s_max"]), rel=1e-7)


def test_the_ground_moves_under_a_wall_at_rest() -> None:
    """Rows have the motion of their interval, not of the next one."""
    motion = {"kind": "one_sine", "a_max_g": 0.1, "omega_p": 2 * math.pi, "t_0": 0.3}
    run = rwmf.simulate(block(motion=motion, solver={"t_end": 2.0}), dt=0.05)
    assert int(run["lift_offs"]) == 0
    t = run["time"].values
    pulse = (t > 0.3) & (t < 1.3)
    expected = np.where(pulse, 0.981 * np.sin(2 * math.pi * (t - 0.3)), 0.0)
    assert run["u_g_ddot"].values == pytest.approx(expected, abs=1e-12)
