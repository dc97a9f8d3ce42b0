"""Large sizes: many ordinates, long pulses, histories that end early."""

import math
import time
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import BATCH, run_words

FALL = """
&wall b = 1.0, h = 2.0 /
&motion kind = 'one_sine', a_max_g = {a}, T_p = 1.0 /
&solver t_end = 5.0, method = '{method}' /
&output dt = 0.1, energy = .true. /
"""

COLLAPSE = """
&frame T_s = 1.0, xi_s = 0.02 /
&p_delta m_g_over_m_s = 1.0, h_f = 3.0, drift_limit = 0.02 /
&motion kind = 'one_sine', a_max_g = {a}, T_p = 1.0 /
&solver t_end = 5.0, method = '{method}' /
&output dt = 0.1, energy = .true. /
"""

PULSES = """
&wall b = 1.0, h = 2.0 /
&frame gamma = 5.0, xi_s = 0.05, T_s = 1.0 /
&vertical ratio = {ratio} /
&motion kind = 'sine', a_max_g = 0.4, T_p = 1.0, cycles = {cycles} /
&solver t_end = 5.0 /
"""

BARE = "&frame xi_s = 0.05 /\n"
COUPLED = "&frame xi_s = 0.05, gamma = 5.0 /\n&wall b = 1.0, h = 2.0 /\n"


@pytest.mark.parametrize("method", ["dop853", "adams", "taylor"])
@pytest.mark.parametrize(("scene", "end"), [(FALL, "overturned"), (COLLAPSE, "collapsed")])
def test_a_history_ends_with_the_motion(tmp_path: Path, scene: str, end: str, method: str) -> None:
    """No row follows overturning or collapse, and a warning gives the time."""
    text = scene.format(method=method, a=3.0)
    result = rwmf.simulate(rwmf.Case.from_text(text))
    t_end = float(result["event_time"][-1])
    assert result[end]
    assert str(result["event"].values[-1]) == end
    assert t_end < 5
    assert result.sizes["time"] == math.floor(t_end / 0.1) + 1
    columns = [name for name in result.data_vars if result[name].dims == ("time",)]
    assert len(columns) > 2
    for name in columns:
        is_finite = np.isfinite(result[name].values)
        if name == "friction_demand":
            # infinite where the pivot would leave the ground, see the theory of the demands
            is_finite |= result["pivot_normal_over_m_w_g"].values <= 0
        assert np.all(is_finite), name
    (tmp_path / "case.nml").write_text(text)
    done = run_words([BATCH, "case.nml"], tmp_path)
    assert done.returncode == 0
    words = f"the history ends at t = {float(f'{t_end:.4g}')} s, when the"
    assert words in done.stderr
    assert any(
        words in warning and end in warning for warning in result.attrs["warnings"].splitlines()
    )
    rows = (tmp_path / "case.history.csv").read_text()
    assert "nan" not in rows.lower()
    assert float(rows.splitlines()[-1].split(",")[0]) == float(result["time"][-1])


def test_a_whole_history_has_no_such_warning() -> None:
    """A wall at rest has all rows."""
    result = rwmf.simulate(rwmf.Case.from_text(FALL.format(method="adams", a=0.5)))
    assert result.sizes["time"] == 51
    assert "history" not in result.attrs["warnings"]


@pytest.mark.parametrize("scene", [BARE, COUPLED])
def test_many_ordinates_need_no_large_stack(tmp_path: Path, scene: str) -> None:
    """Arrays of the size of the user's spectrum are on the heap."""
    (tmp_path / "case.nml").write_text(
        scene + "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n&solver t_end = 0.01 /\n"
        "&spectrum T_s_min = 0.1, T_s_max = 3.0, n = 100000 /\n"
    )
    done = run_words([BATCH, "case.nml"], tmp_path, stack=2**18)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "case.spectrum.csv").open() as file:
        assert sum(line[:1].isdigit() for line in file) == 100000


def test_what_a_pulse_does_after_the_run_takes_no_time() -> None:
    """A hundred million cycles are no more than five when the run ends after five."""
    started = time.monotonic()
    few, many = (
        rwmf.simulate(rwmf.Case.from_text(PULSES.format(ratio=0.3, cycles=cycles)))
        for cycles in (10, 1e8)
    )
    assert time.monotonic() - started < 5
    assert float(few["u_s_max"]) == float(many["u_s_max"])


@pytest.mark.parametrize(("ratio", "is_warned"), [(2.4, False), (2.6, True), (-2.6, True)])
def test_the_lowest_vertical_acceleration_is_known(ratio: float, is_warned: bool) -> None:
    """A vertical motion that takes all of the weight away is warned of."""
    result = rwmf.simulate(rwmf.Case.from_text(PULSES.format(ratio=ratio, cycles=1e8)))
    warnings = result.attrs["warnings"].splitlines()
    assert is_warned == any("takes all of weight" in text for text in warnings)
