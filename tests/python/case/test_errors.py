"""Every error of the input, provoked once: the same message from Python and the batch program."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import rwmf
from checkout import ROOT, Runner

sys.path.append(str(ROOT / "tools"))

from bitwise.scenes import Scene, read_scenes

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
PULSE = "   a_max_g = 0.4\n   omega_p = 6.28\n"
RECORD = "&motion\n   kind = 'record'\n   file = 'rec.txt'\n   unit = 'g'\n"
MOTION = "&motion\n   kind = 'one_sine'\n" + PULSE

# errors: (text to replace, replacement, parts of the message in this order)
WRONG: dict[str, tuple[str, str, str]] = {
    "unknown group": ("&cable", "&cabel", "cabel.*cable"),
    "duplicate group": ("&wall", "&wall h = 1.0, b = 1.0 /\n&wall", "wall"),
    "unknown key": ("xi_s", "xi_x", "frame.*xi_x.*xi_s"),
    "duplicate key": ("h = 2.0", "h = 2.0, h = 2.0", "wall.*h"),
    "wrong type": ("T_s = 1.0", "T_s = 'long'", "frame.*T_s.*long"),
    "half a number": ("T_s = 1.0", "T_s = 1.0abc", "frame.*T_s.*1.0abc"),
    "two values": ("T_s = 1.0", "T_s = 1.0, 2.0", "frame.*T_s"),
    "no value": ("T_s = 1.0", "T_s = ", "frame.*T_s"),
    "NaN": ("T_s = 1.0", "T_s = nan", "frame.*T_s.*nan"),
    "infinite": ("T_s = 1.0", "T_s = inf", "frame.*T_s.*inf"),
    "overflow": ("T_s = 1.0", "T_s = 1e999", "frame.*T_s.*1e999"),
    "missing key": ("   h = 2.0\n", "", "wall.*h"),
    "unterminated group": ("t_end = 2.0\n/\n", "t_end = 2.0\n", "solver"),
    "unterminated text": ("'one_sine'", "'one_sine", "motion"),
    "text outside": ("&wall", "hello\n&wall", "hello"),
    "h": ("h = 2.0", "h = 0.0", "wall.*h = 0.*> 0"),
    "b": ("b = 0.5", "b = -0.5", "wall.*b = -0.5.*> 0"),
    "m_w": ("b = 0.5", "b = 0.5, m_w = 0.0", "wall.*m_w = 0.*> 0"),
    "T_s": ("T_s = 1.0", "T_s = 0", "frame.*T_s = 0.*> 0"),
    "gamma": ("gamma = 5.0", "gamma = -1.0", "frame.*gamma = -1.*>= 0"),
    "xi_s": ("xi_s = 0.05", "xi_s = -0.05", "frame.*xi_s = -0.05.*>= 0"),
    "eta_0": ("eta_0 = 1.0", "eta_0 = -1.0", "cable.*eta_0 = -1.*>= 0"),
    "law": ("eta_0 = 1.0", "eta_0 = 1.0, law = 'cubic'", "cable.*law.*cubic.*linear.*truss"),
    "e": ("e = 0.9", "e = 1.1", "impact.*e = 1.1.*1"),
    "r": ("e = 0.9", "r = -0.1", "impact.*r = -0.1.*0"),
    "e and r": ("e = 0.9", "e = 0.9, r = 0.81", "impact.*e.*r"),
    "neither e nor r": ("e = 0.9\n", "rule = 'constant'\n", "impact.*e.*r"),
    "e with a rule": ("e = 0.9", "e = 0.9, rule = 'housner'", "impact.*e.*housner"),
    "rule": ("e = 0.9", "rule = 'magic'", "impact.*rule.*magic.*constant.*housner.*coupled"),
    "kind": ("'one_sine'", "'two_sine'", "motion.*kind.*two_sine.*one_sine"),
    "no amplitude": ("   a_max_g = 0.4\n", "", "motion.*a_max_g.*v_p"),
    "two amplitudes": ("a_max_g = 0.4", "a_max_g = 0.4, v_p = 1.0", "motion.*v_p = 1.*a_max_g"),
    "no frequency": ("   omega_p = 6.28\n", "", "motion.*omega_p.*T_p"),
    "two frequencies": ("omega_p = 6.28", "omega_p = 6.28, T_p = 1.0", "motion.*T_p = 1.*omega_p"),
    "cycles": ("omega_p = 6.28", "omega_p = 6.28, cycles = 4", "motion.*cycles"),
    "file with a pulse": ("omega_p = 6.28", "omega_p = 6.28, file = 'x'", "motion.*file"),
    "missing record": (MOTION, RECORD.replace("rec.txt", "no.txt"), "motion.*no.txt"),
    "amplitude of a record": (MOTION, RECORD + PULSE, "motion.*(a_max_g|omega_p)"),
    "no unit": (MOTION, RECORD.replace("   unit = 'g'\n", ""), "motion.*unit"),
    "unit": (MOTION, RECORD.replace("'g'", "'gal'"), "motion.*unit.*gal.*cm/s2"),
    "theta_over_alpha": ("&solver", "&initial theta_over_alpha = 99 /\n&solver", "initial.*99"),
    "formulation": ("&solver", "&model formulation = 'mine' /\n&solver", "model.*mine.*published"),
    "published truss": (
        "&cable",
        "&model formulation = 'published' /\n&cable law = 'truss'",
        "published.*truss|truss.*pub",
    ),
    "overturning": (
        "&solver",
        "&model overturning_angle = 2 /\n&solver",
        "model.*overturning_angle",
    ),
    "g": ("&solver", "&model g = 0 /\n&solver", "model.*g = 0.*> 0"),
    "method": ("t_end = 2.0", "t_end = 2.0, method = 'euler'", "solver.*method.*euler.*adams"),
    "rtol": ("t_end = 2.0", "t_end = 2.0, rtol = 0", r"solver.*rtol = 0.*\[1.0e-14, 0.1"),
    "atol": ("t_end = 2.0", "t_end = 2.0, atol = -1", "solver.*atol = -1.*> 0"),
    "max_steps": ("t_end = 2.0", "t_end = 2.0, max_steps = 1.5", "solver.*max_steps.*1.5"),
    "no t_end": ("   t_end = 2.0\n", "", "solver.*t_end"),
    "t_end": ("t_end = 2.0", "t_end = -1", "solver.*t_end = -1.*>= 0"),
    "output dt": ("&solver", "&output dt = 0 /\n&solver", "output.*dt = 0.*> 0"),
    "energy": ("&solver", "&output energy = 'yes' /\n&solver", "output.*energy.*yes"),
    "n": ("&solver", "&spectrum T_s_min=1 T_s_max=2 n=0 /\n&solver", r"spectrum.*n = 0.*\[1, "),
    "range": ("&solver", "&spectrum T_s_min=3 T_s_max=2 n=5 /\n&solver", "spectrum.*T_s_m"),
    "no grid": ("&solver", "&spectrum n=5 /\n&solver", "spectrum.*T_s"),
    "no wall": ("&wall\n   h = 2.0\n   b = 0.5\n/\n", "", "wall"),
    "no gamma": ("   gamma = 5.0\n", "", "frame.*gamma"),
    "no T_s": ("   T_s = 1.0\n", "", "frame.*T_s"),
    "nothing": (BASE, "! nothing\n", "wall|frame|motion"),
}

DAMAGED: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "rec.txt.*(empty|no )"),
    "words": (b"to be\nor not to be\n", "rec.txt"),
    "NaN": (b"0 0\n1 nan\n2 0\n", "rec.txt.*nan"),
    "times": (b"0 0\n2 1\n1 0\n", "rec.txt.*increas"),
    "ragged": (b"0 0\n1 1 1\n2 0\n", "rec.txt"),
    "one sample": (b"0 1\n", "rec.txt"),
    "one column": (b"0\n1\n0\n", "rec.txt.*dt|dt.*rec.txt"),
    "binary": (bytes(range(256)), "rec.txt"),
}


# One case for each further rule: its heading is `NAME -> WHAT THE MESSAGE NAMES, ...`.
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


@pytest.mark.parametrize("name", list(WRONG))
def test_wrong_case(name: str, tmp_path: Path, batch: Runner) -> None:
    old, new, expected = WRONG[name]
    assert BASE.count(old) == 1
    path = tmp_path / "wrong.nml"
    path.write_text(BASE.replace(old, new), encoding="utf-8")
    _both(path, batch, expected)


@pytest.mark.parametrize("scene", REFUSED, ids=lambda scene: scene.name.split(" -> ")[0])
def test_refused_case(
    scene: Scene, tmp_path: Path, batch: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    message = _both(tmp_path / scene.put(), batch, "")
    named = scene.name.split(" -> ")[1].split(", ")
    assert not [word for word in named if word not in message], message


@pytest.mark.parametrize("name", list(DAMAGED))
def test_damaged_record(name: str, tmp_path: Path, batch: Runner) -> None:
    content, expected = DAMAGED[name]
    (tmp_path / "rec.txt").write_bytes(content)
    path = tmp_path / "case.nml"
    path.write_text(BASE.replace(MOTION, RECORD), encoding="utf-8")
    _both(path, batch, expected)


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


def test_an_uncaught_ctrl_c_ends_python_by_its_signal() -> None:
    """A shell sees 130, as after Ctrl-C in any program."""
    script = (
        "import signal, threading, rwmf\n"
        "case = rwmf.Case.from_text(\"&frame T_s = 0.1 xi_s = 0.02 / &motion kind = 'one_sine' "
        'a_max_g = 1 T_p = 1 / &solver t_end = 1e6 rtol = 1e-12 /")\n'
        "threading.Timer(0.1, signal.raise_signal, [signal.SIGINT]).start()\n"
        "rwmf.simulate(case)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False
    )
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
