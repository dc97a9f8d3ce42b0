"""``rwmf pushover``: table, JSON and CSV agree with the dataset; its errors."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import Runner


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    """Write a case with storeys, fuses and masses in kg."""
    path = tmp_path / "case.nml"
    rwmf.Case(
        wall={"h": 4.0, "b": 1.0, "m_w": 2.0e4},
        frame={"xi_s": 0.05},
        storeys={"m_over_m_w": [2.0, 1.5], "k_over_m_w": [900.0, 700.0], "height": [4.2, 3.8],
                 "coupling": "full"},
        yielding={"storey_u_y": 0.02},
        fuse={"eta_y": 0.3, "stroke_y": 0.004},
        motion={"kind": "one_sine", "a_max_g": 0.4, "T_p": 0.8},
        model={"formulation": "exact"},
        solver={"t_end": 2.0},
    ).to_namelist(path)  # fmt: skip
    return path


def test_json_and_csv(command: Runner, case_file: Path, tmp_path: Path) -> None:
    """The numbers of both are those of the dataset, bit for bit."""
    table = tmp_path / "curve.csv"
    words = ("--drifts", "0.01,-0.01", "--steps", "20", "--out", str(table), "--json")
    found = command("pushover", str(case_file), *words)
    assert found.returncode == 0, found.stderr
    result = json.loads(found.stdout)
    curve = rwmf.pushover(str(case_file), (0.01, -0.01), steps=20)
    for key, name in (
        ("roof_drift", "roof_drift"),
        ("base_shear_over_weight", "base_shear_over_weight"),
        ("base_shear_N", "base_shear"),
        ("overturning_moment_N_m", "overturning_moment"),
        ("storey_2_shear_N", "storey_2_shear"),
        ("floor_1_m", "floor_1"),
        ("fuse_left_force_N", "fuse_left_force"),
    ):
        assert np.array_equal(result[key], curve[name].values), key
    assert [mark["name"] for mark in result["marks"]] == curve["mark"].values.tolist()
    with table.open(encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == curve.sizes["step"]
    assert [float(row["roof_drift"]) for row in rows] == result["roof_drift"]
    named = [name for row in rows for name in row["marks"].split()]
    assert named == curve["mark"].values.tolist()
    assert set(rows[0]) - {"step", "marks"} == {
        key for key, value in result.items() if isinstance(value, list) and len(value) == len(rows)
    }


def test_table(command: Runner, case_file: Path) -> None:
    found = command("pushover", str(case_file), "--pattern", "1,3")
    assert found.returncode == 0
    assert "floors: 0.25, 0.75 of the base shear" in found.stdout
    for words in (
        "base shear (kN)",
        "moment (kN m)",
        "wall lifts off",
        "left fuse yields",
        "storey 1 yields",
    ):
        assert words in found.stdout
