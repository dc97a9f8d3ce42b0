"""Random buildings from a number: input of the independent program, and the kernel's case.

The same number makes the same scene on every machine, so that a finding is a number.
"""

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import rwmf
from bodies import Body, Building, Ground, Scene

G = 9.81
T_END = 3.0
SHORTEST = 0.02  # flight that the program follows [s]


def building_scene(number: int) -> Scene:
    """Make the scene of a number.

    Parameters
    ----------
    number : int
        Any.

    Returns
    -------
    Scene
        A frame alone or beside a wall, elastic or not.
    """
    dice = random.Random(f"building {number}")
    coupling = dice.choice(["single", "full", "full", "reduced", "every_floor"])
    wall = _wall(dice) if coupling == "every_floor" or dice.random() < 0.8 else None
    n = 1 if coupling == "single" else dice.randint(2, 4)
    m = [dice.uniform(0.5, 1.5) for _ in range(n)]
    gamma = _log(dice, 0.5, 30.0)
    m = [gamma * x / sum(m) for x in m]
    total = 2 * wall.h if wall else dice.uniform(3.0, 4.5) * n
    parts = [dice.uniform(0.7, 1.3) for _ in range(n)]
    height: list[float] | None = [total * x / sum(parts) for x in parts]
    leans = dice.random() < 0.4
    if coupling == "single" and not wall and not leans:
        height = None
    elif height and n > 1:
        height[-1] = total - sum(height[:-1])
    k = [dice.uniform(0.6, 1.5) * (1.3 - i / n) for i in range(n)]
    period = _log(dice, 0.3, 1.5)
    k = _scaled(m, k, period)
    scene = Scene(
        m,
        k,
        height,
        _ground(dice),
        "full" if coupling == "single" else coupling,
        is_single=coupling == "single",
        xi=dice.choice([0.0, 0.02, 0.05, 0.3]),
        lean=dice.uniform(0.5, 3.0) if leans else 0.0,
        limit=dice.choice([0.02, 0.1]) if leans else math.inf,
        wall=wall,
        vertical=dice.uniform(-0.6, 0.6) if wall and dice.random() < 0.25 else 0.0,
    )
    if dice.random() < 0.75:
        scene.yielding = _yielding(dice, scene, period)
    return scene


def _log(dice: random.Random, low: float, high: float) -> float:
    return low * (high / low) ** dice.random()


def _scaled(m: list[float], k: list[float], period: float) -> list[float]:
    """Scale stiffnesses so that the first period is a given one [s]."""
    n = len(m)
    matrix = np.diag(k) + np.diag([*k[1:], 0.0])
    matrix -= np.diag(k[1:], 1) + np.diag(k[1:], -1)
    root = np.diag(1 / np.sqrt(m))
    squares = np.linalg.eigvalsh(root @ matrix @ root)
    factor = (2 * math.pi / period) ** 2 / squares[0]
    return [factor * k[i] for i in range(n)]


def _wall(dice: random.Random) -> Body:
    h = dice.uniform(3.0, 8.0)
    wall = Body(h, h * dice.uniform(0.12, 0.3))
    wall.e = dice.choice([0.9, 0.8, None])
    wall.formulation = dice.choice(["exact", "symmetric"])
    if dice.random() < 0.6:
        first = dice.uniform(0.0, 1.5)
        wall.eta = (first, first + dice.uniform(0.0, 4.0))
        wall.cable = dice.choice(["truss", "linear"])
    if dice.random() < 0.25:
        wall.damper = dice.uniform(0.05, 1.0)
    if dice.random() < 0.4:
        wall.fuse = {"eta_y": dice.uniform(0.05, 0.4), "stroke_y": _log(dice, 1e-3, 1e-2)}
        wall.fuse |= _law(dice, may_soften=False)
    return wall


def _law(dice: random.Random, *, may_soften: bool) -> dict[str, Any]:
    """Bilinear, softening, slipping or self-centring."""
    law = dice.choice(["plain", "plain", "friction", "flag", *(["softens"] if may_soften else [])])
    keys: dict[str, Any] = {"hardening": dice.choice([0.0, 0.05, 0.2])}
    if law == "softens":
        return {"hardening": -dice.uniform(0.005, 0.05), "ultimate": dice.uniform(3.0, 8.0)}
    if law == "friction":
        return {"law": law, "hardening": dice.choice([0.0, 0.05]),
                "breakaway": dice.choice([1.0, 1.2, 1.4])}  # fmt: skip
    if law == "flag":
        return keys | {"law": law, "flag_height": dice.choice([0.4, 0.8, 1.0])}
    return keys


def _yielding(dice: random.Random, scene: Scene, period: float) -> dict[str, Any]:
    """Make `&yielding` of one spring, or of each storey, that the motion overcomes."""
    share = _log(dice, 0.04, 0.25)
    keys = _law(dice, may_soften=True)
    by_storeys = scene.coupling == "full" or dice.random() < 0.5
    if scene.is_single or scene.coupling == "reduced" or not by_storeys:
        return {"u_y": 1.3 * share * G * (period / (2 * math.pi)) ** 2} | keys
    above = np.cumsum(np.array(scene.m)[::-1])[::-1]
    yields = share * G * above / np.array(scene.k)
    return {"storey_u_y": [float(x) * dice.uniform(0.8, 1.3) for x in yields]} | keys


def _ground(dice: random.Random) -> Ground:
    """Half waves of a sine, or straight lines between random times."""
    peak = G * dice.uniform(0.15, 0.7)
    if dice.random() < 0.5:
        omega = dice.uniform(3.0, 9.0)
        end = math.pi * dice.choice([1, 2, 3, 5]) / omega
        return Ground([0.0, end], [0.0, 0.0], omega, dice.choice([-1, 1]) * peak)
    knots, values = [0.0], [0.0]
    while knots[-1] < T_END:
        knots.append(knots[-1] + dice.uniform(0.05, 0.3))
        values.append(peak * dice.uniform(-1.0, 1.0))
    values[-1] = 0.0
    return Ground(knots, values)


def case_of(scene: Scene, folder: Path, t_end: float, **changes: dict[str, object]) -> rwmf.Case:
    """Make the kernel's case of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    folder : Path
        Folder for the record.
    t_end : float
        End [s].
    **changes
        Groups that are joined with those of the scene.

    Returns
    -------
    rwmf.Case
        With demands.
    """
    groups: dict[str, dict[str, Any]] = {
        "motion": _motion(scene.ground, folder),
        "solver": {"t_end": t_end, "rtol": 1e-12, "method": "dop853"},
        "output": {"reactions": True},
        "frame": {"xi_s": scene.xi},
    }
    if scene.is_single:
        groups["frame"]["T_s"] = 2 * math.pi * math.sqrt(scene.m[0] / scene.k[0])
        if scene.wall:
            groups["frame"]["gamma"] = scene.m[0]
    else:
        groups["storeys"] = {
            "m_over_m_w": list(scene.m),
            "k_over_m_w": list(scene.k),
            "height": list(scene.height or []),
            "coupling": scene.coupling,
        }
    if scene.yielding:
        groups["yielding"] = scene.yielding
    if scene.lean:
        groups["p_delta"] = {"m_g_over_m_s": scene.lean, "drift_limit": scene.limit}
        if scene.is_single and scene.height:
            groups["p_delta"]["h_f"] = scene.height[0]
    if scene.wall:
        groups |= _groups_of(scene.wall)
        if scene.vertical:
            groups["vertical"] = {"ratio": scene.vertical}
    for name, keys in changes.items():
        groups[name] = groups.get(name, {}) | keys
    return rwmf.Case(**groups)


def _motion(ground: Ground, folder: Path) -> dict[str, Any]:
    if ground.omega:
        cycles = ground.knots[-1] * ground.omega / (2 * math.pi)
        return {"kind": "sine", "a_max_g": ground.peak / G, "omega_p": ground.omega,
                "cycles": cycles}  # fmt: skip
    path = folder / "record.txt"
    rows = (f"{t!r} {a!r}" for t, a in zip(ground.knots, ground.values, strict=True))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return {"kind": "record", "file": str(path), "unit": "m/s2"}


def _groups_of(wall: Body) -> dict[str, dict[str, Any]]:
    groups: dict[str, dict[str, Any]] = {
        "wall": {"h": wall.h, "b": wall.b},
        "model": {"formulation": wall.formulation},
        "impact": {"rule": "coupled"} if wall.e is None else {"e": wall.e},
    }
    if wall.eta:
        eta = {"eta_0": wall.eta[0], "eta_alpha": wall.eta[1]}
        groups["cable"] = eta | {"law": wall.cable}
    if wall.damper:
        groups["damper"] = {"c_over_m_w": wall.damper}
    if wall.fuse:
        groups["fuse"] = wall.fuse
    return groups


def differences(scene: Scene, folder: Path) -> dict[str, tuple[float, float]]:
    """Hold a run of the kernel against the program.

    Parameters
    ----------
    scene : Scene
        The scene.
    folder : Path
        Folder for the record.

    Returns
    -------
    dict
        Number of the kernel and of the program for each demand, also for events.
    """
    building = Building(scene)
    course = building.follow(T_END, SHORTEST)
    t_end, impacts = T_END, course.impacts
    if course.collapse is None and course.pieces[-1].t[1] < T_END:
        # flights get short: up to within the last long one
        t_end = impacts[-2] - 0.4 * SHORTEST
        impacts = impacts[:-2]
    run = rwmf.simulate(case_of(scene, folder, t_end))
    until = t_end if course.collapse is None else course.collapse
    expected = building.largest(course, until)
    if scene.wall and scene.wall.fuse:
        stroke, way = building.travel(course, until)
        expected |= {"fuse_stroke_max": stroke, "fuse_stroke_sum": way}
    if scene.wall and not scene.wall.eta:
        del expected["tendon_force_max_over_m_w_g"]
    if scene.yielding:
        expected |= building.left(course, until)
    expected["pivot_normal_min_over_m_w_g"] = -expected.get("pivot_normal_min_over_m_w_g", -1.0)
    if expected["pivot_normal_min_over_m_w_g"] < 1e-3 or not scene.wall:
        expected.pop("friction_demand_max", None)
    if not scene.wall:
        del expected["pivot_normal_min_over_m_w_g"]
    else:
        expected["impacts"] = len(impacts)
    if scene.lean or "ultimate" in (scene.yielding or {}):
        expected["collapsed"] = float(course.collapse is not None)
    if course.collapse is not None:
        expected["t_collapse"] = course.collapse
    return {name: (float(run[name]), value) for name, value in expected.items()}
