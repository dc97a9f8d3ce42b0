"""``rwmf new``, several cases in ``rwmf run``, and the JSON schema of a case."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT, Runner
from rwmf import cli
from rwmf.case.json_schema import make_schema
from scenes import block, coupled


@pytest.mark.parametrize(("storeys", "width"), [(1, 2.0), (6, 4.0), (12, 0.0)])
def test_a_new_case_has_the_numbers_of_the_answers(
    storeys: int, width: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each answer by the value that the kernel derives from the file."""
    answers = iter([str(storeys), "heavy", "90e3", "0.8", str(width)])
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", lambda _: next(answers))
    path = tmp_path / "new.nml"
    assert cli.main(["new", "--out", str(path)]) == 0
    assert next(answers, None) is None
    run = rwmf.simulate(path)
    case = rwmf.Case.from_namelist(path)
    assert len(case.storeys.height) == storeys
    assert float(run["T_s"]) == pytest.approx(0.8, rel=1e-9)
    assert (case.wall is not None) == (width > 0)
    if width:
        assert 2 * case.wall.b == width
        assert case.storeys.coupling == "springs" and case.bending is not None
        assert case.storeys.in_si["m_over_m_w"][0] == pytest.approx([90e3] * storeys)
    # a light wall beside one storey leaves the ground
    assert run.attrs["warnings"] == "" or storeys == 1
    assert "rigid" not in run.attrs["warnings"] and "landings" not in run.attrs["warnings"]
    assert cli.main(["new", "--out", str(path), "--storeys", "2"]) == 2, "exists"


def test_a_table_of_cases(command: Runner, batch: Runner, tmp_path: Path) -> None:
    """Rows are the results of the single runs; a case that fails has a row with its message."""
    coupled(solver={"t_end": 1.0}).to_namelist(tmp_path / "a.nml")
    block().to_namelist(tmp_path / "b.nml")
    coupled(solver={"t_end": 0.5}).to_namelist(tmp_path / "c.nml")
    (tmp_path / "bad.nml").write_text("&wall h = 1.0 /\n")
    assert batch("c.nml").returncode == 0
    words = ("run", "a.nml", "b.nml", "c.summary.csv", "bad.nml")
    tables = {}
    for suffix in ("csv", "nc", "jsonl"):
        found = command(*words, "--out", f"t.{suffix}")
        assert found.returncode == 1
        assert "bad.nml: warning: failed: bad.nml: &wall (line 1): the key b" in found.stderr
        assert "3 of 4 cases have a result" in found.stderr
    with (tmp_path / "t.csv").open() as stream:
        tables["csv"] = list(csv.DictReader(stream))
    tables["jsonl"] = [json.loads(x) for x in (tmp_path / "t.jsonl").read_text().splitlines()]
    netcdf = xr.load_dataset(tmp_path / "t.nc")
    for i, name in enumerate(("a", "b", "c")):
        alone = json.loads(command("run", f"{name}.nml", "--json").stdout)
        keys = [key for key, x in alone.items() if isinstance(x, float) and key != "seconds"]
        assert len(keys) > 5
        for key in keys:
            assert tables["jsonl"][i][key] == alone[key]
            assert float(tables["csv"][i][key]) == alone[key]
            assert float(netcdf[key][i]) == alone[key]
    assert [row["status"] for row in tables["csv"]] == ["ok", "ok", "ok", "failed"]
    assert np.isnan(netcdf["u_s_max_m"].values[[1, 3]]).all(), "no frame, no result"
    assert netcdf["t_u_s_max_s"].attrs["units"] == "s"
    assert netcdf["case"].values.tolist() == list(words[1:])


def test_a_table_is_not_written_over_a_record(command: Runner, tmp_path: Path) -> None:
    record = tmp_path / "quake.csv"
    rwmf.Motion([0.0, 1.0, -1.0, 0.0], dt=0.1, unit="m/s2").write(record)
    before = record.read_bytes()
    (tmp_path / "a.nml").write_text(
        "&frame T_s = 1.0, xi_s = 0.05 /\n"
        "&motion kind = 'record', file = 'quake.csv', unit = 'm/s2', dt = 0.1 /\n"
    )
    found = command("run", "a.nml", "--out", "quake.csv")
    assert (found.returncode, record.read_bytes()) == (2, before)
    assert "is read by this run" in found.stderr


def test_every_input_fits_the_schema() -> None:
    validator = pytest.importorskip("jsonschema").Draft202012Validator
    schema = make_schema()
    validator.check_schema(schema)
    valid = validator(schema)
    paths = sorted((ROOT / "inputs").glob("*.nml"))
    assert len(paths) > 50
    for path in paths:
        case = rwmf.Case.from_namelist(path)
        given = {name: dict(group.as_given()) for name, group in case.groups.items()}
        given = {name: keys for name, keys in given.items() if keys}
        # as in a file of JSON
        problems = list(valid.iter_errors(json.loads(json.dumps(given))))
        assert not problems, (path, problems[0].message, list(problems[0].path))
    for wrong in (
        {"wall": {"h": 1.0}},
        {"wall": {"h": -1.0, "b": 1.0}},
        {"wall": {"h": 1.0, "b": 1.0, "hight": 1.0}},
        {"wall": {"h": 1.0, "b": 1.0, "base": "glued"}},
        {"wall": {"h": 1.0, "b": 1.0, "walls": 51}},
        {"cable": {"eta_0": 1.0}},
        {"walls": {}},
    ):
        assert list(valid.iter_errors(wrong)), wrong
        with pytest.raises(rwmf.InputError):
            rwmf.Case(**wrong)


def test_check_as_json(command: Runner, tmp_path: Path) -> None:
    (tmp_path / "bad.nml").write_text("&wall h = 1.0 /\n")
    found = command("check", "bad.nml", "--json")
    answer = json.loads(found.stdout)
    assert (found.returncode, answer["valid"]) == (2, False)
    assert "&wall (line 1): the key b is missing" in answer["error"]
    assert json.loads(command("check", "--schema").stdout) == make_schema()
