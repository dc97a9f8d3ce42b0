"""Input under attack: always a clear error or an answer, never a crash, a hang or a lost file.

Texts are cut, doubled, exchanged and overwritten with input that is difficult to parse; the same
number makes the same input on every machine.
RWMF_FUZZ sets the number of attacks; the default keeps the suite short. 20,000 is the full run.
"""

import math
import os
import random
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
import rwmf
from checkout import BATCH, REFERENCE, run_python

SEEDS = tuple((REFERENCE / "fuzzed.nml").read_text(encoding="utf-8").split("! ---\n"))
RECORDS = (
    b"# time a\n0.0 0.0\n0.1 0.2\n0.2 -0.3\n0.3 0.1\n0.4 0.0\n",
    b"t,a\n0,0\n.1,1e-1\n.2,-2E-1\n.3,0\n",
    b"PEER\nPLACE\nUNITS OF G\n 6  0.1  NPTS, DT\n 0.0 0.1 0.2\n -0.1 0.0 0.0\n",
)
_TOKENS = (
    "1e308", "-1e308", "1e-308", "NaN", "inf", "-0", "0", "1d400", "1e", "+", "-", ".", "'", '"',
    "/", "&", "&end", "=", ",", "!", "$", "\t", "\r\n", "\x00", "\x1b", "é", "\ufeff", "2*1.0",
    "()", "%", ".true.", "''", "'a''b'", "99999999999999999999", "1" * 400, " " * 3000, "#", ";",
    "&wall", "h", "T_s", "e = 1.0", "gamma = 0", "t_end = 1e-300", "dt = 1e-300", "n = 1000000",
    "rtol = 1e-300", "xi_s = 1e300", "eta_0 = 1e300", "a_max_g = 1e300", "T_s = 1e-300",
    "eta_y = 1e-300", "eta_y = 1e300", "stroke_y = 1e-300", "u_y = 1e-300",
    "hardening = 0.9999999", "rupture_strain = 1e300", "b = 1e-300", "h = 1e300",
    "method = 'bdf'", "formulation = 'published'",
)  # fmt: skip
_BYTES = (b"\x00", b"\xff\xfe", b"nan", b"inf", b"1e999", b"-1e308", b"1,2,3", b"\r", b"\n\n", b"#",
          b"1e-308", b"9" * 400, b"x", b"NPTS", b"-", b".", b"1d3", b"\x1a", b"\t,\t")  # fmt: skip


@dataclass(frozen=True)
class Attack:
    """Namelist and record of one attempt."""

    number: int
    namelist: bytes
    record: bytes


def attack(number: int) -> Attack:
    """Make the input of a number.

    Parameters
    ----------
    number : int
        Any; the same number gives the same bytes.

    Returns
    -------
    Attack
        A namelist and a record; one of both at least is mutated.
    """
    dice = random.Random(number)
    text = dice.choice(SEEDS)
    record = dice.choice(RECORDS)
    if dice.random() < 0.25:
        text = SEEDS[1]
        record = mutate_bytes(dice, record)
    for _ in range(dice.choice((0, 1, 1, 2, 3, 8)) if text == SEEDS[1] else dice.choice((1, 2, 5))):
        text = mutate(dice, text)
    raw = text.encode("utf-8", "surrogateescape")
    if dice.random() < 0.1:
        raw = mutate_bytes(dice, raw)
    return Attack(number, raw, record)


def mutate(dice: random.Random, text: str) -> str:
    """Change a text in one place."""
    at, kind = dice.randrange(len(text) + 1), dice.randrange(8)
    if kind == 0:
        return text[:at] + dice.choice(_TOKENS) + text[at:]
    if kind == 1:
        return text[:at] + text[at + dice.randrange(1, 30) :]
    if kind == 2:
        return text[:at]
    if kind == 3:
        return text[:at] + text[at : at + 40] * 2 + text[at + 40 :]
    if kind == 4:
        return text[:at] + chr(dice.randrange(1, 256)) + text[at + 1 :]
    words = text.split(" ")
    spot = dice.randrange(len(words))
    words[spot] = dice.choice(_TOKENS) if kind < 7 else dice.choice(words)
    return " ".join(words)


def mutate_bytes(dice: random.Random, raw: bytes) -> bytes:
    """Change bytes in a few places."""
    for _ in range(dice.randrange(1, 4)):
        at = dice.randrange(len(raw) + 1)
        cut = dice.choice((0, 0, 1, 3, 50))
        raw = raw[:at] + dice.choice(_BYTES) + raw[at + cut :]
    return raw


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
        made = attack(number)
        (folder / "record.txt").write_bytes(made.record)
        path = folder / "case.nml"
        path.write_bytes(made.namelist)
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
        made = attack(number)
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "record.txt").write_bytes(made.record)
        path = folder / f"case{number}.nml"
        path.write_bytes(made.namelist)
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
