"""A wall that its floors lift while the pull of the ground already decreases.

The first step after such a lift-off is some 3e-15 s long. If a method returns the state at
the beginning of so short a step, the ground moves on and the floors do not. The wall is then
pressed down and lifted again some 1e5 times in a nanosecond. Found by `test_hard_combinations.py`
(its number 4019).
"""

from pathlib import Path

import combinations
import pytest
import rwmf

# the part of El Centro that did it, and a factor
FIRST, SAMPLES, FACTOR = 366, 180, 4.22769280031244


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor"])
def test_lift_off_by_floors(method: str, tmp_path: Path) -> None:
    """Every method leaves the base at once and agrees with the trusted one."""
    times, accelerations = combinations.elcentro()
    part = range(FIRST, FIRST + SAMPLES)
    record = tmp_path / "part.txt"
    lines = (f"{times[i] - times[FIRST]!r} {FACTOR * accelerations[i]!r}" for i in part)
    record.write_text("\n".join(lines) + "\n", encoding="utf-8")
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        frame={"xi_s": 0.0},
        storeys={
            "m_over_m_w": [
                0.41395216406304436,
                0.3978467445461587,
                0.2903014687274829,
                0.25909085052833125,
                0.32694528728951894,
            ],
            "k_over_m_w": [
                1317.1159512347028,
                485.1944828594749,
                1.492889695268742,
                1324.082701900728,
                594.6196206633658,
            ],
            "height": [0.75, 0.75, 0.75, 0.875, 0.875],
            "coupling": "full",
        },
        damper={"c_over_m_w": 0.41396156932705797},
        impact={"rule": "coupled"},
        model={"formulation": "exact", "overturning_angle": 0.9},
        motion={"kind": "record", "file": str(record), "unit": "m/s2"},
        solver={"t_end": 4.0, "rtol": 1e-10, "max_steps": 60_000},
    )
    trusted = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-13}))
    run = rwmf.simulate(case.replace(solver={"method": method}))
    assert int(run.lift_offs) == int(trusted.lift_offs)
    assert float(run.u_s_max) == pytest.approx(float(trusted.u_s_max), rel=1e-8)
