"""Three worked designs beside brute force: cost, re-analysis, records left out, missed targets.

    .venv/bin/python bench/designs.py [--designs 300] [--random 2000]

The suites are artificial ground motions, eight for the design and four that judge it. Each design
is computed again by single runs. Its cost is compared with the cheapest of `--random` designs drawn
evenly within the bounds. A second request for each has a target out of reach.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rwmf
from rwmf._design.targets import Target, targets_of

ROOT = Path(__file__).resolve().parents[1]
SUITE, OTHERS = 8, 4
DT, SAMPLES = 0.02, 600


@dataclass(frozen=True)
class Request:
    """A design to find.

    Attributes
    ----------
    name : str
        The structure in words.
    case : Case
        Settings common to all designs.
    bounds : dict
        Lower and upper bound by key.
    targets : list of dict
        The targets.
    cost : dict
        Weights by key.
    out_of_reach : dict
        A target that no design meets.
    """

    name: str
    case: rwmf.Case
    bounds: dict[str, tuple[float, float]]
    targets: list[dict[str, Any]]
    cost: dict[str, float]
    out_of_reach: dict[str, Any]


def motions(n: int, peak: float) -> list[rwmf.Motion]:
    """Make artificial ground motions: noise behind a ground filter of 2 Hz, in an envelope."""
    random = np.random.default_rng(1940)
    t, f = DT * np.arange(SAMPLES), np.fft.rfftfreq(SAMPLES, DT)
    ratio, damping = f / 2.0, 0.6
    ground = (f > 0.1) * (1 + 2j * damping * ratio) / (1 - ratio**2 + 2j * damping * ratio)
    found = []
    for i in range(n):
        noise = np.fft.irfft(np.fft.rfft(random.standard_normal(SAMPLES)) * ground, SAMPLES)
        a = noise * (t / 3) ** 2 * np.exp(2 * (1 - t / 3))
        found.append(rwmf.Motion(peak * a / abs(a).max(), dt=DT, unit="m/s2", name=f"noise {i}"))
    return found


def requests() -> list[Request]:
    """State the three designs."""
    plain = rwmf.Case.from_namelist(ROOT / "inputs" / "study_elcentro.nml")
    plain = plain.replace(frame={"T_s": 1.2})
    fused = plain.replace(
        fuse={"eta_y": 0.2, "stroke_y": 0.004, "hardening": 0.02}, damper={"c_over_m_w": 0.5}
    )
    storeys = rwmf.Case.from_namelist(ROOT / "inputs" / "six_storeys_by_dimensions.nml")
    storeys = storeys.replace(
        storeys={"coupling": "every_floor"}, output={"energy": False}, solver={"t_end": None}
    )
    drift = {"quantity": "storey_drift_max", "percentile": 84}
    floors = {"quantity": "floor_acceleration_max_g", "percentile": 84}
    slow = {"quantity": "u_s_max", "percentile": 84}
    return [
        Request(
            "wall and frame",
            plain,
            {"eta_0": (0.0, 4.0), "xi_s": (0.02, 0.2)},
            [slow | {"limit": 0.11}, {"quantity": "collapse", "probability": 0.1, "scale": 2.0}],
            {"eta_0": 1.0, "xi_s": 20.0},
            slow | {"limit": 0.02},
        ),
        Request(
            "wall, fuses, damper",
            fused,
            {"fuse.eta_y": (0.02, 0.9), "c_over_m_w": (0.0, 8.0), "b": (0.4, 1.0)},
            [slow | {"limit": 0.1}, {"quantity": "theta_max_over_alpha", "limit": 0.08}
             | {"probability": 0.25}],
            {"fuse.eta_y": 2.0, "c_over_m_w": 0.5, "b": 3.0},
            slow | {"limit": 0.02},
        ),
        Request(
            "six storeys, strands",
            storeys,
            {"strands": (4, 40), "fuse.F_y": (40e3, 320e3)},
            [drift | {"limit": 0.0075}, floors | {"limit": 0.9}],
            {"strands": 1.0, "fuse.F_y": 5e-5},
            drift | {"limit": 0.001},
        ),
    ]  # fmt: skip


def _cheapest_at_random(request: Request, suite: list[rwmf.Motion], n: int) -> tuple[float, int]:
    """Return the cost of the cheapest of random designs that meet the targets, and their number."""
    random = np.random.default_rng(1963)
    table: dict[str, Any] = {}
    for name, (low, high) in request.bounds.items():
        is_whole = isinstance(low, int)
        table[name] = (
            random.integers(low, high + 1, n) if is_whole else random.uniform(low, high, n)
        )
    targets = targets_of(request.targets, request.case)
    meets = np.ones(n, dtype=bool)
    for target in targets:
        meets &= _values(request.case, table, target, suite) <= _limit(target)
    cost = sum(weight * table[name] for name, weight in request.cost.items())
    return float(np.min(np.where(meets, cost, np.inf))), int(meets.sum())


def _values(
    case: rwmf.Case, table: dict[str, Any], target: Target, suite: list[rwmf.Motion]
) -> np.ndarray:
    """Return the value of a target for each row of a table."""
    name = "u_s_max" if target.quantity == "collapse" else target.quantity
    n = len(next(iter(table.values())))
    scaled = table | {"scale": np.full(n, target.scale)}
    found = rwmf.sweep(case, None, suite, points=scaled, quantities=(name,))
    words = found["status"].attrs["flag_meanings"].split()
    ends = [words.index(word) for word in ("overturned", "collapsed") if word in words]
    fallen = np.isin(found["status"].values, ends).reshape(len(suite), n)
    if target.quantity == "collapse":
        return np.asarray(fallen.mean(axis=0))
    worst = np.where(fallen, np.inf, found[name].values.reshape(len(suite), n))
    ranked = np.sort(worst, axis=0)
    return np.asarray(ranked[int(np.ceil(target.share * len(suite) - 1e-9)) - 1])


def _limit(target: Target) -> float:
    return 1 - target.share + 1e-12 if target.quantity == "collapse" else target.limit


def _again(case: rwmf.Case, target: Target, suite: list[rwmf.Motion]) -> float:
    """Compute the value of a target again by single runs."""
    values = []
    for motion in suite:
        scaled = rwmf.Motion(
            np.asarray(motion.values) * target.scale, dt=DT, unit="m/s2", name=motion.name
        )
        run = rwmf.simulate(case.replace(motion=scaled, output={"reactions": True}))
        fallen = bool(run.get("overturned", False)) or bool(run.get("collapsed", False))
        value = float(run[target.quantity]) if target.quantity != "collapse" else 0.0
        values.append(np.inf if fallen else value)
    if target.quantity == "collapse":
        return float(np.isinf(values).mean())
    return sorted(values)[int(np.ceil(target.share * len(values) - 1e-9)) - 1]


def main() -> int:
    """Print the designs; the exit status is 1 when one is dearer than brute force by 2 %."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=300, help="of the first stage")
    parser.add_argument("--random", type=int, default=2000, help="designs by brute force")
    options = parser.parse_args()
    both = motions(SUITE + OTHERS, 4.0)
    suite, others = both[:SUITE], both[SUITE:]
    is_good = True
    for request in requests():
        start = time.process_time()
        found = rwmf.design(
            request.case, request.bounds, request.targets, request.cost, suite,
            left_out=others, designs=options.designs,
        )  # fmt: skip
        seconds = time.process_time() - start
        numbers = ", ".join(f"{name} = {value:.5g}" for name, value in found.values.items())
        print(f"\n{request.name}: {numbers}; feasible: {found.is_feasible}")
        print(f"   cost {found.cost:.5g}, {found.designs} designs, {seconds:.0f} s", flush=True)
        targets = targets_of(request.targets, request.case)
        for check, target in zip(found.checks, targets, strict=True):
            again = _again(found.case, target, suite), _again(found.case, target, others)
            print(f"   {check.target}: {check.value:.6g}, again {again[0]:.6g}; left out "
                  f"{check.value_left_out:.6g}, again {again[1]:.6g}", flush=True)  # fmt: skip
        cheapest, n = _cheapest_at_random(request, suite, options.random)
        print(f"   cheapest of {options.random} at random ({n} meet the targets): {cheapest:.5g}, "
              f"ratio {found.cost / cheapest:.4f}", flush=True)  # fmt: skip
        is_good &= found.is_feasible and found.cost <= 1.02 * cheapest
        missed = rwmf.design(
            request.case, request.bounds, [*request.targets, request.out_of_reach], request.cost,
            suite, left_out=(), designs=64,
        )  # fmt: skip
        for text in missed.missed:
            print(f"   out of reach: {text}", flush=True)
        is_good &= not missed.is_feasible
    return 0 if is_good else 1


if __name__ == "__main__":
    raise SystemExit(main())
