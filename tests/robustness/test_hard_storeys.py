"""Storeys that yield one by one, beside other springs, against quadruple precision."""

from pathlib import Path

import pytest
import rwmf
import trusted
from hard_scenes import METHODS, Groups, Hard

_FRAME: Groups = {
    "frame": {"T_s": None, "gamma": None},
    "storeys": {
        "m_over_m_w": [2.0, 2.0, 1.0],
        "k_over_m_w": [700.0, 600.0, 400.0],
        "height": [1.5, 1.5, 1.0],
        "coupling": "full",
    },
}
_OTHERS: Groups = {
    "fuse": {"eta_y": 0.3, "stroke_y": 0.003},
    "cable": {"eta_y": 1.4, "hardening": 0.02},
}
_JUMPS = (
    (0.0, 0.0), (0.1, 4.0), (0.1000001, -4.0), (0.4, -4.0), (0.4000001, 4.0), (0.7, 4.0),
)  # fmt: skip


def _yielding(u_y: list[float], **more: object) -> Groups:
    return {"yielding": {"storey_u_y": u_y, "hardening": 0.05} | more}


_CASES = [
    Hard("all yield", {**_FRAME, **_yielding([0.01])}),
    Hard("perfectly plastic", {**_FRAME, **_yielding([0.02, 0.01, 0.02], hardening=0.0)}),
    Hard("hardly any strength", {**_FRAME, **_yielding([1e-5])}),
    Hard("with fuses and tendon", {**_FRAME, **_OTHERS, **_yielding([0.01]), "impact": {"e": 0.5}}),
    Hard("e = 0", {**_FRAME, **_yielding([0.01]), "impact": {"e": 0.0}}),
    Hard("jumps of a record", {**_FRAME, **_yielding([0.01])}, _JUMPS),
    Hard(
        "smooth, e = 0.5",
        {**_FRAME, **_yielding([0.01], law="bouc_wen", exponent=1.0), "impact": {"e": 0.5}},
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize("hard", _CASES, ids=[case.name for case in _CASES])
def test_every_method(hard: Hard, tmp_path: Path) -> None:
    """Check the largest displacement and the final rotation, which follow all branches."""
    pytest.importorskip("rwmf._reference")
    truth = trusted.solve(hard.build(tmp_path))
    assert truth["error"] < 1e-15
    for method in METHODS:
        run = rwmf.simulate(hard.build(tmp_path, method), dt=truth["t_end_s"])
        assert float(run["u_s_max"]) == pytest.approx(truth["u_s_max_m"], rel=2e-8), method
        assert float(run["theta"][-1]) == pytest.approx(
            truth["theta_end_rad"], abs=2e-8 * truth["theta_max_rad"]
        ), method
        assert int(run["impacts"]) == truth["impacts"] or truth["impacts"] > 20, method
