"""Every hard case with a frame as a spectrum of one ordinate by method `fast`."""

from __future__ import annotations

from pathlib import Path

import collection
import pytest
import rwmf
from hard_scenes import Hard

ANSWERS = collection.read_answers()
EVERY = [(family, hard) for family, hard in collection.every_case() if hard.groups.get("frame", 1)]


@pytest.mark.parametrize(("family", "hard"), EVERY, ids=lambda value: getattr(value, "name", value))
def test_peak_of_a_spectrum(family: str, hard: Hard, tmp_path: Path) -> None:
    """The peak within what the project promises, whether from the lanes or the general kernel."""
    case = hard.build(tmp_path, "fast")
    truth = ANSWERS[family, hard.name]
    found = rwmf.spectrum(case, T_s=case.frame.T_s)
    bound = max(collection.PEAK_FLOOR, collection.PEAK_FACTOR * hard.rtol * max(truth.kappa, 1.0))
    peak = float(found.u_s_max.values.item())
    assert abs(peak - truth.peak) <= max(bound * truth.peak, collection.NOTHING)
    decided = truth.kappa * hard.rtol < 0.01
    if decided:
        assert (found.status.values.item() == "overturned") == bool(truth.overturned)
