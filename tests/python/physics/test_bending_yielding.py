"""Yielding frames beside a wall that bends: every coupling, every law, every interface."""

import numpy as np
import pytest
import rwmf
from bending import BentWall
from bending_parts import Groups
from bending_scenes import bending_scene, compare
from bending_scenes import bent_case as _case

H, B = 6.0, 1.2
HEIGHTS = [4.2, 4.3, 3.5]
LAWS: list[dict[str, object]] = [
    {"hardening": 0.05},
    {"law": "bouc_wen", "hardening": 0.05, "exponent": 3.0},
    {"law": "pinched", "cap": 4.0, "post_cap": 10.0, "pinch_force": 0.5, "lambda": 50.0},
]
# number of a scene, displacement of the roof or of the storeys at yield [m], hardening
SCENES = [
    (3, {"u_y": 0.07}, 0.18),
    (9, {"u_y": 0.04}, 0.05),
    (33, {"u_y": 0.12}, 0.0),
    (13, {"u_y": 0.06}, 0.01),
    (1, {"storey_u_y": [0.029, 0.037]}, 0.09),
    (19, {"storey_u_y": [0.0114, 0.0106, 0.0105]}, 0.09),
    (116, {"storey_u_y": [0.054, 0.041]}, 0.01),
]


def _building(coupling: str, **groups: object) -> Groups:
    storeys = {"m_over_m_w": [1.5, 1.4, 1.0], "k_over_m_w": [900.0, 800.0, 500.0]}
    return {
        "wall": {"h": H, "b": B},
        "impact": {"rule": "coupled"},
        "bending": {"EI_over_m_w": 1.5e5, "modes": 2},
        "frame": {"xi_s": 0.03},
        "storeys": storeys | {"height": HEIGHTS, "coupling": coupling},
        "motion": {"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.7},
        "solver": {"t_end": 2.0},
    } | groups  # fmt: skip


@pytest.mark.parametrize(("number", "strength", "hardening"), SCENES)
def test_scenes_agree_with_the_independent_program(
    number: int, strength: Groups, hardening: float
) -> None:
    groups, record = bending_scene(number)
    groups["yielding"] = strength | {"hardening": hardening}
    storeys = len(groups["storeys"]["height"])
    needed = {f"storey_{i}_shear_max_over_m_w_g" for i in range(1, storeys + 1)}
    is_one = "reduced" in groups["storeys"]["coupling"]
    needed |= {"ductility"} if is_one else {"storey_1_ductility", "storey_2_ductility"}
    needed |= {"tip_deflection_max_m", "wall_drift_max", "impacts"}
    # the program for comparison samples the moment over the height
    loose = {"wall_moment_max_over_m_w_g_m": 1e-5} if number == 116 else {}
    run = compare(groups, record, needed, loose)
    assert run["energy_hysteretic_J_per_kg"] > 0.1 * run["energy_input_J_per_kg"]


def test_a_single_mass_leans_over_its_own_height() -> None:
    groups = _building("reduced", p_delta={"m_g_over_m_s": 1.2, "h_f": 4.0})
    groups |= {"frame": {"T_s": 0.6, "gamma": 2.0, "xi_s": 0.03}, "yielding": {"u_y": 0.02}}
    del groups["storeys"]
    wall = BentWall(groups)
    expected = wall.largest(wall.follow())
    run = rwmf.simulate(_case(groups)).flat()
    assert expected["ductility"] > 3
    for key in ("ductility", "u_s_max_m", "wall_moment_max_over_m_w_g_m", "tip_deflection_max_m"):
        assert run[key] == pytest.approx(expected[key], rel=1e-8), key


@pytest.mark.parametrize("law", LAWS)
def test_one_storey_is_the_same_with_every_coupling(law: dict[str, object]) -> None:
    storey = {"m_over_m_w": [2.0], "k_over_m_w": [220.0], "height": [2 * H]}
    runs = []
    for coupling in ("full", "reduced", "every_floor"):
        key = "storey_u_y" if coupling == "full" else "u_y"
        groups = _building(coupling, storeys=storey | {"coupling": coupling})
        runs.append(rwmf.simulate(_case(groups | {"yielding": law | {key: 0.01}})))
    assert float(runs[0].ductility) > 5
    # the place of a flat maximum has half the digits of the maximum
    skipped = ("energy_balance", "wall_moment_max_height")
    for key, value in runs[0].data_vars.items():
        if value.ndim or value.dtype.kind != "f" or str(key).startswith(skipped):
            continue
        for run in runs[1:]:
            assert float(run[key]) == pytest.approx(float(value), rel=1e-8, abs=1e-12), key


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("coupling", ["reduced", "every_floor"])
def test_ledger_methods_lanes_and_hosts(coupling: str, law: dict[str, object]) -> None:
    groups = _building(coupling, p_delta={"m_g_over_m_s": 1.2}, yielding=law | {"u_y": 0.03})
    run = rwmf.simulate(_case(groups | {"output": {"dt": 0.05}}, rtol=1e-9))
    assert float(run.ductility) > 3
    assert float(run.energy_balance_relative) < 1e-10
    other = rwmf.simulate(_case(groups, rtol=1e-9, method="adams"))
    keys = ("u_s_max", "ductility", "residual_displacement", "wall_moment_max_over_m_w_g")
    rows = rwmf.sweep(_case(groups, rtol=1e-9), points={"scale": [0.9, 1.0]}, quantities=keys)
    for key in keys:
        assert float(other[key]) == pytest.approx(float(run[key]), rel=1e-8), key
        assert float(rows[key].values[1]) == float(run[key]), key
    forces = run["links_force_over_m_w_g"].transpose("time", ...)
    links = np.nansum(forces.values, axis=1)
    with rwmf.Wall(_case(groups, rtol=1e-9)) as wall:
        for i in range(1, 30):
            wall.advance(float(run.time[i]))
            assert wall.forces.link == pytest.approx(-9.81 * links[i], rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("key", ["u_y", "f_y_over_m_s_g"])
@pytest.mark.parametrize("coupling", ["reduced", "every_floor"])
def test_ordinates_of_a_spectrum_are_runs(coupling: str, key: str) -> None:
    strength = {key: 0.03 if key == "u_y" else 0.2, "law": "bouc_wen", "hardening": 0.1}
    groups = _building(coupling, yielding=strength)
    runs = []
    for factor in (1.0, 4.0):
        storeys = groups["storeys"]
        k = [factor * x for x in storeys["k_over_m_w"]]
        runs.append(
            rwmf.simulate(_case(groups | {"storeys": storeys | {"k_over_m_w": k}}, rtol=1e-9))
        )
    periods = {"T_s": [float(run.T_s) for run in runs]}
    grid = _case(groups | {"spectrum": periods}, rtol=1e-9)
    found = rwmf.spectrum(grid, quantities=("u_s_max", "ductility"))
    for i, run in enumerate(runs):
        for name in ("u_s_max", "ductility"):
            value = float(found[name].values.ravel()[i])
            assert value == pytest.approx(float(run[name]), rel=1e-7), (i, name)


@pytest.mark.parametrize("coupling", ["reduced", "every_floor"])
@pytest.mark.parametrize("law", LAWS[:2])
def test_a_stiff_wall_tends_to_the_rigid_wall(coupling: str, law: dict[str, object]) -> None:
    """Up to the first impact the difference falls with the reciprocal of the stiffness."""
    scene = _building(coupling, yielding=law | {"u_y": 0.01}, solver={"t_end": 0.35})
    scene |= {"motion": {"kind": "sine", "cycles": 2, "a_max_g": 0.9, "T_p": 1.4}}
    rigid = rwmf.simulate(_case({k: v for k, v in scene.items() if k != "bending"}))
    assert float(rigid.ductility) > 1.2
    assert int(rigid.impacts) == 0
    errors = []
    for stiffness in (1e8, 1e10):
        scene["bending"] = {"EI_over_m_w": stiffness, "modes": 1, "xi": 1.0}
        run = rwmf.simulate(_case(scene))
        errors.append(abs(float(run.u_s_max) - float(rigid.u_s_max)))
    assert errors[0] < 1e-2 * float(rigid.u_s_max)
    assert errors[1] == pytest.approx(errors[0] / 100, rel=0.3)


@pytest.mark.parametrize("coupling", ["reduced", "every_floor"])
def test_the_wall_comes_to_the_rest_that_the_program_states(coupling: str) -> None:
    scene = _building(coupling, yielding={"u_y": 0.03, "hardening": 0.1})
    stated = rwmf.simulate(_case(scene, rtol=1e-9)).roof_residual_drift_at_rest * 2 * H
    last = rwmf.simulate(_case(scene | {"output": {"dt": 1.0}}, rtol=1e-9, t_end=60.0)).u_s[-1]
    assert abs(float(last)) > 0.03
    assert float(stated) == pytest.approx(float(last), rel=1e-6)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("coupling", ["reduced", "every_floor"])
def test_a_pushover_beside_a_stiff_wall_is_that_of_the_rigid_wall(
    coupling: str, law: dict[str, object]
) -> None:
    scene = _building(coupling, yielding=law | {"u_y": 0.03}, cable={"eta_0": 0.5, "eta_alpha": 3})
    scene["bending"] = {"EI_over_m_w": 1e12, "modes": 2}
    bent = rwmf.pushover(_case(scene), (0.2, -0.05, 0.1), steps=20)
    del scene["bending"]
    rigid = rwmf.pushover(_case(scene), (0.2, -0.05, 0.1), steps=20)
    if coupling == "reduced":
        assert bent.mark.values.tolist() == rigid.mark.values.tolist()
    assert float(rigid.energy_hysteretic[-1]) > 1
    # storeys that yield one by one have no common force
    others = set() if coupling == "reduced" else {"frame_force_over_m_s_g"}
    for name in sorted(set(rigid.data_vars) - others, key=str):
        both = [curve[name].transpose(curve.roof_drift.dims[0], ...) for curve in (bent, rigid)]
        size = np.nanmax(np.abs(both[1].values))
        ends = [np.nan_to_num(values.values[-1]) for values in both]
        assert np.nanmax(np.abs(both[0].values)) == pytest.approx(size, rel=1e-6), name
        np.testing.assert_allclose(*ends, rtol=0, atol=1e-6 * size, err_msg=str(name))
