"""Batch program, Python and JSON give the same bits for the same case."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import Runner
from scenes import bare_frame, block, coupled, read_table, record

# differs from run to run
_TIMING = "seconds"


@pytest.fixture(params=["coupled", "bare", "block", "record", "paper"])
def case_file(request: pytest.FixtureRequest, tmp_path: Path, elcentro: Path) -> Path:
    """Write one of several scenes with a history."""
    output = {"dt": 0.02}
    scenes = {
        "coupled": lambda: coupled(wall={"m_w": 1920.0}, output=output | {"energy": True}),
        "bare": lambda: bare_frame(output=output),
        "block": lambda: block(initial={"theta_over_alpha": 0.4}, output=output),
        "paper": lambda: coupled(
            model={"formulation": "published"}, solver={"method": "paper"}, output=output
        ),
        "record": lambda: coupled(
            motion=record(elcentro), solver={"t_end": None, "method": "dop853"}, output=output
        ),
    }
    path = tmp_path / "scene.nml"
    scenes[request.param]().to_namelist(path)
    return path


def test_run(case_file: Path, batch: Runner, command: Runner) -> None:
    assert batch(case_file).returncode == 0
    _, (row,) = read_table(case_file.with_name("scene.summary.csv"))
    shown = json.loads(command("run", case_file, "--json").stdout)
    assert list(row) == list(shown)
    for key, value in shown.items():
        if isinstance(value, bool):
            assert row[key] == str(value).lower()
        elif isinstance(value, int | float) and key != _TIMING:
            assert float(row[key]) == value, key
    dataset = rwmf.simulate(rwmf.Case.from_namelist(case_file))
    if "u_s_max_m" in shown:
        assert float(dataset["u_s_max"]) == shown["u_s_max_m"]


def test_history(case_file: Path, batch: Runner) -> None:
    assert batch(case_file).returncode == 0
    _, rows = read_table(case_file.with_name("scene.history.csv"))
    dataset = rwmf.simulate(rwmf.Case.from_namelist(case_file))
    columns = {"t_s": "time", "u_g_ddot_m_s2": "u_g_ddot"}
    if "theta" in dataset:
        columns |= {"theta_rad": "theta", "theta_dot_rad_s": "theta_dot"}
    if "u_s" in dataset:
        columns |= {"u_s_m": "u_s", "u_s_dot_m_s": "u_s_dot"}
    for column, name in columns.items():
        written = np.array([float(row[column]) for row in rows])
        assert np.array_equal(written, dataset[name].values, equal_nan=True), column


def test_command_writes_the_files_of_the_batch_program(
    case_file: Path, batch: Runner, command: Runner, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    assert batch(case_file).returncode == 0
    assert command("run", case_file, "--out", folder).returncode == 0
    history = "scene.history.csv"
    assert (folder / history).read_bytes() == (tmp_path / history).read_bytes()
    assert (folder / "scene.summary.csv").is_file()


@pytest.mark.parametrize("bare", [False, True])
def test_spectrum(bare: bool, tmp_path: Path, batch: Runner, command: Runner) -> None:
    grid = {"T_s_min": 0.4, "T_s_max": 1.6, "n": 4}
    path = tmp_path / "scene.nml"
    if bare:
        bare_frame(spectrum=grid).to_namelist(path)
    else:
        coupled(spectrum=grid | {"gamma": [5.0, 100.0], "b": [0.5, 1.0]}).to_namelist(path)
    assert batch(path).returncode == 0
    _, rows = read_table(tmp_path / "scene.spectrum.csv")
    ours = command("spectrum", path, "--json", "--out", "ours.csv", "--threads", "2")
    shown = json.loads(ours.stdout)
    written = np.array([float(row["u_s_max_m"]) for row in rows])
    assert np.array_equal(np.ravel(shown["u_s_max_m"]), written)
    assert [row["status"] for row in rows] == list(np.ravel(shown["status"]))
    dataset = rwmf.spectrum(rwmf.Case.from_namelist(path))
    assert np.array_equal(dataset["u_s_max"].values.ravel(), written)
    keys = ["T_s_s", "gamma", "b_m", "u_s_max_m", "status", "method", "seconds", "threads"]
    keys = [key for key in keys if not (bare and key in ("gamma", "b_m"))]
    assert list(shown) == [*keys, "rhs_evaluations", "warnings"]
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "scene.spectrum.csv").read_bytes()


def test_round_trip_gives_the_same_bits(elcentro: Path, tmp_path: Path) -> None:
    """Text -> case -> text -> case, in another folder."""
    first = coupled(motion=record(elcentro), frame={"T_s": 0.1 + 0.2}, solver={"t_end": None})
    path = tmp_path / "elsewhere" / "copy.nml"
    path.parent.mkdir()
    first.to_namelist(path)
    second = rwmf.Case.from_namelist(path)
    assert second.frame.T_s == 0.1 + 0.2
    assert float(rwmf.simulate(second)["u_s_max"]) == float(rwmf.simulate(first)["u_s_max"])
