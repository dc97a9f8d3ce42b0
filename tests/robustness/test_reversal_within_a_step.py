"""A velocity that falls below zero and is back at its old value within one step.

The ground acceleration changes its sign between two samples, and a method of high order takes them
in one step. The velocities at both ends are alike, and two peaks lie between them.
Here the first one is the largest of all. Found by `test_hard_combinations.py` (number 5274).
"""

from pathlib import Path

import pytest
import rwmf

STEP = 0.0137  # s
SAMPLES = (
    7.620278583261212, -8.388775846240302, 2.910957374846348, 2.1741987086488823,
    -5.740255921761336, -4.429555387120002, -7.480354831685899, 2.028407006250495,
    -3.0422795556062514, 7.62779247011214, 5.181289998010833, -7.6078632172497365,
)  # m/s2  # fmt: skip
METHODS = ["adams", "bdf", "taylor", "dop853"]


def _run(method: str, rtol: float, record: Path) -> tuple[float, list[float]]:
    """Return the peak [m] and the times of the first peaks of the rotation [s]."""
    record.write_text("".join(f"{a!r}\n" for a in SAMPLES), encoding="utf-8")
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        frame={"T_s": 0.5834892349326286, "gamma": 3.2664529045896575, "xi_s": 0.05},
        impact={"e": 0.8},
        model={"formulation": "exact"},
        motion={"kind": "record", "file": str(record), "dt": STEP, "unit": "m/s2"},
        solver={"t_end": 1.0, "method": method, "rtol": rtol},
    )
    run = rwmf.simulate(case, dt=0.1)
    times = run["event_time"].values[run["event"].values == "peak"]
    return float(run.u_s_max), times[:6].tolist()


@pytest.mark.parametrize("rtol", [1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("method", METHODS)
def test_no_peak_is_missed(method: str, rtol: float, tmp_path: Path) -> None:
    """Every method finds every peak, and the largest one among them."""
    peak, times = _run(method, rtol, tmp_path / "record.txt")
    trusted, expected = _run("dop853", 1e-13, tmp_path / "record.txt")
    # a peak and a dip between the last two samples
    assert sum(10 * STEP < t < 11 * STEP for t in expected) == 2
    assert times == pytest.approx(expected, rel=1e3 * rtol)
    assert peak == pytest.approx(trusted, rel=100 * rtol)
