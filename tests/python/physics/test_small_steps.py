"""Bare frames whose storeys yield one by one against small sampled steps in SciPy."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "bench"))

from yielding_frames import CHAOTIC, METHODS, MOST, survey

# softening, friction with breakaway, Bouc and Wen
SCENES = (37, 89, 154)


@pytest.mark.parametrize("number", SCENES)
def test_every_quantity_by_every_method(number: int, tmp_path: Path) -> None:
    """Demands, ductilities and residual drifts are within 100 rtol times their sensitivity."""
    rows = survey(number, tmp_path, "independent")
    assert {row[1] for row in rows} == set(METHODS)
    for _, method, name, _, error, sensitivity in rows:
        assert 0 < sensitivity < CHAOTIC, (method, name)
        assert error < MOST, (method, name)
