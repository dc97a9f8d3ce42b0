"""Invariants of lossless motion, and the ledger of losses."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from hard_scenes import BLOCK, METHODS, Groups, Hard, quiet, sine
from scipy.integrate import quad

_FREE: Groups = {
    "impact": {"e": 1.0},
    "motion": quiet(),
    "initial": {"theta_over_alpha": 0.2},
}
_ROCKING: Groups = {**BLOCK, **_FREE}
_SPRUNG: Groups = {**_FREE, "frame": {"xi_s": 0.0, "T_s": 1.0, "gamma": 5.0}}


def _period(theta_0: float) -> float:
    """Period of a free-standing block of the common scene, by quadrature [s]."""
    alpha, radius = math.atan2(0.5, 2.0), math.hypot(0.5, 2.0)

    # theta = theta_0 (1 - x**2) takes the square root out of the integrand
    def integrand(x: float) -> float:
        # cos(alpha - theta) - cos(alpha - theta_0), without cancellation at x = 0
        theta = theta_0 * (1 - x**2)
        middle = alpha - (theta + theta_0) / 2
        energy = 2 * math.sin(middle) * math.sin(theta_0 * x**2 / 2)
        return 2 * theta_0 * x / math.sqrt(energy) if x > 0 else 0.0

    start = 2 * theta_0 / math.sqrt(math.sin(alpha - theta_0) * theta_0)
    value, _ = quad(lambda x: integrand(x) if x > 1e-9 else start, 0, 1, epsabs=0, epsrel=1e-13)
    return 4 * value / math.sqrt(1.5 * 9.81 / radius)


@pytest.mark.parametrize("method", METHODS)
def test_impact_times_do_not_drift(method: str, tmp_path: Path) -> None:
    """The last impact in 1000 cycles of a block is at the time of the quadrature."""
    cycles, rtol = 1000, 1e-10
    period = _period(0.2 * math.atan2(0.5, 2.0))
    groups = {**_ROCKING, "solver": {"t_end": cycles * period}}
    run = rwmf.simulate(Hard("drift", groups, rtol=rtol).build(tmp_path, method), dt=10.0)
    times = run["event_time"].values[run["event"].values == "impact"]
    assert len(times) == 2 * cycles
    expected = (np.arange(2 * cycles) + 0.5) * period / 2
    # the local errors of a cycle add up in the energy, and the energy in the phase
    drift = np.max(np.abs(times / expected - 1))
    assert drift <= 10 * rtol * cycles


@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
@pytest.mark.parametrize("method", METHODS)
def test_energy_is_kept(method: str, formulation: str, tmp_path: Path) -> None:
    groups = {**_SPRUNG, "model": {"formulation": formulation}, "solver": {"t_end": 300.0},
              "output": {"energy": True}}  # fmt: skip
    rtol = 1e-10
    run = rwmf.simulate(Hard("energy", groups, rtol=rtol).build(tmp_path, method))
    cycles = int(run["impacts"]) / 2
    assert cycles > 200
    assert abs(float(run["energy_balance_relative"])) <= 100 * rtol * cycles


def test_ten_thousand_cycles(tmp_path: Path) -> None:
    """Energy and time stay linear; the drift per cycle is the tolerance."""
    groups = {**_ROCKING, "solver": {"t_end": 2.4e4}, "output": {"energy": True}}
    run = rwmf.simulate(Hard("long", groups, rtol=1e-11).build(tmp_path, "dop853"))
    cycles = int(run["impacts"]) / 2
    assert cycles == pytest.approx(2.4e4 / _period(0.2 * math.atan2(0.5, 2.0)), rel=1e-5)
    assert cycles > 1e4
    assert abs(float(run["energy_balance_relative"])) <= 1e-11 * cycles


@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
@pytest.mark.parametrize("method", METHODS)
def test_the_ledger_closes(method: str, formulation: str, tmp_path: Path) -> None:
    """Losses in damper and impacts, work of the ground, rest and lift-off in between."""
    groups = {
        "frame": {"T_s": 0.05, "gamma": 0.5},
        "cable": {"eta_0": 5.0, "eta_alpha": 50.0},
        "motion": sine(3.0, 8),
        "model": {"formulation": formulation},
        "output": {"energy": True},
    }
    run = rwmf.simulate(Hard("ledger", groups).build(tmp_path, method))
    assert int(run["lift_offs"]) > 1
    assert abs(float(run["energy_balance_relative"])) <= 1e-7
