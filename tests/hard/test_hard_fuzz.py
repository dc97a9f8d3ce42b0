"""Input under attack: always a clear error or an answer, never a crash, a hang or a lost file.

RWMF_FUZZ sets the number of attacks; the default keeps the suite short. 20,000 is the full run of
namelists, 5,000 that of command lines and of sweep files.
"""

from __future__ import annotations

import contextlib
import faulthandler
import io
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fuzz
import pytest
import rwmf
from rwmf import cli

ATTACKS = int(os.environ.get("RWMF_FUZZ", "600"))
FIRST = int(os.environ.get("RWMF_FUZZ_FIRST", "0"))
COMMANDS = int(os.environ.get("RWMF_FUZZ", "200"))
# one process for so many attacks: a crash is found in its chunk
_CHUNK = 200
_SECONDS = 300
# a command of these short cases takes a fraction of a second
_HANG_SECONDS = 60
_BATCH = Path(
    os.environ.get("RWMF_BATCH", Path(__file__).parents[2] / ".venv" / "bin" / "rwmf-batch")
)
_STARTS = range(FIRST, FIRST + ATTACKS, _CHUNK)


def survive(start: int, stop: int, folder: Path) -> dict[str, int]:
    """Attack the Python entry; anything but a result or an error of the package raises.

    Parameters
    ----------
    start, stop : int
        Numbers of the attacks.
    folder : Path
        An empty folder.

    Returns
    -------
    dict
        How many attacks were refused, failed numerically and answered.
    """
    outcome = {"refused": 0, "failed": 0, "answered": 0}
    for number in range(start, stop):
        attack = fuzz.attack(number)
        (folder / "record.txt").write_bytes(attack.record)
        path = folder / "case.nml"
        path.write_bytes(attack.namelist)
        try:
            case = rwmf.Case.from_namelist(path)
        except rwmf.InputError as error:
            assert "case.nml" in str(error), (number, error)
            assert 10 < len(str(error)) < 4000, number
            outcome["refused"] += 1
            continue
        try:
            outcome["answered"] += _answer(_bounded(case), number)
        except rwmf.RwmfError as error:
            assert len(str(error)) > 10, number
            outcome["failed"] += 1
    return outcome


def _bounded(case: rwmf.Case) -> rwmf.Case:
    """Limit the work: an attack may well ask for an hour of it."""
    changes: dict[str, dict[str, object]] = {"solver": {"max_steps": 20000, "verify": None}}
    if case.output is not None and case.output.dt is not None:
        changes["output"] = {"dt": max(case.output.dt, (case.solver.t_end or 1.0) / 1000, 1e-300)}
    if case.spectrum is not None and (case.spectrum.n or 0) > 5:
        changes["spectrum"] = {"n": 5}
    return case.replace(**changes)


def _answer(case: rwmf.Case, number: int) -> int:
    if case.frame is not None and case.frame.T_s is None:
        found = rwmf.spectrum(case, threads=1)
        assert set(map(str, found["status"].values.flat)) - {""}, number
        return 1
    run = rwmf.simulate(case)
    for name in ("u_s_max", "theta_max_over_alpha", "theta_dot_max"):
        assert name not in run or not math.isnan(float(run[name])), (number, name)
    return 1


@pytest.mark.parametrize("start", _STARTS)
def test_python_entry(start: int, tmp_path: Path) -> None:
    """In a process of its own, so that a crash of the kernel is a failed test."""
    stop = min(start + _CHUNK, FIRST + ATTACKS)
    here = str(Path(__file__).parent)
    code = (
        f"import sys; sys.path.insert(0, {here!r}); from pathlib import Path; "
        f"import test_hard_fuzz as t; print(t.survive({start}, {stop}, Path({str(tmp_path)!r})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=_SECONDS, check=False
    )
    assert done.returncode == 0, f"attacks {start} to {stop}: {done.stderr[-2000:]}"


@pytest.mark.parametrize("start", _STARTS)
def test_batch_program(start: int, tmp_path: Path) -> None:
    """All files of a chunk at once: the program checks each and must refuse as Python does."""
    stop = min(start + _CHUNK, FIRST + ATTACKS)
    bad = []
    for number in range(start, stop):
        attack = fuzz.attack(number)
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "record.txt").write_bytes(attack.record)
        path = folder / f"case{number}.nml"
        path.write_bytes(attack.namelist)
        try:
            rwmf.Case.from_namelist(path)
        except rwmf.InputError:
            bad.append(path)
    out = tmp_path / "out"
    out.mkdir()
    old = out / "case.summary.csv"
    old.write_text("an earlier result\n", encoding="utf-8")
    done = subprocess.run(
        [_BATCH, "--out", out, *bad], capture_output=True, timeout=_SECONDS, check=False
    )
    assert done.returncode == 2, done.stderr[-2000:]
    told = done.stderr.decode("utf-8", "replace")
    silent = [path.name for path in bad if path.name not in told]
    assert not silent, silent
    assert list(out.iterdir()) == [old]
    assert old.read_text(encoding="utf-8") == "an earlier result\n"


def command_survives(kind: str, start: int, stop: int, folder: Path) -> dict[int, int]:
    """Attack the command; a status that nobody has foreseen, a trace or a lost file raises.

    Parameters
    ----------
    kind : str
        'command lines' or 'sweep files'.
    start, stop : int
        Numbers of the attacks.
    folder : Path
        An empty folder, which becomes the current one.

    Returns
    -------
    dict
        How many attacks ended with which exit status.
    """
    os.chdir(folder)
    os.environ.pop("RWMF_TRACEBACK", None)
    outcome: dict[int, int] = {}
    for number in range(start, stop):
        inputs = dict(fuzz.INPUTS)
        words = ["sweep", "s.nml", "--threads", "1"]
        if kind == "sweep files":
            inputs["s.nml"] = fuzz.sweep_file(number)
        else:
            words = fuzz.command_line(number)
        for name, content in inputs.items():
            Path(name).write_bytes(content)
        faulthandler.dump_traceback_later(_HANG_SECONDS, exit=True)
        status, told = _call(lambda words=words: cli.main(words))
        faulthandler.cancel_dump_traceback_later()
        shown = (kind, number, words, inputs["s.nml"], told[-2000:])
        assert status in (0, 1, 2), shown
        assert status == 0 or len(told) > 10, shown
        assert "Traceback" not in told, shown
        left = {path.name for path in Path().iterdir()}
        assert all(Path(name).read_bytes() == inputs[name] for name in inputs), shown
        assert not [name for name in left if name.endswith(".tmp")], shown
        for name in left - set(inputs):
            shutil.rmtree(name) if Path(name).is_dir() else Path(name).unlink()
        outcome[status] = outcome.get(status, 0) + 1
    return outcome


def _call(main: Callable[[], int]) -> tuple[int, str]:
    """Exit status and messages."""
    told = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(told):
        status = main()
    return status, told.getvalue()


@pytest.mark.parametrize("start", range(FIRST, FIRST + COMMANDS, _CHUNK))
@pytest.mark.parametrize("kind", ["command lines", "sweep files"])
def test_command(kind: str, start: int, tmp_path: Path) -> None:
    """In a process of its own, so that a crash is a failed test."""
    pytest.importorskip("h5py")
    stop = min(start + _CHUNK, FIRST + COMMANDS)
    here = str(Path(__file__).parent)
    code = (
        f"import sys; sys.path.insert(0, {here!r}); from pathlib import Path; "
        f"import test_hard_fuzz as t; "
        f"print(t.command_survives({kind!r}, {start}, {stop}, Path({str(tmp_path)!r})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=_SECONDS, check=False
    )
    assert done.returncode == 0, f"{kind} {start} to {stop}: {done.stderr[-4000:]}"
