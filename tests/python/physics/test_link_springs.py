"""Coupling `springs`: the reference program, limits of the stiffness, impacts, laws, every path."""

from typing import Any

import numpy as np
import pytest
import rwmf
import xarray as xr
from bending_scenes import bending_scene, compare

G = 9.81
H, B = 6.0, 1.2
STOREYS: dict[str, Any] = {
    "m_over_m_w": [1.5, 1.4, 1.0],
    "k_over_m_w": [900.0, 800.0, 500.0],
    "height": [4.2, 4.3, 3.5],
}


def _case(coupling: str, k_link: object = None, **changes: dict[str, Any] | None) -> rwmf.Case:
    storeys = STOREYS | {"coupling": coupling}
    if k_link is not None:
        storeys["k_link_over_m_w"] = k_link
    groups: dict[str, Any] = {
        "wall": {"h": H, "b": B},
        "frame": {"xi_s": 0.0},
        "storeys": storeys,
        "cable": {"eta_0": 1.0, "eta_alpha": 4.0},
        "impact": {"rule": "coupled"},
        "motion": {"kind": "one_sine", "a_max_g": 0.45, "T_p": 0.7},
        "solver": {"t_end": 0.4, "rtol": 1e-11},
        "output": {"reactions": True, "energy": True},
    }
    for name, keys in changes.items():
        groups[name] = groups.get(name, {}) | (keys or {})
    return rwmf.Case(**groups)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(5, 53, 12))
def test_reference_program(number: int) -> None:
    """All demands and the ledger of random scenes with a rigid wall, to 1e-8."""
    groups, record = bending_scene(number)
    groups.pop("bending")
    groups["solver"]["rtol"] = 1e-12
    links = {
        f"link_{i}_force_max_over_m_w_g" for i in range(1, len(groups["storeys"]["height"]) + 1)
    }
    compare(groups, record, links | {"wall_drift_max", "storey_2_drift_max", "u_s_max_m"})


def _apart(run: xr.Dataset, limit: xr.Dataset) -> float:
    """Largest difference of the rotations before the first impact, over the largest rotation."""
    theta, other = limit["theta"].values, run["theta"].values
    turns = np.flatnonzero(theta[1:] * theta[:-1] < 0)
    n = int(turns[0]) - 2 if turns.size else theta.size
    return float(np.abs(other - theta)[:n].max() / np.abs(theta).max())


@pytest.mark.parametrize("coupling", ["every_floor", "full"])
def test_stiff_springs_tend_to_rigid_links(coupling: str) -> None:
    """The difference falls as 1/k_link: of all links, or of the roof's beside two soft ones."""
    limit = rwmf.simulate(_case(coupling), dt=0.005)
    stiffnesses = [1e4, 1e5, 1e6, 1e7]
    apart = []
    for k in stiffnesses:
        one = _case("springs", k if coupling == "every_floor" else [1e-9, 1e-9, k])
        apart.append(_apart(rwmf.simulate(one, dt=0.005), limit))
    order = -np.polyfit(np.log(stiffnesses), np.log(apart), 1)[0]
    assert 0.9 < order < 1.4
    assert apart[-1] < 2e-5


def test_soft_springs_leave_the_frame_alone() -> None:
    long = {"t_end": 3.0, "rtol": 1e-11}
    beside = rwmf.simulate(_case("springs", 1e-9, frame={"xi_s": 0.04}, solver=long))
    bare = _case("full", frame={"xi_s": 0.04}, solver=long).without("wall", "cable", "impact")
    alone = rwmf.simulate(bare)
    for i in range(1, 4):
        for name in (f"storey_{i}_drift_max", f"floor_{i}_acceleration_max_g"):
            assert float(beside[name]) == pytest.approx(float(alone[name]), rel=1e-9)


def test_one_spring_for_all_floors() -> None:
    one, each = (rwmf.simulate(_case("springs", k)).flat() for k in (3e3, [3e3, 3e3, 3e3]))
    names = [name for name in one if isinstance(one[name], float) and name != "seconds"]
    assert len(names) > 50
    assert [one[name] for name in names] == [each[name] for name in names]


def test_impacts_leave_the_floors_alone() -> None:
    """The wall loses as much as a free block; velocities of floors do not jump."""
    dt = 1e-4
    run = rwmf.simulate(_case("springs", 3e3, solver={"t_end": 0.9}), dt=dt)
    assert float(run["impacts"]) >= 1
    tangent = (B / H) ** 2
    assert float(run["e"]) == pytest.approx(1 - 1.5 * tangent / (1 + tangent), rel=1e-14)
    for i in range(1, 4):
        u = run[f"floor_{i}"].values
        largest = (float(run[f"floor_{i}_acceleration_max_g"]) + 0.45) * G
        assert np.abs(np.diff(u, 2)).max() < 1.001 * largest * dt**2
    # the impact's part of the ledger, from the velocities just before and after
    jumps = np.abs(np.diff(run["energy_impact"].values))
    i = int(np.argmax(jumps))
    before, after = run["theta_dot"].values[[i, i + 1]]
    size = 2 / 3 * (H**2 + B**2)
    assert jumps[i] == pytest.approx(size * (before**2 - after**2), rel=0.05)


@pytest.mark.parametrize("law", ["elastic_plastic", "friction", "flag", "peak_oriented", "pinched"])
def test_yielding_storeys_on_stiff_springs(law: str) -> None:
    """Storeys that yield one by one tend to those on the straight line; the ledger closes."""
    yielding = {"storey_u_y": [0.02, 0.02, 0.015], "law": law, "hardening": 0.05}
    if law in ("peak_oriented", "pinched"):
        yielding |= {"cap": 3.0, "post_cap": 8.0}
    linked, springs = (
        rwmf.simulate(_case(coupling, k, yielding=yielding, solver={"t_end": 0.38}))
        for coupling, k in (("every_floor", None), ("springs", 1e7))
    )
    for i in range(1, 4):
        name = f"storey_{i}_ductility"
        assert float(springs[name]) > 1.2
        assert float(springs[name]) == pytest.approx(float(linked[name]), rel=2e-5)
    soft = rwmf.simulate(_case("springs", 3e3, yielding=yielding, solver={"t_end": 5.0}))
    assert float(soft["energy_balance_relative"]) < 1e-9
    assert int(soft["impacts"]) > 0
    for i in range(1, 4):
        at_rest = float(soft[f"storey_{i}_residual_drift_at_rest"])
        assert abs(at_rest) <= float(soft[f"storey_{i}_drift_max"])


@pytest.mark.parametrize("method", ["dop853", "adams", "bdf", "taylor"])
def test_methods_agree(method: str) -> None:
    asked = {"t_end": 2.0, "rtol": 1e-10}
    best, other = (
        rwmf.simulate(_case("springs", 3e3, solver=asked | {"method": m})) for m in ("auto", method)
    )
    assert int(other["impacts"]) == int(best["impacts"]) > 0
    for name in ("theta_max_over_alpha", "storey_drift_max", "link_3_force_max_over_m_w_g"):
        assert float(other[name]) == pytest.approx(float(best[name]), rel=1e-7)


@pytest.mark.parametrize("n", [1, 2, 40])
@pytest.mark.parametrize("k", [1e-3, 1e3, 1e5])
def test_sizes(n: int, k: float) -> None:
    """The base of the wall bears the links, its own weight and inertia."""
    storeys = {"n": n, "m_over_m_w": 4 / n, "T_1": 0.8, "k_over_m_w": 1.0, "height": 2 * H / n}
    storeys |= {"coupling": "springs", "k_link_over_m_w": k / n}
    fewer = dict.fromkeys(STOREYS) | storeys
    case = _case("springs", k, frame={"xi_s": 0.03}, solver={"t_end": 1.5, "rtol": 1e-11})
    run = rwmf.simulate(case.replace(storeys=fewer), dt=0.01)
    assert float(run["energy_balance_relative"]) < 1e-10
    theta = run["theta"].values
    push, normal = (run[f"pivot_{way}_over_m_w_g"].values for way in ("horizontal", "normal"))
    shear = push * np.cos(theta) - normal * np.sin(theta)
    links = sum(run[f"link_{i}_force_over_m_w_g"].values for i in range(1, n + 1))
    size = np.abs(push) + np.abs(normal)
    assert np.all(np.abs(run["wall_shear_base_over_m_w_g"].values - shear) < 1e-11 * size)
    assert np.abs(links).max() > 0


def test_every_path_alike() -> None:
    """Sweeps of the stiffness, spectra at the case's own axes and runs have the same bits."""
    case = _case("springs", 3e3, solver={"t_end": 2.0})
    names = ["theta_max_over_alpha", "link_1_force_max_over_m_w_g", "wall_shear_mid_max_over_m_w_g"]
    stiffnesses = [1e3, 3e3, 1e5]
    swept = rwmf.sweep(case, {"storeys.k_link_over_m_w": stiffnesses}, quantities=names)
    for i, k in enumerate(stiffnesses):
        run = rwmf.simulate(_case("springs", k, solver={"t_end": 2.0}))
        for name in names:
            assert swept[name].squeeze().values[i] == float(run[name]), name
    run = rwmf.simulate(case)
    gamma = sum(STOREYS["m_over_m_w"])
    grid = {"T_s": [float(run["T_s"]), 1.1], "gamma": [gamma, 2 * gamma]}
    found = rwmf.sweep(case, grid, quantities=names[:1])[names[0]].squeeze()
    assert found.values.flat[0] == float(run[names[0]])
    # both masses and stiffnesses twice as large, the same links
    twice = STOREYS | {key: [2 * x for x in STOREYS[key]] for key in ("m_over_m_w", "k_over_m_w")}
    heavy = rwmf.simulate(case.replace(storeys=twice))
    assert float(found.sel(gamma=2 * gamma).values[0]) == pytest.approx(
        float(heavy[names[0]]), rel=1e-9
    )
