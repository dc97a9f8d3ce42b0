"""End of chatter, of which the last flights are not followed, small arches, and rest."""

import math
from pathlib import Path

import combinations
import numpy as np
import pytest
import rwmf
from hard_scenes import METHODS
from scenes import block, coupled

SCENE = """
&wall b = {b}, h = {h} /
&impact rule = 'constant', e = {e} /
&motion kind = 'sine', a_max_g = {a}, T_p = {T_p}, cycles = {cycles}, t_0 = {t_0} /
&initial theta_over_alpha = {theta} /
&solver t_end = 6.0, method = '{method}', rtol = {rtol} /
&output reactions = .true. /
"""

# the friction demand is largest at that end, and falls or rises with the ground until then
SCENES = {
    "short period": {"b": 0.434096, "h": 1.1843, "e": 0.340727, "a": 0.0384375, "T_p": 0.110792}
    | {"cycles": 54, "t_0": 0.491406, "theta": 0.211838},
    "low flight": {"b": 0.300075, "h": 1.00494, "e": 0.461446, "a": 0.0501863, "T_p": 0.726621}
    | {"cycles": 8, "t_0": 0.231128, "theta": 0.0451829},
    "long chatter": {"b": 1.62777, "h": 3.92915, "e": 0.540863, "a": 0.0808678, "T_p": 1.01567}
    | {"cycles": 5, "t_0": 0.148129, "theta": 0.222721},
}


def demand(scene: str, method: str, rtol: float) -> float:
    """Largest |H|/N of a run."""
    text = SCENE.format(method=method, rtol=rtol, **SCENES[scene])
    return float(rwmf.simulate(rwmf.Case.from_text(text))["friction_demand_max"])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", SCENES)
def test_the_friction_at_the_end_of_chatter(scene: str, method: str) -> None:
    """It is met to the tolerance; without the flights left out it errs by the root of it, 1e-5.

    The errors of the multistep methods are larger themselves.
    """
    rtol = 1e-8 if method in ("adams", "bdf") else 1e-6
    exact = demand(scene, "dop853", 1e-13)
    assert demand(scene, method, rtol) == pytest.approx(exact, rel=1e-6)


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
