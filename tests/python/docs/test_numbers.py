"""Numbers in the text and tables of pages are those of the program, to every digit shown."""

from __future__ import annotations

import math
import re
import subprocess
import sys

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from rwmf import Case, studies
from scenes import block, coupled

THEORY = "docs/theory/theory.md"
STOREYS = "docs/theory/storeys.md"
COUPLINGS = ("full", "reduced", "every_floor")


def _page(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def _rows(page: str, header: str) -> dict[str, list[str]]:
    """Read the table with this header: further cells by the first one, without code letters."""
    text = _page(page)
    table = text[text.index(header) :].split("\n\n")[0]
    cells = [[cell.strip() for cell in line.strip("| ").split("|")] for line in table.splitlines()]
    return {first.strip("`"): others for first, *others in cells if not first.startswith("---")}


def _same(value: float, shown: str) -> bool:
    """Return True for a number that rounds to the printed digits."""
    return f"{value:.{len(shown.partition('.')[2])}f}" == shown


def _case(coupling: str) -> Case:
    return Case.from_namelist(ROOT / "inputs" / f"storeys_{coupling}.nml")


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_couplings_of_storeys(coupling: str) -> None:
    table = _rows(STOREYS, "| key | `full` |")
    run = rwmf.simulate(_case(coupling).replace(output={"reactions": True}))
    for cell, values in list(table.items())[1:]:
        key = cell.partition("`")[0].removesuffix("_m")
        found = float(run[key] if key in run else run.attrs[key])
        assert _same(found, values[COUPLINGS.index(coupling)]), (key, found)


def test_spectra_of_two_couplings() -> None:
    shown = _rows(STOREYS, "| T_s (s) | 0.5 | 0.75 |")
    periods = list(map(float, shown["T_s (s)"]))
    found = {
        name: rwmf.spectrum(_case(name), T_s=periods, gamma=None).u_s_max.values.ravel()
        for name in COUPLINGS[:2]
    }
    for name, values in found.items():
        assert all(map(_same, values, shown[name])), (name, values)
    differences = 100.0 * (found["reduced"] / found["full"] - 1.0)
    for value, text in zip(differences, shown["difference"], strict=True):
        assert f"{value:+.1f} %" == text


def test_factors_of_the_momentum_balance() -> None:
    table = _rows(THEORY, r"| $\gamma$ | 0 | 5 |")
    gammas, factors = table[r"$\gamma$"], table[r"$e_{\max}$"]
    for gamma, shown in zip(map(float, gammas), factors, strict=True):
        case = coupled(frame={"gamma": gamma or 1e-12}, impact={"rule": "coupled", "e": None})
        assert _same(float(rwmf.simulate(case)["e"]), shown)


def test_place_of_the_impulse_for_a_factor_of_0_9() -> None:
    """(T25) with the factor of the program: distance outside the base over its width."""
    table = _rows(THEORY, r"| $\gamma$ | 0 | 5 | 1800 |" + "\n|---|---|---|---|\n| distance")
    shown = next(values for name, values in table.items() if name.startswith("distance"))
    sine_2, e = 1 / 17, 0.9
    for gamma, text in zip((0.0, 5.0, 1800.0), shown, strict=True):
        inertia = 4 / 3 + 4 * gamma * (1 - sine_2)
        x = (e - _balanced(0.25, gamma)) * inertia / (1 + e) / (2 * sine_2)
        assert f"{-x:,.{len(text.partition('.')[2])}f}" == text
        # an impulse at mid-base, half a width inside, loses nothing
        assert _balanced(0.25, gamma) + 2 * sine_2 / inertia == pytest.approx(1.0, rel=1e-12)


def test_impulsive_friction() -> None:
    """(T26) with the factor of the program, and with 0.9."""
    shown = _rows(THEORY, r"| | free block, $\tan\alpha = 0.25$")["ratio"]
    cases = ((0.25, 0.0, None), (0.5, 0.0, None), (0.25, 5.0, None), (0.25, 5.0, 0.9),
             (0.25, 1800.0, 0.9))  # fmt: skip
    for (tangent, gamma, given), text in zip(cases, shown, strict=True):
        e = given or _balanced(tangent, gamma)
        assert _same((1 + 2 * gamma) * (1 - e) / (tangent * (1 + e)), text)


def _balanced(tangent: float, gamma: float) -> float:
    """Return the factor of the momentum balance that a run reports."""
    wall, impact, solver = {"b": 2 * tangent}, {"rule": "coupled", "e": None}, {"t_end": 0.0}
    case = coupled(wall=wall, frame={"gamma": gamma or 1e-14}, impact=impact, solver=solver)
    return float(rwmf.simulate(case)["e_max"])


@pytest.mark.parametrize("e", [None, 0.9])
def test_boundaries_of_overturning(e: float | None) -> None:
    text = re.sub(r"\s+", " ", _page("docs/howto/studies.md"))
    pattern = (
        r"the boundaries are (\S+) \(after one impact\), (\S+) \(stays again\) and (\S+) "
        if e is None
        else r"With e = 0\.9 they are (\S+), (\S+) and ([\d.]+):"
    )
    shown = re.search(pattern, text)
    assert shown is not None
    case = block(
        wall={"b": 2 * math.tan(0.25)},
        motion={"kind": "one_sine", "a_max_g": 1.0, "omega_p": 8.0},
        impact={"rule": "coupled", "e": None} if e is None else {"rule": "constant", "e": e},
        solver={"method": "dop853"},
    )
    found = studies.overturning_map(case, [5.0], np.linspace(1, 9, 17), tolerance=1e-8)
    values = found["boundary_amplitude"].values.ravel()
    assert all(map(_same, values, shown.groups())), values


def test_table_of_verification() -> None:
    words = [sys.executable, "bench/tables.py", "verification"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    assert len(done.stdout.splitlines()) > 5
    assert done.stdout.strip() in _page("README.md")
