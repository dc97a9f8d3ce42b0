"""The warning that begins with ``sensitive``, against runs with a motion that is 1e-7 stronger.

Six storeys that lose strength, linked to a wall at every floor, under filtered noise. FEMA P-695 is
not needed.
"""

import numpy as np
import pytest
import rwmf
from checkout import ROOT

STEP = 1e-7
DT, N = 0.01, 2500
BUILDING: dict[str, dict[str, object]] = {
    "wall": {"h": 9.6, "b": 2.0, "thickness": 0.35, "density": 2500.0, "shear_key": True},
    "frame": {"xi_s": 0.03},
    "storeys": {
        "n": 6, "m": 150e3, "height": 3.2, "k": 1e8, "distribution": "linear", "T_1": 1.05,
        "coupling": "every_floor",
    },
    "yielding": {
        "storey_F_y": [1.3e6, 1.2e6, 1.1e6, 0.95e6, 0.75e6, 0.55e6], "law": "pinched",
        "hardening": 0.03, "cap": 5.0, "post_cap": 8.0, "residual": 0.1, "lambda": 60.0,
        "pinch_force": 0.4, "pinch_displacement": 0.5, "ultimate": 15.0,
    },
    "p_delta": {"m_g": 900e3, "drift_limit": 0.08},
    "cable": {
        "strands": 20, "strand_area": 150e-6, "modulus": 195e9, "initial_stress": 800e6,
        "yield_stress": 1640e6, "length": 20.0, "rupture_strain": 0.02, "law": "truss",
    },
    "fuse": {"F_y": 300e3, "k": 1e8, "hardening": 0.02},
    "impact": {"rule": "coupled"},
    "solver": {"t_end": 26.0},
    "output": {"reactions": True},
}  # fmt: skip


def _noise(seed: int, factor: float = 1.0) -> rwmf.Motion:
    dice = np.random.default_rng(seed)
    t = np.arange(N) * DT
    a = np.convolve(dice.standard_normal(N + 20), np.hanning(21), "valid")[:N]
    a *= np.minimum(1, t / 2) * np.minimum(1, (25 - t) / 6).clip(0)
    return rwmf.Motion(factor * 0.3 / np.abs(a).max() * a, dt=DT, unit="g", name="noise")


def _told(run: object) -> list[str]:
    lines = run.attrs["warnings"].splitlines()
    return [line for line in lines if line.startswith("sensitive")]


@pytest.mark.parametrize(("seed", "n"), [(111, 1), (100, 0), (104, 0), (112, 0), (120, 0)])
def test_the_warning_is_true(seed: int, n: int) -> None:
    """One run whose peak changes 448 times as much as its motion, four of about 1."""
    case = rwmf.Case(**BUILDING)
    run = rwmf.simulate(case.replace(motion=_noise(seed)))
    near = rwmf.simulate(case.replace(motion=_noise(seed, 1 + STEP)))
    peak = float(run["storey_drift_max"])
    sensitivity = abs(float(near["storey_drift_max"]) / peak - 1) / STEP
    assert (sensitivity > 100) == (n == 1)
    assert n == 1 or sensitivity < 3
    told = _told(run)
    assert len(told) == n
    if n:
        estimate = float(run["sensitivity_storey_drift_max"])
        assert 0.2 * sensitivity < estimate < 5 * sensitivity


def test_shipped_inputs_are_not_sensitive() -> None:
    for name in ("storeys_full", "storeys_every_floor", "fig13_elcentro_slender_wall"):
        case = rwmf.Case.from_namelist(ROOT / "inputs" / f"{name}.nml")
        assert _told(rwmf.simulate(case.replace(output={"reactions": True}))) == [], name


def test_what_the_estimate_does_not_change() -> None:
    """A sweep without sensitivities has the response of a run with them."""
    case = rwmf.Case(**BUILDING).replace(motion=_noise(111), solver={"method": "dop853"})
    with_estimate = rwmf.simulate(case)
    spectrum = rwmf.sweep(case, {"xi_s": [0.03]}, quantities=("storey_drift_max",))
    assert float(spectrum.storey_drift_max.squeeze()) == float(with_estimate.storey_drift_max)
