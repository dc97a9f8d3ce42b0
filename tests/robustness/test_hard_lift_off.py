"""Instants of lift-off that are known in closed form."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from hard_scenes import BLOCK, METHODS, Groups, Hard, quiet, sine, threshold

_SCENES: dict[str, Groups] = {"block": BLOCK, "coupled": {"frame": {"T_s": 0.4}}}
FORMULATIONS = ["published", "symmetric", "exact"]


def _first(run: object, kind: str) -> float:
    return float(run["event_time"].values[run["event"].values == kind][0])


@pytest.mark.parametrize("scene", list(_SCENES))
@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("method", METHODS)
def test_on_a_ramp(method: str, formulation: str, scene: str, tmp_path: Path) -> None:
    groups = {**_SCENES[scene], "model": {"formulation": formulation}}
    limit = threshold(groups)
    hard = Hard("ramp", {**groups, "solver": {"t_end": 0.9}}, ((0.0, 0.0), (1.0, -1.25 * limit)))
    run = rwmf.simulate(hard.build(tmp_path, method), dt=0.9)
    assert _first(run, "lift_off") == pytest.approx(0.8, rel=1e-14)
    assert float(run["theta"][-1]) > 0


@pytest.mark.parametrize("over", [1e-12, 1e-9, 1e-3])
def test_on_a_sine(over: float, tmp_path: Path) -> None:
    """The crest of the pulse passes the threshold by a hair."""
    amplitude = threshold(BLOCK) * (1 + over) / 9.81
    groups = {**BLOCK, "motion": sine(amplitude, 1, 2 * math.pi), "solver": {"t_end": 0.3}}
    run = rwmf.simulate(Hard("crest", groups).build(tmp_path), dt=0.3)
    expected = math.asin(1 / (1 + over)) / (2 * math.pi)
    # at the crest the sine is flat: its round-off moves the instant
    assert _first(run, "lift_off") == pytest.approx(expected, abs=1e-15 + 1e-16 / math.sqrt(over))


@pytest.mark.parametrize("scene", list(_SCENES))
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("part", [0.0, -1e-15, -1e-12, -1e-3])
def test_not_above_the_threshold(part: float, method: str, scene: str, tmp_path: Path) -> None:
    level = threshold(_SCENES[scene]) * (1 + part)
    record = ((0.0, 0.0), (0.5, level), (2.0, level), (2.5, -level), (3.0, 0.0))
    run = rwmf.simulate(Hard("below", _SCENES[scene], record).build(tmp_path, method))
    assert int(run["lift_offs"]) == 0
    assert float(run["theta_max_over_alpha"]) == 0


@pytest.mark.parametrize("method", METHODS)
def test_just_above_the_threshold(method: str, tmp_path: Path) -> None:
    level = threshold(BLOCK) * (1 + 1e-12)
    record = ((0.0, 0.0), (0.5, level), (2.0, level), (2.5, 0.0))
    run = rwmf.simulate(Hard("above", BLOCK, record).build(tmp_path, method))
    assert int(run["lift_offs"]) == 1
    assert 0 < float(run["theta_max_over_alpha"]) < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_exactly_on_the_separatrix(method: str, tmp_path: Path) -> None:
    """Upright on its corner the block stays there: neither falls nor returns."""
    groups = {**BLOCK, "motion": quiet(), "initial": {"theta_over_alpha": 1.0}}
    run = rwmf.simulate(Hard("upright", groups).build(tmp_path, method), dt=0.1)
    assert not bool(run["overturned"])
    # round-off of the rotation, grown by exp(p t) at most
    growth = np.exp(math.sqrt(0.75 * 9.81 / math.hypot(2, 0.5)) * run["time"].values)
    deviation = np.abs(run["theta"].values - math.atan2(0.5, 2.0))
    assert np.all(deviation <= 1e-15 * growth)
