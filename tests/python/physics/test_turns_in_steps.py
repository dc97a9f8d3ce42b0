"""Events inside long steps: the same with and without added knots on the lines of the motion."""

from collections import Counter
from typing import Any

import numpy as np
import pytest
import rwmf

METHODS = ("dop853", "adams", "bdf", "taylor")


def _events(seed: int, method: str, parts: int) -> Counter[str]:
    """Count events of a frame with Bouc-Wen or bilinear force under a sharp record."""
    generator = np.random.default_rng(seed)
    period = float(10 ** generator.uniform(-1.5, 0.5))
    dt = period * float(generator.uniform(0.15, 1.2))
    a = generator.normal(size=7) * 4
    a[0] = 0
    u_y = float(np.max(np.abs(a)) * (period / 6.28) ** 2 * 10 ** generator.uniform(-1.5, 0))
    force: dict[str, Any] = {"u_y": u_y, "hardening": 0.1}
    if seed % 2:
        force |= {"law": "bouc_wen", "exponent": 1.0}
    knots = np.arange(a.size)
    fine = np.interp(np.arange((a.size - 1) * parts + 1) / parts, knots, a)
    case = rwmf.Case(
        frame={"T_s": period, "xi_s": 0.1},
        yielding=force,
        motion=rwmf.Motion(fine, dt=dt / parts, unit="m/s2"),
        solver={"t_end": 6 * dt, "method": method, "rtol": 1e-5},
        output={"dt": 6 * dt},
    )
    return Counter(str(event) for event in rwmf.simulate(case)["event"].values)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("seed", range(8))
def test_added_knots_show_no_further_turns(seed: int, method: str) -> None:
    """A turn that a long step hid would be a peak of the run with short steps alone."""
    assert _events(seed, method, 1)["peak"] == _events(seed, method, 16)["peak"]
