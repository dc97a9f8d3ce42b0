"""Demands of a wall that vibrates on stiff fuses many times faster than its frame."""

from pathlib import Path

import numpy as np
import pytest
import rwmf


@pytest.mark.parametrize("method", ["dop853", "taylor", "adams"])
def test_no_sample_exceeds_a_maximum(method: str, tmp_path: Path) -> None:
    """Steps go through several of its turns: each of them counts."""
    rtol, t_end = 3.3246287902131918e-06, 0.8935218626079113
    record = tmp_path / "lines.txt"
    record.write_text(
        "0 0\n0.042780557170799455 -7.101989202691531\n0.09966122968480196 -4.14866538059339\n"
        "0.7646484205607255 3.9957115924914532\n1.1296812241719099 0\n",
        encoding="utf-8",
    )
    case = rwmf.Case(
        wall={"h": 5.0, "b": 1.0909893368372447, "base": "pinned"},
        frame={"xi_s": 0.02},
        storeys={
            "m_over_m_w": [2.195976336173881] * 4,
            "k_over_m_w": [26.305995808142406, 32.20696936172588, 37.19404150354954,
                           26.59929894428341],
            "height": [2.5] * 4,
            "coupling": "reduced",
        },
        fuse={"eta_y": 5.901280477671188, "stroke_y": 0.005081076161075004, "hardening": 0.02},
        model={"formulation": "exact"},
        motion={"kind": "record", "file": str(record), "unit": "m/s2"},
        p_delta={"m_g_over_m_s": 0.3, "drift_limit": 0.9},
        solver={"t_end": t_end, "method": method, "rtol": rtol},
        output={"reactions": True, "dt": t_end / 20_000},
    )  # fmt: skip
    run = rwmf.simulate(case)
    for name in ("wall_shear_over_m_w_g", "wall_moment_over_m_w_g"):
        sampled = float(np.abs(run[name]).max())
        assert float(run[name.replace("_over", "_max_over", 1)]) >= sampled * (1 - rtol)
