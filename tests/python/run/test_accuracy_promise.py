"""`&solver accuracy` keeps its promise on scenes that nobody chose.

The full count (240 cases) runs by `bench/accuracy_promise.py`, which also measures the cost.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rwmf
from random_cases import random_cases

ASKED = (1e-3, 1e-5, 1e-7, 1e-9)
# two independent methods agree to this, relative to the peak and its sensitivity
TRUSTED = 1e-11


def _peak(case: rwmf.Case, **solver: object) -> float:
    return float(rwmf.simulate(case.replace(solver=solver)).u_s_max)


def test_asked_accuracy_is_delivered(record_folder: Path) -> None:
    """True error at most the asked one, and the estimate of the right size."""
    ratios = []
    for case in random_cases(24, seed=20180, records=record_folder):
        trusted = _peak(case, method="dop853", rtol=3e-14)
        other = _peak(case, method="extrapolation", rtol=1e-13)
        if abs(other - trusted) > TRUSTED * trusted:
            continue
        for asked in ASKED:
            result = rwmf.simulate(case.replace(solver={"accuracy": asked, "rtol": None}))
            error = abs(float(result.u_s_max) - trusted) / trusted
            assert error <= asked
            estimate = result.attrs["estimated_relative_error"]
            if estimate > 1e-12 and error > 1e-12:
                ratios.append(estimate / error)
    assert len(ratios) > 40, "most cases must be good enough to judge by"
    assert np.mean([0.1 <= ratio <= 10 for ratio in ratios]) >= 0.9


def test_estimate_of_any_run(record_folder: Path) -> None:
    """`verify` estimates the error of the default method; the sensitivity is about 1 here."""
    case = next(random_cases(1, seed=7, records=record_folder))
    found = rwmf.simulate(case.replace(solver={"rtol": 1e-6, "verify": True}))
    trusted = _peak(case, method="dop853", rtol=3e-14)
    error = abs(float(found.u_s_max) - trusted) / trusted
    assert found.attrs["estimated_relative_error"] == pytest.approx(error, rel=0.1, abs=1e-12)
    assert 0.0 < found.attrs["sensitivity"] < 100.0
