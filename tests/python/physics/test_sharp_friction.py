"""Peaks of |H|/N where N is close to zero, against dense samples of the same solution."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from combinations import combination

# sizes of the motion [g] at which the smallest N is 0.0003 of the wall's weight
_SIZES = {2: 2.2976675783970735, 14: 1.719730411684823}
_RTOL = (1e-6, 1e-9)
_METHODS = ("dop853", "taylor")


def _case(number: int, folder: Path) -> rwmf.Case:
    made = combination(number).build(folder, motion={"a_max_g": _SIZES[number]})
    return made.replace(output={"reactions": True})


def _dense_peak(run: xr.Dataset) -> float:
    """Largest quotient of the polynomials through seven samples of N and H around the largest."""
    normal = run.pivot_normal_over_m_w_g.values
    i = int(np.argmax(run.friction_demand.values))
    near = slice(i - 3, i + 4)
    x = np.arange(-3.0, 4.0)
    fine = np.linspace(-1.0, 1.0, 20001)
    parts = [
        np.polyval(np.polyfit(x, values[near], 6), fine)
        for values in (run.pivot_horizontal_over_m_w_g.values, normal)
    ]
    return float(np.max(np.abs(parts[0]) / parts[1]))


@pytest.mark.parametrize("rtol", _RTOL)
@pytest.mark.parametrize("method", _METHODS)
@pytest.mark.parametrize("number", sorted(_SIZES))
def test_no_sample_exceeds_the_peak(number: int, method: str, rtol: float, tmp_path: Path) -> None:
    solver = {"method": method, "rtol": rtol}
    case = _case(number, tmp_path).replace(solver=solver)
    run = rwmf.simulate(case.replace(output={"dt": 1e-4, "reactions": True}))
    peak = float(run.friction_demand_max)
    assert peak > 100
    assert peak == pytest.approx(_dense_peak(run), rel=1e-8)
    # rows do not keep a history; those of dop853 are lanes
    sizes = {"motion.a_max_g": [_SIZES[number]]}
    rows = rwmf.sweep(case, sizes, quantities=("friction_demand_max",))
    assert float(rows.friction_demand_max.squeeze()) == pytest.approx(peak, rel=1e-8)


@pytest.mark.parametrize("number", sorted(_SIZES))
def test_limit_below_a_sharp_peak(number: int, tmp_path: Path) -> None:
    """The demand exceeds a coefficient for a short while beside the smallest N, or never."""
    case = _case(number, tmp_path)
    run = rwmf.simulate(case)
    peak = float(run.friction_demand_max)
    asked = {"reactions": True, "friction_limit": 0.999 * peak}
    below = rwmf.simulate(case.replace(output=asked))
    assert bool(below.friction_exceeded)
    before = float(run.t_friction_demand_max - below.t_friction_exceeded)
    assert 0 < before < 1e-3
    dense = rwmf.simulate(case.replace(output={"reactions": True, "dt": 1e-5}))
    earlier = dense.time.values < float(below.t_friction_exceeded)
    assert float(dense.friction_demand.values[earlier].max()) <= asked["friction_limit"]
    above = rwmf.simulate(case.replace(output=asked | {"friction_limit": 1.001 * peak}))
    assert not bool(above.friction_exceeded)


@pytest.mark.parametrize("number", sorted(_SIZES))
def test_infinite_where_the_pivot_lifts(number: int, tmp_path: Path) -> None:
    case = _case(number, tmp_path).replace(motion={"a_max_g": 1.003 * _SIZES[number]})
    run = rwmf.simulate(case)
    assert -0.01 < float(run.pivot_normal_min_over_m_w_g) < 0
    assert bool(run.pivot_lifts)
    assert np.isinf(run.friction_demand_max)
    assert "t_friction_demand_max" not in run
