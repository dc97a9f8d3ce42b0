"""bench/spectra.py runs, on a small problem and without any peer."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

METHODS = ("fast", "dop853", "erk54", "adams", "bdf")
# two digits more than the loosest tolerance of the table leaves to the methods
LARGEST_ERROR = 1e-5


def _rows(text: str, heads: str) -> list[list[str]]:
    """Cells of the first table whose head begins like this."""
    lines = text.split(f"| {heads} |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("| ").split("|")] for line in lines]


@pytest.fixture(scope="module")
def printed(elcentro: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Run the command, which draws its figure; return what it prints."""
    figure = tmp_path_factory.mktemp("bench") / "spectra.png"
    words = ["--periods=3", "--peers=none", "--quad=0", "--rounds=1", "--most=10"]
    done = subprocess.run(
        [sys.executable, ROOT / "bench" / "spectra.py", *words, "--record", elcentro,
         "--plot", figure],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert figure.stat().st_size > 0
    return done.stdout


def test_methods_of_the_kernel_are_compared(printed: str) -> None:
    rows = _rows(printed, "program | rtol")
    assert {row[0] for row in rows} == set(METHODS)
    assert {row[2] for row in rows} == {"5", "1800"}
    assert all(float(row[6]) <= LARGEST_ERROR for row in rows)
    assert all(float(row[4]) > 0 for row in rows)


@pytest.mark.parametrize("what", ["ordinates", "seconds of motion", "threads"])
def test_cost_is_given_over(printed: str, what: str) -> None:
    assert re.search(rf"^\| {what} \|.*\n\|[-|]+\n\| [\d.]+ \| [\d.e+]+ \| 1 \|", printed, re.M)
