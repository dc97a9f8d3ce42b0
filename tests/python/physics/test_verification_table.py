"""The 54 peaks of an independent Taylor-series program (tests/reference/peaks_taylor.csv)."""

from __future__ import annotations

from pathlib import Path

import pytest
import rwmf
from checkout import REFERENCE
from scenes import coupled, read_table, record

# accuracy that the project promises at rtol 1e-9
TOLERANCE = 1e-7
PEAKS = read_table(REFERENCE / "peaks_taylor.csv")[1]


def test_the_table_is_complete() -> None:
    assert len(PEAKS) == 54


@pytest.mark.parametrize("method", ["adams", "taylor"])
@pytest.mark.parametrize("peak", PEAKS, ids=lambda peak: "-".join(list(peak.values())[:4]))
def test_peak(peak: dict[str, str], method: str, elcentro: Path) -> None:
    motion = record(elcentro) if peak["motion"] == "elcentro" else {"kind": peak["motion"]}
    t_end = None if peak["motion"] == "elcentro" else 10.0
    case = coupled(
        frame={"gamma": float(peak["gamma"]), "T_s": float(peak["T_s_s"])},
        motion=motion,
        model={"formulation": peak["formulation"]},
        solver={"method": method, "rtol": 1e-9, "t_end": t_end},
    )
    found = float(rwmf.simulate(case)["u_s_max"])
    assert found == pytest.approx(float(peak["u_s_max_m"]), rel=TOLERANCE, abs=0)
