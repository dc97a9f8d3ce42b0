"""A storey that unloads in the instant in which the wall turns, and with it a tendon or a fuse.

The roof of a frame of one storey moves with the wall, so that the storey turns where theta' = 0. If
another spring yields as well, the peak of the wall is an event. Afterwards theta' is exactly zero,
and the first step may be too short to move the wall. The storey then begins at the limit of its
branch. It must not count as beyond the limit, or the same step returns for ever. Found by
`test_hard_combinations.py` (number 148 of the further ones).
"""

from functools import cache
from typing import Any

import pytest
import rwmf

METHODS = ["adams", "bdf", "taylor", "dop853"]
LAWS: dict[str, dict[str, Any]] = {
    "bilinear": {"hardening": 0.1},
    "friction": {"law": "friction", "hardening": 0.05},
}
TENDON = {"eta_0": 1.0, "eta_alpha": 9.0, "eta_y": 1.3, "hardening": 0.02}
FUSE = {"eta_y": 0.2, "stroke_y": 2e-3, "hardening": 0.05}
OTHERS: dict[str, dict[str, Any]] = {
    "tendon": {"cable": TENDON},
    "fuse": {"fuse": FUSE},
    "both": {"cable": TENDON, "fuse": FUSE},
}


@cache
def _run(law: str, other: str, method: str, rtol: float) -> tuple[float, int, int]:
    """Return the peak of the frame [m] and the numbers of peaks and impacts of the wall."""
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        impact={"e": 0.8},
        model={"formulation": "exact"},
        frame={"xi_s": 0.05},
        storeys={"m_over_m_w": [2.0], "k_over_m_w": [50.0], "height": [4.0], "coupling": "full"},
        yielding={"storey_u_y": [5e-3], **LAWS[law]},
        motion={"kind": "one_sine", "a_max_g": 0.4, "T_p": 0.8},
        solver={"t_end": 1.5, "max_steps": 15_000, "method": method, "rtol": rtol},
        **OTHERS[other],
    )
    run = rwmf.simulate(case, dt=0.1)
    names = run["event"].values.tolist()
    return float(run.u_s_max), names.count("peak"), names.count("impact")


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("other", OTHERS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("method", METHODS)
def test_springs_that_turn_at_once(method: str, law: str, other: str, rtol: float) -> None:
    """Every method reaches the end of the run, with the same peaks and impacts."""
    found = _run(law, other, method, rtol)
    trusted = _run(law, other, "dop853", 1e-13)
    assert found[1:] == trusted[1:]
    assert found[0] == pytest.approx(trusted[0], rel=1e3 * rtol)
