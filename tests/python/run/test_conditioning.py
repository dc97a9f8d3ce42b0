"""Sensitivities of the peaks to the motion: closed forms, defaults, sweeps, printed digits."""

import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
from bending_scenes import bending_scene
from checkout import Runner
from rwmf.kernel import tables

RECORD = rwmf.Motion(
    0.3 * np.sin(np.arange(600) * 0.02 * 5.0) * np.exp(-np.arange(600) * 0.003), dt=0.02, unit="g"
)
FRAME = {"frame": {"T_s": 0.8, "xi_s": 0.05}, "solver": {"t_end": 14.0}}
WALL = {
    "wall": {"h": 4.0, "b": 1.0},
    "frame": {"T_s": 1.2, "xi_s": 0.05, "gamma": 10.0},
    "cable": {"eta_0": 0.5, "eta_alpha": 3.0},
    "impact": {"rule": "coupled"},
    "solver": {"t_end": 14.0},
}
# 0.1 % below the amplitude that overturns the block
BLOCK = {
    "wall": {"h": 2.0, "b": 0.5},
    "impact": {"rule": "constant", "e": 0.9},
    "motion": {"kind": "one_sine", "a_max_g": 0.742, "omega_p": 9.446},
    "solver": {"t_end": 14.0},
}


def _sensitivities(run: rwmf.Response) -> dict[str, float]:
    return {
        key.removeprefix("sensitivity_"): value
        for key, value in run.flat().items()
        if key.startswith("sensitivity_")
    }


@pytest.mark.parametrize("rtol", [1e-12, 1e-9, 1e-6, 1e-4])
def test_a_linear_frame_has_the_sensitivity_1(rtol: float) -> None:
    case = rwmf.Case(**FRAME).replace(
        motion=RECORD, output={"reactions": True}, solver={"rtol": rtol}
    )
    found = _sensitivities(rwmf.simulate(case))
    assert {"u_s_max_m", "base_shear_max_over_weight", "floor_acceleration_max_g"} <= set(found)
    for name, value in found.items():
        assert value == pytest.approx(1.0, abs=1e-2 if rtol > 1e-5 else 1e-3), name


@pytest.mark.parametrize("groups", [WALL, BLOCK])
def test_it_is_the_difference_of_runs(groups: dict[str, dict[str, object]]) -> None:
    """Two runs with tight tolerances and a motion that is 1e-6 weaker or stronger."""
    case = rwmf.Case(**groups)
    if "motion" not in groups:
        case = case.replace(motion=RECORD)
    found = _sensitivities(rwmf.simulate(case.replace(output={"reactions": True})))
    tight = case.replace(output={"reactions": True, "conditioning": False})
    tight = tight.replace(solver={"rtol": 1e-12})
    ends = []
    for factor in (1 - 1e-6, 1 + 1e-6):
        if "motion" in groups:
            other = tight.replace(motion={"a_max_g": factor * 0.742})
        else:
            values = factor * np.asarray(RECORD.values)
            other = tight.replace(motion=rwmf.Motion(values, dt=0.02, unit=RECORD.unit))
        ends.append(rwmf.simulate(other))
    assert len(found) >= 10
    for name in ("theta_max_over_alpha", "theta_dot_max_rad_s"):
        below, above = (end.flat()[name] for end in ends)
        expected = abs(above - below) / (above + below) / 1e-6
        assert found[name] == pytest.approx(expected, rel=2e-2), name


def test_a_run_that_nearly_overturns_has_a_warning() -> None:
    """Bisect the amplitude: beside overturning the rotation is sensitive without bound."""
    case = rwmf.Case(**BLOCK)
    low, high = 0.742, 0.744
    for _ in range(16):
        middle = (low + high) / 2
        run = rwmf.simulate(case.replace(motion={"a_max_g": middle}))
        low, high = (low, middle) if bool(run["overturned"]) else (middle, high)
    run = rwmf.simulate(case.replace(motion={"a_max_g": low}))
    assert float(run["sensitivity_theta_max_over_alpha"]) > 100
    # the wall also has a warning of its e
    (told,) = (x for x in run.attrs["warnings"].splitlines() if x.startswith("sensitive: "))
    assert "theta_max_over_alpha" in told


def test_reported_unless_switched_off_or_without_motion() -> None:
    case = rwmf.Case(**WALL).replace(motion=RECORD)
    on = rwmf.simulate(case)
    off = rwmf.simulate(case.replace(output={"conditioning": False}))
    free = rwmf.simulate(
        rwmf.Case(**WALL).replace(initial={"theta_over_alpha": 0.5, "theta_dot": 0.0})
    )
    assert _sensitivities(on)
    assert not _sensitivities(off)
    assert not _sensitivities(free)
    for name, value in off.flat().items():
        if name != "seconds":
            assert on.flat()[name] == value, name
    assert on.attrs["rhs_evaluations"] == off.attrs["rhs_evaluations"]


def test_of_verify_is_the_sensitivity_of_its_peak() -> None:
    case = rwmf.Case(**WALL).replace(motion=RECORD, solver={"verify": True})
    run = rwmf.simulate(case)
    assert run.attrs["sensitivity"] == float(run["sensitivity_u_s_max"])


@pytest.mark.parametrize("method", ["auto", "dop853", "adams", "taylor"])
def test_spectra_agree_with_runs(method: str) -> None:
    case = rwmf.Case(**WALL).replace(motion=RECORD, solver={"method": method})
    names = ("u_s_max", "theta_max_over_alpha", "impacts")
    plain = rwmf.spectrum(case, T_s=[0.6, 1.2], quantities=names)
    assert not [name for name in plain.data_vars if str(name).startswith("sensitivity")]
    both = rwmf.spectrum(
        case.replace(output={"conditioning": True}), T_s=[0.6, 1.2], quantities=names
    )
    xr_names = {"sensitivity_u_s_max", "sensitivity_theta_max_over_alpha"}
    assert xr_names == {str(n) for n in both.data_vars if str(n).startswith("sensitivity")}
    for name in names:
        assert (plain[name].values == both[name].values).all()
    run = rwmf.simulate(case)
    for name in xr_names:
        here = float(both[name].sel(T_s=1.2).squeeze())
        assert here == pytest.approx(float(run[name]), rel=2e-3), name


def test_sweeps_and_points() -> None:
    case = rwmf.Case(**WALL).replace(motion=RECORD, output={"conditioning": True})
    found = rwmf.sweep(case, {"xi_s": [0.02, 0.05]}, quantities=("u_s_max", "overturned"))
    assert found["sensitivity_u_s_max"].shape == found["u_s_max"].shape
    run = rwmf.simulate(case)
    value = float(found["sensitivity_u_s_max"].sel(xi_s=0.05).squeeze())
    assert value == pytest.approx(float(run["sensitivity_u_s_max"]), rel=2e-3)
    points = rwmf.sweep(
        case.replace(output={"conditioning": None}),
        points={"T_s": [1.2], "scale": [1.0]},
        quantities=("sensitivity_u_s_max",),
    )
    assert float(points["sensitivity_u_s_max"].squeeze()) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize("number", range(6))
def test_of_walls_that_bend(number: int) -> None:
    """Impacts that stop the wall, and contact, included: a difference of runs, within its bound."""
    groups, record = bending_scene(number)
    case = rwmf.Case(**groups).replace(output={"reactions": True})

    def shaken(factor: float) -> rwmf.Case:
        if record is None:
            return case.replace(motion={"a_max_g": factor * groups["motion"]["a_max_g"]})
        values = factor * np.array(record["values"])
        return case.replace(motion=rwmf.Motion(values, times=record["times"], unit="m/s2"))

    run = rwmf.simulate(shaken(1))
    found = _sensitivities(run)
    assert {"theta_max_over_alpha", "wall_moment_mid_max_over_m_w_g_m"} <= set(found)
    assert all(0 <= value <= 1.001e5 for value in found.values())
    near = rwmf.simulate(shaken(1 + 1e-5).replace(output={"conditioning": False}))
    here, there = (x.flat()["wall_moment_mid_max_over_m_w_g_m"] for x in (run, near))
    expected = abs(there / here - 1) / 1e-5
    assert found["wall_moment_mid_max_over_m_w_g_m"] == pytest.approx(expected, rel=1e-3, abs=1e-3)


def test_a_probe_that_bounces_a_million_times_ends() -> None:
    # at the amplitude that lifts the wall off, with an impact that loses nothing
    verge = {
        "wall": {"h": 2.0, "b": 0.5},
        "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
        "impact": {"rule": "none"},
        "motion": {"kind": "one_sine", "a_max_g": 0.5, "omega_p": 8.0},
        "model": {"formulation": "symmetric"},
        "solver": {"t_end": 2.0, "rtol": 1e-8},
    }
    run = rwmf.simulate(rwmf.Case(**verge))
    assert not _sensitivities(run)
    assert "the run takes more than 20000 steps" in run.attrs["warnings"]


def test_peaks_that_are_round_off_have_none() -> None:
    """Equilibrium leaves no moment at the top of a wall whose roof is its top."""
    storeys = {
        "n": 3, "m_over_m_w": 2.0, "height": 8 / 3, "k_over_m_w": 2000.0, "coupling": "every_floor",
    }  # fmt: skip
    case = rwmf.Case(**WALL).replace(frame={"T_s": None, "gamma": None}, storeys=storeys)
    case = case.replace(motion=RECORD, output={"reactions": True})
    key = "wall_moment_3_above_max_over_m_w_g_m"
    run = rwmf.simulate(case)
    assert abs(run.flat()[key]) < 1e-10
    assert run.flat()[f"sensitivity_{key}"] == 0
    both = rwmf.sweep(case, {"xi_s": [0.03, 0.05]}, quantities=(key, f"sensitivity_{key}"))
    assert (both[f"sensitivity_{key.removesuffix('_m')}"].values == 0).all()


@pytest.mark.parametrize("word", ["sensitivity_impacts", "sensitivity_t_u_s_max", "sensitivity_x"])
def test_others_than_peaks_have_none(word: str) -> None:
    case = rwmf.Case(**WALL).replace(motion=RECORD)
    with pytest.raises(rwmf.InputError):
        rwmf.spectrum(case, T_s=[1.2], quantities=(word,))


@pytest.mark.parametrize(
    ("rtol", "sensitivity", "digits"),
    [
        (1e-9, 1.0, 7),
        (1e-9, 0.0, 7),
        (1e-9, 12.0, 5),
        (1e-6, 1.0, 5),
        (1e-9, 1e4, 1),
        (0.1, 1, 3),
        (1e-2, 99, 3),
        (1e-2, 100, 1),
    ],
)
def test_digits_that_hold(rtol: float, sensitivity: float, digits: int) -> None:
    assert tables.digits_of(rtol, sensitivity) == digits


def test_the_terminal_prints_the_digits_that_hold(command: Runner, tmp_path: Path) -> None:
    path = tmp_path / "block.nml"
    rwmf.Case(**BLOCK).to_namelist(path)
    full = json.loads(command("run", path, "--json").stdout)
    shown = command("run", path, "--all").stdout
    lines = {line.split()[0]: line.split() for line in shown.splitlines()}
    assert not [key for key in lines if key.startswith("sensitivity_")]
    key = "theta_max_over_alpha"
    digits = tables.digits_of(1e-9, full[f"sensitivity_{key}"])
    assert digits < 7
    assert lines[key][1] == f"{full[key]:.{digits}g}"
    assert lines[key][2:] == ["(sensitivity", f"{full[f'sensitivity_{key}']:.2g})"]
    assert lines["e"][1] == "0.9"
