"""`&solver accuracy` reaches its accuracy on randomly generated scenes.

The full count (240 cases) runs by `bench/accuracy_promise.py`, which also measures the cost.
"""

import re
from pathlib import Path

import numpy as np
import pytest
import rwmf
from random_cases import random_cases, with_storeys
from rwmf import cli
from scenes import coupled, record

ASKED = (1e-3, 1e-5, 1e-7, 1e-9)
# two independent methods agree to this, relative to the peak and its sensitivity
TRUSTED = 1e-11


def _peak(case: rwmf.Case, **solver: object) -> float:
    return float(rwmf.simulate(case.replace(solver=solver)).u_s_max)


def test_asked_accuracy_is_delivered(record_folder: Path) -> None:
    """The true error is at most the requested one, and the estimate is of the right size."""
    ratios = []
    for case in random_cases(24, seed=20180, records=record_folder):
        trusted = _peak(case, method="dop853", rtol=3e-14)
        other = _peak(case, method="taylor", rtol=1e-13)
        if abs(other - trusted) > TRUSTED * trusted:
            continue
        for asked in ASKED:
            result = rwmf.simulate(case.replace(solver={"accuracy": asked, "rtol": None}))
            error = abs(float(result.u_s_max) - trusted) / trusted
            assert error <= asked
            estimate = result.attrs.get("estimated_relative_error", 0.0)
            if estimate > 1e-12 and error > 1e-12:
                ratios.append(estimate / error)
    assert len(ratios) > 40, "most cases must be good enough to judge by"
    assert np.mean([0.1 <= ratio <= 10 for ratio in ratios]) >= 0.9


DEMANDS = (
    "storey_drift_max",
    "storey_2_drift_max",
    "floor_acceleration_max_g",
    "storey_1_shear_max_over_m_w_g",
    "base_shear_max_over_weight",
    "overturning_moment_max_over_weight",
    "wall_moment_max_over_m_w_g",
    "theta_dot_max",
)


@pytest.mark.slow
@pytest.mark.parametrize("storeys", [0, 3])
def test_asked_accuracy_of_demands_is_delivered(storeys: int, record_folder: Path) -> None:
    """The true error of the named peak is at most the requested one, without `&output`."""
    judged = 0
    for case in random_cases(5, seed=31 + storeys, records=record_folder):
        scene = with_storeys(case, storeys) if storeys else case
        runs = [
            rwmf.simulate(scene.replace(solver={"rtol": rtol}, output={"reactions": True}))
            for rtol in (3e-14, 1e-12)
        ]
        for name in DEMANDS:
            if name not in runs[0]:
                continue
            trusted, other = (float(run[name]) for run in runs)
            if abs(other - trusted) > 1e-10 * trusted:
                continue
            for asked in (1e-4, 1e-8):
                solver = {"accuracy": asked, "accuracy_of": name, "rtol": None}
                result = rwmf.simulate(scene.replace(solver=solver))
                error = abs(float(result[name]) - trusted) / trusted
                assert error <= asked, (name, asked)
                assert result.attrs.get("estimated_relative_error", 0.0) <= asked
                judged += 1
    assert judged > 40, "most cases must be good enough to judge by"


@pytest.mark.parametrize("name", ["elcentro", "pacoima"])
def test_an_estimate_is_never_zero_and_of_the_right_size(name: str, record_folder: Path) -> None:
    """Samples of a record may limit the steps of both runs that are compared: they differ yet."""
    ratios = []
    quantities = ("u_s_max", "estimated_relative_error")
    unit = None if name == "pacoima" else "g"
    motion = record(record_folder / f"{name}.csv", unit=unit)
    case = coupled(motion=motion, solver={"t_end": None})
    periods = list(np.linspace(0.15, 3.0, 12))
    tight = case.replace(solver={"method": "dop853", "rtol": 3e-14})
    trusted = rwmf.spectrum(tight, T_s=periods, gamma=[5.0, 200.0]).u_s_max.values
    for asked in (1e-2, 1e-4, 1e-6, 1e-9):
        solver = {"accuracy": asked, "rtol": None}
        own = case.replace(solver=solver)
        found = rwmf.spectrum(own, T_s=periods, gamma=[5.0, 200.0], quantities=quantities)
        error = np.abs(found.u_s_max.values / trusted - 1)
        estimate = found["estimated_relative_error"].values
        assert not np.any(estimate == 0)
        judged = error > 1e-13
        assert np.all(estimate[judged] > 0)
        ratios.extend(estimate[judged] / error[judged])
    assert len(ratios) > 4
    assert 0.1 < min(ratios) <= max(ratios) < 10


def test_no_estimate_is_absent() -> None:
    """A quantity that starts at its maximum has no error: no number, no key, no cell."""
    still = {"kind": "none", "a_max_g": None, "omega_p": None}
    case = coupled(
        motion=still, initial={"theta_over_alpha": 0.3}, solver={"t_end": 1.0, "verify": True}
    )
    assert "estimated_relative_error" not in rwmf.simulate(case).attrs
    quantities = ("u_s_max", "estimated_relative_error")
    found = rwmf.spectrum(case, T_s=[1.0], quantities=quantities)
    assert np.isnan(found["estimated_relative_error"].values.item())


def _pulsed(record_folder: Path, storeys: int) -> rwmf.Case:
    """Return a scene whose steps the tolerance governs, not the samples of a record."""
    cases = random_cases(20, seed=5, records=record_folder)
    case = next(case for case in cases if case.motion.kind != "record")
    lively = case.replace(motion={"a_max_g": 0.8}, cable={"eta_0": 0.5, "eta_alpha": 3.0})
    return with_storeys(lively, storeys)


def test_the_estimate_is_of_what_is_named(record_folder: Path) -> None:
    """Each peak has an error; without a name it is that of the displacement."""
    case = _pulsed(record_folder, 3)
    estimates: dict[str | None, float] = {}
    for name in (None, "u_s_max_m", "U_s_max", "floor_acceleration_max_g", "storey_1_drift_max"):
        solver = {"accuracy": 1e-10, "accuracy_of": name, "rtol": None}
        found = rwmf.simulate(case.replace(solver=solver))
        estimates[name] = found.attrs["estimated_relative_error"]
    assert 0 < estimates["u_s_max_m"] == estimates[None] == estimates["U_s_max"]
    assert len(set(estimates.values())) == 3


@pytest.mark.parametrize(
    ("solver", "problem"),
    [
        ({"accuracy_of": "storey_drift_max"}, "needs accuracy, or verify"),
        ({"verify": True, "accuracy_of": "storey_drift_mox"}, "did you mean storey_drift_max"),
        ({"verify": True, "accuracy_of": "energy_input_J_per_kg"}, "is no peak of a run"),
        ({"verify": True, "accuracy_of": "t_base_shear_max_s"}, "is no peak of a run"),
        (
            {"verify": True, "accuracy_of": "storey_1_drift_max"},
            "does not apply .* reference/outputs.md lists",
        ),
        ({"verify": True, "accuracy_of": "floor_2_acceleration_max_g"}, "does not apply"),
    ],
)
def test_what_is_named_is_a_peak_of_the_scene(
    solver: dict[str, object], problem: str, record_folder: Path
) -> None:
    case = next(random_cases(1, seed=7, records=record_folder))
    with pytest.raises(rwmf.InputError, match=f"accuracy_of = .*{problem}"):
        rwmf.simulate(case.replace(solver=solver))
    with pytest.raises(rwmf.InputError, match=f"accuracy_of = .*{problem}"):
        rwmf.spectrum(case.replace(solver=solver), T_s=[0.5, 1.0])


def test_a_check_tells_where_it_is_named(
    tmp_path: Path, record_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = _pulsed(record_folder, 2).replace(solver={"verify": True})
    path = tmp_path / "named.nml"
    for name, status in (("storey_2_drift_max", 0), ("storey_3_drift_max", 2)):
        case.replace(solver={"accuracy_of": name}).to_namelist(path)
        assert cli.main(["check", str(path)]) == status
    assert re.search(
        rf"{path}: &solver: accuracy_of = '{name}' \(line \d+\): .* does not apply",
        capsys.readouterr().err,
    )


def test_verify_estimates_the_error_of_what_is_named(record_folder: Path) -> None:
    case = _pulsed(record_folder, 2)
    name = "floor_acceleration_max_g"
    solver = {"rtol": 1e-4, "verify": True, "accuracy_of": name}
    found = rwmf.simulate(case.replace(solver=solver))
    tight = case.replace(solver={"rtol": 3e-14}, output={"reactions": True})
    trusted = float(rwmf.simulate(tight)[name])
    error = abs(float(found[name]) - trusted) / trusted
    assert error > 1e-12
    assert found.attrs["estimated_relative_error"] == pytest.approx(error, rel=0.1)


def test_estimate_of_any_run(record_folder: Path) -> None:
    """`verify` estimates the error of the default method; the sensitivity is about 1 here."""
    case = next(random_cases(1, seed=7, records=record_folder))
    found = rwmf.simulate(case.replace(solver={"rtol": 1e-6, "verify": True}))
    trusted = _peak(case, method="dop853", rtol=3e-14)
    error = abs(float(found.u_s_max) - trusted) / trusted
    assert found.attrs["estimated_relative_error"] == pytest.approx(error, rel=0.1, abs=1e-12)
    assert 0.0 < found.attrs["sensitivity"] < 100.0
