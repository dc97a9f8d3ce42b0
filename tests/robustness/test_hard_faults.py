"""Faults: failed computations and writes end with a helpful error."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
import rwmf
from checkout import BATCH
from hard_scenes import METHODS, Groups, Hard, quiet
from processes import compute

_ENDLESS: Groups = {
    "impact": {"e": 1.0},
    "motion": quiet(),
    "initial": {"theta_over_alpha": 0.2},
    "frame": {"xi_s": 0.0},
    "solver": {"t_end": 1e9, "max_steps": 2_000_000_000},
}


def _write(tmp_path: Path, groups: Groups, name: str = "case") -> Path:
    path = tmp_path / f"{name}.nml"
    Hard(name, groups).build(tmp_path).to_namelist(path)
    return path


@pytest.mark.parametrize("method", METHODS)
def test_too_many_steps(method: str, tmp_path: Path) -> None:
    hard = Hard("steps", {"solver": {"t_end": 1000.0, "max_steps": 20}})
    with pytest.raises(rwmf.NumericalError) as error:
        rwmf.simulate(hard.build(tmp_path, method))
    assert re.search(r"max_steps.*t = .* s, theta = .*raise max_steps", str(error.value))


def test_more_events_than_a_stack_holds(tmp_path: Path) -> None:
    """Bouncing without loss: all events are kept, though 8 MiB of stack hold 262,144 of them."""
    bouncing = _ENDLESS | {
        "frame": None,
        "cable": None,
        "initial": {"theta_over_alpha": 1e-8},
        "solver": {"t_end": 25.0},
    }
    run = rwmf.simulate(Hard("events", bouncing, rtol=1e-3).build(tmp_path, "dop853"), dt=1.0)
    assert run.sizes["event"] > 262_144
    assert (run["event"].values == "impact").sum() == int(run["impacts"])


@pytest.mark.parametrize("method", METHODS)
def test_tolerance_beyond_the_precision(method: str, tmp_path: Path) -> None:
    """Either a result within round-off or an error that names time, state and a remedy."""
    hard = Hard("tight", {"solver": {"t_end": 2.0, "max_steps": 100_000}}, rtol=1e-14)
    loose = Hard("loose", {"solver": {"t_end": 2.0}}, rtol=1e-12)
    expected = float(rwmf.simulate(loose.build(tmp_path, "dop853"))["u_s_max"])
    try:
        found = float(rwmf.simulate(hard.build(tmp_path, method))["u_s_max"])
    except rwmf.NumericalError as error:
        assert re.search(r"t = .* s, theta = .*(rtol|tolerance|max_steps)", str(error))
    else:
        assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_motion_beyond_the_numbers(method: str, tmp_path: Path) -> None:
    """1e300 g: an error, or the wall overturns at once; never a NaN without a word."""
    hard = Hard("huge", {"motion": {"a_max_g": 1e300}, "solver": {"max_steps": 100_000}})
    try:
        run = rwmf.simulate(hard.build(tmp_path, method))
    except rwmf.NumericalError as error:
        assert "t = " in str(error)
    else:
        assert bool(run["overturned"])


def test_no_memory_for_the_history(tmp_path: Path) -> None:
    hard = Hard("memory", {"output": {"dt": 1e-300}})
    with pytest.raises(rwmf.NumericalError, match=r"out of memory for the history.*raise dt"):
        rwmf.simulate(hard.build(tmp_path))


def test_a_failed_ordinate_does_not_stop_the_others(tmp_path: Path) -> None:
    hard = Hard("some", {"solver": {"max_steps": 300}, "frame": {"T_s": None}})
    grid = {"T_s_min": 0.01, "T_s_max": 3.0, "n": 6, "spacing": "log"}
    case = Hard("some", {**hard.groups, "spectrum": grid}).build(tmp_path, "dop853")
    status = [str(value) for value in rwmf.spectrum(case)["status"].values.flat]
    assert "too_many_steps" in status
    assert "ok" in status


def test_full_disk(tmp_path: Path) -> None:
    """On a file system of 64 kB: an error, the old file survives, nothing else stays."""
    path = _write(tmp_path, {"output": {"dt": 1e-4}})
    disk = tmp_path / "disk"
    disk.mkdir()
    script = (
        'mount -t tmpfs -o size=64k none "$1" || exit 99; cd "$1"; '
        'echo "an earlier result" > case.history.csv; "$2" "$3"; status=$?; '
        "cat case.history.csv; ls -A; exit $status"
    )
    words = ["unshare", "-rm", "sh", "-c", script, "sh", disk, BATCH, path]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    except FileNotFoundError:
        pytest.skip("no unshare here")
    if done.returncode == 99 or "unshare" in done.stderr:
        pytest.skip("no right to mount a small disk")
    assert done.returncode == 2, done.stderr
    assert "cannot write" in done.stderr
    assert done.stdout.split("\n")[:2] == ["an earlier result", "case.history.csv"]


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.0, 0.03, 0.06, 0.1, 0.2])
def test_kill_leaves_the_old_or_the_complete_new_file(delay: float, tmp_path: Path) -> None:
    path = _write(tmp_path, {"output": {"dt": 1e-4}, "solver": {"t_end": 2.0}})
    complete = subprocess.run([BATCH, path.name], cwd=tmp_path, capture_output=True, check=True)
    assert complete.returncode == 0
    target = tmp_path / "case.history.csv"
    new = target.read_bytes()
    target.write_text("old\n", encoding="utf-8")
    process = subprocess.Popen(
        [BATCH, path.name], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert target.read_bytes() in (b"old\n", new)


def test_interrupt_stops_at_once(tmp_path: Path) -> None:
    path = _write(tmp_path, _ENDLESS)
    process = subprocess.Popen(
        [BATCH, path.name], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    compute(process, 0.5)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=10)
    assert process.returncode == 130
    assert b"interrupted at t = " in told
    assert sorted(each.name for each in tmp_path.iterdir()) == ["case.nml"]


@pytest.mark.parametrize("kind", ["folder", "pipe", "empty", "long line", "no permission"])
def test_records_that_are_none(kind: str, tmp_path: Path) -> None:
    record = tmp_path / "record.txt"
    if kind == "folder":
        record.mkdir()
    elif kind == "pipe":
        os.mkfifo(record)
    elif kind == "empty":
        record.touch()
    elif kind == "long line":
        record.write_bytes(b"1" * 100_000_000)
    else:
        record.write_text("0 0\n1 1\n", encoding="utf-8")
        record.chmod(0)
        if os.access(record, os.R_OK):
            pytest.skip("this user may read everything")
    started = time.process_time()
    with pytest.raises(rwmf.InputError, match=r"&motion: file = "):
        rwmf.Case(
            wall={"h": 2.0, "b": 0.5},
            motion={"kind": "record", "file": str(record), "unit": "g"},
        )
    assert time.process_time() - started < 10
