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
    shown = _rows(THEORY, "| coupling | u_s_max (m)")[coupling]
    run = rwmf.simulate(_case(coupling))
    keys = ("u_s_max", "theta_max_over_alpha", "impacts", "e", "mass_participation",
            "modal_height", "roof_factor")  # fmt: skip
    found = [float(run[key] if key in run else run.attrs[key]) for key in keys]
    assert list(map(_same, found, shown)) == [True] * len(keys), (found, shown)


def test_forces_of_two_couplings() -> None:
    sentence = re.search(
        r"Base shear over weight (\S+) and (\S+), required friction (\S+) and (\S+), "
        r"smallest pivot reaction (\S+) and (\S+) ",
        _page(THEORY),
    )
    assert sentence is not None
    keys = ("base_shear_max_over_weight", "friction_demand_max", "pivot_normal_min_over_m_w_g")
    runs = [rwmf.simulate(_case(coupling)) for coupling in COUPLINGS[:2]]
    found = [float(run[key]) for key in keys for run in runs]
    assert all(map(_same, found, sentence.groups())), found


def test_spectra_of_two_couplings() -> None:
    shown = _rows(THEORY, "| T_s (s) | 0.5 | 0.75 |")
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
    text = re.search(
        r"For tan\(alpha\) = 0\.25: (\S+) \(gamma = 0\),\s+(\S+) \(5\), (\S+) \(1800\)",
        _page(THEORY),
    )
    assert text is not None
    for gamma, shown in zip((1e-12, 5.0, 1800.0), text.groups(), strict=True):
        case = coupled(frame={"gamma": gamma}, impact={"rule": "coupled", "e": None})
        assert _same(float(rwmf.simulate(case)["e"]), shown)


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
    words = [sys.executable, "bench/verification.py"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    assert len(done.stdout.splitlines()) > 5
    assert done.stdout.strip() in _page("README.md")
