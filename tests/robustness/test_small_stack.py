"""Sizes at their limits with a small stack: nothing that a user sizes lies on it.

Samples, storeys, lists, rows, points, threads and lines as long as they may be, in scenes whose
other numbers are small.
"""

import os
import random
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from checkout import BATCH, ROOT, run_words
from rwmf.kernel import tables

# the least stack of the main thread and of each worker that the documentation promises [bytes]
STACK = 512 * 1024
# three times what the stack holds as reals
_SAMPLES = 196_609
_STOREYS = (549, 999, 1000)
_MANY = 70_000
_WALL = "&wall h = {h}, b = {b} /\n&impact e = 0.9 /\n"
_PULSE = "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"
# required keys of the laws of springs
_LAWS = {
    "peak_oriented": ", cap = 5.0, post_cap = 8.0, ultimate = 10.0",
    "pinched": ", cap = 5.0, post_cap = 8.0, pinch_force = 0.4, pinch_displacement = 0.5, "
    "ultimate = 10.0",
}


@dataclass(frozen=True)
class Attack:
    """A case in files, and lines of Python that compute the like from arrays.

    Attributes
    ----------
    files : dict
        Texts by name; ``case.nml`` is the case.
    lines : str
        Lines of Python, with `case` as the case that has been read.
    environment : dict
        Variables.
    """

    files: Mapping[str, str]
    lines: str
    environment: Mapping[str, str] = field(default_factory=dict)


def choices(name: str) -> list[str]:
    """Words that a key of the namelist allows.

    Parameters
    ----------
    name : str
        Group and key.

    Returns
    -------
    list of str
        The words of the table of keys.
    """
    found = [key for key in tables.schema() if f"{key[0]}.{key[1]}" == name]
    return found[0][5].split()


def building(n: int, coupling: str, law: str | None, method: str) -> str:
    """Give a frame of many storeys beside its wall.

    Parameters
    ----------
    n : int
        Number of storeys.
    coupling : str
        Word of `&storeys`.
    law : str or None
        Of its springs; None for elastic ones.
    method : str
        Word of `&solver`.

    Returns
    -------
    str
        Text of the namelist.
    """
    text = _WALL.format(h=2.0 * n, b=100.0) + _PULSE
    text += f"&storeys n = {n}, m_over_m_w = 0.001, k_over_m_w = 1000.0, height = 4.0, "
    if coupling == "springs":
        text += "k_link_over_m_w = 1e4, "
    text += f"coupling = '{coupling}' /\n&frame xi_s = 0.02 /\n"
    if law is not None:
        text += f"&yielding storey_u_y = 0.01, hardening = 0.05, law = '{law}'"
        text += f"{_LAWS.get(law, '')} /\n"
    text += "&output dt = 1e-4, reactions = .true., energy = .true., conditioning = .false. /\n"
    return text + f"&solver method = '{method}', t_end = 2e-4, rtol = 1e-4 /\n"


def _samples(dice: random.Random) -> Attack:
    """Write records longer than a stack, horizontal and vertical, in every format."""
    n = _SAMPLES
    rows = {
        "one column": "0.1\n-0.1\n" * (n // 2 + 1),
        "two columns": "".join(f"{i / 500} {i % 7}e-2\n" for i in range(n)),
        "AT2": f"A\nB\nC\nNPTS= {2 * n}, DT= .005 SEC\n" + ".1 -.1\n" * n,
    }
    keys = {
        "one column": "unit = 'm/s2', dt = 0.002",
        "two columns": "unit = 'm/s2'",
        "AT2": "",
    }
    horizontal, vertical = dice.choice(list(rows)), dice.choice(list(rows))
    text = _WALL.format(h=2.0, b=0.5) + "&frame xi_s = 0.05, gamma = 5.0, T_s = 1.0 /\n"
    text += f"&motion kind = 'record', file = 'a.txt', {keys[horizontal]} /\n"
    text += f"&vertical file = 'b.txt', {keys[vertical]} /\n" * dice.randrange(2)
    text += "&solver t_end = 0.1, rtol = 1e-5 /\n&spectrum T_s = 0.5, 1.0 /\n"
    lines = f"""
a = 0.1 * np.sin(np.arange({n}) / 9)
times = np.arange({n}) * 0.002
for motion in (rwmf.Motion(a, dt=0.002, unit="g"), rwmf.Motion(a, times=times, unit="g")):
    moved = case.replace(motion=motion)
    rwmf.simulate(moved)
    rwmf.spectrum(moved)
"""
    return Attack({"case.nml": text, "a.txt": rows[horizontal], "b.txt": rows[vertical]}, lines)


def _storeys(dice: random.Random) -> Attack:
    """Choose a tall frame with any coupling, law and method."""
    law = dice.choice([None, *choices("yielding.law")])
    coupling = "full" if law is not None else dice.choice(choices("storeys.coupling"))
    method = dice.choice(choices("solver.method"))
    text = building(dice.choice(_STOREYS), coupling, law, method)
    # the batch program runs the method; Python only calls the kernel with the same sizes
    quick = "case.replace(solver={'method': 'dop853', 't_end': 1e-5})"
    return Attack({"case.nml": text}, f"rwmf.simulate({quick})\ncase.kernel.inventory()\n")


def _lists(dice: random.Random) -> Attack:
    """Write lists and lines that are long, and take as many threads as are allowed."""
    periods = ", ".join(f"{0.5 + i * 1e-5:.5f}" for i in range(dice.choice((1000, _MANY))))
    table = ", ".join(f"{i * 1e-5:.5f}" for i in range(10_000))
    falling = ", ".join(f"{0.9 - i * 1e-6:.6f}" for i in range(10_000))
    impact = f"&impact rule = 'table', table_theta_dot = {table}, table_e = {falling} /\n"
    text = "&wall h = 2.0, b = 0.5 /\n" + _PULSE + "&solver t_end = 0.01, rtol = 1e-4 /\n"
    text += dice.choice((impact, "&impact e = 0.9 /\n"))
    text += f"&frame xi_s = 0.05, gamma = 5.0 /\n! {'c' * dice.choice((10, 3_000_000))}\n"
    text += f"&spectrum T_s = {periods}, gamma = 5.0 /\n"
    lines = f"""
points = {{"T_s": np.linspace(0.5, 1.0, {_MANY}), "gamma": np.full({_MANY}, 5.0)}}
rwmf.sweep(case.replace(spectrum=None, frame={{"T_s": 1.0}}), points=points)
"""
    return Attack({"case.nml": text}, lines, {"OMP_NUM_THREADS": dice.choice(("1", "2", "256"))})


def _rows(dice: random.Random) -> Attack:
    """Ask for a history of many rows."""
    text = _WALL.format(h=2.0, b=0.5) + "&frame xi_s = 0.05, gamma = 5.0, T_s = 1.0 /\n" + _PULSE
    text += f"&solver t_end = 1.0, rtol = 1e-4 /\n&output dt = {1 / dice.choice((2e5, 1e6))} /\n"
    return Attack({"case.nml": text}, "assert rwmf.simulate(case).sizes['time'] > 100000\n")


def _events(dice: random.Random) -> Attack:
    """Let a wall bounce without loss: all of its impacts are kept."""
    method = dice.choice(("dop853", "taylor"))
    text = _WALL.format(h=2.0, b=0.5).replace("0.9", "1.0")
    text += "&initial theta_over_alpha = 1e-8 /\n"
    text += f"&solver method = '{method}', t_end = 6.5, rtol = 1e-3 /\n&output dt = 1.0 /\n"
    lines = f"""
run = rwmf.simulate(case)
assert run.sizes["event"] > {STACK // 8}
assert (run["event"].values == "impact").sum() == int(run["impacts"])
"""
    return Attack({"case.nml": text}, lines)


KINDS: Mapping[str, Callable[[random.Random], Attack]] = {
    "samples": _samples,
    "storeys": _storeys,
    "lists": _lists,
    "rows": _rows,
    "events": _events,
}


def attack(kind: str, number: int) -> Attack:
    """Make the attack of a number.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    number : int
        Any; the same number gives the same attack.

    Returns
    -------
    Attack
        Files and lines.
    """
    return KINDS[kind](random.Random(f"{kind} {number}"))


def survive(found: Attack, folder: Path) -> None:
    """Run an attack by the batch program and by Python, each with a small stack.

    Parameters
    ----------
    found : Attack
        Files and lines.
    folder : path
        An empty folder.
    """
    for name, text in found.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    done = run_words([BATCH, "case.nml"], folder, STACK, **found.environment)
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    code = "import numpy as np, rwmf\ncase = rwmf.Case.from_namelist('case.nml')\n" + found.lines
    place = {"PYTHONPATH": str(ROOT / "driver")}
    done = run_words([sys.executable, "-c", code], folder, STACK, **found.environment, **place)
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])


FIRST = int(os.environ.get("RWMF_FUZZ_FIRST", "0"))
ATTACKS = int(os.environ.get("RWMF_FUZZ", "1"))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(FIRST, FIRST + ATTACKS))
@pytest.mark.parametrize("kind", KINDS)
def test_sizes_at_their_limits(kind: str, number: int, tmp_path: Path) -> None:
    """The batch program and Python answer; RWMF_FUZZ sets the number of attacks of each kind."""
    survive(attack(kind, number), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("law", choices("yielding.law")[::3])
def test_every_law_in_many_storeys(law: str, tmp_path: Path) -> None:
    # a matrix of the storeys is larger than the stack
    text = building(400, "full", law, "dop853")
    (tmp_path / "case.nml").write_text(text.replace("t_end = 2e-4", "t_end = 1e-4"), "utf-8")
    done = run_words([BATCH, "case.nml"], tmp_path, STACK)
    assert done.returncode == 0, done.stderr


def test_many_samples_of_an_array(tmp_path: Path) -> None:
    """A motion of more samples than a stack of 8 MB holds."""
    made = Attack(
        {"case.nml": "&frame xi_s = 0.05, T_s = 1.0 /\n&solver t_end = 0.1 /\n"
         "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"},
        "a = np.sin(np.arange(1_100_000) / 9)\n"
        "rwmf.simulate(case.replace(motion=rwmf.Motion(a, times=np.arange(a.size) * 0.01, "
        "unit='g')))\n",
    )  # fmt: skip
    survive(made, tmp_path)
