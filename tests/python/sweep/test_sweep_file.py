"""Files of sweeps and their command: contents and messages."""

import os
from pathlib import Path

import pytest
import rwmf
import scenes
import xarray as xr
from checkout import Runner
from rwmf import cli
from scenes import coupled

QUICK = {"method": "dop853", "rtol": 1e-6, "t_end": 2.0}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with a case, in which the command runs."""
    coupled(solver=QUICK).to_namelist(tmp_path / "case.nml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _write(folder: Path, sweep: str, grid: str) -> None:
    (folder / "s.nml").write_text(f"&sweep {sweep} /\n&grid {grid} /\n", encoding="utf-8")


def test_a_key_in_two_spellings_stands_twice(folder: Path, command: Runner) -> None:
    _write(folder, "case='case.nml', CASE='other.nml'", "e=0.9")
    found = command("sweep", "s.nml")
    assert (found.returncode, found.stdout) == (2, "")
    assert found.stderr == "rwmf: s.nml, line 1: CASE: outside of a group, or it appears twice\n"


def test_names_that_are_no_utf8(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A NetCDF file holds UTF-8: it shows the bytes of other names by their numbers."""
    place = folder / os.fsdecode(b"caf\xe9")
    place.mkdir()
    monkeypatch.chdir(place)
    record = os.fsdecode(b"r\xe9.txt")
    Path(record).write_text("0 0\n.1 .2\n.2 -.1\n", encoding="ascii")
    motion = scenes.record(Path(record))
    case = coupled(motion=motion, solver=QUICK)
    case.to_namelist("case.nml")
    text = "&sweep case='case.nml' records='" + record + "' unit='g' /\n&grid T_s=1 /\n"
    Path("s.nml").write_text(text, encoding="utf-8", errors="surrogateescape")
    assert cli.main(["sweep", "s.nml", "--out", record + ".nc"]) == 0
    with xr.open_dataset(record + ".nc", engine="h5netcdf") as found:
        assert found["record"].values.tolist() == ["r\\udce9"]
    words = ["study", "wall", "case.nml", "--T_s", "1", "--out", "w.nc", "--out", record + ".png"]
    assert cli.main(words) == 0
    xr.testing.assert_identical(
        rwmf.sweep(case, {"T_s": [1.0]}), rwmf.sweep(case, {"T_s": [1.0]}, file="x.nc").load()
    )


def test_points_in_a_file(folder: Path) -> None:
    """The table lies beside the namelist, its records beside the table."""
    (folder / "tables").mkdir()
    (folder / "tables" / "r.txt").write_text("0 0\n.1 .2\n.2 -.1\n", encoding="ascii")
    (folder / "tables" / "p.csv").write_text(
        "e,xi_s,record\n.8,.02,r.txt\n.9,.05,r.txt\n", encoding="ascii"
    )
    _write(folder, "case='case.nml', points='tables/p.csv', unit='g'", "T_s=0.5,1.0")
    assert cli.main(["sweep", "s.nml", "--out", "p.nc"]) == 0
    case = rwmf.Case.from_namelist("case.nml")
    points = {"e": [0.8, 0.9], "xi_s": [0.02, 0.05], "record": ["tables/r.txt"] * 2}
    with xr.open_dataset("p.nc", engine="h5netcdf") as found:
        assert found.sizes["point"] == 2
        expected = rwmf.sweep(case, {"T_s": [0.5, 1.0]}, points=points, unit="g")
        xr.testing.assert_identical(found.load(), expected)


def test_an_error_in_a_file_of_points(folder: Path, command: Runner) -> None:
    (folder / "p.csv").write_text("# drawn\ne,xi_s\n.8,.02\n1.2,.05\n", encoding="ascii")
    _write(folder, "case='case.nml', points='p.csv'", "T_s=0.5,1.0")
    found = command("sweep", "s.nml")
    assert found.returncode == 2
    assert found.stderr == (
        "rwmf: s.nml: sweep, p.csv, line 4: case.nml: &impact: e = 1.2: "
        "must be a number in [0, 1] [-]\n"
    )
