"""Demands of buildings against a program that solves for every force.

`tests/support/bodies.py` has the program, `building_scenes.py` makes scenes from numbers: frames
alone and beside rocking walls with every coupling, elastic, bilinear, softening, slipping and
self-centring, with cables, dampers, fuses, vertical motion and gravity on the frame.
RWMF_BUILDINGS is the number of rounds of the slow test, RWMF_BUILDINGS_FIRST the first one.
"""

import math
import os
from dataclasses import replace
from pathlib import Path

import pytest
import rwmf
from bodies import Body, Ground, Scene
from building_scenes import building_scene, differences
from combinations import further_combination
from scenes import coupled

G = 9.81
H, B = 6.0, 1.5
XI = 0.04
OMEGA, PEAK = 4.0, 0.35
T_END = 3.0
SAME = 1e-7
NOTHING = 1e-3  # least reference of residual drifts and displacements [-], [m]
NUMBERS = int(os.environ.get("RWMF_BUILDINGS", "9"))
FIRST = int(os.environ.get("RWMF_BUILDINGS_FIRST", "0"))
# short scenes of the first hundred, which include every coupling, law and end of a run
QUICK = (3, 4, 5, 6, 10, 18, 27, 29, 34, 35)


def _compare(scene: Scene, folder: Path, same: float = SAME) -> dict[str, tuple[float, float]]:
    found = differences(scene, folder)
    for name, (value, expected) in found.items():
        least = NOTHING if "residual" in name else 0.0
        assert value == pytest.approx(expected, rel=same, abs=same * least), name
    return found


@pytest.mark.parametrize("number", QUICK)
def test_buildings(number: int, tmp_path: Path) -> None:
    """Check every demand, the number of impacts, residuals and the time of collapse."""
    _compare(building_scene(number), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    "number", [number for number in range(FIRST, FIRST + NUMBERS) if number not in QUICK]
)
def test_more_buildings(number: int, tmp_path: Path) -> None:
    _compare(building_scene(number), tmp_path)


@pytest.mark.parametrize("coupling", ["full", "reduced", "every_floor"])
def test_elastic_frames(coupling: str, tmp_path: Path) -> None:
    """Every coupling with gravity on the displaced frame: three digits more."""
    m, k, height = [1.0, 0.5, 2.0, 1.0], [900.0, 500.0, 700.0, 300.0], [4.0, 3.0, 3.0, 2.0]
    pulse = Ground([0.0, 2 * math.pi / OMEGA], [0.0, 0.0], OMEGA, PEAK * G)
    wall = Body(H, B, eta=(0.8, 2.5))
    scene = Scene(m, k, height, pulse, coupling, xi=XI, lean=1.0, limit=0.5, wall=wall)
    found = _compare(scene, tmp_path, 1e-10)
    assert found["impacts"][0] >= 3


@pytest.mark.parametrize("method", ["dop853", "taylor"])
def test_motion_that_begins_with_a_jump(method: str) -> None:
    """A wall that it lifts at once has not borne it at rest, whenever it comes."""
    runs = [
        rwmf.simulate(
            coupled(
                frame={"T_s": None, "gamma": None},
                storeys={
                    "m_over_m_w": [1.0, 1.0],
                    "k_over_m_w": [800.0, 600.0],
                    "height": [2.0, 2.0],
                    "coupling": "full",
                },
                motion={"t_0": t_0},
                solver={"t_end": 1.0 + t_0, "rtol": 1e-10, "method": method},
                output={"reactions": True},
            )
        )
        for t_0 in (0.0, 1 / 3)
    ]
    for name in (x for x in runs[0] if not str(x).startswith("sensitivity_")):
        if str(name).endswith("_max") and not str(name).startswith("t_"):
            assert runs[1][name].values == pytest.approx(runs[0][name].values, rel=1e-8), name


def test_what_moves_the_ground_beyond_the_end(tmp_path: Path) -> None:
    """A run that ends with its record, at 3.4 m/s2, is that up to just before, by any method."""
    made = further_combination(37)
    end = made.horizontal[-1][0]
    found = [
        float(
            rwmf.simulate(
                made.build(tmp_path, solver={"method": method, "rtol": 1e-10, "t_end": t_end})
            )["wall_moment_max_over_m_w_g"]
        )
        for method in ("dop853", "taylor", "bdf")
        for t_end in (None, end - 1e-7)
    ]
    assert found == pytest.approx([found[0]] * 6, rel=1e-8)


def test_peak_of_friction_close_to_the_end_of_a_step(tmp_path: Path) -> None:
    """No row of the history exceeds the located maximum (it did by 5e-6)."""
    made = further_combination(12)
    groups = {name: keys for name, keys in made.groups.items() if name not in ("cable", "impact")}
    groups["wall"] = groups["wall"] | {"base": "pinned"}
    solver = {"method": "dop853", "rtol": 1e-10}
    case = replace(made, groups=groups).build(tmp_path, solver=solver)
    run = rwmf.simulate(case, dt=1e-4)
    highest = float(abs(run["friction_demand"]).max())
    assert highest <= float(run["friction_demand_max"]) * (1 + 1e-11)


def test_wall_that_stands() -> None:
    """It moves with the ground: closed forms, largest at the base."""
    peak, gamma = 0.1, 0.5
    case = coupled(
        wall={"h": H, "b": B},
        frame={"gamma": gamma},
        motion={"kind": "one_sine", "a_max_g": peak, "omega_p": OMEGA},
        model={"formulation": "exact"},
        solver={"t_end": T_END},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    assert int(run["lift_offs"]) == 0
    expected = {
        "floor_1_acceleration_max_g": peak,
        "wall_shear_max_over_m_w_g": peak * (1 + gamma),
        "wall_moment_max_over_m_w_g": peak * H * (1 + 2 * gamma),
        "overturning_moment_max_over_weight": peak * H * (1 + 2 * gamma) / (1 + gamma),
    }
    # the wall's own part of the overturning moment is that of its slices: m_w u_g'' h
    for name, value in expected.items():
        assert float(run[name]) == pytest.approx(value, rel=1e-14), name
    assert float(run["wall_shear_max_height"]) == 0
    assert float(run["wall_moment_max_height"]) == 0
    assert float(run["roof_drift_max"]) == 0


def test_residual_drifts() -> None:
    """Of a frame that yields as one spring the storeys keep their shares, which add up."""
    m, k, height = [2.0, 2.0, 1.5], [700.0, 600.0, 400.0], [4.0, 4.0, 4.0]
    for coupling, strength in (
        ("reduced", {"u_y": 0.05}),
        ("every_floor", {"u_y": 0.05}),
        ("every_floor", {"storey_u_y": 0.02}),
        ("full", {"storey_u_y": 0.02}),
    ):
        case = coupled(
            wall={"h": H, "b": B},
            frame={"T_s": None, "gamma": None, "xi_s": XI},
            storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
            yielding=strength | {"hardening": 0.1},
            motion={"kind": "one_sine", "a_max_g": PEAK, "omega_p": OMEGA},
            model={"formulation": "exact"},
            solver={"t_end": T_END},
            output={"reactions": True},
        )
        run = rwmf.simulate(case)
        residual = float(run["residual_displacement"])
        assert abs(residual) > 1e-4
        assert float(run["roof_residual_drift"]) == pytest.approx(residual / (2 * H), rel=1e-14)
        largest = float(run["storey_residual_drift_max"])
        assert largest >= abs(residual) / (2 * H) * (1 - 1e-12)
        if "storey_u_y" in strength:
            drifts = [float(run[f"storey_{i}_residual_drift"]) for i in (1, 2, 3)]
            assert largest == max(map(abs, drifts))
        # the columns that yield bear no more than strength and hardening allow
        for i in (1, 2, 3):
            shear = float(run[f"storey_{i}_shear_max_over_m_w_g"])
            elastic = k[i - 1] * float(run[f"storey_{i}_drift_max"]) * height[i - 1] / G
            assert shear < elastic
