"""The multistep method of single runs: its many short steps must not add up to a large error."""

from pathlib import Path

import pytest
import rwmf
from checkout import ROOT

RTOL = 1e-9
# tolerances times the sensitivity of the peak, for which `dop853` needs one
MOST = 10.0


@pytest.mark.parametrize(
    ("T_s", "gamma", "b", "scale", "xi_s", "e"),
    [
        (0.1752, 164.7, 0.9829, 0.7983, 0.01, 0.95),
        (2.579, 6.932, 1.066, 2.186, 0.05, 0.95),
        (2.178, 1.604, 0.6167, 2.806, 0.01, 0.8),
        (2.238, 90.12, 0.9073, 2.039, 0.0, 0.95),
    ],
)
def test_peak_under_el_centro(
    elcentro: Path, T_s: float, gamma: float, b: float, scale: float, xi_s: float, e: float
) -> None:
    """With a quarter of the tolerance for each step the first two err by 26 and 37 of them."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig13_elcentro_slender_wall.nml").replace(
        wall={"b": b},
        frame={"T_s": T_s, "gamma": gamma, "xi_s": xi_s},
        impact={"e": e},
        motion={"file": str(elcentro), "scale": scale},
    )
    trusted = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-12}))
    checked = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": RTOL, "verify": True}))
    peak = float(rwmf.simulate(case.replace(solver={"method": "adams", "rtol": RTOL})).u_s_max)
    bound = MOST * RTOL * max(1.0, float(checked.sensitivity))
    assert abs(peak / float(trusted.u_s_max) - 1) <= bound
