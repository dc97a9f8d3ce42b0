"""Input under attack: always a clear error or an answer, never a crash, a hang or a lost file.

RWMF_FUZZ sets the number of attacks; the default keeps the suite short. 20,000 is the full run of
namelists, 5,000 that of each kind of calls of the command.
"""

from __future__ import annotations

import contextlib
import faulthandler
import fcntl
import io
import math
import os
import shutil
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path

import fuzz
import fuzz_calls
import pytest
import rwmf
from checkout import BATCH, run_python
from rwmf import cli

ATTACKS = int(os.environ.get("RWMF_FUZZ", "600"))
FIRST = int(os.environ.get("RWMF_FUZZ_FIRST", "0"))
COMMANDS = int(os.environ.get("RWMF_FUZZ", "200"))
# one process for so many attacks: a crash is found in its chunk
_CHUNK = 200
_SECONDS = 300
# a command of these short cases takes a fraction of a second
_HANG_SECONDS = 60
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
        Numbers of attacks that were refused, failed numerically and answered.
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
    """Limit the work, because a mutated input may need an hour."""
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
    """A separate process turns a crash of the kernel into a failed test."""
    stop = min(start + _CHUNK, FIRST + ATTACKS)
    code = (
        "from pathlib import Path; "
        f"import test_hard_fuzz as t; print(t.survive({start}, {stop}, Path({str(tmp_path)!r})))"
    )
    done = run_python(code, tmp_path, Path(__file__).parent)
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
        [BATCH, "--out", out, *bad], capture_output=True, timeout=_SECONDS, check=False
    )
    assert done.returncode == 2, done.stderr[-2000:]
    told = done.stderr.decode("utf-8", "replace")
    silent = [path.name for path in bad if path.name not in told]
    assert not silent, silent
    assert list(out.iterdir()) == [old]
    assert old.read_text(encoding="utf-8") == "an earlier result\n"


def command_survives(kind: str, start: int, stop: int, folder: Path) -> dict[int, int]:
    """Call the command; a status that is not right, a trace, a changed or lost file raises.

    Parameters
    ----------
    kind : str
        One of `fuzz_calls.KINDS`.
    start, stop : int
        Numbers of the calls.
    folder : Path
        An empty folder, which becomes the current one.

    Returns
    -------
    dict
        Number of calls by exit status.
    """
    os.chdir(folder)
    os.environ.pop("RWMF_TRACEBACK", None)
    results = _make_results()
    outcome: dict[int, int] = {}
    for number in range(start, stop):
        call = fuzz_calls.make_call(kind, number, results, str(folder))
        _clear()
        for name, content in call.inputs.items():
            Path(name).write_bytes(content)
        _make_other_names(call.inputs)
        with Path("locked.nc.journal").open("rb") as locked:
            fcntl.flock(locked, fcntl.LOCK_EX)
            faulthandler.dump_traceback_later(_HANG_SECONDS, exit=True)
            status, told = _call(lambda words=call.words: cli.main(words))
            faulthandler.cancel_dump_traceback_later()
        shown = (kind, number, call.words, call.inputs["s.nml"], status, told[-2000:])
        assert status in call.statuses, shown
        assert status == 0 or len(told) > 10, shown
        assert call.says in told, shown
        assert "Traceback" not in told, shown
        kept = [name for name in call.inputs if name not in call.loose]
        assert not [name for name in kept if _changed(name, call.inputs[name])], shown
        assert not [path for path in Path().rglob("*.tmp") if path.name[:6] == ".rwmf-"], shown
        outcome[status] = outcome.get(status, 0) + 1
    return outcome


def _make_results() -> dict[str, bytes]:
    """Make the files that only a sweep can write: results, journals, and an HDF5 file."""
    import h5py

    for name, content in fuzz_calls.INPUTS.items():
        Path(name).write_bytes(content)
    Path("other.nml").write_bytes(fuzz_calls.INPUTS["s.nml"].replace(b"0.9", b"0.7"))
    for words in (
        "s.nml --out done.nc",
        "other.nml --out another.nc",
        "s.nml --out half.nc --part 1/2",
        "s.nml --out half.nc --part 2/2",
        "other.nml --out other.nc --part 1/2",
    ):
        status, told = _call(lambda words=words: cli.main(["sweep", *words.split()]))
        assert status == 0, told
    with h5py.File("foreign.nc", "w") as file:
        file.attrs["source"] = "another program"
    names = ["done.nc", "another.nc", "foreign.nc", "half.nc.part-1-of-2.journal"]
    found = {name: Path(name).read_bytes() for name in (*names, "half.nc.part-2-of-2.journal")}
    found["torn.nc.journal"] = found[names[3]][:-3]
    found["locked.nc.journal"] = found[names[3]]
    found["begun.nc.journal"] = Path("other.nc.part-1-of-2.journal").read_bytes()
    return found


def _clear() -> None:
    """Empty the current folder."""
    for path in Path().iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()


def _make_other_names(names: Iterable[str]) -> None:
    """Give each file a symbolic and a hard link, and the folder another name."""
    Path("sub").mkdir()
    Path("here").symlink_to(".")
    Path("planted.nc.journal").symlink_to("record.txt")
    for name in names:
        Path(f"link-{name}").symlink_to(name)
        Path(f"hard-{name}").hardlink_to(name)


def _changed(name: str, content: bytes) -> bool:
    """Check whether a file, or one of its other names, has changed."""
    link, hard = Path(f"link-{name}"), Path(f"hard-{name}")
    same = link.is_symlink() and link.samefile(name) and hard.samefile(name)
    return not same or Path(name).is_symlink() or Path(name).read_bytes() != content


def _call(main: Callable[[], int]) -> tuple[int, str]:
    """Exit status and messages."""
    told = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(told):
        status = main()
    return status, told.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("start", range(FIRST, FIRST + COMMANDS, _CHUNK))
@pytest.mark.parametrize("kind", fuzz_calls.KINDS)
def test_command(kind: str, start: int, tmp_path: Path) -> None:
    """A separate process turns a crash into a failed test."""
    pytest.importorskip("h5py")
    stop = min(start + _CHUNK, FIRST + COMMANDS)
    code = (
        "from pathlib import Path; "
        f"import test_hard_fuzz as t; "
        f"print(t.command_survives({kind!r}, {start}, {stop}, Path({str(tmp_path)!r})))"
    )
    done = run_python(code, tmp_path, Path(__file__).parent)
    assert done.returncode == 0, f"{kind} {start} to {stop}: {done.stderr[-4000:]}"
