"""Storeys that yield individually against an independent program in SciPy.

The plastic displacements are states here, which flow while a storey yields; the kernel has them in
closed form on each branch. Nothing but masses, stiffnesses and geometry is shared.
"""

import numpy as np
import pytest
import rwmf
import xarray as xr
from scenes import bare_frame, coupled
from scipy.integrate import solve_ivp
from test_storeys import PULSE, PULSE_END, TIGHT, B, H, Storeys, ground
from yielding import slowly_unloaded

XI = 0.04
LEDGER = {"energy": True, "dt": 0.01}
SOLVER = {"rtol": 1e-11, "method": "dop853"}


def _groups(m: list[float], k: list[float], coupling: str, height: float) -> dict[str, dict]:
    return {
        "frame": {"T_s": None, "gamma": None, "xi_s": XI},
        "storeys": {
            "m_over_m_w": m,
            "k_over_m_w": k,
            "height": [height / len(m)] * len(m),
            "coupling": coupling,
        },
    }


def _of_storeys(run: xr.Dataset, what: str, n: int) -> list[float]:
    return [float(run[f"storey_{i + 1}_{what}"]) for i in range(n)]


def test_smooth_storeys_against_scipy() -> None:
    """Bouc and Wen's law in each storey, with the present signs of its rate."""
    m, k, u_y = np.array([3.0, 2.0, 1.5]), np.array([600.0, 500.0, 300.0]), 0.015
    hardening, beta = 0.1, 0.7
    model = Storeys(list(m), list(k), XI)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        u, v, z = y.reshape(3, 3)
        drift, speed = np.diff(u, prepend=0.0), np.diff(v, prepend=0.0)
        shear = k * (hardening * drift + (1 - hardening) * u_y * z)
        force = shear - np.append(shear[1:], 0.0) + model.c @ v
        lost = z**2 * (1 - beta + beta * np.sign(speed * z))
        return np.concatenate([v, -force / m - ground(t), speed / u_y * (1 - lost)])

    y, path = np.zeros(9), []
    for begin, end in ((0.0, PULSE_END), (PULSE_END, 2.0)):
        flow = solve_ivp(rates, (begin, end), y, max_step=5e-3, **TIGHT)
        y = flow.y[:, -1]
        path.append(flow.y)
    drifts = np.diff(np.hstack(path)[:3], axis=0, prepend=0.0)
    case = bare_frame(
        **_groups(list(m), list(k), "full", 9.0),
        yielding={
            "storey_u_y": [u_y],
            "hardening": hardening,
            "law": "bouc_wen",
            "exponent": 2.0,
            "beta": beta,
        },
        motion=PULSE,
        solver=SOLVER | {"t_end": 2.0},
        output=LEDGER,
    )
    run = rwmf.simulate(case)
    assert float(run["u_s"][-1]) == pytest.approx(y[2], abs=1e-7)
    farthest = abs(drifts).max(axis=1) / u_y
    assert _of_storeys(run, "ductility", 3) == pytest.approx(farthest, rel=1e-5)
    left = [
        slowly_unloaded(d, z, u_y, hardening, beta, 2.0)
        for d, z in zip(np.diff(y[:3], prepend=0.0), y[6:], strict=True)
    ]
    residual = np.array(_of_storeys(run, "residual_drift", 3)) * 3.0
    assert residual == pytest.approx(left, abs=1e-7)
    shear = k * (hardening * np.diff(y[:3], prepend=0.0) + (1 - hardening) * u_y * y[6:])
    for i in range(3):
        column = run[f"storey_{i + 1}_shear_over_m_w_g"]
        assert float(column[-1]) == pytest.approx(shear[i] / 9.81, abs=1e-6)
    assert float(run["energy_balance_relative"]) < 1e-9


@pytest.mark.parametrize("wall", [True, False])
def test_smooth_storeys_become_bilinear(*, wall: bool) -> None:
    """The difference falls as the square of the exponent, where that is large."""
    m, k = [2.0, 2.0, 2.0], [700.0, 600.0, 400.0]
    groups = _groups(m, k, "full", 2 * H) | {
        "motion": PULSE,
        "solver": SOLVER | {"t_end": 1.5},
    }
    law = {"storey_u_y": [0.02, 0.015, 0.02], "hardening": 0.1}
    make = bare_frame
    if wall:
        make = coupled
        groups |= {
            "wall": {"h": H, "b": B},
            "cable": None,
            "impact": {"e": 0.9},
            "model": {"formulation": "exact"},
        }

    def ductility(**more: object) -> np.ndarray:
        run = rwmf.simulate(make(**groups, yielding=law | more))
        return np.array(_of_storeys(run, "ductility", 3))

    sharp = ductility()
    assert (sharp > 1).any()
    coarse, fine = (
        ductility(law="bouc_wen", exponent=n, beta=0.5) / sharp - 1 for n in (400.0, 800.0)
    )
    assert abs(fine).max() < 2e-5
    assert abs(fine).max() < abs(coarse).max() / 3.8
    if wall:
        assert coarse / fine == pytest.approx(np.full(3, 4.0), rel=0.02)


def test_states_of_smooth_storeys() -> None:
    """Each storey has one more."""
    case = bare_frame(
        **_groups([2.0, 1.0], [500.0, 300.0], "full", 6.0),
        yielding={"storey_u_y": [0.01], "law": "bouc_wen"},
        motion=PULSE,
        solver={"t_end": 1.0},
    )
    assert case.kernel.inventory()["states"] == [
        "u_s_m",
        "u_s_dot_m_s",
        "floor_1_m",
        "floor_1_dot_m_s",
        "z_1",
        "z_2",
    ]


def test_wall_at_rest_bears_what_the_storeys_have_left() -> None:
    """After the motion the roof is held, and the link carries the shear of the uppermost storey."""
    m, k = [2.0, 2.0, 2.0], [700.0, 600.0, 400.0]
    case = coupled(
        **_groups(m, k, "full", 2 * H),
        wall={"h": H, "b": B},
        yielding={"storey_u_y": [0.008, 0.02, 0.015], "hardening": 0.05},
        cable={"eta_0": 10.0, "eta_alpha": 12.0, "law": "linear"},
        impact={"e": 0.0},
        motion=PULSE | {"a_max_g": 0.5},
        model={"formulation": "exact"},
        solver={"rtol": 1e-9, "method": "dop853", "t_end": 60.0},
        output={"reactions": True, "dt": 1.0},
    )
    run = rwmf.simulate(case)
    kind = run["event"].to_numpy()
    assert kind[kind != "branch"][-1] == "rest"
    # storeys have yielded while the wall was held as well
    assert kind[-1] == "branch"
    left = run["storey_3_shear_over_m_w_g"].values[-1]
    assert abs(left) > 1e-3
    # at rest the base balances the pull of the link
    assert float(run["pivot_horizontal_over_m_w_g"][-1]) == pytest.approx(left, abs=1e-5)
    shears = [float(run[f"storey_{i}_shear_over_m_w_g"][-1]) for i in (1, 2, 3)]
    assert shears == pytest.approx([left] * 3, abs=1e-5)
