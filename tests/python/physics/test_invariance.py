"""Invariances of the result, and changes with known effects."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from scenes import coupled, record

# the same physics integrated with other numbers: the tolerance asked, with room for accumulation
SAME_PHYSICS = 1e-7
TIGHT = {"rtol": 1e-10}


@pytest.mark.parametrize(
    "groups",
    [
        {"model": {"formulation": "published"}},
        {"vertical": {"ratio": 0.65}},
        {"model": {"formulation": "exact"}},
    ],
)
@pytest.mark.parametrize("scale", [4.0, 3.0])
def test_dynamic_scaling(scale: float, groups: dict[str, dict[str, object]]) -> None:
    """Lengths times L and times times sqrt(L): the same rotation."""
    time = math.sqrt(scale)
    first = rwmf.simulate(coupled(**groups, solver=TIGHT))
    second = rwmf.simulate(
        coupled(
            **groups,
            wall={"h": 2.0 * scale, "b": 0.5 * scale},
            frame={"T_s": time},
            motion={"omega_p": 2 * math.pi / time},
            solver=TIGHT | {"t_end": 10.0 * time},
        )
    )
    assert float(second["u_s_max"]) == pytest.approx(
        scale * float(first["u_s_max"]), rel=SAME_PHYSICS
    )
    assert float(second["theta_max_over_alpha"]) == pytest.approx(
        float(first["theta_max_over_alpha"]), rel=SAME_PHYSICS
    )


def test_ordinate_is_a_run_of_its_method(elcentro: Path) -> None:
    """An ordinate of a method that is not `fast` has the bits of a single run."""
    case = coupled(motion=record(elcentro), solver={"t_end": 8.0, "method": "adams"})
    ordinate = rwmf.spectrum(case, T_s=1.4, gamma=5.0)["u_s_max"].item()
    assert ordinate == float(rwmf.simulate(case.replace(frame={"T_s": 1.4, "gamma": 5.0})).u_s_max)


def test_namelist_grid_and_list_agree() -> None:
    """A uniform grid in the namelist and the same periods as a list."""
    case = coupled(spectrum={"T_s_min": 0.5, "T_s_max": 2.0, "n": 4}, solver={"t_end": 4.0})
    grid = rwmf.spectrum(case)
    periods = rwmf.spectrum(case, T_s=grid["T_s"].values)
    assert np.array_equal(grid["T_s"].values, np.linspace(0.5, 2.0, 4))
    assert periods["u_s_max"].equals(grid["u_s_max"])
