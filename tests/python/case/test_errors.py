"""Every error of the input, provoked once: the same message from Python and the batch program."""

import os
import re
import signal
from pathlib import Path

import pytest
import rwmf
from bitwise.scenes import Scene, read_scenes
from checkout import ROOT, Runner, run_python
from refused import refusals

BASE = """&wall
   h = 2.0
   b = 0.5
/
&frame
   T_s = 1.0
   gamma = 5.0
   xi_s = 0.05
/
&cable
   eta_0 = 1.0
/
&impact
   e = 0.9
/
&motion
   kind = 'one_sine'
   a_max_g = 0.4
   omega_p = 6.28
/
&solver
   t_end = 2.0
/
"""
# One case for each rule: its heading is `NAME -> WHAT THE MESSAGE NAMES, ...`.
REFUSED = read_scenes(ROOT / "tests" / "reference" / "refused_cases.txt")


def _both(path: Path, batch: Runner, expected: str) -> str:
    """Message of Python, after a comparison with the batch program's."""
    before = sorted(path.parent.iterdir())
    with pytest.raises(rwmf.InputError) as error:
        rwmf.Case.from_namelist(path)
    message = str(error.value)
    found = batch(path)
    assert found.returncode == 2
    assert found.stderr == f"rwmf-batch: {message}\n"
    assert sorted(path.parent.iterdir()) == before
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert re.search(expected, message.removeprefix(f"{path}: "), re.IGNORECASE), message
    return message


@pytest.mark.parametrize("scene", REFUSED, ids=lambda scene: scene.name.split(" -> ")[0])
def test_refused_case(
    scene: Scene, tmp_path: Path, batch: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    message = _both(tmp_path / scene.put(), batch, "")
    named = scene.name.split(" -> ")[1].split(", ")
    assert not [word for word in named if word not in message], message


def test_record_of_bytes_that_are_not_text(tmp_path: Path, batch: Runner) -> None:
    (tmp_path / "rec.txt").write_bytes(bytes(range(256)))
    path = tmp_path / "case.nml"
    motion = "&frame T_s = 1, xi_s = 0 /\n&motion kind = 'record', file = 'rec.txt', unit = 'g' /"
    path.write_text(motion, encoding="utf-8")
    _both(path, batch, "rec.txt")


def test_the_right_case_is_right(tmp_path: Path, batch: Runner) -> None:
    path = tmp_path / "right.nml"
    path.write_text(BASE, encoding="utf-8")
    assert rwmf.Case.from_namelist(path).wall.h == 2.0
    assert batch(path).returncode == 0


@pytest.mark.parametrize("kind", ["missing", "folder", "empty", "pipe"])
def test_files_that_cannot_be_read(kind: str, tmp_path: Path, batch: Runner) -> None:
    path = tmp_path / "case.nml"
    if kind == "folder":
        path.mkdir()
    elif kind == "empty":
        path.touch()
    elif kind == "pipe":
        os.mkfifo(path)
    expected = {"missing": "does not exist", "folder": "a folder"}
    _both(path, batch, expected.get(kind, "empty or not a regular file"))


def test_bytes_that_are_not_text(tmp_path: Path, batch: Runner) -> None:
    path = tmp_path / "case.nml"
    path.write_bytes(bytes(range(256)) * 4)
    with pytest.raises(rwmf.InputError):
        rwmf.Case.from_namelist(path)
    assert batch(path).returncode == 2


def test_several_files_are_checked_before_the_first_runs(tmp_path: Path, batch: Runner) -> None:
    (tmp_path / "good.nml").write_text(BASE, encoding="utf-8")
    (tmp_path / "bad.nml").write_text(BASE.replace("h = 2.0", "h = 0"), encoding="utf-8")
    found = batch("good.nml", "bad.nml")
    assert found.returncode == 2
    assert "bad.nml: " in found.stderr
    assert not list(tmp_path.glob("*.csv"))


def test_earlier_results_survive_a_failure(tmp_path: Path, batch: Runner) -> None:
    path = tmp_path / "case.nml"
    path.write_text(BASE, encoding="utf-8")
    assert batch(path).returncode == 0
    summary = tmp_path / "case.summary.csv"
    first = summary.read_bytes()
    path.write_text(BASE.replace("t_end = 2.0", "t_end = 2.0, max_steps = 5"), encoding="utf-8")
    assert batch(path).returncode == 1
    assert summary.read_bytes() == first
    assert sorted(tmp_path.iterdir()) == [path, summary]


def test_an_uncaught_ctrl_c_ends_python_by_its_signal(tmp_path: Path) -> None:
    """A shell sees 130, as after Ctrl-C in any program."""
    script = (
        "import signal, threading, rwmf\n"
        "case = rwmf.Case.from_text(\"&frame T_s = 0.1 xi_s = 0.02 / &motion kind = 'one_sine' "
        'a_max_g = 1 T_p = 1 / &solver t_end = 1e6 rtol = 1e-12 /")\n'
        "threading.Timer(0.1, signal.raise_signal, [signal.SIGINT]).start()\n"
        "rwmf.simulate(case)\n"
    )
    done = run_python(script, tmp_path)
    assert done.returncode == -signal.SIGINT, done.stderr
    assert "KeyboardInterrupt" in done.stderr


def test_exceptions_derive_from_the_builtin_ones() -> None:
    assert issubclass(rwmf.InputError, (ValueError, rwmf.RwmfError))
    assert issubclass(rwmf.NumericalError, RuntimeError)
    assert issubclass(rwmf.OutputError, OSError)
    assert issubclass(rwmf.Interrupted, KeyboardInterrupt)
    assert not issubclass(rwmf.Interrupted, Exception)
    for kind in (rwmf.InputError, rwmf.NumericalError, rwmf.OutputError):
        assert issubclass(kind, rwmf.RwmfError)
        assert str(kind("what")) == "what"


NUMBERS = {"1": 1.0, "-.64E-02": -0.0064, "1d3": 1e3, "5.": 5.0, "+3.5D+2": 350.0, "0.1": 0.1,
           "1e-400": 0.0, "000": 0.0, "1e0005": 1e5, ".5e1": 5.0}  # fmt: skip
NO_NUMBERS = ["", ".", "-", "1e", "1.0abc", "nan", "inf", "-Infinity", "1e999", "1..0", "1,2",
              "3*1", "0x10", "e5", "1.5+3"]  # fmt: skip
NO_COUNTS = ["", "-", "1.0", "2147483648", "99999999999", "1e3", "1 2"]


def _pulse(keys: str) -> rwmf.Case:
    text = "&frame T_s = 1, xi_s = 0 / &solver t_end = 1 / &motion T_p = 1"
    return rwmf.Case.from_text(f"{text}, {keys} /")


def test_numbers() -> None:
    for word, number in NUMBERS.items():
        assert _pulse(f"kind = 'type_c', v_p = {word}, n_pulses = +007").motion.v_p == number
    assert _pulse("kind = 'type_c', v_p = 1, n_pulses = +007").motion.n_pulses == 7


def test_forms_of_groups_and_lists() -> None:
    """A mark of UTF-8, comments, capitals, repeated values, ends of lines, an empty group."""
    text = "\ufeff! a comment\n&Wall H = 2, b=0.5 / &Spectrum GAMMA = 1.0, 2*5.0 ! one, two\r\n 10,"
    text += " T_s=1/ &output\n&end &frame T_s=2 gamma=3 xi_s=0 / &impact e=0.9 / &solver t_end = 1/"
    text += "&motion kind='none' / ! no"
    case = rwmf.Case.from_text(text)
    assert case.spectrum.gamma == (1.0, 5.0, 5.0, 10.0)
    assert "output" in case.groups


test_refused_texts = refusals(
    rwmf.Case.from_text,
    ("&wall h = 1\n&frame /", "line 1: the group &wall is not closed"),
    ("&wall h = 'abc\n/", r"line 1: the string 'abc"),
    ("&wall h = 1 / /", "'/' is outside"),
    ("& /", "is outside"),
    ("&motion kind = 'it''s / & !' /", "kind = 'it's / & !' (line 1)"),
    *((f"&wall h = {value} /", "h has an empty value") for value in ("", "1,,2", "= 2")),
    *((f"&wall h = {value} /", "repeated value") for value in ("3*", "0*1", "x*1")),
    ("&wall h = 2000000000*1.0 /", "more than"),
    ("&wall , /", "is found where a key"),
    ("&wall h = 1\x07 /", "control character"),
    (f"&a {'h=1 ' * 2000}/", "too many keys"),
    ("&a / " * 2000, "too many groups"),
    (f"&a h = '{18000 * chr(39)}' /", "is longer than"),
)
test_words_that_are_no_numbers = refusals(
    lambda word: _pulse(f"kind = 'one_sine', v_p = {word}"), *((word, "v_p") for word in NO_NUMBERS)
)
test_words_that_are_no_counts = refusals(
    lambda word: _pulse(f"kind = 'type_c', v_p = 1, n_pulses = {word}"),
    *((word, "n_pulses") for word in NO_COUNTS),
)
