"""Envelopes of forces: slices of the wall, the pivot's balance, closed forms, every path alike.

`test_demands_of_walls.py` holds every one of them against the program of single bodies as well.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
import xarray as xr
from combinations import further_combination
from rwmf.run.quantities import QUANTITIES, Quantity
from scenes import block, coupled

G = 9.81
H, B = 6.0, 1.5
L = 2 * H
SLICES = 2000
M_W = 2e5
PULSE = {"kind": "one_sine", "a_max_g": 0.35, "omega_p": 4.0}
FREE = {
    "wall": {"h": H, "b": B},
    "model": {"formulation": "exact"},
    "impact": {"rule": "housner", "e": None},
}


def _storeys(coupling: str, **changes: dict[str, object] | None) -> rwmf.Case:
    """Four unequal storeys beside a wall with strands and fuses, all in N."""
    groups: dict[str, dict[str, Any]] = {
        "wall": {"h": H, "b": B, "m_w": M_W},
        "frame": {"xi_s": 0.04},
        "storeys": {
            "m": [1e5, 9e4, 9e4, 7e4],
            "k": [9e7, 8e7, 7e7, 5e7],
            "height": [3.5, 3.0, 3.0, 2.5],
            "coupling": coupling,
        },
        "cable": {"strands": 20, "strand_area": 1.4e-4, "modulus": 1.95e11, "initial_stress": 9e8},
        "fuse": {"F_y": 1e5, "stroke_y": 0.002},
        "impact": {"rule": "coupled"},
        "motion": {"kind": "ricker", "a_max_g": 0.4, "T_p": 1.0},
        "model": {"formulation": "exact"},
        "solver": {"t_end": 4.0},
    }
    return rwmf.Case(**groups).replace(**changes)


def _slices(run: xr.Dataset, z: float) -> tuple[np.ndarray, np.ndarray]:
    """Shear and moment at a height of a free wall: momentum of 2,000 slices above it."""
    theta, rate, ddot, a = (
        run[name].values[:, None, None] for name in ("theta", "theta_dot", "theta_ddot", "u_g_ddot")
    )
    step = (L - z) / SLICES
    # two points of Gauss up a slice and across it: its inertia is a polynomial of degree two
    nodes = np.array([-1.0, 1.0]) / math.sqrt(3)
    up = z + step * (np.arange(SLICES)[:, None] + 0.5 + nodes / 2).ravel()
    shear, moment = 0.0, 0.0
    for across in B * nodes:
        side = np.where(theta >= 0, 1.0, -1.0)
        x, y = (across - side * B), up[None, None, :]
        c, s = np.cos(theta), np.sin(theta)
        at = x * c + y * s, -x * s + y * c
        push = at[1] * ddot - at[0] * rate**2 + a, -at[0] * ddot - at[1] * rate**2 + G
        own = c * push[0] - s * push[1], s * push[0] + c * push[1]
        shear = shear + own[0].sum(axis=-1) * step / (4 * L)
        moment = moment + ((y - z) * own[0] - across * own[1]).sum(axis=-1) * step / (4 * L)
    return shear[:, 0], moment[:, 0]


@pytest.mark.parametrize(
    "changes",
    [
        {"initial": {"theta_over_alpha": 0.6}},
        {"initial": {"theta_over_alpha": -0.3, "theta_dot": 0.05}, "motion": PULSE},
        {"motion": {"kind": "one_sine", "a_max_g": 0.2, "omega_p": 3.0}},
    ],
    ids=["let go", "shaken", "at rest"],
)
def test_slices_of_a_free_wall(changes: dict[str, Any]) -> None:
    """Largest shear and moment at base and mid-height are those of 2,000 slices at all times."""
    case = block(**FREE, solver={"t_end": 3.0, "rtol": 1e-11}, output={"reactions": True})
    run = rwmf.simulate(case.replace(**changes), dt=0.004)
    for place, z in (("base", 0.0), ("mid", H)):
        for what, values in zip(("shear", "moment"), _slices(run, z), strict=True):
            largest = float(run[f"wall_{what}_{place}_max_over_m_w_g"]) * G
            # rows are 0.004 s apart: the summit of a parabola between them is as near as that
            assert 0.998 * largest < np.abs(values).max() <= largest * (1 + 1e-9), (place, what)
            if place == "base":
                unit = "_over_m_w_g"
                column = run[f"wall_{what}_base{unit}"].values * G
                assert column == pytest.approx(values, rel=1e-9, abs=1e-9)


def test_wall_that_stands_under_a_ramp() -> None:
    """Closed forms: shear m_w a s/L and moment m_w a s^2/(2 L) of the length s above, and links."""
    gamma, top = 0.5, 0.1
    case = coupled(
        **FREE,
        frame={"gamma": gamma, "T_s": 0.7},
        motion={"kind": "one_cosine", "a_max_g": top, "omega_p": 0.1},
        solver={"t_end": 2.0},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    assert int(run["lift_offs"]) == 0
    expected = {
        "wall_shear_base_max_over_m_w_g": top * (1 + gamma),
        "wall_moment_base_max_over_m_w_g": top * H * (1 + 2 * gamma),
        "wall_shear_mid_max_over_m_w_g": top * (0.5 + gamma),
        "wall_moment_mid_max_over_m_w_g": top * H * (0.25 + gamma),
        "wall_shear_1_max_over_m_w_g": top * gamma,
        "wall_shear_1_above_max_over_m_w_g": 0.0,
        "wall_moment_1_max_over_m_w_g": 0.0,
        "wall_moment_1_above_max_over_m_w_g": 0.0,
        "link_1_force_max_over_m_w_g": top * gamma,
        "floor_1_velocity_max": top * G / 0.1 * math.sin(0.2),
        "pivot_normal_max_over_m_w_g": 1 + 1.0,
        "tendon_force_max_over_m_w_g": 1.0,
    }
    for name, value in expected.items():
        assert float(run[name]) == pytest.approx(value, rel=1e-13, abs=1e-13), name


@pytest.mark.parametrize("number", range(0, 40, 3))
def test_base_forces_are_the_pivots(number: int, tmp_path: Path) -> None:
    """Section forces at the base equal the pivot's to 1e-12 in any scene without devices."""
    made = further_combination(number)
    groups = {
        name: keys
        for name, keys in made.groups.items()
        if name not in ("fuse", "damper", "inerter", "nl_damper")
    }
    made.groups.clear()
    made.groups.update(groups)
    case = made.build(tmp_path, output={"reactions": True, "dt": 0.01})
    if case.wall is None:
        return
    run = rwmf.simulate(case)
    theta = run["theta"].values
    h, n = (run[f"pivot_{way}_over_m_w_g"].values for way in ("horizontal", "normal"))
    shear = h * np.cos(theta) - n * np.sin(theta)
    size = np.abs(h) + np.abs(n)
    assert np.all(np.abs(run["wall_shear_base_over_m_w_g"].values - shear) <= 1e-12 * size)
    arm = case.wall.b * np.sign(theta) * (case.wall.base != "pinned")
    moment = -arm * (h * np.sin(theta) + n * np.cos(theta))
    apart = np.abs(run["wall_moment_base_over_m_w_g"].values - moment)
    # a wall that stands is pressed by its whole base
    assert np.all(apart[theta != 0] <= 1e-12 * (size * 2 * case.wall.h)[theta != 0])


@pytest.mark.parametrize("coupling", ["full", "reduced", "every_floor"])
def test_every_path_alike(coupling: str) -> None:
    """Sweep, sweep of one quantity, and run have the same bits; newtons are ratios times m_w g."""
    case = _storeys(coupling)
    run = rwmf.simulate(case.replace(output={"reactions": True}))
    keys = {
        key: item
        for key, item in QUANTITIES.items()
        if "ordinate" in item.outputs.split() and _is_new(key)
    }
    names = [name for item in keys.values() for name in _names(item, run)]
    assert len(names) == len(set(names)) >= len(keys)
    sizes = {"motion.a_max_g": [0.2, 0.4, 0.1]}
    together = rwmf.sweep(case, sizes, quantities=names)
    for name in names:
        assert together[name].squeeze().values[1] == float(run[name]), name
    # series advance the motion where they know all requested quantities
    by_series = ("link_4_force_max", "pivot_normal_max", "tendon_stress_max")
    for name in ("wall_moment_2_max_over_m_w_g", "fuse_stroke_sum", "floor_3_velocity_max",
                 *by_series):  # fmt: skip
        alone = rwmf.sweep(case, sizes, quantities=[name])
        rtol = 1e-6 if name in by_series else 0
        assert np.allclose(alone[name], together[name], rtol=rtol, atol=0), name
        if f"{name}_over_m_w_g" in run:
            ratio = float(run[f"{name}_over_m_w_g"])
            assert float(run[name]) == pytest.approx(ratio * M_W * G, rel=1e-15)
    stress = float(run["tendon_force_max"]) / (20 * 1.4e-4)
    assert float(run["tendon_stress_max"]) == pytest.approx(stress, rel=1e-14)
    links = [name for name in names if name.startswith("link") and name.endswith("force_max")]
    floors = range(1, 5) if coupling == "every_floor" else (4,)
    assert links == [f"link_{i}_force_max" for i in floors]


def _is_new(key: str) -> bool:
    """Tell a quantity of the envelopes from the other demands."""
    parts = ("_base_", "_mid_", "_{i}_", "_{i}_above_")
    of_wall = key.startswith(("wall_shear", "wall_moment")) and any(p in key for p in parts)
    others = ("link_", "pivot_normal_max", "tendon_", "fuse_stroke", "floor_{i}_velocity")
    return of_wall or key.startswith(others)


def _names(item: Quantity, run: xr.Dataset) -> list[str]:
    """Return the variables of a quantity in a run; each quantity has one at least."""
    found = [name.replace("{i}", str(i)) for name in item.names("run")[:1] for i in range(1, 5)]
    found = [name for name in dict.fromkeys(found) if name in run]
    assert found, item
    return found


def test_fuse_strokes() -> None:
    """The chord of the corner that lifts, and its way there and back between the turns."""
    run = rwmf.simulate(_storeys("reduced", output={"reactions": True}), dt=1e-3)
    at_turns = run["event_theta"].values
    theta = np.concatenate([run["theta"].values, at_turns])
    order = np.argsort(np.concatenate([run["time"].values, run["event_time"].values]))
    chord = 4 * B * np.sin(theta[order] / 2)
    ways = [np.abs(np.diff(np.maximum(side * chord, 0.0))).sum() for side in (1, -1)]
    assert float(run["fuse_stroke_sum"]) == pytest.approx(max(ways), rel=1e-9)
    assert float(run["fuse_stroke_max"]) == pytest.approx(np.abs(chord).max(), rel=1e-12)


@pytest.mark.parametrize(
    "motion",
    [
        PULSE,
        {"kind": "one_cosine", "a_max_g": 0.2, "omega_p": 5.0, "t_0": 0.3},
        {"kind": "sine", "a_max_g": 0.2, "omega_p": 5.0, "cycles": 2.25},
        {"kind": "type_c", "a_max_g": 0.2, "T_p": 0.8, "n_pulses": 2},
        {"kind": "ricker", "a_max_g": 0.2, "T_p": 0.8},
        {"kind": "ricker_antisymmetric", "a_max_g": 0.2, "T_p": 0.8},
        {"kind": "mavroeidis_papageorgiou", "a_max_g": 0.2, "T_p": 0.8, "gamma_p": 2, "nu": 0.7},
    ],
    ids=lambda motion: str(motion["kind"]),
)
@pytest.mark.parametrize("wall", [True, False], ids=["wall that stands", "stiff frame"])
def test_velocity_of_the_ground(motion: dict[str, Any], wall: bool) -> None:
    """A floor that does not move has the ground's velocity, whose integral is that of the rows."""
    groups: dict[str, Any] = {
        "frame": {"T_s": 0.7 if wall else 2e-3, "xi_s": 0.05},
        "motion": motion,
        "model": {"formulation": "exact"},
        "solver": {"t_end": 3.0},
        "output": {"reactions": True},
    }
    if wall:
        # twice as wide as high: nothing lifts it
        groups |= {"wall": {"h": 1.0, "b": 2.0}, "impact": {"rule": "coupled"}}
        groups["frame"]["gamma"] = 0.1
    run = rwmf.simulate(rwmf.Case(**groups), dt=1e-4)
    a = run["u_g_ddot"].values
    gained = np.concatenate([[0.0], np.cumsum((a[1:] + a[:-1]) / 2) * 1e-4])
    same = 1e-3 if wall else 5e-3
    assert float(run["floor_1_velocity_max"]) == pytest.approx(np.abs(gained).max(), rel=same)
