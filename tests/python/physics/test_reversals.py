"""Storeys that reverse twice within one step of the integrator."""

from pathlib import Path
from typing import Any

import pytest
import rwmf

METHODS = ("dop853", "taylor", "row")
_FULL = {"coupling": "full"}
# Bouc and Wen, and friction with breakaway: scene, quantity and its value by `dop853` at rtol 1e-13
SMOOTH: tuple[dict[str, Any], str, float] = (
    {
        "wall": {"h": 7.386277656720867, "b": 1.2897646461958807},
        "frame": {"xi_s": 0.05},
        "storeys": _FULL
        | {
            "m_over_m_w": [1.3313757956015229, 0.27464878015113203, 0.39994551949254603],
            "k_over_m_w": [1392.3025336351998, 1168.5553778501333, 1233.5437707394428],
            "height": [4.527881789516528, 4.898970848107303, 5.345702675817902],
        },
        "inerter": {"inertance_over_m_w": 0.11200862128720843},
        "yielding": {"storey_u_y": 0.00848656752820923, "hardening": 0.1, "law": "bouc_wen",
                     "exponent": 1.0, "beta": 1.0},
        "cable": {"eta_0": 1.0, "eta_alpha": 5.927416132643434, "law": "truss"},
        "impact": {"rule": "constant", "r": 0.8},
        "motion": {"kind": "mavroeidis_papageorgiou", "a_max_g": -0.30680591002622987,
                   "T_p": 0.42619246054077337, "gamma_p": 2.320745435515347,
                   "nu": -0.9154470427791828},
        "solver": {"t_end": 2.8},
    },
    "storey_1_ductility",
    1.23480942113,
)  # fmt: skip
FRICTION: tuple[dict[str, Any], str, float] = (
    {
        "wall": {"h": 2.903923052906755, "b": 0.35564266218601515},
        "frame": {"xi_s": 0.05},
        "storeys": _FULL
        | {
            "m_over_m_w": [7.566094038908452, 0.6441879910451652, 0.6073625952090079],
            "k_over_m_w": [1831.389848621528, 1874.239154000391, 1376.0550694525914],
            "height": [2.355404934337633, 1.697910098661554, 1.7545310728143226],
        },
        "yielding": {"storey_u_y": [0.006664321908626363, 0.0030704865021052487,
                                    0.008143818575992832],
                     "hardening": 0.3, "law": "friction", "breakaway": 1.5},
        "p_delta": {"m_g_over_m_s": 0.5},
        "cable": {"eta_0": 0.0, "eta_alpha": 0.6662785431029348, "law": "linear"},
        "impact": {"rule": "coupled"},
        "motion": {"kind": "one_sine", "a_max_g": -0.6649554405647147,
                   "T_p": 0.7013616491747245},
        "solver": {"t_end": 4.84},
    },
    "storey_2_residual_drift",
    -0.00112946168501,
)  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rtol", [1e-6, 1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("scene", [SMOOTH, FRICTION], ids=["bouc_wen", "friction"])
def test_a_storey_that_reverses_twice_in_a_step(
    scene: tuple[dict[str, Any], str, float], rtol: float, method: str
) -> None:
    """Its quantity is within 100 rtol of that at a tight tolerance, which `adams` confirms."""
    groups, name, truth = scene
    solver = {"method": method.replace("row", "dop853"), "rtol": rtol}
    case = rwmf.Case(**groups | {"solver": groups["solver"] | solver})
    if method == "row":
        found = float(rwmf.sweep(case, points={"scale": [1.0]}, quantities=[name])[name][0])
    else:
        found = float(rwmf.simulate(case)[name])
    assert found == pytest.approx(truth, rel=max(100 * rtol, 1e-10))


def test_storeys_that_do_not_move_yet_cost_little() -> None:
    """The upper ones of nine storeys move by round-off at first: halving for them is bounded."""
    n = 9
    case = rwmf.Case(
        wall={"h": 1.5 * n, "b": 3.0},
        frame={"xi_s": 0.0},
        storeys={"m_over_m_w": [1.0] * n, "k_over_m_w": [3000.0] * n, "height": [3.0] * n} | _FULL,
        yielding={"storey_u_y": 0.005},
        cable={"eta_0": 5.0, "eta_alpha": 9.0},
        impact={"e": 0.9},
        motion={"kind": "one_sine", "a_max_g": 0.3, "T_p": 1.0},
        solver={"t_end": 0.3, "method": "dop853", "rtol": 1e-7},
    )
    run = rwmf.simulate(case)
    assert run.attrs["rhs_evaluations"] < 1000 * run.attrs["steps"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("stiff", [2, 3])
def test_a_stiff_storey_among_soft_ones(stiff: int, method: str) -> None:
    """The floors' displacements are 1,000 times its own: accelerations keep the promise."""
    rtol, n = 1e-9, 4
    stiffnesses = [1000.0] * n
    stiffnesses[stiff] = 1e5
    case = rwmf.Case(
        frame={"xi_s": 0.0},
        storeys={"m_over_m_w": [1.0] * n, "k_over_m_w": stiffnesses, "height": [3.0] * n} | _FULL,
        yielding={"storey_u_y": [8.0 / k for k in stiffnesses], "hardening": 0.02},
        motion={"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.4},
        solver={"t_end": 1.5, "method": "dop853", "rtol": 1e-13},
        output={"reactions": True},
    )
    names = [f"floor_{i + 1}_acceleration_max_g" for i in range(n)]
    truth = rwmf.simulate(case)
    case = case.replace(solver={"method": method.replace("row", "dop853"), "rtol": rtol})
    found = rwmf.simulate(case)
    if method == "row":
        found = rwmf.sweep(case, points={"scale": [1.0]}, quantities=names).isel(point=0)
    for name in names:
        assert float(found[name]) == pytest.approx(float(truth[name]), rel=100 * rtol)


QUIET: dict[str, dict[str, Any]] = {
    "one storey": {"n": 1, "m": 0.5, "xi_s": 0.02, "u_y": 0.02},
    "three storeys": {"n": 3, "m": 2.0, "xi_s": 0.05, "u_y": 0.02},
    "six storeys": {"n": 6, "m": 0.5, "xi_s": 0.05, "u_y": 0.002},
}


@pytest.mark.parametrize("rtol", [1e-6, 1e-7, 1e-9])
@pytest.mark.parametrize("name", QUIET)
def test_turns_below_the_tolerance_end(name: str, rtol: float) -> None:
    """Before the pulse, `adams` takes steps over whole periods; smooth storeys turn in them."""
    n, m, xi_s, u_y = (QUIET[name][key] for key in ("n", "m", "xi_s", "u_y"))
    case = rwmf.Case(
        frame={"xi_s": xi_s},
        storeys={"m_over_m_w": [m] * n, "k_over_m_w": [800.0] * n, "height": [4.0] * n} | _FULL,
        yielding={"storey_u_y": [u_y] * n, "law": "bouc_wen", "hardening": 0.05},
        motion={"kind": "ricker", "a_max_g": 0.4, "T_p": 1.0},
        solver={"t_end": 6.0, "method": "adams", "rtol": rtol},
    )
    truth = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-12})).u_s_max
    assert float(rwmf.simulate(case).u_s_max) == pytest.approx(float(truth), rel=100 * rtol)


def test_a_reversal_in_the_first_step_after_another() -> None:
    """The first step of a multistep method is of order 1: its displacements contradict its rates.

    Three storeys in free vibration turn almost together.
    """
    case = rwmf.Case(
        frame={"xi_s": 0.02},
        storeys={"m_over_m_w": [0.5] * 3, "k_over_m_w": [800.0] * 3, "height": [4.0] * 3} | _FULL,
        yielding={"storey_u_y": [0.02] * 3, "law": "bouc_wen", "hardening": 0.05},
        motion={"kind": "one_sine", "a_max_g": 0.7, "T_p": 0.8},
        solver={"t_end": 6.0, "method": "adams", "rtol": 1e-7},
    )
    run = rwmf.simulate(case)
    truth = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-12}))
    for quantity in ("u_s_max", "storey_1_residual_drift"):
        assert float(run[quantity]) == pytest.approx(float(truth[quantity]), rel=1e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rtol", [1e-10, 1e-11, 1e-12, 1e-13])
def test_a_fuse_unloads_where_a_linked_storey_reverses(
    rtol: float, method: str, elcentro: Path
) -> None:
    """Both turn with the wall at one instant; round-off may put either first."""
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.25},
        frame={"xi_s": 0.0},
        storeys={"m_over_m_w": [5.0], "k_over_m_w": [5000.0], "height": [4.0]} | _FULL,
        yielding={"storey_u_y": [0.001], "law": "bouc_wen", "hardening": 0.05, "exponent": 5.0},
        impact={"rule": "coupled"},
        fuse={"eta_y": 0.2, "stroke_y": 0.002, "hardening": 0.05},
        nl_damper={"eta_1": 0.05, "exponent": 0.3},
        motion={"kind": "record", "file": str(elcentro), "unit": "g", "scale": 1.5},
        solver={"t_end": 6.0, "method": method.replace("row", "dop853"), "rtol": rtol},
    )
    if method == "row":
        found = rwmf.sweep(case, points={"scale": [1.0]}, quantities=["u_s_max"]).u_s_max[0]
    else:
        found = rwmf.simulate(case).u_s_max
    # by `adams` at rtol 1e-12
    assert float(found) == pytest.approx(0.0754575510956, rel=1e-8)


@pytest.mark.parametrize("rtol", [1e-4, 1e-5, 1e-6])
def test_a_smooth_frame_lifts_the_wall_below_the_tolerance(rtol: float) -> None:
    """A flight from rest leads away from the base, whatever the first step of `adams` shows."""
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        frame={"T_s": 0.8, "gamma": 200.0, "xi_s": 0.0},
        yielding={"u_y": 0.01, "law": "bouc_wen", "hardening": 0.05, "exponent": 1.0},
        impact={"e": 0.95},
        fuse={"eta_y": 0.2, "stroke_y": 0.002, "hardening": 0.05},
        motion={"kind": "one_sine", "a_max_g": 0.7, "T_p": 0.3},
        solver={"t_end": 6.0, "method": "adams", "rtol": rtol},
    )
    truth = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-11})).u_s_max
    assert float(rwmf.simulate(case).u_s_max) == pytest.approx(float(truth), rel=100 * rtol)
