"""Sweeps in files: resuming, parts, refusals; the bytes never depend on interruptions."""

import fcntl
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import Runner
from rwmf.errors import InputError
from rwmf.sweeps.computation import merge
from scenes import coupled

CASE_SOLVER = {"method": "dop853", "rtol": 1e-6, "t_end": 3.0}
GRID = {"e": [0.8, 0.85, 0.9], "scale": [0.5, 1.0], "T_s": [0.5, 1.0], "gamma": [5.0, 50.0]}
# number required by the issue
KILLS = 10


def _sweep(file: Path, **how: object) -> xr.Dataset:
    with rwmf.sweep(coupled(solver=CASE_SOLVER), GRID, file=file, chunk=2, **how) as found:
        return found.load()


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the file of an undisturbed sweep."""
    path = tmp_path_factory.mktemp("whole") / "whole.nc"
    _sweep(path)
    return path


def test_file_is_what_memory_has(whole: Path) -> None:
    in_memory = rwmf.sweep(coupled(solver=CASE_SOLVER), GRID, chunk=2)
    with xr.open_dataset(whole, engine="h5netcdf") as found:
        xr.testing.assert_identical(found.load(), in_memory)
    assert list(whole.parent.iterdir()) == [whole]


def test_the_same_sweep_is_not_computed_again(whole: Path) -> None:
    before = whole.stat().st_mtime_ns
    _sweep(whole)
    assert whole.stat().st_mtime_ns == before


def test_interrupted_in_python(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "whole.nc"

    def interrupt(done: int, _: int) -> None:
        if done >= 8:
            raise KeyboardInterrupt

    with pytest.raises(rwmf.Interrupted, match="chunks are kept"):
        _sweep(path, progress=interrupt, threads=1)
    assert not path.exists()
    reports: list[int] = []
    _sweep(path, progress=lambda done, _: reports.append(done))
    assert reports[0] >= 8
    assert path.read_bytes() == whole.read_bytes()


def test_torn_entries_are_computed_again(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "whole.nc"
    _sweep(path, progress=_keep_journal(path))
    content = (tmp_path / "kept").read_bytes()
    journal = path.with_name("whole.nc.journal")
    for size in (0, 5, 30, 700, len(content) - 1):
        path.unlink(missing_ok=True)
        # remains of a killed process or a full disk
        journal.write_bytes(content[:size] + (b"\0" * 3 if size > 30 else b""))
        _sweep(path)
        assert path.read_bytes() == whole.read_bytes(), size


def _keep_journal(path: Path) -> Callable[[int, int], None]:
    def keep(_: int, __: int) -> None:
        journal = path.with_name(path.name + ".journal")
        if journal.exists():
            path.with_name("kept").write_bytes(journal.read_bytes())

    return keep


def test_another_case_is_refused(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "whole.nc"
    path.write_bytes(whole.read_bytes())
    other = coupled(solver=CASE_SOLVER | {"rtol": 1e-7})
    with pytest.raises(InputError, match=r"(?s)-.*rtol = 1e-06.*\+.*rtol = 1e-07"):
        rwmf.sweep(other, GRID, file=path, chunk=2)
    assert path.read_bytes() == whole.read_bytes()
    with rwmf.sweep(other, GRID, file=path, chunk=2, restart=True) as found:
        assert "1e-07" in found.attrs["case"]
    path.write_text("hello", encoding="ascii")
    with pytest.raises(InputError, match="is not the result of a sweep"):
        _sweep(path)


def test_another_vertical_record_is_refused(tmp_path: Path) -> None:
    """Its file is read again, beside records that are an axis of the sweep."""
    times = np.arange(100) * 0.02
    for name, size in (("a", 1.0), ("b", 2.0), ("up", 0.5)):
        np.savetxt(tmp_path / f"{name}.csv", np.c_[times, size * np.sin(times)], delimiter=",")
    keys = {"unit": "m/s2", "file": str(tmp_path / "up.csv")}
    case = coupled(solver=CASE_SOLVER, vertical=keys)
    records = [tmp_path / "a.csv", tmp_path / "b.csv"]

    def sweep() -> None:
        rwmf.sweep(case, {"T_s": [0.5]}, records, tmp_path / "s.nc", unit="m/s2").close()

    sweep()
    sweep()
    np.savetxt(tmp_path / "up.csv", np.c_[times, np.cos(times)], delimiter=",")
    with pytest.raises(InputError, match="another sweep"):
        sweep()


def test_parts_and_merge(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "whole.nc"
    for k in (3, 1):
        _sweep(path, part=(k, 3))
    parts = sorted(tmp_path.glob("*.journal"))
    with pytest.raises(InputError, match="a part is missing"):
        merge(parts, path)
    _sweep(path, part=(2, 3))
    merge(sorted(tmp_path.glob("*.journal")), path).close()
    assert path.read_bytes() == whole.read_bytes()


def _start(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "rwmf", "sweep", "sweep.nml", "--out", "out.nc"],
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


@pytest.fixture
def sweep_file(tmp_path: Path) -> Path:
    """Write the namelist of a sweep of about half a second."""
    coupled(solver={"t_end": 6.0, "method": "dop853"}).to_namelist(tmp_path / "case.nml")
    path = tmp_path / "sweep.nml"
    path.write_text(
        "! e over many small chunks\n&sweep\n case = 'case.nml', chunk = 2\n/\n&grid\n"
        f" e = {', '.join(str(x) for x in np.linspace(0.7, 0.95, 30).round(4))}\n"
        " T_s = 0.3, 0.5, 1.0, 2.0 gamma = 5, 50\n/\n",
        encoding="ascii",
    )
    return path


@pytest.mark.slow
def test_killed_at_random_instants(sweep_file: Path) -> None:
    folder = sweep_file.parent
    started = time.perf_counter()
    _, errors = _start(folder).communicate()
    seconds = time.perf_counter() - started
    (folder / "out.nc").rename(folder / "whole.nc")
    chance = random.Random(9)
    for _ in range(KILLS):
        process = _start(folder)
        time.sleep(chance.uniform(0.3, 0.9) * seconds)
        process.send_signal(signal.SIGKILL)
        process.communicate()
    process = _start(folder)
    output, errors = process.communicate()
    assert process.returncode == 0, errors
    assert "240 runs" in output
    assert (folder / "out.nc").read_bytes() == (folder / "whole.nc").read_bytes()


def test_ctrl_c_on_the_command_line(sweep_file: Path) -> None:
    endless = coupled(motion={"kind": "sine", "cycles": 1e6}, solver={"t_end": 1e6})
    endless.to_namelist(sweep_file.with_name("case.nml"))
    with _start(sweep_file.parent) as process:
        journal = sweep_file.with_name("out.nc.journal")
        while process.poll() is None and not journal.exists():
            time.sleep(0.05)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        try:
            _, errors = process.communicate(timeout=10)
        finally:
            process.kill()
    assert process.returncode == 130, errors
    assert "the same command continues" in errors
    assert not (sweep_file.parent / "out.nc").exists()


def test_a_journal_that_another_process_writes(sweep_file: Path, command: Runner) -> None:
    journal = sweep_file.with_name("out.nc.journal")
    with journal.open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        found = command("sweep", sweep_file, "--out", "out.nc")
    assert found.returncode == 2
    assert "another process writes it" in found.stderr
    assert journal.stat().st_size == 0
