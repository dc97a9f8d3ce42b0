"""Faults: failed computations and writes end with a helpful error."""

import re
from pathlib import Path

import pytest
import rwmf
from hard_scenes import METHODS, Groups, Hard, quiet

_ENDLESS: Groups = {
    "impact": {"e": 1.0},
    "motion": quiet(),
    "initial": {"theta_over_alpha": 0.2},
    "frame": {"xi_s": 0.0},
    "solver": {"t_end": 1e9, "max_steps": 2_000_000_000},
}


@pytest.mark.parametrize("method", METHODS)
def test_too_many_steps(method: str, tmp_path: Path) -> None:
    hard = Hard("steps", {"solver": {"t_end": 1000.0, "max_steps": 20}})
    with pytest.raises(rwmf.NumericalError) as error:
        rwmf.simulate(hard.build(tmp_path, method))
    assert re.search(r"max_steps.*t = .* s, theta = .*raise max_steps", str(error.value))


@pytest.mark.parametrize("method", METHODS)
def test_tolerance_beyond_the_precision(method: str, tmp_path: Path) -> None:
    """Either a result within round-off or an error that names time, state and a remedy."""
    hard = Hard("tight", {"solver": {"t_end": 2.0, "max_steps": 100_000}}, rtol=1e-14)
    loose = Hard("loose", {"solver": {"t_end": 2.0}}, rtol=1e-12)
    expected = float(rwmf.simulate(loose.build(tmp_path, "dop853"))["u_s_max"])
    try:
        found = float(rwmf.simulate(hard.build(tmp_path, method))["u_s_max"])
    except rwmf.NumericalError as error:
        assert re.search(r"t = .* s, theta = .*(rtol|tolerance|max_steps)", str(error))
    else:
        assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_motion_beyond_the_numbers(method: str, tmp_path: Path) -> None:
    """1e300 g: an error, or the wall overturns at once; never a NaN without a word."""
    hard = Hard("huge", {"motion": {"a_max_g": 1e300}, "solver": {"max_steps": 100_000}})
    try:
        run = rwmf.simulate(hard.build(tmp_path, method))
    except rwmf.NumericalError as error:
        assert "t = " in str(error)
    else:
        assert bool(run["overturned"])


def test_no_memory_for_the_history(tmp_path: Path) -> None:
    hard = Hard("memory", {"output": {"dt": 1e-300}})
    with pytest.raises(rwmf.NumericalError, match=r"out of memory for the history.*raise dt"):
        rwmf.simulate(hard.build(tmp_path))


def test_a_failed_ordinate_does_not_stop_the_others(tmp_path: Path) -> None:
    hard = Hard("some", {"solver": {"max_steps": 300}, "frame": {"T_s": None}})
    grid = {"T_s_min": 0.01, "T_s_max": 3.0, "n": 6, "spacing": "log"}
    case = Hard("some", {**hard.groups, "spectrum": grid}).build(tmp_path, "dop853")
    status = [str(value) for value in rwmf.spectrum(case)["status"].values.flat]
    assert "too_many_steps" in status
    assert "ok" in status
