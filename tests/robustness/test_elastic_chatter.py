"""Bounces without loss: averaged below the resolution, by every method and in spectra."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from hard_scenes import METHODS
from scenes import coupled, record

# by 5e7 steps of the kernel without averaging [m]; the first at t = 2.4451 s
PEAKS = {0.05: 2.219030e-4, 0.08: 1.02755e-3}


def _case(elcentro: Path, T_s: float, **changes: dict[str, object]) -> rwmf.Case:
    shaken = {
        "motion": record(elcentro),
        "solver": {"t_end": None, "rtol": 1e-7, "max_steps": 1_000_000},
        "impact": {"e": 1.0},
        "frame": {"T_s": T_s},
        "model": {"formulation": "published"},
    }
    return coupled(**shaken).replace(**changes)


@pytest.mark.parametrize("method", [name for name in METHODS if name != "bdf"])
def test_a_wall_that_bounces_without_loss(method: str, elcentro: Path) -> None:
    run = rwmf.simulate(_case(elcentro, 0.05, solver={"method": method}))
    assert float(run.u_s_max) == pytest.approx(PEAKS[0.05], rel=1e-5)
    assert float(run.t_u_s_max) == pytest.approx(2.4451, abs=1e-4)
    assert "bounces" in run.attrs["warnings"]


@pytest.mark.parametrize("method", ["auto", "dop853"])
def test_ordinates_of_elastic_chatter(method: str, elcentro: Path) -> None:
    found = rwmf.spectrum(_case(elcentro, 0.08, solver={"method": method}), T_s=[0.08])
    assert found.status.values.item() == "ok"
    assert found.u_s_max.values.item() == pytest.approx(PEAKS[0.08], rel=1e-5)


@pytest.mark.parametrize("e", [1.0, 1 - 1e-7, 1 - 1e-4])
@pytest.mark.parametrize("T_s", [0.05, 0.3])
def test_the_ledger_closes_over_averaged_bounces(e: float, T_s: float, elcentro: Path) -> None:
    """On average the work of ground motion, dampers and impacts continues."""
    case = _case(elcentro, T_s, impact={"e": e}, model={"formulation": "exact"})
    run = rwmf.simulate(case.replace(output={"energy": True, "dt": 0.05}))
    assert float(run["energy_balance_relative"]) < 1e-6
    assert np.isfinite(run["theta"].values).all()
    assert run["energy_viscous"].values[-1] >= 0


def _linked(elcentro: Path, T_1: float, **changes: dict[str, object]) -> rwmf.Case:
    floors = {"n": 4, "m_over_m_w": [1.25], "height": [9.0], "distribution": "uniform"}
    case = _case(
        elcentro,
        0.5,
        model=None,
        cable=None,
        frame={"T_s": None, "gamma": None},
        wall={"h": 18.0, "b": 3.0},
        storeys=floors | {"T_1": T_1, "coupling": "full"},
    )
    return case.replace(**changes)


@pytest.mark.parametrize("T_1", [0.05])
def test_bounces_beside_moving_floors_are_left_out(T_1: float, elcentro: Path) -> None:
    run = rwmf.simulate(_linked(elcentro, T_1, output={"energy": True}))
    assert "left out" in run.attrs["warnings"]
    assert float(run["energy_balance_relative"]) < 1e-6
    closer = rwmf.simulate(_linked(elcentro, T_1, solver={"rtol": 1e-8}))
    assert float(run.u_s_max) == pytest.approx(float(closer.u_s_max), rel=1e-5)


def test_bounces_left_out_agree_with_single_ones(elcentro: Path) -> None:
    """One that the kernel without this rule ended after 951680 steps."""
    run = rwmf.simulate(_linked(elcentro, 0.08))
    assert float(run.u_s_max) == pytest.approx(0.0013379036825327847, rel=1e-7)
    assert run.attrs["steps"] < 200_000


def test_smooth_hysteresis_that_bounces_without_loss(elcentro: Path) -> None:
    """Nearly elastic: the peak is that of the linear frame."""
    T_s = 0.08
    hysteresis = {"law": "bouc_wen", "u_y": 1.0}
    run = rwmf.simulate(_case(elcentro, T_s, yielding=hysteresis))
    assert float(run.u_s_max) == pytest.approx(PEAKS[T_s], rel=1e-3)
    assert "averaged" in run.attrs["warnings"]
