"""Input under attack: always a clear error or an answer, never a crash, a hang or a lost file.

RWMF_FUZZ sets the number of attacks; the default keeps the suite short. 20,000 is the full run.
"""

import math
import os
import subprocess
from pathlib import Path

import fuzz
import pytest
import rwmf
from checkout import BATCH, run_python

ATTACKS = int(os.environ.get("RWMF_FUZZ", "200"))
FIRST = int(os.environ.get("RWMF_FUZZ_FIRST", "0"))
# one process for so many attacks: a crash is found in its chunk
_CHUNK = 200
_SECONDS = 300
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
