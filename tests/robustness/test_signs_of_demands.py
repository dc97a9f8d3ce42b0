"""Largest magnitudes of demands whose sign changes inside the step that holds the peak."""

import numpy as np
import pytest
import rwmf

BLOCK = {
    "wall": {"h": 1.0, "b": 0.25, "m_w": 1e3},
    "impact": {"rule": "constant", "e": 0.9},
    "motion": {"kind": "one_sine", "a_max_g": 0.4, "T_p": 0.8},
    "model": {"formulation": "exact"},
    "output": {"reactions": True, "dt": 5e-4},
}


@pytest.mark.parametrize("rtol", [1e-5, 1e-7, 1e-9])
def test_moment_of_a_block_that_overturns(rtol: float) -> None:
    """The moment changes sign at 1.91 s and peaks at 2.06 s, in one step of the method."""
    case = rwmf.Case(**BLOCK, solver={"t_end": 3.0, "rtol": rtol})
    found = rwmf.simulate(case)
    history = float(abs(found["overturning_moment_over_weight"]).max())
    other = rwmf.simulate(case.replace(solver={"method": "dop853"}))
    assert found["overturning_moment_max_over_weight"].item() >= history * (1 - 1e-9)
    assert found["overturning_moment_max_over_weight"].item() == pytest.approx(
        other["overturning_moment_max_over_weight"].item(), rel=100 * rtol
    )


@pytest.mark.parametrize("seed", range(12))
def test_random_blocks(seed: int) -> None:
    """No row of a dense history exceeds the maximum of its demand."""
    random = np.random.default_rng(seed)
    case = rwmf.Case(**BLOCK, solver={"t_end": 3.0}).replace(
        wall={"b": random.uniform(0.15, 0.35)},
        motion={"a_max_g": random.uniform(0.3, 0.7), "T_p": random.uniform(0.5, 1.2)},
        output={"dt": 1e-3},
    )
    found = rwmf.simulate(case)
    for name in ("overturning_moment", "base_shear"):
        rows = float(abs(found[f"{name}_over_weight"]).max())
        assert found[f"{name}_max_over_weight"].item() >= rows * (1 - 1e-7), name
