"""bench/spectra.py runs on a small problem, and SciPy solves the same problem."""

import sys
from pathlib import Path

import numpy as np
import peers
import pytest
import rwmf
from checkout import ROOT, run_words


def test_methods_of_the_kernel_are_compared(elcentro: Path) -> None:
    words = ["--periods=3", "--peers=none", "--quad=0", "--rounds=1", "--record", str(elcentro)]
    done = run_words([sys.executable, ROOT / "bench" / "spectra.py", *words], ROOT)
    assert done.returncode == 0, done.stderr
    lines = [line.strip("| ").split(" | ") for line in done.stdout.splitlines() if "|" in line]
    rows = lines[2:]
    assert {row[0] for row in rows} == {"auto", "dop853", "taylor", "adams", "bdf"}
    assert {row[2] for row in rows} == {"5", "1800"}
    # two digits more than the loosest tolerance of the table leaves to the methods
    assert all(float(row[6]) <= 1e-5 and float(row[4]) > 0 for row in rows)


def test_scipy_finds_the_same_peaks(elcentro: Path) -> None:
    """An integrator, an event search and a hybrid loop that share nothing with the kernel."""
    record = peers.read_record(elcentro)
    peer = next(peer for peer in peers.PEERS if "DOP853" in peer.name)
    T_s = np.array([0.6, 2.5])
    for gamma in peers.GAMMAS:
        ours = rwmf.spectrum(peers.case(record, "dop853", 1e-10), T_s=T_s, gamma=gamma)
        found = peer.peaks(record, gamma, peer.rtol, T_s)
        assert found == pytest.approx(ours.u_s_max.values.ravel(), rel=peer.rtol, abs=0)
