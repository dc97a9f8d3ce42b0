"""A shear key bears the horizontal force on the base, in the place of friction."""

import numpy as np
import pytest
import rwmf
from scenes import coupled

WALL = {"h": 4.0, "b": 1.0, "shear_key": True}
STOREYS = {
    "m_over_m_w": [2.0, 1.0],
    "k_over_m_w": [400.0, 300.0],
    "height": [4.0, 4.0],
    "coupling": "full",
}


def _case(coupling: str, **changes: dict[str, object] | None) -> rwmf.Case:
    frame: dict[str, dict[str, object] | None] = {}
    if coupling in ("full", "reduced", "every_floor"):
        frame = {
            "frame": {"T_s": None, "gamma": None},
            "storeys": STOREYS | {"coupling": coupling},
        }
    if coupling == "pinned":
        frame = {"wall": WALL | {"base": "pinned"}, "cable": None, "impact": None}
    solver = {"t_end": 4.0, "rtol": 1e-9, "method": "dop853"}
    scene: dict[str, dict[str, object] | None] = {"wall": WALL, "solver": solver} | frame
    return coupled(**(scene | changes))


@pytest.mark.parametrize("coupling", ["one", "full", "reduced", "every_floor", "pinned"])
def test_its_force_is_the_horizontal_reaction(coupling: str) -> None:
    """Located maxima are above rows of 0.1 ms of the same run, and close to them."""
    case = _case(coupling, output={"reactions": True})
    run = rwmf.simulate(case, dt=1e-4)
    assert not [name for name in run if "friction" in str(name)]
    force = np.abs(run["pivot_horizontal_over_m_w_g"].values)
    largest = float(run["shear_key_force_max_over_m_w_g"])
    assert force.max() <= largest * (1 + 1e-12)
    assert force.max() == pytest.approx(largest, rel=1e-3)
    # the instant is the one at which the rows are largest
    row = int(force.argmax())
    assert float(run["t_shear_key_force_max"]) == pytest.approx(float(run["time"][row]), abs=2e-4)
    without = rwmf.simulate(
        case.replace(wall={"shear_key": None}, output={"friction_limit": 0.01}), dt=1e-4
    )
    assert "shear_key_force_max_over_m_w_g" not in without
    demand = np.abs(without["pivot_horizontal_over_m_w_g"] / without["pivot_normal_over_m_w_g"])
    assert float(demand.max()) <= float(without["friction_demand_max"]) * (1 + 1e-12)
    # the reaction of the base does not affect the motion
    assert np.array_equal(run["theta"].values, without["theta"].values)
    assert float(run["base_shear_max_over_weight"]) == pytest.approx(
        float(without["base_shear_max_over_weight"]), rel=1e-12
    )


@pytest.mark.parametrize("coupling", ["one", "reduced"])
def test_in_lanes(coupling: str) -> None:
    """An ordinate of a spectrum is the run; the friction demand does not apply."""
    key = "shear_key_force_max_over_m_w_g"
    case = _case(coupling)
    grid = rwmf.spectrum(case, T_s=[0.4, 0.6, 0.8, 1.0, 1.2], quantities=[key]).squeeze()
    if coupling == "one":
        run = rwmf.simulate(case.replace(frame={"T_s": 0.8}, output={"reactions": True}))
        assert float(grid[key][2]) == float(run[key])
    assert (grid[key].values > 0).all()
    with pytest.raises(rwmf.InputError, match="friction_demand_max does not apply"):
        rwmf.spectrum(case, T_s=[0.4], quantities=["friction_demand_max"])


def test_a_limit_of_friction_is_refused() -> None:
    with pytest.raises(rwmf.InputError, match="friction_limit"):
        _case("one", output={"reactions": True, "friction_limit": 0.4})
