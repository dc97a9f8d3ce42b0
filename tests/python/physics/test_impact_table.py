"""Velocity factor from a table over the velocity before the impact."""

import numpy as np
import pytest
import rwmf
from scenes import block, coupled

METHODS = ("adams", "bdf", "taylor", "dop853")
SPEEDS = [0.02, 0.1, 0.4]
FACTORS = [0.95, 0.9, 0.7]


def _table(speeds: list[float], factors: list[float]) -> dict[str, object]:
    return {"rule": "table", "e": None, "table_theta_dot": speeds, "table_e": factors}


@pytest.mark.parametrize("method", METHODS)
def test_equal_values_are_a_constant(method: str) -> None:
    """Both runs have equal bits."""
    solver = {"method": method}
    constant = rwmf.simulate(coupled(solver=solver), dt=0.01)
    table = rwmf.simulate(coupled(impact=_table([0.1, 1.0], [0.9, 0.9]), solver=solver), dt=0.01)
    assert np.array_equal(constant["theta"].values, table["theta"].values)
    assert int(constant["impacts"]) == int(table["impacts"])
    assert "e" in constant
    assert "e" not in table


@pytest.mark.parametrize("method", METHODS)
def test_free_rocking_follows_the_table(method: str) -> None:
    """A free swing returns with the velocity that it left with: e(v_n) v_n = v_(n+1)."""
    case = block(
        impact=_table(SPEEDS, FACTORS),
        initial={"theta_over_alpha": 0.8},
        solver={"t_end": 20.0, "rtol": 1e-11, "method": method},
        output={"dt": 20.0},
    )
    run = rwmf.simulate(case)
    is_impact = run["event"].values == "impact"
    speed = np.abs(run["event_theta_dot"].values[is_impact])
    count = int(np.sum(speed > 0.005))
    assert speed[0] > SPEEDS[-1]
    assert count > 15
    expected = speed * np.interp(speed, SPEEDS, FACTORS)
    assert speed[1:count] == pytest.approx(expected[: count - 1], rel=1e-7)


def test_a_wall_that_loses_nothing_slowly_does_not_rest() -> None:
    """The end of chatter depends on the factors of all later velocities."""
    events = {}
    for name, factors in {"slow": [1.0, 1.0, 0.5], "lossy": [0.9, 0.9, 0.5]}.items():
        case = block(
            impact=_table([0.01, 0.02, 0.05], factors),
            initial={"theta_over_alpha": 0.3},
            solver={"t_end": 4.0},
            output={"dt": 4.0},
        )
        run = rwmf.simulate(case)
        events[name] = run["event"].values
        speed = np.abs(run["event_theta_dot"].values[events[name] == "impact"])
        if name == "slow":
            # the velocity from which nothing is lost
            assert speed[-1] == pytest.approx(0.02, rel=1e-6)
    assert "rest" in events["lossy"]
    assert "rest" not in events["slow"]


def test_the_smallest_factor_has_its_impulse_outside_the_base() -> None:
    run = rwmf.simulate(coupled(impact=_table([0.1, 1.0], [1.0, 0.5])))
    (line,) = run.attrs["warnings"].splitlines()
    assert line.startswith("e = 0.5 is below e_max = 0.994")
    assert rwmf.simulate(coupled(impact=_table([0.1, 1.0], [1.0, 0.995]))).attrs["warnings"] == ""
