"""Random scenes with walls that bend, from numbers; runs of the kernel beside the program."""

import math
from typing import Any

import numpy as np
import pytest
import rwmf
from bending import BentWall
from bending_parts import Ground, Groups

Record = dict[str, list[float]] | None

COUPLINGS = ("single", "every_floor", "full", "reduced", "none", "springs")


def bending_scene(number: int) -> tuple[Groups, Record]:
    """Return groups of a case and, where its motion is a record, times [s] and values [m/s2].

    The couplings take turns; `springs` comes sixth. Records have knots at multiples of 0.05 s and
    zeros at both ends.
    """
    rng = np.random.default_rng([20, number])
    coupling = COUPLINGS[number % len(COUPLINGS)]
    h = rng.uniform(3.0, 8.0)
    b = h * rng.uniform(0.12, 0.3)
    fixed = rng.uniform(3.0, 8.0)  # first frequency of the cantilever [Hz]
    stiffness = (2 * math.pi * fixed / 1.8751040687**2) ** 2 * (2 * h) ** 3
    groups: Groups = {
        "wall": {"h": _short(h), "b": _short(b)},
        "bending": {"EI_over_m_w": _short(stiffness), "modes": int(rng.integers(1, 4))},
        "impact": {"rule": "coupled"},
        "model": {"formulation": "exact"},
        "solver": {"t_end": 1.5},
    }
    if rng.random() < 0.4:
        groups["bending"]["damping"] = "stiffness"
    if rng.random() < 0.4:
        groups["bending"]["nu"] = 0.2
    groups |= _frame(rng, coupling, groups["wall"]["h"])
    if rng.random() < 0.75:
        law = str(rng.choice(["linear", "truss"]))
        first = _short(rng.uniform(0.3, 1.2))
        groups["cable"] = {
            "eta_0": first,
            "eta_alpha": _short(first * rng.uniform(1, 6)),
            "law": law,
        }
    for name, values in _devices(rng).items():
        if rng.random() < 0.25:
            groups[name] = values
    if coupling != "none" and rng.random() < 0.3:
        groups["p_delta"] = {"m_g_over_m_s": _short(rng.uniform(0.3, 1.5))}
    return _motion(rng, groups)


def _short(x: float) -> float:
    return float(f"{x:.6g}")


def _devices(rng: np.random.Generator) -> Groups:
    return {
        "damper": {"c_over_m_w": _short(rng.uniform(0.1, 1))},
        "inerter": {"inertance_over_m_w": _short(rng.uniform(0.02, 0.2))},
        "vertical": {"ratio": _short(rng.uniform(-0.5, 0.5))},
        "fuse": {
            "eta_y": _short(rng.uniform(0.05, 0.3)),
            "stroke_y": 0.004,
            "hardening": _short(rng.uniform(0, 0.1)),
        },
    }


def _frame(rng: np.random.Generator, coupling: str, h: float) -> Groups:
    if coupling == "none":
        return {}
    period = rng.uniform(0.5, 1.2)
    if coupling == "single":
        gamma = _short(rng.uniform(0.5, 8))
        return {"frame": {"T_s": _short(period), "gamma": gamma, "xi_s": 0.04}}
    n = int(rng.integers(2, 5))
    m = [_short(x) for x in rng.uniform(0.4, 1.5, n)]
    # stiffnesses that suit the period, falling with height
    scale = (2 * math.pi / period) ** 2 * sum(m) * n / 2
    k = [_short(scale * (1 - 0.5 * i / n) * rng.uniform(0.8, 1.2)) for i in range(n)]
    below = [_short(2 * h / n * x) for x in rng.uniform(0.9, 1.1, n - 1)]
    storeys: dict[str, Any] = {"m_over_m_w": m, "k_over_m_w": k, "coupling": coupling}
    storeys["height"] = [*below, 2 * h - sum(below)]
    if coupling == "springs":
        storeys["k_link_over_m_w"] = _short(rng.uniform(1e3, 1e4))
    return {"frame": {"xi_s": 0.04}, "storeys": storeys}


def _motion(rng: np.random.Generator, groups: Groups) -> tuple[Groups, Record]:
    # roughly in proportion to the acceleration at uplift
    h, b = groups["wall"]["h"], groups["wall"]["b"]
    size = b / h * (1 + groups.get("cable", {}).get("eta_0", 0.0)) * rng.uniform(0.8, 1.6)
    if rng.random() < 0.6:
        kind = str(rng.choice(["one_sine", "one_cosine", "sine"]))
        groups["motion"] = {
            "kind": kind,
            "a_max_g": _short(size),
            "T_p": _short(rng.uniform(0.4, 1)),
        }
        return groups, None
    times = [round(0.05 * i, 10) for i in range(24)]
    values = [_short(9.81 * size * x) for x in rng.uniform(-1.5, 1.5, len(times))]
    values[0] = values[-1] = 0.0
    return groups, {"times": times, "values": values}


def ground_of(record: Record) -> Ground | None:
    """Return the motion of a record, or none for a pulse."""
    return Ground.lines(record["times"], record["values"]) if record else None


def bent_case(groups: Groups, record: Record = None, **solver: object) -> rwmf.Case:
    """Make the kernel's case, with energies and demands and a tight tolerance."""
    given = {name: dict(group) for name, group in groups.items()}
    given["solver"] = given.get("solver", {}) | {"rtol": 1e-11} | solver
    asked = {"energy": True, "reactions": True, "conditioning": False}
    given["output"] = asked | given.get("output", {})
    if record:
        values, times = np.array(record["values"]), np.array(record["times"])
        given["motion"] = rwmf.Motion(values, times=times, unit="m/s2")
    return rwmf.Case(**given)


def compare(
    groups: Groups, record: Record, needed: set[str], loose: dict[str, float] | None = None
) -> dict[str, Any]:
    """Compare a run with the program to 1e-8, some numbers to another tolerance; return it."""
    wall = BentWall(groups, ground_of(record))
    course = wall.follow()
    expected = wall.largest(course)
    energies = wall.energies(course, course.pieces[-1])
    expected |= {f"energy_{name}_J_per_kg": value for name, value in energies.items()}
    run = rwmf.simulate(bent_case(groups, record)).flat()
    assert run["energy_balance_relative"] < 1e-10
    found = {key for key in expected if key in run}
    assert needed <= found
    for key in sorted(found):
        rel = (loose or {}).get(key, 1e-8)
        assert run[key] == pytest.approx(float(expected[key]), rel=rel, abs=1e-12), key
    return run
