"""Signals while files are written: complete files and status 0, or none of them and 130."""

import fcntl
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from checkout import BATCH, run_words
from rwmf.errors import Interrupted
from rwmf.kernel.marshalling import write

RUN = """&wall h = 2.0, b = 0.5 /
&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /
&impact e = 0.9 /
&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /
&solver method = 'dop853', rtol = 1e-4, t_end = 1.0 /
"""
MANY_ROWS = "&output dt = 1e-6, energy = .true. /\n"
MANY_PERIODS = """&frame xi_s = 0.05 /
&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /
&solver t_end = 0.01 /
&spectrum T_s_min = 0.1, T_s_max = 3.0, n = 300000 /
"""
PYTHON = [sys.executable, "-m", "rwmf"]
WORDS = {
    "batch": [BATCH, "case.nml"],
    "run": [*PYTHON, "run", "case.nml", "--out", "."],
    "spectrum": [*PYTHON, "spectrum", "case.nml", "--out", "case.spectrum.csv"],
}


def _begun(folder: Path, process: subprocess.Popen[bytes]) -> None:
    """Wait until some of a new file has been written."""
    while not any(path.stat().st_size > 1e5 for path in folder.glob(".rwmf-*.tmp")):
        assert process.poll() is None
        time.sleep(0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entry", "text", "number"),
    [
        ("batch", RUN + MANY_ROWS, signal.SIGINT),
        ("batch", MANY_PERIODS, signal.SIGTERM),
        ("run", RUN + MANY_ROWS, signal.SIGTERM),
        ("spectrum", MANY_PERIODS, signal.SIGHUP),
    ],
)
def test_interrupted_while_writing(entry: str, text: str, number: int, tmp_path: Path) -> None:
    (tmp_path / "case.nml").write_text(text, encoding="utf-8")
    earlier = [tmp_path / f"case.{kind}.csv" for kind in ("summary", "history", "spectrum")]
    for path in earlier:
        path.write_text("earlier", encoding="utf-8")
    with subprocess.Popen(
        WORDS[entry], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        _begun(tmp_path, process)
        started = time.monotonic()
        process.send_signal(number)
        _, told = process.communicate(timeout=60)
        assert time.monotonic() - started < 5
    assert process.returncode == 130, told
    assert b"interrupted" in told
    assert sorted(tmp_path.iterdir()) == sorted([tmp_path / "case.nml", *earlier])
    assert all(path.read_text(encoding="utf-8") == "earlier" for path in earlier)


def _signalled(names: list[str], first: Path) -> tuple[int, bytes, bytes]:
    """Send SIGTERM when a file is there, while the report blocks in a full pipe."""
    reader, writer = os.pipe()
    os.write(writer, b"x" * fcntl.fcntl(writer, fcntl.F_GETPIPE_SZ))
    with subprocess.Popen(
        [BATCH, *names], cwd=first.parent, stdout=writer, stderr=subprocess.PIPE
    ) as process:
        os.close(writer)
        while not first.exists():
            assert process.poll() is None
            time.sleep(0.01)
        time.sleep(0.1)
        process.send_signal(signal.SIGTERM)
        time.sleep(0.1)
        with os.fdopen(reader, "rb") as stream:
            output = stream.read()
        _, told = process.communicate(timeout=60)
    return process.returncode, output, told


def test_a_signal_behind_the_last_file_is_too_late(tmp_path: Path) -> None:
    """The files are complete: status 0."""
    (tmp_path / "case.nml").write_text(RUN, encoding="utf-8")
    status, output, _ = _signalled(["case.nml"], tmp_path / "case.summary.csv")
    assert b"summary written" in output
    assert status == 0


def test_the_next_case_is_not_begun(tmp_path: Path) -> None:
    """A signal between two cases leaves the first complete and nothing of the second."""
    for name in ("one", "two"):
        (tmp_path / f"{name}.nml").write_text(RUN, encoding="utf-8")
    status, _, told = _signalled(["one.nml", "two.nml"], tmp_path / "one.summary.csv")
    assert status == 130
    assert b"two.nml: not begun: interrupted" in told
    assert not (tmp_path / "two.summary.csv").exists()


@pytest.mark.parametrize(("status", "is_complete"), [(0, True), (130, False)])
def test_interrupt_in_python(status: int, is_complete: bool) -> None:
    def call(*_: np.ndarray) -> tuple[int, int]:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)
        return status, 0

    if is_complete:
        write(call)
    else:
        with pytest.raises(Interrupted):
            write(call)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("&spectrum T_s = 0.5, quantities = 'u_s_max', 'dance' /", "dance"),
        ("&spectrum T_s = 0.5, quantities = 'roof_residual_drift' /", "roof_residual_drift"),
        ("&spectrum T_s = 0.5, quantities = 'storey_3_ductility' /", "storey_3_ductility"),
    ],
)
def test_nothing_is_written_before_all_is_checked(more: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "good.nml").write_text(RUN, encoding="utf-8")
    (tmp_path / "bad.nml").write_text(RUN + more + "\n", encoding="utf-8")
    (tmp_path / "bad.summary.csv").write_text("earlier", encoding="utf-8")
    done = run_words([BATCH, "good.nml", "bad.nml"], tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "bad.nml" in done.stderr
    assert sorted(path.name for path in tmp_path.glob("*.csv")) == ["bad.summary.csv"]
    assert (tmp_path / "bad.summary.csv").read_text(encoding="utf-8") == "earlier"


def test_threads_and_folders_are_checked_before(tmp_path: Path) -> None:
    (tmp_path / "case.nml").write_text(RUN + "&spectrum T_s = 0.5 /\n", encoding="utf-8")
    done = run_words([BATCH, "case.nml"], tmp_path, OMP_NUM_THREADS="100000")
    assert (done.returncode, "OMP_NUM_THREADS" in done.stderr) == (2, True)
    (tmp_path / "case.spectrum.csv").mkdir()
    done = run_words([BATCH, "case.nml"], tmp_path)
    assert (done.returncode, "case.spectrum.csv: it is a folder" in done.stderr) == (2, True)
    assert not (tmp_path / "case.summary.csv").exists()
