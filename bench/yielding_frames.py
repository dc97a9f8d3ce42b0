"""Random frames whose storeys yield one by one: errors of every reported quantity.

    .venv/bin/python bench/yielding_frames.py [--count 2000] [--first 0] [--processes 2]
        [--reference independent]

A scene is a number: a frame of 2 to 9 storeys with one of the laws, with or without a wall, gravity
and devices, under a piecewise linear record. It runs by `dop853`, by `taylor` and as a row
of a table (lanes) at one rtol from 1e-6 to 1e-11. The reference runs at rtol 1e-13 under the same
record with `KNOTS` samples on each line. These bound its steps, so that none of them can hide a
storey that reverses twice. The sensitivity of a quantity is its relative change per relative change
of the motion, 1 at least. Errors above `MOST` times rtol times sensitivity are listed, and scenes
whose sensitivity exceeds `CHAOTIC` are counted apart.

With `--reference independent`, bare frames of three laws are compared with a SciPy program
(`tests/support/yielding_steps.py`), also by `adams`. Other scenes are left out.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import rwmf
from rwmf.errors import NumericalError
from rwmf.quantities import find

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

import combinations
import yielding_steps

MOST = 100.0
CHAOTIC = 1e5
KNOTS = 12
PERTURBATION = 1e-6
SMALL = 1e-9  # of the largest quantity of its kind: below, an error is one of its zero
METHODS = ("dop853", "taylor", "row", "adams")
# numbers of the structure, and of the work
NO_NUMBER = ("seconds", "steps", "rhs_evaluations", "t_", "T_s", "mass_participation",
             "modal_height", "modal_mass_over_m_w", "roof_factor")  # fmt: skip

Groups = dict[str, dict[str, Any]]
Pairs = list[tuple[float, float]]


def draw(number: int) -> tuple[Groups, Pairs, float]:
    """Draw the scene of a number."""
    dice = random.Random(f"yielding frame {number}")
    n = dice.randint(2, 9)
    masses = [dice.uniform(0.3, 1.5) for _ in range(n)]
    stiffnesses = [10 ** dice.uniform(2.3, 3.8) * dice.uniform(0.5, 2.0) for _ in range(n)]
    heights = [dice.uniform(2.5, 4.5) for _ in range(n)]
    peak = 9.81 * dice.uniform(0.15, 0.9)
    weight = sum(masses) * peak
    u_y = [dice.uniform(0.1, 0.9) * weight * (n - i) / n / k for i, k in enumerate(stiffnesses)]
    groups: Groups = {
        "frame": {"xi_s": dice.choice([0.0, 0.02, 0.05])},
        "storeys": {"m": masses, "k": stiffnesses, "height": heights, "coupling": "full"},
        "yielding": {"storey_u_y": u_y} | _law(dice),
        "solver": {"t_end": dice.uniform(2.0, 5.0), "max_steps": 400_000},
        "motion": {"kind": "record"},
    }
    if dice.random() < 0.65:
        groups |= _wall(dice, groups["storeys"])
    else:
        groups["storeys"] = {
            "m_over_m_w" if name == "m" else "k_over_m_w" if name == "k" else name: value
            for name, value in groups["storeys"].items()
        }
    if dice.random() < 0.35:
        groups["p_delta"] = {"m_g_over_m_s": dice.uniform(0.2, 2.0)}
        if dice.random() < 0.3:
            groups["p_delta"]["drift_limit"] = dice.choice([0.01, 0.05])
    groups["output"] = {"reactions": True, "energy": "wall" in groups and dice.random() < 0.5}
    return groups, _record(dice, peak), 10 ** -dice.uniform(6, 11)


def _law(dice: random.Random) -> dict[str, Any]:
    kind = dice.randrange(7)
    if kind == 0:
        return {"hardening": dice.choice([0.0, 0.05, 0.3])}
    if kind in (1, 2):
        return {
            "law": "bouc_wen",
            "hardening": dice.choice([0.02, 0.1]),
            "exponent": dice.choice([1.0, 1.5, 2.0, 8.0]),
            "beta": dice.choice([0.5, 1.0]),
        }
    draws = (combinations._friction, combinations._flag, combinations._softening,
             combinations._loss)  # fmt: skip
    return draws[kind - 3](dice)


def _wall(dice: random.Random, storeys: dict[str, Any]) -> Groups:
    height = sum(storeys["height"])
    half = height / 2
    scale = dice.uniform(2.0, 20.0) / sum(storeys["m"])
    storeys["m_over_m_w"] = [scale * m for m in storeys.pop("m")]
    storeys["k_over_m_w"] = [scale * k for k in storeys.pop("k")]
    groups: Groups = {
        "wall": {"h": half, "b": half * dice.uniform(0.08, 0.25)},
        "model": {"formulation": dice.choice(["exact", "symmetric"])},
        "impact": dice.choice([{"rule": "coupled"}, {"e": 0.8}, {"e": 0.95}]),
        "cable": {"eta_0": dice.choice([0.0, 1.0, 3.0]), "eta_alpha": dice.uniform(4.0, 12.0),
                  "law": dice.choice(["linear", "truss"])},
    }  # fmt: skip
    for name, keys in (
        ("damper", combinations._damper),
        ("fuse", combinations._fuse),
        ("inerter", combinations._inerter),
    ):
        if dice.random() < 0.2:
            groups[name] = keys(dice)
    return groups


def _record(dice: random.Random, peak: float) -> Pairs:
    """Draw straight lines that last 0.02 to 0.5 s: single steps span much of them."""
    t, pairs = 0.0, [(0.0, 0.0)]
    longest = dice.choice([0.05, 0.15, 0.5])
    for _ in range(dice.choice([4, 10, 30])):
        t += dice.uniform(0.2, 1.0) * longest
        pairs.append((t, peak * dice.uniform(-1.0, 1.0)))
    return [*pairs, (t + longest, 0.0)]


def _refined(pairs: Pairs) -> Pairs:
    """Put more samples on the same lines, and on the rest at the end."""
    fine = []
    pairs = [*pairs, (max(6.0, pairs[-1][0] + 1), 0.0)]
    for (t, a), (t_next, a_next) in pairwise(pairs):
        parts = max(KNOTS, math.ceil((t_next - t) / 0.01))
        fine += [(t + (t_next - t) * i / parts, a + (a_next - a) * i / parts)
                 for i in range(parts)]  # fmt: skip
    return [*fine, pairs[-1]]


def _case(groups: Groups, path: Path, **solver: object) -> rwmf.Case:
    groups = groups | {
        "motion": {"kind": "record", "file": str(path), "unit": "m/s2"},
        "solver": groups["solver"] | solver,
    }
    return rwmf.Case(**groups)


def _numbers(values: Mapping[str, object]) -> dict[str, float]:
    """Return the scalars of a run that its accuracy is about, by flat names."""
    return {
        find(key).name: value
        for key, value in values.items()
        if isinstance(value, float)
        and find(key).name
        and not any(key.startswith(word) for word in NO_NUMBER)
        and math.isfinite(value)
    }


def _write(pairs: Pairs, path: Path, scale: float = 1.0) -> Path:
    path.write_text("".join(f"{t!r} {a * scale!r}\n" for t, a in pairs), encoding="utf-8")
    return path


def survey(
    number: int, folder: Path, reference: str = "kernel"
) -> list[tuple[int, str, str, float, float, float]]:
    """Measure the errors of a scene."""
    groups, pairs, rtol = draw(number)
    is_independent = reference == "independent"
    if is_independent and not yielding_steps.is_covered(groups):
        return []
    fine = _refined(pairs)
    tight = {"method": "dop853", "rtol": 1e-13}
    try:
        path = _write(pairs, folder / f"{number}.txt")
        truth = _numbers(rwmf.simulate(_case(groups, _write(fine, folder / f"{number}f.txt"),
                                             **tight)).flat())  # fmt: skip
        moved = [
            _numbers(rwmf.simulate(_case(groups, _write(fine, folder / f"{number}m.txt", 1 + d),
                                         **tight)).flat())
            for d in (PERTURBATION, -PERTURBATION)
        ]  # fmt: skip
    except (NumericalError, rwmf.errors.InputError) as error:
        return [(number, "reference", str(error)[:90], rtol, 0.0, 0.0)]
    sensitivity = {}
    for name, value in truth.items():
        changes = [abs(m.get(name, math.nan) - value) for m in moved]
        sensitivity[name] = max(1.0, max(changes) / PERTURBATION / max(abs(value), 1e-300))
    if is_independent:
        truth = yielding_steps.Frame(groups, pairs).follow()
    rows = []
    for method in METHODS if is_independent else METHODS[:3]:
        try:
            found = _run(method, groups, path, rtol, list(truth))
        except (NumericalError, rwmf.errors.InputError) as error:
            rows.append((number, method, str(error)[:90], rtol, 0.0, 0.0))
            continue
        for name in found.keys() & truth.keys():
            error = abs(found[name] - truth[name]) / max(abs(truth[name]), _floor(name, truth))
            rows.append((number, method, name, rtol, error / rtol / sensitivity[name],
                         sensitivity[name]))  # fmt: skip
    for suffix in ("", "f", "m"):
        (folder / f"{number}{suffix}.txt").unlink()
    return rows


def _floor(name: str, truth: dict[str, float]) -> float:
    """Size below which a quantity is nothing: of residuals and energies that of the largest."""
    for word in ("residual_drift", "energy"):
        if word in name:
            kinds = ("residual_drift", "drift_max") if word == "residual_drift" else (word,)
            others = [abs(v) for k, v in truth.items() if any(kind in k for kind in kinds)]
            return max(others) * (1.0 if word == "energy" else 1e-2)
    return SMALL


def _run(method: str, groups: Groups, path: Path, rtol: float, keys: list[str]) -> dict[str, float]:
    if method != "row":
        return _numbers(rwmf.simulate(_case(groups, path, method=method, rtol=rtol)).flat())
    case = _case(groups, path, method="dop853", rtol=rtol)
    rows = rwmf.sweep(case, points={"scale": [1.0, 0.9]}, quantities=keys)
    first = rows.isel(point=0)
    return _numbers({str(key): first[key].item() for key in first.data_vars})


def main() -> None:
    """Print the table of errors and the scenes that are outside of it."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n", maxsplit=1)[0])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--reference", choices=("kernel", "independent"), default="kernel")
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.count)
    with tempfile.TemporaryDirectory() as place, ProcessPoolExecutor(options.processes) as pool:
        one = partial(survey, folder=Path(place), reference=options.reference)
        rows = [row for found in pool.map(one, numbers, chunksize=4) for row in found]
    _report(rows)


def _report(rows: list[tuple[int, str, str, float, float, float]]) -> None:
    numbers = [row for row in rows if row[5] > 0 and row[5] <= CHAOTIC]
    print("| method | quantities | above 1 | above 10 | above 100 | largest |")
    print("|---|---|---|---|---|---|")
    for method in METHODS:
        errors = [row[4] for row in numbers if row[1] == method]
        counts = " | ".join(str(sum(e > level for e in errors)) for level in (1, 10, 100))
        print(f"| {method} | {len(errors)} | {counts} | {max(errors, default=0):.3g} |")
    chaotic = len({row[0] for row in rows if row[5] > CHAOTIC})
    print(f"{chaotic} scenes have a quantity that is more sensitive than {CHAOTIC:g}")
    for message, count in Counter(row[2] for row in rows if row[5] <= 0).most_common():
        print(f"{count} x {message}")
    outside = sorted((row for row in numbers if row[4] > MOST), key=lambda row: row[:2])
    for number, method, name, rtol, error, sensitivity in outside:
        print(f"{number:6d} {method:14s} {name:32s} rtol {rtol:.1e}  error {error:10.3g}"
              f"  sensitivity {sensitivity:.3g}")  # fmt: skip


if __name__ == "__main__":
    main()
