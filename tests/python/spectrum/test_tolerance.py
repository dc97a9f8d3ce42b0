"""Spectra keep their tolerance, and the compiler in use vectorises the loops of the lanes."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import rwmf
from checkout import ROOT
from random_cases import random_cases

INPUTS = ROOT / "inputs"
BUILD = ROOT / "build"
SOURCES = ROOT / "src" / "rwmf"
TRUSTED = {"method": "dop853", "rtol": 1e-13}
# error over rtol and sensitivity
PROMISED = 1.0

Array = npt.NDArray[np.float64]


def _peaks(case: rwmf.Case) -> Array:
    peaks: Array = rwmf.spectrum(case).u_s_max.values[0]
    return peaks


def _sensitivity(
    case: rwmf.Case, truth: Array, change: float, peaks: Callable[[rwmf.Case], Array] = _peaks
) -> Array:
    """Relative change of the peaks over that of the motion."""
    key = "scale" if case.motion.kind == "record" else "a_max_g"
    largest = np.zeros_like(truth)
    for sign in (-1, 1):
        value = float(getattr(case.motion, key)) * (1 + sign * change)
        other = peaks(case.replace(motion={key: value}, solver=TRUSTED))
        largest = np.maximum(largest, np.abs(other / truth - 1) / change)
    return largest


@pytest.mark.parametrize("formulation", ["published", "exact"])
@pytest.mark.parametrize(
    "name",
    [
        "fig12_one_sine",
        "fig12_one_cosine",
        "fig13_elcentro_slender_wall",
        "fig13_elcentro_squat_wall",
    ],
)
def test_shipped_spectra_keep_the_tolerance(
    name: str, formulation: str, record_folder: Path
) -> None:
    """Every eighth period of the figures: error at most rtol."""
    case = (
        rwmf.Case.from_namelist(INPUTS / f"{name}.nml")
        if "13" not in name
        else _record(name, record_folder)
    )
    changes = {"T_s_min": None, "T_s_max": None, "n": None, "spacing": None}
    changes["T_s"] = np.linspace(0.05, 3.0, 38).tolist()
    case = case.replace(spectrum=changes, model={"formulation": formulation})
    truth = _peaks(case.replace(solver=TRUSTED))
    for rtol in (1e-7, 1e-8, 1e-9):
        found = _peaks(case.replace(solver={"rtol": rtol}))
        assert np.max(np.abs(found / truth - 1)) <= rtol


def _record(name: str, record_folder: Path) -> rwmf.Case:
    """Read a case whose record is in the test's own record_folder."""
    text = (INPUTS / f"{name}.nml").read_text(encoding="utf-8")
    return rwmf.Case.from_text(
        text.replace("records/elcentro.csv", "elcentro.csv"), source=record_folder / "case.nml"
    )


def test_random_scenes_keep_the_tolerance(record_folder: Path) -> None:
    """Error at most rtol, or rtol times the sensitivity of the ordinate to its motion."""
    for case in random_cases(24, seed=8, records=record_folder):
        period = float(case.frame.T_s)
        case = case.replace(
            spectrum={"T_s": [period, 0.7 * period], "gamma": [float(case.frame.gamma), 5.0]}
        )
        truth = _peaks(case.replace(solver=TRUSTED))
        lifted = truth > 0
        for rtol in (1e-5, 1e-7, 1e-9):
            found = _peaks(case.replace(solver={"rtol": rtol}))
            error = np.abs(found[lifted] / truth[lifted] - 1)
            if np.any(error > PROMISED * rtol):
                error /= np.maximum(1.0, _sensitivity(case, truth, 10 * rtol)[lifted])
            assert np.all(error <= PROMISED * rtol), case.text


@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
def test_effects_keep_the_tolerance(formulation: str, record_folder: Path) -> None:
    """Dampers, inerters, vertical motion and a link of finite length, alone and together."""
    groups: dict[str, dict[str, object]] = {
        "damper": {"c_over_m_w": 0.5},
        "inerter": {"inertance_over_m_w": 0.2},
        "vertical": {"ratio": 0.5},
        "link": {"L": 5.0},
    }
    case = _record("fig13_elcentro_slender_wall", record_folder).replace(
        model={"formulation": formulation},
        solver={"rtol": 1e-8},
        spectrum={"T_s": [0.2, 0.5, 1.1, 2.3], "gamma": [5.0, 100.0, 2000.0]}
        | dict.fromkeys(("T_s_min", "T_s_max", "n", "spacing")),
    )
    for changes in [{name: keys} for name, keys in groups.items()] + [groups]:
        scene = case.replace(**changes)
        found = rwmf.spectrum(scene)
        truth = rwmf.spectrum(scene.replace(solver=TRUSTED))
        assert np.max(np.abs(found.u_s_max.values / truth.u_s_max.values - 1)) < 2e-8, changes


_SPRINGS: dict[str, dict[str, dict[str, object]]] = {
    "yielding frame": {"yielding": {"u_y": 0.02, "hardening": 0.05}},
    "friction": {"yielding": {"u_y": 0.02, "law": "friction", "breakaway": 1.3}},
    "flag": {"yielding": {"u_y": 0.02, "hardening": 0.02, "law": "flag", "flag_height": 0.8}},
    "wear": {
        "yielding": {"u_y": 0.01, "law": "pinched", "cap": 3, "post_cap": 4, "lambda": [20.0]}
    },
    "fuses": {"fuse": {"eta_y": 0.3, "stroke_y": 0.005, "hardening": 0.02}},
    "tendon": {"cable": {"eta_y": 1.2, "hardening": 0.02}},
    "tendon that breaks": {"cable": {"eta_y": 1.2, "rupture_strain": 0.012}},
    "all": {
        "yielding": {"u_y": 0.02, "hardening": 0.05},
        "fuse": {"eta_y": 0.3, "stroke_y": 0.005},
        "cable": {"eta_y": 1.2},
    },
}


@pytest.mark.parametrize("springs", _SPRINGS)
def test_springs_with_memory_keep_the_tolerance(springs: str, record_folder: Path) -> None:
    """Series end at the ends and turns of branches, from 1e-5 to 1e-9."""
    case = _record("fig13_elcentro_slender_wall", record_folder).replace(
        model={"formulation": "symmetric"},
        cable={"eta_0": 1.0, "eta_alpha": 5.0},
        spectrum={"T_s": [0.2, 0.5, 1.1, 2.3], "gamma": [5.0, 100.0]}
        | dict.fromkeys(("T_s_min", "T_s_max", "n", "spacing")),
    )
    case = case.replace(**_SPRINGS[springs])
    truth = rwmf.spectrum(case.replace(solver=TRUSTED)).u_s_max.values
    for rtol in (1e-5, 1e-7, 1e-9):
        found = rwmf.spectrum(case.replace(solver={"rtol": rtol})).u_s_max.values
        assert np.max(np.abs(found / truth - 1)) < 2 * rtol


def _with_p_delta(case: rwmf.Case, x: list[float]) -> rwmf.Case:
    """Take up to 1.2 times the frame's stiffness; drift limits from 0.5 to 50 %."""
    height = 2 * float(case.wall.h)
    stiffness = height / 9.81 * (2 * math.pi / float(case.frame.T_s)) ** 2
    ratio = 3 * x[0] if x[1] < 0.5 else 1.2 * x[0] * stiffness
    limit = 0.005 * 100 ** x[2]
    return case.replace(p_delta={"m_g_over_m_s": ratio, "drift_limit": limit})


def _with_initial(case: rwmf.Case, x: list[float]) -> rwmf.Case:
    """Start with 0.01 to 0.8 of the slenderness, a velocity, or both, to either side."""
    rotation = math.copysign(0.01 * 80 ** x[0], x[1] - 0.5)
    state = {"theta_over_alpha": rotation, "theta_dot": 1.4 * x[2] - 0.7}
    if x[3] < 0.6:
        del state["theta_dot" if x[3] < 0.3 else "theta_over_alpha"]
    return case.replace(initial=state)


def _without_rebound(case: rwmf.Case, _: list[float]) -> rwmf.Case:
    return case.replace(impact={"e": 0.0})


def _with_all(case: rwmf.Case, x: list[float]) -> rwmf.Case:
    return _without_rebound(_with_initial(_with_p_delta(case, x), x[3:]), x)


@pytest.mark.slow
@pytest.mark.parametrize("change", [_with_p_delta, _with_initial, _without_rebound, _with_all])
def test_random_scenes_against_single_runs(
    change: Callable[[rwmf.Case, list[float]], rwmf.Case], record_folder: Path
) -> None:
    """Ends and errors as those of single runs at their tightest; the same bits in a team."""
    rtol = 1e-7
    generator = np.random.default_rng(5)
    ends = set()
    for base in random_cases(40, seed=11, records=record_folder):
        case = change(base, generator.random(8).tolist())
        single = case.replace(solver={"rtol": rtol})
        period = float(case.frame.T_s)
        found = rwmf.spectrum(single, T_s=[period])
        peak = found.u_s_max.values.item()
        neighbours = np.linspace(0.8, 0.99, 20) * period
        team = rwmf.spectrum(single, T_s=[*neighbours, period], threads=1)
        assert team.u_s_max.values.ravel()[-1] == peak
        truth = rwmf.simulate(case.replace(solver=TRUSTED))
        end = _end_of(truth)
        assert found.status.values.item() == end, case.text
        ends.add(end)
        error = abs(peak - truth.u_s_max) / max(truth.u_s_max, 1e-300)
        if end == "ok" and error > rtol:
            error /= max(1.0, _sensitivity(case, truth.u_s_max, 10 * rtol, _peak_of_run))
        if end == "ok":
            assert error <= PROMISED * rtol, case.text
    assert change is not _with_p_delta or "collapsed" in ends


def _peak_of_run(case: rwmf.Case) -> Array:
    return rwmf.simulate(case).u_s_max


def _end_of(run: rwmf.Response) -> str:
    if getattr(run, "collapsed", False):
        return "collapsed"
    return "overturned" if run.overturned else "ok"


def test_bare_frames_keep_the_tolerance(record_folder: Path) -> None:
    """Frames alone against the tightest tolerance, damped and overdamped."""
    for xi_s in (0.02, 0.2, 1.3):
        case = rwmf.Case(
            frame={"xi_s": xi_s},
            motion={"kind": "record", "file": str(record_folder / "elcentro.csv"), "unit": "g"},
            spectrum={"T_s": np.geomspace(0.02, 8.0, 40).tolist()},
        )
        found = rwmf.spectrum(case)
        truth = rwmf.spectrum(case.replace(solver=TRUSTED))
        error = np.max(np.abs(found.u_s_max.values / truth.u_s_max.values - 1))
        assert error <= PROMISED * float(case.solver.rtol)


def test_peak_in_the_first_step_of_a_frame(tmp_path: Path) -> None:
    """A frame that starts with nothing and turns back within its first step."""
    path = tmp_path / "turns.txt"
    path.write_text("0.0 -1.3213\n0.0137 2.9329\n", encoding="utf-8")
    case = rwmf.Case(
        frame={"xi_s": 0.05},
        motion={"kind": "record", "file": str(path), "unit": "m/s2"},
        solver={"rtol": 1e-12},
        spectrum={"T_s": [0.3, 2.0, 2.2]},
    )
    found = _peaks(case)
    truth = _peaks(case.replace(solver=TRUSTED))
    assert np.max(np.abs(found / truth - 1)) < 1e-11
    # the ground turns at 0.00426 s, the frame later, and falls back before the record ends
    assert np.all(found > 1.5e-5)


def test_progress_counts_every_ordinate_once(record_folder: Path) -> None:
    """Those that are repeated for a smaller response included."""
    case = _record("fig13_elcentro_slender_wall", record_folder).replace(motion={"scale": 12.0})
    reports: list[tuple[int, int]] = []
    rwmf.spectrum(
        case,
        T_s=np.linspace(0.3, 3.0, 24),
        gamma=[5.0, 1800.0],
        progress=lambda done, total: reports.append((done, total)),
    )
    assert max(reports) == reports[-1] == (48, 48)


def test_peak_of_a_flight_that_begins_in_its_step(tmp_path: Path) -> None:
    """A wall that lifts off at rest and turns back within one step of the lanes."""
    path = tmp_path / "short.txt"
    path.write_text("0.31 5.2618\n0.3101747 -5.3772\n", encoding="utf-8")
    ramp = tmp_path / "ramp.txt"
    ramp.write_text("0.0 0.0\n0.09 4.0\n0.0901 -4.0\n0.18 -4.0\n0.1801 0.0\n", encoding="utf-8")
    for file in (path, ramp):
        case = rwmf.Case(
            wall={"h": 2.0, "b": 0.5},
            frame={"gamma": 430.0, "xi_s": 0.05},
            cable={"eta_0": 1.0, "eta_alpha": 10.0},
            impact={"e": 0.9},
            model={"formulation": "symmetric"},
            motion={"kind": "record", "file": str(file), "unit": "m/s2"},
            spectrum={"T_s": [0.5, 0.8, 2.2]},
        )
        found = _peaks(case)
        truth = _peaks(case.replace(solver=TRUSTED))
        assert np.max(np.abs(found / truth - 1)) < 1e-9, file.name


@pytest.mark.parametrize(
    ("source", "unit"),
    [
        ("integrator/lane_control.f90", "lane_unit_*.vec"),
        ("model/lanes.F90", "lane_unit_*.vec"),
        ("integrator/series/series_loops.F90", "series_unit_*.vec"),
    ],
)
def test_every_loop_is_vectorised(source: str, unit: str) -> None:
    """The compiler's report of the build names every loop that `!$omp simd` marks."""
    reports = sorted((BUILD / "src" / "rwmf" / "integrator").glob(unit))
    if not reports:
        pytest.skip("no build folder")
    for report in reports:
        named = rf"{re.escape(Path(source).name)}:(\d+):\d+: optimized: .* vectorized"
        done = {int(line) for line in re.findall(named, report.read_text(encoding="utf-8"))}
        # Before SSE 4.1 there is no instruction for a choice between two values.
        has_choice = report.stem.endswith(("_v3", "_v4"))
        missed = [
            loop
            for loop, chooses in _marked_loops(SOURCES / source)
            if not done.intersection(loop) and (has_choice or not chooses)
        ]
        assert not missed, (report.name, missed)


def _marked_loops(path: Path) -> list[tuple[range, bool]]:
    """List the loops after `!$omp simd`: lines, of which the report names one; choice."""
    lines = [line.rstrip() for line in path.read_text(encoding="utf-8").splitlines()]
    loops = []
    for number, line in enumerate(lines):
        if line.strip().startswith("!$omp simd"):
            # The report also contains the mark as the initial value of a reduction.
            begin = next(k for k in range(number, len(lines)) if lines[k].strip().startswith("do "))
            indent = lines[begin][: lines[begin].index("do ")]
            text = lines[begin : lines.index(f"{indent}end do", begin)]
            chooses = any("merge(" in part for part in text)
            loops.append((range(begin + 1, begin + len(text) + 2), chooses))
    return loops
