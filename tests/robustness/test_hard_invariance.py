"""Invariances as properties: for scenes that hypothesis chooses."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from hard_scenes import METHODS, scene
from hypothesis import given, settings
from hypothesis import strategies as st

# the examples are the same in every run; the number keeps the suite short
_PROFILE = settings(max_examples=15, deadline=None, derandomize=True, database=None)

_SCENES = st.fixed_dictionaries(
    {
        "tan_alpha": st.floats(0.1, 0.6),
        "gamma": st.floats(0.5, 2000.0),
        "T_s": st.floats(0.1, 3.0),
        "xi_s": st.floats(0.0, 0.2),
        "eta": st.floats(0.0, 3.0),
        "e": st.floats(0.3, 0.95),
        "a": st.floats(0.05, 0.6),
        "method": st.sampled_from(METHODS),
    }
)


def _case(x: dict[str, float], size: float = 1.0, **changes: object) -> rwmf.Case:
    """Scene of which all lengths are multiplied by `size`, all times by its root."""
    time = math.sqrt(size)
    groups = scene(
        {
            "wall": {"h": 2.0 * size, "b": 2.0 * size * x["tan_alpha"]},
            "frame": {"T_s": x["T_s"] * time, "gamma": x["gamma"], "xi_s": x["xi_s"]},
            "cable": {"eta_0": x["eta"], "eta_alpha": 2 * x["eta"]},
            "impact": {"e": x["e"]},
            "motion": {"kind": "one_sine", "a_max_g": x["a"], "omega_p": 2 * math.pi / time},
            "model": {"formulation": "symmetric"},
            "solver": {"t_end": 3.0 * time, "method": x["method"], "rtol": 1e-9},
        }
    )
    return rwmf.Case(**groups).replace(**changes)


def _peak(run: object) -> float:
    return float(run["theta_max_over_alpha"])


@_PROFILE
@given(_SCENES)
def test_mirror(x: dict[str, float]) -> None:
    """`symmetric`: the opposite motion gives the opposite rotation, but for round-off."""
    run = rwmf.simulate(_case(x), dt=0.05)
    mirror = rwmf.simulate(_case(x, motion={"a_max_g": -x["a"]}), dt=0.05)
    size = np.nanmax(np.abs(run["theta"].values))
    assert np.array_equal(np.isnan(run["theta"].values), np.isnan(mirror["theta"].values))
    assert np.nanmax(np.abs(run["theta"].values + mirror["theta"].values)) <= 1e-7 * size


@_PROFILE
@given(_SCENES)
def test_scaling_by_a_power_of_four(x: dict[str, float]) -> None:
    """Doubling times is exact; the difference is the absolute floor of CVODE's first step."""
    run, large = rwmf.simulate(_case(x)), rwmf.simulate(_case(x, 4.0))
    assert _peak(large) == pytest.approx(_peak(run), rel=1e-6, abs=1e-12)


@_PROFILE
@given(_SCENES, st.floats(0.01, 2.0))
def test_time_shift(x: dict[str, float], t_0: float) -> None:
    run = rwmf.simulate(_case(x))
    later = rwmf.simulate(_case(x, motion={"t_0": t_0}, solver={"t_end": 3.0 + t_0}))
    assert _peak(later) == pytest.approx(_peak(run), rel=1e-6, abs=1e-12)


@_PROFILE
@given(_SCENES, st.floats(1e-3, 0.7))
def test_output_grid(x: dict[str, float], dt: float) -> None:
    """Outputs do not change the results, bit for bit."""
    run, fine = rwmf.simulate(_case(x)), rwmf.simulate(_case(x), dt=dt)
    for name in ("u_s_max", "theta_max_over_alpha", "theta_dot_max", "impacts"):
        assert run[name].item() == fine[name].item()
    assert run.attrs["steps"] == fine.attrs["steps"]


@settings(_PROFILE, max_examples=5)
@given(_SCENES, st.permutations([0.2, 0.5, 0.9, 1.4]), st.integers(1, 3))
def test_order_and_threads(x: dict[str, float], periods: list[float], threads: int) -> None:
    case = _case(x)
    first = rwmf.spectrum(case, T_s=[0.2, 0.5, 0.9, 1.4], threads=1)["u_s_max"]
    other = rwmf.spectrum(case, T_s=periods, threads=threads)["u_s_max"]
    for T_s in periods:
        assert float(first.sel(T_s=T_s).item()) == float(other.sel(T_s=T_s).item())


@pytest.mark.parametrize("method", METHODS)
def test_a_record_with_more_knots(method: str, tmp_path: Path) -> None:
    """Additional knots in the middle of straight lines do not change the motion."""
    t = 0.1 * np.arange(21)
    a = 3.0 * np.sin(5 * t) * (t < 1.95)
    both = np.linspace(0, 2, 41)
    peaks = []
    for times in (t, both):
        path = tmp_path / f"record{times.size}.txt"
        np.savetxt(path, np.column_stack([times, np.interp(times, t, a)]), fmt="%.17g")
        motion = {"kind": "record", "file": str(path), "unit": "m/s2",
                  "a_max_g": None, "omega_p": None}  # fmt: skip
        groups = scene({"motion": motion, "solver": {"t_end": 3.0, "method": method}})
        peaks.append(float(rwmf.simulate(rwmf.Case(**groups))["u_s_max"]))
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-7)
