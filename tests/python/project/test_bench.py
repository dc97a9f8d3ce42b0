"""bench/spectra.py runs on a small problem, and its peers solve the same problem."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT

sys.path.append(str(ROOT / "bench"))

from peers import problem, scipy_ivp

METHODS = ("auto", "dop853", "taylor", "adams", "bdf")
# two digits more than the loosest tolerance of the table leaves to the methods
LARGEST_ERROR = 1e-5


def _rows(text: str, heads: str) -> list[list[str]]:
    """Cells of the first table whose head begins like this."""
    lines = text.split(f"| {heads} |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("| ").split("|")] for line in lines]


@pytest.fixture(scope="module")
def printed(elcentro: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Run the command, which draws its figure, and return its output."""
    figure = tmp_path_factory.mktemp("bench") / "spectra.png"
    words = ["--periods=3", "--peers=none", "--quad=0", "--rounds=1"]
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


def test_scipy_finds_the_same_peaks(elcentro: Path) -> None:
    """An integrator, an event search and a hybrid loop that share nothing with the kernel."""
    pytest.importorskip("scipy")
    record = problem.read_record(elcentro)
    peer = next(peer for peer in scipy_ivp.PEERS if "DOP853" in peer.name)
    T_s = np.array([0.6, 2.5])
    for gamma in problem.GAMMAS:
        ours = rwmf.spectrum(problem.case(record, "dop853", 1e-10), T_s=T_s, gamma=gamma)
        found = peer.make(record, gamma, peer.rtol)(T_s)
        assert found == pytest.approx(ours.u_s_max.values.ravel(), rel=peer.rtol, abs=0)
