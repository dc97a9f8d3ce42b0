"""Maxima that lanes find in the steps that may raise them, beside a search of every step."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from alone import build
from rwmf.run.quantities import QUANTITIES

# numbers of scenes of every family
_SCENES = (0, 2, 10, 16, 20, 26, 30, 40, 46, 56)
RTOL = 1e-10
# tolerance of the agreement of adams and dop853 in the response, and a much larger one in all other
# maxima
_SAME, _MISSED = 1e-8, 1e-6


def _peaks(case: rwmf.Case, method: str) -> dict[str, np.ndarray]:
    """All maxima of a run."""
    run = rwmf.simulate(case.replace(solver={"method": method, "rtol": RTOL}))
    names = [row.name for row in QUANTITIES.values() if row.found == "peak"]
    return {
        str(key): np.atleast_1d(run[key].values)
        for key in run
        if any(key == name or _is_of(name, str(key)) for name in names if name)
    }


def _is_of(name: str, key: str) -> bool:
    """Return True for a variable of a floor or storey."""
    before, mark, behind = name.partition("{i}")
    number = key.removeprefix(before).removesuffix(behind)
    return bool(mark) and key == before + number + behind and number.isdigit()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("number", _SCENES)
def test_no_maximum_is_missed(number: int, tmp_path: Path) -> None:
    """`adams` takes no lanes: every step of its runs is searched."""
    case = build(number, tmp_path)
    lanes, every = _peaks(case, "dop853"), _peaks(case, "adams")
    assert lanes.keys() == every.keys()
    for key in {"u_s_max", "theta_max_over_alpha"} & every.keys():
        assert lanes[key] == pytest.approx(every[key], rel=_SAME), "the response is the same"
    for key, peak in every.items():
        if key.endswith("_height"):
            continue
        assert lanes[key] == pytest.approx(peak, rel=_MISSED), key
